//! Options of a map, and the map as a value.

use super::bounded::AddedByBounds;
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::Percentile;
use crate::analysis::{Bands, MAX_POSES, MAX_SURVEYED, spread_places};
use crate::evaluate::{Frame, Nodes, Order, Poses, Random, Spread, Statistics, Summary};
use crate::file_set::options::CompensationOptions;
use crate::job::characteristics::CharacteristicResult;
use crate::job::features::FeatureResult;
use crate::job::job_file::{Job, JobPaths, NO_JOB};
use crate::job::limit::LimitVerdict;
use crate::job::machine_file::MachineFile;
use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::job::played::PlayedRow;
use crate::job::poses::{AxisPositions, poses};
use crate::job::reference::{Reference, ReferenceKind, SetUp, sample_for_unheld};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Approach, Machine, Pose};
use crate::report::plane_picture::PlaneOptions;
use crate::report::{BoundedFigures, Picture, Rows};
use crate::run::{Call, Refused};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Options of [`map`](super::map()).
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct MapOptions {
    /// The poses.
    pub poses: MapPoses,
    /// Seed of random and low-discrepancy poses.
    pub seed: u64,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Order of the errors; exact by default, unless the conventions of the machine name an order.
    pub order: Option<Order>,
    /// Maps the part of this degree in the errors alone, 1 to 6, over a volume of a bare machine.
    pub degree: Option<u8>,
    /// Motion that the part's set-up takes out of the deviations; by default the zero at the part's origin for tool
    /// poses, nothing for a volume.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Number of the worst poses to name.
    pub worst: usize,
    /// Draws the deviation over a plane.
    pub picture: Option<PlaneOptions>,
    /// Maps the residual of this target's compensation, by the files that `compile` would write.
    pub target: Option<String>,
    /// Options of the compensation for the target.
    pub compensation: CompensationOptions,
    /// Bounds and draws of errors, for a machine that bounds some; its figure is the largest deviation over the poses.
    #[serde(flatten)]
    pub tolerances: ToleranceOptions,
    /// Number of machines that are drawn, at least 2.
    pub samples: usize,
    /// True if [`MapResult::played`] is wanted, for the page alone.
    #[doc(hidden)]
    #[serde(skip)]
    pub played: bool,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            poses: MapPoses::Grid,
            seed: 1,
            path: None,
            order: None,
            degree: None,
            reference: None,
            approach: Approach::default(),
            frame: Frame::default(),
            worst: 5,
            picture: None,
            target: None,
            compensation: CompensationOptions::default(),
            tolerances: ToleranceOptions::default(),
            samples: 1000,
            played: false,
        }
    }
}

impl MapOptions {
    /// Returns the files of the job, if the poses are of one.
    pub(crate) fn job(&self) -> JobPaths<'_> {
        let of = JobPaths { path: self.path, ..JobPaths::default() };
        match &self.poses {
            MapPoses::ToolPoses(path) => JobPaths { tool_poses: Some(path), ..of },
            MapPoses::AxisPoses(path) => JobPaths { axis_poses: Some(path), ..of },
            MapPoses::Job(path) => JobPaths { job: Some(path), ..of },
            MapPoses::Grid => of,
            _ => JobPaths { job: Some(Path::new(NO_JOB)), ..of },
        }
    }

    /// Returns the set-up of the part of a map.
    pub(crate) fn set_up(
        &self,
        call: &mut Call<'_>,
        machine: &Machine,
        poses: &Poses,
        job: Option<&Job>,
    ) -> Result<SetUp, Refused> {
        let asked = self.reference.as_ref();
        let fitted = Job::stated(job, asked).is_some_and(|of| of.kind == ReferenceKind::BestFit);
        if fitted && poses.len() > MAX_POSES {
            return call.usage(format!("a best fit is over {MAX_POSES} poses at most, all of which are held"));
        }
        let list: Vec<Pose> = match fitted {
            true => poses.iter().collect(),
            false if machine.unheld().is_empty() => Vec::new(),
            false => sample_for_unheld(poses),
        };
        Job::set_up(job, call, machine, asked, &list)
    }
}

/// Poses of a map; at most 1e9.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MapPoses {
    /// The tool poses of the job of the machine file, or else the grid of the volume of the machine; 100,000 spread
    /// poses where the file states no volume and the grid of the travels has more than [`Self::MAX_HELD`].
    #[default]
    Grid,
    /// Random poses over the volume: their number.
    Random(usize),
    /// Low-discrepancy poses over the volume: their number.
    LowDiscrepancy(usize),
    /// The poses for the tool poses of a file, workpiece frame: CSV with columns X, Y, Z (mm) and I, J, K or rotary
    /// axes (deg), or APT CL data.
    ToolPoses(PathBuf),
    /// The poses of a CSV file: a header of axis names, one pose a line, mm and deg; omitted axes are at 0.
    AxisPoses(PathBuf),
    /// The poses for the tool poses of a job file, with the reference that it states; `none` in its place leaves the
    /// job of the machine file out, for the grid of the volume.
    Job(PathBuf),
    /// Poses as numbers, mm and deg, each as long as the machine has axes and in the order of the chain.
    #[schemars(skip)]
    Listed(Vec<Pose>),
}

