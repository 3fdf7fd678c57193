//! Tool poses from a file, as the work of a machine: the functional point in the workpiece frame with the
//! direction of the tool axis, or with positions of the rotary axes.
//!
//! Rows that a machine cannot reach are omitted, named row by row, and counted.

use super::poses::check;
use super::run::{Call, Refused};
use crate::analysis::{ToolPose, Unreachable, UnreachableCount, inverse, place, rest, tool_pose};
use crate::diagnostic::{Diagnostic, Place, SourceId, codes, shown};
use crate::machine::{AxisKind, Machine, Pose};
use crate::syntax::read_text;
use crate::units::{self, Dimension};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Largest number of tool poses of a file.
const MAX_TOOL_POSES: usize = 1_000_000;

/// Number of rows that are named one by one.
const NAMED: usize = 10;

/// Direction of the tool.
#[derive(Debug, Clone)]
enum Aim {
    /// Unit vector from the tip to the holder, workpiece frame.
    Axis(Vector3<f64>),
    /// The machine's rotary axes as given (deg), all others at 0.
    Rotary(Pose),
}

/// A row of the file.
#[derive(Debug, Clone)]
struct Row {
    /// Place of the row in the file.
    place: Place,
    /// 1-based.
    line: usize,
    tip: Vector3<f64>,
    aim: Aim,
}

/// The rows of a file.
#[derive(Debug, Clone)]
pub(crate) struct ToolPoses {
    file: String,
    rows: Vec<Row>,
}

/// Tool poses of a file that a machine reaches.
#[derive(Debug, Clone, serde::Serialize)]
pub struct ReachedToolPoses {
    /// Name of the file.
    pub file: String,
    /// Number of tool poses in the file.
    pub asked: usize,
    /// Number of tool poses that the machine reaches.
    pub reached: usize,
    /// Number of the others, by reason.
    pub unreachable: UnreachableCount,
    /// The others, row by row.
    pub rows: Vec<MissedToolPose>,
    /// The poses of the machine (mm, deg), in the order of the rows.
    #[serde(skip)]
    pub(crate) poses: Vec<Pose>,
}

/// A tool pose that a machine does not reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct MissedToolPose {
    /// Line of the file, from 1.
    pub line: usize,
    /// The reason.
    pub why: Unreachable,
}

/// Reads a file; rotary columns are those of `machine`.
pub(crate) fn read(call: &mut Call<'_>, machine: &Machine, path: &Path) -> Result<ToolPoses, Refused> {
    let read = read_text(path, None, call.run.files, &mut call.diagnostics);
    let Some((source, text)) = read else { return Err(Refused) };
    match parse(machine, source, &text) {
        Ok(rows) => Ok(ToolPoses { file: path.display().to_string(), rows }),
        Err(refusal) => {
            let help = "columns are X, Y, Z (mm, from the workpiece origin), and I, J, K of the tool axis or \
             positions of rotary axes (deg)";
            call.refuse(refusal.help(help))
        }
    }
}

/// The poses for the tool poses of a file, if there is one.
pub(crate) fn asked(
    call: &mut Call<'_>,
    machine: &Machine,
    path: Option<&PathBuf>,
) -> Result<Option<ReachedToolPoses>, Refused> {
    path.map(|path| read(call, machine, path)?.reached(call, machine)).transpose()
}

impl ToolPoses {
    /// Returns poses of the tool, as the nominal `machine` holds it; the file may give positions of its rotary axes.
    pub(crate) fn list(&self, machine: &Machine) -> Vec<ToolPose> {
        let direction = |aim: &Aim| match aim {
            Aim::Axis(direction) => *direction,
            Aim::Rotary(pose) => tool_pose(machine, pose).direction,
        };
        self.rows.iter().map(|row| ToolPose { tip: row.tip, direction: direction(&row.aim) }).collect()
    }

    /// Returns the poses of a machine for all rows that it reaches. Reports the others; refuses a file without a
    /// reachable row.
    pub(crate) fn reached(&self, call: &mut Call<'_>, machine: &Machine) -> Result<ReachedToolPoses, Refused> {
        let at_rest = rest(machine);
        let found: Vec<Result<Pose, Unreachable>> =
            self.rows.par_iter().map(|row| pose_at(machine, row, &at_rest)).collect();
        let missed: Vec<_> =
            found.iter().enumerate().filter_map(|(i, pose)| Some((i, *pose.as_ref().err()?))).collect();
        self.say(call, machine, &missed)?;
        let poses: Vec<Pose> = found.into_iter().filter_map(Result::ok).collect();
        check(call, machine, &poses)?;
        let unreachable = UnreachableCount::count(missed.iter().map(|(_, why)| why));
        let (file, asked, reached) = (self.file.clone(), self.rows.len(), poses.len());
        Ok(ReachedToolPoses { file, asked, reached, unreachable, rows: self.missed(&missed), poses })
    }

