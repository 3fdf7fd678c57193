//! `record.yaml`: what the engineer states of a calibration, and the files that belong to it.

use super::{Contact, Dates, Instrument, Line, Person, Place, Plate, Statements, Temperature, TwoLetters};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::run::{Call, Refused};
use crate::syntax::{from_yaml, read_text};
use serde::Deserialize;
use std::path::Path;

/// Maximum number of entries of a list.
const MOST: usize = 500;
/// Temperatures of machines and the air about them.
const PLAUSIBLE_DEG_C: std::ops::RangeInclusive<f64> = -40.0..=120.0;
/// Largest expanded uncertainty of a thermometer.
const MAX_KELVIN: f64 = 20.0;
/// Temperatures of a room, 15 to 35 degC, in degF.
const WARM_DEG_F: std::ops::RangeInclusive<f64> = 59.0..=95.0;

/// A description of a calibration. Paths are relative to the description.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// Version of the language: 1.
    record: u32,
    /// Unique name of the record.
    pub id: Line,
    pub dates: Dates,
    #[serde(default = "TwoLetters::english")]
    pub language: TwoLetters,
    pub country: TwoLetters,
    pub place: Place,
    pub laboratory: Contact,
    pub customer: Contact,
    pub persons: Vec<Person>,
    pub machine: Plate,
    /// The machine file as found.
    pub as_found: Line,
    /// The machine file as left; the machine was left as found without it.
    pub as_left: Option<Line>,
    pub instruments: Vec<Instrument>,
    #[serde(default)]
    pub temperatures: Vec<Temperature>,
    #[serde(default)]
    pub standards: Vec<Line>,
    /// Files of raw data.
    pub data: Vec<Line>,
    /// JSON documents of other verbs.
    #[serde(default)]
    pub figures: Vec<Line>,
    #[serde(default)]
    pub limits: Vec<LimitEntry>,
    #[serde(default)]
    pub sets: Vec<SetEntry>,
    #[serde(default)]
    pub remarks: Vec<Line>,
    #[serde(default)]
    pub statements: Statements,
}

/// A limit: of an error, or of a number in a file of figures.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LimitEntry {
    /// Name of the error.
    pub error: Option<Line>,
    /// Name of the figure.
    pub name: Option<Line>,
    /// The file of figures in which the value stands.
    pub figures: Option<Line>,
    /// JSON pointer to the value.
    pub value: Option<Line>,
    /// JSON pointer to its expanded uncertainty.
    pub uncertainty: Option<Line>,
    /// Unit of the value in the file.
    pub unit: Option<Line>,
    /// The limit, with its unit.
    pub limit: Line,
    /// Limit of an error at which a trend raises an alarm, with its unit.
    pub alarm: Option<Line>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SetEntry {
    /// The folder.
    pub folder: Line,
    /// True for a set that was replaced.
    #[serde(default)]
    pub replaced: bool,
    /// The state of the machine by which the set is verified.
    #[serde(default)]
    pub verify_with: StateName,
    /// The folder of the set that was in force when the machine was measured.
    pub installed: Option<Line>,
    /// The JSON document of `compile`.
    pub compile: Option<Line>,
    /// Readings of the machine that was driven with the set.
    pub second: Option<SecondEntry>,
}

/// A second measurement, as `verify` takes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SecondEntry {
    /// Files of measurements.
    pub data: Vec<Line>,
    pub axis_poses: Option<Line>,
    /// Standard uncertainties that all readings share.
    #[serde(default)]
    pub type_b: Vec<Line>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StateName {
    /// As found: the machine from which the set was compiled.
    #[default]
    Found,
    /// As left.
    Left,
}

impl StateName {
    pub fn word(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::Left => "left",
        }
    }
}

pub(crate) fn unfit(message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0820, message).help(help)
}

