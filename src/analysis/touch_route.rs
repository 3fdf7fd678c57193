//! The way of a touch probe around balls on the workpiece: a set is a ball in one pose of the rotary axes, touched at
//! the pole along the tool axis and around it.
//!
//! Every move is checked against balls, their stems and the travel, wherever within their uncertainty the balls are.
//! From set to set the probe retracts as far as it must, at most to where it stands at rest: a set that is clear by
//! itself is so in any order, and what can be touched is one question for a plan and for a program.

use super::{Miss, place, rest};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, Pose};
use nalgebra::{Matrix3, Vector3};

/// Distance (mm) that is kept besides the uncertainty of places.
const RESERVE: f64 = 1.0;
/// Distance (mm) of a touch's start from the ball, and of its target inside, besides that uncertainty.
const STANDOFF: f64 = 2.0;
/// Length (mm) of stems and probe bodies.
const REST_LENGTH: f64 = 300.0;
/// Step (mm, deg) at which moves are looked at.
const STEP: f64 = 0.25;
/// Heights (mm) above the balls that are tried for the way from set to set, the last that is in reach for the rest.
const LIFTS: [f64; 6] = [0.0, 20.0, 50.0, 100.0, 150.0, 200.0];
/// Touches around a ball.
pub const AROUND: usize = 7;
/// Angle (deg) by which they turn from set to set, and number of turns until they are where they were.
const TURN: f64 = 30.0;
const TURNS: usize = 12;

/// The stylus and the body of the probe that holds it, mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Stylus {
    /// Radius of its ball, whose middle is the functional point.
    pub radius: f64,
    /// Distance from the middle of the ball to the body.
    pub length: f64,
    /// Radius of its shaft, less than that of the ball.
    pub shaft: f64,
    /// Radius of the body.
    pub body: f64,
}

/// Sizes of a touch probe and of the balls that it touches, mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ProbeSizes {
    /// Radius of the balls; above 0.
    #[serde(rename = "ball_radius")]
    pub ball_radius_mm: f64,
    /// The stylus; the functional point of the machine file is the middle of its ball.
    pub stylus: Stylus,
    /// Radius of the stems of the balls, along -Z of the workpiece; half that of the balls by default.
    #[serde(rename = "stem")]
    pub stem_mm: Option<f64>,
    /// Distance that each ball may be away from its place; above 0.
    #[serde(rename = "within")]
    pub within_mm: f64,
}

/// Balls of 25 mm within 1 mm, a stylus of 6 mm that is 50 mm long.
impl Default for ProbeSizes {
    fn default() -> Self {
        let stylus = Stylus { radius: 3.0, length: 50.0, shaft: 2.0, body: 20.0 };
        Self { ball_radius_mm: 12.5, stylus, stem_mm: None, within_mm: 1.0 }
    }
}

impl ProbeSizes {
    /// True if all are above 0, and the shaft of the stylus is thinner than its ball.
    pub fn are_possible(&self) -> bool {
        let Stylus { radius, length, shaft, body } = self.stylus;
        let all = [self.ball_radius_mm, self.within_mm, radius, length, shaft, body, self.stem()];
        all.iter().all(|x| *x > 0.0 && x.is_finite()) && shaft < radius
    }

    fn stem(&self) -> f64 {
        self.stem_mm.unwrap_or(self.ball_radius_mm / 2.0)
    }

    /// Returns balls of this size with their middles at these places (mm, from the workpiece origin).
    pub fn balls(&self, centres: Vec<Vector3<f64>>) -> ProbedBalls {
        ProbedBalls { centres, radius: self.ball_radius_mm, stem: self.stem(), within: self.within_mm }
    }
}

/// Balls of one size on the workpiece.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbedBalls {
    /// Middles, from the workpiece origin (mm).
    pub centres: Vec<Vector3<f64>>,
    /// Radius (mm).
    pub radius: f64,
    /// Radius (mm) of the stems on which they stand, along -Z of the workpiece.
    pub stem: f64,
    /// Distance (mm) that each may be away from its place.
    pub within: f64,
}

/// A touch, axes in mm and deg.
#[derive(Debug, Clone, PartialEq)]
pub struct RouteTouch {
    /// Above the start, from where the stylus comes down along the tool axis.
    pub above: Pose,
    pub start: Pose,
    /// The end of a touch that meets nothing.
    pub target: Pose,
}

