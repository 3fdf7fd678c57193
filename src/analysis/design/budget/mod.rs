//! Error budget: from tolerances to the volumetric error.
//!
//! 1. [`bounds()`]: which errors are bounded, by the machine file or by a [`Class`] of machines. Each bound is an
//!    independent source with a direction of its own: along an axis, across it, or a letter.
//! 2. At every pose, the effect of each error at its bound. Their sum with the worst signs is the worst case, the root
//!    of the sum of their squares the RSS; each by itself is a bar of the Pareto chart. The worst pose of a volume is
//!    searched, not taken from its corners alone.
//! 3. [`Draws`]: random machines whose errors respect the tolerances. Every deviation goes through the
//!    model, so errors that act together, and poses, are correlated as in the machine. The error of a
//!    machine is a [`Statistic`] over the poses; percentiles are over machines.
//! 4. The tolerance to tighten first: the derivative of the 95 % value. All derivatives come from the
//!    same random numbers. Since the error of a machine grows in proportion to all tolerances together,
//!    tolerance times derivative, summed up, is the 95 % value itself (Euler).
//! 5. [`side_by_side()`]: these effects in several machines; [`PairedTest`]: whether their 95 % values differ.
//! 6. [`pose_by_pose()`]: RSS and 95 % value at every pose by itself, for machines of which nothing is measured.
//! 7. [`Coverage`]: which acting errors have a value, a bound, or neither.
//! 8. [`draw_figures()`]: figures of drawn machines by their deviations at poses, such as those of features.
//! 9. [`draw_with_zone()`]: drawn machines on which the part is set up by a minimum zone.
//! 10. [`draw_largest_steps()`]: the largest step of the deviation between poses of a path, in drawn machines.
//! 11. [`cheapest()`]: the cheapest tolerances with which the 95 % value is a goal, by a [`CostModel`].
//! 12. [`StayingErrors`]: errors with values that no bound stands for; they act in every machine drawn.
//! 13. [`bounds_by_values()`]: largest values at poses, in place of bounds where there are none.
//! 14. [`drawn_machine()`]: a drawn machine as one with values.
//!
//! To first order in the errors: second orders are of the size of error times error, nanometres here.

mod bounds;
mod cost;
mod coverage;
mod draw;
mod drawn_figures;
mod drawn_machine;
mod goal;
mod kernel;
mod monte_carlo;
mod paired;
mod pose_by_pose;
mod quantile;
mod sample_kernels;
mod search;
mod side_by_side;
mod staying;
mod step_draws;
mod totals;
mod worst;
mod zone_draws;

pub use crate::machine::{Class, classes};
pub(crate) use bounds::on_other_sides;
pub use bounds::{Bound, Role, adding, bounds, bounds_by_values, is_measured, known, lacks_rotary};
pub use cost::{CostModel, Price};
pub use coverage::{Coverage, STAND_IN_CLASS};
pub(crate) use draw::Normals;
pub use draw::{Distribution, Draws, NODES};
pub use drawn_figures::{DrawnFigure, FiguresAt, FiguresRequest, WeightsAt, draw_figures, drawn_positions};
pub use drawn_machine::drawn_machine;
pub use goal::{Binding, CheapestTolerances, GoalAnswer, GoalRequest, cheapest};
pub(crate) use kernel::{
    CurvePoint, DrawnSource, JointBounds, SAMPLE_LANES, SampleChunk, SampleLanes, SourceEffects, by_joint, columns,
    remove_motion, squares,
};
pub use monte_carlo::Statistic;
pub use paired::{
    PairedDifference, PairedTest, Verdict, VersusFirst, are_equal, most_samples, percentile_95, round_sizes,
};
pub use pose_by_pose::{BoundedDeviation, BoundedLength, PoseByPose, PosesRequest, effects_at, pose_by_pose};
pub use quantile::{Percentile, Proportion, mean, rank};
pub use side_by_side::{BoundedError, BudgetPart, side_by_side};
pub use staying::{ActingErrors, StayingErrors, count_staying};
pub use step_draws::{DrawnStep, draw_largest_steps};
pub use totals::{
    Budget, Contribution, DrawnSamples, PERCENTS, Request, Totals, budget, budget_from_samples, budget_poses,
    draw_samples,
};
pub use worst::longest;
pub use zone_draws::draw_with_zone;
