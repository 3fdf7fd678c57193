//! Files of `abbe map`: every pose with its deviation, for other programs.

use super::Outcome;
use super::session::Session;
use super::write::{refuse_input, write_streamed};
use crate::report::Rows;
use std::path::PathBuf;

/// Where every pose with its deviation is written.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Outputs {
    /// Write every pose with its deviation to a CSV file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The same as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// The same as Parquet.
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    /// The same as an unstructured grid of VTK (`.vtu`), which ParaView opens as a vector field.
    #[arg(long, value_name = "FILE.vtu")]
    vtk: Option<PathBuf>,
}

impl Outputs {
    fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.csv, &self.json, &self.parquet, &self.vtk].into_iter().flatten()
    }

    /// Refuses outputs that are inputs, before any work.
    pub(super) fn check(&self, session: &mut Session) -> Outcome {
        for path in self.paths() {
            refuse_input(path, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
        }
        Ok(())
    }

    /// Writes what was asked for, each file whole or not at all.
    pub(super) fn write(&self, session: &mut Session, rows: &Rows<'_>) -> Outcome {
        let csv = self.csv.as_ref().map(|path| write_streamed(path, |out| rows.csv(out)));
        let json = self.json.as_ref().map(|path| write_streamed(path, |out| rows.json(out)));
        let parquet = self.parquet.as_ref().map(|path| write_streamed(path, |out| rows.parquet(out)));
        let vtk = self.vtk.as_ref().map(|path| write_streamed(path, |out| rows.vtk(out)));
        let failure = [csv, json, parquet, vtk].into_iter().flatten().find_map(Result::err);
        failure.map_or(Ok(()), |diagnostic| session.refuse(diagnostic))
    }
}
