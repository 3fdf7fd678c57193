//! `abbe record`: one calibration as a folder, its check, and records in a line.

use crate::cli::Outcome;
use crate::cli::arguments::{PictureFile, help, svg};
use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::store::tree::write_new_folder;
use abbe::results::{
    AlarmState, Conformity, ErrorTrend, LimitDecision, LimitSides, PromisedResidual, Record, RecordTrend, TrendStep,
    UnheldReversal,
};
use abbe::text::{NOT_VERIFIED, counted, significant};
use abbe::{RecordOptions, check_record, record_trend};
use std::path::{Path, PathBuf};

/// A description of a calibration, or records that are there.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The description of the calibration.
    #[arg(required_unless_present_any = ["check", "trend"], conflicts_with_all = ["check", "trend"])]
    description: Option<PathBuf>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "The folder of the new record",
        required_unless_present_any = ["check", "trend"], conflicts_with_all = ["check", "trend"])]
    out: Option<PathBuf>,
    /// Compare every file of a record with its hash.
    #[arg(long, value_name = "DIR", conflicts_with = "trend")]
    check: Option<PathBuf>,
    /// Put records of one machine in a line: every error over the dates, alarms, and what changed.
    #[arg(long, value_name = "DIR", num_args = 1..)]
    trend: Vec<PathBuf>,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG, requires = "trend",
        long_help = "Draw the trend, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
    /// Sign the record with this private key: ed25519, PKCS #8 in PEM.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["check", "trend"])]
    sign: Option<PathBuf>,
    /// The record has to be signed by the key of this public key: ed25519, PEM.
    #[arg(long, value_name = "FILE", requires = "check")]
    key: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
}

impl Args {
    fn options(&self) -> RecordOptions {
        RecordOptions {
            tool: self.set.tool.name().map(str::to_owned),
            compensation: self.set.how.options(),
            poses: self.set.poses.poses,
            seed: self.set.seed.seed,
            sign: self.sign.clone(),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    match (&args.check, &args.description, &args.out) {
        (Some(folder), ..) => check(session, folder, args.key.as_deref()),
        (None, Some(description), Some(out)) => write(session, args, description, out),
        _ => trend(session, args),
    }
}

fn write(session: &mut Session, args: &Args, description: &Path, out: &Path) -> Outcome {
    let record = session.take(abbe::record(description, &args.options(), session.run()))?;
    write_new_folder(out, &record.files).or_else(|refusal| session.refuse(refusal))?;
    session.show(&record, || decisions_csv(record.decisions()), || record_text(&record, out))
}

fn record_text(record: &Record, out: &Path) -> String {
    let data = &record.data;
    let mut text = format!("record {} of {}, serial number {}\n", data.id, data.machine, data.plate.serial);
    if !data.decisions.is_empty() {
        let mut list = table(&["limit of", "of", "value", "U (k = 2)", "limit", "guard", "unit", "decision"]);
        for decision in &data.decisions {
            let _ = list.add_row(cells(decision));
        }
        text += &format!("{list}\ndecisions by ISO 14253-1 at 95 %, {NOT_VERIFIED}\n");
    }
    for set in data.sets.iter().filter(|set| set.installed) {
        text += &set.promised.as_ref().map(|of| promise_text(of, &set.target)).unwrap_or_default();
    }
    // The list of hashes, and what is signed of it, are not in the list, and `--check` does not count them.
    let listed = record.files.iter().filter(|(name, _)| !name.starts_with("SHA256SUMS")).count();
    let sums = record.files.iter().find(|(name, _)| name == "SHA256SUMS").map(|(_, bytes)| abbe::sets::sha256(bytes));
    text += &format!(
        "{} and their hashes in `{}`: print record.html, hand over certificate.xml (DCC 3.2.1)\n{}\nSHA256SUMS {}\n",
        counted(listed, "file"),
        out.display(),
        data.signature.as_ref().map_or_else(|| "not signed".to_owned(), |of| format!("signed by {}", of.public_key)),
        sums.unwrap_or_default()
    );
    text
}

/// The headline of an installed set.
fn promise_text(of: &PromisedResidual, target: &str) -> String {
    let n = |um: f64| significant(um, 4);
    let reversal = |of: &UnheldReversal| format!("{} {} um, {}", of.error, n(of.um), of.file);
    let reversals: Vec<String> = of.reversals.iter().map(reversal).collect();
    let beside = match reversals.is_empty() {
        true => String::new(),
        false => format!("\n  and the reversal that the model does not hold: {}", reversals.join("; ")),
    };
    let type_b = match of.type_b.is_empty() {
        true => "no type B is stated".to_owned(),
        false => format!("with type B: {}", of.type_b.join(", ")),
    };
    let what = match (of.within_um, of.interval_um) {
        (Some(within), Some([low, high])) => format!(
            "95 % of the poses within {} um\n  {} to {} um by the uncertainty of the errors ({type_b})",
            n(within),
            n(low),
            n(high)
        ),
        _ => "how close is not known: the machine file states no uncertainty".to_owned(),
    };
    format!("installed for {target}: {what}{beside}\n")
}

fn words(decision: Conformity) -> &'static str {
    match decision {
        Conformity::Conform => "conforms",
        Conformity::NotConform => "does not conform",
        Conformity::Undecided => "not proven",
    }
}

fn cells(of: &LimitDecision) -> Vec<String> {
    let n = |x: f64| significant(x, 4);
    let maybe = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), n);
    let sign = if of.sides == LimitSides::Both { "±" } else { "" };
    vec![
        of.name.clone(),
        of.of.clone(),
        n(of.value),
        maybe(of.expanded_uncertainty),
        format!("{sign}{}", n(of.limit)),
        maybe(of.guard),
        of.unit.clone(),
        words(of.decision).to_owned(),
    ]
}

