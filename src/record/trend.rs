//! Records of one machine in a line: every error over the dates, alarm limits, and what changed between records.

use super::check::check;
use super::data::{AlarmLimit, Dates, Day, ErrorRow, Line, MachineState, Plate, StateValue};
use super::files::JSON_NAME;
use super::sign::refuse_changed;
use crate::controller::is_plain_name;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::file_set::folder::SET_LIMIT;
use crate::job::machine_file::{LoadOptions, MachineFile, load};
use crate::report::{LinePanel, LinePicture, MachineDifference, Picture};
use crate::run::{Call, Refused, Run, sha256};
use crate::syntax::MemoryFiles;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Compares two machines.
pub(crate) type Compare<'a> = &'a dyn Fn(&mut Call<'_>, [MachineFile; 2]) -> Result<MachineDifference, Refused>;

/// Maximum number of panels of the picture.
const PANELS: usize = 12;

/// Least change of an error that is drawn, um or urad.
const SHOWN: f64 = 1e-3;

/// The part of `record.json` that a trend needs.
#[derive(Debug, Clone, Deserialize)]
struct StoredRecord {
    record: u32,
    id: Line,
    dates: Dates,
    machine: Line,
    plate: Plate,
    as_found: MachineState,
    as_left: Option<MachineState>,
    errors: Vec<ErrorRow>,
    alarms: Vec<AlarmLimit>,
    #[serde(skip)]
    folder: PathBuf,
}

/// A record of the line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct TrendRecord {
    /// Unique name.
    pub id: Line,
    /// The folder.
    pub folder: String,
    /// First and last day.
    pub dates: Dates,
    /// True if the machine was left otherwise than found.
    pub adjusted: bool,
}

/// State of an error against its alarm limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlarmState {
    /// The newest value keeps the limit.
    Below,
    /// The newest value exceeds the limit.
    Alarm,
    /// No record states a limit.
    None,
}

/// An error in a state of a record.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TrendPoint {
    /// Unique name of the record.
    pub id: Line,
    /// The first day for the state as found, the last day for the state as left.
    pub day: Day,
    /// `found` or `left`.
    pub state: &'static str,
    /// The value of the largest size over the volume.
    pub value: f64,
    /// Expanded uncertainty (k = 2), if the machine file states it.
    pub expanded_uncertainty: Option<f64>,
}

/// An error over the records.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ErrorTrend {
    /// Name of the error.
    pub error: String,
    /// `um` or `urad`.
    pub unit: String,
    /// Alarm limit of the absolute value: that of the newest record that states one.
    pub alarm_limit: Option<f64>,
    /// State of the newest value.
    pub alarm: AlarmState,
    /// Newest less oldest value; `None` for a single one.
    pub change: Option<f64>,
    /// The values, oldest first.
    pub points: Vec<TrendPoint>,
}

/// What changed from a record to the next: the machine as it was left against the machine as it was found.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TrendStep {
    /// The earlier record.
    pub from: Line,
    /// The later record.
    pub to: Line,
    /// The difference of the machines, as `diff` states it.
    pub difference: MachineDifference,
}

/// Records in a line.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RecordTrend {
    /// Name of the machine in the newest record.
    pub machine: String,
    /// Its serial number.
    pub serial: Line,
    /// The records, oldest first.
    pub records: Vec<TrendRecord>,
    /// Every error that a record gives a value.
    pub errors: Vec<ErrorTrend>,
    /// What changed between neighbours.
    pub steps: Vec<TrendStep>,
}

/// Puts records of one machine in a line.
pub(crate) fn trend(
    call: &mut Call,
    folders: &[PathBuf],
    load_options: &LoadOptions,
    compare: Compare<'_>,
) -> Result<RecordTrend, Refused> {
    if folders.len() < 2 {
        return call.usage("a trend takes two records or more");
    }
    let mut records = Vec::new();
    for folder in folders {
        records.push(load_stored(call, folder)?);
    }
    records.sort_by(|a, b| (&a.dates.begin, &a.dates.end, &a.id).cmp(&(&b.dates.begin, &b.dates.end, &b.id)));
    refuse_mixture(call, &records)?;
    let steps =
        records.windows(2).map(|pair| step(call, pair, load_options, compare)).collect::<Result<Vec<_>, _>>()?;
    let Some(newest) = records.last() else { return Err(Refused) };
    let of = |record: &StoredRecord| TrendRecord {
        id: record.id.clone(),
        folder: shown(&record.folder.display().to_string()),
        dates: record.dates.clone(),
        adjusted: record.as_left.is_some(),
    };
    Ok(RecordTrend {
        machine: newest.machine.to_string(),
        serial: newest.plate.serial.clone(),
        records: records.iter().map(of).collect(),
        errors: errors(&records),
        steps,
    })
}

