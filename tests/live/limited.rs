//! The generated module with drives that have limits: 1.25 times those of the INI file.

use crate::{Folder, abbe, script_json};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const TRUNNION: &str = "configs/trunnion.yaml";

/// Compiles the trunnion; the INI file of the set, or the folder of a set made by that file's limits.
struct Sets {
    folder: Folder,
    /// The simulation's INI file with limits as machines have them.
    ini: String,
}

impl Sets {
    fn new(name: &str) -> Self {
        let folder = Folder::new(name);
        let sets = Self { folder, ini: String::new() };
        let sim = std::fs::read_to_string(sets.compiled("plain", &[]).join("sim.ini")).unwrap();
        let ini = limited(&sim);
        std::fs::write(sets.folder.0.join("machine.ini"), &ini).unwrap();
        Self { ini, ..sets }
    }

    fn compiled(&self, name: &str, more: &[&str]) -> PathBuf {
        let out = self.folder.0.join(name);
        let text = out.display().to_string();
        let all = ["--quiet", "compile", TRUNNION, "--target", "linuxcnc-kins", "--poses", "50", "--out", &text];
        let _ = abbe(&[&all, more].concat());
        out
    }

    fn fitted(&self) -> PathBuf {
        self.compiled("fitted", &["--ini", &self.folder.0.join("machine.ini").display().to_string()])
    }

    /// Runs lines of MDI; the answers about each.
    fn run(&self, set: &Path, ramp: bool, lines: &[&str]) -> Vec<Value> {
        let tools = "T2 P2 X0 Y0 Z140 D0\n";
        let program = json!({ "ini": self.ini, "tools": tools, "ramp": ramp, "lines": lines });
        let path = self.folder.0.join("program.json");
        std::fs::write(&path, program.to_string()).unwrap();
        let result = script_json("limited.py", &[&set.display().to_string(), &path.display().to_string()]);
        result["lines"].as_array().unwrap().clone()
    }
}

/// Linear joints of 800 mm/s2, a rotary axis of the program at 40 deg/s; following errors of 0.1 mm at rest.
fn limited(sim: &str) -> String {
    let mut section = "";
    let mut lines = Vec::new();
    for line in sim.lines() {
        if line.starts_with('[') {
            section = line;
        }
        let rotary = ["[JOINT_3]", "[JOINT_4]", "[AXIS_A]", "[AXIS_C]"].contains(&section);
        let key = line.split(" = ").next().unwrap();
        lines.push(match (key, section.starts_with("[AXIS"), rotary) {
            ("MAX_VELOCITY", true, true) => format!("{key} = 40"),
            ("MAX_VELOCITY", false, true) => format!("{key} = 60"),
            ("MAX_ACCELERATION", _, true) => format!("{key} = 400"),
            ("MAX_VELOCITY", _, false) => format!("{key} = 300"),
            ("MAX_ACCELERATION", _, false) => format!("{key} = 800"),
            ("FERROR", _, _) => format!("{key} = 0.5"),
            ("MIN_FERROR", _, _) => format!("{key} = 0.1"),
            _ => line.to_owned(),
        });
    }
    lines.join("\n") + "\n"
}

fn numbers(row: &Value) -> Vec<f64> {
    row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// A through 0 at 40 deg/s: the plain set asks more of Y than its drive has, the one made with `--ini` does not.
pub fn pole() {
    let sets = Sets::new("pole");
    let lines = ["G0 X200 Y0 Z100", "G0 A-20 C180", "G0 A20", "G0 A-20", "G0 C-135", "G0 A20"];
    let fitted = sets.run(&sets.fitted(), true, &lines);
    let failed: Vec<&Value> = fitted.iter().filter(|of| !of["failed"].is_null()).collect();
    assert!(failed.is_empty() && fitted.len() == lines.len(), "{failed:?}");
    let through: Vec<f64> = [2, 3, 5].map(|k| numbers(&fitted[k]["acceleration"])[1]).to_vec();
    assert!([2, 3, 5].iter().all(|k| fitted[*k]["zone"] == true), "{fitted:?}");
    assert!(through.iter().all(|y| *y < 800.0 && *y > 100.0), "{through:?}");
    let plain = sets.run(&sets.folder.0.join("plain"), true, &lines);
    let last = plain.last().unwrap();
    let why = last["failed"].as_str().unwrap_or_default();
    println!("  Y at most {through:.0?} mm/s2 with --ini; without: {}", why.lines().next().unwrap_or_default());
    assert!(why.contains("following error"), "{plain:?}");
}

/// Another tool length at A -60: joints go there by the ramp, no block moves meanwhile; without the ramp they step.
pub fn tool() {
    let sets = Sets::new("tool");
    let set = sets.fitted();
    let lines = ["G0 X50 Y20 Z100 A-60 C30", "G43 H2", "G49", "G43 H1", "G43 H2", "G0 A-50 C31"];
    let seen = sets.run(&set, true, &lines);
    assert!(seen.iter().all(|of| of["failed"].is_null()) && seen.len() == lines.len(), "{seen:?}");
    // By 2 sin(30 deg) times the change of the length, which is 20, 140 and 120 mm.
    for (k, change) in [(1, 20.0), (2, 140.0), (3, 120.0), (4, 20.0)] {
        let [before, after] = ["before", "after"].map(|key| numbers(&seen[k][key]));
        let way = (0..3).map(|i| (after[i] - before[i]).powi(2)).sum::<f64>().sqrt();
        let most = |key: &str| numbers(&seen[k][key]).into_iter().fold(0.0, f64::max);
        println!("  {}: {way:.3} mm, at most {:.4} mm in a cycle", lines[k], most("step"));
        assert!((way - change).abs() < 0.02 * change, "{way} {change}");
        assert!(most("step") < 0.0201 && most("acceleration") < 105.0, "{}", seen[k]);
        assert!(seen[k]["moved_in_ramp"].as_f64().unwrap() < 0.01, "{}", seen[k]);
    }
    let (first, again) = (numbers(&seen[0]["after"]), numbers(&seen[3]["after"]));
    assert!(first.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-8), "{first:?} {again:?}");
    let stepping = sets.run(&set, false, &lines[..2]);
    let why = stepping.last().unwrap()["failed"].as_str().unwrap_or_default();
    assert!(why.contains("following error"), "{stepping:?}");
}
