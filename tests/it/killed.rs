//! Runs that are killed: at every step that changes the folder of a set, by a shim before the C library that ends the
//! program there, and at times that nobody chose. Whatever happens, the next command finds the old set or the new one. And
//! runs that the program stops itself, when templates take all memory.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::oracle::program::Folder;
use crate::oracle::random::Random;
use crate::support::{Entry, Run, abbe, tree, verify};

/// Ends the process by SIGKILL at the n-th call that changes the files of a folder.
const SHIM: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void step(const char *path) {
    static int done;
    const char *last = getenv("KILL_AT"), *within = getenv("KILL_IN");
    if (last && within && strstr(path, within) && ++done == atoi(last)) kill(getpid(), SIGKILL);
}
int rename(const char *from, const char *to) {
    step(to);
    return ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
}
int unlink(const char *path) {
    step(path);
    return ((int (*)(const char *))dlsym(RTLD_NEXT, "unlink"))(path);
}
static int opened(const char *name, const char *path, int flags, int mode) {
    if (flags & O_CREAT) step(path);
    return ((int (*)(const char *, int, ...))dlsym(RTLD_NEXT, name))(path, flags, mode);
}
int open(const char *path, int flags, ...) {
    va_list rest; va_start(rest, flags); int mode = va_arg(rest, int); va_end(rest);
    return opened("open", path, flags, mode);
}
int open64(const char *path, int flags, ...) {
    va_list rest; va_start(rest, flags); int mode = va_arg(rest, int); va_end(rest);
    return opened("open64", path, flags, mode);
}
"#;

/// A small machine; errors that differ give sets that differ, and `C` a file that the other has not.
fn machine(folder: &Folder, name: &str, um: f64, with_c: bool) -> PathBuf {
    let (chain, c, ecc) = if with_c {
        ("w C' b X Y t", "\n  C: { travel: continuous }", "\n  ECC: { harmonics: { 1: [30 urad, 0 urad] } }")
    } else {
        ("w b X Y t", "", "")
    };
    folder.write(
        name,
        &format!(
            "abbe: 1\nmachine: example\nchain: \"{chain}\"\naxes:\n  X: {{ travel: [0 mm, 100 mm], origin: [0, 0, 0] }}\n  \
             Y: {{ travel: [0 mm, 80 mm], origin: [0, 0, 0] }}{c}\nerrors:\n  EXX: {{ points: [[0 mm, 0 um], [100 mm, {um} um]] }}\n  \
             EYY: {{ points: [[0 mm, 1 um], [80 mm, {um} um]] }}{ecc}\nvolume: {{ step: 50 mm }}\n"
        ),
    )
}

fn compile(machine: &Path, out: &Path) -> Command {
    let mut command = abbe();
    command.arg("compile").arg(machine).args(["--target", "linuxcnc", "--poses", "1", "--quiet", "--out"]).arg(out);
    command
}

type Files = BTreeMap<PathBuf, Entry>;

/// The files of a set compiled into a folder of its own, by name.
fn set(folder: &Folder, machine: &Path, name: &str) -> Files {
    let out = folder.path(name);
    assert_eq!(Run::of(&mut compile(machine, &out)).code, Some(0));
    relative(&out)
}

fn relative(out: &Path) -> Files {
    let files = tree(out).into_iter().filter(|(_, entry)| *entry != Entry::Folder);
    files.map(|(path, entry)| (path.strip_prefix(out).unwrap().to_owned(), entry)).collect()
}

/// What a run that was killed has left, by the files of the folder and by `verify`, which changes nothing: the old set,
/// the new one, or a set that is half replaced and refused.
fn settled(out: &Path, old: (&Path, &Files), new: (&Path, &Files)) -> &'static str {
    let before = relative(out);
    let run = verify(old.0, out, &["--poses", "1"]);
    assert_eq!(relative(out), before, "verify changes the folder");
    let temporary = |path: &PathBuf| path.to_string_lossy().ends_with(".abbe-set");
    if before.contains_key(Path::new(".abbe-set.json")) {
        run.refused("E0733");
        return "half";
    }
    let mut kept = before.clone();
    kept.retain(|path, _| !temporary(path));
    match (kept == *old.1, kept == *new.1) {
        (true, false) => {
            let touched = before.keys().any(temporary);
            assert_eq!(run.err.contains("W0713"), touched, "{}", run.err);
            if !old.1.is_empty() {
                assert_eq!(run.code, Some(0), "{}", run.err);
            }
            "old"
        }
        (false, true) => {
            // The machine of the new set reads it.
            assert_eq!(verify(new.0, out, &["--poses", "1"]).code, Some(0));
            "new"
        }
        _ => panic!("neither set: {:?}\n{}", kept.keys(), run.err),
    }
}

