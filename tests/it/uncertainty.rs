//! Intervals of headline figures: closed forms of what an uncertainty leaves of a figure, shared and joint parts, and
//! the covariance that a fit writes, against the formulas of a straight line.

use crate::identify::normal;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json, refused};
use serde_json::Value;

/// Three axes along which deviations are as constant as their errors.
fn machine(folder: &Folder, name: &str, errors: &str) -> String {
    let text = format!(
        "abbe: 1\nmachine: {name}\nchain: \"w Y' b X Z t\"\naxes:\n  X: {{ travel: [0, 500], origin: [0, 0, 0] }}\n  Y: {{ \
         travel: [0, 400], origin: [0, 0, 0] }}\n  Z: {{ travel: [-300, 0], origin: [0, 0, 0] }}\ntool: {{ gauge: [0, 0, 0], \
         length: 100 mm }}\n{errors}"
    );
    folder.with(name, &text).display().to_string()
}

fn interval(value: &Value) -> [f64; 2] {
    [0, 1].map(|i| value[i].as_f64().unwrap())
}

fn near(found: [f64; 2], expected: [f64; 2], within: f64) {
    let off = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
    assert!(off <= within, "{found:?} instead of {expected:?}");
}

const FIGURES: [&str; 4] = ["max", "mean", "rms", "p95"];

#[test]
fn a_constant_deviation_is_as_uncertain_as_its_error() {
    let folder = Folder::new("uncertainty-constant");
    let file = machine(&folder, "m.yaml", "errors:\n  EXX: { value: 10 um, uncertainty: 2 um }\n");
    let found = &json(&["map", &file, "--random", "50", "--format", "json"])["uncertainty"];
    assert_eq!(
        (found["drawn"].as_bool(), found["parts"].as_u64(), found["poses"].as_u64()),
        (Some(false), Some(1), Some(50))
    );
    FIGURES.iter().for_each(|figure| near(interval(&found["position_um"][figure]), [8.0, 12.0], 1e-9));
    FIGURES.iter().for_each(|figure| near(interval(&found["rotation_urad"][figure]), [0.0, 0.0], 1e-9));
    // A machine that states none has none.
    let sure = machine(&folder, "sure.yaml", "errors:\n  EXX: 10 um\n");
    assert!(json(&["map", &sure, "--random", "50", "--format", "json"]).get("uncertainty").is_none());
}

#[test]
fn a_figure_less_than_three_times_its_uncertainty_is_drawn() {
    let folder = Folder::new("uncertainty-drawn");
    let file = machine(&folder, "m.yaml", "errors:\n  EXX: { value: 10 um, uncertainty: 8 um }\n");
    let found = &json(&["map", &file, "--random", "50", "--format", "json"])["uncertainty"];
    assert_eq!(found["drawn"].as_bool(), Some(true));
    // |10 + 4 z|: 1.95996 standard deviations, and P(10 + 4 z < -2.16) = 1.2e-3 folds over. The ends are order
    // statistics of 2000 draws, whose standard deviation is sqrt(0.025 * 0.975 / 2000) / 0.0584 * 4 = 0.24 um.
    for figure in FIGURES {
        near(interval(&found["position_um"][figure]), [2.16, 17.84], 4.0 * 0.24);
    }
}

#[test]
fn parts_add_up_by_squares_and_joint_ones_by_their_sign() {
    let folder = Folder::new("uncertainty-joint");
    let values = "errors:\n  EXX: { value: 6 um, uncertainty: 1 um }\n  EXZ: { value: 6 um, uncertainty: 1 um }\n";
    let alone = machine(&folder, "alone.yaml", values);
    let band = |file: &str| {
        let found = json(&["map", file, "--random", "20", "--format", "json"]);
        interval(&found["uncertainty"]["position_um"]["mean"])
    };
    let root = 2f64.sqrt();
    near(band(&alone), [12.0 - root, 12.0 + root], 1e-9);
    let joint = |name: &str, part: &str| machine(&folder, name, &format!("{values}covariance:\n  - {part}\n"));
    let against = joint("against.yaml", "{ errors: { EXX: 0.5 um, EXZ: -0.5 um } }");
    near(band(&against), [12.0, 12.0], 1e-9);
    let along = joint("along.yaml", "{ errors: { EXX: 0.5 um, EXZ: 0.5 um } }");
    near(band(&along), [10.0, 14.0], 1e-9);
    // An error outside the parts keeps its own; set-up errors take part: the workpiece is displaced against the tool.
    let one = joint("one.yaml", "{ errors: { EXX: 0.5 um }, setup: { workpiece: { X: 0.5 um } } }");
    near(band(&one), [11.0, 13.0], 1e-9);
}

