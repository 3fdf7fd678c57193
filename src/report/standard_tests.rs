//! Figures of tests of the ISO 230 series as values and as pictures: circles, axes of rotation, drift, diagonals.

use super::positioning::{StatedContributors, print_unit};
use super::{DialMark, DialPanel, LinePanel, LinePicture, Picture, PolarPicture};
use crate::analysis::instrument::CirclePlane;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::standards::{
    self, AccuracyFigures, AngleReading, BothSenses, Caused, CircleCauses, CircleFigures, DriftFigures, ErrorMotion,
    LEAST_ARC, LEAST_PLACES, LISTED, MIN_READINGS, NOT_VERIFIED, RadialReading, ReadingsTable, Sense, TurningPoint,
    arc, causes, rotating,
};
use crate::units::{counted, significant};
use serde::Serialize;

/// Coverage factor of an expanded uncertainty.
const COVERAGE: f64 = 2.0;

#[derive(Debug, Clone, Copy)]
pub(crate) struct TestSetup {
    /// Plane of a circle.
    pub plane: CirclePlane,
    /// Nominal radius of a circle, mm.
    pub radius_mm: f64,
    /// Feed on a circle, mm/min.
    pub feed: Option<f64>,
    /// Distance of the planes of two probes, mm.
    pub distance_mm: Option<f64>,
}

/// Figures of a test. Serialises as docs/formats/measurements.md describes.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(tag = "test", rename_all = "snake_case")]
pub enum TestFigures {
    /// A circle.
    Circle(Box<CircleTest>),
    /// An axis of rotation.
    Rotation(RotationTest),
    /// Drift.
    Drift(DriftTest),
    /// Diagonals.
    Diagonals(DiagonalsTest),
}

/// A value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct UncertainValue {
    /// The value.
    pub value: f64,
    /// Standard uncertainty by what the causes leave (type A); none without readings to spare.
    pub sigma: Option<f64>,
}

impl UncertainValue {
    fn of(found: Caused, factor: f64) -> Self {
        Self { value: found.value * factor + 0.0, sigma: found.sigma.map(|sigma| (sigma * factor).abs()) }
    }
}

/// Figures of a circle after ISO 230-4.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CircleTest {
    /// The plane.
    pub plane: CirclePlane,
    /// Nominal radius.
    pub radius_mm: f64,
    /// Arc on which there are readings.
    pub arc_deg: f64,
    /// Number of readings.
    pub readings: usize,
    /// Circular deviation G about the centre of least squares.
    pub circular_deviation_um: BothSenses<Option<f64>>,
    /// Bidirectional circular deviation G(b).
    pub bidirectional_um: Option<f64>,
    /// Mean bidirectional radial deviation D.
    pub mean_radial_um: Option<f64>,
    /// Radial deviations F about the nominal centre, largest and smallest.
    pub radial_max_min_um: BothSenses<Option<[f64; 2]>>,
    /// Expanded uncertainties (k = 2) of G, G(b), D and F, type A.
    #[serde(rename = "U")]
    pub uncertainty: Option<CircleUncertainties>,
    /// Centre of least squares from the nominal one: how the ball stood.
    pub centre_um: [f64; 2],
    /// The circle taken apart; none where the readings do not tell causes apart.
    pub causes: Option<CauseTest>,
    /// The standard's text was not at hand.
    pub note: &'static str,
    #[serde(skip)]
    curves: [Vec<(f64, f64)>; 2],
}

/// Expanded uncertainties (k = 2) of the figures of a circle, um: by the scatter about the causes alone, which is in
/// single readings. Errors that repeat along an axis count as scatter; what the instrument adds is not in them.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CircleUncertainties {
    /// Of G and G(b), the difference of two readings.
    #[serde(rename = "G")]
    pub deviation: f64,
    /// Of D, a mean of all.
    #[serde(rename = "D")]
    pub mean: f64,
    /// Of each of F, one reading.
    #[serde(rename = "F")]
    pub extreme: f64,
    /// Contributors that these have and lack.
    pub contributors: StatedContributors,
}

