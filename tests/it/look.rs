//! `up` and `look` of a machine file: what is drawn, where, what is refused by name, and that no figure feels it.

use crate::program::Folder;
use crate::support::{Run, abbe};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::path::Path;

const MACHINE: &str = "abbe: 1
machine: Horizontal
chain: w B' X' b Y Z t
axes:
  X: { travel: [0, 400], origin: [0, 0, 0] }
  Y: { travel: [0, 300], origin: [0, 0, 0] }
  Z: { travel: [0, 500], origin: [0, 0, 0] }
  B: { travel: continuous, origin: [200, 0, 250] }
tool: { gauge: [200, 150, 100], length: 120 mm, direction: [0, 0, 1] }
workpiece: { origin: [200, 150, 250] }
tolerances: { B: { location: { across: 5 um } }, EXX: 10 um }
";

/// A binary STL of a box between two corners.
pub fn block(low: [f32; 3], high: [f32; 3]) -> Vec<u8> {
    let corner = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { high[i] } else { low[i] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let mut bytes = vec![0; 80];
    bytes.extend(12_u32.to_le_bytes());
    for half in halves {
        bytes.extend([0.0_f32; 3].into_iter().chain(half.into_iter().flat_map(corner)).flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Writes a machine with this `look`, and meshes beside it.
fn machine(folder: &Path, look: &str) -> std::path::PathBuf {
    let file = folder.join("m.yaml");
    std::fs::write(&file, format!("{MACHINE}{look}")).unwrap();
    std::fs::write(folder.join("ram.stl"), block([0.0; 3], [10.0, 20.0, 30.0])).unwrap();
    file
}

fn check(file: &Path, more: &[&str]) -> Run {
    Run::of(abbe().args(["check", "--format", "json"]).args(more).arg(file))
}

/// What the page is told of the meshes.
fn look(file: &Path, max_triangles: usize) -> Value {
    let request = json!({"machine": file, "questions": [{"look": {"max_triangles": max_triangles}}]});
    abbe::workbench(&request.to_string(), abbe::Run::on_disk())["answers"][0].clone()
}

/// The points of a surface.
fn points(surface: &Value) -> Vec<[f64; 3]> {
    let bytes = BASE64_STANDARD.decode(surface["positions"].as_str().unwrap()).unwrap();
    let numbers: Vec<f64> =
        bytes.chunks_exact(4).map(|of| f64::from(f32::from_le_bytes(of.try_into().unwrap()))).collect();
    numbers.chunks_exact(3).map(|of| [of[0], of[1], of[2]]).collect()
}

/// Lowest and highest coordinates.
fn extent(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let end = |pick: fn(f64, f64) -> f64| [0, 1, 2].map(|i| points.iter().map(|at| at[i]).reduce(pick).unwrap());
    [end(f64::min), end(f64::max)]
}

#[test]
fn a_mesh_stands_where_the_file_says() {
    let folder = Folder::new("look");
    let text = "up: [0, 2, 0]\nlook:\n  X: ram.stl\n  bed: { mesh: ram.stl, unit: cm, origin: [1, 2, 3], rotation: { A: 90, C: 90 } }\n";
    let file = machine(&folder.0, text);
    let checked = check(&file, &["--deny", "warnings"]);
    assert!(checked.code == Some(0), "{}", checked.err);
    let found = look(&file, 1000);
    let bodies = found["bodies"].as_array().unwrap();
    assert_eq!(bodies.iter().map(|of| &of["body"]).collect::<Vec<_>>(), ["X", "bed"]);
    // Equal corners of its twelve triangles are one.
    assert_eq!((points(&bodies[0]).len(), &found["words"]), (8, &json!("meshes of 24 triangles")));
    assert_eq!(extent(&points(&bodies[0])), [[0.0; 3], [10.0, 20.0, 30.0]]);
    // (x, y, z) turned about X is (x, -z, y), and that about Z is (z, x, y): in cm, and from (1, 2, 3).
    let [low, high] = extent(&points(&bodies[1]));
    for (i, (from, to)) in [(1.0, 301.0), (2.0, 102.0), (3.0, 203.0)].into_iter().enumerate() {
        assert!((low[i] - from).abs() < 1e-3 && (high[i] - to).abs() < 1e-3, "{low:?} {high:?}");
    }
    let request = json!({"machine": file, "questions": ["show"]});
    let chain = &abbe::workbench(&request.to_string(), abbe::Run::on_disk())["answers"][0];
    assert_eq!((&chain["up"], &chain["look"][1]["unit_mm"]), (&json!([0.0, 1.0, 0.0]), &json!(10.0)));
}

#[test]
fn what_cannot_be_drawn_is_named_and_stops_no_figure() {
    let folder = Folder::new("look-faults");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.0.join(name), bytes).unwrap();
    let whole = block([0.0; 3], [1.0; 3]);
    write("cut.stl", &whole[..300]);
    write("nan.stl", &block([f32::NAN; 3], [1.0; 3]));
    write("far.stl", &block([0.0; 3], [1e8; 3]));
    write("model.step", b"ISO-10303-21;\n");
    write("web.gltf", br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"https://a.example/b.bin"}]}"#);
    let cases = [
        ("missing.stl", "no such file"),
        ("cut.stl", "promises 12 triangles"),
        ("nan.stl", "not a finite number"),
        ("far.stl", "1.0e8 mm"),
        ("model.step", "STEP"),
        ("web.gltf", "nothing is fetched"),
        (".", "not a file"),
    ];
    for (name, words) in cases {
        let name = if name == "." { "folder.stl" } else { name };
        let _ = std::fs::create_dir(folder.0.join("folder.stl"));
        let file = machine(&folder.0, &format!("look: {{ Y: {name}, X: ram.stl }}\n"));
        let checked = check(&file, &[]);
        assert_eq!(checked.code, Some(0), "{name}: {}", checked.err);
        let warning = &checked.json()["warnings"][0];
        assert_eq!((&warning["code"], &warning["place"]["line"]), (&json!("W0853"), &json!(12)), "{warning}");
        let message = warning["message"].as_str().unwrap();
        assert!(message.contains(words), "{name}: {message}");
        assert_eq!(check(&file, &["--deny", "warnings"]).code, Some(1));
        let found = look(&file, 1000);
        assert_eq!((found["bodies"].as_array().unwrap().len(), &found["warnings"][0]["code"]), (1, &json!("W0853")));
        // Other verbs read no mesh.
        let map = Run::of(abbe().args(["show", "--deny", "warnings"]).arg(&file));
        assert_eq!(map.code, Some(0), "{}", map.err);
    }
    for (look, code) in [
        ("look: { D: ram.stl }", "E0201"),
        ("look: { X: { unit: mm } }", "E0203"),
        ("look: { X: { mesh: ram.stl, unit: deg } }", "E0206"),
        ("look: { X: { mesh: ram.stl, rotation: { X: 90 } } }", "E0201"),
        ("look: { X: [1, 2] }", "E0202"),
        ("up: [0, 0, 0]", "E0402"),
        ("up: Y", "E0202"),
    ] {
        let file = machine(&folder.0, &format!("{look}\n"));
        let _ = Run::of(abbe().arg("check").arg(&file)).refused(code);
    }
}

#[test]
fn a_variant_that_drops_an_axis_drops_its_mesh() {
    let folder = Folder::new("look-variant");
    let _ = machine(&folder.0, "look: { B: ram.stl, Y: ram.stl }\n");
    let variant = folder.0.join("v.yaml");
    let text = "abbe: 1\nextends: m.yaml\nmachine: V\nchain: w X' b Y Z t\nlook: { Y: null, Z: ram.stl }\n";
    std::fs::write(&variant, text).unwrap();
    let bodies = look(&variant, 1000)["bodies"].clone();
    assert_eq!(bodies.as_array().unwrap().iter().map(|of| &of["body"]).collect::<Vec<_>>(), ["Z"]);
}

#[test]
fn no_study_feels_a_mesh() {
    let folder = Folder::new("look-study");
    let part = |look: &str| {
        let file = machine(&folder.0, look);
        let out = folder.0.join("part.json");
        let _ = std::fs::remove_file(&out);
        let run = Run::of(
            abbe()
                .args(["budget", "--poses", "20", "--samples", "64", "--shard", "1/2", "--quiet", "--state"])
                .arg(&out)
                .arg(&file),
        );
        assert_eq!(run.code, Some(0), "{}", run.err);
        std::fs::read_to_string(out).unwrap()
    };
    assert_eq!(part(""), part("up: [0, 1, 0]\nlook: { X: ram.stl }\n"));
}

#[test]
fn what_is_mailed_is_small() {
    let folder = Folder::new("look-mailed");
    let file = machine(&folder.0, "look: { X: big.stl, Y: ram.stl }\n");
    // A wavy field of 80,000 triangles.
    let n = 200_usize;
    let at = |i: usize, k: usize| [i as f32, k as f32, 5.0 * ((i as f32) / 20.0).sin() * ((k as f32) / 20.0).cos()];
    let mut bytes = vec![0; 80];
    bytes.extend(u32::try_from(2 * n * n).unwrap().to_le_bytes());
    for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
        for half in [[at(i, k), at(i + 1, k), at(i, k + 1)], [at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]] {
            bytes.extend([0.0_f32; 3].into_iter().chain(half.into_iter().flatten()).flat_map(f32::to_le_bytes));
            bytes.extend([0, 0]);
        }
    }
    std::fs::write(folder.0.join("big.stl"), bytes).unwrap();
    let found = look(&file, 20_000);
    let drawn = found["drawn"].as_u64().unwrap();
    assert!((8_000..=20_000).contains(&drawn), "{drawn}");
    assert_eq!(found["words"], format!("meshes of {drawn} triangles, simplified from 80012"));
    let [low, high] = extent(&points(&found["bodies"][0]));
    assert!(low[0] >= 0.0 && low[0] < 2.0 && high[0] > 198.0 && high[0] <= 200.0, "{low:?} {high:?}");
    let page = folder.0.join("page.html");
    let report = |file: &Path| {
        let run = Run::of(
            abbe().args(["report", "--samples", "20", "--poses", "30", "--quiet", "--out"]).arg(&page).arg(file),
        );
        assert_eq!(run.code, Some(0), "{}", run.err);
        std::fs::metadata(&page).unwrap().len()
    };
    let with = report(&file);
    let without = report(&machine(&folder.0, ""));
    assert!(with > without + 50_000 && with < without + 700_000, "{with} {without}");
}
