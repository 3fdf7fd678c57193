//! `abbe check`: all diagnostics, and a summary of the machine.

use crate::cli::output::bands;
use crate::cli::output::budget_text::coverage_line;
use crate::cli::output::session::Session;
use crate::cli::output::view::folded;
use crate::cli::{Exit, Format, Outcome};
use abbe::results::{AxisSummary, CheckedFile, ErrorCounts};
use abbe::results::{ErrorId, ErrorTerm, Travel};
use abbe::text::annotations;
use abbe::text::{angle, cell, counts, length, shown, significant};
use abbe::{MachineFile, check, summary};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine files.
    #[arg(required = true, value_name = "MACHINE")]
    machines: Vec<PathBuf>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let checked = check(&args.machines, session.run());
    let refused = checked.iter().any(CheckedFile::refused);
    for CheckedFile { file, diagnostics, .. } in &checked {
        let count = session.diagnostics.count();
        session.diagnostics.absorb(diagnostics.clone());
        if checked.len() > 1 {
            session.diagnostics.name_file(count, file);
        }
    }
    if session.is_sarif() {
        session.print_document(annotations(&checked));
    } else {
        print(session, &checked);
    }
    if refused { Err(Exit::Refused) } else { Ok(()) }
}

/// One file is printed as it is, several with their names; one that is refused has diagnostics only.
fn print(session: &Session, checked: &[CheckedFile]) {
    match (session.format(), checked) {
        (Format::Json, [CheckedFile { machine: Some(machine), .. }]) => session.print_json(json!(summary(machine))),
        (_, [CheckedFile { machine: None, .. }]) => {}
        (Format::Json, several) => session.print_document(json!(several)),
        (Format::Csv, [CheckedFile { machine: Some(machine), .. }]) => session.print(&csv(machine)),
        (Format::Csv, several) => session.print(&csv_of_several(several)),
        (Format::Text, files) => session.print(&folded(&files.iter().map(text).collect::<Vec<_>>().join("\n"))),
    }
}

fn travel(travel: Travel, unit: &str) -> String {
    match travel {
        Travel::Range(min, max) => format!("{min}..{max} {unit}"),
        Travel::Continuous => "continuous".to_owned(),
    }
}

fn text(CheckedFile { file, machine, diagnostics }: &CheckedFile) -> String {
    let Some(machine) = machine else { return format!("{file}\n  refused: {}\n", counts(diagnostics)) };
    let short = summary(machine);
    let ErrorCounts { location, component, tolerance } = short.errors;
    let axes: Vec<String> =
        machine.axes().iter().map(|axis| format!("{} {}", axis.name, travel(axis.travel, axis.unit()))).collect();
    let mut text = format!("{}\n  chain   {}\n  axes    {}\n", machine.name(), machine.chain(), axes.join(", "));
    let measured: BTreeMap<String, [f64; 2]> =
        short.axes.iter().filter_map(|axis| Some((axis.name.clone(), axis.measured?))).collect();
    if !measured.is_empty() {
        text.push_str(&format!("  measured {}; beyond, curves go on unmeasured\n", bands::ranges(&measured)));
    }
    let class = machine.class().map_or_else(String::new, |class| format!("; class {}", shown(&class.name)));
    text.push_str(&format!(
        "  errors  {location} location, {component} component, {tolerance} bounds in the file{class}\n"
    ));
    text.push_str(&coverage_line(&short.coverage).map_or_else(String::new, |line| format!("  known   {line}\n")));
    let arms = short.axes.iter().filter(|axis| axis.arm_mm.share.is_some_and(|share| share > 0.0));
    let arm = |axis: &AxisSummary| {
        let share = axis.arm_mm.share.unwrap_or(0.0) * 100.0;
        format!("{} {} mm ({} %)", axis.name, significant(axis.arm_mm.longest, 4), significant(share, 2))
    };
    let arms: Vec<String> = arms.map(arm).collect();
    if !arms.is_empty() {
        text.push_str(&format!("  arms    {}\n", arms.join(", ")));
    }
    let tools: Vec<&str> = machine.tools().iter().map(|t| t.name.as_str()).filter(|name| !name.is_empty()).collect();
    if !tools.is_empty() {
        text.push_str(&format!("  tools   {}\n", tools.join(", ")));
    }
    for (key, value) in &machine.provenance().entries {
        text.push_str(&format!("  {key:7} {value}\n"));
    }
    text.push_str(&match diagnostics.warnings() {
        0 => "  no mistakes found\n".to_owned(),
        1 => "  no mistakes, 1 warning\n".to_owned(),
        n => format!("  no mistakes, {n} warnings\n"),
    });
    text
}

/// The errors, one a line, at position 0.
fn csv(machine: &MachineFile) -> String {
    std::iter::once("error,kind,value".to_owned()).chain(rows(machine)).collect::<Vec<_>>().join("\n")
}

/// The same of several files, with the name of the file in front; refused ones have no rows.
fn csv_of_several(checked: &[CheckedFile]) -> String {
    let of = |CheckedFile { file, machine, .. }: &CheckedFile| {
        let name = cell(file);
        machine.iter().flat_map(rows).map(|row| format!("{name},{row}")).collect::<Vec<_>>()
    };
    std::iter::once("file,error,kind,value".to_owned())
        .chain(checked.iter().flat_map(of))
        .collect::<Vec<_>>()
        .join("\n")
}

fn rows(machine: &MachineFile) -> Vec<String> {
    let size = |value: f64, turns: bool| if turns { angle(value) } else { length(value) };
    let row = |(id, term): (ErrorId, &ErrorTerm)| {
        let print = |value: f64| size(value, id.direction.is_rotation());
        let (kind, value) = match term {
            ErrorTerm::Constant(value) => ("location", print(*value)),
            ErrorTerm::Component(_) => ("component", String::new()),
            ErrorTerm::Tolerance(value) => ("tolerance", print(*value)),
        };
        format!("{id},{kind},{value}")
    };
    let framed = machine.tolerances().list().into_iter();
    let framed = framed.map(|(name, value, turns)| format!("{name},tolerance,{}", size(value, turns)));
    machine.errors().map(row).chain(framed).collect()
}
