//! Other kinds of measurements than deviations: lengths, balls, lines, single errors, read from files that the
//! independent model has filled, together in one fit.

use super::identify::{FIVE, deviation, five, five_poses, json, located, normal, of_sample, run, wanted};
use super::oracle::curves::Travel as Way;
use super::oracle::machines::Sample;
use super::oracle::program::Folder;
use super::oracle::random::Random;
use super::oracle::rigid::Frame as OracleFrame;
use abbe::diagnostic::Diagnostics;
use abbe::identify::{
    FitModel, MeasurementSet, Parameter, ParameterFit, ReadingContext, Solution, fit, read_measurements,
};
use abbe::machine::Machine;
use abbe::syntax::Disk;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Nominal and actual place of the functional point, by the independent model.
fn points(sample: &Sample, pose: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
    let answer = sample.evaluate(&pose.to_vec(), Way::Mean, OracleFrame::Workpiece);
    let nominal = Vector3::from(answer.nominal);
    (nominal, nominal + Vector3::from(answer.deviation))
}

pub fn actual(sample: &Sample, pose: &[f64]) -> Vector3<f64> {
    points(sample, pose).1
}

fn header(sample: &Sample, prefix: &str) -> String {
    sample.rigid.walk.iter().map(|axis| format!("{prefix}{},", axis.name)).collect()
}

fn cells(pose: &[f64]) -> String {
    pose.iter().map(|q| format!("{q},")).collect()
}

/// A file with one reading for each pose.
fn file(folder: &Folder, name: &str, head: &str, rows: impl Iterator<Item = String>) -> std::path::PathBuf {
    folder.write(name, &format!("{head}\n{}\n", rows.collect::<Vec<_>>().join("\n")))
}

fn read(machine: &Machine, files: &[std::path::PathBuf]) -> MeasurementSet {
    let mut diagnostics = Diagnostics::default();
    let data = read_measurements(files, machine, &ReadingContext::default(), &Disk, &mut diagnostics);
    assert!(diagnostics.iter().next().is_none(), "{:?}", diagnostics.iter().next());
    data
}

fn solved(machine: &Machine, words: &[&str], data: &MeasurementSet) -> (Vec<Parameter>, ParameterFit, Solution) {
    let unknowns: Vec<Parameter> =
        wanted(machine, words).into_iter().chain(data.nuisances.iter().cloned().map(Parameter::from)).collect();
    let model = FitModel::new(machine, &unknowns);
    let found = fit(&model, &data.rows, data.rows.iter().map(|m| m.weight).collect());
    let solution = Solution::of(&found, &unknowns);
    (unknowns, found, solution)
}

/// The linear axes so that the actual point of the sample is at a place: Newton with differences.
pub fn brought_to(sample: &Sample, pose: &[f64], place: &Vector3<f64>) -> Vec<f64> {
    let linear: Vec<usize> = (0..pose.len()).filter(|i| !sample.rigid.walk[*i].rotary).collect();
    let mut pose = pose.to_vec();
    for _ in 0..8 {
        let here = actual(sample, &pose);
        let column = |i: &usize| {
            let mut moved = pose.clone();
            moved[*i] += 0.5;
            (actual(sample, &moved) - here) / 0.5
        };
        let columns: Vec<Vector3<f64>> = linear.iter().map(column).collect();
        let jacobian = Matrix3::from_columns(&columns[..3]);
        let step = jacobian.try_inverse().unwrap() * (place - here);
        linear.iter().take(3).zip(step.iter()).for_each(|(i, s)| pose[*i] += s);
    }
    pose
}

