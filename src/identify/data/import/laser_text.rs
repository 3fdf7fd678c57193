//! The text files of Renishaw's laser programs: `.rtl`, `.rta`, `.rts`, `.rtr`.
//!
//! No description by the maker is public. The layout is that which independent programs write and read. Neither the
//! quantity and its unit nor the sign stands in the file: the ending of its name gives the one, the caller the other.

use super::form::TableForm;
use super::gather;
use super::header::is_axis;
use super::request::ImportRequest;
use super::sample::{AxisSample, Import, UnusedColumn, refusal};
use super::unit::{self, ReadingUnit, component_error, own_axis, reading_unit};
use crate::diagnostic::{Diagnostic, Place, Reason, shown};
use crate::machine::{AxisName, ErrorId};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Decimals, SheetLine};
use std::path::Path;

/// Quantities by the ending of a file's name: unit of the deviations where it is known, and true for the positioning
/// error of the axis.
const ENDINGS: [(&str, Option<&str>, bool); 4] =
    [("rtl", Some("um"), true), ("rta", Some("mrad"), false), ("rts", None, false), ("rtr", None, true)];

/// Sections that hold entries `name: value` for people.
const NOTES: [&str; 4] = ["HEADER", "USER-TEXT", "EQUIPMENT", "ENVIRONMENT"];

/// The section and entry before the targets, their number, the runs, their number, and the deviations.
const TARGETS: (&str, &str) = ("TARGET DATA", "targets");
const TARGET_COUNT: (&str, &str) = ("TARGET DATA", "target-count");
const RUN_COUNT: (&str, &str) = ("RUNS", "run-count");
const DEVIATIONS: (&str, &str) = ("DEVIATIONS", "run target data");

/// True for a file of this layout.
pub(super) fn is(lines: &[SheetLine]) -> bool {
    lines.first().is_some_and(|line| section(&line.text).is_some())
        && lines.iter().any(|line| section(&line.text) == Some(DEVIATIONS.0))
}

fn section(line: &str) -> Option<&str> {
    line.trim().strip_suffix("::").map(str::trim)
}

/// The numbers of a file as they stand.
#[derive(Default)]
struct Contents {
    targets: Vec<f64>,
    target_count: Option<f64>,
    run_count: Option<f64>,
    /// Run, target and deviation, with the place.
    readings: Vec<([f64; 3], Place)>,
    metadata: Vec<(String, String)>,
}

/// Reads the sections of a file that begins at `first`.
pub(super) fn read(
    lines: &[SheetLine],
    first: &Place,
    wanted: &ImportRequest,
    path: &Path,
) -> Result<Import, Box<Diagnostic>> {
    let refuse = |message: String| Box::new(refusal(message, Some(first.clone())));
    let contents = contents(lines)?;
    let (axis, error, unit) = quantity(&contents, wanted, path).map_err(|why| refuse(why.to_string()))?;
    if wanted.contents.is_none() {
        let message = "nothing in the file says whether its values are errors or corrections";
        let help =
            "say `--holds errors` (measured minus target) or `--holds corrections`; both circulate in this layout";
        return Err(Box::new(refusal(message.to_owned(), Some(first.clone())).help(help)));
    }
    let rotary = axis.starts_with(['A', 'B', 'C']);
    let mut import = Import { errors: vec![error], ..Import::empty(TableForm::LaserText, axis, rotary) };
    let runs = runs(&contents).map_err(|why| refuse(why.to_string()))?;
    let factor = unit.factor * wanted.sign();
    let beside = samples(&mut import, &contents.targets, &runs, factor);
    import.metadata = contents.metadata;
    let deviations = lines.iter().find(|line| section(&line.text) == Some(DEVIATIONS.0));
    let place = deviations.map_or(first, |line| &line.place);
    gather::check_plausible(&import.samples, &import.errors)
        .map_err(|failure| Box::new(refusal(failure.to_string(), Some(place.clone()))))?;
    gather::finish(import, wanted, if beside { &[0] } else { &[] }, place)
}

