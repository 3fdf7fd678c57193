//! A measuring program: the way of a touch probe around balls in the words of a controller.

use crate::analysis::touch_route::{ProbedBalls, RouteSet, RouteTouch, Stylus, TouchRoute};
use crate::controller::{ProgramManifest, ProgramWords, RenderedFile};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisKind, Machine, Pose};
use indexmap::IndexMap;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Feed (mm/min) of approaches, and of the slow touches of any controller.
const FEEDS: [f64; 2] = [6.0, 300.0];
/// Way (mm) back between the fast and the slow touch: more than the way to stop from the fast one.
const BACK: f64 = 0.3;
/// Share of the scatter of a touch that the servo cycle may add.
const LATCH_SHARE: f64 = 1.0 / 3.0;

/// A program that measures balls.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MeasuringProgram {
    /// Name of the machine.
    pub machine: String,
    /// The controller.
    pub controller: String,
    /// The certainty of the syntax, in a word.
    pub certainty: String,
    /// Positions of the axes (mm, deg) from which the program starts: high above all balls.
    pub start: IndexMap<String, f64>,
    /// The sets in their order.
    pub sets: Vec<MeasuredSet>,
    /// Sizes of balls, stems and probe of which the moves keep clear, in words.
    pub checked: String,
    /// Number of touches that are logged.
    pub touches: usize,
    /// Feed of the touches that are logged, mm/min.
    pub slow_mm_per_min: f64,
    /// Feed of approaches, mm/min.
    pub fast_mm_per_min: f64,
    /// Names of the files.
    pub names: Vec<String>,
    /// The files.
    #[serde(skip)]
    pub files: Vec<(String, Vec<u8>)>,
}

/// A ball in a pose of the rotary axes.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MeasuredSet {
    /// Name of the ball.
    pub ball: String,
    /// Name of the pose.
    pub pose: String,
    /// Positions of the axes (mm, deg) with the stylus in the middle of the ball.
    pub middle: IndexMap<String, f64>,
}

/// The balls that are measured, and the accuracy that is wanted.
#[derive(Debug, Clone, Copy)]
pub struct ProgramRequest<'a> {
    /// Names of the balls.
    pub names: &'a [String],
    pub balls: &'a ProbedBalls,
    pub stylus: Stylus,
    /// Scatter of a touch (mm).
    pub noise: f64,
    /// Time (s) between two looks of the controller at the probe.
    pub servo_period: f64,
}

/// A word of a position: `X[12.5 + #21]` where the axis is linear.
#[derive(Clone, Serialize)]
struct Word {
    word: String,
    value: String,
    linear: Option<usize>,
}

#[derive(Serialize)]
struct Axis {
    name: String,
    word: char,
    result: usize,
}

#[derive(Serialize)]
struct Ball {
    number: usize,
}

/// A position between sets; the dry run is there by `along` times its height.
#[derive(Clone, Serialize)]
struct Passed {
    words: Vec<Word>,
    along: Vec<String>,
}

#[derive(Clone, Serialize)]
struct Touch {
    above: Vec<Word>,
    start: Vec<Word>,
    target: Vec<Word>,
}

#[derive(Clone, Serialize)]
struct Set {
    number: usize,
    count: usize,
    ball: String,
    ball_number: usize,
    pose: String,
    way: Vec<Passed>,
    top: Vec<Word>,
    middle: Vec<String>,
    out: Vec<String>,
    along: Vec<String>,
    by_place: Vec<Vec<String>>,
    to_tool: Vec<Vec<String>>,
    place_by_tool: Vec<Vec<String>>,
    touches: Vec<Touch>,
    finding: Vec<Touch>,
}

#[derive(Serialize)]
struct Call {
    name: String,
    done: i64,
}

#[derive(Serialize)]
struct Program {
    machine: String,
    axes: Vec<Axis>,
    /// Words and results of the linear axes.
    linear: Vec<char>,
    results: Vec<usize>,
    balls: Vec<Ball>,
    start: Vec<Word>,
    sets: Vec<usize>,
    calls: Vec<Call>,
    radii: String,
    checked: String,
    within: String,
    fast: String,
    slow: String,
    back: String,
}

