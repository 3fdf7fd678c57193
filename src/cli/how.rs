//! How a machine is compensated: the options that `compile`, `verify`, `diff`, `map` and `report` share.

use super::output::session::Session;
use super::{Exit, Outcome};
use crate::compensation::{Fit, Goal, Scope, Stored};
use crate::controller::{Certificate, ControllerTarget, Depth, JudgedTables, certify, is_plain_name};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::Machine;
use crate::syntax::Disk;
use std::path::{Path, PathBuf};

/// Options that `compile` and `verify` share.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub how: CompensationOptions,
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
pub(super) struct CompensationOptions {
    /// What is corrected: the position (a lattice's default), or the position and the direction of the tool axis (a kinematics module's).
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
    pub stored: Option<StoredArg>,
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

impl StoredArg {
    fn word(self) -> &'static str {
        match self {
            Self::Correction => "stored correction",
            Self::Error => "stored error",
        }
    }

    /// What the manifest of a set says.
    pub(super) fn of(options: &[String]) -> Option<Self> {
        [Self::Correction, Self::Error].into_iter().find(|arg| options.iter().any(|o| o == arg.word()))
    }
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

/// Below this sine of the angle from a singular pose the rotary axes' correction is bounded: lattice
/// cells are about 15 deg wide, and what changes faster than that cannot be interpolated.
const LATTICE_DAMPING: f64 = 0.15;

impl Options {
    /// What the tables leave, at the poses asked for.
    pub(super) fn certificate(&self, machine: &Machine, judged: JudgedTables) -> Certificate {
        certify(machine, judged, self.how.scope(), self.poses as usize, self.seed)
    }

    /// The same of a kinematics module.
    pub(super) fn depth(&self) -> Depth {
        Depth { poses: self.poses as usize, seed: self.seed }
    }
}

impl CompensationOptions {
    pub(super) fn scope(&self) -> Scope {
        let (goal, usual) = match self.correct.unwrap_or(GoalArg::Position) {
            GoalArg::Position => (Goal::Position, WithArg::Linear),
            GoalArg::Pose => (Goal::Pose, WithArg::All),
        };
        Scope { goal, rotary: self.with.unwrap_or(usual) == WithArg::All, damping: LATTICE_DAMPING }
    }

    /// Does a kinematics module correct the direction of the tool axis too?
    pub(super) fn orientation(&self) -> bool {
        self.correct != Some(GoalArg::Position) && self.with != Some(WithArg::Linear)
    }

    /// What is written into the manifest of a set.
    pub(super) fn words(&self) -> Vec<String> {
        let scope = self.scope();
        let goal = if scope.goal == Goal::Pose { "pose" } else { "position" };
        let mut words =
            vec![format!("correct {goal}"), format!("with {} axes", if scope.rotary { "all" } else { "linear" })];
        words.extend(self.stored.map(|stored| stored.word().to_owned()));
        words.extend(self.without.iter().map(|kind| format!("without {kind}")));
        words.extend(self.fit.map(|fit| match fit {
            FitArg::Axis => "fit axis".to_owned(),
            FitArg::FunctionalPoint => "fit functional-point".to_owned(),
        }));
        words
    }

    /// Names of the folders of targets of one's own.
    pub(super) fn own_targets(&self) -> Vec<String> {
        let entries = self.templates.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
        let with_manifest = entries.filter(|entry| entry.path().join("target.yaml").is_file());
        let mut names: Vec<String> = with_manifest.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.retain(|name| is_plain_name(name));
        names.sort();
        names
    }

    /// The target of a name, its stored numbers meaning what is asked for.
    pub(super) fn target(
        &self,
        session: &mut Session,
        name: &str,
        stored: Option<StoredArg>,
    ) -> Result<ControllerTarget, Exit> {
        if let Some(folder) = self.templates.as_deref().filter(|_| is_plain_name(name)) {
            refuse_links(session, &folder.join(name))?;
        }
        let target = ControllerTarget::find(name, self.templates.as_deref(), &Disk, &mut session.diagnostics);
        let mut target = target.ok_or(Exit::Refused)?;
        match stored.or(self.stored) {
            Some(StoredArg::Correction) => target.manifest.mechanism.store(Stored::Correction),
            Some(StoredArg::Error) => target.manifest.mechanism.store(Stored::Error),
            None => {}
        }
        for kind in &self.without {
            if !target.manifest.mechanism.leave_out(kind) {
                return session.usage(&format!(
                    "--without: the target `{name}` has no tables `{}`, or none besides",
                    kind.escape_debug()
                ));
            }
        }
        match self.fit {
            Some(FitArg::Axis) => target.manifest.mechanism.fit(Fit::Axis),
            Some(FitArg::FunctionalPoint) => target.manifest.mechanism.fit(Fit::FunctionalPoint),
            None => {}
        }
        Ok(target)
    }
}

/// A link in a target's folder would carry a file from anywhere into the set.
fn refuse_links(session: &mut Session, folder: &Path) -> Outcome {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut links = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()));
    let Some(link) = links.next() else { return Ok(()) };
    let message = format!("`{}` is a link", shown(&link.path().display().to_string()));
    session.refuse(Diagnostic::new(codes::E0703, message).help("copy the file: a target's folder holds its own files"))
}
