//! Limits of drives: the pole zone by an INI file, the pins that show it, and the ramp to another tool.

use super::bench::{Ask, Bench, Module};
use crate::oracle::program::Folder;
use crate::support::{Run, compile, config};
use serde_json::Value;
use std::path::Path;

const WIDE: [&str; 2] = ["--poses", "20"];

/// An INI file: speed of the rotary axes of the program, acceleration of the linear joints.
fn ini(speed: f64, acceleration: f64) -> String {
    let joint = |n: u32, limits: [f64; 2]| {
        format!("[JOINT_{n}]\nMAX_VELOCITY = {}\nMAX_ACCELERATION = {} # as built\n", limits[0], limits[1])
    };
    let linear: String = (0..3).map(|n| joint(n, [300.0, acceleration])).collect();
    let rotary: String = (3..5).map(|n| joint(n, [90.0, 600.0])).collect();
    format!(
        "[TRAJ]\nLINEAR_UNITS = mm\nMAX_ANGULAR_VELOCITY = {speed}\n{linear}{rotary}\
         [AXIS_A]\nMAX_VELOCITY = 300\n# the controller takes the first\n[AXIS_A]\nMAX_VELOCITY = 1\n"
    )
}

fn fitted(folder: &Folder, name: &str, text: &str) -> Run {
    let file = folder.write(&format!("{name}.ini"), text);
    let more = [&WIDE[..], &["--ini", file.to_str().unwrap()]].concat();
    compile(&config("trunnion.yaml"), "linuxcnc-kins", &folder.path(name), &more)
}

/// The largest acceleration that a turn of 1 deg/s asks of a joint, by the certificate, whose figures are held against
/// the compiled module by a test of their own.
fn asked(json: &Value, turning: &str, joint: &str) -> f64 {
    let of = json["drives"].as_array().unwrap().iter();
    let mut of = of.filter(|one| one["turning"] == turning && one["joint"] == joint);
    of.next().map_or(0.0, |one| one["acceleration"].as_f64().unwrap())
}

/// The zone is the narrowest at which the drives follow: with it they do, with one a twentieth narrower they do not.
#[test]
fn the_pole_zone_is_chosen_by_the_limits_of_the_ini_file() {
    let folder = Folder::new();
    let plain = compile(&config("trunnion.yaml"), "linuxcnc-kins", &folder.path("plain"), &WIDE).json();
    let run = fitted(&folder, "slow", &ini(40.0, 800.0));
    assert!(!run.err.contains("W0763"), "{}", run.err);
    let json = run.json();
    let zone = |json: &Value| json["pole_zone_deg"].as_f64().unwrap();
    let y = asked(&json, "A", "Y") * 1600.0;
    println!("zone {:.3} deg, Y {y:.0} mm/s2 of 800; before {:.3} deg", zone(&json), zone(&plain));
    assert!(zone(&json) > 1.5 * zone(&plain) && zone(&json) < 4.0 * zone(&plain));
    assert!(y <= 0.8 * 800.0 && y > 0.8 * 0.8 * 800.0, "{y}");
    // Slopes go with the inverse square of the width and their change with its third power.
    let narrower = asked(&plain, "A", "Y") * (zone(&plain) / zone(&json)).powi(3) * 1600.0;
    assert!((0.7..1.3).contains(&(narrower / y)), "{narrower} {y}");
    // Drives that are fast enough leave the zone as it is.
    assert_eq!(zone(&fitted(&folder, "fast", &ini(5.0, 5000.0)).json()), zone(&plain));
    // The set says what it was made by, and verify reads the zone from the files.
    let lock = std::fs::read_to_string(folder.path("slow").join("abbe.lock.json")).unwrap();
    assert!(lock.contains("pole zone"), "{lock}");
    let again = crate::support::verify(&config("trunnion.yaml"), &folder.path("slow"), &WIDE).json();
    assert_eq!(again["pole_zone_deg"], json["pole_zone_deg"]);
}

/// Where the lever of the tip alone asks too much, no zone helps: the speed that the drives follow is said.
#[test]
fn an_axis_that_turns_too_fast_is_said() {
    let folder = Folder::new();
    let run = fitted(&folder, "out", &ini(300.0, 800.0));
    assert!(run.code == Some(0) && run.err.contains("warning[W0763]"), "{}", run.err);
    let json = run.json();
    let drives = json["drives"].as_array().unwrap();
    for turning in ["A", "C"] {
        let said =
            run.err.split(&format!("lets `{turning}` turn at 300 deg/s, and the drives follow it up to ")).nth(1);
        let said: f64 = said.unwrap().split_whitespace().next().unwrap().parse().unwrap();
        let of =
            drives.iter().filter(|one| one["turning"] == turning && "XYZ".contains(one["joint"].as_str().unwrap()));
        let by_joint = of.map(|one| {
            let [rate, bend] = ["rate", "acceleration"].map(|key| one[key].as_f64().unwrap());
            (0.8 * 300.0 / rate).min((0.8 * 800.0 / bend).sqrt())
        });
        let least = by_joint.fold(f64::INFINITY, f64::min);
        assert!((said - least).abs() < 0.006 * least && (30.0..100.0).contains(&said), "{turning}: {said} {least}");
    }
}

