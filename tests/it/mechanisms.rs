//! Mechanisms of controllers besides one table for each axis: products of tables, planes, tables for both directions,
//! tables beside kinematics. Vectors by hand from the manuals, and readers of the test's own.

use std::path::{Path, PathBuf};

use crate::oracle::machines::{Sample, combinations};
use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::oracle::yaml;
use crate::support::{Run, abbe, cec, compile, config, names, number, set_files, verify};

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "60"];

fn machine(folder: &Folder, chain: &str, errors: &str) -> PathBuf {
    let rotary = if chain.contains('C') { "  C: { controller: 4, travel: continuous }\n" } else { "" };
    folder.write(
        "machine.yaml",
        &format!(
            "abbe: 1\nmachine: example\nchain: \"{chain}\"\naxes:\n  X: {{ controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  Y: {{ controller: 2, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  \
             Z: {{ controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n{rotary}errors:\n  {errors}\nvolume: {{ step: 100 mm }}\n"
        ),
    )
}

const THREE: &str = "w b X Y Z t";
const TABLE: &str = "w C' b X Y Z t";

/// EXX forward 5 2 0 -3 -4 um, in reverse 8 4 3 -1 -3, at X = -200 .. 200.
const BOTH: &str = "EXX: { forward: { points: [[-200 mm, 5 um], [-100 mm, 2 um], [0 mm, 0 um], [100 mm, -3 um], [200 mm, -4 um]] }, \
     reverse: { points: [[-200 mm, 8 um], [-100 mm, 4 um], [0 mm, 3 um], [100 mm, -1 um], [200 mm, -3 um]] } }";

