//! A single-axis measurement as an instrument exports it, to a table of error curves.

use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::identify::import::{self, Finding, FindingEffect, Import, ImportRequest};
use crate::report::imported::ImportResult;
use crate::report::positioning::contributors;
use crate::run::{Call, Refused, Reply, Run};
use crate::standards::{self, Thermal};
use crate::units::counted;
use std::path::{Path, PathBuf};

pub use crate::identify::import::{Acceptance, FileContents, RunApproach, StraightnessLine};

/// Options of [`import`](import()): facts that the file leaves open.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ImportOptions {
    /// The axis that moved.
    pub axis: Option<String>,
    /// The error whose runs the columns are, such as `EXX`; of several errors the only one to take.
    pub error: Option<String>,
    /// Unit of readings that have none in the file.
    pub unit: Option<String>,
    /// Errors, or corrections, which have the other sign; errors by default. Must be given where the layout of the file
    /// leaves it open.
    pub contents: Option<FileContents>,
    /// Approach of runs without a direction.
    pub runs: Option<RunApproach>,
    /// Direction of the beam of a six-degree instrument, from the launch to the receiver, such as `+X`.
    pub beam: Option<String>,
    /// The machine's direction in which the vertical of that instrument points, such as `+Z`.
    pub vertical: Option<String>,
    /// Titles of its channels that change their sign.
    pub flip: Vec<String>,
    /// A file that maps the columns.
    pub columns: Option<PathBuf>,
    /// The line that is taken off a straightness.
    pub line: StraightnessLine,
    /// Keeps it: the straightness was read against an artefact of the machine.
    pub keep_line: bool,
    /// The axis turns without end: positions modulo 360 deg, first row again at the end.
    pub continuous: bool,
    /// Temperature and expansion of the machine's material, such as `22.5 degC x 11.5 um/m/K`: positions of a linear
    /// axis are brought to 20 deg C, about the first target.
    pub material: Option<String>,
    /// Contributors to the uncertainty of the figures (ISO 230-2 annex A), such as `device 0.5 um/m`,
    /// `misalignment 1 mm`, `temperature 0.7 K x 11.5 um/m/K`, `expansion 2 um/m/K x 5 K`, `drift 1.2 um`.
    pub uncertainty: Vec<String>,
    /// Suspicions that the caller accepts: `suspect` takes readings that accuse themselves.
    pub accept: Vec<Acceptance>,
    /// Refuses a file whose table would have no row.
    pub needs_table: bool,
}

/// Maximum number of left-out rows that a warning lists.
const LISTED: usize = 12;

/// Reads an export: text, UTF-8 or UTF-16, comma, semicolon or tab.
///
/// Fails if the file cannot be understood as a whole; single rows are left out with a warning.
pub fn import(path: impl AsRef<Path>, options: &ImportOptions, run: Run) -> Reply<ImportResult> {
    Call::answer(run, &Sources::default(), |call| {
        let request = request(call, options)?;
        let contributors = match contributors(&options.uncertainty) {
            Ok(contributors) => contributors,
            Err(words) => {
                return call.usage(format!(
                    "`{}` is no uncertainty: write `device 0.5 um/m`, `misalignment 1 mm`, `temperature 0.7 K x 11.5 \
                     um/m/K`, `expansion 2 um/m/K x 5 K` or `drift 1.2 um`",
                    shown(words)
                ));
            }
        };
        let found = import::import(path.as_ref(), &request, run.files, &mut call.diagnostics);
        call.check()?;
        let found = found.ok_or(Refused)?;
        call.extend(found.findings.iter().map(suspicion));
        call.check()?;
        let table = found.table(options.continuous);
        call.extend(left_out(&found));
        call.extend(unknown_columns(&found));
        call.extend(missing(&table.missing));
        if table.rows == 0 && options.needs_table {
            let message = "the table has no row: at no position were all errors measured, from all sides";
            let help =
                "measure the same targets in both directions; without --out the figures of what there is are printed";
            return call.refuse(Diagnostic::new(codes::E0509, message).help(help));
        }
        let result = ImportResult::of(&found, &request, &contributors, &call.diagnostics.sources);
        Ok(ImportResult { table_rows: table.rows, table: table.text, ..result })
    })
}

