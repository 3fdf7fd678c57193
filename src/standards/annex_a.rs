//! Uncertainty of the figures of positioning, k = 2, as ISO 230-2 annex A estimates it (equations of ISO/TR 230-9,
//! annex C; from general knowledge, not verified against the text).
//!
//! A quantity that is only known to lie in a range has an expanded uncertainty of range / sqrt(3), which the annex
//! rounds to 0.6 of the range. What acts on all readings alike (instrument, alignment, temperature, expansion) is in E,
//! M and A and cancels in B and R; drift acts on single readings.

use crate::units::{self, Dimension};

/// Expanded uncertainty of a quantity in a range, as a share of the range.
const OF_RANGE: f64 = 0.6;
/// The same of the cosine error of an offset: one-sided, R^2 / (2 L) / sqrt(3).
const OF_COSINE: f64 = 0.3;
/// Contributors of ISO/TR 230-9, from general knowledge: the list may lack some.
pub const LISTED: [&str; 6] =
    ["device calibration", "alignment", "set-up", "temperature measurement", "expansion coefficients", "EVE (drift)"];
/// Reference temperature, deg C (ISO 1).
pub const REFERENCE: f64 = 20.0;

/// A contributor to the uncertainty; lengths in mm, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contributor {
    /// The instrument's expanded uncertainty, k = 2, by its certificate: of a reading.
    Device(f64, Dimension),
    /// The same over the length measured.
    DevicePerLength(f64),
    /// The offset of the measuring line from the axis over its length, at most.
    Misalignment(f64),
    /// Range (K) of the error of a temperature sensor, and the expansion (1/K) that it is multiplied by.
    Temperature(f64, f64),
    /// Range (1/K) of the coefficient of expansion, and the largest distance (K) from 20 deg C.
    Expansion(f64, f64),
    /// Range that the set-up drifts at rest over the time of the test.
    Drift(f64, Dimension),
}

/// A temperature and a coefficient of expansion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thermal {
    /// K, or deg C.
    pub temperature: f64,
    /// Ratio per K.
    pub expansion: f64,
}

impl Thermal {
    /// Coefficients of what machines, gauges and parts are made of: Invar 1, steel 11.5, zinc 30 um/m/K.
    const MAX_EXPANSION: f64 = 6e-5;

    /// True of machines in a room.
    pub fn is_plausible(&self) -> bool {
        self.temperature.abs() <= 100.0 && self.expansion.abs() <= Self::MAX_EXPANSION
    }
}

/// Reads a temperature times an expansion: `0.7 K x 12 um/m/K`, `22.5 degC x 11.5 um/m/K`.
pub fn thermal(words: &str) -> Option<Thermal> {
    let (temperature, expansion) = words.split_once(" x ")?;
    let value = temperature.trim();
    let bare = ["degC", "\u{b0}C", "K"].iter().find_map(|unit| value.strip_suffix(unit))?;
    let temperature = units::number(bare.trim()).ok()?;
    Some(Thermal { temperature, expansion: per_kelvin(expansion)? })
}

fn per_kelvin(words: &str) -> Option<f64> {
    let quantity = units::quantity(words.trim().strip_suffix("/K")?.trim()).ok()?;
    (quantity.dimension == Dimension::RATIO).then_some(quantity.value)
}

/// Reads a contributor in words: `device 0.5 um/m`, `misalignment 1 mm`, `temperature 0.7 K x 12 um/m/K`,
/// `expansion 2 um/m/K x 5 K`, `drift 1.2 um`. `None` where the words are none of these, or a number is not above zero.
pub fn contributor(words: &str) -> Option<Contributor> {
    let (name, rest) = words.trim().split_once(' ')?;
    let rest = rest.trim();
    let above_zero = |x: f64| x > 0.0 && x.is_finite();
    let quantity = || units::quantity(rest).ok().filter(|quantity| above_zero(quantity.value));
    let size = |of: fn(f64, Dimension) -> Contributor| {
        let found = quantity()?;
        [Dimension::LENGTH, Dimension::ANGLE].contains(&found.dimension).then(|| of(found.value, found.dimension))
    };
    match name {
        "device" if rest.contains('/') => {
            quantity().filter(|q| q.dimension == Dimension::RATIO).map(|q| Contributor::DevicePerLength(q.value))
        }
        "device" => size(Contributor::Device),
        "misalignment" => quantity()?.as_length().map(Contributor::Misalignment),
        "temperature" => thermal(rest)
            .filter(|of| above_zero(of.temperature) && above_zero(of.expansion))
            .map(|of| Contributor::Temperature(of.temperature, of.expansion)),
        "expansion" => {
            let (coefficient, kelvin) = rest.split_once(" x ")?;
            let kelvin = units::number(kelvin.trim().strip_suffix('K')?.trim()).ok()?;
            let range = per_kelvin(coefficient)?;
            (above_zero(range) && above_zero(kelvin)).then_some(Contributor::Expansion(range, kelvin))
        }
        "drift" => size(Contributor::Drift),
        _ => None,
    }
}

/// Returns those of [`LISTED`] that count in an uncertainty of [`AccuracyUncertainty::of`], and those that it lacks.
pub fn contributors(all: &[Contributor], dimension: Dimension, length: Option<f64>) -> [Vec<&'static str>; 2] {
    let counts = |i: usize| all.iter().any(|of| of.listed() == i && of.size(dimension, length).is_some());
    let named = |has: bool| (0..LISTED.len()).filter(|i| counts(*i) == has).map(|i| LISTED[i]).collect();
    [named(true), named(false)]
}

