//! The job in every verb: arrangements, reach, differences, certificates and the report on the part as it is set up,
//! against closed forms of machines with a scale and with a squareness alone.

use crate::program::{Folder, abbe, json, refused, text};
use crate::support::packed::data;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn near(found: &Value, truth: f64) {
    assert!((number(found) - truth).abs() < 1e-6 * truth.abs().max(1.0), "{found} {truth}");
}

/// A machine of three linear axes with these lines; the axes run from -300 to 300 mm.
fn three(folder: &Folder, name: &str, lines: &str) -> PathBuf {
    let axis = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(axis).concat();
    folder.with(name, &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}{lines}\n"))
}

/// 20 um per 100 mm of X, and 50 um everywhere.
const SCALE: &str = "errors: { EXX: { points: [[-300 mm, -60 um], [300 mm, 60 um]] } }\n\
                     setup: { workpiece: { X: -50 um } }";

/// Tool poses along X at -100, 0, 50 and 200 mm.
fn along_x(folder: &Folder) -> PathBuf {
    folder.with("x.csv", "X,Y,Z\n-100,0,0\n0,0,0\n50,0,0\n200,0,0\n")
}

/// A job of these whose part lies at X = 50.
fn job(folder: &Folder) -> PathBuf {
    let _ = folder.with("part.csv", "X,Y,Z\n-150,0,0\n-50,0,0\n0,0,0\n150,0,0\n");
    folder.with("job.yaml", "tool_poses: part.csv\nplace: { origin: [50, 0, 0] }\n")
}

#[test]
fn arrangements_are_ranked_on_the_part_as_it_is_set_up() {
    let folder = Folder::new("job-enumerate");
    let machine = three(&folder, "m.yaml", SCALE);
    let (work, job) = (along_x(&folder), job(&folder));
    let ranked = |more: &[&str]| {
        let found = json(&[&["enumerate", text(&machine), "--format", "json"], more].concat());
        let um: Vec<f64> = found["ranked"].as_array().unwrap().iter().map(|row| number(&row["um"])).collect();
        assert!(um.len() > 4, "{found}");
        (um, found)
    };
    let all = |um: &[f64], truth: f64| assert!(um.iter().all(|um| (um - truth).abs() < 1e-6), "{um:?} {truth}");
    let work = text(&work);
    // -20, 0, 10 and 40 um by the scale: with the shift up to 90 or 70 um, by the side of the bed on which X stands;
    // with the zero at X = 0 40 um; at X = 50 30 um; a best fit leaves them less their mean, 7.5 um.
    let (um, _) = ranked(&["--tool-poses", work, "--reference", "machine"]);
    assert!(um.iter().all(|um| (um - 90.0).abs() < 1e-6 || (um - 70.0).abs() < 1e-6), "{um:?}");
    let (um, found) = ranked(&["--tool-poses", work]);
    all(&um, 40.0);
    let over =
        serde_json::json!({"kind": "job", "reference": "zero", "path": false, "poses": 4, "reached": 4, "tool": ""});
    assert_eq!(found["over"], over);
    let rows = found["ranked"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["minus_file"].as_f64().unwrap().abs() < 1e-6), "{found}");
    assert!(rows[1..].iter().all(|row| row["versus_first"]["verdict"] == "equal"), "{found}");
    all(&ranked(&["--job", text(&job)]).0, 30.0);
    all(&ranked(&["--tool-poses", work, "--reference", "best-fit"]).0, 32.5);
}

#[test]
fn bounded_arrangements_are_drawn_without_the_motion() {
    let folder = Folder::new("job-enumerate-bounds");
    let machine = three(&folder, "m.yaml", "errors: { EC0Y: { tolerance: 100 urad } }");
    let work = folder.with("y.csv", "X,Y,Z\n0,-150,0\n0,20,0\n0,100,0\n");
    let um = |reference: &str| {
        let arguments = ["enumerate", text(&machine), "--tool-poses", text(&work), "--reference", reference];
        let found = json(&[&arguments[..], &["--samples", "50", "--format", "json"]].concat());
        let rows: Vec<f64> = found["ranked"].as_array().unwrap().iter().map(|row| number(&row["um"])).collect();
        let first = rows[0];
        assert!(rows.len() > 4 && rows.iter().all(|um| (um - first).abs() < 1e-6), "{rows:?}");
        first
    };
    // A drawn squareness s moves a tip by s y: the largest |y| is 150, from the zero at Y = 100 it is 250.
    let [machine_um, zero, shifted, fit] = ["machine", "zero", "zero:0,100,0", "best-fit"].map(um);
    assert!(machine_um > 5.0 && machine_um <= 15.0, "{machine_um}");
    assert!((zero / machine_um - 1.0).abs() < 1e-9 && (shifted / machine_um - 250.0 / 150.0).abs() < 1e-9);
    assert!(fit < 1e-9, "what is a rotation of a line is no error of its form: {fit}");
}

