//! A test program of its own harness: checks by name; an omitted one does not count as passed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Name and body of a check.
pub type Check = (&'static str, fn());

/// Runs the checks that the arguments name a part of (none: all). If their equipment is not available they are omitted
/// and named, which is a failure if this variable of the environment is set. `at_once` run together, in their order.
pub fn run(
    checks: &[Check],
    available: impl FnOnce() -> Result<(), String>,
    required: &str,
    at_once: usize,
) -> ExitCode {
    let names: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if std::env::args().any(|a| a == "--list") {
        checks.iter().for_each(|(name, _)| println!("{name}: test"));
        return ExitCode::SUCCESS;
    }
    let wanted = |name: &str| names.is_empty() || names.iter().any(|part| name.contains(part));
    let checks: Vec<&Check> = checks.iter().filter(|(name, _)| wanted(name)).collect();
    if let Err(why) = available() {
        checks.iter().for_each(|(name, _)| println!("test {name} ... LEFT OUT"));
        println!("{} tests left out: {why}; `tests/run` installs what they need", checks.len());
        return if std::env::var_os(required).is_some() { ExitCode::FAILURE } else { ExitCode::SUCCESS };
    }
    let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        while let Some(check) = checks.get(next.fetch_add(1, Ordering::Relaxed)) {
            let _ = failed.fetch_add(usize::from(!passes(check)), Ordering::Relaxed);
        }
    };
    std::thread::scope(|scope| (0..at_once).for_each(|_| drop(scope.spawn(work))));
    let failed = failed.into_inner();
    println!("{} passed, {failed} failed", checks.len() - failed);
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn passes((name, body): &Check) -> bool {
    let passed = catch_unwind(AssertUnwindSafe(body)).is_ok();
    println!("test {name} ... {}", if passed { "ok" } else { "FAILED" });
    passed
}
