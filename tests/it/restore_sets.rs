//! Restore sets: what was in force comes back, by the reader of the program and by readers of the tests' own.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::kinematic_parameters::{Control, OF_HEADS, OF_TABLES, head_head, head_table, numbers, table_table};
use crate::oracle::curves::Travel;
use crate::oracle::machines::Pose;
use crate::oracle::matrix::{minus, norm};
use crate::oracle::program::Folder;
use crate::support::config::sample;
use crate::support::left;
use crate::support::{Run, abbe, compile, config, number, tree, verify};

const FEW: [&str; 3] = ["--poses", "40", "--accept-unverified"];

/// A machine of three axes with errors of positions, one of them by its direction.
fn machine(folder: &Folder, name: &str, errors: &str) -> PathBuf {
    folder.write(
        name,
        &format!(
            "abbe: 1\nmachine: restored\nchain: \"w Y' b X Z t\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 400 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ controller: 2, travel: [0 mm, 300 mm], origin: [0, 0, 0] }}\n  Z: {{ controller: 3, travel: [-200 mm, 0 mm], origin: [0, 0, 0] }}\n\
             tool: {{ length: 100 mm }}\nerrors:\n{errors}volume: {{ step: 50 mm }}\n"
        ),
    )
}

const FIRST: &str = "  EXX: { points: [[0 mm, 0 um], [200 mm, 11 um], [400 mm, -6 um]] }\n  EC0Y: 41 urad\n";

/// Another error of the same axis, and tables that were not there before.
const SECOND: &str = "  EXX: { forward: { points: [[0 mm, 0 um], [400 mm, 9 um]] }, reverse: { points: [[0 mm, 3 um], [400 mm, 14 um]] } }\n  \
                      EYY: { points: [[0 mm, 0 um], [300 mm, 17 um]] }\n  EZX: { points: [[0 mm, 0 um], [150 mm, 7 um], [400 mm, 2 um]] }\n  \
                      EC0Y: -12 urad\n  EBX: { points: [[0 mm, 0 urad], [400 mm, 60 urad]] }\n";

/// Largest difference of two sets on a machine, um.
fn difference(machine: &Path, one: &Path, other: &Path) -> f64 {
    let mut diff = abbe();
    diff.arg("diff").arg(machine).args([one, other]).args(["--format", "json", "--poses", "60"]);
    number(&Run::of(&mut diff).json(), "/position_um/max")
}

/// Numbers of the sag tables that a file fills.
fn tables_of(file: &Path) -> BTreeSet<usize> {
    let text = std::fs::read_to_string(file).unwrap();
    let number = |rest: &str| rest.split([',', ']']).next().unwrap().parse().unwrap();
    text.split("$AN_CEC_STEP[").skip(1).map(number).collect()
}

/// With a set that is off the machine is as without one.
pub fn off_is_bare(off: &serde_json::Value, of: &str) {
    for figure in ["p95", "max"] {
        let [bare, left] =
            ["uncompensated", "compensated"].map(|state| number(off, &format!("/{state}/position_um/{figure}")));
        assert!((bare - left).abs() <= 1e-6 * bare.max(1.0), "{of}: {bare} um without, {left} um with what is off");
    }
}

#[test]
fn tables_in_force_come_back() {
    let folder = Folder::new();
    let [first, second] = [("first.yaml", FIRST), ("second.yaml", SECOND)].map(|(name, e)| machine(&folder, name, e));
    let targets = [
        "linuxcnc",
        "sinumerik-cec",
        "sinumerik-enc",
        "isg-volcomp",
        "heidenhain-com",
        "grid-csv",
        "pmac",
        "twincat-axis",
        "fanuc-pitch",
        "etalon-exchange",
    ];
    for target in targets {
        let [old, new] = ["old", "new"].map(|name| folder.path(&format!("{target}-{name}")));
        let _ = compile(&first, target, &old, &FEW).json();
        let over = [&FEW[..], &["--installed", old.to_str().unwrap()]].concat();
        let _ = compile(&second, target, &new, &over).json();
        let restore = new.join("restore");
        assert!(difference(&second, &new, &old) > 2.0, "{target}: nothing to take back");
        let left = difference(&second, &restore, &old);
        assert!(left < 1e-6, "{target}: {left} um");
        if target == "sinumerik-cec" {
            let [set, back] = [&new, &restore].map(|out| tables_of(&out.join("_N_NC_CEC_INI")));
            assert!(set.is_subset(&back) && set.len() > 3, "{set:?} {back:?}");
        }
    }
}

