//! The reference of a job: what the set-up of its part takes out of the deviations, and how a machine probes it.

use super::numbers::{positions, three};
use super::placement::Placement;
use super::tool_poses::MissedToolPose;
use super::tool_poses::columns::unit_vector;
use crate::analysis::reference::{PartReference, ReferencedField};
use crate::analysis::{Miss, ToolPose, Unreachable, inverse, place, rest, spread_places};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Field, Order, Poses, Spread};
use crate::machine::{AxisKind, Machine, OperatingConditions, Pose, UnheldMotion};
use crate::run::{Call, Refused};
use crate::units::significant;
use nalgebra::Vector3;
use std::fmt;

/// Maximum number of poses over which a best fit is made.
const MAX_FITTED: usize = 1_000_000;

/// Minimum number of different poses of a best fit.
const MIN_FITTED: usize = 3;

/// Maximum number of poses over which motions that the data do not hold are fitted.
const MAX_UNHELD_POSES: usize = 10_000;

/// Number of poses of the volume over which they are fitted in place of too few.
const UNHELD_VOLUME_POSES: usize = 1000;

/// Axes of one pose are less than this apart, mm or deg.
const SAME: f64 = 1e-6;

/// What is taken out of the deviations of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKind {
    /// Nothing: machine coordinates.
    #[default]
    Machine,
    /// Those rigid motions of the workpiece frame that the data behind the errors do not hold: the part of the best fit
    /// over the poses that combines them; nothing where the machine file names none.
    MachineLessUnheld,
    /// Three translations: the zero of the part is probed on the machine. Carried out as `zero-less-unheld` where the
    /// machine file names motions that the data behind the errors do not hold.
    Zero,
    /// The zero, and those rotations about it that the data behind the errors do not hold, fitted over the poses.
    ZeroLessUnheld,
    /// A frame of six datum points, 3-2-1.
    Datum,
    /// The rigid motion with the least sum of squared position deviations over the poses, or with the least largest
    /// one.
    BestFit,
}

impl ReferenceKind {
    /// Those that one states; a zero is carried out as less unheld by itself.
    const STATED: [Self; 5] = [Self::Machine, Self::MachineLessUnheld, Self::Zero, Self::Datum, Self::BestFit];

    /// Returns the keys of a reference that have an effect.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Machine | Self::MachineLessUnheld => &[],
            Self::Zero | Self::ZeroLessUnheld => &["point", "direction", "rotary", "align"],
            Self::Datum => &["direction", "rotary", "datum"],
            Self::BestFit => &["minimum_zone"],
        }
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Machine => "machine",
            Self::MachineLessUnheld => "machine-less-unheld",
            Self::Zero => "zero",
            Self::ZeroLessUnheld => "zero-less-unheld",
            Self::Datum => "datum",
            Self::BestFit => "best-fit",
        }
    }
}

/// A reference with the points at which it is probed, part coordinates.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields, remote = "Self")]
#[schemars(rename = "Reference")]
pub struct Reference {
    /// What is taken out.
    pub kind: ReferenceKind,
    /// Point at which the zero is probed, mm.
    #[serde(deserialize_with = "three")]
    pub point: [f64; 3],
    /// Direction of the tool while the part is probed, from the tip to the holder; of any length but 0.
    #[serde(deserialize_with = "three")]
    pub direction: [f64; 3],
    /// Positions of the rotary axes while the zero is probed, deg, by name, in place of the direction; omitted axes are
    /// at 0.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "positions")]
    pub rotary: Option<super::poses::AxisPositions>,
    /// Rotation that a second point of the zero gives.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub align: Option<Alignment>,
    /// True for the best fit with the smallest largest position deviation in place of the least squares.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub minimum_zone: bool,
    /// The six points of a datum frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub datum: Vec<DatumPoint>,
    /// Where the part lies on the workpiece frame; of a job that is stated by its file.
    #[serde(skip)]
    pub place: Placement,
    /// True if motions that the data do not hold are fitted over the volume: the poses of the result are too few.
    #[serde(skip)]
    pub over_volume: bool,
}

/// A key of a reference that has no effect.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` has no effect on a reference of kind `{}`{}", .kind.name(), beside(*.is_displaced))]
pub(crate) struct IdleKey {
    /// The key.
    pub key: &'static str,
    kind: ReferenceKind,
    is_displaced: bool,
}

