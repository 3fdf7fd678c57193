//! Runs with templates of one's own are done by a child of the program that may take only so much memory: the fuel
//! of a template bounds its steps, not the size of its values, and memory that runs out ends a process without a word.

use super::output::session::Session;
use crate::diagnostic::{Diagnostic, codes};
use std::ffi::OsString;
use std::process::ExitCode;

/// GiB that such a run may take: many times what the largest set needs.
const GIBIBYTES: u64 = 1;

/// Does the command line name a folder with templates?
pub(super) fn wanted(arguments: &[OsString]) -> bool {
    let named = |argument: &OsString| {
        let text = argument.to_string_lossy();
        text == "--templates" || text.starts_with("--templates=")
    };
    cfg!(unix) && arguments.iter().any(named)
}

/// Lets a child do the run. None if there can be no child: then this process is limited instead.
#[cfg(unix)]
pub(super) fn run(arguments: &[OsString], mut session: Session) -> Option<ExitCode> {
    use std::os::unix::process::ExitStatusExt;
    let program = std::env::current_exe().ok()?;
    let own = arguments.get(1..).unwrap_or_default();
    let Ok(status) = std::process::Command::new(program).arg("--confined").args(own).status() else {
        limit();
        return None;
    };
    // What cannot have memory aborts.
    const ABORTED: i32 = 6;
    match (status.code(), status.signal()) {
        (Some(code), _) => Some(ExitCode::from(u8::try_from(code).unwrap_or(3))),
        (None, Some(ABORTED)) => {
            let refused = session.refuse::<()>(
                Diagnostic::new(
                    codes::E0740,
                    format!("the templates asked for more than {GIBIBYTES} GiB of memory: the run was stopped"),
                )
                .help("keep no text in variables that grow, write it as it comes; nothing was written"),
            );
            Some(session.finish(refused))
        }
        _ => Some(ExitCode::from(3)),
    }
}

#[cfg(not(unix))]
pub(super) fn run(_: &[OsString], _: Session) -> Option<ExitCode> {
    None
}

/// Sets the limits of a child. A system that knows none goes without.
#[cfg(unix)]
pub(super) fn limit() {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let at_most = |bytes| Rlimit { current: Some(bytes), maximum: Some(bytes) };
    let _ = setrlimit(Resource::Data, at_most(GIBIBYTES << 30));
    // An abort that is expected leaves no core behind.
    let _ = setrlimit(Resource::Core, at_most(0));
    // Who stops the parent means the run.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::TERM));
}

#[cfg(not(unix))]
pub(super) fn limit() {}
