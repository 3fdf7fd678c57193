//! A geometrical characteristic of a feature as a function of the deviations at its points.
//!
//! At each point counts e, the deviation along the normal; without normals that of a plane, or along the radius.
//! A datum takes its own motion out of e, linearly. What is left is fitted by the motions that the characteristic
//! leaves free: the width of the narrowest zone (a linear program), or that of the residuals of least squares.
//! All of it is of first order and positively homogeneous, so the parts of errors sum up to the value.

use super::minimax::MinimaxFit;
use super::nominal::{ANGLE, Flat, Revolution, SurfacePoint, Unfit};
use crate::algebra::linear::{Svd, beside};
use nalgebra::{DMatrix, DVector, Vector3};

/// A singular value below this part of the size of a datum is no rotation that the datum holds.
const HELD: f64 = 1e-4;

/// A geometrical characteristic (ISO 1101).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CharacteristicKind {
    /// Distance of two parallel lines about a line of a surface.
    Straightness,
    /// Distance of two parallel planes.
    Flatness,
    /// Distance of two circles about the axis, along the normal, in the section where it is largest.
    Roundness,
    /// Difference of the radii of two coaxial cylinders.
    Cylindricity,
    /// Width of a zone along the surface, symmetrical about its nominal form.
    Profile,
    /// Width or diameter of a zone about the nominal place of a plane, or of the axis of a circle or cylinder.
    Position,
    /// Distance of two planes or lines that are parallel to a datum.
    Parallelism,
    /// Distance of two planes or lines that are perpendicular to a datum.
    Perpendicularity,
    /// Distance of two planes or lines at the nominal angle to a datum.
    Angularity,
}

impl CharacteristicKind {
    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straightness => "straightness",
            Self::Flatness => "flatness",
            Self::Roundness => "roundness",
            Self::Cylindricity => "cylindricity",
            Self::Profile => "profile",
            Self::Position => "position",
            Self::Parallelism => "parallelism",
            Self::Perpendicularity => "perpendicularity",
            Self::Angularity => "angularity",
        }
    }

    /// True if it is an angle to a datum.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Parallelism | Self::Perpendicularity | Self::Angularity)
    }
}

/// The fit by which a zone is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ZoneFit {
    /// The narrowest zone.
    #[default]
    MinimumZone,
    /// The zone about the least-squares feature.
    LeastSquares,
}

/// The request for a characteristic.
#[derive(Debug, Clone, Copy)]
pub struct CharacteristicRequest<'a> {
    /// The characteristic.
    pub kind: CharacteristicKind,
    /// The points of the feature.
    pub points: &'a [SurfacePoint],
    /// The points of the datum feature.
    pub datum: Option<&'a [SurfacePoint]>,
    /// The axis of a surface of revolution, a unit vector, where it is stated.
    pub axis: Option<&'a Vector3<f64>>,
    /// True if a profile is fitted onto its nominal form by a rigid motion first.
    pub free: bool,
    /// The fit by which it is judged.
    pub fit: ZoneFit,
}

/// The widths of the zones of a characteristic, in the unit of the deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZoneWidths {
    /// The value that a tolerance limits.
    pub value: f64,
    /// The narrowest zone; `None` where nothing is fitted.
    pub minimum_zone: Option<f64>,
    /// The zone about the least-squares feature; `None` where nothing is fitted.
    pub least_squares: Option<f64>,
}

/// The derivative of a characteristic by the deviation at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointWeight {
    /// Index of the point in the feature, or in the datum.
    pub point: usize,
    /// True if the point is of the datum.
    pub of_datum: bool,
    /// The derivative, by the deviation as a vector.
    pub weight: Vector3<f64>,
}

/// A characteristic of a feature.
#[derive(Debug, Clone, PartialEq)]
pub struct Characteristic {
    directions: Vec<Vector3<f64>>,
    datum: Option<DatumMotion>,
    measure: Measure,
    fit: ZoneFit,
}

/// The motion of a datum by the deviations at its points, and its effect on the feature.
#[derive(Debug, Clone, PartialEq)]
struct DatumMotion {
    directions: Vec<Vector3<f64>>,
    /// Motion by the deviations of the datum: one row for each of its parameters.
    motion: DMatrix<f64>,
    /// Deviation of the feature by that motion: one row for each of its points.
    effect: DMatrix<f64>,
}

