//! Tables that put files in force under the letters of axes, and lists of settings that name one.

use super::activation::{Activation, ActiveFile, base};
use super::named::{self, Cell, cells};
use super::{Fault, ReadContext, patterns};
use crate::controller::manifest::{AssignedAxis, FileSpec, Index};

/// Reads columns; none if the text has none under these words.
pub(super) fn columns(reading: &ReadContext, spec: &FileSpec, text: &str) -> Result<Option<Activation>, Fault> {
    let Some(Index::Columns { header, active, frame }) = &spec.index else { return Ok(None) };
    let lines = match frame {
        Some(frame) if !named::begins(frame, text) => return Ok(None),
        Some(frame) => named::lines_in_frame(frame, text)?,
        None => text.lines().enumerate().collect(),
    };
    under_letters(&Columns { letters: &reading.letters, header, active: active.as_deref() }, &lines)
}

/// The form of columns, and the axes that they can be for.
struct Columns<'a> {
    letters: &'a [AssignedAxis],
    header: &'a str,
    active: Option<&'a str>,
}

/// A line with a header before the letters of axes, then lines with a file under each letter.
fn under_letters(form: &Columns, lines: &[(usize, &str)]) -> Result<Option<Activation>, Fault> {
    let head: Vec<&str> = form.header.split_whitespace().collect();
    let is_header = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.starts_with(&head)
    };
    let Some(at) = lines.iter().position(|(_, line)| is_header(line)) else { return Ok(None) };
    if at > 0 && form.active.is_some() {
        return Err(Fault::new(lines[0].0, format!("the first line is none of `{}`", form.header)));
    }
    let names = cells(lines[at].1);
    let mut rows: Vec<Vec<ActiveFile>> = Vec::new();
    for (line, text) in &lines[at + 1..] {
        let found = cells(text);
        let Some(under) = row(form.active, &names, &found, head.len()) else {
            return Err(Fault::new(*line, format!("{} cells under {} names", found.len(), names.len())));
        };
        if form.active.is_some() && found.first().is_none_or(|(_, number)| number.parse::<usize>().is_err()) {
            return Err(Fault::new(*line, "a row begins with its number"));
        }
        let active = match under[head.len() - 1] {
            Some(mark) if form.active.is_some_and(|active| active == mark) => true,
            Some("-") | None => form.active.is_none(),
            Some(mark) if form.active.is_some() => {
                return Err(Fault::new(*line, format!("`{mark}` is no mark of a row in force")));
            }
            Some(_) => true,
        };
        let file = |(column, file): (usize, &str)| {
            let letter = names[column].1;
            let axis = form.letters.iter().find(|known| known.letter == letter).map(|known| known.axis);
            let axis = axis.ok_or_else(|| Fault::new(*line, format!("the machine has no axis `{letter}`")))?;
            Ok(ActiveFile { file: base(file).to_owned(), axis: Some(axis), line: *line })
        };
        let files = under.iter().enumerate().skip(head.len()).filter_map(|(column, file)| Some((column, (*file)?)));
        let assigned = files.filter(|(_, file)| *file != "-").map(file).collect::<Result<Vec<_>, Fault>>()?;
        if let Some(second) = assigned.iter().enumerate().find(|(i, a)| assigned[..*i].iter().any(|b| a.axis == b.axis))
        {
            return Err(Fault::new(lines[at].0, format!("the axis of `{}` has two columns", second.1.file)));
        }
        if active {
            rows.push(assigned);
        }
        if form.active.is_some() && rows.len() > 1 {
            return Err(Fault::new(*line, "a second row is in force: the controller has one"));
        }
    }
    Ok(Some(Activation::of(rows.concat())))
}

/// The cells of a row under their names. A mark that is blank leaves a cell out, and so do other blank cells where the
/// cells stand under their names.
fn row<'t>(mark: Option<&str>, names: &[Cell], found: &[Cell<'t>], before: usize) -> Option<Vec<Option<&'t str>>> {
    let unmarked = |mark| found.len() + 1 == names.len() && found.iter().all(|(_, cell)| *cell != mark);
    match (named::under(names, found), mark) {
        (None, Some(mark)) if unmarked(mark) => {
            let mut all: Vec<Option<&str>> = found.iter().map(|(_, cell)| Some(*cell)).collect();
            all.insert(before - 1, None);
            Some(all)
        }
        (under, _) => under,
    }
}

