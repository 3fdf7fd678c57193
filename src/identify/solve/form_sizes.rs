//! Sizes of the forms of all axes, estimated together by restricted likelihood (Patterson and Thompson 1971, Harville
//! 1977) and Fisher scoring.
//!
//! The readings, over their standard deviation and less what the unknowns follow, have the covariance
//! `1 + E D^2 E^T`: E are the effects of modes of the forms, D the size of each. Its determinant and inverse come from
//! `V = 1 + D S D` over the modes, `S = E^T E` (Woodbury), so that time does not grow with the readings. The unknowns
//! are logarithms of sizes, normal before the data: a size that the data do not show is that of the other forms instead
//! of zero, at which no estimate of variances has an uncertainty.

use crate::identify::thresholds::*;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Range;

/// Sums over the readings, without the part that the unknowns follow.
pub(super) struct ModeSums {
    /// Products of the effects of modes of one standard deviation.
    pub squares: DMatrix<f64>,
    /// Products of these effects with the residual.
    pub along: DVector<f64>,
    /// The modes of each form.
    pub forms: Vec<Range<usize>>,
    /// Residual sum of squares (mm^2), and its degrees of freedom.
    pub residual: f64,
    pub degrees_of_freedom: f64,
}

/// Logarithms of sizes, in standard deviations of a reading, before the data.
pub(super) struct SizePrior {
    mean: f64,
    /// Inverse of their covariance.
    precision: DMatrix<f64>,
    log_determinant: f64,
}

/// The place of a form among the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FormPlace {
    pub axis: usize,
    pub is_rotation: bool,
}

impl SizePrior {
    /// Returns what is known of forms before the data: `None` without forms.
    pub fn of(forms: &[FormPlace]) -> Option<Self> {
        let [common, motion, axis, own] = FORM_SIZE_SPREADS.map(|spread| spread * spread);
        let covariance = |i: usize, j: usize| {
            let (a, b) = (forms[i], forms[j]);
            let both = |same: bool, variance: f64| if same { variance } else { 0.0 };
            common + both(a.is_rotation == b.is_rotation, motion) + both(a == b, axis) + both(i == j, own)
        };
        let covariance = DMatrix::from_fn(forms.len(), forms.len(), covariance);
        let (precision, log_determinant) = invert(covariance)?;
        (!forms.is_empty()).then(|| Self { mean: libm::log(FORM_SIZE), precision, log_determinant: -log_determinant })
    }
}

/// Sizes of the forms for one choice of lengths.
#[derive(Debug, Clone)]
pub(super) struct FormSizes {
    /// Logarithms of sizes, in standard deviations of a reading.
    pub logarithms: DVector<f64>,
    /// Their covariance.
    covariance: DMatrix<f64>,
    /// Share of the data in what is known of each.
    pub resolution: Vec<f64>,
    /// Variance of a reading (mm^2).
    pub variance: f64,
    /// Logarithm of the likelihood, averaged over all sizes (Laplace).
    pub evidence: f64,
}

impl FormSizes {
    /// Estimates the sizes from a start; `None` if the sums are rounding.
    pub fn estimate(sums: &ModeSums, prior: &SizePrior, start: Option<&DVector<f64>>) -> Option<Self> {
        let count = sums.forms.len();
        let mut at = start.cloned().unwrap_or_else(|| DVector::from_element(count, prior.mean));
        let mut here = Likelihood::of(sums, &at)?;
        for _ in 0..MAX_FORM_STEPS {
            let (posterior, _) = invert(&here.information + &prior.precision)?;
            let away = &prior.precision * at.add_scalar(-prior.mean);
            let mut step = posterior * (&here.slope - away);
            let longest = step.amax();
            step *= (MAX_SIZE_STEP / longest).min(1.0);
            let before = here.value - prior.cost(&at);
            // A step that overshoots is halved.
            let mut found = None;
            for halving in 0..6 {
                let trial = &at + &step * libm::pow(0.5, f64::from(halving));
                let Some(there) = Likelihood::of(sums, &trial) else { continue };
                if there.value - prior.cost(&trial) >= before {
                    found = Some((trial, there));
                    break;
                }
            }
            let Some(better) = found else { break };
            (at, here) = better;
            if longest < SETTLED_SIZE_STEP {
                break;
            }
        }
        let (covariance, log_determinant) = invert(&here.information + &prior.precision)?;
        let evidence = here.value - prior.cost(&at) + 0.5 * (prior.log_determinant - log_determinant);
        let resolution = (0..count).map(|g| (covariance.row(g) * here.information.column(g))[(0, 0)]).collect();
        Some(Self { logarithms: at, covariance, resolution, variance: here.variance, evidence })
    }

