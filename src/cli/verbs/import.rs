//! `abbe import`: a single-axis measurement as an instrument exports it, to a table of error curves.

use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::store::write;
use crate::cli::{Format, Outcome};
use abbe::results::Sources;
use abbe::results::{ImportResult, ImportedError};
use abbe::text::{counted, significant};
use abbe::{ImportOptions, import};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The export: text, UTF-8 or UTF-16, comma, semicolon or tab.
    file: PathBuf,
    /// The axis that moved, if the file does not say it.
    #[arg(long, value_name = "AXIS")]
    axis: Option<String>,
    /// The error whose runs the columns are, such as `EXX`; of several errors the only one to take.
    #[arg(long, value_name = "NAME")]
    error: Option<String>,
    /// Unit of readings that have none in the file.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// The file holds corrections, not errors: change the sign.
    #[arg(long)]
    correction: bool,
    /// The axis turns without end: positions modulo 360 deg, first row again at the end.
    #[arg(long)]
    continuous: bool,
    /// Write the table to this file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let options = ImportOptions {
        axis: args.axis.clone(),
        error: args.error.clone(),
        unit: args.unit.clone(),
        correction: args.correction,
        continuous: args.continuous,
        needs_table: args.out.is_some() || session.format() == Format::Csv,
    };
    let mut inputs = Sources::default();
    let _ = inputs.add(args.file.display().to_string(), "");
    write::refuse_outputs(&args.out, &inputs).or_else(|refusal| session.refuse(refusal))?;
    let answer = import(&args.file, &options, session.run());
    let result = session.take(answer)?;
    if let Some(out) = &args.out {
        write::write_whole(out, result.table.as_bytes()).or_else(|refusal| session.refuse(refusal))?;
    }
    match session.format() {
        Format::Json => session.print_json(json!(result)),
        Format::Csv => session.print(&result.table),
        Format::Text => session.print(&text(&result)),
    }
    Ok(())
}

fn text(result: &ImportResult) -> String {
    let mut text = format!("axis {}: {}, {}", result.axis, result.form, counted(result.readings, "reading"));
    text += if result.directions_inferred { "; directions from the order of the rows\n" } else { "\n" };
    for (key, value) in &result.metadata {
        text += &format!("{key}: {value}\n");
    }
    let mut rows = table(&["error", "unit", "targets", "runs", "E", "M", "B", "mean B", "R", "A", "slope"]);
    for error in &result.errors {
        let _ = rows.add_row(cells(error));
    }
    text += &format!("{rows}\n");
    text + "E systematic deviation, M mean deviation, B reversal, R repeatability, A accuracy: formed after ISO \
     230-2:2014\n"
}

fn cells(f: &ImportedError) -> Vec<String> {
    let n = |x: f64| significant(x, 4);
    let maybe = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), n);
    vec![
        f.error.clone(),
        f.unit.to_owned(),
        f.targets.to_string(),
        f.runs.to_string(),
        n(f.systematic),
        n(f.mean),
        maybe(f.reversal),
        maybe(f.mean_reversal),
        maybe(f.repeatability),
        maybe(f.accuracy),
        format!("{} {}", significant(f.slope, 3), f.slope_unit),
    ]
}
