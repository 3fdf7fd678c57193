//! The effect of the bounds of a machine where nothing is measured.

use super::tolerances::{ClassSource, ToleranceOptions};
use super::withheld::LimitWork;
use crate::analysis::SummaryBand;
use crate::analysis::budget::{
    ActingErrors, Bound, Budget, Draws, PoseByPose, PosesRequest, Request, adding, budget, budget_poses,
    draw_largest_steps, effects_at, is_measured, pose_by_pose,
};
use crate::analysis::reference::PartReference;
use crate::evaluate::{Field, Frame, Poses, Summary};
use crate::job::characteristics::{CharacteristicResult, DrawnRequest, JobCharacteristics, ValuedField};
use crate::job::features::{FeatureResult, bounded_features};
use crate::job::limit::{JobLimit, LimitVerdict};
use crate::job::path::LargestStep;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Machine, Pose};
use crate::report::{BoundedFigures, DrawSettings, DrawnMachineFigures};
use crate::run::{Call, Refused};
use serde::Serialize;

/// The bounds of a machine, and how machines are drawn between them.
#[derive(Debug, Clone)]
pub(crate) struct DrawnBounds {
    pub bounds: Vec<Bound>,
    pub drawing: DrawSettings,
    /// The reference of the part, which its set-up takes out.
    pub removed: Option<PartReference>,
}

impl DrawnBounds {
    /// Returns those of a machine of which nothing is measured; `None` if something is, or nothing is bounded.
    pub(crate) fn of(
        call: &mut Call<'_>,
        machine: &Machine,
        (tolerances, samples, seed): (&ToleranceOptions, usize, u64),
    ) -> Result<Option<Self>, Refused> {
        if is_measured(machine) {
            return Ok(None);
        }
        let bounded = tolerances.bounds_if_any(call, machine)?;
        Ok(Self::new(bounded, (tolerances, samples, seed)))
    }

    fn new(
        (bounds, class): (Vec<Bound>, Option<ClassSource>),
        (tolerances, samples, seed): (&ToleranceOptions, usize, u64),
    ) -> Option<Self> {
        let drawing = tolerances.drawing(class, samples, seed);
        (!bounds.is_empty()).then_some(Self { bounds, drawing, removed: None })
    }

    /// Returns them without what the set-up of a part takes out of their effects.
    pub(crate) fn without(self, removed: Option<&PartReference>) -> Self {
        Self { removed: removed.cloned(), ..self }
    }

    /// Returns the features of tool poses at which they lead to what was found.
    pub(crate) fn features(
        &self,
        machine: &Machine,
        reached: &ReachedToolPoses,
        found: &PoseByPose,
    ) -> Vec<FeatureResult> {
        let draws = self.draws();
        let effects = |pose: &[f64]| effects_at(machine, &self.bounds, pose, &draws, self.removed.as_ref());
        bounded_features(machine, reached, &self.bounds, found, &effects)
    }

    /// Returns the characteristics of toleranced features to which they lead.
    pub(crate) fn characteristics(
        &self,
        call: &Call<'_>,
        machine: &Machine,
        of: &JobCharacteristics,
    ) -> Result<Vec<CharacteristicResult>, Refused> {
        let (draws, samples, removed) = (self.draws(), self.drawing.samples, self.removed.as_ref());
        of.drawn(call, DrawnRequest { machine, bounds: &self.bounds, removed, draws: &draws, samples, values: None })
    }

    /// Returns the generator of the machines drawn.
    pub(crate) fn draws(&self) -> Draws {
        Draws::new(self.drawing.seed, self.drawing.distribution)
    }

    /// Returns what they lead to at poses.
    pub(crate) fn at(
        &self,
        call: &Call<'_>,
        machine: &Machine,
        poses: &Poses,
        frame: Frame,
    ) -> Result<PoseByPose, Refused> {
        let (draws, samples, reference) = (self.draws(), self.drawing.samples, self.removed.as_ref());
        let request = PosesRequest { machine, bounds: &self.bounds, poses, reference, frame, draws: &draws, samples };
        call.stage("machines drawn", request.steps(), |advance| pose_by_pose(request, advance))
    }

    /// Returns the largest step of the deviation to which they lead, from poses with these indices to the next.
    pub(crate) fn largest_step(
        &self,
        call: &Call<'_>,
        machine: &Machine,
        poses: &Poses,
        steps: &[usize],
    ) -> Result<Option<LargestStep>, Refused> {
        let (draws, samples, reference) = (self.draws(), self.drawing.samples, self.removed.as_ref());
        let frame = Frame::Workpiece;
        let request = PosesRequest { machine, bounds: &self.bounds, poses, reference, frame, draws: &draws, samples };
        let drawn =
            call.stage("machines drawn", request.steps(), |advance| draw_largest_steps(request, steps, advance))?;
        Ok(LargestStep::of_machines(drawn))
    }

    pub(crate) fn figures(&self, found: &PoseByPose) -> BoundedFigures {
        BoundedFigures::new(self.bounds.len(), self.drawing.clone(), found)
    }
}

