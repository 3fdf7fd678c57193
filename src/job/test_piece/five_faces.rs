//! A box that stands on the part's origin: tool poses in rows on its top and its four sides, the tool across each.

use super::options::TestPieceOptions;
use super::path::Piece;
use crate::diagnostic::Reason;
use nalgebra::Vector3;

const NO_TOLERANCES: &str = "a box has no tolerances: state `features` of your own, or a `limit`";

/// Names of the faces with their normals and the directions of their rows; the bottom is clamped.
const FACES: [(&str, [f64; 3], [f64; 3]); 5] = [
    ("top", [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
    ("front", [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
    ("right", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
    ("back", [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
    ("left", [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
];

pub(super) fn five_faces(options: &TestPieceOptions) -> Result<Piece, Reason> {
    let (side, poses) = (options.size(160.0)?, options.intervals()?);
    let height = options.height(side)?;
    let half = Vector3::new(side, side, height) / 2.0;
    let rows = (1..).find(|n| n * n >= poses).unwrap_or(poses);
    let place = |i: usize| -1.0 + 2.0 * i as f64 / (rows - 1) as f64;
    let title = format!("Box of {side} x {side} x {height} mm, five faces, the tool across each");
    // The tool cannot touch the origin, which lies below the box.
    let zero = Some(Vector3::z() * height);
    let notes = vec![NO_TOLERANCES.to_owned()];
    let mut piece = Piece { title, are_single: true, zero, notes, ..Piece::default() };
    for (name, normal, along) in FACES {
        piece.name(name);
        let (normal, along) = (Vector3::from(normal), Vector3::from(along));
        for k in 0..rows * rows {
            let on_face = normal + along * place(k % rows) + normal.cross(&along) * place(k / rows);
            piece.point(on_face.component_mul(&half) + Vector3::z() * half.z, normal, normal);
        }
    }
    Ok(piece)
}
