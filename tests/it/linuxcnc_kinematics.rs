//! The closed forms of three kinematics modules of LinuxCNC against `nominal`, with each machine
//! written in the machine language.

use crate::oracle::matrix::{V3, elementary, minus, norm, plus, turn};
use crate::oracle::program::{DEFAULT, Folder, eval};
use crate::oracle::random::Random;

const TRIALS: usize = 8;
const POSES: usize = 40;

/// Positions of the linear axes in mm and of the others in deg.
fn joints(random: &mut Random, linear: usize, rotary: usize) -> Vec<f64> {
    let lengths: Vec<_> = (0..linear).map(|_| random.around(500.0)).collect();
    lengths.into_iter().chain((0..rotary).map(|_| random.around(360.0))).collect()
}

/// Compares the module's forward kinematics with the program at random positions.
fn agrees(yaml: &str, names: &[&str], poses: &[Vec<f64>], forward: impl Fn(&[f64]) -> V3) {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", yaml);
    for (pose, answer) in poses.iter().zip(eval(&machine, names, poses, DEFAULT)) {
        let expected = forward(pose);
        let gap = norm(minus(expected, answer.nominal));
        // Rounding of some metres over five matrices; found 6e-13.
        assert!(gap < 5e-12, "{gap:e} mm at {pose:?}: {expected:?}, {:?}\n{yaml}", answer.nominal);
    }
}

fn axes(names: &[&str], rotary: &str) -> String {
    let linear: String = names.iter().map(|name| format!("  {name}: {{ travel: [-500 mm, 500 mm] }}\n")).collect();
    format!("axes:\n{linear}{rotary}")
}

/// A table-table module: a swivel about `tilt` (0 = A, 1 = B) carries the table C; `offset` is from the
/// rotation point to the swivel.
fn trt(random: &mut Random, chain: &str, tilt: usize) {
    let rotation_point = random.vector(200.0);
    let tool = random.between(0.0, 150.0);
    let mut offset = [random.around(100.0), random.around(100.0), random.around(100.0) + tool];
    offset[tilt] = 0.0;
    let name = ["A", "B"][tilt];
    // The table turns right-handed with positive A, B and C, which is not ISO's sense for tables.
    let rotary = format!(
        "  {name}: {{ travel: [-360 deg, 360 deg], sense: direct, origin: {:?} }}\n  \
         C: {{ travel: continuous, sense: direct, origin: {rotation_point:?} }}\n",
        plus(rotation_point, offset)
    );
    // With all angles zero the joints are the position of the tip, whatever the tool's length.
    let yaml = format!(
        "abbe: 1\nmachine: trt\nchain: \"{chain}\"\n{}tool: {{ gauge: [0, 0, {tool}], length: {tool} mm }}\n",
        axes(&["X", "Y", "Z"], &rotary)
    );
    let forward = |q: &[f64]| {
        let (swivel, table) = (elementary(tilt, -q[3].to_radians()), elementary(2, -q[4].to_radians()));
        let from_swivel = minus(minus([q[0], q[1], q[2]], offset), rotation_point);
        plus(rotation_point, turn(&table, plus(offset, turn(&swivel, from_swivel))))
    };
    let poses: Vec<_> = (0..POSES).map(|_| joints(random, 3, 2)).collect();
    agrees(&yaml, &["X", "Y", "Z", name, "C"], &poses, forward);
}

#[test]
fn xyzac_trt() {
    let mut random = Random::new(21);
    for chain in ["w C' A' b X Y Z t", "w C' A' Y' b X Z t", "w C' A' Z' X' Y' b t"] {
        (0..TRIALS).for_each(|_| trt(&mut random, chain, 0));
    }
}

#[test]
fn xyzbc_trt() {
    let mut random = Random::new(22);
    for chain in ["w C' B' b X Y Z t", "w C' B' X' b Y Z t"] {
        (0..TRIALS).for_each(|_| trt(&mut random, chain, 1));
    }
}

/// A fork head: C, then B turning left-handed about Y, then W along the tool.
#[test]
fn five_axis_head() {
    let mut random = Random::new(23);
    for trial in 0..TRIALS {
        let pivot = if trial == 0 { 250.0 } else { random.between(50.0, 500.0) };
        let rotary = format!(
            "  B: {{ travel: [-360 deg, 360 deg], direction: [0, -1, 0], origin: [0, 0, {pivot}] }}\n  \
             C: {{ travel: continuous, origin: [0, 0, {pivot}] }}\n  W: {{ travel: [-500 mm, 500 mm], direction: [0, 0, -1] }}\n"
        );
        let yaml = format!("abbe: 1\nmachine: head\nchain: \"w b X Y Z C B W t\"\n{}", axes(&["X", "Y", "Z"], &rotary));
        let forward = |q: &[f64]| {
            let arm = turn(&elementary(1, -q[4].to_radians()), [0.0, 0.0, -(pivot + q[3])]);
            plus([q[0], q[1], q[2] + pivot], turn(&elementary(2, q[5].to_radians()), arm))
        };
        let poses: Vec<_> = (0..POSES).map(|_| joints(&mut random, 4, 2)).collect();
        agrees(&yaml, &["X", "Y", "Z", "W", "B", "C"], &poses, forward);
    }
}

/// The signs as they were measured at the controller, apart from any closed form.
#[test]
fn measured_signs() {
    let head = "abbe: 1\nmachine: head\nchain: \"w b X Y Z C B W t\"\naxes:\n  X: { travel: [-9 mm, 9 mm], origin: [0, 0, 0] }\n  Y: { travel: [-9 mm, 9 mm], origin: [0, 0, 0] }\n  \
                Z: { travel: [-9 mm, 9 mm], origin: [0, 0, 0] }\n  B: { travel: [-99 deg, 99 deg], direction: [0, -1, 0], origin: [0, 0, 100] }\n  \
                C: { travel: continuous }\n  W: { travel: [-9 mm, 9 mm], direction: [0, 0, -1] }\n";
    agrees(head, &["B"], &[vec![90.0]], |_| [100.0, 0.0, 100.0]);
    let table = "abbe: 1\nmachine: table\nchain: \"w C' A' b X Y Z t\"\nconventions: { workpiece_axes: direct }\naxes:\n  \
                 X: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n  Z: { travel: [0 mm, 100 mm], origin: [0, 0, 0] }\n  \
                 A: { travel: [-99 deg, 99 deg] }\n  C: { travel: continuous }\n";
    agrees(table, &["Y", "A"], &[vec![100.0, 90.0]], |_| [0.0, 0.0, -100.0]);
    agrees(table, &["X", "C"], &[vec![100.0, 90.0]], |_| [0.0, -100.0, 0.0]);
}
