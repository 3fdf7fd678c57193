//! The residual when a controller commands another pose than the requested one, by the rigid-body model.

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample};
use crate::oracle::matrix::{M4, V3, exp, minus, mul, norm, plus, twist};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Axis, Frame};

/// Position of the actual tip at a command, from the workpiece origin.
pub fn actual(sample: &Sample, command: &Pose, travel: Travel) -> V3 {
    let answer = sample.evaluate(command, travel, Frame::Workpiece);
    plus(answer.nominal, answer.deviation)
}

/// Position of the ideal tip at a pose.
pub fn ideal(sample: &Sample, pose: &Pose) -> V3 {
    sample.evaluate(pose, Travel::Mean, Frame::Workpiece).nominal
}

/// Actual position at a command minus ideal position at a pose, mm.
pub fn position(sample: &Sample, pose: &Pose, command: &Pose, travel: Travel) -> V3 {
    minus(actual(sample, command, travel), ideal(sample, pose))
}

/// Between the actual tool axis at a command and the ideal one at a pose, rad: two tools' tips show the axis.
pub fn tilt(sample: &Sample, pose: &Pose, command: &Pose, travel: Travel) -> f64 {
    const APART: f64 = 100.0;
    let mut longer = sample.clone();
    longer.rigid.offset[2] -= APART;
    let axes = [
        minus(actual(sample, command, travel), actual(&longer, command, travel)),
        minus(ideal(sample, pose), ideal(&longer, pose)),
    ];
    norm(minus(axes[0], axes[1])) / APART
}

/// Random poses over the travels, a turn of continuous axes.
pub fn poses(sample: &Sample, seed: u64, count: usize) -> Vec<Pose> {
    let mut random = Random::new(seed);
    let ends: Vec<[f64; 2]> = sample.axes.iter().map(|axis| axis.travel.unwrap_or([0.0, 360.0])).collect();
    (0..count).map(|_| ends.iter().map(|[low, high]| random.between(*low, *high)).collect()).collect()
}

/// A pose with corrections added.
pub fn corrected(pose: &Pose, correction: &[f64]) -> Pose {
    pose.iter().zip(correction).map(|(q, c)| q + c).collect()
}

/// The same machine without the errors that `keep` (joint by name, direction 0 to 5, location) refuses.
pub fn only(sample: &Sample, keep: impl Fn(&str, usize, bool) -> bool) -> Sample {
    let mut machine = sample.clone();
    for (axis, extra) in machine.rigid.walk.iter_mut().zip(&mut machine.axes) {
        for k in 0..6 {
            if !keep(&axis.name, k, true) {
                axis.location[k] = 0.0;
            }
            if !keep(&axis.name, k, false) {
                extra.errors[k] = None;
            }
        }
    }
    if let Some(spindle) = &mut machine.rigid.spindle {
        (0..6).filter(|k| !keep("S", *k, true)).for_each(|k| spindle[k] = 0.0);
    }
    machine
}

/// Returns the distance of an axis alone from a position along (mm) or about (rad) its own direction, when it is
/// commanded `position + trim`. Its angular errors turn about its origin, which stays where it is; its location does
/// not count.
pub fn along(sample: &Sample, index: usize, position: f64, trim: f64, travel: Travel) -> f64 {
    let axis = &sample.rigid.walk[index];
    let u = axis.direction.map(|c| c / norm(axis.direction));
    let dot = |v: V3| v[0] * u[0] + v[1] * u[1] + v[2] * u[2];
    let mut alone = only(sample, |_, _, _| false);
    alone.rigid.walk = vec![Axis { origin: [0.0; 3], location: [0.0; 6], ..axis.clone() }];
    alone.axes = vec![sample.axes[index].clone()];
    (alone.rigid.gauge, alone.rigid.offset, alone.rigid.workpiece_origin) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    (alone.rigid.tool_setup, alone.rigid.workpiece_setup) = ([0.0; 3], [0.0; 6]);
    alone.rigid.workpiece_rotation = [0.0; 3];
    let there = alone.evaluate(&vec![position + trim], travel, Frame::Workpiece);
    let here = alone.evaluate(&vec![position], travel, Frame::Workpiece);
    if !axis.rotary {
        return dot(minus(plus(there.nominal, there.deviation), here.nominal));
    }
    let direct = axis.workpiece && axis.direct.unwrap_or(sample.rigid.conventions.direct);
    let turned = if direct { -trim } else { trim }.to_radians();
    // First the trim about the axis, then the rotation that the errors make of it.
    let both = product(there.rotation, u.map(|c| c * turned));
    dot(skew(&both))
}

fn product(second: V3, first: V3) -> M4 {
    let rotation = |w: V3| exp(&twist([0.0, 0.0, 0.0, w[0], w[1], w[2]]));
    mul(&rotation(second), &rotation(first))
}

fn skew(m: &M4) -> V3 {
    [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]].map(|c| c / 2.0)
}
