//! The controllers' formats: written numbers against vectors computed by hand from the manuals, files as
//! somebody else would write them, files with defects, and sets on top of sets.

use std::path::{Path, PathBuf};

use crate::oracle::machines::{Sample, combinations};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::yaml;
use crate::support::{Run, abbe, compile, config, number, verify, writes_tables};

/// Every target of the binary but linuxcnc's and grid-csv, which have tests of their own.
fn targets() -> Vec<&'static str> {
    abbe::controller::NAMES
        .into_iter()
        .filter(|name| writes_tables(name) && !matches!(*name, "linuxcnc" | "grid-csv"))
        .collect()
}

/// The common example: EXX = +5 +2 0 -3 -4 um and EYX = +2 +1 0 -1 -3 um at X = -200 .. 200.
const EXAMPLE: &str = "EXX: { points: [[-200 mm, 5 um], [-100 mm, 2 um], [0 mm, 0 um], [100 mm, -3 um], [200 mm, -4 um]] }\n  \
     EYX: { points: [[-200 mm, 2 um], [-100 mm, 1 um], [0 mm, 0 um], [100 mm, -1 um], [200 mm, -3 um]] }";

fn machine(folder: &Folder, errors: &str) -> PathBuf {
    folder.write(
        "machine.yaml",
        &format!(
            "abbe: 1\nmachine: example\nchain: \"w b X Y Z t\"\naxes:\n  X: {{ controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ controller: 2, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  Z: {{ controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\nerrors:\n  {errors}\nvolume: {{ step: 100 mm }}\n"
        ),
    )
}

/// A machine with a rotary table.
fn with_table(folder: &Folder, errors: &str) -> PathBuf {
    folder.write(
        "table.yaml",
        &format!(
            "abbe: 1\nmachine: table\nchain: \"w C' b X Y Z t\"\naxes:\n  X: {{ controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ controller: 2, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  Z: {{ controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  C: {{ controller: 4, travel: continuous }}\nerrors:\n  {errors}\n\
             volume: {{ step: 100 mm, C: {{ step: 15 deg }} }}\n"
        ),
    )
}

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "50"];

/// The text of a file of a set compiled from the common example.
fn written(target: &str, errors: &str, file: &str, more: &[&str]) -> String {
    let folder = Folder::new();
    let machine = machine(&folder, errors);
    compile(&machine, target, &folder.path("out"), &[&FEW[..], more].concat()).json();
    std::fs::read_to_string(folder.path("out").join(file)).unwrap()
}

/// Numbers on the lines that begin with a text, after the last `=`, blank or letter.
fn numbers(text: &str, begin: &str) -> Vec<f64> {
    let number =
        |line: &str| line.rsplit(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).next().unwrap().parse().unwrap();
    text.lines().filter(|line| line.starts_with(begin)).map(number).collect()
}

fn close(found: &[f64], expected: &[f64], tolerance: f64) {
    let near = found.len() == expected.len() && found.iter().zip(expected).all(|(f, e)| (f - e).abs() <= tolerance);
    assert!(near, "{found:?}, not {expected:?}");
}

