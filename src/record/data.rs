//! Content of the record of a calibration: as described, and as found in the files that it names.

use crate::diagnostic::is_layout;
use crate::run::Hashed;
use crate::standards::{Conformity, LimitSides};
use chrono::{Datelike, NaiveDate};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// Longest text of one line, in characters.
const LONGEST: usize = 1000;

/// A text of one line: not empty, without control characters and those that turn the direction of writing, no blanks
/// around it or doubled in it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(try_from = "String")]
pub struct Line(String);

/// Reason why a text is no value of a description.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoValue(String);

impl TryFrom<String> for Line {
    type Error = NoValue;

    fn try_from(text: String) -> Result<Self, NoValue> {
        let words: Vec<&str> = text.split_whitespace().collect();
        // The last two are no characters of XML.
        let bad = |c: char| c.is_control() || is_layout(c) || matches!(c, '\u{fffe}' | '\u{ffff}');
        if words.is_empty() || text.trim().chars().any(bad) || text.chars().nth(LONGEST).is_some() {
            let message = format!("a text is one line of 1 to {LONGEST} characters without control characters");
            return Err(NoValue(message));
        }
        Ok(Self(words.join(" ")))
    }
}

impl Line {
    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A day of the calendar, `2026-11-02`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(try_from = "String")]
pub struct Day(String);

impl TryFrom<String> for Day {
    type Error = NoValue;

    fn try_from(text: String) -> Result<Self, NoValue> {
        // Read and written again: nothing passes but this one form.
        let is_day = |date: &NaiveDate| (1900..=9999).contains(&date.year()) && date.to_string() == text;
        match text.parse().ok().filter(is_day) {
            Some(_) => Ok(Self(text)),
            None => Err(NoValue(format!("`{text}` is no day: write it as 2026-11-02"))),
        }
    }
}

impl Day {
    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Days since the first day of the year 1 of the Gregorian calendar, which has the number 1.
    pub fn number(&self) -> i64 {
        self.0.parse().map_or(0, |date: NaiveDate| i64::from(date.num_days_from_ce()))
    }
}

/// A code of letters: a country (ISO 3166-1) or a language (ISO 639-1).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(try_from = "String")]
pub struct TwoLetters(String);

impl TryFrom<String> for TwoLetters {
    type Error = NoValue;

    fn try_from(text: String) -> Result<Self, NoValue> {
        let all = |of: fn(&u8) -> bool| text.len() == 2 && text.bytes().all(|b| of(&b));
        if all(u8::is_ascii_uppercase) || all(u8::is_ascii_lowercase) {
            return Ok(Self(text));
        }
        Err(NoValue(format!("`{text}` is no code of two letters, such as DE or en")))
    }
}

impl TwoLetters {
    /// English.
    pub fn english() -> Self {
        Self("en".to_owned())
    }

    /// True for capital letters, as countries are written.
    pub fn is_country(&self) -> bool {
        self.0.bytes().all(|b| b.is_ascii_uppercase())
    }
}

/// The place of the calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "camelCase")]
pub enum Place {
    /// At the laboratory.
    Laboratory,
    /// At the customer's.
    Customer,
    /// At a branch of the laboratory.
    LaboratoryBranch,
    /// At a branch of the customer.
    CustomerBranch,
    /// Elsewhere.
    Other,
}

/// First and last day of the calibration, and the day of issue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dates {
    /// First day.
    pub begin: Day,
    /// Last day.
    pub end: Day,
    /// Day of issue.
    #[serde(default)]
    pub issued: Option<Day>,
}

/// A laboratory or a customer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name.
    pub name: Line,
    /// Code of the laboratory, such as that of its accreditation.
    #[serde(default)]
    pub code: Option<Line>,
    /// Electronic mail.
    #[serde(default)]
    pub email: Option<Line>,
    /// Street and number.
    #[serde(default)]
    pub street: Option<Line>,
    /// Post code.
    #[serde(default)]
    pub post_code: Option<Line>,
    /// City.
    pub city: Line,
    /// Country, ISO 3166-1.
    #[serde(default)]
    pub country: Option<TwoLetters>,
}

