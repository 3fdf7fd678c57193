//! Which table acts on which axis is read: tables that are exchanged act exchanged, those that nothing puts in force act
//! on nothing, which is said, and what the controller would not start with is refused. Expected corrections are those of
//! the tables' own lines.

use std::path::{Path, PathBuf};

use abbe::controller::{ControllerTarget, ReadBack, Replay};
use abbe::diagnostic::Diagnostics;
use abbe::machine::Approach;

use crate::oracle::program::Folder;
use crate::support::{Run, compile, verify};
use crate::{loaded, replays};

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "20"];

/// A set without its manifest.
struct Set {
    folder: Folder,
    machine: PathBuf,
    target: &'static str,
}

impl Set {
    fn of(target: &'static str) -> Self {
        let folder = Folder::new();
        let machine = replays::machine(&folder, false);
        compile(&machine, target, &folder.path("out"), &FEW).json();
        std::fs::remove_file(folder.path("out/abbe.lock.json")).unwrap();
        Self { folder, machine, target }
    }

    fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.folder.path("out").join(file)).unwrap()
    }

    /// Verifies the set with some of a file's text exchanged.
    fn with(&self, file: &str, changes: &[(&str, &str)]) -> Run {
        let sound = self.text(file);
        let changed = changes.iter().fold(sound.clone(), |text, (from, to)| {
            assert!(text.contains(from), "{file} has no {from}:\n{text}");
            text.replacen(from, to, 1)
        });
        std::fs::write(self.folder.path("out").join(file), changed).unwrap();
        let run = verify(&self.machine, &self.folder.path("out"), &["--poses", "20"]);
        std::fs::write(self.folder.path("out").join(file), sound).unwrap();
        run
    }

    /// What the controller adds at a pose, with a text in place of that of a file.
    fn added(&self, file: &str, text: &str, pose: &[f64]) -> Vec<f64> {
        let machine = loaded::machine(&self.machine);
        let target = ControllerTarget::builtin(self.target).unwrap();
        let mut files = replays::files(&self.folder.path("out"));
        files.insert(file.to_owned(), text.to_owned());
        let files: Vec<ReadBack> = files.into_iter().map(|(name, text)| ReadBack::new(name, text)).collect();
        let tables = target.read(&machine, &files, &mut Diagnostics::default()).unwrap();
        Replay::new(&machine, &target, &tables).addition(&Approach::Forward.at_pose(pose))
    }
}

/// The value in a column of a table's lines, by straight lines between positions and held outside.
fn value(text: &str, position: usize, column: usize, at: f64) -> f64 {
    let cells = |line: &str| line.split_whitespace().map(|cell| cell.parse().ok()).collect::<Option<Vec<f64>>>();
    let rows: Vec<Vec<f64>> = text.lines().filter_map(cells).filter(|row| row.len() > column).collect();
    let after = rows.iter().position(|row| row[position] >= at).unwrap_or(rows.len() - 1);
    let (a, b) = (&rows[after.saturating_sub(1)], &rows[after]);
    if at <= a[position] {
        return a[column];
    }
    let way = ((at - a[position]) / (b[position] - a[position])).clamp(0.0, 1.0);
    a[column] + way * (b[column] - a[column])
}

fn column(text: &str, name: &str) -> usize {
    let names = text.lines().find(|line| line.starts_with("NR ")).unwrap();
    names.split_whitespace().position(|word| word == name).unwrap()
}

/// The deviation is as large as without tables.
fn corrects_nothing(run: &Run) {
    let json = run.json();
    assert_eq!(json["compensated"], json["uncompensated"]);
    let warnings = json["warnings"].to_string();
    assert!(warnings.contains("W0714"), "{warnings}");
}

