//! Options that the verbs about whole volumes share, and the format of their numbers.

use abbe::options::{Frame, Order};
use abbe::results::{
    MissedToolPose, NeededTravel, PathPole, PathResult, PathRewind, ReachedToolPoses, Statistics, Summary,
};
use abbe::text::{UnknownOrder, fold, shown, significant};
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) use abbe::text::axes_text;

/// `exact` or a number of 1..=6.
pub(crate) fn order(text: &str) -> Result<Order, UnknownOrder> {
    text.parse()
}

pub(crate) fn frame_text(frame: Frame) -> &'static str {
    match frame {
        Frame::Workpiece => "workpiece",
        Frame::Machine => "machine",
        Frame::Tool => "tool",
    }
}

/// `-0` is nobody's result: adding zero turns it into 0.
pub(crate) fn plain(value: f64) -> f64 {
    value + 0.0
}

/// `tool poses of part.csv, 12 more out of reach`.
pub(crate) fn tool_poses_text(reached: &ReachedToolPoses) -> String {
    let missed = match reached.rows.len() {
        0 => String::new(),
        n => format!(", {n} more out of reach"),
    };
    let what = if reached.of_axes { "poses" } else { "tool poses" };
    format!("{what} of {}{missed}", shown(&reached.file))
}

/// Number of rows out of reach that are listed one by one.
const MAX_LISTED: usize = 10;

/// Number of reversals of an axis whose lines are listed.
const REVERSALS: usize = 4;

/// Rows out of reach, one by one, and the travel that the work needs.
pub(crate) fn reach_text(missed: &[MissedToolPose], travel: &[NeededTravel]) -> String {
    let line = |miss: &MissedToolPose| {
        let feature = miss.feature.as_ref().map_or(String::new(), |feature| format!(" ({})", shown(feature)));
        format!("  line {}{feature}: {}\n", miss.line, miss.words())
    };
    let mut text = String::new();
    if !missed.is_empty() {
        text.push_str("Out of reach:\n");
        text.extend(missed.iter().take(MAX_LISTED).map(line));
        if missed.len() > MAX_LISTED {
            let more = missed.len() - MAX_LISTED;
            text.push_str(&format!("  and {more} more (`--format json` lists them row by row)\n"));
        }
    }
    if !travel.is_empty() {
        text.push_str(&format!("Travel that the tool poses need:\n{}\n", travel_table(travel)));
    }
    text
}

/// The events of a path, then the motion of each axis.
pub(crate) fn path_text(path: &PathResult) -> String {
    let PathResult { rewinds, pole_crossings, axes, deviation_step } = path;
    let count = |n: usize, noun: &str| format!("{n} {noun}{}", if n == 1 { "" } else { "s" });
    let head = [count(rewinds.len(), "rewind"), count(pole_crossings.len(), "pole crossing")].join(", ");
    let mut text = format!("One path: {head}\n");
    let rewind = |of: &PathRewind| format!("  lines {} to {}: rewind, {}\n", of.lines[0], of.lines[1], of.words());
    text.extend(rewinds.iter().take(MAX_LISTED).map(rewind));
    let pole = |of: &PathPole| {
        let rate = of
            .deg_per_mm
            .map_or("while the tip stands".to_owned(), |rate| format!("up to {} deg/mm", significant(rate, 3)));
        let [from, to] = of.lines;
        let (turn, nearest) = (significant(of.turn_deg, 4), significant(of.nearest_deg, 3));
        format!("  lines {from} to {to}: pole of {} at {nearest} deg, turns {turn} deg, {rate}\n", of.axis)
    };
    text.extend(pole_crossings.iter().take(MAX_LISTED).map(pole));
    let listed = rewinds.len().min(MAX_LISTED) + pole_crossings.len().min(MAX_LISTED);
    let more = rewinds.len() + pole_crossings.len() - listed;
    if more > 0 {
        text.push_str(&format!("  and {more} more (`--format json` lists them)\n"));
    }
    let mut rows = table(&["axis", "motion", "largest step", "line", "reversals", "first lines"]);
    for of in axes {
        let first: Vec<String> = of.reversals.iter().take(REVERSALS).map(ToString::to_string).collect();
        let dots = if of.reversals.len() > REVERSALS { " ..." } else { "" };
        let line = of.largest_step_line.map_or("-".to_owned(), |line| line.to_string());
        let (motion, step) = (significant(of.motion, 5), significant(of.largest_step, 4));
        let (axis, count) = (format!("{}, {}", of.axis, of.unit), of.reversals.len().to_string());
        let _ = rows.add_row([axis, motion, step, line, count, first.join(" ") + dots]);
    }
    let step = deviation_step.as_ref().map_or_else(String::new, |of| format!("{}\n", of.words()));
    format!("{text}{step}{rows}\n")
}

