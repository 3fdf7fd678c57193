//! Inverse kinematics against forward kinematics, and machines side by side.

use crate::configs::{all, machine};
use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use abbe::analysis::{ToolPose, Unreachable, direction_gap, inverse, rest, tool_pose};
use abbe::evaluate::random_poses;
use abbe::machine::{AxisKind, Machine};
use nalgebra::Vector3;
use serde_json::Value;

/// Distance of place (mm) and direction (rad) between where the machine is and where it should be.
fn miss(machine: &Machine, pose: &[f64], target: &ToolPose) -> (f64, f64) {
    let reached = tool_pose(machine, pose);
    ((reached.tip - target.tip).norm(), (reached.direction - target.direction).norm())
}

#[test]
fn every_pose_of_every_config_is_reached_again_within_the_travel() {
    for (name, machine) in all() {
        let reference = rest(&machine);
        let mut worst = (0.0_f64, 0.0_f64);
        for pose in random_poses(&machine, 400, 11) {
            let target = tool_pose(&machine, &pose);
            let found = inverse(&machine, &target, &reference).unwrap_or_else(|f| panic!("{name}: {f:?} at {pose:?}"));
            let beyond: Vec<_> = machine.beyond_travel(&found).map(|axis| axis.name.as_str()).collect();
            assert!(beyond.is_empty(), "{name}: {beyond:?} at {pose:?}");
            let (place, direction) = miss(&machine, &found, &target);
            worst = (worst.0.max(place), worst.1.max(direction));
        }
        println!("{name}: {:.1e} mm, {:.1e} rad", worst.0, worst.1);
        assert!(worst.0 < 1e-9 && worst.1 <= 1e-12, "{name}: {worst:?}");
    }
}

#[test]
fn the_pose_itself_is_found_from_beside_it_unless_axes_are_redundant() {
    for (name, machine) in all() {
        let rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).count();
        let redundant = rotary > 2 || machine.axes().len() - rotary > 3;
        for pose in random_poses(&machine, 200, 5) {
            let beside: Vec<f64> = pose.iter().map(|q| q + 1e-3).collect();
            let found = inverse(&machine, &tool_pose(&machine, &pose), &beside).unwrap();
            let far = found.iter().zip(&pose).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(far < if redundant { 1.0 } else { 1e-6 }, "{name}: {found:?} instead of {pose:?}");
        }
    }
}

#[test]
fn ends_of_the_travel_and_singular_poses_are_reached() {
    for (name, machine) in all() {
        let corner = |k: usize| -> Vec<f64> {
            let end = |(i, axis): (usize, &abbe::machine::Axis)| {
                let (min, max) = axis.travel.interval();
                if k >> i & 1 == 0 { min } else { max }
            };
            machine.axes().iter().enumerate().map(end).collect()
        };
        for pose in (0..1 << machine.axes().len()).map(corner).chain([rest(&machine)]) {
            let target = tool_pose(&machine, &pose);
            let found =
                inverse(&machine, &target, &rest(&machine)).unwrap_or_else(|f| panic!("{name}: {f:?} at {pose:?}"));
            let (place, direction) = miss(&machine, &found, &target);
            assert!(place < 1e-9 && direction <= 1e-12, "{name}: {place} {direction} at {pose:?}");
        }
    }
}

#[test]
fn an_axis_the_tool_does_not_need_keeps_its_reference() {
    let machine = machine("trunnion.yaml");
    let mut pose = rest(&machine);
    let c = machine.axis_index("C").unwrap();
    let z = machine.axis_index("Z").unwrap();
    (pose[c], pose[z]) = (123.0, -200.0);
    // The tip is over the middle of the table, so that any C will do.
    (pose[machine.axis_index("X").unwrap()], pose[machine.axis_index("Y").unwrap()]) = (0.0, 0.0);
    let found = inverse(&machine, &tool_pose(&machine, &pose), &pose).unwrap();
    assert_eq!(found[c], 123.0);
}

