//! A second campaign: what its readings should be, and what moves them. Lengths in mm, angles in rad; a reading of an
//! angle is the displacement that it makes over the usual lever.

use super::judge::{Readings, Reduced, SetUpUnknown};
use crate::algebra::{Htm, rotation_vector, skew_vector};
use crate::analysis::part_models;
use crate::diagnostic::SourceId;
use crate::evaluate::CompiledModel;
use crate::identify::data::{InstrumentUnknown, LEVER_MM, Measurement, MeasurementSet, Reading, TurnKind, tool_axis};
use crate::identify::lists::index_of;
use crate::identify::model::{FitModel, Observation, Parameter, ReadingSubject, Slope, TypeB, observe, single};
use crate::identify::thresholds::{ACROSS_SHARE, DATUM_ITERATIONS, SET_UP_MM, SET_UP_RAD};
use crate::lower::{Chain, ErrorSite, Exact, NominalPose, Source, into_part, point, sensitivities_to, values};
use crate::machine::{Approach, AxisKind, Machine, OperatingPoint, UncertainPart, sin_cos_degrees};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Motions (mm, deg) that a set adds to a command of a machine.
pub(crate) type Additions<'a> = &'a (dyn Fn(&Machine, &OperatingPoint<'_>) -> Vec<f64> + Sync);

const UM: (&str, f64) = ("um", 1e3);
const URAD: (&str, f64) = ("urad", 1e6);

/// The machine that is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Driven {
    /// Without errors.
    Nominal,
    /// With its errors, and nothing added.
    Bare,
    /// With the set.
    WithSet,
    /// With what the set adds to one axis.
    WithAxis(usize),
}

/// One standard uncertainty of every part of the predicted readings, for a tool and a side of approach.
struct PartEffects {
    models: Vec<CompiledModel>,
    /// The machines whose errors are the parts: single errors are read of them.
    moved: Vec<Machine>,
}

pub(super) struct Campaign<'a> {
    /// The machine with each of its tools.
    machines: Vec<Machine>,
    pub rows: &'a [Measurement],
    /// What the set adds; `None` where there is no set, and the model itself is judged.
    added: Option<Additions<'a>>,
    /// Row and component of every number that was read.
    pub numbers: Vec<(usize, usize)>,
    /// Mean nominal point: the set-up turns about it.
    centre: Vector3<f64>,
}

impl<'a> Campaign<'a> {
    pub fn new(machine: &Machine, data: &'a MeasurementSet, added: Option<Additions<'a>>) -> Self {
        let with = |name: &str| machine.with_tool(name).unwrap_or_else(|| machine.clone());
        let machines: Vec<Machine> = machine.tools().iter().map(|tool| with(&tool.name)).collect();
        let rows = &data.rows[..];
        let seen = |(row, m): (usize, &Measurement)| {
            let mask = m.reading_mask();
            (0..3).filter(move |k| mask[*k]).map(move |k| (row, k))
        };
        let numbers = rows.iter().enumerate().flat_map(seen).collect();
        let nominal = |m: &Measurement| NominalPose::in_part(&machines[m.tool], &m.pose).pose.translation;
        let centre = rows.iter().map(nominal).sum::<Vector3<f64>>() / rows.len().max(1) as f64;
        Self { machines, rows, added, numbers, centre }
    }

    /// Returns the name of an axis.
    pub fn axis(&self, i: usize) -> String {
        self.machines.iter().take(1).map(|machine| machine.axes()[i].name.to_string()).collect()
    }

    fn machine(&self, m: &Measurement) -> &Machine {
        &self.machines[m.tool]
    }

