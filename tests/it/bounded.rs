//! Machines of which nothing is measured: what their bounds lead to in `map`, `compare` and `report`. The oracle is the
//! rigid-body model of these tests with the bounds written out once more here.

use crate::map_files::{array, doubles};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Axis, Conventions, Frame, Machine, State};
use crate::program::{Folder, abbe, abbe_on, json, refused, text, well_formed};
use crate::support::packed;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A five-axis machine with these bounds; the second tool side holds B, the table C.
const FILE: &str = "abbe: 1
machine: First hour
chain: w C' Y' b X Z B t
axes:
  X: { travel: [0, 500], origin: [250, 0, 400] }
  Y: { travel: [0, 400], origin: [0, 200, 0] }
  Z: { travel: [-300, 0], origin: [0, 0, 300] }
  B: { travel: [-100, 100], origin: [250, 200, 150] }
  C: { travel: continuous, origin: [250, 200, -350] }
tool: { gauge: [250, 200, 0], length: 120 mm }
workpiece: { origin: [250, 200, -350] }
volume: { X: { step: 250 mm }, Y: { step: 200 mm }, Z: { step: 150 mm }, B: { step: 100 deg }, C: { step: 120 deg } }
errors:
  EC0Y: { tolerance: 20 urad }
  EX0C: { tolerance: 12 um }
  EA0B: { tolerance: 15 urad }
  EXX: { tolerance: 4 um }
  EBX: { tolerance: 10 urad }
  EYZ: { tolerance: 3 um }
  EAZ: { tolerance: 8 urad }
  ECC: { tolerance: 25 urad }
  EZB: { tolerance: 5 um }
";

/// The bounds of the file: axis of the walk, true for a location error, component X Y Z A B C, mm or rad.
const BOUNDS: [(usize, bool, usize, f64); 9] = [
    (1, true, 5, 20e-6),
    (0, true, 0, 12e-3),
    (4, true, 3, 15e-6),
    (2, false, 0, 4e-3),
    (2, false, 4, 10e-6),
    (3, false, 1, 3e-3),
    (3, false, 3, 8e-6),
    (0, false, 5, 25e-6),
    (4, false, 2, 5e-3),
];

/// Axes in the order of the walk from the workpiece.
const WALK: [&str; 5] = ["C", "Y", "X", "Z", "B"];

fn oracle() -> Machine {
    let axis = |name: &str, origin: [f64; 3]| {
        let letter = "XYZABC".find(name).unwrap();
        Axis {
            name: name.to_owned(),
            rotary: letter > 2,
            workpiece: name == "C" || name == "Y",
            direct: None,
            direction: std::array::from_fn(|k| f64::from(u8::from(letter % 3 == k))),
            origin,
            location: [0.0; 6],
        }
    };
    Machine {
        conventions: Conventions::default(),
        walk: vec![
            axis("C", [250.0, 200.0, -350.0]),
            axis("Y", [0.0, 200.0, 0.0]),
            axis("X", [250.0, 0.0, 400.0]),
            axis("Z", [0.0, 0.0, 300.0]),
            axis("B", [250.0, 200.0, 150.0]),
        ],
        gauge: [250.0, 200.0, 0.0],
        offset: [0.0, 0.0, -120.0],
        workpiece_origin: [250.0, 200.0, -350.0],
        ..Machine::default()
    }
}

/// Position deviation (mm) and rotation (rad) with one error of a value, at a pose by names of axes (mm, deg).
fn deviation(pose: &Value, (axis, location, component, value): (usize, bool, usize, f64)) -> [[f64; 3]; 2] {
    let mut machine = oracle();
    let mut states: Vec<State> = WALK
        .iter()
        .zip(&machine.walk)
        .map(|(name, axis)| {
            let q = pose[*name].as_f64().unwrap();
            State { position: if axis.rotary { q.to_radians() } else { q }, errors: [0.0; 6] }
        })
        .collect();
    if location {
        machine.walk[axis].location[component] = value;
    } else {
        states[axis].errors[component] = value;
    }
    let answer = machine.evaluate(&states, Frame::Workpiece);
    [answer.deviation, answer.rotation]
}

