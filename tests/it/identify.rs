//! Identification: machines with known errors, measured by the independent model, are found again.

use super::language::silent;
use super::oracle::curves::Travel as Way;
use super::oracle::machines::{Sample, combinations};
use super::oracle::program::Folder;
use super::oracle::random::Random;
use super::oracle::rigid::Frame as OracleFrame;
use super::oracle::yaml;
use abbe::diagnostic::{Diagnostics, Place as InFile};
use abbe::evaluate::{Frame, Order, evaluate};
use abbe::identify::{
    FileNotes, FitModel, Measurement, Parameter, ParameterFit, Reading, ReadingContext, Solution, fit, fitted_file,
    held_out, parameters, read_measurements, solve as weigh,
};
use abbe::lower::{ErrorSite, Exact, Source, point, position_jacobian, values};
use abbe::machine::{Approach, Direction, Machine, machine_file};
use abbe::run::unheard;
use abbe::syntax::{Disk, IdentifyEntry};
use nalgebra::{DMatrix, Vector3};

pub fn wanted(machine: &Machine, words: &[&str]) -> Vec<Parameter> {
    let request = IdentifyEntry { fit: words.iter().map(|w| (*w).to_owned()).collect(), ..IdentifyEntry::default() };
    parameters(machine, &request).unwrap_or_else(|refusal| panic!("{refusal:?}"))
}

pub fn measured(pose: &[f64], d: [f64; 3]) -> Measurement {
    let source = Diagnostics::default().sources.add("data.csv", "");
    let place = InFile { source, range: 0..0 };
    let reading = Reading::Deviation { values: d.map(Some), frame: Frame::Workpiece, zero: [None; 3] };
    Measurement::new(pose.to_vec(), reading, place)
}

pub fn solve(machine: &Machine, parameters: &[Parameter], data: &[Measurement]) -> (ParameterFit, Solution) {
    let model = FitModel::new(machine, parameters);
    let found = fit(&model, data, vec![1.0; data.len()]);
    let solution = Solution::of(&found, parameters);
    (found, solution)
}

/// The machine of a sample as the program reads it.
pub fn of_sample(sample: &Sample) -> Machine {
    let folder = Folder::new();
    yaml::write(sample, &folder);
    crate::loaded::machine(&folder.path("machine.yaml"))
}

/// The fitted machine file.
pub fn fitted_text(machine: &Machine, parameters: &[Parameter], found: &ParameterFit) -> String {
    let note = [("fit".to_owned(), "by a test".to_owned())];
    let notes = FileNotes {
        provenance: &note,
        request: &IdentifyEntry::default(),
        joint: true,
        form: None,
        unheld: &[],
        measured: &[],
    };
    fitted_file(machine, parameters, &Solution::of(found, parameters), notes)
}

