//! The compiled evaluator against the general algebra, on random machines in every convention, and against itself:
//! at any vector width and in any batch the bits are the same.

use crate::identify::{five, five_poses};
use crate::interactions::unit_response;
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::rigid::Conventions;
use crate::oracle::yaml;
use abbe::analysis::{SurveyTask, View, deviation_in, map, survey};
use abbe::compensation::{Goal, Scope, correct, correct_all};
use abbe::evaluate::{
    Bare, Batch, Columns, CompiledField, CompiledModel, Deviation, Frame, Nodes, Order, PoseColumns, Poses, Tally,
    Width, command_deviation, evaluate,
};
use abbe::lower::{NominalPose, sensitivities};
use abbe::machine::{Approach, Grid, Machine};

fn random_machine(random: &mut Random, conventions: Conventions, size: f64) -> (Machine, Vec<Vec<f64>>) {
    let sample = Sample::random(random, conventions, size);
    let folder = Folder::new();
    yaml::write(&sample, &folder);
    let poses = sample.poses(random, 29);
    (crate::loaded::machine(&folder.path("machine.yaml")), poses)
}

fn columns(machine: &Machine, poses: &[Vec<f64>]) -> PoseColumns {
    PoseColumns::of(machine.axes().len(), poses.iter().map(Vec::as_slice))
}

fn planned(plan: &CompiledModel, poses: &[Vec<f64>]) -> Vec<Deviation> {
    let columns = columns(plan.machine(), poses);
    let mut out = Columns::new(poses.len());
    plan.deviations(&columns.batch(), out.output(poses.len()));
    (0..poses.len()).map(|i| out.get(i)).collect()
}

/// Largest position and rotation of a list.
fn largest(list: &[Deviation]) -> [f64; 2] {
    list.iter().fold([0.0_f64; 2], |[p, r], d| [p.max(d.position.amax()), r.max(d.rotation.amax())])
}

fn differences(a: &[Deviation], b: &[Deviation]) -> Vec<Deviation> {
    let one = |(a, b): (&Deviation, &Deviation)| Deviation {
        position: a.position - b.position,
        rotation: a.rotation - b.rotation,
    };
    a.iter().zip(b).map(one).collect()
}

const APPROACHES: [Approach; 3] = [Approach::Mean, Approach::Forward, Approach::Reverse];

/// Asserts that plan and general algebra agree; `rounding` is that of the general algebra (mm, rad).
fn agree(machine: &Machine, poses: &[Vec<f64>], order: Order, rounding: [f64; 2]) {
    for approach in APPROACHES {
        let plan = CompiledModel::new(machine, order, approach);
        let general: Vec<_> = poses
            .iter()
            .map(|pose| evaluate(machine, &approach.at_pose(pose), order, Frame::Workpiece).deviation)
            .collect();
        let (size, gap) = (largest(&general), largest(&differences(&planned(&plan, poses), &general)));
        for kind in [0, 1] {
            let tolerance = 1e-12 * size[kind] + rounding[kind];
            assert!(gap[kind] <= tolerance, "{order:?} {approach:?} [{kind}]: {gap:?} of {size:?}\n{machine:?}");
        }
    }
}

fn every_convention(seed: u64, size: f64, linearised: bool, order: Order, rounding: [f64; 2]) {
    let mut random = Random::new(seed);
    for conventions in combinations() {
        let conventions = Conventions { linearised, ..conventions };
        let (machine, poses) = random_machine(&mut random, conventions, size);
        assert!(CompiledModel::new(&machine, order, Approach::Mean).is_compiled());
        agree(&machine, &poses, order, rounding);
    }
}

#[test]
fn first_order_agrees_in_every_convention() {
    every_convention(71, 1e-4, false, Order::Degree(1), [0.0; 2]);
    every_convention(72, 1e-4, true, Order::Degree(1), [0.0; 2]);
}

#[test]
fn second_order_agrees_in_every_convention() {
    // Errors of 5 mrad: the second order is a hundredth of the first, not a ten-thousandth.
    every_convention(73, 5e-3, false, Order::Degree(2), [0.0; 2]);
    every_convention(74, 5e-3, true, Order::Degree(2), [0.0; 2]);
}

