//! `abbe eval`: deviation and E_VE at poses.

use super::poses::{PoseArgs, poses};
use super::session::Session;
use super::{Format, Outcome, load};
use crate::evaluate::{Evaluation, Frame, MAX_DUAL_ORDER, Order, evaluate};
use crate::machine::{Approach, Machine, Pose};
use crate::units::significant;
use nalgebra::Vector3;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[command(flatten)]
    poses: PoseArgs,
    /// 1 to 6, or `exact` (the default, unless the conventions' preset names an order).
    #[arg(long, value_parser = order)]
    order: Option<Order>,
    /// Frame of the vectors.
    #[arg(long, value_enum, default_value = "workpiece")]
    frame: FrameArg,
    /// Direction of approach where forward and reverse curves were given.
    #[arg(long, value_enum, default_value = "mean")]
    direction: ApproachArg,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
}

/// Frame of vectors.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum FrameArg {
    Workpiece,
    Machine,
    Tool,
}

/// Direction of approach.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum ApproachArg {
    Mean,
    Forward,
    Reverse,
}

impl From<ApproachArg> for Approach {
    fn from(arg: ApproachArg) -> Self {
        match arg {
            ApproachArg::Mean => Self::Mean,
            ApproachArg::Forward => Self::Forward,
            ApproachArg::Reverse => Self::Reverse,
        }
    }
}

/// `exact` or a number of 1..=6.
pub(super) fn order(text: &str) -> Result<Order, String> {
    match text.parse::<u8>() {
        Ok(n) if (1..=MAX_DUAL_ORDER).contains(&n) => Ok(Order::Degree(n)),
        _ if text == "exact" => Ok(Order::Exact),
        _ => Err(format!("an order is 1 to {MAX_DUAL_ORDER}, or `exact`")),
    }
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    let poses = poses(session, &machine, &args.poses)?;
    let order = args.order.unwrap_or_else(|| default_order(&machine));
    let frame = match args.frame {
        FrameArg::Workpiece => Frame::Workpiece,
        FrameArg::Machine => Frame::Machine,
        FrameArg::Tool => Frame::Tool,
    };
    let results: Vec<_> =
        poses.iter().map(|pose| evaluate(&machine, pose, order, args.direction.into(), frame)).collect();
    let report = Report { machine: &machine, poses: &poses, results: &results, order, frame };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

fn default_order(machine: &Machine) -> Order {
    machine.conventions().default_order.map_or(Order::Exact, Order::Degree)
}

/// What is printed.
struct Report<'a> {
    machine: &'a Machine,
    poses: &'a [Pose],
    results: &'a [Evaluation],
    order: Order,
    frame: Frame,
}

/// `-0` is nobody's result.
fn plain(value: f64) -> f64 {
    value + 0.0
}

fn row(vector: &Vector3<f64>) -> [f64; 3] {
    [plain(vector.x), plain(vector.y), plain(vector.z)]
}

impl Report<'_> {
    fn order(&self) -> String {
        match self.order {
            Order::Exact => "exact".to_owned(),
            Order::Degree(n) => n.to_string(),
        }
    }

    fn frame(&self) -> &'static str {
        match self.frame {
            Frame::Workpiece => "workpiece",
            Frame::Machine => "machine",
            Frame::Tool => "tool",
        }
    }

    fn rows(&self) -> impl Iterator<Item = (&Pose, &Evaluation)> {
        self.poses.iter().zip(self.results)
    }

    fn json(&self) -> serde_json::Value {
        let poses: Vec<_> = self.rows().map(|(pose, result)| self.pose_json(pose, result)).collect();
        json!({
            "machine": self.machine.name(), "order": self.order(), "frame": self.frame(),
            "units": {"position": "mm", "rotation": "rad", "linear_axis": "mm", "rotary_axis": "deg"},
            "poses": poses,
        })
    }

    fn pose_json(&self, pose: &Pose, result: &Evaluation) -> serde_json::Value {
        let axes: serde_json::Map<_, _> =
            self.axes().zip(pose).map(|(name, q)| (name.to_owned(), json!(plain(*q)))).collect();
        let e_ve: Vec<[f64; 4]> = (0..4).map(|i| std::array::from_fn(|j| plain(result.e_ve[(i, j)]))).collect();
        json!({
            "axes": axes, "nominal": row(&result.nominal), "deviation": row(&result.deviation.position),
            "rotation": row(&result.deviation.rotation), "e_ve": e_ve,
        })
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
            cells.map(|x| plain(x).to_string()).collect::<Vec<_>>().join(",")
        };
        let lines: Vec<String> = std::iter::once(header.join(",")).chain(self.rows().map(line)).collect();
        lines.join("\n")
    }

    fn text(&self) -> String {
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let units = ["dx um", "dy um", "dz um", "|d| um", "wx urad", "wy urad", "wz urad"];
        let _ = table.set_header(self.axes().map(str::to_owned).chain(units.map(str::to_owned)).collect::<Vec<_>>());
        for (pose, result) in self.rows() {
            let micro = |v: &Vector3<f64>| row(v).map(|x| significant(x * 1e6, 5));
            let position = result.deviation.position * 1e-3;
            let length = significant(result.deviation.position.norm() * 1e3, 5);
            let cells = pose.iter().map(|q| significant(*q, 9)).chain(micro(&position)).chain([length]);
            let _ = table.add_row(cells.chain(micro(&result.deviation.rotation)).collect::<Vec<_>>());
        }
        format!(
            "{}: deviation of the functional point, actual minus nominal, {} frame, order {}\n{table}\n",
            self.machine.name(),
            self.frame(),
            self.order()
        )
    }
}
