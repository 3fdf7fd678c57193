//! Pictures into a folder.

use super::session::Session;
use crate::cli::Outcome;
use crate::cli::store::write;
use abbe::results::NamedSvg;
use std::path::Path;

pub(crate) fn write(session: &mut Session, pictures: &[NamedSvg], folder: &Path) -> Outcome {
    write::make_folder(folder).or_else(|refusal| session.refuse(refusal))?;
    for NamedSvg { name, svg } in pictures {
        let path = folder.join(name);
        let written = write::write_whole(&path, svg.as_bytes(), &session.files);
        written.or_else(|refusal| session.refuse(refusal))?;
    }
    Ok(())
}
