//! `eval --order exact` against the independent rigid-body model, on random machines in every convention.

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::matrix::{V3, minus, norm};
use crate::oracle::program::{Ask, DEFAULT, Folder, eval};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Answer, Conventions, Frame};
use crate::oracle::yaml;

/// The largest differences met: mm, rad, and of the two blocks of the error matrix.
#[derive(Debug, Default)]
struct Differences {
    nominal: f64,
    deviation: f64,
    rotation: f64,
    turn: f64,
    shift: f64,
}

impl Differences {
    fn take(&mut self, ours: &Answer, theirs: &Answer) {
        let apart = |a: V3, b: V3| norm(minus(a, b));
        self.nominal = self.nominal.max(apart(ours.nominal, theirs.nominal));
        self.deviation = self.deviation.max(apart(ours.deviation, theirs.deviation));
        self.rotation = self.rotation.max(apart(ours.rotation, theirs.rotation));
        for (row, other) in ours.e_ve.iter().zip(&theirs.e_ve) {
            let turn = (0..3).map(|c| (row[c] - other[c]).abs()).fold(0.0, f64::max);
            self.turn = self.turn.max(turn);
            self.shift = self.shift.max((row[3] - other[3]).abs());
        }
    }

    /// Lengths of some metres and up to six squared turns: both sides keep about twelve decimals of a mm.
    fn hold(&self) -> bool {
        let lengths = [self.nominal, self.deviation, self.shift];
        lengths.iter().all(|d| *d < 1e-9) && self.rotation < 1e-12 && self.turn < 1e-12
    }
}

/// Compares program and oracle at some poses of a machine.
fn compare(sample: &Sample, random: &mut Random, poses: usize, ask: Ask) -> Differences {
    let folder = Folder::new();
    let text = yaml::write(sample, &folder);
    let names: Vec<_> = sample.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
    let poses = sample.poses(random, poses);
    let theirs = eval(&folder.path("machine.yaml"), &names, &poses, ask);
    let mut differences = Differences::default();
    for (pose, theirs) in poses.iter().zip(&theirs) {
        let ours = sample.evaluate(pose, ask.travel, ask.frame);
        differences.take(&ours, theirs);
        assert!(differences.hold(), "{text}\n{names:?} at {pose:?}, {:?} {:?}\nmodel {ours:?}\nprogram {theirs:?}\n{differences:?}", ask.frame, ask.travel);
    }
    differences
}

const FRAMES: [Frame; 3] = [Frame::Workpiece, Frame::Machine, Frame::Tool];
const TRAVELS: [Travel; 3] = [Travel::Mean, Travel::Forward, Travel::Reverse];

/// Machines of all combinations of conventions; frames and directions of travel take turns.
fn all_combinations(seed: u64, each: usize, size: f64, change: impl Fn(&mut Conventions)) {
    let mut random = Random::new(seed);
    for (number, mut conventions) in combinations().enumerate() {
        change(&mut conventions);
        for turn in 0..each {
            let sample = Sample::random(&mut random, conventions, size);
            let (frame, travel) = (FRAMES[(number + turn) % 3], TRAVELS[(number / 3 + turn) % 3]);
            compare(&sample, &mut random, 8, Ask { frame, travel, ..DEFAULT });
        }
    }
}

#[test]
fn orthogonal_joints_in_every_convention() {
    all_combinations(1, 6, 1e-4, |_| {});
}

#[test]
fn linearised_joints_in_every_convention() {
    all_combinations(2, 6, 1e-4, |c| c.linearised = true);
}

/// A truncated series of any order would show: the errors are a tenth of a radian and of a metre.
#[test]
fn exact_is_exact_for_enormous_errors() {
    all_combinations(3, 2, 0.05, |_| {});
    all_combinations(4, 2, 0.05, |c| c.linearised = true);
}

/// The degree at which location errors count does not touch the exact model.
#[test]
fn the_order_of_location_errors_does_not_matter() {
    all_combinations(5, 2, 1e-3, |c| c.real = true);
}

#[test]
fn every_frame_and_direction_of_one_machine() {
    let mut random = Random::new(6);
    for _ in 0..4 {
        let sample = Sample::random(&mut random, Conventions::default(), 1e-4);
        for (frame, travel) in FRAMES.into_iter().flat_map(|frame| TRAVELS.map(|travel| (frame, travel))) {
            compare(&sample, &mut random, 8, Ask { frame, travel, ..DEFAULT });
        }
    }
}
