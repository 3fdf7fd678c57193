//! The budget of one machine: worst case, RSS and drawn machines over the poses.

use super::bounds::Bound;
use super::draw::Draws;
use super::kernel::{BoundEffects, BudgetPose, JointBounds, SampleChunk, by_joint_without, length};
use super::monte_carlo::{self, DrawnMachine, Statistic};
use super::quantile::{Percentile, mean};
use super::search::{Objective, VolumeSearch, exceeds, is_closed};
use super::staying::{ActingErrors, StayingErrors};
use super::worst::{longest, longest_by_ascent, upper_bound};
use crate::analysis::reference::PartReference;
use crate::evaluate::{Field, Poses, Random};
use crate::lower::Quantity;
use crate::machine::{Machine, Pose};
use crate::run::{Advance, Cancelled};
use rayon::prelude::*;
use std::ops::Range;

/// The request for a budget.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The errors that act in every machine drawn beside the bounded ones.
    pub acting: ActingErrors<'a>,
    /// The bounded errors.
    pub bounds: &'a [Bound],
    /// The poses (mm, deg).
    pub poses: &'a [Pose],
    /// The reference of the part, which its set-up takes out.
    pub reference: Option<&'a PartReference>,
    /// True if the worst pose is searched in the volume, beyond the poses; with a reference it never is.
    pub searched: bool,
    /// Another pose (mm, deg) for the Pareto chart.
    pub at: Option<&'a [f64]>,
    /// The generator of drawn machines.
    pub draws: &'a Draws,
    /// Number of drawn machines.
    pub samples: usize,
    /// Statistic of each machine over the poses.
    pub statistic: Statistic,
}

/// A budget of the functional point's position (um) and of the tool's orientation (urad).
#[derive(Debug, Clone)]
pub struct Budget {
    /// Position of the functional point, um.
    pub position: Totals,
    /// Orientation of the tool, urad.
    pub rotation: Totals,
    /// Effect of each error at its bound on the position, at the pose where the RSS is largest, um.
    pub worst: Vec<Contribution>,
    /// The same as root of the mean square over the poses.
    pub average: Vec<Contribution>,
    /// The same at the pose asked for.
    pub at: Option<Vec<Contribution>>,
}

/// The totals of a budget, in um or urad.
#[derive(Debug, Clone)]
pub struct Totals {
    /// All errors at their bounds with the worst signs, at the pose where that is largest.
    pub worst_case: f64,
    /// That pose (mm, deg).
    pub worst_pose: Pose,
    /// Root of the sum of squares of the bounds' effects, at the pose where that is largest.
    pub rss: f64,
    /// That pose.
    pub rss_pose: Pose,
    /// The drawn machines' errors in the order in which they are drawn.
    pub drawn: Vec<f64>,
    /// The same in rising order.
    pub sorted: Vec<f64>,
    /// Their mean and its standard error.
    pub mean: (f64, f64),
    /// Effect of each tolerance on the 95 % value, in the order of the bounds.
    pub tighten: Vec<ToleranceEffect>,
    /// The part of the 95 % value by errors with values: with those effects it sums up to it.
    pub staying: f64,
}

/// One error at its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contribution {
    /// Index in the list of bounds.
    pub bound: usize,
    /// Fraction of the sum of squares.
    pub share: f64,
    /// Deviation by this error alone, um.
    pub um: f64,
}

/// The dependence of the 95 % value on a tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleranceEffect {
    /// Tolerance times derivative of the 95 % value (um or urad): tightening the tolerance by 10 % lowers that value by
    /// a tenth of this, to first order.
    pub effect: f64,
    /// Its standard error from the number of samples.
    pub sigma: f64,
}

/// The reported percentiles, in percent.
pub const PERCENTS: [usize; 4] = [50, 90, 95, 99];

/// The derivative of the 95 % value is estimated from the samples between these fractions.
const WINDOW: (f64, f64) = (0.925, 0.975);

/// Relative precision of the order of upper bounds.
const SINGLE: f64 = 1e-6;

