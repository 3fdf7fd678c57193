//! Readings of tests as tables: a column for each quantity, named and with its unit in the title.

use super::circle::{RadialReading, Sense};
use super::positioning::TargetReading;
use crate::diagnostic::{Diagnostic, Place, codes, shown};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{Decimals, Sheet, SheetLine, cells, drop_empty, number, separator, title};
use crate::units::{self, Dimension};

const MAX_ROWS: usize = 1_000_000;
/// Largest number of diagonals: the body has four, its faces twelve.
const MAX_DIAGONALS: usize = 16;

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
    /// The line of titles.
    header: Place,
    columns: Vec<NumberColumn>,
    /// The sense of rotation of each row, if there is such a column.
    senses: Option<Vec<Sense>>,
    /// The diagonal of each row, if there is such a column.
    diagonals: Option<Vec<String>>,
}

/// The test whose columns a table has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableUse {
    /// Deviations on a circle.
    Circle,
    /// Readings of probes, and temperatures.
    Probes,
    /// Deviations along diagonals.
    Diagonals,
}

fn refusal(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0519, message.into())
}

const ANGLE: [&str; 4] = ["angle", "theta", "position", "c"];
const TIME: [&str; 2] = ["time", "t"];
const SENSE: [&str; 3] = ["sense", "direction", "rotation"];
const DIAGONAL: &str = "diagonal";
const WAY: [&str; 3] = ["way", "position", "target"];
const THERE: [&str; 3] = ["there", "forward", "up"];
const BACK: [&str; 3] = ["back", "reverse", "down"];
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
        let at = |line: &SheetLine, why: Diagnostic| why.at(Some(line.place.clone()), "");
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
        let diagonal = columns.iter().position(|column| column.name == DIAGONAL);
        let (mut senses, mut diagonals) = (Vec::new(), Vec::new());
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
                } else if Some(k) == diagonal {
                    diagonals.push(cell.clone());
                    Ok(())
                } else {
                    value(cell, separator, &mut decimals).map(|value| columns[k].values.push(value))
                };
                read.map_err(|why| at(line, why))?;
            }
        }
        let words = [sense, diagonal];
        let mut kept = 0..columns.len();
        columns.retain(|_| !words.contains(&kept.next()));
        let (senses, diagonals) = (sense.map(|_| senses), diagonal.map(|_| diagonals));
        Ok(Self { header: header.place.clone(), columns, senses, diagonals })
    }

    /// Returns the refusal of a test by this table, shown at its titles.
    pub fn refusal(&self, why: Diagnostic) -> Diagnostic {
        why.at(Some(self.header.clone()), "")
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

    /// Returns the deviations (mm) along each diagonal, in the order of the table.
    pub fn along_diagonals(&self) -> Result<Vec<(String, Vec<TargetReading>)>, Diagnostic> {
        let help = "columns are `diagonal` (ppp, npp ...), `way [mm]` along it, `there [um]` and `back [um]`, a row \
                    for each target and run";
        let missing = |what: &str| refusal(format!("there is no column of {what}")).help(help);
        let names = self.diagonals.as_ref().ok_or_else(|| missing("the names of diagonals"))?;
        let ways = self.column(&WAY).ok_or_else(|| missing("ways along the diagonals"))?;
        let ways = ways.whole(ways.factor(Dimension::LENGTH)?)?;
        let mut list: Vec<(String, Vec<TargetReading>)> = Vec::new();
        for (titles, direction) in [(THERE, ColumnDirection::Forward), (BACK, ColumnDirection::Reverse)] {
            let Some(column) = self.column(&titles) else { continue };
            let factor = column.factor(Dimension::LENGTH)?;
            for ((name, way), value) in names.iter().zip(&ways).zip(&column.values) {
                let Some(value) = value else { continue };
                let reading = TargetReading { position: *way, direction: Some(direction), value: value * factor };
                match list.iter().position(|(known, _)| known == name) {
                    Some(known) => list[known].1.push(reading),
                    None if list.len() < MAX_DIAGONALS => list.push((name.clone(), vec![reading])),
                    None => return Err(refusal(format!("more than {MAX_DIAGONALS} diagonals")).help(help)),
                }
            }
        }
        if list.is_empty() { Err(missing("readings")) } else { Ok(list) }
    }

    /// Returns the names of the columns that are neither the angle or time nor readings: of a circle and of diagonals
    /// those of their deviations, else lengths and temperatures.
    pub fn unused_columns(&self, of: TableUse) -> Vec<&str> {
        let circle = ["deviation", "length", "radius"].iter().chain(&COUNTER_CLOCKWISE).chain(&CLOCKWISE);
        let circle: Vec<&str> = circle.copied().collect();
        let used = |column: &&NumberColumn| {
            let name = column.name.as_str();
            let reading = column.factor(Dimension::LENGTH).is_ok() || column.is_temperature();
            let is_one_of = |lists: &[[&str; 3]]| lists.iter().any(|list| list.contains(&name));
            match of {
                TableUse::Circle => ANGLE.contains(&name) || circle.contains(&name),
                TableUse::Probes => ANGLE.contains(&name) || TIME.contains(&name) || reading,
                TableUse::Diagonals => is_one_of(&[WAY, THERE, BACK]),
            }
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
