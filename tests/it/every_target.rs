//! Every target for every machine of configs/: files that read back and that `verify` and `diff` take, or a refusal
//! with reason and remedy. Nothing gets worse without a warning.

use rayon::prelude::*;
use std::sync::Mutex;

use crate::oracle::program::Folder;
use crate::support::{Run, abbe, compile, config, number, verify};

/// Targets whose tables cost up to seconds on a machine of six axes: one by turns for every second machine.
const HEAVY: [&str; 7] =
    ["sinumerik-cec", "fanuc-3d", "pmac", "sinumerik-enc", "twincat-axis", "heidenhain-com", "fanuc-pitch"];

/// Refusals of machines or numbers that a controller has no room for.
const WORDS: [&str; 6] = ["E0601", "E0603", "E0708", "E0709", "E0751", "E0752"];

/// The machines of 5axiskins and maxkins are in `kinematic_parameters`.
fn targets() -> Vec<&'static str> {
    let own_machine = |target: &&str| matches!(*target, "linuxcnc-5axiskins" | "linuxcnc-maxkins");
    abbe::controller::NAMES.into_iter().filter(|target| !own_machine(target)).collect()
}

/// Every target is written for one of the machines, by turns; refusals on the way to it are judged, too.
#[test]
fn every_target_for_some_config() {
    let names = names();
    let unwritten = |(turn, target): (usize, &'static str)| {
        let mut names = names.iter().cycle().skip(turn).take(names.len());
        (!names.any(|name| judge(name, target))).then_some(target)
    };
    let unwritten: Vec<_> = targets().into_par_iter().enumerate().filter_map(unwritten).collect();
    assert!(unwritten.is_empty(), "written for no machine of configs/: {unwritten:?}");
}

/// Every machine with a third of the light targets.
#[test]
#[ignore = "soak: two minutes of processor time"]
fn every_target_for_every_config() {
    // The only machine of that kind there, and one that the turns below leave out.
    let own = [("variants/tt-ac-800-direct.yaml", "linuxcnc-trt"), ("trunnion.yaml", "haas-mrzp")];
    let mut work: Vec<(String, &str)> = own.map(|(name, target)| (name.to_owned(), target)).to_vec();
    let light: Vec<&str> = abbe::controller::NAMES.into_iter().filter(|target| !HEAVY.contains(target)).collect();
    for (i, name) in names().into_iter().enumerate() {
        let turn = (0..light.len()).filter(|k| (i + k) % 3 == 0).map(|k| light[k]);
        let heavy = (i % 2 == 0).then(|| HEAVY[i / 2 % HEAVY.len()]);
        work.extend(turn.chain(heavy).map(|target| (name.clone(), target)));
    }
    let written = judged(work);
    for target in targets() {
        assert!(written.contains(&target), "{target}: written for no machine of configs/");
    }
}

fn names() -> Vec<String> {
    let others = ["robots/ur5.yaml", "lathes/lathe-xzc.yaml"];
    crate::configs::names().into_iter().chain(others.map(str::to_owned)).collect()
}

/// The same without turns.
#[test]
#[ignore = "soak: eight minutes of processor time"]
fn all_targets_for_all_configs() {
    let work = names().into_iter().flat_map(|name| abbe::controller::NAMES.map(|target| (name.clone(), target)));
    assert!(judged(work.collect()).len() > 300);
}

/// Targets of the sets that were written.
fn judged(work: Vec<(String, &'static str)>) -> Vec<&'static str> {
    let next = Mutex::new(work.into_iter());
    let written = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some((name, target)) = next.lock().unwrap().next() else { break };
                    if judge(&name, target) {
                        written.lock().unwrap().push(target);
                    }
                }
            });
        }
    });
    written.into_inner().unwrap()
}

/// Compiles and judges a set; true if it is written.
fn judge(name: &str, target: &str) -> bool {
    let (folder, machine) = (Folder::new(), config(name));
    let out = folder.path("out");
    let run = compile(&machine, target, &out, &["--accept-unverified", "--poses", "20", "--nodes", "300"]);
    if run.code != Some(0) {
        let known = WORDS.iter().any(|code| run.err.contains(&format!("refused[{code}]")));
        assert!(known && run.code == Some(1) && run.err.contains("help: "), "{name} {target}: {}", run.err);
        assert!(!out.exists() && run.out.starts_with("{\"refused\":true,"), "{name} {target}: files beside a refusal");
        return false;
    }
    let json = run.json();
    said_if_worse(&run, &json, &format!("{name} {target}"));
    let again = verify(&machine, &out, &["--poses", "20"]).json();
    assert_eq!(again["compensated"], json["compensated"], "{name} {target}");
    let mut diff = abbe();
    diff.arg("diff").arg(&machine).args([&out, &out]).args(["--format", "json", "--poses", "3"]);
    let moved = Run::of(&mut diff).json();
    assert_eq!(number(&moved, "/position_um/max"), 0.0, "{name} {target}");
    let off = verify(&machine, &out.join("restore"), &["--poses", "20"]).json();
    crate::restore_sets::off_is_bare(&off, &format!("{name} {target}"));
    true
}

/// The warning names the figures that are larger with the files than without, and only such.
fn said_if_worse(run: &Run, json: &serde_json::Value, of: &str) {
    for (key, word) in [("p95", "95 %"), ("rms", "rms"), ("max", "max")] {
        let [before, after] =
            ["uncompensated", "compensated"].map(|state| number(json, &format!("/{state}/position_um/{key}")));
        let way = json["direction"].as_str().unwrap();
        let said = json["raised"].as_array().unwrap().iter().any(|r| r["figure"] == word && r["direction"] == way);
        assert_eq!(said, after > 1.001 * before + 1e-3, "{of}: {word} {before} {after} {}", json["raised"]);
    }
    let raised = !json["raised"].as_array().unwrap().is_empty();
    let gone = number(json, "/compensated/position_um/rms") < 0.99 * number(json, "/uncompensated/position_um/rms");
    assert_eq!(run.err.contains("the tables raise"), raised, "{of}: {}", run.err);
    assert!(!(gone && run.err.contains("correct nothing")), "{of}: {}", run.err);
}
