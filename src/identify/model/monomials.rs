//! The method of Holub and others 2015: the deviation of order 2 as a polynomial in the parameters. Every monomial is
//! an unknown of its own, and each component is solved for itself by the Moore-Penrose inverse. The method is linear
//! and needs no start. It ignores that a product is the product of its factors, and that the components share them.

use super::prediction::{FitModel, zero_unread};
use crate::algebra::linear::{Svd, Triangle};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::thresholds::{MAX_NULL_SPACE_SHARE, MIN_MONOMIAL_MM, RANK_TOLERANCE};
use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;
use serde::Serialize;

/// A monomial: one parameter, or two (perhaps the same twice).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ErrorMonomial(usize, Option<usize>);

/// One component of the deviation.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MonomialComponent {
    /// `dx`, `dy` or `dz`.
    pub component: &'static str,
    /// Number of readings.
    pub readings: usize,
    /// Number of monomials.
    pub columns: usize,
    /// Rank of the problem.
    pub rank: usize,
    /// Root mean square of the readings.
    pub rms_um: Rms,
    /// The coefficients.
    pub coefficients: Vec<MonomialCoefficient>,
}

/// Root mean square of readings, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Rms {
    /// As measured.
    pub before: f64,
    /// After the fit.
    pub after: f64,
}

/// The coefficient of a monomial.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MonomialCoefficient {
    /// Name such as `EX0C` or `EA0C*EB0C`.
    pub monomial: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// True if the data tell it from the others.
    pub determined: bool,
}

/// First- and second-degree coefficients of a reading (mm, parameters in units of displacement).
struct Expansion {
    /// The reading with all parameters 0.
    constant: Vector3<f64>,
    /// By monomial.
    columns: Vec<Vector3<f64>>,
}

/// Returns all monomials of one and two of so many parameters.
fn monomials(count: usize) -> Vec<ErrorMonomial> {
    let pairs = (0..count).flat_map(|i| (i..count).map(move |j| ErrorMonomial(i, Some(j))));
    (0..count).map(|i| ErrorMonomial(i, None)).chain(pairs).collect()
}

/// Returns the fit of each component that was measured. Rows other than deviations are not in the papers: `None`.
pub fn moore_penrose(model: &FitModel<'_>, data: &[Measurement]) -> Option<Vec<MonomialComponent>> {
    if !data.iter().all(|m| m.kind() == ReadingKind::Deviation) {
        return None;
    }
    let list = monomials(model.own());
    let rows: Vec<Expansion> = data.par_iter().map(|m| expansion(model, m, &list)).collect();
    let component = |k: usize| component(model, data, &rows, &list, k);
    Some((0..3).filter_map(component).collect())
}

/// Returns the coefficients by values at single parameters and pairs: the degrees come apart in the algebra, so that
/// differences of them are exact but for rounding.
fn expansion(model: &FitModel<'_>, m: &Measurement, list: &[ErrorMonomial]) -> Expansion {
    let n = model.own();
    let at = |marked: &[(usize, f64)]| {
        let mut theta = vec![0.0; n];
        marked.iter().for_each(|(j, amount)| theta[*j] += amount / model.parameters()[*j].size);
        model.first_two_orders(m, &theta)
    };
    let zero = at(&[]);
    let single: Vec<[[Vector3<f64>; 2]; 2]> = (0..n).map(|j| [at(&[(j, 1.0)]), at(&[(j, -1.0)])]).collect();
    let column = |monomial: &ErrorMonomial| match monomial {
        // Errors that are not fitted put a part that is linear in the parameter into the second degree.
        ErrorMonomial(j, None) => {
            let odd = |degree: usize| (single[*j][0][degree] - single[*j][1][degree]) / 2.0;
            odd(0) + odd(1)
        }
        ErrorMonomial(i, Some(j)) if i == j => (single[*i][0][1] + single[*i][1][1]) / 2.0 - zero[1],
        ErrorMonomial(i, Some(j)) => at(&[(*i, 1.0), (*j, 1.0)])[1] - single[*i][0][1] - single[*j][0][1] + zero[1],
    };
    Expansion { constant: zero_unread(m, zero[0] + zero[1]), columns: list.iter().map(column).collect() }
}

