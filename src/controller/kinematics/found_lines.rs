//! Lines of rotary axes as a table: what a probe or a control's own calibration printed.

use super::{RotaryLine, Transformation};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::Machine;
use crate::syntax::sheet::{Decimals, Sheet, SheetLine, cells, drop_empty, number, separator, title};
use crate::units::{self, Dimension, FARTHEST, significant};
use nalgebra::Vector3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    /// Coordinate of a point of the axis.
    Point(usize),
    /// Its distance from the nominal point.
    Shift(usize),
    /// Component of the direction.
    Direction(usize),
    /// Expanded uncertainty of the point.
    PointUncertainty,
    /// Expanded uncertainty of the direction.
    AngleUncertainty,
}

const TITLES: [(&str, Column); 11] = [
    ("x", Column::Point(0)),
    ("y", Column::Point(1)),
    ("z", Column::Point(2)),
    ("dx", Column::Shift(0)),
    ("dy", Column::Shift(1)),
    ("dz", Column::Shift(2)),
    ("i", Column::Direction(0)),
    ("j", Column::Direction(1)),
    ("k", Column::Direction(2)),
    ("u", Column::PointUncertainty),
    ("u angle", Column::AngleUncertainty),
];

const HELP: &str = "columns are `axis`, of a point of the axis `x [mm]`, `y [mm]`, `z [mm]` or of its shift `dx [um]`, \
                    `dy [um]`, `dz [um]`, of the direction `i`, `j`, `k`, and expanded uncertainties (k = 2) `u [um]` \
                    and `u angle [urad]`; empty cells are nominal";

/// A rotary axis as it was found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FoundLine {
    pub line: RotaryLine,
    /// True for coordinates of the point that were stated.
    pub stated: [bool; 3],
    /// True if the direction was stated.
    pub directed: bool,
    /// Expanded uncertainty (k = 2) of the point, mm.
    pub point_uncertainty: Option<f64>,
    /// Expanded uncertainty (k = 2) of the direction, rad.
    pub angle_uncertainty: Option<f64>,
}

/// Largest distance of a point from the nominal axis, mm: above it, it counts from another zero.
const MAX_SHIFT: f64 = 10.0;

/// Smallest cosine of the angle between a direction and the nominal one: 5 deg.
const MIN_COSINE: f64 = 0.996;

fn refusal(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0519, message.into()).help(HELP)
}

/// The columns of a table, the place of the axis, and the titles that are left out.
struct Header {
    axis: usize,
    columns: Vec<Option<(Column, f64)>>,
    separator: char,
}

/// Lines of a table, and the titles of columns that are left out.
pub(crate) fn found_lines(
    sheet: &Sheet,
    machine: &Machine,
    nominal: &Transformation,
) -> Result<(Vec<FoundLine>, Vec<String>), Diagnostic> {
    let lines = sheet.lines();
    let [first, rows @ ..] = lines.as_slice() else {
        return Err(refusal("the file is empty").at(Some(sheet.start()), ""));
    };
    let at = |line: &SheetLine, why: Diagnostic| why.at(Some(line.place.clone()), "");
    let (header, left_out) = header(&first.text).map_err(|why| at(first, why))?;
    let mut found: Vec<FoundLine> = Vec::new();
    let mut decimals = Decimals::default();
    for line in rows {
        let row = header.line(&line.text, machine, nominal, &mut decimals).map_err(|why| at(line, why))?;
        if found.iter().any(|known| known.line.axis == row.line.axis) {
            let name = &machine.axes()[row.line.axis].name;
            return Err(at(line, refusal(format!("axis `{name}` is there twice"))));
        }
        found.push(row);
    }
    if found.is_empty() { Err(at(first, refusal("there is no axis below the titles"))) } else { Ok((found, left_out)) }
}

fn header(text: &str) -> Result<(Header, Vec<String>), Diagnostic> {
    let separator = separator(text);
    let mut titles = cells(text, separator);
    drop_empty(&mut titles, 1);
    let (mut axis, mut left_out) = (None, Vec::new());
    let mut columns: Vec<Option<(Column, f64)>> = Vec::new();
    for (place, cell) in titles.iter().enumerate() {
        let (name, unit) = title(cell);
        let name = name.to_lowercase();
        let known = TITLES.iter().find(|(known, _)| *known == name).map(|(_, column)| *column);
        let column =
            known.map(|column| Ok::<_, Diagnostic>((column, factor(column, cell, unit.as_deref())?))).transpose()?;
        if column.is_some_and(|(column, _)| columns.iter().flatten().any(|(other, _)| *other == column)) {
            return Err(refusal(format!("column `{}` is there twice", shown(cell))));
        }
        match name.as_str() {
            "axis" if axis.is_none() => axis = Some(place),
            _ if column.is_none() => left_out.push(cell.clone()),
            _ => {}
        }
        columns.push(column);
    }
    let axis = axis.ok_or_else(|| refusal("there is no column `axis`"))?;
    let is = |wanted: fn(&Column) -> bool| columns.iter().flatten().any(|(column, _)| wanted(column));
    if is(|c| matches!(c, Column::Point(_))) && is(|c| matches!(c, Column::Shift(_))) {
        return Err(refusal("points and shifts of them are one too many"));
    }
    Ok((Header { axis, columns, separator }, left_out))
}

