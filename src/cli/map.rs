//! `abbe map`: the error over a volume.

use super::eval::FrameArg;
use super::poses::{check, pose_at};
use super::progress::Progress;
use super::session::Session;
use super::view::{
    STATISTICS, ViewArgs, axes_json, axes_text, frame_text, numbers, order_text, statistics_rows, table,
};
use super::write::{write_streamed, write_whole};
use super::{Format, Outcome, Stop, load};
use crate::analysis::{
    MOST_POSES, MOST_SURVEYED, Map, Plane, Survey, SurveyTask, View, map, rest, survey, survey_with_rows,
};
use crate::diagnostic::Diagnostic;
use crate::evaluate::{Batch, Columns, Deviation, Nodes, Order, Planned, Poses, Random, Statistics, Tally, worst};
use crate::machine::{AxisKind, Machine};
use crate::report::{PlanePicture, Shown};
use crate::units::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The machine file; its `volume` is the grid.
    machine: PathBuf,
    /// So many random poses over the volume instead of the grid.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_SURVEYED as i64))]
    random: Option<u32>,
    /// Seed of the random poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    view: ViewArgs,
    /// Frame of the vectors.
    #[arg(long, value_enum, default_value = "workpiece")]
    frame: FrameArg,
    /// How many of the worst poses to name.
    #[arg(long, value_name = "K", default_value_t = 5)]
    worst: usize,
    /// Write every pose with its deviation to a CSV file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the error over a plane of two linear axes.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// The two linear axes of the picture, such as XY or X,Z [default: the first two].
    #[arg(long, value_name = "AXES", requires = "svg")]
    plane: Option<String>,
    /// Where the other axes are for the picture [default: 0, or the end of the travel nearest to it].
    #[arg(long, value_name = "Z=-100,A=30", requires = "svg", allow_hyphen_values = true)]
    at: Option<String>,
    /// What the colours of the picture show.
    #[arg(long, value_enum, default_value = "length", requires = "svg")]
    component: ComponentArg,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum ComponentArg {
    Length,
    Dx,
    Dy,
    Dz,
}

impl From<ComponentArg> for Shown {
    fn from(arg: ComponentArg) -> Self {
        match arg {
            ComponentArg::Length => Self::Length,
            ComponentArg::Dx => Self::Component(0),
            ComponentArg::Dy => Self::Component(1),
            ComponentArg::Dz => Self::Component(2),
        }
    }
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.view.tool.as_deref())?;
    let order = args.view.order(&machine);
    let view = View { approach: args.view.approach(), frame: args.frame.into() };
    let field = Planned::new(&machine, order);
    // What can be refused is refused before the work, not after it.
    let picture = args.svg.as_ref().map(|path| Ok((path, picture(session, &machine, args)?))).transpose()?;
    let poses = match args.random {
        Some(count) => Poses::Random(Random::of(&machine, count as usize, args.seed)),
        None => Poses::Nodes(Nodes::of(&machine)),
    };
    if poses.len() > MOST_SURVEYED {
        return session.refuse(too_many(poses.len()));
    }
    let whole = Whole { machine: &machine, field: &field, poses: &poses, view, worst: args.worst };
    let report = Report { machine: &machine, poses: &poses, order, view, found: whole.found(session, args)? };
    if let Some((path, Drawing { axes, at })) = picture {
        let plane = Plane::of(&field, axes, &at, nodes(&machine, axes), view);
        let svg = PlanePicture { machine: &machine, plane: &plane, view, order, shown: args.component.into() }.svg();
        write_whole(path, svg.as_bytes()).or_else(|d| session.refuse(d))?;
    }
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.found.csv.clone().unwrap_or_default()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

fn too_long(count: usize) -> Diagnostic {
    Diagnostic::new("E0541", format!("a table of {count} poses does not go to standard output: {MOST_POSES} at most"))
        .help("write it to a file with `--csv FILE`: that takes no memory, but some 200 bytes of disk per pose")
}

fn too_many(count: usize) -> Diagnostic {
    let count = if count == usize::MAX { "more than can be counted".to_owned() } else { count.to_string() };
    Diagnostic::new("E0812", format!("the grid of the volume has {count} poses; a map takes {MOST_SURVEYED} at most"))
        .help("take random poses (`--random 100000`), or larger steps under `volume` in the machine file")
}

