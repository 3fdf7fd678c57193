//! Rows to samples; what is left out, and why.

use super::failure::SampleFailure;
use super::header::{ColumnRole, ImportHeader, Series};
use super::layout::{ColumnMeaning, ExportLayout};
use super::line::line;
use super::options::{RunApproach, StraightnessLine};
use super::order;
use super::request::ImportRequest;
use super::sample::{AxisSample, Import, UnusedRow, refusal};
use super::suspicion::rows::{self, LostRows, PositionMarks, RowTexts};
use super::unit::{component_error, own_axis, reading_unit};
use crate::diagnostic::{Diagnostic, Place};
use crate::identify::lists::index_of;
use crate::machine::{AxisName, ErrorId, largest};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Decimals, SheetLine};
use crate::units::FARTHEST;

pub(super) fn gather(
    lines: &[SheetLine],
    header: &ImportHeader,
    wanted: &ImportRequest,
) -> Result<Import, Box<Diagnostic>> {
    let by_row = header.roles.contains(&ColumnRole::Other(ColumnMeaning::Direction));
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
    let (mut lost, mut texts, mut marks) = (LostRows::default(), RowTexts::default(), PositionMarks::default());
    let named = header.names_runs();
    let position = header.roles.iter().position(|role| matches!(role, ColumnRole::Position(_))).unwrap_or(0);
    let mut fewest = usize::MAX;
    for (i, line) in lines.iter().enumerate().skip(header.body) {
        let mut cells = sheet::cells(&line.text, header.separator);
        let written = cells.len();
        sheet::drop_empty(&mut cells, header.roles.len());
        let numbers = || cells.iter().zip(&header.roles).filter(|(_, role)| role.is_number()).map(|(cell, _)| cell);
        for cell in numbers() {
            let noted = decimals.note(cell, header.separator);
            noted.map_err(|mixed| Box::new(refusal(mixed.to_string(), Some(line.place.clone()))))?;
        }
        rows::check_numbers(line, numbers(), header.separator)?;
        let at_position = cells.get(position).map_or("", String::as_str);
        let is_cut = i + 1 == lines.len() && i > header.body + 2 && written < fewest && fewest < usize::MAX;
        let found = match is_cut {
            true => Err(SampleFailure::Cut(written, fewest)),
            false => row(&cells, header, wanted, &beside, &line.place, &mut import),
        };
        match found {
            Ok(samples) => {
                fewest = fewest.min(written);
                lost.read();
                if texts.is_again(line, &cells, samples.len(), named) && !wanted.accepts_suspect {
                    continue;
                }
                marks.note(at_position, samples[0].position, &line.place);
                let is_open = header.roles.iter().any(|role| matches!(role, ColumnRole::Open(_)));
                if is_open {
                    open.extend(import.samples.len()..import.samples.len() + samples.len());
                } else {
                    check_plausible(&samples, &import.errors)
                        .map_err(|failure| Box::new(too_large(failure.to_string(), &line.place)))?;
                }
                let at = if by_row { &line.place } else { &header.place };
                agree(&samples, &mut marked).map_err(|error| Box::new(mixed_directions(&import.errors[error], at)))?;
                import.samples.extend(samples);
            }
            Err(failure) => {
                lost.lose(&failure, at_position, &line.place);
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
    marks.check()?;
    import.findings.extend(lost.finding().into_iter().chain(texts.finding()));
    if !open.is_empty() && follows_targets(&import) {
        import.samples.iter_mut().for_each(|sample| sample.value = deviation_of_position(sample, header.rotary));
    }
    check_plausible(&import.samples, &import.errors)
        .map_err(|failure| Box::new(too_large(failure.to_string(), &header.place)))?;
    let columns = rows::exchanged_columns(&import).or_else(|| rows::targets_twice(&import));
    import.findings.extend(columns);
    finish(import, wanted, &beside, &header.place)
}

/// Returns the errors with several columns without a direction: the order of their rows is not that of time.
fn runs_beside(roles: &[ColumnRole]) -> Vec<usize> {
    let series = roles.iter().filter_map(ColumnRole::series).filter(|series| series.label.direction.is_none());
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

/// Refuses several runs without a direction: their mean would hide the reversal.
fn unknown_approach(error: &ErrorId, place: &Place) -> Diagnostic {
    let message = format!("the file has several runs of `{error}` and does not say from which side they approached");
    let help = "name the directions (`1+`, `1-`, `2+` ...), or say `--runs alternating` (the first forward, the second \
                in reverse, and so on) or `--runs one-way`";
    refusal(message, Some(place.clone())).help(help)
}

/// True if readings grow as the targets do: then they are positions, and deviations would be a metre in a metre.
fn follows_targets(import: &Import) -> bool {
    let unit = if import.rotary { 1_f64.to_radians() } else { 1.0 };
    let points: Vec<(f64, f64)> = import.samples.iter().map(|s| (s.position, s.value / unit)).collect();
    (line(&points, StraightnessLine::LeastSquares).0 - 1.0).abs() < 0.1
}

fn deviation_of_position(sample: &AxisSample, rotary: bool) -> f64 {
    let at = if rotary { sample.value.to_degrees() } else { sample.value };
    off_target(at - sample.position, rotary)
}

/// Checks that all readings of an error have a direction, or none; fails with the error of which some have.
fn agree(samples: &[AxisSample], marked: &mut Vec<Option<bool>>) -> Result<(), usize> {
    for sample in samples {
        marked.resize(marked.len().max(sample.error + 1), None);
        if *marked[sample.error].get_or_insert(sample.direction.is_some()) != sample.direction.is_some() {
            return Err(sample.error);
        }
    }
    Ok(())
}

fn mixed_directions(error: &ErrorId, place: &Place) -> Diagnostic {
    let message = format!("some readings of `{error}` have a direction and others have none");
    let help =
        "mark all runs (`1+`, `1-`, `2+` ...; `V1`, `R1` ...) or none: then the order of the rows gives the directions";
    refusal(message, Some(place.clone())).help(help)
}

/// Refuses readings larger than any error of a machine: they are of another unit, or of another column.
pub(super) fn check_plausible(samples: &[AxisSample], errors: &[ErrorId]) -> Result<(), SampleFailure> {
    let direction = |sample: &AxisSample| errors[sample.error].direction;
    let far = samples.iter().find(|sample| sample.value.abs() > largest(direction(sample)));
    let unit = |sample: &AxisSample| if direction(sample).is_rotation() { "rad" } else { "mm" };
    far.map_or(Ok(()), |far| Err(SampleFailure::TooLarge(far.value, unit(far))))
}

fn too_large(message: String, place: &Place) -> Diagnostic {
    let help = "correct the unit in the header; a column of the positions that were reached is called `actual [mm]`, \
                those of runs `actual 1+ [mm]`; mark a row that is not to be used in a column `exclude`";
    refusal(message, Some(place.clone())).help(help)
}

fn row(
    cells: &[String],
    header: &ImportHeader,
    wanted: &ImportRequest,
    beside: &[usize],
    place: &Place,
    import: &mut Import,
) -> Result<Vec<AxisSample>, SampleFailure> {
    let ImportHeader { roles, separator, .. } = header;
    if cells.len() > roles.len() {
        return Err(SampleFailure::Cells(cells.len(), roles.len()));
    }
    let at = |k: usize| cells.get(k).map_or("", String::as_str);
    let mut common = AxisSample {
        error: 0,
        position: f64::NAN,
        direction: None,
        run: String::new(),
        value: 0.0,
        place: place.clone(),
    };
    let (mut name, mut unit, mut reading) = ("", "", None);
    for (k, role) in roles.iter().enumerate() {
        let cell = at(k);
        match role {
            ColumnRole::Position(_) if cell.is_empty() => return Err(SampleFailure::NoPosition),
            ColumnRole::Position(factor) => common.position = sheet::number(cell, *separator)? * factor,
            ColumnRole::Reading(unit) => reading = Some((cell, unit)),
            ColumnRole::Other(ColumnMeaning::Excluded) if !["", "0"].contains(&cell) => {
                return Err(SampleFailure::Excluded(cell.to_owned()));
            }
            ColumnRole::Other(ColumnMeaning::Axis) if is_other_axis(cell, &import.axis) => {
                return Err(SampleFailure::OtherAxis(cell.to_owned()));
            }
            ColumnRole::Other(ColumnMeaning::Run) => common.run = cell.to_owned(),
            ColumnRole::Other(ColumnMeaning::Direction) => common.direction = direction(cell, header.layout)?,
            ColumnRole::Other(ColumnMeaning::ErrorName) => name = cell,
            ColumnRole::Other(ColumnMeaning::Unit) => unit = cell,
            _ => {}
        }
    }
    if common.position.abs() > FARTHEST {
        return Err(SampleFailure::Far(common.position));
    }
    let sign = wanted.sign();
    let sample = |error: usize, value: f64| AxisSample { error, value: value * sign + 0.0, ..common.clone() };
    if let Some((cell, known)) = reading {
        let error = error_of_row(name, wanted, &import.axis)?;
        let own = if unit.is_empty() { None } else { Some(reading_unit(unit)?) };
        let unit = own.or(*known).ok_or(SampleFailure::NoUnit)?;
        if !unit.fits(&error) {
            return Err(SampleFailure::NotUnitOf(error));
        }
        let value = sheet::number(cell, *separator)? * unit.factor;
        return Ok(vec![sample(index_of(&mut import.errors, error), value)]);
    }
    let mut samples = Vec::new();
    for (k, role) in roles.iter().enumerate().filter(|(k, _)| !at(*k).is_empty()) {
        let Some(series) = role.series() else { continue };
        let read = sheet::number(at(k), *separator)? * series.factor;
        let value =
            if let ColumnRole::Reached(_) = role { off_target(read - common.position, import.rotary) } else { read };
        let mut found = with_label(sample(series.error, value), series);
        if found.run.is_empty() && beside.contains(&series.error) {
            found.run = format!("column {}", k + 1);
        }
        samples.push(found);
    }
    if samples.is_empty() { Err(SampleFailure::NoReading) } else { Ok(samples) }
}

/// True for the name of an axis other than the one that moved.
fn is_other_axis(cell: &str, axis: &str) -> bool {
    !cell.eq_ignore_ascii_case(axis) && AxisName::new(&cell.to_uppercase()).is_some()
}

fn error_of_row(name: &str, wanted: &ImportRequest, axis: &str) -> Result<ErrorId, SampleFailure> {
    let error = component_error(name)?;
    own_axis(&error, axis)?;
    if wanted.excludes(&error) {
        return Err(SampleFailure::OtherError(error));
    }
    Ok(error)
}

/// Returns the distance from a target (mm or rad). No error is a turn: encoders count from 0 again, or from -180.
pub(super) fn off_target(off: f64, rotary: bool) -> f64 {
    if rotary { (off - 360.0 * libm::round(off / 360.0)).to_radians() } else { off }
}

/// Returns a sample with direction and run as the title of its column has them.
fn with_label(mut sample: AxisSample, series: &Series) -> AxisSample {
    sample.direction = series.label.direction.or(sample.direction);
    if !series.label.run.is_empty() {
        sample.run.clone_from(&series.label.run);
    }
    sample
}

fn direction(cell: &str, layout: &ExportLayout) -> Result<Option<ColumnDirection>, SampleFailure> {
    match (cell, layout.label(cell, true).direction) {
        ("", _) => Ok(None),
        // As control systems write it, beside `-1`.
        ("1", _) => Ok(Some(ColumnDirection::Forward)),
        (_, Some(direction)) => Ok(Some(direction)),
        _ => Err(SampleFailure::NotDirection(cell.to_owned())),
    }
}
