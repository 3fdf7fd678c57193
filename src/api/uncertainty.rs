//! Intervals of the headline figures by the uncertainty that a machine file states of its errors.

use crate::analysis::{Bands, UncertainDeviations, band_places, bands, uncertain_parts};
use crate::controller::{Certificate, Depth};
use crate::evaluate::{Bare, Field, Order, Poses, Statistics};
use crate::machine::{Approach, Machine, Pose};
use rayon::prelude::*;
use serde::Serialize;

/// Intervals of the figures of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CertificateBands {
    /// Without the files.
    pub uncompensated: Bands,
    /// With them: what the uncertainty of the errors leaves, whatever the files correct.
    pub compensated: Bands,
}

impl CertificateBands {
    /// Returns the intervals of a certificate; `field` is the machine with the files. `None` where the machine states
    /// no uncertainty.
    pub(super) fn of(machine: &Machine, certificate: &Certificate, field: &dyn Field, depth: Depth) -> Option<Self> {
        if machine.uncertain_parts().is_empty() {
            return None;
        }
        let poses = Poses::Listed(depth.poses(machine));
        let bare = Bare { machine, order: Order::Exact };
        let of = |field: &dyn Field, whole: Statistics| {
            field_bands(field, &poses, (whole, &[]), certificate.approach, depth.seed)
        };
        Some(Self {
            uncompensated: of(&bare, certificate.uncompensated.all)?,
            compensated: of(field, certificate.compensated.all)?,
        })
    }
}

/// Returns the intervals of the figures of a field over poses, of which `whole` are the statistics and `besides` the
/// indices of poses not to be left out. `None` where the machine states no uncertainty.
pub(super) fn field_bands(
    field: &dyn Field,
    poses: &Poses,
    (whole, besides): (Statistics, &[usize]),
    approach: Approach,
    seed: u64,
) -> Option<Bands> {
    let machine = field.machine();
    let parts = uncertain_parts([machine]);
    if parts.is_empty() {
        return None;
    }
    let places: Vec<Pose> = band_places(poses.len(), besides).into_iter().map(|i| poses.get(i)).collect();
    let values = places.par_iter().map(|pose| field.deviation(pose, approach)).collect();
    let deviations = UncertainDeviations::of(machine, &parts, (&places, values, whole), approach);
    bands(&[deviations], seed).0.pop()
}
