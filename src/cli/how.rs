//! Options of the compensation of a machine: `compile`, `verify`, `diff`, `map` and `report` share them.

use super::arguments::{JobArg, PosesArg, ReferenceArg, SeedArg, ToolArg, ToolPosesArg};
use super::confined;
use abbe::options::{
    CertifiedWork, CompensationOptions, CorrectingAxes, Fit, Goal, Stored, TemplateLimit, TemplateWatch,
};
use std::path::PathBuf;

/// Options that `compile`, `verify`, `diff` and `report` share.
#[derive(Debug, Clone, clap::Args)]
#[command(mut_arg("job", |option| option.conflicts_with("tool_poses")))]
#[command(mut_arg("poses", |option| option.default_value("2000")))]
pub(super) struct SetArgs {
    #[command(flatten)]
    pub how: CompensationArgs,
    #[command(flatten)]
    pub tool: ToolArg,
    #[command(flatten)]
    pub poses: PosesArg,
    #[command(flatten)]
    pub seed: SeedArg,
    #[command(flatten)]
    pub tool_poses: ToolPosesArg,
    #[command(flatten)]
    pub job: JobArg,
    #[command(flatten)]
    pub reference: ReferenceArg,
}

impl SetArgs {
    /// Returns the work of a certificate besides the volume.
    pub(super) fn certified_work(&self) -> CertifiedWork {
        CertifiedWork { reference: self.reference.reference.clone(), ..work_of(&self.tool_poses, &self.job) }
    }
}

/// Returns the work that is named, with the reference of the job.
pub(super) fn work_of(tool_poses: &ToolPosesArg, job: &JobArg) -> CertifiedWork {
    CertifiedWork {
        tool_poses: tool_poses.tool_poses.clone(),
        job: job.job.clone(),
        path: job.path,
        ..CertifiedWork::default()
    }
}

/// Options of the compensation of a machine.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct CompensationArgs {
    /// Goal of the correction: the position, or the position and the direction of the tool axis [default: `position`
    /// for a lattice, `pose` for a kinematics module].
    #[arg(long, value_enum)]
    correct: Option<Goal>,
    /// Axes that may correct [default: linear for `position`, all for `pose`].
    #[arg(long, value_enum)]
    with: Option<CorrectingAxes>,
    /// A folder with targets of your own.
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// Meaning of stored numbers, where the manual does not state it [default: as `abbe targets` states].
    #[arg(long, value_enum)]
    stored: Option<Stored>,
    /// Leave out tables of one kind that the controller would have: product, plane, cross_axis, own_axis.
    #[arg(long, value_name = "KIND")]
    without: Vec<String>,
    /// Content of own-axis tables: the axis's own error at its origin, or the deviation of the functional point
    /// [default: axis].
    #[arg(long, value_enum, alias = "fit")]
    own_axis: Option<Fit>,
    /// Letters and numbers of axes in the controller [default: `controller` of the axes in the machine file].
    #[arg(long, value_name = "A=AX6,C=AX7", value_delimiter = ',')]
    map: Vec<String>,
    /// Scales of drives in force when the machine was measured: steps in a mm (M92, $100), or mm in a turn
    /// (rotation_distance) [default: those of --installed, else no scale is written].
    #[arg(long, value_name = "X=80,Y=80", value_delimiter = ',')]
    scale: Vec<String>,
    /// True in the resource-limited child that renders user templates.
    #[arg(from_global)]
    template_child: bool,
}

/// Bounds the processor time of templates in the child.
struct TimeOfTemplates;

impl TemplateLimit for TimeOfTemplates {
    fn begin(&self) {
        confined::limit_time(Some(confined::TEMPLATE_SECONDS));
    }

    fn end(&self) {
        confined::limit_time(None);
    }
}

impl CompensationArgs {
    /// Options of the library.
    pub(super) fn options(&self) -> CompensationOptions {
        CompensationOptions {
            correct: self.correct,
            with: self.with,
            templates: self.templates.clone(),
            stored: self.stored,
            without: self.without.clone(),
            fit: self.own_axis,
            map: self.map.clone(),
            scale: self.scale.clone(),
            watch: if self.template_child { TemplateWatch::new(TimeOfTemplates) } else { TemplateWatch::default() },
        }
    }
}
