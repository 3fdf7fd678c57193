//! Positions of the points of a table over one axis, as the rules of the mechanism allow.

use super::{Spacing, TableRules};
use crate::machine::{AxisKind, Curve, Direction, ErrorTerm, Machine, Travel};
use crate::units::Interval;
use std::collections::BinaryHeap;

/// Intervals of a table over a rotary axis that carries sines: 5 deg leave a thousandth of them.
const ROTARY_INTERVALS: usize = 72;

/// Intervals of a table over curves without knots.
const SMOOTH_INTERVALS: usize = 128;

/// The line through position 0 is given by its value here (mm or deg).
const LINE: f64 = 1000.0;

/// Candidates for each point that is kept where points are free.
const CANDIDATES: usize = 4;

/// Positions that a table over an axis covers.
pub(super) fn interval(machine: &Machine, axis: usize, rules: &TableRules) -> Interval {
    match machine.axes()[axis].travel {
        Travel::Continuous => Interval::new(rules.continuous.0, rules.continuous.1),
        Travel::Range(min, max) => Interval::new(min, max),
    }
}

/// The curves that a table over an axis holds.
pub(super) struct AxisCurves<'a> {
    pub machine: &'a Machine,
    pub axis: usize,
    /// Selects the errors of the axis that count.
    pub counts: &'a dyn Fn(Direction) -> bool,
    /// True if the table also carries sines of the axis's angle.
    pub sines: bool,
}

