//! The deviation along the normal of the surface, against its own arithmetic.

use crate::program::{Folder, abbe, json, text};
use serde_json::Value;
use std::path::PathBuf;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A five-axis machine with these lines.
fn five(folder: &Folder, lines: &str) -> PathBuf {
    let text = format!(
        "abbe: 1\nmachine: M\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  Z: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n  \
         A: {{ travel: [-60 deg, 60 deg], origin: [0, 0, -40] }}\n  C: {{ travel: continuous, origin: [0, 0, -50] }}\n\
         {lines}\n"
    );
    folder.with("m.yaml", &text)
}

/// The columns of a CSV by their names in the header.
fn columns<const N: usize>(csv: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let mut lines = csv.lines().filter(|line| !line.is_empty());
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at =
        names.map(|name| header.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}: {header:?}")));
    lines.map(|line| at.map(|k| line.split(',').nth(k).unwrap().parse().unwrap())).collect()
}

#[test]
fn the_deviation_along_the_normal_is_the_same_in_every_frame() {
    let folder = Folder::new("normal-columns");
    let machine = five(
        &folder,
        "workpiece: { origin: [10, 20, 0], rotation: { B: 30 deg } }\nerrors: { EC0Y: 300 urad, EA0Z: 200 urad, EX0C: \
         50 um, EZZ: { points: [[-300 mm, -90 um], [300 mm, 110 um]] } }",
    );
    let rows = [
        ([10.0, 20.0, 5.0], [0.0, 0.2, 0.9], [0.6, 0.0, 0.8]),
        ([-30.0, 15.0, -5.0], [0.3, 0.0, 0.9], [0.0, -2.0, 0.0]),
        ([25.0, -40.0, 12.0], [0.0, 0.0, 1.0], [1.0, 2.0, 2.0]),
    ];
    let line = |(p, a, n): &([f64; 3], [f64; 3], [f64; 3])| {
        p.iter().chain(a).chain(n).map(f64::to_string).collect::<Vec<_>>().join(",") + "\n"
    };
    let table = rows.iter().map(line).collect::<String>();
    let _ = folder.with("part.csv", &format!("X,Y,Z,I,J,K,NX,NY,NZ\n{table}"));
    // A quarter of a turn about Z: x of the part is y of the workpiece.
    let job = folder.with("job.yaml", "tool_poses: part.csv\nplace: { rotation: [0, 0, 90] }\nreference: machine\n");
    let truth = |[dx, dy, dz]: [f64; 3], [nx, ny, nz]: [f64; 3]| {
        // The frame of the workpiece is turned on its seat with the part.
        (dz * nz + dy * nx - dx * ny) / (nx * nx + ny * ny + nz * nz).sqrt()
    };
    let map = |frame: &str| abbe(&["map", text(&machine), "--job", text(&job), "--frame", frame, "--format", "csv"]);
    let unturned = columns(&map("workpiece"), ["dx [um]", "dy [um]", "dz [um]", "dn [um]"]);
    let along: Vec<f64> = unturned.iter().map(|row| row[3]).collect();
    for ([dx, dy, dz, dn], (.., normal)) in unturned.into_iter().zip(rows) {
        assert!((dn - truth([dx, dy, dz], normal)).abs() < 1e-9 && dn.abs() > 1.0, "{dn} {dx} {dy} {dz}");
    }
    for frame in ["machine", "tool"] {
        let turned = columns(&map(frame), ["dn [um]", "dx [um]"]);
        assert!(turned.iter().zip(&along).all(|([dn, _], truth)| (dn - truth).abs() < 1e-9), "{frame}");
    }
    let eval = ["eval", text(&machine), "--job", text(&job)];
    for frame in ["workpiece", "tool"] {
        let frame = ["--frame", frame, "--format"];
        let csv = abbe(&[&eval[..], &frame, &["csv"]].concat());
        let found = json(&[&eval[..], &frame, &["json"]].concat());
        for ((row, pose), truth) in
            columns(&csv, ["dn [mm]"]).iter().zip(found["poses"].as_array().unwrap()).zip(&along)
        {
            let [mm, um] = [row[0], number(&pose["along_normal"]) * 1e3];
            assert!((mm * 1e3 - truth).abs() < 1e-9 && (um - truth).abs() < 1e-9, "{mm} {um} {truth}");
        }
    }
    assert!(abbe(&eval).contains("along normal um"));
    let out = folder.file("rows.json");
    let _ = abbe(&["map", text(&machine), "--job", text(&job), "--json", text(&out), "--quiet"]);
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    assert!((number(&rows["poses"][1]["along_normal_um"]) - along[1]).abs() < 1e-9, "{}", rows["poses"][1]);
    assert!(rows["poses"][1]["rotation_urad"].as_array().unwrap().len() == 3);
    let _ = folder.with("part.csv", "X,Y,Z\n0,0,0\n");
    assert!(!map("workpiece").contains("dn [um]") && !abbe(&eval).contains("along normal"));
}
