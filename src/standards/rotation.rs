//! Error motions of an axis of rotation (ISO 230-7): one probe over several turns.

use super::range;
use crate::algebra::linear::Svd;
use crate::machine::sin_cos_degrees;
use nalgebra::{DMatrix, DVector};

/// Angles that differ by less than this (deg) are one place of the turn.
const SAME: f64 = 1e-3;
/// Least number of places of a turn: fewer do not tell a centre from an error motion.
pub const LEAST_PLACES: usize = 8;

/// A reading: angle (deg, modulo a turn) and displacement (um), or tilt (urad).
pub type AngleReading = (f64, f64);

/// Figures of an error motion about the centre of least squares, in the unit of the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMotion {
    /// Number of places of the turn.
    pub places: usize,
    /// Least number of readings at a place.
    pub turns: usize,
    /// Cosine and sine part of what goes round once: set-up of a radial probe, the fundamental of an axial one.
    pub once: [f64; 2],
    /// Range of all readings about the centre.
    pub total: f64,
    /// Range of the means of all turns about the centre.
    pub synchronous: f64,
    /// Largest range of single turns at one place; `None` of one turn.
    pub asynchronous: Option<f64>,
    /// Range of the means of all turns with what goes round once: of an axial probe the synchronous error motion.
    pub synchronous_whole: f64,
    /// Angle (deg) of each place and the mean of all turns there about the centre.
    pub mean_turn: Vec<AngleReading>,
}

impl ErrorMotion {
    /// Returns the figures. `None` of fewer than eight places, or of places that do not show the centre.
    pub fn of(readings: &[AngleReading]) -> Option<Self> {
        let places = places(readings);
        if places.len() < LEAST_PLACES {
            return None;
        }
        let means: Vec<AngleReading> =
            places.iter().map(|(angle, values)| (*angle, values.iter().sum::<f64>() / values.len() as f64)).collect();
        let [mean, cosine, sine] = once(&means)?;
        let round = |angle: f64| {
            let (s, c) = sin_cos_degrees(angle);
            mean + cosine * c + sine * s
        };
        let centred = |(angle, values): &(f64, Vec<f64>)| {
            let off = round(*angle);
            values.iter().map(|x| x - off).collect::<Vec<f64>>()
        };
        let mean_turn: Vec<AngleReading> = means.iter().map(|(angle, x)| (*angle, x - round(*angle))).collect();
        let turns = places.iter().map(|(_, values)| values.len()).min()?;
        let spread = places.iter().map(|(_, values)| range(values.iter().copied())).fold(0.0, f64::max);
        Some(Self {
            places: places.len(),
            turns,
            once: [cosine, sine],
            total: range(places.iter().flat_map(centred)),
            synchronous: range(mean_turn.iter().map(|(_, x)| *x)),
            asynchronous: (turns > 1).then_some(spread),
            synchronous_whole: range(means.iter().map(|(_, x)| *x)),
            mean_turn,
        })
    }
}

/// Readings by place of the turn, by rising angle.
fn places(readings: &[AngleReading]) -> Vec<(f64, Vec<f64>)> {
    let turned = |(angle, value): &AngleReading| {
        let within = angle.rem_euclid(360.0);
        (if within > 360.0 - SAME { 0.0 } else { within }, *value)
    };
    let mut sorted: Vec<AngleReading> = readings.iter().map(turned).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut places: Vec<(f64, Vec<f64>)> = Vec::new();
    for (angle, value) in sorted {
        match places.last_mut().filter(|(last, _)| angle - *last < SAME) {
            Some((_, values)) => values.push(value),
            None => places.push((angle, vec![value])),
        }
    }
    places
}

/// Mean, cosine and sine part of least squares.
fn once(means: &[AngleReading]) -> Option<[f64; 3]> {
    let rows = DMatrix::from_fn(means.len(), 3, |i, j| {
        let (sine, cosine) = sin_cos_degrees(means[i].0);
        [1.0, cosine, sine][j]
    });
    let right = DVector::from_iterator(means.len(), means.iter().map(|(_, x)| *x));
    let svd = Svd::new(&rows);
    (svd.rank(0.1) == 3).then(|| svd.solve(&right, 3)).map(|x| [x[0], x[1], x[2]])
}

/// Returns the readings in the rotating sensitive direction of two fixed probes at one set of angles.
pub fn rotating(angles: &[f64], x: &[f64], y: &[f64]) -> Vec<AngleReading> {
    let one = |((angle, x), y): ((&f64, &f64), &f64)| {
        let (sine, cosine) = sin_cos_degrees(*angle);
        (*angle, x * cosine + y * sine)
    };
    angles.iter().zip(x).zip(y).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An eccentric artefact of 20 um, a second harmonic of 1.5 um, and turns 0.4 um apart in turn.
    #[test]
    fn set_up_synchronous_and_asynchronous_are_told_apart() {
        let reading = |i: i32| {
            let angle = f64::from(i) * 10.0;
            let t = angle.to_radians();
            let turn = f64::from(i / 36);
            (angle, 7.0 + 20.0 * libm::cos(t - 0.3) + 1.5 * libm::sin(2.0 * t) + 0.2 * (1.0 - 2.0 * (turn % 2.0)))
        };
        let found = ErrorMotion::of(&(0..144).map(reading).collect::<Vec<_>>()).unwrap();
        assert_eq!((found.places, found.turns), (36, 4));
        assert!((libm::hypot(found.once[0], found.once[1]) - 20.0).abs() < 1e-9);
        // sin 2t at steps of 10 deg reaches sin 80 and sin 100 deg.
        let top = 1.5 * libm::sin(80.0_f64.to_radians());
        assert!((found.synchronous - 2.0 * top).abs() < 1e-9, "{}", found.synchronous);
        assert!((found.asynchronous.unwrap() - 0.4).abs() < 1e-9);
        assert!((found.total - (2.0 * top + 0.4)).abs() < 1e-9);
        assert!(found.synchronous_whole > 39.0);
    }

    /// An artefact off centre reads a constant in the rotating direction.
    #[test]
    fn the_rotating_direction_takes_an_eccentricity_for_a_radius() {
        let angles: Vec<f64> = (0..24).map(|i| 15.0 * f64::from(i)).collect();
        let x: Vec<f64> = angles.iter().map(|a| 5.0 * libm::cos(a.to_radians())).collect();
        let y: Vec<f64> = angles.iter().map(|a| 5.0 * libm::sin(a.to_radians())).collect();
        let found = ErrorMotion::of(&rotating(&angles, &x, &y)).unwrap();
        assert!(found.synchronous < 1e-12 && libm::hypot(found.once[0], found.once[1]) < 1e-12);
        assert_eq!(found.asynchronous, None);
        assert_eq!(ErrorMotion::of(&[(0.0, 1.0); 20]), None);
    }
}