/// Effects of the errors at their bounds, to first order by a central difference: um and urad.
fn effects(pose: &Value) -> Vec<[[f64; 3]; 2]> {
    let of = |(axis, location, component, bound): (usize, bool, usize, f64)| {
        let [plus, minus] = [1.0, -1.0].map(|sign| deviation(pose, (axis, location, component, sign * bound)));
        let scales = [1e3, 1e6];
        std::array::from_fn(|q| std::array::from_fn(|k| 0.5 * (plus[q][k] - minus[q][k]) * scales[q]))
    };
    BOUNDS.into_iter().map(of).collect()
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A JSON table of a map.
fn rows(folder: &Folder, arguments: &[&str]) -> Value {
    let out = folder.file("rows.json");
    abbe(&[&["map"], arguments, &["--json", text(&out), "--quiet"]].concat());
    serde_json::from_str(&std::fs::read_to_string(out).unwrap()).unwrap()
}

fn machine(folder: &Folder) -> PathBuf {
    folder.with("m.yaml", FILE)
}

#[test]
fn the_rss_of_every_pose_is_that_of_a_rigid_body() {
    let folder = Folder::new("bounded-rss");
    let path = machine(&folder);
    let table = rows(&folder, &[text(&path), "--random", "25", "--samples", "40"]);
    let poses = table["poses"].as_array().unwrap();
    assert_eq!(poses.len(), 25);
    for pose in poses {
        let all = effects(&pose["axes"]);
        for (q, key) in ["position_um", "rotation_urad"].into_iter().enumerate() {
            let truth = all.iter().map(|effect| length(effect[q]).powi(2)).sum::<f64>().sqrt();
            let rss = number(&pose[key]["rss"]);
            assert!((rss - truth).abs() < 1e-6 * truth, "{key} {rss} {truth} at {}", pose["axes"]);
        }
    }
    // Closed form: squareness of X and Y by its arm, 20 urad at Y = 400 is 8 um.
    let alone = folder.with(
        "s.yaml",
        "abbe: 1\nmachine: S\nchain: w b X Y t\naxes: { X: { travel: [0, 400] }, Y: { travel: [0, 400] } }\n\
         errors: { EC0Y: { tolerance: 20 urad } }\nvolume: { X: { step: 400 mm }, Y: { step: 100 mm } }\n",
    );
    let table = rows(&folder, &[text(&alone), "--samples", "4000"]);
    for pose in table["poses"].as_array().unwrap() {
        let truth = 20e-3 * number(&pose["axes"]["Y"]);
        let [rss, p95] = ["rss", "p95"].map(|key| number(&pose["position_um"][key]));
        assert!((rss - truth).abs() < 1e-9, "{pose}");
        // |U| of a rectangle, 4 sigma of the share below an order statistic of 4000.
        let spread = 4.0 * (0.95 * 0.05 / 4000.0_f64).sqrt();
        assert!((p95 - 0.95 * truth).abs() <= spread * truth, "{pose}");
    }
}

#[test]
fn the_95_percent_value_is_within_the_order_statistics_of_an_own_monte_carlo() {
    // At one pose every error is uniform between its bounds, and independent of the others.
    const OWN: usize = 100_000;
    const DRAWN: f64 = 4000.0;
    let folder = Folder::new("bounded-p95");
    let path = machine(&folder);
    let table = rows(&folder, &[text(&path), "--random", "8", "--samples", "4000"]);
    let mut random = Random::new(95);
    for pose in table["poses"].as_array().unwrap() {
        let all = effects(&pose["axes"]);
        for (q, key) in ["position_um", "rotation_urad"].into_iter().enumerate() {
            let mut own: Vec<f64> = (0..OWN)
                .map(|_| {
                    let sum = all.iter().fold([0.0; 3], |sum: [f64; 3], effect| {
                        let share = random.around(1.0);
                        std::array::from_fn(|k| sum[k] + share * effect[q][k])
                    });
                    length(sum)
                })
                .collect();
            own.sort_by(f64::total_cmp);
            // The rank of the program's value among the own: 0.95 within 4 sigma of both samples.
            let sigma = (0.95 * 0.05 * (1.0 / DRAWN + 1.0 / OWN as f64)).sqrt();
            let at = |share: f64| own[(share.clamp(0.0, 0.999_99) * OWN as f64) as usize];
            let p95 = number(&pose[key]["p95"]);
            let (low, high) = (at(0.95 - 4.0 * sigma), at(0.95 + 4.0 * sigma));
            assert!((low..=high).contains(&p95), "{key} {p95} is not in {low}..{high} at {}", pose["axes"]);
        }
    }
}

/// Tool poses that the machine reaches, and their number.
fn work(folder: &Folder, count: usize) -> PathBuf {
    let mut random = Random::new(7);
    let mut csv = "X,Y,Z,I,J,K,feature\n".to_owned();
    for i in 0..count {
        let place = [random.between(150.0, 350.0), random.between(100.0, 300.0), random.between(0.0, 150.0)];
        let tilt = random.around(0.4);
        let cells = [place[0], place[1], place[2], tilt.sin(), 0.0, tilt.cos()].map(|x| x.to_string());
        csv.push_str(&format!("{},{}\n", cells.join(","), if i % 2 == 0 { "rib" } else { "bore" }));
    }
    folder.with("work.csv", &csv)
}

fn near(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= 1e-12 * b.abs()
        }
        (Value::Object(a), Value::Object(b)) => a.len() == b.len() && a.iter().all(|(k, v)| near(v, &b[k])),
        _ => a == b,
    }
}

