//! Poses of the tool in the workpiece frame, and why one may be out of reach.

use crate::algebra::rotation_about;
use crate::lower::NominalPose;
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel};
use nalgebra::{Matrix3, Vector3};

/// Maximum distance of the place reached from the one requested, mm.
pub const PLACE_TOLERANCE: f64 = 1e-9;

/// Maximum angle of the direction reached from the one requested, rad.
pub const DIRECTION_TOLERANCE: f64 = 1e-12;

/// A pose of the tool in the workpiece frame, that of the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolPose {
    /// The functional point, from the workpiece origin, mm.
    pub tip: Vector3<f64>,
    /// Unit vector of the tool axis, from the tip towards the holder: the tool's own at the zero pose.
    pub direction: Vector3<f64>,
    /// Turn of the tool about its axis, rad: right-handed about the direction, from the attitude that the shortest turn
    /// of the tool axis at the zero pose into the direction gives (see [`attitude`]); `None` leaves it open. Machines
    /// that cannot turn the tool about its axis do not depend on it.
    pub spin_rad: Option<f64>,
}

impl ToolPose {
    /// Returns a tool pose whose spin is open: a tip (mm, from the workpiece origin) and a unit vector.
    pub fn new(tip: Vector3<f64>, direction: Vector3<f64>) -> Self {
        Self { tip, direction, spin_rad: None }
    }

    /// Returns the tool pose in the unturned workpiece frame. The spin is the same: it counts from the shortest turn.
    pub fn to_unturned(&self, machine: &Machine) -> Self {
        let Some(rotation) = machine.workpiece_rotation() else { return *self };
        Self { tip: rotation * self.tip, direction: rotation * self.direction, ..*self }
    }
}

/// Returns the rotation of the tool from the zero pose for a direction of its axis and a spin (rad): the shortest turn
/// of the tool axis there into the direction (unit vectors), after the spin. Into the opposite it is a half turn about
/// X, as far as X is across the tool axis.
pub fn attitude(tool: &Vector3<f64>, direction: &Vector3<f64>, spin_rad: f64) -> Matrix3<f64> {
    let spun = rotation_about(&(*tool).into(), (libm::sin(spin_rad), libm::cos(spin_rad)));
    let (across, cosine) = (tool.cross(direction), tool.dot(direction));
    let sine = across.norm();
    if sine > 0.0 {
        return rotation_about(&(across / sine).into(), (sine, cosine)) * spun;
    }
    if cosine > 0.0 {
        return spun;
    }
    let letter = if tool.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let about = (letter - tool * tool.dot(&letter)).normalize();
    rotation_about(&about.into(), (0.0, -1.0)) * spun
}

/// The reason why a machine cannot take a tool pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unreachable {
    /// Its rotary axes cannot point the tool there.
    Direction,
    /// Its axes do not bring the tip to the place.
    Place,
    /// An axis would have to leave its travel.
    Travel,
}

impl Unreachable {
    /// Returns the reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Direction => "the tool cannot be held in this direction",
            Self::Place => "the axes do not bring the tip there",
            Self::Travel => "an axis would leave its travel",
        }
    }
}

/// A tool pose that a machine cannot take, and what it lacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Miss {
    /// The reason.
    pub why: Unreachable,
    /// For [`Unreachable::Travel`]: the pose (mm, deg) beyond the travel that would take it. Of several the one whose
    /// rotary axes, then linear axes, are least beyond.
    pub beyond: Option<Pose>,
    /// For [`Unreachable::Place`]: distance of the place from what the axes span, mm.
    pub off_mm: Option<f64>,
    /// True if no pose at all takes the tool pose; false if none was found.
    pub is_proved: bool,
}

impl Miss {
    /// Returns a miss of which only the reason is known.
    pub fn new(why: Unreachable) -> Self {
        Self { why, beyond: None, off_mm: None, is_proved: true }
    }

    /// Returns a miss by travel, with the pose (mm, deg) beyond it.
    pub fn travel(beyond: Pose) -> Self {
        Self { beyond: Some(beyond), ..Self::new(Unreachable::Travel) }
    }

    /// Returns a miss by the place, which is so far (mm) from what the axes span.
    pub fn place(off_mm: f64) -> Self {
        Self { off_mm: Some(off_mm), ..Self::new(Unreachable::Place) }
    }

    /// Returns the same miss with what is known of other poses.
    pub fn proved(self, is_proved: bool) -> Self {
        Self { is_proved, ..self }
    }

    /// Returns the miss that comes nearer to the tool pose: the later reason; of two beyond the travel the lesser.
    pub fn or_nearer(self, other: Self, axes: &[Axis]) -> Self {
        let far = |miss: &Self| {
            let pose = miss.beyond.as_ref()?;
            let of = |kind: AxisKind| -> f64 {
                let of_kind = |e: &TravelExcess| axes[e.axis].kind == kind;
                excess(axes, pose).into_iter().filter(of_kind).map(|e| e.by.abs()).sum()
            };
            Some((of(AxisKind::Rotary), of(AxisKind::Linear)))
        };
        let nearer = match (&self, &other) {
            (a, b) if a.why != b.why => a.why > b.why,
            (a, b) => match (far(a), far(b)) {
                (Some((r, l)), Some((s, m))) => r.total_cmp(&s).then(l.total_cmp(&m)).is_le(),
                (None, Some(_)) => false,
                (_, None) => a.off_mm.unwrap_or(f64::MAX) <= b.off_mm.unwrap_or(f64::MAX),
            },
        };
        if nearer { self } else { other }
    }
}

/// A position beyond the travel of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelExcess {
    /// Index of the axis.
    pub axis: usize,
    /// Distance from the nearer end, mm or deg: negative below the lower end.
    pub by: f64,
}

/// Returns the positions of a pose (mm, deg) beyond the travels, axis by axis.
pub fn excess(axes: &[Axis], pose: &[f64]) -> Vec<TravelExcess> {
    let beyond = |(axis, (of, q)): (usize, (&Axis, &f64))| match of.travel {
        Travel::Range(min, _) if *q < min => Some(TravelExcess { axis, by: q - min }),
        Travel::Range(_, max) if *q > max => Some(TravelExcess { axis, by: q - max }),
        _ => None,
    };
    axes.iter().zip(pose).enumerate().filter_map(beyond).collect()
}

/// Returns the tool pose of the nominal machine at a pose (mm, deg).
pub fn tool_pose(machine: &Machine, pose: &[f64]) -> ToolPose {
    tool_pose_of(machine, &NominalPose::in_part(machine, pose))
}

/// Returns the tool pose of the nominal machine at a pose (mm, deg) in the unturned workpiece frame, in which poses are
/// sought.
pub fn unturned_tool_pose(machine: &Machine, pose: &[f64]) -> ToolPose {
    tool_pose_of(machine, &NominalPose::at(machine, pose))
}

fn tool_pose_of(machine: &Machine, nominal: &NominalPose) -> ToolPose {
    ToolPose::new(nominal.pose.translation, nominal.pose.linear * Vector3::from(machine.tool().direction))
}

/// Returns the pose of zeros, each moved into its axis's travel (mm, deg).
pub fn rest(machine: &Machine) -> Pose {
    machine.axes().iter().map(|axis| within_travel(axis, 0.0)).collect()
}

/// Returns a position (mm or deg) moved into the travel.
pub fn within_travel(axis: &Axis, position: f64) -> f64 {
    match axis.travel {
        Travel::Range(min, max) => position.clamp(min, max),
        Travel::Continuous => position,
    }
}
