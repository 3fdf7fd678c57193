//! Readings that scatter in unlike ways: bumped points, several quantities in one fit, uncertainties, few readings.

use super::identify::{deviation, five, five_poses, json, measured, normal, wanted};
use super::measurements::identified;
use super::oracle::random::Random;
use abbe::identify::{FitModel, Measurement, Parameter, ParameterFit, Reading, ReadingKind, Solution, solve};
use abbe::lower::{ErrorSite, Source};
use abbe::machine::{Approach, Direction, Machine};

/// Coverage of intervals of a number of standard uncertainties: the frequency with which they hold the truth.
#[derive(Default)]
struct Coverage {
    inside: usize,
    all: usize,
}

impl Coverage {
    /// Counts intervals of `reach` standard uncertainties; of the stated number without `reach`.
    fn count(&mut self, parameters: &[Parameter], solution: &Solution, known: &[f64], reach: Option<f64>) {
        for ((estimate, parameter), known) in solution.estimates.iter().zip(parameters).zip(known) {
            let (value, sigma) = (parameter.in_unit(estimate.value), parameter.in_unit(estimate.sigma.unwrap()));
            let reach = reach.or(estimate.coverage).unwrap();
            self.inside += usize::from((value - known).abs() < reach * sigma);
            self.all += 1;
        }
    }

    fn share(&self) -> f64 {
        self.inside as f64 / self.all as f64
    }
}

const TRUTH: &str = "errors: { EC0Y: 12 urad, EX0C: 6 um, EYX: { polynomial: [0 um, 8 um/m, -20 um/m^2] }, EAX: { polynomial: [0 urad, 10 urad/m] } }\n";
const WORDS: [&str; 4] = ["EC0Y", "EX0C", "EYX:poly2", "EAX:poly1"];
const KNOWN: [f64; 7] = [12.0, 6.0, 0.0, 8.0, -20.0, 0.0, 10.0];

/// A pose and the deviation there.
type Clean = (Vec<f64>, [f64; 3]);

/// Machine without errors, parameters, poses with the deviations of the true machine.
fn setting(random: &mut Random, count: usize) -> (Machine, Vec<Parameter>, Vec<Clean>) {
    let (truth, blank) = (five(TRUTH), five(""));
    let parameters = wanted(&blank, &WORDS);
    let poses = five_poses(random, count);
    let clean = poses.into_iter().map(|p| (p.clone(), deviation(&truth, &p))).collect();
    (blank, parameters, clean)
}

fn weighed(model: &FitModel<'_>, data: &[Measurement], robust: bool) -> (ParameterFit, Solution) {
    let found = solve(model, data, robust);
    let solution = Solution::of(&found, model.parameters());
    (found, solution)
}

#[test]
fn robust_intervals_cover_the_truth_with_and_without_bumped_points() {
    let mut random = Random::new(601);
    let (blank, parameters, clean) = setting(&mut random, 60);
    let model = FitModel::new(&blank, &parameters);
    for bumped in [0, 6] {
        let mut coverage = Coverage::default();
        for _ in 0..300 {
            let noisy = |(i, (p, d)): (usize, &Clean)| {
                let size = if i < bumped { 0.1 } else { 2e-3 };
                measured(p, d.map(|d| d + size * normal(&mut random)))
            };
            let data: Vec<Measurement> = clean.iter().enumerate().map(noisy).collect();
            let (_, solution) = weighed(&model, &data, true);
            coverage.count(&parameters, &solution, &KNOWN, None);
        }
        let share = coverage.share();
        assert!((0.93..0.97).contains(&share), "{bumped} bumped: {share}");
    }
}

/// An error curve read by itself: a measurement of X at one position.
fn single(direction: Direction, x: f64, value: f64) -> Measurement {
    let source = Source { place: ErrorSite::Component(3), direction };
    let mut one = measured(&[0.0, 0.0, 0.0, x, 0.0], [0.0; 3]);
    let lever = if direction.is_rotation() { 300.0 } else { 1.0 };
    one.reading = Reading::Error { value: value * lever, source };
    one.approach = Approach::Mean;
    one
}

#[test]
fn unlike_quantities_have_variances_of_their_own() {
    let mut random = Random::new(602);
    let (blank, parameters, clean) = setting(&mut random, 40);
    let model = FitModel::new(&blank, &parameters);
    let (mut coverage, mut sigmas) = (Coverage::default(), [0.0; 3]);
    for robust in [false, true] {
        for _ in 0..200 {
            let noisy = |(p, d): &Clean| measured(p, d.map(|d| d + 5e-3 * normal(&mut random)));
            let mut data: Vec<Measurement> = clean.iter().map(noisy).collect();
            for i in 0..20 {
                let x = 25.0 * f64::from(i);
                let (straightness, angle) = (8e-6 * x - 20e-9 * x * x, 10e-9 * x);
                data.push(single(Direction::Y, x, straightness + 2e-4 * normal(&mut random)));
                data.push(single(Direction::A, x, angle + 1e-6 * normal(&mut random)));
            }
            let (found, solution) = weighed(&model, &data, robust);
            coverage.count(&parameters, &solution, &KNOWN, None);
            let kinds: Vec<Option<ReadingKind>> = found.scatter.iter().map(|s| s.of).collect();
            assert_eq!(kinds, [Some(ReadingKind::Deviation), Some(ReadingKind::Error), Some(ReadingKind::Angle)]);
            sigmas.iter_mut().zip(&found.scatter).for_each(|(sum, s)| *sum += s.sigma / 400.0);
        }
    }
    // 5 um, 0.2 um, and 1 urad over 300 mm; the mean of 400 standard deviations from 20 readings is that close.
    for (found, known) in sigmas.into_iter().zip([5e-3, 2e-4, 3e-4]) {
        assert!((found / known - 1.0).abs() < 0.06, "{found} {known}");
    }
    assert!((0.93..0.97).contains(&coverage.share()), "{}", coverage.share());
}

