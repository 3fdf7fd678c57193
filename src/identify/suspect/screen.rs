//! A sample of the readings, linear in the unknowns, on which many changes are tried in little time.
//!
//! The likelihood of a change is that of normal readings, each quantity and component with a standard deviation of its
//! own: noisier readings of one component are no other unit. Factors of readings count with their logarithm (the
//! density of the readings as they are), freed amounts as in Schwarz's criterion (BIC 1978).

use super::change::{posed, revalued};
use crate::identify::data::change::{Change, is_reachable};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::lists::index_of;
use crate::identify::model::{FitModel, Parameter, sizes};
use crate::identify::thresholds::*;
use crate::lower::{ErrorSite, Source};
use crate::machine::Direction;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};
use rayon::prelude::*;

/// A fit of which the readings are examined.
pub(super) struct Screen<'a> {
    pub model: &'a FitModel<'a>,
    pub data: &'a [Measurement],
    /// The rows of the sample.
    pub rows: Vec<usize>,
    theta: Vec<f64>,
    sizes: DVector<f64>,
    /// Normal equation of the knowledge before the data.
    prior: (DMatrix<f64>, DVector<f64>),
    /// Standard deviation of a reading of the data as they are (mm).
    sigma: f64,
    /// Quantities and components.
    groups: Vec<(ReadingKind, usize)>,
}

/// The linear problem of changed poses.
pub(super) struct Posed {
    /// Rows of the data, and as they are with these poses.
    pub rows: Vec<(usize, Measurement)>,
    /// Index in `rows`, component, group and root of the weight, of each reading.
    at: Vec<(usize, usize, usize, f64)>,
    /// Coefficients of displacements.
    columns: DMatrix<f64>,
    residual: DVector<f64>,
    /// Reading of each row without errors.
    bases: Vec<f64>,
    factor: Cholesky<f64, Dyn>,
}

/// The fit of a change.
pub(super) struct Judged {
    /// Logarithm of the likelihood, less what is charged.
    pub likelihood: f64,
    /// RMS of what is left, by rows (mm).
    pub left: f64,
    residual: DVector<f64>,
    /// Standard deviation of each quantity and component (mm).
    pub sigmas: Vec<f64>,
}

impl<'a> Screen<'a> {
    /// Prepares a fit with these values of the unknowns of instruments; `None` where nothing can be told.
    pub fn new(model: &'a FitModel<'a>, data: &'a [Measurement], theta: &[f64], sigma: f64) -> Option<Self> {
        let parameters = model.parameters();
        let own = |j: usize| if j < model.own() { parameters[j].start } else { theta[j] };
        let theta: Vec<f64> = (0..parameters.len()).map(own).collect();
        let most = MAX_SCREENED_ROWS.max(SCREENED_ROWS_PER_UNKNOWN * parameters.len());
        // By the golden section: even, and in step with no pattern.
        let share = most as f64 / data.len().max(1) as f64;
        let taken = |i: &usize| data.len() <= most || (*i as f64 * 0.618_033_988_749_895).fract() < share;
        let rows: Vec<usize> = (0..data.len()).filter(taken).collect();
        let sizes = sizes(parameters);
        let prior = prior(model, &theta, &sizes);
        let mut groups = Vec::new();
        for row in &rows {
            let m = &data[*row];
            (0..3).filter(|k| m.reading_mask()[*k]).for_each(|k| {
                let _ = index_of(&mut groups, (m.kind(), k));
            });
        }
        Some(Self { model, data, rows, theta, sizes, prior, sigma, groups })
    }

