//! `abbe check`: all diagnostics, and a summary of the machine.

use crate::api::{ErrorCounts, MachineFile, summary};
use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use crate::machine::{ErrorTerm, Travel};
use crate::units::{angle, length};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = session.load(&args.machine, None)?;
    match session.format() {
        Format::Json => session.print_json(json!(summary(&machine))),
        Format::Csv => session.print(&csv(&machine)),
        Format::Text => session.print(&text(&machine, session.diagnostics.warnings())),
    }
    Ok(())
}

fn travel(travel: Travel, unit: &str) -> String {
    match travel {
        Travel::Range(min, max) => format!("{min}..{max} {unit}"),
        Travel::Continuous => "continuous".to_owned(),
    }
}

fn text(machine: &MachineFile, warnings: usize) -> String {
    let ErrorCounts { location, component, tolerance } = summary(machine).errors;
    let axes: Vec<String> =
        machine.axes().iter().map(|axis| format!("{} {}", axis.name, travel(axis.travel, axis.unit()))).collect();
    let mut text = format!("{}\n  chain   {}\n  axes    {}\n", machine.name(), machine.chain(), axes.join(", "));
    text.push_str(&format!("  errors  {location} location, {component} component, {tolerance} only bounded\n"));
    let tools: Vec<&str> = machine.tools().iter().map(|t| t.name.as_str()).filter(|name| !name.is_empty()).collect();
    if !tools.is_empty() {
        text.push_str(&format!("  tools   {}\n", tools.join(", ")));
    }
    for (key, value) in &machine.provenance().entries {
        text.push_str(&format!("  {key:7} {value}\n"));
    }
    text.push_str(&match warnings {
        0 => "  no mistakes found\n".to_owned(),
        1 => "  no mistakes, 1 warning\n".to_owned(),
        n => format!("  no mistakes, {n} warnings\n"),
    });
    text
}

/// The errors, one a line, at position 0.
fn csv(machine: &MachineFile) -> String {
    let row = |(id, term): (crate::machine::ErrorId, &ErrorTerm)| {
        let print = |value: f64| if id.direction.is_rotation() { angle(value) } else { length(value) };
        let (kind, value) = match term {
            ErrorTerm::Constant(value) => ("location", print(*value)),
            ErrorTerm::Component(_) => ("component", String::new()),
            ErrorTerm::Tolerance(value) => ("tolerance", print(*value)),
        };
        format!("{id},{kind},{value}")
    };
    std::iter::once("error,kind,value".to_owned()).chain(machine.errors().map(row)).collect::<Vec<_>>().join("\n")
}