fn rms(vectors: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let squares: Vec<f64> = vectors.map(|v| v.norm_squared()).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn tangents_are_the_derivatives_of_the_actual_point() {
    let mut random = Random::new(61);
    for conventions in combinations().step_by(5) {
        let sample = Sample::random(&mut random, conventions, 1e-4);
        let machine = of_sample(&sample);
        let joints = machine.axes().len() + usize::from(machine.spindle_errors().is_some());
        let locations = (0..joints).map(ErrorSite::Location);
        let places = locations
            .chain((0..machine.axes().len()).map(ErrorSite::Component))
            .chain([ErrorSite::Workpiece, ErrorSite::Tool]);
        let sources: Vec<Source> = places
            .flat_map(|place| Direction::ALL.map(|direction| Source { place, direction }))
            .filter(|s| s.place != ErrorSite::Tool || !s.direction.is_rotation())
            .collect();
        let pose = &sample.poses(&mut random, 1)[0];
        let at = values(&machine, &Approach::Mean.at_pose(pose));
        let found = position_jacobian(&machine, pose, &at, &Exact, &sources);
        assert!((found.point - point(&machine, pose, &at, &Exact)).norm() < 1e-10);
        for (source, derivative) in sources.iter().zip(&found.derivatives) {
            let h = 1e-4;
            let moved = |by: f64| {
                let mut changed = at.clone();
                let k = source.direction.index();
                match source.place {
                    ErrorSite::Location(i) if i < pose.len() => changed.axes[i].location[k] += by,
                    ErrorSite::Location(_) => changed.spindle.as_mut().unwrap()[k] += by,
                    ErrorSite::Component(i) => changed.axes[i].component[k] += by,
                    ErrorSite::Workpiece => changed.workpiece[k] += by,
                    ErrorSite::Tool => changed.tool[k] += by,
                }
                point(&machine, pose, &changed, &Exact)
            };
            let expected = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((derivative - expected).norm() < 1e-4, "{source:?}: {derivative} {expected}");
        }
    }
}

/// The sample with only its location errors and set-up, and measurements by the independent model.
pub fn located(random: &mut Random, count: usize) -> (Sample, Vec<Measurement>) {
    let mut sample = Sample::random(random, Default::default(), 2e-4);
    sample.axes.iter_mut().for_each(|extra| extra.errors = Default::default());
    sample.rigid.spindle = None;
    // Readings are in the coordinates of the part.
    sample.rigid.workpiece_rotation = [25.0, -40.0, 130.0];
    let poses = sample.poses(random, count);
    let data = poses.iter().map(|p| measured(p, sample.evaluate(p, Way::Mean, OracleFrame::Workpiece).deviation));
    let data = data.collect();
    (sample, data)
}

#[test]
fn location_errors_of_random_machines_explain_data_of_the_independent_model() {
    let mut random = Random::new(62);
    for _ in 0..8 {
        let (sample, data) = located(&mut random, 80);
        let machine = of_sample(&sample.scaled(0.0, 0.0));
        let parameters = wanted(&machine, &["location", "tool", "workpiece"]);
        let (train, test) = data.split_at(60);
        let (found, solution) = solve(&machine, &parameters, train);
        let model = FitModel::new(&machine, &parameters);
        let left = rms(model.residuals(test, &found.theta).into_iter());
        assert!(left < 1e-8, "{left:e} mm of points not used; {:?}", solution.null_space);
        // Location, tool and workpiece together are always short by three or more.
        assert!(solution.rank + 3 <= parameters.len());
        assert_eq!(solution.null_space.len(), parameters.len() - solution.rank, "{:?}", solution.null_space);
    }
}

/// Derivatives of the independent model by central differences: location errors, tool, workpiece.
fn oracle_jacobian(sample: &Sample, poses: &[Vec<f64>]) -> DMatrix<f64> {
    let axes = sample.rigid.walk.len();
    let h = 1e-3;
    let column = |j: usize| {
        let moved = |by: f64| {
            let mut changed = sample.clone();
            match j {
                j if j < 6 * axes => changed.rigid.walk[j / 6].location[j % 6] += by,
                j if j < 6 * axes + 3 => changed.rigid.tool_setup[j - 6 * axes] += by,
                j => changed.rigid.workpiece_setup[j - 6 * axes - 3] += by,
            }
            let at = |p: &Vec<f64>| changed.evaluate(p, Way::Mean, OracleFrame::Workpiece).deviation;
            poses.iter().flat_map(at).collect::<Vec<f64>>()
        };
        let (up, down) = (moved(h), moved(-h));
        up.iter().zip(down).map(|(u, d)| (u - d) / (2.0 * h)).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..6 * axes + 9).map(column).collect();
    DMatrix::from_fn(3 * poses.len(), columns.len(), |i, j| columns[j][i])
}

#[test]
fn the_rank_is_that_of_the_independent_model() {
    let mut random = Random::new(63);
    for _ in 0..6 {
        let (sample, data) = located(&mut random, 40);
        let machine = of_sample(&sample);
        let parameters = wanted(&machine, &["location", "tool", "workpiece"]);
        let (_, solution) = solve(&machine, &parameters, &data);
        let poses: Vec<Vec<f64>> = data.iter().map(|m| m.pose.clone()).collect();
        // At the true errors, columns in displacement over a lever of 300 mm: differences have no more digits.
        let scales: Vec<f64> = parameters.iter().map(|p| p.size).collect();
        let jacobian = oracle_jacobian(&sample, &poses);
        let scaled = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| jacobian[(i, j)] / scales[j]);
        let singular = scaled.singular_values();
        let rank = singular.iter().filter(|s| **s > 1e-7 * singular.max()).count();
        assert_eq!(solution.rank, rank, "{singular}");
    }
}

