//! Two or more machines on the same tool poses.

use super::data::Given;
use crate::analysis::{Compared, compare};
use crate::evaluate::{Bare, Field};
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
}

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
        Some(Self {
            asked: comparison.asked,
            poses: comparison.common.len(),
            seed: first.poses.1,
            largest_um: comparison.machines.iter().map(|c| c.statistics.position_um.max).fold(0.0, f64::max),
            machines: given.iter().zip(&comparison.machines).map(side).collect(),
        })
    }
}
