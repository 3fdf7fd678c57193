//! Budgets as text: their totals, and tolerances.

use abbe::results::{Coverage, DeviationBudget, PercentileInterval};
use abbe::text::{angle, length, significant};

pub(crate) const TOTALS: [&str; 9] =
    ["", "worst case", "RSS", "mean of both", "Monte Carlo: mean", "median", "90 %", "95 %", "99 %"];

pub(crate) const TOTALS_NOTE: &str =
    "In brackets: 95 % confidence by the number of machines drawn; - where they are too few.";

pub(crate) fn totals_row(name: &str, t: &DeviationBudget) -> Vec<String> {
    let interval = |p: &PercentileInterval| {
        let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 3));
        format!("{} ({}..{})", short(p.value), end(p.low), end(p.high))
    };
    let head = [name.to_owned(), short(t.worst_case), short(t.rss), short(t.mean_of_both), short(t.monte_carlo.mean)];
    head.into_iter().chain(t.monte_carlo.percentiles.values().map(interval)).collect()
}

/// How many of the acting errors of a machine without measured values are bounded, and which are not.
pub(crate) fn coverage_line(of: &Coverage) -> Option<String> {
    if of.valued > 0 || (of.bounded == 0 && of.missing.is_empty()) {
        return None;
    }
    let (bounded, acting) = (of.bounded, of.acting());
    Some(match of.missing.len() {
        0 => format!("all {acting} errors that act are bounded"),
        n => format!(
            "{bounded} of {acting} errors that act are bounded; {n} have neither value nor bound (`--class` has some): \
             {}",
            of.missing.join(", ")
        ),
    })
}

/// A tolerance in um or urad as `± 20 um`.
pub(crate) fn tolerance_text(tolerance: f64, unit: &str) -> String {
    let value = if unit == "um" { length(tolerance * 1e-3) } else { angle(tolerance * 1e-6) };
    format!("± {value}")
}

pub(crate) fn short(value: f64) -> String {
    significant(value, 4)
}
