//! What `check` asks about geometry that is allowed and seldom meant, and nowhere else.

use super::program::{Folder, text};
use abbe::diagnostic::{Rendering, render};
use abbe::{LoadOptions, Run, check, load};
use std::path::{Path, PathBuf};

const SOUND: &str = "\
abbe: 1
machine: Sound
chain: \"w C' A' Y' b X Z t\"
axes:
  X: { travel: [0 mm, 500 mm] }
  Y: { travel: [0 mm, 450 mm] }
  Z: { travel: [-400 mm, 0 mm] }
  A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350] }
  C: { travel: continuous, origin: [250, 225, -380] }
tool: { gauge: [0, 0, 0], length: 120 mm }
workpiece: { origin: [250, 225, -380] }
errors: { EX0C: 6 um }
";

/// Codes and text of what `check` says.
fn asked(file: &Path) -> (Vec<&'static str>, String) {
    let checked = check([file], Run::on_disk()).remove(0);
    assert!(!checked.refused());
    (checked.diagnostics.iter().map(|d| d.code.id).collect(), render(&checked.diagnostics, Rendering::default()))
}

/// What `check` asks if a part of the sound file is another one.
fn with(folder: &Folder, from: &str, to: &str) -> (Vec<&'static str>, String) {
    let changed = SOUND.replace(from, to);
    assert!(changed != SOUND || from == to, "{from}");
    let file = folder.with("m.yaml", &changed);
    // Other verbs take it as it stands.
    assert_eq!(load(&file, &LoadOptions::default(), Run::on_disk()).unwrap().warnings.count(), 0, "{to}");
    asked(&file)
}

#[test]
fn geometry_is_questioned() {
    let folder = Folder::new("questions");
    assert!(with(&folder, "", "").0.is_empty());
    for (from, to, code, words) in [
        (
            "tool: { gauge: [0, 0, 0], length: 120 mm }\n",
            "",
            "W0413",
            "no `tool`: gauge point and tip lie at machine zero",
        ),
        ("workpiece: { origin: [250, 225, -380] }\n", "", "W0413", "no `workpiece`: its origin lies at machine zero"),
        (", origin: [250, 225, -350]", "", "W0405", "axis `A` has a line and no `origin`"),
        // The tip goes from z = -120 down to -520 mm.
        ("-380] }\nerrors", "-80] }\nerrors", "W0413", "stays 40 mm below the workpiece origin along the tool axis"),
        ("length: 120 mm", "length: 400 mm", "W0413", "stays 20 mm below the workpiece origin"),
        ("-380] }\nerrors", "-1000] }\nerrors", "W0413", "stays 480 mm above the workpiece origin"),
        // X takes it from x = 0 to 500 mm.
        ("gauge: [0, 0, 0]", "gauge: [-300, 0, 0]", "W0413", "stays 50 mm beside the workpiece origin along X"),
        ("gauge: [0, 0, 0]", "gauge: [0, 235, 0]", "W0413", "stays 10 mm beside the workpiece origin along Y"),
        (
            "origin: [250, 225, -350]",
            "origin: [250, 225, 350]",
            "W0413",
            "the line of `A` is 730 mm from the workpiece origin at the zero pose",
        ),
        ("{ EX0C: 6 um }", "{ EC0X: 12 urad, EC0Y: -12 urad }", "W0413", "their difference is the squareness"),
        (", length: 120 mm", "", "W0413", "the tool has no length"),
        ("[-120 deg, 30 deg]", "[-2.0944, 0.5236]", "W0413", "from -2.0944 to 0.5236 deg: are these radians?"),
        ("[-400 mm, 0 mm]", "[0 mm, 400 mm]", "W0413", "stays 260 mm above the workpiece origin along the tool axis"),
        ("[0 mm, 500 mm]", "[0 in, 20 in]", "W0413", "`axes.C.origin` has 250 without a unit, which is mm"),
        (
            "[250, 225, -380] }\nerrors",
            "[250, 600, -380] }\nup: [0, 1, 0]\nerrors",
            "W0413",
            "below the workpiece origin along `up`",
        ),
        ("EX0C: 6 um", "EX0C: 2.5 mm", "W0413", "`EX0C` is 2.5 mm: is it the place where axis `C` stands"),
        (
            "EX0C: 6 um",
            "EXX: { points: [[0 mm, 0 um], [100 mm, 2 um], [200 mm, 900 um], \
             [300 mm, 6 um], [350 mm, 8 um], [400 mm, 8 um], [450 mm, 9 um], [500 mm, 10 um]] }",
            "W0413",
            "`EXX` is 900 um at 200 mm, 896 um off the line through its neighbours",
        ),
        (
            "EX0C: 6 um",
            "EXX: { points: [[0 mm, -300 um], [100 mm, 2 um], [200 mm, 4 um], \
             [300 mm, 6 um], [350 mm, 8 um], [400 mm, 8 um], [450 mm, 9 um], [500 mm, 10 um]] }",
            "W0413",
            "`EXX` is -300 um at 0 mm, 300 um off the line through its neighbours",
        ),
        (
            "EX0C: 6 um",
            "EXX: { points: [[0 mm, 0 um], [500 mm, 0.08 um]] }",
            "W0413",
            "above 0.08 um: are its values in mm?",
        ),
        ("EX0C: 6 um", "EAA: { points: [[-120 deg, 0 deg], [30 deg, 1.8 deg]] }", "W0413", "`EAA` reaches 31.4 mrad"),
        ("EX0C: 6 um }", "EX0C: 6 um }\ntolerances: { EXX: 0.008 um }", "W0413", "`EXX` is bounded by 0.008 um"),
    ] {
        let (codes, said) = with(&folder, from, to);
        // Without a workpiece the tip is below machine zero, too.
        assert!(codes.contains(&code) && codes.len() <= 2 && said.contains(words), "{to}: {said}");
    }
    let radians = with(&folder, "[-120 deg, 30 deg]", "[-2.0944, 0.5236]").1;
    assert!(radians.contains("travel: [-120 deg, 30 deg]"), "{radians}");
}

