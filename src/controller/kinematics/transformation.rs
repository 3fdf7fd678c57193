//! The five-axis transformation of a controller, in own arithmetic: rotary axes are lines, X, Y and Z are parallel to
//! the machine, and the tool is a vector from the gauge point.
//!
//! A point of the tool, seen from the workpiece, is `R1 ... (x + Rn ... tip)`: turned about the lines of the head,
//! moved by the linear axes, turned about the lines of the table, each in the order of the walk from the tool to the
//! workpiece. All vectors are in machine directions with the rotary axes at 0, and count from the gauge point with all
//! axes at 0.

use crate::algebra::{hat, rotation_about};
use crate::compensation::{MachinePart, RotaryPlacement};
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix3, Vector3};

/// A rotary axis as a controller knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct RotaryLine {
    /// Index in the walk.
    pub axis: usize,
    /// The unit vector about which a positive command turns the tool right-handed relative to the workpiece.
    pub direction: Vector3<f64>,
    /// A point of the line, mm.
    pub point: Vector3<f64>,
}

/// The transformation.
#[derive(Debug, Clone, PartialEq)]
pub struct Transformation {
    /// The kind of machine.
    pub placement: RotaryPlacement,
    /// Indices in the walk of X, Y and Z.
    pub linear: [usize; 3],
    /// Axes that carry the workpiece, in the order of the walk from the workpiece.
    pub table: Vec<RotaryLine>,
    /// Axes that carry the tool, in the order of the walk.
    pub head: Vec<RotaryLine>,
    /// The tool axis, from the tip to the spindle: a unit vector.
    pub tool: Vector3<f64>,
}

/// The words of a block: the tip of the tool in the workpiece (mm, from the gauge point with all axes at 0), and
/// either the rotary axes or the direction of the tool axis.
#[derive(Debug, Clone, Copy)]
pub struct ProgrammedTool<'a> {
    /// The tip.
    pub tip: Vector3<f64>,
    /// The vector from the gauge point to the tip of a tool that stands along the nominal tool axis, mm.
    pub tool: Vector3<f64>,
    /// The nominal tool axis.
    pub nominal_axis: Vector3<f64>,
    /// Positions of all axes, mm and deg.
    pub axes: &'a [f64],
    /// The direction of the tool axis in the workpiece, if it is programmed by a vector.
    pub vector: Option<Vector3<f64>>,
}

/// A rotary axis that would turn by more than this for a small correction is at a pole, deg: there the controller keeps
/// the axis next to the workpiece where it was programmed.
const MAX_TURN: f64 = 5.0;

impl Transformation {
    /// Returns the line of a part; `None` if the machine has no such axis.
    pub fn line(&self, part: MachinePart) -> Option<&RotaryLine> {
        match part {
            MachinePart::TableFirst => self.table.last(),
            MachinePart::TableSecond => self.table.first().filter(|_| self.table.len() > 1),
            MachinePart::HeadFirst => self.head.first(),
            MachinePart::HeadSecond => self.head.last().filter(|_| self.head.len() > 1),
            MachinePart::Gauge | MachinePart::Tool => None,
        }
    }

    /// The same, to be changed.
    pub fn line_mut(&mut self, part: MachinePart) -> Option<&mut RotaryLine> {
        let axis = self.line(part)?.axis;
        self.table.iter_mut().chain(&mut self.head).find(|line| line.axis == axis)
    }

    /// Returns the positions to which the controller sends the axes, mm and deg.
    pub fn command(&self, program: &ProgrammedTool) -> Vec<f64> {
        let mut command = program.axes.to_vec();
        if let Some(vector) = &program.vector {
            self.turn(vector, &mut command);
        }
        let on_table = self.table.iter().fold(program.tip, |point, line| line.turn(&point, -command[line.axis]));
        let tip = self.tip(program);
        let of_head = self.head.iter().rev().fold(tip, |point, line| line.turn(&point, command[line.axis]));
        self.linear.iter().enumerate().for_each(|(k, axis)| command[*axis] = on_table[k] - of_head[k]);
        command
    }

    /// The lines from the workpiece to the tool.
    fn rotary(&self) -> Vec<&RotaryLine> {
        self.table.iter().chain(&self.head).collect()
    }

