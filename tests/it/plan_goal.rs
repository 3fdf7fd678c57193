//! Fewer inputs: how many readings until an uncertainty over the volume is reached, and readings along lines of axes.

use crate::program::{Folder, abbe, json, refused, text};
use nalgebra::{DMatrix, Matrix3, SymmetricEigen, Vector3};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn machine(folder: &Folder) -> PathBuf {
    let axes = ["X", "Y", "Z"].map(|axis| format!("  {axis}: {{ travel: [0, 400], origin: [0, 0, 0] }}\n")).concat();
    folder.with("m.yaml", &format!("abbe: 1\nmachine: M\nchain: w b X Y Z t\naxes:\n{axes}"))
}

const FIT: &str = "EC0Y,EB0Z,EA0Z,EXX:poly1";

fn plan(machine: &Path, more: &[&str]) -> Value {
    let list = ["identify", text(machine), "--fit", FIT, "--format", "json", "--quiet"];
    json(&[&list[..], more].concat())
}

fn place(of: &Value) -> Vector3<f64> {
    let at = &of["axes"];
    Vector3::from_fn(|k, _| at[["X", "Y", "Z"][k]].as_f64().unwrap())
}

/// Derivatives of the deviation by EC0Y, EB0Z, EA0Z, and both coefficients of EXX: the golden signs.
fn effects(q: &Vector3<f64>) -> [Vector3<f64>; 5] {
    let (x, y) = (Vector3::x(), Vector3::y());
    [x * -q.y, x * q.z, y * -q.z, x, x * q.x]
}

/// The largest standard uncertainty over a volume (um) of readings of 1 um at poses, after the best rigid motion.
fn largest_u(poses: &[Vector3<f64>], volume: &[Vector3<f64>]) -> f64 {
    let columns = |list: &[Vector3<f64>]| DMatrix::from_fn(3 * list.len(), 5, |i, j| effects(&list[i / 3])[j][i % 3]);
    let design = columns(poses);
    let covariance = (design.transpose() * &design).try_inverse().unwrap();
    let motion = |i: usize, k: usize| {
        let axis = Vector3::ith(k % 3, 1.0);
        if k < 3 { axis[i % 3] } else { axis.cross(&(volume[i / 3] / 400.0))[i % 3] }
    };
    let motions = DMatrix::from_fn(3 * volume.len(), 6, motion);
    let of = columns(volume);
    let step = motions.clone().svd(true, true).solve(&of, 1e-12).unwrap();
    let left = of - motions * step;
    let one = |i: usize| {
        let rows = left.rows(3 * i, 3);
        let block: Matrix3<f64> = (rows * &covariance * rows.transpose()).fixed_view::<3, 3>(0, 0).into_owned();
        SymmetricEigen::new(block).eigenvalues.max().sqrt()
    };
    (0..volume.len()).map(one).fold(0.0, f64::max)
}

/// Corners of the volume and a grid inside, in about the proportion of the program's.
fn volume() -> Vec<Vector3<f64>> {
    let corner = |i: usize| Vector3::from_fn(|k, _| if i >> k & 1 == 0 { 0.0 } else { 400.0 });
    let inside = |i: usize| Vector3::from_fn(|k, _| (400.0 / 7.0) * ((i / 7_usize.pow(k as u32) % 7) as f64 + 0.5));
    (0..8).map(corner).chain((0..343).map(inside)).collect()
}

#[test]
fn the_predicted_uncertainty_is_that_of_an_own_design() {
    let folder = Folder::new("plan-predicted");
    let machine = machine(&folder);
    for count in ["4", "12", "40"] {
        let of = plan(&machine, &["--plan", count]);
        let poses: Vec<Vector3<f64>> = of["poses"].as_array().unwrap().iter().map(place).collect();
        let own = largest_u(&poses, &volume());
        let found = of["prediction"]["largest_um"].as_f64().unwrap();
        // The places inside are others, which moves the best rigid motion a little.
        assert!((found / own - 1.0).abs() < 0.03, "{found} for {own}");
        // Each parameter by the same design, exactly: um/mm are 1000 urad.
        let design = DMatrix::from_fn(3 * poses.len(), 5, |i, j| effects(&poses[i / 3])[j][i % 3]);
        let covariance = (design.transpose() * &design).try_inverse().unwrap();
        let sigma = of["parameters"][0]["sigma"].as_f64().unwrap();
        assert!((sigma / (1e3 * covariance[(0, 0)].sqrt()) - 1.0).abs() < 1e-6, "{}", of["parameters"]);
    }
}

