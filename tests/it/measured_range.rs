//! Curves that were measured over a part of the travel: what is said of the rest, and what `--range measured` writes.

use super::program::{Folder, abbe_on, refused, text};
use abbe::options::{FitRange, MapPoses};
use abbe::{EvalOptions, IdentifyOptions, LoadOptions, MapOptions, Run, eval, identify, loads, map};
use serde_json::{Value, json};

const ONE: &str = "abbe: 1\nmachine: One\nchain: \"w b X Y t\"\naxes:\n  X: { travel: [0 mm, 754 mm] }\n  Y: { travel: [0 mm, 100 mm] }\n";

/// Readings of X from 300 to 450, noise and an offset.
fn readings() -> String {
    let noise = [0.6, -0.9, 0.4, 0.8, -0.7, -0.5, 0.9, -0.2, -0.8, 0.5, 0.3, -0.4];
    let row = |(i, e): (usize, &f64)| format!("{},{},{}\n", 300.0 + 150.0 * i as f64 / 11.0, 9 * i, e + 2.0);
    "X,Y,dx [um]\n".to_owned() + &noise.iter().enumerate().map(row).collect::<String>()
}

#[test]
fn a_curve_is_judged_where_it_was_measured() {
    let folder = Folder::new("measured-range");
    let (machine, data) = (folder.with("one.yaml", ONE), folder.with("one.csv", &readings()));
    let out = folder.file("fitted.yaml");
    let arguments = ["identify", text(&machine), "--fit", "EXX:poly4", "--data", text(&data), "--out", text(&out)];
    let (_, said) = refused(&arguments);
    assert!(said.contains("E0515") && said.contains("X was measured from 300 to 450 of 0 to 754 mm"), "{said}");
    assert!(said.contains("--range measured") && !out.exists(), "{said}");
    let answer = |arguments: &[&str]| -> Value {
        let run = abbe_on(2, &[arguments, &["--format", "json"]].concat());
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        serde_json::from_slice(&run.stdout).unwrap()
    };
    // Where the polynomial is fitted, noise of 0.7 um says no more than some um; beyond it says 1.2 mm.
    let report = answer(&[&arguments[..], &["--range", "measured"]].concat());
    assert!(report["errors"][0]["sigma"].as_f64().unwrap() < 2.0, "{}", report["errors"]);
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(written.contains("  X: { range: [300, 450], step: 25 }"), "{written}");
    let at = |x: &str| answer(&["eval", text(&out), "--at", x])["poses"][0]["beyond_measured"].clone();
    assert_eq!((at("X=300"), at("X=450.1"), at("X=299,Y=5")), (json!(null), json!(["X"]), json!(["X"])));
    let words = String::from_utf8(abbe_on(2, &["eval", text(&out), "--at", "X=310", "--at", "X=0"]).stdout).unwrap();
    assert!(words.contains("Beyond what was measured: pose 2 (X)"), "{words}");
    let whole = answer(&["map", text(&out)]);
    assert!(whole["beyond_measured"].is_null() && whole["poses"] == 7 * 5, "{whole}");
}

/// A file that is written on the word of its user names what was measured, too.
#[test]
fn poses_beyond_are_counted() {
    let run = Run::default();
    let machine = loads(ONE, &LoadOptions::default(), run).unwrap().value;
    let options = IdentifyOptions {
        texts: vec![("one.csv".to_owned(), readings())],
        fit: vec!["EXX:poly3".to_owned()],
        machine_file: true,
        accept_undetermined: true,
        ..IdentifyOptions::default()
    };
    let file = |options: &IdentifyOptions| {
        let text = identify(&machine, options, run).unwrap().value.machine_file.unwrap();
        loads(&text, &LoadOptions::default(), run).unwrap().value
    };
    let fitted = file(&options);
    let poses: Vec<Vec<f64>> =
        (0..20).map(|i| vec![40.0 * f64::from(i), 0.0]).take_while(|pose| pose[0] <= 754.0).collect();
    let beyond = poses.iter().filter(|pose| !(300.0..=450.0).contains(&pose[0])).count();
    let options_of_map = MapOptions { poses: MapPoses::Listed(poses.clone()), ..MapOptions::default() };
    let found = map(&fitted, &options_of_map, run).unwrap().value.beyond_measured.unwrap();
    assert_eq!((found.poses, found.of), (beyond, poses.len()));
    assert_eq!(found.measured.into_iter().collect::<Vec<_>>(), [("X".to_owned(), [300.0, 450.0])]);
    // The volume that was measured has none beyond.
    let within = file(&IdentifyOptions { range: FitRange::Measured, ..options });
    assert!(map(&within, &MapOptions::default(), run).unwrap().value.beyond_measured.is_none());
    let none = eval(&machine, &EvalOptions { poses, ..EvalOptions::default() }, run).unwrap().value.poses;
    assert!(none.iter().all(|pose| pose.beyond_measured.is_empty()));
}
