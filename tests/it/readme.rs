//! README.md and the pages in docs are true: their commands run, their output is the program's, their links lead somewhere.
//!
//! In a block fenced as `console`, lines after `$ ` are commands and run in order in a copy of `configs` and `docs`,
//! one copy for each document. The other lines must be in the output of the command above them, in that order; `[...]`
//! marks omitted lines. Guides for newcomers begin in an empty folder: a block with `title="NAME"` is a file that the
//! reader writes.

use super::program::available;
use crate::oracle::program::Folder;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_abbe");

/// Commands that a block may show but that are not run here: they install, run this test, or wait for a browser.
const NOT_RUN: [&str; 7] =
    ["git clone ", "cd ", "tests/run", ".ci/run", "cargo install ", "cargo build --release", "abbe workbench "];

/// A fenced block: the text behind the fence, and its lines.
struct Block {
    kind: String,
    lines: Vec<String>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README.md and every page in docs and its folders, as paths from the top; `docs/site` holds what builds the site.
fn documents() -> Vec<PathBuf> {
    let mut all = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from).to_vec();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).unwrap().map(Result::unwrap) {
            let path = folder.join(entry.file_name());
            match path.extension() {
                Some(ending) if ending == "md" => all.push(path),
                _ if entry.file_type().unwrap().is_dir() && !path.ends_with("site") => folders.push(path),
                _ => {}
            }
        }
    }
    all.sort();
    all
}

fn text(document: &Path) -> String {
    fs::read_to_string(root().join(document)).unwrap()
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        match line.strip_prefix("```") {
            Some(_) if inside => inside = false,
            Some(kind) => {
                blocks.push(Block { kind: kind.to_owned(), lines: Vec::new() });
                inside = true;
            }
            None if inside => blocks.last_mut().unwrap().lines.push(line.to_owned()),
            None => {}
        }
    }
    assert!(!inside, "a fence is not closed");
    blocks
}

/// The text without its blocks.
fn prose(text: &str) -> String {
    let mut inside = false;
    let outside = |line: &&str| {
        let fence = line.starts_with("```");
        inside ^= fence;
        !inside && !fence
    };
    text.lines().filter(outside).collect::<Vec<_>>().join("\n")
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// A folder with the files that the documents' commands read.
fn workshop() -> Folder {
    let folder = Folder::new();
    ["configs", "docs"].iter().for_each(|name| copy(&root().join(name), &folder.path(name)));
    folder
}

/// True for pages whose reader has the program and an empty folder, and nothing of this repository.
fn newcomer(document: &Path) -> bool {
    let name = document.file_name().unwrap().to_str().unwrap();
    name.starts_with("guide-") || name == "first-machine.md"
}

impl Block {
    /// The name of the file that the block is.
    fn title(&self) -> Option<&str> {
        self.kind.split_once(" title=\"").map(|(_, name)| name.trim_end_matches('"'))
    }

    fn has_commands(&self) -> bool {
        ["console", "sh"].contains(&self.kind.as_str())
    }
}

/// Returns the shell command of a line; `None` if it is not run here.
fn runnable(command: &str, document: &Path) -> Option<String> {
    if NOT_RUN.iter().any(|start| command.starts_with(start)) {
        return None;
    }
    let ours = ["abbe ", "cargo run --release -- "]
        .iter()
        .find_map(|start| command.strip_prefix("/usr/bin/time -v ").unwrap_or(command).strip_prefix(start));
    match ours {
        Some(arguments) => Some(format!("\"$ABBE\" {arguments}")),
        None => {
            assert!(
                ["sed ", "cp ", "mkdir "].iter().any(|known| command.starts_with(known)),
                "{}: `{command}` is not known to this test",
                document.display()
            );
            Some(command.to_owned())
        }
    }
}

fn shell(folder: &Folder, script: &str) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-ec", script]).env("ABBE", PROGRAM).env("NO_COLOR", "1").env("COLUMNS", "100");
    shell.current_dir(folder.path("")).output().unwrap()
}

