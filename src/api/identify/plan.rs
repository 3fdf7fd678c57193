//! Readings worth taking, and how well they determine the parameters.

use crate::analysis::instrument::within;
use crate::analysis::touch_route::ProbeSizes;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Frame, Order};
use crate::identify::verdict::inputs::{FitInputs, FitRange};
use crate::identify::verdict::passes::hold_size;
use crate::identify::verdict::problem::Problem;
use crate::identify::{
    DeviationUncertainty, Estimate, FitModel, Measurement, Parameter, PlanInstrument, Prediction, Solution, expected,
    plan, taken_together,
};
use crate::job::machine_file::MachineFile;
use crate::job::poses::{AxisPositions, axis_positions, axis_ranges, check, pose_by_names};
use crate::machine::{AxisKind, Machine};
use crate::run::{Call, Refused, Reply, Run};
use crate::units::counted;
use indexmap::IndexMap;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Options of [`plan_measurements`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct PlanOptions {
    /// Number of readings, 1 to 1000: poses, of a laser lines.
    pub poses: usize,
    /// The instrument; it can take what its kind of readings and the volume allow.
    pub instrument: PlanInstrument,
    /// R-test and touch probe: poses at which the functional point is at a ball on the table, such as `X=100,Y=50`.
    /// Other axes are where [`InstrumentOptions::at`](crate::InstrumentOptions::at) has them. By default there is one.
    pub balls: Vec<String>,
    /// Sizes of a touch probe and of the balls.
    #[serde(flatten)]
    pub probe: ProbeSizes,
    /// Ranges of axes within the volume to which the readings are confined: `A=-60..60,C=0..180`, mm and deg.
    pub ranges: Option<String>,
    /// The readings to choose from, in place of those of an instrument: a file as it is read once it is measured, whose
    /// cells of readings are empty.
    pub candidates: Option<PathBuf>,
    /// Parameters to fit, as in [`IdentifyOptions`](super::IdentifyOptions).
    pub fit: Vec<String>,
    /// Parameters that keep their value.
    pub fixed: Vec<String>,
    /// Values known before the data, as in [`IdentifyOptions`](super::IdentifyOptions).
    pub priors: Vec<String>,
    /// Standard deviation of a reading, mm; above 0.
    pub noise_mm: f64,
    /// Seed of the readings to choose from.
    pub seed: u64,
    /// Largest standard uncertainty of the deviation predicted over the volume, mm: the plan has as few of the readings
    /// as reach it.
    pub until_mm: Option<f64>,
}

/// 20 poses at any place of the volume, 1 um, seed 1.
impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            poses: 20,
            instrument: PlanInstrument::Points,
            balls: Vec::new(),
            probe: ProbeSizes::default(),
            ranges: None,
            candidates: None,
            fit: Vec::new(),
            fixed: Vec::new(),
            priors: Vec::new(),
            noise_mm: 1e-3,
            seed: 1,
            until_mm: None,
        }
    }
}

/// Readings, and what is expected of their measurement.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MeasurementPlan {
    /// The poses in the order of their worth; those of runs, and of a file, in the order in which they are measured.
    pub poses: Vec<PlannedPose>,
    /// Number of readings: poses, of a laser lines.
    pub readings: usize,
    /// Number of readings to choose from.
    pub candidates: usize,
    /// Standard deviation of a reading, um.
    pub noise_um: f64,
    /// The parameters of the machine.
    pub parameters: Vec<ExpectedParameter>,
    /// Uncertainty of the deviation that their fit will predict over the volume.
    pub prediction: ExpectedPrediction,
    /// The uncertainty that was asked for, if one was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<PlanGoal>,
    /// Numerical rank of the problem.
    pub rank: usize,
    /// The rank of the model to first order in the errors: what the readings show without products of errors.
    pub rank_first_order: usize,
    /// Number of unknowns, those of the instrument among them.
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
    /// Positions by axis, mm and deg.
    pub axes: IndexMap<String, f64>,
    /// Positions at the other end of a length, if that is a pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<IndexMap<String, f64>>,
    /// Name of the tool.
    pub tool: String,
    /// The run to which it belongs, if there are runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
}

