//! The inner loops of drawn machines, for every width of vectors: the samples of a chunk lie side by side. Nothing is
//! fused, so every number is that of the same operations one after the other, to the bit.

#![allow(clippy::needless_range_loop, reason = "kernels have plain loops: see `evaluate::compiled`")]

use super::draw::{Distribution, HARMONICS, NODES, NodeValues};
use crate::evaluate::{Kernel, Lanes, Width, run_kernel};

/// Lanes of the widest vectors.
const MAX_LANES: usize = 8;

/// Number of samples computed side by side.
pub const SAMPLE_LANES: usize = 40;

/// A number per sample.
pub type SampleLanes = [f64; SAMPLE_LANES];

/// Runs a kernel at the widest vectors of the processor.
pub fn run(kernel: impl Kernel) {
    run_kernel(Width::widest(), kernel);
}

/// Adds effects times the errors of every sample.
pub struct AddEffects<'a> {
    /// The effect of each error.
    pub effects: &'a [[f64; 3]],
    /// The errors.
    pub errors: &'a [SampleLanes],
    /// Errors at the next node, and the fraction of the way to it.
    pub next: Option<(&'a [SampleLanes], f64)>,
    /// The sums.
    pub to: &'a mut [SampleLanes; 3],
}

impl AddEffects<'_> {
    #[inline(always)]
    fn error<V: Lanes>(&self, source: usize, lane: usize) -> V {
        let error = V::load(&self.errors[source][lane..]);
        match self.next {
            None => error,
            Some((next, fraction)) => error + V::splat(fraction) * (V::load(&next[source][lane..]) - error),
        }
    }
}

impl Kernel for AddEffects<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let count = self.effects.len();
        for lane in (0..SAMPLE_LANES).step_by(V::COUNT) {
            let mut sums = [V::splat(0.0); 3];
            for i in 0..3 {
                sums[i] = V::load(&self.to[i][lane..]);
            }
            let mut k = 0;
            while k + 3 <= count {
                let [x, y, z] = [self.error::<V>(k, lane), self.error(k + 1, lane), self.error(k + 2, lane)];
                let [a, b, c] = [&self.effects[k], &self.effects[k + 1], &self.effects[k + 2]];
                for i in 0..3 {
                    sums[i] = sums[i] + (V::splat(a[i]) * x + V::splat(b[i]) * y + V::splat(c[i]) * z);
                }
                k += 3;
            }
            while k < count {
                let x = self.error::<V>(k, lane);
                for i in 0..3 {
                    sums[i] = sums[i] + V::splat(self.effects[k][i]) * x;
                }
                k += 1;
            }
            for i in 0..3 {
                sums[i].store(&mut self.to[i][lane..]);
            }
        }
    }
}

/// A motion per unit of a number: translation and rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionTerm {
    /// Index of the number.
    pub index: usize,
    /// The motion.
    pub motion: [f64; 6],
}

/// Adds motions times numbers of every sample.
pub struct AddMotions<'a> {
    /// The motions.
    pub terms: &'a [MotionTerm],
    /// The numbers.
    pub factors: &'a [SampleLanes],
    /// The sums.
    pub to: &'a mut [SampleLanes; 6],
}

impl Kernel for AddMotions<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        for lane in (0..SAMPLE_LANES).step_by(V::COUNT) {
            let mut sums = [V::splat(0.0); 6];
            for i in 0..6 {
                sums[i] = V::load(&self.to[i][lane..]);
            }
            for term in self.terms {
                let factor = V::load(&self.factors[term.index][lane..]);
                for i in 0..6 {
                    sums[i] = sums[i] + V::splat(term.motion[i]) * factor;
                }
            }
            for i in 0..6 {
                sums[i].store(&mut self.to[i][lane..]);
            }
        }
    }
}

/// Takes the effect of a motion of the part out of deviations of every sample.
pub struct RemoveMotion<'a> {
    /// Translation and rotation.
    pub motion: &'a [SampleLanes; 6],
    /// Where the functional point is (mm); `None` for deviations of the orientation.
    pub tip: Option<[f64; 3]>,
    /// The deviations.
    pub from: &'a mut [SampleLanes; 3],
}

