//! Readings of tests as tables: a column for each quantity, named and with its unit in the title.

use super::circle::{RadialReading, Sense};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::syntax::sheet::{Decimals, Line, Sheet, cells, drop_empty, number, separator, title};
use crate::units::{self, Dimension};

/// Largest number of rows.
const MAX_ROWS: usize = 1_000_000;

/// A column of numbers.
#[derive(Debug, Clone, PartialEq)]
struct NumberColumn {
    /// Its name, in lower case.
    name: String,
    /// Its unit as it is written.
    unit: Option<String>,
    /// The numbers as they are written; `None` of empty cells.
    values: Vec<Option<f64>>,
}

/// A table of readings.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingsTable {
    /// Columns of numbers.
    columns: Vec<NumberColumn>,
    /// The sense of rotation of each row, if there is such a column.
    senses: Option<Vec<Sense>>,
}

fn refusal(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0519, message.into())
}

const ANGLE: [&str; 4] = ["angle", "theta", "position", "c"];
const TIME: [&str; 2] = ["time", "t"];
const SENSE: [&str; 3] = ["sense", "direction", "rotation"];
const COUNTER_CLOCKWISE: [&str; 5] = ["ccw", "counter-clockwise", "counterclockwise", "+", "g3"];
const CLOCKWISE: [&str; 4] = ["cw", "clockwise", "-", "g2"];
const MINUTES: [(&str, f64); 3] = [("s", 1.0 / 60.0), ("min", 1.0), ("h", 60.0)];

impl ReadingsTable {
    /// Reads a table.
    pub fn of(sheet: &Sheet) -> Result<Self, Diagnostic> {
        let lines = sheet.lines();
        let [header, rows @ ..] = lines.as_slice() else {
            return Err(refusal("the file is empty").at(Some(sheet.start()), ""));
        };
        let at = |line: &Line, why: Diagnostic| why.at(Some(line.place.clone()), "");
        let separator = separator(&header.text);
        let mut titles = cells(&header.text, separator);
        drop_empty(&mut titles, 1);
        if rows.len() > MAX_ROWS {
            return Err(at(&rows[MAX_ROWS], refusal(format!("more than {MAX_ROWS} rows"))));
        }
        let columns = titles.iter().map(|cell| {
            let (name, unit) = title(cell);
            NumberColumn { name: name.to_lowercase(), unit, values: Vec::new() }
        });
        let mut columns: Vec<NumberColumn> = columns.collect();
        if let Some(twice) = (1..columns.len()).find(|i| columns[..*i].iter().any(|c| c.name == columns[*i].name)) {
            return Err(at(header, refusal(format!("column `{}` is there twice", shown(&titles[twice])))));
        }
        let sense = columns.iter().position(|column| SENSE.contains(&column.name.as_str()));
        let mut senses = Vec::new();
        let mut decimals = Decimals::default();
        for line in rows {
            let mut row = cells(&line.text, separator);
            drop_empty(&mut row, columns.len());
            row.resize(columns.len().max(row.len()), String::new());
            if row.len() != columns.len() {
                return Err(at(line, refusal(format!("{} cells under {} columns", row.len(), columns.len()))));
            }
            for (k, cell) in row.iter().enumerate() {
                let read = if Some(k) == sense {
                    sense_of(cell).map(|sense| senses.push(sense))
                } else {
                    value(cell, separator, &mut decimals).map(|value| columns[k].values.push(value))
                };
                read.map_err(|why| at(line, why))?;
            }
        }
        let senses = sense.map(|k| {
            let _ = columns.remove(k);
            senses
        });
        Ok(Self { columns, senses })
    }

    fn column(&self, names: &[&str]) -> Option<&NumberColumn> {
        self.columns.iter().find(|column| names.contains(&column.name.as_str()))
    }

    /// Returns the angles (deg) of all rows.
    pub fn angles(&self) -> Result<Vec<f64>, Diagnostic> {
        let help = "a column `angle [deg]` is needed";
        let column = self.column(&ANGLE).ok_or_else(|| refusal("there is no column of angles").help(help))?;
        let is_bare = column.unit.as_deref().is_none_or(|unit| ["deg", "\u{b0}"].contains(&unit));
        let factor = if is_bare { 1.0 } else { column.factor(Dimension::ANGLE)?.to_degrees() };
        column.whole(factor)
    }

    /// Returns the times (minutes) of all rows, rising.
    pub fn times(&self) -> Result<Vec<f64>, Diagnostic> {
        let help = "a column `time [min]` is needed; other units are s and h";
        let column = self.column(&TIME).ok_or_else(|| refusal("there is no column of times").help(help))?;
        let unit = MINUTES.iter().find(|(unit, _)| column.unit.as_deref() == Some(unit));
        let (_, factor) = unit.ok_or_else(|| refusal("the times have no unit").help(help))?;
        let times = column.whole(*factor)?;
        match times.windows(2).position(|pair| pair[1] < pair[0]) {
            Some(row) => Err(refusal(format!("the time of row {} is before that of the row above", row + 2))),
            None => Ok(times),
        }
    }

