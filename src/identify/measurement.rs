//! Measurements: a CSV file with a column per axis and any of `dx`, `dy`, `dz`.
//!
//! A deviation is that of the functional point, actual minus nominal, its unit in the header. Optional columns:
//! `tool` (a tool's name), `weight` (how much a row counts; 1 is usual), `run` (a label). Comma, semicolon or
//! tab separate; `#` starts a comment line; an empty cell of dx, dy, dz was not measured.

use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, did_you_mean, shown};
use crate::machine::{AxisKind, Machine, Pose};
use crate::syntax::{Files, read_text};
use crate::units::{self, Dimension};
use std::path::Path;

/// One row of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Positions of the axes as programmed (mm, deg).
    pub pose: Pose,
    /// Index in [`Machine::tools`].
    pub tool: usize,
    /// dx, dy, dz (mm), actual minus nominal; `None`: not measured.
    pub deviation: [Option<f64>; 3],
    /// Counts as so many rows.
    pub weight: f64,
    /// Its run, if runs were named.
    pub run: Option<String>,
    /// Where it stands.
    pub place: Place,
}

impl Measurement {
    /// How many components were measured.
    pub fn readings(&self) -> usize {
        self.deviation.iter().flatten().count()
    }
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    /// The axis with this index, and the factor to mm or deg.
    Axis(usize, f64),
    /// Component of the deviation, and the factor to mm.
    Deviation(usize, f64),
    Tool,
    Weight,
    Run,
}

/// Mistakes after which the rest of a file is of the same kind.
const MISTAKES: usize = 5;

/// Reads a file of measurements; whatever is wrong with it is reported, and then there are none.
pub fn read_measurements(
    path: &Path,
    machine: &Machine,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Measurement>> {
    let (source, text) = read_text(path, None, files, diagnostics)?;
    let mut lines = lines(source, &text);
    let Some((place, header)) = lines.next() else {
        diagnostics.push(refusal("the file is empty".to_owned(), None));
        return None;
    };
    let separator = [';', '\t'].into_iter().find(|c| header.contains(*c)).unwrap_or(',');
    let columns = match columns(machine, header, separator) {
        Ok(columns) => columns,
        Err(message) => {
            diagnostics.push(refusal(message, Some(place)));
            return None;
        }
    };
    let (mut rows, mut mistakes) = (Vec::new(), 0);
    for (place, line) in lines {
        match row(machine, &columns, line, separator, place.clone()) {
            Ok(row) => rows.push(row),
            Err(message) if mistakes < MISTAKES => {
                mistakes += 1;
                diagnostics.push(refusal(message, Some(place)));
            }
            Err(_) => break,
        }
    }
    if rows.is_empty() && mistakes == 0 {
        diagnostics.push(refusal("the file has a header and no measurements".to_owned(), Some(place)));
    }
    (mistakes == 0 && !rows.is_empty()).then_some(rows)
}

fn refusal(message: String, place: Option<Place>) -> Diagnostic {
    let help = "a measurement file has a column for each axis (mm, deg) and any of `dx [um]`, `dy [um]`, `dz [um]`; \
                optionally `tool`, `weight`, `run`";
    Diagnostic::new("E0501", message).at(place, "").help(help)
}

/// The lines that count, with their places.
fn lines(source: SourceId, text: &str) -> impl Iterator<Item = (Place, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').filter_map(move |line| {
        let content = line.trim_end();
        let range = start..start + content.len();
        start += line.len();
        let data = !content.trim().is_empty() && !content.trim_start().starts_with('#');
        data.then_some((Place { source, range }, content))
    })
}

/// The cells of a line without the quotes that spreadsheets put around text.
fn cells(line: &str, separator: char) -> impl Iterator<Item = &str> {
    let bare = |cell: &str| cell.len() >= 2 && cell.starts_with('"') && cell.ends_with('"');
    line.split(separator).map(str::trim).map(move |cell| if bare(cell) { cell[1..cell.len() - 1].trim() } else { cell })
}

fn columns(machine: &Machine, header: &str, separator: char) -> Result<Vec<Column>, String> {
    let mut columns: Vec<Column> = Vec::new();
    for cell in cells(header, separator) {
        let column = column(machine, cell)?;
        if columns.iter().any(|known| same(*known, column)) {
            return Err(format!("the column `{}` stands here twice", shown(cell)));
        }
        columns.push(column);
    }
    if columns.iter().any(|column| matches!(column, Column::Deviation(..))) {
        return Ok(columns);
    }
    Err("there is no column of deviations".to_owned())
}

