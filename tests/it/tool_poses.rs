//! Tool poses from a file as the work of `map`, `budget`, `compare` and `enumerate`.

use crate::program::{Folder, abbe, json, refused, text};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Three linear axes of 400 mm, the workpiece at (10, 20, 30), and one squareness.
fn three(folder: &Folder, squareness: &str) -> PathBuf {
    let axes = "{ X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 400], origin: [0, 0, 0] }, Z: { travel: [0, 400], origin: [0, 0, 0] } }";
    folder.with(
        "three.yaml",
        &format!(
            "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {axes}\nworkpiece: {{ origin: [10, 20, 30] }}\nerrors: {{ EC0Y: {squareness} }}\n"
        ),
    )
}

/// The tool poses that `compare` gives machines at random, as a file: X, Y, Z, I, J, K.
fn drawn(folder: &Folder, machine: &str, count: &str) -> PathBuf {
    let csv = abbe(&["compare", machine, machine, "--poses", count, "--seed", "3", "--format", "csv"]);
    let mut rows = "X [mm], Y, Z, I, J, K\n".to_owned();
    for line in csv.lines().skip(1).step_by(2) {
        rows += &(line.split(',').skip(2).take(6).collect::<Vec<_>>().join(",") + "\n");
    }
    folder.with("drawn.csv", &rows)
}

/// Rows of numbers of a CSV file; an empty last cell is none.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let numbers = |line: &str| line.trim_end_matches(',').split(',').map(|cell| cell.parse().unwrap()).collect();
    text.lines().skip(1).map(numbers).collect()
}

#[test]
fn tips_count_from_the_workpiece_origin_and_units_are_read() {
    let folder = Folder::new("tool-poses");
    let machine = three(&folder, "20 urad");
    let file = folder
        .with("work.csv", "# exported\r\nZ [m], X [um], Y\r\n\r\n0.1, 50000, 60\r\n0.2, -10000, 0\r\n0.3, 0, -20\r\n");
    let out = folder.file("map.csv");
    let map = json(&["map", text(&machine), "--tool-poses", text(&file), "--csv", text(&out), "--format", "json"]);
    let found = rows(&out);
    // Lines of the file come first: two of its seven are a comment and blank.
    assert_eq!(found.iter().map(|row| row[0]).collect::<Vec<_>>(), [4.0, 5.0, 6.0]);
    let found: Vec<Vec<f64>> = found.into_iter().map(|row| row[1..].to_vec()).collect();
    for (row, (pose, y)) in
        found.iter().zip([([60.0, 80.0, 130.0], 80.0), ([0.0, 20.0, 230.0], 20.0), ([10.0, 0.0, 330.0], 0.0)])
    {
        assert_eq!(row[..3], pose);
        // A squareness of EC0Y moves the tool by -EC0Y y in x; its square is 4e-10 of y.
        assert!((row[3] + 20e-3 * y).abs() < 1e-6, "{row:?}");
    }
    assert_eq!(
        (found.len(), &map["tool_poses"]["asked"], &map["tool_poses"]["unreachable"]["total"]),
        (3, &3.into(), &0.into())
    );
    assert!((number(&map["position_um"]["max"]) - 1.6).abs() < 1e-6);
    let said = abbe(&["map", text(&machine), "--tool-poses", text(&file)]);
    assert!(said.contains("3 poses (tool poses of ") && !said.contains("out of reach"), "{said}");
}

