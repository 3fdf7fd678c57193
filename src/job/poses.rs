//! Poses from text (`X=100,C=90`), from numbers and from CSV files.

use crate::diagnostic::{Diagnostic, Place, SourceId, codes, shown};
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel};
use crate::run::{Call, Refused};
use crate::syntax::read_table_text;
use crate::syntax::sheet::{self, separator};
use crate::units::{self, significant};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use crate::machine::{AxisPositions, axis_positions};

/// Largest number of poses of a file.
const MAX_POSES: usize = 200_000;

/// Returns positions in the order of the axes as text, such as `X = 100 mm, C = 90 deg`.
pub fn axes_text<'q>(machine: &Machine, pose: impl IntoIterator<Item = &'q f64>) -> String {
    let entry = |(axis, q): (&Axis, &f64)| format!("{} = {} {}", axis.name, units::significant(*q, 7), axis.unit());
    machine.axes().iter().zip(pose).map(entry).collect::<Vec<_>>().join(", ")
}

/// Returns the poses of texts, then those given in numbers, then those of the file; the zero pose if there are none.
pub(crate) fn poses(
    call: &mut Call<'_>,
    machine: &Machine,
    (texts, numbers, file): (&[String], &[Pose], Option<&PathBuf>),
) -> Result<Vec<Pose>, Refused> {
    let mut list = Vec::new();
    for text in texts {
        list.push(pose_at(machine, text).or_else(|refusal| call.refuse(refusal))?);
    }
    for pose in numbers {
        let axes = machine.axes().len();
        if pose.len() != axes {
            return call.usage(format!("a pose has {} positions; the machine has {axes} axes", pose.len()));
        }
        list.push(pose.clone());
    }
    if let Some(path) = file {
        list.extend(rows_of_file(call, machine, path)?.into_iter().map(|row| row.pose));
    } else if list.is_empty() {
        list.push(vec![0.0; machine.axes().len()]);
    }
    check(call, machine, &list)?;
    Ok(list)
}

/// A pose of a file.
pub(crate) struct PoseRow {
    /// Place of the row in the file.
    pub place: Place,
    /// 1-based.
    pub line: usize,
    /// Positions of all axes, mm and deg.
    pub pose: Pose,
}

pub(crate) fn pose_option(
    call: &mut Call<'_>,
    machine: &Machine,
    text: Option<&String>,
) -> Result<Option<Pose>, Refused> {
    text.map(|text| pose_at(machine, text).or_else(|refusal| call.refuse(refusal))).transpose()
}

/// Returns the pose of `X=100,C=90`; omitted axes are at 0.
pub(crate) fn pose_at(machine: &Machine, text: &str) -> Result<Pose, Diagnostic> {
    let mut pose = vec![0.0; machine.axes().len()];
    let mut seen = vec![false; pose.len()];
    for part in text.split(',').filter(|part| !part.trim().is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| unfit(format!("`{part}`: write AXIS=POSITION")))?;
        let axis = machine.axis_index(name.trim()).ok_or_else(|| unfit(unknown_axis(machine, name.trim())))?;
        if std::mem::replace(&mut seen[axis], true) {
            return Err(unfit(format!("axis `{}` is given twice", name.trim())));
        }
        pose[axis] = position(machine, axis, value)?;
    }
    Ok(pose)
}

/// Returns the pose of `X=100,C=90`; omitted axes stay as in `pose`.
pub(crate) fn pose_by_names(machine: &Machine, text: &str, mut pose: Pose) -> Result<Pose, Diagnostic> {
    let given = pose_at(machine, text)?;
    for part in text.split(',') {
        let name = part.split_once('=').map_or("", |(name, _)| name.trim());
        if let Some(axis) = machine.axis_index(name) {
            pose[axis] = given[axis];
        }
    }
    Ok(pose)
}

