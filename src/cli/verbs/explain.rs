//! `abbe explain`: the long text of a diagnostic's code, of an error's name, of a class, of a target.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::explain;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A code such as E0203, an error such as EC0Y, a class such as production, a target such as linuxcnc, or a
    /// word such as gauge.
    what: String,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    match explain(&args.what) {
        Err(unknown) => {
            let help = unknown.help.map_or_else(String::new, |help| format!(".\n{help}"));
            session.usage(&(unknown.message + &help))
        }
        Ok(found) => session.show(&found, || found.text.clone(), || reflowed(&found.text)),
    }
}

/// Joins lines that were broken where the source is full, so that they fold anew.
fn reflowed(text: &str) -> String {
    let begins = |line: &str| ["-", "|", " ", "`", "Wrong", "Right"].iter().any(|mark| line.starts_with(mark));
    // Documents have a sentence a line.
    let is_full = |line: &str| line.chars().count() > 80 && !line.starts_with('|') && !line.ends_with('.');
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        match lines.last_mut() {
            Some(last) if is_full(last) && !line.is_empty() && !begins(line) => {
                *last = format!("{last} {line}");
            }
            _ => lines.push(line.to_owned()),
        }
    }
    lines.join("\n")
}
