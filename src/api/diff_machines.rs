//! `diff` of two machine files: what differs, and what each difference does to the deviations.

use super::compare::nothing_in_common;
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::{ActingErrors, Bound, Request, adding, bounds, budget, is_measured};
use crate::analysis::{Comparison, MachineResult, Work, compare};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::{Bare, Field, Order, quantile_95};
use crate::job::job_file::{Job, JobPaths};
use crate::job::machine_file::{MachineFile, order_of, sources_of};
use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::job::reference::{Reference, ReferenceKind, SetUp, unzeroed};
use crate::job::reference_text::ReferenceOption;
use crate::machine::{Approach, Machine, MachineProperty, Pose, UnheldMotion};
use crate::report::{MachineDifference, describe};
use crate::run::{Call, Count, Refused, Reply, Run};
use rayon::prelude::*;
use std::path::PathBuf;

/// Options of [`diff_machines`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct DiffMachinesOptions {
    /// Number of tool poses, drawn from the volume of the first machine.
    pub poses: usize,
    /// A file of tool poses instead; rotary columns are those of the first machine.
    pub tool_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the deviations; by default the zero at the part's origin for tool
    /// poses, nothing for a volume.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Seed of the tool poses.
    pub seed: u64,
    /// Order of the errors; exact by default, unless the conventions of a machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
}

impl DiffMachinesOptions {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths { job: self.job.as_deref(), tool_poses: self.tool_poses.as_deref(), axis_poses: None, path: self.path }
    }
}

impl Default for DiffMachinesOptions {
    fn default() -> Self {
        let (tool_poses, job, path, reference) = (None, None, None, None);
        Self { poses: 1000, tool_poses, job, path, reference, seed: 1, order: None, approach: Approach::default() }
    }
}

/// Compares two machines property by property, and states the effect of each difference on the 95 % position
/// deviation over tool poses that both reach: where a machine bounds errors, on the 95 % value of machines drawn, in
/// which errors with values act.
///
/// Fails if the files are not two, and if no tool pose is reached by both machines.
pub fn diff_machines(files: &[MachineFile], options: &DiffMachinesOptions, run: Run<'_>) -> Reply<MachineDifference> {
    Call::answer(run, &sources_of(files), |call| {
        options.job_paths().with_tools(call, files, |call, files| difference(call, files, options))
    })
}

fn difference(
    call: &mut Call<'_>,
    files: &[MachineFile],
    options: &DiffMachinesOptions,
) -> Result<MachineDifference, Refused> {
    let [first, second] = files else { return call.usage("`diff` takes two machines") };
    call.check_counts(&[Count::Poses(options.poses)])?;
    let properties = first.differences(second);
    let paths = options.job_paths();
    let job = paths.read_common(call, files)?;
    let judge = Judge::of(call, [first, second], options, job.as_ref())?;
    let mixtures = |hangs: &dyn Fn(&MachineProperty) -> bool| -> Vec<(&MachineProperty, Machine)> {
        let some = properties.iter().filter(|property| hangs(property));
        let mixed = some.filter_map(|property| Some((property, first.with_property_of(second, property)?)));
        mixed.filter(|(_, machine)| judge.is_set_up(machine)).collect()
    };
    let single = mixtures(&|property| judge.hangs_on(property));
    let travels = mixtures(&|property| matches!(property, MachineProperty::Travel(_)));
    let both = [&**first, &**second];
    let work = match &job {
        Some(job) => job.poses.work(first),
        None => Work::random(first, options.poses, options.seed),
    };
    let found = judge.compare(call, &both, &work)?;
    if found.common.is_empty() {
        return call.refuse(nothing_in_common(files, &found));
    }
    let mut paths = Vec::new();
    if let Some(job) = &job {
        for (file, side) in files.iter().zip(&found.machines) {
            let path = side.path.as_ref().map(|events| PathResult::new(file, events, &job.poses.lines()));
            call.about(file.path(), |call| call.extend(path.as_ref().and_then(|path| path.warning(file))));
            paths.extend(path);
        }
        call.check()?;
    }
    // Mixtures that reach most of the common work are judged on what all of these reach; any other, on what it reaches
    // itself: it must not leave the machines without a difference.
    let (asked, common) = (found.asked, Work::listed(found.common.clone(), work.is_path()));
    let (mut wide, mut narrow) = (Vec::new(), Vec::new());
    for (property, machine) in &single {
        let reached = judge.compare(call, &[&both[..], &[machine]].concat(), &common)?.common.len();
        let list = if reached as f64 >= WIDE * common.len() as f64 { &mut wide } else { &mut narrow };
        list.push((*property, machine));
    }
    let machines: Vec<&Machine> = both.into_iter().chain(wide.iter().map(|(_, machine)| *machine)).collect();
    let found = judge.compare(call, &machines, &common)?;
    let mut p95s = Vec::new();
    for (machine, side) in machines.iter().zip(&found.machines) {
        p95s.push(judge.p95_um(call, machine, side)?);
    }
    let place = |property: &MachineProperty| wide.iter().position(|(known, _)| *known == property).map(|i| i + 2);
    let covered = |i: &usize| covers(machines[*i], &found.machines[*i]);
    // Everything but the chain itself is judged on the chain of the second.
    let base = place(&MachineProperty::Chain).filter(covered).unwrap_or(0);
    let mut effects = Vec::new();
    for property in &properties {
        let from = if *property == MachineProperty::Chain { 0 } else { base };
        let alone = narrow.iter().find(|(known, _)| *known == property);
        let travel = travels.iter().find(|(known, _)| *known == property);
        effects.push(match (place(property).filter(covered), alone, travel) {
            (Some(i), ..) => Some(p95s[i] - p95s[from]),
            (None, Some((_, machine)), _) => judge.difference_um(call, machines[from], machine, &common, false)?,
            (None, None, Some((_, machine))) if base > 0 || !properties.contains(&MachineProperty::Chain) => {
                judge.difference_um(call, machines[base], machine, &common, true)?
            }
            _ => None,
        });
    }
    let described = properties.iter().zip(effects);
    Ok(MachineDifference {
        machines: [first, second].map(|file| file.name().to_owned()),
        files: [first, second].map(|file| file.path().to_owned()),
        over: Over::common(first, &judge.reference, job.as_ref().map(|job| &job.poses), [asked, found.common.len()]),
        paths,
        asked,
        poses: found.common.len(),
        seed: options.seed,
        from: judge.bounded.then_some("bounds"),
        p95_um: [p95s[0], p95s[1]],
        minus_first_um: p95s[1] - p95s[0],
        differences: described.map(|(property, effect)| describe(first, second, property, effect)).collect(),
    })
}

