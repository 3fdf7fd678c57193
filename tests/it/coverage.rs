//! Coverage of k = 2: how often the deviation that a fitted file predicts, at poses that were not measured, is within
//! its expanded uncertainty of that of the real machine. The real machine is the tests' rigid body, its forms and the
//! noise of the readings are drawn by formulas of the test.

use super::identify::normal;
use super::measurements::{actual, brought_to};
use super::oracle::curves::{Curve, Error, Points};
use super::oracle::machines::Sample;
use super::oracle::random::Random;
use super::priors::five_axes;
use abbe::{EvalOptions, IdentifyOptions, LoadOptions, Run, eval, identify, loads};
use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

/// Standard deviation of the readings (mm).
const NOISE: f64 = 1e-3;
const FIT: [&str; 22] = [
    "location",
    "EXX:poly3",
    "EYX:poly3",
    "EZX:poly3",
    "EXY:poly3",
    "EYY:poly3",
    "EZY:poly3",
    "EXZ:poly3",
    "EYZ:poly3",
    "EZZ:poly3",
    "EAX:poly2",
    "EBX:poly2",
    "ECX:poly2",
    "EAY:poly2",
    "EBY:poly2",
    "ECY:poly2",
    "EXC:fourier1",
    "EYC:fourier1",
    "EZC:fourier1",
    "EXA:fourier1",
    "EYA:fourier1",
    "EZA:fourier1",
];

/// What the readings of a campaign are like.
#[derive(Clone, Copy)]
struct Campaign {
    readings: usize,
    /// Standard deviations of each displacement (mm) and each rotation (rad) of each axis beside its curves.
    form: [f64; 2],
    /// Their correlation length as a share of the travel.
    length: f64,
    /// Correlation of the noise of a reading with the one before.
    lag: f64,
    /// An R-test and a grid, instead of deviations at random poses.
    r_test: bool,
    /// Curves of all six errors of every axis are fitted, which hardly differ from each other and from location errors.
    is_whole: bool,
}

/// How a campaign's uncertainty covers the real machine.
struct Covered {
    /// Share of the components at 100 poses that are within their expanded uncertainty.
    share: f64,
    /// Mean expanded uncertainty of a component, mm.
    reach: f64,
}

/// A reading: the run of an R-test, if it is one, the pose and the deviation (mm).
struct Row {
    run: Option<usize>,
    pose: Vec<f64>,
    read: [f64; 3],
}

/// Values of a Gaussian process at 60 even places of an interval.
fn process(random: &mut Random, size: f64, share: f64) -> Vec<f64> {
    let near = |i: usize, j: usize| {
        let apart = (i as f64 - j as f64) / 59.0 / share;
        (-0.5 * apart * apart).exp() + if i == j { 1e-9 } else { 0.0 }
    };
    let factor = DMatrix::from_fn(60, 60, near).cholesky().unwrap().l();
    let draws = DVector::from_fn(60, |_, _| normal(random));
    (factor * draws * size).iter().copied().collect()
}

/// The machine without errors; that of an R-test can bring its tip to either side of the table.
fn blank(campaign: Campaign) -> Sample {
    let mut machine = five_axes();
    if campaign.r_test {
        machine.axes[2].travel = Some([-225.0, 225.0]);
        machine.axes[3].travel = Some([-250.0, 250.0]);
    }
    machine
}

/// Its file, errors to be where the readings have them.
fn blank_file(campaign: Campaign) -> String {
    let file = super::identify::FIVE;
    let of_r_test =
        || file.replace("[0 mm, 500 mm]", "[-250 mm, 250 mm]").replace("[0 mm, 450 mm]", "[-225 mm, 225 mm]");
    let file = if campaign.r_test { of_r_test() } else { file.to_owned() };
    format!("{file}identify: {{ datum: {{ line: free, zero: free }} }}\n")
}

/// The blank machine with errors that the curves fit, and forms that they do not.
fn real(random: &mut Random, campaign: Campaign) -> Sample {
    let mut machine = blank(campaign);
    machine.rigid.walk[0].location[0] = 8e-3;
    machine.rigid.walk[1].location[4] = 20e-6;
    for extra in &mut machine.axes {
        let [low, high] = extra.travel.unwrap_or([0.0, 360.0]);
        for (k, error) in extra.errors.iter_mut().enumerate() {
            let size = campaign.form[k / 3];
            if size == 0.0 {
                continue;
            }
            let mut values = process(random, size, campaign.length);
            let turns = extra.travel.is_none();
            if turns {
                values[59] = values[0];
            }
            let at = (0..60).map(|i| low + (high - low) * f64::from(i) / 59.0).collect();
            let points = Points { at, values, cubic: false, periodic: turns, file: false };
            *error = Some(Error { forward: Curve::Points(points), reverse: None });
        }
    }
    machine
}

