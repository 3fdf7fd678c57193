//! `convert`: the oracle finds the same machine before and after, on random machines and every pair of conventions; an
//! inexact conversion is refused with its number.

use crate::oracle::curves::{Curve, Error, Travel as Direction};
use crate::oracle::machines::{Pose, Sample, combinations};
use crate::oracle::matrix::{minus, norm};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::rigid::{self, Answer, Frame, State};
use crate::oracle::yaml;
use crate::support::{Run, abbe, config, number};
use abbe::machine::{
    Approach, AxisKind, Branch, ErrorsAre, Joints, LinearOrder, Location, LocationOrder, Machine, RotaryOrder, Sense,
};

/// The machine as the oracle sees it: its numbers and the names of its conventions.
fn oracle(machine: &Machine) -> rigid::Machine {
    let c = machine.conventions();
    let axis = |(i, axis): (usize, &abbe::machine::Axis)| rigid::Axis {
        name: axis.name.to_string(),
        rotary: axis.kind == AxisKind::Rotary,
        workpiece: axis.branch == Branch::Workpiece,
        direct: Some(axis.sense == Sense::Direct),
        direction: axis.direction,
        origin: axis.origin,
        location: machine.axis_errors(i).location_values(),
    };
    let tool = machine.tool();
    rigid::Machine {
        conventions: rigid::Conventions {
            carried_body: c.location == Location::CarriedBody,
            before: c.linear == LinearOrder::Before,
            rotating: c.rotary == RotaryOrder::Rotating,
            direct: c.workpiece_axes == Sense::Direct,
            body: c.errors_are == ErrorsAre::Body,
            real: c.location_order == LocationOrder::Real,
            linearised: c.joints == Joints::Linearised,
        },
        walk: machine.axes().iter().enumerate().map(axis).collect(),
        spindle: machine.spindle_errors().map(|errors| errors.location_values()),
        gauge: tool.gauge,
        offset: std::array::from_fn(|k| tool.tip[k] - tool.gauge[k]),
        workpiece_origin: machine.workpiece(),
        workpiece_rotation: machine.workpiece_angles(),
        tool_setup: machine.setup().tool,
        workpiece_setup: machine.setup().workpiece,
    }
}

const DIRECTIONS: [(Direction, Approach); 3] = [
    (Direction::Mean, Approach::Mean),
    (Direction::Forward, Approach::Forward),
    (Direction::Reverse, Approach::Reverse),
];

/// The oracle's answer for a file that the program wrote; `over` are the axes whose sense is reversed.
fn answer(machine: &Machine, pose: &Pose, over: &[bool], approach: Approach) -> Answer {
    let state = |(i, q): (usize, &f64)| {
        let position = if over[i] { -q } else { *q };
        let way = match (over[i], approach) {
            (true, Approach::Forward) => Approach::Reverse,
            (true, Approach::Reverse) => Approach::Forward,
            (_, way) => way,
        };
        let rotary = machine.axes()[i].kind == AxisKind::Rotary;
        State {
            position: if rotary { position.to_radians() } else { position },
            errors: machine.component_values(i, &way.at_position(position)),
        }
    };
    let states: Vec<State> = pose.iter().enumerate().map(state).collect();
    oracle(machine).evaluate(&states, Frame::Workpiece)
}

/// The largest difference of positions (mm) and of rotations (rad) between a sample and a converted file.
fn apart(sample: &Sample, converted: &Machine, random: &mut Random) -> [f64; 2] {
    let default = sample.rigid.conventions.direct;
    let was = |axis: &rigid::Axis| axis.workpiece && axis.direct.unwrap_or(default);
    let is = |axis: &abbe::machine::Axis| axis.branch == Branch::Workpiece && axis.sense == Sense::Direct;
    let over: Vec<bool> = sample.rigid.walk.iter().zip(converted.axes()).map(|(a, b)| was(a) != is(b)).collect();
    let mut largest = [0.0_f64; 2];
    for pose in sample.poses(random, 6) {
        for (direction, approach) in DIRECTIONS {
            let ours = sample.evaluate(&pose, direction, Frame::Workpiece);
            let theirs = answer(converted, &pose, &over, approach);
            let gap = |a, b| norm(minus(a, b));
            largest[0] = largest[0].max(gap(ours.nominal, theirs.nominal)).max(gap(ours.deviation, theirs.deviation));
            largest[1] = largest[1].max(gap(ours.rotation, theirs.rotation));
        }
    }
    largest
}

