//! The program itself, run on files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own, removed at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("abbe-it-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// A file in it with this text.
    pub fn with(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.file(name), text).unwrap();
        self.file(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs `abbe` in configs/ on this number of threads; text is as wide as it is, so that sentences are found in it.
pub fn abbe_on(threads: usize, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command
        .args(arguments)
        .arg("--wide")
        .current_dir(crate::configs::folder())
        .env("RAYON_NUM_THREADS", threads.to_string());
    command.output().unwrap()
}

/// Standard output of a run that must succeed and print nothing else.
pub fn abbe(arguments: &[&str]) -> String {
    let output = abbe_on(2, arguments);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && complaint.is_empty(), "{arguments:?}: {complaint}");
    String::from_utf8(output.stdout).unwrap()
}

/// Exit code and standard error of a run.
pub fn refused(arguments: &[&str]) -> (i32, String) {
    let output = abbe_on(2, arguments);
    (output.status.code().unwrap(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Standard output as JSON.
pub fn json(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&abbe(arguments)).unwrap()
}

/// A path as an argument.
pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// True if the program is there. Reports a missing one, so that nobody takes an omitted test for a passed one.
pub fn available(program: &str, what: &str) -> bool {
    let there =
        Command::new(program).arg("--version").output().or_else(|_| Command::new(program).arg("-V").output()).is_ok();
    if !there {
        eprintln!("LEFT OUT: {what}: `{program}` is not installed");
    }
    there
}

/// Checks that the text is well-formed XML. A small reader of its own: tags nest, attributes are quoted, there is one
/// root, and the only entities are the five of XML.
pub fn well_formed(xml: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    let mut roots = 0;
    let mut rest = xml;
    while let Some(start) = rest.find('<') {
        characters(&rest[..start], open.is_empty())?;
        let end = rest[start..].find('>').ok_or("a tag does not end")? + start;
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name) {
                return Err(format!("</{name}> closes nothing"));
            }
            continue;
        }
        roots += usize::from(open.is_empty());
        let (inner, empty) = tag.strip_suffix('/').map_or((tag, false), |inner| (inner, true));
        let (name, attributes) = inner.split_once(' ').unwrap_or((inner, ""));
        attribute_list(attributes)?;
        if !empty {
            open.push(name);
        }
    }
    characters(rest, true)?;
    if roots == 1 && open.is_empty() { Ok(()) } else { Err(format!("{roots} roots, {open:?} open")) }
}

fn characters(text: &str, outside: bool) -> Result<(), String> {
    if outside && !text.trim().is_empty() {
        return Err(format!("text outside the root: {text:?}"));
    }
    for part in text.split('&').skip(1) {
        let entity = part.split(';').next().unwrap_or("");
        if !["amp", "lt", "gt", "quot", "#39"].contains(&entity) {
            return Err(format!("the entity &{entity};"));
        }
    }
    match text.chars().find(|c| c.is_control() && *c != '\n') {
        Some(c) => Err(format!("the character {c:?}")),
        None => Ok(()),
    }
}

fn attribute_list(text: &str) -> Result<(), String> {
    let mut rest = text.trim();
    let mut seen = Vec::new();
    while !rest.is_empty() {
        let (name, value) = rest.split_once("=\"").ok_or_else(|| format!("attributes {rest:?}"))?;
        let (value, after) = value.split_once('"').ok_or_else(|| format!("attributes {rest:?}"))?;
        characters(value, false)?;
        if value.contains('<') || name.contains(char::is_whitespace) || seen.contains(&name) {
            return Err(format!("attribute {name:?}"));
        }
        seen.push(name);
        rest = after.trim_start();
    }
    Ok(())
}

#[test]
fn the_reader_of_xml_tells_good_from_bad() {
    assert_eq!(well_formed("<a b=\"c\"><d/>&amp;</a>\n"), Ok(()));
    for bad in ["<a>", "<a></b>", "<a/><b/>", "<a b=c/>", "<a b=\"1\" b=\"2\"/>", "<a>&x;</a>", "x<a/>", "<a>\u{1}</a>"]
    {
        assert!(well_formed(bad).is_err(), "{bad}");
    }
}