#[test]
fn machines_share_what_both_files_state() {
    let folder = Folder::new("uncertainty-shared");
    let errors =
        "errors:\n  EXX: { value: 10 um, uncertainty: 2 um }\n  EC0Y: { value: 20 urad, uncertainty: 4 urad }\n";
    let first = machine(&folder, "first.yaml", errors);
    let compared = |second: &str| json(&["compare", &first, second, "--poses", "100", "--format", "json"]);
    let of = |result: &Value| {
        let bands = result["machines"][1]["uncertainty"].clone();
        (interval(&bands["minus_first"]["position_um"]["p95"]), bands["told_apart"].as_bool().unwrap())
    };
    let same = machine(&folder, "same.yaml", errors);
    let (band, told) = of(&compared(&same));
    near(band, [0.0, 0.0], 1e-12);
    assert!(!told);
    // The same with a sure EYY more: a difference without any uncertainty of its own to first order.
    let more = machine(&folder, "more.yaml", &format!("{errors}  EYY: 30 um\n"));
    let (band, told) = of(&compared(&more));
    assert!(told && band[0] > 10.0, "{band:?}");
    // Another value is another measurement: both count.
    let other = machine(&folder, "other.yaml", &errors.replace("10 um", "11 um"));
    let result = compared(&other);
    let (band, told) = of(&result);
    assert!(!told && band[0] < -1.0 && band[1] > 1.0, "{band:?}");
    assert_eq!(result["machines"][0]["uncertainty"]["parts"].as_u64(), Some(3));
    let text = abbe(&["compare", &first, &other, "--poses", "100"]);
    assert!(text.contains("is WITHIN its uncertainty"), "{text}");
}

#[test]
fn what_a_compensation_leaves_is_the_uncertainty_of_the_errors() {
    let folder = Folder::new("uncertainty-compile");
    let file = machine(&folder, "m.yaml", "errors:\n  EXX: { value: 10 um, uncertainty: 2 um }\n");
    let out = folder.file("set");
    let arguments = ["--target", "grid-csv", "--poses", "100", "--format", "json"];
    let compiled = [&["compile", &file, "--out", out.to_str().unwrap()], &arguments[..]].concat();
    let check = |found: &Value| {
        let found = &found["uncertainty"]["compensated"];
        assert_eq!(found["drawn"].as_bool(), Some(true));
        // |z| um: 2.5 and 97.5 % of the half normal distribution, with the deviations of order statistics as above.
        near(interval(&found["position_um"]["mean"]), [0.0313, 2.2414], 0.25);
    };
    check(&json(&compiled));
    check(&json(&["verify", &file, out.to_str().unwrap(), "--poses", "100", "--format", "json"]));
}

/// EXX = a + b x with noise: the uncertainty of the line at a place is in every textbook, with Student's factor of 19 or
/// 4 readings to spare (Abramowitz and Stegun, table 26.10). Nothing is said of a form beside the line.
#[test]
fn the_covariance_of_a_fitted_line_goes_through_the_map() {
    line(21, 2.093_024);
    line(6, 2.776_445);
}