#[test]
fn nearly_singular_poses_lose_nothing() {
    for name in ["trunnion.yaml", "hh-ca-gantry.yaml", "ht-nut45-c.yaml", "tt-ac-800.yaml"] {
        let machine = machine(name);
        let tilt = machine.axes().iter().rposition(|axis| ["A", "B"].contains(&axis.name.as_str())).unwrap();
        for (mut pose, exponent) in random_poses(&machine, 60, 3).into_iter().zip((0..15).cycle()) {
            pose[tilt] = 10.0_f64.powi(-exponent);
            let target = tool_pose(&machine, &pose);
            let found =
                inverse(&machine, &target, &rest(&machine)).unwrap_or_else(|f| panic!("{name}: {f:?} at {pose:?}"));
            let (place, direction) = miss(&machine, &found, &target);
            assert!(place < 1e-9 && direction <= 1e-12, "{name}: {place} {direction} at {pose:?}");
        }
    }
}

/// Distance and angle between the tool pose at a pose and an upright one.
fn miss_of(machine: &Machine, pose: &[f64], tip: [f64; 3]) -> (f64, f64) {
    miss(machine, pose, &ToolPose::new(tip.into(), Vector3::z()))
}

#[test]
fn a_cone_is_missed_by_the_angle_to_it() {
    // A nutating head of 45 deg alone holds the tool on a cone of 45 deg about (0, 1, 1).
    let text = "abbe: 1\nmachine: N\nchain: w b X Y Z B t\naxes: { X: { travel: [0, 9] }, Y: { travel: [0, 9] }, \
                Z: { travel: [0, 9] }, B: { direction: [0, 1, 1], travel: [0 deg, 90 deg] } }\n";
    let file = abbe::loads(text, &abbe::LoadOptions::default(), abbe::Run::default()).unwrap();
    let machine: &Machine = &file;
    for tilt in [-30.0_f64, 20.0, 70.0] {
        let (s, c) = (libm::sin(tilt.to_radians()), libm::cos(tilt.to_radians()));
        let direction = Vector3::new(s, 0.0, c);
        let axis = Vector3::new(0.0, 1.0, 1.0).normalize();
        let gap = libm::acos(direction.dot(&axis)) - std::f64::consts::FRAC_PI_4;
        assert!((direction_gap(machine, &direction) - gap.abs()).abs() < 1e-9, "{tilt}");
    }
}

#[test]
fn what_cannot_be_reached_is_said() {
    let machine = machine("trunnion.yaml");
    let reference = rest(&machine);
    let target = |tip: [f64; 3], direction: Vector3<f64>| ToolPose::new(tip.into(), direction);
    let from_below = inverse(&machine, &target([0.0; 3], -Vector3::z()), &reference);
    // A table that tilts to -120 deg falls short of holding the tool from below, by 60 deg.
    let a = machine.axis_index("A").unwrap();
    let miss = from_below.unwrap_err();
    assert_eq!(miss.why, Unreachable::Travel);
    let turned = miss.beyond.unwrap()[a];
    assert!((turned + 180.0).abs() < 1e-9, "{turned}");
    let aside = inverse(&machine, &target([1e4, 0.0, 0.0], Vector3::z()), &reference).unwrap_err();
    assert_eq!(aside.why, Unreachable::Travel);
    // The pose beyond the travel takes the tool pose.
    let (place, direction) = miss_of(&machine, aside.beyond.as_ref().unwrap(), [1e4, 0.0, 0.0]);
    assert!(place < 1e-8 && direction < 1e-12, "{place} {direction}");
    let three = crate::configs::machine("gantry-3ax.yaml");
    let tilted = target([0.0; 3], Vector3::new(0.6, 0.0, 0.8));
    assert_eq!(inverse(&three, &tilted, &rest(&three)).unwrap_err().why, Unreachable::Direction);
    assert!((direction_gap(&three, &tilted.direction) - libm::atan2(0.6, 0.8)).abs() < 1e-12);
    let nan = target([f64::NAN, 0.0, 0.0], Vector3::z());
    assert!(inverse(&machine, &nan, &reference).is_err());
    let nowhere = target([0.0; 3], Vector3::new(f64::NAN, 0.0, 1.0));
    assert!(inverse(&machine, &nowhere, &reference).is_err());
}