/// The way of a probe.
#[derive(Debug, Clone, PartialEq)]
pub struct TouchRoute {
    /// Its beginning: high above all balls, rotary axes at 0 or nearest to it.
    pub rest: Pose,
    pub sets: Vec<RouteSet>,
}

/// A place on the way from set to set.
#[derive(Debug, Clone, PartialEq)]
pub struct PassedPose {
    pub at: Pose,
    /// Displacement of the linear axes (mm) that moves the tip by 1 mm out along the tool axis.
    pub out: Vector3<f64>,
}

/// The way around a ball in a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct RouteSet {
    /// Index of the ball.
    pub ball: usize,
    /// The way to `top` from that of the set before, or from the rest; it ends with `top`.
    pub way: Vec<PassedPose>,
    /// Above all balls along the tool axis, where the set begins and ends.
    pub top: Pose,
    /// The ball: axes with the stylus in its middle.
    pub middle: Pose,
    /// The pole, then around.
    pub touches: Vec<RouteTouch>,
    /// The pole, then two sides and the two across, by which the ball is found.
    pub finding: Vec<RouteTouch>,
    /// Displacement of the linear axes (mm) from a touch on the way out along the tool axis.
    pub out: Vector3<f64>,
    /// Displacements of the linear axes by those of the tip in the workpiece frame.
    pub by_place: Matrix3<f64>,
    /// The same along the two directions of the sides of the finding, and along the tool axis.
    pub by_tool: Matrix3<f64>,
}

/// A reason for which a set cannot be measured.
#[derive(Debug, Clone, PartialEq)]
pub enum RouteFailure {
    /// The axes do not reach a point of this set.
    OutOfReach(usize, Box<Miss>),
    /// A move of this set comes too near: what it would meet, and the distance (mm) that is left.
    Blocked(usize, &'static str, f64),
    /// The way to this set from the rest does.
    Way(usize),
    /// The axes do not reach above all balls, or the probe is not clear of them there.
    Rest,
}

/// Balls, probe and machine: what can be touched, and how the probe gets there.
#[derive(Debug, Clone)]
pub struct TouchScene<'a> {
    machine: &'a Machine,
    balls: &'a ProbedBalls,
    stylus: Stylus,
    rest: Pose,
}

/// A set, and how the probe gets to it from the rest.
struct Approached {
    set: RouteSet,
    /// Above its top, as high as it must be.
    high: Pose,
    /// Between the rest and there.
    from_rest: Vec<Pose>,
}

/// The ways in which a move may meet the ball of its set.
#[derive(Clone, Copy, PartialEq)]
enum Own {
    /// Keep clear of it.
    Clear,
    /// Meet it with the stylus.
    Touched(usize),
    /// Anything: it has stopped the move before.
    Ignored(usize),
}

/// Stylus in the workpiece frame: the middle of its ball, and the tool axis.
#[derive(Clone, Copy)]
struct Held {
    tip: Vector3<f64>,
    axis: Vector3<f64>,
}

impl<'a> TouchScene<'a> {
    /// Returns the scene with its rest, as high above all balls as the axes go; fails if there is none.
    pub fn of(machine: &'a Machine, balls: &'a ProbedBalls, stylus: Stylus) -> Result<Self, RouteFailure> {
        let mut scene = Self { machine, balls, stylus, rest: rest(machine) };
        let middle = balls.centres.iter().sum::<Vector3<f64>>() / balls.centres.len().max(1) as f64;
        let axis = scene.held(&scene.rest).axis;
        let height = scene.height(&middle, &axis);
        let at = |lift: &f64| place(machine, &(middle + axis * (height + lift)), &scene.rest).ok();
        let found = LIFTS.iter().rev().filter_map(at).find(|pose| scene.is_clear(&[pose.clone(), pose.clone()]));
        scene.rest = found.ok_or(RouteFailure::Rest)?;
        Ok(scene)
    }

