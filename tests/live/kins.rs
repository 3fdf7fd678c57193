//! The generated kinematics module in the running controller, against the exact rigid-body model.

use crate::oracle::curves::Travel;
use crate::oracle::machines::Sample;
use crate::oracle::matrix::{V3, cross, minus, mul, norm, transposed};
use crate::oracle::random::Random;
use crate::{Folder, abbe, config, script_json};
use serde_json::{Value, json};
use std::path::Path;

const POSES: usize = 200;
/// Number of the poses that are driven without correction too.
const BARE: usize = 20;
/// Tip and tool axis after correction: 0.05 um and 0.1 urad.
pub const TIP: f64 = 0.05e-3;
pub const AXIS: f64 = 0.1e-6;
/// Beyond this angle from a singular pose the tool axis is corrected exactly, deg.
const SINGULAR: f64 = 1.0;

pub fn three_axis() {
    let seen = drive("configs/vmc-cframe-754.yaml", None);
    println!("  left: tool axis {:.1} urad, which three axes cannot correct", seen.axis * 1e6);
}

pub fn table_table() {
    let seen = drive("configs/trunnion.yaml", Some("A"));
    assert!(seen.axis < AXIS && seen.axis_bare > 10e-6);
}

pub fn head_table() {
    let seen = drive("configs/ht-b-c.yaml", Some("B"));
    assert!(seen.axis < AXIS && seen.axis_bare > 5e-6);
}

