//! Tables to files, through the target's minijinja templates.
//!
//! Numbers reach a template rounded and as text: [`decimal_text`] is the only formatter, and it knows neither `-0` nor
//! a locale. A file with a number that is not finite is refused, whether it came so or the template made it. Templates
//! run with fuel and cannot read files. Fuel bounds their steps, not the cost of a step: a program that renders
//! templates of others bounds their time and memory itself, as `abbe` does.

use super::context::TableWords;
use super::lock::LOCK_NAME;
use super::number::{NOT_FINITE, decimal_text};
use crate::compensation::{CorrectionTable, CorrectionTables};
use crate::controller::manifest::{AssignedAxis, ControllerTarget, FileSpec, Per, axis_letters, is_plain_name};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::{AxisKind, Machine, Travel};
use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior, Value, context, escape_formatter};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Fifty instructions for each cell of 200,000 rows of ten; a template that needs more is a loop.
const FUEL: u64 = 100_000_000;

/// A file's name has a handful of instructions: those of a loop that doubles a text come to a few kilobytes.
const NAME_FUEL: u64 = 60;

/// Largest file of a set, in bytes: 200,000 nodes of nine axes, all corrected, are less.
pub const MAX_FILE_BYTES: usize = 64 << 20;

/// The reason why a template yields no file.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TemplateFailure {
    /// The engine refuses it.
    #[error("{}{}", .0, .0.line().map_or_else(String::new, |line| format!(" (template line {line})")))]
    Engine(#[from] minijinja::Error),
    /// The name could leave the folder.
    #[error("`{0}` is not a plain file name")]
    Name(String),
    /// Two files of the set have the name, or it is that of the manifest of sets.
    #[error("another file of the set is named `{0}`")]
    NameTaken(String),
    /// The file of this name exceeds [`MAX_FILE_BYTES`].
    #[error("`{}` would have more than {} MB", .0, MAX_FILE_BYTES >> 20)]
    Size(String),
    /// The file of this name would have a number that is not finite.
    #[error("a number of `{0}` is not finite")]
    NotFinite(String),
}

/// The text that a template has written so far, up to a limit and the first number that is not finite.
#[derive(Default)]
struct BoundedText {
    text: Vec<u8>,
    not_finite: bool,
}

impl std::io::Write for BoundedText {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.not_finite |= bytes.contains(&(NOT_FINITE as u8));
        if self.not_finite || self.text.len() + bytes.len() > MAX_FILE_BYTES {
            return Err(std::io::Error::other("refused"));
        }
        self.text.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A file with its bytes as on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderedFile {
    /// Its plain name.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl ControllerTarget {
    /// Writes the target's files for (rounded) tables. Diagnostics: a template that fails (E0702).
    pub fn render(
        &self,
        machine: &Machine,
        tables: &Arc<CorrectionTables>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<RenderedFile>> {
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), Some(diagnostics))?;
        let words = TableWords { target: self, machine, tables, letters: &letters };
        let writer = Writer { words, environment: environment() };
        match writer.files(|_| true).and_then(check_names) {
            Ok(files) => Some(files),
            Err(failure) => {
                diagnostics.push(self.failure(&failure));
                None
            }
        }
    }