impl CircleUncertainties {
    /// Returns those of a scatter (um, standard deviation) of so many readings.
    fn of(scatter: f64, readings: usize) -> Self {
        let extreme = COVERAGE * scatter;
        Self {
            deviation: extreme * std::f64::consts::SQRT_2,
            mean: extreme / libm::sqrt(readings as f64),
            extreme,
            contributors: StatedContributors { has: vec!["scatter of the readings"], lacks: LISTED.to_vec() },
        }
    }
}

/// Causes of the deviations of a circle, each beside the others by least squares.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CauseTest {
    /// Angle between the directions of the plane minus 90 deg. Of one sense servo mismatch is in it.
    pub squareness_urad: UncertainValue,
    /// Scale of the first direction minus scale of the second.
    pub scale_mismatch_um_per_m: UncertainValue,
    /// Reversal of both axes, as ISO 230-2 signs it: below zero is lost motion.
    pub reversal_um: [UncertainValue; 2],
    /// Servo mismatch as a radial amplitude: above zero the first axis lags more. None of one sense.
    pub servo_um: Option<UncertainValue>,
    /// The same as a difference of delays, with a feed.
    pub servo_ms: Option<UncertainValue>,
    /// Where the axes turn, by rising angle, with the reversal spikes.
    pub turning_points: [TurningTest; 4],
    /// Root mean square of what these causes leave beside the spikes.
    pub rest_um: f64,
}

/// A turning point of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TurningTest {
    /// The axis, `X`, `Y` or `Z`.
    pub axis: &'static str,
    /// The end at which it turns: `+` where it is largest, or `-`.
    pub end: &'static str,
    /// Its angle on the circle.
    pub angle_deg: f64,
    /// The reversal spike after it; none if the readings show none.
    pub spike: Option<SpikeTest>,
    /// Height from which on a spike of any length would be found; none where the readings are too few to judge.
    pub limit_um: Option<f64>,
}

/// A reversal spike: a short peak after an axis has turned, the same in both senses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SpikeTest {
    /// Height: above zero outwards.
    pub height_um: UncertainValue,
    /// Angle from the turning point to its beginning.
    pub start_deg: f64,
    /// Length at half its height, as an angle.
    pub width_deg: f64,
    /// The same along the path.
    pub width_mm: f64,
    /// The same in time, with a feed.
    pub width_ms: Option<f64>,
    /// Probability that normal scatter shows one as strong at any turning point; below 1e-9 it is rounding.
    pub chance: f64,
}

impl TurningTest {
    fn of(found: TurningPoint, k: usize, setup: &TestSetup) -> Self {
        let spike = found.spike.map(|spike| {
            let width_mm = spike.width.to_radians() * setup.radius_mm;
            SpikeTest {
                height_um: UncertainValue::of(spike.height, 1.0),
                start_deg: spike.start,
                width_deg: spike.width,
                width_mm,
                width_ms: setup.feed.map(|feed| 60e3 * width_mm / feed),
                chance: spike.chance,
            }
        });
        let axis = ["X", "Y", "Z"][setup.plane.directions()[k % 2]];
        let end = if k < 2 { "+" } else { "-" };
        Self { axis, end, angle_deg: found.angle, spike, limit_um: found.limit }
    }

    fn mark(&self) -> Option<DialMark> {
        let spike = self.spike?;
        let end = spike.start_deg + 2.0 * spike.width_deg;
        let label = format!("{}{} {} \u{b5}m", self.axis, self.end, significant(spike.height_um.value, 2));
        Some(DialMark { angle: self.angle_deg, travelled: [spike.start_deg, end], label })
    }
}

impl CauseTest {
    fn of(found: &CircleCauses, setup: &TestSetup) -> Self {
        // An amplitude of v dt / 2; v in um/ms is feed in mm/min / 60.
        let delay = |servo: Caused| setup.feed.map(|feed| UncertainValue::of(servo, 120.0 / feed));
        Self {
            squareness_urad: UncertainValue::of(found.squareness, 1.0),
            scale_mismatch_um_per_m: UncertainValue::of(found.scale_mismatch, 1.0),
            reversal_um: found.reversal.map(|reversal| UncertainValue::of(reversal, 1.0)),
            servo_um: found.servo.map(|servo| UncertainValue::of(servo, 1.0)),
            servo_ms: found.servo.and_then(delay),
            turning_points: [0, 1, 2, 3].map(|k| TurningTest::of(found.turning_points[k], k, setup)),
            rest_um: found.rest,
        }
    }
}