/// Fraction of the common work from which on a mixture of both machines is judged together with the others.
const WIDE: f64 = 0.9;

/// Number of machines drawn where the machines are bounded.
const SAMPLES: usize = 1000;

/// The figure by which machines are judged: by their errors with values, or by machines drawn between bounds, in which
/// these act, where one of the two has bounds.
struct Judge<'a> {
    options: &'a DiffMachinesOptions,
    bounded: bool,
    /// Motion that the part's set-up takes out of each machine.
    reference: Reference,
    /// Motions that the data behind the errors of one of the machines do not hold.
    unheld: Vec<UnheldMotion>,
}

impl<'a> Judge<'a> {
    /// Returns the judge of two machines, for which the part is set up by one reference. Where one of them does not
    /// reach the default, both are in machine coordinates.
    fn of(
        call: &mut Call<'_>,
        files: [&MachineFile; 2],
        options: &'a DiffMachinesOptions,
        job: Option<&Job>,
    ) -> Result<Self, Refused> {
        let stated = Job::stated(job, options.reference.as_ref());
        let bounded = files.iter().any(|file| !bounds_of(file).is_empty());
        if let Some(unlike) = unlike(files) {
            call.warn(unlike);
            call.check()?;
        }
        let default = job.map_or_else(Reference::default, Job::zero);
        let is_stated = stated.is_some();
        let unheld = files.iter().flat_map(|file| file.unheld()).copied().collect();
        let mut judge = Self { options, bounded, reference: stated.unwrap_or(default), unheld };
        let is_fitted = judge.reference.kind == ReferenceKind::BestFit;
        for file in files.into_iter().filter(|_| !is_fitted) {
            match judge.set_up(file, &[]) {
                Ok(set_up) => judge.reference.kind = set_up.reference.kind,
                Err(refusal) if is_stated => {
                    let refusal = Job::located(job, options.reference.as_ref(), refusal);
                    return call.about(file.path(), |call| call.refuse(refusal));
                }
                Err(reason) => {
                    call.about(file.path(), |call| call.warn(unzeroed(&reason)));
                    call.check()?;
                    return Ok(Self { reference: Reference::default(), ..judge });
                }
            }
        }
        Ok(judge)
    }

    /// True if a mixture of the machines reaches the point of the reference.
    fn is_set_up(&self, machine: &Machine) -> bool {
        self.reference.kind == ReferenceKind::BestFit || self.set_up(machine, &[]).is_ok()
    }

    /// Returns the set-up of the part on a machine; fits are over the poses (mm, deg).
    fn set_up(&self, machine: &Machine, poses: &[Pose]) -> Result<SetUp, Diagnostic> {
        SetUp::without(machine, &self.reference, &self.unheld, poses)
    }

