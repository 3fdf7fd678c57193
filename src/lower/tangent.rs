//! Derivatives of the functional point at the actual errors. Each error lives in one factor of one joint, so that
//! dp = P dF x: the actual prefix P, and the actual point x that the rest of the walk makes of the tip. One walk
//! gives all of them. Over D_n the derivatives are those of the model of order n.

use super::chain::{Chain, into_part};
use super::joint::{JointPosition, error_motion, invert_if, nominal};
use super::source::{AxisErrorValues, Elements, ErrorLift, ErrorSite, ErrorValues, Source};
use crate::algebra::{Algebra, Htm, left_jacobian, product, transform};
use crate::machine::{AxisKind, Direction, Joints, LocationAction, Machine, MotionSide};
use nalgebra::{Matrix3, Vector3};

/// The actual functional point, and its derivatives by single errors.
#[derive(Debug, Clone)]
pub struct PositionJacobian<S: Algebra> {
    /// The actual functional point from the workpiece origin (mm, workpiece frame).
    pub point: Vector3<S>,
    /// Its derivative by each source asked for (mm per mm or per rad, workpiece frame).
    pub derivatives: Vec<Vector3<S>>,
}

/// Returns the actual functional point from the workpiece origin (mm, workpiece frame) over an algebra.
pub fn point<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    values: &ErrorValues,
    lift: &impl ErrorLift<S>,
) -> Vector3<S> {
    let chain = Chain::actual(machine, pose, values, lift);
    let image =
        chain.walk().rev().fold(chain.tip.clone(), |x, joint| transform(&joint.linear, &x) + &joint.translation);
    into_part(machine, minus(image, &machine.workpiece()))
}

fn minus<S: Algebra>(x: Vector3<S>, point: &[f64; 3]) -> Vector3<S> {
    Vector3::from_fn(|i, _| x[i].clone() - S::from_real(point[i]))
}

fn plus<S: Algebra>(x: Vector3<S>, point: &[f64; 3]) -> Vector3<S> {
    Vector3::from_fn(|i, _| x[i].clone() + S::from_real(point[i]))
}

/// Returns the actual functional point at a pose (mm, deg) with its derivatives by `sources`, at these errors.
pub fn position_jacobian<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    values: &ErrorValues,
    lift: &impl ErrorLift<S>,
    sources: &[Source],
) -> PositionJacobian<S> {
    image_jacobian(machine, pose, values, lift, sources, None)
}

/// Returns the actual image of a direction of the tool frame at a pose (mm, deg), in the workpiece frame, with its
/// derivatives by `sources`, at these errors.
pub fn direction_jacobian<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    values: &ErrorValues,
    lift: &impl ErrorLift<S>,
    sources: &[Source],
    direction: &Vector3<f64>,
) -> PositionJacobian<S> {
    image_jacobian(machine, pose, values, lift, sources, Some(direction))
}

/// Returns the image of the functional point, or of a direction, that translations do not move.
fn image_jacobian<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    values: &ErrorValues,
    lift: &impl ErrorLift<S>,
    sources: &[Source],
    direction: Option<&Vector3<f64>>,
) -> PositionJacobian<S> {
    let point = direction.is_none();
    let lowering = Lowering { machine, elements: Elements::new(machine, lift) };
    let mut walk = vec![lowering.workpiece_setup(values)];
    walk.extend((0..pose.len()).map(|i| lowering.joint(i, pose[i], &values.axes[i])));
    walk.push(lowering.spindle(values));
    let tip = || lowering.elements.tip(machine.tool().tip, values.tool);
    let mut x = direction.map_or_else(tip, |direction| direction.map(S::from_real));
    for joint in walk.iter_mut().rev() {
        let origin = if point { joint.origin } else { [0.0; 3] };
        x = plus(joint.pass(minus(x, &origin), point), &origin);
    }
    let mut prefix = Matrix3::from_fn(|i, j| if i == j { S::one() } else { S::zero() });
    let mut moved = Vec::with_capacity(walk.len());
    for joint in &walk {
        moved.push(joint.derivatives(&mut prefix, point, machine.conventions().joints));
    }
    let derivative = |source: &Source| {
        let k = source.direction.index();
        match source.place {
            ErrorSite::Workpiece => moved[0][0][k].clone(),
            ErrorSite::Location(i) => moved[i + 1][0][k].clone(),
            ErrorSite::Component(i) => moved[i + 1][1][k].clone(),
            ErrorSite::Tool if point => prefix.column(k % 3).into_owned(),
            ErrorSite::Tool => Vector3::from_fn(|_, _| S::zero()),
        }
    };
    PositionJacobian {
        point: into_part(machine, minus(x, &if point { machine.workpiece() } else { [0.0; 3] })),
        derivatives: sources.iter().map(|source| into_part(machine, derivative(source))).collect(),
    }
}

