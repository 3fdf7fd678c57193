//! Sums over the measurements of a fit.

use crate::identify::data::Measurement;
use rayon::prelude::*;

/// Measurements that are summed together: the sums do not depend on the number of threads.
const TOGETHER: usize = 1024;

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
    let parts: Vec<S> = data.par_chunks(TOGETHER).zip(weights.par_chunks(TOGETHER)).map(one).collect();
    parts.into_iter().fold(zero(), plus)
}