/// A foreign file, and the corrections of the controller from it at positions of one joint.
fn replayed(target: &str, machine: &Path, file: (&str, &str), at: &[(usize, &str, f64)]) -> Vec<f64> {
    let folder = Folder::new();
    let set = folder.path("set");
    std::fs::create_dir_all(&set).unwrap();
    std::fs::write(set.join(file.0), file.1).unwrap();
    let rows: String = at.iter().map(|(joint, way, q)| format!("{joint},{way},{q}\n")).collect();
    let positions = folder.write("positions.csv", &format!("joint,direction,position\n{rows}"));
    let run = verify(machine, &set, &["--target", target, "--replay", positions.to_str().unwrap()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.out.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect()
}

/// Siemens, Extended Functions 03/2013 p. 238: a positive value makes the axis move in the negative direction,
/// so values are the error. The correction meets the curve at the corrected command: 5 um on a slope of 3e-5.
#[test]
fn sinumerik_stores_the_error() {
    let enc = written("sinumerik-enc", EXAMPLE, "_N_AX1_EEC_INI", &[]);
    close(&numbers(&enc, "$AA_ENC_COMP[0,"), &[0.005, 0.002, 0.0, -0.003, -0.004], 1e-6);
    for (begin, value) in [("$AA_ENC_COMP_STEP", 100.0), ("$AA_ENC_COMP_MIN", -200.0), ("$AA_ENC_COMP_MAX", 200.0)] {
        close(&numbers(&enc, begin), &[value], 0.0);
    }
    assert!(enc.starts_with("%_N_AX1_EEC_INI\nCHANDATA(1)\n") && enc.ends_with("M17\n"), "{enc}");
    let cec = written("sinumerik-cec", EXAMPLE, "_N_NC_CEC_INI", &[]);
    close(&numbers(&cec, "$AN_CEC[0,"), &[0.005, 0.002, 0.0, -0.003, -0.004], 1e-6);
    // Straightness meets the curve at the corrected X: 5 um on a slope of 2e-5.
    close(&numbers(&cec, "$AN_CEC[1,"), &[0.002, 0.001, 0.0, -0.001, -0.003], 1e-6);
    assert!(cec.contains("$AN_CEC_INPUT_AXIS[1]=(AX1)\n$AN_CEC_OUTPUT_AXIS[1]=(AX2)\n"), "{cec}");
    let turned = written("sinumerik-cec", EXAMPLE, "_N_NC_CEC_INI", &["--stored", "correction"]);
    close(&numbers(&turned, "$AN_CEC[0,"), &[-0.005, -0.002, 0.0, 0.003, 0.004], 1e-6);
}

/// A table as the manual prints it (p. 242), as LEC: held outside (p. 240), straight between points.
#[test]
fn sinumerik_replay() {
    let folder = Folder::new();
    let file = "%_N_AX1_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0.0\n$AA_ENC_COMP[0,1,AX1]=0.01\n$AA_ENC_COMP[0,2,AX1]=0.012\n\
                $AA_ENC_COMP_STEP[0,AX1]=50.0\n$AA_ENC_COMP_MIN[0,AX1]=-50.0\n$AA_ENC_COMP_MAX[0,AX1]=50.0\n$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n";
    let at = [-200.0, -50.0, -25.0, 0.0, 25.0, 50.0, 200.0].map(|q| (0, "forward", q));
    let found = replayed("sinumerik-enc", &machine(&folder, "EXX: 0 um"), ("_N_AX1_EEC_INI", file), &at);
    close(&found, &[0.0, 0.0, -0.005, -0.01, -0.011, -0.012, -0.012], 1e-12);
    // A cross table for one direction acts in that direction only (p. 249), tables on one axis add up (p. 245).
    let table = |t: usize, direction: i32, value: f64| {
        format!(
            "$AN_CEC[{t},0]={value}\n$AN_CEC[{t},1]={value}\n$AN_CEC_INPUT_AXIS[{t}]=(AX1)\n$AN_CEC_OUTPUT_AXIS[{t}]=(AX1)\n\
             $AN_CEC_STEP[{t}]=100\n$AN_CEC_MIN[{t}]=0\n$AN_CEC_MAX[{t}]=100\n$AN_CEC_DIRECTION[{t}]={direction}\n\
             $AN_CEC_MULT_BY_TABLE[{t}]=0\n$AN_CEC_IS_MODULO[{t}]=0\n"
        )
    };
    let all = table(0, 1, 0.003) + &table(1, -1, 0.008) + &table(5, 0, 0.1);
    let file = format!("%_N_NC_CEC_INI\nCHANDATA(1)\n{all}M17\n");
    let at = [(0, "forward", 50.0), (0, "reverse", 50.0)];
    let found = replayed("sinumerik-cec", &machine(&folder, "EXX: 0 um"), ("_N_NC_CEC_INI", &file), &at);
    close(&found, &[-0.103, -0.108], 1e-12);
}

/// B-63980EN/01 p. 100: increments between neighbouring points, rounded on the absolute curve; a turn sums to zero.
#[test]
fn fanuc_stores_increments_of_the_rounded_correction() {
    let pitch = written("fanuc-pitch", EXAMPLE, "PITCH_X.TXT", &[]);
    // A = -5 -2 0 3 4 um over 400 mm, in sections of which none has more than 1 um.
    let sums: Vec<f64> = numbers(&pitch, "N1").chunks(4).map(|four| four.iter().sum()).collect();
    close(&sums, &[3.0, 2.0, 3.0, 1.0], 0.0);
    let fields = ["N03620Q1A1P8", "N03621Q1A1P1", "N03622Q1A1P16", "N03624Q1A1M25.000"];
    assert!(fields.iter().all(|field| pitch.lines().any(|line| line == *field)), "{pitch}");
    let folder = Folder::new();
    let harmonic = "ECC: { harmonics: { 1: [30 urad, 20 urad], 3: [7 urad, -9 urad] } }";
    let machine = with_table(&folder, harmonic);
    compile(&machine, "fanuc-pitch", &folder.path("out"), &FEW).json();
    let turn = std::fs::read_to_string(folder.path("out/PITCH_C.TXT")).unwrap();
    // The reference point, which is the farthest in - over a turn, has the value of the last.
    let mut increments = numbers(&turn, "N1");
    assert_eq!(Some(increments.remove(0)), increments.last().copied());
    assert_eq!((increments.len(), increments.iter().sum::<f64>()), (72, 0.0));
    // Half a detection unit at every point, not at every increment: 0.0005 deg.
    let mut sum = 0.0;
    for (i, increment) in increments.iter().enumerate() {
        sum += increment;
        let angle = ((i + 1) as f64 * 5.0).to_radians();
        let at = |q: f64| 30.0 * q.cos() + 20.0 * q.sin() + 7.0 * (3.0 * q).cos() - 9.0 * (3.0 * q).sin();
        let wanted = -(at(angle) - at(0.0)) * 1e-6_f64.to_degrees() * 1000.0;
        assert!((sum - wanted).abs() <= 0.501, "{i}: {sum}, not {wanted}");
    }
}

/// The worked example of the leadscrew list (Beckhoff 308693899): programmed 19866.7, measured 19856.5 um, value -102.
#[test]
fn twincat_leadscrew_example() {
    let folder = Folder::new();
    let list = "kopf.achs_nr 1\nkw.ssfk.unit 1\nkw.ssfk.interval 198667\nkw.ssfk.kw_startpos 0\nkw.ssfk.kw_nr_max 2\nkw.ssfk.bilateral 1\n\
                kw.ssfk.modulo 0\nkw.ssfk.table[0].pos 0\nkw.ssfk.table[0].neg 0\nkw.ssfk.table[1].pos -102\nkw.ssfk.table[1].neg -52\n";
    let at = [(0, "forward", 19.8667), (0, "reverse", 19.8667), (0, "forward", 150.0), (0, "forward", 9.93335)];
    let found = replayed("twincat-axis", &machine(&folder, "EXX: 0 um"), ("achskw_X.lis", list), &at);
    close(&found, &[0.0102, 0.0052, 0.0102, 0.0051], 1e-12);
    let text = written("twincat-axis", EXAMPLE, "achskw_X.lis", &[]);
    let own: Vec<f64> = (0..5).flat_map(|i| numbers(&text, &format!("kw.ssfk.table[{i}].pos"))).collect();
    close(&own, &[50.0, 20.0, 0.0, -30.0, -40.0], 0.0);
    let text = written("twincat-axis", EXAMPLE, "achskw_Y.lis", &[]);
    let cross: Vec<f64> = (0..5).flat_map(|i| numbers(&text, &format!("kw.crosscomp.table[{i}].correction"))).collect();
    close(&cross, &[-20.0, -10.0, 0.0, 10.0, 30.0], 0.0);
}

/// Turbo PMAC Software Reference: entries of 1/16 count, the first one spacing from zero, negative positions at
/// the end, the last entry that of zero; the table is added and rolls over.
#[test]
fn pmac_entries_roll_over() {
    let text = written("pmac", EXAMPLE, "compensation.pmc", &[]);
    let start = text.lines().position(|line| line.contains("DEFINE COMP") && line.contains(",#1D,#1,")).unwrap();
    assert!(text.lines().nth(start).unwrap().ends_with(" DEFINE COMP 5,#1D,#1,5000000"), "{text}");
    let entries: Vec<f64> = text.lines().skip(start + 1).take(5).map(|line| line.parse().unwrap()).collect();
    // -E in 1/16 of 0.1 um: 3, 4 um at 100, 200 mm; -5, -2 at -200, -100; a unit where the curve is met.
    close(&entries, &[480.0, 640.0, -800.0, -320.0, 0.0], 1.0);
    let folder = Folder::new();
    let list = "#1 DEFINE COMP 4,#1D,#1,4000000\n160 320\n-160 0\nI51=1\n";
    let at = [50.0, 100.0, 200.0, -100.0, -50.0].map(|q| (0, "forward", q));
    let found = replayed("pmac", &machine(&folder, "EXX: 0 um"), ("compensation.pmc", list), &at);
    close(&found, &[0.0005, 0.001, 0.002, -0.001, -0.0005], 1e-12);
}

/// Positions to command, and a table whose edge cells go on (Kinematics.cpp, GeoCorrect).
#[test]
fn kmotion_stores_commands() {
    let text = written("kmotion-geo", EXAMPLE, "geo.txt", &[]);
    let first: Vec<f64> = text.lines().nth(3).unwrap().split(',').map(|n| n.parse().unwrap()).collect();
    // Row 0, column 0 is X = -200, Y = 0: 5 um too far in +X, 2 um in +Y.
    close(&first, &[0.0, 0.0, -200.005, -0.002, 0.0], 1e-6);
    let folder = Folder::new();
    let table = "2,2\n10,10\n0,0\n0,0,0.0000,0.0000,0.0000\n0,1,10.0004,0.0001,0.0002\n1,0,-0.0003,10.0002,0.0000\n1,1,10.0002,10.0003,0.0003\n";
    let at =
        [(0, "forward", 5.0), (0, "forward", 10.0), (0, "forward", 20.0), (0, "forward", -10.0), (1, "forward", 20.0)];
    let found = replayed("kmotion-geo", &machine(&folder, "EXX: 0 um"), ("geo.txt", table), &at);
    close(&found, &[0.0002, 0.0004, 0.0008, -0.0004, 0.0004], 1e-12);
}

/// The Y axis leans to +X by 350 urad, Z to -X by 120 and to +Y by 80: the files of the firmwares' documentation.
#[test]
fn skews_of_three_firmwares() {
    let errors = "EC0Y: -350 urad\n  EB0Z: -120 urad\n  EA0Z: -80 urad";
    let klipper = written("klipper", errors, "skew_correction.cfg", &[]);
    close(&numbers(&klipper, "xy_skew"), &[0.000350], 1e-7);
    close(&numbers(&klipper, "xz_skew"), &[-0.000120], 1e-7);
    close(&numbers(&klipper, "yz_skew"), &[0.000080], 1e-7);
    let marlin = written("marlin", errors, "skew.gcode", &[]);
    close(&numbers(&marlin, "M852"), &[0.000350, -0.000120, 0.000080], 1e-7);
    let rrf = written("reprapfirmware", errors, "axis_compensation.g", &[]);
    close(&numbers(&rrf, "M556"), &[-0.350, -0.080, 0.120], 1e-4);
    let folder = Folder::new();
    let machine = machine(&folder, errors);
    for target in ["klipper", "marlin"] {
        let json = compile(&machine, target, &folder.path(target), &FEW).json();
        // Second order: 350 urad x 80 urad x 100 mm.
        assert!(number(&json, "/compensated/position_um/max") < 0.02, "{target}: {json}");
        assert!(number(&json, "/uncompensated/position_um/max") > 20.0);
    }
}

/// RepRapFirmware, Grid.cpp: axis 0 along a line, lines along axis 1, clamped, added to Z.
#[test]
fn height_maps() {
    let errors = "EZX: { points: [[-200 mm, -4 um], [200 mm, 8 um]] }";
    let text = written("reprapfirmware", errors, "heightmap.csv", &[]);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("RepRapFirmware height map file v2 "));
    assert!(lines[2].starts_with("X,Y,-200.00,200.00,0.00,100.00,-1.00,20.00,5.00,21,21"), "{}", lines[2]);
    let row: Vec<f64> = lines[3].split(',').map(|n| n.parse().unwrap()).collect();
    close(&[row[0], row[10], row[20]], &[0.004, -0.002, -0.008], 1e-9);
    assert!(lines[3].split(',').all(|cell| cell.len() <= 7 && cell.contains('.')));
}

/// TF5280: ISO names without an E for location errors, mm and rad, arguments mm and deg.
#[test]
fn volumetric_files_name_the_errors() {
    let folder = Folder::new();
    let machine = with_table(&folder, &format!("{EXAMPLE}\n  EC0Y: 12 urad\n  EX0C: 6 um"));
    compile(&machine, "isg-volcomp", &folder.path("isg"), &FEW).json();
    let csv = std::fs::read_to_string(folder.path("isg/volcomp.csv")).unwrap();
    let data: Vec<Vec<&str>> = csv
        .lines()
        .filter(|l| !l.starts_with("//") && !l.starts_with('#'))
        .map(|l| l.split_whitespace().collect())
        .collect();
    assert_eq!(data[0], ["X0C", "C0Y"]);
    assert_eq!(data[1], ["0.006000000", "0.000012000"]);
    assert_eq!(data[2], ["X", "EXX", "EYX"]);
    assert_eq!(data[3], ["-200.000000", "0.005000000", "0.002000000"]);
    let list = std::fs::read_to_string(folder.path("isg/volcomp0.lis")).unwrap();
    assert!(list.contains("\nchain CXYZ\nworkpiece_axes 1\n") && list.contains("\nc 4\n"), "{list}");
    compile(&machine, "etalon-exchange", &folder.path("etalon"), &FEW).json();
    let text = std::fs::read_to_string(folder.path("etalon/etalon.txt")).unwrap();
    assert!(text.contains("[C0Y]\nVALUE = 0.000012000\n[EXX]\nGridpoints = {\n-200.000000 0.005000000\n"), "{text}");
    // Exact but for second order and the spindle: nothing else remains.
    for target in ["isg-volcomp", "etalon-exchange"] {
        let json = compile(&machine, target, &folder.path(target), &FEW).json();
        assert!(number(&json, "/compensated/position_um/max") < 0.01, "{json}");
    }
}

#[test]
fn heidenhain_columns() {
    let text = written("heidenhain-com", EXAMPLE, "X_AXIS.COM", &[]);
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with(';')).collect();
    assert_eq!(lines[1], "NR AXISPOS X Y");
    assert_eq!(lines[2], "0 -200.0000 0.00500 0.00200");
    assert_eq!(lines[6], "4 200.0000 -0.00400 -0.00300");
    assert!(text.contains("NOT VERIFIED, from memory"), "{text}");
    // Steeper than a sixty-fourth the control refuses: 2 mm in 100.
    let folder = Folder::new();
    let steep = machine(
        &folder,
        "EXX: { points: [[-200 mm, 0 mm], [-100 mm, 0 mm], [0 mm, 0 mm], [100 mm, 0 mm], [200 mm, 2 mm]] }",
    );
    let more = [&FEW[..], &["--max-correction", "5 mm, 0.05"]].concat();
    compile(&steep, "heidenhain-com", &folder.path("out"), &more).refused("E0709").says("slope");
}