#[test]
fn ini_files_without_limits_are_refused() {
    let folder = Folder::new();
    let whole = ini(40.0, 800.0);
    let cases = [
        (whole.replace("[JOINT_1]", "[JOINT_7]"), "[JOINT_1] MAX_VELOCITY is missing: the joint of `Y`"),
        (whole.replace("MAX_ANGULAR_VELOCITY", "MAX_LINEAR_VELOCITY"), "[AXIS_C] MAX_VELOCITY is missing"),
        (whole.replace("= 800", "= -800"), "[JOINT_1] MAX_ACCELERATION is no number above 0"),
        (whole.replace("= 800", "= nan"), "[JOINT_1] MAX_ACCELERATION is no number above 0"),
        (whole.replace("= mm", "= inch"), "LINEAR_UNITS is not mm"),
        (String::new(), "is missing"),
    ];
    for (k, (text, words)) in cases.iter().enumerate() {
        let run = fitted(&folder, &format!("bad{k}"), text);
        run.refused("E0755").says(words);
        assert!(!folder.path(&format!("bad{k}")).exists());
    }
    let file = folder.write("whole.ini", &whole);
    let more = ["--poses", "5", "--ini", file.to_str().unwrap()];
    let run = compile(&config("trunnion.yaml"), "linuxcnc", &folder.path("tables"), &more);
    assert!(run.code == Some(2) && run.err.contains("--ini: `linuxcnc` has no pole zone"), "{}", run.err);
}

fn trunnion(out: &Path) {
    assert_eq!(compile(&config("trunnion.yaml"), "linuxcnc-kins", out, &WIDE).code, Some(0));
}

/// On a trunnion the angle from the pole is that of A.
#[test]
fn pins_show_the_pole() {
    let folder = Folder::new();
    let out = folder.path("out");
    trunnion(&out);
    let sample = crate::support::config::sample(&config("trunnion.yaml"));
    let (bench, module) = (Bench::new(&sample, &out), Module::build(&out));
    let index = |name: &str| sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap();
    for a in [0.0, 0.5, -0.97, -0.98, 20.0, -75.0] {
        let mut pose = vec![0.0; sample.rigid.walk.len()];
        (pose[index("A")], pose[index("C")]) = (a, 77.0);
        let row = &module.ramped(&[bench.ask(&pose, 1.0)])[0];
        let (zone, angle) = (row[11], row[12]);
        assert!((angle - a.abs()).abs() < 1e-6 && (zone == 1.0) == (a.abs() < 0.974), "{a}: {zone} {angle}");
    }
}

/// Another tool at a tilt: joints go where the module has them with that tool at once, by the ramp; a tool to which there
/// is no way leaves the one of before in force, and the one of before is the way out.
#[test]
fn another_tool_is_ramped() {
    let folder = Folder::new();
    let out = folder.path("out");
    trunnion(&out);
    let sample = crate::support::config::sample(&config("trunnion.yaml"));
    let (bench, module) = (Bench::new(&sample, &out), Module::build(&out));
    let mut pose = vec![0.0; sample.rigid.walk.len()];
    let index = |name: &str| sample.rigid.walk.iter().position(|axis| axis.name == name).unwrap();
    (pose[index("A")], pose[index("C")], pose[index("X")]) = (-60.0, 30.0, 80.0);
    let first = bench.ask(&pose, 1.0);
    let [x, y, z] = first.tool;
    let with = |tool| Ask { tool, ..first };
    let asks = [first, with([x, y, z + 17.0]), with([x, y, z - 85.0]), with([x, y, 1e9]), with([x, y, z - 85.0])];
    let rows = module.ramped(&asks);
    let phases: Vec<&[[f64; 13]]> = rows.chunks(rows.len() / asks.len()).collect();
    let at_once = module.answers(&asks[..3]);
    for (k, phase) in phases[..3].iter().enumerate() {
        let last = phase.last().unwrap();
        let away = (0..9).map(|i| (last[i] - at_once[k].joints[i]).abs()).fold(0.0, f64::max);
        assert!(away < 1e-8 && last[9] == 0.0 && last[10] == 0.0, "{k}: {away}");
    }
    for pair in [[0, 1], [1, 2]] {
        let before = *phases[pair[0]].last().unwrap();
        let all: Vec<[f64; 13]> = std::iter::once(before).chain(phases[pair[1]].iter().copied()).collect();
        assert!(phases[pair[1]][0][9] == 1.0, "the ramp is not said at once");
        let still = all.iter().skip(1).position(|row| row[9] == 0.0).unwrap();
        let (mut step, mut bend) = (0.0_f64, 0.0_f64);
        for i in 0..9 {
            for three in all.windows(3) {
                step = step.max((three[1][i] - three[0][i]).abs());
                bend = bend.max((three[2][i] - 2.0 * three[1][i] + three[0][i]).abs() * 1e6);
            }
        }
        println!("{still} ms, at most {step:.5} mm a cycle, {bend:.1} mm/s2");
        assert!(step < 0.02001 && step > 0.0198 && bend < 110.0 && bend > 90.0, "{step} {bend}");
        assert!(all[still + 2..].iter().all(|row| (0..9).all(|i| row[i] == all.last().unwrap()[i])));
    }
    // No way: joints stand, both pins say so, and the tool of before clears them.
    let stood = phases[2].last().unwrap();
    assert!(phases[3].iter().all(|row| row[9] == 1.0 && row[10] == 1.0 && row[..9] == stood[..9]));
    assert!(phases[4].iter().all(|row| row[9] == 0.0 && row[10] == 0.0 && row[..9] == stood[..9]));
}
