//! Poses of the axes in place of a volume or a part: `map`, `compare`, `budget` and `report` against `eval` at the same
//! poses, and against the tables of the file.

use crate::program::{Folder, abbe, json, refused, text};
use crate::support::packed;
use nalgebra::Vector3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const KIMM: &str = "papers/bui-kimm.yaml";
const POSES: usize = 45;

/// A curve in the space of the axes, all within the travels of the KIMM machine, and its file.
fn path(folder: &Folder) -> PathBuf {
    let mut rows = "# from the control\n\nC, A [deg]; X\n".replace(';', ",");
    for i in 0..POSES {
        let t = i as f64 / 7.0;
        let (c, a, x) = (11.0 * i as f64, -60.0 * t.sin().abs() + 20.0, 180.0 * (0.8 * t).cos());
        rows += &format!("{c},{a},{x}\n");
    }
    folder.with("path.csv", &rows)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_vec(numbers(value))
}

fn eval(machine: &str, poses: &Path, more: &[&str]) -> Vec<Value> {
    let list = ["eval", machine, "--axis-poses", text(poses), "--format", "json", "--quiet"];
    json(&[&list[..], more].concat())["poses"].as_array().unwrap().clone()
}

/// Statistics of vectors by their definitions: largest, mean, rms, 95 % and ranges.
fn statistics(list: &[Vector3<f64>]) -> BTreeMap<&'static str, Vec<f64>> {
    let mut lengths: Vec<f64> = list.iter().map(|v| v.norm()).collect();
    lengths.sort_by(f64::total_cmp);
    let n = lengths.len();
    let p95 = lengths[(0.95 * n as f64).ceil() as usize - 1];
    let range = |k: usize| {
        let all = || list.iter().map(|v| v[k]);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    let mean = lengths.iter().sum::<f64>() / n as f64;
    let rms = (lengths.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
    BTreeMap::from([
        ("max", vec![lengths[n - 1]]),
        ("mean", vec![mean]),
        ("rms", vec![rms]),
        ("p95", vec![p95]),
        ("range", (0..3).map(range).collect()),
    ])
}

/// The statistics are those of the deviations of `eval`, to rounding of 1e-9 um or urad.
fn is_of(found: &Value, poses: &[Value], key: &str, scale: f64) {
    let list: Vec<Vector3<f64>> = poses.iter().map(|pose| vector(&pose[key]) * scale).collect();
    for (name, expected) in statistics(&list) {
        let own = &found[name];
        let own = if own.is_array() { numbers(own) } else { vec![own.as_f64().unwrap()] };
        let off = own.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(own.len() == expected.len() && off < 1e-8, "{key} {name}: {own:?} for {expected:?}");
    }
}

#[test]
fn a_map_over_poses_of_the_axes_is_that_of_eval() {
    let folder = Folder::new("axis-poses-map");
    let poses = path(&folder);
    let csv = folder.file("map.csv");
    for more in [&[][..], &["--order", "2"], &["--direction", "reverse"]] {
        let list = ["map", KIMM, "--axis-poses", text(&poses), "--csv", text(&csv), "--format", "json"];
        let found = json(&[&list[..], more].concat());
        let of_eval = eval(KIMM, &poses, more);
        assert_eq!((of_eval.len(), &found["poses"]), (POSES, &POSES.into()));
        is_of(&found["position_um"], &of_eval, "deviation", 1e3);
        is_of(&found["rotation_urad"], &of_eval, "rotation", 1e6);
        let over = &found["over"];
        assert_eq!(
            (&over["kind"], &over["path"], &over["poses"]),
            (&"axis_poses".into(), &false.into(), &POSES.into())
        );
        // Row by row: the line of the file, the axes as they are, the deviation.
        let table = std::fs::read_to_string(&csv).unwrap();
        for ((i, line), pose) in table.lines().skip(1).enumerate().zip(&of_eval) {
            let row: Vec<f64> =
                line.trim_end_matches(',').split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            assert_eq!(row[0], (4 + i) as f64, "{line}");
            let axes: Vec<f64> = ["C", "A", "Y", "X", "Z"].map(|axis| pose["axes"][axis].as_f64().unwrap()).into();
            assert_eq!(row[1..6], axes[..]);
            let off = (Vector3::new(row[6], row[7], row[8]) - vector(&pose["deviation"]) * 1e3).norm();
            assert!(off < 1e-8, "{off} um in {line}");
        }
        assert_eq!(table.lines().count(), POSES + 1);
    }
    // The part of one degree, by eval's own parts.
    let found = json(&["map", KIMM, "--axis-poses", text(&poses), "--degree", "2", "--format", "json"]);
    let parts: Vec<Value> = eval(KIMM, &poses, &["--order", "2"])
        .iter()
        .map(|pose| pose["degrees"].as_array().unwrap().iter().find(|of| of["degree"] == 2).unwrap().clone())
        .collect();
    is_of(&found["position_um"], &parts, "deviation", 1e3);
    let said = abbe(&["map", KIMM, "--axis-poses", text(&poses)]);
    assert!(said.contains("Over 45 poses of the axes, single poses; reference: machine coordinates"), "{said}");
}

#[test]
fn poses_of_the_axes_are_a_path_where_that_is_asked_for() {
    let folder = Folder::new("axis-poses-path");
    let poses = folder.with("there-and-back.csv", "X,A\n0,0\n50,-20\n90,-45\n40,-45\n10,-30\n");
    let list = ["map", KIMM, "--axis-poses", text(&poses), "--path", "yes", "--format", "json"];
    let found = json(&list);
    assert_eq!(found["over"]["path"], true);
    let axis = |name: &str| {
        let all = found["path"]["axes"].as_array().unwrap();
        all.iter().find(|of| of["axis"] == name).unwrap()["reversals"].clone()
    };
    // X turns at its third row, the fourth line; A where it comes back from -45, at the last row that holds it.
    assert_eq!((axis("X"), axis("C")), (serde_json::json!([4]), serde_json::json!([])));
    let of_eval: Vec<Vector3<f64>> =
        eval(KIMM, &poses, &[]).iter().map(|pose| vector(&pose["deviation"]) * 1e3).collect();
    let steps: Vec<f64> = of_eval.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    let largest = steps.iter().copied().fold(0.0, f64::max);
    let at = steps.iter().position(|step| *step == largest).unwrap();
    let step = &found["path"]["deviation_step"];
    assert!((step["um"].as_f64().unwrap() - largest).abs() < 1e-8, "{step} for {largest}");
    assert_eq!(step["lines"], serde_json::json!([at + 2, at + 3]));
}

#[test]
fn poses_beyond_the_travel_are_evaluated_with_a_warning_as_in_eval() {
    let folder = Folder::new("axis-poses-beyond");
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes:\n  X: { travel: [0, 400], origin: [0, 0, 0] }\n  Y: { travel: [0, 400], origin: [0, 0, 0] }\n  Z: { travel: [0, 400], origin: [0, 0, 0] }\nerrors: { EC0Y: 20 urad }\n",
    );
    let poses = folder.with("far.csv", "X,Y\n10,100\n20,500\n");
    let (exit, said) = refused(&["map", text(&machine), "--axis-poses", text(&poses), "--format", "json"]);
    assert!(exit == 0 && said.contains("W0801") && said.contains("beyond the travel of `Y`"), "{said}");
    let found = json(&["map", text(&machine), "--axis-poses", text(&poses), "--format", "json", "--quiet"]);
    // A squareness of 20 urad at Y = 500.
    assert!((found["position_um"]["max"].as_f64().unwrap() - 10.0).abs() < 1e-6, "{found}");
}

