//! The header of a file of measurements: the content of each column.

use super::error_name::split_direction;
use super::failure::HeaderFailure;
use super::measurement::TurnKind;
use crate::diagnostic::{did_you_mean, nearest};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, AxisKind, Machine, parse_error_name};
use crate::syntax::sheet;
use crate::units::{self, Dimension};

/// A column: its content, and the factor of its numbers to mm, deg or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeasurementColumn {
    pub content: Content,
    pub factor: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Content {
    /// Position of the axis with this index.
    Axis(usize),
    /// Position of the axis at the other end of a length: `to.X`.
    To(usize),
    /// Component of the deviation: `dx`.
    Deviation(usize),
    /// The same, less that of the first reading of the run: `rel.dx`.
    Relative(usize),
    /// A ball that the functional point was brought to: `ball`.
    Ball,
    Length(LengthKind),
    /// Deviation along the line of the run: `along`.
    Along,
    /// A feature that was touched: `feature`.
    Feature,
    /// Component of the direction from the feature to the probe, workpiece frame: `n.x`.
    Normal(usize),
    /// Distance beyond the touch along that direction: `touch`.
    Beyond,
    /// Coordinate of the functional point in the instrument's own frame: `tracker.x`.
    Tracker(usize),
    /// Component of an orientation: `da`, `level.a`, `collimator.a`, `axis.x`.
    Turn(TurnKind, usize),
    /// The name of a point.
    Point,
    /// A component error, measured in this direction.
    Error(Source, Option<Approach>),
    Station,
    /// Approximate place of a station, workpiece frame: `station.x`.
    StationAt(usize),
    /// Place of a ball, workpiece frame: `ball.x`.
    BallAt(usize),
    /// Standard uncertainty of the place of a station or ball.
    PlaceUncertainty(Fixture),
    Tool,
    /// Number of rows that this one counts for.
    Weight,
    /// Standard uncertainty of readings of this quantity.
    Uncertainty(ReadingQuantity),
    Run,
    Approach,
}

impl Content {
    /// True if its cells hold what was measured.
    pub(super) fn is_reading(self) -> bool {
        matches!(
            self,
            Self::Deviation(_)
                | Self::Relative(_)
                | Self::Length(_)
                | Self::Along
                | Self::Tracker(_)
                | Self::Turn(..)
                | Self::Error(..)
        )
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LengthKind {
    /// A whole distance: `length`.
    Whole,
    /// Distance minus nominal distance: `dl`.
    FromNominal,
    /// Distance less an unknown constant: `displacement`.
    Displacement,
}

/// The thing that stands on the workpiece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fixture {
    Station,
    Ball,
}

/// Lengths, or angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReadingQuantity {
    Length,
    Angle,
}

/// The content of the rows of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowForm {
    Deviation,
    Relative,
    Ball,
    Distance,
    Along,
    Position,
    Touch,
    Turn(TurnKind),
    Error,
}

impl RowForm {
    /// True if rotations may stand beside it, as the other half of a pose of six degrees.
    fn takes_rotations(self) -> bool {
        matches!(self, Self::Deviation | Self::Relative | Self::Position)
    }
}

impl Content {
    /// Returns the form of the rows that this content makes.
    fn form(self) -> Option<RowForm> {
        match self {
            Self::Deviation(_) => Some(RowForm::Deviation),
            Self::Relative(_) => Some(RowForm::Relative),
            Self::Ball => Some(RowForm::Ball),
            Self::Length(_) => Some(RowForm::Distance),
            Self::Along => Some(RowForm::Along),
            Self::Feature => Some(RowForm::Touch),
            Self::Tracker(_) => Some(RowForm::Position),
            Self::Turn(of, _) => Some(RowForm::Turn(of)),
            Self::Error(..) => Some(RowForm::Error),
            _ => None,
        }
    }

    /// True if a file may have one of both only.
    fn excludes(self, other: Self) -> bool {
        self == other || matches!((self, other), (Self::Length(_), Self::Length(_)))
    }
}

enum TitleUnit {
    Missing,
    Length,
    Angle,
    /// A reading: a length or an angle.
    Reading,
}

