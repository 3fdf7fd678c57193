//! Values known before the data: what they are worth by a least squares that shares no code with the program.

use super::fits::{identify, said};
use super::identify::{FIVE, json, normal, run};
use super::measurements::{actual, brought_to};
use super::oracle::machines::{Extra, Sample};
use super::oracle::program::Folder;
use super::oracle::random::Random;
use super::oracle::rigid::{Axis, Conventions, Machine};
use super::oracle::yaml;
use nalgebra::{DMatrix, Rotation3, Vector3};
use serde_json::Value;

/// Location errors of the two rotary axes: axis of the walk, direction, name.
const FITTED: [(usize, usize, &str); 8] = [
    (0, 0, "EX0C"),
    (0, 1, "EY0C"),
    (0, 3, "EA0C"),
    (0, 4, "EB0C"),
    (1, 1, "EY0A"),
    (1, 2, "EZ0A"),
    (1, 4, "EB0A"),
    (1, 5, "EC0A"),
];
/// Standard deviation of the bar's readings (mm).
const NOISE: f64 = 1e-3;

pub fn five_axes() -> Sample {
    let axis = |name: &str, origin: [f64; 3]| {
        let index = "XYZABC".find(name).unwrap();
        let mut direction = [0.0; 3];
        direction[index % 3] = 1.0;
        let workpiece = ["C", "A", "Y"].contains(&name);
        Axis {
            name: name.to_owned(),
            rotary: index > 2,
            workpiece,
            direct: None,
            direction,
            origin,
            location: [0.0; 6],
        }
    };
    let walk = vec![
        axis("C", [250.0, 225.0, -380.0]),
        axis("A", [250.0, 225.0, -350.0]),
        axis("Y", [0.0; 3]),
        axis("X", [0.0; 3]),
        axis("Z", [0.0; 3]),
    ];
    let travels = [None, Some([-120.0, 30.0]), Some([0.0, 450.0]), Some([0.0, 500.0]), Some([-400.0, 0.0])];
    let axes = travels.map(|travel| Extra { travel, errors: Default::default() }).to_vec();
    let rigid = Machine {
        conventions: Conventions::default(),
        walk,
        spindle: None,
        gauge: [250.0, 225.0, 0.0],
        offset: [0.0, 0.0, -120.0],
        workpiece_origin: [250.0, 225.0, -380.0],
        ..Machine::default()
    };
    Sample { rigid, axes, branches: false }
}

/// A set-up of a bar of 150 mm between a ball on the table and one in the spindle: the ball on the table, and the poses.
struct SetUp {
    ball: Vector3<f64>,
    poses: Vec<Vec<f64>>,
}

/// The bar along three directions while the table turns, and while it tilts; the spindle follows.
fn set_ups(blank: &Sample) -> Vec<SetUp> {
    let middle = |c: f64, a: f64| vec![c, a, 225.0, 250.0, -120.0];
    // The bar keeps its direction in the machine, so that it turns against the table.
    let one = |ball: [f64; 3], along: [f64; 3], angles: Vec<(f64, f64)>| {
        let ball = Vector3::from(ball);
        let tip = |c: f64, a: f64| {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), c.to_radians());
            let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), a.to_radians());
            ball + turn * tilt * Vector3::from(along) * 150.0
        };
        SetUp { ball, poses: angles.iter().map(|(c, a)| brought_to(blank, &middle(*c, *a), &tip(*c, *a))).collect() }
    };
    let turns = || (0..36).map(|i| (10.0 * f64::from(i), 0.0)).collect::<Vec<_>>();
    let tilts = || (0..31).map(|i| (0.0, 30.0 - 4.0 * f64::from(i))).collect::<Vec<_>>();
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    vec![
        one([60.0, 0.0, 60.0], x, turns()),
        one([60.0, 0.0, 60.0], y, turns()),
        one([60.0, 0.0, 60.0], z, turns()),
        one([0.0, 40.0, 60.0], x, tilts()),
        one([0.0, 40.0, 60.0], y, tilts()),
        one([0.0, 40.0, 60.0], z, tilts()),
    ]
}

