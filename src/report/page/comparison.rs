//! Two or more machines on the same tool poses.

use super::data::Given;
use crate::analysis::{Compared, ErrorAlone, compare, contributions};
use crate::evaluate::{Bare, Field};
use crate::machine::{Machine, Pose};
use serde::Serialize;
use serde_json::{Value, json};

/// Machines side by side; differences are to the first.
#[derive(Debug, Clone, Serialize)]
pub struct ComparisonData {
    asked: usize,
    poses: usize,
    seed: u64,
    /// The largest of the largest position deviations: the full width of the bars.
    largest_um: f64,
    machines: Vec<Value>,
    /// The errors that do most in any of the machines, one by one.
    errors: Vec<Value>,
}

/// How many of them.
const ERRORS: usize = 20;

impl ComparisonData {
    /// Compares two or more machines at tool poses drawn from the volume of the first.
    pub fn new(given: &[Given<'_>], progress: &(dyn Fn(usize) + Sync)) -> Option<Self> {
        let first = given.first().filter(|_| given.len() > 1)?;
        let bare: Vec<Bare<'_>> = given.iter().map(|g| Bare { machine: g.machine, order: g.order }).collect();
        let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
        let comparison = compare(&fields, &first.sample(), first.approach, progress);
        let side = |(g, c): (&Given<'_>, &Compared)| {
            json!({"name": g.machine.name(), "file": g.file, "chain": g.machine.chain().to_string(),
                "unreachable": c.unreachable, "position_um": c.statistics.position_um,
                "rotation_urad": c.statistics.rotation_urad, "minus_first": c.difference})
        };
        let poses = |c: &Compared| c.reached.iter().map(|(pose, _)| pose.clone()).collect();
        let sides: Vec<(&Machine, Vec<Pose>)> =
            given.iter().zip(&comparison.machines).map(|(g, c)| (g.machine, poses(c))).collect();
        let error = |e: ErrorAlone| {
            let minus: Vec<f64> = (0..e.um.len()).map(|i| e.minus_first(i)).collect();
            json!({"error": e.error, "um": e.um, "minus_first": minus})
        };
        Some(Self {
            errors: contributions(&sides, first.approach).into_iter().take(ERRORS).map(error).collect(),
            asked: comparison.asked,
            poses: comparison.common.len(),
            seed: first.poses.1,
            largest_um: comparison.machines.iter().map(|c| c.statistics.position_um.max).fold(0.0, f64::max),
            machines: given.iter().zip(&comparison.machines).map(side).collect(),
        })
    }
}
