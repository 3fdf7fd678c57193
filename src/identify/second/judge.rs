//! Measured less predicted readings, judged without what the set-up explains.
//!
//! Everything is over the scatter of its reading. With A the effects of set-up and instruments, P their prior weights
//! and M = (A^T A + P)^-1 what is left of a vector x is Q x, Q = 1 - A M A^T = 1 - G G^T; the covariance of what is
//! left of the readings themselves is Q too. Predicted parts B and the type B of the readings S go through the same
//! projector: u^2 = diag(Q) + |Q B|^2 + |Q S|^2 (rows). V^-1 = Q - Q F (1 + F^T Q F)^-1 F^T Q with F = [B S] weighs the
//! amount of the correction.

use crate::algebra::linear::{ReducedSystem, over_columns};
use crate::analysis::budget::Normals;
use crate::analysis::spread_places;
use crate::identify::thresholds::*;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// An unknown of the second campaign: of an instrument, or of the set-up.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SetUpUnknown {
    pub name: String,
    /// Its unit for people, and how many of it a mm or rad is.
    pub unit: (&'static str, f64),
    /// Standard uncertainty (mm or rad) with which it is known to be as it starts; `None`: free.
    pub known: Option<f64>,
    pub start: f64,
}

/// The readings of a campaign (mm) and what moves them.
pub(super) struct Readings {
    /// Measured and predicted readings less nominal ones.
    pub measured: DVector<f64>,
    pub predicted: DVector<f64>,
    /// Effect of the set, and of what it adds to single axes.
    pub set: DVector<f64>,
    pub by_axis: Vec<(usize, DVector<f64>)>,
    /// One standard uncertainty each (columns).
    pub parts: DMatrix<f64>,
    pub shared: DMatrix<f64>,
    /// Effects of a unit of the unknowns of the set-up and the instruments (columns).
    pub set_up: DMatrix<f64>,
    pub unknowns: Vec<SetUpUnknown>,
    /// Distance of the place where they are linear from where they start.
    pub away: DVector<f64>,
    /// Standard deviation of every reading.
    pub sigma: DVector<f64>,
}

/// Something over the scatter of its readings, and what is left of it without what the set-up explains.
pub(super) struct Projected<T> {
    whole: T,
    pub left: T,
}

/// The readings over their scatter, without what the set-up explains.
pub(super) struct Reduced {
    pub readings: Readings,
    /// Motions of the set-up and the instruments by the readings (mm, rad).
    pub step: DVector<f64>,
    /// A M^(1/2), by column: G.
    root: DMatrix<f64>,
    /// Predicted less nominal, and measured less predicted readings.
    pub predicted: DVector<f64>,
    residual: Projected<DVector<f64>>,
    pub parts: Projected<DMatrix<f64>>,
    pub shared: Projected<DMatrix<f64>>,
    set: Projected<DVector<f64>>,
    by_axis: Vec<(usize, Projected<DVector<f64>>)>,
    /// Variance of the readings themselves: diag(Q).
    pub own: DVector<f64>,
}

/// The amount of a correction that the readings see: 1 as predicted, 0 none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Amount {
    pub value: f64,
    /// Standard uncertainty.
    pub sigma: f64,
}

impl Amount {
    /// True if the readings agree with this amount.
    pub fn allows(&self, amount: f64) -> bool {
        (self.value - amount).abs() <= (MAX_AMOUNT_DEVIATIONS * self.sigma).max(MAX_AMOUNT_OFF)
    }
}

/// The judgement of a campaign.
pub(super) struct Judged {
    /// E_n of every reading; `None` where it holds nothing but the set-up.
    pub e_n: Vec<Option<f64>>,
    /// Share of |E_n| <= 1, and the least that chance explains.
    pub within: f64,
    pub least: f64,
    /// Amount of the whole set, and of its additions to single axes; `None` if it does nothing to the readings.
    pub amount: Option<Amount>,
    pub by_axis: Vec<(usize, Amount)>,
    /// An amount that explains the readings, where the predicted one does not.
    pub instead: Option<f64>,
}