/// Returns the words for what stands in place of a key.
fn beside(is_displaced: bool) -> &'static str {
    if is_displaced { " with `rotary`" } else { "" }
}

impl IdleKey {
    /// Returns the remedy.
    pub fn help(&self) -> String {
        let kinds = ReferenceKind::STATED.into_iter().filter(|kind| kind.keys().contains(&self.key));
        let kinds: Vec<String> = kinds.map(|kind| format!("`kind: {}`", kind.name())).collect();
        match self.is_displaced {
            true => "state positions of the rotary axes or a direction of the tool".to_owned(),
            false => format!("omit it, or state {}", kinds.join(" or ")),
        }
    }
}

/// An alignment: a second point gives the rotation about an axis through the first.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Alignment {
    /// Direction of the axis, part coordinates.
    #[serde(deserialize_with = "three")]
    pub about: [f64; 3],
    /// The second point, mm, part coordinates.
    #[serde(deserialize_with = "three")]
    pub point: [f64; 3],
}

/// A datum point: a place on the part with the normal of its surface, part coordinates.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DatumPoint {
    /// The place, mm.
    #[serde(deserialize_with = "three")]
    pub point: [f64; 3],
    /// The normal, of any length but 0.
    #[serde(deserialize_with = "three")]
    pub normal: [f64; 3],
}

impl Default for Reference {
    fn default() -> Self {
        Self {
            kind: ReferenceKind::Machine,
            point: [0.0; 3],
            direction: [0.0, 0.0, 1.0],
            rotary: None,
            align: None,
            minimum_zone: false,
            datum: Vec::new(),
            place: Placement::default(),
            over_volume: false,
        }
    }
}

impl Reference {
    /// Returns the default of a job: the zero at the part's origin, the tool along its +Z.
    pub fn zero() -> Self {
        Self { kind: ReferenceKind::Zero, ..Self::default() }
    }

    /// Returns the reference of a part at a place of the workpiece frame.
    pub(crate) fn placed(self, place: Placement) -> Self {
        Self { place, ..self }
    }

    /// Returns machine coordinates less the motions that the data behind the errors do not hold.
    pub fn machine_less_unheld() -> Self {
        Self { kind: ReferenceKind::MachineLessUnheld, ..Self::default() }
    }

    /// Returns the best fit.
    pub fn best_fit() -> Self {
        Self { kind: ReferenceKind::BestFit, ..Self::default() }
    }

    /// Returns the best fit with the smallest largest deviation.
    pub fn minimum_zone() -> Self {
        Self { minimum_zone: true, ..Self::best_fit() }
    }

    /// Returns the first of keys with which it is stated that has no effect.
    pub(crate) fn idle_key(&self, keys: &[&str]) -> Option<IdleKey> {
        const KEYS: [&str; 6] = ["point", "direction", "rotary", "align", "minimum_zone", "datum"];
        let acts = self.kind.keys();
        KEYS.into_iter().filter(|key| keys.contains(key)).find_map(|key| {
            let is_displaced = acts.contains(&key) && key == "direction" && self.rotary.is_some();
            (is_displaced || !acts.contains(&key)).then_some(IdleKey { key, kind: self.kind, is_displaced })
        })
    }

    /// Returns the keys whose values are not the default.
    pub(crate) fn stated_keys(&self) -> Vec<&'static str> {
        let default = Self::default();
        let stated = [
            ("point", self.point != default.point),
            ("direction", self.direction != default.direction),
            ("rotary", self.rotary.is_some()),
            ("align", self.align.is_some()),
            ("minimum_zone", self.minimum_zone),
            ("datum", !self.datum.is_empty()),
        ];
        stated.into_iter().filter(|(_, is)| *is).map(|(key, _)| key).collect()
    }

    /// Returns the poses over which motions that the data do not hold are fitted, in words.
    fn fitted_over(&self) -> &'static str {
        if self.over_volume { "the volume" } else { "these poses" }
    }

    /// True if its motion is not linear in the errors.
    pub(crate) fn is_minimum_zone(&self) -> bool {
        self.kind == ReferenceKind::BestFit && self.minimum_zone
    }
}

