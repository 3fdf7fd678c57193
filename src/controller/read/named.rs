//! Formats whose columns are named in the file: blocks of ISO errors, and tables over one axis.

use super::assemble::error_value;
use super::{Fault, ReadContext, number, patterns};
use crate::compensation::{AxisErrorCurve, CorrectionTable, CorrectionTables};
use crate::controller::emit::tool_direction;
use crate::controller::emit::{StoredColumn, StoredPosition};
use crate::controller::manifest::TextFrame;
use crate::machine::{AxisKind, parse_error_name};
use nalgebra::Vector3;

/// True for names of the machine's geometry in the same files. The certificate is of the machine file's geometry, so
/// that of the file must be the same.
fn is_geometry(name: &str) -> bool {
    let letters: Vec<char> = name.chars().collect();
    match letters[..] {
        ['P' | 'N', '0', 'X' | 'Y' | 'Z'] | ['I', 'D', 'X' | 'Y' | 'Z'] => true,
        ['P', 'X' | 'Y' | 'Z', 'A' | 'B' | 'C'] => true,
        ['V', 'X' | 'Y' | 'Z', axis] | ['L', 'N', axis] => "XYZABC".contains(axis),
        _ => false,
    }
}

/// Largest effect (mm) of a turn that is not the machine file's: ten times the written resolution.
const SAME: f64 = 1e-5;
/// Largest difference (mm, rad), whatever its effect.
const NEAR: f64 = 1.0;
/// Distance (mm) at which a turned direction displaces the lever of an angular error.
const REACH: f64 = 1e3;

/// Distance of a line in a file, of a rotary axis or of the tool, from the machine file's.
struct OffLine {
    line: usize,
    of: String,
    /// Distance of its point, across the line, mm.
    off: f64,
    /// Angle of its direction, rad.
    turned: f64,
}

/// Refuses lines of rotary axes by which the curves of the file would have another effect. After a second round they
/// are off by what the kinematic parameters were corrected by: that counts as a product with the errors.
fn same_effect(lines: &[OffLine], errors: &[AxisErrorCurve]) -> Result<(), Fault> {
    let largest = |rotations: bool| {
        let of_kind = errors.iter().filter(|curve| curve.error.direction.is_rotation() == rotations);
        of_kind.flat_map(|curve| &curve.values).fold(0.0, |max: f64, x| max.max(x.abs()))
    };
    let (mm, rad) = (largest(false), largest(true));
    for OffLine { line, of, off, turned } in lines {
        if off * rad + turned * (mm + REACH * rad) > SAME || off.max(*turned) > NEAR {
            let what = if off > turned { "point" } else { "direction" };
            let message = format!("the {what} of {of} is not that of the machine file, which is what is certified");
            return Err(Fault::new(*line, message));
        }
    }
    Ok(())
}

/// Reads lines of rotary axes (`PXC PYC PZC`, a point; `VXC VYC VZC`, the direction).
fn lines_of_turns(reading: &ReadContext, line: usize, names: &[&str], row: &[f64]) -> Result<Vec<OffLine>, Fault> {
    let mut all = Vec::new();
    for axis in reading.machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary) {
        let words = ["PX", "PY", "PZ", "VX", "VY", "VZ"].iter().map(|word| format!("{word}{}", axis.name));
        let known: Vec<f64> =
            words.filter_map(|word| names.iter().position(|name| *name == word)).map(|at| row[at]).collect();
        let [px, py, pz, vx, vy, vz] = known[..] else {
            if known.is_empty() {
                continue;
            }
            return Err(Fault::new(line, format!("the line of `{}` is not whole: PX PY PZ and VX VY VZ", axis.name)));
        };
        let direction = Vector3::from(axis.direction);
        let off = (Vector3::new(px, py, pz) - Vector3::from(axis.origin)).cross(&direction).norm();
        let turned = (Vector3::new(vx, vy, vz) - direction).norm();
        all.push(OffLine { line, of: format!("`{}`", axis.name), off, turned });
    }
    Ok(all)
}

