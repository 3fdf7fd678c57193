//! Machines from a path or a text.

use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes};
use crate::evaluate::{Nodes, Order};
use crate::machine::{self, ErrorTerm, Look, Machine};
use crate::run::{Call, Hashed, Refused, Reply, Run, sha256};
use crate::syntax::{self, Files, IdentifyEntry, JobText, MemoryFiles};
use crate::units::counted;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A machine with the files it was read from. Dereferences to its [`Machine`].
#[derive(Debug, Clone)]
pub struct MachineFile {
    pub(crate) machine: Machine,
    pub(crate) identify: Option<IdentifyEntry>,
    pub(crate) job: Option<JobText>,
    /// Drawing directions.
    pub(crate) look: Look,
    pub(crate) sources: Sources,
    pub(crate) path: PathBuf,
    /// True if its tool was asked for by name.
    pub(crate) is_tool_asked: bool,
    /// True if a travel is written in inches.
    pub(crate) in_inches: bool,
    /// Questions of `check` about its geometry.
    pub(crate) questions: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
    input_files: Vec<InputFile>,
}

/// A file that a machine was read from.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct InputFile {
    /// Its path, as it was named.
    pub file: String,
    /// SHA-256 of its text, hexadecimal.
    pub sha256: String,
    /// True if it is outside the folder of the machine file, links resolved.
    pub outside: bool,
}

impl Deref for MachineFile {
    type Target = Machine;

    fn deref(&self) -> &Machine {
        &self.machine
    }
}

impl MachineFile {
    /// Returns the name of the machine file.
    pub fn path(&self) -> &str {
        self.sources.iter().next().map_or("", |(name, _)| name)
    }

    /// Returns name and text of every file that the machine was read from, in the order read.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Returns the warnings of reading it.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Returns the plain name and the SHA-256 of every file that the machine was read from.
    pub fn inputs(&self) -> Vec<Hashed> {
        hashed(&self.sources)
    }

    /// Returns the files that the machine was read from, in the order read.
    pub fn input_files(&self) -> &[InputFile] {
        &self.input_files
    }

    /// Returns the positions of the nodes of the volume's grid (mm or deg), axis by axis.
    pub fn grid(&self) -> Vec<Vec<f64>> {
        Nodes::of(&self.machine).positions()
    }

    /// Returns the order of the errors where none is asked for: the one that the conventions name, or exact.
    pub fn default_order(&self) -> Order {
        order_of(&self.machine, None)
    }

    /// Returns the machine with a volume that ends where these ranges (mm, deg) of its axes do.
    pub(crate) fn with_volume_within(&self, ranges: &[Option<(f64, f64)>]) -> Self {
        Self { machine: self.machine.with_volume_within(ranges), ..self.clone() }
    }

    /// Returns the machine with another of its tools, by name.
    pub fn with_tool(&self, name: &str) -> Result<Self, Diagnostic> {
        match self.machine.with_tool(name) {
            Some(machine) => Ok(Self { machine, is_tool_asked: true, ..self.clone() }),
            None => Err(unknown_tool(&self.machine, name)),
        }
    }
}

/// The order asked for, or the one that the conventions of the machine name.
pub(crate) fn order_of(machine: &Machine, order: Option<Order>) -> Order {
    order.unwrap_or_else(|| machine.conventions().default_order.map_or(Order::Exact, Order::Degree))
}

/// Reads back a machine file of our own making; fails with the reason of its refusal.
pub(crate) fn read_back(text: &str) -> Result<MachineFile, ReadBackFailure> {
    let answer = loads(text, &LoadOptions::default(), Run::default());
    answer.map(|answer| answer.value).map_err(|refusal| ReadBackFailure(refusal.iter().next().cloned()))
}

/// The first reason why a machine file of our own making is refused.
#[derive(Debug, thiserror::Error)]
#[error("{}", .0.as_ref().map_or("it does not read back", |refusal| &refusal.message))]
pub(crate) struct ReadBackFailure(Option<Diagnostic>);

/// Plain names and hashes of files.
pub(crate) fn hashed(sources: &Sources) -> Vec<Hashed> {
    let plain = |name: &str| Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    sources.iter().map(|(name, text)| Hashed::new(plain(name), text.as_bytes())).collect()
}

/// The files that several machines were read from, each once.
pub(crate) fn sources_of(files: &[MachineFile]) -> Sources {
    let mut known = Diagnostics::default();
    files.iter().for_each(|file| known.absorb(Diagnostics::about(file.sources.clone())));
    known.sources
}

/// Options of [`load`].
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct LoadOptions {
    /// Tool of the machine; the first by default.
    pub tool: Option<String>,
}

