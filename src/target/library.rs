//! Where targets come from: the binary, then a folder of the user's.

use super::Manifest;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::{Files, read_text};
use std::path::Path;

/// Targets in the binary.
pub const NAMES: [&str; 5] = ["linuxcnc", "linuxcnc-kins", "linuxcnc-matrixkins", "linuxcnc-trt", "grid-csv"];

/// Files in the binary, as in `templates/`.
const EMBEDDED: [(&str, &str); 18] = [
    ("linuxcnc/target.yaml", include_str!("../../templates/linuxcnc/target.yaml")),
    ("linuxcnc/table.j2", include_str!("../../templates/linuxcnc/table.j2")),
    ("linuxcnc/compensation.inc.j2", include_str!("../../templates/linuxcnc/compensation.inc.j2")),
    ("linuxcnc-kins/target.yaml", include_str!("../../templates/linuxcnc-kins/target.yaml")),
    ("linuxcnc-kins/data.h.j2", include_str!("../../templates/linuxcnc-kins/data.h.j2")),
    ("linuxcnc-kins/model.h.j2", include_str!("../../templates/linuxcnc-kins/model.h.j2")),
    ("linuxcnc-kins/abbekins.comp.j2", include_str!("../../templates/linuxcnc-kins/abbekins.comp.j2")),
    ("linuxcnc-kins/abbekins.hal.j2", include_str!("../../templates/linuxcnc-kins/abbekins.hal.j2")),
    ("linuxcnc-kins/sim.ini.j2", include_str!("../../templates/linuxcnc-kins/sim.ini.j2")),
    ("linuxcnc-kins/sim.hal.j2", include_str!("../../templates/linuxcnc-kins/sim.hal.j2")),
    ("linuxcnc-kins/sim.var.j2", include_str!("../../templates/linuxcnc-kins/sim.var.j2")),
    ("linuxcnc-kins/sim.tbl.j2", include_str!("../../templates/linuxcnc-kins/sim.tbl.j2")),
    ("linuxcnc-matrixkins/target.yaml", include_str!("../../templates/linuxcnc-matrixkins/target.yaml")),
    ("linuxcnc-matrixkins/matrixkins.hal.j2", include_str!("../../templates/linuxcnc-matrixkins/matrixkins.hal.j2")),
    ("linuxcnc-trt/target.yaml", include_str!("../../templates/linuxcnc-trt/target.yaml")),
    ("linuxcnc-trt/trt.hal.j2", include_str!("../../templates/linuxcnc-trt/trt.hal.j2")),
    ("grid-csv/target.yaml", include_str!("../../templates/grid-csv/target.yaml")),
    ("grid-csv/corrections.csv.j2", include_str!("../../templates/grid-csv/corrections.csv.j2")),
];

/// A target: its manifest and the text of its templates, in the order of the manifest's files.
#[derive(Debug, Clone)]
pub struct Target {
    /// What it can do.
    pub manifest: Manifest,
    pub(super) templates: Vec<String>,
}

impl Target {
    /// Finds a target by name, in the binary or in `folder/NAME/`.
    pub fn find(name: &str, folder: Option<&Path>, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Self> {
        if let Some(target) = Self::embedded(name) {
            return Some(target);
        }
        let Some(folder) = folder.filter(|_| is_plain_name(name)) else {
            diagnostics.push(unknown(name));
            return None;
        };
        Self::from_folder(&folder.join(name), files, diagnostics)
    }

    /// A target of the binary.
    pub fn embedded(name: &str) -> Option<Self> {
        let text = |file: &str| {
            let path = format!("{name}/{file}");
            EMBEDDED.iter().find(|(known, _)| *known == path).map(|(_, text)| (*text).to_owned())
        };
        let manifest: Manifest = serde_yaml::from_str(&text("target.yaml")?).ok()?;
        let templates = manifest.files.iter().map(|file| text(&file.template)).collect::<Option<Vec<_>>>()?;
        Some(Self { manifest, templates })
    }

    fn from_folder(folder: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Self> {
        let mut text = |file: &str| read_text(&folder.join(file), None, files, diagnostics).map(|(_, text)| text);
        let manifest = text("target.yaml")?;
        let manifest: Manifest = match serde_yaml::from_str(&manifest) {
            Ok(manifest) => manifest,
            Err(failure) => {
                let message = format!("`{}`: {failure}", folder.join("target.yaml").display());
                diagnostics.push(
                    Diagnostic::new("E0703", message).help("docs/adding-a-target.md lists the keys of a manifest"),
                );
                return None;
            }
        };
        if let Some(fault) = manifest.fault() {
            let message = format!("`{}`: {fault}", folder.join("target.yaml").display());
            diagnostics
                .push(Diagnostic::new("E0703", message).help("docs/adding-a-target.md lists the keys of a manifest"));
            return None;
        }
        if let Some(file) = manifest.files.iter().find(|file| !is_plain_name(&file.template)) {
            let message = format!("the template `{}` is not a plain file name", file.template);
            diagnostics.push(Diagnostic::new("E0703", message).help("a template stands in the target's own folder"));
            return None;
        }
        let templates = manifest.files.iter().map(|file| text(&file.template)).collect::<Option<Vec<_>>>()?;
        Some(Self { manifest, templates })
    }
}

/// A name that cannot leave its folder.
pub fn is_plain_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !name.is_empty() && name.len() <= 80 && name.chars().all(plain) && !name.starts_with('.')
}

fn unknown(name: &str) -> Diagnostic {
    Diagnostic::new("E0701", format!("there is no target `{name}`"))
        .help(format!("known targets: {}; a folder of your own is given with --templates DIR", NAMES.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_in_templates_is_in_the_binary() {
        let mut found = Vec::new();
        for folder in std::fs::read_dir("templates").unwrap().map(|entry| entry.unwrap().path()) {
            for file in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
                found.push(file.strip_prefix("templates").unwrap().display().to_string());
            }
        }
        let mut embedded: Vec<_> = EMBEDDED.iter().map(|(name, _)| (*name).to_owned()).collect();
        found.retain(|name| NAMES.iter().any(|target| name.starts_with(&format!("{target}/"))));
        found.sort();
        embedded.sort();
        assert_eq!(found, embedded);
        assert!(NAMES.iter().all(|name| Target::embedded(name).is_some_and(|t| t.manifest.target == *name)));
    }
}
