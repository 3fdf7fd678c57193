//! Decisions on the limits of a description, and its alarm limits.

use super::description::{Description, LimitEntry, unfit};
use super::{AlarmLimit, ErrorRow, LimitDecision, Line, StateValue};
use crate::diagnostic::{Diagnostic, shown};
use crate::run::{Call, Refused};
use crate::standards::{LimitSides, LimitedValue};
use crate::units;
use serde_json::Value;

/// A file of figures: its name in the description, its name in the record, its document.
pub(crate) struct Figures {
    pub source: String,
    pub file: String,
    pub document: Value,
}

/// Reads the document of a file of figures.
pub(crate) fn document(call: &mut Call, source: &Line, bytes: &[u8]) -> Result<Value, Refused> {
    serde_json::from_slice(bytes).or_else(|_| {
        let message = format!("`{source}` is no JSON document");
        call.refuse(unfit(message, "write the figures of a verb with `--format json`"))
    })
}

/// Returns a decision for every limit: of an error in each state that gives it, of a figure once.
pub(crate) fn decisions(
    call: &mut Call,
    description: &Description,
    rows: &[ErrorRow],
    figures: &[Figures],
) -> Result<(Vec<LimitDecision>, Vec<AlarmLimit>), Refused> {
    let (mut all, mut alarms) = (Vec::new(), Vec::new());
    for limit in &description.limits {
        let found = match &limit.error {
            Some(error) => of_error(limit, error, rows),
            None => of_figure(limit, figures).map(|decision| (vec![decision], None)),
        };
        match found {
            Ok((decisions, alarm)) => {
                all.extend(decisions);
                alarms.extend(alarm);
            }
            Err(refusal) => call.extend([refusal]),
        }
    }
    call.check()?;
    Ok((all, alarms))
}

type OfError = (Vec<LimitDecision>, Option<AlarmLimit>);

fn of_error(limit: &LimitEntry, error: &Line, rows: &[ErrorRow]) -> Result<OfError, Diagnostic> {
    let Some(row) = rows.iter().find(|row| row.error == error.as_str()) else {
        let message = format!("`{}` is limited and neither machine file gives it", shown(error.as_str()));
        return Err(unfit(message, "name an error as the machine files do, such as EXX or EC0Y"));
    };
    let bound = |text: &Line| in_unit(text, &row.unit);
    let size = bound(&limit.limit)?;
    let decided = |of: &str, state: Option<StateValue>| {
        let state = state.filter(|state| !state.bounded)?;
        let limited = LimitedValue {
            value: state.value,
            expanded: state.expanded_uncertainty,
            limit: size,
            sides: LimitSides::Both,
        };
        Some(decision(row.error.clone(), of.to_owned(), row.unit.clone(), limited))
    };
    let states = [decided("found", row.found), decided("left", row.left)];
    let alarm = limit.alarm.as_ref().map(bound).transpose()?;
    let alarm = alarm.map(|limit| AlarmLimit { error: row.error.clone(), limit, unit: row.unit.clone() });
    Ok((states.into_iter().flatten().collect(), alarm))
}

fn of_figure(limit: &LimitEntry, figures: &[Figures]) -> Result<LimitDecision, Diagnostic> {
    let text = |part: &Option<Line>| part.as_ref().map(Line::to_string).unwrap_or_default();
    let (name, source, unit) = (text(&limit.name), text(&limit.figures), text(&limit.unit));
    let Some(file) = figures.iter().find(|file| file.source == source) else {
        let message = format!("the limit of `{}` names `{}`, which is not in `figures`", shown(&name), shown(&source));
        return Err(unfit(message, "list the file under `figures` too"));
    };
    let number = |pointer: &Option<Line>| {
        let pointer = text(pointer);
        file.document.pointer(&pointer).and_then(Value::as_f64).ok_or_else(|| {
            let message = format!("`{}` has no number at `{}`", shown(&source), shown(&pointer));
            unfit(message, "a JSON pointer, such as /errors/0/accuracy_um")
        })
    };
    let at = text(&limit.value);
    if let Some(instead) = named_beside(&name, &file.document, &at) {
        let message = format!("`{}` takes its value from `{}`, beside which `{instead}` is", shown(&name), shown(&at));
        return Err(unfit(message, "name the limit by the figure that it is of, or correct the pointer"));
    }
    let value = number(&limit.value)?;
    let expanded = limit.uncertainty.is_some().then(|| number(&limit.uncertainty)).transpose()?;
    if expanded.is_some_and(|expanded| expanded < 0.0) {
        return Err(unfit(
            format!("the uncertainty of `{}` is below 0", shown(&name)),
            "name the place of its U, k = 2",
        ));
    }
    let bound = in_unit(&limit.limit, &unit)?;
    // A value below 0 has a sign: both sides are limited.
    let sides = if value < 0.0 { LimitSides::Both } else { LimitSides::Upper };
    let limited = LimitedValue { value, expanded, limit: bound, sides };
    Ok(LimitDecision { at: Some(at), ..decision(name, file.file.clone(), unit, limited) })
}

/// Returns the figure beside the one at a pointer that the words of a name mean instead, as `A of X` at `/errors/0/B`.
fn named_beside(name: &str, document: &Value, pointer: &str) -> Option<String> {
    let (parent, own) = pointer.rsplit_once('/')?;
    let beside = document.pointer(parent)?.as_object()?;
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let is_word = |key: &&String| words.contains(&key.as_str());
    let numbers = beside.iter().filter(|(_, value)| value.is_number()).map(|(key, _)| key);
    (!words.contains(&own)).then(|| numbers.into_iter().find(is_word).cloned()).flatten()
}

fn decision(name: String, of: String, unit: String, limited: LimitedValue) -> LimitDecision {
    LimitDecision {
        name,
        of,
        at: None,
        value: limited.value,
        expanded_uncertainty: limited.expanded,
        limit: limited.limit,
        unit,
        sides: limited.sides,
        guard: limited.guard(),
        decision: limited.decision(),
    }
}

fn in_unit(text: &Line, unit: &str) -> Result<f64, Diagnostic> {
    let help = "write it with its unit, such as `10 um` or `15 urad`, in a unit of the value's kind";
    let fault = || unfit(format!("`{}` is no limit in `{}`", shown(text.as_str()), shown(unit)), help);
    let (factor, dimension) = units::unit(unit).map_err(|_| fault())?;
    let quantity = units::quantity(text.as_str()).map_err(|_| fault())?;
    let value = quantity.value / factor;
    if quantity.dimension != dimension || !value.is_finite() || value < 0.0 {
        return Err(fault());
    }
    Ok(value)
}