/// Reads a machine file, and the files it extends and names, through `run.files`.
///
/// Fails with all faults of the files, each with its place.
pub fn load(path: impl AsRef<Path>, options: &LoadOptions, run: Run) -> Reply<MachineFile> {
    Call::answer_of(run, &Sources::default(), |call| read(call, path.as_ref(), options, run.files))
}

/// Reads a machine from the text of a machine file. Files that the text names are read through `run.files`.
pub fn loads(text: &str, options: &LoadOptions, run: Run) -> Reply<MachineFile> {
    let files = Overlay { text: MemoryFiles::default().with(TEXT_NAME, text), files: run.files };
    Call::answer_of(run, &Sources::default(), |call| read(call, Path::new(TEXT_NAME), options, &files))
}

const TEXT_NAME: &str = "machine.yaml";

/// A text in front of other files.
pub(crate) struct Overlay<'a> {
    pub text: MemoryFiles,
    pub files: &'a dyn Files,
}

impl Files for Overlay<'_> {
    fn resolve(&self, path: &Path) -> Option<PathBuf> {
        self.files.resolve(path).or_else(|| {
            let (name, _) = (path.file_name()?, self.text.read(path).ok()?);
            Some(self.files.resolve(folder_of(path))?.join(name))
        })
    }

    fn read(&self, path: &Path) -> Result<Vec<u8>, syntax::ReadFailure> {
        self.text.read(path).or_else(|_| self.files.read(path))
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, syntax::ReadFailure> {
        self.text.read_at_most(path, limit).or_else(|_| self.files.read_at_most(path, limit))
    }
}

fn read(call: &mut Call, path: &Path, options: &LoadOptions, files: &dyn Files) -> Result<MachineFile, Refused> {
    let document = syntax::load(path, files, &mut call.diagnostics);
    let machine = document.as_ref().and_then(|d| machine::resolve(d, files, &mut call.diagnostics));
    let look = document.as_ref().map(|d| machine::look(d, files, &mut call.diagnostics)).unwrap_or_default();
    call.check()?;
    let machine = machine.ok_or(Refused)?;
    let in_inches = document.as_ref().is_some_and(syntax::Document::is_in_inches);
    let questions = document.as_ref().map_or_else(Vec::new, |document| machine::questions(document, &machine, look.up));
    let (identify, job) = document.map_or((None, None), |document| (document.identify, document.job));
    let (sources, warnings) = (call.diagnostics.sources.clone(), call.diagnostics.iter().cloned().collect());
    let input_files = input_files(path, &sources, files);
    let (path, is_tool_asked) = (path.to_owned(), false);
    let file = MachineFile {
        machine,
        identify,
        job,
        look,
        sources,
        path,
        is_tool_asked,
        in_inches,
        questions,
        warnings,
        input_files,
    };
    match &options.tool {
        None => Ok(file),
        Some(name) => file.with_tool(name).or_else(|refusal| call.refuse(refusal)),
    }
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

fn input_files(machine: &Path, sources: &Sources, files: &dyn Files) -> Vec<InputFile> {
    let folder = files.resolve(folder_of(machine));
    let inside = |file: &Path| Some(files.resolve(file)?.starts_with(folder.as_ref()?));
    let input = |(name, text): (&str, &str)| InputFile {
        file: name.to_owned(),
        sha256: sha256(text.as_bytes()),
        outside: !inside(Path::new(name)).unwrap_or(false),
    };
    sources.iter().map(input).collect()
}

/// Warns of a machine that is asked for deviations although all its errors are only bounded.
pub(crate) fn bounded_only(machine: &Machine) -> Option<Diagnostic> {
    let count = machine.errors().count() + machine.tolerances().count();
    let any = count > 0 || machine.class().is_some();
    let bounded = any && machine.errors().all(|(_, term)| matches!(term, ErrorTerm::Tolerance(_)));
    bounded.then(|| {
        let all = if machine.class().is_some() {
            "all errors".to_owned()
        } else {
            format!("all {}", counted(count, "error"))
        };
        let message = format!("{all} are only bounded, and count as 0");
        let help = "`abbe map` and `abbe budget` compute the effect of bounds; give values for measured errors";
        Diagnostic::new(codes::W0802, message).help(help)
    })
}

fn unknown_tool(machine: &Machine, name: &str) -> Diagnostic {
    let known: Vec<_> = machine.tools().iter().map(|tool| tool.name.as_str()).filter(|name| !name.is_empty()).collect();
    let help = if known.is_empty() {
        "this machine has one tool without a name: leave `--tool` out".to_owned()
    } else {
        format!("its tools are {}", known.join(", "))
    };
    Diagnostic::new(codes::E0801, format!("the machine has no tool `{name}`")).help(help)
}
