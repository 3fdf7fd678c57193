//! The sources of targets: the binary, then a folder of the user's.

use super::Manifest;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, did_you_mean, shown};
use crate::syntax::{Files, YamlFailure, from_yaml, read_text};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Defines the targets in the binary by their folders in `templates/` and the files there.
macro_rules! targets {
    ($($target:literal: $($file:literal)+;)+) => {
        /// Targets in the binary.
        pub const NAMES: [&str; [$($target),+].len()] = [$($target),+];

        /// Files in the binary, as in `templates/`.
        const EMBEDDED: &[(&str, &str)] = &[$($((
            concat!($target, "/", $file),
            include_str!(concat!("../../../templates/", $target, "/", $file)),
        ),)+)+];
    };
}

targets! {
    "linuxcnc": "compensation.inc.j2" "table.j2" "target.yaml";
    "linuxcnc-kins": "target.yaml" "data.h.j2" "model.h.j2" "hold.h.j2" "solve.h.j2" "abbekins.comp.j2"
        "abbekins.hal.j2" "reversal.j2" "sim.ini.j2" "sim.hal.j2" "sim.var.j2" "sim.tbl.j2";
    "linuxcnc-matrixkins": "target.yaml" "matrixkins.hal.j2";
    "linuxcnc-trt": "target.yaml" "trt.hal.j2";
    "linuxcnc-5axiskins": "pivot.hal.j2" "target.yaml";
    "linuxcnc-maxkins": "pivot.hal.j2" "target.yaml";
    "isg-volcomp": "hochlauf_part.lis.j2" "target.yaml" "volcomp.csv.j2" "volcomp0.lis.j2";
    "etalon-exchange": "etalon.j2" "target.yaml";
    "sinumerik-cec": "cec.j2" "target.yaml";
    "sinumerik-enc": "eec.j2" "target.yaml";
    "sinumerik-traori": "traori.j2" "target.yaml";
    "sinumerik-chain": "chain.j2" "target.yaml";
    "sinumerik-tcarr": "tcarr.j2" "target.yaml";
    "heidenhain-com": "axis.com.j2" "config.cma.j2" "target.yaml";
    "heidenhain-kinematics": "list.j2" "target.yaml";
    "fanuc-pitch": "pitch.j2" "readme.j2" "target.yaml";
    "fanuc-3d": "lattice.j2" "target.yaml";
    "fanuc-5axis": "parameters.j2" "readme.j2" "target.yaml";
    "haas-mrzp": "settings.j2" "target.yaml";
    "twincat-axis": "achskw.j2" "target.yaml";
    "pmac": "compensation.j2" "target.yaml";
    "kmotion-geo": "geo.j2" "readme.j2" "target.yaml";
    "reprapfirmware": "heightmap.j2" "m556.j2" "target.yaml";
    "klipper": "skew.j2" "target.yaml";
    "marlin": "skew.j2" "target.yaml";
    "grbl": "settings.j2" "target.yaml";
    "grid-csv": "corrections.csv.j2" "target.yaml";
    "grid-json": "corrections.json.j2" "target.yaml";
}

/// Bounds the time that templates take.
pub trait TemplateLimit: Send + Sync {
    fn begin(&self);
    fn end(&self);
}

/// What bounds the time of templates; nothing by default. Two of them count as equal: no result depends on them.
#[derive(Clone, Default)]
pub struct TemplateWatch(Option<Arc<dyn TemplateLimit>>);

impl TemplateWatch {
    /// Bounds templates by a limit.
    pub fn new(limit: impl TemplateLimit + 'static) -> Self {
        Self(Some(Arc::new(limit)))
    }

    /// Runs templates within the limit.
    pub(crate) fn during<T>(&self, job: impl FnOnce() -> T) -> T {
        self.0.iter().for_each(|limit| limit.begin());
        let value = job();
        self.0.iter().for_each(|limit| limit.end());
        value
    }
}

impl PartialEq for TemplateWatch {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl std::fmt::Debug for TemplateWatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TemplateWatch")
    }
}