/// Expanded uncertainties, k = 2, of the figures, in the unit of the readings (mm or rad).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccuracyUncertainty {
    /// Uncertainty of the systematic deviations E of one direction and of both.
    pub systematic: f64,
    /// Uncertainty of the mean deviation M.
    pub mean: f64,
    /// Uncertainty of the reversal at a target, and of B.
    pub reversal: f64,
    /// Uncertainty of the repeatabilities R.
    pub repeatability: f64,
    /// Uncertainty of the accuracies A.
    pub accuracy: f64,
}

impl AccuracyUncertainty {
    /// Returns the uncertainties of a measurement over a length (mm) with so many runs in each direction. Of all but
    /// positions of a linear axis (`is_length`) only instrument and drift count, in the unit of the readings. `None`
    /// where nothing counts.
    pub fn of(all: &[Contributor], dimension: Dimension, length: Option<f64>, runs: usize) -> Option<Self> {
        let (mut common, mut drift, mut counted) = (0.0, 0.0, false);
        for contributor in all {
            let Some((size, is_drift)) = contributor.size(dimension, length) else { continue };
            *(if is_drift { &mut drift } else { &mut common }) += size * size;
            counted = true;
        }
        let n = runs.max(1) as f64;
        let root = |x: f64| libm::sqrt(x);
        let (systematic, repeatability) = (root(common + drift / n), 2.0 * root(drift));
        counted.then(|| Self {
            systematic,
            mean: root(common + drift / (2.0 * n)),
            reversal: root(2.0 * drift / n),
            repeatability,
            accuracy: root(systematic * systematic + repeatability * repeatability),
        })
    }
}

impl Contributor {
    /// Its place in [`LISTED`]; the set-up has no words of its own.
    fn listed(self) -> usize {
        match self {
            Self::Device(..) | Self::DevicePerLength(_) => 0,
            Self::Misalignment(_) => 1,
            Self::Temperature(..) => 3,
            Self::Expansion(..) => 4,
            Self::Drift(..) => 5,
        }
    }

    /// Its expanded uncertainty, and whether it is a drift; `None` where it does not count.
    fn size(self, dimension: Dimension, length: Option<f64>) -> Option<(f64, bool)> {
        let over = |ratio: f64| length.map(|length| (ratio * length, false));
        match self {
            Self::Device(size, of) => (of == dimension).then_some((size, false)),
            Self::Drift(size, of) => (of == dimension).then_some((OF_RANGE * size, true)),
            Self::DevicePerLength(ratio) => over(ratio),
            Self::Misalignment(offset) => {
                length.filter(|length| *length > 0.0).map(|length| (OF_COSINE * offset * offset / length, false))
            }
            Self::Temperature(kelvin, expansion) => over(OF_RANGE * expansion * kelvin),
            Self::Expansion(range, kelvin) => over(OF_RANGE * range * kelvin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the annex's tables: 1 mm over 300 mm, 0.7 K, 2 um/m/K at 5 K.
    #[test]
    fn contributors_have_their_sizes() {
        let size = |words: &str, length: f64| {
            let found = contributor(words).unwrap_or_else(|| panic!("{words}"));
            found.size(Dimension::LENGTH, Some(length)).unwrap().0 * 1e3
        };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        near(size("misalignment 1 mm", 300.0), 1.0);
        near(size("temperature 0.7 K x 12 um/m/K", 1000.0), 5.04);
        near(size("expansion 2 um/m/K x 5 K", 1000.0), 6.0);
        near(size("device 0.5 um/m", 2000.0), 1.0);
        near(size("device 0.4 um", 2000.0), 0.4);
        near(size("drift 1.2 um", 1.0), 0.72);
        for wrong in
            ["device", "device 0 um", "device 3", "drift 1 um/m", "temperature 0.7 K", "laser 1 um", "drift 1e400 um"]
        {
            assert_eq!(contributor(wrong), None, "{wrong}");
        }
    }

    /// A part that all readings share cancels in B and R; drift has its shares of 5 runs: 0.63, 0.45, 0.32 and twice.
    #[test]
    fn shares_are_those_of_means() {
        let all = [contributor("device 3 um").unwrap(), contributor("drift 10 um").unwrap()];
        let found = AccuracyUncertainty::of(&all, Dimension::LENGTH, Some(500.0), 5).unwrap();
        let near = |found: f64, expected: f64| assert!((found * 1e3 - expected).abs() < 1e-9, "{found} {expected}");
        let drift = 6.0_f64;
        near(found.reversal, drift * (2.0_f64 / 5.0).sqrt());
        near(found.systematic, (9.0 + drift * drift / 5.0).sqrt());
        near(found.mean, (9.0 + drift * drift / 10.0).sqrt());
        near(found.repeatability, 12.0);
        near(found.accuracy, (9.0 + drift * drift / 5.0 + 144.0).sqrt());
        assert_eq!(AccuracyUncertainty::of(&all, Dimension::ANGLE, None, 5), None);
        let [has, lacks] = contributors(&all, Dimension::LENGTH, Some(500.0));
        assert_eq!(has, ["device calibration", "EVE (drift)"]);
        assert_eq!(lacks, ["alignment", "set-up", "temperature measurement", "expansion coefficients"]);
        assert_eq!(contributors(&all, Dimension::ANGLE, None), [vec![], LISTED.to_vec()]);
    }
}
