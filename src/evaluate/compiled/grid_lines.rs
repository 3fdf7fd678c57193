//! The lines of a tensor grid: at a node nothing is computed that depends on the outer axes or on the inner axis alone.
//!
//! The inner axis is the last one, the joint next to the tool. The maps of its nodes, and of everything on its tool
//! side, are computed once for the grid. The outer joints are one map ([`Affine`]) for a whole line, the product of
//! those at the nodes of each outer axis. Displacement and rotation at the nodes of a line are then sums of a few
//! numbers of the inner node times vectors of the line:
//!
//! ```text
//!          displacement                          rotation
//! order 1  h + G p + A d                         w + A r
//! order 2  h + G p + A d + G1 d1                 w + A r + w1 x A r1 / 2
//! exact    h + G p + (A + G) d                   the axial vector of G A^T + (A + G) X A^T
//! ```
//!
//! with point p, displacement d, rotation r behind the inner joint (1: of first degree), and 1 + X its relative
//! rotation. With orthogonal joints that axial vector is the sine of the angle along the axis, and a series makes the
//! rotation vector of it.

use super::affine::{Affine, ErrorProducts, Linear, Node, Section, Sections, Vector3};
use super::batch::Output;
use super::exact::{arcsine, polynomial};
use super::simd::{Kernel, Lanes, MAX_LANES};
use super::trigonometry::sin_cos;
use super::vector::{cross, dot, plus, splat, times};

/// A compiled model on the nodes of a grid.
#[derive(Debug, Clone)]
pub struct GridLines {
    products: ErrorProducts,
    /// True if the rotation vector is computed from its sine.
    arc: bool,
    workpiece_setup: Affine,
    /// Maps at the nodes of every outer axis.
    outer: Vec<Vec<Affine>>,
    inner: Inner,
}

/// Numbers at the nodes of the inner axis, in columns padded to whole vectors: the terms of displacements and of
/// rotations.
#[derive(Debug, Clone)]
struct Inner {
    count: usize,
    displacement: Vec<Vec<f64>>,
    rotation: Vec<Vec<f64>>,
}

/// Rotation (rad) of all errors together up to which the series is exact to rounding.
const MAX_ROTATION_RAD: f64 = 0.3;

/// Coefficients of asin s / s by powers of s^2, for s up to the sine of [`MAX_ROTATION_RAD`].
const ARCSINE: [f64; 14] = arcsine();

impl GridLines {
    /// Returns the model on the nodes of a grid, given by their positions (mm, deg) per axis; `None` without axes, and
    /// if the errors together may rotate beyond the range of the series.
    pub fn new(sections: &impl Sections, products: ErrorProducts, positions: &[Vec<f64>]) -> Option<Self> {
        let chain = sections.chain();
        let (spindle, workpiece_setup) =
            (Affine::of(sections, Section::Spindle)?, Affine::of(sections, Section::WorkpieceSetup)?);
        let mut outer: Vec<Vec<Affine>> = Vec::new();
        for (axis, positions) in positions.iter().enumerate() {
            let at = |q: &f64| Affine::of(sections, Section::Joint(axis, node(sections, axis, *q)));
            outer.push(positions.iter().map(at).collect::<Option<_>>()?);
        }
        let inner: Vec<Affine> = outer.pop()?.iter().map(|joint| joint.times(&spindle, products)).collect();
        let arc = products == ErrorProducts::Kept && !chain.linearised;
        let widest = |nodes: &Vec<Affine>| nodes.iter().map(Affine::angle).fold(0.0, f64::max);
        let angle = workpiece_setup.angle() + outer.iter().map(widest).sum::<f64>() + widest(&inner);
        if arc && angle > MAX_ROTATION_RAD {
            return None;
        }
        let inner = Inner::new(&inner, chain.tool, products);
        Some(Self { products, arc, workpiece_setup, outer, inner })
    }

    /// Multiplies the maps of the outer joints at these nodes, from the joint `from` on.
    #[inline(always)]
    fn compose_outer(&self, levels: &mut [Affine], nodes: &[usize], from: usize) {
        for k in from..self.outer.len() {
            levels[k + 1] = levels[k].times(&self.outer[k][nodes[k]], self.products);
        }
    }
}