/// Standard uncertainties of the eight errors (mm, rad): a dense least squares on differences of the rigid model, readings
/// scattering by `noise`, the balls known to `known` (mm).
fn expected(blank: &Sample, set_ups: &[SetUp], noise: f64, known: f64) -> Vec<f64> {
    let unknowns = FITTED.len() + 3 * set_ups.len();
    let lengths = |j: usize, by: f64| -> Vec<f64> {
        let mut machine = blank.clone();
        if let Some((axis, k, _)) = FITTED.get(j) {
            machine.rigid.walk[*axis].location[*k] += by;
        }
        let of = |(s, set_up): (usize, &SetUp)| {
            let mut ball = set_up.ball;
            if j >= FITTED.len() && (j - FITTED.len()) / 3 == s {
                ball[(j - FITTED.len()) % 3] += by;
            }
            set_up.poses.iter().map(|pose| (actual(&machine, pose) - ball).norm()).collect::<Vec<f64>>()
        };
        set_ups.iter().enumerate().flat_map(of).collect()
    };
    let h = 1e-4;
    let columns: Vec<Vec<f64>> = (0..unknowns)
        .map(|j| lengths(j, h).iter().zip(lengths(j, -h)).map(|(up, down)| (up - down) / (2.0 * h * noise)).collect())
        .collect();
    let rows = DMatrix::from_fn(columns[0].len(), unknowns, |i, j| columns[j][i]);
    let mut normal = rows.transpose() * &rows;
    for j in FITTED.len()..unknowns {
        normal[(j, j)] += 1.0 / (known * known);
    }
    let covariance = normal.try_inverse().unwrap();
    (0..FITTED.len()).map(|j| covariance[(j, j)].sqrt()).collect()
}

/// The file of the bar's lengths, of a machine with errors and balls that are not where they are said to be.
fn bar(truth: &Sample, set_ups: &[SetUp], random: &mut Random, known: Option<&str>) -> String {
    let column = if known.is_some() { ",station.u [um]" } else { "" };
    let mut text = format!("C,A,Y,X,Z,length [mm],station,station.x [mm],station.y [mm],station.z [mm]{column}\n");
    let known = known.map_or_else(String::new, |known| format!(",{known}"));
    for (s, set_up) in set_ups.iter().enumerate() {
        let ball = set_up.ball + Vector3::from_fn(|_, _| 0.05 * normal(random));
        for pose in &set_up.poses {
            let length = (actual(truth, pose) - ball).norm() + NOISE * normal(random);
            let cells: Vec<String> = pose.iter().map(f64::to_string).collect();
            let at = set_up.ball;
            text += &format!("{},{length},S{s},{},{},{}{known}\n", cells.join(","), at.x, at.y, at.z);
        }
    }
    text
}

fn estimate(report: &Value, name: &str) -> (f64, f64) {
    let list = report["parameters"].as_array().unwrap();
    let found = list.iter().find(|p| p["name"] == name).unwrap_or_else(|| panic!("{name}: {report}"));
    (found["value"].as_f64().unwrap(), found["type_a"].as_f64().unwrap_or(f64::INFINITY))
}

#[test]
fn a_ball_bar_in_six_set_ups_knows_what_a_dense_least_squares_says() {
    let blank = five_axes();
    let set_ups = set_ups(&blank);
    let mut truth = blank.clone();
    let values = [6e-3, -9e-3, 15e-6, -11e-6, 7e-3, -4e-3, 20e-6, 8e-6];
    FITTED.iter().zip(values).for_each(|((axis, k, _), value)| truth.rigid.walk[*axis].location[*k] = value);
    let folder = Folder::new();
    yaml::write(&blank, &folder);
    let machine = folder.path("machine.yaml");
    let fit: Vec<&str> = FITTED.iter().map(|(_, _, name)| *name).collect();
    let fit = fit.join(",");
    let mut random = Random::new(321);
    let measured = bar(&truth, &set_ups, &mut random, None);
    let known = measured
        .lines()
        .enumerate()
        .map(|(i, line)| format!("{line},{}\n", if i == 0 { "station.u [um]" } else { "50" }));
    let files = [folder.write("free.csv", &measured), folder.write("known.csv", &known.collect::<String>())];
    let priors: Vec<String> = (0..6).flat_map(|s| ["--prior".to_owned(), format!("station S{s} 50 um")]).collect();
    let priors: Vec<&str> = priors.iter().map(String::as_str).collect();
    let base = ["--fit", &fit, "--format", "json"];
    let by_column = json(&identify(&machine, &files[1], &base));
    let by_option = json(&identify(&machine, &files[0], &[&base[..], &priors].concat()));
    let alone = json(&identify(&machine, &files[0], &base));
    assert_eq!(by_column["parameters"], by_option["parameters"]);
    assert_eq!(by_option["known"].as_array().unwrap().len(), 18);
    let noise = by_option["sigma_um"].as_f64().unwrap() * 1e-3;
    assert!((0.8..1.2).contains(&(noise / NOISE)), "{noise}");
    let expected = expected(&blank, &set_ups, noise, 0.05);
    for (((_, k, name), sigma), value) in FITTED.iter().zip(&expected).zip(values) {
        let unit = if *k < 3 { 1e3 } else { 1e6 };
        let (found, stated) = estimate(&by_option, name);
        assert!((stated / (sigma * unit) - 1.0).abs() < 0.02, "{name}: {stated} {}", sigma * unit);
        assert!((found - value * unit).abs() < 4.0 * stated, "{name}: {found} {stated}");
    }
    // Balls of unknown place leave what the bar sees through their place alone; EZ0A is then held by what is plausible.
    let sharper = ["EZ0A", "EB0A", "EC0A"].map(|name| estimate(&alone, name).1 / estimate(&by_option, name).1);
    assert!(sharper[0] > 1.0 && sharper[1..].iter().all(|times| *times > 3.0), "{sharper:?}");
}