/// Converts a sample; the run, and the file if there is one.
fn convert(sample: &Sample, arguments: &[&str]) -> (Run, Option<Machine>, Folder) {
    let folder = Folder::new();
    yaml::write(sample, &folder);
    let out = folder.path("converted.yaml");
    let run = Run::of(
        abbe()
            .arg("convert")
            .arg(folder.path("machine.yaml"))
            .args(arguments)
            .args(["--format", "json", "--out"])
            .arg(&out),
    );
    let machine = out.exists().then(|| crate::loaded::machine(&out));
    (run, machine, folder)
}

/// Rounding of some metres, in matrices multiplied and taken apart again: the program's own bound.
const BOUND: [f64; 2] = [1e-9, 1e-12];

/// Checks an exact conversion: the oracle agrees, and so does the program's own figure.
fn exact(sample: &Sample, arguments: &[&str], random: &mut Random) -> Machine {
    let (run, machine, folder) = convert(sample, arguments);
    let text = || std::fs::read_to_string(folder.path("machine.yaml")).unwrap();
    assert_eq!(run.code, Some(0), "{arguments:?}\n{}\n{}", run.err, text());
    let machine = machine.unwrap();
    let found = apart(sample, &machine, random);
    assert!(found[0] < BOUND[0] && found[1] < BOUND[1], "{arguments:?}: {found:?}\n{}", text());
    let said = run.json();
    assert!(number(&said, "/proof/position_mm") <= BOUND[0] && number(&said, "/proof/rotation_rad") <= BOUND[1]);
    machine
}

/// Every curve in a form that products with the position stay in: polynomials on linear axes, harmonics on rotary ones.
/// `both`: with forward and reverse apart, whose mean no product of errors is true to.
fn closed(sample: &Sample, random: &mut Random, both: bool) -> Sample {
    let mut other = sample.clone();
    for (axis, extra) in other.rigid.walk.iter().zip(&mut other.axes) {
        for (k, error) in extra.errors.iter_mut().enumerate() {
            let size = if k < 3 { 0.02 } else { 4e-5 };
            let curve = |random: &mut Random| match (axis.rotary, random.below(3)) {
                (_, 0) => Curve::Constant(random.around(size)),
                (true, _) => {
                    let term = |k| (k, random.around(size), if k == 0 { 0.0 } else { random.around(size) });
                    Curve::Harmonics([0, 1, 2].map(term).to_vec())
                }
                (false, _) => Curve::Polynomial((0..3).map(|k| random.around(size) / 500_f64.powi(k)).collect()),
            };
            if let Some(Error { forward, reverse }) = error {
                *forward = curve(random);
                *reverse = reverse.as_ref().filter(|_| both).map(|_| curve(random));
            }
        }
    }
    other
}

/// The other word of each key.
fn toggles(of: rigid::Conventions) -> [String; 6] {
    let pairs = [
        ("location", of.carried_body, "axis_only", "carried_body"),
        ("linear", of.before, "after", "before"),
        ("rotary", of.rotating, "stationary", "rotating"),
        ("workpiece_axes", of.direct, "iso841", "direct"),
        ("errors_are", of.body, "tool_relative", "body"),
        ("location_order", of.real, "nilpotent", "real"),
    ];
    pairs.map(|(key, second, a, b)| format!("{key}: {}", if second { a } else { b }))
}

/// From each of the 32 combinations of conventions, three keys alone, the others from the next: 96 pairs.
#[test]
fn every_key_from_every_combination() {
    let mut random = Random::new(101);
    for (index, conventions) in combinations().enumerate() {
        for toggle in toggles(conventions).into_iter().skip((index + index / 2) % 2).step_by(2) {
            let linear = ["workpiece_axes", "location_order"].iter().any(|key| toggle.starts_with(key));
            let sample = closed(&Sample::random(&mut random, conventions, 4e-5), &mut random, linear);
            exact(&sample, &["--to", &toggle], &mut random);
        }
    }
}

