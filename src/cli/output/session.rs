//! One run of the program: its options, its diagnostics, and its two output streams.

use super::progress::StageProgress;
use super::view::{folded, set_wide};
use crate::cli::store::files::Recorded;
use crate::cli::store::limited::standard_output;
use crate::cli::{Color, Exit, Format, FormatArg, Global, Outcome};
use abbe::text::{Rendering, counts, render};
use abbe::{Diagnostic, Diagnostics, codes};
use abbe::{LoadOptions, MachineFile, Reply, Run};
use serde::Serialize;
use serde_json::{Value, json};
use std::cell::{Cell, RefCell};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;

/// The state of a run of the program.
pub(crate) struct Session {
    global: Global,
    bar: StageProgress,
    /// Everything found wrong so far.
    pub diagnostics: Diagnostics,
    /// The disk, and what was read from it.
    pub files: Rc<Recorded>,
    /// The JSON document of the run, printed when it ends.
    document: RefCell<Option<Value>>,
    /// Diagnostic of an invalid command line.
    unfit: RefCell<Option<Diagnostic>>,
    /// Reason why standard output did not take everything.
    output_lost: Cell<Option<ErrorKind>>,
}

impl Session {
    pub(crate) fn new(global: Global) -> Self {
        let bar = StageProgress::new(global.quiet);
        if global.wide {
            set_wide();
        }
        let (document, unfit) = (RefCell::new(None), RefCell::new(None));
        let files = Rc::new(Recorded::within(global.confined.as_deref()));
        let (diagnostics, output_lost) = (Diagnostics::default(), Cell::new(None));
        Self { global, bar, diagnostics, files, document, unfit, output_lost }
    }

    /// Returns the folder of `--confined` if there is none of its name.
    pub(crate) fn missing_root(&self) -> Option<String> {
        self.global.confined.as_ref().filter(|root| !root.is_dir()).map(|root| root.display().to_string())
    }

    /// Returns the folder of `--confined`.
    pub(crate) fn root(&self) -> Option<&Path> {
        self.global.confined.as_deref()
    }

