//! The 2015 paper again, with the files of docs/examples: its own fit on monomials, and the joint fit beside it.

use super::identify::{json, run};
use super::oracle::program::Folder;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples/paper-2015/");

fn report(machine: &str, data: &str, more: &[&str]) -> serde_json::Value {
    let (machine, data) = (format!("{EXAMPLE}{machine}"), format!("{EXAMPLE}{data}"));
    json(&run(&[&["identify", &machine, "--data", &data, "--format", "json"], more].concat()))
}

#[test]
fn the_design_of_the_paper_has_rank_2_along_a_line_and_12_of_22_on_the_grid() {
    for (data, rank) in [("line.csv", 2), ("phantom.csv", 12)] {
        let found = report("as-printed.yaml", data, &["--method", "moore-penrose"]);
        let dx = &found["components"][0];
        assert_eq!((dx["columns"].as_u64(), dx["rank"].as_u64()), (Some(22), Some(rank)), "{dx}");
        let names: Vec<&str> =
            dx["coefficients"].as_array().unwrap().iter().map(|c| c["monomial"].as_str().unwrap()).collect();
        assert!(names.contains(&"b * f2") && names.contains(&"c * g3") && !names.contains(&"b"), "{names:?}");
        assert_eq!(names.iter().filter(|name| name.contains('*')).count(), 15);
    }
}

/// um/m and urad/m of configs/papers/holub-2015.yaml.
const TRUTH: [(&str, f64); 12] = [
    ("EXX:slope", 14.0),
    ("EAX:slope", 26.0),
    ("EBX:slope", 22.0),
    ("ECX:slope", -16.0),
    ("EYY:slope", -11.0),
    ("EAY:slope", 30.0),
    ("EBY:slope", -24.0),
    ("ECY:slope", 18.0),
    ("EZZ:slope", 16.0),
    ("EAZ:slope", -20.0),
    ("EBZ:slope", 28.0),
    ("ECZ:slope", 12.0),
];

/// Fewer inputs: 21 readings along three lines determine what 343 do, and predict these nearly as well as their own fit.
#[test]
fn three_lines_of_seven_points_predict_the_grid() {
    let folder = Folder::new();
    let out = folder.path("three.yaml");
    let file = out.to_str().unwrap();
    let found = report("machine.yaml", "three-lines.csv", &["--out", file, "--quiet"]);
    for (parameter, (name, known)) in found["parameters"].as_array().unwrap().iter().zip(TRUTH) {
        let Some(sigma) = parameter["sigma"].as_f64() else { continue };
        let gap = (parameter["value"].as_f64().unwrap() - known).abs();
        assert!(parameter["name"] == name && gap < 4.0 * sigma, "{name}: off by {gap}, sigma {sigma}");
    }
    assert_eq!((found["rows"].as_u64(), found["rank"].as_u64()), (Some(63), Some(11)));
    let grid = format!("{EXAMPLE}phantom.csv");
    let predicted = ["identify", file, "--predict", &grid, "--noise", "1 um", "--format", "json"];
    let predicted = json(&run(&predicted));
    assert_eq!(predicted["verdict"], "within", "{predicted}");
    // The noise of three components is 1.73 um; what the prediction adds is below its largest uncertainty.
    let left = predicted["kinds"][0]["left"].as_f64().unwrap();
    let u = found["prediction"]["largest_um"].as_f64().unwrap();
    let noise = 3.0_f64.sqrt();
    assert!(left > 0.95 * noise && left < (noise * noise + u * u).sqrt(), "{left} {u}");
}

