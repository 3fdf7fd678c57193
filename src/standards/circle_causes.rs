//! A circular test taken apart into causes by least squares. Readings of reversal spikes do not count in the others.

use super::circle::{CircleFit, RadialReading, Sense, fit_circle};
use super::spikes::{AnglePath, Judged, TURNING_POINTS, height};
use crate::machine::sin_cos_degrees;
use nalgebra::{DMatrix, DVector};

/// A value with its standard uncertainty by the scatter that the causes leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Caused {
    /// The value.
    pub value: f64,
    /// Standard uncertainty, type A; `None` without readings to spare.
    pub sigma: Option<f64>,
}

/// A circle taken apart into causes.
#[derive(Debug, Clone, PartialEq)]
pub struct CircleCauses {
    /// Angle between the directions of the plane minus 90 deg, urad. Of one sense servo mismatch is in it.
    pub squareness: Caused,
    /// Scale of the first direction minus scale of the second, um/m.
    pub scale_mismatch: Caused,
    /// Half the difference of counter-clockwise and clockwise at 45 deg, um: above zero the first axis lags more.
    /// `None` of one sense.
    pub servo: Option<Caused>,
    /// Reversal of both axes, um, signed as ISO 230-2 signs it: below zero is lost motion.
    pub reversal: [Caused; 2],
    /// The turning points of both axes, by rising angle: the first axis at its largest, the second, and so on.
    pub turning_points: [TurningPoint; 4],
    /// Root mean square of what the causes leave beside spikes, um.
    pub rest: f64,
}

/// The place where an axis turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Its angle, deg.
    pub angle: f64,
    /// The reversal spike after it.
    pub spike: Option<Spike>,
    /// Height (um) from which on a spike of any length would be found; `None` where the readings are too few.
    pub limit: Option<f64>,
}

/// A reversal spike, the same in both senses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spike {
    /// Height, um: above zero outwards.
    pub height: Caused,
    /// Where it begins, deg travelled after the turning point.
    pub start: f64,
    /// Length at half its height, deg.
    pub width: f64,
    /// Probability that normal scatter shows one as strong at any of the turning points.
    pub chance: f64,
}

/// Returns the causes of a circle of a nominal radius (mm). `None` where the readings do not tell them apart.
pub fn causes(readings: &[RadialReading], radius: f64) -> Option<CircleCauses> {
    let design = Design::of(readings, radius);
    let path = AnglePath::of(readings);
    let found = match design.fit(path.windows()) {
        Some(first) => path.judge(&design.residuals(&first), |weights| design.variance(&first, weights)),
        None => Default::default(),
    };
    let spikes = TURNING_POINTS.iter().zip(&found).filter_map(|(at, judged)| Some((*at, judged.spike.as_ref()?.pulse)));
    let fit = design.fit(spikes.flat_map(|(at, pulse)| path.spike(at, pulse)))?;
    let left = design.residuals(&fit);
    let spike = |judged: &Judged| {
        let found = judged.spike.as_ref()?;
        let variance = found.variance + design.variance(&fit, &found.weights);
        let height = Caused { value: height(&found.weights, &left), sigma: Some(libm::sqrt(variance)) };
        Some(Spike { height, start: found.pulse.start, width: found.pulse.width(), chance: found.chance })
    };
    let turning = |k: usize| TurningPoint { angle: TURNING_POINTS[k], spike: spike(&found[k]), limit: found[k].limit };
    let caused = |j: usize| Caused { value: fit.values[j], sigma: fit.sigma(j) };
    Some(CircleCauses {
        squareness: caused(3),
        scale_mismatch: caused(4),
        reversal: [caused(5), caused(6)],
        servo: (fit.values.len() == EFFECTS).then(|| caused(7)),
        turning_points: [0, 1, 2, 3].map(turning),
        rest: fit.rest,
    })
}

/// Number of causes with both senses.
const EFFECTS: usize = 8;

/// Readings with the effects of all causes.
struct Design<'a> {
    readings: &'a [RadialReading],
    rows: DMatrix<f64>,
}