#[test]
fn figures_are_those_of_the_budget_at_the_same_poses() {
    let folder = Folder::new("bounded-budget");
    let path = machine(&folder);
    for class in [None, Some("premium")] {
        let file = work(&folder, 12);
        let mut options = vec![
            text(&path),
            "--samples",
            "90",
            "--seed",
            "3",
            "--format",
            "json",
            "--reference",
            "machine",
            "--tool-poses",
        ];
        if let Some(class) = class {
            options.splice(1..1, ["--class", class]);
        }
        let with = |verb: &'static str, work: &Path| json(&[&[verb], &options[..], &[text(work)]].concat());
        let (map, budget) = (with("map", &file), with("budget", &file));
        for key in ["position_um", "rotation_urad"] {
            assert!(near(&map["bounds"][key]["monte_carlo"], &budget[key]["monte_carlo"]), "{class:?} {key}");
            assert!(near(&map["bounds"][key]["rss"]["max"], &budget[key]["rss"]), "{class:?} {key}");
        }
        for key in ["samples", "seed", "distribution", "class", "class_source"] {
            assert_eq!(map["bounds"][key], budget[key], "{key}");
        }
        assert_eq!(map["bounds"]["errors"], budget["tighten"].as_array().unwrap().len());
        // A budget of one pose is that pose.
        let one = work(&folder, 1);
        let (map, budget) = (with("map", &one), with("budget", &one));
        assert!(near(&map["position_um"]["max"], &budget["position_um"]["monte_carlo"]["p95"]), "{class:?}");
        assert!(near(&map["bounds"]["worst"][0]["p95_um"], &map["position_um"]["max"]));
    }
}

#[test]
fn the_seed_decides_and_neither_threads_nor_blocks_do() {
    let folder = Folder::new("bounded-threads");
    let path = machine(&folder);
    let csv = [1, 2, 5].map(|threads| {
        let out = folder.file(&format!("{threads}.csv"));
        let output = abbe_on(threads, &["map", text(&path), "--samples", "130", "--random", "40", "--csv", text(&out)]);
        assert!(output.status.success());
        (output.stdout, std::fs::read(out).unwrap())
    });
    assert!(!csv[0].1.is_empty() && csv[0] == csv[1] && csv[0] == csv[2]);
    let other = abbe_on(2, &["map", text(&path), "--samples", "130", "--random", "40", "--seed", "2"]).stdout;
    assert_ne!(other, csv[0].0);
    // More than a block of poses: the first ones stay as they are.
    let [few, many] = ["50", "8300"].map(|n| rows(&folder, &[text(&path), "--random", n, "--samples", "2"]));
    let (few, many) = (few["poses"].as_array().unwrap(), many["poses"].as_array().unwrap());
    assert!(many.len() == 8300 && few[..] == many[..50]);
    assert!(many.iter().all(|pose| number(&pose["position_um"]["rss"]) > 0.0));
}

