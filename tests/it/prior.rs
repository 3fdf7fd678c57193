//! Prior knowledge does not bend the parameters that the data determine, and keeps the others.

use super::identify::{deviation, five, five_poses, measured, normal, solve, wanted};
use super::oracle::random::Random;
use abbe::evaluate::Frame;
use abbe::identify::{FitModel, Measurement, ParameterFit, Reading, fit, slope_bounds};
use abbe::lower::{ErrorSite, Source};
use abbe::machine::Direction;
use abbe::syntax::{IdentifyEntry, Scalar};
use nalgebra::{DMatrix, DVector};

/// The best polynomial through points, in powers about the middle: its values at places.
fn best(points: &[(f64, f64)], degree: usize, places: &[f64]) -> Vec<f64> {
    let middle = points.iter().map(|(x, _)| x).sum::<f64>() / points.len() as f64;
    let power = |x: f64, k: usize| ((x - middle) / 100.0).powi(k as i32);
    let rows = DMatrix::from_fn(points.len(), degree + 1, |i, k| power(points[i].0, k));
    let right = DVector::from_fn(points.len(), |i, _| points[i].1);
    let c = rows.svd(true, true).solve(&right, 1e-14).unwrap();
    places.iter().map(|x| (0..=degree).map(|k| c[k] * power(*x, k)).sum()).collect()
}

fn is_the_best_cubic(found: &ParameterFit, points: &[(f64, f64)], places: &[f64], within: f64) {
    let curve = |x: &f64| found.theta.iter().enumerate().map(|(k, c)| c * x.powi(k as i32)).sum::<f64>();
    for (ours, theirs) in places.iter().map(curve).zip(best(points, 3, places)) {
        assert!((ours - theirs).abs() < within, "{ours} {theirs}");
    }
}

/// A single reading of EXX (mm) or EBX (rad) at a position of X, as the reader makes it.
fn single(k: usize, x: f64, value: f64) -> Measurement {
    let mut one = measured(&[0.0, 0.0, 0.0, x, 0.0], [0.0; 3]);
    let source = Source { place: ErrorSite::Component(3), direction: Direction::ALL[k] };
    one.reading = Reading::Error { source, value: if k < 3 { value } else { 300.0 * value } };
    one
}

#[test]
fn powers_about_a_zero_point_far_away_are_those_of_least_squares() {
    let machine = five("");
    let parameters = wanted(&machine, &["EXX:poly3"]);
    let mut random = Random::new(181);
    let mut reading = |x: f64| 5e-3 * (x / 30.0).sin() + 2e-4 * normal(&mut random);
    let points: Vec<(f64, f64)> = (0..150).map(|i| 300.0 + f64::from(i)).map(|x| (x, reading(x))).collect();
    let data: Vec<Measurement> =
        points.iter().map(|(x, d)| measured(&[0.0, 0.0, 0.0, *x, 0.0], [*d, 0.0, 0.0])).collect();
    let (found, _) = solve(&machine, &parameters, &data);
    // A hundredth of a reading's scatter: the curve is 1.1 mm at X = 0, where it is held within 0.3 mm.
    is_the_best_cubic(&found, &points, &[300.0, 333.0, 375.0, 420.0, 449.0], 2e-6);
}

#[test]
fn angles_given_as_single_errors_are_fitted_as_closely_as_lengths() {
    let machine = five("");
    let parameters = wanted(&machine, &["EBX:poly3"]);
    let mut random = Random::new(182);
    let mut reading = |x: f64| 20e-6 * (x / 90.0).sin() + 3e-7 * normal(&mut random);
    let points: Vec<(f64, f64)> = (0..26).map(|i| 20.0 * f64::from(i)).map(|x| (x, reading(x))).collect();
    let data: Vec<Measurement> = points.iter().map(|(x, value)| single(4, *x, *value)).collect();
    let (found, solution) = solve(&machine, &parameters, &data);
    is_the_best_cubic(&found, &points, &[0.0, 120.0, 260.0, 500.0], 1e-11);
    assert_eq!(solution.rank, 4);
}