#[derive(Debug, Clone, PartialEq)]
enum Measure {
    /// The widest of zones.
    Zones(Vec<Zone>),
    /// Twice the longest of vectors in the plane: the centre of a circle, or the ends of an axis, by the deviations.
    Centres(Vec<[Vec<f64>; 2]>),
}

#[derive(Debug, Clone, PartialEq)]
struct Zone {
    /// The points that it holds.
    rows: Vec<usize>,
    fit: MinimaxFit,
    /// True if the zone may lie anywhere along the normals, false if it is symmetrical about the fitted form.
    shifts: bool,
}

/// The motions and sizes that a fit leaves free: columns by point.
type Columns = Vec<Vec<f64>>;

impl Characteristic {
    /// Returns a characteristic of a feature, or why its points do not carry it.
    pub fn new(request: CharacteristicRequest<'_>) -> Result<Self, Unfit> {
        let CharacteristicRequest { kind, points, datum, axis, free, fit } = request;
        enough(points, 2)?;
        let judged =
            |(directions, measure): (Vec<Vector3<f64>>, Measure)| Self { directions, datum: None, measure, fit };
        match kind {
            CharacteristicKind::Straightness => flat(points, true).map(judged),
            CharacteristicKind::Flatness => flat(points, false).map(judged),
            CharacteristicKind::Roundness => roundness(points, axis).map(judged),
            CharacteristicKind::Cylindricity => cylindricity(points, axis).map(judged),
            CharacteristicKind::Profile => profile(points, free).map(judged),
            CharacteristicKind::Position => position(points, datum, axis, fit),
            _ => angle(kind, points, datum.ok_or(Unfit::NoDatum)?, axis, fit),
        }
    }

    /// Returns the zones of deviations at the points of the feature and of its datum.
    pub fn widths(&self, feature: &[Vector3<f64>], datum: &[Vector3<f64>]) -> ZoneWidths {
        let left = self.left(feature, datum);
        if !self.is_fitted() {
            return ZoneWidths {
                value: self.width(ZoneFit::MinimumZone, &left),
                minimum_zone: None,
                least_squares: None,
            };
        }
        let [narrowest, least_squares] =
            [ZoneFit::MinimumZone, ZoneFit::LeastSquares].map(|fit| self.width(fit, &left));
        let value = if self.fit == ZoneFit::MinimumZone { narrowest } else { least_squares };
        ZoneWidths { value, minimum_zone: Some(narrowest), least_squares: Some(least_squares) }
    }

    /// Returns the value that a tolerance limits, by deviations at the points of the feature and of its datum.
    pub fn value(&self, feature: &[Vector3<f64>], datum: &[Vector3<f64>]) -> f64 {
        let fit = if self.is_fitted() { self.fit } else { ZoneFit::MinimumZone };
        self.width(fit, &self.left(feature, datum))
    }

    /// True if a motion or size is fitted, so that the two fits differ.
    fn is_fitted(&self) -> bool {
        matches!(&self.measure, Measure::Zones(zones) if zones.iter().any(|zone| zone.fit.rank() > 0))
    }

    fn width(&self, fit: ZoneFit, left: &[f64]) -> f64 {
        match &self.measure {
            Measure::Zones(zones) => zones.iter().map(|zone| zone.width(fit, left)).fold(0.0, f64::max),
            Measure::Centres(centres) => {
                centres.iter().map(|centre| 2.0 * length(moved(centre, left))).fold(0.0, f64::max)
            }
        }
    }

