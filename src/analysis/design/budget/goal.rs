//! The cheapest tolerances with which the 95 % value of the drawn machines is a goal.
//!
//! The cost is a sum of weight / tolerance^power, or of weight * present / tolerance, which is convex. The error of
//! each drawn machine is convex in the tolerances too (a largest length of sums), and so is the mean of the worst tenth
//! of the machines, which stands for the 95 % value while the tolerances are sought: their ratio is taken from the same
//! machines. At the optimum of a free tolerance power times its cost is in proportion to its part of the 95 % value
//! (Karush, Kuhn, Tucker).
//!
//! A step: the parts of the worst tenth give a model in which the square of the value is a sum of squares, one for
//! each tolerance. Its optimum between the limits is found by bisection of the multiplier. With a sum of squares one
//! step would do; here a few tens are made at most, and the same machines are taken in each, so that the result is the
//! same on every run; they are drawn once, with tolerances of 1, and kept as far as memory allows.
//!
//! The tolerances fit the machines by which they are sought better than others. Hence the goal of the search is
//! corrected until other machines keep it, and a third set of machines proves it. The search aims below the goal by
//! the sampling error of a default run, so that the upper end of the interval of such a run is within the goal, too.

use super::bounds::Bound;
use super::cost::Price;
use super::draw::Draws;
use super::kernel::{BudgetPose, JointBounds, SAMPLE_LANES, SampleChunk, by_joint_without};
use super::monte_carlo::{self, DrawnMachine, Statistic};
use super::quantile::{Percentile, TAIL, rank, ranks};
use super::staying::StayingErrors;
use crate::analysis::reference::PartReference;
use crate::evaluate::Field;
use crate::lower::Quantity;
use crate::machine::{Machine, Pose};
use crate::run::unheard;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Maximum number of steps for one goal.
const MAX_STEPS: usize = 15;

/// After so many steps only half of a step is made.
const FULL_STEPS: usize = 5;

/// The search ends when no tolerance changes by more than this fraction.
const SETTLED: f64 = 5e-3;

/// Maximum number of corrections of the goal.
const MAX_CORRECTIONS: usize = 5;

/// The goal is corrected until other machines keep it but for this fraction.
const KEPT: f64 = 1e-3;

/// Smallest part of a tolerance in the value: smaller ones are lost in the noise of the machines drawn.
const MIN_PART: f64 = 1e-5;

/// The last corrections end below the goal by a millionth, which rounding cannot turn.
const BELOW: f64 = 1.0 - 1e-6;

/// Maximum memory for the machines of one generator that are kept.
const KEPT_BYTES: usize = 64 << 20;

/// Number of machines by which the goal is corrected.
const CORRECTING: usize = 20_000;

/// The fraction of the machines by which tolerances are sought.
const WORST: usize = 10;

/// The request for tolerances.
#[derive(Debug, Clone, Copy)]
pub struct GoalRequest<'a> {
    /// The machine; errors with a value that are not bounded stay.
    pub machine: &'a Machine,
    /// The bounded errors with their present tolerances.
    pub bounds: &'a [Bound],
    /// The price of each.
    pub prices: &'a [Price],
    /// The poses (mm, deg).
    pub poses: &'a [Pose],
    /// The reference of the part, which its set-up takes out.
    pub reference: Option<&'a PartReference>,
    /// Generators of machines: for the search, for the correction, for the proof.
    pub draws: [&'a Draws; 3],
    /// Number of machines for the search.
    pub samples: usize,
    /// Number of machines of a default run, the first of those for the search: its interval is within the goal.
    pub default_samples: usize,
    /// Number of machines for the proof.
    pub proof_samples: usize,
    /// Statistic of each machine over the poses.
    pub statistic: Statistic,
    /// The goal of the 95 % value, mm.
    pub goal_mm: f64,
}

/// The answer to a request.
#[derive(Debug, Clone, PartialEq)]
pub enum GoalAnswer {
    /// Tolerances that keep the goal.
    Kept(Box<CheapestTolerances>),
    /// No tolerances within the limits keep it.
    OutOfReach(Unavoidable),
}

/// What holds a tolerance where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Binding {
    /// The goal.
    Goal,
    /// The finest tolerance.
    Finest,
    /// The coarsest tolerance.
    Coarsest,
    /// Its present tolerance, beyond which nothing is loosened.
    Present,
    /// The hold on it.
    Held,
}