/// A machine of three axes by the letters of its chain.
fn three(folder: &Folder, name: &str, chain: &str, more: &str) -> PathBuf {
    let axis = |name: &str| {
        let sense = if name == "Y" && chain.contains("Y'") { more } else { "" };
        format!("  {name}: {{ travel: [-400, 400], origin: [0, 0, 0]{sense} }}\n")
    };
    let axes = ["X", "Y", "Z"].map(axis).concat();
    let errors =
        "errors: { EC0Y: 20 urad, EXY: { polynomial: [1 um, 0.03 um/mm] }, EYY: { polynomial: [0 um, 0.02 um/mm] } }";
    folder.with(name, &format!("abbe: 1\nmachine: {name}\nchain: \"{chain}\"\naxes:\n{axes}{errors}\n"))
}

#[test]
fn machines_are_compared_at_poses_of_the_first() {
    let folder = Folder::new("axis-poses-compare");
    let poses = path(&folder);
    let other = folder.with(
        "other.yaml",
        &format!(
            "abbe: 1\nextends: {}\nmachine: Other\nerrors: {{ EX0C: 30 um, EB0A: -40 urad }}\n",
            text(&crate::configs::folder().join(KIMM))
        ),
    );
    let list = ["compare", KIMM, text(&other), "--axis-poses", text(&poses), "--format", "json", "--quiet"];
    let found = json(&[&list[..], &["--reference", "machine"]].concat());
    for (i, machine) in [KIMM, text(&other)].iter().enumerate() {
        is_of(&found["machines"][i]["position_um"], &eval(machine, &poses, &[]), "deviation", 1e3);
        is_of(&found["machines"][i]["rotation_urad"], &eval(machine, &poses, &[]), "rotation", 1e6);
    }
    assert_eq!((&found["over"]["kind"], &found["poses"]), (&"axis_poses".into(), &POSES.into()));
    // Without a part the verdict needs machine coordinates and best fit, as over a volume.
    assert!(json(&list)["best_fit"].is_object());
    // A machine that reaches the tool poses by other positions takes those: its Y runs the other way.
    let first = three(&folder, "first.yaml", "w b X Y Z t", "");
    let turned = three(&folder, "turned.yaml", "w Y' b X Z t", ", sense: direct");
    let rows = folder.with("rows.csv", "X,Y,Z\n10,100,5\n-30,-250,7\n200,30,-60\n");
    let back = folder.with("back.csv", "X,Y,Z\n10,-100,5\n-30,250,7\n200,-30,-60\n");
    let machines = [text(&first), text(&turned)];
    let list = ["compare", machines[0], machines[1], "--axis-poses", text(&rows), "--reference", "machine"];
    let found = json(&[&list[..], &["--format", "json", "--quiet"]].concat());
    is_of(&found["machines"][0]["position_um"], &eval(machines[0], &rows, &[]), "deviation", 1e3);
    is_of(&found["machines"][1]["position_um"], &eval(machines[1], &back, &[]), "deviation", 1e3);
}