impl Reduced {
    pub fn new(readings: Readings) -> Self {
        let Readings { set_up, sigma, unknowns, away, .. } = &readings;
        let left = &readings.measured - &readings.predicted;
        let (root, step) = Self::least_squares(set_up, &left, sigma, unknowns, away);
        let project = |x: &DMatrix<f64>| {
            let whole = over_rows(x, sigma);
            Projected { left: &whole - &root * root.tr_mul(&whole), whole }
        };
        let one = |x: &DVector<f64>| {
            let whole = x.component_div(sigma);
            Projected { left: &whole - &root * root.tr_mul(&whole), whole }
        };
        // What is known of instruments beforehand pulls them from where the readings put them.
        let pull = |j: usize| if unknowns[j].known.is_some() { away[j] } else { 0.0 };
        let residual = one(&(left + set_up * DVector::from_fn(away.len(), |j, _| pull(j))));
        let by_axis = readings.by_axis.iter().map(|(axis, effect)| (*axis, one(effect))).collect();
        let own = DVector::from_fn(sigma.len(), |i, _| (1.0 - root.row(i).norm_squared()).max(0.0));
        let (predicted, set) = (one(&readings.predicted).left, one(&readings.set));
        let (parts, shared) = (project(&readings.parts), project(&readings.shared));
        Self { predicted, residual, parts, shared, set, by_axis, own, root, step, readings }
    }

    /// Returns measured less predicted readings.
    pub fn residual(&self) -> &DVector<f64> {
        &self.residual.left
    }

    /// Fits unknowns to what is left of readings. Returns the root of their part in the readings, and their step.
    pub fn least_squares(
        effects: &DMatrix<f64>,
        left: &DVector<f64>,
        sigma: &DVector<f64>,
        unknowns: &[SetUpUnknown],
        away: &DVector<f64>,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (rows, count) = (effects.nrows(), effects.ncols());
        let over = over_rows(effects, sigma);
        let weight = |j: usize| unknowns[j].known.map_or(0.0, |known| 1.0 / known);
        let all = DMatrix::from_fn(rows + count, count, |i, j| match i.checked_sub(rows) {
            None => over[(i, j)],
            Some(k) if k == j => weight(j),
            Some(_) => 0.0,
        });
        let right = DVector::from_fn(rows + count, |i, _| match i.checked_sub(rows) {
            None => left[i] / sigma[i],
            Some(j) => -away[j] * weight(j),
        });
        let system = ReducedSystem::of(&all, &right);
        let scale = system.column_norms().map(|norm| if norm > 0.0 { norm } else { 1.0 });
        let svd = system.scaled(&scale);
        let rank = svd.rank(RANK_TOLERANCE);
        let step = svd.solve(&system.right, rank).component_div(&scale);
        (over_columns(&over, &scale) * svd.root_covariance(rank), step)
    }

    /// Returns the standard uncertainty of what is left of each reading, by the readings and by the prediction, over
    /// its scatter.
    pub fn uncertainties(&self, i: usize) -> [f64; 2] {
        let of_readings = self.own[i] + self.shared.left.row(i).norm_squared();
        [libm::sqrt(of_readings), self.parts.left.row(i).norm()]
    }

    fn scores(&self, residual: &DVector<f64>) -> Vec<Option<f64>> {
        let score = |i: usize| {
            let [a, b] = self.uncertainties(i);
            (self.own[i] > MIN_JUDGED_SHARE).then(|| residual[i] / (2.0 * libm::hypot(a, b)))
        };
        (0..residual.len()).map(score).collect()
    }

    /// Returns the share of |E_n| <= 1 that five of a thousand good campaigns do not reach.
    fn least_share(&self, seed: u64) -> f64 {
        let judged: Vec<usize> = (0..self.own.len()).filter(|i| self.own[*i] > MIN_JUDGED_SHARE).collect();
        let places = spread_places(judged.len(), SECOND_DRAWN_READINGS, &[]);
        let places: Vec<usize> = places.into_iter().map(|k| judged[k]).collect();
        let all: Vec<[f64; 2]> = (0..self.own.len()).map(|i| self.uncertainties(i)).collect();
        let one = |sample: usize| {
            let mut normals = Normals::new(seed, sample as u64);
            let mut draw = |count: usize| DVector::from_fn(count, |_, _| normals.next());
            let noise = draw(self.own.len());
            let (amounts, shared) = (draw(self.parts.left.ncols()), draw(self.shared.left.ncols()));
            let absorbed = self.root.tr_mul(&noise);
            let within = places.iter().filter(|i| {
                let row = |of: &DMatrix<f64>, by: &DVector<f64>| of.row(**i).tr_dot(by);
                let drawn = noise[**i] - row(&self.root, &absorbed);
                let drawn = drawn + row(&self.parts.left, &amounts) + row(&self.shared.left, &shared);
                drawn.abs() <= 2.0 * libm::hypot(all[**i][0], all[**i][1])
            });
            within.count() as f64 / places.len().max(1) as f64
        };
        let mut shares: Vec<f64> = (0..SECOND_DRAWS).into_par_iter().map(one).collect();
        shares.sort_unstable_by(f64::total_cmp);
        shares[SECOND_OUTSIDE]
    }
}

