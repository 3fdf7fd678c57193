//! Output of `map` and `report` for targets that replace the kinematics.

use crate::program::{Folder, abbe, json, text};
use crate::support::packed;
use serde_json::Value;

fn max(value: &Value) -> f64 {
    value["position_um"]["max"].as_f64().unwrap()
}

/// The module holds the tip up to the rounding of its files; from one side the residual is that of the certificate.
#[test]
fn maps_show_what_a_module_leaves() {
    let map = |direction: &str, seed: &str| {
        let poses = ["--random", "100", "--seed", seed, "--direction", direction, "--format", "json", "--quiet"];
        json(&[&["map", "trunnion.yaml", "--target", "linuxcnc-kins"], &poses[..]].concat())
    };
    let mean = map("mean", "3");
    assert!(max(&mean) < 2e-5 && max(&mean["uncompensated"]) > 20.0, "{mean}");
    assert_eq!(mean["target"], "linuxcnc-kins");
    let folder = Folder::new("kinematics-views");
    let out = folder.file("out");
    let certificate = json(&[
        "compile",
        "trunnion.yaml",
        "--target",
        "linuxcnc-kins",
        "--out",
        text(&out),
        "--poses",
        "100",
        "--seed",
        "3",
        "--format",
        "json",
        "--quiet",
    ]);
    let side = map(certificate["direction"].as_str().unwrap(), "3");
    for figure in ["max", "mean", "rms", "p95"] {
        let [a, b] = [&side, &certificate["compensated"]].map(|v| v["position_um"][figure].as_f64().unwrap());
        assert!((a - b).abs() < 1e-9 && a < 1e-3, "{figure}: {a} {b}");
    }
}

/// Constants of the controller's own kinematics leave more than nothing and less than all.
#[test]
fn maps_show_what_constants_leave() {
    let map = json(&[
        "map",
        "vmc-cframe-754.yaml",
        "--target",
        "linuxcnc-matrixkins",
        "--random",
        "100",
        "--format",
        "json",
        "--quiet",
    ]);
    let (after, before) = (max(&map), max(&map["uncompensated"]));
    assert!(after > 1.0 && after < 0.7 * before, "{after} {before}");
}

/// A robot's map, which no table could change.
#[test]
fn a_robot_is_mapped_with_its_module() {
    let machine = format!("{}/tests/data/kins/ur5.yaml", env!("CARGO_MANIFEST_DIR"));
    let poses = ["--low-discrepancy", "60", "--format", "json", "--quiet"];
    let map = json(&[&["map", &machine, "--target", "linuxcnc-kins"], &poses[..]].concat());
    assert!(max(&map["uncompensated"]) > 300.0, "{map}");
    assert!(map["position_um"]["p95"].as_f64().unwrap() < 1e-6, "{map}");
    assert!(map["rotation_urad"]["p95"].as_f64().unwrap() < 1e-6, "{map}");
}

#[test]
fn the_page_has_the_field_after_a_module() {
    let folder = Folder::new("kinematics-page");
    let out = folder.file("page.html");
    let target = ["--target", "linuxcnc-kins", "--poses", "40", "--out", text(&out), "--quiet"];
    abbe(&[&["report", "vmc-cframe-754.yaml"], &target[..]].concat());
    let data = packed::data(&std::fs::read_to_string(out).unwrap());
    let machine = &data["machines"][0];
    let layers = machine["field"]["layers"].as_array().unwrap();
    let largest = |id: &str| {
        let layer = layers.iter().find(|layer| layer["id"] == id).unwrap();
        layer["at"].as_array().unwrap().iter().map(|at| at["max_um"].as_f64().unwrap()).fold(0.0, f64::max)
    };
    assert!(largest("total") > 30.0 && largest("after-linuxcnc-kins") < 1e-3);
    assert!((largest("removed-linuxcnc-kins") - largest("total")).abs() < 1e-3);
    assert_eq!(machine["certificates"][0]["target"], "linuxcnc-kins");
}
