//! From a path to a valid machine.

use super::Stop;
use super::files::Disk;
use super::session::Session;
use crate::diagnostic::Diagnostic;
use crate::machine::{self, Machine};
use crate::syntax;
use std::path::Path;

/// Reads, resolves and checks a machine file; `tool` picks one of its tools.
pub(super) fn machine(session: &mut Session, path: &Path, tool: Option<&str>) -> Result<Machine, Stop> {
    let document = syntax::load(path, &Disk, &mut session.diagnostics);
    let machine = document.and_then(|document| machine::resolve(&document, &Disk, &mut session.diagnostics));
    session.checked()?;
    let Some(machine) = machine else { return Err(Stop::Refused) };
    let Some(name) = tool else { return Ok(machine) };
    match machine.with_tool(name) {
        Some(machine) => Ok(machine),
        None => session.refuse(unknown_tool(&machine, name)),
    }
}

fn unknown_tool(machine: &Machine, name: &str) -> Diagnostic {
    let known: Vec<_> = machine.tools().iter().map(|tool| tool.name.as_str()).filter(|name| !name.is_empty()).collect();
    let help = if known.is_empty() {
        "this machine has one tool without a name: leave `--tool` out".to_owned()
    } else {
        format!("its tools are {}", known.join(", "))
    };
    Diagnostic::new("E0801", format!("the machine has no tool `{name}`")).help(help)
}