#[test]
fn the_quill_and_the_column_share_the_way() {
    let machine = machine("boring-w.yaml");
    let reference = rest(&machine);
    let (z, w) = (machine.axis_index("Z").unwrap(), machine.axis_index("W").unwrap());
    let mut pose = reference.clone();
    (pose[z], pose[w]) = (900.0, -500.0);
    let found = inverse(&machine, &tool_pose(&machine, &pose), &reference).unwrap();
    // 400 mm from Z = 0, W = 0 (its end): W cannot go up, so Z goes alone.
    assert!((found[z] - 400.0).abs() < 1e-9 && found[w] == 0.0, "{found:?}");
    assert!(machine.beyond_travel(&found).next().is_none());
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_machine_compared_with_itself_differs_in_nothing() {
    for name in ["trunnion.yaml", "hh-bd-ram.yaml", "boring-w.yaml", "ht-nut45-c.yaml"] {
        let result = json(&["compare", name, name, "--poses", "300", "--format", "json"]);
        assert_eq!((&result["asked"], &result["poses"]), (&300.into(), &300.into()), "{name}");
        let difference = &result["machines"][1]["minus_first"];
        for key in ["position_um", "rotation_urad"] {
            assert!(
                ["max", "mean", "rms", "p95"].iter().all(|m| number(&difference[key][m]) == 0.0),
                "{name}: {difference}"
            );
        }
        assert_eq!(result["machines"][0]["position_um"], result["machines"][1]["position_um"]);
        assert!(number(&result["machines"][0]["position_um"]["max"]) > 1.0);
    }
}

#[test]
fn every_config_reaches_all_tool_poses_of_its_own_volume() {
    for name in crate::configs::names() {
        let output = abbe_on(2, &["compare", &name, &name, "--poses", "200", "--format", "json", "--quiet"]);
        assert!(output.status.success(), "{name}");
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(result["machines"][0]["unreachable"]["total"], 0, "{name}: {}", result["machines"][0]);
    }
}

#[test]
fn two_machines_are_counted_and_subtracted() {
    let result =
        json(&["compare", "trunnion.yaml", "variants/trunnion-swivel-head.yaml", "--poses", "400", "--format", "json"]);
    let (first, second) = (&result["machines"][0], &result["machines"][1]);
    let missed = second["unreachable"]["total"].as_u64().unwrap();
    assert_eq!(result["poses"].as_u64().unwrap() + missed, 400);
    assert!(missed > 0 && second["unreachable"]["travel"] == second["unreachable"]["total"]);
    for key in ["position_um", "rotation_urad"] {
        for metric in ["max", "mean", "rms", "p95"] {
            let expected = number(&second[key][metric]) - number(&first[key][metric]);
            assert_eq!(number(&second["minus_first"][key][metric]), expected);
        }
    }
    // The first machine's numbers are those of `eval` at its poses in the table.
    let csv =
        abbe(&["compare", "trunnion.yaml", "variants/trunnion-swivel-head.yaml", "--poses", "400", "--format", "csv"]);
    assert_eq!(csv.lines().count() as u64, 1 + 2 * (400 - missed));
}

const LATHE: &str = "lathes/lathe-xzc.yaml";

/// C turns the place into the plane of X and Z. X = 0 is on the axis of C: at (30, 40) from it X is 50, and C, which carries the
/// workpiece, is where 30 = 50 cos C and 40 = 50 sin C up to its sign.
#[test]
fn a_lathe_reaches_across_its_plane_by_its_spindle() {
    let machine = machine(LATHE);
    let (x, c) = (machine.axis_index("X").unwrap(), machine.axis_index("C").unwrap());
    let reference = rest(&machine);
    let centre = tool_pose(&machine, &reference).tip;
    let target = ToolPose::new(centre + Vector3::new(30.0, 40.0, 100.0), Vector3::z());
    let found = inverse(&machine, &target, &reference).unwrap();
    assert!((found[x] - 50.0).abs() < 1e-9, "{found:?}");
    let turn = libm::atan2(40.0, 30.0).to_degrees();
    assert!((found[c].abs() - turn).abs() < 1e-9, "{found:?}");
    assert!(miss(&machine, &found, &target).0 < 1e-9);
    // Within 15 mm the slide may stand on either side; beyond 190 mm it may not be.
    let near = ToolPose { tip: centre + Vector3::new(-9.0, 0.0, 0.0), ..target };
    let found = inverse(&machine, &near, &reference).unwrap();
    assert!((found[x] + 9.0).abs() < 1e-9 && found[c].abs() < 1e-9, "{found:?}");
    let far = ToolPose { tip: centre + Vector3::new(150.0, 150.0, 0.0), ..target };
    assert_eq!(inverse(&machine, &far, &reference).unwrap_err().why, Unreachable::Travel);
    // A place that hangs on nothing but X and Z needs no turn.
    for pose in random_poses(&machine, 500, 3) {
        let target = tool_pose(&machine, &pose);
        let found = inverse(&machine, &target, &reference).unwrap();
        assert!(miss(&machine, &found, &target).0 < 1e-9 && machine.beyond_travel(&found).next().is_none());
    }
}

/// A lathe beside itself, and beside one whose X carriage is 10 urad out of square with Z.
#[test]
fn lathes_are_compared() {
    let result = json(&["compare", LATHE, LATHE, "--poses", "300", "--format", "json"]);
    assert_eq!(result["poses"], 300);
    assert_eq!(number(&result["machines"][1]["minus_first"]["position_um"]["max"]), 0.0);
    let folder = Folder::new("compare-lathes");
    let lathe = |name: &str, error: &str| {
        let axes = "{ Z: { travel: [0, 500], origin: [0, 0, 0] }, X: { travel: [0, 200], origin: [0, 0, 0] }, C: { travel: continuous } }";
        let text = "abbe: 1\nmachine: m\nchain: \"w C' b Z X t\"\naxes: ";
        folder.with(
            name,
            &format!("{text}{axes}\nerrors: {{ {error} }}\nvolume: {{ step: 50 mm, C: {{ step: 30 deg }} }}\n"),
        )
    };
    let (square, tilted) = (lathe("square.yaml", "EB0Z: 0 urad"), lathe("tilted.yaml", "EB0Z: 10 urad"));
    let result = json(&["compare", text(&square), text(&tilted), "--poses", "200", "--format", "json"]);
    let [none, some] = [0, 1].map(|i| number(&result["machines"][i]["position_um"]["max"]));
    // 10 urad over at most 500 mm, at the same tool poses.
    assert!(none == 0.0 && some > 4.5 && some <= 5.0, "{none} {some}");
    assert_eq!(result["poses"], 200);
}

#[test]
fn nothing_in_common_is_refused_with_the_reasons() {
    let (code, message) = refused(&["compare", "trunnion.yaml", "gantry-3ax.yaml", "--poses", "50"]);
    assert!(code == 1 && message.contains("E0813") && message.contains("50 direction"), "{message}");
    assert_eq!(refused(&["compare", "trunnion.yaml"]).0, 2);
}

#[test]
fn errors_are_compared_one_by_one() {
    let other = "variants/trunnion-aligned.yaml";
    let result = json(&["compare", "trunnion.yaml", other, "--poses", "200", "--format", "json"]);
    let list = result["contributions"].as_array().unwrap();
    assert!(list.len() >= 41, "{}", list.len());
    let largest = |e: &Value| e["um"].as_array().unwrap().iter().filter_map(Value::as_f64).fold(0.0, f64::max);
    assert!(list.windows(2).all(|two| largest(&two[0]) >= largest(&two[1])));
    for e in list {
        let um = |i: usize| e["um"][i].as_f64().unwrap_or(0.0);
        assert_eq!((number(&e["minus_first"][0]), number(&e["minus_first"][1])), (0.0, um(1) - um(0)), "{e}");
    }
    // EX0C = 6 um on both sides of the difference alone: at most 12 um, by the golden sign of half a turn.
    let eccentric = list.iter().find(|e| e["error"] == "EX0C").unwrap();
    let um = number(&eccentric["um"][0]);
    assert!(um > 11.0 && um <= 12.0, "{eccentric}");
    // The variant removes or reduces what alignment can: the rest is the same, curve by curve.
    let same = list.iter().find(|e| e["error"] == "EXX").unwrap();
    assert_eq!(number(&same["minus_first"][1]), 0.0);
}

#[test]
fn budgets_are_compared_tolerance_by_tolerance() {
    let folder = Folder::new("compare-budgets");
    let machine = |name: &str, errors: &str| {
        let axes = "{ X: { travel: [0, 400], origin: [0, 0, 0] }, Y: { travel: [0, 500], origin: [0, 0, 0] }, Z: { travel: [0, 400], origin: [0, 0, 0] } }";
        folder.with(
            name,
            &format!("abbe: 1\nmachine: {name}\nchain: w b X Y Z t\naxes: {axes}\nerrors: {{ {errors} }}\n"),
        )
    };
    let one = machine("one.yaml", "EC0Y: { tolerance: 20 urad }, EXX: { tolerance: 3 um }");
    let two = machine("two.yaml", "EC0Y: { tolerance: 40 urad }, EXX: { tolerance: 6 um }, EYY: 0 um");
    let three = machine("three.yaml", "EYY: 5 um");
    let of = |files: &[&str]| {
        json(&[&["compare"], files, &["--samples", "300", "--poses", "200", "--format", "json", "--quiet"]].concat())
    };
    let c = of(&[text(&one), text(&two)]);
    let b = &c["budgets"];
    let at = |pointer: &str| b.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {b}"));
    // Drawn alike, an error grows with its tolerance: all of the second is twice the first, and so the difference the first.
    for key in ["worst_case", "rss", "mean_of_both", "monte_carlo/mean", "monte_carlo/p95"] {
        let first = at(&format!("/machines/0/position_um/{key}"));
        assert!((at(&format!("/machines/1/position_um/{key}")) - 2.0 * first).abs() < 1e-9 * first, "{key}");
        assert!((at(&format!("/machines/1/minus_first/position_um/{key}")) - first).abs() < 1e-9 * first, "{key}");
    }
    let errors = b["contributions"].as_array().unwrap();
    assert_eq!(errors.iter().map(|e| e["error"].as_str().unwrap()).collect::<Vec<_>>(), ["EC0Y", "EXX"]);
    assert_eq!((&errors[0]["tolerance"], &errors[0]["unit"]), (&serde_json::json!([20.0, 40.0]), &"urad".into()));
    for i in 0..2 {
        let part = at(&format!("/contributions/{i}/um_of_p95/0"));
        assert!((at(&format!("/contributions/{i}/minus_first/1")) - part).abs() < 1e-9 * part);
    }
    // On average: EC0Y moves the tool by y; root mean square over the tool poses of the comparison, as printed.
    let csv = abbe(&["compare", text(&one), text(&two), "--poses", "200", "--format", "csv"]);
    let y = |line: &str| line.split(',').nth(3).unwrap().parse::<f64>().unwrap();
    let squares: Vec<f64> = csv.lines().skip(1).step_by(2).map(|line| (y(line) * 20e-3).powi(2)).collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((at("/contributions/0/average_um/0") - rms).abs() < 1e-9, "{rms}");
    // All parts are those of the machines around the 95 % value: within the window of 92.5 to 97.5 %.
    let sum: f64 = (0..2).map(|i| at(&format!("/contributions/{i}/um_of_p95/0"))).sum();
    let (p90, p99) = (
        at("/machines/0/position_um/monte_carlo/percentiles/p90/value"),
        at("/machines/0/position_um/monte_carlo/percentiles/p99/value"),
    );
    assert!(p90 < sum && sum < p99, "{p90} {sum} {p99}");
    let few = ["--poses", "50", "--samples", "50", "--max-samples", "50"];
    let said = abbe(&[&["compare", text(&one), text(&two)], &few[..]].concat());
    assert!(said.contains("Budgets on the same tool poses: 2 and 2 errors bounded; 50 machines drawn"), "{said}");
    // One machine without bounds: reported, and the rest is there.
    let c = of(&[text(&one), text(&three)]);
    assert!(c["budgets"].is_null() && c["warnings"][0]["code"] == "W0607", "{c}");
    assert!(of(&[text(&three), text(&three)])["warnings"].is_null());
    // With a class both have bounds.
    let c = of(&[text(&one), text(&three), "--class", "production"]);
    assert_eq!((&c["budgets"]["class"], c["budgets"]["machines"].as_array().unwrap().len()), (&"production".into(), 2));
}
