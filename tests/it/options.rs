//! Options mean the same in every verb: pictures by their ending, threads, old spellings, warnings that name their
//! file. The walk over all options is a unit test of the program (`option_table`).

use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use std::path::Path;

const MACHINE: &str = "abbe: 1
machine: M
chain: w b X Y Z t
axes:
  X: { travel: [0, 400], origin: [0, 0, 0] }
  Y: { travel: [0, 400], origin: [0, 0, 0] }
  Z: { travel: [0, 400], origin: [0, 0, 0] }
errors: { EC0Y: 20 urad }
volume: { step: 100 mm }
";

fn is_png(path: &Path) -> bool {
    std::fs::read(path).unwrap().starts_with(b"\x89PNG\r\n")
}

fn is_svg(path: &Path) -> bool {
    std::fs::read_to_string(path).unwrap().starts_with("<svg")
}

#[test]
fn a_picture_has_the_form_that_its_file_names() {
    let folder = Folder::new("options-pictures");
    let machine = folder.with("m.yaml", MACHINE);
    let bounded = folder.with("b.yaml", &MACHINE.replace("20 urad", "{ tolerance: 20 urad }"));
    let (m, b) = (text(&machine), text(&bounded));
    let lists: [&[&str]; 5] = [
        &["map", m, "--svg"],
        &["map", m, "--png"],
        &["show", m, "--svg"],
        &["instrument", m, "ball-bar", "--svg"],
        &["budget", b, "--samples", "10", "--poses", "2", "--pareto"],
    ];
    for (i, list) in lists.into_iter().enumerate() {
        let [svg, png] = ["svg", "PNG"].map(|ending| folder.file(&format!("{i}.{ending}")));
        abbe(&[list, &[text(&svg), "--quiet"]].concat());
        abbe(&[list, &[text(&png), "--quiet"]].concat());
        assert!(is_svg(&svg) && is_png(&png), "{list:?}");
        let other = folder.file("x.jpg");
        let (code, complaint) = refused(&[list, &[text(&other)]].concat());
        assert!(code == 2 && complaint.contains("ends in .svg or .png") && !other.exists(), "{list:?}: {complaint}");
    }
    // Without an ending the option decides.
    let plain = folder.file("plain");
    abbe(&["map", m, "--png", text(&plain), "--quiet"]);
    assert!(is_png(&plain));
}

#[test]
fn the_number_of_threads_is_an_option_and_changes_nothing() {
    let run = |jobs: &str| abbe(&["map", "trunnion.yaml", "--random", "300", "--format", "json", "--jobs", jobs]);
    assert_eq!(run("1"), run("3"));
    // Before the verb, too.
    assert_eq!(abbe(&["--jobs", "2", "map", "trunnion.yaml", "--random", "300", "--format", "json"]), run("1"));
    for wrong in ["0", "1025", "x"] {
        assert_eq!(refused(&["check", "trunnion.yaml", "--jobs", wrong]).0, 2, "{wrong}");
    }
}

#[test]
fn every_help_has_the_global_options_apart() {
    for verb in ["map", "compare", "budget", "eval", "compile", "identify", "check"] {
        let help = abbe(&[verb, "--help"]);
        let (own, global) = help.split_once("Global options:\n").unwrap();
        for option in ["--format", "--quiet", "--jobs", "--color", "--deny"] {
            assert!(global.contains(option) && !own.contains(&format!("{option} ")), "{verb} {option}");
        }
    }
}

#[test]
fn old_spellings_still_do() {
    let folder = Folder::new("options-old");
    let poses = folder.with("poses.csv", "X,Y\n10,20\n100,200\n");
    let eval = |option: &str| json(&["eval", "trunnion.yaml", option, text(&poses), "--format", "json"]);
    assert_eq!(eval("--poses"), eval("--axis-poses"));
    let map = |option: &str| {
        let more = [option, "functional-point", "--random", "20", "--format", "json"];
        json(&[&["map", "vmc-cframe-754.yaml"][..], &more].concat())
    };
    assert_eq!(map("--fit"), map("--own-axis"));
    // They are not in the help.
    assert!(!abbe(&["eval", "--help"]).contains("--poses") && !abbe(&["map", "--help"]).contains("--fit"));
}

#[test]
fn poses_and_tool_poses_exclude_each_other() {
    let folder = Folder::new("options-exclude");
    let work = folder.with("work.csv", "X,Y,Z\n100,200,300\n");
    let list: [&[&str]; 4] = [
        &["compare", "gantry-3ax.yaml", "gantry-3ax.yaml", "--poses", "5"],
        &["budget", "gantry-3ax.yaml", "--poses", "5"],
        &["enumerate", "gantry-3ax.yaml", "--poses", "5"],
        &["map", "gantry-3ax.yaml", "--random", "5"],
    ];
    for arguments in list {
        let (code, complaint) = refused(&[arguments, &["--tool-poses", text(&work)]].concat());
        assert!(code == 2 && complaint.contains("cannot be used with"), "{arguments:?}: {complaint}");
    }
}

#[test]
fn warnings_of_several_files_name_theirs() {
    let folder = Folder::new("options-warnings");
    // Y has bounded angles and no origin: a warning with its place in the base.
    let base = MACHINE.replace("Y: { travel: [0, 400], origin: [0, 0, 0] }", "Y: { travel: [0, 400] }");
    let base = folder.with(
        "base.yaml",
        &base.replace("errors: {", "errors: { EBY: { tolerance: 5 urad }, EXX: { tolerance: 1 um },"),
    );
    let own = folder.with("own.yaml", "abbe: 1\nextends: base.yaml\nmachine: Own\n");
    let work = folder.with("work.csv", "X,Y,Z\n100,200,300\n900,0,0\n");
    let warnings = |arguments: &[&str]| {
        let output = abbe_on(2, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let shown = String::from_utf8(output.stderr).unwrap();
        shown.split("warning[").skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let page = folder.file("page.html");
    let few = ["--poses", "20", "--samples", "10"];
    let lists: [Vec<&str>; 5] = [
        vec!["check", text(&base), text(&own)],
        vec!["diff", text(&base), text(&own), "--poses", "20"],
        [&["compare", text(&base), text(&own)][..], &few].concat(),
        vec!["compare", text(&base), text(&own), "--samples", "10", "--tool-poses", text(&work)],
        [&["report", text(&base), text(&own), "--out", text(&page)][..], &few].concat(),
    ];
    for list in lists {
        let all = warnings(&list);
        for file in [&base, &own] {
            let about = all.iter().filter(|warning| warning.contains(text(file))).count();
            assert!(about > 0, "{list:?} has no warning of {}: {all:?}", file.display());
        }
        let unnamed = all.iter().find(|w| !w.contains(text(&base)) && !w.contains(text(&own)));
        assert_eq!(unnamed, None, "{list:?}");
    }
    // Budgets that are not compared: the file with neither values nor bounds is named.
    let bare = folder.with("bare.yaml", &MACHINE.replace("errors: { EC0Y: 20 urad }\n", ""));
    let all = warnings(&[&["compare", text(&base), text(&bare)][..], &few].concat());
    assert!(all.iter().any(|w| w.starts_with("W0607") && w.contains(text(&bare))), "{all:?}");
}
