//! Machines that are only bounded: the readings of an acceptance test, and what a control could repair, against closed
//! forms and machines drawn once more here.

use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json};
use ::abbe::{CompareTargetsOptions, LoadOptions, Run, compare_targets, load};
use serde_json::Value;

const AXES: &str = "abbe: 1\nmachine: M\nchain: \"w X' b Y Z t\"\naxes:\n  X: { travel: [0 mm, 400 mm] }\n  \
    Y: { travel: [0 mm, 300 mm] }\n  Z: { travel: [0 mm, 200 mm] }\ntool: { gauge: [0, 0, 0] }\nerrors:\n";
const SQUARE: &str = "  EC0Y: { tolerance: 40 urad }\n  EA0Z: { tolerance: 30 urad }\n";

fn readings(folder: &Folder, errors: &str, instrument: &str) -> Vec<(String, f64, f64)> {
    let machine = folder.with("m.yaml", &format!("{AXES}{errors}"));
    let found = json(&["instrument", machine.to_str().unwrap(), instrument, "--format", "json", "--quiet"]);
    let number = |of: &Value| of.as_f64().unwrap();
    let one =
        |of: &Value| (of["name"].as_str().unwrap().to_owned(), number(&of["rss_um"]), number(&of["p95_um"]["value"]));
    found["bounds"]["readings"].as_array().unwrap().iter().map(one).collect()
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected, "{found} for {expected}");
}

/// A squareness e is a circular deviation of e R; along a diagonal of sides x, y, z two of them add e x y / d and
/// f y z / d, whose sum has a trapezoidal distribution.
#[test]
fn readings_of_two_squarenesses_are_their_closed_forms() {
    let folder = Folder::new("bounded-tests-square");
    let [xy, yz, zx] = <[_; 3]>::try_from(readings(&folder, SQUARE, "ball-bar")).unwrap();
    near(xy.2, 0.95 * 40.0 * 0.1, 0.02);
    near(yz.2, 0.95 * 30.0 * 0.1, 0.02);
    near(xy.1, xy.2, 1e-9);
    assert!(zx.2 < 1e-3, "{zx:?}");
    let [x, y, z] = [400.0_f64, 300.0, 200.0];
    let length = (x * x + y * y + z * z).sqrt();
    let (a, b) = (40e-3 * x * y / length, 30e-3 * y * z / length);
    let all = readings(&folder, SQUARE, "diagonals");
    assert_eq!(all.len(), 4);
    for (name, rss, p95) in all {
        near(p95, a + b - (0.2 * a * b).sqrt(), 0.03);
        near(rss, 0.95 * a.hypot(b), 0.02);
        assert!(name.len() == 3 && name.chars().all(|c| "pn".contains(c)), "{name}");
    }
    let text = abbe(&["instrument", folder.file("m.yaml").to_str().unwrap(), "ball-bar", "--quiet"]);
    assert!(text.contains("RSS, um") && !text.contains("0.00000"), "{text}");
}

/// The error function to 1.5e-7: Abramowitz and Stegun 7.1.26.
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let powers = [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let sum = powers.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    (1.0 - sum * (-x * x).exp()).copysign(x)
}

/// A curve that is uniformly distributed between its bounds at every position, drawn 20,000 times.
#[test]
fn a_bounded_curve_leads_to_the_range_along_a_diagonal() {
    let mut random = Random::new(7);
    let mut normal = || {
        let [u, v] = [random.unit(), random.unit()];
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    let norm = (1..=6).map(|k| 1.0 / f64::from(k * k)).sum::<f64>().sqrt();
    let mut ranges: Vec<f64> = (0..20_000)
        .map(|_| {
            let waves: Vec<[f64; 2]> = (0..6).map(|_| [normal(), normal()]).collect();
            let at = |i: usize| {
                let t = std::f64::consts::PI * i as f64 / 10.0;
                let wave = |(k, [a, b]): (usize, &[f64; 2])| {
                    let order = (k + 1) as f64;
                    (a * (order * t).cos() + b * (order * t).sin()) / (order * norm)
                };
                erf(waves.iter().enumerate().map(wave).sum::<f64>() / 2.0_f64.sqrt())
            };
            let values: Vec<f64> = (0..11).map(at).collect();
            values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
        })
        .collect();
    ranges.sort_by(f64::total_cmp);
    let cosine = 400.0 / (400.0_f64.powi(2) + 300.0_f64.powi(2) + 200.0_f64.powi(2)).sqrt();
    let expected = 8.0 * cosine * ranges[18_999];
    let folder = Folder::new("bounded-tests-curve");
    for (_, rss, p95) in readings(&folder, "  EXX: { tolerance: 8 um }\n", "diagonals") {
        near(p95, expected, 0.03);
        near(rss, p95, 1e-9);
    }
}

/// Factors of squareness take off all of a squareness; factors of scale take off what is none of theirs: nothing.
#[test]
fn a_control_repairs_what_its_kinds_are_of_drawn_machines() {
    let folder = Folder::new("bounded-tests-repair");
    let machine = folder.with("m.yaml", &format!("{AXES}{SQUARE}"));
    let file = load(&machine, &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let repaired = |target: &str| {
        let target = Some(target.to_owned());
        let options = CompareTargetsOptions { machines: 11, target, ..CompareTargetsOptions::default() };
        let found = compare_targets(&file, &options, Run::default()).unwrap().value;
        assert!(found.refused.is_empty() && found.targets.len() == 1, "{found:?}");
        found.targets[0].clone()
    };
    let [klipper, grbl] = ["klipper", "grbl"].map(repaired);
    let drawn = klipper.drawn.unwrap();
    assert!(drawn.machines == 11 && drawn.least > 0.99 && drawn.most <= 1.0, "{drawn:?}");
    let drawn = grbl.drawn.unwrap();
    assert!(drawn.least > -0.05 && drawn.median < 0.35 && drawn.least <= drawn.median, "{drawn:?}");
    // The deviation of a squareness of 40 urad at 300 mm, and of 30 urad at 200 mm.
    let (before, _) = klipper.deciding_um();
    assert!(before > 0.0 && before < 12.0 + 6.0, "{before}");
    let plain = compare_targets(&file, &CompareTargetsOptions::default(), Run::default()).unwrap().value;
    assert!(!plain.is_measured() && plain.targets.iter().all(|of| of.drawn.is_none()));
}
