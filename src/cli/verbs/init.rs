//! `abbe init`: a machine file to begin with.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use crate::cli::store::write::write_new;
use abbe::options::Starter;
use abbe::starter;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The file to write; an existing file is not replaced.
    file: PathBuf,
    /// The kind of machine to begin with.
    #[arg(long, value_enum, default_value = "trunnion")]
    from: Starter,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let text = starter(args.from);
    write_new(&args.file, text.as_bytes()).or_else(|refusal| session.refuse(refusal))?;
    let file = args.file.display();
    session.say(&format!(
        "wrote {file}; next: `abbe check {file}`, and for completion in an editor `abbe schema > abbe.schema.json` \
         beside it"
    ));
    Ok(())
}