#[test]
fn all_forms_hold_the_same_numbers_and_say_where_they_come_from() {
    let folder = Folder::new("bounded-forms");
    let path = machine(&folder);
    let [c, j, v, p] = ["m.csv", "m.json", "m.vtu", "m.parquet"].map(|name| folder.file(name));
    let files = ["--csv", text(&c), "--json", text(&j), "--vtk", text(&v), "--parquet", text(&p)];
    let words = abbe(&[&["map", text(&path), "--samples", "50", "--seed", "9"], &files[..]].concat());
    assert!(
        words.contains("nothing is measured\nFrom bounds: 9 errors; 50 machines drawn, uniform distribution, seed 9\n")
    );
    let csv = std::fs::read_to_string(&c).unwrap();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next().unwrap(),
        "C [deg],Y [mm],X [mm],Z [mm],B [deg],position_rss [um],position_p95 [um],rotation_rss [urad],\
         rotation_p95 [urad],from,samples,seed"
    );
    let lines: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let table: Value = serde_json::from_str(&std::fs::read_to_string(&j).unwrap()).unwrap();
    assert_eq!((&table["from"], &table["samples"], &table["seed"]), (&"bounds".into(), &"50".into(), &"9".into()));
    let poses = table["poses"].as_array().unwrap();
    // 3 X, 3 Y, 3 Z, 3 B and 4 C nodes.
    assert!(poses.len() == 324 && lines.len() == 324);
    let vtk = std::fs::read(&v).unwrap();
    let names = ["position_rss_um", "position_p95_um", "rotation_rss_urad", "rotation_p95_urad"];
    let arrays = names.map(|name| doubles(array(&vtk, name)));
    let head = String::from_utf8_lossy(&vtk[..2000]).into_owned();
    assert!(head.contains("from bounds, nothing is measured") && head.contains("50 machines drawn (seed 9, uniform"));
    assert!(!head.contains("deviation_um"));
    for (i, (line, pose)) in lines.iter().zip(poses).enumerate() {
        assert_eq!(line[9..], ["bounds", "50", "9"]);
        let of = |key: &str, figure: &str| number(&pose[key][figure]);
        let four = [
            of("position_um", "rss"),
            of("position_um", "p95"),
            of("rotation_urad", "rss"),
            of("rotation_urad", "p95"),
        ];
        for (k, truth) in four.into_iter().enumerate() {
            assert_eq!(line[5 + k].parse::<f64>().unwrap(), truth);
            assert_eq!(arrays[k][i], truth);
        }
    }
    use parquet::file::reader::{FileReader, SerializedFileReader};
    let reader = SerializedFileReader::new(std::fs::File::open(&p).unwrap()).unwrap();
    let facts = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
    let fact = |name: &str| facts.iter().find(|fact| fact.key == name).and_then(|fact| fact.value.clone()).unwrap();
    assert_eq!((fact("from").as_str(), fact("samples").as_str(), fact("seed").as_str()), ("bounds", "50", "9"));
    assert_eq!(reader.metadata().file_metadata().num_rows(), 324);
}

#[test]
fn statistics_are_those_of_the_rows_and_ranges_those_of_the_machines_drawn() {
    let folder = Folder::new("bounded-statistics");
    let path = machine(&folder);
    let options = [text(&path), "--samples", "60", "--random", "30"];
    let (table, map) = (rows(&folder, &options), json(&[&["map"], &options[..], &["--format", "json"]].concat()));
    assert_eq!((&map["from"], &map["order"], &map["bounds"]["samples"]), (&"bounds".into(), &"1".into(), &60.into()));
    for (key, figure, at) in [
        ("position_um", "p95", &map["position_um"]),
        ("position_um", "rss", &map["bounds"]["position_um"]["rss"]),
        ("rotation_urad", "p95", &map["rotation_urad"]),
        ("rotation_urad", "rss", &map["bounds"]["rotation_urad"]["rss"]),
    ] {
        let mut list: Vec<f64> =
            table["poses"].as_array().unwrap().iter().map(|pose| number(&pose[key][figure])).collect();
        list.sort_by(f64::total_cmp);
        let mean = list.iter().sum::<f64>() / 30.0;
        let rms = (list.iter().map(|x| x * x).sum::<f64>() / 30.0).sqrt();
        for (name, truth) in [("max", list[29]), ("mean", mean), ("rms", rms), ("p95", list[28])] {
            assert!((number(&at[name]) - truth).abs() < 1e-12 * truth, "{key} {figure} {name}");
        }
    }
    // One constant error of the place: X is off by a share of Y; the range over Y is the largest deviation.
    let alone = folder.with(
        "s.yaml",
        "abbe: 1\nmachine: S\nchain: w b X Y t\naxes: { X: { travel: [0, 400] }, Y: { travel: [-100, 400] } }\n\
         errors: { EC0Y: { tolerance: 20 urad } }\nvolume: { X: { step: 400 mm }, Y: { step: 100 mm } }\n",
    );
    for (frame, axis) in [("workpiece", 0), ("machine", 0)] {
        let map = json(&["map", text(&alone), "--samples", "200", "--frame", frame, "--format", "json"]);
        let range = number(&map["position_um"]["range"][axis]);
        // 400 mm of 500 mm of Y are above zero.
        let everywhere = number(&map["bounds"]["position_um"]["monte_carlo"]["p95"]);
        assert!((range - everywhere * 500.0 / 400.0).abs() < 1e-9, "{range} {everywhere}");
        assert_eq!(map["position_um"]["range"][1], 0.0);
    }
}

