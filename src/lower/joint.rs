//! One joint: nominal motion N, error motion E, location error Loc, composed by the conventions.
//!
//! With M the located motion, for an axis on the tool side (docs/theory.md, "Joints"):
//!
//! | | `axis_only`, M = Loc N Loc^-1 | `carried_body` |
//! |---|---|---|
//! | linear, `after`; rotary, `rotating` | M E | Loc N E |
//! | linear, `before`; rotary, `stationary` | E M | Loc E N |
//!
//! On the workpiece side the matrix is still the motion of the tool relative to the workpiece: the mirror image,
//! factors in reverse order. The bracket is between T(origin) and T(-origin).

use crate::algebra::{Algebra, Htm, exp_hat, hat, rotation_about};
use crate::machine::{
    Axis, AxisKind, Conventions, ErrorFactor, JointConvention, Joints, LocationAction, MotionSide, sin_cos_degrees,
};
use nalgebra::Vector3;

/// The errors of a joint as elements: translations then rotations; `None` where all six are absent.
#[derive(Debug, Clone)]
pub struct JointElements<S> {
    /// Location errors.
    pub location: Option<[S; 6]>,
    /// Component errors at the position.
    pub component: Option<[S; 6]>,
}

/// The nominal motion of an axis, as programmed: the travel of a linear axis (mm), or sine and cosine of a
/// rotary axis's angle. Elements of any algebra: numbers, unknowns of Newton's iteration, symbols.
#[derive(Debug, Clone, PartialEq)]
pub enum JointPosition<S> {
    /// Along the direction.
    Linear(S),
    /// Sine and cosine of the angle about it.
    Rotary(S, S),
}

impl<S: Algebra> JointPosition<S> {
    /// At a number (mm or deg).
    pub fn at(axis: &Axis, position: f64) -> Self {
        match axis.kind {
            AxisKind::Linear => Self::Linear(S::from_real(position)),
            AxisKind::Rotary => {
                let (sine, cosine) = sin_cos_degrees(position);
                Self::Rotary(S::from_real(sine), S::from_real(cosine))
            }
        }
    }

    /// At a number (mm or deg) plus a nilpotent displacement (mm or rad).
    pub fn displaced(axis: &Axis, position: f64, by: &S) -> Self {
        match Self::at(axis, position) {
            Self::Linear(travel) => Self::Linear(travel + by.clone()),
            Self::Rotary(sine, cosine) => {
                let (s, c) = by.sin_cos();
                let turned = cosine.clone() * c.clone() - sine.clone() * s.clone();
                Self::Rotary(sine * c + cosine * s, turned)
            }
        }
    }

    /// Returns the motion in the sense in which the axis moves the tool relative to the workpiece.
    fn in_sense(&self, axis: &Axis) -> Self {
        match self.clone() {
            Self::Linear(travel) => Self::Linear(travel.scaled(axis.sign())),
            Self::Rotary(sine, cosine) => Self::Rotary(sine.scaled(axis.sign()), cosine),
        }
    }
}

/// Returns the matrix G of an axis at a position: tool relative to workpiece.
pub fn joint<S: Algebra>(
    axis: &Axis,
    conventions: &Conventions,
    position: &JointPosition<S>,
    errors: &JointElements<S>,
) -> Htm<S> {
    let convention = axis.convention(conventions);
    let nominal = nominal(axis, position);
    let error = errors.component.as_ref().map(|six| error_motion(six, conventions.joints));
    let location = errors.location.as_ref().map(|six| error_motion(six, conventions.joints));
    let bracket = match (location, convention.location) {
        (Some(location), LocationAction::Factor(factor)) => {
            let inner = with_error(&convention, nominal, error);
            beside(factor, location, inner)
        }
        (Some(location), LocationAction::Displaces) => {
            with_error(&convention, displaced(axis, &location, &nominal), error)
        }
        (None, _) => with_error(&convention, nominal, error),
    };
    Htm::about(&convention.pivot, bracket)
}

/// A factor of a joint's matrix, with its name: `N`, `E`, `E^-1`, `Loc`, `Loc^-1`, `Loc N Loc^-1`, `T(o)`, `T(-o)`.
#[derive(Debug, Clone, PartialEq)]
pub struct JointFactor<S: Algebra> {
    /// Its name.
    pub name: &'static str,
    /// The matrix.
    pub matrix: Htm<S>,
}

