//! `abbe import`: files of instruments by the descriptions of their layouts. The samples are written here from those
//! descriptions, by hand or by other arithmetic than the readers'; figures are those of ISO 230-2 worked out beside them.

use super::identify::{json, run};
use super::oracle::program::Folder;
use serde_json::Value;

/// The report and the table, or what is said on refusal.
fn imported(name: &str, text: &str, options: &[&str]) -> Result<(Value, String), String> {
    let folder = Folder::new();
    let (file, out) = (folder.write(name, text), folder.path("x.csv"));
    let mut arguments = vec!["import", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--format", "json"];
    arguments.extend(options);
    let output = run(&arguments);
    if !output.status.success() {
        assert!(!out.exists());
        return Err(format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr)));
    }
    let table = std::fs::read_to_string(out).unwrap();
    let bare = table.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n"));
    Ok((json(&output), bare.collect()))
}

fn taken(name: &str, text: &str, options: &[&str]) -> (Value, String) {
    imported(name, text, options).unwrap_or_else(|said| panic!("{text}\n{said}"))
}

fn refused(name: &str, text: &str, options: &[&str], words: &[&str]) {
    let said = imported(name, text, options).expect_err(text);
    words.iter().for_each(|word| assert!(said.contains(word), "{word}\n{text}\n{said}"));
}

fn left_out(report: &Value) -> Vec<&str> {
    report["columns_left_out"].as_array().unwrap().iter().map(|column| column["column"].as_str().unwrap()).collect()
}