fn travel_table(travel: &[NeededTravel]) -> comfy_table::Table {
    let range = |[min, max]: [f64; 2]| format!("{} to {}", significant(min, 6), significant(max, 6));
    let row = |t: &NeededTravel| {
        let short = match t.short {
            [0.0, 0.0] => "-".to_owned(),
            [below, 0.0] => format!("{} below", significant(below, 4)),
            [0.0, above] => format!("{} above", significant(above, 4)),
            [below, above] => format!("{} below, {} above", significant(below, 4), significant(above, 4)),
        };
        let has = t.has.map_or("continuous".to_owned(), range);
        [format!("{}, {}", t.axis, t.unit), range(t.needs), has, short]
    };
    let mut rows = table(&["", "needs", "has", "short"]);
    let _ = rows.add_rows(travel.iter().map(row));
    rows
}

pub(crate) fn length(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Columns of a line of text, and of a table.
const LINE: usize = 80;
const TABLE: u16 = 100;

/// True for text as wide as it is (`--wide`).
static WIDE: AtomicBool = AtomicBool::new(false);

/// Lets text be as wide as it is.
pub(crate) fn set_wide() {
    WIDE.store(true, Ordering::Relaxed);
}

/// Returns a text whose lines are folded, but for those of tables, which are narrow already, and of machine files.
pub(crate) fn folded(text: &str) -> String {
    let is_long = |line: &str| line.chars().count() > LINE && !line.starts_with('|') && !line.contains(": {");
    let fits = |line: &str| WIDE.load(Ordering::Relaxed) || !is_long(line);
    text.lines().map(|line| if fits(line) { format!("{line}\n") } else { fold(line) }).collect()
}

/// Hides columns of a table, by their index, that do not fit beside the others; `--wide` shows them.
pub(crate) fn hide(table: &mut comfy_table::Table, columns: &[usize]) {
    if WIDE.load(Ordering::Relaxed) {
        return;
    }
    for column in columns {
        if let Some(column) = table.column_mut(*column) {
            let _ = column.set_constraint(comfy_table::ColumnConstraint::Hidden);
        }
    }
}

pub(crate) fn table(header: &[&str]) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN).set_header(header);
    if !WIDE.load(Ordering::Relaxed) {
        let _ = table.set_content_arrangement(comfy_table::ContentArrangement::Dynamic).set_width(TABLE);
    }
    table
}

/// Keeps the columns of a table as wide as their longest words.
pub(crate) fn keep_words(table: &mut comfy_table::Table) {
    for i in 0..table.column_count() {
        let cells = table.row_iter().filter_map(|row| row.cell_iter().nth(i)).map(comfy_table::Cell::content);
        let longest = cells.flat_map(|cell| cell.split(' ').map(|word| word.chars().count()).max()).max().unwrap_or(0);
        // A blank stands on each side.
        let width = comfy_table::Width::Fixed(u16::try_from(longest + 2).unwrap_or(u16::MAX));
        if let Some(column) = table.column_mut(i) {
            let _ = column.set_constraint(comfy_table::ColumnConstraint::LowerBoundary(width));
        }
    }
}

pub(crate) const STATISTICS: [&str; 9] = ["", "", "max", "mean", "rms", "95 %", "range x", "range y", "range z"];

/// Two rows: position and rotation.
pub(crate) fn statistics_rows(name: &str, statistics: &Statistics) -> [Vec<String>; 2] {
    let row = |name: &str, what: &str, s: &Summary| {
        let numbers = [s.max, s.mean, s.rms, s.p95].into_iter().chain(s.range).map(|x| significant(x, 4));
        [name.to_owned(), what.to_owned()].into_iter().chain(numbers).collect()
    };
    [row(name, "position, um", &statistics.position_um), row("", "rotation, urad", &statistics.rotation_urad)]
}

/// A table with a column for each of several machines, and one for what each differs from the first in.
pub(crate) fn table_of_machines(what: &str, count: usize) -> comfy_table::Table {
    let columns = (1..=count).map(|i| i.to_string()).chain((2..=count).map(|i| format!("{i} - 1")));
    let header: Vec<String> = std::iter::once(what.to_owned()).chain(columns).collect();
    table(&header.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Says how many errors are not listed.
pub(crate) fn errors_more(count: usize, top: usize) -> String {
    match count.saturating_sub(top) {
        0 => String::new(),
        more => format!("... and {more} errors more (`--top {count}`, or `--format json`)\n"),
    }
}

pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|x| plain(x).to_string()).collect::<Vec<_>>().join(",")
}
