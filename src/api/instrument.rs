//! Readings of measuring instruments on a machine.

use super::bounded::DrawnBounds;
use super::budget::BudgetOptions;
use super::tolerances::ToleranceOptions;
use crate::analysis::Unreachable;
use crate::analysis::instrument::{
    BallBar, BoundedReading, BoundedRequest, CirclePlane, Diagonal, DrivenPath, RTest, RTestReading, ball_bar,
    circle_path, diagonal_paths, diagonals, r_test, turn_path, within,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Frame;
use crate::job::machine_file::{MachineFile, bounded_only};
use crate::job::poses::{AxisPositions, axis_positions, check, pose_by_names};
use crate::machine::{Axis, AxisKind, Machine, Pose};
use crate::report::{DiagonalPicture, DialPanel, DrawSettings, Picture, PolarPicture, RTestPicture};
use crate::run::{Call, Count, Refused, Reply, Run};
use crate::units::significant;
use schemars::JsonSchema;
use serde::Serialize;

/// A position that somebody drives to: four decimals.
fn driven(position: f64) -> f64 {
    libm::round(position * 1e4) / 1e4 + 0.0
}

/// Options of [`instrument`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct InstrumentOptions {
    /// The instrument.
    pub instrument: Instrument,
    /// Ball bar: plane of the circle, workpiece frame; by default all three.
    pub plane: Option<CirclePlane>,
    /// Ball bar: its length, above 0 and up to 10000 mm.
    pub radius_mm: f64,
    /// R-test: name of the rotary axis, or of several that turn at once, `A+C`; by default all, one after the other.
    pub axis: Option<String>,
    /// Centre of the circle, place of the ball, or where the other axes are, `X=100,C=90`: mm and deg. By default the
    /// middle of the volume, for the R-test three quarters along it; rotary axes at 0 or nearest to it.
    pub at: Option<String>,
    /// Readings on a circle or turn, points on a diagonal, or steps of every axis; by default 360, 37, 11.
    pub points: Option<usize>,
}

impl Default for InstrumentOptions {
    fn default() -> Self {
        let instrument = Instrument::default();
        Self { instrument, plane: None, radius_mm: 100.0, axis: None, at: None, points: None }
    }
}

/// A measuring instrument.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Instrument {
    /// Circles about a ball, in both senses of rotation (ISO 230-4).
    #[default]
    BallBar,
    /// Rotary axes turning about a ball on the table (R-test, probing).
    RTest,
    /// A laser along the body diagonals, there and back (ISO 230-6).
    Diagonals,
    /// The same, one axis moving at a time.
    StepDiagonals,
}

/// Readings of an instrument on a machine, exact model.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct InstrumentResult {
    /// Name of the machine.
    pub machine: String,
    /// The readings.
    #[serde(flatten)]
    pub readings: Readings,
    /// Readings to which the bounds of a machine lead of which nothing is measured; the others are then zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<ReadingsOfBounds>,
    #[serde(skip)]
    axes: Vec<Axis>,
    #[serde(skip)]
    at: Pose,
}

/// Readings to which bounds lead, first order, without reversal.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReadingsOfBounds {
    /// Number of bounded errors.
    pub errors: usize,
    /// Settings of the machines drawn.
    #[serde(flatten)]
    pub drawing: DrawSettings,
    /// Circular deviation G(b) of each plane, ranges of an R-test along X, Y and Z, or E_d of each diagonal.
    pub readings: Vec<BoundedReading>,
}

/// Readings of an instrument.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "instrument", rename_all = "snake_case")]
pub enum Readings {
    /// Circles of a ball bar.
    BallBar {
        /// Centre of the circles, mm and deg.
        centre: AxisPositions,
        /// Length of the ball bar, mm.
        radius_mm: f64,
        /// The circles, plane by plane.
        planes: Vec<BallBar>,
    },
    /// R-tests.
    RTest {
        /// Pose at which the ball is, mm and deg.
        ball_at: AxisPositions,
        /// Frame of the readings: the machine frame.
        frame: Frame,
        /// The tests, axis by axis.
        axes: Vec<RTest>,
    },
    /// A laser along diagonals.
    Diagonals(LaserReadings),
    /// The same, one axis moving at a time.
    StepDiagonals(LaserReadings),
}

