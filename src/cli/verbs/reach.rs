//! `abbe reach`: tips and directions of the tool within reach over a box.

use crate::cli::Outcome;
use crate::cli::arguments::{
    JobArg, PictureFile, PlaceArg, ReferenceArg, ToolArg, ToolPosesArg, counts, help, length, png, svg,
};
use crate::cli::output::placement;
use crate::cli::output::session::Session;
use crate::cli::output::view::{path_text, reach_text};
use crate::cli::store::write::{refuse_outputs, write_whole};
use abbe::results::ReachResult;
use abbe::text::{Reason, significant};
use abbe::{PlacementOptions, ReachOptions, place, reach};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(mut_arg("tool_poses", |option| option.conflicts_with_all(["region", "step", "directions"])))]
#[command(mut_arg("job", |option| option.conflicts_with_all(["tool_poses", "region", "step", "directions"])))]
#[command(mut_arg("place", |option| option.conflicts_with_all(["region", "step", "directions", "vtk"])))]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Box of the tips in the workpiece frame, mm [default for each side: where the linear axes carry the tip, rotary
    /// axes at rest; for robots where any axis does].
    #[arg(long = "box", value_name = "X=-100..100,Z=0..200", allow_hyphen_values = true)]
    region: Option<String>,
    /// Largest distance of neighbouring tips (above 0) [default: an eighth of the longest side, for robots a third].
    #[arg(long, value_name = "LENGTH", value_parser = step)]
    step: Option<f64>,
    /// Number of tool directions (1 to 100000) [default: 60, for robots 6], over the hemisphere about the tool axis at
    /// rest. With one axis that turns the tool they are on its circle, with none there is one.
    #[arg(long, value_name = "N", value_parser = counts(1..=100_000))]
    directions: Option<usize>,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    reference: ReferenceArg,
    #[command(flatten)]
    place: PlaceArg,
    #[command(flatten)]
    tool: ToolArg,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw sections of the box, coloured by shares of directions, or with `--place` the places of the \
                     part, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
    #[arg(long, value_name = "FILE", value_parser = png, help = help::PNG,
        long_help = "The same, as PNG unless the file ends in .svg")]
    png: Option<PictureFile>,
    #[arg(long, value_name = "FILE", help = help::VTK,
        long_help = "Write the tips with their shares as a structured grid of VTK (`.vts`), which ParaView opens")]
    vtk: Option<PathBuf>,
}

fn step(text: &str) -> Result<f64, Reason> {
    length(text, |mm| mm > 0.0 && mm.is_finite(), "a step is a length above 0, such as `25 mm`")
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.tool.name())?;
    let pictures = args.svg.iter().chain(&args.png);
    PictureFile::refuse(session, pictures.clone())?;
    refuse_outputs(&args.vtk, &session.files).or_else(|d| session.refuse(d))?;
    let is_job = args.job.job.is_some() || args.tool_poses.tool_poses.is_some();
    if let Some(ranges) = &args.place.place {
        let options = PlacementOptions {
            ranges: ranges.clone(),
            job: args.job.job.clone(),
            tool_poses: args.tool_poses.tool_poses.clone(),
            path: args.job.path,
            reference: args.reference.reference.clone(),
            ..PlacementOptions::default()
        };
        let result = session.take(place(&file, &options, session.run()))?;
        return placement::show(session, &result, pictures);
    }
    if is_job && pictures.clone().next().is_some() {
        return session.usage("the picture is of a box or of places: omit `--svg` and `--png`, or add `--place`");
    }
    let options = ReachOptions {
        region: args.region.clone(),
        step_mm: args.step,
        directions: args.directions,
        tool_poses: args.tool_poses.tool_poses.clone(),
        job: args.job.job.clone(),
        path: args.job.path,
        reference: args.reference.reference.clone(),
    };
    let result = session.take(reach(&file, &options, session.run()))?;
    for to in pictures {
        to.write(&result.picture(), session)?;
    }
    if let Some(path) = &args.vtk {
        write_whole(path, &result.vtk(), &session.files).or_else(|d| session.refuse(d))?;
    }
    session.show(&result, || csv(&result), || text(&result))
}

fn csv(of: &ReachResult) -> String {
    let event = |i: usize| of.events.get(i).map_or_else(String::new, |event| format!(",{event}"));
    let row = |(i, ([x, y, z], share)): (usize, ([f64; 3], f64))| format!("{x},{y},{z},{share}{}\n", event(i));
    let head = if of.events.is_empty() { "" } else { ",event" };
    format!("X [mm],Y [mm],Z [mm],share{head}\n{}", of.tips().enumerate().map(row).collect::<String>())
}

fn percent(part: usize, whole: usize) -> String {
    format!("{} %", significant(100.0 * part as f64 / whole as f64, 4))
}

fn text(of: &ReachResult) -> String {
    let side = |k: usize| {
        let [min, max] = of.box_mm[k].map(|x| significant(x, 7));
        format!("{} {min} .. {max}", ["X", "Y", "Z"][k])
    };
    let tool = if of.tool.is_empty() { String::new() } else { format!(", tool {}", of.tool) };
    let [x, y, z] = of.counts;
    let counts = if of.job.is_some() { String::new() } else { format!(" ({x} x {y} x {z})") };
    let mut text = format!(
        "{}: reach of the nominal machine{tool}\n{}{} tips{counts}: {} mm, workpiece frame\n{}\n",
        of.machine,
        of.over.text(),
        of.tips,
        [0, 1, 2].map(side).join(", "),
        of.directions_text()
    );
    let some = (of.tips_in_any_direction, of.tips_in_all_directions);
    text += &format!("\nreached            {} of {} tool poses\n", percent(of.reached, of.tool_poses), of.tool_poses);
    if of.job.is_none() {
        text += &format!("any direction      {} of the tips ({})\n", percent(some.0, of.tips), some.0);
        text += &format!("all directions     {} of the tips ({})\n", percent(some.1, of.tips), some.1);
    }
    let missed = &of.unreachable;
    if missed.total > 0 {
        text += &format!(
            "out of reach       {}: direction {}, place {}, travel {}\n",
            missed.total, missed.direction, missed.place, missed.travel
        );
        if missed.not_proved > 0 {
            text +=
                &format!("not proved         {} of them: no pose was found, and there may be one\n", missed.not_proved);
        }
        let lacks: Vec<String> = of.lacks.iter().map(|lack| format!("  {}\n", lack.words("tool pose"))).collect();
        text += &lacks.concat();
    }
    text += &of.job.as_ref().map_or_else(String::new, |job| reach_text(&job.rows, &job.travel));
    text + &of.path.as_ref().map_or_else(String::new, path_text)
}
