//! Curves that stop short of the travel: closed forms of what goes on, what is said of it, and what is refused.

use super::language::{read, silent};
use super::program::{Folder, abbe_on, text};
use abbe::diagnostic::{Rendering, render};
use abbe::{ConvertOptions, EvalOptions, LoadOptions, MachineFile, Run, convert, eval, loads};
use serde_json::Value;

/// A machine of three axes whose X travels from 0 to 500 mm, with these errors: the deviation along X is EXX.
fn machine(errors: &str) -> String {
    let axes = "axes:\n  X: { travel: [0 mm, 500 mm] }\n  Y: { travel: [0 mm, 100 mm] }\n";
    format!("abbe: 1\nmachine: One\nchain: \"w b X Y t\"\n{axes}{errors}\n")
}

fn with_curve(points: &str, rest: &str) -> String {
    machine(&format!("errors: {{ EXX: {{ points: [{points}]{rest} }} }}"))
}

const THREE: &str = "[10 mm, 1 um], [250 mm, 4 um], [480 mm, 2 um]";

fn loaded(file: &str) -> MachineFile {
    loads(file, &LoadOptions::default(), Run::default()).unwrap().value
}

/// Deviations along X (um) at positions of X (mm), with their expanded uncertainties where there are any.
fn along_x(machine: &MachineFile, positions: &[f64]) -> Vec<(f64, Option<f64>)> {
    let poses = positions.iter().map(|x| vec![*x, 7.0]).collect();
    let found = eval(machine, &EvalOptions { poses, ..EvalOptions::default() }, Run::default()).unwrap().value;
    let one =
        |pose: &abbe::results::PoseResult| (pose.deviation[0] * 1e3, pose.uncertainty.map(|u| u.deviation[0] * 1e3));
    found.poses.iter().map(one).collect()
}

fn values(file: &str, positions: &[f64]) -> Vec<f64> {
    along_x(&loaded(file), positions).into_iter().map(|found| found.0).collect()
}

fn near(found: &[f64], expected: &[f64]) {
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && off < 1e-9, "{found:?}, expected {expected:?}");
}

/// Codes and text of what is said of a file.
fn said(files: &[(&str, &str)]) -> (Vec<&'static str>, String) {
    let (_, diagnostics) = read(files);
    (diagnostics.iter().map(|d| d.code.id).collect(), render(&diagnostics, Rendering::default()))
}

#[test]
fn the_last_value_holds_or_the_last_slope_goes_on() {
    let at = [0.0, 10.0, 130.0, 480.0, 500.0];
    near(&values(&with_curve(THREE, ""), &at), &[1.0, 1.0, 2.5, 2.0, 2.0]);
    near(&values(&with_curve(THREE, ", beyond: hold"), &at), &[1.0, 1.0, 2.5, 2.0, 2.0]);
    let (first, last) = (3.0 / 240.0, -2.0 / 230.0);
    let straight = [1.0 - 10.0 * first, 1.0, 2.5, 2.0, 2.0 + 20.0 * last];
    near(&values(&with_curve(THREE, ", beyond: slope"), &at), &straight);
    // The natural spline through three points: its one second derivative in closed form.
    let bend = 6.0 * (last - first) / (2.0 * (240.0 + 230.0));
    let middle = 2.5 + (0.5 * 0.5 * 0.5 - 0.5) * bend * 240.0 * 240.0 / 6.0;
    let cubic = ", interpolation: cubic";
    near(&values(&with_curve(THREE, cubic), &at), &[1.0, 1.0, middle, 2.0, 2.0]);
    let (first, last) = (first - 240.0 * bend / 6.0, last + 230.0 * bend / 6.0);
    let spline = [1.0 - 10.0 * first, 1.0, middle, 2.0, 2.0 + 20.0 * last];
    near(&values(&with_curve(THREE, &format!("{cubic}, beyond: slope")), &at), &spline);
}

#[test]
fn curves_of_other_ranges_beside_it_change_nothing() {
    let pair = |own: &str| {
        machine(&format!(
            "errors:\n  EXX: {{ points: [{THREE}]{own} }}\n  EYX: {{ points: [[0, 1 um], [495, 2 um], [500, 3 um]] }}"
        ))
    };
    let at = [0.0, 3.0, 481.0, 495.0, 499.0];
    for own in ["", ", interpolation: cubic", ", beyond: slope", ", interpolation: cubic, beyond: slope"] {
        near(&values(&pair(own), &at), &values(&with_curve(THREE, own), &at));
    }
}

