//! Poses from the command line (`--at X=100,C=90`) and from CSV files.

use super::Exit;
use super::output::session::Session;
use crate::diagnostic::{Diagnostic, Place, SourceId, codes};
use crate::machine::{AxisKind, Machine, Pose};
use crate::syntax::Disk;
use crate::syntax::read_text;
use crate::units;
use std::path::{Path, PathBuf};

/// More poses than this belong into a map.
const MAX_POSES: usize = 200_000;

/// Which poses to evaluate.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct PoseArgs {
    /// One pose, mm and deg; axes left out are at 0.
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true)]
    at: Vec<String>,
    /// A CSV file: header of axis names, one pose a line, mm and deg.
    #[arg(long, value_name = "FILE")]
    poses: Option<PathBuf>,
}

/// The poses asked for (the zero pose if none); all positions checked.
pub(super) fn poses(session: &mut Session, machine: &Machine, args: &PoseArgs) -> Result<Vec<Pose>, Exit> {
    let mut list = Vec::new();
    for text in &args.at {
        match pose_at(machine, text) {
            Ok(pose) => list.push(pose),
            Err(message) => return session.usage(&message),
        }
    }
    if let Some(path) = &args.poses {
        list.extend(from_file(session, machine, path)?);
    } else if list.is_empty() {
        list.push(vec![0.0; machine.axes().len()]);
    }
    check(session, machine, &list)?;
    Ok(list)
}

/// One pose from `X=100,C=90`; axes left out are at 0.
pub(super) fn pose_at(machine: &Machine, text: &str) -> Result<Pose, String> {
    let mut pose = vec![0.0; machine.axes().len()];
    let mut seen = vec![false; pose.len()];
    for part in text.split(',').filter(|part| !part.trim().is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| format!("`{part}`: write AXIS=POSITION"))?;
        let axis = machine.axis_index(name.trim()).ok_or_else(|| unknown_axis(machine, name.trim()))?;
        if std::mem::replace(&mut seen[axis], true) {
            return Err(format!("axis `{}` is given twice", name.trim()));
        }
        pose[axis] = position(machine, axis, value)?;
    }
    Ok(pose)
}

/// A bare number (mm or deg) or a quantity with its unit.
fn position(machine: &Machine, axis: usize, text: &str) -> Result<f64, String> {
    let Err(failure) = units::number(text) else { return units::number(text).map_err(|f| f.to_string()) };
    let quantity = units::quantity(text).map_err(|_| failure.to_string())?;
    let linear = machine.axes()[axis].kind == AxisKind::Linear;
    let value = if linear { quantity.as_length() } else { quantity.as_angle().map(f64::to_degrees) };
    value.ok_or_else(|| {
        format!("`{text}` is {}, not a position in {}", quantity.dimension.word(), machine.axes()[axis].unit())
    })
}

fn unknown_axis(machine: &Machine, name: &str) -> String {
    let known: Vec<_> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
    format!("the chain has no axis `{name}`; its axes are {}", known.join(", "))
}

/// A column of a pose file: which axis, and the factor to mm or deg.
struct Column {
    axis: usize,
    factor: f64,
}

fn from_file(session: &mut Session, machine: &Machine, path: &Path) -> Result<Vec<Pose>, Exit> {
    let read = read_text(path, None, &Disk, &mut session.diagnostics);
    let Some((source, text)) = read else { return Err(Exit::Refused) };
    let parsed = parse(machine, &text);
    parsed.or_else(|(line, message)| {
        let place = Some(line_place(source, &text, line));
        session.refuse(
            Diagnostic::new(codes::E0802, message)
                .at(place, "")
                .help("a pose file has a header of axis names (`X, Y, C` or `X [mm]`) and one pose a line, mm and deg"),
        )
    })
}

fn line_place(source: SourceId, text: &str, line: usize) -> Place {
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    Place { source, range: start..start + length }
}