    /// Returns the command that the axes follow at a programmed pose (mm, deg).
    fn command(&self, m: &Measurement, pose: &[f64], driven: Driven) -> Vec<f64> {
        if matches!(driven, Driven::Nominal | Driven::Bare) {
            return pose.to_vec();
        }
        let Some(added) = self.added else { return pose.to_vec() };
        let added = added(self.machine(m), &m.approach.at_pose(pose));
        let acts = |axis: usize| !matches!(driven, Driven::WithAxis(only) if only != axis);
        pose.iter().zip(added).enumerate().map(|(axis, (q, by))| if acts(axis) { q + by } else { *q }).collect()
    }

    /// Returns the subject of a reading: a point (mm, workpiece frame), or an error (mm or rad).
    fn subject(&self, m: &Measurement, driven: Driven, of: ReadingSubject<'_>) -> Vector3<f64> {
        let machine = self.machine(m);
        let pose = of.pose().unwrap_or(&m.pose);
        let command = self.command(m, pose, driven);
        let errors = || values(machine, &m.approach.at_pose(&command));
        match of {
            ReadingSubject::Point(_) if driven == Driven::Nominal => {
                NominalPose::in_part(machine, pose).pose.translation
            }
            ReadingSubject::Point(_) => point(machine, &command, &errors(), &Exact),
            ReadingSubject::Turn(_) | ReadingSubject::Axis(_) => {
                let nominal = NominalPose::in_part(machine, pose).pose.linear;
                let actual = || {
                    let Htm { linear, .. } = Chain::actual(machine, &command, &errors(), &Exact).t_wt();
                    let part = machine.workpiece_rotation().map_or_else(Matrix3::identity, |turn| turn.transpose());
                    part * linear
                };
                let held = if driven == Driven::Nominal { nominal } else { actual() };
                match of {
                    ReadingSubject::Axis(_) => held * Vector3::from(machine.tool().direction),
                    _ => skew_vector(&(held * nominal.transpose())),
                }
            }
            ReadingSubject::Error(_) if driven == Driven::Nominal => Vector3::zeros(),
            ReadingSubject::Error(source) => {
                single(errors().of(source) + motion_along(machine, source, pose, &command))
            }
        }
    }

    fn observe(&self, m: &Measurement, unknowns: &[f64], driven: Driven) -> Observation<f64> {
        observe(self.machine(m), m, unknowns, |of| self.subject(m, driven, of))
    }

    /// Returns the numbers of all readings.
    fn numbers_of(&self, of: impl Fn(&Measurement) -> Vector3<f64> + Sync + Send) -> DVector<f64> {
        let all: Vec<Vector3<f64>> = self.rows.par_iter().map(of).collect();
        DVector::from_iterator(self.numbers.len(), self.numbers.iter().map(|(row, k)| all[*row][*k]))
    }

    fn readings(&self, unknowns: &[f64], driven: Driven) -> DVector<f64> {
        self.numbers_of(|m| self.observe(m, unknowns, driven).value)
    }

