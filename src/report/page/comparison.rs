//! Two or more machines on the same tool poses.

use super::given::MachineInput;
use crate::analysis::reference::PartReference;
use crate::analysis::{Comparison, ErrorContribution, MachineResult, Work, compare, contributions};
use crate::evaluate::{Bare, Field, Frame, Poses, Statistics};
use crate::job::over::Over;
use crate::machine::{Machine, Pose};
use crate::report::text::BoundedFigures;
use crate::run::unheard;
use serde::Serialize;
use serde_json::{Value, json};

/// Machines side by side; differences are to the first.
#[derive(Debug, Clone, Serialize)]
pub struct ComparisonData {
    asked: usize,
    poses: usize,
    seed: u64,
    over: Over,
    over_line: String,
    /// The file of the tool poses; none if they are drawn.
    file: Option<String>,
    /// The largest of the largest position deviations: the full width of the bars.
    largest_um: f64,
    machines: Vec<Value>,
    /// The errors with the largest effect in any of the machines, one by one.
    errors: Vec<Value>,
    /// The budgets on the same work, as `compare` has them.
    budgets: Value,
}

/// Machines with their poses at the tool poses that all of them reach.
pub type MachinePoses<'a> = Vec<(&'a Machine, Vec<Pose>)>;

/// Returns the effect of the bounds of a machine at its poses for the work, where nothing is measured.
fn of_bounds(given: &MachineInput<'_>, poses: &[Pose], reference: Option<&PartReference>) -> Option<BoundedFigures> {
    let bounded = given.budget().filter(|_| !poses.is_empty())?;
    let found = given.at(bounded, &Poses::Listed(poses.to_vec()), Frame::Workpiece, reference);
    Some(MachineInput::figures(bounded, &found))
}

/// Number of these errors.
const ERRORS: usize = 20;

impl ComparisonData {
    /// Two or more machines on a job, or else at tool poses drawn from the volume of the first.
    pub fn work<'a>(given: &[MachineInput<'a>], job: Option<Work>) -> Option<(Comparison, MachinePoses<'a>)> {
        let first = given.first().filter(|_| given.len() > 1)?;
        let work = job.unwrap_or_else(|| Work::OfPoses(first.sample()));
        let bare: Vec<Bare<'_>> = given.iter().map(|g| Bare { machine: g.machine, order: g.order }).collect();
        let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
        let Ok(comparison) = compare(&fields, &work, first.conditions, &unheard);
        let poses = |c: &MachineResult| c.reached.iter().map(|(pose, _)| pose.clone()).collect();
        let sides = given.iter().zip(&comparison.machines).map(|(g, c)| (g.machine, poses(c))).collect();
        Some((comparison, sides))
    }

    /// Content of the page for them, without what set-ups take out on each; `budgets` is null if there are none.
    pub fn new(
        given: &[MachineInput<'_>],
        comparison: &Comparison,
        sides: &MachinePoses<'_>,
        budgets: Value,
        over: &Over,
        references: &[Option<&PartReference>],
    ) -> Self {
        let bounded = given.iter().zip(sides).zip(references);
        let bounded: Vec<Option<BoundedFigures>> =
            bounded.map(|((given, (_, poses)), reference)| of_bounds(given, poses, *reference)).collect();
        let statistics: Vec<Statistics> = bounded
            .iter()
            .zip(&comparison.machines)
            .map(|(of, c)| of.as_ref().map_or(c.statistics, |of| of.statistics(comparison.common.len())))
            .collect();
        let side = |(i, (g, c)): (usize, (&MachineInput<'_>, &MachineResult))| {
            let (own, first) = (bounded[i].as_ref(), bounded[0].as_ref());
            let minus = (own.is_some() == first.is_some()).then(|| statistics[i].minus(&statistics[0]));
            let bounds = own.map(|own| {
                let mut json = json!(own);
                json["rss_minus_first"] = json!(first.map(|first| own.rss_minus(first)));
                json
            });
            json!({"name": g.machine.name(), "file": g.file, "chain": g.machine.chain().to_string(),
                "unreachable": c.unreachable, "position_um": statistics[i].position_um, "bounds": bounds,
                "rotation_urad": statistics[i].rotation_urad, "minus_first": minus})
        };
        let error = |e: ErrorContribution| {
            let minus: Vec<f64> = (0..e.um.len()).map(|i| e.minus_first(i)).collect();
            json!({"error": e.error, "um": e.um, "minus_first": minus})
        };
        let (conditions, seed) = given.first().map_or_else(Default::default, |first| (first.conditions, first.poses.1));
        Self {
            errors: contributions(sides, conditions, references).into_iter().take(ERRORS).map(error).collect(),
            budgets,
            over: over.clone(),
            over_line: over.line(),
            asked: comparison.asked,
            poses: comparison.common.len(),
            seed,
            file: given.first().and_then(|first| Some(first.work?.1["file"].as_str()?.to_owned())),
            largest_um: statistics.iter().map(|of| of.position_um.max).fold(0.0, f64::max),
            machines: given.iter().zip(&comparison.machines).enumerate().map(side).collect(),
        }
    }
}
