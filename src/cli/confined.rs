//! Runs with templates of the user's are done by a child of the program with limited memory. While templates run, their
//! processor time is limited too: the fuel of a template bounds its steps, not the cost of a step.

use super::output::session::Session;
#[cfg(unix)]
use abbe::{Diagnostic, codes};
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

/// GiB of memory for such a run: many times the need of the largest set.
#[cfg(unix)]
const GIBIBYTES: u64 = 1;

/// Processor time for the templates of a set: many times the need of the largest set.
pub(super) const TEMPLATE_SECONDS: u64 = 10;

/// Stack of the child, for the recursion that the template engine allows.
const STACK: usize = 16 << 20;

/// True if the command line names a folder with templates.
pub(super) fn is_wanted(arguments: &[OsString]) -> bool {
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
    let Ok(status) = std::process::Command::new(program).arg("--template-child").args(own).status() else {
        limit();
        return None;
    };
    // A failed allocation aborts; processor time that is used up is a signal of its own.
    const ABORTED: i32 = 6;
    let late = rustix::process::Signal::XCPU.as_raw();
    match (status.code(), status.signal()) {
        (Some(code), _) => Some(ExitCode::from(u8::try_from(code).unwrap_or(3))),
        (None, Some(ABORTED)) => {
            let refused = session.refuse::<()>(
                Diagnostic::new(
                    codes::E0740,
                    format!(
                        "the templates asked for more than {GIBIBYTES} GiB of memory, or for more than {} MiB of stack \
                         (values nested in each other, recursion): the run was stopped",
                        STACK >> 20
                    ),
                )
                .help(
                    "keep no text in variables that grow and nest no lists, write it as it comes; nothing was written",
                ),
            );
            Some(session.finish(refused))
        }
        (None, Some(signal)) if signal == late => {
            let message = format!("the templates ran for more than {TEMPLATE_SECONDS} s of processor time");
            let help = "docs/adding-a-target.md states the limits of templates; nothing was written";
            let refused = session.refuse::<()>(Diagnostic::new(codes::E0702, message).help(help));
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
    // A signal that stops the parent is meant for the run.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::TERM));
}

#[cfg(not(unix))]
pub(super) fn limit() {}

/// Limits the processor time that the child may still use, in seconds; `None` lifts the limit.
#[cfg(unix)]
pub(super) fn limit_time(seconds: Option<u64>) {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    use rustix::time::{ClockId, clock_gettime};
    let spent = u64::try_from(clock_gettime(ClockId::ProcessCPUTime).tv_sec).unwrap_or(0);
    let current = seconds.map(|seconds| spent + seconds);
    let _ = setrlimit(Resource::Cpu, Rlimit { current, maximum: getrlimit(Resource::Cpu).maximum });
}

#[cfg(not(unix))]
pub(super) fn limit_time(_: Option<u64>) {}

/// Runs the job of the child, on the stack at hand if no thread can be had. Returns exit code 3 if it breaks off.
pub(super) fn on_large_stack<J: FnOnce() -> ExitCode + Send + 'static>(job: J) -> ExitCode {
    // What the thread takes is not lost with a thread that does not start.
    let job = Arc::new(Mutex::new(Some(job)));
    let take = |job: &Mutex<Option<J>>| job.lock().unwrap_or_else(PoisonError::into_inner).take();
    let shared = Arc::clone(&job);
    let run = move || take(&shared).map_or(ExitCode::from(3), |job| job());
    match std::thread::Builder::new().stack_size(STACK).spawn(run) {
        Ok(thread) => thread.join().unwrap_or(ExitCode::from(3)),
        Err(_) => take(&job).map_or(ExitCode::from(3), |job| job()),
    }
}
