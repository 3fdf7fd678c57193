//! What a fit is worth: rank, null space in words, uncertainty, and what the noise drowns.

use super::fit::Fit;
use super::parameter::Parameter;
use crate::algebra::linear::Svd;
use crate::units::significant;
use nalgebra::{DMatrix, DVector};

/// Singular values of the column-scaled Jacobian below this share of the largest are zero.
const RANK: f64 = 1e-10;
/// A column is scaled as if it had at least this share of the displacement its parameter usually makes: what
/// is far smaller consists of the rounding of the model, and scaled to unit length would count as rank.
const FAINT: f64 = 1e-2;
/// A parameter with more than this squared share in the null space has no value of its own.
const LOST: f64 = 1e-3;
/// Parameters below this share of the largest in a direction are not named.
const NAMED: f64 = 0.02;

/// A parameter's value and what it is worth; in the parameter's kept unit (mm, rad, degrees of position).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value. Of parameters that the data do not tell apart, the shortest combination.
    pub value: f64,
    /// Standard uncertainty from the scatter of the residuals; `None`: the data leave the value free, or have no reading
    /// more than the rank, so that nothing scatters.
    pub sigma: Option<f64>,
    /// How many times better its effect on a usual reading is known than one reading is: root mean square of the
    /// effect of one standard uncertainty over the readings, inverted, in standard deviations of a reading. Depends on
    /// where was measured, not on what; 0 if the value is free.
    pub valuation: f64,
}

/// A fit with its diagnosis.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One for each parameter.
    pub estimates: Vec<Estimate>,
    /// The least valuation of the machine's parameters that have a value: an observability figure.
    pub valuation: f64,
    /// Numerical rank of the column-scaled Jacobian at the solution.
    pub rank: usize,
    /// How many independent directions the noise does not drown.
    pub well_determined: usize,
    /// What cannot be told apart, in words.
    pub null_space: Vec<String>,
    /// What can in principle, but not with this noise, in words.
    pub drowned: Vec<String>,
    /// Singular values of the column-scaled Jacobian, falling.
    pub singular_values: Vec<f64>,
    /// Largest over smallest of those within the rank.
    pub condition: f64,
    /// Standard deviation of one reading of weight 1 (mm).
    pub sigma: f64,
    /// Readings minus rank.
    pub freedom: usize,
}

impl Solution {
    /// Examines a fit.
    pub fn of(fit: &Fit, parameters: &[Parameter]) -> Self {
        let sizes = DVector::from_iterator(parameters.len(), parameters.iter().map(|p| p.size));
        let norms = fit.reduced.column_norms();
        let strongest = norms.component_div(&sizes).iter().copied().fold(0.0, f64::max);
        let scale = DVector::from_fn(norms.len(), |j, _| norms[j].max(FAINT * strongest * sizes[j]));
        let unit = fit.reduced.scaled(&scale);
        let rank = unit.rank(RANK);
        // In full rank no direction has to be told from the others, and one decomposition will do.
        let full = rank == parameters.len();
        let sized = if full { None } else { Some(fit.reduced.scaled(&sizes)) };
        let freedom = fit.reduced.rows.saturating_sub(rank);
        let sigma = fit.reduced.right_norm() / (freedom.max(1) as f64).sqrt();
        let null = sized.as_ref().map_or_else(Vec::new, |sized| echelon(&sized.null_space(rank)));
        let (covariance, hidden) = match &sized {
            Some(sized) => (sized.covariance(rank), sized.null_space(rank)),
            None => (unit.covariance(rank), DMatrix::zeros(parameters.len(), 0)),
        };
        let units = if full { &scale } else { &sizes };
        // Standard uncertainties for readings of unit variance.
        let spread = |j: usize| libm::sqrt(covariance[(j, j)].max(0.0)) / units[j];
        let free = |j: usize| hidden.row(j).norm_squared() > LOST;
        let theta = at_rest(fit, &null, parameters);
        let root = libm::sqrt(fit.reduced.rows.max(1) as f64);
        let estimate = |(j, value): (usize, f64)| Estimate {
            value,
            sigma: (!free(j) && freedom > 0).then(|| spread(j) * sigma),
            valuation: if free(j) || norms[j] == 0.0 { 0.0 } else { root / (norms[j] * spread(j)) },
        };
        let estimates: Vec<Estimate> = theta.into_iter().enumerate().map(estimate).collect();
        let values = estimates.iter().zip(parameters).filter(|(e, p)| e.valuation > 0.0 && !p.is_nuisance());
        let valuation = values.map(|(e, _)| e.valuation).reduce(f64::min).unwrap_or(0.0);
        let well_determined = heard(&unit, rank, fit.reduced.rows);
        let smallest = if rank > 0 { unit.values[rank - 1] } else { 0.0 };
        Self {
            estimates,
            valuation,
            rank,
            well_determined,
            null_space: null.iter().map(|row| inseparable(&named(row), parameters)).collect(),
            drowned: drowned(&unit, &scale, well_determined..rank, sigma, parameters),
            condition: if smallest > 0.0 { unit.values[0] / smallest } else { f64::INFINITY },
            singular_values: unit.values.iter().copied().collect(),
            sigma,
            freedom,
        }
    }