/// In words, such as `zero at (0, 0, 0) along (0, 0, 1)`.
impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let triple = |v: &[f64; 3]| format!("({})", v.map(|x| significant(x, 6)).join(", "));
        match self.kind {
            ReferenceKind::Machine => f.write_str("machine coordinates"),
            ReferenceKind::MachineLessUnheld => {
                let poses = self.fitted_over();
                write!(f, "machine-less-unheld (without rigid motions that the data do not hold, fitted over {poses})")
            }
            ReferenceKind::BestFit if self.minimum_zone => {
                f.write_str("best fit of the part, minimum zone (no intervals, no parts of errors)")
            }
            ReferenceKind::BestFit => f.write_str("best fit of the part"),
            ReferenceKind::Datum => write!(f, "datum frame of {} points", self.datum.len()),
            ReferenceKind::Zero | ReferenceKind::ZeroLessUnheld => {
                write!(f, "zero at {}", triple(&self.point))?;
                match &self.rotary {
                    Some(rotary) => {
                        let list = rotary.iter().map(|(axis, q)| format!("{axis} = {}", significant(*q, 6)));
                        write!(f, " with {}", list.collect::<Vec<_>>().join(", "))?;
                    }
                    None => write!(f, " along {}", triple(&self.direction))?,
                }
                if let Some(align) = &self.align {
                    write!(f, ", aligned about {}", triple(&align.about))?;
                }
                if self.kind == ReferenceKind::ZeroLessUnheld {
                    let poses = self.fitted_over();
                    write!(f, ", less rotations about it that the data do not hold, fitted over {poses}")?;
                }
                Ok(())
            }
        }
    }
}

/// The set-up of a part on a machine.
#[derive(Debug, Clone)]
pub(crate) struct SetUp {
    /// The reference, as it was carried out.
    pub reference: Reference,
    /// What it takes out; `None` in machine coordinates.
    pub removed: Option<PartReference>,
}

impl SetUp {
    /// The set-up that takes nothing out.
    pub fn machine() -> Self {
        Self { reference: Reference::default(), removed: None }
    }

    /// Returns the best fit over poses (mm, deg).
    pub fn best_fit(machine: &Machine, poses: &[Pose]) -> Self {
        Self { reference: Reference::best_fit(), removed: Some(PartReference::best_fit(machine, poses)) }
    }

    /// Returns machine coordinates less motions that the data of this machine or of others do not hold, fitted over
    /// poses (mm, deg) by least squares: 10,000 spread over their list if there are more, and poses of the volume in
    /// place of fewer than three, of which nothing would be left.
    pub fn less_unheld(machine: &Machine, motions: &[UnheldMotion], poses: &[Pose]) -> Self {
        if motions.is_empty() {
            return Self::machine();
        }
        let (fitted, over_volume) = fitted_for_unheld(machine, poses);
        let reference = Reference { over_volume, ..Reference::machine_less_unheld() };
        Self { reference, removed: Some(PartReference::part_of_best_fit(machine, motions, &fitted)) }
    }

    /// Returns the zero of a part, less those rotations about it that the data of this machine or of others do not
    /// hold, fitted as [`Self::less_unheld`] fits them.
    fn zero(
        machine: &Machine,
        reference: &Reference,
        motions: &[UnheldMotion],
        poses: &[Pose],
    ) -> Result<Self, Diagnostic> {
        let probed = zero(machine, reference)?;
        let turning = probed.left_of(motions);
        if turning.is_empty() {
            let reference = Reference { kind: ReferenceKind::Zero, ..reference.clone() };
            return Ok(Self { reference, removed: Some(probed) });
        }
        let (fitted, over_volume) = fitted_for_unheld(machine, poses);
        let reference = Reference { kind: ReferenceKind::ZeroLessUnheld, over_volume, ..reference.clone() };
        Ok(Self { reference, removed: Some(probed.and_part_of_best_fit(machine, &turning, &fitted)) })
    }

    /// Refuses a minimum zone for what needs a motion that is linear in the errors: `what`, such as `a goal`.
    pub fn refuse_minimum_zone(&self, call: &mut Call<'_>, what: &str) -> Result<(), Refused> {
        if !self.reference.is_minimum_zone() {
            return Ok(());
        }
        let message = format!("a minimum zone is for values and for the machines that `budget` draws, not for {what}");
        call.refuse(refuse(message, "take the least squares, `--reference best-fit`, or another reference"))
    }

    /// Returns the set-up of a part on a machine; fits are over the poses (mm, deg).
    pub fn new(machine: &Machine, reference: &Reference, poses: &[Pose]) -> Result<Self, Diagnostic> {
        Self::without(machine, reference, machine.unheld(), poses)
    }

