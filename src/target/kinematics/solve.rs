//! What the generated module does, in own arithmetic: the real machine from the numbers of the files,
//! ideal inverse kinematics, and the chord form of Newton's iteration for the erroneous machine.
//!
//! For a programmed pose q the command q + c satisfies tip(q + c) = ideal tip and, where the axes can,
//! the same for the direction of the tool axis. Rotary corrections x are damped least squares
//! `x = J^T (J J^T + l^2)^-1 (J x - tilt)`: exact while the weakest direction of J is above the damping,
//! bounded and smooth below it, so that nothing jumps at a singular pose.

use super::data::{CurveData, Form, Joint, Model};
use crate::algebra::{Htm, exp_hat, hat, rotation_about};
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Coordinates X Y Z A B C U V W, mm and deg.
pub type World = [f64; 9];

/// Steps after which the iteration has failed; it contracts by the size of the errors.
const MOST_STEPS: usize = 16;

/// A linear step (mm) and a rotary step (rad) that are rounding.
const SMALL: (f64, f64) = (1e-9, 1e-12);

/// Below this determinant the three linear axes do not span the room.
const FLAT: f64 = 1e-6;

/// What can be changed while the module runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// From the tip of the tool to the gauge point, mm.
    pub tool: [f64; 3],
    /// Is the direction of the tool corrected too?
    pub orientation: bool,
}

/// The ideal machine at a pose.
struct Place {
    tip: Vector3<f64>,
    axis: Vector3<f64>,
    across: [Vector3<f64>; 2],
    /// Displacement of the tip per mm or rad of each joint.
    lever: Vec<Vector3<f64>>,
    /// Rotation per rad in the two directions across the tool axis; zero for linear joints.
    tilt: Vec<Vector2<f64>>,
    /// Inverse of the columns of the solved joints, and which they are.
    inverse: Matrix3<f64>,
    solved: [usize; 3],
}

impl Model {
    /// The setting with which the module starts.
    pub fn setting(&self) -> Setting {
        Setting { tool: self.tool, orientation: self.orientation }
    }

    /// The tip with all axes at 0.
    fn tip(&self, setting: &Setting) -> Vector3<f64> {
        Vector3::from(self.gauge) - Vector3::from(setting.tool)
    }

    /// The world's coordinates of an ideal machine at a command.
    pub fn ideal_world(&self, setting: &Setting, command: &[f64]) -> World {
        let walk = self.joints.iter().zip(command).fold(Htm::identity(), |walk, (j, q)| walk.compose(&nominal(j, *q)));
        let tip = self.tip(setting);
        let mut world = [0.0; 9];
        world[..3].copy_from_slice((walk.apply(&tip.into()) - tip).as_slice());
        self.joints.iter().zip(command).filter(|(j, _)| !j.solved).for_each(|(j, q)| world[j.letter] = *q);
        world
    }

    /// The command that the module gives for a pose; `None` if it reports a failure.
    pub fn command(&self, setting: &Setting, world: &World) -> Option<Vec<f64>> {
        let mut command = self.ideal(setting, world)?;
        let place = self.place(setting, &command)?;
        let mut turned = vec![0.0; command.len()];
        for _ in 0..MOST_STEPS {
            let real = self.real(setting, &command);
            let turns = self.turns(&place, &real.linear.column(2).into_owned(), &turned, setting);
            let mut missing = place.tip - real.translation;
            let (mut largest, mut widest) = (0.0_f64, 0.0_f64);
            for (i, turn) in turns {
                missing -= place.lever[i] * turn;
                turned[i] += turn;
                command[i] += turn.to_degrees();
                widest = widest.max(turn.abs());
            }
            let ways = place.inverse * missing;
            for (i, way) in place.solved.iter().zip(ways.iter()) {
                command[*i] += way;
                largest = largest.max(way.abs());
            }
            if largest < SMALL.0 && widest < SMALL.1 {
                return Some(command);
            }
        }
        None
    }

    /// Ideal inverse kinematics: the solved joints from the tip, the others as programmed.
    fn ideal(&self, setting: &Setting, world: &World) -> Option<Vec<f64>> {
        let mut command: Vec<f64> = self.joints.iter().map(|j| if j.solved { 0.0 } else { world[j.letter] }).collect();
        let place = self.place(setting, &command)?;
        let wanted = Vector3::new(world[0], world[1], world[2]) + self.tip(setting);
        let ways = place.inverse * (wanted - place.tip);
        place.solved.iter().zip(ways.iter()).for_each(|(i, way)| command[*i] = *way);
        Some(command)
    }

