//! Parameters beside plain curves: blocks, knots, both directions, tied errors, own parameters, bounded slopes.

use super::identify::{FIVE, deviation, fitted_text, five, five_poses, json, measured, normal, run};
use super::language::{read, silent};
use super::oracle::program::Folder;
use super::oracle::random::Random;
use abbe::evaluate::Order;
use abbe::identify::{FitModel, Measurement, Parameter, ParameterFit, fit, parameters, slope_bounds};
use abbe::machine::{Approach, Machine};
use abbe::syntax::{IdentifyEntry, Scalar};

fn request(fit: &[&str]) -> IdentifyEntry {
    IdentifyEntry { fit: fit.iter().map(|w| (*w).to_owned()).collect(), ..IdentifyEntry::default() }
}

fn list(machine: &Machine, request: &IdentifyEntry) -> Vec<Parameter> {
    parameters(machine, request).unwrap_or_else(|refusal| panic!("{refusal:?}"))
}

fn data(truth: &Machine, count: usize, seed: u64) -> Vec<Measurement> {
    five_poses(&mut Random::new(seed), count).iter().map(|p| measured(p, deviation(truth, p))).collect()
}

fn solved(machine: &Machine, request: &IdentifyEntry, data: &[Measurement]) -> (Vec<Parameter>, ParameterFit) {
    let unknowns = list(machine, request);
    let bounds = slope_bounds(machine, request, &unknowns).unwrap();
    let model = FitModel::new(machine, &unknowns).with_slope_bounds(&bounds);
    let found = fit(&model, data, vec![1.0; data.len()]);
    (unknowns, found)
}

fn value(unknowns: &[Parameter], found: &ParameterFit, name: &str) -> f64 {
    let j = unknowns.iter().position(|p| p.name == name).unwrap_or_else(|| panic!("{name}"));
    unknowns[j].in_unit(found.theta[j])
}

fn number(x: f64) -> Scalar {
    Scalar::Number(x)
}

#[test]
fn blocks_are_linear_within_and_continuous_across_and_the_file_says_them() {
    let points = "[[0 mm, 0 um], [120 mm, 4 um], [500 mm, -2 um]]";
    let truth = five(&format!(
        "errors: {{ EYX: {{ points: {points} }}, EXX: {{ points: {points}, interpolation: cubic }} }}\n"
    ));
    let blank = five("");
    let mut wanted = request(&["EYX:blocks", "EXX:spline"]);
    for name in ["EYX", "EXX"] {
        wanted.knots.insert(name.to_owned(), vec![number(0.0), Scalar::Text("120 mm".to_owned())]);
    }
    let (unknowns, found) = solved(&blank, &wanted, &data(&truth, 60, 91));
    for name in ["EYX", "EXX"] {
        assert!((value(&unknowns, &found, &format!("{name}:120mm")) - 4.0).abs() < 1e-5);
        assert!((value(&unknowns, &found, &format!("{name}:500mm")) + 2.0).abs() < 1e-5);
    }
    let text = fitted_text(&blank, &unknowns, &found);
    assert!(text.contains("interpolation: linear") && text.contains("interpolation: cubic"), "{text}");
    let fitted = silent(&[("machine.yaml", &text)]);
    for pose in five_poses(&mut Random::new(92), 20) {
        let (a, b) = (deviation(&fitted, &pose), deviation(&truth, &pose));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8), "{a:?} {b:?}");
    }
    let even = list(&blank, &request(&["EYX:blocks4", "ECC:blocks4"]));
    let names: Vec<&str> = even.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "EYX:0mm",
            "EYX:125mm",
            "EYX:250mm",
            "EYX:375mm",
            "EYX:500mm",
            "ECC:0deg",
            "ECC:90deg",
            "ECC:180deg",
            "ECC:270deg"
        ]
    );
}

