//! `eval --order exact` against the independent rigid-body model, on random machines in every convention.

use crate::oracle::curves::Travel;
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::matrix::{V3, minus, norm};
use crate::oracle::program::{Ask, DEFAULT, Folder, eval};
use crate::oracle::random::Random;
use crate::oracle::rigid::{Answer, Axis, Conventions, Frame};
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

    /// Rounding of some metres and of numbers near one, a few times over in six squared exponentials.
    /// Found: 5e-12 mm in nominal positions, 2e-12 in the others, 2e-15 rad.
    fn hold(&self) -> bool {
        let lengths = [self.nominal, self.deviation, self.shift];
        lengths.iter().all(|d| *d < 2e-11) && self.rotation < 1e-14 && self.turn < 1e-14
    }
}

const POSES: usize = 8;

/// Compares program and oracle at some poses of a machine.
fn compare(sample: &Sample, random: &mut Random, ask: Ask) {
    let folder = Folder::new();
    let text = yaml::write(sample, &folder);
    let names: Vec<_> = sample.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
    let poses = sample.poses(random, POSES);
    let theirs = eval(&folder.path("machine.yaml"), &names, &poses, ask);
    let mut differences = Differences::default();
    for (pose, theirs) in poses.iter().zip(&theirs) {
        let ours = sample.evaluate(pose, ask.travel, ask.frame);
        differences.take(&ours, theirs);
        let asked = (ask.frame, ask.travel);
        assert!(
            differences.hold(),
            "{text}\n{names:?} at {pose:?}, {asked:?}\nmodel {ours:?}\nprogram {theirs:?}\n{differences:?}"
        );
    }
}

const FRAMES: [Frame; 3] = [Frame::Workpiece, Frame::Machine, Frame::Tool];
const TRAVELS: [Travel; 3] = [Travel::Mean, Travel::Forward, Travel::Reverse];