    /// Returns the derivatives of the value by the deviations that hold it: their products with the deviations sum up
    /// to the value.
    pub fn weights(&self, feature: &[Vector3<f64>], datum: &[Vector3<f64>]) -> Vec<PointWeight> {
        let left = self.left(feature, datum);
        let mut scalars = vec![0.0; self.directions.len()];
        match &self.measure {
            Measure::Zones(zones) => {
                if let Some(zone) = widest(zones, |zone| zone.width(self.fit, &left)) {
                    zone.add_weights(&left, self.fit, &mut scalars);
                }
            }
            Measure::Centres(centres) => {
                let longest = widest(centres, |centre| length(moved(centre, &left)));
                if let Some((centre, [x, y])) = longest.map(|centre| (centre, moved(centre, &left))) {
                    let size = length([x, y]).max(f64::MIN_POSITIVE);
                    let parts = centre[0].iter().zip(&centre[1]).map(|(a, b)| 2.0 * (a * x + b * y) / size);
                    scalars.iter_mut().zip(parts).for_each(|(scalar, part)| *scalar = part);
                }
            }
        }
        let own = scalars.iter().zip(&self.directions).enumerate();
        let own =
            own.map(|(point, (scalar, direction))| PointWeight { point, of_datum: false, weight: direction * *scalar });
        let of_datum = self.datum.iter().flat_map(|link| {
            let by_motion = -(link.effect.tr_mul(&DVector::from_column_slice(&scalars)));
            let by_row = link.motion.tr_mul(&by_motion);
            let weight = |(point, direction): (usize, &Vector3<f64>)| PointWeight {
                point,
                of_datum: true,
                weight: direction * by_row[point],
            };
            link.directions.iter().enumerate().map(weight).collect::<Vec<_>>()
        });
        own.chain(of_datum).filter(|of| of.weight != Vector3::zeros()).collect()
    }

    /// Returns the deviation of each point along its direction, without the motion of the datum.
    fn left(&self, feature: &[Vector3<f64>], datum: &[Vector3<f64>]) -> Vec<f64> {
        let along = |directions: &[Vector3<f64>], deviations: &[Vector3<f64>]| -> Vec<f64> {
            directions.iter().zip(deviations).map(|(direction, d)| direction.dot(d)).collect()
        };
        let mut left = along(&self.directions, feature);
        if let Some(link) = &self.datum {
            let motion = &link.motion * DVector::from_vec(along(&link.directions, datum));
            let effect = &link.effect * motion;
            left.iter_mut().zip(effect.iter()).for_each(|(e, effect)| *e -= effect);
        }
        left
    }
}

/// Returns the first of the elements with the largest value.
fn widest<T>(list: &[T], value: impl Fn(&T) -> f64) -> Option<&T> {
    let valued = list.iter().rev().map(|of| (value(of), of));
    valued.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, of)| of)
}

fn moved(centre: &[Vec<f64>; 2], deviations: &[f64]) -> [f64; 2] {
    [0, 1].map(|k| centre[k].iter().zip(deviations).map(|(a, e)| a * e).sum())
}

fn length([x, y]: [f64; 2]) -> f64 {
    libm::hypot(x, y)
}

impl Zone {
    /// A zone that holds some points, with columns over all points of the feature.
    fn new(rows: Vec<usize>, columns: &Columns, shifts: bool) -> Self {
        let columns: Columns = columns.iter().map(|column| rows.iter().map(|i| column[*i]).collect()).collect();
        Self { fit: MinimaxFit::new(rows.len(), &columns), rows, shifts }
    }

    fn values(&self, deviations: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|i| deviations[*i]).collect()
    }

    fn width(&self, fit: ZoneFit, deviations: &[f64]) -> f64 {
        let values = self.values(deviations);
        if fit == ZoneFit::MinimumZone {
            return 2.0 * self.fit.fit(&values).half_width;
        }
        let residuals = self.fit.least_squares(&values);
        let ends = residuals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), r| (a.min(*r), b.max(*r)));
        if self.shifts { ends.1 - ends.0 } else { 2.0 * ends.1.max(-ends.0) }
    }

    /// Adds the derivatives of the width by the deviations.
    fn add_weights(&self, deviations: &[f64], fit: ZoneFit, scalars: &mut [f64]) {
        let values = self.values(deviations);
        if fit == ZoneFit::MinimumZone {
            self.fit.fit(&values).weights.iter().for_each(|(k, weight)| scalars[self.rows[*k]] += 2.0 * weight);
            return;
        }
        let residuals = self.fit.least_squares(&values);
        let signs: &[f64] = if self.shifts { &[1.0, -1.0] } else { &[1.0] };
        let mut ends = vec![0.0; values.len()];
        for sign in signs {
            let size = |k: &usize| if self.shifts { sign * residuals[*k] } else { residuals[*k].abs() };
            let Some(k) = (0..values.len()).rev().max_by(|a, b| size(a).total_cmp(&size(b))) else { continue };
            ends[k] += if self.shifts { *sign } else { 2.0 * residuals[k].signum() };
        }
        // The projection onto the residuals is symmetrical.
        let weights = self.fit.least_squares(&ends);
        self.rows.iter().zip(weights).for_each(|(row, weight)| scalars[*row] += weight);
    }
}

