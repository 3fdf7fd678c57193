//! Hands the version to the program, with the commit it is built from: `0.2.0 (1a2b3c4d5e6f)`.
//!
//! The commit is that of the checkout, or the one that `cargo package` recorded; without either there is none.
//! Only release builds carry it: in the others every commit would compile the library anew.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What a release build is made of; a change in it is a change of the program.
const BUILT_FROM: [&str; 5] = ["Cargo.toml", "Cargo.lock", "build.rs", "src", "templates"];

/// The record of `cargo package` in a crate.
const RECORD: &str = ".cargo_vcs_info.json";

/// Digits of a commit, enough for any repository.
const DIGITS: usize = 12;

#[allow(dead_code, reason = "the tests include this file for its other functions")]
fn main() {
    let version = variable("CARGO_PKG_VERSION");
    let folder = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-changed=build.rs");
    let mut commit = None;
    if variable("PROFILE") == "release" {
        watched(&folder).iter().for_each(|path| println!("cargo::rerun-if-changed={}", path.display()));
        commit = checked_out(&folder).or_else(|| recorded(&folder));
    }
    let version = commit.map_or(version.clone(), |commit| format!("{version} ({commit})"));
    println!("cargo::rustc-env=ABBE_VERSION={version}");
}

fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// The commit of a checkout of this repository, with `modified` where the sources differ from it.
pub fn checked_out(folder: &Path) -> Option<String> {
    // A copy inside another repository, say with vendored sources, is not a checkout.
    let top = PathBuf::from(git(folder, &["rev-parse", "--show-toplevel"])?);
    if top.canonicalize().ok()? != folder.canonicalize().ok()? {
        return None;
    }
    let commit = git(folder, &["rev-parse", "HEAD"])?;
    let status = ["status", "--porcelain", "--untracked-files=no", "--"];
    let changes = git(folder, &[&status[..], &BUILT_FROM[..]].concat())?;
    Some(shown(&commit, !changes.is_empty()))
}

/// The commit that `cargo package` recorded.
pub fn recorded(folder: &Path) -> Option<String> {
    let record = std::fs::read_to_string(folder.join(RECORD)).ok()?;
    let commit = record.split("\"sha1\":").nth(1)?.split('"').nth(1)?;
    let hexadecimal = commit.len() >= DIGITS && commit.chars().all(|c| c.is_ascii_hexdigit());
    hexadecimal.then(|| shown(commit, record.contains("\"dirty\": true")))
}

fn shown(commit: &str, modified: bool) -> String {
    let commit: String = commit.chars().take(DIGITS).collect();
    if modified { format!("{commit}, modified") } else { commit }
}

/// The files whose change may change the commit. Cargo builds anew each time if one of them is missing.
fn watched(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = BUILT_FROM.iter().chain(&[RECORD]).map(|name| folder.join(name)).collect();
    // Every commit and checkout goes through the log of HEAD; without a log, through HEAD or its branch.
    let branch = git(folder, &["symbolic-ref", "--quiet", "HEAD"]);
    for name in ["HEAD", "logs/HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        paths.extend(git(folder, &["rev-parse", "--git-path", name]).map(|path| folder.join(path)));
    }
    paths.retain(|path| path.exists());
    paths
}

fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    let _ = command.args(["--no-optional-locks", "-C"]).arg(folder).args(arguments);
    let output = command.output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim_end().to_owned())
}
