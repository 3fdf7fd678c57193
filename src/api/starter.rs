//! Machine files to begin with.

use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::CLASS_NAMES;
use crate::syntax::dialogue::{MachineDialogue, dialogue};
use serde::Serialize;
use std::collections::BTreeMap;

/// A kind of machine to begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Starter {
    /// Three linear axes, C-frame: `w X' Y' b Z t`.
    ThreeAxis,
    /// Four axes, a rotary table on the table of a vertical mill: `w A' X' Y' b Z t`.
    VerticalRotary,
    /// Five axes, both rotary ones under the workpiece: `w C' A' Y' b X Z t`.
    #[default]
    Trunnion,
    /// Five axes, a swivelling head and a rotary table: `w C' Y' b X Z B t`.
    HeadTable,
    /// Five axes, a fork head: `w b X Y Z C A t`.
    HeadHead,
}

/// Returns the text of a machine file to begin with; it is accepted as it is.
pub fn starter(kind: Starter) -> &'static str {
    match kind {
        Starter::ThreeAxis => include_str!("starters/three-axis.yaml"),
        Starter::VerticalRotary => include_str!("starters/vertical-rotary.yaml"),
        Starter::Trunnion => include_str!("starters/trunnion.yaml"),
        Starter::HeadTable => include_str!("starters/head-table.yaml"),
        Starter::HeadHead => include_str!("starters/head-head.yaml"),
    }
}

/// A machine file to begin with, by its name.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NamedMachine {
    /// Its name.
    pub name: &'static str,
    /// Where its rotary axes are.
    pub kind: &'static str,
    #[serde(skip)]
    text: &'static str,
}

/// Names of machines of `configs`, with their texts.
macro_rules! machines {
    ($($kind:literal: $($name:literal $path:literal),+;)+) => {
        [$($(NamedMachine {
            name: $name,
            kind: $kind,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), $path)),
        }),+),+]
    };
}

/// Machines that `abbe init --from` takes, by kind.
pub const NAMED_MACHINES: [NamedMachine; 25] = machines! {
    "written to be changed, with comments":
        "three-axis" "/src/api/starters/three-axis.yaml",
        "vertical-rotary" "/src/api/starters/vertical-rotary.yaml",
        "trunnion" "/src/api/starters/trunnion.yaml",
        "head-table" "/src/api/starters/head-table.yaml",
        "head-head" "/src/api/starters/head-head.yaml";
    "three axes":
        "vmc-cframe-754" "/configs/vmc-cframe-754.yaml",
        "vmc-travelling-column" "/configs/vmc-travelling-column.yaml",
        "gantry-3ax" "/configs/gantry-3ax.yaml",
        "holub-2015" "/configs/papers/holub-2015.yaml";
    "four axes":
        "hmc-4ax" "/configs/hmc-4ax.yaml",
        "boring-w" "/configs/boring-w.yaml";
    "five axes, two in the table":
        "tt-ac-800" "/configs/tt-ac-800.yaml",
        "tt-bc" "/configs/tt-bc.yaml",
        "tt-nut45" "/configs/tt-nut45.yaml",
        "tt-ab-desktop" "/configs/tt-ab-desktop.yaml",
        "bui-kimm" "/configs/papers/bui-kimm.yaml";
    "five axes, one in the table and one in the head":
        "ht-b-c" "/configs/ht-b-c.yaml",
        "ht-nut45-c" "/configs/ht-nut45-c.yaml";
    "five axes and more, two in the head":
        "hh-ca-gantry" "/configs/hh-ca-gantry.yaml",
        "hh-bd-ram" "/configs/hh-bd-ram.yaml",
        "hh-cb-a-nut" "/configs/hh-cb-a-nut.yaml";
    "lathes and turn-mills":
        "lathe-xzc" "/configs/lathes/lathe-xzc.yaml",
        "millturn-bc" "/configs/millturn-bc.yaml";
    "others":
        "ur5" "/configs/robots/ur5.yaml",
        "hrdina-vasik-2014" "/configs/papers/hrdina-vasik-2014.yaml";
};

