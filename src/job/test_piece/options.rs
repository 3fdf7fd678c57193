//! Kinds of test pieces and their sizes.

use crate::diagnostic::Reason;

/// A kind of test piece.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum TestPieceKind {
    /// Four sides parallel to X and Y, in the manner of ISO 10791-7.
    Square,
    /// A square that is turned, in the manner of ISO 10791-7.
    Diamond,
    /// A circle, in the manner of ISO 10791-7.
    Circle,
    /// A cone frustum whose axis is tilted, flank milled with five axes, in the manner of ISO 10791-7 and NAS 979.
    #[default]
    Cone,
    /// A ruled surface along an S, flank milled with five axes: geometry of our own in the manner of ISO 10791-7.
    SShape,
    /// Circle, diamond and square above each other, in the manner of NAS 979.
    #[serde(rename = "nas-979")]
    #[cfg_attr(feature = "cli", value(name = "nas-979"))]
    Nas979,
    /// A box with five faces, the tool across each: a work to begin with, of no standard.
    Box,
}

impl TestPieceKind {
    const ALL: [Self; 7] =
        [Self::Square, Self::Diamond, Self::Circle, Self::Cone, Self::SShape, Self::Nas979, Self::Box];

    /// True for each of half an apex, a tilt and a motion of C that a piece of the kind has.
    fn angles(self) -> [bool; 3] {
        match self {
            Self::Cone => [true; 3],
            Self::Diamond | Self::SShape | Self::Nas979 => [false, true, false],
            Self::Square | Self::Circle | Self::Box => [false; 3],
        }
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Square => "square",
            Self::Diamond => "diamond",
            Self::Circle => "circle",
            Self::Cone => "cone",
            Self::SShape => "s-shape",
            Self::Nas979 => "nas-979",
            Self::Box => "box",
        }
    }
}

/// The motion of a rotary axis about Z along the circle of a tilted cone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ConeMotion {
    /// The axis is tilted by less than the half apex: a whole turn.
    Turn,
    /// By as much: half a turn, at its ends the tool along Z, where the motion is singular.
    Pole,
    /// By more: to and fro.
    Swing,
}

/// Options of a test piece.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct TestPieceOptions {
    /// The kind.
    pub kind: TestPieceKind,
    /// Side of a square, also of that about a diamond, or of a box; diameter of a circle or of the base of a cone;
    /// length of an S; 0.1 to 100000 mm; by default 160, of a cone 80.
    pub size_mm: Option<f64>,
    /// Height of the contour, of a box, or of the centre of a cone's base above the part's origin, 0.1 to 100000 mm; by
    /// default 20, of a cone 120, of an S the height of its surface, 40, of a box its side.
    pub height_mm: Option<f64>,
    /// Cone: half of its apex angle, above 0 and below 80 deg; by default 15.
    pub half_apex_deg: Option<f64>,
    /// Cone: tilt of its axis about Y, 0 to 80 deg; S: the largest lean of its surface; diamond, also of NAS 979: its
    /// turn against the square. By default 10 of a cone or by its motion, 20 of an S, 30 of a diamond.
    pub tilt_deg: Option<f64>,
    /// Cone: the motion of a rotary axis about Z, which chooses the tilt in place of an angle.
    pub c_motion: Option<ConeMotion>,
    /// Number of intervals of a circle, or of each side, 8 to 100000.
    /// Of a box, number of tool poses on each face, in equal rows, so that there may be a few more.
    pub steps: usize,
}

impl Default for TestPieceOptions {
    fn default() -> Self {
        Self {
            kind: TestPieceKind::default(),
            size_mm: None,
            height_mm: None,
            half_apex_deg: None,
            tilt_deg: None,
            c_motion: None,
            steps: 360,
        }
    }
}

impl TestPieceOptions {
    /// Refuses options that the kind does not have.
    pub(super) fn check(&self) -> Result<(), Reason> {
        let (kind, angles) =
            (self.kind, [self.half_apex_deg.is_some(), self.tilt_deg.is_some(), self.c_motion.is_some()]);
        for (index, name) in ["the half apex", "the tilt", "the motion of C"].into_iter().enumerate() {
            let kinds: Vec<&str> =
                TestPieceKind::ALL.into_iter().filter(|of| of.angles()[index]).map(|of| of.name()).collect();
            if angles[index] && !kind.angles()[index] {
                let kinds = kinds.join(", ");
                return Err(Reason::new(format!("{name} is no option of `{}`: it is one of {kinds}", kind.name())));
            }
        }
        Ok(())
    }

    /// Returns a size or its default, mm.
    pub(super) fn size(&self, default_mm: f64) -> Result<f64, Reason> {
        length(self.size_mm, default_mm, "a size")
    }

    /// Returns a height or its default, mm.
    pub(super) fn height(&self, default_mm: f64) -> Result<f64, Reason> {
        length(self.height_mm, default_mm, "a height")
    }

    /// Returns the number of intervals.
    pub(super) fn intervals(&self) -> Result<usize, Reason> {
        if (8..=100_000).contains(&self.steps) {
            Ok(self.steps)
        } else {
            Err(Reason::new("a contour has 8 to 100000 steps"))
        }
    }

    /// Returns the tilt or its default, deg.
    pub(super) fn tilt(&self, default_deg: f64) -> Result<f64, Reason> {
        let tilt = self.tilt_deg.unwrap_or(default_deg);
        if (0.0..=80.0).contains(&tilt) {
            Ok(tilt)
        } else {
            Err(Reason::new(format!("a tilt is 0 to 80 deg, not {tilt}")))
        }
    }
}

/// Sizes of pieces, mm: the least is 100000 of the last digits of the table, as many as the most steps of a contour.
const SIZES: std::ops::RangeInclusive<f64> = 0.1..=1e5;

fn length(given: Option<f64>, default_mm: f64, what: &str) -> Result<f64, Reason> {
    let mm = given.unwrap_or(default_mm);
    if SIZES.contains(&mm) {
        Ok(mm)
    } else {
        Err(Reason::new(format!("{what} of {mm:?} mm: 0.1 to 100000 mm are taken")))
    }
}
