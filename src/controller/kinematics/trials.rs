//! Sign tests of kinematic parameters: deliberate changes of numbers, and the readings that they must give.
//!
//! A trial displaces one part of the machine: a rotary line or the tool axis. The same block is run before and after
//! the change, and the position of a linear axis is read both times. The block turns the axis of that line alone, so
//! that a number of another line, or one of the other sign, gives another reading.

use super::Parameters;
use super::driven::programmed_block;
use super::parameters::step;
use super::transformation::Transformation;
use crate::compensation::MachinePart;
use crate::controller::emit::decimal_text;
use crate::machine::{AxisKind, Machine, Pose};
use nalgebra::Vector3;

/// A trial.
#[derive(Debug, Clone, PartialEq)]
pub struct SignTrial {
    /// The numbers that are changed, in the order of the file.
    pub changes: Vec<NumberChange>,
    /// Positions of the block, mm and deg.
    pub pose: Pose,
    /// Length of the tool along the nominal tool axis, mm, where the reading depends on it.
    pub tool_length_mm: Option<f64>,
    /// Index of the linear axis that is read.
    pub axis: usize,
    /// Change of its position, mm.
    pub reading_mm: f64,
    /// The same for the block with the rotary axes at 0, or as near as their travels let them.
    pub unturned_mm: f64,
}

/// The change of a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NumberChange {
    /// The controller's name.
    pub name: String,
    /// Amount that is added to it, with its sign.
    pub by: String,
}

/// Sign tests of a set of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct SignTrials {
    /// The trials.
    pub trials: Vec<SignTrial>,
    /// Names of vectors that no trial reaches, by their first number.
    pub untested: Vec<String>,
}

/// Smallest reading of a trial, mm.
pub const MIN_READING_MM: f64 = 0.02;

/// Length of the tool of trials of the tool axis, mm.
const TOOL_MM: f64 = 100.0;

/// Displacements of a line, mm, the smallest that reaches [`MIN_READING_MM`] is taken.
const SHIFTS_MM: [f64; 4] = [0.1, 0.2, 0.5, 1.0];

/// Changes of a component of a direction.
const TILTS: [f64; 4] = [0.001, 0.002, 0.005, 0.01];

/// Angle between the positions of a rotary axis that are tried, deg.
const ANGLE_STEP: f64 = 15.0;

/// Positions of linear axes that are tried, as fractions of the travel; the middle comes first.
const FRACTIONS: [f64; 3] = [0.5, 0.25, 0.75];

/// Readings that differ by less than this (mm) count as equal.
const EQUAL_MM: f64 = 1e-4;

/// Component of a direction above which a change of it turns nothing.
const ALONG: f64 = 0.9;

/// A part with the property of it that a trial changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Displaced {
    Point(MachinePart),
    Direction(MachinePart),
}

impl Parameters {
    /// Returns a trial for the point and one for the direction of each line and of the tool, of those that numbers
    /// place.
    pub fn sign_trials(&self, machine: &Machine) -> SignTrials {
        let parts = [
            MachinePart::TableFirst,
            MachinePart::TableSecond,
            MachinePart::HeadFirst,
            MachinePart::HeadSecond,
            MachinePart::Tool,
        ];
        let all = parts.into_iter().flat_map(|part| [Displaced::Point(part), Displaced::Direction(part)]);
        let trials: Vec<SignTrial> = all.filter_map(|displaced| self.trial_of(machine, displaced)).collect();
        let tested = |name: &String| trials.iter().flat_map(|trial| &trial.changes).any(|change| change.name == *name);
        let vectors = self.rules.parameters.iter().map(|vector| vector.names().iter().flatten());
        let untested = vectors.filter(|names| !names.clone().any(tested)).filter_map(|mut names| names.next().cloned());
        SignTrials { untested: untested.collect(), trials }
    }

    /// Returns the trial with the largest reading, by the smallest change that reaches [`MIN_READING_MM`].
    fn trial_of(&self, machine: &Machine, displaced: Displaced) -> Option<SignTrial> {
        let sizes = match displaced {
            Displaced::Point(_) => SHIFTS_MM,
            Displaced::Direction(_) => TILTS,
        };
        let poses = trial_poses(machine, self.nominal.axis_of(displaced.part()), displaced);
        sizes.into_iter().find_map(|size| {
            let trials = (0..3).flat_map(|k| self.trials_along(machine, Change { displaced, size, k }, &poses));
            let found = trials.reduce(|best, other| if better(&other, &best) { other } else { best })?;
            (found.reading_mm.abs() >= MIN_READING_MM).then_some(found)
        })
    }

