//! Effect of bounds as text, for `map` and `compare`.

use super::view::{axes_text, statistics_rows, table};
use abbe::MachineFile;
use abbe::results::{
    AddedByBounds, BoundedFigures, BoundedLengths, LengthStatistics, MapFromBounds, RssDifference, Statistics,
};
use abbe::text::{counted, significant, within};
use comfy_table::Table;

/// `From bounds: 41 errors, class production; 1000 machines drawn, uniform distribution, seed 1`.
pub(crate) fn source(of: &BoundedFigures) -> String {
    format!("From bounds: {}{}; {}", counted(of.errors, "error"), of.drawing.class_words(), of.drawing.words())
}

/// Explanation of the rows of the statistics.
pub(crate) const ROWS_NOTE: &str = "95 %: what 95 % of the machines drawn do not exceed at a pose; ranges likewise.\n\
     RSS: root of the sum of squares of the errors at their bounds, at a pose.";

/// Rows of the 95 % value and of the RSS, position and rotation; the name is in front of the first.
pub(crate) fn rows(name: &str, poses: usize, of: &BoundedFigures) -> Vec<Vec<String>> {
    let [mut position, mut rotation] = statistics_rows(name, &of.statistics(poses));
    position[1] = "position 95 %, um".to_owned();
    rotation[1] = "rotation 95 %, urad".to_owned();
    let [of_position, of_rotation] = [&of.position_um.rss, &of.rotation_urad.rss].map(four);
    vec![position, rss_row("position RSS, um", of_position), rotation, rss_row("rotation RSS, urad", of_rotation)]
}

/// Rows of the differences of the 95 % values and of the RSS.
pub(crate) fn difference_rows(name: &str, p95: &Statistics, rss: &RssDifference) -> Vec<Vec<String>> {
    let [mut position, mut rotation] = statistics_rows(name, p95);
    position[1] = "position 95 %, um".to_owned();
    rotation[1] = "rotation 95 %, urad".to_owned();
    let rows =
        [rss_row("position RSS, um", four(&rss.position_um)), rss_row("rotation RSS, urad", four(&rss.rotation_urad))];
    let [of_position, of_rotation] = rows;
    vec![position, of_position, rotation, of_rotation]
}

fn four(of: &LengthStatistics) -> [f64; 4] {
    [of.max, of.mean, of.rms, of.p95]
}

fn rss_row(what: &str, rss: [f64; 4]) -> Vec<String> {
    let numbers = rss.map(|x| significant(x, 4));
    let ranges = ["-"; 3].map(str::to_owned);
    [String::new(), what.to_owned()].into_iter().chain(numbers).chain(ranges).collect()
}

pub(crate) fn statistics(poses: usize, of: &BoundedFigures) -> Table {
    let mut table = table(&["", "max", "mean", "rms", "95 % of poses", "range x", "range y", "range z"]);
    let _ = table.add_rows(rows("", poses, of).into_iter().map(|row| row.into_iter().skip(1).collect::<Vec<_>>()));
    table
}

/// The largest deviations of the machines drawn.
pub(crate) fn everywhere(of: &BoundedFigures) -> String {
    let interval = |of: &BoundedLengths| {
        let (low, high) = of.monte_carlo.percentiles.get("p95").map_or((None, None), |p| (p.low, p.high));
        within(of.monte_carlo.p95, low, high)
    };
    format!(
        "95 % of the machines deviate nowhere by more than {} um and {} urad (in brackets: 95 % confidence).\n",
        interval(&of.position_um),
        interval(&of.rotation_urad)
    )
}

/// The poses with the largest 95 % values.
pub(crate) fn worst(file: &MachineFile, of: &MapFromBounds) -> String {
    let line = |(i, worst): (usize, &abbe::results::WorstBoundedPose)| {
        let lead = if i == 0 { "Worst:" } else { "      " };
        let [p95, rss] = [worst.p95_um, worst.rss_um].map(|x| significant(x, 4));
        format!("{lead} 95 % {p95} um, RSS {rss} um at {}\n", axes_text(file, worst.axes.values()))
    };
    of.worst.iter().enumerate().map(line).collect()
}

/// Describes the contribution of bounded errors beside measured ones of bounds beside measured errors.
pub(crate) fn bounded_contribution(of: &AddedByBounds) -> String {
    let [rss, p95] = [of.position_um.rss, of.position_um.p95].map(|x| significant(x, 4));
    let errors = counted(of.errors, "error");
    format!(
        "Not in these figures: {errors} without a value and only bounded. By themselves they make {p95} um (95 % of {} \
         machines drawn, seed {}, largest of {} poses) and {rss} um RSS.\n",
        of.samples, of.seed, of.poses
    )
}