fn enough(points: &[SurfacePoint], needed: usize) -> Result<(), Unfit> {
    if points.len() < needed { Err(Unfit::Few { count: points.len(), needed }) } else { Ok(()) }
}

fn all(points: &[SurfacePoint]) -> Vec<usize> {
    (0..points.len()).collect()
}

/// Directions of a flat feature, and its zone of straightness or flatness.
fn flat(points: &[SurfacePoint], line: bool) -> Result<(Vec<Vector3<f64>>, Measure), Unfit> {
    enough(points, if line { 3 } else { 4 })?;
    let flat = Flat::of(points)?;
    match (line, flat.is_line) {
        (true, false) => return Err(Unfit::Line),
        (false, true) => return Err(Unfit::Plane),
        _ => {}
    }
    let place = |direction: &Vector3<f64>| -> Vec<f64> {
        points.iter().map(|p| (p.place - flat.centre).dot(direction) / flat.size).collect()
    };
    let mut columns = vec![vec![1.0; points.len()], place(&flat.within[0])];
    columns.extend((!line).then(|| place(&flat.within[1])));
    let directions = points.iter().map(|p| p.normal.unwrap_or(flat.normal)).collect();
    Ok((directions, Measure::Zones(vec![Zone::new(all(points), &columns, true)])))
}

/// Columns of circles and cylinders: radius, place across the axis, and with a height the tilt of the axis.
fn round_columns(of: &Revolution) -> Columns {
    let column = |value: &dyn Fn(usize) -> f64| (0..of.points.len()).map(value).collect::<Vec<f64>>();
    let mut columns = vec![column(&|_| 1.0), column(&|i| of.points[i].across[0]), column(&|i| of.points[i].across[1])];
    if of.sections().len() > 1 {
        for k in 0..2 {
            columns.push(column(&|i| of.points[i].height / of.half_height * of.points[i].across[k]));
        }
    }
    columns
}

fn round_directions(of: &Revolution) -> Vec<Vector3<f64>> {
    of.points.iter().map(|p| p.direction).collect()
}

fn roundness(points: &[SurfacePoint], axis: Option<&Vector3<f64>>) -> Result<(Vec<Vector3<f64>>, Measure), Unfit> {
    enough(points, 4)?;
    let of = Revolution::of(points, axis)?;
    let columns = &round_columns(&of)[..3];
    let zones = of.sections().into_iter().map(|rows| Zone::new(rows, &columns.to_vec(), true)).collect();
    Ok((round_directions(&of), Measure::Zones(zones)))
}

fn cylindricity(points: &[SurfacePoint], axis: Option<&Vector3<f64>>) -> Result<(Vec<Vector3<f64>>, Measure), Unfit> {
    enough(points, 6)?;
    let of = Revolution::of(points, axis)?;
    if !of.is_cylinder() {
        return Err(Unfit::Cone);
    }
    let zone = Zone::new(all(points), &round_columns(&of), true);
    Ok((round_directions(&of), Measure::Zones(vec![zone])))
}

fn profile(points: &[SurfacePoint], free: bool) -> Result<(Vec<Vector3<f64>>, Measure), Unfit> {
    let directions = normals(points)?;
    let centre = points.iter().map(|p| p.place).sum::<Vector3<f64>>() / points.len() as f64;
    let size = points.iter().map(|p| (p.place - centre).norm()).fold(f64::MIN_POSITIVE, f64::max);
    let motion = |k: usize| -> Vec<f64> {
        let turn = |(p, n): (&SurfacePoint, &Vector3<f64>)| ((p.place - centre) / size).cross(n)[k % 3];
        if k < 3 {
            directions.iter().map(|n| n[k]).collect()
        } else {
            points.iter().zip(&directions).map(turn).collect()
        }
    };
    let columns: Columns = if free { (0..6).map(motion).collect() } else { Vec::new() };
    let zone = Zone::new(all(points), &columns, false);
    Ok((directions, Measure::Zones(vec![zone])))
}