/// Machines of `configs` that change one of the others, with the name of that one.
pub const VARIANTS: [[&str; 2]; 5] = [
    ["trunnion-aligned", "trunnion"],
    ["trunnion-long-tool", "trunnion"],
    ["trunnion-swivel-head", "trunnion"],
    ["tt-ac-800-direct", "tt-ac-800"],
    ["holub-2015-as-printed", "holub-2015"],
];

impl NamedMachine {
    /// Returns the walk from the workpiece to the tool.
    fn chain(&self) -> &'static str {
        let line = self.text.lines().find_map(|line| line.strip_prefix("chain:"));
        line.unwrap_or_default().trim().trim_matches('"')
    }

    /// Returns the machine file: geometry and location errors; measured curves stay where their tables are.
    fn file(&self) -> String {
        let mut is_list = false;
        let keeps = |line: &&str| {
            is_list = line.starts_with("measured:") || is_list && line.starts_with(' ');
            !is_list
        };
        self.text.lines().filter(keeps).flat_map(|line| [line, "\n"]).collect()
    }
}

/// Returns the machine file of that name. Fails for names that are not listed.
pub fn named_machine(name: &str) -> Result<String, Diagnostic> {
    let found = NAMED_MACHINES.iter().find(|machine| machine.name == name).map(NamedMachine::file);
    found.ok_or_else(|| match VARIANTS.iter().find(|[variant, _]| *variant == name) {
        Some([_, base]) => {
            let help =
                format!("begin with `{base}`, and write what differs into a second file, `extends: {base}.yaml`");
            Diagnostic::new(codes::E0101, format!("`{name}` is a variant of `{base}`")).help(help)
        }
        None => {
            let names: Vec<&str> = NAMED_MACHINES.iter().map(|machine| machine.name).collect();
            let message = format!("there is no machine `{}` to begin with", shown(name));
            Diagnostic::new(codes::E0101, message).help(did_you_mean(name, &names))
        }
    })
}

/// Returns the questions that answers by key lead to, and the commented machine file once all are understood.
///
/// An answer that is missing or empty is the one that its question proposes.
pub fn machine_dialogue(answers: &BTreeMap<String, String>) -> MachineDialogue {
    dialogue(answers, &CLASS_NAMES)
}

/// Returns the list of what `abbe init --from` takes, with classes and controls, in 80 columns.
pub fn machines_text(targets: &[&str]) -> String {
    let mut text = "Machines that `abbe init FILE --from NAME` writes:\n".to_owned();
    let mut kind = "";
    for machine in NAMED_MACHINES {
        if machine.kind != kind {
            kind = machine.kind;
            text += &format!("\n  {kind}\n");
        }
        text += &format!("    {:22} {}\n", machine.name, machine.chain());
    }
    text += "\n  variants, which change one of these (configs/ of the repository)\n";
    VARIANTS.iter().for_each(|[variant, base]| text += &format!("    {variant:22} of {base}\n"));
    text += "\nCurves of these stay in configs/: files have geometry and location errors.\n";
    text += &wrapped("Classes of machines (`abbe explain NAME`)", &CLASS_NAMES);
    text + &wrapped("Controls (`abbe targets NAME`)", targets)
}

/// A heading, and words in lines of 80 columns.
fn wrapped(heading: &str, words: &[&str]) -> String {
    let mut lines = vec![format!("\n{heading}:"), String::from(" ")];
    for word in words {
        if lines.last().is_some_and(|line| line.len() + word.len() > 78) {
            lines.push(" ".to_owned());
        }
        lines.last_mut().into_iter().for_each(|line| *line += &format!(" {word}"));
    }
    lines.join("\n") + "\n"
}

/// Returns the JSON Schema (draft-07) of the machine file.
pub fn schema() -> serde_json::Value {
    crate::syntax::schema()
}
