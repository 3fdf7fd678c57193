//! The header of a file of measurements: which column holds what.

use crate::diagnostic::{did_you_mean, shown};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, AxisKind, Machine, parse_error_name};
use crate::syntax::sheet;
use crate::units::{self, Dimension};

/// What a column holds; numbers are factors to mm, deg or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Column {
    /// Position of the axis with this index.
    Axis(usize, f64),
    /// Position of the axis at the other end of a length: `to.X`.
    To(usize, f64),
    /// Component of the deviation: `dx`.
    Deviation(usize, f64),
    /// The same, less what the first reading of the run was: `rel.dx`.
    Relative(usize, f64),
    /// A ball that the functional point was brought to: `ball`.
    Ball,
    /// A whole distance: `length`.
    Length(f64),
    /// Distance minus nominal distance: `dl`.
    LengthError(f64),
    /// Distance less a constant that nobody knows: `displacement`.
    Displacement(f64),
    /// Deviation along the line of the run: `along`.
    Along(f64),
    /// A component error, measured in this direction.
    Error(Source, Option<Approach>, f64),
    Station,
    /// Where a station is about, workpiece frame: `station.x`.
    StationAt(usize, f64),
    Tool,
    /// How many rows this one counts for.
    Weight,
    /// Standard uncertainty of readings of this quantity.
    Uncertainty(Quantity, f64),
    Run,
    Approach,
}

/// Lengths, or angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Length,
    Angle,
}

/// What the rows of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Deviation,
    Relative,
    Ball,
    Distance,
    Along,
    Error,
}

impl Column {
    /// The kind of rows that this column makes.
    fn form(self) -> Option<Form> {
        match self {
            Self::Deviation(..) => Some(Form::Deviation),
            Self::Relative(..) => Some(Form::Relative),
            Self::Ball => Some(Form::Ball),
            Self::Length(_) | Self::LengthError(_) | Self::Displacement(_) => Some(Form::Distance),
            Self::Along(_) => Some(Form::Along),
            Self::Error(..) => Some(Form::Error),
            _ => None,
        }
    }

    /// Do both say the same thing?
    fn same(self, other: Self) -> bool {
        let bare = |column: Self| match column {
            Self::Axis(i, _) => Self::Axis(i, 1.0),
            Self::To(i, _) => Self::To(i, 1.0),
            Self::Deviation(i, _) => Self::Deviation(i, 1.0),
            Self::Relative(i, _) => Self::Relative(i, 1.0),
            Self::StationAt(i, _) => Self::StationAt(i, 1.0),
            Self::Error(source, approach, _) => Self::Error(source, approach, 1.0),
            Self::Length(_) | Self::LengthError(_) | Self::Displacement(_) => Self::Length(1.0),
            Self::Along(_) => Self::Along(1.0),
            Self::Uncertainty(quantity, _) => Self::Uncertainty(quantity, 1.0),
            other => other,
        };
        bare(self) == bare(other)
    }
}

const WORDS: [&str; 22] = [
    "dx",
    "dy",
    "dz",
    "rel.dx",
    "rel.dy",
    "rel.dz",
    "ball",
    "length",
    "dl",
    "displacement",
    "along",
    "station",
    "station.x",
    "station.y",
    "station.z",
    "tool",
    "weight",
    "u",
    "run",
    "approach",
    "EXX",
    "to.X",
];

/// The columns of a header and what its rows are.
pub fn columns(machine: &Machine, header: &str, separator: char) -> Result<(Vec<Column>, Form), String> {
    let mut columns: Vec<Column> = Vec::new();
    let mut cells = sheet::cells(header, separator);
    sheet::drop_empty(&mut cells, 0);
    for cell in cells {
        let column = column(machine, &cell)?;
        if columns.iter().any(|known| known.same(column)) {
            return Err(format!("the column `{}` occurs twice, or two columns say the same", shown(&cell)));
        }
        columns.push(column);
    }
    let mut forms = columns.iter().filter_map(|column| column.form());
    let Some(form) = forms.next() else { return Err("there is no column of readings".to_owned()) };
    if forms.any(|other| other != form) {
        return Err("the header mixes kinds of readings: give every kind a file of its own".to_owned());
    }
    belongs(&columns, form)?;
    weighed(&columns, form)?;
    positions(machine, &columns)?;
    Ok((columns, form))
}

/// A component error is nothing without the position of its own axis.
fn positions(machine: &Machine, columns: &[Column]) -> Result<(), String> {
    for column in columns {
        let Column::Error(Source { place: ErrorSite::Component(axis), .. }, ..) = *column else { continue };
        if !columns.iter().any(|known| matches!(known, Column::Axis(known, _) if *known == axis)) {
            let axis = &machine.axes()[axis].name;
            return Err(format!("errors of `{axis}` are read at positions of `{axis}`: there is no column `{axis}`"));
        }
    }
    Ok(())
}

/// A weight or uncertainties, and then of every quantity that is read.
fn weighed(columns: &[Column], form: Form) -> Result<(), String> {
    let angle = |c: &Column| matches!(c, Column::Error(source, ..) if source.direction.is_rotation());
    let length = |c: &Column| form != Form::Error || (matches!(c, Column::Error(..)) && !angle(c));
    let given = |wanted| columns.iter().any(|c| matches!(c, Column::Uncertainty(quantity, _) if *quantity == wanted));
    let (lengths, angles) = (given(Quantity::Length), given(Quantity::Angle));
    if !(lengths || angles) {
        return Ok(());
    }
    if columns.contains(&Column::Weight) {
        return Err("`weight` and `u` say the same: leave one out".to_owned());
    }
    match (columns.iter().any(length), columns.iter().any(angle)) {
        read if read == (lengths, angles) => Ok(()),
        (true, true) => Err("lengths and angles are read: give `u [um]` and `u [urad]`, or neither".to_owned()),
        (true, false) => Err("lengths are read: give `u [um]`".to_owned()),
        _ => Err("angles are read: give `u [urad]`".to_owned()),
    }
}

