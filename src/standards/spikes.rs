//! Reversal spikes of circular tests: short peaks after an axis has turned, in what the other causes leave.
//!
//! A spike is a pulse, round or sharp, over the angle travelled since the turning point, the same in both senses. Its
//! scatter is that of the same pulse laid where no axis turns, so that correlated noise and errors that repeat along
//! the path do not pass for spikes.

use super::circle::{RadialReading, Sense};
use super::student::beyond;
use crate::units::Interval;

/// Angle (deg) travelled after a turning point within which spikes are.
const WINDOW: f64 = 18.0;
/// Longest pulse, and where one begins at the latest, deg.
const LONGEST: f64 = 12.0;
const LATEST: f64 = 6.0;
/// Least number of steps from reading to reading in a round and in a sharp pulse.
const STEPS: f64 = 4.0;
const SHARP_STEPS: f64 = 6.0;
/// Shortest pulse, deg, however near the readings are.
const SHORTEST: f64 = 0.2;
/// Ratio of a length to the one before.
const GROWTH: f64 = 1.2;
/// Places of the peak, as shares of the length: a spike rises faster than it falls.
const PEAKS: [f64; 3] = [0.0, 0.25, 0.5];
/// Latest start in lengths.
const LATE: usize = 2;
/// Largest gap between readings in a pulse, as a share of its length.
const GAP: f64 = 1.0 / 3.0;
/// Fewest separate places that a scatter is formed of.
const FEWEST: usize = 5;
/// Heights below this (um) are rounding.
const MIN_HEIGHT: f64 = 1e-3;
/// Probability, at most, that normal scatter shows a spike in a circle that has none.
pub const FALSE_ALARM: f64 = 0.01;
/// Angles at which an axis turns, deg: the first axis at its largest, the second, the first at its smallest, the
/// second.
pub(super) const TURNING_POINTS: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

/// A pulse of height 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pulse {
    /// Where it begins, deg after the turning point.
    pub start: f64,
    /// Length from beginning to end, deg.
    length: f64,
    /// Place of its peak, as a share of the length.
    peak: f64,
    shape: Shape,
}

/// The rise of a pulse, and backwards its fall.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// Half a wave of a cosine.
    Round,
    /// A square, as of motion that sticks and dies away.
    Sharp,
}

impl Pulse {
    fn value(&self, path: f64) -> f64 {
        let share = (path - self.start) / self.length;
        if !(0.0..=1.0).contains(&share) {
            return 0.0;
        }
        let phase = if share < self.peak { share / self.peak } else { (1.0 - share) / (1.0 - self.peak) };
        match self.shape {
            Shape::Round => 0.5 - 0.5 * libm::cos(std::f64::consts::PI * phase),
            Shape::Sharp => phase * phase,
        }
    }

    /// Its length at half its height, deg: the same wherever the peak is.
    pub fn width(&self) -> f64 {
        match self.shape {
            Shape::Round => 0.5 * self.length,
            Shape::Sharp => (1.0 - std::f64::consts::FRAC_1_SQRT_2) * self.length,
        }
    }
}

struct Laid {
    /// Weights of readings in its height.
    weights: Vec<(usize, f64)>,
    /// Sum of its squares over them.
    gain: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoundSpike {
    pub pulse: Pulse,
    /// Weights of readings in its height.
    pub weights: Vec<(usize, f64)>,
    /// Variance (um^2) of the height of such a pulse where no axis turns.
    pub variance: f64,
    /// Probability that normal scatter shows one as strong at any turning point.
    pub chance: f64,
}

/// Spike and limit of a turning point.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Judged {
    pub spike: Option<FoundSpike>,
    /// Height (um) from which on a spike of any length is found. `None` where the readings are too few.
    pub limit: Option<f64>,
}

/// A pulse laid at a turning point, with its height and variance.
struct SpikeCandidate {
    pulse: Pulse,
    laid: Laid,
    height: f64,
    control: f64,
    /// Variance of the height, with that of the fit there.
    variance: f64,
    freedom: usize,
}

/// Readings in the order of their angles, a turn before and after as well, by sense.
pub(super) struct AnglePath([Vec<(f64, usize)>; 2]);