#[test]
fn what_has_no_meaning_without_measured_errors_is_refused() {
    let folder = Folder::new("bounded-refused");
    let path = machine(&folder);
    let svg = folder.file("x.svg");
    for (options, words) in [
        (vec!["--target", "linuxcnc"], "nothing to compensate"),
        (vec!["--order", "2"], "first order"),
        (vec!["--svg", text(&svg), "--drawing", "grid"], "bounds have no direction"),
        (vec!["--svg", text(&svg), "--component", "dx"], "bounds have no direction"),
    ] {
        let (code, complaint) = refused(&[&["map", text(&path)], &options[..]].concat());
        assert!(code == 2 && complaint.contains(words), "{options:?}: {code} {complaint}");
    }
    let (code, complaint) = refused(&["map", text(&path), "--random", "1000001", "--samples", "2"]);
    assert!(code == 1 && complaint.contains("E0812") && complaint.contains("from bounds"), "{complaint}");
    assert!(!svg.exists());
}

#[test]
fn the_picture_shows_the_95_percent_value_and_says_so() {
    let folder = Folder::new("bounded-picture");
    let (path, svg) = (machine(&folder), folder.file("x.svg"));
    abbe(&["map", text(&path), "--random", "5", "--samples", "30", "--svg", text(&svg), "--quiet"]);
    let drawn = std::fs::read_to_string(&svg).unwrap();
    well_formed(&drawn).unwrap();
    for words in ["95 % value of the deviation over the X-Y plane", ", from bounds", "95 % value of |d| in µm"] {
        assert!(drawn.contains(words), "{words}");
    }
    assert!(drawn.contains("30 machines drawn, uniform distribution, seed 1"));
    // No direction, no arrows.
    assert!(!drawn.contains("Arrows:"));
}

#[test]
fn bounds_beside_measured_errors_are_said_in_a_sentence() {
    let folder = Folder::new("bounded-mixed");
    let path = folder.with("m.yaml", &FILE.replace("EXX: { tolerance: 4 um }", "EXX: 4 um"));
    let options = [text(&path), "--samples", "50", "--seed", "4"];
    let map = json(&[&["map"], &options[..], &["--random", "20", "--format", "json"]].concat());
    // A budget has the measured error in every machine; with a value of zero it is one of the bounds alone.
    let zero = folder.with("z.yaml", &FILE.replace("EXX: { tolerance: 4 um }", "EXX: 0 um"));
    let budget = json(&[&["budget", text(&zero)], &options[1..], &["--format", "json"]].concat());
    // The measured error as it is, without bounds in it.
    assert!((number(&map["position_um"]["max"]) - 4.0).abs() < 1e-9 && map.get("from").is_none());
    let add = &map["bounds_add"];
    assert_eq!((&add["errors"], &add["samples"], &add["seed"]), (&8.into(), &50.into(), &4.into()));
    for key in ["position_um", "rotation_urad"] {
        assert!(near(&add[key]["rss"], &budget[key]["rss"]), "{key}");
        assert!(near(&add[key]["p95"], &budget[key]["monte_carlo"]["p95"]), "{key}");
    }
    let words = abbe(&[&["map"], &options[..], &["--random", "20"]].concat());
    assert!(words.contains("Not in these figures: 8 errors without a value and only bounded."), "{words}");
    // A class bounds what has a value, too; that adds nothing.
    let measured = folder.with(
        "c.yaml",
        "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 400], origin: [0, 0, 0] } }\nclass: production\n\
         errors: { EXX: 1 um, EYX: 1 um, EZX: 1 um, EAX: 1 urad, EBX: 1 urad }\n",
    );
    let map = json(&["map", text(&measured), "--samples", "50", "--format", "json"]);
    assert_eq!(map["bounds_add"]["errors"], 1);
    let without = folder.with(
        "w.yaml",
        "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 400] } }\nerrors: { EXX: 1 um }\n",
    );
    assert!(json(&["map", text(&without), "--format", "json"]).get("bounds_add").is_none());
}

