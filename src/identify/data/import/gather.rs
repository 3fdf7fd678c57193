//! Rows to samples; what is left out, and why.

use super::failure::RowFailure;
use super::header::{Header, Role, Series};
use super::layout::{Layout, Meaning};
use super::options::RunApproach;
use super::order;
use super::request::ImportRequest;
use super::sample::{Import, Sample, UnusedRow, refusal};
use super::unit::{component_error, own_axis, reading_unit};
use crate::diagnostic::{Diagnostic, Place};
use crate::identify::data::error_name::parse_component_error;
use crate::identify::lists::index_of;
use crate::machine::{AxisName, ErrorId};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Decimals, SheetLine};
use crate::units::FARTHEST;

/// Largest readings (mm, rad) that are believed.
const LARGEST: (f64, f64) = (10.0, 0.1);

pub(super) fn gather(lines: &[SheetLine], header: &Header, wanted: &ImportRequest) -> Result<Import, Box<Diagnostic>> {
    let by_row = header.roles.contains(&Role::Other(Meaning::Direction));
    let mut import = Import {
        errors: header.errors.clone(),
        metadata: header.metadata.clone(),
        unused_columns: header.unused.clone(),
        channels: header.channels.clone(),
        ..Import::empty(header.form, header.axis.clone(), header.rotary)
    };
    let beside = if by_row { Vec::new() } else { runs_beside(&header.roles) };
    let mut open = Vec::new();
    let mut decimals = Decimals::default();
    let mut marked: Vec<Option<bool>> = Vec::new();
    for line in &lines[header.body..] {
        let mut cells = sheet::cells(&line.text, header.separator);
        sheet::drop_empty(&mut cells, header.roles.len());
        for (cell, _) in cells.iter().zip(&header.roles).filter(|(_, role)| role.is_number()) {
            let noted = decimals.note(cell, header.separator);
            noted.map_err(|mixed| Box::new(refusal(mixed.to_string(), Some(line.place.clone()))))?;
        }
        match row(&cells, header, wanted, &beside, &mut import) {
            Ok(samples) => {
                let is_open = header.roles.iter().any(|role| matches!(role, Role::Open(_)));
                if is_open {
                    open.extend(import.samples.len()..import.samples.len() + samples.len());
                } else {
                    believed(&samples, &import.errors)
                        .map_err(|failure| Box::new(too_large(failure.to_string(), &line.place)))?;
                }
                let at = if by_row { &line.place } else { &header.place };
                agree(&samples, &mut marked).map_err(|error| Box::new(half_marked(&import.errors[error], at)))?;
                import.samples.extend(samples);
            }
            Err(failure) => {
                import.left_out.push(UnusedRow { place: line.place.clone(), reason: failure.to_string() });
            }
        }
    }
    if import.samples.is_empty() {
        let place = lines.get(header.body).or(lines.last()).map(|line| line.place.clone());
        let why = import.left_out.first().map(|first| format!("; the first row: {}", first.reason));
        return Err(Box::new(refusal(
            format!("the table has no row to use{}{}", wanted.of(), why.unwrap_or_default()),
            place,
        )));
    }
    if !open.is_empty() && follows_targets(&import) {
        import.samples.iter_mut().for_each(|sample| sample.value = reached(sample, header.rotary));
    }
    believed(&import.samples, &import.errors)
        .map_err(|failure| Box::new(too_large(failure.to_string(), &header.place)))?;
    finish(import, wanted, &beside, &header.place)
}

/// Errors that have several columns without a direction: the order of the rows is not that of time.
fn runs_beside(roles: &[Role]) -> Vec<usize> {
    let series = roles.iter().filter_map(Role::series).filter(|series| series.label.direction.is_none());
    let mut errors: Vec<usize> = series.map(|series| series.error).collect();
    errors.sort_unstable();
    let several = errors.chunk_by(|a, b| a == b).filter(|group| group.len() > 1);
    several.map(|group| group[0]).collect()
}

