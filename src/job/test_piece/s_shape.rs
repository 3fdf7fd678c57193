//! A ruled surface along an S whose lean changes sides, milled with the flank of the tool: the tip runs along its lower
//! edge, and the tool lies along the straight line of the surface there.
//!
//! Over u from -1/2 to 1/2 the lower edge is (a sin 2 pi u, L u, 0). The line leans by b cos 2 pi u across the edge, in
//! the plane that is upright to it: on one side in the middle of the S, on the other at its ends.

use super::options::TestPieceOptions;
use super::path::Piece;
use crate::analysis::zone::CharacteristicKind as Kind;
use crate::diagnostic::Reason;
use nalgebra::Vector3;

/// Amplitude of the S by its length.
const AMPLITUDE: f64 = 0.25;

/// Width of the zone of its profile, um.
const PROFILE: f64 = 100.0;

pub(super) fn s_shape(options: &TestPieceOptions) -> Result<Piece, Reason> {
    let (length, height, steps) = (options.size(160.0)?, options.height(40.0)?, options.intervals()?);
    let lean_deg = options.tilt(20.0)?;
    let title = format!("S-shaped ruled surface: length {length} mm, height {height} mm, lean up to {lean_deg} deg");
    let mut piece = Piece { title, ..Piece::default() };
    piece.name("flank");
    let (amplitude, turn) = (AMPLITUDE * length, std::f64::consts::TAU);
    for i in 0..=steps {
        let u = i as f64 / steps as f64 - 0.5;
        let (s, c) = libm::sincos(turn * u);
        let along = Vector3::new(amplitude * turn * c, length, 0.0).normalize();
        let across = Vector3::new(along.y, -along.x, 0.0);
        let (lean, upright) = libm::sincos(lean_deg.to_radians() * c);
        let axis = across * lean + Vector3::z() * upright;
        // The line is across the edge: the normal there is across both.
        piece.point(Vector3::new(amplitude * s, length * u, 0.0), axis, along.cross(&axis));
    }
    piece.tolerance("flank", Kind::Profile, PROFILE, None);
    piece.notes = vec![
        "the surface is geometry of our own in the manner of the S-shaped test piece of ISO 10791-7, whose control \
         points it does not have; the profile of 100 um is from memory; check against the standard"
            .to_owned(),
        format!("one flank along its lower edge; its {height} mm above the tip are not followed"),
    ];
    Ok(piece)
}
