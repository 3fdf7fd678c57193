//! Balls by least squares: a centre for each set of touches, and one effective radius and threefold lobing for all.
//!
//! |p - c| = r + s (a cos 3t + b sin 3t), p the functional point at contact, c the centre, t and s the angle and the
//! sine of the touch about and from the axis of the probe, as `data/touches.rs` has them. The centres are eliminated
//! set by set.

use super::log::TouchSet;
use crate::identify::thresholds::TOUCH_LOBE_MM;
use nalgebra::{Matrix3, SMatrix, Vector3, Vector4};

/// Steps of Gauss and Newton: the start is a millimetre off at worst, and each squares what is left over the radius.
const STEPS: usize = 10;
/// Pivot (mm) of points in space below which they are in a plane.
const MIN_PIVOT_MM: f64 = 1e-3;
/// Distance (mm) of a touch from the centre of its ball below which it has no direction.
const MIN_DISTANCE_MM: f64 = 1e-3;
/// Variance of a residual, in that of a touch, below which it says nothing.
const MIN_SHARE_LEFT: f64 = 1e-6;
/// Weight that holds the lobing at 0.
const NO_LOBING: f64 = 1e9;

/// Balls fitted to touches; lengths in mm, cofactors are covariances over the variance of a touch.
#[derive(Debug, Clone)]
pub(super) struct SphereFit {
    pub centres: Vec<Vector3<f64>>,
    pub cofactors: Vec<Matrix3<f64>>,
    /// Effective radius, and the two parts of the lobing.
    pub probe: Vector3<f64>,
    pub probe_cofactor: Matrix3<f64>,
    /// Set by set and touch by touch distance from the centre less that of the fit.
    pub residuals: Vec<Vec<f64>>,
    /// The same over its standard deviation, in that of a touch; of a touch left out that of its prediction.
    pub standardised: Vec<Vec<f64>>,
    /// Sum of squares of the residuals.
    pub sum: f64,
    /// Residual degrees of freedom.
    pub freedom: f64,
}

/// A set at a step of the fit.
struct Part {
    rows: Vec<Row>,
    /// Cofactor of the centre with the probe known.
    cofactor: Matrix3<f64>,
    /// Motion of the centre against the probe's numbers.
    by_probe: Matrix3<f64>,
    /// Step of the centre with the probe as it is.
    own: Vector3<f64>,
}

/// A row: derivatives of the distance from the centre by centre (with the other sign) and probe.
struct Row {
    by_centre: Vector3<f64>,
    by_probe: Vector3<f64>,
    residual: f64,
}

fn row(tip: &Vector3<f64>, rotation: &Matrix3<f64>, centre: &Vector3<f64>, probe: &Vector3<f64>) -> Row {
    let from = tip - centre;
    let normal = from.normalize();
    let in_tool = rotation.transpose() * normal;
    let (angle, share) = (3.0 * libm::atan2(in_tool.y, in_tool.x), libm::hypot(in_tool.x, in_tool.y));
    let by_probe = Vector3::new(1.0, share * libm::cos(angle), share * libm::sin(angle));
    Row { by_centre: normal, by_probe, residual: from.norm() - by_probe.dot(probe) }
}

impl SphereFit {
    /// Fits the touches that are used. `weight` is that of a lobing of 0; `None` if a set has fewer than four touches,
    /// or does not surround its ball.
    fn weighed(sets: &[TouchSet], used: &[Vec<bool>], weight: f64) -> Option<Self> {
        let count = used.iter().flatten().filter(|used| **used).count();
        let starts = sets.iter().zip(used).map(|(set, used)| start(set, used)).collect::<Option<Vec<_>>>()?;
        let mut radii: Vec<f64> = starts.iter().map(|start| start.w).collect();
        radii.sort_by(f64::total_cmp);
        let mut fit = Self {
            centres: starts.iter().map(|start| start.xyz()).collect(),
            cofactors: Vec::new(),
            probe: Vector3::new(*radii.get(radii.len() / 2)?, 0.0, 0.0),
            probe_cofactor: Matrix3::zeros(),
            residuals: Vec::new(),
            standardised: Vec::new(),
            sum: 0.0,
            freedom: 0.0,
        };
        let held = Matrix3::from_diagonal(&Vector3::new(0.0, weight, weight));
        for step in 0..STEPS {
            let (mut schur, mut right) = (held, -held * fit.probe);
            let mut parts = Vec::new();
            for ((set, used), centre) in sets.iter().zip(used).zip(&fit.centres) {
                let rows: Vec<Row> =
                    set.contacts.iter().map(|of| row(&of.tip, &of.rotation, centre, &fit.probe)).collect();
                let (mut a, mut b, mut g) = (Matrix3::zeros(), Matrix3::zeros(), Vector3::zeros());
                for row in rows.iter().zip(used).filter(|(_, used)| **used).map(|(row, _)| row) {
                    a += row.by_centre * row.by_centre.transpose();
                    b += row.by_centre * row.by_probe.transpose();
                    g += row.by_centre * row.residual;
                    schur += row.by_probe * row.by_probe.transpose();
                    right += row.by_probe * row.residual;
                }
                let inverse = a.try_inverse()?;
                schur -= b.transpose() * inverse * b;
                right -= b.transpose() * inverse * g;
                parts.push(Part { rows, cofactor: inverse, by_probe: inverse * b, own: inverse * g });
            }
            fit.probe_cofactor = schur.try_inverse()?;
            if step + 1 == STEPS {
                fit.judge(&parts, used);
                fit.freedom = count as f64 - 3.0 * sets.len() as f64 - 3.0 + weight * fit.lobing_cofactor().trace();
                break;
            }
            let change = fit.probe_cofactor * right;
            fit.probe += change;
            for (centre, part) in fit.centres.iter_mut().zip(&parts) {
                *centre += part.own - part.by_probe * change;
            }
        }
        (fit.freedom > 0.0 && fit.sum.is_finite()).then_some(fit)
    }

