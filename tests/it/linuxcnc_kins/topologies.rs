//! Machines whose tip is not moved by three linear axes, and axes under every name.

use super::bench::{Bench, Module, poses};
use super::{WIDE, small};
use crate::oracle::machines::{Sample, combinations};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::yaml;
use crate::support::{Run, abbe, compile};
use std::path::{Path, PathBuf};

/// A machine of tests/data/kins.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/kins").join(name)
}

/// A robot of axes in random directions.
fn random_robot(random: &mut Random, folder: &Folder, count: usize) -> PathBuf {
    let mut text = "abbe: 1\nmachine: Robot\nchain: \"w b".to_owned();
    (1..=count).for_each(|k| text += &format!(" J{k}"));
    text += " t\"\naxes:\n";
    for k in 1..=count {
        let [u, p] = [random.vector(1.0), random.vector(600.0)];
        text += &format!("  J{k}: {{ kind: rotary, direction: {u:?}, origin: {p:?}, travel: [-170 deg, 170 deg] }}\n");
    }
    text += "tool: { gauge: [100, 50, 30], offset: [0, 20, -90] }\nworkpiece: { origin: [0, 0, 0] }\nerrors:\n";
    for k in 1..=count {
        let [um, urad] = [random.around(100.0), random.around(200.0)];
        text += &format!("  EX0J{k}: {um} um\n  EZ0J{k}: {um} um\n  EA0J{k}: {urad} urad\n  EB0J{k}: {urad} urad\n");
    }
    folder.write("robot.yaml", &text)
}

/// Compiles, and gives the run and the set.
fn compiled(machine: &Path, folder: &Folder) -> (Run, PathBuf) {
    let out = folder.path("out");
    (compile(machine, "linuxcnc-kins", &out, &WIDE), out)
}

/// Sees to it that a machine keeps its promises; at how many poses the tip was held.
fn kept(sample: &Sample, out: &Path, random: &mut Random, (words, count): (&str, usize), what: &str) -> usize {
    let bench = Bench::new(sample, out);
    assert_eq!(bench.words(), words, "{what}");
    let (worst, held) = bench.promises(&Module::build(out), &poses(sample, random, count));
    // The residual, tenths of a mm, is seen along directions found by differences, good to 1e-8.
    let tip = if words == "axes" { 0.1 * worst[0] } else { worst[0] };
    small(([tip, worst[1], worst[2]], held), what);
    held
}

#[test]
fn a_lathe_without_y_is_corrected_as_far_as_its_axes_go() {
    let folder = Folder::new();
    let machine = data("lathe.yaml");
    let (run, out) = compiled(&machine, &folder);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let _ = run.says("W0760");
    let sample = crate::support::config::sample(&machine);
    let held = kept(&sample, &out, &mut Random::new(61), ("axes", 60), "lathe");
    assert!(held > 50, "{held}");
    let ini = std::fs::read_to_string(out.join("sim.ini")).unwrap();
    assert!(ini.contains("COORDINATES = X Z C\n"), "{ini}");
}

/// Without C the errors across X and Z stay, and the certificate states them.
#[test]
fn what_two_axes_cannot_move_is_left() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(data("lathe.yaml")).unwrap().replace("w C' b", "w b");
    let text: Vec<&str> = text.lines().filter(|line| !line.contains("C: ") && !line.contains("0C:")).collect();
    let machine = folder.write("lathe.yaml", &(text.join("\n") + "\n"));
    let (run, out) = compiled(&machine, &folder);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let sample = crate::support::config::sample(&machine);
    assert_eq!(kept(&sample, &out, &mut Random::new(62), ("axes", 20), "X and Z"), 20);
    let left = run.json()["compensated"]["position_um"]["max"].as_f64().unwrap();
    // EA0Z of 70 urad over 600 mm and EC0X of 90 urad over 200 mm are Y.
    assert!(left > 20.0 && left < 61.0, "{left}");
}

#[test]
fn robots_hold_the_pose_of_the_tool() {
    let mut random = Random::new(63);
    let folder = Folder::new();
    let machine = data("ur5.yaml");
    let (run, out) = compiled(&machine, &folder);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let sample = crate::support::config::sample(&machine);
    let held = kept(&sample, &out, &mut random, ("pose", 200), "UR5");
    assert!(held > 100, "{held}");
    for count in [6, 6, 7] {
        let folder = Folder::new();
        let machine = random_robot(&mut random, &folder, count);
        let (run, out) = compiled(&machine, &folder);
        assert_eq!(run.code, Some(0), "{}", run.err);
        let sample = crate::support::config::sample(&machine);
        let text = std::fs::read_to_string(&machine).unwrap();
        let held = kept(&sample, &out, &mut random, ("pose", 60), &text);
        assert!(held > 30, "{held}: {text}");
    }
}

