//! Files of `abbe map`: every pose with its deviation, for other programs, and pictures.

use super::session::Session;
use crate::cli::Outcome;
use crate::cli::arguments::{PictureFile, help, png, svg};
use crate::cli::store::write::StagedFile;
use abbe::Diagnostic;
use abbe::options::{MapTable, PlaneComponent, PlaneDrawing, PlaneOptions, TableForm};
use abbe::results::Picture;
use std::io::BufWriter;
use std::path::PathBuf;

/// Files for every pose with its deviation.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct OutputArgs {
    /// Write every pose with its deviation to a CSV file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The same as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// The same as Parquet.
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    #[arg(long, value_name = "FILE", help = help::VTK,
        long_help = "The same as an unstructured grid of VTK (`.vtu`), which ParaView opens as a vector field")]
    vtk: Option<PathBuf>,
}

impl OutputArgs {
    fn files(&self) -> impl Iterator<Item = (TableForm, &PathBuf)> {
        let all = [
            (TableForm::Csv, &self.csv),
            (TableForm::Json, &self.json),
            (TableForm::Parquet, &self.parquet),
            (TableForm::Vtk, &self.vtk),
        ];
        all.into_iter().filter_map(|(form, path)| Some((form, path.as_ref()?)))
    }

    /// Returns the paths of the files.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.files().map(|(_, path)| path)
    }

    /// Begins all files.
    pub(crate) fn begin(&self) -> Result<StagedTables, Diagnostic> {
        let begin =
            |(form, path): (TableForm, &PathBuf)| Ok((form, path.display().to_string(), StagedFile::new(path)?));
        Ok(StagedTables(self.files().map(begin).collect::<Result<_, _>>()?))
    }
}

/// The files of a map in the making.
pub(crate) struct StagedTables(Vec<(TableForm, String, StagedFile)>);

impl StagedTables {
    /// The files as tables to be filled.
    pub(crate) fn tables(&self) -> Result<Vec<MapTable<'static>>, Diagnostic> {
        let table = |(form, name, staged): &(TableForm, String, StagedFile)| {
            let sink = Box::new(BufWriter::new(staged.writer()?));
            Ok(MapTable { name: name.clone(), form: *form, sink })
        };
        self.0.iter().map(table).collect()
    }

    /// Puts the filled files in their places.
    pub(crate) fn commit(self) -> Result<(), Diagnostic> {
        self.0.into_iter().try_for_each(|(.., staged)| staged.commit())
    }
}

/// Options of the pictures.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct PictureArgs {
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw the error over a plane of two linear axes, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
    #[arg(long, value_name = "FILE", value_parser = png, help = help::PNG,
        long_help = "The same, as PNG unless the file ends in .svg")]
    png: Option<PictureFile>,
    /// Form of the picture: a map of colours with arrows, or the deformed grid; `before-after` maps the error without
    /// compensation and the residual (with `--target`).
    #[arg(long, value_enum, default_value = "colours")]
    drawing: PlaneDrawing,
    #[arg(long, value_name = "AXES", help = help::PLANE,
        long_help = "The two linear axes of the picture, such as XY or X,Z [default: the first two]")]
    plane: Option<String>,
    #[arg(long, value_name = "X=100,C=90", allow_hyphen_values = true, help = help::AT,
        long_help = "Positions of the other axes for the picture, mm and deg [default: 0, or the end of the travel \
                     nearest to it]")]
    at: Option<String>,
    /// Quantity that the colours show.
    #[arg(long, value_enum, default_value = "length")]
    component: PlaneComponent,
}

impl PictureArgs {
    /// Returns the files of the pictures.
    pub(crate) fn files(&self) -> impl Iterator<Item = &PictureFile> + Clone {
        self.svg.iter().chain(&self.png)
    }

    /// Returns their paths.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.files().map(PictureFile::path)
    }

    /// Refuses options of a picture without one, and files that are no pictures.
    pub(crate) fn refuse_unfit(&self, session: &Session) -> Outcome {
        PictureFile::refuse_unknown(session, self.files())?;
        let drawn = self.svg.is_some() || self.png.is_some();
        if !drawn && (self.plane.is_some() || self.at.is_some() || self.drawing != PlaneDrawing::Colours) {
            return session
                .usage("`--plane`, `--at` and `--drawing` are for a picture: add `--svg FILE` or `--png FILE`");
        }
        Ok(())
    }

    /// The picture asked for.
    pub(crate) fn options(&self) -> Option<PlaneOptions> {
        let _ = self.paths().next()?;
        let (drawing, component) = (self.drawing, self.component);
        Some(PlaneOptions { drawing, plane: self.plane.clone(), at: self.at.clone(), component })
    }

    /// Writes the picture.
    pub(crate) fn write(&self, session: &mut Session, picture: Option<&Picture>) -> Outcome {
        let Some(picture) = picture else { return Ok(()) };
        for file in self.files() {
            file.write(picture, session)?;
        }
        Ok(())
    }
}
