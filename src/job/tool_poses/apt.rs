//! Tool poses as APT CL data, as text: `GOTO/x,y,z[,i,j,k]` with tip and tool axis, `UNITS`, `RAPID`, comments.
//!
//! Words that only a post-processor needs are passed over. Words that would change the meaning of the positions, such
//! as `TRACUT`, are refused.

use super::{Aim, MAX_TOOL_POSES, Row, columns::unit_vector, wrong};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::syntax::sheet::{Sheet, SheetLine};
use crate::units;
use nalgebra::Vector3;

/// Feature of rows at rapid traverse.
const RAPID: &str = "(rapid)";

/// Words that move the tool, or the frame, in a way that is not followed here.
const REFUSED: [&str; 8] = ["TRACUT", "COPY", "GOHOME", "GOLFT", "GORGT", "GOFWD", "GOBACK", "INDIRV"];

/// A record with the place of its first line.
struct Record {
    place: Place,
    line: usize,
    /// Before the slash, in upper case.
    word: String,
    /// Behind it.
    arguments: Vec<String>,
    comment: Option<String>,
}

pub(crate) fn is_cl_data(sheet: &Sheet) -> bool {
    let goto = |line: &SheetLine| {
        let text = line.text.trim_start().to_ascii_uppercase();
        text.strip_prefix("GOTO").is_some_and(|rest| rest.trim_start().starts_with('/'))
    };
    sheet.lines().iter().any(goto)
}

pub(crate) fn rows(sheet: &Sheet) -> Result<Vec<Row>, Diagnostic> {
    let mut reader =
        Reader { factor: 1.0, axis: Vector3::z(), at: None, rapid: false, feature: None, rows: Vec::new() };
    for record in records(sheet) {
        let place = record.place.clone();
        let help =
            "read are GOTO, GODLTA, FROM, UNITS and RAPID; let the CAM system write positions in the workpiece frame";
        reader.read(&record).map_err(|refusal| refusal.at(Some(place), "").help(help))?;
    }
    if reader.rows.is_empty() {
        return Err(wrong("the file has no tool poses").at(Some(sheet.start()), ""));
    }
    Ok(reader.rows)
}

/// Returns the records: lines joined where `$` ends them, comments (`$$`, `PPRINT`) beside them.
fn records(sheet: &Sheet) -> Vec<Record> {
    let mut records: Vec<Record> = Vec::new();
    let mut open: Option<(SheetLine, String)> = None;
    for line in sheet.lines() {
        let (content, comment) = match line.text.split_once("$$") {
            Some((content, comment)) => (content.trim().to_owned(), Some(comment.trim().to_owned())),
            None => (line.text.trim().to_owned(), None),
        };
        let (first, mut text) = open.take().unwrap_or_else(|| (line.clone(), String::new()));
        match content.strip_suffix('$') {
            Some(part) if comment.is_none() => {
                text.push_str(part);
                open = Some((first, text));
                continue;
            }
            _ => text.push_str(&content),
        }
        records.push(record(&first, &text, comment));
    }
    records.extend(open.map(|(first, text)| record(&first, &text, None)));
    records
}

fn record(line: &SheetLine, text: &str, comment: Option<String>) -> Record {
    let (word, rest) = text.split_once('/').unwrap_or((text, ""));
    let upper = word.trim().to_ascii_uppercase();
    let printed = upper.strip_prefix("PPRINT").map(|_| {
        let words = text.get("PPRINT".len()..).unwrap_or_default();
        words.trim_start_matches('/').trim().to_owned()
    });
    Record {
        place: line.place.clone(),
        line: line.number,
        word: if printed.is_some() { String::new() } else { upper },
        arguments: rest.split(',').map(|cell| cell.trim().to_owned()).filter(|cell| !cell.is_empty()).collect(),
        comment: printed.or(comment),
    }
}

struct Reader {
    /// Unit of lengths, mm.
    factor: f64,
    /// Tool axis, modal.
    axis: Vector3<f64>,
    /// The last tip, mm.
    at: Option<Vector3<f64>>,
    /// True until the next motion.
    rapid: bool,
    feature: Option<String>,
    rows: Vec<Row>,
}

