//! Rows to samples; what is left out, and why.

use super::header::{Header, Role, component_error, direction, fits, index, own_axis, reading_unit};
use super::{Import, ImportRequest, LeftOut, Sample, error_name, order, refusal};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::machine::{AxisName, ErrorId};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Decimals, Line};

/// Farthest position (mm or deg) that is believed.
const FARTHEST: f64 = 1e6;
/// Largest readings (mm, rad) that are believed.
const LARGEST: (f64, f64) = (10.0, 0.1);

pub(crate) fn gather(lines: &[Line], header: Header, wanted: &ImportRequest) -> Result<Import, Box<Diagnostic>> {
    let Header { form, axis, rotary, errors, roles, separator, place, body, metadata, .. } = header;
    let mut import =
        Import { form, axis, rotary, errors, samples: Vec::new(), metadata, left_out: Vec::new(), inferred: false };
    let mut decimals = Decimals::default();
    let by_row = roles.contains(&Role::Direction);
    let mut marked: Vec<Option<bool>> = Vec::new();
    for line in &lines[body..] {
        let mut cells = sheet::cells(&line.text, separator);
        sheet::drop_empty(&mut cells, roles.len());
        for (cell, _) in cells.iter().zip(&roles).filter(|(_, role)| role.is_number()) {
            let noted = decimals.note(cell, separator);
            noted.map_err(|mixed| Box::new(refusal(mixed.to_string(), Some(line.place.clone()))))?;
        }
        match row(&cells, &roles, separator, wanted, &mut import) {
            Ok(samples) => {
                believed(&samples, &import.errors).map_err(|why| Box::new(too_large(why, &line.place)))?;
                let at = if by_row { &line.place } else { &place };
                agree(&samples, &mut marked).map_err(|error| Box::new(half_marked(&import.errors[error], at)))?;
                import.samples.extend(samples);
            }
            Err(reason) => import.left_out.push(LeftOut { place: line.place.clone(), reason }),
        }
    }
    if import.samples.is_empty() {
        let place = lines.get(body).or(lines.last()).map(|line| line.place.clone());
        let why = import.left_out.first().map(|first| format!("; the first row: {}", first.reason));
        return Err(Box::new(refusal(
            format!("the table has no row to use{}{}", wanted.of(), why.unwrap_or_default()),
            place,
        )));
    }
    // Targets and directions are those of the positions as programmed: a turn ends where it began only afterwards.
    let near = order::merge(&mut import.samples);
    order::passes(&mut import);
    if wanted.continuous {
        order::wrap(&mut import.samples, near);
    }
    Ok(import)
}

/// Directions are known of all readings of an error or of none; gives the error of which they are not.
fn agree(samples: &[Sample], marked: &mut Vec<Option<bool>>) -> Result<(), usize> {
    for sample in samples {
        marked.resize(marked.len().max(sample.error + 1), None);
        if *marked[sample.error].get_or_insert(sample.direction.is_some()) != sample.direction.is_some() {
            return Err(sample.error);
        }
    }
    Ok(())
}

fn half_marked(error: &ErrorId, place: &Place) -> Diagnostic {
    let message = format!("some readings of `{error}` have a direction and others have none");
    let help = "mark all runs (`1+`, `1-`, `2+` ...; `V1`, `R1` ...) or none: then the order of the rows says it";
    refusal(message, Some(place.clone())).help(help)
}

/// Readings that no machine shows are of another unit, or of another column: no row of its own is at fault.
fn believed(samples: &[Sample], errors: &[ErrorId]) -> Result<(), String> {
    let turns = |sample: &Sample| errors[sample.error].direction.is_rotation();
    let unit = |sample: &Sample| if turns(sample) { (LARGEST.1, "rad") } else { (LARGEST.0, "mm") };
    let far = samples.iter().find(|sample| sample.value.abs() > unit(sample).0);
    far.map_or(Ok(()), |far| Err(format!("a reading of {} {} is no error of a machine", far.value, unit(far).1)))
}

fn too_large(message: String, place: &Place) -> Diagnostic {
    let help = "correct the unit in the header; a column of the positions that were reached is called `actual [mm]`; \
                mark a row that is not to be used in a column `exclude`";
    refusal(message, Some(place.clone())).help(help)
}

/// The samples of one row, or why it is left out.
fn row(
    cells: &[String],
    roles: &[Role],
    separator: char,
    wanted: &ImportRequest,
    import: &mut Import,
) -> Result<Vec<Sample>, String> {
    let Import { errors, axis, rotary, .. } = import;
    if cells.len() > roles.len() {
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
            Role::Axis if !at(k).eq_ignore_ascii_case(axis) && AxisName::new(&at(k).to_uppercase()).is_some() => {
                return Err(format!("a row of axis {}", shown(at(k))));
            }
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
    let sign = if wanted.correction { -1.0 } else { 1.0 };
    let sample = |error: usize, value: f64| Sample { error, value: value * sign + 0.0, ..common.clone() };
    if let Some((cell, known)) = reading {
        let name = name.unwrap_or_default();
        let error = component_error(name)?;
        own_axis(&error, axis)?;
        if wanted.error.as_deref().and_then(error_name).is_some_and(|wanted| wanted != error) {
            return Err(format!("a reading of {error}"));
        }
        let own = unit.filter(|unit| !unit.is_empty()).map(reading_unit).transpose()?;
        let (factor, dimension) = own.or(*known).ok_or("the reading has no unit")?;
        fits(&error, dimension).map_err(|()| format!("not a unit of `{error}`"))?;
        let value = number(cell)? * factor;
        return Ok(vec![sample(index(errors, error), value)]);
    }
    let mut samples = Vec::new();
    for (k, role) in roles.iter().enumerate() {
        let (error, direction, run, value) = match role {
            _ if at(k).is_empty() => continue,
            Role::Value { error, direction, run, factor } => (error, direction, run, number(at(k))? * factor),
            Role::Reached { error, direction, run, factor } => {
                let off = number(at(k))? * factor - common.position;
                // No error is a turn: encoders count from 0 again, or from -180.
                let off = if *rotary { (off - 360.0 * libm::round(off / 360.0)).to_radians() } else { off };
                (error, direction, run, off)
            }
            _ => continue,
        };
        let mut sample = sample(*error, value);
        sample.direction = direction.or(sample.direction);
        if !run.is_empty() {
            sample.run.clone_from(run);
        }
        samples.push(sample);
    }
    if samples.is_empty() { Err("nothing was measured in this row".to_owned()) } else { Ok(samples) }
}

fn way(cell: &str) -> Result<Option<ColumnDirection>, String> {
    match (cell, direction(cell, true).0) {
        ("", _) => Ok(None),
        (_, Some(way)) => Ok(Some(way)),
        _ => Err(format!("`{}` is no direction", shown(cell))),
    }
}