#[test]
fn without_files_in_force_the_set_is_switched_off() {
    let folder = Folder::new();
    let path = machine(&folder, "second.yaml", SECOND);
    let out = folder.path("out");
    let text = Run::of(abbe().arg("compile").arg(&path).args(["--target", "linuxcnc", "--out"]).arg(&out)).out;
    assert!(text.contains("/restore, the same files without corrections\n"), "{text}");
    for joint in ["joint_0_X.comp", "joint_1_Y.comp", "joint_2_Z.comp"] {
        let points = |out: &Path| std::fs::read_to_string(out.join(joint)).unwrap();
        let fields = |line: &str| line.split(' ').skip(1).map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
        assert!(points(&out.join("restore")).lines().flat_map(fields).all(|c| c == 0.0), "{joint}");
        assert!(joint.contains('Z') || points(&out).lines().flat_map(fields).any(|c| c != 0.0), "{joint}");
    }
    // The next set has a restore set of its own, and nothing of the one before stays.
    let fresh = folder.path("fresh");
    let other = machine(&folder, "first.yaml", FIRST);
    let _ = compile(&other, "linuxcnc", &out, &FEW).json();
    let _ = compile(&other, "linuxcnc", &fresh, &FEW).json();
    let within = |out: &Path| -> Vec<_> {
        let all = tree(out).into_iter();
        all.map(|(path, entry)| (path.strip_prefix(out).unwrap().to_owned(), entry)).collect()
    };
    assert_eq!(within(&out), within(&fresh));
    let _ = compile(&other, "grid-csv", &out, &[&FEW[..], &["--replace"]].concat()).json();
    assert!(!out.join("restore/joint_0_X.comp").exists() && out.join("restore/corrections.csv").exists());
}

/// Names and numbers of the lines of swivel data and of their remarks `was`.
fn with_remarks(file: &Path) -> Vec<(String, String, String)> {
    let text = std::fs::read_to_string(file).unwrap();
    let of = |line: &str| {
        let (name, rest) = line.split_once('=')?;
        let (value, was) = rest.split_once(" ; was ")?;
        Some((name.to_owned(), value.to_owned(), was.to_owned()))
    };
    text.lines().filter_map(of).collect()
}

#[test]
fn parameters_go_back_to_the_numbers_before() {
    let folder = Folder::new();
    let path = folder.write("first.yaml", &table_table(OF_TABLES));
    let [first, second] = ["first", "second"].map(|name| folder.path(name));
    let _ = compile(&path, "sinumerik-traori", &first, &FEW).json();
    let [set, back] = [&first, &first.join("restore")].map(|out| with_remarks(&out.join("TRAORI.INI")));
    assert_eq!(set.len(), 18);
    for (line, back) in set.iter().zip(&back) {
        assert_eq!((&line.0, &line.2, &line.1), (&back.0, &back.1, &back.2));
    }
    assert!(set.iter().any(|line| line.1 != line.2));
    let off = verify(&path, &first.join("restore"), &["--poses", "40"]).json();
    off_is_bare(&off, "traori");

    let left = folder.write("left.yaml", &table_table("  EX0C: 7 um\n  EA0C: -10 urad\n  EZ0A: 4 um\n"));
    let over = [&FEW[..], &["--installed", first.to_str().unwrap()]].concat();
    let _ = compile(&left, "sinumerik-traori", &second, &over).json();
    let [old, back] = [&first, &second.join("restore")].map(|out| numbers(&out.join("TRAORI.INI")));
    assert_eq!(old, back);
    assert_ne!(old, numbers(&second.join("TRAORI.INI")));
}

