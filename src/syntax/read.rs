//! Bytes to text: refusals of the file itself.

use super::Disk;
use super::causes::{binary_format, foreign_format};
use super::files::{Files, ReadFailure};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, codes, nearest, shown};
use std::path::Path;
use std::sync::Arc;

/// Reads a file as UTF-8 text without its byte order mark and keeps it among the sources.
/// `named` is where another file names it.
pub fn read_text(
    path: &Path,
    named: Option<Place>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<(SourceId, Arc<str>)> {
    let bytes = read_bytes(path, named.clone(), Disk::MAX_BYTES, files, diagnostics)?;
    if let Some(foreign) = binary_format(&bytes) {
        let message = format!("`{}` is {}, not a text", shown(&path.display().to_string()), foreign.noun);
        diagnostics.push(
            Diagnostic::new(codes::E0104, message).at(named, "").help("name the YAML file: `abbe init` writes one"),
        );
        return None;
    }
    keep_bytes(path, bytes, named, diagnostics)
}

/// Reads a table as [`read_text`] does, and refuses files of other programs by name.
pub fn read_table_text(
    path: &Path,
    named: Option<Place>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<(SourceId, Arc<str>)> {
    let bytes = read_table_bytes(path, named.clone(), Disk::MAX_BYTES, files, diagnostics)?;
    keep_bytes(path, bytes, named, diagnostics)
}

/// Decodes bytes, and keeps the text among the sources.
fn keep_bytes(
    path: &Path,
    bytes: Vec<u8>,
    named: Option<Place>,
    diagnostics: &mut Diagnostics,
) -> Option<(SourceId, Arc<str>)> {
    let text = decode(path, bytes, named, diagnostics)?;
    Some(keep(path, &text, diagnostics))
}

/// Reads the bytes of a table; a file of another program is refused by name.
pub(super) fn read_table_bytes(
    path: &Path,
    named: Option<Place>,
    limit: u64,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<u8>> {
    let bytes = read_bytes(path, named.clone(), limit, files, diagnostics)?;
    let Some(foreign) = foreign_format(path, &bytes) else { return Some(bytes) };
    let message = format!("`{}` is {}, not a table", shown(&path.display().to_string()), foreign.noun);
    diagnostics.push(Diagnostic::new(codes::E0104, message).at(named, "").help(foreign.remedy));
    None
}

fn read_bytes(
    path: &Path,
    named: Option<Place>,
    limit: u64,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<u8>> {
    let refusal = match files.read_at_most(path, limit) {
        Ok(bytes) => return Some(bytes),
        Err(ReadFailure::NotFound) => missing(path, files),
        Err(failure) => unreadable(path, &failure),
    };
    diagnostics.push(refusal.at(named, ""));
    None
}

/// Returns the refusal of a file that is not there, with the name of one beside it that may be meant.
fn missing(path: &Path, files: &dyn Files) -> Diagnostic {
    let refusal = unreadable(path, &ReadFailure::NotFound);
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let beside = files.entries(folder);
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().to_lowercase());
    let is_yaml = |path: &Path| path.extension().is_some_and(|ending| ending == "yml" || ending == "yaml");
    let twin = beside.iter().map(|entry| Path::new(&entry.name));
    let twin = twin.filter(|name| is_yaml(name) && is_yaml(path)).find(|name| stem(name) == stem(path));
    let asked = path.file_name().unwrap_or_default().to_string_lossy();
    let near = || nearest(&asked, beside.iter().map(|entry| entry.name.as_str())).map(Path::new);
    match twin.or_else(near) {
        Some(near) => refusal.help(format!("there is `{}`", shown(&path.with_file_name(near).display().to_string()))),
        None if asked.contains('\\') => refusal.help("write `/` between folders"),
        None => refusal,
    }
}

/// Keeps a text among the sources, without its byte order mark.
pub(super) fn keep(path: &Path, text: &str, diagnostics: &mut Diagnostics) -> (SourceId, Arc<str>) {
    let text: Arc<str> = text.strip_prefix('\u{feff}').unwrap_or(text).into();
    (diagnostics.sources.add(shown(&path.display().to_string()), Arc::clone(&text)), text)
}

/// Returns the refusal of a file that cannot be read.
pub(crate) fn unreadable(path: &Path, failure: &ReadFailure) -> Diagnostic {
    let file = format!("`{}`", shown(&path.display().to_string()));
    match failure {
        ReadFailure::NotFound => Diagnostic::new(codes::E0101, format!("there is no file {file}"))
            .help("paths are relative to the file that names them"),
        ReadFailure::Denied => {
            Diagnostic::new(codes::E0101, format!("{file} may not be read")).help("change its permissions")
        }
        ReadFailure::NotAFile(word) => {
            Diagnostic::new(codes::E0102, format!("{file} is {word}, not a file")).help("name a regular file")
        }
        ReadFailure::TooLarge(size, limit) => {
            let mb = |bytes: &u64| bytes.div_ceil(1 << 20);
            let help = if *limit > Disk::MAX_BYTES {
                "split it: a run takes several files of readings"
            } else {
                "thin the table out: the limit is 100000 rows"
            };
            Diagnostic::new(codes::E0103, format!("{file} has {} MB; the limit is {} MB", mb(size), mb(limit)))
                .help(help)
        }
        ReadFailure::Outside(root) => {
            let root = shown(&root.display().to_string());
            Diagnostic::new(codes::E0819, format!("{file} is outside `{root}`, to which --confined limits this run"))
                .help("name a folder that holds every file of the run, or trust the files and leave --confined out")
        }
        ReadFailure::Other(words) => Diagnostic::new(codes::E0101, format!("{file} cannot be read: {}", shown(words)))
            .help("check the path and the medium"),
    }
}

fn decode(path: &Path, bytes: Vec<u8>, named: Option<Place>, diagnostics: &mut Diagnostics) -> Option<String> {
    let utf16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    match String::from_utf8(bytes) {
        Ok(text) => Some(text),
        Err(failure) => {
            let at = failure.utf8_error().valid_up_to();
            let line = failure.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
            let found = if utf16 { "is UTF-16".to_owned() } else { format!("is not UTF-8 (line {line})") };
            let message = format!("`{}` {found}", shown(&path.display().to_string()));
            let encoding = if utf16 { "UTF-16" } else { "ISO-8859-1" };
            let help = format!("save it as UTF-8, for example: iconv -f {encoding} -t UTF-8 old > new");
            diagnostics.push(Diagnostic::new(codes::E0104, message).at(named, "").help(help));
            None
        }
    }
}