/// Random chains of three to six axes, of every convention, as they come.
#[test]
fn whatever_the_language_can_say() {
    let mut random = Random::new(64);
    let (mut seen, mut held) = ([0; 3], 0);
    for conventions in combinations().step_by(2) {
        // Errors of machine tools, 20 um and 20 urad: with larger ones corrections next to a singular pose change
        // faster than the axes they correct, and forward kinematics find no inverse solution.
        let sample = Sample::random(&mut random, conventions, 2e-5);
        let folder = Folder::new();
        let _ = yaml::write(&sample, &folder);
        let (run, out) = compiled(&folder.path("machine.yaml"), &folder);
        assert_eq!(run.code, Some(0), "{}", run.err);
        let text = std::fs::read_to_string(folder.path("machine.yaml")).unwrap();
        let bench = Bench::new(&sample, &out);
        let words = bench.words();
        seen[["tip", "pose", "axes"].iter().position(|w| *w == words).unwrap()] += 1;
        if words == "tip" {
            continue; // The tests of every convention have these.
        }
        held += kept(&sample, &out, &mut random, (words, 30), &text);
    }
    assert!(seen[2] >= 4 && held > 60, "{seen:?} {held}");
}

/// Chains in random directions with two rotary axes, where these tilt the tool in one direction only, and from 1e-9 to
/// 2 deg beside it: the tip is held, corrections are bounded and do not jump, and the inverse is found or refused.
#[test]
fn random_chains_at_and_beside_their_singular_poses() {
    const BESIDE: [f64; 15] =
        [-2.0, -0.8, -0.1, -1e-3, -1e-6, -2e-9, -1e-9, 0.0, 1e-9, 2e-9, 1e-6, 1e-3, 0.1, 0.8, 2.0];
    let mut random = Random::new(65);
    let (mut met, mut lost) = (0, 0);
    for conventions in combinations().chain(combinations()) {
        let (sample, folder) = super::accepted(&mut random, conventions, 2e-5);
        let rotary = sample.rigid.walk.iter().filter(|axis| axis.rotary).count();
        if rotary != 2 || met > 400 {
            continue;
        }
        let out = folder.path("out");
        let (bench, module) = (Bench::new(&sample, &out), Module::build(&out));
        let text = std::fs::read_to_string(folder.path("machine.yaml")).unwrap();
        for pose in poses(&sample, &mut random, 6).iter().filter_map(|pose| bench.singular(pose)) {
            let beside = BESIDE.map(|by| {
                let mut pose = pose.clone();
                pose[bench.last()] += by;
                pose
            });
            let (worst, refused, commands) = bench.beside_singular(&module, &beside);
            assert!(worst[0] < super::TIP && worst[1] < super::BACK, "{worst:?} at {pose:?}: {text}");
            assert!(commands.iter().all(|(_, share)| *share < 1.1), "{commands:?} at {pose:?}: {text}");
            for (a, b) in commands
                .iter()
                .zip(&commands[1..])
                .zip(BESIDE.windows(2))
                .filter(|(_, by)| by[1] - by[0] < 1e-8)
                .map(|(c, _)| c)
            {
                let jump = a.0.iter().zip(&b.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(jump < 1e-6, "{jump} at {pose:?}: {text}");
            }
            met += BESIDE.len();
            lost += refused;
        }
    }
    assert!(met > 200 && lost * 10 < met, "{met} poses, {lost} ways back refused");
}

#[test]
fn axes_beyond_the_letters_are_refused_and_rotary_ones_warned_of() {
    let folder = Folder::new();
    let axis = |k: usize| format!("  J{k}: {{ kind: rotary, direction: [0, 0, 1], travel: [-9 deg, 9 deg] }}\n");
    let write = |count: usize| {
        let names: Vec<String> = (1..=count).map(|k| format!("J{k}")).collect();
        let axes: String = (1..=count).map(axis).collect();
        let chain = names.join(" ");
        let text = format!(
            "abbe: 1\nmachine: m\nchain: \"w b X Y Z {chain} t\"\naxes:\n  X: {{ travel: [0, 9] }}\n  Y: {{ travel: [0, 9] }}\n  \
             Z: {{ travel: [0, 9] }}\n{axes}tool: {{ length: 100 mm }}\nerrors:\n  EXX: {{ points: [[0 mm, 0 um], [9 mm, 3 um]] }}\n"
        );
        folder.write("machine.yaml", &text)
    };
    let machine = write(4);
    let run =
        Run::of(abbe().args(["compile", "--target", "linuxcnc-kins", "--out"]).arg(folder.path("out")).arg(&machine));
    assert_eq!(run.code, Some(0), "{}", run.err);
    let _ = run.says("W0761");
    let ini = std::fs::read_to_string(folder.path("out").join("sim.ini")).unwrap();
    assert!(ini.contains("COORDINATES = X Y Z A B C U\n"), "{ini}");
    let out = folder.path("other");
    let _ = compile(&write(7), "linuxcnc-kins", &out, &WIDE).refused("E0752");
    assert!(!out.exists());
}