/// The general algebra takes the difference of positions of a metre, and of rotations: 2^-53 of them, a few times.
const ROUNDING: [f64; 2] = [2e-12, 2e-15];

#[test]
fn the_exact_model_agrees_in_every_convention() {
    every_convention(75, 1e-4, false, Order::Exact, ROUNDING);
    every_convention(76, 1e-4, true, Order::Exact, ROUNDING);
    every_convention(77, 1e-2, false, Order::Exact, ROUNDING);
    every_convention(78, 1e-2, true, Order::Exact, ROUNDING);
}

/// Widths that this processor has.
fn widths() -> Vec<Width> {
    Width::ALL.into_iter().filter(|width| width.is_supported()).collect()
}

#[test]
fn the_bits_depend_on_no_width_and_no_batch() {
    let mut random = Random::new(81);
    println!("widths: {:?}", widths());
    for (index, conventions) in combinations().enumerate() {
        let conventions = Conventions { linearised: index % 2 == 0, ..conventions };
        let (machine, poses) = random_machine(&mut random, conventions, 1e-3);
        // More than two chunks of the look-up ahead.
        let poses: Vec<Vec<f64>> = poses.iter().cycle().take(77).cloned().collect();
        for order in [Order::Degree(1), Order::Degree(2), Order::Exact] {
            let plan = CompiledModel::new(&machine, order, Approach::Mean);
            let scalar = planned(&plan.clone().with_width(Width::Scalar), &poses);
            let one_by_one: Vec<_> = poses.iter().map(|pose| plan.deviation(pose)).collect();
            assert_eq!(scalar, one_by_one, "{order:?}");
            for width in widths() {
                let plan = plan.clone().with_width(width);
                // Whole vectors and a rest at every width; whole chunks and less.
                for count in [77, 64, 40, 32, 29, 1, 3, 8, 11] {
                    assert_eq!(planned(&plan, &poses[..count]), scalar[..count], "{order:?} {width:?} {count}");
                }
            }
        }
    }
}

#[test]
fn large_batches_have_the_bits_of_small_ones() {
    // Above 2^18 poses deviations are stored past the caches, and from where a cache line begins.
    let count = (1 << 18) + 77;
    let mut random = Random::new(83);
    let (machine, few) = random_machine(&mut random, Conventions::default(), 1e-4);
    let few = columns(&machine, &few);
    let many: Vec<Vec<f64>> =
        few.axes.iter().map(|column| column.iter().copied().cycle().take(count).collect()).collect();
    let plan = CompiledModel::new(&machine, Order::Degree(1), Approach::Mean);
    let mut small = Columns::new(29);
    plan.deviations(&few.batch(), small.output(29));
    for width in widths() {
        let plan = plan.clone().with_width(width);
        let mut out = Columns::new(count);
        // Columns that begin anywhere in a line.
        for skipped in [0, 3] {
            let axes = many.iter().map(|column| &column[skipped..]).collect();
            let (_, room) = out.output(count).split_at(skipped);
            plan.deviations(&Batch::new(axes, count - skipped).unwrap(), room);
            assert!((skipped..count).all(|i| out.get(i) == small.get(i % 29)), "{width:?} {skipped}");
        }
    }
}

/// Pieces of a large batch may be of any length, and begin anywhere in a line.
#[test]
fn the_last_piece_of_a_large_batch_may_be_small() {
    let mut random = Random::new(88);
    let (machine, few) = random_machine(&mut random, Conventions::default(), 1e-4);
    let few = columns(&machine, &few);
    let plan = CompiledModel::new(&machine, Order::Degree(1), Approach::Mean);
    let mut small = Columns::new(29);
    plan.deviations(&few.batch(), small.output(29));
    for (tail, skipped) in (1..=17).zip([0, 1, 2, 3, 4, 5, 6, 7].into_iter().cycle()) {
        // Four blocks, and a rest.
        let count = (1 << 14) + tail;
        let many: Vec<Vec<f64>> =
            few.axes.iter().map(|column| column.iter().copied().cycle().take(count).collect()).collect();
        for width in widths() {
            let mut out = Columns::new(count + skipped);
            let (_, room) = out.output(count + skipped).split_at(skipped);
            let poses = Batch::new(many.iter().map(Vec::as_slice).collect(), count).unwrap();
            plan.clone().with_width(width).deviations_parallel(&poses, room);
            assert!((0..count).all(|i| out.get(skipped + i) == small.get(i % 29)), "{width:?} {tail} {skipped}");
        }
    }
}

