//! Every folder of tests/diagnostics is a machine file with mistakes and the text that is shown for
//! it. UPDATE_EXPECTED=1 writes the texts anew; read them before they are committed.

use abbe::diagnostic::{CODES, Diagnostics, Rendering, render, summary};
use abbe::machine;
use abbe::syntax::Disk;
use abbe::syntax::{self, Files, ReadFailure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A folder as the place where the program runs.
struct Folder(PathBuf);

impl Files for Folder {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        Disk.read(&self.0.join(path))
    }
}

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let mut folders: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    folders.sort();
    folders
}

/// The text shown, and the codes in it.
fn shown(folder: &Path) -> (String, BTreeSet<&'static str>) {
    let files = Folder(folder.to_owned());
    let mut diagnostics = Diagnostics::default();
    let document = syntax::load(Path::new("machine.yaml"), &files, &mut diagnostics);
    let machine = document.and_then(|d| machine::resolve(&d, &files, &mut diagnostics));
    assert_eq!(machine.is_none(), diagnostics.is_refused(), "{}", folder.display());
    let text = render(&diagnostics, Rendering::default()) + &summary(&diagnostics) + "\n";
    (text, diagnostics.iter().map(|d| d.code.id).collect())
}

#[test]
fn every_example_is_shown_as_expected() {
    let update = std::env::var_os("UPDATE_EXPECTED").is_some();
    let mut wrong = Vec::new();
    for folder in examples() {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        let (text, codes) = shown(&folder);
        let wanted = name.split('-').next().unwrap();
        assert!(name.starts_with("many") || codes.contains(wanted), "{name} shows {codes:?}:\n{text}");
        let expected = folder.join("expected.txt");
        if update {
            std::fs::write(&expected, &text).unwrap();
        } else if std::fs::read_to_string(&expected).unwrap_or_default() != text {
            wrong.push(format!("{name}:\n{text}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_code_that_a_file_can_cause_has_an_example() {
    // E0103 needs a file of 100 MB or 100000 rows: bad_input.rs. W0413 is of `check`: questions.rs. From E05 on: later
    // stages.
    let elsewhere =
        |code: &str| ["E0103", "W0413"].contains(&code) || code[1..].starts_with("05") || &code[1..3] >= "05";
    let seen: BTreeSet<&str> = examples().iter().flat_map(|f| shown(f).1).collect();
    let missing: Vec<&str> = CODES.iter().map(|c| c.id).filter(|c| !elsewhere(c) && !seen.contains(c)).collect();
    assert!(missing.is_empty(), "no example for {missing:?}");
}

#[test]
fn every_code_is_in_the_table_once_and_explained() {
    let codes: BTreeSet<&str> = CODES.iter().map(|c| c.id).collect();
    assert_eq!(codes.len(), CODES.len());
    for code in CODES {
        assert!(code.explanation.len() > 60 && !code.title.is_empty(), "{}", code.id);
    }
    let used = codes_in(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let unknown: Vec<_> = used.iter().filter(|c| !codes.contains(c.as_str())).collect();
    assert!(unknown.is_empty(), "not in the table: {unknown:?}");
    let unused: Vec<_> = codes.iter().filter(|c| !used.contains(**c)).collect();
    assert!(unused.is_empty(), "in the table but never reported: {unused:?}");
}

/// Codes that the sources name, the table itself excepted.
fn codes_in(folder: &Path) -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.is_dir() {
            codes.extend(codes_in(&path));
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("diagnostic/codes.rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let named = text.split("codes::").skip(1).filter_map(|rest| rest.get(..5));
            let is_code = |t: &&str| t.starts_with(['E', 'W']) && t[1..].bytes().all(|b| b.is_ascii_digit());
            codes.extend(named.filter(is_code).map(str::to_owned));
        }
    }
    codes
}
