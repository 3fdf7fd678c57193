//! A job: the tool poses of a part, where the part lies, and what its set-up takes out.

use super::characteristics::{FeatureEntries, FeatureTolerances, JobCharacteristics};
use super::limit::{JobLimit, parse_limit};
use super::machine_file::MachineFile;
use super::placement::Placement;
use super::reference::{Reference, SetUp};
use super::tool_poses::{self, ReachedToolPoses, ToolPoses};
use crate::analysis::budget::Statistic;
use crate::diagnostic::{Diagnostic, Reason, codes, shown};
use crate::machine::{Machine, Pose};
use crate::run::{Call, Refused};
use crate::syntax::{from_yaml, read_text};
use std::path::Path;

/// The word in place of a file that leaves the job of a machine file out.
pub(crate) const NO_JOB: &str = "none";

/// A job file, or the job of a machine file.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct JobFile {
    /// The file of the tool poses, from the folder of the job file.
    tool_poses: String,
    /// Where the part lies on the workpiece frame.
    #[serde(default)]
    place: Placement,
    /// The reference: what the set-up takes out.
    reference: Option<Reference>,
    /// True if the tool poses are one continuous path.
    path: Option<bool>,
    /// Name of the tool.
    tool: Option<String>,
    /// Limit of the 95 % value of the position deviation.
    limit: Option<String>,
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
}

/// The files that make a job: at most one of them is there. Without both the job of the machine file counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JobPaths<'a> {
    /// The job file, or [`NO_JOB`].
    pub job: Option<&'a Path>,
    /// The bare tool poses.
    pub tool_poses: Option<&'a Path>,
    /// True if the tool poses are one path; by default what the job file says, or else of CL data alone.
    pub path: Option<bool>,
}

impl JobPaths<'_> {
    /// Reads the job for a machine, which gives the rotary columns their axes; `None` without one. Says if the job of
    /// the machine file gives way.
    pub(crate) fn read(self, call: &mut Call<'_>, file: &MachineFile) -> Result<Option<Job>, Refused> {
        Ok(self.read_unplaced(call, file)?.map(UnplacedJob::placed))
    }

    /// Reads the same with the part not yet on the workpiece frame.
    pub(crate) fn read_unplaced(self, call: &mut Call<'_>, file: &MachineFile) -> Result<Option<UnplacedJob>, Refused> {
        let job = self.job.filter(|path| *path != Path::new(NO_JOB));
        let own = file.job.is_some() && (self.job.is_none() || job.is_some());
        match (job, self.tool_poses) {
            (Some(_), Some(_)) => call.usage("a job file names its tool poses: omit one of the two"),
            (Some(path), None) => {
                call.extend(own.then(|| displaced(file, path)));
                from_file(call, file, path, self.path).map(Some)
            }
            (None, Some(path)) => {
                call.extend(own.then(|| displaced(file, path)));
                let poses = tool_poses::read(call, file, path)?.along(self.path);
                let (features, place) = (FeatureTolerances::default(), Placement::default());
                Ok(Some(UnplacedJob(Job { poses, limit_mm: None, features, place, reference: None })))
            }
            (None, None) if own => from_machine_file(call, file, self.path),
            (None, None) if self.path.is_some() => {
                call.usage("`--path` is about tool poses: give `--job` or `--tool-poses`")
            }
            (None, None) => Ok(None),
        }
    }
}

/// The warning of a machine file whose job gives way to another.
fn displaced(file: &MachineFile, by: &Path) -> Diagnostic {
    let [file, by] = [file.path().to_owned(), by.display().to_string()].map(|name| shown(&name));
    Diagnostic::new(codes::W0852, format!("the job of `{file}` gives way to `{by}`"))
        .help("omit `--job` and `--tool-poses` for the job of the machine file")
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
        job?.limit_mm.map(|mm| JobLimit { mm, statistic, missed })
    }

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
fn from_file(call: &mut Call<'_>, machine: &Machine, path: &Path, asked: Option<bool>) -> Result<UnplacedJob, Refused> {
    let files = call.run.files;
    let Some((_, text)) = read_text(path, None, files, &mut call.diagnostics) else { return Err(Refused) };
    let name = path.display().to_string();
    match from_yaml::<JobFile>(&text) {
        Ok(job) => {
            let tool_poses = path.parent().unwrap_or(Path::new("")).join(&job.tool_poses);
            job.on(call, machine, &name, &tool_poses, asked)
        }
        Err(failure) => call.refuse(refused(&name, &Reason::new(failure))),
    }
}

/// Reads the job of a machine file.
fn from_machine_file(
    call: &mut Call<'_>,
    file: &MachineFile,
    asked: Option<bool>,
) -> Result<Option<UnplacedJob>, Refused> {
    let Some(text) = &file.job else { return Ok(None) };
    let job = text.read::<JobFile>(&mut call.diagnostics);
    call.check()?;
    let job = job.ok_or(Refused)?;
    let tool_poses = text.path("tool_poses", &job.tool_poses);
    job.on(call, file, file.path(), &tool_poses, asked).map(Some)
}

impl JobFile {
    /// Returns the job on a machine; `name` is that of the file in which it stands.
    fn on(
        self,
        call: &mut Call<'_>,
        machine: &Machine,
        name: &str,
        tool_poses: &Path,
        asked: Option<bool>,
    ) -> Result<UnplacedJob, Refused> {
        let Self { tool_poses: _, place, reference, path, tool, limit, features } = self;
        if let Some(tool) = tool.filter(|tool| machine.with_tool(tool).is_none()) {
            let message = format!("the job is for the tool `{}`, which the machine does not have", shown(&tool));
            return call
                .refuse(refused(name, &Reason::new(message)).help("name one of the `tools` of the machine file"));
        }
        let limit = limit.map(|text| parse_limit(&text)).transpose();
        let limit_mm = limit.or_else(|reason| call.refuse(refused(name, &reason)))?;
        let poses = tool_poses::read(call, machine, tool_poses)?.along(asked.or(path));
        let features = features.placed(place).or_else(|reason| call.refuse(refused(name, &reason)))?;
        Ok(UnplacedJob(Job { poses, limit_mm, features, place, reference }))
    }
}

fn refused(name: &str, failure: &Reason) -> Diagnostic {
    let message = format!("`{}`: {}", shown(name), shown(&failure.to_string()));
    let help = "a job has `tool_poses`, and may have `place`, `reference`, `path`, `tool`, `limit` and `features`; \
                docs/formats/jobs.md has an example";
    Diagnostic::new(codes::E0851, message).help(help)
}