/// Readings of a laser along diagonals.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LaserReadings {
    /// Pose of the axes that stand, mm and deg.
    pub at: AxisPositions,
    /// The diagonals, at least one.
    pub diagonals: Vec<Diagonal>,
    /// The largest E_d, um.
    pub e_um: f64,
}

impl InstrumentResult {
    /// Returns centre of the circle, place of the ball, or where the other axes are, such as `X = 100 mm, C = 90 deg`.
    pub fn place(&self) -> String {
        let entry = |(axis, q): (&Axis, &f64)| format!("{} = {} {}", axis.name, significant(*q, 7), axis.unit());
        self.axes.iter().zip(&self.at).map(entry).collect::<Vec<_>>().join(", ")
    }

    /// Returns the axes that do not move along the diagonals, such as `, A = 0 deg`.
    pub fn standing(&self) -> String {
        let (Readings::Diagonals(of) | Readings::StepDiagonals(of)) = &self.readings else { return String::new() };
        let moving = of.diagonals.first().map_or(&[][..], |line| &line.axes);
        let stands = |(axis, q): (&Axis, &f64)| {
            let is_moving = moving.iter().any(|name| axis.name.as_str() == name);
            (!is_moving).then(|| format!(", {} = {} {}", axis.name, significant(*q, 7), axis.unit()))
        };
        self.axes.iter().zip(&self.at).filter_map(stands).collect()
    }

    /// Returns a picture of the readings.
    pub fn picture(&self) -> Picture {
        let title = &self.machine;
        match &self.readings {
            Readings::BallBar { radius_mm, planes, .. } => {
                let subtitle = format!("Ball bar of {} mm about {}", significant(*radius_mm, 6), self.place());
                let panels: Vec<DialPanel> = planes.iter().map(DialPanel::of).collect();
                PolarPicture::senses(title, &subtitle, &panels).picture()
            }
            Readings::RTest { axes, .. } => {
                let subtitle = format!("R-test with the ball at {}", self.place());
                RTestPicture { title, subtitle: &subtitle, tests: axes }.picture()
            }
            Readings::Diagonals(of) => self.laser_picture("", of),
            Readings::StepDiagonals(of) => self.laser_picture(", one axis at a time", of),
        }
    }

    fn laser_picture(&self, how: &str, of: &LaserReadings) -> Picture {
        let subtitle = format!("Laser along the diagonals{how}{}", self.standing());
        DiagonalPicture { title: &self.machine, subtitle: &subtitle, diagonals: &of.diagonals }.picture()
    }

    /// Returns the poses of the R-tests as a table to measure by, each there and back in a run of its own: the
    /// positions of all axes, and empty columns for the readings, as `identify` takes them. None of other instruments.
    pub fn sequence(&self) -> Option<String> {
        let Readings::RTest { axes: turns, .. } = &self.readings else { return None };
        let title = |axis: &Axis| format!("{} [{}]", axis.name, axis.unit());
        let titles: Vec<String> = self.axes.iter().map(title).collect();
        let mut table = format!(
            "# R-test of {}, ball at {}: tool relative to workpiece, less the first reading of the run\n\
             # directions of the machine: abbe identify --frame machine\n\
             run,{},rel.dx [um],rel.dy [um],rel.dz [um]\n",
            self.machine,
            self.place(),
            titles.join(",")
        );
        for turn in turns {
            let name = &turn.axis;
            let row = |run: &str, reading: &RTestReading| {
                let positions: Vec<String> = reading.axes.values().map(|q| driven(*q).to_string()).collect();
                format!("{run},{},,,\n", positions.join(","))
            };
            let there = turn.readings.iter().map(|reading| row(&format!("{name} there"), reading));
            let back = turn.readings.iter().rev().map(|reading| row(&format!("{name} back"), reading));
            table.extend(there.chain(back));
        }
        Some(table)
    }
}

