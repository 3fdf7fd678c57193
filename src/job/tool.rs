//! The tool that a job names: machines take it, unless another was asked for.

use super::job_file::{JobPaths, NO_JOB};
use super::machine_file::MachineFile;
use crate::diagnostic::Diagnostics;
use crate::run::{Call, Refused};
use crate::syntax::read_job;
use std::path::Path;

/// The only entry of a job that is read here; what is wrong with a job is reported where all of it is read.
#[derive(serde::Deserialize)]
struct NamedTool {
    tool: Option<String>,
}

impl JobPaths<'_> {
    /// Calls a function with the machine, which has the tool of its job.
    pub(crate) fn with_tool<T>(
        self,
        call: &mut Call<'_>,
        file: &MachineFile,
        of: impl FnOnce(&mut Call<'_>, &MachineFile) -> Result<T, Refused>,
    ) -> Result<T, Refused> {
        let tool = self.tool(call, file);
        let equipped = tool.and_then(|tool| file.with_tool(&tool).ok());
        of(call, equipped.as_ref().unwrap_or(file))
    }

    /// Calls a function with machines on one job, which is that of the first where none is named. Refuses a machine but
    /// the first that does not have the tool of the job; the first is refused where the job is read.
    pub(crate) fn with_tools<T>(
        self,
        call: &mut Call<'_>,
        files: &[MachineFile],
        of: impl FnOnce(&mut Call<'_>, &[MachineFile]) -> Result<T, Refused>,
    ) -> Result<T, Refused> {
        let Some(tool) = files.first().and_then(|first| self.tool(call, first)) else { return of(call, files) };
        let mut equipped = Vec::new();
        for (index, file) in files.iter().enumerate() {
            equipped.push(match file.with_tool(&tool) {
                Ok(file) => file,
                Err(_) if index == 0 => return of(call, files),
                Err(refusal) => return call.about(file.path(), |call| call.refuse(refusal)),
            });
        }
        of(call, &equipped)
    }

    /// Returns the tool that the job names; none where one was asked for with the machine.
    fn tool(self, call: &Call<'_>, file: &MachineFile) -> Option<String> {
        if file.is_tool_asked
            || self.tool_poses.is_some()
            || self.axis_poses.is_some()
            || self.job == Some(Path::new(NO_JOB))
        {
            return None;
        }
        let mut apart = Diagnostics::default();
        let named: Option<NamedTool> = match self.job {
            Some(path) => read_job(path, call.run.files, &mut apart)?.read(&mut apart),
            None => file.job.as_ref()?.read(&mut apart),
        };
        named?.tool
    }
}
