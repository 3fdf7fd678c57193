//! `abbe map`: the error over a volume.

use crate::analysis::map;
use crate::analysis::{Diagonal, MAX_POSES, MAX_SURVEYED, SurveyTask, View, body_diagonals, rest};
use crate::cli::how::CompensationArgs;
use crate::cli::output::map_output::Outputs;
use crate::cli::output::map_picture::{Pictures, Subject};
use crate::cli::output::map_survey::surveyed;
use crate::cli::output::progress::Progress;
use crate::cli::output::session::Session;
use crate::cli::output::view::{
    FrameArg, STATISTICS, ViewArgs, axes_json, axes_text, frame_text, order_text, statistics_rows, table,
};
use crate::cli::set_effect;
use crate::cli::store::write::refuse_outputs;
use crate::cli::tool_poses;
use crate::cli::tool_poses::Reached;
use crate::cli::{Exit, Format, Outcome, load};
use crate::controller::{ControllerTarget, Depth, Effect};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{CompiledField, Deviation, Field, Nodes, Order, Poses, Random, Spread, Statistics, Tally, worst};
use crate::machine::Machine;
use crate::report::{RowFormat, Rows};
use crate::units::significant;
use serde_json::json;
use std::io::Cursor;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; its `volume` is the grid.
    machine: PathBuf,
    /// So many random poses over the volume instead of the grid.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SURVEYED as i64))]
    random: Option<u32>,
    /// So many low-discrepancy poses over the volume: spread more evenly than random ones.
    #[arg(long, value_name = "N", conflicts_with = "random", value_parser = clap::value_parser!(u32).range(1..=MAX_SURVEYED as i64))]
    low_discrepancy: Option<u32>,
    /// The poses for these tool poses in the workpiece frame instead of the grid: a CSV file with columns X, Y, Z and
    /// I, J, K or rotary axes.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["random", "low_discrepancy"])]
    tool_poses: Option<PathBuf>,
    /// Seed of the random or low-discrepancy poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Map what the compensation of a controller leaves, beside what is there without it.
    #[arg(long, value_name = "NAME")]
    target: Option<String>,
    #[command(flatten)]
    how: CompensationArgs,
    #[command(flatten)]
    view: ViewArgs,
    /// Frame of the vectors.
    #[arg(long, value_enum, default_value = "workpiece")]
    frame: FrameArg,
    /// How many of the worst poses to name.
    #[arg(long, value_name = "K", default_value_t = 5, value_parser = clap::value_parser!(u32).range(..=100_000))]
    worst: u32,
    #[command(flatten)]
    outputs: Outputs,
    #[command(flatten)]
    pictures: Pictures,
}