    /// Returns the set-up of a part on a machine, where the data behind the errors of this machine or of others do not
    /// hold some motions; fits are over the poses (mm, deg).
    pub fn without(
        machine: &Machine,
        reference: &Reference,
        motions: &[UnheldMotion],
        poses: &[Pose],
    ) -> Result<Self, Diagnostic> {
        let removed = match reference.kind {
            ReferenceKind::Machine => None,
            ReferenceKind::MachineLessUnheld => return Ok(Self::less_unheld(machine, motions, poses)),
            ReferenceKind::Zero | ReferenceKind::ZeroLessUnheld => {
                return Self::zero(machine, reference, motions, poses);
            }
            ReferenceKind::BestFit if poses.is_empty() || poses.len() > MAX_FITTED => {
                let message = format!("a best fit is over 1 to {MAX_FITTED} poses, not {}", poses.len());
                return Err(refuse(message, "take fewer poses, `--random 10000`, or another `--reference`"));
            }
            ReferenceKind::BestFit if count_different(poses) < MIN_FITTED => {
                let (poses, rest) = match count_different(poses) {
                    1 => ("one pose", "nothing of its deviation"),
                    _ => ("two poses", "one of the six numbers of their deviations"),
                };
                let message = format!("a best fit of {poses} leaves {rest}: it takes {MIN_FITTED} different poses");
                return Err(refuse(message, "take more poses, or another `--reference`"));
            }
            ReferenceKind::BestFit if reference.minimum_zone => Some(PartReference::minimum_zone(machine, poses)),
            ReferenceKind::BestFit => return Ok(Self::best_fit(machine, poses)),
            ReferenceKind::Datum => Some(datum(machine, reference)?),
        };
        Ok(Self { reference: reference.clone(), removed })
    }

    /// Returns the set-up of a part by the default. Where the machine does not reach it, this says so and takes machine
    /// coordinates.
    pub fn by_default(
        call: &mut Call<'_>,
        machine: &Machine,
        default: &Reference,
        poses: &[Pose],
    ) -> Result<Self, Refused> {
        Self::new(machine, default, poses).or_else(|reason| {
            call.warn(unzeroed(&reason));
            call.check()?;
            Ok(Self::machine())
        })
    }

    /// Returns what is taken out.
    pub fn removed(&self) -> Option<&PartReference> {
        self.removed.as_ref()
    }

    /// Returns a field without what is taken out; `None` in machine coordinates.
    pub fn field<'a>(
        &self,
        field: &'a dyn Field,
        order: Order,
        conditions: OperatingConditions,
    ) -> Option<ReferencedField<'a>> {
        Some(ReferencedField::new(field, self.removed.as_ref()?, order, conditions))
    }
}

/// Returns the poses (mm, deg) over which motions that the data do not hold are fitted, and true if they are poses of
/// the volume: 10,000 spread over a list if there are more, and the volume in place of fewer than three, of which
/// nothing would be left.
fn fitted_for_unheld(machine: &Machine, poses: &[Pose]) -> (Vec<Pose>, bool) {
    if count_different(poses) < MIN_FITTED {
        return (Poses::Spread(Spread::of(machine, UNHELD_VOLUME_POSES, 0)).iter().collect(), true);
    }
    (spread_places(poses.len(), MAX_UNHELD_POSES, &[]).into_iter().map(|i| poses[i].clone()).collect(), false)
}

/// Returns those of poses (mm, deg) over which motions that the data do not hold are fitted at most.
pub(crate) fn sample_for_unheld(poses: &Poses) -> Vec<Pose> {
    spread_places(poses.len(), MAX_UNHELD_POSES, &[]).into_iter().map(|i| poses.get(i)).collect()
}

/// Returns the warning of a job whose part cannot be zeroed at its origin.
pub(crate) fn unzeroed(reason: &Diagnostic) -> Diagnostic {
    let message = format!("the deviations are in machine coordinates: {}", reason.message);
    Diagnostic::new(codes::W0850, message)
        .help("state a point that the machine reaches, `--reference zero:X,Y,Z`, or `--reference machine`")
}

/// Returns the number of different poses (mm, deg) in a list, counted up to the minimum of a best fit.
fn count_different(poses: &[Pose]) -> usize {
    let same = |a: &Pose, b: &Pose| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME);
    let mut known: Vec<&Pose> = Vec::new();
    for pose in poses {
        if known.len() < MIN_FITTED && !known.iter().any(|other| same(other, pose)) {
            known.push(pose);
        }
    }
    known.len()
}

