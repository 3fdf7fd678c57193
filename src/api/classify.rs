//! The rotation or motion, and its errors, of a matrix over the dual numbers of order n.

use crate::algebra::{AdmissibilityFailure, ErrorOfDegree, Split, error_class, split};
use crate::analysis::{Lemma, lemmas, lie_algebra};
use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::run::{Call, Refused, Reply, Run};
use crate::syntax::{MatrixFile, matrix_file, read_text};
use crate::units::significant;
use nalgebra::{DMatrix, DVector};
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
    /// A rotation or motion with errors.
    Admissible(Box<MotionWithErrors>),
    /// No such rotation or motion.
    Inadmissible(NoMotion),
}

/// A nominal rotation or motion N with small errors, as E N and as N E.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MotionWithErrors {
    admissible: bool,
    /// `SO(3, D_2)` of rotations, `SE(3, D)` of motions.
    pub group: String,
    /// Rotation of N, row by row.
    pub rotation: Vec<Vec<f64>>,
    /// Translation of N, mm; none of a rotation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation_mm: Option<Vec<f64>>,
    /// Errors of degree 1 on the left of N: mm and rad; of motions of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors_before: Option<SixErrors>,
    /// Errors of degree 1 on the right of N: mm and rad; of motions of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors_after: Option<SixErrors>,
    /// The errors of every degree: E = exp(W), of motions with a displacement.
    pub degrees: Vec<ErrorsOfDegree>,
    /// The error class I^A of the rotation.
    pub error_class: ErrorClass,
    /// Statements of the papers at this matrix.
    pub lemmas: Vec<Lemma>,
    units: Units,
    /// Angle of the rotation, deg; of the plane and of space.
    #[serde(skip)]
    pub angle_deg: Option<f64>,
    /// Unit vector of the axis of the rotation; none where it is not unique to rounding (0 and 180 deg).
    #[serde(skip)]
    pub axis: Option<[f64; 3]>,
}

/// The errors of one degree.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ErrorsOfDegree {
    /// Power of i.
    pub degree: usize,
    /// Errors on the left of N.
    pub before: ErrorPart,
    /// Errors on the right of N.
    pub after: ErrorPart,
}

/// A coefficient of an error matrix.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ErrorPart {
    /// Skew matrix, rad.
    pub rotation: Vec<Vec<f64>>,
    /// Displacement, mm; none of a rotation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement_mm: Option<Vec<f64>>,
}

/// The error class I^A of an orthogonal matrix A: all B with A^T B skew.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ErrorClass {
    /// Dimension over the reals.
    pub dimension: usize,
    /// A basis, each matrix row by row.
    pub basis: Vec<Vec<Vec<f64>>>,
    /// True if it is closed under the commutator.
    pub is_lie_algebra: bool,
    /// The reason.
    pub reason: String,
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
    /// `None` unless the error is one of space.
    fn of(error: &ErrorOfDegree) -> Option<Self> {
        let (w, d) = (&error.rotation, &error.displacement);
        (d.len() == 3).then(|| {
            // Adding zero turns -0 into 0.
            let six = [d[0], d[1], d[2], w[(2, 1)], w[(0, 2)], w[(1, 0)]];
            let [ex, ey, ez, ea, eb, ec] = six.map(|value| value + 0.0);
            Self { ex, ey, ez, ea, eb, ec }
        })
    }

    /// Returns them in the order EX, EY, EZ, EA, EB, EC.
    pub fn values(&self) -> [f64; 6] {
        [self.ex, self.ey, self.ez, self.ea, self.eb, self.ec]
    }
}

/// A matrix that is no rotation or motion with small errors.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct NoMotion {
    admissible: bool,
    /// The reason.
    pub reason: String,
    /// The error class of its real part, if that is orthogonal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_class: Option<ErrorClass>,
    /// Statements of the papers at this matrix, if its real part is orthogonal.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lemmas: Vec<Lemma>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
struct Units {
    length: &'static str,
    angle: &'static str,
}

