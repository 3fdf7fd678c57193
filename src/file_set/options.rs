//! Options of the compensation of a machine: `compile`, `verify`, `diff`, `map` and `report` share them.

use crate::compensation::{DriveScale, Fit, Goal, Scope, Stored};
use crate::controller::{ControllerTarget, Lock, TemplateWatch, is_plain_name};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{AxisName, ControllerAxis};
use crate::run::{Call, Refused};
use crate::syntax::{EntryKind, Files};
use crate::units::number;
use std::path::{Path, PathBuf};

/// Options of the compensation of a machine.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct CompensationOptions {
    /// Goal of the correction; by default the position for tables, the pose for a kinematics module.
    pub correct: Option<Goal>,
    /// Axes that correct. By default the linear ones for the position, all for the pose.
    pub with: Option<CorrectingAxes>,
    /// A folder with targets of one's own, each a folder with a `target.yaml`.
    pub templates: Option<PathBuf>,
    /// Meaning of stored numbers, `correction` or `error`, where the manual does not state it; by default the
    /// manifest's.
    pub stored: Option<Stored>,
    /// Kinds of tables to leave out although the controller has them: product, plane, cross_axis, own_axis.
    pub without: Vec<String>,
    /// Content of own-axis tables; by default the manifest's.
    pub fit: Option<Fit>,
    /// Letters and numbers of axes in the controller, such as `A=AX6` or `X1=U`, over those of the machine file.
    pub map: Vec<String>,
    /// Scales of drives in force when the machine was measured, such as `X=80`: steps in a mm, or mm in a turn. Without
    /// it, and without the control's own settings among the files in force, no scale is written.
    pub scale: Vec<String>,
    /// What bounds the time of templates.
    #[serde(skip)]
    pub watch: TemplateWatch,
}

/// Axes that correct.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum CorrectingAxes {
    /// The linear axes.
    Linear,
    /// All axes.
    All,
}

/// Sine of the angle from a singular pose below which the rotary axes' correction is bounded: lattice cells are about
/// 15 deg wide, and faster changes cannot be interpolated.
const LATTICE_DAMPING: f64 = 0.15;

/// The word for a meaning of stored numbers in the manifest of a set.
fn stored_word(stored: Stored) -> &'static str {
    match stored {
        Stored::Correction => "stored correction",
        Stored::Error => "stored error",
        Stored::Command => "stored command",
    }
}

/// Returns the meaning of stored numbers that the manifest of a set states.
fn stored_of(options: &[String]) -> Option<Stored> {
    let known = [Stored::Correction, Stored::Error];
    known.into_iter().find(|stored| options.iter().any(|option| option == stored_word(*stored)))
}

/// The word for a goal in the manifest of a set.
fn goal_word(goal: Goal) -> &'static str {
    match goal {
        Goal::Position => "correct position",
        Goal::Pose => "correct pose",
    }
}

/// Returns the goal that the manifest of a set states.
fn goal_of(options: &[String]) -> Option<Goal> {
    [Goal::Position, Goal::Pose].into_iter().find(|goal| options.iter().any(|option| option == goal_word(*goal)))
}

/// The word for axes that correct in the manifest of a set.
fn axes_word(axes: CorrectingAxes) -> &'static str {
    match axes {
        CorrectingAxes::Linear => "with linear axes",
        CorrectingAxes::All => "with all axes",
    }
}

/// Returns the axes that correct by the manifest of a set.
fn axes_of(options: &[String]) -> Option<CorrectingAxes> {
    let known = [CorrectingAxes::Linear, CorrectingAxes::All];
    known.into_iter().find(|axes| options.iter().any(|option| option == axes_word(*axes)))
}

/// What the manifest of a set says before an entry of [`CompensationOptions::map`].
const MAP: &str = "map ";

