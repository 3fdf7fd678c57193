//! Options of the report.

use crate::api::tolerances::ToleranceOptions;
use crate::evaluate::Order;
use crate::file_set::options::CompensationOptions;
use crate::job::job_file::JobPaths;
use crate::job::reference::Reference;
use crate::job::reference_text::ReferenceOption;
use crate::machine::Approach;
use std::path::PathBuf;

/// Options of [`report`](super::report::report()).
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ReportOptions {
    /// Controllers whose compensation and certificate are shown.
    pub targets: Vec<String>,
    /// Options of the compensation.
    pub compensation: CompensationOptions,
    /// Number of poses of maps and certificates.
    pub poses: usize,
    /// A file of tool poses, of which statistics and comparison are taken: CSV or APT CL data.
    pub tool_poses: Option<PathBuf>,
    /// A CSV file of poses of the axes of the one machine instead, of which statistics and pictures are taken; its page
    /// asks its own questions over the volume. A header of axis names, one pose a line, mm and deg.
    pub axis_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of statistics, single errors and comparison; by default the zero at the
    /// part's origin for tool poses, nothing for a volume.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Seed of the poses, and of the errors that are drawn.
    pub seed: u64,
    /// Order of the errors; exact by default, unless the conventions of a machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
    /// Bounds, draws and statistic of errors, where a machine bounds some.
    pub tolerances: ToleranceOptions,
    /// Number of machines that are drawn for a budget, at least 2.
    pub samples: usize,
}

impl ReportOptions {
    /// Returns the files of the job.
    pub(super) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths {
            job: self.job.as_deref(),
            tool_poses: self.tool_poses.as_deref(),
            axis_poses: self.axis_poses.as_deref(),
            path: self.path,
        }
    }
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            compensation: CompensationOptions::default(),
            poses: 2000,
            tool_poses: None,
            axis_poses: None,
            job: None,
            path: None,
            reference: None,
            seed: 1,
            order: None,
            approach: Approach::default(),
            tolerances: ToleranceOptions::default(),
            samples: 1000,
        }
    }
}
