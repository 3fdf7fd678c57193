//! `abbe instrument`: readings of measuring instruments on the machine.

use crate::cli::Outcome;
use crate::cli::arguments::{PictureFile, ToolArg, counts, help, svg};
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::store::write;
use abbe::options::{CirclePlane, Instrument};
use abbe::results::{
    BallBar, BoundedReading, Diagonal, InstrumentResult, LaserReadings, RTest, Readings, ReadingsOfBounds,
};
use abbe::text::{cell, significant};
use abbe::{InstrumentOptions, instrument};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The instrument.
    #[arg(value_enum)]
    instrument: Instrument,
    #[arg(long, value_enum, value_name = "AXES", help = help::PLANE,
        long_help = "Ball bar: the plane of the circle, in the workpiece frame [default: all three]")]
    plane: Option<CirclePlane>,
    #[arg(long, value_name = "MM", default_value_t = 100.0, help = help::RADIUS,
        long_help = "Ball bar: its length, mm (above 0)")]
    radius: f64,
    #[arg(long, value_name = "AXIS", help = help::AXIS,
        long_help = "R-test: the rotary axis, or several that turn at once, `A+C` [default: all, one after the other]")]
    axis: Option<String>,
    /// R-test: write the poses to this file, a table to measure by that `identify` reads.
    #[arg(long, value_name = "FILE")]
    sequence: Option<PathBuf>,
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true, help = help::AT,
        long_help = "Centre of the circle, place of the ball, or where the other axes are, mm and deg [default: the \
                     middle of the volume, three quarters along it for the R-test]. Rotary axes are at 0 or nearest")]
    at: Option<String>,
    /// Readings on a circle or turn, points on a diagonal, steps of every axis (3 to 100000) [default: 360, 37, 11].
    #[arg(long, value_name = "N", value_parser = counts(3..=100_000))]
    points: Option<usize>,
    #[command(flatten)]
    tool: ToolArg,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw the readings, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
}

