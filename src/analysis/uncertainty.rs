//! Uncertainty of figures: what the uncertainty of the errors' values leaves of the statistics of deviations.
//!
//! The uncertainty is a sum of independent parts ([`UncertainPart`]), each of which moves the deviations at all poses
//! together by known amounts, to first order. A figure such as the 95 % value follows to first order: its expanded
//! uncertainty is twice the root of the sum of the squared halves of its differences, each part added and taken away
//! (JCGM 100:2008, 5.1.3 note 2, with correlations in the parts). Where that is more than a third of a figure the
//! figure is no longer straight enough: it is drawn (JCGM 101:2008), and the interval holds the middle 95 % of the
//! draws.

use super::design::budget::{Normals, Statistic};
use super::reference::{PartReference, tip_at};
use crate::evaluate::{CompiledModel, Deviation, Order, Statistics, Summary};
use crate::machine::{Machine, OperatingConditions, Pose, UncertainPart};
use nalgebra::{DMatrix, SymmetricEigen, Vector3};
use rayon::prelude::*;
use serde::Serialize;

/// Largest number of poses at which the parts are followed.
const MAX_BAND_POSES: usize = 1000;

/// Number of draws; the interval lies between the 50th from either end.
const DRAWS: usize = 2000;
const OUTSIDE: usize = DRAWS / 40;

/// Variance of a principal part, as a share of the largest, below which it is left out: rounding, in another order for
/// every datum.
const MIN_PRINCIPAL_SHARE: f64 = 1e-10;

/// Share of a figure from which on it is drawn.
const STRAIGHT: f64 = 1.0 / 3.0;

/// Golden ratio, by which places in a list spread without following any step of it.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Intervals of the statistics of vectors at a level of confidence of 95 %: lower and upper end.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, schemars::JsonSchema)]
pub struct SummaryBand {
    /// Interval of the largest length.
    pub max: [f64; 2],
    /// Interval of the mean length.
    pub mean: [f64; 2],
    /// Interval of the root of the mean of the squared length.
    pub rms: [f64; 2],
    /// Interval of the 95 % value of the length.
    pub p95: [f64; 2],
}

/// Returns the figure by which a statistic judges values over poses, with its interval.
pub(crate) fn figure_of(statistic: Statistic, of: &Summary, band: Option<&SummaryBand>) -> (f64, Option<[f64; 2]>) {
    match statistic {
        Statistic::Max => (of.max, band.map(|band| band.max)),
        Statistic::P95 => (of.p95, band.map(|band| band.p95)),
    }
}

/// Intervals of the statistics of deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Bands {
    /// Number of independent parts of the uncertainty.
    pub parts: usize,
    /// Number of poses at which they were followed.
    pub poses: usize,
    /// True if the intervals were drawn, false if they are to first order (k = 2).
    pub drawn: bool,
    /// Position deviations of the functional point, um.
    pub position_um: SummaryBand,
    /// Rotations of the tool, urad.
    pub rotation_urad: SummaryBand,
}

/// A machine's deviations (mm, rad) at some poses, and what each part of an uncertainty adds to them.
#[derive(Debug, Clone)]
pub struct UncertainDeviations {
    values: Vec<Deviation>,
    /// By part; empty where the part is not of this machine.
    parts: Vec<Vec<Deviation>>,
    /// Statistics over all poses, of which these are some.
    whole: Statistics,
    /// True if the division of the uncertainty into parts depends on a datum that the data do not hold.
    depends_on_datum: bool,
}

impl UncertainDeviations {
    /// Returns the deviations `values` of a machine, compensated or not, at poses (mm, deg) with the effects of the
    /// parts that are its own, of which a reference takes out its motion. `whole` are the statistics over all poses.
    pub fn of(
        machine: &Machine,
        parts: &[UncertainPart],
        poses: &[Pose],
        values: Vec<Deviation>,
        whole: Statistics,
        conditions: OperatingConditions,
        reference: Option<&PartReference>,
    ) -> Self {
        let own = machine.uncertain_parts();
        let bare = machine.without_uncertainty();
        let effect = |part: &UncertainPart| {
            if !own.contains(part) {
                return Vec::new();
            }
            let model = part_model(&bare, part, conditions);
            let Some(of) = reference else { return poses.iter().map(|pose| model.deviation(pose)).collect() };
            let motion = of.motion(of.points().iter().map(|point| model.deviation(&point.pose).position));
            let left = |pose: &Pose| motion.removed_from(&model.deviation(pose), &tip_at(machine, pose));
            poses.iter().map(left).collect()
        };
        let depends_on_datum = !machine.unheld().is_empty();
        Self { values, parts: parts.par_iter().map(effect).collect(), whole, depends_on_datum }
    }

