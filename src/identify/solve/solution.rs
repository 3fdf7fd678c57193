//! Quality of a fit: rank, null space in words, uncertainty, and weakly identified combinations.
//!
//! Notation: J is the Jacobian of the readings over their scatter, R its triangle, C the covariance of the unknowns.
//! A displacement is an unknown times its usual effect on a point (mm), so that unlike unknowns can be compared.

use super::fit::ParameterFit;
use super::plausible::within_plausible;
use crate::algebra::linear::{ReducedSystem, Svd, beside, over_columns};
use crate::evaluate::Order;
use crate::identify::data::Measurement;
use crate::identify::model::{FitModel, Parameter, sizes};
use crate::identify::thresholds::*;
use crate::identify::words::{describe_null, describe_weak, join_names, main_parts, reduced_echelon};
use crate::lower::Source;
use crate::machine::JointUncertainty;
use crate::standards::Coverage;
use nalgebra::{DMatrix, DVector, RowDVector};

/// Parts named of a direction that changes nothing, for people.
const MAX_LISTED: usize = 12;
/// A parameter's value and its uncertainty, in the parameter's kept unit (mm, rad, degrees of position).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// The value. In the null space it is the part of the shortest solution.
    pub value: f64,
    /// Combined standard uncertainty; `None` if the value is in the null space or there are no residual degrees of
    /// freedom.
    pub sigma: Option<f64>,
    /// The part of it by the scatter of independent readings (type A).
    pub scatter: Option<f64>,
    /// The part of it by the form of the axes beside the fitted curves.
    pub form: f64,
    /// The part of it that is common to all readings (type B).
    pub common: f64,
    /// Coverage factor of a 95 % interval (Student); `None` without residual degrees of freedom.
    pub coverage: Option<f64>,
    /// Observability `sqrt(n / VIF)` for n readings and the variance inflation factor of the parameter's column of J:
    /// one reading's standard deviation over the RMS effect of one standard uncertainty. 0 in the null space.
    pub observability: f64,
}

/// Covariance of the parameters, in their units, by the form of the axes beside the fitted curves.
#[derive(Debug, Clone, PartialEq)]
pub struct FormCovariance {
    /// All of it.
    pub all: DMatrix<f64>,
    /// The part that remains for predictions which add the stated forms themselves: covariance of the distance from the
    /// values that come nearest to the machine over the volume, form and all (the L2 projection of Tuo and Wu 2015).
    /// All of it if no form is stated.
    pub unmodelled: DMatrix<f64>,
}

/// Covariance of the parameters, in their units, from what readings share.
#[derive(Debug, Clone, PartialEq)]
struct SharedCovariance {
    form: FormCovariance,
    /// By what is common to all readings.
    common: DMatrix<f64>,
}

/// Effects on the unknowns of uncertainties that all readings share.
pub struct CommonEffects {
    /// The covariance of the unknowns, in their units.
    pub(super) covariance: DMatrix<f64>,
    /// Indices of the uncertainties that move no unknown.
    pub(super) idle: Vec<usize>,
}

impl SharedCovariance {
    /// Returns that of linear functions (rows) of the parameters: `map C map^T`.
    fn through(&self, map: &DMatrix<f64>) -> Self {
        let through = |of: &DMatrix<f64>| map * of * map.transpose();
        let form = FormCovariance { all: through(&self.form.all), unmodelled: through(&self.form.unmodelled) };
        Self { form, common: through(&self.common) }
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.form.all[(i, j)] + self.common[(i, j)]
    }
}

/// A change of the unknowns to a datum.
pub(super) struct DatumTransform<'a> {
    /// Linear map of the unknowns, in their units.
    pub map: &'a DMatrix<f64>,
    /// Their values in the datum.
    pub theta: &'a [f64],
    /// True if it also fixes directions that readings see weakly.
    pub fixes_weak: bool,
}

