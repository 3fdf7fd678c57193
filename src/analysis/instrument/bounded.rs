//! Readings to which the bounds of errors lead, to first order in the errors: of machines drawn between them, and of
//! each bound alone. Drawn errors have no reversal.

use crate::analysis::budget::{Bound, Draws, FiguresRequest, Percentile, draw_figures, percentile_95};
use crate::machine::{Machine, Pose};
use crate::run::{Advance, Cancelled};
use nalgebra::Vector3;

/// Returns readings (mm) by the deviations (mm) at poses.
type ReadingsAt<'a> = dyn Fn(&[Vector3<f64>]) -> Vec<f64> + Sync + 'a;

/// A path of an instrument with what it reads there.
pub struct DrivenPath<'a> {
    /// Names of its readings.
    pub names: Vec<String>,
    /// The poses (mm, deg).
    pub poses: Vec<Pose>,
    /// The readings.
    pub readings: Box<ReadingsAt<'a>>,
}

/// A reading to which bounds lead.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct BoundedReading {
    /// The plane, the axis with a direction, or the senses along a diagonal.
    pub name: String,
    /// Root of the sum of squares of what 95 % of machines read in which one bound acts alone, um.
    pub rss_um: f64,
    /// The reading that 95 % of the machines drawn do not exceed, um.
    pub p95_um: Percentile,
}

/// The bounds of a machine with the machines drawn between them.
#[derive(Clone, Copy)]
pub struct BoundedRequest<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The bounded errors, at least one.
    pub bounds: &'a [Bound],
    /// The generator of drawn machines.
    pub draws: &'a Draws,
    /// Number of drawn machines, at least 1.
    pub samples: usize,
}

impl BoundedRequest<'_> {
    /// Returns the number of steps of a path that the progress counts.
    pub fn steps(&self) -> usize {
        2 * self.samples * (1 + self.bounds.len())
    }

    /// Returns the readings of a path.
    pub fn readings(&self, path: &DrivenPath<'_>, advance: Advance<'_>) -> Result<Vec<BoundedReading>, Cancelled> {
        let together = self.drawn(path, self.bounds, advance)?;
        let alone = |bound: &Bound| self.drawn(path, std::slice::from_ref(bound), advance);
        let alone: Vec<Vec<Vec<f64>>> = self.bounds.iter().map(alone).collect::<Result<_, Cancelled>>()?;
        let one = |(k, (name, mut values)): (usize, (&String, Vec<f64>))| {
            values.sort_by(f64::total_cmp);
            let squares = alone.iter().map(|of| percentile_95(&of[k])).map(|um| um * um);
            BoundedReading {
                name: name.clone(),
                rss_um: squares.sum::<f64>().sqrt(),
                p95_um: Percentile::of(&values, 95),
            }
        };
        Ok(path.names.iter().zip(together).enumerate().map(one).collect())
    }

    /// Returns reading by reading those of the machines drawn, um.
    fn drawn(&self, path: &DrivenPath<'_>, bounds: &[Bound], advance: Advance<'_>) -> Result<Vec<Vec<f64>>, Cancelled> {
        let Self { machine, draws, samples, .. } = *self;
        let request = FiguresRequest {
            machine,
            bounds,
            poses: &path.poses,
            constant: &[],
            reference: None,
            draws,
            samples,
            figures: &*path.readings,
            weights: &|_, _| Vec::new(),
        };
        let all = draw_figures(request, advance)?;
        Ok(all.into_iter().map(|of| of.values.iter().map(|mm| mm * 1e3).collect()).collect())
    }
}
