//! Gauges: a distance between two points of the set-up (balls, stations) that is known before the data:
//! `distance b1 b2 = 50 mm 20 um`.

use super::known::{refusal, value_and_sigma};
use super::parameter::Parameter;
use super::refusal::Refusal;
use crate::diagnostic::shown;
use crate::identify::thresholds::{MAX_FRAME_MISFIT_SHARE, MIN_LENGTH_MM};
use crate::units::{Dimension, significant};
use nalgebra::Vector3;

/// A known distance between two points.
#[derive(Debug, Clone, PartialEq)]
pub struct Gauge {
    /// `distance ball b1 ball b2`.
    pub name: String,
    /// First of the three unknowns of each point.
    pub ends: [usize; 2],
    /// Vector from the first point to the second where all six unknowns are 0 (mm).
    pub way: Vector3<f64>,
    /// Distance (mm).
    pub length: f64,
    /// Standard uncertainty of the distance (mm).
    pub sigma: f64,
}

const HELP: &str = "write two balls or stations of the report, their distance and its standard uncertainty: \
                    `distance b1 b2 = 50 mm 20 um`";
const COORDINATES: [&str; 3] = [".x", ".y", ".z"];

const FAR: &str = "check its unit and the points; of a machine that is so far off, state the size of its errors: \
                   `identify: { plausible: { length: 60 mm } }`";

/// Reads gauges in words, one for each set-up that has both points; `None` if the words are of another prior.
///
/// `bases` holds the zero of each unknown (mm), `plausible` the size (mm) of an error that is no mistake.
/// Fails if a point is unknown or named twice, and if the distance is none, or not that of the points as they start.
pub fn parse_gauge(
    words: &str,
    unknowns: &[Parameter],
    bases: &[f64],
    plausible: f64,
) -> Result<Option<Vec<Gauge>>, Refusal> {
    let Some(rest) = words.trim().strip_prefix("distance ") else { return Ok(None) };
    let said = shown(words);
    let fail = |what: &str| refusal(format!("the prior `{said}` {what}"), HELP);
    let (names, quantities) = rest.split_once('=').ok_or_else(|| fail("has no distance"))?;
    let (length, sigma) = value_and_sigma(quantities).ok_or_else(|| fail("has no uncertainty that can be read"))?;
    if length.dimension != Dimension::LENGTH || sigma.dimension != Dimension::LENGTH {
        return Err(fail("is not in units of length"));
    }
    if !(length.value > 0.0 && sigma.value > 0.0) {
        return Err(fail("has a distance or an uncertainty that is not above zero"));
    }
    let points = points(unknowns);
    let names: Vec<&str> = names.split_whitespace().collect();
    let found: Vec<_> = (1..names.len())
        .map(|cut| names.split_at(cut))
        .map(|(a, b)| pairs(&points, &a.join(" "), &b.join(" ")))
        .filter(|found| !found.is_empty())
        .collect();
    let [pairs] = &found[..] else {
        let known: Vec<String> = points.iter().map(|(label, _)| format!("`{label}`")).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        return Err(fail(&format!("does not name two points of one set-up; the points are {known}")));
    };
    let one = |[a, b]: &[usize; 2]| {
        let ends = [points[*a].1, points[*b].1];
        if ends[0] == ends[1] {
            return Err(fail("names one point twice"));
        }
        let base = |end: usize| Vector3::from_fn(|k, _| bases[end + k]);
        let name = format!("distance {} {}", points[*a].0, points[*b].0);
        let way = base(ends[1]) - base(ends[0]);
        let gauge = Gauge { name, ends, way, length: length.value, sigma: sigma.value };
        let start: Vec<f64> = unknowns.iter().map(|p| p.start).collect();
        let apart = gauge.way(&start).norm();
        let off = (apart - gauge.length).abs();
        // Where the points start is seen through the errors of the machine.
        if apart < MIN_LENGTH_MM || off > plausible + MAX_FRAME_MISFIT_SHARE * gauge.length {
            let apart = significant(apart, 4);
            let message = format!("the prior `{said}` is not near the {apart} mm between the points as they start");
            return Err(refusal(message, FAR));
        }
        Ok(gauge)
    };
    pairs.iter().map(one).collect::<Result<_, _>>().map(Some)
}

