//! Inverse kinematics of robots against Pinocchio (tests/oracles/arms.py) and the closed form of the UR5.

use crate::configs::machine;
use crate::program::{Folder, abbe, json, text};
use abbe::analysis::{ToolPose, branches, inverse, rest, tool_pose};
use abbe::evaluate::random_poses;
use abbe::machine::Machine;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::Path;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Output of Pinocchio.
fn oracle() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracles/arms.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A machine file of six rotary axes by their lines.
fn by_lines(name: &str, arm: &Value) -> String {
    let vector = |v: &Value| format!("{:?}", numbers(v));
    let axis = |(i, axis): (usize, &Value)| {
        let (w, o) = (vector(&axis[0]), vector(&axis[1]));
        format!("J{}: {{ kind: rotary, direction: {w}, origin: {o}, travel: [-200 deg, 200 deg] }}", i + 1)
    };
    let axes: Vec<String> = arm["axes"].as_array().unwrap().iter().enumerate().map(axis).collect();
    let tip = vector(&arm["tip"]);
    format!(
        "abbe: 1\nmachine: {name}\nchain: w b J1 J2 J3 J4 J5 J6 t\naxes: {{ {} }}\ntool: {{ gauge: {tip}, length: 0 }}\n\
         workpiece: {{ origin: [0, 0, 0] }}\n",
        axes.join(", ")
    )
}

/// Direction and spin of a rotation, by Rodrigues' formula for the shortest turn.
fn aim(rotation: &Matrix3<f64>) -> (Vector3<f64>, f64) {
    let d = rotation.column(2).into_owned();
    let v = Vector3::z().cross(&d);
    let hat = v.cross_matrix();
    let shortest = Matrix3::identity() + hat + hat * hat / (1.0 + d.z);
    let spin = shortest.transpose() * rotation;
    (d, libm::atan2(spin[(1, 0)], spin[(0, 0)]))
}

/// Largest difference of positions, whole turns aside, deg.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| libm::remainder(a - b, 360.0).abs()).fold(0.0, f64::max)
}

fn target(pose: &Value) -> ToolPose {
    let rows: Vec<Vec<f64>> = pose["rotation"].as_array().unwrap().iter().map(numbers).collect();
    let (direction, spin) = aim(&Matrix3::from_fn(|i, j| rows[i][j]));
    ToolPose { spin_rad: Some(spin), ..ToolPose::new(Vector3::from_vec(numbers(&pose["tip"])), direction) }
}

#[test]
fn all_branches_are_those_that_pinocchio_finds() {
    for (name, arm) in oracle().as_object().unwrap() {
        let machine: Machine = if name == "ur5" {
            machine("robots/ur5.yaml")
        } else {
            let file = abbe::loads(&by_lines(name, arm), &abbe::LoadOptions::default(), abbe::Run::default());
            (*file.unwrap_or_else(|refusal| panic!("{name}: {refusal:?}")).value).clone()
        };
        let at_rest = rest(&machine);
        for pose in arm["poses"].as_array().unwrap() {
            let target = target(pose);
            let found = branches(&machine, &target, &at_rest);
            let drawn = numbers(&pose["drawn"]);
            assert!(found.iter().any(|q| apart(q, &drawn) < 1e-6), "{name}: {found:?} without {drawn:?}");
            let theirs: Vec<Vec<f64>> = pose["branches"].as_array().unwrap().iter().map(numbers).collect();
            for q in &theirs {
                assert!(found.iter().any(|ours| apart(ours, q) < 1e-5), "{name}: {found:?} without {q:?}");
            }
            assert_eq!(found.len(), theirs.len(), "{name}: {found:?} {theirs:?}");
            for q in &found {
                let at = tool_pose(&machine, q);
                assert!((at.tip - target.tip).norm() < 1e-9 && (at.direction - target.direction).norm() < 1e-12);
                assert!(machine.beyond_travel(q).next().is_none());
            }
            // Nearest first.
            let far = |q: &Vec<f64>| q.iter().map(|x| x * x).sum::<f64>();
            assert!(found.windows(2).all(|pair| far(&pair[0]) <= far(&pair[1]) + 1e-6), "{name}");
        }
    }
}

/// Denavit-Hartenberg table of the UR5, mm.
const D: [f64; 6] = [89.159, 0.0, 0.0, 109.15, 94.65, 82.3];
const A: [f64; 6] = [0.0, -425.0, -392.25, 0.0, 0.0, 0.0];

/// Rotation and translation of a row of the table.
fn row(i: usize, q: f64) -> (Matrix3<f64>, Vector3<f64>) {
    let alpha = [1.0, 0.0, 0.0, 1.0, -1.0, 0.0][i];
    let (s, c) = (libm::sin(q), libm::cos(q));
    let (sa, ca) = (alpha, if alpha == 0.0 { 1.0 } else { 0.0 });
    let r = Matrix3::new(c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca);
    (r, Vector3::new(A[i] * c, A[i] * s, D[i]))
}

