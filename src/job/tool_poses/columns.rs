//! Tool poses as CSV: names of columns in any case, any separator, units in the header, decimal commas.

use super::{Aim, MAX_TOOL_POSES, Row, wrong};
use crate::diagnostic::{Diagnostic, shown};
use crate::lower::into_part;
use crate::machine::{AxisKind, Machine};
use crate::syntax::sheet::{Decimals, Sheet, SheetLine, cells, drop_empty, number, separator, title};
use crate::units::{self, Dimension};
use nalgebra::Vector3;

const FEATURE: [&str; 4] = ["FEATURE", "LABEL", "OPERATION", "NAME"];

/// Content of a column, with the factor to mm or deg.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Tip(usize, f64),
    Axis(usize),
    Rotary(usize, f64),
    /// Turn of the tool about its axis, with the factor to deg.
    Spin(f64),
    /// A letter of the normal of the surface.
    Normal(usize),
    Feature,
}

impl Column {
    fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Tip(i, _), Self::Tip(k, _)) | (Self::Axis(i), Self::Axis(k)) => i == k,
            (Self::Normal(i), Self::Normal(k)) => i == k,
            (Self::Rotary(i, _), Self::Rotary(k, _)) => i == k,
            (Self::Feature, Self::Feature) | (Self::Spin(_), Self::Spin(_)) => true,
            _ => false,
        }
    }
}

/// Returns the rows of a table; rotary columns are those of `machine`.
pub(super) fn rows(machine: &Machine, sheet: &Sheet) -> Result<Vec<Row>, Diagnostic> {
    let help = "columns are X, Y, Z (mm, from the workpiece origin), I, J, K of the tool axis or positions of rotary \
                axes (deg), spin (deg), NX, NY, NZ of the normal of the surface, and feature; another unit stands in \
                brackets: `X [cm]`";
    let lines = sheet.lines();
    let [header, data @ ..] = lines.as_slice() else {
        return Err(wrong("the file has no header").at(Some(sheet.start()), "").help(help));
    };
    let separator = separator(&header.text);
    let at = |line: &SheetLine, refusal: Diagnostic| refusal.at(Some(line.place.clone()), "").help(help);
    let columns = columns(machine, &cells(&header.text, separator)).map_err(|refusal| at(header, refusal))?;
    if data.len() > MAX_TOOL_POSES {
        return Err(at(&data[MAX_TOOL_POSES], wrong(format!("more than {MAX_TOOL_POSES} tool poses"))));
    }
    let mut table = Table { machine, columns, separator, decimals: Decimals::default() };
    let row = |line: &SheetLine| table.row(line).map_err(|refusal| at(line, refusal));
    let rows = data.iter().map(row).collect::<Result<Vec<_>, _>>()?;
    if rows.is_empty() { Err(at(header, wrong("the file has no tool poses"))) } else { Ok(rows) }
}

fn columns(machine: &Machine, header: &[String]) -> Result<Vec<Column>, Diagnostic> {
    let mut header = header.to_vec();
    drop_empty(&mut header, 1);
    let columns: Vec<Column> = header.iter().map(|cell| column(machine, cell)).collect::<Result<_, _>>()?;
    if let Some(i) = (0..columns.len()).find(|i| columns[..*i].iter().any(|other| other.same(&columns[*i]))) {
        return Err(wrong(format!("column `{}` is there twice", shown(&header[i]))));
    }
    let count = |kind: fn(&Column) -> bool| columns.iter().filter(|column| kind(column)).count();
    if count(|c| matches!(c, Column::Tip(..))) != 3 {
        return Err(wrong("the columns X, Y and Z are needed: the functional point in the workpiece frame"));
    }
    if let 1 | 2 = count(|c| matches!(c, Column::Normal(_))) {
        return Err(wrong("of NX, NY and NZ all are needed, or none"));
    }
    match (count(|c| matches!(c, Column::Axis(_))), count(|c| matches!(c, Column::Rotary(..)))) {
        (1 | 2, _) => Err(wrong("of I, J and K all are needed, or none")),
        (3, 1..) => Err(wrong("the tool axis is given twice: by I, J, K and by rotary axes")),
        _ => Ok(columns),
    }
}