fn node(sections: &impl Sections, axis: usize, position: f64) -> Node {
    let turn = sin_cos(position);
    let curves = sections.chain().joints[axis].lookup_request().curves;
    Node { position, turn, six: curves.map_or([0.0; 6], |curves| curves.at_position(position, turn)) }
}

impl Inner {
    /// Returns the columns for the maps at the nodes, and the set-up displacement of the functional point (mm).
    fn new(nodes: &[Affine], tool: Vector3, products: ErrorProducts) -> Self {
        let count = nodes.len();
        let mut inner = Self { count, displacement: Vec::new(), rotation: Vec::new() };
        let padded = |numbers: &mut Vec<Vec<f64>>, value: &dyn Fn(&Affine) -> Vector3| {
            for k in 0..3 {
                let mut column: Vec<f64> = nodes.iter().map(|node| value(node)[k]).collect();
                column.resize(count.next_multiple_of(MAX_LANES), 0.0);
                numbers.push(column);
            }
        };
        let displaced = |node: &Affine| node.displacement_past(tool, products);
        padded(&mut inner.displacement, &|node| node.nominal.shift);
        match products {
            ErrorProducts::Dropped => {
                padded(&mut inner.displacement, &|node| displaced(node)[0]);
                padded(&mut inner.rotation, &|node| node.rotation()[0]);
            }
            ErrorProducts::SecondDegree => {
                padded(&mut inner.displacement, &|node| plus(displaced(node)[1], displaced(node)[0]));
                padded(&mut inner.displacement, &|node| displaced(node)[0]);
                padded(&mut inner.rotation, &|node| plus(node.rotation()[1], node.rotation()[0]));
                padded(&mut inner.rotation, &|node| node.rotation()[0]);
            }
            ErrorProducts::Kept => {
                padded(&mut inner.displacement, &|node| displaced(node)[0]);
                for k in 0..3 {
                    padded(&mut inner.rotation, &|node| node.relative()[k]);
                }
            }
        }
        inner
    }
}

/// A run of whole lines of a grid.
pub struct Lines<'a, 'o> {
    /// The grid.
    pub grid: &'a GridLines,
    /// The first line: index of the node of every outer axis.
    pub first: Vec<usize>,
    /// Deviations of whole lines.
    pub out: Output<'o>,
}

impl Kernel for Lines<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        match (self.grid.products, self.grid.arc) {
            (ErrorProducts::Dropped, _) => self.all::<V, FirstOrderLine, 6, 3>(),
            (ErrorProducts::SecondDegree, _) => self.all::<V, SecondOrderLine, 9, 6>(),
            (ErrorProducts::Kept, false) => self.all::<V, ExactLine<false>, 6, 9>(),
            (ErrorProducts::Kept, true) => self.all::<V, ExactLine<true>, 6, 9>(),
        }
    }
}

/// A line: displacement and rotation as constants plus sums of vectors times the numbers of the inner node.
struct OuterLine<const D: usize, const R: usize> {
    displacement: [Vector3; D],
    shift: Vector3,
    rotation: [Vector3; R],
    turn: Vector3,
}

/// The form of the lines of an order. (A trait, for closures are compiled without the vector features.)
trait LineForm<const D: usize, const R: usize> {
    fn line(outer: &Affine) -> OuterLine<D, R>;

    /// Returns the rotation vector of the sum.
    #[inline(always)]
    fn finish<V: Lanes>(sum: [V; 3]) -> [V; 3] {
        sum
    }
}

/// Order 1.
struct FirstOrderLine;
/// Order 2.
struct SecondOrderLine;
/// The exact model; with orthogonal joints (`ARC`) the angle is computed from its sine.
struct ExactLine<const ARC: bool>;

impl LineForm<6, 3> for FirstOrderLine {
    #[inline(always)]
    fn line(outer: &Affine) -> OuterLine<6, 3> {
        let ([a, b, c], displaced) = (outer.nominal.columns, &outer.displacement[0]);
        let [g, h, i] = displaced.columns;
        OuterLine {
            displacement: [g, h, i, a, b, c],
            shift: displaced.shift,
            rotation: [a, b, c],
            turn: outer.rotation()[0],
        }
    }
}

