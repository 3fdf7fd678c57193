//! The header: beginning of the table, roles of its columns, and the metadata before it.

use super::channels::{self, InstrumentChannel};
use super::columns::{ColumnMap, MappedColumn};
use super::failure::ExportFailure;
use super::form::TableForm;
use super::layout::{ColumnMeaning, ExportLayout, GENERAL, RunLabel};
use super::request::ImportRequest;
use super::sample::{NamedChannel, UnusedColumn, refusal};
use super::titles::{self, Title};
use super::unit::{ReadingUnit, component_error, own_axis, own_error, position_unit, reading_unit};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::identify::data::error_name::{parse_component_error, split_direction};
use crate::identify::lists::index_of;
use crate::machine::{Approach, AxisName, ErrorId};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, SheetLine};

/// Lines before the table, at most.
const MAX_PREAMBLE_LINES: usize = 500;

/// Readings of one column: index of the error, direction and run by title, factor to mm or rad.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub error: usize,
    pub label: RunLabel,
    pub factor: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum ColumnRole {
    /// Positions of targets, with the factor to mm or deg.
    Position(f64),
    /// Deviations.
    Deviation(Series),
    /// Positions that were reached: their differences from the targets are the readings.
    Reached(Series),
    /// Deviations or positions that were reached: the numbers show which.
    Open(Series),
    /// Readings in the unit of their row, or in this one.
    Reading(Option<ReadingUnit>),
    Other(ColumnMeaning),
}

impl ColumnRole {
    /// True for columns of numbers.
    pub fn is_number(&self) -> bool {
        !matches!(self, Self::Other(_))
    }

    /// Returns the readings of a column, by the title.
    pub fn series(&self) -> Option<&Series> {
        match self {
            Self::Deviation(series) | Self::Reached(series) | Self::Open(series) => Some(series),
            _ => None,
        }
    }
}

/// A header that was understood.
pub(super) struct ImportHeader {
    pub layout: &'static ExportLayout,
    pub form: TableForm,
    pub axis: String,
    /// True for a rotary axis.
    pub rotary: bool,
    pub errors: Vec<ErrorId>,
    pub roles: Vec<ColumnRole>,
    pub separator: char,
    pub place: Place,
    /// Index of the first line after it.
    pub body: usize,
    pub metadata: Vec<(String, String)>,
    /// Columns that are not used.
    pub unused: Vec<UnusedColumn>,
    pub channels: Vec<NamedChannel>,
    /// The channels that titles name.
    named: Vec<InstrumentChannel>,
    /// Factor of positions to mm or deg.
    pub factor: f64,
    /// True if letters such as `F1` and `R1` are directions.
    paired: bool,
}

/// Splits a line before the table: `key: value` or `key = value`, with a separator between as spreadsheets write it.
fn metadata(line: &str, separator: char) -> Option<(String, String)> {
    let (key, value) = line.split_once([':', '=']).or_else(|| line.split_once(separator))?;
    let tame =
        |text: &str| text.trim_matches(|c: char| c.is_whitespace() || [':', '"', separator].contains(&c)).to_owned();
    let (key, value) = (tame(key), tame(value));
    (!key.is_empty() && !value.is_empty()).then(|| (key.chars().take(80).collect(), value.chars().take(200).collect()))
}

/// True of the word for the axis in an entry or a title.
pub(super) fn is_axis(word: &str) -> bool {
    ["axis", "achse"].iter().any(|known| word.eq_ignore_ascii_case(known))
}

/// Returns the value of a key before the table.
fn entry<'m>(metadata: &'m [(String, String)], key: &str) -> Option<&'m str> {
    let is_key = |known: &str| known.eq_ignore_ascii_case(key) || (is_axis(known) && is_axis(key));
    metadata.iter().find(|(known, _)| is_key(known)).map(|(_, value)| value.as_str())
}