impl Args {
    fn options(&self) -> InstrumentOptions {
        InstrumentOptions {
            instrument: self.instrument,
            plane: self.plane,
            radius_mm: self.radius,
            axis: self.axis.clone(),
            at: self.at.clone(),
            points: self.points,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.tool.name())?;
    PictureFile::refuse(session, args.svg.iter())?;
    if args.sequence.is_some() && args.instrument != Instrument::RTest {
        return session.usage("`--sequence` is for the R-test: `abbe instrument MACHINE r-test --sequence FILE`");
    }
    write::refuse_outputs(&args.sequence, &session.files).or_else(|refusal| session.refuse(refusal))?;
    let result = session.take(instrument(&file, &args.options(), session.run()))?;
    if let Some(file) = &args.svg {
        file.write(&result.picture(), session)?;
    }
    if let Some((out, table)) = args.sequence.as_ref().zip(result.sequence()) {
        write::write_whole(out, table.as_bytes(), &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    let csv = || match &result.readings {
        Readings::BallBar { planes, .. } => circles_csv(planes),
        Readings::RTest { axes, .. } => turns_csv(axes),
        Readings::Diagonals(of) | Readings::StepDiagonals(of) => lines_csv(&of.diagonals),
    };
    let exact = || match &result.readings {
        Readings::BallBar { radius_mm, planes, .. } => circles_text(&result, *radius_mm, planes),
        Readings::RTest { axes, .. } => turns_text(&result, axes),
        Readings::Diagonals(of) | Readings::StepDiagonals(of) => lines_text(&result, of),
    };
    let text = || result.bounds.as_ref().map_or_else(exact, |of| bounds_text(&result, of));
    session.show(&result, csv, text)
}

/// The readings of machines drawn: those of the machine without errors say nothing.
fn bounds_text(result: &InstrumentResult, of: &ReadingsOfBounds) -> String {
    let what = match &result.readings {
        Readings::BallBar { radius_mm, .. } => {
            format!("G(b) of a ball bar of {} mm about {}", significant(*radius_mm, 6), result.place())
        }
        Readings::RTest { .. } => format!("ranges of an R-test with the ball where the tool is at {}", result.place()),
        Readings::Diagonals(_) | Readings::StepDiagonals(_) => {
            format!("E_d of a laser along the diagonals{}", result.standing())
        }
    };
    let mut rows = table(&["reading", "RSS, um", "95 %, um", "from", "to"]);
    for BoundedReading { name, rss_um, p95_um } in &of.readings {
        let ends = [p95_um.low, p95_um.high].map(|end| end.map_or_else(|| "-".to_owned(), um));
        let _ = rows.add_row([name.clone(), um(*rss_um), um(p95_um.value)].into_iter().chain(ends));
    }
    format!(
        "{}: {what}\nNothing is measured: readings of {} machines drawn between {} bounds, without reversal.\n{rows}\n\
         95 %: what 95 of 100 machines do not exceed, with its interval. RSS: root of the sum of squares of that value \
         with one bound alone.\n",
        result.machine, of.drawing.samples, of.errors
    )
}

fn um(x: f64) -> String {
    significant(x, 4)
}

fn head(what: &str, result: &InstrumentResult) -> String {
    format!("{}: {what} {}; exact model\n", result.machine, result.place())
}

fn circles_csv(list: &[BallBar]) -> String {
    let mut csv = "plane,angle [deg],counter-clockwise [um],clockwise [um]\n".to_owned();
    for b in list {
        for ((angle, there), back) in b.angle_deg.iter().zip(&b.counter_clockwise_um).zip(&b.clockwise_um) {
            csv += &format!("{},{angle},{},{}\n", b.plane.name(), there + 0.0, back + 0.0);
        }
    }
    csv
}

fn circles_text(result: &InstrumentResult, radius: f64, list: &[BallBar]) -> String {
    let mut rows = table(&[
        "plane",
        "G ccw, um",
        "G cw, um",
        "G(b), um",
        "D, um",
        "F ccw, um",
        "F cw, um",
        "squareness, urad",
        "scale, um/m",
    ]);
    for b in list {
        let both = |[max, min]: [f64; 2]| format!("{} / {}", um(max), um(min));
        let _ = rows.add_row([
            b.plane.name().to_owned(),
            um(b.circular_deviation_um.counter_clockwise),
            um(b.circular_deviation_um.clockwise),
            um(b.bidirectional_um),
            um(b.mean_radial_um),
            both(b.radial_max_min_um.counter_clockwise),
            both(b.radial_max_min_um.clockwise),
            um(b.squareness_urad),
            um(b.scale_mismatch_um_per_m),
        ]);
    }
    format!(
        "{}{rows}\nG: circular deviation of a sense about its own least-squares centre, G(b): of both about theirs; D: \
         mean radial deviation; F: largest and smallest.\nSquareness above 0: the angle between the plane's directions \
         is above 90 deg. Scale: of the first direction minus the second.\n",
        head(&format!("ball bar of {} mm about", significant(radius, 6)), result)
    )
}

fn turns_csv(list: &[RTest]) -> String {
    let mut csv = "axis,position [deg],dx [um],dy [um],dz [um]\n".to_owned();
    for r in list {
        for reading in &r.readings {
            let (q, [x, y, z]) = (reading.position_deg, reading.reading_um);
            csv += &format!("{},{q},{x},{y},{z}\n", cell(&r.axis));
        }
    }
    csv
}

fn turns_text(result: &InstrumentResult, list: &[RTest]) -> String {
    let mut rows =
        table(&["axis", "from, deg", "to, deg", "readings", "left out", "range x, um", "range y, um", "range z, um"]);
    for r in list {
        let ends = [&r.readings[0], &r.readings[r.count - 1]].map(|reading| significant(reading.position_deg, 6));
        let counts = [r.count, r.skipped].map(|n| n.to_string());
        let name = r.axis.clone();
        let _ = rows.add_row([name].into_iter().chain(ends).chain(counts).chain(r.range_um.map(um)));
    }
    format!(
        "{}{rows}\nTool relative to workpiece, directions of the machine frame, 0 at the first position. Left out: \
         positions to which the linear axes cannot follow.\n",
        head("R-test with the ball where the tool is at", result)
    )
}

fn lines_csv(list: &[Diagonal]) -> String {
    let mut csv = "diagonal,way [mm],there [um],back [um]\n".to_owned();
    for d in list {
        for ((way, there), back) in d.way_mm.iter().zip(&d.there_um).zip(&d.back_um) {
            csv += &format!("{},{way},{},{}\n", d.name, there + 0.0, back + 0.0);
        }
    }
    csv
}

fn lines_text(result: &InstrumentResult, of: &LaserReadings) -> String {
    let list = &of.diagonals;
    let names: Vec<String> = list[0].axes.iter().map(|name| format!("by {name}, um")).collect();
    let mut header = vec!["diagonal", "length, mm", "at the end, um", "E_d, um", "B_d, um"];
    let stepped = list[0].by_axis_um.is_some();
    if stepped {
        header.extend(names.iter().map(String::as_str));
    }
    let mut rows = table(&header);
    for d in list {
        let last = d.way_mm.len() - 1;
        let mut row =
            vec![d.name.clone(), significant(d.way_mm[last], 6), um(d.there_um[last]), um(d.e_d_um), um(d.b_d_um)];
        row.extend(d.by_axis_um.iter().flatten().map(|x| um(*x)));
        let _ = rows.add_row(row);
    }
    format!(
        "{}{rows}\nSenses of {} along the diagonal: p rises, n falls. E_d: range there and back; B_d: \
         their largest difference.\n",
        others(result),
        list[0].axes.join(", ")
    )
}

/// The heading, with the axes that do not move.
fn others(result: &InstrumentResult) -> String {
    format!("{}: laser along the diagonals{}; exact model\n", result.machine, result.standing())
}