fn column(machine: &Machine, cell: &str) -> Result<Column, Diagnostic> {
    let (name, unit) = title(cell);
    let (name, unit) = (name.to_uppercase(), unit.as_deref());
    if let Some(i) = ["X", "Y", "Z"].iter().position(|letter| *letter == name) {
        return Ok(Column::Tip(i, factor(&name, unit, Dimension::LENGTH)?));
    }
    if let (Some(i), None) = (["I", "J", "K"].iter().position(|letter| *letter == name), unit) {
        return Ok(Column::Axis(i));
    }
    if let (Some(i), None) = (["NX", "NY", "NZ"].iter().position(|letter| *letter == name), unit) {
        return Ok(Column::Normal(i));
    }
    if name == "SPIN" {
        return Ok(Column::Spin(factor(&name, unit, Dimension::ANGLE)?));
    }
    if let (true, None) = (FEATURE.contains(&name.as_str()), unit) {
        return Ok(Column::Feature);
    }
    let rotary = |i: &usize| machine.axes()[*i].kind == AxisKind::Rotary;
    match machine.axis_index(&name).filter(rotary) {
        Some(i) => Ok(Column::Rotary(i, factor(&name, unit, Dimension::ANGLE)?)),
        None => {
            let rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary);
            let names: Vec<&str> = rotary.map(|axis| axis.name.as_str()).collect();
            let known = if names.is_empty() { "there is none".to_owned() } else { names.join(", ") };
            let message = format!(
                "column `{}` is neither X, Y, Z nor I, J, K, spin, NX, NY, NZ, feature nor a rotary axis ({known})",
                shown(cell)
            );
            Err(wrong(message))
        }
    }
}

/// Returns the factor of a unit to mm or deg, 1 without a unit.
fn factor(name: &str, unit: Option<&str>, dimension: Dimension) -> Result<f64, Diagnostic> {
    let Some(unit) = unit else { return Ok(1.0) };
    if dimension == Dimension::ANGLE && ["deg", "°"].contains(&unit.to_lowercase().as_str()) {
        return Ok(1.0);
    }
    let known = units::unit(unit).or_else(|failure| units::unit(&unit.to_lowercase()).map_err(|_| failure));
    let (factor, of) = known.map_err(|failure| wrong(failure.to_string()))?;
    if of != dimension {
        return Err(wrong(format!("`{unit}` is {}, not a unit for `{name}`", of.word())));
    }
    Ok(if dimension == Dimension::ANGLE { factor.to_degrees() } else { factor })
}

/// A table while its rows are read.
struct Table<'a> {
    machine: &'a Machine,
    columns: Vec<Column>,
    separator: char,
    decimals: Decimals,
}

impl Table<'_> {
    fn row(&mut self, line: &SheetLine) -> Result<Row, Diagnostic> {
        let mut cells = cells(&line.text, self.separator);
        drop_empty(&mut cells, self.columns.len());
        if cells.len() != self.columns.len() {
            return Err(wrong(format!("{} cells under {} columns", cells.len(), self.columns.len())));
        }
        let (mut tip, mut axis, mut pose) = (Vector3::zeros(), Vector3::zeros(), vec![0.0; self.machine.axes().len()]);
        let (mut feature, mut spin_rad, mut normal) = (None, None, Vector3::zeros());
        for (cell, column) in cells.iter().zip(&self.columns) {
            if *column == Column::Feature {
                feature = Some(cell.clone());
                continue;
            }
            self.decimals.note(cell, self.separator).map_err(|mixed| wrong(mixed.to_string()))?;
            let number = number(cell, self.separator).map_err(|failure| wrong(failure.to_string()))?;
            match *column {
                Column::Tip(i, factor) => tip[i] = number * factor,
                Column::Axis(i) => axis[i] = number,
                Column::Normal(i) => normal[i] = number,
                Column::Rotary(i, factor) => pose[i] = number * factor,
                Column::Spin(factor) => spin_rad = Some((number * factor).to_radians()),
                Column::Feature => {}
            }
        }
        if tip.iter().chain(&pose).any(|x| x.abs() > units::FARTHEST) {
            return Err(wrong("a position is beyond 1000000 mm or deg: no machine goes there"));
        }
        let holds = |kind: fn(&Column) -> bool| self.columns.iter().any(kind);
        let aim = match (holds(|c| matches!(c, Column::Rotary(..))), holds(|c| matches!(c, Column::Axis(_)))) {
            (true, _) => Aim::Rotary(pose),
            (_, true) => Aim::Axis(unit_vector(&axis, "the tool axis I, J, K")?),
            _ => Aim::Axis(into_part(self.machine, Vector3::from(self.machine.tool().direction))),
        };
        let normal = holds(|c| matches!(c, Column::Normal(_))).then(|| unit_vector(&normal, "the normal NX, NY, NZ"));
        let normal = normal.transpose()?;
        Ok(Row { place: line.place.clone(), line: line.number, tip, aim, spin_rad, feature, normal })
    }
}

/// Returns the direction of a vector of any length but 0.
pub(crate) fn unit_vector(axis: &Vector3<f64>, what: &str) -> Result<Vector3<f64>, Diagnostic> {
    // Scaled first: the square of a large or small number is not one.
    let largest = axis.amax();
    let scaled = if largest > 0.0 && largest.is_finite() { axis / largest } else { Vector3::zeros() };
    scaled.try_normalize(0.0).ok_or_else(|| wrong(format!("{what} has no direction: it is zero")))
}
