//! Steps per mm and rotation distances: what the firmwares make of the numbers is written here once more, as the number
//! of steps and the length of a step, and shares nothing with the program.

use std::path::Path;

use abbe::controller::{ControllerTarget, Replay};
use abbe::machine::Approach;
use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::controllers::Files;
use crate::support::{Run, abbe, compile};
use crate::{loaded, replays};

/// X moves 1 mm/m too far, Y 0.8 mm/m too short, Z 2 mm/m too far; Y leans by 200 urad.
const PRINTER: &str = "abbe: 1\nmachine: printer\nchain: \"w Y' b X Z t\"\naxes:\n  X: { travel: [0 mm, 300 mm] }\n  \
    Y: { travel: [0 mm, 300 mm] }\n  Z: { travel: [0 mm, 300 mm] }\nerrors:\n  EXX: { points: [[0 mm, 0 um], [300 mm, 300 um]] }\n  \
    EYY: { points: [[0 mm, 0 um], [300 mm, -240 um]] }\n  EZZ: { points: [[0 mm, 0 um], [300 mm, 600 um]] }\n";
const SKEW: &str = "  EC0Y: 200 urad\n";
/// Axis, scale error, limit of what is left over 300 mm.
const SCALES: [(&str, f64); 3] = [("X", 1e-3), ("Y", -0.8e-3), ("Z", 2e-3)];
const FEW: [&str; 2] = ["--poses", "200"];

/// Firmware, file, option, and how a scale in force and the number of the file make a step (mm) from the one before.
type Firmware = (&'static str, &'static str, &'static str, fn(&str, &str) -> f64);

const FIRMWARES: [Firmware; 4] = [
    ("marlin", "skew.gcode", "X=80,Y=80.29,Z=400", step_of_m92),
    ("reprapfirmware", "axis_compensation.g", "X=80,Y=80.29,Z=400", step_of_m92),
    ("grbl", "settings.nc", "X=80,Y=80.29,Z=400", |text, axis| {
        let key = ["X", "Y", "Z"].iter().position(|known| *known == axis).map(|i| format!("${}=", 100 + i)).unwrap();
        1.0 / number_behind(text, &key)
    }),
    // A turn of 200 steps, divided by 16; a step of 80, 80.29 and 400 a mm.
    ("klipper", "skew_correction.cfg", "X=40,Y=39.85552372648,Z=8", |text, axis| {
        let (_, section) = text.split_once(&format!("\n[stepper_{}]\n", axis.to_lowercase())).unwrap();
        number_behind(section, "rotation_distance = ") / 3200.0
    }),
];

/// The number behind a word at the beginning of a line that is no comment.
fn number_behind(text: &str, word: &str) -> f64 {
    let line = text.lines().find_map(|line| line.strip_prefix(word)).unwrap_or_else(|| panic!("{word}: {text}"));
    line.trim().parse().unwrap()
}

fn step_of_m92(text: &str, axis: &str) -> f64 {
    1.0 / number_behind(text, &format!("M92 {axis}"))
}

fn p95(json: &Value, which: &str) -> f64 {
    json.pointer(&format!("/{which}/position_um/p95")).unwrap().as_f64().unwrap()
}

fn verify(machine: &Path, folder: &Path, more: &[&str]) -> Run {
    Run::of(abbe().arg("verify").arg(machine).arg(folder).args(["--format", "json"]).args(FEW).args(more))
}

/// The machine at its old number goes (1 + e) mm for a mm. Sent to a position with the new one, the motor makes so many
/// steps of the old machine's length: it arrives.
#[test]
fn motors_make_the_right_number_of_steps() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", &format!("{PRINTER}{SKEW}"));
    for (name, file, scale, step) in FIRMWARES {
        let out = folder.path(name);
        let run = compile(&machine, name, &out, &[&["--scale", scale][..], &FEW].concat());
        let json = run.json();
        assert!(!run.err.contains("W0718"), "{}", run.err);
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        let inverse = name == "klipper";
        for ((axis, error), entry) in SCALES.iter().zip(scale.split(',')) {
            let before: f64 = entry.split_once('=').unwrap().1.parse().unwrap();
            let step_before = if inverse { before / 3200.0 } else { 1.0 / before };
            // A motor step moves the machine further than the firmware takes it for.
            let moved = step_before * (1.0 + error);
            let arrived = 300.0 / step(&text, axis) * moved;
            assert!((arrived - 300.0).abs() < 2e-4, "{name} {axis}: {arrived}\n{text}");
        }
        // The rest is second order; Grbl leaves the skew, 200 urad over 300 mm.
        let limit = if name == "grbl" { 62.0 } else { 0.3 };
        assert!(p95(&json, "uncompensated") > 600.0 && p95(&json, "compensated") < limit, "{name}: {json}");
        for (error, judged) in json["errors"].as_object().unwrap().iter().filter(|(error, _)| *error != "EC0Y") {
            assert_eq!(judged["handled"], "fully", "{name}: {error} {judged}");
        }
        // What takes it back stands there as it was given.
        let back = entry_lines(&text, scale);
        assert_eq!(back, 3, "{name}: {text}");
    }
}

