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
        assert!(exit == 1 && out.starts_with("Not admissible") && out.contains(words), "{out}");
        let (out, complaint, exit) = classify(&text, &["--format", "json"]);
        let json: Value = serde_json::from_str(&out).unwrap();
        assert!(exit == 1 && json["admissible"] == false && json.get("diagnostics").is_none(), "{out} {complaint}");
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
    let (_, complaint, _) = classify("matrix: [[1, 0], [0, one]]", &[]);
    let complaint = complaint.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(complaint.contains("entry (2, 2) of `matrix` is `one`"), "{complaint}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(&classify(text, &["--format", "json"]).0).unwrap()
}

/// Sine and cosine of the angle phi + k i + m i^2 + n i^3, by the derivatives of a polynomial in i.
fn sine_cosine([phi, k, m, n]: [f64; 4]) -> [[f64; 4]; 2] {
    let (s, c) = libm::sincos(phi);
    // The square and the cube of k i + m i^2 + n i^3.
    let (two, three) = ([k * k, 2.0 * k * m], k * k * k);
    let sine = [s, c * k, c * m - s * two[0] / 2.0, c * n - s * two[1] / 2.0 - c * three / 6.0];
    let cosine = [c, -s * k, -s * m - c * two[0] / 2.0, -s * n - c * two[1] / 2.0 + s * three / 6.0];
    [sine, cosine]
}

fn entry(list: [f64; 4]) -> String {
    format!("[{}]", list.map(|x| format!("{x:e}")).join(", "))
}

#[test]
fn rotations_of_the_plane_are_angles_to_degree_three() {
    let angle = [0.5, 1e-3, -2e-4, 3e-5];
    let [s, c] = sine_cosine(angle);
    let text = format!("matrix: [[{}, {}], [{}, {}]]", entry(c), entry(s.map(|x| -x)), entry(s), entry(c));
    let json = json_of(&text);
    assert_eq!((json["admissible"].as_bool(), json["group"].as_str()), (Some(true), Some("SO(2, D_3)")), "{json}");
    for (degree, wanted) in angle.iter().enumerate().skip(1) {
        let w = number(&json["degrees"][degree - 1]["before"]["rotation"][1][0]);
        assert!((w - wanted).abs() < 1e-15, "{degree}: {w}");
    }
    // The print of 2015 has m = 0.
    let row = |word: &str| {
        json["lemmas"].as_array().unwrap().iter().find(|l| l["statement"].as_str().unwrap().contains(word))
    };
    assert_eq!(row("2015, SO(2, D_2)").unwrap()["holds"], false);
    assert_eq!(row("Lemma 3").unwrap()["holds"], true);
    assert_eq!(row("Lemma 4").unwrap()["holds"], true);
    let (out, _, exit) = classify(&text, &[]);
    assert!(exit == 0 && out.contains("28.6478898 deg") && out.contains("Error class I^A: dimension 1"), "{out}");
}

/// A turn of 1 about the first two axes of four, errors in the other plane: the product of two plane rotations.
#[test]
fn rotations_of_four_dimensions() {
    let [s, c] = sine_cosine([1.0, 0.0, 0.0, 0.0]);
    let [t, d] = sine_cosine([0.0, 2e-3, 5e-4, 0.0]);
    let text = format!(
        "kind: rotation\nmatrix: [[{c}, {ms}, 0, 0], [{s}, {c}, 0, 0], [0, 0, {d}, {mt}], [0, 0, {t}, {d}]]",
        c = entry(c),
        s = entry(s),
        ms = entry(s.map(|x| -x)),
        t = entry(t),
        mt = entry(t.map(|x| -x)),
        d = entry(d)
    );
    let json = json_of(&text);
    assert_eq!(json["group"], "SO(4, D_3)", "{json}");
    let w = |degree: usize| number(&json["degrees"][degree - 1]["before"]["rotation"][3][2]);
    assert!((w(1) - 2e-3).abs() < 1e-15 && (w(2) - 5e-4).abs() < 1e-15 && w(3).abs() < 1e-15);
    assert!((json["error_class"]["dimension"] == 6) && json["error_class"]["is_lie_algebra"] == false);
}

/// The class of E-bar: every matrix of the basis fulfils A^T B + B^T A = 0, they are independent, and none is
/// diag(M, -M) only.
#[test]
fn the_error_class_of_the_block_exchange() {
    let json = json_of("kind: rotation\nreal: [[0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0]]");
    let class = &json["error_class"];
    assert_eq!(class["is_lie_algebra"], true, "{json}");
    let matrices: Vec<nalgebra::Matrix4<f64>> = class["basis"]
        .as_array()
        .unwrap()
        .iter()
        .map(|b| nalgebra::Matrix4::from_fn(|i, j| number(&b[i][j])))
        .collect();
    let exchange = nalgebra::Matrix4::from_fn(|i, j| f64::from(u8::from((i + 2) % 4 == j)));
    for b in &matrices {
        let product = exchange.transpose() * b;
        assert_eq!((product + product.transpose()).amax(), 0.0, "{b}");
    }
    let flat = nalgebra::DMatrix::from_fn(16, matrices.len(), |i, k| matrices[k][i]);
    assert_eq!((matrices.len(), flat.rank(1e-9)), (6, 6));
    let row =
        json["lemmas"].as_array().unwrap().iter().find(|l| l["statement"].as_str().unwrap().contains("(15)")).unwrap();
    assert!(row["holds"] == false && row["reason"].as_str().unwrap().contains("skew"), "{row}");
    let reflected = json_of("real: [[0, 1], [1, 0]]");
    assert!(reflected["admissible"] == false && reflected["error_class"]["dimension"] == 1, "{reflected}");
}

/// A quarter of the printed second matrix of (27): it is of the rotation of the opposite sense.
#[test]
fn the_second_matrix_of_27_at_a_rotation_about_y() {
    let (s, c) = libm::sincos(0.3);
    let json = json_of(&format!("real: [[{c:e}, 0, {s:e}], [0, 1, 0], [{:e}, 0, {c:e}]]", -s));
    let row =
        json["lemmas"].as_array().unwrap().iter().find(|l| l["statement"].as_str().unwrap().contains("(27)")).unwrap();
    assert_eq!(row["holds"], false, "{row}");
    assert!(row["reason"].as_str().unwrap().ends_with("for the rotation of the opposite sense 0"), "{row}");
}

/// A linearised matrix 1 + i hat(w) is a rotation to degree 1 only.
#[test]
fn linearised_matrices_stop_at_degree_one() {
    let text = "matrix: [[1, [0, -0.01], 0], [[0, 0.01], 1, 0], [0, 0, [1, 0, 0]]]";
    let (out, _, exit) = classify(text, &[]);
    let out = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(exit == 1 && out.contains("of i^2: a linearised matrix is a rotation to degree 1 only"), "{out}");
}