/// Lines of settings: those that the template writes, the one that names a file, and what changes the corrections.
pub(super) fn settings(reading: &ReadContext, spec: &FileSpec, text: &str) -> Result<Option<Activation>, Fault> {
    let Some(Index::Settings { comment, file, room, turned, stopped, defaults, free, .. }) = &spec.index else {
        return Ok(None);
    };
    let bare = |line: &str| plain(line.split(&**comment).next().unwrap_or_default());
    let said: Vec<(usize, String)> = text.lines().map(bare).enumerate().filter(|(_, line)| !line.is_empty()).collect();
    let field = |pattern: &str, line: &str| patterns::fields(pattern, line).map(|f| f.into_iter().map(|f| f.1));
    if !said.iter().any(|(_, line)| patterns::fits(file, line)) {
        return Ok(None);
    }
    let written = reading.target.text_of(reading.machine, &spec.path).unwrap_or_default();
    let special = |line: &str| {
        let mut patterns = free.iter().chain([file]).chain(room).chain(turned).chain(stopped);
        patterns.any(|pattern| patterns::fits(pattern, line))
    };
    let mut wanted: Vec<String> = written.lines().map(bare).filter(|l| !l.is_empty() && !special(l)).collect();
    let mut all = Activation::of(Vec::new());
    for (number, line) in &said {
        let fits = |pattern: &Option<String>| pattern.as_ref().and_then(|p| field(p, line)?.next());
        if let Some(name) = field(file, line).and_then(|mut fields| fields.next()) {
            all.files.push(ActiveFile { file: base(&name).to_owned(), axis: None, line: *number });
        } else if let Some(rows) = fits(room) {
            let rows = rows.parse().map_err(|_| Fault::new(*number, format!("`{rows}` is no number of rows")))?;
            all.room = Some((rows, *number));
        } else if let Some((letters, sense)) =
            fits(turned).map(|l| (l, -1.0)).or_else(|| fits(stopped).map(|l| (l, 0.0)))
        {
            for letter in letters.chars().filter(|c| !c.is_whitespace()) {
                let axis = reading.by_letter(&letter.to_uppercase().to_string());
                let axis = axis.ok_or_else(|| Fault::new(*number, format!("the machine has no axis `{letter}`")))?;
                all.senses.push((axis, sense));
            }
        } else if let Some(at) = wanted.iter().position(|wanted| wanted.eq_ignore_ascii_case(line)) {
            wanted.remove(at);
        } else if !free.iter().any(|pattern| patterns::fits(pattern, line)) {
            let key = line.split(' ').next().unwrap_or_default();
            let meant = wanted.iter().find(|wanted| wanted.split(' ').next() == Some(key));
            let message = match meant {
                Some(meant) => format!("this machine has `{meant}` here: the controller would compute another one"),
                None => "what this line does to the corrections is not known here".to_owned(),
            };
            return Err(Fault::new(*number, message));
        }
    }
    wanted.retain(|line| !defaults.iter().any(|default| default.eq_ignore_ascii_case(line)));
    if let (Some(pattern), None) = (room, all.room) {
        return Err(Fault::new(0, format!("there is no line `{pattern}`")));
    }
    match (wanted.first(), &all.files[..]) {
        (Some(missing), _) => Err(Fault::new(0, format!("the line `{missing}` is missing"))),
        (None, [_]) => Ok(Some(all)),
        (None, _) => Err(Fault::new(all.files[1].line, "a second file: its rows would not be in the certificate")),
    }
}

/// A line with single blanks, without a remark in brackets behind it.
fn plain(line: &str) -> String {
    let line = line.trim();
    let bare = if line.ends_with(')') { line.rsplit_once(" (").map_or(line, |(before, _)| before) } else { line };
    bare.split_whitespace().collect::<Vec<_>>().join(" ")
}
