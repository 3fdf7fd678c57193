//! Intervals of the figures of a certificate by the uncertainty that a machine file states of its errors.

use crate::analysis::Bands;
use crate::analysis::figure_bands::field_bands;
use crate::controller::{Certificate, Depth};
use crate::evaluate::{Bare, Field, Order, Poses, Statistics};
use crate::job::reference::SetUp;
use crate::machine::Machine;
use serde::Serialize;

/// Intervals of the figures of a certificate.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CertificateBands {
    /// Without the files.
    pub uncompensated: Bands,
    /// With them: what the uncertainty of the errors leaves, whatever the files correct.
    pub compensated: Bands,
    /// Errors with a value of which the machine file states no uncertainty: they count as exact.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_stated: Vec<String>,
}

impl CertificateBands {
    /// Returns the intervals of a certificate; `field` is the machine with the files, and the figures are without what
    /// `set_up` takes out. `None` where the machine states
    /// no uncertainty.
    pub(crate) fn of(
        machine: &Machine,
        certificate: &Certificate,
        field: &dyn Field,
        depth: Depth,
        set_up: &SetUp,
    ) -> Option<Self> {
        if machine.uncertain_parts().is_empty() {
            return None;
        }
        let poses = Poses::Listed(depth.poses(machine));
        let bare = Bare { machine, order: Order::Exact };
        let of = |field: &dyn Field, whole: Statistics| {
            let conditions = certificate.approach.into();
            let without = set_up.field(field, Order::Exact, conditions);
            let field = without.as_ref().map_or(field, |field| field as &dyn Field);
            field_bands(field, &poses, whole, &[], conditions, depth.seed, set_up.removed())
        };
        Some(Self {
            uncompensated: of(&bare, certificate.uncompensated.statistics(certificate.poses))?,
            compensated: of(field, certificate.compensated.statistics(certificate.poses))?,
            not_stated: machine.errors_taken_as_exact().iter().map(ToString::to_string).collect(),
        })
    }
}