/// Reads entries such as `A=AX6`; one axis may have a letter and a number. `Err`: the entry that is none.
fn axis_words(map: &[String]) -> Result<Vec<(String, ControllerAxis)>, &String> {
    let mut all: Vec<(String, ControllerAxis)> = Vec::new();
    for entry in map {
        let read = || entry.split_once('=').and_then(|(name, word)| Some((name, ControllerAxis::parse(word)?)));
        let read = || read().filter(|(name, _)| AxisName::new(name).is_some());
        let (name, word) = read().ok_or(entry)?;
        match all.iter_mut().find(|(known, _)| known == name) {
            Some((_, words)) => *words = words.and(word).ok_or(entry)?,
            None => all.push((name.to_owned(), word)),
        }
    }
    Ok(all)
}

/// A reason for which an entry is no scale of a drive.
#[derive(Debug, thiserror::Error)]
enum ScaleFailure {
    #[error("`{0}` has no `=`: {1}, such as `X=80.5,Y=80`")]
    NoAxis(String, &'static str),
    /// A name, and the one that was meant.
    #[error("`{0}` is no name of an axis{1}")]
    NotAxis(String, String),
    #[error("`{0}` is not a number from {least} to {most}", least = DriveScale::RANGE[0], most = DriveScale::RANGE[1])]
    NotNumber(String),
    #[error("`{0}` is there twice")]
    Twice(String),
}

/// Reads entries such as `X=80`.
fn scales(entries: &[String]) -> Result<Vec<(String, f64)>, ScaleFailure> {
    let [least, most] = DriveScale::RANGE;
    let mut all: Vec<(String, f64)> = Vec::new();
    for entry in entries {
        let shown = entry.escape_debug().to_string();
        let Some((name, value)) = entry.split_once('=') else {
            let is_fraction = !all.is_empty() && entry.parse::<u64>().is_ok();
            let why = if is_fraction { "decimals have a point, commas part the axes" } else { "name its axis" };
            return Err(ScaleFailure::NoAxis(shown, why));
        };
        let Some(axis) = AxisName::new(name).map(|axis| axis.to_string()) else {
            let capital = name.to_uppercase();
            let near = AxisName::new(&capital).map_or_else(String::new, |_| format!("; did you mean `{capital}`?"));
            return Err(ScaleFailure::NotAxis(name.escape_debug().to_string(), near));
        };
        let value = number(value).ok().filter(|value| (least..=most).contains(value));
        let value = value.ok_or(ScaleFailure::NotNumber(shown))?;
        if all.iter().any(|(known, _)| *known == axis) {
            return Err(ScaleFailure::Twice(axis));
        }
        all.push((axis, value));
    }
    Ok(all)
}

impl CompensationOptions {
    /// These options, and what the manifest of a set states where they do not.
    pub(crate) fn as_in(&self, lock: Option<&Lock>) -> Self {
        let Some(lock) = lock else { return self.clone() };
        let of_lock = || lock.options.iter().filter_map(|option| option.strip_prefix(MAP)).map(str::to_owned);
        let map = if self.map.is_empty() { of_lock().collect() } else { self.map.clone() };
        // What corrects by what goes together.
        let (correct, with) = match (self.correct, self.with) {
            (None, None) => (goal_of(&lock.options), axes_of(&lock.options)),
            stated => stated,
        };
        Self { correct, with, stored: self.stored.or_else(|| stored_of(&lock.options)), map, ..self.clone() }
    }

    pub(crate) fn scope(&self) -> Scope {
        let goal = self.correct.unwrap_or(Goal::Position);
        let usual = if goal == Goal::Pose { CorrectingAxes::All } else { CorrectingAxes::Linear };
        Scope { goal, rotary: self.with.unwrap_or(usual) == CorrectingAxes::All, damping: LATTICE_DAMPING }
    }

    /// True if a kinematics module corrects the direction of the tool axis too.
    pub(crate) fn orientation(&self) -> bool {
        self.correct != Some(Goal::Position) && self.with != Some(CorrectingAxes::Linear)
    }