#[test]
fn the_phantom_is_found_again_by_the_joint_fit() {
    let folder = Folder::new();
    let svg = folder.path("planes");
    let found = report("machine.yaml", "phantom.csv", &["--svg", svg.to_str().unwrap(), "--folds", "5"]);
    let mut determined = 0;
    for (parameter, (name, known)) in found["parameters"].as_array().unwrap().iter().zip(TRUTH) {
        assert_eq!(parameter["name"], name);
        let Some(sigma) = parameter["sigma"].as_f64() else { continue };
        let gap = (parameter["value"].as_f64().unwrap() - known).abs();
        assert!(gap < 4.0 * sigma, "{name}: off by {gap}, sigma {sigma}");
        determined += 1;
    }
    // The roll of Z about the tool's own line acts on no point of it.
    assert_eq!((determined, found["rank"].as_u64()), (11, Some(11)), "{}", found["null_space"]);
    // The noise is 1 um in each of three components.
    let rms = |key: &str| found["rms_um"][key].as_f64().unwrap();
    assert!((rms("after") - 3.0_f64.sqrt()).abs() < 0.1 && (rms("held_out") - 3.0_f64.sqrt()).abs() < 0.1);
    assert!(rms("before") > 3.0 * rms("after"));
    for name in ["fit-xy.svg", "fit-xz.svg", "fit-yz.svg"] {
        let text = std::fs::read_to_string(svg.join(name)).unwrap();
        // A circle and a dot for each of 49 points, and one in the legend.
        assert_eq!(text.matches("<circle").count(), 99, "{name}");
    }
}

#[test]
fn the_papers_way_explains_each_component_of_the_phantom() {
    let found = report("machine.yaml", "phantom.csv", &["--method", "moore-penrose"]);
    for component in found["components"].as_array().unwrap() {
        let after = component["rms_um"]["after"].as_f64().unwrap();
        assert!((0.9..1.1).contains(&after), "{component}");
        assert!(component["rank"].as_u64() < component["columns"].as_u64());
    }
}

/// dx = (a + 2 b) x: the shortest answer is a fifth and two fifths of it.
#[test]
fn of_many_answers_the_shortest_is_given() {
    let folder = Folder::new();
    let machine = "abbe: 1\nmachine: One\nchain: \"w b X t\"\naxes:\n  X: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\nidentify:\n  fit: [a, b]\n  parameters: { a: { EXX: [0, 1] }, b: { EXX: [0, 2] } }\n";
    let machine = folder.write("machine.yaml", machine);
    let data = folder.write("data.csv", "X [mm],dx [um]\n0,0\n50,25\n100,50\n");
    let found = json(&run(&[
        "identify",
        machine.to_str().unwrap(),
        "--data",
        data.to_str().unwrap(),
        "--method",
        "moore-penrose",
        "--format",
        "json",
    ]));
    let dx = &found["components"][0];
    let value = |k: usize| dx["coefficients"][k]["value"].as_f64().unwrap();
    assert_eq!((dx["rank"].as_u64(), dx["columns"].as_u64()), (Some(1), Some(2)));
    assert!((value(0) - 100.0).abs() < 1e-9 && (value(1) - 200.0).abs() < 1e-9, "{dx}");
    assert_eq!(dx["coefficients"][0]["determined"], false);
}