/// All kinds at once, of one machine.
fn everything(sample: &Sample, poses: &[Vec<f64>], folder: &Folder) -> Vec<std::path::PathBuf> {
    let axes = header(sample, "");
    let stations = [Vector3::new(900.0, -700.0, 500.0), Vector3::new(-800.0, 600.0, 900.0)];
    let half = poses.len() / 2;
    let displacement = |(i, pose): (usize, &Vec<f64>)| {
        let station = usize::from(i >= half);
        format!("{}S{station},{}", cells(pose), (actual(sample, pose) - stations[station]).norm() - 57.0)
    };
    let tracer = poses.iter().enumerate().map(displacement);
    let bar = poses.iter().map(|pose| {
        let length = (actual(sample, pose) - Vector3::new(400.0, 500.0, -900.0)).norm();
        format!("{}{length},401,502,-899", cells(pose))
    });
    let pair = poses.windows(2).map(|w| {
        let (here, there) = (points(sample, &w[0]), points(sample, &w[1]));
        let gap = (here.1 - there.1).norm() - (here.0 - there.0).norm();
        format!("{}{}{}", cells(&w[0]), cells(&w[1]), gap * 1e3)
    });
    let off = |pose: &Vec<f64>| {
        let (nominal, actual) = points(sample, pose);
        actual - nominal
    };
    let first = off(&poses[0]);
    let relative = poses.iter().map(|pose| {
        let d = (off(pose) - first) * 1e3;
        format!("{}{},{},{}", cells(pose), d.x, d.y, d.z)
    });
    let far = poses.iter().map(|p| points(sample, p).0 - points(sample, &poses[0]).0);
    let far = far.fold(Vector3::zeros(), |a: Vector3<f64>, b| if b.norm() > a.norm() { b } else { a }).normalize();
    let line = poses.iter().map(|pose| format!("{}{}", cells(pose), (off(pose) - first).dot(&far)));
    vec![
        file(folder, "tracer.csv", &format!("{axes}station,displacement [mm]"), tracer),
        file(folder, "bar.csv", &format!("{axes}length [mm],station.x [mm],station.y [mm],station.z [mm]"), bar),
        file(folder, "pair.csv", &format!("{axes}{}dl [um]", header(sample, "to.")), pair),
        file(folder, "rtest.csv", &format!("{axes}rel.dx [um],rel.dy [um],rel.dz [um]"), relative),
        file(folder, "line.csv", &format!("{axes}along [mm]"), line),
    ]
}

#[test]
fn every_kind_explains_data_of_the_independent_model() {
    let mut random = Random::new(81);
    for _ in 0..3 {
        let (mut sample, _) = located(&mut random, 1);
        sample.rigid.walk.iter_mut().filter(|axis| !axis.rotary).for_each(|axis| axis.location[3..].fill(1e-4));
        let poses = sample.poses(&mut random, 44);
        let folder = Folder::new();
        let machine = of_sample(&sample.scaled(0.0, 0.0));
        for path in everything(&sample, &poses, &folder) {
            let data = read(&machine, std::slice::from_ref(&path));
            let (unknowns, found, _) = solved(&machine, &["location", "tool"], &data);
            let left = FitModel::new(&machine, &unknowns).residuals(&data.rows, &found.theta);
            let worst = left.iter().map(|r| r.norm()).fold(0.0, f64::max);
            assert!(worst < 1e-7, "{}: {worst:e}", path.display());
            assert!(found.converged, "{}", path.display());
        }
    }
}

/// A machine that can bring its point to a ball in any orientation: three linear and two rotary axes.
fn five_axes(random: &mut Random) -> Sample {
    loop {
        let (sample, _) = located(random, 1);
        let linear = sample.rigid.walk.iter().filter(|axis| !axis.rotary);
        let directions: Vec<Vector3<f64>> = linear.map(|axis| Vector3::from(axis.direction)).collect();
        let [a, b, c] = directions[..] else { continue };
        if sample.rigid.walk.len() > 3 && a.cross(&b).dot(&c).abs() > 0.3 {
            return sample;
        }
    }
}

#[test]
fn a_ball_that_is_found_again_in_many_orientations_tells_the_rotary_axes() {
    let mut random = Random::new(84);
    let sample = five_axes(&mut random);
    let machine = of_sample(&sample.scaled(0.0, 0.0));
    let folder = Folder::new();
    let poses = sample.poses(&mut random, 50);
    let place = actual(&sample, &poses[0]);
    let rows = poses.iter().map(|pose| format!("{}b1", cells(&brought_to(&sample, pose, &place))));
    let path = file(&folder, "balls.csv", &format!("{}ball", header(&sample, "")), rows);
    let data = read(&machine, &[path]);
    let (unknowns, found, solution) = solved(&machine, &["location", "tool"], &data);
    let left = FitModel::new(&machine, &unknowns).residuals(&data.rows, &found.theta);
    let worst = left.iter().map(|r| r.norm()).fold(0.0, f64::max);
    // The axes stop where Newton's iteration with differences of 0.5 mm has come to.
    assert!(worst < 1e-7 && found.converged, "{worst:e}");
    // Without errors the ball would be found off by their effect.
    let model = FitModel::new(&machine, &unknowns);
    let start: Vec<f64> = unknowns.iter().map(|p| p.start).collect();
    let before = model.residuals(&data.rows, &start).iter().map(|r| r.norm()).fold(0.0, f64::max);
    assert!(before > 1e-3 && solution.rank < unknowns.len(), "{before}");
}