fn line(readings: usize, student: f64) {
    let folder = Folder::new(&format!("uncertainty-fit-{readings}"));
    let file = machine(&folder, "m.yaml", "identify: { datum: { line: free, zero: free } }\n");
    let mut random = Random::new(2718);
    let places: Vec<f64> = (0..readings).map(|i| 500.0 * i as f64 / (readings - 1) as f64).collect();
    let read: Vec<f64> = places.iter().map(|x| 9.0 + 0.02 * x + 0.8 * normal(&mut random)).collect();
    let rows: String = places.iter().zip(&read).map(|(x, y)| format!("{x},{y}\n")).collect();
    let data = folder.with("data.csv", &format!("X,EXX [um]\n{rows}"));
    let out = folder.file("fitted.yaml");
    let fit =
        ["identify", &file, "--data", data.to_str().unwrap(), "--fit", "EXX:poly1", "--out", out.to_str().unwrap()];
    let _ = abbe(&fit);
    let n = places.len() as f64;
    let (x, y) = (places.iter().sum::<f64>() / n, read.iter().sum::<f64>() / n);
    let sxx: f64 = places.iter().map(|p| (p - x).powi(2)).sum();
    let b = places.iter().zip(&read).map(|(p, r)| (p - x) * (r - y)).sum::<f64>() / sxx;
    let left: f64 = places.iter().zip(&read).map(|(p, r)| (r - y - b * (p - x)).powi(2)).sum();
    let variance = left / (n - 2.0);
    for q in [0.0, 260.0, 500.0] {
        let poses = folder.with("poses.csv", &format!("X,Y,Z\n{q},0,-100\n"));
        let poses = poses.to_str().unwrap();
        let found =
            json(&["map", out.to_str().unwrap(), "--reference", "machine", "--tool-poses", poses, "--format", "json"]);
        let (value, u) = (y + b * (q - x), (variance * (1.0 / n + (q - x).powi(2) / sxx)).sqrt());
        // The prior of 3 mm and the rounding of the file come in below this.
        near(interval(&found["uncertainty"]["position_um"]["mean"]), [value - student * u, value + student * u], 1e-3);
    }
}

#[test]
fn parts_that_make_no_sense_are_refused() {
    let folder = Folder::new("uncertainty-refused");
    for (part, code, words) in [
        ("[{ errors: { EXX: { tolerance: 2 um } } }]", "E0209", "is itself an uncertainty"),
        ("[{ errors: { EXX: { value: 2 um, uncertainty: 1 um } } }]", "E0209", "is itself an uncertainty"),
        ("[{ errors: { EXV: 2 um } }]", "E0406", "covariance"),
        ("[{ errors: { EXX: 2 } }]", "E0204", "covariance"),
        ("[{ setup: { tool: { A: 2 urad } } }]", "E0201", "covariance"),
        ("[{ error: { EXX: 2 um } }]", "E0201", "error"),
        ("3", "E0202", "covariance"),
        ("[{ form: { axis: X, size: 2 um } }]", "E0203", "`length`"),
        ("[{ form: { axis: X, length: 50 mm } }]", "E0203", "`size` or `rotation`"),
        ("[{ form: { axis: X, errors: { EXY: 1 um }, length: 50 mm } }]", "E0209", "no error of the axis `X`"),
        ("[{ form: { axis: X, size: 1 um, errors: { EXX: 1 um }, length: 50 mm } }]", "E0209", "twice"),
        ("[{ form: { axis: X, errors: { EXX: 0 um }, length: 50 mm } }]", "E0213", "not above zero"),
        ("[{ form: { axis: X, size: 2 um, length: 2.4 mm } }]", "E0213", "below 1/200 of the travel"),
        ("[{ form: { axis: X, rotation: 0 urad, length: 50 mm } }]", "E0213", "not above zero"),
        ("[{ form: { axis: X, rotation: 2 um, length: 50 mm } }]", "E0205", "rotation"),
        ("[{ form: { axis: W, size: 2 um, length: 50 mm } }]", "E0406", "`W` is not an axis"),
        ("[{ form: { axis: X, size: -2 um, length: 50 mm } }]", "E0213", "not above zero"),
        ("[{ form: { axis: X, size: 2 um, length: 0 mm } }]", "E0213", "not above zero"),
        ("[{ form: { axis: X, size: 2 um, length: 5 deg } }]", "E0205", "length"),
        ("[{ form: { axis: X, size: 2 um, length: 5 mm }, errors: { EXX: 1 um } }]", "E0209", "beside"),
        (
            "[{ form: { axis: X, size: 2 um, length: 5 mm } }, { form: { axis: X, size: 2 um, length: 5 mm } }]",
            "E0209",
            "two forms",
        ),
    ] {
        let file = machine(&folder, "m.yaml", &format!("errors:\n  EXX: 1 um\ncovariance: {part}\n"));
        let (status, message) = refused(&["check", &file]);
        assert!(status == 1 && message.contains(code) && message.contains(words), "{part}: {message}");
    }
    let many = "  - { errors: { EXX: 1 nm } }\n".repeat(1001);
    let file = machine(&folder, "m.yaml", &format!("covariance:\n{many}"));
    let (status, message) = refused(&["check", &file]);
    assert!(status == 1 && message.contains("1000 are read at most"), "{message}");
}

