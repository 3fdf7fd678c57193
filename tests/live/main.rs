//! Tests against a real LinuxCNC (tests/linuxcnc/): the files of `compile` are loaded and run.
//!
//! Without the controller every check is omitted and named; with `ABBE_REQUIRE_LIVE=1` (as in `tests/run`) a missing
//! controller is a failure. An omitted check does not count as passed.

// A test that panics is a test that fails: nothing to be careful about.
#![allow(clippy::disallowed_methods, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "../it/support/checks.rs"]
mod checks;
mod composed;
#[path = "../it/support/config.rs"]
mod config;
mod kinematics;
mod kins;
mod kins_topologies;
mod limited;
#[path = "../it/loaded.rs"]
mod loaded;
#[path = "../it/oracle/mod.rs"]
#[allow(dead_code, reason = "shared with the tests that need no controller")]
mod oracle;
mod switching;
mod tables;

use std::path::PathBuf;
use std::process::{Command, ExitCode, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The longest first.
const CHECKS: [checks::Check; 21] = [
    ("parameters and tables together, xyzac-trt and xyzbc-trt", composed::tilting_tables),
    ("parameters and tables together, 5axiskins", composed::head),
    ("parameters and tables together, maxkins", composed::head_over_table),
    ("the harness notices spoiled tables", tables::harness),
    ("three-axis tables in the running controller", tables::three_axis),
    ("five-axis tables in the running controller", tables::five_axis),
    ("a restore set of tables, loaded in place of the set", tables::restored),
    ("malformed tables: what the controller swallows never comes out of compile", tables::malformed),
    ("ideal kinematics of xyzac-trt, xyzbc-trt and 5axiskins", kinematics::nominal),
    ("centres in xyzac-trt and xyzbc-trt", kinematics::centres),
    ("pivot length in 5axiskins", kinematics::pivot),
    ("error model in the kinematics, three axes", kins::three_axis),
    ("error model in the kinematics, tilting table", kins::table_table),
    ("error model in the kinematics, head and table", kins::head_table),
    ("error model in the kinematics, lathe without Y", kins_topologies::lathe),
    ("error model in the kinematics, robot", kins_topologies::robot),
    ("A through 0 at 40 deg/s with limited drives", limited::pole),
    ("another tool length at a tilt, with limited drives", limited::tool),
    ("M428 and M429 with the error model", switching::switching),
    ("the simulation of the kinematics, with the stock launcher", kins::launcher),
    ("the harness notices a spoiled module", kins::spoiled),
];

fn main() -> ExitCode {
    // Each has a controller in a sandbox of its own, and waits for it nearly all its time.
    checks::run(&CHECKS, controller, "ABBE_REQUIRE_LIVE", 3)
}

/// Checks that there is a controller that we may start.
fn controller() -> Result<(), String> {
    let modules = Command::new("/usr/bin/python3").args(["-c", "import linuxcnc, hal"]).output();
    if !modules.is_ok_and(|output| output.status.success()) {
        return Err("LinuxCNC is not installed".to_owned());
    }
    let user = Command::new("id").arg("-u").output().map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    if user.is_ok_and(|id| id == "0") { Ok(()) } else { Err("its sandbox needs root".to_owned()) }
}

/// A folder of its own, removed at the end; readable by the controller's user.
pub struct Folder(pub PathBuf);

impl Folder {
    /// Makes it, empty.
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("abbe-live-{name}-{}-{count}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs the program; its standard output.
pub fn abbe(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_abbe")).args(arguments).output().unwrap();
    assert!(output.status.success(), "abbe {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a script of tests/linuxcnc.
pub fn script(name: &str, arguments: &[&str]) -> Output {
    Command::new("/usr/bin/python3").arg(format!("tests/linuxcnc/{name}")).args(arguments).output().unwrap()
}

/// Returns its JSON, if it reports that everything holds.
pub fn script_json(name: &str, arguments: &[&str]) -> serde_json::Value {
    let output = script(name, arguments);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{name} {arguments:?}: {text}\n{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&text).unwrap()
}