    /// Returns the way through sets, each a ball and a pose whose rotary axes count, in this order.
    pub fn route(&self, sets: &[(usize, Pose)]) -> Result<TouchRoute, RouteFailure> {
        let mut before: Option<Approached> = None;
        let mut route = Vec::new();
        for (number, (ball, pose)) in sets.iter().enumerate() {
            let mut next = self.approached(number, *ball, pose)?;
            let way = match &before {
                None => next.from_rest.clone(),
                Some(before) => self.between(before, &next),
            };
            let ends = [next.high.clone(), next.set.top.clone()];
            let mut way: Vec<Pose> = way.into_iter().chain(ends).collect();
            way.dedup();
            next.set.way = way.into_iter().map(|at| PassedPose { out: self.out(&at), at }).collect();
            route.push(next.set.clone());
            before = Some(next);
        }
        Ok(TouchRoute { rest: self.rest.clone(), sets: route })
    }

    /// Returns where the axes are with the stylus in the middle of a ball, in a pose whose rotary axes count; none if
    /// the ball cannot be touched so.
    pub fn touchable(&self, ball: usize, pose: &Pose) -> Option<Pose> {
        self.approached(0, ball, pose).ok().map(|of| of.set.middle)
    }

    /// The set of a ball, turned on until it is clear, with a clear way from the rest.
    fn approached(&self, number: usize, ball: usize, pose: &Pose) -> Result<Approached, RouteFailure> {
        let mut turned = (0..TURNS).map(|turn| self.set(number, number + turn, ball, pose));
        let first = turned.next().unwrap_or(Err(RouteFailure::Rest));
        let set = match first {
            // Another turn reaches no farther.
            Err(RouteFailure::Blocked(..)) => turned.find_map(Result::ok).map_or(first, Ok)?,
            other => other?,
        };
        for high in LIFTS.map(|lift| self.lift(&set, lift)) {
            let is_clear = |via: &Vec<Pose>| {
                let to = [high.clone(), set.top.clone()];
                self.is_clear(&std::iter::once(&self.rest).chain(via).chain(&to).cloned().collect::<Vec<_>>())
            };
            let ways = [Vec::new(), vec![self.turned(&set)]];
            if let Some(from_rest) = ways.into_iter().find(is_clear) {
                return Ok(Approached { set, high, from_rest });
            }
        }
        Err(RouteFailure::Way(number))
    }

    /// The rest with the rotary axes of a set.
    fn turned(&self, set: &RouteSet) -> Pose {
        let at = |(i, q): (usize, &f64)| if follows(self.machine, i) { self.rest[i] } else { *q };
        set.middle.iter().enumerate().map(at).collect()
    }

    /// The way from the top of a set to above that of another: the shortest that is clear.
    fn between(&self, from: &Approached, to: &Approached) -> Vec<Pose> {
        let retracted = vec![self.turned(&from.set), self.turned(&to.set)];
        let is_clear = |via: &Vec<Pose>| {
            let ends = (std::iter::once(&from.high), std::iter::once(&to.high));
            self.is_clear(&ends.0.chain(via).chain(ends.1).cloned().collect::<Vec<_>>())
        };
        let over_rest = || -> Vec<Pose> {
            let back = from.from_rest.iter().rev();
            back.chain([&self.rest]).chain(&to.from_rest).cloned().collect()
        };
        let way = [Vec::new(), retracted].into_iter().find(is_clear).unwrap_or_else(over_rest);
        let start = (from.high != from.set.top).then(|| from.high.clone());
        start.into_iter().chain(way).collect()
    }

    /// The displacement of the linear axes for 1 mm of the tip along the tool axis; 0 where they are at both ends.
    fn out(&self, at: &Pose) -> Vector3<f64> {
        let held = self.held(at);
        let moved = |way: f64| {
            let to = place(self.machine, &(held.tip + held.axis * way), at).ok()?;
            let steps: Vec<f64> = (0..at.len()).filter(|i| follows(self.machine, *i)).map(|i| to[i] - at[i]).collect();
            Some(Vector3::from_fn(|k, _| steps.get(k).map_or(0.0, |step| step * way)))
        };
        moved(1.0).or_else(|| moved(-1.0)).unwrap_or_default()
    }

    fn is_clear(&self, way: &[Pose]) -> bool {
        way.windows(2).all(|ends| self.nearest(&ends[0], &ends[1], Own::Clear).1 >= 0.0)
    }

    /// Height (mm) above a place along the tool axis at which the stylus is above all balls.
    fn height(&self, place: &Vector3<f64>, axis: &Vector3<f64>) -> f64 {
        let reach = self.balls.radius + self.stylus.radius;
        let rise = |ball: &Vector3<f64>| axis.dot(&(ball - place)) + reach + 2.0 * self.balls.within + RESERVE;
        self.balls.centres.iter().map(rise).fold(reach + self.balls.within + STANDOFF, f64::max)
    }

