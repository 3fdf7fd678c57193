//! Linear axes: the place by the smallest motion from the reference, within the travel.

use super::tool_pose::{Miss, PLACE_TOLERANCE, unturned_tool_pose};
use crate::algebra::rotation_about;
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// Rounding of a position, mm: a position beyond the travel by less counts as its end.
const ROUNDING_MM: f64 = 1e-9;

/// A direction whose eigenvalue of J J^T is below this fraction of the largest is not spanned.
const RANK_TOLERANCE: f64 = 1e-12;

/// A linear axis at rotary positions.
#[derive(Debug, Clone)]
pub struct LinearSlide {
    /// Index of the axis.
    pub axis: usize,
    /// Motion of the tool per mm, unturned workpiece frame.
    pub direction: Vector3<f64>,
    /// Travel from the reference in both senses, mm.
    pub range: (f64, f64),
    /// Motion from the reference (mm) once the axis has come to an end of its travel.
    pub end: Option<f64>,
}

impl LinearSlide {
    /// Returns the position (mm) after a motion from the reference (mm).
    fn position(&self, machine: &Machine, reference: &[f64], motion: f64) -> f64 {
        let (min, max) = self.range;
        let beyond = |by: f64| (0.0..=ROUNDING_MM).contains(&by);
        match machine.axes()[self.axis].travel {
            // The ends themselves, not reference plus range.
            Travel::Range(_, end) if beyond(motion - max) => end,
            Travel::Range(end, _) if beyond(min - motion) => end,
            _ => reference[self.axis] + motion,
        }
    }
}

/// Returns the candidate with the positions of its linear axes that bring the tip to a place (mm, unturned workpiece
/// frame), nearest to the reference.
pub fn complete(machine: &Machine, tip: &Vector3<f64>, candidate: Pose, reference: &[f64]) -> Result<Pose, Miss> {
    let mut pose = candidate;
    let slides = slides(machine.axes(), &pose, reference);
    slides.iter().for_each(|s| pose[s.axis] = reference[s.axis]);
    let wanted = tip - unturned_tool_pose(machine, &pose).tip;
    let found = match motions(slides.clone(), &wanted) {
        Ok(found) => found,
        Err(LinearFailure::Place(off)) => return Err(Miss::place(off)),
        Err(LinearFailure::Travel(beyond)) => {
            slides.iter().zip(beyond).for_each(|(s, motion)| pose[s.axis] = s.position(machine, reference, motion));
            return Err(Miss::travel(pose));
        }
    };
    slides.iter().zip(found).for_each(|(s, motion)| pose[s.axis] = s.position(machine, reference, motion));
    Ok(pose)
}

/// Returns every linear axis at the rotary positions of the pose.
pub fn slides(axes: &[Axis], pose: &[f64], reference: &[f64]) -> Vec<LinearSlide> {
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
                let direction = turned * Vector3::from(axis.direction) * axis.sign();
                slides.push(LinearSlide { axis: i, direction, range: (min, max), end: None });
            }
        }
    }
    slides
}

/// The reason why the linear axes do not bring the tip to a place.
#[derive(Debug, PartialEq)]
enum LinearFailure {
    /// They do not span it, by so many mm.
    Place(f64),
    /// The motions from the reference (mm) that bring it there, beyond the travel.
    Travel(Vec<f64>),
}

/// Returns the smallest motions from the reference; one by one, the axis that is furthest beyond its travel is held at
/// its end. If that fails, the motions are those before the last axis was held: it is the one that falls short.
fn motions(mut slides: Vec<LinearSlide>, wanted: &Vector3<f64>) -> Result<Vec<f64>, LinearFailure> {
    let mut beyond: Option<Vec<f64>> = None;
    loop {
        let motions = match (smallest(&slides, wanted), beyond) {
            (Ok(motions), _) => motions,
            (Err(_), Some(beyond)) => return Err(LinearFailure::Travel(beyond)),
            (Err(off), None) => return Err(LinearFailure::Place(off)),
        };
        let excess = |(slide, motion): (&LinearSlide, &f64)| (slide.range.0 - motion).max(motion - slide.range.1);
        let excesses: Vec<f64> = slides.iter().zip(&motions).map(excess).collect();
        let worst = (0..slides.len()).max_by(|a, b| excesses[*a].total_cmp(&excesses[*b]));
        let Some(worst) = worst.filter(|i| excesses[*i] > ROUNDING_MM) else { return Ok(motions) };
        if slides[worst].end.is_some() {
            return Err(LinearFailure::Travel(motions));
        }
        slides[worst].end = Some(motions[worst].clamp(slides[worst].range.0, slides[worst].range.1));
        beyond = Some(motions);
    }
}