/// The truth is one cubic per piece, smooth across the knots, by its own formula: no B-spline of ours.
#[test]
fn b_splines_are_found_and_the_file_says_them() {
    let cube = |x: f64| if x > 0.0 { x * x * x } else { 0.0 };
    let exx = |x: f64| 4.0 + 0.02 * x - 2e-7 * x * x * x + 9e-7 * cube(x - 120.0) - 1.5e-6 * cube(x - 300.0);
    let square = |x: f64| if x > 0.0 { x * x } else { 0.0 };
    let eyx = |x: f64| -1.0 + 0.01 * x - 1e-4 * square(x - 120.0);
    let blank = five("");
    let mut wanted = request(&["EXX:bspline", "EYX:bspline/2", "ECC:bspline4"]);
    let knots = |list: &[f64]| list.iter().map(|q| number(*q)).collect::<Vec<_>>();
    wanted.knots.insert("EXX".to_owned(), knots(&[120.0, 300.0]));
    wanted.knots.insert("EYX".to_owned(), knots(&[120.0]));
    let points: Vec<String> = (0..=500).map(|x| format!("[{x} mm, {} um]", exx(f64::from(x)))).collect();
    let bent: Vec<String> = (0..=500).map(|x| format!("[{x} mm, {} um]", eyx(f64::from(x)))).collect();
    let ecc = "{ bspline: { knots: [0, 90, 180, 270, 360], coefficients: [3 urad, 20 urad, -10 urad, 5 urad] } }";
    let truth = five(&format!(
        "errors: {{ EXX: {{ points: [{}] }}, EYX: {{ points: [{}] }}, ECC: {ecc} }}\n",
        points.join(", "),
        bent.join(", ")
    ));
    // Whole millimetres, where the table is the formula.
    let whole = |mut pose: Vec<f64>| {
        let x = five("").axis_index("X").unwrap();
        pose[x] = libm::round(pose[x]);
        pose
    };
    let poses: Vec<Vec<f64>> = five_poses(&mut Random::new(191), 200).into_iter().map(whole).collect();
    let rows: Vec<Measurement> = poses.iter().map(|p| measured(p, deviation(&truth, p))).collect();
    let (unknowns, found) = solved(&blank, &wanted, &rows);
    assert_eq!(unknowns.iter().filter(|p| p.name.starts_with("EXX:b@")).count(), 6);
    assert_eq!(unknowns.iter().filter(|p| p.name.starts_with("EYX:b@")).count(), 4);
    assert!((value(&unknowns, &found, "EXX:b@0mm") - exx(0.0)).abs() < 1e-5);
    assert!((value(&unknowns, &found, "EXX:b@500mm") - exx(500.0)).abs() < 1e-5);
    let ecc: Vec<f64> = unknowns
        .iter()
        .zip(&found.theta)
        .filter(|(p, _)| p.name.starts_with("ECC"))
        .map(|(p, t)| p.in_unit(*t))
        .collect();
    assert!(ecc.iter().zip([3.0, 20.0, -10.0, 5.0]).all(|(a, b)| (a - b).abs() < 1e-5), "{ecc:?}");
    let text = fitted_text(&blank, &unknowns, &found);
    assert!(text.contains("bspline: { degree: 3") && text.contains("bspline: { degree: 2"), "{text}");
    let fitted = silent(&[("machine.yaml", &text)]);
    for pose in five_poses(&mut Random::new(192), 50).into_iter().map(whole) {
        let (a, b) = (deviation(&fitted, &pose), deviation(&truth, &pose));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8), "{a:?} {b:?}");
    }
    // A fit that starts at the fitted machine is there already.
    let again = list(&fitted, &wanted);
    for (p, start) in again.iter().zip(&found.theta) {
        assert!((p.start - start).abs() < 1e-13, "{}: {} {start}", p.name, p.start);
    }
}