    /// Values of the parameters (mm, rad, degrees of position).
    pub fn theta(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }
}

/// Independent directions in which one standard deviation of the estimate moves the points, parameter by
/// parameter, less than the noise of a single reading does. It depends on where was measured, not on what.
fn heard(unit: &Svd, rank: usize, readings: usize) -> usize {
    let limit = 1.0 / (readings.max(1) as f64).sqrt();
    (0..rank).filter(|k| unit.values[*k] > limit).count()
}

/// Puts parameters that have no effect back to where they started: what is left of them is the bend of
/// the directions they hid in while the others moved.
fn at_rest(fit: &Fit, null: &[DVector<f64>], parameters: &[Parameter]) -> Vec<f64> {
    let mut theta = fit.theta.clone();
    for row in null {
        let [(alone, amount)] = named(row)[..] else { continue };
        if fit.bounded[alone] {
            continue;
        }
        let away = (theta[alone] - parameters[alone].start) * parameters[alone].size / amount;
        for (j, parameter) in parameters.iter().enumerate().filter(|(j, _)| *j != alone) {
            theta[j] -= away * row[j] / parameter.size;
        }
        theta[alone] = parameters[alone].start;
    }
    theta
}

/// A direction: parameters and how much of each (unit size 1).
type Direction = Vec<(usize, f64)>;

/// A basis of a subspace in which few parameters take part in each direction: reduced echelon form.
fn echelon(basis: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let mut rows: Vec<DVector<f64>> = basis.column_iter().map(|column| column.into_owned()).collect();
    // Among equals the first: which of two equal parts is larger must not depend on rounding.
    let largest =
        |row: &DVector<f64>| (0..row.len()).fold(0, |p, j| if row[j].abs() > 1.0001 * row[p].abs() { j } else { p });
    for k in 0..rows.len() {
        let size = |row: &DVector<f64>| row[largest(row)].abs();
        let best =
            (k..rows.len()).fold(k, |best, i| if size(&rows[i]) > 1.0001 * size(&rows[best]) { i } else { best });
        rows.swap(k, best);
        let pivot = largest(&rows[k]);
        if rows[k][pivot] == 0.0 {
            continue;
        }
        let row = &rows[k] / rows[k][pivot];
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[pivot];
            if i == k { other.copy_from(&row) } else { *other -= &row * factor }
        }
    }
    rows.sort_by_key(|row| (named(row).len(), largest(row)));
    rows
}

/// The parameters that matter in a direction.
fn named(row: &DVector<f64>) -> Direction {
    let largest = row.iter().map(|x| x.abs()).fold(0.0, f64::max);
    row.iter().copied().enumerate().filter(|(_, x)| x.abs() > NAMED * largest && *x != 0.0).collect()
}

/// `EX0C, tool.X and workpiece.X`.
fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

fn names<'a>(direction: &Direction, parameters: &'a [Parameter]) -> Vec<&'a str> {
    direction.iter().map(|(j, _)| parameters[*j].name.as_str()).collect()
}

