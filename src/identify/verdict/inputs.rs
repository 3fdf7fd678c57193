//! The request of a fit, from any face of the program.

use crate::evaluate::{Frame, Order};
use std::path::{Path, PathBuf};

/// The part of the volume over which a fit is judged, and which its machine file states.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FitRange {
    /// The volume of the machine file, by default the travels.
    #[default]
    Travel,
    /// Of axes with fitted curves the range in which they were measured.
    Measured,
}

pub(crate) struct FitInputs<'a> {
    /// Parameters to fit; if empty, those of the machine file.
    pub fit: &'a [String],
    /// Parameters that keep their value.
    pub fixed: &'a [String],
    /// Values known before the data, in words.
    pub priors: &'a [String],
    /// Standard uncertainties that all readings share, in words.
    pub type_b: &'a [String],
    /// Files of measurements, in their order.
    pub paths: Vec<PathBuf>,
    /// Those of them that are texts, by name.
    pub texts: &'a [(String, String)],
    /// True if nothing is measured: the rows are readings that could be taken.
    pub is_plan: bool,
    /// Frame in which the deviations were measured.
    pub frame: Frame,
    /// The poses of named points.
    pub axis_poses: Option<&'a Path>,
    /// Model to fit.
    pub order: Order,
    /// Gives readings that stand out less weight.
    pub robust: bool,
    /// Number of parts of the check of the prediction.
    pub folds: Option<usize>,
    /// The part of the volume over which the fit is judged.
    pub range: FitRange,
    /// Writes the machine file although it holds values that are not determined.
    pub accept_undetermined: bool,
}
