//! Folders that somebody else filled: manifests, lists and links that lead the program to files that are not its own.
//! Nothing is removed or replaced but what the manifest of the old set lists, with the bytes that it lists.

use serde_json::json;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::oracle::program::Folder;
use crate::support::sha256::sha256;
use crate::support::{Run, abbe, compile, tree, verify};

const FEW: [&str; 2] = ["--poses", "1"];

/// A small machine; `with_c` gives its set one more file.
fn machine(path: &Path, um: f64, with_c: bool) {
    let (chain, c, ecc) = if with_c {
        (
            "w C' b X t",
            "\n  C: { controller: 2, travel: continuous, origin: [0, 0, 0] }",
            "\n  ECC: { harmonics: { 1: [30 urad, 0 urad] } }",
        )
    } else {
        ("w b X t", "", "")
    };
    let text = format!(
        "abbe: 1\nmachine: example\nchain: \"{chain}\"\naxes:\n  X: {{ controller: 1, travel: [0 mm, 100 mm], origin: [0, 0, 0] }}{c}\n\
         errors:\n  EXX: {{ points: [[0 mm, 0 um], [100 mm, {um} um]] }}{ecc}\n"
    );
    std::fs::write(path, text).unwrap();
}

fn hashed(folder: &Path, name: &str) -> serde_json::Value {
    let bytes = std::fs::read(folder.join(name)).unwrap_or_default();
    json!({ "name": name, "sha256": sha256(&bytes) })
}

/// A set in `out`, a machine file with a curve beside it, and a file of the user's.
fn handed_over(folder: &Folder) -> (PathBuf, PathBuf) {
    let out = folder.path("out");
    std::fs::create_dir_all(&out).unwrap();
    let (old, own) = (folder.path("old.yaml"), out.join("machine.yaml"));
    machine(&old, 3.0, true);
    machine(&own, 7.0, false);
    std::fs::write(out.join("notes.txt"), "years of work").unwrap();
    assert_eq!(compile(&old, "linuxcnc", &out, &FEW).code, Some(0));
    (own, out)
}

/// Adds entries to the manifest of a set.
fn forge(out: &Path, add: &[serde_json::Value]) {
    let path = out.join("abbe.lock.json");
    let mut lock: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    lock["files"].as_array_mut().unwrap().extend(add.iter().cloned());
    std::fs::write(path, lock.to_string()).unwrap();
}

#[test]
fn readers_change_nothing_whatever_a_list_asks_for() {
    let folder = Folder::new();
    let (own, out) = handed_over(&folder);
    let forged = |files: serde_json::Value| {
        let removed = json!([hashed(&out, "machine.yaml"), hashed(&out, "notes.txt"), hashed(&out, "joint_0_X.comp")]);
        std::fs::write(out.join(".abbe-set.json"), json!({ "run": 1, "files": files, "removed": removed }).to_string())
            .unwrap();
    };
    let new =
        json!({ "name": "notes.txt", "sha256": sha256(b"theirs"), "before": hashed(&out, "notes.txt")["sha256"] });
    std::fs::write(out.join(".notes.txt.1.abbe-set"), "theirs").unwrap();
    let text = out.to_str().unwrap();
    for files in [json!([]), json!([new])] {
        forged(files);
        let before = tree(&out);
        verify(&own, &out, &FEW).refused("E0733");
        Run::of(abbe().arg("diff").arg(&own).arg(&out).arg(&out)).refused("E0733");
        let more = [&FEW[..], &["--installed", text]].concat();
        compile(&own, "linuxcnc", &folder.path("sum"), &more).refused("E0733");
        assert_eq!(tree(&out), before);
    }
    // Nor does a compile into the folder, but for the set: it mends what the list says is half done.
    let run = compile(&own, "linuxcnc", &out, &FEW);
    assert_eq!(run.code, Some(0), "{}", run.err);
    run.says("W0712");
    assert_eq!(std::fs::read(out.join("notes.txt")).unwrap(), b"years of work");
    assert!(own.exists() && !out.join(".abbe-set.json").exists());
    assert!(!out.join("joint_1_C.comp").exists() && out.join("joint_0_X.comp").exists());
}

#[test]
fn a_manifest_gives_no_right_to_sources_and_to_files_of_no_target() {
    let folder = Folder::new();
    let (own, out) = handed_over(&folder);
    // The machine file under a name that the target writes.
    let source = out.join("joint_7_A.comp");
    std::fs::rename(&own, &source).unwrap();
    forge(&out, &[hashed(&out, "joint_7_A.comp"), hashed(&out, "notes.txt")]);
    let run = compile(&source, "linuxcnc", &out, &FEW);
    run.says("W0707").says("it is an input of this run").says("it is no file that the target `linuxcnc` writes");
    assert!(run.code == Some(0) && source.exists() && out.join("notes.txt").exists());
    assert!(!out.join("joint_1_C.comp").exists());
    let lock: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("abbe.lock.json")).unwrap()).unwrap();
    let stale: Vec<&str> = lock["stale"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(stale, ["joint_7_A.comp", "notes.txt"]);
    let run = verify(&source, &out, &FEW);
    assert_eq!(run.code, Some(0));
    run.says("`joint_7_A.comp` is of an earlier set and still there");
    // A new set does not replace a source either.
    let over = out.join("joint_0_X.comp");
    std::fs::rename(&source, &over).unwrap();
    let before = std::fs::read(&over).unwrap();
    forge(&out, &[hashed(&out, "joint_0_X.comp")]);
    compile(&over, "linuxcnc", &out, &FEW).refused("E0630");
    assert_eq!(std::fs::read(&over).unwrap(), before);
}

