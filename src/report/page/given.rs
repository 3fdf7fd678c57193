//! A machine as it was handed to the page.

use super::instruments::Instruments;
use crate::controller::{Certificate, ControllerTarget, Effect};
use crate::evaluate::{Order, Poses, Random};
use crate::machine::{Approach, Machine, Pose};
use crate::report::text::BudgetReport;
use serde_json::Value;

/// One machine that was given, and how it is looked at.
#[derive(Debug, Clone, Copy)]
pub struct MachineInput<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Its file as it was named.
    pub file: &'a str,
    /// Order of the errors.
    pub order: Order,
    /// Side of approach.
    pub approach: Approach,
    /// Number of poses of the statistics, and the seed of random ones.
    pub poses: (usize, u64),
    /// The poses for the tool poses of a file instead of random ones, and what the page says of the file.
    pub work: Option<(&'a [Pose], &'a Value)>,
    /// Results of the targets that were written for it.
    pub written: &'a [TargetResult],
    /// Readings of instruments on it.
    pub instruments: &'a Instruments,
    /// Its budget, if errors are bounded.
    pub budget: Option<BudgetReport<'a>>,
    /// Warnings, each as a line.
    pub warnings: &'a [String],
}

/// Compensation for one target: its effect as the controller reads it, and the residual.
#[derive(Debug, Clone)]
pub struct TargetResult {
    /// The controller.
    pub target: ControllerTarget,
    /// Its tables, or its kinematics.
    pub effect: Effect,
    /// Certificate of the residual.
    pub certificate: Certificate,
}

impl MachineInput<'_> {
    /// The poses that statistics are taken over: those of the work, or of a certificate.
    pub fn sample(&self) -> Poses {
        match self.work {
            Some((poses, _)) => Poses::Listed(poses.iter().take(self.poses.0).cloned().collect()),
            None => Poses::Random(Random::of(self.machine, self.poses.0, self.poses.1)),
        }
    }
}