    /// Returns a matrix of `count` columns, of which each row of readings has some.
    fn columns(&self, count: usize, rows: &[Vec<(usize, Vector3<f64>)>]) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.numbers.len(), count);
        for (i, (row, k)) in self.numbers.iter().enumerate() {
            rows[*row].iter().for_each(|(column, effect)| all[(i, *column)] += effect[*k]);
        }
        all
    }

    /// Forms what is judged: places of instruments by the readings, then everything that moves these, linear there.
    pub fn reduce(&self, machine: &Machine, data: &MeasurementSet, shared: &[TypeB]) -> Reduced {
        let sigma = self.numbers_of(|m| Vector3::repeat(1e-3 / libm::sqrt(m.weight)));
        let measured = self.numbers_of(Measurement::values);
        let mut unknowns: Vec<SetUpUnknown> = data.nuisances.iter().map(SetUpUnknown::of).collect();
        let mut at: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
        let instruments = at.len();
        let by_instrument = |at: &[f64]| {
            let of = |m: &Measurement| self.observe(m, at, Driven::WithSet).by_unknown;
            self.columns(instruments, &self.rows.par_iter().map(of).collect::<Vec<_>>())
        };
        // Away from the solution a length is no straight function of the place of its station.
        for _ in 0..if instruments > 0 { DATUM_ITERATIONS } else { 0 } {
            let left = &measured - self.readings(&at, Driven::WithSet);
            let step = Reduced::least_squares(&by_instrument(&at), &left, &sigma, &unknowns, &away(&unknowns, &at)).1;
            at.iter_mut().zip(step.iter()).for_each(|(x, by)| *x += by);
        }
        let set_up = self.set_up(&at, &mut unknowns);
        at.resize(unknowns.len(), 0.0);
        let mut all = self.columns(unknowns.len(), &set_up);
        all.columns_mut(0, instruments).copy_from(&by_instrument(&at[..instruments]));
        let [nominal, bare, with_set] =
            [Driven::Nominal, Driven::Bare, Driven::WithSet].map(|driven| self.readings(&at, driven));
        let by_axis = |axis: usize| (axis, self.readings(&at, Driven::WithAxis(axis)) - &bare);
        let axes = if self.added.is_some() { 0..machine.axes().len() } else { 0..0 };
        let by_axis = axes.map(by_axis).filter(|(_, effect)| effect.amax() > 0.0).collect();
        // Without a set the errors themselves are what the readings may see or not.
        let set = &with_set - if self.added.is_some() { &bare } else { &nominal };
        Reduced::new(Readings {
            measured: measured - &nominal,
            set,
            predicted: with_set - nominal,
            by_axis,
            parts: self.parts(machine, &at),
            shared: self.shared(machine, data, shared, &at[..instruments]),
            away: away(&unknowns, &at),
            set_up: all,
            unknowns,
            sigma,
        })
    }

    /// Returns for each row the effect of the set-up on it, and adds the unknowns of the set-up.
    fn set_up(&self, at: &[f64], unknowns: &mut Vec<SetUpUnknown>) -> Vec<Vec<(usize, Vector3<f64>)>> {
        let mut files: Vec<SourceId> = Vec::new();
        for m in self.rows {
            let _ = index_of(&mut files, m.place.source);
        }
        let mut one = |m: &Measurement| {
            let file = files.iter().position(|file| *file == m.place.source).unwrap_or(0);
            let prefix = if files.len() > 1 { format!("{}/", file + 1) } else { String::new() };
            let effects = self.set_up_of(m, at).into_iter();
            let effects = effects.filter(|(_, effect)| effect.amax() > 0.0).map(|(mut unknown, effect)| {
                unknown.name = format!("{prefix}{}", unknown.name);
                (index_of(unknowns, unknown), effect)
            });
            effects.collect()
        };
        self.rows.iter().map(&mut one).collect()
    }

    /// Returns the motions that the second set-up may have beside the first, as far as the kind of reading does not
    /// hold them and its instrument has no unknowns for them, each with the effect of a unit.
    fn set_up_of(&self, m: &Measurement, at: &[f64]) -> Vec<(SetUpUnknown, Vector3<f64>)> {
        match &m.reading {
            Reading::Deviation { .. } => {
                let slope = self.observe(m, at, Driven::WithSet).slope;
                let arm = NominalPose::in_part(self.machine(m), &m.pose).pose.translation - self.centre;
                let moved = |k: usize| {
                    let effect = slope.of(&Vector3::ith(k, 1.0), |x: &f64| *x);
                    (SetUpUnknown::known(format!("part {}", ["x", "y", "z"][k]), UM, SET_UP_MM), effect)
                };
                let turned = |k: usize| {
                    let effect = slope.of(&Vector3::ith(k, 1.0).cross(&arm), |x: &f64| *x);
                    (SetUpUnknown::known(format!("turn {}", ["A", "B", "C"][k]), URAD, SET_UP_RAD), effect)
                };
                (0..3).map(moved).chain((0..3).map(turned)).collect()
            }
            Reading::Error { source, .. } => self.set_up_of_error(m, *source),
            // In the frame of the deviations beside it.
            Reading::Turn { turned: [None, None, None], .. } => {
                let slope = self.observe(m, at, Driven::WithSet).slope;
                let turned = |k: usize| {
                    let effect = slope.of(&Vector3::ith(k, 1.0), |x: &f64| *x);
                    (SetUpUnknown::known(format!("turn {}", ["A", "B", "C"][k]), URAD, SET_UP_RAD), effect)
                };
                (0..3).map(turned).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The zero of the instrument; across the axis the alignment of a straightness reference, or the place and the tilt
    /// of an artefact on a rotary axis.
    fn set_up_of_error(&self, m: &Measurement, source: Source) -> Vec<(SetUpUnknown, Vector3<f64>)> {
        let machine = self.machine(m);
        let name = source.error(machine).map_or_else(String::new, |error| error.to_string());
        let unknown = |what: &str, unit, known: f64, effect: f64| {
            (SetUpUnknown::known(format!("{what} {name}"), unit, known), single(effect))
        };
        let unit = m.kind().unit();
        let mut list = vec![unknown("zero", unit, SET_UP_MM, 1.0)];
        let ErrorSite::Component(i) = source.place else { return list };
        let (axis, q) = (&machine.axes()[i], m.pose[i]);
        if axis.direction[source.direction.index() % 3].abs() > ACROSS_SHARE {
            return list;
        }
        match (axis.kind, source.direction.is_rotation()) {
            (AxisKind::Linear, false) => list.push(unknown("slope", URAD, SET_UP_RAD, q)),
            (AxisKind::Linear, true) => {}
            (AxisKind::Rotary, is_tilt) => {
                let known = if is_tilt { SET_UP_RAD * LEVER_MM } else { SET_UP_MM };
                let (sine, cosine) = sin_cos_degrees(q);
                list.push(unknown("artefact cos", unit, known, cosine));
                list.push(unknown("artefact sin", unit, known, sine));
            }
        }
        list
    }

    /// Returns what one standard uncertainty of every part of the machine's errors does to the predicted readings.
    fn parts(&self, machine: &Machine, at: &[f64]) -> DMatrix<f64> {
        let parts: Vec<UncertainPart> = machine.uncertain_parts();
        let mut effects: BTreeMap<(usize, usize), PartEffects> = BTreeMap::new();
        for m in self.rows {
            let _ = effects
                .entry((m.tool, m.approach as usize))
                .or_insert_with(|| PartEffects::of(self.machine(m), &parts, m.approach));
        }
        let of = |m: &Measurement| {
            let slope = self.observe(m, at, Driven::WithSet).slope;
            let Some(PartEffects { models, moved }) = effects.get(&(m.tool, m.approach as usize)) else {
                return Vec::new();
            };
            let displaced = |j: usize, of: &ReadingSubject<'_>| match of {
                ReadingSubject::Point(pose) => into_part(self.machine(m), models[j].deviation(pose).position),
                ReadingSubject::Turn(pose) => into_part(self.machine(m), models[j].deviation(pose).rotation),
                ReadingSubject::Axis(pose) => {
                    let axis = tool_axis(self.machine(m), &NominalPose::in_part(self.machine(m), pose));
                    into_part(self.machine(m), models[j].deviation(pose).rotation).cross(&axis)
                }
                ReadingSubject::Error(source) => single(values(&moved[j], &m.approach.at_pose(&m.pose)).of(*source)),
            };
            (0..parts.len()).map(|j| (j, change(m, &slope, |of| displaced(j, of)))).collect()
        };
        self.columns(parts.len(), &self.rows.par_iter().map(of).collect::<Vec<_>>())
    }

    /// Returns what one standard uncertainty of what all readings share does to them, by cause and channel.
    fn shared(&self, machine: &Machine, data: &MeasurementSet, all: &[TypeB], at: &[f64]) -> DMatrix<f64> {
        let instruments: Vec<Parameter> = data.nuisances.iter().cloned().map(Parameter::from).collect();
        let model = FitModel::new(machine, &instruments);
        let mut causes = Vec::new();
        let mut of = |m: &Measurement| -> Vec<(usize, Vector3<f64>)> {
            let each = all.iter().enumerate();
            let effects = each.flat_map(|(k, of)| {
                of.effect.of(&model, m, at).into_iter().map(move |(channel, effect)| ((k, channel), effect))
            });
            effects.map(|(cause, effect)| (index_of(&mut causes, cause), effect)).collect()
        };
        let rows: Vec<Vec<(usize, Vector3<f64>)>> = self.rows.iter().map(&mut of).collect();
        self.columns(causes.len(), &rows)
    }
}

impl SetUpUnknown {
    fn of(of: &InstrumentUnknown) -> Self {
        let unit = if of.is_angle { URAD } else { UM };
        Self { name: of.name.clone(), unit, known: of.known, start: of.start }
    }

    fn known(name: String, unit: (&'static str, f64), known: f64) -> Self {
        Self { name, unit, known: Some(known), start: 0.0 }
    }
}

impl PartEffects {
    fn of(machine: &Machine, parts: &[UncertainPart], approach: Approach) -> Self {
        let bare = machine.without_uncertainty();
        let moved = parts.iter().map(|part| bare.moved_by(part)).collect();
        Self { models: part_models(machine, parts, approach.into()), moved }
    }
}

/// Returns how far unknowns are from where they start.
fn away(unknowns: &[SetUpUnknown], at: &[f64]) -> DVector<f64> {
    DVector::from_iterator(at.len(), unknowns.iter().zip(at).map(|(unknown, x)| x - unknown.start))
}

/// Returns the change of a reading by displacements of its subjects: of a length between two poses those of the near
/// one less those of the far one.
fn change(
    m: &Measurement,
    slope: &Slope<f64>,
    displaced: impl Fn(&ReadingSubject<'_>) -> Vector3<f64>,
) -> Vector3<f64> {
    let of = |subject: &ReadingSubject<'_>| slope.of(&displaced(subject), |x: &f64| *x);
    if let Reading::Error { source, .. } = &m.reading {
        return of(&ReadingSubject::Error(*source));
    }
    match &m.reading {
        Reading::Turn { of: TurnKind::Axis, .. } => return of(&ReadingSubject::Axis(&m.pose)),
        Reading::Turn { .. } => return of(&ReadingSubject::Turn(&m.pose)),
        _ => {}
    }
    m.poses().map(|pose| of(&ReadingSubject::Point(pose))).reduce(|near, far| near - far).unwrap_or_default()
}

/// Returns the motion (mm or rad) along an error that an instrument for single errors sees in added motions: of linear
/// axes for displacements, of rotary axes for rotations. The lever arms of rotary axes are not in its reading.
fn motion_along(machine: &Machine, source: Source, pose: &[f64], command: &[f64]) -> f64 {
    let turns = source.direction.is_rotation();
    let kind = if turns { AxisKind::Rotary } else { AxisKind::Linear };
    let seen = machine.axes().iter().zip(pose.iter().zip(command));
    let seen: Vec<f64> = seen.map(|(axis, (q, c))| if axis.kind == kind { *c } else { *q }).collect();
    let [before, after] = [pose, &seen].map(|q| NominalPose::at(machine, q).pose);
    let error: Vec<_> = source.error(machine).into_iter().collect();
    let along = sensitivities_to(machine, pose, &error).into_iter().map(|unit| match turns {
        true => (unit.rotation, rotation_vector(&(after.linear * before.linear.transpose()))),
        false => (unit.deviation, after.translation - before.translation),
    });
    along.map(|(unit, step)| step.dot(&unit) / unit.norm_squared()).sum()
}
