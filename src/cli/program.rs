//! The command line as a whole: its verbs, and the call of each.

use super::global::{Global, Outcome};
use super::output::session::Session;
use super::verbs::{
    budget, check, classify, compare, compile, convert, diff, enumerate, equations, eval, explain, figures, identify,
    import, init, instrument, locate, man, map, measure, reach, record, report, show, targets, testpiece, verify,
    workbench,
};
use super::{confined, threads};
use abbe::text::fold_beside;
use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// A compiler from machine-tool configurations to volumetric compensation.
#[derive(Debug, Parser)]
#[command(name = "abbe", version = env!("ABBE_VERSION"), about, max_term_width = 100)]
pub(super) struct Cli {
    #[command(flatten)]
    pub(super) global: Global,
    #[command(subcommand)]
    pub(super) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// All diagnostics, and a summary of the machine.
    Check(check::Args),
    /// The chain, frames, lever arms, and the location errors it needs.
    Show(show::Args),
    /// Deviation and E_VE at poses.
    Eval(eval::Args),
    /// The closed forms: joint matrices, E_VE and deviations as polynomials in the errors.
    Equations(equations::Args),
    /// Motion and errors of a 4x4 matrix over the dual numbers.
    Classify(classify::Args),
    /// The same machine under other conventions, proved by an equal map.
    Convert(convert::Args),
    /// The error over a volume.
    Map(map::Args),
    /// Tips and directions of the tool within reach over a box.
    Reach(reach::Args),
    /// Machines side by side on the same tool poses.
    Compare(compare::Args),
    /// Tolerances to the volumetric error, and which of them to tighten first.
    Budget(budget::Args),
    /// All arrangements of the axes, ranked on the same work.
    Enumerate(enumerate::Args),
    /// Readings of a ball bar, an R-test or a laser along the diagonals.
    Instrument(instrument::Args),
    /// Measurements to error parameters, with rank, uncertainty and a fitted machine file.
    Identify(identify::Args),
    /// A program for LinuxCNC that touches balls in poses of the rotary axes.
    Measure(measure::Args),
    /// A single-axis measurement as an instrument exports it, to a table of error curves; the log of a touch probe, to
    /// touches of balls.
    Import(import::Args),
    /// Figures of ISO 230-3, 230-4 and 230-7 from readings of a test.
    Figures(figures::Args),
    /// Location errors from what a control's own calibration of the rotary axes found.
    Locate(locate::Args),
    /// The compensation files of a controller, with their certificate.
    Compile(compile::Args),
    /// Replay compensation files as the controller would, and certify the residual.
    Verify(verify::Args),
    /// One calibration as a folder: machine, raw data with hashes, certificates, decisions; records in a line.
    Record(record::Args),
    /// One self-contained HTML page for a design review.
    Report(report::Args),
    /// A page to change the machine file and see its effect at once.
    Workbench(workbench::Args),
    /// Difference between two sets of compensation files, in micrometres.
    Diff(diff::Args),
    /// A test piece of a standard as a job: tool poses, features and tolerances.
    Testpiece(testpiece::Args),
    /// The controllers, one a line; of one its mechanisms and limits.
    Targets(targets::Args),
    /// The long text of a code, an error name or a target.
    Explain(explain::Args),
    /// Write a machine file to begin with.
    Init(init::Args),
    /// The JSON Schema (draft-07) of the machine file, for editors.
    Schema,
    /// Completions for a shell.
    Completions {
        /// Name of the shell.
        shell: clap_complete::Shell,
    },
    /// Write the manual pages.
    Man(man::Args),
}

/// Runs the program on its arguments.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(message) => return usage(&with_options(with_verbs(message), &arguments)),
    };
    if cli.global.template_child {
        confined::limit();
        return confined::on_large_stack(move || exit_code(cli));
    }
    if confined::is_wanted(&arguments) {
        let done = confined::run(&arguments, Session::new(cli.global.clone()));
        if let Some(code) = done {
            return code;
        }
    }
    exit_code(cli)
}

fn exit_code(cli: Cli) -> ExitCode {
    threads::start(cli.global.jobs);
    let mut session = Session::new(cli.global);
    let outcome = dispatch(&mut session, cli.verb);
    session.finish(outcome)
}