#[test]
fn both_directions_are_found_and_written() {
    let truth = five(
        "errors: { EXX: { forward: { polynomial: [1 um, 8 um/m] }, reverse: { polynomial: [-2 um, 12 um/m] } }, EC0Y: 5 urad }\n",
    );
    let blank = five("");
    let poses = five_poses(&mut Random::new(93), 60);
    let one = |(i, pose): (usize, &Vec<f64>)| {
        let approach = [Approach::Forward, Approach::Reverse, Approach::Mean][i % 3];
        let d =
            abbe::evaluate::evaluate(&truth, &approach.at_pose(pose), Order::Exact, abbe::evaluate::Frame::Workpiece);
        Measurement { approach, ..measured(pose, d.deviation.position.into()) }
    };
    let data: Vec<Measurement> = poses.iter().enumerate().map(one).collect();
    let (unknowns, found) = solved(&blank, &request(&["EXX+-:poly1", "EC0Y"]), &data);
    let expected = [("EXX+:x^0", 1.0), ("EXX+:x^1", 8.0), ("EXX-:x^0", -2.0), ("EXX-:x^1", 12.0), ("EC0Y", 5.0)];
    for (name, known) in expected {
        assert!((value(&unknowns, &found, name) - known).abs() < 1e-5, "{name}");
    }
    let fitted = silent(&[("machine.yaml", &fitted_text(&blank, &unknowns, &found))]);
    for approach in [Approach::Forward, Approach::Reverse, Approach::Mean] {
        let at = |machine: &Machine| {
            machine.component_values(machine.axis_index("X").unwrap(), &approach.at_position(300.0))[0]
        };
        assert!((at(&fitted) - at(&truth)).abs() < 1e-9);
    }
}

#[test]
fn tied_errors_and_own_parameters_move_together() {
    let truth = five(
        "errors: { EX0C: 6 um, EY0C: -3 um, EBX: { polynomial: [0 urad, 20 urad/m] }, EYX: { polynomial: [0 um, 0 um/m, 10 um/m^2] } }\n",
    );
    let blank = five("");
    let mut wanted = request(&["EX0C", "f1"]);
    wanted.tied.insert("EY0C".to_owned(), [("EX0C".to_owned(), number(-0.5))].into_iter().collect());
    let powers = |c: &[f64]| c.iter().copied().map(number).collect::<Vec<_>>();
    let own = [("EBX".to_owned(), powers(&[0.0, 1.0])), ("EYX".to_owned(), powers(&[0.0, 0.0, 0.5]))];
    wanted.parameters.insert("f1".to_owned(), own.into_iter().collect());
    let (unknowns, found) = solved(&blank, &wanted, &data(&truth, 30, 94));
    assert_eq!(unknowns.len(), 2);
    assert!(
        (value(&unknowns, &found, "EX0C") - 6.0).abs() < 1e-6 && (value(&unknowns, &found, "f1") - 20.0).abs() < 1e-5
    );
    assert_eq!(unknowns[1].unit, "urad/m");
    let fitted = silent(&[("machine.yaml", &fitted_text(&blank, &unknowns, &found))]);
    for pose in five_poses(&mut Random::new(95), 10) {
        let (a, b) = (deviation(&fitted, &pose), deviation(&truth, &pose));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8));
    }
}

/// X was measured over a quarter of its travel, with noise: a cubic runs away beyond.
#[test]
fn a_bounded_slope_keeps_a_curve_flat_where_nothing_was_measured() {
    let truth = five("errors: { EXX: { polynomial: [0 um, 10 um/m] } }\n");
    let blank = five("");
    let mut random = Random::new(96);
    let mut data = data(&truth, 60, 97);
    for m in &mut data {
        m.pose[3] *= 0.25;
        let d = deviation(&truth, &m.pose).map(|d| d + 2e-3 * normal(&mut random));
        *m = measured(&m.pose, d);
    }
    let at_end = |wanted: &IdentifyEntry| {
        let (unknowns, found) = solved(&blank, wanted, &data);
        let fitted = silent(&[("machine.yaml", &fitted_text(&blank, &unknowns, &found))]);
        (fitted.component_values(3, &Approach::Mean.at_position(500.0))[0] - 5e-3).abs()
    };
    let mut bounded = request(&["EXX:poly5"]);
    let loose = at_end(&bounded);
    bounded.slopes.insert("EXX".to_owned(), Scalar::Text("20 um/m".to_owned()));
    let tight = at_end(&bounded);
    // Without a bound only the prior holds the end: within 3 mm.
    assert!(loose > 0.05 && tight < 0.002, "{loose} {tight}");
}