/// Where a campaign reads: random poses, or three balls on the turning and tilting table and a grid beside them.
fn measured_poses(random: &mut Random, campaign: Campaign, blank: &Sample) -> Vec<(Option<usize>, Vec<f64>)> {
    if !campaign.r_test {
        return super::identify::five_poses(random, campaign.readings).into_iter().map(|pose| (None, pose)).collect();
    }
    let mut all = Vec::new();
    for (run, ball) in [[70.0, 0.0, 60.0], [-30.0, 80.0, 40.0], [0.0, -60.0, 120.0]].iter().enumerate() {
        for (turn, tilt) in (0..60).map(|i| (30.0 * f64::from(i % 12), 30.0 - 30.0 * f64::from(i / 12))) {
            all.push((Some(run), brought_to(blank, &[turn, tilt, 0.0, 0.0, -200.0], &Vector3::from(*ball))));
        }
    }
    for i in 0..100 {
        let [x, y, z] = [i % 5, i / 5 % 5, i / 25].map(f64::from);
        all.push((None, vec![0.0, 0.0, 112.5 * y - 225.0, 125.0 * x - 250.0, 133.0 * z - 399.0]));
    }
    all
}

/// Where it is judged: poses of the same kind that were not measured.
fn other_poses(random: &mut Random, campaign: Campaign, blank: &Sample) -> Vec<Vec<f64>> {
    if !campaign.r_test {
        return super::identify::five_poses(random, 100);
    }
    let mut one = |i: usize| {
        let mut within = |low, high| random.between(low, high);
        if i.is_multiple_of(2) {
            return vec![0.0, 0.0, within(-225.0, 225.0), within(-250.0, 250.0), within(-400.0, 0.0)];
        }
        let ball = Vector3::new(within(-60.0, 60.0), within(-60.0, 60.0), within(40.0, 120.0));
        brought_to(blank, &[within(0.0, 360.0), within(-90.0, 30.0), 0.0, 0.0, -200.0], &ball)
    };
    (0..100).map(&mut one).collect()
}

fn deviation(blank: &Sample, real: &Sample, pose: &[f64]) -> [f64; 3] {
    (actual(real, pose) - actual(blank, pose)).into()
}

/// The files of a campaign: deviations, and those of an R-test less the first of their run.
fn files(rows: &[Row]) -> Vec<(String, String)> {
    let mut texts = [
        ("grid.csv", "C,A,Y,X,Z,dx [mm],dy [mm],dz [mm]"),
        ("balls.csv", "C,A,Y,X,Z,rel.dx [mm],rel.dy [mm],rel.dz [mm],run"),
    ]
    .map(|(name, head)| (name.to_owned(), format!("{head}\n")));
    for row in rows {
        let first = rows.iter().find(|other| row.run.is_some() && other.run == row.run).map_or([0.0; 3], |of| of.read);
        let cells = row.pose.iter().copied().chain((0..3).map(|k| row.read[k] - first[k])).map(|x| x.to_string());
        let cells: Vec<String> = cells.chain(row.run.map(|run| format!("ball {run}"))).collect();
        texts[usize::from(row.run.is_some())].1 += &format!("{}\n", cells.join(","));
    }
    texts.into_iter().filter(|(_, text)| text.lines().count() > 1).collect()
}

/// The errors that a campaign fits.
fn fit(campaign: Campaign) -> Vec<String> {
    if !campaign.is_whole {
        let angles = if campaign.r_test { &["EAZ:poly2", "EBZ:poly2", "ECZ:poly2"][..] } else { &[] };
        return FIT.iter().chain(angles).map(|word| (*word).to_owned()).collect();
    }
    let curves = [("X", "poly2"), ("Y", "poly2"), ("Z", "poly2"), ("C", "fourier2"), ("A", "poly3")];
    let of = |(axis, basis): (&str, &str)| ["X", "Y", "Z", "A", "B", "C"].map(|of| format!("E{of}{axis}:{basis}"));
    std::iter::once("location".to_owned()).chain(curves.into_iter().flat_map(of)).collect()
}