fn load_stored(call: &mut Call, folder: &Path) -> Result<StoredRecord, Refused> {
    if let Some(stranger) = check(call, folder, None)?.unlisted.first() {
        let name = shown(&folder.display().to_string());
        let message = format!("`{}` in `{name}` is not of the record", shown(stranger));
        let help = "a trend reads the files of its records only: keep other files elsewhere";
        return call.refuse(Diagnostic::new(codes::E0821, message).help(help));
    }
    let bytes = call.run.files.read_at_most(&folder.join(JSON_NAME), SET_LIMIT).unwrap_or_default();
    match serde_json::from_slice::<StoredRecord>(&bytes) {
        Ok(record) if record.record == 1 && record.is_its_own() => {
            Ok(StoredRecord { folder: folder.to_owned(), ..record })
        }
        _ => {
            let message =
                format!("`{JSON_NAME}` of `{}` is no record of version 1", shown(&folder.display().to_string()));
            call.refuse(Diagnostic::new(codes::E0821, message).help("make the record again from its sources"))
        }
    }
}

impl StoredRecord {
    /// True if it leads to files of its folder only, and names errors as abbe writes them: the folder may be anybody's.
    fn is_its_own(&self) -> bool {
        let error = |(error, unit): (&String, &String)| {
            error.bytes().all(|byte| byte.is_ascii_alphanumeric()) && ["um", "urad"].contains(&unit.as_str())
        };
        let rows = self.errors.iter().map(|row| (&row.error, &row.unit));
        let states = || std::iter::once(&self.as_found).chain(&self.as_left);
        rows.chain(self.alarms.iter().map(|alarm| (&alarm.error, &alarm.unit))).all(error)
            && states().all(|state| state.file.split('/').all(is_plain_name))
    }
}

/// Refuses records of several machines, by the serial number, and a record that is given twice.
fn refuse_mixture(call: &mut Call, records: &[StoredRecord]) -> Result<(), Refused> {
    for pair in records.windows(2) {
        let [first, second] = pair else { continue };
        let [a, b] = [&first.plate.serial, &second.plate.serial];
        if a != b {
            let message = format!("`{}` is of serial number {a}, `{}` of {b}", first.id, second.id);
            call.extend([Diagnostic::new(codes::E0822, message).help("a trend is of one machine")]);
        }
    }
    for (i, record) in records.iter().enumerate() {
        if records[..i].iter().any(|earlier| earlier.id == record.id) {
            let message = format!("two records bear the name `{}`", record.id);
            call.extend([Diagnostic::new(codes::E0822, message).help("name each record once; names are unique")]);
        }
    }
    call.check()
}

fn step(
    call: &mut Call,
    pair: &[StoredRecord],
    load_options: &LoadOptions,
    compare: Compare<'_>,
) -> Result<TrendStep, Refused> {
    let [first, second] = pair else { return Err(Refused) };
    let left = load_state(call, first, first.as_left.as_ref().unwrap_or(&first.as_found), load_options)?;
    let found = load_state(call, second, &second.as_found, load_options)?;
    let difference = compare(call, [left, found])?;
    Ok(TrendStep { from: first.id.clone(), to: second.id.clone(), difference })
}

/// Loads the machine of a state from the files that the record states, and from no other.
fn load_state(
    call: &mut Call,
    record: &StoredRecord,
    state: &MachineState,
    load_options: &LoadOptions,
) -> Result<MachineFile, Refused> {
    let mut memory = MemoryFiles::default();
    for input in &state.inputs {
        let bytes = call.run.files.read_at_most(&record.folder.join(&input.name), SET_LIMIT).unwrap_or_default();
        if sha256(&bytes) != input.sha256 {
            let message = format!("`{}` of `{}` has changed", shown(&input.name), record.id);
            return call.refuse(refuse_changed(message));
        }
        memory = memory.with(record.folder.join(&input.name), bytes);
    }
    let answer = load(record.folder.join(&state.file), load_options, Run { files: &memory, ..call.run });
    call.take(answer)
}