fn both(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Lines of a block; a command that goes on behind a backslash is one line.
fn joined(lines: &[String]) -> Vec<String> {
    let text = lines.join("\n").replace("\\\n", " ");
    text.lines().map(str::to_owned).collect()
}

/// Runs the commands of a block and compares the output in the text with theirs.
fn run(folder: &Folder, block: &Block, document: &Path) -> usize {
    let mut count = 0;
    // Nothing was run yet, or the last command is not run here.
    let mut rest: Option<String> = None;
    for line in joined(&block.lines) {
        if let Some(command) = line.strip_prefix("$ ") {
            rest = runnable(command, document).map(|script| {
                let output = shell(folder, &script);
                assert!(output.status.success(), "{}: `{command}`\n{}", document.display(), both(&output));
                count += 1;
                both(&output)
            });
        } else if let (Some(output), false) = (&mut rest, line.trim().is_empty() || line.trim() == "[...]") {
            let at = output.lines().position(|said| said.trim_end() == line.trim_end());
            let Some(at) = at else {
                panic!("{}: the program does not say\n{line}\nbut\n{output}", document.display())
            };
            *output = output.lines().skip(at + 1).collect::<Vec<_>>().join("\n");
        }
    }
    count
}

#[test]
fn commands_run_and_say_what_the_documents_say() {
    let mut count = 0;
    for document in documents() {
        let content = text(&document);
        let newcomer = newcomer(&document);
        let folder = if newcomer { Folder::new() } else { workshop() };
        for block in blocks(&content) {
            match block.title() {
                Some(name) => drop(folder.write(name, &(block.lines.join("\n") + "\n"))),
                None if block.has_commands() => count += run(&folder, &block, &document),
                None => {}
            }
        }
        for image in fs::read_dir(root().join("docs/images")).unwrap().map(|entry| entry.unwrap().file_name()) {
            // The reader of a guide draws beside the other files.
            let drawn = folder.path(if newcomer { "" } else { "docs/images" }).join(&image);
            if newcomer && !content.contains(&format!("](images/{})", image.display())) {
                continue;
            }
            let both = [root().join("docs/images").join(&image), drawn].map(|path| fs::read(path).unwrap_or_default());
            assert!(
                both[0] == both[1],
                "docs/images/{} is not what the command in {} draws",
                image.display(),
                document.display()
            );
        }
    }
    assert!(count > 15, "{count} commands");
}

#[test]
fn newcomers_need_nothing_of_this_repository() {
    let mut count = 0;
    for document in documents().into_iter().filter(|document| newcomer(document)) {
        let content = text(&document);
        for line in blocks(&content).iter().filter(|block| block.has_commands()).flat_map(|block| joined(&block.lines))
        {
            let Some(command) = line.strip_prefix("$ ") else { continue };
            count += 1;
            assert!(command.starts_with("abbe "), "{}: `{command}` needs more than abbe", document.display());
        }
        // Links lead into the repository; what is typed does not.
        let typed: String = content
            .split("](")
            .enumerate()
            .map(|(i, part)| if i == 0 { part } else { part.split_once(')').unwrap().1 })
            .collect();
        for path in ["configs/", "docs/", "tests/", "../", "`sed ", "`cp "] {
            assert!(!typed.contains(path), "{}: {path}", document.display());
        }
    }
    assert!(count > 40, "{count} commands");
}

/// The programs of the guide for LinuxCNC, read by its interpreter, which takes the end of each touch for the contact:
/// the places where the ball is expected agree with the readings of the page, whose machine is 0.05 mm off.
#[test]
fn linuxcnc_reads_the_programs_of_its_guide() {
    if !available("rs274", "programs of the guide for LinuxCNC") {
        return;
    }
    let blocks = blocks(&text(Path::new("docs/guide-linuxcnc.md")));
    let named = |name: &str| blocks.iter().find(|block| block.title() == Some(name)).unwrap().lines.clone();
    let folder = Folder::new();
    let logged = |name: &str| {
        let program = folder.write(name, &(named(name).join("\n") + "\n"));
        let mut interpreter = Command::new("rs274");
        interpreter.arg("-g").arg(program).current_dir(folder.path("")).env("HOME", folder.path(""));
        let output = interpreter.output().unwrap();
        assert!(output.status.success(), "{}", both(&output));
        let said = both(&output);
        let rows = said.lines().filter_map(|line| line.split_once("LOG(\"")?.1.strip_suffix("\")").map(str::to_owned));
        rows.collect::<Vec<String>>()
    };
    let numbers = |row: &String| row.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
    let (program, readings) = (logged("ball.ngc"), named("ball1.csv"));
    assert_eq!(program.len(), 17);
    assert_eq!(program[0], readings[0]);
    for (expected, read) in program.iter().zip(&readings).skip(1) {
        let (expected, read) = (numbers(expected), numbers(read));
        // The interpreter touches 4 mm deep, and less the radius that makes 4 mm in Z.
        let gaps: Vec<f64> = expected.iter().zip(&read).map(|(a, b)| (a - b).abs()).collect();
        assert!(gaps[1] < 0.2 && gaps[2] < 0.2 && (gaps[3] - 4.046).abs() < 0.2, "{expected:?} {read:?}");
        assert_eq!(expected[4..], read[4..]);
    }
    let along = logged("again.ngc");
    assert!(along.len() == 5 && along.iter().all(|row| (numbers(row)[2] - 11.0).abs() < 1e-3), "{along:?}");
}

/// Links of Markdown that are no addresses of the web.
fn links(text: &str) -> Vec<String> {
    let ends = prose(text)
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')').map(|(link, _)| link.to_owned()))
        .collect::<Vec<_>>();
    ends.into_iter().filter(|link| !link.contains("://")).collect()
}

