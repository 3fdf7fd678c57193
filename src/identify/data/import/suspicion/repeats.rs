//! Readings that repeat each other: the passes of one error, and what each reading is off its repeats.

use crate::identify::data::import::sample::AxisSample;
use crate::identify::thresholds::{JUDGING_LEVER_MM, MIN_REPEATED_READINGS};
use crate::machine::ErrorId;
use crate::syntax::ColumnDirection;
use indexmap::{IndexMap, IndexSet};

/// The upper quartile of the absolute value of a normal deviate, in standard deviations.
const QUARTILE_OVER_SIGMA: f64 = 1.1503;
/// Rounds in which levels of passes and of targets are found; medians settle in two or three.
const POLISH_ROUNDS: usize = 4;
/// Runs of a direction from which on its readings are compared with each other alone.
const OWN_REPEATS: usize = 3;

/// One reading: its index among the samples, target, pass, and the readings that it is compared with.
#[derive(Debug, Clone, Copy)]
pub(super) struct RepeatedReading {
    pub sample: usize,
    pub target: usize,
    pub pass: usize,
    pub group: usize,
    pub value: f64,
}

/// A pass: the readings of one run in one direction.
#[derive(Debug, Clone)]
pub(super) struct MeasuredPass {
    /// The run by the order of the file.
    pub run: usize,
    pub name: String,
    pub direction: Option<ColumnDirection>,
    /// Its first sample.
    pub first: usize,
}

impl MeasuredPass {
    /// Returns `run 3 forward`.
    pub fn words(&self) -> String {
        let way = match self.direction {
            Some(ColumnDirection::Forward) => " forward",
            Some(ColumnDirection::Reverse) => " reverse",
            None => "",
        };
        format!("run {}{way}", crate::diagnostic::shown(&self.name))
    }
}

/// The readings of one error by target and pass.
pub(super) struct Repeats {
    pub readings: Vec<RepeatedReading>,
    pub passes: Vec<MeasuredPass>,
    /// Positions of the targets, rising.
    pub targets: Vec<f64>,
    /// Number of runs.
    pub runs: usize,
    /// Steps (mm or rad) in which the readings are written.
    resolution: f64,
}

/// Distances of readings from their repeats.
pub(super) struct Deviations {
    /// Off the median of the other readings, levels of passes taken out; `None` without others.
    pub off: Vec<Option<f64>>,
    /// Robust standard deviation of these.
    pub scatter: f64,
    /// The same of a single reading.
    pub sigma: f64,
    /// The same where there are repeats, down to the arithmetic: finer than the steps of the readings.
    pub measured: Option<f64>,
    /// The level of each pass.
    pub levels: Vec<f64>,
}

/// Returns a limit of lengths (mm) as one of an error, mm or rad.
pub(super) fn least(error: &ErrorId, limit_mm: f64) -> f64 {
    if error.direction.is_rotation() { limit_mm / JUDGING_LEVER_MM } else { limit_mm }
}

/// Returns the median; zero of nothing.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n => (values[(n - 1) / 2] + values[n / 2]) / 2.0,
    }
}

/// Returns a standard deviation by the upper quartile of the sizes: a quarter of the values may be anything, and the
/// zeros that medians leave do not shrink it as they shrink the median.
pub(super) fn robust_sigma(values: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    sizes.get(sizes.len() * 3 / 4).map_or(0.0, |size| size / QUARTILE_OVER_SIGMA)
}

/// Returns the median of each group of values.
fn medians(count: usize, values: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut groups = vec![Vec::new(); count];
    values.for_each(|(group, value)| groups[group].push(value));
    groups.iter_mut().map(|group| median(group)).collect()
}

impl Repeats {
    /// Sorts the samples of an error.
    pub fn of(samples: &[AxisSample], error: usize) -> Self {
        let of_error = || samples.iter().enumerate().filter(|(_, sample)| sample.error == error);
        let mut targets: Vec<f64> = of_error().map(|(_, sample)| sample.position).collect();
        targets.sort_unstable_by(f64::total_cmp);
        targets.dedup();
        let mut runs: IndexSet<&str> = IndexSet::new();
        let mut passes: IndexMap<(&str, Option<u8>), MeasuredPass> = IndexMap::new();
        let mut readings = Vec::new();
        for (i, sample) in of_error() {
            let way = sample.direction.map(|way| way as u8);
            let (run, name, direction) = (runs.insert_full(&sample.run).0, sample.run.clone(), sample.direction);
            let entry = passes.entry((&sample.run, way));
            let pass = entry.index();
            let _ = entry.or_insert(MeasuredPass { run, name, direction, first: i });
            let target = targets.partition_point(|target| *target < sample.position);
            readings.push(RepeatedReading { sample: i, target, pass, group: target, value: sample.value });
        }
        let passes: Vec<MeasuredPass> = passes.into_values().collect();
        let ways: IndexSet<Option<u8>> = passes.iter().map(|pass| pass.direction.map(|way| way as u8)).collect();
        let of_way =
            |way: &Option<u8>| passes.iter().filter(|pass| pass.direction.map(|way| way as u8) == *way).count();
        if ways.iter().all(|way| of_way(way) >= OWN_REPEATS) {
            let way = |pass: usize| ways.get_index_of(&passes[pass].direction.map(|way| way as u8)).unwrap_or(0);
            readings.iter_mut().for_each(|reading| reading.group += targets.len() * way(reading.pass));
        }
        let resolution = resolution(&readings);
        let runs = runs.len();
        Self { readings, passes, targets, runs, resolution }
    }