#[test]
fn what_is_right_is_not_questioned() {
    let folder = Folder::new("questions-right");
    for (from, to) in [
        (
            "EX0C: 6 um",
            "EXX: { points: [[0 mm, 0 um], [100 mm, 2 um], [200 mm, 50 um], \
             [300 mm, 6 um], [350 mm, 8 um], [400 mm, 8 um], [450 mm, 9 um], [500 mm, 10 um]] }",
        ),
        ("[-120 deg, 30 deg]", "[-1.5, 1.5]"),
        ("[-120 deg, 30 deg]", "[-5, 0]"),
        // Away from 0 rotary axes are elsewhere.
        ("[-120 deg, 30 deg], origin: [250, 225, -350] }", "[10, 20], origin: [0, 0, 0] }"),
        ("gauge: [0, 0, 0], length: 120 mm", "gauge: [0, 0, 0], offset: [0, 0, -120]"),
        // A table that turns right-handed goes the other way.
        ("C: { travel", "C: { sense: direct, travel"),
        ("Y: { travel: [0 mm, 450 mm] }", "Y: { sense: direct, travel: [-450 mm, 0 mm] }"),
        ("EX0C: 6 um", "EX0C: 0.9 mm"),
        // A pallet below a spindle that lies.
        ("[250, 225, -380] }\nerrors", "[250, -90, -380] }\nup: [0, 1, 0]\nerrors"),
    ] {
        let (codes, said) = with(&folder, from, to);
        assert!(codes.is_empty(), "{to}: {said}");
    }
}

#[test]
fn a_bounded_machine_is_asked_for_the_origins_that_classes_need() {
    let folder = Folder::new("questions-bounded");
    let (codes, said) = with(&folder, "errors: { EX0C: 6 um }", "tolerances: { EXX: { A: 8 um } }");
    assert_eq!(codes, ["W0405"; 3], "{said}");
    assert!(said.contains("axis `X` has no bounds of its angles, for which verbs take those of a class,"), "{said}");
    // With values nothing stands in.
    assert!(with(&folder, "EX0C: 6 um", "EXX: 6 um").0.is_empty());
}

#[test]
fn a_variant_with_another_gauge_point_is_questioned() {
    let folder = Folder::new("questions-variant");
    let tools = SOUND.replace("tool: {", "tools: { short: {").replace("120 mm }", "120 mm } }");
    let _ = (folder.with("base.yaml", SOUND), folder.with("tools.yaml", &tools));
    let variant = |base: &str, tool: &str| {
        let text = format!("abbe: 1\nextends: {base}\nmachine: Long\n{tool}\n");
        let (codes, said) = asked(&folder.with("variant.yaml", &text));
        (codes.len(), said)
    };
    for (base, tool) in [
        ("base.yaml", "tool: { gauge: [250, 0, 0], length: 240 mm }"),
        ("tools.yaml", "tools: { short: { gauge: [250 mm, 0, 0] } }"),
    ] {
        let (count, said) = variant(base, tool);
        assert!(count == 1 && said.contains("moves the gauge point of its base by 250 mm"), "{tool}: {said}");
    }
    for tool in ["tool: { length: 240 mm }", "tool: { gauge: [0, 0, 0] }", "tool: { gauge: [0, 0, 40] }"] {
        assert_eq!(variant("base.yaml", tool), (0, String::new()), "{tool}");
    }
}

#[test]
fn the_machines_of_the_repository_raise_no_question() {
    let mut folders = vec![crate::configs::folder()];
    let mut files: Vec<PathBuf> = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "yaml") {
                files.push(path);
            }
        }
    }
    assert!(files.len() > 25);
    for file in files {
        assert_eq!(asked(&file), (Vec::new(), String::new()), "{}", text(&file));
    }
}

/// A travel in arc minutes is none in inches.
#[test]
fn only_inches_are_inches() {
    use abbe::syntax::TravelEntry;
    let entry = |end: &str| -> TravelEntry { serde_yaml::from_str(&format!("[0, {end}]")).unwrap() };
    for end in ["16 in", "16in", "1e1 inch"] {
        assert!(entry(end).is_in_inches(), "{end}");
    }
    for end in ["600 arcmin", "16 mm", "16", "16 furlongin"] {
        assert!(!entry(end).is_in_inches(), "{end}");
    }
}