/// Anchors of a page's headings.
fn anchors(text: &str) -> BTreeSet<String> {
    let keep = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let anchor = |heading: &str| {
        heading.trim().to_lowercase().chars().filter(|c| keep(*c)).collect::<String>().replace(' ', "-")
    };
    prose(text).lines().filter(|line| line.starts_with('#')).map(|line| anchor(line.trim_start_matches('#'))).collect()
}

#[test]
fn links_lead_somewhere() {
    for document in documents() {
        let content = text(&document);
        let here = root().display().to_string();
        assert!(
            !content.contains(&here) && !content.contains("/root/"),
            "{}: a path of one machine",
            document.display()
        );
        for link in links(&content) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() {
                root().join(&document)
            } else {
                root().join(&document).parent().unwrap().join(file)
            };
            assert!(target.exists(), "{}: `{link}` leads nowhere", document.display());
            let found = anchor.is_empty() || anchors(&fs::read_to_string(&target).unwrap()).contains(anchor);
            assert!(found, "{}: `{link}` has no such heading", document.display());
        }
    }
}

/// Where a second sentence of a line begins, in columns from 0. Code and text in brackets count as one word.
fn second_sentence(line: &str) -> Option<usize> {
    const ABBREVIATIONS: [&str; 6] = ["e.g.", "i.e.", "p.", "pp.", "cf.", "al."];
    let (mut depth, mut code, mut word) = (0_usize, false, String::new());
    let letters: Vec<char> = line.trim_start().chars().collect();
    for (at, letter) in letters.iter().enumerate() {
        match letter {
            '`' => code = !code,
            '(' | '[' if !code => depth += 1,
            ')' | ']' if !code => depth = depth.saturating_sub(1),
            ' ' if !code && depth == 0 => {
                let last = word.trim_end_matches([')', '"']);
                let ends = last.ends_with(['.', '!', '?']) && last.chars().filter(|c| c.is_alphanumeric()).count() > 1;
                let starts = letters.get(at + 1).is_some_and(|next| next.is_uppercase() || "`[(\"*".contains(*next));
                if ends
                    && starts
                    && !ABBREVIATIONS.contains(&last)
                    && last.trim_end_matches('.').parse::<u32>().is_err()
                {
                    return Some(at + 1);
                }
                word.clear();
                continue;
            }
            _ => {}
        }
        word.push(*letter);
    }
    None
}