/// Number of comments with one of the numbers in force.
fn entry_lines(text: &str, scale: &str) -> usize {
    let numbers = scale.split(',').map(|entry| entry.split_once('=').unwrap().1);
    let is_in = |number: &str| {
        text.lines().any(|line| line.starts_with([';', '#']) && line.ends_with(number) && !line.starts_with("M92"))
    };
    numbers.filter(|number| is_in(number)).count()
}

/// Without the numbers in force no line is written, and it is said; half of them is half of the lines.
#[test]
fn no_scale_without_the_one_in_force() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", PRINTER);
    for (name, file, scale, _) in FIRMWARES {
        let out = folder.path(name);
        let run = compile(&machine, name, &out, &FEW);
        let json = run.json();
        run.says("W0718").says("of `X`").says("of `Z`").says("--scale");
        // A height map takes a constant of Z.
        assert!(p95(&json, "compensated") > if name == "reprapfirmware" { 380.0 } else { 600.0 }, "{json}");
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        assert!(!["\nM92", "\n$10", "rotation_distance"].iter().any(|word| text.contains(word)), "{text}");
        verify(&machine, &out, &[]).json();
        let x = scale.split(',').next().unwrap();
        let run = compile(&machine, name, &out, &[&["--scale", x][..], &FEW].concat());
        run.json();
        assert!(run.err.contains("of `Z`") && !run.err.contains("of `X`"), "{}", run.err);
    }
}

/// Without its manifest a set says the same; each number counts, and none goes without the other.
#[test]
fn numbers_and_what_takes_them_back_are_read() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", PRINTER);
    for (name, file, scale, _) in FIRMWARES {
        let out = folder.path(name);
        let json = compile(&machine, name, &out, &[&["--scale", scale][..], &FEW].concat()).json();
        std::fs::remove_file(out.join("abbe.lock.json")).unwrap();
        let found = verify(&machine, &out, &[]).json();
        assert_eq!(found["compensated"], json["compensated"], "{name}");
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        let write = |text: &str| std::fs::write(out.join(file), text).unwrap();
        let own = text.lines().filter(|line| line.contains(if name == "grbl" { "$100=" } else { "80" }));
        let first = scale.split(',').next().unwrap().split_once('=').unwrap().1;
        let now = text.lines().find(|line| {
            let sign = if name == "klipper" { "rotation_distance = 40.04" } else { "79.92" };
            line.contains(sign)
        });
        let now = now.unwrap_or_else(|| panic!("{name}: {:?} {text}", own.collect::<Vec<_>>()));
        // A per cent, in the number and in what it counts against: 3 mm over 300.
        write(&text.replace(now, &now.replace("79.92", "79.12").replace("40.04", "40.44")));
        assert!(p95(&verify(&machine, &out, &[]).json(), "compensated") > 2000.0, "{name}");
        let back = text.lines().find(|line| line.ends_with(first) && line.starts_with([';', '#'])).unwrap();
        write(&text.replace(back, &back.replace(first, if first == "40" { "40.4" } else { "80.8" })));
        assert!(p95(&verify(&machine, &out, &[]).json(), "compensated") > 2000.0, "{name}");
        write(&text.replace(&format!("{back}\n"), ""));
        verify(&machine, &out, &[]).refused("E0704").says("the number before this one is not there");
        write(&text.replace(&format!("{now}\n"), ""));
        verify(&machine, &out, &[]).refused("E0704").says("the number that takes this one's place is not there");
        write(&text.replace(back, &back.replace(first, "0")));
        verify(&machine, &out, &[]).refused("E0704").says("is no scale of a drive");
    }
}

const M503: &str = "Send: M503\nRecv: echo:; Linear Units:\nRecv: echo:  G21 ; (mm)\nRecv: echo:; Temperature Units:\nRecv: echo:  M149 C ; Units in Celsius\n\
    Recv: echo:; Steps per unit:\nRecv: echo:  M92 X80.29 Y80.29 Z399.21 E425.35\nRecv: echo:; Max feedrates (units/s):\nRecv: echo:  M203 X500.00 Y500.00 Z10.00 E50.00\n\
    Recv: echo:; Skew Factor:\nRecv: echo:  M852 I0.0010 J0.0000 K0.0000\nRecv:\nRecv: ok\n";
