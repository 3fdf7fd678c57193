//! Joints as maps of points: nominally a rigid motion, and beside it a displacement. Both are affine in the point, at
//! every order.
//!
//! A section of a chain is therefore known by the displacements of four points; they are computed by the walk of the
//! order itself. Maps of sections are multiplied from the workpiece on. With the displacement D(x) = G x + h of a point
//! x, the nominal motion A x + t, and a dash for the inner of two sections,
//!
//! ```text
//! (A, t) (A', t') = (A A', A t' + t)        D D' (x) = G (A' x + t') + h + A D'(x) [+ G D'(x)]
//! ```
//!
//! The last term is a product of errors: order 1 drops it, at order 2 it is of second degree, the exact model keeps it.
//! The rotation relative to the nominal one is 1 + G A^T.

use super::chain::{CompiledChain, CompiledJoint, NominalMotion};
use super::curves::Six;
use super::lookup::LaneInputs;
use super::pass::MAX_SQUARED_HALF_ANGLE;
use super::vector::{cross, dot, minus, plus, plus_cross, plus_times, times};

/// A vector or a point.
pub type Vector3 = [f64; 3];

/// A part of the chain.
#[derive(Debug, Clone, Copy)]
pub enum Section {
    /// The set-up errors of the workpiece.
    WorkpieceSetup,
    /// A joint at a position.
    Joint(usize, Node),
    /// The errors of the spindle.
    Spindle,
}

/// A node of an axis.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Position, mm or deg.
    pub position: f64,
    /// Its sine and cosine.
    pub turn: (f64, f64),
    /// The six errors there.
    pub six: Six,
}

impl LaneInputs<f64> for Node {
    fn position(self, _: usize) -> f64 {
        self.position
    }

    fn added(self, _: usize) -> Option<f64> {
        None
    }

    fn turn(self, _: usize) -> (f64, f64) {
        self.turn
    }

    fn errors(self, _: usize) -> Six {
        self.six
    }
}

/// An order that can evaluate one section of the chain alone.
pub trait Sections {
    fn chain(&self) -> &CompiledChain;
    /// Returns the displacement of a point (mm) by the errors of a section, of first and of second degree (exact: all
    /// in the first), and the largest squared half angle met: above [`MAX_SQUARED_HALF_ANGLE`] the displacement is not
    /// valid.
    fn displacement_past(&self, section: Section, point: Vector3) -> ([Vector3; 2], f64);
}

/// The treatment of the product of two errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorProducts {
    /// Dropped: order 1.
    Dropped,
    /// Added to the second degree: order 2.
    SecondDegree,
    /// Added to the displacement: exact.
    Kept,
}

/// An affine map: `columns x + shift`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Linear {
    /// Columns of the linear part.
    pub columns: [Vector3; 3],
    /// Image of zero, mm.
    pub shift: Vector3,
}

impl Linear {
    /// Returns the image of x without the shift.
    #[inline(always)]
    pub fn rotate(&self, x: Vector3) -> Vector3 {
        plus_times(plus_times(times(self.columns[0], x[0]), self.columns[1], x[1]), self.columns[2], x[2])
    }

    /// Returns the image of x.
    #[inline(always)]
    pub fn image(&self, x: Vector3) -> Vector3 {
        plus(self.rotate(x), self.shift)
    }

    /// Returns the map to the sum of both images.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for k in 0..3 {
            sum.columns[k] = plus(sum.columns[k], other.columns[k]);
        }
        sum.shift = plus(sum.shift, other.shift);
        sum
    }

    /// Returns the linear part after another map.
    #[inline(always)]
    fn after(&self, other: &Self) -> Self {
        let [a, b, c] = other.columns;
        Self { columns: [self.rotate(a), self.rotate(b), self.rotate(c)], shift: self.rotate(other.shift) }
    }

    /// Returns this map after the nominal motion of an inner section.
    #[inline(always)]
    fn past(&self, inner: &Affine) -> Self {
        let columns = if inner.turns { self.after(&inner.nominal).columns } else { self.columns };
        Self { columns, shift: self.image(inner.nominal.shift) }
    }
}

/// A section: its nominal motion, and the displacement by degree.
#[derive(Debug, Clone, Copy)]
pub struct Affine {
    /// Nominal motion.
    pub nominal: Linear,
    /// Displacement of first and of second degree.
    pub displacement: [Linear; 2],
    /// True if the nominal motion rotates.
    turns: bool,
}

