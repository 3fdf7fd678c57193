//! Touches of planes from stated directions. Oracle: the rigid-body model moves the linear axes until the actual ball of
//! the probe meets the actual plane.

use crate::kinematic_parameters::{OF_TABLES, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::V3;
use crate::program::{Folder, json, refused, text};
use crate::support::config::sample;
use nalgebra::{Matrix3, Rotation3, Vector3};
use serde_json::Value;

/// Radius of the probe's ball less its pre-travel, mm.
const CONSTANT: f64 = 2.996;
/// Threefold lobing of the pre-travel, mm.
const LOBE: f64 = 0.0012;

/// The actual and the nominal tip, workpiece frame, where the axes X, Y, Z, A, C are.
fn tips(machine: &Sample, at: &[f64; 5]) -> [Vector3<f64>; 2] {
    let of = |name: &str| at[["X", "Y", "Z", "A", "C"].iter().position(|axis| *axis == name).unwrap()];
    let pose: Vec<f64> = machine.rigid.walk.iter().map(|axis| of(&axis.name)).collect();
    machine.holds(&pose, Travel::Mean).map(|held| Vector3::from(held.tip))
}

/// Moves the linear axes so that the tip (actual 0, nominal 1) moves by this.
fn moved(machine: &Sample, at: &[f64; 5], by: Vector3<f64>, which: usize) -> [f64; 5] {
    let here = tips(machine, at)[which];
    let column = |k: usize| {
        let mut other = *at;
        other[k] += 1.0;
        tips(machine, &other)[which] - here
    };
    let step = Matrix3::from_columns(&[column(0), column(1), column(2)]).try_inverse().unwrap() * by;
    std::array::from_fn(|k| at[k] + if k < 3 { step[k] } else { 0.0 })
}

/// Faces of a block: normal, middle, and two directions along it (mm, workpiece frame).
const FACES: [[V3; 4]; 4] = [
    [[1.0, 0.0, 0.0], [60.0, 0.0, 40.0], [0.0, 35.0, 0.0], [0.0, 0.0, 25.0]],
    [[-1.0, 0.0, 0.0], [-60.0, 0.0, 40.0], [0.0, 35.0, 0.0], [0.0, 0.0, 25.0]],
    [[0.0, 1.0, 0.0], [0.0, 50.0, 40.0], [45.0, 0.0, 0.0], [0.0, 0.0, 25.0]],
    [[0.0, 0.0, 1.0], [0.0, 0.0, 80.0], [45.0, 0.0, 0.0], [0.0, 35.0, 0.0]],
];

/// The table of the touches of blocks (name, and size over that of [`FACES`]) that are displaced and turned on the
/// machine.
fn campaign(machine: &Sample, blocks: &[(&str, f64)]) -> String {
    let (turn, shift) = (Rotation3::new(Vector3::new(2e-4, -3e-4, 1e-4)), Vector3::new(0.02, -0.03, 0.01));
    let mut table = "X,Y,Z,A [deg],C [deg],feature,n.x,n.y,n.z\n".to_owned();
    let turns = [[0.0, 0.0], [0.0, 97.0], [0.0, 180.0], [0.0, 270.0], [-60.0, 10.0], [-60.0, 130.0], [-90.0, 45.0]];
    for [a, c] in turns.into_iter().chain([[25.0, 200.0], [-30.0, 310.0]]) {
        let faces = blocks.iter().flat_map(|(name, size)| {
            FACES.map(|[normal, rest @ ..]| (name, Vector3::from(normal), rest.map(|v| Vector3::from(v) * *size)))
        });
        for (name, normal, [middle, u, v]) in faces {
            for [s, t] in [[1.0, 1.0], [-1.0, 0.6], [0.3, -1.0]] {
                let place = middle + u * s + v * t;
                let start = [250.0, 225.0, -200.0, a, c];
                let target = place + normal * CONSTANT - tips(machine, &start)[1];
                let mut at = moved(machine, &start, target, 1);
                // The tool does not turn: its frame is that of the machine, in which the block is turned by C and A.
                let in_machine = Rotation3::from_axis_angle(&Vector3::x_axis(), -f64::to_radians(a))
                    * Rotation3::from_axis_angle(&Vector3::z_axis(), -f64::to_radians(c))
                    * normal;
                let angle = 3.0 * in_machine.y.atan2(in_machine.x);
                let wanted = CONSTANT + LOBE * in_machine.xy().norm() * angle.cos();
                for _ in 0..4 {
                    let [actual, _] = tips(machine, &at);
                    let off = (turn * normal).dot(&(actual - (turn * place + shift))) - wanted;
                    at = moved(machine, &at, normal * -off, 0);
                }
                let positions: Vec<String> = at.iter().map(|q| format!("{q:.9}")).collect();
                table += &format!("{},{name},{},{},{}\n", positions.join(","), normal.x, normal.y, normal.z);
            }
        }
    }
    table
}

fn found<'v>(fit: &'v Value, list: &str, name: &str) -> &'v Value {
    fit[list].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap_or_else(|| panic!("{name}: {fit}"))
}