#[test]
fn manifests_that_lead_elsewhere_are_refused() {
    let folder = Folder::new();
    let (own, out) = handed_over(&folder);
    let lock = std::fs::read(out.join("abbe.lock.json")).unwrap();
    std::fs::write(folder.path("mine.txt"), "mine").unwrap();
    let absolute = folder.path("mine.txt").display().to_string();
    for name in ["../mine.txt", absolute.as_str(), "out/../../mine.txt", ".", ""] {
        std::fs::write(out.join("abbe.lock.json"), &lock).unwrap();
        forge(&out, &[json!({ "name": name, "sha256": sha256(b"mine") })]);
        let before = tree(&folder.path(""));
        verify(&own, &out, &FEW).refused("E0734");
        Run::of(abbe().arg("diff").arg(&own).arg(&out).arg(&out)).refused("E0734");
        compile(&own, "linuxcnc", &out, &FEW).refused("E0734");
        assert_eq!(tree(&folder.path("")), before, "{name}");
    }
    // A table that is a link, and a manifest that is one.
    std::fs::write(out.join("abbe.lock.json"), &lock).unwrap();
    let table = out.join("joint_0_X.comp");
    std::fs::rename(&table, folder.path("elsewhere.comp")).unwrap();
    symlink("../elsewhere.comp", &table).unwrap();
    verify(&own, &out, &FEW).refused("E0734").says("is a link");
    compile(&own, "linuxcnc", &out, &FEW).refused("E0706");
    std::fs::rename(out.join("abbe.lock.json"), folder.path("lock.json")).unwrap();
    symlink("../lock.json", out.join("abbe.lock.json")).unwrap();
    // The link is not followed: without a manifest all files count, those for the joint of the former machine too.
    verify(&own, &out, &[&FEW[..], &["--target", "linuxcnc"]].concat()).refused("E0704").says("no axis for joint 1");
    compile(&own, "linuxcnc", &out, &FEW).refused("E0706");
    assert_eq!(std::fs::read(folder.path("elsewhere.comp")).unwrap().len(), folder_len(&folder));
}

fn folder_len(folder: &Folder) -> usize {
    std::fs::metadata(folder.path("elsewhere.comp")).unwrap().len() as usize
}

/// An edited table of the old set stays, is named, and is repeated until it is gone.
#[test]
fn what_cannot_go_is_named_until_it_is_gone() {
    let folder = Folder::new();
    let (own, out) = handed_over(&folder);
    let edited = out.join("joint_1_C.comp");
    std::fs::write(&edited, "0 1 1\n").unwrap();
    for _ in 0..2 {
        compile(&own, "linuxcnc", &out, &FEW).says("W0707").says("it has been changed since abbe wrote it");
        verify(&own, &out, &FEW).says("W0707").says("joint_1_C.comp");
    }
    std::fs::remove_file(&edited).unwrap();
    for run in [verify(&own, &out, &FEW), compile(&own, "linuxcnc", &out, &FEW), verify(&own, &out, &FEW)] {
        assert!(run.code == Some(0) && !run.err.contains("W0707"), "{}", run.err);
    }
    assert!(!std::fs::read_to_string(out.join("abbe.lock.json")).unwrap().contains("stale"));
}

/// A text that stands for a file of the disk is where that file is.
#[test]
fn texts_of_a_page_are_in_the_folder_of_their_file() {
    let folder = Folder::new();
    let path = folder.path("m.yaml");
    machine(&path, 3.0, false);
    std::fs::create_dir(folder.path("other")).unwrap();
    let _ = folder.write("other/x.csv", "X [mm],EYX [um]\n0,0\n100,2\n");
    let text = std::fs::read_to_string(&path).unwrap() + "measured: [other/x.csv, new.csv, ../x.csv]\n";
    let new = "X [mm],EZX [um]\n0,0\n100,2\n";
    let above = path.parent().unwrap().join("../x.csv");
    let texts = json!({&*path.to_string_lossy(): text, &*folder.path("new.csv").to_string_lossy(): new,
        &*above.to_string_lossy(): new.replace("EZX [um]", "EAX [urad]")});
    let request = json!({"machine": path, "texts": texts, "questions": ["show"]}).to_string();
    let found = abbe::workbench(&request, abbe::Run::on_disk());
    let inputs = found["answers"][0]["inputs"].as_array().unwrap_or_else(|| panic!("{found}"));
    let outside: Vec<&serde_json::Value> = inputs.iter().map(|input| &input["outside"]).collect();
    assert_eq!(outside, [false, false, false, true], "{inputs:?}");
}

