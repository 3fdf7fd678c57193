//! JSON: the facts, then one object a pose, a line each, so that it can be read by eye and by line.

use super::table::{RowBlock, Rows, Stream};
use super::work::WorkRows;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

pub(super) struct Json<W> {
    out: W,
}

impl Rows<'_> {
    /// Writes the object of a row, after a comma for all rows but the first.
    pub(super) fn json_line(&self, index: usize, row: &[f64], text: &mut String) {
        self.json_unreached(index, text);
        let (axes, values) = row.split_at(self.machine.axes().len());
        let names = self.machine.axes().iter().map(|axis| axis.name.to_string());
        let axes: Map<String, Value> = names.zip(axes.iter().map(|q| json!(q))).collect();
        let mut pose = self.work.and_then(|work| work.reached.get(index)).map_or_else(Map::new, WorkRows::json_lead);
        let along = values.get(6);
        let values = match values {
            [rss_um, p95_um, rss_urad, p95_urad] => [
                ("position_um", json!({"rss": rss_um, "p95": p95_um})),
                ("rotation_urad", json!({"rss": rss_urad, "p95": p95_urad})),
            ],
            six => [("deviation_um", json!(six[..3])), ("rotation_urad", json!(six[3..6]))],
        };
        pose.extend([("axes".to_owned(), Value::Object(axes))]);
        pose.extend(values.map(|(name, value)| (name.to_owned(), value)));
        pose.extend(along.map(|um| ("along_normal_um".to_owned(), json!(um))));
        text.push_str(",\n");
        text.push_str(&Value::Object(pose).to_string());
    }

    /// Writes the objects of the unreached rows before the pose with an index.
    pub(super) fn json_unreached(&self, index: usize, text: &mut String) {
        for row in self.work.map_or(&[][..], |work| work.misses_before(index)) {
            text.push_str(",\n");
            text.push_str(&row.json.to_string());
        }
    }
}

impl<W: Write> Json<W> {
    pub(super) fn new(rows: &Rows<'_>, mut out: W) -> io::Result<Self> {
        let facts: Map<String, Value> =
            rows.facts().into_iter().map(|(name, word)| (name.to_owned(), json!(word))).collect();
        let head = Value::Object(facts).to_string();
        write!(out, "{},\"poses\":[", head.trim_end_matches('}'))?;
        Ok(Self { out })
    }
}

impl<W: Write> Stream for Json<W> {
    fn put(&mut self, rows: &RowBlock) -> io::Result<()> {
        let text = if rows.first == 0 { rows.json.trim_start_matches(',') } else { &rows.json };
        self.out.write_all(text.as_bytes())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.write_all(b"\n]}\n")?;
        self.out.flush()
    }
}
