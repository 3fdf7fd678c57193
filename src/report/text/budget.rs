//! A budget as it stands in JSON, and its pictures: the same in `budget`, in a comparison and on the page.

use crate::analysis::budget::{
    Bound, Budget, Contribution, Distribution, PERCENTS, Percentile, Statistic, Totals, count_staying, known, mean,
};
use crate::evaluate::{Frame, Order};
use crate::job::limit::{JobLimit, LimitVerdict};
use crate::machine::{AxisPositions, ErrorId, Machine, axis_positions};
use crate::report::pictures::{Bar, ParetoPicture, Picture, WaterfallPicture};
use crate::units::significant;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Serialize;

/// Settings of the machines drawn for a budget.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DrawSettings {
    /// The class that bounds what the machine file does not.
    pub class: Option<String>,
    /// Source of the class.
    pub class_source: Option<String>,
    /// Number of machines drawn.
    pub samples: usize,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Distribution of an error between its bounds.
    pub distribution: Distribution,
    /// Statistic of a machine over the poses.
    pub statistic: Statistic,
}

/// A budget: to first order, in the workpiece frame.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BudgetFigures {
    /// Settings of the machines drawn.
    #[serde(flatten)]
    pub drawing: DrawSettings,
    /// Frame of the vectors: the workpiece frame.
    pub frame: Frame,
    /// Order of the errors: 1.
    pub order: Order,
    /// Number of errors that have values and are left out, for bounds stand for them.
    pub left_out: usize,
    /// The errors with values that no bound stands for, if there are any: they act in every machine drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_values: Option<ActingValues>,
    /// Number of poses.
    pub poses: usize,
    /// The position deviation, um.
    pub position_um: DeviationBudget,
    /// The rotation of the tool, urad.
    pub rotation_urad: DeviationBudget,
    /// Effect of each error at its bound where the RSS is largest, largest first.
    pub contributions: Vec<BoundedContribution>,
    /// The same, averaged over the poses.
    pub contributions_on_average: Vec<BoundedContribution>,
    /// The bounded errors; first the one whose tightening lowers the 95 % value most.
    pub tighten: Vec<Tightening>,
    /// The bounds, mm and rad, in the order of the machine.
    #[serde(skip)]
    pub bounds: Vec<Bound>,
}

/// Errors with values in a budget.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ActingValues {
    /// Number of these errors.
    pub errors: usize,
    /// Their part of the 95 % value of the position, um.
    pub um_of_p95: f64,
}

impl ActingValues {
    /// Returns those of a budget; `None` without any.
    pub(crate) fn of(machine: &Machine, bounds: &[Bound], budget: &Budget) -> Option<Self> {
        let errors = count_staying(machine, bounds);
        (errors > 0).then_some(Self { errors, um_of_p95: budget.position.staying })
    }
}

/// A deviation, as bounds lead to it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DeviationBudget {
    /// Sum of the effects of all bounds, at the pose where it is largest.
    pub worst_case: f64,
    /// Root of the sum of their squares, at the pose where it is largest.
    pub rss: f64,
    /// Mean of both.
    pub mean_of_both: f64,
    /// Pose of the worst case, mm and deg.
    pub worst_case_at: AxisPositions,
    /// Pose of the largest RSS, mm and deg.
    pub rss_at: AxisPositions,
    /// Machines drawn between the bounds.
    pub monte_carlo: DrawnMachineFigures,
}

/// Figures of machines drawn.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DrawnMachineFigures {
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean.
    pub mean_sigma: f64,
    /// Value that 95 % of the machines do not exceed.
    pub p95: f64,
    /// Percentiles by name, such as `p95`.
    pub percentiles: IndexMap<String, PercentileInterval>,
}

impl DrawnMachineFigures {
    /// Returns the 95 % value (um) against the limit of a job, with the spread of values that act in each machine.
    pub(crate) fn against(&self, limit: &JobLimit, spread_um: Option<[f64; 2]>) -> LimitVerdict {
        let interval = self.percentiles.get("p95").and_then(|of| Some([of.low?, of.high?]));
        limit.on_machines(self.p95, interval, spread_um)
    }
}

/// A percentile of machines drawn with its confidence interval; none where there are too few machines for one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PercentileInterval {
    /// The percentile.
    pub value: f64,
    /// Lower end of its 95 % confidence interval.
    pub low: Option<f64>,
    /// Upper end of its 95 % confidence interval.
    pub high: Option<f64>,
}

/// Effect of an error at its bound.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BoundedContribution {
    /// Name of the error.
    pub error: String,
    /// Share of the sum of squares, 0 to 1.
    pub share: f64,
    /// Position deviation, um.
    pub um: f64,
}

/// A bounded error, and the effect of its tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Tightening {
    /// Name of the error.
    pub error: String,
    /// Its tolerance, in `unit`.
    pub tolerance: f64,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Its direction, machine frame.
    pub direction: [f64; 3],
    /// True if its name has the letter of a direction.
    pub by_letter: bool,
    /// True if the class bounds it, false if the machine file does.
    pub of_class: bool,
    /// Derivative of the 95 % value by the tolerance, um by unit.
    pub um_per_unit: f64,
    /// Standard error of the derivative, um by unit.
    pub sigma: f64,
    /// Its part of the 95 % value, um.
    pub um_of_p95: f64,
    /// Standard error of that part, um.
    pub um_of_p95_sigma: f64,
    /// Its effect where the RSS is largest, um.
    pub at_worst_um: Option<f64>,
    /// Its effect averaged over the poses, um.
    pub average_um: Option<f64>,
}

/// A tolerance in um or urad.
pub fn tolerance(bound: &Bound) -> f64 {
    bound.tolerance * bound.error.direction.micro().0
}

