//! Budgets of several machines on the same work.

use super::tolerances::{ClassSource, ToleranceOptions};
use crate::analysis::budget::{
    ActingErrors, Bound, BoundedError, Budget, BudgetPart, Class, Coverage, PairedDifference, PairedTest, Request,
    STAND_IN_CLASS, Totals, Verdict, VersusFirst, budget, classes, is_measured, known, round_sizes, side_by_side,
};
use crate::analysis::reference::PartReference;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Machine, Pose};
use crate::report::{ActingValues, DeviationBudget, DrawSettings};
use crate::run::{Call, Refused};
use schemars::JsonSchema;
use serde::Serialize;

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
    /// Motion that the part's set-up takes out on each machine.
    pub references: &'a [Option<&'a PartReference>],
}

/// Budgets on the same work.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct ComparedBudgets {
    /// The budget of each machine.
    pub machines: Vec<ComparedBudget>,
    /// Effect of the error that is first in `contributions`, um.
    pub largest_um: f64,
    /// Error by error, largest first.
    pub contributions: Vec<ComparedContribution>,
    /// Settings of the machines drawn.
    #[serde(flatten)]
    pub drawing: DrawSettings,
    /// Number of machines that are drawn at most, if the first ones do not tell the machines apart.
    pub max_samples: usize,
    /// The 95 % value of the position of each machine but the first, minus that of the first.
    pub versus_first_p95_um: Vec<ComparedVerdict>,
}

/// A machine against the first, on the machines drawn of both.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ComparedVerdict {
    /// The verdict on the two; none if errors that only one of the files bounds could turn it.
    pub verdict: Option<Verdict>,
    /// Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 %
    /// confidence.
    pub minus_first: PairedDifference,
    /// The same with the other machine's bounds for what only one of them bounds: like with like. None where both
    /// bound the same errors, and without a verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minus_first_alike: Option<PairedDifference>,
    /// The reason why there is no verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withheld: Option<WithheldVerdict>,
}

/// The reason why there is no verdict on two machines: errors without a value or a bound could turn it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WithheldVerdict {
    /// The reason in words.
    pub reason: String,
    /// The verdict on the errors that are bounded.
    pub as_bounded: Verdict,
    /// Errors that the first machine states nothing of.
    pub missing_first: Vec<String>,
    /// Errors that this machine states nothing of.
    pub missing: Vec<String>,
    /// The class that bounds them, where the other machine does not.
    pub class: String,
    /// Its 95 % value minus that of the first, um, with the bounds of the other machine for what is missing, and with
    /// those of the class for what neither bounds.
    pub minus_first_if_filled: [PairedDifference; 2],
}

/// The budget of a machine beside others.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ComparedBudget {
    /// Number of bounded errors.
    pub errors: usize,
    /// Number of these that the class bounds; the machine file bounds the others.
    pub errors_by_class: usize,
    /// Number of errors that act and have neither a value nor a bound.
    pub unbounded: usize,
    /// The position deviation, um.
    pub position_um: DeviationBudget,
    /// The rotation of the tool, urad.
    pub rotation_urad: DeviationBudget,
    /// Minus the figures of the first machine.
    pub minus_first: BudgetDifference,
    /// The class that bounds what the machine file does not.
    pub class: Option<String>,
    /// Source of the class.
    pub class_source: Option<String>,
    /// Number of errors that have values and are left out, for bounds of a class stand for them.
    pub left_out: usize,
    /// The errors with values that act in every machine drawn, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_values: Option<ActingValues>,
}

/// Figures of a budget minus those of another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct BudgetDifference {
    /// Differences of the position deviation, um.
    pub position_um: DeviationBudgetDifference,
    /// Differences of the orientation deviation, urad.
    pub rotation_urad: DeviationBudgetDifference,
}

/// Figures of a deviation minus those of another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DeviationBudgetDifference {
    /// Difference of the worst cases.
    pub worst_case: f64,
    /// Difference of the RSS values.
    pub rss: f64,
    /// Difference of the means of both.
    pub mean_of_both: f64,
    /// Differences of the figures of machines drawn.
    pub monte_carlo: DrawnDifference,
}

/// Figures of machines drawn minus those of others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DrawnDifference {
    /// Difference of the means.
    pub mean: f64,
    /// Difference of the 95 % values.
    pub p95: f64,
}

