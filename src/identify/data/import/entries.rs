//! Run files of a control system's test bench: an entry for each target and each position that was reached,
//! `TGT_DATA[1]=0`, `REF_DATA_FWD[1,2]=0.0012`.

use super::form::TableForm;
use super::gather::{self, off_target};
use super::options::FileContents;
use super::request::ImportRequest;
use super::sample::{AxisSample, Import, refusal};
use super::unit::{self, position_unit};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::syntax::ColumnDirection::{self, Forward, Reverse};
use crate::syntax::sheet::SheetLine;
use crate::units;
use indexmap::IndexMap;

/// Names of targets and of positions that were reached, by direction.
const TARGET: &str = "TGT_DATA";
const REACHED: [(&str, ColumnDirection); 2] = [("REF_DATA_FWD", Forward), ("REF_DATA_BWD", Reverse)];
/// The entry of the unit; mm without one.
const UNIT: &str = "UNIT";

/// True for a file of this layout.
pub(super) fn is(lines: &[SheetLine]) -> bool {
    lines.iter().any(|line| entry(&line.text).is_some_and(|(name, indices, _)| name == TARGET && !indices.is_empty()))
}

/// Splits `NAME[1,2]=value`, or `NAME=value`.
fn entry(line: &str) -> Option<(&str, Vec<usize>, &str)> {
    let (name, value) = line.split_once('=')?;
    let (name, list) = match name.trim().strip_suffix(']').and_then(|open| open.split_once('[')) {
        Some((name, list)) => (name, list),
        None => return Some((name.trim(), Vec::new(), value.trim())),
    };
    let indices: Option<Vec<usize>> = list.split(',').map(|index| index.trim().parse().ok()).collect();
    Some((name.trim(), indices?, value.trim()))
}

/// Reads the entries of a file that begins at `place`.
pub(super) fn read(lines: &[SheetLine], place: &Place, wanted: &ImportRequest) -> Result<Import, Box<Diagnostic>> {
    let refuse = |message: &str| Box::new(refusal(message.to_owned(), Some(place.clone())));
    let axis = match (&wanted.axis, wanted.error.as_deref().map(unit::component_error)) {
        (_, Some(Err(failure))) => return Err(refuse(&failure.to_string())),
        (Some(axis), _) => axis.to_uppercase(),
        (None, Some(Ok(error))) => error.axis.to_string(),
        (None, None) => return Err(refuse("the file does not say which axis moved: give `--axis X`")),
    };
    let own = unit::own_error(&axis).ok_or_else(|| refuse("the positioning error of this axis has no name"))?;
    if wanted.error.as_deref().is_some_and(|error| unit::component_error(error).as_ref() != Ok(&own)) {
        return Err(refuse(&format!("positions that were reached show the positioning error `{own}` and no other")));
    }
    if wanted.contents.is_some_and(|contents| contents == FileContents::Corrections) {
        return Err(refuse("positions that were reached are no corrections"));
    }
    let mut import = Import { errors: vec![own], ..Import::empty(TableForm::Entries, axis, false) };
    let (mut targets, mut factor) = (IndexMap::new(), None);
    let mut readings = Vec::new();
    for line in lines {
        let refuse = |message: String| Box::new(refusal(message, Some(line.place.clone())));
        let Some((name, indices, value)) = entry(&line.text) else { continue };
        let number = || units::number(value).map_err(|failure| refuse(failure.to_string()));
        let reached = REACHED.iter().find(|(known, _)| *known == name).map(|(_, direction)| *direction);
        let twice = match (&indices[..], reached) {
            ([target], None) if name == TARGET => targets.insert(*target, number()?).is_some(),
            ([target, run], Some(direction)) => {
                readings.push((*target, *run, direction, number()?, line));
                false
            }
            ([], None) if name == UNIT => {
                let found = position_unit(value).map_err(|failure| refuse(failure.to_string()))?;
                factor.replace(found).is_some()
            }
            _ => {
                import.metadata.push((name.to_owned(), value.to_owned()));
                false
            }
        };
        if twice {
            return Err(refuse(format!("`{}` is given twice", shown(name))));
        }
    }
    let (rotary, factor) = factor.unwrap_or((import.axis.starts_with(['A', 'B', 'C']), 1.0));
    import.rotary = rotary;
    if rotary != import.errors[0].direction.is_rotation() {
        return Err(refuse("the unit is not one of positions of this axis"));
    }
    for (target, run, direction, value, line) in readings {
        let Some(position) = targets.get(&target).map(|position| position * factor) else {
            let message = format!("there is no target {target}");
            return Err(Box::new(refusal(message, Some(line.place.clone()))));
        };
        let value = off_target(value * factor - position, rotary);
        let (run, direction, place) = (run.to_string(), Some(direction), line.place.clone());
        import.samples.push(AxisSample { error: 0, position, direction, run, value, place });
    }
    if import.samples.is_empty() {
        return Err(refuse("the file has targets and no position that was reached"));
    }
    gather::check_plausible(&import.samples, &import.errors).map_err(|failure| refuse(&failure.to_string()))?;
    gather::finish(import, wanted, &[], place)
}
