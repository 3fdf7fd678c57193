//! The first hour: files by questions, and messages that name the cause of a beginner's mistake.

use super::program::{Folder, abbe, available, json, refused, text};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Runs the program in a pseudo-terminal in a folder, with a text typed; returns the exit code and what was shown.
const TERMINAL: &str = "
import os, pty, sys
folder, typed, program = sys.argv[1], sys.argv[2].encode(), sys.argv[3:]
child, terminal = pty.fork()
if child == 0:
    os.chdir(folder)
    os.execv(program[0], program)
os.write(terminal, typed)
while True:
    try:
        shown = os.read(terminal, 65536)
    except OSError:
        break
    if not shown:
        break
    os.write(1, shown)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
";

pub fn typed(folder: &Folder, answers: &str) -> (i32, String) {
    let python = std::env::var("ABBE_PYTHON").unwrap_or("python3".to_owned());
    let program = [text(&folder.0), answers, env!("CARGO_BIN_EXE_abbe"), "init"];
    let done = Command::new(python).args(["-c", TERMINAL]).args(program).output().unwrap();
    (done.status.code().unwrap(), String::from_utf8_lossy(&done.stdout).into_owned())
}

#[test]
fn questions_make_files_that_check_is_silent_about() {
    if !available("python3", "questions on a terminal") {
        return;
    }
    let folder = Folder::new("questions");
    let _ = folder.with("x.csv", "X [mm], EXX [um]\n-200, 0\n0, 1\n300, 2\n");
    // The axes of each kind, by its number.
    let kinds = ["XYZ", "XYZ", "XYZA", "XYZAC", "XYZBC", "XYZCA"];
    let errors = [
        ("1\nproduction\n", "class: production"),
        ("2\n8\n\n\n\n", "EXX: { A: 8 um }"),
        ("3\nx.csv\n", "measured: [\"x.csv\"]"),
        ("4\n", "EC0Y: 12 urad"),
    ];
    for (kind, axes) in kinds.iter().enumerate() {
        for (number, (known, holds)) in errors.iter().enumerate() {
            let name = format!("m{kind}{number}.yaml");
            // A class is asked for after a sheet; empty answers take what is proposed.
            let sheet = if number == 1 { "\n".repeat(axes.len() - 3) } else { String::new() };
            let travels = format!("-200 300\n0, 350\n-380 -20\n{}", "\n".repeat(axes.len() - 3));
            let answers = format!("{}\n{travels}95.5\n{known}{sheet}{name}\n", kind + 1);
            let (code, shown) = typed(&folder, &answers);
            assert_eq!(code, 0, "{answers}: {shown}");
            let file = folder.file(&name);
            let written = std::fs::read_to_string(&file).unwrap();
            assert!(written.contains(holds) && written.contains("length: 95.5 mm"), "{written}");
            abbe(&["check", text(&file)]);
            let show = json(&["show", text(&file), "--format", "json"]);
            let travel = |name: &str| {
                show["axes"].as_array().unwrap().iter().find(|axis| axis["name"] == name).unwrap()["travel"].clone()
            };
            assert_eq!(travel("X"), serde_json::json!([-200.0, 300.0]));
            assert_eq!(show["axes"].as_array().unwrap().len(), axes.len());
        }
    }
    let nothing = folder.file("never.yaml");
    for cut in ["", "4\n0 500\n", "9\nfoo\n2\n5 1\n0 500\n"] {
        let (code, shown) = typed(&folder, &format!("{cut}\u{4}"));
        assert!(code == 1 && shown.contains("nothing is written"), "{code} {shown}");
        assert!(
            !cut.starts_with('9') || shown.contains("a number from 1 to 6") && shown.contains("the lower end first")
        );
    }
    assert!(!nothing.exists() && !folder.file("machine.yaml").exists());
    let (code, message) = refused(&["init"]);
    assert!(code == 2 && message.contains("abbe init FILE"), "{message}");
}

