//! Files of `abbe map`: every pose with its deviation, for other programs.

use super::session::Session;
use crate::cli::store::write::Staged;
use crate::cli::{Exit, Outcome};
use crate::diagnostic::Diagnostic;
use crate::evaluate::Deviation;
use crate::report::{RowBlock, RowFormat, Rows, Stream};
use std::io::BufWriter;
use std::path::PathBuf;

/// Where every pose with its deviation is written.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Outputs {
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

/// Rows of a block of a map that is held: as many as a survey makes at once.
const BLOCK: usize = 1 << 14;

impl Outputs {
    fn wanted(&self) -> impl Iterator<Item = (RowFormat, &PathBuf)> {
        let all = [
            (RowFormat::Csv, &self.csv),
            (RowFormat::Json, &self.json),
            (RowFormat::Parquet, &self.parquet),
            (RowFormat::Vtk, &self.vtk),
        ];
        all.into_iter().filter_map(|(form, path)| Some((form, path.as_ref()?)))
    }

    /// The forms that were asked for.
    pub(crate) fn forms(&self) -> Vec<RowFormat> {
        self.wanted().map(|(form, _)| form).collect()
    }

    /// Where they go.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.wanted().map(|(_, path)| path)
    }

    /// Writes a map that is held, each file whole or not at all.
    pub(crate) fn write(&self, session: &mut Session, rows: &Rows<'_>, deviations: &[Deviation]) -> Outcome {
        let forms = self.forms();
        if forms.is_empty() {
            return Ok(());
        }
        let mut tables = Tables::new(session, self, rows)?;
        for (k, block) in deviations.chunks(BLOCK).enumerate() {
            let first = k * BLOCK;
            let pairs = block.iter().enumerate().map(|(i, deviation)| (rows.poses.get(first + i), *deviation));
            if !tables.put(&rows.prepared(&forms, first, pairs)) {
                break;
            }
        }
        tables.finish(session)
    }
}

/// The files of a map, written side by side while it is made.
pub(crate) struct Tables<'a> {
    tables: Vec<(Staged, Box<dyn Stream + 'a>)>,
    failure: Option<Diagnostic>,
}

impl<'a> Tables<'a> {
    /// Begins them all.
    pub(crate) fn new(session: &mut Session, outputs: &Outputs, rows: &Rows<'a>) -> Result<Self, Exit> {
        let begin = |(form, path): (RowFormat, &PathBuf)| {
            let staged = Staged::new(path)?;
            let file = staged.file()?;
            let stream = rows.stream(form, BufWriter::new(file)).map_err(|failure| staged.failed(&failure))?;
            Ok((staged, stream))
        };
        let tables: Result<Vec<_>, Diagnostic> = outputs.wanted().map(begin).collect();
        Ok(Self { tables: tables.or_else(|d| session.refuse(d))?, failure: None })
    }

    /// The next rows; `false` if one of the files cannot be written.
    pub(crate) fn put(&mut self, rows: &RowBlock) -> bool {
        let mut written =
            self.tables.iter_mut().map(|(staged, stream)| stream.put(rows).map_err(|f| staged.failed(&f)));
        self.failure = written.find_map(Result::err);
        self.failure.is_none()
    }

    /// Ends them all, and puts them in their places.
    pub(crate) fn finish(self, session: &mut Session) -> Outcome {
        let Self { tables, failure } = self;
        let end = |(staged, stream): (Staged, Box<dyn Stream + 'a>)| {
            stream.finish().map_err(|failure| staged.failed(&failure))?;
            Ok(staged)
        };
        let ended =
            failure.map_or(Ok(()), Err).and_then(|()| tables.into_iter().map(end).collect::<Result<Vec<_>, _>>());
        let placed = ended.and_then(|list| list.into_iter().try_for_each(Staged::commit));
        placed.or_else(|d| session.refuse(d))
    }
}
