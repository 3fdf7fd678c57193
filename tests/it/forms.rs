//! Forms on every axis: how often the expanded uncertainty (k = 2) of a fitted file holds the deviation of the real
//! machine at poses that were not measured, campaign by campaign. The real machine is the tests' rigid body; its forms
//! are sums of waves, drawn here.

use super::oracle::curves::{Curve, Error, Points, Travel};
use super::oracle::machines::{Extra, Sample};
use super::oracle::random::Random;
use super::oracle::rigid::{Axis, Frame, Machine};
use abbe::{EvalOptions, IdentifyOptions, LoadOptions, Run, eval, identify, loads};
use rayon::prelude::*;

/// Standard deviation of the readings (mm).
const NOISE: f64 = 1e-3;
/// Standard deviations of displacements (mm) and rotations (rad) of every axis beside its curves.
const FORM: [f64; 2] = [1e-3, 3e-6];
/// Correlation length of a linear axis over its travel.
const LENGTH: f64 = 0.15;
/// Harmonics of a turn of a rotary axis.
const HARMONICS: std::ops::RangeInclusive<u32> = 3..=8;
/// Poses at which a campaign is judged.
const JUDGED: usize = 200;

/// A sum of twelve even numbers is normal enough: standard deviation 1.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// Name of an axis, true on the workpiece side, origin, travel (none without an end).
type Built = (&'static str, bool, [f64; 3], Option<[f64; 2]>);

/// How a machine is built.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Build {
    /// Table in Y, ram in X and Z.
    ThreeAxis,
    /// A tilting and turning table.
    Trunnion,
    /// A swivelling head over a turning table.
    HeadTable,
}

impl Build {
    /// Axes from workpiece to tool.
    fn axes(self) -> Vec<Built> {
        let turn = None;
        match self {
            Self::ThreeAxis => vec![
                ("Y", true, [0.0; 3], Some([0.0, 600.0])),
                ("X", false, [0.0; 3], Some([0.0, 800.0])),
                ("Z", false, [0.0; 3], Some([-500.0, 0.0])),
            ],
            Self::Trunnion => vec![
                ("C", true, [300.0, 250.0, -420.0], turn),
                ("B", true, [300.0, 250.0, -380.0], Some([-100.0, 35.0])),
                ("X", true, [0.0; 3], Some([0.0, 600.0])),
                ("Y", false, [0.0; 3], Some([0.0, 500.0])),
                ("Z", false, [0.0; 3], Some([-450.0, 0.0])),
            ],
            Self::HeadTable => vec![
                ("C", true, [350.0, 300.0, -600.0], turn),
                ("Y", true, [0.0; 3], Some([0.0, 600.0])),
                ("X", false, [0.0; 3], Some([0.0, 700.0])),
                ("Z", false, [0.0; 3], Some([-400.0, 0.0])),
                ("A", false, [350.0, 300.0, 60.0], Some([-95.0, 95.0])),
            ],
        }
    }

    fn tip(self) -> ([f64; 3], [f64; 3]) {
        match self {
            Self::ThreeAxis => ([400.0, 300.0, 0.0], [400.0, 300.0, -400.0]),
            Self::Trunnion => ([300.0, 250.0, 0.0], [300.0, 250.0, -400.0]),
            Self::HeadTable => ([350.0, 300.0, -50.0], [350.0, 300.0, -500.0]),
        }
    }

    /// The machine without errors.
    fn blank(self) -> Sample {
        let axis = |(name, workpiece, origin, _): &Built| {
            let index = "XYZABC".find(name).unwrap();
            let direction = std::array::from_fn(|k| f64::from(u8::from(k == index % 3)));
            let rotary = index > 2;
            Axis {
                name: (*name).to_owned(),
                rotary,
                workpiece: *workpiece,
                direct: None,
                direction,
                origin: *origin,
                location: [0.0; 6],
            }
        };
        let (gauge, workpiece_origin) = self.tip();
        let rigid = Machine {
            walk: self.axes().iter().map(axis).collect(),
            gauge,
            offset: [0.0, 0.0, -130.0],
            workpiece_origin,
            ..Machine::default()
        };
        let extra = |(.., travel): Built| Extra { travel, errors: Default::default() };
        Sample { rigid, axes: self.axes().into_iter().map(extra).collect(), branches: false }
    }