fn text(value: f64) -> String {
    format!("{:.6}", value + 0.0)
}

fn rows(of: &Matrix3<f64>) -> Vec<Vec<String>> {
    of.row_iter().map(|row| row.iter().map(|x| format!("{:.9}", x + 0.0)).collect()).collect()
}

fn refusal(message: String) -> Diagnostic {
    let help = "a measuring program takes three linear axes that place the tip, under the letters of the controller";
    Diagnostic::new(codes::E0601, message).help(help)
}

impl ProgramRequest<'_> {
    /// Returns the sizes of which the moves keep clear.
    fn words(&self) -> String {
        let (ProbedBalls { radius: ball, stem, .. }, Stylus { radius, length, shaft, body }) =
            (self.balls, self.stylus);
        format!(
            "balls of {ball} mm radius on stems of {stem}, a stylus ball of {radius}, {length} mm from its middle to \
             the probe, a shaft of {shaft} and a probe of {body}"
        )
    }
}

impl MeasuringProgram {
    /// Writes the program of a way, or says why the controller cannot go it.
    pub(crate) fn linuxcnc(
        machine: &Machine,
        TouchRoute { rest, sets: route }: &TouchRoute,
        request: &ProgramRequest<'_>,
    ) -> Result<Self, Diagnostic> {
        let manifest = ProgramManifest::linuxcnc()?;
        let mut axes = Vec::new();
        for axis in machine.axes() {
            let name = axis.name.as_str();
            let at = manifest.letters.chars().position(|letter| name.len() == 1 && name.starts_with(letter));
            let at = at.ok_or_else(|| refusal(format!("the controller has no letter for the axis {name}")))?;
            let word = name.chars().next().unwrap_or('X');
            axes.push(Axis { name: name.to_owned(), word, result: manifest.first_result + at });
        }
        let linear: Vec<usize> = (0..axes.len()).filter(|i| machine.axes()[*i].kind == AxisKind::Linear).collect();
        if linear.len() != 3 {
            return Err(refusal(format!("the machine has {} linear axes", linear.len())));
        }
        // A latch is late by up to a cycle: its scatter is that of an even distribution.
        let slow = 60.0 * libm::sqrt(12.0) * request.noise * LATCH_SHARE / request.servo_period;
        let slow = libm::floor(slow).clamp(FEEDS[0], FEEDS[1]);
        let mut sets = Vec::new();
        let poses = names_of_poses(machine, route);
        for ((number, set), pose) in (1..).zip(route).zip(poses) {
            let of = Numbered { number, count: route.len(), pose };
            sets.push(Set::of(&axes, &linear, set, request.names, of)?);
        }
        let first = |ball: &usize| route.iter().position(|set| set.ball == *ball);
        let firsts: Vec<usize> = (0..request.names.len()).filter_map(|ball| first(&ball)).collect();
        let calls = (0..route.len()).flat_map(|i| {
            let ball = route[i].ball + 1;
            let find = firsts.contains(&i).then(|| Call { name: format!("abbe_find_{ball}"), done: -(ball as i64) });
            find.into_iter().chain([Call { name: format!("abbe_set_{}", i + 1), done: i as i64 + 1 }])
        });
        let program = Program {
            machine: machine.name().chars().filter(|c| !"()".contains(*c) && !c.is_control() && c.is_ascii()).collect(),
            linear: linear.iter().map(|i| axes[*i].word).collect(),
            results: linear.iter().map(|i| axes[*i].result).collect(),
            balls: (1..=request.names.len()).map(|number| Ball { number }).collect(),
            start: words(&axes, &linear, rest),
            sets: (1..=route.len()).collect(),
            calls: calls.collect(),
            radii: text(request.balls.radius + request.stylus.radius),
            checked: request.words(),
            within: format!("{}", request.balls.within),
            fast: format!("{}", FEEDS[1]),
            slow: format!("{slow}"),
            back: format!("{BACK}"),
            axes,
        };
        let balls = firsts.iter().map(|i| sets[*i].clone()).collect();
        let files = manifest.render(&ProgramWords { program, balls, sets: sets.clone() })?;
        let named = |at: &Pose| machine.axes().iter().zip(at).map(|(a, q)| (a.name.to_string(), *q)).collect();
        Ok(Self {
            machine: machine.name().to_owned(),
            controller: manifest.title,
            certainty: manifest.certainty.level.word().to_owned(),
            checked: request.words(),
            touches: route.iter().map(|set| set.touches.len()).sum(),
            start: named(rest),
            sets: sets
                .iter()
                .zip(route)
                .map(|(of, set)| MeasuredSet {
                    ball: of.ball.clone(),
                    pose: of.pose.clone(),
                    middle: named(&set.middle),
                })
                .collect(),
            slow_mm_per_min: slow,
            fast_mm_per_min: FEEDS[1],
            names: files.iter().map(|file| file.name.clone()).collect(),
            files: files.into_iter().map(|RenderedFile { name, bytes }| (name, bytes)).collect(),
        })
    }
}