fn request(call: &mut Call, options: &ImportOptions) -> Result<ImportRequest, Refused> {
    let request = ImportRequest {
        axis: options.axis.clone(),
        error: options.error.clone(),
        unit: options.unit.clone(),
        contents: options.contents,
        approach: options.runs,
        line: options.line,
        keep_line: options.keep_line,
        continuous: options.continuous,
        flipped: options.flip.clone(),
        material: material(call, options)?,
        accepts_suspect: options.accept.contains(&Acceptance::Suspect),
        ..ImportRequest::default()
    };
    let request = match (&options.beam, &options.vertical) {
        (None, None) => request,
        (Some(beam), Some(vertical)) => match request.with_mounting(beam, vertical) {
            Some(request) => request,
            None => {
                return call.usage("`--beam` and `--vertical` are two directions across each other, such as +X and +Z");
            }
        },
        _ => return call.usage("`--beam` and `--vertical` need each other"),
    };
    let Some(file) = &options.columns else { return Ok(request) };
    let map = import::read_columns(file, call.run.files, &mut call.diagnostics);
    Ok(request.with_columns(map.ok_or(Refused)?))
}

/// The material of the machine, in words.
fn material(call: &mut Call, options: &ImportOptions) -> Result<Option<Thermal>, Refused> {
    let Some(words) = &options.material else { return Ok(None) };
    match standards::thermal(words).filter(Thermal::is_plausible) {
        Some(found) => Ok(Some(found)),
        None => call.usage(format!(
            "`{}` is no material: write its temperature times its expansion, such as `22.5 degC x 11.5 um/m/K`",
            shown(words)
        )),
    }
}

fn left_out(found: &Import) -> Option<Diagnostic> {
    let (count, used) = (found.left_out.len(), counted(found.samples.len(), "reading"));
    let message = format!("rows or readings left out: {count}; {used} used");
    let warning = Diagnostic::new(codes::W0504, message).help("correct the file, or accept what is left");
    let listed = found.left_out.iter().take(LISTED);
    (count > 0).then(|| listed.fold(warning, |warning, row| warning.at(Some(row.place.clone()), row.reason.clone())))
}

/// The diagnostic of a finding, with its lines.
fn suspicion(finding: &Finding) -> Diagnostic {
    let code = if finding.effect == FindingEffect::Refused { codes::E0543 } else { codes::W0520 };
    let diagnostic = Diagnostic::new(code, finding.message.clone()).help(finding.help.clone());
    finding.places.iter().take(LISTED).fold(diagnostic, |diagnostic, place| diagnostic.at(Some(place.clone()), ""))
}

fn unknown_columns(found: &Import) -> Option<Diagnostic> {
    let unknown = found.unused_columns.iter().filter(|column| !column.known);
    let titles: Vec<&str> = unknown.map(|column| column.title.as_str()).collect();
    let help = "a reading among them is mapped by `--columns FILE`; `abbe explain W0511` shows such a file";
    columns_left_out(&titles, help)
}

/// A warning of columns that were not understood.
pub(crate) fn columns_left_out(titles: &[&str], help: &str) -> Option<Diagnostic> {
    let list: Vec<String> = titles.iter().take(LISTED).map(|title| format!("`{}`", shown(title))).collect();
    let more = if titles.len() > LISTED { " ..." } else { "" };
    let message = format!("{} left out, not understood: {}{more}", counted(titles.len(), "column"), list.join(", "));
    (!titles.is_empty()).then(|| Diagnostic::new(codes::W0511, message).help(help))
}

fn missing(positions: &[String]) -> Option<Diagnostic> {
    let list = positions.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let message = format!("the table has no row at {list}: an error or a direction was not measured there");
    let help = "measure the same targets in both directions";
    (!positions.is_empty()).then(|| Diagnostic::new(codes::W0504, message).help(help))
}