#[test]
fn what_no_kernel_covers_goes_through_the_general_algebra() {
    let mut random = Random::new(82);
    for linearised in [false, true] {
        let conventions = Conventions { real: true, linearised, ..Conventions::default() };
        let (machine, poses) = random_machine(&mut random, conventions, 1e-3);
        for order in [Order::Degree(1), Order::Degree(2), Order::Degree(3)] {
            assert!(!CompiledModel::new(&machine, order, Approach::Mean).is_compiled());
            agree(&machine, &poses, order, [0.0; 2]);
        }
        assert!(CompiledModel::new(&machine, Order::Exact, Approach::Mean).is_compiled());
        agree(&machine, &poses, Order::Exact, ROUNDING);
    }
    // Rotations of half a radian: beyond the series.
    let folder = Folder::new();
    let errors: String =
        ["EAX", "EBX", "ECX", "EAY", "EBY", "ECY", "EAZ", "EBZ"].map(|e| format!("{e}: 0.09 rad, ")).concat();
    let text = format!(
        "abbe: 1\nmachine: m\nchain: \"w C' b X Y Z t\"\naxes:\n  X: {{ travel: [0, 500], origin: [0, 0, 0] }}\n  Y: {{ travel: [0, 500], origin: [0, 0, 0] }}\n  Z: {{ travel: [0, 500], origin: [0, 0, 0] }}\n  C: {{ travel: continuous }}\nerrors: {{ {errors} ECZ: {{ polynomial: [0 rad, 0.0001 rad/mm] }} }}\n"
    );
    let machine = crate::loaded::machine(&folder.write("machine.yaml", &text));
    let poses = abbe::evaluate::random_poses(&machine, 29, 1);
    let turned = planned(&CompiledModel::new(&machine, Order::Exact, Approach::Mean), &poses);
    assert!(turned.iter().all(|d| d.rotation.norm() > 0.35), "{turned:?}");
    agree(&machine, &poses, Order::Exact, ROUNDING);
    // Then a grid is no more than its nodes.
    assert!(CompiledModel::new(&machine, Order::Exact, Approach::Mean).grid(&nodes(&machine)).is_none());
}

/// Linear and cubic B-splines are compiled with the tables beside them; the second derivatives of quadratic ones jump.
#[test]
fn b_splines_run_with_the_tables() {
    let knots = "knots: [0, 120, 500], coefficients: [3 um, -2 um, 4 um";
    let errors = |degree: u8, more: &str| {
        format!(
            "errors:\n  EXX: {{ bspline: {{ degree: {degree}, {knots}{more}] }} }}\n  EYX: {{ points: [[0, 1 um], [200, 2 um], [500, 0 um]] }}\n  EBX: {{ points: [[0, 1 urad], [200, 9 urad], [500, 0 urad]], interpolation: cubic }}\n  ECC: {{ bspline: {{ degree: {degree}, knots: [0, 50, 200, 360], coefficients: [3 urad, 20 urad, -10 urad] }} }}\n"
        )
    };
    for (degree, more, compiled) in [(1, "", true), (2, ", 5 um", false), (3, ", 5 um, -1 um", true)] {
        let machine = five(&errors(degree, more));
        let poses = five_poses(&mut Random::new(74), 60);
        for order in [Order::Degree(1), Order::Degree(2), Order::Exact] {
            assert_eq!(CompiledModel::new(&machine, order, Approach::Mean).is_compiled(), compiled);
            agree(&machine, &poses, order, [2e-12, 1e-15]);
        }
    }
}

