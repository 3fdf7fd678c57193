//! Sums over the measurements of a fit.

use crate::identify::data::Measurement;
use rayon::prelude::*;

/// Measurements that are summed together, at least, and largest number of such sums: neither depends on the number of
/// threads.
const TOGETHER: usize = 1024;
const MOST: usize = 16;

/// Returns the sum over all measurements, each with its weight: `add` adds one, `plus` takes two sums together.
pub(super) fn summed<S: Send>(
    (data, weights): (&[Measurement], &[f64]),
    zero: impl Fn() -> S + Sync,
    add: impl Fn(&mut S, &Measurement, f64) + Sync,
    plus: impl Fn(S, S) -> S,
) -> S {
    let one = |(data, weights): (&[Measurement], &[f64])| {
        let mut sum = zero();
        data.iter().zip(weights).for_each(|(m, weight)| add(&mut sum, m, *weight));
        sum
    };
    let together = data.len().div_ceil(MOST).max(TOGETHER);
    let parts: Vec<S> = data.par_chunks(together).zip(weights.par_chunks(together)).map(one).collect();
    parts.into_iter().fold(zero(), plus)
}
