//! Reconfiguring is one edit: `A` moves from under the table to the head, in the chain line alone.

use std::path::Path;
use std::process::{Command, Output};

use crate::oracle::program::Folder;

/// A copy of the trunnion machine with its tables, and the same with the edited chain.
fn machines() -> Folder {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("errors/trunnion")).unwrap();
    for file in std::fs::read_dir(configs.join("errors/trunnion")).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), folder.path("errors/trunnion").join(file.file_name())).unwrap();
    }
    let original = std::fs::read_to_string(configs.join("trunnion.yaml")).unwrap();
    let (before, after) = (r#"chain: "w C' A' Y' b X Z t""#, r#"chain: "w C' Y' b X Z A t""#);
    assert_eq!(original.matches(before).count(), 1);
    folder.write("trunnion.yaml", &original);
    folder.write("moved.yaml", &original.replace(before, after));
    folder
}

/// Runs the program and asserts that it is content.
fn succeeds(folder: &Folder, arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_abbe"))
        .arg("--wide")
        .args(arguments)
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "abbe {}\n{complaint}", arguments.join(" "));
    output
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn moving_an_axis_across_the_bed_is_one_edit() {
    let folder = machines();
    succeeds(&folder, &["check", "moved.yaml"]);
    let errors = ["trunnion.yaml", "moved.yaml"].map(|machine| {
        let map = json(&succeeds(&folder, &["map", machine, "--format", "json"]));
        assert!(map["poses"].as_u64().unwrap() > 1000, "{map}");
        map["position_um"]["p95"].as_f64().unwrap()
    });
    // The same errors act through other lever arms, so the maps cannot be equal, nor either of them nothing.
    assert!(errors.iter().all(|p95| *p95 > 1.0) && errors[0] != errors[1], "{errors:?}");
    succeeds(&folder, &["compare", "trunnion.yaml", "moved.yaml"]);
    for target in ["linuxcnc", "grid-csv"] {
        succeeds(&folder, &["compile", "moved.yaml", "--target", target, "--out", target]);
        assert!(folder.path(target).join("abbe.lock.json").is_file(), "{target} wrote no manifest");
    }
}