/// From any combination to any other at once, and back: the errors are what they were.
#[test]
fn any_combination_to_any_other_and_back() {
    let mut random = Random::new(102);
    let all: Vec<rigid::Conventions> = combinations().collect();
    for from in &all {
        let to = all[random.below(all.len())];
        let words = |c: rigid::Conventions| {
            let mut words = toggles(rigid::Conventions {
                carried_body: !c.carried_body,
                before: !c.before,
                rotating: !c.rotating,
                direct: !c.direct,
                body: !c.body,
                real: !c.real,
                ..c
            })
            .to_vec();
            words.retain(|word| !word.starts_with("location_order"));
            words.join(", ")
        };
        let sample = closed(&Sample::random(&mut random, *from, 4e-5), &mut random, false);
        let mut there = exact(&sample, &["--to", &words(to)], &mut random);
        // A second conversion takes the first one's file.
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let (one, two) = (folder.path("one.yaml"), folder.path("two.yaml"));
        for (source, target, to) in [("machine.yaml", &one, to), ("one.yaml", &two, *from)] {
            let run =
                Run::of(abbe().arg("convert").arg(folder.path(source)).args(["--to", &words(to), "--out"]).arg(target));
            assert_eq!(run.code, Some(0), "{}", run.err);
        }
        there = if one.exists() { crate::loaded::machine(&two) } else { there };
        let found = apart(&sample, &there, &mut random);
        assert!(found[0] < 2.0 * BOUND[0] && found[1] < 2.0 * BOUND[1], "{found:?}");
    }
}

/// Location errors from the machine frame to the line of any axis: constants alone change to first order.
#[test]
fn any_axis_can_be_the_datum() {
    let mut random = Random::new(103);
    for conventions in combinations().filter(|c| !c.carried_body).step_by(2) {
        let sample = closed(&Sample::random(&mut random, conventions, 4e-5), &mut random, false);
        let datum = sample.rigid.walk[random.below(sample.rigid.walk.len())].name.clone();
        let machine = exact(&sample, &["--datum", &datum], &mut random);
        let index = machine.axis_index(&datum).unwrap();
        assert_eq!(machine.axis_errors(index).location_values(), [0.0; 6], "the datum has no location error");
    }
}

/// Tables stay tables, to the bit where nothing but their sign or their direction changes.
#[test]
fn tables_are_kept() {
    for to in ["carried_body", "direct"] {
        let folder = Folder::new();
        let out = folder.path("converted.yaml");
        let run = Run::of(abbe().arg("convert").arg(config("trunnion.yaml")).args(["--to", to, "--out"]).arg(&out));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let [before, after] = [config("trunnion.yaml"), out].map(|path| crate::loaded::machine(&path));
        for (i, axis) in before.axes().iter().enumerate() {
            for (a, b) in before.axis_errors(i).component.iter().zip(&after.axis_errors(i).component) {
                let points = |term: &Option<abbe::machine::ErrorTerm>| match term {
                    Some(abbe::machine::ErrorTerm::Component(c)) => {
                        c.curves().filter_map(|c| c.knots()).map(|k| k.positions().len()).max()
                    }
                    _ => None,
                };
                assert_eq!(points(a), points(b), "{} {to}", axis.name);
            }
            let turned = to == "direct" && axis.branch == Branch::Workpiece;
            let kept = |q: f64| (q, if turned { -q } else { q });
            if to == "direct" {
                let (q, r) = kept(axis.travel.interval().0);
                let (a, b) = (
                    before.component_values(i, &Approach::Mean.at_position(q)),
                    after.component_values(i, &Approach::Mean.at_position(r)),
                );
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15), "{a:?} {b:?}");
            }
        }
    }
}

/// Angle in a table times position is no table: refused with the size, nothing written; accepted with a bound.
#[test]
fn what_bends_between_points_is_refused_with_its_size() {
    let folder = Folder::new();
    let out = folder.path("converted.yaml");
    let run = |more: &[&str]| {
        Run::of(
            abbe().arg("convert").arg(config("trunnion.yaml")).args(["--to", "before", "--out"]).arg(&out).args(more),
        )
    };
    run(&[]).refused("E0526").says("differ by up to 49.1 nm").says("EZX (the position times an angle").says("--within");
    assert!(!out.exists());
    let accepted = run(&["--within", "1 nm", "--format", "json"]);
    let said = accepted.json();
    assert!(number(&said, "/proof/position_mm") < 1e-6 && number(&said, "/proof/position_mm") > 1e-9);
    assert!(out.exists());
    run(&["--within", "0.001 nm"]).refused("E0526");
}