/// The uncertainty of the deviation over the volume to be expected of a fit, after the best rigid motion of the
/// workpiece frame.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ExpectedPrediction {
    /// The largest standard uncertainty, um, along the direction in which it is largest; none if the readings leave the
    /// deviation free, or none is to spare.
    pub largest_um: Option<f64>,
    /// A combination of parameters that changes the deviation and no reading, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub combination: Option<String>,
    /// Pose at which it is largest, mm and deg.
    pub at: AxisPositions,
}

/// A plan for an uncertainty of the deviation over the volume.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlanGoal {
    /// The largest standard uncertainty that was asked for, um.
    pub um: f64,
    /// True if the readings reach it; one fewer of them in their order do not.
    pub reached: bool,
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

/// Chooses readings whose measurement determines the parameters best, each once.
///
/// Fails if the parameters asked for are not those of the machine, for options out of range, if the instrument can
/// take fewer readings, and if none of them holds a length.
pub fn plan_measurements(file: &MachineFile, options: &PlanOptions, run: Run) -> Reply<MeasurementPlan> {
    Call::answer(run, file.sources(), |call| {
        if !(1..=1000).contains(&options.poses) || options.noise_mm.is_nan() || options.noise_mm <= 0.0 {
            return call.usage("a plan has 1 to 1000 poses and a noise above zero");
        }
        if options.until_mm.is_some_and(|mm| mm.is_nan() || mm <= 0.0) {
            return call.usage("the uncertainty that a plan is to reach is above zero");
        }
        if options.candidates.is_some() && *options != options.of_file() {
            return call
                .usage("readings to choose from have no instrument, balls or ranges: leave them out, or the file");
        }
        let ranges = options.ranges.as_ref().map(|text| axis_ranges(file, text)).transpose();
        let ranges = ranges.or_else(|refusal| call.refuse(refusal))?;
        let file = &ranges.map_or_else(|| file.clone(), |ranges| file.with_volume_within(&ranges));
        let texts = match options.candidates {
            Some(_) => Vec::new(),
            None => vec![("candidates.csv".to_owned(), table(call, file, options)?)],
        };
        let problem = Problem::read(call, file, &options.inputs(&texts))?;
        let (model, rows) = (problem.model(file, Order::Exact), &problem.rows);
        hold_size(call, file, &options.inputs(&texts), &problem, &model.start())?;
        let candidates = taken_together(rows).len();
        if candidates < options.poses {
            let count = counted(candidates, "reading");
            return call.usage(format!("there are {count} to choose {} from, each once", options.poses));
        }
        let chosen = call.stage("readings chosen", options.poses, |advance| {
            // A ball without a set would stand in the way of a program that is not told of it.
            let each_ball = options.instrument == PlanInstrument::Touch;
            plan(&model, rows, options.poses, each_ball, options.noise_mm, advance)
        })?;
        let in_order = options.candidates.is_some() || options.instrument == PlanInstrument::Touch;
        let in_order = in_order || rows.iter().any(|row| row.run.is_some());
        let first = |call: &Call<'_>, count: usize| {
            let mut first: Vec<usize> = chosen.iter().take(count).flatten().copied().collect();
            if in_order {
                first.sort_unstable();
            }
            lines(call, &first.iter().map(|i| &rows[*i]).collect::<Vec<_>>())
        };
        let (count, goal) = match options.until_mm {
            None => (options.poses, None),
            Some(mm) => {
                let (count, reached) = fewest(call, file, options, mm, first)?;
                (count, Some(PlanGoal { um: mm * 1e3, reached }))
            }
        };
        let csv = first(call, count);
        let of = examined(call, file, options, &csv)?;
        Ok(MeasurementPlan { readings: count, candidates, goal, csv, ..of })
    })
}