    /// Its file.
    fn file(self) -> String {
        let side = |workpiece: bool| self.axes().into_iter().filter(move |(_, on, ..)| *on == workpiece);
        let names =
            |workpiece: bool, prime: &str| side(workpiece).map(|a| format!("{}{prime} ", a.0)).collect::<String>();
        let axis = |(name, _, origin, travel): (&str, bool, [f64; 3], Option<[f64; 2]>)| {
            let unit = if "ABC".contains(name) { "deg" } else { "mm" };
            let travel = travel.map_or("continuous".to_owned(), |[low, high]| format!("[{low} {unit}, {high} {unit}]"));
            format!("  {name}: {{ travel: {travel}, origin: {origin:?} }}\n")
        };
        let (gauge, origin) = self.tip();
        format!(
            "abbe: 1\nmachine: judged\nchain: \"w {}b {}t\"\naxes:\n{}tool: {{ gauge: {gauge:?}, length: 130 mm }}\n\
             workpiece: {{ origin: {origin:?} }}\nidentify: {{ datum: {{ line: free, zero: free }} }}\n",
            names(true, "'"),
            names(false, ""),
            self.axes().into_iter().map(axis).collect::<String>()
        )
    }

    /// What is fitted: location errors and a low curve of every error that tips feel.
    fn fit(self) -> Vec<String> {
        let curves = |(name, _, _, travel): (&str, bool, [f64; 3], Option<[f64; 2]>)| {
            let is_rotary = "ABC".contains(name);
            let of = move |letter: char| match (is_rotary, travel.is_none()) {
                (true, _) => format!("E{letter}{name}:fourier1"),
                (false, _) if "ABC".contains(letter) => format!("E{letter}{name}:poly2"),
                (false, _) => format!("E{letter}{name}:poly3"),
            };
            // The angles of Z act at one lever arm only: they are like its straightness.
            let letters = if is_rotary || name == "Z" { "XYZ" } else { "XYZABC" };
            letters.chars().map(of).collect::<Vec<_>>()
        };
        std::iter::once("location".to_owned()).chain(self.axes().into_iter().flat_map(curves)).collect()
    }
}

/// What the readings of a campaign are like.
#[derive(Clone, Copy, Debug)]
struct Campaign {
    build: Build,
    readings: usize,
    /// Factor of the forms.
    form: f64,
    /// Readings that are 100 um off.
    outliers: usize,
    robust: bool,
}

/// How many components at poses that were not measured are within the expanded uncertainty, and beyond twice as much.
#[derive(Clone, Copy, Debug)]
struct Count {
    within: f64,
    beyond: f64,
    /// The largest distance over the expanded uncertainty.
    worst: f64,
}

/// A wave along an axis: a Gaussian process by forty random waves, or harmonics of a turn.
fn wave(random: &mut Random, extra: &Extra, rotary: bool, size: f64) -> Curve {
    if rotary {
        let scale = size / f64::from(HARMONICS.count() as u32).sqrt();
        return Curve::Harmonics(HARMONICS.map(|k| (k, scale * normal(random), scale * normal(random))).collect());
    }
    let [low, high] = extra.travel.unwrap();
    let scale = size / 20f64.sqrt();
    let waves: Vec<[f64; 3]> = (0..20)
        .map(|_| [normal(random) / (LENGTH * (high - low)), scale * normal(random), scale * normal(random)])
        .collect();
    let value = |x: f64| waves.iter().map(|[k, c, s]| c * (k * x).cos() + s * (k * x).sin()).sum();
    let at: Vec<f64> = (0..=300).map(|i| low + (high - low) * f64::from(i) / 300.0).collect();
    let values = at.iter().map(|x| value(*x)).collect();
    Curve::Points(Points { at, values, cubic: false, periodic: false, file: false })
}

/// The blank machine with location errors, low curves and a form on every axis.
fn real(random: &mut Random, campaign: Campaign) -> Sample {
    let mut machine = campaign.build.blank();
    for axis in &mut machine.rigid.walk {
        axis.location = std::array::from_fn(|k| if k < 3 { 8e-3 } else { 20e-6 } * normal(random));
    }
    for (axis, extra) in machine.rigid.walk.iter().zip(&mut machine.axes) {
        for k in 0..6 {
            let forward = wave(random, extra, axis.rotary, campaign.form * FORM[k / 3]);
            extra.errors[k] = Some(Error { forward, reverse: None });
        }
    }
    machine
}

fn pose(random: &mut Random, sample: &Sample) -> Vec<f64> {
    sample.axes.iter().map(|extra| extra.travel.unwrap_or([0.0, 360.0])).map(|[a, b]| random.between(a, b)).collect()
}

fn deviation(sample: &Sample, pose: &Vec<f64>) -> [f64; 3] {
    sample.evaluate(pose, Travel::Mean, Frame::Workpiece).deviation
}

