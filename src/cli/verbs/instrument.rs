//! `abbe instrument`: what measuring instruments would read of the machine.

use crate::analysis::Unreachable;
use crate::analysis::instrument::{BallBar, CirclePlane, Diagonal, RTest, ball_bar, diagonals, r_test, within};
use crate::cli::output::session::Session;
use crate::cli::output::view::{axes_json, axes_text, cell, table};
use crate::cli::poses::{check, pose_at};
use crate::cli::store::write::{PictureKind, write_picture};
use crate::cli::{Exit, Format, Outcome, load};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisKind, Machine};
use crate::report::{DiagonalPicture, Picture, PolarPicture, RTestPicture, circle_json, line_json, turn_json};
use crate::units::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The instrument.
    #[arg(value_enum)]
    instrument: InstrumentArg,
    /// Ball bar: the plane of the circle, in the workpiece frame [default: all three].
    #[arg(long, value_enum)]
    plane: Option<PlaneArg>,
    /// Ball bar: its length, mm.
    #[arg(long, value_name = "MM", default_value_t = 100.0)]
    radius: f64,
    /// R-test: the rotary axis [default: all, one after the other].
    #[arg(long, value_name = "AXIS")]
    axis: Option<String>,
    /// Centre of the circle, place of the ball, or where the other axes are, mm and deg [default: the
    /// middle of the volume; for the R-test three quarters along it; rotary axes at 0 or nearest to it].
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true)]
    at: Option<String>,
    /// Readings on a circle or turn, points on a diagonal, steps of every axis [default: 360, 37, 11].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=100_000))]
    points: Option<u32>,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
    /// Draw the readings (SVG, or PNG by the file's ending).
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum InstrumentArg {
    /// Circles about a ball, both ways round (ISO 230-4).
    BallBar,
    /// Rotary axes turning about a ball on the table (R-test, probing).
    RTest,
    /// A laser along the body diagonals, there and back (ISO 230-6).
    Diagonals,
    /// The same, one axis moving at a time.
    StepDiagonals,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum PlaneArg {
    Xy,
    Yz,
    Zx,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    load::warn_bounded(session, &machine);
    let share = if args.instrument == InstrumentArg::RTest { 0.75 } else { 0.5 };
    let at = match &args.at {
        None => within(&machine, share),
        // What is not named stays where it would be.
        Some(text) => named(&machine, text, within(&machine, share)).or_else(|message| session.usage(&message))?,
    };
    check(session, &machine, std::slice::from_ref(&at))?;
    match args.instrument {
        InstrumentArg::BallBar => circles(session, args, &machine, &at),
        InstrumentArg::RTest => turns(session, args, &machine, &at),
        InstrumentArg::Diagonals => lines(session, args, &machine, &at, false),
        InstrumentArg::StepDiagonals => lines(session, args, &machine, &at, true),
    }
}

/// A pose of which only some axes are named.
fn named(machine: &Machine, text: &str, mut pose: Vec<f64>) -> Result<Vec<f64>, String> {
    let given = pose_at(machine, text)?;
    for part in text.split(',') {
        let name = part.split_once('=').map_or("", |(name, _)| name.trim());
        if let Some(axis) = machine.axis_index(name) {
            pose[axis] = given[axis];
        }
    }
    Ok(pose)
}

fn not_driven<T>(session: &mut Session, what: &str, why: Unreachable) -> Result<T, Exit> {
    let help = "take a smaller `--radius`, another place (`--at X=250,Y=200`), or another `--plane` or `--axis`";
    session.refuse(Diagnostic::new(codes::E0612, format!("{what} cannot be driven: {}", why.words())).help(help))
}

fn um(x: f64) -> String {
    significant(x, 4)
}

fn head(machine: &Machine, what: &str, at: &[f64]) -> String {
    format!("{}: {what} {}; exact model\n", machine.name(), axes_text(machine, at))
}

fn circles(session: &mut Session, args: &Args, machine: &Machine, at: &[f64]) -> Outcome {
    if !(args.radius > 0.0 && args.radius <= 10_000.0) {
        return session.usage("`--radius` is a length above 0 and up to 10000 mm");
    }
    let planes = match args.plane {
        None => CirclePlane::ALL.to_vec(),
        Some(PlaneArg::Xy) => vec![CirclePlane::XY],
        Some(PlaneArg::Yz) => vec![CirclePlane::YZ],
        Some(PlaneArg::Zx) => vec![CirclePlane::ZX],
    };
    let mut list = Vec::new();
    for plane in planes {
        match ball_bar(machine, at, plane, args.radius, args.points.unwrap_or(360) as usize) {
            Ok(reading) => list.push(reading),
            Err(why) => {
                let what = format!("a circle of {} mm in {}", significant(args.radius, 6), plane.name());
                return not_driven(session, &what, why);
            }
        }
    }
    let subtitle = format!("Ball bar of {} mm about {}", significant(args.radius, 6), axes_text(machine, at));
    drawn(session, args, || PolarPicture { title: machine.name(), subtitle: &subtitle, circles: &list }.picture())?;
    match session.format() {
        Format::Json => session.print_json(json!({
            "machine": machine.name(), "instrument": "ball_bar", "centre": axes_json(machine, at), "radius_mm": args.radius,
            "planes": list.iter().map(circle_json).collect::<Vec<_>>(),
        })),
        Format::Csv => session.print(&circles_csv(&list)),
        Format::Text => session.print(&circles_text(machine, at, args.radius, &list)),
    }
    Ok(())
}

fn circles_csv(list: &[BallBar]) -> String {
    let mut csv = "plane,angle [deg],counter-clockwise [um],clockwise [um]\n".to_owned();
    for b in list {
        for ((angle, there), back) in b.angles.iter().zip(&b.readings[0]).zip(&b.readings[1]) {
            csv += &format!("{},{angle},{},{}\n", b.plane.name(), there + 0.0, back + 0.0);
        }
    }
    csv
}

fn circles_text(machine: &Machine, at: &[f64], radius: f64, list: &[BallBar]) -> String {
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
            um(b.deviation[0]),
            um(b.deviation[1]),
            um(b.bidirectional),
            um(b.mean),
            both(b.extremes[0]),
            both(b.extremes[1]),
            um(b.squareness),
            um(b.scale_mismatch),
        ]);
    }
    format!(
        "{}{rows}\nG: circular deviation about the least-squares centre, G(b): of both ways; D: mean radial deviation; F: largest and smallest.\nSquareness above 0: the angle between the plane's directions is above 90 deg. Scale: of the first direction minus the second.\n",
        head(machine, &format!("ball bar of {} mm about", significant(radius, 6)), at)
    )
}

