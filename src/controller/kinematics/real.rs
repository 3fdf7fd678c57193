//! The real machine from the numbers of the files: joints with their errors, curves.

use super::data::{CurveData, Form, ModuleJoint, ModuleModel};
use super::nominal::{Setting, motion};
use crate::algebra::{Htm, exp_hat, hat};
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix3, Vector3};

impl ModuleModel {
    /// The real machine at a command: orientation of the tool, place of its tip.
    pub fn real(&self, setting: &Setting, command: &[f64]) -> Htm<f64> {
        let clamped = Htm::about(&self.workpiece, self.error(&self.clamping, true));
        let walk = self.joints.iter().zip(command).fold(clamped, |walk, (j, q)| walk.compose(&self.joint(j, *q)));
        let walk = walk.compose(&Htm::about(&self.gauge, self.error(&self.spindle, false)));
        let tip = walk.apply(&(self.tip(setting) + Vector3::from(self.tool_clamping)).into());
        Htm { linear: walk.linear, translation: tip }
    }

    fn joint(&self, joint: &ModuleJoint, q: f64) -> Htm<f64> {
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

    fn mean(&self, curves: &[Option<usize>; 2], q: f64) -> f64 {
        let value = |index: &usize| self.curves[*index].value(q);
        match curves {
            [Some(one), Some(other)] => 0.5 * (value(one) + value(other)),
            [Some(one), None] | [None, Some(one)] => value(one),
            [None, None] => 0.0,
        }
    }
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
        let bend = |fraction: f64| fraction * (fraction * fraction - 1.0);
        straight + (bend(left) * second[i] + bend(right) * second[i + 1]) * width * width / 6.0
    }
}

fn harmonic(order: usize, term: &[f64], q: f64) -> f64 {
    let (sine, cosine) = sin_cos_degrees(order as f64 * q);
    term[0] * cosine + term[1] * sine
}
