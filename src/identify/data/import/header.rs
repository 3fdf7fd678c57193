//! Where the table begins, what its columns are, and what stands before it.

use super::form::Form;
use super::sample::{ImportRequest, refusal};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::identify::data::error_name::{parse_component_error, split_direction};
use crate::machine::ErrorId;
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::{self, Line};
use crate::units::{self, Dimension};

/// What a column holds; factors to mm, deg, rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Role {
    Position(f64),
    /// Readings of an error: index, direction, run.
    Value {
        error: usize,
        direction: Option<ColumnDirection>,
        run: String,
        factor: f64,
    },
    /// The position that was reached, for which the reading is what lies between it and the target.
    Reached {
        error: usize,
        direction: Option<ColumnDirection>,
        run: String,
        factor: f64,
    },
    /// Tidy: the reading, in the unit of its row or this.
    Reading(Option<(f64, Dimension)>),
    ErrorName,
    Unit,
    Run,
    Direction,
    /// Not empty: the row is not to be used.
    Excluded,
    /// The axis that moved.
    Axis,
    Ignored,
}

impl Role {
    /// Do its cells hold numbers?
    pub(crate) fn is_number(&self) -> bool {
        matches!(self, Self::Position(_) | Self::Value { .. } | Self::Reached { .. } | Self::Reading(_))
    }
}

/// A header that was understood.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    pub form: Form,
    pub axis: String,
    pub rotary: bool,
    /// Of positions, to mm or deg.
    pub factor: f64,
    pub errors: Vec<ErrorId>,
    pub roles: Vec<Role>,
    pub separator: char,
    /// Are `F1` or `V1`, and `R1`, directions?
    pub paired: bool,
    /// Where it stands.
    pub place: Place,
    /// Index of the first line after it.
    pub body: usize,
    pub metadata: Vec<(String, String)>,
}

/// Names of position columns that do not say the axis.
const POSITIONS: [&str; 9] = [
    "position",
    "target",
    "pos",
    "nominal",
    "target position",
    "nominal position",
    "soll",
    "sollposition",
    "soll-position",
];
/// Names of columns of positions that were reached, longer ones before those they begin with.
const REACHED: [&str; 9] = [
    "actual position",
    "actual pos",
    "actual",
    "measured position",
    "istposition",
    "ist-position",
    "ist position",
    "istwert",
    "ist",
];
/// Words with which columns of deviations begin, beside positions that were reached.
const DEVIATIONS: [&str; 4] = ["deviation", "error", "abweichung", "difference"];
/// Lines before the table, at most.
const PREAMBLE: usize = 500;

/// Words that say a direction, and which; longer ones before those they begin with.
const WAYS: [(&str, ColumnDirection); 24] = [
    ("forward", ColumnDirection::Forward),
    ("reverse", ColumnDirection::Reverse),
    ("backward", ColumnDirection::Reverse),
    ("vorwärts", ColumnDirection::Forward),
    ("vorwaerts", ColumnDirection::Forward),
    ("rückwärts", ColumnDirection::Reverse),
    ("rueckwaerts", ColumnDirection::Reverse),
    ("zurück", ColumnDirection::Reverse),
    ("zurueck", ColumnDirection::Reverse),
    ("rück", ColumnDirection::Reverse),
    ("rueck", ColumnDirection::Reverse),
    ("vor", ColumnDirection::Forward),
    ("hin", ColumnDirection::Forward),
    ("fwd", ColumnDirection::Forward),
    ("bwd", ColumnDirection::Reverse),
    ("rev", ColumnDirection::Reverse),
    ("down", ColumnDirection::Reverse),
    ("up", ColumnDirection::Forward),
    ("->", ColumnDirection::Forward),
    ("<-", ColumnDirection::Reverse),
    ("→", ColumnDirection::Forward),
    ("←", ColumnDirection::Reverse),
    ("+", ColumnDirection::Forward),
    ("-", ColumnDirection::Reverse),
];

