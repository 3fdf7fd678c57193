//! `abbe init`: a machine file to begin with, named or by questions.

use crate::cli::output::session::Session;
use crate::cli::store::limited::standard_output;
use crate::cli::store::write::write_new;
use crate::cli::{Exit, Outcome};
use abbe::dialogue::{AnswerChoice, FILES, MachineDialogue, MachineQuestion};
use abbe::{CLASS_NAMES, NAMED_MACHINES, VARIANTS, machine_dialogue, machines_text, named_machine, targets};
use serde_json::json;
use std::collections::BTreeMap;
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
    let Some((file, text)) = answered() else {
        let _ = writeln!(std::io::stderr().lock(), "abbe: the input ended; nothing is written");
        return Err(Exit::Refused);
    };
    write(session, Path::new(&file), &text)
}

/// Asks all questions, and returns the name of the file and its text; none if the input ends.
fn answered() -> Option<(String, String)> {
    say("A machine file by questions. Enter takes what stands in [ ].\nNothing is written before the last answer.\n");
    let mut answers = BTreeMap::new();
    let text = loop {
        let MachineDialogue { questions, file } = machine_dialogue(&answers);
        let Some(question) = questions.into_iter().find(|of| !answers.contains_key(&of.key)) else { break file? };
        let MachineQuestion { key, asked, default, wanted, choices, .. } = question;
        let is_understood = |answer: &str| {
            let mut answers = answers.clone();
            answers.insert(key.clone(), answer.to_owned());
            machine_dialogue(&answers).questions.iter().any(|of| of.key == key && of.is_understood)
                && (key != FILES || answer.split_whitespace().all(|name| Path::new(name).is_file()))
        };
        let names = list_choices(&choices);
        let answer = question_line(&format!("{asked}{names}"), &default, &wanted, is_understood)?;
        answers.insert(key, answer);
    };
    let free = |answer: &str| !Path::new(answer).exists();
    let file = question_line("\nName of the file", "machine.yaml", "another name: this file is there already", free)?;
    Some((file, text))
}

/// Prints choices that need more than a word, and returns the others in brackets.
fn list_choices(choices: &[AnswerChoice]) -> String {
    for AnswerChoice { answer, title, picture } in choices.iter().filter(|choice| !choice.title.is_empty()) {
        let picture = if picture.is_empty() { String::new() } else { format!("\n{picture}") };
        say(&format!("\n  {answer}  {title}{picture}"));
    }
    match choices.first() {
        Some(first) if first.title.is_empty() => {
            format!(" ({})", choices.iter().map(|choice| choice.answer.as_str()).collect::<Vec<_>>().join(", "))
        }
        Some(_) => {
            say("\n\n");
            String::new()
        }
        None => String::new(),
    }
}

/// Asks until an answer is understood; none if the input ends.
fn question_line(asked: &str, default: &str, wanted: &str, reads: impl Fn(&str) -> bool) -> Option<String> {
    loop {
        let proposal = if default.is_empty() { String::new() } else { format!(" [{default}]") };
        say(&format!("{asked}{proposal}: "));
        let mut line = String::new();
        if std::io::stdin().lock().read_line(&mut line).unwrap_or(0) == 0 {
            say("\n");
            return None;
        }
        let answer = Some(line.trim()).filter(|answer| !answer.is_empty()).unwrap_or(default);
        if reads(answer) {
            return Some(answer.to_owned());
        }
        say(&format!("  Wanted: {wanted}.\n"));
    }
}

/// Prints as it is; a closed terminal ends the input, too.
fn say(text: &str) {
    let mut out = standard_output();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
