//! The figures of machines side by side with one reference, and the verdicts on them.

use super::bounded::DrawnBounds;
use super::budgets::{ComparedBudgets, ComparedVerdict, DrawnMachines, budgets};
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::{PairedDifference, PoseByPose, Statistic, Verdict};
use crate::analysis::figure_bands::{ComparedBands, compared_bands};
use crate::analysis::reference::PartReference;
use crate::analysis::{Comparison, figure_of};
use crate::evaluate::{Difference, Field, Frame, Order, Poses, Statistics, Summary};
use crate::job::job_file::Job;
use crate::job::machine_file::{MachineFile, order_of};
use crate::job::over::Over;
use crate::job::reference::{Reference, SetUp, unzeroed};
use crate::lower::NominalPose;
use crate::machine::{Machine, OperatingConditions, Pose, UnheldMotion};
use crate::report::BoundedFigures;
use crate::run::{Call, Refused};
use crate::units::{by_uncertainty, significant};
use nalgebra::Vector3;

/// Machines side by side without the rigid motion of the part that fits the deviations of each best.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct FittedComparison {
    /// Poses and reference that it is over.
    pub over: Over,
    /// The machines in their order.
    pub machines: Vec<FittedMachine>,
    /// The 95 % value of the position of each machine but the first, minus that of the first, where budgets are
    /// compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub versus_first_p95_um: Vec<ComparedVerdict>,
}

/// One machine of a comparison without the best fit.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct FittedMachine {
    /// Statistics of the deviation of the functional point, um.
    pub position_um: Summary,
    /// Statistics of the deviation of the orientation of the tool, urad.
    pub rotation_urad: Summary,
    /// The statistics minus those of the first machine; none where of only one of the two nothing is measured.
    pub minus_first: Option<Difference>,
    /// The 95 % value of its budget, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget_p95_um: Option<f64>,
}

/// The verdict on a machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MachineVerdict {
    /// Number of the machine, from 1.
    pub machine: usize,
    /// Its 95 % value against that of the first; none where that depends on the reference, or is not known.
    pub verdict: Option<Verdict>,
    /// The difference by which it is judged; none without a verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<JudgedDifference>,
    /// The reason why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The figure of the position deviation by which a machine is judged, minus that of the first machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct JudgedDifference {
    /// True if it is the value that 95 % of machines drawn do not exceed.
    pub drawn: bool,
    /// The class whose bounds stand for the values of both machines, where these are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
    /// True if what only one of the machines bounds has the bounds of the other one in both.
    pub alike: bool,
    /// The figure of a machine over the poses.
    pub statistic: Statistic,
    /// The difference, um: negative is better than the first.
    pub um: f64,
    /// Lower end of its interval, um, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// Upper end of its interval, um, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
}

impl JudgedDifference {
    /// Returns the figure in words, such as `largest deviation, 95 % of machines: -4.4 um (-5.1..-3.6)`.
    pub fn words(&self) -> String {
        let of = match (self.drawn, self.statistic) {
            (true, Statistic::Max) => "largest deviation, 95 % of machines",
            (true, Statistic::P95) => "95 % of the poses, 95 % of machines",
            (false, Statistic::Max) => "largest deviation",
            (false, Statistic::P95) => "95 % of the poses",
        };
        let signed = |um: f64, text: &str| format!("{}{text}", if um > 0.0 && text != "0" { "+" } else { "" });
        let um = match self.low.zip(self.high) {
            Some((low, high)) => {
                let [um, from, to] = by_uncertainty(self.um, Some(low), Some(high));
                format!("{} um ({}..{})", signed(self.um, &um), signed(low, &from), signed(high, &to))
            }
            None => format!("{} um", signed(self.um, &significant(self.um, 3))),
        };
        let class = self.class.as_ref().map_or_else(String::new, |name| format!(" of class {name}, values left out"));
        let alike = if self.alike { ", what one lacks bounded as the other's" } else { "" };
        format!("{of}{class}{alike}: {um}")
    }
}

