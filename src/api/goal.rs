//! The cheapest tolerances for a goal.

use super::tolerances::ToleranceOptions;
use crate::analysis::budget::{
    Binding, Bound, CheapestTolerances, CostModel, GoalAnswer, GoalRequest, Percentile, Price, cheapest,
};
use crate::analysis::reference::PartReference;
use crate::diagnostic::{Diagnostic, Reason, codes, shown};
use crate::machine::{ErrorKind, Machine, Pose};
use crate::report::tolerance_unit;
use crate::run::{Call, Refused};
use crate::syntax::{from_yaml, read_text};
use crate::units::significant;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Minimum number of machines drawn for the search.
const MIN_SEARCHED: usize = 2000;

/// Minimum number of machines drawn for the proof.
const MIN_PROOF: usize = 100_000;

/// Seeds of the correction and of the proof, from that of the search.
const NEXT_SEEDS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xD1B5_4A32_D192_ED03];

/// How tolerances are searched for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalInputs<'a> {
    /// A file of costs.
    pub cost: Option<&'a Path>,
    /// True if tolerances may become coarser than they are.
    pub loosen: bool,
    pub tolerances: &'a ToleranceOptions,
    pub samples: usize,
    /// Number of machines of a default run.
    pub default_samples: usize,
    pub seed: u64,
}

/// The cheapest tolerances for a goal.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ToleranceGoal {
    /// The goal of the 95 % value, um.
    pub goal_um: f64,
    /// The 95 % value with the old tolerances, um, by the machines of the search.
    pub before_um: Percentile,
    /// The 95 % value with the new tolerances, um, of machines drawn anew.
    pub proof_um: Percentile,
    /// Number of machines of the proof.
    pub proof_samples: usize,
    /// The 95 % value of what no tolerance of the cost model changes, um.
    pub staying_um: f64,
    /// Number of steps of the search.
    pub steps: usize,
    /// The cost.
    pub cost: GoalCost,
    /// The tolerances, those of the largest part in the 95 % value first.
    pub tolerances: Vec<GoalTolerance>,
}

/// The cost of tolerances.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GoalCost {
    /// Its unit.
    pub unit: String,
    /// Power of the tolerance in the cost; none where the cost is relative to the present tolerances, weight x
    /// (present / new - 1).
    pub power: Option<f64>,
    /// Value with the old tolerances.
    pub before: f64,
    /// Value with the new tolerances.
    pub after: f64,
    /// Cost of lowering the 95 % value by one um; none if no tolerance is free.
    pub per_um: Option<f64>,
}

/// A tolerance for a goal.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GoalTolerance {
    /// Name of the error.
    pub error: String,
    /// The kind by which it is paid for.
    pub kind: ErrorKind,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Before, in `unit`.
    pub old: f64,
    /// After, in `unit`.
    pub new: f64,
    /// The limit that holds it.
    pub binds: Binding,
    /// Its part of the 95 % value, um.
    pub um_of_p95: f64,
    /// Its weight in the cost.
    pub weight: f64,
    /// Its cost before.
    pub cost_before: f64,
    /// Its cost after.
    pub cost_after: f64,
}