/// Maximum number of axes with which all corners of the volume are among the poses.
const MAX_CORNER_AXES: usize = 10;

/// Returns the corners of the volume, and `count` random poses within it (mm, deg). Where the ends of a rotary axis are
/// one place, the corner opposite to it takes the place of one of them.
pub fn budget_poses(machine: &Machine, count: usize, seed: u64) -> Vec<Pose> {
    let volume = machine.volume();
    let moving: Vec<usize> = (0..volume.len()).filter(|i| volume[*i].max > volume[*i].min).collect();
    let corner = |k: usize| {
        let mut pose: Pose = volume.iter().map(|grid| grid.min).collect();
        let far = |i: usize| {
            let opposite = is_closed(&machine.axes()[i], &volume[i]);
            if opposite { volume[i].min + 180.0 } else { volume[i].max }
        };
        moving.iter().enumerate().filter(|(bit, _)| k >> bit & 1 == 1).for_each(|(_, i)| pose[*i] = far(*i));
        pose
    };
    let corners = if moving.len() > MAX_CORNER_AXES { 0 } else { 1 << moving.len() };
    let within = Poses::Random(Random::of(machine, count, seed));
    (0..corners).map(corner).chain(within.iter()).collect()
}

/// Drawn machines in the order of their indices.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnSamples {
    /// Statistic of the position, mm.
    pub position: Vec<DrawnMachine>,
    /// Statistic of the orientation of the tool, rad.
    pub rotation: Vec<DrawnMachine>,
}

/// Returns the drawn machines with these indices, for [`budget_from_samples`]. Calls `progress` with the number of
/// machines drawn since its last call: in all twice their number.
pub fn draw_samples(
    request: Request<'_>,
    samples: Range<usize>,
    progress: Advance<'_>,
) -> Result<DrawnSamples, Cancelled> {
    let joints = by_joint_without(request.machine, request.bounds, request.reference);
    samples_at(&request, &joints, &effects_of_both(&request, &joints), samples, progress)
}

/// Returns the budget; the request has at least one bound, pose and sample. Calls `progress` with the number of
/// machines drawn since its last call: in all twice the samples.
pub fn budget(request: Request<'_>, progress: Advance<'_>) -> Result<Budget, Cancelled> {
    budget_from_samples(request, None, progress)
}

/// Returns the budget with machines that are drawn already: all that the request asks for.
pub fn budget_from_samples(
    request: Request<'_>,
    drawn: Option<DrawnSamples>,
    progress: Advance<'_>,
) -> Result<Budget, Cancelled> {
    let joints = by_joint_without(request.machine, request.bounds, request.reference);
    let places = effects_of_both(&request, &joints);
    let drawn = match drawn {
        Some(drawn) => drawn,
        None => samples_at(&request, &joints, &places, 0..request.samples, progress)?,
    };
    let [at_position, at_rotation] = &places;
    let (position, extremes, worst) = totals(&request, &joints, Quantity::Position, at_position, drawn.position);
    let (rotation, ..) = totals(&request, &joints, Quantity::Rotation, at_rotation, drawn.rotation);
    let at = request.at.map(|pose| {
        let budget_pose = BudgetPose::new(request.machine, &joints, pose, Quantity::Position);
        contributions(&budget_pose.extremes(&joints, request.bounds, request.draws).lengths)
    });
    Ok(Budget {
        position,
        rotation,
        worst: contributions(&worst.lengths),
        average: contributions(&root_mean_square(&extremes)),
        at,
    })
}

/// Effects of every error at its bound, at every pose.
type Extremes = Vec<BoundEffects>;

/// Calls a function with the field of the errors that act in every machine drawn.
fn with_acting<T>(request: &Request<'_>, of: impl FnOnce(Option<&dyn Field>) -> T) -> T {
    match request.acting {
        ActingErrors::None => of(None),
        ActingErrors::OfField(field) => of(Some(field)),
        ActingErrors::OfMachine => {
            let staying = StayingErrors::new(request.machine, request.bounds, request.reference);
            of(staying.as_ref().map(|staying| staying as &dyn Field))
        }
    }
}