/// A fit with its diagnosis.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One for each parameter.
    pub estimates: Vec<Estimate>,
    /// Least observability of the machine's parameters outside the null space.
    pub observability: f64,
    /// Numerical rank of the column-scaled Jacobian at the solution.
    pub rank: usize,
    /// The rank to first order in the errors: directions that only products of errors show do not count.
    pub rank_first_order: usize,
    /// Number of independent directions above the noise of one reading.
    pub well_determined: usize,
    /// Parameters without effect on any reading.
    pub without_effect: Vec<String>,
    /// Null space in words: a sentence for each direction, first those of `without_effect`.
    pub null_space: Vec<String>,
    /// The same sentences, cut to a few parts.
    null_space_summary: Vec<String>,
    /// Directions within the rank but below the noise of one reading, in words.
    pub below_noise: Vec<String>,
    /// Singular values of the column-scaled Jacobian, falling.
    pub singular_values: Vec<f64>,
    /// Largest over smallest of those within the rank.
    pub condition: f64,
    /// Standard deviation of one reading of weight 1 (mm).
    pub sigma: f64,
    /// Residual degrees of freedom: readings minus rank.
    pub degrees_of_freedom: usize,
    /// Root of the covariance of the parameters as displacements over `units`, for readings of unit variance.
    root: DMatrix<f64>,
    /// Residual degrees of freedom that the scatter of each parameter rests on.
    parameter_freedom: Vec<f64>,
    /// Orthonormal basis (columns) of the null space, by displacements.
    null_basis: DMatrix<f64>,
    units: DVector<f64>,
    /// Covariance beyond what the scatter of single readings makes.
    shared: SharedCovariance,
    /// Indices of the uncertainties common to all readings that move no unknown.
    pub idle_common: Vec<usize>,
    /// The null space as a reduced echelon basis, by displacements.
    null_echelon: Vec<DVector<f64>>,
    /// Basis (columns, by displacements) of the null space to first order, if it is larger than the exact one.
    second_order_only: Option<DMatrix<f64>>,
    /// Displacements (columns) by one standard uncertainty of those of its directions that readings notice.
    noticed: DMatrix<f64>,
}

/// Directions (columns, by displacements) that the readings do not see to first order.
struct WeakDirections {
    /// Orthonormal basis.
    free: DMatrix<f64>,
    /// Those that the readings notice all the same, as displacements by one standard uncertainty.
    noticed: DMatrix<f64>,
}

impl Solution {
    /// Examines a fit.
    pub fn of(fit: &ParameterFit, parameters: &[Parameter]) -> Self {
        Self::examine(fit, parameters, None)
    }