impl MapPoses {
    /// Largest number of poses of which a map is held as a whole; above it quantiles are approximate.
    pub const MAX_HELD: usize = MAX_POSES;
    /// Largest number of poses.
    pub const MAX: usize = MAX_SURVEYED;

    /// Returns the number of poses; `None` where a file decides.
    pub fn count(&self, file: &MachineFile) -> Option<usize> {
        match self {
            Self::Grid => file.job.is_none().then(|| of_volume(file, 0).len()),
            Self::Random(count) | Self::LowDiscrepancy(count) => Some(*count),
            Self::Listed(list) => Some(list.len()),
            Self::ToolPoses(_) | Self::AxisPoses(_) | Self::Job(_) => None,
        }
    }

    pub(crate) fn of(
        &self,
        call: &mut Call<'_>,
        (machine, seed): (&Machine, u64),
        reached: Option<&ReachedToolPoses>,
    ) -> Result<Poses, Refused> {
        Ok(match self {
            Self::Random(count) => Poses::Random(Random::of(machine, *count, seed)),
            Self::LowDiscrepancy(count) => Poses::Spread(Spread::of(machine, *count, seed)),
            Self::Grid | Self::ToolPoses(_) | Self::AxisPoses(_) | Self::Job(_) => match reached {
                Some(reached) => Poses::Listed(reached.poses.clone()),
                None => of_volume(machine, seed),
            },
            Self::Listed(list) => Poses::Listed(poses(call, machine, (&[], list, None))?),
        })
    }
}

/// Number of poses in place of a grid that nobody asked for and that is too large.
const SPREAD_POSES: usize = 100_000;

/// Returns the poses of a map of the volume.
fn of_volume(machine: &Machine, seed: u64) -> Poses {
    let nodes = Nodes::of(machine);
    if nodes.len() > MapPoses::MAX_HELD && machine.has_default_volume() {
        return Poses::Spread(Spread::of(machine, SPREAD_POSES, seed));
    }
    Poses::Nodes(nodes)
}

/// A map of deviations, actual minus nominal; of a machine of which nothing is measured, of what its bounds lead to.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct MapResult {
    /// Name of the machine.
    pub machine: String,
    /// `exact`, or a degree.
    pub order: Order,
    /// Degree in the errors, if the part of one degree alone is mapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub degree: Option<u8>,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Side of approach.
    pub direction: Approach,
    /// What the map is over.
    pub over: Over,
    /// Events of the path, if the tool poses are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathResult>,
    /// The 95 % value of the position against the limit of the job, if it states one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<LimitVerdict>,
    /// Number of poses.
    pub poses: usize,
    /// `bounds` where nothing is measured: then the statistics are of the 95 % value at each pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
    /// What the bounds lead to, where nothing is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<MapFromBounds>,
    /// What bounds of errors without a value add to the measured ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds_add: Option<AddedByBounds>,
    /// Statistics of the deviation of the functional point, um.
    pub position_um: Summary,
    /// Statistics of the deviation of the orientation of the tool, urad.
    pub rotation_urad: Summary,
    /// Intervals of the statistics, where the machine file states uncertainties of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Bands>,
    /// The value that 95 % of the whole volume keeps, um, with its interval by the number of random poses; of random
    /// poses alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_over_volume: Option<Percentile>,
    /// The poses beyond the ranges in which the curves of the axes were measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_measured: Option<BeyondMeasured>,
    /// The worst poses, largest deviation of the functional point first.
    pub worst: Vec<WorstPose>,
    /// The body diagonals of the volume; none of a job.
    pub diagonals: Vec<BodyDiagonal>,
    /// Relative error of the 95 % values, for a map of more than [`MapPoses::MAX_HELD`] poses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_relative_error: Option<f64>,
    /// Tool poses of a file, with those that the machine reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_poses: Option<ReachedToolPoses>,
    /// The features of the file, where it names some: the largest deviation on each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<FeatureResult>,
    /// The characteristics of features for which the job states tolerances.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub characteristics: Vec<CharacteristicResult>,
    /// The target whose compensation is in the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// The same without compensation, for a map with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncompensated: Option<Uncompensated>,
    /// The rows of a work one by one, where they were asked for.
    #[serde(skip)]
    pub played: Vec<PlayedRow>,
    /// Numbers of nodes along the axes, for the grid of the volume.
    #[serde(skip)]
    pub grid: Option<Vec<usize>>,
    /// The picture that was asked for.
    #[serde(skip)]
    pub picture: Option<Picture>,
}