/// The comparison can fail: a module with the sign of one of its numbers turned is noticed.
pub fn spoiled() {
    let bench = Bench::new("configs/trunnion.yaml", Some("A"));
    let poses = &poses(&bench)[..6];
    let lines = poses.iter().map(|pose| json!({"mdi": bench.line(pose), "record": true, "enable": true}));
    let program = json!({ "lines": lines.collect::<Vec<Value>>() }).to_string();
    type Spoil = (&'static str, fn(&str) -> String);
    let spoils: [(&str, Spoil); 1] = [(
        "a location error",
        ("abbekins_data.h", |text| {
            let array = text.find("abbe_location[").unwrap();
            let start = array + text[array..].find('{').unwrap();
            let number = start + text[start..].find(|c: char| ('1'..='9').contains(&c)).unwrap();
            let word = text[..number].rfind(' ').unwrap() + 1;
            match text[word..].strip_prefix('-') {
                Some(rest) => format!("{}{rest}", &text[..word]),
                None => format!("{}-{}", &text[..word], &text[word..]),
            }
        }),
    )];
    for (what, (file, spoil)) in spoils {
        let folder = Folder::new("spoiled");
        let out = folder.0.join("out");
        let _ = abbe(&[
            "--quiet",
            "compile",
            "configs/trunnion.yaml",
            "--target",
            "linuxcnc-kins",
            "--out",
            &out.display().to_string(),
            "--poses",
            "5",
        ]);
        let sound = std::fs::read_to_string(out.join(file)).unwrap();
        let spoiled = spoil(&sound);
        assert_ne!(spoiled, sound);
        std::fs::write(out.join(file), spoiled).unwrap();
        let path = folder.0.join("program.json");
        std::fs::write(&path, &program).unwrap();
        let result = script_json("kins.py", &[&out.display().to_string(), &path.display().to_string()]);
        let commands = result["joints"].as_array().unwrap().iter().map(|row| bench.command(row));
        let tip = poses.iter().zip(commands).map(|(pose, command)| bench.missed(pose, &command)[0]).fold(0.0, f64::max);
        println!("  {what} turned: tip {:.1e} um off, {:.0} times what is allowed", tip * 1e3, tip / TIP);
        assert!(tip > 4.0 * TIP, "{what}: {tip:e} mm");
    }
}

/// The simulation as it is written; and switching off and on moves no joint in a step.
pub fn launcher() {
    let bench = Bench::new("configs/trunnion.yaml", Some("A"));
    let folder = Folder::new("launcher");
    let out = folder.0.join("out").display().to_string();
    let _ = abbe(&["--quiet", "compile", "configs/trunnion.yaml", "--target", "linuxcnc-kins", "--out", &out]);
    let result = script_json("kins.py", &[&out, "--launcher"]);
    let [on, off, again] = ["on", "off", "again"].map(|key| bench.command(&result[key]));
    // X100 Y150 Z100 from the workpiece origin at A = -20, C = 30, found from the ideal machine at its command.
    let [_, nominal] = bench.sample.holds(&off, Travel::Mean);
    assert!(norm(minus(nominal.tip, [100.0, 150.0, 100.0])) < 1e-9, "{off:?} {nominal:?}");
    let [real, _] = bench.sample.holds(&on, Travel::Mean);
    assert!(norm(minus(real.tip, [100.0, 150.0, 100.0])) < TIP, "{on:?} {real:?}");
    assert_eq!(on, again);
    let shares: Vec<f64> = result["shares"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    let way = on.iter().zip(&off).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let step = result["largest_step"].as_f64().unwrap();
    println!("  correction of {way:.1e} (mm, deg) fades with at most {step:.1e} between two of {} looks", shares.len());
    assert!(shares.len() > 100 && step < 0.25 * way);
}

/// Largest values over the poses, mm and rad.
struct Seen {
    axis: f64,
    axis_bare: f64,
}

/// A machine as the tests know it.
pub struct Bench {
    pub sample: Sample,
    /// Axes in the order of the controller's joints, by their place in the walk.
    pub joints: Vec<usize>,
    /// The axis whose angle gives the distance of the pose from a singular one.
    tilting: Option<usize>,
}

impl Bench {
    pub fn new(path: impl AsRef<Path>, tilting: Option<&str>) -> Self {
        let sample = config::sample(path.as_ref());
        let index = |name: &str| sample.rigid.walk.iter().position(|axis| axis.name == name);
        let robot = (1..=9).map(|k| format!("J{k}"));
        let joints: Vec<usize> =
            "XYZABCUVW".chars().map(String::from).chain(robot).filter_map(|name| index(&name)).collect();
        assert_eq!(joints.len(), sample.rigid.walk.len());
        let tilting = tilting.map(|name| index(name).unwrap());
        Self { joints, tilting, sample }
    }

    fn line(&self, pose: &[f64]) -> String {
        let [_, nominal] = self.sample.holds(&pose.to_vec(), Travel::Mean);
        let mut line = "G0".to_owned();
        for axis in &self.joints {
            let known = &self.sample.rigid.walk[*axis];
            let linear = "XYZ".find(&known.name);
            let value = linear.map_or(pose[*axis], |k| nominal.tip[k]);
            line += &format!(" {}{value:.12}", known.name);
        }
        line
    }

    pub fn command(&self, joints: &Value) -> Vec<f64> {
        let mut command = vec![0.0; self.joints.len()];
        self.joints.iter().zip(joints.as_array().unwrap()).for_each(|(axis, q)| command[*axis] = q.as_f64().unwrap());
        command
    }

    /// Returns the distances of the tip and of the direction of the tool from those of the program, and the rotation of
    /// the tool about its axis.
    fn missed(&self, pose: &[f64], command: &[f64]) -> [f64; 3] {
        let [_, wanted] = self.sample.holds(&pose.to_vec(), Travel::Mean);
        let [real, _] = self.sample.holds(&command.to_vec(), Travel::Mean);
        let angle = norm(cross(unit(real.axis()), unit(wanted.axis())));
        let m = mul(&real.rotation, &transposed(&wanted.rotation));
        let skew = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
        let about: f64 = (0..3).map(|k| 0.5 * skew[k] * wanted.axis()[k]).sum();
        [norm(minus(real.tip, wanted.tip)), angle, about.abs()]
    }
}

fn unit(v: V3) -> V3 {
    v.map(|x| x / norm(v))
}

fn drive(path: &str, tilting: Option<&str>) -> Seen {
    let bench = Bench::new(path, tilting);
    let folder = Folder::new("kins");
    let out = folder.0.join("out").display().to_string();
    let _ = abbe(&["--quiet", "compile", path, "--target", "linuxcnc-kins", "--out", &out, "--poses", "50"]);
    let poses = poses(&bench);
    let singular = singular(&bench);
    let entry =
        |pose: &[f64], record: bool, enable: bool| json!({"mdi": bench.line(pose), "record": record, "enable": enable});
    // A motion of 1e-9 deg is none to the controller: each of these is approached from elsewhere.
    let mut lines: Vec<Value> =
        singular.iter().flat_map(|pose| [entry(&poses[0], false, true), entry(pose, true, true)]).collect();
    lines.extend(poses.iter().map(|pose| entry(pose, true, true)));
    lines.extend(poses[..BARE].iter().map(|pose| entry(pose, true, false)));
    let program = folder.0.join("program.json");
    std::fs::write(&program, json!({ "lines": lines }).to_string()).unwrap();
    let result = script_json("kins.py", &[&out, &program.display().to_string()]);
    let joints = result["joints"].as_array().unwrap();
    assert_eq!(joints.len(), singular.len() + POSES + BARE);
    let commands: Vec<Vec<f64>> = joints.iter().map(|row| bench.command(row)).collect();
    steady(&bench, &singular, &commands[..singular.len()]);
    returns(&bench, &result, &lines);
    let (driven, bare) = commands[singular.len()..].split_at(POSES);
    report(path, &bench, &poses, driven, bare, &result)
}

/// Poses over the travels, turned axes over a turn.
pub fn poses(bench: &Bench) -> Vec<Vec<f64>> {
    let mut random = Random::new(41);
    let mut position = |axis: usize| {
        let [low, high] = bench.sample.axes[axis].travel.unwrap_or([-180.0, 180.0]);
        // Corrections at the very end would leave the curves.
        random.between(low + 0.5, high - 0.5)
    };
    (0..POSES).map(|_| (0..bench.joints.len()).map(&mut position).collect()).collect()
}

/// The start of every program, and a hair to either side of it, at some positions of the last rotary axis.
fn singular(bench: &Bench) -> Vec<Vec<f64>> {
    let Some(tilting) = bench.tilting else { return Vec::new() };
    let middle = |axis: usize| bench.sample.axes[axis].travel.map_or(0.0, |[low, high]| 0.5 * (low + high));
    let base: Vec<f64> =
        (0..bench.joints.len()).map(|i| if bench.sample.rigid.walk[i].rotary { 0.0 } else { middle(i) }).collect();
    let other = (0..base.len()).find(|i| *i != tilting && bench.sample.rigid.walk[*i].rotary).unwrap();
    let mut all = Vec::new();
    for turn in [0.0, 37.0, 90.0] {
        for tilt in [0.0, 1e-9, -1e-9, 0.0] {
            let mut pose = base.clone();
            (pose[tilting], pose[other]) = (tilt, turn);
            all.push(pose);
        }
    }
    all
}

/// Within 1e-9 deg of the singular pose no joint moves by more than 2e-8: the slope of rotary corrections is
/// at most the tilt over the square of the damping, 0.35 here, and the levers are below 20 mm per deg.
fn steady(bench: &Bench, poses: &[Vec<f64>], commands: &[Vec<f64>]) {
    let mut largest = 0.0_f64;
    for group in commands.chunks(4) {
        for other in &group[1..] {
            let change = |i: usize| (group[0][i] - other[i]).abs();
            largest = (0..other.len()).map(change).fold(largest, f64::max);
        }
        assert!(group[0].iter().zip(&group[3]).all(|(a, b)| (a - b).abs() < 1e-10), "another way back");
    }
    let tip = poses.iter().zip(commands).map(|(p, c)| bench.missed(p, c)[0]).fold(0.0, f64::max);
    assert!(largest < 2e-8 && tip < TIP, "{largest:e} {tip:e}");
    if !poses.is_empty() {
        println!(
            "  around the singular pose: joints move by {largest:.1e} (mm, deg) for 1e-9 deg, tip {tip:.1e} mm off"
        );
    }
}

/// The status channel's position, forward kinematics of the joints, is the programmed one.
pub fn returns(bench: &Bench, result: &Value, lines: &[Value]) {
    let mut largest = 0.0_f64;
    let zero: V3 = std::array::from_fn(|k| bench.sample.rigid.workpiece_origin[k] - bench.sample.rigid.gauge[k]);
    let recorded = lines.iter().filter(|line| line["record"] == true);
    for (line, back) in recorded.zip(result["back"].as_array().unwrap()) {
        for word in line["mdi"].as_str().unwrap().split(' ').skip(1) {
            let (letter, value) = word.split_at(1);
            let k = "XYZABCUVW".find(letter).unwrap();
            let tool = result["tool"][k].as_f64().unwrap_or(0.0);
            let programmed = value.parse::<f64>().unwrap() + if k < 3 { zero[k] + tool } else { 0.0 };
            largest = largest.max((back[k].as_f64().unwrap() - programmed).abs());
        }
    }
    println!("  forward(inverse(pose)) of {} axes in the controller: {largest:.1e} (mm, deg)", bench.joints.len());
    assert!(largest < 1e-9, "{largest:e}");
}

fn report(
    path: &str,
    bench: &Bench,
    poses: &[Vec<f64>],
    driven: &[Vec<f64>],
    bare: &[Vec<f64>],
    result: &Value,
) -> Seen {
    let far = |pose: &[f64]| bench.tilting.is_none_or(|axis| pose[axis].abs() > SINGULAR);
    let largest = |commands: &[Vec<f64>], k: usize| {
        let all = poses.iter().zip(commands).filter(|(pose, _)| k != 1 || far(pose));
        all.map(|(pose, command)| bench.missed(pose, command)[k]).fold(0.0, f64::max)
    };
    let pin = |name: &str| {
        let values = result["pins"].as_array().unwrap().iter().map(|pins| pins[name].as_f64().unwrap());
        values.fold(0.0, f64::max)
    };
    let (tip, axis) = (largest(driven, 0), largest(driven, 1));
    let (tip_bare, axis_bare) = (largest(bare, 0), largest(bare, 1));
    println!("  {path}: {POSES} poses, tip {:.1e} um (without {:.1} um)", tip * 1e3, tip_bare * 1e3);
    println!(
        "  {path}: tool axis {:.1e} urad (without {:.1} urad); about it at most {:.0} urad",
        axis * 1e6,
        axis_bare * 1e6,
        largest(driven, 2) * 1e6
    );
    println!("  {path}: at most {} steps; failures {}", pin("iterations"), pin("failures"));
    assert!(tip < TIP, "tip {tip:e} mm");
    assert!(tip_bare > 20e-3 || bench.tilting.is_some() && tip_bare > 10e-3, "without correction {tip_bare:e} mm");
    assert_eq!(pin("failures"), 0.0);
    Seen { axis, axis_bare }
}