#[test]
fn heidenhain_rows_and_columns_are_obeyed() {
    let set = Set::of("heidenhain-com");
    let sound = set.with("CONFIG.CMA", &[]).json();
    let text = set.text("CONFIG.CMA");
    let (x, y) = (set.text("X_AXIS.COM"), set.text("Y_AXIS.COM"));
    let pose = [70.0, 30.0, 10.0];
    // [column of the COM file] = F([column of the CMA file]), stored errors.
    let exchanged = text.replace("X_AXIS", "Q_AXIS").replace("Y_AXIS", "X_AXIS").replace("Q_AXIS", "Y_AXIS");
    let z = set.text("Z_AXIS.COM");
    let sum = |x_at: f64, y_at: f64, axis: &str| {
        let one = |text: &str, at: f64| {
            text.contains(&format!(" {axis}")).then(|| value(text, column(text, "AXISPOS"), column(text, axis), at))
        };
        -[one(&x, x_at), one(&y, y_at), one(&z, 10.0)].into_iter().flatten().sum::<f64>()
    };
    for (file, x_at, y_at) in [(&text, 70.0, 30.0), (&exchanged, 30.0, 70.0)] {
        let added = set.added("CONFIG.CMA", file, &pose);
        for (i, axis) in ["X", "Y"].iter().enumerate() {
            assert!((added[i] - sum(x_at, y_at, axis)).abs() < 1e-12, "{axis}: {added:?} {}", sum(x_at, y_at, axis));
        }
    }
    corrects_nothing(&set.with("CONFIG.CMA", &[("0 *", "0 -")]));
    corrects_nothing(&set.with("CONFIG.CMA", &[("0 *", "0  ")]));
    let one = set.with("CONFIG.CMA", &[("X_AXIS.COM", "-")]);
    one.says("W0714").says("`X_AXIS.COM` is not in force");
    assert_ne!(one.json()["compensated"], sound["compensated"]);
    set.with("CONFIG.CMA", &[("X_AXIS.COM", "OTHER.COM")]).refused("E0705").says("`OTHER.COM` is missing");
    set.with("CONFIG.CMA", &[("[END]", "1 * - - -\n[END]")]).refused("E0704").says("a second row is in force");
    set.with("CONFIG.CMA", &[(" X ", " Q ")]).refused("E0704").says("no axis `Q`");
    // Without the file nothing says what is in force.
    std::fs::remove_file(set.folder.path("out/CONFIG.CMA")).unwrap();
    let alone = verify(&set.machine, &set.folder.path("out"), &["--poses", "20"]);
    alone.says("W0715").says("`CONFIG.CMA` is not there");
    assert_eq!(alone.json()["compensated"], sound["compensated"]);
}