/// Every error in the order of the records.
fn errors(records: &[StoredRecord]) -> Vec<ErrorTrend> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for row in records.iter().flat_map(|record| &record.errors) {
        if !names.iter().any(|(name, _)| *name == row.error) {
            names.push((&row.error, &row.unit));
        }
    }
    names.into_iter().filter_map(|(name, unit)| of_error(records, name, unit)).collect()
}

fn of_error(records: &[StoredRecord], name: &str, unit: &str) -> Option<ErrorTrend> {
    let of = |record: &StoredRecord| {
        let row = record.errors.iter().find(|row| row.error == name);
        let point = |state: &'static str, day: &Day, value: Option<StateValue>| {
            let value = value.filter(|value| !value.bounded && !value.held)?;
            let (id, day) = (record.id.clone(), day.clone());
            Some(TrendPoint { id, day, state, value: value.value, expanded_uncertainty: value.expanded_uncertainty })
        };
        let found = row.and_then(|row| point("found", &record.dates.begin, row.found));
        let left = row.and_then(|row| point("left", &record.dates.end, row.left));
        found.into_iter().chain(left).collect::<Vec<_>>()
    };
    let points: Vec<TrendPoint> = records.iter().flat_map(of).collect();
    let (oldest, newest) = (points.first()?.value, points.last()?.value);
    let alarm = records.iter().rev().find_map(|record| record.alarms.iter().find(|alarm| alarm.error == name));
    let alarm_limit = alarm.map(|alarm| alarm.limit);
    let state = match alarm_limit {
        None => AlarmState::None,
        Some(limit) if newest.abs() > limit => AlarmState::Alarm,
        Some(_) => AlarmState::Below,
    };
    let (error, unit) = (name.to_owned(), unit.to_owned());
    let change = (points.len() > 1).then_some(newest - oldest);
    Some(ErrorTrend { error, unit, alarm_limit, alarm: state, change, points })
}

impl RecordTrend {
    /// Returns the errors that changed or have an alarm limit over the days: those in alarm first, then those with a
    /// limit, then those that changed most; at most 12.
    pub fn picture(&self) -> Picture {
        let first = self.records.first().map_or(0, |record| record.dates.begin.number());
        let begin = self.records.first().map_or("", |record| record.dates.begin.as_str());
        let size = |error: &ErrorTrend| error.change.map_or(0.0, f64::abs);
        let moved = |error: &&ErrorTrend| error.alarm_limit.is_some() || size(error) > SHOWN;
        let mut shown: Vec<&ErrorTrend> = self.errors.iter().filter(moved).collect();
        let rank = |error: &ErrorTrend| (error.alarm != AlarmState::Alarm, error.alarm_limit.is_none());
        shown.sort_by(|a, b| rank(a).cmp(&rank(b)).then(size(b).total_cmp(&size(a))));
        let omitted = self.errors.len() - shown.len().min(PANELS);
        shown.truncate(PANELS);
        let panels: Vec<LinePanel> = shown.into_iter().map(|error| panel(error, first)).collect();
        let more = if omitted > 0 { format!("; {omitted} more errors are in the table") } else { String::new() };
        let subtitle = format!("{} records, as found and as left{more}", self.records.len());
        let title = format!("{}, serial number {}", self.machine, self.serial);
        let across = format!("days since {begin}");
        LinePicture { title: &title, subtitle: &subtitle, across: &across, panels: &panels }.picture()
    }
}

fn panel(error: &ErrorTrend, first: i64) -> LinePanel {
    let at = |point: &TrendPoint| ((point.day.number() - first) as f64, point.value);
    let line: Vec<(f64, f64)> = error.points.iter().map(at).collect();
    let ends = [line.first().copied().unwrap_or_default().0, line.last().copied().unwrap_or_default().0];
    let mut curves = vec![(error.error.clone(), line)];
    for limit in error.alarm_limit.into_iter().flat_map(|limit| [limit, -limit]) {
        let name = if limit >= 0.0 { "alarm limit" } else { "alarm limit, below 0" };
        curves.push((name.to_owned(), ends.map(|x| (x, limit)).to_vec()));
    }
    LinePanel { unit: if error.unit == "um" { "µm" } else { "µrad" }, curves }
}
