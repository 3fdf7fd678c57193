//! Quality of a fit: rank, null space in words, uncertainty, and combinations that the noise drowns.

use super::fit::Fit;
use crate::algebra::linear::{ReducedSystem, Svd, beside};
use crate::evaluate::Order;
use crate::identify::data::Measurement;
use crate::identify::model::{Model, Parameter};
use crate::identify::words::{drowned, echelon, inseparable, list, named};
use crate::lower::Source;
use crate::machine::JointUncertainty;
use crate::standards::Coverage;
use nalgebra::{DMatrix, DVector, RowDVector};

/// Singular values of the column-scaled Jacobian below this share of the largest are zero.
const RANK: f64 = 1e-10;
/// A column is scaled as if it had at least this share of the displacement its parameter usually makes: what
/// is far smaller consists of the rounding of the model, and scaled to unit length would count as rank.
const FAINT: f64 = 1e-2;
/// Parts named of a direction that changes nothing, for people.
const MAX_LISTED: usize = 12;
/// A direction of unit size that a datum leaves less of than this is fixed by it.
const FIXED: f64 = 1e-2;
/// Independent parts of the covariance below this share of the largest change nothing.
const TOLD: f64 = 1e-6;
/// Rounds in which the scatter of the readings and what is known before them are weighed against each other.
const ROUNDS: usize = 4;
/// A motion of the whole machine of which free directions leave more than this share is free beside them.
const ADDED: f64 = 0.1;
/// Least scatter (mm) beside which values are known: less is rounding.
pub(super) const MIN_SIGMA: f64 = 1e-9;
/// A parameter with more than this squared share in the null space has no value of its own.
const LOST: f64 = 1e-3;

/// A parameter's value and what it is worth; in the parameter's kept unit (mm, rad, degrees of position).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value. Of parameters that the data do not tell apart, the shortest combination.
    pub value: f64,
    /// Combined standard uncertainty; `None`: the data leave the value free, or have no reading more than the rank, so
    /// that nothing scatters.
    pub sigma: Option<f64>,
    /// The part of it that the scatter of the residuals makes, one independent of the other.
    pub scatter: Option<f64>,
    /// The part of it that the form of the axes makes beside the fitted curves.
    pub form: f64,
    /// The part of it that is common to all readings.
    pub common: f64,
    /// Number of combined standard uncertainties to either side of a 95 % interval (Student); `None` without scatter.
    pub coverage: Option<f64>,
    /// How many times better its effect on a usual reading is known than one reading is: root mean square of the
    /// effect of one standard uncertainty over the readings, inverted, in standard deviations of a reading. Depends on
    /// where was measured, not on what; 0 if the value is free.
    pub valuation: f64,
}

/// Covariance of the parameters, in their units, from what readings share.
#[derive(Debug, Clone, PartialEq)]
struct SharedCovariance {
    /// By the form of the axes beside the fitted curves.
    form: DMatrix<f64>,
    /// The same of what predictions have of it beside the stated forms.
    apart: DMatrix<f64>,
    /// By what is common to all readings.
    common: DMatrix<f64>,
}

impl SharedCovariance {
    /// Returns that of `count` parameters whose readings share nothing.
    fn none(count: usize) -> Self {
        let none = DMatrix::zeros(count, count);
        Self { form: none.clone(), apart: none.clone(), common: none }
    }