/// A target and what it does.
type Compensation = (ControllerTarget, Effect);

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.view.tool.as_deref())?;
    load::warn_bounded(session, &machine);
    let order = args.view.order(&machine);
    let view = View { approach: args.view.approach(), frame: args.frame.into() };
    // What can be refused is refused before the work, not after it.
    let outputs = args.outputs.paths().chain(args.pictures.paths());
    refuse_outputs(outputs, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    let place = args.pictures.place(session, &machine, args.target.is_some())?;
    let reached = tool_poses::asked(session, &machine, args.tool_poses.as_deref())?;
    let compensation = compensation(session, args, &machine, order)?;
    let bare = CompiledField::new(&machine, order);
    let replayed = compensation.as_ref().map(|(target, effect)| effect.field(&machine, target));
    let field: &dyn Field = replayed.as_ref().map_or(&bare as &dyn Field, |field| &**field);
    let poses = poses(args, &machine, reached.as_ref());
    if poses.len() > MAX_SURVEYED {
        return session.refuse(too_many(poses.len()));
    }
    let target = args.target.as_deref().unwrap_or_default();
    let reached = reached.as_ref();
    let whole = Whole { machine: &machine, poses: &poses, reached, view, order, target, worst: args.worst as usize };
    let before = match &replayed {
        Some(_) => Some(whole.found(session, &bare, None)?.statistics),
        None => None,
    };
    let found = whole.found(session, field, Some(&args.outputs))?;
    if let Some(place) = place {
        let state = if target.is_empty() { String::new() } else { format!("after {target}") };
        let subject = Subject { field, state: &state };
        let before = replayed.is_some().then_some(&bare as &dyn Field);
        args.pictures.write(session, &place, (&subject, before), (view, order))?;
    }
    let diagonals = body_diagonals(field, &rest(&machine), DIAGONAL_STEPS, view.approach);
    let report = Report { whole: &whole, found, before, diagonals };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.found.csv.clone().unwrap_or_default()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

/// Intervals of a body diagonal.
const DIAGONAL_STEPS: usize = 20;

fn poses(args: &Args, machine: &Machine, reached: Option<&Reached>) -> Poses {
    if let Some(reached) = reached {
        return Poses::Listed(reached.poses.clone());
    }
    match (args.random, args.low_discrepancy) {
        (Some(count), _) => Poses::Random(Random::of(machine, count as usize, args.seed)),
        (None, Some(count)) => Poses::Spread(Spread::of(machine, count as usize, args.seed)),
        (None, None) => Poses::Nodes(Nodes::of(machine)),
    }
}

/// Poses at which the warnings of a compensation are found.
const CERTIFIED: usize = 1000;

/// What `compile` would write for the target, with its warnings.
fn compensation(
    session: &mut Session,
    args: &Args,
    machine: &Machine,
    order: Order,
) -> Result<Option<Compensation>, Exit> {
    let Some(name) = &args.target else { return Ok(None) };
    if order != Order::Exact {
        return session.usage(
            "a compensated machine is mapped with the exact model: leave `--order` out, or say `--order exact`",
        );
    }
    let depth = Depth { poses: CERTIFIED, seed: args.seed };
    let (target, effect, _) = set_effect::compiled(session, machine, name, &args.how, depth)?;
    Ok(Some((target, effect)))
}

fn too_long(count: usize) -> Diagnostic {
    Diagnostic::new(codes::E0541, format!("a table of {count} poses does not go to standard output: {MAX_POSES} at most"))
        .help("write it to a file with `--csv FILE` or `--parquet FILE`: that takes no memory, but 80 to 200 bytes of disk per pose")
}

fn too_many(count: usize) -> Diagnostic {
    let count = if count == usize::MAX { "more than can be counted".to_owned() } else { count.to_string() };
    Diagnostic::new(
        codes::E0812,
        format!("the grid of the volume has {count} poses; a map takes {MAX_SURVEYED} at most"),
    )
    .help("take random poses (`--random 100000`), or larger steps under `volume` in the machine file")
}

/// Everything that is mapped.
struct Whole<'a> {
    machine: &'a Machine,
    poses: &'a Poses,
    /// Where they come from, if from a file.
    reached: Option<&'a Reached>,
    view: View,
    order: Order,
    target: &'a str,
    worst: usize,
}

/// What a map has found.
pub(crate) struct SurveyResult {
    pub statistics: Statistics,
    /// The worst poses by number, largest deviation first.
    pub worst: Vec<(usize, Deviation)>,
    /// Is the quantile that of a sketch?
    pub sketched: bool,
    /// What goes to standard output.
    pub csv: Option<String>,
}

impl Whole<'_> {
    /// Maps a field; `outputs` are written, if there are any.
    fn found(&self, session: &mut Session, field: &dyn Field, outputs: Option<&Outputs>) -> Result<SurveyResult, Exit> {
        let printed = session.format() == Format::Csv && outputs.is_some();
        let Self { machine, poses, view, order, target, .. } = *self;
        let rows = Rows { machine, poses, view, order, target };
        if poses.len() > MAX_POSES {
            if printed {
                return session.refuse(too_long(self.poses.len()));
            }
            let task = SurveyTask { field, poses: self.poses, view: self.view, worst: self.worst };
            return surveyed(session, task, &rows, outputs);
        }
        let progress = Progress::new(self.poses.len(), session.is_quiet());
        let result = map(field, self.poses, self.view, &|count| progress.add(count));
        drop(progress);
        let Ok(map) = result else { return session.refuse(too_many(self.poses.len())) };
        if let Some(outputs) = outputs {
            outputs.write(session, &rows, &map.deviations)?;
        }
        let csv = printed.then(|| text(&rows, &map.deviations));
        let indices = worst(&map.deviations, self.worst);
        let worst = indices.into_iter().map(|i| (i, map.deviations[i])).collect();
        Ok(SurveyResult { statistics: map.statistics, worst, sketched: false, csv })
    }
}

/// The table as CSV.
fn text(rows: &Rows<'_>, deviations: &[Deviation]) -> String {
    let mut bytes = Cursor::new(Vec::new());
    let all = rows.prepared(&[RowFormat::Csv], 0, rows.poses.iter().zip(deviations.iter().copied()));
    // Writing to memory cannot fail.
    let _ = rows.stream(RowFormat::Csv, &mut bytes).and_then(|mut csv| {
        csv.put(&all)?;
        csv.finish()
    });
    String::from_utf8_lossy(bytes.get_ref()).into_owned()
}