#[test]
fn the_model_of_order_two_is_fitted_with_its_own_derivatives() {
    let blank = five("");
    let unknowns = list(&blank, &request(&["EC0Y", "EB0Z", "EX0C", "EA0C", "EXX:poly1", "workpiece"]));
    let theta: Vec<f64> = unknowns.iter().map(|p| 20e-3 / p.size).collect();
    let poses = five_poses(&mut Random::new(98), 12);
    let rows: Vec<Measurement> = poses.iter().map(|p| measured(p, [0.0; 3])).collect();
    let exact = FitModel::new(&blank, &unknowns);
    for (order, bound) in [(Order::Degree(1), 1e-4), (Order::Degree(2), 1e-7)] {
        let model = FitModel::new(&blank, &unknowns).to_order(order);
        let data: Vec<Measurement> =
            poses.iter().zip(&rows).map(|(p, m)| measured(p, model.prediction(m, &theta).into())).collect();
        let gap = rows.iter().map(|m| (model.prediction(m, &theta) - exact.prediction(m, &theta)).norm());
        let gap = gap.fold(0.0, f64::max);
        assert!(gap > 0.0 && gap < bound, "{gap:e}");
        // Newton's last steps are quadratic only with the derivatives of this very model.
        let found = fit(&model, &data, vec![1.0; data.len()]);
        let left = model.residuals(&data, &found.theta).iter().map(|r| r.norm()).fold(0.0, f64::max);
        assert!(found.converged && found.steps <= 4 && left < 1e-10, "{} steps, {left:e}", found.steps);
        // The derivatives against differences of the model itself.
        let reduced = model.triangle(&rows[..4], &[1.0; 4], &theta);
        let column = |j: usize| {
            let moved = |by: f64| {
                let mut changed = theta.clone();
                changed[j] += by / unknowns[j].size;
                rows[..4]
                    .iter()
                    .flat_map(|m| model.prediction(m, &changed).iter().copied().collect::<Vec<_>>())
                    .collect::<Vec<_>>()
            };
            moved(1e-2).iter().zip(moved(-1e-2)).map(|(a, b)| (a - b) / 2e-2).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..unknowns.len()).map(column).collect();
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
                let own = reduced.r.column(i).dot(&reduced.r.column(j)) / unknowns[i].size / unknowns[j].size;
                assert!((dot - own).abs() < 1e-8 * (1.0 + dot.abs()), "{order:?} {i} {j}: {dot} {own}");
            }
        }
    }
}