#[test]
fn a_volume_is_ranked_in_machine_coordinates_and_by_the_best_fit() {
    let folder = Folder::new("job-enumerate-both");
    let lines = "errors: { EXX: { tolerance: 8 um }, EC0Y: { tolerance: 60 urad }, EB0Z: { tolerance: 30 urad }, \
                 EA0Z: { tolerance: 40 urad }, EYX: { tolerance: 6 um } }";
    let machine = three(&folder, "m.yaml", lines);
    let arguments = ["enumerate", text(&machine), "--poses", "30", "--samples", "60", "--max-samples", "60"];
    let of = |more: &[&str]| json(&[&arguments[..], more, &["--format", "json"]].concat());
    let [both, alone, fitted] = [&[][..], &["--reference", "machine"], &["--reference", "best-fit"]].map(of);
    let figure = |of: &Value, chain: &Value| {
        let rows = of["ranked"].as_array().unwrap();
        number(&rows.iter().find(|row| row["chain"] == *chain).unwrap()["um"])
    };
    let mut withheld = 0;
    for row in both["ranked"].as_array().unwrap() {
        near(&row["um"], figure(&alone, &row["chain"]));
        near(&row["best_fit"]["um"], figure(&fitted, &row["chain"]));
        let [own, fit] = [&row["versus_first"]["verdict"], &row["best_fit"]["versus_first"]["verdict"]];
        assert_eq!(row.get("withheld").is_some(), own != fit, "{row}");
        withheld += usize::from(row.get("withheld").is_some());
    }
    assert!(alone["ranked"][0].get("best_fit").is_none() && both["over"]["reference"] == "machine");
    let said = abbe(&arguments);
    assert!(said.contains("best fit, um") && said.contains("reference: machine coordinates"), "{said}");
    assert_eq!(said.contains("without a verdict"), withheld > 0);
}

#[test]
fn an_arrangement_that_misses_the_zero_has_no_figure() {
    let folder = Folder::new("job-enumerate-zero");
    let side = "chain: \"w b X Y Z t\"\naxes:\n  X: { travel: [-300, 300], origin: [0, 0, 0], on_workpiece: { travel: [-80, 80] } }\n  \
                Y: { travel: [-300, 300], origin: [0, 0, 0] }\n  Z: { travel: [-300, 300], origin: [0, 0, 0] }\n";
    let machine = folder.with("m.yaml", &format!("abbe: 1\nmachine: M\n{side}{SCALE}\n"));
    let work = folder.with("w.csv", "X,Y,Z\n-50,0,0\n50,0,0\n");
    let arguments = ["enumerate", text(&machine), "--tool-poses", text(&work), "--reference"];
    let found = json(&[&arguments[..], &["zero:150,0,0", "--format", "json"]].concat());
    let apart = found["reach_less"].as_array().unwrap();
    assert!(!apart.is_empty() && apart.iter().all(|row| row["misses_reference"] == true && row["um"].is_null()));
    assert!(
        apart.iter().all(|row| row["on_table"].as_u64().unwrap() > 0) && apart.iter().all(|row| row["reached"] == 2)
    );
    let (code, said) = refused(&[&arguments[..], &["zero:900,0,0"]].concat());
    assert!(code == 1 && said.contains("E0850"), "{said}");
}

