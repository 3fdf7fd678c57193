//! Touches: the axes as they stand when a probe has met a feature of the workpiece from a stated direction. A feature
//! is a rigid body (a ball, a plane, a rod, a corner) that nobody has placed to microns: its displacement and rotation
//! are unknowns, as far as its touches feel them.

use super::measurement::{InstrumentUnknown, LEVER_MM};
use crate::algebra::linear::beside;
use crate::identify::thresholds::{MAX_SIZE_GAP_MM, MIN_TOUCH_SHARE, TOUCH_LOBE_MM};
use nalgebra::{DVector, Vector3};

/// A touch.
#[derive(Debug, Clone)]
pub(super) struct Touch {
    /// Nominal functional point (mm, workpiece frame).
    pub point: Vector3<f64>,
    /// Direction from the feature to the probe, workpiece frame; a unit vector.
    pub normal: Vector3<f64>,
    /// The same in the frame of the tool.
    pub in_tool: Vector3<f64>,
    /// Index of the tool.
    pub tool: usize,
}

/// The unknowns of touches of the same features with the same probes.
pub(super) struct TouchUnknowns {
    pub list: Vec<InstrumentUnknown>,
    /// For each touch the unknowns (indices in `list`) and what a unit of each adds to its reading.
    pub shares: Vec<Vec<(usize, f64)>>,
    /// For each touch its nominal distance (mm) from where its feature is taken to be, along the direction.
    pub nominal: Vec<f64>,
}

/// Orthonormal columns.
#[derive(Default)]
pub(super) struct Columns(Vec<DVector<f64>>);

impl Columns {
    /// Adds a column, unless it is too small or depends on the others.
    pub fn add(&mut self, column: &DVector<f64>) -> bool {
        let rest = beside(column.clone(), &self.0);
        let norm = rest.norm();
        let is_seen = norm > MIN_TOUCH_SHARE * (column.len() as f64).sqrt();
        if is_seen {
            self.0.push(rest / norm);
        }
        is_seen
    }
}

/// Returns what features (or runs), of which these are the members and the spans of columns, do not take up of a column
/// of all touches.
pub(super) fn beside_features<'m>(
    column: &DVector<f64>,
    features: impl Iterator<Item = &'m Vec<usize>>,
    spans: &[Columns],
) -> DVector<f64> {
    let mut rest = column.clone();
    for (members, span) in features.zip(spans) {
        let own = DVector::from_iterator(members.len(), members.iter().map(|i| column[*i]));
        members.iter().zip(beside(own, &span.0).iter()).for_each(|(i, x)| rest[*i] = *x);
    }
    rest
}

/// Returns the features (by index) of each size, the smallest first: distances of their touches from the middle, as far
/// as their places do not take them up, that differ by more than errors of a machine do. A feature that shows no size
/// goes with the first ones.
fn sizes(nominal: &[f64], features: &[(String, Vec<usize>)], spans: &[Columns]) -> Vec<Vec<usize>> {
    let of = |(members, span): (&Vec<usize>, &Columns)| {
        let ones = beside(DVector::from_element(members.len(), 1.0), &span.0);
        let far = DVector::from_iterator(members.len(), members.iter().map(|i| nominal[*i]));
        let square = ones.norm_squared();
        (square > MIN_TOUCH_SHARE * MIN_TOUCH_SHARE * members.len() as f64).then(|| ones.dot(&far) / square)
    };
    let found: Vec<Option<f64>> = features.iter().map(|(_, members)| members).zip(spans).map(of).collect();
    let mut seen: Vec<(f64, usize)> = found.iter().enumerate().filter_map(|(k, size)| Some(((*size)?, k))).collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for (size, k) in seen {
        match groups.last_mut() {
            Some(group) if size - last <= MAX_SIZE_GAP_MM => group.push(k),
            _ => groups.push(vec![k]),
        }
        last = size;
    }
    let unseen = (0..features.len()).filter(|k| found[*k].is_none());
    match groups.first_mut() {
        Some(first) => first.extend(unseen),
        None => groups.push(unseen.collect()),
    }
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
}

const MOTIONS: [&str; 6] = ["x", "y", "z", "A", "B", "C"];

