//! A certificate as text and JSON.

use super::Format;
use super::session::Session;
use crate::evaluate::Summary;
use crate::machine::{Approach, Machine};
use crate::target::{Certificate, Figures, Handled, Target};
use crate::units::significant;
use serde_json::json;
use std::path::Path;

/// What is shown.
pub(super) struct Shown<'a> {
    pub machine: &'a Machine,
    pub target: &'a Target,
    pub certificate: &'a Certificate,
    pub files: Vec<String>,
    pub folder: &'a Path,
}

impl Shown<'_> {
    pub(super) fn print(&self, session: &Session) {
        match session.format() {
            Format::Json => session.print_json(self.json()),
            Format::Text => session.print(&self.text()),
            Format::Csv => session.print(&self.csv()),
        }
    }

    fn json(&self) -> serde_json::Value {
        let certificate = self.certificate;
        let summary = |f: &Figures| json!({"position_um": f.all.position_um, "rotation_urad": f.all.rotation_urad, "tool_axis_urad": f.tool_axis});
        let errors: serde_json::Map<_, _> = certificate
            .errors
            .iter()
            .map(|e| (e.error.to_string(), json!({"handled": e.handled, "left_um": e.left, "alone_um": e.alone})))
            .collect();
        json!({
            "target": self.target.manifest.target, "files": self.files, "poses": certificate.poses,
            "direction": certificate.approach,
            "uncompensated": summary(&certificate.uncompensated), "compensated": summary(&certificate.compensated),
            "errors": errors,
            "at_reference": {"forward": self.by_axis(0), "reverse": self.by_axis(1)},
            "cannot": self.target.manifest.cannot,
        })
    }

    fn by_axis(&self, direction: usize) -> serde_json::Map<String, serde_json::Value> {
        let names = self.machine.axes().iter().map(|axis| axis.name.to_string());
        names.zip(&self.certificate.at_reference[direction]).map(|(name, c)| (name, json!(c))).collect()
    }

    fn csv(&self) -> String {
        let rows =
            self.certificate.errors.iter().map(|e| format!("{},{},{},{}", e.error, word(e.handled), e.alone, e.left));
        let header = "error,handled,alone [um],left [um]".to_owned();
        std::iter::once(header).chain(rows).collect::<Vec<_>>().join("\n")
    }

    fn text(&self) -> String {
        [self.heading(), self.figures(), self.by_error(), self.cautions()].join("\n")
    }

    fn heading(&self) -> String {
        let what = &self.target.manifest;
        let certificate = self.certificate;
        format!(
            "{}: {}\n{} files in {}\n\nCertificate: {} poses spread over the volume, none a table point{}\n",
            self.machine.name(),
            what.title,
            self.files.len(),
            self.folder.display(),
            certificate.poses,
            match certificate.approach {
                Approach::Mean => String::new(),
                Approach::Forward => ", approached forward (the worse direction)".to_owned(),
                Approach::Reverse => ", approached in reverse (the worse direction)".to_owned(),
            }
        )
    }

    fn figures(&self) -> String {
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let _ = table.set_header(["", "max", "95 %", "rms", "mean"]);
        let (before, after) = (&self.certificate.uncompensated, &self.certificate.compensated);
        let rows = [
            ("position um, uncompensated", before.all.position_um),
            ("position um, compensated", after.all.position_um),
            ("tool axis urad, uncompensated", before.tool_axis),
            ("tool axis urad, compensated", after.tool_axis),
            ("orientation urad, uncompensated", before.all.rotation_urad),
            ("orientation urad, compensated", after.all.rotation_urad),
        ];
        for (name, s) in rows {
            let cells = [s.max, s.p95, s.rms, s.mean].map(|x| significant(x, 4));
            let _ = table.add_row(std::iter::once(name.to_owned()).chain(cells));
        }
        format!("{table}\n{}", ratio(&before.all.position_um, &after.all.position_um))
    }

    /// Only what is left: a list of forty errors that are gone helps nobody.
    fn by_error(&self) -> String {
        let mut left: Vec<_> = self.certificate.errors.iter().filter(|e| e.handled != Handled::Fully).collect();
        left.sort_by(|a, b| b.left.total_cmp(&a.left));
        let gone: Vec<String> = self
            .certificate
            .errors
            .iter()
            .filter(|e| e.handled == Handled::Fully)
            .map(|e| e.error.to_string())
            .collect();
        let mut text =
            format!("Fully compensated: {}\n", if gone.is_empty() { "none".to_owned() } else { gone.join(" ") });
        if !left.is_empty() {
            text.push_str("Left of each error alone (95 %, um; in brackets without compensation):\n");
        }
        for e in left {
            text.push_str(&format!(
                "  {:6} {:6} {:>8} ({})\n",
                e.error.to_string(),
                word(e.handled),
                significant(e.left, 3),
                significant(e.alone, 3)
            ));
        }
        text
    }

    fn cautions(&self) -> String {
        let manifest = &self.target.manifest;
        let [forward, reverse] = &self.certificate.at_reference;
        let mut text =
            String::from("At the reference position (all axes at 0) the controller adds, forward / reverse:\n");
        for ((axis, f), r) in self.machine.axes().iter().zip(forward).zip(reverse) {
            text.push_str(&format!(
                "  {:4} {} / {} {}\n",
                axis.name.to_string(),
                significant(*f, 4),
                significant(*r, 4),
                axis.unit()
            ));
        }
        text.push_str("This is also the step at the first motion after switching the compensation on.\n");
        text.push_str("This target cannot correct:\n");
        manifest.cannot.iter().for_each(|line| text.push_str(&format!("  - {line}\n")));
        text.push_str(&format!("Test the sign before cutting: {}\n", manifest.sign_test.trim()));
        text
    }
}

fn ratio(before: &Summary, after: &Summary) -> String {
    if after.p95 > 0.0 {
        format!("The 95 % position deviation falls by a factor of {}.\n", significant(before.p95 / after.p95, 3))
    } else {
        String::new()
    }
}

fn word(handled: Handled) -> &'static str {
    match handled {
        Handled::Fully => "fully",
        Handled::Partly => "partly",
        Handled::No => "no",
    }
}
