//! First-order sensitivities over a batch, and the normal equations of a fit.
//!
//! A unit error at a joint is a twist in the nominal frame of that joint: the frames are computed once per pose, and
//! each source of error costs one cross product.

use super::batch::{Batch, Columns, Output, Slices};
use super::chain::{CompiledChain, CompiledJoint, LocationEffect, Motion};
use super::lanes::run;
use super::model::{CompiledModel, MAX_AXES};
use super::simd::{Kernel, Lanes};
use super::trigonometry::sin_cos;
use super::vector::{Vector, cross, minus, plus, plus_times, splat, times};
use crate::lower::{ErrorSite, Source};
use rayon::prelude::*;

/// The effect of a unit error, compiled.
#[derive(Debug, Clone, Copy)]
enum Response {
    /// A twist in a frame, about a point.
    Twist { frame: usize, about: [f64; 3], sign: f64, direction: usize },
    /// The difference of the same twist in the frames on both sides of a joint.
    Around { frame: usize, about: [f64; 3], direction: usize },
    /// A displacement per mm of travel, in a frame.
    Bend { axis: usize, by: [f64; 3] },
    /// A displacement of the tip.
    Tip { direction: usize },
    /// No effect.
    Nothing,
}

impl Response {
    fn new(chain: &CompiledChain, source: Source, origin: [f64; 3], gauge: [f64; 3]) -> Self {
        let direction = source.direction.index();
        let last = chain.joints.len();
        match source.place {
            ErrorSite::Workpiece => Self::Twist { frame: 0, about: origin, sign: -1.0, direction },
            ErrorSite::Tool if direction < 3 => Self::Tip { direction },
            ErrorSite::Tool => Self::Nothing,
            ErrorSite::Component(i) => chain.joints.get(i).map_or(Self::Nothing, |link| {
                let frame = if link.outside { i } else { i + 1 };
                Self::Twist { frame, about: link.origin, sign: sign(link.inverse), direction }
            }),
            ErrorSite::Location(i) => match chain.joints.get(i) {
                Some(link) => Self::location(link, i, direction),
                None => Self::Twist { frame: last, about: gauge, sign: 1.0, direction },
            },
        }
    }

    fn location(link: &CompiledJoint, axis: usize, direction: usize) -> Self {
        let (about, frame) = (link.origin, axis);
        match (link.location_effect, link.motion) {
            (LocationEffect::Around, Motion::Slide(_)) if direction < 3 => Self::Nothing,
            (LocationEffect::Around, Motion::Slide(u)) => {
                let unit = std::array::from_fn(|k| if k + 3 == direction { 1.0 } else { 0.0 });
                Self::Bend { axis, by: cross(unit, u) }
            }
            (LocationEffect::Around, Motion::Turn(_)) => Self::Around { frame, about, direction },
            (LocationEffect::Outermost, _) => Self::Twist { frame, about, sign: sign(link.inverse), direction },
            (LocationEffect::Innermost, _) => {
                Self::Twist { frame: axis + 1, about, sign: sign(link.inverse), direction }
            }
        }
    }
}

fn sign(inverse: bool) -> f64 {
    if inverse { -1.0 } else { 1.0 }
}

/// A nominal frame of the chain.
#[derive(Clone, Copy)]
struct NominalFrame<V> {
    /// Images of the unit vectors.
    columns: [Vector<V>; 3],
    /// Image of the machine's zero point, mm.
    origin: Vector<V>,
}

/// The frames before every joint, and after the last.
type Frames<V> = [NominalFrame<V>; MAX_AXES + 1];

struct Sensitivities<'a, 'o> {
    chain: &'a CompiledChain,
    responses: &'a [Response],
    poses: Slices<'a>,
    count: usize,
    out: &'a mut [Output<'o>],
}

impl Kernel for Sensitivities<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let mut at = 0;
        while at + V::COUNT <= self.count {
            self.step::<V>(at);
            at += V::COUNT;
        }
        while at < self.count {
            self.step::<f64>(at);
            at += 1;
        }
    }
}

impl Sensitivities<'_, '_> {
    #[inline(always)]
    fn step<V: Lanes>(&mut self, at: usize) {
        let frames = self.frames::<V>(at);
        let last = &frames[self.chain.joints.len()];
        let tip = image(last, &self.chain.tip);
        for (index, response) in self.responses.iter().enumerate() {
            let (d, w) = self.response(response, &frames, tip, at);
            let out = &mut self.out[index];
            for k in 0..3 {
                d[k].store(&mut out.position[k][at..]);
                w[k].store(&mut out.rotation[k][at..]);
            }
        }
    }