    /// Returns that of linear functions (rows) of the parameters.
    fn mapped(&self, map: &DMatrix<f64>) -> Self {
        let mapped = |of: &DMatrix<f64>| map * of * map.transpose();
        Self { form: mapped(&self.form), apart: mapped(&self.apart), common: mapped(&self.common) }
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        self.form[(i, j)] + self.common[(i, j)]
    }
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
    /// The same of the model to first order in the errors: what only products of errors show does not count.
    pub rank_first_order: usize,
    /// Number of independent directions that the noise does not drown.
    pub well_determined: usize,
    /// Parameters without any effect.
    pub idle: Vec<String>,
    /// Null space in words: a sentence for each rank that is missing, first those on `idle`.
    pub null_space: Vec<String>,
    /// The same, of a few parts each.
    short: Vec<String>,
    /// Combinations that are determined in principle, but not with this noise, in words.
    pub drowned: Vec<String>,
    /// Singular values of the column-scaled Jacobian, falling.
    pub singular_values: Vec<f64>,
    /// Largest over smallest of those within the rank.
    pub condition: f64,
    /// Standard deviation of one reading of weight 1 (mm).
    pub sigma: f64,
    /// Readings minus rank.
    pub freedom: usize,
    /// Root of the covariance of the parameters as displacements over `units`, for readings of unit variance.
    root: DMatrix<f64>,
    /// Degrees of freedom that the scatter of each parameter rests on.
    freedoms: Vec<f64>,
    /// Directions (columns) in which these are free.
    hidden: DMatrix<f64>,
    units: DVector<f64>,
    /// Covariance of the parameters, in their units, beyond what the scatter of single readings makes.
    shared: SharedCovariance,
    /// Directions that change nothing, reduced, in displacements.
    null: Vec<DVector<f64>>,
    /// Directions (columns, by displacements) that the model to first order leaves free, if the exact one does not.
    products: Option<DMatrix<f64>>,
}

impl Solution {
    /// Examines a fit.
    pub fn of(fit: &Fit, parameters: &[Parameter]) -> Self {
        Self::without(fit, parameters, None)
    }

    /// Examines a fit, directions (columns, by displacements) left out that only products of errors show, if there are.
    fn without(fit: &Fit, parameters: &[Parameter], products: Option<&DMatrix<f64>>) -> Self {
        let sizes = DVector::from_iterator(parameters.len(), parameters.iter().map(|p| p.size));
        let norms = fit.reduced.column_norms();
        let (reduced, redundant) = informed(fit, &sizes);
        let reduced = products.map_or_else(|| reduced.clone(), |products| beyond(&reduced, &sizes, products));
        let scale = scale(&reduced, &sizes);
        let unit = reduced.scaled(&scale);
        let rank = products.map_or_else(|| unit.rank(RANK), |products| parameters.len() - products.ncols());
        // In full rank no direction has to be told from the others, and one decomposition will do.
        let full = rank == parameters.len();
        let sized = if full { None } else { Some(reduced.scaled(&sizes)) };
        let freedom = redundant.map_or(fit.reduced.rows.saturating_sub(rank), |rest| libm::round(rest) as usize);
        let sigma = libm::sqrt(fit.squares / redundant.unwrap_or(freedom as f64).max(1.0));
        let null = sized.as_ref().map_or_else(Vec::new, |sized| echelon(&sized.null_space(rank)));
        let (root, hidden) = match &sized {
            Some(sized) => (sized.root_covariance(rank), sized.null_space(rank)),
            None => (unit.root_covariance(rank), DMatrix::zeros(parameters.len(), 0)),
        };
        let units = if full { &scale } else { &sizes };
        // Standard uncertainties for readings of unit variance.
        let spread = |j: usize| root.row(j).norm() / units[j];
        let free = |j: usize| hidden.row(j).norm_squared() > LOST;
        let theta = at_rest(fit, &null, parameters);
        let readings = libm::sqrt(fit.reduced.rows.max(1) as f64);
        let freedoms: Vec<f64> =
            (0..parameters.len()).map(|j| fit.freedom.get(j).copied().unwrap_or(freedom as f64)).collect();
        let mut student = Coverage::default();
        let estimate = |(j, value): (usize, f64)| Estimate {
            value,
            sigma: (!free(j) && freedom > 0).then(|| spread(j) * sigma),
            scatter: (!free(j) && freedom > 0).then(|| spread(j) * sigma),
            form: 0.0,
            common: 0.0,
            coverage: (freedom > 0).then(|| student.reach(freedoms[j])),
            valuation: if free(j) || norms[j] == 0.0 { 0.0 } else { readings / (norms[j] * spread(j)) },
        };
        let estimates: Vec<Estimate> = theta.into_iter().enumerate().map(estimate).collect();
        let values = estimates.iter().zip(parameters).filter(|(e, p)| e.valuation > 0.0 && !p.is_nuisance());
        let valuation = values.map(|(e, _)| e.valuation).reduce(f64::min).unwrap_or(0.0);
        let well_determined = heard(&unit, rank, fit.reduced.rows);
        // One standard deviation along a direction, in units of displacement.
        let along = |k: usize| unit.v.column(k).component_mul(&sizes).component_div(&scale) * (sigma / unit.values[k]);
        let spreads: Vec<DVector<f64>> = (well_determined..rank).map(along).collect();
        let sentences = |most| null.iter().map(|row| inseparable(&named(row), parameters, most)).collect();
        let smallest = if rank > 0 { unit.values[rank - 1] } else { 0.0 };
        Self {
            estimates,
            valuation,
            rank,
            rank_first_order: rank,
            well_determined,
            idle: null.iter().map_while(|row| alone(row).map(|(j, _)| parameters[j].name.clone())).collect(),
            null_space: sentences(usize::MAX),
            short: sentences(MAX_LISTED),
            drowned: drowned(&spreads, &scale.component_div(&sizes), &null, parameters),
            condition: if smallest > 0.0 { unit.values[0] / smallest } else { f64::INFINITY },
            singular_values: unit.values.iter().copied().collect(),
            sigma,
            freedom,
            units: units.clone(),
            shared: SharedCovariance::none(parameters.len()),
            root,
            freedoms,
            hidden,
            null,
            products: products.cloned(),
        }
    }

