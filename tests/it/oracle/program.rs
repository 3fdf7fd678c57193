//! The program under test, seen only through its command line.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

use super::curves::Travel;
use super::rigid::{Answer, Frame};

/// A temporary folder that goes away with its last user.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder of a name that no other test has.
    pub fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let name = format!("abbe-oracle-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Returns the path of a file of this name, existing or not.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.path(name), text).unwrap();
        self.path(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Request to `eval`.
#[derive(Clone, Copy)]
pub struct Ask<'a> {
    /// `exact` or a number; the default if none.
    pub order: Option<&'a str>,
    /// The frame of the answer.
    pub frame: Frame,
    /// The direction of travel.
    pub travel: Travel,
    /// The tool, if not the first.
    pub tool: Option<&'a str>,
}

/// Request without options.
pub const DEFAULT: Ask<'static> = Ask { order: None, frame: Frame::Workpiece, travel: Travel::Mean, tool: None };

/// Asks `eval` for the answers at poses, given as axis names and rows.
pub fn eval<N: AsRef<str>>(machine: &Path, names: &[N], poses: &[Vec<f64>], ask: Ask) -> Vec<Answer> {
    let folder = Folder::new();
    let cells = |pose: &Vec<f64>| pose.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let header = names.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(",");
    let rows: String = poses.iter().map(|pose| cells(pose) + "\n").collect();
    let csv = folder.write("poses.csv", &format!("{header}\n{rows}"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.arg("eval").arg(machine).arg("--poses").arg(csv).args(["--format", "json"]);
    // Defaults are omitted, so that they are tested too.
    ask.order.map(|order| command.args(["--order", order]));
    match ask.frame {
        Frame::Workpiece => {}
        Frame::Machine => drop(command.args(["--frame", "machine"])),
        Frame::Tool => drop(command.args(["--frame", "tool"])),
    }
    match ask.travel {
        Travel::Mean => {}
        Travel::Forward => drop(command.args(["--direction", "forward"])),
        Travel::Reverse => drop(command.args(["--direction", "reverse"])),
    }
    ask.tool.map(|tool| command.args(["--tool", tool]));
    let output = command.output().unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}\n{complaint}", std::fs::read_to_string(machine).unwrap());
    let answers = parse(&output.stdout, ask);
    assert_eq!(answers.len(), poses.len());
    answers
}

fn parse(stdout: &[u8], ask: Ask) -> Vec<Answer> {
    let json: Value = serde_json::from_slice(stdout).unwrap();
    // An order is printed as a number or as its digits.
    assert_eq!(json["order"].to_string().trim_matches('"'), ask.order.unwrap_or("exact"));
    assert_eq!(json["frame"], format!("{:?}", ask.frame).to_lowercase());
    assert_eq!(json["units"]["position"], "mm");
    assert_eq!(json["units"]["rotation"], "rad");
    json["poses"].as_array().unwrap().iter().map(answer).collect()
}

fn answer(pose: &Value) -> Answer {
    Answer {
        nominal: numbers(&pose["nominal"]),
        deviation: numbers(&pose["deviation"]),
        rotation: numbers(&pose["rotation"]),
        e_ve: std::array::from_fn(|row| numbers(&pose["e_ve"][row])),
    }
}

fn numbers<const N: usize>(list: &Value) -> [f64; N] {
    assert_eq!(list.as_array().unwrap().len(), N);
    std::array::from_fn(|i| list[i].as_f64().unwrap())
}