/// An error in several budgets; a list has a value for each machine, none where a machine does not bound it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ComparedContribution {
    /// Name of the error.
    pub error: String,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Its tolerance, in `unit`.
    pub tolerance: Vec<Option<f64>>,
    /// Its part of the 95 % value, um.
    pub um_of_p95: Vec<Option<f64>>,
    /// Standard error of that part, um.
    pub um_of_p95_sigma: Vec<Option<f64>>,
    /// That part minus that of the first machine, um.
    pub minus_first: Vec<f64>,
    /// Its effect averaged over the poses, um.
    pub average_um: Vec<Option<f64>>,
}

impl ComparedBudget {
    fn new(machine: &Machine, (bounds, class): (&[Bound], &Option<ClassSource>), own: &Budget, first: &Budget) -> Self {
        let (class, class_source) = class.clone().unzip();
        let with_values = ActingValues::of(machine, bounds, own);
        Self {
            errors: bounds.len(),
            errors_by_class: bounds.iter().filter(|bound| bound.of_class).count(),
            unbounded: Coverage::of(machine, bounds).missing.len(),
            left_out: known(machine) - with_values.map_or(0, |of| of.errors),
            position_um: DeviationBudget::new(machine, &own.position),
            rotation_urad: DeviationBudget::new(machine, &own.rotation),
            minus_first: BudgetDifference {
                position_um: DeviationBudgetDifference::new(&own.position, &first.position),
                rotation_urad: DeviationBudgetDifference::new(&own.rotation, &first.rotation),
            },
            class,
            class_source,
            with_values,
        }
    }
}

impl DeviationBudgetDifference {
    fn new(own: &Totals, first: &Totals) -> Self {
        let p95 = |totals: &Totals| totals.percentile(95).value;
        Self {
            worst_case: own.worst_case - first.worst_case,
            rss: own.rss - first.rss,
            mean_of_both: own.mean_of_both() - first.mean_of_both(),
            monte_carlo: DrawnDifference { mean: own.mean.0 - first.mean.0, p95: p95(own) - p95(first) },
        }
    }
}

impl ComparedContribution {
    fn new(of: &BoundedError) -> Self {
        let (factor, unit) = of.direction.micro();
        let each = |value: &dyn Fn(&BudgetPart) -> f64| -> Vec<Option<f64>> {
            of.parts.iter().map(|part| part.as_ref().map(value)).collect()
        };
        Self {
            error: of.error.clone(),
            unit,
            tolerance: each(&|part| part.tolerance * factor),
            um_of_p95: each(&|part| part.of_p95.effect),
            um_of_p95_sigma: each(&|part| part.of_p95.sigma),
            minus_first: (0..of.parts.len()).map(|i| of.minus_first(i)).collect(),
            average_um: each(&|part| part.average),
        }
    }
}

/// Returns the budgets, each at the poses of its machine for the same work; none if not every machine has one.
pub(crate) fn budgets(
    call: &mut Call<'_>,
    sides: &[(&Machine, Vec<Pose>)],
    drawn: DrawnMachines<'_>,
) -> Result<Option<ComparedBudgets>, Refused> {
    let mut all = Vec::new();
    let mut sources: Vec<Option<ClassSource>> = Vec::new();
    for ((machine, _), file) in sides.iter().zip(drawn.files) {
        let (bounds, of) = call.about(file, |call| drawn.tolerances.bounds_if_any(call, machine))?;
        sources.push(of);
        all.push(bounds);
    }
    if all.iter().all(Vec::is_empty) || sides.iter().any(|(_, poses)| poses.is_empty()) {
        return Ok(None);
    }
    if drawn.references.iter().flatten().any(|of| !of.is_linear()) {
        let message = "budgets are not compared: a minimum zone has no worst case, RSS or parts of errors";
        let help = "take the least squares, `--reference best-fit`, or another reference";
        call.warn(Diagnostic::new(codes::W0607, message).help(help));
        call.check()?;
        return Ok(None);
    }
    // A measured machine without bounds is the same in every draw, beside others that are measured, too.
    let measured = sides.iter().all(|(machine, _)| is_measured(machine));
    let without = drawn.files.iter().zip(&all).filter(|(_, bounds)| bounds.is_empty() && !measured);
    let without: Vec<String> = without.map(|(file, _)| format!("`{}`", shown(file))).collect();
    if !without.is_empty() {
        let message = format!("budgets are not compared: {} bounds no error", without.join(" and "));
        let help = "write tolerances into every file, or take those of a class: `--class production`";
        call.warn(Diagnostic::new(codes::W0607, message).help(help));
        call.check()?;
        return Ok(None);
    }
    let (list, versus) = budgeted(call, sides, &all, drawn)?;
    let samples = list.first().map_or(drawn.samples, |budget| budget.position.drawn.len());
    let compared = Compared { sides, bounds: &all, sources: &sources, drawn, samples };
    let versus_first = compared.verdicts(call, versus)?;
    let common = sources.iter().all(|class| *class == sources[0]).then(|| sources[0].clone()).flatten();
    let pairs: Vec<(&[Bound], &Budget)> = all.iter().map(Vec::as_slice).zip(&list).collect();
    let errors = side_by_side(&pairs);
    let one = |(i, (machine, _)): (usize, &(&Machine, Vec<Pose>))| {
        ComparedBudget::new(machine, (&all[i], &sources[i]), &list[i], &list[0])
    };
    Ok(Some(ComparedBudgets {
        machines: sides.iter().enumerate().map(one).collect(),
        largest_um: errors.first().map_or(0.0, BoundedError::largest),
        contributions: errors.iter().map(ComparedContribution::new).collect(),
        drawing: drawn.tolerances.drawing(common, samples, drawn.seed),
        max_samples: drawn.max_samples.max(drawn.samples),
        versus_first_p95_um: versus_first,
    }))
}