fn turns(session: &mut Session, args: &Args, machine: &Machine, at: &[f64]) -> Outcome {
    let rotary: Vec<usize> =
        (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary).collect();
    let chosen: Vec<usize> = match &args.axis {
        None => rotary.clone(),
        Some(name) => rotary.iter().copied().filter(|i| machine.axes()[*i].name.as_str() == name).collect(),
    };
    if chosen.is_empty() {
        let known: Vec<&str> = rotary.iter().map(|i| machine.axes()[*i].name.as_str()).collect();
        return session.usage(&if known.is_empty() {
            "the machine has no rotary axis to turn".to_owned()
        } else {
            format!("`--axis` is one of the rotary axes {}", known.join(", "))
        });
    }
    let mut list = Vec::new();
    for axis in chosen {
        match r_test(machine, at, axis, args.points.unwrap_or(37) as usize) {
            Ok(reading) => list.push(reading),
            Err(why) => {
                let what = format!("an R-test of {} at this place of the ball", machine.axes()[axis].name);
                return not_driven(session, &what, why);
            }
        }
    }
    let subtitle = format!("R-test with the ball at {}", axes_text(machine, at));
    let tests: Vec<(String, RTest)> =
        list.iter().map(|r| (machine.axes()[r.axis].name.to_string(), r.clone())).collect();
    drawn(session, args, || RTestPicture { title: machine.name(), subtitle: &subtitle, tests: &tests }.picture())?;
    match session.format() {
        Format::Json => session.print_json(json!({
            "machine": machine.name(), "instrument": "r_test", "ball_at": axes_json(machine, at), "frame": "machine",
            "axes": list.iter().map(|r| turn_json(machine, r)).collect::<Vec<_>>(),
        })),
        Format::Csv => session.print(&turns_csv(machine, &list)),
        Format::Text => session.print(&turns_text(machine, at, &list)),
    }
    Ok(())
}

fn turns_csv(machine: &Machine, list: &[RTest]) -> String {
    let mut csv = "axis,position [deg],dx [um],dy [um],dz [um]\n".to_owned();
    for r in list {
        for (q, d) in r.positions.iter().zip(&r.readings) {
            let name = cell(machine.axes()[r.axis].name.as_str());
            csv += &format!("{name},{q},{},{},{}\n", d.x + 0.0, d.y + 0.0, d.z + 0.0);
        }
    }
    csv
}

