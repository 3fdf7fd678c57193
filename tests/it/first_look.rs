//! What a newcomer sees first: the answer in the first line, lines that fit a terminal, and the cause of a mistake.

use super::program::{Folder, abbe, json, refused, text};
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::{Command, Output};

/// Runs the program as a person does, without `--wide`.
fn narrow(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.args(arguments).current_dir(crate::configs::folder()).output().unwrap()
}

/// The numbers of a sentence.
fn numbers(sentence: &str) -> Vec<f64> {
    let parts = sentence.split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-')));
    parts.filter_map(|part| part.trim_end_matches('.').parse().ok()).collect()
}

/// Checks that the first line begins so and holds these figures, to a percent, in this order.
fn answers(arguments: &[&str], begin: &str, figures: &[f64]) {
    let said = abbe(&[arguments, &["--quiet"]].concat());
    let first = said.lines().next().unwrap();
    assert!(first.starts_with(begin), "{arguments:?}: {first}");
    let mut found = numbers(first).into_iter();
    for figure in figures {
        let near = |x: f64| (x - figure).abs() <= 0.01 * figure.abs();
        assert!(found.any(near), "{arguments:?}: no {figure} in {first}");
    }
}

fn value(of: &Value, path: &str) -> f64 {
    of.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}"))
}

#[test]
fn the_first_line_is_the_answer() {
    let folder = Folder::new("first-line");
    let said = |verb: &[&str]| json(&[verb, &["--format", "json", "--quiet"]].concat());
    let two = |value: f64| (value * 100.0).round() / 100.0;
    for machine in ["gantry-3ax.yaml", "trunnion.yaml"] {
        let verb = ["map", machine, "--random", "100"];
        let of = said(&verb);
        let figures = ["/position_um/p95", "/position_um/max", "/poses"].map(|path| value(&of, path));
        answers(&verb, "Position deviation: 95 % of the poses within", &figures);

        let verb = ["budget", machine, "--class", "production", "--poses", "10", "--samples", "50"];
        let of = said(&verb);
        let paths = ["/position_um/monte_carlo/p95", "/position_um/rss", "/position_um/worst_case", "/over/poses"];
        answers(&verb, "Position deviation: 95 % of 50 machines drawn within", &paths.map(|path| value(&of, path)));

        let verb = ["enumerate", machine, "--class", "production", "--poses", "10", "--samples", "50"];
        let of = said(&verb);
        let first = of["ranked"][0]["chain"].as_str().unwrap();
        answers(&verb, &format!("First: {first}, "), &[value(&of, "/ranked/0/um"), 10.0]);

        let out = folder.file(machine);
        let verb = ["compile", machine, "--target", "grid-json", "--out", text(&out), "--poses", "50"];
        let begin = "For the errors in the file the 95 % position deviation falls from";
        answers(&verb, begin, &[]);
        let verb = ["verify", machine, text(&out), "--poses", "50"];
        let of = said(&verb);
        answers(&verb, begin, &[two(value(&of, "/uncompensated/position_um/p95")), value(&of, "/poses")]);

        let verb = ["identify", machine, "--plan", "8", "--fit", "needed"];
        let of = said(&verb);
        let (determined, unknowns) = (value(&of, "/well_determined"), value(&of, "/unknowns"));
        answers(&verb, &format!("{determined} of {unknowns} unknowns determined by 8 readings."), &[]);
    }
    let (values, _) = MACHINE.split_once("errors:").unwrap();
    let bounded = folder.with("bounded.yaml", &format!("{values}class: production\n"));
    let verb = ["map", text(&bounded), "--random", "50", "--samples", "50"];
    let p95 = value(&said(&verb), "/bounds/position_um/monte_carlo/p95");
    answers(&verb, "Position deviation: 95 % of 50 machines drawn within", &[p95, 50.0]);
    let shop = "../docs/examples/shop-floor/";
    let (machine, data) = (format!("{shop}machine.yaml"), format!("{shop}volume.csv"));
    let verb = ["identify", &machine, "--data", &data, "--fit", "location,EXX:poly3,EYY:poly1,EZZ:poly1,EZY:poly2"];
    let of = said(&verb);
    let (rank, unknowns) = (value(&of, "/rank"), value(&of, "/unknowns"));
    let figures = ["/rows", "/rms_um/before", "/rms_um/after"].map(|path| value(&of, path));
    answers(&verb, &format!("{rank} of {unknowns} unknowns determined by"), &figures);
    answers(&["map", "robots/ur5.yaml", "--random", "10"], "Position deviation: 0 um, for no error", &[10.0]);
}

