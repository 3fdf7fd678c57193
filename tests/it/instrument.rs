//! Virtual instruments against closed forms.

use crate::kinematic_parameters::{OF_HEADS, OF_TABLES, head_head, head_table, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::{V3, minus};
use crate::program::{Folder, abbe, json, refused, text, well_formed};
use crate::support::config::sample;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(number).collect()
}

/// Three linear axes of 400 mm with these errors.
fn three(folder: &Folder, errors: &str) -> std::path::PathBuf {
    let text = format!(
        "abbe: 1\nmachine: M\nchain: w Y' b X Z t\naxes: {{ X: {{ travel: [0, 400], origin: [0, 0, 0] }}, Y: {{ travel: [0, 400], origin: [0, 0, 0] }}, Z: {{ travel: [0, 400], origin: [0, 0, 0] }} }}\nerrors: {{ {errors} }}\n"
    );
    folder.with("m.yaml", &text)
}

#[test]
fn a_ball_bar_reads_squareness_and_scale_with_their_signs() {
    let folder = Folder::new("ball-bar");
    let path = three(&folder, "EC0Y: 10 urad, EA0Z: 20 urad, EB0Z: 30 urad, EXX: { polynomial: [0 um, 40 um/m] }");
    let b = json(&["instrument", text(&path), "ball-bar", "--radius", "150", "--points", "72", "--format", "json"]);
    // Second order: squares of 40 um/m over 150 mm are some 1e-7 um, of 30 urad the same.
    let near = |value: &Value, truth: f64| assert!((number(value) - truth).abs() < 2e-3, "{value} instead of {truth}");
    let plane = |i: usize| &b["planes"][i];
    // EC0Y and EA0Z above 0: angle above 90 deg; EB0Z above 0: the angle X-Z is below it.
    for (i, truth) in [10.0, 20.0, -30.0].into_iter().enumerate() {
        near(&plane(i)["squareness_urad"], truth);
    }
    for (i, truth) in [40.0, 0.0, -40.0].into_iter().enumerate() {
        near(&plane(i)["scale_mismatch_um_per_m"], truth);
    }
    // YZ: -e R / 2 sin 2 angle, a range of e R, the same in both senses.
    near(&plane(1)["bidirectional_um"], 20e-6 * 150e3);
    let readings = numbers(&plane(1)["counter_clockwise_um"]);
    for (i, reading) in readings.iter().enumerate() {
        let angle = (i as f64 * 5.0).to_radians();
        assert!((reading + 20e-6 * 150e3 / 2.0 * (2.0 * angle).sin()).abs() < 1e-4, "{i}: {reading}");
    }
    assert_eq!(plane(1)["counter_clockwise_um"], plane(1)["clockwise_um"]);
    // XY: the mean of 40 um/m cos^2 over the circle is half of it.
    near(&plane(0)["mean_radial_um"], 0.5 * 40e-6 * 150e3);
}

#[test]
fn reversal_shows_where_an_axis_turns_round() {
    let folder = Folder::new("ball-bar-reversal");
    let path = three(&folder, "EXX: { forward: 0 um, reverse: -2 um }");
    let b = json(&["instrument", text(&path), "ball-bar", "--plane", "xy", "--points", "360", "--format", "json"]);
    let plane = &b["planes"][0];
    // The ball was set up at the mean, -1 um. Counter-clockwise X falls in the upper half.
    let (ccw, cw) = (numbers(&plane["counter_clockwise_um"]), numbers(&plane["clockwise_um"]));
    for (angle, x_falls) in [(45, true), (135, true), (200, false), (330, false)] {
        let cosine = f64::from(angle).to_radians().cos();
        let side = if x_falls { -1.0 } else { 1.0 };
        // 1 um squared over twice 100 mm is 5e-6 um.
        assert!((ccw[angle as usize] - side * cosine).abs() < 1e-5, "{angle}");
        assert!((cw[angle as usize] + side * cosine).abs() < 1e-5, "{angle}");
    }
    assert!(number(&plane["bidirectional_um"]) > 1.9);
}