impl TouchUnknowns {
    /// Finds the unknowns of touches, of which `features` are names and members, and balls if `are_balls`, which have
    /// no rotation; `tool_name` gives the name of a tool by index, empty if there is one.
    pub fn of(
        touches: &[Touch],
        features: &[(String, Vec<usize>)],
        are_balls: bool,
        tool_name: &dyn Fn(usize) -> String,
    ) -> Self {
        let count = touches.len();
        let mut all = Self { list: Vec::new(), shares: vec![Vec::new(); count], nominal: vec![0.0; count] };
        let mut spans = Vec::new();
        for (name, members) in features {
            spans.push(all.add_feature(touches, name, members, if are_balls { 3 } else { 6 }));
        }
        let sizes = sizes(&all.nominal, features, &spans);
        let mut tools: Vec<usize> = touches.iter().map(|touch| touch.tool).collect();
        tools.sort_unstable();
        tools.dedup();
        let mut own = Columns::default();
        for tool in tools {
            // Radius less pre-travel, of features of each size by itself.
            for size in &sizes {
                let is_of = |i: &usize| touches[*i].tool == tool;
                let members = || size.iter().flat_map(|of| &features[*of].1).copied().filter(is_of);
                let mut column = DVector::zeros(count);
                members().for_each(|i| column[i] = 1.0);
                let rest = beside_features(&column, features.iter().map(|(_, members)| members), &spans);
                if own.add(&rest) {
                    let of = match (&sizes[..], size.first()) {
                        ([_, _, ..], Some(first)) => format!(" {}", features[*first].0),
                        _ => String::new(),
                    };
                    let name = format!("touch constant{of}{}", tool_name(tool));
                    all.push(name, false, None, members().map(|i| (i, 1.0)));
                }
            }
            // Pre-travel with three lobes turns with the probe.
            let lobe = |touch: &Touch, part: usize| {
                let [x, y] = [touch.in_tool.x, touch.in_tool.y];
                let angle = 3.0 * libm::atan2(y, x);
                libm::hypot(x, y) * if part == 1 { libm::cos(angle) } else { libm::sin(angle) }
            };
            let share = |touch: &Touch, part: usize| if touch.tool == tool { lobe(touch, part) } else { 0.0 };
            for (part, word) in [(1, "cos"), (2, "sin")] {
                let column = DVector::from_iterator(count, touches.iter().map(|touch| share(touch, part)));
                let rest = beside_features(&column, features.iter().map(|(_, members)| members), &spans);
                if own.add(&rest) {
                    let name = format!("touch lobe {word}{}", tool_name(tool));
                    all.push(name, false, Some(TOUCH_LOBE_MM), column.iter().copied().enumerate());
                }
            }
        }
        all
    }

    fn push(&mut self, name: String, is_angle: bool, known: Option<f64>, shares: impl Iterator<Item = (usize, f64)>) {
        let index = self.list.len();
        self.list.push(InstrumentUnknown { name, is_angle, start: 0.0, known, base: 0.0 });
        shares.filter(|(_, share)| *share != 0.0).for_each(|(i, share)| self.shares[i].push((index, share)));
    }

    /// Adds the displacement and rotation, or the first so many of these six motions, of a feature about the middle of
    /// its touches; returns the span of their columns.
    fn add_feature(&mut self, touches: &[Touch], name: &str, members: &[usize], motions: usize) -> Columns {
        let points = members.iter().map(|i| touches[*i].point);
        let middle = points.sum::<Vector3<f64>>() / members.len().max(1) as f64;
        let mut span = Columns::default();
        for (k, letter) in MOTIONS.into_iter().enumerate().take(motions) {
            let share = |i: &usize| {
                let Touch { point, normal, .. } = &touches[*i];
                if k < 3 { normal[k] } else { (point - middle).cross(normal)[k - 3] }
            };
            let shares: Vec<f64> = members.iter().map(share).collect();
            let scale = if k < 3 { 1.0 } else { 1.0 / LEVER_MM };
            if span.add(&(DVector::from_column_slice(&shares) * scale)) {
                self.push(format!("{name}.{letter}"), k >= 3, None, members.iter().copied().zip(shares));
                // The distance of two balls, which may be known, counts from the places that they are displaced from.
                self.list.last_mut().filter(|_| motions == 3).into_iter().for_each(|ball| ball.base = middle[k]);
            }
        }
        for i in members {
            self.nominal[*i] = touches[*i].normal.dot(&(touches[*i].point - middle));
        }
        span
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touches(list: &[([f64; 3], [f64; 3])]) -> Vec<Touch> {
        let one = |(point, normal): &([f64; 3], [f64; 3])| {
            let normal = Vector3::from(*normal).normalize();
            Touch { point: Vector3::from(*point), normal, in_tool: normal, tool: 0 }
        };
        list.iter().map(one).collect()
    }

    fn names(list: &[([f64; 3], [f64; 3])]) -> Vec<String> {
        let of = [("f".to_owned(), (0..list.len()).collect())];
        let found = TouchUnknowns::of(&touches(list), &of, false, &|_| String::new());
        found.list.into_iter().map(|unknown| unknown.name).collect()
    }

    /// The rigid motions that a surface of a kind shows, and a radius that its place does not take up.
    #[test]
    fn a_feature_has_the_unknowns_that_its_touches_feel() {
        let z = [0.0, 0.0, 1.0];
        let plane = [([0.0, 0.0, 5.0], z), ([200.0, 0.0, 5.0], z), ([0.0, 150.0, 5.0], z), ([90.0, 80.0, 5.0], z)];
        assert_eq!(names(&plane), ["f.z", "f.A", "f.B"]);
        let round = |height: f64, steps: usize| {
            (0..steps).map(move |i| {
                let (sine, cosine) = libm::sincos(i as f64 * std::f64::consts::TAU / steps as f64);
                ([40.0 + 8.0 * cosine, 9.0 + 8.0 * sine, height], [cosine, sine, 0.0])
            })
        };
        let rod: Vec<_> = round(0.0, 4).chain(round(120.0, 4)).collect();
        // Four touches a round are blind to threefold lobing of one phase, and feel the other.
        assert_eq!(names(&rod), ["f.x", "f.y", "f.A", "f.B", "touch constant"]);
        let ball: Vec<_> = round(0.0, 7).chain([([40.0, 9.0, 8.0], z)]).collect();
        assert_eq!(names(&ball), ["f.x", "f.y", "f.z", "touch constant", "touch lobe cos", "touch lobe sin"]);
    }
}
