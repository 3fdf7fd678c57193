//! `abbe classify`: the rotation or motion, and its errors, of a matrix over the dual numbers of order n.

use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::{Exit, Format, Outcome};
use abbe::results::{Classification, ErrorClass, ErrorPart, Lemma, MotionWithErrors, SixErrors};
use abbe::text::{angle, length, significant};
use abbe::{ClassifyOptions, classify};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A YAML file: `matrix` with entries `number` or `[real, i-part, ...]`, or `real` and `dual`; mm and rad.
    matrix: PathBuf,
    /// Largest difference of entries from those of a motion (0 or more).
    #[arg(long, default_value = "1e-9")]
    tolerance: f64,
}

/// Letters of the six errors.
const SIX: [&str; 6] = ["EX", "EY", "EZ", "EA", "EB", "EC"];

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let found = session.take(classify(&args.matrix, &ClassifyOptions { tolerance: args.tolerance }, session.run()))?;
    if session.format() == Format::Csv {
        return session.usage("`classify` has no csv form: it prints text or json");
    }
    session.show(&found, String::new, || text(&found))?;
    if matches!(found, Classification::Inadmissible(_)) { Err(Exit::Refused) } else { Ok(()) }
}

fn text(found: &Classification) -> String {
    match found {
        Classification::Admissible(motion) if motion.translation_mm.is_some() => admissible(motion),
        Classification::Admissible(rotation) => {
            admissible(rotation) + &class(&rotation.error_class) + &lemmas(&rotation.lemmas)
        }
        Classification::Inadmissible(why) => {
            let rest = why.error_class.as_ref().map_or_else(String::new, class) + &lemmas(&why.lemmas);
            format!("Not admissible: {}.\n{rest}", why.reason)
        }
    }
}

fn admissible(motion: &MotionWithErrors) -> String {
    let sort = match (motion.translation_mm.is_some(), motion.errors_before.is_some()) {
        (true, true) => "a motion with six errors",
        (true, false) => "a motion with errors",
        (false, _) => "a rotation with errors",
    };
    let mut text = format!("Admissible: {sort}, in {}.\n", motion.group);
    if let Some(translation) = &motion.translation_mm {
        text.push_str(&format!("  nominal translation  {} mm\n", list(translation, 9)));
    }
    text.push_str(&format!("  nominal rotation     {}\n", turn(motion)));
    if let (Some(before), Some(after)) = (&motion.errors_before, &motion.errors_after) {
        text.push_str(&format!("  errors on the left, E N  {}\n", cells(before)));
        text.push_str(&format!("  errors on the right, N E {}\n", cells(after)));
    }
    let from = if motion.errors_before.is_some() { 2 } else { 1 };
    for errors in motion.degrees.iter().filter(|errors| errors.degree >= from) {
        for (side, part) in [("left, E N ", &errors.before), ("right, N E", &errors.after)] {
            text.push_str(&format!("  i^{} on the {side}  {}\n", errors.degree, part_text(part)));
        }
    }
    text
}

/// The skew matrix of an error by its entries below the diagonal, and its displacement.
fn part_text(part: &ErrorPart) -> String {
    let w = &part.rotation;
    let turns = match w.len() {
        2 => format!("{:.9e} rad", w[1][0]),
        3 => format!("{:.9e}, {:.9e}, {:.9e} rad about x, y, z", w[2][1], w[0][2], w[1][0]),
        n => {
            let below = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
            let entry = |(i, j): (usize, usize)| format!("({}, {}) {:.9e}", i + 1, j + 1, w[i][j]);
            format!("W: {} rad", below.map(entry).collect::<Vec<_>>().join(", "))
        }
    };
    let moved = |d: &Vec<f64>| format!("; {} mm", d.iter().map(|x| format!("{x:.9e}")).collect::<Vec<_>>().join(", "));
    turns + &part.displacement_mm.as_ref().map_or_else(String::new, moved)
}

fn list(values: &[f64], digits: usize) -> String {
    values.iter().map(|x| significant(*x, digits)).collect::<Vec<_>>().join(", ")
}

/// A basis of the error class: each matrix in a line.
fn class(class: &ErrorClass) -> String {
    let matrix = |(k, b): (usize, &Vec<Vec<f64>>)| {
        let rows = b.iter().map(|row| list(row, 6)).collect::<Vec<_>>().join("; ");
        format!("  B{} = ({rows})\n", k + 1)
    };
    let is = if class.is_lie_algebra { "a Lie algebra" } else { "no Lie algebra" };
    let dimension = class.dimension;
    let basis: String = class.basis.iter().enumerate().map(matrix).collect();
    format!("\nError class I^A: dimension {dimension}, {is} ({})\n{basis}", class.reason)
}

fn lemmas(list: &[Lemma]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut table = table(&["statement", "holds", "reason"]);
    for Lemma { statement, holds, reason } in list {
        let _ = table.add_row([statement.as_str(), if *holds { "yes" } else { "no" }, reason]);
    }
    format!("\n{table}\n")
}

fn cells(errors: &SixErrors) -> String {
    let print = |(index, (name, value)): (usize, (&str, f64))| {
        format!("{name} {}", if index < 3 { length(value) } else { angle(value) })
    };
    SIX.into_iter().zip(errors.values()).enumerate().map(print).collect::<Vec<_>>().join(", ")
}

/// Angle and axis; of more than three dimensions the matrix.
fn turn(motion: &MotionWithErrors) -> String {
    let Some(degrees) = motion.angle_deg else {
        return motion.rotation.iter().map(|row| list(row, 7)).collect::<Vec<_>>().join("; ");
    };
    let text = significant(degrees, 9);
    match motion.axis {
        Some(axis) => format!("{text} deg about {}", list(&axis, 7)),
        None if degrees == 0.0 => "none".to_owned(),
        None => format!("{text} deg"),
    }
}