#[test]
fn rotary_columns_are_where_the_rotary_axes_go() {
    let folder = Folder::new("tool-poses-rotary");
    for machine in ["trunnion.yaml", "ht-b-c.yaml", "hh-ca-gantry.yaml"] {
        let (first, second) = if machine == "ht-b-c.yaml" { ("B", "C") } else { ("A", "C") };
        let map = folder.file("map.csv");
        abbe(&["map", machine, "--random", "40", "--csv", text(&map)]);
        let header = std::fs::read_to_string(&map).unwrap().lines().next().unwrap().to_owned();
        let names: Vec<String> = header.split(',').map(|cell| cell.split(' ').next().unwrap().to_owned()).collect();
        let at = |name: &str| names.iter().position(|n| n == name).unwrap();
        let axes = names.len() - 6;
        let poses: Vec<Vec<f64>> = rows(&map).into_iter().map(|row| row[..axes].to_vec()).collect();
        let cells = |pose: &Vec<f64>| pose.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n";
        let asked: String = poses.iter().map(cells).collect();
        let file = folder.with("poses.csv", &format!("{}\n{asked}", names[..axes].join(",")));
        // Place of the nominal tool, by `eval`.
        let answers = json(&["eval", machine, "--poses", text(&file), "--format", "json"]);
        let row = |(answer, pose): (&Value, &Vec<f64>)| {
            let tip: Vec<String> = (0..3).map(|k| number(&answer["nominal"][k]).to_string()).collect();
            format!("{},{},{}\n", tip.join(","), pose[at(first)], pose[at(second)])
        };
        let work: String = answers["poses"].as_array().unwrap().iter().zip(&poses).map(row).collect();
        let file = folder.with("work.csv", &format!("X,Y,Z,{first} [deg],{second}\n{work}"));
        let out = folder.file("again.csv");
        abbe(&["map", machine, "--tool-poses", text(&file), "--csv", text(&out)]);
        let again = rows(&out);
        assert_eq!(again.len(), poses.len(), "{machine}");
        for (a, b) in again.iter().zip(&poses) {
            let far = a[1..].iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(far < 1e-9, "{machine}: {a:?} {b:?}");
        }
    }
}

#[test]
fn work_that_was_drawn_and_the_same_from_a_file_compare_alike() {
    let folder = Folder::new("tool-poses-compare");
    let file = drawn(&folder, "trunnion.yaml", "120");
    let of = |work: &[&str]| {
        let class = ["--class", "production", "--samples", "40", "--seed", "3", "--format", "json", "--quiet"];
        json(&[&["compare", "trunnion.yaml", "ht-b-c.yaml"], work, &class].concat())
    };
    let (ours, theirs) = (of(&["--tool-poses", text(&file)]), of(&["--poses", "120"]));
    assert_eq!(ours["poses"], theirs["poses"]);
    for i in 0..2 {
        let (a, b) = (&ours["machines"][i], &theirs["machines"][i]);
        assert_eq!(a["unreachable"], b["unreachable"]);
        for key in ["max", "rms", "p95"] {
            // Digits of the file are all there; a direction is normalised again.
            let (a, b) = (number(&a["position_um"][key]), number(&b["position_um"][key]));
            assert!((a - b).abs() < 1e-9, "{key}: {a} {b}");
        }
        let p95 = |of: &Value| number(&of["budgets"]["machines"][i]["position_um"]["monte_carlo"]["p95"]);
        assert!((p95(&ours) - p95(&theirs)).abs() < 1e-8);
    }
    let missed = ours["machines"][1]["unreachable"]["total"].as_u64().unwrap();
    assert!(missed > 10);
    // One warning for the machine, at the first of them.
    let warnings: Vec<&Value> =
        ours["warnings"].as_array().unwrap().iter().filter(|w| w["code"] == "W0608").collect();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0]["place"]["file"].as_str().unwrap().ends_with("drawn.csv"));
    assert!(warnings[0]["message"].as_str().unwrap().contains(&format!("does not reach {missed} of 120 tool poses: ")));
    assert_eq!(ours["machines"][1]["missed"].as_array().unwrap().len() as u64, missed);
    assert_eq!(ours["machines"][1]["missed"][0]["line"], warnings[0]["place"]["line"]);
}

#[test]
fn arrangements_are_ranked_on_the_work_of_a_file() {
    let folder = Folder::new("tool-poses-enumerate");
    let file = drawn(&folder, "vmc-cframe-754.yaml", "60");
    let of = |work: &[&str]| {
        json(&[&["enumerate", "vmc-cframe-754.yaml"], work, &["--seed", "3", "--format", "json"]].concat())
    };
    let (ours, theirs) = (of(&["--tool-poses", text(&file)]), of(&["--poses", "60"]));
    let chains = |of: &Value| -> Vec<(String, f64)> {
        let row = |r: &Value| (r["chain"].as_str().unwrap().to_owned(), (number(&r["um"]) * 1e6).round());
        of["ranked"].as_array().unwrap().iter().map(row).collect()
    };
    assert_eq!(chains(&ours), chains(&theirs));
    assert_eq!(ours["tool_poses"]["reached"], 60);
    // Another work is another study: its state file is refused.
    let state = folder.file("state");
    let shard = |work: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
        command.current_dir("configs").args(["enumerate", "vmc-cframe-754.yaml", "--shard", "1/2"]);
        command.arg("--state").arg(&state).arg("--tool-poses").arg(work).output().unwrap()
    };
    assert!(shard(&file).status.success());
    let other = folder.with("other.csv", "X,Y,Z\n0,0,100\n10,0,100\n");
    let output = shard(&other);
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("E0610"));
}