/// Machines on the same work, whatever the reference.
pub(crate) struct Alike<'a> {
    pub files: &'a [MachineFile],
    pub fields: &'a [&'a dyn Field],
    /// Each machine with its poses for the work.
    pub sides: &'a [(&'a Machine, Vec<Pose>)],
    pub draws: AlikeDraws<'a>,
    /// Order of the errors, if it is asked for.
    pub order: Option<Order>,
    pub conditions: OperatingConditions,
}

/// How machines are drawn for all of them.
#[derive(Clone, Copy)]
pub(crate) struct AlikeDraws<'a> {
    pub tolerances: &'a ToleranceOptions,
    /// Number in the first round.
    pub samples: usize,
    /// Limit of the rounds.
    pub max_samples: usize,
    pub seed: u64,
}

/// The figures of machines with one reference.
pub(crate) struct Figures {
    pub comparison: Comparison,
    pub bounded: Vec<Option<Bounded>>,
    pub budgets: Option<ComparedBudgets>,
    /// True if machines have bounds that are left out, since the reference is a minimum zone.
    pub bounds_left_out: bool,
    pub uncertainty: Option<Vec<ComparedBands>>,
    /// Number of machines drawn.
    pub samples: usize,
}

/// What the bounds of a machine lead to at its poses for the work.
pub(crate) struct Bounded {
    pub found: PoseByPose,
    pub figures: BoundedFigures,
}

impl Bounded {
    fn new(call: &Call<'_>, of: &DrawnBounds, machine: &Machine, poses: &[Pose]) -> Result<Self, Refused> {
        let found = of.at(call, machine, &Poses::Listed(poses.to_vec()), Frame::Workpiece)?;
        Ok(Self { figures: of.figures(&found), found })
    }
}

/// Returns the set-ups of the part on all machines, each at its poses for the work. Without a job the motions are
/// taken out that the data of any of them do not hold. A job without a reference is zeroed at its origin; where a
/// machine does not reach that, all are in machine coordinates. Returns the reason, too, if the set-ups are not alike.
pub(crate) fn set_ups(
    call: &mut Call<'_>,
    files: &[MachineFile],
    sides: &[(&Machine, Vec<Pose>)],
    asked: Option<&Reference>,
    job: Option<&Job>,
) -> Result<(Vec<SetUp>, Option<String>), Refused> {
    let stated = Job::stated(job, asked);
    let is_stated = stated.is_some();
    let reference = stated
        .or_else(|| job.filter(|job| job.has_part()).map(Job::zero))
        .unwrap_or_else(Reference::machine_less_unheld);
    // What one machine is without, all are without.
    let motions: Vec<UnheldMotion> = files.iter().flat_map(|file| file.unheld()).copied().collect();
    let mut list = Vec::new();
    for ((machine, poses), file) in sides.iter().zip(files) {
        match SetUp::without(machine, &reference, &motions, poses) {
            Ok(set_up) => list.push(set_up),
            Err(refusal) if is_stated => {
                return call.about(file.path(), |call| call.refuse(Job::located(job, asked, refusal)));
            }
            Err(reason) => {
                call.about(file.path(), |call| call.warn(unzeroed(&reason)));
                call.check()?;
                let why = format!("no reference point that all machines reach: {}", reason.message);
                return Ok((vec![SetUp::machine(); files.len()], Some(why)));
            }
        }
    }
    let why = "the zero is probed in other directions of the tool: state `I,J,K` in place of rotary axes";
    let unlike = reference.rotary.is_some() && !is_probed_alike(sides, &list);
    Ok((list, unlike.then(|| why.to_owned())))
}

/// True if the tool has the same direction on the part at the reference points of all machines.
fn is_probed_alike(sides: &[(&Machine, Vec<Pose>)], set_ups: &[SetUp]) -> bool {
    let directions = |((machine, _), set_up): (&(&Machine, Vec<Pose>), &SetUp)| -> Vec<Vector3<f64>> {
        let tool = Vector3::from(machine.tool().direction);
        let points = set_up.removed().map_or(&[][..], |of| of.points()).iter();
        let probed = 1 + usize::from(set_up.reference.align.is_some());
        points.take(probed).map(|point| NominalPose::in_part(machine, &point.pose).pose.linear * tool).collect()
    };
    let all: Vec<Vec<Vector3<f64>>> = sides.iter().zip(set_ups).map(directions).collect();
    all.iter()
        .all(|of| of.len() == all[0].len() && of.iter().zip(&all[0]).all(|(a, b)| (a - b).norm() < SAME_DIRECTION))
}

