//! Files of `abbe map`: every pose with its deviation, for other programs.

use super::session::Session;
use super::write::{refuse_input, write_streamed};
use super::{Outcome, Stop};
use crate::report::Rows;
use std::path::{Path, PathBuf};

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

    /// The file that can be written while a map is made; the others need all of it.
    pub(super) fn streamed(&self, session: &mut Session) -> Result<Option<&Path>, Stop> {
        if self.json.is_some() || self.parquet.is_some() || self.vtk.is_some() {
            return session.usage("so many poses are written as CSV only: leave `--json`, `--parquet` and `--vtk` out");
        }
        Ok(self.csv.as_deref())
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