impl Description {
    /// Reads a description.
    pub fn read(call: &mut Call, path: &Path) -> Result<Self, Refused> {
        let text = read_text(path, None, call.run.files, &mut call.diagnostics);
        call.check()?;
        let (_, text) = text.ok_or(Refused)?;
        let name = shown(&path.display().to_string());
        let description: Self = match from_yaml(&text) {
            Ok(description) => description,
            Err(fault) => {
                let line = fault.line.map_or_else(String::new, |line| format!(":{line}"));
                let help = "`abbe explain E0820` has a whole description; docs/record.md lists the keys";
                return call.refuse(unfit(format!("{name}{line}: {}", shown(&fault.message)), help));
            }
        };
        let faults = description.faults();
        call.extend(faults.into_iter().map(|(message, help)| unfit(format!("{name}: {message}"), help)));
        call.check()?;
        Ok(description)
    }

    fn faults(&self) -> Vec<(String, &'static str)> {
        let mut faults = Vec::new();
        let mut fault = |wrong: bool, message: String, help: &'static str| {
            if wrong {
                faults.push((message, help));
            }
        };
        fault(
            self.record != 1,
            format!("`record: {}` is no version of the language", self.record),
            "write `record: 1`",
        );
        let reversed = self.dates.end < self.dates.begin;
        fault(reversed, "the last day is before the first".to_owned(), "exchange `begin` and `end`");
        let early = self.dates.issued.as_ref().filter(|issued| **issued < self.dates.end);
        let message = early.map(|issued| format!("`issued` {} is before the last day", issued.as_str()));
        fault(early.is_some(), message.unwrap_or_default(), "a certificate is issued after the calibration");
        fault(!self.country.is_country(), "`country` is in small letters".to_owned(), "ISO 3166-1: DE, US, CN");
        fault(self.language.is_country(), "`language` is in capital letters".to_owned(), "ISO 639-1: de, en, zh");
        let contacts = [&self.laboratory.country, &self.customer.country];
        let small = contacts.into_iter().flatten().any(|country| !country.is_country());
        fault(small, "the country of a contact is in small letters".to_owned(), "ISO 3166-1: DE, US, CN");
        for (name, count) in [("persons", self.persons.len()), ("instruments", self.instruments.len())] {
            fault(count == 0, format!("`{name}` is empty"), "a calibration has at least one");
        }
        fault(self.data.is_empty(), "`data` is empty".to_owned(), "name the files of raw data");
        let counts = [
            ("persons", self.persons.len()),
            ("instruments", self.instruments.len()),
            ("temperatures", self.temperatures.len()),
            ("standards", self.standards.len()),
            ("data", self.data.len()),
            ("figures", self.figures.len()),
            ("limits", self.limits.len()),
            ("sets", self.sets.len()),
            ("remarks", self.remarks.len()),
        ];
        for (name, count) in counts {
            fault(count > MOST, format!("`{name}` has {count} entries; the limit is {MOST}"), "shorten the list");
        }
        for temperature in &self.temperatures {
            let [deg_c, u] = [temperature.deg_c, temperature.expanded_uncertainty_k.unwrap_or(0.0)];
            let wrong = !PLAUSIBLE_DEG_C.contains(&deg_c) || !(0.0..=MAX_KELVIN).contains(&u);
            let name = &temperature.name;
            let message = format!("`{name}` is no temperature of a machine: {deg_c} degC, uncertainty {u} K");
            fault(wrong, message, "-40 to 120 degC and, for the uncertainty, 0 to 20 K");
        }
        // Of a machine that is measured some part has the temperature of the room.
        let warm = self.temperatures.iter().all(|temperature| WARM_DEG_F.contains(&temperature.deg_c));
        let message = "all temperatures are from 59 to 95 degC, as those of a room are in degF".to_owned();
        fault(warm && !self.temperatures.is_empty(), message, "state them in degC: 68 degF are 20 degC");
        for limit in &self.limits {
            let of_figure = [&limit.name, &limit.figures, &limit.value, &limit.unit];
            let whole = of_figure.iter().all(|part| part.is_some()) && limit.alarm.is_none();
            let none = of_figure.iter().all(|part| part.is_none()) && limit.uncertainty.is_none();
            let help = "a limit has `error`, or else `name`, `figures`, `value` and `unit`";
            let fits = if limit.error.is_some() { none } else { whole };
            fault(!fits, format!("the limit `{}` is of no value", limit.limit), help);
        }
        faults
    }
}