impl AxisCurves<'_> {
    fn all(&self) -> impl Iterator<Item = &Curve> {
        let terms = Direction::ALL.into_iter().filter(|d| (self.counts)(*d));
        let component = |d: Direction| match self.machine.axis_errors(self.axis).component[d.index()].as_ref() {
            Some(ErrorTerm::Component(component)) => Some(component),
            _ => None,
        };
        terms.filter_map(component).flat_map(|c| c.curves())
    }

    /// True if all curves are straight between knots.
    fn straight(&self) -> bool {
        !self.sines && self.all().all(|curve| matches!(curve, Curve::Linear(_)))
    }

    /// Knots within an interval, ends included; periodic ones are repeated.
    pub fn knots(&self, range: Interval) -> Vec<f64> {
        let mut all = vec![range.min, range.max];
        for knots in self.all().filter_map(Curve::knots) {
            let period = knots.period().unwrap_or(0.0);
            let turns = if period > 0.0 { libm::ceil(range.span() / period) as i32 + 1 } else { 0 };
            let shifted = |turn: i32| knots.positions().iter().map(move |q| q + f64::from(turn) * period);
            all.extend((-turns..=turns).flat_map(shifted).filter(|q| range.contains(*q)));
        }
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Positions of the table's points. Where they are free and the knots too many, the points with the smallest
    /// residual between them stay.
    pub fn positions(&self, rules: &TableRules, columns: &ColumnValues) -> Vec<f64> {
        let kind = self.machine.axes()[self.axis].kind;
        let travel = interval(self.machine, self.axis, rules);
        let range = match rules.spacing {
            Spacing::Stepped | Spacing::PowerOfTwo(_) => {
                Interval { min: rules.increment.position(travel.min, kind), ..travel }
            }
            Spacing::Anchored => Interval::new(travel.min.min(0.0), travel.max.max(0.0)),
            _ => travel,
        };
        let max_points = rules.max_points.min(rules.max_points_per_axis);
        let min_step = rules.increment.min_position(kind);
        let turns = self.machine.is_continuous(self.axis);
        let step = |step: f64| whole_step(step, min_step, turns.then_some(range));
        let positions = match rules.spacing {
            Spacing::Free => self.free(range, max_points, rules, columns),
            Spacing::Equal => equal(range, max_points),
            Spacing::Stepped => self.steps(range, step(self.step(range, max_points - 1)), max_points),
            Spacing::Anchored if turns => {
                multiples_over(range, step(self.step(range, max_points.saturating_sub(3).max(1))))
            }
            Spacing::Anchored => {
                multiples_over(range, step(self.anchored_step(range, max_points.saturating_sub(3).max(1), min_step)))
            }
            Spacing::PowerOfTwo(unit) => {
                let wanted = range.span() / (max_points - 1) as f64 / unit;
                self.steps(range, unit * libm::exp2(libm::ceil(libm::log2(wanted) - 1e-9).max(0.0)), max_points)
            }
            Spacing::Line => vec![0.0, LINE],
        };
        rules.increment.distinct(positions, kind)
    }

    fn free(&self, range: Interval, max_points: usize, rules: &TableRules, columns: &ColumnValues) -> Vec<f64> {
        let knots = self.knots(range);
        if self.straight() && (2..=max_points).contains(&knots.len()) {
            return knots;
        }
        let dense = CANDIDATES * max_points.min(SMOOTH_INTERVALS * 2);
        let mut candidates = [knots, equal(range, dense)].concat();
        candidates.sort_by(f64::total_cmp);
        // At the positions that will be stored.
        let candidates = rules.increment.distinct(candidates, self.machine.axes()[self.axis].kind);
        let rows: Vec<Vec<f64>> = candidates.iter().map(|q| (columns.value)(*q)).collect();
        let stored: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().map(|x| (columns.stored)(*x)).collect()).collect();
        let kept = place(&candidates, &rows, &stored, max_points);
        kept.into_iter().map(|i| candidates[i]).collect()
    }

    /// Returns the step of equal distances, in at most `max_intervals`: one that meets the knots if there is one.
    fn step(&self, range: Interval, max_intervals: usize) -> f64 {
        let knots = self.knots(range);
        let regular = range.span() / (knots.len() - 1) as f64;
        let meets = knots.iter().enumerate().all(|(i, q)| (q - range.min - i as f64 * regular).abs() < 1e-6 * regular);
        let rotary = self.machine.axes()[self.axis].kind == AxisKind::Rotary;
        let wanted = match (self.straight(), rotary && self.sines) {
            (true, _) => 1,
            (false, true) => ROTARY_INTERVALS,
            (false, false) => SMOOTH_INTERVALS,
        };
        let intervals = if meets { (knots.len() - 1) * wanted.div_ceil(knots.len() - 1) } else { SMOOTH_INTERVALS };
        range.span() / intervals.min(max_intervals).max(1) as f64
    }

    /// Returns the largest step whose multiples from 0 meet the knots, or else the ends, in at most `max_intervals`.
    /// Where the ends are not met, the rest between the last multiple and the end would count for a whole step.
    fn anchored_step(&self, range: Interval, max_intervals: usize, min_step: f64) -> f64 {
        let whole = |ratio: f64| (ratio - libm::round(ratio)).abs() < 1e-6;
        let (fine, max_intervals) = (SMOOTH_INTERVALS.min(max_intervals), (2 * SMOOTH_INTERVALS).min(max_intervals));
        let wanted = match (self.straight(), self.sines && self.machine.axes()[self.axis].kind == AxisKind::Rotary) {
            (true, _) => 1,
            (false, true) => ROTARY_INTERVALS.min(max_intervals),
            (false, false) => fine,
        };
        let meets = |step: f64, points: &[f64]| whole(step / min_step) && points.iter().all(|q| whole(q / step));
        let knots = self.knots(range);
        let of = |intervals: usize| range.span() / intervals as f64;
        let first = (wanted..=max_intervals).map(of).find(|step| meets(*step, &knots));
        let ends = || {
            (fine..=max_intervals)
                .chain((wanted.max(fine / 2)..fine).rev())
                .map(of)
                .find(|step| meets(*step, &[range.min, range.max]))
        };
        first.or_else(ends).unwrap_or(of(fine))
    }

    fn steps(&self, range: Interval, step: f64, max_points: usize) -> Vec<f64> {
        let count = (libm::ceil(range.span() / step - 1e-9).max(1.0) as usize + 1).min(max_points);
        (0..count).map(|i| range.min + i as f64 * step).collect()
    }
}

