//! The controller's own kinematics modules, called in process, against `eval`.

use crate::{Folder, abbe, script_json};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Ideal positions agree to 1e-9 mm at random offsets, pivots and joint positions.
pub fn nominal() {
    let data = script_json("kinematics.py", &["--seed", "1"]);
    let mut items: BTreeMap<u64, Vec<&Value>> = BTreeMap::new();
    for item in data["items"].as_array().unwrap() {
        items.entry(item["machine"].as_u64().unwrap()).or_default().push(item);
    }
    let mut largest = 0.0_f64;
    for (machine, items) in &items {
        let yaml = data["machines"][*machine as usize]["yaml"].as_str().unwrap();
        largest = largest.max(compare(yaml, items));
    }
    println!("  {} machines, largest difference {largest:e} mm", items.len());
    assert!(items.len() >= 9 && largest < 1e-9, "{largest:e}");
}

/// The pins that `compile --target linuxcnc-trt` sets put the shipped modules where the erroneous machine has
/// its tip: its only errors are those that these modules can hold.
pub fn centres() {
    for (tilt, errors) in [
        ("A", "EX0C: 60 um\n  EY0C: -40 um\n  EY0A: 70 um\n  EZ0A: 90 um"),
        ("B", "EX0C: 60 um\n  EY0C: -40 um\n  EX0B: 70 um\n  EZ0B: 90 um"),
    ] {
        let folder = Folder::new("centres");
        let machine = folder.0.join("machine.yaml");
        std::fs::write(&machine, tilting_table(tilt, errors)).unwrap();
        let (machine, out) = (machine.display().to_string(), folder.0.join("out").display().to_string());
        let _ = abbe(&["--quiet", "compile", &machine, "--target", "linuxcnc-trt", "--out", &out]);
        let hal = std::fs::read_to_string(format!("{out}/trt.hal")).unwrap();
        let pin = |line: &str| {
            let words: Vec<&str> = line.split(' ').collect();
            let (module, name) = words[1].split_once('.').unwrap();
            (module.to_owned(), name.to_owned(), words[2].parse::<f64>().unwrap())
        };
        let pins: Vec<_> = hal.lines().filter(|line| line.starts_with("setp")).map(pin).collect();
        let joints: Vec<Value> = (0..40).map(|k| json!({"joints": joints(tilt, f64::from(k))})).collect();
        let mut values: BTreeMap<&str, f64> = pins.iter().map(|(_, name, value)| (name.as_str(), *value)).collect();
        assert!(hal.contains(&format!("net tool-length motion.tooloffset.z => {}.tool-offset", pins[0].0)));
        let _ = values.insert("tool-offset", 120.0);
        let ask = json!({"module": pins[0].0, "sets": [{"pins": values, "poses": joints}]});
        let file = folder.0.join("ask.json");
        std::fs::write(&file, ask.to_string()).unwrap();
        let sets = script_json("kinematics.py", &["--ask", &file.display().to_string()]);
        let largest = tip_differences(&machine, sets[0]["poses"].as_array().unwrap(), [0.0, 0.0, 10.0 - 120.0]);
        println!("  {}: tip {largest:.1e} mm from the exact model", pins[0].0);
        // Pins have six decimals; a tilt of the axis is second order.
        assert!(largest < 5e-6);
    }
}

/// The pivot length that `compile --target linuxcnc-5axiskins` sets puts the tip of the shipped module where the
/// machine has it whose head is too high; W is the length of the tool. The sign test as printed: with a pivot longer by
/// 0.1 and B at 90 the same joints are 0.1 further in X and Z, so the joints of one point are 0.1 lower.
pub fn pivot() {
    const TOOL: f64 = 100.0;
    let folder = Folder::new("pivot");
    let machine = folder.0.join("machine.yaml");
    let text = format!(
        "abbe: 1\nmachine: pivot\nchain: \"w b X Y Z C B t\"\naxes:\n  X: {{ travel: [-300 mm, 300 mm] }}\n  \
         Y: {{ travel: [-300 mm, 300 mm] }}\n  Z: {{ travel: [-300 mm, 0 mm] }}\n  C: {{ travel: [-200 deg, 200 deg] }}\n  \
         B: {{ travel: [-100 deg, 100 deg], direction: [0, -1, 0], origin: [0, 0, 180] }}\n\
         tool: {{ length: {TOOL} mm }}\nerrors:\n  EZ0B: 90 um\n"
    );
    std::fs::write(&machine, text).unwrap();
    let (machine, out) = (machine.display().to_string(), folder.0.join("out").display().to_string());
    let _ = abbe(&["--quiet", "compile", &machine, "--target", "linuxcnc-5axiskins", "--out", &out]);
    let hal = std::fs::read_to_string(format!("{out}/5axiskins.hal")).unwrap();
    let line = hal.lines().find(|line| line.starts_with("setp")).unwrap();
    let length: f64 = line.strip_prefix("setp 5axiskins.pivot-length ").unwrap().parse().unwrap();
    let at = |k: f64| {
        json!({"joints": {"X": 2.0 * k - 190.0, "Y": 150.0 - k, "Z": -k, "C": 1.9 * k - 190.0,
        "B": 95.0 - 0.9 * k, "W": TOOL}})
    };
    let poses: Vec<Value> = (0..200).map(|k| at(f64::from(k))).collect();
    let level = json!([{"joints": {"X": 0.0, "Y": 0.0, "Z": 0.0, "C": 0.0, "B": 90.0, "W": 0.0}}]);
    let ask = json!({"module": "5axiskins", "sets": [
        {"pins": {"pivot-length": length}, "poses": poses},
        {"pins": {"pivot-length": length}, "poses": level},
        {"pins": {"pivot-length": length + 0.1}, "poses": level},
    ]});
    let file = folder.0.join("ask.json");
    std::fs::write(&file, ask.to_string()).unwrap();
    let sets = script_json("kinematics.py", &["--ask", &file.display().to_string()]);
    let largest = tip_differences(&machine, sets[0]["poses"].as_array().unwrap(), [0.0; 3]);
    println!("  5axiskins: tip {largest:.1e} mm from the exact model at 200 poses");
    assert!(largest < 1e-9);
    let position = |set: usize, k: usize| sets[set]["poses"][0]["position"][k].as_f64().unwrap();
    for (k, wanted) in [0.1, 0.0, 0.1].into_iter().enumerate() {
        assert!((position(2, k) - position(1, k) - wanted).abs() < 1e-9);
    }
}