fn refuse(message: String, help: &str) -> Diagnostic {
    Diagnostic::new(codes::E0850, message).help(help)
}

fn zero(machine: &Machine, reference: &Reference) -> Result<PartReference, Diagnostic> {
    let pose = probed(machine, reference, &reference.point)?;
    let Some(align) = &reference.align else { return Ok(PartReference::zero(machine, pose)) };
    let second = probed(machine, reference, &align.point)?;
    let about = unturned(machine, reference, unit(&align.about, "the axis of the alignment")?);
    PartReference::aligned_zero(machine, [pose, second], &about).ok_or_else(|| {
        let help = "state a second point beside the axis through the first";
        refuse("the second point of the alignment gives no rotation about its axis".to_owned(), help)
    })
}

fn datum(machine: &Machine, reference: &Reference) -> Result<PartReference, Diagnostic> {
    if reference.datum.len() != 6 {
        let message = format!("a datum frame has six points, three, two and one; there are {}", reference.datum.len());
        return Err(refuse(message, "state six points with their normals under `datum` of the reference"));
    }
    let poses =
        reference.datum.iter().map(|point| probed(machine, reference, &point.point)).collect::<Result<_, _>>()?;
    let normal =
        |point: &DatumPoint| Ok(unturned(machine, reference, unit(&point.normal, "the normal of a datum point")?));
    let normals = reference.datum.iter().map(normal).collect::<Result<Vec<_>, _>>()?;
    PartReference::datum(machine, poses, &normals).map_err(|short| {
        let message = format!("the six datum points hold {} of the six motions of the part", short.rank);
        let help = "3-2-1: three points of a plane that are not on a line, two on a face across it, one across both";
        refuse(message, help)
    })
}

fn unit(vector: &[f64; 3], what: &str) -> Result<Vector3<f64>, Diagnostic> {
    unit_vector(&Vector3::from(*vector), what)
        .map_err(|_| refuse(format!("{what} is zero"), "a direction of any length but 0"))
}

/// Returns a vector of the part in the unturned workpiece frame.
fn unturned(machine: &Machine, reference: &Reference, vector: Vector3<f64>) -> Vector3<f64> {
    let vector = reference.place.direction(vector);
    machine.workpiece_rotation().map_or(vector, |rotation| rotation * vector)
}

/// Returns the pose (mm, deg) at which a machine probes a point of the part (mm).
fn probed(machine: &Machine, reference: &Reference, point: &[f64; 3]) -> Result<Pose, Diagnostic> {
    let tip = reference.place.point(Vector3::from(*point));
    let found = match &reference.rotary {
        Some(rotary) => {
            let pose = with_rotary(machine, rotary)?;
            place(machine, &tip, &pose).and_then(|placed| {
                if machine.beyond_travel(&placed).next().is_some() { Err(Miss::travel(placed)) } else { Ok(placed) }
            })
        }
        None => {
            let direction = unit(&reference.direction, "the direction of the tool at the reference")?;
            inverse(machine, &ToolPose::new(tip, reference.place.direction(direction)), &rest(machine))
        }
    };
    found.map_err(|miss| {
        let why = match miss.why {
            Unreachable::Direction => miss.why.words().to_owned(),
            _ => MissedToolPose::new(machine, (0, None), &miss, None).words(),
        };
        let place = point.map(|x| significant(x, 6)).join(", ");
        let message = format!("`{}` does not reach the reference point ({place}): {why}", machine.name());
        refuse(message, "state a point and a direction that the machine reaches, `--reference zero:X,Y,Z,I,J,K`")
    })
}

/// Returns the pose at rest with rotary axes at positions (deg).
fn with_rotary(machine: &Machine, rotary: &super::poses::AxisPositions) -> Result<Pose, Diagnostic> {
    let mut pose = rest(machine);
    for (index, axis) in machine.axes().iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Rotary) {
        pose[index] = rotary.get(axis.name.as_str()).copied().unwrap_or(0.0);
    }
    let unknown = rotary
        .keys()
        .find(|name| machine.axis_index(name).is_none_or(|index| machine.axes()[index].kind != AxisKind::Rotary));
    match unknown {
        Some(name) => Err(refuse(
            format!("the reference states a position of `{name}`, which is no rotary axis of the machine"),
            "state positions of rotary axes, or a direction of the tool",
        )),
        None => Ok(pose),
    }
}
