//! Places of a part to be tried: ranges of its origin and of its rotations.

use super::placement::Placement;
use crate::diagnostic::{Reason, shown};
use crate::units::{FARTHEST, number, quantity};

/// The numbers of a place, in their order.
const NAMES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// Index of the first rotation.
const FIRST_ROTATION: usize = 3;

/// Number of values of a range that states none.
const DEFAULT_COUNT: usize = 9;

/// Maximum number of values of a range.
const MAX_COUNT: usize = 1000;

/// Largest rotation, deg.
const TURN_DEG: f64 = 360.0;

/// Values of one number of a place.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PlaceRange {
    /// `X`, `Y`, `Z` of `origin`, or `A`, `B`, `C` of `rotation`, which turn about X, Y, Z.
    pub of: &'static str,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// The first and the last value.
    pub ends: [f64; 2],
    /// Number of values at equal distances.
    pub count: usize,
}

impl PlaceRange {
    /// Reads `X=-200..200:9`, `X=-200..200` or `X=40`.
    fn parse(text: &str) -> Option<Self> {
        let (name, values) = text.split_once('=')?;
        let index = NAMES.iter().position(|known| name.trim().eq_ignore_ascii_case(known))?;
        let (of, unit) = (NAMES[index], if index < FIRST_ROTATION { "mm" } else { "deg" });
        let (ends, count) = match values.rsplit_once(':') {
            Some((ends, count)) => (ends, count.trim().parse().ok()?),
            None => (values, DEFAULT_COUNT),
        };
        let Some((first, last)) = ends.split_once("..") else {
            let only = value(values, unit)?;
            return Some(Self { of, unit, ends: [only; 2], count: 1 });
        };
        let ends = [value(first, unit)?, value(last, unit)?];
        (ends[0] < ends[1] && (2..=MAX_COUNT).contains(&count)).then_some(Self { of, unit, ends, count })
    }

    /// Returns the value of a step below `count`, mm or deg.
    pub(crate) fn value(&self, step: usize) -> f64 {
        let [first, last] = self.ends;
        match self.count - 1 {
            end if step == 0 || end == 0 => first,
            end if step == end => last,
            end => first + (last - first) * (step as f64 / end as f64),
        }
    }

    /// Returns the same number of a place, mm or deg.
    pub fn of_place(&self, place: &Placement) -> f64 {
        place.numbers()[self.index()]
    }

    fn index(&self) -> usize {
        NAMES.iter().position(|name| *name == self.of).unwrap_or_default()
    }

    /// True if a place is at an end beyond which there may be a better one.
    fn is_edge(&self, place: &Placement) -> bool {
        let [first, last] = self.ends;
        let closed = self.unit == "deg" && last - first >= TURN_DEG;
        self.count > 1 && !closed && self.ends.contains(&self.of_place(place))
    }
}

/// Reads a value with or without its unit, mm or deg.
fn value(text: &str, unit: &str) -> Option<f64> {
    let with_unit = || {
        let quantity = quantity(text).ok()?;
        if unit == "mm" { quantity.as_length() } else { quantity.as_angle().map(f64::to_degrees) }
    };
    let value = number(text).ok().or_else(with_unit)?;
    let largest = if unit == "mm" { FARTHEST } else { TURN_DEG };
    // Adding zero turns -0 into 0.
    (value.abs() <= largest).then_some(value + 0.0)
}

/// Places on a grid of ranges; numbers without a range are those of the job.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlaceGrid {
    /// The ranges as they are named.
    pub ranges: Vec<PlaceRange>,
    own: Placement,
}

impl PlaceGrid {
    /// Reads ranges such as `X=-200..200:9,C=0..90:4`, about the place of a job.
    pub(crate) fn parse(text: &str, own: Placement) -> Result<Self, Reason> {
        let mut ranges: Vec<PlaceRange> = Vec::new();
        for part in text.split(',') {
            let range = PlaceRange::parse(part).ok_or_else(|| {
                Reason::new(format!(
                    "`{}` is no range of places: `X=-200..200:9` is nine values in mm (2 to {MAX_COUNT}, rising; nine \
                     without a number), `C=0..90:4` four in deg, `Z=40` one",
                    shown(part)
                ))
            })?;
            if ranges.iter().any(|known| known.of == range.of) {
                return Err(Reason::new(format!("`{}` of the place is given twice", range.of)));
            }
            ranges.push(range);
        }
        Ok(Self { ranges, own })
    }

    /// Returns the number of places.
    pub(crate) fn len(&self) -> usize {
        self.ranges.iter().fold(1, |product, range| product.saturating_mul(range.count))
    }

    /// True if places turn the part otherwise than the job does.
    pub(crate) fn turns(&self) -> bool {
        self.ranges.iter().any(|range| range.unit == "deg" && range.ends != [range.of_place(&self.own); 2])
    }

    /// Returns the places, the first range running fastest.
    pub(crate) fn places(&self) -> impl Iterator<Item = Placement> {
        (0..self.len()).map(|index| {
            let mut numbers = self.own.numbers();
            let mut rest = index;
            for range in &self.ranges {
                numbers[range.index()] = range.value(rest % range.count);
                rest /= range.count;
            }
            Placement::of_numbers(numbers)
        })
    }

    /// Returns the names of the ranges at whose end a place is.
    pub(crate) fn edges(&self, place: &Placement) -> Vec<&'static str> {
        self.ranges.iter().filter(|range| range.is_edge(place)).map(|range| range.of).collect()
    }
}