/// Reads the tool (`P0X P0Y P0Z`, where one without length ends; `N0X N0Y N0Z`, its direction to the tip), directions
/// of linear axes, and what must be 0 or the machine's: offsets of axes and their numbers.
fn other_geometry(reading: &ReadContext, line: usize, names: &[&str], row: &[f64]) -> Result<Vec<OffLine>, Fault> {
    let machine = reading.machine;
    let number = |name: String| names.iter().position(|known| *known == name).map(|at| row[at]);
    let three = |before: &str, after: &str| ["X", "Y", "Z"].map(|k| number(format!("{before}{k}{after}")));
    let mut all = Vec::new();
    let mut compare = |of: &str, found: [Option<f64>; 3], wanted: [f64; 3], is_point: bool| match found {
        [None, None, None] => Ok(()),
        [Some(x), Some(y), Some(z)] => {
            let apart = (Vector3::new(x, y, z) - Vector3::from(wanted)).norm();
            let (off, turned) = if is_point { (apart, 0.0) } else { (0.0, apart) };
            all.push(OffLine { line, of: of.to_owned(), off, turned });
            Ok(())
        }
        _ => {
            Err(Fault::new(line, format!("the {} of {of} is not whole", if is_point { "point" } else { "direction" })))
        }
    };
    compare("the tool", three("P0", ""), machine.tool().gauge, true)?;
    compare("the tool", three("N0", ""), tool_direction(machine.tool()), false)?;
    for axis in machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear) {
        compare(&format!("`{}`", axis.name), three("V", axis.name.as_str()), axis.direction, false)?;
    }
    if three("ID", "").into_iter().flatten().any(|offset| offset != 0.0) {
        return Err(Fault::new(line, "offsets of axes (ID): their effect would not be in the certificate"));
    }
    for known in &reading.letters {
        if number(format!("LN{}", known.letter)).is_some_and(|stated| stated != known.number as f64) {
            return Err(Fault::new(line, format!("`LN{}` is not the number of this axis", known.letter)));
        }
    }
    Ok(all)
}

/// True if it names the position of an axis, of this machine or of another one.
fn is_argument(reading: &ReadContext, name: &str) -> bool {
    reading.machine.axis_index(name).is_some() || matches!(name, "X" | "Y" | "Z" | "A" | "B" | "C")
}

/// Blocks of columns under a line of names, `//` before a comment, a line with `#` between blocks: one
/// row of constants, or an axis and its errors.
pub(super) fn error_columns(reading: &ReadContext, text: &str) -> Result<CorrectionTables, Fault> {
    let (mut all, mut turns) = (CorrectionTables::default(), Vec::new());
    let mut header: Option<(usize, Vec<&str>)> = None;
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    for (line, words) in text.lines().enumerate() {
        let bare = words.split("//").next().unwrap_or_default().trim();
        if bare.starts_with('#') {
            block(reading, header.take(), &std::mem::take(&mut rows), &mut all, &mut turns)?;
        } else if bare.is_empty() {
        } else if let Some((_, names)) = &header {
            let cells: Result<Vec<f64>, _> = bare.split_whitespace().map(number).collect();
            let cells = cells.map_err(|bad| Fault::new(line, bad))?;
            if cells.len() != names.len() {
                return Err(Fault::new(line, format!("{} numbers under {} names", cells.len(), names.len())));
            }
            rows.push((line, cells));
        } else {
            header = Some((line, bare.split_whitespace().collect()));
        }
    }
    block(reading, header, &rows, &mut all, &mut turns)?;
    same_effect(&turns, &all.errors)?;
    Ok(all)
}