    /// Writes files that have no tables, once each, from a context of their own besides name and version, and the
    /// files of the tables beside them.
    pub(crate) fn render_once(
        &self,
        machine: &Machine,
        own: &Value,
        beside: &Arc<CorrectionTables>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<RenderedFile>> {
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), Some(diagnostics))?;
        let words = TableWords { target: self, machine, tables: beside, letters: &letters };
        let writer = Writer { words, environment: environment() };
        let files = || {
            let tables = writer.files(FileSpec::is_of_tables)?;
            let beside: Vec<String> = tables.iter().map(|file| file.name.clone()).collect();
            let file = |(spec, template): (&FileSpec, &Arc<str>)| {
                let context = context! {
                    machine => self.file_name(machine),
                    version => env!("CARGO_PKG_VERSION"),
                    caution => self.manifest.caution(),
                    beside => beside.clone(),
                        ..own.clone()
                };
                render_file(&writer.environment, &spec.path, template, context)
            };
            let once = self.manifest.files.iter().zip(&self.templates).filter(|(spec, _)| !spec.is_of_tables());
            let mut files: Vec<RenderedFile> = once.map(file).collect::<Result<_, TemplateFailure>>()?;
            files.extend(tables);
            check_names(files)
        };
        files().map_err(|failure| diagnostics.push(self.failure(&failure))).ok()
    }

    /// Returns the text of a file that is the same whatever the tables are; `None` if a template fails.
    pub(in crate::controller) fn text_of(&self, machine: &Machine, path: &str) -> Option<String> {
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), None)?;
        let tables = Arc::default();
        let words = TableWords { target: self, machine, tables: &tables, letters: &letters };
        let writer = Writer { words, environment: environment() };
        let files = self.watch.during(|| writer.files(|spec| spec.path == path)).ok()?;
        files.into_iter().next().and_then(|file| String::from_utf8(file.bytes).ok())
    }

    fn failure(&self, failure: &TemplateFailure) -> Diagnostic {
        let message = format!("target `{}`: {failure}", self.manifest.target);
        if matches!(failure, TemplateFailure::NotFinite(_)) {
            let help = "look for a wrong unit or power of ten in the machine file; nothing was written";
            return Diagnostic::new(codes::E0542, message).help(help);
        }
        let help = "docs/adding-a-target.md states the variables and the limits of templates; nothing was written";
        Diagnostic::new(codes::E0702, message).help(help)
    }

    /// Names of the files that hold a table of their own for each axis, in the order of the joints:
    /// (index of the axis, file name).
    pub(crate) fn axis_files(
        &self,
        machine: &Machine,
        spec: &FileSpec,
    ) -> Result<Vec<(usize, String)>, TemplateFailure> {
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), None).unwrap_or_default();
        letters.iter().map(|known| Ok((known.axis, file_name(&spec.path, name_context(machine, known))?))).collect()
    }
}

pub(super) fn environment() -> Environment<'static> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_fuel(Some(FUEL));
    environment.set_auto_escape_callback(|_| minijinja::AutoEscape::None);
    mark_not_finite(&mut environment);
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build();
    if let Ok(syntax) = syntax {
        environment.set_syntax(syntax);
    }
    environment
}

/// Refuses a name that two files have.
pub(super) fn check_names(files: Vec<RenderedFile>) -> Result<Vec<RenderedFile>, TemplateFailure> {
    let mut names = BTreeSet::from([LOCK_NAME]);
    let taken = files.iter().find(|file| !names.insert(file.name.as_str()));
    match taken.map(|file| file.name.clone()) {
        Some(name) => Err(TemplateFailure::NameTaken(name)),
        None => Ok(files),
    }
}

/// Has a template write the mark for a number that is not finite.
fn mark_not_finite(environment: &mut Environment) {
    let mark = Value::from(NOT_FINITE.to_string());
    environment.set_formatter(move |out, state, value| {
        let finite = !value.is_number() || f64::try_from(value.clone()).is_ok_and(f64::is_finite);
        escape_formatter(out, state, if finite { value } else { &mark })
    });
}

/// The variables of the name of an axis's file.
fn name_context(machine: &Machine, known: &AssignedAxis) -> Value {
    let (letter, name) = (known.letter.as_str(), machine.axes()[known.axis].name.as_str());
    context! { joint => known.number - 1, letter, name }
}

/// Renders the name of a file: expressions without filters and functions.
fn file_name(path: &str, own: Value) -> Result<String, TemplateFailure> {
    let mut environment = Environment::empty();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_fuel(Some(NAME_FUEL));
    mark_not_finite(&mut environment);
    let name = environment.render_str(path, own)?;
    if name.contains(NOT_FINITE) {
        return Err(TemplateFailure::NotFinite(path.to_owned()));
    }
    if is_plain_name(&name) { Ok(name) } else { Err(TemplateFailure::Name(name)) }
}

impl ControllerTarget {
    /// A file's name for every letter and every place that an axis of it could have.
    pub(crate) fn names_of_letters(&self, spec: &FileSpec, letters: &str) -> Vec<String> {
        let name = |(joint, letter): (usize, char)| {
            let own = context! { joint, letter => letter.to_string(), name => letter.to_string() };
            file_name(&spec.path, own).ok()
        };
        let places = 0..letters.len();
        let mut names: Vec<String> =
            places.flat_map(|joint| letters.chars().map(move |letter| (joint, letter))).filter_map(name).collect();
        names.sort();
        names.dedup();
        names
    }
}

