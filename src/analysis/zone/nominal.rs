//! The nominal geometry of a feature by its points: lines, planes, and surfaces of revolution about an axis.

use crate::algebra::linear::Svd;
use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};

/// Points may be off their nominal form by this part of its size: files have few decimals.
const FORM: f64 = 1e-3;

/// Sine of the largest angle between directions that count as one.
pub(super) const ANGLE: f64 = 1e-3;

/// Least part of a normal along the radius for a deviation to be one of the radius.
const RADIAL: f64 = 0.2;

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Its place, mm.
    pub place: Vector3<f64>,
    /// Unit vector out of the material, if the file has it.
    pub normal: Option<Vector3<f64>>,
}

/// The reason why points do not carry a characteristic.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// Too few points.
    #[error("{count} of its tool poses are reached, and {needed} are needed")]
    Few {
        /// Number of points.
        count: usize,
        /// Number needed.
        needed: usize,
    },
    /// No normals, and none that follow from the points.
    #[error("its tool poses have no normals: add the columns NX, NY, NZ")]
    Normals,
    /// Normals of a plane or line that differ.
    #[error("its normals are not parallel, so it is neither a plane nor a line")]
    Turning,
    /// Points off a line.
    #[error("its points are not on a line")]
    Line,
    /// Points off a plane, or on a line.
    #[error("its points do not span a plane")]
    Plane,
    /// Points off circles about one axis.
    #[error("its points are not on circles about one axis")]
    Round,
    /// Normals that are not across the axis.
    #[error("its normals have no part along the radius")]
    Radial,
    /// A surface of revolution whose axis is unknown.
    #[error("its axis does not follow from its points: state `axis: [0, 0, 1]`, or add the columns NX, NY, NZ")]
    Axis,
    /// A radius that changes along the axis.
    #[error("it is no cylinder: its radius changes along its axis")]
    Cone,
    /// No datum where one is needed.
    #[error("it needs a datum: `datum: NAME` of another feature")]
    NoDatum,
    /// A datum that does not fit the characteristic.
    #[error("the datum does not fit: {0}")]
    Datum(&'static str),
    /// A nominal angle other than that of the characteristic.
    #[error("the nominal angle to the datum is {deg:.3} deg: state `angularity`")]
    Angle {
        /// The angle, deg.
        deg: f64,
    },
}

/// Points with their centre and their principal axes.
struct Cloud {
    centre: Vector3<f64>,
    /// Unit vectors, the longest extent first.
    axes: [Vector3<f64>; 3],
    /// Largest distance from the centre along each, mm.
    extents: [f64; 3],
}

impl Cloud {
    fn of(points: &[SurfacePoint]) -> Self {
        let centre = points.iter().map(|p| p.place).sum::<Vector3<f64>>() / points.len().max(1) as f64;
        let axes = principal(points.iter().map(|p| p.place - centre));
        let extent =
            |axis: &Vector3<f64>| points.iter().map(|p| (p.place - centre).dot(axis).abs()).fold(0.0, f64::max);
        Self { centre, extents: axes.map(|axis| extent(&axis)), axes }
    }

    fn is_line(&self) -> bool {
        self.extents[0] > 0.0 && self.extents[1] <= FORM * self.extents[0]
    }

    fn is_plane(&self) -> bool {
        self.extents[0] > 0.0 && !self.is_line() && self.extents[2] <= FORM * self.extents[0]
    }
}

/// Returns the principal axes of vectors, the longest first, each with its largest letter positive.
fn principal(vectors: impl Iterator<Item = Vector3<f64>>) -> [Vector3<f64>; 3] {
    let SymmetricEigen { eigenvectors, eigenvalues } =
        vectors.fold(Matrix3::zeros(), |sum, v| sum + v * v.transpose()).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a: &usize, b: &usize| eigenvalues[*b].total_cmp(&eigenvalues[*a]));
    order.map(|k| upright(eigenvectors.column(k).into_owned()))
}

/// Returns an axis in the sense in which its largest letter is positive.
fn upright(axis: Vector3<f64>) -> Vector3<f64> {
    let largest = (0..3).fold(0, |best, k| if axis[k].abs() > axis[best].abs() + 1e-9 { k } else { best });
    if axis[largest] < 0.0 { -axis } else { axis }
}

