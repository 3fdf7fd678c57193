//! `abbe map`: the error over a volume.

use crate::cli::arguments::{
    AxisPosesArg, FrameOption, JobArg, PlaceArg, ReferenceArg, SamplesArg, SeedArg, ToolPosesArg, ViewArgs, counts,
    help,
};
use crate::cli::how::CompensationArgs;
use crate::cli::output::map_output::{OutputArgs, PictureArgs};
use crate::cli::output::session::Session;
use crate::cli::output::view::{
    STATISTICS, axes_text, frame_text, path_text, reach_text, statistics_rows, table, tool_poses_text,
};
use crate::cli::output::{bands, bounded, characteristics, placement};
use crate::cli::store::write::refuse_outputs;
use crate::cli::tolerances::BoundsArgs;
use crate::cli::{Format, Outcome};
use abbe::options::{MapPoses, MapTable, TableForm};
use abbe::results::{BeyondMeasured, MapFromBounds, MapResult, Statistics};
use abbe::text::{counted, shown, significant};
use abbe::{Diagnostic, MachineFile, MapOptions, PlacementOptions, codes, map_tables, place};
use std::io::Cursor;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(mut_arg("tool_poses", |option| option.conflicts_with_all(["random", "low_discrepancy"])))]
#[command(mut_arg("job", |option| option.conflicts_with_all(["random", "low_discrepancy", "tool_poses"])))]
#[command(mut_arg("axis_poses", |option| {
    option.conflicts_with_all(["random", "low_discrepancy", "tool_poses", "job", "place"])
}))]
#[command(mut_arg("place", |option| {
    let files = ["csv", "json", "parquet", "vtk", "plane", "at", "drawing"];
    option.conflicts_with_all(["random", "low_discrepancy", "target"]).conflicts_with_all(files)
}))]
pub(crate) struct Args {
    /// The machine file; its `volume` is the grid.
    machine: PathBuf,
    /// Evaluate N random poses instead of the grid (1 to 1000000000) [default: the grid].
    #[arg(long, value_name = "N", value_parser = counts(1..=MapPoses::MAX as i64))]
    random: Option<usize>,
    /// Evaluate N low-discrepancy poses instead of the grid, spread more evenly than random ones (1 to 1000000000)
    /// [default: the grid].
    #[arg(long, value_name = "N", conflicts_with = "random",
        value_parser = counts(1..=MapPoses::MAX as i64))]
    low_discrepancy: Option<usize>,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    axis_poses: AxisPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    place: PlaceArg,
    #[command(flatten)]
    reference: ReferenceArg,
    #[command(flatten)]
    seed: SeedArg,
    #[arg(long, value_name = "NAME", help = help::TARGET,
        long_help = "Map the residual after the compensation of this controller, beside the uncompensated error; \
                     `abbe targets` lists them. Kinematic parameters and tables for what they leave: A+B")]
    target: Option<String>,
    #[command(flatten)]
    how: CompensationArgs,
    #[command(flatten)]
    bounds: BoundsArgs,
    #[command(flatten)]
    samples: SamplesArg,
    #[command(flatten)]
    view: ViewArgs,
    /// Map the part of one degree in the errors alone (1 to 6); 2 is what products of two errors do [default: all
    /// degrees of the order].
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u8).range(1..=6))]
    degree: Option<u8>,
    #[command(flatten)]
    frame: FrameOption,
    /// Number of the worst poses to name (0 to 100000).
    #[arg(long, value_name = "K", default_value_t = 5, value_parser = counts(0..=100_000))]
    worst: usize,
    #[command(flatten)]
    outputs: OutputArgs,
    #[command(flatten)]
    pictures: PictureArgs,
}

impl Args {
    fn options(&self) -> MapOptions {
        let job = self.job.job.as_ref();
        let axis_poses = self.axis_poses.axis_poses.clone().map(MapPoses::AxisPoses);
        let poses = match (self.tool_poses.tool_poses.as_ref().or(job), self.random, self.low_discrepancy) {
            (Some(path), ..) if job.is_some() => MapPoses::Job(path.clone()),
            (Some(path), ..) => MapPoses::ToolPoses(path.clone()),
            (_, Some(count), _) => MapPoses::Random(count),
            (.., Some(count)) => MapPoses::LowDiscrepancy(count),
            _ => MapPoses::Grid,
        };
        MapOptions {
            poses: axis_poses.unwrap_or(poses),
            seed: self.seed.seed,
            order: self.view.order.order,
            degree: self.degree,
            reference: self.reference.reference.clone(),
            path: self.job.path,
            approach: self.view.direction.direction,
            frame: self.frame.frame,
            worst: self.worst,
            picture: self.pictures.options(),
            target: self.target.clone(),
            compensation: self.how.options(),
            tolerances: self.bounds.options(),
            samples: self.samples.samples,
            played: false,
        }
    }
}