/// What ISO/IEC 17025 asks of a certificate beside the numbers; `null` where the description does not state it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Statements {
    /// Chain of calibrations to the unit of length.
    pub traceability: Option<Line>,
    /// Rule by which the decisions count, and who agreed to it.
    pub decision_rule: Option<Line>,
    /// Conditions during the calibration.
    pub environment: Option<Line>,
    /// Place at which the machine stands: address, hall.
    pub location: Option<Line>,
    /// Lines and volume that were measured, and how they were approached.
    pub path: Option<Line>,
    /// Name of the record that this one replaces.
    pub replaces: Option<Line>,
}

/// A responsible person.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Name.
    pub name: Line,
    /// Role, such as `calibration engineer`.
    #[serde(default)]
    pub role: Option<Line>,
}

/// The machine by its plate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Serial number.
    pub serial: Line,
    /// Manufacturer.
    #[serde(default)]
    pub manufacturer: Option<Line>,
    /// Model.
    #[serde(default)]
    pub model: Option<Line>,
}

/// An instrument and its certificate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    /// Name.
    pub name: Line,
    /// Manufacturer.
    #[serde(default)]
    pub manufacturer: Option<Line>,
    /// Model.
    #[serde(default)]
    pub model: Option<Line>,
    /// Serial number.
    pub serial: Line,
    /// Number of its certificate.
    pub certificate: Line,
    /// Day of its calibration.
    pub calibrated: Day,
    /// Day on which its certificate ends.
    #[serde(default)]
    pub due: Option<Day>,
    /// Uncertainty in the words of its certificate.
    pub uncertainty: Line,
    /// The certificate as a file; in the record its copy.
    #[serde(default)]
    pub file: Option<Line>,
}

/// A temperature during the calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Temperature {
    /// Place of the sensor.
    pub name: Line,
    /// Temperature, degC.
    pub deg_c: f64,
    /// Expanded uncertainty (k = 2), K.
    #[serde(default)]
    pub expanded_uncertainty_k: Option<f64>,
}

/// The machine file of a state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct MachineState {
    /// The machine file within the record.
    pub file: String,
    /// Every file that it is read from, within the record.
    pub inputs: Vec<Hashed>,
}

/// An error in one state of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct StateValue {
    /// The value of the largest size over the volume: of a bounded error its bound.
    pub value: f64,
    /// True if the error is only bounded.
    pub bounded: bool,
    /// Expanded uncertainty (k = 2), if the machine file states it.
    pub expanded_uncertainty: Option<f64>,
    /// True of a zero that the datum of a fit sets, or its user: nothing is measured.
    #[serde(default)]
    pub held: bool,
}

/// An error as found and as left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ErrorRow {
    /// Name of the error.
    pub error: String,
    /// `um` or `urad`.
    pub unit: String,
    /// As found; `null` if the file does not give it.
    pub found: Option<StateValue>,
    /// As left; `null` if the file does not give it.
    pub left: Option<StateValue>,
}

/// An error whose value has a covariance with those of others.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CovariedError {
    /// Name of the error.
    pub error: String,
    /// Position (mm or deg) of the value, approached with rising position; `null` for a location error.
    pub position: Option<f64>,
    /// The value: of a curve that of the largest size at its positions.
    pub value: f64,
    /// `um` or `urad`.
    pub unit: &'static str,
}

/// Covariance of the fit in a state of the machine.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordedCovariance {
    /// `found` or `left`.
    pub state: &'static str,
    /// The errors that the fit knows with an uncertainty, in the order of rows and columns.
    pub errors: Vec<CovariedError>,
    /// The covariance, row by row, in products of the units.
    pub covariance: Vec<Vec<f64>>,
}