#[test]
fn the_reach_of_a_job_counts_its_rows() {
    let folder = Folder::new("job-reach");
    let machine = three(&folder, "m.yaml", "");
    let work = folder.with("w.csv", "X,Y,Z,feature\n0,0,0,a\n310,0,0,b\n-100,50,0,b\n0,0,-350,c\n");
    let found = json(&["reach", text(&machine), "--tool-poses", text(&work), "--format", "json"]);
    assert_eq!((&found["tool_poses"], &found["reached"], &found["share"]), (&4.into(), &2.into(), &0.5.into()));
    assert_eq!((&found["over"]["kind"], &found["over"]["reached"]), (&"job".into(), &2.into()));
    let lines: Vec<&Value> = found["job"]["rows"].as_array().unwrap().iter().map(|row| &row["line"]).collect();
    assert_eq!(lines, [3, 5]);
    assert_eq!(found["box_mm"][0], serde_json::json!([-100.0, 310.0]));
    let csv = abbe(&["reach", text(&machine), "--tool-poses", text(&work), "--format", "csv"]);
    assert_eq!(csv.lines().skip(1).collect::<Vec<_>>(), ["0,0,0,1", "310,0,0,0", "-100,50,0,1", "0,0,-350,0"]);
    let none = folder.with("none.csv", "X,Y,Z\n400,0,0\n");
    let (code, said) = refused(&["reach", text(&machine), "--tool-poses", text(&none)]);
    assert_eq!(code, 0, "nothing in reach is an answer: {said}");
    let far = folder.with("far.yaml", "tool_poses: w.csv\nreference: zero:0,400,0\n");
    let (code, said) = refused(&["reach", text(&machine), "--job", text(&far)]);
    assert!(code == 0 && said.contains("W0850") && said.contains("above its travel"), "{said}");
    // An option goes over the job, as in the other verbs.
    let near = ["reach", text(&machine), "--job", text(&far), "--reference", "zero:0,50,0", "--format", "json"];
    assert_eq!(json(&near)["over"]["reference"], "zero");
    let beyond = ["reach", text(&machine), "--tool-poses", text(&work), "--reference", "zero:0,400,0"];
    let (code, said) = refused(&beyond);
    assert!(code == 0 && said.contains("W0850"), "{said}");
    for wrong in [vec!["--job", text(&far), "--step", "10 mm"], vec!["--reference", "zero"]] {
        let (code, _) = refused(&[&["reach", text(&machine)], &wrong[..]].concat());
        assert_eq!(code, 2, "{wrong:?}");
    }
    let volume = json(&["reach", text(&machine), "--step", "300 mm", "--format", "json"]);
    assert_eq!((&volume["over"]["kind"], &volume["over"]["poses"]), (&"volume".into(), &volume["tool_poses"]));
}

#[test]
fn differences_count_on_the_part_as_it_is_set_up() {
    let folder = Folder::new("job-diff");
    let (first, second) = (three(&folder, "a.yaml", ""), three(&folder, "b.yaml", SCALE));
    let (work, job) = (along_x(&folder), job(&folder));
    let of = |more: &[&str]| json(&[&["diff", text(&first), text(&second), "--format", "json"], more].concat());
    let effects = |found: &Value| -> Vec<f64> {
        found["differences"].as_array().unwrap().iter().map(|d| number(&d["minus_first_um"])).collect()
    };
    // Of four poses the 95 % value is the largest.
    let found = of(&["--tool-poses", text(&work)]);
    assert_eq!((&found["over"]["reference"], &found["over"]["kind"]), (&"zero".into(), &"job".into()));
    near(&found["minus_first_um"], 40.0);
    let list = effects(&found);
    assert!(list.iter().any(|um| um.abs() < 1e-6) && list.iter().any(|um| (um - 40.0).abs() < 1e-6), "{found}");
    near(&of(&["--job", text(&job)])["minus_first_um"], 30.0);
    near(&of(&["--job", text(&job), "--reference", "best-fit"])["minus_first_um"], 32.5);
    let whole = number(&of(&["--job", text(&job), "--reference", "machine"])["minus_first_um"]);
    assert!((whole - 90.0).abs() < 1e-6 || (whole - 70.0).abs() < 1e-6, "{whole}");
    let volume = of(&[]);
    assert_eq!((&volume["over"]["kind"], &volume["over"]["reference"]), (&"volume".into(), &"machine".into()));
    let folders = [folder.file("x"), folder.file("y")];
    let (code, said) = refused(&["diff", text(&first), text(&folders[0]), text(&folders[1]), "--job", text(&job)]);
    assert!(code == 2 && said.contains("not with two sets"), "{said}");
}

fn certificate(machine: &Path, out: &Path, verb: &str, more: &[&str]) -> Value {
    let fixed: &[&str] = if verb == "compile" {
        &["compile", text(machine), "--target", "grid-csv", "--out", text(out)]
    } else {
        &["verify", text(machine), text(out)]
    };
    json(&[fixed, &["--poses", "40", "--format", "json"], more].concat())
}