    /// Returns the variance (mm^2) of a form: the mean over what the data leave of its size.
    pub fn form_variance(&self, form: usize) -> f64 {
        self.variance * libm::exp(2.0 * self.logarithms[form] + self.covariance[(form, form)])
    }
}

impl SizePrior {
    fn cost(&self, at: &DVector<f64>) -> f64 {
        let away = at.add_scalar(-self.mean);
        0.5 * away.dot(&(&self.precision * &away))
    }
}

/// The restricted likelihood at some sizes, the variance of a reading the likeliest.
struct Likelihood {
    value: f64,
    slope: DVector<f64>,
    /// Fisher's information on the logarithms of the sizes.
    information: DMatrix<f64>,
    variance: f64,
}

impl Likelihood {
    fn of(sums: &ModeSums, logarithms: &DVector<f64>) -> Option<Self> {
        let count = sums.along.len();
        let mut scale = DVector::zeros(count);
        for (form, modes) in sums.forms.iter().enumerate() {
            scale.rows_mut(modes.start, modes.len()).fill(libm::exp(logarithms[form]));
        }
        let grown = DMatrix::from_fn(count, count, |i, j| {
            scale[i] * sums.squares[(i, j)] * scale[j] + if i == j { 1.0 } else { 0.0 }
        });
        let (inverse, log_determinant) = invert(grown)?;
        let along = sums.along.component_mul(&scale);
        let explained = &inverse * &along;
        let rest = sums.residual - along.dot(&explained);
        // A form that explains everything but rounding would win with no variance at all.
        if rest.is_nan() || rest <= MIN_RESIDUAL_SHARE * sums.residual {
            return None;
        }
        let freedom = sums.degrees_of_freedom;
        let used = |modes: &Range<usize>| modes.clone().map(|i| 1.0 - inverse[(i, i)]).sum::<f64>();
        let used: Vec<f64> = sums.forms.iter().map(used).collect();
        let squares = |modes: &Range<usize>| explained.rows(modes.start, modes.len()).norm_squared();
        let slope = |g: usize| freedom / rest * squares(&sums.forms[g]) - used[g];
        let block = |g: usize, h: usize| {
            let (a, b) = (&sums.forms[g], &sums.forms[h]);
            let squares = inverse.view((a.start, b.start), (a.len(), b.len())).norm_squared();
            // Of the complement 1 - V^-1.
            if g == h { squares + 2.0 * used[g] - a.len() as f64 } else { squares }
        };
        let forms = sums.forms.len();
        // Less what the variance of a reading takes up.
        let information = DMatrix::from_fn(forms, forms, |g, h| 2.0 * block(g, h) - 2.0 / freedom * used[g] * used[h]);
        Some(Self {
            value: -0.5 * (log_determinant + freedom * libm::log(rest)),
            slope: DVector::from_fn(forms, |g, _| slope(g)),
            information,
            variance: rest / freedom,
        })
    }
}

/// Size up to which a matrix is inverted at once.
const MAX_INVERTED_AT_ONCE: usize = 32;

