//! Rows to samples; what is left out, and why.

use super::header::{Header, Role, direction, fits, index, reading_unit};
use super::{Import, LeftOut, Sample, Wanted, error_name, refusal};
use crate::diagnostic::{Diagnostic, shown};
use crate::machine::ErrorId;
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Decimals, Line};

/// Farthest position (mm or deg) that is believed.
const FARTHEST: f64 = 1e6;
/// Largest reading (mm or rad): an error of the machine language.
const LARGEST: f64 = 10.0;

pub(super) fn gather(lines: &[Line], header: Header, wanted: &Wanted) -> Result<Import, Box<Diagnostic>> {
    let Header { form, axis, rotary, errors, roles, separator, body, metadata } = header;
    let mut import =
        Import { form, axis, rotary, errors, samples: Vec::new(), metadata, left_out: Vec::new(), inferred: false };
    let mut decimals = Decimals::default();
    for line in &lines[body..] {
        let cells = sheet::cells(&line.text, separator);
        for (cell, _) in cells.iter().zip(&roles).filter(|(_, role)| role.is_number()) {
            let noted = decimals.note(cell, separator);
            noted.map_err(|words| Box::new(refusal(words, Some(line.place.clone()))))?;
        }
        match row(&cells, &roles, separator, wanted, &mut import.errors, &import.axis) {
            Ok(samples) => import.samples.extend(samples),
            Err(reason) => import.left_out.push(LeftOut { place: line.place.clone(), reason }),
        }
    }
    if import.samples.is_empty() {
        let place = lines.get(body).or(lines.last()).map(|line| line.place.clone());
        let why = import.left_out.first().map(|first| format!("; the first row: {}", first.reason));
        return Err(Box::new(refusal(format!("the table has no row to use{}", why.unwrap_or_default()), place)));
    }
    if import.samples.iter().all(|sample| sample.direction.is_none()) {
        infer(&mut import);
    }
    Ok(import)
}

/// The samples of one row, or why it is left out.
fn row(
    cells: &[String],
    roles: &[Role],
    separator: char,
    wanted: &Wanted,
    errors: &mut Vec<ErrorId>,
    axis: &str,
) -> Result<Vec<Sample>, String> {
    // Spreadsheets leave empty cells at the end of a row.
    let bare = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    if bare > roles.len() {
        return Err(format!("{} cells under {} columns", cells.len(), roles.len()));
    }
    let number = |cell: &str| sheet::number(cell, separator).map_err(|failure| failure.to_string());
    let at = |k: usize| cells.get(k).map_or("", String::as_str);
    let mut common = Sample { error: 0, position: f64::NAN, direction: None, run: String::new(), value: 0.0 };
    let (mut name, mut unit, mut reading) = (None, None, None);
    for (k, role) in roles.iter().enumerate() {
        match role {
            Role::Excluded if !at(k).is_empty() && at(k) != "0" => return Err(format!("marked `{}`", shown(at(k)))),
            Role::Position(_) if at(k).is_empty() => return Err("no position".to_owned()),
            Role::Position(factor) => common.position = number(at(k))? * factor,
            Role::Run => common.run = at(k).to_owned(),
            Role::Direction => common.direction = way(at(k))?,
            Role::ErrorName => name = Some(at(k)),
            Role::Unit => unit = Some(at(k)),
            Role::Reading(known) => reading = Some((at(k), known)),
            _ => {}
        }
    }
    if common.position.abs() > FARTHEST {
        return Err(format!("the position {} is beyond 1000000 mm or deg", common.position));
    }
    if wanted.continuous {
        common.position = common.position.rem_euclid(360.0);
    }
    let sign = if wanted.correction { -1.0 } else { 1.0 };
    let sample = |error: usize, value: f64| match value * sign {
        value if value.abs() > LARGEST => Err(format!("a reading of {value} mm or rad is no error of a machine")),
        value => Ok(Sample { error, value: value + 0.0, ..common.clone() }),
    };
    if let Some((cell, known)) = reading {
        let name = name.unwrap_or_default();
        let error = error_name(name).ok_or_else(|| format!("`{}` is not a component error", shown(name)))?;
        if !error.axis.to_string().eq_ignore_ascii_case(axis) {
            return Err(format!("`{error}` is no error of axis {}", shown(axis)));
        }
        let own = unit.filter(|unit| !unit.is_empty()).map(reading_unit).transpose()?;
        let (factor, dimension) = own.or(*known).ok_or("the reading has no unit")?;
        fits(&error, dimension).map_err(|()| format!("not a unit of `{error}`"))?;
        let value = number(cell)? * factor;
        return Ok(vec![sample(index(errors, error), value)?]);
    }
    let mut samples = Vec::new();
    for (k, role) in roles.iter().enumerate() {
        let Role::Value { error, direction, run, factor } = role else { continue };
        if at(k).is_empty() {
            continue;
        }
        let mut sample = sample(*error, number(at(k))? * factor)?;
        sample.direction = direction.or(sample.direction);
        if !run.is_empty() {
            sample.run.clone_from(run);
        }
        samples.push(sample);
    }
    if samples.is_empty() { Err("nothing was measured in this row".to_owned()) } else { Ok(samples) }
}

