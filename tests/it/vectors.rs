//! Files written by hand from the manuals, and the corrections of the controller, worked out by hand: the vectors that
//! `targets`, `compile_linuxcnc`, `linuxcnc_constants` and the live tests do not have already. Every number below was
//! found with a pencil, not by the program.

use std::path::PathBuf;

use abbe::controller::{ControllerTarget, NAMES, Replay};
use abbe::machine::Approach;

use crate::loaded;
use crate::oracle::program::Folder;
use crate::replays;
use crate::support::compile;
use crate::support::controllers::Files;

/// Tests with a target's vectors: of the file's text, and of the corrections.
const VECTORS: [(&str, &str, &str); 28] = [
    ("linuxcnc", "compile_linuxcnc", "compile_linuxcnc, tests/live"),
    ("linuxcnc-kins", "linuxcnc_kins/mod", "tests/live"),
    ("linuxcnc-matrixkins", "linuxcnc_constants", "linuxcnc_constants"),
    ("linuxcnc-trt", "linuxcnc_constants", "linuxcnc_constants"),
    ("linuxcnc-maxkins", "kinematic_parameters", "kinematic_parameters"),
    ("linuxcnc-5axiskins", "kinematic_parameters", "kinematic_parameters"),
    ("sinumerik-traori", "kinematic_parameters", "kinematic_parameters"),
    ("sinumerik-chain", "kinematic_chain", "kinematic_chain"),
    ("sinumerik-tcarr", "kinematic_parameters", "kinematic_parameters"),
    ("heidenhain-kinematics", "kinematic_parameters", "kinematic_parameters"),
    ("fanuc-5axis", "kinematic_parameters", "kinematic_parameters"),
    ("haas-mrzp", "kinematic_parameters", "kinematic_parameters"),
    ("isg-volcomp", "targets", "vectors"),
    ("etalon-exchange", "targets", "vectors"),
    ("sinumerik-cec", "targets", "targets"),
    ("sinumerik-enc", "targets", "targets"),
    ("heidenhain-com", "targets", "vectors"),
    ("fanuc-pitch", "targets", "vectors"),
    ("fanuc-3d", "vectors", "vectors"),
    ("twincat-axis", "targets", "targets, vectors"),
    ("pmac", "targets", "targets"),
    ("kmotion-geo", "targets", "targets"),
    ("reprapfirmware", "targets", "vectors"),
    ("klipper", "targets", "vectors"),
    ("marlin", "targets", "vectors"),
    ("grbl", "scales", "scales"),
    ("grid-csv", "vectors", "vectors"),
    ("grid-json", "vectors", "vectors"),
];

/// The places above are real: the file is there and speaks of the target.
#[test]
fn every_target_has_a_vector_by_hand() {
    assert_eq!(
        VECTORS.map(|(target, ..)| target).iter().collect::<std::collections::BTreeSet<_>>(),
        NAMES.iter().collect()
    );
    for (target, text, added) in VECTORS {
        for place in [text, added].iter().flat_map(|list| list.split(", ")) {
            let path =
                if place.starts_with("tests/") { format!("{place}/main.rs") } else { format!("tests/it/{place}.rs") };
            let source = std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("{path}"));
            let stem = target.strip_prefix("linuxcnc-").unwrap_or(target);
            assert!(source.contains(stem), "{target} is not in {path}");
        }
    }
}

/// Checks the corrections of files at a place (X, Y, Z).
fn added(target: &str, files: &[(&str, &str)], place: [f64; 3], expected: [f64; 3]) {
    let folder = Folder::new();
    let machine = loaded::machine(&replays::machine(&folder, false));
    let loaded = ControllerTarget::builtin(target).unwrap();
    let files: Files = files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    let tables = replays::read(&loaded, &machine, &files)
        .unwrap_or_else(|diagnostics| panic!("{target}: {:?}", diagnostics.iter().collect::<Vec<_>>()));
    let found = Replay::new(&machine, &loaded, &tables).addition(&Approach::Forward.at_pose(&place));
    let near = found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12);
    assert!(near, "{target} at {place:?}: {found:?}, not {expected:?}");
}