fn block(
    reading: &ReadContext,
    header: Option<(usize, Vec<&str>)>,
    rows: &[(usize, Vec<f64>)],
    all: &mut CorrectionTables,
    turns: &mut Vec<OffLine>,
) -> Result<(), Fault> {
    let Some((line, names)) = header else { return Ok(()) };
    let Some(rules) = reading.target.manifest.mechanism.error_curves.as_ref() else { return Ok(()) };
    let argument = reading.machine.axis_index(names[0]);
    // Before the rows: those of two arguments do not rise.
    if names.iter().filter(|name| is_argument(reading, name)).count() > 1 {
        return Err(Fault::new(
            line,
            "a block over two axes: the machine language has no errors that depend on two, so its effect would not be \
             in the certificate. Give the curves over their own axis alone, at one position of the other",
        ));
    }
    if argument.is_none() && is_argument(reading, names[0]) {
        return Err(Fault::new(line, format!("the machine has no axis `{}`", names[0])));
    }
    if rows.is_empty() {
        return Err(Fault::new(line, "there are no rows under these names"));
    }
    if argument.is_none() && rows.len() != 1 {
        return Err(Fault::new(rows[1].0, "constants have one row"));
    }
    let place = argument.map(|axis| StoredPosition { rules, kind: reading.machine.axes()[axis].kind });
    let positions: Vec<f64> =
        place.map_or_else(Vec::new, |place| rows.iter().map(|(_, row)| place.position(row[0])).collect());
    if let Some(i) = positions.windows(2).position(|w| w[1] <= w[0]) {
        return Err(Fault::new(rows[i + 1].0, "the positions do not rise"));
    }
    if argument.is_none() {
        if let Some((_, twice)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            return Err(Fault::new(line, format!("`{twice}` is there twice (error 70469)")));
        }
        turns.extend(lines_of_turns(reading, line, &names, &rows[0].1)?);
        turns.extend(other_geometry(reading, line, &names, &rows[0].1)?);
    }
    for (column, name) in names.iter().enumerate().skip(usize::from(argument.is_some())) {
        if argument.is_none() && is_geometry(name) {
            continue;
        }
        let known = parse_error_name(name).filter(|id| reading.machine.axis_index(id.axis.as_str()).is_some());
        let error = known
            .ok_or_else(|| Fault::new(line, format!("`{name}`: the controller knows no such name (error 70468)")))?;
        let own = argument.map(|axis| &reading.machine.axes()[axis].name);
        if error.is_location() != own.is_none() || own.is_some_and(|own| *own != error.axis) {
            return Err(Fault::new(line, format!("`{name}` is no error of this block's axis")));
        }
        if all.errors.iter().any(|curve| curve.error == error) {
            return Err(Fault::new(line, format!("`{name}` is there twice (error 70469)")));
        }
        let values = rows.iter().map(|(_, row)| error_value(rules, error.direction, row[column])).collect();
        all.errors.push(AxisErrorCurve { error, positions: positions.clone(), values });
    }
    Ok(())
}

/// The names of the columns over one axis.
pub(super) struct CurveHeader<'a> {
    pub position: &'a str,
    pub reversal: &'a str,
    pub frame: &'a TextFrame,
}

/// The lines between the first and the last one of a frame, without comments and blank lines.
pub(super) fn lines_in_frame<'a>(frame: &TextFrame, text: &'a str) -> Result<Vec<(usize, &'a str)>, Fault> {
    let said = text.lines().map(str::trim).enumerate();
    let mut said = said.filter(|(_, line)| !line.is_empty() && !line.starts_with(&*frame.comment));
    let (line, first) = said.next().ok_or_else(|| Fault::new(0, "there is nothing but comments"))?;
    if !frame.begin.iter().any(|pattern| patterns::fits(pattern, first)) {
        return Err(Fault::new(line, format!("the first line is none like `{}`", frame.begin.join("`, `"))));
    }
    let mut inner: Vec<(usize, &str)> = Vec::new();
    while let Some((line, bare)) = said.next() {
        if bare != frame.end {
            inner.push((line, bare));
        } else if let Some((line, _)) = said.next() {
            return Err(Fault::new(line, format!("text behind `{}`", frame.end)));
        } else {
            return Ok(inner);
        }
    }
    let end = text.lines().count().saturating_sub(1);
    Err(Fault::new(end, format!("the file does not end with `{}`: it was cut off", frame.end)))
}

/// True if a text begins as a frame does.
pub(super) fn begins(frame: &TextFrame, text: &str) -> bool {
    let mut said = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with(&*frame.comment));
    said.next().is_some_and(|first| frame.begin.iter().any(|pattern| patterns::fits(pattern, first)))
}

/// A cell and the place of its first letter.
pub(super) type Cell<'t> = (usize, &'t str);

pub(super) fn cells(line: &str) -> Vec<Cell<'_>> {
    let start = |cell: &str| cell.as_ptr() as usize - line.as_ptr() as usize;
    line.split_whitespace().map(|cell| (start(cell), cell)).collect()
}

/// The cell under each name; none where a cell is blank, of rows whose cells begin where their names do.
pub(super) fn under<'t>(names: &[Cell], found: &[Cell<'t>]) -> Option<Vec<Option<&'t str>>> {
    if found.len() == names.len() {
        return Some(found.iter().map(|(_, cell)| Some(*cell)).collect());
    }
    let aligned = found.iter().all(|(start, _)| names.iter().any(|(name, _)| name == start));
    let at = |start: usize| found.iter().find(|(known, _)| *known == start).map(|(_, cell)| *cell);
    aligned.then(|| names.iter().map(|(start, _)| at(*start)).collect())
}