/// Distance of the probed points (mm): a power of two of a machine's size, so that differences lose no digits.
const PROBE_MM: f64 = 1024.0;

impl Affine {
    /// Returns the map of a section in coordinates about the functional point of the zero pose, for the machine's zero
    /// point may be far away; `None` if its rotations are beyond the range of the series.
    pub fn of(sections: &impl Sections, section: Section) -> Option<Self> {
        let base = sections.chain().tip;
        let probe = |point: Vector3| {
            let (displaced, squared_half_angle) = sections.displacement_past(section, plus(base, point));
            (squared_half_angle <= MAX_SQUARED_HALF_ANGLE).then_some(displaced)
        };
        let origin = probe([0.0; 3])?;
        let mut displacement = origin.map(|shift| Linear { columns: [[0.0; 3]; 3], shift });
        for k in 0..3 {
            let there = probe(std::array::from_fn(|i| if i == k { PROBE_MM } else { 0.0 }))?;
            for degree in 0..2 {
                displacement[degree].columns[k] = times(minus(there[degree], origin[degree]), 1.0 / PROBE_MM);
            }
        }
        let (nominal, turns) = match section {
            Section::Joint(axis, at) => nominal_map(&sections.chain().joints[axis], base, &at),
            Section::WorkpieceSetup | Section::Spindle => (UNIT, false),
        };
        Some(Self { nominal, displacement, turns })
    }

    /// Returns the product of this section and an inner one.
    #[inline(always)]
    pub fn times(&self, inner: &Self, products: ErrorProducts) -> Self {
        let (a, [first, second]) = (&self.nominal, &self.displacement);
        let [of_first, of_second] = &inner.displacement;
        let displacement = match products {
            ErrorProducts::Dropped => [first.past(inner).plus(&a.after(of_first)), Linear::default()],
            ErrorProducts::SecondDegree => [
                first.past(inner).plus(&a.after(of_first)),
                second.past(inner).plus(&a.after(of_second)).plus(&first.after(of_first)),
            ],
            ErrorProducts::Kept => [first.past(inner).plus(&a.plus(first).after(of_first)), Linear::default()],
        };
        Self { nominal: a.past(inner), displacement, turns: self.turns || inner.turns }
    }

    /// Returns the displacement of the base, by degree, after a displacement inside the section.
    pub fn displacement_past(&self, by: Vector3, products: ErrorProducts) -> [Vector3; 2] {
        let [first, second] = self.displacement.map(|displacement| displacement.shift);
        let (first, again) = (plus(first, self.nominal.rotate(by)), self.displacement[0].rotate(by));
        match products {
            ErrorProducts::Dropped => [first, second],
            ErrorProducts::SecondDegree => [first, plus(second, again)],
            ErrorProducts::Kept => [plus(first, again), second],
        }
    }

    /// Returns the axial vector of the rotation, by degree: the sine of the angle, along the axis.
    #[inline(always)]
    pub fn rotation(&self) -> [Vector3; 2] {
        let ([a, b, c], mut sines) = (self.nominal.columns, [[0.0; 3]; 2]);
        for degree in 0..2 {
            let [x, y, z] = self.displacement[degree].columns;
            sines[degree] = times(plus_cross(plus_cross(cross(a, x), b, y), c, z), 0.5);
        }
        sines
    }

    /// Returns the rotation relative to the nominal one, minus 1: columns of G A^T.
    pub fn relative(&self) -> [Vector3; 3] {
        let displaced = &self.displacement[0];
        std::array::from_fn(|k| displaced.rotate(self.nominal.columns.map(|column| column[k])))
    }

    /// Returns the angle (rad) from the nominal orientation, up to a quarter turn.
    pub fn angle(&self) -> f64 {
        let sines = self.rotation()[0];
        libm::asin(dot(sines, sines).sqrt().min(1.0))
    }
}

const UNIT: Linear = Linear { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

/// Returns the nominal motion of a joint in coordinates about a base; true if it rotates.
fn nominal_map(link: &CompiledJoint, base: Vector3, at: &Node) -> (Linear, bool) {
    match link.motion {
        NominalMotion::Slide(u) => (Linear { shift: times(u, at.position), ..UNIT }, false),
        NominalMotion::Turn(about) => {
            let columns = UNIT.columns.map(|e| about.rotate(at.turn, e));
            let arm = minus(link.origin, base);
            (Linear { columns, shift: minus(arm, about.rotate(at.turn, arm)) }, true)
        }
    }
}