/// Returns the inverse and the logarithm of the determinant of a positive definite matrix, by halves (Schur
/// complement): nearly all is products of matrices.
fn invert(matrix: DMatrix<f64>) -> Option<(DMatrix<f64>, f64)> {
    let count = matrix.nrows();
    if count <= MAX_INVERTED_AT_ONCE {
        let root = Cholesky::new(matrix)?;
        let log_determinant = 2.0 * root.l_dirty().diagonal().iter().map(|x| libm::log(*x)).sum::<f64>();
        return Some((root.inverse(), log_determinant));
    }
    let half = count / 2;
    let rest = count - half;
    let corner = matrix.view((half, 0), (rest, half)).into_owned();
    let (first, first_determinant) = invert(matrix.view((0, 0), (half, half)).into_owned())?;
    let across = &corner * &first;
    let complement = matrix.view((half, half), (rest, rest)) - &across * corner.transpose();
    let (second, second_determinant) = invert(complement)?;
    let lower = -(&second * &across);
    let mut inverse = DMatrix::zeros(count, count);
    inverse.view_mut((0, 0), (half, half)).copy_from(&(first - across.tr_mul(&lower)));
    inverse.view_mut((0, half), (half, rest)).copy_from(&lower.transpose());
    inverse.view_mut((half, 0), (rest, half)).copy_from(&lower);
    inverse.view_mut((half, half), (rest, rest)).copy_from(&second);
    Some((inverse, first_determinant + second_determinant))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn wave(i: usize, j: usize) -> f64 {
        libm::sin(1.7 * i as f64 + 2.3 * (j * j) as f64 + 0.4)
    }

    /// Two forms of 40 and 20 modes over 90 readings.
    fn sums() -> (ModeSums, DMatrix<f64>, DVector<f64>) {
        let (effects, read) = (DMatrix::from_fn(90, 60, wave), DVector::from_fn(90, |i, _| 3.0 * wave(i, 65)));
        let (squares, along) = (effects.tr_mul(&effects), effects.tr_mul(&read));
        let (residual, degrees_of_freedom) = (read.norm_squared(), 90.0);
        (ModeSums { squares, along, forms: vec![0..40, 40..60], residual, degrees_of_freedom }, effects, read)
    }

    /// The likelihood by the dense covariance of the readings, its slope by differences, and the information by traces.
    #[test]
    fn likelihood_is_that_of_the_dense_covariance() {
        let (sums, effects, read) = sums();
        let covariance = |at: &DVector<f64>| {
            let scale = |j: usize| libm::exp(2.0 * at[usize::from(j >= 40)]);
            let grown = DMatrix::from_fn(90, 60, |i, j| effects[(i, j)] * scale(j));
            DMatrix::identity(90, 90) + grown * effects.transpose()
        };
        let dense = |at: &DVector<f64>| {
            let covariance = covariance(at);
            let determinant = covariance.clone().symmetric_eigenvalues().iter().map(|x| libm::log(*x)).sum::<f64>();
            let rest = read.dot(&(covariance.try_inverse().unwrap() * &read));
            -0.5 * (determinant + 90.0 * libm::log(rest))
        };
        let at = DVector::from_column_slice(&[-1.2, 0.3]);
        let found = Likelihood::of(&sums, &at).unwrap();
        assert!((found.value - dense(&at)).abs() < 1e-8 * found.value.abs());
        let inverse = covariance(&at).try_inverse().unwrap();
        let moved = |g: usize| {
            let half =
                |sign: f64| covariance(&DVector::from_fn(2, |i, _| at[i] + if i == g { sign * 1e-5 } else { 0.0 }));
            (half(1.0) - half(-1.0)) / 2e-5
        };
        for g in 0..2 {
            let step = |sign: f64| DVector::from_fn(2, |i, _| at[i] + if i == g { sign * 1e-5 } else { 0.0 });
            let slope = (dense(&step(1.0)) - dense(&step(-1.0))) / 2e-5;
            assert!((found.slope[g] - slope).abs() < 1e-4 * (1.0 + slope.abs()), "{slope} {}", found.slope[g]);
            for h in 0..2 {
                let trace = 0.5 * (&inverse * moved(g) * &inverse * moved(h)).trace();
                let of = |g: usize| 0.5 * (&inverse * moved(g)).trace();
                let expected = trace - of(g) * of(h) * 2.0 / 90.0;
                assert!((found.information[(g, h)] - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{g} {h}");
            }
        }
    }

    /// Sizes by which the readings were drawn come back, and a form without any effect has the size of its neighbours.
    #[test]
    fn sizes_come_back() {
        let mut state = 7_u64;
        let mut even = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1_u64 << 31) as f64
        };
        let mut normal = || (0..12).map(|_| even()).sum::<f64>() - 6.0;
        // Cosines of 400 readings, all apart.
        let cosine = |i: usize, j: usize| libm::cos(PI * (j + 1) as f64 * (i as f64 + 0.5) / 400.0);
        let effects = DMatrix::from_fn(400, 120, |i, j| if j < 80 { cosine(i, j) } else { 0.0 });
        let sizes = |j: usize| if j < 40 { 4.0 } else { 0.25 };
        let modes = DVector::from_fn(120, |j, _| sizes(j) * normal());
        let read = &effects * modes + DVector::from_fn(400, |_, _| normal());
        let sums = ModeSums {
            squares: effects.tr_mul(&effects),
            along: effects.tr_mul(&read),
            forms: vec![0..40, 40..80, 80..120],
            residual: read.norm_squared(),
            degrees_of_freedom: 400.0,
        };
        let place = |axis| FormPlace { axis, is_rotation: false };
        let prior = SizePrior::of(&[place(0), place(1), place(2)]).unwrap();
        let found = FormSizes::estimate(&sums, &prior, None).unwrap();
        let size = |form: usize| libm::sqrt(found.form_variance(form));
        assert!((3.0..5.5).contains(&size(0)) && (0.17..0.37).contains(&size(1)), "{} {}", size(0), size(1));
        assert!(size(1) < size(2) && size(2) < size(0), "{}", size(2));
        assert!(found.resolution[0] > 0.9 && found.resolution[2] < 1e-9, "{:?}", found.resolution);
        assert!((found.variance - 1.0).abs() < 0.2, "{}", found.variance);
    }
}