#[test]
fn the_new_file_is_not_written_over_the_old() {
    let folder = Folder::new();
    let text = "abbe: 1\nmachine: M\nchain: \"w b X t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] } }\nerrors: { EXX: 3 um }\n";
    let path = folder.write("machine.yaml", text);
    Run::of(abbe().arg("convert").arg(&path).args(["--to", "linearised", "--out"]).arg(&path)).refused("E0630");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}

/// A linearised joint is no rotation: the difference is half the square of the angle, times the lever.
#[test]
fn linearised_joints_cannot_be_made_orthogonal() {
    let folder = Folder::new();
    let text = "abbe: 1\nmachine: M\nchain: \"w b X t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] } }\n\
                tool: { offset: [0, 0, -400] }\nerrors: { EBX: 100 urad, EXX: 3 um }\n";
    let path = folder.write("machine.yaml", text);
    let run = |more: &[&str]| Run::of(abbe().arg("convert").arg(&path).args(["--to", "linearised"]).args(more));
    // 400 mm (1e-4)^2 / 2 = 2 nm; along with the third order of the sine, 400 mm 1e-12/6, nothing.
    run(&[]).refused("E0526").says("up to 2 nm").says("stretches");
    assert_eq!(run(&["--within", "5 nm"]).code, Some(0));
    let plain = folder.write("machine.yaml", &text.replace("EBX: 100 urad, ", ""));
    assert_eq!(Run::of(abbe().arg("convert").arg(plain).args(["--to", "linearised"])).code, Some(0));
}

/// By hand: with `before`, a carriage's yaw of 10 urad shows as straightness 10 urad times position, at its guide.
#[test]
fn yaw_becomes_straightness() {
    let folder = Folder::new();
    let path = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: M\nchain: \"w b X t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] } }\nerrors: { ECX: 10 urad }\n",
    );
    let out = folder.path("out.yaml");
    assert_eq!(Run::of(abbe().arg("convert").arg(path).args(["--to", "before", "--out"]).arg(&out)).code, Some(0));
    let six = crate::loaded::machine(&out).component_values(0, &Approach::Mean.at_position(400.0));
    // E N: the error turns the travel already made, so 10 urad x 400 mm = 4 um must be taken back.
    assert!((six[1] + 4e-3).abs() < 1e-12 && (six[5] - 1e-5).abs() < 1e-18, "{six:?}");
}

/// By hand: squareness of Y in the machine frame, as errors of joints that carry each other.
#[test]
fn squareness_between_carried_bodies() {
    let folder = Folder::new();
    let path = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: M\nchain: \"w b X Y t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] }, Y: { travel: [0, 500], origin: [0, 0, 0] } }\n\
         errors: { EC0X: 5 urad, EC0Y: 12 urad }\n",
    );
    let out = folder.path("out.yaml");
    let run = Run::of(abbe().arg("convert").arg(path).args(["--to", "carried_body", "--out"]).arg(&out));
    assert_eq!(run.code, Some(0), "{}", run.err);
    let machine = crate::loaded::machine(&out);
    let c0 = |i: usize| machine.axis_errors(i).location_values()[5];
    assert!((c0(0) - 5e-6).abs() < 1e-18 && (c0(1) - 7e-6).abs() < 1e-18);
    // The tool is on Y as before: its rotation along the chain is taken back at the spindle.
    assert!((machine.spindle_errors().unwrap().location_values()[5] + 12e-6).abs() < 1e-18);
    assert_eq!(machine.chain().to_string(), "w b X Y (S) t");
}

