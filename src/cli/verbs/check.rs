//! `abbe check`: all diagnostics, and a summary of the machine.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome, load};
use crate::machine::{ErrorTerm, Machine, Travel};
use crate::units::{angle, length};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, None)?;
    match session.format() {
        Format::Json => session.print_json(json(&machine)),
        Format::Csv => session.print(&csv(&machine)),
        Format::Text => session.print(&text(&machine, session.diagnostics.warnings())),
    }
    Ok(())
}

/// How many errors are location errors, component errors, only bounded.
fn counts(machine: &Machine) -> [usize; 3] {
    let mut counts = [0; 3];
    for (_, term) in machine.errors() {
        counts[match term {
            ErrorTerm::Constant(_) => 0,
            ErrorTerm::Component(_) => 1,
            ErrorTerm::Tolerance(_) => 2,
        }] += 1;
    }
    counts
}

fn travel(travel: Travel, unit: &str) -> String {
    match travel {
        Travel::Range(min, max) => format!("{min}..{max} {unit}"),
        Travel::Continuous => "continuous".to_owned(),
    }
}

fn text(machine: &Machine, warnings: usize) -> String {
    let [location, component, tolerance] = counts(machine);
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

fn json(machine: &Machine) -> serde_json::Value {
    let [location, component, tolerance] = counts(machine);
    let axes: Vec<_> = machine
        .axes()
        .iter()
        .map(|axis| {
            let (min, max) = axis.travel.interval();
            json!({
                "name": axis.name.as_str(), "kind": axis.kind, "branch": axis.branch, "direction": axis.direction,
                "origin": axis.origin, "continuous": axis.travel == Travel::Continuous, "travel": [min, max],
                "unit": axis.unit(),
            })
        })
        .collect();
    json!({
        "machine": machine.name(), "chain": machine.chain().to_string(), "axes": axes,
        "tools": machine.tools().iter().map(|tool| tool.name.as_str()).collect::<Vec<_>>(),
        "conventions": machine.conventions(),
        "errors": {"location": location, "component": component, "tolerance": tolerance},
    })
}

/// The errors, one a line, at position 0.
fn csv(machine: &Machine) -> String {
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
