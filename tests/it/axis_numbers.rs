//! Letters and numbers of axes in the controller are the user's: stated, or the file is refused.

use std::path::{Path, PathBuf};

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile, names, set_files, verify};

const FEW: [&str; 3] = ["--accept-unverified", "--poses", "60"];

/// Targets whose files name axes by numbers of the machine.
const NUMBERED: [&str; 5] = ["sinumerik-cec", "sinumerik-enc", "twincat-axis", "pmac", "fanuc-pitch"];

const NAMES: [&str; 5] = ["X", "Y", "Z", "A", "C"];

/// A trunnion whose entries end with these words.
fn machine(folder: &Folder, name: &str, words: [&str; 5]) -> PathBuf {
    let travel = ["[0 mm, 500 mm]", "[0 mm, 400 mm]", "[-300 mm, 0 mm]", "[-90 deg, 30 deg]", "continuous"];
    let axis = |k: usize| format!("  {}: {{ travel: {}, origin: [0, 0, 0]{} }}\n", NAMES[k], travel[k], words[k]);
    let axes: String = (0..5).map(axis).collect();
    let errors = "EXX: { points: [[0 mm, 0 um], [500 mm, 9 um]] }, EZX: { points: [[0 mm, 0 um], [500 mm, 8 um]] }, \
                  EAA: { points: [[-90 deg, 20 urad], [30 deg, -8 urad]] }, ECC: { harmonics: { 1: [9 urad, 4 urad] } }";
    let text = format!(
        "abbe: 1\nmachine: numbers\nchain: \"w C' A' b X Y Z t\"\naxes:\n{axes}tool: {{ length: 90 mm }}\n\
         errors: {{ {errors} }}\nvolume: {{ step: 100 mm, A: {{ step: 30 deg }}, C: {{ step: 30 deg }} }}\n"
    );
    folder.write(name, &text)
}

fn numbered(folder: &Folder, name: &str, numbers: [u16; 5]) -> PathBuf {
    let words = numbers.map(|number| format!(", controller: {number}"));
    machine(folder, name, words.each_ref().map(String::as_str))
}

/// All files of a set but its manifest, one after the other.
fn text(out: &Path) -> String {
    let files = set_files(out).into_iter().filter(|name| name != "abbe.lock.json");
    files.map(|name| format!("{name}\n{}", std::fs::read_to_string(out.join(&name)).unwrap())).collect()
}

#[test]
fn numbers_are_not_assumed() {
    for target in NUMBERED {
        let folder = Folder::new();
        let (plain, out) = (machine(&folder, "plain.yaml", [""; 5]), folder.path("out"));
        let refused = compile(&plain, target, &out, &FEW);
        refused.refused("E0712").says("not stated: X, Y, Z, A, C");
        assert!(!out.exists());
        // The line that is printed serves as it stands.
        let map = refused.err.split("--map ").nth(1).unwrap().split([',', ' ']).take(5).collect::<Vec<_>>().join(",");
        let json = compile(&plain, target, &out, &[&FEW[..], &["--map", &map]].concat()).json();
        // The manifest keeps it.
        let again = verify(&plain, &out, &["--poses", "60"]).json();
        assert_eq!(again["compensated"], json["compensated"], "{target}");
        let stated = folder.path("stated");
        let file = numbered(&folder, "stated.yaml", [1, 2, 3, 4, 5]);
        assert_eq!(compile(&file, target, &stated, &FEW).json()["compensated"], json["compensated"]);
        assert_eq!(text(&stated), text(&out), "{target}");
        std::fs::remove_file(out.join("abbe.lock.json")).unwrap();
        verify(&plain, &out, &["--target", target]).refused("E0712");
        verify(&file, &out, &["--target", target, "--poses", "60"]).json();
    }
}