#[test]
fn a_plan_until_an_uncertainty_has_the_fewest_readings() {
    let folder = Folder::new("plan-until");
    let machine = machine(&folder);
    for goal in [1.0, 0.6, 0.35] {
        let asked = format!("{goal} um");
        let of = plan(&machine, &["--plan", "60", "--until", &asked]);
        let readings = of["readings"].as_u64().unwrap() as usize;
        assert_eq!(
            (&of["goal"]["um"].as_f64().map(|um| (um - goal).abs() < 1e-9), &of["goal"]["reached"]),
            (&Some(true), &true.into())
        );
        assert_eq!(of["poses"].as_array().unwrap().len(), readings);
        // The plans without a goal are the oracle: the one with as many reaches it, that with one fewer does not.
        let u = |count: usize| {
            let of = plan(&machine, &["--plan", &count.to_string()]);
            of["prediction"]["largest_um"].as_f64().unwrap_or(f64::INFINITY)
        };
        assert!(
            u(readings) <= goal && u(readings - 1) > goal,
            "{goal}: {readings}, {} and {}",
            u(readings),
            u(readings - 1)
        );
        assert_eq!(of["prediction"]["largest_um"].as_f64().unwrap(), u(readings));
        let places: BTreeSet<String> =
            of["poses"].as_array().unwrap().iter().map(|of| of["axes"].to_string()).collect();
        assert_eq!(places.len(), readings, "no pose twice");
        let own = largest_u(&of["poses"].as_array().unwrap().iter().map(place).collect::<Vec<_>>(), &volume());
        assert!(own < goal * 1.03, "{own} for {goal}");
    }
    let list = ["identify", text(&machine), "--fit", FIT, "--plan", "60", "--until"];
    let said = abbe(&[&list[..], &["0.6 um"]].concat());
    assert!(said.starts_with("u = 0.6 um over the volume is reached by "), "{said}");
    assert!(said.contains("predicts   the volume with u = 0.5"), "{said}");
    let said = abbe(&[&list[..], &["1 nm"]].concat());
    assert!(said.starts_with("u = 0.001 um over the volume is NOT reached by 60 readings"), "{said}");
    for wrong in ["0 um", "-1 um", "2 m", "1 deg", "x"] {
        let (exit, _) = refused(&[&list[..], &[wrong]].concat());
        assert_eq!(exit, 2, "{wrong}");
    }
    let (exit, said) = refused(&["identify", text(&machine), "--data", "x.csv", "--until", "1 um"]);
    assert!(exit == 2 && said.contains("--plan"), "{said}");
}

#[test]
fn readings_along_lines_of_the_axes_are_planned_only_if_asked_for() {
    let folder = Folder::new("plan-lines");
    let machine = machine(&folder);
    let of = plan(&machine, &["--plan", "21", "--instrument", "lines"]);
    // Two coordinates in {0, 200, 400}, the third one of eleven: 27 + 3 * 9 * 8.
    assert_eq!(of["candidates"], 243);
    let is_end = |q: f64| [0.0, 200.0, 400.0].contains(&q);
    let mut met = BTreeSet::new();
    for pose in of["poses"].as_array().unwrap().iter().map(place) {
        assert!(pose.iter().filter(|q| is_end(**q)).count() >= 2 && pose.iter().all(|q| q % 40.0 == 0.0), "{pose}");
        assert!(met.insert(pose.map(|q| q as i64).as_slice().to_vec()), "{pose} twice");
    }
    // Anywhere it takes other places.
    let anywhere = plan(&machine, &["--plan", "21"]);
    assert!(anywhere["poses"].as_array().unwrap().iter().map(place).any(|pose| pose.iter().all(|q| !is_end(*q))));
    let (exit, said) = refused(&["identify", text(&machine), "--fit", FIT, "--plan", "244", "--instrument", "lines"]);
    assert!(exit == 2 && said.contains("243 readings"), "{said}");
}

#[test]
fn readings_that_leave_the_deviation_free_predict_nothing() {
    let folder = Folder::new("plan-free");
    let machine = machine(&folder);
    // With the other axes in one place, no squareness is seen.
    let rows: String = (0..8).map(|i| format!("{},100,100,,,\n", 50 * i)).collect();
    let data = folder.with("line.csv", &format!("X,Y,Z,dx [um],dy [um],dz [um]\n{rows}"));
    let of = plan(&machine, &["--plan", "8", "--data", text(&data)]);
    assert!(
        of["prediction"]["largest_um"].is_null() && of["prediction"]["combination"].is_string(),
        "{}",
        of["prediction"]
    );
    let of = plan(&machine, &["--plan", "8", "--data", text(&data), "--until", "5 um"]);
    assert_eq!((&of["goal"]["reached"], &of["readings"]), (&false.into(), &8.into()));
}
