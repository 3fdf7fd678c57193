//! Intervals less the rigid motions that the data do not hold: a multilateration of a machine of the oracle, whose
//! workpiece frame nothing says. The true deviations come from the tests' rigid body.

use super::identify::normal;
use super::measurements::actual;
use super::oracle::curves::{Curve, Error};
use super::oracle::machines::Sample;
use super::oracle::random::Random;
use super::program::Folder;
use super::support::config::sample;
use abbe::options::{MapPoses, Reference, ReferenceKind};
use abbe::results::PoseResult;
use abbe::{
    EvalOptions, IdentifyOptions, LoadOptions, MachineFile, MapOptions, Run, compare, eval, identify, loads, map,
};
use nalgebra::{DMatrix, DVector, Vector3};

const THREE: &str = "abbe: 1\nmachine: Three\nchain: \"w b X Y Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm] }\n  Y: { travel: [0 mm, 400 mm] }\n  Z: { travel: [-300 mm, 0 mm] }\ntool: { length: 80 mm }\n";
const STATIONS: [[f64; 3]; 4] =
    [[-200.0, -150.0, -500.0], [700.0, -200.0, -100.0], [-100.0, 600.0, 200.0], [600.0, 500.0, -600.0]];

/// Standard deviation of a length (mm).
const NOISE: f64 = 1e-3;

/// The machine without errors.
fn blank() -> Sample {
    sample(&Folder::new("unheld").with("three.yaml", THREE))
}

/// The machine with random polynomials for all errors: cubic displacements of 8 um, parabolic rotations of 15 urad.
fn real(blank: &Sample, random: &mut Random) -> Sample {
    let mut machine = blank.clone();
    for axis in &mut machine.axes {
        let [low, high] = axis.travel.unwrap();
        for (k, error) in axis.errors.iter_mut().enumerate() {
            let (size, degree) = if k < 3 { (8e-3, 3) } else { (15e-6, 2) };
            let coefficients = (0..=degree).map(|i| size * normal(random) / (high - low).powi(i)).collect();
            *error = Some(Error { forward: Curve::Polynomial(coefficients), reverse: None });
        }
    }
    machine
}

/// Displacements from four stations of unknown place, with dead paths.
fn lengths(real: &Sample, random: &mut Random) -> String {
    let mut text = "X,Y,Z,station,run,displacement [mm]\n".to_owned();
    for (s, station) in STATIONS.iter().enumerate() {
        for i in 0..80 {
            let pose = [125.0 * f64::from(i % 5), 133.0 * f64::from(i / 5 % 4), -100.0 * f64::from(i / 20)];
            let read = (actual(real, &pose) - Vector3::from(*station)).norm() - 40.0 + NOISE * normal(random);
            text += &format!("{},{},{},S{s},r{s},{read}\n", pose[0], pose[1], pose[2]);
        }
    }
    text
}

/// The machine that is fitted to lengths in a datum.
fn fitted(lengths: &str, datum: &str) -> MachineFile {
    let curves = ["X", "Y", "Z"].iter().flat_map(|axis| {
        ["X", "Y", "Z", "A", "B", "C"].map(|d| format!("E{d}{axis}:poly{}", if "XYZ".contains(d) { 3 } else { 2 }))
    });
    let options = IdentifyOptions {
        texts: vec![("lengths.csv".to_owned(), lengths.to_owned())],
        fit: curves.chain(["EC0Y", "EB0Z", "EA0Z"].map(str::to_owned)).collect(),
        machine_file: true,
        ..IdentifyOptions::default()
    };
    let machine = loads(&format!("{THREE}{datum}"), &LoadOptions::default(), Run::default()).unwrap().value;
    let found = identify(&machine, &options, Run::default()).unwrap_or_else(|why| panic!("{datum}: {why:?}")).value;
    loads(&found.machine_file.unwrap(), &LoadOptions::default(), Run::default()).unwrap().value
}

/// Components within their interval, and the sizes of errors and intervals.
#[derive(Debug, Default)]
struct Coverage {
    within: f64,
    count: f64,
    squares: f64,
    expanded: f64,
}

impl Coverage {
    fn add(&mut self, truth: &Vector3<f64>, pose: &PoseResult) {
        let reach = pose.uncertainty.unwrap().deviation;
        for k in 0..3 {
            let off = pose.deviation[k] - truth[k];
            self.within += f64::from(u8::from(off.abs() <= reach[k]));
            self.count += 1.0;
            (self.squares, self.expanded) = (self.squares + off * off, self.expanded + reach[k] * reach[k]);
        }
    }

