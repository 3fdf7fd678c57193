//! Place of a station of distance measurements, from the distances alone: the start of the fit.
//!
//! |p - s|^2 = (D + c)^2 is linear in s, c and |s|^2 - c^2 (multilateration). Poses in one plane leave both sides of
//! it possible, so that they are refused here.

use crate::algebra::linear::Triangle;
use crate::identify::thresholds::{COPLANAR_SHARE, STATION_RANK_TOLERANCE};
use nalgebra::{DVector, Vector3};

/// A distance and the nominal point it was measured to.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    pub point: Vector3<f64>,
    /// The distance (mm), or what is left of it without the unknown constant of its run.
    pub value: f64,
    /// Run whose constant is missing.
    pub run: Option<usize>,
}

/// A reason for which the place of a station cannot be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StationFailure {
    /// The file gives it two places.
    #[error("the station has two places: give it two names")]
    TwoPlaces,
    /// Nothing is measured yet.
    #[error("a plan knows its place from the file alone")]
    Planned,
    /// The number of distances, and the number that is needed.
    #[error("{0} distances do not determine its place ({1} are needed)")]
    TooFew(usize, usize),
    /// The poses do not surround a volume.
    #[error("its poses lie in a plane or on a line, so its side of them is undetermined")]
    Flat,
}

/// Returns the place of a station (mm) by multilateration.
pub fn place(sights: &[Sight]) -> Result<Vector3<f64>, StationFailure> {
    let count = sights.len().max(1) as f64;
    let centre = sights.iter().map(|s| s.point).sum::<Vector3<f64>>() / count;
    let runs = sights.iter().filter_map(|s| s.run).max().map_or(0, |last| last + 1);
    let unknowns = 3 + if runs == 0 { 1 } else { 2 * runs };
    if sights.len() < unknowns {
        return Err(StationFailure::TooFew(sights.len(), unknowns));
    }
    let mut triangle = Triangle::new(unknowns);
    for sight in sights {
        let p = sight.point - centre;
        let mut row = vec![0.0; unknowns];
        (0..3).for_each(|k| row[k] = 2.0 * p[k]);
        match sight.run {
            Some(run) => {
                row[3 + 2 * run] = 2.0 * sight.value;
                row[4 + 2 * run] = -1.0;
            }
            None => row[3] = -1.0,
        }
        triangle.push(row, p.norm_squared() - sight.value * sight.value);
    }
    let reduced = triangle.finish();
    let scale = reduced.column_norms();
    let svd = reduced.scaled(&scale);
    // A constant beside readings that hardly vary is a column like another: the threshold is not for those.
    if svd.rank(STATION_RANK_TOLERANCE) < unknowns || flat(sights, &centre) {
        return Err(StationFailure::Flat);
    }
    let scaled: DVector<f64> = svd.solve(&reduced.right, unknowns);
    Ok(centre + Vector3::from_fn(|k, _| scaled[k] / scale[k]))
}

/// True if the points lie in a plane.
fn flat(sights: &[Sight], centre: &Vector3<f64>) -> bool {
    let mut triangle = Triangle::new(3);
    for sight in sights {
        let p = sight.point - centre;
        triangle.push(p.iter().copied(), 0.0);
    }
    triangle.finish().scaled(&DVector::from_element(3, 1.0)).rank(COPLANAR_SHARE) < 3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<Vector3<f64>> {
        (0..27).map(|i| Vector3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) * 150.0).collect()
    }

    #[test]
    fn a_station_is_found_with_and_without_dead_path() {
        let station = Vector3::new(-200.0, 90.0, 350.0);
        for (path, run) in [(0.0, None), (123.0, Some(0))] {
            let sight = |p: Vector3<f64>| Sight { point: p, value: (p - station).norm() - path, run };
            let sights: Vec<Sight> = points().into_iter().map(sight).collect();
            assert!((place(&sights).unwrap() - station).norm() < 1e-8);
        }
    }

    #[test]
    fn a_plane_of_points_is_refused() {
        let flat = points().into_iter().filter(|p| p.z == 0.0);
        let sights: Vec<Sight> = flat.map(|point| Sight { point, value: 400.0 + point.x, run: None }).collect();
        assert!(place(&sights).is_err() && place(&sights[..2]).is_err());
    }
}
