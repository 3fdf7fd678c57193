//! Figures of standards from readings: closed forms, and a virtual instrument whose figures are formed elsewhere.

use crate::program::{Folder, abbe, abbe_on, json, refused, well_formed};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

fn near(found: &Value, expected: f64, within: f64) {
    assert!((number(found) - expected).abs() <= within, "{found} instead of {expected}");
}

/// Means at 0, 100, 200: forward 0, 2, 4 um, reverse 1, 3, 5 um, two runs 0.5 um about them: s = sqrt(0.5) um.
const RUNS: &str =
    "X [mm],1+ [um],1- [um],2+ [um],2- [um]\n0,0.5,1.5,-0.5,0.5\n100,2.5,3.5,1.5,2.5\n200,4.5,5.5,3.5,4.5\n";

#[test]
fn positioning_has_figures_of_each_direction_and_their_uncertainty() {
    let folder = Folder::new("figures-positioning");
    let file = folder.with("runs.csv", RUNS).display().to_string();
    let svg = folder.file("runs.svg").display().to_string();
    let words = ["device 0.5 um/m", "drift 10 um", "expansion 2 um/m/K x 5 K"];
    let stated: Vec<&str> = words.iter().flat_map(|words| ["--uncertainty", words]).collect();
    let basic = ["import", &file, "--error", "EXX", "--format", "json", "--svg", &svg];
    let report = json(&[&basic[..], &stated].concat());
    let error = &report["errors"][0];
    let s = 0.5_f64.sqrt();
    for way in ["forward", "reverse"] {
        near(&error["one_way"][way]["E"], 4.0, 1e-9);
        near(&error["one_way"][way]["R"], 4.0 * s, 1e-9);
        near(&error["one_way"][way]["A"], 4.0 + 4.0 * s, 1e-9);
    }
    // B has no sign, the reversals of the targets have.
    near(&error["B"], 1.0, 1e-9);
    near(&error["mean_B"], -1.0, 1e-9);
    let targets = error["at_targets"].as_array().unwrap();
    assert_eq!(targets.len(), 3);
    for (k, target) in targets.iter().enumerate() {
        near(&target["B"], -1.0, 1e-9);
        near(&target["forward"]["mean"], 2.0 * k as f64, 1e-9);
        near(&target["reverse"]["s"], s, 1e-9);
    }
    // Over 200 mm: 0.1 um of the device, 0.6 * 10 um/m of the expansion; 6 um of drift, two runs.
    let (common, drift) = (0.1_f64.powi(2) + 1.2_f64.powi(2), 36.0);
    let u = &error["U"];
    near(&u["E"], (common + drift / 2.0).sqrt(), 1e-9);
    near(&u["M"], (common + drift / 4.0).sqrt(), 1e-9);
    near(&u["B"], 6.0, 1e-9);
    near(&u["R"], 12.0, 1e-9);
    near(&u["A"], (common + drift / 2.0 + 144.0).sqrt(), 1e-9);
    let remarks = error["remarks"].as_array().unwrap();
    assert_eq!(remarks.len(), 3, "{remarks:?}");
    let picture = std::fs::read_to_string(&svg).unwrap();
    well_formed(&picture).unwrap();
    assert!(picture.contains("EXX, E 5, B 1") && picture.matches("<circle").count() >= 12, "{picture}");
    let said = abbe(&[&["import", &file, "--error", "EXX"][..], &stated].concat());
    assert!(said.contains("not verified against the text of the standard") && said.contains("even pitch"), "{said}");
    assert!(json(&basic[..6])["errors"][0]["U"].is_null());
    for wrong in ["laser 1 um", "drift 1 um/m", "device -1 um", "temperature 3 K"] {
        let (status, message) = refused(&["import", &file, "--error", "EXX", "--uncertainty", wrong]);
        assert!(status == 2 && message.contains("is no uncertainty"), "{wrong}: {message}");
    }
}

