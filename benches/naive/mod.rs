//! The first program that comes to mind: every joint a 4x4 matrix, every curve looked up by itself, both chains
//! multiplied out, and the difference taken. Small angles in the error matrices (`joints: linearised`), default
//! conventions otherwise.

use abbe::evaluate::{Batch, Columns, CompiledModel, Frame, evaluate};
use abbe::machine::{AxisKind, Branch, ComponentError, Curve, ErrorTerm, Machine};

type Matrix = [[f64; 4]; 4];

struct Joint {
    rotary: bool,
    workpiece: bool,
    direction: [f64; 3],
    origin: [f64; 3],
    location: [f64; 6],
    curves: Vec<(Vec<f64>, Vec<f64>)>,
}

/// The chain, with its tables as they were given.
pub struct Chain {
    joints: Vec<Joint>,
    tip: [f64; 3],
}

fn identity() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            for k in 0..4 {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}

fn translation(by: [f64; 3], sign: f64) -> Matrix {
    let mut m = identity();
    (0..3).for_each(|k| m[k][3] = by[k] * sign);
    m
}

fn rotation(u: [f64; 3], degrees: f64) -> Matrix {
    let (s, c) = libm::sincos(degrees.to_radians());
    let hat = [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
    let mut m = identity();
    for i in 0..3 {
        for j in 0..3 {
            m[i][j] = f64::from(u8::from(i == j)) * c + s * hat[i][j] + (1.0 - c) * u[i] * u[j];
        }
    }
    m
}

fn error(six: [f64; 6]) -> Matrix {
    let [x, y, z, a, b, c] = six;
    [[1.0, -c, b, x], [c, 1.0, -a, y], [-b, a, 1.0, z], [0.0, 0.0, 0.0, 1.0]]
}

/// Returns the inverse to first order, which is enough for constants of some 1e-5.
fn inverse(m: &Matrix) -> Matrix {
    let mut r = identity();
    for i in 0..3 {
        for j in 0..3 {
            r[i][j] = m[j][i];
        }
    }
    for i in 0..3 {
        r[i][3] = -(0..3).map(|k| r[i][k] * m[k][3]).sum::<f64>();
    }
    r
}

fn look_up((positions, values): &(Vec<f64>, Vec<f64>), x: f64) -> f64 {
    if positions.is_empty() {
        return 0.0;
    }
    let i = positions.partition_point(|p| *p <= x).clamp(1, positions.len() - 1);
    let share = (x - positions[i - 1]) / (positions[i] - positions[i - 1]);
    values[i - 1] + share * (values[i] - values[i - 1])
}

impl Joint {
    fn matrix(&self, q: f64, real: bool) -> Matrix {
        let mut m = match self.rotary {
            true => rotation(self.direction, q),
            false => translation(self.direction.map(|u| u * q), 1.0),
        };
        if real {
            let location = error(self.location);
            m = product(&product(&location, &m), &inverse(&location));
            let e = error(std::array::from_fn(|k| look_up(&self.curves[k], q)));
            let outside = self.rotary != self.workpiece;
            m = if outside { product(&e, &m) } else { product(&m, &e) };
        }
        product(&product(&translation(self.origin, 1.0), &m), &translation(self.origin, -1.0))
    }
}

impl Chain {
    /// Builds the model of a machine whose curves are tables.
    pub fn new(machine: &Machine) -> Self {
        let joint = |(i, axis): (usize, &abbe::machine::Axis)| {
            let curve = |term: &Option<ErrorTerm>| match term {
                Some(ErrorTerm::Component(ComponentError::Single(Curve::Linear(knots)))) => {
                    (knots.positions().to_vec(), knots.values().to_vec())
                }
                _ => (Vec::new(), Vec::new()),
            };
            Joint {
                rotary: axis.kind == AxisKind::Rotary,
                workpiece: axis.branch == Branch::Workpiece,
                direction: axis.direction,
                origin: axis.origin,
                location: machine.axis_errors(i).location_values(),
                curves: machine.axis_errors(i).component.iter().map(curve).collect(),
            }
        };
        Self { joints: machine.axes().iter().enumerate().map(joint).collect(), tip: machine.tool().tip }
    }

    fn chain(&self, pose: &[f64], real: bool) -> Matrix {
        self.joints.iter().zip(pose).fold(identity(), |m, (joint, q)| product(&m, &joint.matrix(*q, real)))
    }

    /// The first `count` poses.
    pub fn run(&self, batch: &Batch<'_>, out: &mut Columns, count: usize) {
        for i in 0..count {
            let pose: [f64; 5] = std::array::from_fn(|axis| batch.axes()[axis][i]);
            let (real, nominal) = (self.chain(&pose, true), self.chain(&pose, false));
            for k in 0..3 {
                let at = |m: &Matrix| m[k][0] * self.tip[0] + m[k][1] * self.tip[1] + m[k][2] * self.tip[2] + m[k][3];
                out.position[k][i] = at(&real) - at(&nominal);
            }
            let relative = |a: usize, b: usize| (0..3).map(|k| real[a][k] * nominal[b][k]).sum::<f64>();
            let vector = |a: usize, b: usize| 0.5 * (relative(a, b) - relative(b, a));
            out.rotation[0][i] = vector(2, 1);
            out.rotation[1][i] = vector(0, 2);
            out.rotation[2][i] = vector(1, 0);
        }
    }
}

/// One pose over the general algebra.
pub fn general(plan: &CompiledModel, pose: &[f64], out: &mut Columns, index: usize) {
    let d = evaluate(plan.machine(), &plan.conditions().at_pose(pose), plan.order(), Frame::Workpiece).deviation;
    for k in 0..3 {
        out.position[k][index] = d.position[k];
        out.rotation[k][index] = d.rotation[k];
    }
}