/// A set of one foreign file, and the corrections of the controller from it: joint, direction, position.
fn replayed(target: &str, machine: &Path, file: (&str, &str), at: &[(usize, &str, f64)]) -> Vec<f64> {
    let folder = Folder::new();
    let set = set_of(&folder, file);
    let rows: String = at.iter().map(|(joint, way, q)| format!("{joint},{way},{q}\n")).collect();
    let positions = folder.write("positions.csv", &format!("joint,direction,position\n{rows}"));
    let run = verify(machine, &set, &["--target", target, "--replay", positions.to_str().unwrap()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.out.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect()
}

fn set_of(folder: &Folder, (name, text): (&str, &str)) -> PathBuf {
    let set = folder.path("set");
    std::fs::create_dir_all(&set).unwrap();
    std::fs::write(set.join(name), text).unwrap();
    set
}

fn close(found: &[f64], expected: &[f64], tolerance: f64) {
    let near = found.len() == expected.len() && found.iter().zip(expected).all(|(f, e)| (f - e).abs() <= tolerance);
    assert!(near, "{found:?}, not {expected:?}");
}

/// A-77810E: 3620 to 3622 are for travel in +, 3626 is the farthest point in - for travel in -, 3627 the absolute amount at
/// the reference position approached in -. A = -E: -5 -2 0 3 4 and -8 -4 -3 1 3 um.
#[test]
fn fanuc_in_both_directions() {
    let folder = Folder::new();
    let machine = machine(&folder, THREE, BOTH);
    let json = compile(&machine, "fanuc-pitch", &folder.path("out"), &FEW).json();
    let text = std::fs::read_to_string(folder.path("out/PITCH_X.TXT")).unwrap();
    let expected = [
        "%",
        "N03605Q1A1P00000001",
        "N03620Q1A1P8",
        "N03621Q1A1P1",
        "N03622Q1A1P16",
        "N03623Q1A1P1",
        "N03624Q1A1M25.000",
        "N03626Q1A1P101",
        "N03627Q1A1P-3",
    ];
    assert_eq!(text.lines().take(9).collect::<Vec<_>>(), expected);
    // 100 mm of a table by hand are four sections, none with more than a unit.
    let increments: Vec<i32> = text
        .lines()
        .filter(|line| line.starts_with("N1"))
        .map(|l| l.split('P').nth(1).unwrap().parse().unwrap())
        .collect();
    assert!(increments.iter().all(|n| n.abs() <= 1), "{text}");
    assert_eq!(increments.chunks(4).map(|four| four.iter().sum()).collect::<Vec<i32>>(), [3, 2, 3, 1, 4, 1, 4, 2]);
    // Straight lines leave half a unit of the rounding; the pulse at the worse end of its section one more.
    assert!(number(&json, "/straight/position_um/max") < 0.51, "{json}");
    assert!((0.9..1.51).contains(&number(&json, "/compensated/position_um/max")), "{json}");
    // Half a detection unit below the sum at every point, in both directions.
    let at: Vec<(usize, &str, f64)> = ["forward", "reverse"]
        .iter()
        .flat_map(|way| [-200.0, -150.0, 0.0, 100.0, 200.0].map(|q| (0, *way, q)))
        .collect();
    let found = replayed("fanuc-pitch", &machine, ("PITCH_X.TXT", &text), &at);
    let um = [
        -5.0,
        text_sum(&increments[..2]) - 5.0,
        0.0,
        3.0,
        4.0,
        -8.0,
        text_sum(&increments[16..18]) - 8.0,
        -3.0,
        1.0,
        3.0,
    ];
    close(&found, &um.map(|um| um * 1e-3), 1e-12);
}

fn text_sum(increments: &[i32]) -> f64 {
    f64::from(increments.iter().sum::<i32>())
}

/// B-63980EN/01 p. 100, example 2: reference point 60, 45 deg, farthest point in - again 60, in + 60 + 360 / 45 = 68; the
/// values 61 to 68 sum to zero, and 60 has the value of 68.
#[test]
fn fanuc_turn() {
    let folder = Folder::new();
    let machine = machine(&folder, TABLE, "EXX: 0 um");
    let list = |sixty: i32| {
        let points = [sixty, 1, 1, -1, -2, 0, 1, 1, -1];
        let rows: String = points.iter().enumerate().map(|(i, p)| format!("N{}Q0P{p}\n", 10060 + i)).collect();
        let head = "%\nN03605Q1A4P00000000\nN03620Q1A4P60\nN03621Q1A4P60\nN03622Q1A4P68\nN03623Q1A4P1\nN03624Q1A4M45.0\nN03625Q1A4M360.0\n";
        format!("{head}{rows}%\n")
    };
    let at = [0.0, 22.5, 45.0, 90.0, 180.0, 315.0, 360.0, 405.0].map(|q| (3, "forward", q));
    let found = replayed("fanuc-pitch", &machine, ("PITCH_C.TXT", &list(-1)), &at);
    close(&found, &[0.0, 0.0005, 0.001, 0.002, -0.001, 0.001, 0.0, 0.001], 1e-12);
    let run = verify(&machine, &set_of(&folder, ("PITCH_C.TXT", &list(0))), &["--target", "fanuc-pitch"]);
    run.refused("E0704").says("60 and 68");
}

/// Tables whose own values a controller may add where tables are multiplied: of all, of the second factors, of none.
const READINGS: [[bool; 2]; 3] = [[true, true], [false, true], [false, false]];

/// Siemens, Extended Functions 03/2013 p. 252: dX = Z sin(tilt(X)). Here the tilt rises along X and Z is the lever, and the
/// sum of the tables is that error, whatever the controller adds of the factors.
#[test]
fn a_tilt_times_a_lever() {
    let folder = Folder::new();
    let machine = machine(&folder, THREE, "EBX: { points: [[-200 mm, -40 urad], [200 mm, 60 urad]] }");
    let json = compile(&machine, "sinumerik-cec", &folder.path("with"), &FEW).json();
    let without =
        compile(&machine, "sinumerik-cec", &folder.path("without"), &[&FEW[..], &["--without", "product"]].concat());
    let without = without.json();
    assert_eq!(
        (&json["errors"]["EBX"]["handled"], &without["errors"]["EBX"]["handled"]),
        (&"fully".into(), &"partly".into())
    );
    let left = [&json, &without].map(|json| number(json, "/compensated/position_um/p95"));
    assert!(left[0] < 0.02 && left[1] > 0.5, "{left:?}");
    let tables =
        cec::CorrectionTables::read(&std::fs::read_to_string(folder.path("with/_N_NC_CEC_INI")).unwrap()).unwrap();
    assert_eq!(tables.0.values().filter(|table| table.times > 0).count() % 2, 0);
    assert!(tables.0.values().any(|table| table.times > 0));
    for [x, z] in [[-200.0, 100.0], [200.0, 100.0], [-120.0, 30.0], [37.0, 0.0], [150.0, 71.0]] {
        let error = (10.0 + 0.25 * x) * 1e-6 * z;
        for reading in READINGS {
            let found = tables.sum(1, &[x, 50.0, z], false, reading);
            assert!((found - error).abs() < 2e-5, "{reading:?} at {x} {z}: {found}, not {error}");
        }
    }
}

/// f = 0.1 0.3 over X, g = 0.2 0.4 over Z, and both once more with the other sign: at X = 100, Z = 0 twice 0.3 times 0.2.
#[test]
fn products_are_read_where_their_factors_cancel() {
    let folder = Folder::new();
    let machine = machine(&folder, THREE, "EXX: 0 um");
    let table = |t: usize, [a, b]: [f64; 2], input: usize, times: usize| {
        format!(
            "$AN_CEC[{t},0]={a}\n$AN_CEC[{t},1]={b}\n$AN_CEC_INPUT_AXIS[{t}]=(AX{input})\n$AN_CEC_OUTPUT_AXIS[{t}]=(AX1)\n\
             $AN_CEC_STEP[{t}]=100\n$AN_CEC_MIN[{t}]=0\n$AN_CEC_MAX[{t}]=100\n$AN_CEC_DIRECTION[{t}]=0\n\
             $AN_CEC_MULT_BY_TABLE[{t}]={times}\n$AN_CEC_IS_MODULO[{t}]=0\n"
        )
    };
    let file = |body: &str| format!("%_N_NC_CEC_INI\nCHANDATA(1)\n{body}M17\n");
    let first = table(0, [0.1, 0.3], 1, 2) + &table(1, [0.2, 0.4], 3, 0);
    let opposite = table(2, [-0.1, -0.3], 1, 4) + &table(3, [-0.2, -0.4], 3, 0);
    let at = [(0, "forward", 100.0), (0, "reverse", 50.0), (0, "forward", -50.0)];
    let all = file(&(first.clone() + &opposite));
    close(&replayed("sinumerik-cec", &machine, ("_N_NC_CEC_INI", &all), &at), &[-0.12, -0.08, -0.04], 1e-15);
    let refused = |text: &str, words: &str| {
        let set = set_of(&folder, ("_N_NC_CEC_INI", text));
        verify(&machine, &set, &["--target", "sinumerik-cec"]).refused("E0704").says(words);
    };
    refused(&file(&first), "not documented");
    refused(&all.replace("MULT_BY_TABLE[0]=2", "MULT_BY_TABLE[0]=9"), "table number 9");
    refused(&all.replace("MULT_BY_TABLE[0]=2", "MULT_BY_TABLE[0]=3"), "one and the same axis");
}

/// Gain of products on a whole machine, and their room: at most 62 tables.
#[test]
fn products_on_a_whole_machine() {
    let (name, factor) = ("vmc-cframe-754.yaml", 4.0);
    let folder = Folder::new();
    let left = ["with", "without"].map(|out| {
        let more = if out == "with" { vec![] } else { vec!["--without", "product"] };
        let json =
            compile(&config(name), "sinumerik-cec", &folder.path(out), &[&["--poses", "200"], &more[..]].concat());
        number(&json.json(), "/compensated/position_um/p95")
    });
    assert!(left[0] * factor < left[1], "{name}: {left:?}");
    let tables =
        cec::CorrectionTables::read(&std::fs::read_to_string(folder.path("with/_N_NC_CEC_INI")).unwrap()).unwrap();
    assert!(tables.0.len() <= 62 && *tables.0.keys().last().unwrap() == tables.0.len() - 1);
    let again = verify(&config(name), &folder.path("with"), &["--poses", "200"]).json();
    assert_eq!(number(&again, "/compensated/position_um/p95"), left[0]);
}

/// PMAC 2 Software Reference p. 211: the entries of row 0 begin one column from the origin, those of further rows at it. Four
/// columns of 100 mm over motor 1, two rows of 50 mm over motor 2.
#[test]
fn pmac_plane_by_hand() {
    let folder = Folder::new();
    let path = machine(&folder, THREE, "EXX: 0 um");
    let list =
        "#1 DEFINE COMP 2.4,#1D,#2D,#1,4000000,1000000\n160 320 -160 0\n16 176 336 -144 16\n0 160 320 -160 0\nI51=1\n";
    let mut diagnostics = abbe::diagnostic::Diagnostics::default();
    let machine = crate::loaded::machine(&path);
    let target = abbe::controller::ControllerTarget::builtin("pmac").unwrap();
    let tables =
        target.read(&machine, &[abbe::controller::ReadBack::new("compensation.pmc", list)], &mut diagnostics).unwrap();
    let replay = abbe::controller::Replay::new(&machine, &target, &tables);
    let added = |x: f64, y: f64| replay.addition(&abbe::machine::Approach::Forward.at_pose(&[x, y, 0.0]))[0];
    // 160 sixteenths of a ten-thousandth of a millimetre are a micrometre.
    let cases = [
        (100.0, 0.0, 1.0),
        (200.0, 0.0, 2.0),
        (-100.0, 0.0, -1.0),
        (50.0, 0.0, 0.5),
        (0.0, 50.0, 0.1),
        (100.0, 50.0, 1.1),
        (100.0, 25.0, 1.05),
        (-150.0, 0.0, 0.5),
        (100.0, 75.0, 1.05),
        (100.0, 100.0, 1.0),
    ];
    for (x, y, um) in cases {
        assert!((added(x, y) - um * 1e-3).abs() < 1e-12, "{x} {y}: {} mm", added(x, y));
    }
    let torn = list.replace("-144 16\n", "-144 17\n");
    verify(&path, &set_of(&folder, ("compensation.pmc", &torn)), &["--target", "pmac"]).refused("E0704").says("jump");
}

/// Turbo PMAC Software Reference p. 301: subtracted when the motor moves in the negative direction, added to Ixx86, zero at the
/// motor's zero.
#[test]
fn pmac_backlash_by_hand() {
    let folder = Folder::new();
    let path = machine(&folder, THREE, "EXX: 0 um");
    let list =
        "#1 DEFINE COMP 4,#1D,#1,4000000\n160 320\n-160 0\n#1 DEFINE BLCOMP 4,4000000\n80 160 -32 0\nI51=1\nI186=32\n";
    let at = [
        (0, "forward", 100.0),
        (0, "reverse", 100.0),
        (0, "reverse", 0.0),
        (0, "reverse", -100.0),
        (0, "reverse", 50.0),
    ];
    let found = replayed("pmac", &path, ("compensation.pmc", list), &at);
    close(&found, &[1e-3, 0.3e-3, -0.2e-3, -1e-3, 0.05e-3], 1e-12);
    let constant = list.replace("#1 DEFINE BLCOMP 4,4000000\n80 160 -32 0\n", "");
    close(
        &replayed("pmac", &path, ("compensation.pmc", &constant), &at),
        &[1e-3, 0.8e-3, -0.2e-3, -1.2e-3, 0.3e-3],
        1e-12,
    );
    // Written: the lost motion is 3 um at 0, and 3 2 3 2 1 from -200 on.
    let machine = machine(&folder, THREE, BOTH);
    let json = compile(&machine, "pmac", &folder.path("out"), &FEW).json();
    let text = std::fs::read_to_string(folder.path("out/compensation.pmc")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let start = lines.iter().position(|line| line.starts_with("#1 DEFINE BLCOMP 5,5000000")).unwrap();
    let entries: Vec<f64> = lines[start + 1..start + 6].iter().map(|line| line.parse().unwrap()).collect();
    close(&entries, &[-160.0, -320.0, 0.0, -160.0, 0.0], 1.0);
    assert_eq!(lines[start + 6], "I186=480");
    assert!(number(&json, "/compensated/position_um/max") < 0.02, "{json}");
}

/// A module holds the mean, tables beside it half of the difference of the directions; without them that half remains.
#[test]
fn reversal_beside_kinematics() {
    let folder = Folder::new();
    let more = "\n  EYX: 12 urad".replace("EYX: 12 urad", "EC0Y: 20 urad");
    let machine = machine(&folder, TABLE, &format!("{BOTH}{more}"));
    let out = folder.path("out");
    let json = compile(&machine, "linuxcnc-kins", &out, &["--poses", "60"]).json();
    assert!(number(&json, "/compensated/position_um/max") < 2e-3, "{json}");
    assert_eq!(json["errors"]["EXX"]["handled"], "fully");
    assert!(
        names(&out).contains(&"reversal_X.comp".to_owned())
            && !names(&out).iter().any(|name| name.contains("reversal_Y"))
    );
    let table = std::fs::read_to_string(out.join("reversal_X.comp")).unwrap();
    let rows: Vec<Vec<f64>> =
        table.lines().map(|line| line.split(' ').map(|cell| cell.parse().unwrap()).collect()).collect();
    // Half of reverse minus forward: 1.5 1 1.5 1 0.5 um.
    for (row, (q, um)) in rows.iter().zip([(-200.0, 1.5), (-100.0, 1.0), (0.0, 1.5), (100.0, 1.0), (200.0, 0.5)]) {
        close(row, &[q, um * 1e-3, -um * 1e-3], 1e-6);
    }
    let ini = std::fs::read_to_string(out.join("sim.ini")).unwrap();
    let section = ini.split("[JOINT_0]").nth(1).unwrap().split("[AXIS_").next().unwrap();
    assert!(section.contains("COMP_FILE = reversal_X.comp\nCOMP_FILE_TYPE = 1\n"), "{ini}");
    assert_eq!(ini.matches("COMP_FILE = ").count(), 1);
    let again = verify(&machine, &out, &["--poses", "60"]).json();
    assert_eq!(again["compensated"], json["compensated"]);
    for gone in ["reversal_X.comp", "abbe.lock.json"] {
        std::fs::remove_file(out.join(gone)).unwrap();
    }
    let alone = verify(&machine, &out, &["--poses", "60"]).json();
    assert!((1.2..1.51).contains(&number(&alone, "/compensated/position_um/max")), "{alone}");
}

/// Old tables with points where the new ones have none: taken over where points are free, else reported.
#[test]
fn what_resampling_loses_is_said() {
    let folder = Folder::new();
    let peak = "EXX: { points: [[-200 mm, 0 um], [-10 mm, 0 um], [0 mm, 8 um], [10 mm, 0 um], [200 mm, 0 um]] }";
    let first = machine(&folder, THREE, peak);
    let smooth = folder.write(
        "left.yaml",
        &std::fs::read_to_string(&first)
            .unwrap()
            .replace(peak, "EXX: { points: [[-200 mm, 1 um], [0 mm, 0 um], [200 mm, 2 um]] }"),
    );
    for (target, loses) in [("linuxcnc", false), ("isg-volcomp", false), ("sinumerik-enc", true)] {
        let old = folder.path(&format!("{target}-old"));
        compile(&first, target, &old, &FEW).json();
        let more = [&FEW[..], &["--installed", old.to_str().unwrap()]].concat();
        let run = compile(&smooth, target, &folder.path(&format!("{target}-new")), &more);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_eq!(run.err.contains("W0704"), loses, "{target}: {}", run.err);
    }
}

/// COMP_FILE tables for the deviation of the functional point instead of the axis's own error.
#[test]
fn own_axis_tables_for_the_functional_point() {
    let folder = Folder::new();
    // The tip is 50 mm above the axis on average: an angle about Y moves it along X.
    let machine = machine(&folder, THREE, "EBX: { points: [[-200 mm, -40 urad], [200 mm, 60 urad]] }");
    let axis = compile(&machine, "linuxcnc", &folder.path("axis"), &FEW).json();
    let point =
        compile(&machine, "linuxcnc", &folder.path("point"), &[&FEW[..], &["--fit", "functional-point"]].concat())
            .json();
    let left = [&axis, &point].map(|json| number(json, "/compensated/position_um/rms"));
    assert!(left[1] < 0.7 * left[0], "{left:?}");
    assert_eq!(names(&folder.path("point")).len(), names(&folder.path("axis")).len());
    Run::of(
        abbe()
            .args(["compile", machine.to_str().unwrap(), "--target", "linuxcnc", "--without", "plane", "--out"])
            .arg(folder.path("no")),
    )
    .says("--without");
}

/// Random machines: no file breaks a limit of its controller, as readers of the test's own count it. Compile itself
/// insists that its files read back.
#[test]
fn limits_hold_on_random_machines() {
    let mut random = Random::new(77);
    let conventions: Vec<_> = combinations().collect();
    let mut written = 0;
    for i in 0..7 {
        let target = ["sinumerik-cec", "pmac", "fanuc-pitch"][i % 3];
        let sample = Sample::random(&mut random, conventions[(5 * i) % conventions.len()], [1e-5, 1e-4][i / 3 % 2]);
        let folder = Folder::new();
        yaml::write(&sample, &folder);
        let out = folder.path("out");
        let run = compile(&folder.path("machine.yaml"), target, &out, &["--accept-unverified", "--poses", "10"]);
        if run.code != Some(0) {
            assert!(
                ["E0708", "E0709", "E0601", "E0602"].iter().any(|code| run.err.contains(code)),
                "{target}: {}",
                run.err
            );
            continue;
        }
        written += 1;
        let texts: Vec<String> =
            set_files(&out).iter().map(|name| std::fs::read_to_string(out.join(name)).unwrap()).collect();
        match target {
            "sinumerik-cec" => cec_limits(&texts),
            "pmac" => pmac_limits(&texts),
            _ => fanuc_limits(&texts),
        }
    }
    assert!(written >= 3, "{written}");
}

fn cec_limits(texts: &[String]) {
    let tables =
        cec::CorrectionTables::read(texts.iter().find(|text| text.starts_with("%_N_NC_CEC")).map_or("", |text| text))
            .unwrap();
    assert!(tables.0.len() <= 62);
    for table in tables.0.values() {
        assert!(table.values().len() <= 2000);
        assert!(table.times == 0 || (table.direction == 0.0 && tables.0[&(table.times - 1)].output == table.output));
        assert!(table.values().iter().all(|value| value.abs() < 5.0));
    }
    // Whatever is added of the factors, the sum is the same.
    for position in [[0.0; 9], [7.0; 9], [-31.0; 9]] {
        for output in 1..=9 {
            let sums = READINGS.map(|reading| tables.sum(output, &position, false, reading));
            assert!(sums.iter().all(|sum| (sum - sums[0]).abs() < 1e-12), "{sums:?}");
        }
    }
}

fn pmac_limits(texts: &[String]) {
    let text = texts.iter().find(|text| text.contains("I51=1")).unwrap();
    let mut owners: Vec<usize> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with(';')) {
        if let Some((owner, _)) = line.split_once(" DEFINE COMP ") {
            owners.push(owner[1..].parse().unwrap());
        } else if line.starts_with('I') {
            assert!(line.split_once('=').unwrap().1.parse::<u32>().unwrap() <= 8_388_607, "{line}");
        } else if !line.starts_with('#') {
            line.parse::<i64>().unwrap();
        }
    }
    // Defined from the highest motor down, each once.
    assert!(owners.windows(2).all(|pair| pair[1] < pair[0]) && owners.iter().all(|owner| (1..=32).contains(owner)));
}

fn fanuc_limits(texts: &[String]) {
    let mut points: Vec<usize> = Vec::new();
    for line in texts.iter().filter(|text| text.starts_with('%')).flat_map(|text| text.lines()) {
        if let Some((number, value)) = line.strip_prefix("N1").and_then(|rest| rest.split_once("Q0P")) {
            points.push(number.parse().unwrap());
            assert!(value.parse::<i32>().unwrap().abs() <= 127, "{line}");
        }
    }
    let count = points.len();
    points.sort_unstable();
    points.dedup();
    assert!(points.len() == count && points.iter().all(|point| *point < 1024), "a point is used twice");
}