/// Draws machines in rounds until all are told apart from the first, or the limit is reached.
fn budgeted(
    call: &Call<'_>,
    sides: &[(&Machine, Vec<Pose>)],
    bounds: &[Vec<Bound>],
    drawn: DrawnMachines<'_>,
) -> Result<(Vec<Budget>, Vec<VersusFirst>), Refused> {
    let (draws, statistic) = (drawn.tolerances.draws(drawn.seed), drawn.tolerances.statistic);
    let sizes = round_sizes(drawn.samples, drawn.max_samples);
    let mut last = (Vec::new(), Vec::new());
    for samples in sizes.iter().copied() {
        let list: Vec<Budget> = call.stage("machines drawn", 2 * samples * sides.len(), |advance| {
            let one = |(i, (machine, poses)): (usize, &(&Machine, Vec<Pose>))| {
                let (bounds, reference, draws) = (&bounds[i], drawn.references[i], &draws);
                let (searched, acting) = (false, ActingErrors::OfMachine);
                let request = Request {
                    machine,
                    acting,
                    bounds,
                    poses,
                    reference,
                    searched,
                    at: None,
                    draws,
                    samples,
                    statistic,
                };
                budget(request, advance)
            };
            sides.iter().enumerate().map(one).collect()
        })?;
        let test = PairedTest::of_round(samples, list.len(), sizes.len());
        let values: Vec<&[f64]> = list.iter().map(|budget| budget.position.drawn.as_slice()).collect();
        let versus: Vec<VersusFirst> = values.iter().skip(1).map(|of| test.versus(of, values[0])).collect();
        let open = versus.iter().any(|versus| versus.verdict == Verdict::NotToldApart);
        last = (list, versus);
        if !open {
            break;
        }
    }
    Ok(last)
}

/// Returns the class that stands in for what no machine bounds: one that is in force, or else production.
pub(crate) fn stand_in(in_force: Option<&str>, machines: &[&Machine]) -> (String, Option<Class>) {
    let name = in_force.unwrap_or(STAND_IN_CLASS);
    let named = machines.iter().filter_map(|machine| machine.class()).find(|class| class.name == name);
    let class = classes().remove(name).or_else(|| named.map(|named| named.class.clone()));
    (name.to_owned(), class)
}

/// Budgets of machines with what they are drawn from.
struct Compared<'a> {
    sides: &'a [(&'a Machine, Vec<Pose>)],
    bounds: &'a [Vec<Bound>],
    sources: &'a [Option<ClassSource>],
    drawn: DrawnMachines<'a>,
    /// Number of machines drawn in the last round.
    samples: usize,
}