fn way(cell: &str) -> Result<Option<ColumnDirection>, String> {
    match (cell, direction(cell).0) {
        ("", _) => Ok(None),
        (_, Some(way)) => Ok(Some(way)),
        _ => Err(format!("`{}` is no direction", shown(cell))),
    }
}

/// Directions from the order of the rows, where positions rise and fall: there and back, as lasers measure. At a
/// turning point the target is measured twice, or once: then it belongs to the way that ends there.
fn infer(import: &mut Import) {
    let count = import.errors.len();
    for error in 0..count {
        let of: Vec<usize> = (0..import.samples.len()).filter(|i| import.samples[*i].error == error).collect();
        let at = |k: usize| import.samples[of[k]].position;
        let step = |k: usize| (at(k) - at(k - 1)).partial_cmp(&0.0).unwrap_or(std::cmp::Ordering::Equal);
        let steps: Vec<std::cmp::Ordering> = (1..of.len()).map(step).collect();
        let falls = steps.iter().any(|s| s.is_lt());
        let rises = steps.iter().any(|s| s.is_gt());
        if !(falls && rises) {
            continue;
        }
        // A jump back to the start of the next run in one direction is not a way that was measured.
        if steps.iter().filter(|s| s.is_lt()).count() * 4 < steps.len()
            && !steps.windows(2).any(|w| w[0].is_lt() && w[1].is_lt())
        {
            continue;
        }
        let next = |k: usize| steps[k..].iter().find(|s| s.is_ne()).copied();
        let mut ways: Vec<Option<ColumnDirection>> = Vec::with_capacity(of.len());
        for k in 0..of.len() {
            let came = if k == 0 || steps[k - 1].is_eq() {
                next(k.min(steps.len().saturating_sub(1)))
            } else {
                Some(steps[k - 1])
            };
            let came = came.or_else(|| steps.iter().rev().find(|s| s.is_ne()).copied());
            ways.push(came.map(|s| if s.is_gt() { ColumnDirection::Forward } else { ColumnDirection::Reverse }));
        }
        number_runs(import, &of, &ways);
        import.inferred = true;
    }
}

/// Every way back and forth is a run of its own, if the file names none.
fn number_runs(import: &mut Import, of: &[usize], ways: &[Option<ColumnDirection>]) {
    let mut run = 1;
    let mut seen: Vec<ColumnDirection> = Vec::new();
    let mut last = None;
    for (i, way) in of.iter().zip(ways) {
        let Some(way) = *way else { continue };
        if last != Some(way) {
            if seen.contains(&way) {
                run += 1;
                seen.clear();
            }
            seen.push(way);
            last = Some(way);
        }
        let sample = &mut import.samples[*i];
        sample.direction = Some(way);
        if sample.run.is_empty() {
            sample.run = run.to_string();
        }
    }
}