#[test]
fn a_certificate_has_figures_over_the_job_beside_those_over_the_volume() {
    let folder = Folder::new("job-certificate");
    let machine = three(&folder, "m.yaml", SCALE);
    let (job, out) = (job(&folder), folder.file("out"));
    let found = certificate(&machine, &out, "compile", &["--job", text(&job)]);
    assert_eq!((&found["over"]["kind"], &found["over"]["poses"]), (&"volume".into(), &40.into()));
    let over =
        serde_json::json!({"kind": "job", "reference": "zero", "path": false, "poses": 4, "reached": 4, "tool": ""});
    assert_eq!(found["job"]["over"], over);
    near(&found["job"]["uncompensated"]["position_um"]["max"], 30.0);
    // A grid of straight lines follows a straight scale, rounded to what a file holds.
    assert!(number(&found["job"]["compensated"]["position_um"]["max"]) < 0.02, "{found}");
    assert!(number(&found["uncompensated"]["position_um"]["max"]) > 60.0);
    let again = certificate(&machine, &out, "verify", &["--job", text(&job)]);
    assert_eq!((&again["job"], &again["over"]), (&found["job"], &found["over"]));
    let fit = certificate(&machine, &out, "verify", &["--job", text(&job), "--reference", "best-fit"]);
    near(&fit["job"]["uncompensated"]["position_um"]["max"], 32.5);
    let whole = certificate(&machine, &out, "verify", &[]);
    assert!(whole.get("job").is_none() && whole["compensated"] == found["compensated"]);
    let said = abbe(&["verify", text(&machine), text(&out), "--poses", "40", "--job", text(&job)]);
    let head = "Over a job of 4 tool poses, 4 reached, single poses; reference: zero at\n  (0, 0, 0) along";
    assert!(said.contains(head) && said.contains("machine coordinates"), "{said}");
    let (code, said) = refused(&["verify", text(&machine), text(&out), "--reference", "zero"]);
    assert!(code == 2 && said.contains("give a job too"), "{said}");
}

#[test]
fn certificates_and_reports_take_the_tool_of_the_job() {
    let folder = Folder::new("job-tool-sets");
    // The lever arm of a turn of Z is the tool's length, at which Z stands: 40 and 100 urad.
    let lines = "errors: { EBZ: { points: [[-300 mm, -150 urad], [300 mm, 150 urad]] } }\n\
         tools: { short: { gauge: [0, 0, 0], length: 80 mm }, long: { gauge: [0, 0, 0], length: 200 mm } }";
    let machine = three(&folder, "m.yaml", lines);
    let _ = along_x(&folder);
    for (tool, um) in [("short", 3.2), ("long", 20.0)] {
        let job = folder.with(
            &format!("{tool}.yaml"),
            &format!("tool_poses: x.csv\nreference: machine\ntool: {tool}\nlimit: 10 um\n"),
        );
        let out = folder.file(tool);
        for verb in ["compile", "verify"] {
            let found = certificate(&machine, &out, verb, &["--job", text(&job)]);
            assert_eq!(found["job"]["over"]["tool"], tool, "{verb}");
            near(&found["job"]["uncompensated"]["position_um"]["max"], um);
        }
        let page = folder.file("page.html");
        let _ = abbe(&["report", text(&machine), "--job", text(&job), "--out", text(&page), "--quiet"]);
        let html = std::fs::read_to_string(&page).unwrap();
        assert!(html.contains(&format!("tool: {tool}")), "{tool}");
        near(&data(&html)["machines"][0]["statistics"]["position_um"]["max"], um);
    }
}

