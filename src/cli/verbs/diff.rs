//! `abbe diff`: how far two sets of compensation files are apart, in micrometres.

use crate::cli::how::Options;
use crate::cli::output::certificate::micro;
use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome, load, set_effect};
use crate::compensation::{Correction, Jacobian};
use crate::evaluate::{Summary, random_poses};
use crate::machine::{Approach, Machine};
use crate::units::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file: its axes, and the volume over which the sets are compared.
    machine: PathBuf,
    /// A folder with compensation files.
    old: PathBuf,
    /// Another one.
    new: PathBuf,
    #[command(flatten)]
    options: Options,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let machine = load::machine(session, &args.machine, args.options.tool.as_deref())?;
    let (old, of_old) = set_effect::found(session, &machine, &args.old, &args.options)?;
    let (new, of_new) = set_effect::found(session, &machine, &args.new, &args.options)?;
    session.checked()?;
    let added = [of_old.added(&machine, &old), of_new.added(&machine, &new)];
    let mut axes: Vec<Vec<f64>> = vec![Vec::new(); machine.axes().len()];
    let mut moved = Vec::new();
    for pose in random_poses(&machine, args.options.poses as usize, args.options.seed) {
        let jacobian = Jacobian::at(&machine, &pose);
        for approach in [Approach::Forward, Approach::Reverse] {
            let [a, b] = [0, 1].map(|i: usize| added[i](&pose, approach));
            let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| b - a).collect();
            axes.iter_mut().zip(&difference).for_each(|(all, d)| all.push(*d));
            moved.push(jacobian.displacement(&Correction(difference)) * 1000.0);
        }
    }
    print(session, &machine, &axes, &Summary::of(&moved));
    Ok(())
}

/// Largest absolute value, and the root of the mean square.
fn figures(values: &[f64]) -> (f64, f64) {
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let square = values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64;
    (largest, libm::sqrt(square))
}

fn print(session: &Session, machine: &Machine, axes: &[Vec<f64>], moved: &Summary) {
    let rows = machine.axes().iter().zip(axes).map(|(axis, values)| {
        let (scale, unit) = micro(axis.kind);
        let (largest, rms) = figures(values);
        (axis.name.to_string(), largest * scale, rms * scale, unit)
    });
    let rows: Vec<_> = rows.collect();
    match session.format() {
        Format::Json => {
            let axes: serde_json::Map<_, _> = rows
                .iter()
                .map(|(name, largest, rms, unit)| {
                    (name.clone(), json!({ format!("max_{unit}"): largest, format!("rms_{unit}"): rms }))
                })
                .collect();
            session.print_json(json!({"axes": axes, "position_um": moved}));
        }
        Format::Csv => {
            let lines = rows.iter().map(|(name, largest, rms, unit)| format!("{name},{unit},{largest},{rms}"));
            let header = std::iter::once("axis,unit,max,rms".to_owned());
            session.print(&header.chain(lines).collect::<Vec<_>>().join("\n"));
        }
        Format::Text => {
            let mut text = String::from("Second set less the first, over both directions of approach:\n");
            for (name, largest, rms, unit) in &rows {
                text.push_str(&format!(
                    "  {name:4} max {} {unit}, rms {} {unit}\n",
                    significant(*largest, 4),
                    significant(*rms, 4)
                ));
            }
            text.push_str(&format!(
                "The functional point moves by at most {} um, 95 % {} um, rms {} um.\n",
                significant(moved.max, 4),
                significant(moved.p95, 4),
                significant(moved.rms, 4)
            ));
            session.print(&text);
        }
    }
}
