//! Folders that `compile` refuses to touch, and files that `verify` refuses to believe.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile, config, names, sha256::sha256, tree, verify};

/// A three-axis machine whose set is made in no time; `axes` may add some, `more` any key.
fn machine(folder: &Folder, name: &str, errors: &str, more: &str) -> PathBuf {
    folder.write(
        name,
        &format!(
            "abbe: 1\nmachine: small\nchain: w b X Y Z t\naxes: {{ X: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }}, Y: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }}, \
             Z: {{ travel: [0 mm, 600 mm], origin: [0, 0, 0] }} }}\nerrors: {{ {errors} }}\nvolume: {{ step: 300 mm }}\n{more}"
        ),
    )
}

const EXX: &str = "EXX: { points: [[0 mm, 1 um], [300 mm, 4 um], [600 mm, -2 um]] }";

/// A folder `out` with a set of ours, beside the machine file.
fn compiled(target: &str) -> (Folder, PathBuf, PathBuf) {
    let folder = Folder::new();
    let machine = machine(&folder, "machine.yaml", EXX, "");
    let out = folder.path("out");
    compile(&machine, target, &out, &[]).json();
    (folder, machine, out)
}

/// Compiles over a folder, and asserts that it is refused and that nothing whatever has changed.
fn refused_unchanged(folder: &Folder, machine: &Path, out: &Path, code: &str, words: &str) {
    let before = tree(&folder.path(""));
    compile(machine, "linuxcnc", out, &[]).refused(code).says(words);
    assert_eq!(tree(&folder.path("")), before, "{code}: {words}");
}

