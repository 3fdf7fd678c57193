//! `abbe init`: a machine file to begin with, named or by questions.

use crate::cli::output::session::Session;
use crate::cli::store::limited::standard_output;
use crate::cli::store::write::write_new;
use crate::cli::{Exit, Outcome};
use abbe::dialogue::{KnownErrors, MACHINE_CHOICES, MachineAnswers};
use abbe::text::number;
use abbe::{CLASS_NAMES, NAMED_MACHINES, VARIANTS, machines_text, named_machine, targets};
use serde_json::json;
use std::fmt::Write as _;
use std::io::{BufRead, IsTerminal, Write};
use std::path::Path;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The file to write; an existing file is not replaced. Without it, on a terminal, questions make the file.
    file: Option<std::path::PathBuf>,
    /// The machine to begin with [default: trunnion]; without a name all of them are listed, with classes and controls.
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = "")]
    from: Option<String>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let from = args.from.as_deref();
    match &args.file {
        _ if from == Some("") => list(session),
        Some(file) => {
            let text = named_machine(from.unwrap_or("trunnion")).or_else(|refusal| session.refuse(refusal))?;
            write(session, file, &text)
        }
        None if from.is_none() && std::io::stdin().is_terminal() && std::io::stdout().is_terminal() => ask(session),
        None => session.usage("`init` asks on a terminal only; name the file: `abbe init FILE`"),
    }
}

fn list(session: &Session) -> Outcome {
    let targets = targets();
    let names: Vec<&str> = targets.iter().map(|target| target.target.as_str()).collect();
    let variants: Vec<&str> = VARIANTS.iter().map(|[variant, _]| *variant).collect();
    let csv = || NAMED_MACHINES.iter().map(|of| format!("{},\"{}\"\n", of.name, of.kind)).collect();
    let all =
        json!({"machines": NAMED_MACHINES.to_vec(), "variants": variants, "classes": CLASS_NAMES, "targets": names});
    session.show(&all, csv, || machines_text(&names))
}

fn write(session: &mut Session, file: &Path, text: &str) -> Outcome {
    write_new(file, text.as_bytes()).or_else(|refusal| session.refuse(refusal))?;
    let file = file.display();
    session.say(&format!(
        "wrote {file}; next: `abbe check {file}`\n\
         For completion in an editor: `abbe schema > abbe.schema.json` beside it"
    ));
    Ok(())
}

/// Asks, and writes the file that the answers make.
fn ask(session: &mut Session) -> Outcome {
    let made = questions();
    let Some((file, answers)) = made else {
        let _ = writeln!(std::io::stderr().lock(), "abbe: the input ended; nothing is written");
        return Err(Exit::Refused);
    };
    write(session, Path::new(&file), &answers.machine_file())
}

/// Asks all questions; none if the input ends.
fn questions() -> Option<(String, MachineAnswers)> {
    say("A machine file by questions. Enter takes what stands in [ ].\nNothing is written before the last answer.\n");
    for (choice, number) in MACHINE_CHOICES.iter().zip(1..) {
        say(&format!("\n  {number}  {}: {}\n{}\n", choice.title, choice.chain, choice.picture));
    }
    let count = MACHINE_CHOICES.len();
    let kind = question("\nWhich kind", "4", &format!("a number from 1 to {count}"), |answer| one_of(answer, count))?;
    let choice = MACHINE_CHOICES[kind - 1];
    let mut travels = Vec::new();
    for (axis, usual) in choice.axes {
        let default = usual.map_or("continuous".to_owned(), |[from, to]| format!("{from} {to}"));
        let is_rotary = "ABC".contains(axis);
        let unit = if is_rotary { "deg, two ends or `continuous`" } else { "mm, two ends" };
        let wanted = "two numbers, the lower end first, such as `0 500`";
        let asked = format!("Travel of {axis}, {unit}");
        travels.push(question(&asked, &default, wanted, |answer| travel(answer, is_rotary))?);
    }
    let length = |answer: &str| number(answer).ok().filter(|length| (0.0..=1e4).contains(length));
    let tool_length_mm =
        question("Tool: from the nose of the spindle to the tip, mm", "120", "a length in mm, such as 120", length)?;
    say("\nWhat is known of its errors\n  1  nothing yet: bounds typical of a class of machines\n  2  a data sheet: \
         accuracy of the axes\n  3  measured tables, as CSV files\n  \
         4  nothing: invented values, to try the program\n");
    let errors = match question("Which", "1", "a number from 1 to 4", |answer| one_of(answer, 4))? {
        1 => KnownErrors::Class(class()?),
        2 => KnownErrors::DataSheet(data_sheet(choice.axes.iter().map(|(axis, _)| *axis))?, class()?),
        3 => KnownErrors::Measured(question("Files, with blanks between", "", "names of files that are there", files)?),
        _ => KnownErrors::Example,
    };
    let free = |answer: &str| (!Path::new(answer).exists()).then(|| answer.to_owned());
    let file = question("\nName of the file", "machine.yaml", "another name: this file is there already", free)?;
    Some((file, MachineAnswers { choice, travels, tool_length_mm, errors }))
}

