//! The rotation of the workpiece: every input and output in its frame counts in the coordinates of the part, and
//! nothing else changes.

use crate::configs;
use crate::language::read;
use crate::oracle::matrix::elementary;
use crate::oracle::random::Random;
use crate::program::{Folder, abbe, json, text};
use abbe::analysis::instrument::{CirclePlane as Plane, ball_bar, diagonals, r_test};
use abbe::analysis::{
    SurveyTask, ToolPose, View, body_diagonals, branches, inverse, map, place, rest, survey_with_rows, tool_pose,
};
use abbe::evaluate::{
    Bare, CompiledField, Deviation, Frame, Nodes, Order, Poses, Random as Draw, evaluate, random_poses,
};
use abbe::machine::{Approach, Machine, MachineProperty, machine_file};
use nalgebra::{Matrix3, Matrix4, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The text of a machine whose part is turned by angles (deg).
fn text_of(machine: &Machine, angles: [f64; 3]) -> String {
    let mut parts = machine.to_parts();
    parts.workpiece_rotation = angles;
    machine_file(&parts, &[])
}

fn with_part(machine: &Machine, angles: [f64; 3]) -> Machine {
    read(&[("m.yaml", &text_of(machine, angles))]).0.unwrap()
}

/// The machine without rotation, with one, and the matrix from coordinates of the part to machine directions.
fn both(machine: &Machine, angles: [f64; 3]) -> (Machine, Machine, Matrix3<f64>) {
    let [a, b, c] = [0, 1, 2].map(|axis| {
        let m = elementary(axis, angles[axis].to_radians());
        Matrix3::from_fn(|i, k| m[i][k])
    });
    (with_part(machine, [0.0; 3]), with_part(machine, angles), c * b * a)
}

fn of_config(name: &str, angles: [f64; 3]) -> (Machine, Machine, Matrix3<f64>) {
    both(&configs::machine(name), angles)
}

fn near(a: &Vector3<f64>, b: &Vector3<f64>, tolerance: f64) -> bool {
    (a - b).amax() <= tolerance
}

#[test]
fn deviations_turn_with_the_part_and_the_other_frames_stay() {
    let mut random = Random::new(5);
    for (name, machine) in configs::all() {
        let (plain, turned, r) = both(&machine, random.vector(180.0));
        for pose in random_poses(&plain, 4, 7) {
            for order in [Order::Exact, Order::Degree(2)] {
                let at = |machine, frame| evaluate(machine, &Approach::Mean.at_pose(&pose), order, frame);
                let (before, after) = (at(&plain, Frame::Workpiece), at(&turned, Frame::Workpiece));
                // 1e-12 mm of the deviation; the nominal tip is metres away.
                assert!(near(&after.deviation.position, &(r.transpose() * before.deviation.position), 1e-12), "{name}");
                assert!(near(&after.deviation.rotation, &(r.transpose() * before.deviation.rotation), 1e-15), "{name}");
                assert!(near(&after.nominal, &(r.transpose() * before.nominal), 1e-11), "{name}");
                let from_part: Matrix4<f64> = before.e_ve * r.to_homogeneous();
                assert!((after.e_ve - from_part).amax() < 1e-12, "{name}");
                for frame in [Frame::Machine, Frame::Tool] {
                    let (before, after) = (at(&plain, frame), at(&turned, frame));
                    assert_eq!((before.deviation, before.nominal), (after.deviation, after.nominal), "{name}");
                }
            }
        }
    }
}

/// The deviations of a survey in the order of its poses.
fn surveyed(field: &CompiledField, poses: &Poses, view: View) -> Vec<Deviation> {
    let mut all = Vec::new();
    let task = SurveyTask { field, poses, view, worst: 1 };
    let rows =
        |block: abbe::analysis::SurveyBlock<'_>| block.rows().map(|(_, deviation)| deviation).collect::<Vec<_>>();
    let mut keep = |rows: Vec<Deviation>| {
        all.extend(rows);
        true
    };
    assert!(survey_with_rows(task, &rows, &mut keep, &|_| Ok(())).unwrap().is_some());
    all
}

#[test]
fn maps_and_surveys_count_in_the_coordinates_of_the_part() {
    for name in ["trunnion.yaml", "hmc-4ax.yaml", "gantry-3ax.yaml"] {
        let (plain, turned, r) = of_config(name, [-90.0, 20.0, 35.0]);
        let listed = Poses::Random(Draw::of(&plain, 300, 3));
        let mut volume = plain.volume().to_vec();
        volume.iter_mut().for_each(|grid| grid.step = (grid.max - grid.min) / 3.0);
        let grid = Poses::Nodes(Nodes::new(&volume));
        // Order 3 goes through the general algebra.
        for (order, poses) in [
            (Order::Exact, &listed),
            (Order::Degree(1), &grid),
            (Order::Degree(2), &listed),
            (Order::Degree(3), &listed),
        ] {
            for frame in [Frame::Workpiece, Frame::Machine, Frame::Tool] {
                let view = View { frame, ..View::default() };
                let rows = |machine: &Machine| {
                    let field = CompiledField::new(machine, order);
                    let map = map(&field, poses, view, &|_| Ok(())).unwrap();
                    let streamed = surveyed(&field, poses, view);
                    (map.deviations, streamed, map.statistics.position_um.max)
                };
                let ((a, s, max), (b, t, turned_max)) = (rows(&plain), rows(&turned));
                assert!((max - turned_max).abs() < 1e-9, "{name}: {max} {turned_max}");
                let back = if frame == Frame::Workpiece { r.transpose() } else { Matrix3::identity() };
                for (before, after) in a.iter().zip(&b).chain(s.iter().zip(&t)) {
                    assert!(near(&(back * before.position), &after.position, 1e-12), "{name} {order} {frame:?}");
                    assert!(near(&(back * before.rotation), &after.rotation, 1e-15), "{name} {order} {frame:?}");
                }
            }
        }
    }
}

#[test]
fn tool_poses_in_the_coordinates_of_the_part_lead_to_the_same_poses() {
    let mut random = Random::new(8);
    let mut all = configs::all();
    all.push(("ur5".to_owned(), configs::machine("robots/ur5.yaml")));
    for (name, machine) in all {
        let (plain, turned, r) = both(&machine, random.vector(180.0));
        for pose in random_poses(&plain, 5, 9) {
            let (before, after) = (tool_pose(&plain, &pose), tool_pose(&turned, &pose));
            assert!(near(&after.tip, &(r.transpose() * before.tip), 1e-11), "{name}");
            assert!(near(&after.direction, &(r.transpose() * before.direction), 1e-14), "{name}");
            // A robot is asked with a spin, or it has as many poses as spins.
            let spin_rad = (name == "ur5").then_some(0.7);
            let (before, after) = (ToolPose { spin_rad, ..before }, ToolPose { spin_rad, ..after });
            let (here, there) = (inverse(&plain, &before, &rest(&plain)), inverse(&turned, &after, &rest(&turned)));
            match (&here, &there) {
                (Ok(a), Ok(b)) => {
                    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{name}: {a:?} {b:?}");
                    let again = tool_pose(&turned, b);
                    assert!(near(&again.tip, &after.tip, 2e-9) && near(&again.direction, &after.direction, 2e-12));
                }
                (a, b) => assert_eq!(a.is_ok(), b.is_ok(), "{name}: {a:?} {b:?}"),
            }
            let (here, there) = (place(&plain, &before.tip, &pose), place(&turned, &after.tip, &pose));
            if let (Ok(a), Ok(b)) = (&here, &there) {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7), "{name}: {a:?} {b:?}");
            }
            assert_eq!(here.is_ok(), there.is_ok());
            let list = |machine: &Machine, target: &ToolPose| branches(machine, target, &rest(machine)).len();
            assert_eq!(list(&plain, &before), list(&turned, &after), "{name}");
        }
    }
}

