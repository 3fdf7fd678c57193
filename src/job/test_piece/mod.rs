//! Test pieces as jobs: tool poses with normals along the contours of a piece, and the tolerances of its features.
//!
//! - `options`: kinds of pieces and their sizes;
//! - `contour`: polygons and circles in layers, and the piece of NAS 979;
//! - `cone`: a cone frustum whose axis is tilted;
//! - `five_faces`: a box;
//! - `s_shape`: a ruled surface whose lean changes sides;
//! - `written`: the files of a job.
//!
//! Sizes and tolerances are from memory of the standards and of published tests; each file says so.

mod cone;
mod contour;
mod five_faces;
mod options;
mod path;
mod s_shape;
mod written;

use crate::diagnostic::{Diagnostic, codes};
pub use options::{ConeMotion, TestPieceKind, TestPieceOptions};
use path::Piece;
use schemars::JsonSchema;
use serde::Serialize;

/// A test piece as a job.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TestPiece {
    /// The kind.
    pub kind: TestPieceKind,
    /// Number of tool poses.
    pub poses: usize,
    /// Names of its features.
    pub features: Vec<String>,
    /// The motion of a rotary axis about Z, of a cone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c_motion: Option<ConeMotion>,
    /// Largest angle of the tool to Z, deg.
    pub largest_tilt_deg: f64,
    /// Notes on what rests on memory, or is geometry of our own.
    pub notes: Vec<String>,
    /// Name of the job file.
    pub job: String,
    /// The files: names and bytes.
    #[serde(skip)]
    pub files: Vec<(String, Vec<u8>)>,
}

/// Returns a test piece as a job; the diagnostic names a size that no such piece has.
pub(crate) fn test_piece(options: &TestPieceOptions) -> Result<TestPiece, Diagnostic> {
    let piece = options.check().and_then(|()| match options.kind {
        TestPieceKind::Square => contour::square(options),
        TestPieceKind::Diamond => contour::diamond(options),
        TestPieceKind::Circle => contour::circle(options),
        TestPieceKind::Nas979 => contour::nas_979(options),
        TestPieceKind::Cone => cone::cone(options),
        TestPieceKind::SShape => s_shape::s_shape(options),
        TestPieceKind::Box => five_faces::five_faces(options),
    });
    let piece = piece.map_err(|wrong| {
        let help = "sizes are 0.1 to 100000 mm; `abbe testpiece --help` has the meaning of all options";
        Diagnostic::new(codes::E0818, wrong.to_string()).help(help)
    })?;
    let Piece { names, c_motion, notes, .. } = &piece;
    let name = options.kind.name();
    let steepest = piece.points.iter().map(|point| point.axis.z).fold(1.0, f64::min);
    Ok(TestPiece {
        kind: options.kind,
        poses: piece.points.len(),
        features: names.clone(),
        c_motion: *c_motion,
        largest_tilt_deg: libm::acos(steepest).to_degrees(),
        notes: notes.clone(),
        job: format!("{name}.yaml"),
        files: written::files(name, &piece),
    })
}