fn same(a: Column, b: Column) -> bool {
    match (a, b) {
        (Column::Axis(i, _), Column::Axis(j, _)) | (Column::Deviation(i, _), Column::Deviation(j, _)) => i == j,
        _ => a == b,
    }
}

fn column(machine: &Machine, cell: &str) -> Result<Column, String> {
    let (name, unit) = units::header(cell);
    if let Some(axis) = machine.axis_index(name) {
        return Ok(Column::Axis(axis, unit.map_or(Ok(1.0), |unit| position_factor(machine, axis, unit))?));
    }
    if let Some(component) = ["dx", "dy", "dz"].iter().position(|known| *known == name) {
        let unit = unit.ok_or_else(|| format!("column `{name}` has no unit: write `{name} [um]`"))?;
        return match units::unit(unit) {
            Ok((factor, Dimension::LENGTH)) => Ok(Column::Deviation(component, factor)),
            _ => Err(format!("`{}` is not a unit of length for `{name}`", shown(unit))),
        };
    }
    match name {
        "tool" => Ok(Column::Tool),
        "weight" => Ok(Column::Weight),
        "run" => Ok(Column::Run),
        _ => {
            let axes = machine.axes().iter().map(|axis| axis.name.as_str());
            let known: Vec<&str> = axes.chain(["dx", "dy", "dz", "tool", "weight", "run"]).collect();
            Err(format!("nobody here knows the column `{}`; {}", shown(name), did_you_mean(name, &known)))
        }
    }
}

fn position_factor(machine: &Machine, axis: usize, unit: &str) -> Result<f64, String> {
    let kind = machine.axes()[axis].kind;
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) if kind == AxisKind::Linear => Ok(factor),
        // Degrees stay degrees: no detour over radians that would cost a bit.
        Ok(_) if kind == AxisKind::Rotary && ["deg", "°"].contains(&unit) => Ok(1.0),
        Ok((factor, Dimension::ANGLE)) if kind == AxisKind::Rotary => Ok(factor.to_degrees()),
        _ => Err(format!("`{}` is not a unit for positions of `{}`", shown(unit), machine.axes()[axis].name)),
    }
}

fn row(
    machine: &Machine,
    columns: &[Column],
    line: &str,
    separator: char,
    place: Place,
) -> Result<Measurement, String> {
    let found = cells(line, separator).count();
    if found != columns.len() {
        return Err(format!("this row has {found} cells, the header has {}", columns.len()));
    }
    let tool = machine.tools().iter().position(|tool| tool.name == machine.tool().name).unwrap_or_default();
    let pose = vec![0.0; machine.axes().len()];
    let mut row = Measurement { pose, tool, deviation: [None; 3], weight: 1.0, run: None, place };
    for (cell, column) in cells(line, separator).zip(columns) {
        match *column {
            Column::Axis(axis, factor) => row.pose[axis] = number(cell)? * factor,
            Column::Deviation(..) if cell.is_empty() => {}
            Column::Deviation(component, factor) => row.deviation[component] = Some(number(cell)? * factor),
            Column::Tool if cell.is_empty() => {}
            Column::Tool => row.tool = tool_index(machine, cell)?,
            Column::Weight => row.weight = weight(cell)?,
            Column::Run => row.run = Some(cell.to_owned()),
        }
    }
    if row.readings() == 0 { Err("nothing was measured in this row".to_owned()) } else { Ok(row) }
}

fn number(cell: &str) -> Result<f64, String> {
    units::number(cell)
        .map_err(|failure| if cell.is_empty() { "a cell is empty".to_owned() } else { failure.to_string() })
}

fn weight(cell: &str) -> Result<f64, String> {
    match number(cell)? {
        weight if weight > 0.0 => Ok(weight),
        _ => Err(format!("the weight `{}` is not above zero; leave the row out", shown(cell))),
    }
}

fn tool_index(machine: &Machine, name: &str) -> Result<usize, String> {
    let known: Vec<&str> = machine.tools().iter().map(|tool| tool.name.as_str()).collect();
    known
        .iter()
        .position(|known| *known == name)
        .ok_or_else(|| format!("the machine has no tool `{}`; {}", shown(name), did_you_mean(name, &known)))
}