pub const FIVE: &str = "abbe: 1\nmachine: Five\nchain: \"w C' A' Y' b X Z t\"\naxes:\n  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 450 mm], origin: [0, 0, 0] }\n  Z: { travel: [-400 mm, 0 mm], origin: [0, 0, 0] }\n  A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350] }\n  C: { travel: continuous, origin: [250, 225, -380] }\ntool: { gauge: [250, 225, 0], length: 120 mm }\nworkpiece: { origin: [250, 225, -380] }\n";

pub fn five(errors: &str) -> Machine {
    silent(&[("machine.yaml", &format!("{FIVE}{errors}"))])
}

pub fn five_poses(random: &mut Random, count: usize) -> Vec<Vec<f64>> {
    let mut one = |low, high| random.between(low, high);
    (0..count)
        .map(|_| vec![one(0.0, 360.0), one(-120.0, 30.0), one(0.0, 450.0), one(0.0, 500.0), one(-400.0, 0.0)])
        .collect()
}

pub fn deviation(machine: &Machine, pose: &[f64]) -> [f64; 3] {
    evaluate(machine, &Approach::Mean.at_pose(pose), Order::Exact, Frame::Workpiece).deviation.position.into()
}

/// A sum of twelve even numbers is normal enough: standard deviation 1.
pub fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    let truth = five(
        "errors: { EC0Y: 12 urad, EB0Z: -20 urad, EA0Z: 7 urad, EX0C: 6 um, EY0C: -9 um, EA0C: 15 urad, EXX: { polynomial: [0 um, 8 um/m, -20 um/m^2] } }\n",
    );
    let blank = five("");
    let parameters = wanted(&blank, &["EC0Y", "EB0Z", "EA0Z", "EX0C", "EY0C", "EA0C", "EXX:poly2"]);
    let known = [12.0, -20.0, 7.0, 6.0, -9.0, 15.0, 0.0, 8.0, -20.0];
    let mut random = Random::new(64);
    let poses = five_poses(&mut random, 40);
    let clean: Vec<[f64; 3]> = poses.iter().map(|p| deviation(&truth, p)).collect();
    let (mut inside, mut all) = (0, 0);
    for _ in 0..1000 {
        let data: Vec<Measurement> =
            poses.iter().zip(&clean).map(|(p, d)| measured(p, d.map(|d| d + 2e-3 * normal(&mut random)))).collect();
        let (_, solution) = solve(&blank, &parameters, &data);
        assert_eq!(solution.rank, 9);
        for ((estimate, parameter), known) in solution.estimates.iter().zip(&parameters).zip(known) {
            let (value, sigma) = (parameter.in_unit(estimate.value), parameter.in_unit(estimate.sigma.unwrap()));
            inside += usize::from((value - known).abs() < 1.98 * sigma);
            all += 1;
        }
    }
    let share = inside as f64 / all as f64;
    assert!((0.93..0.97).contains(&share), "{share}");
}

