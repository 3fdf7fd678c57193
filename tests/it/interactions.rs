//! Sensitivities and interactions: read off the algebra, they are the structured form's numbers, the derivatives of the
//! exact model, and a bound on the terms that order 1 neglects.

use crate::configs;
use abbe::algebra::Dual;
use abbe::analysis::interactions;
use abbe::evaluate::{Frame, Order, evaluate, random_poses, response};
use abbe::lower::{AxisErrorValues, ErrorLift, ErrorValues, Source, sensitivities};
use abbe::machine::{Approach, ErrorId, LocationOrder, Machine};
use nalgebra::Vector3;
use serde_json::Value;
use std::process::Command;

/// Every error is of first order, also where the conventions count it in the real part.
struct FirstOrder;

impl ErrorLift<Dual<2>> for FirstOrder {
    fn lift(&self, _: Source, value: f64) -> Dual<2> {
        Dual::first_order(value)
    }

    fn real(&self, source: Source, value: f64) -> Dual<2> {
        self.lift(source, value)
    }
}

/// Displacement and rotation by a unit of one error: the first degree of the whole model over the dual numbers.
pub fn unit_response(machine: &Machine, pose: &[f64], error: &ErrorId) -> [Vector3<f64>; 2] {
    let axes = vec![AxisErrorValues { location: [0.0; 6], component: [0.0; 6] }; machine.axes().len()];
    let mut values = ErrorValues { axes, spindle: None, tool: [0.0; 3], workpiece: [0.0; 6] };
    let place = match machine.axis_index(error.axis.as_str()) {
        Some(i) if error.is_location() => &mut values.axes[i].location,
        Some(i) => &mut values.axes[i].component,
        None => values.spindle.insert([0.0; 6]),
    };
    place[error.direction.index()] = 1.0;
    let response = response(machine, pose, &values, &FirstOrder);
    // Responses are in the coordinates of the part, sensitivities are not.
    let turned = machine.workpiece_rotation().unwrap_or_else(nalgebra::Matrix3::identity);
    [response.position, response.rotation].map(|v| turned * v.map(|x| x.0[1]))
}

#[test]
fn the_first_degree_is_the_structured_form() {
    for (name, machine) in configs::all() {
        if machine.conventions().location_order == LocationOrder::Real {
            continue;
        }
        let calculation = interactions(&machine, 1).unwrap();
        for pose in random_poses(&machine, 3, 21) {
            let first = calculation.at(&Approach::Mean.at_pose(&pose)).first;
            for structured in sensitivities(&machine, &pose, |_| true) {
                let error = structured.error.to_string();
                let effect = first.iter().find(|e| e.errors == [error.clone()]).unwrap();
                // Sensitivities do not know of the rotation of the part.
                let part = |v| abbe::lower::into_part(&machine, v);
                let gap = (effect.deviation - part(structured.deviation)).amax();
                let turn = (effect.rotation - part(structured.rotation)).amax();
                assert!(gap < 1e-11 && turn < 1e-14, "{name} {error}: {gap:e} {turn:e}");
            }
        }
    }
}

#[test]
fn effects_sum_to_the_orders_and_bound_what_order_one_neglects() {
    for (name, machine) in configs::all() {
        let calculation = interactions(&machine, 2).unwrap();
        for pose in random_poses(&machine, 2, 22) {
            let effects = calculation.at(&Approach::Mean.at_pose(&pose));
            let order =
                |n| evaluate(&machine, &Approach::Mean.at_pose(&pose), Order::Degree(n), Frame::Workpiece).deviation;
            let second: nalgebra::Vector3<f64> = effects.second.iter().map(|e| e.deviation * e.value).sum();
            let difference = order(2).position - order(1).position;
            assert!((second - difference).amax() < 2e-13, "{name} {second} {difference}");
            let exact = evaluate(&machine, &Approach::Mean.at_pose(&pose), Order::Exact, Frame::Workpiece).deviation;
            let (position, rotation) = effects.neglected_bound();
            // The third degree is a thousandth of the second.
            assert!((exact.position - order(1).position).norm() <= 1.01 * position + 1e-13, "{name}");
            assert!((exact.rotation - order(1).rotation).norm() <= 1.01 * rotation + 1e-16, "{name}");
        }
    }
}

