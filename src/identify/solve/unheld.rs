//! Rigid motions of the workpiece frame that a fitted machine does not hold: those that no reading notices while the
//! places of instruments and set-ups follow, whatever the errors are, and those that a datum of the errors has decided.

use super::fit::ParameterFit;
use crate::algebra::linear::{Svd, over_columns};
use crate::identify::data::{LEVER_MM, Measurement};
use crate::identify::model::{BasisFunction, FitModel, Parameter, sizes};
use crate::identify::thresholds::{MAX_TURNING_SHARE, MAX_UNNOTICED_SHARE, MIN_UNHELD_PART, RANK_TOLERANCE};
use crate::identify::words::reduced_echelon;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Direction, UnheldMotion};
use nalgebra::{DMatrix, DVector};

/// Largest amounts of a motion that is written: 1 mm, 1 mrad.
const LIMITS: [f64; 6] = [1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3];

/// Returns the rigid motions that neither the readings of a fit nor the errors in their datum hold. `by_datum` are
/// motions (columns, as displacements) that the datum decided.
pub fn unheld(
    model: &FitModel<'_>,
    data: &[Measurement],
    fit: &ParameterFit,
    by_datum: Option<&DMatrix<f64>>,
) -> Vec<UnheldMotion> {
    let unnoticed = unnoticed(model, data, fit);
    // Combinations of unit size whose motion is less are undone by a set-up.
    let decided = by_datum.map_or_else(|| DMatrix::zeros(6, 0), |motions| span(motions, MAX_TURNING_SHARE));
    let both: Vec<_> = unnoticed.column_iter().chain(decided.column_iter()).collect();
    if both.is_empty() {
        return Vec::new();
    }
    let basis = span(&DMatrix::from_columns(&both), MIN_UNHELD_PART);
    let rows = match basis.ncols() {
        6 => (0..6).map(|k| DVector::from_fn(6, |i, _| f64::from(u8::from(i == k)))).collect(),
        _ => reduced_echelon(&basis),
    };
    rows.iter().map(motion).collect()
}

/// Returns an orthonormal basis of columns, without directions in which they are not longer than `least`.
fn span(columns: &DMatrix<f64>, least: f64) -> DMatrix<f64> {
    let svd = Svd::new(&columns.transpose());
    svd.v.columns(0, svd.values.iter().filter(|value| **value > least).count()).into_owned()
}

/// Returns a motion of displacements (mm; rotations over the lever arm) with the rounding of a zero left out: up to
/// 1 mm, up to 1 mrad.
fn motion(displacements: &DVector<f64>) -> UnheldMotion {
    let shares = displacements / displacements.amax();
    let share = |i: usize| if shares[i].abs() > MAX_UNNOTICED_SHARE { shares[i] } else { 0.0 };
    let amounts: [f64; 6] = std::array::from_fn(|i| if i < 3 { share(i) } else { share(i) / LEVER_MM });
    let in_limits = (0..6).map(|i| amounts[i].abs() / LIMITS[i]).fold(0.0, f64::max);
    let is_alone = amounts.iter().filter(|amount| **amount != 0.0).count() == 1;
    let amount = |i: usize| if is_alone { amounts[i].signum() * LIMITS[i] } else { amounts[i] / in_limits };
    UnheldMotion::of(std::array::from_fn(|i| if amounts[i] == 0.0 { 0.0 } else { amount(i) }))
}

/// Returns the motions (orthonormal columns, as displacements) that no reading notices: those of the workpiece, as a
/// set-up error, that instruments and set-ups undo.
fn unnoticed(model: &FitModel<'_>, data: &[Measurement], fit: &ParameterFit) -> DMatrix<f64> {
    let machine = &model.machines()[0];
    let set_up = machine.setup().workpiece;
    let of = |direction: &Direction| {
        let source = Source { place: ErrorSite::Workpiece, direction: *direction };
        let start = set_up[direction.index()];
        Parameter::single(machine, String::new(), source, BasisFunction::Constant, start)
    };
    let parameters = model.parameters();
    let follows = |j: &usize| *j >= model.own() || parameters[*j].is_workpiece_clamping();
    let followers: Vec<usize> = (0..parameters.len()).filter(follows).collect();
    let unknowns: Vec<Parameter> =
        Direction::ALL.iter().map(of).chain(followers.iter().map(|j| parameters[*j].clone())).collect();
    let theta: Vec<f64> = set_up.into_iter().chain(followers.iter().map(|j| fit.theta[*j])).collect();
    let moved = model.with_parameters(&unknowns);
    let readings = moved.triangle(data, &vec![1.0; data.len()], &theta);
    // What is known of the places of instruments holds the frame, too.
    let known = fit.known.select_columns(&followers);
    let mut known = known.insert_columns(0, 6, 0.0);
    known.row_iter_mut().for_each(|mut row| {
        let size = row.amax();
        row.iter_mut().for_each(|x| *x /= size.max(f64::MIN_POSITIVE));
    });
    let whole = readings.with_rows(&known, &DVector::zeros(known.nrows()));
    let sized = over_columns(&whole.r, &sizes(&unknowns));
    let (motions, places) = (sized.columns(0, 6).into_owned(), sized.columns(6, sized.ncols() - 6).into_owned());
    let svd = Svd::new(&places);
    let followed = svd.u.columns(0, svd.rank(RANK_TOLERANCE)).into_owned();
    let noticed = Svd::new(&(&motions - &followed * followed.tr_mul(&motions)));
    // A turn of the whole turns what the readings leave.
    let left = readings.right_norm() / LEVER_MM;
    let least = (MAX_UNNOTICED_SHARE * motions.norm()).max(left);
    noticed.null_space(noticed.values.iter().filter(|value| **value > least).count())
}