/// Fits a campaign and looks at 100 poses that were not measured.
fn covered(campaign: Campaign, seed: u64) -> Covered {
    let mut random = Random::new(seed);
    let (blank, real) = (blank(campaign), real(&mut random, campaign));
    let mut noise = [0.0; 3].map(|_: f64| NOISE * normal(&mut random));
    let mut rows = Vec::new();
    for (run, pose) in measured_poses(&mut random, campaign, &blank) {
        let fresh = (1.0 - campaign.lag * campaign.lag).sqrt() * NOISE;
        noise = noise.map(|before| campaign.lag * before + fresh * normal(&mut random));
        let read = deviation(&blank, &real, &pose);
        rows.push(Row { run, pose, read: std::array::from_fn(|k| read[k] + noise[k]) });
    }
    let run = Run::on_disk();
    let machine = loads(&blank_file(campaign), &LoadOptions::default(), run).unwrap().value;
    let options =
        IdentifyOptions { texts: files(&rows), fit: fit(campaign), machine_file: true, ..IdentifyOptions::default() };
    let fitted = identify(&machine, &options, run).unwrap_or_else(|why| panic!("{why:?}")).value;
    let fitted = loads(&fitted.machine_file.unwrap(), &LoadOptions::default(), run).unwrap().value;
    let poses = other_poses(&mut random, campaign, &blank);
    let predicted = eval(&fitted, &EvalOptions { poses: poses.clone(), ..EvalOptions::default() }, run).unwrap().value;
    let within = |(pose, predicted): (&Vec<f64>, &abbe::results::PoseResult)| {
        let (truth, reach) = (deviation(&blank, &real, pose), predicted.uncertainty.unwrap().deviation);
        (0..3).filter(|k| (predicted.deviation[*k] - truth[*k]).abs() <= reach[*k]).count()
    };
    let share = poses.iter().zip(&predicted.poses).map(within).sum::<usize>() as f64 / 300.0;
    let reaches = predicted.poses.iter().flat_map(|pose| pose.uncertainty.unwrap().deviation);
    Covered { share, reach: reaches.sum::<f64>() / 300.0 }
}

fn coverage(campaign: Campaign, draws: u64) -> f64 {
    let shares: Vec<f64> = (0..draws).into_par_iter().map(|seed| covered(campaign, 1000 + seed).share).collect();
    shares.iter().sum::<f64>() / draws as f64
}

const WHITE: Campaign =
    Campaign { readings: 120, form: [0.0; 2], length: 0.0, lag: 0.0, r_test: false, is_whole: false };

/// Kinds of campaigns, with the coverage that each is to have.
fn kinds() -> Vec<(&'static str, Campaign, f64, f64)> {
    let autocorrelated = Campaign { lag: 0.6, ..WHITE };
    let formed = |length, size, angle| Campaign { form: [size * NOISE, angle * 1e-6], length, ..WHITE };
    let mut all = vec![("white", WHITE, 0.92, 0.98), ("lag 0.6", autocorrelated, 0.92, 0.98)];
    // The last, far above the noise of the readings: a laser and a screw.
    for (share, size) in
        [(0.05, 0.5), (0.05, 1.0), (0.1, 0.5), (0.1, 1.0), (0.2, 0.5), (0.2, 1.0), (0.3, 1.0), (0.1, 2.0), (0.2, 10.0)]
    {
        all.push(("form", formed(share, size, 0.0), 0.90, 0.99));
    }
    // Angles (urad) that move a tip 300 mm away by the noise, and by three times as much.
    for (share, angle) in [(0.05, 3.3), (0.1, 3.3), (0.2, 3.3), (0.3, 3.3), (0.1, 10.0), (0.2, 10.0)] {
        all.push(("form of angles", formed(share, 0.0, angle), 0.90, 0.99));
    }
    for (share, angle) in [(0.1, 3.3), (0.2, 10.0)] {
        all.push(("form of both", formed(share, 1.0, angle), 0.90, 0.99));
    }
    for (size, angle) in [(0.0, 0.0), (1.0, 0.0), (1.0, 3.3)] {
        all.push(("R-test", Campaign { r_test: true, ..formed(0.2, size, angle) }, 0.90, 1.0));
    }
    all
}

/// Counts every kind. Shares of campaigns scatter by 0.05, so that the mean of a few may be off by twice that over the
/// root of their number.
fn every_kind_covers(draws: u64) {
    let margin = if draws < 100 { 0.1 / (draws as f64).sqrt() } else { 0.0 };
    for (name, campaign, low, high) in kinds() {
        let found = coverage(campaign, draws);
        let [um, urad] = [campaign.form[0] * 1e3, campaign.form[1] * 1e6];
        let kind = format!("{name} {um:.1} um {urad:.1} urad over {}", campaign.length);
        println!("{kind}: {found:.4}");
        assert!((low - margin..=high + margin).contains(&found), "{kind}: {found}");
    }
}

/// Of the many combinations of such curves some hardly move a tip: they make the uncertainty neither metres nor
/// nothing.
#[test]
fn curves_on_every_axis_are_as_uncertain_as_they_are() {
    let campaign = Campaign { readings: 150, form: [1e-3, 3e-6], length: 0.15, is_whole: true, ..WHITE };
    for found in (0..2).into_par_iter().map(|seed| covered(campaign, 2000 + seed)).collect::<Vec<_>>() {
        let Covered { share, reach } = found;
        println!("{share} {reach}");
        assert!(share > 0.85 && reach > 2e-3 && reach < 15e-3, "{share} {reach}");
    }
}

#[test]
#[ignore = "soak: a minute"]
fn expanded_uncertainties_cover_the_real_machine() {
    every_kind_covers(4);
}

/// The same with more draws: `cargo test --release --test it -- --ignored coverage --nocapture`.
#[test]
#[ignore = "soak: minutes"]
fn coverage_of_many_campaigns() {
    every_kind_covers(400);
}