impl Kernel for RemoveMotion<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        for lane in (0..SAMPLE_LANES).step_by(V::COUNT) {
            let mut motion = [V::splat(0.0); 6];
            for i in 0..6 {
                motion[i] = V::load(&self.motion[i][lane..]);
            }
            let [tx, ty, tz, a, b, c] = motion;
            let effect = match self.tip {
                None => [a, b, c],
                Some([x, y, z]) => {
                    let [x, y, z] = [V::splat(x), V::splat(y), V::splat(z)];
                    [tx + (b * z - c * y), ty + (c * x - a * z), tz + (a * y - b * x)]
                }
            };
            for i in 0..3 {
                (V::load(&self.from[i][lane..]) - effect[i]).store(&mut self.from[i][lane..]);
            }
        }
    }
}

/// Sums over nodes of the products of vectors with that of every node, each times a correlation.
pub struct NodeSums<'a> {
    /// The vectors of the nodes, component by component.
    pub columns: &'a [NodeValues; 3],
    /// The nodes over which is summed.
    pub counts: &'a [usize],
    /// Correlations of any two nodes.
    pub correlations: &'a [NodeValues],
    /// The sum of every node.
    pub rows: &'a mut NodeValues,
}

impl Kernel for NodeSums<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let [x, y, z] = self.columns;
        for place in (0..self.rows.len()).step_by(V::COUNT) {
            let [a, b, c] = [V::load(&x[place..]), V::load(&y[place..]), V::load(&z[place..])];
            let mut sum = V::splat(-0.0);
            for n in self.counts {
                let n = *n;
                let product = a * V::splat(x[n]) + b * V::splat(y[n]) + c * V::splat(z[n]);
                sum = sum + product * V::load(&self.correlations[n][place..]);
            }
            sum.store(&mut self.rows[place..]);
        }
    }
}

/// The values of the curves of a chunk at their nodes, as bounded numbers times a tolerance.
pub struct CurveNodes<'a> {
    /// Weighted cosine and sine of every wave at every node.
    pub waves: &'a [[(f64, f64); HARMONICS]],
    /// Amplitudes of cosine and sine, wave by wave.
    pub amplitudes: &'a [[SampleLanes; 2]; HARMONICS],
    /// The tolerance.
    pub tolerance: f64,
    /// The distribution within the bounds.
    pub distribution: Distribution,
    /// The nodes: of every `stride`-th entry.
    pub nodes: &'a mut [SampleLanes],
    /// Distance of two nodes of the curve.
    pub stride: usize,
}

impl Kernel for CurveNodes<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        for lane in (0..SAMPLE_LANES).step_by(V::COUNT) {
            let mut amplitudes = [[V::splat(0.0); 2]; HARMONICS];
            for k in 0..HARMONICS {
                for i in 0..2 {
                    amplitudes[k][i] = V::load(&self.amplitudes[k][i][lane..]);
                }
            }
            for node in 0..NODES {
                let waves = &self.waves[node];
                let mut normal = V::splat(-0.0);
                for k in 0..HARMONICS {
                    let (cosine, sine) = waves[k];
                    normal = normal + (V::splat(cosine) * amplitudes[k][0] + V::splat(sine) * amplitudes[k][1]);
                }
                let x = normal * V::splat(std::f64::consts::FRAC_1_SQRT_2);
                let mut even = [0.0; MAX_LANES];
                erf(x).store(&mut even);
                beyond::<V>(x, &mut even);
                if self.distribution != Distribution::Uniform {
                    for i in 0..V::COUNT {
                        even[i] = self.distribution.fraction_of(even[i]);
                    }
                }
                let to = &mut self.nodes[node * self.stride][lane..];
                (V::splat(self.tolerance) * V::load(&even)).store(to);
            }
        }
    }
}

/// Below this size (2^-28), and from [`OUTER`] on, the numbers of [`erf`] are replaced.
const INNER: f64 = 3.725_290_298_461_914e-9;
const OUTER: f64 = 1.25;

