//! How a machine is compensated: the options that `compile`, `verify`, `diff`, `map` and `report` share.

use abbe::options::{CompensationOptions, CorrectingAxes, Fit, Goal, Stored};
use std::path::PathBuf;

/// Options that `compile` and `verify` share.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct SetArgs {
    #[command(flatten)]
    pub how: CompensationArgs,
    /// Which of the machine's tools.
    #[arg(long)]
    pub tool: Option<String>,
    /// Poses of the certificate.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub poses: u32,
    /// Seed of the certificate's poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// How a machine is compensated.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct CompensationArgs {
    /// What is corrected: the position (a lattice's default), or the position and the direction of the tool axis (a
    /// kinematics module's).
    #[arg(long, value_enum)]
    correct: Option<GoalArg>,
    /// With which axes; linear by default for the position, all for the pose.
    #[arg(long, value_enum)]
    with: Option<WithArg>,
    /// A folder with targets of your own.
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// What stored numbers mean, where the manual does not say it; by default what `abbe targets` says.
    #[arg(long, value_enum)]
    stored: Option<StoredArg>,
    /// Leave out tables of one kind that the controller would have: product, plane, cross_axis, own_axis.
    #[arg(long, value_name = "KIND")]
    without: Vec<String>,
    /// What own-axis tables are made for: the axis's own error at its origin, or the deviation of the functional point.
    #[arg(long, value_enum)]
    fit: Option<FitArg>,
}

/// What own-axis tables are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FitArg {
    Axis,
    FunctionalPoint,
}

/// The meaning of stored numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum StoredArg {
    /// Added to the command.
    Correction,
    /// Actual minus nominal; the controller subtracts it.
    Error,
}

/// What is corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum GoalArg {
    Position,
    Pose,
}

/// Which axes correct.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum WithArg {
    Linear,
    All,
}

impl CompensationArgs {
    /// Options of the library.
    pub(super) fn options(&self) -> CompensationOptions {
        CompensationOptions {
            correct: self.correct.map(|goal| match goal {
                GoalArg::Position => Goal::Position,
                GoalArg::Pose => Goal::Pose,
            }),
            with: self.with.map(|axes| match axes {
                WithArg::Linear => CorrectingAxes::Linear,
                WithArg::All => CorrectingAxes::All,
            }),
            templates: self.templates.clone(),
            stored: self.stored.map(|stored| match stored {
                StoredArg::Correction => Stored::Correction,
                StoredArg::Error => Stored::Error,
            }),
            without: self.without.clone(),
            fit: self.fit.map(|fit| match fit {
                FitArg::Axis => Fit::Axis,
                FitArg::FunctionalPoint => Fit::FunctionalPoint,
            }),
        }
    }
}