#[test]
fn instruments_read_the_same_but_for_planes_of_the_part() {
    let (plain, turned, _) = of_config("trunnion.yaml", [-90.0, 0.0, 0.0]);
    let centre = [0.0, 0.0, 225.0, 250.0, -150.0];
    // XY of the part runs from X to -Z of the machine: its ZX circle, a quarter turn on.
    let [part, machine] =
        [(&turned, Plane::XY), (&plain, Plane::ZX)].map(|(m, plane)| ball_bar(m, &centre, plane, 100.0, 360).unwrap());
    let senses =
        [(&part.counter_clockwise_um, &machine.counter_clockwise_um), (&part.clockwise_um, &machine.clockwise_um)];
    for (sense, (of_part, of_machine)) in senses.into_iter().enumerate() {
        for i in 0..360 {
            let (a, b) = (of_part[i], of_machine[(i + 90) % 360]);
            assert!((a - b).abs() < 1e-7, "{sense} {i}: {a} {b}");
        }
    }
    let deviation = part.circular_deviation_um.counter_clockwise;
    assert!(deviation > 1.0, "{deviation}");
    let other = ball_bar(&plain, &centre, Plane::XY, 100.0, 360).unwrap();
    assert!((other.circular_deviation_um.counter_clockwise - deviation).abs() > 1e-3);
    let mut random = Random::new(3);
    let (plain, turned, _) = of_config("trunnion.yaml", random.vector(180.0));
    for axis in [0, 1] {
        let [a, b] = [&plain, &turned].map(|m| r_test(m, &centre, &[axis], 19).unwrap());
        assert_eq!(a.skipped, b.skipped);
        let readings = a.readings.iter().zip(&b.readings).map(|(a, b)| [a, b].map(|of| Vector3::from(of.reading_um)));
        let apart = readings.map(|[a, b]| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-7 && a.range_um[0] > 0.1, "{apart:e} um");
    }
    let read = |m: &Machine| -> Vec<f64> {
        diagonals(m, &rest(m), 8, false).into_iter().flat_map(|diagonal| diagonal.there_um).collect()
    };
    assert_eq!(read(&plain), read(&turned));
    let bodies = |machine: &Machine| -> Vec<f64> {
        let field = Bare { machine, order: Order::Exact };
        let all = body_diagonals(&field, &Approach::Mean.at_pose(&rest(machine)), 6);
        all.into_iter().flat_map(|diagonal| diagonal.deviations).collect()
    };
    assert_eq!(bodies(&plain), bodies(&turned));
}

