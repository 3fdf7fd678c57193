//! `compile --target linuxcnc-kins`: the generated C is compiled with a shim of the controller's headers
//! and called at random poses; where its joints bring the erroneous machine is asked of the oracle.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use abbe::target::{Carried, Driven, Target};

use crate::configs;
use crate::oracle::curves::Travel;
use crate::oracle::machines::{Pose, Sample, combinations};
use crate::oracle::matrix::{V3, cross, minus, norm};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::yaml;
use crate::support::{Run, compile, config, names, verify};

const WORLD: &str = "XYZABCUVW";

/// What the module says about a pose.
struct Answer {
    joints: [f64; 9],
    back: [f64; 9],
    failures: i32,
}

/// A compiled module.
struct Module {
    folder: Folder,
}

/// What its pins hold, and a pose of the world.
#[derive(Clone, Copy)]
struct Ask {
    share: f64,
    orientation: bool,
    tool: V3,
    world: [f64; 9],
}

impl Module {
    /// Builds what a compiled set holds, any warning being an error.
    fn build(set: &Path) -> Self {
        let folder = Folder::new();
        let component = std::fs::read_to_string(set.join("abbekins.comp")).unwrap();
        let (declarations, wiring) = component.split_once("\n;;\n").unwrap();
        assert!(declarations.contains("include \"abbekins_model.h\";"));
        let shim = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/linuxcnc");
        let main = std::fs::read_to_string(shim.join("kins_main.c")).unwrap();
        let _ = folder.write("all.c", &format!("#include \"shim.h\"\n{wiring}\n{main}"));
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-D_POSIX_C_SOURCE=199309L", "-Wall", "-Wextra", "-Werror", "-O0", "-I"]).arg(&shim);
        let done =
            cc.arg("-I").arg(set).arg("-o").arg(folder.path("all")).arg(folder.path("all.c")).arg("-lm").output();
        let done = done.unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        Self { folder }
    }

    fn answers(&self, asked: &[Ask]) -> Vec<Answer> {
        let mut run =
            Command::new(self.folder.path("all")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let text = |ask: &Ask| {
            let numbers: Vec<String> = ask.tool.iter().chain(&ask.world).map(f64::to_string).collect();
            format!("1 {} {} {}\n", ask.share, u8::from(ask.orientation), numbers.join(" "))
        };
        let input: String = asked.iter().map(text).collect();
        let mut stdin = run.stdin.take().unwrap();
        let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
        let output = run.wait_with_output().unwrap();
        writer.join().unwrap().unwrap();
        assert!(output.status.success());
        let answer = |line: &str| {
            let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
            let nine = |from: usize| std::array::from_fn(|i| numbers[from + i]);
            Answer { joints: nine(0), back: nine(9), failures: numbers[19] as i32 }
        };
        let answers: Vec<Answer> = String::from_utf8(output.stdout).unwrap().lines().map(answer).collect();
        assert_eq!(answers.len(), asked.len());
        answers
    }
}

/// Axes of a sample by the controller's letters: an axis with another name has the first free letter.
fn letters(sample: &Sample) -> Vec<usize> {
    let walk = &sample.rigid.walk;
    let own = |name: &str| WORLD.find(name).filter(|_| name.len() == 1);
    let mut taken: Vec<usize> = walk.iter().filter_map(|axis| own(&axis.name)).collect();
    let mut letter = |rotary: bool| {
        let kind = if rotary { 3..6 } else { 0..9 };
        let free = kind.filter(|k| rotary || !(3..6).contains(k)).find(|k| !taken.contains(k)).unwrap();
        taken.push(free);
        free
    };
    walk.iter().map(|axis| own(&axis.name).unwrap_or_else(|| letter(axis.rotary))).collect()
}

/// A machine and its module.
struct Bench<'a> {
    sample: &'a Sample,
    letters: Vec<usize>,
}