/// Cells of a CSV text by line, below its header.
fn cells(csv: &str) -> (Vec<&str>, Vec<Vec<&str>>) {
    let mut lines = csv.lines().map(|line| line.split(',').collect());
    (lines.next().unwrap(), lines.collect())
}

#[test]
fn two_machines_are_compared_by_what_their_bounds_lead_to() {
    let folder = Folder::new("bounded-compare");
    let a = machine(&folder);
    let b = folder.with("b.yaml", &FILE.replace("ECC: { tolerance: 25 urad }", "ECC: { tolerance: 60 urad }"));
    let file = work(&folder, 15);
    let work = ["--samples", "60", "--reference", "machine", "--tool-poses", text(&file)];
    let compared = [&work[..], &["--max-samples", "60"]].concat();
    let result = json(&[&["compare", text(&a), text(&b)], &compared[..], &["--format", "json"]].concat());
    let csv = abbe(&[&["compare", text(&a), text(&b)], &compared[..], &["--format", "csv"]].concat());
    let (head, lines) = cells(&csv);
    assert_eq!(head[8..12], ["position_rss [um]", "position_p95 [um]", "rotation_rss [urad]", "rotation_p95 [urad]"]);
    assert!(!head.contains(&"dx [um]") && lines.len() == 30);
    let at = |line: &[&str], k: usize| line[k].parse::<f64>().unwrap();
    for pair in lines.chunks(2) {
        for k in 8..12 {
            assert_eq!(at(&pair[0], k + 4), 0.0);
            assert_eq!(at(&pair[1], k + 4), at(&pair[1], k) - at(&pair[0], k));
            // The same machines are drawn, and ECC of the second is wider.
            assert!(at(&pair[1], k) >= at(&pair[0], k) * if k % 2 == 0 { 1.0 } else { 0.9 });
        }
        assert_eq!(pair[1][16..], ["bounds", "60", "1"]);
    }
    for (i, path) in [&a, &b].into_iter().enumerate() {
        let side = &result["machines"][i];
        let map = json(&[&["map", text(path)], &work[..], &["--format", "json"]].concat());
        assert_eq!(side["from"], "bounds");
        for key in ["position_um", "rotation_urad"] {
            assert!(near(&side["bounds"][key], &map["bounds"][key]), "{i} {key}");
            for figure in ["max", "mean", "rms", "p95"] {
                assert!(near(&side[key][figure], &map[key][figure]), "{i} {key} {figure}");
                let minus = number(&side[key][figure]) - number(&result["machines"][0][key][figure]);
                assert_eq!(number(&side["minus_first"][key][figure]), minus);
                let rss = |i: usize| number(&result["machines"][i]["bounds"][key]["rss"][figure]);
                assert_eq!(number(&side["bounds"]["rss_minus_first"][key][figure]), rss(i) - rss(0));
            }
        }
    }
    let words = abbe(&[&["compare", text(&a), text(&b)], &compared[..]].concat());
    assert!(words.contains("  2  nothing is measured. From bounds: 9 errors; 60 machines drawn"), "{words}");
    // One of them measured: its deviations stand beside the bounds of the other, without a difference.
    let measured = folder.with("c.yaml", &FILE.replace("EXX: { tolerance: 4 um }", "EXX: 4 um"));
    let both = [&["compare", text(&measured), text(&a)], &compared[..]].concat();
    let result = json(&[&both[..], &["--format", "json"]].concat());
    assert!((number(&result["machines"][0]["position_um"]["max"]) - 4.0).abs() < 1e-9);
    assert!(number(&result["machines"][1]["position_um"]["max"]) > 0.0 && result["machines"][1]["from"] == "bounds");
    assert!(result["machines"][1]["minus_first"].is_null());
    // What the other bounds of the first add is a budget of them on this work.
    let zero = folder.with("z.yaml", &FILE.replace("EXX: { tolerance: 4 um }", "EXX: 0 um"));
    let budget = json(&[&["budget", text(&zero)], &work[..], &["--format", "json"]].concat());
    let add = &result["machines"][0]["bounds_add"];
    assert!(near(&add["position_um"]["rss"], &budget["position_um"]["rss"]) && add["errors"] == 8);
    assert!(result["machines"][1].get("bounds_add").is_none());
    let csv = abbe(&[&both[..], &["--format", "csv"]].concat());
    let (head, lines) = cells(&csv);
    assert!(lines.iter().all(|line| line.len() == head.len()));
    assert!(
        (at(&lines[0], 8) - 4.0).abs() < 1e-9
            && lines[0][14].is_empty()
            && lines[1][8].is_empty()
            && !lines[1][14].is_empty()
    );
}

