//! `abbe compare`: machines side by side on the same tool poses.

use crate::cli::output::session::Session;
use crate::cli::output::view::{STATISTICS, ViewArgs, cell, numbers, reach_text, statistics_rows, table};
use crate::cli::output::{bands, budgets};
use crate::cli::tolerances::ToleranceArgs;
use crate::cli::{Format, Outcome};
use abbe::results::{CompareResult, Statistics};
use abbe::text::significant;
use abbe::{CompareOptions, compare};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Two or more machine files; differences are to the first, and tool poses are drawn from its volume.
    #[arg(required = true, num_args = 2..)]
    machines: Vec<PathBuf>,
    /// Number of tool poses.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    poses: u32,
    /// The tool poses themselves, in the workpiece frame: APT CL data or a table with columns X, Y, Z and I, J, K, or
    /// rotary axes of the first machine.
    #[arg(long, value_name = "FILE", conflicts_with = "poses")]
    tool_poses: Option<PathBuf>,
    /// Seed of the tool poses, and of the errors that are drawn.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of errors to list one by one as text.
    #[arg(long, value_name = "K", default_value_t = 10)]
    top: usize,
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// Number of machines to draw for the budgets, which are compared where every machine bounds errors.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    samples: u32,
    /// Maximum number of them, drawn until every machine is told apart from the first [default: 8 times --samples].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=800_000))]
    max_samples: Option<u32>,
    #[command(flatten)]
    view: ViewArgs,
}

impl Args {
    fn options(&self) -> CompareOptions {
        CompareOptions {
            poses: self.poses as usize,
            tool_poses: self.tool_poses.clone(),
            seed: self.seed,
            tolerances: self.tolerances.options(),
            samples: self.samples as usize,
            max_samples: self.max_samples.map(|limit| limit as usize),
            order: self.view.order,
            approach: self.view.approach(),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let mut files = Vec::new();
    for path in &args.machines {
        files.push(session.load(path, args.view.tool.as_deref())?);
    }
    let answer = compare(&files, &args.options(), session.run());
    let result = session.take(answer)?;
    match session.format() {
        Format::Json => session.print_json(json!(result)),
        Format::Csv => session.print(&csv(&result)),
        Format::Text => session.print(&text(args, &result)),
    }
    Ok(())
}

/// One line for each tool pose and machine.
fn csv(result: &CompareResult) -> String {
    let mut csv =
        "pose,file,x [mm],y [mm],z [mm],i,j,k,dx [um],dy [um],dz [um],wx [urad],wy [urad],wz [urad]\n".to_owned();
    for (pose, row) in result.rows.iter().enumerate() {
        for (machine, deviation) in result.machines.iter().zip(&row.deviations) {
            let (um, urad) = (deviation.position_mm.map(|x| x * 1e3), deviation.rotation_rad.map(|x| x * 1e6));
            let values = numbers([row.tip_mm, row.direction, um, urad].into_iter().flatten());
            csv.push_str(&format!("{pose},{},{values}\n", cell(&machine.file)));
        }
    }
    csv
}

fn text(args: &Args, result: &CompareResult) -> String {
    let mut text = format!(
        "{} tool poses in the workpiece frame, {}; {} reached by all\n",
        result.asked,
        match &args.tool_poses {
            Some(path) => format!("of {}", path.display()),
            None => format!("drawn from the volume of {}", result.machines[0].machine),
        },
        result.poses
    );
    for (i, side) in result.machines.iter().enumerate() {
        let (number, missed) = (i + 1, side.unreachable);
        text.push_str(&format!("  {number}  {} ({}), {}: unreachable {missed}\n", side.machine, side.file, side.chain));
    }
    let mut rows = table(&STATISTICS);
    for (i, side) in result.machines.iter().enumerate() {
        let _ = rows.add_rows(statistics_rows(&(i + 1).to_string(), &side.statistics(result.poses)));
    }
    for (i, side) in result.machines.iter().enumerate().skip(1) {
        let (position_um, rotation_urad) = (side.minus_first.position_um, side.minus_first.rotation_urad);
        let difference = Statistics { poses: result.poses, position_um, rotation_urad };
        let _ = rows.add_rows(statistics_rows(&format!("{} - 1", i + 1), &difference));
    }
    let mut reach = String::new();
    for (i, side) in result.machines.iter().enumerate() {
        if let (Some(missed), Some(travel)) = (&side.missed, &side.travel) {
            reach.push_str(&format!("Machine {}, {}:\n{}", i + 1, side.file, reach_text(missed, travel)));
        }
    }
    let budgets = result.budgets.as_ref().map_or(String::new(), |of| budgets::text(of, args.top));
    let errors = one_by_one(result, args.top);
    let reach = uncertainty(result) + &reach;
    format!("{text}{rows}\n{reach}{errors}{budgets}Negative differences: less error than machine 1.\n")
}

/// Intervals of the figures and of their differences, and whether these are more than that.
fn uncertainty(result: &CompareResult) -> String {
    let of = || result.machines.iter().enumerate().filter_map(|(i, side)| Some((i, side.uncertainty.as_ref()?)));
    let own = of().map(|(i, bands)| ((i + 1).to_string(), &bands.own));
    let minus = of().skip(1).map(|(i, bands)| (format!("{} - 1", i + 1), &bands.minus_first));
    let mut text = bands::text(&own.chain(minus).collect::<Vec<_>>());
    for (i, bands) in of().skip(1) {
        let verdict = if bands.told_apart { "is more than" } else { "is WITHIN" };
        text += &format!("The difference {} - 1 of the 95 % position deviation {verdict} its uncertainty.\n", i + 1);
    }
    text
}

/// Errors with the largest effect in any of the machines.
fn one_by_one(result: &CompareResult, top: usize) -> String {
    let errors = &result.contributions;
    if errors.is_empty() || top == 0 {
        return String::new();
    }
    let count = result.machines.len();
    let columns = (1..=count).map(|i| i.to_string()).chain((2..=count).map(|i| format!("{i} - 1")));
    let header: Vec<String> = std::iter::once("alone, 95 %, um".to_owned()).chain(columns).collect();
    let mut rows = table(&header.iter().map(String::as_str).collect::<Vec<_>>());
    for e in errors.iter().take(top) {
        let own = e.um.iter().map(|um| um.map_or("-".to_owned(), |um| significant(um, 4)));
        let minus = e.minus_first.iter().skip(1).map(|um| significant(*um, 4));
        let _ = rows.add_row(std::iter::once(e.error.clone()).chain(own).chain(minus));
    }
    let more = match errors.len().saturating_sub(top) {
        0 => String::new(),
        n => format!("... and {n} errors more (`--top {}`, or `--format json`)\n", errors.len()),
    };
    format!("{rows}\n{more}")
}