#[test]
fn messages_keep_to_80_columns_and_lines_of_files_are_cut() {
    let folder = Folder::new("narrow-messages");
    let long = format!("X,{},dx [um]\n0,1,2\n", "nonsense".repeat(15));
    let data = folder.with("a-file-with-a-name-of-its-own.csv", &long);
    let verb = ["identify", "trunnion.yaml", "--data", text(&data)];
    let output = narrow(&verb);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.lines().count() > 8, "{said}");
    let is_message = |line: &&str| !line.contains("-->");
    let is_name = |line: &str| line.split_whitespace().any(|word| word.len() > 80);
    assert!(said.lines().filter(is_message).all(|line| line.chars().count() <= 80 || is_name(line)), "{said}");
    assert!(said.contains("| X,nonsense"), "{said}");
    let (code, wide) = refused(&verb);
    assert!(code == 1 && wide.lines().any(|line| line.chars().count() > 200), "{wide}");
    assert!(wide.contains(long.lines().next().unwrap()), "{wide}");
    let prose = |text: &str| {
        let is_quoted = |line: &&str| line.starts_with("1 | ") || line.contains("^^^");
        text.lines().filter(|line| !is_quoted(line)).collect::<Vec<_>>().join(" ")
    };
    let words = |text: &str| prose(text).split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let plain = |text: &str| words(text).into_iter().filter(|word| word != "|").collect::<Vec<_>>();
    assert_eq!(plain(&said), plain(&wide));
    // What a run takes for granted is said once, and fits.
    let said = String::from_utf8(narrow(&["identify", "trunnion.yaml", "--plan", "3"]).stderr).unwrap();
    assert_eq!(said.matches("nothing says what to fit").count(), 1, "{said}");
    assert!(said.lines().all(|line| line.chars().count() <= 80), "{said}");
}

#[test]
fn long_texts_of_codes_fit_a_terminal() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/diagnostic/explain");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        let Some(code) = name.strip_suffix(".md") else { continue };
        let said = String::from_utf8(narrow(&["explain", code]).stdout).unwrap();
        for line in said.lines().filter(|line| !line.contains(": {") && !line.starts_with('|')) {
            assert!(line.chars().count() <= 80, "{code}: {line}");
        }
        count += 1;
    }
    assert!(count > 150, "{count}");
}

const MACHINE: &str = "\
abbe: 1
machine: m
chain: \"w C' A' Y' b X Z t\"
axes:
  X: { travel: [0 mm, 500 mm] }
  Y: { travel: [0 mm, 450 mm] }
  Z: { travel: [-400 mm, 0 mm] }
  A: { travel: [-120 deg, 30 deg], origin: [250, 225, -350] }
  C: { travel: continuous, origin: [250, 225, -380] }
tool: { gauge: [250, 225, 0], length: 120 mm }
workpiece: { origin: [250, 225, -380] }
errors:
  EC0Y: 12 urad
  EXX: { table: x.csv }
";

const TABLE: &str = "X [mm],EXX [um]\n0,0\n250,3\n500,5\n";

/// Mistakes of beginners that were accepted in silence, or whose message did not name the cause.
#[test]
fn mistakes_of_beginners_are_named() {
    let folder = Folder::new("beginners");
    let machine = folder.with("m.yaml", MACHINE);
    let _ = folder.with("x.csv", TABLE);
    assert_eq!(refused(&["check", text(&machine)]), (0, String::new()));
    for (from, to, words) in [
        ("[-120 deg, 30 deg]", "[-2.09, 0.52]", "axis `A` travels from -2.09 to 0.52 deg: are these radians?"),
        ("[0 mm, 500 mm] }\n  Y", "[0, 0.5] }\n  Y", "axis `X` travels from 0 to 0.5 mm: are these metres?"),
        ("length: 120 mm", "length: 0.12", "the tip is 0.12 mm from the gauge point: are these metres?"),
        ("gauge: [250, 225, 0]", "gauge: [0.25, 0.225, 0]", "`tool.gauge` is [0.25, 0.225, 0] mm: are these metres?"),
        ("origin: [250, 225, -350]", "origin: [0.25, 0.225, -0.35]", "`axes.A.origin` is [0.25, 0.225, -0.35] mm"),
        ("workpiece: { origin: [250, 225, -380]", "workpiece: { origin: [0.25, 0.225, -0.38]", "are these metres?"),
        ("{ table: x.csv }", "x.csv", "a table of an error is `{ table: FILE }`"),
        ("table: x.csv", "table: errors\\x.csv", "write `/` between folders"),
    ] {
        assert!(MACHINE.contains(from), "{from}");
        let file = folder.with("wrong.yaml", &MACHINE.replacen(from, to, 1));
        let (_, message) = refused(&["check", text(&file)]);
        assert!(message.contains(words), "{to}: {message}");
    }
    let _ = folder.with("x.csv", &TABLE.replace("um", "mm"));
    assert!(refused(&["check", text(&machine)]).1.contains("`EXX` reaches 5 mm: are its values in um?"));
    let _ = folder.with("x.csv", TABLE);
    let verify = refused(&["verify", text(&machine), text(&folder.file("x.csv"))]);
    assert!(verify.1.contains("is a file, not a folder of compensation files"), "{}", verify.1);
}