    /// Examines a fit; directions that are only seen to second order (columns, by displacements) count as null space.
    fn examine(fit: &ParameterFit, parameters: &[Parameter], second_order_only: Option<&DMatrix<f64>>) -> Self {
        let sizes = sizes(parameters);
        let (reduced, redundancy) = with_prior(fit, &sizes);
        let reduced = blind_to(reduced, &sizes, second_order_only);
        let scale = column_scale(&reduced, &sizes);
        let unit = reduced.scaled(&scale);
        let rank =
            second_order_only.map_or_else(|| unit.rank(RANK_TOLERANCE), |blind| parameters.len() - blind.ncols());
        // In full rank there is no null space to separate, and one decomposition will do.
        let full = rank == parameters.len();
        let sized = if full { None } else { Some(reduced.scaled(&sizes)) };
        let degrees_of_freedom =
            redundancy.map_or(fit.reduced.rows.saturating_sub(rank), |rest| libm::round(rest) as usize);
        let sigma = libm::sqrt(fit.squares / redundancy.unwrap_or(degrees_of_freedom as f64).max(1.0));
        let null_echelon = sized.as_ref().map_or_else(Vec::new, |sized| reduced_echelon(&sized.null_space(rank)));
        let null_basis =
            sized.as_ref().map_or_else(|| DMatrix::zeros(parameters.len(), 0), |sized| sized.null_space(rank));
        let units = if full { scale.clone() } else { sizes.clone() };
        let root = match within_plausible(&reduced, &fit.plausible, rank, sigma) {
            Some(all) => all.scaled(&units).root_covariance(rank),
            None => sized.as_ref().unwrap_or(&unit).root_covariance(rank),
        };
        let by_parameter = |j: usize| fit.parameter_freedom.get(j).copied().unwrap_or(degrees_of_freedom as f64);
        let parameter_freedom: Vec<f64> = (0..parameters.len()).map(by_parameter).collect();
        let mut student = Coverage::default();
        let estimate = |(j, value): (usize, f64)| {
            let coverage = (degrees_of_freedom > 0).then(|| student.reach(parameter_freedom[j]));
            Estimate { value, coverage, ..Estimate::default() }
        };
        let theta = reset_without_effect(fit, &null_echelon, parameters);
        let estimates: Vec<Estimate> = theta.into_iter().enumerate().map(estimate).collect();
        let well_determined = count_above_noise(&unit, rank, fit.reduced.rows);
        let spread = |k: usize| displacements(&unit, k, &sizes, &scale) * (sigma / unit.values[k]);
        // Without residual degrees of freedom there is no noise that would hide anything.
        let hidden = if degrees_of_freedom > 0 { well_determined..rank } else { 0..0 };
        let spreads: Vec<DVector<f64>> = hidden.map(spread).collect();
        let none = DMatrix::zeros(parameters.len(), parameters.len());
        let form = FormCovariance { all: none.clone(), unmodelled: none.clone() };
        let mut solution = Self {
            estimates,
            observability: 0.0,
            rank,
            rank_first_order: rank,
            well_determined,
            without_effect: Vec::new(),
            null_space: Vec::new(),
            null_space_summary: Vec::new(),
            below_noise: describe_weak(&spreads, &scale.component_div(&sizes), &null_echelon, parameters),
            condition: condition(&unit, rank),
            singular_values: unit.values.iter().copied().collect(),
            sigma,
            degrees_of_freedom,
            units,
            shared: SharedCovariance { form, common: none },
            idle_common: Vec::new(),
            root,
            parameter_freedom,
            null_basis,
            null_echelon,
            second_order_only: second_order_only.cloned(),
            noticed: DMatrix::zeros(parameters.len(), 0),
        };
        solution.estimate_scatter(fit);
        solution.estimates.iter_mut().for_each(|estimate| estimate.sigma = estimate.scatter);
        solution.describe_null_space(parameters);
        solution
    }

    /// Adds covariances by what readings share: the form of the axes, and what is common to all.
    pub fn add_covariances(mut self, form: Option<&FormCovariance>, common: CommonEffects) -> Self {
        let none = || DMatrix::zeros(self.units.len(), self.units.len());
        let form = form.cloned().unwrap_or_else(|| FormCovariance { all: none(), unmodelled: none() });
        self.idle_common = common.idle;
        self.shared = SharedCovariance { form, common: common.covariance };
        self.combine();
        self
    }

    /// Takes over what the readings share in another solution of the same linear problem, to which this one adds
    /// knowledge: that moves this one less.
    pub(super) fn add_covariances_of(mut self, other: &Self, fit: &ParameterFit) -> Self {
        let seen = with_known(&fit.reduced, &fit.known, self.sigma).r;
        let root = self.covariance_root();
        self.shared = other.shared.through(&(&root * (&seen * &root).tr_mul(&seen)));
        self.combine();
        self
    }

    /// Combines scatter and shared covariance: `u^2 = u_scatter^2 + u_form^2 + u_common^2`.
    fn combine(&mut self) {
        let mut student = Coverage::default();
        for (j, estimate) in self.estimates.iter_mut().enumerate() {
            let root = |part: &DMatrix<f64>| libm::sqrt(part[(j, j)].max(0.0));
            (estimate.form, estimate.common) = (root(&self.shared.form.all), root(&self.shared.common));
            let all = |scatter: f64| libm::sqrt(scatter * scatter + self.shared.entry(j, j).max(0.0));
            estimate.sigma = estimate.scatter.map(all);
            // Only the scatter rests on few readings (Welch and Satterthwaite, JCGM 100:2008, G.4.1).
            let both = estimate.scatter.zip(estimate.sigma).filter(|(scatter, _)| *scatter > 0.0);
            let ratio = both.map_or(1.0, |(scatter, sigma)| sigma / scatter);
            let freedom = self.parameter_freedom[j] * ratio * ratio * ratio * ratio;
            estimate.coverage = estimate.coverage.map(|_| student.reach(freedom));
        }
    }