/// Returns the ranges of `A=-60..60,C=0..180` in the order of the axes (mm, deg), each within the volume.
pub(crate) fn axis_ranges(machine: &Machine, text: &str) -> Result<Vec<Option<(f64, f64)>>, Diagnostic> {
    let mut ranges = vec![None; machine.axes().len()];
    for part in text.split(',').filter(|part| !part.trim().is_empty()) {
        let fault = || unfit(format!("`{}`: write AXIS=FIRST..LAST", shown(part.trim())));
        let (name, ends) = part.split_once('=').ok_or_else(fault)?;
        let (first, last) = ends.split_once("..").ok_or_else(fault)?;
        let axis = machine.axis_index(name.trim()).ok_or_else(|| unfit(unknown_axis(machine, name.trim())))?;
        let ends = (position(machine, axis, first.trim())?, position(machine, axis, last.trim())?);
        let volume = &machine.volume()[axis];
        if !(volume.min <= ends.0 && ends.0 < ends.1 && ends.1 <= volume.max) {
            let [min, max] = [volume.min, volume.max].map(|end| units::significant(end, 7));
            return Err(unfit(format!("`{}` is no range within {min}..{max}, the volume", shown(part.trim()))));
        }
        if ranges[axis].replace(ends).is_some() {
            return Err(unfit(format!("axis `{}` is given twice", name.trim())));
        }
    }
    Ok(ranges)
}

/// A bare number (mm or deg) or a quantity with its unit.
fn position(machine: &Machine, axis: usize, text: &str) -> Result<f64, Diagnostic> {
    let failure = match units::number(text) {
        Ok(value) => return Ok(value),
        Err(failure) => failure,
    };
    let quantity = units::quantity(text).map_err(|_| unfit(failure.to_string()))?;
    let linear = machine.axes()[axis].kind == AxisKind::Linear;
    let value = if linear { quantity.as_length() } else { quantity.as_angle().map(f64::to_degrees) };
    value.ok_or_else(|| {
        let unit = machine.axes()[axis].unit();
        unfit(format!("`{text}` is {}, not a position in {unit}", quantity.dimension.word()))
    })
}

fn unfit(message: String) -> Diagnostic {
    Diagnostic::new(codes::E0818, message)
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

/// Rows from which on a column of small angles is a sweep, not a few places.
const SWEEP: usize = 20;

/// True if positions are twelfths of pi, to two decimals, and two of them differ from 0.
fn are_parts_of_pi(positions: impl Iterator<Item = f64>) -> bool {
    let mut turned = 0;
    for position in positions.filter(|position| *position != 0.0) {
        let twelfths = position * 12.0 / std::f64::consts::PI;
        let off = (twelfths - libm::round(twelfths)).abs() * std::f64::consts::PI / 12.0;
        let is_whole = position == libm::round(position);
        if off > 0.005 || is_whole || position.abs() > 6.3 {
            return false;
        }
        turned += 1;
    }
    turned >= 2
}

/// Warns of columns without a unit whose positions look like radians or metres, once each.
pub(crate) fn other_units<'p>(
    machine: &Machine,
    header: &[String],
    poses: impl Iterator<Item = &'p Pose> + Clone,
    place: &Option<Place>,
) -> Vec<Diagnostic> {
    let is_bare = |axis: &Axis| header.iter().any(|cell| *axis.name.as_str() == **cell);
    let one = |(column, axis): (usize, &Axis)| {
        let positions = || poses.clone().map(|pose| pose[column]);
        let [min, max] = [positions().fold(f64::INFINITY, f64::min), positions().fold(f64::NEG_INFINITY, f64::max)];
        let few = positions().count() < SWEEP;
        if few && !(axis.kind == AxisKind::Rotary && are_parts_of_pi(positions())) {
            return None;
        }
        let name = &axis.name;
        let (message, units) = match (axis.kind, axis.travel) {
            (AxisKind::Rotary, _) if few => {
                (format!("the column `{name}` has parts of pi alone: are these radians?"), ["deg", "rad"])
            }
            (AxisKind::Rotary, _) if max - min > 3.0 && max.max(-min) <= std::f64::consts::TAU => {
                let message =
                    format!("the column `{name}` turns by more than 3 and ends before 2 pi: are these radians?");
                (message, ["deg", "rad"])
            }
            // A fifth of the travel, if these are metres.
            (AxisKind::Linear, Travel::Range(from, to))
                if 1e3 * (max - min) > 0.2 * (to - from) && 1e3 * min >= from && 1e3 * max <= to =>
            {
                let range = format!("{} to {}", significant(min, 4), significant(max, 4));
                (format!("the column `{name}` goes from {range} alone: are these metres?"), ["mm", "m"])
            }
            _ => return None,
        };
        let [ours, theirs] = units;
        let help = format!("positions are in {ours}; say `{name} [{theirs}]` or `{name} [{ours}]` in the header");
        Some(Diagnostic::new(codes::W0804, message).at(place.clone(), "").help(help))
    };
    machine.axes().iter().enumerate().filter(|(_, axis)| is_bare(axis)).filter_map(one).collect()
}

