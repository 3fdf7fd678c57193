//! Budgets as text: their totals, and bounds.

use abbe::results::{Bound, PERCENTS, Percentile, Totals};
use abbe::text::{angle, length, significant};

/// Heads of a table of totals.
pub(crate) const TOTALS: [&str; 9] =
    ["", "worst case", "RSS", "mean of both", "Monte Carlo: mean", "median", "90 %", "95 %", "99 %"];

/// Note below the totals.
pub(crate) const TOTALS_NOTE: &str =
    "In brackets: 95 % confidence by the number of machines drawn; - where they are too few.";

/// A row of it.
pub(crate) fn totals_row(name: &str, t: &Totals) -> Vec<String> {
    let interval = |p: Percentile| {
        let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 3));
        format!("{} ({}..{})", short(p.value), end(p.low), end(p.high))
    };
    let head = [name.to_owned(), short(t.worst_case), short(t.rss), short(t.mean_of_both()), short(t.mean.0)];
    head.into_iter().chain(PERCENTS.map(|p| interval(t.percentile(p)))).collect()
}

pub(crate) fn bound_text(bound: &Bound) -> String {
    let value = if bound.error.direction.is_rotation() { angle(bound.tolerance) } else { length(bound.tolerance) };
    format!("± {value}")
}

pub(crate) fn short(value: f64) -> String {
    significant(value, 4)
}