/// A form moves every displacement of its axis by its size, whichever way it runs; between the knots, half a length
/// apart, straight lines take off at most 1 - sqrt((1 + exp(-1/8)) / 2) = 3.0 %.
#[test]
fn a_form_is_the_uncertainty_of_each_displacement() {
    let folder = Folder::new("uncertainty-form");
    let forms = "covariance:\n  - { form: { axis: X, size: 3 um, length: 60 mm } }\n  - { form: { axis: Z, size: 4 um, \
                 length: 0.1 m } }\n";
    let file = machine(&folder, "m.yaml", forms);
    for at in ["X=0,Z=-300", "X=123.4,Y=7,Z=-77.7", "X=500"] {
        let report = json(&["eval", &file, "--at", at, "--format", "json"]);
        let found = &report["poses"][0]["uncertainty"];
        for k in 0..3 {
            let reach = found["deviation"][k].as_f64().unwrap();
            assert!((0.0097..=0.010_000_001).contains(&reach), "{at}: {reach}");
            assert_eq!(found["rotation"][k].as_f64(), Some(0.0), "{at}");
        }
    }
    let csv = abbe(&["eval", &file, "--at", "X=0", "--format", "csv"]);
    assert!(csv.contains("U dx [mm],U dy [mm],U dz [mm],U wx [rad],U wy [rad],U wz [rad]"), "{csv}");
    let text = abbe(&["eval", &file, "--at", "X=0"]);
    assert!(text.contains("U (k = 2) behind \u{b1}") && text.contains("0 \u{b1} 10"), "{text}");
}

/// At every position a form has its size, however short its length, on a turning axis too; each error its own.
#[test]
fn a_form_has_its_size_everywhere() {
    let folder = Folder::new("uncertainty-form-everywhere");
    let of = |length: &str| {
        let forms = format!(
            "covariance:\n  - {{ form: {{ axis: X, errors: {{ EXX: 3 um, EZX: 1 um }}, length: {length} }} }}\n"
        );
        let file = machine(&folder, "m.yaml", &forms);
        let reaches = (0..40).flat_map(|i| {
            let at = format!("X={}", 500.0 * f64::from(i) / 39.0);
            let found = json(&["eval", &file, "--at", &at, "--format", "json"])["poses"][0]["uncertainty"].clone();
            let one = move |(k, size): (usize, f64)| found["deviation"][k].as_f64().unwrap() / (2.0 * size) - 1.0;
            [(0, 3e-3), (2, 1e-3)].map(one)
        });
        let off = reaches.map(f64::abs).fold(0.0, f64::max);
        let parts =
            json(&["map", &file, "--random", "5", "--format", "json"])["uncertainty"]["parts"].as_u64().unwrap();
        (off, parts)
    };
    let (short, long) = (of("4 mm"), of("100 mm"));
    assert!(short.0 < 2e-3 && long.0 < 2e-3, "{short:?} {long:?}");
    // Waves up to 3.9 over the length: 1 + 2 * 0.59 (T / l + 3) of each error.
    assert!((250..350).contains(&short.1) && (14..30).contains(&long.1), "{short:?} {long:?}");
}