    /// Widens the scatter so that two standard uncertainties reach 95 % with few residual degrees of freedom (Student).
    /// The unknowns of one error are widened alike, for they may cancel.
    pub fn with_student_scatter(mut self, parameters: &[Parameter]) -> Self {
        let mut student = Coverage::default();
        let sources = |p: &Parameter| p.terms.iter().map(|term| term.source).collect::<Vec<_>>();
        let all: Vec<Vec<Source>> = parameters.iter().map(sources).collect();
        for j in 0..self.root.nrows() {
            let same_error = |i: &usize| {
                *i == j || all.get(j).zip(all.get(*i)).is_some_and(|(a, b)| a.iter().any(|s| b.contains(s)))
            };
            let freedom = (0..self.parameter_freedom.len()).filter(same_error).map(|i| self.parameter_freedom[i]);
            let freedom = freedom.fold(f64::INFINITY, f64::min);
            self.root.row_mut(j).scale_mut((0.5 * student.reach(freedom)).max(1.0));
        }
        self
    }

    /// Returns a root of the covariance of the parameters, in their units, for independent readings of unit variance.
    /// The null space has no part in it.
    pub(super) fn covariance_root(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.root.nrows(), self.root.ncols(), |j, k| self.root[(j, k)] / self.units[j])
    }

    /// Returns the combined covariance of all parameters as displacements over `units`, for predictions beside the
    /// stated forms.
    fn prediction_covariance(&self) -> DMatrix<f64> {
        let scatter = &self.root * self.root.transpose() * (self.sigma * self.sigma);
        let shared = &self.shared.form.unmodelled + &self.shared.common;
        let scaled = |i: usize, j: usize| shared[(i, j)] * self.units[i] * self.units[j];
        scatter + DMatrix::from_fn(self.units.len(), self.units.len(), scaled)
    }

    /// Counts the rank of the model to first order at the same values, where rigid `motions` of the machine that no
    /// reading notices are free. Directions that only products of errors show are useless in practice, and parameters
    /// they hardly touch would be as uncertain as they are: they count as null space, but where the errors are so large
    /// that the readings see them as others.
    pub fn with_first_order_rank(
        self,
        model: &FitModel<'_>,
        data: &[Measurement],
        fit: &ParameterFit,
        motions: &[DVector<f64>],
    ) -> Self {
        let parameters = model.parameters();
        let sizes = sizes(parameters);
        let first = model.clone().to_order(Order::Degree(1)).triangle(data, &fit.weights, &fit.theta);
        let first = with_known(&first, &fit.known, self.sigma);
        let rank = first.scaled(&column_scale(&first, &sizes)).rank(RANK_TOLERANCE);
        let unseen = first.scaled(&sizes).null_space(rank);
        let WeakDirections { free, noticed } = self.weakest_directions(fit, &sizes, &unseen, motions);
        if parameters.len() - free.ncols() >= self.rank {
            return self;
        }
        let mut first_order = Self::examine(fit, parameters, Some(&free));
        let values = self.estimates.iter().map(|estimate| estimate.value);
        first_order.estimates.iter_mut().zip(values).for_each(|(estimate, value)| estimate.value = value);
        first_order.rank = self.rank;
        first_order.degrees_of_freedom = self.degrees_of_freedom;
        first_order.singular_values = self.singular_values;
        first_order.sigma = self.sigma;
        first_order.noticed = noticed;
        first_order.estimate_scatter(fit);
        first_order.combine();
        first_order
    }

    /// Returns the null space at the solution with rigid `motions`, and the directions `unseen` to first order that the
    /// readings see least there, as many as are unseen in all: errors turn what changes nothing to first order.
    fn weakest_directions(
        &self,
        fit: &ParameterFit,
        sizes: &DVector<f64>,
        unseen: &DMatrix<f64>,
        motions: &[DVector<f64>],
    ) -> WeakDirections {
        let columns = |of: &DMatrix<f64>| of.column_iter().map(|column| column.into_owned()).collect::<Vec<_>>();
        let null = with_motions(&self.null_basis, motions);
        let all = with_motions(&null, &columns(unseen));
        let rest = all.columns(null.ncols(), all.ncols() - null.ncols());
        let weak = with_motions(unseen, motions).ncols().saturating_sub(null.ncols());
        let readings = over_columns(&with_known(&fit.reduced, &fit.known, self.sigma).r, sizes);
        let largest = readings.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
        let seen = Svd::new(&(readings * rest));
        let well = seen.values.iter().filter(|value| **value > MIN_PRODUCT_SHARE * largest).count();
        let well = well.max(rest.ncols().saturating_sub(weak));
        let products = rest * seen.null_space(well);
        let notice = |k: &usize| seen.values[well + k] * fit.plausible_mm() > self.sigma;
        let amount = |k: usize| products.column(k) * (self.sigma / seen.values[well + k]);
        let noticed: Vec<DVector<f64>> = (0..products.ncols()).filter(notice).map(amount).collect();
        let noticed = DMatrix::from_fn(sizes.len(), noticed.len(), |i, k| noticed[k][i]);
        WeakDirections { free: with_motions(&null, &columns(&products)), noticed }
    }

    /// Takes scatter and observability of the parameters from the root of their covariance.
    fn estimate_scatter(&mut self, fit: &ParameterFit) {
        let norms = fit.reduced.column_norms();
        let readings = libm::sqrt(fit.reduced.rows.max(1) as f64);
        for (j, estimate) in self.estimates.iter_mut().enumerate() {
            let is_free = self.null_basis.row(j).norm_squared() > MAX_NULL_SPACE_SHARE;
            let spread = self.root.row(j).norm() / self.units[j];
            estimate.scatter = (!is_free && self.degrees_of_freedom > 0).then_some(spread * self.sigma);
            estimate.observability =
                if is_free || norms[j] == 0.0 || spread == 0.0 { 0.0 } else { readings / (norms[j] * spread) };
        }
    }

    fn describe_null_space(&mut self, parameters: &[Parameter]) {
        let single = |row: &DVector<f64>| only_parameter(row).map(|(j, _)| parameters[j].name.clone());
        self.without_effect = self.null_echelon.iter().map_while(single).collect();
        let text = |max| self.null_echelon.iter().map(|row| describe_null(&main_parts(row), parameters, max)).collect();
        (self.null_space, self.null_space_summary) = (text(usize::MAX), text(MAX_LISTED));
        let values = self.estimates.iter().zip(parameters).filter(|(e, p)| e.observability > 0.0 && !p.is_nuisance());
        self.observability = values.map(|(e, _)| e.observability).reduce(f64::min).unwrap_or(0.0);
    }

    /// Returns the standard uncertainty of a linear combination of parameters (index and factor); `None` if it has a
    /// part in the null space or there are no residual degrees of freedom.
    pub fn uncertainty(&self, combination: &[(usize, f64)]) -> Option<f64> {
        let mut row = DVector::zeros(self.units.len());
        combination.iter().for_each(|(j, factor)| row[*j] += factor / self.units[*j]);
        let is_determined = self.null_basis.tr_mul(&row).norm_squared() <= MAX_NULL_SPACE_SHARE * row.norm_squared();
        let acting: Vec<usize> = (0..row.len()).filter(|j| row[*j] != 0.0).collect();
        let pairs = acting.iter().flat_map(|i| acting.iter().map(move |j| (*i, *j)));
        let amount = |j: usize| row[j] * self.units[j];
        let shared: f64 = pairs.map(|(i, j)| amount(i) * self.shared.entry(i, j) * amount(j)).sum();
        let mut scatter = RowDVector::zeros(self.root.ncols());
        acting.iter().for_each(|j| scatter += self.root.row(*j) * (row[*j] * self.sigma));
        let all = || libm::sqrt((scatter.norm_squared() + shared).max(0.0));
        (is_determined && self.degrees_of_freedom > 0).then(all)
    }

    /// Returns the solution in a datum (S-transformation): the covariance goes through its map, and null-space
    /// directions that its conditions fix leave the null space.
    pub(super) fn in_datum(mut self, datum: &DatumTransform<'_>, fit: &ParameterFit, parameters: &[Parameter]) -> Self {
        let count = datum.theta.len();
        // Second-order-only directions are as good as unknown: a datum may fix them.
        let units = sizes(parameters);
        let reduced = blind_to(with_prior(fit, &units).0, &units, self.second_order_only.as_ref());
        let rank = self.rank_first_order;
        let seen = reduced.scaled(&units);
        self.null_basis = seen.null_space(rank);
        let known = within_plausible(&reduced, &fit.plausible, rank, self.sigma);
        self.root = known.map_or(seen, |all| all.scaled(&units)).root_covariance(rank);
        self.units = units.clone();
        self.shared = self.shared.through(datum.map);
        let map = DMatrix::from_fn(count, count, |i, j| datum.map[(i, j)] * units[i] / units[j]);
        self.root = &map * &self.root;
        let svd = Svd::new(&(&map * &self.null_basis).transpose());
        let kept = svd.values.iter().filter(|value| **value > MIN_FREE_LENGTH).count();
        let fixed = self.null_basis.ncols() - kept;
        self.null_basis = svd.v.columns(0, kept).into_owned();
        self.noticed = DMatrix::zeros(count, 0);
        self.null_echelon = reduced_echelon(&self.null_basis);
        self.rank_first_order += fixed;
        self.rank = self.rank.max(self.rank_first_order);
        self.estimates.iter_mut().zip(datum.theta).for_each(|(estimate, value)| estimate.value = *value);
        self.estimate_scatter(fit);
        self.combine();
        self.describe_null_space(parameters);
        if datum.fixes_weak {
            self.describe_weak_in_datum(&reduced, &map, rank, parameters);
        }
        self
    }

    /// Describes what is below noise of the parameters in a datum; `map` takes displacements of the fit to its.
    fn describe_weak_in_datum(
        &mut self,
        reduced: &ReducedSystem,
        map: &DMatrix<f64>,
        rank: usize,
        parameters: &[Parameter],
    ) {
        let sizes = &self.units;
        let scale = column_scale(reduced, sizes);
        let sized = over_columns(&reduced.r, sizes) * map;
        let r = DMatrix::from_fn(sized.nrows(), sizes.len(), |i, j| sized[(i, j)] * sizes[j]);
        let unit = ReducedSystem { r, ..reduced.clone() }.scaled(&scale);
        let rank = unit.rank(RANK_TOLERANCE).min(rank);
        self.well_determined = count_above_noise(&unit, rank, reduced.rows);
        self.condition = condition(&unit, rank);
        let spread = |k: usize| map * displacements(&unit, k, sizes, &scale) * (self.sigma / unit.values[k]);
        let spreads: Vec<DVector<f64>> = (self.well_determined..rank).map(spread).collect();
        self.below_noise = describe_weak(&spreads, &scale.component_div(sizes), &self.null_echelon, parameters);
    }

    /// Returns the covariance of the first `count` parameters, in their units, row by row, with scatter, form, and what
    /// is common to the readings. The null space has no part in it.
    pub fn covariance(&self, count: usize) -> Vec<Vec<f64>> {
        let root = self.covariance_root() * self.sigma;
        let whole = &root * root.transpose() + &self.shared.form.all + &self.shared.common;
        (0..count).map(|i| (0..count).map(|j| whole[(i, j)]).collect()).collect()
    }

    /// Returns a factor F of the joint covariance `F F^T` of the first `count` parameters, in their units: its columns
    /// are independent parts of one standard uncertainty each, the largest first. The null space has no part in it; it
    /// is empty without residual degrees of freedom.
    pub fn covariance_factor(&self, count: usize) -> Vec<Vec<f64>> {
        if self.degrees_of_freedom == 0 {
            return Vec::new();
        }
        let svd = Svd::new(&self.prediction_covariance().view((0, 0), (count, count)).into_owned());
        let largest = svd.values.iter().copied().fold(0.0, f64::max);
        let counts = |value: &&f64| **value > MIN_COVARIANCE_SHARE * largest;
        let column = |(k, value): (usize, &f64)| {
            let scale = value.sqrt();
            (0..count).map(|j| svd.v[(j, k)] * scale / self.units[j]).collect()
        };
        svd.values.iter().take_while(counts).take(JointUncertainty::MOST).enumerate().map(column).collect()
    }

    /// Returns for linear functions A of the parameters (rows, in their units) `C A^T`, so that their covariance is
    /// `A C A^T`, and the effect of the null-space directions (columns) on each.
    pub(super) fn covariance_with(&self, rows: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let scaled = over_columns(rows, &self.units);
        let unit = |column: nalgebra::DVectorView<'_, f64>| column.normalize();
        let noticed: Vec<DVector<f64>> = self.noticed.column_iter().map(unit).collect();
        let unnoticed = self.null_basis.column_iter().map(|column| beside(column.into_owned(), &noticed));
        let unnoticed: Vec<DVector<f64>> = unnoticed.collect();
        let free = &scaled * DMatrix::from_fn(scaled.ncols(), unnoticed.len(), |i, k| unnoticed[k][i]);
        let half = (self.prediction_covariance() + &self.noticed * self.noticed.transpose()) * scaled.transpose();
        let columns = DMatrix::from_fn(half.nrows(), half.ncols(), |j, i| half[(j, i)] / self.units[j]);
        (columns, free)
    }

    /// Describes the null-space direction that changes these linear functions (rows) most.
    pub(super) fn worst_null_direction(&self, rows: &DMatrix<f64>, parameters: &[Parameter]) -> Option<String> {
        let effect = |direction: &DVector<f64>| {
            let step = DVector::from_fn(direction.len(), |j, _| direction[j] / parameters[j].size);
            (rows * step).amax()
        };
        let larger = |a: (usize, f64), b: (usize, f64)| if b.1 > TIE_RATIO * a.1 { b } else { a };
        let (worst, _) = self.null_echelon.iter().map(effect).enumerate().reduce(larger)?;
        self.null_space_summary.get(worst).cloned()
    }

    /// Returns the smallest and the largest coverage factor of 95 % intervals; `None` without residual degrees of
    /// freedom.
    pub fn coverage_range(&self) -> Option<(f64, f64)> {
        let factors = self.estimates.iter().filter_map(|e| e.coverage).map(|factor| (factor, factor));
        factors.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Returns the null space in short sentences: one for all parameters without effect, one for each other direction.
    pub fn null_space_summary(&self) -> Vec<String> {
        let names: Vec<&str> = self.without_effect.iter().map(String::as_str).collect();
        let all = (names.len() >= 2).then(|| format!("{} have no effect on these data", join_names(&names)));
        let rest = self.null_space_summary.iter().skip(if all.is_some() { names.len() } else { 0 }).cloned();
        all.into_iter().chain(rest).collect()
    }

    /// Returns the values of the parameters (mm, rad, degrees of position).
    pub fn theta(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }
}