impl AnglePath {
    pub fn of(readings: &[RadialReading]) -> Self {
        Self(Sense::ALL.map(|sense| {
            let mine = readings.iter().enumerate().filter(|(_, reading)| reading.sense == sense);
            let mut turn: Vec<(f64, usize)> = mine.map(|(i, reading)| (reading.angle.rem_euclid(360.0), i)).collect();
            turn.sort_by(|a, b| a.0.total_cmp(&b.0));
            [-360.0, 0.0, 360.0].iter().flat_map(|by| turn.iter().map(move |(a, i)| (a + by, *i))).collect()
        }))
    }

    /// Readings of a sense between two angles travelled after a place, with those angles.
    fn stretch(&self, k: usize, at: f64, path: Interval) -> impl Iterator<Item = (f64, usize)> {
        let sign = Sense::ALL[k].sign();
        let (low, high) = if sign > 0.0 { (at + path.min, at + path.max) } else { (at - path.max, at - path.min) };
        let all = &self.0[k];
        let range = all.partition_point(|(a, _)| *a < low)..all.partition_point(|(a, _)| *a <= high);
        all[range].iter().map(move |(a, i)| (sign * (a - at), *i))
    }

    /// Readings of both senses between two angles travelled after a place.
    fn near(&self, at: f64, path: Interval) -> impl Iterator<Item = usize> {
        (0..2).flat_map(move |k| self.stretch(k, at, path).map(|(_, i)| i))
    }

    /// Readings in the windows after all turning points.
    pub fn windows(&self) -> impl Iterator<Item = usize> {
        TURNING_POINTS.iter().flat_map(|at| self.near(*at, Interval::new(0.0, WINDOW)))
    }

    /// Readings of a spike, its tail included.
    pub fn spike(&self, at: f64, pulse: Pulse) -> impl Iterator<Item = usize> {
        self.near(at, Interval::new(pulse.start - 0.25 * pulse.length, pulse.start + 1.5 * pulse.length))
    }

    /// The usual step from reading to reading, deg.
    fn step(&self) -> Option<f64> {
        let steps = self.0.iter().flat_map(|all| all.windows(2).map(|pair| pair[1].0 - pair[0].0));
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied()
    }

    /// All pulses that the readings can show.
    fn pulses(&self) -> Vec<Pulse> {
        let Some(step) = self.step() else { return Vec::new() };
        let shapes = [(Shape::Round, STEPS), (Shape::Sharp, SHARP_STEPS)];
        shapes.into_iter().flat_map(|(shape, steps)| Self::of_shape(shape, (steps * step).max(SHORTEST))).collect()
    }

    fn of_shape(shape: Shape, shortest: f64) -> impl Iterator<Item = Pulse> {
        let lengths = std::iter::successors(Some(shortest), |length| Some(length * GROWTH));
        lengths.take_while(|length| *length <= LONGEST).flat_map(move |length| {
            let starts = (0..=4 * LATE).map(move |k| 0.25 * length * k as f64).filter(|start| *start <= LATEST);
            starts.flat_map(move |start| PEAKS.map(|peak| Pulse { start, length, peak, shape }))
        })
    }

    /// True if the readings of a sense are dense over a pulse.
    fn is_dense(&self, k: usize, at: f64, pulse: &Pulse) -> bool {
        let (start, end) = (pulse.start, pulse.start + pulse.length);
        let sign = Sense::ALL[k].sign();
        let mut places: Vec<f64> = self.stretch(k, at, Interval::new(start, end)).map(|(path, _)| path).collect();
        if sign < 0.0 {
            places.reverse();
        }
        let before = std::iter::once(start).chain(places.iter().copied());
        before.zip(places.iter().copied().chain([end])).all(|(a, b)| b - a <= GAP * pulse.length)
    }

    fn senses(&self, at: f64, pulse: &Pulse) -> [bool; 2] {
        [0, 1].map(|k| self.is_dense(k, at, pulse))
    }

    fn pulse_weights(&self, at: f64, pulse: &Pulse, senses: [bool; 2]) -> Laid {
        let range = Interval::new(pulse.start, pulse.start + pulse.length);
        let of = |k: usize| self.stretch(k, at, range).map(|(path, i)| (i, pulse.value(path)));
        let mut weights: Vec<(usize, f64)> = (0..2).filter(|k| senses[*k]).flat_map(of).collect();
        let gain: f64 = weights.iter().map(|(_, value)| value * value).sum();
        weights.iter_mut().for_each(|(_, value)| *value /= gain);
        Laid { weights, gain }
    }