    fn share(&self) -> f64 {
        self.within / self.count
    }

    /// Expanded uncertainty over twice the root mean square of the true error.
    fn ratio(&self) -> f64 {
        (self.expanded / (4.0 * self.squares)).sqrt()
    }
}

fn poses(random: &mut Random, count: usize) -> Vec<Vec<f64>> {
    let one = |random: &mut Random| vec![500.0 * random.unit(), 400.0 * random.unit(), -300.0 * random.unit()];
    (0..count).map(|_| one(random)).collect()
}

/// What the best rigid motion leaves of displacements of points, by a dense least squares.
fn without_rigid_motion(points: &[Vector3<f64>], displacements: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let rows = DMatrix::from_fn(3 * points.len(), 6, |i, k| {
        let axis = Vector3::ith(k % 3, 1.0);
        if k < 3 { axis[i % 3] } else { axis.cross(&points[i / 3])[i % 3] / 300.0 }
    });
    let right = DVector::from_fn(3 * points.len(), |i, _| displacements[i / 3][i % 3]);
    let step = rows.clone().svd(true, true).solve(&right, 1e-12).unwrap();
    let left = right - rows * step;
    (0..points.len()).map(|i| Vector3::from_fn(|k, _| left[3 * i + k])).collect()
}

/// What is left of displacements of points after the translation at one of them and the best rotation about it.
fn without_zero_and_rotation(points: &[Vector3<f64>], displacements: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let arm = |i: usize| points[i] - points[0];
    let rows = DMatrix::from_fn(3 * points.len(), 3, |i, k| Vector3::ith(k, 1.0).cross(&arm(i / 3))[i % 3]);
    let rest = DVector::from_fn(3 * points.len(), |i, _| (displacements[i / 3] - displacements[0])[i % 3]);
    let turn = rows.clone().svd(true, true).solve(&rest, 1e-12).unwrap();
    let left = rest - rows * turn;
    (0..points.len()).map(|i| Vector3::from_fn(|k, _| left[3 * i + k])).collect()
}

/// Where a part is zeroed, the translation is probed, and how the frame is turned nothing tells.
#[test]
fn a_zero_is_without_the_rotations_that_nothing_holds() {
    let blank = blank();
    let mut coverage = Coverage::default();
    for seed in 0..4 {
        let mut random = Random::new(4300 + seed);
        let real = real(&blank, &mut random);
        let lengths = lengths(&real, &mut random);
        // The first pose is where the zero is probed.
        let poses = [vec![vec![250.0, 200.0, -150.0]], poses(&mut random, 60)].concat();
        let points: Vec<Vector3<f64>> = poses.iter().map(|pose| actual(&blank, pose)).collect();
        let zero = points[0].iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let reference: Reference = format!("zero:{zero}").parse().unwrap();
        let figures = |datum: &str| {
            let file = fitted(&lengths, datum);
            let options =
                EvalOptions { poses: poses.clone(), reference: Some(reference.clone()), ..EvalOptions::default() };
            let found = eval(&file, &options, Run::default()).unwrap().value;
            let plain = loads(THREE, &LoadOptions::default(), Run::default()).unwrap().value;
            let options =
                abbe::CompareOptions { reference: Some(reference.clone()), ..abbe::CompareOptions::default() };
            let both = compare(&[plain, file], &options, Run::default()).unwrap().value;
            for over in [found.over.as_ref().unwrap(), &both.over] {
                assert_eq!(over.reference, ReferenceKind::ZeroLessUnheld);
                assert!(over.line().contains("less rotations about it that the data do not hold"), "{}", over.line());
            }
            // The plain machine is alike without errors.
            assert_eq!(both.machines[0].position_um.max, 0.0);
            (found, both.machines[1].position_um.p95)
        };
        let (found, p95) = figures("");
        let moved: Vec<Vector3<f64>> = poses.iter().zip(&points).map(|(pose, p)| actual(&real, pose) - p).collect();
        // At the zero itself nothing is left, and known to be.
        for (truth, pose) in without_zero_and_rotation(&points, &moved).iter().zip(&found.poses).skip(1) {
            coverage.add(truth, pose);
        }
        let (other, other_p95) = figures("identify: { datum: { zero: machine, line: end-points } }\n");
        assert!((p95 - other_p95).abs() <= 1e-6 * p95, "{p95} {other_p95}");
        for (a, b) in found.poses.iter().zip(&other.poses) {
            for k in 0..3 {
                let [ua, ub] = [a, b].map(|of| of.uncertainty.unwrap().deviation[k]);
                assert!((a.deviation[k] - b.deviation[k]).abs() <= 1e-9, "{:?} {:?}", a.deviation, b.deviation);
                assert!((ua - ub).abs() <= 1e-6 * ua.max(1e-6), "{ua} {ub}");
            }
        }
    }
    assert!((0.90..=0.99).contains(&coverage.share()), "{coverage:?}");
    assert!((0.8..1.4).contains(&coverage.ratio()), "{coverage:?}");
}