/// 5 K above 20 degC at 10 um/(m K) are 50 um/m too long.
#[test]
fn positions_are_brought_to_the_reference_temperature() {
    let folder = Folder::new("figures-material");
    let file = folder.with("runs.csv", RUNS).display().to_string();
    let out = folder.file("table.csv").display().to_string();
    let at = |error: &str, words: &str| {
        let material = ["--material", words, "--out", &out, "--keep-line"];
        json(&[&["import", &file, "--error", error, "--axis", "X", "--format", "json"], &material[..]].concat())
    };
    let report = at("EXX", "25 degC x 10 um/m/K");
    // Forward 0, -3, -6, reverse 1, -2, -5.
    near(&report["errors"][0]["E"], 7.0, 1e-9);
    near(&report["errors"][0]["slope"], -30.0, 1e-9);
    near(&report["material"]["expansion_um_per_m_k"], 10.0, 1e-9);
    let table = std::fs::read_to_string(&out).unwrap();
    assert!(table.contains("200, -6, -5"), "{table}");
    // A straightness does not grow.
    near(&at("EYX", "25 degC x 10 um/m/K")["errors"][0]["E"], 5.0, 1e-9);
    let (status, message) = refused(&["import", &file, "--error", "EXX", "--material", "25 K"]);
    assert!(status == 2 && message.contains("is no material"), "{message}");
}

/// The path of a machine: squareness 40 urad, scale 20 um/m, lost motion 3 and 5 um, 2 um of lag, ball off by 6 and -4 um.
fn path(angle: f64, sense: f64) -> f64 {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let (along, up) = (-sine * sense, cosine * sense);
    let x = 150.0 * cosine * (1.0 + 20e-6) - 1.5e-3 * along.signum() - 2e-3 * along;
    let y = 150.0 * sine - 2.5e-3 * up.signum();
    (x - 40e-6 * y - 6e-3).hypot(y + 4e-3)
}

#[test]
fn a_circle_is_taken_apart() {
    let folder = Folder::new("figures-circle");
    let angles = || (0..180).map(|i| 2.0 * f64::from(i) + 1.0);
    let um = |angle: f64, sense: f64| (path(angle, sense) - 150.0) * 1e3;
    let columns: String = angles().map(|a| format!("{a};{};{}\n", um(a, 1.0), um(a, -1.0))).collect();
    let columns = folder.with("columns.csv", &format!("angle [deg];ccw [um];cw [um]\n{columns}"));
    let one =
        |sense: f64, word: &str| -> String { angles().map(|a| format!("{a},{},{word}\n", path(a, sense))).collect() };
    let rows =
        folder.with("rows.csv", &format!("angle [deg],length [mm],sense\n{}{}", one(1.0, "CCW"), one(-1.0, "cw")));
    let reports = [columns, rows].map(|file| {
        json(&["figures", "circle", file.to_str().unwrap(), "--radius", "150", "--feed", "1200", "--format", "json"])
    });
    for report in &reports {
        let causes = &report["causes"];
        near(&causes["squareness_urad"]["value"], 40.0, 0.05);
        near(&causes["scale_mismatch_um_per_m"]["value"], 20.0, 0.05);
        near(&causes["reversal_um"][0]["value"], -3.0, 0.01);
        near(&causes["reversal_um"][1]["value"], -5.0, 0.01);
        // The first axis alone lags by 2 um of path: half of it outwards at 45 deg, and 0.1 ms at 20 mm/s.
        near(&causes["servo_um"]["value"], 1.0, 0.01);
        near(&causes["servo_ms"]["value"], 0.1, 0.001);
        near(&report["centre_um"][0], -6.0, 0.6);
        let largest = angles().map(|a| um(a, 1.0)).fold(f64::NEG_INFINITY, f64::max);
        let smallest = angles().map(|a| um(a, 1.0)).fold(f64::INFINITY, f64::min);
        near(&report["radial_max_min_um"]["counter_clockwise"][0], largest, 1e-6);
        near(&report["radial_max_min_um"]["counter_clockwise"][1], smallest, 1e-6);
    }
    near(&reports[0]["bidirectional_um"], number(&reports[1]["bidirectional_um"]), 1e-6);
}

