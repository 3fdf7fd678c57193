//! What the order of the rows and the places of the readings say: which are one target, where a pass begins and
//! ends, from which side its targets were approached, and on a turning axis which end meets which.

use super::sample::{AxisSample, Import};
use crate::identify::thresholds::{MAX_TARGET_SCATTER, MIN_STEP_OVER_SCATTER, SAME_TARGET};
use crate::syntax::ColumnDirection;
use indexmap::IndexMap;

/// Moves the positions of all readings to their targets; returns how near to a target counts as on it.
pub(crate) fn merge(samples: &mut [AxisSample]) -> f64 {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by(|a, b| samples[*a].position.total_cmp(&samples[*b].position));
    let sorted: Vec<f64> = order.iter().map(|i| samples[*i].position).collect();
    let width = gap_within(&sorted);
    let mut start = 0;
    for group in sorted.chunk_by(|a, b| b - a <= width) {
        let at = target(group);
        order[start..start + group.len()].iter().for_each(|i| samples[*i].position = at);
        start += group.len();
    }
    if width > SAME_TARGET { MAX_TARGET_SCATTER } else { SAME_TARGET }
}

/// Returns the widest gap between neighbours that belong to one target.
fn gap_within(sorted: &[f64]) -> f64 {
    let mut gaps: Vec<f64> = sorted.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > SAME_TARGET).collect();
    gaps.sort_by(f64::total_cmp);
    let widest = |gap: f64| {
        let groups = sorted.chunk_by(|a, b| b - a <= gap);
        groups.map(|g| g[g.len() - 1] - g[0]).fold(0.0, f64::max)
    };
    let fits = |w: &&[f64]| {
        let most = (w[1] / MIN_STEP_OVER_SCATTER).min(MAX_TARGET_SCATTER);
        w[0] <= most && widest(w[0]) <= most
    };
    gaps.windows(2).rev().find(fits).map_or(SAME_TARGET, |w| w[0])
}

/// Returns the position of readings of one target: of all numbers between them the roundest.
fn target(group: &[f64]) -> f64 {
    let (low, high) = (group[0], group[group.len() - 1]);
    let mean = group.iter().sum::<f64>() / group.len() as f64;
    let rounded = |scale: f64| libm::round(mean * scale) / scale;
    let mut round = (0..10).map(|digits| rounded(libm::pow(10.0, f64::from(digits))));
    if low == high { low } else { round.find(|at| (low..=high).contains(at)).unwrap_or(mean) }
}

/// True if named runs take turns in the rows, reading by reading: the rows are then sorted, and not in the order of
/// time.
pub(crate) fn take_turns<'s>(samples: impl Iterator<Item = &'s AxisSample>) -> bool {
    let mut runs: Vec<&str> = samples.map(|sample| sample.run.as_str()).collect();
    runs.dedup();
    let count = runs.len();
    runs.sort_unstable();
    runs.dedup();
    runs.len() > 1 && runs.len() < count
}

/// True if the rows of an error show there and back within its runs, which gives the directions.
pub(crate) fn go_there_and_back(samples: &[AxisSample], error: usize) -> bool {
    ways(samples, &passes_of(samples, error)).is_some()
}

/// Gives the runs of an error alternating directions, forward first: two passes are one run.
pub(crate) fn alternate(samples: &mut [AxisSample], error: usize) {
    let mut runs: IndexMap<String, ()> = IndexMap::new();
    for sample in samples.iter_mut().filter(|sample| sample.error == error) {
        let pass = runs.insert_full(sample.run.clone(), ()).0;
        sample.direction =
            Some(if pass.is_multiple_of(2) { ColumnDirection::Forward } else { ColumnDirection::Reverse });
        sample.run = (pass / 2 + 1).to_string();
    }
}

/// Finds the passes of every error, numbers those without a name, and infers directions where none is known.
pub(crate) fn passes(import: &mut Import) {
    for error in 0..import.errors.len() {
        let passes = passes_of(&import.samples, error);
        let ways = if passes.iter().flatten().any(|i| import.samples[*i].direction.is_some()) {
            None
        } else {
            ways(&import.samples, &passes)
        };
        import.inferred |= ways.is_some();
        number(&mut import.samples, &passes, ways.as_deref());
    }
}