/// The inverse covariance of all readings, set-up and prediction in it.
struct Weight {
    /// Remainder of the effects that readings share.
    effects: DMatrix<f64>,
    inner: Option<Cholesky<f64, Dyn>>,
}

impl Weight {
    fn new(of: &Reduced) -> Self {
        let beside = |a: &DMatrix<f64>, b: &DMatrix<f64>| {
            let columns: Vec<_> = a.column_iter().chain(b.column_iter()).map(|column| column.into_owned()).collect();
            if columns.is_empty() { DMatrix::zeros(a.nrows(), 0) } else { DMatrix::from_columns(&columns) }
        };
        let whole = beside(&of.parts.whole, &of.shared.whole);
        let effects = beside(&of.parts.left, &of.shared.left);
        let inner = Cholesky::new(DMatrix::identity(whole.ncols(), whole.ncols()) + whole.tr_mul(&effects));
        Self { effects, inner }
    }

    /// Returns the weighed form of something, such as the effect of a set.
    fn times(&self, x: &Projected<DVector<f64>>) -> DVector<f64> {
        let through = self.effects.tr_mul(&x.whole);
        let solved = self.inner.as_ref().map_or_else(|| through.clone(), |inner| inner.solve(&through));
        &x.left - &self.effects * solved
    }

    /// Returns the amounts of effects that are in the readings, fitted together; `None` if they do nothing to them.
    fn amounts(&self, effects: &[&Projected<DVector<f64>>], residual: &DVector<f64>) -> Option<Vec<Amount>> {
        let weighed: Vec<DVector<f64>> = effects.iter().map(|effect| self.times(effect)).collect();
        let entry = |i: usize, j: usize| weighed[i].dot(&effects[j].whole) + if i == j { NO_INFORMATION } else { 0.0 };
        let inverse = Cholesky::new(DMatrix::from_fn(effects.len(), effects.len(), entry))?.inverse();
        let seen = &inverse * DVector::from_fn(effects.len(), |i, _| weighed[i].dot(residual));
        let amount = |i: usize| Amount { value: 1.0 + seen[i], sigma: libm::sqrt(inverse[(i, i)]) };
        Some((0..effects.len()).map(amount).collect())
    }
}

/// Judges a campaign; `seed` is that of the draws.
pub(super) fn judge(of: &Reduced, seed: u64) -> Judged {
    let weight = Weight::new(of);
    let residual = &of.residual.whole;
    let acts = |amount: &Amount| MAX_AMOUNT_DEVIATIONS * amount.sigma < LARGEST_AMOUNT;
    let amount = weight.amounts(&[&of.set], residual).and_then(|list| list.first().copied()).filter(acts);
    let effects: Vec<&Projected<DVector<f64>>> = of.by_axis.iter().map(|(_, effect)| effect).collect();
    let by_axis = weight.amounts(&effects, residual).unwrap_or_default();
    let by_axis = of.by_axis.iter().map(|(axis, _)| *axis).zip(by_axis).filter(|(_, amount)| acts(amount)).collect();
    let e_n = of.scores(of.residual());
    let (within, least) = (share(&e_n), of.least_share(seed));
    let explains = |instead: &f64| {
        let sure = |amount: &Amount| amount.sigma <= MAX_NAMED_UNCERTAINTY && amount.allows(*instead);
        let left = of.residual() - &of.set.left * (*instead - 1.0);
        amount.as_ref().is_some_and(sure) && share(&of.scores(&left)) >= least
    };
    let refused = within < least || amount.as_ref().is_some_and(|amount| !amount.allows(1.0));
    let instead = [0.0, -1.0, 0.5].into_iter().find(explains).filter(|_| refused);
    Judged { e_n, within, least, amount, by_axis, instead }
}

fn share(e_n: &[Option<f64>]) -> f64 {
    let judged = e_n.iter().flatten().count();
    e_n.iter().flatten().filter(|e_n| e_n.abs() <= 1.0).count() as f64 / judged.max(1) as f64
}

fn over_rows(x: &DMatrix<f64>, sigma: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] / sigma[i])
}