fn flange(q: &[f64; 6]) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut r, mut p) = (Matrix3::identity(), Vector3::zeros());
    for (i, q) in q.iter().enumerate() {
        let (ri, pi) = row(i, *q);
        (r, p) = (r * ri, r * pi + p);
    }
    (r, p)
}

/// The closed form of the UR5: shoulder, wrist and elbow have two ways each.
fn closed_form(r: &Matrix3<f64>, p: &Vector3<f64>) -> Vec<[f64; 6]> {
    use std::f64::consts::PI;
    let mut found = Vec::new();
    let wrist = p - r.column(2) * D[5];
    let shoulder = libm::asin(D[3] / libm::hypot(wrist.x, wrist.y));
    let towards = libm::atan2(wrist.y, wrist.x);
    for q1 in [towards + shoulder, towards + PI - shoulder] {
        let n = Vector3::new(libm::sin(q1), -libm::cos(q1), 0.0);
        let cosine = (p.dot(&n) - D[3]) / D[5];
        for q5 in [libm::acos(cosine), -libm::acos(cosine)] {
            let s5 = libm::sin(q5);
            let q6 = libm::atan2(-r.column(1).dot(&n) / s5, r.column(0).dot(&n) / s5);
            // What the three parallel axes have to do.
            let ((r1, p1), (r5, p5), (r6, p6)) = (row(0, q1), row(4, q5), row(5, q6));
            let (outer_r, outer_p) = (r5 * r6, r5 * p6 + p5);
            let middle_r = r1.transpose() * r * outer_r.transpose();
            let middle_p = r1.transpose() * (p - p1) - middle_r * outer_p;
            let elbow = middle_p - middle_r.column(1) * D[3];
            let sum = libm::atan2(middle_r[(1, 0)], middle_r[(0, 0)]);
            let bend = (elbow.x * elbow.x + elbow.y * elbow.y - A[1] * A[1] - A[2] * A[2]) / (2.0 * A[1] * A[2]);
            if bend.abs() > 1.0 {
                continue;
            }
            for q3 in [libm::acos(bend), -libm::acos(bend)] {
                let q2 = libm::atan2(elbow.y, elbow.x) - libm::atan2(A[2] * libm::sin(q3), A[1] + A[2] * libm::cos(q3));
                found.push([q1, q2, q3, sum - q2 - q3, q5, q6]);
            }
        }
    }
    found
}

#[test]
fn the_branches_of_the_ur5_are_its_closed_form() {
    let machine = machine("robots/ur5.yaml");
    let home = flange(&[0.0; 6]);
    let mut eight = 0;
    for pose in random_poses(&machine, 60, 4) {
        let q: [f64; 6] = std::array::from_fn(|i| pose[i].to_radians());
        let (r, p) = flange(&q);
        let (direction, spin) = aim(&(r * home.0.transpose()));
        let tip = p + r * Vector3::new(0.0, 0.09, 31.0);
        let target = ToolPose { spin_rad: Some(spin), ..ToolPose::new(tip, direction) };
        let found = branches(&machine, &target, &rest(&machine));
        let theirs = closed_form(&r, &p);
        for solution in &theirs {
            let (back_r, back_p) = flange(solution);
            assert!((back_r - r).norm() < 1e-9 && (back_p - p).norm() < 1e-6, "the closed form itself");
            let degrees = solution.map(f64::to_degrees);
            assert!(found.iter().any(|q| apart(q, &degrees) < 1e-6), "{found:?} without {degrees:?}");
        }
        assert_eq!(found.len(), theirs.len(), "{pose:?}");
        eight += usize::from(theirs.len() == 8);
    }
    assert!(eight > 40, "{eight}");
}

#[test]
fn a_robot_reaches_what_it_reaches_itself() {
    let result = json(&["compare", "robots/ur5.yaml", "robots/ur5.yaml", "--poses", "60", "--format", "json"]);
    assert_eq!((number(&result["asked"]), number(&result["poses"])), (60.0, 60.0));
    assert_eq!(number(&result["machines"][1]["unreachable"]["total"]), 0.0);
}

#[test]
fn a_free_spin_is_the_nearest_and_a_given_one_is_held() {
    let machine = machine("robots/ur5.yaml");
    for pose in random_poses(&machine, 12, 9) {
        let target = tool_pose(&machine, &pose);
        let far = |q: &[f64]| q.iter().zip(&pose).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        // From beside the pose: no spin and no branch is nearer than the pose itself.
        let beside: Vec<f64> = pose.iter().map(|q| q + 0.05).collect();
        let found = inverse(&machine, &target, &beside).unwrap();
        let to = |q: &[f64]| q.iter().zip(&beside).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        assert!(to(&found) <= to(&pose) + 1e-6 && far(&found) < 0.2, "{found:?} {pose:?}");
        let at = tool_pose(&machine, &found);
        assert!((at.tip - target.tip).norm() < 1e-9 && (at.direction - target.direction).norm() < 1e-12);
    }
}