/// Figures of the error motions of an axis of rotation after ISO 230-7.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RotationTest {
    /// Number of readings.
    pub readings: usize,
    /// Error motions by probe, then in the rotating sensitive direction, then tilts.
    pub motions: Vec<MotionTest>,
    /// The standard's text was not at hand.
    pub note: &'static str,
}

/// An error motion about the centre of least squares.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MotionTest {
    /// Probe, or what was formed of probes.
    pub motion: String,
    /// Unit of the figures, `um` or `urad`.
    pub unit: &'static str,
    /// Places of the turn.
    pub places: usize,
    /// Turns, at the place that has fewest.
    pub turns: usize,
    /// Total error motion.
    pub total: f64,
    /// Synchronous error motion; of an axial probe the residual one, without the fundamental.
    pub synchronous: f64,
    /// Asynchronous error motion; none of one turn.
    pub asynchronous: Option<f64>,
    /// Amplitude of what goes round once. Radial: how far the artefact stood off the axis. Axial: the fundamental,
    /// which is an error motion.
    pub once: f64,
    /// Synchronous error motion with what goes round once.
    pub synchronous_with_once: f64,
    #[serde(skip)]
    mean_turn: Vec<AngleReading>,
}

impl MotionTest {
    fn of(motion: String, unit: &'static str, readings: &[AngleReading]) -> Option<Self> {
        let found = ErrorMotion::of(readings)?;
        Some(Self {
            motion,
            unit,
            places: found.places,
            turns: found.turns,
            total: found.total,
            synchronous: found.synchronous,
            asynchronous: found.asynchronous,
            once: libm::hypot(found.once[0], found.once[1]),
            synchronous_with_once: found.synchronous_whole,
            mean_turn: found.mean_turn,
        })
    }
}

/// Figures of thermal drift after ISO 230-3.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DriftTest {
    /// Duration of the test.
    pub minutes: f64,
    /// Displacements by probe, then tilts.
    pub drifts: Vec<DriftOf>,
    /// Ranges of the temperatures.
    pub temperatures: Vec<TemperatureRange>,
    /// The standard's text was not at hand.
    pub note: &'static str,
    #[serde(skip)]
    curves: Vec<LinePanel>,
}

/// The drift of one displacement or tilt.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DriftOf {
    /// Probe or tilt.
    pub drift: String,
    /// Unit of the figures, `um` or `urad`.
    pub unit: &'static str,
    /// Range over the test.
    pub range: f64,
    /// Range over the first 60 minutes.
    pub first_hour: f64,
    /// Largest range within 60 minutes.
    pub largest_in_an_hour: f64,
    /// Last minus first.
    pub change: f64,
}

/// The range of a temperature.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TemperatureRange {
    /// The sensor.
    pub sensor: String,
    /// Lowest and highest, deg C.
    pub deg_c: [f64; 2],
}

/// Figures of diagonals after ISO 230-6.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DiagonalsTest {
    /// Number of readings.
    pub readings: usize,
    /// Diagonal systematic deviation of positioning E_d: the largest E of the diagonals.
    pub e_d_um: f64,
    /// Diagonal reversal B_d: the largest B of the diagonals; none of one direction.
    pub b_d_um: Option<f64>,
    /// Each diagonal.
    pub diagonals: Vec<DiagonalTest>,
    /// The standard's text was not at hand.
    pub note: &'static str,
}

/// One diagonal, with the figures of ISO 230-2.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DiagonalTest {
    /// Its name.
    pub diagonal: String,
    /// Largest minus smallest target.
    pub length_mm: f64,
    /// Number of targets.
    pub targets: usize,
    /// Smallest number of runs that a target has in a direction.
    pub runs: usize,
    /// Systematic deviation E of both directions.
    pub e_um: f64,
    /// Largest reversal B, and the mean with its sign; none of one direction.
    pub b_um: Option<f64>,
    /// Mean reversal: below zero is lost motion.
    pub mean_b_um: Option<f64>,
    /// Mean deviation M.
    pub m_um: f64,
    /// Repeatability R; none of single runs.
    pub r_um: Option<f64>,
    /// Accuracy A; none of single runs.
    pub a_um: Option<f64>,
    #[serde(skip)]
    curves: LinePanel,
}

