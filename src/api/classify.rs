//! The motion and the errors of a 4x4 matrix over the dual numbers.

use crate::algebra::{AdmissibilityFailure, Split, skew_vector, split};
use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::run::{Call, Refused, Reply, Run};
use crate::syntax::{from_yaml, read_text};
use crate::units::significant;
use nalgebra::Matrix4;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Options of [`classify`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ClassifyOptions {
    /// Difference of entries from those of a motion that counts as rounding; above 0 and below 0.1.
    pub tolerance: f64,
}

/// 1e-9.
impl Default for ClassifyOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9 }
    }
}

/// A matrix over the dual numbers, classified.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Classification {
    /// A motion with six errors.
    Admissible(Box<MotionWithErrors>),
    /// No such motion.
    Inadmissible(NoMotion),
}

/// A nominal motion N with six small errors, as E N and as N E.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MotionWithErrors {
    admissible: bool,
    /// Rotation of N, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Translation of N, mm.
    pub translation_mm: [f64; 3],
    /// Errors on the left of N: mm and rad.
    pub errors_before: SixErrors,
    /// Errors on the right of N: mm and rad.
    pub errors_after: SixErrors,
    units: Units,
    /// Angle of the rotation, deg.
    #[serde(skip)]
    pub angle_deg: f64,
    /// Unit vector of the axis of the rotation; none where it is not unique to rounding (0 and 180 deg).
    #[serde(skip)]
    pub axis: Option<[f64; 3]>,
}

/// Six errors; displacements in mm, rotations in rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "UPPERCASE")]
pub struct SixErrors {
    /// Displacement along X.
    pub ex: f64,
    /// Displacement along Y.
    pub ey: f64,
    /// Displacement along Z.
    pub ez: f64,
    /// Rotation about X.
    pub ea: f64,
    /// Rotation about Y.
    pub eb: f64,
    /// Rotation about Z.
    pub ec: f64,
}

impl SixErrors {
    fn of(six: [f64; 6]) -> Self {
        // Adding zero turns -0 into 0.
        let [ex, ey, ez, ea, eb, ec] = six.map(|value| value + 0.0);
        Self { ex, ey, ez, ea, eb, ec }
    }

    /// Returns them in the order EX, EY, EZ, EA, EB, EC.
    pub fn values(&self) -> [f64; 6] {
        [self.ex, self.ey, self.ez, self.ea, self.eb, self.ec]
    }
}

/// A matrix that is no motion with small errors.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct NoMotion {
    admissible: bool,
    /// The reason.
    pub reason: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
struct Units {
    length: &'static str,
    angle: &'static str,
}

impl MotionWithErrors {
    fn of(split: &Split) -> Self {
        let cosine = (0.5 * (split.rotation.trace() - 1.0)).clamp(-1.0, 1.0);
        let skew = skew_vector(&split.rotation);
        let angle = libm::atan2(skew.norm(), cosine);
        let unique = angle >= 1e-12 && skew.norm() >= 1e-9;
        Self {
            admissible: true,
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| split.rotation[(i, j)] + 0.0)),
            translation_mm: split.translation.into(),
            errors_before: SixErrors::of(split.before),
            errors_after: SixErrors::of(split.after),
            units: Units { length: "mm", angle: "rad" },
            angle_deg: if angle < 1e-12 { 0.0 } else { angle.to_degrees() },
            axis: unique.then(|| skew.normalize().map(|x| x + 0.0).into()),
        }
    }
}

/// The file of a matrix.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    matrix: Option<[[Entry; 4]; 4]>,
    real: Option<[[f64; 4]; 4]>,
    dual: Option<[[f64; 4]; 4]>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Entry {
    Real(f64),
    Dual([f64; 2]),
}

impl Entry {
    fn parts(self) -> [f64; 2] {
        match self {
            Self::Real(a) => [a, 0.0],
            Self::Dual(parts) => parts,
        }
    }
}

/// Reads a matrix over the dual numbers from a YAML file and classifies it.
///
/// The file has `matrix` with four rows of four entries, each `number` or `[real, i-part]`, or `real` and `dual`; mm
/// and rad. Fails if it has not; a matrix that is no motion is a result.
pub fn classify(path: impl AsRef<Path>, options: &ClassifyOptions, run: Run) -> Reply<Classification> {
    Call::answer(run, &Sources::default(), |call| {
        if !(options.tolerance > 0.0 && options.tolerance < 0.1) {
            return call.usage("`--tolerance` is a number above 0 and below 0.1");
        }
        let Some((_, text)) = read_text(path.as_ref(), None, run.files, &mut call.diagnostics) else {
            return Err(Refused);
        };
        let (real, dual) = parse(&text).or_else(|refusal| call.refuse(refusal))?;
        Ok(match split(&real, &dual, options.tolerance) {
            Ok(split) => Classification::Admissible(Box::new(MotionWithErrors::of(&split))),
            Err(why) => Classification::Inadmissible(NoMotion { admissible: false, reason: reason(why) }),
        })
    })
}

/// Real and i-part.
fn parse(text: &str) -> Result<(Matrix4<f64>, Matrix4<f64>), Diagnostic> {
    let written: Written = from_yaml(text).map_err(|failure| unreadable(&failure.to_string()))?;
    let rows = |rows: [[f64; 4]; 4]| Matrix4::from_fn(|i, j| rows[i][j]);
    let (real, dual) = match (written.matrix, written.real, written.dual) {
        (Some(entries), None, None) => {
            let part = |k: usize| Matrix4::from_fn(|i, j| entries[i][j].parts()[k]);
            (part(0), part(1))
        }
        (None, Some(real), Some(dual)) => (rows(real), rows(dual)),
        _ => return Err(unreadable("either `matrix`, or `real` and `dual`")),
    };
    let finite = real.iter().chain(dual.iter()).all(|x| x.is_finite());
    if finite { Ok((real, dual)) } else { Err(unreadable("an entry is not finite")) }
}

fn unreadable(reason: &str) -> Diagnostic {
    Diagnostic::new(codes::E0815, format!("no matrix over the dual numbers: {}", shown(reason))).help(
        "write `matrix:` with four rows of four entries, a number or `[real, i-part]`, or `real:` and `dual:` with \
         four rows of four numbers",
    )
}

fn reason(why: AdmissibilityFailure) -> String {
    match why {
        AdmissibilityFailure::LastRow(size) => format!("the last row is not 0 0 0 1 (by {})", significant(size, 3)),
        AdmissibilityFailure::NotOrthogonal(size) => {
            format!("the real 3x3 block A is no rotation: A^T A - 1 has an entry {}", significant(size, 3))
        }
        AdmissibilityFailure::Reflection => "the real 3x3 block is a reflection, determinant -1".to_owned(),
        AdmissibilityFailure::NotInClass(size, i, j) => {
            let what = if i == j { "a stretch" } else { "a shear" };
            let size = significant(size, 3);
            format!(
                "the i-part B is not in the error class of A: A^T B + B^T A has {size} at ({}, {}), {what}",
                i + 1,
                j + 1
            )
        }
    }
}