#[test]
fn a_list_names_every_machine_class_and_control() {
    let list = narrow(&["init", "--from"]);
    assert!(list.lines().all(|line| line.chars().count() <= 80), "{list}");
    let words: BTreeSet<&str> = list.split_whitespace().collect();
    let (mut folders, mut names) = (vec![super::configs::folder()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            match entry.extension() {
                None if entry.is_dir() => folders.push(entry),
                Some(ending) if ending == "yaml" => names.push(entry.file_stem().unwrap().to_str().unwrap().to_owned()),
                _ => {}
            }
        }
    }
    assert!(names.len() > 25);
    let controls = json(&["targets", "--format", "json"]);
    let controls = controls["targets"].as_array().unwrap().iter().map(|of| of["target"].as_str().unwrap().to_owned());
    let classes = ["ultra-precision", "desktop"].map(str::to_owned);
    for name in names.into_iter().chain(controls).chain(classes) {
        assert!(words.contains(name.as_str()), "{name}");
    }
    let all = json(&["init", "--from", "--format", "json"]);
    let folder = Folder::new("every-starter");
    for machine in all["machines"].as_array().unwrap() {
        let name = machine["name"].as_str().unwrap();
        let file = folder.file(&format!("{name}.yaml"));
        abbe(&["init", text(&file), "--from", name, "--quiet"]);
        abbe(&["check", text(&file)]);
    }
    let csv = abbe(&["init", "--from", "--format", "csv"]);
    assert_eq!(csv.lines().count(), all["machines"].as_array().unwrap().len());
    let begin = |name: &str| refused(&["init", text(&folder.file("new.yaml")), "--from", name]);
    assert!(begin("trunion").1.contains("did you mean `trunnion`"));
    assert!(begin("trunnion-aligned").1.contains("begin with `trunnion`"));
}

/// The message for a machine file with one line replaced, with its place.
fn mistake(folder: &Folder, from: &str, to: &str) -> String {
    let machine = "abbe: 1\nmachine: m\nchain: \"w b X Z t\"\naxes:\n  X: { travel: [0, 100], origin: [0, 0, 0] }\n  \
                   Z:\n    travel: [-100, 0]\n    origin: [0, 0, 0]\ntool: { gauge: [0, 0, 0], length: 50 mm }\n\
                   workpiece: { origin: [50, 0, -120] }\n";
    assert!(machine.contains(from), "{from}");
    let file = folder.with("mistake.yaml", &machine.replacen(from, to, 1));
    let (code, message) = refused(&["check", text(&file)]);
    assert!(code == 1 && message.contains("1 mistake\n"), "{message}");
    message
}

#[test]
fn mistakes_of_writing_name_their_cause_and_place() {
    let folder = Folder::new("writing");
    for (from, to, cause, place) in [
        ("    travel", "\ttravel", "a tab indents this line", "7:1"),
        ("  X:", "\tX:", "a tab indents this line", "5:1"),
        ("machine: m", "machine m", "no colon behind `machine`", "2:1"),
        ("axes:", "axes", "no colon behind `axes`", "4:1"),
        ("  X:", "  X", "no colon behind `X`", "5:3"),
        ("  X: {", "  X:{", "no blank behind the colon of `X`", "5:3"),
        ("machine: m", "machine:m", "no blank behind the colon of `machine`", "2:1"),
        ("{ travel:", "{ travel", "no colon behind `travel`", "5:8"),
        ("    origin: [0, 0, 0]", "    origin [0, 0, 0]", "no colon behind `origin`", "8:5"),
        ("length: 50", "length 50", "write `length: 50 mm`, with a colon and a blank", "9:27"),
        ("w b X Z t", "wbXZt", "blanks between the names: `w b X Z t`", "3:8"),
        ("w b X Z t", "w b X Zt", "blanks between the names: `w b X Z t`", "3:8"),
        ("w b X Z t", "w b XZ t", "blanks between the names: `X Z`", "3:13"),
        ("w b X Z t", "w C'A' b X Z t", "blanks between the names: `C' A'`", "3:11"),
        ("w b X Z t", "wC'A'bXZ(S)t", "blanks between the names: `w C' A' b X Z (S) t`", "3:8"),
    ] {
        let message = mistake(&folder, from, to);
        assert!(message.contains(cause) && message.contains(&format!("mistake.yaml:{place}\n")), "{to}: {message}");
    }
    for (from, to, cause, place) in [
        ("[0, 100]", "[0, 100", "`[` is not closed", "5:16"),
        ("50 mm }", "50 mm", "`{` is not closed", "9:7"),
        ("    origin:", "      origin:", "indented deeper than the one above", "8:1"),
    ] {
        let message = mistake(&folder, from, to);
        assert!(message.contains(cause) && message.contains(&format!("mistake.yaml:{place}\n")), "{to}: {message}");
    }
    // Other faults keep the parser's words.
    assert!(mistake(&folder, "machine: m", "machine: *m").contains("not YAML: "));
}