#[test]
fn a_line_of_prose_has_100_columns_or_one_sentence() {
    let mut long = Vec::new();
    for document in documents() {
        let content = text(&document);
        let lines = prose(&content).lines().map(str::to_owned).collect::<Vec<_>>();
        for line in lines.iter().filter(|line| line.chars().count() > 100 && !line.trim_start().starts_with('|')) {
            if let Some(at) = second_sentence(line) {
                let next: String = line.trim_start().chars().skip(at).take(40).collect();
                long.push(format!("{}: begin a line at: {next}", document.display()));
            }
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn the_index_names_every_page() {
    let index = PathBuf::from("docs/README.md");
    let named = links(&text(&index)).into_iter().map(|link| fs::canonicalize(root().join("docs").join(link)).unwrap());
    let named: BTreeSet<PathBuf> = named.collect();
    let missing = documents().into_iter().filter(|page| *page != index && !named.contains(&root().join(page)));
    assert_eq!(missing.collect::<Vec<_>>(), Vec::<PathBuf>::new());
}

#[test]
fn the_front_page_is_short() {
    let page = text(Path::new("README.md"));
    assert!(page.lines().count() <= 100, "{} lines", page.lines().count());
    let wide: Vec<&str> = page.lines().filter(|line| line.chars().count() > 80).collect();
    assert!(wide.is_empty(), "over 80 columns: {wide:#?}");
}

/// The table of the front page: what each mechanism leaves of the deviation of one machine.
#[test]
fn the_front_page_says_what_each_mechanism_leaves() {
    let page = text(Path::new("README.md"));
    let rows = page.lines().skip_while(|line| !line.starts_with("| mechanism | target | leaves |")).skip(2);
    let mut count = 0;
    for row in rows.take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let targets = cells[2].trim_matches('`').split('+').flat_map(|target| ["--target", target]);
        let output = Command::new(PROGRAM)
            .args(["compile", "configs/trunnion.yaml", "--accept-unverified", "--format", "json", "--out", "set"])
            .args(["--map", "X=AX1,Y=AX2,Z=AX3,A=AX4,C=AX5"])
            .args(targets)
            .current_dir(workshop().path(""))
            .output()
            .unwrap();
        let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let left = answer["compensated"]["position_um"]["p95"].as_f64().unwrap();
        match cells[3].strip_suffix(" um").unwrap().strip_prefix("below ") {
            Some(limit) => assert!(left < limit.parse().unwrap(), "{row}: {left}"),
            None => {
                let stated: f64 = cells[3].trim_end_matches(" um").parse().unwrap();
                assert!((left / stated - 1.0).abs() < 2e-3, "{row}: {left}");
            }
        }
        let before = answer["uncompensated"]["position_um"]["p95"].as_f64().unwrap();
        assert!((before - 34.0).abs() < 0.5, "{row}: {before} before");
        count += 1;
    }
    assert_eq!(count, 6);
}

#[test]
fn every_verb_and_every_target_is_described() {
    let all: String = documents().iter().map(|document| text(document)).collect();
    let help = Command::new(PROGRAM).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let commands =
        help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1).take_while(|line| !line.is_empty());
    let verbs: Vec<&str> =
        commands.filter_map(|line| line.split_whitespace().next()).filter(|verb| *verb != "help").collect();
    assert!(verbs.contains(&"compile"), "{help}");
    let targets = Command::new(PROGRAM).args(["targets", "--format", "csv"]).output().unwrap();
    let targets = String::from_utf8(targets.stdout).unwrap();
    let targets: Vec<&str> = targets.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert!(targets.contains(&"linuxcnc"));
    for name in verbs.iter().chain(&targets) {
        let marked = [format!("`{name}"), format!("abbe {name}")];
        assert!(marked.iter().any(|form| all.contains(form)), "`{name}` is nowhere described");
    }
}

/// Fragments of the language page extend this.
const BASE: &str = "
abbe: 1
machine: Base
chain: \"w C' A' Y' b X Z t\"
axes:
  X: { travel: [0 mm, 500 mm], origin: [0, 0, 0] }
  Y: { travel: [0 mm, 450 mm], origin: [0, 0, 0] }
  Z: { travel: [-400 mm, 0 mm], origin: [0, 0, 0] }
  A: { travel: [-120 deg, 30 deg] }
  C: { travel: continuous }
";

#[test]
fn examples_of_the_machine_language_are_accepted() {
    let folder = workshop();
    folder.write("configs/base.yaml", BASE);
    let page = text(Path::new("docs/language.md"));
    let mut count = 0;
    for block in blocks(&page).iter().filter(|block| block.kind == "yaml") {
        let example = block.lines.join("\n");
        let whole = example.contains("machine: ") && !example.contains("extends: ");
        let (name, example) = match example.contains("extends: ") {
            true => ("configs/variants/example.yaml", example),
            false if whole => ("configs/example.yaml", example),
            false => ("configs/example.yaml", format!("abbe: 1\nextends: base.yaml\n{example}")),
        };
        folder.write(name, &example);
        let output = shell(&folder, &format!("\"$ABBE\" check {name}"));
        assert!(output.status.success(), "{example}\n{}", both(&output));
        count += 1;
    }
    assert!(count > 10, "{count} examples");
    let table = blocks(&page).into_iter().find(|block| block.kind == "csv").unwrap();
    folder.write("configs/table.csv", &table.lines.join("\n"));
    folder.write(
        "configs/example.yaml",
        "abbe: 1\nmachine: M\nchain: w b X t\naxes: { X: { travel: [0, 50], origin: [0, 0, 0] } }\nmeasured: [table.csv]\n",
    );
    let output = shell(&folder, "\"$ABBE\" check configs/example.yaml");
    assert!(output.status.success(), "{}", both(&output));
}

#[test]
fn the_page_on_targets_quotes_the_example_that_runs() {
    let page = text(Path::new("docs/adding-a-target.md"));
    for file in fs::read_dir(root().join("docs/examples/northmill")).unwrap() {
        let file = file.unwrap().path();
        assert!(page.contains(&fs::read_to_string(&file).unwrap()), "{} is not quoted", file.display());
    }
}
