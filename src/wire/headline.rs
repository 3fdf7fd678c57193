//! The first line of a result's text: the figure that a verb is asked for, with its interval, and how much of the work
//! it is over. The program begins with it, and Python shows it.

use crate::analysis::budget::Statistic;
use crate::api::results::{
    BudgetResult, CertificateBands, CertificateReport, CompareResult, ComparedMachine, EnumerateResult,
    EquationsResult, EvalResult, IdentifyResult, MachineDifference, MachineVerdict, MapResult, MeasurementPlan, Over,
    OverKind, PercentileInterval, PredictedReadings, ROUNDING_UM, RankedArrangements, ReachResult, SetDifference,
    Summary, TargetComparison, Verdict,
};
use crate::job::limit::LimitVerdict;
use crate::units::{counted, ends, fold, significant, with_interval, within};
use nalgebra::Vector3;

/// Largest factor that is stated: what is left then is less than anybody knows of the errors.
const MAX_FACTOR: f64 = 1000.0;
/// Errors without an uncertainty that are named.
const NAMED: usize = 4;

fn short(value: f64) -> String {
    significant(value, 4)
}

/// A figure against the limit of the job.
pub fn limit(limit: Option<&LimitVerdict>) -> String {
    limit.map_or_else(String::new, |limit| format!("Job: {}\n", limit.words()))
}

/// `over 298 of 300 tool poses`.
pub fn over(of: &Over) -> String {
    let what = match of.kind {
        OverKind::Volume | OverKind::AxisPoses => "pose",
        OverKind::Job => "tool pose",
    };
    let all = counted(of.poses, what);
    if of.reached < of.poses { format!("over {} of {all}", of.reached) } else { format!("over {all}") }
}

fn of_machines(value: f64, interval: Option<&PercentileInterval>) -> String {
    interval.map_or_else(|| short(value), |of| within(value, of.low, of.high))
}

/// Returns that of a map.
pub fn map(of: &MapResult) -> String {
    let over = over(&of.over);
    let limit = limit(of.limit.as_ref());
    if let Some(bounds) = &of.bounds {
        let of = &bounds.figures.position_um.monte_carlo;
        let um = of_machines(of.p95, of.percentiles.get("p95"));
        let drawn = bounds.figures.drawing.samples;
        return format!("{limit}Position deviation: 95 % of {drawn} machines drawn within {um} um, {over}.\n");
    }
    if of.position_um.max == 0.0 && of.uncompensated.is_none() {
        return format!("{limit}Position deviation: 0 um, for no error with a value acts, {over}.\n");
    }
    let band = of.uncertainty.as_ref().map(|of| &of.position_um);
    let p95 = with_interval(of.position_um.p95, band.map(|band| band.p95));
    let max = with_interval(of.position_um.max, band.map(|band| band.max));
    let without = of
        .uncompensated
        .as_ref()
        .map_or_else(String::new, |of| format!(" instead of {} um", short(of.position_um.p95)));
    let left_out = of
        .bounds_add
        .as_ref()
        .map_or_else(String::new, |of| format!(", {} left out", counted(of.errors, "bounded error")));
    format!(
        "{limit}Position deviation: 95 % of the poses within {p95} um{without}, the largest {max} um, \
         {over}{left_out}.\n"
    )
}

/// Returns that of a budget.
pub fn budget(of: &BudgetResult) -> String {
    let position = &of.budget.position_um;
    let um = of_machines(position.monte_carlo.p95, position.monte_carlo.percentiles.get("p95"));
    let at = match of.budget.drawing.statistic {
        Statistic::Max => "",
        Statistic::P95 => " at 95 % of the poses",
    };
    format!(
        "{}Position deviation: 95 % of {} machines drawn within {um} um{at}; RSS {} um, worst case {} um; {}.\n",
        limit(of.limit.as_ref()),
        of.budget.drawing.samples,
        short(position.rss),
        short(position.worst_case),
        over(&of.over)
    )
}

/// Returns how many unknowns a fit determines: `3 of 4 unknowns (4 with products of errors)`.
pub fn rank(first_order: usize, exact: usize, unknowns: usize) -> String {
    if exact > first_order {
        format!("{first_order} of {} ({exact} with products of errors)", counted(unknowns, "unknown"))
    } else {
        format!("{exact} of {}", counted(unknowns, "unknown"))
    }
}

/// Returns that of a fit.
pub fn identify(of: &IdentifyResult) -> String {
    let prediction = match of.prediction.largest_um {
        Some(size) if of.prediction.held => {
            format!("; predicts the volume with u = {} um at most", significant(size, 2))
        }
        _ => "; some of the volume is not predicted".to_owned(),
    };
    let stopped = if of.settled { "" } else { "NOT SETTLED: " };
    format!(
        "{stopped}{} determined by {}; rms {} um before, {} um after{prediction}.\n",
        rank(of.rank_first_order, of.rank, of.unknowns),
        counted(of.rows, "reading"),
        significant(of.rms_um.before, 3),
        significant(of.rms_um.after, 3),
    )
}