fn turns_text(machine: &Machine, at: &[f64], list: &[RTest]) -> String {
    let mut rows =
        table(&["axis", "from, deg", "to, deg", "readings", "left out", "range x, um", "range y, um", "range z, um"]);
    for r in list {
        let ends = [r.positions[0], r.positions[r.positions.len() - 1]].map(|q| significant(q, 6));
        let counts = [r.positions.len(), r.skipped].map(|n| n.to_string());
        let name = machine.axes()[r.axis].name.to_string();
        let _ = rows.add_row([name].into_iter().chain(ends).chain(counts).chain(r.range.map(um)));
    }
    format!(
        "{}{rows}\nTool relative to workpiece, directions of the machine frame, 0 at the first position. Left out: positions to which the linear axes cannot follow.\n",
        head(machine, "R-test with the ball where the tool is at", at)
    )
}

fn lines(session: &mut Session, args: &Args, machine: &Machine, at: &[f64], steps: bool) -> Outcome {
    let list = diagonals(machine, at, args.points.unwrap_or(11) as usize, steps);
    if list.is_empty() {
        return not_driven(session, "a diagonal", Unreachable::Place);
    }
    let how = if steps { ", one axis at a time" } else { "" };
    let subtitle = format!("Laser along the diagonals{how}{}", standing(machine, at, &list[0].axes));
    drawn(session, args, || {
        DiagonalPicture { title: machine.name(), subtitle: &subtitle, diagonals: &list }.picture()
    })?;
    match session.format() {
        Format::Json => session.print_json(json!({
            "machine": machine.name(), "instrument": if steps { "step_diagonals" } else { "diagonals" },
            "at": axes_json(machine, at), "diagonals": list.iter().map(|d| line_json(machine, d)).collect::<Vec<_>>(),
            "e_um": list.iter().map(|d| d.systematic).fold(0.0, f64::max),
        })),
        Format::Csv => session.print(&lines_csv(&list)),
        Format::Text => session.print(&lines_text(machine, at, &list)),
    }
    Ok(())
}

fn lines_csv(list: &[Diagonal]) -> String {
    let mut csv = "diagonal,way [mm],there [um],back [um]\n".to_owned();
    for d in list {
        for ((way, there), back) in d.ways.iter().zip(&d.there).zip(&d.back) {
            csv += &format!("{},{way},{},{}\n", d.name, there + 0.0, back + 0.0);
        }
    }
    csv
}

fn lines_text(machine: &Machine, at: &[f64], list: &[Diagonal]) -> String {
    let names: Vec<String> = list[0].axes.iter().map(|i| format!("by {}, um", machine.axes()[*i].name)).collect();
    let mut header = vec!["diagonal", "length, mm", "at the end, um", "E_d, um", "B_d, um"];
    let stepped = list[0].by_axis.is_some();
    if stepped {
        header.extend(names.iter().map(String::as_str));
    }
    let mut rows = table(&header);
    for d in list {
        let last = d.ways.len() - 1;
        let mut row =
            vec![d.name.clone(), significant(d.ways[last], 6), um(d.there[last]), um(d.systematic), um(d.reversal)];
        row.extend(d.by_axis.iter().flatten().map(|x| um(*x)));
        let _ = rows.add_row(row);
    }
    let axes: Vec<String> = list[0].axes.iter().map(|i| machine.axes()[*i].name.to_string()).collect();
    format!(
        "{}{rows}\nSenses of {} along the diagonal: p rises, n falls. E_d: range of the mean of there and back; B_d: their largest difference.\n",
        others(machine, at, &list[0].axes),
        axes.join(", ")
    )
}

/// The heading, with the axes that stand.
fn others(machine: &Machine, at: &[f64], moving: &[usize]) -> String {
    format!("{}: laser along the diagonals{}; exact model\n", machine.name(), standing(machine, at, moving))
}

/// `, A = 0 deg`: the axes that stand.
fn standing(machine: &Machine, at: &[f64], moving: &[usize]) -> String {
    let stands = |(i, (axis, q)): (usize, (&crate::machine::Axis, &f64))| {
        (!moving.contains(&i)).then(|| format!(", {} = {} {}", axis.name, significant(*q, 7), axis.unit()))
    };
    machine.axes().iter().zip(at).enumerate().filter_map(stands).collect()
}

/// Draws the readings if that was asked for.
fn drawn(session: &mut Session, args: &Args, picture: impl FnOnce() -> Picture) -> Outcome {
    let Some(path) = &args.svg else { return Ok(()) };
    let kind = PictureKind::of(path).unwrap_or(PictureKind::Svg);
    write_picture(path, &picture(), kind, &session.diagnostics.sources).or_else(|d| session.refuse(d))
}
