//! The straight line in a straightness: set-up of the optics, or squareness with a sign.

use super::identify::{json, run};
use super::oracle::program::Folder;
use serde_json::Value;

const MACHINE: &str = "abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm] }\n  \
                       Y: { travel: [0 mm, 500 mm] }\n  Z: { travel: [0 mm, 500 mm] }\ntool: { length: 100 mm }\n";

fn imported(text: &str, options: &[&str]) -> (Value, String) {
    let folder = Folder::new();
    let (file, out) = (folder.write("laser.csv", text), folder.path("x.csv"));
    let mut arguments = vec!["import", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--format", "json"];
    arguments.extend(options);
    let report = json(&run(&arguments));
    let table = std::fs::read_to_string(out).unwrap();
    (report, table.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect())
}

/// Optics 55 um/m askew, a bow of 4 um, lost motion of 1 um.
fn askew() -> String {
    let rows = (0..=10).map(|i| {
        let x = f64::from(i) * 50.0;
        let value = 7.0 + 0.055 * x + [0.0, 4.0][usize::from(i == 5)];
        format!("{x},{},{}\n", value - 0.5, value + 0.5)
    });
    format!("X [mm],EYX+ [um],EYX- [um]\n{}", rows.collect::<String>())
}

#[test]
fn the_line_is_taken_off_and_its_size_is_said() {
    let (report, table) = imported(&askew(), &[]);
    let line = &report["errors"][0]["line"];
    assert_eq!((&line["taken_off"], &line["squareness"]), (&true.into(), &"EC0Y".into()), "{report}");
    // The bow in the middle is symmetric: it has no slope, and 4/11 um of offset.
    for (key, expected) in
        [("slope_um_per_m", 55.0), ("rise_um", 27.5), ("length_mm", 500.0), ("squareness_urad", -55.0)]
    {
        assert!((line[key].as_f64().unwrap() - expected).abs() < 1e-6, "{key}: {line}");
    }
    let cells = |row: usize| -> Vec<f64> {
        table.lines().nth(row).unwrap().split(", ").map(|cell| cell.parse().unwrap()).collect()
    };
    let near = |row: usize, values: [f64; 2]| {
        let off: Vec<f64> = cells(row)[1..].iter().zip(values).map(|(a, b)| (a - b).abs()).collect();
        assert!(off.iter().all(|off| *off < 1e-5), "{off:?} {table}");
    };
    let share = 4.0 / 11.0;
    near(1, [-share - 0.5, -share + 0.5]);
    near(6, [4.0 - share - 0.5, 4.0 - share + 0.5]);
    let figure = |key: &str| report["errors"][0][key].as_f64().unwrap();
    assert!((figure("E") - 5.0).abs() < 1e-6 && (figure("B") - 1.0).abs() < 1e-6 && figure("slope").abs() < 1e-6);
    let (report, table) = imported(&askew(), &["--keep-line"]);
    assert!(table.contains("0, 6.5, 7.5\n") && table.contains("500, 34, 35\n"), "{table}");
    assert_eq!(report["errors"][0]["line"]["taken_off"], false);
}

/// A cubic of 10 um over 1 m: least squares and end points differ as Legendre's polynomials say.
#[test]
fn end_points_are_another_line() {
    let rows: String = (0..=200)
        .map(|i| {
            let t = f64::from(i) / 100.0 - 1.0;
            format!("{},{}\n", i * 5, 10.0 * t * t * t)
        })
        .collect();
    let text = format!("X [mm],EZX [um]\n{rows}");
    let of = |options: &[&str]| imported(&text, options).0["errors"][0]["line"]["slope_um_per_m"].as_f64().unwrap();
    // t^3 = 3/5 t + ...: 12 um/m in the continuum, and 1 % more on 201 targets.
    let squares: f64 = (0..=200).map(|i| (f64::from(i) / 100.0 - 1.0).powi(2)).sum();
    let fourth: f64 = (0..=200).map(|i| (f64::from(i) / 100.0 - 1.0).powi(4)).sum();
    assert!((of(&[]) - 20.0 * fourth / squares).abs() < 1e-6);
    assert!((of(&["--line", "end-points"]) - 20.0).abs() < 1e-6);
}

#[test]
fn only_a_straightness_of_a_linear_axis_has_a_line() {
    for (text, options) in [
        ("X [mm],EXX [um]\n0,0\n100,5\n", &[][..]),
        ("X [mm],EBX [urad]\n0,0\n100,5\n", &[]),
        ("C [deg],EXC [um]\n0,0\n90,5\n", &[]),
    ] {
        let (report, table) = imported(text, options);
        assert!(report["errors"][0]["line"].is_null() && table.lines().last().unwrap().ends_with(", 5"), "{table}");
    }
}

fn checked(lines: &str) -> Vec<String> {
    let folder = Folder::new();
    let file = folder.write("m.yaml", &format!("{MACHINE}{lines}"));
    let output = run(&["check", file.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    said.split("warning[").skip(1).map(str::to_owned).collect()
}

#[test]
fn a_line_that_is_left_is_warned_of() {
    let with = |error: &str, slope: f64, more: &str| {
        checked(&format!("errors:\n  {error}: {{ points: [[0 mm, 0 um], [500 mm, {} um]] }}\n{more}", slope * 0.5))
    };
    for error in ["EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"] {
        assert!(with(error, 9.0, "").is_empty(), "{error}");
        let said = with(error, 55.0, "");
        assert!(said.len() == 1 && said[0].contains("W0403") && said[0].contains("abbe import"), "{said:?}");
        assert!(with(error, 55.0, "identify: { datum: { squareness: in straightness } }\n").is_empty());
        assert_eq!(with(error, 55.0, "identify: { datum: { squareness: in location } }\n").len(), 1);
    }
    // A curve through zero at both ends has a line of least squares, and none through its ends.
    let cubic: Vec<String> = (0..=40)
        .map(|i| {
            let t = f64::from(i) / 20.0 - 1.0;
            format!("[{} mm, {} um]", 12.5 * f64::from(i), 40.0 * (t * t * t - t))
        })
        .collect();
    let bent = |more: &str| checked(&format!("errors:\n  EZX: {{ points: [{}] }}\n{more}", cubic.join(", ")));
    assert!(bent("").len() == 1 && bent("identify: { datum: { line: end-points } }\n").is_empty());
    assert_eq!(with("EYX", 55.0, "identify: { datum: { line: end-points } }\n").len(), 1);
    // Squareness given too: counted twice, wherever the file holds it.
    let both = "  EC0Y: 12 urad\nidentify: { datum: { squareness: in straightness } }\n";
    assert_eq!(with("EYX", 55.0, both).len(), 1);
    // `compile` says it too.
    let folder = Folder::new();
    let text = format!("{MACHINE}errors:\n  EYX: {{ points: [[0 mm, 0 um], [500 mm, 27 um]] }}\n");
    let (file, out) = (folder.write("m.yaml", &text), folder.path("set"));
    let output = run(&["compile", file.to_str().unwrap(), "--target", "linuxcnc", "--out", out.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("W0403"));
}

/// The squareness that the advice names does what the line does: positions of the machine agree but for a rigid motion,
/// which shows in the lengths between them.
#[test]
fn the_squareness_of_the_advice_has_the_sign_of_the_line() {
    let poses = ["X=500,Y=500,Z=0", "X=500,Y=0,Z=500", "X=0,Y=500,Z=500", "X=500,Y=500,Z=500"];
    let diagonals = |lines: &str| -> Vec<f64> {
        let folder = Folder::new();
        let file = folder.write("m.yaml", &format!("{MACHINE}errors:\n  {lines}\n"));
        let length = |pose: &&str| {
            let at = |pose: &str| -> [f64; 3] {
                let output = run(&["eval", file.to_str().unwrap(), "--at", pose, "--format", "json"]);
                let pose = json(&output)["poses"][0].clone();
                std::array::from_fn(|k| pose["nominal"][k].as_f64().unwrap() + pose["deviation"][k].as_f64().unwrap())
            };
            let (from, to) = (at("X=0,Y=0,Z=0"), at(pose));
            (0..3).map(|k| (to[k] - from[k]) * (to[k] - from[k])).sum::<f64>().sqrt()
        };
        poses.iter().map(length).collect()
    };
    for error in ["EYX", "EXY", "EZX", "EXZ", "EZY", "EYZ"] {
        let line = format!("{error}: {{ points: [[0 mm, 0 um], [500 mm, 20 um]] }}");
        let said = checked(&format!("errors:\n  {line}\n"));
        let advice = said[0].split("write it as `").nth(1).unwrap().split('`').next().unwrap().to_owned();
        assert!(advice.contains("40 urad"), "{advice}");
        let off = diagonals(&line).iter().zip(diagonals(&advice)).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        // Lengths of 0.7 m change by 14 um; the second order is 1 nm.
        assert!(off < 2e-6, "{error} {advice}: {off}");
    }
}