/// Reads a matrix over the dual numbers of order n from a YAML file and classifies it.
///
/// The file has `matrix` with rows of entries, each `number` or a list of coefficients, or `real` and `dual`, or
/// `coefficients`; mm and rad. Four rows are a motion, other numbers a rotation, unless `kind` says otherwise. Fails
/// for a file that is none; a matrix that is no motion is a result.
pub fn classify(path: impl AsRef<Path>, options: &ClassifyOptions, run: Run) -> Reply<Classification> {
    Call::answer(run, &Sources::default(), |call| {
        if !(options.tolerance > 0.0 && options.tolerance < 0.1) {
            return call.usage("`--tolerance` is a number above 0 and below 0.1");
        }
        let Some((_, text)) = read_text(path.as_ref(), None, run.files, &mut call.diagnostics) else {
            return Err(Refused);
        };
        let file = matrix_file(&text).or_else(|reason| call.refuse(unreadable(&reason.to_string())))?;
        Ok(classified(&file, options.tolerance))
    })
}

/// The matrix of a file.
struct Subject {
    matrix: Vec<DMatrix<f64>>,
    /// Its rotation block.
    block: Vec<DMatrix<f64>>,
    tolerance: f64,
}

fn classified(file: &MatrixFile, tolerance: f64) -> Classification {
    let of = |rows: &Vec<Vec<f64>>| DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
    let matrix: Vec<DMatrix<f64>> = file.coefficients.iter().map(of).collect();
    let size = matrix.first().map_or(0, DMatrix::nrows);
    let affine = file.is_motion.unwrap_or(size == 4);
    let n = size - usize::from(affine && size > 0);
    let block = matrix.iter().map(|m| m.view((0, 0), (n, n)).into_owned()).collect();
    let subject = Subject { matrix, block, tolerance };
    let (lemmas, error_class) = subject.real_part();
    match (split(&subject.matrix, affine, tolerance), error_class) {
        (Ok(found), Some(error_class)) => Classification::Admissible(Box::new(MotionWithErrors {
            lemmas,
            ..MotionWithErrors::of(&found, affine, error_class)
        })),
        (found, error_class) => {
            let reason = found.err().map_or_else(String::new, |why| subject.reason(why));
            Classification::Inadmissible(NoMotion { admissible: false, reason, error_class, lemmas })
        }
    }
}

impl Subject {
    /// Returns what is true of the real part, if it is orthogonal.
    fn real_part(&self) -> (Vec<Lemma>, Option<ErrorClass>) {
        let [a, higher @ ..] = self.block.as_slice() else { return (Vec::new(), None) };
        let defect = (a.transpose() * a - DMatrix::identity(a.nrows(), a.nrows())).amax();
        if defect > self.tolerance { (Vec::new(), None) } else { (lemmas(a, higher), Some(ErrorClass::of(a))) }
    }

    fn reason(&self, why: AdmissibilityFailure) -> String {
        let n = self.block.first().map_or(0, DMatrix::nrows);
        match why {
            AdmissibilityFailure::LastRow(size) => {
                format!("the last row is not {}1 (by {})", "0 ".repeat(n), significant(size, 3))
            }
            AdmissibilityFailure::NotOrthogonal(size) => {
                format!("the real {n}x{n} block A is no rotation: A^T A - 1 has an entry {}", significant(size, 3))
            }
            AdmissibilityFailure::Reflection => format!("the real {n}x{n} block is a reflection, determinant -1"),
            AdmissibilityFailure::Degree { degree, size, at: (i, j) } => {
                let what = if i == j { "a stretch" } else { "a shear" };
                let at = format!("{} at ({}, {}), {what}", significant(size, 3), i + 1, j + 1);
                match degree {
                    1 => format!("the i-part B is not in the error class of A: A^T B + B^T A has {at}"),
                    _ if self.is_linearised() => {
                        format!("C^T C has {at}, of i^{degree}: a linearised matrix is a rotation to degree 1 only")
                    }
                    _ => format!("C^T C has {at}, of i^{degree}"),
                }
            }
        }
    }