/// dx = a x of four readings: the slope through the origin, its standard uncertainty and what three of them leave.
#[test]
fn coefficients_have_the_uncertainty_of_the_pseudo_inverse() {
    let folder = Folder::new();
    let head = "abbe: 1\nmachine: One\nchain: \"w b X t\"\naxes:\n  X: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n";
    let one = format!("{head}identify:\n  fit: [a]\n  parameters: {{ a: {{ EXX: [0, 1] }} }}\n");
    let data = folder.write("data.csv", "X [mm],dx [um]\n20,11\n40,19\n60,32\n100,49\n");
    let fit = |machine: &str, more: &[&str]| {
        let machine = folder.write("machine.yaml", machine);
        let base = ["identify", machine.to_str().unwrap(), "--data", data.to_str().unwrap()];
        json(&run(&[&base[..], &["--method", "moore-penrose", "--format", "json"], more].concat()))
    };
    let found = fit(&one, &["--order", "1"]);
    let (x, y) = ([0.02, 0.04, 0.06, 0.1_f64], [11.0, 19.0, 32.0, 49.0_f64]);
    let dot = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let slope = dot(&x, &y) / dot(&x, &x);
    let rest: [f64; 4] = std::array::from_fn(|i| y[i] - slope * x[i]);
    let sigma = (dot(&rest, &rest) / 3.0 / dot(&x, &x)).sqrt();
    let dx = &found["components"][0];
    let coefficient = &dx["coefficients"][0];
    assert_eq!((found["order"].as_u64(), dx["columns"].as_u64()), (Some(1), Some(1)));
    for (key, wanted) in [("value", slope), ("sigma", sigma)] {
        let value = coefficient[key].as_f64().unwrap();
        assert!((value / wanted - 1.0).abs() < 1e-9, "{key}: {value} {wanted}");
    }
    assert_eq!(coefficient["determined"], true);
    // Two curves of which the second is nearly the first: both are there, and neither is told from the other.
    let two = "identify:\n  fit: [a, b]\n  parameters: { a: { EXX: [0, 1] }, b: { EXX: [0, 1, 0.00001] } }\n";
    let found = fit(&format!("{head}{two}"), &["--order", "1"]);
    let dx = &found["components"][0];
    assert_eq!((dx["rank"].as_u64(), &dx["coefficients"][0]["determined"]), (Some(2), &false.into()));
    assert!(dx["coefficients"][0]["sigma"].as_f64().unwrap() > 100.0 * sigma);
}

#[test]
fn options_that_coefficients_know_nothing_of_are_refused() {
    let (machine, data) = (format!("{EXAMPLE}machine.yaml"), format!("{EXAMPLE}phantom.csv"));
    let base = ["identify", &machine, "--data", &data, "--method", "moore-penrose"];
    let idle: [&[&str]; 7] = [
        &["--order", "exact"],
        &["--robust"],
        &["--folds", "3"],
        &["--range", "measured"],
        &["--prior", "EC0Y 5 urad"],
        &["--type-b", "laser 0.4 um/m"],
        &["--noise", "1um"],
    ];
    for options in idle {
        let output = run(&[&base[..], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        let said = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains("--method moore-penrose"), "{options:?}: {said}");
    }
    let folder = Folder::new();
    let svg = folder.path("svg");
    assert_eq!(run(&[&base[..], &["--svg", svg.to_str().unwrap()]].concat()).status.code(), Some(0));
    for name in ["fit-xy.svg", "fit-xz.svg", "fit-yz.svg"] {
        assert!(std::fs::read_to_string(svg.join(name)).unwrap().matches("<circle").count() > 20, "{name}");
    }
}

#[test]
fn what_does_not_go_together_is_said() {
    let (machine, data) = (format!("{EXAMPLE}machine.yaml"), format!("{EXAMPLE}line.csv"));
    let base = ["identify", &machine, "--data", &data, "--method", "moore-penrose"];
    assert_eq!(run(&[&base[..], &["--out", "x.yaml"]].concat()).status.code(), Some(2));
    let folder = Folder::new();
    let relative = folder.write("r.csv", "X,rel.dx [um]\n300,0\n350,1\n");
    let with = |data: &str, more: &[&str]| {
        let output = run(&[&["identify", &machine, "--data", data], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) = with(relative.to_str().unwrap(), &["--method", "moore-penrose"]);
    assert!(code == Some(1) && said.contains("E0510"), "{said}");
    let curve = folder.write("c.csv", "X,EXX [um]\n300,0\n350,1\n");
    let svg = folder.path("svg");
    let (code, said) = with(curve.to_str().unwrap(), &["--fit", "EXX:poly1", "--svg", svg.to_str().unwrap()]);
    assert!(code == Some(1) && said.contains("E0511"), "{said}");
}
