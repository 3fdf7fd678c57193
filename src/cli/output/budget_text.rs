//! Budgets as text: their totals, and tolerances.

use super::view::{hide, table};
use abbe::results::{ActingValues, Coverage, DeviationBudget, PercentileInterval};
use abbe::text::{angle, counted, length, significant, within};

const TOTALS: [&str; 9] =
    ["", "worst case", "RSS", "mean of both", "Monte Carlo: mean", "median", "90 %", "95 %", "99 %"];

/// Columns of these that only `--wide` shows.
const TOTALS_WIDE: [usize; 3] = [3, 5, 6];

/// Returns the table of totals with these rows.
pub(crate) fn totals(rows: Vec<Vec<String>>) -> comfy_table::Table {
    let mut totals = table(&TOTALS);
    let _ = totals.add_rows(rows);
    hide(&mut totals, &TOTALS_WIDE);
    totals
}

pub(crate) const TOTALS_NOTE: &str =
    "In brackets: 95 % confidence by the number of machines drawn; - where they are too few.";

pub(crate) fn totals_row(name: &str, t: &DeviationBudget) -> Vec<String> {
    let interval = |p: &PercentileInterval| within(p.value, p.low, p.high);
    let head = [name.to_owned(), short(t.worst_case), short(t.rss), short(t.mean_of_both), short(t.monte_carlo.mean)];
    head.into_iter().chain(t.monte_carlo.percentiles.values().map(interval)).collect()
}

/// The line that counts the bounded among the acting errors of a machine, beside those with a value, and names the
/// others.
pub(crate) fn coverage_line(of: &Coverage) -> Option<String> {
    let (valued, bounded, acting) = (of.valued, of.bounded, of.acting());
    // What a measured machine does not state is zero.
    if bounded == 0 && (valued > 0 || of.missing.is_empty()) {
        return None;
    }
    let known = match (valued, of.missing.len()) {
        (0, 0) => return Some(format!("all {acting} errors that act are bounded")),
        (0, _) => format!("{bounded} of {acting} errors that act are bounded"),
        _ => format!("of {acting} errors that act {valued} have a value, {bounded} a bound"),
    };
    Some(match of.missing.len() {
        0 => known,
        n => format!("{known}; {n} have neither value nor bound (`--class` has some): {}", of.missing.join(", ")),
    })
}

/// The lines of the errors with values: of those that are left out, and of those that act in every machine drawn.
pub(crate) fn values_text(left_out: usize, with_values: Option<ActingValues>) -> String {
    let mut text = String::new();
    if left_out > 0 {
        text += &format!("{} with a value left out: bounds stand for them\n", counted(left_out, "error"));
    }
    if let Some(ActingValues { errors, um_of_p95 }) = with_values {
        let (errors, um) = (counted(errors, "error"), significant(um_of_p95, 4));
        text += &format!("{errors} with a value in every machine drawn: {um} um of the 95 % value\n");
    }
    text
}

/// A tolerance in um or urad as `± 20 um`.
pub(crate) fn tolerance_text(tolerance: f64, unit: &str) -> String {
    let value = if unit == "um" { length(tolerance * 1e-3) } else { angle(tolerance * 1e-6) };
    format!("± {value}")
}

pub(crate) fn short(value: f64) -> String {
    significant(value, 4)
}