#[test]
fn an_r_test_sees_an_eccentric_table_twice() {
    let folder = Folder::new("r-test");
    let path = folder.with(
        "m.yaml",
        "abbe: 1\nmachine: M\nchain: w C' b X Y Z t\naxes: { X: { travel: [-300, 300], origin: [0, 0, 0] }, Y: { travel: [-300, 300], origin: [0, 0, 0] }, Z: { travel: [-300, 300], origin: [0, 0, 0] }, C: { travel: continuous } }\nerrors: { EX0C: 10 um }\n",
    );
    let arguments = ["instrument", text(&path), "r-test", "--at", "X=120", "--points", "5", "--format", "json"];
    let r = json(&arguments);
    let readings = r["axes"][0]["readings"].as_array().unwrap();
    // d = (1 - R) e in the workpiece frame; in the machine frame R^T d = (R^T - 1) e: golden sign -20 um at 180 deg.
    for (reading, (x, y)) in readings.iter().zip([(0.0, 0.0), (-10.0, -10.0), (-20.0, 0.0), (-10.0, 10.0), (0.0, 0.0)])
    {
        let [dx, dy, dz] = [0, 1, 2].map(|i| number(&reading["reading_um"][i]));
        assert!((dx - x).abs() < 1e-6 && (dy - y).abs() < 1e-6 && dz.abs() < 1e-9, "{reading}");
    }
    let range = numbers(&r["axes"][0]["range_um"]);
    assert!((range[0] - 20.0).abs() < 1e-6 && (range[1] - 20.0).abs() < 1e-6);
    // The ball stays where it is in the workpiece frame: the linear axes follow it round.
    assert!((number(&readings[1]["axes"]["X"]).abs() - number(&readings[0]["axes"]["Y"]).abs()).abs() < 1e-9);
    // Too far out, the linear axes cannot follow the whole path.
    let far = json(&["instrument", text(&path), "r-test", "--at", "X=290,Y=290", "--points", "37", "--format", "json"]);
    assert!(far["axes"][0]["skipped"].as_u64().unwrap() > 10);
}

