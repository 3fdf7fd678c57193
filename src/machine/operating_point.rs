//! What the errors of a machine may depend on: the positions of its axes, and the conditions in which it stands there.

/// The side from which a position is approached; curves may differ (reversal).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Approach {
    /// The mean of forward and reverse.
    #[default]
    Mean,
    /// Rising position.
    Forward,
    /// Falling position.
    Reverse,
}

/// Quantities besides positions on which errors may depend, as temperatures and loads: one value for each name.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OperatingState {
    /// Values in the order of [`Self::NAMES`].
    pub values: [f64; Self::NAMES.len()],
}

impl OperatingState {
    /// Names of the quantities: none yet.
    pub const NAMES: [&'static str; 0] = [];
}

/// What poses have in common that are evaluated together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OperatingConditions {
    /// Side from which the axes approach the poses.
    pub approach: Approach,
    /// Quantities besides positions.
    pub state: OperatingState,
}

impl From<Approach> for OperatingConditions {
    fn from(approach: Approach) -> Self {
        Self { approach, state: OperatingState::default() }
    }
}

impl OperatingConditions {
    /// Returns the conditions with the poses approached from the other side.
    pub fn reversed(self) -> Self {
        Self { approach: self.approach.opposite(), ..self }
    }

    /// Returns the operating point at a pose (mm, deg).
    pub fn at_pose(self, axes: &[f64]) -> OperatingPoint<'_> {
        OperatingPoint { axes, conditions: self }
    }

    /// Returns what a curve depends on at a position (mm or deg) of its axis, with the other axes at 0.
    pub fn at_position(self, position: f64) -> CurveArgument<'static> {
        CurveArgument { position, at: self.at_pose(&[]) }
    }
}

impl Approach {
    /// Returns the other side; the mean is its own.
    pub fn opposite(self) -> Self {
        match self {
            Self::Mean => Self::Mean,
            Self::Forward => Self::Reverse,
            Self::Reverse => Self::Forward,
        }
    }

    /// Returns the operating point at a pose (mm, deg) approached from this side.
    pub fn at_pose(self, axes: &[f64]) -> OperatingPoint<'_> {
        OperatingConditions::from(self).at_pose(axes)
    }

    /// Returns what a curve depends on at a position (mm or deg) of its axis approached from this side, with the other
    /// axes at 0.
    pub fn at_position(self, position: f64) -> CurveArgument<'static> {
        OperatingConditions::from(self).at_position(position)
    }
}

/// A machine at a pose, in its conditions: what errors, fields and lowering are evaluated at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint<'a> {
    /// Positions as programmed (mm, deg), in the order of [`Machine::axes`](super::Machine::axes).
    pub axes: &'a [f64],
    /// Side of approach and state.
    pub conditions: OperatingConditions,
}

impl<'a> OperatingPoint<'a> {
    /// Returns the position (mm or deg) of the axis with this index; 0 for a joint that does not move.
    pub fn position(&self, axis: usize) -> f64 {
        self.axes.get(axis).copied().unwrap_or_default()
    }

    /// Returns what the curves of the axis with this index depend on.
    pub fn argument(&self, axis: usize) -> CurveArgument<'a> {
        CurveArgument { position: self.position(axis), at: *self }
    }
}

/// An operating point as the curves of one axis see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveArgument<'a> {
    /// Position of their own axis (mm or deg).
    pub position: f64,
    /// The whole operating point; axes that it does not list stand at 0.
    pub at: OperatingPoint<'a>,
}

/// A position (mm or deg) as the argument of a curve that depends on nothing else.
impl From<f64> for CurveArgument<'_> {
    fn from(position: f64) -> Self {
        OperatingConditions::default().at_position(position)
    }
}

impl<'a> From<&Self> for CurveArgument<'a> {
    fn from(argument: &Self) -> Self {
        *argument
    }
}
