//! Sentences of documents, long texts of messages and help have at most 30 words. Code blocks, tables and headings are
//! no prose.

use super::program::abbe_on;
use std::path::{Path, PathBuf};

const WORDS: usize = 30;

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
        let name = page.strip_prefix(root).unwrap().display();
        let text = std::fs::read_to_string(page).unwrap();
        for paragraph in paragraphs(&text).iter().filter(|of| sentences(of).iter().any(|words| *words > WORDS)) {
            wrong.push(format!("{name}: {}", paragraph.chars().take(200).collect::<String>()));
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