/// Difference of unit vectors up to which they are one direction.
const SAME_DIRECTION: f64 = 1e-9;

/// Returns what is taken out on each machine.
pub(crate) fn removed(set_ups: &[SetUp]) -> Vec<Option<&PartReference>> {
    set_ups.iter().map(SetUp::removed).collect()
}

impl Alike<'_> {
    /// Returns the figures of a comparison with set-ups.
    pub(crate) fn figures(
        &self,
        call: &mut Call<'_>,
        comparison: Comparison,
        set_ups: &[SetUp],
    ) -> Result<Figures, Refused> {
        let Self { files, fields, sides, draws, order, conditions } = *self;
        let AlikeDraws { tolerances, samples, max_samples, seed } = draws;
        let references = removed(set_ups);
        let orders: Vec<Order> = files.iter().map(|file| order_of(file, order)).collect();
        let comparison = comparison.without(fields, &references, &orders, conditions);
        let names: Vec<&str> = files.iter().map(MachineFile::path).collect();
        let drawn = DrawnMachines { tolerances, files: &names, samples, max_samples, seed, references: &references };
        let budgets = budgets(call, sides, drawn)?;
        let samples = budgets.as_ref().map_or(samples, |budgets| budgets.drawing.samples);
        let mut bounds_left_out = false;
        if references.iter().flatten().any(|of| !of.is_linear()) {
            for (machine, _) in sides {
                bounds_left_out |= !tolerances.bounds_if_any(call, machine)?.0.is_empty();
            }
        }
        let mut bounded = Vec::new();
        for (((machine, poses), file), reference) in sides.iter().zip(files).zip(&references) {
            let of = call.about(file.path(), |call| DrawnBounds::of(call, machine, (tolerances, samples, seed)))?;
            if of.is_some() {
                set_ups.iter().try_for_each(|of| of.refuse_minimum_zone(call, "a comparison of bounds"))?;
            }
            bounded.push(of.map(|of| Bounded::new(call, &of.without(*reference), machine, poses)).transpose()?);
        }
        call.check()?;
        // Figures from bounds have no uncertainty: they are one.
        let measured = bounded.iter().all(Option::is_none);
        let bands = || compared_bands(sides, &comparison, conditions, seed, &references);
        let uncertainty = if measured { bands() } else { None };
        Ok(Figures { comparison, bounded, budgets, bounds_left_out, uncertainty, samples })
    }
}

impl Figures {
    fn statistics(&self, index: usize) -> Statistics {
        match &self.bounded[index] {
            Some(of) => of.figures.statistics(self.comparison.common.len()),
            None => self.comparison.machines[index].statistics,
        }
    }

    /// Returns the statistics of a machine minus those of the first, where both are alike.
    fn minus_first(&self, index: usize) -> Option<Difference> {
        let is_alike = self.bounded[index].is_some() == self.bounded[0].is_some();
        is_alike.then(|| self.statistics(index).minus(&self.statistics(0)))
    }

    /// Returns the figures as those without a best fit.
    pub(crate) fn compared(&self, over: Over) -> FittedComparison {
        let p95 = |i: usize| self.budgets.as_ref().map(|of| of.machines[i].position_um.monte_carlo.p95);
        let one = |i: usize| {
            let Statistics { position_um, rotation_urad, .. } = self.statistics(i);
            FittedMachine { position_um, rotation_urad, minus_first: self.minus_first(i), budget_p95_um: p95(i) }
        };
        let machines = (0..self.bounded.len()).map(one).collect();
        let versus_first_p95_um = self.budgets.as_ref().map_or_else(Vec::new, |of| of.versus_first_p95_um.clone());
        FittedComparison { over, machines, versus_first_p95_um }
    }