/// A cell of a table of commas.
fn cell(text: &str) -> String {
    text.replace(',', ";")
}

fn decisions_csv(decisions: &[LimitDecision]) -> String {
    let mut csv = "name,of,value,expanded uncertainty,limit,guard,unit,decision\n".to_owned();
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
    for of in decisions {
        let (u, guard) = (number(of.expanded_uncertainty), number(of.guard));
        let (name, unit) = (cell(&of.name), cell(&of.unit));
        let decision = words(of.decision);
        csv.push_str(&format!("{name},{},{},{u},{},{guard},{unit},{decision}\n", of.of, of.value, of.limit));
    }
    csv
}

fn check(session: &mut Session, folder: &Path, key: Option<&Path>) -> Outcome {
    let found = session.take(check_record(folder, key, session.run()))?;
    let text = || {
        let replaced = match found.replaced_sets {
            0 => String::new(),
            count => format!(", {} archived", counted(count, "replaced set")),
        };
        let signed = match &found.signature {
            None => "not signed: whoever writes the folder anew is not noticed".to_owned(),
            Some(of) if found.of_given_key => format!("signed by the given key {}", of.public_key),
            Some(of) => format!("signed by {}; whose key this is shows --key", of.public_key),
        };
        format!("{} as recorded{replaced}\n{signed}\nSHA256SUMS {}\n", counted(found.files, "file"), found.sha256)
    };
    session.show(&found, || format!("files,SHA256SUMS\n{},{}\n", found.files, found.sha256), text)
}

fn trend(session: &mut Session, args: &Args) -> Outcome {
    PictureFile::refuse(session, args.svg.iter())?;
    let trend = session.take(record_trend(&args.trend, &args.options(), session.run()))?;
    if let Some(file) = &args.svg {
        file.write(&trend.picture(), session)?;
    }
    session.show(&trend, || trend_csv(&trend), || trend_text(&trend))
}

fn trend_csv(trend: &RecordTrend) -> String {
    let mut csv = "error,unit,record,day,state,value,expanded uncertainty,alarm limit\n".to_owned();
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
    for of in &trend.errors {
        for point in &of.points {
            let (id, day) = (cell(point.id.as_str()), point.day.as_str());
            let (u, alarm) = (number(point.expanded_uncertainty), number(of.alarm_limit));
            let (error, unit) = (&of.error, &of.unit);
            csv.push_str(&format!("{error},{unit},{id},{day},{},{},{u},{alarm}\n", point.state, point.value));
        }
    }
    csv
}

/// A row of the table of a trend: the values record by record, as found and, if it was adjusted, as left.
fn trend_row(of: &ErrorTrend, trend: &RecordTrend) -> Vec<String> {
    let n = |x: f64| significant(x, 4);
    let values = trend.records.iter().map(|record| {
        let points = of.points.iter().filter(|point| point.id == record.id);
        let values: Vec<String> = points.map(|point| n(point.value)).collect();
        if values.is_empty() { "-".to_owned() } else { values.join(" > ") }
    });
    let change = of.change.map_or_else(|| "-".to_owned(), n);
    let alarm = match (of.alarm, of.alarm_limit) {
        (AlarmState::Alarm, Some(limit)) => format!("ALARM: ±{}", n(limit)),
        (_, Some(limit)) => format!("±{}", n(limit)),
        _ => "-".to_owned(),
    };
    [of.error.clone(), of.unit.clone()].into_iter().chain(values).chain([change, alarm]).collect()
}

fn trend_text(trend: &RecordTrend) -> String {
    let days: Vec<String> =
        trend.records.iter().map(|record| format!("{} {}", record.dates.begin.as_str(), record.id)).collect();
    let mut header: Vec<&str> = vec!["error", "unit"];
    header.extend(days.iter().map(String::as_str));
    header.extend(["change", "alarm limit"]);
    let mut list = table(&header);
    for of in &trend.errors {
        let _ = list.add_row(trend_row(of, trend));
    }
    let steps: String = trend.steps.iter().map(step_text).collect();
    let head = format!("{}, serial number {}: {}", trend.machine, trend.serial, counted(trend.records.len(), "record"));
    format!("{head}, as found > as left\n{list}\n{steps}")
}

fn step_text(step: &TrendStep) -> String {
    let of = &step.difference;
    let names: Vec<&str> =
        of.differences.iter().map(|d| if d.name.is_empty() { d.kind } else { d.name.as_str() }).collect();
    let what = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    let [before, after] = of.p95_um.map(|um| significant(um, 4));
    format!("{} to {}: {before} um to {after} um (95 % of the poses); changed: {what}\n", step.from, step.to)
}
