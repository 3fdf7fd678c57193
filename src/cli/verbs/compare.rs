//! `abbe compare`: machines side by side on the same tool poses.

use crate::analysis::{Comparison, ErrorContribution, UnreachableCount, Work};
use crate::analysis::{compare, contributions};
use crate::cli::output::budgets::{Budgets, Drawn, budgets};
use crate::cli::output::progress::Progress;
use crate::cli::output::session::Session;
use crate::cli::output::view::{STATISTICS, ViewArgs, cell, numbers, order_text, statistics_rows, table};
use crate::cli::poses::check;
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::tool_poses;
use crate::cli::tool_poses::ToolPoses;
use crate::cli::{Format, Outcome, load};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Bare, Field, Statistics};
use crate::machine::{Machine, Pose};
use crate::units::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Two or more machine files; differences are to the first, and tool poses are drawn from its volume.
    #[arg(required = true, num_args = 2..)]
    machines: Vec<PathBuf>,
    /// How many tool poses.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    poses: u32,
    /// The tool poses themselves, in the workpiece frame: a CSV file with columns X, Y, Z and I, J, K, or rotary axes of
    /// the first machine.
    #[arg(long, value_name = "FILE", conflicts_with = "poses")]
    tool_poses: Option<PathBuf>,
    /// Seed of the tool poses, and of the errors that are drawn.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How many errors to list one by one as text.
    #[arg(long, value_name = "K", default_value_t = 10)]
    top: usize,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// How many machines are drawn for the budgets, which are compared where every machine bounds errors.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    samples: u32,
    #[command(flatten)]
    view: ViewArgs,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let mut machines = Vec::new();
    for path in &args.machines {
        machines.push(load::machine(session, path, args.view.tool.as_deref())?);
    }
    let bare: Vec<Bare<'_>> =
        machines.iter().map(|machine| Bare { machine, order: args.view.order(machine) }).collect();
    let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
    let file = match &args.tool_poses {
        Some(path) => Some(tool_poses::read(session, &machines[0], path)?),
        None => None,
    };
    let work = match &file {
        Some(file) => Work::Listed(file.list(&machines[0])),
        None => Work::random(&machines[0], args.poses as usize, args.seed),
    };
    let progress = Progress::new(work.len(), session.is_quiet());
    let comparison = compare(&fields, &work, args.view.approach(), &|count| progress.add(count));
    drop(progress);
    if let Some(file) = &file {
        for (machine, side) in machines.iter().zip(&comparison.machines) {
            file.say(session, machine, &side.missed)?;
            check(session, machine, &side.reached.iter().map(|(pose, _)| pose.clone()).collect::<Vec<_>>())?;
        }
    }
    let poses = |side: &crate::analysis::MachineResult| side.reached.iter().map(|(pose, _)| pose.clone()).collect();
    let sides: Vec<(&Machine, Vec<Pose>)> = machines.iter().zip(comparison.machines.iter().map(poses)).collect();
    let errors = contributions(&sides, args.view.approach());
    if comparison.common.is_empty() {
        return session.refuse(nothing_in_common(args, &comparison));
    }
    let budgets = budgets(
        session,
        &sides,
        Drawn { tolerances: &args.tolerances, samples: args.samples as usize, seed: args.seed },
    )?;
    let report = Report { args, machines: &machines, comparison: &comparison, errors, budgets, file };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

fn nothing_in_common(args: &Args, comparison: &Comparison) -> Diagnostic {
    let missed = |(file, m): (String, &UnreachableCount)| format!("{file} misses {}", reasons(m));
    let sides = files(args).zip(comparison.machines.iter().map(|c| &c.unreachable));
    let help = sides.map(missed).collect::<Vec<_>>().join("; ");
    let message = format!("none of the {} tool poses is reached by all machines", comparison.asked);
    Diagnostic::new(codes::E0813, message).help(format!(
        "{help}. Tool poses count from the workpiece origin: give the machines comparable ones, or narrow the first one's `volume`"
    ))
}

/// `12: 3 direction, 9 travel`.
fn reasons(missed: &UnreachableCount) -> String {
    let each = [(missed.direction, "direction"), (missed.place, "place"), (missed.travel, "travel")];
    let list: Vec<String> = each.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect();
    if list.is_empty() { "0".to_owned() } else { format!("{} ({})", missed.total, list.join(", ")) }
}

/// What is printed.
struct Report<'a> {
    args: &'a Args,
    machines: &'a [Machine],
    comparison: &'a Comparison,
    errors: Vec<ErrorContribution>,
    budgets: Option<Budgets>,
    file: Option<ToolPoses>,
}

fn files(args: &Args) -> impl Iterator<Item = String> {
    args.machines.iter().map(|path| path.display().to_string())
}