    fn held(&self, pose: &[f64]) -> Held {
        let nominal = NominalPose::in_part(self.machine, pose).pose;
        Held { tip: nominal.translation, axis: nominal.linear * Vector3::from(self.machine.tool().direction) }
    }

    /// The set of a ball, its touches turned by so many steps.
    fn set(&self, number: usize, turn: usize, ball: usize, pose: &Pose) -> Result<RouteSet, RouteFailure> {
        let at = |tip: Vector3<f64>| {
            place(self.machine, &tip, pose).map_err(|miss| RouteFailure::OutOfReach(number, Box::new(miss)))
        };
        let centre = self.balls.centres[ball];
        let middle = at(centre)?;
        let tool = NominalPose::in_part(self.machine, &middle).pose.linear;
        let axis = self.held(&middle).axis;
        // Across the tool axis; along Z of the tool these are its X and Y.
        let least = (0..3).min_by(|a, b| axis_part(self.machine, *a).total_cmp(&axis_part(self.machine, *b)));
        let first: Vector3<f64> = tool.column(least.unwrap_or(0)).into_owned();
        let first = (first - axis * axis.dot(&first)).normalize();
        let frame = Matrix3::from_columns(&[first, axis.cross(&first), axis]);
        let (reach, off) = (self.balls.radius + self.stylus.radius, self.balls.within + STANDOFF);
        let height = self.height(&centre, &axis);
        let touch = |out: Vector3<f64>| -> Result<RouteTouch, RouteFailure> {
            let out = frame * out;
            Ok(RouteTouch {
                above: at(centre + (out + axis * (1.0 - out.dot(&axis))) * (reach + off))?,
                start: at(centre + out * (reach + off))?,
                target: at(centre + out * (reach - off))?,
            })
        };
        let around = |step: usize| {
            let angle = (step as f64 * 360.0 / AROUND as f64 + turn as f64 * TURN).to_radians();
            Vector3::new(libm::cos(angle), libm::sin(angle), 0.0)
        };
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let linear: Vec<usize> = (0..pose.len()).filter(|i| follows(self.machine, *i)).collect();
        let moved = |by: Vector3<f64>| {
            let to = at(centre + by)?;
            Ok(Vector3::from_fn(|k, _| linear.get(k).map_or(0.0, |i| to[*i] - middle[*i])))
        };
        let moves = |of: Matrix3<f64>| -> Result<Matrix3<f64>, RouteFailure> {
            Ok(Matrix3::from_columns(&[moved(of * x)?, moved(of * y)?, moved(of * z)?]))
        };
        let set = RouteSet {
            ball,
            way: Vec::new(),
            top: at(centre + axis * height)?,
            touches: std::iter::once(z).chain((0..AROUND).map(around)).map(touch).collect::<Result<_, _>>()?,
            finding: [z, x, -x, y, -y].into_iter().map(touch).collect::<Result<_, _>>()?,
            out: moved(axis)? * height,
            by_place: moves(Matrix3::identity())?,
            by_tool: moves(frame)?,
            middle,
        };
        self.check(number, &set)?;
        Ok(set)
    }

    /// Raises the top of a set along the tool axis, as far as the axes go.
    fn lift(&self, set: &RouteSet, lift: f64) -> Pose {
        let held = self.held(&set.top);
        let raised = |by: f64| place(self.machine, &(held.tip + held.axis * by), &set.middle).ok();
        let heights = LIFTS.iter().rev().filter(|height| **height <= lift);
        heights.copied().filter(|height| *height > 0.0).find_map(raised).unwrap_or_else(|| set.top.clone())
    }