#[test]
fn what_rests_on_memory_is_not_written_by_accident() {
    let folder = Folder::new();
    let machine = machine(&folder, EXAMPLE);
    for target in ["heidenhain-com", "fanuc-pitch", "fanuc-3d"] {
        let out = folder.path(target);
        compile(&machine, target, &out, &[]).refused("E0710").says("memory");
        assert!(!out.exists());
        compile(&machine, target, &out, &FEW).json();
        let all: String = crate::replays::files(&out).into_values().collect();
        assert!(all.contains("NOT VERIFIED, from memory"), "{target}");
    }
}

/// Random machines, small errors and absurd ones: the files read back (compile insists on it), and the worst outcome is
/// a refusal with a message.
#[test]
fn random_machines_for_every_target() {
    let mut random = Random::new(44);
    let conventions: Vec<_> = combinations().collect();
    for (i, target) in targets().iter().enumerate() {
        let size = [1e-5, 3e-3][i % 2];
        let sample = Sample::random(&mut random, conventions[(7 * i) % conventions.len()], size);
        let folder = Folder::new();
        let text = yaml::write(&sample, &folder);
        let machine = folder.write("machine.yaml", &text);
        let run =
            compile(&machine, target, &folder.path("out"), &["--accept-unverified", "--poses", "10", "--nodes", "500"]);
        let refused = run.code == Some(1)
            && ["E0708", "E0709", "E0601", "E0602", "E0603"].iter().any(|code| run.err.contains(code));
        assert!(run.code == Some(0) || refused, "{target}: {:?} {}\n{text}", run.code, run.err);
        assert_eq!(folder.path("out").exists(), run.code == Some(0));
    }
}