    /// Returns the trials of one change: one for each pose and linear axis.
    fn trials_along(&self, machine: &Machine, change: Change, poses: &[Pose]) -> Vec<SignTrial> {
        let Some(moved) = self.nominal.displaced(change) else { return Vec::new() };
        let (old, new) = (self.rules.numbers(&self.nominal), self.rules.numbers(&moved));
        let offsets = self.rules.offsets();
        let written = |i: usize| {
            let (scale, decimals) = step(self.increment, offsets[i]);
            let text = decimal_text((new[i] - old[i]) * scale, decimals);
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        };
        let differs = |i: &usize| (new[*i] - old[*i]).abs() > 0.1 * change.size;
        let changes: Vec<NumberChange> = (0..old.len())
            .filter(differs)
            .map(|i| NumberChange { name: self.names()[i].to_owned(), by: written(i) })
            .collect();
        if changes.is_empty() {
            return Vec::new();
        }
        let after = self.rules.transformation(&self.nominal, &new);
        let tool_length_mm = (change.displaced.part() == MachinePart::Tool).then_some(TOOL_MM);
        let reading = |pose: &Pose| {
            let mut block = programmed_block(machine, false, pose);
            if let Some(length) = tool_length_mm {
                block.tool = block.nominal_axis * -length;
            }
            let [before, after] = [&self.nominal, &after].map(|control| control.command(&block));
            before.iter().zip(&after).map(|(before, after)| after - before).collect::<Vec<f64>>()
        };
        let readings = poses.iter().flat_map(|pose| {
            let (turned, unturned) = (reading(pose), reading(&unturned(machine, pose)));
            self.nominal.linear.map(|axis| SignTrial {
                changes: changes.clone(),
                pose: pose.clone(),
                tool_length_mm,
                axis,
                reading_mm: turned[axis],
                unturned_mm: unturned[axis],
            })
        });
        readings.collect()
    }
}

/// A change of one component.
#[derive(Debug, Clone, Copy)]
struct Change {
    displaced: Displaced,
    size: f64,
    k: usize,
}

impl Displaced {
    fn part(self) -> MachinePart {
        match self {
            Self::Point(part) | Self::Direction(part) => part,
        }
    }
}

impl Transformation {
    fn axis_of(&self, part: MachinePart) -> Option<usize> {
        self.line(part).map(|line| line.axis)
    }

    /// Returns the transformation with a displaced part; `None` if the machine has no such part, or the change turns
    /// nothing.
    fn displaced(&self, Change { displaced, size, k }: Change) -> Option<Self> {
        let mut moved = self.clone();
        let by = Vector3::from_fn(|i, _| if i == k { size } else { 0.0 });
        match displaced {
            Displaced::Point(part) => moved.line_mut(part)?.point += by,
            Displaced::Direction(MachinePart::Tool) => {
                moved.tool = Some(moved.tool).filter(|tool| tool[k].abs() < ALONG)? + by;
            }
            Displaced::Direction(part) => {
                let line = moved.line_mut(part).filter(|line| line.direction[k].abs() < ALONG)?;
                line.direction += by;
            }
        }
        Some(moved)
    }
}

/// True if the first trial is to be preferred: a larger reading, then fewer changes; the first of equal ones stands.
fn better(one: &SignTrial, than: &SignTrial) -> bool {
    let more = one.reading_mm.abs() - than.reading_mm.abs();
    more > EQUAL_MM || (more > -EQUAL_MM && one.changes.len() < than.changes.len())
}

/// Returns blocks that turn one rotary axis alone, those with small positive angles first. A trial of a point needs one
/// place of the linear axes; the reading of a direction depends on it.
fn trial_poses(machine: &Machine, turned: Option<usize>, displaced: Displaced) -> Vec<Pose> {
    let rest = |fractions: [f64; 3]| -> Pose {
        let mut linear = fractions.into_iter();
        let of = |axis: &crate::machine::Axis| {
            let (min, max) = axis.travel.interval();
            match axis.kind {
                AxisKind::Linear => libm::round(min + (max - min) * linear.next().unwrap_or(0.5)).clamp(min, max),
                AxisKind::Rotary => 0.0_f64.clamp(min, max),
            }
        };
        machine.axes().iter().map(of).collect()
    };
    let places: Vec<Pose> = match displaced {
        Displaced::Direction(part) if part != MachinePart::Tool => FRACTIONS
            .iter()
            .flat_map(|x| FRACTIONS.iter().flat_map(move |y| FRACTIONS.iter().map(move |z| rest([*x, *y, *z]))))
            .collect(),
        _ => vec![rest([0.5; 3])],
    };
    let Some(axis) = turned else { return places };
    let (min, max) = machine.axes()[axis].travel.interval();
    let count = libm::floor(180.0 / ANGLE_STEP) as i32;
    let angles = (1..=count).flat_map(|n| [f64::from(n) * ANGLE_STEP, f64::from(-n) * ANGLE_STEP]);
    let angles = angles
        .filter(|angle| (min..=max).contains(angle))
        .chain([min, max].into_iter().filter(|end| end.abs() < 180.0));
    let turned = |angle: f64| {
        places.iter().map(move |place| {
            let mut pose = place.clone();
            pose[axis] = angle;
            pose
        })
    };
    angles.flat_map(turned).collect()
}

/// Returns the block with the rotary axes at 0, or as near as their travels let them.
fn unturned(machine: &Machine, pose: &[f64]) -> Pose {
    let of = |(axis, q): (&crate::machine::Axis, &f64)| {
        let (min, max) = axis.travel.interval();
        if axis.kind == AxisKind::Linear { *q } else { 0.0_f64.clamp(min, max) }
    };
    machine.axes().iter().zip(pose).map(of).collect()
}