#[test]
fn linuxcnc_joints_are_those_of_the_ini() {
    let set = Set::of("linuxcnc");
    let inc = "compensation.inc";
    let text = set.text(inc);
    let tables = ["joint_0_X.comp", "joint_1_Y.comp", "joint_2_Z.comp"].map(|file| set.text(file));
    let pose = [70.0, 30.0, 10.0];
    let near = |text: &str, expected: [f64; 3]| {
        let added = set.added(inc, text, &pose);
        assert!(added.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{added:?} {expected:?}");
    };
    let at = |table: usize, q: f64| value(&tables[table], 0, 1, q);
    near(&text, [at(0, 70.0), at(1, 30.0), at(2, 10.0)]);
    let swap = |text: &str, a: &str, b: &str| text.replace(a, "?").replace(b, a).replace('?', b);
    near(&swap(&text, "joint_0_X.comp", "joint_1_Y.comp"), [at(1, 70.0), at(0, 30.0), at(2, 10.0)]);
    // Joint 0 is Y.
    let kinds = text.replace("coordinates=XYZ", "coordinates=YXZ");
    near(&kinds, [at(1, 70.0), at(0, 30.0), at(2, 10.0)]);
    for comment in ["# COMP_FILE = joint_0", "; COMP_FILE = joint_0", "COMP_FILES = joint_0"] {
        let commented = text.replace("COMP_FILE = joint_0", comment);
        near(&commented, [0.0, at(1, 30.0), at(2, 10.0)]);
    }
    // The second section of a name is not read.
    near(&format!("[JOINT_0]\nTYPE = LINEAR\n{text}"), [0.0, at(1, 30.0), at(2, 10.0)]);
    let inches = text.replace("[TRAJ]\n", "[TRAJ]\nLINEAR_UNITS = inch\n");
    near(&inches, [0, 1, 2].map(|i| 25.4 * at(i, pose[i] / 25.4)));
    set.with(inc, &[("COMP_FILE = joint_0", "#COMP_FILE = joint_0")]).says("W0714").says("`joint_0_X.comp`");
    for (from, to, code, words) in [
        ("[JOINT_2]", "[JOINT_7]", "E0704", "no axis for joint 7"),
        ("COMP_FILE = joint_0_X", "COMP_FILE = joint_9_X", "E0705", "`joint_9_X.comp` is missing"),
        ("JOINTS = 3", "JOINTS = 2", "E0704", "2 joints"),
        ("TYPE = LINEAR", "TYPE = ANGULAR", "E0704", "the axis of this joint is LINEAR"),
        ("KINEMATICS = trivkins", "KINEMATICS = ownkins", "E0704", "`ownkins` is not known"),
        ("[TRAJ]\n", "[TRAJ]\nLINEAR_UNITS = cubits\n", "E0704", "`cubits` is no unit"),
        ("coordinates=XYZ", "coordinates=XXZ", "E0704", "two joints of one axis"),
    ] {
        set.with(inc, &[(from, to)]).refused(code).says(words);
    }
    // The machine's own INI beside ours.
    std::fs::write(set.folder.path("out/mill.ini"), swap(&text, "joint_0_X.comp", "joint_1_Y.comp")).unwrap();
    let both = verify(&set.machine, &set.folder.path("out"), &["--poses", "20"]);
    both.refused("E0732").says("put different tables in force");
}

#[test]
fn the_list_of_a_volumetric_compensation_is_that_of_the_machine() {
    let set = Set::of("isg-volcomp");
    let list = "volcomp0.lis";
    let sound = set.with(list, &[]).json();
    for (from, to, words) in [
        ("x 1\ny 2", "x 2\ny 1", "this machine has `x 1` here"),
        ("chain XYZ", "chain YXZ", "this machine has `chain XYZ` here"),
        ("workpiece_axes 0", "workpiece_axes 1", "this machine has `workpiece_axes 0` here"),
        ("interpolation GRID", "interpolation SCATTER", "`interpolation GRID`"),
        ("enable_splicing 1", "switch_off 1", "is not known here"),
    ] {
        set.with(list, &[(from, to)]).refused("E0704").says(words);
    }
    set.with(list, &[("file[0] volcomp.csv", "file[0] other.csv")]).refused("E0705").says("`other.csv` is missing");
    set.with("hochlauf_part.lis", &[("max_records 10000", "max_records 3")]).refused("E0704").says("room for 3");
    // In other words, and with a path.
    let other = set.with(list, &[("file[0] volcomp.csv", "FILE"), ("chain XYZ", "Chain  XYZ")]);
    other.refused("E0704");
    let other = [("file[0] volcomp.csv", "file[0] C:\\vc\\volcomp.csv (main table)"), ("chain XYZ", "Chain  XYZ")];
    assert_eq!(set.with(list, &other).json()["compensated"], sound["compensated"]);
    let pose = [70.0, 30.0, 10.0];
    let text = set.text(list);
    let plain = set.added(list, &text, &pose);
    let turned = set.added(list, &format!("{text}negate XZ\n"), &pose);
    let stopped = set.added(list, &format!("{text}set_to_zero Y\n"), &pose);
    assert!(plain.iter().all(|x| *x != 0.0));
    assert_eq!(turned, [-plain[0], plain[1], -plain[2]]);
    assert_eq!(stopped, [plain[0], 0.0, plain[2]]);
    // Nothing can be compiled on top of a set that is turned.
    std::fs::write(set.folder.path("out").join(list), format!("{text}negate X\n")).unwrap();
    let more = ["--installed", set.folder.path("out").to_str().unwrap(), "--poses", "20"].map(str::to_owned);
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    compile(&set.machine, "isg-volcomp", &set.folder.path("new"), &more).refused("E0711").says("turns corrections");
}

/// Logical axis numbers of one's own stand in the machine file.
#[test]
fn numbers_of_a_list_are_those_of_the_machine_file() {
    let set = Set::of("isg-volcomp");
    let text = std::fs::read_to_string(&set.machine).unwrap().replacen("controller: 1", "controller: 6", 1);
    let machine = set.folder.write("six.yaml", &text);
    compile(&machine, "isg-volcomp", &set.folder.path("six"), &FEW).json();
    let list = std::fs::read_to_string(set.folder.path("six/volcomp0.lis")).unwrap();
    assert!(list.contains("\nx 6\ny 2\n"), "{list}");
}

/// Behind M17, M30 or the second `%` nothing is read.
#[test]
fn nothing_stands_behind_the_end() {
    let verified = |set: &Set, file: &str, text: &str| {
        std::fs::write(set.folder.path("out").join(file), text).unwrap();
        verify(&set.machine, &set.folder.path("out"), &["--poses", "20"])
    };
    for (target, file, end) in [
        ("sinumerik-cec", "_N_NC_CEC_INI", "M17"),
        ("sinumerik-cec", "_N_NC_CEC_INI", "M30"),
        ("sinumerik-enc", "_N_AX1_EEC_INI", "M17"),
        ("fanuc-pitch", "PITCH_X.TXT", "%"),
    ] {
        let set = Set::of(target);
        let text = set.text(file);
        let lines: Vec<&str> = text.lines().collect();
        let middle = lines.len() / 2;
        let cut = [&lines[..middle], &[end], &lines[middle..]].concat().join("\n");
        verified(&set, file, &cut).refused("E0704").says("stops reading at line");
        // Comments and blank lines may stand there.
        if target.starts_with("sinumerik") {
            verified(&set, file, &format!("{text}\n; that was all\n")).json();
            verified(&set, file, &text.replace("M17", "M30\nM17")).json();
        }
    }
}

/// Exchanged as an installed set too: what is not in force was not there when the machine was measured.
#[test]
fn installed_tables_are_those_in_force() {
    let set = Set::of("heidenhain-com");
    let new = |name: &str, installed: &Path| {
        let out = set.folder.path(name);
        let more = [&FEW[..], &["--installed", installed.to_str().unwrap()]].concat();
        compile(&set.machine, "heidenhain-com", &out, &more).json();
        std::fs::read_to_string(out.join("X_AXIS.COM")).unwrap()
    };
    let first = set.text("X_AXIS.COM");
    let on_top = new("on-top", &set.folder.path("out"));
    assert_ne!(on_top, first);
    let text = set.text("CONFIG.CMA").replace("0 *", "0 -");
    std::fs::write(set.folder.path("out/CONFIG.CMA"), text).unwrap();
    assert_eq!(new("on-nothing", &set.folder.path("out")), first);
}
