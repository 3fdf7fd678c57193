//! Reversal spikes of circular tests: paths written by the test in closed form, with and without spikes, in both senses
//! and on arcs.

use super::identify::normal;
use super::oracle::random::Random;
use crate::program::{Folder, abbe, json, well_formed};
use abbe::results::{CauseTest, CircleTest, SpikeTest, TestFigures};
use abbe::{FiguresOptions, Run, figures};

const RADIUS: f64 = 100.0;

/// A peak after an axis has turned: height (um, outwards), length at half of it and delay (deg), at one of 0, 90, 180,
/// 270 deg.
#[derive(Clone, Copy)]
struct Peak {
    at: f64,
    height: f64,
    width: f64,
    delay: f64,
    shape: fn(f64) -> f64,
}

/// Shapes over the length at half height; 1 at their peak.
fn half_sine(x: f64) -> f64 {
    if (0.0..=1.5).contains(&x) { (x / 1.5 * std::f64::consts::PI).sin() } else { 0.0 }
}
fn triangle(x: f64) -> f64 {
    (1.0 - (x - 1.0).abs()).max(0.0)
}
fn decay(x: f64) -> f64 {
    if x >= 0.0 { (-x * std::f64::consts::LN_2).exp() } else { 0.0 }
}

/// Deviations (um) of a machine with squareness 40 urad, scale 20 um/m, lost motion 3 and 5 um, 2 um of lag of the
/// first axis, a ball off by 6 and -4 um, and peaks.
fn deviation(angle: f64, sense: f64, peaks: &[Peak]) -> f64 {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let (along, up) = (-sine * sense, cosine * sense);
    let x = RADIUS * cosine * (1.0 + 20e-6) - 1.5e-3 * along.signum() - 2e-3 * along;
    let y = RADIUS * sine - 2.5e-3 * up.signum();
    let after = |peak: &Peak| {
        let travelled = (sense * (angle - peak.at) + 180.0).rem_euclid(360.0) - 180.0;
        peak.height * (peak.shape)((travelled - peak.delay) / peak.width)
    };
    ((x - 40e-6 * y - 6e-3).hypot(y + 4e-3) - RADIUS) * 1e3 + peaks.iter().map(after).sum::<f64>()
}

/// How a circle is read.
#[derive(Clone, Copy)]
struct Reading {
    step: f64,
    arc: (f64, f64),
    noise: f64,
    /// Correlation of the noise with that of the reading before.
    lag: f64,
    senses: &'static [f64],
}

const BOTH: Reading = Reading { step: 0.5, arc: (0.0, 360.0), noise: 0.3, lag: 0.0, senses: &[1.0, -1.0] };

fn table(reading: Reading, peaks: &[Peak], seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut text = "angle [deg],deviation [um],sense\n".to_owned();
    for sense in reading.senses {
        let word = if *sense > 0.0 { "ccw" } else { "cw" };
        let mut noise = reading.noise * normal(&mut random);
        for i in 0..((reading.arc.1 - reading.arc.0) / reading.step) as usize {
            let angle = reading.arc.0 + reading.step * (i as f64 + 0.37);
            let fresh = (1.0 - reading.lag * reading.lag).sqrt() * reading.noise;
            noise = reading.lag * noise + fresh * normal(&mut random);
            text += &format!("{angle},{},{word}\n", deviation(angle, *sense, peaks) + noise);
        }
    }
    text
}

fn taken_apart(folder: &Folder, reading: Reading, peaks: &[Peak], seed: u64) -> CircleTest {
    let file = folder.with("circle.csv", &table(reading, peaks, seed));
    let options = FiguresOptions { feed: Some(1200.0), radius_mm: RADIUS, ..FiguresOptions::default() };
    match figures(&file, &options, Run::on_disk()).unwrap_or_else(|why| panic!("{why:?}")).value {
        TestFigures::Circle(test) => *test,
        other => panic!("{other:?}"),
    }
}