    /// The same with covariances by what readings share: the form of the axes (all of it, and what predictions have of
    /// it beside the stated forms), and what is common to all.
    pub fn sharing(mut self, form: Option<[&DMatrix<f64>; 2]>, common: DMatrix<f64>) -> Self {
        let none = SharedCovariance::none(self.units.len());
        let [form, apart] = form.map_or([none.form, none.apart], |both| both.map(DMatrix::clone));
        self.shared = SharedCovariance { form, apart, common };
        self.combine();
        self
    }

    /// The same with what the readings share in another solution of the same linear problem, to which this one adds
    /// knowledge: that moves this one less.
    pub(super) fn sharing_with(mut self, other: &Self, fit: &Fit) -> Self {
        let seen = with_known(&fit.reduced, &fit.known, self.sigma).r;
        let root = self.unit_root();
        self.shared = other.shared.mapped(&(&root * (&seen * &root).tr_mul(&seen)));
        self.combine();
        self
    }

    fn combine(&mut self) {
        let mut student = Coverage::default();
        for (j, estimate) in self.estimates.iter_mut().enumerate() {
            let root = |part: &DMatrix<f64>| libm::sqrt(part[(j, j)].max(0.0));
            (estimate.form, estimate.common) = (root(&self.shared.form), root(&self.shared.common));
            let all = |scatter: f64| libm::sqrt(scatter * scatter + self.shared.of(j, j).max(0.0));
            estimate.sigma = estimate.scatter.map(all);
            // Only the scatter rests on few readings (Welch and Satterthwaite, JCGM 100:2008, G.4.1).
            let share = estimate.scatter.zip(estimate.sigma).filter(|(scatter, _)| *scatter > 0.0);
            let ratio = share.map_or(1.0, |(scatter, sigma)| sigma / scatter);
            let freedom = self.freedoms[j] * ratio * ratio * ratio * ratio;
            estimate.coverage = estimate.coverage.map(|_| student.reach(freedom));
        }
    }

