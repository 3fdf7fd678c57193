//! A ball bar: the distance of a ball at the functional point from a ball on the workpiece while the
//! machine drives a circle about it, in both senses.

use super::bounded::DrivenPath;
use super::path::{PosePath, deviation_from, hold};
use crate::analysis::inverse::{Unreachable, tool_pose};
use crate::lower::into_part;
use crate::machine::{Approach, Machine, Pose, sin_cos_degrees};
use crate::standards::{BothSenses, range};
use nalgebra::Vector3;

/// A plane of the workpiece frame; the circle runs from its first to its second direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[allow(missing_docs, reason = "the letters are their own documentation")]
pub enum Plane {
    XY,
    YZ,
    ZX,
}

impl Plane {
    /// All three.
    pub const ALL: [Self; 3] = [Self::XY, Self::YZ, Self::ZX];

    /// Returns the two directions as indices of x, y, z.
    pub fn directions(self) -> [usize; 2] {
        match self {
            Self::XY => [0, 1],
            Self::YZ => [1, 2],
            Self::ZX => [2, 0],
        }
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::XY => "XY",
            Self::YZ => "YZ",
            Self::ZX => "ZX",
        }
    }
}

/// A circle of a ball bar in both senses, evaluated by ISO 230-4.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct BallBar {
    /// The plane, workpiece frame.
    pub plane: Plane,
    /// Circular deviation G of each path, um: range about its own centre of least squares.
    pub circular_deviation_um: BothSenses<f64>,
    /// Bidirectional circular deviation G(b), um.
    pub bidirectional_um: f64,
    /// Mean bidirectional radial deviation D, um.
    pub mean_radial_um: f64,
    /// Radial deviations F, um: largest and smallest reading.
    pub radial_max_min_um: BothSenses<[f64; 2]>,
    /// Angle between the plane's directions minus 90 deg by the second harmonic, urad.
    pub squareness_urad: f64,
    /// Scale of the first direction minus that of the second, um/m.
    pub scale_mismatch_um_per_m: f64,
    /// Angles of the readings from the plane's first direction to its second, deg.
    pub angle_deg: Vec<f64>,
    /// Length read minus radius with rising angle, um.
    pub counter_clockwise_um: Vec<f64>,
    /// Length read minus radius with falling angle, um.
    pub clockwise_um: Vec<f64>,
    /// Readings of both senses about their common least-squares centre, um.
    #[serde(skip)]
    pub centred_um: [Vec<f64>; 2],
}

/// Returns the readings over a circle about the pose `centre` (mm, deg), at `points` angles in both senses. The ball on
/// the workpiece is at the actual functional point of that pose, as on the machine; rotary axes stay as there. Fails
/// with the reason if the linear axes cannot follow.
pub fn ball_bar(
    machine: &Machine,
    centre: &[f64],
    plane: Plane,
    radius_mm: f64,
    points: usize,
) -> Result<BallBar, Unreachable> {
    let Circle { angles, arms, poses: there } = Circle::new(machine, centre, plane, radius_mm, points)?;
    let back = there.iter().rev().cloned().collect();
    let ball = deviation_from(machine, centre, &vec![Approach::Mean; centre.len()]);
    let read = |deviations: Vec<Vector3<f64>>| -> Vec<f64> {
        let length = |(d, arm): (Vector3<f64>, &Vector3<f64>)| (arm + into_part(machine, d - ball)).norm();
        let one = |at: (Vector3<f64>, &Vector3<f64>)| (length(at) - radius_mm) * 1e3;
        deviations.into_iter().zip(&arms).map(one).collect()
    };
    let forward = read(PosePath { poses: there, closed: true }.deviations(machine));
    let mut reverse = PosePath { poses: back, closed: true }.deviations(machine);
    reverse.reverse();
    Ok(evaluate(plane, radius_mm, angles.clone(), [forward, read(reverse)]))
}

/// A circle that the linear axes drive about a ball.
struct Circle {
    angles: Vec<f64>,
    /// Arms from the ball to the functional point, workpiece frame, mm.
    arms: Vec<Vector3<f64>>,
    poses: Vec<Pose>,
}

impl Circle {
    fn new(
        machine: &Machine,
        centre: &[f64],
        plane: Plane,
        radius_mm: f64,
        points: usize,
    ) -> Result<Self, Unreachable> {
        let middle = tool_pose(machine, centre).tip;
        let [u, v] = plane.directions();
        let arm = |angle: &f64| {
            let (sine, cosine) = sin_cos_degrees(*angle);
            let mut arm = Vector3::zeros();
            (arm[u], arm[v]) = (radius_mm * cosine, radius_mm * sine);
            arm
        };
        let angles: Vec<f64> = (0..points).map(|i| 360.0 * i as f64 / points as f64).collect();
        let arms: Vec<Vector3<f64>> = angles.iter().map(arm).collect();
        let poses = hold(machine, centre, arms.iter().map(|arm| middle + arm))?;
        Ok(Self { angles, arms, poses })
    }
}

