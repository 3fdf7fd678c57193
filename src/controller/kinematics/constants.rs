//! Modules of the controller's own with a few constants, fitted to the deviation of the functional
//! point over the volume: a 3x3 matrix, or the lines of a tilting table.

use super::data::WORLD;
use crate::algebra::rotation_about;
use crate::compensation::{Correction, Scope, correct};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Bare, Field, Order, random_poses};
use crate::machine::{Approach, AxisKind, Branch, Machine, sin_cos_degrees};
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

/// Poses to which constants are fitted.
const POSES: usize = 1000;

/// joint = C axis, for X, Y, Z.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearMap {
    /// Row by row.
    pub matrix: [f64; 9],
    /// Index in the walk of X, Y and Z.
    axes: [usize; 3],
}

impl LinearMap {
    /// Fits the matrix with the smallest residual deviation of the functional point (least squares).
    pub fn fitted(machine: &Machine, letters: &[(usize, usize)]) -> Result<Self, Diagnostic> {
        let axes = xyz(machine, letters).filter(|_| letters.len() == 3).ok_or_else(|| {
            Diagnostic::new(
                codes::E0751,
                "this kinematics module is for machines with the linear axes X, Y, Z and no other",
            )
            .help("for other machines take the target linuxcnc-kins")
        })?;
        let (mut gram, mut moment) = (Matrix3::zeros(), Matrix3::zeros());
        for pose in random_poses(machine, POSES, 0) {
            let Correction(added) = correct(machine, &pose, Approach::Mean, Scope::POSITION).correction;
            let [q, c] = [&pose, &added].map(|all| Vector3::from(axes.map(|i| all[i])));
            gram += q * q.transpose();
            moment += c * q.transpose();
        }
        let inverse = gram.try_inverse().unwrap_or_else(Matrix3::zeros);
        let fitted = Matrix3::identity() + moment * inverse;
        Ok(Self { matrix: std::array::from_fn(|i| fitted[(i / 3, i % 3)]), axes })
    }

    /// Returns the joint positions that the module commands.
    pub fn command(&self, pose: &[f64]) -> Vec<f64> {
        let mut command = pose.to_vec();
        for (row, axis) in self.axes.iter().enumerate() {
            command[*axis] = (0..3).map(|k| self.matrix[3 * row + k] * pose[self.axes[k]]).sum();
        }
        command
    }

    pub(super) fn rounded(mut self, decimals: u8) -> Self {
        self.matrix = self.matrix.map(|x| round(x, decimals));
        self
    }
}

/// Indices in the walk of the linear axes X, Y and Z.
fn xyz(machine: &Machine, letters: &[(usize, usize)]) -> Option<[usize; 3]> {
    let linear = |axis: &usize| machine.axes()[*axis].kind == AxisKind::Linear;
    let find = |letter: usize| letters.iter().position(|(l, _)| *l == letter).filter(linear);
    Some([find(0)?, find(1)?, find(2)?])
}

/// The lines of a tilting table A or B with a table C on it, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Centres {
    /// 0 if the table tilts about X (A), 1 if about Y (B).
    pub tilt: usize,
    /// A point of C's line, the vector from it to the tilting line, the length of the tool.
    pub lines: [f64; 7],
    /// Index in the walk of X, Y and Z.
    axes: [usize; 3],
    /// Index in the walk of C and of the tilting axis.
    rotary: [usize; 2],
}

impl Centres {
    /// Fits the nominal lines, moved for the smallest residual deviation (least squares).
    pub fn fitted(machine: &Machine, letters: &[(usize, usize)]) -> Result<Self, Diagnostic> {
        let nominal = Self::nominal(machine, letters).ok_or_else(|| {
            Diagnostic::new(
                codes::E0751,
                "this kinematics module is for a table C on a tilting table A or B, X, Y, \
             Z along the machine axes, \
             and tables that turn right-handed",
            )
            .help(
                "a chain such as \"w C' A' b X Y Z t\" with `sense: direct` for A and C; for other machines \
                 take the target linuxcnc-kins",
            )
        })?;
        let bare = Bare { machine, order: Order::Exact };
        let (mut gram, mut moment) = (Matrix4::identity() * 1e-9, Vector4::zeros());
        for pose in random_poses(machine, POSES, 0) {
            let deviation = bare.deviation(&pose, Approach::Mean).position;
            let columns = nominal.columns(&pose);
            for (i, a) in columns.iter().enumerate() {
                moment[i] += a.dot(&deviation);
                columns.iter().enumerate().for_each(|(j, b)| gram[(i, j)] += a.dot(b));
            }
        }
        let shift = gram.try_inverse().unwrap_or_else(Matrix4::zeros) * moment;
        Ok(nominal.shifted(&shift))
    }