impl<'a> Bench<'a> {
    fn new(sample: &'a Sample) -> Self {
        Self { sample, letters: letters(sample) }
    }

    fn ask(&self, pose: &Pose, share: f64) -> Ask {
        let rigid = &self.sample.rigid;
        let [_, ideal] = self.sample.holds(pose, Travel::Mean);
        let [_, zero] = self.sample.holds(&vec![0.0; pose.len()], Travel::Mean);
        let mut world = [0.0; 9];
        pose.iter().zip(&self.letters).for_each(|(q, letter)| world[*letter] = *q);
        world[..3].copy_from_slice(&minus(ideal.tip, zero.tip));
        Ask { share, orientation: true, tool: rigid.offset.map(|x| -x), world }
    }

    /// Joints stand in the order of the letters.
    fn command(&self, answer: &Answer) -> Pose {
        let mut order: Vec<usize> = (0..self.letters.len()).collect();
        order.sort_by_key(|axis| self.letters[*axis]);
        let mut command = vec![0.0; order.len()];
        order.iter().enumerate().for_each(|(joint, axis)| command[*axis] = answer.joints[joint]);
        command
    }

    /// The weaker of the two tilts of the tool axis that a turn of rotary axes by 1 makes: the sine of the
    /// angle from a singular pose of two orthogonal axes. By differences of the oracle.
    fn agility(&self, pose: &Pose) -> f64 {
        const STEP: f64 = 1e-3;
        let axis_at = |axis: usize, by: f64| {
            let mut pose = pose.clone();
            pose[axis] += by;
            self.sample.holds(&pose, Travel::Mean)[1].axis()
        };
        let rotary = (0..pose.len()).filter(|i| self.sample.rigid.walk[*i].rotary);
        let ways = rotary.map(|i| minus(axis_at(i, STEP), axis_at(i, -STEP)).map(|x| x / (2.0 * STEP.to_radians())));
        let ways: Vec<V3> = ways.collect();
        // Sum of squares of the areas, over the larger eigenvalue: the smaller one.
        let trace: f64 = ways.iter().map(|w| norm(*w).powi(2)).sum();
        let pairs =
            ways.iter().enumerate().flat_map(|(i, a)| ways[..i].iter().map(move |b| norm(cross(*a, *b)).powi(2)));
        let determinant: f64 = pairs.sum();
        let spread = (0.25 * trace * trace - determinant).max(0.0).sqrt();
        (determinant / (0.5 * trace + spread).max(1e-12)).sqrt()
    }

    /// Everything a module promises at poses: the tip, the tool axis, the way back, the switch.
    fn promises(&self, module: &Module, poses: &[Pose]) -> [f64; 3] {
        let asked: Vec<Ask> = poses.iter().map(|pose| self.ask(pose, 1.0)).collect();
        let off: Vec<Ask> = poses.iter().map(|pose| self.ask(pose, 0.0)).collect();
        let half: Vec<Ask> = poses.iter().map(|pose| self.ask(pose, 0.5)).collect();
        let all = module.answers(&[asked.clone(), off, half].concat());
        let mut worst = [0.0_f64; 3];
        for (k, pose) in poses.iter().enumerate() {
            let [on, off, half] = [0, 1, 2].map(|part| &all[part * poses.len() + k]);
            assert_eq!(on.failures, 0, "{pose:?}");
            let command = self.command(on);
            let [real, _] = self.sample.holds(&command, Travel::Mean);
            let [_, wanted] = self.sample.holds(pose, Travel::Mean);
            worst[0] = worst[0].max(norm(minus(real.tip, wanted.tip)));
            if self.agility(pose) > 1.0_f64.to_radians().sin() {
                let unit = |v: V3| v.map(|x| x / norm(v));
                worst[1] = worst[1].max(norm(cross(unit(real.axis()), unit(wanted.axis()))));
            }
            for answer in [on, off, half] {
                let gap = |i: usize| (answer.back[i] - asked[k].world[i]).abs();
                worst[2] = (0..9).map(gap).fold(worst[2], f64::max);
            }
            let (ideal, middle) = (self.command(off), self.command(half));
            for axis in 0..pose.len() {
                assert!((ideal[axis] - pose[axis]).abs() < 1e-9, "{ideal:?} {pose:?}");
                assert!((middle[axis] - 0.5 * (pose[axis] + command[axis])).abs() < 1e-9);
            }
        }
        worst
    }
}