    /// The same with the scatter so much wider that two standard uncertainties reach 95 % where few readings are to
    /// spare (Student); the unknowns of one error alike, for they may cancel.
    pub fn widened(mut self, parameters: &[Parameter]) -> Self {
        let mut student = Coverage::default();
        let sources = |p: &Parameter| p.terms.iter().map(|term| term.source).collect::<Vec<_>>();
        let all: Vec<Vec<Source>> = parameters.iter().map(sources).collect();
        for j in 0..self.root.nrows() {
            let alike = |i: &usize| {
                *i == j || all.get(j).zip(all.get(*i)).is_some_and(|(a, b)| a.iter().any(|s| b.contains(s)))
            };
            let freedom =
                (0..self.freedoms.len()).filter(alike).map(|i| self.freedoms[i]).fold(f64::INFINITY, f64::min);
            self.root.row_mut(j).scale_mut((0.5 * student.reach(freedom)).max(1.0));
        }
        self
    }

    /// Root of the covariance of the parameters, in their units, for independent readings of unit variance. What the
    /// data leave free has none.
    pub(super) fn unit_root(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.root.nrows(), self.root.ncols(), |j, k| self.root[(j, k)] / self.units[j])
    }

    /// Combined covariance of all parameters as displacements over `units`, for predictions beside the stated forms.
    fn combined(&self) -> DMatrix<f64> {
        let scatter = &self.root * self.root.transpose() * (self.sigma * self.sigma);
        let apart = &self.shared.apart + &self.shared.common;
        let shared = |i: usize, j: usize| apart[(i, j)] * self.units[i] * self.units[j];
        scatter + DMatrix::from_fn(self.units.len(), self.units.len(), shared)
    }

    /// Counts the rank of the model to first order at the same place, in which `motions` of the whole machine that no
    /// reading notices are free. Directions that only products of errors show are known to no use, and what
    /// they hardly touch would be as uncertain as they are: they count as free.
    pub fn compared(self, model: &Model<'_>, data: &[Measurement], fit: &Fit, motions: &[DVector<f64>]) -> Self {
        let parameters = model.parameters();
        let sizes = DVector::from_iterator(parameters.len(), parameters.iter().map(|p| p.size));
        let first = model.clone().to_order(Order::Degree(1)).triangle(data, &fit.weights, &fit.theta);
        let first = with_known(&first, &fit.known, self.sigma);
        let rank = first.scaled(&scale(&first, &sizes)).rank(RANK);
        let free = with_motions(&first.scaled(&sizes).null_space(rank), motions);
        if parameters.len() - free.ncols() >= self.rank {
            return self;
        }
        let less = Self::without(fit, parameters, Some(&free));
        let (rank, freedom, singular_values) = (self.rank, self.freedom, self.singular_values);
        let mut estimates = less.estimates.clone();
        estimates.iter_mut().zip(&self.estimates).for_each(|(estimate, before)| estimate.value = before.value);
        let mut less = Self { estimates, rank, freedom, singular_values, sigma: self.sigma, ..less };
        less.estimate(fit);
        less
    }

    /// Draws the uncertainties of the parameters from their covariance.
    fn estimate(&mut self, fit: &Fit) {
        let norms = fit.reduced.column_norms();
        let readings = libm::sqrt(fit.reduced.rows.max(1) as f64);
        for (j, estimate) in self.estimates.iter_mut().enumerate() {
            let is_free = self.hidden.row(j).norm_squared() > LOST;
            let spread = self.root.row(j).norm() / self.units[j];
            estimate.scatter = (!is_free && self.freedom > 0).then_some(spread * self.sigma);
            estimate.valuation =
                if is_free || norms[j] == 0.0 || spread == 0.0 { 0.0 } else { readings / (norms[j] * spread) };
        }
        self.combine();
    }

    /// Puts what is free into words.
    fn describe(&mut self, parameters: &[Parameter]) {
        self.idle = self.null.iter().map_while(|row| alone(row).map(|(j, _)| parameters[j].name.clone())).collect();
        let sentences = |most| self.null.iter().map(|row| inseparable(&named(row), parameters, most)).collect();
        (self.null_space, self.short) = (sentences(usize::MAX), sentences(MAX_LISTED));
        let values = self.estimates.iter().zip(parameters).filter(|(e, p)| e.valuation > 0.0 && !p.is_nuisance());
        self.valuation = values.map(|(e, _)| e.valuation).reduce(f64::min).unwrap_or(0.0);
    }

    /// Standard uncertainty of a sum of so much of each parameter; `None` if the data leave it free, or nothing
    /// scatters.
    pub fn uncertainty(&self, sum: &[(usize, f64)]) -> Option<f64> {
        let mut row = DVector::zeros(self.units.len());
        sum.iter().for_each(|(j, factor)| row[*j] += factor / self.units[*j]);
        let told = self.hidden.tr_mul(&row).norm_squared() <= LOST * row.norm_squared();
        let acting: Vec<usize> = (0..row.len()).filter(|j| row[*j] != 0.0).collect();
        let pairs = acting.iter().flat_map(|i| acting.iter().map(move |j| (*i, *j)));
        let amount = |j: usize| row[j] * self.units[j];
        let shared: f64 = pairs.map(|(i, j)| amount(i) * self.shared.of(i, j) * amount(j)).sum();
        let mut scatter = RowDVector::zeros(self.root.ncols());
        acting.iter().for_each(|j| scatter += self.root.row(*j) * (row[*j] * self.sigma));
        (told && self.freedom > 0).then(|| libm::sqrt((scatter.norm_squared() + shared).max(0.0)))
    }

    /// The same in another datum: values `theta`, of which those of a fit are linear functions (`map`), and directions
    /// that become fixed by it; with `near` among them such that readings notice a little of.
    pub(super) fn moved(
        mut self,
        (map, theta): (&DMatrix<f64>, &[f64]),
        (fit, parameters): (&Fit, &[Parameter]),
        near: bool,
    ) -> Self {
        let count = theta.len();
        // What only products of errors show is as good as unknown: a datum may fix it.
        let units = DVector::from_iterator(count, parameters.iter().map(|p| p.size));
        let reduced = informed(fit, &units).0;
        let reduced = self.products.as_ref().map_or_else(|| reduced.clone(), |of| beyond(&reduced, &units, of));
        let rank = self.rank_first_order;
        let seen = reduced.scaled(&units);
        self.hidden = seen.null_space(rank);
        self.root = seen.root_covariance(rank);
        self.units = units.clone();
        self.shared = self.shared.mapped(map);
        let map = DMatrix::from_fn(count, count, |i, j| map[(i, j)] * units[i] / units[j]);
        self.root = &map * &self.root;
        let svd = Svd::new(&(&map * &self.hidden).transpose());
        let kept = svd.values.iter().filter(|value| **value > FIXED).count();
        let fixed = self.hidden.ncols() - kept;
        let free = svd.v.columns(0, kept).into_owned();
        self.null = echelon(&free);
        self.hidden = free;
        self.rank_first_order += fixed;
        self.rank = self.rank.max(self.rank_first_order);
        self.estimates.iter_mut().zip(theta).for_each(|(estimate, value)| estimate.value = *value);
        self.estimate(fit);
        self.describe(parameters);
        if near {
            self.drown(&reduced, &map, (rank, parameters));
        }
        self
    }

    /// Names what the noise drowns of the parameters in a datum, of which those of the fit are linear functions (`map`,
    /// by displacements).
    fn drown(&mut self, reduced: &ReducedSystem, map: &DMatrix<f64>, (rank, parameters): (usize, &[Parameter])) {
        let sizes = &self.units;
        let (scale, count) = (scale(reduced, sizes), sizes.len());
        let sized = DMatrix::from_fn(reduced.r.nrows(), count, |i, j| reduced.r[(i, j)] / sizes[j]) * map;
        let r = DMatrix::from_fn(sized.nrows(), count, |i, j| sized[(i, j)] * sizes[j]);
        let unit = ReducedSystem { r, ..reduced.clone() }.scaled(&scale);
        let rank = unit.rank(RANK).min(rank);
        self.well_determined = heard(&unit, rank, reduced.rows);
        self.condition = if rank > 0 { unit.values[0] / unit.values[rank - 1] } else { f64::INFINITY };
        let along = |k: usize| {
            map * unit.v.column(k).component_mul(sizes).component_div(&scale) * (self.sigma / unit.values[k])
        };
        let spreads: Vec<DVector<f64>> = (self.well_determined..rank).map(along).collect();
        self.drowned = drowned(&spreads, &scale.component_div(sizes), &self.null, parameters);
    }

    /// Columns of a factor of the joint covariance of the first `count` parameters, in their units: independent parts,
    /// one standard uncertainty each, the largest first. Directions that the data leave free are not in it; nothing is
    /// without scatter.
    pub fn factor(&self, count: usize) -> Vec<Vec<f64>> {
        if self.freedom == 0 {
            return Vec::new();
        }
        let svd = Svd::new(&self.combined().view((0, 0), (count, count)).into_owned());
        let largest = svd.values.iter().copied().fold(0.0, f64::max);
        let told = svd.values.iter().take_while(|value| **value > TOLD * TOLD * largest).take(JointUncertainty::MOST);
        let column = |(k, value): (usize, &f64)| {
            let scale = value.sqrt();
            (0..count).map(|j| svd.v[(j, k)] * scale / self.units[j]).collect()
        };
        told.enumerate().map(column).collect()
    }

    /// Uncertainties of sums of the parameters, one for each row: covariances for readings that scatter as they do are
    /// those of `CV` with the rows. Returns `CV`, a column for each row, and what the free directions do to each row.
    pub(super) fn spread(&self, rows: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let mut scaled = rows.clone();
        scaled.column_iter_mut().zip(self.units.iter()).for_each(|(mut column, unit)| column /= *unit);
        let free = &scaled * &self.hidden;
        let half = self.combined() * scaled.transpose();
        let columns = DMatrix::from_fn(half.nrows(), half.ncols(), |j, i| half[(j, i)] / self.units[j]);
        (columns, free)
    }

    /// The direction that changes no reading but most of these rows, in words.
    pub(super) fn loudest(&self, rows: &DMatrix<f64>, parameters: &[Parameter]) -> Option<String> {
        let effect = |direction: &DVector<f64>| {
            let step = DVector::from_fn(direction.len(), |j, _| direction[j] / parameters[j].size);
            (rows * step).amax()
        };
        let louder = |a: (usize, f64), b: (usize, f64)| if b.1 > 1.0001 * a.1 { b } else { a };
        let (worst, _) = self.null.iter().map(effect).enumerate().reduce(louder)?;
        self.short.get(worst).cloned()
    }

    /// The least and the greatest number of standard uncertainties that 95 % intervals reach; `None` without scatter.
    pub fn coverage(&self) -> Option<(f64, f64)> {
        let reaches = self.estimates.iter().filter_map(|e| e.coverage).map(|reach| (reach, reach));
        reaches.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// What cannot be told apart, in sentences that can be read: those without effect in one, the others of a few
    /// parts.
    pub fn free(&self) -> Vec<String> {
        let idle: Vec<&str> = self.idle.iter().map(String::as_str).collect();
        let all = if idle.len() < 2 { None } else { Some(format!("{} have no effect on these data", list(&idle))) };
        let rest = self.short.iter().skip(if all.is_some() { idle.len() } else { 0 }).cloned();
        all.into_iter().chain(rest).collect()
    }

    /// Values of the parameters (mm, rad, degrees of position).
    pub fn theta(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }
}