/// The largest value of a column of an error's tables at positions, by linear interpolation of the file.
fn largest(file: &str, error: &str, positions: &[f64]) -> f64 {
    let table = std::fs::read_to_string(crate::configs::folder().join("errors/bui-kimm").join(file)).unwrap();
    let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let header = cells(table.lines().next().unwrap());
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|line| cells(line).iter().map(|x| x.parse().unwrap()).collect()).collect();
    let is_of = |name: &String| name.split([' ', '+', '-']).next() == Some(error);
    let columns: Vec<usize> = (1..header.len()).filter(|k| is_of(&header[*k])).collect();
    assert!(!columns.is_empty(), "{error} in {header:?}");
    let at = |q: f64, k: usize| {
        let i = rows.iter().rposition(|row| row[0] <= q).unwrap().min(rows.len() - 2);
        let (a, b) = (&rows[i], &rows[i + 1]);
        a[k] + (b[k] - a[k]) * (q - a[0]) / (b[0] - a[0])
    };
    let all = positions.iter().flat_map(|q| columns.iter().map(|k| at(*q, *k).abs()));
    all.fold(0.0, f64::max)
}

#[test]
fn a_budget_of_values_at_poses_of_the_axes_needs_no_class() {
    let folder = Folder::new("axis-poses-budget");
    let poses = path(&folder);
    let list = ["budget", KIMM, "--axis-poses", text(&poses), "--reference", "machine", "--samples", "200"];
    let found = json(&[&list[..], &["--format", "json"]].concat());
    assert_eq!((&found["from"], &found["over"]["kind"]), (&"values".into(), &"axis_poses".into()));
    let tighten = found["tighten"].as_array().unwrap();
    let bounds: BTreeMap<&str, f64> =
        tighten.iter().map(|of| (of["error"].as_str().unwrap(), of["tolerance"].as_f64().unwrap())).collect();
    assert_eq!(bounds.len(), 41);
    let of_eval = eval(KIMM, &poses, &["--sensitivity"]);
    let positions = |axis: &str| -> Vec<f64> {
        of_eval
            .iter()
            .map(|pose| pose["axes"][axis].as_f64().unwrap())
            .map(|q| if axis == "C" { q.rem_euclid(360.0) } else { q })
            .collect()
    };
    let constants = [("EC0Y", 18.0), ("EB0Z", 22.0), ("EY0A", 9.0), ("EC0A", 16.0), ("EB0C", 19.0)];
    let tables = ["EXX", "EYX", "ECX", "EYY", "EZZ", "EAA", "EXA", "ECA", "ECC", "EBC", "EZC"];
    let of_tables = tables.map(|error| {
        let axis = &error[2..];
        (error, largest(&format!("{}.csv", axis.to_lowercase()), error, &positions(axis)))
    });
    for (error, expected) in constants.into_iter().chain(of_tables) {
        assert!((bounds[error] - expected).abs() < 1e-9, "{error}: {} for {expected}", bounds[error]);
    }
    // RSS and worst case by the sensitivities of eval: um per um are mm per mm, um per urad are mm per rad in 1e-3.
    let effects = |pose: &Value| -> Vec<Vector3<f64>> {
        let per = |error: &str| if "ABC".contains(&error[1..2]) { 1e-3 } else { 1.0 };
        let all = pose["sensitivity"].as_array().unwrap().iter().map(|of| (of["error"].as_str().unwrap(), of));
        all.map(|(error, of)| vector(&of["deviation"]) * bounds[error] * per(error)).collect()
    };
    let all: Vec<Vec<Vector3<f64>>> = of_eval.iter().map(effects).collect();
    let rss = |list: &Vec<Vector3<f64>>| list.iter().map(|v| v.norm_squared()).sum::<f64>().sqrt();
    let largest_rss = all.iter().map(rss).fold(0.0, f64::max);
    let position = &found["position_um"];
    let number = |key: &str| position[key].as_f64().unwrap();
    assert!((number("rss") - largest_rss).abs() < 1e-6, "{position} for {largest_rss}");
    // The sum of signed effects that is longest, along the directions of a fine lattice of the sphere: short of it by
    // less than a thousandth.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let along = |k: usize| {
        let (z, turn) = (1.0 - (2 * k + 1) as f64 / 4000.0, golden * k as f64);
        Vector3::new((1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z)
    };
    let support = |u: Vector3<f64>, list: &[Vector3<f64>]| list.iter().map(|v| v.dot(&u).abs()).sum::<f64>();
    let lower = all.iter().flat_map(|list| (0..4000).map(move |k| support(along(k), list))).fold(0.0, f64::max);
    let worst = number("worst_case");
    assert!(lower <= worst * (1.0 + 1e-9) && worst < lower * 1.001, "{worst} for {lower}");
    let drawn = &position["monte_carlo"];
    assert!(drawn["p95"].as_f64().unwrap() > 0.2 * worst && drawn["p95"].as_f64().unwrap() < worst);
    let said = abbe(&list);
    assert!(said.contains("41 errors with values, none bounded: each within ± its largest at these poses"), "{said}");
    // Pictures as of any budget.
    let pareto = folder.file("pareto.svg");
    let _ = abbe(&[&list[..], &["--pareto", text(&pareto)]].concat());
    assert!(std::fs::read_to_string(pareto).unwrap().starts_with("<svg"));
}