/// Files with defects: each refused, with its place and the controller's reaction.
#[test]
fn defects_are_said() {
    type Case = (&'static str, &'static str, fn(&str) -> String, &'static str);
    let cases: [Case; 14] = [
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| t.replacen("$AN_CEC[0,1]=", "$AN_CEC[0.1]=", 1), "would not understand"),
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| t.replacen("$AN_CEC[0,1]=", "$AN_CEC[0,2]=", 1), "given twice"),
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| without(t, "$AN_CEC[0,1]="), "point 1 is missing"),
        (
            "sinumerik-cec",
            "_N_NC_CEC_INI",
            |t| t.replacen("STEP[0]=100.0000", "STEP[0]=90.0000", 1),
            "do not fit together",
        ),
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| t.replacen("(AX2)", "(AX9)", 1), "no axis `9`"),
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| t.replacen("IS_MODULO[0]=0", "IS_MODULO[0]=1", 1), "would jump"),
        ("sinumerik-cec", "_N_NC_CEC_INI", |t| without(t, "M17"), "no line `M17`"),
        ("fanuc-pitch", "PITCH_X.TXT", |t| without(t, "N10002"), "point 2 is missing"),
        ("fanuc-pitch", "PITCH_X.TXT", |t| t.replacen("N10001Q0P", "N10001Q0P0.", 1), "no increment"),
        (
            "twincat-axis",
            "achskw_X.lis",
            |t| t.replacen("kw.ssfk.kw_nr_max 5", "kw.ssfk.kw_nr_max 4", 1),
            "the file states 4",
        ),
        ("pmac", "compensation.pmc", |t| t.replacen("\nI51=1", "\n7\nI51=1", 1), "the file states"),
        ("kmotion-geo", "geo.txt", |t| format!("; a comment\n{t}"), "would not understand"),
        ("isg-volcomp", "volcomp.csv", |t| t.replacen("EYX", "EYQ", 1), "70468"),
        ("klipper", "skew_correction.cfg", |t| t.replacen("xy_skew = ", "xy_skew = 1", 1), "refuse this factor"),
    ];
    let folder = Folder::new();
    let machine = machine(&folder, EXAMPLE);
    for (target, file, change, words) in cases {
        let out = folder.path(target);
        if !out.exists() {
            compile(&machine, target, &out, &FEW).json();
        }
        let path = out.join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        let changed = change(&text);
        assert_ne!(changed, text, "{target}: {words}");
        std::fs::write(&path, changed).unwrap();
        let run = verify(&machine, &out, &["--poses", "10"]);
        assert!(
            run.code == Some(1) && run.err.contains("refused[E0704]") && run.err.contains(words),
            "{target}, {words}: {}",
            run.err
        );
        assert!(run.err.contains(&format!("{file}:")), "no place: {}", run.err);
        std::fs::write(&path, text).unwrap();
    }
}