    /// Returns the lines of rows that were missed, with the reason.
    pub(crate) fn missed(&self, missed: &[(usize, Unreachable)]) -> Vec<MissedToolPose> {
        missed.iter().map(|(i, why)| MissedToolPose { line: self.rows[*i].line, why: *why }).collect()
    }

    /// Names the rows that a machine does not reach; all of them are refused.
    pub(crate) fn say(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
        missed: &[(usize, Unreachable)],
    ) -> Result<(), Refused> {
        let name = shown(machine.name());
        if !self.rows.is_empty() && missed.len() == self.rows.len() {
            let reasons = reasons(missed.iter().map(|(_, why)| why));
            let message = format!("`{name}` reaches none of the {} tool poses: {reasons}", missed.len());
            let help = "tips count from the workpiece origin, in the workpiece frame: check that origin, the tool \
             and the travels";
            return call.refuse(Diagnostic::new(codes::E0613, message).help(help));
        }
        for (i, why) in missed.iter().take(NAMED) {
            let message = format!("`{name}` does not reach this tool pose: {}", why.words());
            let diagnostic = Diagnostic::new(codes::W0608, message).at(Some(self.rows[*i].place.clone()), "left out");
            call.warn(diagnostic);
        }
        if missed.len() > NAMED {
            let rest = &missed[NAMED..];
            let message = format!(
                "`{name}` does not reach {} tool poses more: {}",
                rest.len(),
                reasons(rest.iter().map(|(_, why)| why))
            );
            call.warn(Diagnostic::new(codes::W0608, message).help("`--format json` lists all of them"));
        }
        call.checked()
    }
}

/// `3 direction, 9 travel`.
fn reasons<'a>(why: impl Iterator<Item = &'a Unreachable>) -> String {
    let m = UnreachableCount::count(why);
    let each = [(m.direction, "direction"), (m.place, "place"), (m.travel, "travel")];
    each.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect::<Vec<_>>().join(", ")
}

fn pose_at(machine: &Machine, row: &Row, at_rest: &[f64]) -> Result<Pose, Unreachable> {
    match &row.aim {
        Aim::Axis(direction) => inverse(machine, &ToolPose { tip: row.tip, direction: *direction }, at_rest),
        Aim::Rotary(rotary) => {
            let start = machine.axes().iter().zip(rotary).zip(at_rest);
            let pose: Pose = start
                .map(|((axis, turned), rest)| if axis.kind == AxisKind::Rotary { *turned } else { *rest })
                .collect();
            let placed = place(machine, &row.tip, &pose)?;
            if machine.beyond_travel(&placed).next().is_some() { Err(Unreachable::Travel) } else { Ok(placed) }
        }
    }
}

/// Content of a column, with the factor to mm or deg.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Tip(usize, f64),
    Axis(usize),
    Rotary(usize, f64),
}

fn wrong(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0817, message)
}

fn parse(machine: &Machine, source: SourceId, text: &str) -> Result<Vec<Row>, Diagnostic> {
    let mut start = 0;
    let mut lines = text.split_inclusive('\n').enumerate().filter_map(|(number, line)| {
        let content = line.trim_end();
        let place = Place { source, range: start..start + content.len() };
        start += line.len();
        let counts = !content.trim_start().is_empty() && !content.trim_start().starts_with('#');
        counts.then_some((number + 1, place, content))
    });
    let whole = Place { source, range: 0..0 };
    let (_, place, header) = lines.next().ok_or_else(|| wrong("the file has no header").at(Some(whole), ""))?;
    let columns = columns(machine, header).map_err(|refusal| refusal.at(Some(place.clone()), ""))?;
    let mut rows = Vec::new();
    for (line, place, text) in lines {
        let (tip, aim) = row(machine, &columns, text).map_err(|refusal| refusal.at(Some(place.clone()), ""))?;
        if rows.len() == MAX_TOOL_POSES {
            return Err(wrong(format!("more than {MAX_TOOL_POSES} tool poses")).at(Some(place), ""));
        }
        rows.push(Row { place, line, tip, aim });
    }
    if rows.is_empty() { Err(wrong("the file has no tool poses").at(Some(place), "")) } else { Ok(rows) }
}