/// Returns the cheapest tolerances for the goal of the options (mm).
pub(crate) fn goal(
    call: &mut Call,
    machine: &Machine,
    inputs: GoalInputs<'_>,
    (bounds, poses, reference): (&[Bound], &[Pose], Option<&PartReference>),
    goal_mm: f64,
) -> Result<ToleranceGoal, Refused> {
    if !(goal_mm > 0.0 && goal_mm.is_finite()) {
        return call.usage("`--goal` is a length above 0, such as `30 um`");
    }
    let model = match &inputs.cost {
        Some(path) => read(call, path)?,
        None => CostModel::default(),
    };
    let prices = match (model.prices(machine, bounds, inputs.loosen), &inputs.cost) {
        (Ok(prices), _) => prices,
        (Err(failure), path) => {
            let name = path.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
            return call.refuse(refuse(&name, &failure));
        }
    };
    let tolerances = inputs.tolerances;
    let [first, second, third] = [0, NEXT_SEEDS[0], NEXT_SEEDS[1]].map(|by| tolerances.draws(inputs.seed ^ by));
    let proof_samples = inputs.samples.max(MIN_PROOF);
    let request = GoalRequest {
        machine,
        bounds,
        prices: &prices,
        poses,
        reference,
        draws: [&first, &second, &third],
        samples: inputs.samples.max(MIN_SEARCHED),
        default_samples: inputs.default_samples,
        proof_samples,
        statistic: tolerances.statistic,
        goal_mm,
    };
    match call.stage("cheapest tolerances", 1, |_| Ok(cheapest(request)))? {
        GoalAnswer::Kept(found) => Ok(ToleranceGoal {
            goal_um: goal_mm * 1e3,
            before_um: found.before,
            proof_um: found.proof,
            proof_samples,
            staying_um: found.staying_um,
            steps: found.steps,
            cost: GoalCost {
                unit: model.unit().to_owned(),
                power: model.power,
                before: found.cost[0],
                after: found.cost[1],
                per_um: found.cost_per_um,
            },
            tolerances: in_order(bounds, &prices, &found),
        }),
        GoalAnswer::OutOfReach(left) => {
            let um = |um: f64| format!("{} um", significant(um, 4));
            let held = prices.iter().filter(|price| price.held).count();
            let (by, every) = match held {
                0 => (String::new(), "every tolerance"),
                _ => (format!(" by tightening what is not held ({held} are)"), "every other tolerance"),
            };
            let (goal, least) = (um(goal_mm * 1e3), um(left.finest_um));
            let message =
                format!("the goal of {goal} is out of reach{by}: {least} are left with {every} at its finest");
            let staying = if left.staying_um > 0.0 {
                format!("the errors that have values stay, with {} by themselves: correct them; ", um(left.staying_um))
            } else {
                String::new()
            };
            let help = format!(
                "{staying}{}allow finer tolerances (`finest` in `--cost`), or set a goal above what is left",
                if held > 0 { "hold less (`held` in `--cost`), " } else { "" }
            );
            call.refuse(Diagnostic::new(codes::E0614, message).help(help))
        }
    }
}

fn in_order(bounds: &[Bound], prices: &[Price], found: &CheapestTolerances) -> Vec<GoalTolerance> {
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|a, b| found.parts_um[*b].total_cmp(&found.parts_um[*a]).then(a.cmp(b)));
    let one = |i: usize| {
        let (old, price, tolerance) = (&bounds[i], &prices[i], found.tolerances[i]);
        GoalTolerance {
            error: old.to_string(),
            kind: price.kind,
            unit: tolerance_unit(&old.error),
            old: crate::report::tolerance(old),
            new: crate::report::tolerance(&Bound { tolerance, ..old.clone() }),
            binds: found.binding[i],
            um_of_p95: found.parts_um[i],
            weight: price.weight,
            cost_before: price.cost(old.tolerance),
            cost_after: price.cost(tolerance),
        }
    };
    order.into_iter().map(one).collect()
}

fn read(call: &mut Call, path: &Path) -> Result<CostModel, Refused> {
    let files = call.run.files;
    let Some((_, text)) = read_text(path, None, files, &mut call.diagnostics) else { return Err(Refused) };
    let written = from_yaml::<CostModel>(&text).map_err(Reason::new);
    match written.and_then(CostModel::validate) {
        Ok(model) => Ok(model),
        Err(failure) => call.refuse(refuse(&path.display().to_string(), &failure)),
    }
}

fn refuse(name: &str, failure: &Reason) -> Diagnostic {
    let message = format!("`{}`: {}", shown(name), shown(&failure.to_string()));
    let help =
        "a cost model has `weights`, `held`, `finest`, `coarsest`, `unit` and `power`; docs/budget.md has an example";
    Diagnostic::new(codes::E0615, message).help(help)
}