/// Poses a little inside the travels, so that corrected commands are still on the oracle's curves; every
/// fifth near one where all rotary axes are at 0.
fn poses(sample: &Sample, random: &mut Random, count: usize) -> Vec<Pose> {
    let pose = |k: usize| {
        let position = |i: usize| {
            let [low, high] = sample.axes[i].travel.unwrap_or([-500.0, 800.0]);
            let (middle, half) = (0.5 * (low + high), 0.45 * (high - low));
            let near = if k.is_multiple_of(10) { 1e-9 } else { 1.0 };
            let small = sample.rigid.walk[i].rotary && k.is_multiple_of(5) && low < -1.0 && high > 1.0;
            if small { random.around(near) } else { middle + random.around(half) }
        };
        (0..sample.axes.len()).map(position).collect()
    };
    (0..count).map(pose).collect()
}

/// Roundings of some metres over a dozen matrices, and the steps left out by the stop of the iteration.
const TIP: f64 = 1e-9;
const AXIS: f64 = 1e-12;
const BACK: f64 = 1e-9;

fn small(worst: [f64; 3], what: &str) {
    assert!(worst[0] < TIP && worst[1] < AXIS && worst[2] < BACK, "{what}: tip, axis, way back {worst:?}");
}

const WIDE: [&str; 4] = ["--poses", "20", "--max-correction", "90 mm, 90 mrad"];

/// Without X, Y and Z no kinematics that hold the tip.
const REFUSED: [&str; 1] = ["papers/hrdina-vasik-2014.yaml"];

/// Forms of curves that the reader of these tests does not know; the random machines have them.
const OTHER_FORMS: [&str; 2] = ["papers/holub-2015.yaml", "papers/holub-2015-as-printed.yaml"];

#[test]
fn every_config_is_held_where_the_program_wants_it() {
    let mut random = Random::new(51);
    let all = configs::names();
    let count = all.len();
    for name in all {
        let folder = Folder::new();
        let out = folder.path("out");
        let run = compile(&config(&name), "linuxcnc-kins", &out, &WIDE);
        if REFUSED.contains(&name.as_str()) {
            let _ = run.refused("E0750");
            assert!(!out.exists());
            continue;
        }
        assert_eq!(run.code, Some(0), "{name}: {}", run.err);
        let module = Module::build(&out);
        if OTHER_FORMS.contains(&name.as_str()) {
            continue;
        }
        let sample = crate::support::config::sample(&config(&name));
        let bench = Bench::new(&sample);
        let poses = poses(&sample, &mut random, 60);
        small(bench.promises(&module, &poses), &name);
        replay_agrees(&name, &bench, &module, &poses);
    }
    assert!(count >= 20);
}

/// The replay of the certificate is another implementation of the same numbers.
fn replay_agrees(name: &str, bench: &Bench, module: &Module, poses: &[Pose]) {
    let machine = configs::machine(name);
    let target = Target::embedded("linuxcnc-kins").unwrap();
    let carried = Carried::of(&machine, &target, true).unwrap();
    let driven = Driven::new(&machine, &carried);
    let asked: Vec<Ask> = poses.iter().map(|pose| bench.ask(pose, 1.0)).collect();
    for (pose, answer) in poses.iter().zip(module.answers(&asked)) {
        let (ours, theirs) = (driven.command(pose).unwrap(), bench.command(&answer));
        let gap = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Rotary corrections next to a singular pose are rounded over the damping, 0.017.
        assert!(gap < 1e-9, "{name} at {pose:?}: {ours:?} {theirs:?}");
    }
}