fn numbers(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|k, _| value[k].as_f64().unwrap())
}

/// Two files of one machine, one with a rotation of the part.
fn files(folder: &Folder, name: &str, angles: [f64; 3]) -> ([PathBuf; 2], Matrix3<f64>) {
    let (plain, turned, r) = of_config(name, angles);
    let path = |sub: &str, text: &str| {
        std::fs::create_dir_all(folder.file(sub)).unwrap();
        folder.with(&format!("{sub}/machine.yaml"), text)
    };
    let paths = [path("plain", &text_of(&plain, [0.0; 3])), path("turned", &text_of(&turned, angles))];
    (paths, r)
}

#[test]
fn effects_of_errors_are_in_the_coordinates_of_the_part() {
    let folder = Folder::new("part-effects");
    let ([plain, turned], r) = files(&folder, "tt-bc.yaml", [30.0, -90.0, 10.0]);
    let at = |machine: &Path| {
        json(&[
            "eval",
            text(machine),
            "--at",
            "X=50,Y=30,Z=-40,B=-20,C=70",
            "--sensitivity",
            "--interactions",
            "--format",
            "json",
        ])
    };
    let (before, after) = (at(&plain), at(&turned));
    let (before, after) = (&before["poses"][0], &after["poses"][0]);
    for list in ["sensitivity", "interactions"] {
        let (before, after) = (before[list].as_array().unwrap(), after[list].as_array().unwrap());
        assert!(before.len() == after.len() && before.len() > 10);
        for (a, b) in before.iter().zip(after) {
            assert_eq!((&a["error"], &a["value"]), (&b["error"], &b["value"]));
            for key in ["deviation", "rotation"] {
                let (a, b) = (r.transpose() * numbers(&a[key]), numbers(&b[key]));
                assert!(near(&a, &b, 1e-9 * (1.0 + a.norm())), "{list}: {a} {b}");
            }
        }
    }
}