#[test]
fn files_of_other_programs_are_named() {
    let folder = Folder::new("foreign");
    let is_machine = |file: &Path| abbe(&["init", text(file), "--quiet"]);
    let machine = folder.file("m.yaml");
    is_machine(&machine);
    for (name, content, cause) in [
        ("part.stp", "ISO-10303-21;\n", "drawing of a part"),
        ("part.txt", "ISO-10303-21;\n", "drawing of a part"),
        ("part.STEP", "", "drawing of a part"),
        ("sheet.xlsx", "PK\u{3}\u{4}", "workbook"),
        ("sheet.csv", "PK\u{3}\u{4}", "workbook"),
        ("part.nc", "%\nO1\nG0 X1\n", "program for a control"),
        ("part.csv", "N10 G0 X1\n", "program for a control"),
        ("sheet.pdf", "%PDF-1.5\n", "PDF"),
    ] {
        let file = folder.with(name, content);
        let path = text(&file);
        let measured = folder.with("n.yaml", &format!("abbe: 1\nmachine: m\nchain: w b X t\nmeasured: [{name}]\n"));
        for arguments in [
            vec!["map", text(&machine), "--tool-poses", path],
            vec!["identify", text(&machine), "--data", path],
            vec!["import", path, "--axis", "X"],
            vec!["check", text(&measured)],
        ] {
            let (code, message) = refused(&arguments);
            assert!(code == 1 && message.contains(cause) && message.contains("E0104"), "{arguments:?}: {message}");
        }
    }
    // A table of another program's ending that nobody took for one stays a table.
    let poses = folder.with("poses.dat", "X [mm], Y [mm], Z [mm], I, J, K\n0, 0, 50, 0, 0, 1\n");
    let _ = json(&["map", text(&machine), "--tool-poses", text(&poses), "--format", "json", "--quiet"]);
    let _ = folder.with("other.yml", "abbe: 1\n");
    let (_, message) = refused(&["check", text(&folder.file("other.yaml"))]);
    assert!(message.contains("there is `") && message.contains("other.yml`"), "{message}");
    let (_, message) = refused(&["check", text(&folder.file("poces.dat"))]);
    assert!(message.contains("poses.dat`"), "{message}");
}

/// A machine of three axes without errors, and readings of one with the squareness EC0Y = 12, EB0Z = -8, EA0Z = 5 urad.
fn square(folder: &Folder) -> (std::path::PathBuf, std::path::PathBuf) {
    let machine = folder.with(
        "square.yaml",
        "abbe: 1\nmachine: Square\nchain: w b X Y Z t\naxes:\n  X: { travel: [0, 400], origin: [0, 0, 0] }\n  Y: { \
         travel: [0, 400], origin: [0, 0, 0] }\n  Z: { travel: [-300, 0], origin: [0, 0, 0] }\ntool: { gauge: [0, 0, \
         0], length: 50 mm }\nworkpiece: { origin: [200, 200, -340] }\n",
    );
    let mut rows = String::from("X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um]\n");
    for (x, y, z) in [0.0, 200.0, 400.0]
        .iter()
        .flat_map(|x| [0.0, 400.0].map(|y| (*x, y)))
        .flat_map(|(x, y)| [-300.0, -100.0, 0.0].map(|z| (x, y, z)))
    {
        // +10 urad of EC0Y at Y = 500 moves by -5 um in X, of EB0Z at Z = 300 by +3 um in X, of EA0Z by -3 um in Y.
        let (dx, dy) = (-12e-3 * y - 8e-3 * z, -5e-3 * z);
        rows += &format!("{x},{y},{z},{dx},{dy},0\n");
    }
    (machine, folder.with("readings.csv", &rows))
}

