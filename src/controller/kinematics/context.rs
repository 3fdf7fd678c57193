//! The resolved machine as data for templates. Numbers arrive as text that reads back as the same
//! double; constants as plain decimals.

use super::KinematicsModule;
use super::data::{CurveData, ModuleJoint, ModuleModel, ModuleWords, WORLD};
use super::parameters::WrittenParameter;
use super::transformation::Transformation;
use crate::compensation::KinematicsMechanism;
use crate::controller::emit::{decimal_text, exact};
use crate::machine::{Axis, AxisKind, Branch, Grid, Machine, Travel};
use crate::units::{Interval, significant};
use minijinja::{Value, context};

fn list(numbers: &[f64]) -> Vec<String> {
    numbers.iter().map(|x| exact(*x)).collect()
}

/// Distance by which joint limits exceed the travel, mm or deg.
const MARGIN: f64 = 1.0;

/// Returns the variables of templates besides the machine's name and the version.
pub fn context(machine: &Machine, carried: &KinematicsModule, mechanism: &KinematicsMechanism) -> Value {
    match carried {
        KinematicsModule::FullModel(model) => full_model(machine, model, mechanism),
        KinematicsModule::LinearMap(map) => constants(&map.matrix, mechanism),
        KinematicsModule::KinematicParameters(parameters) => {
            let one = |p: WrittenParameter| context! { name => p.name, value => p.value, before => p.before };
            let constants: Vec<Value> = parameters.texts().into_iter().map(one).collect();
            context! { constants, ..chain(machine, parameters.transformation()) }
        }
    }
}

/// Both branches of the nominal chain, each from the bed outwards, and the names of the axes in the order of the
/// transformation.
fn chain(machine: &Machine, transformation: &Transformation) -> Value {
    let all = machine.axes();
    let moved = |axis: &Axis, k: usize| {
        let carried = if axis.branch == Branch::Workpiece { -1.0 } else { 1.0 };
        decimal_text(axis.direction[k] * axis.sign() * carried, 0)
    };
    let one = |axis: &Axis| {
        let direction: Vec<String> = (0..3).map(|k| moved(axis, k)).collect();
        context! { name => axis.name.as_str(), rotary => axis.kind == AxisKind::Rotary, direction }
    };
    let of = |branch: Branch| move |axis: &&Axis| axis.branch == branch;
    let tool: Vec<Value> = all.iter().filter(of(Branch::Tool)).map(one).collect();
    let workpiece: Vec<Value> = all.iter().rev().filter(of(Branch::Workpiece)).map(one).collect();
    let name = |axis: usize| all[axis].name.to_string();
    let rotary = transformation.head.iter().chain(transformation.table.iter().rev());
    context! {
        branches => context! { tool, workpiece },
        linear_axes => transformation.linear.map(name).to_vec(),
        rotary_axes => rotary.map(|line| name(line.axis)).collect::<Vec<_>>(),
    }
}

fn constants(values: &[f64], mechanism: &KinematicsMechanism) -> Value {
    let text = |value: &f64| decimal_text(*value, mechanism.increment.correction_decimals);
    let all = mechanism.constants.iter().zip(values).map(|(name, value)| context! { name, value => text(value) });
    context! { constants => all.collect::<Vec<_>>() }
}

fn full_model(machine: &Machine, model: &ModuleModel, mechanism: &KinematicsMechanism) -> Value {
    let axes = machine.axes().iter().zip(machine.volume());
    let joints = model
        .joints
        .iter()
        .zip(axes)
        .map(|(joint, (axis, volume))| joint_context(model.words, joint, axis, volume, mechanism));
    let mut start = 0;
    let curves = model.curves.iter().map(|curve| {
        let entry = curve_context(curve, start);
        start += curve.numbers.len();
        entry
    });
    let mut in_order: Vec<usize> = (0..model.joints.len()).collect();
    in_order.sort_by_key(|i| model.joints[*i].number);
    let decimals = |x: &f64| decimal_text(*x, mechanism.increment.position_decimals);
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
        words => model.words as usize,
        coordinates => coordinates(machine, model),
        damping => exact(model.damping),
        pole_zone_deg => significant(libm::asin(model.damping).to_degrees(), 3),
        arm => exact(model.arm),
        orientation => u8::from(model.orientation),
        // Position of the program's zero for programs to count from the workpiece origin.
        program_zero => (0..3).map(|k| decimals(&program_zero(model, k))).collect::<Vec<_>>(),
    }
}

/// The letters of the program's words, with the joint that each of them moves.
fn coordinates(machine: &Machine, model: &ModuleModel) -> Vec<Value> {
    let held = match model.words {
        ModuleWords::Tip => "XYZ",
        ModuleWords::Pose => "XYZABC",
        ModuleWords::Axes => "",
    };
    let coordinate = |(index, letter): (usize, char)| {
        let own = model.joints.iter().position(|joint| joint.letter == Some(index));
        let name = match own {
            Some(axis) => machine.axes()[axis].name.as_str().to_owned(),
            None if !held.contains(letter) => return None,
            None if index < 3 => "tip of the tool".to_owned(),
            None => ["roll", "pitch", "yaw"][index - 3].to_owned(),
        };
        let rotary = own.map_or((3..6).contains(&index), |axis| model.joints[axis].rotary);
        Some(context! { letter => letter.to_string(), name, rotary => u8::from(rotary) })
    };
    WORLD.chars().enumerate().filter_map(coordinate).collect()
}

/// Returns the program's zero in machine coordinates: the workpiece origin, where a word is a position of the tip.
fn program_zero(model: &ModuleModel, k: usize) -> f64 {
    let along = |joint: &ModuleJoint| joint.letter == Some(k) && !joint.rotary && joint.direction[k] > 0.5;
    let placed = model.words != ModuleWords::Axes || model.joints.iter().any(along);
    if placed { model.workpiece[k] - model.gauge[k] } else { 0.0 }
}

/// Returns the position of a joint after homing: 0, or the middle of the volume where 0 may be a singular pose.
fn home(words: ModuleWords, volume: &Grid, travel: Interval) -> f64 {
    let middle = 0.5 * (volume.min + volume.max);
    (if words == ModuleWords::Pose { middle } else { 0.0 }).clamp(travel.min, travel.max)
}

fn joint_context(
    words: ModuleWords,
    joint: &ModuleJoint,
    axis: &Axis,
    volume: &Grid,
    mechanism: &KinematicsMechanism,
) -> Value {
    let travel = match axis.travel {
        Travel::Range(min, max) => Interval::new(min, max),
        // The range in which a controller's position stays exact enough.
        Travel::Continuous => Interval::new(-36_000.0, 36_000.0),
    };
    let curves = joint.curves.map(|pair| pair.map(|curve| curve.map_or(-1, |i| i as i64)).to_vec());
    let position = |x: f64| decimal_text(x, mechanism.increment.position_decimals);
    context! {
        name => axis.name.as_str(),
        coordinate => joint.letter.map_or(-1, |letter| letter as i64),
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
        min => position(travel.min),
        max => position(travel.max),
        // Corrections may leave the travel by a little.
        limit_min => position(travel.min - MARGIN),
        limit_max => position(travel.max + MARGIN),
        home => position(home(words, volume, travel)),
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
