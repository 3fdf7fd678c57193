//! The profile of a round feature over the angle about its axis, as a tester of roundness would draw it.

use super::minimax::MinimaxFit;
use super::nominal::{Revolution, SurfacePoint, Unfit};
use nalgebra::Vector3;

/// A surface of revolution whose circles are looked at one by one.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundSurface {
    of: Revolution,
    /// The sections with their fits, by height.
    sections: Vec<(Vec<usize>, MinimaxFit)>,
}

/// The profile of a section.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundProfile {
    /// Height of the section along the axis from the middle of the surface, mm.
    pub height: f64,
    /// Its nominal radius, mm.
    pub radius: f64,
    /// Its points by angle.
    pub points: Vec<ProfilePoint>,
    /// Largest minus smallest distance from the least-squares circle, mm.
    pub least_squares: f64,
    /// Width of the narrowest zone between two circles about one centre, mm.
    pub minimum_zone: f64,
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Angle from the first direction across the axis towards the second, 0 to 360 deg.
    pub angle_deg: f64,
    /// Deviation along the normal, away from the axis, mm.
    pub deviation: f64,
    /// The same of the least-squares circle, mm.
    pub circle: f64,
}

/// Least number of points of a section: a circle has three unknowns.
const MIN_POINTS: usize = 8;

impl RoundSurface {
    /// Returns the surface through points about an axis that is stated, or else the one that follows from them.
    pub fn new(points: &[SurfacePoint], axis: Option<&Vector3<f64>>) -> Result<Self, Unfit> {
        let few = |count: usize| Unfit::Few { count, needed: MIN_POINTS };
        if points.len() < MIN_POINTS {
            return Err(few(points.len()));
        }
        let of = Revolution::of(points, axis)?;
        let section = |rows: Vec<usize>| {
            let across = |k: usize| rows.iter().map(|i| of.points[*i].across[k]).collect();
            let fit = MinimaxFit::new(rows.len(), &[vec![1.0; rows.len()], across(0), across(1)]);
            (rows, fit)
        };
        let sections = of.sections().into_iter().filter(|rows| rows.len() >= MIN_POINTS);
        let sections: Vec<(Vec<usize>, MinimaxFit)> = sections.map(section).collect();
        if sections.is_empty() { Err(few(0)) } else { Ok(Self { of, sections }) }
    }

    /// Returns the two directions across the axis: angles count from the first towards the second.
    pub fn across(&self) -> [Vector3<f64>; 2] {
        self.of.across
    }

    /// Returns the profile of the section with the widest minimum zone, by the deviations (mm) at all points.
    pub fn widest(&self, deviations: &[Vector3<f64>]) -> Option<RoundProfile> {
        let profile = |(rows, fit): &(Vec<usize>, MinimaxFit)| self.profile(rows, fit, deviations);
        // Of equal ones the first.
        self.sections.iter().rev().map(profile).max_by(|a, b| a.minimum_zone.total_cmp(&b.minimum_zone))
    }

    fn profile(&self, rows: &[usize], fit: &MinimaxFit, deviations: &[Vector3<f64>]) -> RoundProfile {
        let points = || rows.iter().map(|i| (&self.of.points[*i], &deviations[*i]));
        let along: Vec<f64> = points().map(|(point, d)| point.direction.dot(d)).collect();
        let residuals = fit.least_squares(&along);
        let (low, high) = residuals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), r| (a.min(*r), b.max(*r)));
        let point = |((point, _), (along, residual)): ((&_, &_), (&f64, &f64))| {
            let point: &super::nominal::RoundPoint = point;
            let [x, y] = point.radial;
            // Of a bore the normal points to the axis.
            let sign = if point.across[0] * x + point.across[1] * y < 0.0 { -1.0 } else { 1.0 };
            let angle_deg = libm::atan2(y, x).to_degrees().rem_euclid(360.0);
            ProfilePoint { angle_deg, deviation: sign * along, circle: sign * (along - residual) }
        };
        let mut list: Vec<ProfilePoint> = points().zip(along.iter().zip(&residuals)).map(point).collect();
        list.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg));
        let count = rows.len().max(1) as f64;
        let mean = |of: fn(&super::nominal::RoundPoint) -> f64| points().map(|(p, _)| of(p)).sum::<f64>() / count;
        RoundProfile {
            height: mean(|point| point.height),
            radius: mean(|point| point.radius),
            points: list,
            least_squares: high - low,
            minimum_zone: 2.0 * fit.fit(&along).half_width,
        }
    }
}