/// The cheapest tolerances, in the order of the bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct CheapestTolerances {
    /// The tolerances (mm, rad).
    pub tolerances: Vec<f64>,
    /// What binds each.
    pub binding: Vec<Binding>,
    /// The part of each in the 95 % value, um; with that of the errors that stay they add up to it.
    pub parts_um: Vec<f64>,
    /// The cost of the present tolerances, and of the new ones.
    pub cost: [f64; 2],
    /// Cost of lowering the 95 % value by one um; `None` if no tolerance is free.
    pub cost_per_um: Option<f64>,
    /// The 95 % value with the present tolerances, um, by the machines of the search.
    pub before: Percentile,
    /// The same with the new ones, by machines that the search has not seen.
    pub proof: Percentile,
    /// Largest deviation by the errors that stay alone, um; the 95 % one if that is the statistic.
    pub staying_um: f64,
    /// Number of steps of the search.
    pub steps: usize,
}

/// The error that is left with the finest tolerances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unavoidable {
    /// The upper end of the interval of a default run with all tolerances at their finest, um.
    pub finest_um: f64,
    /// The statistic of the errors that stay alone, um.
    pub staying_um: f64,
}

struct GoalSearch<'a> {
    request: GoalRequest<'a>,
    joints: Vec<JointBounds>,
    poses: Vec<BudgetPose>,
    /// For each generator.
    kept: [KeptDraws<'a>; 3],
}

/// The machines of a generator as it draws them with tolerances of 1; the first ones are kept.
struct KeptDraws<'a> {
    draws: &'a Draws,
    unit: Vec<Bound>,
    chunks: Vec<OnceLock<SampleChunk>>,
}

impl<'a> KeptDraws<'a> {
    /// Keeps so many machines, and not more than fit into [`KEPT_BYTES`].
    fn new(draws: &'a Draws, joints: &[JointBounds], bounds: &[Bound], samples: usize) -> Self {
        let chunks = samples.div_ceil(SAMPLE_LANES).min(KEPT_BYTES / SampleChunk::bytes(joints).max(1));
        let unit = bounds.iter().map(|bound| Bound { tolerance: 1.0, ..bound.clone() }).collect();
        Self { draws, unit, chunks: (0..chunks).map(|_| OnceLock::new()).collect() }
    }

    /// Returns the machines from an index on with the tolerances of bounds.
    fn chunk(&self, joints: &[JointBounds], bounds: &[Bound], first: usize) -> SampleChunk {
        let Some(chunk) = self.chunks.get(first / SAMPLE_LANES) else {
            return SampleChunk::new(joints, bounds, self.draws, first);
        };
        chunk.get_or_init(|| SampleChunk::new(joints, &self.unit, self.draws, first)).times(joints, bounds)
    }
}

/// The sets of machines, in the order of the generators.
const SEARCH: usize = 0;
const CORRECTION: usize = 1;
const PROOF: usize = 2;

/// The value of machines drawn with some tolerances, mm.
struct DrawnValue {
    sorted: Vec<f64>,
    /// Mean of the worst machines.
    worst: f64,
    parts: Vec<f64>,
}

impl DrawnValue {
    fn p95(&self) -> f64 {
        self.sorted[rank(self.sorted.len(), 95) - 1]
    }

    fn percentile_um(&self) -> Percentile {
        Percentile::of(&self.sorted.iter().map(|mm| mm * 1e3).collect::<Vec<_>>(), 95)
    }

    /// Returns the upper end of the interval that a run of `count` machines has, as a multiple of the 95 % value: the
    /// quantile at its share of the machines.
    fn sampling_error(&self, count: usize) -> f64 {
        let share = ranks(count, 95, TAIL).1.min(count) as f64 / count as f64;
        let at = ((share * self.sorted.len() as f64) as usize).clamp(1, self.sorted.len());
        self.sorted[at - 1] / self.p95()
    }
}

