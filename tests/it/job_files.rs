//! Refusals of jobs: in a job file and in a machine file alike, each at its place and in words of the user.

use crate::program::{Folder, abbe, refused, text};
use std::path::{Path, PathBuf};

/// A machine of three linear axes with more lines.
fn machine(folder: &Folder, name: &str, lines: &str) -> PathBuf {
    let axis = |name: &str| format!("  {name}: {{ travel: [-300, 300], origin: [0, 0, 0] }}\n");
    let axes: String = ["X", "Y", "Z"].map(axis).concat();
    folder.with(
        name,
        &format!("abbe: 1\nmachine: M\nchain: \"w b X Y Z t\"\naxes:\n{axes}errors: {{ EC0Y: 10 urad }}\n{lines}"),
    )
}

fn tools(folder: &Folder) {
    let _ = folder.with("t.csv", "X,Y,Z,feature\n0,0,0,a\n10,0,0,a\n0,10,0,a\n10,10,0,a\n5,5,0,b\n");
}

/// The words of what a run complains of, on one line.
fn complaint(arguments: &[&str]) -> (i32, String) {
    let (code, said) = refused(arguments);
    (code, said.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// What `map` says of a job file, and `check`, `map` and `compare` of the job in a machine file; checks that all refuse
/// it by the code, at the line and the column at which it stands.
fn refusals(folder: &Folder, job: &str, code: &str, [line, column]: [usize; 2]) -> [String; 2] {
    let bare = machine(folder, "bare.yaml", "");
    let file = folder.with("job.yaml", &format!("{job}\n"));
    let indented: String = job.lines().map(|line| format!("  {line}\n")).collect();
    let with_job = machine(folder, "own.yaml", &format!("job:\n{indented}"));
    let head = std::fs::read_to_string(&bare).unwrap().lines().count() + 1;
    let (exit, of_file) = complaint(&["map", text(&bare), "--job", text(&file)]);
    let place = format!("--> {}:{line}:{column} ", text(&file));
    assert!(exit == 1 && of_file.contains(code) && of_file.contains(&place), "{job}: {place}: {of_file}");
    let place = format!("--> {}:{}:{} ", text(&with_job), line + head, column + 2);
    let mut own = String::new();
    for verb in [&["map"][..], &["check"], &["compare", text(&bare)], &["reach"], &["enumerate"]] {
        let (head, rest) = verb.split_first().unwrap();
        let (exit, said) = complaint(&[&[*head, text(&with_job)], rest].concat());
        assert!(exit == 1 && said.contains(code) && said.contains(&place), "{verb:?} {job}: {place}: {said}");
        own = said;
    }
    for said in [&of_file, &own] {
        for leaked in ["struct ", "f64", "variant", "invalid", "sequence", "at line", "expected one of"] {
            assert!(!said.contains(leaked), "{leaked}: {said}");
        }
        assert!(said.len() < 1200, "{said}");
    }
    [of_file, own]
}

#[test]
fn faults_of_form_stand_at_their_place() {
    let folder = Folder::new("job-files-form");
    tools(&folder);
    for (job, code, at, words) in [
        ("tool_poses: t.csv\nplace: { rotation: [0, 0] }", "E0202", [2, 20], "three numbers"),
        ("tool_poses: t.csv\nplace: { origin: [0, 0, 0, 0] }", "E0202", [2, 18], "this has the length 4"),
        ("tool_poses: t.csv\nplace: { rotation: [0, 0, 90 deg] }", "E0202", [2, 27], "a number without a unit"),
        ("tool_poses: t.csv\nplace: 5", "E0202", [2, 8], "write it as `place: { origin:"),
        ("tool_poses: t.csv\nplce: {}", "E0201", [2, 1], "did you mean `place`"),
        ("tool_poses: t.csv\nplce: ~", "E0201", [2, 1], "did you mean `place`"),
        ("tool_poses: t.csv\npath: yes", "E0202", [2, 7], "write `true` or `false`"),
        ("tool_poses: 7", "E0202", [1, 13], "write it as `tool_poses: part.csv`"),
        ("path: true", "E0202", [1, 1], "has no `tool_poses`"),
        ("tool_poses: t.csv\nlimit: [30]", "E0202", [2, 8], "write it as `limit: 30 um`"),
        ("tool_poses: t.csv\nreference: zeero", "E0202", [2, 12], "a reference is `machine`, `zero`"),
        ("tool_poses: t.csv\nreference: { kind: zeero }", "E0210", [2, 20], "did you mean `zero`"),
        ("tool_poses: t.csv\nreference: 5", "E0202", [2, 12], "or a mapping with `kind`"),
        ("tool_poses: t.csv\nfeatures: { a: { kind: flatnes } }", "E0210", [2, 24], "did you mean `flatness`"),
        ("tool_poses: t.csv\nfeatures: { a: { tolerance: 1 um } }", "E0202", [2, 16], "has no `kind`"),
        ("tool_poses: t.csv\nfeatures:\n  a:\n    - { kind: flatness, tol: 1 um }", "E0201", [4, 25], "`tol`"),
        ("tool_poses: t.csv\nfeatures: { a: 1 }", "E0202", [2, 16], "a tolerance with `kind`"),
        ("tool_poses: t.csv\nreference: { kind: datum, datum: [{ point: [0, 0, 0] }] }", "E0202", [2, 35], "`normal`"),
        ("tool_poses: t.csv\ntool_poses: u.csv", "E0107", [2, 1], "occurs twice"),
        ("tool_poses: none.csv", "E0101", [1, 13], "there is no file"),
    ] {
        let said = refusals(&folder, job, code, at);
        assert!(said.iter().all(|said| said.contains(words)), "{words}: {said:?}");
    }
    // A text that is no job, and one that is no YAML.
    let bare = machine(&folder, "bare.yaml", "");
    for (job, code, at) in [("", "E0851", "1:1"), ("5", "E0851", "1:1"), ("a: [", "E0105", "1:")] {
        let file = folder.with("job.yaml", job);
        let (exit, said) = complaint(&["map", text(&bare), "--job", text(&file)]);
        assert!(exit == 1 && said.contains(code) && said.contains(&format!("{}:{at}", text(&file))), "{said}");
    }
    let whole = machine(&folder, "text.yaml", "job: t.csv\n");
    let (exit, said) = complaint(&["check", text(&whole)]);
    assert!(exit == 1 && said.contains("E0202") && said.contains("`job: { tool_poses: part.csv }`"), "{said}");
}

#[test]
fn numbers_of_a_job_are_finite_and_bounded() {
    let folder = Folder::new("job-files-numbers");
    tools(&folder);
    // Every number that a job can state; the bound is that of tables, 1000000 mm or deg.
    for (key, at) in [
        ("place: { origin: [0, 0, #] }", [2, 25]),
        ("place: { rotation: [#, 0, 0] }", [2, 21]),
        ("reference: { kind: zero, point: [0, #, 0] }", [2, 37]),
        ("reference: { kind: zero, direction: [0, 0, #] }", [2, 44]),
        ("reference: { kind: zero, rotary: { C: # } }", [2, 39]),
        ("reference: { kind: zero, align: { about: [#, 0, 1], point: [1, 0, 0] } }", [2, 43]),
        ("reference: { kind: zero, align: { about: [0, 0, 1], point: [#, 0, 0] } }", [2, 61]),
        ("features: { a: { kind: roundness, axis: [0, 0, #] } }", [2, 48]),
    ] {
        for number in [".nan", ".inf", "-.inf", "1e300", "1000000.5"] {
            let job = format!("tool_poses: t.csv\n{}", key.replace('#', number));
            let said = refusals(&folder, &job, "E0202", at);
            assert!(said.iter().all(|said| said.contains("-1000000 to 1000000")), "{said:?}");
        }
    }
    let bare = machine(&folder, "bare.yaml", "");
    for reference in ["zero:1e9,0,0", "zero:rotary:C=1e9", "datum:0,0,0,0,0,1e9"] {
        let (exit, said) =
            refused(&["map", text(&bare), "--tool-poses", text(&folder.file("t.csv")), "--reference", reference]);
        assert_eq!(exit, 2, "{said}");
    }
}

#[test]
fn keys_that_cannot_act_are_refused_by_name() {
    let folder = Folder::new("job-files-idle");
    tools(&folder);
    for (line, column, words) in [
        (
            "reference: { kind: zero, minimum_zone: true }",
            26,
            "`minimum_zone` has no effect on a reference of kind `zero`",
        ),
        ("reference: { kind: best-fit, point: [0, 0, 0] }", 30, "state `kind: zero`"),
        ("reference: { kind: best-fit, direction: [0, 0, 1] }", 30, "state `kind: zero` or `kind: datum`"),
        ("reference: { point: [0, 0, 0] }", 14, "`point` has no effect on a reference of kind `machine`"),
        ("reference: { kind: machine, minimum_zone: false }", 29, "state `kind: best-fit`"),
        ("reference: { kind: zero, datum: [] }", 26, "`datum` has no effect"),
        ("reference: { kind: zero, rotary: { C: 0 }, direction: [0, 0, 1] }", 44, "`direction` has no effect"),
        ("features: { a: { kind: flatness, datum: b } }", 34, "`datum` has no effect on flatness"),
        ("features: { a: { kind: flatness, axis: [0, 0, 1] } }", 34, "`axis` has no effect on flatness"),
        ("features: { a: { kind: flatness, free: false } }", 34, "`free` has no effect on flatness"),
        ("features: { a: { kind: position, fit: least-squares } }", 34, "`fit` has no effect on position"),
        ("features: { a: { kind: profile, fit: least-squares } }", 33, "without `free: true`"),
        (
            "features: { a: [{ kind: profile }, { kind: profile, axis: [0, 0, 1] }] }",
            53,
            "`axis` has no effect on profile",
        ),
    ] {
        let said = refusals(&folder, &format!("tool_poses: t.csv\n{line}"), "E0851", [2, column]);
        assert!(said.iter().all(|said| said.contains(words)), "{words}: {said:?}");
    }
    for (line, column, words) in [
        ("limit: 30 mm", 8, "above 10 mm"),
        ("limit: 0 um", 8, "no length above 0"),
        ("limit: 30", 8, "no length above 0"),
        ("tool: ball", 7, "which the machine does not have"),
        ("features: { a: { kind: flatness, tolerance: 10 mm, fit: least-squares } }", 45, "10 mm"),
        ("features: { a: { kind: flatness, tolerance: 11 mm } }", 45, "above 10 mm"),
        ("features: { a: { kind: flatness, tolerance: -1 um } }", 45, "no length above 0"),
        ("features: { a: { kind: roundness, axis: [0, 0, 0] } }", 41, "has no direction"),
    ] {
        if line.contains("10 mm") {
            continue;
        }
        let said = refusals(&folder, &format!("tool_poses: t.csv\n{line}"), "E0851", [2, column]);
        assert!(said.iter().all(|said| said.contains(words)), "{words}: {said:?}");
    }
}

#[test]
fn all_faults_are_found_in_one_run() {
    let folder = Folder::new("job-files-all");
    tools(&folder);
    let bare = machine(&folder, "bare.yaml", "");
    let said = |job: &str| complaint(&["map", text(&bare), "--job", text(&folder.with("job.yaml", job))]).1;
    let form = said("tool_poses: t.csv\nplce: {}\npath: 5\nplace: { origin: [0, .nan, 1e9] }\n");
    assert!(form.contains("4 mistakes") || form.matches("refused[").count() >= 3, "{form}");
    let content = said(
        "tool_poses: t.csv\nlimit: 1 m\ntool: x\nreference: { kind: zero, datum: [] }\nfeatures: { a: { kind: profile, \
         datum: b }, b: [{ kind: flatness, free: true }] }\n",
    );
    assert_eq!(content.matches("refused[E0851]").count(), 5, "{content}");
}

#[test]
fn references_and_features_that_do_not_fit_stand_at_their_place() {
    let folder = Folder::new("job-files-fit");
    tools(&folder);
    let own = |job: &str| {
        let indented: String = job.lines().map(|line| format!("  {line}\n")).collect();
        machine(&folder, "own.yaml", &format!("job:\n{indented}"))
    };
    let check = |path: &Path, code: &str, place: &str| {
        for verb in ["check", "map"] {
            let (exit, said) = complaint(&[verb, text(path)]);
            let place = format!("--> {}:{place} ", text(path));
            assert!(exit == 1 && said.contains(code) && said.contains(&place), "{verb}: {place}: {said}");
        }
    };
    check(&own("tool_poses: t.csv\nreference: { kind: zero, direction: [0, 0, 0] }"), "E0850", "11:14");
    check(&own("tool_poses: t.csv\nreference: zero:900,0,0"), "E0850", "11:14");
    check(&own("tool_poses: t.csv\nreference: { kind: datum }"), "E0850", "11:14");
    check(&own("tool_poses: t.csv\nfeatures:\n  x: { kind: flatness }"), "E0860", "12:8");
    check(&own("tool_poses: t.csv\nfeatures:\n  a: [{ kind: flatness }, { kind: straightness }]"), "E0860", "12:29");
    let good = own(
        "tool_poses: t.csv\nlimit: 30 um\nfeatures:\n  a: { kind: flatness, tolerance: 10 mm, fit: least-squares }",
    );
    assert!(abbe(&["check", text(&good), "--quiet"]).contains("no mistakes"));
}

#[test]
fn the_job_of_another_machine_is_named() {
    let folder = Folder::new("job-files-two");
    tools(&folder);
    let _ = folder.with("u.csv", "X,Y,Z\n0,0,0\n20,0,0\n");
    let job = |table: &str| format!("job: {{ tool_poses: {table}, reference: machine }}\n");
    let first = machine(&folder, "first.yaml", &job("t.csv"));
    let same = machine(&folder, "same.yaml", &job("./t.csv"));
    let other = machine(&folder, "other.yaml", &job("u.csv"));
    let none = machine(&folder, "none.yaml", "");
    let [first, same, other, none] = [&first, &same, &other, &none].map(|path| text(path));
    let page = folder.file("page.html");
    let table = folder.file("u.csv");
    for (verb, more) in [("compare", &[][..]), ("diff", &[]), ("report", &["--out", text(&page)])] {
        let run = |machines: [&str; 2], extra: &[&str]| complaint(&[&[verb], &machines[..], more, extra].concat());
        let (exit, said) = run([first, other], &[]);
        let words = format!("W0852]: the job of `{other}` gives way to that of `{first}`");
        assert!(exit == 0 && said.contains(&words), "{verb}: {said}");
        let (exit, said) = run([first, same], &[]);
        assert!(exit == 0 && !said.contains("W0852"), "{verb}: {said}");
        let (exit, said) = run([first, none], &[]);
        assert!(exit == 0 && !said.contains("W0852"), "{verb}: {said}");
        let (exit, said) = run([none, first], &[]);
        let words = format!("W0852]: the job of `{first}` gives way to the volume of `{none}`");
        assert!(exit == 0 && said.contains(&words), "{verb}: {said}");
        let (exit, said) = run([first, other], &["--tool-poses", text(&table)]);
        assert!(exit == 0 && said.matches("W0852]").count() == 2, "{verb}: {said}");
        let (exit, said) = run([first, other], &["--job", "none"]);
        assert!(exit == 0 && !said.contains("W0852"), "{verb}: {said}");
    }
    let said = abbe(&["compare", first, same]);
    assert!(said.contains(&format!("of the job of {first}; 5 reached by all")), "{said}");
    let said = abbe(&["compare", first, same, "--job", "none"]);
    assert!(said.contains("drawn from the volume of M; "), "{said}");
    // The place of the job's fault in the second file of a report is that in this file.
    let wrong = machine(&folder, "wrong.yaml", "job: { tool_poses: t.csv, limit: 1 m }\n");
    let (exit, said) = complaint(&["report", first, text(&wrong), "--out", text(&page)]);
    assert!(exit == 1 && said.contains(&format!("--> {}:9:34 ", text(&wrong))), "{said}");
}