/// A-79351E p. 3/13: eight corners weighted by fractions between 0 and 1. Z: 0.75 of 8 um, and 8 um more at one corner,
/// whose weight is 0.25 x 0.5 x 0.75.
#[test]
fn fanuc_lattice() {
    let list = "POINTS 2 2 2\nSTART 0.000 0.000 0.000\nINTERVAL 100.000 100.000 100.000\n0 0 0 0 0 0\n0 0 1 0 0 8\n0 1 0 0 4 0\n0 1 1 0 4 8\n\
                1 0 0 10 0 0\n1 0 1 10 0 8\n1 1 0 10 4 0\n1 1 1 10 4 16\n";
    let files = [("lattice.txt", list)];
    added("fanuc-3d", &files, [25.0, 50.0, 75.0], [0.0025, 0.002, 0.00675]);
    added("fanuc-3d", &files, [300.0, -50.0, 0.0], [0.010, 0.0, 0.0]);
    // 10809 multiplies the stored number.
    let thrice = list.replacen("0 0 0 0 0 0\n", "MAGNIFICATION 3\n0 0 0 0 0 0\n", 1);
    added("fanuc-3d", &[("lattice.txt", &thrice)], [25.0, 50.0, 75.0], [0.0075, 0.006, 0.02025]);
}

/// EXX from 300 to -300 um, beyond the numbers from -127 to 127: hundreds of three um.
#[test]
fn fanuc_lattice_magnified() {
    let folder = Folder::new();
    let errors = "EXX: { points: [[-200 mm, 300 um], [200 mm, -300 um]] }";
    let text = text_of(&folder, errors, "fanuc-3d", "lattice.txt");
    let has = |line: &str| assert!(text.lines().any(|l| l == line), "{line}: {text}");
    has("MAGNIFICATION 3");
    for (i, x) in [(0, -100), (1, -80), (4, -20), (5, 0), (10, 100)] {
        has(&format!("{i} 0 0 {x} 0 0"));
    }
    let small =
        text_of(&Folder::new(), "EXX: { points: [[-200 mm, 120 um], [200 mm, -120 um]] }", "fanuc-3d", "lattice.txt");
    assert!(small.lines().any(|line| line == "MAGNIFICATION 1") && small.lines().any(|line| line == "0 0 0 -120 0 0"));
}

/// EXX = 5 2 0 -3 -4 and EYX = 2 1 0 -1 -3 um at -200 .. 200: on 11 points from -200 in steps of 40, in whole um with the sign turned.
#[test]
fn fanuc_lattice_text() {
    let folder = Folder::new();
    let errors = "EXX: { points: [[-200 mm, 5 um], [-100 mm, 2 um], [0 mm, 0 um], [100 mm, -3 um], [200 mm, -4 um]] }\n  \
         EYX: { points: [[-200 mm, 2 um], [-100 mm, 1 um], [0 mm, 0 um], [100 mm, -1 um], [200 mm, -3 um]] }";
    let text = text_of(&folder, errors, "fanuc-3d", "lattice.txt");
    for line in ["POINTS 11 11 11", "START -200.000 0.000 0.000", "INTERVAL 40.000 10.000 10.000"] {
        assert!(text.lines().any(|l| l == line), "{line}");
    }
    // X = -200 -160 -80 0 120 200.
    let expected = [(0, -5, -2), (1, -4, -2), (3, -2, -1), (5, 0, 0), (8, 3, 1), (10, 4, 3)];
    for (i, x, y) in expected {
        for (j, k) in [(0, 0), (10, 3), (4, 10)] {
            let line = format!("{i} {j} {k} {x} {y} 0");
            assert!(text.lines().any(|l| l == line), "{line}");
        }
    }
}

/// The set's text for a machine of three axes, X from -200 to 200, Y and Z from 0 to 100, a node every 100 mm.
fn text_of(folder: &Folder, errors: &str, target: &str, file: &str) -> String {
    let machine: PathBuf = folder.write(
        "machine.yaml",
        &format!(
            "abbe: 1\nmachine: example\nchain: \"w b X Y Z t\"\naxes:\n  X: {{ controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }}\n  Y: {{ controller: 2, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  \
             Z: {{ controller: 3, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\nerrors:\n  {errors}\nvolume: {{ step: 100 mm }}\n"
        ),
    );
    compile(&machine, target, &folder.path(target), &["--accept-unverified", "--poses", "5"]).json();
    std::fs::read_to_string(folder.path(target).join(file)).unwrap()
}

