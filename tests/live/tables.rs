//! COMP_FILE tables in the running controller.

use crate::{Folder, abbe, script, script_json};

pub fn three_axis() {
    in_the_controller("configs/vmc-cframe-754.yaml", 3);
}

pub fn five_axis() {
    in_the_controller("configs/trunnion.yaml", 5);
}

/// A second set over a first one, taken back: the controller does with the restore set what the first set says.
pub fn restored() {
    let machine = "configs/vmc-cframe-754.yaml";
    let folder = Folder::new("restored");
    let [first, second] = ["first", "second"].map(|name| folder.0.join(name).display().to_string());
    let compile = ["--quiet", "compile", machine, "--target", "linuxcnc", "--poses", "50", "--out"];
    let _ = abbe(&[&compile[..], &[&first]].concat());
    let _ = abbe(&[&compile[..], &[&second, "--installed", &first]].concat());
    let read = |out: &str| std::fs::read_to_string(format!("{out}/joint_0_X.comp")).unwrap();
    assert_ne!(read(&first), read(&second));
    loaded(&folder, machine, 3, &format!("{second}/restore"), &first);
}

fn in_the_controller(machine: &str, joints: usize) {
    let folder = Folder::new(&joints.to_string());
    let out = folder.0.join("out").display().to_string();
    let _ = abbe(&["--quiet", "compile", machine, "--target", "linuxcnc", "--out", &out, "--poses", "50"]);
    loaded(&folder, machine, joints, &out, &out);
}

/// Loads a set, moves all joints in both directions over their tables and beyond, and compares the controller's
/// correction at every recorded position with the replay of another set that says the same (1e-9) and the motor with it
/// (1e-6, at rest 5e-5).
fn loaded(folder: &Folder, machine: &str, joints: usize, out: &str, same: &str) {
    let observed = folder.0.join("observed.csv").display().to_string();
    let replay = folder.0.join("replay.csv").display().to_string();
    let seen = script_json("run_comp.py", &["observe", out, "--out", &observed]);
    assert_eq!(seen["joints"].as_array().unwrap().len(), 2 * joints, "every joint in both directions");
    std::fs::write(&replay, abbe(&["--quiet", "verify", machine, same, "--replay", &observed])).unwrap();
    let checked = script_json("run_comp.py", &["check", &observed, out, "--expect", &replay]);
    assert_eq!(checked["replay"]["ok"], true);
    let joints = checked["replay"]["joints"].as_array().unwrap();
    let largest = |key: &str| joints.iter().map(|j| j["max_difference"][key].as_f64().unwrap()).fold(0.0, f64::max);
    println!(
        "  {machine}: table value {:e} from the replay; motor {:e} in motion, {:e} at rest (mm, deg)",
        largest("corr"),
        largest("motor_in_motion"),
        largest("motor_at_rest")
    );
}

/// The controller swallows these in silence; none of the files of any config has one of them.
pub fn malformed() {
    let shown = script_json("malformed.py", &["show"]);
    let variants = shown["variants"].as_array().unwrap();
    assert!(variants.len() >= 7, "{variants:?}");
    let mut compiled = 0;
    for entry in std::fs::read_dir("configs").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "yaml") {
            continue;
        }
        let folder = Folder::new("lint");
        let out = folder.0.join("out").display().to_string();
        let _ = abbe(&[
            "--quiet",
            "compile",
            &path.display().to_string(),
            "--target",
            "linuxcnc",
            "--out",
            &out,
            "--poses",
            "50",
        ]);
        let lint = script("malformed.py", &["lint", &out]);
        assert!(lint.status.success(), "{}: {}", path.display(), String::from_utf8_lossy(&lint.stdout));
        compiled += 1;
    }
    assert!(compiled >= 12);
}

/// The comparisons can fail: tables, replays and observations spoiled on purpose are noticed.
pub fn harness() {
    let output = script("selftest.py", &["--spoiled"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