/// A step of whole increments, not less than the one wanted; within a turn one that divides it.
fn whole_step(wanted: f64, min_step: f64, turn: Option<Interval>) -> f64 {
    const DIVISORS: [f64; 14] = [0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0];
    let rounded = min_step * libm::ceil(wanted / min_step - 1e-6);
    let divides = |step: f64, range: Interval| {
        let intervals = range.span() / step;
        (intervals - libm::round(intervals)).abs() < 1e-9 * intervals
    };
    match turn {
        Some(range) if !divides(rounded, range) => DIVISORS.into_iter().find(|step| *step >= wanted).unwrap_or(180.0),
        _ => rounded,
    }
}

fn equal(range: Interval, points: usize) -> Vec<f64> {
    let last = (points - 1) as f64;
    (0..points).map(|i| range.min + range.span() * (i as f64 / last)).collect()
}

fn multiples_over(range: Interval, step: f64) -> Vec<f64> {
    let (first, last) = (libm::floor(range.min / step + 1e-9) as i64, libm::ceil(range.max / step - 1e-9) as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Returns `count` multiples of a step, up to the first one not below the range's end; over a turn, `count` and one.
pub(super) fn rolling(range: Interval, count: usize, turn: bool, rules: &TableRules, kind: AxisKind) -> Vec<f64> {
    if turn {
        return equal(range, count + 1);
    }
    let (min, max, min_step) = (range.min.min(0.0), range.max.max(0.0), rules.increment.min_position(kind));
    let step = min_step * libm::ceil((max - min) / count.saturating_sub(2).max(1) as f64 / min_step - 1e-6);
    let last = libm::ceil(max / step - 1e-9) as i64;
    (last + 1 - count as i64..=last).map(|i| i as f64 * step).collect()
}

/// Values in the columns of a table at a position, and the number that the controller stores for a value.
pub(super) struct ColumnValues<'a> {
    pub value: &'a dyn Fn(f64) -> Vec<f64>,
    pub stored: &'a dyn Fn(f64) -> f64,
}

/// Candidates, with the residual of straight lines between stored numbers.
struct Loss<'a> {
    positions: &'a [f64],
    rows: &'a [Vec<f64>],
    stored: &'a [Vec<f64>],
}

impl Loss<'_> {
    /// Returns the sum of squared residuals between two points that are kept, weighted by the travel of each candidate.
    fn between(&self, low: usize, high: usize) -> f64 {
        let span = self.positions[high] - self.positions[low];
        let residual = |i: usize| {
            let fraction = (self.positions[i] - self.positions[low]) / span;
            let columns = self.rows[i].iter().zip(&self.stored[low]).zip(&self.stored[high]);
            let square = columns.map(|((v, a), b)| v - a - (b - a) * fraction).map(|e| e * e).sum::<f64>();
            square * 0.5 * (self.positions[i + 1] - self.positions[i - 1])
        };
        (low + 1..high).map(residual).sum()
    }

    /// Returns the increase of the sum of squares if a kept point is removed.
    fn worth(&self, kept: &[usize], at: usize) -> f64 {
        let (before, here, after) = (kept[at - 1], kept[at], kept[at + 1]);
        self.between(before, after) - self.between(before, here) - self.between(here, after)
    }

    /// Returns the gain and the index of the best further point between two points. Of many places, every n-th is tried
    /// first, then those about the best of them.
    fn best(&self, low: usize, high: usize) -> Option<(f64, usize)> {
        let whole = self.between(low, high);
        let gain = |i: usize| (whole - self.between(low, i) - self.between(i, high), i);
        let of = |places: &mut dyn Iterator<Item = usize>| places.map(gain).max_by(|a, b| a.0.total_cmp(&b.0));
        let stride = (high - low).div_ceil(LOOKED_AT);
        let found = of(&mut (low + 1..high).step_by(stride))?;
        let (from, to) = ((found.1 + 1).saturating_sub(stride).max(low + 1), (found.1 + stride).min(high));
        if stride == 1 { Some(found) } else { of(&mut (from..to)) }
    }
}

/// Places between two points that are looked at for another one.
const LOOKED_AT: usize = 512;

/// Number of candidates of which the best choice is found. Where more points than these are kept, a choice matters
/// little.
const TRIED: usize = 192;

/// Maximum number of rounds of improvement.
const ROUNDS: usize = 20;

