//! The error over a volume.

use super::bounded::{AddedByBounds, DrawnBounds, added};
use super::compensation::effect::named_effect;
use super::compensation::options::CompensationOptions;
use super::features::{FeatureResult, features};
use super::machine_file::MachineFile;
use super::map_bounds::{self, MapFromBounds};
use super::map_tables::{MapTable, Tables};
use super::order_of;
use super::plane_picture::{PlaneOptions, Subject};
use super::poses::{AxisPositions, axis_positions, poses};
use super::run::{Answer, Call, Count, Refused, Run};
use super::share::shared_deviations;
use super::tolerances::ToleranceOptions;
use super::tool_poses::{self, ReachedToolPoses};
use super::uncertainty::field_bands;
use crate::analysis::{
    self, Bands, DiagonalRun, MAX_POSES, MAX_SURVEYED, Survey, SurveyTask, View, body_diagonals, rest,
};
use crate::controller::{ControllerEffect, ControllerTarget, Depth};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::evaluate::{
    CompiledField, Deviation, Field, Frame, Nodes, Order, Poses, Random, Spread, Statistics, Summary, Tally, worst,
};
use crate::machine::{Approach, Machine, Pose};
use crate::report::{Picture, Rows};
use std::path::PathBuf;

/// Options of [`map`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct MapOptions {
    /// The poses.
    pub poses: MapPoses,
    /// Seed of random and low-discrepancy poses.
    pub seed: u64,
    /// Order of the errors; exact by default, unless the conventions of the machine name an order.
    pub order: Option<Order>,
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
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            poses: MapPoses::Grid,
            seed: 1,
            order: None,
            approach: Approach::default(),
            frame: Frame::default(),
            worst: 5,
            picture: None,
            target: None,
            compensation: CompensationOptions::default(),
            tolerances: ToleranceOptions::default(),
            samples: 1000,
        }
    }
}

/// Poses of a map; at most 1e9.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MapPoses {
    /// The grid of the volume of the machine.
    #[default]
    Grid,
    /// Random poses over the volume: their number.
    Random(usize),
    /// Low-discrepancy poses over the volume: their number.
    LowDiscrepancy(usize),
    /// The poses for the tool poses of a file, workpiece frame: CSV with columns X, Y, Z (mm) and I, J, K or rotary
    /// axes (deg), or APT CL data.
    ToolPoses(PathBuf),
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
            Self::Grid => Some(Nodes::of(file).len()),
            Self::Random(count) | Self::LowDiscrepancy(count) => Some(*count),
            Self::Listed(list) => Some(list.len()),
            Self::ToolPoses(_) => None,
        }
    }

    pub(super) fn of(
        &self,
        call: &mut Call<'_>,
        (machine, seed): (&Machine, u64),
        reached: Option<&ReachedToolPoses>,
    ) -> Result<Poses, Refused> {
        Ok(match self {
            Self::Grid => Poses::Nodes(Nodes::of(machine)),
            Self::Random(count) => Poses::Random(Random::of(machine, *count, seed)),
            Self::LowDiscrepancy(count) => Poses::Spread(Spread::of(machine, *count, seed)),
            Self::ToolPoses(_) => Poses::Listed(reached.map_or_else(Vec::new, |reached| reached.poses.clone())),
            Self::Listed(list) => Poses::Listed(poses(call, machine, (&[], list, None))?),
        })
    }
}

/// A map of deviations, actual minus nominal; of a machine of which nothing is measured, of what its bounds lead to.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct MapResult {
    /// Name of the machine.
    pub machine: String,
    /// `exact`, or a degree.
    pub order: Order,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Side of approach.
    pub direction: Approach,
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
    /// The worst poses, largest deviation of the functional point first.
    pub worst: Vec<WorstPose>,
    /// The body diagonals of the volume.
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
    /// The target whose compensation is in the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// The same without compensation, for a map with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncompensated: Option<Uncompensated>,
    /// Numbers of nodes along the axes, for the grid of the volume.
    #[serde(skip)]
    pub grid: Option<Vec<usize>>,
    /// The picture that was asked for.
    #[serde(skip)]
    pub picture: Option<Picture>,
}

