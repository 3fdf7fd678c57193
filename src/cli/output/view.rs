//! Options that the verbs about whole volumes share, and the format of their numbers.

use abbe::options::{Approach, Frame, Order};
use abbe::results::{ReachedToolPoses, Statistics, Summary};
use abbe::text::{UnknownOrder, shown, significant};

pub(crate) use abbe::text::axes_text;

/// Options of the evaluation and of its tool.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ViewArgs {
    /// 1 to 6, or `exact` (the default, unless the conventions' preset names an order).
    #[arg(long, value_parser = order)]
    pub(crate) order: Option<Order>,
    /// Direction of approach where forward and reverse curves were given.
    #[arg(long, value_enum, default_value = "mean")]
    direction: ApproachArg,
    /// Tool of the machine, by name [default: the first].
    #[arg(long)]
    pub(crate) tool: Option<String>,
}

impl ViewArgs {
    pub(crate) fn approach(&self) -> Approach {
        self.direction.into()
    }
}

/// Frame of vectors.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum FrameArg {
    Workpiece,
    Machine,
    Tool,
}

impl From<FrameArg> for Frame {
    fn from(arg: FrameArg) -> Self {
        match arg {
            FrameArg::Workpiece => Self::Workpiece,
            FrameArg::Machine => Self::Machine,
            FrameArg::Tool => Self::Tool,
        }
    }
}

/// Direction of approach.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum ApproachArg {
    Mean,
    Forward,
    Reverse,
}

impl From<ApproachArg> for Approach {
    fn from(arg: ApproachArg) -> Self {
        match arg {
            ApproachArg::Mean => Self::Mean,
            ApproachArg::Forward => Self::Forward,
            ApproachArg::Reverse => Self::Reverse,
        }
    }
}

/// `exact` or a number of 1..=6.
pub(crate) fn order(text: &str) -> Result<Order, UnknownOrder> {
    text.parse()
}

/// Name of the frame as printed.
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
    format!("tool poses of {}{missed}", shown(&reached.file))
}

/// Length of a vector.
pub(crate) fn length(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// A table for the terminal, with its header.
pub(crate) fn table(header: &[&str]) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN).set_header(header);
    table
}

/// Header of tables of statistics.
pub(crate) const STATISTICS: [&str; 9] = ["", "", "max", "mean", "rms", "95 %", "range x", "range y", "range z"];

/// Two rows: position and rotation.
pub(crate) fn statistics_rows(name: &str, statistics: &Statistics) -> [Vec<String>; 2] {
    let row = |name: &str, what: &str, s: &Summary| {
        let numbers = [s.max, s.mean, s.rms, s.p95].into_iter().chain(s.range).map(|x| significant(x, 4));
        [name.to_owned(), what.to_owned()].into_iter().chain(numbers).collect()
    };
    [row(name, "position, um", &statistics.position_um), row("", "rotation, urad", &statistics.rotation_urad)]
}

/// A cell of a CSV file, quoted where it has to be.
pub(crate) fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// Numbers of a CSV line.
pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|x| plain(x).to_string()).collect::<Vec<_>>().join(",")
}
