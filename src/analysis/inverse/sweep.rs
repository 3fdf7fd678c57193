//! Exact reach along a sweep: a turn of rotary axes that leaves the direction of the tool as it is (a free axis, or two
//! parallel axes against each other).
//!
//! Along a sweep s every determinant of directions of linear axes and of the way to the place is a + b cos s + c sin s.
//! A place that the linear axes cannot just reach has two of them span, with the others at ends of their travels, a
//! plane through it. So the ends of the arcs in reach are zeros of such determinants, and the arcs between
//! neighbouring zeros are in reach as a whole or not at all. The same holds for lathes, whose two linear axes meet the
//! place at zeros.

use super::linear::{self, LinearSlide};
use super::rotary::{Sweep, nearness, wrapped};
use super::tool_pose::unturned_tool_pose;
use crate::machine::{AxisKind, Machine, Pose, Travel};
use nalgebra::{Matrix3, Vector3};

/// Largest number of linear axes: with more there are too many combinations of ends.
const MAX_SLIDES: usize = 5;

/// Amplitudes and misses below this (mm) count as touching.
const TOUCHING_MM: f64 = 1e-6;

/// Angles (deg) that determine a wave, and one that checks it.
const SAMPLES_DEG: [f64; 4] = [0.0, 120.0, 240.0, 77.0];

/// Largest deviation of the check from its wave, as a fraction of the size.
const WAVE_TOLERANCE: f64 = 1e-9;

/// Candidates along sweeps.
#[derive(Default)]
pub struct SweepCandidates {
    /// Ends and middles of all arcs, nearest to the reference first: if there is a pose in reach, one of these is.
    pub arcs: Vec<Pose>,
    /// Poses at which the sum of what the linear axes lack may be least.
    pub shortfalls: Vec<Pose>,
    /// True if the arcs are all there are.
    pub exact: bool,
}

/// Returns the candidates along sweeps for a tip (mm, unturned workpiece frame); rotary axes are within their travel.
pub fn sweep_poses(machine: &Machine, tip: &Vector3<f64>, sweeps: &[Sweep], reference: &[f64]) -> SweepCandidates {
    let mut swept = SweepCandidates { exact: true, ..SweepCandidates::default() };
    for sweep in sweeps {
        let along = AlongSweep { machine, tip, sweep, reference };
        let exact = along.add(&mut swept);
        swept.exact &= exact;
    }
    let rotary: Vec<usize> = (0..reference.len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary).collect();
    swept.arcs.sort_by_cached_key(|pose| nearness(rotary.iter().map(|i| (pose[*i], reference[*i]))));
    swept
}

/// a + b cos s + c sin s.
#[derive(Debug, Clone, Copy, Default)]
struct Wave {
    a: f64,
    b: f64,
    c: f64,
}

impl Wave {
    /// Returns the wave of values at [`SAMPLES_DEG`]; `None` if they are of no wave.
    fn through([p, q, r, check]: [f64; 4]) -> Option<Self> {
        let wave = Self { a: (p + q + r) / 3.0, b: (2.0 * p - q - r) / 3.0, c: (q - r) / libm::sqrt(3.0) };
        let (sine, cosine) = libm::sincos(SAMPLES_DEG[3].to_radians());
        let size = 1.0 + wave.a.abs() + libm::hypot(wave.b, wave.c);
        let off = wave.a + wave.b * cosine + wave.c * sine - check;
        (off.abs() <= WAVE_TOLERANCE * size).then_some(wave)
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        Self { a: self.a + factor * other.a, b: self.b + factor * other.b, c: self.c + factor * other.c }
    }

    /// Returns the wave with the zeros of the derivative of `self / other`.
    fn slope_over(self, other: Self) -> Self {
        Self {
            a: self.c * other.b - self.b * other.c,
            b: self.c * other.a - self.a * other.c,
            c: self.a * other.b - self.b * other.a,
        }
    }

    /// Returns the zeros, deg.
    fn zeros(self) -> Vec<f64> {
        let size = libm::hypot(self.b, self.c);
        if size == 0.0 || self.a.abs() > size + TOUCHING_MM {
            return Vec::new();
        }
        let (middle, half) = (libm::atan2(self.c, self.b), libm::acos((-self.a / size).clamp(-1.0, 1.0)));
        vec![(middle - half).to_degrees(), (middle + half).to_degrees()]
    }
}

/// One sweep for one place.
struct AlongSweep<'a> {
    machine: &'a Machine,
    tip: &'a Vector3<f64>,
    sweep: &'a Sweep,
    reference: &'a [f64],
}

/// The linear axes at one angle of a sweep, and the way from the tip with all of them at the reference to the place.
struct Span {
    slides: Vec<LinearSlide>,
    way: Vector3<f64>,
}