#[test]
fn the_rank_of_lengths_is_that_of_the_independent_model() {
    let mut random = Random::new(82);
    let (sample, _) = located(&mut random, 1);
    let machine = of_sample(&sample);
    let poses = sample.poses(&mut random, 60);
    let station = Vector3::new(900.0, -700.0, 500.0);
    let folder = Folder::new();
    let rows = poses.iter().map(|p| format!("{}S,{}", cells(p), (actual(&sample, p) - station).norm() - 9.0));
    let path = file(&folder, "t.csv", &format!("{}station,displacement [mm]", header(&sample, "")), rows);
    let data = read(&machine, &[path]);
    let (unknowns, _, solution) = solved(&machine, &["location", "tool", "workpiece"], &data);
    // Columns of the independent model by differences, in displacement over a lever of 300 mm.
    let axes = sample.rigid.walk.len();
    let h = 1e-3;
    let value = |changed: &Sample, station: Vector3<f64>, path: f64| -> Vec<f64> {
        poses.iter().map(|p| (actual(changed, p) - station).norm() - path).collect()
    };
    let column = |j: usize| {
        let moved = |by: f64| {
            let (mut changed, mut at, mut path) = (sample.clone(), station, 9.0);
            match j {
                j if j < 6 * axes => changed.rigid.walk[j / 6].location[j % 6] += by,
                j if j < 6 * axes + 3 => changed.rigid.tool_setup[j - 6 * axes] += by,
                j if j < 6 * axes + 9 => changed.rigid.workpiece_setup[j - 6 * axes - 3] += by,
                j if j < 6 * axes + 12 => at[j - 6 * axes - 9] += by,
                _ => path += by,
            }
            value(&changed, at, path)
        };
        moved(h).iter().zip(moved(-h)).map(|(u, d)| (u - d) / (2.0 * h) / unknowns[j].size).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..unknowns.len()).map(column).collect();
    let jacobian = DMatrix::from_fn(poses.len(), unknowns.len(), |i, j| columns[j][i]);
    let singular = jacobian.singular_values();
    // Differences have no more digits.
    let rank = singular.iter().filter(|s| **s > 1e-6 * singular.max()).count();
    assert_eq!(solution.rank, rank, "{singular}");
    let words = solution.null_space.join("\n");
    assert!(words.contains("station S.x") && words.contains("workpiece.X"), "{words}");
}