/// `Run 1 +`, `2 reverse`, `up`, `<-`: the direction, and what is left as the run's name. `F1`, `V1` (vorwärts) and
/// `R1` are directions where both of a pair are there, and runs otherwise.
pub(crate) fn direction(label: &str, paired: bool) -> (Option<ColumnDirection>, String) {
    let lower = label.trim().to_lowercase();
    let found = WAYS.iter().find_map(|(word, way)| {
        let rest = lower.strip_suffix(word).or_else(|| lower.strip_prefix(word))?;
        Some((Some(*way), rest.trim().to_owned()))
    });
    let letter = || letter(&lower).filter(|_| paired).map(|(way, rest)| (Some(way), rest.to_owned()));
    let (way, rest) = found.or_else(letter).unwrap_or((None, lower.clone()));
    let run = rest.strip_prefix("run").unwrap_or(&rest).trim_matches(|c: char| c.is_whitespace() || c == '_');
    (way, run.to_owned())
}

/// `actual`, `actual position 2 -`, `ist_1`: the direction and the run of positions that were reached. What has another
/// word in its title, such as `actual deviation` or `actual feed`, is something else.
fn reached(title: &str, paired: bool) -> Option<(Option<ColumnDirection>, String)> {
    let lower = title.to_lowercase();
    let rest = REACHED.iter().find_map(|word| lower.strip_prefix(word))?;
    let name = rest.trim_start_matches([' ', '_', '-']);
    // A sign by itself is a direction, one before a name joins the two.
    let (way, run) = direction(if name.is_empty() { rest } else { name }, paired);
    run.chars().all(|c| c.is_ascii_digit()).then_some((way, run))
}

/// `f1`, `v 2`, `r`: a letter and the number of a run.
fn letter(lower: &str) -> Option<(ColumnDirection, &str)> {
    let (way, rest) = match lower.strip_prefix(['f', 'v']) {
        Some(rest) => (ColumnDirection::Forward, rest.trim()),
        None => (ColumnDirection::Reverse, lower.strip_prefix('r')?.trim()),
    };
    rest.chars().all(|c| c.is_ascii_digit()).then_some((way, rest))
}

/// Are there titles `F1` or `V1` as well as `R1`?
fn paired(titles: &[String]) -> bool {
    let ways: Vec<ColumnDirection> =
        titles.iter().filter_map(|title| letter(title.trim())).map(|(way, _)| way).collect();
    ways.contains(&ColumnDirection::Forward) && ways.contains(&ColumnDirection::Reverse)
}

/// `key: value` or `key = value` before the table; with a separator in between as spreadsheets write it.
fn metadata(line: &str, separator: char) -> Option<(String, String)> {
    let (key, value) = line.split_once([':', '=']).or_else(|| line.split_once(separator))?;
    let tame =
        |text: &str| text.trim_matches(|c: char| c.is_whitespace() || [':', '"', separator].contains(&c)).to_owned();
    let (key, value) = (tame(key), tame(value));
    (!key.is_empty() && !value.is_empty()).then(|| (key.chars().take(80).collect(), value.chars().take(200).collect()))
}

/// Does a line begin a table? It has two cells or more, and one of them is a position: its title and unit.
fn begins(cells: &[String], axis: Option<&str>) -> Option<(String, Option<String>)> {
    let position = |(name, _): &(String, Option<String>)| {
        POSITIONS.contains(&name.to_lowercase().as_str())
            || axis.is_some_and(|axis| name.eq_ignore_ascii_case(axis))
            || (axis.is_none() && name.len() <= 2 && crate::machine::AxisName::new(name).is_some())
    };
    // `axis; X` before the table is no header. Runs may be named by numbers, positions are words.
    let said = cells.len() == 2 && cells[0].eq_ignore_ascii_case("axis");
    if cells.len() < 2 || said { None } else { cells.iter().map(|cell| sheet::title(cell)).find(position) }
}