#[test]
fn the_report_states_its_reference_and_has_the_figures_of_the_job() {
    let folder = Folder::new("job-report");
    let (machine, other) = (three(&folder, "m.yaml", SCALE), three(&folder, "o.yaml", "errors: { EC0Y: 80 urad }"));
    let (job, out) = (job(&folder), folder.file("page.html"));
    let page = |machines: &[&Path], more: &[&str]| {
        let machines: Vec<&str> = machines.iter().map(|path| text(path)).collect();
        let fixed = ["--poses", "60", "--out", text(&out), "--quiet"];
        abbe(&[&["report"], &machines[..], &fixed, more].concat());
        std::fs::read_to_string(&out).unwrap()
    };
    let html = page(&[&machine], &["--job", text(&job)]);
    assert!(
        html.contains("reference: zero at (0, 0, 0) along (0, 0, 1)") && html.contains("are in machine coordinates.")
    );
    let of = &data(&html)["machines"][0];
    near(&of["statistics"]["position_um"]["max"], 30.0);
    near(&of["worst"][0]["length_um"], 30.0);
    // The scale alone makes all of it.
    let scale = of["sources"].as_array().unwrap().iter().find(|source| source["error"] == "EXX").unwrap();
    near(&scale["max_um"], 30.0);
    near(&scale["at_worst_um"], 30.0);
    let fit = data(&page(&[&machine], &["--job", text(&job), "--reference", "best-fit"]));
    near(&fit["machines"][0]["statistics"]["position_um"]["max"], 32.5);
    let both = data(&page(&[&machine, &other], &["--job", text(&job)]));
    near(&both["comparison"]["machines"][0]["position_um"]["max"], 30.0);
    near(&both["comparison"]["machines"][1]["position_um"]["max"], 0.0);
    assert_eq!(both["comparison"]["over"]["reference"], "zero");
    let volume = page(&[&machine], &[]);
    assert!(volume.contains("reference: machine coordinates") && !volume.contains("are in machine coordinates."));
}

#[test]
fn the_job_of_a_machine_file_counts_where_no_other_is_named() {
    let folder = Folder::new("job-own");
    let other = folder.with("other.csv", "X,Y,Z\n0,0,0\n100,0,0\n");
    let _ = job(&folder);
    let lines = format!("{SCALE}\njob: {{ tool_poses: part.csv, place: {{ origin: [50, 0, 0] }}, limit: 30.5 um }}");
    let machine = three(&folder, "m.yaml", &lines);
    let of = |more: &[&str]| json(&[&["map", text(&machine), "--format", "json"], more].concat());
    let own = of(&[]);
    near(&own["position_um"]["max"], 30.0);
    assert_eq!((&own["over"]["kind"], &own["over"]["reference"]), (&"job".into(), &"zero".into()));
    assert_eq!((&own["limit"]["limit_um"], &own["limit"]["held"]), (&30.5.into(), &true.into()));
    let fitted = of(&["--reference", "best-fit"]);
    near(&fitted["position_um"]["max"], 32.5);
    assert_eq!(fitted["limit"]["held"], false);
    assert_eq!(of(&["--random", "20"])["over"]["kind"], "volume");
    assert_eq!(of(&["--job", "none"])["over"]["kind"], "volume");
    let (code, said) = refused(&["map", text(&machine), "--tool-poses", text(&other)]);
    assert!(code == 0 && said.contains("W0852") && said.contains("other.csv"), "{said}");
    let checks = |line: &str| {
        let machine = three(&folder, "c.yaml", line);
        refused(&["check", text(&machine)])
    };
    for (line, word) in [
        ("job: { tool_poses: absent.csv }", "absent.csv"),
        ("job: { tool_poses: part.csv, tool: long }", "which the machine does not have"),
        ("job: { tool_poses: part.csv, limit: 3 deg }", "no length above 0"),
        ("job: { tool_poses: part.csv, where: 1 }", "where"),
        ("job: { tool_poses: part.csv, reference: { kind: datum } }", "there are 0"),
    ] {
        let (code, said) = checks(line);
        assert!(code == 1 && said.contains(word), "{line}: {code} {said}");
    }
    let (code, said) = checks("job: { tool_poses: part.csv }");
    assert!(code == 0 && said.contains("no `tool`") && said.matches("warning[").count() == 1, "{said}");
}

/// The machine with a bounded squareness whose X reaches 80 mm to either side on the tool side, and 300 mm below the
/// part.
fn short_on_the_tool(folder: &Folder) -> PathBuf {
    let axes = "  X: { travel: [-80, 80], origin: [0, 0, 0], on_workpiece: { travel: [-300, 300] } }\n  \
                Y: { travel: [-300, 300], origin: [0, 0, 0] }\n  Z: { travel: [-300, 300], origin: [0, 0, 0] }\n";
    let errors = "errors: { EC0Y: { tolerance: 100 urad } }";
    folder.with("m.yaml", &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}{errors}\n"))
}