/// Returns the readings of one error, as indices, by pass: within each run (and direction, if it is known), up to where
/// the position jumps back to the start.
fn passes_of(samples: &[AxisSample], error: usize) -> Vec<Vec<usize>> {
    let mut runs: IndexMap<(&str, Option<bool>), Vec<usize>> = IndexMap::new();
    let mut targets = Vec::new();
    for (i, sample) in samples.iter().enumerate().filter(|(_, sample)| sample.error == error) {
        let way = sample.direction.map(|way| way == ColumnDirection::Forward);
        runs.entry((&sample.run, way)).or_default().push(i);
        targets.push(sample.position);
    }
    targets.sort_by(f64::total_cmp);
    targets.dedup();
    let step = |at: f64| targets.partition_point(|target| *target < at);
    let mut passes = Vec::new();
    for run in runs.into_values() {
        let steps: Vec<usize> = run.iter().map(|i| step(samples[*i].position)).collect();
        let starts = starts(&steps);
        let ends = starts.iter().skip(1).copied().chain([run.len()]);
        passes.extend(starts.iter().zip(ends).map(|(start, end)| run[*start..end].to_vec()));
    }
    passes
}

/// Returns the indices at which passes begin, of readings at targets by number. A step to the next target is a measured
/// one; a step back over several targets to the start of the pass, or beyond, is not.
fn starts(targets: &[usize]) -> Vec<usize> {
    // Of two targets in turns a pass has two readings; there and back, the far one would be read twice.
    let alternates = |pair: &[usize]| pair == &targets[..2] && pair[0] != pair[1];
    if targets.len() >= 4 && targets.chunks(2).all(alternates) {
        return (0..targets.len()).step_by(2).collect();
    }
    // The index at which the present way began, and its direction once it is known.
    let (mut starts, mut way_start, mut rising) = (vec![0], 0, None);
    for k in 1..targets.len() {
        let (before, now) = (targets[k - 1], targets[k]);
        if before == now {
            continue;
        }
        let up = now > before;
        let turns_back = rising.is_some_and(|rising: bool| rising != up);
        let reaches_start = if up { now >= targets[way_start] } else { now <= targets[way_start] };
        if turns_back && reaches_start && before.abs_diff(now) > 1 {
            starts.push(k);
            (way_start, rising) = (k, None);
        } else {
            way_start = if turns_back { k - 1 } else { way_start };
            rising = Some(up);
        }
    }
    starts
}

/// Returns the direction of approach of every reading by pass; `None` unless both directions were measured and all are
/// known.
fn ways(samples: &[AxisSample], passes: &[Vec<usize>]) -> Option<Vec<Vec<ColumnDirection>>> {
    let mut all: Vec<Vec<ColumnDirection>> = Vec::new();
    for pass in passes {
        let at: Vec<f64> = pass.iter().map(|i| samples[*i].position).collect();
        let same_run = |last: &&usize| samples[**last].run == samples[pass[0]].run;
        let before = passes.get(all.len().wrapping_sub(1)).and_then(|last| last.last()).filter(same_run);
        // One reading after a jump back goes on as before.
        let only = before.and(all.last()).and_then(|ways| ways.last()).copied();
        all.push(ways_of(&at).or_else(|| Some(vec![only?; pass.len()]))?);
    }
    let both = [ColumnDirection::Forward, ColumnDirection::Reverse];
    both.iter().all(|way| all.iter().flatten().any(|known| known == way)).then_some(all)
}

/// Returns the directions of one pass: there and back, as lasers measure. At a turning point the target is measured
/// twice, or once: then it belongs to the way that ends there.
fn ways_of(at: &[f64]) -> Option<Vec<ColumnDirection>> {
    let way = |step: f64| if step > 0.0 { ColumnDirection::Forward } else { ColumnDirection::Reverse };
    let steps: Vec<f64> = at.windows(2).map(|w| w[1] - w[0]).collect();
    let last = steps.iter().rev().find(|step| **step != 0.0)?;
    let one = |k: usize| match k.checked_sub(1).map(|k| steps[k]) {
        Some(step) if step != 0.0 => way(step),
        _ => way(*steps[k..].iter().find(|step| **step != 0.0).unwrap_or(last)),
    };
    Some((0..at.len()).map(one).collect())
}