const CONFIG_G: &str = "; Configuration\nG90 ; absolute\nM584 X0 Y1 Z2 E3 ; drives\nM350 X16 Y16 Z16 E16 I1\nM92 X80.29 Y80.29 Z399.21 E420:420 ; steps per mm\n\
    M566 X900 Y900 Z12\nM669 K0 ; Cartesian\nM556 S100 X-0.1 Y0 Z0 ; squareness\n";
const PRINTER_CFG: &str = "[include mainsail.cfg]\n[mcu]\nserial: /dev/ttyUSB0\n\n[printer]\nkinematics: cartesian\nmax_velocity: 300\n\n[stepper_x]\nstep_pin: PB9\n\
    microsteps: 16\nrotation_distance: 80.29 # GT2\n\n[stepper_y]\nrotation_distance = 80.29 ; belt\n[stepper_z]\nrotation_distance=399.21\n[extruder]\nrotation_distance: 33.5\n\
    [extruder1]\nrotation_distance: 7\n\n[skew_correction]\n#*# <---------------------- SAVE_CONFIG ---------------------->\n#*# [skew_correction CaliFlower]\n#*# xy_skew = 0.0010\n\
    #*# xz_skew = 0.0\n#*# yz_skew = 0.0\n";
const DOLLARS: &str = "$0=10\n$1=25\n$13=0\n$100=80.290\n$101=80.290 (y, step/mm)\n$102=399.210\n$110=500.000\nok\n";

/// The settings as the controls print them. The skew in force stays, with the new one on top.
#[test]
fn scales_in_force_are_read_from_the_controls_settings() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", &format!("{PRINTER}{SKEW}"));
    let settings = [
        ("marlin", "skew.gcode", "settings.txt", M503),
        ("reprapfirmware", "axis_compensation.g", "config.g", CONFIG_G),
        ("klipper", "skew_correction.cfg", "printer.cfg", PRINTER_CFG),
        ("grbl", "settings.nc", "dollars.txt", DOLLARS),
    ];
    for (name, file, settings, text) in settings {
        let (before, out) = (folder.path(&format!("{name}-before")), folder.path(name));
        std::fs::create_dir(&before).unwrap();
        std::fs::write(before.join(settings), text).unwrap();
        let installed = ["--installed", before.to_str().unwrap(), "--poses", "200"];
        let run = compile(&machine, name, &out, &installed);
        let json = run.json();
        assert!(!run.err.contains("W0718"), "{}", run.err);
        assert!(p95(&json, "compensated") < if name == "grbl" { 62.0 } else { 0.3 }, "{name}: {json}");
        let written = std::fs::read_to_string(out.join(file)).unwrap();
        assert_eq!(entry_lines(&written, "X=80.29,Z=399.21"), 2, "{written}");
        assert_eq!(verify(&machine, &out, &installed[..2]).json()["compensated"], json["compensated"]);
        // -200 urad beside the 1000 in force: EC0Y turns Y towards -X, and the factors count where Y leans to +X.
        if let Some(skew) = ["M852 I", "xy_skew = "].iter().find(|word| written.contains(&format!("\n{word}"))) {
            assert!((number_behind(&written, skew) - 8e-4).abs() < 2e-6, "{written}");
        } else if name == "reprapfirmware" {
            assert!((number_behind(&written, "M556 S1000 X") + 0.8).abs() < 2e-3, "{written}");
        }
        // What was in force may be named by the option too, to more digits and no others.
        let same = [&installed[..], &["--scale", "X=80.2912"]].concat();
        compile(&machine, name, &out, &same).json();
        let other = [&installed[..], &["--scale", "X=81"]].concat();
        compile(&machine, name, &out, &other).refused("E0711").says("--scale says 81 for `X`");
    }
}

/// Once loaded, a number is the one in force: the next set counts from it and takes back to it.
#[test]
fn the_next_set_counts_from_the_last() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", PRINTER);
    let better = folder.write("better.yaml", &PRINTER.replace("300 um]", "30 um]").replace("600 um]", "0 um]"));
    for (name, file, scale, step) in FIRMWARES {
        let (first, second) = (folder.path(&format!("{name}1")), folder.path(&format!("{name}2")));
        compile(&machine, name, &first, &[&["--scale", scale][..], &FEW].concat()).json();
        let installed = [&["--installed", first.to_str().unwrap()][..], &FEW].concat();
        let json = compile(&better, name, &second, &installed).json();
        assert!(p95(&json, "compensated") < 1.0, "{json}");
        let [one, two] = [&first, &second].map(|out| step(&std::fs::read_to_string(out.join(file)).unwrap(), "X"));
        assert!((two / one - 1.0001).abs() < 1e-6, "{name}: {one} {two}");
        verify(&better, &second, &installed[..2]).json();
    }
}