/// Four combinations of the eighteen curves show only in products of errors: the part of the measured curves that six
/// knots cannot follow would draw them out by millimetres.
#[test]
fn what_shows_only_in_products_of_errors_is_not_followed() {
    let machine = crate::loaded::machine(std::path::Path::new("configs/vmc-cframe-754.yaml"));
    let directions = ["X", "Y", "Z", "A", "B", "C"];
    let words: Vec<String> =
        ["X", "Y", "Z"].iter().flat_map(|a| directions.map(|d| format!("E{d}{a}:spline6"))).collect();
    let parameters = wanted(&machine, &words.iter().map(String::as_str).collect::<Vec<_>>());
    let mut random = Random::new(65);
    let mut draw = |count: usize| -> Vec<Measurement> {
        let pose = |random: &mut Random| {
            machine
                .axes()
                .iter()
                .map(|axis| {
                    let (low, high) = axis.travel.interval();
                    random.between(low, high)
                })
                .collect::<Vec<f64>>()
        };
        let poses: Vec<Vec<f64>> = (0..count).map(|_| pose(&mut random)).collect();
        poses.iter().map(|p| measured(p, deviation(&machine, p).map(|d| d + 1e-3 * normal(&mut random)))).collect()
    };
    let (data, fresh) = (draw(6000), draw(200));
    let (found, solution) = solve(&machine, &parameters, &data);
    assert!(found.converged && found.steps <= 3, "{} steps", found.steps);
    assert!(solution.rank > solution.well_determined && !solution.below_noise.is_empty());
    let moved = |(p, theta): (&Parameter, &f64)| (theta - p.start).abs() * p.size;
    let farthest = parameters.iter().zip(&found.theta).map(moved).fold(0.0, f64::max);
    assert!(farthest < 0.2, "{farthest} mm");
    // A reading scatters by 1 um, and splines of six knots miss the curves by about as much.
    let left = rms(FitModel::new(&machine, &parameters).residuals(&fresh, &found.theta).into_iter());
    assert!((1.7e-3..3.2e-3).contains(&left), "{left} mm");
}

#[test]
fn every_kind_of_curve_is_found_again_and_the_fitted_file_says_it() {
    let text = "errors:\n  EC0Y: 12 urad\n  EXX: { polynomial: [0 um, 8 um/m, -20 um/m^2, 30 um/m^3] }\n  ECC: { harmonics: { 0: [3 urad, 0 urad], 1: [20 urad, -10 urad], 2: [4 urad, 5 urad] } }\n  EYX: { points: [[0 mm, 0 um], [125 mm, 3 um], [250 mm, -2 um], [375 mm, 1 um], [500 mm, 4 um]], interpolation: cubic }\n  EXA: { harmonics: { 0: [0 um, 0 um], 1: [2 um, 1 um] } }\n";
    let truth = five(text);
    let blank = five(
        "errors: { EXA: { harmonics: { 0: [0 um, 0 um], 1: [2 um, 1 um] } }, EZZ: { tolerance: 3 um } }\nprovenance: { class: test, source: 'a: \"b\"' }\n",
    );
    let parameters = wanted(&blank, &["EC0Y", "EXX:poly3", "ECC:fourier2", "EYX:spline5"]);
    let mut random = Random::new(65);
    let data: Vec<Measurement> =
        five_poses(&mut random, 120).iter().map(|p| measured(p, deviation(&truth, p))).collect();
    let (found, solution) = solve(&blank, &parameters, &data);
    assert_eq!(solution.rank, parameters.len());
    assert!(found.converged && found.steps <= 8, "{} steps", found.steps);
    let value = |name: &str| {
        let j = parameters.iter().position(|p| p.name == name).unwrap_or_else(|| panic!("{name}"));
        parameters[j].in_unit(found.theta[j])
    };
    let expected = [("EC0Y", 12.0), ("EXX:x^3", 30.0), ("ECC:cos1", 20.0), ("ECC:sin2", 5.0), ("EYX:375mm", 1.0)];
    for (name, known) in expected {
        assert!((value(name) - known).abs() < 1e-4, "{name}: {}", value(name));
    }
    let text = fitted_text(&blank, &parameters, &found);
    let fitted = silent(&[("machine.yaml", &text)]);
    for pose in five_poses(&mut random, 30) {
        let gap = Vector3::from(deviation(&fitted, &pose)) - Vector3::from(deviation(&truth, &pose));
        assert!(gap.norm() < 1e-9, "{}", gap.norm());
    }
    assert_eq!(fitted.provenance().entries.len(), 3);
}

