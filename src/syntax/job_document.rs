//! A job file to its text with places.

use super::files::Files;
use super::job_text::{JobText, SECTION};
use super::mapping::{FileForm, read_mapping};
use super::schema::schema;
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use std::path::Path;

/// Reads a job file; what is not YAML, or holds no job, is reported.
pub fn read_job(path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<JobText> {
    let help = "a job names the file of its tool poses: `tool_poses: part.csv`; docs/formats/jobs.md has an example";
    let empty = Diagnostic::new(codes::E0851, "the file holds no job").help(help);
    let root = schema();
    let form = FileForm { schemas: [&root["properties"][SECTION], &root], empty };
    let written = read_mapping(path, None, form, files, diagnostics)?;
    Some(JobText::of_file(written.map, written.places))
}
