//! A cone frustum whose axis is tilted, milled with the flank of the tool: the tip runs along the circle of its base,
//! and the tool lies along the straight line of the cone there.

use super::options::{ConeMotion, TestPieceOptions};
use super::path::Piece;
use crate::analysis::zone::CharacteristicKind as Kind;
use crate::diagnostic::Reason;
use nalgebra::Vector3;

/// Tolerance of the roundness, um.
const ROUND: f64 = 80.0;

/// Angles (deg) within which the tilt is that of the half apex.
const SAME: f64 = 1e-6;

pub(super) fn cone(options: &TestPieceOptions) -> Result<Piece, Reason> {
    let (diameter, height, steps) = (options.size(80.0)?, options.height(120.0)?, options.intervals()?);
    let half = options.half_apex_deg.unwrap_or(15.0);
    if !(half > 0.0 && half < 80.0) {
        return Err(Reason::new(format!("half an apex is above 0 and below 80 deg, not {half}")));
    }
    if options.tilt_deg.is_some() && options.c_motion.is_some() {
        return Err(Reason::new("the motion of C follows from the tilt: state one of them"));
    }
    let tilt = options.tilt(match options.c_motion {
        None => 10.0,
        Some(ConeMotion::Turn) => half * 2.0 / 3.0,
        Some(ConeMotion::Pole) => half,
        Some(ConeMotion::Swing) => half * 2.0,
    })?;
    let motion = match tilt - half {
        off if off.abs() <= SAME => ConeMotion::Pole,
        off if off < 0.0 => ConeMotion::Turn,
        _ => ConeMotion::Swing,
    };
    let [(sine, cosine), (rise, lean)] = [tilt, half].map(|deg| libm::sincos(deg.to_radians()));
    // The axis of the cone, and two directions across it.
    let axis = Vector3::new(sine, 0.0, cosine);
    let across = [Vector3::new(cosine, 0.0, -sine), Vector3::y()];
    let words = match motion {
        ConeMotion::Turn => "a rotary axis about Z makes a whole turn",
        ConeMotion::Pole => "the tool passes along Z, where a rotary axis about Z is singular",
        ConeMotion::Swing => "a rotary axis about Z goes to and fro",
    };
    let title =
        format!("Cone frustum: base of {diameter} mm, half apex {half} deg, axis tilted by {tilt} deg; {words}");
    let mut piece = Piece { title, c_motion: Some(motion), ..Piece::default() };
    piece.name("cone");
    for i in 0..=steps {
        let (s, c) = libm::sincos(std::f64::consts::TAU * i as f64 / steps as f64);
        let outward = across[0] * c + across[1] * s;
        let tip = Vector3::z() * height + outward * (0.5 * diameter);
        piece.point(tip, axis * lean - outward * rise, outward * lean + axis * rise);
    }
    piece.tolerance("cone", Kind::Roundness, ROUND, None);
    let defaults = [
        (options.size_mm.is_none(), "base of 80 mm, "),
        (options.half_apex_deg.is_none(), "half apex of 15 deg, "),
        (options.tilt_deg.is_none() && options.c_motion.is_none(), "tilt of 10 deg, "),
    ];
    let defaults: String = defaults.into_iter().filter(|(is, _)| *is).map(|(_, words)| words).collect();
    piece.notes = vec![
        format!(
            "from memory of NAS 979 and ISO 10791-7 (cone frustum): {defaults}roundness of 80 um; check against the \
             standard"
        ),
        "the deviation is that of the tip along the normal, at the base of the cone".to_owned(),
    ];
    Ok(piece)
}
