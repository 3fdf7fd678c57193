//! JSON: the facts, then one object a pose.

use super::Rows;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

impl Rows<'_> {
    /// Writes JSON: a pose a line, so that it can be read by eye and by line.
    pub fn json(&self, out: &mut dyn Write) -> io::Result<()> {
        let facts: Map<String, Value> =
            self.facts().into_iter().map(|(name, word)| (name.to_owned(), json!(word))).collect();
        let head = Value::Object(facts).to_string();
        write!(out, "{},\"poses\":[", head.trim_end_matches('}'))?;
        for index in 0..self.deviations.len() {
            let comma = if index == 0 { "\n" } else { ",\n" };
            write!(out, "{comma}{}", self.pose(index))?;
        }
        writeln!(out, "\n]}}")
    }

    fn pose(&self, index: usize) -> Value {
        let row = self.row(index);
        let (axes, six) = row.split_at(self.machine.axes().len());
        let names = self.machine.axes().iter().map(|axis| axis.name.to_string());
        let axes: Map<String, Value> = names.zip(axes.iter().map(|q| json!(q))).collect();
        json!({"axes": axes, "deviation_um": six[..3], "rotation_urad": six[3..]})
    }
}