impl<'a> Design<'a> {
    fn of(readings: &'a [RadialReading], radius: f64) -> Self {
        let both = Sense::ALL.iter().all(|sense| readings.iter().any(|r| r.sense == *sense));
        let count = if both { EFFECTS } else { EFFECTS - 1 };
        let effects = readings.iter().flat_map(|reading| effects(reading, radius).into_iter().take(count));
        Self { readings, rows: DMatrix::from_row_iterator(readings.len(), count, effects) }
    }

    /// Fits all readings but some.
    fn fit(&self, left_out: impl Iterator<Item = usize>) -> Option<CircleFit> {
        let mut kept = vec![true; self.readings.len()];
        left_out.for_each(|i| kept[i] = false);
        let kept: Vec<usize> = (0..kept.len()).filter(|i| kept[*i]).collect();
        let readings: Vec<RadialReading> = kept.iter().map(|i| self.readings[*i]).collect();
        fit_circle(&self.rows.select_rows(&kept), &readings)
    }

    fn residuals(&self, fit: &CircleFit) -> Vec<f64> {
        let predicted = &self.rows * &fit.values;
        self.readings.iter().zip(predicted.iter()).map(|(reading, value)| reading.deviation - value).collect()
    }

    /// The variance of a weighted sum of what a fit predicts.
    fn variance(&self, fit: &CircleFit, weights: &[(usize, f64)]) -> f64 {
        let mut sum = DVector::zeros(self.rows.ncols());
        weights.iter().for_each(|(i, weight)| sum += self.rows.row(*i).transpose() * *weight);
        fit.variance(&sum)
    }
}

/// Radial effects (um) of a unit of each cause: radius and centre, squareness (urad), scale (um/m), both reversals
/// and the servo mismatch (um).
fn effects(reading: &RadialReading, radius: f64) -> [f64; EFFECTS] {
    let (sine, cosine) = sin_cos_degrees(reading.angle);
    let (sine_2, cosine_2) = sin_cos_degrees(2.0 * reading.angle);
    let sense = reading.sense.sign();
    let half = 0.5e-3 * radius;
    // An axis that moves up is half its reversal above the middle.
    let up = |speed: f64| if speed == 0.0 { 0.0 } else { 0.5 * speed.signum() };
    let reversals = [cosine * up(-sense * sine), sine * up(sense * cosine)];
    [1.0, cosine, sine, -half * sine_2, half * cosine_2, reversals[0], reversals[1], sense * sine_2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standards::circle::tests::circle;

    /// Each cause by a machine that has it: the path itself, not its first order.
    #[test]
    fn causes_are_told_apart() {
        let (radius, square, scale, lag, lost) = (100.0, 50e-6, 30e-6, 2e-3, [4e-3, 7e-3]);
        let readings = circle(5, |t, sense| {
            let s = sense.sign();
            // The first axis lags by 2 um of path more than the second; each axis falls short by half its lost motion.
            let (dx, dy) = (-libm::sin(t) * s, libm::cos(t) * s);
            let x = radius * libm::cos(t) * (1.0 + scale) - 0.5 * lost[0] * dx.signum() - lag * dx;
            let y = radius * libm::sin(t) - 0.5 * lost[1] * dy.signum();
            // An angle above 90 deg leans the second direction against the first.
            (libm::hypot(x - square * y, y) - radius) * 1e3 + 3.0 * libm::cos(t) - 1.0 * libm::sin(t)
        });
        let found = causes(&readings, radius).unwrap();
        let near =
            |found: Caused, expected: f64| assert!((found.value - expected).abs() < 0.02, "{found:?} {expected}");
        near(found.squareness, 50.0);
        near(found.scale_mismatch, 30.0);
        near(found.reversal[0], -4.0);
        near(found.reversal[1], -7.0);
        // Half the lag difference, outwards at 45 deg.
        near(found.servo.unwrap(), 1.0);
        assert!(found.rest < 0.01, "{}", found.rest);
    }
}