/// Returns the title of positions of a line that begins a table: of two cells or more, one of them a position.
fn begins(layout: &ExportLayout, cells: &[String], axis: Option<&str>, map: Option<&ColumnMap>) -> Option<Title> {
    let is_position = |title: &Title| {
        if let Some(map) = map {
            return ColumnMap::names(&map.position, &title.name, &title.cell);
        }
        layout.is_position(&title.lower)
            || axis.is_some_and(|axis| title.name.eq_ignore_ascii_case(axis))
            || (axis.is_none() && title.name.len() <= 2 && AxisName::new(&title.name).is_some())
    };
    // `axis; X` before the table is no header. Runs may be named by numbers, positions are words.
    let said = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    let is_entry = said == 2 && is_axis(&cells[0]);
    if cells.len() < 2 || is_entry { None } else { cells.iter().map(|cell| Title::new(cell)).find(is_position) }
}

/// Finds and reads the header of an export.
pub(super) fn find(lines: &[SheetLine], wanted: &ImportRequest) -> Result<ImportHeader, Box<Diagnostic>> {
    check_request(wanted).map_err(|failure| Box::new(refusal(failure.to_string(), None)))?;
    let layout = &GENERAL;
    let of_error = wanted.error_id().map(|error| error.axis.to_string());
    let mut known: Vec<(String, String)> = Vec::new();
    let mut other = None;
    for (i, line) in lines.iter().enumerate().take(MAX_PREAMBLE_LINES) {
        let separator = sheet::separator(&line.text);
        let cells = sheet::cells(&line.text, separator);
        let axis = wanted.axis.as_deref().or(entry(&known, "axis")).or(of_error.as_deref());
        let map = wanted.columns.as_ref();
        if begins(layout, &cells, axis, map).is_some() && (map.is_some() || !line.text.contains(": ")) {
            let reader = HeaderReader { layout, lines, wanted, metadata: &known, separator };
            let refuse = |failure: ExportFailure| Box::new(refusal(failure.to_string(), Some(line.place.clone())));
            return reader.header(i, &cells).map_err(refuse);
        }
        if let (None, Some(axis), Some(Title { name, unit: Some(_), .. })) =
            (&other, axis, begins(layout, &cells, None, map))
        {
            other = Some((axis.to_owned(), name, line.place.clone()));
        }
        known.extend(metadata(&line.text, separator));
    }
    Err(Box::new(match other {
        Some((axis, title, place)) => other_axis(&axis, &title, place),
        None => no_header(lines),
    }))
}

/// Returns the request holds whether or not the file states it too.
fn check_request(wanted: &ImportRequest) -> Result<(), ExportFailure> {
    wanted.error.as_deref().map(component_error).transpose()?;
    wanted.unit.as_deref().map(reading_unit).transpose()?;
    Ok(())
}

fn other_axis(axis: &str, title: &str, place: Place) -> Diagnostic {
    let (axis, title) = (shown(axis), shown(title));
    let message = format!("axis {axis} moved, but the positions of this header are those of `{title}`");
    let help = "correct the axis in the file, or name the axis that moved with `--axis`";
    refusal(message, Some(place)).help(help)
}

fn no_header(lines: &[SheetLine]) -> Diagnostic {
    let first = lines.first().map(|line| line.place.clone());
    refusal("there is no header with a position column".to_owned(), first)
}

/// The columns of runs, where there are positions that were reached.
enum RunColumns {
    /// There are none.
    NotReached,
    /// They are not those of the error that is asked for.
    OtherError,
    /// They are the readings.
    Reached(ErrorId),
    /// There are deviations too, which are the same readings.
    Deviations(ErrorId),
}

/// Refuses two columns of one run: their mean would be no reading of any run.
fn check_runs(header: &ImportHeader, titles: &[Title]) -> Result<(), ExportFailure> {
    let run = |role: &ColumnRole| role.series().map(|series| (series.error, series.label.clone()));
    let runs: Vec<Option<(usize, RunLabel)>> =
        header.roles.iter().map(|role| run(role).filter(|(_, label)| !label.run.is_empty())).collect();
    let again = |k: &usize| runs[*k].is_some() && runs[..*k].contains(&runs[*k]);
    let second = (0..runs.len()).find(again);
    second.map_or(Ok(()), |k| Err(ExportFailure::RunTwice(titles[k].cell.clone())))
}