#[test]
fn a_composed_set_goes_back_as_one() {
    let folder = Folder::new();
    let path = folder.write(
        "m.yaml",
        &table_table(&format!("{OF_TABLES}  EXX: {{ points: [[0 mm, 0 um], [500 mm, 19 um]] }}\n"))
            .replace("  X: { ", "  X: { origin: [0, 0, 0], "),
    );
    let compile = |name: &str, more: &[&str]| {
        let mut run = abbe();
        run.arg("compile").arg(&path).args(["--target", "sinumerik-traori+sinumerik-enc", "--format", "json", "--out"]);
        Run::of(run.arg(folder.path(name)).args(FEW).args(more)).json()
    };
    let _ = compile("first", &[]);
    let [first, second] = ["first", "second"].map(|name| folder.path(name));
    let off = verify(&path, &first.join("restore"), &["--poses", "40"]).json();
    off_is_bare(&off, "composed");
    let _ = compile("second", &["--installed", first.to_str().unwrap()]);
    assert!(difference(&path, &second.join("restore"), &first) < 1e-6);
}

/// Modules: the model of the machine without errors, and zeros in the tables beside it.
#[test]
fn modules_go_back_to_the_nominal_machine() {
    let folder = Folder::new();
    for (name, target) in [("vmc-cframe-754.yaml", "linuxcnc-matrixkins"), ("trunnion.yaml", "linuxcnc-kins")] {
        let out = folder.path(target);
        let _ = compile(&config(name), target, &out, &FEW).json();
        let off = verify(&config(name), &out.join("restore"), &["--poses", "40"]).json();
        off_is_bare(&off, target);
    }
}

/// The centre of a ball before and after a turn, by the manual's transformation and the rigid body of the tests: with the
/// numbers of the restore set, and with those of the set.
#[test]
fn a_ball_is_found_where_the_certificate_says() {
    for (kind, text) in [
        ("table-table", table_table(OF_TABLES)),
        ("head-head", head_head(OF_HEADS)),
        ("head-table", head_table(OF_HEADS)),
    ] {
        let folder = Folder::new();
        let path = folder.write("m.yaml", &text);
        let out = folder.path("out");
        let json = compile(&path, "sinumerik-traori", &out, &FEW).json();
        let sample = sample(&path);
        let pose = |at: &serde_json::Value| -> Pose {
            sample.rigid.walk.iter().map(|axis| at[axis.name.as_str()].as_f64().unwrap()).collect()
        };
        let [set, back] =
            [&out, &out.join("restore")].map(|out| Control::traori(kind, &numbers(&out.join("TRAORI.INI"))));
        let checks = json["ball_checks"].as_array().unwrap();
        assert_eq!(checks.len(), 2, "{kind}: {json}");
        for check in checks {
            let [first, second] = ["first", "second"].map(|key| pose(&check[key]));
            let [one, other] = [&first, &second].map(|pose| left::ideal(&sample, pose));
            assert!(norm(minus(one, other)) < 1e-9, "{kind}: the ball moves on the part");
            let turned: Vec<&str> = (0..first.len())
                .filter(|i| sample.rigid.walk[*i].rotary && first[*i] != second[*i])
                .map(|i| sample.rigid.walk[i].name.as_str())
                .collect();
            assert_eq!(turned, [check["turned"].as_str().unwrap()]);
            for (control, key) in [(&back, "before_um"), (&set, "with_um")] {
                // A tip that is displaced by d finds the centre at -d.
                let found = |pose: &Pose| {
                    let command = control.inverse(&sample, pose, left::ideal(&sample, pose));
                    left::position(&sample, pose, &command, Travel::Mean)
                };
                let moved = minus(found(&first), found(&second)).map(|c| 1e3 * c);
                let stated: Vec<f64> = check[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
                assert!((0..3).all(|k| (moved[k] - stated[k]).abs() < 0.02), "{kind} {check}: {key} {moved:?}");
            }
            let size = |key: &str| {
                check[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap().abs()).fold(0.0, f64::max)
            };
            assert!(size("before_um") > 10.0 && size("with_um") < 1.0, "{kind}: {check}");
        }
        assert_eq!(verify(&path, &out, &["--poses", "40"]).json()["ball_checks"], json["ball_checks"]);
    }
}

/// What `verify` says of the set that takes a set back.
fn said_of_restore(machine: &Path, out: &Path) -> Option<String> {
    let run = Run::of(abbe().arg("verify").arg(machine).arg(out).args(["--poses", "5", "--format", "json"]));
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.err.split("warning[W0720]: ").nth(1).map(|rest| rest.lines().next().unwrap().to_owned())
}

/// A restore set that is missing, edited, or another set's is named, and one as it was written is not.
#[test]
fn verify_holds_the_restore_set_against_its_set() {
    let folder = Folder::new();
    let [first, second] = [("first.yaml", FIRST), ("second.yaml", SECOND)].map(|(name, e)| machine(&folder, name, e));
    let [one, other] = [(&first, "one"), (&second, "other")].map(|(machine, name)| {
        let out = folder.path(name);
        let _ = compile(machine, "linuxcnc", &out, &FEW).json();
        out
    });
    let restore = one.join("restore");
    assert_eq!(said_of_restore(&first, &one), None);
    assert_eq!(said_of_restore(&first, &restore), None);
    let table = restore.join("joint_0_X.comp");
    let whole = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, whole.replacen('0', "1", 1)).unwrap();
    assert!(said_of_restore(&first, &one).unwrap().contains("`joint_0_X.comp` is missing or was edited"));
    std::fs::remove_file(&table).unwrap();
    assert!(said_of_restore(&first, &one).unwrap().contains("`joint_0_X.comp` is missing or was edited"));
    std::fs::remove_dir_all(&restore).unwrap();
    assert!(said_of_restore(&first, &one).unwrap().contains("restore` is missing"));
    std::fs::rename(other.join("restore"), &restore).unwrap();
    assert!(said_of_restore(&first, &one).unwrap().contains("takes another set back: its manifest has other inputs"));
}

