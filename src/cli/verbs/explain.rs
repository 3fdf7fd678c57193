//! `abbe explain`: the long text of a diagnostic's code, of an error's name, of a class, of a target.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use abbe::explain;
use serde_json::json;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A code such as E0203, an error such as EC0Y, a class such as production, or a target such as linuxcnc.
    what: String,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    match explain(&args.what) {
        Err(unknown) => return session.usage(&unknown.message),
        Ok(found) if session.format() == Format::Json => session.print_json(json!(found)),
        Ok(found) => session.print(&found.text),
    }
    Ok(())
}
