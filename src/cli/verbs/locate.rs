//! `abbe locate`: location errors from the lines of the rotary axes that a control's own calibration found.

use crate::cli::Outcome;
use crate::cli::arguments::{InstalledArg, help};
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::store::{file_set, write};
use abbe::results::{LocateResult, LocatedAxis, LocatedError};
use abbe::text::significant;
use abbe::{LocateOptions, locate};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// A table of lines, or a folder with kinematic parameters of a controller; without it the lines of the machine
    /// file are printed, which a calibration should find.
    found: Option<PathBuf>,
    #[arg(long, value_name = "NAME", help = help::TARGET,
        long_help = "The controller of the parameters [default: the one that their files name]")]
    target: Option<String>,
    /// A folder with targets of your own.
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    #[command(flatten)]
    installed: InstalledArg,
    #[arg(long, value_name = "PATH", requires = "found", help = help::OUT,
        long_help = "Write the machine with the errors found to this file")]
    out: Option<PathBuf>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, None)?;
    write::refuse_outputs(&args.out, &session.files).or_else(|refusal| session.refuse(refusal))?;
    for folder in [args.found.as_ref(), args.installed.installed.as_ref()].into_iter().flatten() {
        if folder.is_dir() {
            file_set::check(session, folder)?;
        }
    }
    let options = LocateOptions {
        target: args.target.clone(),
        templates: args.templates.clone(),
        installed: args.installed.installed.clone(),
        max_change_mm: args.installed.max_change,
    };
    let result = session.take(locate(&file, args.found.as_deref(), &options, session.run()))?;
    if let Some(out) = &args.out {
        let text = result.machine_file.as_bytes();
        write::write_whole(out, text, &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    let table = || if args.found.is_none() { table_of_lines(&result) } else { csv(&result) };
    session.show(&result, table, || text(&result))
}

const TITLES: [&str; 8] = ["error", "unit", "found", "U", "in file", "U in file", "difference", "agrees"];

fn cells(error: &LocatedError, number: fn(f64) -> String, none: &str) -> [String; 8] {
    let maybe = |x: Option<f64>| x.map_or_else(|| none.to_owned(), number);
    let agrees = error.agrees.map_or(none, |agrees| if agrees { "yes" } else { "no" });
    [
        error.name.clone(),
        error.unit.to_owned(),
        number(error.found),
        maybe(error.uncertainty),
        number(error.in_file),
        maybe(error.in_file_uncertainty),
        number(error.difference),
        agrees.to_owned(),
    ]
}

fn text(result: &LocateResult) -> String {
    let lines = format!("Rotary axes, all axes at 0, coordinates of `origin`:\n{}\n", lines(result));
    if result.lines.iter().all(|line| line.found.is_none()) {
        return format!("{}\n{lines}", result.machine);
    }
    format!("{}{lines}", errors(result))
}

fn lines(result: &LocateResult) -> comfy_table::Table {
    let mut rows = table(&["axis", "", "x mm", "y mm", "z mm", "i", "j", "k"]);
    for axis in &result.lines {
        for (of, line) in [("found", axis.found), ("in file", Some(axis.in_file))] {
            let Some(line) = line else { continue };
            let fixed = |x: &f64, decimals: i32| {
                let scale = libm::pow(10.0, f64::from(decimals));
                (libm::round(x * scale) / scale + 0.0).to_string()
            };
            let point = line.point_mm.iter().map(|x| fixed(x, 4));
            let direction = line.direction.iter().map(|x| fixed(x, 7));
            let _ = rows.add_row([axis.axis.clone(), of.to_owned()].into_iter().chain(point).chain(direction));
        }
    }
    rows
}

/// The lines of the machine file in the layout of the table that is read.
fn table_of_lines(result: &LocateResult) -> String {
    let row = |axis: &LocatedAxis| {
        let numbers = axis.in_file.point_mm.iter().chain(&axis.in_file.direction).map(f64::to_string);
        let maybe = [axis.uncertainty_um, axis.uncertainty_urad].map(|u| u.map_or_else(String::new, |u| u.to_string()));
        let cells: Vec<String> = [axis.axis.clone()].into_iter().chain(numbers).chain(maybe).collect();
        cells.join(",") + "\n"
    };
    let titles = "axis,x [mm],y [mm],z [mm],i,j,k,u [um],u angle [urad]\n".to_owned();
    titles + &result.lines.iter().map(row).collect::<String>()
}

fn errors(result: &LocateResult) -> String {
    let mut rows = table(&TITLES);
    for error in &result.errors {
        let _ = rows.add_row(cells(error, |x| significant(libm::round(x * 1e6) / 1e6 + 0.0, 4), "-"));
    }
    let source = result.target.as_ref().map_or_else(|| "a table of lines".to_owned(), |name| format!("`{name}`"));
    let mut text = format!("{}: location errors from {source}\n{rows}\n", result.machine);
    if result.errors.iter().any(|error| error.agrees.is_some()) {
        text += "agrees: the difference is within both expanded uncertainties (k = 2), root of the sum of squares\n";
    }
    text
}

fn csv(result: &LocateResult) -> String {
    let row = |error: &LocatedError| cells(error, |x| x.to_string(), "").join(",") + "\n";
    TITLES.join(",") + "\n" + &result.errors.iter().map(row).collect::<String>()
}
