//! Sums over the measurements of a fit.

use crate::identify::data::Measurement;
use rayon::prelude::*;

/// Least number of measurements that are summed in one piece; it does not depend on the number of threads.
const MIN_PIECE: usize = 1024;
const MAX_PIECES: usize = 16;

/// Returns the sum over all measurements with their weights: `add` adds one to a sum, `plus` adds two sums.
pub(super) fn parallel_sum<S: Send>(
    data: &[Measurement],
    weights: &[f64],
    zero: impl Fn() -> S + Sync,
    add: impl Fn(&mut S, &Measurement, f64) + Sync,
    plus: impl Fn(S, S) -> S,
) -> S {
    let one = |(data, weights): (&[Measurement], &[f64])| {
        let mut sum = zero();
        data.iter().zip(weights).for_each(|(m, weight)| add(&mut sum, m, *weight));
        sum
    };
    let piece = data.len().div_ceil(MAX_PIECES).max(MIN_PIECE);
    let parts: Vec<S> = data.par_chunks(piece).zip(weights.par_chunks(piece)).map(one).collect();
    parts.into_iter().fold(zero(), plus)
}
