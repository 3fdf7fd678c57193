//! What newcomers type: files without a verb, lists for mappings, one text for one mistake, lines that can be copied.

use super::first_hour::typed;
use super::program::{Folder, available, refused, text};
use std::collections::BTreeMap;

#[test]
fn errors_as_a_list_are_named_as_a_list() {
    let folder = Folder::new("lists");
    for list in ["\n  - EC0Y: 12 arcsec\n", "\n- EC0Y: 12 arcsec\n  EXX: 2 um\n", " [EC0Y: 12 arcsec]\n"] {
        for section in ["errors", "tolerances"] {
            let machine = format!("abbe: 1\nmachine: m\nchain: w b X t\naxes:\n  X: {{}}\n{section}:{list}");
            let file = folder.with("m.yaml", &machine);
            let (code, message) = refused(&["check", text(&file)]);
            let cause = format!("`{section}` is a list: it must be a mapping of names to entries");
            assert!(code == 1 && message.contains(&cause) && message.contains("omit the `-`"), "{message}");
        }
    }
    let file = folder.with("m.yaml", "abbe: 1\nmachine: m\nchain: w b X t\naxes:\n  X: {}\nerrors: 12 um\n");
    assert!(refused(&["check", text(&file)]).1.contains("one indented `NAME: ...` a line"));
}

#[test]
fn a_machine_file_in_place_of_a_verb_is_answered_by_verbs() {
    for file in ["m.yaml", "folder/m.yml"] {
        let (code, message) = refused(&[file]);
        let verbs = format!("`abbe check {file}`, `abbe workbench {file}`");
        assert!(code == 2 && message.contains(&verbs), "{message}");
    }
    let (code, message) = refused(&["chekc", "m.yaml"]);
    assert!(code == 2 && message.contains("'check'") && !message.contains("abbe check"), "{message}");
}

#[test]
fn an_unknown_target_has_one_text() {
    let folder = Folder::new("no-target");
    for (name, help) in [("linuxnc", "did you mean `linuxcnc`?"), ("foo", "known here: `linuxcnc`")] {
        let (code, listed) = refused(&["targets", name]);
        let out = folder.file("never");
        let compiled = refused(&["compile", "trunnion.yaml", "--target", name, "--out", text(&out)]).1;
        assert!(code == 1 && listed.contains(&format!("there is no target `{name}`")), "{listed}");
        assert!(listed.contains(help) && compiled.contains(listed.trim()), "{listed}\n{compiled}");
    }
}

#[test]
fn answers_make_one_file_on_the_terminal_and_on_the_page() {
    if !available("python3", "questions on a terminal") {
        return;
    }
    let folder = Folder::new("one-file");
    let (code, shown) = typed(&folder, "5\n0 620\n\n\n\n\n95.5\n2\n8\n\n\n6\n\npremium\nm.yaml\n");
    assert_eq!(code, 0, "{shown}");
    let answers = [
        ("kind", "5"),
        ("travel X", " 0, 620 "),
        ("tool", "95.5"),
        ("known", "2"),
        ("accuracy X", "8"),
        ("accuracy B", "6"),
        ("class", "premium"),
        ("no question", "no answer"),
    ];
    let answers: BTreeMap<String, String> = answers.map(|(key, answer)| (key.to_owned(), answer.to_owned())).into();
    let made = abbe::machine_dialogue(&answers);
    assert_eq!(made.file.as_deref(), Some(std::fs::read_to_string(folder.file("m.yaml")).unwrap().as_str()));
    // Every question of the page was asked on the terminal.
    let one_line = shown.replace("\r\n", " ");
    assert!(made.questions.iter().all(|of| one_line.contains(&of.asked)), "{shown}");
    let (code, shown) = typed(&folder, "1\n\n\n\n\n3\nnowhere.csv\n\u{4}");
    assert!(code == 1 && shown.contains("Wanted: names of files that are there."), "{shown}");
}

#[test]
fn lines_for_a_terminal_keep_commands_and_labels_whole() {
    let folder = Folder::new("lines");
    let part = folder.with("part.csv", "X,Y,Z,feature\n9000,0,100,a_feature_with_a_name\n0,0,100,top\n");
    let map = std::process::Command::new(env!("CARGO_BIN_EXE_abbe"))
        .args(["map", "vmc-cframe-754.yaml", "--tool-poses", text(&part)])
        .current_dir(crate::configs::folder())
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    let told = String::from_utf8(map.stderr).unwrap();
    assert!(
        told.contains("note: the first of them: ") && told.lines().all(|line| line.chars().count() <= 80),
        "{told}"
    );
}