    /// Variance of the height of a pulse where no axis turns.
    fn control(&self, pulse: &Pulse, senses: [bool; 2], left: &[f64]) -> Control {
        let (mut squares, mut count) = (0.0, 0_usize);
        let step = 0.5 * pulse.length;
        let places = ((90.0 - 2.0 * WINDOW) / step) as usize;
        for turning in TURNING_POINTS {
            for place in (0..=places).map(|j| turning + WINDOW + step * j as f64) {
                let here = self.senses(place, pulse);
                if (0..2).all(|k| here[k] || !senses[k]) {
                    let height = height(&self.pulse_weights(place, pulse, senses).weights, left);
                    squares += height * height;
                    count += 1;
                }
            }
        }
        let freedom = count / 2;
        (freedom >= FEWEST).then(|| (squares / count as f64, freedom))
    }

    /// Judges all turning points by what a fit of the readings outside the windows leaves, and by the variance that it
    /// gives a weighted sum of predictions.
    pub fn judge(&self, left: &[f64], fit: impl Fn(&[(usize, f64)]) -> f64) -> [Judged; 4] {
        let pulses = self.pulses();
        let mut controls = Controls { path: self, left, known: Vec::new() };
        let candidates = TURNING_POINTS.map(|at| {
            let one = |pulse: &Pulse| {
                let senses = self.senses(at, pulse);
                let (control, freedom) = controls.of(pulse, senses).filter(|_| senses != [false; 2])?;
                let laid = self.pulse_weights(at, pulse, senses);
                let variance = control + fit(&laid.weights);
                let height = height(&laid.weights, left);
                Some(SpikeCandidate { pulse: *pulse, laid, height, control, variance, freedom })
            };
            pulses.iter().filter_map(one).collect::<Vec<SpikeCandidate>>()
        });
        let count: usize = candidates.iter().map(Vec::len).sum();
        candidates.map(|list| judge(list, count as f64))
    }
}

/// A variance, and the number of separate places that it is formed of.
type Control = Option<(f64, usize)>;

/// Variances where no axis turns, each kind of pulse looked up once.
struct Controls<'a> {
    path: &'a AnglePath,
    left: &'a [f64],
    known: Vec<(Pulse, [bool; 2], Control)>,
}

impl Controls<'_> {
    fn of(&mut self, pulse: &Pulse, senses: [bool; 2]) -> Control {
        let kind = Pulse { start: 0.0, ..*pulse };
        if let Some((.., found)) = self.known.iter().find(|(of, by, _)| *of == kind && *by == senses) {
            return *found;
        }
        let found = self.path.control(&kind, senses, self.left);
        self.known.push((kind, senses, found));
        found
    }
}

/// Judges the candidates of a turning point, of so many at all of them: each counts as a trial of its own
/// (Bonferroni).
fn judge(list: Vec<SpikeCandidate>, trials: f64) -> Judged {
    let limit = |c: &SpikeCandidate| quantile(FALSE_ALARM / trials, c.freedom) * libm::sqrt(c.variance);
    let limit = list.iter().map(limit).reduce(f64::max);
    let explained = |c: &SpikeCandidate| c.laid.gain * c.height * c.height;
    let best = list.into_iter().reduce(|a, b| if explained(&b) > explained(&a) { b } else { a });
    let spike = best.and_then(|c| {
        let ratio = c.height / libm::sqrt(c.variance);
        let chance = (trials * beyond(ratio, c.freedom)).min(1.0);
        let found = chance < FALSE_ALARM && c.height.abs() > MIN_HEIGHT;
        found.then_some(FoundSpike { pulse: c.pulse, weights: c.laid.weights, variance: c.control, chance })
    });
    Judged { spike, limit }
}

/// The height of a pulse by weights of readings.
pub(super) fn height(weights: &[(usize, f64)], left: &[f64]) -> f64 {
    weights.iter().map(|(i, weight)| weight * left[*i]).sum()
}

/// The value that chance exceeds with a probability, to either side, of Student's distribution.
fn quantile(probability: f64, freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if beyond(middle, freedom) > probability { &mut low } else { &mut high }) = middle;
    }
    high
}
