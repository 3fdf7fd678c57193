//! Readings of virtual instruments, as JSON: the same in `instrument` and on the page.

use super::positions::positions;
use crate::analysis::instrument::{BallBar, Diagonal, RTest};
use crate::machine::{Machine, Pose};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// A circle of a ball bar.
pub fn circle_json(b: &BallBar) -> Value {
    json!({
        "plane": b.plane, "circular_deviation_um": {"counter_clockwise": b.deviation[0], "clockwise": b.deviation[1]},
        "bidirectional_um": b.bidirectional, "mean_radial_um": b.mean,
        "radial_max_min_um": {"counter_clockwise": b.extremes[0], "clockwise": b.extremes[1]},
        "squareness_urad": b.squareness + 0.0, "scale_mismatch_um_per_m": b.scale_mismatch + 0.0,
        "angle_deg": b.angles, "counter_clockwise_um": b.readings[0], "clockwise_um": b.readings[1],
    })
}

/// An R-test of one axis.
pub fn turn_json(machine: &Machine, r: &RTest) -> Value {
    let reading = |((q, pose), d): ((&f64, &Pose), &Vector3<f64>)| {
        json!({"position_deg": q,
        "axes": positions(machine, pose), "reading_um": [d.x + 0.0, d.y + 0.0, d.z + 0.0]})
    };
    json!({
        "axis": r.name(machine), "range_um": r.range, "count": r.readings.len(),
            "skipped": r.skipped,
        "readings": r.positions.iter().zip(&r.poses).zip(&r.readings).map(reading).collect::<Vec<_>>(),
    })
}

/// A laser along one diagonal.
pub fn line_json(machine: &Machine, d: &Diagonal) -> Value {
    let names: Vec<&str> = d.axes.iter().map(|i| machine.axes()[*i].name.as_str()).collect();
    json!({
        "name": d.name, "axes": names, "e_d_um": d.systematic, "b_d_um": d.reversal, "by_axis_um": d.by_axis,
        "way_mm": d.ways, "there_um": d.there, "back_um": d.back,
    })
}