/// A flat feature: a plane, or a line with the normal of its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Flat {
    /// The normal.
    pub normal: Vector3<f64>,
    /// The centre of its points, mm.
    pub centre: Vector3<f64>,
    /// Directions within it, the longer extent first.
    pub within: [Vector3<f64>; 2],
    /// Half of its longer extent, mm.
    pub size: f64,
    /// True if all points are on a line.
    pub is_line: bool,
}

impl Flat {
    /// Returns the plane or line of points; without normals a plane only.
    pub fn of(points: &[SurfacePoint]) -> Result<Self, Unfit> {
        let cloud = Cloud::of(points);
        let (is_line, size) = (cloud.is_line(), cloud.extents[0]);
        let normal = match common_normal(points)? {
            Some(normal) => normal,
            None if cloud.is_plane() => cloud.axes[2],
            None if is_line => return Err(Unfit::Normals),
            None => return Err(Unfit::Plane),
        };
        if points.iter().any(|p| (p.place - cloud.centre).dot(&normal).abs() > FORM * size) {
            return Err(if is_line { Unfit::Line } else { Unfit::Plane });
        }
        let along = cloud.axes[0] - normal * normal.dot(&cloud.axes[0]);
        let along = along.try_normalize(0.0).unwrap_or(cloud.axes[0]);
        Ok(Self { normal, centre: cloud.centre, within: [along, normal.cross(&along)], size, is_line })
    }
}

/// Returns the normal that all points have, `None` where no point has one.
fn common_normal(points: &[SurfacePoint]) -> Result<Option<Vector3<f64>>, Unfit> {
    let normals: Vec<Vector3<f64>> = points.iter().filter_map(|p| p.normal).collect();
    let Some(first) = normals.first() else { return Ok(None) };
    if normals.len() < points.len() {
        return Err(Unfit::Normals);
    }
    let apart = |n: &Vector3<f64>| n.cross(first).norm() > ANGLE || n.dot(first) < 0.0;
    if normals.iter().any(apart) {
        return Err(Unfit::Turning);
    }
    Ok(normals.iter().sum::<Vector3<f64>>().try_normalize(0.0))
}

/// A surface of revolution.
#[derive(Debug, Clone, PartialEq)]
pub struct Revolution {
    /// The axis, a unit vector.
    pub axis: Vector3<f64>,
    /// Two directions across it.
    pub across: [Vector3<f64>; 2],
    /// The points, in their order.
    pub points: Vec<RoundPoint>,
    /// Half of the extent along the axis, mm; 0 for one circle.
    pub half_height: f64,
    /// The largest radius, mm.
    pub radius: f64,
}

/// A point of a surface of revolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundPoint {
    /// The direction of the deviation that counts: the normal, or else that of the radius.
    pub direction: Vector3<f64>,
    /// Its parts along the two directions across the axis.
    pub across: [f64; 2],
    /// The direction of the radius by the two directions across the axis, of length 1.
    pub radial: [f64; 2],
    /// Height along the axis from the middle, mm.
    pub height: f64,
    /// The nominal radius, mm.
    pub radius: f64,
}