/// Returns the error function as libm has it between [`INNER`] and [`OUTER`], by the same operations.
#[inline(always)]
fn erf<V: Lanes>(x: V) -> V {
    const TIP: [f64; 5] = [
        0.128_379_167_095_512_56,
        -0.325_042_107_247_001_5,
        -0.028_481_749_575_598_51,
        -0.005_770_270_296_489_442,
        -2.376_301_665_665_016_3e-05,
    ];
    const TIP_BELOW: [f64; 6] = [
        1.0,
        0.397_917_223_959_155_35,
        0.065_022_249_988_767_3,
        0.005_081_306_281_875_766,
        0.000_132_494_738_004_321_64,
        -3.960_228_278_775_368e-06,
    ];
    const BEND: [f64; 7] = [
        -0.002_362_118_560_752_659_4,
        0.414_856_118_683_748_33,
        -0.372_207_876_035_701_3,
        0.318_346_619_901_161_75,
        -0.110_894_694_282_396_68,
        0.035_478_304_325_618_236,
        -0.002_166_375_594_868_791,
    ];
    const BEND_BELOW: [f64; 7] = [
        1.0,
        0.106_420_880_400_844_23,
        0.540_397_917_702_171,
        0.071_828_654_414_196_27,
        0.126_171_219_808_761_64,
        0.013_637_083_912_029_05,
        0.011_984_499_846_799_107,
    ];
    /// The error function in the middle of the bend, in single precision.
    const AT_ONE: f64 = 0.845_062_911_510_467_5;
    let (one, bend) = (V::splat(1.0), V::splat(0.84375));
    let size = x.larger(V::splat(0.0) - x);
    let (square, past) = (x * x, size - one);
    let above = size.select_less(bend, polynomial(&TIP, square), polynomial(&BEND, past));
    let below = size.select_less(bend, polynomial(&TIP_BELOW, square), polynomial(&BEND_BELOW, past));
    let quotient = above.quotient(below);
    let outer = one - (V::splat(1.0 - AT_ONE) - quotient);
    size.select_less(bend, x + x * quotient, outer.with_sign_of(x))
}

#[inline(always)]
fn polynomial<V: Lanes, const N: usize>(coefficients: &[f64; N], x: V) -> V {
    let mut sum = V::splat(coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = V::splat(coefficients[k]) + x * sum;
    }
    sum
}

/// Writes what [`erf`] does not cover: 8 % of normal numbers.
#[inline(always)]
fn beyond<V: Lanes>(x: V, to: &mut [f64]) {
    let x = x.to_array();
    for i in 0..V::COUNT {
        let size = x[i].abs();
        if !(INNER..OUTER).contains(&size) {
            to[i] = libm::erf(x[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers on both sides of every limit of libm's, and many between.
    fn numbers() -> Vec<f64> {
        let limits = [0.0, 1e-300, INNER, 0.84375, OUTER, 1.0 / 0.35, 6.0, 30.0];
        let about = limits.iter().flat_map(|x| [x.next_down(), *x, x.next_up()]);
        let all: Vec<f64> = about.chain((0..4000).map(|i| f64::from(i) * 7.77e-4)).map(|x| x / HALF).collect();
        // Not -0, which a sum of waves never is.
        all.iter().copied().chain(all.iter().map(|x| 0.0 - x)).collect()
    }

    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

    #[test]
    fn curves_are_those_of_scalar_numbers_at_every_width() {
        let mut waves = [[(0.0, 0.0); HARMONICS]; NODES];
        waves.iter_mut().for_each(|node| node[0] = (1.0, 0.5));
        for distribution in [Distribution::Uniform, Distribution::Triangular] {
            for numbers in numbers().chunks(SAMPLE_LANES) {
                let mut amplitudes = [[[0.0; SAMPLE_LANES]; 2]; HARMONICS];
                amplitudes[0][0][..numbers.len()].copy_from_slice(numbers);
                let truth = amplitudes[0][0].map(|x| (3.0 * distribution.fraction(x)).to_bits());
                for width in Width::ALL.into_iter().filter(|width| width.is_supported()) {
                    let mut nodes = vec![[0.0; SAMPLE_LANES]; 2 * NODES];
                    let kernel = CurveNodes {
                        waves: &waves,
                        amplitudes: &amplitudes,
                        tolerance: 3.0,
                        distribution,
                        nodes: &mut nodes,
                        stride: 2,
                    };
                    run_kernel(width, kernel);
                    for (i, node) in nodes.iter().enumerate() {
                        let expected = if i % 2 == 0 { truth } else { [0; SAMPLE_LANES] };
                        assert_eq!(node.map(f64::to_bits), expected, "{width:?} {distribution:?} {i}");
                    }
                }
            }
        }
    }
}
