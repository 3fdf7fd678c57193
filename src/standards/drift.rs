//! Thermal drift (ISO 230-3): displacements over time, and the tilts of two probes at a distance.

use super::range;
use std::collections::VecDeque;

/// The first part of a test, of which the standard wants figures of its own (minutes).
pub const FIRST: f64 = 60.0;

/// Figures of one displacement or tilt, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriftFigures {
    /// Range over the whole test.
    pub total: f64,
    /// Range over the first hour.
    pub first: f64,
    /// Last reading minus first.
    pub change: f64,
    /// Largest change within an hour anywhere in the test.
    pub largest_in_an_hour: f64,
}

impl DriftFigures {
    /// Returns the figures of readings at times (minutes, rising). `None` without readings.
    pub fn of(times: &[f64], values: &[f64]) -> Option<Self> {
        let (start, first, last) = (*times.first()?, *values.first()?, *values.last()?);
        let early = times.iter().zip(values).filter(|(t, _)| **t - start <= FIRST).map(|(_, x)| *x);
        Some(Self {
            total: range(values.iter().copied()),
            first: range(early),
            change: last - first,
            largest_in_an_hour: hourly(times, values),
        })
    }
}

/// The largest range within an hour: of each window that begins at a reading, by the readings that may be its extremes.
fn hourly(times: &[f64], values: &[f64]) -> f64 {
    let mut largest: f64 = 0.0;
    // Indices of falling and of rising values within the window: the first is the extreme.
    let (mut high, mut low) = (VecDeque::new(), VecDeque::new());
    for (i, (time, value)) in times.iter().zip(values).enumerate() {
        while high.back().is_some_and(|k: &usize| values[*k] <= *value) {
            let _ = high.pop_back();
        }
        while low.back().is_some_and(|k: &usize| values[*k] >= *value) {
            let _ = low.pop_back();
        }
        high.push_back(i);
        low.push_back(i);
        for window in [&mut high, &mut low] {
            while window.front().is_some_and(|k| time - times[*k] > FIRST) {
                let _ = window.pop_front();
            }
        }
        if let (Some(top), Some(bottom)) = (high.front(), low.front()) {
            largest = largest.max(values[*top] - values[*bottom]);
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_over_time() {
        let times: Vec<f64> = (0..241).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| 20.0 * (1.0 - libm::exp(-t / 60.0))).collect();
        let found = DriftFigures::of(&times, &values).unwrap();
        let hour = 20.0 * (1.0 - libm::exp(-1.0));
        assert!((found.first - hour).abs() < 1e-12 && (found.largest_in_an_hour - hour).abs() < 1e-12);
        assert!((found.total - 20.0 * (1.0 - libm::exp(-4.0))).abs() < 1e-12 && found.change == found.total);
        // A fall between two slow rises: every window against the slow way.
        let values: Vec<f64> = times.iter().map(|t| libm::sin(t / 37.0) * 9.0 + libm::cos(t / 11.0)).collect();
        let slow = |i: usize| {
            let window = (i..241).take_while(|k| times[*k] - times[i] <= FIRST).map(|k| values[k]);
            range(window)
        };
        let expected = (0..241).map(slow).fold(0.0, f64::max);
        assert_eq!(DriftFigures::of(&times, &values).unwrap().largest_in_an_hour, expected);
    }
}
