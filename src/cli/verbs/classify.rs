//! `abbe classify`: the motion and the errors of a 4x4 matrix over the dual numbers.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use abbe::results::{Classification, MotionWithErrors, SixErrors};
use abbe::text::{angle, length, significant};
use abbe::{ClassifyOptions, classify};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A YAML file: `matrix` with entries `number` or `[real, i-part]`, or `real` and `dual`; mm and rad.
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
    session.show(&found, String::new, || text(&found))
}

fn text(found: &Classification) -> String {
    match found {
        Classification::Admissible(motion) => admissible(motion),
        Classification::Inadmissible(why) => format!("Not admissible: {}.\n", why.reason),
    }
}

fn admissible(motion: &MotionWithErrors) -> String {
    let [x, y, z] = motion.translation_mm.map(|x| significant(x + 0.0, 9));
    let mut text = format!("Admissible: a motion with six errors.\n  nominal translation  {x}, {y}, {z} mm\n");
    text.push_str(&format!("  nominal rotation     {}\n", turn(motion)));
    text.push_str(&format!("  errors on the left, E N  {}\n", cells(&motion.errors_before)));
    text.push_str(&format!("  errors on the right, N E {}\n", cells(&motion.errors_after)));
    text
}

fn cells(errors: &SixErrors) -> String {
    let print = |(index, (name, value)): (usize, (&str, f64))| {
        format!("{name} {}", if index < 3 { length(value) } else { angle(value) })
    };
    SIX.into_iter().zip(errors.values()).enumerate().map(print).collect::<Vec<_>>().join(", ")
}

/// Angle and axis.
fn turn(motion: &MotionWithErrors) -> String {
    let degrees = significant(motion.angle_deg, 9);
    match motion.axis {
        Some(axis) => format!("{degrees} deg about {}", axis.map(|x| significant(x, 7)).join(", ")),
        None if motion.angle_deg == 0.0 => "none".to_owned(),
        None => format!("{degrees} deg"),
    }
}