#[test]
fn what_the_file_alone_misses_stays_in_the_work_of_a_ranking() {
    let folder = Folder::new("job-enumerate-whole");
    let machine = short_on_the_tool(&folder);
    let work = folder.with("w.csv", "X,Y,Z\n0,20,0\n50,-40,0\n150,100,0\n");
    let arguments = ["enumerate", text(&machine), "--tool-poses", text(&work), "--samples", "50", "--quiet"];
    let found = json(&[&arguments[..], &["--format", "json"]].concat());
    assert_eq!((&found["poses"], &found["over"]["reached"]), (&3.into(), &2.into()));
    let (ranked, less) = (found["ranked"].as_array().unwrap(), found["reach_less"].as_array().unwrap());
    assert!(!ranked.is_empty() && !less.is_empty());
    // A drawn squareness s moves a tip by s y: over all |y| is 100 at most, where both reach it is 40.
    let file = number(&less[0]["um"]);
    for row in ranked {
        assert!(row["on_table"].as_u64().unwrap() > 0 && row["reached"] == 3, "{row}");
        near(&row["um"], 2.5 * file);
        assert!(number(&row["minus_file"]).abs() < 1e-6, "{row}");
    }
    for row in less {
        assert_eq!((&row["reached"], &row["unreachable"]["total"]), (&2.into(), &1.into()));
        near(&row["um"], file);
        assert!(number(&row["minus_file"]).abs() < 1e-6, "{row}");
    }
    assert!(less.iter().any(|row| row["chain"] == found["chain"]));
    let said = abbe(&arguments);
    assert!(said.contains("3 tool poses of") && said.contains("of which the file's arrangement misses 1"), "{said}");
    // What none reaches is no reason to rank fewer tool poses.
    let far = folder.with("far.csv", "X,Y,Z\n0,20,0\n50,-40,0\n150,100,0\n0,400,0\n");
    let arguments = ["enumerate", text(&machine), "--tool-poses", text(&far), "--samples", "50", "--quiet"];
    let found = json(&[&arguments[..], &["--format", "json"]].concat());
    assert_eq!((&found["poses"], &found["ranked"]), (&4.into(), &Value::Array(Vec::new())));
    let reached = |row: &Value| row["reached"].as_u64().unwrap();
    let counts: Vec<u64> = found["reach_less"].as_array().unwrap().iter().map(reached).collect();
    assert!(counts.contains(&3) && counts.contains(&2) && counts.iter().all(|n| *n == 3 || *n == 2), "{counts:?}");
    let said = abbe(&arguments);
    assert!(said.contains("No arrangement reaches all 4 tool poses; the most is 3, by w "), "{said}");
}

#[test]
fn a_job_takes_the_tool_that_it_names() {
    let folder = Folder::new("job-tool");
    let tools = "tools:\n  short: { gauge: [0, 0, 0], length: 80 mm }\n  long: { gauge: [0, 0, 0], length: 200 mm }\n";
    let errors = "errors: { EBZ: { points: [[-300 mm, 60 urad], [300 mm, 60 urad]] }, EC0Y: { tolerance: 10 urad } }";
    let machine = three(&folder, "m.yaml", &format!("{tools}{errors}"));
    let _ = along_x(&folder);
    let job = |name: &str, tool: &str| folder.with(name, &format!("tool_poses: x.csv\n{tool}reference: machine\n"));
    let (long, plain) = (job("long.yaml", "tool: long\n"), job("plain.yaml", ""));
    let with = |verb: &[&str], job: &Path, more: &[&str]| {
        json(&[verb, &["--job", text(job), "--format", "json", "--quiet"], more].concat())
    };
    let file = text(&machine);
    let verbs = [
        vec!["map", file],
        vec!["eval", file],
        vec!["reach", file],
        vec!["budget", file],
        vec!["enumerate", file],
        vec!["compare", file, file],
        vec!["diff", file, file],
        vec!["map", file, "--place", "X=0..10:2"],
    ];
    for verb in &verbs {
        let named = with(verb, &long, &[]);
        assert_eq!(named["over"]["tool"], "long", "{verb:?}");
        assert_eq!(with(verb, &plain, &[])["over"]["tool"], "short", "{verb:?}");
        if verb[0] != "diff" && verb[0] != "enumerate" {
            assert_eq!(named, with(verb, &plain, &["--tool", "long"]), "{verb:?}");
            // A tool that is asked for comes before that of the job.
            assert_eq!(with(verb, &long, &["--tool", "short"]), with(verb, &plain, &[]), "{verb:?}");
        }
        let missing = job("missing.yaml", "tool: longer\n");
        let (code, said) = refused(&[&verb[..], &["--job", text(&missing)]].concat());
        assert!(code == 1 && said.contains("E0851") && said.contains("`longer`"), "{verb:?}: {said}");
    }
    // A rotation of Z moves the tip by as much as the tool is long.
    let most = |job: &Path| number(&with(&["map", file], job, &[])["position_um"]["max"]);
    let [long_um, short_um] = [most(&long), most(&plain)];
    assert!((long_um / short_um - 200.0 / 80.0).abs() < 1e-6, "{long_um} {short_um}");
    // The job of a machine file too, and a machine that is compared has to have the tool.
    let own = three(&folder, "own.yaml", &format!("{tools}{errors}\njob: {{ tool_poses: x.csv, tool: long }}"));
    let of = |more: &[&str]| json(&[&["map", text(&own), "--format", "json", "--quiet"], more].concat());
    assert_eq!((&of(&[])["over"]["tool"], &of(&["--random", "5"])["over"]["tool"]), (&"long".into(), &"short".into()));
    assert_eq!(refused(&["check", text(&own)]).0, 0);
    let other = three(&folder, "other.yaml", errors);
    let (code, said) = refused(&["compare", file, text(&other), "--job", text(&long)]);
    assert!(code == 1 && said.contains("E0801") && said.contains("other.yaml"), "{said}");
}