/// An error matrix of a factor, and its derivatives by its six errors.
struct FactorMotion<S: Algebra> {
    matrix: Htm<S>,
    jacobian: Option<Matrix3<S>>,
}

/// A factor of a joint's bracket and the point that it was applied to.
struct Factor<S: Algebra> {
    kind: FactorKind<S>,
    input: Vector3<S>,
}

enum FactorKind<S: Algebra> {
    /// The nominal motion.
    Nominal(Htm<S>),
    /// The error motion, or its inverse: 0 for location, 1 for component errors.
    Error(usize, Option<Htm<S>>),
    /// `Loc N Loc^-1` of a translation: the translation along the displaced direction.
    Displaced(Vector3<S>),
}

/// Returns the image of a point, or of a direction.
fn image<S: Algebra>(g: &Htm<S>, x: &Vector3<S>, point: bool) -> Vector3<S> {
    let turned = transform(&g.linear, x);
    if point { turned + &g.translation } else { turned }
}

/// A joint: its bracket about an origin.
struct JointFactors<S: Algebra> {
    origin: [f64; 3],
    motions: [FactorMotion<S>; 2],
    factors: Vec<Factor<S>>,
}

impl<S: Algebra> JointFactors<S> {
    fn new(origin: [f64; 3], motions: [FactorMotion<S>; 2], kinds: Vec<FactorKind<S>>) -> Self {
        let zero = Vector3::from_fn(|_, _| S::zero());
        let factors = kinds.into_iter().map(|kind| Factor { kind, input: zero.clone() }).collect();
        Self { origin, motions, factors }
    }

    /// Applies the bracket to a point (or to a direction); every factor keeps its input.
    fn pass(&mut self, mut x: Vector3<S>, point: bool) -> Vector3<S> {
        let Self { motions, factors, .. } = self;
        let apply = |g: &Htm<S>, x: &Vector3<S>| image(g, x, point);
        for factor in factors.iter_mut().rev() {
            let image = match &factor.kind {
                FactorKind::Nominal(g) | FactorKind::Error(_, Some(g)) => apply(g, &x),
                FactorKind::Error(which, None) => apply(&motions[*which].matrix, &x),
                FactorKind::Displaced(shift) if point => transform(&motions[0].matrix.linear, shift) + &x,
                FactorKind::Displaced(_) => x.clone(),
            };
            factor.input = std::mem::replace(&mut x, image);
        }
        x
    }

    /// Derivatives by location and component errors; the prefix moves on past this joint.
    fn derivatives(&self, prefix: &mut Matrix3<S>, point: bool, joints: Joints) -> [[Vector3<S>; 6]; 2] {
        let zero = || std::array::from_fn(|_| Vector3::from_fn(|_, _| S::zero()));
        let mut sum: [[Vector3<S>; 6]; 2] = [zero(), zero()];
        for factor in &self.factors {
            match &factor.kind {
                FactorKind::Nominal(g) => *prefix = product(prefix, &g.linear),
                FactorKind::Error(which, None) => {
                    let motion = &self.motions[*which];
                    motion.add(&mut sum[*which], prefix, point, &factor.input, joints);
                    *prefix = product(prefix, &motion.matrix.linear);
                }
                FactorKind::Error(which, Some(inverse)) => {
                    // d(M^-1) x = -M^-1 dM (M^-1 x).
                    let after = product(prefix, &inverse.linear);
                    let image = image(inverse, &factor.input, point);
                    let back = after.map(|x| -x);
                    self.motions[*which].add(&mut sum[*which], &back, point, &image, joints);
                    *prefix = after;
                }
                FactorKind::Displaced(shift) if point => {
                    self.motions[0].add(&mut sum[0], prefix, false, shift, joints);
                }
                FactorKind::Displaced(_) => {}
            }
        }
        sum
    }
}

impl<S: Algebra> FactorMotion<S> {
    fn new(six: &[S; 6], joints: Joints) -> Self {
        let jacobian = match joints {
            Joints::Orthogonal if six[3..].iter().any(|e| !e.is_zero()) => {
                Some(left_jacobian(&[six[3].clone(), six[4].clone(), six[5].clone()]))
            }
            _ => None,
        };
        Self { matrix: error_motion(six, joints), jacobian }
    }

