//! The cheapest tolerances for a goal.

use super::budget::BudgetOptions;
use crate::analysis::budget::{
    Binding, Bound, CheapestTolerances, CostModel, GoalAnswer, GoalRequest, Price, cheapest,
};
use crate::diagnostic::{Diagnostic, Reason, codes, shown};
use crate::machine::{ErrorKind, Machine, Pose};
use crate::report::tolerance_unit;
use crate::run::{Call, Refused};
use crate::syntax::{from_yaml, read_text};
use crate::units::significant;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use std::path::Path;

/// Minimum number of machines drawn for the search.
const MIN_SEARCHED: usize = 2000;

/// Minimum number of machines drawn for the proof.
const MIN_PROOF: usize = 8000;

/// Seeds of the correction and of the proof, from that of the search.
const NEXT_SEEDS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xD1B5_4A32_D192_ED03];

/// Tolerances for a goal. Serialises as docs/formats.md describes.
#[derive(Debug, Clone)]
pub struct ToleranceGoal {
    /// The goal of the 95 % value, um.
    pub goal_um: f64,
    /// Number of machines drawn for the proof.
    pub proof_samples: usize,
    /// Exponent of the tolerance in the cost.
    pub power: f64,
    /// The new tolerances, those of the largest part in the 95 % value first.
    pub tolerances: Vec<NewTolerance>,
    /// The whole of the result, in the order of the bounds.
    pub cheapest: CheapestTolerances,
}

/// The old and the new tolerance of an error.
#[derive(Debug, Clone, PartialEq)]
pub struct NewTolerance {
    /// The error with its old tolerance.
    pub old: Bound,
    /// The error with its new tolerance.
    pub new: Bound,
    /// The kind by which it is paid for.
    pub kind: ErrorKind,
    /// The limit that holds it, if one does.
    pub binding: Binding,
    /// Its part of the 95 % value, um.
    pub part_um: f64,
    /// Its weight in the cost.
    pub weight: f64,
    /// Its cost, old and new.
    pub cost: [f64; 2],
}

impl Serialize for ToleranceGoal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.contract().serialize(serializer)
    }
}

impl ToleranceGoal {
    fn contract(&self) -> Value {
        let CheapestTolerances { cost, cost_per_um, before, proof, staying_um, steps, .. } = &self.cheapest;
        let tolerance = |of: &NewTolerance| {
            json!({
                "error": of.old.to_string(), "kind": of.kind, "unit": tolerance_unit(&of.old.error),
                "old": crate::report::tolerance(&of.old), "new": crate::report::tolerance(&of.new),
                "binds": of.binding, "um_of_p95": of.part_um, "weight": of.weight,
                "cost_before": of.cost[0], "cost_after": of.cost[1],
            })
        };
        json!({
            "goal_um": self.goal_um, "before_um": before, "proof_um": proof, "proof_samples": self.proof_samples,
            "staying_um": staying_um, "steps": steps,
            "cost": {"power": self.power, "before": cost[0], "after": cost[1], "per_um": cost_per_um},
            "tolerances": self.tolerances.iter().map(tolerance).collect::<Vec<_>>(),
        })
    }
}

/// Returns the cheapest tolerances for the goal of the options (mm).
pub(crate) fn goal(
    call: &mut Call<'_>,
    machine: &Machine,
    options: &BudgetOptions,
    (bounds, poses): (&[Bound], &[Pose]),
    goal_mm: f64,
) -> Result<ToleranceGoal, Refused> {
    if !(goal_mm > 0.0 && goal_mm.is_finite()) {
        return call.usage("`--goal` is a length above 0, such as `30 um`");
    }
    let model = match &options.cost {
        Some(path) => read(call, path)?,
        None => CostModel::default(),
    };
    let prices = match (model.prices(machine, bounds), &options.cost) {
        (Ok(prices), _) => prices,
        (Err(failure), path) => {
            let name = path.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
            return call.refuse(refused(&name, &failure));
        }
    };
    let tolerances = &options.tolerances;
    let [first, second, third] = [0, NEXT_SEEDS[0], NEXT_SEEDS[1]].map(|by| tolerances.draws(options.seed ^ by));
    let proof_samples = options.samples.max(MIN_PROOF);
    let request = GoalRequest {
        machine,
        bounds,
        prices: &prices,
        power: model.power,
        poses,
        draws: [&first, &second, &third],
        samples: options.samples.max(MIN_SEARCHED),
        proof_samples,
        statistic: tolerances.statistic,
        goal_mm,
    };
    match call.stage(1, |_| cheapest(request)) {
        GoalAnswer::Kept(found) => Ok(ToleranceGoal {
            goal_um: goal_mm * 1e3,
            proof_samples,
            power: model.power,
            tolerances: in_order(bounds, &prices, model.power, &found),
            cheapest: *found,
        }),
        GoalAnswer::OutOfReach(left) => {
            let um = |um: f64| format!("{} um", significant(um, 4));
            let message = format!(
                "the goal of {} is out of reach: {} are left with every tolerance at its finest",
                um(goal_mm * 1e3),
                um(left.finest_um)
            );
            let staying = if left.staying_um > 0.0 {
                format!("the errors that have values stay, with {} by themselves: correct them; ", um(left.staying_um))
            } else {
                String::new()
            };
            let help =
                format!("{staying}allow finer tolerances (`finest` in `--cost`), or set a goal above what is left");
            call.refuse(Diagnostic::new(codes::E0614, message).help(help))
        }
    }
}

fn in_order(bounds: &[Bound], prices: &[Price], power: f64, found: &CheapestTolerances) -> Vec<NewTolerance> {
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|a, b| found.parts_um[*b].total_cmp(&found.parts_um[*a]).then(a.cmp(b)));
    let one = |i: usize| {
        let (old, price, tolerance) = (&bounds[i], &prices[i], found.tolerances[i]);
        NewTolerance {
            old: old.clone(),
            new: Bound { tolerance, ..old.clone() },
            kind: price.kind,
            binding: found.binding[i],
            part_um: found.parts_um[i],
            weight: price.weight,
            cost: [price.cost(old.tolerance, power), price.cost(tolerance, power)],
        }
    };
    order.into_iter().map(one).collect()
}

/// Reads a cost model.
fn read(call: &mut Call<'_>, path: &Path) -> Result<CostModel, Refused> {
    let files = call.run.files;
    let Some((_, text)) = read_text(path, None, files, &mut call.diagnostics) else { return Err(Refused) };
    let written = from_yaml::<CostModel>(&text).map_err(Reason::new);
    match written.and_then(CostModel::validate) {
        Ok(model) => Ok(model),
        Err(failure) => call.refuse(refused(&path.display().to_string(), &failure)),
    }
}

fn refused(name: &str, failure: &Reason) -> Diagnostic {
    let message = format!("`{}`: {}", shown(name), shown(&failure.to_string()));
    let help = "a cost model has `power`, `weights`, `finest` and `coarsest`; docs/budget.md has an example";
    Diagnostic::new(codes::E0615, message).help(help)
}