#[test]
fn a_best_fit_of_fewer_than_three_poses_is_refused() {
    let folder = Folder::new("job-few");
    let machine = three(&folder, "m.yaml", SCALE);
    let of = |name: &str, rows: &str| {
        let work = folder.with(name, &format!("X,Y,Z\n{rows}"));
        refused(&["map", text(&machine), "--tool-poses", text(&work), "--reference", "best-fit"])
    };
    for (name, rows, words) in [
        ("one.csv", "10,20,30\n", "one pose leaves nothing"),
        ("same.csv", "10,20,30\n10,20,30\n10,20,30\n10,20,30\n", "one pose leaves nothing"),
        ("two.csv", "10,20,30\n40,20,30\n10,20,30\n", "two poses leaves one of the six numbers"),
    ] {
        let (code, said) = of(name, rows);
        assert!(code == 1 && said.contains("E0850") && said.contains(words), "{said}");
    }
    assert_eq!(of("three.csv", "10,20,30\n40,20,30\n10,70,30\n").0, 0);
}

#[test]
fn body_diagonals_are_of_a_volume() {
    let folder = Folder::new("job-diagonals");
    let machine = three(&folder, "m.yaml", SCALE);
    let job = job(&folder);
    let of = |more: &[&str]| json(&[&["map", text(&machine), "--format", "json"], more].concat());
    assert_eq!(of(&["--job", text(&job)])["diagonals"], Value::Array(Vec::new()));
    assert_eq!(of(&["--random", "20"])["diagonals"].as_array().unwrap().len(), 4);
    assert!(!abbe(&["map", text(&machine), "--job", text(&job)]).contains("Body diagonals"));
    assert!(abbe(&["map", text(&machine), "--random", "20"]).contains("Body diagonals"));
}

/// A path along Y with a row out of reach, lines 2 to 7, and a job of it.
fn along_y(folder: &Folder, more: &str) -> PathBuf {
    let _ = folder.with("y.csv", "X,Y,Z\n0,0,0\n0,50,0\n0,70,0\n0,150,0\n0,900,0\n0,-100,0\n");
    folder.with("y.yaml", &format!("tool_poses: y.csv\npath: true\n{more}"))
}

#[test]
fn a_path_has_its_largest_step_between_neighbours_in_reach() {
    let folder = Folder::new("job-steps");
    let job = along_y(&folder, "limit: 5 um\n");
    let step = |name: &str, lines: &str| {
        let machine = three(&folder, name, lines);
        let found = json(&["map", text(&machine), "--job", text(&job), "--format", "json", "--quiet"]);
        assert_eq!(found["path"]["deviation_step"]["lines"], serde_json::json!([4, 5]), "{found}");
        (found, abbe(&["map", text(&machine), "--job", text(&job), "--quiet"]))
    };
    // Out of square by 40 urad: from y = 70 to 150 mm the deviation changes by 3.2 um; from 150 to -100, by 10 um,
    // the path does not lead: the row between is out of reach.
    let (found, said) = step("values.yaml", "errors: { EC0Y: 40 urad }");
    near(&found["path"]["deviation_step"]["um"], 3.2);
    assert!(said.contains("Largest step between rows: 3.2 um, lines 4 to 5\n"), "{said}");
    // Bounded by it: every machine drawn has a step that is 80 of 150 parts of its largest deviation.
    let (found, said) = step("bounds.yaml", "tolerances: { EC0Y: 40 urad }");
    let um = number(&found["path"]["deviation_step"]["um"]);
    near(&found["bounds"]["position_um"]["monte_carlo"]["p95"], um * 150.0 / 80.0);
    assert!((0.9 * 3.2..3.2).contains(&um), "{um}");
    assert!(said.contains("Largest step between rows: 95 % of the machines within "), "{said}");
}

