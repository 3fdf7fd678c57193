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

/// The map over tool poses as JSON, without what a set-up of the part takes out.
fn map_in_machine_coordinates(machine: &Path, work: &Path) -> Value {
    let reference = ["--reference", "machine", "--format", "json", "--quiet"];
    json(&[&["map", text(machine), "--tool-poses", text(work)], &reference[..]].concat())
}

#[test]
fn tips_count_from_the_workpiece_origin_and_units_are_read() {
    let folder = Folder::new("tool-poses");
    let machine = three(&folder, "20 urad");
    let file = folder
        .with("work.csv", "# exported\r\nZ [m], X [um], Y\r\n\r\n0.1, 50000, 60\r\n0.2, -10000, 0\r\n0.3, 0, -20\r\n");
    let out = folder.file("map.csv");
    let map = json(&[
        "map",
        text(&machine),
        "--reference",
        "machine",
        "--tool-poses",
        text(&file),
        "--csv",
        text(&out),
        "--format",
        "json",
    ]);
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
    let said = abbe(&["map", text(&machine), "--reference", "machine", "--tool-poses", text(&file)]);
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
        abbe(&["map", machine, "--reference", "machine", "--tool-poses", text(&file), "--csv", text(&out)]);
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
    let (ours, theirs) = (of(&["--reference", "machine", "--tool-poses", text(&file)]), of(&["--poses", "120"]));
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
    let warnings: Vec<&Value> = ours["warnings"].as_array().unwrap().iter().filter(|w| w["code"] == "W0608").collect();
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
    let same = ["--tool-poses", text(&file), "--reference", "machine"];
    let (ours, theirs) = (of(&same), of(&["--poses", "60", "--reference", "machine"]));
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
    let b = json(&[
        "budget",
        text(&machine),
        "--reference",
        "machine",
        "--tool-poses",
        text(&file),
        "--samples",
        "20",
        "--format",
        "json",
    ]);
    // Y is 20 mm more than the tip's y.
    assert!((number(&b["position_um"]["worst_case"]) - 20e-3 * 100.0).abs() < 1e-9);
    assert_eq!((&b["poses"], &b["tool_poses"]["asked"]), (&2.into(), &2.into()));
}