/// Titles, besides those of axes and errors.
const TITLES: [(&str, TitleUnit, Content); 47] = [
    ("dx", TitleUnit::Length, Content::Deviation(0)),
    ("dy", TitleUnit::Length, Content::Deviation(1)),
    ("dz", TitleUnit::Length, Content::Deviation(2)),
    ("rel.dx", TitleUnit::Length, Content::Relative(0)),
    ("rel.dy", TitleUnit::Length, Content::Relative(1)),
    ("rel.dz", TitleUnit::Length, Content::Relative(2)),
    ("ball", TitleUnit::Missing, Content::Ball),
    ("length", TitleUnit::Length, Content::Length(LengthKind::Whole)),
    ("dl", TitleUnit::Length, Content::Length(LengthKind::FromNominal)),
    ("displacement", TitleUnit::Length, Content::Length(LengthKind::Displacement)),
    ("along", TitleUnit::Length, Content::Along),
    ("feature", TitleUnit::Missing, Content::Feature),
    ("n.x", TitleUnit::Missing, Content::Normal(0)),
    ("n.y", TitleUnit::Missing, Content::Normal(1)),
    ("n.z", TitleUnit::Missing, Content::Normal(2)),
    ("touch", TitleUnit::Length, Content::Beyond),
    ("tracker.x", TitleUnit::Length, Content::Tracker(0)),
    ("tracker.y", TitleUnit::Length, Content::Tracker(1)),
    ("tracker.z", TitleUnit::Length, Content::Tracker(2)),
    ("da", TitleUnit::Angle, Content::Turn(TurnKind::Rotation, 0)),
    ("db", TitleUnit::Angle, Content::Turn(TurnKind::Rotation, 1)),
    ("dc", TitleUnit::Angle, Content::Turn(TurnKind::Rotation, 2)),
    ("level.a", TitleUnit::Angle, Content::Turn(TurnKind::Level, 0)),
    ("level.b", TitleUnit::Angle, Content::Turn(TurnKind::Level, 1)),
    ("level.c", TitleUnit::Angle, Content::Turn(TurnKind::Level, 2)),
    ("collimator.a", TitleUnit::Angle, Content::Turn(TurnKind::Collimator, 0)),
    ("collimator.b", TitleUnit::Angle, Content::Turn(TurnKind::Collimator, 1)),
    ("collimator.c", TitleUnit::Angle, Content::Turn(TurnKind::Collimator, 2)),
    ("axis.x", TitleUnit::Angle, Content::Turn(TurnKind::Axis, 0)),
    ("axis.y", TitleUnit::Angle, Content::Turn(TurnKind::Axis, 1)),
    ("axis.z", TitleUnit::Angle, Content::Turn(TurnKind::Axis, 2)),
    ("point", TitleUnit::Missing, Content::Point),
    ("station", TitleUnit::Missing, Content::Station),
    ("station.x", TitleUnit::Length, Content::StationAt(0)),
    ("station.y", TitleUnit::Length, Content::StationAt(1)),
    ("station.z", TitleUnit::Length, Content::StationAt(2)),
    ("station.u", TitleUnit::Length, Content::PlaceUncertainty(Fixture::Station)),
    ("ball.x", TitleUnit::Length, Content::BallAt(0)),
    ("ball.y", TitleUnit::Length, Content::BallAt(1)),
    ("ball.z", TitleUnit::Length, Content::BallAt(2)),
    ("ball.u", TitleUnit::Length, Content::PlaceUncertainty(Fixture::Ball)),
    ("tool", TitleUnit::Missing, Content::Tool),
    ("weight", TitleUnit::Missing, Content::Weight),
    ("u", TitleUnit::Reading, Content::Uncertainty(ReadingQuantity::Length)),
    ("run", TitleUnit::Missing, Content::Run),
    ("session", TitleUnit::Missing, Content::Run),
    ("approach", TitleUnit::Missing, Content::Approach),
];

pub(super) fn columns(
    machine: &Machine,
    header: &str,
    separator: char,
) -> Result<(Vec<MeasurementColumn>, RowForm), HeaderFailure> {
    let columns = parse_columns(machine, header, separator)?;
    let contents: Vec<Content> = columns.iter().map(|column| column.content).collect();
    let forms: Vec<RowForm> = contents.iter().filter_map(|content| content.form()).collect();
    let rotations = RowForm::Turn(TurnKind::Rotation);
    let other = forms.iter().find(|form| **form != rotations);
    let form = *other.or(forms.first()).ok_or(HeaderFailure::NoReadings)?;
    if forms.iter().any(|other| *other != form && !(*other == rotations && form.takes_rotations())) {
        return Err(HeaderFailure::MixedReadings);
    }
    if form == RowForm::Ball && contents.iter().any(|content| matches!(content, Content::Normal(_))) {
        // Touches of balls.
        check_ends(&contents, RowForm::Touch)?;
        check_weights(&contents, RowForm::Touch)?;
        return Ok((columns, RowForm::Touch));
    }
    check_ends(&contents, form)?;
    check_weights(&contents, form)?;
    check_positions(machine, &contents)?;
    Ok((columns, form))
}

