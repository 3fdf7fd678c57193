//! The statement of what a result is over: a volume or a job, its reference, its poses, its tool.

use super::reference::{Reference, ReferenceKind};
use super::tool_poses::{ReachedToolPoses, ToolPoses};
use crate::machine::Machine;
use crate::units::{counted, fold};

/// What poses are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OverKind {
    /// The volume of the machine.
    Volume,
    /// The tool poses of a part.
    Job,
    /// Poses of the axes.
    AxisPoses,
}

impl OverKind {
    /// Returns that of the rows of a file: poses of the axes, or tool poses.
    fn of_rows(are_axes: bool) -> Self {
        if are_axes { Self::AxisPoses } else { Self::Job }
    }
}

/// What a result is over.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Over {
    /// A volume, a job, or poses of the axes.
    pub kind: OverKind,
    /// Motion that the part's set-up takes out.
    pub reference: ReferenceKind,
    /// True if the best fit is the minimum zone.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub minimum_zone: bool,
    /// True if the poses are one continuous path.
    pub path: bool,
    /// Number of poses asked for.
    pub poses: usize,
    /// Number of poses that are reached.
    pub reached: usize,
    /// Name of the tool; empty where the machine has one without a name.
    pub tool: String,
    /// The reference in words.
    #[serde(skip)]
    words: String,
}

impl Over {
    /// Returns the statement for poses of a machine, single ones.
    pub(crate) fn new(kind: OverKind, machine: &Machine, reference: &Reference, [poses, reached]: [usize; 2]) -> Self {
        let (tool, words) = (machine.tool().name.clone(), reference.to_string());
        let minimum_zone = reference.is_minimum_zone();
        Self { kind, reference: reference.kind, minimum_zone, path: false, poses, reached, tool, words }
    }

    /// Returns the same statement for poses of one path, or for single ones.
    pub(crate) fn along(self, path: bool) -> Self {
        Self { path, ..self }
    }

    /// Returns the statement for the tool poses that machines have in common: of a job, or else of the volume of the
    /// first.
    pub(crate) fn common(first: &Machine, reference: &Reference, job: Option<&ToolPoses>, counts: [usize; 2]) -> Self {
        let kind = job.map_or(OverKind::Volume, |job| OverKind::of_rows(job.are_axes()));
        Self::new(kind, first, reference, counts).along(job.is_some_and(ToolPoses::is_path))
    }

    /// Returns the statement for the tool poses of a job, or else for a number of poses of the volume.
    pub(crate) fn work(
        machine: &Machine,
        reference: &Reference,
        tool_poses: Option<&ReachedToolPoses>,
        count: usize,
    ) -> Self {
        match tool_poses {
            Some(of) => {
                let kind = OverKind::of_rows(of.of_axes);
                Self::new(kind, machine, reference, [of.asked, of.reached]).along(of.path.is_some())
            }
            None => Self::new(OverKind::Volume, machine, reference, [count, count]),
        }
    }

    /// Returns the reference in words, such as `machine coordinates`.
    pub fn reference_words(&self) -> &str {
        &self.words
    }

    /// Returns the statement as text for a terminal of 80 columns, its end on a line of its own where it is longer.
    pub fn text(&self) -> String {
        fold(&self.line())
    }

    /// Returns the statement in one line, such as `Over a job of 300 tool poses, 298 reached, single poses; reference:
    /// zero at (0, 0, 0) along (0, 0, 1); tool: short`.
    pub fn line(&self) -> String {
        let path = if self.path { "one path" } else { "single poses" };
        let of = match self.kind {
            OverKind::Volume if self.reached < self.poses => {
                format!("the volume, {}, {} reached", counted(self.poses, "pose"), self.reached)
            }
            OverKind::Volume => format!("the volume, {}", counted(self.poses, "pose")),
            OverKind::Job => {
                format!("a job of {}, {} reached, {path}", counted(self.poses, "tool pose"), self.reached)
            }
            OverKind::AxisPoses if self.reached < self.poses => {
                format!("{} of the axes, {} reached, {path}", counted(self.poses, "pose"), self.reached)
            }
            OverKind::AxisPoses => format!("{} of the axes, {path}", counted(self.poses, "pose")),
        };
        let tool = if self.tool.is_empty() { "that of the file" } else { &self.tool };
        format!("Over {of}; reference: {}; tool: {tool}", self.words)
    }
}