/// What is printed.
struct Report<'a> {
    whole: &'a Whole<'a>,
    found: SurveyResult,
    /// Without compensation, if the map is with.
    before: Option<Statistics>,
    diagonals: Vec<Diagonal>,
}

/// um; adding zero turns -0 into 0.
fn position_um(deviation: &Deviation) -> [f64; 3] {
    (deviation.position * 1e3).map(|x| x + 0.0).into()
}

impl Report<'_> {
    fn worst(&self) -> impl Iterator<Item = (Vec<f64>, &Deviation)> {
        self.found.worst.iter().map(|(i, deviation)| (self.whole.poses.get(*i), deviation))
    }

    fn json(&self) -> serde_json::Value {
        let s = &self.found.statistics;
        let worst: Vec<_> = self
            .worst()
            .map(|(pose, d)| json!({"axes": axes_json(self.whole.machine, &pose), "deviation_um": position_um(d)}))
            .collect();
        let mut json = json!({
            "machine": self.whole.machine.name(), "order": order_text(self.whole.order), "frame": frame_text(self.whole.view.frame),
            "direction": self.whole.view.approach, "poses": s.poses, "position_um": s.position_um,
            "rotation_urad": s.rotation_urad, "worst": worst, "diagonals": self.diagonals.iter().map(|d| self.diagonal(d)).collect::<Vec<_>>(),
        });
        if self.found.sketched {
            json["p95_relative_error"] = json!(Tally::QUANTILE_ERROR);
        }
        if let Some(reached) = self.whole.reached {
            json["tool_poses"] = reached.json();
        }
        if let (Some(object), Some(before)) = (json.as_object_mut(), &self.before) {
            let _ = object.insert("target".to_owned(), json!(self.whole.target));
            let before = json!({"position_um": before.position_um, "rotation_urad": before.rotation_urad});
            let _ = object.insert("uncompensated".to_owned(), before);
        }
        json
    }

    fn diagonal(&self, d: &Diagonal) -> serde_json::Value {
        let ends = [&d.ends[0], &d.ends[1]].map(|pose| axes_json(self.whole.machine, pose));
        let along: Vec<f64> = d.deviations.iter().map(|x| x * 1e3 + 0.0).collect();
        json!({"name": d.name, "from": ends[0], "to": ends[1], "length_mm": d.length, "range_um": d.range() * 1e3, "deviations_um": along})
    }

    fn text(&self) -> String {
        let where_from = match self.whole.poses {
            Poses::Listed(_) => self.whole.reached.map_or_else(String::new, Reached::words),
            Poses::Nodes(nodes) => nodes.counts().map(|n| n.to_string()).collect::<Vec<_>>().join(" x ") + " grid",
            Poses::Spread(_) => "low-discrepancy over the volume".to_owned(),
            _ => "random over the volume".to_owned(),
        };
        let mut text = format!(
            "{}: deviation of the functional point, actual minus nominal, {} frame, order {}\n{} poses ({where_from})\n{}\n",
            self.whole.machine.name(),
            frame_text(self.whole.view.frame),
            order_text(self.whole.order),
            self.found.statistics.poses,
            self.statistics(),
        );
        for (i, (pose, d)) in self.worst().enumerate() {
            let [x, y, z] = position_um(d).map(|v| significant(v, 4));
            let length = significant(d.position.norm() * 1e3, 4);
            let lead = if i == 0 { "Worst:" } else { "      " };
            text.push_str(&format!("{lead} {length} um ({x}, {y}, {z}) at {}\n", axes_text(self.whole.machine, &pose)));
        }
        if !self.diagonals.is_empty() {
            let of = |d: &Diagonal| format!("{} {}", d.name, significant(d.range() * 1e3, 4));
            let list = self.diagonals.iter().map(of).collect::<Vec<_>>().join(", ");
            text.push_str(&format!("Body diagonals, range of the displacement along them, um: {list}\n"));
        }
        text
    }

    /// One pair of rows, or two: without compensation and with.
    fn statistics(&self) -> comfy_table::Table {
        let Some(before) = &self.before else {
            let mut table = table(&STATISTICS[1..]);
            let _ = table.add_rows(statistics_rows("", &self.found.statistics).map(|row| row.into_iter().skip(1)));
            return table;
        };
        let mut table = table(&STATISTICS);
        let _ = table.add_rows(statistics_rows("before", before));
        let _ = table.add_rows(statistics_rows(&format!("after {}", self.whole.target), &self.found.statistics));
        table
    }
}
