//! Parts of a release besides the program: the commit in its version, manual pages, completions.

use crate::oracle::program::Folder;
use std::path::Path;
use std::process::Command;

#[path = "../../build.rs"]
mod build_script;

fn abbe(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_abbe")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs git as a user of its own, whatever the machine's settings are.
fn git(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new("git");
    command.args(["-c", "user.name=a", "-c", "user.email=a@example.invalid", "-c", "commit.gpgsign=false", "-C"]);
    let output = command.arg(folder).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// Makes a repository with one commit of a `Cargo.toml`; returns the commit.
fn repository(folder: &Path) -> String {
    git(folder, &["init", "-q"]);
    std::fs::write(folder.join("Cargo.toml"), "[package]\n").unwrap();
    git(folder, &["add", "."]);
    git(folder, &["commit", "-qm", "First"]);
    git(folder, &["rev-parse", "HEAD"])
}

/// `Cargo.toml` has the version. What repeats it agrees, behind these words.
#[test]
fn the_version_is_one_number() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, words) in [
        ("docs/repository.md", "rev: v"),
        ("docs/repository.md", "--tag v"),
        ("docs/adding-a-target.md", "written by abbe "),
        ("docs/cluster.md", "abbe-dask:"),
        ("docs/python.md", "pip install abbe-"),
        ("docs/formats/measurements.md", "\"abbe\": \""),
    ] {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        let digits = |rest: &str| rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect::<String>();
        let found: Vec<String> = text.split(words).skip(1).map(digits).filter(|found| found.contains('.')).collect();
        assert!(!found.is_empty(), "{file} has no version behind {words:?}");
        assert!(found.iter().all(|found| found.trim_end_matches('.') == version), "{file} has {found:?}");
    }
    let changes = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("CHANGELOG.md")).unwrap();
    let first = changes.lines().find_map(|line| line.strip_prefix("## ")).unwrap();
    assert_eq!(first.split_whitespace().next(), Some(version), "the first section of CHANGELOG.md");
    for own in ["fuzz/Cargo.toml", "web/engine/Cargo.toml"] {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(own)).unwrap();
        assert!(!text.contains("\nversion ="), "{own} is not released and needs no version");
    }
    let python = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("python/Cargo.toml")).unwrap();
    assert!(python.contains("\nversion.workspace = true\n"), "python/Cargo.toml has a version of its own");
}

#[test]
fn a_checkout_has_its_commit_and_whether_it_was_modified() {
    let folder = Folder::new();
    let top = folder.path("");
    let commit = repository(&top)[..12].to_owned();
    assert_eq!(build_script::checked_out(&top), Some(commit.clone()));
    folder.write("notes.txt", "not part of the program");
    assert_eq!(build_script::checked_out(&top), Some(commit.clone()));
    folder.write("Cargo.toml", "[package]\nname = \"other\"\n");
    assert_eq!(build_script::checked_out(&top), Some(format!("{commit}, modified")));
}

#[test]
fn a_copy_inside_another_repository_has_no_commit() {
    let folder = Folder::new();
    let _ = repository(&folder.path(""));
    let inner = folder.path("vendor");
    std::fs::create_dir(&inner).unwrap();
    assert_eq!(build_script::checked_out(&inner), None);
    assert_eq!(build_script::recorded(&inner), None);
}

#[test]
fn a_package_has_the_commit_that_cargo_recorded() {
    let folder = Folder::new();
    let record = |git: &str| {
        let text = format!("{{\n  \"git\": {{\n    {git}\n  }},\n  \"path_in_vcs\": \"\"\n}}");
        let _ = folder.write(".cargo_vcs_info.json", &text);
        build_script::recorded(&folder.path(""))
    };
    let commit = "\"sha1\": \"0123456789abcdef0123456789abcdef01234567\"";
    assert_eq!(record(commit), Some("0123456789ab".to_owned()));
    assert_eq!(record(&format!("{commit},\n    \"dirty\": true")), Some("0123456789ab, modified".to_owned()));
    assert_eq!(record("\"sha1\": \"unknown\""), None);
}

#[test]
fn the_version_is_that_of_the_package() {
    let version = abbe(&["--version"]);
    let own = format!("abbe {}", env!("CARGO_PKG_VERSION"));
    assert!(version.trim_end() == own || version.starts_with(&format!("{own} (")), "{version}");
}

/// Verbs that the help lists.
fn verbs() -> Vec<String> {
    let help = abbe(&["--help"]);
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn every_verb_has_a_manual_page() {
    let folder = Folder::new();
    let pages = folder.path("man");
    let _ = abbe(&["man", pages.to_str().unwrap()]);
    let page = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap();
    let verbs: Vec<String> = verbs().into_iter().filter(|verb| verb != "help").collect();
    assert!(verbs.len() > 20, "{verbs:?}");
    for verb in &verbs {
        let text = page(&format!("abbe-{verb}.1"));
        assert!(text.contains(&format!(".TH abbe-{verb} 1")), "{text}");
        // The synopsis is the command as it is typed.
        assert!(text.contains(&format!("\\fBabbe {verb}\\fR")), "{text}");
    }
    let program = page("abbe.1");
    assert!(program.contains(concat!("abbe ", env!("CARGO_PKG_VERSION"))) && program.contains("abbe\\-check(1)"));
    assert!(program.contains("abbe\\-man(1)"), "{program}");
    assert_eq!(std::fs::read_dir(&pages).unwrap().count(), verbs.len() + 1);
}

#[test]
fn shells_complete_every_verb() {
    for shell in ["bash", "zsh", "fish"] {
        let script = abbe(&["completions", shell]);
        for verb in verbs() {
            assert!(script.contains(&verb), "{shell}: no `{verb}`");
        }
    }
}