impl DiagonalTest {
    fn of(diagonal: String, found: &AccuracyFigures) -> Self {
        let um = |x: f64| x * 1e3 + 0.0;
        let direction = |of: fn(&standards::TargetReadings) -> Option<standards::Repeated>| -> Vec<(f64, f64)> {
            found.targets.iter().filter_map(|t| Some((t.position, um(of(t)?.mean)))).collect()
        };
        let curves = [("there", direction(|t| t.forward)), ("back", direction(|t| t.reverse))];
        let curves = curves.into_iter().filter(|(_, points)| !points.is_empty());
        let curves = curves.map(|(word, points)| (format!("{diagonal} {word}"), points)).collect();
        Self {
            length_mm: standards::range(found.targets.iter().map(|t| t.position)),
            targets: found.targets.len(),
            runs: found.runs,
            e_um: um(found.systematic),
            b_um: found.reversal.map(um),
            mean_b_um: found.mean_reversal.map(um),
            m_um: um(found.mean),
            r_um: found.repeatability.map(um),
            a_um: found.accuracy.map(um),
            curves: LinePanel { unit: "\u{b5}m", curves },
            diagonal,
        }
    }
}

fn refusal(message: String, help: &str) -> Diagnostic {
    Diagnostic::new(codes::E0519, message).help(help.to_owned())
}

pub(crate) fn circle(table: &ReadingsTable, setup: &TestSetup) -> Result<CircleTest, Diagnostic> {
    let readings = table.circle(setup.radius_mm)?;
    let arc_deg = arc(&readings);
    let Some(found) = CircleFigures::of(&readings) else {
        let (count, deg) = (counted(readings.len(), "reading"), significant(arc_deg, 4));
        let message = format!("there are {count}, and those of one sense are on {deg} deg of the circle");
        let help = format!("a centre needs {MIN_READINGS} readings, and of each sense that was read {LEAST_ARC} deg");
        return Err(refusal(message, &help));
    };
    let curve = |sense: Sense| {
        let mine = readings.iter().zip(&found.centred).filter(|(r, _)| r.sense == sense);
        let mut curve: Vec<(f64, f64)> = mine.map(|(r, x): (&RadialReading, &f64)| (r.angle, *x)).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve
    };
    let causes = causes(&readings, setup.radius_mm);
    Ok(CircleTest {
        plane: setup.plane,
        radius_mm: setup.radius_mm,
        arc_deg,
        readings: readings.len(),
        circular_deviation_um: BothSenses::new(found.deviation),
        bidirectional_um: found.bidirectional,
        mean_radial_um: found.mean,
        radial_max_min_um: BothSenses::new(found.extremes),
        uncertainty: causes.as_ref().map(|found| CircleUncertainties::of(found.rest, readings.len())),
        centre_um: found.centre,
        causes: causes.map(|found| CauseTest::of(&found, setup)),
        note: NOT_VERIFIED,
        curves: Sense::ALL.map(curve),
    })
}

/// Pairs of probes `x1` and `x2`: their letter, and the readings of both.
type Pair<'p> = (&'p str, &'p [f64], &'p [f64]);

fn pairs(probes: &[(String, Vec<f64>)]) -> Vec<Pair<'_>> {
    let second = |name: &str| probes.iter().find(|(other, _)| *other == format!("{name}2"));
    probes
        .iter()
        .filter_map(|(name, first)| {
            let letter = name.strip_suffix('1')?;
            second(letter).map(|(_, second)| (letter, first.as_slice(), second.as_slice()))
        })
        .collect()
}