fn near(report: &Value, figures: &[(&str, f64)]) {
    for (key, expected) in figures {
        let found = report["errors"][0][*key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
        assert!((found - expected).abs() < 1e-6, "{key}: {found} {report}");
    }
}

/// Three targets, two runs each way; the runs are half a micrometre about 0 2 4 (up) and 1 3 5 (down).
const UP: [[f64; 2]; 3] = [[0.5, -0.5], [2.5, 1.5], [4.5, 3.5]];
const DOWN: [[f64; 2]; 3] = [[1.5, 0.5], [3.5, 2.5], [5.5, 4.5]];
const TABLE: &str = "X [mm], EXX+ [um], EXX- [um]\n0, 0, 1\n100, 2, 3\n200, 4, 5\n";

/// E = 5, M = 4, B = 1, R = 4 s + 1 with s = 0.5 sqrt 2, A = 5 + 4 s.
fn standard() -> [(&'static str, f64); 6] {
    let s = 0.5_f64.sqrt();
    [("E", 5.0), ("M", 4.0), ("B", 1.0), ("mean_B", -1.0), ("R", 4.0 * s + 1.0), ("A", 5.0 + 4.0 * s)]
}

/// As packages of lasers export a test: numbers of targets, environment and statistics beside the runs.
fn export(before: &str, between: &str, after: &str) -> String {
    let mut text = format!(
        "Target number;Target (mm);{before}Run 1 fwd (um);Run 1 rev (um);{between}Run 2 fwd (um);Run 2 rev (um);{after}\n"
    );
    let cells = |titles: &str| (0..titles.matches(';').count()).map(|k| format!("{};", 20 + k)).collect::<String>();
    for i in 0..3 {
        text += &format!("{};{};{}", i + 1, i * 100, cells(before));
        text += &format!("{};{};{}", UP[i][0], DOWN[i][0], cells(between));
        text += &format!("{};{};{}\n", UP[i][1], DOWN[i][1], cells(after));
    }
    text
}

#[test]
fn only_named_runs_are_runs() {
    let environment = "Air temperature (°C);Pressure (hPa);Humidity (%);";
    let statistics = "Mean fwd;Sigma fwd;Reversal (um);Mean reverse (um);";
    for (before, between, after) in
        [(environment, "", statistics), ("", "", environment), ("", "Material temp 1;", ""), ("", "Mean 1 (um);", "")]
    {
        let text = export(before, between, after);
        for options in [&["--error", "EXX"][..], &["--error", "EXX", "--unit", "um"]] {
            let (report, table) = taken("carto.csv", &text, options);
            assert_eq!(table, TABLE, "{text}");
            near(&report, &standard());
            assert_eq!((&report["errors"][0]["runs"], &report["readings"]), (&2.into(), &12.into()));
            let named = [before, between, after].concat();
            let left = left_out(&report);
            assert!(left.contains(&"Target number") && left.len() == 1 + named.matches(';').count(), "{left:?}");
            assert!(report["warnings"].as_array().is_none_or(Vec::is_empty), "{report}");
        }
    }
}

#[test]
fn unknown_columns_are_left_out_by_name_or_refuse_the_file() {
    let (report, table) = taken("a.csv", &export("", "", "Quux (um);"), &["--error", "EXX"]);
    assert_eq!(table, TABLE);
    assert_eq!(report["warnings"][0]["code"], "W0511");
    assert!(report["warnings"][0]["message"].as_str().unwrap().contains("Quux"), "{report}");
    refused(
        "a.csv",
        &export("", "Quux (um);", ""),
        &["--error", "EXX"],
        &["E0509", "Quux", "between runs", "--columns"],
    );
    // A unit that is not one of the error stays, whatever `--unit` says.
    let celsius = "X [mm];Run 1 + [°C];Run 1 - [°C]\n0;20;21\n100;20;21\n";
    refused("a.csv", celsius, &["--error", "EXX", "--unit", "um"], &["E0509", "°C"]);
    let urad = "X [mm];Run 1 + [urad];Run 1 - [urad]\n0;20;21\n100;20;21\n";
    refused("a.csv", urad, &["--error", "EXX", "--unit", "um"], &["E0509", "is not a unit of `EXX`"]);
    // Nothing but foreign columns: no unit is recommended.
    for titles in ["Air temperature (°C);Pressure", "Sigma fwd;Reversal (um)", "Quux;Foo"] {
        let text = format!("Target (mm);{titles}\n0;20;21\n100;20;21\n");
        let said = imported("a.csv", &text, &["--error", "EXX"]).unwrap_err();
        assert!(said.contains("no column of readings") && !said.contains("--unit um"), "{said}");
        assert!(imported("a.csv", &text, &["--error", "EXX", "--unit", "um"]).is_err(), "{text}");
    }
    // Titles that begin or end like directions or runs.
    for title in ["Upper", "Downtime", "Revision", "Runout", "Forward speed", "T1", "Run temperature"] {
        let text = format!("Target (mm);{title};Deviation (um)\n0;20;1\n100;20;2\n");
        assert_eq!(taken("a.csv", &text, &["--error", "EXX"]).1, "X [mm], EXX [um]\n0, 1\n100, 2\n", "{title}");
    }
}

#[test]
fn runs_without_a_direction_are_not_averaged() {
    // Passes up and down in turns, as some programs number them.
    let beside = "X [mm];Run 1;Run 2;Run 3;Run 4\n0;0.5;1.5;-0.5;0.5\n100;2.5;3.5;1.5;2.5\n200;4.5;5.5;3.5;4.5\n";
    let mut sorted = "run;X [mm];EXX [um]\n".to_owned();
    for i in 0..3 {
        for (k, value) in [UP[i][0], DOWN[i][0], UP[i][1], DOWN[i][1]].iter().enumerate() {
            sorted += &format!("Run {};{};{value}\n", k + 1, i * 100);
        }
    }
    for text in [beside, &sorted] {
        let options = if text == beside { vec!["--error", "EXX", "--unit", "um"] } else { Vec::new() };
        refused("a.csv", text, &options, &["E0509", "from which side", "--runs alternating"]);
        let with = |how| [options.clone(), vec!["--runs", how]].concat();
        let (report, table) = taken("a.csv", text, &with("alternating"));
        assert_eq!(table, TABLE, "{report}");
        near(&report, &standard());
        let (report, table) = taken("a.csv", text, &with("one-way"));
        assert_eq!(table, "X [mm], EXX [um]\n0, 0.5\n100, 2.5\n200, 4.5\n");
        assert_eq!((&report["errors"][0]["runs"], report["errors"][0]["B"].is_null()), (&4.into(), true));
    }
}

/// The text of a laser's test: sections, five targets to a line, passes with the index of the target.
fn laser_text(passes: &[&[(usize, f64)]], flags: &str) -> String {
    let mut text = "HEADER::\r\nFile type:1\r\nOwner:RENISHAW\r\nVersion no:2\r\n\r\nTARGET DATA::\r\nFiletype:ISO\r\n\
                    Target-count: 3\r\nTargets :\r\n 0.0  100.0  200.0 \r\n"
        .to_owned();
    text +=
        &format!("Flags: {flags}\r\n\r\nUSER-TEXT::\r\nMachine:  Mill\r\nSerial No:\r\nAxis: X\r\nTITLE:test\r\n\r\n");
    text += &format!("RUNS::\r\nRun-count:{}\r\n\r\nDEVIATIONS::\r\nRun Target Data:\r\n", passes.len());
    for (k, pass) in passes.iter().enumerate() {
        pass.iter().for_each(|(target, value)| text += &format!("{}   {target}      {value}\r\n", k + 1));
    }
    text + "\r\nENVIRONMENT::\r\nAir temp   : 20.1\r\n\r\nEOF::\r\n\r\n"
}

#[test]
fn a_lasers_text_file() {
    let up = |run: usize| [(1, UP[0][run]), (2, UP[1][run]), (3, UP[2][run])];
    let down = |run: usize| [(3, DOWN[2][run]), (2, DOWN[1][run]), (1, DOWN[0][run])];
    let text = laser_text(&[&up(0), &down(0), &up(1), &down(1)], "0 0 2 0");
    refused("a.rtl", &text, &[], &["E0509", "errors or corrections", "--holds errors"]);
    let (report, table) = taken("a.rtl", &text, &["--holds", "errors"]);
    assert_eq!(table, TABLE);
    near(&report, &standard());
    assert_eq!(report["metadata"][3], serde_json::json!(["Machine", "Mill"]));
    let (_, table) = taken("a.rtl", &text, &["--holds", "corrections"]);
    assert!(table.contains("100, -2, -3\n"), "{table}");
    // A test in one direction, its reverse passes filled with zeros.
    let zero = [(3, 0.0), (2, 0.0), (1, 0.0)];
    let one = laser_text(&[&up(0), &zero, &up(1), &zero], "0 1 2 0");
    let (report, table) = taken("a.rtl", &one, &["--holds", "errors"]);
    assert_eq!(
        (table.as_str(), left_out(&report)),
        ("X [mm], EXX [um]\n0, 0\n100, 2\n200, 4\n", vec!["run 2", "run 4"])
    );
    // All passes rising: nothing tells one direction from sorted passes of two.
    let rising = |run: usize| [(1, DOWN[0][run]), (2, DOWN[1][run]), (3, DOWN[2][run])];
    let sorted = laser_text(&[&up(0), &rising(0), &up(1), &rising(1)], "0 0 2 0");
    refused("a.rtl", &sorted, &["--holds", "errors"], &["from which side"]);
    assert_eq!(taken("a.rtl", &sorted, &["--holds", "errors", "--runs", "alternating"]).1, TABLE);
    // The index counts, not the place.
    let shuffled = text.replace(" 0.0  100.0  200.0 ", " 200.0  100.0  0.0 ");
    assert!(taken("a.rtl", &shuffled, &["--holds", "errors"]).1.contains("200, 1, 0\n"));
    let comma = text.replace(".5\r", ",5\r").replace("0.5", "0,5").replace("0.0 ", "0,0 ");
    assert_eq!(taken("a.rtl", &comma.replace("20.1", "20,1"), &["--holds", "errors"]).1, TABLE);
    for (fault, repair, words) in [
        ("Target-count: 3", "Target-count: 4", "announces 4 targets"),
        ("Run-count:4", "Run-count:5", "announces 5 runs"),
        ("4   1 ", "4   2 ", "each of the 3 targets once"),
        ("4   1 ", "4   7 ", "no number of a target"),
        ("4   1 ", "4   x ", "not a number"),
    ] {
        refused("a.rtl", &text.replace(fault, repair), &["--holds", "errors"], &["E0509", words]);
    }
    refused("a.rtl", &text, &["--holds", "errors", "--unit", "mm"], &["hold um"]);
    refused("a.txt", &text, &["--holds", "errors", "--error", "EXX"], &["no unit"]);
    // Angles are in mrad, straightness in a unit that nobody has described.
    let (_, table) = taken("a.rta", &text, &["--holds", "errors", "--error", "EBX"]);
    assert_eq!(table, "X [mm], EBX+ [urad], EBX- [urad]\n0, 0, 1000\n100, 2000, 3000\n200, 4000, 5000\n");
    refused("a.rta", &text, &["--holds", "errors"], &["--error"]);
    refused("a.rts", &text, &["--holds", "errors", "--error", "EYX"], &["--unit"]);
}

#[test]
fn entries_of_a_test_bench() {
    let mut text = "TEST_DATA=# from a log\nUNIT=mm\nCYCLES=2\nPOSITIONS=3\n".to_owned();
    for i in 0..3 {
        text += &format!("TGT_DATA[{}]={}\n", i + 1, i * 100);
        for run in 0..2 {
            let at = |value: f64| format!("{:.5}", i as f64 * 100.0 + value * 1e-3);
            text += &format!("REF_DATA_FWD[{},{}]={}\n", i + 1, run + 1, at(UP[i][run]));
            text += &format!("REF_DATA_BWD[{},{}]={}\n", i + 1, run + 1, at(DOWN[i][run]));
        }
    }
    let (report, table) = taken("report.dat", &text, &["--axis", "X"]);
    assert_eq!(table, TABLE);
    near(&report, &standard());
    refused("report.dat", &text, &[], &["which axis moved"]);
    refused("report.dat", &text, &["--axis", "X", "--error", "EYX"], &["`EXX` and no other"]);
    refused("report.dat", &text.replace("TGT_DATA[2]", "TGT_DATA[9]"), &["--axis", "X"], &["no target 2"]);
}

/// A file of a control system: target, cycle, direction and reading, the reading a deviation or a position.
#[test]
fn plain_run_files() {
    let file = |unit: &str, words: [&str; 2], reading: &dyn Fn(f64, f64) -> String| {
        let mut text = format!("target,cycle,direction,reading [{unit}]\n");
        for run in 0..2 {
            for i in (0..3).chain((0..3).rev().map(|i| i + 3)) {
                let (way, values) = if i < 3 { (words[0], UP) } else { (words[1], DOWN) };
                let target = (i % 3) as f64 * 100.0;
                text += &format!("{target},{},{way},{}\n", run + 1, reading(target, values[i % 3][run]));
            }
        }
        text
    };
    for words in [["fwd", "bwd"], ["+", "-"], ["1", "-1"], ["up", "down"]] {
        let deviations = file("um", words, &|_, value| format!("{value}"));
        let reached = file("mm", words, &|target, value| format!("{:.5}", target + value * 1e-3));
        for text in [deviations, reached] {
            let (report, table) = taken("runs.csv", &text, &["--error", "EXX"]);
            assert_eq!(table, TABLE, "{text}");
            near(&report, &standard());
        }
    }
    // A short travel: positions within 10 mm are no deviations of 10 mm.
    let short = "target [mm],cycle,direction,reading [mm]\n0,1,+,0.001\n2,1,+,2.002\n4,1,+,4.001\n";
    assert_eq!(taken("runs.csv", short, &["--error", "EXX"]).1, "X [mm], EXX [um]\n0, 1\n2, 2\n4, 1\n");
}

/// Targets in a row, as the standard prints its example.
#[test]
fn targets_in_a_row() {
    let text = "Machine;M\nTarget position (mm);0;;100;;200;\nApproach direction;↑;↓;↑;↓;↑;↓\n\
                Run 1 (um);0.5;1.5;2.5;3.5;4.5;5.5\nRun 2 (um);-0.5;0.5;1.5;2.5;3.5;4.5\nMean (um);0;1;2;3;4;5\n";
    let (report, table) = taken("iso.csv", text, &["--error", "EXX"]);
    assert_eq!((table.as_str(), left_out(&report)), (TABLE, vec!["Mean (um)"]));
    near(&report, &standard());
    let signed = "position [mm];0;100;200\n1+ [um];0.5;2.5;4.5\n1- [um];1.5;3.5;5.5\n2+ [um];-0.5;1.5;3.5\n2- [um];0.5;2.5;4.5\n";
    assert_eq!(taken("iso.csv", signed, &["--error", "EXX"]).1, TABLE);
    // Runs that are named by numbers stay columns.
    let columns = "position [mm];1+;1-;2+;2-\n0;0.5;1.5;-0.5;0.5\n100;2.5;3.5;1.5;2.5\n200;4.5;5.5;3.5;4.5\n";
    assert_eq!(taken("iso.csv", columns, &["--error", "EXX", "--unit", "um"]).1, TABLE);
}

#[test]
fn what_compile_writes_for_a_tracer_is_read() {
    let text = "// variant Vendor\n[C0Y]\nVALUE = 0.000012\n[EXX]\nGridpoints = {\n  -300.0  0.000000\n  -150.0  0.001100\n\
                0.0  0.0019\n}  // end of EXX\n[EBX]\nGridpoints = {\n-300 0\n-150 0.000002\n0 0.000003\n}\n\
                [ECC]\nGridpoints = {\n0 0\n180 0.00001\n360 0\n}\n";
    refused("etalon.txt", text, &[], &["E0509", "X, C", "--axis"]);
    let (report, table) = taken("etalon.txt", text, &["--axis", "X"]);
    assert_eq!(table, "X [mm], EXX [um], EBX [urad]\n-300, 0, 0\n-150, 1.1, 2\n0, 1.9, 3\n");
    assert_eq!(left_out(&report), ["EC0Y", "ECC"]);
    let reason = report["columns_left_out"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("EC0Y: 12 urad"), "{reason}");
    let (_, table) = taken("etalon.txt", text, &["--error", "ECC"]);
    assert_eq!(table, "C [deg], ECC [urad]\n0, 0\n180, 10\n360, 0\n");
    for (fault, repair) in [("}  // end", "// end"), ("0.001100", "0.0011 7"), ("[EXX]", "[EQX]"), ("VALUE", "VALUES")]
    {
        refused("etalon.txt", &text.replacen(fault, repair, 1), &["--axis", "X"], &["E0509"]);
    }
    // There and back: the files of a machine, imported, are its errors.
    let folder = Folder::new();
    let machine = "abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm] }\n  \
                   Y: { travel: [0 mm, 500 mm] }\n  Z: { travel: [0 mm, 500 mm] }\ntool: { length: 100 mm }\nerrors:\n  \
                   EXX: { points: [[0 mm, 0 um], [250 mm, 3 um], [500 mm, -2 um]] }\n  EC0Y: 12 urad\n";
    let (file, out) = (folder.write("m.yaml", machine), folder.path("set"));
    let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
    let output = run(&["compile", file, "--target", "etalon-exchange", "--out", out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written = std::fs::read_to_string(format!("{out}/etalon.txt")).unwrap();
    let (report, table) = taken("etalon.txt", &written, &["--axis", "X", "--error", "EXX"]);
    assert!(["0, 0\n", "250, 3\n", "500, -2\n"].iter().all(|row| table.contains(row)), "{table}");
    assert!(left_out(&report).contains(&"EC0Y"), "{report}");
}

#[test]
fn six_channels_become_iso_errors() {
    let text = "Target [mm];Linear [um];Straightness H [um];Straightness V [um];Pitch [arcsec];Yaw [arcsec];Roll [urad];Air temp\n\
                0;0;0;0;0;0;0;20\n100;1;2;-1;1;2;3;20\n200;2;0;1;2;1;4;20\n";
    refused("six.csv", text, &["--axis", "Y"], &["--beam", "--vertical"]);
    let arcsec = 1e6 * std::f64::consts::PI / 648_000.0;
    // Beam +Y, vertical +Z: h is -X.
    let (report, table) = taken("six.csv", text, &["--beam", "+Y", "--vertical", "+Z", "--keep-line"]);
    let signs: Vec<String> = report["channels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| format!("{}{}", c["sign"].as_str().unwrap(), c["error"].as_str().unwrap()))
        .collect();
    assert_eq!(signs, ["+EYY", "-EXY", "+EZY", "-EAY", "+ECY", "+EBY"]);
    let row: Vec<f64> = table.lines().nth(2).unwrap().split(", ").map(|cell| cell.parse().unwrap()).collect();
    let expected = [100.0, 1.0, -2.0, -1.0, -arcsec, 2.0 * arcsec, 3.0];
    assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{table}");
    let flipped = ["--beam", "+Y", "--vertical", "+Z", "--flip", "Pitch", "--error", "EAY"];
    let (report, _) = taken("six.csv", text, &flipped);
    assert_eq!(report["channels"][0]["sign"], "+");
    refused("six.csv", text, &["--axis", "X", "--beam", "+Y", "--vertical", "+Z"], &["beam is along Y"]);
    refused("six.csv", text, &["--beam", "+Y", "--vertical", "+Z", "--flip", "Roil"], &["Roil"]);
    // One channel by hand, where no other could be meant.
    let yaw = "X [mm];Yaw [urad]\n0;1\n100;2\n";
    assert_eq!(taken("six.csv", yaw, &["--error", "ECX"]).1, "X [mm], ECX [urad]\n0, 1\n100, 2\n");
    refused("six.csv", yaw, &["--error", "EAX"], &["no column of readings"]);
    refused("six.csv", text, &["--error", "ECY"], &["E0509"]);
}

#[test]
fn columns_are_mapped_by_hand() {
    let folder = Folder::new();
    let text = "Kanal 0;Kanal 1;Kanal 2 [um];Kanal 3 [nm];Kanal 4;ok\n0;9;0;-1000;0;\n100;9;2;-3000;0;\n200;9;4;-5000;7;\n300;9;9;9;9;no\n";
    let map = "position: { column: Kanal 0, unit: mm }\ncolumns:\n  Kanal 2: { error: EXX, direction: forward }\n  \
               Kanal 3: { error: EXX, unit: nm, direction: reverse, flip: true }\n  ok: exclude\n";
    let with = |text: &str, map: &str| {
        let map = folder.write("map.yaml", map);
        imported("odd.csv", text, &["--columns", map.to_str().unwrap()])
    };
    let (report, table) = with(text, map).unwrap();
    assert_eq!((table.as_str(), left_out(&report)), (TABLE, vec!["Kanal 1", "Kanal 4"]));
    let reached = "position: Kanal 0\ncolumns: { Kanal 1: { error: EXX, reached: true } }\n";
    let (_, table) = with("Kanal 0;Kanal 1\n0;0.001\n100;100.002\n", reached).unwrap();
    assert_eq!(table, "X [mm], EXX [um]\n0, 1\n100, 2\n");
    for (fault, repair, words) in [
        ("Kanal 2:", "Kanal 9:", "no column `Kanal 9`"),
        ("unit: nm", "unit: um", "the mapping says `um`"),
        ("unit: nm", "unit: arcsec", "not a unit of `EXX`"),
        ("error: EXX", "error: EC0Y", "not a component error"),
        ("ok: exclude", "ok: excluded", "cannot be read"),
        ("flip: true", "flop: true", "cannot be read"),
        ("position:", "positions:", "positions"),
        ("unit: mm", "unit: um/m", "not a unit of positions"),
    ] {
        let said = with(text, &map.replacen(fault, repair, 1)).unwrap_err();
        assert!(said.contains(words) && (said.contains("E0512") || said.contains("E0509")), "{fault}\n{said}");
    }
    let said = with(text, "not: [a, mapping").unwrap_err();
    assert!(said.contains("E0512"), "{said}");
}