/// Adds known values (rows over their standard uncertainty) to readings that scatter by `sigma` (mm).
fn with_known(reduced: &ReducedSystem, known: &DMatrix<f64>, sigma: f64) -> ReducedSystem {
    if known.nrows() == 0 {
        return reduced.clone();
    }
    reduced.with_rows(&(known * sigma.max(MIN_SCATTER_MM)), &DVector::zeros(known.nrows()))
}

/// Takes directions N (orthonormal columns, by displacements) out of a linear problem: `J (1 - N N^T)`.
fn blind_to(reduced: ReducedSystem, sizes: &DVector<f64>, directions: Option<&DMatrix<f64>>) -> ReducedSystem {
    let Some(directions) = directions else { return reduced };
    let sized = over_columns(&reduced.r, sizes);
    let blind = &sized - (&sized * directions) * directions.transpose();
    ReducedSystem { r: DMatrix::from_fn(blind.nrows(), blind.ncols(), |i, j| blind[(i, j)] * sizes[j]), ..reduced }
}

/// Extends orthonormal directions by those parts of motions that are not among them.
fn with_motions(free: &DMatrix<f64>, motions: &[DVector<f64>]) -> DMatrix<f64> {
    let mut all: Vec<DVector<f64>> = free.column_iter().map(|column| column.into_owned()).collect();
    for motion in motions {
        let rest = beside(motion.clone(), &all);
        if rest.norm() > MIN_NEW_MOTION_SHARE * motion.norm() {
            all.push(rest.normalize());
        }
    }
    DMatrix::from_fn(free.nrows(), all.len(), |i, j| all[j][i])
}