    /// Returns the linear problem with changed poses; `None` if the machine cannot take them.
    pub fn posed(&self, changes: &[Change]) -> Option<Posed> {
        let machine = &self.model.machines()[0];
        let moved = |row: &usize| Some((*row, posed(changes, self.model, self.data, *row)?));
        let rows: Vec<(usize, Measurement)> = self.rows.iter().filter_map(moved).collect();
        let beyond =
            |(row, m): &(usize, Measurement)| !is_reachable(machine, m) && is_reachable(machine, &self.data[*row]);
        if rows.len() * 20 < self.rows.len() * 19 || rows.iter().any(beyond) {
            return None;
        }
        let lines: Vec<(Vec<Vector3<f64>>, Vector3<f64>)> =
            rows.par_iter().map(|(_, m)| self.model.rows(m, &self.theta)).collect();
        let mut at = Vec::new();
        for (i, (_, m)) in rows.iter().enumerate() {
            let mask = m.reading_mask();
            for k in (0..3).filter(|k| mask[*k]) {
                let group = self.groups.iter().position(|group| *group == (m.kind(), k)).unwrap_or(0);
                at.push((i, k, group, libm::sqrt(m.weight)));
            }
        }
        let entry = |n: usize, j: usize| {
            let (i, k, _, root) = at[n];
            lines[i].0[j][k] * root / self.sizes[j]
        };
        let columns = DMatrix::from_fn(at.len(), self.sizes.len(), entry);
        let residual = DVector::from_iterator(at.len(), at.iter().map(|(i, k, _, root)| lines[*i].1[*k] * root));
        let bases = rows.iter().map(|(_, m)| self.model.prediction(m, &self.theta).x).collect();
        let normal = columns.tr_mul(&columns) + &self.prior.0 * (self.sigma * self.sigma);
        Some(Posed { rows, at, residual, bases, factor: normal.cholesky()?, columns })
    }

    /// Returns the residual of changed readings before the fit, and the sum of the logarithms of the factors.
    fn changed(&self, problem: &Posed, changes: &[Change]) -> (DVector<f64>, f64) {
        let mut logs = 0.0;
        let mut new = Vec::with_capacity(problem.rows.len());
        for ((_, m), base) in problem.rows.iter().zip(&problem.bases) {
            let (values, log) = revalued(changes, self.model, m, *base);
            logs += log;
            new.push(values - m.values());
        }
        let residual =
            problem.at.iter().zip(problem.residual.iter()).map(|((i, k, _, root), r)| r + new[*i][*k] * root);
        (DVector::from_iterator(problem.at.len(), residual), logs)
    }

    /// Returns the likelihood of changed readings that scatter alike: a first look.
    pub fn glance(&self, problem: &Posed, changes: &[Change]) -> f64 {
        let (residual, logs) = self.changed(problem, changes);
        let force = problem.columns.tr_mul(&residual) + &self.prior.1 * (self.sigma * self.sigma);
        let squares = (&residual - &problem.columns * problem.factor.solve(&force)).norm_squared();
        let n = residual.len() as f64;
        self.scaled(logs - 0.5 * n * libm::log((squares / n).max(MIN_SUSPECT_MM * MIN_SUSPECT_MM)), problem)
    }

    /// Rows that a lag loses count as the others do.
    fn scaled(&self, likelihood: f64, problem: &Posed) -> f64 {
        likelihood * self.rows.len() as f64 / problem.rows.len() as f64
    }