/// Which plane to draw, and where the other axes are.
struct Drawing {
    axes: [usize; 2],
    at: Vec<f64>,
}

fn picture(session: &mut Session, machine: &Machine, args: &Args) -> Result<Drawing, Stop> {
    let axes = plane_axes(machine, args.plane.as_deref()).or_else(|message| session.usage(&message))?;
    let at = match &args.at {
        Some(text) => pose_at(machine, text).or_else(|message| session.usage(&message))?,
        None => rest(machine),
    };
    let mut shown = at.clone();
    // The two axes of the plane run over the volume, wherever `--at` puts them.
    axes.iter().for_each(|i| shown[*i] = machine.volume()[*i].min);
    check(session, machine, std::slice::from_ref(&shown))?;
    Ok(Drawing { axes, at })
}

/// `XY`, or `X,Y2` where names are longer; two different linear axes with room to move.
fn plane_axes(machine: &Machine, text: Option<&str>) -> Result<[usize; 2], String> {
    let moves =
        |i: &usize| machine.axes()[*i].kind == AxisKind::Linear && machine.volume()[*i].max > machine.volume()[*i].min;
    let mut linear: Vec<usize> = (0..machine.axes().len()).filter(moves).collect();
    linear.sort_by(|a, b| machine.axes()[*a].name.cmp(&machine.axes()[*b].name));
    let known: Vec<&str> = linear.iter().map(|i| machine.axes()[*i].name.as_str()).collect();
    let known = known.join(", ");
    let Some(text) = text else {
        return if let [a, b, ..] = linear[..] {
            Ok([a, b])
        } else {
            Err("the machine has no two linear axes to draw a plane of".to_owned())
        };
    };
    let names: Vec<String> = match text.split_once(',') {
        Some((a, b)) => vec![a.trim().to_owned(), b.trim().to_owned()],
        None => text.chars().map(String::from).collect(),
    };
    let index = |name: &String| linear.iter().copied().find(|i| machine.axes()[*i].name.as_str() == name);
    match names.iter().map(index).collect::<Option<Vec<_>>>().as_deref() {
        Some([a, b]) if a != b => Ok([*a, *b]),
        _ => Err(format!("`--plane {text}` is not two different linear axes of {known}, such as `XY` or `X,Z`")),
    }
}

/// About square cells, 72 along the longer side.
fn nodes(machine: &Machine, axes: [usize; 2]) -> [usize; 2] {
    let spans = axes.map(|i| machine.volume()[i].max - machine.volume()[i].min);
    let longest = spans[0].max(spans[1]);
    spans.map(|span| 1 + (72.0 * span / longest).round().max(2.0) as usize)
}

/// Everything that is mapped.
struct Whole<'a> {
    machine: &'a Machine,
    field: &'a Planned,
    poses: &'a Poses,
    view: View,
    worst: usize,
}

/// What a map has found.
struct Found {
    statistics: Statistics,
    /// The worst poses by number, largest deviation first.
    worst: Vec<(usize, Deviation)>,
    /// Is the quantile that of a sketch?
    sketched: bool,
    /// What goes to standard output.
    csv: Option<String>,
}