/// Adds the known values to the linear problem of a fit. Returns it with the redundancy of the readings, their number
/// less their share of the rank (Helmert); `None` if nothing is known.
fn with_prior(fit: &ParameterFit, sizes: &DVector<f64>) -> (ReducedSystem, Option<f64>) {
    if fit.known.nrows() == 0 {
        return (fit.reduced.clone(), None);
    }
    let rank = fit.reduced.scaled(sizes).rank(RANK_TOLERANCE);
    let mut redundancy = fit.reduced.rows as f64 - rank as f64;
    let mut whole = fit.reduced.clone();
    let readings = over_columns(&fit.reduced.r, sizes);
    for _ in 0..REPORT_SCATTER_ITERATIONS {
        let sigma = libm::sqrt(fit.squares / redundancy.max(1.0));
        whole = with_known(&fit.reduced, &fit.known, sigma);
        let sized = whole.scaled(sizes);
        let used = (&readings * sized.root_covariance(sized.rank(RANK_TOLERANCE))).norm_squared();
        redundancy = (fit.reduced.rows as f64 - used).max(0.0);
    }
    (whole, Some(redundancy))
}

/// Returns the scale of each column: its length, or a small share of its usual length if it is shorter.
fn column_scale(reduced: &ReducedSystem, sizes: &DVector<f64>) -> DVector<f64> {
    let norms = reduced.column_norms();
    let strongest = norms.component_div(sizes).iter().copied().fold(0.0, f64::max);
    DVector::from_fn(norms.len(), |j, _| norms[j].max(MIN_COLUMN_SHARE * strongest * sizes[j]))
}