impl ImportHeader {
    /// True if every reading has its run and its direction by name: then no row is there again.
    pub fn names_runs(&self) -> bool {
        let has = |meaning| self.roles.contains(&ColumnRole::Other(meaning));
        let by_column = has(ColumnMeaning::Run) && has(ColumnMeaning::Direction);
        let named = |series: &Series| series.label.direction.is_some() && !series.label.run.is_empty();
        let mut series = self.roles.iter().filter_map(ColumnRole::series).peekable();
        by_column || (series.peek().is_some() && series.all(named))
    }
}

struct HeaderReader<'a> {
    layout: &'static ExportLayout,
    lines: &'a [SheetLine],
    wanted: &'a ImportRequest,
    metadata: &'a [(String, String)],
    separator: char,
}

/// Returns the axis of the errors that have columns, if it is one: of `position; ECC [urad]` it is C.
fn only_axis(titles: &[Title]) -> Option<String> {
    let mut axes = titles.iter().filter_map(|title| Some(title.error()?.0.axis.to_string()));
    let first = axes.next()?;
    axes.all(|axis| axis == first).then_some(first)
}

impl HeaderReader<'_> {
    fn entry(&self, key: &str) -> Option<&str> {
        entry(self.metadata, key)
    }

    fn header(&self, at: usize, cells: &[String]) -> Result<ImportHeader, ExportFailure> {
        let (titles, rows_below) = titles::titles(self.lines, at, cells, self.separator, self.layout);
        let body = at + 1 + rows_below;
        let paired = self.layout.has_letter_pairs(titles.iter().map(|title| title.lower.as_str()));
        let axis = self.axis(&titles, body, paired)?;
        let is_position = |title: &Title| match &self.wanted.columns {
            Some(map) => ColumnMap::names(&map.position, &title.name, &title.cell),
            None => title.name.eq_ignore_ascii_case(&axis) || self.layout.is_position(&title.lower),
        };
        let position = titles.iter().position(is_position).ok_or(ExportFailure::NoPositions)?;
        let (rotary, factor) = match self.unit_of_positions(&titles[position])? {
            None => (axis.starts_with(['A', 'B', 'C']), 1.0),
            Some(unit) => position_unit(unit)?,
        };
        if self.wanted.continuous && !rotary {
            return Err(ExportFailure::LinearAxis(axis));
        }
        let mut header = ImportHeader {
            layout: self.layout,
            form: self.form(&titles),
            axis,
            rotary,
            factor,
            errors: Vec::new(),
            roles: Vec::new(),
            separator: self.separator,
            paired,
            place: self.lines[at].place.clone(),
            body,
            metadata: self.metadata.to_vec(),
            unused: Vec::new(),
            channels: Vec::new(),
            named: titles.iter().filter_map(|t| Some(channels::channel(&t.name, self.layout)?.0)).collect(),
        };
        self.roles(&mut header, &titles, position)?;
        Ok(header)
    }

    /// Returns the unit of the targets: of their title, of the mapping or the metadata.
    fn unit_of_positions<'u>(&'u self, title: &'u Title) -> Result<Option<&'u str>, ExportFailure> {
        let mapped = self.wanted.columns.as_ref().and_then(|map| map.position_unit.as_deref());
        match (title.unit.as_deref(), mapped) {
            (Some(own), Some(mapped)) if position_unit(own) != position_unit(mapped) => {
                Err(ExportFailure::OtherUnit(title.name.clone(), own.to_owned(), mapped.to_owned()))
            }
            (own, mapped) => Ok(own.or(mapped).or(self.entry("position unit"))),
        }
    }

    fn form(&self, titles: &[Title]) -> TableForm {
        let is_channel = |title: &Title| channels::channel(&title.name, self.layout).is_some();
        match (&self.wanted.columns, self.wanted.mounting) {
            (Some(_), _) => TableForm::Mapped,
            (None, Some(_)) if titles.iter().any(is_channel) => TableForm::Channels,
            _ => form(titles),
        }
    }

    /// Gives every column its role.
    fn roles(&self, header: &mut ImportHeader, titles: &[Title], position: usize) -> Result<(), ExportFailure> {
        let runs = if header.form == TableForm::Runs { self.runs(header, titles)? } else { RunColumns::NotReached };
        for (k, title) in titles.iter().enumerate() {
            let role =
                if k == position { ColumnRole::Position(header.factor) } else { self.role(header, title, &runs)? };
            header.roles.push(role);
        }
        self.check_between_runs(header, titles)?;
        check_runs(header, titles)?;
        self.check_names(header, titles)?;
        header.unused =
            titles.iter().zip(&header.roles).filter_map(|(title, role)| unused_column(title, role)).collect();
        let is_reading = |role: &ColumnRole| role.is_number() && !matches!(role, ColumnRole::Position(_));
        let any = header.roles.iter().any(is_reading);
        let mean = titles.iter().find(|title| self.layout.is_mean(&title.lower) && self.unit(title).is_some());
        match (any, mean) {
            (true, _) => Ok(()),
            (false, Some(mean)) => Err(ExportFailure::Means(mean.cell.clone())),
            (false, None) => Err(ExportFailure::NoReadings(self.wanted.error.clone())),
        }
    }

    /// Refuses a column between runs that no rule has: it could be one of them.
    fn check_between_runs(&self, header: &ImportHeader, titles: &[Title]) -> Result<(), ExportFailure> {
        let is_run = |role: &ColumnRole| role.series().is_some();
        let (Some(first), Some(last)) = (header.roles.iter().position(is_run), header.roles.iter().rposition(is_run))
        else {
            return Ok(());
        };
        let unknown = |k: &usize| header.roles[*k] == ColumnRole::Other(ColumnMeaning::Unknown);
        match (first..last).find(unknown).filter(|_| header.form == TableForm::Runs) {
            Some(k) => Err(ExportFailure::UnknownBetween(titles[k].cell.clone())),
            None => Ok(()),
        }
    }

    /// Refuses a mapping, or a list of flipped channels, that names columns which the table does not have.
    fn check_names(&self, header: &ImportHeader, titles: &[Title]) -> Result<(), ExportFailure> {
        let has = |name: &str| titles.iter().any(|title| ColumnMap::names(name, &title.name, &title.cell));
        let mapped = self.wanted.columns.iter().flat_map(|map| &map.columns);
        if let Some((name, _)) = mapped.into_iter().find(|(name, _)| !has(name)) {
            return Err(ExportFailure::NoMapped(name.clone()));
        }
        let is_channel = |name: &str| {
            let of = |found: &NamedChannel| ColumnMap::names(name, &Title::new(&found.title).name, &found.title);
            header.channels.iter().any(of)
        };
        match self.wanted.flipped.iter().find(|name| !is_channel(name)) {
            Some(name) => Err(ExportFailure::NoFlipped(name.clone())),
            None => Ok(()),
        }
    }

    /// Returns the unit of a column of readings: its own, or that of all that have none.
    fn unit<'u>(&'u self, title: &'u Title) -> Option<&'u str> {
        let own = title.unit.as_deref().or(self.wanted.unit.as_deref());
        own.or(self.entry("unit")).or(self.entry("units"))
    }

    /// Returns the label of a title such as `actual [mm]` in the unit of the targets; in another unit it is a
    /// deviation.
    fn actual_position_label(&self, header: &ImportHeader, title: &Title) -> Option<RunLabel> {
        let same = |unit: &str| position_unit(unit) == Ok((header.rotary, header.factor));
        self.layout.actual_position_label(&title.lower, header.paired).filter(|_| self.unit(title).is_none_or(same))
    }

    /// Looks for positions that were reached. They show the positioning error of the axis and no other one.
    fn runs(&self, header: &ImportHeader, titles: &[Title]) -> Result<RunColumns, ExportFailure> {
        let axis = &header.axis;
        let own = own_error(axis);
        let error = self.error()?;
        if !titles.iter().any(|title| self.actual_position_label(header, title).is_some()) {
            return Ok(RunColumns::NotReached);
        }
        let other = |error: &ErrorId| {
            error.direction.is_rotation() != header.rotary || own.as_ref().is_some_and(|own| own != error)
        };
        if error.as_ref().is_some_and(other) {
            return Ok(RunColumns::OtherError);
        }
        let error = error.or(own).ok_or(ExportFailure::NoError(None))?;
        own_axis(&error, axis)?;
        let deviations = titles.iter().any(|title| self.layout.is_deviation(&title.lower));
        Ok(if deviations { RunColumns::Deviations(error) } else { RunColumns::Reached(error) })
    }

    /// Returns the axes that the column `axis` names, each once, two at most.
    fn axes_of_rows(&self, titles: &[Title], body: usize) -> Vec<String> {
        let mut axes: Vec<String> = Vec::new();
        let Some(column) = titles.iter().position(|title| is_axis(&title.lower)) else { return axes };
        for line in &self.lines[body.min(self.lines.len())..] {
            let cells = sheet::cells(&line.text, self.separator);
            // Not a line of words below the table.
            let axis = cells.get(column).filter(|_| cells.len() == titles.len()).map(|cell| cell.to_uppercase());
            let named = axis.filter(|axis| AxisName::new(axis).is_some());
            axes.extend(named.filter(|axis| !axes.contains(axis) && axes.len() < 2));
        }
        axes
    }

    /// Returns the axis: as requested, of the metadata or a column, of the error requested, the only column that is
    /// named like one, or that of all errors that have columns.
    fn axis(&self, titles: &[Title], body: usize, paired: bool) -> Result<String, ExportFailure> {
        let own = |title: &Title| {
            let run = paired && self.layout.letter(&title.lower).is_some();
            let short = title.name.len() <= 2 && parse_component_error(&title.name).is_none() && !run;
            short.then(|| AxisName::new(&title.name)).flatten().map(|n| n.to_string())
        };
        let noted = self.entry("axis").map(str::to_uppercase).filter(|axis| AxisName::new(axis).is_some());
        if let (Some(noted), Some(wanted)) = (&noted, &self.wanted.axis)
            && !noted.eq_ignore_ascii_case(wanted)
        {
            return Err(ExportFailure::AxisNoted(noted.clone(), wanted.clone()));
        }
        let given = self.wanted.axis.clone().or_else(|| self.entry("axis").map(str::to_owned));
        let column = self.axes_of_rows(titles, body);
        if let ([one, other], None) = (&column[..], &given) {
            return Err(ExportFailure::TwoAxes(one.clone(), other.clone()));
        }
        let error = || self.wanted.error.as_deref().or(self.entry("error")).and_then(parse_component_error);
        let mapped = || self.wanted.columns.as_ref()?.errors().next().map(|error| error.axis.to_string());
        let beam = || self.wanted.mounting.map(|mounting| ["X", "Y", "Z"][mounting.along()].to_owned());
        let axis = given
            .or_else(|| column.first().cloned())
            .or_else(|| error().map(|error| error.axis.to_string()))
            .or_else(mapped)
            .or_else(|| titles.iter().find_map(own))
            .or_else(|| only_axis(titles))
            .or_else(beam);
        axis.map(|name| name.trim().to_uppercase()).ok_or(ExportFailure::NoAxis)
    }

    fn role(&self, header: &mut ImportHeader, title: &Title, runs: &RunColumns) -> Result<ColumnRole, ExportFailure> {
        if let Some(map) = &self.wanted.columns {
            return self.role_by_map(header, title, map);
        }
        match self.layout.meaning(&title.lower, header.form) {
            Some(ColumnMeaning::Value) => {
                let unit = title.unit.as_deref().or(self.wanted.unit.as_deref());
                return Ok(ColumnRole::Reading(unit.map(reading_unit).transpose()?));
            }
            Some(meaning) => return Ok(ColumnRole::Other(meaning)),
            None => {}
        }
        match header.form {
            TableForm::Wide => self.role_by_error(header, title),
            TableForm::Runs => self.role_by_run(header, title, runs),
            TableForm::Channels => self.role_by_channel(header, title),
            _ => Ok(self.not_a_reading(title)),
        }
    }

    /// Returns a column that is no reading: known by a word of its title, or unknown.
    fn not_a_reading(&self, title: &Title) -> ColumnRole {
        let known = self.layout.is_other(&title.lower)
            || self.layout.actual_position_label(&title.lower, true).is_some()
            || self.layout.is_position(&title.lower)
            || channels::channel(&title.name, self.layout).is_some()
            || title.error().is_some();
        ColumnRole::Other(if known { ColumnMeaning::Ignored } else { ColumnMeaning::Unknown })
    }

    fn role_by_map(
        &self,
        header: &mut ImportHeader,
        title: &Title,
        map: &ColumnMap,
    ) -> Result<ColumnRole, ExportFailure> {
        let of_title = |(name, _): &&(String, MappedColumn)| ColumnMap::names(name, &title.name, &title.cell);
        let (error, unit, label, flip, reached) = match map.columns.iter().find(of_title).map(|(_, column)| column) {
            Some(MappedColumn::Run) => return Ok(ColumnRole::Other(ColumnMeaning::Run)),
            Some(MappedColumn::Direction) => return Ok(ColumnRole::Other(ColumnMeaning::Direction)),
            Some(MappedColumn::Excluded) => return Ok(ColumnRole::Other(ColumnMeaning::Excluded)),
            Some(MappedColumn::Ignored) | None => return Ok(ColumnRole::Other(ColumnMeaning::Ignored)),
            Some(MappedColumn::Readings { error, unit, label, flip, reached }) => (error, unit, label, flip, reached),
        };
        if self.wanted.excludes(error) {
            return Ok(ColumnRole::Other(ColumnMeaning::Ignored));
        }
        if let (Some(own), Some(mapped)) = (title.unit.as_deref(), unit.as_deref())
            && reading_unit(own) != reading_unit(mapped)
        {
            return Err(ExportFailure::OtherUnit(title.name.clone(), own.to_owned(), mapped.to_owned()));
        }
        if *reached {
            own_axis(error, &header.axis)?;
            return Ok(Self::reached_role(header, error, label.clone()));
        }
        let known = Title { unit: title.unit.clone().or(unit.clone()), ..Title::new(&title.cell) };
        self.deviation(header, &known, error.clone(), label.clone(), *flip)
    }

    fn role_by_channel(&self, header: &mut ImportHeader, title: &Title) -> Result<ColumnRole, ExportFailure> {
        let Some((mounting, (channel, label))) = self.wanted.mounting.zip(channels::channel(&title.name, self.layout))
        else {
            return Ok(self.not_a_reading(title));
        };
        let axis = AxisName::new(&header.axis).ok_or(ExportFailure::NoAxis)?;
        if channels::axis_direction(&axis) != Some(mounting.along()) {
            let beam = ["X", "Y", "Z"][mounting.along()].to_owned();
            return Err(ExportFailure::BeamAcross(beam, header.axis.clone()));
        }
        let (error, negative) = mounting.error(channel, &axis);
        if self.wanted.excludes(&error) {
            return Ok(ColumnRole::Other(ColumnMeaning::Ignored));
        }
        let flipped = self.wanted.flipped.iter().any(|name| ColumnMap::names(name, &title.name, &title.cell));
        let negative = negative != flipped;
        header.channels.push(NamedChannel { title: title.cell.clone(), error: error.clone(), negative });
        self.deviation(header, title, error, label, negative)
    }

    fn role_by_error(&self, header: &mut ImportHeader, title: &Title) -> Result<ColumnRole, ExportFailure> {
        let named = title.error().filter(|(error, _)| !self.wanted.excludes(error));
        let Some((error, approach)) = named else { return Ok(self.not_a_reading(title)) };
        let direction = approach.map(|approach| match approach {
            Approach::Reverse => ColumnDirection::Reverse,
            _ => ColumnDirection::Forward,
        });
        self.deviation(header, title, error, RunLabel { direction, run: String::new() }, false)
    }

    fn role_by_run(
        &self,
        header: &mut ImportHeader,
        title: &Title,
        runs: &RunColumns,
    ) -> Result<ColumnRole, ExportFailure> {
        let reached = self.actual_position_label(header, title);
        let error = match (runs, reached) {
            (RunColumns::Reached(error), Some(label)) => return Ok(Self::reached_role(header, error, label)),
            (RunColumns::NotReached, _) | (RunColumns::OtherError, None) => self.error()?,
            (RunColumns::Deviations(error), None) if self.layout.is_deviation(&title.lower) => Some(error.clone()),
            _ => return Ok(self.not_a_reading(title)),
        };
        let by_channel = channels::channel(&title.name, self.layout);
        let label = match (self.layout.run(&title.name, header.paired), by_channel, &error) {
            (Some(label), ..) => label,
            (None, Some((channel, label)), Some(error)) if Self::only_channel(header, channel, error) => label,
            (None, Some(_), None) => {
                return Err(ExportFailure::Channels(format!("`{}` ...", shown(&title.name))));
            }
            _ => return Ok(self.not_a_reading(title)),
        };
        let error = error.ok_or_else(|| ExportFailure::NoError(Some(title.name.clone())))?;
        let open = self.layout.is_open(&title.lower) && own_error(&header.axis).as_ref() == Some(&error);
        Ok(match self.deviation(header, title, error, label, false)? {
            ColumnRole::Deviation(series) if open => ColumnRole::Open(series),
            role => role,
        })
    }

    /// True if the channel can show the error, and no other channel of the table can.
    fn only_channel(header: &ImportHeader, channel: InstrumentChannel, error: &ErrorId) -> bool {
        let rival = header.named.iter().any(|other| *other != channel && other.can_show(error));
        channel.can_show(error) && !rival
    }

    /// Returns the error that is asked for, or that the file names.
    fn error(&self) -> Result<Option<ErrorId>, ExportFailure> {
        self.wanted.error.as_deref().or(self.entry("error")).map(component_error).transpose()
    }

    /// Returns the role of positions that were reached, in the unit of the targets.
    fn reached_role(header: &mut ImportHeader, error: &ErrorId, label: RunLabel) -> ColumnRole {
        let error = index_of(&mut header.errors, error.clone());
        ColumnRole::Reached(Series { error, label, factor: header.factor })
    }

    /// Returns the role of deviations; `negative`: of readings with the other sign.
    fn deviation(
        &self,
        header: &mut ImportHeader,
        title: &Title,
        error: ErrorId,
        label: RunLabel,
        negative: bool,
    ) -> Result<ColumnRole, ExportFailure> {
        own_axis(&error, &header.axis)?;
        let text = self.unit(title).ok_or_else(|| ExportFailure::NoUnit(title.name.clone()))?;
        let unit = reading_unit(text)?;
        if !unit.fits(&error) {
            return Err(ExportFailure::NotUnitOf(text.to_owned(), error));
        }
        let factor = if negative { -unit.factor } else { unit.factor };
        Ok(ColumnRole::Deviation(Series { error: index_of(&mut header.errors, error), label, factor }))
    }
}

/// Returns a column that is not used, with the reason.
fn unused_column(title: &Title, role: &ColumnRole) -> Option<UnusedColumn> {
    let (known, reason) = match role {
        ColumnRole::Other(ColumnMeaning::Ignored) => (true, "not a reading of these errors"),
        ColumnRole::Other(ColumnMeaning::Unknown) => (false, "not understood"),
        _ => return None,
    };
    let title = title.cell.trim();
    (!title.is_empty()).then(|| UnusedColumn { title: title.to_owned(), reason: reason.to_owned(), known })
}

fn form(titles: &[Title]) -> TableForm {
    let has = |word: &str| titles.iter().any(|title| title.lower == word);
    let is_error = |title: &Title| title.error().is_some() && split_direction(&title.name).0.len() >= 3;
    match (has("error") && has("value"), titles.iter().any(is_error)) {
        (true, _) => TableForm::Tidy,
        (_, true) => TableForm::Wide,
        _ => TableForm::Runs,
    }
}