#[test]
fn the_report_budgets_the_job_and_judges_its_limit() {
    let folder = Folder::new("job-report-bounds");
    let job = along_y(&folder, "limit: 5 um\n");
    // In the plane of the part only the squareness of Y counts; over the volume that of Z makes most.
    let machine = three(&folder, "m.yaml", "tolerances: { EC0Y: 40 urad, EB0Z: 100 urad }");
    let out = folder.file("page.html");
    let _ = abbe(&["report", text(&machine), "--job", text(&job), "--out", text(&out), "--quiet"]);
    let html = std::fs::read_to_string(&out).unwrap();
    let of = &data(&html)["machines"][0];
    assert_eq!(of["budget"]["tighten"][0]["error"], "EC0Y");
    near(&of["budget"]["position_um"]["worst_case"], 6.0);
    assert_eq!(of["work"]["limit"]["held"], false);
    assert!(html.contains("limit 5 µm: exceeded") && html.contains("Largest step of the deviation between rows"));
    assert!(html.contains("over the tool poses of the job"), "the scope of the tolerances");
    let volume = abbe(&["budget", text(&machine), "--reference", "machine", "--format", "json", "--quiet"]);
    let volume: Value = serde_json::from_str(&volume).unwrap();
    assert_eq!(volume["tighten"][0]["error"], "EB0Z");
}

#[test]
fn a_feature_with_points_out_of_reach_is_not_said_to_hold() {
    let folder = Folder::new("job-unreached");
    let _ = folder.with(
        "top.csv",
        "X,Y,Z,feature\n0,0,0,top\n100,0,0,top\n0,100,0,top\n100,100,0,top\n100,900,0,top\n0,0,10,up\n90,0,10,up\n\
         0,90,10,up\n90,90,10,up\n",
    );
    let features =
        "features:\n  top: { kind: flatness, tolerance: 10 um }\n  up: { kind: flatness, tolerance: 10 um }\n";
    let job = folder.with("top.yaml", &format!("tool_poses: top.csv\n{features}"));
    let machine = three(&folder, "m.yaml", "errors: { EC0Y: 40 urad }");
    let found = json(&["map", text(&machine), "--job", text(&job), "--format", "json", "--quiet"]);
    let of = &found["characteristics"];
    assert_eq!((&of[0]["unreached"], &of[0]["holds"], &of[1]["holds"]), (&1.into(), &Value::Null, &true.into()));
    let said = abbe(&["map", text(&machine), "--job", text(&job), "--quiet"]);
    assert!(said.contains("| top *") && said.contains("| not decided |"), "{said}");
    assert!(said.contains("top flatness: * 1 of its points are out of reach"), "{said}");
    let out = folder.file("page.html");
    let _ = abbe(&["report", text(&machine), "--job", text(&job), "--out", text(&out), "--quiet"]);
    let html = std::fs::read_to_string(&out).unwrap();
    assert!(html.contains("top *") && html.contains("not decided"));
    let bounded = three(&folder, "b.yaml", "tolerances: { EA0Z: 40 urad }");
    let said = abbe(&["map", text(&bounded), "--job", text(&job), "--quiet"]);
    assert!(said.contains("at most 100"), "{said}");
    let _ = abbe(&["report", text(&bounded), "--job", text(&job), "--out", text(&out), "--quiet"]);
    let html = std::fs::read_to_string(&out).unwrap();
    let drawn = &data(&html)["machines"][0]["work"]["characteristics"][1]["drawn"];
    assert!(number(&drawn["holds"]["low"]) > 0.9 && html.contains("how many of 100 machines"), "{drawn}");
}