#[test]
fn a_budget_at_a_tool_pose_is_the_closed_form() {
    let folder = Folder::new("tool-poses-budget");
    let machine = three(&folder, "{ tolerance: 20 urad }");
    let file = folder.with("work.csv", "X,Y,Z\n0,80,0\n5,30,10\n");
    let b = json(&["budget", text(&machine), "--tool-poses", text(&file), "--samples", "20", "--format", "json"]);
    // Y is 20 mm more than the tip's y.
    assert!((number(&b["position_um"]["worst_case"]) - 20e-3 * 100.0).abs() < 1e-9);
    assert_eq!((&b["poses"], &b["tool_poses"]["asked"]), (&2.into(), &2.into()));
}

#[test]
fn what_is_out_of_reach_is_named_and_what_is_wrong_refused() {
    let folder = Folder::new("tool-poses-refused");
    let machine = three(&folder, "20 urad");
    let file = folder.with("work.csv", "X,Y,Z,I,J,K\n0,0,0,0,0,1\n900,0,0,0,0,1\n0,0,0,0,1,1\n0,0,5,0,0,2e300\n");
    let map = json(&["map", text(&machine), "--tool-poses", text(&file), "--format", "json", "--quiet"]);
    assert_eq!((&map["poses"], &map["tool_poses"]["unreachable"]["total"]), (&2.into(), &2.into()));
    assert_eq!(
        map["tool_poses"]["rows"],
        serde_json::json!([
            {"line": 3, "why": "travel", "beyond": [{"axis": "X", "by": 510.0, "unit": "mm"}]},
            {"line": 4, "why": "direction", "off_deg": 45.0}
        ])
    );
    let (code, message) = refused(&["map", text(&machine), "--tool-poses", text(&file), "--deny", "warnings"]);
    assert!(code == 1 && message.contains("W0608") && message.contains("work.csv:3:1"), "{message}");
    let nowhere = folder.with("nowhere.csv", "X,Y,Z\n900,0,0\n901,0,0\n");
    let (code, message) = refused(&["budget", text(&machine), "--class", "production", "--tool-poses", text(&nowhere)]);
    assert!(code == 1 && message.contains("E0613"), "{message}");
    assert!(message.contains("reaches none of the 2 tool poses: X short by up to 511 mm above 400 mm (2 rows)"), "{message}");
    for (content, said) in [
        ("", "no header"),
        ("X,Y,Z\n", "no tool poses"),
        ("X,Y\n1,2\n", "X, Y and Z are needed"),
        ("X,Y,Z,I,J\n1,2,3,0,1\n", "I, J and K"),
        ("X,Y,Z,X\n1,2,3,4\n", "twice"),
        ("X,Y,Z,A\n1,2,3,4\n", "neither"),
        ("X,Y,Z [deg]\n1,2,3\n", "not a unit for `Z`"),
        ("X,Y,Z\n1,2\n", "2 cells under 3 columns"),
        ("X,Y,Z\n1,2,nan\n", "nan"),
        ("X,Y,Z\n1,2,1e9\n", "beyond 1000000"),
        ("X,Y,Z,I,J,K\n1,2,3,0,0,0\n", "zero"),
    ] {
        let wrong = folder.with("wrong.csv", content);
        let (code, message) = refused(&["map", text(&machine), "--tool-poses", text(&wrong)]);
        assert!(code == 1 && message.contains("E0817") && message.contains(said), "{content:?}: {message}");
    }
    let twice = folder.with("twice.csv", "X,Y,Z,I,J,K,C\n1,2,3,0,0,1,0\n");
    let (code, message) = refused(&["map", "trunnion.yaml", "--tool-poses", text(&twice)]);
    assert!(code == 1 && message.contains("given twice"), "{message}");
    assert_eq!(refused(&["map", "trunnion.yaml", "--tool-poses", text(&twice), "--random", "5"]).0, 2);
    let missing = folder.file("missing.csv");
    assert_eq!(refused(&["map", "trunnion.yaml", "--tool-poses", text(&missing)]).0, 1);
}