/// Whatever the numbers are, the same corrections reach the same axes.
#[test]
fn any_numbers_are_written_and_read() {
    for (target, words) in [
        ("sinumerik-cec", ["(AX11)", "(AX23)"]),
        ("sinumerik-enc", ["_N_AX23_EEC_INI", "AX11]"]),
        ("twincat-axis", ["kopf.achs_nr 11", "master_ax_nr 11"]),
        ("pmac", ["#11D,#11", "#23D,#23"]),
        ("fanuc-pitch", ["N03620Q1A11P", "N03620Q1A23P"]),
    ] {
        let folder = Folder::new();
        let usual = numbered(&folder, "usual.yaml", [1, 2, 3, 4, 5]);
        let (first, second) = (folder.path("first"), folder.path("second"));
        let json = compile(&usual, target, &first, &FEW).json();
        let other = numbered(&folder, "other.yaml", [11, 3, 7, 23, 2]);
        let of_other = compile(&other, target, &second, &FEW).json();
        assert_eq!(of_other["compensated"], json["compensated"], "{target}");
        let text = text(&second);
        assert!(words.iter().all(|word| text.contains(word)), "{target}: {text}");
        let again = verify(&other, &second, &["--poses", "60"]).json();
        assert_eq!(again["compensated"], json["compensated"], "{target}");
        // With other numbers the files are of other axes, or of none.
        let wrong = verify(&usual, &second, &["--poses", "60", "--quiet"]);
        assert!(wrong.code == Some(1) || wrong.json()["compensated"] != json["compensated"], "{target}");
    }
}

#[test]
fn words_that_do_not_fit_are_refused() {
    let folder = Folder::new();
    let plain = machine(&folder, "plain.yaml", [""; 5]);
    let with = |map: &str| compile(&plain, "pmac", &folder.path("out"), &[&FEW[..], &["--map", map]].concat());
    with("X=1,Y=1,Z=3,A=4,C=5").refused("E0712").says("axes `X` and `Y` have one number");
    with("X=1,Q=2").refused("E0712").says("no axis `Q`");
    with("X=A").refused("E0601").says("cannot be `A`");
    with("X=Y").refused("E0601").says("both `Y`");
    for map in ["X", "X=", "X=0", "X=1.5", "X=AX", "=1", "X=1,X=2", "X=U,X=V", "X=65536"] {
        assert_eq!(with(map).code, Some(2), "{map}");
    }
    for word in ["0", "-3", "1.5", "AX", "[1, 2]", "[A, 1, 2]", "x", "{ number: 3 }"] {
        let words = format!(", controller: {word}");
        let file = machine(&folder, "wrong.yaml", [&words, "", "", "", ""]);
        let run = Run::of(abbe().arg("check").arg(&file));
        assert_eq!(run.code, Some(1), "{word}: {}", run.err);
        run.says("controller");
    }
}

/// A letter of the controller's instead of the first free one.
#[test]
fn letters_are_the_users() {
    let folder = Folder::new();
    let text = |word: &str| {
        format!(
            "abbe: 1\nmachine: m\nchain: w b X1 Y t\naxes:\n  X1: {{ travel: [0, 300], origin: [0, 0, 0]{word} }}\n  \
             Y: {{ travel: [0, 300], origin: [0, 0, 0] }}\nerrors: {{ EXX1: {{ points: [[0, 0 um], [300, 9 um]] }} }}\n"
        )
    };
    let plain = folder.write("plain.yaml", &text(""));
    let out = |name: &str| folder.path(name);
    let first = compile(&plain, "linuxcnc", &out("first"), &FEW);
    first.says("W0601").json();
    assert!(names(&out("first")).contains(&"joint_0_X.comp".to_owned()));
    let by_option = compile(&plain, "linuxcnc", &out("option"), &[&FEW[..], &["--map", "X1=U"]].concat());
    let file = folder.write("stated.yaml", &text(", controller: [U, 9]"));
    let by_file = compile(&file, "linuxcnc", &out("file"), &FEW);
    for (run, name) in [(by_option, "option"), (by_file, "file")] {
        assert!(!run.err.contains("W0601"), "{}", run.err);
        run.json();
        // LinuxCNC counts joints itself.
        assert_eq!(set_files(&out(name)), ["abbe.lock.json", "compensation.inc", "joint_0_Y.comp", "joint_1_U.comp"]);
    }
    let again = folder.path("again.yaml");
    let convert = Run::of(abbe().arg("convert").arg(&file).args(["--to", "linearised", "--out"]).arg(&again));
    assert_eq!(convert.code, Some(0), "{}", convert.err);
    assert!(std::fs::read_to_string(&again).unwrap().contains("controller: [U, 9]"));
    let diff = Run::of(abbe().args(["diff", "--format", "json"]).arg(&plain).arg(&file)).json();
    assert_eq!(
        (&diff["differences"][0]["kind"], &diff["differences"][0]["second"]),
        (&"controller".into(), &"U, 9".into())
    );
}