/// Computed from both sides of the seam, the second derivative differs by rounding: that is no reason to leave it out.
#[test]
fn b_splines_of_continuous_axes_are_smooth_at_the_seam() {
    let mut random = Random::new(75);
    for _ in 0..20 {
        let mut inner: Vec<f64> = (0..3).map(|_| random.between(10.0, 350.0)).collect();
        inner.sort_by(f64::total_cmp);
        let [a, b, c] = [inner[0], inner[1] + 1.0, inner[2] + 2.0];
        let machine = five(&format!(
            "errors:\n  EXC: {{ bspline: {{ degree: 3, knots: [0 deg, {a} deg, {b} deg, {c} deg, 360 deg], coefficients: [1 um, 4 um, -4 um, -2 um] }} }}\n"
        ));
        let poses = five_poses(&mut random, 60);
        for order in [Order::Degree(1), Order::Degree(2), Order::Exact] {
            agree(&machine, &poses, order, [2e-12, 1e-15]);
        }
    }
}

/// A step between two knots that all but coincide stays one, also where the knots of another curve lie between.
#[test]
fn steps_between_knots_are_kept() {
    for (gap, other) in [(1e-12, ""), (2e-12, ""), (3e-12, "400.0000000000025"), (1e-9, "400")] {
        let more = if other.is_empty() {
            String::new()
        } else {
            format!("  EYX: {{ points: [[0, 1 um], [{other}, 2 um], [500, 0 um]] }}\n")
        };
        let machine = five(&format!(
            "errors:\n  EXX: {{ points: [[0, 0 um], [400, 0 um], [{}, 10 um], [500, 10 um]] }}\n{more}",
            400.0 + gap
        ));
        let poses = five_poses(&mut Random::new(76), 60);
        for order in [Order::Degree(1), Order::Exact] {
            agree(&machine, &poses, order, [2e-12, 1e-15]);
        }
    }
}

#[test]
fn sensitivities_are_those_of_the_general_algebra() {
    let mut random = Random::new(83);
    for (index, conventions) in combinations().enumerate() {
        let conventions = Conventions { linearised: index % 2 == 0, ..conventions };
        let (machine, poses) = random_machine(&mut random, conventions, 1e-3);
        for pose in &poses {
            for found in sensitivities(&machine, pose, |_| true) {
                let [deviation, rotation] = unit_response(&machine, pose, &found.error);
                // Positions of a metre, rotations of one.
                let gap = [found.deviation - deviation, found.rotation - rotation].map(|v| v.amax());
                assert!(gap[0] < 1e-12 * 1e3 && gap[1] < 1e-14, "{:?} {gap:?}", found.error);
            }
        }
    }
}

#[test]
fn commands_are_those_of_the_general_algebra() {
    let mut random = Random::new(85);
    for (index, conventions) in combinations().enumerate() {
        let conventions = Conventions { linearised: index % 2 == 0, ..conventions };
        let (machine, poses) = random_machine(&mut random, conventions, 1e-4);
        let added: Vec<Vec<f64>> =
            poses.iter().map(|pose| pose.iter().map(|_| random.around(0.05)).collect()).collect();
        let plan = CompiledModel::new(&machine, Order::Exact, Approach::Mean);
        let mut out = Columns::new(poses.len());
        let (at, by) = (columns(&machine, &poses), columns(&machine, &added));
        plan.commanded(&at.batch(), &by.batch(), out.output(poses.len())).unwrap();
        for (i, (pose, added)) in poses.iter().zip(&added).enumerate() {
            let command: Vec<f64> = pose.iter().zip(added).map(|(q, c)| q + c).collect();
            let expected =
                command_deviation(&machine, &NominalPose::at(&machine, pose).pose, &Approach::Mean.at_pose(&command));
            let gap = [out.get(i).position - expected.position, out.get(i).rotation - expected.rotation];
            let gap = gap.map(|v| v.amax());
            // Positions of a metre; curves are looked up at the sum, which is rounded.
            assert!(gap[0] < 4e-12 && gap[1] < 4e-15, "{gap:?} {conventions:?}");
        }
    }
}

