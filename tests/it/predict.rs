//! How well a machine file predicts readings, without a fit: against an own model, an own least-squares set-up, and
//! campaigns of other machines.

use crate::program::{Folder, abbe, json, refused, text};
use nalgebra::{DMatrix, DVector, Vector3};
use serde_json::Value;
use std::path::{Path, PathBuf};

const SQUARENESS: f64 = 40e-6;
const SCALE: f64 = 0.05e-3;

fn machine(folder: &Folder, name: &str, factor: f64) -> PathBuf {
    let (square, scale) = (SQUARENESS * factor * 1e6, SCALE * factor * 1e6);
    let axes = ["X", "Y", "Z"].map(|axis| format!("  {axis}: {{ travel: [0, 400], origin: [0, 0, 0] }}\n")).concat();
    let errors = format!("{{ EC0Y: {square} urad, EZZ: {{ polynomial: [0 um, {scale} um/m] }} }}");
    folder.with(name, &format!("abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes:\n{axes}errors: {errors}\n"))
}

/// The poses of a campaign, mm.
fn poses() -> Vec<Vector3<f64>> {
    let at =
        |i: usize| Vector3::new((i * 37 % 41) as f64 * 9.0, (i * 23 % 43) as f64 * 9.0, (i * 31 % 37) as f64 * 10.0);
    (0..40).map(at).collect()
}

/// What the machine does at a pose, mm: to second order in errors of 1e-5 nothing else.
fn deviation(pose: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-SQUARENESS * pose.y, 0.0, SCALE * pose.z)
}

/// Numbers that look normal, of a standard deviation of 1: twelve of a generator less six.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }
}

/// Readings of a machine with this much of the errors, on a part that lies otherwise: deviations in um.
fn readings(amount: f64, noise_um: f64) -> Vec<Vector3<f64>> {
    let mut noise = Noise(7);
    let (place, turn) = (Vector3::new(0.02, -0.03, 0.05), Vector3::new(40e-6, -25e-6, 60e-6));
    let one =
        |pose: &Vector3<f64>| (deviation(pose) * amount + place + turn.cross(pose)) * 1e3 + noise.vector() * noise_um;
    poses().iter().map(one).collect()
}

fn table(folder: &Folder, name: &str, readings: &[Vector3<f64>]) -> PathBuf {
    let row = |(pose, d): (&Vector3<f64>, &Vector3<f64>)| {
        format!("{},{},{},{},{},{}\n", pose.x, pose.y, pose.z, d.x, d.y, d.z)
    };
    let rows: String = poses().iter().zip(readings).map(row).collect();
    folder.with(name, &format!("X,Y,Z,dx [um],dy [um],dz [um]\n{rows}"))
}

/// What six motions of the part leave of vectors by least squares, root mean square over the places.
fn left(vectors: &[Vector3<f64>]) -> f64 {
    let poses = poses();
    let entry = |i: usize, k: usize| {
        let axis = Vector3::ith(k % 3, 1.0);
        let moved = if k < 3 { axis } else { axis.cross(&(poses[i / 3] / 400.0)) };
        moved[i % 3]
    };
    let motions = DMatrix::from_fn(3 * poses.len(), 6, entry);
    let all = DVector::from_fn(3 * poses.len(), |i, _| vectors[i / 3][i % 3]);
    let step = motions.clone().svd(true, true).solve(&all, 1e-12).unwrap();
    ((all - motions * step).norm_squared() / poses.len() as f64).sqrt()
}

fn predict(machine: &Path, data: &Path) -> Value {
    json(&["identify", text(machine), "--predict", text(data), "--noise", "1 um", "--format", "json", "--quiet"])
}

#[test]
fn readings_are_predicted_less_the_set_up_and_nothing_is_fitted() {
    let folder = Folder::new("predict");
    let (file, found) = (machine(&folder, "m.yaml", 1.0), readings(1.0, 1.0));
    let of = predict(&file, &table(&folder, "good.csv", &found));
    let predicted: Vec<Vector3<f64>> = poses().iter().map(|pose| deviation(pose) * 1e3).collect();
    let residual: Vec<Vector3<f64>> = found.iter().zip(&predicted).map(|(a, b)| a - b).collect();
    let kind = &of["kinds"][0];
    for (key, expected) in [("measured", left(&found)), ("predicted", left(&predicted)), ("left", left(&residual))] {
        let own = kind[key].as_f64().unwrap();
        assert!((own - expected).abs() < 2e-3, "{key}: {own} for {expected}");
    }
    assert_eq!((&of["verdict"], &of["instead"], &kind["places"]), (&"within".into(), &Value::Null, &40.into()));
    assert_eq!(of["readings"].as_array().unwrap().len(), 120);
    let amount = of["errors_seen"]["amount"].as_f64().unwrap();
    let u = of["errors_seen"]["expanded_uncertainty"].as_f64().unwrap();
    assert!((amount - 1.0).abs() < 2.0 * u && u < 0.2, "{amount} ± {u}");
    // The turn by which the part lies is found: 60 urad about Z, but for the part of the squareness that looks like it.
    let said = abbe(&["identify", text(&file), "--predict", text(&folder.file("good.csv")), "--noise", "1 um"]);
    assert!(said.contains("um are left: within both uncertainties") && said.contains("counts as exact"), "{said}");
    let csv = abbe(&[
        "identify",
        text(&file),
        "--predict",
        text(&folder.file("good.csv")),
        "--noise",
        "1 um",
        "--format",
        "csv",
    ]);
    assert_eq!(csv.lines().count(), 121);
    let squares: f64 =
        csv.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse::<f64>().unwrap()).map(|x| x * x).sum();
    assert!(((squares / 40.0).sqrt() - left(&residual)).abs() < 2e-3);
}