pub(crate) fn rotation(table: &ReadingsTable, setup: &TestSetup) -> Result<RotationTest, Diagnostic> {
    let (angles, probes) = (table.angles()?, table.probes()?);
    let at = |values: &[f64]| angles.iter().copied().zip(values.iter().copied()).collect::<Vec<AngleReading>>();
    let named = |name: &str| probes.iter().find(|(probe, _)| probe == name).map(|(_, values)| values.as_slice());
    let mut all: Vec<((String, &'static str), Vec<AngleReading>)> =
        probes.iter().map(|(name, values)| ((name.clone(), "um"), at(values))).collect();
    for end in ["", "1", "2"] {
        if let (Some(x), Some(y)) = (named(&format!("x{end}")), named(&format!("y{end}"))) {
            all.push(((format!("rotating x{end}, y{end}"), "um"), rotating(&angles, x, y)));
        }
    }
    if let Some(distance) = setup.distance_mm {
        for (letter, first, second) in pairs(&probes) {
            // um over mm are mrad.
            let tilts: Vec<f64> = first.iter().zip(second).map(|(a, b)| (b - a) / distance * 1e3).collect();
            all.push(((format!("tilt {letter}"), "urad"), at(&tilts)));
        }
    }
    let help = format!(
        "columns are `angle [deg]` and probes such as `x [um]`, `y [um]`, `z [um]`, or `x1`, `x2` of two planes; each \
         turn has at least {LEAST_PLACES} places, the same in every turn"
    );
    let motions: Option<Vec<MotionTest>> =
        all.into_iter().map(|((motion, unit), values)| MotionTest::of(motion, unit, &values)).collect();
    match motions.filter(|motions| !motions.is_empty()) {
        Some(motions) => Ok(RotationTest { readings: angles.len(), motions, note: NOT_VERIFIED }),
        None => Err(refusal("the readings show no error motion".to_owned(), &help)),
    }
}

pub(crate) fn drift(table: &ReadingsTable, setup: &TestSetup) -> Result<DriftTest, Diagnostic> {
    let (times, probes) = (table.times()?, table.probes()?);
    let mut all: Vec<(String, &'static str, Vec<f64>)> =
        probes.iter().map(|(name, values)| (name.clone(), "um", values.clone())).collect();
    if let Some(distance) = setup.distance_mm {
        for (letter, first, second) in pairs(&probes) {
            // A displacement that grows along Z turns about the other axis: dX/dZ = +B, dY/dZ = -A.
            let (name, sign) = match letter {
                "x" => ("tilt B".to_owned(), 1e3),
                "y" => ("tilt A".to_owned(), -1e3),
                other => (format!("tilt of {other}"), 1e3),
            };
            all.push((name, "urad", first.iter().zip(second).map(|(a, b)| sign * (b - a) / distance).collect()));
        }
    }
    let one = |(drift, unit, values): &(String, &'static str, Vec<f64>)| {
        DriftFigures::of(&times, values).map(|found| DriftOf {
            drift: drift.clone(),
            unit,
            range: found.total,
            first_hour: found.first,
            largest_in_an_hour: found.largest_in_an_hour,
            change: found.change + 0.0,
        })
    };
    let drifts: Vec<DriftOf> = all.iter().filter_map(one).collect();
    if drifts.is_empty() {
        let help = "columns are `time [min]`, probes such as `x1 [um]`, and temperatures such as `air [degC]`";
        return Err(refusal("there is no reading of a probe".to_owned(), help));
    }
    let warm = table.temperatures()?;
    let panel = |unit: &'static str, shown: &'static str| {
        let of = all.iter().filter(|(_, of, _)| *of == unit);
        let curve = |(name, _, values): &(String, &'static str, Vec<f64>)| {
            let start = values.first().copied().unwrap_or(0.0);
            (name.clone(), times.iter().zip(values).map(|(t, x)| (*t, x - start)).collect())
        };
        LinePanel { unit: shown, curves: of.map(curve).collect() }
    };
    let degrees = warm.iter().map(|(name, values)| {
        (name.clone(), times.iter().copied().zip(values.iter().copied()).collect::<Vec<(f64, f64)>>())
    });
    let degrees = LinePanel { unit: "\u{b0}C", curves: degrees.collect() };
    let panels = [panel("um", "\u{b5}m"), panel("urad", "\u{b5}rad"), degrees];
    let extremes = |(sensor, values): &(String, Vec<f64>)| {
        let start = values.first().copied().unwrap_or(0.0);
        let low = values.iter().copied().fold(start, f64::min);
        TemperatureRange { sensor: sensor.clone(), deg_c: [low, values.iter().copied().fold(start, f64::max)] }
    };
    Ok(DriftTest {
        minutes: standards::range(times.iter().copied()),
        drifts,
        temperatures: warm.iter().map(extremes).collect(),
        note: NOT_VERIFIED,
        curves: panels.into_iter().filter(|panel| !panel.curves.is_empty()).collect(),
    })
}

pub(crate) fn diagonals(table: &ReadingsTable) -> Result<DiagonalsTest, Diagnostic> {
    let list = table.along_diagonals()?;
    let readings = list.iter().map(|(_, readings)| readings.len()).sum();
    let one = |(name, readings): (String, Vec<_>)| Some(DiagonalTest::of(name, &AccuracyFigures::of(&readings)?));
    let diagonals: Vec<DiagonalTest> = list.into_iter().filter_map(one).collect();
    if let Some(point) = diagonals.iter().find(|diagonal| diagonal.length_mm <= 0.0) {
        let message = format!("the diagonal `{}` has one target", shown(&point.diagonal));
        return Err(refusal(message, "a diagonal has targets from one corner to the other"));
    }
    Ok(DiagonalsTest {
        readings,
        e_d_um: diagonals.iter().map(|diagonal| diagonal.e_um).fold(0.0, f64::max),
        b_d_um: diagonals.iter().filter_map(|diagonal| diagonal.b_um).reduce(f64::max),
        diagonals,
        note: NOT_VERIFIED,
    })
}

impl TestFigures {
    /// Returns a picture of the readings.
    pub fn picture(&self) -> Picture {
        match self {
            Self::Circle(test) => test.picture(),
            Self::Rotation(test) => test.picture(),
            Self::Drift(test) => {
                let subtitle = format!("Over {} min", significant(test.minutes, 4));
                LinePicture { title: "Thermal drift", subtitle: &subtitle, across: "time in min", panels: &test.curves }
                    .picture()
            }
            Self::Diagonals(test) => test.picture(),
        }
    }
}

impl DiagonalsTest {
    fn picture(&self) -> Picture {
        let panels: Vec<LinePanel> = self.diagonals.iter().map(|diagonal| diagonal.curves.clone()).collect();
        let subtitle = format!("E_d {} \u{b5}m, means of the runs", significant(self.e_d_um, 3));
        LinePicture { title: "Diagonals", subtitle: &subtitle, across: "way in mm", panels: &panels }.picture()
    }
}

impl CircleTest {
    fn picture(&self) -> Picture {
        let whole = self.arc_deg >= 360.0;
        let [right, up] = self.plane.directions().map(|i| ["+X", "+Y", "+Z"][i]);
        let g = |of: Option<f64>| of.map_or_else(|| "-".to_owned(), |g| significant(g, 3));
        let (there, back) = (self.circular_deviation_um.counter_clockwise, self.circular_deviation_um.clockwise);
        let square = self
            .causes
            .map(|causes| format!(", squareness {} \u{b5}rad", significant(causes.squareness_urad.value, 3)));
        let panel = DialPanel {
            directions: [right.to_owned(), up.to_owned()],
            marks: self.causes.iter().flat_map(|causes| causes.turning_points).filter_map(|at| at.mark()).collect(),
            curves: self.curves.to_vec(),
            closed: whole,
            title: format!("{}: G(b) {} \u{b5}m", self.plane.name(), g(self.bidirectional_um)),
            line: format!("G {} and {} \u{b5}m{}", g(there), g(back), square.unwrap_or_default()),
        };
        let subtitle = format!("Radius {} mm, {} readings", significant(self.radius_mm, 6), self.readings);
        PolarPicture::senses("Circular path", &subtitle, &[panel]).picture()
    }
}

impl RotationTest {
    fn picture(&self) -> Picture {
        let panel = |test: &MotionTest| DialPanel {
            directions: ["0\u{b0}".to_owned(), "90\u{b0}".to_owned()],
            marks: Vec::new(),
            curves: vec![test.mean_turn.clone()],
            closed: true,
            title: format!(
                "{}: synchronous {} {}",
                test.motion,
                significant(test.synchronous, 3),
                print_unit(test.unit)
            ),
            line: format!(
                "total {}, asynchronous {}",
                significant(test.total, 3),
                test.asynchronous.map_or_else(|| "-".to_owned(), |x| significant(x, 3))
            ),
        };
        let panels: Vec<DialPanel> = self.motions.iter().map(panel).collect();
        PolarPicture::mean_turn("Error motions", "Mean of all turns about the centre of least squares", &panels)
            .picture()
    }
}
