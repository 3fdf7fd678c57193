//! A user's repository of machines: the hook of pre-commit and the workflow of docs/repository.md.

use crate::oracle::program::Folder;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns a YAML text as JSON.
fn yaml(text: &str) -> Value {
    serde_yaml::from_str(text).unwrap()
}

fn hooks() -> Vec<Value> {
    let text = std::fs::read_to_string(root().join(".pre-commit-hooks.yaml")).unwrap();
    yaml(&text).as_array().unwrap().clone()
}

/// Runs a command line of a hook or a workflow with this build as `abbe`.
fn shell(line: &str, folder: &Path) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_abbe")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    Command::new("sh").args(["-e", "-c", line]).env("PATH", path).current_dir(folder).output().unwrap()
}

/// The YAML blocks of docs/repository.md: the user's configuration of pre-commit, then the workflow.
fn samples() -> [Value; 2] {
    let text = std::fs::read_to_string(root().join("docs/repository.md")).unwrap();
    let blocks: Vec<Value> =
        text.split("```yaml\n").skip(1).map(|rest| yaml(rest.split("```").next().unwrap())).collect();
    blocks.try_into().unwrap()
}

/// A folder `machines` with two machines.
fn machines(folder: &Folder) -> PathBuf {
    let machines = folder.path("machines");
    std::fs::create_dir(&machines).unwrap();
    for name in ["three-axis", "head-head"] {
        let file = machines.join(format!("{name}.yaml"));
        let made = shell(&format!("abbe init --quiet --from {name} '{}'", file.display()), &machines);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    }
    machines
}

#[test]
fn hooks_have_what_pre_commit_asks_for() {
    let known = ["id", "name", "description", "entry", "language", "types"];
    for hook in hooks() {
        let keys: Vec<&String> = hook.as_object().unwrap().keys().collect();
        assert_eq!(keys, known, "{hook}");
        assert!(["rust", "system"].contains(&hook["language"].as_str().unwrap()));
    }
}

#[test]
fn the_hook_accepts_good_machines_and_refuses_bad_ones() {
    let folder = Folder::new();
    let machines = machines(&folder);
    std::fs::write(machines.join("bad.yaml"), "abbe: 1\nchain: w X b t\n").unwrap();
    for hook in hooks() {
        let entry = hook["entry"].as_str().unwrap();
        for file in ["three-axis.yaml", "head-head.yaml"] {
            let good = shell(&format!("{entry} {file}"), &machines);
            assert_eq!(good.status.code(), Some(0), "{}", String::from_utf8_lossy(&good.stderr));
        }
        assert_eq!(shell(&format!("{entry} bad.yaml"), &machines).status.code(), Some(1));
        // pre-commit hands over all files of a commit at once.
        let several = shell(&format!("{entry} three-axis.yaml head-head.yaml"), &machines);
        assert_eq!(several.status.code(), Some(0));
        let one_bad = shell(&format!("{entry} three-axis.yaml bad.yaml head-head.yaml"), &machines);
        let (out, err) = (String::from_utf8_lossy(&one_bad.stdout), String::from_utf8_lossy(&one_bad.stderr));
        assert_eq!(one_bad.status.code(), Some(1));
        assert!(out.contains("bad.yaml\n  refused:") && err.contains("bad.yaml"), "{out}{err}");
    }
}

#[test]
fn the_samples_name_what_there_is() {
    let [configuration, workflow] = samples();
    let repository = &configuration["repos"][0];
    assert_eq!(repository["rev"], concat!("v", env!("CARGO_PKG_VERSION")));
    let used = repository["hooks"][0]["id"].as_str().unwrap();
    assert!(hooks().iter().any(|hook| hook["id"] == used), "{used}");
    let steps = workflow["jobs"]["check"]["steps"].as_array().unwrap();
    assert!(steps.iter().all(|step| step["run"].is_string() != step["uses"].is_string()), "{steps:?}");
    let install = steps.iter().find_map(|step| step["run"].as_str().filter(|run| run.contains("install"))).unwrap();
    assert!(install.ends_with(concat!("--tag v", env!("CARGO_PKG_VERSION"))), "{install}");
}

#[test]
fn the_workflow_writes_annotations_whether_machines_are_refused_or_not() {
    let folder = Folder::new();
    let machines = machines(&folder);
    let top = machines.parent().unwrap();
    let [_, workflow] = samples();
    let steps = workflow["jobs"]["check"]["steps"].as_array().unwrap();
    let check = steps.iter().find(|step| step["name"] == "Check the machines").unwrap()["run"].as_str().unwrap();
    for (bad, code, level) in [("", 0, "warning"), ("abbe: 1\nchain: w X b t\n", 1, "error")] {
        if !bad.is_empty() {
            std::fs::write(machines.join("bad.yaml"), bad).unwrap();
        }
        assert_eq!(shell(check, top).status.code(), Some(code));
        let log: Value = serde_json::from_str(&std::fs::read_to_string(top.join("abbe.sarif")).unwrap()).unwrap();
        let results = log["runs"][0]["results"].as_array().unwrap();
        assert!(results.iter().all(|result| result["level"] == "warning") == (level == "warning"), "{results:?}");
    }
}

#[test]
fn the_workflow_replays_the_tables_of_each_machine() {
    let folder = Folder::new();
    let top = machines(&folder).parent().unwrap().to_owned();
    let compile = "abbe compile machines/three-axis.yaml --target grid-csv --out tables/three-axis";
    assert_eq!(shell(compile, &top).status.code(), Some(0));
    let [_, workflow] = samples();
    let steps = workflow["jobs"]["check"]["steps"].as_array().unwrap();
    let replay = steps.iter().find(|step| step["name"] == "Replay the tables").unwrap()["run"].as_str().unwrap();
    let sound = shell(replay, &top);
    assert_eq!(sound.status.code(), Some(0), "{}", String::from_utf8_lossy(&sound.stderr));
    let table = top.join("tables/three-axis/corrections.csv");
    let edited = std::fs::read_to_string(&table).unwrap().trim_end().to_owned() + "1\n";
    std::fs::write(table, edited).unwrap();
    let refused = shell(replay, &top);
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("W0701"));
}