/// At every step, over an old set and into an empty folder.
#[test]
fn a_run_killed_at_any_step_leaves_one_whole_set() {
    let folder = Folder::new();
    let source = folder.write("shim.c", SHIM);
    let shim = folder.path("shim.so");
    let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&shim).arg(&source).arg("-ldl").status();
    assert!(built.unwrap().success(), "the C compiler that Rust links with");
    let machines = [machine(&folder, "old.yaml", 3.0, true), machine(&folder, "new.yaml", 7.0, false)];
    let sets = [set(&folder, &machines[0], "old-set"), set(&folder, &machines[1], "new-set")];
    let nothing = Files::new();
    for (label, old) in [("over", &sets[0]), ("into", &nothing)] {
        let mut seen = BTreeMap::new();
        for step in 1.. {
            assert!(step < 200, "the shim ends no run");
            let out = folder.path(&format!("{label}-{step}"));
            std::fs::create_dir_all(&out).unwrap();
            old.iter().for_each(|(path, entry)| {
                let Entry::File(bytes) = entry else { panic!("{path:?}") };
                std::fs::create_dir_all(out.join(path).parent().unwrap()).unwrap();
                std::fs::write(out.join(path), bytes).unwrap();
            });
            let mut run = compile(&machines[1], &out);
            run.env("LD_PRELOAD", &shim).env("KILL_AT", step.to_string()).env("KILL_IN", &out);
            let status = run.stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
            if status.success() {
                assert_eq!(relative(&out), sets[1]);
                break;
            }
            assert_eq!(status.signal(), Some(9));
            *seen.entry(settled(&out, (&machines[0], old), (&machines[1], &sets[1]))).or_insert(0) += 1;
            // Compiling again mends it, whichever set it is and in either order, and leaves nothing beside it.
            for order in [[0, 1], [1, 0]] {
                let copy = folder.path(&format!("{label}-{step}-again-{}", order[0]));
                std::fs::create_dir_all(&copy).unwrap();
                relative(&out).iter().for_each(|(path, entry)| {
                    let Entry::File(bytes) = entry else { panic!("{path:?}") };
                    std::fs::create_dir_all(copy.join(path).parent().unwrap()).unwrap();
                    std::fs::write(copy.join(path), bytes).unwrap();
                });
                for i in order {
                    let run = Run::of(&mut compile(&machines[i], &copy));
                    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
                    assert_eq!(relative(&copy), sets[i], "step {step}");
                    assert_eq!(verify(&machines[i], &copy, &["--poses", "1"]).code, Some(0));
                }
            }
        }
        println!("{label}: killed at {seen:?} steps");
        assert!(seen["old"] >= 4 && seen["half"] >= 4, "{seen:?}");
    }
}

/// At random times.
#[test]
fn a_run_killed_at_any_time_leaves_one_whole_set() {
    let folder = Folder::new();
    let machines = [machine(&folder, "old.yaml", 3.0, true), machine(&folder, "new.yaml", 7.0, false)];
    let sets = [set(&folder, &machines[0], "old-set"), set(&folder, &machines[1], "new-set")];
    let out = folder.path("out");
    let mut random = Random::new(5);
    for _ in 0..10 {
        assert_eq!(Run::of(&mut compile(&machines[0], &out)).code, Some(0));
        let mut run = compile(&machines[1], &out).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(random.below(60_000) as u64));
        let _ = run.kill();
        let _ = run.wait();
        let _ = settled(&out, (&machines[0], &sets[0]), (&machines[1], &sets[1]));
    }
}