#[test]
fn the_report_shows_the_bounds_and_no_zeros() {
    let folder = Folder::new("bounded-report");
    let (a, out) = (machine(&folder), folder.file("page.html"));
    let class = folder.with("k.yaml", &(FILE.split("errors:").next().unwrap().to_owned() + "class: premium\n"));
    abbe(&[
        "report",
        text(&a),
        text(&class),
        "--poses",
        "40",
        "--samples",
        "40",
        "--seed",
        "5",
        "--out",
        text(&out),
        "--quiet",
    ]);
    let page = std::fs::read_to_string(&out).unwrap();
    let data = packed::data(&page);
    for (i, path) in [&a, &class].into_iter().enumerate() {
        let map = json(&["map", text(path), "--random", "40", "--samples", "40", "--seed", "5", "--format", "json"]);
        let machine = &data["machines"][i];
        for key in ["position_um", "rotation_urad"] {
            for figure in ["max", "mean", "rms", "p95"] {
                assert!(near(&machine["statistics"][key][figure], &map[key][figure]), "{key} {figure}");
            }
            assert!(near(&machine["bounds"][key], &map["bounds"][key]), "{key}");
        }
        assert!(near(&machine["worst"][0]["p95_um"], &map["bounds"]["worst"][0]["p95_um"]));
        assert!(machine["warnings"].as_array().unwrap().is_empty());
        for layer in machine["field"]["layers"].as_array().unwrap() {
            for at in layer["at"].as_array().unwrap() {
                assert!(at.get("deviation_nm").is_none(), "{}", layer["id"]);
                // An error of C's place does nothing at C = 0.
                assert!(number(&at["max_um"]) > 0.0 || layer["group"] == "error", "{}", layer["id"]);
            }
        }
    }
    // Layers against the rigid body: the RSS at each node of the first station.
    let field = &data["machines"][0]["field"];
    let grid = field["grid"].as_array().unwrap();
    let rss = field["layers"].as_array().unwrap().iter().find(|layer| layer["id"] == "rss").unwrap();
    let nodes = rss["at"][0]["length_nm"].as_array().unwrap();
    let count = grid[0]["positions"].as_array().unwrap().len();
    for node in [0, 10, nodes.len() - 1] {
        let mut pose = serde_json::json!({"X": 0.0, "Y": 0.0, "Z": 0.0, "B": 0.0, "C": 0.0});
        let mut rest = node;
        for axis in grid {
            pose[axis["name"].as_str().unwrap()] = axis["positions"][rest % count].clone();
            rest /= count;
        }
        let truth = effects(&pose).iter().map(|effect| length(effect[0]).powi(2)).sum::<f64>().sqrt() * 1e3;
        assert!((number(&nodes[node]) - truth).abs() < 1.0, "{} {truth}", nodes[node]);
    }
    // What the workbench starts with is compressed: it has answers of `eval` and `instrument`, with their warnings.
    let report = format!("{page}{data}");
    for words in ["gives no component errors", "gives no error a value", "count as 0"] {
        assert!(!report.contains(words), "{words}");
    }
    assert!(page.contains("From bounds, nothing is measured") && page.contains("No component error is measured"));
    // The class bounds every location error that the chain needs.
    let locations = data["machines"][1]["locations"].as_array().unwrap();
    assert!(
        !locations.is_empty() && locations.iter().all(|l| l["status"] == "not in the file by name: bounded otherwise")
    );
    let machines = &data["comparison"]["machines"];
    assert!(number(&machines[1]["minus_first"]["position_um"]["p95"]).abs() > 0.0);
    // A target is left out, with a warning.
    let output = abbe_on(
        2,
        &["report", text(&a), "--poses", "10", "--samples", "10", "--target", "linuxcnc", "--out", text(&out)],
    );
    assert!(output.status.success() && String::from_utf8_lossy(&output.stderr).contains("W0802"));
}