/// Factor from the numbers of a column to mm or rad.
fn factor(column: Column, title: &str, unit: Option<&str>) -> Result<f64, Diagnostic> {
    let dimension = match column {
        Column::Direction(_) if unit.is_none() => return Ok(1.0),
        Column::Direction(_) => return Err(refusal(format!("`{}`: a direction has no unit", shown(title)))),
        Column::AngleUncertainty => Dimension::ANGLE,
        _ => Dimension::LENGTH,
    };
    let Some(unit) = unit else { return Err(refusal(format!("the column `{}` has no unit", shown(title)))) };
    match units::unit(unit) {
        Ok((factor, of)) if of == dimension => Ok(factor),
        _ => Err(refusal(format!("`{}` is no unit for the column `{}`", shown(unit), shown(title)))),
    }
}

/// The numbers of a row: mm, rad and components of directions.
#[derive(Default)]
struct Row {
    point: [Option<f64>; 3],
    shift: [Option<f64>; 3],
    direction: [Option<f64>; 3],
    uncertainty: [Option<f64>; 2],
}

impl Header {
    fn line(
        &self,
        text: &str,
        machine: &Machine,
        nominal: &Transformation,
        decimals: &mut Decimals,
    ) -> Result<FoundLine, Diagnostic> {
        let mut cells = cells(text, self.separator);
        drop_empty(&mut cells, self.columns.len());
        cells.resize(self.columns.len().max(cells.len()), String::new());
        if cells.len() != self.columns.len() {
            return Err(refusal(format!("{} cells under {} titles", cells.len(), self.columns.len())));
        }
        let name = cells[self.axis].trim();
        let axis = machine.axis_index(name);
        let line = nominal.table.iter().chain(&nominal.head).find(|line| Some(line.axis) == axis);
        let line = line.ok_or_else(|| refusal(format!("the machine has no rotary axis `{}`", shown(name))))?;
        let mut row = Row::default();
        for (cell, column) in cells.iter().zip(&self.columns) {
            if let Some((column, factor)) = column.filter(|_| !cell.is_empty()) {
                *row.slot(column) = Some(value(cell, self.separator, decimals)? * factor);
            }
        }
        row.find(line, name, Vector3::from(machine.tool().gauge))
    }
}

fn value(cell: &str, separator: char, decimals: &mut Decimals) -> Result<f64, Diagnostic> {
    decimals.note(cell, separator).map_err(|mixed| refusal(mixed.to_string()))?;
    let value = number(cell, separator).map_err(|failure| refusal(failure.to_string()))?;
    if value.abs() > FARTHEST { Err(refusal(format!("`{}` is beyond 1000000", shown(cell)))) } else { Ok(value) }
}

impl Row {
    fn slot(&mut self, column: Column) -> &mut Option<f64> {
        match column {
            Column::Point(k) => &mut self.point[k],
            Column::Shift(k) => &mut self.shift[k],
            Column::Direction(k) => &mut self.direction[k],
            Column::PointUncertainty => &mut self.uncertainty[0],
            Column::AngleUncertainty => &mut self.uncertainty[1],
        }
    }

    fn find(&self, nominal: &RotaryLine, name: &str, gauge: Vector3<f64>) -> Result<FoundLine, Diagnostic> {
        let mut line = nominal.clone();
        for k in 0..3 {
            let stated = self.point[k].map(|x| x - gauge[k]);
            line.point[k] = stated.unwrap_or(nominal.point[k] + self.shift[k].unwrap_or_default());
        }
        if let [Some(i), Some(j), Some(k)] = self.direction {
            let direction = Vector3::new(i, j, k);
            if direction.norm() < 1e-3 {
                return Err(refusal(format!("the direction of `{name}` has no length")));
            }
            // A line has no sense: the opposite vector is of the same axis.
            line.direction = direction.normalize() * if direction.dot(&nominal.direction) < 0.0 { -1.0 } else { 1.0 };
        } else if self.direction.iter().any(Option::is_some) {
            return Err(refusal(format!("the direction of `{name}` needs i, j and k")));
        }
        refuse_far(&line, nominal, name)?;
        let stated = std::array::from_fn(|k| self.point[k].or(self.shift[k]).is_some());
        let directed = self.direction[0].is_some();
        if !directed && stated == [false; 3] {
            return Err(refusal(format!("nothing is stated of axis `{name}`")));
        }
        if self.uncertainty.iter().flatten().any(|u| *u < 0.0) {
            return Err(refusal(format!("an uncertainty of axis `{name}` is below 0")));
        }
        let [point_uncertainty, angle_uncertainty] = self.uncertainty;
        Ok(FoundLine { line, stated, directed, point_uncertainty, angle_uncertainty })
    }
}

/// Refuses a line that no location error explains.
fn refuse_far(line: &RotaryLine, nominal: &RotaryLine, name: &str) -> Result<(), Diagnostic> {
    let shift = line.point - nominal.point;
    let across = (shift - nominal.direction * nominal.direction.dot(&shift)).norm();
    if across > MAX_SHIFT {
        let message = format!("the point of `{name}` is {} mm from the nominal axis", significant(across, 4));
        let help = "coordinates are those of `origin` in the machine file, all axes at 0, in the unit of the title";
        return Err(Diagnostic::new(codes::E0519, message).help(help));
    }
    if line.direction.dot(&nominal.direction) < MIN_COSINE {
        return Err(refusal(format!("the direction of `{name}` is more than 5 deg off the nominal one")));
    }
    Ok(())
}