impl MapResult {
    /// Returns a map that has statistics and nothing else.
    pub(crate) fn empty(rows: &Rows<'_>, over: Over, statistics: Statistics) -> Self {
        Self {
            machine: rows.machine.name().to_owned(),
            order: rows.order,
            degree: None,
            frame: rows.view.frame,
            direction: rows.view.conditions.approach,
            over,
            limit: None,
            path: None,
            poses: statistics.poses,
            from: None,
            bounds: None,
            bounds_add: None,
            position_um: statistics.position_um,
            rotation_urad: statistics.rotation_urad,
            uncertainty: None,
            p95_over_volume: None,
            played: Vec::new(),
            beyond_measured: BeyondMeasured::of(rows.machine, rows.poses),
            worst: Vec::new(),
            diagonals: Vec::new(),
            p95_relative_error: None,
            tool_poses: None,
            features: Vec::new(),
            characteristics: Vec::new(),
            target: None,
            uncompensated: None,
            grid: if let Poses::Nodes(nodes) = rows.poses { Some(nodes.counts().collect()) } else { None },
            picture: None,
        }
    }

    /// Returns the statistics of the map.
    pub fn statistics(&self) -> Statistics {
        Statistics { poses: self.poses, position_um: self.position_um, rotation_urad: self.rotation_urad }
    }
}

/// Poses of a map beyond the ranges in which curves were measured.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BeyondMeasured {
    /// Number of the poses, of those counted.
    pub poses: usize,
    /// Number of poses that were counted: those of the map, or of more than [`MapPoses::MAX_HELD`] some spread over
    /// them.
    pub of: usize,
    /// The measured ranges that poses leave, by axis, mm and deg.
    pub measured: BTreeMap<String, [f64; 2]>,
}

impl BeyondMeasured {
    /// Returns the poses of a list that a machine has not been measured at; `None` if there are none.
    pub(crate) fn of(machine: &Machine, poses: &Poses) -> Option<Self> {
        machine.axes().iter().find(|axis| machine.measured_range(&axis.name).is_some())?;
        let places = spread_places(poses.len(), MAX_POSES, &[]);
        let mut measured = BTreeMap::new();
        let mut beyond = 0;
        for pose in places.iter().map(|i| poses.get(*i)) {
            let mut is_beyond = false;
            for axis in machine.beyond_measured(&pose) {
                is_beyond = true;
                measured.extend(machine.measured_range(&axis.name).map(|range| (axis.name.to_string(), range.into())));
            }
            beyond += usize::from(is_beyond);
        }
        (beyond > 0).then_some(Self { poses: beyond, of: places.len(), measured })
    }
}

/// What the bounds of a machine lead to over a map.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct MapFromBounds {
    /// Its figures, with the machines drawn.
    #[serde(flatten)]
    pub figures: BoundedFigures,
    /// The worst poses, largest 95 % value of the position deviation first.
    pub worst: Vec<WorstBoundedPose>,
}

/// A pose with a large 95 % value.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct WorstBoundedPose {
    /// The pose, mm and deg.
    pub axes: AxisPositions,
    /// Root of the sum of squares of the bounds' effects on the functional point, um.
    pub rss_um: f64,
    /// The position deviation that 95 % of the machines drawn do not exceed, um.
    pub p95_um: f64,
}

/// Statistics of a machine without compensation.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Uncompensated {
    /// Displacement of the functional point, um.
    pub position_um: Summary,
    /// Rotation of the tool, urad.
    pub rotation_urad: Summary,
}

/// A pose with a large deviation.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct WorstPose {
    /// The pose, mm and deg.
    pub axes: AxisPositions,
    /// Deviation of the functional point, um.
    pub deviation_um: [f64; 3],
    /// Length of the deviation, um.
    #[serde(skip)]
    pub length_um: f64,
}

/// Displacement along a body diagonal.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct BodyDiagonal {
    /// Senses of the axes along it, such as `ppp`.
    pub name: String,
    /// The pose at its beginning, mm and deg.
    pub from: AxisPositions,
    /// The pose at its end, mm and deg.
    pub to: AxisPositions,
    /// Length, mm.
    pub length_mm: f64,
    /// Maximum minus minimum of the displacement, um.
    pub range_um: f64,
    /// Displacement along the diagonal at equal intervals, um.
    pub deviations_um: Vec<f64>,
}