    /// Returns the likelihood of changes.
    pub fn judge(&self, problem: &Posed, changes: &[Change]) -> Option<Judged> {
        let (residual, logs) = self.changed(problem, changes);
        let freed = self.freed(problem, changes);
        let left_out: Vec<bool> = problem.rows.iter().map(|(row, m)| is_left_out(changes, *row, m)).collect();
        let out: Vec<bool> = problem.at.iter().map(|at| left_out[at.0]).collect();
        let (p, q) = (self.sizes.len(), freed.ncols());
        let mut sigmas = vec![self.sigma; self.groups.len()];
        let kept = out.iter().filter(|out| !**out).count() as f64;
        let freedom = kept - (p + q) as f64;
        if freedom < MIN_SUSPECT_FREEDOM {
            return None;
        }
        let mut all = DMatrix::zeros(residual.len(), p + q);
        all.columns_mut(0, p).copy_from(&problem.columns);
        all.columns_mut(p, q).copy_from(&freed);
        let mut left = residual.clone();
        for _ in 0..SUSPECT_WEIGHTINGS {
            let weight = |n: usize| if out[n] { 0.0 } else { 1.0 / sigmas[problem.at[n].2] };
            let mut rows = all.clone();
            rows.row_iter_mut().enumerate().for_each(|(n, mut row)| row *= weight(n));
            let right = DVector::from_fn(residual.len(), |n, _| residual[n] * weight(n));
            let mut normal = rows.tr_mul(&rows);
            let mut force = rows.tr_mul(&right);
            let mut known = normal.view_mut((0, 0), (p, p));
            known += &self.prior.0;
            (p..p + q).for_each(|j| normal[(j, j)] += 1e-9 + 1e-12 * normal[(j, j)]);
            force.rows_mut(0, p).axpy(1.0, &self.prior.1, 1.0);
            left = &residual - &all * normal.cholesky()?.solve(&force);
            sigmas = self.sigmas(problem, &left, &out, freedom / kept);
        }
        let mut likelihood = logs - 0.5 * q as f64 * libm::log(kept);
        let (mut squares, mut outside) = (0.0, (0.0, 0.0));
        for (n, at) in problem.at.iter().enumerate() {
            let square = left[n] * left[n];
            if out[n] {
                outside = (outside.0 + 1.0, outside.1 + square);
            } else {
                squares += square / (at.3 * at.3);
                likelihood -= libm::log(sigmas[at.2]);
            }
        }
        if outside.0 > 0.0 {
            likelihood -= outside.0 * 0.5 * libm::log(outside.1 / outside.0);
        }
        likelihood -= changes.iter().map(|change| charge(change, problem.rows.len())).sum::<f64>();
        let rows = left_out.iter().filter(|out| !**out).count();
        let left_mm = libm::sqrt(squares / rows.max(1) as f64);
        Some(Judged { likelihood: self.scaled(likelihood, problem), left: left_mm, residual: left, sigmas })
    }