#[test]
fn both_directions_and_rotary_axes_go_on_too() {
    let points = |end: f64| format!("{{ points: [[10 mm, {end} um], [250 mm, 0 um], [480 mm, 0 um]] }}");
    let file = machine(&format!("errors: {{ EXX: {{ forward: {}, reverse: {} }} }}", points(1.0), points(2.0)));
    near(&values(&file, &[0.0]), &[1.5]);
    let rotary = |travel: &str, to: f64| {
        let head = "abbe: 1\nmachine: One\nchain: \"w b X C t\"\naxes:\n  X: { travel: [0 mm, 9 mm] }\n";
        let axis = format!("  C: {{ travel: {travel}, origin: [0, 0, 0] }}\n");
        let points = format!("[[-80, 1 um], [{to}, 1 um]]");
        format!("{head}{axis}errors: {{ EXC: {{ points: {points}, beyond: hold }} }}\n")
    };
    let _ = silent(&[("m.yaml", &rotary("[-90, 90]", 85.0))]);
    assert_eq!(said(&[("m.yaml", &rotary("continuous", 279.0))]).0, ["E0410"]);
}

#[test]
fn it_is_said_unless_the_file_says_it() {
    let table = "X [mm], EXX+ [um], EXX- [um], EZX [um]\n2.3, 0, 1, 3\n250, 4, 5, 5\n498.6, 9, 9, 1\n";
    let file = machine("errors: { EYX: { points: [[5, 0 um], [495, 0 um]] } }\nmeasured: [x.csv]");
    let (codes, words) = said(&[("m.yaml", &file), ("x.csv", table)]);
    assert_eq!(codes, ["W0412", "W0412"], "{words}");
    assert!(words.contains("`EXX`, `EZX` are given from 2.3 to 498.6 mm of a travel from 0 to 500 mm"), "{words}");
    assert!(words.contains("`EYX` is given from 5 to 495 mm of a travel from 0 to 500 mm: it holds"), "{words}");
    let stated = file.replace("[0 mm, 500 mm]", "[0 mm, 500 mm], beyond: hold");
    let machine = silent(&[("m.yaml", &stated), ("x.csv", table)]);
    assert_eq!(machine.measured_range(&machine.axes()[0].name), Some((5.0, 495.0)));
    // A curve is asked before its axis.
    let own = stated.replace("[495, 0 um]]", "[495, 0 um]], beyond: refuse");
    assert_eq!(said(&[("m.yaml", &own), ("x.csv", table)]).0, ["E0409"]);
}

#[test]
fn more_than_a_tenth_is_refused() {
    let from = |low: &str, high: &str, rest: &str| {
        said(&[("m.yaml", &with_curve(&format!("[{low}, 1 um], [{high}, 1 um]"), rest))]).0
    };
    let quiet: [&str; 0] = [];
    for beyond in ["hold", "slope"] {
        let rest = format!(", beyond: {beyond}");
        assert_eq!(from("40", "460", &rest), quiet);
        // 420 mm were measured: 42 mm go on.
        assert_eq!(from("42.1", "460", &rest), ["E0409"]);
        assert_eq!(from("0", "454.5", &rest), ["E0409"]);
        assert_eq!(from("0", "454.6", &rest), quiet);
    }
    assert_eq!(from("0", "499", ", beyond: refuse"), ["E0409"]);
    assert_eq!(from("0", "500", ", beyond: refuse"), quiet);
    assert_eq!(from("0", "500", ", beyond: extrapolate"), ["E0210"]);
    let one = said(&[("m.yaml", &with_curve("[250, 1 um]", ""))]);
    assert_eq!(one.0, ["E0409"], "{}", one.1);
    assert!(one.1.contains("at most 0 mm, a tenth, go on"), "{}", one.1);
    let spline = "bspline: { degree: 1, knots: [1, 500], coefficients: [1 um, 2 um] }";
    assert_eq!(said(&[("m.yaml", &machine(&format!("errors: {{ EXX: {{ {spline} }} }}")))]).0, ["E0409"]);
    for term in ["EXX: { value: 2 um, beyond: hold }", "EXX: { tolerance: 2 um, beyond: hold }"] {
        assert_eq!(said(&[("m.yaml", &machine(&format!("errors: {{ {term} }}")))]).0, ["E0209"], "{term}");
    }
    let two = "EXX: { beyond: hold, forward: 1 um, reverse: 2 um }";
    assert_eq!(said(&[("m.yaml", &machine(&format!("errors: {{ {two} }}")))]).0, ["E0209"]);
    assert_eq!(said(&[("m.yaml", &machine("errors: { EB0X: { value: 2 urad, beyond: hold } }"))]).0, ["E0408"]);
}

#[test]
fn beyond_the_travel_nothing_goes_on() {
    let machine = loaded(&with_curve(THREE, ""));
    let at =
        |x: f64| eval(&machine, &EvalOptions { poses: vec![vec![x, 0.0]], ..EvalOptions::default() }, Run::default());
    assert!(at(500.0).is_ok());
    let refusal = at(501.0).unwrap_err();
    assert_eq!(refusal.iter().map(|d| d.code.id).collect::<Vec<_>>(), ["E0803"]);
}