fn columns(machine: &Machine, header: &str) -> Result<Vec<Column>, Diagnostic> {
    let columns: Vec<Column> = header.split(',').map(|cell| column(machine, cell)).collect::<Result<_, _>>()?;
    let same = |a: &Column, b: &Column| match (a, b) {
        (Column::Tip(i, _), Column::Tip(k, _)) | (Column::Axis(i), Column::Axis(k)) => i == k,
        (Column::Rotary(i, _), Column::Rotary(k, _)) => i == k,
        _ => false,
    };
    if let Some(i) = (0..columns.len()).find(|i| columns[..*i].iter().any(|other| same(other, &columns[*i]))) {
        let name = header.split(',').nth(i).unwrap_or("").trim();
        return Err(wrong(format!("column `{}` is there twice", shown(name))));
    }
    let count = |kind: fn(&Column) -> bool| columns.iter().filter(|column| kind(column)).count();
    let axis = count(|c| matches!(c, Column::Axis(_)));
    if count(|c| matches!(c, Column::Tip(..))) != 3 {
        return Err(wrong("the columns X, Y and Z are needed: the functional point in the workpiece frame"));
    }
    match (axis, count(|c| matches!(c, Column::Rotary(..)))) {
        (1 | 2, _) => Err(wrong("of I, J and K all are needed, or none")),
        (3, 1..) => Err(wrong("the tool axis is given twice: by I, J, K and by rotary axes")),
        _ => Ok(columns),
    }
}

fn column(machine: &Machine, cell: &str) -> Result<Column, Diagnostic> {
    let (name, unit) = units::header(cell);
    let factor = |dimension: Dimension, one: f64| match unit {
        None => Ok(one),
        Some("deg" | "°") if dimension == Dimension::ANGLE => Ok(1.0),
        Some(unit) => {
            let (factor, of) = units::unit(unit).map_err(|failure| wrong(failure.to_string()))?;
            let degrees = if dimension == Dimension::ANGLE { factor.to_degrees() } else { factor };
            if of == dimension {
                Ok(degrees)
            } else {
                Err(wrong(format!("`{unit}` is {}, not a unit for `{name}`", of.word())))
            }
        }
    };
    if let Some(i) = ["X", "Y", "Z"].iter().position(|letter| *letter == name) {
        return Ok(Column::Tip(i, factor(Dimension::LENGTH, 1.0)?));
    }
    if let (Some(i), None) = (["I", "J", "K"].iter().position(|letter| *letter == name), unit) {
        return Ok(Column::Axis(i));
    }
    let rotary = |i: &usize| machine.axes()[*i].kind == AxisKind::Rotary;
    match machine.axis_index(name).filter(rotary) {
        Some(i) => Ok(Column::Rotary(i, factor(Dimension::ANGLE, 1.0)?)),
        None => {
            let rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary);
            let names: Vec<&str> = rotary.map(|axis| axis.name.as_str()).collect();
            let known = if names.is_empty() { "there is none".to_owned() } else { names.join(", ") };
            Err(wrong(format!("column `{}` is neither X, Y, Z nor I, J, K nor a rotary axis ({known})", shown(name))))
        }
    }
}

fn row(machine: &Machine, columns: &[Column], line: &str) -> Result<(Vector3<f64>, Aim), Diagnostic> {
    const FARTHEST: f64 = 1e6;
    let cells: Vec<&str> = line.split(',').collect();
    if cells.len() != columns.len() {
        return Err(wrong(format!("{} cells under {} columns", cells.len(), columns.len())));
    }
    let (mut tip, mut axis, mut pose) = (Vector3::zeros(), Vector3::zeros(), vec![0.0; machine.axes().len()]);
    for (cell, column) in cells.iter().zip(columns) {
        let number = units::number(cell).map_err(|failure| wrong(failure.to_string()))?;
        match *column {
            Column::Tip(i, factor) => tip[i] = number * factor,
            Column::Axis(i) => axis[i] = number,
            Column::Rotary(i, factor) => pose[i] = number * factor,
        }
    }
    if tip.iter().chain(&pose).any(|x| x.abs() > FARTHEST) {
        return Err(wrong("a position is beyond 1000000 mm or deg: no machine goes there"));
    }
    if columns.iter().any(|column| matches!(column, Column::Rotary(..))) {
        return Ok((tip, Aim::Rotary(pose)));
    }
    if !columns.iter().any(|column| matches!(column, Column::Axis(_))) {
        return Ok((tip, Aim::Axis(Vector3::from(machine.tool().direction))));
    }
    // Scaled first: the square of a large or small number is not one.
    let largest = axis.amax();
    let scaled = if largest > 0.0 && largest.is_finite() { axis / largest } else { Vector3::zeros() };
    match scaled.try_normalize(0.0) {
        Some(direction) => Ok((tip, Aim::Axis(direction))),
        None => Err(wrong("the tool axis I, J, K has no direction: it is zero")),
    }
}