#[test]
fn requests_that_make_no_sense_are_refused_in_words() {
    let folder = Folder::new();
    let data = folder.write("data.csv", "X,dx [um]\n1,2\n3,4\n5,6\n7,8\n");
    for section in [
        "{ fit: [EXX:blocks] }",
        "{ fit: [EXX:blocks0] }",
        "{ fit: [EXX:spline], knots: { EXX: [0, 900] } }",
        "{ fit: [EXX:bspline] }",
        "{ fit: [EXX:bspline5/4] }",
        "{ fit: [EXX:bspline5/0] }",
        "{ fit: [EXX:bspline5, EXX:spline5] }",
        "{ fit: [EXX:bspline5, EXX:bspline6] }",
        "{ fit: [EXX:spline4, EXX:spline5] }",
        "{ fit: [EXX:spline], knots: { EXX: [10, 10] } }",
        "{ fit: [EXX:spline], knots: { EXX: [10 deg] } }",
        "{ fit: [EC0Y+] }",
        "{ fit: [EXX+:poly1, EXX:poly1] }",
        "{ fit: [EXX], tied: { EXX: { EYX: 1 } } }",
        "{ fit: [EXX], tied: { EYX: { EXX: 1, EZX: 1 } } }",
        "{ fit: [EXX], tied: { EBX: { EXX: 1 } } }",
        "{ fit: [EXX], tied: { EYX: { EZX: 1 } } }",
        "{ fit: [f], parameters: { f: { EQQ: [1] } } }",
        "{ fit: [f], parameters: { f: { EXX: [0, 0] } } }",
        "{ fit: [tool], parameters: { tool: { EXX: [1] } } }",
        "{ fit: [f], parameters: { f: { EC0Y: [0, 1] } } }",
        "{ fit: [EXX], slopes: { EYX: 2 um/m } }",
        "{ fit: [EXX], slopes: { EXX: 2 um } }",
        "{ fit: [EXX], slopes: { EXX: -2 um/m } }",
    ] {
        let machine = folder.write("machine.yaml", &format!("{FIVE}identify: {section}\n"));
        let output = run(&["identify", machine.to_str().unwrap(), "--data", data.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let code = ["E0502", "E0215", "E0405", "E0205", "E0213"].iter().any(|code| said.contains(code));
        assert!(code && output.status.code() == Some(1), "{section}: {said}");
    }
}

#[test]
fn the_section_is_read_and_fits() {
    let section = "identify:\n  fit: [EXX:spline, EX0C, f1]\n  knots: { EXX: [0, 200 mm, 500] }\n  tied: { EY0C: { EX0C: -1 } }\n  parameters: { f1: { EBX: [0, 1] } }\n  slopes: { EXX: 50 um/m }\n";
    let (machine, diagnostics) = read(&[("machine.yaml", &format!("{FIVE}{section}"))]);
    assert!(machine.is_some() && diagnostics.iter().next().is_none(), "{:?}", diagnostics.iter().next());
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", &format!("{FIVE}{section}"));
    let rows: String = (0..30).map(|i| format!("{},{},{},1,2,3\n", i * 17 % 500, i * 31 % 450, i * 12)).collect();
    let data = folder.write("data.csv", &format!("X,Y,C,dx [um],dy [um],dz [um]\n{rows}"));
    let arguments = ["identify", machine.to_str().unwrap(), "--data", data.to_str().unwrap(), "--format", "json"];
    let report = json(&run(&arguments));
    assert_eq!(report["unknowns"], 5);
    let again = json(&run(&[&arguments[..], &["--order", "2"]].concat()));
    assert_eq!(again["unknowns"], 5);
}

/// `linear` and a parameter of one's own start again from the values that they have written.
#[test]
fn sums_of_powers_start_where_the_file_is() {
    let truth = five(
        "errors: { EBX: { polynomial: [0 urad, 12 urad/m] }, EZX: { polynomial: [0 um, 0 um/m, -6 um/m^2] }, EXX: { polynomial: [0 um, 9 um/m] }, EAY: { polynomial: [0 urad, 7 urad/m] }, EZY: { polynomial: [0 um, 0 um/m, 3.5 um/m^2] } }\n",
    );
    let blank = five("");
    let mut wanted = request(&["f1", "EXX:poly1"]);
    let factors = [("EBX", vec![number(0.0), number(1.0)]), ("EZX", vec![number(0.0), number(0.0), number(-0.5)])];
    wanted
        .parameters
        .insert("f1".to_owned(), factors.map(|(name, list)| (name.to_owned(), list)).into_iter().collect());
    for wanted in [request(&["linear"]), wanted] {
        let (unknowns, found) = solved(&blank, &wanted, &data(&truth, 40, 96));
        let fitted = silent(&[("machine.yaml", &fitted_text(&blank, &unknowns, &found))]);
        let again = list(&fitted, &wanted);
        for ((parameter, theta), before) in again.iter().zip(&found.theta).zip(&unknowns) {
            let off = parameter.in_unit(parameter.start) - before.in_unit(*theta);
            assert!(off.abs() < 1e-6, "{}: {off}", parameter.name);
        }
        assert!(again.iter().any(|p| p.start != 0.0));
        // A curve that is no such sum is replaced.
        let other = five("errors: { EBX: { polynomial: [0 urad, 12 urad/m] }, EZX: { polynomial: [0 um, 5 um/m] } }\n");
        assert!(list(&other, &wanted).iter().filter(|p| p.terms.len() > 1).all(|p| p.start == 0.0));
    }
}
