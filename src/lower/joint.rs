//! One joint: nominal motion N, error motion E, location error Loc, composed as the conventions say.
//!
//! With M the located motion, for an axis on the tool side (docs/theory.md, "Joints"):
//!
//! | | `axis_only`, M = Loc N Loc^-1 | `carried_body` |
//! |---|---|---|
//! | linear, `after`; rotary, `rotating` | M E | Loc N E |
//! | linear, `before`; rotary, `stationary` | E M | Loc E N |
//!
//! On the workpiece side the matrix is still the motion of the tool relative to the workpiece: the
//! mirror image, factors in reverse order. The bracket stands between T(origin) and T(-origin).

use crate::algebra::{Algebra, Htm, exp_hat, hat, rotation_about};
use crate::machine::{
    Axis, AxisKind, Branch, Conventions, ErrorsAre, Joints, LinearOrder, Location, RotaryOrder, sin_cos_degrees,
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

/// The matrix G of an axis at a position (mm or deg): tool relative to workpiece.
pub fn joint<S: Algebra>(axis: &Axis, conventions: &Conventions, position: f64, errors: &JointElements<S>) -> Htm<S> {
    let body = conventions.errors_are == ErrorsAre::Body && axis.branch == Branch::Workpiece;
    let carried = conventions.location == Location::CarriedBody;
    let nominal = nominal(axis, position);
    let error = errors.component.as_ref().map(|six| invert_if(body, error_motion(six, conventions.joints)));
    let location =
        errors.location.as_ref().map(|six| invert_if(body && carried, error_motion(six, conventions.joints)));
    let bracket = match location {
        Some(location) if carried => {
            let inner = with_error(axis, conventions, nominal, error);
            outermost(axis, &location, &inner)
        }
        Some(location) => with_error(axis, conventions, displaced(&location, &nominal), error),
        None => with_error(axis, conventions, nominal, error),
    };
    Htm::about(&axis.origin, bracket)
}

/// N(q): translation along, or rotation about, the axis direction.
fn nominal<S: Algebra>(axis: &Axis, position: f64) -> Htm<S> {
    let q = axis.sign() * position;
    match axis.kind {
        AxisKind::Linear => Htm::translation(Vector3::from(axis.direction).map(|u| S::from_real(u * q))),
        AxisKind::Rotary => {
            let (sine, cosine) = sin_cos_degrees(q);
            let linear = rotation_about(&axis.direction, (S::from_real(sine), S::from_real(cosine)));
            Htm { linear, ..Htm::identity() }
        }
    }
}

/// The matrix of six errors: orthogonal or linearised.
pub(super) fn error_motion<S: Algebra>(six: &[S; 6], joints: Joints) -> Htm<S> {
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
pub(super) fn invert_if<S: Algebra>(invert: bool, matrix: Htm<S>) -> Htm<S> {
    if invert { matrix.inverse().unwrap_or(matrix) } else { matrix }
}

/// `Loc N Loc^-1`.
fn displaced<S: Algebra>(location: &Htm<S>, nominal: &Htm<S>) -> Htm<S> {
    location.compose(nominal).compose(&invert_if(true, location.clone()))
}

/// E on its side of the motion.
fn with_error<S: Algebra>(axis: &Axis, conventions: &Conventions, motion: Htm<S>, error: Option<Htm<S>>) -> Htm<S> {
    let Some(error) = error else { return motion };
    if error_outside(axis, conventions) { error.compose(&motion) } else { motion.compose(&error) }
}

/// Is the product E M rather than M E? Both sides of the bed are mirror images.
fn error_outside(axis: &Axis, conventions: &Conventions) -> bool {
    let on_guide = match axis.kind {
        AxisKind::Linear => conventions.linear == LinearOrder::Before,
        AxisKind::Rotary => conventions.rotary == RotaryOrder::Stationary,
    };
    on_guide == (axis.branch == Branch::Tool)
}

/// A carried body's location error is outermost on the bed's side.
fn outermost<S: Algebra>(axis: &Axis, location: &Htm<S>, inner: &Htm<S>) -> Htm<S> {
    match axis.branch {
        Branch::Tool => location.compose(inner),
        Branch::Workpiece => inner.compose(location),
    }
}