    /// Returns the deviations of machines with the principal parts of what the parts do to all of them together, the
    /// largest first, if the division into parts depends on a datum: figures that are no straight functions of the
    /// parts, and draws, are then the same for every datum. Parts that only turn the tool come behind those that move
    /// its tip: readings of the tip do not hold them.
    pub fn with_principal_parts(machines: Vec<Self>) -> Vec<Self> {
        let count = machines.first().map_or(0, |machine| machine.parts.len());
        if count == 0 || !machines.iter().any(|machine| machine.depends_on_datum) {
            return machines;
        }
        // Rows: three components of each pose of each machine.
        let effects = |of: &dyn Fn(&Deviation) -> Vector3<f64>| -> DMatrix<f64> {
            let rows = machines.iter().flat_map(|machine| (0..3 * machine.values.len()).map(move |i| (machine, i)));
            let entry = |(machine, i): (&Self, usize), k: usize| {
                machine.parts[k].get(i / 3).map_or(0.0, |effect| of(effect)[i % 3])
            };
            let rows: Vec<_> = rows.collect();
            DMatrix::from_fn(rows.len(), count, |i, k| entry(rows[i], k))
        };
        let (positions, rotations) = (effects(&|effect| effect.position), effects(&|effect| effect.rotation));
        let (moving, turning) = principal_directions(&positions);
        let (turning_only, _) = principal_directions(&(&rotations * &turning));
        let turned = &rotations * &turning * &turning_only;
        let (mut positions, mut rotations) = (&positions * &moving, &rotations * &moving);
        // The largest effect of a part is positive.
        for (k, mut column) in positions.column_iter_mut().enumerate() {
            let sign = sign_of_largest(column.iter());
            column *= sign;
            rotations.column_mut(k).scale_mut(sign);
        }
        let mut first = 0;
        let with = |machine: Self| {
            let (start, poses) = (first, machine.values.len());
            first += 3 * poses;
            let three = |of: &DMatrix<f64>, i: usize, k: usize| Vector3::from_fn(|j, _| of[(start + 3 * i + j, k)]);
            let moved = |k: usize| -> Vec<Deviation> {
                let at = |i| Deviation { position: three(&positions, i, k), rotation: three(&rotations, i, k) };
                (0..poses).map(at).collect()
            };
            let turned_by = |k: usize| -> Vec<Deviation> {
                let sign = sign_of_largest(turned.column(k).iter());
                let at = |i| Deviation { position: Vector3::zeros(), rotation: three(&turned, i, k) * sign };
                (0..poses).map(at).collect()
            };
            let parts = (0..positions.ncols()).map(moved).chain((0..turned.ncols()).map(turned_by)).collect();
            Self { parts, ..machine }
        };
        machines.into_iter().map(with).collect()
    }

    /// Returns figures of the deviations in draws of the parts (JCGM 101), the same for a seed. Deviations are those of
    /// all poses.
    pub fn draws<T: Send>(&self, seed: u64, of: &(dyn Fn(&[Deviation]) -> T + Sync)) -> Vec<T> {
        let one = |sample: usize| of(&self.moved(&amounts(self.parts.len(), seed, sample)));
        (0..DRAWS).into_par_iter().map(one).collect()
    }

    /// Returns the interval that holds the middle 95 % of draws; reorders them.
    pub fn interval(draws: &mut [f64]) -> [f64; 2] {
        draws.sort_unstable_by(f64::total_cmp);
        [draws[OUTSIDE - 1], draws[draws.len() - OUTSIDE]]
    }

    /// Figures with so much of each part added, in standard uncertainties.
    fn with(&self, amounts: &[f64]) -> DeviationFigures {
        figures(&Statistics::of(&self.moved(amounts)))
    }