/// A target: its manifest and the text of its templates, in the order of the manifest's files.
#[derive(Debug, Clone)]
pub struct ControllerTarget {
    /// Its manifest.
    pub manifest: Manifest,
    pub(crate) templates: Vec<Arc<str>>,
    /// Hears when they run.
    pub(crate) watch: TemplateWatch,
}

impl ControllerTarget {
    /// Finds a target by name, in the binary or in `folder/NAME/`.
    pub fn find(name: &str, folder: Option<&Path>, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Self> {
        if let Some(target) = Self::builtin(name) {
            if let Some(changed) = folder.and_then(|folder| override_in(name, &folder.join(name), files)) {
                let message = format!("`{}` is not the file of the target `{name}` that abbe knows", changed.display());
                let help = "a target of your own has a name of its own: rename its folder, and `target:` in its \
                            target.yaml";
                diagnostics.push(Diagnostic::new(codes::E0703, message).help(help));
                return None;
            }
            return Some(target);
        }
        let Some(folder) = folder.filter(|_| is_plain_name(name)) else {
            diagnostics.push(unknown_target(name));
            return None;
        };
        Self::from_folder(&folder.join(name), files, diagnostics)
    }

    /// A target of the binary. Its manifest is read once: to recognise a set is to try all of them.
    pub fn builtin(name: &str) -> Option<Self> {
        static READ: [OnceLock<Option<ControllerTarget>>; NAMES.len()] = [const { OnceLock::new() }; NAMES.len()];
        let index = NAMES.iter().position(|known| *known == name)?;
        READ[index].get_or_init(|| Self::parse(name)).clone()
    }

    fn parse(name: &str) -> Option<Self> {
        let text = |file: &str| {
            let path = format!("{name}/{file}");
            EMBEDDED.iter().find(|(known, _)| *known == path).map(|(_, text)| *text)
        };
        let manifest: Manifest = serde_yaml::from_str(text("target.yaml")?).ok()?;
        let template = |file: &str| text(file).map(Arc::from);
        let templates = manifest.files.iter().map(|file| template(&file.template)).collect::<Option<Vec<_>>>()?;
        Some(Self { manifest, templates, watch: TemplateWatch::default() })
    }

    fn from_folder(folder: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Self> {
        let mut text = |file: &str| read_text(&folder.join(file), None, files, diagnostics).map(|(_, text)| text);
        let manifest = text("target.yaml")?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let manifest = match sound(&manifest).and_then(|manifest| check_name(manifest, &name)) {
            Ok(manifest) => manifest,
            Err(fault) => {
                let message = format!("`{}`: {fault}", folder.join("target.yaml").display());
                let help = "docs/adding-a-target.md lists the keys of a manifest; a template is in the target's \
                 own folder";
                diagnostics.push(Diagnostic::new(codes::E0703, message).help(help));
                return None;
            }
        };
        let templates = manifest.files.iter().map(|file| text(&file.template)).collect::<Option<Vec<_>>>()?;
        Some(Self { manifest, templates, watch: TemplateWatch::default() })
    }
}

/// Files of a target are shorter (bytes).
const MAX_FILE: u64 = 1 << 20;

/// Returns a file of the binary's target that a folder has in another form.
fn override_in(name: &str, folder: &Path, files: &dyn Files) -> Option<PathBuf> {
    let own = EMBEDDED.iter().filter_map(|(path, text)| Some((path.strip_prefix(name)?.strip_prefix('/')?, *text)));
    let mut own = own.map(|(file, text)| (folder.join(file), text));
    own.find(|(path, text)| files.read_at_most(path, MAX_FILE).is_ok_and(|bytes| bytes != text.as_bytes()))
        .map(|(path, _)| path)
}

/// The reason why a manifest is refused.
#[derive(Debug, thiserror::Error)]
enum ManifestFault {
    /// It is no YAML, or has other keys.
    #[error(transparent)]
    Syntax(YamlFailure),
    /// Its keys do not fit together.
    #[error("{0}")]
    Unsound(String),
    /// A template is outside the target's folder.
    #[error("the template `{0}` is not a plain file name")]
    Template(String),
    /// The target has another name than its folder, by which it is found.
    #[error("the target is named `{}` and its folder `{}`: give both one name", shown(.0), shown(.1))]
    Name(String, String),
}

/// Reads a manifest that can be worked with.
fn sound(text: &str) -> Result<Manifest, ManifestFault> {
    let manifest: Manifest = from_yaml(text).map_err(ManifestFault::Syntax)?;
    if let Some(fault) = manifest.fault() {
        return Err(ManifestFault::Unsound(fault));
    }
    match manifest.files.iter().find(|file| !is_plain_name(&file.template)) {
        Some(file) => Err(ManifestFault::Template(file.template.clone())),
        None => Ok(manifest),
    }
}

/// Refuses a manifest that names another target than its folder: the files would be judged by that one.
fn check_name(manifest: Manifest, folder: &str) -> Result<Manifest, ManifestFault> {
    if manifest.target == folder {
        return Ok(manifest);
    }
    Err(ManifestFault::Name(manifest.target, folder.to_owned()))
}

/// A name that cannot leave its folder.
pub fn is_plain_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !name.is_empty() && name.len() <= 80 && name.chars().all(plain) && !name.starts_with('.')
}

/// True if a path of a manifest becomes this name for some machine: what stands between its expressions is there in
/// that order.
pub(in crate::controller) fn path_fits(path: &str, name: &str) -> bool {
    let mut pieces = path.split("{{").map(|piece| piece.split_once("}}").map_or(piece, |(_, text)| text));
    let Some(mut rest) = pieces.next().and_then(|first| name.strip_prefix(first)) else { return false };
    let texts: Vec<&str> = pieces.collect();
    let Some((last, between)) = texts.split_last() else { return rest.is_empty() };
    for text in between {
        match rest.find(text) {
            Some(at) => rest = &rest[at + text.len()..],
            None => return false,
        }
    }
    is_plain_name(name) && rest.ends_with(last)
}

/// The refusal of a name that no target has.
pub fn unknown_target(name: &str) -> Diagnostic {
    let refusal = Diagnostic::new(codes::E0701, format!("there is no target `{}`", shown(name)));
    if name.contains('+') {
        return refusal.help("a set of two targets is meant: name both (`--target A+B`), or the subfolder of one");
    }
    let word = name.to_lowercase();
    let title =
        |of: &&&str| ControllerTarget::builtin(of).is_some_and(|of| of.manifest.title.to_lowercase().contains(&word));
    let of_maker: Vec<&str> = match word.as_str() {
        "siemens" => NAMES.iter().filter(|of| of.starts_with("sinumerik")).copied().collect(),
        _ if word.len() < 3 => Vec::new(),
        _ => NAMES.iter().filter(|of| of.starts_with(&word) || title(of)).copied().collect(),
    };
    if !of_maker.is_empty() {
        let one = format!("one of them: `{}`", of_maker.join("`, `"));
        return refusal.help(format!("{one}; `abbe targets MACHINE` compares them on a machine"));
    }
    refusal.help(format!("{} (a folder of your own: `compile --templates DIR`)", did_you_mean(name, &NAMES)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fit_the_paths_of_their_targets() {
        let path = "joint_{{ joint }}_{{ letter }}.comp";
        for name in ["joint_0_X.comp", "joint_12_AA.comp"] {
            assert!(path_fits(path, name), "{name}");
        }
        for name in ["joint_0.comp", "joint_0_X.comp.bak", "my_joint_0_X.comp", "machine.yaml", "", "joint_0_/X.comp"] {
            assert!(!path_fits(path, name), "{name}");
        }
        assert!(path_fits("_N_AX{{ joint + 1 }}_EEC_INI", "_N_AX3_EEC_INI"));
        assert!(path_fits("etalon.txt", "etalon.txt") && !path_fits("etalon.txt", "etalon.txt2"));
    }

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
        assert!(NAMES.iter().all(|name| ControllerTarget::builtin(name).is_some_and(|t| t.manifest.target == *name)));
    }
}
