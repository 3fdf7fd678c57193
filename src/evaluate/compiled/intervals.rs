//! The interval of a table in which a position lies, and the fraction of the interval that lies below the position.
//!
//! The index of a uniform interval is a product. Measured tables are not uniform (ISO 230-2 asks for targets at uneven
//! steps): their range is divided into buckets of one length, few enough to stay in the cache and short enough that
//! each holds at most one knot. A bucket has a row with the two intervals that meet in it, read as the rows of the
//! table are. Knots too close together for that are found by a binary search within the bucket.

use super::simd::{Lanes, MAX_LANES, RowVector, TableRow};

/// The method by which the interval of a position is found.
#[derive(Debug, Clone, PartialEq)]
pub enum KnotIntervals {
    /// Intervals of one length: intervals per mm or deg, the index of the last, and the length.
    Uniform { per_unit: f64, last: f64, width: f64 },
    /// One row per bucket: its knot (infinity if it has none); begin, inverse length and length of the interval in
    /// which the bucket begins; inverse length and length of the interval that begins at the knot; and the index of the
    /// first of the two.
    Bucketed { buckets: Buckets, rows: Vec<TableRow> },
    /// The interval at the start of each bucket, and a binary search up to that of the next.
    Searched { buckets: Buckets, starts: Vec<u32>, knots: Vec<f64> },
}

/// Division of a table's range into buckets of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Buckets {
    per_unit: f64,
    last: f64,
}

impl Buckets {
    fn new(count: usize, span: f64) -> Self {
        Self { per_unit: count as f64 / span, last: (count - 1) as f64 }
    }

    /// Returns the indices of the buckets at distances (mm or deg) from the first knot.
    #[inline(always)]
    pub fn indices<V: Lanes>(&self, distance: V) -> [u32; MAX_LANES] {
        (distance * V::splat(self.per_unit)).smaller(V::splat(self.last)).truncate().1
    }
}

/// Positions within their intervals, lane by lane.
#[derive(Debug, Clone, Copy)]
pub struct IntervalPoint<V> {
    /// Index of the interval.
    pub interval: [u32; MAX_LANES],
    /// Distance from the lower knot, divided by the length of the interval.
    pub fraction: V,
    /// Length of the interval (mm or deg).
    pub width: V,
}

const MAX_BUCKETS_PER_INTERVAL: usize = 4;

/// Maximum number of buckets of a searched table.
const MAX_SEARCH_BUCKETS: usize = 1 << 20;

impl KnotIntervals {
    /// Returns the cheapest method for these knots: at least two, in rising order.
    pub fn new(knots: &[f64]) -> Self {
        let count = knots.len() - 1;
        let (first, span) = (knots[0], knots[count] - knots[0]);
        let uniform = |i: usize| first + span * (i as f64 / count as f64);
        if knots.iter().enumerate().all(|(i, q)| (q - uniform(i)).abs() <= 8.0 * f64::EPSILON * span) {
            return Self::Uniform {
                per_unit: count as f64 / span,
                last: (count - 1) as f64,
                width: span / count as f64,
            };
        }
        let mut buckets = count;
        while buckets <= MAX_BUCKETS_PER_INTERVAL * count {
            if let Some(rows) = (0..buckets).map(|index| Bucket { index, count: buckets }.row(knots)).collect() {
                return Self::Bucketed { buckets: Buckets::new(buckets, span), rows };
            }
            buckets += buckets.div_ceil(4);
        }
        let buckets = (2 * count).min(MAX_SEARCH_BUCKETS);
        let start = |index| interval(knots, Bucket { index, count: buckets }.start(knots)) as u32;
        let starts = (0..=buckets).map(start).collect();
        Self::Searched { buckets: Buckets::new(buckets, span), starts, knots: knots.to_vec() }
    }
}

/// One of `count` buckets over the range of the knots.
#[derive(Debug, Clone, Copy)]
struct Bucket {
    index: usize,
    count: usize,
}

impl Bucket {
    fn start(self, knots: &[f64]) -> f64 {
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        first + (last - first) * (self.index as f64 / self.count as f64)
    }

    /// Returns the row of the bucket; `None` if it holds two knots.
    fn row(self, knots: &[f64]) -> Option<TableRow> {
        let (i, end) = (interval(knots, self.start(knots)), Self { index: self.index + 1, ..self }.start(knots));
        let (low, knot) = (knots[i], knots[i + 1]);
        let width = knot - low;
        let without_knot = [f64::INFINITY, low, 1.0 / width, width, 0.0, 0.0, i as f64, 0.0];
        match knots.get(i + 2) {
            Some(next) if knot < end => {
                let next_width = next - knot;
                let with_knot = [knot, low, 1.0 / width, width, 1.0 / next_width, next_width, i as f64, 0.0];
                (*next >= end).then_some(TableRow(with_knot))
            }
            _ => Some(TableRow(without_knot)),
        }
    }
}

