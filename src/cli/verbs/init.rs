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
    from: InitSource,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum InitSource {
    /// Three linear axes, C-frame: `w X' Y' b Z t`.
    ThreeAxis,
    /// Five axes, both rotary ones under the workpiece: `w C' A' Y' b X Z t`.
    Trunnion,
    /// Five axes, a swivelling head and a rotary table: `w C' Y' b X Z B t`.
    HeadTable,
    /// Five axes, a fork head: `w b X Y Z C A t`.
    HeadHead,
}

impl InitSource {
    fn kind(self) -> Starter {
        match self {
            Self::ThreeAxis => Starter::ThreeAxis,
            Self::Trunnion => Starter::Trunnion,
            Self::HeadTable => Starter::HeadTable,
            Self::HeadHead => Starter::HeadHead,
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let text = starter(args.from.kind());
    write_new(&args.file, text.as_bytes()).or_else(|refusal| session.refuse(refusal))?;
    let file = args.file.display();
    session.say(&format!(
        "wrote {file}; next: `abbe check {file}`, and for completion in an editor `abbe schema > abbe.schema.json` \
         beside it"
    ));
    Ok(())
}
