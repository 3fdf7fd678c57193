//! The generated kinematics in the running controller on machines whose tip is not moved by X, Y and Z.

use crate::kins::{AXIS, Bench, TIP, returns};
use crate::oracle::curves::Travel;
use crate::oracle::matrix::{M4, cross, minus, mul, norm, transposed};
use crate::oracle::random::Random;
use crate::{Folder, abbe, script_json};
use serde_json::{Value, json};

const LATHE: &str = "tests/data/kins/lathe.yaml";
const ROBOT: &str = "tests/data/kins/ur5.yaml";

/// Errors of robots are a tenth of a per cent: the limits are meant for machine tools.
const LIMITS: &str = "20 mm, 30 mrad";

/// Runs lines through the simulation of a machine.
fn run(path: &str, lines: &[Value]) -> Value {
    let folder = Folder::new("topologies");
    let out = folder.0.join("out").display().to_string();
    let module = ["--target", "linuxcnc-kins", "--out", &out, "--poses", "50", "--max-correction", LIMITS];
    let _ = abbe(&[&["--quiet", "compile", path], &module[..]].concat());
    let program = folder.0.join("program.json");
    std::fs::write(&program, json!({ "lines": lines }).to_string()).unwrap();
    script_json("kins.py", &[&out, &program.display().to_string()])
}

fn line(mdi: String, record: bool) -> Value {
    json!({"mdi": mdi, "record": record, "enable": true})
}

/// Words are positions of axes; X and Z hold the tip in their plane, and C holds it across.
pub fn lathe() {
    let bench = Bench::new(LATHE, None);
    let rigid = &bench.sample.rigid;
    let mut random = Random::new(71);
    let index = |name: &str| rigid.walk.iter().position(|axis| axis.name == name).unwrap();
    let (x, z, c) = (index("X"), index("Z"), index("C"));
    let pose = |_| {
        let mut pose = vec![0.0; 3];
        (pose[x], pose[z], pose[c]) = (random.between(20.0, 199.0), random.between(1.0, 599.0), random.around(180.0));
        pose
    };
    let poses: Vec<Vec<f64>> = (0..60).map(pose).collect();
    // Words count from the workpiece origin; the controller adds the tool.
    let word = |q: f64, k: usize| q - (rigid.workpiece_origin[k] - rigid.gauge[k]) + rigid.offset[k];
    let mdi = |p: &Vec<f64>| format!("G0 X{:.12} Z{:.12} C{:.12}", word(p[x], 0), word(p[z], 2), p[c]);
    let lines: Vec<Value> = poses.iter().map(|pose| line(mdi(pose), true)).collect();
    let result = run(LATHE, &lines);
    returns(&bench, &result, &lines);
    let (mut left, mut bare) = (0.0_f64, 0.0_f64);
    for (pose, joints) in poses.iter().zip(result["joints"].as_array().unwrap()) {
        let [_, wanted] = bench.sample.holds(pose, Travel::Mean);
        let off = |command: &Vec<f64>| norm(minus(bench.sample.holds(command, Travel::Mean)[0].tip, wanted.tip));
        left = left.max(off(&bench.command(joints)));
        bare = bare.max(off(pose));
    }
    println!("  {LATHE}: tip {:.1e} um (without {:.1} um)", left * 1e3, bare * 1e3);
    assert!(left < TIP && bare > 30e-3, "{left:e} {bare:e}");
}

/// Straight motions between poses of the tool, and a pose out of reach.
pub fn robot() {
    let bench = Bench::new(ROBOT, None);
    let mut random = Random::new(72);
    let middle = [16.0, -65.0, 85.5, -45.0, 97.0, -4.5];
    let poses: Vec<Vec<f64>> = (0..20).map(|_| middle.iter().map(|q| q + random.around(12.0)).collect()).collect();
    let mdi = |pose: &Vec<f64>| {
        let [_, nominal] = bench.sample.holds(pose, Travel::Mean);
        let ([x, y, z], [a, b, c]) = (nominal.tip, angles(&nominal.rotation));
        format!("G1 X{x:.12} Y{y:.12} Z{z:.12} A{a:.12} B{b:.12} C{c:.12}")
    };
    let mut lines = vec![line("F100000".to_owned(), false)];
    lines.extend(poses.iter().map(|pose| line(mdi(pose), true)));
    lines.push(json!({"mdi": "G1 X5000", "record": false, "enable": true, "refused": "kinematicsInverse"}));
    let result = run(ROBOT, &lines);
    returns(&bench, &result, &lines);
    let mut worst = [0.0_f64; 4];
    for (pose, joints) in poses.iter().zip(result["joints"].as_array().unwrap()) {
        let [_, wanted] = bench.sample.holds(pose, Travel::Mean);
        let missed = |command: &Vec<f64>| {
            let [real, _] = bench.sample.holds(command, Travel::Mean);
            let turned = mul(&real.rotation, &transposed(&wanted.rotation));
            let half = [turned[2][1] - turned[1][2], turned[0][2] - turned[2][0], turned[1][0] - turned[0][1]];
            assert!(norm(cross(real.axis(), wanted.axis())) < 0.1);
            [norm(minus(real.tip, wanted.tip)), 0.5 * norm(half)]
        };
        let ([tip, turn], [tip_bare, turn_bare]) = (missed(&bench.command(joints)), missed(pose));
        for (worst, value) in worst.iter_mut().zip([tip, turn, tip_bare, turn_bare]) {
            *worst = worst.max(value);
        }
    }
    let [tip, turn, tip_bare, turn_bare] = worst;
    println!("  {ROBOT}: tip {:.1e} um (without {:.0} um)", tip * 1e3, tip_bare * 1e3);
    println!("  {ROBOT}: orientation {:.1e} urad (without {:.0} urad)", turn * 1e6, turn_bare * 1e6);
    assert!(tip < TIP && turn < AXIS && tip_bare > 0.3 && turn_bare > 300e-6, "{worst:?}");
}

/// Roll, pitch and yaw in deg.
fn angles(m: &M4) -> [f64; 3] {
    let pitch = (-m[2][0]).atan2(m[0][0].hypot(m[1][0]));
    [m[2][1].atan2(m[2][2]), pitch, m[1][0].atan2(m[0][0])].map(f64::to_degrees)
}