/// Normals of a surface: those of the file, or that of the plane through the points.
fn normals(points: &[SurfacePoint]) -> Result<Vec<Vector3<f64>>, Unfit> {
    let given: Option<Vec<Vector3<f64>>> = points.iter().map(|p| p.normal).collect();
    if let Some(given) = given {
        return Ok(given);
    }
    let flat = Flat::of(points).map_err(|_| Unfit::Normals)?;
    Ok(vec![flat.normal; points.len()])
}

/// A plane or line about its nominal place, or the axis of a circle or cylinder about its own or that of a datum.
fn position(
    points: &[SurfacePoint],
    datum: Option<&[SurfacePoint]>,
    axis: Option<&Vector3<f64>>,
    fit: ZoneFit,
) -> Result<Characteristic, Unfit> {
    if points.iter().any(|p| p.normal.is_none()) && axis.is_none() {
        return Err(Unfit::Axis);
    }
    if let (None, Ok(flat)) = (axis, Flat::of(points)) {
        if datum.is_some() {
            return Err(Unfit::Datum("the position of a plane or line is to the zero of the part"));
        }
        let measure = Measure::Zones(vec![Zone::new(all(points), &Vec::new(), false)]);
        return Ok(Characteristic { directions: vec![flat.normal; points.len()], datum: None, measure, fit });
    }
    enough(points, 3)?;
    let of = Revolution::of(points, axis)?;
    let inverse = inverse_of(&round_columns(&of));
    let end = |part: f64| {
        [1, 2].map(|k| {
            let tilt = |i: usize| if inverse.nrows() > 3 { part * inverse[(k + 2, i)] } else { 0.0 };
            (0..points.len()).map(|i| inverse[(k, i)] + tilt(i)).collect::<Vec<f64>>()
        })
    };
    let ends: &[f64] = if inverse.nrows() > 3 { &[-1.0, 1.0] } else { &[0.0] };
    let measure = Measure::Centres(ends.iter().map(|part| end(*part)).collect());
    let datum = datum.map(|datum| axis_of(datum, points, &of)).transpose()?;
    Ok(Characteristic { directions: round_directions(&of), datum, measure, fit })
}

/// Returns the motion of the axis of a round datum, or of the centre of a circle, with its effect on a surface about a
/// parallel axis.
fn axis_of(datum: &[SurfacePoint], points: &[SurfacePoint], of: &Revolution) -> Result<DatumMotion, Unfit> {
    enough(datum, 3)?;
    let round = Revolution::of(datum, Some(&of.axis));
    let round =
        round.map_err(|_| Unfit::Datum("the position of an axis is to a circle or cylinder about a parallel one"))?;
    let inverse = inverse_of(&round_columns(&round));
    let middle = datum[0].place.dot(&of.axis) - round.points[0].height;
    // The directions across the axis follow from the axis: those of both are the same. The tilts are those of the
    // ends of the datum.
    let effect = |i: usize, k: usize| {
        let lever = if k < 2 { 1.0 } else { (points[i].place.dot(&of.axis) - middle) / round.half_height };
        lever * of.points[i].across[k % 2]
    };
    let count = inverse.nrows() - 1;
    let effect = DMatrix::from_fn(points.len(), count, effect);
    Ok(DatumMotion { directions: round_directions(&round), motion: inverse.rows(1, count).into_owned(), effect })
}

/// Returns the matrix that leads from deviations to the least-squares coefficients of columns.
fn inverse_of(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let matrix = DMatrix::from_fn(columns[0].len(), columns.len(), |i, k| columns[k][i]);
    let svd = Svd::new(&matrix);
    let rank = svd.rank(HELD * HELD);
    let scaled = DMatrix::from_fn(rank, matrix.nrows(), |k, i| svd.u[(i, k)] / svd.values[k]);
    svd.v.columns(0, rank) * scaled
}