/// Returns the cheapest tolerances; the request has at least one bound, pose and sample.
pub fn cheapest(request: GoalRequest<'_>) -> GoalAnswer {
    let search = GoalSearch::new(request);
    let finest: Vec<f64> = request.prices.iter().map(|price| price.finest).collect();
    let staying_um = search.staying() * 1e3;
    let least = search.default_run(&finest);
    if least > request.goal_mm {
        return GoalAnswer::OutOfReach(Unavoidable { finest_um: least * 1e3, staying_um });
    }
    let present: Vec<f64> = request.bounds.iter().map(|bound| bound.tolerance).collect();
    let mut tolerances: Vec<f64> = present.clone();
    tolerances.iter_mut().zip(request.prices).for_each(|(t, price)| *t = t.clamp(price.finest, price.coarsest));
    let (mut aim, mut steps) = (request.goal_mm, 0);
    for _ in 0..MAX_CORRECTIONS {
        steps += search.settle(&mut tolerances, aim);
        let kept = search.evaluate(&tolerances, CORRECTION, CORRECTING);
        let by = request.goal_mm / (kept.p95() * kept.sampling_error(request.default_samples));
        let by = by.min(request.goal_mm / search.default_run(&tolerances));
        let at_coarsest = tolerances.iter().zip(request.prices).all(|(t, price)| *t >= price.coarsest);
        if (by - 1.0).abs() <= KEPT || (at_coarsest && by >= 1.0) {
            break;
        }
        aim *= by;
        scale(&mut tolerances, request.prices, by);
    }
    let mut run = search.default_run(&tolerances);
    for _ in 0..MAX_CORRECTIONS {
        if run <= request.goal_mm {
            break;
        }
        scale(&mut tolerances, request.prices, request.goal_mm / run * BELOW);
        run = search.default_run(&tolerances);
    }
    let before = search.evaluate(&present, SEARCH, request.samples).percentile_um();
    let proof = search.evaluate(&tolerances, PROOF, request.proof_samples);
    let least = proof.p95().max(run);
    if least > request.goal_mm {
        return GoalAnswer::OutOfReach(Unavoidable { finest_um: least * 1e3, staying_um });
    }
    GoalAnswer::Kept(Box::new(search.answer(tolerances, &present, before, &proof, staying_um, steps)))
}

fn scale(tolerances: &mut [f64], prices: &[Price], by: f64) {
    tolerances.iter_mut().zip(prices).for_each(|(t, price)| *t = (*t * by).clamp(price.finest, price.coarsest));
}

impl<'a> GoalSearch<'a> {
    fn new(request: GoalRequest<'a>) -> Self {
        let GoalRequest { machine, bounds, reference, .. } = request;
        let joints = by_joint_without(machine, bounds, reference);
        let staying = StayingErrors::new(machine, bounds, reference);
        let field = staying.as_ref().map(|staying| staying as &dyn Field);
        let at = |pose: &Pose| BudgetPose::new(machine, &joints, pose, Quantity::Position).beside(field, pose);
        let poses = request.poses.par_iter().map(at).collect();
        let sizes = [request.samples.max(request.default_samples), CORRECTING, 0];
        let kept = |set: usize| KeptDraws::new(request.draws[set], &joints, bounds, sizes[set]);
        Self { request, kept: [kept(SEARCH), kept(CORRECTION), kept(PROOF)], joints, poses }
    }

    /// Returns the statistic of the errors that stay alone, mm.
    fn staying(&self) -> f64 {
        let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let mut lengths: Vec<f64> = self.poses.iter().map(|pose| length(pose.constant_deviation())).collect();
        self.request.statistic.of(&mut lengths)
    }

    fn evaluate(&self, tolerances: &[f64], set: usize, samples: usize) -> DrawnValue {
        let GoalRequest { bounds, statistic, .. } = self.request;
        let bounds: Vec<Bound> = bounds
            .iter()
            .zip(tolerances)
            .map(|(bound, tolerance)| Bound { tolerance: *tolerance, ..bound.clone() })
            .collect();
        let chunk_at = |first: usize| self.kept[set].chunk(&self.joints, &bounds, first);
        let Ok([mut drawn]) =
            monte_carlo::draw([&self.poses], &self.joints, &chunk_at, statistic, 0..samples, &unheard);
        drawn.sort_by(|a, b| a.value.total_cmp(&b.value));
        let worst = &drawn[drawn.len() - drawn.len().div_ceil(WORST)..];
        let mean = |of: &dyn Fn(&DrawnMachine) -> f64| worst.iter().map(of).sum::<f64>() / worst.len() as f64;
        let parts = (0..bounds.len()).map(|i| mean(&|sample| sample.parts[i])).collect();
        DrawnValue { worst: mean(&|sample| sample.value), parts, sorted: drawn.iter().map(|s| s.value).collect() }
    }