#[test]
fn touches_of_a_block_tell_the_rotary_axes_and_the_probe() {
    let folder = Folder::new("touches");
    let real = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let data = folder.with("touches.csv", &campaign(&real, &[("block", 1.0)]));
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    let fit = json(&[
        "identify",
        text(&plain),
        "--fit",
        &names.join(","),
        "--data",
        text(&data),
        "--format",
        "json",
        "--quiet",
    ]);
    let unknowns: Vec<&str> =
        fit["instruments"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    let motions = ["x", "y", "z", "A", "B", "C"].map(|letter| format!("feature block.{letter}"));
    let of_probe = ["touch constant", "touch lobe cos", "touch lobe sin"].map(str::to_owned);
    assert_eq!(unknowns, [&motions[..], &of_probe].concat());
    assert_eq!(fit["kinds"][0]["kind"], "touches");
    let after = fit["rms_um"]["after"].as_f64().unwrap();
    assert!(after < 0.02, "{after}");
    for line in OF_TABLES.lines() {
        let (name, wanted) = line.trim().split_once(": ").unwrap();
        let wanted: f64 = wanted.split(' ').next().unwrap().parse().unwrap();
        let value = found(&fit, "parameters", name)["value"].as_f64().unwrap();
        // A rotation of 0.3 mrad of the block times its displacement is the part that is not linear.
        assert!((value - wanted).abs() < 0.2, "{name}: {value} {wanted}");
    }
    let lobe = |word: &str| found(&fit, "instruments", &format!("touch lobe {word}"))["value"].as_f64().unwrap();
    assert!((lobe("cos") - LOBE).abs() < 2e-5 && lobe("sin").abs() < 2e-5, "{fit}");
}

/// Half the size of a block is in the constant: blocks of two sizes have two, those of one size share it.
#[test]
fn features_of_two_sizes_have_a_constant_each() {
    let folder = Folder::new("touches-sizes");
    let real = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let blocks = [("large", 1.0), ("small", 0.5), ("again", 1.0)];
    let data = folder.with("touches.csv", &campaign(&real, &blocks));
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    let names = names.join(",");
    let fit = json(&["identify", text(&plain), "--fit", &names, "--data", text(&data), "--format", "json", "--quiet"]);
    let constants: Vec<(&str, f64)> = fit["instruments"].as_array().unwrap().iter().map(named).collect();
    let constants: Vec<_> = constants.into_iter().filter(|(name, _)| name.starts_with("touch constant")).collect();
    let [(small, of_small), (large, of_large)] = constants[..] else { panic!("{constants:?}") };
    assert_eq!([small, large], ["touch constant feature small", "touch constant feature large"]);
    assert!((of_large - of_small - 30.0).abs() < 1e-3, "{constants:?}");
    for line in OF_TABLES.lines() {
        let (name, wanted) = line.trim().split_once(": ").unwrap();
        let wanted: f64 = wanted.split(' ').next().unwrap().parse().unwrap();
        let value = found(&fit, "parameters", name)["value"].as_f64().unwrap();
        assert!((value - wanted).abs() < 0.2, "{name}: {value} {wanted}");
    }
}

/// A part that is set up anew in each session: its place and turn are fitted for each, and are no part of the machine.
#[test]
fn workpieces_are_set_up_by_themselves_in_each_session() {
    let folder = Folder::new("set-ups");
    let real = sample(&folder.with("real.yaml", &table_table(OF_TABLES)));
    let plain = folder.with("plain.yaml", &table_table("  EX0C: 0 um\n"));
    let mut table = "session,X,Y,Z,A [deg],C [deg],dx [um],dy [um],dz [um]\n".to_owned();
    let set_ups = [([0.2, -0.1, 0.05], [2e-4, -1e-4, 3e-4]), ([-0.15, 0.3, 0.1], [-3e-4, 2e-4, 1e-4])];
    for (session, (shift, turn)) in ["am", "pm"].into_iter().zip(set_ups) {
        let (shift, turn) = (Vector3::from(shift), Rotation3::new(Vector3::from(turn)));
        for [a, c] in [[0.0, 0.0], [0.0, 120.0], [0.0, 240.0], [-60.0, 30.0], [-90.0, 200.0], [25.0, 310.0]] {
            for [x, y, z] in [[250.0, 225.0, -200.0], [330.0, 225.0, -220.0], [250.0, 300.0, -150.0]] {
                let at = [x, y, z, a, c];
                let [actual, nominal] = tips(&real, &at);
                // The part lies elsewhere: what it sees of the tip.
                let read = (turn.inverse() * (actual - shift) - nominal) * 1e3;
                table += &format!("{session},{x},{y},{z},{a},{c},{},{},{}\n", read.x, read.y, read.z);
            }
        }
    }
    let data = folder.with("sessions.csv", &table);
    let names: Vec<&str> = OF_TABLES.lines().map(|line| line.trim().split(':').next().unwrap()).collect();
    let fit = |set_up: &str, more: &[&str]| {
        let list = format!("{},{set_up}", names.join(","));
        let words = ["identify", text(&plain), "--fit", &list, "--data", text(&data), "--format", "json", "--quiet"];
        json(&[&words[..], more].concat())
    };
    let file = folder.file("fitted.yaml");
    let each = fit("workpiece-by-run", &["--out", text(&file)]);
    let left = |fit: &Value| fit["rms_um"]["after"].as_f64().unwrap();
    // Products of a turn of 0.3 mrad and a displacement of 0.3 mm.
    assert!(left(&each) < 0.1, "{}", left(&each));
    for line in OF_TABLES.lines() {
        let (name, wanted) = line.trim().split_once(": ").unwrap();
        let wanted: f64 = wanted.split(' ').next().unwrap().parse().unwrap();
        let value = found(&each, "parameters", name)["value"].as_f64().unwrap();
        assert!((value - wanted).abs() < 0.2, "{name}: {value} {wanted}");
    }
    let [am, pm] =
        ["am", "pm"].map(|run| found(&each, "parameters", &format!("workpiece run {run}.C"))["value"].as_f64());
    assert!((am.unwrap() - pm.unwrap()).abs() > 150.0, "{each}");
    assert!(left(&fit("workpiece", &[])) > 50.0);
    let written = std::fs::read_to_string(&file).unwrap();
    assert!(written.contains("workpiece: {  } }") && written.contains("workpiece-by-run"), "{written}");
}

fn named(of: &Value) -> (&str, f64) {
    (of["name"].as_str().unwrap(), of["value"].as_f64().unwrap())
}

/// A dial on a straightedge: what is not straight is the machine's, the rest its place.
#[test]
fn a_dial_on_a_plane_reads_a_straightness() {
    let folder = Folder::new("dial");
    let axis = |name: &str| format!("  {name}: {{ travel: [0, 500], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(axis).concat();
    let machine = folder.with("m.yaml", &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}"));
    let dial = |x: f64| 3.0 + 0.02 * x + 8.0 * (x / 250.0 - 1.0).powi(2);
    let row = |i: u32| {
        let x = f64::from(i) * 50.0;
        format!("{x},edge,0,0,1,{}\n", dial(x))
    };
    let rows: String = (0..11).map(row).collect();
    let data = folder.with("dial.csv", &format!("X,feature,n.x,n.y,n.z,touch [um]\n{rows}"));
    let fixed = ["--fixed", "EZX:x^0,EZX:x^1"];
    let asked =
        ["identify", text(&machine), "--fit", "EZX:poly2", "--data", text(&data), "--format", "json", "--quiet"];
    let fit = json(&[&asked[..], &fixed].concat());
    let unit = found(&fit, "parameters", "EZX:x^2");
    assert_eq!(unit["unit"], "um/m^2");
    assert!((unit["value"].as_f64().unwrap() - 8.0 / 0.0625).abs() < 1e-6, "{fit}");
    for (titles, row, said) in [
        ("X,feature,n.x,n.y", "0,edge,0,0", "all three of `n.x`"),
        ("X,dx [um],n.x,n.y,n.z", "0,1,0,0,1", "all three of `n.x`"),
        ("X,feature,n.x,n.y,n.z", "0,edge,0,0,0", "has no length"),
        ("X,feature,n.x,n.y,n.z", "0,edge,0,0,up", "E0501"),
    ] {
        let file = folder.with("bad.csv", &format!("{titles}\n{row}\n{row}\n"));
        let (code, found) = refused(&["identify", text(&machine), "--fit", "EZX:poly2", "--data", text(&file)]);
        assert!(code == 1 && found.contains("E0501") && found.contains(said), "{found}");
    }
}