    fn place(&self, setting: &Setting, command: &[f64]) -> Option<Place> {
        let mut walks = vec![Htm::identity()];
        for (joint, q) in self.joints.iter().zip(command) {
            let next = walks[walks.len() - 1].compose(&nominal(joint, *q));
            walks.push(next);
        }
        let end = walks.pop()?;
        let tip = end.apply(&self.tip(setting).into());
        let axis = end.linear.column(2).into_owned();
        let across = across(&axis);
        let directions = self.joints.iter().zip(&walks).map(|(j, walk)| walk.linear * Vector3::from(j.direction));
        let (mut lever, mut tilt) = (Vec::new(), Vec::new());
        for ((joint, walk), direction) in self.joints.iter().zip(&walks).zip(directions) {
            if joint.rotary {
                lever.push(direction.cross(&(tip - walk.apply(&joint.origin))));
                tilt.push(Vector2::new(direction.dot(&across[0]), direction.dot(&across[1])));
            } else {
                lever.push(direction);
                tilt.push(Vector2::zeros());
            }
        }
        let found: Vec<usize> = (0..lever.len()).filter(|i| self.joints[*i].solved).collect();
        let solved: [usize; 3] = found.try_into().ok()?;
        let columns = Matrix3::from_columns(&solved.map(|i| lever[i]));
        let flat = columns.determinant().abs();
        let inverse = if flat > FLAT { columns.try_inverse()? } else { return None };
        Some(Place { tip, axis, across, lever, tilt, inverse, solved })
    }

    /// Steps (rad) of the rotary joints against the tilt of the tool axis.
    fn turns(&self, place: &Place, axis: &Vector3<f64>, turned: &[f64], setting: &Setting) -> Vec<(usize, f64)> {
        let rotary: Vec<usize> =
            (0..self.joints.len()).filter(|i| setting.orientation && self.joints[*i].rotary).collect();
        let off = place.axis.cross(axis);
        let made: Vector2<f64> = rotary.iter().map(|i| place.tilt[*i] * turned[*i]).sum();
        let goal = made - Vector2::new(off.dot(&place.across[0]), off.dot(&place.across[1]));
        let total = self.damped(place, &rotary, &goal);
        rotary.iter().zip(total).map(|(i, x)| (*i, x - turned[*i])).collect()
    }

    /// `J^T (J J^T + l^2)^-1 goal`.
    fn damped(&self, place: &Place, rotary: &[usize], goal: &Vector2<f64>) -> Vec<f64> {
        if let [only] = rotary {
            let tilt = place.tilt[*only];
            let weakest = tilt.norm_squared();
            let scale = weakest + self.square(weakest);
            return vec![if scale > 0.0 { tilt.dot(goal) / scale } else { 0.0 }];
        }
        let gram: Matrix2<f64> = rotary.iter().map(|i| place.tilt[*i] * place.tilt[*i].transpose()).sum();
        let half = 0.5 * gram.trace();
        let spread = libm::hypot(0.5 * (gram[(0, 0)] - gram[(1, 1)]), gram[(0, 1)]);
        let square = self.square(half - spread);
        let (a, b, d) = (gram[(0, 0)] + square, gram[(0, 1)], gram[(1, 1)] + square);
        let determinant = a * d - b * b;
        let weights = if determinant > 0.0 {
            Vector2::new(d * goal[0] - b * goal[1], a * goal[1] - b * goal[0]) / determinant
        } else {
            Vector2::zeros()
        };
        rotary.iter().map(|i| place.tilt[*i].dot(&weights)).collect()
    }

    /// l^2: 0 from the threshold on, and reaching it without a kink.
    fn square(&self, weakest: f64) -> f64 {
        let threshold = self.damping * self.damping;
        let below = (1.0 - weakest.max(0.0) / threshold).max(0.0);
        threshold * below * below
    }

    /// The real machine at a command: orientation of the tool, place of its tip.
    fn real(&self, setting: &Setting, command: &[f64]) -> Htm<f64> {
        let clamped = Htm::about(&self.workpiece, self.error(&self.clamping, true));
        let walk = self.joints.iter().zip(command).fold(clamped, |walk, (j, q)| walk.compose(&self.joint(j, *q)));
        let walk = walk.compose(&Htm::about(&self.gauge, self.error(&self.spindle, false)));
        let tip = walk.apply(&(self.tip(setting) + Vector3::from(self.tool_clamping)).into());
        Htm { linear: walk.linear, translation: tip }
    }

