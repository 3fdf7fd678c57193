//! The least and the largest position of a column, faster than the deviations are computed.

use super::lanes::run;
use super::model::CompiledModel;
use super::simd::{Kernel, Lanes, MAX_LANES};
use super::width::Width;

/// The ends of a column of at least one number.
struct Ends<'a, 'o> {
    column: &'a [f64],
    ends: &'o mut Option<[f64; 2]>,
}

/// Vectors side by side: a comparison waits for the one before.
const STREAMS: usize = 4;

impl Kernel for Ends<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let padded: [f64; MAX_LANES] = std::array::from_fn(|k| self.column[k.min(self.column.len() - 1)]);
        let column = if self.column.len() < V::COUNT { &padded[..V::COUNT] } else { self.column };
        let mut low = [V::load(column); STREAMS];
        let (mut high, mut finite) = (low, [V::splat(0.0); STREAMS]);
        let last = column.len() - V::COUNT;
        let mut at = 0;
        while at < column.len() {
            for k in 0..STREAMS {
                // The last vectors end where the column does: a number that counts twice changes no end.
                let q = V::load(&column[(at + k * V::COUNT).min(last)..]);
                (low[k], high[k]) = (low[k].smaller(q), high[k].larger(q));
                // Not a number, and so forever, if the position is not finite.
                finite[k] = finite[k] + q * V::splat(0.0);
            }
            at += STREAMS * V::COUNT;
        }
        let within = |vectors: [V; STREAMS]| vectors.into_iter().flat_map(|v| v.to_array().into_iter().take(V::COUNT));
        if within(finite).all(|zero| zero == 0.0) {
            let low = within(low).fold(f64::INFINITY, f64::min);
            *self.ends = Some([low, within(high).fold(f64::NEG_INFINITY, f64::max)]);
        }
    }
}

impl CompiledModel {
    /// Returns the least and the largest number of a column; `None` where one is not finite, and without numbers.
    pub fn ends(&self, column: &[f64]) -> Option<[f64; 2]> {
        ends(self.width, column)
    }
}

fn ends(width: Width, column: &[f64]) -> Option<[f64; 2]> {
    let mut ends = None;
    if !column.is_empty() {
        run(width, Ends { column, ends: &mut ends });
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_column_of_any_length() {
        for width in Width::ALL {
            assert_eq!(ends(width, &[]), None);
            for len in 1..100_usize {
                let mut column: Vec<f64> = (0..len).map(|i| ((i * 7919) % 101) as f64 - 50.0).collect();
                let sorted = {
                    let mut sorted = column.clone();
                    sorted.sort_by(f64::total_cmp);
                    sorted
                };
                assert_eq!(ends(width, &column), Some([sorted[0], sorted[len - 1]]));
                for at in 0..len {
                    let before = column[at];
                    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                        column[at] = bad;
                        assert_eq!(ends(width, &column), None);
                    }
                    column[at] = before;
                }
            }
        }
    }
}
