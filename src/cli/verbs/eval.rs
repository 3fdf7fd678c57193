//! `abbe eval`: deviation and E_VE at poses.

use crate::cli::output::algebra;
use crate::cli::output::effects::{Effects, inverse};
use crate::cli::output::session::Session;
use crate::cli::output::view::{FrameArg, ViewArgs, axes_json, frame_text, numbers, order_text, plain, table};
use crate::cli::poses::{PoseArgs, poses};
use crate::cli::{Format, Outcome, load};
use crate::evaluate::{Evaluation, Frame, evaluate, evaluate_over};
use crate::machine::{Approach, Machine, Pose};
use crate::units::significant;
use nalgebra::Vector3;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[command(flatten)]
    poses: PoseArgs,
    #[command(flatten)]
    view: ViewArgs,
    /// Follow errors over a Weil algebra: the machine file's, or one in the words of its section
    /// `algebra`, such as `degree: 3, generators: per-axis, vanish: [x1^2, x3*x4]`.
    #[arg(long, value_name = "ALGEBRA", num_args = 0..=1, default_missing_value = "", conflicts_with = "order")]
    algebra: Option<String>,
    /// Besides: how far the axes have to move to undo the errors, by Newton over the algebra.
    #[arg(long, requires = "algebra")]
    inverse: bool,
    /// Besides: what 1 um or 1 urad of every error does (workpiece frame).
    #[arg(long)]
    sensitivity: bool,
    /// Besides: what pairs of errors do, and how far order 1 can be trusted.
    #[arg(long, requires = "sensitivity")]
    interactions: bool,
    /// Frame of the vectors.
    #[arg(long, value_enum, default_value = "workpiece")]
    frame: FrameArg,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.view.tool.as_deref())?;
    load::warn_bounded(session, &machine);
    let poses = poses(session, &machine, &args.poses)?;
    let (order, approach, frame) = (args.view.order(&machine), args.view.approach(), args.frame.into());
    let lift = args.algebra.as_deref().map(|text| algebra::lift(session, &machine, text)).transpose()?;
    let result = |pose: &Pose| match &lift {
        Some(lift) => evaluate_over(&machine, pose, lift, approach, frame),
        None => evaluate(&machine, pose, order, approach, frame),
    };
    let results: Vec<_> = poses.iter().map(result).collect();
    let order = lift.as_ref().map_or_else(|| order_text(order), algebra::name);
    let effects =
        args.sensitivity.then(|| Effects::new(session, &machine, &poses, approach, args.interactions)).transpose()?;
    let mut displacements = Vec::new();
    for (lift, pose) in lift.iter().filter(|_| args.inverse).flat_map(|lift| poses.iter().map(move |pose| (lift, pose)))
    {
        displacements.push(inverse(session, &machine, pose, lift, approach)?);
    }
    let results = &results;
    let report = Report { machine: &machine, poses: &poses, results, order, frame, approach, effects, displacements };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

/// What is printed.
struct Report<'a> {
    machine: &'a Machine,
    poses: &'a [Pose],
    results: &'a [Evaluation],
    order: String,
    frame: Frame,
    approach: Approach,
    effects: Option<Effects>,
    /// By pose; none without `--inverse`.
    displacements: Vec<Vec<(String, f64)>>,
}

fn row(vector: &Vector3<f64>) -> [f64; 3] {
    [plain(vector.x), plain(vector.y), plain(vector.z)]
}

impl Report<'_> {
    fn rows(&self) -> impl Iterator<Item = (&Pose, &Evaluation)> {
        self.poses.iter().zip(self.results)
    }

    fn json(&self) -> serde_json::Value {
        let poses: Vec<_> = (0..self.poses.len()).map(|i| self.pose_json(i)).collect();
        json!({
            "machine": self.machine.name(), "order": self.order, "frame": frame_text(self.frame),
            "direction": self.approach, "tool": self.machine.tool().name,
            "units": {"position": "mm", "rotation": "rad", "linear_axis": "mm", "rotary_axis": "deg"},
            "poses": poses,
        })
    }

    fn pose_json(&self, index: usize) -> serde_json::Value {
        let (pose, result) = (&self.poses[index], &self.results[index]);
        let e_ve: Vec<[f64; 4]> = (0..4).map(|i| std::array::from_fn(|j| plain(result.e_ve[(i, j)]))).collect();
        let mut fields = json!({
            "axes": axes_json(self.machine, pose), "nominal": row(&result.nominal), "deviation": row(&result.deviation.position),
            "rotation": row(&result.deviation.rotation), "e_ve": e_ve,
        });
        for (name, value) in self.effects.iter().flat_map(|e| e.json(index)) {
            fields[name] = value;
        }
        if let Some(by) = self.displacements.get(index) {
            fields["inverse"] =
                by.iter().map(|(axis, by)| (axis.clone(), json!(plain(*by)))).collect::<serde_json::Map<_, _>>().into();
        }
        fields
    }

    fn axes(&self) -> impl Iterator<Item = &str> {
        self.machine.axes().iter().map(|axis| axis.name.as_str())
    }

    fn csv(&self) -> String {
        let axes = self.machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
        let names = ["x [mm]", "y [mm]", "z [mm]", "dx [mm]", "dy [mm]", "dz [mm]", "wx [rad]", "wy [rad]", "wz [rad]"];
        let header: Vec<String> = axes.chain(names.map(str::to_owned)).collect();
        let line = |(pose, result): (&Pose, &Evaluation)| {
            let deviation = &result.deviation;
            let vectors = [&result.nominal, &deviation.position, &deviation.rotation];
            let cells = pose.iter().copied().chain(vectors.into_iter().flat_map(row));
            numbers(cells)
        };
        let lines: Vec<String> = std::iter::once(header.join(",")).chain(self.rows().map(line)).collect();
        lines.join("\n")
    }

    fn text(&self) -> String {
        let units = ["dx um", "dy um", "dz um", "|d| um", "wx urad", "wy urad", "wz urad"];
        let mut table = table(&self.axes().chain(units).collect::<Vec<_>>());
        for (pose, result) in self.rows() {
            let micro = |v: &Vector3<f64>| row(v).map(|x| significant(x * 1e6, 5));
            let position = result.deviation.position * 1e-3;
            let length = significant(result.deviation.position.norm() * 1e3, 5);
            let cells = pose.iter().map(|q| significant(*q, 9)).chain(micro(&position)).chain([length]);
            let _ = table.add_row(cells.chain(micro(&result.deviation.rotation)).collect::<Vec<_>>());
        }
        let effects = self.effects.as_ref().map_or_else(String::new, Effects::text);
        format!(
            "{}: deviation of the functional point, actual minus nominal, {} frame, order {}{}{}\n{table}\n{}{effects}",
            self.machine.name(),
            frame_text(self.frame),
            self.order,
            match self.approach {
                Approach::Mean => "",
                Approach::Forward => ", approached forward",
                Approach::Reverse => ", approached in reverse",
            },
            match self.machine.tool().name.as_str() {
                "" => String::new(),
                name => format!(", tool {name}"),
            },
            self.displacements_text()
        )
    }

    fn displacements_text(&self) -> String {
        let line = |by: &Vec<(String, f64)>| {
            let axis = |(name, by): &(String, f64)| format!("{name} {}", significant(plain(*by), 6));
            format!("To undo the errors, move by (mm, deg): {}\n", by.iter().map(axis).collect::<Vec<_>>().join(", "))
        };
        self.displacements.iter().map(line).collect()
    }
}