/// Returns the readings of a measuring instrument on a machine.
///
/// Fails for a path that the machine cannot drive, and for a place or an axis that does not fit it.
pub fn instrument(file: &MachineFile, options: &InstrumentOptions, run: Run) -> Reply<InstrumentResult> {
    Call::answer(run, file.sources(), |call| read(call, file, options))
}

fn read(call: &mut Call, machine: &Machine, options: &InstrumentOptions) -> Result<InstrumentResult, Refused> {
    call.extend(bounded_only(machine));
    options.points.map_or(Ok(()), |points| call.check_counts(&[Count::Points(points)]))?;
    let share = if options.instrument == Instrument::RTest { 0.75 } else { 0.5 };
    let usual = within(machine, share);
    let at = match &options.at {
        None => usual,
        // Axes without a value stay at their usual place.
        Some(text) => pose_by_names(machine, text, usual).or_else(|refusal| call.refuse(refusal))?,
    };
    check(call, machine, std::slice::from_ref(&at))?;
    let readings = match options.instrument {
        Instrument::BallBar => circles(call, machine, &at, options)?,
        Instrument::RTest => turns(call, machine, &at, options)?,
        Instrument::Diagonals => Readings::Diagonals(lines(call, machine, &at, options, false)?),
        Instrument::StepDiagonals => Readings::StepDiagonals(lines(call, machine, &at, options, true)?),
    };
    let bounds = of_bounds(call, machine, &at, options)?;
    Ok(InstrumentResult { machine: machine.name().to_owned(), readings, bounds, axes: machine.axes().to_vec(), at })
}

/// Returns the readings to which bounds lead, of a machine of which nothing is measured.
fn of_bounds(
    call: &mut Call,
    machine: &Machine,
    at: &[f64],
    options: &InstrumentOptions,
) -> Result<Option<ReadingsOfBounds>, Refused> {
    let (tolerances, BudgetOptions { samples, seed, .. }) = (ToleranceOptions::default(), BudgetOptions::default());
    let Some(bounds) = DrawnBounds::of(call, machine, (&tolerances, samples, seed))? else { return Ok(None) };
    let draws = bounds.draws();
    let request = BoundedRequest { machine, bounds: &bounds.bounds, draws: &draws, samples };
    let mut readings = Vec::new();
    for path in driven_paths(call, machine, at, options)? {
        readings.extend(call.stage("machines drawn", request.steps(), |advance| request.readings(&path, advance))?);
    }
    Ok(Some(ReadingsOfBounds { errors: bounds.bounds.len(), drawing: bounds.drawing, readings }))
}

/// Returns the paths that an instrument drives.
fn driven_paths<'a>(
    call: &mut Call,
    machine: &'a Machine,
    at: &[f64],
    options: &InstrumentOptions,
) -> Result<Vec<DrivenPath<'a>>, Refused> {
    let paths = match options.instrument {
        Instrument::BallBar => {
            let one =
                |plane| circle_path(machine, at, plane, options.radius_mm, options.points.unwrap_or(DRAWN_CIRCLE));
            planes(options).into_iter().map(one).collect()
        }
        Instrument::RTest => {
            let turning = turning(call, machine, options)?;
            turning.iter().map(|axes| turn_path(machine, at, axes, options.points.unwrap_or(TURN))).collect()
        }
        Instrument::Diagonals => Ok(diagonal_paths(machine, at, options.points.unwrap_or(DIAGONAL), false)),
        Instrument::StepDiagonals => Ok(diagonal_paths(machine, at, options.points.unwrap_or(DIAGONAL), true)),
    };
    paths.or_else(|why| call.refuse(not_driven("the path", why)))
}

/// Readings on a circle and on a turn, points on a diagonal, if nothing else is stated.
const CIRCLE: usize = 360;
/// Fewer in each of many machines: their waves are long.
const DRAWN_CIRCLE: usize = 72;
const TURN: usize = 37;
const DIAGONAL: usize = 11;