fn contents(lines: &[SheetLine]) -> Result<Contents, Box<Diagnostic>> {
    let mut found = Contents::default();
    let (mut current, mut list) = (String::new(), String::new());
    let mut decimals = Decimals::default();
    for line in lines {
        let refuse = |message: String| Box::new(refusal(message, Some(line.place.clone())));
        if let Some(name) = section(&line.text) {
            (current, list) = (name.to_uppercase(), String::new());
            continue;
        }
        let mut numbers = line.text.as_str();
        if let Some((key, value)) = line.text.split_once(':') {
            (list, numbers) = (key.trim().to_lowercase(), value);
            if NOTES.contains(&current.as_str()) && !value.trim().is_empty() {
                found.metadata.push((key.trim().to_owned(), value.trim().to_owned()));
            }
        }
        let mut values = Vec::new();
        let at = (current.as_str(), list.as_str());
        if ![TARGETS, TARGET_COUNT, RUN_COUNT, DEVIATIONS].contains(&at) {
            continue;
        }
        for cell in numbers.split_whitespace() {
            decimals.note(cell, ';').map_err(|mixed| refuse(mixed.to_string()))?;
            values.push(sheet::number(cell, ';').map_err(|failure| refuse(failure.to_string()))?);
        }
        match (at, &values[..]) {
            (_, []) => {}
            (TARGETS, targets) => found.targets.extend(targets),
            (TARGET_COUNT, [count]) => found.target_count = Some(*count),
            (RUN_COUNT, [count]) => found.run_count = Some(*count),
            (DEVIATIONS, [run, target, value]) => found.readings.push(([*run, *target, *value], line.place.clone())),
            _ => return Err(refuse(format!("{} numbers stand where others belong", values.len()))),
        }
    }
    Ok(found)
}

fn quantity(
    contents: &Contents,
    wanted: &ImportRequest,
    path: &Path,
) -> Result<(String, ErrorId, ReadingUnit), Reason> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let (known, own) =
        ENDINGS.iter().find(|(known, ..)| *known == ending).map_or((None, false), |(_, unit, own)| (*unit, *own));
    let named = wanted.error.as_deref().map(component_error).transpose().map_err(Reason::new)?;
    let note = contents.metadata.iter().find(|(key, _)| is_axis(key));
    let noted = note.map(|(_, axis)| axis.to_uppercase()).filter(|axis| AxisName::new(axis).is_some());
    let axis = wanted.axis.as_deref().map(str::to_uppercase).or(noted);
    let axis = axis.or_else(|| named.as_ref().map(|error| error.axis.to_string()));
    let axis = axis.ok_or_else(|| Reason::new("the file does not say which axis moved: give `--axis X`"))?;
    let error = match named {
        Some(error) => error,
        None if own => unit::own_error(&axis)
            .ok_or_else(|| Reason::new("the file does not say which error it holds: give `--error`"))?,
        None => return Err(Reason::new("the file does not say which error it holds: give `--error`")),
    };
    own_axis(&error, &axis).map_err(Reason::new)?;
    let unit = match (known, wanted.unit.as_deref()) {
        (Some(known), Some(given)) if reading_unit(known) != reading_unit(given) => {
            return Err(Reason::new(format!("`.{ending}` files hold {known}, not `{}`", shown(given))));
        }
        (Some(unit), _) | (None, Some(unit)) => unit,
        (None, None) => {
            return Err(Reason::new("no unit stands in the file, and none is known for its ending: give `--unit`"));
        }
    };
    let found = reading_unit(unit).map_err(Reason::new)?;
    if found.fits(&error) {
        Ok((axis, error, found))
    } else {
        Err(Reason::new(format!("`{}` is not a unit of `{error}`", shown(unit))))
    }
}

/// A reading of a run: index of the target, deviation, and its line.
struct LaserReading {
    target: usize,
    value: f64,
    place: Place,
}

