//! Linear axes: the place by the smallest motion from the reference, within the travel.

use super::tool_pose::{PLACE_TOLERANCE, Unreachable, tool_pose};
use crate::algebra::rotation_about;
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// What rounding may add to a position, mm: beyond the travel by less is at its end.
const ROUNDING: f64 = 1e-9;

/// Below this share of the largest eigenvalue of J J^T a direction counts as not spanned.
const RANK: f64 = 1e-12;

/// Sine of an angle below which two axes count as parallel, or one as lying in a plane.
const FLAT: f64 = 1e-6;

/// A linear axis: its index, the way the tool goes per mm (workpiece frame), its room in both senses.
#[derive(Debug, Clone)]
struct Slide {
    axis: usize,
    way: Vector3<f64>,
    room: (f64, f64),
    /// How far it goes from its reference; given once it has come to an end of its travel.
    ended: Option<f64>,
}

/// The candidate with its linear axes where they bring the tip to the place.
pub fn complete(
    machine: &Machine,
    tip: &Vector3<f64>,
    candidate: Pose,
    reference: &[f64],
) -> Result<Pose, Unreachable> {
    let mut pose = candidate;
    let slides = slides(machine.axes(), &pose, reference);
    slides.iter().for_each(|s| pose[s.axis] = reference[s.axis]);
    let wanted = tip - tool_pose(machine, &pose).tip;
    for (slide, motion) in slides.iter().zip(motions(slides.clone(), &wanted)?) {
        let (min, max) = slide.room;
        pose[slide.axis] = match machine.axes()[slide.axis].travel {
            // The ends themselves, not reference plus room.
            Travel::Range(_, end) if motion >= max => end,
            Travel::Range(end, _) if motion <= min => end,
            _ => reference[slide.axis] + motion,
        };
    }
    Ok(pose)
}

/// Unit normal of the plane that the linear axes span at a pose, its sense that of the first two that span it; none if they span a
/// line, or space.
pub fn normal(axes: &[Axis], pose: &[f64]) -> Option<Vector3<f64>> {
    let ways: Vec<Vector3<f64>> = slides(axes, pose, pose).into_iter().map(|slide| slide.way).collect();
    let pairs = ways.iter().enumerate().flat_map(|(i, a)| ways[i + 1..].iter().map(move |b| a.cross(b)));
    let normal = pairs.into_iter().find(|n| n.norm() > FLAT)?.normalize();
    ways.iter().all(|way| way.dot(&normal).abs() < FLAT).then_some(normal)
}

/// Every linear axis at the rotary positions of the pose.
fn slides(axes: &[Axis], pose: &[f64], reference: &[f64]) -> Vec<Slide> {
    let mut turned = Matrix3::identity();
    let mut slides = Vec::new();
    for (i, axis) in axes.iter().enumerate() {
        match axis.kind {
            AxisKind::Rotary => turned *= rotation_about(&axis.direction, sin_cos_degrees(axis.sign() * pose[i])),
            AxisKind::Linear => {
                let (min, max) = match axis.travel {
                    Travel::Range(min, max) => (min - reference[i], max - reference[i]),
                    Travel::Continuous => (f64::NEG_INFINITY, f64::INFINITY),
                };
                let way = turned * Vector3::from(axis.direction) * axis.sign();
                slides.push(Slide { axis: i, way, room: (min, max), ended: None });
            }
        }
    }
    slides
}

/// Motions from the reference: smallest first without ends; then, one by one, the axis that is
/// furthest beyond its travel is held at its end.
fn motions(mut slides: Vec<Slide>, wanted: &Vector3<f64>) -> Result<Vec<f64>, Unreachable> {
    let mut failure = Unreachable::Place;
    loop {
        let motions = smallest(&slides, wanted).ok_or(failure)?;
        failure = Unreachable::Travel;
        let excess = |(slide, motion): (&Slide, &f64)| (slide.room.0 - motion).max(motion - slide.room.1);
        let excesses: Vec<f64> = slides.iter().zip(&motions).map(excess).collect();
        let worst = (0..slides.len()).max_by(|a, b| excesses[*a].total_cmp(&excesses[*b]));
        let Some(worst) = worst.filter(|i| excesses[*i] > ROUNDING) else { return Ok(motions) };
        if slides[worst].ended.is_some() {
            return Err(Unreachable::Travel);
        }
        slides[worst].ended = Some(motions[worst].clamp(slides[worst].room.0, slides[worst].room.1));
    }
}

