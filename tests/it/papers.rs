//! docs/papers.md is true: every command of the concordance runs and prints what the row says, and its tests exist.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A row of the concordance.
struct Row {
    place: String,
    command: Vec<String>,
    prints: Vec<String>,
    tests: Vec<String>,
}

/// The parts of a cell in backticks.
fn quoted(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn rows() -> Vec<Row> {
    let text = std::fs::read_to_string(root().join("docs/papers.md")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [place, command, prints, tests, _] = cells[..] else { return None };
        let command = quoted(command).first()?.clone();
        let command = command.strip_prefix("abbe ")?.to_owned();
        // Words in double quotes stay whole.
        let words = command.split('"').enumerate().flat_map(|(k, part)| match k % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect(),
            _ => vec![part.to_owned()],
        });
        Some(Row { place: place.to_owned(), command: words.collect(), prints: quoted(prints), tests: quoted(tests) })
    };
    text.lines().filter(|line| line.starts_with("| ")).filter_map(row).collect()
}

fn squeezed(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn every_command_of_the_concordance_prints_what_it_says() {
    let rows = rows();
    assert!(rows.len() >= 30, "the table is found: {} rows", rows.len());
    for Row { place, command, prints, .. } in &rows {
        assert!(!prints.is_empty(), "{place}: says nothing of what is printed");
        let mut run = Command::new(env!("CARGO_BIN_EXE_abbe"));
        let output = run.arg("--wide").args(command).current_dir(root()).output().unwrap();
        let [out, complaint] = [&output.stdout, &output.stderr].map(|bytes| squeezed(&String::from_utf8_lossy(bytes)));
        let expected = i32::from(out.starts_with("Not admissible"));
        assert_eq!(output.status.code(), Some(expected), "{place}: {command:?}\n{complaint}");
        for wanted in prints {
            assert!(out.contains(&squeezed(wanted)), "{place}: {command:?} does not print `{wanted}`\n{out}");
        }
    }
}

#[test]
fn every_test_of_the_concordance_exists() {
    let mut sources = String::new();
    let mut folders = vec![PathBuf::from("tests/it"), PathBuf::from("src/algebra")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).unwrap().map(Result::unwrap) {
            let path = folder.join(entry.file_name());
            match path.extension() {
                Some(ending) if ending == "rs" => sources += &std::fs::read_to_string(root().join(path)).unwrap(),
                _ if entry.file_type().unwrap().is_dir() => folders.push(path),
                _ => {}
            }
        }
    }
    for Row { place, tests, .. } in rows() {
        for test in tests {
            assert!(sources.contains(&format!("fn {test}(")), "{place}: there is no test {test}");
        }
    }
}

/// The table of degrees, against runs of the program over each algebra and over the exact model.
#[test]
fn each_degree_leaves_what_the_table_says() {
    let text = std::fs::read_to_string(root().join("docs/papers.md")).unwrap();
    let deviation = |more: &[&str]| {
        let mut run = Command::new(env!("CARGO_BIN_EXE_abbe"));
        let file = "docs/examples/papers/large-errors.yaml";
        let at = ["eval", file, "--at", "X=150,Y=-120,Z=80,A=-50,C=70", "--format", "json"];
        let output = run.args(at).args(more).current_dir(root()).output().unwrap();
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let vector: [f64; 3] = std::array::from_fn(|k| json["poses"][0]["deviation"][k].as_f64().unwrap());
        (vector, json["algebra"]["monomials"].as_array().map_or(0, Vec::len))
    };
    let (exact, _) = deviation(&[]);
    for degree in 1..=6 {
        let (found, monomials) = deviation(&["--algebra", &format!("degree: {degree}, generators: per-axis")]);
        let distance = (0..3).map(|k| (found[k] - exact[k]) * (found[k] - exact[k])).sum::<f64>().sqrt();
        let choose = |n: usize| (1..=degree).fold(1, |product, i| product * (n + i) / i);
        let row = format!("| {degree} | {monomials} | {} | {distance:.1e} |", choose(10));
        assert!(monomials == choose(5) && text.contains(&row), "{row}");
    }
}
