//! `diff` of two machine files: what differs is named, and each effect is that of a file with this difference alone.

use crate::program::{Folder, abbe, json, refused};
use serde_json::Value;

const BASE: &str = "abbe: 1
machine: One
chain: \"w C' A' Y' b X Z t\"
axes:
  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }
  Y: { travel: [0 mm, 450 mm], origin: [0, 0, 0] }
  Z: { travel: [-400 mm, 0 mm], origin: [0, 0, 0] }
  A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350], on_tool: { origin: { from: gauge, at: [0, 0, 200] } } }
  C: { travel: continuous, origin: [250, 225, -380], on_tool: { origin: { from: gauge, at: [0, 0, 250] } } }
tool: { gauge: [0, 0, 0], length: 120 mm }
workpiece: { origin: [250, 225, -380] }
errors:
  EC0Y: 21 urad
  EB0Z: -22 urad
  EXX: { points: [[0 mm, 0 um], [500 mm, 6 um]] }
  EBX: { points: [[0 mm, 0 urad], [500 mm, 12 urad]] }
  EB0C: 24 urad
";

/// The base with lines in place of others.
fn edited(folder: &Folder, name: &str, edits: &[(&str, &str)]) -> String {
    let mut text = BASE.to_owned();
    for (old, new) in edits {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    folder.with(name, &text).display().to_string()
}

const EDITS: [(&str, &str, &str); 5] = [
    (
        "origin of A",
        "A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350]",
        "A: { travel: [-120 deg, 30 deg], origin: [250, 225, -365]",
    ),
    ("tool", "length: 120 mm", "length: 180 mm"),
    ("EXX", "[500 mm, 6 um]", "[500 mm, 9 um]"),
    ("EC0Y", "EC0Y: 21 urad", "EC0Y: -12 urad"),
    ("EA0C", "  EB0C: 24 urad\n", "  EB0C: 24 urad\n  EA0C: 15 urad\n"),
];

fn named(difference: &Value) -> String {
    match (difference["kind"].as_str().unwrap(), difference["name"].as_str().unwrap()) {
        ("error", name) => name.to_owned(),
        (kind, "") => kind.to_owned(),
        (kind, name) => format!("{kind} of {name}"),
    }
}

#[test]
fn each_effect_is_that_of_a_file_with_this_difference_alone() {
    let folder = Folder::new("diff-machines-each");
    let base = edited(&folder, "base.yaml", &[]);
    let edits: Vec<(&str, &str)> = EDITS.iter().map(|(_, old, new)| (*old, *new)).collect();
    let second = edited(&folder, "second.yaml", &edits);
    let found = json(&["diff", &base, &second, "--poses", "300", "--format", "json"]);
    let differences = found["differences"].as_array().unwrap();
    let names: Vec<String> = differences.iter().map(named).collect();
    assert_eq!(names, ["origin of A", "tool", "EA0C", "EC0Y", "EXX"]);
    // Files written by hand, side by side: the work that all of them reach is the same.
    let single: Vec<String> = EDITS
        .iter()
        .enumerate()
        .map(|(i, (_, old, new))| edited(&folder, &format!("{i}.yaml"), &[(old, new)]))
        .collect();
    let mut args = vec!["compare", &base, &second];
    args.extend(single.iter().map(String::as_str));
    args.extend(["--poses", "300", "--format", "json"]);
    let compared = json(&args);
    assert_eq!(compared["poses"], found["poses"]);
    let p95 = |machine: usize| compared["machines"][machine]["position_um"]["p95"].as_f64().unwrap();
    assert_eq!(found["p95_um"], serde_json::json!([p95(0), p95(1)]));
    for (i, (name, ..)) in EDITS.iter().enumerate() {
        let difference = differences.iter().find(|d| named(d) == *name).unwrap();
        assert_eq!(difference["minus_first_um"].as_f64().unwrap(), p95(i + 2) - p95(0), "{name}");
    }
    let of = |name: &str| differences.iter().find(|d| named(d) == name).unwrap();
    assert!((of("EXX")["largest"].as_f64().unwrap() - 3.0).abs() < 1e-12);
    assert_eq!((of("EC0Y")["first"].as_str(), of("EC0Y")["second"].as_str()), (Some("21 urad"), Some("-12 urad")));
    assert_eq!((of("EA0C")["first"].as_str(), of("EA0C")["second"].as_str()), (Some("none"), Some("15 urad")));
}

#[test]
fn an_axis_that_changes_its_side_takes_its_geometry_along() {
    let folder = Folder::new("diff-machines-side");
    let base = edited(&folder, "base.yaml", &[]);
    let head = edited(&folder, "head.yaml", &[("w C' A' Y' b X Z t", "w C' Y' b X Z A t"), ("EC0Y: 21", "EC0Y: 40")]);
    let moved = edited(&folder, "moved.yaml", &[("w C' A' Y' b X Z t", "w C' Y' b X Z A t")]);
    let found = json(&["diff", &base, &head, "--format", "json"]);
    let differences = found["differences"].as_array().unwrap();
    assert_eq!(differences.iter().map(named).collect::<Vec<_>>(), ["chain", "EC0Y"]);
    let compared = json(&["compare", &base, &head, &moved, "--poses", "2000", "--format", "json"]);
    let p95 = |machine: usize| compared["machines"][machine]["position_um"]["p95"].as_f64().unwrap();
    assert_eq!(differences[0]["minus_first_um"].as_f64().unwrap(), p95(2) - p95(0));
    // The error is judged on the new chain.
    assert_eq!(differences[1]["minus_first_um"].as_f64().unwrap(), p95(1) - p95(2));
}

#[test]
fn added_axes_conventions_and_travels_are_named() {
    let folder = Folder::new("diff-machines-named");
    let base = edited(&folder, "base.yaml", &[]);
    let other = edited(
        &folder,
        "other.yaml",
        &[
            ("chain: \"w C' A' Y' b X Z t\"", "conventions: { linear: before }\nchain: \"w C' A' Y' b X Z W t\""),
            (
                "tool: { gauge",
                "  W: { kind: linear, direction: [0, 0, 1], travel: [-50 mm, 0 mm], origin: [0, 0, 0] }\ntool: { gauge",
            ),
            ("[-400 mm, 0 mm]", "[-400 mm, 10 mm]"),
        ],
    );
    let found = abbe(&["diff", &base, &other, "--poses", "100"]);
    for line in ["chain", "w C' A' Y' b X Z W t", "travel of Z", "-400 .. 10 mm", "conventions", "linear before"] {
        assert!(found.contains(line), "{line}\n{found}");
    }
    let same = abbe(&["diff", &base, &base]);
    assert!(same.contains("The machines do not differ."), "{same}");
    let csv = abbe(&["diff", &base, &other, "--poses", "100", "--format", "csv"]);
    assert_eq!(csv.lines().next(), Some("kind,name,first,second,largest [um or urad],minus first [um]"));
    assert_eq!(csv.lines().count(), 4, "{csv}");
}

#[test]
fn bounds_and_classes_are_named() {
    let folder = Folder::new("diff-machines-bounds");
    let base = edited(&folder, "base.yaml", &[]);
    let bounded = "class: premium\ntolerances: { A: { across: 2 um } }\nerrors:\n  EZ0A: { tolerance: 5 um }\n";
    let other = edited(&folder, "other.yaml", &[("errors:\n", bounded)]);
    let found = json(&["diff", &base, &other, "--poses", "50", "--format", "json"]);
    let list = found["differences"].as_array().unwrap();
    assert_eq!(list.iter().map(named).collect::<Vec<_>>(), ["class", "tolerances", "EZ0A"]);
    assert_eq!((list[0]["first"].as_str(), list[0]["second"].as_str()), (Some("none"), Some("premium")));
    assert_eq!(list[1]["second"], "A across within 2 um");
    assert_eq!(list[2]["second"], "within 5 um");
    // All of them widen what is drawn beside the values.
    assert!(list.iter().all(|d| d["minus_first_um"].as_f64().unwrap() > 0.0), "{found}");
    assert_eq!(found["from"], "bounds");
}

#[test]
fn files_are_machines_and_folders_are_sets() {
    let folder = Folder::new("diff-machines-usage");
    let base = edited(&folder, "base.yaml", &[]);
    let here = folder.file("").display().to_string();
    for args in [vec!["diff", &base, &here], vec!["diff", &here, &here], vec!["diff", &base, &base, &here]] {
        let (_, said) = refused(&args);
        assert!(said.contains("files are machines and folders are sets"), "{said}");
    }
    let (_, said) = refused(&["diff", &base, &base, "--correct", "pose"]);
    assert!(said.contains("options of the compensation go with two sets"), "{said}");
}