#[test]
fn a_budget_of_bounds_keeps_them_at_poses_of_the_axes() {
    let folder = Folder::new("axis-poses-bounds");
    let machine = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes:\n  X: { travel: [0, 400], origin: [0, 0, 0] }\n  Y: { travel: [0, 400], origin: [0, 0, 0] }\n  Z: { travel: [0, 400], origin: [0, 0, 0] }\nerrors: { EC0Y: { tolerance: 20 urad }, EX0Y: 3 um, EXX: 4 um }\n",
    );
    let poses = folder.with("p.csv", "Y\n50\n300\n");
    let of = json(&["budget", text(&machine), "--axis-poses", text(&poses), "--format", "json", "--quiet"]);
    assert_eq!((&of["from"], of["tighten"].as_array().unwrap().len()), (&Value::Null, 1));
    // 20 urad at 300 mm beside 4 um that act.
    assert!((of["position_um"]["worst_case"].as_f64().unwrap() - 10.0).abs() < 1e-9, "{}", of["position_um"]);
    let (exit, said) = refused(&["budget", KIMM]);
    assert!(exit == 1 && said.contains("E0604") && said.contains("--axis-poses") && said.contains("--class"), "{said}");
    let path = path(&folder);
    let (exit, said) = refused(&["budget", KIMM, "--axis-poses", text(&path), "--goal", "30 um"]);
    assert!(exit == 2 && said.contains("no error is bounded"), "{said}");
}

