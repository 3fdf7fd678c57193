//! `abbe classify` as a program.

use crate::oracle::program::Folder;
use serde_json::Value;
use std::process::Command;

fn classify(text: &str, more: &[&str]) -> (String, String, i32) {
    let folder = Folder::new();
    let path = folder.write("matrix.yaml", text);
    let output = Command::new(env!("CARGO_BIN_EXE_abbe")).arg("classify").arg(path).args(more).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code().unwrap())
}

/// A quarter turn about z after a travel of 100 mm, with 12 urad about z and 4 um along y.
const MOTION: &str = "matrix:\n  - [[0, -12e-6], -1, 0, 100]\n  - [1, [0, -12e-6], 0, [0, 0.0052]]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";

#[test]
fn a_motion_is_named_with_its_errors() {
    let (out, complaint, exit) = classify(MOTION, &["--format", "json"]);
    assert_eq!(exit, 0, "{complaint}");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["admissible"], true);
    let near = |value: &Value, wanted: f64| (value.as_f64().unwrap() - wanted).abs() < 1e-15;
    let before = &json["errors_before"];
    assert!(near(&before["EC"], 12e-6) && near(&before["EY"], 0.004) && near(&before["EX"], 0.0), "{before}");
    assert!(near(&json["errors_after"]["EX"], 0.0052), "{json}");
    let (out, _, _) = classify(MOTION, &[]);
    assert!(out.contains("90 deg about 0, 0, 1") && out.contains("EC 12 urad") && out.contains("EY 4 um"), "{out}");
}

#[test]
fn two_real_matrices_are_the_same() {
    let two = "real: [[0, -1, 0, 100], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n\
               dual: [[-12e-6, 0, 0, 0], [0, -12e-6, 0, 0.0052], [0, 0, 0, 0], [0, 0, 0, 0]]\n";
    assert_eq!(classify(two, &[]).0, classify(MOTION, &[]).0);
}

#[test]
fn what_is_not_admissible_is_said_with_its_reason() {
    for (from, to, words) in [
        ("[1, [0, -12e-6]", "[1, [0, 12e-6]", "error class"),
        ("[0, 0, 1, 0]", "[0, 0, -1, 0]", "reflection"),
        ("[0, 0, 1, 0]", "[0, 0, 2, 0]", "no rotation"),
        ("[0, 0, 1, 0]", "[0, 0, 0, 0]", "no rotation"),
        ("[0, 0, 0, 1]", "[0, 0, 0, 2]", "last row"),
    ] {
        let text = MOTION.replace(from, to);
        assert_ne!(text, MOTION);
        let (out, _, exit) = classify(&text, &[]);
        assert!(exit == 0 && out.starts_with("Not admissible") && out.contains(words), "{out}");
        let json: Value = serde_json::from_str(&classify(&text, &["--format", "json"]).0).unwrap();
        assert_eq!(json["admissible"], false);
    }
}

#[test]
fn what_is_no_matrix_is_refused() {
    for text in [
        "",
        "matrix: [[1]]",
        "matrix: 3",
        "real: [[1]]",
        "- x",
        "matrix: [[.nan, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
    ] {
        let (_, complaint, exit) = classify(text, &[]);
        assert!(exit == 1 && complaint.contains("E0815"), "{text}: {exit} {complaint}");
    }
}
