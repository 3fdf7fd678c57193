//! Inverse kinematics over D_n: on every configuration against the exact model, at poles, and where there is none.

use crate::configs::{folder, machine as config};
use crate::program::{Folder, abbe, json, refused, text};
use abbe::evaluate::{commanded_deviation, tool_axis_tilt};
use abbe::machine::{Approach, AxisKind, Machine, Travel};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A configuration with constant errors alone, which do not change along a displacement: 0.1 to 0.3 mm and mrad.
fn with_constants(files: &Folder, name: &str) -> PathBuf {
    let text = std::fs::read_to_string(folder().join(name)).unwrap();
    let mut document: serde_yaml::Value = serde_yaml::from_str(&text).unwrap();
    let map = document.as_mapping_mut().unwrap();
    for key in ["errors", "measured", "tolerances", "class", "covariance", "identify", "job", "look", "setup"] {
        let _ = map.remove(key);
    }
    let mut errors = String::new();
    for (i, axis) in config(name).axes().iter().enumerate() {
        for (k, letter) in ["X", "Y", "Z", "A", "B", "C"].iter().enumerate() {
            let (unit, sign) = (if k < 3 { "um" } else { "urad" }, if (i + k) % 3 == 0 { -1 } else { 1 });
            let value = sign * (100 + 20 * ((7 * i + 3 * k) % 11) as i32);
            let form = match axis.travel {
                Travel::Continuous => format!("{{ harmonics: {{ 0: [{value} {unit}, 0 {unit}] }} }}"),
                Travel::Range(..) => format!("{{ polynomial: [{value} {unit}] }}"),
            };
            errors += &format!("E{letter}{}: {form}\n", axis.name);
        }
    }
    let _ = map.insert("errors".into(), serde_yaml::from_str(&errors).unwrap());
    files.with(&name.replace('/', "-"), &serde_yaml::to_string(&document).unwrap())
}

/// A pose away from the poles: each axis at 37 % of its travel.
fn off_pole(machine: &Machine) -> Vec<f64> {
    let one = |travel: &Travel| match travel {
        Travel::Range(min, max) => (min + 0.37 * (max - min)).round(),
        Travel::Continuous => 133.0,
    };
    machine.axes().iter().map(|axis| one(&axis.travel)).collect()
}

fn at(machine: &Machine, pose: &[f64]) -> String {
    let one = |(axis, q): (&abbe::machine::Axis, &f64)| format!("{}={q}", axis.name);
    machine.axes().iter().zip(pose).map(one).collect::<Vec<_>>().join(",")
}

fn solved(file: &Path, at: &str, degree: usize) -> Value {
    let algebra = format!("degree: {degree}, generators: single");
    let list = ["eval", text(file), "--at", at, "--algebra", &algebra, "--inverse", "--format", "json", "--quiet"];
    json(&list)["poses"][0].clone()
}

/// Distance of the point (mm), and tilt of the tool axis (rad), of the exact machine after the displacements.
fn left(machine: &Machine, pose: &[f64], by: &Value) -> (f64, f64) {
    let moved: Vec<f64> = machine
        .axes()
        .iter()
        .zip(pose)
        .map(|(axis, q)| q + by[axis.name.as_str()].as_f64().unwrap_or_default())
        .collect();
    let deviation = commanded_deviation(machine, pose, &Approach::Mean.at_pose(&moved));
    (deviation.position.norm(), tool_axis_tilt(machine, pose, &deviation.rotation).norm())
}

const CONFIGS: [&str; 18] = [
    "boring-w.yaml",
    "gantry-3ax.yaml",
    "hh-bd-ram.yaml",
    "hh-ca-gantry.yaml",
    "hh-cb-a-nut.yaml",
    "hmc-4ax.yaml",
    "ht-b-c.yaml",
    "ht-nut45-c.yaml",
    "millturn-bc.yaml",
    "trunnion.yaml",
    "tt-ab-desktop.yaml",
    "tt-ac-800.yaml",
    "tt-bc.yaml",
    "tt-nut45.yaml",
    "vmc-cframe-754.yaml",
    "vmc-travelling-column.yaml",
    "papers/bui-kimm.yaml",
    "papers/hrdina-vasik-2014.yaml",
];