#[test]
fn a_report_has_the_statistics_and_pictures_of_poses_of_the_axes() {
    let folder = Folder::new("axis-poses-report");
    let poses = path(&folder);
    let out = folder.file("page.html");
    let _ = abbe(&["report", KIMM, "--axis-poses", text(&poses), "--poses", "60", "--out", text(&out), "--quiet"]);
    let page = std::fs::read_to_string(&out).unwrap();
    let data = packed::data(&page);
    let machine = &data["machines"][0];
    assert_eq!((&machine["over"]["kind"], &machine["poses"]), (&"axis_poses".into(), &POSES.into()));
    is_of(&machine["statistics"]["position_um"], &eval(KIMM, &poses, &[]), "deviation", 1e3);
    let (exit, said) = refused(&["report", KIMM, KIMM, "--axis-poses", text(&poses), "--out", text(&out)]);
    assert!(exit == 2 && said.contains("of one machine"), "{said}");
}

#[test]
fn wrong_files_of_poses_are_refused_at_their_place_and_nothing_is_written() {
    let folder = Folder::new("axis-poses-wrong");
    let out = folder.file("out.csv");
    let cases = [
        ("U,X\n1,2\n", "no axis `U`"),
        ("X,X\n1,2\n", "twice"),
        ("1,2\n3,4\n", "the header is missing"),
        ("X,Y\n1\n", "1 cells under 2 columns"),
        ("X\nnan\n", "nan"),
        ("X [deg]\n1\n", "not a unit for `X`"),
        ("X\n", "the file has no poses"),
        ("", "the file has no header"),
        ("X\n1e9\n", "1000000 mm"),
        ("X,Y,Z,I,J,K\n1,2,3,0,0,1\n", "no axis `I`"),
    ];
    for (content, part) in cases {
        let file = folder.with("wrong.csv", content);
        for list in [&["map", KIMM, "--csv", text(&out)][..], &["compare", KIMM, KIMM], &["budget", KIMM]] {
            let (exit, said) = refused(&[list, &["--axis-poses", text(&file)]].concat());
            assert!(exit == 1 && said.contains("E0802") && said.contains(part), "{content:?}: {said}");
        }
        assert!(!out.exists(), "{content:?}");
    }
    let absent = folder.file("absent.csv");
    let (exit, said) = refused(&["map", KIMM, "--axis-poses", text(&absent)]);
    assert!(exit == 1 && said.contains("E0101"), "{said}");
    let poses = path(&folder);
    let others: [&[&str]; 5] = [
        &["map", KIMM, "--random", "5"],
        &["map", KIMM, "--tool-poses", "x.csv"],
        &["budget", KIMM, "--poses", "7"],
        &["compare", KIMM, KIMM, "--job", "x.yaml"],
        &["report", KIMM, "--job", "x.yaml", "--out", "x.html"],
    ];
    for list in others {
        let (exit, said) = refused(&[list, &["--axis-poses", text(&poses)]].concat());
        assert!(exit == 2 && said.contains("cannot be used with"), "{list:?}: {said}");
    }
}