/// The readings of a ball bar that the program imagines on a machine, evaluated as if they came from the shop floor.
#[test]
fn a_circle_has_the_figures_of_the_virtual_ball_bar() {
    let folder = Folder::new("figures-ball-bar");
    let trunnion = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/trunnion.yaml");
    let machine = ["instrument", trunnion, "ball-bar", "--plane", "xy", "--radius", "120"];
    let expected = &json(&[&machine[..], &["--format", "json"]].concat())["planes"][0];
    let csv = abbe(&[&machine[..], &["--format", "csv"]].concat());
    let readings: String = csv.lines().map(|line| format!("{}\n", line.split_once(',').unwrap().1)).collect();
    let file = folder.with("bar.csv", &readings).display().to_string();
    let svg = folder.file("circle.svg").display().to_string();
    let found = json(&["figures", "circle", &file, "--radius", "120", "--svg", &svg, "--format", "json"]);
    for sense in ["counter_clockwise", "clockwise"] {
        near(&found["circular_deviation_um"][sense], number(&expected["circular_deviation_um"][sense]), 1e-9);
        for end in 0..2 {
            near(&found["radial_max_min_um"][sense][end], number(&expected["radial_max_min_um"][sense][end]), 1e-9);
        }
    }
    near(&found["bidirectional_um"], number(&expected["bidirectional_um"]), 1e-9);
    near(&found["mean_radial_um"], number(&expected["mean_radial_um"]), 1e-9);
    // Beside the reversals: those turn about both ways and leave the second harmonic as it is.
    near(&found["causes"]["squareness_urad"]["value"], number(&expected["squareness_urad"]), 1e-6);
    let picture = std::fs::read_to_string(&svg).unwrap();
    well_formed(&picture).unwrap();
    assert!(picture.contains("XY: G(b)"), "{picture}");
}

/// Two probes on an artefact 20 um off the axis, a second harmonic of 1.5 um in X, a tilt of 10 urad twice a turn, two
/// turns 0.4 um apart along Z.
#[test]
fn an_axis_of_rotation_has_its_error_motions() {
    let folder = Folder::new("figures-rotation");
    let row = |i: i32| {
        let angle = 10.0 * f64::from(i);
        let (t, turn) = (angle.to_radians(), f64::from(i / 36));
        let tilt = 10e-6 * (2.0 * t).cos() * 200.0 * 1e3;
        let (x, y) = (20.0 * t.cos() + 1.5 * (2.0 * t).cos(), 20.0 * t.sin());
        let z = 3.0 * t.sin() + 0.4 * turn;
        format!("{angle},{x},{y},{z},{}\n", x + tilt)
    };
    let rows: String = (0..72).map(row).collect();
    let file = folder.with("turns.csv", &format!("angle [deg],x1 [um],y1 [um],z [um],x2 [um]\n{rows}"));
    let svg = folder.file("turns.svg").display().to_string();
    let file = file.to_str().unwrap();
    let report = json(&["figures", "rotation", file, "--distance", "200", "--svg", &svg, "--format", "json"]);
    let motion = |name: &str| {
        let all = report["motions"].as_array().unwrap();
        all.iter().find(|motion| motion["motion"] == name).unwrap_or_else(|| panic!("{name}: {report}")).clone()
    };
    let x = motion("x1");
    near(&x["once"], 20.0, 1e-9);
    near(&x["synchronous"], 3.0, 1e-9);
    near(&x["asynchronous"], 0.0, 1e-9);
    let z = motion("z");
    near(&z["asynchronous"], 0.4, 1e-9);
    near(&z["once"], 3.0, 1e-9);
    near(&z["synchronous"], 0.0, 1e-9);
    near(&z["synchronous_with_once"], 6.0 * 80.0_f64.to_radians().sin().max(90.0_f64.to_radians().sin()), 1e-9);
    near(&motion("tilt x")["synchronous"], 20.0, 1e-9);
    assert_eq!(motion("tilt x")["unit"], "urad");
    // 20 um all the way round is a radius; cos 2t cos t is (cos t + cos 3t) / 2.
    near(&motion("rotating x1, y1")["once"], 0.75, 1e-9);
    near(&motion("rotating x1, y1")["synchronous"], 1.5, 1e-9);
    well_formed(&std::fs::read_to_string(&svg).unwrap()).unwrap();
}