/// Returns the least-squares solution of minimum length over the axes that are not at an end; if it misses the place,
/// by how much (mm).
fn smallest(slides: &[LinearSlide], wanted: &Vector3<f64>) -> Result<Vec<f64>, f64> {
    let free = |s: &&LinearSlide| s.end.is_none();
    let gram = slides.iter().filter(free).fold(Matrix3::zeros(), |sum, s| sum + s.direction * s.direction.transpose());
    let inverse = pseudo_inverse(&gram);
    let mut motions: Vec<f64> = slides.iter().map(|s| s.end.unwrap_or(0.0)).collect();
    // The second and third round remove the rounding of the first.
    for _ in 0..3 {
        let pull = inverse * missing(slides, &motions, wanted);
        let of_free = slides.iter().zip(&mut motions).filter(|(s, _)| s.end.is_none());
        of_free.for_each(|(s, motion)| *motion += s.direction.dot(&pull));
    }
    let off = missing(slides, &motions, wanted).norm();
    if off <= PLACE_TOLERANCE { Ok(motions) } else { Err(off) }
}

/// Returns the remaining distance.
fn missing(slides: &[LinearSlide], motions: &[f64], wanted: &Vector3<f64>) -> Vector3<f64> {
    slides.iter().zip(motions).fold(*wanted, |rest, (s, motion)| rest - s.direction * *motion)
}

/// Returns the pseudo-inverse of a symmetric, positive semidefinite matrix from its eigenvectors.
fn pseudo_inverse(gram: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = gram.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    (0..3).filter(|i| eigen.eigenvalues[*i] > RANK_TOLERANCE * largest).fold(Matrix3::zeros(), |sum, i| {
        let v = eigen.eigenvectors.column(i);
        sum + v * v.transpose() / eigen.eigenvalues[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slide(way: [f64; 3], room: (f64, f64)) -> LinearSlide {
        LinearSlide { axis: 0, direction: way.into(), range: room, end: None }
    }

    #[test]
    fn parallel_axes_share_the_way_until_one_ends() {
        let free = vec![slide([0.0, 0.0, 1.0], (-100.0, 100.0)), slide([0.0, 0.0, 1.0], (-20.0, 20.0))];
        let short = motions(free.clone(), &Vector3::new(0.0, 0.0, 30.0)).unwrap();
        assert!((short[0] - 15.0).abs() < 1e-12 && (short[1] - 15.0).abs() < 1e-12);
        let long = motions(free.clone(), &Vector3::new(0.0, 0.0, 90.0)).unwrap();
        assert!((long[0] - 70.0).abs() < 1e-12 && long[1] == 20.0);
        // The second is at its end; the first falls short by 10 mm.
        let Err(LinearFailure::Travel(beyond)) = motions(free.clone(), &Vector3::new(0.0, 0.0, 130.0)) else {
            panic!()
        };
        assert!((beyond[0] - 110.0).abs() < 1e-12 && beyond[1] == 20.0, "{beyond:?}");
        assert_eq!(motions(free, &Vector3::new(1.0, 0.0, 0.0)), Err(LinearFailure::Place(1.0)));
    }

    #[test]
    fn every_axis_that_falls_short_is_told() {
        let axes = vec![slide([1.0, 0.0, 0.0], (0.0, 10.0)), slide([0.0, 1.0, 0.0], (0.0, 10.0))];
        assert_eq!(motions(axes, &Vector3::new(17.0, -3.0, 0.0)), Err(LinearFailure::Travel(vec![17.0, -3.0])));
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
