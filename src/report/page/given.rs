//! A machine as it was handed to the page.

use super::instruments::Instruments;
use crate::analysis::budget::{Coverage, Draws, PoseByPose, PosesRequest, is_measured, pose_by_pose};
use crate::analysis::reference::PartReference;
use crate::controller::{Certificate, ControllerEffect, ControllerTarget};
use crate::evaluate::{Frame, Order, Poses, Random};
use crate::job::over::Over;
use crate::job::round_features::RoundFeature;
use crate::machine::{Machine, OperatingConditions, Pose};
use crate::report::text::{BoundedFigures, BudgetFigures};
use crate::run::unheard;
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
    /// Operating conditions.
    pub conditions: OperatingConditions,
    /// Number of poses of the statistics, and the seed of random ones.
    pub poses: (usize, u64),
    /// The poses for the tool poses of a file instead of random ones, and what the page says of the file.
    pub work: Option<(&'a [Pose], &'a Value)>,
    /// The round features of the work.
    pub round: &'a [RoundFeature],
    /// Motion that the part's set-up takes out of the figures.
    pub removed: Option<&'a PartReference>,
    /// Poses and reference of the figures.
    pub over: &'a Over,
    /// Results of the targets that were written for it.
    pub written: &'a [TargetResult],
    /// Readings of instruments on it.
    pub instruments: &'a Instruments,
    /// Its budget, if errors are bounded.
    pub budget: Option<&'a BudgetFigures>,
    /// Which of the errors that act are known, if errors are bounded.
    pub coverage: Option<&'a Coverage>,
    /// Effect of the bounds of errors without a value beside the measured ones; null without any.
    pub bounds_add: &'a Value,
    /// Uncertainties that all readings of its fit shared (type B), in words.
    pub type_b: &'a [String],
    /// Each error in words, by its name.
    pub words: &'a Value,
    /// Warnings, each as a line.
    pub warnings: &'a [String],
}

/// Compensation for one target: its effect as the controller reads it, and the residual.
#[derive(Debug, Clone)]
pub struct TargetResult {
    /// The controller.
    pub target: ControllerTarget,
    /// Its tables, or its kinematics.
    pub effect: ControllerEffect,
    /// Certificate of the residual.
    pub certificate: Certificate,
}

impl<'a> MachineInput<'a> {
    /// The bounds of a machine of which nothing is measured, with the machines drawn.
    pub fn budget(&self) -> Option<&'a BudgetFigures> {
        self.budget.filter(|_| !is_measured(self.machine))
    }

    /// Returns the effect of bounds at poses, in the frame, without what a reference takes out.
    pub fn at(
        &self,
        bounded: &BudgetFigures,
        poses: &Poses,
        frame: Frame,
        reference: Option<&PartReference>,
    ) -> PoseByPose {
        let draws = Draws::new(bounded.drawing.seed, bounded.drawing.distribution);
        let (machine, bounds, samples) = (self.machine, bounded.bounds.as_slice(), bounded.drawing.samples);
        let request = PosesRequest { machine, bounds, poses, reference, frame, draws: &draws, samples };
        let Ok(found) = pose_by_pose(request, &unheard);
        found
    }

    /// The figures of what bounds lead to.
    pub fn figures(bounded: &BudgetFigures, found: &PoseByPose) -> BoundedFigures {
        BoundedFigures::new(bounded.bounds.len(), bounded.drawing.clone(), found)
    }

    /// The poses that statistics are taken over: those of the work, or of a certificate.
    pub fn sample(&self) -> Poses {
        match self.work {
            Some((poses, _)) => Poses::Listed(poses.iter().take(self.poses.0).cloned().collect()),
            None => Poses::Random(Random::of(self.machine, self.poses.0, self.poses.1)),
        }
    }
}
