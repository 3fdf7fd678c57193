//! Bounds in the frames of the axes: a machine turned as a whole keeps its budget, an upright one keeps its letters, and
//! an oblique axis is bounded across itself.

use crate::configs;
use crate::language::read;
use crate::oracle::random::Random;
use abbe::analysis::LocationSet;
use abbe::analysis::budget::{
    ActingErrors, Bound, Budget, Distribution, Draws, NODES, Request, Statistic, bounds, budget, budget_poses, classes,
};
use abbe::evaluate::random_poses;
use abbe::lower::sensitivities_to;
use abbe::machine::{AxisKind, Direction, ErrorFamily, ErrorId, Machine, Travel, machine_file};

type Turn = [[f64; 3]; 3];

/// A rotation about an axis (Rodrigues), by its own arithmetic.
fn turn(random: &mut Random) -> Turn {
    let v = random.vector(1.0);
    let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = v.map(|c| c / norm);
    let (s, c) = random.between(0.3, 3.0).sin_cos();
    let k = 1.0 - c;
    [
        [c + k * x * x, k * x * y - s * z, k * x * z + s * y],
        [k * x * y + s * z, c + k * y * y, k * y * z - s * x],
        [k * x * z - s * y, k * y * z + s * x, c + k * z * z],
    ]
}

fn turned(r: &Turn, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| r[i][k] * v[k]).sum())
}

/// The machine without its errors, turned as a whole about machine zero, written and read again.
fn machine_turned(machine: &Machine, r: &Turn) -> Machine {
    let mut parts = machine.to_parts();
    for axis in &mut parts.axes {
        (axis.direction, axis.origin) = (turned(r, axis.direction), turned(r, axis.origin));
    }
    for geometry in parts.geometry.axes.values_mut() {
        for side in [&mut geometry.tool, &mut geometry.workpiece] {
            (side.direction, side.origin.at) = (turned(r, side.direction), turned(r, side.origin.at));
        }
    }
    parts.geometry.workpiece.at = turned(r, parts.geometry.workpiece.at);
    parts.workpiece = turned(r, parts.workpiece);
    for tool in &mut parts.tools {
        (tool.gauge, tool.tip) = (turned(r, tool.gauge), turned(r, tool.tip));
        tool.direction = turned(r, tool.direction);
    }
    read(&[("m.yaml", &machine_file(&parts, &[]))]).0.unwrap()
}

fn of_class(machine: &Machine) -> Vec<Bound> {
    bounds(machine, Some(&classes()["production"]))
}

fn budgeted(machine: &Machine, bounds: &[Bound], searched: bool) -> Budget {
    let (poses, draws) = (budget_poses(machine, 25, 1), Draws::new(3, Distribution::Uniform));
    let (statistic, samples) = (Statistic::Max, 40);
    budget(
        Request {
            acting: ActingErrors::None,
            machine,
            bounds,
            poses: &poses,
            reference: None,
            searched,
            at: None,
            draws: &draws,
            samples,
            statistic,
        },
        &|_| Ok(()),
    )
    .unwrap()
}

/// Largest relative difference of worst case, RSS and every drawn machine.
fn difference(a: &Budget, b: &Budget) -> f64 {
    let relative = |a: f64, b: f64| (a - b).abs() / a.abs().max(1e-12);
    [(&a.position, &b.position), (&a.rotation, &b.rotation)].into_iter().fold(0.0, |largest: f64, (a, b)| {
        let drawn = a.sorted.iter().zip(&b.sorted).map(|(a, b)| relative(*a, *b)).fold(0.0, f64::max);
        largest.max(relative(a.worst_case, b.worst_case)).max(relative(a.rss, b.rss)).max(drawn)
    })
}