impl MapResult {
    /// Returns a map that has statistics and nothing else.
    pub(super) fn empty(rows: &Rows<'_>, statistics: Statistics) -> Self {
        Self {
            machine: rows.machine.name().to_owned(),
            order: rows.order,
            frame: rows.view.frame,
            direction: rows.view.approach,
            poses: statistics.poses,
            from: None,
            bounds: None,
            bounds_add: None,
            position_um: statistics.position_um,
            rotation_urad: statistics.rotation_urad,
            uncertainty: None,
            worst: Vec::new(),
            diagonals: Vec::new(),
            p95_relative_error: None,
            tool_poses: None,
            features: Vec::new(),
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

/// Maps the deviations of a machine over its volume.
///
/// Fails for more than 1e9 poses (1e6 where nothing is measured), and for a picture or a file of tool poses that does
/// not fit the machine.
pub fn map(file: &MachineFile, options: &MapOptions, run: Run<'_>) -> Result<Answer<MapResult>, Diagnostics> {
    map_tables(file, options, Vec::new(), run)
}

/// Maps as [`map`] does, and writes every pose with its deviation into tables.
///
/// Fails also if a table cannot be written; then tables may be incomplete.
pub fn map_tables(
    file: &MachineFile,
    options: &MapOptions,
    tables: Vec<MapTable<'_>>,
    run: Run<'_>,
) -> Result<Answer<MapResult>, Diagnostics> {
    Call::answer(run, file.sources(), |call| volume(call, file, options, tables))
}

/// Intervals of a body diagonal.
const DIAGONAL_STEPS: usize = 20;

fn volume(
    call: &mut Call<'_>,
    machine: &Machine,
    options: &MapOptions,
    tables: Vec<MapTable<'_>>,
) -> Result<MapResult, Refused> {
    call.bounded(&[Count::Machines(options.samples)])?;
    if let MapPoses::Random(0) | MapPoses::LowDiscrepancy(0) = options.poses {
        return call.usage("a map takes 1 pose at least");
    }
    let settings = (&options.tolerances, options.samples, options.seed);
    if let Some(drawn) = DrawnBounds::of(call, machine, settings)? {
        call.run.share.not_a_part()?;
        return map_bounds::volume(call, machine, options, (&drawn, tables));
    }
    let order = order_of(machine, options.order);
    let view = View { approach: options.approach, frame: options.frame };
    let place =
        options.picture.as_ref().map(|picture| picture.place(call, machine, options.target.is_some())).transpose()?;
    let tool_poses = match &options.poses {
        MapPoses::ToolPoses(path) => tool_poses::asked(call, machine, Some(path))?,
        _ => None,
    };
    let compensation = compensation(call, machine, options, order)?;
    let bare = CompiledField::new(machine, order);
    let replayed = compensation.as_ref().map(|(target, effect)| effect.field(machine, target));
    let field: &dyn Field = replayed.as_ref().map_or(&bare as &dyn Field, |field| &**field);
    let poses = options.poses.of(call, (machine, options.seed), tool_poses.as_ref())?;
    if poses.len() > MAX_SURVEYED {
        return call.refuse(too_many(poses.len()));
    }
    let name = options.target.as_deref().unwrap_or_default();
    let work = tool_poses.as_ref().map(ReachedToolPoses::work_rows);
    let rows = Rows { machine, poses: &poses, view, order, target: name, work: work.as_ref(), drawn: None };
    let before = match &replayed {
        Some(_) => Some(found(call, &bare, &rows, Vec::new(), 0)?.statistics),
        None => None,
    };
    let survey = found(call, field, &rows, tables, options.worst)?;
    let state = if name.is_empty() { String::new() } else { format!("after {name}") };
    let before_field = replayed.is_some().then_some(&bare as &dyn Field);
    let subject = Subject { field, state: &state, before: before_field };
    let drawn = options.picture.as_ref().zip(place.as_ref());
    let picture = drawn.map(|(picture, place)| picture.picture(place, &subject, (view, order)));
    let features = tool_poses.as_ref().map(|reached| features(field, reached, view, replayed.is_none()));
    let features = features.unwrap_or_default();
    let bounds_add = added(call, machine, settings, tool_poses.as_ref().map(|reached| reached.poses.as_slice()))?;
    let diagonals = body_diagonals(field, &rest(machine), DIAGONAL_STEPS, view.approach);
    let result = result(&rows, &survey, &diagonals);
    let uncompensated = before.map(|s| Uncompensated { position_um: s.position_um, rotation_urad: s.rotation_urad });
    let besides: Vec<usize> = survey.worst.iter().map(|(i, _)| *i).collect();
    let uncertainty = field_bands(field, &poses, (survey.statistics, &besides), view.approach, options.seed);
    let target = options.target.clone();
    Ok(MapResult { picture, tool_poses, features, bounds_add, target, uncompensated, uncertainty, ..result })
}

/// Number of poses at which the warnings of a compensation are found.
const CERTIFIED: usize = 1000;

/// Returns the effect of the files that `compile` would write for the target, with its warnings.
fn compensation(
    call: &mut Call<'_>,
    machine: &Machine,
    options: &MapOptions,
    order: Order,
) -> Result<Option<(ControllerTarget, ControllerEffect)>, Refused> {
    let Some(name) = &options.target else { return Ok(None) };
    if order != Order::Exact {
        return call
            .usage("a compensated machine is mapped with the exact model: omit `--order`, or give `--order exact`");
    }
    let depth = Depth { poses: CERTIFIED, seed: options.seed };
    let (target, effect, _) = named_effect(call, machine, name, &options.compensation, depth)?;
    Ok(Some((target, effect)))
}

fn too_many(count: usize) -> Diagnostic {
    let count = if count == usize::MAX { "more than can be counted".to_owned() } else { count.to_string() };
    Diagnostic::new(codes::E0812, format!("there are {count} poses; a map takes {MAX_SURVEYED} at most")).help(
        "take fewer random poses (`--random 100000`), or for the grid larger steps under `volume` in the machine file",
    )
}

/// Maps a field; the tables are written.
fn found(
    call: &mut Call<'_>,
    field: &dyn Field,
    rows: &Rows<'_>,
    tables: Vec<MapTable<'_>>,
    count: usize,
) -> Result<Survey, Refused> {
    let (poses, view) = (rows.poses, rows.view);
    let tables = Tables::new(*rows, tables).or_else(|refusal| call.refuse(refusal))?;
    if poses.len() > MAX_POSES {
        call.run.share.not_a_part()?;
        return tables.surveyed(call, SurveyTask { field, poses, view, worst: count });
    }
    let analysis::Map { deviations, statistics } = analysis::Map::of(shared_deviations(call, field, poses, view)?);
    tables.write(&deviations).or_else(|refusal| call.refuse(refusal))?;
    let worst = worst(&deviations, count).into_iter().map(|i| (i, deviations[i])).collect();
    Ok(Survey { statistics, worst })
}

fn result(rows: &Rows<'_>, survey: &Survey, diagonals: &[DiagonalRun]) -> MapResult {
    let Rows { machine, poses, .. } = *rows;
    let worst = |(i, deviation): &(usize, Deviation)| WorstPose {
        axes: axis_positions(machine, &poses.get(*i)),
        // Adding zero turns -0 into 0.
        deviation_um: (deviation.position * 1e3).map(|x| x + 0.0).into(),
        length_um: deviation.position.norm() * 1e3,
    };
    let diagonal = |d: &DiagonalRun| {
        let [from, to] = [&d.ends[0], &d.ends[1]].map(|pose| axis_positions(machine, pose));
        let deviations_um = d.deviations.iter().map(|x| x * 1e3 + 0.0).collect();
        let (length_mm, range_um) = (d.length, d.range() * 1e3);
        BodyDiagonal { name: d.name.clone(), from, to, length_mm, range_um, deviations_um }
    };
    MapResult {
        worst: survey.worst.iter().map(worst).collect(),
        diagonals: diagonals.iter().map(diagonal).collect(),
        p95_relative_error: (poses.len() > MAX_POSES).then_some(Tally::QUANTILE_ERROR),
        ..MapResult::empty(rows, survey.statistics)
    }
}