fn component(
    model: &FitModel<'_>,
    data: &[Measurement],
    rows: &[Expansion],
    list: &[ErrorMonomial],
    k: usize,
) -> Option<MonomialComponent> {
    let seen: Vec<usize> = (0..data.len()).filter(|i| data[*i].reading_mask()[k]).collect();
    if seen.is_empty() {
        return None;
    }
    let occurs = |c: &usize| seen.iter().any(|i| rows[*i].columns[*c][k].abs() > MIN_MONOMIAL_MM);
    let columns: Vec<usize> = (0..list.len()).filter(occurs).collect();
    let mut triangle = Triangle::new(columns.len());
    for i in &seen {
        let right = data[*i].values()[k] - rows[*i].constant[k];
        let root = libm::sqrt(data[*i].weight);
        triangle.push(columns.iter().map(|c| rows[*i].columns[*c][k] * root), right * root);
    }
    let reduced = triangle.finish();
    let scale = reduced.column_norms();
    let svd = reduced.scaled(&scale);
    let rank = svd.rank(RANK_TOLERANCE);
    // A unit of each monomial in the papers' units, mm and rad.
    let sizes = DVector::from_iterator(columns.len(), columns.iter().map(|c| size(model, list[*c])));
    let found = shortest(&svd, &scale, &sizes, &reduced.right, rank);
    let null = svd.null_space(rank);
    let residual = |i: &usize| {
        let fitted: f64 = columns.iter().zip(found.iter()).map(|(c, x)| rows[*i].columns[*c][k] * x).sum();
        data[*i].values()[k] - rows[*i].constant[k] - fitted
    };
    let before = |i: &usize| data[*i].values()[k] - rows[*i].constant[k];
    let rms = |f: &dyn Fn(&usize) -> f64| libm::sqrt(seen.iter().map(|i| f(i) * f(i)).sum::<f64>() / seen.len() as f64);
    let coefficient = |(j, c): (usize, &usize)| {
        let (monomial, unit, factor) = label(model, list[*c]);
        let determined = null.row(j).norm_squared() < MAX_NULL_SPACE_SHARE;
        MonomialCoefficient { monomial, value: found[j] / sizes[j] * factor + 0.0, unit, determined }
    };
    Some(MonomialComponent {
        component: ["dx", "dy", "dz"][k],
        readings: seen.len(),
        columns: columns.len(),
        rank,
        rms_um: Rms { before: rms(&before) * 1e3, after: rms(&residual) * 1e3 },
        coefficients: columns.iter().enumerate().map(coefficient).collect(),
    })
}

/// Returns the product of the sizes of a monomial's parameters.
fn size(model: &FitModel<'_>, ErrorMonomial(i, j): ErrorMonomial) -> f64 {
    let of = |j: usize| model.parameters()[j].size;
    of(i) * j.map_or(1.0, of)
}

/// Returns name, unit, and factor from mm and rad to the unit.
fn label(model: &FitModel<'_>, ErrorMonomial(i, j): ErrorMonomial) -> (String, String, f64) {
    let p = |j: usize| &model.parameters()[j];
    match j {
        None => (p(i).name.clone(), p(i).unit.clone(), p(i).factor),
        Some(j) => {
            let name = format!("{} * {}", p(i).name, p(j).name);
            (name, format!("{} * {}", p(i).unit, p(j).unit), p(i).factor * p(j).factor)
        }
    }
}

/// Returns the shortest best solution in mm and rad: that of the Moore-Penrose inverse of the papers' matrix.
fn shortest(svd: &Svd, scale: &DVector<f64>, sizes: &DVector<f64>, right: &DVector<f64>, rank: usize) -> DVector<f64> {
    let one = svd.solve(right, rank).component_div(scale);
    let null = svd.null_space(rank);
    if null.ncols() == 0 {
        return one;
    }
    let weight = |j: usize| 1.0 / sizes[j];
    let free = DMatrix::from_fn(null.nrows(), null.ncols(), |i, j| null[(i, j)] / scale[i] * weight(i));
    let q = free.qr().q();
    let raw = DVector::from_fn(one.len(), |j, _| one[j] * weight(j));
    let rest = &raw - &q * q.tr_mul(&raw);
    DVector::from_fn(one.len(), |j, _| rest[j] / weight(j))
}