impl Whole<'_> {
    fn found(&self, session: &mut Session, args: &Args) -> Result<Found, Stop> {
        let printed = session.format() == Format::Csv;
        if self.poses.len() > MOST_POSES {
            if printed {
                return session.refuse(too_long(self.poses.len()));
            }
            return self.surveyed(session, args);
        }
        let progress = Progress::new(self.poses.len(), session.is_quiet());
        let result = map(self.field, self.poses, self.view, &|count| progress.add(count));
        drop(progress);
        let Ok(map) = result else { return session.refuse(too_many(self.poses.len())) };
        let csv = (printed || args.csv.is_some()).then(|| self.csv(&map));
        if let (Some(path), Some(csv)) = (&args.csv, &csv) {
            write_whole(path, csv.as_bytes()).or_else(|d| session.refuse(d))?;
        }
        let indices = worst(&map.deviations, self.worst);
        let worst = indices.into_iter().map(|i| (i, map.deviations[i])).collect();
        Ok(Found { statistics: map.statistics, worst, sketched: false, csv })
    }

    /// Without keeping the deviations; a file is written as they come.
    fn surveyed(&self, session: &mut Session, args: &Args) -> Result<Found, Stop> {
        let task = SurveyTask { field: self.field, poses: self.poses, view: self.view, worst: self.worst };
        let progress = Progress::new(self.poses.len(), session.is_quiet());
        let add = |count| progress.add(count);
        let survey = match &args.csv {
            None => survey(task, &add),
            Some(path) => {
                let mut found: Option<Survey> = None;
                let written = write_streamed(path, |file| {
                    file.write_all(self.header().as_bytes())?;
                    let mut failure = Ok(());
                    found = survey_with_rows(
                        task,
                        &rows,
                        &mut |text| {
                            failure = file.write_all(text.as_bytes());
                            failure.is_ok()
                        },
                        &add,
                    );
                    failure.and_then(|()| file.write_all(b"\n"))
                });
                written.or_else(|d| session.refuse(d))?;
                found.ok_or(Stop::Refused)?
            }
        };
        drop(progress);
        Ok(Found { statistics: survey.statistics, worst: survey.worst, sketched: true, csv: None })
    }

    fn header(&self) -> String {
        let axes = self.machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
        let names = ["dx [um]", "dy [um]", "dz [um]", "wx [urad]", "wy [urad]", "wz [urad]"];
        axes.chain(names.map(str::to_owned)).collect::<Vec<_>>().join(",")
    }

    fn csv(&self, map: &Map) -> String {
        let mut csv = self.header();
        for (pose, d) in self.poses.iter().zip(&map.deviations) {
            csv.push_str(&row(pose, d));
        }
        csv.push('\n');
        csv
    }
}

/// A line of a file, with the end of the line before.
fn row(pose: impl IntoIterator<Item = f64>, d: &Deviation) -> String {
    let rotation: [f64; 3] = (d.rotation * 1e6).into();
    format!("\n{}", numbers(pose.into_iter().chain(position_um(d)).chain(rotation)))
}

/// The lines of a block of poses.
fn rows(poses: &Batch<'_>, columns: &Columns, len: usize) -> String {
    (0..len).map(|i| row(poses.pose(i), &columns.get(i))).collect()
}

/// What is printed.
struct Report<'a> {
    machine: &'a Machine,
    poses: &'a Poses,
    order: Order,
    view: View,
    found: Found,
}

/// um; adding zero turns -0 into 0.
fn position_um(deviation: &Deviation) -> [f64; 3] {
    (deviation.position * 1e3).map(|x| x + 0.0).into()
}

impl Report<'_> {
    fn worst(&self) -> impl Iterator<Item = (Vec<f64>, &Deviation)> {
        self.found.worst.iter().map(|(i, deviation)| (self.poses.get(*i), deviation))
    }

    fn json(&self) -> serde_json::Value {
        let s = &self.found.statistics;
        let worst: Vec<_> = self
            .worst()
            .map(|(pose, d)| json!({"axes": axes_json(self.machine, &pose), "deviation_um": position_um(d)}))
            .collect();
        let mut json = json!({
            "machine": self.machine.name(), "order": order_text(self.order), "frame": frame_text(self.view.frame),
            "direction": self.view.approach, "poses": s.poses, "position_um": s.position_um,
            "rotation_urad": s.rotation_urad, "worst": worst,
        });
        if self.found.sketched {
            json["p95_relative_error"] = json!(Tally::QUANTILE_ERROR);
        }
        json
    }

    fn text(&self) -> String {
        let mut statistics = table(&STATISTICS[1..]);
        let _ = statistics.add_rows(statistics_rows("", &self.found.statistics).map(|row| row.into_iter().skip(1)));
        let where_from = match self.poses {
            Poses::Nodes(nodes) => nodes.counts().map(|n| n.to_string()).collect::<Vec<_>>().join(" x ") + " grid",
            _ => "random over the volume".to_owned(),
        };
        let mut text = format!(
            "{}: deviation of the functional point, actual minus nominal, {} frame, order {}\n{} poses ({where_from})\n{statistics}\n",
            self.machine.name(),
            frame_text(self.view.frame),
            order_text(self.order),
            self.found.statistics.poses,
        );
        for (i, (pose, d)) in self.worst().enumerate() {
            let [x, y, z] = position_um(d).map(|v| significant(v, 4));
            let length = significant(d.position.norm() * 1e3, 4);
            let lead = if i == 0 { "Worst:" } else { "      " };
            text.push_str(&format!("{lead} {length} um ({x}, {y}, {z}) at {}\n", axes_text(self.machine, &pose)));
        }
        text
    }
}