fn without(text: &str, begin: &str) -> String {
    text.split_inclusive('\n').filter(|line| !line.starts_with(begin)).collect()
}

/// Without names and without a manifest, by their content.
#[test]
fn formats_are_told_apart_by_content() {
    let folder = Folder::new();
    let machine = machine(&folder, EXAMPLE);
    for (target, file) in [
        ("sinumerik-cec", "_N_NC_CEC_INI"),
        ("isg-volcomp", "volcomp.csv"),
        ("etalon-exchange", "etalon.txt"),
        ("twincat-axis", "achskw_X.lis"),
        ("pmac", "compensation.pmc"),
        ("kmotion-geo", "geo.txt"),
        ("fanuc-pitch", "PITCH_X.TXT"),
        ("grid-json", "corrections.json"),
    ] {
        compile(&machine, target, &folder.path(target), &FEW).json();
        let found = folder.path(&format!("found-{target}"));
        std::fs::create_dir_all(&found).unwrap();
        std::fs::copy(folder.path(target).join(file), found.join("whatever.txt")).unwrap();
        let json = verify(&machine, &found, &["--poses", "20"]).json();
        assert_eq!((&json["target"], &json["files"]), (&target.into(), &serde_json::json!(["whatever.txt"])), "{json}");
    }
    let nothing = folder.path("nothing");
    std::fs::create_dir_all(&nothing).unwrap();
    std::fs::write(nothing.join("letter.txt"), "Dear Sir,\n").unwrap();
    verify(&machine, &nothing, &[]).refused("E0705");
}

