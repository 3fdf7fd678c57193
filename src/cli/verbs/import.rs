//! `abbe import`: a single-axis measurement as an instrument exports it, to a table of error curves; the log of a touch
//! probe, to touches of balls.

use crate::cli::arguments::{PictureFile, ToolArg, counts, help, svg};
use crate::cli::output::session::Session;
use crate::cli::output::touch_report;
use crate::cli::output::view::{hide, table};
use crate::cli::store::write;
use crate::cli::{Format, Outcome};
use abbe::options::{Acceptance, FileContents, RunApproach, StraightnessLine, TouchCoordinates};
use abbe::results::{ImportResult, ImportedError, OneWayAccuracy};
use abbe::text::{NOT_VERIFIED, counted, significant};
use abbe::{ImportOptions, TouchOptions, import, import_touches};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The export: text, UTF-8 or UTF-16, comma, semicolon or tab.
    file: PathBuf,
    #[arg(long, value_name = "AXIS", help = help::AXIS, long_help = "The axis that moved, if the file does not say it")]
    axis: Option<String>,
    /// The error whose runs the columns are, such as `EXX`; of several errors the only one to take.
    #[arg(long, value_name = "NAME")]
    error: Option<String>,
    /// Unit of readings that have none in the file.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Meaning of the values: errors (actual minus target) or corrections [default: errors, where the layout does not
    /// leave it open].
    #[arg(long, value_enum, value_name = "WHAT")]
    holds: Option<FileContents>,
    /// The file holds corrections, not errors: short for `--holds corrections`.
    #[arg(long, conflicts_with = "holds")]
    correction: bool,
    /// Approach of runs without a direction.
    #[arg(long, value_enum, value_name = "HOW")]
    runs: Option<RunApproach>,
    /// Direction of the beam of a six-degree instrument, from the launch to the receiver, such as `+X`.
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, requires = "vertical")]
    beam: Option<String>,
    /// The machine's direction in which the vertical of that instrument points, such as `+Z`.
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, requires = "beam")]
    vertical: Option<String>,
    /// Change the sign of a channel of that instrument, by its title; may be repeated.
    #[arg(long, value_name = "TITLE", requires = "beam")]
    flip: Vec<String>,
    /// Map the columns by this file (YAML), instead of by their titles.
    #[arg(long, value_name = "FILE")]
    columns: Option<PathBuf>,
    /// The axis turns without end: positions modulo 360 deg, first row again at the end.
    #[arg(long)]
    continuous: bool,
    /// The line that is taken off a straightness.
    #[arg(long, value_enum, value_name = "RULE", default_value = "least-squares")]
    line: StraightnessLine,
    /// Keep the line of a straightness: it was read against an artefact of the machine.
    #[arg(long, conflicts_with = "line")]
    keep_line: bool,
    /// Bring the positions of a linear axis to 20 deg C by its material, such as `22.5 degC x 11.5 um/m/K`.
    #[arg(long, value_name = "MATERIAL")]
    material: Option<String>,
    /// Contributor to the uncertainty of the figures (ISO 230-2 annex A), such as `device 0.5 um/m` (k = 2),
    /// `misalignment 1 mm`, `temperature 0.7 K x 11.5 um/m/K`, `expansion 2 um/m/K x 5 K`, `drift 1.2 um`; may be
    /// repeated.
    #[arg(long, value_name = "WORDS")]
    uncertainty: Vec<String>,
    #[arg(long, value_enum, value_name = "WORDS", value_delimiter = ',', help = help::ACCEPT)]
    accept: Vec<Acceptance>,
    /// The file is a log of touches of balls on this machine: read centres, and write the touches for `identify`.
    #[arg(long = "machine", value_name = "MACHINE", conflicts_with_all = NOT_OF_TOUCHES)]
    machine: Option<PathBuf>,
    /// Touches of a ball in a pose, of a probe file, which does not name them (4 to 1000) [default: 8].
    #[arg(long, value_name = "N", requires = "machine", value_parser = counts(4..=1000))]
    touches: Option<usize>,
    /// The meaning of X, Y, Z in a log of touches [default: what the log states, else joints].
    #[arg(long, value_enum, value_name = "WHICH", requires = "machine")]
    coordinates: Option<TouchCoordinates>,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw the runs with their means and bands of 2 s, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "Write the table to this file")]
    out: Option<PathBuf>,
    #[command(flatten)]
    tool: ToolArg,
}