#[test]
fn tables_of_poses_are_read_as_other_tables_are() {
    let folder = Folder::new("pose-tables");
    let eval = |content: &str| {
        let poses = folder.with("p.csv", content);
        abbe(&["eval", "trunnion.yaml", "--poses", text(&poses), "--format", "csv"])
    };
    let plain = eval("X,Y,C\n100.5,100,0\n200,100,90\n");
    assert_eq!(plain, eval("X;Y;C\n100.5;100;0\n200;100;90\n"));
    assert_eq!(plain, eval("X;Y;C\n100,5;100;0\n200;100;90\n"));
    assert_eq!(plain, eval("X\tY\tC\n100.5\t100\t0\n200\t100\t90\n"));
    let wrong = |name: &str, content: &str| {
        let poses = folder.with(name, content);
        refused(&["eval", "trunnion.yaml", "--poses", text(&poses)]).1
    };
    assert!(wrong("p.csv", "100,100,-100,0,0\n").contains("the header is missing: the first line holds numbers"));
    assert!(wrong("p.xlsx", "PK\u{3}\u{4}").contains("is a workbook of a spreadsheet, not a table"));
    let rows = |scale: f64| (0..25).map(|i| format!("{}\n", f64::from(i) * scale)).collect::<String>();
    let said = wrong("p.csv", &format!("X\n{}", rows(0.02)));
    assert!(said.contains("W0804") && said.contains("from 0 to 0.48 alone: are these metres?"), "{said}");
    assert!(said.contains("say `X [m]` or `X [mm]`"), "{said}");
    assert_eq!(wrong("p.csv", &format!("X [mm]\n{}", rows(0.02))), "");
    assert_eq!(wrong("p.csv", &format!("X\n{}", rows(20.0))), "");
}

/// No pose of a plan stands in it twice: a second reading there tells of the noise alone.
#[test]
fn plans_repeat_no_pose() {
    let mut plans = 0;
    for machine in ["gantry-3ax.yaml", "trunnion.yaml", "hh-ca-gantry.yaml", "robots/ur5.yaml"] {
        for instrument in ["points", "r-test", "tracker", "laser"] {
            let fit = ["--fit", "location", "--instrument", instrument, "--plan", "12"];
            let (code, _) = refused(&[&["identify", machine], &fit[..], &["--quiet"]].concat());
            if code != 0 {
                continue;
            }
            let plan = json(&[&["identify", machine], &fit[..], &["--quiet", "--format", "json"]].concat());
            let poses = plan["poses"].as_array().unwrap();
            let key = |pose: &Value| [&pose["axes"], &pose["to"], &pose["tool"], &pose["run"]].map(Value::to_string);
            let apart: BTreeSet<_> = poses.iter().map(key).collect();
            assert!(!poses.is_empty() && apart.len() == poses.len(), "{machine}, {instrument}: {poses:?}");
            plans += 1;
        }
    }
    assert!(plans >= 9, "{plans}");
}

#[test]
fn quiet_is_quiet() {
    let folder = Folder::new("quiet");
    let machine = folder.with("m.yaml", &MACHINE.replace(", origin: [250, 225, -350]", ""));
    let _ = folder.with("x.csv", TABLE);
    let (machine, out, new) = (text(&machine), folder.file("out"), folder.file("new.yaml"));
    let files = ["page.html", "man"].map(|name| folder.file(name));
    let some = ["--poses", "5", "--samples", "20", "--class", "production"];
    let runs: Vec<Vec<&str>> = vec![
        vec!["check", machine],
        vec!["show", machine],
        vec!["eval", machine, "--at", "Y=900", "--order", "1"],
        vec!["equations", machine],
        vec!["map", machine, "--random", "20"],
        vec!["reach", machine, "--directions", "2"],
        [&["compare", machine, machine], &some[..]].concat(),
        [&["budget", machine], &some[..]].concat(),
        [&["enumerate", machine], &some[..]].concat(),
        vec!["instrument", machine, "ball-bar"],
        vec!["identify", machine, "--plan", "3"],
        vec!["compile", machine, "--target", "linuxcnc", "--out", text(&out), "--poses", "20"],
        vec!["verify", machine, text(&out), "--poses", "20"],
        vec!["diff", machine, machine],
        vec!["report", machine, "--out", text(&files[0]), "--poses", "5", "--samples", "20"],
        vec!["convert", machine, "--to", "bui-kimm", "--within", "5 nm"],
        vec!["targets"],
        vec!["explain", "EC0Y"],
        vec!["init", text(&new)],
        vec!["schema"],
        vec!["completions", "bash"],
        vec!["man", text(&files[1])],
    ];
    for run in &runs {
        let output = narrow(&[&run[..], &["--quiet"]].concat());
        // A run may be refused, and says so; one that succeeds says nothing beside its result.
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() || said.is_empty(), "{run:?}: {said}");
        assert!(output.status.success(), "{run:?}: {said}");
    }
    assert!(abbe(&["--help"]).lines().any(|line| line.trim_start().starts_with("man ")));
    let known = json(&["targets", "--format", "json"]);
    let list = String::from_utf8(narrow(&["targets"]).stdout).unwrap();
    for target in known["targets"].as_array().unwrap() {
        let name = target["target"].as_str().unwrap();
        assert_eq!(list.lines().filter(|line| line.split_whitespace().next() == Some(name)).count(), 1, "{name}");
    }
}