    /// A joint with its errors.
    fn joint(&self, joint: &Joint, q: f64) -> Htm<f64> {
        let location = self.error(&joint.location, joint.location_inverted);
        let motion = motion(joint, q);
        let motion = match (self.carried_body, joint.rotary) {
            (true, _) => motion,
            (false, false) => Htm::translation(location.linear * motion.translation),
            (false, true) => location.compose(&motion).compose(&location.inverse().unwrap_or_else(Htm::identity)),
        };
        let six = joint.curves.map(|curves| self.mean(&curves, q));
        let error = self.error(&six, joint.inverted);
        let bracket = if joint.outside { error.compose(&motion) } else { motion.compose(&error) };
        let bracket = match (self.carried_body, joint.workpiece_side) {
            (false, _) => bracket,
            (true, true) => bracket.compose(&location),
            (true, false) => location.compose(&bracket),
        };
        Htm::about(&joint.origin, bracket)
    }

    fn error(&self, six: &[f64; 6], inverted: bool) -> Htm<f64> {
        let [dx, dy, dz, ex, ey, ez] = *six;
        let turn = [ex, ey, ez];
        let linear = if self.linearised { Matrix3::identity() + hat(&turn) } else { exp_hat(&turn) };
        let matrix = Htm { linear, translation: Vector3::new(dx, dy, dz) };
        if inverted { matrix.inverse().unwrap_or(matrix) } else { matrix }
    }

    /// The mean of the curves of an error.
    fn mean(&self, curves: &[Option<usize>; 2], q: f64) -> f64 {
        let value = |index: &usize| self.curves[*index].value(q);
        match curves {
            [Some(one), Some(other)] => 0.5 * (value(one) + value(other)),
            [Some(one), None] | [None, Some(one)] => value(one),
            [None, None] => 0.0,
        }
    }
}

/// The nominal motion about machine zero.
fn nominal(joint: &Joint, q: f64) -> Htm<f64> {
    Htm::about(&joint.origin, motion(joint, q))
}

fn motion(joint: &Joint, q: f64) -> Htm<f64> {
    if joint.rotary {
        Htm { linear: rotation_about(&joint.direction, sin_cos_degrees(q)), ..Htm::identity() }
    } else {
        Htm::translation(Vector3::from(joint.direction) * q)
    }
}

/// Two unit vectors across a direction.
fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    // The coordinate least along the axis makes a first vector that is never short.
    let least = axis.iamin();
    let mut unit = Vector3::zeros();
    unit[least] = 1.0;
    let first = axis.cross(&unit).normalize();
    [first, axis.cross(&first)]
}

impl CurveData {
    /// Value (mm or rad) at a position (mm or deg).
    fn value(&self, q: f64) -> f64 {
        match self.form {
            Form::Polynomial => self.numbers.iter().rev().fold(0.0, |sum, c| sum * q + c),
            Form::Harmonics => self.numbers.chunks_exact(2).enumerate().map(|(k, term)| harmonic(k, term, q)).sum(),
            Form::Linear | Form::Cubic => self.between(q),
        }
    }

    /// Between points; the end values are held, or the argument wraps.
    fn between(&self, q: f64) -> f64 {
        let count = self.numbers.len() / self.form.width();
        let (at, rest) = self.numbers.split_at(count);
        let (values, second) = rest.split_at(count);
        if count < 2 {
            return values[0];
        }
        let x = if self.period > 0.0 {
            q - self.period * libm::floor((q - at[0]) / self.period)
        } else {
            q.clamp(at[0], at[count - 1])
        };
        let i = at.iter().rposition(|p| *p <= x).unwrap_or(0).min(count - 2);
        let width = at[i + 1] - at[i];
        let (right, left) = ((x - at[i]) / width, (at[i + 1] - x) / width);
        let straight = left * values[i] + right * values[i + 1];
        if self.form == Form::Linear {
            return straight;
        }
        let bend = |share: f64| share * (share * share - 1.0);
        straight + (bend(left) * second[i] + bend(right) * second[i + 1]) * width * width / 6.0
    }
}

fn harmonic(order: usize, term: &[f64], q: f64) -> f64 {
    let (sine, cosine) = sin_cos_degrees(order as f64 * q);
    term[0] * cosine + term[1] * sine
}
