//! `abbe init`: a machine file to begin with.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use crate::cli::store::write::write_new;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The file to write; one that is there is left alone.
    file: PathBuf,
    /// The kind of machine to begin with.
    #[arg(long, value_enum, default_value = "trunnion")]
    from: From,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum From {
    /// Three linear axes, C-frame: `w X' Y' b Z t`.
    ThreeAxis,
    /// Five axes, both rotary ones under the workpiece: `w C' A' Y' b X Z t`.
    Trunnion,
    /// Five axes, a swivelling head and a rotary table: `w C' Y' b X Z B t`.
    HeadTable,
    /// Five axes, a fork head: `w b X Y Z C A t`.
    HeadHead,
}

impl From {
    fn text(self) -> &'static str {
        match self {
            Self::ThreeAxis => include_str!("three-axis.yaml"),
            Self::Trunnion => include_str!("trunnion.yaml"),
            Self::HeadTable => include_str!("head-table.yaml"),
            Self::HeadHead => include_str!("head-head.yaml"),
        }
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    write_new(&args.file, args.from.text().as_bytes()).or_else(|diagnostic| session.refuse(diagnostic))?;
    let file = args.file.display();
    session.say(&format!("wrote {file}; next: `abbe check {file}`, and for completion in an editor `abbe schema > abbe.schema.json` beside it"));
    Ok(())
}