impl Compared<'_> {
    /// Withholds the verdicts that errors without a value or a bound could turn: those whose difference changes its
    /// sign once such errors have the other machine's bounds, and then those of a class.
    fn verdicts(&self, call: &Call<'_>, versus: Vec<VersusFirst>) -> Result<Vec<ComparedVerdict>, Refused> {
        let sides = self.sides.iter().zip(self.bounds);
        let coverages: Vec<Coverage> = sides.map(|((machine, _), bounds)| Coverage::of(machine, bounds)).collect();
        let mut verdicts = Vec::new();
        for (i, VersusFirst { verdict, minus_first }) in (1..).zip(versus) {
            let decided = matches!(verdict, Verdict::Better | Verdict::Worse);
            let complete = [0, i].iter().all(|side| coverages[*side].missing.is_empty());
            let mut own =
                ComparedVerdict { verdict: Some(verdict), minus_first, minus_first_alike: None, withheld: None };
            if decided && !complete {
                match self.alike(call, &coverages, i, verdict)? {
                    Ok(alike) => own.minus_first_alike = alike,
                    Err(withheld) => (own.verdict, own.withheld) = (None, Some(withheld)),
                }
            }
            verdicts.push(own);
        }
        Ok(verdicts)
    }

    /// Returns the difference with the other machine's bounds for what only one of them bounds, if there is such an
    /// error, or why the verdict does not stand.
    fn alike(
        &self,
        call: &Call<'_>,
        coverages: &[Coverage],
        index: usize,
        verdict: Verdict,
    ) -> Result<Result<Option<PairedDifference>, WithheldVerdict>, Refused> {
        let of_machine = self.sources.iter().flatten().map(|(name, _)| name.as_str()).next();
        let machines: Vec<&Machine> = self.sides.iter().map(|(machine, _)| *machine).collect();
        let (name, class) = stand_in(of_machine, &machines);
        let test = PairedTest::of_round(self.samples, self.sides.len(), 1);
        let filled = |side: usize, other: usize, class: Option<&Class>| {
            coverages[side].fill(self.sides[side].0, &self.bounds[side], &self.bounds[other], class)
        };
        let fill = |class: Option<&Class>| -> Result<VersusFirst, Refused> {
            let values = |side: usize, other: usize| self.draw_values(call, side, &filled(side, other, class));
            Ok(test.versus(&values(index, 0)?, &values(0, index)?))
        };
        let whole = [fill(None)?, fill(class.as_ref())?];
        let sign = if verdict == Verdict::Better { -1.0 } else { 1.0 };
        if whole.iter().all(|whole| sign * whole.minus_first.value > 0.0) {
            let lacks = |side: usize, other: usize| filled(side, other, None).len() > self.bounds[side].len();
            let differ = lacks(index, 0) || lacks(0, index);
            return Ok(Ok(differ.then(|| whole[0].minus_first)));
        }
        let lacks = |side: usize| {
            let (missing, acting) = (coverages[side].missing.len(), coverages[side].acting());
            format!("{} lacks {missing} of {acting}", shown(self.drawn.files[side]))
        };
        // Beside a machine without bounds the option would take the place of its values.
        let has_whole = [0, index].iter().any(|side| self.bounds[*side].is_empty());
        let remedy = if has_whole { format!("`class: {name}` in the file") } else { format!("`--class {name}`") };
        let reason = format!(
            "errors with neither value nor bound could turn it: {}, {}; {remedy} bounds them",
            lacks(0),
            lacks(index)
        );
        Ok(Err(WithheldVerdict {
            reason,
            as_bounded: verdict,
            missing_first: coverages[0].missing.clone(),
            missing: coverages[index].missing.clone(),
            class: name,
            minus_first_if_filled: whole.map(|whole| whole.minus_first),
        }))
    }

    /// Returns the 95 % values (um) of machines drawn between bounds of one of the machines.
    fn draw_values(&self, call: &Call<'_>, side: usize, bounds: &[Bound]) -> Result<Vec<f64>, Refused> {
        let DrawnMachines { tolerances, seed, references, .. } = self.drawn;
        let (machine, poses) = &self.sides[side];
        let (draws, statistic, samples) = (&tolerances.draws(seed), tolerances.statistic, self.samples);
        let (reference, searched, acting) = (references[side], false, ActingErrors::OfMachine);
        let request =
            Request { machine, acting, bounds, poses, reference, searched, at: None, draws, samples, statistic };
        Ok(call.stage("machines drawn", 2 * samples, |advance| budget(request, advance))?.position.drawn)
    }
}