/// Returns the effects of all errors at the poses.
pub(super) fn effects(request: &Request<'_>, joints: &[JointBounds], quantity: Quantity) -> Vec<BudgetPose> {
    with_acting(request, |field| {
        let at = |pose: &Pose| BudgetPose::new(request.machine, joints, pose, quantity).beside(field, pose);
        request.poses.par_iter().map(at).collect()
    })
}

fn effects_of_both(request: &Request<'_>, joints: &[JointBounds]) -> [Vec<BudgetPose>; 2] {
    [Quantity::Position, Quantity::Rotation].map(|quantity| effects(request, joints, quantity))
}

fn samples_at(
    request: &Request<'_>,
    joints: &[JointBounds],
    places: &[Vec<BudgetPose>; 2],
    samples: Range<usize>,
    progress: Advance<'_>,
) -> Result<DrawnSamples, Cancelled> {
    let chunk_at = |first: usize| SampleChunk::new(joints, request.bounds, request.draws, first);
    let places = places.each_ref().map(Vec::as_slice);
    let [position, rotation] = monte_carlo::draw(places, joints, &chunk_at, request.statistic, samples, progress)?;
    Ok(DrawnSamples { position, rotation })
}

fn totals(
    request: &Request<'_>,
    joints: &[JointBounds],
    quantity: Quantity,
    budget_poses: &[BudgetPose],
    mut drawn: Vec<DrawnMachine>,
) -> (Totals, Extremes, BoundEffects) {
    let Request { machine, bounds, poses, draws, reference, .. } = *request;
    let scale = if quantity == Quantity::Position { 1e3 } else { 1e6 };
    let extremes: Extremes = budget_poses.par_iter().map(|pose| pose.extremes(joints, bounds, draws)).collect();
    let (worst, mut worst_case) = worst_of(&extremes, if reference.is_some() { longest_by_ascent } else { longest });
    let sums: Vec<f64> = extremes.iter().map(BoundEffects::rss).collect();
    let largest_rss = largest(&sums);
    let (mut worst_pose, mut rss_pose) = (poses[worst].clone(), poses[largest_rss].clone());
    let (mut at_rss, mut largest_sum) = (extremes[largest_rss].clone(), sums[largest_rss]);
    if request.searched && reference.is_none() {
        let sum = |list: &[[f64; 3]]| lengths(list).iter().sum::<f64>();
        let (worst, (pose, vectors, sum_there)) = with_acting(request, |field| {
            let at = |pose: &[f64]| {
                let here = BudgetPose::new(machine, joints, pose, quantity).beside(field, pose);
                here.extremes(joints, bounds, draws).vectors
            };
            let search =
                |objective: Objective<'_>, known: &Pose| VolumeSearch::new(machine, &at, objective).worst(known);
            let worst = search(Objective { value: &longest, bound: &sum }, &worst_pose);
            (worst, search(Objective { value: &rss, bound: &rss }, &rss_pose))
        });
        (worst_pose, _, worst_case) = worst;
        (rss_pose, largest_sum) = (pose, sum_there);
        let mut lengths = lengths(&vectors);
        let staying = lengths.get(bounds.len()).copied().unwrap_or(0.0);
        lengths.truncate(bounds.len());
        at_rss = BoundEffects { lengths, vectors, staying };
    }
    let in_order = drawn.iter().map(|sample| sample.value * scale).collect();
    // A stable order of equal values keeps the window the same on every run.
    drawn.sort_by(|a, b| a.value.total_cmp(&b.value));
    let sorted: Vec<f64> = drawn.iter().map(|sample| sample.value * scale).collect();
    let totals = Totals {
        worst_case: worst_case * scale,
        worst_pose,
        rss: largest_sum * scale,
        rss_pose,
        mean: mean(&sorted),
        staying: around(&drawn, |sample| (sample.value - sample.parts.iter().sum::<f64>()) * scale).effect,
        tighten: (0..bounds.len()).map(|bound| around(&drawn, |sample| sample.parts[bound] * scale)).collect(),
        drawn: in_order,
        sorted,
    };
    (totals, extremes, at_rss)
}