/// Returns the circle of [`ball_bar`] with its circular deviation about its own least-squares centre. The last pose is
/// that of the ball.
pub fn circle_path<'a>(
    machine: &'a Machine,
    centre: &[f64],
    plane: Plane,
    radius_mm: f64,
    points: usize,
) -> Result<DrivenPath<'a>, Unreachable> {
    let Circle { angles, arms, mut poses } = Circle::new(machine, centre, plane, radius_mm, points)?;
    poses.push(centre.to_vec());
    let directions: Vec<(f64, f64)> = angles.iter().map(|angle| sin_cos_degrees(*angle)).collect();
    let readings = move |deviations: &[Vector3<f64>]| {
        let ball = deviations.last().copied().unwrap_or_default();
        let length = |(d, arm): (&Vector3<f64>, &Vector3<f64>)| (arm + into_part(machine, d - ball)).norm() - radius_mm;
        let read: Vec<f64> = deviations.iter().zip(&arms).map(length).collect();
        let turned = read.iter().zip(&directions);
        let [s, c] = turned.clone().fold([0.0; 2], |[s, c], (r, (sine, cosine))| [s + r * sine, c + r * cosine]);
        let [s, c] = [s, c].map(|sum| 2.0 * sum / read.len() as f64);
        vec![range(turned.map(|(r, (sine, cosine))| r - s * sine - c * cosine))]
    };
    Ok(DrivenPath { names: vec![plane.name().to_owned()], poses, readings: Box::new(readings) })
}

/// Returns the parts of sine and cosine of a multiple of the angle (deg), over even steps of a turn.
fn harmonic<'a>(readings: impl Iterator<Item = (&'a f64, &'a f64)>, order: f64) -> [f64; 2] {
    let (count, s, c) = readings.fold((0.0, 0.0, 0.0), |(count, s, c), (r, angle)| {
        let (sine, cosine) = sin_cos_degrees(order * angle);
        (count + 1.0, s + r * sine, c + r * cosine)
    });
    [2.0 * s / count, 2.0 * c / count]
}

/// Returns the readings of a path about a centre.
fn about_centre(path: &[f64], angles: &[f64], [sine_1, cosine_1]: [f64; 2]) -> Vec<f64> {
    let off = |(r, angle): (&f64, &f64)| {
        let (sine, cosine) = sin_cos_degrees(*angle);
        r - sine_1 * sine - cosine_1 * cosine
    };
    path.iter().zip(angles).map(off).collect()
}

fn evaluate(plane: Plane, radius: f64, angles: Vec<f64>, readings: [Vec<f64>; 2]) -> BallBar {
    let count = (2 * angles.len()) as f64;
    let both = || readings.iter().flat_map(|sense| sense.iter().zip(&angles));
    let [sine_2, cosine_2] = harmonic(both(), 2.0);
    let centre = harmonic(both(), 1.0);
    let centred = readings.each_ref().map(|sense| about_centre(sense, &angles, centre));
    let own_range = |path: &Vec<f64>| {
        let centre = harmonic(path.iter().zip(&angles), 1.0);
        range(about_centre(path, &angles, centre).into_iter())
    };
    let extreme = |sense: &Vec<f64>| {
        [sense.iter().copied().fold(f64::NEG_INFINITY, f64::max), sense.iter().copied().fold(f64::INFINITY, f64::min)]
    };
    let mean_radial_um = readings.iter().flatten().sum::<f64>() / count;
    let radial_max_min_um = BothSenses::new(readings.each_ref().map(extreme));
    let circular_deviation_um = BothSenses::new(readings.each_ref().map(own_range));
    let [counter_clockwise_um, clockwise_um] = readings;
    BallBar {
        plane,
        circular_deviation_um,
        bidirectional_um: range(centred.iter().flatten().copied()),
        mean_radial_um,
        radial_max_min_um,
        // An angle above 90 deg by e reads - e radius / 2 sin 2 angle; um and mm make 1e3 urad. Never -0.
        squareness_urad: -2.0 * sine_2 / radius * 1e3 + 0.0,
        scale_mismatch_um_per_m: 2.0 * cosine_2 / radius * 1e3 + 0.0,
        angle_deg: angles,
        counter_clockwise_um,
        clockwise_um,
        centred_um: centred,
    }
}