#[test]
fn readings_of_other_machines_are_told_and_named() {
    let folder = Folder::new("predict-other");
    let file = machine(&folder, "m.yaml", 1.0);
    for (amount, verdict, instead) in [
        (1.0, "within", Value::Null),
        (0.0, "not-within", "nominal".into()),
        (-1.0, "not-within", "reversed".into()),
        (0.5, "not-within", "half".into()),
        (2.0, "not-within", Value::Null),
    ] {
        let of = predict(&file, &table(&folder, &format!("{amount}.csv"), &readings(amount, 1.0)));
        assert_eq!((&of["verdict"], &of["instead"]), (&verdict.into(), &instead), "{amount}: {}", of["words"]);
        let seen = of["errors_seen"]["amount"].as_f64().unwrap();
        assert!((seen - amount).abs() < 0.2, "{seen} for {amount}");
    }
    // A tenth of the scatter: the errors are too small for these readings.
    let small = machine(&folder, "small.yaml", 0.01);
    let of = predict(&small, &table(&folder, "small.csv", &readings(0.0, 1.0)));
    assert_eq!(of["verdict"], "cannot-tell", "{}", of["words"]);
}

#[test]
fn a_fit_predicts_the_readings_that_it_did_not_see() {
    let folder = Folder::new("predict-fit");
    let blank = machine(&folder, "blank.yaml", 0.0);
    let first = table(&folder, "first.csv", &readings(1.0, 1.0));
    let fitted = folder.file("fitted.yaml");
    let fit = ["identify", text(&blank), "--data", text(&first), "--fit", "EC0Y,EZZ:poly1,workpiece", "--out"];
    let _ = json(&[&fit[..], &[text(&fitted), "--format", "json", "--quiet"]].concat());
    let mut other = readings(1.0, 0.0);
    let mut noise = Noise(99);
    other.iter_mut().for_each(|reading| *reading += noise.vector());
    let of = predict(&fitted, &table(&folder, "second.csv", &other));
    assert_eq!((&of["verdict"], &of["has_predicted_uncertainty"]), (&"within".into(), &true.into()), "{}", of["words"]);
}

#[test]
fn predictions_refuse_what_they_cannot_judge() {
    let folder = Folder::new("predict-refused");
    let file = machine(&folder, "m.yaml", 1.0);
    let data = table(&folder, "d.csv", &readings(1.0, 1.0));
    let out = folder.file("out.yaml");
    let predicting = ["identify", text(&file), "--predict", text(&data)];
    let (exit, said) = refused(&predicting);
    assert!(exit == 2 && said.contains("nothing says how sure the readings are") && said.contains("--noise"), "{said}");
    for more in [&["--fit", "EC0Y"][..], &["--out", text(&out)], &["--plan", "3"], &["--data", text(&data)]] {
        let (exit, said) = refused(&[&predicting[..], more].concat());
        assert!(exit == 2 && said.contains("cannot be used with") && !out.exists(), "{more:?}: {said}");
    }
    let absent = folder.file("absent.csv");
    let (exit, said) = refused(&["identify", text(&file), "--predict", text(&absent)]);
    assert!(exit == 1 && said.contains("E0101"), "{said}");
    let wrong = folder.with("wrong.csv", "X,Y,Q,dx [um]\n1,2,3,4\n");
    let (exit, said) = refused(&["identify", text(&file), "--predict", text(&wrong), "--noise", "1 um"]);
    assert!(exit == 1 && said.contains("E0501"), "{said}");
    let (exit, said) = refused(&[&predicting[..], &[text(&data), "--noise", "1 um"]].concat());
    assert!(exit == 1 && said.contains("named twice") || said.contains("E0501"), "{said}");
}