/// Returns that of a plan of measurements.
pub fn plan(of: &MeasurementPlan) -> String {
    let unknowns = counted(of.unknowns, "unknown");
    let readings = counted(of.readings, "reading");
    let goal = of.goal.map_or_else(String::new, |goal| {
        let verb = if goal.reached { "is reached by" } else { "is NOT reached by" };
        format!("u = {} um over the volume {verb} {readings}.\n", significant(goal.um, 4))
    });
    format!("{goal}{} of {unknowns} determined by {readings}.\n", of.well_determined)
}

/// Returns that of readings against a machine file.
pub fn predict(of: &PredictedReadings) -> String {
    fold(&format!("Readings predicted by the file, less the set-up, RMS: {}.", of.words))
}

/// Returns that of a study; nothing of a part of one.
pub fn study(of: &EnumerateResult) -> String {
    if let EnumerateResult::Ranked(ranked) = of { enumerate(ranked) } else { String::new() }
}

/// Returns that of a ranking.
pub fn enumerate(of: &RankedArrangements) -> String {
    let Some(first) = of.ranked.first() else { return String::new() };
    let um = first.um.map_or_else(String::new, |um| match first.low.or(first.high) {
        Some(_) => format!(", {} um", within(um, first.low, first.high)),
        None => format!(", {} um", short(um)),
    });
    let open = of.count(Verdict::NotToldApart) + of.ranked.iter().filter(|row| row.withheld.is_some()).count();
    let apart = match (of.ranked.len(), open) {
        (1, _) => String::new(),
        (all, 0) => format!("; told apart from the other {} ranked", all - 1),
        (all, open) => format!("; not told apart from {open} of the other {} ranked", all - 1),
    };
    format!("First: {}{um}, {}{apart}.\n", first.chain, over(&of.over))
}

/// Returns that of a certificate: what a second measurement says of the files, then by how much they lower the
/// deviation, over the job first.
pub fn certificate(report: &CertificateReport) -> String {
    let measured = report.second.as_ref().map_or_else(String::new, |of| {
        format!("Measured with the set in force, less the set-up, RMS: {}.\n", of.words)
    });
    let raised = |words: Option<String>, over: &str| {
        words.map_or_else(String::new, |words| format!("The files RAISE {words}, {over}.\n"))
    };
    let job = report.job.as_ref().map_or_else(String::new, |job| {
        let over = over(&job.over);
        let ratio = ratio(&job.uncompensated.position_um, &job.compensated.position_um, None, &over);
        raised(job.raised(), &over) + &ratio
    });
    let part = if report.beyond_measured.is_some() { "measured part of the " } else { "" };
    let over = format!("over {} of the {part}volume", counted(report.poses, "pose"));
    let left = report.uncertainty.as_ref();
    let (before, after) = (&report.uncompensated.position_um, &report.compensated.position_um);
    measured + &job + &raised(report.raised(), &over) + &ratio(before, after, left, &over)
}

/// Returns that of a comparison of targets.
pub fn compare_targets(of: &TargetComparison) -> String {
    let Some(best) = of.targets.first() else { return "No target has files for this machine.\n".to_owned() };
    if !of.is_measured() {
        return "Nothing to correct yet: no error with a value acts.\n".to_owned();
    }
    let (before, after) = best.deciding_um();
    let left = if after < ROUNDING_UM { "less than a nanometre".to_owned() } else { format!("{} um", short(after)) };
    let figure = match best.over.kind {
        OverKind::Job | OverKind::AxisPoses => "largest",
        OverKind::Volume => "95 %",
    };
    let target = &best.target;
    fold(&format!("Least is left by {target}: {left} of the {figure} position deviation of {} um.", short(before)))
}

/// Returns by what factor the deviation falls, and what is left within the uncertainty of the errors.
fn ratio(before: &Summary, after: &Summary, left: Option<&CertificateBands>, over: &str) -> String {
    let (before, after) = (before.p95, after.p95);
    let [from, to] = [before, after].map(|um| significant(um, 4));
    let deviation = "For the errors in the file the 95 % position deviation";
    let falls = format!("{deviation} falls from {from} um");
    let left = left.map_or_else(String::new, |of| {
        let [low, high] = of.compensated.position_um.p95;
        let [low, high] = ends(low, high);
        let without = match &of.not_stated[..] {
            [] => String::new(),
            few if few.len() <= NAMED => format!(" (none is stated of {})", few.join(", ")),
            many => format!(" (none is stated of {} and {} more)", many[..NAMED].join(", "), many.len() - NAMED),
        };
        format!("; within their uncertainty{without} {low} to {high} um are left")
    });
    if before.max(after) < ROUNDING_UM {
        format!("There is nothing to compensate, {over}.\n")
    } else if after < ROUNDING_UM {
        format!("{falls} to below a nanometre, {over}{left}.\n")
    } else if before > MAX_FACTOR * after {
        format!("{falls} to {to} um, by a factor of more than {MAX_FACTOR}, {over}{left}.\n")
    } else if from == to {
        format!("{deviation} stays at {from} um, {over}{left}.\n")
    } else if after <= before {
        format!("{falls} to {to} um, by a factor of {}, {over}{left}.\n", significant(before / after, 3))
    } else {
        String::new()
    }
}