impl Report<'_> {
    fn files(&self) -> impl Iterator<Item = String> {
        files(self.args)
    }

    fn json(&self) -> serde_json::Value {
        let side = |((machine, file), c): ((&Machine, String), &crate::analysis::MachineResult)| {
            let mut json = json!({
                "machine": machine.name(), "file": file, "order": order_text(self.args.view.order(machine)),
                "unreachable": c.unreachable, "position_um": c.statistics.position_um,
                "rotation_urad": c.statistics.rotation_urad, "minus_first": c.difference,
            });
            if let Some(work) = &self.file {
                json["missed"] = work.lines(&c.missed).into();
            }
            json
        };
        let machines: Vec<_> =
            self.machines.iter().zip(self.files()).zip(&self.comparison.machines).map(side).collect();
        let error = |e: &ErrorContribution| {
            let minus: Vec<f64> = (0..e.um.len()).map(|i| e.minus_first(i)).collect();
            json!({"error": e.error, "um": e.um, "minus_first": minus})
        };
        let mut json = json!({
            "contributions": self.errors.iter().map(error).collect::<Vec<_>>(),
            "asked": self.comparison.asked, "poses": self.comparison.common.len(), "seed": self.args.seed,
            "frame": "workpiece", "direction": self.args.view.approach(), "machines": machines,
        });
        if let Some(budgets) = &self.budgets {
            json["budgets"] = budgets.json(self.machines);
        }
        json
    }

    /// One line for each tool pose and machine.
    fn csv(&self) -> String {
        let mut csv =
            "pose,file,x [mm],y [mm],z [mm],i,j,k,dx [um],dy [um],dz [um],wx [urad],wy [urad],wz [urad]\n".to_owned();
        for (pose, target) in self.comparison.common.iter().enumerate() {
            for (file, side) in self.files().zip(&self.comparison.machines) {
                let (_, d) = &side.reached[pose];
                let vectors = [target.tip, target.direction, d.position * 1e3, d.rotation * 1e6];
                let values = numbers(vectors.iter().flat_map(|v| v.iter().copied()));
                csv.push_str(&format!("{pose},{},{values}\n", cell(&file)));
            }
        }
        csv
    }

    fn text(&self) -> String {
        let c = self.comparison;
        let mut text = format!(
            "{} tool poses in the workpiece frame, {}; {} reached by all\n",
            c.asked,
            match &self.args.tool_poses {
                Some(path) => format!("of {}", path.display()),
                None => format!("drawn from the volume of {}", self.machines[0].name()),
            },
            c.common.len()
        );
        for (i, ((machine, file), side)) in self.machines.iter().zip(self.files()).zip(&c.machines).enumerate() {
            let missed = reasons(&side.unreachable);
            text.push_str(&format!(
                "  {}  {} ({file}), {}: unreachable {missed}\n",
                i + 1,
                machine.name(),
                machine.chain()
            ));
        }
        let mut rows = table(&STATISTICS);
        for (i, side) in c.machines.iter().enumerate() {
            let _ = rows.add_rows(statistics_rows(&(i + 1).to_string(), &side.statistics));
        }
        for (i, side) in c.machines.iter().enumerate().skip(1) {
            let (position_um, rotation_urad) = (side.difference.position_um, side.difference.rotation_urad);
            let difference = Statistics { poses: c.common.len(), position_um, rotation_urad };
            let _ = rows.add_rows(statistics_rows(&format!("{} - 1", i + 1), &difference));
        }
        let budgets = self.budgets.as_ref().map_or(String::new(), |budgets| budgets.text(self.args.top));
        format!("{text}{rows}\n{}{budgets}Negative differences: less error than machine 1.\n", self.one_by_one())
    }

    /// The errors that do most in any of the machines.
    fn one_by_one(&self) -> String {
        if self.errors.is_empty() || self.args.top == 0 {
            return String::new();
        }
        let count = self.machines.len();
        let columns = (1..=count).map(|i| i.to_string()).chain((2..=count).map(|i| format!("{i} - 1")));
        let header: Vec<String> = std::iter::once("alone, 95 %, um".to_owned()).chain(columns).collect();
        let mut rows = table(&header.iter().map(String::as_str).collect::<Vec<_>>());
        for e in self.errors.iter().take(self.args.top) {
            let own = e.um.iter().map(|um| um.map_or("-".to_owned(), |um| significant(um, 4)));
            let minus = (1..count).map(|i| significant(e.minus_first(i), 4));
            let _ = rows.add_row(std::iter::once(e.error.to_string()).chain(own).chain(minus));
        }
        let more = match self.errors.len().saturating_sub(self.args.top) {
            0 => String::new(),
            n => format!("... and {n} errors more (`--top {}`, or `--format json`)\n", self.errors.len()),
        };
        format!("{rows}\n{more}")
    }
}