    /// Returns the options of a kinematics module as the manifest of its set states them.
    pub(crate) fn module_words(&self) -> Vec<String> {
        vec![goal_word(if self.orientation() { Goal::Pose } else { Goal::Position }).to_owned()]
    }

    /// Returns the options of tables as the manifest of their set states them.
    pub(crate) fn words(&self) -> Vec<String> {
        let scope = self.scope();
        let axes = if scope.rotary { CorrectingAxes::All } else { CorrectingAxes::Linear };
        let mut words = vec![goal_word(scope.goal).to_owned(), axes_word(axes).to_owned()];
        words.extend(self.stored.map(|stored| stored_word(stored).to_owned()));
        words.extend(self.without.iter().map(|kind| format!("without {kind}")));
        words.extend(self.map.iter().map(|entry| format!("{MAP}{entry}")));
        words.extend(self.scale.iter().map(|entry| format!("scale {entry}")));
        words.extend(self.fit.map(|fit| match fit {
            Fit::Axis => "fit axis".to_owned(),
            Fit::FunctionalPoint => "fit functional-point".to_owned(),
        }));
        words
    }

    /// Returns the names of the targets in the user's folder, sorted.
    pub(crate) fn own_targets(&self, files: &dyn Files) -> Vec<String> {
        let Some(folder) = &self.templates else { return Vec::new() };
        let has_manifest = |name: &String| {
            let entries = files.entries(&folder.join(name));
            entries.iter().any(|entry| entry.name == "target.yaml" && entry.kind != EntryKind::Other)
        };
        let names = files.entries(folder).into_iter().map(|entry| entry.name);
        names.filter(|name| is_plain_name(name) && has_manifest(name)).collect()
    }

    /// Finds a target by name and adapts it to the options.
    pub(crate) fn target(&self, call: &mut Call, name: &str) -> Result<ControllerTarget, Refused> {
        if let Some(folder) = self.templates.as_deref().filter(|_| is_plain_name(name)) {
            refuse_links(call, &folder.join(name))?;
        }
        let target = ControllerTarget::find(name, self.templates.as_deref(), call.run.files, &mut call.diagnostics);
        let mut target = target.ok_or(Refused)?;
        target.watch = self.watch.clone();
        if let Some(stored) = self.stored {
            target.manifest.mechanism.store(stored);
        }
        for kind in &self.without {
            if !target.manifest.mechanism.leave_out(kind) {
                let kind = kind.escape_debug();
                return call.usage(format!("--without: the target `{name}` has no tables `{kind}`, or no others"));
            }
        }
        if let Some(fit) = self.fit {
            target.manifest.mechanism.fit(fit);
        }
        if !self.scale.is_empty() {
            let in_force = scales(&self.scale).or_else(|why| call.usage(format!("--scale: {why}")))?;
            if target.manifest.mechanism.scale().is_none() {
                return call.usage(format!("--scale: the target `{name}` has no scale of drives in its files"));
            }
            target.manifest.mechanism.own_axis.iter_mut().for_each(|own| own.in_force.clone_from(&in_force));
        }
        let given = match axis_words(&self.map) {
            Ok(given) => given,
            Err(entry) => {
                let (entry, expected) = (entry.escape_debug(), ControllerAxis::EXPECTED);
                return call.usage(format!("--map: `{entry}` is not an axis, `=` and {expected}"));
            }
        };
        target.manifest.axis_letters.iter_mut().for_each(|letters| letters.given.clone_from(&given));
        Ok(target)
    }
}

/// A link in a target's folder would carry a file from anywhere into the set.
fn refuse_links(call: &mut Call, folder: &Path) -> Result<(), Refused> {
    let entries = call.run.files.entries(folder);
    let Some(link) = entries.iter().find(|entry| entry.kind == EntryKind::Link) else { return Ok(()) };
    let message = format!("`{}` is a link", shown(&folder.join(&link.name).display().to_string()));
    call.refuse(Diagnostic::new(codes::E0703, message).help("copy the file: a target's folder holds its own files"))
}
