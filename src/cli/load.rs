//! From a path to a valid machine.

use super::Exit;
use super::output::session::Session;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{self, ErrorTerm, Machine};
use crate::syntax::Disk;
use crate::syntax::{self, Files, IdentifyEntry};
use crate::units::counted;
use std::path::Path;

/// Reads, resolves and checks a machine file; `tool` picks one of its tools.
pub(super) fn machine(session: &mut Session, path: &Path, tool: Option<&str>) -> Result<Machine, Exit> {
    machine_through(session, path, tool, &Disk)
}

/// The same through other eyes than the disk's.
pub(super) fn machine_through(
    session: &mut Session,
    path: &Path,
    tool: Option<&str>,
    files: &dyn Files,
) -> Result<Machine, Exit> {
    with_identify(session, path, tool, files).map(|(machine, _)| machine)
}

/// The same, with the section `identify` of the file.
pub(super) fn with_identify(
    session: &mut Session,
    path: &Path,
    tool: Option<&str>,
    files: &dyn Files,
) -> Result<(Machine, Option<IdentifyEntry>), Exit> {
    let document = syntax::load(path, files, &mut session.diagnostics);
    let machine = document.as_ref().and_then(|d| machine::resolve(d, files, &mut session.diagnostics));
    session.checked()?;
    let Some(machine) = machine else { return Err(Exit::Refused) };
    let section = document.and_then(|document| document.identify);
    let Some(name) = tool else { return Ok((machine, section)) };
    match machine.with_tool(name) {
        Some(machine) => Ok((machine, section)),
        None => session.refuse(unknown_tool(&machine, name)),
    }
}

/// A machine that is asked for deviations although all its errors are only bounded.
pub(super) fn warn_bounded(session: &mut Session, machine: &Machine) {
    let count = machine.errors().count();
    if count > 0 && machine.errors().all(|(_, term)| matches!(term, ErrorTerm::Tolerance(_))) {
        let message = format!("all {} are only bounded, and count as 0", counted(count, "error"));
        let help = "`abbe budget` says what the bounds come to; give values for what was measured";
        session.diagnostics.push(Diagnostic::new(codes::W0802, message).help(help));
    }
}

fn unknown_tool(machine: &Machine, name: &str) -> Diagnostic {
    let known: Vec<_> = machine.tools().iter().map(|tool| tool.name.as_str()).filter(|name| !name.is_empty()).collect();
    let help = if known.is_empty() {
        "this machine has one tool without a name: leave `--tool` out".to_owned()
    } else {
        format!("its tools are {}", known.join(", "))
    };
    Diagnostic::new(codes::E0801, format!("the machine has no tool `{name}`")).help(help)
}
