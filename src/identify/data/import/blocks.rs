//! Blocks by error, as laser tracers hand them to controllers (Etalon's exchange format): `[EXY]`, `Gridpoints = {`,
//! rows of position and value, `}`; `[C0Y]`, `VALUE = 0.00001`. Values are errors in mm and rad, positions mm and deg.

use super::form::TableForm;
use super::gather;
use super::request::ImportRequest;
use super::sample::{AxisSample, Import, UnusedColumn, refusal};
use super::unit::component_error;
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::identify::lists::index_of;
use crate::machine::{ErrorId, parse_error_name};
use crate::syntax::sheet::SheetLine;
use crate::units;

/// The entry of a constant, and the one that opens the rows of a curve.
const CONSTANT: &str = "VALUE";
const CURVE: &str = "GRIDPOINTS";

fn block(line: &str) -> Option<&str> {
    bare(line).strip_prefix('[')?.strip_suffix(']').map(str::trim)
}

/// Returns a line without the comment at its end.
fn bare(line: &str) -> &str {
    line.split("//").next().unwrap_or_default().trim()
}

fn entry(line: &str) -> Option<(String, &str)> {
    let (key, value) = bare(line).split_once('=')?;
    Some((key.trim().to_uppercase(), value.trim()))
}

/// True for a file of this layout.
pub(super) fn is(lines: &[SheetLine]) -> bool {
    lines.windows(2).any(|pair| {
        let known = |(key, _): (String, &str)| key == CONSTANT || key == CURVE;
        block(&pair[0].text).and_then(parse_error_name).is_some() && entry(&pair[1].text).is_some_and(known)
    })
}

#[derive(Default)]
struct Blocks {
    /// Curves, with the readings.
    curves: Vec<(ErrorId, Vec<(f64, f64)>)>,
    constants: Vec<(ErrorId, f64)>,
}

/// Reads the blocks of a file that begins at `place`.
pub(super) fn read(lines: &[SheetLine], place: &Place, wanted: &ImportRequest) -> Result<Import, Box<Diagnostic>> {
    let refuse = |message: String| Box::new(refusal(message, Some(place.clone())));
    let blocks = blocks(lines)?;
    let named = wanted.error.as_deref().map(component_error).transpose();
    let named = named.map_err(|failure| refuse(failure.to_string()))?;
    let mut axes: Vec<String> = Vec::new();
    for (error, _) in &blocks.curves {
        index_of(&mut axes, error.axis.to_string());
    }
    let given = wanted.axis.as_deref().map(str::to_uppercase).or(named.as_ref().map(|error| error.axis.to_string()));
    let axis = match (given, &axes[..]) {
        (Some(axis), _) => axis,
        (None, [axis]) => axis.clone(),
        (None, _) => {
            return Err(refuse(format!("the file has curves of axes {}: select one with `--axis`", axes.join(", "))));
        }
    };
    let rotary = axis.starts_with(['A', 'B', 'C']);
    let mut import = Import::empty(TableForm::Blocks, axis, rotary);
    for (error, value) in &blocks.constants {
        let amount = if error.direction.is_rotation() { units::angle(*value) } else { units::length(*value) };
        let reason = format!("a constant of {amount}: write `{error}: {amount}` into the machine file");
        import.unused_columns.push(UnusedColumn { title: error.to_string(), reason, known: true });
    }
    for (error, points) in blocks.curves {
        let unused = match (&named, error.axis.to_string() == import.axis) {
            (_, false) => "a curve of another axis",
            (Some(named), _) if *named != error => "not the error asked for",
            _ => "",
        };
        if !unused.is_empty() {
            let column = UnusedColumn { title: error.to_string(), reason: unused.to_owned(), known: true };
            import.unused_columns.push(column);
            continue;
        }
        let index = import.errors.len();
        import.errors.push(error);
        let sign = wanted.sign();
        import.samples.extend(points.iter().map(|(position, value)| AxisSample {
            error: index,
            position: *position,
            direction: None,
            run: String::new(),
            value: value * sign + 0.0,
            place: place.clone(),
        }));
    }
    if import.samples.is_empty() {
        return Err(refuse(format!("the file has no curve of axis {}{}", shown(&import.axis), wanted.of())));
    }
    gather::check_plausible(&import.samples, &import.errors).map_err(|failure| refuse(failure.to_string()))?;
    gather::finish(import, wanted, &[], place)
}

fn blocks(lines: &[SheetLine]) -> Result<Blocks, Box<Diagnostic>> {
    let mut found = Blocks::default();
    let mut name: Option<ErrorId> = None;
    let mut points: Option<Vec<(f64, f64)>> = None;
    for line in lines {
        let refuse = |message: String| Box::new(refusal(message, Some(line.place.clone())));
        let text = bare(&line.text);
        let number = |text: &str| units::number(text).map_err(|failure| refuse(failure.to_string()));
        if points.is_some() && (block(text).is_some() || text.contains('=')) {
            return Err(refuse("the curve before is not closed by `}`".to_owned()));
        }
        if let Some(title) = block(text) {
            let error = parse_error_name(title);
            name = Some(error.ok_or_else(|| refuse(format!("`{}` is not the name of an error", shown(title))))?);
        } else if text == "}" {
            let curve = name.clone().zip(points.take());
            found.curves.push(curve.ok_or_else(|| refuse("`}` closes nothing".to_owned()))?);
        } else if let Some((key, value)) = entry(text) {
            let error = name.clone().ok_or_else(|| refuse("an entry before the first `[NAME]`".to_owned()))?;
            match key.as_str() {
                CONSTANT => found.constants.push((error, number(value)?)),
                CURVE if value.starts_with('{') => points = Some(Vec::new()),
                _ => return Err(refuse(format!("`{}` is not understood", shown(&key)))),
            }
        } else if let (Some(points), [position, value]) =
            (&mut points, &text.split_whitespace().collect::<Vec<_>>()[..])
        {
            points.push((number(position)?, number(value)?));
        } else if !text.is_empty() {
            return Err(refuse("a line that is neither an entry nor a row of a curve".to_owned()));
        }
    }
    match points {
        Some(_) => Err(Box::new(refusal("the last curve is not closed by `}`".to_owned(), None))),
        None => Ok(found),
    }
}