impl AlongSweep<'_> {
    /// Adds the candidates; true if they are all.
    fn add(&self, swept: &mut SweepCandidates) -> bool {
        let spans = SAMPLES_DEG.map(|degrees| self.span(degrees));
        let count = spans[0].slides.len();
        if !(2..=MAX_SLIDES).contains(&count) {
            return false;
        }
        let Some(boundaries) = waves(&spans, Span::boundaries) else { return false };
        let mut ends: Vec<f64> = boundaries.into_iter().flat_map(Wave::zeros).collect();
        ends.extend(self.travel_ends());
        ends.push(0.0);
        ends.iter_mut().for_each(|s| *s -= 360.0 * libm::floor(*s / 360.0));
        ends.sort_by(f64::total_cmp);
        let middles: Vec<f64> =
            ends.iter().zip(ends.iter().skip(1).chain([&(ends[0] + 360.0)])).map(|(s, t)| (s + t) / 2.0).collect();
        swept.arcs.extend(ends.into_iter().chain(middles).filter_map(|s| self.within(s)));
        let quotients = waves(&spans, Span::quotients).unwrap_or_default();
        swept.shortfalls.extend(least_sums(&quotients).into_iter().filter_map(|s| self.within(s)));
        true
    }

    fn at(&self, degrees: f64) -> Pose {
        let mut pose = self.sweep.pose.clone();
        self.sweep.rates.iter().for_each(|(axis, rate)| pose[*axis] += rate * degrees);
        pose
    }

    /// Returns the pose with its rotary axes within their travels, by whole turns; `None` if one is beyond.
    fn within(&self, degrees: f64) -> Option<Pose> {
        let mut pose = self.at(degrees);
        for (i, _) in &self.sweep.rates {
            pose[*i] = wrapped(self.machine.axes()[*i].travel, self.reference[*i], pose[*i].to_radians())?;
        }
        Some(pose)
    }

    /// Returns the angles of the sweep at the ends of the travels of its axes.
    fn travel_ends(&self) -> Vec<f64> {
        let of = |(axis, rate): &(usize, f64)| match self.machine.axes()[*axis].travel {
            Travel::Range(min, max) => [min, max].map(|end| (end - self.sweep.pose[*axis]) / rate).to_vec(),
            Travel::Continuous => Vec::new(),
        };
        self.sweep.rates.iter().flat_map(of).collect()
    }

    fn span(&self, degrees: f64) -> Span {
        let mut pose = self.at(degrees);
        let mut slides = linear::slides(self.machine.axes(), &pose, self.reference);
        slides.iter().for_each(|slide| pose[slide.axis] = self.reference[slide.axis]);
        let way = self.tip - unturned_tool_pose(self.machine, &pose).tip;
        if let [first, second] = slides.as_slice() {
            // Nothing moves across the plane of two axes.
            let normal = first.direction.cross(&second.direction);
            slides.push(LinearSlide { axis: usize::MAX, direction: normal, range: (0.0, 0.0), end: None });
        }
        Span { slides, way }
    }
}

/// Returns the waves of quantities that spans give; `None` if one is not a wave.
fn waves(spans: &[Span; 4], of: impl Fn(&Span) -> Vec<f64>) -> Option<Vec<Wave>> {
    let [p, q, r, check] = [&spans[0], &spans[1], &spans[2], &spans[3]].map(of);
    (0..p.len()).map(|i| Wave::through([p[i], q[i], r[i], check[i]])).collect()
}

fn determinant(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> f64 {
    a.cross(b).dot(c)
}

impl Span {
    /// Returns the determinants that vanish at the ends of arcs.
    fn boundaries(&self) -> Vec<f64> {
        let mut list = Vec::new();
        let count = self.slides.len();
        for i in 0..count {
            for j in i + 1..count {
                let (a, b) = (&self.slides[i].direction, &self.slides[j].direction);
                let held: Vec<&LinearSlide> =
                    (0..count).filter(|k| ![i, j].contains(k)).map(|k| &self.slides[k]).collect();
                list.extend(self.corners(&held).iter().map(|way| determinant(a, b, way)));
                list.extend(self.slides[j + 1..].iter().map(|c| determinant(a, b, &c.direction)));
            }
        }
        list
    }

    /// Returns what is left of the way with axes at each combination of the ends of their travels, if they have ends.
    fn corners(&self, held: &[&LinearSlide]) -> Vec<Vector3<f64>> {
        let step = |ways: Vec<Vector3<f64>>, slide: &&LinearSlide| {
            let ends = [slide.range.0, slide.range.1].into_iter().filter(|end| end.is_finite());
            ends.flat_map(|end| ways.iter().map(move |way| way - slide.direction * end)).collect()
        };
        held.iter().fold(vec![self.way], step)
    }

    /// Returns the determinant of three axes, then those with the way in place of each: their quotients are the
    /// motions. Empty for other numbers of axes.
    fn quotients(&self) -> Vec<f64> {
        let [a, b, c] = self.slides.as_slice() else { return Vec::new() };
        let matrix = Matrix3::from_columns(&[a.direction, b.direction, c.direction]);
        let with = |column: usize| {
            let mut replaced = matrix;
            replaced.set_column(column, &self.way);
            replaced.determinant()
        };
        vec![matrix.determinant(), with(0), with(1), with(2)]
    }
}

/// Returns the angles (deg) at which a sum of motions, each with either sign or left out, is stationary.
fn least_sums(quotients: &[Wave]) -> Vec<f64> {
    let [whole, parts @ ..] = quotients else { return Vec::new() };
    let signs = |k: usize| [k % 3, k / 3 % 3, k / 9].map(|digit| digit as f64 - 1.0);
    // 13 of the 27 are all zeros, and those after it are those before with the signs turned.
    (0..13)
        .map(|k| parts.iter().zip(signs(k)).fold(Wave::default(), |sum, (part, sign)| sum.plus(sign, *part)))
        .flat_map(|sum| sum.slope_over(*whole).zeros())
        .collect()
}