/// Counts one campaign.
fn count(campaign: Campaign, seed: u64) -> Count {
    let mut random = Random::new(seed);
    let real = real(&mut random, campaign);
    let names: Vec<String> = real.rigid.walk.iter().map(|axis| axis.name.clone()).collect();
    let mut text = format!("{},dx [mm],dy [mm],dz [mm]\n", names.join(","));
    for i in 0..campaign.readings {
        let at = pose(&mut random, &real);
        let read = deviation(&real, &at).map(|d| d + NOISE * normal(&mut random));
        let off = if i < campaign.outliers { 0.1 } else { 0.0 };
        let cells = at.iter().copied().chain(read.map(|d| d + off)).map(|x| x.to_string()).collect::<Vec<_>>();
        text += &format!("{}\n", cells.join(","));
    }
    let run = Run::on_disk();
    let machine = loads(&campaign.build.file(), &LoadOptions::default(), run).unwrap().value;
    let options = IdentifyOptions {
        texts: vec![("readings.csv".to_owned(), text)],
        fit: campaign.build.fit(),
        robust: campaign.robust,
        machine_file: true,
        ..IdentifyOptions::default()
    };
    let fitted = identify(&machine, &options, run).unwrap_or_else(|why| panic!("{why:?}")).value;
    let fitted = loads(&fitted.machine_file.unwrap(), &LoadOptions::default(), run).unwrap().value;
    let poses: Vec<Vec<f64>> = (0..JUDGED).map(|_| pose(&mut random, &real)).collect();
    let predicted = eval(&fitted, &EvalOptions { poses: poses.clone(), ..EvalOptions::default() }, run).unwrap().value;
    let ratios: Vec<f64> = poses
        .iter()
        .zip(&predicted.poses)
        .flat_map(|(pose, predicted)| {
            let (truth, reach) = (deviation(&real, pose), predicted.uncertainty.unwrap().deviation);
            (0..3).map(move |k| (predicted.deviation[k] - truth[k]).abs() / reach[k]).collect::<Vec<_>>()
        })
        .collect();
    let share = |limit: f64| ratios.iter().filter(|ratio| **ratio > limit).count() as f64 / ratios.len() as f64;
    Count { within: 1.0 - share(1.0), beyond: share(2.0), worst: ratios.iter().copied().fold(0.0, f64::max) }
}

/// The campaign of a seed: builds in turn, 100 to 300 poses.
fn campaign(seed: u64) -> Campaign {
    let build = [Build::ThreeAxis, Build::Trunnion, Build::HeadTable][seed as usize % 3];
    let readings = 100 + 40 * (seed as usize / 3 % 6);
    Campaign { build, readings, form: 1.0, outliers: 0, robust: false }
}

/// What the campaigns of some seeds count together.
#[derive(Debug)]
struct Summary {
    mean: f64,
    /// Fifth percentile of the campaigns.
    low: f64,
    least: f64,
    beyond: f64,
    worst: f64,
}

/// Counts the campaigns of some seeds.
fn summary(seeds: std::ops::Range<u64>, change: impl Fn(Campaign) -> Campaign + Sync) -> Summary {
    let counts: Vec<Count> = seeds.into_par_iter().map(|seed| count(change(campaign(seed)), seed)).collect();
    let mut within: Vec<f64> = counts.iter().map(|count| count.within).collect();
    within.sort_by(f64::total_cmp);
    let mean = |of: &dyn Fn(&Count) -> f64| counts.iter().map(of).sum::<f64>() / counts.len() as f64;
    Summary {
        mean: mean(&|count| count.within),
        low: within[within.len() / 20],
        least: within[0],
        beyond: mean(&|count| count.beyond),
        worst: counts.iter().map(|count| count.worst).fold(0.0, f64::max),
    }
}

/// Ten campaigns, in seconds; two hundred are soak.
#[test]
fn ten_campaigns_hold_forms_on_every_axis() {
    let found = summary(500..510, |campaign| Campaign { readings: campaign.readings.min(150), ..campaign });
    assert!((0.9..=1.0).contains(&found.mean) && found.least >= 0.8 && found.beyond <= 0.01, "{found:?}");
}

/// Bumped readings do not narrow the intervals of a robust fit.
#[test]
fn robust_fits_hold_forms_beside_outliers() {
    let bumped = |campaign: Campaign| Campaign { readings: 120, outliers: 3, robust: true, ..campaign };
    let found = summary(600..603, bumped);
    assert!(found.mean >= 0.88 && found.least >= 0.75, "{found:?}");
}

/// Two hundred campaigns: three machines, six numbers of readings.
#[test]
#[ignore = "soak: minutes"]
fn two_hundred_campaigns_hold_forms_on_every_axis() {
    let found = summary(1_000..1_200, |campaign| campaign);
    println!("{found:?}");
    let Summary { mean, low, least, beyond, worst } = found;
    assert!(worst < 4.0, "{worst}");
    assert!((0.92..=0.98).contains(&mean) && low >= 0.85 && least >= 0.7 && beyond <= 0.01, "{found:?}");
}

