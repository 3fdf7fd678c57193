//! Measuring programs: files of a controller from templates, by a manifest of their own.

use super::render::{RenderedFile, check_names, environment, render_file};
use crate::controller::manifest::Certainty;
use crate::diagnostic::{Diagnostic, codes};
use minijinja::value::Serde as ViaSerde;
use minijinja::{Value, context};
use serde::{Deserialize, Serialize};

const MANIFEST: &str = include_str!("../../../templates/measure-linuxcnc/program.yaml");
const TEMPLATES: [(&str, &str); 5] = [
    ("start.j2", include_str!("../../../templates/measure-linuxcnc/start.j2")),
    ("touch.j2", include_str!("../../../templates/measure-linuxcnc/touch.j2")),
    ("find.j2", include_str!("../../../templates/measure-linuxcnc/find.j2")),
    ("set.j2", include_str!("../../../templates/measure-linuxcnc/set.j2")),
    ("measure.py.j2", include_str!("../../../templates/measure-linuxcnc/measure.py.j2")),
];

/// The manifest of a measuring program.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramManifest {
    /// One line.
    pub title: String,
    /// The certainty of its syntax.
    pub certainty: Certainty,
    /// Letters of axes.
    pub letters: String,
    /// Number of the parameter that has the first letter's position at a touch; the others follow.
    pub first_result: usize,
    files: Vec<ProgramFile>,
}

/// A file of a measuring program.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProgramFile {
    /// Its name, an expression.
    path: String,
    template: String,
    per: Per,
}

/// Parts of a program that have files of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Per {
    Program,
    Ball,
    Set,
}

/// The words of a measuring program: of all, of each ball, and of each set.
pub struct ProgramWords<P: Serialize, S: Serialize> {
    /// The words that all files have.
    pub program: P,
    /// The set before which each ball is found.
    pub balls: Vec<S>,
    /// The sets in their order.
    pub sets: Vec<S>,
}

impl ProgramManifest {
    /// Returns the manifest of the program for LinuxCNC.
    pub fn linuxcnc() -> Result<Self, Diagnostic> {
        serde_yaml::from_str(MANIFEST).map_err(|failure| refusal(&failure))
    }

    /// Writes the files of a program.
    pub fn render<P: Serialize, S: Serialize>(
        &self,
        words: &ProgramWords<P, S>,
    ) -> Result<Vec<RenderedFile>, Diagnostic> {
        let environment = environment();
        let program = Value::from(ViaSerde(&words.program));
        let mut files = Vec::new();
        for file in &self.files {
            let parts: Vec<Option<&S>> = match file.per {
                Per::Program => vec![None],
                Per::Ball => words.balls.iter().map(Some).collect(),
                Per::Set => words.sets.iter().map(Some).collect(),
            };
            let text = TEMPLATES.iter().find(|(name, _)| *name == file.template).map_or("", |(_, text)| text);
            for part in parts {
                let part = part.map_or_else(|| context! {}, |part| Value::from(ViaSerde(part)));
                let both = context! { ..part, ..program.clone() };
                let all = context! { version => env!("CARGO_PKG_VERSION"), ..both };
                let written = render_file(&environment, &file.path, text, all);
                files.push(written.map_err(|failure| refusal(&failure))?);
            }
        }
        check_names(files).map_err(|failure| refusal(&failure))
    }
}

fn refusal(failure: &dyn std::fmt::Display) -> Diagnostic {
    Diagnostic::new(codes::E0702, format!("the measuring program cannot be written: {failure}"))
}