fn nodes(machine: &Machine) -> Nodes {
    let volume: Vec<Grid> = machine
        .volume()
        .iter()
        .enumerate()
        .map(|(k, grid)| Grid { step: (grid.max - grid.min) / [2.0, 3.0, 1.0, 4.0][k % 4] * 1.01, ..*grid })
        .collect();
    Nodes::new(&volume)
}

/// Deviations at the nodes of a grid from a line on.
fn filled(plan: &CompiledModel, nodes: &Nodes, first: usize) -> Vec<Deviation> {
    let grid = plan.grid(nodes).unwrap();
    assert_eq!(grid.lines() * grid.line(), nodes.len());
    let mut out = Columns::new(nodes.len() - first * grid.line());
    let len = out.len();
    grid.fill_parallel(first, out.output(len));
    (0..len).map(|i| out.get(i)).collect()
}

/// Up to rounding; and the same bits from any line on and at any width.
fn grid_agrees(machine: &Machine, order: Order) {
    let nodes = nodes(machine);
    let poses: Vec<Vec<f64>> = (0..nodes.len()).map(|i| nodes.get(i)).collect();
    for approach in APPROACHES {
        let plan = CompiledModel::new(machine, order, approach);
        let (scattered, whole) = (planned(&plan, &poses), filled(&plan, &nodes, 0));
        let (size, gap) = (largest(&scattered), largest(&differences(&whole, &scattered)));
        assert!(gap[0] <= 1e-12 * size[0] && gap[1] <= 1e-12 * size[1], "{gap:?} of {size:?}");
        let grid = plan.grid(&nodes).unwrap();
        let half = grid.lines() / 2;
        assert_eq!(filled(&plan, &nodes, half), whole[half * grid.line()..]);
        for width in widths() {
            assert_eq!(filled(&plan.clone().with_width(width), &nodes, 0), whole, "{order:?} {width:?}");
        }
    }
}

#[test]
fn grids_are_the_nodes_one_by_one() {
    let mut random = Random::new(86);
    for (index, conventions) in combinations().enumerate() {
        let conventions = Conventions { linearised: index % 2 == 0, ..conventions };
        // With 10 mrad too, so that products of errors count.
        for size in [1e-4, 1e-2] {
            let (machine, _) = random_machine(&mut random, conventions, size);
            for order in [Order::Degree(1), Order::Degree(2), Order::Exact] {
                grid_agrees(&machine, order);
            }
        }
    }
}

/// Grids have points a metre apart; the points must not depend on the size of the machine, nor on its zero point.
#[test]
fn grids_of_any_size_and_place() {
    for (size, away) in [(1e-3, 0.0), (1e-3, 700.0), (1.0, 20_000.0), (1.0, 300_000.0), (60.0, 0.0)] {
        let at = |[x, y, z]: [f64; 3]| format!("[{}, {}, {}]", away + size * x, away + size * y, size * z - away);
        let way = |low: f64, high: f64| format!("[{} mm, {} mm]", size * low, size * high);
        let text = format!(
            "abbe: 1\nmachine: m\nchain: \"w C' A' Y' b X Z t\"\naxes:\n  X: {{ travel: {}, origin: [0, 0, 0] }}\n  Y: {{ travel: {}, origin: [0, 0, 0] }}\n  Z: {{ travel: {}, origin: [0, 0, 0] }}\n  A: {{ travel: [-120 deg, 30 deg], origin: {} }}\n  C: {{ travel: continuous, origin: {} }}\ntool: {{ gauge: {}, length: {} mm }}\nworkpiece: {{ origin: {} }}\nerrors:\n  EC0Y: 21 urad\n  EB0A: 24 urad\n  EX0C: 6 um\n  EAX: {{ points: [[{} mm, 3 urad], [{} mm, -8 urad]] }}\n  ECZ: {{ polynomial: [3 urad, 0.1 urad/mm] }}\n  EBC: {{ harmonics: {{ 1: [5 urad, 9 urad] }} }}\n  EZA: {{ harmonics: {{ 2: [4 um, 1 um] }} }}\n",
            way(0.0, 500.0),
            way(0.0, 450.0),
            way(-400.0, 0.0),
            at([250.0, 225.0, -350.0]),
            at([250.0, 225.0, -380.0]),
            at([250.0, 225.0, 0.0]),
            120.0 * size,
            at([250.0, 225.0, -380.0]),
            0.0,
            500.0 * size
        );
        let folder = Folder::new();
        let machine = crate::loaded::machine(&folder.write("machine.yaml", &text));
        for order in [Order::Degree(1), Order::Degree(2), Order::Exact] {
            grid_agrees(&machine, order);
        }
    }
}

