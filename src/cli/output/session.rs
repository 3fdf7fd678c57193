//! One run of the program: its options, what it found wrong, and its two output streams.

use crate::cli::{Color, Exit, Format, Global, Outcome};
use crate::diagnostic::{Diagnostic, Diagnostics, Rendering, render, summary};
use std::cell::Cell;
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;

/// The state of a run.
pub(crate) struct Session {
    global: Global,
    /// Everything found wrong so far.
    pub diagnostics: Diagnostics,
    /// Why standard output did not take everything.
    output_lost: Cell<Option<ErrorKind>>,
}

impl Session {
    pub(crate) fn new(global: Global) -> Self {
        Self { global, diagnostics: Diagnostics::default(), output_lost: Cell::new(None) }
    }

    /// A session with the same options that has found nothing yet.
    pub(crate) fn fresh(&self) -> Self {
        Self::new(self.global.clone())
    }

    pub(crate) fn format(&self) -> Format {
        self.global.format
    }

    /// Prints to standard output. A closed pipe ends the output, not the run.
    pub(crate) fn print(&self, text: &str) {
        let mut out = std::io::stdout().lock();
        let ending: &[u8] = if text.ends_with('\n') { b"" } else { b"\n" };
        let written = out.write_all(text.as_bytes()).and_then(|()| out.write_all(ending)).and_then(|()| out.flush());
        match written {
            Err(failure) if failure.kind() != ErrorKind::BrokenPipe => self.output_lost.set(Some(failure.kind())),
            _ => {}
        }
    }

    /// Says something to the person, on standard error, unless `--quiet`.
    pub(crate) fn say(&self, text: &str) {
        if !self.global.quiet {
            let _ = writeln!(std::io::stderr().lock(), "{text}");
        }
    }

    /// No progress, please.
    pub(crate) fn is_quiet(&self) -> bool {
        self.global.quiet
    }

    /// Prints a JSON object with the warnings found so far in it.
    pub(crate) fn print_json(&self, mut value: serde_json::Value) {
        let warnings: Vec<_> = self.diagnostics.iter().map(|d| self.warning(d)).collect();
        if let (Some(object), false) = (value.as_object_mut(), warnings.is_empty()) {
            let _ = object.insert("warnings".to_owned(), warnings.into());
        }
        self.print(&value.to_string());
    }

    fn warning(&self, diagnostic: &Diagnostic) -> serde_json::Value {
        let sources = &self.diagnostics.sources;
        let place = diagnostic.labels.first().map(|label| {
            let (line, column) = sources.line_column(&label.place);
            serde_json::json!({"file": sources.name(label.place.source), "line": line, "column": column})
        });
        serde_json::json!({"code": diagnostic.code, "message": diagnostic.message, "place": place})
    }

    /// Adds a refusal and stops.
    pub(crate) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Result<T, Exit> {
        self.diagnostics.push(diagnostic);
        Err(Exit::Refused)
    }

    /// A command line that parsed but makes no sense.
    pub(crate) fn usage<T>(&self, message: &str) -> Result<T, Exit> {
        let _ = writeln!(std::io::stderr().lock(), "abbe: {message}\nTry `abbe --help`.");
        Err(Exit::Usage)
    }

    /// Stops if anything so far refuses the input (or warns, with `--deny warnings`).
    pub(crate) fn checked(&mut self) -> Outcome {
        if self.global.deny.is_some() && self.diagnostics.warnings() > 0 {
            self.diagnostics.deny_warnings();
        }
        if self.diagnostics.refused() { Err(Exit::Refused) } else { Ok(()) }
    }

    /// Renders the diagnostics and gives the exit code.
    pub(crate) fn finish(self, outcome: Outcome) -> ExitCode {
        let color = match self.global.color {
            Color::Auto => std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none(),
            Color::Always => true,
            Color::Never => false,
        };
        let refused = outcome == Err(Exit::Refused);
        if self.diagnostics.iter().next().is_some() && (refused || !self.global.quiet) {
            let text = render(&self.diagnostics, Rendering { color });
            let _ = std::io::stderr().lock().write_all(text.as_bytes());
            if refused {
                let _ = writeln!(std::io::stderr().lock(), "{}", summary(&self.diagnostics));
            }
        }
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
}
