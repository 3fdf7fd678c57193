//! A budget as JSON and as pictures, the same in `budget`, in a comparison and on the page.

use super::positions::positions;
use crate::analysis::budget::{
    Bound, BoundedError, Budget, Contribution, Distribution, PERCENTS, Percentile, Statistic, Totals, known, mean,
};
use crate::machine::{ErrorId, Machine};
use crate::report::pictures::{Bar, ParetoPicture, Picture, WaterfallPicture};
use crate::units::significant;
use serde_json::{Map, Value, json};

/// Settings of the machines drawn for a budget.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawSettings {
    /// The class that bounds what the machine file does not, and its source.
    pub class: Option<(String, String)>,
    /// Number of machines.
    pub samples: usize,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Distribution of an error between its bounds.
    pub distribution: Distribution,
    /// Statistic of a machine over the poses.
    pub statistic: Statistic,
}

/// A budget with what it is of.
#[derive(Debug, Clone, Copy)]
pub struct BudgetReport<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Its bounds.
    pub bounds: &'a [Bound],
    /// The budget.
    pub budget: &'a Budget,
    /// At how many poses.
    pub poses: usize,
    /// Settings of the machines drawn.
    pub drawing: &'a DrawSettings,
}

impl DrawSettings {
    /// As it stands in JSON.
    pub fn json(&self) -> Map<String, Value> {
        let (class, source) = self.class.clone().unzip();
        let entries = [
            ("class", json!(class)),
            ("class_source", json!(source)),
            ("samples", json!(self.samples)),
            ("seed", json!(self.seed)),
            ("distribution", json!(self.distribution)),
            ("statistic", json!(self.statistic)),
        ];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// A tolerance in um or urad.
pub fn tolerance(bound: &Bound) -> f64 {
    bound.tolerance * bound.error.direction.micro().0
}

/// `um` or `urad`.
pub fn tolerance_unit(error: &ErrorId) -> &'static str {
    error.direction.micro().1
}

impl BudgetReport<'_> {
    /// Bounds by how much the 95 % value hangs on them.
    pub fn order(&self) -> Vec<usize> {
        let effect = |i: &usize| self.budget.position.tighten[*i].effect;
        let mut order: Vec<usize> = (0..self.bounds.len()).collect();
        order.sort_by(|a, b| effect(b).total_cmp(&effect(a)).then(a.cmp(b)));
        order
    }

    /// All of it.
    pub fn json(&self) -> Map<String, Value> {
        let entries = [
            ("frame", json!("workpiece")),
            ("order", json!("1")),
            ("left_out", json!(known(self.machine))),
            ("poses", json!(self.poses)),
            ("position_um", self.totals(&self.budget.position)),
            ("rotation_urad", self.totals(&self.budget.rotation)),
            ("contributions", json!(self.contributions(&self.budget.worst))),
            ("contributions_on_average", json!(self.contributions(&self.budget.average))),
            ("tighten", json!(self.tighten())),
        ];
        let mut json = self.drawing.json();
        json.extend(entries.into_iter().map(|(name, value)| (name.to_owned(), value)));
        json
    }

    /// Totals of position and orientation.
    fn totals(&self, totals: &Totals) -> Value {
        json!({
            "worst_case": totals.worst_case, "rss": totals.rss, "mean_of_both": totals.mean_of_both(),
            "worst_case_at": positions(self.machine, &totals.worst_pose), "rss_at": positions(self.machine,
                &totals.rss_pose),
            "monte_carlo": drawn_json(&totals.sorted),
        })
    }

    /// Contributions in their order.
    pub fn contributions(&self, list: &[Contribution]) -> Vec<Value> {
        let one = |c: &Contribution| json!({"error": self.bounds[c.bound].to_string(), "share": c.share, "um": c.um});
        list.iter().map(one).collect()
    }

    /// Indices of the tolerances, first the one to tighten first, and the effect of each at its bound.
    fn tighten(&self) -> Vec<Value> {
        let um = |list: &[Contribution], i: usize| list.iter().find(|c| c.bound == i).map(|c| c.um);
        let one = |i: usize| {
            let (bound, t) = (&self.bounds[i], self.budget.position.tighten[i]);
            let per = 1.0 / tolerance(bound);
            json!({
                "error": bound.to_string(), "tolerance": tolerance(bound), "unit": tolerance_unit(&bound.error),
                "direction": bound.direction, "by_letter": bound.by_letter,
                "of_class": bound.of_class, "um_per_unit": t.effect * per, "sigma": t.sigma * per,
                "um_of_p95": t.effect, "um_of_p95_sigma": t.sigma,
                "at_worst_um": um(&self.budget.worst, i), "average_um": um(&self.budget.average, i),
            })
        };
        self.order().into_iter().map(one).collect()
    }