    /// True where an axis is kept because a tool direction needs a large turn of it or has no solution.
    pub fn at_pole(&self, program: &ProgrammedTool) -> bool {
        match (&program.vector, &self.rotary()[..]) {
            (Some(vector), [outer, inner]) => {
                self.two([outer, inner], vector, [program.axes[outer.axis], program.axes[inner.axis]]).is_none()
            }
            _ => false,
        }
    }

    /// The tip from the gauge point, rotary axes at 0: a tool stands along the controller's tool axis.
    fn tip(&self, program: &ProgrammedTool) -> Vector3<f64> {
        self.tilt(&program.tool, &program.nominal_axis)
    }

    /// A vector turned as the nominal tool axis is to this one.
    pub fn tilt(&self, vector: &Vector3<f64>, nominal_axis: &Vector3<f64>) -> Vector3<f64> {
        let about = hat(&nominal_axis.cross(&self.tool).into());
        let tilt = Matrix3::identity() + about + about * about / (1.0 + nominal_axis.dot(&self.tool));
        tilt * vector
    }

    /// Turns the rotary axes so that the tool axis has a direction in the workpiece, or comes as near as they let it,
    /// with the solution nearest to where they are programmed.
    fn turn(&self, vector: &Vector3<f64>, command: &mut [f64]) {
        match self.rotary()[..] {
            [only] => command[only.axis] = near(only.angle(&self.tool, vector), command[only.axis]),
            [outer, inner] => {
                let programmed = [command[outer.axis], command[inner.axis]];
                let solution = self.two([outer, inner], vector, programmed);
                let [first, second] = solution.unwrap_or_else(|| self.inner_alone([outer, inner], vector, programmed));
                (command[outer.axis], command[inner.axis]) = (first, second);
            }
            _ => {}
        }
    }

    /// Angles (deg) with the outer axis where it is programmed, and the inner one as near to the vector as it comes.
    fn inner_alone(&self, [outer, inner]: [&RotaryLine; 2], vector: &Vector3<f64>, programmed: [f64; 2]) -> [f64; 2] {
        let seen = outer.rotation(-programmed[0]) * vector;
        [programmed[0], near(inner.angle(&self.tool, &seen), programmed[1])]
    }

    /// Angles of two axes, deg; `None` at a pole. The direction between the two turns is on the cone of the outer axis
    /// through the programmed vector and on that of the inner axis through the tool.
    fn two(&self, [outer, inner]: [&RotaryLine; 2], vector: &Vector3<f64>, programmed: [f64; 2]) -> Option<[f64; 2]> {
        let (u, w) = (outer.direction, inner.direction);
        let cross = u.cross(&w);
        let cosine = u.dot(&w);
        let (to_outer, to_inner) = (u.dot(vector), w.dot(&self.tool));
        let below = cosine * cosine - 1.0;
        let a = (cosine * to_inner - to_outer) / below;
        let b = (cosine * to_outer - to_inner) / below;
        let rest = (1.0 - a * a - b * b - 2.0 * a * b * cosine) / cross.norm_squared();
        let between = |c: f64| u * a + w * b + cross * c;
        let solution = |c: f64| {
            let middle = between(c);
            let first = near(outer.angle(&middle, vector), programmed[0]);
            [first, near(inner.angle(&self.tool, &middle), programmed[1])]
        };
        let far = |angles: &[f64; 2]| (0..2).map(|i| (angles[i] - programmed[i]).abs()).fold(0.0, f64::max);
        let root = libm::sqrt(rest.max(0.0));
        let best = [solution(root), solution(-root)].into_iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        best.filter(|angles| rest >= 0.0 && far(angles) <= MAX_TURN)
    }
}

impl RotaryLine {
    /// The rotation by an angle, deg.
    fn rotation(&self, degrees: f64) -> Matrix3<f64> {
        rotation_about(&self.direction.into(), sin_cos_degrees(degrees))
    }

    /// A point turned about the line by an angle, deg.
    fn turn(&self, point: &Vector3<f64>, degrees: f64) -> Vector3<f64> {
        self.point + self.rotation(degrees) * (point - self.point)
    }

    /// The angle (deg) by which a vector turned about the line comes nearest to another.
    fn angle(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        let u = self.direction;
        let [from, to] = [from, to].map(|v| v - u * u.dot(v));
        libm::atan2(u.dot(&from.cross(&to)), from.dot(&to)).to_degrees()
    }
}

/// The angle plus as many turns as bring it nearest to another.
fn near(angle: f64, to: f64) -> f64 {
    angle + 360.0 * libm::round((to - angle) / 360.0)
}
