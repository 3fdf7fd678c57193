//! `abbe man`, hidden: the manual pages, for packages.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use crate::cli::store::write::{make_folder, replace_whole};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The folder to write the pages to: `abbe.1` and one for each verb.
    folder: PathBuf,
}

pub(crate) fn run(session: &mut Session, args: &Args, program: clap::Command) -> Outcome {
    make_folder(&args.folder).or_else(|refusal| session.refuse(refusal))?;
    let mut program = program.disable_help_subcommand(true);
    program.build();
    for command in [&program].into_iter().chain(program.get_subcommands().filter(|verb| !verb.is_hide_set())) {
        let (name, text) = page(command);
        replace_whole(&args.folder.join(name), &text).or_else(|refusal| session.refuse(refusal))?;
    }
    Ok(())
}

/// Returns name and text of the page of the program or of one of its verbs.
fn page(command: &clap::Command) -> (String, Vec<u8>) {
    let page = clap_mangen::Man::new(command.clone());
    let page = page.source(concat!("abbe ", env!("ABBE_VERSION"))).manual("abbe");
    let mut text = Vec::new();
    // Memory takes every byte.
    let _ = page.render(&mut text);
    (page.get_filename(), text)
}
