//! The walk of order 1, step by step, with the errors of neighbouring axes summed before they are transposed.
//!
//! Twists that act at one point simply add up: of such axes the rows of the tables are summed, transposed once, and have one lever.
//! One slide along a machine axis may lie between some of them and that point. Behind it a twist is the same if its
//! displacement is less `eps x u` times the position, which are two numbers; they stand in the rows, where else there is padding.
//!
//! What has been summed is a rotation and the displacement of a point of reference, so that a twist more is a sum and nothing else.
//! That point lies on the axis of the turn that comes next, which leaves it where it is; the twists are those about it.

use super::chain::Motion;
use super::curves::{Curves, Six};
use super::twist::{TwistJoint, twist};
use super::vector::{cross, minus};

/// A step of the walk: each part after the one before, if it is there.
#[derive(Debug, Clone, Default)]
pub struct Step {
    /// Past the joint of an axis.
    pub motion: Option<usize>,
    /// Have there been errors before?
    pub rotated: bool,
    /// From this point of reference to the next.
    pub shift: Option<[f64; 3]>,
    /// The errors of axes whose curves are rows.
    pub sum: Option<Sum>,
    /// The errors of an axis whose curves are more.
    pub errors: Option<(usize, Curves)>,
    /// A constant twist.
    pub constant: Option<Six>,
}

/// Axes whose twists are added up, with their curves.
#[derive(Debug, Clone)]
pub struct Sum {
    pub first: (usize, Curves),
    pub others: Vec<(usize, Curves)>,
    pub slide: Option<Slide>,
}

/// A slide between some of them and the point.
#[derive(Debug, Clone, Copy)]
pub struct Slide {
    pub axis: usize,
    /// The machine axis along which it goes, 0 to 2. The two numbers of a row belong to the other two, in rising order.
    pub along: usize,
}

/// The point of reference on the workpiece's side of these joints' end: of the next turn there, else of the last one passed.
pub fn reference(joints: &[TwistJoint], end: usize) -> [f64; 3] {
    let turn = |joint: &&TwistJoint| matches!(joint.motion, Motion::Turn(_));
    let next = joints[..end].iter().rev().find(turn);
    next.or_else(|| joints.iter().find(turn)).map_or([0.0; 3], |joint| joint.origin)
}

/// Of these joints, from the tool to the workpiece, beginning with a constant twist.
pub fn steps(joints: &[TwistJoint], end: Option<Six>) -> Vec<Step> {
    let mut builder = StepBuilder { joints, steps: vec![Step::default()], open: None };
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

/// A twist about the machine's zero point as one about another.
fn about_point(six: &Six, point: [f64; 3]) -> Six {
    twist(six, &point.map(|x| -x), 1.0)
}

struct StepBuilder<'a> {
    joints: &'a [TwistJoint],
    steps: Vec<Step>,
    /// Which step has the latest sum, and the slides passed since, if others may still join it.
    open: Option<(usize, Vec<usize>)>,
}

impl StepBuilder<'_> {
    /// The step that is being made.
    fn last(&mut self) -> &mut Step {
        if self.steps.is_empty() {
            self.steps.push(Step::default());
        }
        let last = self.steps.len() - 1;
        &mut self.steps[last]
    }

    fn motion(&mut self, axis: usize) {
        let shift = match self.joints[axis].motion {
            Motion::Turn(_) => minus(reference(self.joints, axis), self.joints[axis].origin),
            Motion::Slide(_) => [0.0; 3],
        };
        let shift = (shift != [0.0; 3]).then_some(shift);
        self.steps.push(Step { motion: Some(axis), shift, ..Step::default() });
        match (self.joints[axis].motion, &mut self.open) {
            (Motion::Slide(_), Some((_, passed))) => passed.push(axis),
            (Motion::Slide(_), None) => {}
            (Motion::Turn(_), open) => *open = None,
        }
    }

    /// A constant twist on the workpiece's side of the joint `end`.
    fn constant(&mut self, constant: Option<Six>, end: usize) {
        let about = reference(self.joints, end);
        self.last().constant = constant.map(|six| about_point(&six, about));
    }

    /// The errors of an axis; those that follow on the workpiece's side are joints before `end`.
    fn errors(&mut self, axis: usize, end: usize) {
        let Some(curves) = self.joints[axis].curves.clone() else { return };
        let about = reference(self.joints, end);
        let curves = curves.mapped(|six| about_point(six, about));
        if !curves.is_linear_table() {
            if self.last().errors.is_some() {
                self.steps.push(Step::default());
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
            self.steps.push(Step::default());
        }
        self.last().sum = Some(sum);
        self.open = Some((self.steps.len() - 1, Vec::new()));
    }

    /// The latest sum, taken from its step to act here; `None` if too much lies between.
    fn latest(&mut self) -> Option<Sum> {
        let (at, passed) = self.open.take()?;
        let mut sum = self.steps[at].sum.clone()?;
        match (&passed[..], sum.slide) {
            ([], _) => {}
            ([slide], None) => sum.passed(*slide, self.joints[*slide].motion)?,
            _ => return None,
        }
        self.steps[at].sum = None;
        Some(sum)
    }
}

impl Sum {
    /// Behind a slide; `None` if that is not along a machine axis.
    fn passed(&mut self, axis: usize, motion: Motion) -> Option<()> {
        let Motion::Slide(u) = motion else { return None };
        let along = (0..3).find(|k| (0..3).all(|j| j == *k || u[j] == 0.0))?;
        for (_, curves) in std::iter::once(&mut self.first).chain(&mut self.others) {
            curves.set_auxiliary(|[.., a, b, c]| {
                let [x, y, z] = cross([*a, *b, *c], u).map(|way| -way);
                [[y, z], [x, z], [x, y]][along]
            });
        }
        self.slide = Some(Slide { axis, along });
        Some(())
    }
}