/// Two exact directions of approach need not have an exact mean.
#[test]
fn the_mean_of_two_directions_is_said_to_be_the_reason() {
    let folder = Folder::new();
    let path = folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: M\nchain: \"w b X t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] } }\n\
         errors: { ECX: { forward: 90 urad, reverse: -90 urad } }\n",
    );
    // q (cos 90e-6 - 1) = 2.025 nm along X from both sides, nothing from their mean.
    let run = |more: &[&str]| Run::of(abbe().arg("convert").arg(&path).args(["--to", "before"]).args(more));
    run(&[]).refused("E0526").says("up to 2.03 nm").says("the mean of two products");
    assert_eq!(run(&["--within", "3 nm"]).code, Some(0));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::new();
    let text = "abbe: 1\nmachine: M\nchain: \"w C' b X t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] }, C: { travel: continuous } }\n\
                errors: { EBX: { tolerance: 3 urad }, EA0C: 4 urad }\n";
    let path = folder.write("machine.yaml", text);
    let run = |arguments: &[&str]| Run::of(abbe().arg("convert").arg(&path).args(arguments));
    run(&["--to", "before"]).refused("E0527").says("EBX");
    assert_eq!(run(&["--to", "direct, carried_body"]).code, Some(0));
    run(&["--to", "carried"]).refused("E0528").says("carried_body");
    run(&["--to", "location: sideways"]).refused("E0528").says("sideways");
    run(&["--to", "preset: kimm"]).refused("E0528").says("there is no preset `kimm`");
    run(&["--to", "colour: red"]).refused("E0528").says("colour");
    run(&["--to", ""]).refused("E0528");
    run(&["--datum", "Q"]).refused("E0528").says("its axes are C, X");
    run(&["--datum", "X", "--to", "carried_body"]).refused("E0528");
    assert_eq!(run(&[]).code, Some(2));
    assert_eq!(run(&["--to", "before", "--format", "csv"]).code, Some(2));
    assert_eq!(run(&["--to", "before", "--within", "1 deg"]).code, Some(2));
    folder.write("machine.yaml", &text.replace("EA0C: 4", "EA0C: { tolerance: 4 urad }, EB0C: 4"));
    run(&["--to", "carried_body"]).refused("E0527").says("EA0C");
    folder.write(
        "machine.yaml",
        "abbe: 1\nmachine: M\nchain: \"w b X C t\"\naxes: { X: { travel: [0, 500], origin: [0, 0, 0] }, C: { travel: continuous } }\n\
         tools: { short: { gauge: [0, 0, 0], length: 50 }, long: { gauge: [0, 0, -80], length: 90 } }\n\
         errors: { EA0C: 4 urad }\n",
    );
    run(&["--to", "carried_body"]).refused("E0529").says("gauge");
}

/// The algebra, the volume, several tools and where numbers come from are in the file too.
#[test]
fn the_file_is_whole() {
    let folder = Folder::new();
    let text = "abbe: 1\nmachine: M\nchain: \"w C' b X (S) t\"\n\
                axes: { X: { travel: [0, 500], origin: [0, 0, 0] }, C: { travel: [-90, 270] } }\n\
                tools: { short: { length: 50 }, long: { length: 90 } }\n\
                volume: { C: { range: [0, 180], step: 5 deg } }\n\
                algebra: { degree: 3, generators: { slow: [EXX, EX0C], \"fast one\": [EYX] }, vanish: [slow^2] }\n\
                provenance: { class: test, converted-by: somebody }\n\
                errors: { EXX: 4 um, EYX: { forward: 1 um, reverse: 3 um }, EX0C: 2 um, EA0S: 3 urad, EZC: { tolerance: 1 um } }\n";
    let path = folder.write("machine.yaml", text);
    let out = folder.path("out.yaml");
    let convert = |to: &str| {
        let run = Run::of(
            abbe().arg("convert").arg(&path).args(["--to", to, "--tool", "long", "--quiet", "--out"]).arg(&out),
        );
        assert_eq!(run.code, Some(0), "{}", run.err);
        (crate::loaded::machine(&out), std::fs::read_to_string(&out).unwrap())
    };
    let (machine, written) = convert("direct");
    let before = crate::loaded::machine(&path);
    assert_eq!(machine.algebra(), before.algebra());
    let interval = |m: &Machine| (m.volume()[0].min, m.volume()[0].max, m.volume()[0].step);
    assert_eq!((interval(&before), interval(&machine)), ((0.0, 180.0, 5.0), (-180.0, 0.0, 5.0)), "{written}");
    assert_eq!(machine.tools().iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["long", "short"]);
    let entries = &machine.provenance().entries;
    assert!(entries.contains(&("class".to_owned(), "test".to_owned())));
    assert!(entries.iter().filter(|(key, _)| key == "converted-by").all(|(_, by)| by.starts_with("abbe")));
    let (again, _) = convert("direct");
    assert_eq!(format!("{again:?}"), format!("{machine:?}"), "same input, same bytes");
}
