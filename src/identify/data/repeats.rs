//! Poses that were measured more than once: how well they repeat, and whether they contradict each other.

use super::measurement::{Measurement, Reading, ReadingKind};
use crate::identify::thresholds::*;
use std::collections::BTreeMap;

/// Repeatability of readings of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// Kind of the readings.
    pub of: ReadingKind,
    /// Standard deviation of a reading of weight 1 (mm).
    pub sigma: f64,
    /// Degrees of freedom that it rests on.
    pub degrees_of_freedom: usize,
    /// The two rows of one pose whose readings differ most, and by how much (mm).
    pub worst: (usize, usize, f64),
    /// True if the others differ far less.
    pub contradict: bool,
    /// True if first and last readings are each other's negative.
    pub opposed: bool,
}

#[derive(Debug, Clone, Copy, Default)]
struct RepeatReading {
    row: usize,
    /// mm.
    value: f64,
    root_weight: f64,
}

/// Returns pose, tool and side of a row as bits; -0 and 0 are the same position.
fn key(m: &Measurement) -> impl Iterator<Item = u64> {
    m.pose.iter().map(|q| (q + 0.0).to_bits()).chain([m.tool as u64, m.approach as u64])
}

/// Groups readings of one component (absolute, or of one run) in one pose, from one side, with one tool. There may be
/// millions of rows: they are sorted, and a pose that was measured once takes no memory.
fn groups(data: &[Measurement], kind: ReadingKind) -> Vec<Vec<RepeatReading>> {
    let mut rows: Vec<usize> = (0..data.len()).filter(|row| data[*row].kind() == kind).collect();
    rows.sort_by(|a, b| key(&data[*a]).cmp(key(&data[*b])));
    let poses = rows.chunk_by(|a, b| key(&data[*a]).eq(key(&data[*b])));
    poses.filter(|rows| rows.len() > 1).flat_map(|rows| of_pose(data, rows)).filter(|group| group.len() > 1).collect()
}

fn of_pose(data: &[Measurement], rows: &[usize]) -> impl Iterator<Item = Vec<RepeatReading>> {
    let mut groups: BTreeMap<(usize, Option<usize>), Vec<RepeatReading>> = BTreeMap::new();
    for (row, m) in rows.iter().map(|row| (*row, &data[*row])) {
        let (values, zero) = match &m.reading {
            Reading::Deviation { values, zero, .. } => (*values, *zero),
            Reading::Position { value, frame, .. } => (<[f64; 3]>::from(*value).map(Some), [Some(*frame); 3]),
            _ => continue,
        };
        for k in 0..3 {
            let one = values[k].map(|value| RepeatReading { row, value, root_weight: libm::sqrt(m.weight) });
            one.into_iter().for_each(|one| groups.entry((k, zero[k])).or_default().push(one));
        }
    }
    groups.into_values()
}

/// Returns the weighted sum of squares about the mean (mm^2).
fn squares(group: &[RepeatReading]) -> f64 {
    let weight: f64 = group.iter().map(|r| r.root_weight * r.root_weight).sum();
    let mean = group.iter().map(|r| r.value * r.root_weight * r.root_weight).sum::<f64>() / weight;
    group.iter().map(|r| (r.value - mean) * (r.value - mean) * r.root_weight * r.root_weight).sum()
}

/// Returns the least and the greatest of a group, and their difference in standard deviations of weight 1.
fn range_of(group: &[RepeatReading]) -> (RepeatReading, RepeatReading, f64) {
    let by_value = |a: &&RepeatReading, b: &&RepeatReading| a.value.total_cmp(&b.value);
    let least = group.iter().min_by(by_value).copied().unwrap_or_default();
    let most = group.iter().max_by(by_value).copied().unwrap_or_default();
    (least, most, (most.value - least.value) / libm::hypot(1.0 / least.root_weight, 1.0 / most.root_weight))
}

/// Returns the repeatability at poses that were measured more than once, by kind of reading.
pub fn repeats(data: &[Measurement]) -> Vec<Repeats> {
    [ReadingKind::Deviation, ReadingKind::Relative, ReadingKind::Position]
        .into_iter()
        .filter_map(|kind| repeats_of(data, kind))
        .collect()
}

fn repeats_of(data: &[Measurement], of: ReadingKind) -> Option<Repeats> {
    let groups = groups(data, of);
    let (mut sum, mut degrees_of_freedom) = (0.0, 0);
    for group in &groups {
        sum += squares(group);
        degrees_of_freedom += group.len() - 1;
    }
    let farther = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
    let sizes = groups.iter().map(|group| range_of(group).2).enumerate();
    let (widest, size) = sizes.reduce(farther)?;
    let (least, most, _) = range_of(&groups[widest]);
    let others_freedom = degrees_of_freedom + 1 - groups[widest].len();
    let others = libm::sqrt((sum - squares(&groups[widest])).max(0.0) / others_freedom.max(1) as f64);
    Some(Repeats {
        of,
        sigma: libm::sqrt(sum / degrees_of_freedom as f64),
        degrees_of_freedom,
        worst: (least.row.min(most.row), least.row.max(most.row), most.value - least.value),
        contradict: others_freedom >= MIN_OTHER_REPEATS && others > 0.0 && size > CONTRADICTION_DEVIATIONS * others,
        opposed: have_opposite_signs(&groups),
    })
}

/// True if first and last readings of the groups are each other's negative, as those of files with unlike signs are.
fn have_opposite_signs(groups: &[Vec<RepeatReading>]) -> bool {
    let ends = groups.iter().filter_map(|group| Some((group.first()?.value, group.last()?.value)));
    let (mut product, mut first, mut last) = (0.0, 0.0, 0.0);
    for (a, b) in ends {
        product += a * b;
        first += a * a;
        last += b * b;
    }
    groups.len() >= MIN_REPEATED_POSES && product < OPPOSITE_SIGN_CORRELATION * libm::sqrt(first * last)
}