#[test]
fn a_fitted_file_of_any_machine_says_the_same_as_the_machine() {
    let mut random = Random::new(66);
    for conventions in combinations().step_by(7) {
        let sample = Sample::random(&mut random, conventions, 1e-4);
        let before = of_sample(&sample);
        let text = machine_file(&before.to_parts(), &[]);
        let (after, diagnostics) = super::language::read(&[("machine.yaml", &text)]);
        let after = after.unwrap_or_else(|| panic!("{text}\n{:?}", diagnostics.iter().next()));
        for pose in sample.poses(&mut random, 10) {
            for approach in [Approach::Mean, Approach::Forward, Approach::Reverse] {
                let at =
                    |machine| evaluate(machine, &approach.at_pose(&pose), Order::Exact, Frame::Workpiece).deviation;
                assert!((at(&before).position - at(&after).position).norm() < 1e-10, "{text}");
            }
        }
    }
}

#[test]
fn what_cannot_be_separated_is_said_in_words() {
    let blank = five("");
    let parameters = wanted(&blank, &["EX0C", "EZ0C", "tool", "workpiece"]);
    // Only C moves: the tool's offset along Z and the workpiece's cannot be distinguished.
    let data: Vec<Measurement> =
        (0..24).map(|i| measured(&[f64::from(i) * 15.0, 0.0, 200.0, 250.0, -100.0], [1e-3, 0.0, 2e-3])).collect();
    let (_, solution) = solve(&blank, &parameters, &data);
    let words = solution.null_space.join("\n");
    assert!(words.contains("EZ0C has no effect on these data"), "{words}");
    assert!(words.lines().any(|l| l.contains("tool.Z and workpiece.Z cannot be separated")), "{words}");
    let free = |name: &str| solution.estimates[parameters.iter().position(|p| p.name == name).unwrap()].sigma.is_none();
    assert!(free("EZ0C") && free("tool.Z") && free("workpiece.Z"));
}

/// Constant parts of EXX, EXY and EXZ are one, and the slope of EXZ is a squareness.
#[test]
fn knots_of_a_curve_that_cannot_be_separated_are_one_phrase() {
    let three = "abbe: 1\nmachine: Three\nchain: \"w b X Y Z t\"\nconventions: { joints: linearised }\naxes:\n  X: { travel: [0 mm, 300 mm], origin: [0, 0, 0] }\n  Y: { travel: [0 mm, 200 mm], origin: [0, 0, 0] }\n  Z: { travel: [-100 mm, 0 mm], origin: [0, 0, 0] }\n";
    let machine = silent(&[("machine.yaml", three)]);
    let parameters = wanted(&machine, &["EB0Z", "EXX:blocks3", "EXY:blocks2", "EXZ:blocks4"]);
    let grid = |i: i32| [f64::from(i % 7) * 50.0, f64::from(i / 7 % 5) * 50.0, f64::from(i / 35 % 5) * -25.0];
    let data: Vec<Measurement> = (0..175).map(|i| measured(&grid(i), [1e-3, 0.0, 0.0])).collect();
    let (_, solution) = solve(&machine, &parameters, &data);
    assert_eq!(
        solution.null_space,
        [
            "EB0Z and EXZ cannot be separated: together EB0Z +1 urad, EXZ +0.1 um at -100mm to +0.025 um at -25mm change nothing",
            "EXY and EXZ cannot be separated: together EXY +1 um throughout, EXZ -1 um throughout change nothing",
            "EXX and EXZ cannot be separated: together EXX +1 um throughout, EXZ -1 um throughout change nothing",
        ]
    );
}