    /// Deviations with so much of each part added, in standard uncertainties.
    fn moved(&self, amounts: &[f64]) -> Vec<Deviation> {
        let mut moved = self.values.clone();
        for (amount, part) in amounts.iter().zip(&self.parts).filter(|(amount, _)| **amount != 0.0) {
            for (value, effect) in moved.iter_mut().zip(part) {
                value.position += effect.position * *amount;
                value.rotation += effect.rotation * *amount;
            }
        }
        moved
    }
}

/// Returns the principal directions of the columns of a matrix, orthonormal, the largest effect first, and a basis of
/// those that have none but rounding.
fn principal_directions(effects: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    if effects.ncols() == 0 {
        return (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0));
    }
    let SymmetricEigen { eigenvectors, eigenvalues } = effects.tr_mul(effects).symmetric_eigen();
    let least = MIN_PRINCIPAL_SHARE * eigenvalues.iter().copied().fold(0.0, f64::max);
    let (mut acting, idle): (Vec<usize>, Vec<usize>) = (0..eigenvalues.len()).partition(|k| eigenvalues[*k] > least);
    acting.sort_by(|a, b| eigenvalues[*b].total_cmp(&eigenvalues[*a]));
    (eigenvectors.select_columns(&acting), eigenvectors.select_columns(&idle))
}

/// Returns the sign of the largest entry.
fn sign_of_largest<'a>(entries: impl Iterator<Item = &'a f64>) -> f64 {
    entries.fold(0.0, |largest: f64, x| if x.abs() > largest.abs() { *x } else { largest }).signum()
}

/// Returns the amounts of the parts in a draw.
fn amounts(count: usize, seed: u64, sample: usize) -> Vec<f64> {
    let mut normals = Normals::new(seed, sample as u64);
    (0..count).map(|_| normals.next()).collect()
}

/// Largest, mean, rms and 95 % value, of positions, then of rotations.
type DeviationFigures = [f64; 8];

/// An interval about each of them.
type FigureIntervals = [[f64; 2]; 8];

fn figures(statistics: &Statistics) -> DeviationFigures {
    let four = |s: &Summary| [s.max, s.mean, s.rms, s.p95];
    let ([a, b, c, d], [e, f, g, h]) = (four(&statistics.position_um), four(&statistics.rotation_urad));
    [a, b, c, d, e, f, g, h]
}

/// Returns the models whose deviations are the effects of one standard uncertainty of each part, to first order.
pub fn part_models(machine: &Machine, parts: &[UncertainPart], conditions: OperatingConditions) -> Vec<CompiledModel> {
    let bare = machine.without_uncertainty();
    parts.par_iter().map(|part| part_model(&bare, part, conditions)).collect()
}

fn part_model(bare: &Machine, part: &UncertainPart, conditions: OperatingConditions) -> CompiledModel {
    CompiledModel::new(&bare.moved_by(part), Order::Degree(1), conditions)
}

/// Returns the parts of several machines, each once.
pub fn uncertain_parts<'m>(machines: impl IntoIterator<Item = &'m Machine>) -> Vec<UncertainPart> {
    let mut all: Vec<UncertainPart> = Vec::new();
    for machine in machines {
        let known = all.len();
        let own = machine.uncertain_parts();
        all.extend(own.into_iter().filter(|part| !all[..known].contains(part)).collect::<Vec<_>>());
    }
    all
}

/// Returns places of a list of `count` at which its figures are looked at: all, or 1000 spread over it,
/// and `besides`.
pub fn band_places(count: usize, besides: &[usize]) -> Vec<usize> {
    spread_places(count, MAX_BAND_POSES, besides)
}

/// Returns places of a list of `count`: all, or `most` spread over it, and `besides`.
pub fn spread_places(count: usize, most: usize, besides: &[usize]) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let spread = (0..most).map(|i| ((i as f64 * GOLDEN).fract() * count as f64) as usize);
    let mut places: Vec<usize> = spread.chain(besides.iter().copied()).collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// Returns the intervals of each machine's figures, and of the figures of each minus those of the first. Machines share
