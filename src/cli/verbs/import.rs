//! `abbe import`: a single-axis measurement as an instrument exports it, to a table of error curves.

use crate::cli::output::session::Session;
use crate::cli::store::write;
use crate::cli::{Format, Outcome};
use crate::diagnostic::{Diagnostic, codes};
use crate::identify::import::{AccuracyFigures, Import, ImportRequest, import};
use crate::machine::ErrorId;
use crate::syntax::Disk;
use crate::units::{counted, significant};
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
    /// Where to write the table.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Left-out rows that are listed.
const LISTED: usize = 12;

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let wanted = ImportRequest {
        axis: args.axis.clone(),
        error: args.error.clone(),
        unit: args.unit.clone(),
        correction: args.correction,
        continuous: args.continuous,
    };
    let found = import(&args.file, &wanted, &Disk, &mut session.diagnostics);
    session.checked()?;
    let Some(found) = found else { return Err(crate::cli::Exit::Refused) };
    write::refuse_outputs(&args.out, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    let table = found.table(args.continuous);
    remarks(session, &found, &table.missing);
    session.checked()?;
    if table.rows == 0 && (args.out.is_some() || session.format() == Format::Csv) {
        let message = "the table has no row: at no position were all errors measured, from all sides";
        let help =
            "measure the same targets in both directions; without --out the figures of what there is are printed";
        return session.refuse(Diagnostic::new(codes::E0509, message).help(help));
    }
    if let Some(out) = &args.out
        && let Err(refusal) = write::write_whole(out, table.text.as_bytes())
    {
        return session.refuse(refusal);
    }
    match session.format() {
        Format::Json => session.print_json(json(session, &found)),
        Format::Csv => session.print(&table.text),
        Format::Text => session.print(&text(&found)),
    }
    session.checked()
}

fn remarks(session: &mut Session, found: &Import, missing: &[String]) {
    if !found.left_out.is_empty() {
        let (count, all) = (found.left_out.len(), found.left_out.len() + found.samples.len());
        let message = format!("{count} of {all} rows or readings were left out");
        let mut warning = Diagnostic::new(codes::W0504, message).help("correct the file, or accept what is left");
        for row in found.left_out.iter().take(LISTED) {
            warning = warning.at(Some(row.place.clone()), row.reason.clone());
        }
        session.diagnostics.push(warning);
    }
    if !missing.is_empty() {
        let list = missing.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
        let message = format!("the table has no row at {list}: an error or a direction was not measured there");
        session
            .diagnostics
            .push(Diagnostic::new(codes::W0504, message).help("measure the same targets in both directions"));
    }
}

/// Factor and unit of an error's figures, and of its slope.
fn unit(error: &ErrorId) -> (f64, &'static str) {
    if error.direction.is_rotation() { (1e6, "urad") } else { (1e3, "um") }
}

fn per(rotary: bool) -> (f64, &'static str) {
    if rotary { (1.0, "deg") } else { (1e3, "m") }
}

fn json(session: &Session, found: &Import) -> serde_json::Value {
    let sources = &session.diagnostics.sources;
    let left =
        found.left_out.iter().map(|row| json!({"line": sources.line_column(&row.place).0, "reason": row.reason}));
    let one = |(k, error): (usize, &ErrorId)| {
        let f = found.figures(k)?;
        let factor = unit(error).0;
        let value = |x: Option<f64>| x.map(|x| x * factor + 0.0);
        Some(json!({
            "error": error.to_string(), "unit": unit(error).1, "targets": f.targets.len(), "runs": f.runs,
            "bidirectional": f.bidirectional(), "E": f.systematic * factor, "M": f.mean * factor,
            "B": value(f.reversal), "mean_B": value(f.mean_reversal), "R": value(f.repeatability), "A": value(f.accuracy),
            "slope": f.slope * factor * per(found.rotary).0, "slope_unit": format!("{}/{}", unit(error).1, per(found.rotary).1),
        }))
    };
    json!({
        "axis": found.axis, "form": found.form.word(), "directions_inferred": found.inferred,
        "errors": found.errors.iter().enumerate().filter_map(one).collect::<Vec<_>>(),
        "readings": found.samples.len(), "left_out": left.collect::<Vec<_>>(),
        "metadata": found.metadata.iter().map(|(k, v)| json!([k, v])).collect::<Vec<_>>(),
    })
}

fn text(found: &Import) -> String {
    let readings = counted(found.samples.len(), "reading");
    let mut text = format!("axis {}: {}, {readings}", found.axis, found.form.word());
    text += if found.inferred { "; directions from the order of the rows\n" } else { "\n" };
    for (key, value) in &found.metadata {
        text += &format!("{key}: {value}\n");
    }
    let mut table = comfy_table::Table::new();
    let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
    let _ = table.set_header(["error", "unit", "targets", "runs", "E", "M", "B", "mean B", "R", "A", "slope"]);
    for (k, error) in found.errors.iter().enumerate() {
        if let Some(figures) = found.figures(k) {
            let _ = table.add_row(cells(found.rotary, error, &figures));
        }
    }
    text += &format!("{table}\n");
    text + "E systematic deviation, M mean deviation, B reversal, R repeatability, A accuracy: formed after ISO 230-2:2014\n"
}

fn cells(rotary: bool, error: &ErrorId, f: &AccuracyFigures) -> Vec<String> {
    let (factor, unit) = unit(error);
    let n = |x: f64| significant(x * factor, 4);
    let maybe = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), n);
    let (per, of) = per(rotary);
    vec![
        error.to_string(),
        unit.to_owned(),
        f.targets.len().to_string(),
        f.runs.to_string(),
        n(f.systematic),
        n(f.mean),
        maybe(f.reversal),
        maybe(f.mean_reversal),
        maybe(f.repeatability),
        maybe(f.accuracy),
        format!("{} {unit}/{of}", significant(f.slope * factor * per, 3)),
    ]
}
