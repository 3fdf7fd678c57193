//! Formats distinguished by content: every target's files under other names and without a manifest, alone, in `diff`
//! and as the installed set; ambiguous content is refused with the candidates.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::{PARAMETER_TARGETS, Run, abbe, compile, names, number, set_files, verify};

const TABLES: &str = "EXX: { points: [[0 mm, 0 um], [500 mm, 9 um]] }\n  EYX: { points: [[0 mm, 0 um], [500 mm, -4 um]] }\n  \
     EZX: { points: [[0 mm, 0 um], [500 mm, 6 um]] }\n  EYY: { points: [[0 mm, 0 um], [400 mm, 7 um]] }\n  EZZ: { points: [[-300 mm, 3 um], [0 mm, 0 um]] }\n  EC0Y: 30 urad";

/// Three axes of different travel, or of the same.
fn three_axes(folder: &Folder, name: &str, y: u32) -> PathBuf {
    let errors = TABLES.replace("[400 mm", &format!("[{y} mm"));
    folder.write(
        name,
        &format!(
            "abbe: 1\nmachine: example\nchain: \"w b X Y Z t\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 500 mm], origin: [0, 0, 0] }}\n  Y: {{ controller: 2, travel: [0 mm, {y} mm], origin: [0, 0, 0] }}\n  \
             Z: {{ controller: 3, travel: [-300 mm, 0 mm], origin: [0, 0, 0] }}\nerrors:\n  {errors}\nvolume: {{ step: 100 mm }}\n"
        ),
    )
}

/// A tilting table that turns right-handed, the machine of linuxcnc-trt.
fn tilting_table(folder: &Folder) -> PathBuf {
    folder.write(
        "tilting.yaml",
        "abbe: 1\nmachine: tilting\nchain: \"w C' A' b X Y Z t\"\naxes:\n  X: { controller: 1, travel: [-200 mm, 200 mm], origin: [0, 0, 0] }\n  Y: { controller: 2, travel: [-150 mm, 150 mm], origin: [0, 0, 0] }\n  \
         Z: { controller: 3, travel: [-300 mm, 0 mm], origin: [0, 0, 0] }\n  A: { controller: 4, travel: [-90 deg, 30 deg], sense: direct }\n  C: { controller: 5, travel: continuous, sense: direct }\nerrors:\n  EX0C: 20 um\n  EY0A: -15 um\n",
    )
}

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "40"];

fn strip(mut json: Value) -> Value {
    json.as_object_mut().unwrap().retain(|key, _| key != "files" && key != "warnings");
    json
}

/// The same files under meaningless names, in another order, without the manifest.
fn renamed(out: &Path, into: &Path) {
    std::fs::create_dir_all(into).unwrap();
    for (i, name) in set_files(out).iter().rev().filter(|name| *name != "abbe.lock.json").enumerate() {
        std::fs::copy(out.join(name), into.join(format!("found{i}.bin"))).unwrap();
    }
}

#[test]
fn every_target_is_told_by_its_content() {
    let folder = Folder::new();
    let (three, tilting) = (three_axes(&folder, "three.yaml", 400), tilting_table(&folder));
    for target in abbe::controller::NAMES {
        let machine = match target {
            // Its machine is none of these; `kinematic_parameters` has it.
            "linuxcnc-5axiskins" | "linuxcnc-maxkins" => continue,
            "linuxcnc-trt" => &tilting,
            _ if PARAMETER_TARGETS.contains(&target) => &tilting,
            _ => &three,
        };
        let (out, found) = (folder.path(target), folder.path(&format!("{target}-found")));
        let scale: &[&str] = if target == "grbl" { &["--scale", "X=80,Y=80,Z=400"] } else { &[] };
        compile(machine, target, &out, &[&FEW[..], scale].concat()).json();
        let before = verify(machine, &out, &["--poses", "40"]).json();
        renamed(&out, &found);
        let after = verify(machine, &found, &["--poses", "40"]);
        assert_eq!(after.code, Some(0), "{target}: {}", after.err);
        assert_eq!(after.json()["target"], target);
        assert_eq!(strip(after.json()), strip(before), "{target}");
        if target.starts_with("linuxcnc-") {
            continue;
        }
        let diff =
            Run::of(abbe().args(["diff", "--format", "json", "--poses", "40"]).arg(machine).arg(&out).arg(&found));
        assert_eq!(number(&diff.json(), "/position_um/max"), 0.0, "{target}");
        let more = [&FEW[..], &["--installed", found.to_str().unwrap(), "--max-correction", "5 mm, 0.05"]].concat();
        compile(machine, target, &folder.path(&format!("{target}-on-top")), &more).json();
    }
}