/// The verdict on each machine, or the reason why there is none.
pub fn compare(result: &CompareResult) -> String {
    let over = format!(", over {} of {} tool poses", result.poses, result.asked);
    let of = |verdict: &MachineVerdict| {
        let (machine, by) = (verdict.machine, verdict.by.as_ref().map_or_else(String::new, |by| by.words()));
        match (&verdict.verdict, &verdict.reason) {
            (Some(known), _) => format!("Machine {machine} against 1: {}; {by}{over}.", known.words()),
            (None, reason) => {
                let reason = reason.as_deref().unwrap_or_default();
                format!("Machine {machine} against 1: no verdict: {reason}{over}.\n")
            }
        }
    };
    let limit = |(i, side): (usize, &ComparedMachine)| Some(format!("Machine {i}: {}\n", side.limit.as_ref()?.words()));
    let limits: String = (1..).zip(&result.machines).filter_map(limit).collect();
    limits + &out_of_reach(result) + &result.verdicts.iter().map(of).collect::<String>()
}

/// Tool poses of a part that some machine does not reach: verdicts and figures are without them.
fn out_of_reach(result: &CompareResult) -> String {
    let missed: Vec<String> = (1..)
        .zip(&result.machines)
        .filter(|(_, side)| side.unreachable.total > 0)
        .map(|(i, side)| format!("{} of machine {i}", side.unreachable.total))
        .collect();
    if missed.is_empty() || result.over.kind != OverKind::Job {
        return String::new();
    }
    let (asked, common) = (result.asked, result.poses);
    format!("Out of reach of {asked} tool poses: {}; judged are the {common} that all reach.\n", missed.join(", "))
}

/// Returns that of the reach.
pub fn reach(of: &ReachResult) -> String {
    let percent = |part: usize, whole: usize| significant(100.0 * part as f64 / whole as f64, 4);
    let reached =
        format!("Reached: {} % of {}", percent(of.reached, of.tool_poses), counted(of.tool_poses, "tool pose"));
    if of.job.is_some() {
        return format!("{reached}.\n");
    }
    let [any, all] = [of.tips_in_any_direction, of.tips_in_all_directions].map(|part| percent(part, of.tips));
    format!("{reached}; in any direction {any} % of {}, in all directions {all} %.\n", counted(of.tips, "tip"))
}

/// Returns that of deviations at poses: the largest.
pub fn eval(of: &EvalResult) -> String {
    let size = |v: [f64; 3]| 1e3 * Vector3::from(v).norm();
    let largest = of.poses.iter().map(|pose| size(pose.deviation)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((at, um)) = largest else { return String::new() };
    match of.poses.len() {
        1 => format!("Position deviation: {} um.\n", short(um)),
        count => format!("Position deviation: at most {} um, at pose {} of {count}.\n", short(um), at + 1),
    }
}

/// Returns that of the difference of two machines.
pub fn diff(of: &MachineDifference) -> String {
    if of.differences.is_empty() {
        return "The machines do not differ.\n".to_owned();
    }
    let what = if of.from.is_some() { "of machines drawn" } else { "of the poses" };
    let [first, second] = of.p95_um.map(short);
    format!(
        "{}; position deviation, 95 % {what}: {first} um -> {second} um, over {} of {} tool poses.\n",
        counted(of.differences.len(), "difference"),
        of.poses,
        of.asked
    )
}

/// Returns that of the difference of two sets of files.
pub fn diff_sets(of: &SetDifference) -> String {
    let [max, p95] = [of.position_um.max, of.position_um.p95].map(short);
    format!("The functional point moves by at most {max} um, 95 % {p95} um.\n")
}

/// Returns that of closed forms: their degree, the number of symbols, and the terms of the displacement.
pub fn equations(of: &EquationsResult) -> String {
    let terms = |k: usize| of.deviation.get(k).map_or(0, |one| one.terms.len());
    format!(
        "Deviations to degree {} in {}: {}, {} and {} terms along x, y, z.\n",
        of.degree,
        counted(of.symbols.iter().filter(|symbol| symbol.kind == "error").count(), "error"),
        terms(0),
        terms(1),
        terms(2)
    )
}