/// A plane or line between planes at its nominal angle to a datum.
fn angle(
    kind: CharacteristicKind,
    points: &[SurfacePoint],
    datum: &[SurfacePoint],
    axis: Option<&Vector3<f64>>,
    fit: ZoneFit,
) -> Result<Characteristic, Unfit> {
    let flat = Flat::of(points)?;
    enough(datum, 2)?;
    let (direction, directions, sizes) = match Flat::of(datum) {
        Ok(datum_flat) => (datum_flat.normal, vec![datum_flat.normal; datum.len()], 0),
        Err(_) => {
            let of = Revolution::of(datum, axis);
            let of = of.map_err(|_| Unfit::Datum("an angle is to a line, a plane or a cylinder"))?;
            (of.axis, round_directions(&of), 1)
        }
    };
    let cosine = flat.normal.dot(&direction).abs().min(1.0);
    // Of a plane counts its normal, of a cylinder its axis.
    let turned = if sizes == 0 { cosine } else { (1.0 - cosine * cosine).max(0.0).sqrt() };
    let off = match kind {
        CharacteristicKind::Parallelism => (1.0 - turned * turned).max(0.0).sqrt(),
        CharacteristicKind::Perpendicularity => turned,
        _ => 0.0,
    };
    if off > ANGLE {
        return Err(Unfit::Angle { deg: libm::acos(turned).to_degrees() });
    }
    let held = Rotations::held_by(datum, &directions, sizes == 1);
    if held.motion.nrows() == 0 {
        return Err(Unfit::Datum("it holds no rotation of the part"));
    }
    let turn = |p: &SurfacePoint, about: &Vector3<f64>| about.dot(&(p.place - flat.centre).cross(&flat.normal));
    let effect = DMatrix::from_fn(points.len(), held.about.len(), |i, k| turn(&points[i], &held.about[k]));
    let free = |about: &Vector3<f64>| points.iter().map(|p| turn(p, about) / flat.size).collect::<Vec<f64>>();
    // A rotation that moves no point by its size is none of the feature.
    let counts = |column: &Vec<f64>| column.iter().any(|x| x.abs() > HELD);
    let columns: Columns =
        std::iter::once(vec![1.0; points.len()]).chain(held.free.iter().map(free).filter(counts)).collect();
    let measure = Measure::Zones(vec![Zone::new(all(points), &columns, true)]);
    let datum = Some(DatumMotion { directions, motion: held.motion, effect });
    Ok(Characteristic { directions: vec![flat.normal; points.len()], datum, measure, fit })
}

/// The rotations of a part that a datum holds, by least squares.
struct Rotations {
    /// Axes of the rotations that it holds.
    about: Vec<Vector3<f64>>,
    /// Axes of the others.
    free: Vec<Vector3<f64>>,
    /// The rotations by the deviations of the datum, rad per mm.
    motion: DMatrix<f64>,
}

impl Rotations {
    fn held_by(datum: &[SurfacePoint], directions: &[Vector3<f64>], sized: bool) -> Self {
        let count = datum.len();
        let centre = datum.iter().map(|p| p.place).sum::<Vector3<f64>>() / count as f64;
        let size = datum.iter().map(|p| (p.place - centre).norm()).fold(f64::MIN_POSITIVE, f64::max);
        let shift = |k: usize| DVector::from_fn(count, |i, _| if k < 3 { directions[i][k] } else { 1.0 });
        let mut known: Vec<DVector<f64>> = Vec::new();
        for column in (0..if sized { 4 } else { 3 }).map(shift) {
            let rest = beside(column.clone(), &known);
            if rest.norm() > HELD * HELD * column.norm() {
                known.push(rest.normalize());
            }
        }
        let turn = |i: usize, k: usize| ((datum[i].place - centre) / size).cross(&directions[i])[k];
        let turns: Vec<DVector<f64>> =
            (0..3).map(|k| beside(DVector::from_fn(count, |i, _| turn(i, k)), &known)).collect();
        let svd = Svd::new(&DMatrix::from_columns(&turns));
        let rank = svd.values.iter().filter(|value| **value > HELD * (count as f64).sqrt()).count();
        let axis = |k: usize| Vector3::new(svd.v[(0, k)], svd.v[(1, k)], svd.v[(2, k)]);
        let motion = DMatrix::from_fn(rank, count, |k, i| svd.u[(i, k)] / svd.values[k] / size);
        Self { about: (0..rank).map(axis).collect(), free: (rank..3).map(axis).collect(), motion }
    }
}