/// What the bounds of a machine add to its measured errors: a budget of those errors that have no value.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct AddedByBounds {
    /// Number of these errors.
    pub errors: usize,
    /// Number of poses: those of the budget, or of the work.
    pub poses: usize,
    /// Number of machines drawn.
    pub samples: usize,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Of the position deviation, um.
    pub position_um: AddedDeviation,
    /// Of the orientation, urad.
    pub rotation_urad: AddedDeviation,
}

/// A deviation that bounds add.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct AddedDeviation {
    /// Root of the sum of squares of the bounds' effects, at the pose where that is largest.
    pub rss: f64,
    /// The largest deviation over the poses that 95 % of the machines drawn do not exceed.
    pub p95: f64,
}

/// Number of random poses, as a budget has them.
const POSES: usize = 500;

/// The bounds of a machine with measured errors, of those errors that have no value.
pub(crate) struct AddingBounds<'a> {
    pub machine: &'a Machine,
    pub tolerances: &'a ToleranceOptions,
    pub samples: usize,
    pub seed: u64,
    /// The poses of a work; `None` is the volume.
    pub work: Option<&'a [Pose]>,
    pub reference: Option<&'a PartReference>,
}

impl AddingBounds<'_> {
    /// Returns what they add, as a budget would have it; `None` where no error without a value is bounded, and with a
    /// minimum zone.
    pub(crate) fn added(&self, call: &mut Call<'_>) -> Result<Option<AddedByBounds>, Refused> {
        let Some((errors, poses, found)) = self.budget(call, ActingErrors::None)? else { return Ok(None) };
        let [position_um, rotation_urad] = [&found.position, &found.rotation]
            .map(|totals| AddedDeviation { rss: totals.rss, p95: totals.percentile(95).value });
        let Self { samples, seed, .. } = *self;
        Ok(Some(AddedByBounds { errors, poses, samples, seed, position_um, rotation_urad }))
    }

    /// Returns the verdict of a limit on the machine, whose measured errors act as a field has them, less what the
    /// set-up of the part takes out; `values_um` are these alone, with
    /// their intervals.
    pub(crate) fn limit(
        &self,
        call: &mut Call<'_>,
        limit: JobLimit,
        field: &dyn Field,
        values_um: &Summary,
        band: Option<&SummaryBand>,
    ) -> Result<LimitVerdict, Refused> {
        let found = self.budget(call, ActingErrors::OfField(field))?;
        let is_zone = self.reference.is_some_and(|of| !of.is_linear());
        let is_partial = is_zone && !Self { reference: None, ..*self }.bounds(call)?.is_empty();
        let limit = JobLimit { is_partial, ..limit };
        let spread = limit.spread_um(values_um, band);
        let verdict = match found {
            Some((.., found)) => DrawnMachineFigures::of(&found.position.sorted).against(&limit, spread),
            None => limit.on_values(values_um, band),
        };
        let Self { machine, tolerances, samples, seed, work, reference } = *self;
        let bounds = &self.bounds(call)?;
        let poses = work.unwrap_or_default();
        LimitWork { machine, bounds, poses, reference, tolerances, samples, seed }.open(call, verdict)
    }

    /// Returns the characteristics of toleranced features: of machines drawn, in which the measured errors act as the
    /// field has them, or of these alone where nothing is drawn.
    pub(crate) fn characteristics(
        &self,
        call: &mut Call<'_>,
        of: &JobCharacteristics,
        valued: ValuedField<'_>,
    ) -> Result<Vec<CharacteristicResult>, Refused> {
        let Self { machine, tolerances, samples, seed, reference: removed, .. } = *self;
        let bounds = self.bounds(call)?;
        if bounds.is_empty() {
            return Ok(of.values(valued));
        }
        let (draws, values) = (tolerances.draws(seed), Some(valued.field));
        of.drawn(call, DrawnRequest { machine, bounds: &bounds, removed, draws: &draws, samples, values })
    }

    /// Returns the bounds; none if no error is measured, and with a minimum zone.
    fn bounds(&self, call: &mut Call<'_>) -> Result<Vec<Bound>, Refused> {
        let Self { machine, tolerances, reference, .. } = *self;
        if !is_measured(machine) || reference.is_some_and(|of| !of.is_linear()) {
            return Ok(Vec::new());
        }
        let (all, _) = tolerances.bounds_if_any(call, machine)?;
        Ok(adding(machine, &all))
    }

    fn budget(&self, call: &mut Call<'_>, acting: ActingErrors<'_>) -> Result<Option<(usize, usize, Budget)>, Refused> {
        let Self { machine, tolerances, samples, seed, work, reference } = *self;
        let bounds = self.bounds(call)?;
        if bounds.is_empty() {
            return Ok(None);
        }
        let of_budget = || budget_poses(machine, POSES, seed);
        let (poses, searched) = work.map_or_else(|| (of_budget(), true), |work| (work.to_vec(), false));
        let (draws, statistic, count) = (tolerances.draws(seed), tolerances.statistic, poses.len());
        let request = Request {
            machine,
            acting,
            bounds: &bounds,
            poses: &poses,
            reference,
            searched,
            at: None,
            draws: &draws,
            samples,
            statistic,
        };
        let found = call.stage("machines drawn", 2 * samples, |advance| budget(request, advance))?;
        Ok(Some((bounds.len(), count, found)))
    }
}
