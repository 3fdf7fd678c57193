//! The method of Holub and others 2015: the deviation of order 2 as a polynomial in the parameters. Every monomial is
//! an unknown of its own, and each component is solved for itself by the Moore-Penrose inverse. The method is linear
//! and needs no start. It ignores that a product is the product of its factors, and that the components share them.

use super::prediction::{FitModel, zero_unread};
use crate::algebra::linear::Triangle;
use crate::identify::data::{COMPONENTS, Measurement, ReadingKind};
use crate::identify::thresholds::{MAX_INFLATION, MAX_NULL_SPACE_SHARE, MIN_MONOMIAL_MM, RANK_TOLERANCE};
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
    /// The fitted reading of each row (mm), by its index in the data.
    #[serde(skip)]
    pub fitted: Vec<(usize, f64)>,
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
    /// Standard uncertainty, in `unit`, by the pseudo-inverse and what is left of the readings; none without readings
    /// to spare. Of a coefficient that the data do not tell from others it is that of the shortest answer.
    pub sigma: Option<f64>,
    /// True if the data tell it from the others: it is free of the null space, and the others make its uncertainty no
    /// more than ten times what it would be without them.
    pub determined: bool,
}

/// First- and second-degree coefficients of a reading (mm, parameters in units of displacement).
struct Expansion {
    /// The reading with all parameters 0.
    constant: Vector3<f64>,
    /// By monomial.
    columns: Vec<Vector3<f64>>,
}

/// Returns all monomials of one and, of order 2, of two of so many parameters.
fn monomials(count: usize, order: u8) -> Vec<ErrorMonomial> {
    let pairs = (0..if order > 1 { count } else { 0 }).flat_map(|i| (i..count).map(move |j| ErrorMonomial(i, Some(j))));
    (0..count).map(|i| ErrorMonomial(i, None)).chain(pairs).collect()
}

/// Returns the fit of each component that was measured by monomials up to degree 1 or 2. Rows other than deviations are
/// not in the papers: `None`.
pub fn moore_penrose(model: &FitModel<'_>, data: &[Measurement], order: u8) -> Option<Vec<MonomialComponent>> {
    if !data.iter().all(|m| m.kind() == ReadingKind::Deviation) {
        return None;
    }
    let list = monomials(model.own(), order);
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
    let null = svd.null_space(rank);
    let shortest = Shortest::new(&null, &scale, &sizes);
    let found = shortest.of(&svd.solve(&reduced.right, rank));
    let fitted = |i: &usize| -> f64 {
        rows[*i].constant[k] + columns.iter().zip(found.iter()).map(|(c, x)| rows[*i].columns[*c][k] * x).sum::<f64>()
    };
    let residual = |i: &usize| data[*i].values()[k] - fitted(i);
    let squares: f64 = seen.iter().map(|i| data[*i].weight * residual(i) * residual(i)).sum();
    let spare = seen.len() - rank;
    let scatter = (spare > 0).then(|| libm::sqrt(squares / spare as f64));
    // Of readings of unit scatter: the rows of the pseudo-inverse.
    let root = svd.root_covariance(rank);
    let spread: Vec<DVector<f64>> = (0..rank).map(|r| shortest.of(&root.column(r).into_owned())).collect();
    let sigma_of = |j: usize| libm::sqrt(spread.iter().map(|direction| direction[j] * direction[j]).sum::<f64>());
    let before = |i: &usize| data[*i].values()[k] - rows[*i].constant[k];
    let rms = |f: &dyn Fn(&usize) -> f64| libm::sqrt(seen.iter().map(|i| f(i) * f(i)).sum::<f64>() / seen.len() as f64);
    let coefficient = |(j, c): (usize, &usize)| {
        let (monomial, unit, factor) = label(model, list[*c]);
        // Without the others a coefficient scatters by the inverse of its column's length.
        let inflation = sigma_of(j) * scale[j];
        let determined = null.row(j).norm_squared() < MAX_NULL_SPACE_SHARE && inflation < MAX_INFLATION;
        let in_unit = factor / sizes[j];
        let sigma = scatter.map(|scatter| scatter * sigma_of(j) * in_unit);
        MonomialCoefficient { monomial, value: found[j] * in_unit + 0.0, unit, sigma, determined }
    };
    Some(MonomialComponent {
        component: COMPONENTS[k],
        readings: seen.len(),
        columns: columns.len(),
        rank,
        rms_um: Rms { before: rms(&before) * 1e3, after: rms(&residual) * 1e3 },
        coefficients: columns.iter().enumerate().map(coefficient).collect(),
        fitted: seen.iter().map(|i| (*i, fitted(i))).collect(),
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

/// The shortest of equivalent answers in mm and rad: that of the Moore-Penrose inverse of the papers' matrix.
struct Shortest<'a> {
    /// Norms of the columns.
    scale: &'a DVector<f64>,
    /// Sizes of the monomials.
    sizes: &'a DVector<f64>,
    /// Orthonormal basis of what changes nothing, in mm and rad.
    free: Option<DMatrix<f64>>,
}

impl<'a> Shortest<'a> {
    fn new(null: &DMatrix<f64>, scale: &'a DVector<f64>, sizes: &'a DVector<f64>) -> Self {
        let free = DMatrix::from_fn(null.nrows(), null.ncols(), |i, j| null[(i, j)] / scale[i] / sizes[i]);
        Self { scale, sizes, free: (null.ncols() > 0).then(|| free.qr().q()) }
    }

    /// Returns the shortest answer that does as much as one by scaled columns, as displacements.
    fn of(&self, scaled: &DVector<f64>) -> DVector<f64> {
        let one = scaled.component_div(self.scale);
        let Some(free) = &self.free else { return one };
        let raw = one.component_div(self.sizes);
        let rest = &raw - free * free.tr_mul(&raw);
        rest.component_mul(self.sizes)
    }
}