/// Files of others are named under `inputs`, and refused with `--confined`.
#[test]
fn files_outside_the_folder_are_listed_and_can_be_refused() {
    let folder = Folder::new();
    let inside = folder.path("theirs");
    std::fs::create_dir(&inside).unwrap();
    let _ = folder.write("base.yaml", "errors: { EXX: { points: [[0 mm, 0 um], [100 mm, 3 um]] } }\n");
    let _ = folder.write("x.csv", "X [mm],EYX [um]\n0,0\n100,2\n");
    symlink("../x.csv", inside.join("link.csv")).unwrap();
    let own = folder.write(
        "theirs/m.yaml",
        "abbe: 1\nextends: ../base.yaml\nmachine: m\nchain: w b X t\naxes: { X: { controller: 1, travel: [0, 100], origin: [0, 0, 0] } }\nmeasured: [link.csv]\n",
    );
    let shown = |verb: &str, more: &[&str]| Run::of(abbe().arg(verb).arg(&own).args(more).current_dir(&inside));
    for verb in ["show", "check"] {
        let json = shown(verb, &["--format", "json"]).json();
        let inputs = json["inputs"].as_array().unwrap();
        let listed: Vec<(bool, bool)> = inputs
            .iter()
            .map(|input| {
                let file = PathBuf::from(input["file"].as_str().unwrap());
                assert_eq!(input["sha256"], sha256(&std::fs::read(&file).unwrap()));
                (file == own, input["outside"].as_bool().unwrap())
            })
            .collect();
        assert_eq!(listed, [(true, false), (false, true), (false, true)], "{verb}");
        // `check` asks about geometry, too.
        assert!(verb == "check" || json["warnings"].is_null(), "{verb}");
    }
    let text = shown("show", &[]);
    assert!(text.out.contains("Inputs outside the folder of the machine file:") && text.err.is_empty(), "{}", text.err);
    let root = inside.to_str().unwrap();
    let run = shown("check", &["--confined", root]);
    run.refused("E0819").says(root).says("base.yaml");
    // Through a link alone, and a file that is not there.
    let _ = folder.write(
        "theirs/n.yaml",
        "abbe: 1\nmachine: m\nchain: w b X t\naxes: { X: { controller: 1, travel: [0, 100], origin: [0, 0, 0] } }\nmeasured: [link.csv]\n",
    );
    for (name, table) in [("n.yaml", "link.csv"), ("o.yaml", "../none.csv"), ("p.yaml", "/etc/passwd")] {
        let text = std::fs::read_to_string(inside.join("n.yaml")).unwrap().replace("link.csv", table);
        std::fs::write(inside.join(name), text).unwrap();
        let run = Run::of(abbe().args(["check", name, "--confined", "."]).current_dir(&inside));
        run.refused("E0819");
        assert!(!run.err.contains("root:"), "{}", run.err);
    }
    // All of it inside: nothing to refuse. Sets are confined too.
    let all = folder.path("").display().to_string();
    assert_eq!(shown("check", &["--confined", &all]).code, Some(0));
    let run = Run::of(abbe().arg("verify").arg(&own).arg("/tmp").args(["--confined", &all]));
    run.refused("E0819");
    assert_eq!(Run::of(abbe().arg("check").arg(&own).args(["--confined", "/none"])).code, Some(2));
}

/// The kernel's own files, FIFOs and devices are refused at once, wherever a path may stand.
#[test]
fn what_is_no_file_on_disk_is_refused_at_once() {
    let folder = Folder::new();
    let own = folder.path("m.yaml");
    machine(&own, 3.0, false);
    let fifo = folder.path("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    for path in ["/proc/kmsg", "/proc/self/environ", "/sys/kernel/uevent_seqnum", "/dev/zero", fifo.to_str().unwrap()] {
        if !Path::new(path).exists() {
            continue;
        }
        let verbs: [&[&str]; 5] = [
            &["check", path],
            &["map", "m.yaml", "--tool-poses", path],
            &["identify", "m.yaml", "--data", path],
            &["classify", path],
            &["verify", "m.yaml", ".", "--replay", path],
        ];
        for arguments in verbs {
            let begin = Instant::now();
            let mut child = abbe()
                .args(arguments)
                .current_dir(folder.path(""))
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            while child.try_wait().unwrap().is_none() {
                assert!(begin.elapsed() < Duration::from_secs(20), "{arguments:?} blocks");
                std::thread::sleep(Duration::from_millis(5));
            }
            let output = child.wait_with_output().unwrap();
            let err = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.code() == Some(1) && err.contains("help: "), "{arguments:?}: {err}");
        }
    }
    let _ = std::fs::set_permissions(&fifo, std::fs::Permissions::from_mode(0o600));
}