/// Returns what is expected of chosen readings, as they will be read: without the unknowns of runs that are not chosen.
fn examined(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &PlanOptions,
    csv: &str,
) -> Result<MeasurementPlan, Refused> {
    let readings = vec![("plan.csv".to_owned(), csv.to_owned())];
    let inputs = FitInputs { paths: vec![PathBuf::from("plan.csv")], ..options.inputs(&readings) };
    let problem = Problem::read(call, file, &inputs)?;
    let model = problem.model(file, Order::Exact);
    Ok(planned(file, &model, &problem.rows, expected(&model, &problem.rows, options.noise_mm)))
}

/// Returns how many of the chosen readings, in their order, reach an uncertainty (mm), and true; or all of them, and
/// false. A reading more never makes it larger, so that the number is found by bisection.
fn fewest(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &PlanOptions,
    until_mm: f64,
    first: impl Fn(&Call<'_>, usize) -> String,
) -> Result<(usize, bool), Refused> {
    let is_reached = |call: &mut Call<'_>, count: usize| {
        call.go_on()?;
        let csv = first(call, count);
        // What is said of a plan that is only tried is not said.
        let run = Run { deny_warnings: false, ..call.run };
        let tried = Call::answer(run, file.sources(), |call| examined(call, file, options, &csv));
        let um = tried.ok().and_then(|plan| plan.value.prediction.largest_um);
        Ok(um.is_some_and(|um| um <= until_mm * 1e3))
    };
    if !is_reached(call, options.poses)? {
        return Ok((options.poses, false));
    }
    // A probe touches every ball that is stated.
    let fewest = if options.instrument == PlanInstrument::Touch { options.balls.len().max(1) } else { 1 };
    let (mut short, mut enough) = (fewest - 1, options.poses);
    while enough - short > 1 {
        let middle = short + (enough - short) / 2;
        if is_reached(call, middle)? {
            enough = middle;
        } else {
            short = middle;
        }
    }
    Ok((enough, true))
}

impl PlanOptions {
    /// The same without what an instrument needs.
    fn of_file(&self) -> Self {
        let (instrument, probe) = (PlanInstrument::Points, ProbeSizes::default());
        Self { instrument, balls: Vec::new(), probe, ranges: None, ..self.clone() }
    }

    fn inputs<'a>(&'a self, texts: &'a [(String, String)]) -> FitInputs<'a> {
        let names = texts.iter().map(|(name, _)| PathBuf::from(name));
        FitInputs {
            fit: &self.fit,
            fixed: &self.fixed,
            priors: &self.priors,
            type_b: &[],
            paths: self.candidates.iter().cloned().chain(names).collect(),
            texts,
            is_plan: true,
            frame: Frame::Workpiece,
            axis_poses: None,
            order: Order::Exact,
            robust: false,
            folds: None,
            range: FitRange::Travel,
            noise: None,
            accept: Vec::new(),
        }
    }
}