/// The intervals hold the true deviation after the same motions are taken off it, and are of the size of its error.
#[test]
fn intervals_without_a_frame_hold_and_are_not_wide() {
    let blank = blank();
    let mut coverage = Coverage::default();
    for seed in 0..6 {
        let mut random = Random::new(4100 + seed);
        let real = real(&blank, &mut random);
        let file = fitted(&lengths(&real, &mut random), "");
        let poses = poses(&mut random, 60);
        let options = EvalOptions { poses: poses.clone(), ..EvalOptions::default() };
        let found = eval(&file, &options, Run::default()).unwrap().value;
        assert_eq!(found.over.unwrap().reference, ReferenceKind::MachineLessUnheld);
        let points: Vec<Vector3<f64>> = poses.iter().map(|pose| actual(&blank, pose)).collect();
        let moved: Vec<Vector3<f64>> = poses.iter().zip(&points).map(|(pose, p)| actual(&real, pose) - p).collect();
        for (truth, pose) in without_rigid_motion(&points, &moved).iter().zip(&found.poses) {
            coverage.add(truth, pose);
        }
    }
    assert!((0.91..=0.99).contains(&coverage.share()), "{coverage:?}");
    assert!((0.8..1.4).contains(&coverage.ratio()), "{coverage:?}");
}

/// What a datum decides is in no figure of the tip: deviations, intervals and comparisons are those of every other datum.
/// How the tool turns, lengths to the tip do not tell.
#[test]
fn every_datum_gives_the_same_figures() {
    let blank = blank();
    let mut random = Random::new(4200);
    let real = real(&blank, &mut random);
    let (lengths, poses) = (lengths(&real, &mut random), poses(&mut random, 40));
    let figures = |datum: &str| -> Vec<f64> {
        let file = fitted(&lengths, datum);
        let options = EvalOptions { poses: poses.clone(), ..EvalOptions::default() };
        let points = eval(&file, &options, Run::default()).unwrap().value.poses;
        let one = eval(&file, &EvalOptions { poses: vec![poses[0].clone()], ..options }, Run::default()).unwrap().value;
        let options = MapOptions { poses: MapPoses::Random(400), ..MapOptions::default() };
        let whole = map(&file, &options, Run::default()).unwrap().value;
        assert_eq!(whole.over.reference, ReferenceKind::MachineLessUnheld);
        let plain = loads(THREE, &LoadOptions::default(), Run::default()).unwrap().value;
        let both = compare(&[plain, file], &abbe::CompareOptions::default(), Run::default()).unwrap().value;
        assert_eq!(both.over.reference, ReferenceKind::MachineLessUnheld);
        let bands = [whole.uncertainty.unwrap(), both.machines[1].uncertainty.unwrap().own];
        let bands = bands.iter().flat_map(|of| [of.position_um.max, of.position_um.p95]);
        let at = points.iter().chain(&one.poses).flat_map(|pose| {
            let of = pose.uncertainty.unwrap();
            [pose.deviation.map(|x| x * 1e3), of.deviation.map(|x| x * 1e3)].concat()
        });
        let whole = [whole.position_um.max, whole.position_um.p95, both.machines[1].position_um.p95];
        at.chain(bands.flatten()).chain(whole).collect()
    };
    let first = figures("");
    for datum in ["zero: middle", "zero: machine, line: end-points", "squareness: in straightness"] {
        let other = figures(&format!("identify: {{ datum: {{ {datum} }} }}\n"));
        let largest = first.iter().zip(&other).map(|(a, b)| (a - b).abs() / a.abs().max(1.0)).fold(0.0, f64::max);
        assert!(largest < 1e-6, "{datum}: {largest}");
    }
    // Machine coordinates are those of the datum.
    let machine = Some(Reference::default());
    let of = |datum: &str| {
        let options = MapOptions { poses: MapPoses::Random(400), reference: machine.clone(), ..MapOptions::default() };
        map(&fitted(&lengths, datum), &options, Run::default()).unwrap().value.position_um.p95
    };
    let (a, b) = (of(""), of("identify: { datum: { zero: middle } }\n"));
    assert!((a - b).abs() > 0.1 * a, "{a} {b}");
}