fn class() -> Option<String> {
    let asked = format!("Class ({})", CLASS_NAMES.join(", "));
    let known = |answer: &str| CLASS_NAMES.contains(&answer).then(|| answer.to_owned());
    question(&asked, "production", "one of these classes", known)
}

/// Accuracy of each axis of the sheet that has one.
fn data_sheet<'a>(axes: impl Iterator<Item = &'a str>) -> Option<Vec<(String, String)>> {
    let mut figures = Vec::new();
    for axis in axes {
        let unit = if "ABC".contains(axis) { "arcsec" } else { "um" };
        let asked = format!("Accuracy A (ISO 230-2) of {axis}, {unit}; 0 if the sheet has none");
        let band = |answer: &str| number(answer).ok().filter(|value| (0.0..=1e5).contains(value));
        let value = question(&asked, "0", &format!("the whole band, in {unit}, such as 8"), band)?;
        if value > 0.0 {
            figures.push((axis.to_owned(), format!("{value} {unit}")));
        }
    }
    Some(figures)
}

fn files(answer: &str) -> Option<Vec<String>> {
    let names: Vec<String> = answer.split_whitespace().map(str::to_owned).collect();
    (!names.is_empty() && names.iter().all(|name| Path::new(name).is_file())).then_some(names)
}

fn one_of(answer: &str, count: usize) -> Option<usize> {
    answer.parse().ok().filter(|number| (1..=count).contains(number))
}

/// Ends of a travel, the lower one first, or none for an axis without end.
fn travel(answer: &str, may_be_endless: bool) -> Option<Option<[f64; 2]>> {
    if may_be_endless && answer == "continuous" {
        return Some(None);
    }
    let separates = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '[' | ']');
    let ends: Vec<f64> = answer.split(separates).filter_map(|word| number(word).ok()).collect();
    let is_travel = |ends: &[f64; 2]| ends[0] < ends[1] && ends.iter().all(|end| end.abs() <= 1e5);
    <[f64; 2]>::try_from(ends).ok().filter(is_travel).map(Some)
}

/// Asks until an answer is understood; none if the input ends.
fn question<T>(asked: &str, default: &str, wanted: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
    loop {
        let mut prompt = asked.to_owned();
        let _ = if default.is_empty() { write!(prompt, ": ") } else { write!(prompt, " [{default}]: ") };
        say(&prompt);
        let mut line = String::new();
        if std::io::stdin().lock().read_line(&mut line).unwrap_or(0) == 0 {
            say("\n");
            return None;
        }
        let answer = line.trim();
        match read(if answer.is_empty() { default } else { answer }) {
            Some(found) => return Some(found),
            None => say(&format!("  Wanted: {wanted}.\n")),
        }
    }
}

/// Prints as it is; a closed terminal ends the input, too.
fn say(text: &str) {
    let mut out = standard_output();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
