//! `abbe diff`: what two machines, or two sets of compensation files, differ in.

use crate::cli::Outcome;
use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::output::view::{path_text, table};
use crate::cli::store::file_set;
use abbe::options::CompensationOptions;
use abbe::results::{MachineDifference, PropertyDifference, SetDifference};
use abbe::text::{cell, significant};
use abbe::{DiffMachinesOptions, DiffOptions};
use std::path::{Path, PathBuf};

/// Two machine files, or a machine file and two folders of compensation files.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Two machine files; or a machine file, the folder of a set and the folder of another.
    #[arg(num_args = 2..=3, required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    match args.paths.as_slice() {
        [first, second] if !first.is_dir() && !second.is_dir() => machines(session, args, [first, second]),
        [machine, old, new] if !machine.is_dir() && !old.is_file() && !new.is_file() => {
            sets(session, args, machine, [old, new])
        }
        _ => session.usage(
            "files are machines and folders are sets: `abbe diff A.yaml B.yaml`, or `abbe diff MACHINE.yaml OLD NEW` \
             with two folders",
        ),
    }
}

fn machines(session: &mut Session, args: &Args, paths: [&Path; 2]) -> Outcome {
    if args.set.how.options() != CompensationOptions::default() {
        return session.usage("options of the compensation go with two sets, not with two machines");
    }
    let tool = args.set.tool.name();
    let files = [session.load_one_of(paths[0], tool)?, session.load_one_of(paths[1], tool)?];
    let options = DiffMachinesOptions {
        poses: args.set.poses.poses,
        tool_poses: args.set.tool_poses.tool_poses.clone(),
        job: args.set.job.job.clone(),
        path: args.set.job.path,
        reference: args.set.reference.reference.clone(),
        seed: args.set.seed.seed,
        ..DiffMachinesOptions::default()
    };
    let difference = session.take(abbe::diff_machines(&files, &options, session.run()))?;
    session.show(&difference, || machines_csv(&difference), || machines_text(&difference))
}

fn sets(session: &mut Session, args: &Args, machine: &Path, [old, new]: [&Path; 2]) -> Outcome {
    let set = &args.set;
    if set.tool_poses.tool_poses.is_some() || set.job.job.is_some() || set.reference.reference.is_some() {
        return session.usage("a job and its reference go with two machines, not with two sets");
    }
    let file = session.load(machine, args.set.tool.name())?;
    for folder in [old, new] {
        file_set::check(session, folder)?;
    }
    let (compensation, poses, seed) = (args.set.how.options(), args.set.poses.poses, args.set.seed.seed);
    let options = DiffOptions { compensation, poses, seed };
    let difference = session.take(abbe::diff(&file, old, new, &options, session.run()))?;
    session.show(&difference, || csv(&difference), || text(&difference))
}

fn machines_csv(of: &MachineDifference) -> String {
    let mut csv = "kind,name,first,second,largest [um or urad],minus first [um]\n".to_owned();
    for d in &of.differences {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let (first, second) = (cell(&d.first), cell(&d.second));
        let (largest, effect) = (number(d.largest), number(d.minus_first_um));
        csv.push_str(&format!("{},{},{first},{second},{largest},{effect}\n", d.kind, d.name));
    }
    csv
}

fn machines_text(of: &MachineDifference) -> String {
    let mut text = String::new();
    for (i, (machine, file)) in of.machines.iter().zip(&of.files).enumerate() {
        text.push_str(&format!("  {}  {machine} ({file})\n", i + 1));
    }
    if of.differences.is_empty() {
        return text + "The machines do not differ.\n";
    }
    let mut rows = table(&["differs", "1", "2", "95 %, um"]);
    for d in &of.differences {
        let effect = d.minus_first_um.map_or_else(|| "-".to_owned(), sign_text);
        let _ = rows.add_row([property_name(d), d.first.clone(), d.second.clone(), effect]);
    }
    let what =
        if of.from.is_some() { "95 % value of machines drawn between the bounds" } else { "95 % position deviation" };
    let [first, second] = of.p95_um.map(|um| significant(um, 4));
    let chain = if of.differences[0].kind == "chain" { ", the others on the chain of machine 2" } else { "" };
    for (i, path) in (1..).zip(&of.paths) {
        text += &format!("Machine {i}:\n{}", path_text(path));
    }
    text + &format!(
        "{rows}\n95 %, um: change of the {what} of machine 1 with this difference alone{chain}.\n\
         All together: {first} um -> {second} um ({}), over {} of {} tool poses that both reach.\n{}",
        sign_text(of.minus_first_um),
        of.poses,
        of.asked,
        of.over.text()
    )
}

fn property_name(difference: &PropertyDifference) -> String {
    match difference.kind {
        "error" => difference.name.clone(),
        kind if difference.name.is_empty() => kind.to_owned(),
        kind => format!("{kind} of {}", difference.name),
    }
}

fn sign_text(um: f64) -> String {
    let sign = if um > 0.0 { "+" } else { "" };
    format!("{sign}{}", significant(um + 0.0, 4))
}

fn csv(difference: &SetDifference) -> String {
    let lines = difference.axes.iter().map(|a| format!("{},{},{},{}", a.name, a.unit, a.max, a.rms));
    std::iter::once("axis,unit,max,rms".to_owned()).chain(lines).collect::<Vec<_>>().join("\n")
}

fn text(difference: &SetDifference) -> String {
    let mut text = String::from("Second set less the first, over both directions of approach:\n");
    for a in &difference.axes {
        let [max, rms] = [a.max, a.rms].map(|x| significant(x, 4));
        text.push_str(&format!("  {:4} max {max} {unit}, rms {rms} {unit}\n", a.name, unit = a.unit));
    }
    let moved = &difference.position_um;
    let [max, p95, rms] = [moved.max, moved.p95, moved.rms].map(|x| significant(x, 4));
    text + &format!("The functional point moves by at most {max} um, 95 % {p95} um, rms {rms} um.\n")
}
