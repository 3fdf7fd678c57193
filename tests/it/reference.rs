//! The reference of a job against closed forms, brute force and the rigid body of the oracle: what the set-up of a part
//! takes out of deviations, of sensitivities and of drawn machines.

use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::{V3, cross, minus, norm, plus};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Conventions, Frame};
use crate::oracle::{program, yaml};
use crate::program::{Folder, abbe, json, refused, text};
use abbe::options::{DatumPoint, MapPoses, Reference, ReferenceKind};
use abbe::{LoadOptions, MapOptions, Run};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Solves a linear system by elimination with pivots.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for k in 0..N {
        let pivot = (k..N).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            (0..N).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        let known: f64 = (k + 1..N).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

/// The rows of t + w x p by t and w.
fn rows_of(p: V3) -> [[f64; 6]; 3] {
    let unit = |k: usize| std::array::from_fn::<f64, 3, _>(|i| f64::from(u8::from(i == k)));
    let columns: [V3; 6] = std::array::from_fn(|k| if k < 3 { unit(k) } else { cross(unit(k - 3), p) });
    std::array::from_fn(|i| std::array::from_fn(|k| columns[k][i]))
}

/// The rigid motion with the least squares of what it leaves.
fn least_squares(points: &[(V3, V3)]) -> [f64; 6] {
    let (mut a, mut b) = ([[0.0; 6]; 6], [0.0; 6]);
    for (p, d) in points {
        for (row, value) in rows_of(*p).iter().zip(d) {
            for i in 0..6 {
                (0..6).for_each(|k| a[i][k] += row[i] * row[k]);
                b[i] += row[i] * value;
            }
        }
    }
    solve(a, b)
}

fn without(motion: &[f64; 6], p: V3, d: V3) -> V3 {
    let [x, y, z, a, b, c] = *motion;
    minus(d, plus([x, y, z], cross([a, b, c], p)))
}

#[test]
fn a_best_fit_is_the_least_squares_of_the_rigid_body() {
    let mut random = Random::new(40);
    for _ in 0..6 {
        // Of a micrometre, so that squares of errors do not count.
        let sample = Sample::random(&mut random, Conventions::default(), 1e-6);
        let (folder, poses) = (program::Folder::new(), sample.poses(&mut random, 30));
        let file = folder.write("m.yaml", &yaml::write(&sample, &folder));
        let answers: Vec<_> = poses.iter().map(|pose| sample.evaluate(pose, Travel::Mean, Frame::Workpiece)).collect();
        let points: Vec<(V3, V3)> = answers.iter().map(|of| (of.nominal, of.deviation)).collect();
        let motion = least_squares(&points);
        let left: Vec<f64> = points.iter().map(|(p, d)| norm(without(&motion, *p, *d)) * 1e3).collect();
        let turned = |of: V3| norm(minus(of, [motion[3], motion[4], motion[5]])) * 1e6;
        let turns = answers.iter().map(|of| turned(of.rotation)).fold(0.0, f64::max);
        let machine = abbe::load(&file, &LoadOptions::default(), Run::on_disk()).unwrap().value;
        let options = MapOptions {
            poses: MapPoses::Listed(poses),
            reference: Some(Reference::best_fit()),
            ..MapOptions::default()
        };
        let map = abbe::map(&machine, &options, Run::on_disk()).unwrap().value;
        let rms = (left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64).sqrt();
        let largest = left.iter().copied().fold(0.0, f64::max);
        for (found, truth) in
            [(map.position_um.max, largest), (map.position_um.rms, rms), (map.rotation_urad.max, turns)]
        {
            assert!((found - truth).abs() < 1e-4 * truth.max(0.1), "{found} {truth}");
        }
        assert!(largest > 0.05, "{largest}: nothing is left to compare");
    }
}

/// A five-axis machine with these lines.
fn five(folder: &Folder, name: &str, lines: &str) -> PathBuf {
    let text = format!(
        "abbe: 1\nmachine: M\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  Z: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         A: {{ travel: [-60 deg, 60 deg], origin: [0, 0, -40] }}\n  C: {{ travel: continuous, origin: [0, 0, -50] }}\n\
         workpiece: {{ origin: [20, 10, 0] }}\n{lines}\n"
    );
    folder.with(name, &text)
}

/// Tool poses on a hemisphere.
fn work(folder: &Folder) -> PathBuf {
    let mut random = Random::new(7);
    let mut rows = "X,Y,Z,I,J,K\n0,0,0,0,0,1\n".to_owned();
    for _ in 0..40 {
        let [x, y, z] = random.vector(80.0);
        let (tilt, turn) = (random.unit() * 0.9, random.around(3.0));
        let (i, j, k) = (tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos());
        rows += &format!("{x},{y},{z},{i},{j},{k}\n");
    }
    folder.with("work.csv", &rows)
}

/// Position (um) and rotation (urad) row by row.
fn deviations(machine: &Path, work: &Path, reference: &str) -> Vec<[f64; 6]> {
    let csv = abbe(&["map", text(machine), "--tool-poses", text(work), "--reference", reference, "--format", "csv"]);
    let mut lines = csv.lines();
    let first = lines.next().unwrap().split(',').position(|cell| cell == "dx [um]").unwrap();
    let row = |line: &str| -> [f64; 6] {
        let cells: Vec<f64> = line.split(',').skip(first).take(6).map(|cell| cell.parse().unwrap()).collect();
        cells.try_into().unwrap()
    };
    lines.map(row).collect()
}

fn largest(rows: &[[f64; 6]], first: usize) -> f64 {
    rows.iter().map(|row| norm([row[first], row[first + 1], row[first + 2]])).fold(0.0, f64::max)
}

#[test]
fn a_part_that_lies_elsewhere_is_no_error() {
    let folder = Folder::new("reference-setup");
    let work = work(&folder);
    let shifted = five(&folder, "shifted.yaml", "setup: { workpiece: { X: 300 um, Y: -200 um, Z: 100 um } }");
    assert!((largest(&deviations(&shifted, &work, "machine"), 0) - 374.165_738_7).abs() < 1e-4);
    for reference in ["zero", "zero:10,20,-5,0,0.5,0.8", "best-fit", "best-fit:minimum-zone"] {
        assert!(largest(&deviations(&shifted, &work, reference), 0) < 1e-7, "{reference}");
    }
    // A finite turn: half of its square would be 0.05 um on 80 mm.
    let turned = "setup: { workpiece: { A: 900 urad, B: -500 urad, C: 700 urad, X: 50 um } }";
    let turned = five(&folder, "turned.yaml", turned);
    for reference in ["best-fit", "best-fit:minimum-zone"] {
        let left = deviations(&turned, &work, reference);
        assert!(largest(&left, 0) < 1e-6 && largest(&left, 3) < 1e-6, "{} {}", largest(&left, 0), largest(&left, 3));
    }
    assert!(largest(&deviations(&turned, &work, "zero"), 0) > 50.0, "a zero takes no rotation out");
}

#[test]
fn a_zero_takes_out_the_deviation_at_its_point_and_nothing_else() {
    let folder = Folder::new("reference-zero");
    let work = work(&folder);
    let machine = five(
        &folder,
        "m.yaml",
        "errors: { EC0Y: 30 urad, EX0C: 12 um, EA0C: 15 urad, EZZ: { points: [[-300 mm, -9 um], [300 mm, 11 um]] } }\n\
         setup: { workpiece: { X: 20 um } }",
    );
    let [whole, left] = ["machine", "zero"].map(|reference| deviations(&machine, &work, reference));
    // The first row is the zero point.
    for (whole_row, left_row) in whole.iter().zip(&left) {
        for k in 0..6 {
            let truth = whole_row[k] - if k < 3 { whole[0][k] } else { 0.0 };
            assert!((left_row[k] - truth).abs() < 1e-6, "{left_row:?} {truth}");
        }
    }
    assert!(largest(&left, 0) > 5.0 && norm([whole[0][0], whole[0][1], whole[0][2]]) > 5.0);
    let bare = json(&["map", text(&machine), "--tool-poses", text(&work), "--format", "json"]);
    let over =
        serde_json::json!({"kind": "job", "reference": "zero", "path": false, "poses": 41, "reached": 41, "tool": ""});
    assert_eq!(bare["over"], over, "the default of tool poses");
    assert!((number(&bare["position_um"]["max"]) - largest(&left, 0)).abs() < 1e-6);
    let volume = json(&["map", text(&machine), "--random", "50", "--format", "json"]);
    assert_eq!((&volume["over"]["kind"], &volume["over"]["reference"]), (&"volume".into(), &"machine".into()));
    let said = abbe(&["map", text(&machine), "--tool-poses", text(&work)]);
    let head =
        "Over a job of 41 tool poses, 41 reached, single poses; reference: zero at (0, 0, 0) along (0, 0, 1); tool";
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(words.join(" ").contains(head) && said.lines().nth(2).is_some_and(|line| line.len() <= 80), "{said}");
}

#[test]
fn six_datum_points_have_no_deviation_along_their_normals() {
    let folder = Folder::new("reference-datum");
    let mut rows = "X,Y,Z\n".to_owned();
    let point = |point: [f64; 3], normal: [f64; 3]| DatumPoint { point, normal };
    let datum = vec![
        point([-80.0, -80.0, 0.0], [0.0, 0.0, 1.0]),
        point([80.0, -80.0, 0.0], [0.0, 0.0, 1.0]),
        point([0.0, 80.0, 0.0], [0.0, 0.0, 1.0]),
        point([-60.0, -80.0, -20.0], [0.0, -1.0, 0.0]),
        point([60.0, -80.0, -20.0], [0.0, -1.0, 0.0]),
        point([-80.0, 0.0, -20.0], [-1.0, 0.0, 0.0]),
    ];
    datum.iter().for_each(|at| rows += &at.point.map(|x| x.to_string()).join(",").replace('\n', ""));
    rows = datum.iter().fold("X,Y,Z\n".to_owned(), |sum, at| sum + &at.point.map(|x| x.to_string()).join(",") + "\n");
    let work = folder.with("datum.csv", &rows);
    let lines = "errors: { EC0Y: 300 urad, EA0Z: 200 urad, EZZ: { points: [[-300 mm, -90 um], [300 mm, 110 um]] } }\n\
                 setup: { workpiece: { C: 400 urad, X: 80 um } }";
    let machine = five(&folder, "m.yaml", lines);
    let file = abbe::load(&machine, &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let map = |datum: Vec<DatumPoint>| {
        let reference = Reference { kind: ReferenceKind::Datum, datum, ..Reference::default() };
        let (poses, worst) = (MapPoses::ToolPoses(work.clone()), 6);
        let options = MapOptions { poses, worst, reference: Some(reference), ..MapOptions::default() };
        abbe::map(&file, &options, Run::on_disk())
    };
    let found = map(datum.clone()).unwrap().value;
    for worst in &found.worst {
        let at = |axis: &str, offset: f64| worst.axes[axis] - offset;
        let place = [at("X", 20.0), at("Y", 10.0), at("Z", 0.0)];
        let of = datum.iter().find(|of| norm(minus(of.point, place)) < 1e-6).unwrap();
        let along: f64 = worst.deviation_um.iter().zip(of.normal).map(|(d, n)| d * n).sum();
        assert!(along.abs() < 1e-7, "{along} um along {:?}", of.normal);
    }
    assert!(found.position_um.max > 1.0, "{}", found.position_um.max);
    // What is taken out is a rigid motion: the linear one is 400 urad of the part and its neighbours to first order.
    let whole = deviations(&machine, &work, "machine");
    assert!(whole.iter().map(|row| norm([row[0], row[1], row[2]])).fold(0.0, f64::max) > 50.0);
    let mut line = datum.clone();
    line[2].point = [0.0, -80.0, 0.0];
    let refusal = map(line).unwrap_err();
    let said: Vec<String> = refusal.iter().map(|d| format!("{} {}", d.code.id, d.message)).collect();
    assert!(said[0].contains("E0850") && said[0].contains("hold 5 of the six"), "{said:?}");
    let few = map(datum[..5].to_vec()).unwrap_err();
    assert!(few.iter().any(|d| d.message.contains("there are 5")));
}

/// The correlation of a drawn curve between two positions of its travel, as fractions of it: six waves over half a
/// turn, weights 1/k^2, brought to a uniform distribution.
fn correlation(x: f64, y: f64) -> f64 {
    let total: f64 = (1..=6).map(|k| 1.0 / f64::from(k * k)).sum();
    let wave = |k: i32| (f64::from(k) * std::f64::consts::PI * (x - y)).cos() / f64::from(k * k);
    let normal = (1..=6).map(wave).sum::<f64>() / total;
    6.0 / std::f64::consts::PI * (0.5 * normal).asin()
}

#[test]
fn a_bounded_curve_counts_by_its_values_at_the_pose_and_at_the_zero() {
    let folder = Folder::new("reference-curve");
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: { X: { travel: [0, 640], origin: [0, 0, 0] }, Y: { travel: [0, 400], origin: [0, 0, 0] }, Z: { travel: [0, 400], origin: [0, 0, 0] } }\nerrors: { EXX: { tolerance: 10 um } }\n",
    );
    for (x, worst) in [(0.0, 0.0), (200.0, 20.0), (640.0, 20.0)] {
        let work = folder.with("one.csv", &format!("X,Y,Z\n{x},0,0\n"));
        let arguments =
            ["budget", text(&machine), "--tool-poses", text(&work), "--samples", "20000", "--format", "json"];
        let found = json(&arguments);
        let position = &found["position_um"];
        let rss = 10.0 * (2.0 - 2.0 * correlation(x / 640.0, 0.0)).sqrt();
        assert!((number(&position["worst_case"]) - worst).abs() < 1e-9, "{x}: {position}");
        assert!((number(&position["rss"]) - rss).abs() < 1e-6 * rss + 1e-9, "{x}: {position} {rss}");
        // The mean of the squares of the machines drawn is a third of the square of the RSS, by a normal number as the
        // difference of two uniform ones has no other simple law; so only an upper bound is stated of the 95 % value.
        assert!(number(&position["monte_carlo"]["p95"]) <= worst + 1e-9);
        let whole = json(&[&arguments[..], &["--reference", "machine"]].concat());
        assert!((number(&whole["position_um"]["rss"]) - 10.0).abs() < 1e-9);
    }
}

#[test]
fn drawn_machines_worst_case_and_rss_agree_without_the_motion() {
    use abbe::analysis::budget::{ActingErrors, Distribution, Draws, Request, Statistic, bounds, budget, classes};
    use abbe::analysis::reference::PartReference;
    use abbe::evaluate::random_poses;
    let machine = crate::configs::machine("trunnion.yaml");
    let class = classes().remove("production").unwrap();
    let bounds = bounds(&machine, Some(&class));
    let all = random_poses(&machine, 25, 3);
    let zero = PartReference::zero(&machine, all[0].clone());
    let fit = PartReference::best_fit(&machine, &all);
    for distribution in [Distribution::Uniform, Distribution::Triangular] {
        let draws = Draws::new(5, distribution);
        for reference in [None, Some(&zero), Some(&fit)] {
            for pose in &all[1..4] {
                let poses = std::slice::from_ref(pose);
                let (samples, statistic) = (4000, Statistic::Max);
                let request = Request {
                    acting: ActingErrors::None,
                    machine: &machine,
                    bounds: &bounds,
                    poses,
                    reference,
                    searched: false,
                    at: None,
                    draws: &draws,
                    samples,
                    statistic,
                };
                let found = budget(request, &|_| Ok(())).unwrap();
                for totals in [&found.position, &found.rotation] {
                    let squares = totals.drawn.iter().map(|x| x * x).sum::<f64>() / samples as f64;
                    let scaled = squares.sqrt() / distribution.deviation();
                    assert!((scaled / totals.rss - 1.0).abs() < 0.05, "{scaled} {}", totals.rss);
                    assert!(totals.sorted[samples - 1] <= totals.worst_case * (1.0 + 1e-9));
                    assert!(totals.worst_case >= totals.rss * 0.999);
                }
                // Tolerance times derivative, summed up, is the value (Euler).
                let parts: f64 = found.position.tighten.iter().map(|of| of.effect).sum();
                let p95 = found.position.percentile(95).value;
                assert!((parts / p95 - 1.0).abs() < 0.02, "{parts} {p95}");
            }
        }
    }
}

#[test]
fn bounds_of_the_table_that_are_rigid_motions_vanish() {
    let folder = Folder::new("reference-bounds");
    // At one position of the table its location errors are fixed to the part.
    let lines = "abbe: 1\nmachine: M\nchain: \"w C' b X Y Z t\"\naxes: { X: { travel: [-300, 300], origin: [0, 0, 0] }, Y: { travel: [-300, 300], origin: [0, 0, 0] }, Z: { travel: [-300, 300], origin: [0, 0, 0] }, C: { travel: [-10 deg, 10 deg], origin: [0, 0, 0] } }\nconventions: { location: carried_body }\nerrors: { EX0C: { tolerance: 20 um }, EA0C: { tolerance: 50 urad }, EB0C: { tolerance: 50 urad } }\n";
    let machine = folder.with("m.yaml", lines);
    let work = folder.with("work.csv", "X,Y,Z\n0,0,0\n100,0,0\n0,100,0\n50,-80,40\n-60,20,90\n");
    let of = |reference: &str| {
        let found = json(&[
            "budget",
            text(&machine),
            "--tool-poses",
            text(&work),
            "--reference",
            reference,
            "--format",
            "json",
        ]);
        ["worst_case", "rss"].map(|key| number(&found["position_um"][key]))
    };
    assert!(of("machine")[0] > 20.0);
    assert!(of("best-fit").iter().all(|um| *um < 1e-9), "{:?}", of("best-fit"));
}

#[test]
fn the_effect_of_a_bounded_location_error_is_the_map_of_that_error() {
    let folder = Folder::new("reference-one");
    let work = work(&folder);
    for error in ["EC0Y", "EA0Z", "EX0C", "EB0A", "EA0C"] {
        let size = if error == "EX0C" { "20 um" } else { "40 urad" };
        let value = five(&folder, "value.yaml", &format!("errors: {{ {error}: {size} }}"));
        let bound = five(&folder, "bound.yaml", &format!("errors: {{ {error}: {{ tolerance: {size} }} }}"));
        for reference in ["machine", "zero", "zero:20,30,-10,0,0.3,0.9", "best-fit"] {
            let of = |verb: &str, machine: &Path, more: &[&str]| {
                let fixed = [verb, text(machine), "--tool-poses", text(&work), "--reference", reference];
                json(&[&fixed[..], &["--format", "json"], more].concat())
            };
            let map = of("map", &value, &["--order", "1"]);
            let budget = of("budget", &bound, &["--samples", "40"]);
            for key in ["position_um", "rotation_urad"] {
                let (truth, found) = (number(&map[key]["max"]), &budget[key]);
                for figure in ["worst_case", "rss"] {
                    let found = number(&found[figure]);
                    assert!(
                        (found - truth).abs() < 1e-6 * truth.max(1.0),
                        "{error} {reference} {key}: {found} {truth}"
                    );
                }
            }
        }
    }
}

#[test]
fn compare_gives_a_verdict_only_where_both_references_agree() {
    let folder = Folder::new("reference-compare");
    // One has a large offset of the table and nothing else, the other small errors of form.
    let offset = five(&folder, "offset.yaml", "setup: { workpiece: { X: 40 um } }\nerrors: { EC0Y: 1 urad }");
    let form = five(&folder, "form.yaml", "errors: { EC0Y: 80 urad }");
    let arguments = ["compare", text(&offset), text(&form), "--poses", "60", "--format", "json"];
    let found = json(&arguments);
    assert_eq!((&found["over"]["kind"], &found["over"]["reference"]), (&"volume".into(), &"machine".into()));
    assert_eq!(found["best_fit"]["over"]["reference"], "best-fit");
    let p95 = |of: &Value| number(&of["position_um"]["p95"]);
    assert!(p95(&found["machines"][0]) > p95(&found["machines"][1]));
    assert!(p95(&found["best_fit"]["machines"][0]) < p95(&found["best_fit"]["machines"][1]));
    assert_eq!(found["verdicts"][0]["verdict"], Value::Null);
    assert_eq!(found["verdicts"][0]["reason"], "better in machine coordinates, worse with the best fit");
    let stated = json(&[&arguments[..], &["--reference", "best-fit"]].concat());
    assert_eq!((&stated["verdicts"][0]["verdict"], &stated["best_fit"]), (&"worse".into(), &Value::Null));
    assert!((p95(&stated["machines"][0]) - p95(&found["best_fit"]["machines"][0])).abs() < 1e-9);
    let said = abbe(&arguments[..5]);
    assert!(said.contains("Machine 2 against 1: no verdict: better in machine coordinates"), "{said}");
}

#[test]
fn the_command_line_states_what_files_state() {
    let folder = Folder::new("reference-text");
    let machine = five(
        &folder,
        "m.yaml",
        "errors: { EC0Y: 300 urad, EA0Z: 200 urad, EZZ: { points: [[-300 mm, -90 um], [300 mm, 110 um]] }, EX0C: 7 um }",
    );
    let work = work(&folder);
    let of = |arguments: &[&str]| {
        let found = json(&[&["map", text(&machine), "--format", "json"], arguments].concat());
        (found["position_um"].clone(), found["over"].clone())
    };
    for (words, mapping) in [
        (
            "datum:-80,-80,0,Z:80,-80,0,Z:0,80,0,0,0,2:-60,-80,-20,-Y:60,-80,-20,0,-1,0:-80,0,-20,-X",
            "{ kind: datum, datum: [{ point: [-80, -80, 0], normal: [0, 0, 1] }, { point: [80, -80, 0], normal: [0, 0, \
             1] }, { point: [0, 80, 0], normal: [0, 0, 1] }, { point: [-60, -80, -20], normal: [0, -1, 0] }, { point: \
             [60, -80, -20], normal: [0, -1, 0] }, { point: [-80, 0, -20], normal: [-1, 0, 0] }] }",
        ),
        (
            "zero:10,-20,5,0,0.3,0.9:about:Z:80,0,5",
            "{ kind: zero, point: [10, -20, 5], direction: [0, 0.3, 0.9], align: { about: [0, 0, 1], point: [80, 0, 5] } }",
        ),
        (
            "zero:10,0,0:rotary:A=20,C=-90:about:0,1,1:0,0,50",
            "{ kind: zero, point: [10, 0, 0], rotary: { A: 20, C: -90 }, align: { about: [0, 1, 1], point: [0, 0, 50] } }",
        ),
        ("best-fit:minimum-zone", "{ kind: best-fit, minimum_zone: true }"),
    ] {
        let job = folder.with("job.yaml", &format!("tool_poses: work.csv\nreference: {mapping}\n"));
        let as_text = folder.with("text.yaml", &format!("tool_poses: work.csv\nreference: {words}\n"));
        let line = of(&["--tool-poses", text(&work), "--reference", words]);
        assert_eq!(line, of(&["--job", text(&job)]), "{words}");
        assert_eq!(line, of(&["--job", text(&as_text)]), "{words}");
        assert_ne!(line.0, of(&["--tool-poses", text(&work)]).0, "{words}");
    }
    let unknown = ["map", text(&machine), "--tool-poses", text(&work), "--reference", "datum:0,0,0"];
    let (code, said) = refused(&unknown);
    assert!(code == 2 && said.contains("six points and their normals"), "{said}");
}

#[test]
fn machines_without_a_common_zero_have_no_verdict() {
    let folder = Folder::new("reference-apart");
    let machine = five(&folder, "m.yaml", "errors: { EC0Y: 30 urad }");
    let short = std::fs::read_to_string(&machine).unwrap().replace("X: { travel: [-300", "X: { travel: [30");
    let short = folder.with("short.yaml", &short.replace("30 urad", "60 urad"));
    let work = folder.with("work.csv", "X,Y,Z\n100,0,0\n80,10,0\n");
    let arguments = ["compare", text(&machine), text(&short), "--tool-poses", text(&work), "--format", "json"];
    let (code, said) = refused(&arguments);
    assert!(code == 0 && said.contains("W0850") && said.contains("below its travel"), "{said}");
    let stated = json(&[&arguments[..], &["--reference", "zero:100,0,0"]].concat());
    assert_eq!(stated["verdicts"][0]["verdict"], "worse");
    let (code, said) = refused(&[&arguments[..], &["--reference", "zero:0,0,0"]].concat());
    assert!(code == 1 && said.contains("E0850"), "{said}");
    let (code, said) = refused(&[&arguments[..], &["--reference", "origin"]].concat());
    assert!(code == 2 && said.contains("a reference is `machine`"), "{said}");
}

#[test]
fn a_goal_and_its_proof_are_without_the_motion() {
    let folder = Folder::new("reference-goal");
    let machine = five(&folder, "m.yaml", "class: production");
    let work = work(&folder);
    let goal = |reference: &str| {
        let arguments = ["budget", text(&machine), "--tool-poses", text(&work), "--goal", "25 um", "--samples", "2000"];
        json(&[&arguments[..], &["--reference", reference, "--format", "json"]].concat())
    };
    for reference in ["machine", "zero", "best-fit"] {
        let found = goal(reference);
        let (before, p95) =
            (number(&found["goal"]["before_um"]["value"]), number(&found["position_um"]["monte_carlo"]["p95"]));
        assert!((before / p95 - 1.0).abs() < 1e-9, "{reference}: {before} {p95}");
        assert!(
            (number(&found["goal"]["proof_um"]["value"]) / 25.0 - 1.0).abs() < 0.06,
            "{reference}: {}",
            found["goal"]
        );
    }
}

#[test]
fn a_job_is_its_tool_poses_where_the_part_lies() {
    let folder = Folder::new("reference-job");
    let machine = five(
        &folder,
        "m.yaml",
        "errors: { EC0Y: 60 urad, EB0C: 25 urad, EXX: { points: [[-300 mm, -9 um], [300 mm, 11 um]] } }",
    );
    std::fs::create_dir_all(folder.file("parts")).unwrap();
    // A point p of the part lies at (30, -20, 5) + Rz(90 deg) p: (x, y, z) goes to (30 - y, -20 + x, 5 + z).
    let part = [[10.0, 20.0, 3.0], [-40.0, 5.0, 8.0], [60.0, -30.0, 0.0]];
    let line = |[x, y, z]: V3| format!("{x},{y},{z},0.6,0,0.8\n");
    let placed = |[x, y, z]: V3| format!("{},{},{},0,0.6,0.8\n", 30.0 - y, -20.0 + x, 5.0 + z);
    let table = |of: &dyn Fn(V3) -> String| part.iter().fold("X,Y,Z,I,J,K\n".to_owned(), |sum, p| sum + &of(*p));
    folder.with("parts/part.csv", &table(&line));
    let bare = folder.with("bare.csv", &table(&placed));
    let job = |text: &str| {
        folder.with(
            "parts/job.yaml",
            &format!("tool_poses: part.csv\nplace: {{ origin: [30, -20, 5], rotation: [0, 0, 90] }}\n{text}"),
        )
    };
    let figures = |arguments: &[&str]| {
        let found = json(&[&["map", text(&machine), "--format", "json"], arguments].concat());
        ["max", "rms", "p95"].map(|key| number(&found["position_um"][key]))
    };
    let same = |a: [f64; 3], b: [f64; 3]| a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-6);
    let path = job("");
    let (job_path, bare_path) = (text(&path), text(&bare));
    // The part's origin lies at (30, -20, 5), its Z along that of the workpiece frame.
    let zero = figures(&["--tool-poses", bare_path, "--reference", "zero:30,-20,5"]);
    let by_job = figures(&["--job", job_path]);
    assert!(same(by_job, zero), "{by_job:?} {zero:?}");
    assert!(!same(zero, figures(&["--tool-poses", bare_path])));
    for reference in ["machine", "best-fit"] {
        let bare = figures(&["--tool-poses", bare_path, "--reference", reference]);
        assert!(same(figures(&["--job", job_path, "--reference", reference]), bare), "{reference}");
        let _ = job(&format!("reference: {reference}\n"));
        assert!(same(figures(&["--job", job_path]), bare), "{reference}");
    }
    let eval = json(&["eval", text(&machine), "--job", job_path, "--reference", "best-fit", "--format", "json"]);
    let largest = eval["poses"].as_array().unwrap().iter().map(|pose| {
        let [x, y, z] = [0, 1, 2].map(|k| number(&pose["deviation"][k]));
        norm([x, y, z]) * 1e3
    });
    let best = figures(&["--job", job_path, "--reference", "best-fit"]);
    assert!((largest.fold(0.0, f64::max) - best[0]).abs() < 1e-9, "{eval}");
    assert_eq!((&eval["over"]["reference"], &eval["over"]["reached"]), (&"best-fit".into(), &3.into()));
    // The point of the file is one of the part: (10, 20, 3) lies at (10, -10, 8).
    let _ = job("reference: { kind: zero, point: [10, 20, 3], direction: [0.6, 0, 0.8] }\n");
    let stated = figures(&["--tool-poses", bare_path, "--reference", "zero:10,-10,8,0,0.6,0.8"]);
    assert!(same(figures(&["--job", job_path]), stated));
    // Rotary axes in place of a direction; an alignment takes a rotation of the table out.
    let turned = five(&folder, "turned.yaml", "setup: { workpiece: { C: 300 urad, X: 20 um } }");
    let align = "reference: { kind: zero, rotary: { A: 0, C: 0 }, align: { about: [0, 0, 1], point: [60, 0, 0] } }\n";
    let _ = job(align);
    let left = json(&["map", text(&turned), "--job", job_path, "--format", "json"]);
    assert!(number(&left["position_um"]["max"]) < 1e-6, "{left}");
    for (fault, said, content) in [
        ("E0201", "tool_pose", "tool_pose: x.csv\n"),
        ("E0850", "there are 0", "tool_poses: part.csv\nreference: { kind: datum, datum: [] }\n"),
        ("E0202", "a reference is", "tool_poses: part.csv\nreference: table\n"),
        ("E0850", "no rotary axis", "tool_poses: part.csv\nreference: { kind: zero, rotary: { X: 1 } }\n"),
        ("E0851", "for the tool `long`", "tool_poses: part.csv\ntool: long\n"),
    ] {
        let path = folder.with("parts/bad.yaml", content);
        let (code, message) = refused(&["map", text(&machine), "--job", text(&path)]);
        assert!(code == 1 && message.contains(fault) && message.contains(said), "{content}: {message}");
    }
}