impl Reader {
    fn read(&mut self, record: &Record) -> Result<(), Diagnostic> {
        if let Some(comment) = record.comment.as_ref().filter(|text| text.contains(char::is_alphanumeric)) {
            self.feature = Some(comment.clone());
        }
        match record.word.as_str() {
            "UNITS" | "UNIT" => self.units(record),
            "RAPID" => {
                self.rapid = true;
                Ok(())
            }
            "GOTO" => self.goto(record),
            "FROM" => {
                self.rapid = true;
                self.goto(record)
            }
            "GODLTA" => self.step(record),
            "CSYS" if !is_identity(&record.arguments) => Err(wrong("`CSYS` with another frame is not followed")),
            "TRACUT" if record.arguments.iter().any(|word| word.eq_ignore_ascii_case("NOMORE")) => Ok(()),
            word if REFUSED.contains(&word) => Err(wrong(format!("`{word}` is not followed"))),
            _ => Ok(()),
        }
    }

    fn units(&mut self, record: &Record) -> Result<(), Diagnostic> {
        let name = record.arguments.first().map_or("", String::as_str);
        self.factor = match name.to_ascii_uppercase().as_str() {
            "MM" => 1.0,
            "CM" => 10.0,
            "M" => 1000.0,
            "IN" | "INCH" | "INCHES" => 25.4,
            _ => return Err(wrong(format!("`{}` is not a unit of lengths: MM, CM, M or INCH", shown(name)))),
        };
        if self.rows.is_empty() { Ok(()) } else { Err(wrong("the unit changes inside the file")) }
    }

    fn goto(&mut self, record: &Record) -> Result<(), Diagnostic> {
        let numbers = numbers(record)?;
        match numbers[..] {
            [x, y, z] => self.push(record, Vector3::new(x, y, z) * self.factor),
            [x, y, z, i, j, k] => {
                self.axis = unit_vector(&Vector3::new(i, j, k), "the tool axis I, J, K")?;
                self.push(record, Vector3::new(x, y, z) * self.factor)
            }
            _ => Err(wrong(format!("`{}` with {} numbers: 3 or 6 are expected", record.word, numbers.len()))),
        }
    }

    fn step(&mut self, record: &Record) -> Result<(), Diagnostic> {
        let by = match numbers(record)?[..] {
            [along] => self.axis * along,
            [x, y, z] => Vector3::new(x, y, z),
            _ => return Err(wrong("`GODLTA` takes 1 or 3 numbers")),
        };
        let Some(at) = self.at else { return Err(wrong("`GODLTA` before the first position")) };
        self.push(record, at + by * self.factor)
    }

    fn push(&mut self, record: &Record, tip: Vector3<f64>) -> Result<(), Diagnostic> {
        if tip.amax() > units::FARTHEST {
            return Err(wrong("a position is beyond 1000000 mm: no machine goes there"));
        }
        if self.rows.len() == MAX_TOOL_POSES {
            return Err(wrong(format!("more than {MAX_TOOL_POSES} tool poses")));
        }
        let rapid = std::mem::replace(&mut self.rapid, false);
        self.at = Some(tip);
        self.rows.push(Row {
            place: record.place.clone(),
            line: record.line,
            tip,
            aim: Aim::Axis(self.axis),
            spin_rad: None,
            normal: None,
            feature: if rapid { Some(RAPID.to_owned()) } else { self.feature.clone() },
        });
        Ok(())
    }
}

fn numbers(record: &Record) -> Result<Vec<f64>, Diagnostic> {
    record.arguments.iter().map(|cell| units::number(cell).map_err(|failure| wrong(failure.to_string()))).collect()
}

/// True for the twelve numbers of a frame that is the workpiece frame, or for none.
fn is_identity(arguments: &[String]) -> bool {
    let numbers: Vec<f64> = arguments.iter().filter_map(|cell| units::number(cell).ok()).collect();
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    numbers.is_empty() || numbers == identity
}