/// Numbers the runs, if the file names none: every way back and forth is one.
fn number(samples: &mut [AxisSample], passes: &[Vec<usize>], ways: Option<&[Vec<ColumnDirection>]>) {
    let mut run = 0;
    for (k, pass) in passes.iter().enumerate() {
        let mut seen: Vec<ColumnDirection> = Vec::new();
        run += 1;
        for (j, i) in pass.iter().enumerate() {
            let way = ways.map(|ways| ways[k][j]);
            if let Some(way) = way.filter(|way| seen.last() != Some(way)) {
                if seen.len() == 2 {
                    run += 1;
                    seen.clear();
                }
                seen.push(way);
            }
            let sample = &mut samples[*i];
            sample.direction = sample.direction.or(way);
            if sample.run.is_empty() {
                sample.run = run.to_string();
            }
        }
    }
}

/// Takes positions modulo 360 deg. Two readings of one run a whole turn apart become their mean: the seam.
pub(crate) fn wrap(samples: &mut Vec<AxisSample>, near: f64) {
    let programmed: Vec<f64> = samples.iter().map(|sample| sample.position).collect();
    for sample in samples.iter_mut() {
        let position = sample.position.rem_euclid(360.0);
        sample.position = if position >= 360.0 - near { position - 360.0 } else { position };
    }
    // -0.3 and 359.7 are one place, but for arithmetic.
    merge(samples);
    let place = |sample: &AxisSample| (sample.error, sample.direction.map(|way| way as u8), sample.position.to_bits());
    let mut count: IndexMap<_, usize> = IndexMap::new();
    let mut readings: IndexMap<_, Vec<AxisSample>> = IndexMap::new();
    for (sample, programmed) in samples.drain(..).zip(programmed) {
        let key = (place(&sample), sample.run.clone());
        let times = count.entry((key.clone(), programmed.to_bits())).or_default();
        *times += 1;
        readings.entry((key, *times)).or_default().push(sample);
    }
    let mean = |group: Vec<AxisSample>| {
        let value = group.iter().map(|sample| sample.value).sum::<f64>() / group.len() as f64;
        group.into_iter().next().map(|first| AxisSample { value, ..first })
    };
    samples.extend(readings.into_values().filter_map(mean));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_ends_where_the_position_jumps_back_over_targets() {
        assert_eq!(starts(&[0, 1, 2, 0, 1, 2, 0, 1, 2]), [0, 3, 6]);
        assert_eq!(starts(&[2, 1, 0, 2, 1, 0]), [0, 3]);
        // There and back is one pass, whether turning points are measured once or twice.
        assert_eq!(starts(&[0, 1, 2, 2, 1, 0, 0, 1, 2]), [0]);
        assert_eq!(starts(&[0, 1, 2, 1, 0, 1, 2]), [0]);
        // A missing reading on the way back is no jump, nor is one on the way there.
        assert_eq!(starts(&[0, 1, 2, 3, 3, 1, 0]), [0]);
        assert_eq!(starts(&[0, 2, 3, 3, 2, 1, 0]), [0]);
        assert_eq!(starts(&[5]), [0]);
        assert_eq!(starts(&[0, 1, 0, 1, 0, 1]), [0, 2, 4]);
        assert_eq!(starts(&[0, 1, 1, 0, 0, 1, 1, 0]), [0]);
    }

    #[test]
    fn targets_are_told_from_scatter() {
        assert_eq!(gap_within(&[0.0, 0.0003, 0.0004, 100.0, 100.02]), 100.02 - 100.0);
        assert_eq!(gap_within(&[0.0, 0.001, 0.002, 0.003]), SAME_TARGET);
        // A far target makes no scatter of even steps: they are too wide together.
        let even: Vec<f64> = (0..60).map(|i| f64::from(i) * 1e-3).chain([100.0]).collect();
        assert_eq!(gap_within(&even), SAME_TARGET);
        assert_eq!((target(&[-1e-4, 2e-4]), target(&[99.9, 99.9]), target(&[1.24, 1.26])), (0.0, 99.9, 1.25));
    }
}
