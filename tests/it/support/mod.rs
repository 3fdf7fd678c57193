//! Common parts of the tests of compensation: running the program, comparing whole folders, and readers of its files.
//! Nothing here uses the library.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

pub mod cec;
pub mod comp;
pub mod config;
pub mod controllers;
pub mod lattice;
pub mod left;
pub mod packed;
pub mod sha256;
pub mod stacking;

/// The program, to be given arguments.
pub fn abbe() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    // Text as wide as it is, so that sentences are found in it.
    command.arg("--wide");
    command
}

/// A file of `configs/`.
pub fn config(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name)
}

/// A finished run.
pub struct Run {
    /// The exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Run {
    /// Runs a command.
    pub fn of(command: &mut Command) -> Self {
        let Output { status, stdout, stderr } = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: status.code(), out: text(stdout), err: text(stderr) }
    }

    /// The JSON of a run that must have gone well.
    pub fn json(&self) -> Value {
        assert_eq!(self.code, Some(0), "{}", self.err);
        serde_json::from_str(&self.out).unwrap()
    }

    /// Asserts a refusal: exit code 1, the diagnostic, its help, on standard output nothing but its JSON.
    pub fn refused(&self, code: &str) -> &Self {
        assert_eq!(self.code, Some(1), "{code} expected: {}{}", self.out, self.err);
        assert!(self.err.contains(&format!("refused[{code}]")), "{code} expected: {}", self.err);
        assert!(self.err.contains("help: "), "no help: {}", self.err);
        // With `--format json` the diagnostics are on standard output, and nothing else is.
        if !self.out.is_empty() {
            let refusal: Value = serde_json::from_str(&self.out).unwrap();
            let list = refusal["diagnostics"].as_array().unwrap();
            assert!(refusal["refused"] == true && list.iter().any(|d| d["code"] == code), "{}", self.out);
        }
        self
    }

    /// Asserts that standard error holds these words.
    pub fn says(&self, words: &str) -> &Self {
        assert!(self.err.contains(words), "`{words}` is not in: {}", self.err);
        self
    }
}

/// `compile` for a target, with more options.
pub fn compile(machine: &Path, target: &str, out: &Path, more: &[&str]) -> Run {
    Run::of(
        abbe().arg("compile").arg(machine).args(["--target", target, "--format", "json", "--out"]).arg(out).args(more),
    )
}

/// `verify`, with more options.
pub fn verify(machine: &Path, out: &Path, more: &[&str]) -> Run {
    Run::of(abbe().arg("verify").arg(machine).arg(out).args(["--format", "json"]).args(more))
}

/// A number of a JSON value, by path.
pub fn number(json: &Value, path: &str) -> f64 {
    json.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {path} in {json}"))
}

/// Content of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entry {
    /// A folder.
    Folder,
    /// A link and its target.
    Link(PathBuf),
    /// A file and its bytes.
    File(Vec<u8>),
    /// A FIFO, a device.
    Other,
}

/// Everything below a folder, links not followed.
pub fn tree(folder: &Path) -> BTreeMap<PathBuf, Entry> {
    let mut all = BTreeMap::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let kind = std::fs::symlink_metadata(&path).unwrap().file_type();
        let entry = if kind.is_dir() {
            all.extend(tree(&path));
            Entry::Folder
        } else if kind.is_symlink() {
            Entry::Link(std::fs::read_link(&path).unwrap())
        } else if kind.is_file() {
            Entry::File(std::fs::read(&path).unwrap())
        } else {
            Entry::Other
        };
        all.insert(path, entry);
    }
    all
}

/// Names of the files of a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut all: Vec<_> = std::fs::read_dir(folder).unwrap().map(name).collect();
    all.sort();
    all
}

/// Names of the files of a set, sorted, without the set that takes it back.
pub fn set_files(out: &Path) -> Vec<String> {
    names(out).into_iter().filter(|name| out.join(name).is_file()).collect()
}

/// The ceil(0.95 n)-th smallest.
pub fn p95(values: &[f64]) -> f64 {
    sorted(values)[(values.len() * 95).div_ceil(100) - 1]
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// Between which values the 95 % quantile of another sample of the same population lies, four standard
/// deviations of both ranks allowed: no shape of the distribution is supposed.
pub fn p95_bracket(own: &[f64], theirs: usize) -> (f64, f64) {
    let sorted = sorted(own);
    let (n, m) = (own.len() as f64, theirs as f64);
    let spread = 4.0 * (0.95 * 0.05 * (1.0 / n + 1.0 / m)).sqrt();
    let at = |share: f64| sorted[((share * n).ceil() as usize).clamp(1, own.len()) - 1];
    (at(0.95 - spread), at(0.95 + spread))
}

#[test]
fn quantiles_by_hand() {
    let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
    assert_eq!(p95(&hundred), 95.0);
    assert_eq!(p95(&hundred[..1]), 100.0);
    // 4 sqrt(0.0475 (1/100 + 1/100)) is 0.1233: ranks 82.67 and 107.3.
    assert_eq!(p95_bracket(&hundred, 100), (83.0, 100.0));
}

/// Targets of kinematic parameters: `kinematic_parameters` has their tests.
pub const PARAMETER_TARGETS: [&str; 9] = [
    "linuxcnc-5axiskins",
    "linuxcnc-maxkins",
    "linuxcnc-trt",
    "sinumerik-traori",
    "sinumerik-chain",
    "sinumerik-tcarr",
    "heidenhain-kinematics",
    "fanuc-5axis",
    "haas-mrzp",
];

/// True if a target's files are tables.
pub fn writes_tables(target: &str) -> bool {
    !target.starts_with("linuxcnc-") && !PARAMETER_TARGETS.contains(&target)
}