/// Measured with tables in force: the new files hold old plus new, and are judged against the measured machine.
#[test]
fn old_plus_new() {
    let folder = Folder::new();
    let errors = |um: [f64; 3]| {
        format!("EXX: {{ points: [[-200 mm, {} um], [0 mm, {} um], [200 mm, {} um]] }}", um[0], um[1], um[2])
    };
    let first = machine(&folder, &errors([5.0, 0.0, -4.0]));
    for target in ["sinumerik-enc", "linuxcnc", "isg-volcomp", "grid-csv"] {
        let (old, new) = (folder.path(&format!("{target}-old")), folder.path(&format!("{target}-new")));
        compile(&first, target, &old, &FEW).json();
        let left = folder.write(
            "left.yaml",
            &std::fs::read_to_string(&first).unwrap().replace("5 um", "1 um").replace("-4 um", "2 um"),
        );
        let more = [&FEW[..], &["--installed", old.to_str().unwrap()]].concat();
        let json = compile(&left, target, &new, &more).json();
        assert!(number(&json, "/compensated/position_um/max") < 0.002, "{target}: {json}");
        if target == "sinumerik-enc" {
            let text = std::fs::read_to_string(new.join("_N_AX1_EEC_INI")).unwrap();
            close(&numbers(&text, "$AA_ENC_COMP[0,"), &[0.006, 0.0, -0.002], 1e-6);
        }
        // The new set less the old one takes 1 and 2 um away.
        let run = Run::of(abbe().args(["diff", "--format", "json"]).arg(&left).arg(&old).arg(&new));
        let largest = number(&run.json(), "/axes/X/max_um");
        assert!((1.9..2.001).contains(&largest), "{target}: {largest}");
        let again = verify(&left, &new, &["--installed", old.to_str().unwrap(), "--poses", "50"]).json();
        assert!(number(&again, "/compensated/position_um/max") < 0.002, "{target}");
    }
    let cec = folder.path("cec");
    let other = folder.path("linuxcnc-old");
    let more = [&FEW[..], &["--installed", other.to_str().unwrap()]].concat();
    compile(&first, "sinumerik-cec", &cec, &more).refused("E0711");
    assert!(!cec.exists());
}