/// Poses, or the 0-based line and what is wrong with it.
fn parse(machine: &Machine, text: &str) -> Result<Vec<Pose>, (usize, String)> {
    let data = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.lines().enumerate().filter(|(_, line)| data(line));
    let (number, header) = lines.next().ok_or((0, "the file has no header".to_owned()))?;
    let columns = header_columns(machine, header).map_err(|message| (number, message))?;
    let mut poses = Vec::new();
    for (number, line) in lines {
        poses.push(row(machine, &columns, line).map_err(|message| (number, message))?);
        if poses.len() > MAX_POSES {
            return Err((number, format!("more than {MAX_POSES} poses; use `map` for a whole volume")));
        }
    }
    if poses.is_empty() { Err((number, "the file has no poses".to_owned())) } else { Ok(poses) }
}

fn header_columns(machine: &Machine, header: &str) -> Result<Vec<Column>, String> {
    let mut columns: Vec<Column> = Vec::new();
    for cell in header.split(',') {
        let (name, unit) = units::header(cell);
        let axis = machine.axis_index(name).ok_or_else(|| unknown_axis(machine, name))?;
        if columns.iter().any(|column| column.axis == axis) {
            return Err(format!("column `{name}` is there twice"));
        }
        columns.push(Column { axis, factor: unit.map_or(Ok(1.0), |unit| factor(machine, axis, unit))? });
    }
    Ok(columns)
}

fn factor(machine: &Machine, axis: usize, unit: &str) -> Result<f64, String> {
    let (factor, dimension) = units::unit(unit).map_err(|failure| failure.to_string())?;
    match machine.axes()[axis].kind {
        AxisKind::Linear if dimension == units::Dimension::LENGTH => Ok(factor),
        // Degrees stay degrees: no detour over radians that would cost a bit.
        AxisKind::Rotary if unit == "deg" || unit == "°" => Ok(1.0),
        AxisKind::Rotary if dimension == units::Dimension::ANGLE => Ok(factor.to_degrees()),
        _ => Err(format!("`{unit}` is {}, not a unit for `{}`", dimension.word(), machine.axes()[axis].name)),
    }
}

fn row(machine: &Machine, columns: &[Column], line: &str) -> Result<Pose, String> {
    let cells: Vec<&str> = line.split(',').collect();
    if cells.len() != columns.len() {
        return Err(format!("{} cells under {} columns", cells.len(), columns.len()));
    }
    let mut pose = vec![0.0; machine.axes().len()];
    for (cell, column) in cells.iter().zip(columns) {
        pose[column.axis] = units::number(cell).map_err(|failure| failure.to_string())? * column.factor;
    }
    Ok(pose)
}

/// Refuses poses where an error curve is not defined; warns about those beyond the travel.
pub(super) fn check(session: &mut Session, machine: &Machine, poses: &[Pose]) -> Result<(), Exit> {
    const FARTHEST: f64 = 1e6;
    if poses.iter().flatten().any(|q| q.abs() > FARTHEST) {
        let message = "a position is beyond 1000000 mm or deg: no machine goes there";
        return session.refuse(Diagnostic::new(codes::E0802, message).help("positions are in mm and deg"));
    }
    for pose in poses {
        if let Some(outside) = machine.outside(pose) {
            return session.refuse(
                Diagnostic::new(
                    codes::E0803,
                    format!("{} is not known at {} = {}", outside.error, outside.error.axis, outside.position),
                )
                .help(format!(
                    "its table covers {} to {}; a table is never extrapolated",
                    outside.domain.0, outside.domain.1
                )),
            );
        }
    }
    let mut beyond: Vec<&str> =
        poses.iter().flat_map(|pose| machine.beyond_travel(pose)).map(|axis| axis.name.as_str()).collect();
    beyond.sort_unstable();
    beyond.dedup();
    for name in beyond {
        session
            .diagnostics
            .push(Diagnostic::new(codes::W0801, format!("poses beyond the travel of `{name}` were evaluated")));
    }
    session.checked()
}
