//! Every system call with which a run changes files fails once, and once the run is killed before it: by `strace`, which
//! sees the calls that a shim before the C library misses. Afterwards each output is the old one or the new one, and the
//! next run writes the new one and leaves nothing beside it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::kinematic_parameters::table_table;
use crate::oracle::program::Folder;
use crate::support::{Entry, abbe, tree, verify};

/// Calls that change files or open them for that, with the errors that each is given.
const CALLS: [(&str, &[&str]); 15] = [
    ("open", &["EIO", "ENOSPC", "EACCES", "EMFILE"]),
    ("openat", &["EIO", "ENOSPC", "EACCES", "EMFILE"]),
    // A second handle of a file that is written.
    ("fcntl", &["EMFILE"]),
    ("write", &["EIO", "ENOSPC"]),
    ("pwrite64", &["EIO", "ENOSPC"]),
    ("fsync", &["EIO", "ENOSPC"]),
    ("fchmod", &["EIO", "EACCES"]),
    ("ftruncate", &["EIO", "ENOSPC"]),
    ("linkat", &["EIO", "ENOSPC", "EACCES"]),
    ("rename", &["EIO", "ENOSPC", "EACCES"]),
    ("renameat", &["EIO", "ENOSPC", "EACCES"]),
    ("unlink", &["EIO", "EACCES"]),
    ("unlinkat", &["EIO", "EACCES"]),
    ("mkdir", &["EIO", "ENOSPC", "EACCES"]),
    ("flock", &["EIO"]),
];

type Files = BTreeMap<PathBuf, Entry>;

/// A command in a folder of its own, with the outputs of an earlier run in it.
struct Job<'a> {
    folder: &'a Folder,
    /// Inputs, and outputs of the earlier run.
    old: Files,
    /// The same after the run.
    new: Files,
    arguments: Vec<&'static str>,
}