/// Reads a file of poses of the axes: a header of axis names, one pose a line, mm and deg.
pub(crate) fn rows_of_file(call: &mut Call<'_>, machine: &Machine, path: &Path) -> Result<Vec<PoseRow>, Refused> {
    let read = read_table_text(path, None, call.run.files, &mut call.diagnostics);
    let Some((source, text)) = read else { return Err(Refused) };
    let parsed = parse(machine, &text);
    let PoseTable { header, poses } = parsed.or_else(|(line, refusal)| {
        let place = Some(line_place(source, &text, line));
        let help = "a pose file has a header of axis names (`X, Y, C` or `X [mm]`) and one pose a line, mm and deg";
        call.refuse(refusal.at(place, "").help(help))
    })?;
    let line = text.lines().nth(header).unwrap_or("");
    let cells: Vec<String> = line.split(separator(line)).map(|cell| cell.trim().to_owned()).collect();
    let place = Some(line_place(source, &text, header));
    call.extend(other_units(machine, &cells, poses.iter().map(|(_, pose)| pose), &place));
    let starts: Vec<usize> = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
    let row = |(line, pose): (usize, Pose)| {
        let start = starts.get(line).copied().unwrap_or(text.len());
        let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
        PoseRow { place: Place { source, range: start..start + length }, line: line + 1, pose }
    };
    Ok(poses.into_iter().map(row).collect())
}

fn line_place(source: SourceId, text: &str, line: usize) -> Place {
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    Place { source, range: start..start + length }
}

fn wrong(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0802, message)
}

/// A table of poses; lines are from 0.
struct PoseTable {
    header: usize,
    poses: Vec<(usize, Pose)>,
}

/// Returns the table of a text, or a line with its refusal.
fn parse(machine: &Machine, text: &str) -> Result<PoseTable, (usize, Diagnostic)> {
    let data = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.lines().enumerate().filter(|(_, line)| data(line));
    let (at, header) = lines.next().ok_or((0, wrong("the file has no header")))?;
    let separator = separator(header);
    let columns = header_columns(machine, header, separator).map_err(|refusal| (at, refusal))?;
    let mut poses = Vec::new();
    for (number, line) in lines {
        let pose = row(machine, &columns, line, separator).map_err(|refusal| (number, refusal))?;
        poses.push((number, pose));
        if poses.len() > MAX_POSES {
            return Err((number, wrong(format!("more than {MAX_POSES} poses; use `map` for a whole volume"))));
        }
    }
    if poses.is_empty() { Err((at, wrong("the file has no poses"))) } else { Ok(PoseTable { header: at, poses }) }
}

fn header_columns(machine: &Machine, header: &str, separator: char) -> Result<Vec<Column>, Diagnostic> {
    let mut columns: Vec<Column> = Vec::new();
    if header.split(separator).all(|cell| sheet::number(cell, separator).is_ok()) {
        return Err(wrong("the header is missing: the first line holds numbers"));
    }
    for cell in header.split(separator) {
        let (name, unit) = units::header(cell);
        let axis = machine.axis_index(name).ok_or_else(|| wrong(unknown_axis(machine, name)))?;
        if columns.iter().any(|column| column.axis == axis) {
            return Err(wrong(format!("column `{name}` is there twice")));
        }
        columns.push(Column { axis, factor: unit.map_or(Ok(1.0), |unit| factor(machine, axis, unit))? });
    }
    Ok(columns)
}