#[test]
fn what_is_out_of_reach_is_named_and_what_is_wrong_refused() {
    let folder = Folder::new("tool-poses-refused");
    let machine = three(&folder, "20 urad");
    let file = folder.with("work.csv", "X,Y,Z,I,J,K\n0,0,0,0,0,1\n900,0,0,0,0,1\n0,0,0,0,1,1\n0,0,5,0,0,2e300\n");
    let map = json(&[
        "map",
        text(&machine),
        "--reference",
        "machine",
        "--tool-poses",
        text(&file),
        "--format",
        "json",
        "--quiet",
    ]);
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
    assert!(
        message.contains("reaches none of the 2 tool poses: X short by up to 511 mm above 400 mm (2 rows)"),
        "{message}"
    );
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

/// Three linear axes of 400 mm and two squarenesses: -20e-6 y in x, 30e-6 z in x.
fn squares(folder: &Folder) -> PathBuf {
    let axis = |name: &str| format!("{name}: {{ travel: [0, 400], origin: [0, 0, 0] }}");
    let text = format!(
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {{ {}, {}, {} }}\nerrors: {{ EC0Y: 20 urad, EB0Z: 30 urad }}\n",
        axis("X"),
        axis("Y"),
        axis("Z")
    );
    folder.with("squares.yaml", &text)
}

#[test]
fn a_table_of_any_case_separator_and_unit_is_read() {
    let folder = Folder::new("tool-poses-any");
    let machine = three(&folder, "20 urad");
    let same = "X,Y,Z,I,J,K\n25.4,50.5,100,0,0,1\n0,60,200,0,0,1\n";
    let map = |content: &str| {
        let (work, out) = (folder.with("work.csv", content), folder.file("map.csv"));
        abbe(&["map", text(&machine), "--reference", "machine", "--tool-poses", text(&work), "--csv", text(&out)]);
        let csv = std::fs::read_to_string(&out).unwrap();
        csv.lines().map(|line| line.split(',').skip(1).collect::<Vec<_>>().join(",")).collect::<Vec<_>>()
    };
    let plain = map(same);
    for content in [
        "x (inch);y_mm;z/cm;i;j;k\n1;50,5;10;0;0;1\n0;60;20;0;0;1;;\n",
        "\u{feff}Z\tY\tX [MM]\tK\tJ\tI\n100\t50.5\t25.4\t1\t0\t0\n200\t60\t0\t2\t0\t0\n",
        "// from a spreadsheet\r\n\"x\",\"y\",\"z\"\r\n25.4,50.5,100\r\n0,60,200\r\n",
    ] {
        assert_eq!(map(content), plain, "{content}");
    }
    let wrong = folder.with("wrong.csv", "x;y;z\n1,5;2.5;3\n");
    let (code, message) = refused(&["map", text(&machine), "--tool-poses", text(&wrong)]);
    assert!(code == 1 && message.contains("E0817") && message.contains("decimal comma"), "{message}");
}

#[test]
fn rows_keep_their_lines_and_the_unreached_in_csv_and_json() {
    let folder = Folder::new("tool-poses-lines");
    let machine = three(&folder, "20 urad");
    let work =
        folder.with("work.csv", "X,Y,Z,feature\n\n900,0,0,pocket\n0,0,0,pocket\n0,-30,700,\"a, b\"\n5,0,5,rib\n");
    let (csv, rows) = (folder.file("map.csv"), folder.file("map.json"));
    let run = [
        "map",
        text(&machine),
        "--reference",
        "machine",
        "--tool-poses",
        text(&work),
        "--csv",
        text(&csv),
        "--json",
        text(&rows),
        "--quiet",
    ];
    let said = abbe(&run);
    let csv = std::fs::read_to_string(&csv).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(
        lines[0],
        "line,feature,X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um],wx [urad],wy [urad],wz [urad],unreached"
    );
    assert_eq!(lines[1], "3,pocket,,,,,,,,,,X 510 mm above its travel");
    assert!(lines[2].starts_with("4,pocket,10,20,30,") && lines[2].ends_with(','), "{}", lines[2]);
    assert_eq!(lines[3], "5,\"a, b\",,,,,,,,,,\"Y 10 mm below its travel, Z 330 mm above its travel\"");
    assert!(lines[4].starts_with("6,rib,15,20,35,") && lines.len() == 5);
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&rows).unwrap()).unwrap();
    let rows = rows["poses"].as_array().unwrap();
    let of = |key: &str| rows.iter().map(|row| row[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("line"), [3, 4, 5, 6].map(Value::from));
    assert_eq!(rows[2]["beyond"][0], serde_json::json!({"axis": "Y", "by": -10.0, "unit": "mm"}));
    assert_eq!(rows[1]["axes"]["Z"], 30.0);
    // The travel that the work needs: of what is reached and what is not.
    let map = map_in_machine_coordinates(&machine, &work);
    let travel = serde_json::json!([
        {"axis": "X", "unit": "mm", "needs": [10.0, 910.0], "has": [0.0, 400.0], "short": [0.0, 510.0]},
        {"axis": "Y", "unit": "mm", "needs": [-10.0, 20.0], "has": [0.0, 400.0], "short": [10.0, 0.0]},
        {"axis": "Z", "unit": "mm", "needs": [30.0, 730.0], "has": [0.0, 400.0], "short": [0.0, 330.0]}
    ]);
    assert_eq!(map["tool_poses"]["travel"], travel);
    assert!(said.contains("line 5 (a, b): Y 10 mm below its travel, Z 330 mm above its travel"), "{said}");
    assert!(said.contains("| X, mm | 10 to 910 | 0 to 400 | 510 above |"), "{said}");
}

