//! `abbe testpiece`: a test piece as a job.

use crate::cli::Outcome;
use crate::cli::arguments::{counts, help};
use crate::cli::output::session::Session;
use crate::cli::output::view::numbers;
use crate::cli::store::tree::write_new_folder;
use abbe::options::{ConeMotion, TestPieceKind};
use abbe::results::TestPiece;
use abbe::text::{Reason, cell, significant};
use abbe::{TestPieceOptions, testpiece};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The kind of piece.
    #[arg(value_enum)]
    kind: TestPieceKind,
    /// Side of a box or square (or of that about a diamond), diameter of a circle or of a cone's base, length of an S,
    /// mm (0.1 to 100000) [default: 160, of a cone 80].
    #[arg(long, value_name = "MM", value_parser = size)]
    piece_size: Option<f64>,
    /// Height of a contour, of a box, of the base of a cone or of an S above the part's origin, mm (0.1 to 100000)
    /// [default: 20, of a cone 120, of an S 40, of a box its side].
    #[arg(long, value_name = "MM", value_parser = size)]
    height: Option<f64>,
    /// Half of the apex angle of a cone, deg (above 0) [default: 15].
    #[arg(long, value_name = "DEG")]
    half_apex: Option<f64>,
    /// Tilt of a cone, largest lean of an S, turn of a diamond, deg (0 to 80) [default: 10 of a cone, 20 of an S, 30 of
    /// a diamond].
    #[arg(long, value_name = "DEG", value_parser = tilt)]
    tilt: Option<f64>,
    /// Motion of a rotary axis about Z on a cone, which chooses the tilt.
    #[arg(long, value_enum, value_name = "MOTION", conflicts_with = "tilt")]
    c_motion: Option<ConeMotion>,
    /// Number of intervals of a circle or of each side, of tool poses on each face of a box (8 to 100000).
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = counts(8..=100_000))]
    steps: usize,
    #[arg(long, short, value_name = "PATH", help = help::OUT,
        long_help = "Write the job file and its table of tool poses to this new folder")]
    out: PathBuf,
}

fn size(text: &str) -> Result<f64, Reason> {
    let mm = text.parse::<f64>().ok().filter(|mm| (0.1..=1e5).contains(mm));
    mm.ok_or_else(|| Reason::new("a size is 0.1 to 100000 mm"))
}

fn tilt(text: &str) -> Result<f64, Reason> {
    let deg = text.parse::<f64>().ok().filter(|deg| (0.0..=80.0).contains(deg));
    deg.ok_or_else(|| Reason::new("a tilt is 0 to 80 deg"))
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let options = TestPieceOptions {
        kind: args.kind,
        size_mm: args.piece_size,
        height_mm: args.height,
        half_apex_deg: args.half_apex,
        tilt_deg: args.tilt,
        c_motion: args.c_motion,
        steps: args.steps,
    };
    let piece = session.take(testpiece(&options, session.run()))?;
    write_new_folder(&args.out, &piece.files).or_else(|refusal| session.refuse(refusal))?;
    session.show(&piece, || csv(&piece), || text(&piece, args))
}

fn csv(piece: &TestPiece) -> String {
    let line = |name: &String| format!("{},{},{}\n", cell(name), piece.poses, numbers([piece.largest_tilt_deg]));
    "feature,poses,largest tilt [deg]\n".to_owned() + &piece.features.iter().map(line).collect::<String>()
}

fn text(piece: &TestPiece, args: &Args) -> String {
    let job = args.out.join(&piece.job);
    let notes: String = piece.notes.iter().map(|note| format!("Note: {note}\n")).collect();
    format!(
        "{} tool poses, tool up to {} deg from Z; features: {}\n{notes}Wrote {}; next: `abbe map MACHINE --job {}`\n",
        piece.poses,
        significant(piece.largest_tilt_deg, 4),
        piece.features.join(", "),
        args.out.display(),
        job.display()
    )
}
