//! `abbe measure`: a program that touches balls.

use crate::cli::Outcome;
use crate::cli::arguments::{NoiseArg, ProbeArgs, ToolArg, help};
use crate::cli::output::session::Session;
use crate::cli::store::tree::write_new_folder;
use abbe::results::MeasuringProgram;
use abbe::text::{Reason, cell, counted, significant};
use abbe::{MeasureOptions, measure};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file; its tool ends in the middle of the stylus ball.
    machine: PathBuf,
    /// The sets: a table with a row for each ball in a pose, with `ball`, `ball.x [mm]`, `ball.y [mm]`, `ball.z [mm]`
    /// and a column for each rotary axis.
    sets: PathBuf,
    #[command(flatten)]
    probe: ProbeArgs,
    /// Time between two looks of the controller at the probe, ms (0.01 to 100).
    #[arg(long, value_name = "MS", value_parser = milliseconds, default_value = "1")]
    servo_period: f64,
    #[command(flatten)]
    noise: NoiseArg,
    #[command(flatten)]
    tool: ToolArg,
    #[arg(long, value_name = "PATH", help = help::OUT,
        long_help = "Write the files of the program to this new folder")]
    out: Option<PathBuf>,
}

fn milliseconds(text: &str) -> Result<f64, Reason> {
    let ms = text.parse::<f64>().ok().filter(|ms| (0.01..=100.0).contains(ms));
    ms.ok_or_else(|| Reason::new("a period is 0.01 to 100 ms"))
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.tool.name())?;
    let options = MeasureOptions {
        sizes: args.probe.sizes(),
        noise_mm: args.noise.noise.unwrap_or(MeasureOptions::default().noise_mm),
        servo_period_s: args.servo_period / 1e3,
    };
    let program = session.take(measure(&file, &args.sets, &options, session.run()))?;
    if let Some(out) = &args.out {
        write_new_folder(out, &program.files).or_else(|refusal| session.refuse(refusal))?;
    }
    session.show(&program, || csv(&program), || text(&program, args))
}

fn csv(program: &MeasuringProgram) -> String {
    let titles = program.sets.first().map(|set| set.middle.keys().cloned().collect::<Vec<_>>().join(","));
    let line = |set: &abbe::results::MeasuredSet| {
        let middle: Vec<String> = set.middle.values().map(|q| format!("{q:.6}")).collect();
        format!("{},{},{}\n", cell(&set.ball), set.pose, middle.join(","))
    };
    format!("ball,pose,{}\n", titles.unwrap_or_default()) + &program.sets.iter().map(line).collect::<String>()
}

fn text(program: &MeasuringProgram, args: &Args) -> String {
    let sets = counted(program.sets.len(), "set");
    let mut text = format!(
        "{}: {sets}, {} logged contacts at {} mm/min, approaches at {} mm/min; for {} (syntax {})\n",
        program.machine,
        program.touches,
        program.slow_mm_per_min,
        program.fast_mm_per_min,
        program.controller,
        program.certainty
    );
    let start: Vec<String> = program.start.iter().map(|(axis, q)| format!("{axis} = {}", significant(*q, 6))).collect();
    text += &format!("Starts above all balls, at {}\n", start.join(", "));
    text += &format!("Checked for {}\n", program.checked);
    text +=
        "Every move keeps clear of balls and stems and within the travel; clamps, walls and the table are not known\n";
    text + &match &args.out {
        Some(out) => format!("Wrote {}; next: read abbe_start.ngc there\n", out.display()),
        None => "Nothing is written without --out\n".to_owned(),
    }
}