fn factor(machine: &Machine, axis: usize, unit: &str) -> Result<f64, Diagnostic> {
    let (factor, dimension) = units::unit(unit).map_err(|failure| wrong(failure.to_string()))?;
    match machine.axes()[axis].kind {
        AxisKind::Linear if dimension == units::Dimension::LENGTH => Ok(factor),
        // Degrees stay degrees: no detour over radians that would cost a bit.
        AxisKind::Rotary if unit == "deg" || unit == "°" => Ok(1.0),
        AxisKind::Rotary if dimension == units::Dimension::ANGLE => Ok(factor.to_degrees()),
        _ => {
            let name = &machine.axes()[axis].name;
            Err(wrong(format!("`{unit}` is {}, not a unit for `{name}`", dimension.word())))
        }
    }
}

fn row(machine: &Machine, columns: &[Column], line: &str, separator: char) -> Result<Pose, Diagnostic> {
    let cells: Vec<&str> = line.split(separator).collect();
    if cells.len() != columns.len() {
        return Err(wrong(format!("{} cells under {} columns", cells.len(), columns.len())));
    }
    let mut pose = vec![0.0; machine.axes().len()];
    for (cell, column) in cells.iter().zip(columns) {
        pose[column.axis] =
            sheet::number(cell, separator).map_err(|failure| wrong(failure.to_string()))? * column.factor;
    }
    Ok(pose)
}

/// Poses beyond the travel of an axis: their number, and of the farthest one how far it is, its position and number.
#[derive(Default)]
struct BeyondTravel {
    count: usize,
    far: f64,
    position: f64,
    pose: usize,
}

/// Refuses poses where an error curve is not defined; warns about those beyond the travel.
pub(crate) fn check<'p>(
    call: &mut Call<'_>,
    machine: &Machine,
    poses: impl IntoIterator<Item = &'p Pose>,
) -> Result<(), Refused> {
    let mut beyond: BTreeMap<&str, BeyondTravel> = BTreeMap::new();
    for (number, pose) in (1..).zip(poses) {
        known(machine, pose).or_else(|refusal| call.refuse(refusal))?;
        for (axis, q) in machine.axes().iter().zip(pose).filter(|(axis, q)| !axis.travel.contains(**q)) {
            let (low, high) = axis.travel.interval();
            let far = (low - q).max(q - high);
            let of = beyond.entry(axis.name.as_str()).or_default();
            of.count += 1;
            if far > of.far {
                (of.far, of.position, of.pose) = (far, *q, number);
            }
        }
    }
    for (name, of) in beyond {
        let (count, pose, at) = (of.count, of.pose, significant(of.position, 6));
        let message =
            format!("poses beyond the travel of `{name}` were evaluated: {count}, the farthest pose {pose} at {at}");
        call.warn(Diagnostic::new(codes::W0801, message));
    }
    call.check()
}

/// Refuses a pose where an error curve is not defined.
pub(crate) fn known(machine: &Machine, pose: &[f64]) -> Result<(), Diagnostic> {
    if pose.iter().any(|q| q.is_nan() || q.abs() > units::FARTHEST) {
        let message = "a position is beyond 1000000 mm or deg: no machine goes there";
        return Err(Diagnostic::new(codes::E0802, message).help("positions are in mm and deg"));
    }
    let Some(outside) = machine.outside(pose) else { return Ok(()) };
    let message = format!("{} is not known at {} = {}", outside.error, outside.error.axis, outside.position);
    let (from, to) = outside.domain;
    let help = format!("its table covers {from} to {to}; beyond the travel a table is never extrapolated");
    Err(Diagnostic::new(codes::E0803, message).help(help))
}
