//! The controller's own kinematics modules, called in process, against `eval`.

use crate::{Folder, abbe, script_json};
use serde_json::Value;
use std::collections::BTreeMap;

/// Ideal positions agree to 1e-9 mm at random offsets, pivots and joint positions.
pub fn ideal() {
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