    /// Returns the verdict of these figures on a machine: that of its budget, or else of its measured errors.
    fn own_verdict(&self, index: usize) -> Option<Verdict> {
        if let Some(of) = &self.budgets {
            let verdict = of.versus_first_p95_um.get(index - 1).and_then(|versus| versus.verdict)?;
            // The uncertainty of values may turn what is told apart by machines drawn.
            let by = self.judged(index)?;
            let is_open = by.low.zip(by.high).is_some_and(|(low, high)| low <= 0.0 && high >= 0.0);
            return Some(if self.uncertainty.is_some() && is_open { Verdict::NotToldApart } else { verdict });
        }
        let difference = Verdict::of_difference(self.minus_first(index)?.position_um.p95);
        match &self.uncertainty {
            Some(bands) if !bands[index].told_apart => Some(Verdict::NotToldApart),
            _ => Some(difference),
        }
    }

    /// Returns why errors that are left out or that nothing bounds leave a machine without a verdict.
    fn withheld(&self, index: usize) -> Option<String> {
        if self.bounds_left_out {
            return Some("bounds are left out with a minimum zone".to_owned());
        }
        let pair = |of: &ComparedBudgets| [0, index].map(|i| (of.machines[i].left_out, of.machines[i].with_values));
        if let Some([(a, with_a), (b, with_b)]) = self.budgets.as_ref().map(pair)
            && (a > 0 && with_b.is_some() || b > 0 && with_a.is_some())
        {
            let (machine, errors) = if a > 0 { (1, a) } else { (index + 1, b) };
            return Some(format!("the class stands for the {errors} values of machine {machine}, which are left out"));
        }
        let versus = self.budgets.as_ref()?.versus_first_p95_um.get(index - 1)?;
        versus.withheld.as_ref().map(|withheld| withheld.reason.clone())
    }

    /// Returns the difference (um) of the figures by which a machine is judged, with its interval.
    fn judged(&self, index: usize) -> Option<JudgedDifference> {
        if let Some(of) = &self.budgets {
            let versus = of.versus_first_p95_um.get(index - 1)?;
            let alike = versus.minus_first_alike;
            let PairedDifference { value, mut low, mut high, .. } = alike.unwrap_or(versus.minus_first);
            if let (Some(bands), Some(um)) = (&self.uncertainty, self.minus_first(index)) {
                let band = bands[index].minus_first.position_um;
                let (um, ends) = figure_of(of.drawing.statistic, &um.position_um, Some(&band));
                let [from, to] = ends.unwrap_or([um, um]);
                (low, high) = (low.map(|low| low + from - um), high.map(|high| high + to - um));
            }
            let [first, own] = [&of.machines[0], &of.machines[index]];
            let class = own.class.clone().filter(|_| first.left_out > 0 && own.left_out > 0);
            return Some(JudgedDifference {
                drawn: true,
                class,
                alike: alike.is_some(),
                statistic: of.drawing.statistic,
                um: value,
                low,
                high,
            });
        }
        let um = self.minus_first(index)?.position_um.p95;
        let drawn = self.bounded[index].is_some();
        Some(JudgedDifference {
            drawn,
            class: None,
            alike: false,
            statistic: Statistic::P95,
            um,
            low: None,
            high: None,
        })
    }

    /// Returns the verdict on a machine, on which a best fit must agree if there is one. `unlike` is the reason why the
    /// machines are not judged alike.
    pub(crate) fn verdict(&self, fitted: Option<&Self>, index: usize, unlike: Option<String>) -> MachineVerdict {
        let (own, best_fit) = (self.own_verdict(index), fitted.map(|of| of.own_verdict(index)));
        let withheld = || self.withheld(index).or_else(|| fitted?.withheld(index));
        let reason = match (unlike, own, best_fit.flatten()) {
            (Some(unlike), ..) => Some(unlike),
            (None, ..) if withheld().is_some() => withheld(),
            (None, None, _) => Some("only one of the two has measured errors".to_owned()),
            (None, Some(own), Some(fit)) if own != fit => {
                Some(format!("{} in machine coordinates, {} with the best fit", own.words(), fit.words()))
            }
            _ => None,
        };
        let verdict = own.filter(|_| reason.is_none());
        MachineVerdict { machine: index + 1, verdict, by: self.judged(index).filter(|_| reason.is_none()), reason }
    }
}