/// Every file below a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            let _ =
                found.insert(path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn compensation_does_not_depend_on_the_rotation_of_the_part() {
    let folder = Folder::new("part-compile");
    let ([plain, turned], _) = files(&folder, "trunnion.yaml", [-90.0, 15.0, 40.0]);
    let mut compiled = 0;
    for target in ["linuxcnc", "linuxcnc-kins", "grid-csv"] {
        let run = |machine: &Path, name: &str| {
            let out = folder.file(&format!("{name}-{target}"));
            let arguments = ["compile", text(machine), "--target", target, "--poses", "60", "--out", text(&out)];
            let output = crate::program::abbe_on(2, &arguments);
            output.status.success().then(|| contents(&out))
        };
        let (before, after) = (run(&plain, "plain"), run(&turned, "turned"));
        assert_eq!(before.is_some(), after.is_some(), "{target}");
        let (Some(before), Some(after)) = (before, after) else { continue };
        assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
        compiled += 1;
        for (name, bytes) in &before {
            if name == "abbe.lock.json" {
                // It names the hash of the machine file, which says where the part lies.
                let lines =
                    |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap().lines().map(str::to_owned).collect();
                let (a, b): (Vec<String>, Vec<String>) = (lines(bytes), lines(&after[name]));
                let apart: Vec<&String> = a.iter().zip(&b).filter(|(a, b)| a != b).map(|(a, _)| a).collect();
                assert!(a.len() == b.len() && matches!(apart[..], [line] if line.contains("sha256")), "{apart:?}");
            } else {
                assert!(*bytes == after[name], "{target}: {name} differs");
            }
        }
    }
    assert_eq!(compiled, 3, "every target takes the machine");
}

#[test]
fn budgets_do_not_depend_on_the_rotation_of_the_part() {
    let folder = Folder::new("part-budget");
    let ([plain, turned], _) = files(&folder, "ht-b-c.yaml", [12.0, -70.0, 95.0]);
    let of = |machine: &Path| {
        let arguments = ["budget", text(machine), "--class", "production", "--poses", "40", "--samples", "50"];
        abbe(&[&arguments[..], &["--format", "json"]].concat())
    };
    assert_eq!(of(&plain), of(&turned));
}

/// A file of tool poses, its coordinates turned.
type Form<'a> = &'a dyn Fn(&Matrix3<f64>) -> String;

#[test]
fn files_of_tool_poses_count_in_the_coordinates_of_the_part() {
    let folder = Folder::new("part-work");
    let angles = [-90.0, 0.0, 30.0];
    let ([plain, turned], r) = files(&folder, "trunnion.yaml", angles);
    let machine = with_part(&configs::machine("trunnion.yaml"), [0.0; 3]);
    let work: Vec<ToolPose> = random_poses(&machine, 12, 4).iter().map(|pose| tool_pose(&machine, pose)).collect();
    let csv = |turn: &Matrix3<f64>| {
        let row = |pose: &ToolPose| {
            let (p, d) = (turn * pose.tip, turn * pose.direction);
            format!("{},{},{},{},{},{}\n", p.x, p.y, p.z, d.x, d.y, d.z)
        };
        format!("X,Y,Z,I,J,K\n{}", work.iter().map(row).collect::<String>())
    };
    let apt = |turn: &Matrix3<f64>| {
        let row = |pose: &ToolPose| {
            let (p, d) = (turn * pose.tip, turn * pose.direction);
            format!("GOTO/{},{},{},{},{},{}\n", p.x, p.y, p.z, d.x, d.y, d.z)
        };
        format!("UNITS/MM\n{}", work.iter().map(row).collect::<String>())
    };
    // Without a tool axis it is that of the zero pose, whatever the part's coordinates are.
    let tips = |turn: &Matrix3<f64>| {
        let tips = (0..5).map(|i| turn * Vector3::new(f64::from(i), -5.0, 60.0));
        format!("X,Y,Z\n{}", tips.map(|p| format!("{},{},{}\n", p.x, p.y, p.z)).collect::<String>())
    };
    let forms: [(&str, Form<'_>); 3] = [("w.csv", &csv), ("w.cls", &apt), ("t.csv", &tips)];
    for (name, form) in forms {
        let mapped = |machine: &Path, turn: &Matrix3<f64>| -> Vec<Vec<f64>> {
            let (file, out) = (folder.with(name, &form(turn)), folder.file("map.csv"));
            // Rows drawn at random are no path, which CL data are by default.
            let single = ["map", text(machine), "--reference", "machine", "--path", "no", "--tool-poses", text(&file)];
            abbe(&[&single[..], &["--csv", text(&out)]].concat());
            let text = std::fs::read_to_string(&out).unwrap();
            let cells = |line: &str| line.trim_end_matches(',').split(',').map(|c| c.parse().unwrap()).collect();
            text.lines().skip(1).map(cells).collect()
        };
        let (before, after) = (mapped(&plain, &Matrix3::identity()), mapped(&turned, &r.transpose()));
        assert!(before.len() == after.len() && before.len() >= 5, "{name}");
        for (a, b) in before.iter().zip(&after) {
            assert!(a[..6].iter().zip(&b[..6]).all(|(a, b)| (a - b).abs() < 1e-6), "{name}: {a:?} {b:?}");
            let (d, e) = (Vector3::from_row_slice(&a[6..9]), Vector3::from_row_slice(&b[6..9]));
            assert!(near(&(r.transpose() * d), &e, 1e-5), "{name}: {a:?} {b:?}");
        }
    }
    let none = folder.with("far.csv", "X,Y,Z,I,J,K\n0,0,9000,0,0,1\n0,0,50,0,0,1\n");
    let output =
        crate::program::abbe_on(1, &["map", text(&turned), "--reference", "machine", "--tool-poses", text(&none)]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("W0608"), "{output:?}");
}

#[test]
fn a_rotation_is_written_shown_compared_and_replaced_whole() {
    let base = text_of(&configs::machine("trunnion.yaml"), [10.0, 0.0, -30.5]);
    assert!(base.contains("rotation: { A: 10 deg, C: -30.5 deg }"), "{base}");
    let machine = read(&[("m.yaml", &base)]).0.unwrap();
    assert_eq!(machine.workpiece_angles(), [10.0, 0.0, -30.5]);
    // A rotation of a variant replaces that of its base, letter by letter or not.
    let variant = "abbe: 1\nextends: m.yaml\nworkpiece: { rotation: { B: 0.5 rad } }\n";
    let turned = read(&[("v.yaml", variant), ("m.yaml", &base)]).0.unwrap();
    assert_eq!(turned.workpiece_angles(), [0.0, 0.5_f64.to_degrees(), 0.0]);
    assert_eq!(turned.workpiece(), machine.workpiece());
    assert_eq!(machine.differences(&turned), [MachineProperty::Workpiece]);
    let taken = machine.with_property_of(&turned, &MachineProperty::Workpiece).unwrap();
    assert_eq!(taken.workpiece_angles(), turned.workpiece_angles());
    // Whole turns are none.
    assert_eq!(with_part(&machine, [360.0, -720.0, 0.0]).workpiece_rotation(), None);
    let folder = Folder::new("part-shown");
    let (plain, path) = (folder.with("p.yaml", &text_of(&machine, [0.0; 3])), folder.with("m.yaml", &base));
    let shown = abbe(&["show", text(&path)]);
    assert!(shown.contains("workpiece rotation A 10 deg, C -30.5 deg"), "{shown}");
    assert!(!abbe(&["show", text(&plain)]).contains("workpiece rotation"));
    assert_eq!(json(&["show", text(&path), "--format", "json"])["workpiece_rotation_deg"][2], -30.5);
    let apart = abbe(&["diff", text(&plain), text(&path), "--poses", "20"]);
    assert!(apart.contains("rotation A 10 deg, C -30.5 deg"), "{apart}");
    let out = folder.file("converted.yaml");
    abbe(&["convert", text(&path), "--to", "errors_are: body", "--within", "1 nm", "--out", text(&out)]);
    assert!(std::fs::read_to_string(&out).unwrap().contains("rotation: { A: 10 deg, C: -30.5 deg }"));
}