/// A line of names, then rows: number, position, and a column for every corrected axis. The file's axis is the input. A
/// column for the negative direction is accepted as long as it holds no other values.
pub(super) fn axis_columns(reading: &ReadContext, header: &CurveHeader, text: &str) -> Result<CorrectionTables, Fault> {
    let input = reading.axis.unwrap_or(0);
    let mut names: Option<Vec<Cell>> = None;
    let mut rows: Vec<(usize, Vec<Option<f64>>)> = Vec::new();
    for (line, bare) in lines_in_frame(header.frame, text)? {
        let cells = cells(bare);
        let Some(names) = &names else {
            names = Some(cells);
            continue;
        };
        let Some(under) = under(names, &cells) else {
            return Err(Fault::new(line, format!("{} cells under {} names", cells.len(), names.len())));
        };
        let value = |cell: &Option<&str>| match cell.filter(|cell| *cell != "-") {
            None => Ok(None),
            Some(cell) => number(cell.trim_start_matches('+')).map(Some),
        };
        if names
            .iter()
            .zip(&under)
            .any(|((_, name), cell)| *name == "NR" && cell.is_none_or(|n| n.parse::<usize>().is_err()))
        {
            return Err(Fault::new(line, "a row begins with its number"));
        }
        let row: Result<Vec<Option<f64>>, _> = under.iter().map(value).collect();
        rows.push((line, row.map_err(|bad| Fault::new(line, bad))?));
    }
    let names = names.ok_or_else(|| Fault::new(0, "there is no line of names"))?;
    let names: Vec<&str> = names.iter().map(|(_, name)| *name).collect();
    let column = |name: &str| names.iter().position(|n| *n == name);
    let position =
        column(header.position).ok_or_else(|| Fault::new(0, format!("there is no column `{}`", header.position)))?;
    let reversal = column(header.reversal);
    let reversing =
        |(_, row): &&(usize, Vec<Option<f64>>)| reversal.and_then(|at| row[at]).is_some_and(|value| value != 0.0);
    if let Some((line, _)) = rows.iter().find(reversing) {
        let message = format!("a value under `{}`: its use by the controller is not public", header.reversal);
        return Err(Fault::new(*line, message));
    }
    let mut all = CorrectionTables::default();
    for (at, name) in names.iter().enumerate() {
        if at == position || Some(at) == reversal || *name == "NR" {
            continue;
        }
        let output =
            reading.by_letter(name).ok_or_else(|| Fault::new(0, format!("the machine has no axis `{name}`")))?;
        all.tables.push(axis_column(reading, input, output, &rows, position, at)?);
    }
    if all.tables.is_empty() { Err(Fault::new(0, "no axis is corrected")) } else { Ok(all) }
}

fn axis_column(
    reading: &ReadContext,
    input: usize,
    output: usize,
    rows: &[(usize, Vec<Option<f64>>)],
    position: usize,
    value: usize,
) -> Result<CorrectionTable, Fault> {
    let mut table = CorrectionTable::curve(input, Vec::new(), output, Vec::new());
    let rules = reading.target.manifest.mechanism.rules(&table);
    let rules = rules.ok_or_else(|| Fault::new(0, "the controller has no table of this kind"))?;
    let axes = reading.machine.axes();
    let (place, cell) = (StoredPosition { rules, kind: axes[input].kind }, StoredColumn::new(rules, axes[output].kind));
    for (line, row) in rows {
        let Some(stored) = row[value] else { continue };
        let q = row[position].ok_or_else(|| Fault::new(*line, "a point without position"))?;
        let q = place.position(q);
        if table.nodes[0].last().is_some_and(|last| q <= *last) {
            return Err(Fault::new(*line, "the positions do not rise"));
        }
        table.nodes[0].push(q);
        table.values.push(cell.correction(stored, Some(q)));
    }
    let count = table.nodes[0].len();
    if count == 0 || count > rules.max_points {
        return Err(Fault::new(0, format!("{count} points: from 1 to {}", rules.max_points)));
    }
    Ok(table)
}