    /// Compares the readings for which `used` is true.
    pub fn deviations(&self, used: &[bool]) -> Deviations {
        let groups = self.targets.len() * 3;
        let active = || self.readings.iter().zip(used).filter(|(_, used)| **used).map(|(reading, _)| reading);
        let mut levels = vec![0.0; self.passes.len()];
        for _ in 0..POLISH_ROUNDS {
            let middle = medians(groups, active().map(|r| (r.group, r.value - levels[r.pass])));
            levels = medians(self.passes.len(), active().map(|r| (r.pass, r.value - middle[r.group])));
        }
        let mut sorted: Vec<Vec<f64>> = vec![Vec::new(); groups];
        active().for_each(|r| sorted[r.group].push(r.value - levels[r.pass]));
        sorted.iter_mut().for_each(|group| group.sort_unstable_by(f64::total_cmp));
        let off = |(r, used): (&RepeatedReading, &bool)| {
            let (group, value) = (&sorted[r.group], r.value - levels[r.pass]);
            (*used && group.len() > 1).then(|| value - median_of_others(group, value))
        };
        let off: Vec<Option<f64>> = self.readings.iter().zip(used).map(off).collect();
        let measured = robust_sigma(off.iter().flatten().copied());
        let scatter = measured.max(self.resolution / 2.0);
        let compared = sorted.iter().filter(|group| group.len() > 1);
        let (count, sum) = compared.fold((0, 0), |(count, sum), group| (count + 1, sum + group.len()));
        let others = (sum as f64 / f64::from(count.max(1)) - 1.0).max(1.0);
        // The variance of a reading less the median of n others: 1 + 1, 1.5, 1.45, 1.3 ... for n = 1, 2, 3, 4.
        let of_one = libm::sqrt(1.0 + 1.2 / others);
        let measured = (sum >= MIN_REPEATED_READINGS).then_some(measured / of_one);
        Deviations { off, scatter, sigma: scatter / of_one, measured, levels }
    }

    /// Returns the median at every target of the readings of the passes that `takes` is true for, levels taken out.
    pub fn profile(&self, levels: &[f64], takes: impl Fn(usize) -> bool) -> Vec<Option<f64>> {
        let mut at = vec![Vec::new(); self.targets.len()];
        let taken = self.readings.iter().filter(|r| takes(r.pass));
        taken.for_each(|r| at[r.target].push(r.value - levels[r.pass]));
        at.iter_mut().map(|values| (!values.is_empty()).then(|| median(values))).collect()
    }

    /// Returns the two readings beside a reading in its pass, as their mean.
    pub fn neighbours(&self, of: &RepeatedReading) -> Option<f64> {
        let at = |target: usize| {
            let found = self.readings.iter().find(|r| r.pass == of.pass && r.target == target);
            found.map(|r| r.value)
        };
        let beside = [of.target.checked_sub(1).and_then(at), at(of.target + 1)];
        let known: Vec<f64> = beside.into_iter().flatten().collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    }
}

/// Returns the median of a sorted group without one of its values.
fn median_of_others(group: &[f64], value: f64) -> f64 {
    let own = group.partition_point(|other| *other < value);
    let at = |k: usize| group[if k < own { k } else { k + 1 }.min(group.len() - 1)];
    let n = group.len() - 1;
    (at((n - 1) / 2) + at(n / 2)) / 2.0
}

/// Returns the smallest step between readings, beyond the arithmetic.
fn resolution(readings: &[RepeatedReading]) -> f64 {
    let mut values: Vec<f64> = readings.iter().map(|r| r.value).collect();
    values.sort_unstable_by(f64::total_cmp);
    let steps = values.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 1e-9);
    steps.reduce(f64::min).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_others() {
        let group = [1.0, 2.0, 3.0, 10.0];
        let found: Vec<f64> = group.iter().map(|value| median_of_others(&group, *value)).collect();
        assert_eq!(found, [3.0, 3.0, 2.0, 2.0]);
        assert_eq!((median_of_others(&[1.0, 4.0], 1.0), median_of_others(&[1.0, 4.0], 4.0)), (4.0, 1.0));
        assert_eq!((median(&mut [3.0, 1.0, 2.0]), median(&mut [4.0, 1.0]), median(&mut [])), (2.0, 2.5, 0.0));
    }
}