/// Options of single-axis readings.
const NOT_OF_TOUCHES: [&str; 15] = [
    "axis",
    "error",
    "unit",
    "holds",
    "correction",
    "runs",
    "beam",
    "vertical",
    "columns",
    "continuous",
    "line",
    "keep_line",
    "material",
    "uncertainty",
    "svg",
];

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if let Some(machine) = &args.machine {
        return touches(session, args, machine);
    }
    let options = ImportOptions {
        axis: args.axis.clone(),
        error: args.error.clone(),
        unit: args.unit.clone(),
        contents: args.holds.or(args.correction.then_some(FileContents::Corrections)),
        runs: args.runs,
        beam: args.beam.clone(),
        vertical: args.vertical.clone(),
        flip: args.flip.clone(),
        columns: args.columns.clone(),
        line: args.line,
        keep_line: args.keep_line,
        continuous: args.continuous,
        material: args.material.clone(),
        uncertainty: args.uncertainty.clone(),
        accept: args.accept.clone(),
        needs_table: args.out.is_some() || session.format() == Format::Csv,
    };
    write::refuse_outputs(&args.out, &session.files).or_else(|refusal| session.refuse(refusal))?;
    PictureFile::refuse(session, args.svg.iter())?;
    let result = session.take(import(&args.file, &options, session.run()))?;
    if let Some(out) = &args.out {
        write::write_whole(out, result.table.as_bytes(), &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    if let Some(file) = &args.svg {
        file.write(&result.picture(), session)?;
    }
    session.show(&result, || result.table.clone(), || text(&result) + &entries(&result, args.out.as_deref()))
}

/// Entries of a machine file that take the uncertainty along, which a table does not hold.
fn entries(result: &ImportResult, out: Option<&Path>) -> String {
    let Some(out) = out else { return String::new() };
    let entry = |error: &ImportedError| {
        let of_curve = significant(error.uncertainty?.systematic, 3);
        let table = out.display();
        Some(format!("  {}: {{ table: {table}, uncertainty: {of_curve} {} }}\n", error.error, error.unit))
    };
    let entries: String = result.errors.iter().filter_map(entry).collect();
    if entries.is_empty() { entries } else { format!("With U, `errors` of the machine file takes it as\n{entries}") }
}

/// Reads a log of touches.
fn touches(session: &mut Session, args: &Args, machine: &Path) -> Outcome {
    let file = session.load(machine, args.tool.name())?;
    write::refuse_outputs(&args.out, &session.files).or_else(|refusal| session.refuse(refusal))?;
    let options = TouchOptions {
        touches: args.touches.unwrap_or(TouchOptions::default().touches),
        coordinates: args.coordinates,
        accept: args.accept.clone(),
    };
    let result = session.take(import_touches(&file, &args.file, &options, session.run()))?;
    if let Some(out) = &args.out {
        write::write_whole(out, result.table.as_bytes(), &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    session.show(&result, || result.table.clone(), || touch_report::text(&result))
}

fn text(result: &ImportResult) -> String {
    let mut text = format!("axis {}: {}, {}", result.axis, result.form, counted(result.readings, "reading"));
    text += if result.directions_inferred { "; directions from the order of the rows\n" } else { "\n" };
    for (key, value) in &result.metadata {
        text += &format!("{key}: {value}\n");
    }
    for channel in &result.channels {
        text += &format!("{} = {}{}\n", channel.error, channel.sign, channel.column);
    }
    for column in &result.columns_left_out {
        text += &format!("left out: {} ({})\n", column.column, column.reason);
    }
    for finding in &result.findings {
        text += &format!("suspect: {}\n", finding.message);
    }
    text.extend(result.errors.iter().filter_map(line));
    let mut rows = table(&["error", "unit", "targets", "runs", "", "E", "M", "B", "mean B", "R", "A", "slope"]);
    for error in &result.errors {
        add(&mut rows, error);
    }
    hide(&mut rows, &[2]);
    text += &format!("{rows}\n");
    text += "E systematic deviation, M mean deviation, B reversal, R repeatability, A accuracy: formed after ISO \
             230-2:2014\n";
    text.extend(result.errors.iter().filter_map(|error| {
        let remarks = error.remarks.join("; ");
        (!remarks.is_empty()).then(|| format!("{}: {remarks}\n", error.error))
    }));
    text + &notes(result)
}

/// Where the figures rest on what could not be compared with the text of the standard.
fn notes(result: &ImportResult) -> String {
    let mut text = String::new();
    if let Some(of) = &result.material {
        text += &format!(
            "positions at 20 degC: material at {} degC, {} um/(m K), about the first target\n",
            of.temperature_deg_c,
            significant(of.expansion_um_per_m_k, 4)
        );
    }
    if result.errors.iter().any(|error| error.uncertainty.is_some()) {
        text += "U: expanded uncertainty, k = 2, after ISO 230-2 annex A, of one direction as of both\n";
        for error in &result.errors {
            let words = error.contributors.as_ref().map(|of| format!("U of {} {}\n", error.error, of.words()));
            text += &words.unwrap_or_default();
        }
    }
    if result.errors.iter().any(|error| error.uncertainty.is_some() || !error.remarks.is_empty()) {
        text += &format!("U and the remarks on targets and runs are {NOT_VERIFIED}\n");
    }
    text
}

/// A sentence on the line of a straightness.
fn line(error: &ImportedError) -> Option<String> {
    let line = error.line.as_ref()?;
    let n = |x: f64| significant(x, 3);
    let size = format!("{} um/m, {} um over {} mm", n(line.slope_um_per_m), n(line.rise_um), n(line.length_mm));
    let squareness = line.squareness.as_ref().zip(line.squareness_urad);
    let would =
        squareness.map_or_else(String::new, |(name, value)| format!(" (it would be {name} = {} urad)", n(value)));
    Some(if line.taken_off {
        format!(
            "{}: line of {size} taken off. It is how the optics stood, unless they were set to an artefact of the \
             machine{would}: --keep-line\n",
            error.error
        )
    } else {
        format!("{}: line of {size} kept{would}\n", error.error)
    })
}

fn number(x: f64) -> String {
    significant(x, 4)
}

fn maybe(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), number)
}

/// The rows of an error: both directions together, each by itself, and the uncertainty.
fn add(rows: &mut comfy_table::Table, f: &ImportedError) {
    let (targets, runs) = (f.targets.to_string(), f.runs.to_string());
    let figures = [maybe(f.reversal), maybe(f.mean_reversal), maybe(f.repeatability), maybe(f.accuracy)];
    let first =
        [f.error.clone(), f.unit.to_owned(), targets, runs, String::new(), number(f.systematic), number(f.mean)];
    let slope = format!("{} {}", significant(f.slope, 3), f.slope_unit);
    let _ = rows.add_row(first.into_iter().chain(figures).chain([slope]));
    let beside = |name: &str, cells: [String; 6]| {
        let blank = [(); 4].map(|()| String::new());
        blank.into_iter().chain([name.to_owned()]).chain(cells).chain([String::new()])
    };
    let one = |of: OneWayAccuracy| {
        let none = || "-".to_owned();
        [number(of.systematic), none(), none(), none(), maybe(of.repeatability), maybe(of.accuracy)]
    };
    if let (Some(forward), Some(reverse)) = (f.one_way.forward, f.one_way.reverse) {
        let _ = rows.add_row(beside("forward", one(forward)));
        let _ = rows.add_row(beside("reverse", one(reverse)));
    }
    if let Some(u) = f.uncertainty {
        let cells = [u.systematic, u.mean, u.reversal, u.reversal, u.repeatability, u.accuracy].map(number);
        let _ = rows.add_row(beside("U", cells));
    }
}