/// `um` or `urad`.
pub fn tolerance_unit(error: &ErrorId) -> &'static str {
    error.direction.micro().1
}

/// Contributions in their order.
pub fn contributions(bounds: &[Bound], list: &[Contribution]) -> Vec<BoundedContribution> {
    let one = |c: &Contribution| BoundedContribution { error: bounds[c.bound].to_string(), share: c.share, um: c.um };
    list.iter().map(one).collect()
}

impl DeviationBudget {
    /// Returns the totals of position or orientation.
    pub fn new(machine: &Machine, totals: &Totals) -> Self {
        Self {
            worst_case: totals.worst_case,
            rss: totals.rss,
            mean_of_both: totals.mean_of_both(),
            worst_case_at: axis_positions(machine, &totals.worst_pose),
            rss_at: axis_positions(machine, &totals.rss_pose),
            monte_carlo: DrawnMachineFigures::of(&totals.sorted),
        }
    }
}

impl DrawnMachineFigures {
    /// Returns mean and percentiles of values of drawn machines in rising order.
    pub fn of(sorted: &[f64]) -> Self {
        let interval = |percent: usize| {
            let Percentile { value, low, high, .. } = Percentile::of(sorted, percent);
            PercentileInterval { value, low, high }
        };
        let (mean, mean_sigma) = mean(sorted);
        Self {
            mean,
            mean_sigma,
            p95: interval(95).value,
            percentiles: PERCENTS.map(|percent| (format!("p{percent}"), interval(percent))).into_iter().collect(),
        }
    }
}

/// The bounds with their effects; first the one whose tightening lowers the 95 % value most.
fn tightenings(bounds: &[Bound], budget: &Budget) -> Vec<Tightening> {
    let effects = &budget.position.tighten;
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|a, b| effects[*b].effect.total_cmp(&effects[*a].effect).then(a.cmp(b)));
    let um = |list: &[Contribution], i: usize| list.iter().find(|c| c.bound == i).map(|c| c.um);
    let one = |i: usize| {
        let (bound, t) = (&bounds[i], effects[i]);
        let per = 1.0 / tolerance(bound);
        Tightening {
            error: bound.to_string(),
            tolerance: tolerance(bound),
            unit: tolerance_unit(&bound.error),
            direction: bound.direction,
            by_letter: bound.by_letter,
            of_class: bound.of_class,
            um_per_unit: t.effect * per,
            sigma: t.sigma * per,
            um_of_p95: t.effect,
            um_of_p95_sigma: t.sigma,
            at_worst_um: um(&budget.worst, i),
            average_um: um(&budget.average, i),
        }
    };
    order.into_iter().map(one).collect()
}

impl BudgetFigures {
    /// Returns the figures of a budget at so many poses.
    pub fn new(machine: &Machine, bounds: Vec<Bound>, budget: &Budget, poses: usize, drawing: DrawSettings) -> Self {
        let with_values = ActingValues::of(machine, &bounds, budget);
        Self {
            drawing,
            frame: Frame::Workpiece,
            order: Order::Degree(1),
            left_out: known(machine) - with_values.map_or(0, |of| of.errors),
            with_values,
            poses,
            position_um: DeviationBudget::new(machine, &budget.position),
            rotation_urad: DeviationBudget::new(machine, &budget.rotation),
            contributions: contributions(&bounds, &budget.worst),
            contributions_on_average: contributions(&bounds, &budget.average),
            tighten: tightenings(&bounds, budget),
            bounds,
        }
    }

    /// Returns a picture of the effects of the errors at their bounds: the `top` largest, and the sum of all.
    pub fn pareto(&self, machine: &str, top: usize) -> Picture {
        let bar = |c: &BoundedContribution| Bar { label: c.error.clone(), value: c.um };
        ParetoPicture {
            title: machine.to_owned(),
            subtitle: format!("Each error at its bound, at {}", round(&self.position_um.rss_at)),
            quantity: "position deviation in µm".to_owned(),
            bars: self.contributions.iter().take(top.max(1)).map(bar).collect(),
            total: self.contributions.iter().map(|c| c.um * c.um).sum::<f64>(),
        }
        .picture()
    }

    /// Returns a picture of the use of the budget, tolerance by tolerance: the `top` largest, and the sum of the
    /// others.
    pub fn waterfall(&self, machine: &str, top: usize) -> Picture {
        let (first, others) = self.tighten.split_at(top.max(1).min(self.tighten.len()));
        let mut bars: Vec<Bar> = first.iter().map(|t| Bar { label: t.error.clone(), value: t.um_of_p95 }).collect();
        if !others.is_empty() {
            let label = format!("{} others", others.len());
            bars.push(Bar { label, value: others.iter().map(|t| t.um_of_p95).sum() });
        }
        bars.extend(self.with_values.map(|of| Bar { label: "values".to_owned(), value: of.um_of_p95 }));
        let p = &self.position_um;
        WaterfallPicture {
            title: machine.to_owned(),
            subtitle: format!(
                "Contribution of each tolerance to the 95 % value of {} drawn machines",
                self.drawing.samples
            ),
            quantity: "position deviation in µm".to_owned(),
            bars,
            marks: vec![
                ("95 %".to_owned(), p.monte_carlo.p95),
                ("RSS".to_owned(), p.rss),
                ("mean of both".to_owned(), p.mean_of_both),
                ("worst case".to_owned(), p.worst_case),
            ],
        }
        .picture()
    }
}

/// A pose with the digits a picture has room for.
fn round(pose: &AxisPositions) -> String {
    let axes = pose.iter().map(|(axis, q)| format!("{axis} {}", significant(*q, 4)));
    axes.collect::<Vec<_>>().join(", ") + " (mm, deg)"
}