pub(crate) fn find(lines: &[Line], wanted: &ImportRequest) -> Result<Header, Box<Diagnostic>> {
    understood(wanted).map_err(|why| Box::new(refusal(why, None)))?;
    let mut known: Vec<(String, String)> = Vec::new();
    let mut other = None;
    for (i, line) in lines.iter().enumerate().take(PREAMBLE) {
        let separator = sheet::separator(&line.text);
        let cells = sheet::cells(&line.text, separator);
        let named = known.iter().find(|(key, _)| key.eq_ignore_ascii_case("axis")).map(|(_, value)| value.as_str());
        let axis = wanted.axis.as_deref().or(named);
        if begins(&cells, axis).is_some() && !line.text.contains(": ") {
            return Reading { lines, wanted, metadata: &known, separator }.header(i, &cells);
        }
        if let (None, Some(axis), Some((title, Some(_)))) = (&other, axis, begins(&cells, None)) {
            other = Some((axis.to_owned(), title, line.place.clone()));
        }
        known.extend(metadata(&line.text, separator));
    }
    if let Some((axis, title, place)) = other {
        let (axis, title) = (shown(&axis), shown(&title));
        let message =
            format!("axis {axis} is said to have moved, but the positions of this header are those of `{title}`");
        let help = "correct the axis in the file, or say with `--axis` which one moved";
        return Err(Box::new(refusal(message, Some(place)).help(help)));
    }
    let first = lines.first().map(|line| line.place.clone());
    if lines.first().is_some_and(|line| line.text.trim().ends_with("::")) {
        let message = "the file begins as those in which laser programs keep their tests, whose layout is not public";
        let help = "export the test from that program as text or CSV, with a position column and columns of deviations";
        return Err(Box::new(refusal(message.to_owned(), first).help(help)));
    }
    Err(Box::new(refusal("there is no header with a position column".to_owned(), first)))
}

/// What is asked for holds whether or not the file says it too.
fn understood(wanted: &ImportRequest) -> Result<(), String> {
    wanted.error.as_deref().map(component_error).transpose()?;
    wanted.unit.as_deref().map(reading_unit).transpose()?;
    Ok(())
}

pub(crate) fn component_error(name: &str) -> Result<ErrorId, String> {
    parse_component_error(name).ok_or_else(|| format!("`{}` is not a component error", shown(name)))
}

/// What columns of runs are, where there are positions that were reached.
enum Found {
    /// There are none.
    Other,
    /// They are not those of the error that is asked for.
    Beside,
    /// They are the readings.
    Reached(ErrorId),
    /// There are deviations too, which say the same.
    Deviations(ErrorId),
}

fn is_deviation(name: &str) -> bool {
    DEVIATIONS.iter().any(|word| name.to_lowercase().starts_with(word))
}

struct Reading<'a> {
    lines: &'a [Line],
    wanted: &'a ImportRequest,
    metadata: &'a [(String, String)],
    separator: char,
}

/// The axis of the errors that have columns, if it is one: of `position; ECC [urad]` it is C.
fn only_axis(titles: &[(String, Option<String>)]) -> Option<String> {
    let named = |(name, _): &(String, Option<String>)| parse_component_error(split_direction(name).0);
    let mut axes = titles.iter().filter_map(named).map(|error| error.axis.to_string());
    let first = axes.next()?;
    axes.all(|axis| axis == first).then_some(first)
}