/// A curve may go on as steeply as between its points: 4 um over 240 mm, with a rectangular distribution.
#[test]
fn intervals_widen_beyond() {
    let steepest = 3.0 / 240.0;
    for beyond in ["hold", "slope"] {
        let file = loaded(&with_curve(THREE, &format!(", uncertainty: 0.6 um, beyond: {beyond}")));
        let found: Vec<f64> = along_x(&file, &[0.0, 10.0, 250.0, 500.0]).iter().map(|of| of.1.unwrap()).collect();
        let at = |gap: f64| 2.0 * (0.09 + (steepest * gap) * (steepest * gap) / 3.0_f64).sqrt();
        near(&found, &[at(10.0), 0.6, 0.6, at(20.0)]);
    }
    // Without uncertainties there is nothing to widen.
    assert!(along_x(&loaded(&with_curve(THREE, "")), &[0.0])[0].1.is_none());
}

#[test]
fn a_written_machine_is_the_same() {
    for rest in ["hold", "slope", "hold, interpolation: cubic", "slope, interpolation: cubic"] {
        let machine = loaded(&with_curve(THREE, &format!(", beyond: {rest}")));
        let options = ConvertOptions { to: Some("carried_body".to_owned()), ..ConvertOptions::default() };
        let written = convert(&machine, &options, Run::default()).unwrap().value.machine_file;
        let again = loads(&written, &LoadOptions::default(), Run::default()).unwrap();
        assert_eq!(again.warnings.count(), 0, "{written}");
        let at = [0.0, 5.0, 10.0, 200.0, 480.0, 490.0, 500.0];
        let [before, after] = [&machine, &again.value].map(|machine| along_x(machine, &at));
        assert_eq!(before, after, "{written}");
        let range = |machine: &MachineFile| machine.measured_range(&machine.axes()[0].name);
        assert_eq!((range(&machine), range(&again.value)), (Some((10.0, 480.0)), Some((10.0, 480.0))));
    }
}

/// From 0 to 4 um where it is measured, from 50 to 450 mm, and on to -0.4 and 4.4 um.
const RAMP: &str = "\
abbe: 1
machine: Ramp
chain: \"w b X Y Z t\"
axes:
  X: { travel: [10 mm, 490 mm], home: 10, beyond: slope }
  Y: { travel: [0 mm, 100 mm], home: 0 }
  Z: { travel: [0 mm, 100 mm], home: 0 }
errors: { EXX: { points: [[50 mm, 0 um], [450 mm, 4 um]], uncertainty: 0.2 um } }
";

#[test]
fn certificates_judge_what_was_measured_and_state_the_rest_apart() {
    let folder = Folder::new("short-curves");
    let (machine, out) = (folder.with("ramp.yaml", RAMP), folder.file("out"));
    let arguments = ["compile", text(&machine), "--target", "grid-csv", "--out", text(&out)];
    let run = |more: &[&str]| {
        let output = abbe_on(2, &[&arguments[..], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let report: Value = serde_json::from_str(&run(&["--format", "json"])).unwrap();
    let beyond = &report["beyond_measured"];
    let largest = |of: &Value| of["uncompensated"]["position_um"]["max"].as_f64().unwrap();
    assert!((3.98..=4.0 + 1e-9).contains(&largest(&report)), "{}", largest(&report));
    assert!((4.38..=4.4 + 1e-9).contains(&largest(beyond)), "{}", largest(beyond));
    // Half of the poses are at either end: the mean of 0 to 0.4 and of 4 to 4.4 um.
    let mean = beyond["uncompensated"]["position_um"]["mean"].as_f64().unwrap();
    assert!((mean - 2.2).abs() < 0.1, "{mean}");
    assert!(beyond["compensated"]["position_um"]["max"].as_f64().unwrap() < 0.01, "{beyond}");
    assert_eq!((&beyond["poses"], &beyond["measured"]["X"]), (&2000.into(), &serde_json::json!([50.0, 450.0])));
    let words = run(&[]);
    assert!(words.contains("2000 poses spread over the measured part of the volume"), "{words}");
    assert!(words.contains("Measured: X from 50 to 450. At 2000 poses beyond"), "{words}");
    let checked = String::from_utf8(abbe_on(2, &["check", text(&machine)]).stdout).unwrap();
    assert!(checked.contains("measured X from 50 to 450; beyond, curves go on unmeasured"), "{checked}");
    let json: Value =
        serde_json::from_slice(&abbe_on(2, &["check", text(&machine), "--format", "json"]).stdout).unwrap();
    assert_eq!(json["axes"][0]["measured"], serde_json::json!([50.0, 450.0]));
    assert!(json["axes"][1].get("measured").is_none(), "{json}");
    let map: Value = serde_json::from_slice(&abbe_on(2, &["map", text(&machine), "--format", "json"]).stdout).unwrap();
    assert_eq!(map["beyond_measured"]["measured"]["X"], serde_json::json!([50.0, 450.0]));
}
