//! A job: the tool poses of a part, where the part lies, and what its set-up takes out.

use super::characteristics::{FeatureEntries, FeatureTolerances, JobCharacteristics};
use super::limit::JobLimit;
use super::machine_file::MachineFile;
use super::numbers::part_length;
use super::placement::Placement;
use super::reference::{Reference, SetUp};
use super::reference_text::WrittenReference;
use super::tool_poses::{self, ReachedToolPoses, ToolPoses};
use crate::analysis::budget::Statistic;
use crate::diagnostic::{Diagnostic, Place, codes, shown};
use crate::machine::{Machine, Pose};
use crate::run::{Call, Refused};
use crate::syntax::{JobText, Scalar, TOOL_POSES, read_job};
use std::path::Path;

/// The word in place of a file that leaves the job of a machine file out.
pub(crate) const NO_JOB: &str = "none";

/// A job file, or the job of a machine file.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct JobFile {
    /// The file of the tool poses, from the folder of the job file.
    tool_poses: String,
    /// Where the part lies on the workpiece frame.
    #[serde(default)]
    place: Placement,
    /// The reference: what the set-up takes out.
    reference: Option<WrittenReference>,
    /// True if the tool poses are one continuous path.
    path: Option<bool>,
    /// Name of the tool.
    tool: Option<String>,
    /// Limit of the 95 % value of the position deviation.
    limit: Option<Scalar>,
    /// Tolerances of features.
    #[serde(default)]
    features: FeatureEntries,
}

/// A job on a machine.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    /// Its tool poses, workpiece frame.
    pub poses: ToolPoses,
    /// Limit of the 95 % value of the position deviation, mm.
    pub limit_mm: Option<f64>,
    /// The tolerances of its features.
    pub features: FeatureTolerances,
    place: Placement,
    reference: Option<Reference>,
    /// The place at which the reference is stated.
    reference_written: Option<Place>,
}

/// The files that make a job: at most one of them is there. Without all the job of the machine file counts.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JobPaths<'a> {
    /// The job file, or [`NO_JOB`].
    pub job: Option<&'a Path>,
    /// The bare tool poses.
    pub tool_poses: Option<&'a Path>,
    /// Poses of the axes, which are a job without a part.
    pub axis_poses: Option<&'a Path>,
    /// True if the tool poses are one path; by default what the job file says, or else of CL data alone.
    pub path: Option<bool>,
}

impl<'a> JobPaths<'a> {
    /// Reads the job for a machine, which gives the rotary columns their axes; `None` without one. Says if the job of
    /// the machine file gives way.
    pub(crate) fn read(self, call: &mut Call<'_>, file: &MachineFile) -> Result<Option<Job>, Refused> {
        Ok(self.read_unplaced(call, file)?.map(UnplacedJob::placed))
    }

    /// Reads the job for several machines. The first gives the rotary columns their axes, and its own job if no other
    /// is asked for. Says which jobs of the others give way.
    pub(crate) fn read_common(self, call: &mut Call<'_>, files: &'a [MachineFile]) -> Result<Option<Job>, Refused> {
        let [first, others @ ..] = files else { return Ok(None) };
        let job = self.read(call, first)?;
        call.extend(self.displaced_jobs(first, others));
        Ok(job)
    }

