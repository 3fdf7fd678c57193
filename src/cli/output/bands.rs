//! Intervals of figures by the uncertainty of the errors, as text.

use super::view::table;
use abbe::results::{Bands, SummaryBand};
use abbe::text::{counted, ends, significant};
use std::collections::BTreeMap;

/// A table of intervals, a row for positions and one for rotations of each name.
pub(crate) fn text(of: &[(String, &Bands)]) -> String {
    let Some((_, first)) = of.first() else { return String::new() };
    let mut rows = table(&["", "", "max", "mean", "rms", "95 %"]);
    for (name, bands) in of {
        let row = |name: &str, what: &str, s: &SummaryBand| -> Vec<String> {
            let ends = [s.max, s.mean, s.rms, s.p95].map(|[low, high]| {
                let [low, high] = ends(low, high);
                format!("{low} to {high}")
            });
            [name.to_owned(), what.to_owned()].into_iter().chain(ends).collect()
        };
        let _ = rows.add_row(row(name, "position, um", &bands.position_um));
        let _ = rows.add_row(row("", "rotation, urad", &bands.rotation_urad));
    }
    let how = if first.drawn { "drawn, the middle 95 %" } else { "first order, k = 2" };
    let parts = counted(first.parts, "independent part");
    format!("With the uncertainty of the errors ({parts}; {how}) the figures lie within:\n{rows}\n")
}

/// Measured ranges in words, mm and deg.
pub(crate) fn ranges(of: &BTreeMap<String, [f64; 2]>) -> String {
    let range = |(axis, [min, max]): (&String, &[f64; 2])| {
        format!("{axis} from {} to {}", significant(*min, 6), significant(*max, 6))
    };
    of.iter().map(range).collect::<Vec<_>>().join(", ")
}