    /// True if a figure depends on a property. A travel counts by itself, where other poses are taken within it: it
    /// must not change the work of the others.
    fn hangs_on(&self, property: &MachineProperty) -> bool {
        match property {
            MachineProperty::Travel(_) | MachineProperty::Controller(_) | MachineProperty::Home(_) => false,
            MachineProperty::Class | MachineProperty::Tolerances => self.bounded,
            _ => true,
        }
    }

    fn compare(&self, call: &Call<'_>, machines: &[&Machine], work: &Work) -> Result<Comparison, Refused> {
        let bare: Vec<Bare<'_>> =
            machines.iter().map(|machine| Bare { machine, order: order_of(machine, self.options.order) }).collect();
        let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
        call.stage("poses", work.len(), |advance| compare(&fields, work, self.options.approach.into(), advance))
    }

    /// Returns the 95 % position deviation (um) at the poses of a machine, or the 95 % value of machines drawn.
    fn p95_um(&self, call: &mut Call<'_>, machine: &Machine, side: &MachineResult) -> Result<f64, Refused> {
        let poses: Vec<Pose> = side.reached.iter().map(|(pose, _)| pose.clone()).collect();
        let set_up = self.set_up(machine, &poses).or_else(|refusal| call.refuse(refusal))?;
        if !self.bounded {
            let (order, conditions) = (order_of(machine, self.options.order), self.options.approach.into());
            let bare = Bare { machine, order };
            let Some(field) = set_up.field(&bare, order, conditions) else {
                return Ok(side.statistics.position_um.p95);
            };
            let um = |pose: &Pose| field.deviation(&conditions.at_pose(pose)).position.norm() * 1e3;
            return Ok(quantile_95(&mut poses.par_iter().map(um).collect::<Vec<_>>()));
        }
        set_up.refuse_minimum_zone(call, "a difference of bounds")?;
        let bounds = bounds_of(machine);
        if bounds.is_empty() && !is_measured(machine) {
            return Ok(0.0);
        }
        let tolerances = ToleranceOptions::default();
        let (draws, statistic) = (tolerances.draws(self.options.seed), tolerances.statistic);
        let request = Request {
            machine,
            acting: ActingErrors::OfMachine,
            bounds: &bounds,
            poses: &poses,
            reference: set_up.removed(),
            searched: false,
            at: None,
            draws: &draws,
            samples: SAMPLES,
            statistic,
        };
        let found = call.stage("machines drawn", 2 * SAMPLES, |advance| budget(request, advance))?;
        Ok(found.position.percentile(95).value)
    }

    /// Returns the figure of a mixture minus that of the machine it is made from, on the tool poses that both reach;
    /// none without such, nor of a travel within which both take them by the same poses.
    fn difference_um(
        &self,
        call: &mut Call<'_>,
        from: &Machine,
        mixture: &Machine,
        work: &Work,
        of_travel: bool,
    ) -> Result<Option<f64>, Refused> {
        let found = self.compare(call, &[from, mixture], work)?;
        if found.common.is_empty() || !covers(mixture, &found.machines[1]) {
            return Ok(None);
        }
        if of_travel && is_same(&found.machines[0], &found.machines[1]) {
            return Ok(None);
        }
        let [from, mixture] = [(from, &found.machines[0]), (mixture, &found.machines[1])];
        Ok(Some(self.p95_um(call, mixture.0, mixture.1)? - self.p95_um(call, from.0, from.1)?))
    }
}

/// Remarks a machine of which nothing is measured beside one without bounds.
fn unlike(files: [&MachineFile; 2]) -> Option<Diagnostic> {
    let is_designed = |file: &MachineFile| !is_measured(file) && !bounds_of(file).is_empty();
    let is_whole = |file: &MachineFile| is_measured(file) && bounds_of(file).is_empty();
    let designed = files.into_iter().find(|file| is_designed(file))?;
    let measured = files.into_iter().find(|file| is_whole(file))?;
    let message = format!(
        "`{}` is measured and `{}` only bounded: the difference is of one machine and of 95 % of machines",
        shown(measured.path()),
        shown(designed.path())
    );
    Some(Diagnostic::new(codes::W0607, message).help("compare designs with designs, and measured machines with such"))
}

fn bounds_of(machine: &Machine) -> Vec<Bound> {
    adding(machine, &bounds(machine, machine.class().map(|named| &named.class)))
}

/// Axes of one pose are less than this apart, mm or deg.
const SAME: f64 = 1e-6;

/// True if both take their tool poses by the same poses of their axes.
fn is_same(a: &MachineResult, b: &MachineResult) -> bool {
    let alike = |(a, b): (&f64, &f64)| (a - b).abs() < SAME;
    a.reached.iter().zip(&b.reached).all(|((a, _), (b, _))| a.iter().zip(b).all(alike))
}

/// True if every error curve is defined at the poses.
fn covers(machine: &Machine, side: &MachineResult) -> bool {
    side.reached.iter().all(|(pose, _)| machine.outside(pose).is_none())
}