/// Six readings of an angle have four to spare: intervals of parameters that hang on them are wider than the others.
#[test]
fn what_hangs_on_few_readings_has_the_students_factor_of_those() {
    let mut random = Random::new(605);
    let (blank, parameters, clean) = setting(&mut random, 40);
    let model = FitModel::new(&blank, &parameters);
    for robust in [false, true] {
        let (mut coverage, mut few) = (Coverage::default(), 0.0_f64);
        for _ in 0..300 {
            let noisy = |(p, d): &Clean| measured(p, d.map(|d| d + 2e-3 * normal(&mut random)));
            let mut data: Vec<Measurement> = clean.iter().map(noisy).collect();
            for i in 0..6 {
                let x = 90.0 * f64::from(i);
                data.push(single(Direction::A, x, 10e-9 * x + 1e-7 * normal(&mut random)));
            }
            let (_, solution) = weighed(&model, &data, robust);
            coverage.count(&parameters[5..], &after(&solution, 5), &KNOWN[5..], None);
            few = few.max(solution.estimates[6].coverage.unwrap());
            assert!(solution.estimates[0].coverage.unwrap() < 2.1);
        }
        // Student's, for four degrees of freedom; with robust weights for less.
        assert!(few > 2.7, "{few}");
        assert!((0.92..0.98).contains(&coverage.share()), "{robust}: {}", coverage.share());
    }
}

/// A solution without its first estimates.
fn after(solution: &Solution, first: usize) -> Solution {
    let mut rest = solution.clone();
    rest.estimates.drain(..first);
    rest
}

#[test]
fn intervals_from_few_readings_are_students() {
    let mut random = Random::new(603);
    let (truth, blank) = (five("errors: { EC0Y: 12 urad, EX0C: 6 um }\n"), five(""));
    let parameters = wanted(&blank, &["EC0Y", "EX0C"]);
    let model = FitModel::new(&blank, &parameters);
    let (mut student, mut plain) = (Coverage::default(), Coverage::default());
    for _ in 0..2000 {
        let one = |p: &Vec<f64>| measured(p, deviation(&truth, p).map(|d| d + 2e-3 * normal(&mut random)));
        let poses = five_poses(&mut Random::new(604), 2);
        let data: Vec<Measurement> = poses.iter().map(one).collect();
        let (_, solution) = weighed(&model, &data, false);
        assert_eq!(solution.degrees_of_freedom, 4);
        student.count(&parameters, &solution, &[12.0, 6.0], Some(solution.estimates[0].coverage.unwrap()));
        plain.count(&parameters, &solution, &[12.0, 6.0], Some(1.96));
    }
    assert!((0.935..0.965).contains(&student.share()), "{}", student.share());
    assert!(plain.share() < 0.9, "{}", plain.share());
}

#[test]
fn uncertainties_are_lengths_of_lengths_and_angles_of_angles() {
    let rows = "0,1,2,0.5,1\n100,2,3,0.5,1\n200,3,5,0.5,1\n300,5,5,0.5,1\n400,6,8,0.5,1\n";
    let both = format!("X,EYX [um],EBX [urad],u [um],u [urad]\n{rows}");
    let report = json(&identified(both.as_bytes(), &["--fit", "EYX:poly1,EBX:poly1", "--format", "json"]).0);
    // Weights are given: one variance for all, and no other is looked for.
    assert!(report["scatter"].as_array().unwrap().is_empty() && report["sigma_um"].is_number(), "{report}");
    // By hand: residuals of the two straight lines over their uncertainties, 10 readings less 4 unknowns.
    let line = |y: [f64; 5]| {
        let (x, n) = ([0.0, 1.0, 2.0, 3.0, 4.0_f64], 5.0);
        let (mx, my) = (2.0, y.iter().sum::<f64>() / n);
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / 10.0;
        x.iter().zip(&y).map(|(x, y)| (y - my - slope * (x - mx)).powi(2)).sum::<f64>()
    };
    let squares = line([1.0, 2.0, 3.0, 5.0, 6.0]) / 0.25 + line([2.0, 3.0, 5.0, 5.0, 8.0]);
    let sigma = report["sigma_um"].as_f64().unwrap();
    assert!((sigma - (squares / 6.0_f64).sqrt()).abs() < 1e-6, "{sigma}");
    let said = |header: &str| {
        let (output, _) = identified(format!("{header}\n0,1,2\n").as_bytes(), &["--fit", "EYX:poly1"]);
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(said("X,EYX [um],u [urad]").contains("lengths are read: give `u [um]`"));
    assert!(said("X,EBX [urad],u [um]").contains("angles are read: give `u [urad]`"));
    assert!(said("X,dx [um],u [urad]").contains("lengths are read: give `u [um]`"));
    assert!(said("X,EYX [um],u [kg]").contains("not a unit"));
}

#[test]
fn only_components_that_were_read_have_a_first_reading() {
    let data = "X,Z,run,rel.dx [um]\n0,0,a,0\n100,0,a,1\n300,-100,a,2\n400,-300,a,4\n";
    let report = json(&identified(data.as_bytes(), &["--fit", "EXX:poly1", "--format", "json"]).0);
    let instruments: Vec<&str> =
        report["instruments"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(instruments, ["first a.x"]);
}
