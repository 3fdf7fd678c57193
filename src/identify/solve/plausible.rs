//! Knowledge before the readings in the covariance: errors are plausible in size.
//!
//! The fit is pulled to its start by this knowledge ([`crate::identify::model::Prior`]). Its covariance has the
//! knowledge where the readings tell less, so that what they tell more of is as uncertain as they alone say.

use crate::algebra::linear::{ReducedSystem, Svd};
use crate::identify::thresholds::RANK_TOLERANCE;
use nalgebra::{DMatrix, DVector};

/// Adds rows (mm) for the directions of the machine's unknowns of which readings that scatter by `sigma` (mm) tell less
/// than is known before: `plausible` are combinations known with standard deviation 1, a triangle. Directions beyond
/// `rank` stay free. `None` if there are no such directions.
pub(super) fn within_plausible(
    reduced: &ReducedSystem,
    plausible: &DMatrix<f64>,
    rank: usize,
    sigma: f64,
) -> Option<ReducedSystem> {
    let (own, all) = plausible.shape();
    let machine = plausible.columns(0, own);
    // What instruments and set-ups, which may be anywhere, leave of the readings.
    let others = Svd::new(&reduced.r.columns(own, all - own).into_owned());
    let used = others.u.columns(0, others.rank(RANK_TOLERANCE));
    let seen = reduced.r.columns(0, own);
    let left = seen - used * used.tr_mul(&seen);
    let svd = Svd::new(&machine.tr_solve_upper_triangular(&left.transpose())?.transpose());
    let held = own.saturating_sub(all - rank);
    let first = (0..held).find(|k| svd.values[*k] < sigma)?;
    let mut rows = DMatrix::zeros(held - first, all);
    rows.columns_mut(0, own).copy_from(&(svd.v.columns(first, held - first).tr_mul(&machine) * sigma));
    Some(reduced.with_rows(&rows, &DVector::zeros(held - first)))
}

/// Adds rows under effects (mm) of the unknowns on places that stand for readings of this scatter (mm).
pub(super) fn known_before(effects: DMatrix<f64>, plausible: &DMatrix<f64>, scatter: f64) -> DMatrix<f64> {
    let first = effects.nrows();
    let mut all = effects.insert_rows(first, plausible.nrows(), 0.0);
    all.rows_mut(first, plausible.nrows()).copy_from(&(plausible * scatter));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(rows: &[f64], columns: usize) -> ReducedSystem {
        let matrix = DMatrix::from_row_slice(rows.len() / columns, columns, rows);
        ReducedSystem::of(&matrix, &DVector::zeros(matrix.nrows()))
    }

    fn variances(problem: &ReducedSystem) -> Vec<f64> {
        let root = Svd::new(&problem.r).root_covariance(problem.r.ncols());
        (&root * root.transpose()).diagonal().iter().copied().collect()
    }

    /// Readings of scatter 1 tell the first unknown to 0.1 and the second to 1000 where 0.5 is plausible: closed form.
    #[test]
    fn only_what_readings_hardly_tell_is_known_before() {
        let readings = problem(&[10.0, 0.0, 0.0, 1e-3], 2);
        let plausible = DMatrix::identity(2, 2) * 2.0;
        let [first, second] = variances(&within_plausible(&readings, &plausible, 2, 1.0).unwrap())[..] else {
            panic!()
        };
        assert!((first - 1e-2).abs() < 1e-15, "{first}");
        assert!((second - 1.0 / (4.0 + 1e-6)).abs() < 1e-12, "{second}");
        assert!(within_plausible(&readings, &plausible, 2, 1e-4).is_none());
    }

    /// An instrument may be anywhere: the machine's unknown is held, the instrument by the readings and it. What
    /// nothing tells stays free.
    #[test]
    fn instruments_have_no_plausible_place_and_null_spaces_stay() {
        let readings = problem(&[1.0, 1.0, 0.0, 1e-3], 2);
        let plausible = DMatrix::from_row_slice(1, 2, &[2.0, 0.0]);
        let [own, instrument] = variances(&within_plausible(&readings, &plausible, 2, 1.0).unwrap())[..] else {
            panic!()
        };
        assert!((own - 0.25).abs() < 1e-6 && (instrument - 1.25).abs() < 1e-5, "{own} {instrument}");
        assert!(within_plausible(&problem(&[1.0, 1.0, 0.0, 0.0], 2), &plausible, 1, 1.0).is_none());
    }
}