/// The lever arm of X's rotations is that from its origin, which rides with it, down to the tip: Z - 100 mm.
#[test]
fn a_form_of_rotations_moves_the_tip_by_its_lever_arm() {
    let folder = Folder::new("uncertainty-form-rotations");
    for (size, um) in [("", 0.0), ("size: 1 um, ", 1.0)] {
        let form = format!("covariance:\n  - {{ form: {{ axis: X, {size}rotation: 5 urad, length: 60 mm }} }}\n");
        let file = machine(&folder, "m.yaml", &form);
        for (at, arm) in [("X=0", 0.1_f64), ("X=123.4,Y=7,Z=-300", 0.4), ("X=500,Z=-77", 0.177)] {
            let found = &json(&["eval", &file, "--at", at, "--format", "json"])["poses"][0]["uncertainty"];
            let lateral = (um * um + (5.0 * arm).powi(2)).sqrt();
            for (k, size) in [lateral, lateral, um].into_iter().enumerate() {
                let ratio = |key: &str, size: f64| found[key][k].as_f64().unwrap() / (2.0 * size);
                assert!(size == 0.0 || (0.969..1.000_001).contains(&ratio("deviation", size / 1e3)), "{at}: {found}");
                assert!((0.969..1.000_001).contains(&ratio("rotation", 5e-6)), "{at}: {found}");
            }
        }
    }
}

/// Deviations of a tip under X, at these Z in turn, where A and B of X have waves of this amplitude (urad) as form.
fn turned(folder: &Folder, amplitude: f64, columns: &str, heights: &[f64]) -> Value {
    let file = machine(folder, "m.yaml", FREE);
    let mut random = Random::new(417);
    let row = |i: usize, random: &mut Random| {
        let (x, z) = (500.0 * i as f64 / 179.0, heights[i % heights.len()]);
        let arm = (z - 100.0) / 1e3;
        let turns = [0.4, 2.1].map(|phase: f64| amplitude * (x / 40.0 + phase).sin() * arm);
        let read = [turns[1], -turns[0], 0.0].map(|um| um + 0.3 * normal(random));
        let cells = read.iter().take(columns.split(',').count()).map(|um| format!(",{um}")).collect::<String>();
        format!("{x},0,{z}{cells}\n")
    };
    let rows: String = (0..180).map(|i| row(i, &mut random)).collect();
    let data = folder.with("data.csv", &format!("X,Y,Z,{columns}\n{rows}")).display().to_string();
    let fit = if columns.contains("dy") { "EXX:poly1,EYX:poly1" } else { "EXX:poly1" };
    warned(&["identify", &file, "--data", &data, "--fit", fit, "--format", "json"])
}

/// Lever arms tell rotations from displacements: 10 urad of a sine are 7.07 urad. At one lever arm, along the
/// direction that both move, either may be and both are stated.
#[test]
fn lever_arms_tell_forms_of_rotations_from_those_of_displacements() {
    let folder = Folder::new("uncertainty-rotations");
    let form = |report: &Value| {
        let [form] = &report["lack_of_fit"]["forms"].as_array().unwrap()[..] else { panic!("{report}") };
        assert_eq!(form["axis"], "X", "{form}");
        ["size_um", "rotation_urad"].map(|key| form[key].as_f64().unwrap())
    };
    let [size, rotation] = form(&turned(&folder, 10.0, "dx [um],dy [um],dz [um]", &[0.0, -150.0, -300.0]));
    assert!(size < 0.3 && (5.0..10.0).contains(&rotation), "{size} {rotation}");
    let one = turned(&folder, 20.0, "dx [um]", &[0.0]);
    let [size, rotation] = form(&one);
    // The root mean square of what is read is 1.41 um, at an arm of 100 mm.
    assert!((0.3..3.0).contains(&size) && (2.0..20.0).contains(&rotation), "{size} {rotation}");
    // Lateral at the longest arm, 400 mm.
    let largest = one["prediction"]["largest_um"].as_f64().unwrap();
    assert!(
        largest > 0.99 * size.hypot(0.4 * rotation) && one["prediction"]["at"]["Z"] == -300.0,
        "{}",
        one["prediction"]
    );
}