/// docs/controls/lattice.md: between four nodes with the weights 3/8, 3/8, 1/8, 1/8: 0.0015 + 0.00125 + 0.00275.
#[test]
fn lattices_of_our_own() {
    let csv = "X [mm],Y [mm],dX [mm]\n0,0,0.0\n0,100,0.004\n100,0,0.010\n100,100,0.022\n";
    let json = r#"{"columns": ["X [mm]", "Y [mm]", "dX [mm]"], "rows": [[0, 0, 0.0], [0, 100, 0.004], [100, 0, 0.010], [100, 100, 0.022]]}"#;
    for (target, file, text) in [("grid-csv", "corrections.csv", csv), ("grid-json", "corrections.json", json)] {
        added(target, &[(file, text)], [25.0, 50.0, 7.0], [0.0055, 0.0, 0.0]);
        added(target, &[(file, text)], [-10.0, 400.0, 7.0], [0.004, 0.0, 0.0]);
    }
    // Straightness of 2 um at -200, 1 um at -100: its negative, in a row for each node.
    let folder = Folder::new();
    let errors = "EYX: { points: [[-200 mm, 2 um], [-100 mm, 1 um], [0 mm, 0 um], [100 mm, -1 um], [200 mm, -3 um]] }";
    let rows = [(-200, -20), (-100, -10), (0, 0), (100, 10), (200, 30)];
    let lines = rows.map(|(x, tenths)| {
        let sign = if tenths < 0 { "-" } else { "" };
        format!("{x}.000000,100.000000,0.000000,0.0000000,{sign}0.00{:02}000,0.0000000", i32::abs(tenths))
    });
    let csv = text_of(&folder, errors, "grid-csv", "corrections.csv");
    assert!(lines.iter().all(|line| csv.lines().any(|l| l == line)), "{csv}");
    let json = text_of(&folder, errors, "grid-json", "corrections.json");
    assert!(lines.iter().all(|line| json.contains(&format!("[{line}]"))), "{json}");
}

/// A-77810E, B-63980EN p. 100: P[n] = A(x_n) - A(x_(n-1)), A = 0 at the reference point 40: -5 -2 0 3 4 um at -200 .. 200.
#[test]
fn fanuc_increments_are_summed_up() {
    let text = "%\nN03620Q1A1P40\nN03621Q1A1P39\nN03622Q1A1P42\nN03623Q1A1P1\nN03624Q1A1M100.0\nN10039Q0P3\nN10040Q0P2\nN10041Q0P3\nN10042Q0P1\n%\n";
    let files = [("PITCH_X.TXT", text)];
    for (x, um) in [
        (-200.0, -5.0),
        (-150.0, -3.5),
        (-100.0, -2.0),
        (0.0, 0.0),
        (50.0, 1.5),
        (200.0, 4.0),
        (300.0, 4.0),
        (-400.0, -5.0),
    ] {
        added("fanuc-pitch", &files, [x, 0.0, 0.0], [um / 1000.0, 0.0, 0.0]);
    }
    // The magnification multiplies the sum.
    let twice = text.replace("N03623Q1A1P1", "N03623Q1A1P2");
    added("fanuc-pitch", &[("PITCH_X.TXT", &twice)], [50.0, 0.0, 0.0], [0.003, 0.0, 0.0]);
}

/// Beckhoff 308704779, 308713099, the values of its examples. Cross: half way from -45 to -130. Plane, [master 2][master 1]: at
/// half the first cell 6 and -1, at a quarter of the second 4.25; beyond the margin 12 and 5, so 10.25; units of 0.1 um.
#[test]
fn twincat_cross_and_plane() {
    let cross = "kopf.achs_nr 3\nkw.crosscomp.unit 1\nkw.crosscomp.last_index 2\nkw.crosscomp.master_ax_nr 2\nkw.crosscomp.n_cycles 10\n\
         kw.crosscomp.table[0].setpoint -2500000\nkw.crosscomp.table[0].correction 0\nkw.crosscomp.table[1].setpoint 0\n\
         kw.crosscomp.table[1].correction -45\nkw.crosscomp.table[2].setpoint 2500000\nkw.crosscomp.table[2].correction -130\n";
    added("twincat-axis", &[("achskw_Z.lis", cross)], [0.0, 125.0, 0.0], [0.0, 0.0, -0.00875]);
    added("twincat-axis", &[("achskw_Z.lis", cross)], [0.0, 999.0, 0.0], [0.0, 0.0, -0.013]);
    let plane = "kopf.achs_nr 1\nkw.crosscomp2.unit 1\nkw.crosscomp2.interval 1000000\nkw.crosscomp2.master1_ax_nr 2\nkw.crosscomp2.master2_ax_nr 3\n\
         kw.crosscomp2.start_position_master1 -1000000\nkw.crosscomp2.start_position_master2 0\nkw.crosscomp2.last_index_master1 1\n\
         kw.crosscomp2.last_index_master2 1\nkw.crosscomp2.n_cycles 10\nkw.crosscomp2.table[0][0].correction 0\nkw.crosscomp2.table[0][1].correction 12\n\
         kw.crosscomp2.table[1][0].correction -7\nkw.crosscomp2.table[1][1].correction 5\n";
    added("twincat-axis", &[("achskw_X.lis", plane)], [0.0, -50.0, 25.0], [0.000_425, 0.0, 0.0]);
    added("twincat-axis", &[("achskw_X.lis", plane)], [0.0, 60.0, 25.0], [0.001_025, 0.0, 0.0]);
}

