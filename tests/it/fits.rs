//! Fits that would run away are refused, and every fit says what it is worth over the volume.

use super::identify::{FIVE, deviation, five, five_poses, json, normal, run};
use super::oracle::program::Folder;
use super::oracle::random::Random;
use std::path::Path;
use std::process::Output;

const THREE: &str = "abbe: 1\nmachine: Three\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 400 mm], origin: [0, 0, 0] }\n  Z: { travel: [-300 mm, 0 mm], origin: [0, 0, 0] }\n";

pub fn identify(machine: &Path, data: &Path, options: &[&str]) -> Output {
    let base = ["identify", machine.to_str().unwrap(), "--data", data.to_str().unwrap()];
    run(&[&base[..], options].concat())
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Poses in which the tool point of the nominal machine is in one place, for all angles: the linear axes of the
/// machine have unit directions.
fn around(place: [f64; 3], angles: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<f64>> {
    let blank = five("");
    let point = |pose: &[f64]| abbe::lower::NominalPose::at(&blank, pose).pose.translation;
    let one = |(c, a): (f64, f64)| {
        let mut pose = vec![c, a, 225.0, 250.0, -100.0];
        for _ in 0..3 {
            let here = point(&pose);
            let column = |i: usize| {
                let mut moved = pose.clone();
                moved[i] += 1.0;
                point(&moved) - here
            };
            let jacobian = nalgebra::Matrix3::from_columns(&[column(3), column(2), column(4)]);
            let step = jacobian.try_inverse().unwrap() * (nalgebra::Vector3::from(place) - here);
            (pose[3], pose[2], pose[4]) = (pose[3] + step.x, pose[2] + step.y, pose[4] + step.z);
        }
        pose
    };
    angles.map(one).collect()
}

/// Axes as they stand when a probe has found balls that are fixed to the table.
fn balls(random: &mut Random, places: &[[f64; 3]]) -> String {
    let mut text = "C,A,Y,X,Z,ball\n".to_owned();
    for (b, place) in places.iter().enumerate() {
        let angles = (0..12).map(|i| (30.0 * f64::from(i), -10.0 * f64::from(i % 4) + 5.0));
        for mut pose in around(*place, angles) {
            (2..5).for_each(|i| pose[i] += 1e-3 * normal(random));
            let cells: Vec<String> = pose.iter().map(f64::to_string).collect();
            text += &format!("{},b{b}\n", cells.join(","));
        }
    }
    text
}

const PLACES: [[f64; 3]; 3] = [[60.0, 20.0, 100.0], [-70.0, 50.0, 130.0], [10.0, -80.0, 160.0]];

#[test]
fn balls_that_hold_no_length_are_refused_by_name() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let text = balls(&mut Random::new(311), &PLACES);
    let data = folder.write("balls.csv", &text);
    let fit = ["--fit", "tool,EXX:poly1,EYY:poly1,EZZ:poly1"];
    let output = identify(&machine, &data, &fit);
    let words = said(&output);
    assert_eq!(output.status.code(), Some(1), "{words}");
    let named = ["E0514", "grows or shrinks", "EXX:x^1", "EYY:x^1", "EZZ:x^1", "tool.Z", "length [mm]"];
    assert!(named.iter().all(|word| words.contains(word)), "{words}");
    // One of them held, or a laser along an axis beside the balls, and there is nothing left to refuse.
    let output = identify(&machine, &data, &[&fit[..], &["--fixed", "EXX:x^1"]].concat());
    assert!(output.status.success(), "{}", said(&output));
    let laser = folder.write("laser.csv", "X,EXX [um]\n0,0.1\n100,-0.2\n200,0.1\n300,0\n400,0.2\n500,-0.1\n");
    let report = json(&run(&[
        "identify",
        machine.to_str().unwrap(),
        "--data",
        data.to_str().unwrap(),
        laser.to_str().unwrap(),
        "--fit",
        "tool,EXX:poly1,EYY:poly1,EZZ:poly1",
        "--format",
        "json",
    ]));
    let scale = report["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "EZZ:x^1").unwrap().clone();
    assert!(scale["value"].as_f64().unwrap().abs() < 100.0, "{scale}");
    // Location errors alone stretch nothing.
    let output = identify(&machine, &data, &["--fit", "EC0Y,EB0Z,EA0Z,EX0C,EY0C,EA0C,EB0C,EY0A,EZ0A,EB0A,EC0A"]);
    assert!(output.status.success(), "{}", said(&output));
}

/// A regular grid of few planes: what lies between them is free.
fn planes(random: &mut Random, curve: impl Fn(f64) -> f64) -> String {
    let mut text = "X,Y,Z,dx [um],dy [um],dz [um]\n".to_owned();
    for i in 0..6 {
        for j in 0..3 {
            for k in 0..3 {
                let (x, y, z) = (100.0 * f64::from(i), 200.0 * f64::from(j), -150.0 * f64::from(k));
                let noise: Vec<f64> = (0..3).map(|_| 0.4 * normal(random)).collect();
                text += &format!("{x},{y},{z},{},{},{}\n", curve(x) + noise[0], noise[1], noise[2]);
            }
        }
    }
    text
}

#[test]
fn a_file_whose_prediction_is_not_held_is_not_written() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", THREE);
    let data = folder.write("grid.csv", &planes(&mut Random::new(312), |x| 10.0 * (x / 120.0).sin()));
    let out = folder.path("fitted.yaml");
    let write = |form: &str, more: &[&str]| {
        identify(&machine, &data, &[&["--fit", form, "--out", out.to_str().unwrap()], more].concat())
    };
    let output = write("EXX:bspline12", &[]);
    let words = said(&output);
    assert!(output.status.code() == Some(1) && !out.exists(), "{words}");
    assert!(["E0515", "EXX", "--accept undetermined"].iter().all(|word| words.contains(word)), "{words}");
    let output = write("EXX:bspline12", &["--accept-undetermined"]);
    assert!(output.status.success() && out.exists(), "{}", said(&output));
    std::fs::remove_file(&out).unwrap();
    let output = write("EXX:bspline3", &[]);
    assert!(output.status.success() && out.exists(), "{}", said(&output));
    let report = json(&identify(&machine, &data, &["--fit", "EXX:bspline12", "--format", "json"]));
    let prediction = &report["prediction"];
    assert!(prediction["infinite"] == true && prediction["held"] == false, "{prediction}");
    assert!(prediction["largest_um"].is_null() && prediction["combination"].as_str().unwrap().contains("EXX"));
    let text = identify(&machine, &data, &["--fit", "EXX:bspline12"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("prediction u is infinite"));
}

/// EXX = s x: the best rigid motion takes off its mean, and s (x - 250 mm) is left; the mean of the poses looked at is
/// some millimetres off the middle.
#[test]
fn the_uncertainty_over_the_volume_is_that_of_the_curve_less_a_rigid_motion() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", THREE);
    let data = folder.write("grid.csv", &planes(&mut Random::new(313), |x| 0.02 * x));
    let options = ["--fit", "EXX:poly1", "--format", "json"];
    let report = json(&identify(&machine, &data, &options));
    let prediction = &report["prediction"];
    let parameter =
        |name: &str| report["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap().clone();
    let (value, sigma) =
        (parameter("EXX:x^1")["value"].as_f64().unwrap(), parameter("EXX:x^1")["sigma"].as_f64().unwrap());
    let largest = prediction["largest_um"].as_f64().unwrap();
    let forms = report["lack_of_fit"]["forms"].as_array().unwrap();
    let form: f64 = forms.iter().map(|form| form["size_um"].as_f64().unwrap().powi(2)).sum();
    let expected = ((sigma * 0.25).powi(2) + form).sqrt();
    assert!((largest / expected - 1.0).abs() < 0.04, "{largest} {sigma}");
    assert!((prediction["deviation_um"].as_f64().unwrap() / (value * 0.25) - 1.0).abs() < 0.04, "{prediction}");
    assert!([0.0, 500.0].contains(&prediction["at"]["X"].as_f64().unwrap()), "{prediction}");
    assert!(prediction["held"] == true && prediction["infinite"] == false);
    // The set-up turns and moves the whole: it changes no prediction.
    let report =
        json(&identify(&machine, &data, &["--fit", "EXX:poly1,workpiece,EYY:poly1,EZZ:poly1", "--format", "json"]));
    assert_eq!(report["rank"], report["unknowns"], "{report}");
    assert!(report["prediction"]["infinite"] == false, "{}", report["prediction"]);
}

/// A curve that is measured on a part of its travel, and beyond it is as uncertain as is plausible.
#[test]
fn curves_beyond_what_was_measured_are_not_written() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", THREE);
    let mut random = Random::new(314);
    let rows: String = (0..40).map(|i| format!("{},{}\n", 0.5 * f64::from(i), 0.3 * normal(&mut random))).collect();
    let data = folder.write("short.csv", &format!("X,EXX [um]\n{rows}"));
    let out = folder.path("fitted.yaml");
    let output = identify(&machine, &data, &["--fit", "EXX:poly3", "--out", out.to_str().unwrap()]);
    let words = said(&output);
    assert!(output.status.code() == Some(1) && !out.exists(), "{words}");
    assert!(words.contains("E0515") && words.contains("at X = 500 mm, Y = 400 mm"), "{words}");
    assert!(words.contains("X was measured from 0 to 19.5 of 0 to 500 mm"), "{words}");
}

/// Location errors of 15 mm and 50 mrad, as robots out of the box have them, with 0.05 mm of noise.
#[test]
fn a_machine_with_large_errors_reaches_the_optimum_and_is_written() {
    let folder = Folder::new();
    let large = "identify: { plausible: { length: 60 mm, angle: 300 mrad } }\nerrors: { EC0Y: 40 mrad, EB0Z: -50 mrad, EA0Z: 30 mrad, EX0C: 15 mm, EY0C: -12 mm, EA0C: 45 mrad, EB0C: -35 mrad, EY0A: 14 mm, EZ0A: -15 mm, EB0A: 50 mrad, EC0A: 20 mrad }\n";
    let truth = five(large);
    let machine = folder.write("machine.yaml", FIVE);
    let names = ["EC0Y", "EB0Z", "EA0Z", "EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A"];
    let known = [40e3, -50e3, 30e3, 15e3, -12e3, 45e3, -35e3, 14e3, -15e3, 50e3, 20e3];
    let mut random = Random::new(315);
    let poses = five_poses(&mut random, 60);
    let (mut squares, mut sums, mut draws) = (0.0, 0.0, 0.0);
    let out = folder.path("fitted.yaml");
    for _ in 0..12 {
        let mut text = "C,A,Y,X,Z,dx [um],dy [um],dz [um]\n".to_owned();
        for pose in &poses {
            let read = deviation(&truth, pose).map(|d| (d * 1e3 + 50.0 * normal(&mut random)).to_string());
            let cells: Vec<String> = pose.iter().map(f64::to_string).collect();
            text += &format!("{},{}\n", cells.join(","), read.join(","));
        }
        let data = folder.write("data.csv", &text);
        let fit = names.join(",");
        let report =
            json(&identify(&machine, &data, &["--fit", &fit, "--out", out.to_str().unwrap(), "--format", "json"]));
        sums += report["rms_um"]["after"].as_f64().unwrap().powi(2);
        for (parameter, known) in report["parameters"].as_array().unwrap().iter().zip(known) {
            let off = parameter["value"].as_f64().unwrap() - known;
            squares += (off / parameter["sigma"].as_f64().unwrap()).powi(2);
            draws += 1.0;
        }
    }
    // 180 readings less 11 unknowns.
    let expected = 3.0 * 50.0 * 50.0 * 169.0 / 180.0;
    assert!((sums / 12.0 / expected - 1.0).abs() < 0.06, "{} {expected}", sums / 12.0);
    assert!((0.75..1.3).contains(&(squares / draws)), "bias and sigma: {}", squares / draws);
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(written.contains("plausible"), "{written}");
    assert!(run(&["check", out.to_str().unwrap()]).status.success());
    let refused = five_refused(&large.replace("60 mm", "12 mm"));
    assert!(refused.contains("E0412") && refused.contains("12 mm"), "{refused}");
}

/// Y lies 600 mrad off its direction, as where data and file mean different directions: printed, but not as a machine.
#[test]
fn values_of_no_machine_are_named_and_not_written() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", THREE);
    let (sin, cos) = 0.6_f64.sin_cos();
    let row = |y: f64| format!("0,{y},0,{},{},0\n", -1e3 * y * sin, 1e3 * y * (cos - 1.0));
    let rows: String = (0..9).map(|i| row(50.0 * f64::from(i))).collect();
    let data = folder.write("data.csv", &format!("X,Y,Z,dx [um],dy [um],dz [um]\n{rows}"));
    let printed = identify(&machine, &data, &["--fit", "EC0Y", "--format", "json"]);
    let value = json(&printed)["parameters"][0]["value"].as_f64().unwrap();
    assert!((value - 600e3).abs() < 1e-3, "{value}");
    let words = said(&printed);
    assert!(words.contains("W0512") && words.contains("`errors.EC0Y` reaches 600 mrad"), "{words}");
    let out = folder.path("fitted.yaml");
    let written = identify(&machine, &data, &["--fit", "EC0Y", "--out", out.to_str().unwrap()]);
    assert!(written.status.code() == Some(1) && !out.exists());
    assert!(said(&written).contains("E0504") && !said(&written).contains("W0512"), "{}", said(&written));
}

fn five_refused(errors: &str) -> String {
    let folder = Folder::new();
    let file = folder.write("machine.yaml", &format!("{FIVE}{errors}"));
    said(&run(&["check", file.to_str().unwrap()]))
}