/// Rows over their standard uncertainty beside readings that scatter by `sigma` (mm).
fn with_known(reduced: &ReducedSystem, known: &DMatrix<f64>, sigma: f64) -> ReducedSystem {
    if known.nrows() == 0 {
        return reduced.clone();
    }
    reduced.with_rows(&(known * sigma.max(MIN_SIGMA)), &DVector::zeros(known.nrows()))
}

/// The linear problem, blind to these directions (orthonormal columns, by displacements).
fn beyond(reduced: &ReducedSystem, sizes: &DVector<f64>, directions: &DMatrix<f64>) -> ReducedSystem {
    let (rows, count) = reduced.r.shape();
    let sized = DMatrix::from_fn(rows, count, |i, j| reduced.r[(i, j)] / sizes[j]);
    let blind = &sized - (&sized * directions) * directions.transpose();
    ReducedSystem { r: DMatrix::from_fn(rows, count, |i, j| blind[(i, j)] * sizes[j]), ..reduced.clone() }
}

/// Orthonormal directions and what motions add to them.
fn with_motions(free: &DMatrix<f64>, motions: &[DVector<f64>]) -> DMatrix<f64> {
    let mut all: Vec<DVector<f64>> = free.column_iter().map(|column| column.into_owned()).collect();
    for motion in motions {
        let rest = beside(motion.clone(), &all);
        if rest.norm() > ADDED * motion.norm() {
            all.push(rest.normalize());
        }
    }
    DMatrix::from_fn(free.nrows(), all.len(), |i, j| all[j][i])
}

