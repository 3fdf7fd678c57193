//! Files are written whole or not at all: into a temporary file beside the target, then renamed.

use super::files::Recorded;
use super::limited::LimitedWriter;
use abbe::results::Picture;
use abbe::{Diagnostic, codes};
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes a file so that a reader sees either the old content or all of `bytes`; never over a file that was read in
/// this run.
pub(crate) fn write_whole(path: &Path, bytes: &[u8], read: &Recorded) -> Result<(), Diagnostic> {
    refuse_input(path, read)?;
    clear_left_over(path, read);
    replace_whole(path, bytes)
}

/// Like [`write_whole`], for a file of our own that may have been read before.
pub(crate) fn replace_whole(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    replace_if(path, bytes, || true).map(drop)
}

/// Like [`replace_whole`], if `still` is true once all is on the disk: a slow one gives others the time to write.
/// Returns true if the file was replaced.
pub(crate) fn replace_if(path: &Path, bytes: &[u8], still: impl FnOnce() -> bool) -> Result<bool, Diagnostic> {
    let staged = StagedFile::new(path)?;
    staged.writer()?.write_all(bytes).map_err(|failure| staged.failure(&failure))?;
    staged.commit_if(still)
}

/// A file in the making, beside the one it becomes; gone if it is not finished. Where the system has files without a
/// name it is one until then: a program that was killed leaves nothing.
pub(crate) struct StagedFile {
    path: PathBuf,
    target: PathBuf,
    temporary: PathBuf,
    file: File,
    /// True while the file has no name.
    unnamed: bool,
}

impl StagedFile {
    pub(crate) fn new(path: &Path) -> Result<Self, Diagnostic> {
        let target = replaceable(path)?;
        let temporary = temporary(&target).ok_or_else(|| unwritable(path, "the path names no file"))?;
        let (unnamed, opened) = match unnamed::open(folder_of(&target)) {
            Some(file) => (true, Ok(file)),
            None => (false, OpenOptions::new().write(true).create_new(true).open(&temporary)),
        };
        let file = opened.map_err(|failure| unwritable(path, &failure.to_string()))?;
        // Held while the run is alive: by that another run tells what a killed one left. Where there are no locks,
        // nothing is told, and nothing is cleared.
        let _ = file.try_lock();
        Ok(Self { path: path.to_owned(), target, temporary, file, unnamed })
    }

    pub(crate) fn writer(&self) -> Result<LimitedWriter<File>, Diagnostic> {
        let file = self.file.try_clone().map_err(|failure| self.failure(&failure))?;
        Ok(LimitedWriter::new(file, 0))
    }

    /// Returns the diagnostic of a file that cannot be written.
    pub(crate) fn failure(&self, failure: &io::Error) -> Diagnostic {
        unwritable(&self.path, &failure.to_string())
    }

    /// All of it is there: it takes its place.
    pub(crate) fn commit(self) -> Result<(), Diagnostic> {
        self.commit_if(|| true).map(drop)
    }

    fn commit_if(self, still: impl FnOnce() -> bool) -> Result<bool, Diagnostic> {
        let finished = || {
            if let Ok(metadata) = fs::metadata(&self.target) {
                self.file.set_permissions(metadata.permissions())?;
            }
            self.file.sync_all()?;
            if self.unnamed {
                unnamed::name(&self.file, &self.temporary)?;
            }
            if !still() {
                return Ok(false);
            }
            fs::rename(&self.temporary, &self.target).map(|()| true)
        };
        finished().map_err(|failure| self.failure(&failure))
    }
}