/// Returns the table of what the instrument could read.
fn table(call: &mut Call<'_>, file: &MachineFile, options: &PlanOptions) -> Result<String, Refused> {
    let touches = options.instrument == PlanInstrument::Touch;
    let of_balls = touches || options.instrument == PlanInstrument::RTest;
    if !of_balls && !options.balls.is_empty() {
        return call.usage("balls are of the instruments `r-test` and `touch`");
    }
    if !touches && options.probe != ProbeSizes::default() {
        return call.usage("sizes of balls and probe are of the instrument `touch`");
    }
    if !options.probe.are_possible() {
        return call.usage("lengths are above 0, and the shaft of the stylus is thinner than its ball");
    }
    if of_balls && !file.axes().iter().any(|axis| axis.kind == AxisKind::Rotary) {
        return call.usage("the machine has no rotary axis to turn");
    }
    let usual = within(file, 0.75);
    let mut balls = Vec::new();
    for text in &options.balls {
        balls.push(pose_by_names(file, text, usual.clone()).or_else(|refusal| call.refuse(refusal))?);
    }
    check(call, file, &balls)?;
    if balls.is_empty() {
        balls.push(usual);
    }
    let help = "put the ball at another place: `--ball X=250,Y=200`";
    let table = options.instrument.table(file, &balls, &options.probe, options.seed).or_else(|why| {
        let message = format!("an R-test cannot be driven at a ball: {}", why.words());
        call.refuse(Diagnostic::new(codes::E0612, message).help(help))
    })?;
    let lacks = |number: &usize| !table.lines().any(|line| line.starts_with(&format!("b{number},")));
    if let Some(number) = (1..=balls.len()).find(|number| touches && lacks(number)) {
        let message = format!("ball b{number} is touched with a clear shaft in none of the poses that were tried");
        return call.refuse(Diagnostic::new(codes::E0612, message).help(help));
    }
    if touches && options.poses < balls.len() {
        return call.usage(format!("a plan for {} touches each: take more poses", counted(balls.len(), "ball")));
    }
    Ok(table)
}

/// Returns the lines of the chosen readings, below the head of their table.
fn lines(call: &Call<'_>, chosen: &[&Measurement]) -> String {
    let Some(first) = chosen.first() else { return String::new() };
    let text = call.diagnostics.sources.text(first.place.source);
    let is_title = |line: &str| !line.trim().is_empty() && !line.starts_with('#') && !line.starts_with("//");
    let head = text.lines().position(is_title).map_or(0, |title| title + 1);
    let mut csv: String = text.lines().take(head).map(|line| format!("{line}\n")).collect();
    let mut met = BTreeSet::new();
    for row in chosen {
        if met.insert(row.place.range.start) {
            csv += text.get(row.place.range.clone()).unwrap_or_default().trim_end_matches(['\r', '\n']);
            csv += "\n";
        }
    }
    csv
}

fn planned(
    machine: &Machine,
    model: &FitModel<'_>,
    chosen: &[Measurement],
    (expected, prediction): (Solution, Prediction),
) -> MeasurementPlan {
    let parameter = |(p, e): (&Parameter, &Estimate)| ExpectedParameter {
        name: p.name.clone(),
        sigma: e.sigma.map(|s| p.in_unit(s)),
        unit: p.unit.clone(),
    };
    let own = &model.parameters()[..model.own()];
    let (largest_um, combination) = match prediction.uncertainty {
        DeviationUncertainty::Known(mm) => (Some(mm * 1e3), None),
        DeviationUncertainty::Unknown => (None, None),
        DeviationUncertainty::Free(words) => (None, Some(words)),
    };
    let at = axis_positions(machine, &prediction.pose);
    MeasurementPlan {
        poses: chosen.iter().map(|row| planned_pose(model, row)).collect(),
        readings: 0,
        candidates: 0,
        noise_um: expected.sigma * 1e3,
        parameters: own.iter().zip(&expected.estimates).map(parameter).collect(),
        prediction: ExpectedPrediction { largest_um, combination, at },
        goal: None,
        rank: expected.rank,
        rank_first_order: expected.rank_first_order,
        unknowns: model.parameters().len(),
        well_determined: expected.well_determined,
        null_space: expected.null_space.clone(),
        below_noise: expected.below_noise.clone(),
        condition: expected.condition,
        free: expected.null_space_summary(),
        csv: String::new(),
    }
}

fn planned_pose(model: &FitModel<'_>, row: &Measurement) -> PlannedPose {
    let machine = model.machine(row);
    let mut poses =
        row.poses().map(|pose| machine.axes().iter().zip(pose).map(|(axis, q)| (axis.name.to_string(), *q)).collect());
    let (axes, to) = (poses.next().unwrap_or_default(), poses.next());
    PlannedPose { axes, to, tool: machine.tool().name.clone(), run: row.run.clone() }
}