/// Returns the root of the sum of squares.
fn rss(list: &[[f64; 3]]) -> f64 {
    lengths(list).iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Totals {
    /// Returns the mean of worst case and RSS, the estimate of such budgets (A. H. Slocum).
    pub fn mean_of_both(&self) -> f64 {
        0.5 * (self.worst_case + self.rss)
    }

    /// Returns the index of the bound whose tolerance to tighten first: the largest effect on the 95 % value.
    pub fn first_to_tighten(&self) -> Option<usize> {
        let effect = |i: &usize| self.tighten[*i].effect;
        (0..self.tighten.len()).rev().max_by(|a, b| effect(a).total_cmp(&effect(b)))
    }

    /// Returns a percentile of the drawn machines, with its confidence interval.
    pub fn percentile(&self, percent: usize) -> Percentile {
        Percentile::of(&self.sorted, percent)
    }
}

/// Returns the pose with the largest worst case, and its length. The sum of lengths is an upper bound that skips other
/// poses.
fn worst_of(extremes: &Extremes, longest: fn(&[[f64; 3]]) -> f64) -> (usize, f64) {
    let upper: Vec<f64> = extremes.iter().map(|effects| lengths(&effects.vectors).iter().sum()).collect();
    let mut order: Vec<usize> = (0..extremes.len()).collect();
    // In single precision, where rounding does not order places that are alike.
    order.sort_by(|a, b| (upper[*b] as f32).total_cmp(&(upper[*a] as f32)).then(a.cmp(b)));
    let mut best = (0, -1.0);
    for index in order {
        if upper[index] < best.1 * (1.0 - SINGLE) {
            break;
        }
        // Passed over before the search: it would find nothing longer.
        if upper_bound(&extremes[index].vectors) <= best.1 {
            continue;
        }
        let length = longest(&extremes[index].vectors);
        if exceeds(length, best.1) {
            best = (index, length);
        }
    }
    best
}

fn lengths(vectors: &[[f64; 3]]) -> Vec<f64> {
    vectors.iter().map(length).collect()
}

/// Returns the index of the largest value; of equal ones the first.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).fold(0, |best, i| if exceeds(values[i], values[best]) { i } else { best })
}

fn root_mean_square(extremes: &Extremes) -> Vec<f64> {
    let mut sums = vec![0.0; extremes.first().map_or(0, |effects| effects.lengths.len())];
    for effects in extremes {
        sums.iter_mut().zip(&effects.lengths).for_each(|(sum, x)| *sum += x * x);
    }
    sums.into_iter().map(|sum| (sum / extremes.len() as f64).sqrt()).collect()
}

/// Returns the contributions of lengths (mm), largest first.
fn contributions(lengths: &[f64]) -> Vec<Contribution> {
    let total: f64 = lengths.iter().map(|x| x * x).sum();
    let share = |x: f64| if total > 0.0 { x * x / total } else { 0.0 };
    let one = |(bound, x): (usize, &f64)| Contribution { bound, share: share(*x), um: x * 1e3 };
    let mut list: Vec<Contribution> = lengths.iter().enumerate().map(one).collect();
    list.sort_by(|a, b| b.um.total_cmp(&a.um).then(a.bound.cmp(&b.bound)));
    list
}

/// Returns the ranks (from 0) around the 95 % value of samples in rising order, at least one.
pub(super) fn around_95(count: usize) -> Range<usize> {
    let n = count as f64;
    let first = ((WINDOW.0 * n) as usize).min(count - 1);
    first..(libm::ceil(WINDOW.1 * n) as usize).clamp(first + 1, count)
}

/// Returns the mean of parts over the samples around the 95 % value.
fn around(drawn: &[DrawnMachine], part: impl Fn(&DrawnMachine) -> f64) -> ToleranceEffect {
    let parts: Vec<f64> = drawn[around_95(drawn.len())].iter().map(part).collect();
    let (effect, sigma) = mean(&parts);
    ToleranceEffect { effect, sigma }
}