#[test]
fn robust_weights_resist_bumped_points_and_held_out_data_are_predicted() {
    let truth = five("errors: { EC0Y: 12 urad, EX0C: 6 um }\n");
    let blank = five("");
    let parameters = wanted(&blank, &["EC0Y", "EX0C"]);
    let mut random = Random::new(67);
    let mut data: Vec<Measurement> = five_poses(&mut random, 100)
        .iter()
        .map(|p| measured(p, deviation(&truth, p).map(|d| d + 1e-3 * normal(&mut random))))
        .collect();
    data[10] = measured(&data[10].pose, [0.3, -0.2, 0.1]);
    let model = FitModel::new(&blank, &parameters);
    let robust = weigh(&model, &data, true);
    assert!((robust.theta[0] - 12e-6).abs() < 2e-6 && (robust.theta[1] - 6e-3).abs() < 6e-4, "{:?}", robust.theta);
    let seen = abbe::identify::FitInData { theta: robust.theta.clone(), stand: None };
    let report = abbe::identify::Residuals::of(&model, &data, &robust, &robust.theta, &seen);
    assert_eq!(report.outliers.first().map(|o| o.row), Some(10));
    data.remove(10);
    let Ok(left) = held_out(&model, &data, 5, false, &unheard);
    let left = left.unwrap();
    assert!((1.4e-3..2.1e-3).contains(&left), "{left}");
}

/// 60 of the 1000 poses; see tests/data/ur5/LICENSE.
#[test]
fn the_ur5_robot_has_rank_27() {
    let robot = super::configs::machine("robots/ur5.yaml");
    let parameters = wanted(&robot, &["location", "tool"]);
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/ur5/extract.csv");
    let mut diagnostics = Diagnostics::default();
    let data = read_measurements(&[folder], &robot, &ReadingContext::default(), &Disk, &mut diagnostics).rows;
    let (found, solution) = solve(&robot, &parameters, &data);
    assert!(found.converged, "{} steps", found.steps);
    assert_eq!((solution.rank, parameters.len(), data.len()), (27, 39, 60));
    let model = FitModel::new(&robot, &parameters);
    let after = rms(model.residuals(&data, &found.theta).into_iter());
    assert!(after < 0.1125, "{after}");
    for axis in 1..=6 {
        let own = if [1, 5].contains(&axis) { "Z" } else { "Y" };
        assert!(
            solution.null_space.iter().any(|w| w.contains(&format!("E{own}0J{axis}"))),
            "{:?}",
            solution.null_space
        );
    }
}

/// Runs the program.
pub fn run(arguments: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_abbe")).arg("--wide").args(arguments).output().unwrap()
}