/// A set that cannot be finished is refused, and compiling again mends it.
#[test]
fn what_cannot_be_finished_is_refused() {
    let folder = Folder::new();
    let machines = [machine(&folder, "old.yaml", 3.0, false), machine(&folder, "new.yaml", 7.0, false)];
    let out = folder.path("out");
    let list = |text: &str| {
        assert_eq!(Run::of(&mut compile(&machines[0], &out)).code, Some(0));
        std::fs::write(out.join(".abbe-set.json"), text).unwrap();
        verify(&machines[0], &out, &["--poses", "1"]).refused("E0733");
        assert_eq!(Run::of(&mut compile(&machines[1], &out)).code, Some(0));
        assert_eq!(verify(&machines[1], &out, &["--poses", "1"]).code, Some(0));
        assert!(!out.join(".abbe-set.json").exists());
    };
    list("{}");
    list("not a list");
    list(r#"{"run": 1, "files": [{"name": "../joint_0_X.comp", "sha256": "00", "before": null}], "removed": []}"#);
    list(r#"{"run": 1, "files": [{"name": "joint_0_X.comp", "sha256": "00"}]}"#);
}

/// A target of one's own whose one file is this, compiled over a folder that has a file already.
fn greedy(path: &str, template: &str) -> Run {
    let folder = Folder::new();
    let machine = machine(&folder, "machine.yaml", 3.0, false);
    let own = folder.path("templates/greedy");
    std::fs::create_dir_all(&own).unwrap();
    let manifest = "target: greedy\ntitle: x\nexpresses: x\ncannot: []\ncertainty: { syntax: { level: own format, source: x }, sign: { level: own format, source: x } }\n\
         sign_test: x\nmechanism: { own_axis: { max_points: 9, stored: correction, increment: { position_decimals: 3, correction_decimals: 6 } } }\n\
         controller: { lookup: command, interpolation: linear, outside: hold, arithmetic: float64 }\n\
         files: [{ path: 'PATH', template: all.j2, per: machine, layout: { format: lines, lines: [{ line: \"P <position> <value>\" }] } }]\n";
    std::fs::write(own.join("target.yaml"), manifest.replace("PATH", path)).unwrap();
    std::fs::write(own.join("all.j2"), template).unwrap();
    let (out, templates) = (folder.path("out"), folder.path("templates"));
    std::fs::create_dir(&out).unwrap();
    let _ = folder.write("out/kept", "kept");
    let mut run = abbe();
    run.arg("compile").arg(&machine).args(["--target", "greedy", "--templates"]).arg(&templates).arg("--out").arg(&out);
    let run = Run::of(&mut run);
    assert_eq!(crate::support::names(&out), ["kept"], "{template}");
    run
}

/// Fuel does not bound memory that doubles: a text, a list, the output of a filter.
#[test]
fn templates_that_take_all_memory_are_refused() {
    for step in ["ns.s ~ ns.s", "ns.s | replace('x', ns.s)", "[ns.s, ns.s] | join(ns.s)"] {
        let text = format!(
            "{{% set ns = namespace(s='xxxxxxxx') %}}{{% for i in range(60) %}}{{% set ns.s = {step} %}}{{% endfor %}}{{{{ ns.s }}}}"
        );
        greedy("all.txt", &text).refused("E0740").says("1 GiB");
    }
    // A usage error of the child is one of the program.
    let run = Run::of(abbe().args(["compile", "--templates", "."]));
    assert_eq!(run.code, Some(2));
}

/// Numbers that are not finite leave a template in no file, whoever made them.
#[test]
fn templates_write_no_number_that_is_not_finite() {
    for text in ["{{ 1e308 * 10 }}", "{{ -1e308 * 10 }}", "{{ 1e308 * 10 - 1e308 * 10 }}"] {
        greedy("all.txt", text).refused("E0542").says("a number of `all.txt` is not finite");
        greedy(text, "").refused("E0542").says("is not finite");
    }
}

/// The manifest of a set is not one of its files.
#[test]
fn templates_take_no_name_that_is_taken() {
    greedy("abbe.lock.json", "").refused("E0702").says("another file of the set is named `abbe.lock.json`");
}

/// Nor does it bound the cost of one step: much in few steps. A file's name has no such steps.
#[test]
fn templates_that_take_all_day_are_refused() {
    let large = "{% set ns = namespace(s='xy', n=0) %}{% for i in range(23) %}{% set ns.s = ns.s ~ ns.s %}{% endfor %}";
    let work = "{% for i in range(99999) %}{% set ns.n = ns.s | upper | replace('X', 'z') | length %}{% endfor %}";
    greedy("all.txt", &format!("{large}{work}")).refused("E0702").says("10 s of processor time");
    // A name has no functions, and no steps to double a text often.
    let name = "{% set ns = namespace(n=0) %}{% for i in range(99999) %}{% set ns.n = range(99999) | list | sort | length %}{% endfor %}all.txt";
    greedy(name, "").refused("E0702").says("unknown f");
    let double = format!("{{% set s = \"xx\" %}}{}{{{{ s }}}}", "{% set s = s ~ s %}".repeat(60));
    greedy(&double, "").refused("E0702").says("fuel");
    // Recursion without end, and values in each other that only their own end unwinds.
    greedy("all.txt", "{% macro m() %}{{ m() }}{% endmacro %}{{ m() }}").refused("E0702").says("recursion");
    let deep = "{% set ns = namespace(l=[]) %}{% for i in range(90000) %}{% set ns.l = [ns.l] %}{% endfor %}";
    let run = greedy("all.txt", deep);
    assert_eq!(run.code, Some(1), "{}", run.err);
}