fn tilting_table(tilt: &str, errors: &str) -> String {
    format!(
        "abbe: 1\nmachine: trt\nchain: \"w C' {tilt}' b X Y Z t\"\naxes:\n  X: {{ travel: [-250 mm, 250 mm] }}\n  \
         Y: {{ travel: [-200 mm, 200 mm] }}\n  Z: {{ travel: [-400 mm, 0 mm] }}\n  \
         {tilt}: {{ travel: [-100 deg, 30 deg], sense: direct, origin: [1, 2, -350] }}\n  \
         C: {{ travel: continuous, sense: direct, origin: [3, 5, -380] }}\n\
         tool: {{ gauge: [0, 0, 10], length: 120 mm }}\nerrors:\n  {errors}\n"
    )
}

fn joints(tilt: &str, k: f64) -> BTreeMap<String, f64> {
    let values =
        [("X", 6.0 * k - 120.0), ("Y", 100.0 - 5.0 * k), ("Z", -9.0 * k), (tilt, 3.0 * k - 95.0), ("C", 37.0 * k)];
    values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Largest distance of the modules' tips from those of the erroneous machine at the same joints. Both count
/// from where the tip is with all axes at 0.
fn tip_differences(machine: &str, poses: &[Value], zero: [f64; 3]) -> f64 {
    let distance = |pose: &Value| {
        let axes = pose["joints"].as_object().unwrap().iter().filter(|(name, _)| *name != "W");
        let at: Vec<String> = axes.map(|(n, q)| format!("{n}={q}")).collect();
        let text = abbe(&["--quiet", "eval", machine, "--at", &at.join(","), "--format", "json"]);
        let ours: Value = serde_json::from_str(&text).unwrap();
        let gap = |i: usize| {
            let of = |key: &str| ours["poses"][0][key][i].as_f64().unwrap();
            of("nominal") + of("deviation") - zero[i] - pose["position"][i].as_f64().unwrap()
        };
        (0..3).map(|i| gap(i) * gap(i)).sum::<f64>().sqrt()
    };
    poses.iter().map(distance).fold(0.0, f64::max)
}

/// Largest distance between the controller's positions and ours.
fn compare(yaml: &str, items: &[&Value]) -> f64 {
    let folder = Folder::new("kinematics");
    let machine = folder.0.join("machine.yaml");
    let poses = folder.0.join("poses.csv");
    std::fs::write(&machine, yaml).unwrap();
    let names: Vec<&String> = items[0]["joints"].as_object().unwrap().keys().collect();
    let line = |item: &Value| names.iter().map(|n| item["joints"][*n].to_string()).collect::<Vec<_>>().join(",");
    let header = names.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(",");
    let text: Vec<String> = std::iter::once(header).chain(items.iter().map(|item| line(item))).collect();
    std::fs::write(&poses, text.join("\n")).unwrap();
    let (machine, poses) = (machine.display().to_string(), poses.display().to_string());
    let result: Value =
        serde_json::from_str(&abbe(&["--quiet", "eval", &machine, "--poses", &poses, "--format", "json"])).unwrap();
    let ours = result["poses"].as_array().unwrap();
    assert_eq!(ours.len(), items.len());
    let distance = |(item, pose): (&&Value, &Value)| {
        let component = |i: usize| item["position"][i].as_f64().unwrap() - pose["nominal"][i].as_f64().unwrap();
        (0..3).map(|i| component(i) * component(i)).sum::<f64>().sqrt()
    };
    items.iter().zip(ours).map(distance).fold(0.0, f64::max)
}