/// The linear problem with what is known before the data, and how many readings the data have to spare then (Helmert):
/// `None` if nothing is known.
fn informed(fit: &Fit, sizes: &DVector<f64>) -> (ReducedSystem, Option<f64>) {
    if fit.known.nrows() == 0 {
        return (fit.reduced.clone(), None);
    }
    let rank = fit.reduced.scaled(sizes).rank(RANK);
    let mut redundant = fit.reduced.rows as f64 - rank as f64;
    let mut whole = fit.reduced.clone();
    for _ in 0..ROUNDS {
        let sigma = libm::sqrt(fit.squares / redundant.max(1.0));
        whole = with_known(&fit.reduced, &fit.known, sigma);
        let sized = whole.scaled(sizes);
        let mut own = fit.reduced.r.clone();
        own.column_iter_mut().zip(sizes.iter()).for_each(|(mut column, size)| column /= *size);
        let used = (&own * sized.root_covariance(sized.rank(RANK))).norm_squared();
        redundant = (fit.reduced.rows as f64 - used).max(0.0);
    }
    (whole, Some(redundant))
}

/// The scales of the columns of a linear problem, given the usual sizes of its unknowns.
fn scale(reduced: &ReducedSystem, sizes: &DVector<f64>) -> DVector<f64> {
    let norms = reduced.column_norms();
    let strongest = norms.component_div(sizes).iter().copied().fold(0.0, f64::max);
    DVector::from_fn(norms.len(), |j, _| norms[j].max(FAINT * strongest * sizes[j]))
}

/// Independent directions in which one standard deviation of the estimate moves the points, parameter by
/// parameter, less than the noise of a single reading does. It depends on where was measured, not on what.
fn heard(unit: &Svd, rank: usize, readings: usize) -> usize {
    let limit = 1.0 / (readings.max(1) as f64).sqrt();
    (0..rank).filter(|k| unit.values[*k] > limit).count()
}

/// The only parameter of a direction, and how much of it.
fn alone(row: &DVector<f64>) -> Option<(usize, f64)> {
    if let [only] = named(row)[..] { Some(only) } else { None }
}

/// Puts parameters that have no effect back to where they started: what is left of them is the bend of
/// the directions they hid in while the others moved.
fn at_rest(fit: &Fit, null: &[DVector<f64>], parameters: &[Parameter]) -> Vec<f64> {
    let mut theta = fit.theta.clone();
    for row in null {
        let Some((alone, amount)) = alone(row) else { continue };
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
