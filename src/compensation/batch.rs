//! Corrections of many poses at once: the iteration of [`correct()`](super::correct()) on the compiled evaluator.

use super::correct::{MAX_STEPS, SMALL_STEP, is_settled};
use super::{Corrected, Correction, Jacobian, Scope};
use crate::evaluate::{Columns, CompiledModel, PoseColumns};
use crate::machine::Pose;

/// A pose that is being corrected.
struct Open {
    jacobian: Jacobian,
    correction: Correction,
    /// True once the pose is solved.
    closed: bool,
}

/// Solves actual(q + c) = nominal(q) at many poses (mm, deg), every pose in at most the number of steps that
/// [`correct()`](super::correct()) takes. The residual is computed without a difference of positions: it lacks their
/// rounding, which the residual of `correct()` has. `None` unless the plan is exact.
pub fn correct_all(plan: &CompiledModel, poses: &[Pose], scope: Scope) -> Option<Vec<Corrected>> {
    let none = Correction::none(plan.machine());
    correct_all_from(plan, poses, vec![none; poses.len()], scope)
}

/// The same when something is added to the commands already: one correction for each pose.
pub(super) fn correct_all_from(
    plan: &CompiledModel,
    poses: &[Pose],
    starts: Vec<Correction>,
    scope: Scope,
) -> Option<Vec<Corrected>> {
    let machine = plan.machine();
    let axes = machine.axes().len();
    let at = PoseColumns::of(axes, poses.iter().map(Vec::as_slice));
    let mut residual = Columns::new(poses.len());
    let start = |(pose, correction): (&Pose, Correction)| Open {
        jacobian: Jacobian::at(machine, pose),
        correction,
        closed: false,
    };
    let mut open: Vec<Open> = poses.iter().zip(starts).map(start).collect();
    let evaluate = |open: &[Open], residual: &mut Columns| {
        let added = PoseColumns::of(axes, open.iter().map(|pose| pose.correction.0.as_slice()));
        plan.commanded(&at.batch(), &added.batch(), residual.output(poses.len()))
    };
    evaluate(&open, &mut residual)?;
    for _ in 0..MAX_STEPS {
        let mut small = vec![true; poses.len()];
        for (i, pose) in open.iter_mut().enumerate().filter(|(_, pose)| !pose.closed) {
            let step = pose.jacobian.correction(&residual.get(i), &pose.correction, scope);
            pose.correction.0.iter_mut().zip(&step.0).for_each(|(c, s)| *c += s);
            small[i] = step.0.iter().all(|s| s.abs() < SMALL_STEP);
        }
        evaluate(&open, &mut residual)?;
        for (i, pose) in open.iter_mut().enumerate() {
            pose.closed |= small[i] || is_settled(&residual.get(i), scope);
        }
        if open.iter().all(|pose| pose.closed) {
            break;
        }
    }
    let corrected = |(i, pose): (usize, Open)| Corrected { correction: pose.correction, residual: residual.get(i) };
    Some(open.into_iter().enumerate().map(corrected).collect())
}