#[test]
fn our_own_set_is_replaced_and_other_files_are_left_alone() {
    let (folder, machine_file, out) = compiled("linuxcnc");
    let first = tree(&out);
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    std::fs::write(out.join("joint_9_Q.comp"), "0 0 0\n").unwrap();
    compile(&machine_file, "linuxcnc", &out, &[]).json();
    let again = tree(&out);
    assert!(first.iter().all(|(path, entry)| again[path] == *entry));
    assert_eq!(again.len(), first.len() + 2);
    // Another set over it: the new bytes, still nobody else's.
    let other = machine(&folder, "machine.yaml", "EXX: { points: [[0 mm, 9 um], [600 mm, 9 um]] }", "");
    compile(&other, "linuxcnc", &out, &[]).json();
    assert!(std::fs::read_to_string(out.join("joint_0_X.comp")).unwrap().starts_with("0.000000 -0.009000000 "));
    assert_eq!(std::fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    assert_eq!(names(&out).len(), 8, "{:?}", names(&out));
    assert!(names(&out).iter().all(|name| !name.starts_with('.')));
}

/// A set that no longer has an axis takes its old table away, unless somebody has worked on it.
#[test]
fn stale_files_of_ours_go_and_edited_ones_stay() {
    for edited in [false, true] {
        let folder = Folder::new();
        let out = folder.path("out");
        compile(&config("trunnion.yaml"), "linuxcnc", &out, &["--poses", "10"]).json();
        if edited {
            std::fs::write(out.join("joint_3_A.comp"), "0 0 0\n").unwrap();
        }
        compile(&machine(&folder, "machine.yaml", EXX, ""), "linuxcnc", &out, &["--replace"]).json();
        let tables = ["joint_0_X.comp", "joint_1_Y.comp", "joint_2_Z.comp"];
        let ours = [&["abbe.lock.json", "compensation.inc", "restore"][..], &tables].concat();
        let kept: Vec<_> = names(&out).into_iter().filter(|name| !ours.contains(&name.as_str())).collect();
        assert_eq!(kept, if edited { vec!["joint_3_A.comp"] } else { vec![] });
        // Another target in the same folder takes the place of the first.
        compile(&folder.path("machine.yaml"), "grid-csv", &out, &["--replace"]).json();
        let left: Vec<_> = names(&out).into_iter().filter(|name| name != "joint_3_A.comp").collect();
        assert_eq!(left, ["abbe.lock.json", "corrections.csv", "restore"]);
    }
}

#[test]
fn files_that_are_not_ours_are_not_replaced() {
    let folder = Folder::new();
    let machine_file = machine(&folder, "machine.yaml", EXX, "");
    let out = folder.path("out");
    for name in ["joint_1_Y.comp", "compensation.inc"] {
        std::fs::create_dir(&out).unwrap();
        std::fs::write(out.join(name), "0 0.01 0.01\n").unwrap();
        refused_unchanged(&folder, &machine_file, &out, "E0706", "was not written by abbe");
        std::fs::remove_dir_all(&out).unwrap();
    }
    let (folder, machine_file, out) = compiled("linuxcnc");
    let table = out.join("joint_0_X.comp");
    let text = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, text.replacen("-0.001", "-0.002", 1)).unwrap();
    // The bytes that the next set would hold are not ours to take away either, if the rest of the set differs.
    machine(&folder, "machine.yaml", "EYY: { points: [[0 mm, 1 um], [600 mm, 2 um]] }", "");
    refused_unchanged(&folder, &machine_file, &out, "E0706", "has been edited since abbe wrote it");
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_replaced() {
    use std::os::unix::fs::symlink;
    let names = ["joint_0_X.comp", "compensation.inc", "abbe.lock.json"];
    for name in names {
        for kind in ["link", "link to the same", "dangling", "folder", "fifo"] {
            let (folder, machine_file, out) = compiled("linuxcnc");
            let path = out.join(name);
            let elsewhere = folder.path("elsewhere");
            std::fs::copy(&path, &elsewhere).unwrap();
            std::fs::remove_file(&path).unwrap();
            match kind {
                "link" => {
                    std::fs::write(&elsewhere, "precious").unwrap();
                    symlink(&elsewhere, &path).unwrap();
                }
                "link to the same" => symlink(&elsewhere, &path).unwrap(),
                "dangling" => symlink(folder.path("nowhere"), &path).unwrap(),
                "folder" => std::fs::create_dir(&path).unwrap(),
                _ => assert!(Command::new("mkfifo").arg(&path).status().unwrap().success()),
            }
            refused_unchanged(&folder, &machine_file, &out, "E0706", name);
        }
    }
}

/// A manifest that we did not write is somebody's file; one with hashes of others' files gives us no right to them.
#[test]
fn manifests_of_others() {
    for text in ["", "{}", "[1, 2]", "precious", "{\"abbe\": \"0.1.0\", \"target\": \"linuxcnc\"}"] {
        let (folder, machine_file, out) = compiled("linuxcnc");
        std::fs::write(out.join("abbe.lock.json"), text).unwrap();
        refused_unchanged(&folder, &machine_file, &out, "E0706", "abbe.lock.json");
    }
    let (folder, machine_file, out) = compiled("linuxcnc");
    folder.write("victim.txt", "precious");
    let lock = out.join("abbe.lock.json");
    let mut json: Value = serde_json::from_slice(&std::fs::read(&lock).unwrap()).unwrap();
    for name in ["../victim.txt", folder.path("victim.txt").to_str().unwrap(), "..", "."] {
        let entry = serde_json::json!({"name": name, "sha256": sha256(b"precious")});
        json["files"].as_array_mut().unwrap().push(entry);
    }
    std::fs::write(&lock, json.to_string()).unwrap();
    refused_unchanged(&folder, &machine_file, &out, "E0734", "../victim.txt");
    assert_eq!(std::fs::read_to_string(folder.path("victim.txt")).unwrap(), "precious");
}

#[test]
fn folders_that_cannot_be_written_to() {
    let folder = Folder::new();
    let machine_file = machine(&folder, "machine.yaml", EXX, "");
    let file = folder.write("file", "precious");
    refused_unchanged(&folder, &machine_file, &file, "E0810", "file");
    refused_unchanged(&folder, &machine_file, &file.join("below"), "E0810", "file");
    // Nobody writes here, root neither.
    if cfg!(target_os = "linux") {
        refused_unchanged(&folder, &machine_file, Path::new("/proc"), "E0810", "/proc");
        refused_unchanged(&folder, &machine_file, Path::new("/dev/null/out"), "E0810", "/dev/null");
    }
    let long = folder.path(&"x".repeat(300));
    refused_unchanged(&folder, &machine_file, &long, "E0810", "xxx");
}

/// Runs `compile` under a limit of the size of files: to the program, the disk is full.
fn under_a_limit(machine: &Path, out: &Path, blocks: u32, ignoring: bool) -> Run {
    let trap = if ignoring { "trap '' XFSZ; " } else { "" };
    let script = format!("{trap}ulimit -f {blocks}; exec \"$@\"");
    let program = env!("CARGO_BIN_EXE_abbe");
    let arguments = ["-c", &script, "sh", program, "compile"];
    Run::of(Command::new("sh").args(arguments).arg(machine).args(["--target", "grid-csv", "--out"]).arg(out))
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_old_set() {
    let (folder, _, out) = compiled("grid-csv");
    let before = tree(&out);
    // 13 x 13 x 13 nodes are over 100 kB, a block is 512 or 1024 bytes.
    let fine = folder.write(
        "fine.yaml",
        &std::fs::read_to_string(folder.path("machine.yaml")).unwrap().replace("step: 300", "step: 50"),
    );
    under_a_limit(&fine, &out, 20, true).refused("E0810").says("nothing was written");
    assert_eq!(tree(&out), before);
    // The signal that goes with the limit kills nothing: the refusal is the same, and the next run is not hindered.
    under_a_limit(&fine, &out, 20, false).refused("E0810").says("nothing was written");
    assert_eq!(tree(&out), before);
    verify(&folder.path("machine.yaml"), &out, &[]).json();
    compile(&fine, "grid-csv", &out, &[]).json();
    verify(&fine, &out, &[]).json();
    // In an empty place nothing appears under the names of a set.
    let fresh = folder.path("fresh");
    under_a_limit(&fine, &fresh, 20, true).refused("E0810");
    assert!(!fresh.exists() || tree(&fresh).is_empty());
}

#[test]
fn corrections_beyond_what_is_plausible() {
    let rotary =
        "EAC: { points: [[0 deg, 0 urad], [360 deg, 0 urad]] }, ECC: { points: [[0 deg, 6 mrad], [360 deg, 6 mrad]] }";
    let cases = [
        ("linuxcnc", "EXX: { points: [[0 mm, 1.2 mm], [600 mm, 1.2 mm]] }", "2 mm"),
        ("grid-csv", "EXX: { points: [[0 mm, -1.2 mm], [600 mm, -1.2 mm]] }", "2 mm"),
        ("linuxcnc", "EXX: { points: [[0 mm, 0 mm], [10 mm, 0.2 mm], [600 mm, 0 mm]] }", "0.03"),
        (
            "grid-csv",
            "EYX: { points: [[0 mm, 0.9 mm], [600 mm, 0.9 mm]] }, EYY: { points: [[0 mm, 0.3 mm], [600 mm, 0.3 mm]] }",
            "2 mm",
        ),
        ("linuxcnc", rotary, "7 mrad"),
    ];
    for (target, errors, raised) in cases {
        let folder = Folder::new();
        let machine = machine(&folder, "machine.yaml", errors, "");
        let text = std::fs::read_to_string(&machine).unwrap();
        if errors.contains("ECC") {
            let text =
                text.replace("chain: w b", "chain: w C' b").replace("axes: {", "axes: { C: { travel: continuous },");
            folder.write("machine.yaml", &text);
        }
        let out = folder.path("out");
        compile(&machine, target, &out, &[]).refused("E0602").says("--max-correction");
        assert!(!out.exists(), "{target}: {errors}");
        // A study writes nothing that is loaded.
        let study = ["--target", target, "--random", "20", "--format", "json"];
        Run::of(abbe().arg("map").arg(&machine).args(study)).json();
        compile(&machine, target, &out, &["--max-correction", raised]).json();
        // Raising one limit does not raise another.
        let other = if raised.contains("mm") { "9 mrad" } else { "2 mm" };
        compile(&machine, target, &folder.path("other"), &["--max-correction", other]).refused("E0602");
    }
}

#[test]
fn limits_that_make_no_sense_are_a_matter_of_usage() {
    let (_folder, machine, out) = compiled("linuxcnc");
    let before = tree(&out);
    for limit in ["-1 mm", "0 mm", "3 s", "nan", "inf mm", "much", "1e400 mm"] {
        let run = compile(&machine, "linuxcnc", &out, &[&format!("--max-correction={limit}")]);
        assert_eq!(run.code, Some(2), "{limit}: {}", run.err);
    }
    assert_eq!(tree(&out), before);
}

#[test]
fn axes_without_a_letter() {
    let folder = Folder::new();
    let axis = |name: &str| format!("{name}: {{ kind: rotary, direction: [0, 0, 1], travel: [0 deg, 90 deg] }}");
    let with = |axes: &[&str]| {
        let all: Vec<_> = axes.iter().map(|name| axis(name)).collect();
        let (chain, axes) = (axes.join(" "), all.join(", "));
        folder.write("machine.yaml", &format!("abbe: 1\nmachine: free\nchain: w b {chain} t\naxes: {{ {axes} }}\n"))
    };
    let out = folder.path("out");
    compile(&with(&["J1", "B", "J2", "J3"]), "linuxcnc", &out, &[]).refused("E0601").says("J3");
    assert!(!out.exists());
    // A warning is a refusal to those who ask for it.
    let three = with(&["J1", "B", "J2"]);
    compile(&three, "linuxcnc", &out, &["--deny", "warnings"]);
    assert!(!out.exists());
    let run = compile(&three, "linuxcnc", &out, &[]);
    run.json();
    run.says("W0601").says("`J1` is written as `A`").says("`J2` is written as `C`");
    assert_eq!(names(&out)[2..5], ["joint_0_A.comp", "joint_1_B.comp", "joint_2_C.comp"]);
}

#[test]
fn names_do_not_leave_their_place() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(machine(&folder, "machine.yaml", EXX, "")).unwrap();
    let before = names(&folder.path(""));
    let named = |name: &str| folder.write("machine.yaml", &text.replace("machine: small", &format!("machine: {name}")));
    // A name is text wherever it appears: no path, no template, no line of its own.
    for name in ["../../evil", "\"{{ 7 * 7 }} {% endfor %}\"", "\"</script>\"", "/etc/evil"] {
        let out = folder.path("out");
        compile(&named(name), "linuxcnc", &out, &[]).json();
        let fragment = std::fs::read_to_string(out.join("compensation.inc")).unwrap();
        assert!(fragment.lines().next().unwrap().starts_with(&format!("# {}: ", name.trim_matches('"'))), "{fragment}");
        std::fs::remove_dir_all(&out).unwrap();
        assert_eq!(names(&folder.path("")), before);
    }
    let out = folder.path("out");
    compile(&named("\"two\\nCOMP_FILE = /etc/passwd\""), "linuxcnc", &out, &[]).refused("E0212");
    assert!(!out.exists());
    for target in ["..", "../linuxcnc", "linuxcnc/../linuxcnc", "/etc", ""] {
        let more = ["--templates", "templates"];
        compile(&named("plain"), target, &out, &more).refused("E0701");
        assert!(!out.exists());
    }
}

/// A target of the user's: a manifest and templates by file name.
fn target(folder: &Folder, files: &str, templates: &[(&str, &str)]) -> PathBuf {
    let own = folder.path("templates/own");
    std::fs::create_dir_all(&own).unwrap();
    let manifest = format!(
        "target: own\ntitle: own\nexpresses: x\ncannot: []\ncertainty: {{ syntax: {{ level: memory, source: x }}, \
         sign: {{ level: memory, source: x }} }}\nsign_test: x\nmechanism: {{ lattice: {{ max_nodes: 20000, corrects_rotary: false, \
         stored: correction, increment: {{ position_decimals: 3, correction_decimals: 5 }} }} }}\ncontroller: {{ lookup: command, \
         interpolation: linear, outside: hold, arithmetic: float64 }}\nfiles:\n{files}"
    );
    std::fs::write(own.join("target.yaml"), manifest).unwrap();
    for (name, text) in templates {
        std::fs::write(own.join(name), text).unwrap();
    }
    own
}

/// Three loops in each other around a text.
fn loops(text: &str) -> String {
    let start: String = ["a", "b", "c"].map(|name| format!("{{% for {name} in range(10000) %}}")).concat();
    format!("{start}{text}{}", "{% endfor %}".repeat(3))
}

const LATTICE: &str = "{{ columns | join(\",\") }}\n{% for row in rows %}{{ row }}\n{% endfor %}\n";

fn spec(path: &str, template: &str, layout: bool) -> String {
    let layout = if layout { ", layout: { format: csv_lattice }" } else { "" };
    format!("  - {{ path: \"{path}\", template: {template}, per: machine{layout} }}\n")
}

#[test]
fn a_target_of_ones_own_is_a_folder() {
    let folder = Folder::new();
    let machine = machine(&folder, "machine.yaml", EXX, "");
    target(&folder, &spec("own.csv", "own.j2", true), &[("own.j2", LATTICE)]);
    let templates = folder.path("templates");
    let more = ["--templates", templates.to_str().unwrap()];
    let out = folder.path("out");
    compile(&machine, "own", &out, &more).json();
    let text = std::fs::read_to_string(out.join("own.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("X [mm],Y [mm],Z [mm],dX [mm],dY [mm],dZ [mm]"));
    assert_eq!(lines.next(), Some("0.000,0.000,0.000,-0.00100,0.00000,0.00000"));
    verify(&machine, &out, &more).json();
    assert_eq!(lines.count(), 26);
}

#[test]
fn templates_that_would_do_harm() {
    let files = spec("own.csv", "own.j2", true);
    let bad = [
        (spec("../own.csv", "own.j2", true), LATTICE, "E0702"),
        (spec("/tmp/own.csv", "own.j2", true), LATTICE, "E0702"),
        (spec("below/own.csv", "own.j2", true), LATTICE, "E0702"),
        (spec(".own.csv", "own.j2", true), LATTICE, "E0702"),
        (spec("own.csv", "../own.j2", true), LATTICE, "E0703"),
        (spec("own.csv", "missing.j2", true), LATTICE, "E0101"),
        (files.clone() + "    unheard_of: 1\n", LATTICE, "E0703"),
        (files.clone(), "{{ unheard_of }}", "E0702"),
        (files.clone(), "{% include 'target.yaml' %}", "E0702"),
        (files.clone(), "{% for", "E0702"),
        (files.clone(), "X [mm],dX [mm]\n", "E0704"),
        // The written text must be the intended one.
        (files.clone(), "X [mm],Y [mm],Z [mm],dX [mm],dY [mm],dZ [mm]\n1,1,1,0,0,0\n", "E0707"),
        // Ten to the twelfth rounds; and as many bytes in few rounds.
        (files.clone(), &loops(""), "E0702"),
        (files.clone(), &loops(&"x".repeat(100_000)), "E0702"),
    ];
    for (files, template, code) in bad {
        let folder = Folder::new();
        let machine = machine(&folder, "machine.yaml", EXX, "");
        target(&folder, &files, &[("own.j2", template)]);
        folder.write("own.j2", LATTICE);
        let before = tree(&folder.path(""));
        let templates = folder.path("templates");
        let run = compile(&machine, "own", &folder.path("out"), &["--templates", templates.to_str().unwrap()]);
        assert_eq!(
            (run.code, run.err.contains(&format!("refused[{code}]"))),
            (Some(1), true),
            "{template}: {}",
            run.err
        );
        assert_eq!(tree(&folder.path("")), before, "{template}");
    }
}

#[test]
fn a_target_has_the_name_of_its_folder() {
    let folder = Folder::new();
    let machine = config("gantry-3ax.yaml");
    let own = folder.path("templates/own");
    std::fs::create_dir_all(&own).unwrap();
    for entry in std::fs::read_dir("templates/grid-csv").unwrap().map(Result::unwrap) {
        std::fs::copy(entry.path(), own.join(entry.file_name())).unwrap();
    }
    let templates = folder.path("templates");
    let more = ["--templates", templates.to_str().unwrap(), "--poses", "5"];
    // Found by fuzzing: the manifest of the set would name the target of the binary, and `verify` would judge by that.
    let run = compile(&machine, "own", &folder.path("out"), &more);
    run.refused("E0703").says("`grid-csv`").says("`own`");
    assert!(!folder.path("out").exists());
}

#[cfg(unix)]
#[test]
fn templates_that_are_links() {
    let folder = Folder::new();
    let machine = machine(&folder, "machine.yaml", EXX, "");
    let own = target(
        &folder,
        &(spec("own.csv", "own.j2", true) + &spec("secret.txt", "secret.j2", false)),
        &[("own.j2", LATTICE)],
    );
    std::os::unix::fs::symlink(folder.write("secret", "precious"), own.join("secret.j2")).unwrap();
    let templates = folder.path("templates");
    let run = compile(&machine, "own", &folder.path("out"), &["--templates", templates.to_str().unwrap()]);
    run.refused("E0703").says("secret.j2");
    assert!(!folder.path("out").exists());
}

/// From the text of a file to the bytes of another.
type Change<'a> = &'a dyn Fn(&str) -> Vec<u8>;

/// Changes a file of a set, and runs `verify` on it.
fn tampered(set: &(Folder, PathBuf, PathBuf), file: &str, change: impl Fn(&str) -> Vec<u8>) -> Run {
    let (_, machine, out) = set;
    let text = std::fs::read_to_string(out.join(file)).unwrap();
    let bytes = change(&text);
    assert_ne!(bytes, text.as_bytes(), "the change changes nothing");
    std::fs::write(out.join(file), bytes).unwrap();
    let run = verify(machine, out, &["--poses", "10"]);
    std::fs::write(out.join(file), text).unwrap();
    run
}

/// Everything that LinuxCNC would swallow in silence, with the place where it would.
#[test]
fn tables_that_the_controller_would_misread() {
    let set = compiled("linuxcnc");
    let (_, machine, out) = &set;
    let original = std::fs::read_to_string(out.join("joint_0_X.comp")).unwrap();
    assert_eq!(original.lines().count(), 3);
    // The line that is replaced or put in front of the one with this number, and the message.
    let cases: [(usize, &str, &str); 15] = [
        (1, "# comment", "stop reading"),
        (1, "", "0 numbers"),
        (2, "300.0,-0.004,-0.004", "stop reading"),
        (2, "300.0 -0,004 -0,004", "decimal comma"),
        (2, "300.0 nan -0.004", "not a finite number"),
        (2, "300.0 -0.004 inf", "not a finite number"),
        (3, "600.0 1e400 0.0", "not a finite number"),
        (2, "300.0 -0.004", "2 numbers"),
        (2, "300.0 -0.004 -0.004 7", "4 numbers"),
        (2, "700.0 -0.004 -0.004", "do not rise"),
        (2, "0.0 -0.004 -0.004", "do not rise"),
        (3, "nominal forward reverse", "not a number"),
        (2, "0x1p8 -0.004 -0.004", "not a number"),
        (1, "\u{feff}0.0 -0.001 -0.001", "not a number"),
        (2, "300.0 -0.004 \u{0660}", "not a number"),
    ];
    for (number, line, words) in cases {
        let change = |text: &str| {
            let mut lines: Vec<&str> = text.lines().collect();
            lines[number - 1] = line;
            (lines.join("\n") + "\n").into_bytes()
        };
        let run = tampered(&set, "joint_0_X.comp", change);
        // A line that does not rise may be the one that follows.
        let at = if words == "do not rise" && line.starts_with('7') { number + 1 } else { number };
        run.refused("E0704").says(words).says(&format!("joint_0_X.comp:{at}:"));
    }
    let bytes: [(Change, &str); 6] = [
        (&|_| Vec::new(), "empty"),
        (&|text| format!("\n{text}").into_bytes(), "0 numbers"),
        (&|text| text.as_bytes()[..text.len() - 12].to_vec(), "2 numbers"),
        (&|text| text.replacen(' ', &" ".repeat(300), 1).into_bytes(), "cut it in pieces"),
        (&|text| text.replace(' ', "\u{a0}").into_bytes(), "1 numbers"),
        (&|text| [text.as_bytes(), &[0xff, 0xfe]].concat(), "UTF-8"),
    ];
    for (change, words) in bytes {
        tampered(&set, "joint_0_X.comp", change).refused("E0704").says(words);
    }
    let rows = |n: usize| (0..n).map(|i| format!("{i}.5 0.0 0.0\n")).collect::<String>();
    tampered(&set, "joint_0_X.comp", |_| rows(257).into_bytes()).refused("E0704").says("joint_0_X.comp:257:");
    let run = tampered(&set, "joint_0_X.comp", |_| rows(256).into_bytes());
    assert_eq!(run.code, Some(0), "{}", run.err);
    // All is as before.
    assert_eq!(verify(machine, out, &[]).err, "");
}

#[test]
fn lattices_that_are_none() {
    let set = compiled("grid-csv");
    let lines = |change: &dyn Fn(&mut Vec<String>)| {
        tampered(&set, "corrections.csv", |text| {
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            change(&mut lines);
            (lines.join("\n") + "\n").into_bytes()
        })
    };
    let set_line = |number: usize, line: &'static str| lines(&move |all| all[number - 1] = line.into());
    let header = |header: &'static str| set_line(1, header);
    header("X [mm],Y [mm],Z [mm],dX [um],dY [mm],dZ [mm]").refused("E0704").says("dX");
    header("X,Y,Z,dX,dY,dZ").refused("E0704").says("corrections.csv:1:");
    header("X [mm],Y [mm],Q [mm],dX [mm],dY [mm],dZ [mm]").refused("E0704").says("`Q`");
    header("X [mm],dX [mm],Y [mm],Z [mm],dY [mm],dZ [mm]").refused("E0704").says("`Y`");
    header("X [mm],Y [mm],X [mm],dX [mm],dY [mm],dZ [mm]").refused("E0704").says("twice");
    header("X [mm],Y [mm],Z [mm],dX [mm],dX [mm],dZ [mm]").refused("E0704").says("twice");
    // A row that is missing, there twice, in another's place, cut, or of no node.
    for change in [(&|all: &mut Vec<String>| drop(all.remove(9))) as &dyn Fn(&mut Vec<String>), &|all| {
        all.insert(5, all[5].clone())
    }] {
        lines(change).refused("E0704");
    }
    for (one, other) in [(1, 2), (12, 13), (20, 27)] {
        lines(&|all| all.swap(one, other)).refused("E0704");
    }
    lines(&|all| all.truncate(27)).refused("E0704").says("26 rows");
    lines(&|all| all.truncate(1)).refused("E0704").says("no rows");
    set_line(15, "300.0,300.0,0.0,0.0,0.0").refused("E0704").says("corrections.csv:15:");
    set_line(15, "300.0,300.0,1.0,0.0,0.0,0.0").refused("E0704").says("corrections.csv:15:");
    set_line(15, "# a comment").refused("E0704").says("corrections.csv:15:");
    set_line(15, "").refused("E0704").says("corrections.csv:15:");
    set_line(15, "300.0,300.0,300.0,nan,0.0,0.0").refused("E0704").says("corrections.csv:15:");
    tampered(&set, "corrections.csv", |text| format!("\u{feff}{text}").into_bytes()).refused("E0704");
    tampered(&set, "corrections.csv", |_| Vec::new()).refused("E0704").says("empty");
}

#[test]
fn sets_that_are_not_whole() {
    let (folder, machine, out) = compiled("linuxcnc");
    std::fs::rename(out.join("joint_1_Y.comp"), folder.path("aside")).unwrap();
    verify(&machine, &out, &[]).refused("E0705").says("joint_1_Y.comp");
    std::fs::create_dir(out.join("joint_1_Y.comp")).unwrap();
    verify(&machine, &out, &[]).refused("E0704").says("joint_1_Y.comp");
    verify(&machine, &folder.path("nothing"), &[]).refused("E0705");
    verify(&machine, &machine, &[]).refused("E0705");
    verify(&machine, &out, &["--target", "grid-csv"]).refused("E0705").says("corrections.csv");
    verify(&machine, &out, &["--target", "nobody's"]).refused("E0701");
    // A manifest that names a target from elsewhere.
    let lock = std::fs::read_to_string(out.join("abbe.lock.json")).unwrap();
    for name in ["../../linuxcnc", "nobody"] {
        std::fs::write(out.join("abbe.lock.json"), lock.replace("\"linuxcnc\"", &format!("\"{name}\""))).unwrap();
        verify(&machine, &out, &[]).refused("E0701");
    }
}

/// Harmless defects are reported and read as they are; files found on a machine need no manifest.
#[test]
fn harmless_edits_are_warnings() {
    let set = compiled("linuxcnc");
    let (_, machine, out) = &set;
    let changes: [Change; 4] = [
        &|text| text.replace('\n', "\r\n").into_bytes(),
        &|text| text.replace(' ', "\t ").into_bytes(),
        &|text| text.trim_end().as_bytes().to_vec(),
        &|text| text.replacen("0.000000", "+0.", 1).into_bytes(),
    ];
    let plain = verify(machine, out, &["--poses", "10"]).json();
    for change in changes {
        let run = tampered(&set, "joint_0_X.comp", change);
        let mut json = run.json();
        assert_eq!(json["warnings"][0]["code"], "W0701");
        run.says("`joint_0_X.comp` has been edited");
        json.as_object_mut().unwrap().remove("warnings");
        assert_eq!(json, plain);
    }
    // Other numbers are other numbers.
    let run = tampered(&set, "joint_0_X.comp", |text| text.replace("-0.00", "-0.05").into_bytes());
    assert!(run.json()["compensated"]["position_um"]["max"].as_f64().unwrap() > 40.0);
    tampered(&set, "compensation.inc", |text| text.replace("COMP_FILE_TYPE = 1", "COMP_FILE_TYPE=1").into_bytes())
        .says("`compensation.inc` has been edited");
    // Tables of the other type have other columns.
    tampered(&set, "compensation.inc", |text| text.replace("COMP_FILE_TYPE = 1", "COMP_FILE_TYPE = 0").into_bytes())
        .says("only tables under `COMP_FILE_TYPE = 1`");
    std::fs::remove_file(out.join("abbe.lock.json")).unwrap();
    std::fs::remove_file(out.join("compensation.inc")).unwrap();
    let mut found = verify(machine, out, &["--poses", "10"]).json();
    found["files"] = plain["files"].clone();
    assert_eq!(found["warnings"][0]["code"], "W0703", "nobody can tell whether these were edited");
    found.as_object_mut().unwrap().remove("warnings");
    assert_eq!(found, plain);
}

/// Whatever we write we read, and know again as ours: 200,000 nodes of seven axes are over 20 MB. Blanks make a small
/// lattice as large.
#[test]
fn a_large_set_is_read_back() {
    let folder = Folder::new();
    let machine = machine(&folder, "machine.yaml", EXX, "");
    let fine = std::fs::read_to_string(&machine).unwrap().replace("step: 300", "step: 25");
    std::fs::write(&machine, fine).unwrap();
    let padded = LATTICE.replace("{{ row }}", &format!("{{{{ row }}}}{}", " ".repeat(1300)));
    target(&folder, &spec("own.csv", "own.j2", true), &[("own.j2", &padded)]);
    let (out, templates) = (folder.path("out"), folder.path("templates"));
    let more = ["--templates", templates.to_str().unwrap(), "--poses", "5"];
    let written = compile(&machine, "own", &out, &more).json();
    assert!(std::fs::metadata(out.join("own.csv")).unwrap().len() > 20_000_000);
    assert_eq!(verify(&machine, &out, &more).json(), written);
    // Another set of the same size in its place.
    let other = std::fs::read_to_string(&machine).unwrap().replace("4 um", "5 um");
    std::fs::write(&machine, other).unwrap();
    compile(&machine, "own", &out, &more).json();
}

#[test]
fn replays_of_what_is_no_position() {
    let (folder, machine, out) = compiled("linuxcnc");
    for row in ["0,forward", "0,sideways,3", "7,forward,3", "0,forward,nan", "-1,forward,3", "", "0,forward,3 mm"] {
        let asked = folder.write("asked.csv", &format!("joint,direction,position\n{row}\n"));
        let run = verify(&machine, &out, &["--replay", asked.to_str().unwrap()]);
        assert_eq!((run.code, run.err.contains("E0802")), (Some(1), true), "{row}: {}", run.err);
    }
    let run = Run::of(abbe().arg("verify").arg(&machine).arg(&out).args(["--replay", "nowhere.csv"]));
    run.refused("E0101");
}