/// Columns of the Jacobian of a line are known: a scale moves its slope, an offset its constant, and nothing else.
#[test]
fn what_all_readings_share_goes_into_the_unknown_that_is_like_it() {
    let folder = Folder::new("uncertainty-type-b");
    let file =
        machine(&folder, "m.yaml", "identify: { type_b: [laser 0.4 um/m], datum: { line: free, zero: free } }\n");
    let mut random = Random::new(577);
    let reading = |i: usize, random: &mut Random| format!("{},0,0,{}\n", 20 * i, 5.0 + normal(random));
    let rows: String = (0..26).map(|i| reading(i, &mut random)).collect();
    let data = folder.with("data.csv", &format!("X,Y,Z,dx [um]\n{rows}")).display().to_string();
    let report = |more: &[&str]| {
        json(&[&["identify", &file, "--data", &data, "--fit", "EXX:poly1", "--format", "json"], more].concat())
    };
    let part = |report: &Value, k: usize, key: &str| report["parameters"][k][key].as_f64().unwrap();
    let all = report(&["--type-b", "set-up 3 um", "--type-b", "steel 0.5 K x 12 um/m/K"]);
    // 0.4 and 0.5 * 12 um/m together.
    let slope = (0.4_f64.powi(2) + 6.0_f64.powi(2)).sqrt();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b.max(1.0), "{a} instead of {b}");
    near(part(&all, 0, "type_b"), 3.0);
    near(part(&all, 1, "type_b"), slope);
    for k in 0..2 {
        let squares = ["type_a", "lack_of_fit", "type_b"].map(|key| part(&all, k, key).powi(2));
        near(part(&all, k, "sigma"), squares.iter().sum::<f64>().sqrt());
        near(part(&all, k, "type_a"), part(&report(&[]), k, "type_a"));
    }
    assert_eq!(all["type_b"][1], serde_json::json!({ "name": "set-up", "scale_um_per_m": null, "offset_um": 3.0 }));
    let words = abbe(&["identify", &file, "--data", &data, "--fit", "EXX:poly1"]);
    assert!(words.contains("type B     laser 0.4 um/m"), "{words}");
    for wrong in ["laser", "laser 0.4", "0.4 um/m", "laser 0 um", "laser 3 urad"] {
        let (status, message) = refused(&["identify", &file, "--data", &data, "--fit", "EXX:poly1", "--type-b", wrong]);
        assert!(status == 1 && message.contains("E0517"), "{wrong}: {message}");
    }
}

/// The report of a run that warns.
fn warned(arguments: &[&str]) -> Value {
    crate::identify::json(&crate::identify::run(arguments))
}

/// A file of readings of single errors over X.
fn over_x(folder: &Folder, name: &str, rows: impl Iterator<Item = (f64, f64)>) -> String {
    let rows: String = rows.map(|(x, read)| format!("{x},{read}\n")).collect();
    folder.with(name, &format!("X,EXX [um]\n{rows}")).display().to_string()
}

const FREE: &str = "identify: { datum: { line: free, zero: free } }\n";

/// An offset is common to the readings of one error; of an angle it says nothing.
#[test]
fn an_offset_is_common_to_the_readings_of_one_error() {
    let folder = Folder::new("uncertainty-channels");
    let file = machine(&folder, "m.yaml", FREE);
    let mut random = Random::new(91);
    let mut noise = || 5.0 + normal(&mut random);
    let rows: String = (0..26).map(|i| format!("{},{},{},{}\n", 20 * i, noise(), noise(), noise())).collect();
    let data = folder.with("data.csv", &format!("X,EBX [urad],EXX [um],EYX [um]\n{rows}")).display().to_string();
    let fit = "EXX:poly1,EYX:poly1,EBX:poly1";
    let report =
        json(&["identify", &file, "--data", &data, "--fit", fit, "--type-b", "set-up 3 um", "--format", "json"]);
    for (k, expected) in [3.0, 3.0, 0.0].into_iter().enumerate() {
        let found = report["parameters"][2 * k]["type_b"].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-6, "{}: {found}", report["parameters"][2 * k]["name"]);
    }
}

