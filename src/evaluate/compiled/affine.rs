//! Joints as maps of points: ideally a rigid motion, and beside it a displacement. Both are affine in the point, at every order.
//!
//! So a section of a chain is known when the displacement of four points is: the walk of the order itself is asked for them. Maps of
//! sections are multiplied from the workpiece on. Where x is displaced by D(x) = G x + h, ideally moved by A x + t, and the section
//! outside by capitals without a dash,
//!
//! ```text
//! (A, t) (A', t') = (A A', A t' + t)        D D' (x) = G (A' x + t') + h + A D'(x) [+ G D'(x)]
//! ```
//!
//! The last term is a product of errors: order 1 goes without, at order 2 it is of second degree, the exact model has it whole. The
//! rotation relative to the nominal one is 1 + G A^T.

use super::chain::{CompiledChain, CompiledJoint, Motion};
use super::curves::Six;
use super::lookup::Inputs;
use super::pass::MAX_SQUARED_HALF_ANGLE;
use super::vector::{cross, dot, minus, plus, plus_cross, plus_times, times};

/// A vector or a point.
pub type Vector3 = [f64; 3];

/// A part of the chain.
#[derive(Debug, Clone, Copy)]
pub enum Section {
    /// The errors of the clamped workpiece.
    Clamping,
    /// A joint at a position.
    Joint(usize, Node),
    /// The errors of the spindle.
    Spindle,
}

/// A node of an axis: the position, its sine and cosine, and the errors there.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    pub position: f64,
    pub turn: (f64, f64),
    pub six: Six,
}

impl Inputs<f64> for Node {
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

/// An order that can be asked for one section alone.
pub trait Sections {
    /// The chain.
    fn chain(&self) -> &CompiledChain;
    /// The displacement of a point by its errors, of first and of second degree (exact: all in the first), and a number that is
    /// above [`MAX_SQUARED_HALF_ANGLE`] if it must not be trusted.
    fn displaced(&self, section: Section, point: Vector3) -> ([Vector3; 2], f64);
}

/// Where the product of two errors belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorProducts {
    /// Nowhere: order 1.
    Dropped,
    /// Into the second degree: order 2.
    SecondDegree,
    /// To all the rest: exact.
    Kept,
}

/// Of the image of x: `columns x + shift`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Linear {
    pub columns: [Vector3; 3],
    pub shift: Vector3,
}

impl Linear {
    /// Without the shift.
    #[inline(always)]
    pub fn turned(&self, x: Vector3) -> Vector3 {
        plus_times(plus_times(times(self.columns[0], x[0]), self.columns[1], x[1]), self.columns[2], x[2])
    }

    #[inline(always)]
    pub fn image(&self, x: Vector3) -> Vector3 {
        plus(self.turned(x), self.shift)
    }

    /// Sum of both images.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for k in 0..3 {
            sum.columns[k] = plus(sum.columns[k], other.columns[k]);
        }
        sum.shift = plus(sum.shift, other.shift);
        sum
    }

    /// The linear part alone after another map.
    #[inline(always)]
    fn after(&self, other: &Self) -> Self {
        let [a, b, c] = other.columns;
        Self { columns: [self.turned(a), self.turned(b), self.turned(c)], shift: self.turned(other.shift) }
    }

    /// After the nominal motion of a section.
    #[inline(always)]
    fn past(&self, inner: &Affine) -> Self {
        let columns = if inner.turns { self.after(&inner.nominal).columns } else { self.columns };
        Self { columns, shift: self.image(inner.nominal.shift) }
    }
}

/// A section: its nominal motion, and the displacement by degree.
#[derive(Debug, Clone, Copy)]
pub struct Affine {
    pub nominal: Linear,
    pub displacement: [Linear; 2],
    /// Does it turn (ideally)?
    turns: bool,
}

/// Points are asked for at this distance (mm): a power of two of a machine's size, so that differences lose nothing.
const PROBE: f64 = 1024.0;

impl Affine {
    /// In coordinates about the functional point of the zero pose, for the machine's zero point may be far away. `None` where the
    /// numbers must not be trusted.
    pub fn of(sections: &impl Sections, section: Section) -> Option<Self> {
        let base = sections.chain().tip;
        let asked = |point: Vector3| {
            let (displaced, far) = sections.displaced(section, plus(base, point));
            (far <= MAX_SQUARED_HALF_ANGLE).then_some(displaced)
        };
        let origin = asked([0.0; 3])?;
        let mut displacement = origin.map(|shift| Linear { columns: [[0.0; 3]; 3], shift });
        for k in 0..3 {
            let there = asked(std::array::from_fn(|i| if i == k { PROBE } else { 0.0 }))?;
            for degree in 0..2 {
                displacement[degree].columns[k] = times(minus(there[degree], origin[degree]), 1.0 / PROBE);
            }
        }
        let (nominal, turns) = match section {
            Section::Joint(axis, at) => moved(&sections.chain().joints[axis], base, &at),
            Section::Clamping | Section::Spindle => (UNIT, false),
        };
        Some(Self { nominal, displacement, turns })
    }

    /// This one outside another.
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

    /// The displacement of the base, by degree, that is already displaced from where it ideally is.
    pub fn displaced(&self, by: Vector3, products: ErrorProducts) -> [Vector3; 2] {
        let [first, second] = self.displacement.map(|displacement| displacement.shift);
        let (first, again) = (plus(first, self.nominal.turned(by)), self.displacement[0].turned(by));
        match products {
            ErrorProducts::Dropped => [first, second],
            ErrorProducts::SecondDegree => [first, plus(second, again)],
            ErrorProducts::Kept => [plus(first, again), second],
        }
    }

    /// By degree, the vector of the rotation's antisymmetric chunk: the sine of the angle, along the axis.
    #[inline(always)]
    pub fn rotation(&self) -> [Vector3; 2] {
        let ([a, b, c], mut sines) = (self.nominal.columns, [[0.0; 3]; 2]);
        for degree in 0..2 {
            let [x, y, z] = self.displacement[degree].columns;
            sines[degree] = times(plus_cross(plus_cross(cross(a, x), b, y), c, z), 0.5);
        }
        sines
    }

    /// The rotation relative to the nominal one less 1: columns of G A^T.
    pub fn relative(&self) -> [Vector3; 3] {
        let displaced = &self.displacement[0];
        std::array::from_fn(|k| displaced.turned(self.nominal.columns.map(|column| column[k])))
    }

    /// The angle (rad) by which it turns off the nominal orientation, up to a quarter turn.
    pub fn angle(&self) -> f64 {
        let sines = self.rotation()[0];
        libm::asin(dot(sines, sines).sqrt().min(1.0))
    }
}

const UNIT: Linear = Linear { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

/// The nominal motion of a joint about a base; does it turn?
fn moved(link: &CompiledJoint, base: Vector3, at: &Node) -> (Linear, bool) {
    match link.motion {
        Motion::Slide(u) => (Linear { shift: times(u, at.position), ..UNIT }, false),
        Motion::Turn(about) => {
            let columns = UNIT.columns.map(|e| about.turned(at.turn, e));
            let arm = minus(link.origin, base);
            (Linear { columns, shift: minus(arm, about.turned(at.turn, arm)) }, true)
        }
    }
}