/// A laser that reads six errors at once: those of one do not count as noise of the others.
#[test]
fn lengths_and_angles_in_one_file_are_each_known_as_well_as_alone() {
    let machine = five("");
    let mut random = Random::new(184);
    let at = |i: i32| 20.0 * f64::from(i);
    let lengths: Vec<Measurement> = (0..26).map(|i| single(0, at(i), 3e-4 * normal(&mut random))).collect();
    let angles: Vec<Measurement> = (0..26).map(|i| single(4, at(i), 1e-6 * normal(&mut random))).collect();
    let sigmas = |words: &[&str], data: &[Measurement]| -> Vec<f64> {
        let parameters = wanted(&machine, words);
        let (_, solution) = solve(&machine, &parameters, data);
        solution.estimates.iter().map(|e| e.sigma.unwrap()).collect()
    };
    let alone = [sigmas(&["EXX:poly2"], &lengths), sigmas(&["EBX:poly2"], &angles)].concat();
    let both = sigmas(&["EXX:poly2", "EBX:poly2"], &[lengths, angles].concat());
    // 1 urad is 0.3 um over 300 mm: the same noise, of which 26 readings know a quarter.
    assert!(alone.iter().zip(&both).all(|(a, b)| (0.7..1.4).contains(&(a / b))), "{alone:?} {both:?}");
}

#[test]
fn what_one_component_shows_only_in_products_stays_at_home() {
    let truth = five(
        "errors: { EC0Y: 12 urad, EB0Z: -20 urad, EA0Z: 7 urad, EX0C: 6 um, EY0C: -9 um, EA0C: 15 urad, EB0A: 11 urad }\n",
    );
    let blank = five("");
    let parameters = wanted(&blank, &["location"]);
    let mut random = Random::new(183);
    let poses = five_poses(&mut random, 60);
    let seen = |pose: &Vec<f64>| {
        let mut one = measured(pose, deviation(&truth, pose));
        let [_, _, z] = deviation(&truth, pose);
        one.reading = Reading::Deviation { values: [None, None, Some(z)], frame: Frame::Workpiece, zero: [None; 3] };
        one
    };
    let mut data: Vec<Measurement> = poses.iter().map(seen).collect();
    for one in &mut data {
        if let Reading::Deviation { values: [_, _, Some(z)], .. } = &mut one.reading {
            *z += 1e-3 * normal(&mut random);
        }
    }
    let (found, _) = solve(&blank, &parameters, &data);
    let away = |(p, theta): (&abbe::identify::Parameter, &f64)| (theta - p.start).abs() * p.size;
    let farthest = parameters.iter().zip(&found.theta).map(away).fold(0.0, f64::max);
    assert!(farthest < 0.05, "{farthest} mm");
}

#[test]
fn as_many_readings_as_unknowns_leave_no_uncertainty_to_state() {
    let machine = five("");
    let parameters = wanted(&machine, &["EC0Y"]);
    let mut one = measured(&[0.0, 0.0, 300.0, 100.0, 0.0], [0.0; 3]);
    one.reading = Reading::Deviation { values: [Some(3e-3), None, None], frame: Frame::Workpiece, zero: [None; 3] };
    let (_, solution) = solve(&machine, &parameters, &[one]);
    assert_eq!((solution.rank, solution.degrees_of_freedom), (1, 0));
    assert!(solution.estimates[0].sigma.is_none() && solution.estimates[0].value < -5e-6);
}

#[test]
fn a_bound_on_the_slope_carries_blocks_and_b_splines_over_what_was_not_measured() {
    let machine = five("");
    for basis in ["EXX:blocks8", "EXX:bspline8", "EXX:spline8"] {
        let mut request = IdentifyEntry { fit: vec![basis.to_owned()], ..IdentifyEntry::default() };
        request.slopes.insert("EXX".to_owned(), Scalar::Text("20 um/m".to_owned()));
        let parameters = abbe::identify::parameters(&machine, &request).unwrap();
        let bounds = slope_bounds(&machine, &request, &parameters).unwrap();
        let model = FitModel::new(&machine, &parameters).with_slope_bounds(&bounds);
        let reading = |x: f64| measured(&[0.0, 0.0, 0.0, x, 0.0], [4e-3 + 1e-3 * (x / 40.0).sin(), 0.0, 0.0]);
        let data: Vec<Measurement> = (0..41).map(|i| reading(100.0 + 5.0 * f64::from(i))).collect();
        let found = fit(&model, &data, vec![1.0; data.len()]);
        let solution = abbe::identify::Solution::of(&found, &parameters);
        let curve = |x: f64| {
            let one = |(p, theta): (&abbe::identify::Parameter, f64)| p.terms[0].basis.value(x) * theta;
            parameters.iter().zip(solution.theta()).map(one).sum::<f64>()
        };
        let slopes = [(curve(100.0) - curve(0.0)) / 100.0, (curve(500.0) - curve(300.0)) / 200.0];
        assert!(slopes.iter().all(|slope| slope.abs() < 50e-6), "{basis}: {slopes:?}");
    }
}