/// Readings without noise leave nothing to judge a form by, and three places with jitter are no curve.
#[test]
fn a_form_needs_noise_and_places() {
    let folder = Folder::new("uncertainty-no-form");
    let file = machine(&folder, "m.yaml", FREE);
    let mut random = Random::new(92);
    let exact = over_x(&folder, "exact.csv", (0..26).map(|i| (20.0 * f64::from(i), 5.0 + 0.25 * f64::from(i))));
    let jitter = (0..45).map(|i| {
        let off = 0.01 + 0.02 * f64::from(i % 7);
        let place = 250.0 * f64::from(i % 3) + if i % 3 == 2 { -off } else { off };
        (place, [9.0, -9.0, 9.0][i as usize % 3] + normal(&mut random))
    });
    let jitter = over_x(&folder, "jitter.csv", jitter);
    for data in [exact, jitter] {
        let out = folder.file("fitted.yaml").display().to_string();
        let fit = ["identify", &file, "--data", &data, "--fit", "EXX:poly1", "--format", "json", "--out", &out];
        assert!(warned(&fit)["lack_of_fit"].is_null(), "{data}");
        assert!(!std::fs::read_to_string(&out).unwrap().contains("form:"), "{data}");
    }
}

/// A fit says nothing of the form of axes that it has not looked at.
#[test]
fn forms_of_other_axes_stay() {
    let folder = Folder::new("uncertainty-second-fit");
    let known = "covariance:\n  - { form: { axis: X, size: 7 um, length: 60 mm } }\n  - { form: { axis: Z, size: 4 um, \
                 length: 0.1 m } }\n";
    let file = machine(&folder, "m.yaml", &format!("{FREE}{known}"));
    let mut random = Random::new(93);
    let rows = (0..101).map(|i| (5.0 * f64::from(i), 3.0 * (0.1 * f64::from(i)).sin() + 0.3 * normal(&mut random)));
    let data = over_x(&folder, "data.csv", rows.collect::<Vec<_>>().into_iter());
    let out = folder.file("fitted.yaml").display().to_string();
    let report = warned(&["identify", &file, "--data", &data, "--fit", "EXX:poly1", "--out", &out, "--format", "json"]);
    assert_eq!(report["lack_of_fit"]["forms"].as_array().unwrap().len(), 1, "{}", report["lack_of_fit"]);
    let text = std::fs::read_to_string(&out).unwrap();
    let forms: Vec<&str> = text.lines().filter(|line| line.contains("form:")).collect();
    let of = |axis: &str| forms.iter().filter(|form| form.contains(axis)).copied().collect::<Vec<_>>();
    assert_eq!(of("\"Z\""), ["  - { form: { axis: \"Z\", size: 0.004 mm, length: 100 mm } }"]);
    assert!(forms.len() == 2 && of("\"X\"").len() == 1 && !forms.concat().contains("0.007"), "{forms:?}");
}

/// Machines share the form of an axis only where they have its errors from one calibration.
#[test]
fn forms_beside_other_errors_are_other_forms() {
    let folder = Folder::new("uncertainty-two-forms");
    let form = "covariance:\n  - { form: { axis: X, size: 3 um, length: 60 mm } }\n";
    let of = |name: &str, value: f64| machine(&folder, name, &format!("errors:\n  EXX: {value} um\n{form}"));
    let (first, other, same) = (of("a.yaml", 40.0), of("b.yaml", 50.0), of("c.yaml", 40.0));
    let width = |other: &str| {
        let report = json(&["compare", &first, other, "--poses", "20", "--format", "json"]);
        let [low, high] = interval(&report["machines"][1]["uncertainty"]["minus_first"]["position_um"]["mean"]);
        high - low
    };
    assert!(width(&same) < 1e-9 && width(&other) > 1.0, "{} {}", width(&same), width(&other));
}