/// Returns the balls and stations among unknowns: their names and the first of their unknowns.
fn points(unknowns: &[Parameter]) -> Vec<(&str, usize)> {
    let point = |j: usize| {
        let three = unknowns.get(j..j + 3)?;
        let label = three[0].name.strip_suffix(COORDINATES[0]).filter(|_| three[0].is_nuisance())?;
        let bare = label.rsplit_once('/').map_or(label, |(_, bare)| bare);
        let is_whole = three.iter().zip(COORDINATES).all(|(p, end)| p.name.strip_suffix(end) == Some(label));
        (is_whole && (bare.starts_with("ball") || bare.starts_with("station"))).then_some((label, j))
    };
    (0..unknowns.len()).filter_map(point).collect()
}

/// Returns the pairs of points of these names that belong together: what stands before the names, file, kind and run,
/// is the same; or there is only one of each.
fn pairs(points: &[(&str, usize)], first: &str, second: &str) -> Vec<[usize; 2]> {
    let named = |name: &str| -> Vec<(usize, String)> {
        let before = |label: &str| {
            let head = label.strip_suffix(name)?;
            (head.is_empty() || head.ends_with([' ', '/'])).then(|| head.to_owned())
        };
        points.iter().enumerate().filter_map(|(i, (label, _))| Some((i, before(label)?))).collect()
    };
    let (first, second) = (named(first), named(second));
    if let ([(a, _)], [(b, _)]) = (&first[..], &second[..]) {
        return vec![[*a, *b]];
    }
    let same = |(a, head): &(usize, String)| second.iter().find(|(_, other)| other == head).map(|(b, _)| [*a, *b]);
    first.iter().filter_map(same).collect()
}

impl Gauge {
    fn way(&self, theta: &[f64]) -> Vector3<f64> {
        self.way + Vector3::from_fn(|k, _| theta[self.ends[1] + k] - theta[self.ends[0] + k])
    }

    /// Returns the distance (mm) at these unknowns, and its derivatives by unknown.
    pub(crate) fn found(&self, theta: &[f64]) -> (f64, [(usize, f64); 6]) {
        let (row, _) = self.row(theta);
        (self.way(theta).norm(), row.map(|(j, share)| (j, share * self.sigma)))
    }

    /// True if both are of the same two points.
    pub fn is_of_same(&self, other: &Self) -> bool {
        self.ends == other.ends || [self.ends[1], self.ends[0]] == other.ends
    }

    /// Returns the gauge among the unknowns that are kept, by their indices in rising order; `None` if a coordinate of
    /// its points is not.
    pub(crate) fn among(&self, kept: &[usize]) -> Option<Self> {
        let place = |end: usize| {
            let first = kept.binary_search(&end).ok()?;
            kept.get(first..first + 3)?.iter().eq(&[end, end + 1, end + 2]).then_some(first)
        };
        Some(Self { ends: [place(self.ends[0])?, place(self.ends[1])?], ..self.clone() })
    }

    /// Returns the equation at these unknowns, over its standard uncertainty: coefficients by unknown, and the right
    /// side.
    pub(super) fn row(&self, theta: &[f64]) -> ([(usize, f64); 6], f64) {
        let way = self.way(theta);
        let apart = way.norm();
        let towards = way / apart.max(MIN_LENGTH_MM) / self.sigma;
        let entry = |i: usize| {
            let sign = if i < 3 { -1.0 } else { 1.0 };
            (self.ends[i / 3] + i % 3, sign * towards[i % 3])
        };
        let row: [(usize, f64); 6] = std::array::from_fn(entry);
        let there: f64 = row.iter().map(|(j, share)| share * theta[*j]).sum();
        (row, (self.length - apart) / self.sigma + there)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_its_points_where_others_are_left_out() {
        let gauge = Gauge {
            name: "distance b1 b2".to_owned(),
            ends: [2, 7],
            way: Vector3::new(50.0, 0.0, 0.0),
            length: 50.0,
            sigma: 0.02,
        };
        let all: Vec<usize> = (0..10).collect();
        assert_eq!(gauge.among(&all), Some(gauge.clone()));
        let less: Vec<usize> = all.iter().copied().filter(|j| ![0, 5, 6].contains(j)).collect();
        assert_eq!(gauge.among(&less).map(|of| of.ends), Some([1, 4]));
        for coordinate in [2, 3, 4, 7, 8, 9] {
            let less: Vec<usize> = all.iter().copied().filter(|j| *j != coordinate).collect();
            assert_eq!(gauge.among(&less), None, "{coordinate}");
        }
    }
}