    /// Fails if a move of a set comes too near to a ball or a stem.
    fn check(&self, number: usize, set: &RouteSet) -> Result<(), RouteFailure> {
        let refuse = |(what, left): (&'static str, f64)| match left < 0.0 {
            true => Err(RouteFailure::Blocked(number, what, left)),
            false => Ok(()),
        };
        let clear = Own::Clear;
        for touches in [&set.touches, &set.finding] {
            let mut from = &set.top;
            for touch in touches {
                refuse(self.nearest(from, &touch.above, clear))?;
                refuse(self.nearest(&touch.above, &touch.start, clear))?;
                let contact: Pose = touch.start.iter().zip(&touch.target).map(|(a, b)| (a + b) / 2.0).collect();
                refuse(self.nearest(&touch.start, &contact, Own::Touched(set.ball)))?;
                refuse(self.nearest(&contact, &touch.target, Own::Ignored(set.ball)))?;
                // Where it broke off.
                let mut steps = set.out.iter();
                let moved = |(i, q): (usize, &f64)| {
                    if follows(self.machine, i) { q + steps.next().unwrap_or(&0.0) } else { *q }
                };
                let out: Pose = touch.start.iter().enumerate().map(moved).collect();
                refuse(self.nearest(&touch.start, &out, clear))?;
                refuse(self.nearest(&out, &set.top, clear))?;
                from = &touch.above;
            }
            refuse(self.nearest(from, &set.top, clear))?;
        }
        Ok(())
    }

    /// Returns what a move comes nearest to, and the distance (mm) beyond what must be left.
    fn nearest(&self, from: &Pose, to: &Pose, own: Own) -> (&'static str, f64) {
        let far = from.iter().zip(to).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
        let count = libm::ceil(far / STEP).max(1.0) as usize;
        let at = |i: usize| {
            let share = i as f64 / count as f64;
            self.held(&from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect::<Vec<_>>())
        };
        let mut last = at(0);
        let mut nearest = ("nothing", f64::MAX);
        for i in 0..=count {
            let here = at(i);
            // Between two looks no point of the probe moves farther than this.
            let length = self.stylus.length + REST_LENGTH;
            let moved = (here.tip - last.tip).norm() + length * (here.axis - last.axis).norm();
            for (ball, centre) in self.balls.centres.iter().enumerate().filter(|(ball, _)| own != Own::Ignored(*ball)) {
                let is_touched = own == Own::Touched(ball);
                let margin = RESERVE + moved + if is_touched { 0.0 } else { self.balls.within };
                for (what, left) in self.distances(&here, centre, is_touched) {
                    if left - margin < nearest.1 {
                        nearest = (what, left - margin);
                    }
                }
            }
            last = here;
        }
        nearest
    }

    /// Distances of the probe from a ball and its stem. A ball that stops the stylus is not met by it.
    fn distances(&self, held: &Held, centre: &Vector3<f64>, is_touched: bool) -> [(&'static str, f64); 2] {
        let Stylus { radius, length, shaft, body } = self.stylus;
        let parts = [(0.0, 0.0, radius), (0.0, length, shaft), (length + body, length + REST_LENGTH, body)];
        let down = -Vector3::z() * REST_LENGTH;
        let mut found = [("a ball", f64::MAX), ("the stem of a ball", f64::MAX)];
        for (from, to, thick) in parts {
            let (start, way) = (held.tip + held.axis * from, held.axis * (to - from));
            if !(is_touched && from == 0.0) {
                let left = between(&start, &way, centre, &Vector3::zeros()) - self.balls.radius - thick;
                found[0].1 = found[0].1.min(left);
            }
            found[1].1 = found[1].1.min(between(&start, &way, centre, &down) - self.balls.stem - thick);
        }
        found
    }
}

fn axis_part(machine: &Machine, k: usize) -> f64 {
    machine.tool().direction[k].abs()
}

/// Returns the distance of two segments, each a start and a way.
fn between(p: &Vector3<f64>, u: &Vector3<f64>, q: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
    let (w, a, b, c) = (p - q, u.dot(u), u.dot(v), v.dot(v));
    let (d, e) = (u.dot(&w), v.dot(&w));
    let on = |x: f64| x.clamp(0.0, 1.0);
    let on_u = |t: f64| if a > 0.0 { on((b * t - d) / a) } else { 0.0 };
    let on_v = |s: f64| if c > 0.0 { on((b * s + e) / c) } else { 0.0 };
    let crossing = a * c - b * b;
    let s = if crossing > 1e-12 * a * c { on((b * e - c * d) / crossing) } else { 0.0 };
    let t = on_v(s);
    let s = on_u(t);
    (w + u * s - v * on_v(s)).norm()
}

/// True for axes that follow the tip.
fn follows(machine: &Machine, axis: usize) -> bool {
    machine.axes()[axis].kind == AxisKind::Linear
}
