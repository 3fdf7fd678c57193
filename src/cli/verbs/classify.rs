//! `abbe classify`: which motion and which errors a 4x4 matrix over the dual numbers is.

use crate::algebra::{AdmissibilityFailure, Split, split};
use crate::cli::output::session::Session;
use crate::cli::{Exit, Format, Outcome};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::syntax::Disk;
use crate::syntax::read_text;
use crate::units::{angle, length, significant};
use nalgebra::Matrix4;
use serde::Deserialize;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A YAML file: `matrix` with entries `number` or `[real, i-part]`, or `real` and `dual`; mm and rad.
    matrix: PathBuf,
    /// How far entries may be from those of a motion.
    #[arg(long, default_value = "1e-9")]
    tolerance: f64,
}

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    matrix: Option<[[Entry; 4]; 4]>,
    real: Option<[[f64; 4]; 4]>,
    dual: Option<[[f64; 4]; 4]>,
}

/// A dual number.
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

/// Letters of the six errors.
const SIX: [&str; 6] = ["EX", "EY", "EZ", "EA", "EB", "EC"];

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if !(args.tolerance > 0.0 && args.tolerance < 0.1) {
        return session.usage("`--tolerance` is a number above 0 and below 0.1");
    }
    let (real, dual) = read(session, args)?;
    let found = split(&real, &dual, args.tolerance);
    match (session.format(), &found) {
        (Format::Csv, _) => return session.usage("`classify` has no csv form: it prints text or json"),
        (Format::Json, Ok(split)) => session.print_json(contract(split)),
        (Format::Json, Err(why)) => session.print_json(json!({"admissible": false, "reason": reason(*why)})),
        (Format::Text, Ok(split)) => session.print(&text(split)),
        (Format::Text, Err(why)) => session.print(&format!("Not admissible: {}.\n", reason(*why))),
    }
    Ok(())
}

fn read(session: &mut Session, args: &Args) -> Result<(Matrix4<f64>, Matrix4<f64>), Exit> {
    let Some((_, text)) = read_text(&args.matrix, None, &Disk, &mut session.diagnostics) else {
        return Err(Exit::Refused);
    };
    parse(&text).or_else(|reason| {
        session
            .refuse(Diagnostic::new(codes::E0815, format!("no matrix over the dual numbers: {}", shown(&reason))).help(
            "write `matrix:` with four rows of four entries, a number or `[real, i-part]`, or `real:` and `dual:` with \
             four rows of four numbers",
        ))
    })
}

/// Real and i-part.
fn parse(text: &str) -> Result<(Matrix4<f64>, Matrix4<f64>), String> {
    let written: Written = serde_yaml::from_str(text).map_err(|failure| failure.to_string())?;
    let rows = |rows: [[f64; 4]; 4]| Matrix4::from_fn(|i, j| rows[i][j]);
    let (real, dual) = match (written.matrix, written.real, written.dual) {
        (Some(entries), None, None) => {
            let part = |k: usize| Matrix4::from_fn(|i, j| entries[i][j].parts()[k]);
            (part(0), part(1))
        }
        (None, Some(real), Some(dual)) => (rows(real), rows(dual)),
        _ => return Err("either `matrix`, or `real` and `dual`".to_owned()),
    };
    let finite = real.iter().chain(dual.iter()).all(|x| x.is_finite());
    if finite { Ok((real, dual)) } else { Err("an entry is not finite".to_owned()) }
}

/// Why not, in a clause.
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

fn contract(split: &Split) -> serde_json::Value {
    let six = |six: &[f64; 6]| {
        SIX.iter().zip(six).map(|(n, v)| ((*n).to_owned(), json!(v + 0.0))).collect::<serde_json::Map<_, _>>()
    };
    let rotation: Vec<[f64; 3]> = (0..3).map(|i| std::array::from_fn(|j| split.rotation[(i, j)] + 0.0)).collect();
    json!({
        "admissible": true, "rotation": rotation, "translation_mm": split.translation.as_slice(),
        "errors_before": six(&split.before), "errors_after": six(&split.after),
        "units": {"length": "mm", "angle": "rad"},
    })
}

fn text(split: &Split) -> String {
    let [x, y, z] = [0, 1, 2].map(|i| significant(split.translation[i] + 0.0, 9));
    let mut text = format!("Admissible: a motion with six errors.\n  nominal translation  {x}, {y}, {z} mm\n");
    text.push_str(&format!("  nominal rotation     {}\n", turn(split)));
    for (title, six) in [("errors on the left, E N ", &split.before), ("errors on the right, N E", &split.after)] {
        let print = |(index, name): (usize, &&str)| {
            let value = six[index] + 0.0;
            format!("{name} {}", if index < 3 { length(value) } else { angle(value) })
        };
        let cells: Vec<String> = SIX.iter().enumerate().map(print).collect();
        text.push_str(&format!("  {title} {}\n", cells.join(", ")));
    }
    text
}

/// Angle and axis.
fn turn(split: &Split) -> String {
    let cosine = (0.5 * (split.rotation.trace() - 1.0)).clamp(-1.0, 1.0);
    let skew = crate::algebra::skew_vector(&split.rotation);
    let angle = libm::atan2(skew.norm(), cosine);
    if angle < 1e-12 {
        return "none".to_owned();
    }
    let degrees = significant(angle.to_degrees(), 9);
    if skew.norm() < 1e-9 {
        return format!("{degrees} deg");
    }
    let axis = skew.normalize();
    format!("{degrees} deg about {}", [0, 1, 2].map(|i| significant(axis[i] + 0.0, 7)).join(", "))
}
