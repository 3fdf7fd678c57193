//! Holding the tool at a place by the axes: corrections of the joints from the missing motion of tip and orientation,
//! linear in both.
//!
//! Gram matrices are inverted by `g(s) = 1 / (s + l^2(s))`, which is the inverse above a threshold and
//! bounded and smooth below it: commands are continuous at a singular pose, and steep beside it.

use super::data::{ModuleModel, ModuleWords};
use super::nominal::{BodyPlace, Setting};
use super::topology::FLAT;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix3xX, Matrix6, Matrix6xX, MatrixXx3, Vector3, Vector6};

/// Corrections of all joints (mm, rad) for a displacement and a rotation of the tool (mm, rad).
pub struct Hold {
    map: DMatrix<f64>,
    motion: Matrix6xX<f64>,
}

impl Hold {
    /// Returns the total corrections from the motion they make and the one still missing.
    pub fn total(&self, made: &DVector<f64>, missing: &Vector6<f64>, setting: &Setting) -> DVector<f64> {
        let mut goal = &self.motion * made + missing;
        if !setting.orientation {
            goal.fixed_rows_mut::<3>(3).fill(0.0);
        }
        &self.map * goal
    }
}

impl ModuleModel {
    /// At a place; `None` where linear axes that must span the room do not.
    pub fn hold(&self, place: &BodyPlace, setting: &Setting) -> Option<Hold> {
        match self.words {
            ModuleWords::Pose => Some(self.whole(place)),
            ModuleWords::Tip | ModuleWords::Axes => self.by_turns(place, setting),
        }
    }

    fn indices_where(&self, which: impl Fn(usize) -> bool) -> Vec<usize> {
        (0..self.joints.len()).filter(|i| which(*i)).collect()
    }

    /// Linear axes hold the tip. Rotary axes, if they are to correct at all, hold the rest of the tip, then the tool
    /// axis with the freedom that remains.
    fn by_turns(&self, place: &BodyPlace, setting: &Setting) -> Option<Hold> {
        let linear = self.indices_where(|i| self.joints[i].solved && !self.joints[i].rotary);
        let rotary = self.indices_where(|i| setting.orientation && self.joints[i].rotary);
        let ways = columns(&linear, |i| place.lever[i]);
        let (back, left) = match self.words {
            ModuleWords::Tip => (self.span_inverse(&ways)?, Matrix3::zeros()),
            _ => {
                let gram = self.limit_gram(&(&ways * ways.transpose()));
                let back = ways.transpose() * gram;
                let left = Matrix3::identity() - &ways * &back;
                (back, left)
            }
        };
        let axis = place.axis();
        let levers = columns(&rotary, |i| place.lever[i]);
        let tilts = columns(&rotary, |i| place.turn[i] - axis * axis.dot(&place.turn[i]));
        let reach = left * &levers / self.arm;
        let by_place = reach.transpose() * self.limit_gram(&(&reach * reach.transpose()));
        let free = &tilts - &tilts * &by_place * &reach;
        let by_tilt = free.transpose() * self.limit_gram(&(&free * free.transpose()));
        let by_place = by_place * left / self.arm;
        let by_place = &by_place - &by_tilt * &tilts * &by_place;

        let mut map = DMatrix::zeros(self.joints.len(), 6);
        for (row, i) in rotary.iter().enumerate() {
            map.view_mut((*i, 0), (1, 3)).copy_from(&by_place.row(row));
            map.view_mut((*i, 3), (1, 3)).copy_from(&by_tilt.row(row));
        }
        let remains = [Matrix3::identity() - &levers * &by_place, -(&levers * &by_tilt)];
        for (half, remains) in remains.iter().enumerate() {
            let ways = &back * remains;
            linear.iter().enumerate().for_each(|(row, i)| {
                map.view_mut((*i, 3 * half), (1, 3)).copy_from(&ways.row(row));
            });
        }
        let motion = Matrix6xX::from_fn(self.joints.len(), |r, i| match r {
            0..3 => place.lever[i][r],
            _ => (place.turn[i] - axis * axis.dot(&place.turn[i]))[r - 3],
        });
        Some(Hold { map, motion })
    }

    /// The inverse of three directions that span the room.
    fn span_inverse(&self, ways: &Matrix3xX<f64>) -> Option<MatrixXx3<f64>> {
        let square: Matrix3<f64> = (ways.ncols() == 3).then(|| ways.fixed_columns::<3>(0).into_owned())?;
        let inverse = (square.determinant().abs() > FLAT).then(|| square.try_inverse())??;
        Some(MatrixXx3::from_column_slice(inverse.as_slice()))
    }

    /// Six axes hold all of the tool.
    fn whole(&self, place: &BodyPlace) -> Hold {
        let solved = self.indices_where(|i| self.joints[i].solved);
        // Scale to arms and rad.
        let unit = |i: usize| if self.joints[i].rotary { 1.0 } else { self.arm };
        let column = |i: &usize| {
            let (p, t) = (place.lever[*i] * (unit(*i) / self.arm), place.turn[*i]);
            Vector6::new(p[0], p[1], p[2], t[0], t[1], t[2])
        };
        let jacobian = Matrix6::from_columns(&solved.iter().map(column).collect::<Vec<_>>());
        let inverse = jacobian.try_inverse();
        let weakest = inverse.map_or(0.0, |inverse| inverse.norm_squared().recip());
        let square = self.square(weakest);
        let inverse = match inverse {
            Some(inverse) if square == 0.0 => inverse,
            _ => {
                let gram = jacobian * jacobian.transpose() + Matrix6::identity() * square;
                jacobian.transpose() * gram.try_inverse().unwrap_or_else(Matrix6::zeros)
            }
        };
        let mut map = DMatrix::zeros(self.joints.len(), 6);
        for (row, i) in solved.iter().enumerate() {
            (0..6).for_each(|c| map[(*i, c)] = inverse[(row, c)] * unit(*i) / if c < 3 { self.arm } else { 1.0 });
        }
        let motion = Matrix6xX::from_fn(self.joints.len(), |r, i| match r {
            0..3 => place.lever[i][r],
            _ => place.turn[i][r - 3],
        });
        Hold { map, motion }
    }

    /// l^2: 0 from the threshold on, and reaching it without a kink.
    fn square(&self, weakest: f64) -> f64 {
        let threshold = self.damping * self.damping;
        let below = (1.0 - weakest.max(0.0) / threshold).max(0.0);
        threshold * below * below
    }

    /// g of a Gram matrix.
    fn limit_gram(&self, gram: &Matrix3<f64>) -> Matrix3<f64> {
        let parts = gram.symmetric_eigen();
        let inverse = parts.eigenvalues.map(|s| (s.max(0.0) + self.square(s)).recip());
        parts.eigenvectors * Matrix3::from_diagonal(&inverse) * parts.eigenvectors.transpose()
    }
}

fn columns(which: &[usize], of: impl Fn(usize) -> Vector3<f64>) -> Matrix3xX<f64> {
    Matrix3xX::from_fn(which.len(), |r, c| of(which[c])[r])
}
