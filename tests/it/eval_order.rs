//! `eval --order n` against the exact model: its truncation error falls with the (n+1)-th power of the errors, and it
//! is a polynomial of degree n in them.

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample, combinations};
use crate::oracle::program::{Ask, DEFAULT, Folder, eval};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Answer, Conventions, Frame};
use crate::oracle::yaml;

const ORDERS: [&str; 6] = ["1", "2", "3", "4", "5", "6"];

/// All lengths of the answers (mm), then all angles (rad).
type Numbers = [Vec<f64>; 2];

fn numbers(answers: &[Answer]) -> Numbers {
    let lengths = answers.iter().flat_map(|a| a.deviation.into_iter().chain((0..3).map(|r| a.e_ve[r][3])));
    let block = |a: &Answer| (0..9).map(|k| a.e_ve[k / 3][k % 3]).collect::<Vec<_>>();
    let angles = answers.iter().flat_map(|a| a.rotation.into_iter().chain(block(a)));
    [lengths.collect(), angles.collect()]
}

/// The root of the sum of squares.
fn size(list: &[f64]) -> f64 {
    list.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    size(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

/// A machine on which orders are compared at some poses.
struct Subject {
    sample: Sample,
    poses: Vec<Pose>,
    frame: Frame,
}

impl Subject {
    fn random(random: &mut Random, conventions: Conventions, size: f64) -> Self {
        let sample = Sample::random(random, conventions, size);
        let poses = sample.poses(random, 6);
        let frame = [Frame::Workpiece, Frame::Machine, Frame::Tool][random.below(3)];
        Self { sample, poses, frame }
    }

    /// The program's answers of the first orders for the machine with scaled errors.
    fn program(&self, sample: &Sample, orders: &[&str]) -> Vec<Numbers> {
        let folder = Folder::new();
        yaml::write(sample, &folder);
        let names: Vec<_> = sample.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
        let machine = folder.path("machine.yaml");
        let ask = |order| Ask { order: Some(order), frame: self.frame, ..DEFAULT };
        orders.iter().map(|order| numbers(&eval(&machine, &names, &self.poses, ask(order)))).collect()
    }

    fn exact(&self, sample: &Sample) -> Numbers {
        let answers: Vec<_> = self.poses.iter().map(|pose| sample.evaluate(pose, Travel::Mean, self.frame)).collect();
        numbers(&answers)
    }

    /// Truncation error of each order at each of the machines: [machine][order][lengths, angles].
    fn left(&self, machines: &[Sample], orders: &[&str]) -> Vec<Vec<[f64; 2]>> {
        let gap = |theirs: &Numbers, ours: &Numbers| [0, 1].map(|kind| distance(&theirs[kind], &ours[kind]));
        let of_machine = |sample: &Sample| {
            let ours = self.exact(sample);
            self.program(sample, orders).iter().map(|theirs| gap(theirs, &ours)).collect()
        };
        machines.iter().map(of_machine).collect()
    }
}

/// The exponent with which the last halving of the errors made the rest fall.
fn exponent(rests: &[f64]) -> f64 {
    let [.., before, after] = rests else { panic!("two sizes are needed") };
    (before / after).log2()
}

/// Asserts the exponents n + 1 on machines whose errors are halved again and again.
fn converges(subject: &Subject, machines: &[Sample], orders: &[&str], tolerance: f64) {
    let left = subject.left(machines, orders);
    for (index, order) in orders.iter().enumerate() {
        for kind in [0, 1] {
            let rests: Vec<_> = left.iter().map(|machine| machine[index][kind]).collect();
            let (found, expected) = (exponent(&rests), (index + 2) as f64);
            let what = ["lengths", "angles"][kind];
            let conventions = subject.sample.rigid.conventions;
            assert!(
                (found - expected).abs() < tolerance,
                "order {order}, {what}: exponent {found}, rests {rests:?}\n{conventions:?}"
            );
        }
    }
}

/// The next power of errors of some mrad, and the rounding below the rest of order 3; found 0.0034.
const TOLERANCE: f64 = 0.01;

fn every_combination(seed: u64, change: impl Fn(&mut Conventions)) {
    let mut random = Random::new(seed);
    for mut conventions in combinations() {
        change(&mut conventions);
        let subject = Subject::random(&mut random, conventions, 4e-3);
        converges(&subject, &[0.5, 0.25].map(|s| subject.sample.scaled(s, s)), &ORDERS[..3], TOLERANCE);
    }
}

#[test]
fn orthogonal_joints_converge_in_every_convention() {
    every_combination(11, |_| {});
}

#[test]
fn linearised_joints_converge_in_every_convention() {
    every_combination(12, |c| c.linearised = true);
}

/// Higher orders need larger errors to be seen above the rounding, and those have a larger next power: found 0.009.
#[test]
fn orders_up_to_six_converge() {
    let mut random = Random::new(13);
    for linearised in [false, true] {
        for conventions in combinations().step_by(7) {
            let subject = Subject::random(&mut random, Conventions { linearised, ..conventions }, 1e-2);
            let machines = [1.0, 0.5].map(|s| subject.sample.scaled(s, 5.0 * s));
            converges(&subject, &machines, &ORDERS, 0.02);
        }
    }
}

/// A product that was not cut would converge as well; its differences of the next order would not vanish.
#[test]
fn order_n_is_a_polynomial_of_degree_n_in_the_errors() {
    let mut random = Random::new(14);
    for (linearised, real) in [(false, false), (true, false), (false, true), (true, true)] {
        for conventions in combinations().step_by(5) {
            let subject = Subject::random(&mut random, Conventions { linearised, real, ..conventions }, 4e-3);
            // Under `real` only the component errors are cut.
            let machine = |k: usize| subject.sample.scaled(k as f64 / 4.0, if real { 1.0 } else { k as f64 / 4.0 });
            let answers: Vec<_> = (0..=4).map(|k| subject.program(&machine(k), &ORDERS[..3])).collect();
            for order in 1..=3 {
                let rows: Vec<_> = answers.iter().map(|orders| &orders[order - 1]).collect();
                vanishes(&rows, order + 1, real);
            }
        }
    }
}

/// Asserts that the differences of some order vanish, and that those of one order less do not.
fn vanishes(rows: &[&Numbers], order: usize, real: bool) {
    for (kind, tolerance) in [(0, 5e-13), (1, 5e-16)] {
        let at_zero = size(&rows[0][kind]);
        assert!(real || at_zero == 0.0, "errors of size zero give {at_zero}");
        let [higher, lower] = [order, order - 1].map(|order| {
            let values: Vec<_> = rows.iter().map(|row| row[kind].clone()).collect();
            size(&(0..order).fold(values, |v, _| differences(&v))[0])
        });
        // Sixteen times the rounding of answers of some mm and mrad; found 2e-14 and 3e-17.
        assert!(higher < tolerance, "order {}: {higher:e}, one order less: {lower:e}", order - 1);
        assert!(lower > 100.0 * tolerance, "order {}: nothing to see, {lower:e}", order - 1);
    }
}

fn differences(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    rows.windows(2).map(|pair| pair[1].iter().zip(&pair[0]).map(|(b, a)| b - a).collect()).collect()
}

fn real(linearised: bool, conventions: Conventions) -> Conventions {
    Conventions { real: true, linearised, ..conventions }
}

/// With `location_order: real` location errors are never cut: alone, they are exact at any order.
#[test]
fn real_location_errors_are_exact_at_order_one() {
    let mut random = Random::new(15);
    for (index, conventions) in combinations().enumerate() {
        let subject = Subject::random(&mut random, real(index % 2 == 0, conventions), 1e-2);
        let located = subject.sample.scaled(0.0, 1.0);
        let (ours, theirs) = (subject.exact(&located), subject.program(&located, &ORDERS[..1]));
        for (kind, tolerance) in [(0, 2e-11), (1, 5e-14)] {
            // As the exact model; found 2e-12 mm and 3e-15 rad.
            let gap = distance(&ours[kind], &theirs[0][kind]);
            assert!(gap < tolerance, "{gap:e} {conventions:?}\n{located:?}");
        }
    }
}

/// With `location_order: real` the component errors alone are halved, the location errors stay.
#[test]
fn component_errors_converge_beside_real_location_errors() {
    let mut random = Random::new(16);
    for (index, conventions) in combinations().enumerate() {
        let subject = Subject::random(&mut random, real(index % 2 == 1, conventions), 4e-3);
        let machines = [0.5, 0.25].map(|s| subject.sample.scaled(s, 1.0));
        converges(&subject, &machines, &ORDERS[..3], TOLERANCE);
    }
}
