//! The first line of a text: the figure that a verb is asked for, with its interval, and how much of the work it is
//! over.

use super::budget_text::short;
use super::view::limit_text;
use abbe::options::Statistic;
use abbe::results::{
    BudgetResult, IdentifyResult, MapResult, MeasurementPlan, Over, OverKind, PercentileInterval, RankedArrangements,
    Verdict,
};
use abbe::text::{counted, significant, with_interval, within};

/// `over 298 of 300 tool poses`.
pub(crate) fn over(of: &Over) -> String {
    let what = match of.kind {
        OverKind::Volume => "pose",
        OverKind::Job => "tool pose",
    };
    let all = counted(of.poses, what);
    if of.reached < of.poses { format!("over {} of {all}", of.reached) } else { format!("over {all}") }
}

fn of_machines(value: f64, interval: Option<&PercentileInterval>) -> String {
    interval.map_or_else(|| short(value), |of| within(value, of.low, of.high))
}

pub(crate) fn map(of: &MapResult) -> String {
    let over = over(&of.over);
    let limit = limit_text(of.limit.as_ref());
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

pub(crate) fn budget(of: &BudgetResult) -> String {
    let position = &of.budget.position_um;
    let um = of_machines(position.monte_carlo.p95, position.monte_carlo.percentiles.get("p95"));
    let at = match of.budget.drawing.statistic {
        Statistic::Max => "",
        Statistic::P95 => " at 95 % of the poses",
    };
    format!(
        "{}Position deviation: 95 % of {} machines drawn within {um} um{at}; RSS {} um, worst case {} um; {}.\n",
        limit_text(of.limit.as_ref()),
        of.budget.drawing.samples,
        short(position.rss),
        short(position.worst_case),
        over(&of.over)
    )
}

/// Returns how many unknowns a fit determines: `3 of 4 unknowns (4 with products of errors)`.
pub(crate) fn rank(first_order: usize, exact: usize, unknowns: usize) -> String {
    if exact > first_order {
        format!("{first_order} of {} ({exact} with products of errors)", counted(unknowns, "unknown"))
    } else {
        format!("{exact} of {}", counted(unknowns, "unknown"))
    }
}

pub(crate) fn identify(of: &IdentifyResult) -> String {
    let prediction = match of.prediction.largest_um {
        Some(size) if of.prediction.held => {
            format!("; predicts the volume to u = {} um or better", significant(size, 2))
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

pub(crate) fn plan(of: &MeasurementPlan) -> String {
    let unknowns = counted(of.unknowns, "unknown");
    format!("{} of {unknowns} determined by {}.\n", of.well_determined, counted(of.readings, "reading"))
}

pub(crate) fn enumerate(of: &RankedArrangements) -> String {
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
