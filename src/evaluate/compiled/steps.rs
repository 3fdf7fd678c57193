//! The steps of the walk of order 1, with the rows of neighbouring axes summed before they are transposed.
//!
//! Twists that act at one point add up: the table rows of such axes are summed, transposed once, and share one lever.
//! One slide along a machine axis may lie between some of them and that point. A twist moved past the slide is the same
//! with its displacement reduced by `eps x u` times the position: two numbers, in the spare columns of the rows.
//!
//! The sum so far is a rotation and the displacement of a point of reference, so that another twist is added component
//! by component. The point of reference lies on the axis of the next rotary joint, which leaves it where it is; twists
//! are taken about it.

use super::chain::NominalMotion;
use super::curves::{CompiledCurves, Six};
use super::twist::{TwistJoint, twist};
use super::vector::{cross, minus};

/// A step of the walk; its parts act in the order of the fields.
#[derive(Debug, Clone, Default)]
pub struct WalkStep {
    /// Nominal motion of the joint with this index.
    pub motion: Option<usize>,
    /// True if a step before has added errors.
    pub rotated: bool,
    /// Move of the point of reference, mm.
    pub shift: Option<[f64; 3]>,
    /// Errors of axes whose curves are linear tables.
    pub sum: Option<Sum>,
    /// Errors of an axis with other curves.
    pub errors: Option<(usize, CompiledCurves)>,
    /// A constant twist.
    pub constant: Option<Six>,
}

/// Axes whose twists are added up: index and curves.
#[derive(Debug, Clone)]
pub struct Sum {
    /// First axis of the sum.
    pub first: (usize, CompiledCurves),
    /// The other axes.
    pub others: Vec<(usize, CompiledCurves)>,
    /// Slide between some of them and the point of reference.
    pub slide: Option<ReferenceSlide>,
}

/// A linear axis between the axes of a sum and the point of reference.
#[derive(Debug, Clone, Copy)]
pub struct ReferenceSlide {
    /// Index of the axis.
    pub axis: usize,
    /// Its direction: machine axis 0 to 2. The spare columns of a row belong to the other two, in rising order.
    pub along: usize,
}

/// Returns the point of reference after the joints from `end` on: the origin of the next rotary joint, else of the last
/// one passed.
pub fn reference(joints: &[TwistJoint], end: usize) -> [f64; 3] {
    let turn = |joint: &&TwistJoint| matches!(joint.motion, NominalMotion::Turn(_));
    let next = joints[..end].iter().rev().find(turn);
    next.or_else(|| joints.iter().find(turn)).map_or([0.0; 3], |joint| joint.origin)
}

/// Returns the steps past these joints, from the tool to the workpiece, beginning with a constant twist.
pub fn steps(joints: &[TwistJoint], end: Option<Six>) -> Vec<WalkStep> {
    let mut builder = StepBuilder { joints, steps: vec![WalkStep::default()], open: None };
    builder.constant(end, joints.len());
    for (axis, joint) in joints.iter().enumerate().rev() {
        if !joint.outside {
            builder.errors(axis, axis + 1);
        }
        builder.motion(axis);
        if joint.outside {
            builder.errors(axis, axis);
        }
        builder.constant(joint.constant, axis);
    }
    let mut rotated = false;
    for step in &mut builder.steps {
        step.rotated = rotated;
        rotated |= step.sum.is_some() || step.errors.is_some() || step.constant.is_some();
    }
    builder.steps
}

/// Returns a twist about the machine's zero point as one about another point.
fn about_point(six: &Six, point: [f64; 3]) -> Six {
    twist(six, &point.map(|x| -x), 1.0)
}

struct StepBuilder<'a> {
    joints: &'a [TwistJoint],
    steps: Vec<WalkStep>,
    /// Index of the step with the latest sum, and the slides passed since; `None` if no axis can join it any more.
    open: Option<(usize, Vec<usize>)>,
}

impl StepBuilder<'_> {
    /// Returns the step under construction.
    fn last(&mut self) -> &mut WalkStep {
        if self.steps.is_empty() {
            self.steps.push(WalkStep::default());
        }
        let last = self.steps.len() - 1;
        &mut self.steps[last]
    }

    fn motion(&mut self, axis: usize) {
        let shift = match self.joints[axis].motion {
            NominalMotion::Turn(_) => minus(reference(self.joints, axis), self.joints[axis].origin),
            NominalMotion::Slide(_) => [0.0; 3],
        };
        let shift = (shift != [0.0; 3]).then_some(shift);
        self.steps.push(WalkStep { motion: Some(axis), shift, ..WalkStep::default() });
        match (self.joints[axis].motion, &mut self.open) {
            (NominalMotion::Slide(_), Some((_, passed))) => passed.push(axis),
            (NominalMotion::Slide(_), None) => {}
            (NominalMotion::Turn(_), open) => *open = None,
        }
    }

    /// Adds a constant twist on the workpiece's side of the joint `end`.
    fn constant(&mut self, constant: Option<Six>, end: usize) {
        let about = reference(self.joints, end);
        self.last().constant = constant.map(|six| about_point(&six, about));
    }

    /// Adds the errors of an axis; the joints before `end` lie on the workpiece's side of them.
    fn errors(&mut self, axis: usize, end: usize) {
        let Some(curves) = self.joints[axis].curves.clone() else { return };
        let about = reference(self.joints, end);
        let curves = curves.map_errors(|six| about_point(six, about));
        if !curves.is_linear_table() {
            if self.last().errors.is_some() {
                self.steps.push(WalkStep::default());
            }
            self.last().errors = Some((axis, curves));
            return;
        }
        let sum = match self.latest() {
            Some(mut sum) => {
                sum.others.push((axis, curves));
                sum
            }
            None => Sum { first: (axis, curves), others: Vec::new(), slide: None },
        };
        if self.last().sum.is_some() {
            self.steps.push(WalkStep::default());
        }
        self.last().sum = Some(sum);
        self.open = Some((self.steps.len() - 1, Vec::new()));
    }

    /// Takes the latest sum from its step to act here; `None` if more than one slide lies between.
    fn latest(&mut self) -> Option<Sum> {
        let (at, passed) = self.open.take()?;
        let mut sum = self.steps[at].sum.clone()?;
        match (&passed[..], sum.slide) {
            ([], _) => {}
            ([slide], None) => sum.pass_slide(*slide, self.joints[*slide].motion)?,
            _ => return None,
        }
        self.steps[at].sum = None;
        Some(sum)
    }
}

impl Sum {
    /// Moves the sum past a slide; returns `None` if that is not along a machine axis.
    fn pass_slide(&mut self, axis: usize, motion: NominalMotion) -> Option<()> {
        let NominalMotion::Slide(u) = motion else { return None };
        let along = (0..3).find(|k| (0..3).all(|j| j == *k || u[j] == 0.0))?;
        for (_, curves) in std::iter::once(&mut self.first).chain(&mut self.others) {
            curves.set_auxiliary(|[.., a, b, c]| {
                let [x, y, z] = cross([*a, *b, *c], u).map(|lever| -lever);
                [[y, z], [x, z], [x, y]][along]
            });
        }
        self.slide = Some(ReferenceSlide { axis, along });
        Some(())
    }
}