impl Drop for StagedFile {
    fn drop(&mut self) {
        // A failed attempt leaves a file that is ours alone; if it cannot be removed either, there is no more to
        // report. After a commit there is nothing of this name.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Clears temporary files for this path that runs left which were killed between naming and renaming them.
pub(crate) fn clear_left_over(path: &Path, read: &Recorded) {
    let Ok(target) = replaceable(path) else { return };
    let Some(name) = target.file_name().map(|name| name.to_string_lossy().into_owned()) else { return };
    let of_a_run = |entry: &fs::DirEntry| {
        let own = entry.file_name().to_string_lossy().into_owned();
        let run =
            own.strip_prefix('.').and_then(|rest| rest.strip_prefix(&name)?.strip_prefix('.')?.strip_suffix(".tmp"));
        let regular = entry.file_type().is_ok_and(|kind| kind.is_file());
        regular && run.is_some_and(|run| !run.is_empty() && run.bytes().all(|byte| byte.is_ascii_digit()))
    };
    for entry in fs::read_dir(folder_of(&target)).into_iter().flatten().flatten().filter(of_a_run) {
        let left = File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if left && !is_input(&entry.path(), read) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Files without a name.
#[cfg(target_os = "linux")]
mod unnamed {
    use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, open as open_at};
    use std::os::fd::AsRawFd;
    use std::path::{Path, PathBuf};
    use std::{fs::File, io};

    /// Path by which the system names the open file.
    fn own(file: &File) -> PathBuf {
        PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
    }

    /// `None` if the file system has none, or could not give it a name later.
    pub(crate) fn open(folder: &Path) -> Option<File> {
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        let file = File::from(open_at(folder, flags, Mode::from_raw_mode(0o666)).ok()?);
        own(&file).exists().then_some(file)
    }

    pub(crate) fn name(file: &File, path: &Path) -> io::Result<()> {
        Ok(linkat(CWD, own(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
    }
}

#[cfg(not(target_os = "linux"))]
mod unnamed {
    use std::{fs::File, io, path::Path};

    pub(crate) fn open(_: &Path) -> Option<File> {
        None
    }

    pub(crate) fn name(_: &File, _: &Path) -> io::Result<()> {
        Ok(())
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PictureKind {
    Svg,
    Png,
}

impl PictureKind {
    /// Kind of picture by the ending of a name.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

pub(crate) fn write_picture(
    path: &Path,
    picture: &Picture,
    kind: PictureKind,
    read: &Recorded,
) -> Result<(), Diagnostic> {
    match kind {
        PictureKind::Svg => write_whole(path, picture.svg().as_bytes(), read),
        PictureKind::Png => {
            let undrawable = |why: String| {
                Diagnostic::new(codes::E0632, format!("`{}` cannot be drawn: {why}", path.display()))
                    .help("write SVG instead")
            };
            write_whole(path, &picture.png().map_err(|failure| undrawable(failure.to_string()))?, read)
        }
    }
}

/// Refuses to write over a file that was read in this run: a machine file, a table, a measurement, a template.
pub(crate) fn refuse_input(path: &Path, read: &Recorded) -> Result<(), Diagnostic> {
    if !is_input(path, read) {
        return Ok(());
    }
    let message = format!("`{}` is an input of this run", path.display());
    Err(Diagnostic::new(codes::E0630, message).help("give the output another name; nothing was written"))
}

/// True if a path leads to a file that was read in this run.
pub(crate) fn is_input(path: &Path, read: &Recorded) -> bool {
    identity(path).is_some_and(|own| read.paths().iter().any(|other| identity(other).as_ref() == Some(&own)))
}

/// Refuses, before any work, outputs that cannot all be written: over an input, two to one file, or where there is
/// no folder.
pub(crate) fn refuse_outputs<'a>(
    paths: impl IntoIterator<Item = &'a PathBuf>,
    read: &Recorded,
) -> Result<(), Diagnostic> {
    let mut seen: Vec<&PathBuf> = Vec::new();
    for path in paths {
        refuse_input(path, read)?;
        clear_left_over(path, read);
        let _ = replaceable(path)?;
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(unwritable(path, &format!("there is no folder `{}`", folder.display())));
        }
        let own = identity(path);
        let same = |other: &&PathBuf| own.is_some() && identity(other) == own || entry(other) == entry(path);
        if seen.iter().any(same) {
            let message = format!("two outputs of this run are to be `{}`", path.display());
            return Err(Diagnostic::new(codes::E0630, message).help("give each a name of its own; nothing was written"));
        }
        seen.push(path);
    }
    Ok(())
}

pub(crate) fn make_folder(folder: &Path) -> Result<(), Diagnostic> {
    refuse_no_folder(folder)?;
    fs::create_dir_all(folder).map_err(|failure| unwritable_folder(folder, &failure.to_string()))
}

/// Refuses, before any work, a folder for outputs that is a file.
pub(crate) fn refuse_no_folder(folder: &Path) -> Result<(), Diagnostic> {
    let other = fs::metadata(folder).is_ok_and(|metadata| !metadata.is_dir());
    if other { Err(unwritable_folder(folder, "it is a file, not a folder")) } else { Ok(()) }
}

pub(crate) fn unwritable_folder(folder: &Path, why: &str) -> Diagnostic {
    Diagnostic::new(codes::E0810, format!("cannot write to `{}`: {why}", folder.display()))
        .help("name a folder that you may write to; nothing was written")
}

/// Returns device and inode, by which two paths are the same file.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).ok().map(|m| (m.dev(), m.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<PathBuf> {
    fs::canonicalize(path).ok()
}

/// Returns the folder and the name in it, by which two paths to nothing yet are the same file.
fn entry(path: &Path) -> (Option<impl PartialEq + use<>>, Option<&OsStr>) {
    (identity(folder_of(path)), path.file_name())
}

/// Like [`write_whole`], but a file that is there already is refused.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    if path.symlink_metadata().is_ok() {
        let message = format!("`{}` is there already", path.display());
        return Err(Diagnostic::new(codes::E0811, message)
            .help("give another name, or remove it first: nothing is overwritten here"));
    }
    replace_whole(path, bytes)
}

/// The regular file behind the path, or the path itself if there is nothing yet.
fn replaceable(path: &Path) -> Result<PathBuf, Diagnostic> {
    let Ok(metadata) = fs::metadata(path) else {
        let link = path.symlink_metadata().is_ok();
        return if link { Err(unwritable(path, "it is a link to nothing")) } else { Ok(path.to_owned()) };
    };
    if metadata.is_dir() {
        return Err(unwritable(path, "it is a directory"));
    }
    // Renaming over a device or FIFO would replace it.
    if !metadata.is_file() {
        return Err(unwritable(path, "it is not a regular file"));
    }
    if metadata.permissions().readonly() {
        return Err(unwritable(path, "it is read-only"));
    }
    // A link stays a link: its target is replaced.
    fs::canonicalize(path).map_err(|failure| unwritable(path, &failure.to_string()))
}

/// The folder of a path; that of the run for a name alone.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn temporary(target: &Path) -> Option<PathBuf> {
    let mut name = std::ffi::OsString::from(".");
    name.push(target.file_name()?);
    name.push(format!(".{}.tmp", std::process::id()));
    Some(target.with_file_name(name))
}

fn unwritable(path: &Path, why: &str) -> Diagnostic {
    let help = "name a file in a folder that exists and that you may write to; nothing was written";
    Diagnostic::new(codes::E0810, format!("cannot write `{}`: {why}", path.display())).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("abbe-write-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn entries(&self) -> usize {
            fs::read_dir(&self.0).unwrap().count()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let folder = Folder::new("whole");
        let path = folder.0.join("map.csv");
        replace_whole(&path, b"old and long").unwrap();
        replace_whole(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(folder.entries(), 1);
        assert_eq!(write_new(&path, b"other").unwrap_err().code, "E0811");
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    /// A file that others write while the bytes go to the disk is not lost.
    #[test]
    fn a_file_that_others_wrote_meanwhile_stays() {
        let folder = Folder::new("meanwhile");
        let path = folder.0.join("m.yaml");
        fs::write(&path, "before").unwrap();
        let slow = || {
            fs::write(&path, "theirs").unwrap();
            fs::read(&path).unwrap() == b"before"
        };
        assert!(!replace_if(&path, b"mine", slow).unwrap());
        assert_eq!((fs::read(&path).unwrap().as_slice(), folder.entries()), (&b"theirs"[..], 1));
        assert!(replace_if(&path, b"mine", || true).unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"mine");
    }

    /// After a kill: with nameless files there is nothing to see before the end.
    #[test]
    fn a_file_in_the_making_has_no_name_where_the_system_can() {
        let folder = Folder::new("unfinished");
        let path = folder.0.join("map.csv");
        let staged = StagedFile::new(&path).unwrap();
        staged.writer().unwrap().write_all(b"all of it").unwrap();
        assert_eq!(folder.entries(), usize::from(!staged.unnamed));
        staged.commit().unwrap();
        assert_eq!((fs::read(&path).unwrap().as_slice(), folder.entries()), (&b"all of it"[..], 1));
        drop(StagedFile::new(&path).unwrap());
        assert_eq!(folder.entries(), 1);
    }

    #[test]
    fn what_cannot_be_written_is_said_and_leaves_nothing() {
        let folder = Folder::new("refused");
        for path in [
            folder.0.clone(),
            folder.0.join("none/map.csv"),
            PathBuf::from("/dev/null"),
            PathBuf::from("/"),
            PathBuf::new(),
        ] {
            let diagnostic = replace_whole(&path, b"x").unwrap_err();
            assert_eq!(diagnostic.code, "E0810", "{path:?}");
        }
        assert_eq!(folder.entries(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_stays_one() {
        let folder = Folder::new("link");
        let path = folder.0.join("map.csv");
        std::os::unix::fs::symlink(folder.0.join("none.csv"), &path).unwrap();
        assert_eq!(replace_whole(&path, b"x").unwrap_err().code, "E0810");
        assert!(path.symlink_metadata().unwrap().is_symlink());
    }
}