#[test]
fn cl_data_is_read_and_features_are_judged_one_by_one() {
    let folder = Folder::new("tool-poses-apt");
    let machine = squares(&folder);
    let cl = "PARTNO PLATE\n$$ ---\nUNITS/INCH\nMULTAX/ON\nRAPID\nGOTO/1,2,3,0,0,1\n$$ Pocket A\nFEDRAT/300,MMPM\n\
              GOTO/ 1, 2.0, $\n  1\nGODLTA/0,0,-1\ngoto/1,8,0 $$ Rib\nPPRINT Rib B\nGOTO/10,0,5,0,0,2\nGOTO/100,0,0\nFINI\n";
    let work = folder.with("part.cls", cl);
    let map = map_in_machine_coordinates(&machine, &work);
    assert_eq!((&map["tool_poses"]["asked"], &map["tool_poses"]["reached"]), (&6.into(), &5.into()));
    assert_eq!(map["tool_poses"]["rows"][0]["line"], 15);
    let features = map["features"].as_array().unwrap();
    let names: Vec<&str> = features.iter().map(|f| f["feature"].as_str().unwrap()).collect();
    assert_eq!(names, ["(rapid)", "Pocket A", "Rib", "Rib B"]);
    // x is moved by -20e-6 y + 30e-6 z, inches of 25.4 mm.
    let dx = |y: f64, z: f64| ((-20e-3 * y + 30e-3 * z) * 25.4).abs();
    let wanted = [(dx(2.0, 3.0), 6), (dx(2.0, 0.0).max(dx(2.0, 1.0)), 11), (dx(8.0, 0.0), 12), (dx(0.0, 5.0), 14)];
    for (feature, (um, line)) in features.iter().zip(wanted) {
        assert!((number(&feature["max_um"]) - um).abs() < 1e-6, "{feature}");
        assert_eq!(feature["line"], line, "{feature}");
    }
    assert_eq!((&features[1]["poses"], &features[3]["unreached"]), (&2.into(), &1.into()));
    let part =
        |f: &Value, k: usize| (f["errors"][k]["error"].as_str().unwrap().to_owned(), number(&f["errors"][k]["um"]));
    let (name, um) = part(&features[2], 0);
    assert!(name == "EC0Y" && (um - dx(8.0, 0.0)).abs() < 1e-9, "{name} {um}");
    let ((a, of_a), (b, of_b)) = (part(&features[0], 0), part(&features[0], 1));
    assert!(a == "EB0Z" && b == "EC0Y" && (of_a - 90e-3 * 25.4).abs() < 1e-9 && (of_b + 40e-3 * 25.4).abs() < 1e-9);
    let said = abbe(&["map", text(&machine), "--reference", "machine", "--tool-poses", text(&work), "--quiet"]);
    assert!(said.contains("Largest deviation on each feature") && said.contains("| Pocket A | 2      |"), "{said}");
    for (content, why) in [
        ("TRACUT/1,0,0,0,0,1,0,0,0,0,1,0\nGOTO/1,2,3\n", "`TRACUT` is not followed"),
        ("GOTO/1,2\n", "3 or 6 are expected"),
        ("GOTO/1,2,3\nUNITS/INCH\n", "the unit changes"),
        ("GODLTA/1,2,3\nGOTO/1,2,3\n", "before the first position"),
        ("GOTO/1,2,3,0,0,0\n", "no direction"),
    ] {
        let wrong = folder.with("wrong.cls", content);
        let (code, message) = refused(&["map", text(&machine), "--tool-poses", text(&wrong)]);
        assert!(code == 1 && message.contains("E0817") && message.contains(why), "{content:?}: {message}");
    }
    // The page has the same.
    let page = folder.file("page.html");
    let run =
        ["report", text(&machine), "--tool-poses", text(&work), "--samples", "20", "--out", text(&page), "--quiet"];
    abbe(&run);
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("Largest deviation on each feature") && page.contains("Rib B"));
}

#[test]
fn a_study_takes_the_travel_that_the_work_needs() {
    let folder = Folder::new("tool-poses-size");
    // The machine of the file is far too small for the work.
    let axis = |name: &str| format!("{name}: {{ travel: [0, 10], origin: [0, 0, 0] }}");
    let text_of = format!(
        "abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes: {{ {}, {}, {} }}\nerrors: {{ EC0Y: {{ tolerance: 20 urad }} }}\n",
        axis("X"),
        axis("Y"),
        axis("Z")
    );
    let machine = folder.with("small.yaml", &text_of);
    let work = folder.with("work.csv", "X,Y,Z\n-50,0,30\n250,80,0\n100,-20,90\n");
    let run = ["enumerate", text(&machine), "--tool-poses", text(&work), "--samples", "40", "--size", "--format"];
    let study = json(&[&run[..], &["json"]].concat());
    assert_eq!((&study["tool_poses"]["reached"], study["ranked"].as_array().unwrap().len()), (&3.into(), 24));
    for row in study["ranked"].as_array().unwrap() {
        let span = |name: &str| number(&row["travel"][name][1]) - number(&row["travel"][name][0]);
        let spans = [span("X"), span("Y"), span("Z")];
        assert!(spans.iter().zip([300.0, 100.0, 90.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{row}");
    }
    let said = abbe(&[&run[..], &["text"]].concat());
    assert!(said.contains("X 300") && said.contains("travel needed, mm or deg"), "{said}");
    let csv = abbe(&[&run[..], &["csv"]].concat());
    assert!(csv.lines().next().unwrap().contains(",travel [mm or deg],") && csv.contains("X -50 250"), "{csv}");
    // Errors with values end with the travel.
    let valued = three(&folder, "20 urad");
    let (code, message) = refused(&["enumerate", text(&valued), "--size"]);
    assert!(code == 2 && message.contains("--size"), "{message}");
}