/// A target of one's own, by its mechanism and its decimals.
fn own_target(folder: &Folder, name: &str, mechanism: &str) {
    let path = folder.path(&format!("templates/{name}"));
    std::fs::create_dir_all(&path).unwrap();
    let manifest = format!(
        "target: {name}\ntitle: x\nexpresses: x\ncannot: []\ncertainty: {{ syntax: {{ level: own format, source: x }}, sign: {{ level: own format, source: x }} }}\n\
         sign_test: x\nmechanism: {{ cross_axis: {{ own: true, fit: functional_point, {mechanism} }} }}\n\
         controller: {{ lookup: command, interpolation: linear, outside: hold, arithmetic: float64 }}\nfiles:\n  - path: all.txt\n    template: all.j2\n    per: machine\n    \
         layout:\n      format: lines\n      lines:\n        - {{ line: \"T <table> <input> <output>\" }}\n        - {{ line: \"P <position> <value>\" }}\n"
    );
    std::fs::write(path.join("target.yaml"), manifest).unwrap();
    let template = "{% for t in tables %}T {{ t.number }} {{ t.input }} {{ t.output }}\n{% for p in t.points %}P {{ p.position }} {{ p.value }}\n{% endfor %}{% endfor %}";
    std::fs::write(path.join("all.j2"), template).unwrap();
}

/// Rounding moves no axis by more than half an increment for each of its tables.
#[test]
fn rounding_stays_within_its_bound() {
    let folder = Folder::new();
    let rules = "max_points: 200, spacing: equal, stored: correction";
    own_target(&folder, "coarse", &format!("{rules}, increment: {{ position_decimals: 6, correction_decimals: 3 }}"));
    own_target(&folder, "fine", &format!("{rules}, increment: {{ position_decimals: 6, correction_decimals: 12 }}"));
    let templates = folder.path("templates");
    let more = ["--templates", templates.to_str().unwrap(), "--poses", "200"];
    let machine = config("vmc-cframe-754.yaml");
    for target in ["coarse", "fine"] {
        compile(&machine, target, &folder.path(target), &more).json();
    }
    let run = Run::of(
        abbe()
            .args(["diff", "--format", "json"])
            .arg(&machine)
            .args([folder.path("fine"), folder.path("coarse")])
            .args(more),
    );
    for axis in ["X", "Y", "Z"] {
        let largest = number(&run.json(), &format!("/axes/{axis}/max_um"));
        // Three tables a linear axis, half a micrometre each.
        assert!(largest > 0.1 && largest <= 1.5 + 1e-6, "{axis}: {largest} um");
    }
}

