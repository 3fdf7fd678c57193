//! A new folder with files, all of them or none: it is filled under a temporary name beside its place, then renamed.
//! A folder that is there already stays as it is; one that holds these files is as good as written.

use super::files::read_at_most;
use super::limited::LimitedWriter;
use super::write::{folder_of, make_folder, unwritable_folder};
use abbe::{Diagnostic, codes};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Ending of the temporary name.
const TEMPORARY: &str = ".abbe-record";

/// Refuses a folder that is there already and not empty.
fn refuse_existing(folder: &Path) -> Result<(), Diagnostic> {
    let empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    match fs::symlink_metadata(folder) {
        Ok(metadata) if !metadata.is_dir() || !empty() => {
            let message = format!("`{}` is there already", folder.display());
            let help = "give another name, or remove it first: nothing is overwritten here";
            Err(Diagnostic::new(codes::E0811, message).help(help))
        }
        _ => Ok(()),
    }
}

/// Writes files into a new folder; their names have `/` between folders.
pub(crate) fn write_new_folder(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Diagnostic> {
    if holds(folder, files) {
        return Ok(());
    }
    refuse_existing(folder)?;
    let Some(name) = folder.file_name() else {
        return Err(unwritable_folder(folder, "the path names no new folder"));
    };
    let parent = folder_of(folder);
    make_folder(parent)?;
    let name = name.to_string_lossy();
    clear_left_over(parent, &name);
    let staged = StagedFolder::new(parent, &name).map_err(|failure| unwritable_folder(folder, &failure.to_string()))?;
    let written = staged.fill(files).and_then(|()| fs::rename(&staged.path, folder));
    written.map_err(|failure| match fs::symlink_metadata(folder) {
        Ok(_) if refuse_existing(folder).is_err() => unwritable_folder(folder, "another run has made it meanwhile"),
        _ => unwritable_folder(folder, &failure.to_string()),
    })?;
    // A file system that cannot sync folders does it on its own terms.
    let _ = fs::File::open(parent).and_then(|handle| handle.sync_all());
    Ok(())
}

/// True if a folder holds all of these files with these bytes.
fn holds(folder: &Path, files: &[(String, Vec<u8>)]) -> bool {
    let same = |(name, bytes): &(String, Vec<u8>)| {
        read_at_most(&folder.join(name), bytes.len() as u64).is_ok_and(|found| found == *bytes)
    };
    !files.is_empty() && files.iter().all(same)
}

/// A folder under its temporary name, removed when it is dropped before it was renamed.
struct StagedFolder {
    path: PathBuf,
    /// Held while the run is alive: by that another run tells what a killed one left.
    _lock: Option<fs::File>,
}

impl StagedFolder {
    fn new(parent: &Path, name: &str) -> std::io::Result<Self> {
        let path = parent.join(format!(".{name}.{}{TEMPORARY}", std::process::id()));
        fs::create_dir(&path)?;
        let lock = fs::File::open(&path).ok().filter(|handle| handle.try_lock().is_ok());
        Ok(Self { path, _lock: lock })
    }

    fn fill(&self, files: &[(String, Vec<u8>)]) -> std::io::Result<()> {
        let mut folders = vec![self.path.clone()];
        for (name, bytes) in files {
            let path = self.path.join(name);
            let inside = path.parent().unwrap_or(&self.path);
            if !folders.iter().any(|known| known == inside) {
                fs::create_dir_all(inside)?;
                folders.push(inside.to_owned());
            }
            let handle = fs::OpenOptions::new().write(true).create_new(true).open(&path)?;
            LimitedWriter::new(&handle, 0).write_all(bytes)?;
            handle.sync_all()?;
        }
        for folder in folders {
            let _ = fs::File::open(folder).and_then(|handle| handle.sync_all());
        }
        Ok(())
    }
}

impl Drop for StagedFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Clears temporary folders of this name that killed runs left.
fn clear_left_over(parent: &Path, name: &str) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let own = entry.file_name().to_string_lossy().into_owned();
        let run =
            own.strip_prefix('.').and_then(|rest| rest.strip_prefix(name)?.strip_prefix('.')?.strip_suffix(TEMPORARY));
        let folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if !folder || !run.is_some_and(|run| !run.is_empty() && run.bytes().all(|byte| byte.is_ascii_digit())) {
            continue;
        }
        if fs::File::open(entry.path()).is_ok_and(|handle| handle.try_lock().is_ok()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn temporary(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("abbe-tree-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        path
    }

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_folder_is_written_whole_and_never_over_another() {
        let top = temporary("whole");
        let files = [("a.txt".to_owned(), b"one".to_vec()), ("deep/er/b.txt".to_owned(), b"two".to_vec())];
        write_new_folder(&top.join("new"), &files).unwrap();
        assert_eq!(fs::read(top.join("new/deep/er/b.txt")).unwrap(), b"two");
        write_new_folder(&top.join("new"), &files).unwrap();
        let other = [files[0].clone(), ("deep/er/b.txt".to_owned(), b"2".to_vec())];
        assert_eq!(write_new_folder(&top.join("new"), &other).unwrap_err().code, "E0811");
        // An empty folder is as good as none.
        fs::create_dir(top.join("empty")).unwrap();
        write_new_folder(&top.join("empty"), &files).unwrap();
        assert_eq!(fs::read(top.join("empty/a.txt")).unwrap(), b"one");
        let twice = [files[0].clone(), files[0].clone()];
        assert_eq!(write_new_folder(&top.join("none"), &twice).unwrap_err().code, "E0810");
        assert_eq!(names(&top).len(), 2, "{:?}", names(&top));
        fs::remove_dir_all(&top).unwrap();
    }

    #[test]
    fn what_a_killed_run_left_is_cleared_and_nothing_else() {
        let top = temporary("left");
        for name in [".new.1.abbe-record", ".new.x.abbe-record", ".other.1.abbe-record", "new.1.abbe-record"] {
            fs::create_dir_all(top.join(name).join("data")).unwrap();
        }
        let held = fs::File::open(top.join(".other.1.abbe-record")).unwrap();
        write_new_folder(&top.join("new"), &[("a".to_owned(), Vec::new())]).unwrap();
        let mut left = names(&top);
        left.sort();
        assert_eq!(left, [".new.x.abbe-record", ".other.1.abbe-record", "new", "new.1.abbe-record"]);
        held.lock().unwrap();
        write_new_folder(&top.join("other"), &[("a".to_owned(), Vec::new())]).unwrap();
        assert!(top.join(".other.1.abbe-record").exists());
        fs::remove_dir_all(&top).unwrap();
    }
}