impl Revolution {
    /// Returns the surface of revolution through points about an axis that is stated, or else that of the plane of the
    /// points, or of their normals.
    pub fn of(points: &[SurfacePoint], axis: Option<&Vector3<f64>>) -> Result<Self, Unfit> {
        let cloud = Cloud::of(points);
        if cloud.is_line() {
            return Err(Unfit::Round);
        }
        let axis = match axis {
            Some(axis) => *axis,
            None if cloud.is_plane() => cloud.axes[2],
            None => axis_of_normals(points)?,
        };
        let side = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let first = (side - axis * axis.dot(&side)).normalize();
        let across = [first, axis.cross(&first)];
        let heights: Vec<f64> = points.iter().map(|p| (p.place - cloud.centre).dot(&axis)).collect();
        let ends = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(*z), b.max(*z)));
        let (middle, half_height) = (0.5 * (ends.0 + ends.1), 0.5 * (ends.1 - ends.0));
        let plane: Vec<[f64; 2]> =
            points.iter().map(|p| across.map(|direction| (p.place - cloud.centre).dot(&direction))).collect();
        let circles = Circles::fit(&plane, &heights, cloud.extents[0]);
        let point = |((p, [x, y]), z): ((&SurfacePoint, &[f64; 2]), &f64)| {
            let [dx, dy] = [x - circles.centre[0], y - circles.centre[1]];
            let (radius, nominal) = (libm::hypot(dx, dy), circles.radius(*z, cloud.extents[0]));
            if !nominal.is_finite() || radius == 0.0 || (radius - nominal).abs() > FORM * radius.max(nominal) {
                return Err(Unfit::Round);
            }
            let outward = (across[0] * dx + across[1] * dy) / radius;
            let direction = p.normal.unwrap_or(outward);
            if direction.dot(&outward).abs() < RADIAL {
                return Err(Unfit::Radial);
            }
            let radial = [dx / radius, dy / radius];
            Ok(RoundPoint {
                direction,
                across: across.map(|of| of.dot(&direction)),
                radial,
                height: z - middle,
                radius,
            })
        };
        let points: Vec<RoundPoint> = points.iter().zip(&plane).zip(&heights).map(point).collect::<Result<_, _>>()?;
        let radius = points.iter().map(|p| p.radius).fold(0.0, f64::max);
        Ok(Self { axis, across, points, half_height, radius })
    }

    /// True if the radius is the same at all heights.
    pub fn is_cylinder(&self) -> bool {
        self.points.iter().all(|p| self.radius - p.radius <= FORM * self.radius)
    }

    /// Returns the points of each circle about the axis, by height.
    pub fn sections(&self) -> Vec<Vec<usize>> {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by(|a, b| self.points[*a].height.total_cmp(&self.points[*b].height).then(a.cmp(b)));
        let mut sections: Vec<Vec<usize>> = Vec::new();
        for i in order {
            match sections.last_mut() {
                Some(last) if self.points[i].height - self.points[last[0]].height <= FORM * self.radius => last.push(i),
                _ => sections.push(vec![i]),
            }
        }
        sections
    }
}

/// Returns the axis with which all normals enclose one angle.
fn axis_of_normals(points: &[SurfacePoint]) -> Result<Vector3<f64>, Unfit> {
    let normals: Vec<Vector3<f64>> = points.iter().map(|p| p.normal).collect::<Option<_>>().ok_or(Unfit::Axis)?;
    let mean = normals.iter().sum::<Vector3<f64>>() / normals.len().max(1) as f64;
    let axis = principal(normals.iter().map(|n| n - mean))[2];
    let part = mean.dot(&axis);
    if normals.iter().any(|n| (n.dot(&axis) - part).abs() > ANGLE) { Err(Unfit::Axis) } else { Ok(axis) }
}

/// Circles about one centre whose radius is linear in the height.
struct Circles {
    centre: [f64; 2],
    /// Square of the radius over the height, in units of the size: constant, linear, square.
    square: [f64; 3],
}

impl Circles {
    fn fit(plane: &[[f64; 2]], heights: &[f64], size: f64) -> Self {
        let scale = size.max(f64::MIN_POSITIVE);
        let square = |x: f64| x * x;
        let row = |i: usize, k: usize| match k {
            0 | 1 => 2.0 * plane[i][k] / scale,
            2 => 1.0,
            3 => heights[i] / scale,
            _ => square(heights[i] / scale),
        };
        let matrix = DMatrix::from_fn(plane.len(), 5, row);
        let right = DVector::from_fn(plane.len(), |i, _| square(plane[i][0] / scale) + square(plane[i][1] / scale));
        let svd = Svd::new(&matrix);
        let x = svd.solve(&right, svd.rank(FORM * FORM));
        let square = [x[2] + x[0] * x[0] + x[1] * x[1], x[3], x[4]];
        Self { centre: [x[0] * scale, x[1] * scale], square }
    }

    fn radius(&self, height: f64, size: f64) -> f64 {
        let z = height / size.max(f64::MIN_POSITIVE);
        (self.square[0] + z * (self.square[1] + z * self.square[2])).sqrt() * size
    }
}
