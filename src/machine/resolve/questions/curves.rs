//! Measured curves that are allowed and seldom meant: values in another unit, and single values far out.

use super::asked::{TINY, WIDE_LOCATION, angle, ask};
use crate::diagnostic::Diagnostic;
use crate::machine::resolve::doubles::is_fitted_curve;
use crate::machine::{Curve, ErrorId, ErrorTerm, Machine};
use crate::syntax::{Document, keys};
use crate::units::{counted, significant};

/// Distance (mm, rad) of a value from the line through its neighbours from which on it is asked about.
const SPIKE: [f64; 2] = [5e-2, 2.5e-4];
/// The same over the median of those distances: bends of a curve are shared by many values.
const SPIKE_RATIO: f64 = 20.0;
/// Values from which on a table has such a median.
const JUDGED_VALUES: usize = 8;

/// Returns what to ask about the curves of a machine.
pub(super) fn curve_questions(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let one = |(error, term): (ErrorId, &ErrorTerm)| {
        let ErrorTerm::Component(component) = term else { return None };
        let sought = |curve: &Curve| {
            let knots = curve.knots()?;
            let unit = Unit::of(&error);
            let points: Vec<(f64, f64)> =
                knots.positions().iter().copied().zip(knots.values().iter().copied()).collect();
            let largest = points.iter().fold(0.0_f64, |largest, (_, value)| largest.max(value.abs()));
            unit.tiny(largest, points.len())
                .or_else(|| unit.wide(largest))
                .or_else(|| unit.spike(&points, machine.axes()[machine.axis_index(error.axis.as_str())?].unit()))
        };
        let (message, help) = component.curves().find_map(sought)?;
        let message = format!("`{error}` {message}");
        // What a fit found is no slip of a hand.
        (!is_fitted_curve(document, &error))
            .then(|| ask(document, &keys(["errors", &error.to_string()]), message, help))
    };
    machine.errors().filter_map(one).collect()
}

/// The unit of an error, with the limits in it.
struct Unit {
    turns: bool,
    factor: f64,
    micro: &'static str,
}

type Question = (String, &'static str);

impl Unit {
    fn of(error: &ErrorId) -> Self {
        let (factor, micro) = error.direction.micro();
        Self { turns: error.direction.is_rotation(), factor, micro }
    }

    fn of_limits(&self, limits: [f64; 2]) -> f64 {
        limits[usize::from(self.turns)]
    }

    fn words(&self, value: f64) -> String {
        format!("{} {}", significant(value * self.factor, 3), self.micro)
    }

    fn tiny(&self, largest: f64, count: usize) -> Option<Question> {
        let is_tiny = count > 1 && largest > 0.0 && largest < self.of_limits(TINY);
        let larger = if self.turns { "mrad or deg" } else { "mm" };
        let message = || format!("is nowhere above {}: are its values in {larger}?", self.words(largest));
        is_tiny.then(|| (message(), "write the unit of the readings in the header, or correct the values"))
    }

    fn wide(&self, largest: f64) -> Option<Question> {
        let message = || format!("reaches {}: is that meant?", angle(largest, 1e3, "mrad"));
        (self.turns && largest >= WIDE_LOCATION)
            .then(|| (message(), "microradians and arcseconds are usual: compare the unit of its values"))
    }

    /// Asks about a value far from the line through its neighbours, where the others are near theirs.
    fn spike(&self, points: &[(f64, f64)], axis_unit: &str) -> Option<Question> {
        if points.len() < JUDGED_VALUES {
            return None;
        }
        let off = |i: usize| {
            let (before, after) = match i {
                0 => (1, 2),
                last if last + 1 == points.len() => (last - 2, last - 1),
                inner => (inner - 1, inner + 1),
            };
            let [(q, value), (a, from), (b, to)] = [points[i], points[before], points[after]];
            (value - from - (to - from) * (q - a) / (b - a)).abs()
        };
        let all: Vec<f64> = (0..points.len()).map(off).collect();
        let last = points.len() - 1;
        let inner = (1..last).max_by(|a, b| all[*a].total_cmp(&all[*b]))?;
        // A value at an end draws one neighbour along, a value within two.
        let far = match inner {
            1 if all[2] < all[1] / 4.0 => 0,
            inner if inner + 1 == last && all[inner - 1] < all[inner] / 4.0 => last,
            inner => inner,
        };
        // Distances to which the value does not contribute.
        let mut others: Vec<f64> = (0..points.len()).filter(|i| i.abs_diff(far) > 2).map(|i| all[i]).collect();
        others.sort_by(f64::total_cmp);
        let (size, median) = (all[far], others.get(others.len() / 2).copied()?);
        if size < self.of_limits(SPIKE).max(SPIKE_RATIO * median) {
            return None;
        }
        let (at, value) = points[far];
        let message = format!(
            "is {} at {} {axis_unit}, {} off the line through its neighbours; of half of {} it is {} at most",
            self.words(value),
            significant(at, 6),
            self.words(size),
            counted(points.len(), "value"),
            self.words(median)
        );
        Some((message, "a misprint, or a reading that was disturbed: correct it, or leave the row out"))
    }
}