    #[inline(always)]
    fn frames<V: Lanes>(&self, at: usize) -> Frames<V> {
        let zero = V::splat(0.0);
        let unit: [Vector<V>; 3] = [splat(&[1.0, 0.0, 0.0]), splat(&[0.0, 1.0, 0.0]), splat(&[0.0, 0.0, 1.0])];
        let mut frames = [NominalFrame { columns: unit, origin: [zero; 3] }; MAX_AXES + 1];
        for (axis, link) in self.chain.joints.iter().enumerate() {
            let q = V::load(&self.poses.axes[axis][at..]);
            let NominalFrame { columns, origin } = frames[axis];
            frames[axis + 1] = match &link.motion {
                Motion::Slide(u) => {
                    NominalFrame { columns, origin: plus_times(origin, combined(&columns, splat(u)), q) }
                }
                Motion::Turn(about) => {
                    let turn = sin_cos(q);
                    let [a, b, c] = unit;
                    let turned = [
                        combined(&columns, about.turned(turn, a)),
                        combined(&columns, about.turned(turn, b)),
                        combined(&columns, about.turned(turn, c)),
                    ];
                    let o = splat(&link.origin);
                    let moved = minus(o, about.turned(turn, o));
                    NominalFrame { columns: turned, origin: plus(origin, combined(&columns, moved)) }
                }
            };
        }
        frames
    }

    #[inline(always)]
    fn response<V: Lanes>(
        &self,
        response: &Response,
        frames: &Frames<V>,
        tip: Vector<V>,
        at: usize,
    ) -> (Vector<V>, Vector<V>) {
        let zero = [V::splat(0.0); 3];
        match response {
            Response::Twist { frame, about, sign, direction } => {
                let (d, w) = twist(&frames[*frame], about, *direction, tip);
                (times(d, V::splat(*sign)), times(w, V::splat(*sign)))
            }
            Response::Around { frame, about, direction } => {
                let (outer, inner) = (&frames[*frame], &frames[*frame + 1]);
                let ((d, w), (e, v)) = (twist(outer, about, *direction, tip), twist(inner, about, *direction, tip));
                (minus(d, e), minus(w, v))
            }
            Response::Bend { axis, by } => {
                let q = V::load(&self.poses.axes[*axis][at..]);
                (times(combined(&frames[*axis].columns, splat(by)), q), zero)
            }
            Response::Tip { direction } => (frames[self.chain.joints.len()].columns[*direction], zero),
            Response::Nothing => (zero, zero),
        }
    }
}

#[inline(always)]
fn combined<V: Lanes>(columns: &[Vector<V>; 3], v: Vector<V>) -> Vector<V> {
    plus_times(plus_times(times(columns[0], v[0]), columns[1], v[1]), columns[2], v[2])
}

#[inline(always)]
fn image<V: Lanes>(frame: &NominalFrame<V>, point: &[f64; 3]) -> Vector<V> {
    plus(combined(&frame.columns, splat(point)), frame.origin)
}

/// Returns displacement and rotation of the tip by a unit error in a frame.
#[inline(always)]
fn twist<V: Lanes>(
    frame: &NominalFrame<V>,
    about: &[f64; 3],
    direction: usize,
    tip: Vector<V>,
) -> (Vector<V>, Vector<V>) {
    let axis = frame.columns[direction % 3];
    if direction < 3 { (axis, [V::splat(0.0); 3]) } else { (cross(axis, minus(tip, image(frame, about))), axis) }
}

/// One unknown of a fit: an error times a function of the pose.
#[derive(Debug, Clone, Copy)]
pub struct Unknown<'a> {
    /// The source of the error.
    pub source: Source,
    /// The function at every pose of the batch; `None` is the constant 1.
    pub basis: Option<&'a [f64]>,
}

/// NormalEquations equations `J^T J x = J^T r` of the position deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// J^T J.
    pub matrix: nalgebra::DMatrix<f64>,
    /// J^T r.
    pub right: nalgebra::DVector<f64>,
}

/// Number of poses summed together: the sums do not depend on the number of threads.
const BLOCK: usize = 2048;