/// Columns that make sense with this kind of rows only.
fn belongs(columns: &[Column], form: Form) -> Result<(), String> {
    let station = columns.iter().any(|c| matches!(c, Column::Station | Column::StationAt(..)));
    let places = columns.iter().filter(|c| matches!(c, Column::StationAt(..))).count();
    let to = columns.iter().any(|c| matches!(c, Column::To(..)));
    if form != Form::Distance && (station || to) {
        return Err("`station` and `to.` columns belong to a length".to_owned());
    }
    if form == Form::Distance && station == to {
        let words =
            "a length needs its other end: a column `station`, or `to.` columns with the positions of a second pose";
        return Err(if to { format!("{words}, not both") } else { words.to_owned() });
    }
    if ![0, 3].contains(&places) {
        return Err("give all of `station.x`, `station.y` and `station.z`, or none".to_owned());
    }
    if station && places == 0 && columns.iter().any(|c| matches!(c, Column::LengthError(_))) {
        return Err(
            "`dl` is the difference from the nominal distance: say with `station.x [mm]` ... from where".to_owned()
        );
    }
    let approach = columns.iter().any(|c| matches!(c, Column::Approach));
    if approach && columns.iter().any(|c| matches!(c, Column::Error(_, Some(_), _))) {
        return Err("the direction stands in `approach` and in the name of an error: leave one out".to_owned());
    }
    Ok(())
}

fn column(machine: &Machine, cell: &str) -> Result<Column, String> {
    // An axis may be called as it likes.
    let (name, unit) = if machine.axis_index(cell).is_some() { (cell.to_owned(), None) } else { sheet::title(cell) };
    let (name, unit) = (name.as_str(), unit.as_deref());
    let position = |axis| unit.map_or(Ok(1.0), |unit| position_factor(machine, axis, unit));
    if let Some(axis) = machine.axis_index(name) {
        return Ok(Column::Axis(axis, position(axis)?));
    }
    if let Some(axis) = name.strip_prefix("to.").and_then(|name| machine.axis_index(name)) {
        return Ok(Column::To(axis, position(axis)?));
    }
    let length = || length_factor(name, unit);
    let component = |stem: &str, names: [&str; 3]| {
        name.strip_prefix(stem).and_then(|rest| names.iter().position(|known| *known == rest))
    };
    if let Some(k) = component("", ["dx", "dy", "dz"]) {
        return Ok(Column::Deviation(k, length()?));
    }
    if let Some(k) = component("rel.", ["dx", "dy", "dz"]) {
        return Ok(Column::Relative(k, length()?));
    }
    if let Some(k) = component("station.", ["x", "y", "z"]) {
        return Ok(Column::StationAt(k, length()?));
    }
    match name {
        "length" => Ok(Column::Length(length()?)),
        "dl" => Ok(Column::LengthError(length()?)),
        "displacement" => Ok(Column::Displacement(length()?)),
        "along" => Ok(Column::Along(length()?)),
        "u" => uncertainty(name, unit),
        "ball" => Ok(Column::Ball),
        "station" => Ok(Column::Station),
        "tool" => Ok(Column::Tool),
        "weight" => Ok(Column::Weight),
        "run" => Ok(Column::Run),
        "approach" => Ok(Column::Approach),
        _ => error(machine, name, unit),
    }
}

/// `EXX [um]`, `EXX+ [um]`, `EXX reverse [um]`.
fn error(machine: &Machine, name: &str, unit: Option<&str>) -> Result<Column, String> {
    let (bare, approach) = crate::identify::model::request::directed(name);
    let found = parse_error_name(bare).filter(|error| !error.is_location());
    let axis = found.as_ref().and_then(|error| machine.axis_index(error.axis.as_str()));
    let Some((error, axis)) = found.zip(axis) else {
        let axes = machine.axes().iter().map(|axis| axis.name.as_str());
        let known: Vec<&str> = axes.chain(WORDS).collect();
        return Err(format!("nobody here knows the column `{}`; {}", shown(name), did_you_mean(name, &known)));
    };
    let wanted = if error.direction.is_rotation() { Dimension::ANGLE } else { Dimension::LENGTH };
    let unit = unit.ok_or_else(|| format!("column `{name}` has no unit: write `{name} [um]` or `[urad]`"))?;
    match units::unit(unit) {
        Ok((factor, dimension))
            if dimension == wanted || (dimension == Dimension::RATIO && wanted == Dimension::ANGLE) =>
        {
            Ok(Column::Error(
                Source { place: ErrorSite::Component(axis), direction: error.direction },
                approach,
                factor,
            ))
        }
        _ => Err(format!("`{}` is not a unit of `{error}`", shown(unit))),
    }
}

/// `u [um]` or `u [urad]`.
fn uncertainty(name: &str, unit: Option<&str>) -> Result<Column, String> {
    match unit.map(units::unit) {
        Some(Ok((factor, Dimension::ANGLE))) => Ok(Column::Uncertainty(Quantity::Angle, factor)),
        _ => Ok(Column::Uncertainty(Quantity::Length, length_factor(name, unit)?)),
    }
}

fn length_factor(name: &str, unit: Option<&str>) -> Result<f64, String> {
    let unit = unit.ok_or_else(|| format!("column `{name}` has no unit: write `{name} [um]` or `[mm]`"))?;
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) => Ok(factor),
        _ => Err(format!("`{}` is not a unit of length for `{name}`", shown(unit))),
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