    /// Takes residuals and cofactors.
    fn judge(&mut self, parts: &[Part], used: &[Vec<bool>]) {
        for (part, used) in parts.iter().zip(used) {
            let mixed = -part.by_probe * self.probe_cofactor;
            let own = part.cofactor - mixed * part.by_probe.transpose();
            let mut of_set = Vec::new();
            for (row, used) in part.rows.iter().zip(used) {
                let (c, p) = (&row.by_centre, &row.by_probe);
                let share = c.dot(&(own * c)) + 2.0 * c.dot(&(mixed * p)) + p.dot(&(self.probe_cofactor * p));
                let variance = if *used { (1.0 - share).max(MIN_SHARE_LEFT) } else { 1.0 + share };
                of_set.push(row.residual / libm::sqrt(variance));
                self.sum += if *used { row.residual * row.residual } else { 0.0 };
            }
            self.cofactors.push(own);
            self.standardised.push(of_set);
            self.residuals.push(part.rows.iter().map(|row| row.residual).collect());
        }
    }

    /// Fits centres, radius and lobing, which is known to be 0 as well as data sheets say.
    pub fn of(sets: &[TouchSet], used: &[Vec<bool>]) -> Option<Self> {
        let mut fit = Self::weighed(sets, used, NO_LOBING)?;
        for _ in 0..2 {
            let variance = (fit.sum / fit.freedom).max(f64::MIN_POSITIVE);
            fit = Self::weighed(sets, used, (variance / (TOUCH_LOBE_MM * TOUCH_LOBE_MM)).max(1e-9))?;
        }
        Some(fit)
    }

    /// Returns the variance of a touch (mm^2).
    pub fn variance(&self) -> f64 {
        self.sum / self.freedom
    }

    /// Returns the cofactor of the two parts of the lobing.
    pub fn lobing_cofactor(&self) -> SMatrix<f64, 2, 2> {
        self.probe_cofactor.fixed_view::<2, 2>(1, 1).into_owned()
    }
}

/// Returns centre and radius of the algebraic sphere, |p|^2 = 2 p c + (r^2 - |c|^2); `None` of points in a plane.
pub(super) fn algebraic(points: &[Vector3<f64>]) -> Option<Vector4<f64>> {
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let (mut normal, mut right) = (SMatrix::<f64, 4, 4>::zeros(), Vector4::zeros());
    for point in points {
        let p = point - middle;
        let row = Vector4::new(2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0);
        normal += row * row.transpose();
        right += row * p.norm_squared();
    }
    let factor = normal.cholesky()?;
    let thin = factor.l_dirty().diagonal().min() < MIN_PIVOT_MM;
    let found = factor.solve(&right);
    let radius = libm::sqrt(found.w + found.xyz().norm_squared());
    let is_ball = points.iter().all(|p| (p - middle - found.xyz()).norm() > MIN_DISTANCE_MM);
    (radius.is_finite() && is_ball && !thin && points.len() > 3).then(|| (found.xyz() + middle).push(radius))
}

fn start(set: &TouchSet, used: &[bool]) -> Option<Vector4<f64>> {
    let tips = set.contacts.iter().zip(used).filter(|(_, used)| **used).map(|(of, _)| of.tip);
    algebraic(&tips.collect::<Vec<_>>())
}