/// Numbers of which it is not known what they move are not taken.
#[test]
fn scales_that_are_none_of_an_axis_are_refused() {
    let folder = Folder::new();
    let machine = folder.write("printer.yaml", PRINTER);
    let run = |name: &str, file: &str, text: &str| {
        let before = folder.path("before");
        let _ = std::fs::remove_dir_all(&before);
        std::fs::create_dir(&before).unwrap();
        std::fs::write(before.join(file), text).unwrap();
        compile(&machine, name, &folder.path("out"), &["--installed", before.to_str().unwrap(), "--poses", "20"])
    };
    let klipper = |from: &str, to: &str| run("klipper", "skew_correction.cfg", &PRINTER_CFG.replace(from, to));
    klipper("cartesian", "corexy").refused("E0704").says("the motors of this machine are no axes");
    klipper("80.29 #", "-80.29 #").refused("E0704").says("is no scale of a drive");
    klipper("xz_skew = 0.0", "xy_skew = 0.1").refused("E0704");
    // Three motors of Z: nothing is said of it, and it is said.
    let several = klipper("[extruder]", "[stepper_z1]\nrotation_distance: 399.21\n[extruder]");
    several.json();
    assert!(several.err.contains("of `Z`") && !several.err.contains("of `X`"), "{}", several.err);
    run("marlin", "skew.gcode", &M503.replace("  G21", "  G20")).refused("E0704").says("steps in an inch");
    let duet = |from: &str, to: &str| run("reprapfirmware", "axis_compensation.g", &CONFIG_G.replace(from, to));
    duet("K0", "K1").refused("E0704").says("the motors of this machine are no axes");
    duet("M669 K0", "M667 S1").refused("E0704");
    duet("E420:420", "S256").refused("E0704").says("another microstepping");
    duet("Z0 ;", "Z0 P1 ;").refused("E0704").says("P1 corrects Y over X");
    let option = |target: &str, scale: &str, words: &str| {
        let run = compile(&machine, target, &folder.path("out"), &["--scale", scale, "--poses", "20"]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        run.says(words);
    };
    option("marlin", "Q=80", "no linear axis `Q`");
    option("linuxcnc", "X=80", "has no scale of drives");
    for scale in ["X=0", "X", "X=80,X=81", "X=1e9", "X=-80"] {
        option("grbl", scale, "--scale: `");
    }
}

/// Marlin's planner: the skew first, steps from what it leaves. Y' = 100 - 50 x 80e-6; X' = 10 - Y' x 350e-6 + 50 x 120e-6;
/// then X by 80.08 / 80, Y by 79.92 / 80, Z by 400.4 / 400.
#[test]
fn scales_come_last() {
    let folder = Folder::new();
    let machine = loaded::machine(&replays::machine(&folder, false));
    let (y, z) = (100.0 - 50.0 * 80e-6, 50.0);
    let x = 10.0 - y * 350e-6 + z * 120e-6;
    let (expected, plain) =
        ([x * 1.001 - 10.0, y * 0.999 - 100.0, z * 1.001 - z], [10.0 * 1.001 - 10.0, 100.0 * 0.999 - 100.0, 0.05]);
    let scales = "; M92 X80\n; M92 Y80\n; M92 Z400\nM92 X80.08\nM92 Y79.92\nM92 Z400.4\n";
    let marlin = format!("G21\n{scales}M852 I0.000350\nM852 J-0.000120\nM852 K0.000080\nM500\n");
    let grbl = "; $100=80\n; $101=80\n; $102=400\n$100=80.08\n$101=79.92\n$102=400.4\n";
    for (name, file, text, expected) in
        [("marlin", "skew.gcode", marlin.as_str(), expected), ("grbl", "settings.nc", grbl, plain)]
    {
        let target = ControllerTarget::builtin(name).unwrap();
        let files: Files = [(file.to_owned(), text.to_owned())].into();
        let tables = replays::read(&target, &machine, &files).unwrap_or_else(|_| panic!("{name}"));
        let found = Replay::new(&machine, &target, &tables).addition(&Approach::Forward.at_pose(&[10.0, 100.0, 50.0]));
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12), "{name}: {found:?} {expected:?}");
    }
}

/// A manifest with a scale that is no line is refused by its reason.
#[test]
fn a_scale_is_a_line() {
    let folder = Folder::new();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/templates/grbl/target.yaml");
    let manifest = std::fs::read_to_string(path).unwrap();
    std::fs::create_dir(folder.path("own")).unwrap();
    folder.write(
        "own/target.yaml",
        &manifest.replace("target: grbl", "target: own").replace("spacing: line", "spacing: free"),
    );
    folder.write("own/settings.j2", "");
    let machine = folder.write("printer.yaml", PRINTER);
    let own = folder.path(".");
    let templates = ["--templates", own.to_str().unwrap()];
    compile(&machine, "own", &folder.path("out"), &templates).refused("E0703").says("scale: with spacing: line");
}