/// Returns the factors whose product, in this order, is the matrix of an axis.
pub fn joint_factors<S: Algebra>(
    axis: &Axis,
    conventions: &Conventions,
    position: &JointPosition<S>,
    errors: &JointElements<S>,
) -> Vec<JointFactor<S>> {
    let convention = axis.convention(conventions);
    let motion = nominal(axis, position);
    let error = |six: &[S; 6]| error_motion(six, conventions.joints);
    let (component, location) = (errors.component.as_ref().map(error), errors.location.as_ref().map(error));
    let factor = |name, matrix| JointFactor { name, matrix };
    let mut factors = match (&location, convention.location) {
        (Some(location), LocationAction::Displaces) if axis.kind == AxisKind::Linear => {
            vec![factor("Loc N Loc^-1", displaced(axis, location, &motion))]
        }
        (Some(location), LocationAction::Displaces) => {
            let back = factor("Loc^-1", invert_if(true, location.clone()));
            vec![factor("Loc", location.clone()), factor("N", motion), back]
        }
        _ => vec![factor("N", motion)],
    };
    let names = |plain, inverse, by: ErrorFactor| if by.inverse { inverse } else { plain };
    let mut put = |name, matrix: Htm<S>, by: ErrorFactor| {
        let new = factor(name, invert_if(by.inverse, matrix));
        match by.side {
            MotionSide::Outer => factors.insert(0, new),
            MotionSide::Inner => factors.push(new),
        }
    };
    if let Some(component) = component {
        put(names("E", "E^-1", convention.component), component, convention.component);
    }
    if let (Some(location), LocationAction::Factor(by)) = (location, convention.location) {
        put(names("Loc", "Loc^-1", by), location, by);
    }
    between(&convention.pivot, factors)
}

/// Factors between the translations to a point and back, unless that is the origin.
pub fn between<S: Algebra>(point: &[f64; 3], mut factors: Vec<JointFactor<S>>) -> Vec<JointFactor<S>> {
    if point.iter().any(|x| *x != 0.0) {
        let to = Vector3::from(*point);
        let translation = |v: Vector3<f64>| Htm::translation(v.map(S::from_real));
        factors.insert(0, JointFactor { name: "T(o)", matrix: translation(to) });
        factors.push(JointFactor { name: "T(-o)", matrix: translation(-to) });
    }
    factors
}

/// N(q): translation along, or rotation about, the axis direction.
pub(super) fn nominal<S: Algebra>(axis: &Axis, position: &JointPosition<S>) -> Htm<S> {
    match position.in_sense(axis) {
        JointPosition::Linear(travel) => Htm::translation(Vector3::from(axis.direction).map(|u| travel.scaled(u))),
        JointPosition::Rotary(sine, cosine) => {
            Htm { linear: rotation_about(&axis.direction, (sine, cosine)), ..Htm::identity() }
        }
    }
}

/// The matrix of six errors: orthogonal or linearised.
pub fn error_motion<S: Algebra>(six: &[S; 6], joints: Joints) -> Htm<S> {
    let [dx, dy, dz, ex, ey, ez] = six.clone();
    let linear = match joints {
        Joints::Orthogonal => exp_hat(&[ex, ey, ez]),
        Joints::Linearised => {
            let mut linear = hat(&[ex, ey, ez]);
            (0..3).for_each(|i| linear[(i, i)] = S::one());
            linear
        }
    };
    Htm { linear, translation: Vector3::new(dx, dy, dz) }
}

/// Inverse of an error matrix. Its determinant is 1 plus second-order terms: at the error sizes the
/// machine language admits (0.1 rad) it cannot vanish.
pub fn invert_if<S: Algebra>(invert: bool, matrix: Htm<S>) -> Htm<S> {
    if invert { matrix.inverse().unwrap_or(matrix) } else { matrix }
}

/// `Loc N Loc^-1`. Of a translation it is the translation along the displaced direction: written so,
/// there is nothing to divide by.
fn displaced<S: Algebra>(axis: &Axis, location: &Htm<S>, nominal: &Htm<S>) -> Htm<S> {
    if axis.kind == AxisKind::Linear {
        return Htm::translation(&location.linear * &nominal.translation);
    }
    location.compose(nominal).compose(&invert_if(true, location.clone()))
}

/// E, or its inverse, on its side of the motion.
fn with_error<S: Algebra>(convention: &JointConvention, motion: Htm<S>, error: Option<Htm<S>>) -> Htm<S> {
    match error {
        Some(error) => beside(convention.component, error, motion),
        None => motion,
    }
}

/// Returns an error matrix as a factor of a product.
fn beside<S: Algebra>(factor: ErrorFactor, error: Htm<S>, motion: Htm<S>) -> Htm<S> {
    let error = invert_if(factor.inverse, error);
    match factor.side {
        MotionSide::Outer => error.compose(&motion),
        MotionSide::Inner => motion.compose(&error),
    }
}
