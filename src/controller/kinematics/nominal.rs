//! The nominal machine from the numbers of the files: where its tool is, and how every axis moves it.

use super::data::{ModuleJoint, ModuleModel};
use crate::algebra::{Htm, rotation_about};
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix3, Vector3};

/// The values that can be changed while the module runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The vector from the tip of the tool to the gauge point, mm.
    pub tool: [f64; 3],
    /// True if the direction of the tool is corrected too.
    pub orientation: bool,
}

/// The nominal machine at a command.
pub struct BodyPlace {
    /// The tip of the tool.
    pub tip: Vector3<f64>,
    /// The rotation of the tool from its orientation with all axes at 0.
    pub rotation: Matrix3<f64>,
    /// Displacement of the tip per mm or rad of each joint.
    pub lever: Vec<Vector3<f64>>,
    /// Rotation of the tool per rad of each joint; zero for linear joints.
    pub turn: Vec<Vector3<f64>>,
}

impl BodyPlace {
    /// The direction of the tool axis.
    pub fn axis(&self) -> Vector3<f64> {
        self.rotation.column(2).into_owned()
    }
}

impl ModuleModel {
    /// The setting with which the module starts.
    pub fn setting(&self) -> Setting {
        Setting { tool: self.tool, orientation: self.orientation }
    }

    /// The tip with all axes at 0.
    pub fn tip(&self, setting: &Setting) -> Vector3<f64> {
        Vector3::from(self.gauge) - Vector3::from(setting.tool)
    }

    /// The nominal machine at a command.
    pub fn place(&self, setting: &Setting, command: &[f64]) -> BodyPlace {
        let (mut walk, mut lines) = (Htm::identity(), Vec::new());
        for (joint, q) in self.joints.iter().zip(command) {
            lines.push((walk.linear * Vector3::from(joint.direction), walk.apply(&joint.origin)));
            walk = walk.compose(&Htm::about(&joint.origin, motion(joint, *q)));
        }
        let tip = walk.apply(&self.tip(setting).into());
        let both = self.joints.iter().zip(lines).map(|(joint, (way, foot))| match joint.rotary {
            true => (way.cross(&(tip - foot)), way),
            false => (way, Vector3::zeros()),
        });
        let (lever, turn) = both.unzip();
        BodyPlace { tip, rotation: walk.linear, lever, turn }
    }
}

/// The nominal motion of a joint, its line through the zero of its own frame.
pub fn motion(joint: &ModuleJoint, q: f64) -> Htm<f64> {
    if joint.rotary {
        Htm { linear: rotation_about(&joint.direction, sin_cos_degrees(q)), ..Htm::identity() }
    } else {
        Htm::translation(Vector3::from(joint.direction) * q)
    }
}

/// Returns the rotation of extrinsic X-Y-Z angles (fixed-axis roll, pitch and yaw, deg).
pub fn from_roll_pitch_yaw(angles: &[f64; 3]) -> Matrix3<f64> {
    let about = |k: usize| {
        let unit = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        rotation_about(&unit, sin_cos_degrees(angles[k]))
    };
    about(2) * about(1) * about(0)
}

/// The inverse function; at a pitch of 90 deg all of the turn is taken for yaw.
pub fn to_roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    let level = libm::hypot(r[(0, 0)], r[(1, 0)]);
    let pitch = libm::atan2(-r[(2, 0)], level);
    let (roll, yaw) = if level > GIMBAL {
        (libm::atan2(r[(2, 1)], r[(2, 2)]), libm::atan2(r[(1, 0)], r[(0, 0)]))
    } else {
        (0.0, libm::atan2(-r[(0, 1)], r[(1, 1)]))
    };
    [roll, pitch, yaw].map(f64::to_degrees)
}

/// Cosine of a pitch below which roll and yaw are one.
const GIMBAL: f64 = 1e-6;

/// The rotation vector of a rotation, or the skew part of one near none.
pub fn rotation_vector(m: &Matrix3<f64>) -> Vector3<f64> {
    let skew = Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]) * 0.5;
    let sine = skew.norm();
    let angle = libm::atan2(sine, 0.5 * (m.trace() - 1.0));
    if sine > SMALL_TURN { skew * (angle / sine) } else { skew }
}

/// A turn of which angle and sine are the same double.
const SMALL_TURN: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roll_pitch_and_yaw_are_those_of_the_controller() {
        // gomath.c, go_rpy_mat_convert: the third row is -sin p, cos p sin r, cos p cos r.
        let r = from_roll_pitch_yaw(&[20.0, 30.0, 40.0]);
        let [(sr, cr), (sp, cp), (sy, cy)] = [20.0, 30.0, 40.0].map(sin_cos_degrees);
        let printed = Matrix3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        );
        assert!((r - printed).norm() < 1e-15);
        for angles in [[20.0, 30.0, 40.0], [-170.0, 80.0, 100.0], [0.0, 90.0, 25.0], [0.0, -90.0, -60.0]] {
            let back = to_roll_pitch_yaw(&from_roll_pitch_yaw(&angles));
            assert!(angles.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-11), "{angles:?} {back:?}");
        }
    }

    #[test]
    fn rotation_vectors_up_to_half_a_turn() {
        let unit = Vector3::new(1.0, -2.0, 2.0) / 3.0;
        for angle in [0.0, 1e-9, 0.1, 90.0, 179.0] {
            let vector = rotation_vector(&rotation_about(&unit.into(), sin_cos_degrees(angle)));
            assert!((vector - unit * f64::to_radians(angle)).norm() < 1e-14, "{angle}");
        }
    }
}