/// Random machines of every combination of conventions, with curves of every form.
fn every_convention(seed: u64, linearised: bool, real: bool) {
    let mut random = Random::new(seed);
    for conventions in combinations() {
        let conventions = crate::oracle::rigid::Conventions { linearised, real, ..conventions };
        let (sample, folder) = accepted(&mut random, conventions);
        let module = Module::build(&folder.path("out"));
        let poses = poses(&sample, &mut random, 40);
        let text = std::fs::read_to_string(folder.path("machine.yaml")).unwrap();
        small(Bench::new(&sample).promises(&module, &poses), &text);
    }
}

/// Draws until the target takes the machine; flat triples of directions are the only ones it refuses.
fn accepted(random: &mut Random, conventions: crate::oracle::rigid::Conventions) -> (Sample, Folder) {
    for _ in 0..1000 {
        let mut sample = Sample::random(random, conventions, 1e-4);
        let linear: Vec<usize> = (0..sample.axes.len()).filter(|i| !sample.rigid.walk[*i].rotary).collect();
        let rotary: Vec<usize> = (0..sample.axes.len()).filter(|i| sample.rigid.walk[*i].rotary).collect();
        if linear.len() < 3 || rotary.len() > 3 {
            continue;
        }
        for (names, axes) in [("XYZUVW", &linear), ("BCA", &rotary)] {
            axes.iter().zip(names.chars()).for_each(|(i, name)| sample.rigid.walk[*i].name = name.to_string());
        }
        let columns = [0, 1, 2].map(|k| sample.rigid.walk[linear[k]].direction);
        let size: f64 = columns.iter().map(|v| norm(*v)).product();
        let volume: f64 = columns[0].iter().zip(cross(columns[1], columns[2])).map(|(a, b)| a * b).sum();
        // Turned by a rotary axis in between they may still be flat: such poses are rare and not wanted here.
        let between = (linear[0]..linear[2]).any(|i| sample.rigid.walk[i].rotary);
        if volume.abs() < 0.3 * size || between {
            continue;
        }
        let folder = Folder::new();
        let _ = yaml::write(&sample, &folder);
        let run = compile(&folder.path("machine.yaml"), "linuxcnc-kins", &folder.path("out"), &WIDE);
        assert_eq!(run.code, Some(0), "{}", run.err);
        return (sample, folder);
    }
    panic!("no machine found");
}

#[test]
fn orthogonal_joints_of_every_convention() {
    every_convention(52, false, false);
}

#[test]
fn linearised_joints_of_every_convention() {
    every_convention(53, true, true);
}

#[test]
fn a_name_cannot_break_out_of_the_text() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(config("gantry-3ax.yaml")).unwrap();
    let odd = "*/ #include <x> */ \\\" ?? %s {{ machine }} ;;";
    let text = text.replace("machine: Moving gantry milling machine", &format!("machine: '{odd}'"));
    let text = text.replace("errors/gantry-3ax", &config("errors/gantry-3ax").display().to_string());
    let machine = folder.write("machine.yaml", &text);
    let out = folder.path("out");
    let run = compile(&machine, "linuxcnc-kins", &out, &WIDE);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let _ = Module::build(&out);
    for name in names(&out).iter().filter(|name| name.ends_with(".h") || name.ends_with(".comp")) {
        assert!(!std::fs::read_to_string(out.join(name)).unwrap().contains("#include <x>"), "{name}");
    }
}