    /// Surroundings of a call of the library: files from the disk, progress on the terminal.
    pub(crate) fn run(&self) -> Run<'_> {
        Run { monitor: &self.bar, deny_warnings: self.global.deny.is_some(), ..Run::with(&*self.files) }
    }

    /// Keeps the diagnostics of a call of the library, and returns its value if it has one.
    pub(crate) fn take<T>(&mut self, answer: Reply<T>) -> Result<T, Exit> {
        match answer {
            Ok(answer) => {
                self.diagnostics.absorb(answer.warnings);
                Ok(answer.value)
            }
            Err(refusals) => {
                let unfit = refusals.iter().find(|d| d.code == codes::E0818).map(|d| d.message.clone());
                if let Some(message) = unfit {
                    return self.usage(&message);
                }
                self.diagnostics.absorb(refusals);
                Err(Exit::Refused)
            }
        }
    }

    /// Reads a machine file; `tool` picks one of its tools.
    pub(crate) fn load(&mut self, path: &Path, tool: Option<&str>) -> Result<MachineFile, Exit> {
        let options = LoadOptions { tool: tool.map(str::to_owned) };
        self.take(abbe::load(path, &options, self.run()))
    }

    /// Reads one of several machine files: diagnostics name it.
    pub(crate) fn load_one_of(&mut self, path: &Path, tool: Option<&str>) -> Result<MachineFile, Exit> {
        let count = self.diagnostics.count();
        let file = self.load(path, tool);
        self.diagnostics.name_file(count, &path.display().to_string());
        file
    }

    /// Form of the output; SARIF counts as JSON.
    pub(crate) fn format(&self) -> Format {
        match self.global.format {
            FormatArg::Text => Format::Text,
            FormatArg::Csv => Format::Csv,
            FormatArg::Json | FormatArg::Sarif => Format::Json,
        }
    }

    pub(crate) fn is_sarif(&self) -> bool {
        self.global.format == FormatArg::Sarif
    }

    /// Prints to standard output. A closed pipe ends the output, not the run.
    pub(crate) fn print(&self, text: &str) {
        let mut out = standard_output();
        let ending: &[u8] = if text.ends_with('\n') { b"" } else { b"\n" };
        let written = out.write_all(text.as_bytes()).and_then(|()| out.write_all(ending)).and_then(|()| out.flush());
        match written {
            Err(failure) if failure.kind() != ErrorKind::BrokenPipe => self.output_lost.set(Some(failure.kind())),
            _ => {}
        }
    }

    /// True if standard output did not take what was printed.
    pub(crate) fn has_lost_output(&self) -> bool {
        self.output_lost.get().is_some()
    }

    /// Prints a text to the person, on standard error, unless `--quiet`.
    pub(crate) fn say(&self, text: &str) {
        if !self.global.quiet {
            let _ = write!(std::io::stderr().lock(), "{}", folded(text));
        }
    }

    /// Prints the result of a verb in the form of the output.
    pub(crate) fn show<T: Serialize>(
        &self,
        result: &T,
        csv: impl FnOnce() -> String,
        text: impl FnOnce() -> String,
    ) -> Outcome {
        match self.format() {
            Format::Json => self.print_json(json!(result)),
            Format::Csv => self.print(&csv()),
            Format::Text => self.print(&folded(&text())),
        }
        Ok(())
    }

    /// Prints a JSON object, when the run ends, with the warnings found so far in it.
    pub(crate) fn print_json(&self, value: Value) {
        self.print_document(self.diagnostics.document(value));
    }

    /// Prints a JSON document when the run ends.
    pub(crate) fn print_document(&self, value: Value) {
        let _ = self.document.replace(Some(value));
    }

    /// The JSON document of the run: its result, and its diagnostics if it is refused.
    fn document(&self, outcome: Outcome) -> Option<Value> {
        let document = self.document.take();
        // A result that is a refusal by itself, such as a matrix that is no motion, stands alone.
        let silent = self.diagnostics.iter().next().is_none() && self.unfit.borrow().is_none();
        if self.is_sarif() || self.format() != Format::Json || outcome.is_ok() || silent {
            return document;
        }
        let refusal = match self.unfit.take() {
            Some(unfit) => json!(Diagnostics::from(unfit)),
            None => json!(self.diagnostics),
        };
        let mut document = document.unwrap_or_else(|| json!({}));
        if let (Some(object), Value::Object(refusal)) = (document.as_object_mut(), refusal) {
            object.extend(refusal);
        }
        Some(document)
    }

    /// Adds a refusal and stops.
    pub(crate) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Result<T, Exit> {
        self.diagnostics.push(diagnostic);
        Err(Exit::Refused)
    }

    /// A command line that parsed but makes no sense.
    pub(crate) fn usage<T>(&self, message: &str) -> Result<T, Exit> {
        let text = folded(&format!("abbe: {message}\nTry `abbe --help`."));
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
        let _ = self.unfit.replace(Some(Diagnostic::new(codes::E0818, message)));
        Err(Exit::Usage)
    }

    /// Prints the JSON document, renders the diagnostics and gives the exit code.
    pub(crate) fn finish(self, outcome: Outcome) -> ExitCode {
        if let Some(document) = self.document(outcome) {
            self.print(&document.to_string());
        }
        self.render(outcome);
        if let Some(why) = self.output_lost.get() {
            let _ = writeln!(std::io::stderr().lock(), "abbe: standard output did not take everything: {why}");
            return ExitCode::from(3);
        }
        match outcome {
            Ok(()) => ExitCode::SUCCESS,
            Err(Exit::Refused) => ExitCode::from(1),
            Err(Exit::Usage) => ExitCode::from(2),
        }
    }

    /// Renders the diagnostics on standard error.
    fn render(&self, outcome: Outcome) {
        let color = match self.global.color {
            Color::Auto => std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none(),
            Color::Always => true,
            Color::Never => false,
        };
        let refused = outcome == Err(Exit::Refused);
        if self.diagnostics.iter().next().is_some() && (refused || !self.global.quiet) {
            let text = render(&self.diagnostics, Rendering { color, folded: !self.global.wide });
            let _ = std::io::stderr().lock().write_all(text.as_bytes());
            if refused {
                let _ = writeln!(std::io::stderr().lock(), "{}", counts(&self.diagnostics));
            }
        }
    }
}