#[test]
fn a_machine_turned_as_a_whole_keeps_its_budget() {
    let mut random = Random::new(17);
    let mut largest = 0.0_f64;
    let others = ["robots/ur5.yaml", "lathes/lathe-xzc.yaml"].map(|name| (name.to_owned(), configs::machine(name)));
    // The search is most of the work: a machine each with three linear axes, one and two rotary ones.
    let searched = ["gantry-3ax.yaml", "hmc-4ax.yaml", "tt-nut45.yaml"];
    for (name, machine) in configs::all().into_iter().chain(others) {
        let plain = machine.filtered(|_| false);
        let limits = of_class(&plain);
        for searched in [false, true].into_iter().take(1 + usize::from(searched.contains(&name.as_str()))) {
            let truth = budgeted(&plain, &limits, searched);
            let other = machine_turned(&plain, &turn(&mut random));
            let there = of_class(&other);
            assert_eq!(there.len(), limits.len(), "{name}");
            let found = difference(&truth, &budgeted(&other, &there, searched));
            largest = largest.max(found);
            assert!(found < 1e-9, "{name}, searched {searched}: {found}");
        }
    }
    println!("largest relative difference {largest:e}");
}

/// Bounds along and across every axis, and of squareness.
fn framed(machine: &Machine) -> Machine {
    let mut parts = machine.filtered(|_| false).to_parts();
    let mut size = 0.0;
    let mut next = |unit: f64| {
        size += 1.0;
        Some((3.0 + size % 7.0) * unit)
    };
    for axis in &parts.axes {
        let component = [next(1e-3), next(1e-3), next(1e-6), next(1e-6)];
        let rotary = axis.kind == AxisKind::Rotary;
        let location = if rotary { [None, next(5e-3), None, next(5e-6)] } else { [None; 4] };
        parts.tolerances.joints.insert(axis.name.clone(), [location, component]);
    }
    let there = |name: &str| parts.axes.iter().any(|axis| axis.name.as_str() == name);
    for (pair, names) in [([0, 1], ["X", "Y"]), ([0, 2], ["X", "Z"]), ([1, 2], ["Y", "Z"])] {
        if names.iter().all(|name| there(name)) {
            parts.tolerances.squareness.insert(pair, next(4e-6).unwrap());
        }
    }
    if let Some(spindle) = parts.chain.spindle() {
        let location = [None, None, None, Some(30e-6)];
        parts.tolerances.joints.insert(spindle.clone(), [location, [None; 4]]);
    }
    read(&[("m.yaml", &machine_file(&parts, &[]))]).0.unwrap()
}

#[test]
fn tolerances_along_and_across_turn_with_the_machine() {
    let mut random = Random::new(23);
    for (name, machine) in configs::all() {
        let machine = framed(&machine);
        let (limits, other) = (bounds(&machine, None), machine_turned(&machine, &turn(&mut random)));
        let there = bounds(&other, None);
        assert!(limits.len() >= 6 * machine.axes().len() && limits.iter().all(|b| !b.of_class && !b.by_letter));
        assert_eq!(there.len(), limits.len(), "{name}");
        let found = difference(&budgeted(&machine, &limits, false), &budgeted(&other, &there, false));
        assert!(found < 1e-9, "{name}: {found}");
        // Turned by a quarter about Z, the letters change and the budget does not.
        let quarter = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let there = machine_turned(&machine, &quarter);
        let found = difference(&budgeted(&machine, &limits, false), &budgeted(&there, &bounds(&there, None), false));
        assert!(found < 1e-9, "{name}: {found}");
    }
}

#[test]
fn on_an_upright_machine_the_frames_are_the_letters() {
    let mut upright = 0;
    for (name, machine) in configs::all() {
        let plain = machine.filtered(|_| false);
        let straight = |u: &[f64; 3]| u.iter().filter(|x| x.abs() > 1e-12).count() == 1;
        if !plain.axes().iter().all(|axis| straight(&axis.direction)) {
            continue;
        }
        upright += 1;
        let mut expected: Vec<String> = LocationSet::of(&plain).members.iter().map(|(id, _)| id.to_string()).collect();
        let six = |axis: &abbe::machine::Axis| {
            Direction::ALL.map(|direction| {
                ErrorId { axis: axis.name.clone(), family: ErrorFamily::Component, direction }.to_string()
            })
        };
        expected.extend(plain.axes().iter().flat_map(six));
        expected.sort();
        let limits = of_class(&plain);
        let mut found: Vec<String> = limits.iter().map(ToString::to_string).collect();
        found.sort();
        assert_eq!(found, expected, "{name}");
        assert!(limits.iter().all(|bound| straight(&bound.direction)), "{name}");
    }
    assert!(upright > 10, "{upright}");
}