#[test]
fn a_fit_of_which_nothing_is_said_is_of_what_the_chain_needs() {
    let folder = Folder::new("needed");
    let (machine, data) = square(&folder);
    let fit = |more: &[&str]| {
        json(&[&["identify", text(&machine), "--data", text(&data), "--format", "json", "--quiet"], more].concat())
    };
    let shown = json(&["show", text(&machine), "--format", "json"]);
    let set: Vec<&str> =
        shown["location_errors"]["set"].as_array().unwrap().iter().map(|of| of["error"].as_str().unwrap()).collect();
    for found in [fit(&[]), fit(&["--fit", "needed"])] {
        let found = found["parameters"].as_array().unwrap();
        let names: Vec<&str> = found.iter().map(|of| of["name"].as_str().unwrap()).collect();
        assert_eq!(names, set);
        for (of, value) in found.iter().zip([12.0, -8.0, 5.0]) {
            // The readings are of small angles, the fit turns.
            assert!((of["value"].as_f64().unwrap() - value).abs() < 1e-3, "{of}");
        }
    }
    let (code, said) = refused(&["identify", text(&machine), "--data", text(&data)]);
    assert!(code == 0 && said.contains("--fit needed"), "{said}");
    let (_, said) = refused(&["identify", text(&machine), "--data", text(&data), "--fit", "needed"]);
    assert!(!said.contains("--fit needed"), "{said}");
}

#[test]
fn quiet_says_nothing_but_refusals() {
    let folder = Folder::new("quiet");
    let (machine, data) = square(&folder);
    let warned = folder.with(
        "warned.yaml",
        "abbe: 1\nmachine: m\nchain: w b X Z t\naxes:\n  X: { travel: [0, 100] }\n  Z: { travel: [0, 100] }\n",
    );
    assert!(refused(&["check", text(&warned)]).1.contains("warning"));
    let out = folder.file("out");
    for arguments in [
        vec!["check", text(&warned)],
        vec!["show", text(&warned)],
        vec!["map", text(&warned), "--random", "50"],
        vec!["budget", text(&warned), "--class", "production", "--poses", "5", "--samples", "50"],
        vec!["compare", text(&warned), text(&warned), "--poses", "5"],
        vec!["identify", text(&machine), "--data", text(&data)],
        vec!["compile", text(&machine), "--target", "grid-json", "--out", text(&out)],
        vec!["init", text(&folder.file("new.yaml"))],
    ] {
        let (code, said) = refused(&[&arguments[..], &["--quiet"]].concat());
        assert!(code == 0 && said.is_empty(), "{arguments:?}: {said}");
    }
    assert!(refused(&["check", "nowhere.yaml", "--quiet"]).1.contains("E0101"));
}

