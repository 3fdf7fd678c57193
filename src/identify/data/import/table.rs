//! From the samples to the table that a machine file takes.

use super::sample::Import;
use super::suspicion::FindingEffect;
use crate::diagnostic::shown;
use crate::standards::{AccuracyFigures, TargetReading};

/// A table of error curves.
#[derive(Debug, Clone)]
pub struct ImportedTable {
    /// As it is written.
    pub text: String,
    /// Number of positions.
    pub rows: usize,
    /// At which positions it has no row because something is missing there.
    pub missing: Vec<String>,
}

impl Import {
    /// Returns the figures of one error; `None` without readings.
    pub fn figures(&self, error: usize) -> Option<AccuracyFigures> {
        let of_error = self.samples.iter().filter(|sample| sample.error == error);
        let readings: Vec<TargetReading> =
            of_error.map(|s| TargetReading { position: s.position, direction: s.direction, value: s.value }).collect();
        AccuracyFigures::of(&readings)
    }

    /// Returns the table as a machine file takes it, means over the runs.
    pub fn table(&self, continuous: bool) -> ImportedTable {
        let figures: Vec<AccuracyFigures> = (0..self.errors.len()).filter_map(|k| self.figures(k)).collect();
        let unit = if self.rotary { "deg" } else { "mm" };
        let mut header = vec![format!("{} [{unit}]", self.axis)];
        for (error, figures) in self.errors.iter().zip(&figures) {
            let value = if error.direction.is_rotation() { "urad" } else { "um" };
            let ways: &[&str] = if figures.bidirectional() { &["+", "-"] } else { &[""] };
            header.extend(ways.iter().map(|way| format!("{error}{way} [{value}]")));
        }
        let mut positions: Vec<f64> = figures.iter().flat_map(|f| f.targets.iter().map(|t| t.position)).collect();
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let both: Vec<bool> = figures.iter().map(AccuracyFigures::bidirectional).collect();
        let mut missing = Vec::new();
        let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
        for position in positions {
            match self.row(&figures, &both, position) {
                Some(values) => rows.push((position, values)),
                None => missing.push(format!("{}", position + 0.0)),
            }
        }
        if let (true, Some((first, values))) = (continuous, rows.first().cloned()) {
            rows.retain(|(position, _)| *position < first + 360.0);
            rows.push((first + 360.0, values));
        }
        let mut text = String::new();
        for (key, value) in &self.metadata {
            text += &format!("# {}: {}\n", shown(key), shown(value));
        }
        for line in self.lines.iter().filter(|line| line.taken_off) {
            let slope = round_for_table(line.slope * 1e6);
            text += &format!("# {}: line of {slope} um/m taken off\n", self.errors[line.error]);
        }
        for finding in &self.findings {
            let effect = match finding.effect {
                FindingEffect::LeftOut => "left out",
                FindingEffect::Accepted => "accepted",
                FindingEffect::Used | FindingEffect::Refused => continue,
            };
            text += &format!("# {effect}: {}\n", finding.message);
        }
        text += &format!("{}\n", header.join(", "));
        for (position, values) in &rows {
            let cells: Vec<String> = values.iter().map(|v| format!("{}", round_for_table(*v))).collect();
            text += &format!("{}, {}\n", position + 0.0, cells.join(", "));
        }
        ImportedTable { text, rows: rows.len(), missing }
    }

    /// Returns the cells of one position, um and urad.
    fn row(&self, figures: &[AccuracyFigures], both: &[bool], position: f64) -> Option<Vec<f64>> {
        let mut cells = Vec::new();
        for ((error, figures), both) in self.errors.iter().zip(figures).zip(both) {
            let factor = if error.direction.is_rotation() { 1e6 } else { 1e3 };
            let at = figures.targets.binary_search_by(|t| t.position.total_cmp(&position)).ok()?;
            let target = &figures.targets[at];
            let means = if *both { vec![target.forward?.mean, target.reverse?.mean] } else { vec![target.any()?.mean] };
            cells.extend(means.into_iter().map(|mean| mean * factor));
        }
        Some(cells)
    }
}

/// Rounds to a thousandth of a nanometre: no digits of mere arithmetic, never `-0`.
fn round_for_table(value: f64) -> f64 {
    let scaled = libm::round(value * 1e6) / 1e6;
    if scaled.is_finite() { scaled + 0.0 } else { value }
}
