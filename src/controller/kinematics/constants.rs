//! A module of the controller's own with a 3x3 matrix, fitted to the deviation of the functional point over the volume.

use crate::compensation::{Correction, Scope, correct};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::random_poses;
use crate::machine::{Approach, AxisKind, Machine};
use nalgebra::{Matrix3, Vector3};

const POSES: usize = 1000;

/// joint = C axis, for X, Y, Z.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LinearMap {
    /// Row by row.
    pub matrix: [f64; 9],
    /// Index in the walk of X, Y and Z.
    axes: [usize; 3],
}

impl LinearMap {
    /// Fits the matrix with the smallest residual deviation of the functional point (least squares).
    pub fn fit(machine: &Machine, letters: &[(usize, usize)]) -> Result<Self, Diagnostic> {
        let axes = xyz(machine, letters).filter(|_| letters.len() == 3).ok_or_else(|| {
            Diagnostic::new(
                codes::E0751,
                "this kinematics module is for machines with the linear axes X, Y, Z and no other",
            )
            .help("for other machines take the target linuxcnc-kins")
        })?;
        let (mut gram, mut moment) = (Matrix3::zeros(), Matrix3::zeros());
        for pose in random_poses(machine, POSES, 0) {
            let Correction(added) = correct(machine, &Approach::Mean.at_pose(&pose), Scope::POSITION).correction;
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

    pub(super) fn round(mut self, decimals: u8) -> Self {
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

fn round(value: f64, decimals: u8) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    libm::round(value * scale) / scale + 0.0
}