/// Runs in the order of the file.
type LaserRuns = Vec<Vec<LaserReading>>;

/// Returns the readings by run; every run has every target once.
fn runs(contents: &Contents) -> Result<LaserRuns, Reason> {
    let Contents { targets, target_count, run_count, readings, .. } = contents;
    if target_count.is_some_and(|count| count != targets.len() as f64) {
        let count = target_count.unwrap_or_default();
        return Err(Reason::new(format!("the file announces {count} targets and has {}", targets.len())));
    }
    let mut runs: LaserRuns = Vec::new();
    let mut last = f64::NAN;
    for ([run, target, value], place) in readings {
        let index = (1..=targets.len()).find(|index| *index as f64 == *target);
        let index =
            index.ok_or_else(|| Reason::new(format!("{target} is no number of a target (1 to {})", targets.len())))?;
        if *run != last {
            runs.push(Vec::new());
            last = *run;
        }
        if let Some(pass) = runs.last_mut() {
            pass.push(LaserReading { target: index - 1, value: *value, place: place.clone() });
        }
    }
    let mut seen = vec![false; targets.len()];
    for (number, pass) in (1..).zip(&runs) {
        seen.fill(false);
        pass.iter().for_each(|reading| seen[reading.target] = true);
        if pass.len() != targets.len() || !seen.iter().all(|seen| *seen) {
            return Err(Reason::new(format!("run {number} does not have each of the {} targets once", targets.len())));
        }
    }
    let announced = run_count.unwrap_or(runs.len() as f64);
    if announced == runs.len() as f64 && !runs.is_empty() {
        Ok(runs)
    } else {
        Err(Reason::new(format!("the file announces {announced} runs and has {}", runs.len())))
    }
}

/// Returns the direction of a run: that of its targets in the order of the file.
fn direction(run: &[LaserReading], targets: &[f64]) -> Option<ColumnDirection> {
    let at: Vec<f64> = run.iter().map(|reading| targets[reading.target]).collect();
    let rises = at.windows(2).all(|w| w[1] > w[0]);
    let falls = at.windows(2).all(|w| w[1] < w[0]);
    match (rises, falls) {
        (true, false) => Some(ColumnDirection::Forward),
        (false, true) => Some(ColumnDirection::Reverse),
        _ => None,
    }
}

/// Takes the readings; true if the directions of the runs stay open.
fn samples(import: &mut Import, targets: &[f64], runs: &LaserRuns, factor: f64) -> bool {
    let is_zero = |run: &[LaserReading]| run.iter().all(|reading| reading.value == 0.0);
    let (odd, even): (Vec<_>, Vec<_>) = runs.iter().enumerate().partition(|(k, _)| k.is_multiple_of(2));
    // One writer fills the reverse runs of a test in one direction with zeros.
    let placeholders =
        !even.is_empty() && even.iter().all(|(_, run)| is_zero(run)) && !odd.iter().all(|(_, run)| is_zero(run));
    let directions: Vec<_> = runs.iter().map(|run| direction(run, targets)).collect();
    let open = !placeholders && runs.len() > 1 && directions.windows(2).all(|w| w[0] == w[1]);
    let mut count = [0, 0];
    for (k, run) in runs.iter().enumerate() {
        if placeholders && !k.is_multiple_of(2) {
            let reason = "every deviation is 0, as writers fill runs that were not measured".to_owned();
            import.unused_columns.push(UnusedColumn { title: format!("run {}", k + 1), reason, known: true });
            continue;
        }
        let direction = directions[k].filter(|_| !open && !placeholders);
        let side = usize::from(direction == Some(ColumnDirection::Reverse));
        count[side] += 1;
        let name = if open { (k + 1).to_string() } else { count[side].to_string() };
        import.samples.extend(run.iter().map(|reading| AxisSample {
            error: 0,
            position: targets[reading.target],
            direction,
            run: name.clone(),
            value: reading.value * factor + 0.0,
            place: reading.place.clone(),
        }));
    }
    open
}