#[test]
fn angles_that_look_like_radians_are_asked_about_once() {
    let folder = Folder::new("radians");
    let rows = |header: &str, from: f64, to: f64, count: usize, rest: &str| {
        let row = |k: usize| format!("{},{rest}\n", from + (to - from) * k as f64 / (count - 1) as f64);
        folder.with("poses.csv", &format!("{header}\n{}", (0..count).map(row).collect::<String>()))
    };
    let warnings = |arguments: &[&str]| {
        let said = refused(arguments).1;
        said.matches("W0804").count()
    };
    let poses = |file: &Path| warnings(&["eval", "trunnion.yaml", "--axis-poses", text(file), "--format", "csv"]);
    for (header, from, to, count, wanted) in [
        ("C,A", 0.0, 6.2, 25, 1),
        ("C,A", -3.1, 3.1, 20, 1),
        ("C,A", 0.0, 6.2, 19, 0),
        ("C,A", 0.0, 2.9, 25, 0),
        ("C,A", 0.0, 7.0, 25, 0),
        ("C,A", 0.0, 360.0, 25, 0),
        ("C [deg],A", 0.0, 6.2, 25, 0),
        ("C [rad],A", 0.0, 6.2, 25, 0),
    ] {
        let file = rows(header, from, to, count, "0");
        assert_eq!(poses(&file), wanted, "{header} {from} {to} {count}");
    }
    let file = rows("C,X,Y,Z", 0.0, 6.2, 24, "0,0,60");
    let over = ["map", "trunnion.yaml", "--format", "json", "--tool-poses"];
    assert_eq!(warnings(&[&over[..], &[text(&file)]].concat()), 1);
    let file = rows("C,X,Y,Z,dx [um],dy [um],dz [um]", 0.0, 6.2, 24, "100,100,-100,1,2,3");
    assert_eq!(warnings(&["identify", "trunnion.yaml", "--data", text(&file), "--fit", "workpiece"]), 1);
}

#[test]
fn remedies_stand_in_the_message() {
    let folder = Folder::new("remedies");
    let twice = folder.with(
        "twice.yaml",
        "abbe: 1\nmachine: m\nchain: w b X t\naxes: { X: { travel: [0, 100] } }\nerrors: { EXX: 1 um, dxx: 2 um }\n",
    );
    let said = refused(&["check", text(&twice)]).1;
    assert!(said.contains("E0407") && said.contains("remove one of the two"), "{said}");
    let out = folder.file("out");
    // A trunnion whose tables turn as ISO 841 has it; the same with `sense: direct` is taken.
    let said = refused(&["compile", "tt-ac-800.yaml", "--target", "linuxcnc-trt", "--out", text(&out), "--quiet"]).1;
    assert!(said.contains("E0751") && said.contains("sense: direct"), "{said}");
    let direct =
        ["compile", "variants/tt-ac-800-direct.yaml", "--target", "linuxcnc-trt", "--out", text(&out), "--quiet"];
    assert_eq!(refused(&direct).0, 0);
    for (code, words) in [("E0407", "Remove one of the two"), ("E0513", "`sense`"), ("E0751", "`sense: direct`")] {
        assert!(abbe(&["explain", code]).contains(words), "{code}");
    }
}

/// Places of a drawing's points: centres of its small circles, view by view in the order of the points.
fn centres(svg: &str) -> Vec<[f64; 2]> {
    let number = |tag: &str, name: &str| -> f64 {
        tag.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
    };
    let circles = svg.split("<circle ").skip(1).filter(|tag| number(tag, " r") == 3.5 || tag.contains("r=\"3.5\""));
    circles.map(|tag| [number(tag, "cx"), number(tag, "cy")]).collect()
}

#[test]
fn the_zero_pose_is_drawn_to_scale() {
    let folder = Folder::new("zero-pose");
    let out = folder.file("zero.svg");
    let said = abbe(&["show", "trunnion.yaml", "--zero-pose", text(&out)]);
    for line in ["line of C         250, 225, -380 mm, along 0, 0, 1", "line of A         250, 225, -350 mm"] {
        assert!(said.contains(line), "{said}");
    }
    let svg = std::fs::read_to_string(out).unwrap();
    super::program::well_formed(&svg).unwrap();
    for words in ["gauge", "tip: 0, 0, -120", "workpiece: 250, 225, -380", "A: 250, 225, -350, line along 1, 0, 0"] {
        assert!(svg.contains(words), "{words}");
    }
    let drawn = centres(&svg);
    // Gauge, tip, workpiece, then C, A, Y, X, Z; the views are X-Z, Y-Z, X-Y.
    assert_eq!(drawn.len(), 24);
    let points =
        [[0.0, 0.0, 0.0], [0.0, 0.0, -120.0], [250.0, 225.0, -380.0], [250.0, 225.0, -380.0], [250.0, 225.0, -350.0]];
    let scale = (drawn[1][1] - drawn[0][1]) / 120.0;
    for (view, [right, up]) in [[0, 2], [1, 2], [0, 1]].into_iter().enumerate() {
        let [gauge, ..] = drawn[8 * view..] else { panic!() };
        for (point, at) in points.iter().zip(&drawn[8 * view..]) {
            let off = [at[0] - gauge[0] - scale * point[right], at[1] - gauge[1] + scale * point[up]];
            assert!(off.iter().all(|off| off.abs() < 0.02), "{view} {point:?} {off:?}");
        }
    }
}