/// Least squares of least length over the axes that are not at an end; `None` if it does not get there.
fn smallest(slides: &[Slide], wanted: &Vector3<f64>) -> Option<Vec<f64>> {
    let free = |s: &&Slide| s.ended.is_none();
    let gram = slides.iter().filter(free).fold(Matrix3::zeros(), |sum, s| sum + s.way * s.way.transpose());
    let inverse = pseudo_inverse(&gram);
    let mut motions: Vec<f64> = slides.iter().map(|s| s.ended.unwrap_or(0.0)).collect();
    // The second and third time take back what rounding has left.
    for _ in 0..3 {
        let pull = inverse * missing(slides, &motions, wanted);
        let of_free = slides.iter().zip(&mut motions).filter(|(s, _)| s.ended.is_none());
        of_free.for_each(|(s, motion)| *motion += s.way.dot(&pull));
    }
    (missing(slides, &motions, wanted).norm() <= PLACE_TOLERANCE).then_some(motions)
}

fn missing(slides: &[Slide], motions: &[f64], wanted: &Vector3<f64>) -> Vector3<f64> {
    slides.iter().zip(motions).fold(*wanted, |rest, (s, motion)| rest - s.way * *motion)
}

/// Pseudo-inverse of a symmetric, positive semidefinite matrix from its eigenvectors.
fn pseudo_inverse(gram: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = gram.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    (0..3).filter(|i| eigen.eigenvalues[*i] > RANK * largest).fold(Matrix3::zeros(), |sum, i| {
        let v = eigen.eigenvectors.column(i);
        sum + v * v.transpose() / eigen.eigenvalues[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slide(way: [f64; 3], room: (f64, f64)) -> Slide {
        Slide { axis: 0, way: way.into(), room, ended: None }
    }

    #[test]
    fn parallel_axes_share_the_way_until_one_ends() {
        let free = vec![slide([0.0, 0.0, 1.0], (-100.0, 100.0)), slide([0.0, 0.0, 1.0], (-20.0, 20.0))];
        let short = motions(free.clone(), &Vector3::new(0.0, 0.0, 30.0)).unwrap();
        assert!((short[0] - 15.0).abs() < 1e-12 && (short[1] - 15.0).abs() < 1e-12);
        let long = motions(free.clone(), &Vector3::new(0.0, 0.0, 90.0)).unwrap();
        assert!((long[0] - 70.0).abs() < 1e-12 && long[1] == 20.0);
        assert_eq!(motions(free.clone(), &Vector3::new(0.0, 0.0, 130.0)), Err(Unreachable::Travel));
        assert_eq!(motions(free, &Vector3::new(1.0, 0.0, 0.0)), Err(Unreachable::Place));
    }

    #[test]
    fn the_pseudo_inverse_is_right_on_every_rank() {
        for n in 0..6_u32 {
            let way = |k: u32| {
                let t = f64::from(7 * k + 1);
                Vector3::new(libm::sin(t), libm::cos(2.0 * t), libm::sin(3.0 * t)).normalize()
            };
            let gram = (0..n.min(4) / 2 + n % 2).map(way).fold(Matrix3::zeros(), |sum, w| sum + w * w.transpose());
            let inverse = pseudo_inverse(&gram);
            assert!((gram * inverse * gram - gram).amax() < 1e-12, "{n}");
            assert!((inverse * gram * inverse - inverse).amax() < 1e-10 * inverse.amax().max(1.0), "{n}");
        }
    }
}