#[test]
fn a_survey_is_a_map_that_is_not_kept() {
    let mut random = Random::new(87);
    for order in [Order::Degree(1), Order::Exact] {
        let (machine, _) = random_machine(&mut random, Conventions::default(), 1e-4);
        let field = CompiledField::new(&machine, order);
        let grid = Poses::Nodes(nodes(&machine));
        for (poses, frame) in [
            (grid.clone(), Frame::Workpiece),
            (grid, Frame::Tool),
            (Poses::Random(abbe::evaluate::Random::of(&machine, 40_000, 3)), Frame::Machine),
        ] {
            let view = View { frame, ..View::default() };
            let kept = map(&field, &poses, view, &|_| Ok(())).unwrap();
            let survey = || survey(SurveyTask { field: &field, poses: &poses, view, worst: 4 }, &|_| Ok(())).unwrap();
            let found = survey();
            assert_eq!(found.statistics.poses, poses.len());
            let close =
                |a: f64, b: f64, tolerance: f64| assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b} {frame:?}");
            for (a, b) in [
                (found.statistics.position_um, kept.statistics.position_um),
                (found.statistics.rotation_urad, kept.statistics.rotation_urad),
            ] {
                close(a.max, b.max, 1e-11);
                close(a.mean, b.mean, 1e-11);
                close(a.rms, b.rms, 1e-11);
                close(a.p95, b.p95, Tally::QUANTILE_ERROR + 1e-11);
                (0..3).for_each(|k| close(a.range[k], b.range[k], 1e-11));
            }
            let general = Bare { machine: &machine, order };
            for (index, deviation) in &found.worst {
                let expected = deviation_in(&general, &poses.get(*index), view);
                assert!((deviation.position - expected.position).amax() < 4e-12, "{frame:?}");
            }
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert_eq!(alone.install(survey), found);
        }
    }
}

#[test]
fn corrections_in_batches_are_those_one_by_one() {
    for name in ["trunnion", "hh-bd-ram", "ht-nut45-c", "vmc-cframe-754", "millturn-bc"] {
        let machine = crate::loaded::machine(&crate::support::config(&format!("{name}.yaml")));
        let plan = CompiledModel::new(&machine, Order::Exact, Approach::Mean);
        let poses = abbe::evaluate::random_poses(&machine, 40, 5);
        for scope in [Scope::POSITION, Scope { goal: Goal::Pose, rotary: true, damping: 0.05 }] {
            let all = correct_all(&plan, &poses, scope).unwrap();
            assert_eq!(all.len(), poses.len());
            for (pose, found) in poses.iter().zip(&all) {
                let one = correct(&machine, &Approach::Mean.at_pose(pose), scope);
                let gaps = one.correction.0.iter().zip(&found.correction.0).map(|(a, b)| (a - b).abs());
                // mm and deg; the rounding of positions, and the last step of an iteration that contracts by 1e-4.
                assert!(gaps.fold(0.0, f64::max) < 1e-9, "{name} {scope:?} {pose:?}: {one:?} {found:?}");
                assert!((one.residual.position - found.residual.position).amax() < 1e-10, "{name} {scope:?}");
            }
        }
        let first = CompiledModel::new(&machine, Order::Degree(1), Approach::Mean);
        assert!(correct_all(&first, &poses, Scope::POSITION).is_none());
    }
}