/// Names verbs for a machine file where a verb is wanted.
fn with_verbs(mut message: clap::Error) -> clap::Error {
    let word = match message.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) => word.clone(),
        _ => return message,
    };
    if [".yaml", ".yml"].iter().any(|ending| word.ends_with(ending)) {
        // Names of files resemble verbs by chance.
        let _ = message.remove(ContextKind::SuggestedSubcommand);
        let tip = format!("a verb is before the file: `abbe check {word}`, `abbe workbench {word}`");
        let _ = message.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    message
}

/// Lists the options of the verb for one that it does not have and that none of its own resembles.
fn with_options(mut message: clap::Error, arguments: &[OsString]) -> clap::Error {
    let is_unlike_any =
        message.kind() == clap::error::ErrorKind::UnknownArgument && message.get(ContextKind::SuggestedArg).is_none();
    let program = Cli::command();
    let asked = || arguments.iter().skip(1).find_map(|word| program.find_subcommand(word));
    if let Some(verb) = is_unlike_any.then(asked).flatten() {
        let own = verb.get_arguments().filter(|argument| !argument.is_global_set());
        let names: Vec<String> = own.filter_map(|argument| Some(format!("--{}", argument.get_long()?))).collect();
        let tip = match names.is_empty() {
            true => format!("`{}` has no options of its own", verb.get_name()),
            false => format!("`{}` has {}", verb.get_name(), names.join(" ")),
        };
        let _ = message.insert(
            ContextKind::Suggested,
            ContextValue::StyledStrs(vec![fold_beside(&tip, 7).replace('\n', "\n       ").into()]),
        );
    }
    message
}

fn usage(message: &clap::Error) -> ExitCode {
    match message.print().and_then(|()| std::io::stdout().flush()) {
        // A closed pipe is no reason to change the exit code.
        Err(failure) if !message.use_stderr() && failure.kind() != ErrorKind::BrokenPipe => {
            let _ = writeln!(std::io::stderr(), "abbe: standard output did not take everything: {}", failure.kind());
            ExitCode::from(3)
        }
        _ => ExitCode::from(if message.use_stderr() { 2 } else { 0 }),
    }
}

fn dispatch(session: &mut Session, verb: Verb) -> Outcome {
    if session.is_sarif() && !matches!(verb, Verb::Check(_)) {
        return session.usage("`--format sarif` goes with `check` only");
    }
    if let Some(root) = session.missing_root() {
        return session.usage(&format!("--confined: there is no folder `{root}`"));
    }
    match verb {
        Verb::Eval(args) => eval::run(session, &args),
        Verb::Classify(args) => classify::run(session, &args),
        Verb::Convert(args) => convert::run(session, &args),
        Verb::Equations(args) => equations::run(session, &args),
        Verb::Show(args) => show::run(session, &args),
        Verb::Map(args) => map::run(session, &args),
        Verb::Reach(args) => reach::run(session, &args),
        Verb::Compare(args) => compare::run(session, &args),
        Verb::Budget(args) => budget::run(session, &args),
        Verb::Enumerate(args) => enumerate::run(session, &args),
        Verb::Instrument(args) => instrument::run(session, &args),
        Verb::Identify(args) => identify::run(session, &args),
        Verb::Figures(args) => figures::run(session, &args),
        Verb::Measure(args) => measure::run(session, &args),
        Verb::Import(args) => import::run(session, &args),
        Verb::Locate(args) => locate::run(session, &args),
        Verb::Init(args) => init::run(session, &args),
        Verb::Compile(args) => compile::run(session, &args),
        Verb::Verify(args) => verify::run(session, &args),
        Verb::Record(args) => record::run(session, &args),
        Verb::Report(args) => report::run(session, &args),
        Verb::Workbench(args) => workbench::run(session, &args),
        Verb::Diff(args) => diff::run(session, &args),
        Verb::Testpiece(args) => testpiece::run(session, &args),
        Verb::Targets(args) => targets::run(session, &args),
        Verb::Check(args) => check::run(session, &args),
        Verb::Explain(args) => explain::run(session, &args),
        Verb::Schema => schema(session),
        Verb::Completions { shell } => completions(session, shell),
        Verb::Man(args) => man::run(session, &args, <Cli as clap::CommandFactory>::command()),
    }
}

fn completions(session: &Session, shell: clap_complete::Shell) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut <Cli as clap::CommandFactory>::command(), "abbe", &mut script);
    session.print(&String::from_utf8_lossy(&script));
    Ok(())
}

fn schema(session: &Session) -> Outcome {
    session.print(&format!("{:#}", abbe::schema()));
    Ok(())
}
