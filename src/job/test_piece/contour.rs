//! Contours in layers, milled with the flank of a tool along Z: square, diamond and circle.

use super::options::TestPieceOptions;
use super::path::Piece;
use crate::analysis::zone::CharacteristicKind as Kind;
use crate::diagnostic::Reason;
use nalgebra::Vector3;

/// Part of a side at its ends that is no point of a feature: there the normal turns.
const CORNER: f64 = 0.05;

/// Above this size (mm) tolerances are those of the larger piece.
const SMALL: f64 = 160.0;

const FROM_MEMORY: &str =
    "tolerances are from memory of ISO 10791-7 (contouring test piece); check against the standard";
const OWN_PROPORTIONS: &str = "sizes are proportions of our own; check against the standard";
const NO_BORE: &str = "the central bore, and the position of the circle to it, are left out: boring is no contour";

/// Returns the note on sizes that the options do not state.
fn own_sizes(options: &TestPieceOptions) -> Option<String> {
    let stated = options.size_mm.is_some() && options.height_mm.is_some();
    (!stated).then(|| OWN_PROPORTIONS.to_owned())
}

type Result<T> = std::result::Result<T, Reason>;

/// A polygon of four sides about a point of the part.
struct Sides<'a> {
    /// Names of its sides begin with this.
    name: &'a str,
    side: f64,
    turn_deg: f64,
    height: f64,
    steps: usize,
}

impl Sides<'_> {
    /// Adds the sides, counter-clockwise: the first is the lower one before the turn.
    fn add(&self, piece: &mut Piece) {
        let turned = |angle_deg: f64| {
            let angle = angle_deg.to_radians();
            Vector3::new(libm::cos(angle), libm::sin(angle), 0.0)
        };
        for k in 0..4 {
            let normal = turned(self.turn_deg - 90.0 + 90.0 * f64::from(k));
            let along = turned(self.turn_deg + 90.0 * f64::from(k));
            piece.name(format!("{}-{}", self.name, k + 1));
            for i in 0..=self.steps {
                let part = -0.5 + CORNER + (1.0 - 2.0 * CORNER) * i as f64 / self.steps as f64;
                let tip = normal * (0.5 * self.side) + along * (part * self.side) + Vector3::z() * self.height;
                piece.point(tip, Vector3::z(), normal);
            }
        }
    }
}

/// Adds a circle about a point of the part.
fn add_circle(piece: &mut Piece, diameter: f64, height: f64, steps: usize) {
    piece.name("circle");
    for i in 0..=steps {
        let angle = std::f64::consts::TAU * i as f64 / steps as f64;
        let normal = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        piece.point(normal * (0.5 * diameter) + Vector3::z() * height, Vector3::z(), normal);
    }
}

/// Tolerances of straightness and of angles for a size, um.
fn limits(size: f64) -> [f64; 2] {
    if size <= SMALL { [10.0, 15.0] } else { [15.0, 20.0] }
}

/// States straightness of four sides, and the angles of sides to the first, or of all to a datum.
fn state_sides(piece: &mut Piece, name: &str, size: f64, datum: Option<&str>) {
    let [straight, angle] = limits(size);
    let side = |k: usize| format!("{name}-{}", k + 1);
    for k in 0..4 {
        piece.tolerance(&side(k), Kind::Straightness, straight, None);
        match (datum, k) {
            (Some(datum), _) => piece.tolerance(&side(k), Kind::Angularity, angle, Some(datum)),
            (None, 1 | 3) => piece.tolerance(&side(k), Kind::Perpendicularity, angle, Some(&side(0))),
            (None, 2) => piece.tolerance(&side(k), Kind::Parallelism, angle, Some(&side(0))),
            _ => {}
        }
    }
}

/// Side of the largest square within another that is turned against it.
fn within(side: f64, turn_deg: f64) -> f64 {
    let turn = turn_deg.to_radians();
    side / (libm::cos(turn).abs() + libm::sin(turn).abs())
}

pub(super) fn square(options: &TestPieceOptions) -> Result<Piece> {
    let (side, height, steps) = (options.size(160.0)?, options.height(20.0)?, options.intervals()?);
    let mut piece = Piece { title: format!("Square of {side} mm, three axes"), ..Piece::default() };
    Sides { name: "square", side, turn_deg: 0.0, height, steps }.add(&mut piece);
    state_sides(&mut piece, "square", side, None);
    piece.notes = std::iter::once(FROM_MEMORY.to_owned()).chain(own_sizes(options)).collect();
    Ok(piece)
}

pub(super) fn diamond(options: &TestPieceOptions) -> Result<Piece> {
    let (size, height, steps) = (options.size(160.0)?, options.height(20.0)?, options.intervals()?);
    let turn_deg = options.tilt(30.0)?;
    let side = within(size, turn_deg);
    let title = format!("Diamond of {side:.3} mm, turned by {turn_deg} deg, three axes");
    let mut piece = Piece { title, ..Piece::default() };
    Sides { name: "diamond", side, turn_deg, height, steps }.add(&mut piece);
    state_sides(&mut piece, "diamond", size, None);
    piece.notes = vec![
        FROM_MEMORY.to_owned(),
        OWN_PROPORTIONS.to_owned(),
        "without the square the angles are to the first side of the diamond, not to a side of the square".to_owned(),
    ];
    Ok(piece)
}

pub(super) fn circle(options: &TestPieceOptions) -> Result<Piece> {
    let (diameter, height, steps) = (options.size(160.0)?, options.height(20.0)?, options.intervals()?);
    let mut piece = Piece { title: format!("Circle of {diameter} mm, three axes"), ..Piece::default() };
    add_circle(&mut piece, diameter, height, steps);
    piece.tolerance("circle", Kind::Roundness, limits(diameter)[1], None);
    piece.notes = std::iter::once(FROM_MEMORY.to_owned()).chain(own_sizes(options)).collect();
    Ok(piece)
}

/// Circle, diamond and square above each other, each within the one below.
pub(super) fn nas_979(options: &TestPieceOptions) -> Result<Piece> {
    let (size, height, steps) = (options.size(160.0)?, options.height(20.0)?, options.intervals()?);
    let turn_deg = options.tilt(30.0)?;
    let side = within(size, turn_deg);
    let title = format!("Circle, diamond and square of {size} mm in layers of {height} mm, three axes");
    let mut piece = Piece { title, ..Piece::default() };
    Sides { name: "square", side: size, turn_deg: 0.0, height, steps }.add(&mut piece);
    state_sides(&mut piece, "square", size, None);
    Sides { name: "diamond", side, turn_deg, height: 2.0 * height, steps }.add(&mut piece);
    state_sides(&mut piece, "diamond", size, Some("square-1"));
    add_circle(&mut piece, side, 3.0 * height, steps);
    piece.tolerance("circle", Kind::Roundness, limits(size)[1], None);
    let memory =
        "order of the layers and tolerances are from memory of NAS 979 and ISO 10791-7; check against the standards";
    piece.notes = vec![memory.to_owned(), OWN_PROPORTIONS.to_owned(), NO_BORE.to_owned()];
    Ok(piece)
}
