//! In which interval of a table a position lies, and its share of the upper end.
//!
//! Intervals of one length are counted. Those of measured tables are not of one length (ISO 230-2 wants targets at uneven steps): the
//! range is divided into cells of one length, few enough to stay in the cache and short enough that none has two knots in it. Then a cell
//! has a row with both intervals that meet in it, read as the rows of the table are. Where knots crowd together there is a search.

use super::simd::{Lanes, MOST, Pieces, Row};

/// How the interval of a position is found.
#[derive(Debug, Clone, PartialEq)]
pub enum Intervals {
    /// Of one length: intervals per mm or deg, the number of the last, and the length.
    Even { per_unit: f64, last: f64, width: f64 },
    /// A row for each cell: the knot in it, then begin, inverse length and length of the interval that the cell begins in, inverse length and
    /// length of the next one, which begins at the knot, and the number of the first. Infinity is no knot.
    Apart { cells: Cells, rows: Vec<Row> },
    /// The interval at the start of each cell, and a search up to that of the next.
    Crowded { cells: Cells, starts: Vec<u32>, knots: Vec<f64> },
}

/// Cells of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    per_unit: f64,
    last: f64,
}

impl Cells {
    fn new(count: usize, span: f64) -> Self {
        Self { per_unit: count as f64 / span, last: (count - 1) as f64 }
    }

    /// Their numbers at positions from the first knot on.
    #[inline(always)]
    pub fn of<V: Lanes>(&self, along: V) -> [u32; MOST] {
        (along * V::splat(self.per_unit)).smaller(V::splat(self.last)).whole().1
    }
}

/// Intervals, shares of their upper ends, and lengths, lane by lane.
pub type Found<V> = ([u32; MOST], V, V);

/// Cells are at most so many times the intervals.
const MAX_CELLS: usize = 4;

impl Intervals {
    /// Between knots that rise; there are at least two.
    pub fn new(knots: &[f64]) -> Self {
        let count = knots.len() - 1;
        let (first, span) = (knots[0], knots[count] - knots[0]);
        let place = |i: usize| first + span * (i as f64 / count as f64);
        if knots.iter().enumerate().all(|(i, q)| (q - place(i)).abs() <= 8.0 * f64::EPSILON * span) {
            return Self::Even { per_unit: count as f64 / span, last: (count - 1) as f64, width: span / count as f64 };
        }
        let mut cells = count;
        while cells <= MAX_CELLS * count {
            if let Some(rows) = (0..cells).map(|cell| row(knots, (cell, cells))).collect() {
                return Self::Apart { cells: Cells::new(cells, span), rows };
            }
            cells += cells.div_ceil(4);
        }
        let cells = (2 * count).min(1 << 20);
        let starts = (0..=cells).map(|cell| interval(knots, edge(knots, (cell, cells))) as u32).collect();
        Self::Crowded { cells: Cells::new(cells, span), starts, knots: knots.to_vec() }
    }
}

/// Where a cell of so many begins.
fn edge(knots: &[f64], (cell, cells): (usize, usize)) -> f64 {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    first + (last - first) * (cell as f64 / cells as f64)
}

/// The interval of a position.
fn interval(knots: &[f64], x: f64) -> usize {
    knots.partition_point(|q| *q <= x).saturating_sub(1).min(knots.len() - 2)
}

/// The row of a cell; `None` if there are two knots in it.
fn row(knots: &[f64], (cell, cells): (usize, usize)) -> Option<Row> {
    let (i, end) = (interval(knots, edge(knots, (cell, cells))), edge(knots, (cell + 1, cells)));
    let (low, knot) = (knots[i], knots[i + 1]);
    let width = knot - low;
    let alone = [f64::INFINITY, low, 1.0 / width, width, 0.0, 0.0, i as f64, 0.0];
    match knots.get(i + 2) {
        Some(next) if knot < end => {
            let next_width = next - knot;
            let both = [knot, low, 1.0 / width, width, 1.0 / next_width, next_width, i as f64, 0.0];
            (*next >= end).then_some(Row(both))
        }
        _ => Some(Row(alone)),
    }
}

/// At positions in these cells, of which none has two knots in it.
#[inline(always)]
pub fn apart<V: Lanes>(rows: &[Row], cells: &[u32; MOST], x: V) -> Found<V> {
    let mut of = [V::Eight::of(&rows[0]); MOST];
    for lane in 0..V::COUNT {
        of[lane] = V::Eight::of(&rows[cells[lane] as usize]);
    }
    let [knot, low, low_inverse, low_width, high_inverse, high_width, index, _] = V::columns(&of);
    let share = (x - x.if_less(knot, low, knot)) * x.if_less(knot, low_inverse, high_inverse);
    let (_, interval) = x.if_less(knot, index, index + V::splat(1.0)).whole();
    (interval, share, x.if_less(knot, low_width, high_width))
}

/// Lane by lane.
#[inline(never)]
pub fn search(
    starts: &[u32],
    knots: &[f64],
    cells: &[u32; MOST],
    positions: &[f64; MOST],
    count: usize,
) -> ([u32; MOST], [f64; MOST], [f64; MOST]) {
    let (mut at, mut share, mut width) = ([0; MOST], [0.0; MOST], [0.0; MOST]);
    for lane in 0..count {
        let (cell, x) = (cells[lane] as usize, positions[lane]);
        let (low, high) = (starts[cell] as usize, starts[cell + 1] as usize);
        let i = low + knots[low + 1..=high].partition_point(|q| *q <= x);
        let h = knots[i + 1] - knots[i];
        (at[lane], share[lane], width[lane]) = (i as u32, (x - knots[i]) / h, h);
    }
    (at, share, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Interval and share of a position by looking through all knots.
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
            let Intervals::Apart { cells, rows } = Intervals::new(&knots) else { panic!("{count}") };
            assert!(rows.len() <= MAX_CELLS * count);
            agrees(&knots, |x| {
                let (at, share, width) = apart(&rows, &cells.of(x - knots[0]), x);
                (at[0], share, width)
            });
        }
    }

    #[test]
    fn knots_that_crowd_together_are_searched() {
        let mut knots = jittered(40);
        let middle = knots[20];
        knots.extend((1..5).map(|k| middle + f64::from(k) * 1e-6));
        knots.sort_by(f64::total_cmp);
        let Intervals::Crowded { cells, starts, knots } = Intervals::new(&knots) else { panic!("{knots:?}") };
        agrees(&knots, |x| {
            let (at, share, width) = search(&starts, &knots, &cells.of(x - knots[0]), &[x; MOST], 1);
            (at[0], share[0], width[0])
        });
    }

    #[test]
    fn equal_steps_are_counted() {
        let knots: Vec<f64> = (0..=77).map(|i| 3.0 + 0.1 * f64::from(i)).collect();
        assert!(matches!(Intervals::new(&knots), Intervals::Even { .. }));
    }
}
