//! `record`: what its headline promises, and of what it says that it is not known.

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, number};
use serde_json::Value;
use std::path::Path;

/// The calibration of the guide, recorded; `change` edits the description. Returns the document and what is printed.
fn shop_floor(change: impl Fn(String) -> String) -> (Folder, Value, String) {
    let folder = Folder::new();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/shop-floor");
    let here = |name: &str| source.join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let run = Run::of(abbe().args(arguments).current_dir(folder.path("")));
        assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.err);
        run.out
    };
    let json = ["--format", "json"];
    let fit = "location,EXX:poly3,EYY:poly1,EZZ:poly1,EZY:poly2";
    let (machine, volume, laser) = (here("machine.yaml"), here("volume.csv"), here("x-laser.csv"));
    let fitted = ["--data", &volume, "--fit", fit, "--type-b", "tracker 1.5 um/m", "--out", "fitted.yaml"];
    run(&[&["identify", &machine], &fitted[..]].concat());
    let stated = ["--uncertainty", "device 0.5 um/m", "--uncertainty", "drift 0.8 um"];
    let imported = run(&[&["import", &laser, "--error", "EXX", "--axis", "X"], &stated[..], &json].concat());
    folder.write("x-laser.json", &imported);
    let circle = run(&[&["figures", "circle", &here("circle-xy.csv"), "--radius", "150"], &json[..]].concat());
    folder.write("circle-xy.json", &circle);
    let set = ["--target", "sinumerik-cec", "--out", "fitted-tables"];
    folder.write("compile.json", &run(&[&["compile", "fitted.yaml"], &set[..], &json].concat()));
    let text = std::fs::read_to_string(source.join("record.yaml")).unwrap();
    let text = change(text.replace("docs/examples/shop-floor", &source.display().to_string()));
    folder.write("record.yaml", &text);
    let printed = run(&["record", "record.yaml", "--out", "made"]);
    let data = serde_json::from_str(&read(&folder, "made/record.json")).unwrap();
    (folder, data, printed)
}

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).unwrap()
}

fn figure(data: &Value, file: usize, name: &str) -> Value {
    let all = data["figures"][file]["values"].as_array().unwrap();
    all.iter().find(|of| of["figure"] == name).unwrap_or_else(|| panic!("{name} in {all:?}")).clone()
}

/// The machine of the readings has 2.8 um of lost motion in X and 1.8 um in Y, the fit none.
#[test]
fn the_headline_is_what_is_known() {
    let (folder, data, printed) = shop_floor(|text| text);
    let document = |name: &str| serde_json::from_str::<Value>(&read(&folder, name)).unwrap();
    let (laser, circle) = (document("x-laser.json"), document("circle-xy.json"));
    let of_laser = number(&laser, "/errors/0/B") + number(&laser, "/errors/0/U/B");
    let of_circle = |i: usize| {
        let at = |key: &str| number(&circle, &format!("/causes/reversal_um/{i}/{key}"));
        at("value").abs() + 2.0 * at("sigma")
    };
    let [x, y] = [of_laser.max(of_circle(0)), of_circle(1)];
    let promised = &data["sets"][0]["promised"];
    let interval = &data["sets"][0]["verify"]["uncertainty"]["compensated"]["position_um"]["p95"];
    assert_eq!(&promised["interval_um"], interval);
    let within = interval[1].as_f64().unwrap() + (x * x + y * y).sqrt();
    assert!((number(promised, "/within_um") - within).abs() < 1e-9, "{promised}");
    assert!(within > 3.3 && number(promised, "/model_um") < 0.01);
    assert_eq!(promised["type_b"], serde_json::json!(["tracker 1.5 um/m"]));
    let names: Vec<&str> =
        promised["reversals"].as_array().unwrap().iter().map(|of| of["error"].as_str().unwrap()).collect();
    assert_eq!(names, ["EXX", "EYY"]);
    let page = read(&folder, "made/record.html");
    assert!(printed.contains("with type B: tracker 1.5 um/m") && printed.contains("EXX 3."), "{printed}");
    assert!(!printed.contains("0.0013") && page.contains("<strong>95 % of the poses within"), "{printed}");
    // A zero that the datum sets is no result: neither in the table, nor in the certificate, nor decided.
    let errors = data["errors"].as_array().unwrap();
    let held = |name: &str| errors.iter().find(|row| row["error"] == name).unwrap()["found"].clone();
    for name in ["EA0Y", "EB0X", "EC0X"] {
        assert_eq!((&held(name)["held"], &held(name)["value"]), (&true.into(), &0.0.into()), "{name}");
    }
    assert_eq!(held("EC0Y")["held"], false);
    let certificate = read(&folder, "made/certificate.xml");
    assert!(certificate.contains(">EC0Y<") && !certificate.contains(">EA0Y<"));
    assert_eq!(page.matches("held at 0").count(), 3);
}