/// Machines of all combinations of conventions; frames and directions of travel take turns.
fn all_combinations(seed: u64, each: usize, size: f64, change: impl Fn(&mut Conventions)) {
    let mut random = Random::new(seed);
    for (number, mut conventions) in combinations().enumerate() {
        change(&mut conventions);
        for turn in 0..each {
            let mut sample = Sample::random(&mut random, conventions, size);
            if turn % 2 == 1 {
                sample.rigid.workpiece_rotation = random.vector(180.0);
            }
            let (frame, travel) = (FRAMES[(number + turn) % 3], TRAVELS[(number / 3 + turn) % 3]);
            compare(&sample, &mut random, Ask { frame, travel, ..DEFAULT });
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

/// A truncated series of any order would show: the errors are as large as the program takes them.
#[test]
fn exact_is_exact_for_enormous_errors() {
    let mut random = Random::new(3);
    let mut seen = 0.0;
    for conventions in combinations() {
        for linearised in [false, true] {
            let conventions = Conventions { linearised, ..conventions };
            let sample = Sample::random(&mut random, conventions, 0.012).scaled(1.0, 8.0);
            compare(&sample, &mut random, DEFAULT);
            seen += f64::from(u8::from(order_six_shows(&sample, &mut random)));
        }
    }
    assert!(seen > 60.0, "only {seen} of 64 machines tell order 6 from exact");
}

/// True if the highest order of the program is far enough from the exact model to be noticed.
fn order_six_shows(sample: &Sample, random: &mut Random) -> bool {
    let folder = Folder::new();
    yaml::write(sample, &folder);
    let names: Vec<_> = sample.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
    let poses = sample.poses(random, POSES);
    let mut differences = Differences::default();
    for (pose, theirs) in
        poses.iter().zip(eval(&folder.path("machine.yaml"), &names, &poses, Ask { order: Some("6"), ..DEFAULT }))
    {
        differences.take(&sample.evaluate(pose, Travel::Mean, Frame::Workpiece), &theirs);
    }
    !differences.hold()
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
            compare(&sample, &mut random, Ask { frame, travel, ..DEFAULT });
        }
    }
}

/// A preset is its list of conventions, and any of them can be amended.
#[test]
fn presets() {
    let orthogonal = Conventions { real: true, ..Conventions::default() };
    let holub = Conventions { linearised: true, ..orthogonal };
    let hrdina = Conventions { before: true, linearised: true, ..Conventions::default() };
    let kimm = Conventions { carried_body: true, direct: true, body: true, linearised: true, ..Conventions::default() };
    let presets = [
        ("holub-2015", holub),
        ("hrdina-vasik-2014", hrdina),
        ("bui-kimm", kimm),
        ("{ preset: holub-2015, joints: orthogonal }", orthogonal),
    ];
    let mut random = Random::new(9);
    for (preset, conventions) in presets {
        let sample = Sample::random(&mut random, conventions, 1e-3);
        let folder = Folder::new();
        let text = yaml::write(&sample, &folder);
        let keys = text.lines().find(|line| line.starts_with("conventions:")).unwrap();
        let machine = folder.write("preset.yaml", &text.replace(keys, &format!("conventions: {preset}")));
        let names: Vec<_> = sample.rigid.walk.iter().map(|axis| axis.name.as_str()).collect();
        let poses = sample.poses(&mut random, POSES);
        for order in ["1", "2", "exact"] {
            let [named, spelt] = [&machine, &folder.path("machine.yaml")]
                .map(|file| eval(file, &names, &poses, Ask { order: Some(order), ..DEFAULT }));
            assert_eq!(format!("{named:?}"), format!("{spelt:?}"), "{preset}, order {order}");
        }
    }
}

/// The columns of the poses come in any order, some with a unit; axes without one are at zero.
#[test]
fn columns_of_the_poses() {
    let mut random = Random::new(7);
    for _ in 0..8 {
        let sample = Sample::random(&mut random, Conventions::default(), 1e-4);
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let heading = |axis: &Axis| format!("{} [{}]", axis.name, if axis.rotary { "deg" } else { "mm" });
        let mut columns: Vec<_> = sample.rigid.walk.iter().map(heading).enumerate().collect();
        random.shuffle(&mut columns);
        let (absent, _) = columns.pop().unwrap();
        let mut poses = sample.poses(&mut random, POSES);
        poses.iter_mut().for_each(|pose| pose[absent] = 0.0);
        let written: Vec<_> = poses.iter().map(|pose| columns.iter().map(|(i, _)| pose[*i]).collect()).collect();
        let names: Vec<_> = columns.iter().map(|(_, name)| name).collect();
        let mut differences = Differences::default();
        for (pose, theirs) in poses.iter().zip(eval(&folder.path("machine.yaml"), &names, &written, DEFAULT)) {
            differences.take(&sample.evaluate(pose, Travel::Mean, Frame::Workpiece), &theirs);
        }
        assert!(differences.hold(), "{names:?}: {differences:?}");
    }
}

/// Conventions that do not differ make a comparison empty: each key changes the model's answers.
#[test]
fn every_convention_matters() {
    let mut random = Random::new(8);
    let sample = mixed(&mut random);
    let poses = sample.poses(&mut random, POSES);
    let deviations = |conventions: Conventions| {
        let mut sample = sample.clone();
        sample.rigid.conventions = conventions;
        poses
            .iter()
            .flat_map(|pose| sample.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation)
            .collect::<Vec<_>>()
    };
    let answers: Vec<_> = combinations()
        .flat_map(|c| [false, true].map(|linearised| deviations(Conventions { linearised, ..c })))
        .collect();
    for (i, one) in answers.iter().enumerate() {
        for other in &answers[..i] {
            let gap = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(gap > 1e-6, "two combinations of conventions differ by {gap:e} mm only");
        }
    }
}

/// A machine with linear and rotary axes on both sides and location errors on all.
fn mixed(random: &mut Random) -> Sample {
    loop {
        let sample = Sample::random(random, Conventions::default(), 1e-3);
        let has = |rotary, workpiece| {
            let alike = |axis: &&Axis| axis.rotary == rotary && axis.workpiece == workpiece;
            sample.rigid.walk.iter().filter(alike).any(|axis| axis.location[5] != 0.0 && axis.direct.is_none())
        };
        if [(false, false), (false, true), (true, false), (true, true)].iter().all(|&(r, w)| has(r, w)) {
            return sample;
        }
    }
}