#[test]
fn a_column_gives_the_spin() {
    let folder = Folder::new("robots-spin");
    let poses = folder.with("poses.csv", "J1,J2,J3,J4,J5,J6\n10,-60,80,-40,70,5\n20,-70,90,-50,80,-10\n");
    let answers = json(&["eval", "robots/ur5.yaml", "--poses", text(&poses), "--format", "json"]);
    let machine = machine("robots/ur5.yaml");
    let home = flange(&[0.0; 6]).0;
    let mut rows = "X,Y,Z,I,J,K,Spin [deg]\n".to_owned();
    for (answer, q) in answers["poses"]
        .as_array()
        .unwrap()
        .iter()
        .zip([[10.0_f64, -60.0, 80.0, -40.0, 70.0, 5.0], [20.0, -70.0, 90.0, -50.0, 80.0, -10.0]])
    {
        let (r, _) = flange(&q.map(f64::to_radians));
        let (d, spin) = aim(&(r * home.transpose()));
        let tip = numbers(&answer["nominal"]);
        rows += &format!("{},{},{},{},{},{},{}\n", tip[0], tip[1], tip[2], d.x, d.y, d.z, spin.to_degrees());
    }
    let file = folder.with("work.csv", &rows);
    let out = folder.file("map.csv");
    abbe(&["map", "robots/ur5.yaml", "--reference", "machine", "--tool-poses", text(&file), "--csv", text(&out)]);
    let csv = std::fs::read_to_string(&out).unwrap();
    for line in csv.lines().skip(1) {
        let q: [f64; 6] = std::array::from_fn(|i| line.split(',').nth(i + 1).unwrap().parse::<f64>().unwrap());
        // The attitude is held, whichever branch was taken.
        let (r, _) = flange(&q.map(f64::to_radians));
        let (_, spin) = aim(&(r * home.transpose()));
        let asked: f64 = rows
            .lines()
            .nth(line.split(',').next().unwrap().parse::<usize>().unwrap() - 1)
            .unwrap()
            .split(',')
            .nth(6)
            .unwrap()
            .parse()
            .unwrap();
        assert!(libm::remainder(spin.to_degrees() - asked, 360.0).abs() < 1e-9, "{line}");
    }
    assert_eq!((csv.lines().count(), machine.axes().len()), (3, 6));
}

/// A SCARA arm with a slide: three parallel rotary axes and Z.
const SCARA: &str = "abbe: 1\nmachine: Scara\nchain: w b J1 J2 Z J4 t\naxes: { J1: { kind: rotary, direction: [0, 0, 1], \
                     travel: [-130 deg, 130 deg] }, J2: { kind: rotary, direction: [0, 0, 1], origin: [300, 0, 0], travel: \
                     [-145 deg, 145 deg] }, Z: { travel: [-200, 0], origin: [0, 0, 0] }, J4: { kind: rotary, direction: \
                     [0, 0, 1], origin: [550, 0, 0], travel: [-180 deg, 180 deg] } }\ntool: { gauge: [550, 0, 0], length: 0 }\n";

#[test]
fn chains_without_closed_form_follow_with_little_motion() {
    let file = abbe::loads(SCARA, &abbe::LoadOptions::default(), abbe::Run::default()).unwrap();
    let machine: &Machine = &file;
    // Along a line the elbow keeps its side.
    let mut before = vec![10.0, 60.0, -50.0, 0.0];
    let start = tool_pose(machine, &before).tip;
    for k in 0..40 {
        let tip = start + Vector3::new(-2.0, 3.0, 1.0) * f64::from(k);
        let found = inverse(machine, &ToolPose::new(tip, Vector3::z()), &before).unwrap();
        assert!((tool_pose(machine, &found).tip - tip).norm() < 1e-9 && machine.beyond_travel(&found).next().is_none());
        // Law of cosines at the elbow.
        let square = tip.x * tip.x + tip.y * tip.y;
        let bend = libm::acos((square - 300.0_f64.powi(2) - 250.0_f64.powi(2)) / (2.0 * 300.0 * 250.0)).to_degrees();
        assert!((found[1] - bend).abs() < 1e-7 && found[3].abs() < 1e-9, "{found:?}");
        before = found;
    }
    let beyond = inverse(machine, &ToolPose::new(Vector3::new(0.0, 600.0, 0.0), Vector3::z()), &before);
    assert!(beyond.is_err());
}