/// Standard output as a person sees it.
fn narrow(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    let output = command.args(arguments).arg("--quiet").current_dir(super::configs::folder()).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// Codes and messages of the warnings of a run; none if it is refused.
fn warnings(arguments: &[&str]) -> Option<BTreeSet<(String, String)>> {
    let output = super::program::abbe_on(2, &[arguments, &["--format", "json"]].concat());
    let document: serde_json::Value =
        serde_json::from_slice(&output.stdout).ok().filter(|_| output.status.success())?;
    let word = |warning: &serde_json::Value, key: &str| warning[key].as_str().unwrap().to_owned();
    let list = document["warnings"].as_array().into_iter().flatten();
    Some(list.map(|warning| (word(warning, "code"), word(warning, "message"))).collect())
}

/// W0802 is no fault of a file: `eval` counts bounds as zero, which the summary of `check` says. W06 are of tables.
#[test]
fn what_verbs_warn_of_a_file_check_warns_of_too() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let mut files: Vec<_> = std::fs::read_dir(examples).unwrap().map(|of| of.unwrap().path()).collect();
    files.retain(|folder| folder.file_name().unwrap().to_str().unwrap().starts_with('W'));
    let mut files: Vec<String> = files.iter().map(|folder| text(&folder.join("machine.yaml")).to_owned()).collect();
    files.extend(["trunnion.yaml", "vmc-cframe-754.yaml", "lathes/lathe-xzc.yaml"].map(str::to_owned));
    let (mut seen, folder) = (0, Folder::new("warnings"));
    for (number, file) in files.iter().enumerate() {
        let out = folder.file(&number.to_string());
        let known = warnings(&["check", file]).unwrap();
        for verb in [
            vec!["show", file],
            vec!["eval", file],
            vec!["map", file, "--random", "20"],
            vec!["budget", file, "--poses", "3", "--samples", "20"],
            vec!["compare", file, file, "--poses", "3"],
            vec!["reach", file, "--directions", "1"],
            vec!["compile", file, "--target", "grid-json", "--out", text(&out), "--poses", "10"],
        ] {
            let Some(said) = warnings(&verb) else { continue };
            seen += said.len();
            let alone: Vec<_> = said
                .iter()
                .filter(|(code, _)| code != "W0802" && !code.starts_with("W06"))
                .filter(|of| !known.contains(of))
                .collect();
            assert!(alone.is_empty(), "{verb:?}: {alone:?}");
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn text_keeps_to_80_columns_and_tables_to_100() {
    let folder = Folder::new("columns");
    let (square, data) = square(&folder);
    let (out, cec) = (folder.file("out"), folder.file("cec"));
    let mut runs: Vec<Vec<&str>> = vec![
        vec!["identify", text(&square), "--data", text(&data), "--fit", "needed"],
        vec!["identify", text(&square), "--plan", "5", "--fit", "needed"],
        vec!["compile", "trunnion.yaml", "--target", "sinumerik-cec", "--out", text(&cec), "--poses", "50"],
        vec!["compile", "trunnion.yaml", "--target", "linuxcnc", "--out", text(&out), "--poses", "50"],
        vec!["verify", "trunnion.yaml", text(&out), "--poses", "50"],
        vec!["instrument", "trunnion.yaml", "ball-bar"],
        vec!["instrument", "trunnion.yaml", "r-test"],
        vec!["convert", "trunnion.yaml", "--to", "bui-kimm", "--within", "5 nm"],
        vec!["targets"],
        vec!["init", "--from"],
        vec!["diff", "trunnion.yaml", "variants/trunnion-aligned.yaml", "--poses", "20"],
    ];
    for machine in ["trunnion.yaml", "hh-bd-ram.yaml", "vmc-cframe-754.yaml"] {
        runs.extend([
            vec!["check", machine],
            vec!["show", machine],
            vec!["eval", machine, "--sensitivity"],
            vec!["map", machine, "--random", "200"],
            vec!["map", machine, "--random", "50", "--class", "production"],
            vec!["budget", machine, "--class", "production", "--poses", "10", "--samples", "50"],
            vec!["compare", machine, "boring-w.yaml", "gantry-3ax.yaml", "--poses", "20"],
            vec!["compare", machine, machine, "--class", "production", "--poses", "10", "--samples", "50"],
            vec!["reach", machine, "--directions", "2"],
            vec!["equations", machine],
        ]);
    }
    // Six axes have thousands of arrangements, for which the lines are as long as for five.
    for machine in ["trunnion.yaml", "hh-ca-gantry.yaml", "vmc-cframe-754.yaml"] {
        runs.push(vec!["enumerate", machine, "--class", "production", "--poses", "10", "--samples", "50"]);
    }
    let mut printed = 0;
    for run in &runs {
        let said = narrow(run);
        printed += usize::from(!said.is_empty());
        for line in said.lines() {
            let most = if line.starts_with('|') { 100 } else { 80 };
            assert!(line.chars().count() <= most, "{run:?}: {line}");
        }
    }
    assert!(printed > 35, "{printed} of {}", runs.len());
    let wide = abbe(&["show", "trunnion.yaml"]);
    assert!(wide.lines().any(|line| line.chars().count() > 100));
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let folded = narrow(&["eval", "trunnion.yaml", "--sensitivity"]);
    assert_eq!(joined(&folded), joined(&abbe(&["eval", "trunnion.yaml", "--sensitivity"])));
}

#[test]
fn a_comparison_begins_with_what_it_decides() {
    let work = ["--class", "production", "--poses", "20", "--samples", "50"];
    let said = narrow(&[&["compare", "trunnion.yaml", "tt-ac-800.yaml"], &work[..]].concat());
    let first: Vec<&str> = said.lines().take(4).map(str::trim).collect();
    let head = first.join(" ");
    assert!(first[0].starts_with("Machine 2 against 1:"), "{said}");
    assert!(head.contains("over 20 of 20 tool poses"), "{said}");
    assert!(
        head.contains("Bounds of machine 1: all 41 by class production; of 2: all 43 by class production."),
        "{said}"
    );
}

#[test]
fn words_of_the_glossary_are_explained() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/words.md");
    let page = std::fs::read_to_string(page).unwrap();
    let entries: Vec<(&str, &str)> =
        page.split("\n## ").skip(1).map(|entry| entry.split_once("\n\n").unwrap()).collect();
    assert!(entries.len() > 10 && entries.iter().filter(|(_, text)| text.contains("```text")).count() >= 6);
    for (heading, text) in &entries {
        let said = abbe(&["explain", heading]);
        assert!(said.starts_with(heading) && said.contains(text.trim()), "{heading}: {said}");
    }
    for (word, heading) in [
        ("gauge", "Gauge point"),
        ("zero", "Zero pose"),
        ("Tip", "Tip"),
        ("component", "Location and"),
        ("tcp", "Tip"),
        ("e_ve", "E_VE"),
        ("tolerance", "Bound"),
        ("backlash", "Reversal"),
        ("inch", "Units"),
    ] {
        assert!(abbe(&["explain", word]).starts_with(heading), "{word}");
    }
    let (code, said) = refused(&["explain", "gouge"]);
    assert!(code == 2 && said.contains("did you mean `gauge`?"), "{said}");
    let (code, said) = refused(&["explain", "whatever"]);
    // What there is, in a few lines: not every code.
    assert!(code == 2 && said.contains("squareness") && said.lines().count() < 10, "{said}");
    assert_eq!(refused(&["explain", "and"]).0, 2);
}