/// Returns the columns of a table of poses, which may have empty columns for deviations.
pub(super) fn pose_columns(
    machine: &Machine,
    header: &str,
    separator: char,
) -> Result<Vec<MeasurementColumn>, HeaderFailure> {
    let columns = parse_columns(machine, header, separator)?;
    let is_axis = |column: &MeasurementColumn| matches!(column.content, Content::Axis(_));
    let is_reading = |column: &MeasurementColumn| {
        column.content.form().is_some_and(|form| form != RowForm::Deviation && form != RowForm::Relative)
    };
    match (columns.iter().any(is_reading), columns.iter().any(is_axis)) {
        (true, _) => Err(HeaderFailure::PosesWithReadings),
        (_, false) => Err(HeaderFailure::NoPoses),
        (false, true) => Ok(columns),
    }
}

/// Returns the columns of a header, no content twice.
fn parse_columns(machine: &Machine, header: &str, separator: char) -> Result<Vec<MeasurementColumn>, HeaderFailure> {
    let mut columns: Vec<MeasurementColumn> = Vec::new();
    let mut cells = sheet::cells(header, separator);
    sheet::drop_empty(&mut cells, 0);
    for cell in cells {
        let column = column(machine, &cell)?;
        if columns.iter().any(|known| known.content.excludes(column.content)) {
            return Err(HeaderFailure::Repeated(cell));
        }
        columns.push(column);
    }
    Ok(columns)
}

/// Returns a component error is nothing without the position of its own axis.
fn check_positions(machine: &Machine, contents: &[Content]) -> Result<(), HeaderFailure> {
    for content in contents {
        let Content::Error(Source { place: ErrorSite::Component(axis), .. }, _) = *content else { continue };
        if !contents.contains(&Content::Axis(axis)) {
            return Err(HeaderFailure::NoPositions(machine.axes()[axis].name.to_string()));
        }
    }
    Ok(())
}

/// Returns a weight or uncertainties, and then of every quantity that is read.
fn check_weights(contents: &[Content], form: RowForm) -> Result<(), HeaderFailure> {
    let angle = |c: &Content| match c {
        Content::Error(source, _) => source.direction.is_rotation(),
        c => matches!(c, Content::Turn(..)),
    };
    let length = |c: &Content| match form {
        RowForm::Error => matches!(c, Content::Error(..)) && !angle(c),
        form => !matches!(form, RowForm::Turn(_)),
    };
    let given = |quantity| contents.contains(&Content::Uncertainty(quantity));
    let given = (given(ReadingQuantity::Length), given(ReadingQuantity::Angle));
    if given == (false, false) {
        return Ok(());
    }
    if contents.contains(&Content::Weight) {
        return Err(HeaderFailure::WeightAndUncertainty);
    }
    let (lengths, angles) = (contents.iter().any(length), contents.iter().any(angle));
    if given == (lengths, angles) { Ok(()) } else { Err(HeaderFailure::NoUncertainty(lengths, angles)) }
}

/// Refuses columns that belong to rows of another form.
fn check_ends(contents: &[Content], form: RowForm) -> Result<(), HeaderFailure> {
    let any = |fits: fn(&Content) -> bool| contents.iter().any(fits);
    let station = any(|c| matches!(c, Content::Station | Content::StationAt(_)));
    let to = any(|c| matches!(c, Content::To(_)));
    let places = contents.iter().filter(|c| matches!(c, Content::StationAt(_))).count();
    match (form, station, to) {
        (RowForm::Distance, true, true) => return Err(HeaderFailure::TwoOtherEnds),
        (RowForm::Distance, false, false) => return Err(HeaderFailure::NoOtherEnd),
        (RowForm::Distance, ..) | (_, false, false) => {}
        _ => return Err(HeaderFailure::NoLength),
    }
    let balls = contents.iter().filter(|c| matches!(c, Content::BallAt(_))).count();
    if ![0, 3].contains(&places) || ![0, 3].contains(&balls) {
        return Err(HeaderFailure::PartOfStation);
    }
    if form == RowForm::Position && contents.iter().filter(|c| matches!(c, Content::Tracker(_))).count() < 3 {
        return Err(HeaderFailure::PartOfPosition);
    }
    let horizontal = contents.iter().filter(|c| matches!(c, Content::Turn(TurnKind::Level | TurnKind::Collimator, _)));
    if horizontal.count() > 2 {
        return Err(HeaderFailure::ThirdRotation);
    }
    let normals = contents.iter().filter(|c| matches!(c, Content::Normal(_))).count();
    let has_normal = normals == 3;
    if (form == RowForm::Touch) != has_normal || (!has_normal && (normals > 0 || any(|c| *c == Content::Beyond))) {
        return Err(HeaderFailure::PartOfTouch);
    }
    let known = |fixture| contents.contains(&Content::PlaceUncertainty(fixture));
    if (known(Fixture::Station) && places == 0) || (form != RowForm::Ball && (balls > 0 || known(Fixture::Ball))) {
        return Err(HeaderFailure::NoPlace);
    }
    if station && places == 0 && contents.contains(&Content::Length(LengthKind::FromNominal)) {
        return Err(HeaderFailure::NoStation);
    }
    if contents.contains(&Content::Approach) && any(|c| matches!(c, Content::Error(_, Some(_)))) {
        return Err(HeaderFailure::TwoApproaches);
    }
    Ok(())
}

