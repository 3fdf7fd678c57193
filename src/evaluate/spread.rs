//! Low-discrepancy poses: the sequence of Halton (Numer. Math. 2, 1960, 84-90), its coordinate k in the k-th
//! prime as base, moved as a whole by a random shift modulo 1 (Cranley and Patterson, SIAM J. Numer. Anal. 13,
//! 1976, 904-914), so that another seed gives another sample of the same evenness.

use crate::machine::{Machine, Pose};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Low-discrepancy poses over intervals, computed by index.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    coordinates: Vec<Coordinate>,
    count: usize,
}

#[derive(Debug, Clone, PartialEq)]
struct Coordinate {
    /// Prime base.
    base: u64,
    /// Shift modulo 1.
    shift: f64,
    /// Interval, mm or deg.
    interval: (f64, f64),
}

impl Spread {
    /// Returns `count` poses over the machine's volume.
    pub fn of(machine: &Machine, count: usize, seed: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        let intervals = machine.volume().iter().map(|grid| (grid.min, grid.max));
        let coordinates = primes().zip(intervals);
        let coordinates =
            coordinates.map(|(base, interval)| Coordinate { base, shift: unit(generator.next_u64()), interval });
        Self { coordinates: coordinates.collect(), count }
    }

    /// Returns the number of poses.
    pub fn len(&self) -> usize {
        self.count
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the pose with this index (mm, deg).
    pub fn get(&self, index: usize) -> Pose {
        let position = |Coordinate { base, shift, interval: (min, max) }: &Coordinate| {
            let fraction = radical_inverse(index as u64 + 1, *base) + shift;
            (min + (max - min) * (fraction - libm::floor(fraction))).min(*max)
        };
        self.coordinates.iter().map(position).collect()
    }
}

/// Returns 2, 3, 5, 7 ...
fn primes() -> impl Iterator<Item = u64> {
    (2..).filter(|n: &u64| (2..*n).take_while(|d| d * d <= *n).all(|d| !n.is_multiple_of(d)))
}

/// Returns the upper 53 bits as a number in [0, 1).
pub(super) fn unit(bits: u64) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
    (bits >> 11) as f64 * SCALE
}

/// Returns the digits of the index in this base, mirrored at the radix point: in [0, 1).
pub fn radical_inverse(mut index: u64, base: u64) -> f64 {
    let (mut value, mut weight) = (0.0, 1.0);
    while index > 0 {
        weight /= base as f64;
        value += (index % base) as f64 * weight;
        index /= base;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_haltons() {
        assert_eq!([1, 2, 3, 4, 5].map(|i| radical_inverse(i, 2)), [0.5, 0.25, 0.75, 0.125, 0.625]);
        let ninths = [1, 2, 3, 4].map(|i| radical_inverse(i, 3) * 9.0);
        for (value, expected) in ninths.into_iter().zip([3.0, 6.0, 1.0, 4.0]) {
            assert!((value - expected).abs() < 1e-14);
        }
        assert_eq!(primes().take(8).collect::<Vec<_>>(), [2, 3, 5, 7, 11, 13, 17, 19]);
    }

    #[test]
    fn poses_are_more_even_than_random_ones_and_depend_on_the_seed() {
        let coordinate = |base, shift| Coordinate { base, shift, interval: (0.0, 1.0) };
        let of = |shift| Spread { coordinates: vec![coordinate(2, shift), coordinate(3, 0.7)], count: 1000 };
        // Expected are 10 of 1000 points in each of a hundred boxes; random ones miss that by 3.2 (root of 10).
        let mut boxes = [0_i32; 100];
        for pose in (0..1000).map(|i| of(0.3).get(i)) {
            assert!(pose.iter().all(|x| (0.0..1.0).contains(x)));
            boxes[(pose[0] * 10.0) as usize * 10 + (pose[1] * 10.0) as usize] += 1;
        }
        let off = boxes.iter().map(|n| f64::from((n - 10) * (n - 10))).sum::<f64>() / 100.0;
        assert!(off.sqrt() < 1.5, "{off}");
        assert_ne!(of(0.3).get(5), of(0.4).get(5));
    }
}