impl Args {
    fn placement(&self, ranges: &str) -> PlacementOptions {
        PlacementOptions {
            ranges: ranges.to_owned(),
            figure: true,
            job: self.job.job.clone(),
            tool_poses: self.tool_poses.tool_poses.clone(),
            path: self.job.path,
            reference: self.reference.reference.clone(),
            order: self.view.order.order,
            approach: self.view.direction.direction,
            tolerances: self.bounds.options(),
            samples: self.samples.samples,
            seed: self.seed.seed,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.view.tool.name())?;
    // Refusals come before the work.
    let outputs = || args.outputs.paths().chain(args.pictures.paths());
    refuse_outputs(outputs(), &session.files).or_else(|d| session.refuse(d))?;
    args.pictures.refuse_unfit(session)?;
    if let Some(ranges) = &args.place.place {
        let result = session.take(place(&file, &args.placement(ranges), session.run()))?;
        // Tool poses are among the files read by now.
        refuse_outputs(outputs(), &session.files).or_else(|d| session.refuse(d))?;
        return placement::show(session, &result, args.pictures.files());
    }
    let options = args.options();
    if let Some(count) = options.poses.count(&file).filter(|count| session.format() == Format::Csv && too_long(*count))
    {
        return session.refuse(no_table(count));
    }
    let mut printed = Cursor::new(Vec::new());
    let staged = args.outputs.begin().or_else(|d| session.refuse(d))?;
    let mut tables = staged.tables().or_else(|d| session.refuse(d))?;
    if session.format() == Format::Csv {
        tables.push(MapTable {
            name: "standard output".to_owned(),
            form: TableForm::Csv,
            sink: Box::new(&mut printed),
        });
    }
    let result = session.take(map_tables(&file, &options, tables, session.run()))?;
    // Tool poses and templates are among the files read by now.
    refuse_outputs(outputs(), &session.files).or_else(|d| session.refuse(d))?;
    staged.commit().or_else(|d| session.refuse(d))?;
    args.pictures.write(session, result.picture.as_ref())?;
    session.show(&result, || String::from_utf8_lossy(printed.get_ref()).into_owned(), || text(&file, args, &result))
}

fn too_long(count: usize) -> bool {
    (MapPoses::MAX_HELD + 1..=MapPoses::MAX).contains(&count)
}

fn no_table(count: usize) -> Diagnostic {
    let max = MapPoses::MAX_HELD;
    Diagnostic::new(codes::E0541, format!("a table of {count} poses does not go to standard output: {max} at most"))
        .help(
            "write it to a file with `--csv FILE` or `--parquet FILE`: that takes no memory, but 80 to 200 bytes \
         of disk per pose",
        )
}

fn text(file: &MachineFile, args: &Args, result: &MapResult) -> String {
    if let Some(of) = &result.bounds {
        return text_of_bounds(file, args, result, of);
    }
    let mut text = abbe::headlines::map(result);
    text += &format!(
        "{}: deviation of the functional point, actual minus nominal, {} frame, {}\n{}{} ({})\n{}\n",
        result.machine,
        frame_text(result.frame),
        result.degree.map_or_else(|| format!("order {}", result.order), |k| format!("degree {k} in the errors alone")),
        result.over.text(),
        counted(result.poses, "pose"),
        sampling(args, result),
        statistics(result),
    );
    if let Some(uncertainty) = &result.uncertainty {
        text.push_str(&bands::text(&[(String::new(), uncertainty)]));
    }
    text.push_str(&result.beyond_measured.as_ref().map_or_else(String::new, beyond_measured));
    text.push_str(&result.bounds_add.as_ref().map_or_else(String::new, bounded::bounded_contribution));
    for (i, worst) in result.worst.iter().enumerate() {
        let [x, y, z] = worst.deviation_um.map(|v| significant(v, 4));
        let length = significant(worst.length_um, 4);
        let lead = if i == 0 { "Worst:" } else { "      " };
        text.push_str(&format!("{lead} {length} um ({x}, {y}, {z}) at {}\n", axes_text(file, worst.axes.values())));
    }
    text.push_str(&features(result));
    text.push_str(&characteristics::text(&result.characteristics));
    if let Some(reached) = &result.tool_poses {
        text.push_str(&reach_text(&reached.rows, &reached.travel));
        text.push_str(&result.path.as_ref().map_or_else(String::new, path_text));
    }
    if !result.diagonals.is_empty() {
        let list = result.diagonals.iter().map(|d| format!("{} {}", d.name, significant(d.range_um, 4)));
        let list = list.collect::<Vec<_>>().join(", ");
        text.push_str(&format!("Body diagonals, range of the displacement along them, um: {list}\n"));
    }
    text
}

/// The poses beyond what was measured, in words.
fn beyond_measured(of: &BeyondMeasured) -> String {
    format!("{} of {} poses are beyond what was measured: {}\n", of.poses, of.of, bands::ranges(&of.measured))
}

/// The map of a machine of which nothing is measured.
fn text_of_bounds(file: &MachineFile, args: &Args, result: &MapResult, of: &MapFromBounds) -> String {
    let mut text = abbe::headlines::map(result);
    text += &format!(
        "{}: deviation of the functional point that the bounds lead to; nothing is measured\n{}\n{}{} ({}), {} \
         frame, first order\n{}\n{}\n{}{}",
        result.machine,
        bounded::source(&of.figures),
        result.over.text(),
        counted(result.poses, "pose"),
        sampling(args, result),
        frame_text(result.frame),
        bounded::statistics(result.poses, &of.figures),
        bounded::ROWS_NOTE,
        bounded::everywhere(&of.figures),
        bounded::worst(file, of),
    );
    text.push_str(&features(result));
    text.push_str(&characteristics::text(&result.characteristics));
    if let Some(reached) = &result.tool_poses {
        text.push_str(&reach_text(&reached.rows, &reached.travel));
        text.push_str(&result.path.as_ref().map_or_else(String::new, path_text));
    }
    text
}

/// The largest deviation on each feature, and the errors that dominate there.
fn features(result: &MapResult) -> String {
    if result.features.is_empty() {
        return String::new();
    }
    let bounded = result.bounds.is_some();
    let lengths = if bounded { ["largest 95 %, um", "95 % of poses, um"] } else { ["max, um", "95 %, um"] };
    let mut rows = table(&["feature", "poses", lengths[0], lengths[1], "line", "errors there, um"]);
    for f in &result.features {
        let um = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 4));
        let poses =
            if f.unreached > 0 { format!("{} of {}", f.poses, f.poses + f.unreached) } else { f.poses.to_string() };
        let errors = f.errors.iter().map(|e| format!("{} {}", e.error, significant(e.um, 3)));
        let errors = errors.collect::<Vec<_>>().join(", ");
        let line = f.line.map_or("-".to_owned(), |line| line.to_string());
        let name = if f.feature.is_empty() { "-".to_owned() } else { shown(&f.feature) };
        let _ = rows.add_row([name, poses, um(f.max_um), um(f.p95_um), line, errors]);
    }
    let head = if bounded {
        "Largest 95 % value on each feature, with the errors that make most there, each alone at its bound:"
    } else {
        "Largest deviation on each feature, with the parts of errors along it:"
    };
    format!("{head}\n{rows}\n")
}

/// Source of the poses.
fn sampling(args: &Args, result: &MapResult) -> String {
    match (&result.tool_poses, &result.grid) {
        (Some(reached), _) => tool_poses_text(reached),
        (_, Some(counts)) => counts.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ") + " grid",
        _ if args.random.is_none() => "low-discrepancy over the volume".to_owned(),
        _ => "random over the volume".to_owned(),
    }
}

/// One pair of rows, or two: without compensation and with.
fn statistics(result: &MapResult) -> comfy_table::Table {
    let all = result.statistics();
    let Some(before) = &result.uncompensated else {
        let mut table = table(&STATISTICS[1..]);
        let _ = table.add_rows(statistics_rows("", &all).map(|row| row.into_iter().skip(1)));
        return table;
    };
    let before = Statistics { position_um: before.position_um, rotation_urad: before.rotation_urad, ..all };
    let mut table = table(&STATISTICS);
    let _ = table.add_rows(statistics_rows("before", &before));
    let _ = table.add_rows(statistics_rows(&format!("after {}", result.target.as_deref().unwrap_or_default()), &all));
    table
}