    /// Returns the standard deviation of each group, drawn a little to that of all: a group that is fitted exactly
    /// would have none.
    fn sigmas(&self, problem: &Posed, left: &DVector<f64>, out: &[bool], share: f64) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.groups.len()];
        for (n, at) in problem.at.iter().enumerate().filter(|(n, _)| !out[*n]) {
            sums[at.2] = (sums[at.2].0 + 1.0, sums[at.2].1 + left[n] * left[n]);
        }
        let (count, squares) = sums.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        let (all, pull) = (squares / count, SUSPECT_PULL * count);
        let sigma = |(n, own): &(f64, f64)| libm::sqrt((own + pull * all) / (n + pull) / share).max(MIN_SUSPECT_MM);
        sums.iter().map(sigma).collect()
    }

    /// Returns the columns of what is freed: drifts, shifts.
    fn freed(&self, problem: &Posed, changes: &[Change]) -> DMatrix<f64> {
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let count = self.data.len().max(2) as f64;
        let time = |n: usize| 2.0 * problem.rows[problem.at[n].0].0 as f64 / (count - 1.0) - 1.0;
        let all = 0..problem.at.len();
        for change in changes {
            match change {
                Change::Shifted(scope) => {
                    for group in 0..self.groups.len() {
                        let one = |n: usize| {
                            let (i, _, of, root) = problem.at[n];
                            if of == group && scope.holds(&problem.rows[i].1) { root } else { 0.0 }
                        };
                        columns.push(all.clone().map(one).collect());
                    }
                }
                Change::Drift(false) => {
                    for (group, power) in (0..self.groups.len()).flat_map(|g| (1..=DRIFT_POWERS).map(move |k| (g, k))) {
                        let one = |n: usize| {
                            let (_, _, of, root) = problem.at[n];
                            if of == group { root * libm::pow(time(n), f64::from(power)) } else { 0.0 }
                        };
                        columns.push(all.clone().map(one).collect());
                    }
                }
                Change::Drift(true) => {
                    let moved = self.tool_effects(problem);
                    for (column, power) in moved.column_iter().flat_map(|c| (1..=DRIFT_POWERS).map(move |k| (c, k))) {
                        let one = |n: usize| column[n] * libm::pow(time(n), f64::from(power));
                        columns.push(all.clone().map(one).collect());
                    }
                }
                Change::OtherTool(tool) => {
                    let is_of = |n: usize| problem.rows[problem.at[n].0].1.tool == *tool;
                    for column in self.tool_effects(problem).column_iter() {
                        let one = |n: usize| if is_of(n) { column[n] } else { 0.0 };
                        columns.push(all.clone().map(one).collect());
                    }
                }
                _ => {}
            }
        }
        columns.retain(|column| column.iter().any(|x| *x != 0.0));
        DMatrix::from_fn(problem.at.len(), columns.len(), |n, j| columns[j][n])
    }

    /// Returns what displacements of the tool do to the readings, a column each.
    fn tool_effects(&self, problem: &Posed) -> DMatrix<f64> {
        self.effects(problem, &[0, 1, 2].map(|k| Source { place: ErrorSite::Tool, direction: Direction::ALL[k] }))
    }

    /// Returns what units of errors do to the readings, a column each.
    pub fn effects(&self, problem: &Posed, sources: &[Source]) -> DMatrix<f64> {
        let machine = &self.model.machines()[0];
        let one = |(j, source): (usize, &Source)| {
            Parameter::single(machine, format!("{j}"), *source, crate::identify::BasisFunction::Constant, 0.0)
        };
        let instruments = &self.model.parameters()[self.model.own()..];
        let list: Vec<Parameter> = sources.iter().enumerate().map(one).chain(instruments.iter().cloned()).collect();
        let model = self.model.with_parameters(&list);
        let mut theta = vec![0.0; sources.len()];
        theta.extend_from_slice(&self.theta[self.model.own()..]);
        let lines: Vec<Vec<Vector3<f64>>> = problem.rows.par_iter().map(|(_, m)| model.rows(m, &theta).0).collect();
        DMatrix::from_fn(problem.at.len(), sources.len(), |n, j| {
            let (i, k, _, root) = problem.at[n];
            lines[i][j][k] * root
        })
    }

    /// Returns the gain in likelihood by forms of all axes: curves of each error, of a common size, that no fit takes
    /// up. `None` where they cannot be told.
    pub fn gain_by_form(&self, problem: &Posed) -> Option<f64> {
        let machine = &self.model.machines()[0];
        let axes = machine.axes().len();
        let place = |axis: usize| move |d: &Direction| Source { place: ErrorSite::Component(axis), direction: *d };
        let sources: Vec<Source> = (0..axes).flat_map(|axis| Direction::ALL.iter().map(place(axis))).collect();
        let effects = self.effects(problem, &sources);
        let ends = |axis: usize| {
            let all = problem.rows.iter().map(|(_, m)| m.pose[axis]);
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| (a.min(q), b.max(q)))
        };
        let ends: Vec<(f64, f64)> = (0..axes).map(ends).collect();
        let mut forms = DMatrix::zeros(problem.at.len(), sources.len() * SUSPECT_FORM_WAVES);
        for (s, source) in sources.iter().enumerate() {
            let axis = s / Direction::ALL.len();
            let (low, high) = ends[axis];
            let size = if source.direction.is_rotation() { SUSPECT_FORM_TILT } else { 1.0 };
            for k in 0..SUSPECT_FORM_WAVES {
                for n in 0..problem.at.len() {
                    let q = problem.rows[problem.at[n].0].1.pose[axis];
                    let part = if high > low { (q - low) / (high - low) } else { 0.0 };
                    let wave = libm::cos(std::f64::consts::PI * (k + 1) as f64 * part);
                    forms[(n, s * SUSPECT_FORM_WAVES + k)] = effects[(n, s)] * size * wave;
                }
            }
        }
        self.evidence(problem, &forms)
    }

    /// Returns the gain in marginal likelihood by these columns, the best over their common size.
    fn evidence(&self, problem: &Posed, forms: &DMatrix<f64>) -> Option<f64> {
        let (p, q, n) = (self.sizes.len(), forms.ncols(), problem.at.len());
        let mut all = problem.columns.clone().resize_horizontally(p + q, 0.0);
        all.columns_mut(p, q).copy_from(forms);
        let (normal, force) = (all.tr_mul(&all), all.tr_mul(&problem.residual));
        let squares = problem.residual.norm_squared();
        let log_det =
            |factor: &Cholesky<f64, Dyn>| 2.0 * factor.l_dirty().diagonal().iter().map(|x| libm::log(*x)).sum::<f64>();
        let own = squares - problem.factor.solve(&force.rows(0, p).into_owned()).dot(&force.rows(0, p));
        let freedom = n.checked_sub(p)? as f64;
        let mut best = 0.0_f64;
        for ratio in SUSPECT_FORM_SIZES {
            let mut with = normal.clone();
            let mut known = with.view_mut((0, 0), (p, p));
            known += &self.prior.0 * (self.sigma * self.sigma);
            (p..p + q).for_each(|j| with[(j, j)] += 1.0 / (ratio * ratio));
            let factor = with.cholesky()?;
            let rest = squares - factor.solve(&force).dot(&force);
            let price = log_det(&factor) - log_det(&problem.factor) + 2.0 * q as f64 * libm::log(ratio);
            best = best.max(0.5 * freedom * libm::log(own / rest.max(1e-12 * own)) - 0.5 * price);
        }
        Some(best)
    }

    /// Returns single rows far off, one after the other; `None` without any, or where they are many.
    pub fn outlying(&self, problem: &Posed, changes: &[Change]) -> Option<Change> {
        let most = MIN_SUSPECT_ROWS.max((MAX_SUSPECT_ROW_SHARE * problem.rows.len() as f64) as usize);
        let mut rows: Vec<usize> = Vec::new();
        loop {
            let with = [changes, &[Change::RowsLeftOut(rows.clone())]].concat();
            let judged = self.judge(problem, &with)?;
            let mut sizes = vec![(0.0_f64, 0); problem.rows.len()];
            for (n, at) in problem.at.iter().enumerate() {
                sizes[at.0].0 = sizes[at.0].0.max((judged.residual[n] / judged.sigmas[at.2]).abs());
                sizes[at.0].1 = problem.rows[at.0].0;
            }
            let farthest =
                sizes.into_iter().filter(|(_, row)| !rows.contains(row)).max_by(|a, b| a.0.total_cmp(&b.0))?;
            if farthest.0 < MIN_SUSPECT_ROW_SIGMA {
                rows.sort_unstable();
                return (!rows.is_empty()).then_some(Change::RowsLeftOut(rows));
            }
            rows.push(farthest.1);
            if rows.len() > most {
                return None;
            }
        }
    }
}