#[test]
fn off_the_poles_each_order_undoes_the_errors_to_the_next() {
    let files = Folder::new("inverse-orders");
    let mut solutions = 0;
    for name in CONFIGS {
        let file = with_constants(&files, name);
        let machine = abbe::load(text(&file), &abbe::LoadOptions::default(), abbe::Run::on_disk()).unwrap().value;
        let pose = off_pole(&machine);
        let count = |kind: AxisKind| machine.axes().iter().filter(|axis| axis.kind == kind).count();
        if count(AxisKind::Linear) != 3 {
            let algebra = ["--algebra", "degree: 2, generators: single", "--inverse"];
            let (exit, said) = refused(&[&["eval", text(&file), "--quiet"][..], &algebra].concat());
            assert!(exit == 1 && said.contains("E0524") && said.contains("linear ax"), "{name}: {said}");
            continue;
        }
        solutions += 1;
        let of: Vec<Value> = (1..=3).map(|degree| solved(&file, &at(&machine, &pose), degree)).collect();
        assert!(of.iter().all(|of| of["inverse_pole"].is_null()), "{name}");
        let found: Vec<(f64, f64)> = of.iter().map(|of| left(&machine, &pose, &of["inverse"])).collect();
        let before = left(&machine, &pose, &Value::Null);
        assert!(before.0 > 0.05, "{name}: {before:?}");
        // Errors of 1e-3 over levers of a metre: each order leaves a hundredth of the one before, to rounding.
        let falls = |a: f64, b: f64| b < a / 20.0 || b < 1e-10;
        let points: Vec<f64> = std::iter::once(before.0).chain(found.iter().map(|of| of.0)).collect();
        assert!(points.windows(2).all(|pair| falls(pair[0], pair[1])), "{name}: {points:?}");
        // With linearised joints no rotation is one, and its vector holds squares of the errors.
        if count(AxisKind::Rotary) == 2 && name != "papers/bui-kimm.yaml" {
            let tilts: Vec<f64> = std::iter::once(before.1).chain(found.iter().map(|of| of.1)).collect();
            assert!(tilts.windows(2).all(|pair| falls(pair[0], pair[1])), "{name}: {tilts:?}");
        }
    }
    assert!(solutions >= 14, "{solutions}");
}

#[test]
fn at_a_pole_the_position_is_held_and_what_is_left_is_named() {
    let files = Folder::new("inverse-pole");
    let file = with_constants(&files, "trunnion.yaml");
    let machine = abbe::load(text(&file), &abbe::LoadOptions::default(), abbe::Run::on_disk()).unwrap().value;
    // A turns the tool in the plane across X of the machine; the table has turned that by C.
    for (c, unreachable) in [(0.0_f64, [1.0, 0.0, 0.0]), (90.0, [0.0, 1.0, 0.0])] {
        let pose: Vec<f64> = machine
            .axes()
            .iter()
            .map(|axis| match axis.name.as_str() {
                "X" => 120.0,
                "Y" => 200.0,
                "Z" => -70.0,
                "C" => c,
                _ => 0.0,
            })
            .collect();
        let at = at(&machine, &pose);
        let mut points = vec![left(&machine, &pose, &Value::Null).0];
        for degree in 1..=3 {
            let of = solved(&file, &at, degree);
            let pole = &of["inverse_pole"];
            assert_eq!(
                (&pole["free"], &of["inverse"]["A"], &of["inverse"]["C"]),
                (&"C".into(), &0.0.into(), &0.0.into())
            );
            for (k, expected) in unreachable.iter().enumerate() {
                assert!((pole["unreachable"][k].as_f64().unwrap().abs() - expected).abs() < 1e-6, "C = {c}: {pole}");
            }
            points.push(left(&machine, &pose, &of["inverse"]).0);
        }
        assert!(points.windows(2).all(|pair| pair[1] < pair[0] / 20.0 || pair[1] < 1e-10), "{points:?}");
        let algebra = ["--algebra", "degree: 2, generators: single", "--inverse"];
        let said = abbe(&[&["eval", text(&file), "--quiet", "--at", &at][..], &algebra].concat());
        assert!(said.contains("pose 1 is at a pole") && said.contains("`C` is free"), "{said}");
    }
}

#[test]
fn machines_without_three_linear_axes_are_refused_in_words() {
    let algebra = ["--algebra", "degree: 2, generators: single", "--inverse", "--quiet"];
    for (machine, words) in
        [("papers/hrdina-vasik-2014.yaml", "has 1 linear axis"), ("boring-w.yaml", "has 4 linear axes")]
    {
        let (exit, said) = refused(&[&["eval", machine][..], &algebra].concat());
        assert!(exit == 1 && said.contains("E0524") && said.contains(words), "{said}");
    }
}