#[test]
fn intervals_of_a_joint_fit_of_several_kinds_cover_the_truth() {
    let truth = five("errors: { EC0Y: 12 urad, EB0Z: -20 urad, EX0C: 6 um, EA0C: 15 urad }\n");
    let blank = five("");
    let (words, known) = (["EC0Y", "EB0Z", "EX0C", "EA0C"], [12.0, -20.0, 6.0, 15.0]);
    let mut random = Random::new(83);
    let poses = five_poses(&mut random, 24);
    let nominal: Vec<Vector3<f64>> =
        poses.iter().map(|p| abbe::lower::NominalPose::at(&blank, p).pose.translation).collect();
    let off: Vec<Vector3<f64>> = poses.iter().map(|p| Vector3::from(deviation(&truth, p))).collect();
    let station = Vector3::new(700.0, -500.0, 400.0);
    let folder = Folder::new();
    let (mut inside, mut all) = (0, 0);
    let one = |i: usize, noise: f64| (nominal[i] + off[i] - station).norm() - 3.0 + 2e-3 * noise;
    let tracer = (0..24).map(|i| format!("{}{}", cells(&poses[i]), one(i, 0.0)));
    let tracer = file(
        &folder,
        "t.csv",
        "C,A,Y,X,Z,displacement [mm],station.x [mm],station.y [mm],station.z [mm]",
        tracer.map(|row| format!("{row},700,-500,400")),
    );
    let relative = (0..24).map(|i| format!("{}{},{},{}", cells(&poses[i]), off[i].x, off[i].y, off[i].z));
    let relative = file(&folder, "r.csv", "C,A,Y,X,Z,rel.dx [mm],rel.dy [mm],rel.dz [mm]", relative);
    let clean = read(&blank, &[tracer, relative]);
    let unknowns: Vec<Parameter> =
        wanted(&blank, &words).into_iter().chain(clean.nuisances.iter().cloned().map(Parameter::from)).collect();
    let model = FitModel::new(&blank, &unknowns);
    for _ in 0..1000 {
        let mut rows = clean.rows.clone();
        for row in &mut rows {
            use abbe::identify::Reading;
            match &mut row.reading {
                Reading::Distance { value, .. } => *value += 2e-3 * normal(&mut random),
                Reading::Deviation { values, .. } => {
                    values.iter_mut().flatten().for_each(|v| *v += 2e-3 * normal(&mut random));
                }
                _ => unreachable!(),
            }
        }
        let found = fit(&model, &rows, vec![1.0; rows.len()]);
        let solution = Solution::of(&found, &unknowns);
        assert_eq!(solution.rank, 11);
        for ((estimate, parameter), known) in solution.estimates.iter().zip(&unknowns).zip(known) {
            let (value, sigma) = (parameter.in_unit(estimate.value), parameter.in_unit(estimate.sigma.unwrap()));
            inside += usize::from((value - known).abs() < 1.99 * sigma);
            all += 1;
        }
    }
    let share = f64::from(u32::try_from(inside).unwrap()) / f64::from(u32::try_from(all).unwrap());
    assert!((0.93..0.97).contains(&share), "{share}");
}

#[test]
fn hostile_files_of_other_kinds_are_refused_in_words() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let said = |data: &str| {
        let data = folder.write("data.csv", data);
        let (machine, data) = (machine.to_str().unwrap(), data.to_str().unwrap());
        let output = run(&["identify", machine, "--data", data, "--fit", "EC0Y", "--format", "json"]);
        assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).starts_with("{\"refused\":true,"));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let at = "station.x [mm],station.y [mm],station.z [mm]";
    for (code, data) in [
        ("E0501", "X,length [mm]\n1,2\n".to_owned()),
        ("E0501", "X,length [deg],station\n1,2,S\n".to_owned()),
        ("E0501", "X,length,station\n1,2,S\n".to_owned()),
        ("E0501", "X,length [mm],dx [um],station\n1,2,3,S\n".to_owned()),
        ("E0501", "X,length [mm],station,to.X\n1,2,S,3\n".to_owned()),
        ("E0501", "X,length [mm],displacement [mm],station\n1,2,3,S\n".to_owned()),
        ("E0501", "X,dl [um],station\n1,2,S\n".to_owned()),
        ("E0501", "X,dx [um],station\n1,2,S\n".to_owned()),
        ("E0501", "X,length [mm],station.x [mm]\n1,2,3\n".to_owned()),
        ("E0501", "X,length [mm],station\n1,nan,S\n".to_owned()),
        ("E0501", "X,length [mm],station\n1,inf,S\n".to_owned()),
        ("E0501", "X,EXX [urad]\n1,2\n".to_owned()),
        ("E0501", "X,EC0Y [urad]\n1,2\n".to_owned()),
        ("E0501", "X,EXX+ [um],approach\n1,2,-\n".to_owned()),
        ("E0501", "X,dx [um],approach\n1,2,sideways\n".to_owned()),
        ("E0501", "X,dx [um],u [um]\n1,2,0\n".to_owned()),
        ("E0501", "X,dx [um],u [um],weight\n1,2,1,1\n".to_owned()),
        ("E0501", "X,rel.dx [um]\n1,\n".to_owned()),
        // The file does not name the X of the readings.
        ("E0501", "Y,EXX [um]\n0,1\n100,2\n".to_owned()),
        ("E0501", "X,EXX [um],EYY [um]\n0,1,2\n".to_owned()),
        ("E0501", "X,length [mm],station\n1,0,S\n".to_owned()),
        ("E0501", "X,length [mm],to.X\n1,-5,100\n".to_owned()),
        ("E0501", "X;dx [um]\n0;1,5\n1.000;2\n".to_owned()),
        ("E0501", "X;dx [um]\n0;1.5\n1000;2,5\n".to_owned()),
        ("E0505", "X,Y,length [mm],station\n1,1,500,S\n2,7,501,S\n3,2,502,S\n4,9,503,S\n5,1,504,S\n".to_owned()),
        ("E0505", "X,displacement [mm],station\n1,500,S\n2,501,S\n".to_owned()),
        ("E0505", format!("X,length [mm],{at}\n1,5,100,0,0\n2,5,200,0,0\n")),
        // The functional point at the zero pose is 250, 225, -120; the workpiece origin 250, 225, -380.
        ("E0506", format!("X,length [mm],{at}\n0,5,0,0,260\n1,5,0,0,260\n")),
        ("E0506", "X,length [mm],to.X\n10,5,10.1\n".to_owned()),
        ("more than 1 km", format!("X,length [mm],{at}\n0,5,1e12,0,260\n1,5,1e12,0,260\n")),
        ("more than 1 km", format!("X,length [m],{at}\n0,5000,0,0,260\n1,5,0,0,260\n")),
        ("E0507", "X,along [um]\n10,5\n10,6\n10.5,6\n".to_owned()),
        ("E0802", "X,length [mm],to.X\n10,5,1e9\n".to_owned()),
        ("E0503", format!("X,length [mm],{at}\n0,500,500,0,0\n100,400,500,0,0\n")),
        ("E0508", format!("X,run,rel.dx [um]\n{}", (0..600).map(|i| format!("{i},r{i},1\n")).collect::<String>())),
    ] {
        assert!(said(&data).contains(code), "{code}: {data}\n{}", said(&data));
    }
    assert!(said("X,length [mm],dx [um],station\n1,2,3,S\n").contains("mixes kinds"));
    assert!(said("Y,EXX [um]\n0,1\n100,2\n").contains("no column `X`"));
    let mixed = said("X;dx [um]\n0;1,5\n1.000;2\n");
    assert!(mixed.contains("decimal") && mixed.contains("data.csv:3"), "{mixed}");
}