fn causes(folder: &Folder, reading: Reading, peaks: &[Peak], seed: u64) -> CauseTest {
    taken_apart(folder, reading, peaks, seed).causes.unwrap()
}

fn spikes(causes: &CauseTest) -> Vec<(f64, SpikeTest)> {
    causes.turning_points.iter().filter_map(|at| Some((at.angle_deg, at.spike?))).collect()
}

/// Checks squareness, scale, reversals and servo, each within so many standard uncertainties and some nanometres.
fn unbiased(causes: &CauseTest, sigmas: f64) {
    let servo = causes.servo_um.map(|servo| (servo, 1.0));
    let all = [
        (causes.squareness_urad, 40.0),
        (causes.scale_mismatch_um_per_m, 20.0),
        (causes.reversal_um[0], -3.0),
        (causes.reversal_um[1], -5.0),
    ];
    for (found, expected) in all.into_iter().chain(servo) {
        let reach = sigmas * found.sigma.unwrap() + 5e-3;
        assert!((found.value - expected).abs() < reach, "{found:?} instead of {expected}: {causes:?}");
    }
}

/// Peaks outwards and inwards, of three shapes, one delayed; nothing at 180 deg.
const PEAKS: [Peak; 3] = [
    Peak { at: 0.0, height: 4.0, width: 3.0, delay: 0.0, shape: half_sine },
    Peak { at: 90.0, height: -2.5, width: 2.0, delay: 1.0, shape: triangle },
    Peak { at: 270.0, height: 6.0, width: 2.5, delay: 0.0, shape: decay },
];

#[test]
fn spikes_have_their_height_and_length_and_bias_nothing() {
    let folder = Folder::new("spikes-both");
    for seed in 1..=20 {
        let causes = causes(&folder, BOTH, &PEAKS, seed);
        unbiased(&causes, 4.5);
        let found = spikes(&causes);
        assert_eq!(found.iter().map(|(at, _)| *at).collect::<Vec<_>>(), [0.0, 90.0, 270.0], "{causes:?}");
        for ((_, spike), peak) in found.iter().zip(PEAKS) {
            let reach = 4.0 * spike.height_um.sigma.unwrap() + 0.15 * peak.height.abs();
            assert!((spike.height_um.value - peak.height).abs() < reach, "seed {seed}: {spike:?}");
            assert!((spike.width_deg / peak.width - 1.0).abs() < 0.35, "seed {seed}: {spike:?}");
            assert!((spike.width_mm - spike.width_deg.to_radians() * RADIUS).abs() < 1e-9);
            // 1200 mm/min are 20 um a ms.
            assert!((spike.width_ms.unwrap() - spike.width_mm * 50.0).abs() < 1e-9);
            assert!(spike.chance < 1e-4, "{spike:?}");
        }
        // The rest is the noise.
        assert!((causes.rest_um - 0.3).abs() < 0.04, "{}", causes.rest_um);
    }
}

/// Spikes on all four quadrants, which a fit of the other causes takes for reversal, squareness and lag.
#[test]
fn spikes_do_not_pass_for_other_causes() {
    let folder = Folder::new("spikes-bias");
    let peak = |at: f64, height: f64| Peak { at, height, width: 5.0, delay: 0.0, shape: half_sine };
    let peaks = [peak(0.0, 8.0), peak(90.0, -8.0), peak(180.0, 8.0), peak(270.0, -8.0)];
    let exact = Reading { noise: 0.02, ..BOTH };
    let causes = causes(&folder, exact, &peaks, 3);
    assert_eq!(spikes(&causes).len(), 4);
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 0.03, "{found} {expected}: {causes:?}");
    near(causes.squareness_urad.value / 20.0, 2.0);
    near(causes.scale_mismatch_um_per_m.value / 20.0, 1.0);
    near(causes.reversal_um[0].value, -3.0);
    near(causes.reversal_um[1].value, -5.0);
    near(causes.servo_um.unwrap().value, 1.0);
}