pub fn json(output: &std::process::Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A file of measurements of a machine, in um, with two tools if it has them.
fn data_file(folder: &Folder, machine: &Machine, poses: &[Vec<f64>], tools: &[&str]) -> String {
    let mut text = "# measured by a test\nC [deg]; A; Y; X [mm]; Z; tool; dx [um]; dy [um]; dz [mm]\n".to_owned();
    for tool in tools {
        let machine = machine.with_tool(tool).unwrap();
        for pose in poses {
            let [dx, dy, dz] = deviation(&machine, pose);
            let cells = pose.iter().map(f64::to_string).collect::<Vec<_>>().join(";");
            text += &format!("{cells};{tool};{};{};{dz}\n", dx * 1e3, dy * 1e3);
        }
    }
    folder.write("data.csv", &text).to_str().unwrap().to_owned()
}

#[test]
fn the_verb_writes_a_machine_that_the_other_verbs_take() {
    let folder = Folder::new();
    let tools =
        "tools: { short: { gauge: [250, 225, 0], length: 120 mm }, long: { gauge: [250, 225, 0], length: 240 mm } }\n";
    let base = FIVE.replace("tool: { gauge: [250, 225, 0], length: 120 mm }\n", tools).replace("Z t", "Z (S) t");
    let errors = "errors: { EC0Y: 12 urad, EX0C: 6 um, EA0S: 15 urad, EB0S: -9 urad, EZ0A: 4 um }\n";
    let truth = silent(&[("machine.yaml", &format!("{base}{errors}"))]);
    let section = "identify: { fit: [location, EA0S, EB0S, tool], fixed: [EC0A, tool] }\n";
    let machine = folder.write("machine.yaml", &format!("{base}{section}"));
    let machine = machine.to_str().unwrap();
    let poses = five_poses(&mut Random::new(68), 60);
    let data = data_file(&folder, &truth, &poses, &["short", "long"]);
    let out = folder.path("fitted.yaml");
    let out = out.to_str().unwrap();
    let report = json(&run(&["identify", machine, "--data", &data, "--out", out, "--folds", "4", "--format", "json"]));
    assert_eq!(report["rows"], 360);
    assert_eq!(report["unknowns"], 31);
    assert!(report["rank"].as_u64().unwrap() < 31 && report["well_determined"].as_u64().unwrap() >= 12);
    assert!(report["rms_um"]["before"].as_f64().unwrap() > 5.0);
    assert!(report["rms_um"]["after"].as_f64().unwrap() < 1e-3, "{}", report["rms_um"]);
    assert!(report["rms_um"]["held_out"].as_f64().unwrap() < 1e-3, "{}", report["rms_um"]);
    assert!(!report["null_space"].as_array().unwrap().is_empty());
    let named = |name: &str| report["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).cloned();
    let tilt = named("EA0S").unwrap();
    assert!((tilt["value"].as_f64().unwrap() - 15.0).abs() < 1e-3 && tilt["unit"] == "urad", "{tilt}");
    assert!(named("EC0A").is_none() && named("tool.X").is_none());
    for verb in [&["check", out][..], &["eval", out, "--at", "X=100,C=90"], &["map", out, "--random", "20"]] {
        let output = run(verb);
        assert!(output.status.success(), "{verb:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let tables = folder.path("tables");
    let output = run(&["compile", out, "--target", "linuxcnc", "--out", tables.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let again = json(&run(&["identify", out, "--data", &data, "--fit", "EC0Y", "--format", "json"]));
    assert!(again["rms_um"]["before"].as_f64().unwrap() < 1e-3, "{}", again["rms_um"]);
}

#[test]
fn what_is_wrong_with_the_input_is_said() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let machine = machine.to_str().unwrap();
    let codes = |data: &str, fit: &str| {
        let data = folder.write("data.csv", data);
        let output = run(&["identify", machine, "--data", data.to_str().unwrap(), "--fit", fit, "--format", "json"]);
        assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).starts_with("{\"refused\":true,"));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let row = "X,Y,dx [um]\n1,2,3\n4,5,6\n7,8,9\n";
    for data in [
        "",
        "X,Y,dx [um]\n",
        "X,dx\n1,2\n",
        "X,dq [um]\n1,2\n",
        "X,dx [deg]\n1,2\n",
        "X,Y\n1,2\n",
        "X,dx [um]\n1\n",
        "X,dx [um]\n1,nan\n",
        "X,dx [um]\n1,\n",
        "X,dx [um],weight\n1,2,-1\n",
        "X,X,dx [um]\n1,1,2\n",
        "X,dx [um],tool\n1,2,nosuch\n",
    ] {
        assert!(codes(data, "EC0Y").contains("E0501"), "{data}");
    }
    for fit in
        ["locations", "EXQ", "EXX:poly0", "EXX:fourier2", "ECC:poly2", "EC0Y:poly2", "linear,EXX:poly2", "spindle"]
    {
        assert!(codes(row, fit).contains("E0502"), "{fit}");
    }
    // EC0Y, and two of EXX; readings along Y alone feel but one location error.
    assert!(
        codes("X,Y,dx [um]\n1,2,3\n4,5,6\n", "EC0Y,EXX:poly1").contains("2 readings cannot determine 3 parameters")
    );
    let output = run(&["identify", machine, "--data", folder.path("data.csv").to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("nothing says what to fit"));
}

#[test]
fn contradictory_data_are_explained() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    // X has a bend that a squareness error cannot make; every pose was measured twice.
    let rows: String =
        (0..20).map(|i| format!("{0},0,{1}\n{0},0,{2}\n", 25 * i, 5 * (i % 5), 5 * (i % 5) + 1)).collect();
    let data = folder.write("data.csv", &format!("X,Y,dx [um]\n{rows}"));
    let output = run(&[
        "identify",
        machine.to_str().unwrap(),
        "--data",
        data.to_str().unwrap(),
        "--fit",
        "EXX:poly1",
        "--format",
        "json",
    ]);
    let report = json(&output);
    assert!((report["repeatability_um"].as_f64().unwrap() - 0.5_f64.sqrt()).abs() < 1e-9);
    assert_eq!(report["warnings"][0]["code"], "W0502");
}

#[test]
fn planned_poses_tell_more_than_random_ones_and_their_uncertainty_is_met() {
    let blank = five("");
    let parameters = wanted(
        &blank,
        &["EC0Y", "EB0Z", "EA0Z", "EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A", "workpiece"],
    );
    let model = FitModel::new(&blank, &parameters);
    let mut random = Random::new(69);
    let candidates: Vec<Measurement> = five_poses(&mut random, 500).iter().map(|p| measured(p, [0.0; 3])).collect();
    let Ok(chosen) = abbe::identify::plan(&model, &candidates, 16, false, 1e-3, &unheard);
    let planned: Vec<Measurement> = chosen.iter().flatten().map(|i| candidates[*i].clone()).collect();
    let (expected, _) = abbe::identify::expected(&model, &planned, 1e-3);
    assert_eq!((planned.len(), expected.rank), (16, 17));
    // The determinant of the covariance, by way of the singular values of the design.
    let information = |poses: &[Measurement]| -> f64 {
        let theta = vec![0.0; parameters.len()];
        model.triangle(poses, &vec![1.0; poses.len()], &theta).r.determinant().abs().ln()
    };
    let best = (0..20)
        .map(|_| information(&five_poses(&mut random, 16).iter().map(|p| measured(p, [0.0; 3])).collect::<Vec<_>>()));
    let best = best.fold(f64::NEG_INFINITY, f64::max);
    assert!(information(&planned) > best + 1.0, "{} {best}", information(&planned));
    // Measured with that noise, the fit scatters as predicted.
    let (mut squares, draws) = (0.0, 600);
    for _ in 0..draws {
        let data: Vec<Measurement> =
            planned.iter().map(|m| measured(&m.pose, [0.0; 3].map(|d| d + 1e-3 * normal(&mut random)))).collect();
        let (_, solution) = solve(&blank, &parameters, &data);
        let z = |(e, p): (&abbe::identify::Estimate, &abbe::identify::Estimate)| (e.value / p.sigma.unwrap()).powi(2);
        squares += solution.estimates.iter().zip(&expected.estimates).map(z).sum::<f64>() / 17.0;
    }
    assert!((0.9..1.1).contains(&(squares / f64::from(draws))), "{}", squares / f64::from(draws));
}

#[test]
fn a_plan_is_a_file_of_measurements_to_be_filled_in() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let machine = machine.to_str().unwrap();
    let plan = |format| {
        run(&["identify", machine, "--fit", "EC0Y,EX0C", "--plan", "6", "--noise", "2 um", "--format", format])
    };
    let report = json(&plan("json"));
    assert_eq!((report["poses"].as_array().unwrap().len(), &report["rank"]), (6, &serde_json::json!(2)));
    let text = String::from_utf8(plan("csv").stdout).unwrap();
    let filled = folder.write("data.csv", &text.replace(",,,", ",1,2,3"));
    let report = json(&run(&[
        "identify",
        machine,
        "--fit",
        "EC0Y,EX0C",
        "--data",
        filled.to_str().unwrap(),
        "--format",
        "json",
    ]));
    assert_eq!(report["rows"], 18);
    assert_eq!(run(&["identify", machine, "--fit", "EC0Y"]).status.code(), Some(2));
    assert_eq!(run(&["identify", machine, "--fit", "EC0Y", "--plan", "3", "--noise", "2 deg"]).status.code(), Some(2));
}