impl CompiledModel {
    /// Computes the deviations by a unit of each source (1 mm, 1 rad) to first order, at every pose (mm, deg), in the
    /// workpiece frame: the same as [`sensitivities`](crate::lower::sensitivities). `out` has one output per source.
    /// Returns `None` if the chain is not compiled.
    pub fn sensitivities(&self, poses: &Batch<'_>, sources: &[Source], out: &mut [Output<'_>]) -> Option<()> {
        let chain = self.chain.as_ref()?;
        let count = out.iter().map(|out| out.len()).min().unwrap_or(0).min(poses.len());
        let (origin, gauge) = (self.machine.workpiece(), self.machine.tool().gauge);
        let responses: Vec<Response> =
            sources.iter().map(|source| Response::new(chain, *source, origin, gauge)).collect();
        let poses = Slices { axes: poses.axes(), added: &[], whole: poses.len() };
        run(self.width, Sensitivities { chain, responses: &responses, poses, count, out });
        Some(())
    }

    /// NormalEquations equations of unknowns against measured position deviations (mm), streamed: memory does not grow
    /// with the poses. The same bits on any number of threads. `None` for chains that are not compiled, or if lengths
    /// differ.
    pub fn normal_equations(
        &self,
        poses: &Batch<'_>,
        unknowns: &[Unknown<'_>],
        measured: [&[f64]; 3],
    ) -> Option<NormalEquations> {
        let lengths = unknowns.iter().filter_map(|u| u.basis).chain(measured).map(<[f64]>::len);
        if self.chain.is_none() || !lengths.into_iter().all(|len| len == poses.len()) {
            return None;
        }
        let starts: Vec<usize> = (0..poses.len()).step_by(BLOCK).collect();
        let n = unknowns.len();
        let zero = NormalEquations { matrix: nalgebra::DMatrix::zeros(n, n), right: nalgebra::DVector::zeros(n) };
        // A few blocks at a time, added in their order.
        Some(starts.chunks(64).fold(zero, |sum, starts| {
            let blocks: Vec<NormalEquations> =
                starts.par_iter().filter_map(|start| self.block_sums(poses, unknowns, measured, *start)).collect();
            blocks.into_iter().fold(sum, |sum, sums| NormalEquations {
                matrix: sum.matrix + sums.matrix,
                right: sum.right + sums.right,
            })
        }))
    }

    /// Returns the sums of one block, which begins at pose `start`.
    fn block_sums(
        &self,
        poses: &Batch<'_>,
        unknowns: &[Unknown<'_>],
        measured: [&[f64]; 3],
        start: usize,
    ) -> Option<NormalEquations> {
        let (_, rest) = poses.split_at(start);
        let (part, _) = rest.split_at(BLOCK.min(rest.len()));
        let sources: Vec<Source> = unknowns.iter().map(|u| u.source).collect();
        let mut columns = vec![Columns::new(part.len()); unknowns.len()];
        let mut out: Vec<Output<'_>> = columns.iter_mut().map(|c| c.output(part.len())).collect();
        self.sensitivities(&part, &sources, &mut out)?;
        let range = start..start + part.len();
        for (unknown, column) in unknowns.iter().zip(&mut columns) {
            if let Some(basis) = unknown.basis {
                let scaled = |c: &mut Vec<f64>| c.iter_mut().zip(&basis[range.clone()]).for_each(|(c, b)| *c *= b);
                column.position.iter_mut().for_each(scaled);
            }
        }
        let n = unknowns.len();
        let product = |i: usize, j: usize| (0..3).map(|k| sum(&columns[i].position[k], &columns[j].position[k])).sum();
        let mut matrix = nalgebra::DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                matrix[(i, j)] = product(i, j);
                matrix[(j, i)] = matrix[(i, j)];
            }
        }
        let against = |i: usize, _| (0..3).map(|k| sum(&columns[i].position[k], &measured[k][range.clone()])).sum();
        Some(NormalEquations { matrix, right: nalgebra::DVector::from_fn(n, against) })
    }
}

/// Returns the scalar product in eight interleaved sums: one order for any vector width.
fn sum(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_eights, b_eights) = (a.chunks_exact(8), b.chunks_exact(8));
    for (k, (x, y)) in a_eights.remainder().iter().zip(b_eights.remainder()).enumerate() {
        sums[k] += x * y;
    }
    for (a, b) in a_eights.zip(b_eights) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum()
}