/// Curve of a component error.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ErrorCurve {
    /// `found` or `left`.
    pub state: &'static str,
    /// Name of the error.
    pub error: String,
    /// Name of the axis.
    pub axis: String,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// `mm` or `deg`.
    pub position_unit: &'static str,
    /// Positions: those of the table, or 21 over the volume.
    pub positions: Vec<f64>,
    /// Values approached with rising position.
    pub forward: Vec<f64>,
    /// Values approached with falling position; `null` if they are the same.
    pub reverse: Option<Vec<f64>>,
    /// Expanded uncertainty (k = 2) of the values, if the file states it.
    pub expanded_uncertainty: Option<f64>,
}

/// A decision on a limit, ISO 14253-1.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LimitDecision {
    /// Name of the limited value.
    pub name: String,
    /// `found`, `left` or the file of figures.
    pub of: String,
    /// The place of the value in a file of figures, a JSON pointer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// The value.
    pub value: f64,
    /// Expanded uncertainty (k = 2).
    pub expanded_uncertainty: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// Unit of the three, and of the guard.
    pub unit: String,
    /// Sides of the limit.
    pub sides: LimitSides,
    /// Distance from the limit within which nothing is proven.
    pub guard: Option<f64>,
    /// The decision.
    pub decision: Conformity,
}

/// An alarm limit of an error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct AlarmLimit {
    /// Name of the error.
    pub error: String,
    /// Limit of the absolute value, um or urad.
    pub limit: f64,
    /// `um` or `urad`.
    pub unit: String,
}

/// A set of compensation files.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordedSet {
    /// Its folder within the record.
    pub folder: String,
    /// True if it is in force as left, false if it was replaced.
    pub installed: bool,
    /// The controller.
    pub target: String,
    /// Its files, within the record.
    pub files: Vec<Hashed>,
    /// The state of the machine by which it is verified: `found` or `left`; `null` for a replaced set.
    pub verified_with: Option<&'static str>,
    /// Certificate of `verify`; `null` for a replaced set.
    pub verify: Option<Value>,
    /// Residual that the certificate allows to promise; `null` for a replaced set.
    pub promised: Option<PromisedResidual>,
    /// Certificate that `compile` printed, if the description names it.
    pub compile: Option<Value>,
}

/// A reversal that was measured and that the machine file does not hold.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct UnheldReversal {
    /// Name of the error.
    pub error: String,
    /// Its largest size with the expanded uncertainty (k = 2) that the file of figures states, um.
    pub um: f64,
    /// The file of figures.
    pub file: String,
}

/// Residual of an installed set that is promised.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PromisedResidual {
    /// 95 % position deviation over the volume by the values of the errors alone, um.
    pub model_um: f64,
    /// Its interval at 95 % by the uncertainty of the errors, um; `null` if the machine file states none.
    pub interval_um: Option<[f64; 2]>,
    /// Contributions of type B in this uncertainty, in words; empty if the fit states none.
    pub type_b: Vec<String>,
    /// Reversals that the model does not hold, the largest of each error.
    pub reversals: Vec<UnheldReversal>,
    /// Upper end of the interval, plus the reversals of each direction added and the directions at right angles, um;
    /// `null` without an interval.
    pub within_um: Option<f64>,
}

/// The signature of a record, as the record states it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct RecordSignature {
    /// `ed25519`.
    pub algorithm: String,
    /// The public key: its 32 bytes, hexadecimal.
    pub public_key: String,
    /// File of the signature within the record.
    pub file: String,
}

/// A copied file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct CopiedFile {
    /// Name as the description has it.
    pub source: String,
    /// Name within the record.
    pub file: String,
    /// Size in bytes.
    pub bytes: usize,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A figure of a standard, from a document of another verb.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordedFigure {
    /// Its name.
    pub figure: Line,
    /// Its value.
    pub value: f64,
    /// Its expanded uncertainty (k = 2), if the document states one.
    pub expanded_uncertainty: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
}

