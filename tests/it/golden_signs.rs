//! The golden signs: one error, one position, the deviation by hand; on both sides of the bed.

use crate::oracle::matrix::{V3, minus, norm};
use crate::oracle::program::{Ask, DEFAULT, Folder, eval};
use crate::oracle::rigid::Frame;

/// A three-axis machine with a tool and a workpiece whose places must not matter.
fn three_axis(chain: &str, error: &str) -> String {
    format!(
        "abbe: 1\nmachine: signs\nchain: \"{chain}\"\naxes:\n  X: {{ travel: [0 mm, 600 mm] }}\n  Y: {{ travel: [0 mm, 600 mm] }}\n  \
         Z: {{ travel: [0 mm, 600 mm] }}\ntool: {{ gauge: [250, 225, 0], length: 120 mm }}\nworkpiece: {{ origin: [30, 20, -380] }}\n\
         errors:\n  {error}\n"
    )
}

/// A machine with a rotary axis whose centre is not in the machine zero.
fn with_c(chain: &str) -> String {
    three_axis(chain, "EX0C: 10 um").replace("axes:\n", "axes:\n  C: { travel: continuous, origin: [100, 50, -300] }\n")
}

fn holds(yaml: &str, axis: &str, position: f64, ask: Ask, expected_um: V3) {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", yaml);
    let found = eval(&machine, &[axis], &[vec![position]], ask)[0].deviation.map(|c| c * 1000.0);
    // The rounding of a position of 500 mm is 1.1e-10 um; found 9.7e-11.
    assert!(norm(minus(found, expected_um)) < 5e-10, "{found:?} is not {expected_um:?} um\n{yaml}");
}

/// The axis in question on the tool side, on the workpiece side next to the bed, and next to the workpiece.
const SIDES: [&str; 4] = ["w b X Y Z t", "w b Z Y X t", "w X' Y' Z' b t", "w Z' Y' X' b t"];

/// The same deviation on both sides of the bed: first order, and exactly with the cosine that belongs to it.
fn both_sides(error: &str, axis: &str, position: f64, first_um: V3, cosine_um: V3) {
    for chain in SIDES {
        let yaml = three_axis(chain, error);
        let exact = std::array::from_fn(|i| first_um[i] + cosine_um[i]);
        holds(&yaml, axis, position, DEFAULT, exact);
        holds(&yaml, axis, position, Ask { order: Some("1"), ..DEFAULT }, first_um);
        holds(&yaml, axis, position, Ask { frame: Frame::Machine, ..DEFAULT }, exact);
    }
}

#[test]
fn positioning_error() {
    both_sides("EXX: 10 um", "X", 100.0, [10.0, 0.0, 0.0], [0.0; 3]);
}

#[test]
fn squareness_of_x_and_y() {
    // 500 mm turned by 10 urad; 500 (1 - cos) is 2.5e-5 um.
    both_sides("EC0Y: 10 urad", "Y", 500.0, [-5.0, 0.0, 0.0], [0.0, -2.5e-5, 0.0]);
}

#[test]
fn squareness_of_x_and_z() {
    both_sides("EB0Z: 10 urad", "Z", 300.0, [3.0, 0.0, 0.0], [0.0, 0.0, -1.5e-5]);
}

#[test]
fn squareness_of_y_and_z() {
    both_sides("EA0Z: 10 urad", "Z", 300.0, [0.0, -3.0, 0.0], [0.0, 0.0, -1.5e-5]);
}

/// The centre lies 10 um in +X: the whole turn about it is displaced, R(q) turning the point by +q.
#[test]
fn eccentric_rotary_axis() {
    let table = "w C' b X Y Z t";
    let head = "w b X Y Z C t";
    let frames = |frame| Ask { frame, ..DEFAULT };
    for chain in [table, head, "w X' C' b Y Z t", "w b X C Y Z t"] {
        let yaml = with_c(chain);
        holds(&yaml, "C", 0.0, DEFAULT, [0.0; 3]);
        holds(&yaml, "C", 180.0, DEFAULT, [20.0, 0.0, 0.0]);
        holds(&yaml, "C", 90.0, DEFAULT, [10.0, -10.0, 0.0]);
    }
    // A table has turned by -180 deg in the machine; before a head nothing has turned.
    holds(&with_c(table), "C", 180.0, frames(Frame::Machine), [-20.0, 0.0, 0.0]);
    holds(&with_c(head), "C", 180.0, frames(Frame::Machine), [20.0, 0.0, 0.0]);
    holds(&with_c(table), "C", 90.0, frames(Frame::Machine), [-10.0, -10.0, 0.0]);
    holds(&with_c(head), "C", 90.0, frames(Frame::Machine), [10.0, -10.0, 0.0]);
    // The tool of both has turned by +180 or +90 deg against the workpiece.
    for chain in [table, head] {
        holds(&with_c(chain), "C", 180.0, frames(Frame::Tool), [-20.0, 0.0, 0.0]);
        holds(&with_c(chain), "C", 90.0, frames(Frame::Tool), [-10.0, -10.0, 0.0]);
    }
}