/// Sets of two targets have theirs below, and the parts have none.
#[test]
fn verify_holds_the_restore_set_of_two_targets_against_them() {
    let folder = Folder::new();
    let (path, out) = (config("trunnion.yaml"), folder.path("both"));
    let both = "heidenhain-kinematics+heidenhain-com";
    let _ = compile(&path, both, &out, &[&FEW[..], &["--nothing-else"]].concat()).json();
    for folder in [out.clone(), out.join("restore"), out.join("heidenhain-kinematics")] {
        assert_eq!(said_of_restore(&path, &folder), None, "{}", folder.display());
    }
    std::fs::remove_file(out.join("restore/heidenhain-kinematics/kinematics.txt")).unwrap();
    assert!(said_of_restore(&path, &out).unwrap().contains("`kinematics.txt` is missing"));
}

/// Preset rows count from the table's centre to the datum, so they change against the centre: by the numbers of the
/// list itself, added by the test, and back by the restore list.
#[test]
fn presets_go_against_the_centre_of_the_table_and_back() {
    let folder = Folder::new();
    let numbers = |list: &Path| -> ([f64; 3], [f64; 3]) {
        let text = std::fs::read_to_string(list.join("kinematics.txt")).unwrap();
        let (mut moved, mut presets) = ([0.0; 3], [f64::NAN; 3]);
        for line in text.lines() {
            if let Some((name, rest)) = line.strip_prefix("Trans.").and_then(|rest| rest.split_once(" = ")) {
                let (value, was) = rest.split_once(" ; was ").unwrap();
                let k = "XYZ".find(name.chars().last().unwrap()).unwrap();
                moved[k] += value.parse::<f64>().unwrap() - was.parse::<f64>().unwrap();
            }
            let words: Vec<&str> = line.trim_start_matches(';').split_whitespace().collect();
            if let ([letter @ ("X" | "Y" | "Z"), by], true) = (&words[..], line.starts_with(';')) {
                presets["XYZ".find(letter).unwrap()] = by.parse().unwrap();
            }
        }
        (moved, presets)
    };
    let path = config("trunnion.yaml");
    let [old, new] = ["old", "new"].map(|name| folder.path(name));
    let _ = compile(&path, "heidenhain-kinematics", &old, &[&FEW[..], &["--nothing-else"]].concat()).json();
    // On top of these numbers once more.
    let over = [&FEW[..], &["--nothing-else", "--installed", old.to_str().unwrap()]].concat();
    let _ = compile(&path, "heidenhain-kinematics", &new, &over).json();
    for set in [&old, &new] {
        let (moved, presets) = numbers(set);
        let (back, presets_back) = numbers(&set.join("restore"));
        assert!(moved.iter().any(|by| by.abs() > 1e-3), "{moved:?}");
        for k in 0..3 {
            assert!((presets[k] + moved[k]).abs() < 1e-9, "{presets:?} {moved:?}");
            assert!((back[k] + moved[k]).abs() < 1e-9 && (presets_back[k] - moved[k]).abs() < 1e-9, "{back:?}");
        }
    }
}