/// The output of `identify` of the five-axis machine, and the bytes of its data.
pub fn identified(data: &[u8], options: &[&str]) -> (std::process::Output, Folder) {
    let folder = Folder::new();
    let (machine, file) = (folder.write("machine.yaml", FIVE), folder.path("data.csv"));
    std::fs::write(&file, data).unwrap();
    let named = |name: &&str| if name.contains('.') { folder.path(name) } else { name.into() };
    let options: Vec<std::path::PathBuf> = options.iter().map(named).collect();
    let mut arguments = vec!["identify", machine.to_str().unwrap(), "--data", file.to_str().unwrap()];
    arguments.extend(options.iter().map(|o| o.to_str().unwrap()));
    (run(&arguments), folder)
}

#[test]
fn the_fitted_machine_is_not_written_over_what_was_read() {
    let data = "X,EXX [um]\n0,1\n100,2\n200,3\n";
    for name in ["machine.yaml", "data.csv"] {
        let (output, folder) = identified(data.as_bytes(), &["--fit", "EXX:poly1", "--out", name]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains("E0630"), "{name}: {said}");
        assert_eq!(std::fs::read_to_string(folder.path("machine.yaml")).unwrap(), FIVE);
        assert_eq!(std::fs::read_to_string(folder.path("data.csv")).unwrap(), data);
    }
}