    /// Returns the warnings of machine files whose jobs give way where machines are compared on one work: that asked
    /// for, or else that of the first.
    pub(crate) fn displaced_jobs(
        self,
        first: &'a MachineFile,
        others: &'a [MachineFile],
    ) -> impl Iterator<Item = Diagnostic> + 'a {
        let asked = self.job.or(self.tool_poses).or(self.axis_poses);
        let by = match (asked, &first.job) {
            (Some(path), _) => format!("`{}`", path.display()),
            (None, Some(_)) => format!("that of `{}`", first.path()),
            (None, None) => format!("the volume of `{}`", first.path()),
        };
        let same = first.job.as_ref().filter(|_| asked.is_none());
        let differs = move |own: &JobText| same.is_none_or(|same| !same.equals(own));
        let others = others.iter().filter(move |_| asked != Some(Path::new(NO_JOB)));
        others.filter(move |file| file.job.as_ref().is_some_and(&differs)).map(move |file| displaced(file, &by))
    }

    /// Reads the same with the part not yet on the workpiece frame.
    pub(crate) fn read_unplaced(self, call: &mut Call<'_>, file: &MachineFile) -> Result<Option<UnplacedJob>, Refused> {
        let job = self.job.filter(|path| *path != Path::new(NO_JOB));
        let own = file.job.is_some() && (self.job.is_none() || job.is_some());
        match (job, self.tool_poses, self.axis_poses) {
            (Some(_), Some(_), _) => call.usage("a job file names its tool poses: omit one of the two"),
            (_, Some(_), Some(_)) | (Some(_), _, Some(_)) => {
                call.usage("poses of the axes take the place of a job and of tool poses: give one of them")
            }
            (Some(path), None, None) => {
                call.extend(own.then(|| displaced(file, &format!("`{}`", path.display()))));
                from_file(call, file, path, self.path).map(Some)
            }
            (None, Some(path), None) | (None, None, Some(path)) => {
                call.extend(own.then(|| displaced(file, &format!("`{}`", path.display()))));
                let read = if self.axis_poses.is_some() { tool_poses::read_axes } else { tool_poses::read };
                let poses = read(call, file, path)?.along(self.path);
                let (features, place) = (FeatureTolerances::default(), Placement::default());
                let (limit_mm, reference, reference_written) = (None, None, None);
                Ok(Some(UnplacedJob(Job { poses, limit_mm, features, place, reference, reference_written })))
            }
            (None, None, None) if own => from_machine_file(call, file, self.path),
            (None, None, None) if self.path.is_some() => {
                call.usage("`--path` is about tool poses: give `--job` or `--tool-poses`")
            }
            (None, None, None) => Ok(None),
        }
    }
}

/// The warning of a machine file whose job gives way to another: `by`, such as `` `part.yaml` ``.
fn displaced(file: &MachineFile, by: &str) -> Diagnostic {
    let help = if by.starts_with('`') {
        "omit `--job` and `--tool-poses` for the job of the machine file"
    } else {
        "machines are compared on one work: that of the first, or what `--job` and `--tool-poses` name"
    };
    let message = format!("the job of `{}` gives way to {}", shown(file.path()), shown(by));
    Diagnostic::new(codes::W0852, message).help(help)
}

/// A job whose tool poses are in part coordinates.
#[derive(Debug, Clone)]
pub(crate) struct UnplacedJob(Job);

impl UnplacedJob {
    /// Returns the job with the part at its own place.
    fn placed(mut self) -> Job {
        self.0.poses.put(&self.0.place);
        self.0
    }

    /// Returns the place that the job states.
    pub(crate) fn place(&self) -> Placement {
        self.0.place
    }

    /// Returns the tool poses, part coordinates.
    pub(crate) fn poses(&self) -> &ToolPoses {
        &self.0.poses
    }

    /// Returns the job with the part at another place; its reference moves along, tolerances are left out.
    pub(crate) fn at(&self, place: Placement) -> Job {
        Self(Job { place, features: FeatureTolerances::default(), ..self.0.clone() }).placed()
    }
}

impl Job {
    /// Returns the limit of a job on a machine that reaches these tool poses.
    pub(crate) fn limit(
        job: Option<&Self>,
        statistic: Statistic,
        reached: Option<&ReachedToolPoses>,
    ) -> Option<JobLimit> {
        let missed = reached.map_or(0, |reached| reached.asked - reached.reached);
        job?.limit_mm.map(|mm| JobLimit { mm, statistic, missed, is_partial: false })
    }