#[test]
fn drift_has_ranges_and_tilts() {
    let folder = Folder::new("figures-drift");
    let row = |i: i32| {
        let hours = f64::from(i) / 12.0;
        let grown = 20.0 * (1.0 - (-hours).exp());
        format!("{},{},{},{},{}\n", 5 * i, grown, grown * 1.5, -grown, 20.0 + hours)
    };
    let rows: String = (0..49).map(row).collect();
    let file = folder.with("drift.csv", &format!("time [min],x1 [um],x2 [um],z [um],air [degC]\n{rows}"));
    let svg = folder.file("drift.svg").display().to_string();
    let file = file.to_str().unwrap();
    let report = json(&["figures", "drift", file, "--distance", "100", "--svg", &svg, "--format", "json"]);
    let hour = 20.0 * (1.0 - (-1.0_f64).exp());
    let whole = 20.0 * (1.0 - (-4.0_f64).exp());
    let (x, z, tilt) = (&report["drifts"][0], &report["drifts"][2], &report["drifts"][3]);
    for (key, expected) in [("range", whole), ("first_hour", hour), ("largest_in_an_hour", hour), ("change", whole)] {
        near(&x[key], expected, 1e-9);
    }
    near(&z["change"], -whole, 1e-9);
    // 0.5 of 20 um over 100 mm, about Y.
    assert_eq!((&tilt["drift"], &tilt["unit"]), (&"tilt B".into(), &"urad".into()));
    near(&tilt["change"], 5.0 * whole, 1e-6);
    near(&report["temperatures"][0]["deg_c"][1], 24.0, 1e-9);
    well_formed(&std::fs::read_to_string(&svg).unwrap()).unwrap();
}

/// The readings of the virtual laser give the figures that it forms itself; a table of one's own gives those of hand.
#[test]
fn diagonals_have_the_figures_of_the_virtual_laser() {
    let folder = Folder::new("figures-diagonals");
    let machine = "vmc-cframe-754.yaml";
    let file = folder.with("laser.csv", &abbe(&["instrument", machine, "diagonals", "--format", "csv"]));
    let (file, svg) = (file.display().to_string(), folder.file("d.svg").display().to_string());
    let own = json(&["instrument", machine, "diagonals", "--format", "json"]);
    let found = json(&["figures", "diagonals", &file, "--svg", &svg, "--format", "json"]);
    near(&found["e_d_um"], own["e_um"].as_f64().unwrap(), 1e-9);
    let list = found["diagonals"].as_array().unwrap();
    assert_eq!((list.len(), &found["note"]), (4, &"not verified against the text of the standard".into()));
    for (found, own) in list.iter().zip(own["diagonals"].as_array().unwrap()) {
        assert_eq!((&found["diagonal"], &found["r_um"]), (&own["name"], &Value::Null));
        near(&found["e_um"], own["e_d_um"].as_f64().unwrap(), 1e-9);
        near(&found["b_um"], own["b_d_um"].as_f64().unwrap(), 1e-9);
    }
    well_formed(&std::fs::read_to_string(&svg).unwrap()).unwrap();
    // Two runs: means there 0, 4, back 1, 7; deviations root 2 and 0.
    let rows = "ppp;0;0;1\nppp;500;3;7\nppp;0;0;1\nppp;500;5;7\nnpp;0;0;0\nnpp;500;-2;\n";
    let file = folder.with("own.csv", &format!("diagonal;way [mm];there [um];back [um]\n{rows}")).display().to_string();
    let found = json(&["figures", "diagonals", &file, "--format", "json"]);
    let ppp = &found["diagonals"][0];
    assert_eq!((&ppp["runs"], &ppp["targets"], &found["readings"]), (&2.into(), &2.into(), &11.into()));
    for (key, value) in [("e_um", 7.0), ("b_um", 3.0), ("mean_b_um", -2.0), ("m_um", 5.0), ("length_mm", 500.0)] {
        near(&ppp[key], value, 1e-9);
    }
    // 4 s there, and 2 s there + B; mean + 2 s against mean - 2 s.
    let s = 2.0_f64.sqrt();
    near(&ppp["r_um"], (2.0 * s + 3.0).max(4.0 * s), 1e-9);
    near(&ppp["a_um"], 7.0_f64.max(4.0 + 2.0 * s) - 0.0_f64.min(4.0 - 2.0 * s), 1e-9);
    near(&found["e_d_um"], 7.0, 1e-9);
    near(&found["b_d_um"], 3.0, 1e-9);
}