fn eval(arguments: &[&str]) -> String {
    let machine = configs::folder().join("trunnion.yaml");
    let output = Command::new(env!("CARGO_BIN_EXE_abbe"))
        .args(["--wide", "eval"])
        .arg(machine)
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn eval_prints_them_on_request() {
    let at = ["--at", "X=100,Y=50,A=-40,C=30"];
    let plain: Value = serde_json::from_str(&eval(&[&at[..], &["--format", "json"]].concat())).unwrap();
    assert!(plain["poses"][0].get("sensitivity").is_none());
    let arguments = [&at[..], &["--sensitivity", "--interactions", "--format", "json"]].concat();
    let json: Value = serde_json::from_str(&eval(&arguments)).unwrap();
    let pose = &json["poses"][0];
    assert_eq!(pose["deviation"], plain["poses"][0]["deviation"]);
    let count = configs::machine("trunnion.yaml").errors().count();
    assert_eq!(pose["sensitivity"].as_array().unwrap().len(), count);
    assert!(pose["interactions"].as_array().unwrap().len() > 100);
    assert!(pose["order_1_neglects"]["position_mm"].as_f64().unwrap() > 1e-7);
    let text = eval(&[&at[..], &["--sensitivity"]].concat());
    assert!(text.contains("EBX") && !text.contains("order 1 is good to"));
    let text = eval(&[&at[..], &["--sensitivity", "--interactions"]].concat());
    assert!(text.contains("order 1 is good to ") && text.contains(" nm and "), "{text}");
}

/// A table has a column for each number that was asked for, at all poses the same.
#[test]
fn tables_have_columns_for_what_is_asked_for() {
    // Fewer pairs have an effect at the first.
    let at = ["--at", "A=-20", "--at", "X=100,Y=50,A=-40,C=30"];
    let more = ["--sensitivity", "--interactions", "--algebra", "degree: 2", "--inverse"];
    let table = eval(&[&at[..], &more, &["--format", "csv"]].concat());
    let json: Value = serde_json::from_str(&eval(&[&at[..], &more, &["--format", "json"]].concat())).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let effects = |pose: &Value, key: &str| pose[key].as_array().unwrap().clone();
    let pairs: Vec<usize> = (0..2).map(|i| effects(&json["poses"][i], "interactions").len()).collect();
    assert!(pairs[0] < pairs[1] && rows.len() == 3 && rows.iter().all(|row| row.len() == rows[0].len()), "{pairs:?}");
    for (pose, row) in json["poses"].as_array().unwrap().iter().zip(&rows[1..]) {
        let cell = |name: &str| {
            let column = rows[0].iter().position(|head| *head == name).unwrap_or_else(|| panic!("no column {name}"));
            row[column].parse::<f64>().unwrap()
        };
        for (axis, unit) in [("X", "mm"), ("A", "deg")] {
            assert_eq!(cell(&format!("undo {axis} [{unit}]")), pose["inverse"][axis].as_f64().unwrap());
        }
        let unit = |error: &str| if "ABC".contains(&error[1..2]) { "/rad" } else { "/mm" };
        for effect in [effects(pose, "sensitivity"), effects(pose, "interactions")].concat() {
            let name = effect["error"].as_str().unwrap();
            let per: String = name.split('*').map(unit).collect();
            for (k, letter) in ["x", "y", "z"].iter().enumerate() {
                assert_eq!(cell(&format!("d{letter}/{name} [mm{per}]")), effect["deviation"][k].as_f64().unwrap());
                assert_eq!(cell(&format!("w{letter}/{name} [rad{per}]")), effect["rotation"][k].as_f64().unwrap());
            }
        }
    }
}