impl<'a> Job<'a> {
    /// Makes the inputs by `prepare` and the outputs of the run.
    fn new(folder: &'a Folder, arguments: &[&'static str], prepare: impl Fn(&Path)) -> Self {
        let at = folder.path("made");
        std::fs::create_dir(&at).unwrap();
        prepare(&at);
        let old = files(&at);
        let mut job = Self { folder, old, new: Files::new(), arguments: arguments.to_vec() };
        let run = job.command(&at, &[]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        job.new = files(&at);
        assert!(job.new != job.old, "{arguments:?} changes nothing");
        job
    }

    /// Runs the command, behind `strace` if it is given options.
    fn command(&self, at: &Path, strace: &[&str]) -> Output {
        let mut command = abbe();
        if !strace.is_empty() {
            let program = command.get_program().to_owned();
            command = Command::new("strace");
            command.args(["-qq"]).args(strace).arg(program);
        }
        command.args(&self.arguments).args(["--jobs", "1"]).current_dir(at).output().expect("strace")
    }

    /// Names of the calls that change files, each with its number among those of its name.
    fn calls(&self) -> Vec<(&'static str, usize)> {
        let (at, log) = (self.copy("traced"), self.folder.path("log"));
        let names = CALLS.map(|(name, _)| name).join(",");
        let run = self.command(&at, &["-o", log.to_str().unwrap(), "-e", &format!("trace={names}")]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut calls = Vec::new();
        for line in std::fs::read_to_string(log).unwrap().lines() {
            let Some((name, _)) = CALLS.into_iter().find(|(name, _)| line.starts_with(&format!("{name}("))) else {
                continue;
            };
            let count = counts.entry(name).or_default();
            *count += 1;
            // What the loader and the standard library open is no matter of ours.
            let foreign = ["/etc/", "/proc/", "/sys/", "/lib", "/usr/"];
            if !(name.starts_with("open") && foreign.iter().any(|path| line.contains(&format!("\"{path}")))) {
                calls.push((name, *count));
            }
        }
        calls
    }

    fn copy(&self, name: &str) -> PathBuf {
        let at = self.folder.path(name);
        let _ = std::fs::remove_dir_all(&at);
        for (path, entry) in &self.old {
            let Entry::File(bytes) = entry else { panic!("{path:?}") };
            std::fs::create_dir_all(at.join(path).parent().unwrap()).unwrap();
            std::fs::write(at.join(path), bytes).unwrap();
        }
        at
    }

    /// Runs with a fault in one call; returns what is there afterwards.
    fn faulty(&self, (name, number): (&str, usize), fault: &str) -> (Output, PathBuf) {
        let at = self.copy("faulty");
        let inject = format!("inject={name}:{fault}:when={number}");
        let run = self.command(&at, &["-o", "/dev/null", "-e", &format!("trace={name}"), "-e", &inject]);
        (run, at)
    }

    /// Every fault in every call; `judge` gets the files that a run has left.
    fn all(&self, judge: impl Fn(&str, &Output, &Path)) {
        let calls = self.calls();
        let kinds: BTreeSet<&str> = calls.iter().map(|(name, _)| *name).collect();
        assert!(["write", "fsync", "rename"].iter().all(|name| kinds.contains(name)), "{kinds:?}");
        let mut runs = 0;
        for call in calls {
            let errors = CALLS.iter().find(|(name, _)| *name == call.0).unwrap().1;
            let errors = errors.iter().map(|error| format!("error={error}"));
            for fault in errors.chain(["signal=SIGKILL".to_owned()]) {
                let what = format!("{:?}: {call:?} {fault}", self.arguments);
                let (run, at) = self.faulty(call, &fault);
                let code = run.status.code();
                assert!(fault.starts_with("signal") || matches!(code, Some(0 | 1 | 3)), "{what}: {code:?}");
                assert!(!text(&run.stderr).contains("panicked"), "{what}: {}", text(&run.stderr));
                if code.is_some_and(|code| code != 0) {
                    assert!(!run.stderr.is_empty(), "{what}: not a word");
                }
                judge(&what, &run, &at);
                let again = self.command(&at, &[]);
                assert_eq!(again.status.code(), Some(0), "{what}, again: {}", text(&again.stderr));
                let found = files(&at);
                assert!(found == self.new, "{what}, again: {:?}", found.keys());
                runs += 1;
            }
        }
        println!("{:?}: {runs} faults", self.arguments[0]);
    }

    /// The same where a temporary folder holds the new files.
    fn old_or_new_below(&self, what: &str, run: &Output, at: &Path) {
        let (found, killed) = (files(at), run.status.code().is_none());
        for (path, entry) in &found {
            let temporary = path.components().next().unwrap().as_os_str().to_str().unwrap().starts_with('.');
            let known = self.old.get(path) == Some(entry) || self.new.get(path) == Some(entry);
            assert!(known || temporary && killed, "{what}: {}", path.display());
        }
        assert!(run.status.code() != Some(0) || found == self.new, "{what}: success, and not the new files");
    }

    /// Each file is the old one, or the new one; besides there are temporary files only after a kill.
    fn old_or_new(&self, what: &str, run: &Output, at: &Path) {
        let found = files(at);
        for (path, entry) in &found {
            let temporary = path.file_name().unwrap().to_str().unwrap().starts_with('.');
            let known = self.old.get(path) == Some(entry) || self.new.get(path) == Some(entry);
            assert!(known || temporary && run.status.code().is_none(), "{what}: {}", path.display());
        }
        assert!(self.old.keys().all(|path| found.contains_key(path)), "{what}: {:?}", found.keys());
        // Success is the new files.
        assert!(run.status.code() != Some(0) || found == self.new, "{what}: success, and not the new files");
    }
}

fn files(at: &Path) -> Files {
    let all = tree(at).into_iter().filter(|(_, entry)| matches!(entry, Entry::File(_)));
    all.map(|(path, entry)| (path.strip_prefix(at).unwrap().to_owned(), entry)).collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn machine(um: f64, c: &str) -> String {
    format!(
        "abbe: 1\nmachine: example\nchain: w {}b X Y t\naxes:\n  X: {{ travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  \
         Y: {{ travel: [0 mm, 80 mm], origin: [0, 0, 0] }}\n{c}errors:\n  \
         EXX: {{ points: [[0 mm, 0 um], [100 mm, {um} um]] }}\n  EYY: {{ tolerance: {um} um }}\n\
         volume: {{ step: 50 mm }}\n",
        if c.is_empty() { "" } else { "C' " }
    )
}

const COMPILE: [&str; 8] = ["compile", "m.yaml", "--target", "linuxcnc", "--poses", "1", "--out", "out"];

/// The old set has a file that the new one has not.
#[test]
#[ignore = "needs strace; tests/run installs it"]
fn a_set_is_replaced_whole() {
    let folder = Folder::new();
    let job = Job::new(&folder, &COMPILE, |at| {
        let c = "  C: { travel: continuous, origin: [0, 0, 0] }\n";
        let more = "errors:\n  ECC: { harmonics: { 1: [30 urad, 0 urad] } }\n";
        std::fs::write(at.join("m.yaml"), machine(3.0, c).replace("errors:\n", more)).unwrap();
        let run = abbe().args(COMPILE).current_dir(at).output().unwrap();
        assert!(run.status.success(), "{}", text(&run.stderr));
        std::fs::write(at.join("m.yaml"), machine(7.0, "")).unwrap();
    });
    assert!(job.old.keys().any(|path| !job.new.contains_key(path)));
    job.all(|what, run, at| {
        let (out, code) = (at.join("out"), run.status.code());
        let found = files(at);
        let plain = |files: &Files| -> Files {
            let ours = |path: &&PathBuf| !path.to_str().unwrap().ends_with(".abbe-set");
            files.iter().filter(|(path, _)| ours(path)).map(|(path, entry)| (path.clone(), entry.clone())).collect()
        };
        let mut found_plain = plain(&found);
        // A file of the old set that cannot go is named, and listed in the manifest.
        if text(&run.stderr).contains("W0707") {
            found_plain.retain(|path, _| job.new.contains_key(path));
            let new = &job.new;
            // The manifest beside it, of the set or of the one that takes it back.
            let listing = ["out/abbe.lock.json", "out/restore/abbe.lock.json"].map(Path::new).map(|lock| {
                let listed = found_plain.insert(lock.to_owned(), new[lock].clone());
                matches!(listed, Some(Entry::File(bytes)) if text(&bytes).contains("stale"))
            });
            assert!(listing.contains(&true), "{what}");
            assert!(found_plain == *new, "{what}: {:?}", found.keys());
            return;
        }
        // A half replaced set is refused.
        if found.contains_key(Path::new("out/.abbe-set.json")) {
            assert_ne!(code, Some(0), "{what}");
            verify(&at.join("m.yaml"), &out, &["--poses", "1"]).refused("E0733");
            return;
        }
        assert!(found_plain == job.old || found_plain == job.new, "{what}: {:?}", found.keys());
        assert!(code != Some(0) || found_plain == job.new, "{what}: success, and not the new set");
        assert!(code.is_none() || found_plain.len() == found.len(), "{what}: {:?}", found.keys());
    });
}

/// The sets of two targets are one set: parameters of one run are never certified with the tables of another.
#[test]
#[ignore = "needs strace; tests/run installs it"]
fn sets_of_two_targets_are_replaced_as_one() {
    let folder = Folder::new();
    let targets = ["--target", "sinumerik-traori", "--target", "sinumerik-cec"];
    let arguments =
        [&["compile", "m.yaml"][..], &targets, &["--accept-unverified", "--poses", "1", "--out", "out"]].concat();
    let job = Job::new(&folder, &arguments, |at| {
        let text = |um: f64| {
            let errors = format!("  EX0C: {um} um\n  EXX: {{ points: [[0 mm, 0 um], [500 mm, {um} um]] }}\n");
            table_table(&errors).replace("  X: { ", "  X: { origin: [0, 0, 0], ")
                + "volume: { step: 500 mm, A: { step: 90 deg }, C: { step: 180 deg } }\n"
        };
        std::fs::write(at.join("m.yaml"), text(3.0)).unwrap();
        let run = abbe().args(&arguments).current_dir(at).output().unwrap();
        assert!(run.status.success(), "{}", self::text(&run.stderr));
        std::fs::write(at.join("m.yaml"), text(7.0)).unwrap();
    });
    job.all(|what, run, at| {
        let (found, code) = (files(at), run.status.code());
        if found.keys().any(|path| path.ends_with(".abbe-set.json")) {
            assert_ne!(code, Some(0), "{what}");
            verify(&at.join("m.yaml"), &at.join("out"), &["--poses", "1"]).refused("E0733");
            return;
        }
        let ours = |path: &&PathBuf| !path.to_str().unwrap().ends_with(".abbe-set");
        let plain = |of: &Files| found.keys().filter(ours).all(|path| of.get(path) == found.get(path));
        assert!(plain(&job.old) || plain(&job.new), "{what}: {:?}", found.keys());
        assert!(code != Some(0) || found == job.new, "{what}: success, and not the new sets");
    });
}

#[test]
#[ignore = "needs strace; tests/run installs it"]
fn a_fitted_machine_is_written_whole() {
    let folder = Folder::new();
    let arguments = ["identify", "m.yaml", "--data", "r.csv", "--fit", "EXX:poly2", "--quiet", "--out", "f.yaml"];
    let job = Job::new(&folder, &arguments, |at| {
        std::fs::write(at.join("m.yaml"), machine(3.0, "")).unwrap();
        std::fs::write(at.join("r.csv"), "X [mm],dx [um]\n0,0\n20,1.1\n40,2\n60,2.8\n80,4.1\n100,5\n").unwrap();
        std::fs::write(at.join("f.yaml"), "old\n").unwrap();
    });
    job.all(|what, run, at| job.old_or_new(what, run, at));
}

#[test]
#[ignore = "needs strace; tests/run installs it"]
fn maps_are_written_whole() {
    let folder = Folder::new();
    let arguments = [
        "map",
        "m.yaml",
        "--quiet",
        "--csv",
        "m.csv",
        "--json",
        "m.json",
        "--vtk",
        "m.vtk",
        "--parquet",
        "m.parquet",
        "--plane",
        "XY",
        "--svg",
        "m.svg",
    ];
    let job = Job::new(&folder, &arguments, |at| {
        std::fs::write(at.join("m.yaml"), machine(3.0, "")).unwrap();
        for end in ["csv", "json", "vtk", "parquet", "svg"] {
            std::fs::write(at.join(format!("m.{end}")), "old").unwrap();
        }
    });
    job.all(|what, run, at| job.old_or_new(what, run, at));
}

/// The state of a study grows; a run that goes on from what another has left gives the same.
#[test]
#[ignore = "needs strace; tests/run installs it"]
fn a_study_goes_on_from_what_is_left() {
    let folder = Folder::new();
    let arguments =
        ["enumerate", "m.yaml", "--poses", "3", "--samples", "4", "--max-samples", "4", "--quiet", "--state", "s.json"];
    let job = Job::new(&folder, &arguments, |at| std::fs::write(at.join("m.yaml"), machine(3.0, "")).unwrap());
    job.all(|_, _, _| {});
}

/// A record is there whole or not at all.
#[test]
#[ignore = "needs strace; tests/run installs it"]
fn a_record_is_written_whole() {
    let folder = Folder::new();
    let arguments = ["record", "r.yaml", "--quiet", "--out", "out"];
    let job = Job::new(&folder, &arguments, |at| {
        let description = "record: 1\nid: R\ndates: { begin: 2026-11-02, end: 2026-11-02 }\ncountry: DE\nplace: other\n\
            laboratory: { name: L, city: C }\ncustomer: { name: L, city: C }\npersons: [{ name: P }]\n\
            machine: { serial: S }\nas_found: m.yaml\ndata: [r.csv]\n\
            instruments: [{ name: I, serial: S, certificate: C, calibrated: 2026-01-01, uncertainty: 1 um }]\n";
        std::fs::write(at.join("m.yaml"), machine(3.0, "")).unwrap();
        std::fs::write(at.join("r.csv"), "1\n").unwrap();
        std::fs::write(at.join("r.yaml"), description).unwrap();
    });
    let inside = |files: &Files| files.iter().filter(|(path, _)| path.starts_with("out")).count();
    job.all(|what, run, at| {
        job.old_or_new_below(what, run, at);
        let found = inside(&files(at));
        assert!(found == 0 || found == inside(&job.new), "{what}: {found} files");
    });
}