    /// Returns the upper end (mm) of the interval of a default run.
    fn default_run(&self, tolerances: &[f64]) -> f64 {
        let run = self.evaluate(tolerances, SEARCH, self.request.default_samples).percentile_um();
        run.high.unwrap_or(run.value) * 1e-3
    }

    /// Moves tolerances to the cheapest ones whose 95 % value is `aim` (mm); returns the number of steps.
    fn settle(&self, tolerances: &mut [f64], aim: f64) -> usize {
        for step in 0..MAX_STEPS {
            let found = self.evaluate(tolerances, SEARCH, self.request.samples);
            let next = self.step(tolerances, &found, aim);
            let mut change = 0.0_f64;
            for (t, next) in tolerances.iter_mut().zip(next) {
                let full = libm::log(next / *t);
                change = change.max(full.abs());
                *t *= libm::exp(if step < FULL_STEPS { full } else { 0.5 * full });
            }
            if change <= SETTLED {
                return step + 1;
            }
        }
        MAX_STEPS
    }

    /// Returns the optimum of the model: the square of the value is a sum of squares.
    fn step(&self, tolerances: &[f64], found: &DrawnValue, aim: f64) -> Vec<f64> {
        let GoalRequest { prices, .. } = self.request;
        let value = found.worst;
        let staying = value - found.parts.iter().sum::<f64>();
        let squares: Vec<f64> = found.parts.iter().map(|part| part.max(MIN_PART * value) * value).collect();
        let aim = aim * value / found.p95();
        let room = aim * aim - staying * value;
        let at = |log: f64| -> Vec<f64> {
            let one = |((t, square), price): ((&f64, &f64), &Price)| {
                let multiplier = libm::exp(log);
                let free = price.rise(1.0) * t * t / (2.0 * multiplier * square);
                libm::pow(free, 1.0 / (price.exponent() + 2.0)).clamp(price.finest, price.coarsest)
            };
            tolerances.iter().zip(&squares).zip(prices).map(one).collect()
        };
        let total = |next: &[f64]| -> f64 {
            let one = |((t, square), next): ((&f64, &f64), &f64)| square * (next / t) * (next / t);
            tolerances.iter().zip(&squares).zip(next).map(one).sum()
        };
        let (mut low, mut high) = (-300.0, 300.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if total(&at(middle)) > room { low = middle } else { high = middle }
        }
        at(high)
    }

    fn answer(
        &self,
        tolerances: Vec<f64>,
        present: &[f64],
        before: Percentile,
        proof: &DrawnValue,
        staying_um: f64,
        steps: usize,
    ) -> CheapestTolerances {
        let GoalRequest { prices, .. } = self.request;
        let binding = |(t, price): (&f64, &Price)| match *t {
            _ if price.held => Binding::Held,
            t if t >= price.coarsest && price.coarsest == price.present => Binding::Present,
            t if t <= price.finest => Binding::Finest,
            t if t >= price.coarsest => Binding::Coarsest,
            _ => Binding::Goal,
        };
        let binding: Vec<Binding> = tolerances.iter().zip(prices).map(binding).collect();
        // The worst tenth stands for the 95 % value.
        let um = proof.p95() / proof.worst * 1e3;
        let parts_um: Vec<f64> = proof.parts.iter().map(|part| part * um).collect();
        let cost = |list: &[f64]| -> f64 { list.iter().zip(prices).map(|(t, price)| price.cost(*t)).sum() };
        let free = |i: &usize| binding[*i] == Binding::Goal;
        let (mut paid, mut won) = (0.0, 0.0);
        for i in (0..tolerances.len()).filter(free) {
            paid += prices[i].rise(tolerances[i]);
            won += parts_um[i];
        }
        CheapestTolerances {
            cost: [cost(present), cost(&tolerances)],
            cost_per_um: (won > 0.0).then(|| paid / won),
            proof: proof.percentile_um(),
            tolerances,
            binding,
            parts_um,
            before,
            staying_um,
            steps,
        }
    }
}