fn column(machine: &Machine, cell: &str) -> Result<MeasurementColumn, HeaderFailure> {
    // An axis may be called as it likes.
    let (name, unit) = if machine.axis_index(cell).is_some() { (cell.to_owned(), None) } else { sheet::title(cell) };
    let (name, unit) = (name.as_str(), unit.as_deref());
    let position = |axis| unit.map_or(Ok(1.0), |unit| position_factor(machine, axis, unit));
    if let Some(axis) = machine.axis_index(name) {
        return Ok(MeasurementColumn { content: Content::Axis(axis), factor: position(axis)? });
    }
    if let Some(axis) = name.strip_prefix("to.").and_then(|name| machine.axis_index(name)) {
        return Ok(MeasurementColumn { content: Content::To(axis), factor: position(axis)? });
    }
    let Some((_, title_unit, content)) = TITLES.iter().find(|(title, ..)| *title == name) else {
        return error(machine, name, unit);
    };
    match (title_unit, unit.map(units::unit)) {
        (TitleUnit::Missing, _) => Ok(MeasurementColumn { content: *content, factor: 1.0 }),
        (TitleUnit::Reading, Some(Ok((factor, Dimension::ANGLE)))) => {
            Ok(MeasurementColumn { content: Content::Uncertainty(ReadingQuantity::Angle), factor })
        }
        (TitleUnit::Angle, Some(Ok((factor, Dimension::ANGLE | Dimension::RATIO)))) => {
            Ok(MeasurementColumn { content: *content, factor })
        }
        (TitleUnit::Angle, _) => Err(HeaderFailure::NoAngleUnit(name.to_owned())),
        (TitleUnit::Length | TitleUnit::Reading, _) => {
            Ok(MeasurementColumn { content: *content, factor: length_factor(name, unit)? })
        }
    }
}

/// Reads the title of a component error: `EXX [um]`, `EXX+ [um]`, `EXX reverse [um]`.
fn error(machine: &Machine, name: &str, unit: Option<&str>) -> Result<MeasurementColumn, HeaderFailure> {
    let (bare, approach) = split_direction(name);
    let found = parse_error_name(bare).filter(|error| !error.is_location());
    let axis = found.as_ref().and_then(|error| machine.axis_index(error.axis.as_str()));
    let Some((error, axis)) = found.zip(axis) else {
        let axes = machine.axes().iter().map(|axis| axis.name.as_str());
        let known: Vec<&str> = axes.chain(TITLES.iter().map(|(title, ..)| *title)).chain(["EXX", "to.X"]).collect();
        // All titles are too many to read: the help lists their kinds.
        let axes: Vec<&str> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
        let near = nearest(name, known.iter().copied()).is_some();
        let suggestion = did_you_mean(name, if near { &known } else { &axes });
        return Err(HeaderFailure::Unknown(name.to_owned(), suggestion));
    };
    let wanted = if error.direction.is_rotation() { Dimension::ANGLE } else { Dimension::LENGTH };
    let fits = |found| found == wanted || (found == Dimension::RATIO && wanted == Dimension::ANGLE);
    let unit = unit.ok_or_else(|| HeaderFailure::NoErrorUnit(name.to_owned()))?;
    match units::unit(unit) {
        Ok((factor, dimension)) if fits(dimension) => {
            let source = Source { place: ErrorSite::Component(axis), direction: error.direction };
            Ok(MeasurementColumn { content: Content::Error(source, approach), factor })
        }
        _ => Err(HeaderFailure::NotUnitOf(unit.to_owned(), error.to_string())),
    }
}

fn length_factor(name: &str, unit: Option<&str>) -> Result<f64, HeaderFailure> {
    let unit = unit.ok_or_else(|| HeaderFailure::NoLengthUnit(name.to_owned()))?;
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) => Ok(factor),
        _ => Err(HeaderFailure::NotLength(unit.to_owned(), name.to_owned())),
    }
}

fn position_factor(machine: &Machine, axis: usize, unit: &str) -> Result<f64, HeaderFailure> {
    let kind = machine.axes()[axis].kind;
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) if kind == AxisKind::Linear => Ok(factor),
        // Degrees stay degrees: no detour over radians that would cost a bit.
        Ok(_) if kind == AxisKind::Rotary && ["deg", "°"].contains(&unit) => Ok(1.0),
        Ok((factor, Dimension::ANGLE)) if kind == AxisKind::Rotary => Ok(factor.to_degrees()),
        _ => Err(HeaderFailure::NotPositionUnit(unit.to_owned(), machine.axes()[axis].name.to_string())),
    }
}
