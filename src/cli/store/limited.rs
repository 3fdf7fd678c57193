//! Writing under a limit on the size of files (`ulimit -f`). The system ends a program that goes beyond by a signal
//! (SIGXFSZ), without a word; here the write fails like one on a full disk.

use std::io::{self, Seek, SeekFrom, Write};

/// A writer that fails at the limit on the size of files.
pub(crate) struct LimitedWriter<W> {
    writer: W,
    /// Position of the next byte.
    position: u64,
    /// The limit; `None` without one.
    limit: Option<u64>,
}

impl<W: Write> LimitedWriter<W> {
    /// Writes from a position of the file on.
    pub(crate) fn new(writer: W, position: u64) -> Self {
        Self { writer, position, limit: limit() }
    }
}

impl<W: Write> Write for LimitedWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = self.limit.map_or(u64::MAX, |limit| limit.saturating_sub(self.position));
        let fits = bytes.len().min(usize::try_from(room).unwrap_or(usize::MAX));
        if fits == 0 && !bytes.is_empty() {
            let words = "the file would exceed the limit on the size of files";
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, words));
        }
        let written = self.writer.write(&bytes[..fits])?;
        self.position = self.position.saturating_add(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl<W: Seek> Seek for LimitedWriter<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.position = self.writer.seek(to)?;
        Ok(self.position)
    }
}

/// Returns the limit on the size of files, in bytes.
#[cfg(unix)]
fn limit() -> Option<u64> {
    use rustix::process::{Resource, getrlimit};
    getrlimit(Resource::Fsize).current
}

#[cfg(not(unix))]
fn limit() -> Option<u64> {
    None
}

/// Standard output; with the limit if it is a regular file.
pub(crate) fn standard_output() -> LimitedWriter<io::StdoutLock<'static>> {
    let out = io::stdout().lock();
    match position(&out) {
        Some(position) => LimitedWriter::new(out, position),
        None => LimitedWriter { writer: out, position: 0, limit: None },
    }
}

/// Returns where the next byte of a regular file goes; `None` for terminals, pipes and devices.
#[cfg(unix)]
fn position(out: &io::StdoutLock<'static>) -> Option<u64> {
    use rustix::fs::{FileType, OFlags, SeekFrom, fcntl_getfl, fstat, seek};
    let stat = fstat(out).ok()?;
    if FileType::from_raw_mode(stat.st_mode) != FileType::RegularFile {
        return None;
    }
    let appends = fcntl_getfl(out).is_ok_and(|flags| flags.contains(OFlags::APPEND));
    if appends { u64::try_from(stat.st_size).ok() } else { seek(out, SeekFrom::Current(0)).ok() }
}

#[cfg(not(unix))]
fn position(_: &io::StdoutLock<'static>) -> Option<u64> {
    None
}