pub(super) fn render_file(
    environment: &Environment,
    path: &str,
    template: &str,
    context: Value,
) -> Result<RenderedFile, TemplateFailure> {
    let name = file_name(path, context.clone())?;
    let compiled = environment.template_from_str(template)?;
    let mut text = BoundedText::default();
    match compiled.render_captured_to(context, &mut text) {
        Ok(_) => Ok(RenderedFile { name, bytes: text.text }),
        Err(_) if text.not_finite => Err(TemplateFailure::NotFinite(name)),
        Err(failure) if failure.kind() == minijinja::ErrorKind::WriteFailure => Err(TemplateFailure::Size(name)),
        Err(failure) => Err(failure.into()),
    }
}

/// The input of the files of a set.
struct Writer<'a> {
    words: TableWords<'a>,
    environment: Environment<'static>,
}

impl Writer<'_> {
    fn files(&self, keep: impl Fn(&FileSpec) -> bool) -> Result<Vec<RenderedFile>, TemplateFailure> {
        let mut files = Vec::new();
        let target = self.words.target;
        for (spec, template) in target.manifest.files.iter().zip(&target.templates).filter(|(spec, _)| keep(spec)) {
            if spec.per == Per::Machine {
                if spec.of.as_ref().is_none_or(|of| self.words.any(of)) {
                    files.push(self.file(spec, template, self.machine_context(spec)?)?);
                }
                continue;
            }
            for known in self.words.letters {
                if spec.per.wants(known.axis, &self.words.tables.tables) {
                    files.push(self.file(spec, template, self.axis_context(known, Some(spec.per))?)?);
                }
            }
        }
        Ok(files)
    }

    fn file(&self, spec: &FileSpec, template: &str, context: Value) -> Result<RenderedFile, TemplateFailure> {
        render_file(&self.environment, &spec.path, template, context)
    }

    fn limits(&self, axis: usize) -> (f64, f64) {
        match (self.words.machine.axes()[axis].travel, &self.words.target.manifest.mechanism.own_axis) {
            (Travel::Continuous, Some(own)) => own.table.continuous,
            (travel, _) => travel.interval(),
        }
    }

    /// Formats a position outside a table.
    fn position(&self, value: f64) -> String {
        let rules = self.words.target.manifest.mechanism.iter().next();
        decimal_text(value, rules.map_or(6, |(_, rules)| rules.increment.position_decimals))
    }

    /// An axis; with its tables in the file of an axis.
    fn axis_context(&self, known: &AssignedAxis, of: Option<Per>) -> Result<Value, TemplateFailure> {
        let (machine, target) = (self.words.machine, self.words.target);
        let AssignedAxis { axis: index, letter, number } = known;
        let axis = &machine.axes()[*index];
        let (min, max) = self.limits(*index);
        let mut per_axis = target.manifest.files.iter().filter(|spec| spec.per == Per::Axis);
        let file = per_axis.next().map(|spec| file_name(&spec.path, name_context(machine, known))).transpose()?;
        let tables = of.map(|per| self.words.tables(|table| per.holds(*index, table)));
        let own = of.map(|_| self.words.own_points(*index));
        Ok(context! {
            joint => number - 1, letter, file, tables,
            points => own,
            name => axis.name.as_str(),
            kind => if axis.kind == AxisKind::Linear { "linear" } else { "rotary" },
            unit => axis.unit(),
            min => self.position(min),
            max => self.position(max),
            number,
            ..self.common()
        })
    }

    fn common(&self) -> Value {
        context! {
            machine => self.words.target.file_name(self.words.machine),
            version => env!("CARGO_PKG_VERSION"),
            caution => self.words.target.manifest.caution(),
        }
    }

    fn machine_context(&self, spec: &FileSpec) -> Result<Value, TemplateFailure> {
        let axes =
            self.words.letters.iter().map(|known| self.axis_context(known, None)).collect::<Result<Vec<_>, _>>()?;
        let (columns, rows) = self.words.lattice().unzip();
        // A lattice is written row by row; as a list of tables it would be in memory as text.
        let tables = columns.is_none().then(|| self.words.tables(|table| self.words.is_of(table, spec.of.as_deref())));
        Ok(context! {
            axes,
            columns, rows,
            tables => tables,
            errors => self.words.errors(),
            chain => self.words.chain(),
            ..self.common()
        })
    }
}

impl Per {
    fn wants(self, axis: usize, tables: &[CorrectionTable]) -> bool {
        self == Self::Axis || tables.iter().any(|table| self.holds(axis, table))
    }

    fn holds(self, axis: usize, table: &CorrectionTable) -> bool {
        match self {
            Self::Machine => true,
            Self::Axis | Self::Output => table.corrected[0] == axis,
            Self::Input => table.axes[0] == axis,
        }
    }
}
