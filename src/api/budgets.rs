//! Budgets of several machines on the same work.

use super::tolerances::{ClassSource, ToleranceOptions};
use crate::analysis::budget::{
    Bound, BoundedError, Budget, PairedTest, Request, Verdict, VersusFirst, budget, round_sizes, side_by_side,
};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Machine, Pose};
use crate::report::{BudgetReport, DrawSettings, budgets_json};
use crate::run::{Call, Refused};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// Draws of machines.
#[derive(Clone, Copy)]
pub(crate) struct DrawnMachines<'a> {
    pub tolerances: &'a ToleranceOptions,
    /// Names of the files of the machines.
    pub files: &'a [&'a str],
    /// Number in the first round.
    pub samples: usize,
    /// Limit of the rounds.
    pub max_samples: usize,
    pub seed: u64,
}

/// A budget for each machine, and the contribution of each error to each. Serialises as docs/formats.md describes.
#[derive(Debug, Clone)]
pub struct ComparedBudgets {
    machines: Vec<Machine>,
    poses: usize,
    /// Name and source of the class of each machine.
    pub classes: Vec<Option<(String, String)>>,
    /// The bounds of each machine.
    pub bounds: Vec<Vec<Bound>>,
    /// The budget of each machine.
    pub budgets: Vec<Budget>,
    /// The 95 % value of the position of each machine but the first, minus that of the first.
    pub versus_first: Vec<VersusFirst>,
    /// Number of machines that are drawn at most, if the first ones do not tell the machines apart.
    pub max_samples: usize,
    /// Error by error, largest first.
    pub errors: Vec<BoundedError>,
    /// Settings of the draws.
    pub drawing: DrawSettings,
}

impl Serialize for ComparedBudgets {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.contract().serialize(serializer)
    }
}

impl ComparedBudgets {
    fn contract(&self) -> Value {
        let (poses, drawing) = (self.poses, &self.drawing);
        let sides = self.machines.iter().zip(self.bounds.iter().zip(&self.budgets));
        let reports: Vec<BudgetReport<'_>> =
            sides.map(|(machine, (bounds, budget))| BudgetReport { machine, bounds, budget, poses, drawing }).collect();
        let mut json = budgets_json(&reports, &self.errors);
        if let Some(object) = json.as_object_mut() {
            object.extend(drawing.json());
            let _ = object.insert("max_samples".to_owned(), self.max_samples.into());
            let _ = object.insert("versus_first_p95_um".to_owned(), serde_json::json!(self.versus_first));
        }
        for (machine, class) in json["machines"].as_array_mut().into_iter().flatten().zip(&self.classes) {
            let (name, source) = class.clone().unzip();
            (machine["class"], machine["class_source"]) = (json!(name), json!(source));
        }
        json
    }
}

/// Returns the budgets, each at the poses of its machine for the same work; none if not every machine has one.
pub(crate) fn budgets(
    call: &mut Call<'_>,
    sides: &[(&Machine, Vec<Pose>)],
    drawn: DrawnMachines<'_>,
) -> Result<Option<ComparedBudgets>, Refused> {
    let mut all = Vec::new();
    let mut classes: Vec<Option<ClassSource>> = Vec::new();
    for ((machine, _), file) in sides.iter().zip(drawn.files) {
        let (bounds, of) = call.about(file, |call| drawn.tolerances.bounds_if_any(call, machine))?;
        classes.push(of);
        all.push(bounds);
    }
    if all.iter().all(Vec::is_empty) || sides.iter().any(|(_, poses)| poses.is_empty()) {
        return Ok(None);
    }
    let without = drawn.files.iter().zip(&all).filter(|(_, bounds)| bounds.is_empty());
    let without: Vec<String> = without.map(|(file, _)| format!("`{}`", shown(file))).collect();
    if !without.is_empty() {
        let message = format!("budgets are not compared: {} bounds no error", without.join(" and "));
        let help = "write tolerances into every file, or take those of a class: `--class production`";
        call.warn(Diagnostic::new(codes::W0607, message).help(help));
        call.checked()?;
        return Ok(None);
    }
    let (list, versus_first) = budgeted(call, sides, &all, drawn);
    let common = classes.iter().all(|class| *class == classes[0]).then(|| classes[0].clone()).flatten();
    let pairs: Vec<(&[Bound], &Budget)> = all.iter().map(Vec::as_slice).zip(&list).collect();
    let samples = list.first().map_or(drawn.samples, |budget| budget.position.drawn.len());
    Ok(Some(ComparedBudgets {
        machines: sides.iter().map(|(machine, _)| (*machine).clone()).collect(),
        poses: sides.first().map_or(0, |(_, poses)| poses.len()),
        errors: side_by_side(&pairs),
        bounds: all,
        budgets: list,
        versus_first,
        max_samples: drawn.max_samples.max(drawn.samples),
        drawing: drawn.tolerances.drawing(common, samples, drawn.seed),
        classes,
    }))
}

/// Draws machines in rounds until all are told apart from the first, or the limit is reached.
fn budgeted(
    call: &Call<'_>,
    sides: &[(&Machine, Vec<Pose>)],
    bounds: &[Vec<Bound>],
    drawn: DrawnMachines<'_>,
) -> (Vec<Budget>, Vec<VersusFirst>) {
    let (draws, statistic) = (drawn.tolerances.draws(drawn.seed), drawn.tolerances.statistic);
    let sizes = round_sizes(drawn.samples, drawn.max_samples);
    let mut last = (Vec::new(), Vec::new());
    for samples in sizes.iter().copied() {
        let list: Vec<Budget> = call.stage(2 * samples * sides.len(), |advance| {
            let one = |((machine, poses), bounds): (&(&Machine, Vec<Pose>), &Vec<Bound>)| {
                budget(
                    Request { machine, bounds, poses, searched: false, at: None, draws: &draws, samples, statistic },
                    advance,
                )
            };
            sides.iter().zip(bounds).map(one).collect()
        });
        let test = PairedTest::of_round(samples, list.len(), sizes.len());
        let values: Vec<&[f64]> = list.iter().map(|budget| budget.position.drawn.as_slice()).collect();
        let versus: Vec<VersusFirst> = values.iter().skip(1).map(|of| test.versus(of, values[0])).collect();
        let open = versus.iter().any(|versus| versus.verdict == Verdict::NotToldApart);
        last = (list, versus);
        if !open {
            break;
        }
    }
    last
}