impl Reading<'_> {
    fn said(&self, key: &str) -> Option<&str> {
        self.metadata.iter().find(|(known, _)| known.eq_ignore_ascii_case(key)).map(|(_, value)| value.as_str())
    }

    fn header(&self, at: usize, cells: &[String]) -> Result<Header, Box<Diagnostic>> {
        let place = Some(self.lines[at].place.clone());
        let refuse = |message: String| Box::new(refusal(message, place.clone()));
        let (titles, row_of_units) = self.titles(at, cells);
        let lower: Vec<String> = titles.iter().map(|(name, _)| name.to_lowercase()).collect();
        let (error, value) = (lower.iter().position(|n| n == "error"), lower.iter().position(|n| n == "value"));
        let column = lower.iter().position(|n| n == "axis");
        let body = at + 1 + usize::from(row_of_units);
        let column = column.map(|k| self.axes_of_rows(body, k, titles.len())).unwrap_or_default();
        let axis = self.axis(&titles, &column).map_err(&refuse)?;
        let letter = axis.chars().next().unwrap_or('X');
        let position = titles.iter().position(|(name, _)| self.is_position(name, &axis));
        let Some(position) = position else { return Err(refuse("there is no position column".to_owned())) };
        let unit = titles[position].1.as_deref().or(self.said("position unit"));
        let (rotary, factor) = match unit {
            None => (['A', 'B', 'C'].contains(&letter), 1.0),
            Some(unit) => position_unit(unit).map_err(&refuse)?,
        };
        if self.wanted.continuous && !rotary {
            return Err(refuse(format!(
                "axis {} moves along a line: `--continuous` is for axes that turn",
                shown(&axis)
            )));
        }
        let mut header = Header {
            form: Form::Wide,
            axis,
            rotary,
            factor,
            errors: Vec::new(),
            roles: Vec::new(),
            separator: self.separator,
            paired: paired(&lower),
            place: self.lines[at].place.clone(),
            body,
            metadata: self.metadata.to_vec(),
        };
        let has_error = |(name, _): &(String, Option<String>)| {
            split_direction(name).0.len() >= 3 && parse_component_error(split_direction(name).0).is_some()
        };
        header.form = match (error, value) {
            (Some(_), Some(_)) => Form::Tidy,
            _ if titles.iter().any(has_error) => Form::Wide,
            _ => Form::Runs,
        };
        self.roles(&mut header, &titles, position).map_err(&refuse)?;
        Ok(header)
    }

    /// Names and units of the columns; is there a row of units below them?
    fn titles(&self, at: usize, cells: &[String]) -> (Vec<(String, Option<String>)>, bool) {
        let mut titles: Vec<(String, Option<String>)> = cells.iter().map(|cell| sheet::title(cell)).collect();
        let bare = |cell: &str| cell.trim_matches(['[', ']', '(', ')']).to_owned();
        let below = self.lines.get(at + 1).map(|line| sheet::cells(&line.text, self.separator)).unwrap_or_default();
        let row_of_units = below.len() == titles.len()
            && below.iter().any(|cell| units::unit(&bare(cell)).is_ok())
            && below.iter().all(|cell| sheet::number(cell, self.separator).is_err());
        if row_of_units {
            for ((_, unit), cell) in titles.iter_mut().zip(below.iter().map(|cell| bare(cell))) {
                *unit = unit.take().or_else(|| units::unit(&cell).ok().filter(|_| !cell.is_empty()).map(|_| cell));
            }
        }
        (titles, row_of_units)
    }

    /// What every column is.
    fn roles(&self, header: &mut Header, titles: &[(String, Option<String>)], position: usize) -> Result<(), String> {
        let found = if header.form == Form::Runs { self.reached(header, titles)? } else { Found::Other };
        for (k, (name, unit)) in titles.iter().enumerate() {
            let role = if k == position {
                Role::Position(header.factor)
            } else {
                self.role(header, name, unit.as_deref(), &found)?
            };
            header.roles.push(role);
        }
        let number = |role: &Role| role.is_number() && !matches!(role, Role::Position(_));
        let any = header.roles.iter().any(number);
        if any { Ok(()) } else { Err(format!("there is no column of readings{}", self.wanted.of())) }
    }

    /// The unit of a column of readings: its own, or that of all that have none.
    fn unit<'u>(&'u self, own: Option<&'u str>) -> Option<&'u str> {
        own.or(self.wanted.unit.as_deref()).or(self.said("unit")).or(self.said("units"))
    }

    /// `actual [mm]`: in the unit of the targets. In another one it is a deviation.
    fn is_reached(&self, header: &Header, name: &str, unit: Option<&str>) -> bool {
        let same = |unit: &str| position_unit(unit) == Ok((header.rotary, header.factor));
        reached(name, header.paired).is_some() && self.unit(unit).is_none_or(same)
    }

    /// Are there columns of positions that were reached? They show the positioning error of the axis and no other one.
    fn reached(&self, header: &Header, titles: &[(String, Option<String>)]) -> Result<Found, String> {
        let axis = &header.axis;
        let own = parse_component_error(&format!("E{}{axis}", axis.chars().next().unwrap_or_default()));
        let error = self.error()?;
        if !titles.iter().any(|(name, unit)| self.is_reached(header, name, unit.as_deref())) {
            return Ok(Found::Other);
        }
        let other = |error: &ErrorId| {
            error.direction.is_rotation() != header.rotary || own.as_ref().is_some_and(|own| own != error)
        };
        if error.as_ref().is_some_and(other) {
            return Ok(Found::Beside);
        }
        let error = error.or(own).ok_or_else(|| {
            format!("nothing says of which error the positions that {axis} reached show the runs: give `--error EXX`")
        })?;
        own_axis(&error, axis)?;
        let deviations = titles.iter().any(|(name, _)| is_deviation(name));
        Ok(if deviations { Found::Deviations(error) } else { Found::Reached(error) })
    }

    fn is_position(&self, name: &str, axis: &str) -> bool {
        name.eq_ignore_ascii_case(axis) || POSITIONS.contains(&name.to_lowercase().as_str())
    }

    /// The axes that a column names, each once.
    fn axes_of_rows(&self, body: usize, column: usize, width: usize) -> Vec<String> {
        let mut axes: Vec<String> = Vec::new();
        for line in &self.lines[body.min(self.lines.len())..] {
            let cells = sheet::cells(&line.text, self.separator);
            // Not a line of words below the table.
            let axis = cells.get(column).filter(|_| cells.len() == width).map(|cell| cell.to_uppercase());
            let named = axis.filter(|axis| crate::machine::AxisName::new(axis).is_some());
            axes.extend(named.filter(|axis| !axes.contains(axis) && axes.len() < 2));
        }
        axes
    }

    /// As asked for, as the metadata or a column say, the only column that is named like one, or that of the error or of all
    /// errors that have columns.
    fn axis(&self, titles: &[(String, Option<String>)], column: &[String]) -> Result<String, String> {
        let lower: Vec<String> = titles.iter().map(|(name, _)| name.to_lowercase()).collect();
        let paired = paired(&lower);
        let own = |(name, _): &(String, Option<String>)| {
            let run = paired && letter(&name.to_lowercase()).is_some();
            let short = name.len() <= 2 && parse_component_error(name).is_none() && !run;
            short.then(|| crate::machine::AxisName::new(name)).flatten().map(|n| n.to_string())
        };
        let given = self.wanted.axis.clone().or_else(|| self.said("axis").map(str::to_owned));
        if let ([one, other], None) = (column, &given) {
            let (one, other) = (shown(one), shown(other));
            return Err(format!("the column `axis` names `{one}` and `{other}`: say with `--axis` which to take"));
        }
        let given = given.or_else(|| column.first().cloned()).or_else(|| titles.iter().find_map(own));
        let error = || self.wanted.error.as_deref().or(self.said("error")).and_then(parse_component_error);
        let given = given.or_else(|| error().map(|error| error.axis.to_string())).or_else(|| only_axis(titles));
        let axis = given.map(|name| name.trim().to_uppercase());
        axis.ok_or_else(|| "nothing says which axis moved: give `--axis X`".to_owned())
    }

    fn role(&self, header: &mut Header, name: &str, unit: Option<&str>, found: &Found) -> Result<Role, String> {
        let lower = name.to_lowercase();
        match lower.as_str() {
            "run" => return Ok(Role::Run),
            "axis" => return Ok(Role::Axis),
            "direction" | "dir" | "approach" => return Ok(Role::Direction),
            "exclude" | "excluded" | "reason" | "rejected" => return Ok(Role::Excluded),
            "error" if header.form == Form::Tidy => return Ok(Role::ErrorName),
            "unit" if header.form == Form::Tidy => return Ok(Role::Unit),
            "value" if header.form == Form::Tidy => {
                let unit = unit.map(str::to_owned).or_else(|| self.wanted.unit.clone());
                return unit
                    .map_or(Ok(Role::Reading(None)), |u| reading_unit(&u).map(|known| Role::Reading(Some(known))));
            }
            "" | "temp" | "temperature" | "time" | "comment" | "point" | "no" | "index" => {
                return Ok(Role::Ignored);
            }
            _ => {}
        }
        if header.form == Form::Tidy {
            return Ok(Role::Ignored);
        }
        let (bare, approach) = split_direction(name);
        let way = approach.map(|a| match a {
            crate::machine::Approach::Reverse => ColumnDirection::Reverse,
            _ => ColumnDirection::Forward,
        });
        if header.form == Form::Wide {
            let wanted = self.wanted.error.as_deref().and_then(parse_component_error);
            let error =
                parse_component_error(bare).filter(|error| wanted.as_ref().is_none_or(|wanted| wanted == error));
            let Some(error) = error else { return Ok(Role::Ignored) };
            return self.value(header, error, way, String::new(), name, unit);
        }
        let error = match found {
            Found::Other => self.error()?,
            _ if self.is_reached(header, name, unit) => {
                let Found::Reached(error) = found else { return Ok(Role::Ignored) };
                let (direction, run) = reached(name, header.paired).unwrap_or_default();
                let error = index(&mut header.errors, error.clone());
                return Ok(Role::Reached { error, direction, run, factor: header.factor });
            }
            Found::Beside => self.error()?,
            Found::Deviations(error) if is_deviation(name) => Some(error.clone()),
            _ => return Ok(Role::Ignored),
        };
        let error = error.ok_or_else(|| {
            format!("nothing says which error the runs are of (`{}`): give `--error EXX`", shown(name))
        })?;
        let (way, run) = direction(name, header.paired);
        self.value(header, error, way, run, name, unit)
    }

    /// The error that is asked for, or that the file says.
    fn error(&self) -> Result<Option<ErrorId>, String> {
        let said = self.wanted.error.as_deref().or(self.said("error"));
        said.map(component_error).transpose()
    }

    fn value(
        &self,
        header: &mut Header,
        error: ErrorId,
        direction: Option<ColumnDirection>,
        run: String,
        name: &str,
        unit: Option<&str>,
    ) -> Result<Role, String> {
        own_axis(&error, &header.axis)?;
        let Some(unit) = self.unit(unit) else {
            return Err(format!(
                "nothing says in which unit `{}` is: write `{0} [um]`, or give `--unit um`",
                shown(name)
            ));
        };
        let (factor, dimension) = reading_unit(unit)?;
        fits(&error, dimension).map_err(|()| format!("`{}` is not a unit of `{error}`", shown(unit)))?;
        let index = index(&mut header.errors, error);
        Ok(Role::Value { error: index, direction, run, factor })
    }
}