fn inseparable(direction: &Direction, parameters: &[Parameter]) -> String {
    if let [(j, _)] = direction[..] {
        return format!("{} has no effect on these data", parameters[j].name);
    }
    let first = direction.first().map_or(1.0, |(j, x)| parameters[*j].shown(x / parameters[*j].size));
    let amount = |(j, x): &(usize, f64)| parameters[*j].shown(x / parameters[*j].size) / first;
    let curves = direction.chunk_by(|(i, _), (j, _)| parameters[*i].curve().0 == parameters[*j].curve().0);
    let (mut names, mut parts) = (Vec::new(), Vec::new());
    for knots in curves {
        match shape(knots, &amount, parameters) {
            Some(part) => {
                names.push(parameters[knots[0].0].curve().0);
                parts.push(part);
            }
            None => {
                let part = |k: &(usize, f64)| {
                    format!("{} {} {}", parameters[k.0].name, signed(amount(k)), parameters[k.0].unit)
                };
                names.extend(knots.iter().map(|(j, _)| parameters[*j].name.as_str()));
                parts.extend(knots.iter().map(part));
            }
        }
    }
    match &parts[..] {
        [one] => format!("{one} changes nothing"),
        _ => format!("{} cannot be separated: together {} change nothing", list(&names), parts.join(", ")),
    }
}

/// Amounts of neighbouring knots of a curve as one: the same throughout, or from one to another. `None` of so few that they
/// may as well be listed.
fn shape(knots: &[(usize, f64)], amount: &impl Fn(&(usize, f64)) -> f64, parameters: &[Parameter]) -> Option<String> {
    let ([(i, _), .., (j, _)], true) = (knots, knots.len() > 2) else { return None };
    let (curve, from) = parameters[*i].curve();
    let (from, to, unit) = (from?, parameters[*j].curve().1?, &parameters[*i].unit);
    let (first, last) = (amount(&knots[0]), amount(&knots[knots.len() - 1]));
    let all = parameters.iter().filter(|p| p.curve().0 == curve).count() == knots.len();
    let even = knots.iter().all(|k| (amount(k) - first).abs() <= 0.01 * first.abs());
    if all && even {
        return Some(format!("{curve} {} {unit} throughout", signed(first)));
    }
    Some(format!("{curve} {} {unit} at {from} to {} {unit} at {to}", signed(first), signed(last)))
}

fn signed(value: f64) -> String {
    let text = significant(value, 3);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// Parameters named of a direction that the noise drowns: those with the largest part.
const MOST_NAMED: usize = 6;
/// What moves points by more than this (mm) is no error of a machine: less of it is named.
const LARGE: f64 = 1.0;

/// The directions within the rank whose uncertainty is beyond use, each with what it amounts to.
fn drowned(
    unit: &Svd,
    scale: &DVector<f64>,
    which: std::ops::Range<usize>,
    sigma: f64,
    parameters: &[Parameter],
) -> Vec<String> {
    let describe = |k: usize| {
        let value = unit.values[k];
        // One standard deviation along this direction, in units of displacement.
        let spread = |j: usize| unit.v[(j, k)] / scale[j] * sigma / value * parameters[j].size;
        let direction = named(&DVector::from_fn(parameters.len(), |j, _| spread(j)));
        let mut direction: Direction = direction.into_iter().filter(|(j, _)| unit.v[(*j, k)].abs() > 0.1).collect();
        direction.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let most = direction.first().map_or(0.0, |(_, x)| x.abs());
        let share = if most > LARGE { LARGE / most } else { 1.0 };
        let part = |(j, x): &(usize, f64)| {
            let p = &parameters[*j];
            format!("{} {} {}", p.name, signed(p.shown(x * share / p.size)), p.unit)
        };
        let others = direction.split_off(direction.len().min(MOST_NAMED)).len();
        let mut parts: Vec<String> = direction.iter().map(part).collect();
        let mut names = names(&direction, parameters);
        let more = format!("{others} more");
        if others > 0 {
            names.push(&more);
            parts.push("...".to_owned());
        }
        let (parts, names) = (parts.join(", "), list(&names));
        if share < 1.0 {
            let share = significant(share, 2);
            return format!(
                "{names} are only known together: {parts} are {share} of what the noise (one standard deviation) hides"
            );
        }
        format!("{names} are only known together: the noise (one standard deviation) cannot be told from {parts}")
    };
    which.map(describe).collect()
}