/// the parts that both their files state. `seed` is that of the draws.
pub fn bands(machines: &[UncertainDeviations], seed: u64) -> (Vec<Bands>, Vec<Bands>) {
    let count = machines.first().map_or(0, |machine| machine.parts.len());
    let at_rest: Vec<DeviationFigures> = machines.iter().map(|machine| machine.with(&[])).collect();
    // Of each machine, then of each less that of the first.
    let moved = |amounts: &[f64]| -> Vec<DeviationFigures> {
        let own: Vec<DeviationFigures> =
            machines.iter().zip(&at_rest).map(|(m, rest)| minus(&m.with(amounts), rest)).collect();
        own.iter().copied().chain(own.iter().map(|figures| minus(figures, &own[0]))).collect()
    };
    let whole: Vec<DeviationFigures> = machines.iter().map(|machine| figures(&machine.whole)).collect();
    let (straight, reach) = first_order(count, &moved);
    let bent = |(figure, reach): (&f64, &f64)| *reach > figure.abs() * STRAIGHT;
    let drawn = whole.iter().zip(&reach).any(|(figures, reach)| figures.iter().zip(reach).any(bent));
    let changes = if drawn { by_draws(count, seed, &moved) } else { straight };
    let (own, differences) = changes.split_at(machines.len().min(changes.len()));
    let band = |(machine, (figures, intervals)): (&UncertainDeviations, (DeviationFigures, &FigureIntervals)),
                least: f64| {
        let ends: FigureIntervals =
            std::array::from_fn(|i| intervals[i].map(|change| (figures[i] + change).max(least)));
        let four = |i: usize| SummaryBand { max: ends[i], mean: ends[i + 1], rms: ends[i + 2], p95: ends[i + 3] };
        Bands { parts: count, poses: machine.values.len(), drawn, position_um: four(0), rotation_urad: four(4) }
    };
    let above_first = whole.iter().map(|figures| minus(figures, &whole[0]));
    let own = machines.iter().zip(whole.iter().copied().zip(own)).map(|of| band(of, 0.0)).collect();
    let differences = machines.iter().zip(above_first.zip(differences)).map(|of| band(of, f64::NEG_INFINITY)).collect();
    (own, differences)
}

fn minus(of: &DeviationFigures, from: &DeviationFigures) -> DeviationFigures {
    std::array::from_fn(|i| of[i] - from[i])
}

/// Changes of figures to first order: minus and plus the expanded uncertainty, k = 2. Beside them the larger change of
/// either sign, expanded likewise: a length near zero grows whichever way it is moved.
fn first_order(
    count: usize,
    moved: &(impl Fn(&[f64]) -> Vec<DeviationFigures> + Sync),
) -> (Vec<FigureIntervals>, Vec<DeviationFigures>) {
    let both = |k: usize| {
        let mut amounts = vec![0.0; count];
        amounts[k] = 1.0;
        let up = moved(&amounts);
        amounts[k] = -1.0;
        (up, moved(&amounts))
    };
    let changes: Vec<(Vec<DeviationFigures>, Vec<DeviationFigures>)> = (0..count).into_par_iter().map(both).collect();
    let expanded = |m: usize, i: usize, of: fn(f64, f64) -> f64| {
        let parts = changes.iter().map(|(up, down)| of(up[m][i], down[m][i]));
        2.0 * parts.map(|x| x * x).sum::<f64>().sqrt()
    };
    let half = |m: usize, i: usize| expanded(m, i, |up, down| 0.5 * (up - down));
    let reach = |m: usize, i: usize| expanded(m, i, |up, down| up.abs().max(down.abs()));
    let fields = 0..changes.first().map_or(0, |(up, _)| up.len());
    let intervals = fields.clone().map(|m| std::array::from_fn(|i| [-half(m, i), half(m, i)])).collect();
    (intervals, fields.map(|m| std::array::from_fn(|i| reach(m, i))).collect())
}

/// Changes of figures between which the middle 95 % of the draws lie.
fn by_draws(
    count: usize,
    seed: u64,
    moved: &(impl Fn(&[f64]) -> Vec<DeviationFigures> + Sync),
) -> Vec<FigureIntervals> {
    let one = |sample: usize| moved(&amounts(count, seed, sample));
    let all: Vec<Vec<DeviationFigures>> = (0..DRAWS).into_par_iter().map(one).collect();
    let interval = |m: usize, i: usize| {
        let mut values: Vec<f64> = all.iter().map(|figures| figures[m][i]).collect();
        UncertainDeviations::interval(&mut values)
    };
    (0..all.first().map_or(0, Vec::len)).map(|m| std::array::from_fn(|i| interval(m, i))).collect()
}