    /// Adds prefix times the derivatives of the motion of a point (or of a direction only).
    fn add(&self, sum: &mut [Vector3<S>; 6], prefix: &Matrix3<S>, point: bool, x: &Vector3<S>, joints: Joints) {
        let turned = match joints {
            Joints::Orthogonal => transform(&self.matrix.linear, x),
            Joints::Linearised => x.clone(),
        };
        for k in 0..3 {
            if point {
                sum[k] += prefix.column(k);
            }
            let w = self.jacobian.as_ref().map_or_else(
                || Vector3::from_fn(|i, _| if i == k { S::one() } else { S::zero() }),
                |j| j.column(k).into_owned(),
            );
            let at = |i: usize| {
                let (a, b) = ((i + 1) % 3, (i + 2) % 3);
                w[a].clone() * turned[b].clone() - w[b].clone() * turned[a].clone()
            };
            sum[3 + k] += transform(prefix, &Vector3::new(at(0), at(1), at(2)));
        }
    }
}

/// Numbers to factors.
struct Lowering<'a, L> {
    machine: &'a Machine,
    elements: Elements<'a, L>,
}

impl<L> Lowering<'_, L> {
    fn motion<S: Algebra>(&self, place: ErrorSite, six: &[f64; 6]) -> FactorMotion<S>
    where
        L: ErrorLift<S>,
    {
        let element = |direction: Direction| self.elements.one(Source { place, direction }, six[direction.index()]);
        FactorMotion::new(&Direction::ALL.map(element), self.machine.conventions().joints)
    }

    fn none<S: Algebra>(&self) -> FactorMotion<S> {
        FactorMotion { matrix: Htm::identity(), jacobian: None }
    }

    fn workpiece_setup<S: Algebra>(&self, values: &ErrorValues) -> JointFactors<S>
    where
        L: ErrorLift<S>,
    {
        let motion = self.motion(ErrorSite::Workpiece, &values.workpiece);
        let inverse = invert_if(true, motion.matrix.clone());
        JointFactors::new(self.machine.workpiece(), [motion, self.none()], vec![FactorKind::Error(0, Some(inverse))])
    }

    fn spindle<S: Algebra>(&self, values: &ErrorValues) -> JointFactors<S>
    where
        L: ErrorLift<S>,
    {
        let motion = self.motion(ErrorSite::Location(values.axes.len()), &values.spindle.unwrap_or_default());
        JointFactors::new(self.machine.tool().gauge, [motion, self.none()], vec![FactorKind::Error(0, None)])
    }

    /// Returns the factors in the order that [`super::joint()`] multiplies them in.
    fn joint<S: Algebra>(&self, i: usize, position: f64, errors: &AxisErrorValues) -> JointFactors<S>
    where
        L: ErrorLift<S>,
    {
        let axis = &self.machine.axes()[i];
        let convention = axis.convention(self.machine.conventions());
        let location = self.motion(ErrorSite::Location(i), &errors.location);
        let component = self.motion(ErrorSite::Component(i), &errors.component);
        let nominal = nominal(axis, &JointPosition::<S>::at(axis, position));
        let inverse = |wanted: bool, motion: &FactorMotion<S>| wanted.then(|| invert_if(true, motion.matrix.clone()));
        let mut factors = match (convention.location, axis.kind) {
            (LocationAction::Factor(_), _) => vec![FactorKind::Nominal(nominal)],
            (LocationAction::Displaces, AxisKind::Linear) => vec![FactorKind::Displaced(nominal.translation)],
            (LocationAction::Displaces, AxisKind::Rotary) => {
                let back = FactorKind::Error(0, inverse(true, &location));
                vec![FactorKind::Error(0, None), FactorKind::Nominal(nominal), back]
            }
        };
        let end = |side: MotionSide, count: usize| if side == MotionSide::Outer { 0 } else { count };
        let error = FactorKind::Error(1, inverse(convention.component.inverse, &component));
        factors.insert(end(convention.component.side, factors.len()), error);
        if let LocationAction::Factor(factor) = convention.location {
            let error = FactorKind::Error(0, inverse(factor.inverse, &location));
            factors.insert(end(factor.side, factors.len()), error);
        }
        JointFactors::new(convention.pivot, [location, component], factors)
    }
}