/// Points as the rules have them: free with the smallest residual, in steps of a power of two, in a limited number.
#[test]
fn points_obey_the_rules() {
    let folder = Folder::new();
    let curve = "EXX: { points: [[-200 mm, 0 um], [-190 mm, 6 um], [-50 mm, 6 um], [-49 mm, -3 um], [120 mm, 0 um], [200 mm, 1 um]] }";
    let machine = machine(&folder, curve);
    let templates = folder.path("templates");
    let points = |name: &str, rules: &str| -> (Vec<f64>, f64) {
        own_target(
            &folder,
            name,
            &format!("{rules}, stored: correction, increment: {{ position_decimals: 3, correction_decimals: 6 }}"),
        );
        let more = ["--templates", templates.to_str().unwrap(), "--poses", "400"];
        let json = compile(&machine, name, &folder.path(name), &more).json();
        let text = std::fs::read_to_string(folder.path(name).join("all.txt")).unwrap();
        let place = |line: &str| line.split(' ').nth(1).unwrap().parse().unwrap();
        (
            text.lines().filter(|line| line.starts_with('P')).map(place).collect(),
            number(&json, "/compensated/position_um/rms"),
        )
    };
    let (all, left) = points("free", "max_points: 10, spacing: free");
    assert_eq!(all, [-200.0, -190.0, -50.0, -49.0, 120.0, 200.0]);
    // At a corner the correction meets the other side of the curve: 6 um on a slope of 6e-4.
    assert!(left < 3.6e-3, "{left}");
    let (five, free) = points("five", "max_points: 5, spacing: free");
    let (_, equal) = points("equal", "max_points: 5, spacing: equal");
    assert_eq!(five.len(), 5);
    assert!(free < 0.2 * equal, "free {free}, equal {equal}");
    let (powers, _) = points("powers", "max_points: 64, spacing: { power_of_two: 0.001 }");
    let steps: Vec<f64> = powers.windows(2).map(|w| w[1] - w[0]).collect();
    assert!(powers.len() <= 64 && steps.iter().all(|step| (step - 8.192).abs() < 1e-9), "{steps:?}");
}

/// Squareness is a cross table's, positioning an own-axis table's, and nothing is taken away twice.
#[test]
fn nothing_is_compensated_twice() {
    let folder = Folder::new();
    let machine = machine(&folder, &format!("{EXAMPLE}\n  EC0Y: 40 urad\n  EZY: {{ polynomial: [0 um, 30 um/m] }}"));
    for target in ["sinumerik-cec", "twincat-axis", "heidenhain-com", "pmac"] {
        let json = compile(&machine, target, &folder.path(target), &FEW).json();
        // A last place of 0.1 um in up to three tables; the lists of TwinCAT round to it.
        assert!(number(&json, "/compensated/position_um/max") < 0.2, "{target}: {json}");
        assert!(
            ["EXX", "EYX", "EZY", "EC0Y"].iter().all(|e| json["errors"][e]["handled"] == "fully"),
            "{target}: {json}"
        );
    }
    // Angles act through lever arms: a sum of tables leaves a residual, and it is reported.
    let angle = machine_with_angle(&folder);
    let json = compile(&angle, "heidenhain-com", &folder.path("angle"), &FEW).json();
    assert_eq!(json["errors"]["ECX"]["handled"], "partly", "{json}");
    for target in ["twincat-axis", "pmac", "sinumerik-cec"] {
        let json = compile(&angle, target, &folder.path(target), &FEW).json();
        assert_eq!(json["errors"]["ECX"]["handled"], "fully", "{target}: {json}");
    }
}

fn machine_with_angle(folder: &Folder) -> PathBuf {
    machine(folder, "ECX: { points: [[-200 mm, -40 urad], [200 mm, 60 urad]] }")
}