/// Puts positions on targets and finds the directions; `beside` are the errors with runs beside each other.
pub(super) fn finish(
    mut import: Import,
    wanted: &ImportRequest,
    beside: &[usize],
    place: &Place,
) -> Result<Import, Box<Diagnostic>> {
    // Targets and directions are those of the positions as programmed: a turn ends where it began only afterwards.
    let near = order::merge(&mut import.samples);
    for error in 0..import.errors.len() {
        let of_error = || import.samples.iter().filter(|sample| sample.error == error);
        let turns = order::take_turns(of_error());
        if of_error().any(|sample| sample.direction.is_some()) || !(turns || beside.contains(&error)) {
            continue;
        }
        match wanted.approach {
            Some(RunApproach::Alternating) => order::alternate(&mut import.samples, error),
            Some(RunApproach::OneWay) => {}
            None if turns || !order::go_there_and_back(&import.samples, error) => {
                return Err(Box::new(unknown_approach(&import.errors[error], place)));
            }
            None => {}
        }
    }
    order::passes(&mut import);
    if wanted.continuous {
        order::wrap(&mut import.samples, near);
    }
    Ok(import)
}

/// Several runs of which nothing says the direction: their mean would hide the reversal.
fn unknown_approach(error: &ErrorId, place: &Place) -> Diagnostic {
    let message = format!("the file has several runs of `{error}` and does not say from which side they approached");
    let help = "name the directions (`1+`, `1-`, `2+` ...), or say `--runs alternating` (the first forward, the second \
                in reverse, and so on) or `--runs one-way`";
    refusal(message, Some(place.clone())).help(help)
}

/// True if readings grow as the targets do: then they are positions, and deviations would be a metre in a metre.
fn follows_targets(import: &Import) -> bool {
    let unit = if import.rotary { 1_f64.to_radians() } else { 1.0 };
    let n = import.samples.len() as f64;
    let mean = |of: &dyn Fn(&Sample) -> f64| import.samples.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|s| s.position), mean(&|s| s.value / unit));
    let square = mean(&|s| (s.position - x) * (s.position - x));
    let slope = mean(&|s| (s.position - x) * (s.value / unit - y)) / square;
    (slope - 1.0).abs() < 0.1
}

/// The deviation of a reading that is a position.
fn reached(sample: &Sample, rotary: bool) -> f64 {
    let at = if rotary { sample.value.to_degrees() } else { sample.value };
    off_target(at - sample.position, rotary)
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
    let help =
        "mark all runs (`1+`, `1-`, `2+` ...; `V1`, `R1` ...) or none: then the order of the rows gives the directions";
    refusal(message, Some(place.clone())).help(help)
}

/// Readings that no machine shows are of another unit, or of another column: no row of its own is at fault.
pub(super) fn believed(samples: &[Sample], errors: &[ErrorId]) -> Result<(), RowFailure> {
    let turns = |sample: &Sample| errors[sample.error].direction.is_rotation();
    let unit = |sample: &Sample| if turns(sample) { (LARGEST.1, "rad") } else { (LARGEST.0, "mm") };
    let far = samples.iter().find(|sample| sample.value.abs() > unit(sample).0);
    far.map_or(Ok(()), |far| Err(RowFailure::TooLarge(far.value, unit(far).1)))
}

fn too_large(message: String, place: &Place) -> Diagnostic {
    let help = "correct the unit in the header; a column of the positions that were reached is called `actual [mm]`; \
                mark a row that is not to be used in a column `exclude`";
    refusal(message, Some(place.clone())).help(help)
}

