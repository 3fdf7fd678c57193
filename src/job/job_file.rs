//! A job: the tool poses of a part, where the part lies, and what its set-up takes out.

use super::characteristics::{FeatureEntries, FeatureTolerances, JobCharacteristics};
use super::placement::Placement;
use super::reference::{Reference, ReferenceEntry, SetUp};
use super::tool_poses::{self, ReachedToolPoses, ToolPoses};
use crate::diagnostic::{Diagnostic, Reason, codes, shown};
use crate::machine::{Machine, Pose};
use crate::run::{Call, Refused};
use crate::syntax::{from_yaml, read_text};
use std::path::{Path, PathBuf};

/// A job file.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct JobFile {
    /// The file of the tool poses, from the folder of the job file.
    tool_poses: PathBuf,
    /// Where the part lies on the workpiece frame.
    #[serde(default)]
    place: Placement,
    /// The reference: what the set-up takes out.
    reference: Option<ReferenceEntry>,
    /// True if the tool poses are one continuous path.
    path: Option<bool>,
    /// Name of the tool.
    tool: Option<String>,
    /// Tolerances of features.
    #[serde(default)]
    features: FeatureEntries,
}

/// A job on a machine.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    /// Its tool poses, workpiece frame.
    pub poses: ToolPoses,
    /// The tolerances of its features.
    pub features: FeatureTolerances,
    place: Placement,
    reference: Option<Reference>,
}

/// The files that make a job: of one of them at most the other is there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JobPaths<'a> {
    /// The job file.
    pub job: Option<&'a PathBuf>,
    /// The bare tool poses.
    pub tool_poses: Option<&'a PathBuf>,
    /// True if the tool poses are one path; by default what the job file says, or else of CL data alone.
    pub path: Option<bool>,
}

impl JobPaths<'_> {
    /// Reads the job for a machine, which gives the rotary columns their axes; `None` without files.
    pub(crate) fn read(self, call: &mut Call<'_>, machine: &Machine) -> Result<Option<Job>, Refused> {
        match (self.job, self.tool_poses) {
            (Some(_), Some(_)) => call.usage("a job file names its tool poses: omit one of the two"),
            (Some(path), None) => from_file(call, machine, path, self.path).map(Some),
            (None, Some(path)) => {
                let poses = tool_poses::read(call, machine, path)?.along(self.path);
                Ok(Some(Job {
                    poses,
                    features: FeatureTolerances::default(),
                    place: Placement::default(),
                    reference: None,
                }))
            }
            (None, None) if self.path.is_some() => {
                call.usage("`--path` is about tool poses: give `--job` or `--tool-poses`")
            }
            (None, None) => Ok(None),
        }
    }
}

impl Job {
    /// Returns the set-up of the part on a machine, which takes out what the options state, or else the job file, or
    /// else the zero at the part's origin, and without a job nothing; a best fit is over the poses (mm, deg).
    pub(crate) fn set_up(
        job: Option<&Self>,
        call: &mut Call<'_>,
        machine: &Machine,
        asked: Option<&Reference>,
        poses: &[Pose],
    ) -> Result<SetUp, Refused> {
        let (stated, default) = (Self::stated(job, asked), job.map(Self::zero));
        SetUp::of(call, machine, stated.as_ref(), default.as_ref(), poses)
    }

    /// Returns the characteristics of toleranced features on the tool poses that a machine reaches; `None` without.
    pub(crate) fn characteristics(
        job: Option<&Self>,
        call: &mut Call<'_>,
        machine: &Machine,
        reached: Option<&ReachedToolPoses>,
    ) -> Result<Option<JobCharacteristics>, Refused> {
        let (Some(job), Some(reached)) = (job, reached) else { return Ok(None) };
        JobCharacteristics::of(call, machine, &job.features, reached)
    }

    /// Returns what the options state, or else the job file, on the part where it lies.
    pub(crate) fn stated(job: Option<&Self>, asked: Option<&Reference>) -> Option<Reference> {
        let place = job.map_or_else(Placement::default, |job| job.place);
        let stated = asked.or_else(|| job?.reference.as_ref())?;
        Some(stated.clone().placed(place))
    }

    /// Returns the zero at the part's origin.
    pub(crate) fn zero(&self) -> Reference {
        Reference::zero().placed(self.place)
    }
}

/// Reads a job file; `asked` says whether its tool poses are one path, whatever it says itself.
fn from_file(call: &mut Call<'_>, machine: &Machine, path: &Path, asked: Option<bool>) -> Result<Job, Refused> {
    let files = call.run.files;
    let Some((_, text)) = read_text(path, None, files, &mut call.diagnostics) else { return Err(Refused) };
    let JobFile { tool_poses, place, reference, path: is_path, tool, features } = match from_yaml::<JobFile>(&text) {
        Ok(file) => file,
        Err(failure) => return call.refuse(refused(path, &Reason::new(failure))),
    };
    if let Some(tool) = tool.filter(|tool| *tool != machine.tool().name) {
        let message = format!("the job is for the tool `{}`", shown(&tool));
        return call.refuse(refused(path, &Reason::new(message)).help(format!("choose it: `--tool {}`", shown(&tool))));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut poses = tool_poses::read(call, machine, &folder.join(tool_poses))?.along(asked.or(is_path));
    poses.put(&place);
    let features = features.placed(place).or_else(|reason| call.refuse(refused(path, &reason)))?;
    Ok(Job { poses, features, place, reference: reference.map(|ReferenceEntry(reference)| reference) })
}

fn refused(path: &Path, failure: &Reason) -> Diagnostic {
    let message = format!("`{}`: {}", shown(&path.display().to_string()), shown(&failure.to_string()));
    let help = "a job has `tool_poses`, and may have `place`, `reference`, `path`, `tool` and `features`; \
                docs/formats/jobs.md has an example";
    Diagnostic::new(codes::E0851, message).help(help)
}