/// Returns the index of the interval that holds a position.
fn interval(knots: &[f64], x: f64) -> usize {
    knots.partition_point(|q| *q <= x).saturating_sub(1).min(knots.len() - 2)
}

/// Finds positions `x` by the rows of their buckets, none of which holds two knots.
#[inline(always)]
pub fn find_by_bucket<V: Lanes>(rows: &[TableRow], buckets: &[u32; MAX_LANES], x: V) -> IntervalPoint<V> {
    let mut read = [V::Row::of(&rows[0]); MAX_LANES];
    for lane in 0..V::COUNT {
        read[lane] = V::Row::of(&rows[buckets[lane] as usize]);
    }
    let [knot, low, low_inverse, low_width, high_inverse, high_width, index, _] = V::transpose(&read);
    let fraction = (x - x.select_less(knot, low, knot)) * x.select_less(knot, low_inverse, high_inverse);
    let (_, interval) = x.select_less(knot, index, index + V::splat(1.0)).truncate();
    IntervalPoint { interval, fraction, width: x.select_less(knot, low_width, high_width) }
}

/// Finds the first `count` positions one by one, by a binary search from the start of their bucket.
#[inline(never)]
pub fn find_by_search(
    starts: &[u32],
    knots: &[f64],
    buckets: &[u32; MAX_LANES],
    positions: &[f64; MAX_LANES],
    count: usize,
) -> IntervalPoint<[f64; MAX_LANES]> {
    let (mut interval, mut fraction, mut width) = ([0; MAX_LANES], [0.0; MAX_LANES], [0.0; MAX_LANES]);
    for lane in 0..count {
        let (bucket, x) = (buckets[lane] as usize, positions[lane]);
        let (low, high) = (starts[bucket] as usize, starts[bucket + 1] as usize);
        let i = low + knots[low + 1..=high].partition_point(|q| *q <= x);
        let h = knots[i + 1] - knots[i];
        (interval[lane], fraction[lane], width[lane]) = (i as u32, (x - knots[i]) / h, h);
    }
    IntervalPoint { interval, fraction, width }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns interval and fraction of a position by looking through all knots.
    fn looked_through(knots: &[f64], x: f64) -> (usize, f64) {
        let i = (0..knots.len() - 1).rev().find(|i| knots[*i] <= x).unwrap_or(0);
        (i, (x - knots[i]) / (knots[i + 1] - knots[i]))
    }

    /// At all knots and between them: place along the knots, counted in intervals, for at a knot either side will do.
    fn agrees(knots: &[f64], find: impl Fn(f64) -> (u32, f64, f64)) {
        let between = |k: usize| (0..=16).map(move |n| knots[k] + (knots[k + 1] - knots[k]) * f64::from(n) / 16.0);
        for x in (0..knots.len() - 1).flat_map(between).filter(|x| *x <= knots[knots.len() - 1]) {
            let ((i, share), (found, part, width)) = (looked_through(knots, x), find(x));
            // The position is rounded before it is divided by the interval.
            let tolerance = 4.0 * f64::EPSILON * (1.0 + x.abs() / width);
            assert!((f64::from(found) + part - i as f64 - share).abs() <= tolerance, "{x}: {i} {share} {found} {part}");
            let at = found as usize;
            assert_eq!(width, knots[at + 1] - knots[at]);
        }
    }

    fn jittered(count: usize) -> Vec<f64> {
        let jitter = |i: usize| (i * i * 7919 % 13) as f64 / 13.0 - 0.5;
        (0..count).map(|i| -40.0 + 25.0 * (i as f64 + 0.5 * jitter(i))).collect()
    }

    #[test]
    fn targets_of_iso_230_2_have_rows() {
        for count in [3, 21, 128, 4097] {
            let knots = jittered(count);
            let KnotIntervals::Bucketed { buckets, rows } = KnotIntervals::new(&knots) else { panic!("{count}") };
            assert!(rows.len() <= MAX_BUCKETS_PER_INTERVAL * count);
            agrees(&knots, |x| {
                let point = find_by_bucket(&rows, &buckets.indices(x - knots[0]), x);
                (point.interval[0], point.fraction, point.width)
            });
        }
    }

    #[test]
    fn knots_that_crowd_together_are_searched() {
        let mut knots = jittered(40);
        let middle = knots[20];
        knots.extend((1..5).map(|k| middle + f64::from(k) * 1e-6));
        knots.sort_by(f64::total_cmp);
        let KnotIntervals::Searched { buckets, starts, knots } = KnotIntervals::new(&knots) else {
            panic!("{knots:?}")
        };
        agrees(&knots, |x| {
            let point = find_by_search(&starts, &knots, &buckets.indices(x - knots[0]), &[x; MAX_LANES], 1);
            (point.interval[0], point.fraction[0], point.width[0])
        });
    }

    #[test]
    fn equal_steps_are_counted() {
        let knots: Vec<f64> = (0..=77).map(|i| 3.0 + 0.1 * f64::from(i)).collect();
        assert!(matches!(KnotIntervals::new(&knots), KnotIntervals::Uniform { .. }));
    }
}