#[test]
fn a_prior_is_a_reading_of_its_own_uncertainty() {
    let folder = Folder::new();
    let file = format!("{FIVE}errors: {{ EC0Y: {{ value: 10 urad, uncertainty: 4 urad }} }}\n");
    let machine = folder.write("machine.yaml", &file);
    let mut random = Random::new(322);
    let rows: String =
        (0..200).map(|i| format!("{},{}\n", 2 * i, -0.02 * f64::from(2 * i) + 5.0 * normal(&mut random))).collect();
    let data = folder.write("data.csv", &format!("Y,dx [um]\n{rows}"));
    let report =
        |more: &[&str]| json(&identify(&machine, &data, &[&["--fit", "EC0Y", "--format", "json"], more].concat()));
    let scatter = |report: &Value| report["sigma_um"].as_f64().unwrap();
    let alone = report(&[]);
    let (value, sigma) = estimate(&alone, "EC0Y");
    // The mean of two values by their weights; half of the file's expanded uncertainty is 2 urad. Pulled away from their
    // best, the readings scatter a little more.
    for (prior, centre, u) in [("EC0Y 2 urad", 10.0, 2.0), ("EC0Y = 30 urad 1 urad", 30.0, 1.0), ("file", 10.0, 2.0)] {
        let both = report(&["--prior", prior]);
        let sigma = sigma * scatter(&both) / scatter(&alone);
        let (found, less) = estimate(&both, "EC0Y");
        let weights = (1.0 / (sigma * sigma), 1.0 / (u * u));
        let expected = (value * weights.0 + centre * weights.1) / (weights.0 + weights.1);
        assert!((found - expected).abs() < 0.02 * less, "{prior}: {found} {expected}");
        assert!((less * (weights.0 + weights.1).sqrt() - 1.0).abs() < 0.005, "{prior}: {less}");
    }
    for prior in ["EC0Y", "EC0Y 5 um", "EC0Y 0 urad", "EC0Z 5 urad", "ball b1 50 um", "EC0Y = 1 urad", ""] {
        let output = identify(&machine, &data, &["--fit", "EC0Y", "--prior", prior]);
        assert!(output.status.code() == Some(1) && said(&output).contains("E0516"), "{prior}: {}", said(&output));
    }
    let section = folder
        .write("section.yaml", &format!("{file}identify: {{ fit: [EC0Y], priors: [EC0Y 2 urad, ball b1 1 um] }}\n"));
    let output = identify(&section, &data, &["--format", "json"]);
    assert!(said(&output).contains("W0509") && said(&output).contains("ball b1"), "{}", said(&output));
    assert_eq!(estimate(&json(&output), "EC0Y"), estimate(&report(&["--prior", "EC0Y 2 urad"]), "EC0Y"));
    assert!(run(&["explain", "E0516"]).status.success());
}

/// Two balls whose places are known hold the size of the machine.
#[test]
fn balls_at_known_places_hold_the_scale() {
    let blank = five_axes();
    let mut truth = blank.clone();
    let places = [[60.0, 20.0, 100.0], [-70.0, 50.0, 130.0], [10.0, -80.0, 160.0]];
    truth.rigid.tool_setup = [0.02, -0.01, 0.03];
    let folder = Folder::new();
    yaml::write(&blank, &folder);
    let mut random = Random::new(323);
    let mut text = "C,A,Y,X,Z,ball,ball.x [mm],ball.y [mm],ball.z [mm],ball.u [um]\n".to_owned();
    for (b, place) in places.iter().enumerate() {
        for i in 0..12 {
            let start = vec![30.0 * f64::from(i), 5.0 - 10.0 * f64::from(i % 4), 225.0, 250.0, -100.0];
            let mut pose = brought_to(&truth, &start, &Vector3::from(*place));
            (2..5).for_each(|i| pose[i] += 1e-3 * normal(&mut random));
            let cells: Vec<String> = pose.iter().map(f64::to_string).collect();
            text += &format!("{},b{b},{},{},{},2\n", cells.join(","), place[0], place[1], place[2]);
        }
    }
    let data = folder.write("balls.csv", &text);
    let fit = ["--fit", "tool,EXX:poly1,EYY:poly1,EZZ:poly1", "--fixed", "EXX:x^0,EYY:x^0,EZZ:x^0", "--format", "json"];
    let report = json(&identify(&folder.path("machine.yaml"), &data, &fit));
    for (name, known) in [("tool.X", 20.0), ("tool.Y", -10.0), ("EXX:x^1", 0.0), ("EYY:x^1", 0.0), ("EZZ:x^1", 0.0)] {
        let (value, sigma) = estimate(&report, name);
        assert!((value - known).abs() < 4.0 * sigma && sigma < 60.0, "{name}: {value} {sigma}");
    }
}