/// A column is a reading by its unit, or it is left out by name.
#[test]
fn columns_that_are_no_readings_are_left_out_by_name() {
    let folder = Folder::new("figures-columns");
    let rows: String = (0..24).map(|i| format!("{},{},7,1\n", 15 * i, i % 2)).collect();
    for (test, title) in
        [("circle", "angle [deg],ccw [um],index,temperature"), ("rotation", "angle [deg],x [um],index,y")]
    {
        let file = folder.with("readings.csv", &format!("{title}\n{rows}")).display().to_string();
        let output = abbe_on(2, &["figures", test, &file]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let last = title.rsplit(',').next().unwrap();
        let words = format!("2 columns left out, not understood: `index`, `{last}`");
        assert!(output.status.success() && said.contains("W0511") && said.contains(&words), "{test}: {said}");
    }
}

#[test]
fn readings_that_carry_no_figure_are_refused() {
    let folder = Folder::new("figures-refused");
    for (test, text, words) in [
        ("circle", "", "empty"),
        ("diagonals", "way [mm],there [um]\n0,1\n", "names of diagonals"),
        ("diagonals", "diagonal,there [um]\nppp,1\n", "ways along the diagonals"),
        ("diagonals", "diagonal,way [mm]\nppp,1\n", "no column of readings"),
        ("diagonals", "diagonal,way [mm],there [um]\nppp,1,1\nppp,1,2\n", "has one target"),
        ("diagonals", "diagonal,way [mm],there\nppp,1,1\n", "has no unit"),
        ("circle", "ccw [um]\n1\n", "no column of angles"),
        ("circle", "angle [deg],ccw\n0,1\n90,1\n200,1\n", "has no unit"),
        ("circle", "angle [deg],ccw [urad]\n0,1\n90,1\n200,1\n", "not a unit"),
        ("circle", "angle [deg],ccw [um]\n0,1\n10,2\n20,3\n30,1\n", "deg of the circle"),
        ("circle", "angle [deg],ccw [um]\n0,1\n70,2\n140,1\n", "3 readings, and those of one sense are on 140 deg"),
        ("circle", "angle [deg],ccw [um]\n0,0\n100,2\n", "2 readings, and those of one sense are on 100 deg"),
        ("circle", "angle [deg],deviation [um]\n0,1\n120,2\n240,3\n", "sense of rotation"),
        ("circle", "angle [deg],deviation [um],sense\n0,1,left\n", "is no sense"),
        ("circle", "angle [deg],ccw [um],ccw [um]\n0,1,1\n", "twice"),
        ("circle", "angle [deg],ccw [um]\n0,1,2\n", "3 cells under 2 columns"),
        ("circle", "angle [deg],ccw [um]\n0,1e300\n", "beyond"),
        ("circle", "angle [deg],ccw [um]\n0,nan\n", "nan"),
        ("rotation", "angle [deg],x [um]\n0,1\n90,1\n180,2\n", "no error motion"),
        ("rotation", "angle [deg],x [um]\n0,1\n90,\n180,2\n", "empty cells"),
        ("drift", "time [min],x [um]\n0,1\n5,2\n3,3\n", "row 3 is before"),
        ("drift", "time,x [um]\n0,1\n", "no unit"),
        ("drift", "time [min],air [degC]\n0,20\n", "no reading of a probe"),
    ] {
        let file = folder.with("readings.csv", text).display().to_string();
        let (status, message) = refused(&["figures", test, &file]);
        assert!(status == 1 && message.contains(words), "{test} {text:?}: {message}");
        assert!(message.contains("readings.csv:"), "no place: {test} {text:?}: {message}");
    }
    let file = folder.with("good.csv", "angle [deg],ccw [um]\n0,1\n120,1\n240,1\n").display().to_string();
    for wrong in [["--radius", "0"], ["--radius", "nan"], ["--feed", "-1"], ["--distance", "0"]] {
        assert_eq!(refused(&["figures", "circle", &file, wrong[0], wrong[1]]).0, 2, "{wrong:?}");
    }
}