/// Returns the samples of one row.
fn row(
    cells: &[String],
    header: &Header,
    wanted: &ImportRequest,
    beside: &[usize],
    import: &mut Import,
) -> Result<Vec<Sample>, RowFailure> {
    let Header { roles, separator, .. } = header;
    if cells.len() > roles.len() {
        return Err(RowFailure::Cells(cells.len(), roles.len()));
    }
    let at = |k: usize| cells.get(k).map_or("", String::as_str);
    let mut common = Sample { error: 0, position: f64::NAN, direction: None, run: String::new(), value: 0.0 };
    let (mut name, mut unit, mut reading) = ("", "", None);
    for (k, role) in roles.iter().enumerate() {
        let cell = at(k);
        match role {
            Role::Position(_) if cell.is_empty() => return Err(RowFailure::NoPosition),
            Role::Position(factor) => common.position = sheet::number(cell, *separator)? * factor,
            Role::Reading(unit) => reading = Some((cell, unit)),
            Role::Other(Meaning::Excluded) if !["", "0"].contains(&cell) => {
                return Err(RowFailure::Excluded(cell.to_owned()));
            }
            Role::Other(Meaning::Axis) if is_other_axis(cell, &import.axis) => {
                return Err(RowFailure::OtherAxis(cell.to_owned()));
            }
            Role::Other(Meaning::Run) => common.run = cell.to_owned(),
            Role::Other(Meaning::Direction) => common.direction = direction(cell, header.layout)?,
            Role::Other(Meaning::ErrorName) => name = cell,
            Role::Other(Meaning::Unit) => unit = cell,
            _ => {}
        }
    }
    if common.position.abs() > FARTHEST {
        return Err(RowFailure::Far(common.position));
    }
    let sign = wanted.sign();
    let sample = |error: usize, value: f64| Sample { error, value: value * sign + 0.0, ..common.clone() };
    if let Some((cell, known)) = reading {
        let error = error_of_row(name, wanted, &import.axis)?;
        let own = if unit.is_empty() { None } else { Some(reading_unit(unit)?) };
        let unit = own.or(*known).ok_or(RowFailure::NoUnit)?;
        if !unit.fits(&error) {
            return Err(RowFailure::NotUnitOf(error));
        }
        let value = sheet::number(cell, *separator)? * unit.factor;
        return Ok(vec![sample(index_of(&mut import.errors, error), value)]);
    }
    let mut samples = Vec::new();
    for (k, role) in roles.iter().enumerate().filter(|(k, _)| !at(*k).is_empty()) {
        let Some(series) = role.series() else { continue };
        let read = sheet::number(at(k), *separator)? * series.factor;
        let value = if let Role::Reached(_) = role { off_target(read - common.position, import.rotary) } else { read };
        let mut found = labelled(sample(series.error, value), series);
        if found.run.is_empty() && beside.contains(&series.error) {
            found.run = format!("column {}", k + 1);
        }
        samples.push(found);
    }
    if samples.is_empty() { Err(RowFailure::NoReading) } else { Ok(samples) }
}

/// True for the name of an axis other than the one that moved.
fn is_other_axis(cell: &str, axis: &str) -> bool {
    !cell.eq_ignore_ascii_case(axis) && AxisName::new(&cell.to_uppercase()).is_some()
}

/// The error that a row names.
fn error_of_row(name: &str, wanted: &ImportRequest, axis: &str) -> Result<ErrorId, RowFailure> {
    let error = component_error(name)?;
    own_axis(&error, axis)?;
    if wanted.error.as_deref().and_then(parse_component_error).is_some_and(|wanted| wanted != error) {
        return Err(RowFailure::OtherError(error));
    }
    Ok(error)
}

/// Distance from a target (mm or rad). No error is a turn: encoders count from 0 again, or from -180.
pub(super) fn off_target(off: f64, rotary: bool) -> f64 {
    if rotary { (off - 360.0 * libm::round(off / 360.0)).to_radians() } else { off }
}

/// A sample with direction and run as the title of its column has them.
fn labelled(mut sample: Sample, series: &Series) -> Sample {
    sample.direction = series.label.direction.or(sample.direction);
    if !series.label.run.is_empty() {
        sample.run.clone_from(&series.label.run);
    }
    sample
}

fn direction(cell: &str, layout: &Layout) -> Result<Option<ColumnDirection>, RowFailure> {
    match (cell, layout.label(cell, true).direction) {
        ("", _) => Ok(None),
        // As control systems write it, beside `-1`.
        ("1", _) => Ok(Some(ColumnDirection::Forward)),
        (_, Some(direction)) => Ok(Some(direction)),
        _ => Err(RowFailure::NotDirection(cell.to_owned())),
    }
}