/// The same with three readings that are 100 um off, by robust fits.
#[test]
#[ignore = "soak: minutes"]
fn hundred_robust_campaigns_hold_forms_beside_outliers() {
    let found = summary(2_000..2_100, |campaign| Campaign { outliers: 3, robust: true, ..campaign });
    println!("{found:?}");
    let Summary { mean, low, least, beyond, worst } = found;
    assert!(worst < 4.0, "{worst}");
    assert!((0.92..=0.98).contains(&mean) && low >= 0.85 && least >= 0.7 && beyond <= 0.01, "{found:?}");
}

/// A machine whose EXX is a slope and whose EZX is bent by 6 um, read on a grid with 1 um of noise.
fn bent(readings: usize, seed: u64, fit: &[&str]) -> (abbe::results::IdentifyResult, Sample) {
    let mut random = Random::new(seed);
    let mut real = Build::ThreeAxis.blank();
    let error = |curve| Some(Error { forward: curve, reverse: None });
    let x = &mut real.axes[1];
    x.errors[0] = error(Curve::Polynomial(vec![0.0, 30e-6]));
    x.errors[2] = error(Curve::Polynomial(vec![0.0, 4.0 * 6e-3 / 800.0, -4.0 * 6e-3 / 800.0 / 800.0]));
    let mut text = "Y,X,Z,dx [mm],dy [mm],dz [mm]\n".to_owned();
    for _ in 0..readings {
        let at = pose(&mut random, &real);
        let read = deviation(&real, &at).map(|d| d + NOISE * normal(&mut random));
        let cells = at.iter().chain(&read).map(ToString::to_string).collect::<Vec<_>>();
        text += &format!("{}\n", cells.join(","));
    }
    let run = Run::on_disk();
    let machine = loads(&Build::ThreeAxis.file(), &LoadOptions::default(), run).unwrap().value;
    let options = IdentifyOptions {
        texts: vec![("readings.csv".to_owned(), text)],
        fit: fit.iter().map(|word| (*word).to_owned()).collect(),
        machine_file: true,
        ..IdentifyOptions::default()
    };
    (identify(&machine, &options, run).unwrap_or_else(|why| panic!("{why:?}")).value, real)
}

/// The share of random poses at which the expanded uncertainty holds dz.
fn held_in_z(fitted: &abbe::results::IdentifyResult, real: &Sample, seed: u64) -> f64 {
    let mut random = Random::new(seed);
    let run = Run::on_disk();
    let file = fitted.machine_file.as_ref().unwrap();
    let machine = loads(file, &LoadOptions::default(), run).unwrap().value;
    let poses: Vec<Vec<f64>> = (0..300).map(|_| pose(&mut random, real)).collect();
    let predicted = eval(&machine, &EvalOptions { poses: poses.clone(), ..EvalOptions::default() }, run).unwrap().value;
    let holds = |(pose, predicted): &(&Vec<f64>, &abbe::results::PoseResult)| {
        let reach = predicted.uncertainty.as_ref().unwrap().deviation[2];
        (predicted.deviation[2] - deviation(real, pose)[2]).abs() <= reach
    };
    poses.iter().zip(&predicted.poses).filter(holds).count() as f64 / 300.0
}

/// The form is that of EZX alone, and so are the wide intervals; the report names it with the curve that removes it.
#[test]
fn one_bent_error_among_straight_ones_is_held_and_named() {
    for (readings, seed) in [(120, 71), (343, 72), (1900, 73)] {
        let (fitted, real) = bent(readings, seed, &["linear"]);
        let held = held_in_z(&fitted, &real, seed + 10);
        let lack = fitted.lack_of_fit.as_ref().unwrap();
        // 0.81 to 0.91 over twelve draws: a single bend is one draw of its form, and its size is not known better.
        assert!(held >= 0.75, "{readings}: {held}");
        let first = &lack.bends[0];
        assert_eq!((first.error.as_str(), first.fit.as_deref()), ("EZX", Some("EZX:poly3")), "{lack:?}");
        assert!((5.0..7.2).contains(&first.bend) && first.unit == "um", "{first:?}");
        let (better, _) = bent(readings, seed, &["linear", "EZX:poly3"]);
        // Of three components of 1 um.
        assert!(better.rms_um.after < 2.0, "{}", better.rms_um.after);
        let promised = fitted.rms_um.after * first.rms_ratio;
        assert!((better.rms_um.after / promised - 1.0).abs() < 0.1, "{} {promised}", better.rms_um.after);
    }
}