/// A table of three columns does not name its axis: the machine's configuration does, then its travel, or nothing.
#[test]
fn tables_that_do_not_say_their_axis() {
    let folder = Folder::new();
    let alike = three_axes(&folder, "alike.yaml", 500);
    let out = folder.path("out");
    compile(&alike, "linuxcnc", &out, &FEW).json();
    let before = strip(verify(&alike, &out, &["--poses", "40"]).json());
    let found = folder.path("found");
    std::fs::create_dir_all(&found).unwrap();
    for (old, new) in [("joint_0_X.comp", "b.comp"), ("joint_1_Y.comp", "a.comp"), ("joint_2_Z.comp", "c.comp")] {
        std::fs::copy(out.join(old), found.join(new)).unwrap();
    }
    // X and Y travel alike.
    verify(&alike, &found, &[]).refused("E0731").says("`a.comp`").says("X (`joint_0_X.comp`), Y (`joint_1_Y.comp`)");
    let ini = |kind: &str| {
        let joint = |n: usize, file: &str| format!("[JOINT_{n}]\nTYPE = LINEAR\nCOMP_FILE = {file}\n{kind}\n");
        format!("[EMC]\nMACHINE = mill\n{}{}{}", joint(0, "tables/b.comp"), joint(1, "a.comp"), joint(2, "c.comp"))
    };
    std::fs::write(found.join("mill.ini"), ini("COMP_FILE_TYPE = 1")).unwrap();
    assert_eq!(strip(verify(&alike, &found, &["--poses", "40"]).json()), before);
    // The default of LinuxCNC reads the same numbers as positions.
    for kind in ["COMP_FILE_TYPE = 0", ""] {
        std::fs::write(found.join("mill.ini"), ini(kind)).unwrap();
        verify(&alike, &found, &[]).refused("E0704").says("mill.ini:").says("COMP_FILE_TYPE = 1");
    }
    // The same holds in our own file of that kind.
    let path = out.join("compensation.inc");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replacen("COMP_FILE_TYPE = 1", "COMP_FILE_TYPE = 0", 1)).unwrap();
    verify(&alike, &out, &[]).refused("E0704").says("compensation.inc:");
    // Different travels distinguish the axes, with a warning.
    let three = three_axes(&folder, "three.yaml", 400);
    let set = folder.path("three");
    compile(&three, "linuxcnc", &set, &FEW).json();
    std::fs::rename(set.join("joint_1_Y.comp"), set.join("y.txt")).unwrap();
    std::fs::rename(set.join("joint_0_X.comp"), set.join("x.txt")).unwrap();
    std::fs::rename(set.join("joint_2_Z.comp"), set.join("z.txt")).unwrap();
    std::fs::remove_file(set.join("abbe.lock.json")).unwrap();
    std::fs::remove_file(set.join("compensation.inc")).unwrap();
    let run = verify(&three, &set, &["--poses", "40"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.says("W0710").says("`y.txt` does not name its axis: read as the table of `Y`");
    // A set is only whole with all of its tables.
    std::fs::remove_file(set.join("y.txt")).unwrap();
    verify(&three, &set, &[]).refused("E0705").says("joint_1_Y.comp");
}

/// HEIDENHAIN: the CMA file assigns, then the frame of the table names its file.
#[test]
fn columns_are_assigned_by_the_configuration() {
    let folder = Folder::new();
    let machine = three_axes(&folder, "alike.yaml", 500);
    let out = folder.path("out");
    compile(&machine, "heidenhain-com", &out, &FEW).json();
    let before = strip(verify(&machine, &out, &["--poses", "40"]).json());
    let found = folder.path("found");
    std::fs::create_dir_all(&found).unwrap();
    let text = std::fs::read_to_string(out.join("X_AXIS.COM")).unwrap();
    // The frame still names the file as it was.
    std::fs::write(found.join("ONE.COM"), &text).unwrap();
    std::fs::copy(out.join("Y_AXIS.COM"), found.join("TWO.COM")).unwrap();
    std::fs::copy(out.join("Z_AXIS.COM"), found.join("THREE.COM")).unwrap();
    assert_eq!(strip(verify(&machine, &found, &["--poses", "40"]).json()), before);
    // A file that assigns files comes first: X and Y exchanged.
    std::fs::write(
        found.join("OTHER.CMA"),
        "BEGIN OTHER .CMA MM\nNR ACTIVE X Y Z\n0 * TWO.COM ONE.COM THREE.COM\n[END]\n",
    )
    .unwrap();
    let exchanged = strip(verify(&machine, &found, &["--poses", "40"]).json());
    assert_ne!(exchanged["compensated"], before["compensated"]);
    assert_eq!(exchanged["target"], "heidenhain-com");
}

#[test]
fn what_content_leaves_open_is_refused() {
    let folder = Folder::new();
    let machine = three_axes(&folder, "three.yaml", 400);
    let [tables, matrix, both] = ["tables", "matrix", "both"].map(|name| folder.path(name));
    compile(&machine, "linuxcnc", &tables, &FEW).json();
    compile(&machine, "linuxcnc-matrixkins", &matrix, &FEW).json();
    std::fs::create_dir_all(&both).unwrap();
    for from in [&tables, &matrix] {
        for name in set_files(from).iter().filter(|name| *name != "abbe.lock.json") {
            std::fs::copy(from.join(name), both.join(name)).unwrap();
        }
    }
    let run = verify(&machine, &both, &[]);
    run.refused("E0730").says("`linuxcnc`").says("`linuxcnc-matrixkins`").says("matrixkins.hal");
    for target in ["linuxcnc", "linuxcnc-matrixkins"] {
        let json = verify(&machine, &both, &["--target", target, "--poses", "40"]).json();
        assert_eq!(json["target"], target);
    }
    // A target of one's own with the format of another.
    let own = folder.path("templates/copy");
    std::fs::create_dir_all(&own).unwrap();
    for name in ["target.yaml", "skew.j2"] {
        let text = std::fs::read_to_string(Path::new("templates/klipper").join(name)).unwrap();
        std::fs::write(own.join(name), text.replace("target: klipper", "target: copy")).unwrap();
    }
    let skew = folder.path("skew");
    compile(&machine, "klipper", &skew, &FEW).json();
    std::fs::remove_file(skew.join("abbe.lock.json")).unwrap();
    std::fs::rename(skew.join("skew_correction.cfg"), skew.join("printer.cfg")).unwrap();
    let templates = folder.path("templates");
    let more = ["--templates", templates.to_str().unwrap(), "--poses", "40"];
    verify(&machine, &skew, &more).refused("E0730").says("`copy` (`printer.cfg`)").says("`klipper` (`printer.cfg`)");
    assert_eq!(verify(&machine, &skew, &[&more[..], &["--target", "copy"]].concat()).json()["target"], "copy");
    // In a set of one's own target alone it is recognised too.
    let manifest = std::fs::read_to_string(own.join("target.yaml")).unwrap();
    std::fs::write(own.join("target.yaml"), manifest.replace("xy_skew = ", "own_xy ")).unwrap();
    let template = std::fs::read_to_string(own.join("skew.j2")).unwrap();
    std::fs::write(own.join("skew.j2"), template.replace("xy_skew = ", "own_xy ")).unwrap();
    let ours = folder.path("ours");
    compile(&machine, "copy", &ours, &[&FEW[..], &more[..2]].concat()).json();
    std::fs::remove_file(ours.join("abbe.lock.json")).unwrap();
    std::fs::rename(ours.join("skew_correction.cfg"), ours.join("printer.cfg")).unwrap();
    assert_eq!(verify(&machine, &ours, &more).json()["target"], "copy");
    // The same part twice.
    let twice = folder.path("twice");
    std::fs::create_dir_all(&twice).unwrap();
    for name in ["a.cfg", "b.cfg"] {
        std::fs::copy(skew.join("printer.cfg"), twice.join(name)).unwrap();
    }
    verify(&machine, &twice, &[]).refused("E0732").says("`a.cfg` and `b.cfg`");
}

/// A damaged file among sound ones is not passed over in silence.
#[test]
fn what_is_not_read_is_said() {
    let folder = Folder::new();
    let machine = three_axes(&folder, "three.yaml", 400);
    let out = folder.path("out");
    compile(&machine, "sinumerik-enc", &out, &FEW).json();
    let found = folder.path("found");
    renamed(&out, &found);
    let name = names(&found)[0].clone();
    let text = std::fs::read_to_string(found.join(&name)).unwrap();
    std::fs::write(found.join(&name), text.replacen("]=0.", "]=O.", 1)).unwrap();
    std::fs::write(found.join("image.png"), [0x89, 0x50, 0xff, 0xfe]).unwrap();
    let run = verify(&machine, &found, &["--poses", "40"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.says("W0711").says(&format!("`{name}` is ignored")).says("`image.png` is ignored").says(": line ");
    // With the set's manifest a missing table is missing.
    std::fs::remove_file(out.join("_N_AX2_EEC_INI")).unwrap();
    verify(&machine, &out, &[]).refused("E0705").says("_N_AX2_EEC_INI");
}