fn planes(options: &InstrumentOptions) -> Vec<CirclePlane> {
    options.plane.map_or_else(|| CirclePlane::ALL.to_vec(), |plane| vec![plane])
}

fn not_driven(path: &str, why: Unreachable) -> Diagnostic {
    let help = "take a smaller `--radius`, another place (`--at X=250,Y=200`), or another `--plane` or `--axis`";
    Diagnostic::new(codes::E0612, format!("{path} cannot be driven: {}", why.words())).help(help)
}

fn circles(call: &mut Call, machine: &Machine, at: &[f64], options: &InstrumentOptions) -> Result<Readings, Refused> {
    let radius_mm = options.radius_mm;
    if !(radius_mm > 0.0 && radius_mm <= 10_000.0) {
        return call.usage("`--radius` is a length above 0 and up to 10000 mm");
    }
    let one = |plane: CirclePlane| {
        ball_bar(machine, at, plane, radius_mm, options.points.unwrap_or(CIRCLE)).map_err(|why| {
            let path = format!("a circle of {} mm in {}", significant(radius_mm, 6), plane.name());
            not_driven(&path, why)
        })
    };
    let planes =
        planes(options).into_iter().map(one).collect::<Result<_, _>>().or_else(|refusal| call.refuse(refusal))?;
    Ok(Readings::BallBar { centre: axis_positions(machine, at), radius_mm, planes })
}

/// Returns the rotary axes that turn, test by test.
fn turning(call: &mut Call, machine: &Machine, options: &InstrumentOptions) -> Result<Vec<Vec<usize>>, Refused> {
    let name = |i: usize| machine.axes()[i].name.as_str();
    let rotary: Vec<usize> =
        (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary).collect();
    if rotary.is_empty() {
        return call.usage("the machine has no rotary axis to turn");
    }
    let chosen = match &options.axis {
        None => rotary.iter().map(|axis| vec![*axis]).collect(),
        Some(words) => {
            let find = |word: &str| rotary.iter().copied().find(|i| name(*i) == word.trim());
            let together: Option<Vec<usize>> = words.split('+').map(find).collect();
            let once = |axes: &Vec<usize>| (1..axes.len()).all(|i| !axes[..i].contains(&axes[i]));
            match together.filter(once) {
                Some(together) => vec![together],
                None => {
                    let known: Vec<&str> = rotary.iter().map(|i| name(*i)).collect();
                    let known = known.join(", ");
                    return call
                        .usage(format!("`--axis` is one of the rotary axes {known}, or several, each once: `A+C`"));
                }
            }
        }
    };
    Ok(chosen)
}

fn turns(call: &mut Call, machine: &Machine, at: &[f64], options: &InstrumentOptions) -> Result<Readings, Refused> {
    let name = |i: usize| machine.axes()[i].name.as_str();
    let chosen = turning(call, machine, options)?;
    let one = |axes: Vec<usize>| {
        let names: Vec<&str> = axes.iter().map(|i| name(*i)).collect();
        r_test(machine, at, &axes, options.points.unwrap_or(TURN))
            .map_err(|why| not_driven(&format!("an R-test of {} at this place of the ball", names.join("+")), why))
    };
    let axes = chosen.into_iter().map(one).collect::<Result<_, _>>().or_else(|refusal| call.refuse(refusal))?;
    Ok(Readings::RTest { ball_at: axis_positions(machine, at), frame: Frame::Machine, axes })
}

fn lines(
    call: &mut Call,
    machine: &Machine,
    at: &[f64],
    options: &InstrumentOptions,
    stepped: bool,
) -> Result<LaserReadings, Refused> {
    let diagonals = diagonals(machine, at, options.points.unwrap_or(DIAGONAL), stepped);
    if diagonals.is_empty() {
        return call.refuse(not_driven("a diagonal", Unreachable::Place));
    }
    let e_um = diagonals.iter().map(|d| d.e_d_um).fold(0.0, f64::max);
    Ok(LaserReadings { at: axis_positions(machine, at), diagonals, e_um })
}
