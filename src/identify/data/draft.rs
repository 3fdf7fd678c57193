//! Rows of a file before their runs are known as a whole.

use super::columns::{Content, LengthKind, ReadingQuantity};
use super::failure::RowFailure;
use super::measurement::{Measurement, lever};
use super::tracker::{PointFailure, TrackedPoint};
use crate::diagnostic::shown;
use crate::identify::thresholds::MIN_WEIGHT;
use crate::lower::Source;
use crate::machine::{Approach, Direction, Pose};

/// One row before its run is known as a whole.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub row: Measurement,
    pub to: Option<Pose>,
    /// Kind and value of a length.
    pub length: Option<(LengthKind, f64)>,
    pub along: f64,
    pub errors: Vec<(Source, Approach, f64)>,
    /// Weight of angles, where their uncertainty is given.
    pub angles: Option<f64>,
    pub station: Option<String>,
    pub at: [Option<f64>; 3],
    /// Standard uncertainty of the place (mm).
    pub known: Option<f64>,
    pub ball: String,
    pub feature: String,
    pub normal: [f64; 3],
    /// Place in the instrument's frame.
    pub tracker: [Option<f64>; 3],
    /// Components of an orientation (rad).
    pub turn: [Option<f64>; 3],
    pub point: String,
}

impl Draft {
    /// Takes a reading for planned: its value does not matter.
    pub fn plan(&mut self, content: &Content, deviation: &mut [Option<f64>; 3]) {
        match *content {
            Content::Deviation(k) | Content::Relative(k) => deviation[k] = Some(0.0),
            Content::Tracker(k) => self.tracker[k] = Some(0.0),
            Content::Turn(_, k) => self.turn[k] = Some(0.0),
            Content::Error(source, approach) => self.errors.push((source, approach.unwrap_or_default(), 0.0)),
            Content::Length(kind) => self.length = Some((kind, 0.0)),
            _ => {}
        }
    }

    /// Takes a standard uncertainty (mm or rad) for the weight.
    pub fn uncertain(&mut self, quantity: ReadingQuantity, value: f64, cell: &str) -> Result<(), RowFailure> {
        let angle = quantity == ReadingQuantity::Angle;
        let um = value * 1e3 * if angle { lever(Direction::A) } else { 1.0 };
        let weight = weight(1.0 / (um * um), cell)?;
        self.row.has_uncertainty = true;
        *(if angle { self.angles.get_or_insert(weight) } else { &mut self.row.weight }) = weight;
        Ok(())
    }
}

/// Poses at which points were measured, in the order of their table.
pub(super) struct PointPoses {
    pub drafts: Vec<Draft>,
    /// True if the table names the points.
    pub has_names: bool,
}

impl PointPoses {
    /// Returns the rows of points, and the names of those that have no pose.
    pub fn of(&self, points: Vec<TrackedPoint>) -> Result<(Vec<Draft>, Vec<String>), PointFailure> {
        if !self.has_names {
            if self.drafts.len() != points.len() {
                return Err(PointFailure::Count(points.len(), self.drafts.len()));
            }
            let rows = self.drafts.iter().zip(points).map(|(draft, point)| draft.with_point(point));
            return Ok((rows.collect(), Vec::new()));
        }
        let by_name: std::collections::BTreeMap<&str, &Draft> =
            self.drafts.iter().map(|draft| (draft.point.as_str(), draft)).collect();
        let (mut rows, mut unknown): (Vec<Draft>, Vec<String>) = (Vec::new(), Vec::new());
        for point in points {
            match by_name.get(point.name.as_str()) {
                Some(draft) => rows.push(draft.with_point(point)),
                None => unknown.push(point.name),
            }
        }
        if rows.is_empty() { Err(PointFailure::NoPose) } else { Ok((rows, unknown)) }
    }
}

impl Draft {
    /// Returns the row of a point that was measured at this pose.
    fn with_point(&self, point: TrackedPoint) -> Self {
        let mut draft = self.clone();
        draft.tracker = <[f64; 3]>::from(point.at).map(Some);
        draft.row.place = point.place;
        draft
    }
}

/// Groups rows by run (and by `also`), in the order of their first rows; the name is empty or begins with a blank.
pub(super) fn runs(drafts: Vec<Draft>, also: impl Fn(&Draft) -> String) -> Vec<(String, Vec<Draft>)> {
    let mut groups: indexmap::IndexMap<String, Vec<Draft>> = indexmap::IndexMap::new();
    for draft in drafts {
        let words = [draft.row.run.clone().unwrap_or_default(), also(&draft)];
        let name = words.iter().filter(|w| !w.is_empty()).map(|w| format!(" {}", shown(w))).collect();
        groups.entry(name).or_default().push(draft);
    }
    groups.into_iter().collect()
}

/// Refuses a weight that sums of squares cannot bear.
pub(super) fn weight(value: f64, cell: &str) -> Result<f64, RowFailure> {
    let good = (MIN_WEIGHT..=1.0 / MIN_WEIGHT).contains(&value);
    if good { Ok(value) } else { Err(RowFailure::Weight(cell.to_owned(), value)) }
}