/// What is no pose is refused, and the controller stops with a message; the next pose is taken again.
#[test]
fn absurd_poses_are_failures() {
    let folder = Folder::new();
    let (_, out) = set(&folder);
    let module = Module::build(&out);
    let at = |x: f64| Ask {
        share: 1.0,
        orientation: true,
        tool: [0.0, 0.0, 100.0],
        world: [x, 0., 0., 0., 0., 0., 0., 0., 0.],
    };
    let far_tool = Ask { tool: [f64::NAN, 0.0, 0.0], ..at(0.0) };
    let answers = module.answers(&[at(1.0), at(f64::NAN), at(f64::INFINITY), at(-1e12), far_tool, at(1.0)]);
    assert_eq!(answers.iter().map(|answer| answer.failures).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 4]);
    assert_eq!(answers[0].joints, answers[5].joints);
}

/// A compiled three-axis set.
fn set(folder: &Folder) -> (PathBuf, PathBuf) {
    let (machine, out) = (config("vmc-cframe-754.yaml"), folder.path("out"));
    assert_eq!(compile(&machine, "linuxcnc-kins", &out, &WIDE).code, Some(0));
    (machine, out)
}

#[test]
fn defects_by_hand_are_refused_with_their_line() {
    let folder = Folder::new();
    let (machine, out) = set(&folder);
    let data = out.join("abbekins_data.h");
    let good = std::fs::read_to_string(&data).unwrap();
    let defects = [
        (
            "static const int abbe_rotary[ABBE_AXES] = { 0, 0, 0 };",
            "static const int abbe_rotary[ABBE_AXES] = { 0, 0 };",
        ),
        ("abbe_joint[ABBE_AXES] = { 0, 1, 2 }", "abbe_joint[ABBE_AXES] = { 1, 0, 2 }"),
        ("abbe_coordinate[ABBE_AXES] = { 0", "abbe_coordinate[ABBE_AXES] = { 9"),
        ("abbe_damping[1] = { 0.017 }", "abbe_damping[1] = { 0 }"),
        ("abbe_damping[1] = { 0.017 }", "abbe_damping[1] = { nan }"),
        ("abbe_gauge[3] = { 0.0", "abbe_gauge[3] = { 1/0"),
        ("static const double abbe_gauge", "static const double abbe_other"),
        ("abbe_form[ABBE_CURVES] = { 0", "abbe_form[ABBE_CURVES] = { 4"),
        ("abbe_start[ABBE_CURVES] = { 0", "abbe_start[ABBE_CURVES] = { 99999999"),
        ("abbe_period[ABBE_CURVES] = { 0.0", "abbe_period[ABBE_CURVES] = { -360"),
        ("#endif", "int main(void) { return 0; }\n#endif"),
        ("{ { 0, ", "{ { 999, "),
    ];
    for (from, to) in defects {
        assert!(good.contains(from), "{from}");
        std::fs::write(&data, good.replacen(from, to, 1)).unwrap();
        let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704");
    }
    std::fs::write(&data, good.replacen("/* 0: linear */\n    ", "/* 0: linear */\n    1e5, ", 1)).unwrap();
    let _ = verify(&machine, &out, &["--poses", "20"]).refused("E0704");
    std::fs::remove_file(&data).unwrap();
    let _ = verify(&machine, &out, &[]).refused("E0705");
}

#[test]
fn an_edited_number_is_replayed_as_it_is() {
    let folder = Folder::new();
    let (machine, out) = set(&folder);
    let data = out.join("abbekins_data.h");
    let good = std::fs::read_to_string(&data).unwrap();
    let left = |run: &Run| run.json()["compensated"]["position_um"]["max"].as_f64().unwrap();
    // What is left is reversal.
    let before = left(&verify(&machine, &out, &["--poses", "200"]));
    assert!(before < 10.0, "{before}");
    let wrong = good.replacen("abbe_tool_clamping[3] = { 0.0,", "abbe_tool_clamping[3] = { 0.5,", 1);
    assert_ne!(wrong, good);
    std::fs::write(&data, wrong).unwrap();
    let run = verify(&machine, &out, &["--poses", "200"]);
    let _ = run.says("W0701");
    // The module believes the tip half a millimetre beside where it is.
    assert!((left(&run) - 500.0).abs() < 10.0, "{}", left(&run));
}