/// Chooses the rising positions to keep, so that straight lines between the stored numbers, as the controller draws
/// them, have the smallest sum of squared residuals. First the candidate that costs the least is removed, again and
/// again, until there are few. The best choice of these is then found (Bellman 1961). In the end each point is moved
/// between its neighbours, as long as that lowers the sum.
pub(super) fn place(positions: &[f64], rows: &[Vec<f64>], stored: &[Vec<f64>], max_points: usize) -> Vec<usize> {
    let loss = Loss { positions, rows, stored };
    let max_points = max_points.max(2);
    let thinned = thin(&loss, max_points.max(TRIED));
    let mut kept = if thinned.len() > max_points { choose(&loss, &thinned, max_points) } else { thinned };
    for _ in 0..ROUNDS {
        if !slide(&loss, &mut kept) {
            break;
        }
    }
    kept
}

/// Cost of removing a candidate, and its index. The cheapest is the greatest; of equal ones every other goes before the
/// next, so that no gap outgrows the others on a straight curve.
#[derive(PartialEq)]
struct Cost(f64, usize);

impl Eq for Cost {}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let order = |at: usize| (at.trailing_zeros(), at);
        other.0.total_cmp(&self.0).then(order(other.1).cmp(&order(self.1)))
    }
}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// A sum of squares (mm or deg squared, per mm or deg of travel) below this is rounding: a thousandth of the finest
/// increment.
const NOTHING: f64 = 1e-24;

/// Removes candidates until `max_points` remain.
fn thin(loss: &Loss, max_points: usize) -> Vec<usize> {
    let count = loss.positions.len();
    // Neighbours of each remaining candidate, and its cost.
    let mut before: Vec<usize> = (0..count).map(|at| at.saturating_sub(1)).collect();
    let mut after: Vec<usize> = (1..=count).collect();
    let mut costs: Vec<Option<f64>> = vec![None; count];
    let mut queue = BinaryHeap::new();
    let mut remaining = count;
    let within = |at: usize| at > 0 && at + 1 < count;
    let cost = |low: usize, at: usize, high: usize| {
        let cost = loss.worth(&[low, at, high], 1);
        if cost.abs() < NOTHING * (loss.positions[high] - loss.positions[low]) { 0.0 } else { cost }
    };
    for at in (0..count).filter(|at| within(*at)) {
        let cost = cost(at - 1, at, at + 1);
        costs[at] = Some(cost);
        queue.push(Cost(cost, at));
    }
    while remaining > max_points {
        let Some(Cost(known, at)) = queue.pop() else { break };
        // An entry queued before a neighbour was removed has another cost now.
        if costs[at].is_none_or(|cost| cost.total_cmp(&known).is_ne()) {
            continue;
        }
        costs[at] = None;
        remaining -= 1;
        let (low, high) = (before[at], after[at]);
        (after[low], before[high]) = (high, low);
        for at in [low, high].into_iter().filter(|at| within(*at)) {
            let cost = cost(before[at], at, after[at]);
            costs[at] = Some(cost);
            queue.push(Cost(cost, at));
        }
    }
    (0..count).filter(|at| !within(*at) || costs[*at].is_some()).collect()
}

/// Returns the choice of `max_points` (at least 2) out of more candidates, both ends among them, with the smallest sum
/// of squares.
fn choose(loss: &Loss, candidates: &[usize], max_points: usize) -> Vec<usize> {
    let last = candidates.len() - 1;
    let between: Vec<Vec<f64>> =
        (0..=last).map(|high| (0..high).map(|low| loss.between(candidates[low], candidates[high])).collect()).collect();
    // Smallest sum up to a candidate by this number of intervals, and the candidate before it.
    let mut lowest: Vec<f64> = (0..=last).map(|at| if at == 0 { 0.0 } else { f64::INFINITY }).collect();
    let mut before: Vec<Vec<usize>> = Vec::new();
    for _ in 1..max_points {
        let best = |high: usize| {
            let choices = (0..high).map(|low| (lowest[low] + between[high][low], low));
            choices.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0))
        };
        let (sums, lows) = (0..=last).map(best).unzip();
        lowest = sums;
        before.push(lows);
    }
    let mut kept = vec![last];
    for lows in before.iter().rev() {
        kept.push(lows[kept[kept.len() - 1]]);
    }
    kept.into_iter().rev().map(|at| candidates[at]).collect()
}