    /// The lines of the nominal machine; `None` if it is not such a machine.
    fn nominal(machine: &Machine, letters: &[(usize, usize)]) -> Option<Self> {
        let axes = xyz(machine, letters)?;
        let rotary = [0, 1];
        let tilt = WORLD.find(['A', 'B'].into_iter().find(|l| WORLD.find(*l) == letters.get(1).map(|l| l.0))?)? - 3;
        let along = |axis: usize, k: usize, sense: f64| {
            let this = &machine.axes()[axis];
            (0..3).all(|i| (this.direction[i] * this.sign() - if i == k { sense } else { 0.0 }).abs() < 1e-12)
        };
        let linear = (0..3).all(|k| along(axes[k], k, 1.0));
        let tables = rotary.iter().all(|i| machine.axes()[*i].branch == Branch::Workpiece);
        let fits = letters.len() == 5 && letters[0].0 == 5 && linear && tables && along(0, 2, -1.0);
        if !(fits && along(1, tilt, -1.0)) {
            return None;
        }
        let tool = machine.tool();
        if tool.direction != [0.0, 0.0, 1.0] {
            return None;
        }
        let (c, t) = (machine.axes()[0].origin, machine.axes()[1].origin);
        let offset: [f64; 3] = std::array::from_fn(|i| if i == tilt { 0.0 } else { t[i] - c[i] });
        let lines = [
            c[0] - tool.tip[0],
            c[1] - tool.tip[1],
            c[2] - tool.gauge[2],
            offset[0],
            offset[1],
            offset[2],
            tool.gauge[2] - tool.tip[2],
        ];
        Some(Self { tilt, lines, axes, rotary })
    }

    /// The centre of C and the vector from it to the tilting axis, tool included.
    fn centre_and_offset(&self) -> (Vector3<f64>, Vector3<f64>) {
        let [x, y, z, dx, dy, dz, tool] = self.lines;
        (Vector3::new(x, y, z), Vector3::new(dx, dy, dz + tool))
    }

    /// Rotations of the table by C and by the tilting axis, as the tool sees them.
    fn turns(&self, pose: &[f64]) -> [Matrix3<f64>; 2] {
        let unit = |k: usize| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let [c, tilt] = self.rotary.map(|axis| sin_cos_degrees(-pose[axis]));
        [rotation_about(&unit(2), c), rotation_about(&unit(self.tilt), tilt)]
    }

    /// Returns the joint positions that the module commands for a tip: p = R + Rc (D + Rt (J - D - R)) solved for J.
    pub fn command(&self, tip: &Vector3<f64>, pose: &[f64]) -> Vec<f64> {
        let (centre, offset) = self.centre_and_offset();
        let [c, tilt] = self.turns(pose);
        let joints = centre + offset + tilt.transpose() * (c.transpose() * (tip - centre) - offset);
        let mut command = pose.to_vec();
        self.axes.iter().zip(joints.iter()).for_each(|(axis, q)| command[*axis] = *q);
        command
    }

    /// Returns the motion of the tip per mm of the C line in X and Y, and of the tilting line in its two directions.
    fn columns(&self, pose: &[f64]) -> [Vector3<f64>; 4] {
        let [c, tilt] = self.turns(pose);
        let (by_c, by_tilt) = (Matrix3::identity() - c, c * (Matrix3::identity() - tilt));
        [by_c.column(0), by_c.column(1), by_tilt.column(1 - self.tilt), by_tilt.column(2)].map(|c| c.into_owned())
    }

    fn shifted(mut self, shift: &Vector4<f64>) -> Self {
        let across = 1 - self.tilt;
        self.lines[0] += shift[0];
        self.lines[1] += shift[1];
        // The tilting line is given from the centre of C.
        self.lines[3 + across] += shift[2] - shift[across];
        self.lines[5] += shift[3];
        self
    }

    pub(super) fn rounded(mut self, decimals: u8) -> Self {
        self.lines = self.lines.map(|x| round(x, decimals));
        self
    }
}

fn round(value: f64, decimals: u8) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    libm::round(value * scale) / scale + 0.0
}