/// The poses of three sequences, of both axes together too, are measured on the oracle's machine; `identify` finds its
/// location errors.
#[test]
fn a_sequence_is_measured_and_tells_the_location_errors() {
    for (of, turns) in [
        (table_table as fn(&str) -> String, ["C", "A", "A+C"]),
        (head_table, ["C", "B", "B+C"]),
        (head_head, ["C", "B", "B+C"]),
    ] {
        let folder = Folder::new("sequence");
        let errors = if of("") == table_table("") { OF_TABLES } else { OF_HEADS };
        let (real, plain) = (folder.with("real.yaml", &of(errors)), folder.with("plain.yaml", &of("  EX0C: 0 um\n")));
        let sample = sample(&real);
        let mut arguments = vec!["identify".to_owned(), text(&plain).to_owned(), "--fit".to_owned()];
        let names: Vec<&str> = errors.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
        arguments.extend([names.join(","), "--data".to_owned()]);
        for (i, axes) in turns.iter().enumerate() {
            let table = folder.file(&format!("{i}.csv"));
            let rest = ["--axis", axes, "--points", "13", "--sequence", text(&table)];
            let _ = abbe(&[&["instrument", text(&plain), "r-test"][..], &rest].concat());
            let sequence = std::fs::read_to_string(&table).unwrap();
            std::fs::write(&table, measured(&sequence, &sample)).unwrap();
            arguments.push(text(&table).to_owned());
        }
        arguments.extend(["--format", "json"].map(str::to_owned));
        let fit = json(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        for line in errors.lines() {
            let (name, value) = line.trim().split_once(": ").unwrap();
            let wanted: f64 = value.split(' ').next().unwrap().parse().unwrap();
            let found = fit["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap();
            // Readings are written to 1e-6 um.
            assert!((number(&found["value"]) - wanted).abs() < 1e-4, "{turns:?} {name}: {found}, {wanted}");
        }
    }
    let folder = Folder::new("no-sequence");
    let (exit, said) = refused(&["instrument", "trunnion.yaml", "ball-bar", "--sequence", text(&folder.file("s.csv"))]);
    assert!(exit == 2 && said.contains("is for the R-test"), "{exit} {said}");
    for wrong in ["A+A", "A+X", "A+", ""] {
        assert_eq!(refused(&["instrument", "trunnion.yaml", "r-test", "--axis", wrong]).0, 2, "{wrong}");
    }
}

/// The sequence with the readings of the oracle's machine, workpiece frame.
fn measured(sequence: &str, sample: &Sample) -> String {
    let mut lines = sequence.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut table = titles.join(",") + "\n";
    let mut first: Option<(String, V3)> = None;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let at = |name: &str| titles.iter().position(|title| title.split(' ').next() == Some(name)).unwrap();
        let pose: Vec<f64> = sample.rigid.walk.iter().map(|axis| cells[at(&axis.name)].parse().unwrap()).collect();
        let [real, ideal] = sample.holds(&pose, Travel::Mean);
        let deviation = minus(real.tip, ideal.tip);
        if first.as_ref().is_none_or(|(run, _)| run != cells[0]) {
            first = Some((cells[0].to_owned(), deviation));
        }
        let read = minus(deviation, first.as_ref().unwrap().1).map(|mm| format!("{:.6}", mm * 1e3));
        table += &format!("{},{}\n", cells[..titles.len() - 3].join(","), read.join(","));
    }
    table
}

#[test]
fn diagonals_tell_squareness_by_their_differences() {
    let folder = Folder::new("diagonals");
    let path = three(&folder, "EC0Y: 10 urad");
    let d = json(&["instrument", text(&path), "diagonals", "--format", "json"]);
    let list = d["diagonals"].as_array().unwrap();
    let names: Vec<&str> = list.iter().map(|d| d["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["ppp", "npp", "pnp", "nnp"]);
    // The tip goes by -10 urad * 400 mm in X while Y rises; a diagonal takes 1 / sqrt 3 of it.
    for (diagonal, sign) in list.iter().zip([-1.0, 1.0, 1.0, -1.0]) {
        let end = *numbers(&diagonal["there_um"]).last().unwrap();
        assert!((end - sign * 4.0 / 3.0_f64.sqrt()).abs() < 1e-3, "{diagonal}");
        assert!((number(&diagonal["e_d_um"]) - end.abs()).abs() < 1e-9 && number(&diagonal["b_d_um"]) < 1e-9);
    }
    let s = json(&["instrument", text(&path), "step-diagonals", "--points", "6", "--format", "json"]);
    for diagonal in s["diagonals"].as_array().unwrap() {
        // 5 steps of three axes and the start; all of the error belongs to Y.
        assert_eq!(diagonal["way_mm"].as_array().unwrap().len(), 16);
        let by_axis = numbers(&diagonal["by_axis_um"]);
        let end = *numbers(&diagonal["there_um"]).last().unwrap();
        assert!((by_axis[1] - end).abs() < 1e-6 && by_axis[0].abs() < 1e-6 && by_axis[2].abs() < 1e-6, "{diagonal}");
    }
    // With reversal, the return run differs.
    let path = three(&folder, "EXX: { forward: 1 um, reverse: -1 um }");
    let d = json(&["instrument", text(&path), "diagonals", "--format", "json"]);
    assert!((number(&d["diagonals"][0]["b_d_um"]) - 2.0 / 3.0_f64.sqrt()).abs() < 1e-9, "{d}");
}

#[test]
fn pictures_tables_and_refusals() {
    let folder = Folder::new("instrument");
    let svg = folder.file("polar.svg");
    let said = abbe(&["instrument", "trunnion.yaml", "ball-bar", "--radius", "150", "--svg", text(&svg)]);
    assert!(said.contains("G(b)"));
    let picture = std::fs::read_to_string(&svg).unwrap();
    assert_eq!(well_formed(&picture), Ok(()));
    for (instrument, columns) in [("ball-bar", 4), ("r-test", 5), ("diagonals", 4), ("step-diagonals", 4)] {
        let csv = abbe(&["instrument", "trunnion.yaml", instrument, "--format", "csv"]);
        assert!(
            csv.lines().count() >= 20 && csv.lines().all(|line| line.split(',').count() == columns),
            "{instrument}"
        );
        assert!(!csv.contains("NaN") && !csv.contains(",-0,"));
    }
    for (arguments, code) in [
        (&["ball-bar", "--radius", "400"][..], "E0612"),
        (&["ball-bar", "--at", "X=10"], "E0612"),
        (&["r-test", "--at", "X=500,Y=450,Z=0", "--axis", "A"], "E0612"),
    ] {
        let (exit, message) = refused(&[&["instrument", "trunnion.yaml"], arguments].concat());
        assert!(exit == 1 && message.contains(code) && message.contains("help"), "{arguments:?}: {message}");
    }
    for arguments in [&["ball-bar", "--radius", "-1"][..], &["ball-bar", "--points", "2"], &["r-test", "--axis", "X"]] {
        assert_eq!(refused(&[&["instrument", "trunnion.yaml"], arguments].concat()).0, 2, "{arguments:?}");
    }
}

#[test]
fn every_instrument_is_drawn() {
    let folder = Folder::new("instrument-pictures");
    for instrument in ["ball-bar", "r-test", "diagonals", "step-diagonals"] {
        let (svg, png) = (folder.file("p.svg"), folder.file("p.png"));
        abbe(&["instrument", "ht-b-c.yaml", instrument, "--svg", text(&svg)]);
        let picture = std::fs::read_to_string(&svg).unwrap();
        well_formed(&picture).unwrap();
        abbe(&["instrument", "ht-b-c.yaml", instrument, "--svg", text(&png)]);
        assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG"));
        // A reading that grows beyond its frame would be drawn outside of the picture.
        let size = |name: &str| -> f64 {
            picture.split_once(&format!("{name}=\"")).unwrap().1.split('"').next().unwrap().parse().unwrap()
        };
        for (name, limit) in [("cx", size("width")), ("cy", size("height"))] {
            for part in picture.split(&format!(" {name}=\"")).skip(1) {
                let at: f64 = part.split('"').next().unwrap().parse().unwrap();
                assert!((0.0..=limit).contains(&at), "{instrument}: {name} {at}");
            }
        }
    }
    // The ranges in the picture's words are those of the JSON.
    let svg = folder.file("r.svg");
    let r = json(&["instrument", "ht-b-c.yaml", "r-test", "--svg", text(&svg), "--format", "json"]);
    let picture = std::fs::read_to_string(&svg).unwrap();
    for axis in r["axes"].as_array().unwrap() {
        let ranges: Vec<String> =
            numbers(&axis["range_um"]).iter().map(|um| abbe::units::significant(*um, 3)).collect();
        let words = format!("{}: ranges {} µm", axis["axis"].as_str().unwrap(), ranges.join(", "));
        assert!(picture.contains(&words), "{words}");
    }
}