/// skew_correction.py, planner.h skew() and Move.cpp AxisTransform at X = 10, Y = 100, Z = 50. X: -0.035 + 0.006, and for the first two
/// 50 x 350e-6 x 80e-6 more; Y: -0.004.
#[test]
fn three_firmwares() {
    let place = [10.0, 100.0, 50.0];
    let klipper =
        "[skew_correction]\n\n[skew_correction machine]\nxy_skew = 0.000350\nxz_skew = -0.000120\nyz_skew = 0.000080\n";
    added("klipper", &[("skew_correction.cfg", klipper)], place, [-0.028_998_6, -0.004, 0.0]);
    let marlin = "G21\nM852 I0.000350\nM852 J-0.000120\nM852 K0.000080\nM500\n";
    added("marlin", &[("skew.gcode", marlin)], place, [-0.028_998_6, -0.004, 0.0]);
    let position_jacobian = "M556 S1000 X-0.350\nM556 S1000 Y-0.080\nM556 S1000 Z0.120\n";
    let duet = [("axis_compensation.g", position_jacobian)];
    added("reprapfirmware", &duet, place, [-0.029, -0.004, 0.0]);
    // Grid.cpp, a row for each Y: at X = 25 the heights 0.0025 and 0.008, half way 0.00525; outside the corner's 0.020.
    let map = "RepRapFirmware height map file v2 generated by hand\naxis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\n\
         X,Y,0.00,100.00,0.00,100.00,-1.00,100.00,100.00,2,2\n0.000,0.010\n0.004,0.020\n";
    let flat = "M556 S1000 X0\nM556 S1000 Y0\nM556 S1000 Z0\n";
    let duet = [("axis_compensation.g", flat), ("heightmap.csv", map)];
    added("reprapfirmware", &duet, [25.0, 50.0, 0.0], [0.0, 0.0, 0.005_25]);
    added("reprapfirmware", &duet, [500.0, 500.0, 0.0], [0.0, 0.0, 0.020]);
}

/// Values read as the error: turned, straight between points, held outside (none of it documented).
#[test]
fn heidenhain_table() {
    let table = "BEGIN X_AXIS .COM MM\nNR AXISPOS X Y\n0 -200.0000 0.00500 0.00200\n1 0.0000 0.00000 0.00000\n2 200.0000 -0.00400 -0.00300\n[END]\n";
    let files = [("X_AXIS.COM", table)];
    added("heidenhain-com", &files, [100.0, 0.0, 0.0], [0.002, 0.0015, 0.0]);
    added("heidenhain-com", &files, [-500.0, 0.0, 0.0], [-0.005, -0.002, 0.0]);
}

/// TF5280: at X = 100 the curves are EXX = -1 um, EYX = -0.25 um, ECX = -5 urad. The tool is 100 mm from the carriage's
/// reference point in Y (gauge point 60, Y = 40), none in X: ECX moves it by +0.5 um in X. EC0Y = 40 urad moves it by
/// -1.6 um in X at Y = 40. Together -2.1 and -0.25 um, which the axes take back.
#[test]
fn volumetric_curves() {
    let isg = "C0Y\n0.000040\n#\nX EXX EYX ECX\n-200 0.005 0.002 0.000010\n200 -0.003 -0.001 -0.000010\n#\nN0X N0Y N0Z\n0 0 -1\n";
    let etalon = "[C0Y]\nVALUE = 0.000040\n[EXX]\nGridpoints = {\n-200 0.005\n200 -0.003\n}\n[EYX]\nGridpoints = {\n-200 0.002\n200 -0.001\n}\n\
         [ECX]\nGridpoints = {\n-200 0.000010\n200 -0.000010\n}\n";
    for (target, file, text) in [("isg-volcomp", "volcomp.csv", isg), ("etalon-exchange", "etalon.txt", etalon)] {
        added(target, &[(file, text)], [100.0, 40.0, 20.0], [0.0021, 0.00025, 0.0]);
    }
}