    /// True if all parts of degree 2 and above are 0.
    fn is_linearised(&self) -> bool {
        self.block.iter().skip(2).all(|part| part.amax() == 0.0)
    }
}

impl MotionWithErrors {
    fn of(split: &Split, affine: bool, error_class: ErrorClass) -> Self {
        let n = split.rotation.nrows();
        let part = |error: &ErrorOfDegree| ErrorPart {
            rotation: rows(&error.rotation),
            displacement_mm: affine.then(|| column(&error.displacement)),
        };
        let pairs = split.before.iter().zip(&split.after).enumerate();
        let degrees: Vec<ErrorsOfDegree> =
            pairs.map(|(k, (b, a))| ErrorsOfDegree { degree: k + 1, before: part(b), after: part(a) }).collect();
        let of_space = affine && n == 3;
        let six = |errors: &[ErrorOfDegree]| errors.first().filter(|_| of_space).and_then(SixErrors::of);
        let ring = match degrees.len() {
            0 => "R".to_owned(),
            1 => "D".to_owned(),
            degree => format!("D_{degree}"),
        };
        let turn = Turn::of(&split.rotation);
        Self {
            admissible: true,
            group: format!("{}({n}, {ring})", if affine { "SE" } else { "SO" }),
            rotation: rows(&split.rotation),
            translation_mm: affine.then(|| column(&split.translation)),
            errors_before: six(&split.before),
            errors_after: six(&split.after),
            degrees,
            error_class,
            lemmas: Vec::new(),
            units: Units { length: "mm", angle: "rad" },
            angle_deg: turn.as_ref().map(|turn| turn.angle_deg),
            axis: turn.and_then(|turn| turn.axis),
        }
    }
}

/// The angle of a rotation of the plane or of space, and its axis where that is unique.
struct Turn {
    angle_deg: f64,
    axis: Option<[f64; 3]>,
}

impl Turn {
    fn of(a: &DMatrix<f64>) -> Option<Self> {
        match a.nrows() {
            2 => Some(Self { angle_deg: libm::atan2(a[(1, 0)], a[(0, 0)]).to_degrees() + 0.0, axis: None }),
            3 => {
                let cosine = (0.5 * (a.trace() - 1.0)).clamp(-1.0, 1.0);
                let differences = [a[(2, 1)] - a[(1, 2)], a[(0, 2)] - a[(2, 0)], a[(1, 0)] - a[(0, 1)]];
                let skew = nalgebra::Vector3::from(differences) * 0.5;
                let angle = libm::atan2(skew.norm(), cosine);
                let unique = angle >= 1e-12 && skew.norm() >= 1e-9;
                let angle_deg = if angle < 1e-12 { 0.0 } else { angle.to_degrees() };
                Some(Self { angle_deg, axis: unique.then(|| skew.normalize().map(|x| x + 0.0).into()) })
            }
            _ => None,
        }
    }
}

impl ErrorClass {
    fn of(a: &DMatrix<f64>) -> Self {
        let basis = error_class(a);
        let Lemma { holds, reason, .. } = lie_algebra(a);
        Self { dimension: basis.len(), basis: basis.iter().map(rows).collect(), is_lie_algebra: holds, reason }
    }
}

/// Returns a matrix row by row: adding zero turns -0 into 0.
fn rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)] + 0.0).collect()).collect()
}

fn column(v: &DVector<f64>) -> Vec<f64> {
    v.iter().map(|x| x + 0.0).collect()
}

fn unreadable(reason: &str) -> Diagnostic {
    Diagnostic::new(codes::E0815, format!("no matrix over the dual numbers: {}", shown(reason))).help(
        "write `matrix:` with rows of entries, each a number or a list of coefficients such as `[real, i-part]`; or \
         `real:` and `dual:`; or `coefficients:` with a matrix for each power of i",
    )
}