    /// Effects of the errors at their bounds, and their sum.
    pub fn pareto(&self, top: usize) -> Picture {
        let bar = |c: &Contribution| Bar { label: self.bounds[c.bound].to_string(), value: c.um };
        ParetoPicture {
            title: self.machine.name().to_owned(),
            subtitle: format!("Each error at its bound, at {}", self.rounded(&self.budget.position.rss_pose)),
            quantity: "position deviation in µm".to_owned(),
            bars: self.budget.worst.iter().take(top.max(1)).map(bar).collect(),
            total: self.budget.worst.iter().map(|c| c.um * c.um).sum::<f64>(),
        }
        .picture()
    }

    /// A pose with the digits a picture has room for.
    fn rounded(&self, pose: &[f64]) -> String {
        let axes = self.machine.axes().iter().zip(pose);
        axes.map(|(axis, q)| format!("{} {}", axis.name, significant(*q, 4))).collect::<Vec<_>>().join(", ")
            + " (mm, deg)"
    }

    /// Use of the budget, tolerance by tolerance.
    pub fn waterfall(&self, top: usize) -> Picture {
        let order = self.order();
        let top = top.max(1);
        let part = |i: &usize| self.budget.position.tighten[*i].effect;
        let mut bars: Vec<Bar> =
            order.iter().take(top).map(|i| Bar { label: self.bounds[*i].to_string(), value: part(i) }).collect();
        if order.len() > top {
            let label = format!("{} others", order.len() - top);
            bars.push(Bar { label, value: order.iter().skip(top).map(part).sum() });
        }
        let p = &self.budget.position;
        WaterfallPicture {
            title: self.machine.name().to_owned(),
            subtitle: format!(
                "Contribution of each tolerance to the 95 % value of {} drawn machines",
                self.drawing.samples
            ),
            quantity: "position deviation in µm".to_owned(),
            bars,
            marks: vec![
                ("95 %".to_owned(), p.percentile(95).value),
                ("RSS".to_owned(), p.rss),
                ("mean of both".to_owned(), p.mean_of_both()),
                ("worst case".to_owned(), p.worst_case),
            ],
        }
        .picture()
    }
}

/// Mean and percentiles of drawn machines' values, given in rising order.
pub fn drawn_json(sorted: &[f64]) -> Value {
    let percentiles: Map<_, _> = PERCENTS
        .iter()
        .map(|p| Percentile::of(sorted, *p))
        .map(|p| (format!("p{}", p.percent), json!({"value": p.value, "low": p.low, "high": p.high})))
        .collect();
    let (mean, mean_sigma) = mean(sorted);
    let p95 = Percentile::of(sorted, 95).value;
    json!({"mean": mean, "mean_sigma": mean_sigma, "p95": p95, "percentiles": percentiles})
}

/// Several budgets on the same work: totals, differences to the first, and error by error.
pub fn budgets_json(budgets: &[BudgetReport<'_>], errors: &[BoundedError]) -> Value {
    let side = |of: &BudgetReport<'_>| {
        let minus = |totals: fn(&Budget) -> &Totals| {
            budgets.first().map(|first| minus_first(totals(of.budget), totals(first.budget)))
        };
        json!({
            "errors": of.bounds.len(),
            "position_um": of.totals(&of.budget.position), "rotation_urad": of.totals(&of.budget.rotation),
            "minus_first": {"position_um": minus(|b| &b.position), "rotation_urad": minus(|b| &b.rotation)},
        })
    };
    let error = |e: &BoundedError| {
        let each = |f: &dyn Fn(&crate::analysis::budget::BudgetPart) -> f64| -> Vec<Option<f64>> {
            e.parts.iter().map(|part| part.as_ref().map(f)).collect()
        };
        let minus: Vec<f64> = (0..e.parts.len()).map(|i| e.minus_first(i)).collect();
        json!({
            "error": e.error, "unit": e.direction.micro().1,
            "tolerance": each(&|p| p.tolerance * e.direction.micro().0),
            "um_of_p95": each(&|p| p.of_p95.effect), "um_of_p95_sigma": each(&|p| p.of_p95.sigma),
            "minus_first": minus, "average_um": each(&|p| p.average),
        })
    };
    json!({"machines": budgets.iter().map(side).collect::<Vec<_>>(), "largest_um": errors.first().map_or(0.0,
        BoundedError::largest), "contributions": errors.iter().map(error).collect::<Vec<_>>()})
}

fn minus_first(totals: &Totals, first: &Totals) -> Value {
    let p95 = |t: &Totals| t.percentile(95).value;
    json!({
        "worst_case": totals.worst_case - first.worst_case, "rss": totals.rss - first.rss,
        "mean_of_both": totals.mean_of_both() - first.mean_of_both(),
        "monte_carlo": {"mean": totals.mean.0 - first.mean.0, "p95": p95(totals) - p95(first)},
    })
}