/// U of one direction is that of both; of a circle it is by the scatter; what it lacks is said.
#[test]
fn uncertainties_say_what_they_lack() {
    let (folder, data, _) = shop_floor(|text| text);
    let document = |name: &str| serde_json::from_str::<Value>(&read(&folder, name)).unwrap();
    let (laser, circle) = (document("x-laser.json"), document("circle-xy.json"));
    for (key, name) in [("E", "EXX: E forward"), ("R", "EXX: R reverse"), ("A", "EXX: A forward")] {
        let u = number(&laser, &format!("/errors/0/U/{key}"));
        assert_eq!(figure(&data, 0, name)["expanded_uncertainty"].as_f64(), Some(u), "{name}");
    }
    let rest = number(&circle, "/causes/rest_um");
    let readings = number(&circle, "/readings");
    for (name, u) in [
        ("circular deviation G, clockwise", 2.0 * 2.0_f64.sqrt() * rest),
        ("circular deviation G(b)", 2.0 * 2.0_f64.sqrt() * rest),
        ("mean radial deviation D", 2.0 * rest / readings.sqrt()),
        ("radial deviation F, clockwise, smallest", 2.0 * rest),
    ] {
        let found = figure(&data, 1, &format!("XY: {name}"))["expanded_uncertainty"].as_f64().unwrap();
        assert!((found - u).abs() < 1e-12, "{name}: {found} {u}");
    }
    let page = read(&folder, "made/record.html");
    let laser = "U of EXX has device calibration, EVE (drift); it lacks alignment, set-up, temperature measurement, \
                 expansion coefficients, and is not complete";
    assert!(page.contains(laser) && page.contains("U of G, D and F has scatter of the readings; it lacks device"));
    // Documents of earlier versions do not state them.
    let mut old = document("x-laser.json");
    old["errors"][0].as_object_mut().unwrap().remove("contributors");
    folder.write("x-laser.json", &old.to_string());
    let again = Run::of(abbe().args(["record", "record.yaml", "--out", "again"]).current_dir(folder.path("")));
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert!(read(&folder, "again/record.html").contains("U of EXX does not state its contributors"));
}

#[test]
fn statements_are_stated_or_not() {
    let (folder, data, _) = shop_floor(|text| text);
    let stated = data["statements"]["traceability"].as_str().unwrap();
    for name in ["record.html", "certificate.xml"] {
        let text = read(&folder, &format!("made/{name}"));
        assert!(text.contains(stated) && text.matches("not stated").count() == 1, "{name}");
    }
    assert!(read(&folder, "made/record.html").contains("counter(pages)"));
    let without = |text: String| {
        let mut inside = false;
        let keep = |line: &&str| {
            inside = line.starts_with("statements:") || inside && line.starts_with("  ");
            !inside
        };
        text.lines().filter(keep).map(|line| format!("{line}\n")).collect()
    };
    let (folder, data, _) = shop_floor(without);
    assert!(data["statements"]["replaces"].is_null());
    for name in ["record.html", "certificate.xml"] {
        assert_eq!(read(&folder, &format!("made/{name}")).matches("not stated").count(), 6, "{name}");
    }
}

/// The covariance is the product of the columns in the fitted file, read here by another way.
#[test]
fn the_covariance_is_that_of_the_fit() {
    let (folder, data, _) = shop_floor(|text| text);
    let fitted = read(&folder, "fitted.yaml");
    let columns: Vec<&str> = fitted.lines().filter(|line| line.starts_with("  - { errors:")).collect();
    let amount = |line: &str, name: &str| -> f64 {
        let rest = line.split_once(&format!("{name}: ")).unwrap().1;
        rest.split_once(" urad").unwrap().0.parse().unwrap()
    };
    let product = |a: &str, b: &str| columns.iter().map(|line| amount(line, a) * amount(line, b)).sum::<f64>();
    let found = &data["covariances"][0];
    let names: Vec<&str> = found["errors"].as_array().unwrap().iter().map(|of| of["error"].as_str().unwrap()).collect();
    let place = |name: &str| names.iter().position(|of| *of == name).unwrap();
    for (a, b) in [("EC0Y", "EC0Y"), ("EC0Y", "EA0Z"), ("EA0Z", "EC0Y"), ("EB0Z", "EB0Z")] {
        let covariance = found["covariance"][place(a)][place(b)].as_f64().unwrap();
        assert!((covariance - product(a, b)).abs() < 1e-9, "{a} {b}: {covariance} {}", product(a, b));
    }
    assert!(!names.contains(&"EA0Y") && names.contains(&"EXX"));
    // A curve stands at the position of its largest size.
    let curve = &found["errors"][place("EXX")];
    let row = data["errors"].as_array().unwrap().iter().find(|row| row["error"] == "EXX").unwrap();
    assert_eq!(curve["position"], 500.0);
    assert!((number(curve, "/value") - number(row, "/found/value")).abs() < 1e-9);
    let certificate = read(&folder, "made/certificate.xml");
    assert_eq!(certificate.matches("<si:covariance>").count(), names.len() * names.len());
    assert!(certificate.contains("EXX(500)"));
}