    /// Returns the readings of a circle of a nominal radius (mm).
    pub fn circle(&self, radius: f64) -> Result<Vec<RadialReading>, Diagnostic> {
        let angles = self.angles()?;
        let both = [self.column(&COUNTER_CLOCKWISE[..3]), self.column(&CLOCKWISE[..2])];
        let mut readings = Vec::new();
        if both.iter().any(Option::is_some) {
            for (column, sense) in both.into_iter().zip(Sense::ALL).filter_map(|(c, sense)| Some((c?, sense))) {
                let values = column.values.iter().zip(&angles).filter_map(|(value, angle)| Some((*angle, (*value)?)));
                let factor = column.factor(Dimension::LENGTH)? * 1e3;
                readings.extend(values.map(|(angle, x)| RadialReading { angle, sense, deviation: x * factor }));
            }
            return Ok(readings);
        }
        let help = "columns are `angle [deg]` with `ccw [um]` and `cw [um]`, or with `deviation [um]` or `length [mm]` \
                    and `sense` (ccw, cw)";
        let deviation = self.column(&["deviation"]).map(|column| (column, 0.0));
        let length = self.column(&["length", "radius"]).map(|column| (column, radius));
        let Some((column, nominal)) = deviation.or(length) else {
            return Err(refusal("there is no column of readings").help(help));
        };
        let Some(senses) = &self.senses else {
            return Err(refusal("nothing says the sense of rotation").help(help));
        };
        let values = column.whole(column.factor(Dimension::LENGTH)?)?;
        let rows = angles.into_iter().zip(senses).zip(values);
        Ok(rows
            .map(|((angle, sense), x)| RadialReading { angle, sense: *sense, deviation: (x - nominal) * 1e3 })
            .collect())
    }

    /// Returns the names of the columns that are neither the angle or time nor readings: of a circle those of its
    /// deviations, else lengths and temperatures.
    pub fn unused(&self, is_circle: bool) -> Vec<&str> {
        let circle = ["deviation", "length", "radius"].iter().chain(&COUNTER_CLOCKWISE).chain(&CLOCKWISE);
        let circle: Vec<&str> = circle.copied().collect();
        let used = |column: &&NumberColumn| {
            let name = column.name.as_str();
            let reading = column.factor(Dimension::LENGTH).is_ok() || column.is_temperature();
            let of_test = if is_circle { circle.contains(&name) } else { TIME.contains(&name) || reading };
            ANGLE.contains(&name) || of_test
        };
        self.columns.iter().filter(|column| !used(column)).map(|column| column.name.as_str()).collect()
    }

    /// Returns the columns that are lengths, with their names, in um.
    pub fn probes(&self) -> Result<Vec<(String, Vec<f64>)>, Diagnostic> {
        let probes = self.columns.iter().filter(|column| {
            let name = column.name.as_str();
            !ANGLE.contains(&name) && !TIME.contains(&name) && column.factor(Dimension::LENGTH).is_ok()
        });
        let read = |column: &NumberColumn| {
            let values = column.whole(column.factor(Dimension::LENGTH)? * 1e3)?;
            Ok((column.name.clone(), values))
        };
        probes.map(read).collect()
    }

    /// Returns the columns of temperatures (deg C), with their names.
    pub fn temperatures(&self) -> Result<Vec<(String, Vec<f64>)>, Diagnostic> {
        let warm = self.columns.iter().filter(|column| column.is_temperature());
        warm.map(|column| Ok((column.name.clone(), column.whole(1.0)?))).collect()
    }
}

fn sense_of(cell: &str) -> Result<Sense, Diagnostic> {
    let word = cell.to_lowercase();
    if COUNTER_CLOCKWISE.contains(&word.as_str()) {
        return Ok(Sense::CounterClockwise);
    }
    let clockwise = CLOCKWISE.contains(&word.as_str());
    clockwise
        .then_some(Sense::Clockwise)
        .ok_or_else(|| refusal(format!("`{}` is no sense: write ccw or cw", shown(cell))))
}

fn value(cell: &str, separator: char, decimals: &mut Decimals) -> Result<Option<f64>, Diagnostic> {
    if cell.is_empty() {
        return Ok(None);
    }
    decimals.note(cell, separator).map_err(|mixed| refusal(mixed.to_string()))?;
    let value = number(cell, separator).map_err(|failure| refusal(failure.to_string()))?;
    if value.abs() > units::FARTHEST {
        Err(refusal(format!("`{}` is beyond 1000000", shown(cell))))
    } else {
        Ok(Some(value))
    }
}

impl NumberColumn {
    fn is_temperature(&self) -> bool {
        self.unit.as_deref().is_some_and(|unit| ["degc", "\u{b0}c"].contains(&unit.to_lowercase().as_str()))
    }

    /// The factor of its unit to mm or rad.
    fn factor(&self, dimension: Dimension) -> Result<f64, Diagnostic> {
        let Some(unit) = &self.unit else {
            let help = format!("write it in the title: `{} [um]`", self.name);
            return Err(refusal(format!("the column `{}` has no unit", shown(&self.name))).help(help));
        };
        let found = units::unit(unit).map_err(|failure| refusal(failure.to_string()))?;
        let (factor, of) = found;
        let wrong = || refusal(format!("`{}` is {}, not a unit for `{}`", shown(unit), of.word(), shown(&self.name)));
        (of == dimension).then_some(factor).ok_or_else(wrong)
    }

    /// All values times a factor; refuses empty cells.
    fn whole(&self, factor: f64) -> Result<Vec<f64>, Diagnostic> {
        let all: Option<Vec<f64>> = self.values.iter().map(|value| value.map(|x| x * factor)).collect();
        all.ok_or_else(|| refusal(format!("the column `{}` has empty cells", shown(&self.name))))
    }
}