fn words(axes: &[Axis], linear: &[usize], at: &Pose) -> Vec<Word> {
    let word = |(i, axis): (usize, &Axis)| Word {
        word: axis.word.to_string(),
        value: text(at[i]),
        linear: linear.iter().position(|of| *of == i).map(|at| at + 1),
    };
    axes.iter().enumerate().map(word).collect()
}

/// Names poses of the rotary axes in the order in which they come.
fn names_of_poses(machine: &Machine, route: &[RouteSet]) -> Vec<String> {
    let rotary = |set: &RouteSet| -> Vec<f64> {
        let all = machine.axes().iter().zip(&set.middle);
        all.filter(|(axis, _)| axis.kind == AxisKind::Rotary).map(|(_, q)| *q).collect()
    };
    let mut known: Vec<Vec<f64>> = Vec::new();
    let mut name = |set: &RouteSet| {
        let own = rotary(set);
        let at = known.iter().position(|other| *other == own).unwrap_or(known.len());
        known.extend((at == known.len()).then_some(own));
        format!("p{}", at + 1)
    };
    route.iter().map(&mut name).collect()
}

/// A set in the program: its number, the number of all, and the name of its pose.
struct Numbered {
    number: usize,
    count: usize,
    pose: String,
}

impl Set {
    fn of(
        axes: &[Axis],
        linear: &[usize],
        set: &RouteSet,
        names: &[String],
        Numbered { number, count, pose }: Numbered,
    ) -> Result<Self, Diagnostic> {
        let words = |at: &Pose| words(axes, linear, at);
        let touch = |touch: &RouteTouch| Touch {
            above: words(&touch.above),
            start: words(&touch.start),
            target: words(&touch.target),
        };
        let inverse = |of: &Matrix3<f64>| {
            of.try_inverse().ok_or_else(|| refusal("the linear axes do not move the tip in all directions".to_owned()))
        };
        let place = inverse(&set.by_place)?;
        let steps = |of: Vector3<f64>| of.iter().map(|step| text(*step)).collect();
        Ok(Self {
            number,
            count,
            ball: names[set.ball].clone(),
            ball_number: set.ball + 1,
            pose,
            way: set.way.iter().map(|of| Passed { words: words(&of.at), along: steps(of.out) }).collect(),
            top: words(&set.top),
            middle: linear.iter().map(|i| text(set.middle[*i])).collect(),
            out: steps(set.out),
            along: steps(set.by_tool.column(2).into_owned()),
            by_place: rows(&set.by_place),
            to_tool: rows(&inverse(&set.by_tool)?),
            place_by_tool: rows(&(place * set.by_tool)),
            touches: set.touches.iter().map(touch).collect(),
            finding: set.finding.iter().map(touch).collect(),
        })
    }
}