/// A document of figures.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordedFigures {
    /// The file.
    #[serde(flatten)]
    pub copy: CopiedFile,
    /// Figures in it that are those of `import` and `figures`.
    pub values: Vec<RecordedFigure>,
    /// In sentences which contributors the uncertainties have and lack.
    pub contributors: Vec<Line>,
}

/// Everything that a record shows.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordData {
    /// Version of the contract: 1.
    pub record: u32,
    /// Version of the program.
    pub abbe: &'static str,
    /// Unique name of the record.
    pub id: Line,
    /// Days.
    pub dates: Dates,
    /// Language of the texts.
    pub language: TwoLetters,
    /// Country of the calibration.
    pub country: TwoLetters,
    /// Place of the calibration.
    pub place: Place,
    /// The laboratory.
    pub laboratory: Contact,
    /// The customer.
    pub customer: Contact,
    /// Responsible persons.
    pub persons: Vec<Person>,
    /// Name of the machine.
    pub machine: String,
    /// Its chain.
    pub chain: String,
    /// Its plate.
    pub plate: Plate,
    /// Instruments.
    pub instruments: Vec<Instrument>,
    /// Temperatures.
    pub temperatures: Vec<Temperature>,
    /// Standards.
    pub standards: Vec<Line>,
    /// What ISO/IEC 17025 asks beside the numbers.
    pub statements: Statements,
    /// Remarks.
    pub remarks: Vec<Line>,
    /// The machine as found.
    pub as_found: MachineState,
    /// The machine as left; `null` if it was left as found.
    pub as_left: Option<MachineState>,
    /// Every error.
    pub errors: Vec<ErrorRow>,
    /// Covariances of the fits, for each state that states one.
    pub covariances: Vec<RecordedCovariance>,
    /// Curves of component errors.
    pub curves: Vec<ErrorCurve>,
    /// Decisions.
    pub decisions: Vec<LimitDecision>,
    /// Alarm limits for the trend.
    pub alarms: Vec<AlarmLimit>,
    /// Sets of compensation files.
    pub sets: Vec<RecordedSet>,
    /// Raw data.
    pub data: Vec<CopiedFile>,
    /// Figures: JSON documents of other verbs.
    pub figures: Vec<RecordedFigures>,
    /// The signature; `null` if the record is not signed.
    pub signature: Option<RecordSignature>,
    /// Every file but this document, its signature and the list of the hashes.
    pub files: Vec<Hashed>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_days() {
        let day = |text: &str| Day::try_from(text.to_owned());
        for text in ["2026-11-02", "2024-02-29", "2000-02-29"] {
            assert!(day(text).is_ok(), "{text}");
        }
        for text in [
            "2026-11-31",
            "2026-02-29",
            "1900-02-29",
            "2026-13-01",
            "2026-1-1",
            "02.11.2026",
            "+026-11-02",
            "+2026-11-02",
            " 2026-11-02",
            "20261102",
            "",
        ] {
            assert!(day(text).is_err(), "{text}");
        }
        let number = |text: &str| day(text).unwrap().number();
        assert_eq!(number("2026-03-01") - number("2026-02-28"), 1);
        assert_eq!(number("2024-03-01") - number("2024-02-28"), 2);
        assert_eq!(number("2027-01-01") - number("2026-01-01"), 365);
        assert_eq!(number("2100-01-01") - number("2000-01-01"), 36525);
    }

    #[test]
    fn lines_are_single_lines_that_xml_can_hold() {
        assert_eq!(Line::try_from(" a  b ".to_owned()).unwrap().as_str(), "a b");
        for text in ["", "  ", "a\u{0}b", "a\u{1b}b", "a\u{fffe}"] {
            assert!(Line::try_from(text.to_owned()).is_err(), "{text:?}");
        }
        assert!(Line::try_from("x".repeat(1001)).is_err());
    }
}
