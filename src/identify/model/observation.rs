//! Readings as functions of the actual geometry: the one place that knows the kinds of reading.

use crate::algebra::{Algebra, exp_hat, hat, left_jacobian};
use crate::identify::data::{
    DistanceEnd, LEVER_MM, Measurement, Reading, TurnKind, lever, rotation_to, tool_axis, turn_effects,
};
use crate::lower::{NominalPose, Source};
use crate::machine::Machine;
use nalgebra::{Matrix3, Vector3};

/// The actual geometry that a reading depends on, as a point (mm, workpiece frame).
pub(in crate::identify) enum ReadingSubject<'a> {
    /// The functional point at a pose.
    Point(&'a [f64]),
    /// The vector of the skew part of actual times inverse nominal orientation at a pose: of a small rotation its
    /// vector.
    Turn(&'a [f64]),
    /// The unit vector along the axis of the tool at a pose.
    Axis(&'a [f64]),
    /// A component error at the pose of the measurement, as the first coordinate.
    Error(Source),
}

impl<'a> ReadingSubject<'a> {
    /// Returns the pose of a subject that has one of its own.
    pub fn pose(&self) -> Option<&'a [f64]> {
        match self {
            Self::Point(pose) | Self::Turn(pose) | Self::Axis(pose) => Some(pose),
            Self::Error(_) => None,
        }
    }
}

/// A reading (mm, in its own frame) of subjects over an algebra; the first [`Measurement::reading_mask`] components
/// count.
pub(in crate::identify) struct Observation<S> {
    /// The reading.
    pub value: Vector3<S>,
    /// Its derivative by the first subject; by the second subject it is the negative of that.
    pub slope: Slope<S>,
    /// Its derivatives by unknowns of instruments, with their indices.
    pub by_unknown: Vec<(usize, Vector3<f64>)>,
}

/// The linear map from displacements of a subject to changes of a reading.
pub(in crate::identify) enum Slope<S> {
    /// All three components, in another frame (of rotations times the lever).
    Rotation(Matrix3<f64>),
    /// The component along a fixed direction.
    Along(Vector3<f64>),
    /// The component along the actual line of sight.
    Towards(Vector3<S>),
}

impl<S: Algebra> Slope<S> {
    /// Returns the change of the reading by a displacement, of which `real` is the part that counts.
    pub fn of(&self, displacement: &Vector3<S>, real: impl Fn(&S) -> f64) -> Vector3<f64> {
        match self {
            Self::Rotation(rotation) => rotation * displacement.map(|x| real(&x)),
            Self::Along(direction) => first(real(&along(direction, displacement))),
            Self::Towards(direction) => first(real(&dot(direction, displacement))),
        }
    }
}

/// Returns the reading of a measurement where `at` gives its one or two subjects and `unknowns` (mm) are those of the
/// instruments.
pub(in crate::identify) fn observe<S: Algebra>(
    machine: &Machine,
    m: &Measurement,
    unknowns: &[f64],
    mut at: impl FnMut(ReadingSubject<'_>) -> Vector3<S>,
) -> Observation<S> {
    let constant = |index: &Option<usize>| S::from_real(index.map_or(0.0, |index| unknowns[index]));
    let less_constant = |index: usize| (index, first(-1.0));
    match &m.reading {
        Reading::Deviation { frame, zero, .. } => {
            let nominal = NominalPose::in_part(machine, &m.pose);
            let rotation = rotation_to(*frame, &nominal);
            let deviation = subtract(&at(ReadingSubject::Point(&m.pose)), &nominal.pose.translation);
            Observation {
                value: rotate(&rotation, &deviation).zip_map(&Vector3::from(*zero), |x, zero| x - constant(&zero)),
                slope: Slope::Rotation(rotation),
                by_unknown: (0..3).filter_map(|k| Some((zero[k]?, -Vector3::ith(k, 1.0)))).collect(),
            }
        }
        Reading::Position { about, frame, .. } => {
            let nominal = NominalPose::in_part(machine, &m.pose).pose.translation;
            let [displacement, turn] = [0, 3].map(|k| Vector3::from_fn(|i, _| unknowns[frame + k + i]));
            let turn: [f64; 3] = turn.into();
            let rotation = exp_hat(&turn);
            let arm = rotate(&rotation, &subtract(&at(ReadingSubject::Point(&m.pose)), about));
            let by_turn = -hat(&arm.clone().map(|x| x.real() + x.nilpotent_sum()).into()) * left_jacobian(&turn);
            let by = |k: usize| if k < 3 { Vector3::ith(k, 1.0) } else { by_turn.column(k - 3).into_owned() };
            Observation {
                value: subtract(&arm, &(nominal - about - displacement)),
                slope: Slope::Rotation(rotation),
                by_unknown: (0..6).map(|k| (frame + k, by(k))).collect(),
            }
        }
        Reading::Distance { from, zero, .. } => {
            let here = at(ReadingSubject::Point(&m.pose));
            let (other, station) = match from {
                DistanceEnd::Station(index) => {
                    (Vector3::from_fn(|k, _| S::from_real(unknowns[index + k])), Some(*index))
                }
                DistanceEnd::Pose(to) => (at(ReadingSubject::Point(to)), None),
            };
            let (length, towards) = normalise(here - other);
            let pull = |k: usize| first(-(towards[k].real() + towards[k].nilpotent_sum()));
            let by_station = station.into_iter().flat_map(|index| (0..3).map(move |k| (index + k, k)));
            let by_unknown = by_station.map(|(index, k)| (index, pull(k))).chain(zero.map(less_constant)).collect();
            Observation { value: single(length - constant(zero)), slope: Slope::Towards(towards), by_unknown }
        }
        Reading::Along { direction, less, .. } => {
            let nominal = NominalPose::in_part(machine, &m.pose).pose.translation;
            let deviation = along(direction, &subtract(&at(ReadingSubject::Point(&m.pose)), &nominal));
            let added = less.iter().map(|(index, share)| share * unknowns[*index]).sum();
            Observation {
                value: single(deviation - S::from_real(added)),
                slope: Slope::Along(*direction),
                by_unknown: less.iter().map(|(index, share)| (*index, first(-share))).collect(),
            }
        }
        Reading::Turn { of, frame, turned, mounted, .. } => {
            let nominal = NominalPose::in_part(machine, &m.pose);
            let to_frame = rotation_to(*frame, &nominal) * LEVER_MM;
            let seen = match of {
                TurnKind::Axis => subtract(&at(ReadingSubject::Axis(&m.pose)), &tool_axis(machine, &nominal)),
                _ => at(ReadingSubject::Turn(&m.pose)),
            };
            let part = |indices: &[Option<usize>; 3], about: &Matrix3<f64>| {
                let (effects, indices) = (turn_effects(machine, *of, *frame, &nominal, about) * LEVER_MM, *indices);
                (0..3).filter_map(move |k| Some((indices[k]?, effects.column(k).into_owned())))
            };
            let by_frame = part(turned, &Matrix3::identity());
            let by_mount = part(mounted, &nominal.pose.linear);
            let by_unknown: Vec<(usize, Vector3<f64>)> = by_frame.chain(by_mount).collect();
            let added = by_unknown.iter().map(|(index, by)| by * unknowns[*index]).sum::<Vector3<f64>>();
            let value = subtract(&rotate(&to_frame, &seen), &-added);
            Observation { value, slope: Slope::Rotation(to_frame), by_unknown }
        }
        Reading::Error { source, .. } => {
            let direction = first(lever(source.direction));
            let value = single(along(&direction, &at(ReadingSubject::Error(*source))));
            Observation { value, slope: Slope::Along(direction), by_unknown: Vec::new() }
        }
    }
}

/// Returns a vector of one number.
pub(in crate::identify) fn single<S: Algebra>(x: S) -> Vector3<S> {
    Vector3::new(x, S::zero(), S::zero())
}

fn first(x: f64) -> Vector3<f64> {
    Vector3::new(x, 0.0, 0.0)
}

fn subtract<S: Algebra>(x: &Vector3<S>, point: &Vector3<f64>) -> Vector3<S> {
    x.zip_map(point, |x, p| x - S::from_real(p))
}

/// Turns a vector over an algebra.
pub(super) fn rotate<S: Algebra>(rotation: &Matrix3<f64>, x: &Vector3<S>) -> Vector3<S> {
    Vector3::from_fn(|i, _| (0..3).map(|j| x[j].scaled(rotation[(i, j)])).fold(S::zero(), |a, b| a + b))
}

fn along<S: Algebra>(direction: &Vector3<f64>, x: &Vector3<S>) -> S {
    (0..3).map(|k| x[k].scaled(direction[k])).fold(S::zero(), |a, b| a + b)
}

fn dot<S: Algebra>(a: &Vector3<S>, b: &Vector3<S>) -> S {
    (0..3).map(|k| a[k].clone() * b[k].clone()).fold(S::zero(), |a, b| a + b)
}

/// Returns the length and the direction of a vector; both 0 for a vector without length.
fn normalise<S: Algebra>(way: Vector3<S>) -> (S, Vector3<S>) {
    let length = dot(&way, &way).sqrt().unwrap_or_else(S::zero);
    let recip = length.recip().unwrap_or_else(S::zero);
    let unit = way.map(|x| x * recip.clone());
    (length, unit)
}