impl LineForm<9, 6> for SecondOrderLine {
    #[inline(always)]
    fn line(outer: &Affine) -> OuterLine<9, 6> {
        let ([a, b, c], [first, second]) = (outer.nominal.columns, &outer.displacement);
        let ([d, e, f], sum) = (first.columns, second.plus(first));
        let [g, h, i] = sum.columns;
        let [w, ww] = outer.rotation();
        let half = times(w, 0.5);
        OuterLine {
            displacement: [g, h, i, a, b, c, d, e, f],
            shift: sum.shift,
            rotation: [a, b, c, cross(half, a), cross(half, b), cross(half, c)],
            turn: plus(ww, w),
        }
    }
}

impl<const ARC: bool> LineForm<6, 9> for ExactLine<ARC> {
    #[inline(always)]
    fn line(outer: &Affine) -> OuterLine<6, 9> {
        let displaced = &outer.displacement[0];
        let [g, h, i] = displaced.columns;
        let Linear { columns: [a, b, c], .. } = outer.nominal.plus(displaced);
        // The axial vector of u v^T is v x u / 2.
        let [p, q, r] = outer.nominal.columns.map(|column| times(column, 0.5));
        let rotation = [
            cross(p, a),
            cross(p, b),
            cross(p, c),
            cross(q, a),
            cross(q, b),
            cross(q, c),
            cross(r, a),
            cross(r, b),
            cross(r, c),
        ];
        OuterLine { displacement: [g, h, i, a, b, c], shift: displaced.shift, rotation, turn: outer.rotation()[0] }
    }

    #[inline(always)]
    fn finish<V: Lanes>(sum: [V; 3]) -> [V; 3] {
        if !ARC {
            return sum;
        }
        let square = dot(sum, sum);
        times(sum, polynomial(&ARCSINE, square))
    }
}

impl Lines<'_, '_> {
    #[inline(always)]
    fn all<V: Lanes, O: LineForm<D, R>, const D: usize, const R: usize>(mut self) {
        let grid = self.grid;
        let lines = self.out.len() / grid.inner.count;
        let mut nodes = std::mem::take(&mut self.first);
        let mut levels = vec![grid.workpiece_setup; grid.outer.len() + 1];
        let mut from = 0;
        for line in 0..lines {
            grid.compose_outer(&mut levels, &nodes, from);
            self.one::<V, O, D, R>(line, &O::line(&levels[grid.outer.len()]));
            from = advance(&mut nodes, |axis| grid.outer[axis].len());
        }
    }

    #[inline(always)]
    fn one<V: Lanes, O: LineForm<D, R>, const D: usize, const R: usize>(&mut self, line: usize, of: &OuterLine<D, R>) {
        let inner = &self.grid.inner;
        let mut i = 0;
        while i < inner.count {
            let d = sum::<V, D>(&of.displacement, &of.shift, &inner.displacement, i);
            let w = sum::<V, R>(&of.rotation, &of.turn, &inner.rotation, i);
            write(&mut self.out, line * inner.count + i, d, O::finish(w));
            i += V::COUNT;
        }
    }
}

#[inline(always)]
fn sum<V: Lanes, const N: usize>(
    vectors: &[Vector3; N],
    constant: &Vector3,
    numbers: &[Vec<f64>],
    at: usize,
) -> [V; 3] {
    let mut sum = splat::<V>(constant);
    for j in 0..N {
        let number = V::load(&numbers[j][at..]);
        for k in 0..3 {
            sum[k] = sum[k].plus_times(number, V::splat(vectors[j][k]));
        }
    }
    sum
}

/// Writes a vector of nodes. It may reach into the next line, which is written later, but not beyond the end.
#[inline(always)]
fn write<V: Lanes>(out: &mut Output<'_>, at: usize, d: [V; 3], w: [V; 3]) {
    let remaining = out.position[0].len() - at;
    for k in 0..3 {
        if V::COUNT <= remaining {
            d[k].store(&mut out.position[k][at..]);
            w[k].store(&mut out.rotation[k][at..]);
        } else {
            out.position[k][at..].copy_from_slice(&d[k].to_array()[..remaining]);
            out.rotation[k][at..].copy_from_slice(&w[k].to_array()[..remaining]);
        }
    }
}

/// Moves to the next line; returns the outermost axis that moved.
fn advance(nodes: &mut [usize], count: impl Fn(usize) -> usize) -> usize {
    for k in (0..nodes.len()).rev() {
        nodes[k] += 1;
        if nodes[k] < count(k) {
            return k;
        }
        nodes[k] = 0;
    }
    0
}
