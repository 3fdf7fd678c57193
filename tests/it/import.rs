//! `abbe import`: exports of lasers in the usual forms, with their faults reported row by row.

use super::identify::{json, run};
use super::oracle::program::Folder;

/// Means at 0, 100, 200: forward 0, 2, 4 um, reverse 1, 3, 5 um, runs 0.5 um about them.
const MEANS: [[f64; 2]; 3] = [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]];

fn value(target: usize, way: usize, run: usize) -> f64 {
    MEANS[target][way] + if run == 0 { 0.5 } else { -0.5 }
}

const TABLE: &str = "X [mm], EXX+ [um], EXX- [um]\n0, 0, 1\n100, 2, 3\n200, 4, 5\n";

/// Returns the report and the table of a file.
fn imported(text: &[u8], options: &[&str]) -> (serde_json::Value, String) {
    let folder = Folder::new();
    let (file, out) = (folder.path("laser.csv"), folder.path("x.csv"));
    std::fs::write(&file, text).unwrap();
    let mut arguments = vec!["import", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--format", "json"];
    arguments.extend(options);
    let report = json(&run(&arguments));
    (report, std::fs::read_to_string(out).unwrap())
}

fn without_comments(table: &str) -> String {
    table.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect()
}

/// The standard's figures of these readings: s = 0.5 sqrt 2 everywhere.
fn check(report: &serde_json::Value, runs: u64) {
    let figures = &report["errors"][0];
    let near = |key: &str, expected: f64| {
        let found = figures[key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
        assert!((found - expected).abs() < 1e-9, "{key}: {found} {report}");
    };
    let s = 0.5_f64.sqrt();
    assert_eq!((figures["error"].as_str(), figures["runs"].as_u64()), (Some("EXX"), Some(runs)));
    near("E", 5.0);
    near("M", 4.0);
    near("B", 1.0);
    near("mean_B", -1.0);
    near("R", (4.0 * s).max(4.0 * s + 1.0));
    near("A", 5.0 + 4.0 * s);
    near("slope", 20.0);
}

/// There and back in one column, run after run, as lasers record.
fn zigzag(cell: impl Fn(usize, f64) -> String) -> String {
    let mut text = String::new();
    for run in 0..2 {
        for target in 0..3 {
            text += &cell(target, value(target, 0, run));
        }
        for target in (0..3).rev() {
            text += &cell(target, value(target, 1, run));
        }
    }
    text
}

#[test]
fn runs_beside_each_other_with_metadata_decimal_commas_and_utf16() {
    let mut text =
        "HEADER\r\nInstrument: laser 80\r\nDate: 2026-11-01\r\nAxis: X\r\n\r\nposition (mm);1+;1-;2+;2-\r\n".to_owned();
    for (i, target) in ["0", "100,0", "200"].iter().enumerate() {
        let cells: Vec<String> =
            (0..4).map(|k| (value(i, k % 2, k / 2) * 1e-3).to_string().replace('.', ",")).collect();
        text += &format!("{target};{}\r\n", cells.join(";"));
    }
    text += "300;0,1;bump;0,1;0,1\r\nend of file\r\n";
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let (report, table) = imported(&wide, &["--error", "EXX", "--unit", "mm"]);
    check(&report, 2);
    assert_eq!(without_comments(&table), TABLE);
    assert!(table.contains("# Instrument: laser 80\n"), "{table}");
    let left = report["left_out"].as_array().unwrap();
    assert_eq!(left.iter().map(|l| l["line"].as_u64().unwrap()).collect::<Vec<_>>(), [10, 11], "{report}");
    assert!(left[0]["reason"].as_str().unwrap().contains("bump"));
    assert_eq!(report["warnings"][0]["code"], "W0504");
}

#[test]
fn there_and_back_in_one_column() {
    let rows = zigzag(|target, v| format!("{},{v}\n", target * 100));
    let (report, table) = imported(format!("\u{feff}X [mm],EXX [um]\n{rows}").as_bytes(), &[]);
    check(&report, 2);
    assert_eq!((without_comments(&table).as_str(), &report["directions_inferred"]), (TABLE, &serde_json::json!(true)));
}

/// Actual minus nominal of positions that instruments list as reached; in rows of their own unit, and modulo a turn.
#[test]
fn positions_that_were_reached() {
    let reached = |i: usize, k: usize| format!("{:.4}", i as f64 * 100.0 + value(i, k % 2, k / 2) * 1e-3);
    let mut text = "nominal [mm], actual 1+ [mm], actual 1- [mm], actual 2+ [mm], actual 2- [mm]\n".to_owned();
    for i in 0..3 {
        text += &format!("{}, {}\n", i * 100, (0..4).map(|k| reached(i, k)).collect::<Vec<_>>().join(", "));
    }
    for options in [&["--axis", "X"][..], &["--error", "EXX"], &["--axis", "X", "--unit", "um"]] {
        let (report, table) = imported(text.as_bytes(), options);
        check(&report, 2);
        assert_eq!(without_comments(&table), TABLE);
    }
    // Beside deviations they add nothing; columns that are neither are ignored.
    let table = |text: &str, options: &[&str]| without_comments(&imported(text.as_bytes(), options).1);
    let both = "nominal [mm], actual [mm], deviation [um]\n0, 0, 1\n100, 100.0021, 2\n";
    assert_eq!(table(both, &["--axis", "X"]), "X [mm], EXX [um]\n0, 1\n100, 2\n");
    for beside in ["actual feed", "actual temperature [degC]", "Ist-Temperatur", "temp actual", "feed [mm/min]"] {
        let text = format!("X [mm], Actual [mm], {beside}\n0, 0.001, 20\n100, 100.002, 21\n");
        assert_eq!(table(&text, &[]), "X [mm], EXX [um]\n0, 1\n100, 2\n", "{beside}");
    }
    let pitch = "X [mm], actual [mm], pitch [urad]\n0, 0, 1\n100, 100.0021, 2\n";
    assert_eq!(table(pitch, &["--error", "EBX"]), "X [mm], EBX [urad]\n0, 1\n100, 2\n");
    // Deviations that are called actual.
    for title in ["actual deviation [um]", "Ist-Abweichung [um]", "actual [um]", "ist error+ [um]"] {
        let text = format!("X [mm]; {title}\n0; 1\n4; 2\n");
        assert_eq!(table(&text, &["--error", "EXX"]), "X [mm], EXX [um]\n0, 1\n4, 2\n", "{title}");
    }
    assert_eq!(
        table("X [mm]; actual\n0; 1\n4; 2\n", &["--unit", "um", "--error", "EXX"]),
        "X [mm], EXX [um]\n0, 1\n4, 2\n"
    );
    assert_eq!(table("X [mm]; actual\n0; 0.001\n4; 4.002\n", &["--unit", "mm"]), "X [mm], EXX [um]\n0, 1\n4, 2\n");
    let arcsec = "C [deg]; actual error [arcsec]\n0; 0.5\n90; 1.2\n";
    assert_eq!(table(arcsec, &["--error", "ECC"]), "C [deg], ECC [urad]\n0, 2.424068\n90, 5.817764\n");
    // A hyphen joins words and is no direction: there and back by the order of the rows.
    let rows = "0; 0.001\n100; 100.002\n200; 200.003\n200; 200.004\n100; 100.005\n0; 0.004\n";
    for title in ["actual", "Ist-Position", "Istwert", "actual-1", "actual_1"] {
        let expected = "X [mm], EXX+ [um], EXX- [um]\n0, 1, 4\n100, 2, 5\n200, 3, 4\n";
        assert_eq!(table(&format!("X [mm]; {title} [mm]\n{rows}"), &[]), expected, "{title}");
    }
    // Encoders that count from 0 again: 10 urad before and behind, to the digits that are read.
    let off = 1e-5_f64.to_degrees();
    let turn = format!("C [deg]; actual\n0; {off}\n180; {}\n360; {off}\n", 180.0 - off);
    let (closed, open) = (table(&turn, &["--continuous"]), table(&turn, &[]));
    assert_eq!(closed, "C [deg], ECC [urad]\n0, 10\n180, -10\n360, 10\n");
    assert_eq!(open, closed);
    let below = format!("C [deg]; actual\n0; {}\n180; {}\n", 360.0 - off, -180.0 + off);
    assert_eq!(table(&below, &[]), "C [deg], ECC [urad]\n0, -10\n180, 10\n");
    for (text, options, words) in [
        ("X [mm], actual [deg]\n0, 0\n", &["--error", "EXX"][..], "is not a unit of `EXX`"),
        ("U [mm], actual [mm]\n0, 0\n", &[], "give `--error EXX`"),
        ("X [mm], actual [mm]\n0, 0\n100, 100.001\n", &["--error", "EYX"], "no column of readings"),
        ("X [mm], reading [mm]\n0, 0\n100, 100.001\n", &[], "--error EXX"),
        // Not one row at a time until one is left.
        ("X [mm], deviation [mm]\n0, 0\n100, 100.001\n", &["--error", "EXX"], "a reading of 100.001 mm"),
        ("X [mm], pitch [deg]\n0, 0\n100, 30\n", &["--error", "EBX"], "rad is no error of a machine"),
        ("X [mm], EXX [um]\n0, 0\n100, 3\n", &["--continuous"], "axis X is linear"),
    ] {
        let said = refused(text, options);
        assert!(said.contains("E0509") && said.contains(words), "{text}\n{said}");
    }
    // Half a file of a laser's own program.
    assert!(refused("HEADER::\nFile Version: 7\nTARGETS::\n0.0\n100.0\n", &[]).contains("no header"));
}

#[test]
fn one_error_of_several_is_taken_and_options_are_understood_or_refused() {
    let wide = "X [mm], EXX [um], EYX [um]\n0, 0, 1\n10, 2, 3\n";
    let tidy = "error,value,unit,X [mm]\nEXX,0,um,0\nEYX,1,um,0\nEXX,2,um,10\nEYX,3,um,10\n";
    for text in [wide, tidy] {
        let table = imported(text.as_bytes(), &["--error", "EYX", "--keep-line"]).1;
        assert_eq!(without_comments(&table), "X [mm], EYX [um]\n0, 1\n10, 3\n", "{text}");
        assert!(refused(text, &["--error", "EZX"]).contains("EZX"), "{text}");
        assert!(refused(text, &["--error", "nope"]).contains("`nope` is not a component error"));
        assert!(refused(text, &["--unit", "parsec"]).contains("`parsec` is not a unit"));
    }
}

#[test]
fn one_reading_a_row() {
    let mut text = "axis\terror\tposition [mm]\trun\tdirection\tvalue\tunit\treason\n".to_owned();
    for (i, _) in MEANS.iter().enumerate() {
        for k in 0..4 {
            let way = ["forward", "reverse"][k % 2];
            text += &format!("X\tEXX\t{}\t{}\t{way}\t{}\tnm\t\n", i * 100, k / 2, value(i, k % 2, k / 2) * 1e3);
        }
    }
    text += "X\tEXX\t100\t9\tforward\t99\tum\tprobe was bumped\nX\tEYY\t100\t9\tforward\t1\tum\t\n";
    let (report, table) = imported(text.as_bytes(), &["--axis", "X"]);
    check(&report, 2);
    assert_eq!(without_comments(&table), TABLE);
    let reasons: Vec<&str> =
        report["left_out"].as_array().unwrap().iter().map(|l| l["reason"].as_str().unwrap()).collect();
    assert_eq!(
        reasons,
        ["marked `probe was bumped`", "`EYY` is an error of axis Y, but axis X moved: correct `--error` or `--axis`"]
    );
}

#[test]
fn six_errors_in_one_run_with_a_row_of_units_and_vdi_names() {
    let text = "X;xtx;EYX;xrz\nmm;µm;nm;arcsec\n0;1;2000;1\n10;2;3000;2\n";
    let (report, table) = imported(text.as_bytes(), &["--correction", "--keep-line"]);
    assert_eq!(report["errors"].as_array().unwrap().len(), 3);
    let arcsec = 1e6 * std::f64::consts::PI / 648_000.0;
    assert!(table.starts_with("X [mm], EXX [um], EYX [um], ECX [urad]\n0, -1, -2, -"), "{table}");
    let last = table.lines().nth(1).unwrap().rsplit(", ").next().unwrap();
    assert!((last.parse::<f64>().unwrap() + arcsec).abs() < 1e-6, "{table}");
}

#[test]
fn a_turning_axis_closes_and_the_table_is_one_that_machines_take() {
    let rows: String = (0..=12).map(|i| format!("{},{}\n", i * 30 - 180, f64::from(i % 12))).collect();
    let (_, table) = imported(format!("C [deg],ECC [urad]\n{rows}").as_bytes(), &["--continuous"]);
    let folder = Folder::new();
    folder.write("c.csv", &table);
    let text = "abbe: 1\nmachine: M\nchain: \"w C' b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 9 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 9 mm], origin: [0, 0, 0] }\n  Z: { travel: [0 mm, 9 mm], origin: [0, 0, 0] }\n  C: { travel: continuous }\nmeasured: [c.csv]\n";
    let machine = folder.write("machine.yaml", text);
    let output = run(&["check", machine.to_str().unwrap()]);
    assert!(output.status.success(), "{}\n{table}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(table.lines().count(), 14);
}

#[test]
fn hostile_exports_are_refused_in_words() {
    let folder = Folder::new();
    let said = |bytes: &[u8], options: &[&str]| {
        let file = folder.path("laser.csv");
        std::fs::write(&file, bytes).unwrap();
        let out = folder.path("none.csv");
        let mut arguments = vec!["import", file.to_str().unwrap(), "--out", out.to_str().unwrap()];
        arguments.extend(options);
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(!out.exists());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    for text in [
        "",
        "just words\n",
        "1,2\n3,4\n",
        "X [mm],EXX\n0,1\n",
        "X [mm],EXX [urad]\n0,1\n",
        "X [mm],EYY [um]\n0,1\n",
        "X [urad/mm],EXX [um]\n0,1\n",
        "position,1,2\n0,1,2\n",
        "X [mm],1,2\n0,1,2\n",
        "X [mm],EXX [um]\n",
        "X [mm],EXX [um]\nnan,1\n0,inf\n1e9,1\n,1\n1\n",
        "X [mm],EXX [um]\n0,1e9\n",
        "error,value,unit\nEXX,1,um\n",
    ] {
        assert!(said(text.as_bytes(), &[]).contains("E0509"), "{text}");
    }
    assert!(said(b"X [mm],1\n0,1\n", &["--error", "EXX", "--unit", "furlong"]).contains("E0509"));
    assert!(said(b"X [mm],1\n0,1\n", &["--error", "EC0Y", "--unit", "um"]).contains("E0509"));
    assert!(said(&[0xff, 0xfe, 0x00], &[]).contains("E0104"));
    // Bytes that are no text stay refused: a control character, and a byte that Windows-1252 does not have.
    assert!(said(b"X,\xb5\x01\n", &[]).contains("E0104"));
    assert!(said(b"X,\x81\n", &[]).contains("E0104"));
}

/// The refusal of an export; nothing is written.
fn refused(text: &str, options: &[&str]) -> String {
    let folder = Folder::new();
    let (file, out) = (folder.write("laser.csv", text), folder.path("x.csv"));
    let mut arguments = vec!["import", file.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(options);
    let output = run(&arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && !out.exists(), "{text}\n{said}");
    said
}

#[test]
fn the_table_is_not_written_over_the_export() {
    let folder = Folder::new();
    let text = "X [mm],EXX [um]\n0,1\n100,2\n";
    let file = folder.write("laser.csv", text);
    let output = run(&["import", file.to_str().unwrap(), "--out", file.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && said.contains("E0630"), "{said}");
    assert_eq!(std::fs::read_to_string(file).unwrap(), text);
}

#[test]
fn a_turning_axis_has_its_seam_read_at_both_ends_of_a_pass() {
    let column = |rows: &[(i32, f64)]| {
        let rows: String = rows.iter().map(|(at, value)| format!("{at},{value}\n")).collect();
        imported(format!("C [deg],ECC [urad]\n{rows}").as_bytes(), &["--continuous"])
    };
    // 0 and 360 are one place read twice in one pass: its mean, no second run and no direction.
    let (report, table) = column(&[(0, 1.0), (90, 5.0), (180, 6.0), (270, 7.0), (360, 3.0)]);
    assert_eq!(table, "C [deg], ECC [urad]\n0, 2\n90, 5\n180, 6\n270, 7\n360, 2\n");
    assert_eq!(report["directions_inferred"], false);
    assert!(report["errors"][0]["R"].is_null() && report["errors"][0]["runs"] == 1, "{report}");
    let (_, table) = column(&[(-180, 1.0), (-90, 5.0), (0, 6.0), (90, 7.0), (180, 3.0)]);
    assert_eq!(table, "C [deg], ECC [urad]\n0, 6\n90, 7\n180, 2\n270, 5\n360, 6\n");
    let there = [(0, 1.0), (120, 5.0), (240, 6.0), (360, 3.0)];
    let back = [(360, 4.0), (240, 8.0), (120, 9.0), (0, 8.0)];
    let (report, table) = column(&[there, back].concat());
    assert_eq!(table, "C [deg], ECC+ [urad], ECC- [urad]\n0, 2, 6\n120, 5, 9\n240, 6, 8\n360, 2, 6\n");
    assert!(report["directions_inferred"] == true && report["errors"][0]["R"].is_null(), "{report}");
}

#[test]
fn a_jump_back_begins_a_run_and_is_no_approach() {
    let value = |target: usize, run: usize| [1.0, 3.0, 5.0][target] + [0.5, 0.0, -0.5][run];
    let rows = |named: bool, down: bool| -> String {
        let order: Vec<usize> = if down { vec![2, 1, 0] } else { vec![0, 1, 2] };
        let row = |run: usize, i: &usize| match named {
            true => format!("{},{},{}\n", run + 1, i * 100, value(*i, run)),
            false => format!("{},{}\n", i * 100, value(*i, run)),
        };
        (0..3).flat_map(|run| order.iter().map(move |i| row(run, i))).collect()
    };
    for (text, name) in [
        (format!("X [mm],EXX [um]\n{}", rows(false, false)), "one column"),
        (format!("X [mm],EXX [um]\n{}", rows(false, true)), "falling"),
        (format!("run,X [mm],EXX [um]\n{}", rows(true, false)), "named"),
    ] {
        let (report, table) = imported(text.as_bytes(), &[]);
        assert_eq!(table, "X [mm], EXX [um]\n0, 1\n100, 3\n200, 5\n", "{name}");
        assert_eq!(
            (&report["errors"][0]["runs"], &report["directions_inferred"]),
            (&3.into(), &false.into()),
            "{name}: {report}"
        );
    }
    // Two runs that each go in one direction: their directions are those within each.
    let (_, table) = imported(b"run,X [mm],EXX [um]\n1,0,1\n1,100,2\n1,200,3\n2,200,6\n2,100,5\n2,0,4\n", &[]);
    assert_eq!(table, "X [mm], EXX+ [um], EXX- [um]\n0, 1, 4\n100, 2, 5\n200, 3, 6\n");
}

#[test]
fn directions_are_known_of_all_readings_or_of_none() {
    let options = ["--error", "EXX", "--unit", "um"];
    for pair in ["V1;R1", "v 1;r 1", "vor;zurück", "Vorwärts 1;RÜCKWÄRTS 1", "1→;1←", "→;←", "hin;zurueck"]
    {
        let text = format!("X [mm];{pair}\n0;1;2\n100;3;4\n");
        let (_, table) = imported(text.as_bytes(), &options);
        assert_eq!(table, "X [mm], EXX+ [um], EXX- [um]\n0, 1, 2\n100, 3, 4\n", "{pair}");
    }
    // The runs are no axes: the axis is that of the error.
    let (_, table) = imported(b"position [mm];V1;R1\n0;1;2\n100;3;4\n", &options);
    assert_eq!(table, "X [mm], EXX+ [um], EXX- [um]\n0, 1, 2\n100, 3, 4\n");
    // Without the other letter of the pair `R1` is a run.
    let (_, table) = imported(b"X [mm];R1;R2\n0;1;2\n100;3;4\n", &[&options[..], &["--runs", "one-way"]].concat());
    assert_eq!(table, "X [mm], EXX [um]\n0, 1.5\n100, 3.5\n");
    let said = refused("X [mm];1+;2\n0;1;2\n100;3;4\n", &options);
    assert!(said.contains("E0509") && said.contains("laser.csv:1") && said.contains("EXX"), "{said}");
    let said = refused("X [mm],EXX+ [um],EXX [um]\n0,1,2\n100,3,4\n", &[]);
    assert!(said.contains("E0509") && said.contains("laser.csv:1"), "{said}");
    let said = refused("X [mm],direction,EXX [um]\n0,+,1\n100,,2\n", &[]);
    assert!(said.contains("E0509") && said.contains("laser.csv:3"), "{said}");
}

#[test]
fn decimal_comma_and_point_in_one_file_are_refused() {
    for text in
        ["X [mm];EXX [um]\n0;1,5\n1.000;2,5\n", "X [mm];EXX [um]\n0,0;1\n1.5;2\n", "X [mm];EXX [um]\n0;1\n2.000,5;2\n"]
    {
        let said = refused(text, &[]);
        assert!(said.contains("E0509") && said.contains("laser.csv:3") && said.contains("decimal"), "{said}");
    }
    // Dates and words are no numbers.
    let (_, table) = imported(b"time;X [mm];EXX [um]\n1.5;0;1,5\n2.5;100;2,5\n", &[]);
    assert_eq!(table, "X [mm], EXX [um]\n0, 1.5\n100, 2.5\n");
}

#[test]
fn positions_that_scatter_about_a_target_are_one_target() {
    let off = [1e-4, -1e-4, 3e-4, -2e-4];
    let turn = std::cell::Cell::new(0);
    let rows = zigzag(|target, v| {
        turn.set((turn.get() + 1) % 4);
        format!("{},{v}\n", 100.0 * f64::from(u8::try_from(target).unwrap()) + off[turn.get()])
    });
    let (report, table) = imported(format!("X [mm],EXX [um]\n{rows}").as_bytes(), &[]);
    check(&report, 2);
    assert_eq!(table, TABLE);
    // Targets a micrometre apart are targets: nothing distinguishes scatter from steps.
    let rows: String = (0..5).map(|i| format!("0.00{i},{i}\n")).collect();
    let (report, _) = imported(format!("X [mm],EXX [um]\n{rows}").as_bytes(), &[]);
    assert_eq!(report["errors"][0]["targets"], 5, "{report}");
    // And ten micrometres apart beside steps that are not much larger.
    let (report, _) = imported(b"X [mm],EXX [um]\n0,1\n0.01,2\n0.11,3\n0.21,4\n", &[]);
    assert_eq!(report["errors"][0]["targets"], 4, "{report}");
    let said = refused("X [mm],EXX+ [um],EXX- [um]\n0,1,\n100,,2\n", &[]);
    assert!(said.contains("E0509") && said.contains("no row"), "{said}");
}

#[test]
fn what_german_instruments_write_is_read() {
    let (_, table) = imported(b"Pr\xfcfer: M\xfcller\nX [mm];EXX [\xb5m]\n0;1,5\n100;2,5\n", &[]);
    assert_eq!(table, "# Pr\u{fc}fer: M\u{fc}ller\nX [mm], EXX [um]\n0, 1.5\n100, 2.5\n");
}

#[test]
fn a_column_says_the_axis() {
    let text = "axis,error,position [mm],value,unit\nY,EYY,0,1,um\nY,EYY,100,2,um\n";
    let (report, table) = imported(text.as_bytes(), &[]);
    assert_eq!((table.as_str(), &report["axis"]), ("Y [mm], EYY [um]\n0, 1\n100, 2\n", &"Y".into()));
    let both = format!("{text}X,EXX,0,1,um\n");
    let said = refused(&both, &[]);
    assert!(said.contains("E0509") && said.contains("`Y` and `X`") && said.contains("--axis"), "{said}");
    let (report, _) = imported(both.as_bytes(), &["--axis", "Y"]);
    let left = report["left_out"].as_array().unwrap();
    assert_eq!((left.len(), left[0]["reason"].as_str()), (1, Some("a row of axis X")), "{report}");
}

#[test]
fn errors_that_have_columns_say_the_axis() {
    let (report, table) = imported(b"position [deg],ECC [urad],EXC [um]\n0,1,2\n90,2,3\n", &[]);
    assert_eq!((table.as_str(), &report["axis"]), ("C [deg], ECC [urad], EXC [um]\n0, 1, 2\n90, 2, 3\n", &"C".into()));
    let said = refused("position [mm],EXX [um],EYY [um]\n0,1,2\n", &[]);
    assert!(said.contains("the file does not say which axis moved"), "{said}");
}

#[test]
fn two_targets_in_turns_are_read_in_one_direction() {
    let (report, table) = imported(b"X [mm],EXX [um]\n0,1\n100,2\n0,1.5\n100,2.5\n", &[]);
    assert_eq!(table, "X [mm], EXX [um]\n0, 1.25\n100, 2.25\n", "{report}");
}

#[test]
fn an_axis_that_the_header_does_not_have_is_said() {
    let said = refused("Axis: Y\nX [mm],EXX [um]\n0,1\n", &[]);
    assert!(said.contains("laser.csv:2") && said.contains("axis Y") && said.contains("`X`"), "{said}");
}
