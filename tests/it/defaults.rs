//! Defaults that do not trip: a map without a volume, a list of targets that fits a terminal, folders that stay.

use super::program::{Folder, abbe, json, refused, text};

/// Five axes without a `volume`: the grid of the travels has 21 x 17 x 13 x 13 x 25 nodes, a million and a half.
pub(super) const FIVE: &str = "\
abbe: 1
machine: Five
chain: \"w C' A' b X Y Z t\"
axes:
  X: { travel: [0, 500], origin: [0, 0, 0] }
  Y: { travel: [0, 400], origin: [0, 0, 0] }
  Z: { travel: [-300, 0], origin: [0, 0, 0] }
  A: { travel: [-90, 90], origin: [250, 200, -300] }
  C: { travel: continuous, origin: [250, 200, -300] }
tool: { gauge: [250, 200, 0], length: 100 mm }
workpiece: { origin: [250, 200, -300] }
";

#[test]
fn a_map_without_a_volume_takes_a_spread() {
    let folder = Folder::new("defaults-map");
    let file = |errors: &str| folder.with("m.yaml", &format!("{FIVE}{errors}\n"));
    for errors in ["errors: { EXX: 5 um }", "tolerances: { EXX: 5 um }"] {
        let path = file(errors);
        let found = json(&["map", text(&path), "--samples", "2", "--format", "json"]);
        assert_eq!(found["poses"], 100_000, "{errors}");
        let words = abbe(&["map", text(&path), "--samples", "2"]);
        assert!(words.contains("100000 poses (low-discrepancy over the volume)"), "{words}");
    }
    // A grid that the file asks for is kept.
    let asked = file("volume: { X: { step: 26 mm } }\ntolerances: { EXX: 5 um }");
    let (code, said) = refused(&["map", text(&asked), "--samples", "2"]);
    assert!(code == 1 && said.contains("E0812"), "{said}");
}

#[test]
fn targets_are_one_a_line() {
    let all = json(&["targets", "--format", "json"]);
    let count = all["targets"].as_array().unwrap().len();
    let words = abbe(&["targets"]);
    assert_eq!(words.lines().count(), count + 1, "{words}");
    assert!(words.lines().all(|line| line.chars().count() <= 80), "{words}");
    let one = abbe(&["targets", "linuxcnc"]);
    assert!(one.starts_with("linuxcnc: ") && one.contains("\n  limits: ") && one.contains("\n  sign test: "), "{one}");
    assert_eq!(json(&["targets", "linuxcnc", "--format", "json"])["targets"].as_array().unwrap().len(), 1);
    let (code, said) = refused(&["targets", "linuxcn"]);
    assert!(code == 1 && said.contains("E0701") && said.contains("linuxcnc"), "{said}");
    assert!(abbe(&["--help"]).contains("\n  man "));
}

#[test]
fn the_set_of_another_target_or_machine_stays() {
    let folder = Folder::new("defaults-replace");
    let out = folder.file("out");
    let compile = |machine: &str, target: &str, more: &[&str]| {
        let few = ["--poses", "50", "--quiet"];
        let arguments = ["compile", machine, "--target", target, "--out", text(&out)];
        refused(&[&arguments[..], &few, more].concat())
    };
    let (one, other) = ("gantry-3ax.yaml", "vmc-cframe-754.yaml");
    assert_eq!(compile(one, "linuxcnc", &[]).0, 0);
    assert_eq!(compile(one, "linuxcnc", &[]).0, 0);
    let names = || {
        let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = names();
    for (machine, target) in [(one, "grid-csv"), (other, "linuxcnc")] {
        let (code, said) = compile(machine, target, &[]);
        assert!(code == 1 && said.contains("E0706") && said.contains("holds the set of `linuxcnc` for"), "{said}");
        assert!(said.contains("--replace"), "{said}");
        assert_eq!(names(), before);
    }
    assert_eq!(compile(one, "grid-csv", &["--replace"]).0, 0);
    assert_ne!(names(), before);
    assert_eq!(compile(one, "grid-csv", &[]).0, 0);
}

/// What the comparison of targets states is what the certificate of each states.
#[test]
fn targets_are_compared_by_their_certificates() {
    let found = json(&["targets", "gantry-3ax.yaml", "--format", "json"]);
    let targets = found["targets"].as_array().unwrap();
    let name = |of: &serde_json::Value| of["target"].as_str().unwrap().to_owned();
    let left = |of: &serde_json::Value| of["compensated"]["position_um"]["p95"].as_f64().unwrap();
    assert!(targets.windows(2).all(|pair| left(&pair[0]) <= left(&pair[1])), "{found}");
    let refused_targets = found["refused"].as_array().unwrap();
    assert_eq!(targets.len() + refused_targets.len(), abbe::controller::NAMES.len(), "{found}");
    let folder = Folder::new("defaults-targets");
    let out = folder.file("out");
    for of in targets.iter().chain(refused_targets) {
        let target = name(of);
        let set = ["compile", "gantry-3ax.yaml", "--target", &target, "--out", text(&out)];
        let compile = [&set[..], &["--accept-unverified", "--nothing-else", "--replace", "--quiet"]].concat();
        if let Some(code) = of["code"].as_str() {
            let (exit, said) = refused(&compile);
            assert!(exit == 1 && said.contains(&format!("refused[{code}]")), "{target}: {said}");
            continue;
        }
        let certificate = json(&[&compile[..], &["--format", "json"]].concat());
        for key in ["over", "uncompensated", "compensated"] {
            assert_eq!(of[key], certificate[key], "{target}");
        }
    }
    let words = abbe(&["targets", "gantry-3ax.yaml"]);
    assert!(words.starts_with("Least is left by ") && words.contains("No files for this machine:\n"), "{words}");
    assert!(words.lines().all(|line| line.chars().count() <= 80), "{words}");
}

/// Over a job the largest deviation decides; of a machine without values targets say what they correct.
#[test]
fn targets_are_compared_over_a_job_or_named_by_what_they_correct() {
    let folder = Folder::new("defaults-targets-job");
    let part = folder.with("part.csv", "x,y,z\n10,20,130\n-40,50,110\n");
    let found = json(&["targets", "gantry-3ax.yaml", "--tool-poses", text(&part), "--quiet", "--format", "json"]);
    let largest = |of: &serde_json::Value| of["compensated"]["position_um"]["max"].as_f64().unwrap();
    let targets = found["targets"].as_array().unwrap();
    assert!(targets.iter().all(|of| of["over"]["kind"] == "job" && of["over"]["poses"] == 2), "{found}");
    assert!(targets.windows(2).all(|pair| largest(&pair[0]) <= largest(&pair[1])), "{found}");
    let words = abbe(&["targets", "gantry-3ax.yaml", "--tool-poses", text(&part), "--quiet"]);
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("largest position deviation") && words.contains("Over a job of 2 tool poses"), "{words}");
    let bounded = FIVE.replace("machine: Five", "machine: Five\ntolerances: { EXX: 5 um }");
    let bounded = folder.with("bounded.yaml", &bounded);
    let words = abbe(&["targets", text(&bounded)]);
    assert!(words.starts_with("Nothing to correct yet") && words.contains("corrects, once it is measured"), "{words}");
    let (code, said) = refused(&["targets", "linuxcnc", "--tool-poses", text(&part)]);
    assert!(code == 2 && said.contains("abbe targets MACHINE"), "{said}");
}
