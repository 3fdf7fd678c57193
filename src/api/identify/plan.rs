//! Poses worth measuring, and how well they determine the parameters.

use crate::identify::verdict::problem::{Requested, priors};
use crate::identify::{Estimate, FitModel, Measurement, Parameter, plan};
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Reply, Run};
use indexmap::IndexMap;
use serde::Serialize;

/// Options of [`plan_measurements`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct PlanOptions {
    /// Number of poses, 1 to 1000.
    pub poses: usize,
    /// Parameters to fit, as in [`IdentifyOptions`](super::IdentifyOptions).
    pub fit: Vec<String>,
    /// Parameters that keep their value.
    pub fixed: Vec<String>,
    /// Values known before the data, as in [`IdentifyOptions`](super::IdentifyOptions).
    pub priors: Vec<String>,
    /// Standard deviation of a reading, mm; above 0.
    pub noise_mm: f64,
    /// Seed of the poses to choose from.
    pub seed: u64,
}

/// 20 poses, 1 um, seed 1.
impl Default for PlanOptions {
    fn default() -> Self {
        Self { poses: 20, fit: Vec::new(), fixed: Vec::new(), priors: Vec::new(), noise_mm: 1e-3, seed: 1 }
    }
}

/// Poses, and what is expected of their measurement.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MeasurementPlan {
    /// The poses in the order of their worth.
    pub poses: Vec<PlannedPose>,
    /// Standard deviation of a reading, um.
    pub noise_um: f64,
    /// The parameters.
    pub parameters: Vec<ExpectedParameter>,
    /// Numerical rank of the problem.
    pub rank: usize,
    /// The rank of the model to first order in the errors: what the readings show without products of errors.
    pub rank_first_order: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of independent combinations above the noise.
    pub well_determined: usize,
    /// Combinations without effect, in words.
    pub null_space: Vec<String>,
    /// Combinations below the noise, in words.
    #[serde(rename = "drowned")]
    pub below_noise: Vec<String>,
    /// Ratio of the largest singular value to the smallest that counts.
    pub condition: f64,
    /// Combinations without effect, in words for people: shortened.
    #[serde(skip)]
    pub free: Vec<String>,
    /// A file of measurements that only lacks the measured values.
    #[serde(skip)]
    pub csv: String,
}

/// A pose to measure.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlannedPose {
    /// Positions by axis, mm and deg, to two decimals.
    pub axes: IndexMap<String, f64>,
    /// Name of the tool.
    pub tool: String,
}

/// A parameter with its expected uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ExpectedParameter {
    /// Name such as `EX0C`.
    pub name: String,
    /// Expected standard uncertainty, in `unit`; none if the poses leave it free.
    pub sigma: Option<f64>,
    /// Unit of the uncertainty.
    pub unit: String,
}

/// Chooses poses whose measurement determines the parameters best.
///
/// Fails if the parameters asked for are not those of the machine, and for options out of range.
pub fn plan_measurements(file: &MachineFile, options: &PlanOptions, run: Run) -> Reply<MeasurementPlan> {
    Call::answer(run, file.sources(), |call| {
        if !(1..=1000).contains(&options.poses) || options.noise_mm.is_nan() || options.noise_mm <= 0.0 {
            return call.usage("a plan has 1 to 1000 poses and a noise above zero");
        }
        let Requested { request, own, .. } = Requested::of(call, file, &options.fit, &options.fixed)?;
        let known = priors(call, file, &request, &options.priors, &own)?;
        let model = FitModel::new(file, &own).with_known(&known);
        let plan = plan(&model, options.poses, options.noise_mm, options.seed);
        let s = &plan.expected;
        let parameter = |(p, e): (&Parameter, &Estimate)| ExpectedParameter {
            name: p.name.clone(),
            sigma: e.sigma.map(|s| p.in_unit(s)),
            unit: p.unit.clone(),
        };
        Ok(MeasurementPlan {
            poses: plan.poses.iter().map(|pose| plan_pose(&model, pose)).collect(),
            noise_um: s.sigma * 1e3,
            parameters: own.iter().zip(&s.estimates).map(parameter).collect(),
            rank: s.rank,
            rank_first_order: s.rank_first_order,
            unknowns: own.len(),
            well_determined: s.well_determined,
            null_space: s.null_space.clone(),
            below_noise: s.below_noise.clone(),
            condition: s.condition,
            free: s.null_space_summary(),
            csv: csv(&model, &plan.poses),
        })
    })
}

fn plan_pose(model: &FitModel<'_>, pose: &Measurement) -> PlannedPose {
    let machine = model.machine(pose);
    let axes = machine.axes().iter().zip(&pose.pose);
    PlannedPose {
        axes: axes.map(|(axis, q)| (axis.name.to_string(), round_position(*q))).collect(),
        tool: machine.tool().name.clone(),
    }
}

fn csv(model: &FitModel<'_>, poses: &[Measurement]) -> String {
    let named = model.machines().len() > 1;
    let axes = model.machines().iter().take(1).flat_map(|machine| machine.axes());
    let header: Vec<String> = axes.map(|axis| format!("{} [{}]", axis.name, axis.unit())).collect();
    let tool = if named { ",tool" } else { "" };
    let mut text = format!("{}{tool},dx [um],dy [um],dz [um]\n", header.join(","));
    for pose in poses {
        let cells: Vec<String> = pose.pose.iter().map(|q| round_position(*q).to_string()).collect();
        let tool = if named { format!(",{}", model.machine(pose).tool().name) } else { String::new() };
        text += &format!("{}{tool},,,\n", cells.join(","));
    }
    text
}

/// Positions that a person can type in: 0.01 mm or deg, never `-0`.
fn round_position(q: f64) -> f64 {
    (q * 100.0).round() / 100.0 + 0.0
}