/// Returns a right singular vector of the column-scaled problem in displacements.
fn displacements(unit: &Svd, k: usize, sizes: &DVector<f64>, scale: &DVector<f64>) -> DVector<f64> {
    unit.v.column(k).component_mul(sizes).component_div(scale)
}

/// Returns the ratio of the largest to the smallest singular value within the rank; 1 without rank.
fn condition(unit: &Svd, rank: usize) -> f64 {
    if rank > 0 { unit.values[0] / unit.values[rank - 1].max(f64::MIN_POSITIVE) } else { 1.0 }
}

/// Counts the directions in which one standard deviation of the estimate moves the points, parameter by parameter, less
/// than the noise of one reading does: singular values above `1 / sqrt(n)`. It depends on the poses, not on the errors.
fn count_above_noise(unit: &Svd, rank: usize, readings: usize) -> usize {
    let limit = 1.0 / (readings.max(1) as f64).sqrt();
    (0..rank).filter(|k| unit.values[*k] > limit).count()
}

/// Returns the only parameter of a direction, and its amount; `None` if there are several.
fn only_parameter(row: &DVector<f64>) -> Option<(usize, f64)> {
    if let [only] = main_parts(row)[..] { Some(only) } else { None }
}

/// Puts parameters without effect back to their start: their values are only the curvature of the null space along
/// which the others moved.
fn reset_without_effect(fit: &ParameterFit, null: &[DVector<f64>], parameters: &[Parameter]) -> Vec<f64> {
    let mut theta = fit.theta.clone();
    for row in null {
        let Some((only, amount)) = only_parameter(row) else { continue };
        if fit.slope_bounded[only] {
            continue;
        }
        let away = (theta[only] - parameters[only].start) * parameters[only].size / amount;
        for (j, parameter) in parameters.iter().enumerate().filter(|(j, _)| *j != only) {
            theta[j] -= away * row[j] / parameter.size;
        }
        theta[only] = parameters[only].start;
    }
    theta
}
