//! The resolved machine as data for templates. Numbers arrive as text that reads back as the same
//! double; constants as plain decimals.

use super::data::{CurveData, Joint, Model, WORLD};
use super::{Carried, KinematicsMechanism};
use crate::machine::{Axis, Machine, Travel};
use crate::target::render::fixed;
use minijinja::{Value, context};

/// The shortest decimal number that is read as the same double; never `-0`.
fn exact(x: f64) -> String {
    format!("{:?}", x + 0.0)
}

fn list(numbers: &[f64]) -> Vec<String> {
    numbers.iter().map(|x| exact(*x)).collect()
}

/// What joint limits allow beyond the travel, mm or deg.
const MARGIN: f64 = 1.0;

/// What templates see besides the machine's name and the version.
pub fn context(machine: &Machine, carried: &Carried, mechanism: &KinematicsMechanism) -> Value {
    match carried {
        Carried::FullModel(model) => full_model(machine, model, mechanism),
        Carried::LinearMap(map) => constants(&map.matrix, mechanism, "none"),
        Carried::RotaryCentres(centres) => constants(&centres.lines, mechanism, ["a", "b"][centres.tilt.min(1)]),
    }
}

fn constants(values: &[f64], mechanism: &KinematicsMechanism, tilt: &str) -> Value {
    let text = |value: &f64| fixed(*value, mechanism.increment.correction_decimals);
    let all = mechanism.constants.iter().zip(values).map(|(name, value)| context! { name, value => text(value) });
    context! { constants => all.collect::<Vec<_>>(), tilt }
}

fn full_model(machine: &Machine, model: &Model, mechanism: &KinematicsMechanism) -> Value {
    let joints = model.joints.iter().zip(machine.axes()).map(|(joint, axis)| joint_context(joint, axis, mechanism));
    let mut start = 0;
    let curves = model.curves.iter().map(|curve| {
        let entry = curve_context(curve, start);
        start += curve.numbers.len();
        entry
    });
    let mut in_order: Vec<usize> = (0..model.joints.len()).collect();
    in_order.sort_by_key(|i| model.joints[*i].number);
    let place = |from: [f64; 3]| -> Vec<String> {
        (0..3).map(|i| fixed(model.workpiece[i] - from[i], mechanism.increment.position_decimals)).collect()
    };
    let decimals = |x: &f64| fixed(*x, mechanism.increment.position_decimals);
    context! {
        joints => joints.collect::<Vec<_>>(),
        joints_in_order => in_order,
        curves => curves.collect::<Vec<_>>(),
        carried_body => u8::from(model.carried_body),
        linearised => u8::from(model.linearised),
        gauge => list(&model.gauge),
        tool => list(&model.tool),
        tool_decimals => model.tool.iter().map(decimals).collect::<Vec<_>>(),
        tool_clamping => list(&model.tool_clamping),
        spindle => list(&model.spindle),
        workpiece => list(&model.workpiece),
        clamping => list(&model.clamping),
        damping => exact(model.damping),
        orientation => u8::from(model.orientation),
        // Where the program's zero must be for programs to count from the workpiece origin.
        program_zero => place(model.gauge),
    }
}

fn joint_context(joint: &Joint, axis: &Axis, mechanism: &KinematicsMechanism) -> Value {
    let (min, max) = match axis.travel {
        Travel::Range(min, max) => (min, max),
        // As far as a controller's position stays exact enough.
        Travel::Continuous => (-36_000.0, 36_000.0),
    };
    let curves = joint.curves.map(|pair| pair.map(|curve| curve.map_or(-1, |i| i as i64)).to_vec());
    let position = |x: f64| fixed(x, mechanism.increment.position_decimals);
    context! {
        name => axis.name.as_str(),
        letter => WORLD.get(joint.letter..=joint.letter),
        coordinate => joint.letter,
        joint => joint.number,
        rotary => u8::from(joint.rotary),
        solved => u8::from(joint.solved),
        workpiece_side => u8::from(joint.workpiece_side),
        outside => u8::from(joint.outside),
        inverted => u8::from(joint.inverted),
        location_inverted => u8::from(joint.location_inverted),
        direction => list(&joint.direction),
        origin => list(&joint.origin),
        location => list(&joint.location),
        curves => curves.to_vec(),
        continuous => axis.travel == Travel::Continuous,
        min => position(min),
        max => position(max),
        // Corrections may leave the travel by a little.
        limit_min => position(min - MARGIN),
        limit_max => position(max + MARGIN),
        home => position(0.0_f64.clamp(min, max)),
    }
}

fn curve_context(curve: &CurveData, start: usize) -> Value {
    let form = ["linear", "cubic", "polynomial", "harmonics"][curve.form as usize];
    context! {
        form,
        form_number => curve.form as usize,
        points => curve.numbers.len() / curve.form.width(),
        start,
        period => exact(curve.period),
        numbers => list(&curve.numbers),
    }
}