const OBLIQUE: &str = "abbe: 1\nmachine: M\nchain: \"w b X Y Z B t\"\naxes:\n  X: { travel: [0, 400], origin: [0, 0, \
                       0] }\n  Y: { travel: [0, 300], origin: [0, 0, 0] }\n  Z: { travel: [-200, 0], origin: [0, 0, 0] \
                       }\n  B: { travel: [0, 180], direction: [0, 1, 1], origin: [0, 0, 60] }\ntool: { gauge: [0, 0, 0], \
                       length: 150 }\n";

fn oblique(rest: &str) -> Machine {
    read(&[("m.yaml", &format!("{OBLIQUE}{rest}"))]).0.unwrap()
}

/// The displacement of the tip when the line of B is turned by w (rad), to first order: before the motion plus, after it
/// minus. By hand.
fn by_tilt(w: [f64; 3], q: f64) -> f64 {
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let (s, c) = q.to_radians().sin_cos();
    let u = [0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()];
    let rotated = |v: [f64; 3]| -> [f64; 3] {
        let (n, d) = (cross(u, v), (0..3).map(|i| u[i] * v[i]).sum::<f64>());
        std::array::from_fn(|i| c * v[i] + s * n[i] + (1.0 - c) * d * u[i])
    };
    // Tip at (0, 0, -150), B's origin at (0, 0, 60).
    let arm = [0.0, 0.0, -210.0];
    let (moved, turned) = (cross(w, rotated(arm)), rotated(cross(w, arm)));
    (0..3).map(|i| (moved[i] - turned[i]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_tilt_of_a_45_degree_axis_is_bounded_across_it() {
    // EB0B and EC0B at 50 urad each would tilt the axis by 50 / sqrt 2 only: the rest turns it about itself.
    let machine = oblique("");
    let limits = of_class(&machine);
    let names: Vec<String> = limits.iter().filter(|b| b.error.axis.as_str() == "B").map(ToString::to_string).collect();
    let expected = [
        "EX0B",
        "B location across 2",
        "EA0B",
        "B location about across 2",
        "EXB",
        "B along",
        "B across 2",
        "EAB",
        "B about along",
        "B about across 2",
    ];
    assert_eq!(names, expected);
    let diagonal = 0.5_f64.sqrt();
    for q in [30.0, 90.0, 180.0] {
        let poses = [vec![100.0, 50.0, -20.0, q]];
        let draws = Draws::new(1, Distribution::Uniform);
        let (statistic, samples) = (Statistic::Max, 2);
        let request = Request {
            acting: ActingErrors::None,
            machine: &machine,
            bounds: &limits,
            poses: &poses,
            reference: None,
            searched: false,
            at: Some(&poses[0]),
            draws: &draws,
            samples,
            statistic,
        };
        let at = budget(request, &|_| Ok(())).unwrap().at.unwrap();
        let um = |name: &str| at.iter().find(|c| limits[c.bound].to_string() == name).unwrap().um;
        let across = by_tilt([0.0, diagonal * 50e-6, -diagonal * 50e-6], q) * 1e3;
        assert!((um("B location about across 2") - across).abs() < 1e-9 * across, "{q}");
        assert!((um("EA0B") - by_tilt([50e-6, 0.0, 0.0], q) * 1e3).abs() < 1e-9 * across, "{q}");
        // What either letter gave.
        for letter in [[0.0, 50e-6, 0.0], [0.0, 0.0, 50e-6]] {
            assert!((by_tilt(letter, q) * 1e3 / across - diagonal).abs() < 1e-12);
        }
    }
    // An upright axis has the same bounds.
    let sizes = |machine: &Machine| {
        let mut sizes: Vec<f64> = of_class(machine).iter().map(|bound| bound.tolerance).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    };
    let upright = read(&[("m.yaml", &OBLIQUE.replace("direction: [0, 1, 1], ", ""))]).0.unwrap();
    assert_eq!(sizes(&machine), sizes(&upright));
}

/// A drawn curve at a position: straight lines between the nodes.
fn at(curve: &[f64], axis: &abbe::machine::Axis, position: f64) -> f64 {
    let (min, max) = axis.travel.interval();
    let along = if axis.travel == Travel::Continuous { (position - min).rem_euclid(360.0) } else { position - min };
    let x = along / (max - min) * (NODES - 1) as f64;
    let i = (x.floor() as usize).min(NODES - 2);
    curve[i] + (x - i as f64) * (curve[i + 1] - curve[i])
}

#[test]
fn drawn_machines_are_those_of_the_model_with_tied_letters() {
    for name in ["tt-nut45.yaml", "hh-cb-a-nut.yaml"] {
        let machine = configs::machine(name).filtered(|_| false);
        let limits = of_class(&machine);
        assert!(limits.iter().filter(|b| b.direction.iter().filter(|x| **x != 0.0).count() > 1).count() >= 6, "{name}");
        let draws = Draws::new(7, Distribution::Triangular);
        let poses = random_poses(&machine, 12, 5);
        let (statistic, samples) = (Statistic::Max, 5);
        let request = Request {
            acting: ActingErrors::None,
            machine: &machine,
            bounds: &limits,
            poses: &poses,
            reference: None,
            searched: false,
            at: None,
            draws: &draws,
            samples,
            statistic,
        };
        let mut by_hand = vec![0.0_f64; samples];
        for pose in &poses {
            let mut deviations = vec![nalgebra::Vector3::zeros(); samples];
            for bound in &limits {
                let of_letters = sensitivities_to(&machine, pose, &bound.letter_ids());
                let effect = of_letters
                    .iter()
                    .zip(bound.direction)
                    .fold(nalgebra::Vector3::zeros(), |sum, (s, x)| sum + s.deviation * x);
                for (sample, sum) in deviations.iter_mut().enumerate() {
                    let share = match machine.axis_index(bound.error.axis.as_str()) {
                        Some(i) if !bound.error.is_location() => {
                            let axis = &machine.axes()[i];
                            let closed = axis.travel == Travel::Continuous;
                            at(&draws.curve(&bound.error, sample, closed), axis, pose[i])
                        }
                        _ => draws.constant(&bound.error, sample),
                    };
                    *sum += effect * (share * bound.tolerance);
                }
            }
            by_hand.iter_mut().zip(&deviations).for_each(|(most, d)| *most = most.max(d.norm() * 1e3));
        }
        by_hand.sort_by(f64::total_cmp);
        let found = budget(request, &|_| Ok(())).unwrap().position.sorted;
        assert!(by_hand.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-9 * a), "{name}: {by_hand:?} {found:?}");
    }
}

#[test]
fn letters_of_an_oblique_axis_are_machine_coordinates() {
    let machine = oblique("errors: { EBB: { tolerance: 3 urad }, EX0B: { tolerance: 4 um } }\n");
    let limits = of_class(&machine);
    let of_b = |family: ErrorFamily, turns: bool| -> Vec<(String, f64)> {
        let wanted = |b: &&Bound| {
            b.error.axis.as_str() == "B" && b.error.family == family && b.error.direction.is_rotation() == turns
        };
        limits.iter().filter(wanted).map(|b| (b.to_string(), (b.tolerance * 1e9).round() / 1e3)).collect()
    };
    let pairs = |list: &[(&str, f64)]| list.iter().map(|(n, t)| ((*n).to_owned(), *t)).collect::<Vec<_>>();
    // The rotations of B are by letter now; the nearest letter is along it.
    assert_eq!(of_b(ErrorFamily::Component, true), pairs(&[("EAB", 10.0), ("EBB", 3.0), ("ECB", 10.0)]));
    // X is across B anyway.
    assert_eq!(
        of_b(ErrorFamily::Location, false).iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["EX0B", "B location across 2"]
    );
    assert!(machine.axes().iter().any(|axis| axis.kind == AxisKind::Rotary));
}