/// An arc of 220 deg read over its ends' turning points in one sense only, and a circle of one sense.
#[test]
fn arcs_and_single_senses_have_their_spikes() {
    let folder = Folder::new("spikes-arc");
    let arc = Reading { arc: (-20.0, 200.0), ..BOTH };
    for seed in 1..=10 {
        let causes = causes(&folder, arc, &PEAKS, seed);
        unbiased(&causes, 4.5);
        assert_eq!(spikes(&causes).iter().map(|(at, _)| *at).collect::<Vec<_>>(), [0.0, 90.0], "{causes:?}");
        assert!(causes.turning_points[2].limit_um.is_some() && causes.turning_points[3].limit_um.is_none());
    }
    for sense in [&[1.0][..], &[-1.0]] {
        let one = Reading { senses: sense, ..BOTH };
        let causes = causes(&folder, one, &PEAKS, 5);
        assert_eq!(spikes(&causes).len(), 3, "{causes:?}");
        assert!((causes.reversal_um[1].value + 5.0).abs() < 5.0 * causes.reversal_um[1].sigma.unwrap());
    }
}

/// Of 300 circles without spikes not more than 1 in 100 shows one: white noise, noise that correlates, coarse arcs.
#[test]
fn circles_without_spikes_show_none() {
    let folder = Folder::new("spikes-none");
    let correlated = Reading { lag: 0.8, ..BOTH };
    let coarse = Reading { step: 1.0, arc: (10.0, 240.0), ..BOTH };
    for (name, reading) in [("white", BOTH), ("correlated", correlated), ("arc", coarse)] {
        let alarms = (0..300).filter(|seed| !spikes(&causes(&folder, reading, &[], 100 + seed)).is_empty()).count();
        println!("{name}: {alarms} of 300");
        assert!(alarms <= 3, "{name}: {alarms} of 300 circles show a spike");
    }
    // What is stated as found nowhere would be found.
    let limits = causes(&folder, BOTH, &[], 1).turning_points.map(|at| at.limit_um.unwrap());
    for (k, limit) in limits.into_iter().enumerate() {
        let at = 90.0 * k as f64;
        let peak = Peak { at, height: 1.5 * limit, width: 2.0, delay: 0.0, shape: triangle };
        assert_eq!(spikes(&causes(&folder, BOTH, &[peak], 1)).len(), 1, "{limit} at {at}");
    }
}

#[test]
fn spikes_are_printed_drawn_and_left_unjudged() {
    let folder = Folder::new("spikes-printed");
    let file = folder.with("circle.csv", &table(BOTH, &PEAKS, 2)).display().to_string();
    let svg = folder.file("circle.svg").display().to_string();
    let text = abbe(&["figures", "circle", &file, "--feed", "1200", "--svg", &svg]);
    for row in ["spike X+ ", "spike X+, length", "spike Y+ ", "spike X- ", "none above", "spike Y-, chance"] {
        assert!(text.contains(row), "{row}: {text}");
    }
    let picture = std::fs::read_to_string(&svg).unwrap();
    well_formed(&picture).unwrap();
    for label in ["X+ ", "Y+ -", "Y- "] {
        assert!(picture.contains(&format!(">{label}")), "{label}: {picture}");
    }
    assert_eq!(picture.matches("stroke-opacity=\"0.35\"").count(), 6);
    // Readings 5 deg apart say nothing of spikes.
    let coarse = Reading { step: 5.0, ..BOTH };
    let file = folder.with("coarse.csv", &table(coarse, &PEAKS, 2)).display().to_string();
    let found = json(&["figures", "circle", &file, "--format", "json"]);
    for point in found["causes"]["turning_points"].as_array().unwrap() {
        assert!(point["spike"].is_null() && point["limit_um"].is_null(), "{point}");
    }
}