/// Smaller gains are rounding.
const GAIN: f64 = 1e-9;

/// Moves every point between its neighbours to the smallest sum of squares.
fn slide(loss: &Loss, kept: &mut [usize]) -> bool {
    let mut moved = false;
    for at in 1..kept.len().saturating_sub(1) {
        let worth = loss.worth(kept, at);
        let span = loss.positions[kept[at + 1]] - loss.positions[kept[at - 1]];
        if let Some((gain, best)) = loss.best(kept[at - 1], kept[at + 1])
            && gain > worth * (1.0 + GAIN) + NOTHING * span
        {
            kept[at] = best;
            moved = true;
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::{Loss, place};

    #[test]
    fn corners_of_a_broken_line_stay() {
        let positions: Vec<f64> = (0..=100).map(f64::from).collect();
        let corners = [(0.0, 0.0), (17.0, 3.0), (40.0, -2.0), (41.0, 5.0), (100.0, 1.0)];
        let line = |q: f64| {
            let i = corners.iter().rposition(|c| c.0 <= q).unwrap().min(corners.len() - 2);
            let ((a, x), (b, y)) = (corners[i], corners[i + 1]);
            vec![x + (y - x) * (q - a) / (b - a)]
        };
        let rows: Vec<Vec<f64>> = positions.iter().map(|q| line(*q)).collect();
        assert_eq!(place(&positions, &rows, &rows, 5), [0, 17, 40, 41, 100]);
        assert_eq!(place(&positions, &rows, &rows, 2), [0, 100]);
    }

    /// Where nothing is lost with any choice, points are spread, and rounding does not crowd them together.
    #[test]
    fn straight_curves_keep_points_everywhere() {
        let positions: Vec<f64> = (0..=1000).map(f64::from).collect();
        for slope in [0.0, 1e-6, 0.3e-6] {
            let rows: Vec<Vec<f64>> = positions.iter().map(|q| vec![5e-3 + slope * q, 8e-3 - slope * q]).collect();
            let kept = place(&positions, &rows, &rows, 256);
            let widest = kept.windows(2).map(|pair| pair[1] - pair[0]).max();
            assert!(kept.len() == 256 && widest <= Some(8), "{slope}: {widest:?}");
        }
    }

    fn total(loss: &Loss, kept: &[usize]) -> f64 {
        kept.windows(2).map(|pair| loss.between(pair[0], pair[1])).sum()
    }

    /// No choice of the same number of points has a smaller sum: all are tried, on curves with noise and coarse
    /// storage.
    #[test]
    fn nothing_leaves_less() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for _ in 0..20 {
            let mut positions = vec![0.0];
            while positions.len() < 14 {
                positions.push(positions[positions.len() - 1] + 0.2 + random());
            }
            let rows: Vec<Vec<f64>> =
                positions.iter().map(|q| vec![libm::sin(0.7 * q) + 0.3 * random(), 0.1 * q * q]).collect();
            let stored: Vec<Vec<f64>> =
                rows.iter().map(|row| row.iter().map(|x| libm::round(x * 20.0) / 20.0).collect()).collect();
            let loss = Loss { positions: &positions, rows: &rows, stored: &stored };
            let minimum = (0_u32..1 << 12).filter(|set| set.count_ones() == 4).map(|set| {
                let inner = (0..12).filter(|bit| set >> bit & 1 == 1).map(|bit| bit as usize + 1);
                let kept: Vec<usize> = std::iter::once(0).chain(inner).chain([13]).collect();
                total(&loss, &kept)
            });
            let found = total(&loss, &place(&positions, &rows, &stored, 6));
            let minimum = minimum.fold(f64::INFINITY, f64::min);
            // Sums of six terms, in another order.
            assert!((found - minimum).abs() <= 1e-14 * minimum, "{found} {minimum}");
        }
    }
}