/// Returns the logarithm of the odds against a change before the data.
fn charge(change: &Change, rows: usize) -> f64 {
    match change {
        Change::RowsLeftOut(list) => list.len() as f64 * libm::log(rows as f64),
        _ => SUSPECT_CHARGE,
    }
}

/// True if changes leave a row out.
pub(super) fn is_left_out(changes: &[Change], row: usize, m: &Measurement) -> bool {
    changes.iter().any(|change| match change {
        Change::LeftOut(scope) => scope.holds(m),
        Change::RowsLeftOut(rows) => rows.contains(&row),
        _ => false,
    })
}

/// Returns what is known before the data as a normal equation of displacements: known values, bounds of slopes, and
/// that errors are no larger than a machine's.
fn prior(model: &FitModel<'_>, theta: &[f64], sizes: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let (known, values) = model.known_rows(theta);
    let theta = DVector::from_column_slice(theta);
    let count = sizes.len();
    let mut normal = DMatrix::zeros(count, count);
    let mut force = DVector::zeros(count);
    for (rows, values) in [(&known, values), (model.slope_rows(), DVector::zeros(model.slope_rows().nrows()))] {
        let missing = values - rows * &theta;
        let scaled = DMatrix::from_fn(rows.nrows(), count, |i, j| rows[(i, j)] / sizes[j]);
        normal += scaled.tr_mul(&scaled);
        force += scaled.tr_mul(&missing);
    }
    for j in 0..count {
        normal[(j, j)] += 1.0 / (SUSPECT_PRIOR_MM * SUSPECT_PRIOR_MM);
    }
    (normal, force)
}