#[test]
fn units_stand_in_the_header_as_instruments_write_them() {
    let fitted = |data: &[u8]| {
        let (output, _) = identified(data, &["--fit", "EXX:poly1", "--format", "csv"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let plain = fitted(b"X [mm],EXX [um]\n0,1\n100,2\n200,4\n");
    assert_eq!(fitted(b"X [mm],EXX [um],,\n0,1,,\n100,2\n200,4,\n"), plain);
    for data in [
        b"X (mm),EXX (um)\n0,1\n100,2\n200,4\n".as_slice(),
        b"X,EXX/um\n0,1\n100,2\n200,4\n",
        b"X_cm,EXX_um\n0,1\n10,2\n20,4\n",
        b"X [mm];EXX [\xb5m]\n0;1,0\n100;2,0\n200;4,0\n",
    ] {
        assert_eq!(fitted(data), plain, "{}", String::from_utf8_lossy(data));
    }
}

#[test]
fn curves_of_any_power_of_the_language_are_written_and_read_again() {
    let rows: String = (0..51).map(|i| format!("{},{}\n", i * 10, f64::from(i % 7))).collect();
    let data = format!("X,EXX [um]\n{rows}");
    for form in ["EXX:poly10", "EXX:poly14"] {
        let (output, folder) = identified(data.as_bytes(), &["--fit", form, "--out", "fitted.yaml"]);
        assert!(output.status.success(), "{form}: {}", String::from_utf8_lossy(&output.stderr));
        let again = run(&["check", folder.path("fitted.yaml").to_str().unwrap()]);
        assert!(again.status.success(), "{form}: {}", String::from_utf8_lossy(&again.stderr));
    }
}

#[test]
fn one_reading_and_one_parameter_are_singular() {
    let (output, _) = identified(b"X,EXX [um]\n100,1\n", &["--fit", "EXX:poly1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("1 reading cannot determine 2 parameters"), "{said}");
    // Where the slope does nothing the reading is that of the constant alone: no machine file is made of it.
    let (output, folder) = identified(b"X,EXX [um]\n0,1\n", &["--fit", "EXX:poly1", "--out", "fitted.yaml"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("E0515") && said.contains("EXX:x^1 has no effect on these data"), "{said}");
    assert!(!folder.path("fitted.yaml").exists());
}

#[test]
fn one_report_of_several_kinds_names_what_belongs_to_the_instruments() {
    let folder = Folder::new();
    let machine = folder.write("machine.yaml", FIVE);
    let truth = five("errors: { EC0Y: 12 urad, EXX: { polynomial: [0 um, 20 um/m] } }\n");
    let grid = |i: usize| vec![0.0, 0.0, 90.0 * (i / 5) as f64, 100.0 * (i % 5) as f64, -80.0 * (i % 4) as f64];
    let poses: Vec<Vec<f64>> = (0..25).map(grid).collect();
    // UTF-16 with decimal commas, as spreadsheets save it.
    let mut text = "C [deg];A;Y;X [mm];Z;rel.dx [µm];rel.dy [µm];rel.dz [µm];u [um];run\r\n".to_owned();
    for pose in &poses {
        let [dx, dy, dz] = deviation(&truth, pose).map(|d| d * 1e3 + 4.0);
        let row: Vec<String> =
            pose.iter().copied().chain([dx, dy, dz, 0.5]).map(|x| x.to_string().replace('.', ",")).collect();
        text += &format!("{};am\r\n", row.join(";"));
    }
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    std::fs::write(folder.path("rtest.csv"), wide).unwrap();
    let rows: String = (0..6).map(|i| format!("{},{},1\n", i * 100, f64::from(i) * 2.0)).collect();
    let curve = folder.write("curve.csv", &format!("X [mm],EXX [um],u [um]\n{rows}"));
    let report = json(&run(&[
        "identify",
        machine.to_str().unwrap(),
        "--data",
        folder.path("rtest.csv").to_str().unwrap(),
        curve.to_str().unwrap(),
        "--fit",
        "EC0Y,EXX:poly1",
        "--format",
        "json",
    ]));
    let value = |list: &str, name: &str| {
        let found = report[list].as_array().unwrap().iter().find(|p| p["name"] == name).cloned();
        found.unwrap_or_else(|| panic!("{name}: {report}"))["value"].as_f64().unwrap()
    };
    assert!((value("parameters", "EC0Y") - 12.0).abs() < 1e-4 && (value("parameters", "EXX:x^1") - 20.0).abs() < 1e-4);
    // The subtracted reading is the deviation at the first one: -4 um here.
    assert!((value("instruments", "rtest/first am.x") + 4e-3).abs() < 1e-6, "{report}");
    assert_eq!(report["kinds"].as_array().unwrap().len(), 2);
    assert!(report["valuation"].as_f64().unwrap() > 0.5);
}