    /// Returns the set-up of the part on a machine, which takes out what the options state, or else the job file, or
    /// else the zero at the part's origin, and without a part the motions that the data behind the errors do not hold;
    /// fits are over the poses (mm, deg).
    pub(crate) fn set_up(
        job: Option<&Self>,
        call: &mut Call<'_>,
        machine: &Machine,
        asked: Option<&Reference>,
        poses: &[Pose],
    ) -> Result<SetUp, Refused> {
        match (Self::stated(job, asked), job.filter(|job| job.has_part())) {
            (Some(stated), _) => {
                SetUp::new(machine, &stated, poses).or_else(|refusal| call.refuse(Self::located(job, asked, refusal)))
            }
            (None, Some(job)) => SetUp::by_default(call, machine, &job.zero(), poses),
            (None, None) => Ok(SetUp::less_unheld(machine, machine.unheld(), poses)),
        }
    }

    /// Returns the refusal of a reference with the place where the job states it, unless the options state another.
    pub(crate) fn located(job: Option<&Self>, asked: Option<&Reference>, refusal: Diagnostic) -> Diagnostic {
        let job = job.filter(|_| asked.is_none());
        refusal.at(job.and_then(|job| job.reference_written.clone()), "")
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

    /// True if it is of a part: poses of the axes are not.
    pub(crate) fn has_part(&self) -> bool {
        !self.poses.are_axes()
    }

    /// Returns the zero at the part's origin.
    pub(crate) fn zero(&self) -> Reference {
        Reference::zero().placed(self.place)
    }
}

/// Reads a job file; `asked` says whether its tool poses are one path, whatever it says itself.
fn from_file(call: &mut Call<'_>, machine: &Machine, path: &Path, asked: Option<bool>) -> Result<UnplacedJob, Refused> {
    let text = read_job(path, call.run.files, &mut call.diagnostics);
    call.check()?;
    read(call, machine, &text.ok_or(Refused)?, asked)
}

/// Reads the job of a machine file.
fn from_machine_file(
    call: &mut Call<'_>,
    file: &MachineFile,
    asked: Option<bool>,
) -> Result<Option<UnplacedJob>, Refused> {
    let Some(text) = &file.job else { return Ok(None) };
    let text = text.among(&file.sources, &mut call.diagnostics.sources);
    read(call, file, &text, asked).map(Some)
}

/// Reads a job on a machine. All that is wrong with its form is found in one run.
fn read(call: &mut Call<'_>, machine: &Machine, text: &JobText, asked: Option<bool>) -> Result<UnplacedJob, Refused> {
    let job = text.read::<JobFile>(&mut call.diagnostics);
    call.check()?;
    let JobFile { tool_poses, place, reference, path, tool, limit, features } = job.ok_or(Refused)?;
    let reference = reference.map(|WrittenReference(reference)| reference);
    let keys = text.keys_of("reference");
    if let Some(idle) = reference.as_ref().and_then(|reference| reference.idle_key(&keys)) {
        call.extend([refused(&idle.to_string(), text.key(&["reference", idle.key]), idle.help())]);
    }
    call.extend(tool.and_then(|tool| of_unknown_tool(machine, &tool, text)));
    let limit_mm = limit.map(|limit| part_length(&limit.to_string())).transpose().unwrap_or_else(|why| {
        let help = "write a length with its unit, `limit: 30 um`";
        call.extend([refused(&why.to_string(), text.value(&["limit"]), help)]);
        None
    });
    let features = features.placed(place, text).unwrap_or_else(|refusals| {
        call.extend(refusals);
        FeatureTolerances::default()
    });
    call.check()?;
    let named = text.value(&[TOOL_POSES]);
    let poses = tool_poses::read_named(call, machine, &text.tool_poses(&tool_poses), named)?.along(asked.or(path));
    let reference_written = reference.as_ref().and_then(|_| text.value(&["reference"]));
    Ok(UnplacedJob(Job { poses, limit_mm, features, place, reference, reference_written }))
}

/// Returns the refusal of a job for a tool that the machine does not have.
fn of_unknown_tool(machine: &Machine, tool: &str, text: &JobText) -> Option<Diagnostic> {
    let unknown = machine.with_tool(tool).is_none();
    let message = format!("the job is for the tool `{}`, which the machine does not have", shown(tool));
    unknown.then(|| refused(&message, text.value(&["tool"]), "name one of the `tools` of the machine file"))
}

fn refused(why: &str, place: Option<Place>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::E0851, why).at(place, "").help(help)
}
