//! Sentences of documents, long texts of messages and help have at most 30 words. Code blocks, tables and headings are
//! no prose. Pages that had longer ones when the rule came are listed with how many; the numbers only fall.

use super::program::abbe_on;
use std::path::{Path, PathBuf};

const WORDS: usize = 30;

/// Longer sentences of a page.
const LONGER: [(&str, usize); 49] = [
    ("CHANGELOG.md", 12),
    ("docs/adding-a-target.md", 5),
    ("docs/algebra.md", 3),
    ("docs/architecture.md", 7),
    ("docs/budget.md", 15),
    ("docs/cluster.md", 1),
    ("docs/compensation.md", 15),
    ("docs/controls/README.md", 2),
    ("docs/controls/fanuc.md", 4),
    ("docs/controls/heidenhain.md", 5),
    ("docs/controls/isg-twincat.md", 6),
    ("docs/controls/linuxcnc.md", 5),
    ("docs/conventions.md", 4),
    ("docs/enumerate.md", 2),
    ("docs/formats/designs.md", 3),
    ("docs/formats/jobs.md", 17),
    ("docs/formats/json.md", 5),
    ("docs/formats/maps.md", 4),
    ("docs/formats/measurements.md", 1),
    ("docs/formats/sets.md", 9),
    ("docs/formats/tool-poses.md", 7),
    ("docs/guide-data-sheets.md", 1),
    ("docs/identify/examples.md", 4),
    ("docs/identify/fit.md", 16),
    ("docs/identify/import.md", 9),
    ("docs/identify/method.md", 19),
    ("docs/instruments.md", 4),
    ("docs/kinematic-parameters.md", 3),
    ("docs/linuxcnc-kins.md", 13),
    ("docs/performance.md", 17),
    ("docs/python.md", 4),
    ("docs/record.md", 4),
    ("docs/reliability.md", 5),
    ("docs/report.md", 6),
    ("docs/second-measurement.md", 2),
    ("docs/standards.md", 8),
    ("docs/theory.md", 4),
    ("docs/workbench.md", 8),
    ("src/diagnostic/explain/E0501.md", 1),
    ("src/diagnostic/explain/E0509.md", 1),
    ("src/diagnostic/explain/E0523.md", 1),
    ("src/diagnostic/explain/E0524.md", 1),
    ("src/diagnostic/explain/E0731.md", 1),
    ("src/diagnostic/explain/E0751.md", 1),
    ("src/diagnostic/explain/E0812.md", 1),
    ("src/diagnostic/explain/E0851.md", 1),
    ("src/diagnostic/explain/W0511.md", 1),
    ("src/diagnostic/explain/W0512.md", 1),
    ("src/diagnostic/explain/W0714.md", 1),
];

/// A text without code in it, and links as their words.
fn bare(text: &str) -> String {
    let without_code: String =
        text.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "Code" }).collect();
    let mut rest = without_code.as_str();
    let mut bare = String::new();
    while let Some((before, after)) = rest.split_once("](") {
        bare += before;
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    (bare + rest).replace('[', "")
}

/// The paragraphs of prose of a page; an item of a list is one.
fn paragraphs(page: &str) -> Vec<String> {
    let (mut found, mut open, mut fenced) = (vec![String::new()], false, false);
    for line in page.lines() {
        let content = line.trim_start();
        fenced ^= content.starts_with("```");
        let is_prose = !fenced && !content.starts_with(['#', '|', '!', '`'])
            || content.starts_with('`') && !fenced && !content.starts_with("```");
        if !is_prose || content.is_empty() || line.starts_with("    ") {
            open = false;
            continue;
        }
        let item = ["- ", "* "].iter().find_map(|mark| content.strip_prefix(mark)).or_else(|| {
            let (number, rest) = content.split_once(". ")?;
            number.parse::<u32>().is_ok().then_some(rest)
        });
        if !open || item.is_some() {
            found.push(String::new());
        }
        open = true;
        found.last_mut().unwrap().push_str(&format!("{} ", item.unwrap_or(content)));
    }
    found
}

/// Numbers of words of the sentences of a paragraph. A colon before a sentence of its own ends one, too.
fn sentences(paragraph: &str) -> Vec<usize> {
    let text = bare(paragraph);
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut counts = vec![0];
    for (i, word) in words.iter().enumerate() {
        *counts.last_mut().unwrap() += 1;
        let end = word.trim_end_matches(['"', ')', '*', '\'']);
        let next = words
            .get(i + 1)
            .is_some_and(|next| next.trim_start_matches(['(', '*', '"']).starts_with(char::is_uppercase));
        if next && end.ends_with(['.', '?', '!', ':']) {
            counts.push(0);
        }
    }
    counts
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match entry.extension() {
            Some(ending) if ending == "md" => found.push(entry),
            _ if entry.is_dir() => pages(&entry, found),
            _ => {}
        }
    }
}

#[test]
fn sentences_of_documents_have_30_words() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name)).to_vec();
    pages(&root.join("docs"), &mut all);
    pages(&root.join("src/diagnostic/explain"), &mut all);
    all.sort();
    assert!(all.len() > 200);
    let mut wrong = Vec::new();
    for page in &all {
        let name = page.strip_prefix(root).unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(page).unwrap();
        let long: Vec<String> =
            paragraphs(&text).into_iter().filter(|of| sentences(of).iter().any(|words| *words > WORDS)).collect();
        let count: usize =
            long.iter().flat_map(|paragraph| sentences(paragraph)).filter(|words| *words > WORDS).count();
        let listed = LONGER.iter().find(|(listed, _)| *listed == name).map_or(0, |(_, count)| *count);
        if count != listed {
            let first = long.first().map_or("", String::as_str);
            wrong.push(format!("(\"{name}\", {count}), not {listed}: {}", first.chars().take(200).collect::<String>()));
        }
    }
    assert!(wrong.is_empty(), "sentences of more than {WORDS} words:\n{}", wrong.join("\n"));
}

#[test]
fn sentences_of_help_have_30_words() {
    let help = |arguments: &[&str]| String::from_utf8(abbe_on(1, arguments).stdout).unwrap();
    let list = help(&["--help"]);
    let verbs = list.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let verbs: Vec<&str> = verbs.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(verbs.len() > 25);
    let mut long = Vec::new();
    for verb in verbs.iter().filter(|verb| **verb != "help") {
        // Help of an option stands below it, indented.
        let help = help(&[verb, "--help"]);
        let mut paragraph = String::new();
        for line in help.lines().chain([""]) {
            if line.starts_with("          ") && !line.trim_start().starts_with('-') {
                paragraph += &format!("{} ", line.trim());
                continue;
            }
            // Defaults and possible values are no prose.
            let prose = paragraph.split('[').next().unwrap_or("");
            let longest = sentences(prose).into_iter().max().unwrap_or(0);
            if longest > WORDS {
                long.push(format!("{verb}, {longest}: {paragraph}"));
            }
            paragraph.clear();
        }
    }
    long.dedup();
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn the_count_of_words_notices() {
    let page = "# T\n\nOne two three. Four `five six`: Seven [eight nine](x.md#y).\n\n- Ten\n  eleven\n\n```text\nx\n```\n| y |\n";
    let counts: Vec<Vec<usize>> = paragraphs(page).iter().skip(1).map(|of| sentences(of)).collect();
    assert_eq!(counts, [vec![3, 2, 3], vec![2]]);
}