/// Is it of a rotary axis, and the factor to mm or deg?
fn position_unit(unit: &str) -> Result<(bool, f64), String> {
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) => Ok((false, factor)),
        Ok((_, Dimension::ANGLE)) if unit == "deg" || unit == "°" => Ok((true, 1.0)),
        Ok((factor, Dimension::ANGLE)) => Ok((true, factor.to_degrees())),
        _ => Err(format!("`{}` is not a unit of positions", shown(unit))),
    }
}

pub(crate) fn own_axis(error: &ErrorId, axis: &str) -> Result<(), String> {
    let own = error.axis.to_string().eq_ignore_ascii_case(axis);
    if own { Ok(()) } else { Err(format!("`{error}` is no error of axis {}", shown(axis))) }
}

/// Where an error stands in the list; added if it is new.
pub(crate) fn index(errors: &mut Vec<ErrorId>, error: ErrorId) -> usize {
    errors.iter().position(|known| *known == error).unwrap_or_else(|| {
        errors.push(error);
        errors.len() - 1
    })
}

pub(crate) fn reading_unit(unit: &str) -> Result<(f64, Dimension), String> {
    units::unit(unit).map_err(|_| format!("`{}` is not a unit", shown(unit)))
}

/// Angles may be ratios (`um/m`).
pub(crate) fn fits(error: &ErrorId, dimension: Dimension) -> Result<(), ()> {
    let good = match dimension {
        Dimension::LENGTH => !error.direction.is_rotation(),
        Dimension::ANGLE | Dimension::RATIO => error.direction.is_rotation(),
        _ => false,
    };
    if good { Ok(()) } else { Err(()) }
}
