//! A certificate as text and JSON.

use super::session::Session;
use crate::cli::Format;
use crate::controller::{
    Certificate, ControllerTarget, ErrorLeft, Figures, Handled, ROUNDING_UM, RaisedFigure, ZeroShift,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Summary;
use crate::machine::{Approach, Axis, AxisKind, Machine};
use crate::units::significant;
use serde_json::json;
use std::path::Path;

/// What is shown.
pub(crate) struct CertificateView<'a> {
    pub machine: &'a Machine,
    pub target: &'a ControllerTarget,
    pub certificate: &'a Certificate,
    pub files: Vec<String>,
    pub folder: &'a Path,
}

impl CertificateView<'_> {
    pub(crate) fn print(&self, session: &Session) {
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
        let shifted = certificate.shifted.as_ref();
        let shift = |s: &ZeroShift| {
            let of = |kind: AxisKind| -> serde_json::Map<_, _> {
                let axes = self.machine.axes().iter().zip(&s.shift).filter(|(axis, _)| axis.kind == kind);
                axes.map(|(axis, shift)| (axis.name.to_string(), json!(shift * micro(kind).0))).collect()
            };
            json!({"shift_um": of(AxisKind::Linear), "shift_urad": of(AxisKind::Rotary), "position_um": s.position_um, "without_tables_um": s.alone_um})
        };
        let raised = |r: &RaisedFigure| json!({"direction": r.approach, "figure": r.figure, "before_um": r.before, "after_um": r.after});
        json!({
            "reference_shift": shifted.map(shift), "raised": certificate.raised.iter().map(raised).collect::<Vec<_>>(),
            "target": self.target.manifest.target, "files": self.files, "poses": certificate.poses,
            "direction": certificate.approach, "tool": self.machine.tool().name,
            "uncompensated": summary(&certificate.uncompensated), "compensated": summary(&certificate.compensated),
            "errors": errors,
            "at_reference": {"forward": self.by_axis(0), "reverse": self.by_axis(1)},
            "cannot": self.target.manifest.cannot,
        })
    }

    fn by_axis(&self, direction: usize) -> serde_json::Map<String, serde_json::Value> {
        self.named(&self.certificate.at_reference[direction])
    }

    fn named(&self, values: &[f64]) -> serde_json::Map<String, serde_json::Value> {
        let names = self.machine.axes().iter().map(|axis| axis.name.to_string());
        names.zip(values).map(|(name, value)| (name, json!(value))).collect()
    }

    /// What a new reference position does where tables must vanish at it.
    fn shifted(&self) -> String {
        let Some(shifted) = &self.certificate.shifted else { return String::new() };
        let one = |(axis, shift): (&Axis, &f64)| {
            let (scale, unit) = micro(axis.kind);
            format!("{} {} {unit}", axis.name, significant(shift * scale, 4))
        };
        let list: Vec<String> = self.machine.axes().iter().zip(&shifted.shift).map(one).collect();
        format!(
            "The tables vanish at the reference position. With the machine zero moved besides by {} the position is at most {} um off, 95 % {}; without tables and with the zero where it is best for that, {} and {}.\n",
            list.join(", "),
            significant(shifted.position_um.max, 4),
            significant(shifted.position_um.p95, 4),
            significant(shifted.alone_um.max, 4),
            significant(shifted.alone_um.p95, 4)
        )
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
        let files = if self.files.len() == 1 { "file" } else { "files" };
        format!(
            "{}: {}\n{} {files} in {}\nTool: {}\n\nCertificate: {} poses spread over the volume, none a table point{}\n",
            self.machine.name(),
            what.title,
            self.files.len(),
            self.folder.display(),
            tool(self.machine, self.target),
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
        let raised = raised(self.certificate).map_or_else(String::new, |words| format!("The files RAISE {words}.\n"));
        format!("{table}\n{}{raised}{}", ratio(&before.all.position_um, &after.all.position_um), self.shifted())
    }

    /// Only what is left: a list of forty errors that are gone helps nobody.
    fn by_error(&self) -> String {
        let list = |keep: &dyn Fn(&ErrorLeft) -> bool| {
            let names: Vec<String> =
                self.certificate.errors.iter().filter(|e| keep(e)).map(|e| e.error.to_string()).collect();
            if names.is_empty() { "none".to_owned() } else { names.join(" ") }
        };
        let idle = |e: &ErrorLeft| e.alone < NO_EFFECT;
        let gone = list(&|e| e.handled == Handled::Fully && !idle(e));
        let mut text = format!(
            "What this target can do against each error alone, laid out as here:\n  fully compensated: {gone}\n"
        );
        if self.certificate.errors.iter().any(idle) {
            text.push_str(&format!("  without effect here: {}\n", list(&idle)));
        }
        let mut left: Vec<_> =
            self.certificate.errors.iter().filter(|e| e.handled != Handled::Fully && !idle(e)).collect();
        left.sort_by(|a, b| b.left.total_cmp(&a.left));
        if !left.is_empty() {
            text.push_str("  left of it (95 %, um; in brackets without compensation):\n");
        }
        for e in left {
            let (left, alone) = (significant(e.left, 3), significant(e.alone, 3));
            text.push_str(&format!("  {:6} {:6} {left:>8} ({alone})\n", e.error.to_string(), word(e.handled)));
        }
        text
    }

    /// A test at the machine with a number from these files.
    fn sign_test(&self) -> String {
        let Some(strongest) = &self.certificate.strongest else { return String::new() };
        let axes = self.machine.axes();
        let place: Vec<String> = axes
            .iter()
            .zip(&strongest.at)
            .map(|(axis, q)| format!("{} = {} {}", axis.name, significant(*q, 7), axis.unit()))
            .collect();
        let axis = &axes[strongest.axis];
        let coming = match strongest.approach {
            Approach::Mean => "",
            Approach::Forward => ", coming forward",
            Approach::Reverse => ", coming in reverse",
        };
        let by = |x: f64| format!("{} {}", significant(x, 4), axis.unit());
        let (name, added, other) = (&axis.name, by(strongest.value), by(0.0 - strongest.value));
        // Tables beside a module are not switched with it.
        let (what, they) = if self.target.manifest.kinematics().is_some() {
            ("the module adds", "it")
        } else {
            ("the files add", "they")
        };
        format!(
            "Then measure: at {}{coming}, {what} {added} to {name}. Switched on, {they} must change what an instrument along {name} reads by {added}; by {other} means a wrong sign.\n",
            place.join(", "),
        )
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
        text.push_str(&self.sign_test());
        text
    }
}

/// Below this (um) an error does nothing at the functional point.
const NO_EFFECT: f64 = 0.05;

/// How many um in a mm, or urad in a deg, and their name.
pub(crate) fn micro(kind: AxisKind) -> (f64, &'static str) {
    match kind {
        AxisKind::Linear => (1e3, "um"),
        AxisKind::Rotary => (1f64.to_radians() * 1e6, "urad"),
    }
}

/// What the files raise, in words; none if nothing.
fn raised(certificate: &Certificate) -> Option<String> {
    let way = |approach| match approach {
        Approach::Mean => "",
        Approach::Forward => " forward",
        Approach::Reverse => " in reverse",
    };
    let one = |r: &RaisedFigure| {
        format!("{}{} to {} um from {}", r.figure, way(r.approach), significant(r.after, 4), significant(r.before, 4))
    };
    let all: Vec<String> = certificate.raised.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("the position deviation: {}", all.join(", ")))
}

fn ratio(before: &Summary, after: &Summary) -> String {
    let (before, after) = (before.p95, after.p95);
    if before < ROUNDING_UM {
        "There was nothing to compensate.\n".to_owned()
    } else if after < ROUNDING_UM {
        "The 95 % position deviation falls below a nanometre.\n".to_owned()
    } else if after <= before {
        format!("The 95 % position deviation falls by a factor of {}.\n", significant(before / after, 3))
    } else {
        String::new()
    }
}

/// What to warn of before anybody loads such files.
pub(crate) fn warnings(certificate: &Certificate) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let (before, after) = (&certificate.uncompensated, &certificate.compensated);
    let lessened = |b: &Summary, a: &Summary| a.rms < 0.999 * b.rms;
    let lessens =
        lessened(&before.all.position_um, &after.all.position_um) || lessened(&before.tool_axis, &after.tool_axis);
    if certificate.strongest.is_none() && !lessens {
        let help = "no error of this machine is within the target's reach, or the files hold nothing: a target with a lattice, such as grid-csv, takes away what depends on several axes";
        found.push(Diagnostic::new(codes::W0602, "the tables correct nothing").help(help));
    } else if let Some(words) = raised(certificate) {
        found.push(Diagnostic::new(codes::W0602, format!("the tables raise {words}")).help(why_raised(certificate)));
    }
    // A twentieth more is within what any table of angles changes here and there.
    let turned = |b: &Summary, a: &Summary| a.p95 > b.p95 * 1.05 + ROUNDING_UM;
    if turned(&before.tool_axis, &after.tool_axis) || turned(&before.all.rotation_urad, &after.all.rotation_urad) {
        let message = format!(
            "the orientation gets worse: 95 % {} urad instead of {} (tool axis {} instead of {})",
            significant(after.all.rotation_urad.p95, 4),
            significant(before.all.rotation_urad.p95, 4),
            significant(after.tool_axis.p95, 4),
            significant(before.tool_axis.p95, 4)
        );
        found.push(Diagnostic::new(codes::W0603, message).help("rotation about the tool axis matters to tools that do not turn; `--correct position` leaves the rotary axes alone"));
    }
    found
}

/// Why tables can make it worse, and what to do.
fn why_raised(certificate: &Certificate) -> &'static str {
    match &certificate.shifted {
        Some(shifted) if shifted.is_better() => {
            "the tables vanish at the reference position and leave a constant: move the machine zero as the certificate says, or do not load them"
        }
        _ => {
            "they take away an error that happened to cancel another one, which this target cannot correct: do not load them for volumetric accuracy"
        }
    }
}

/// The tool in words: a table holds for its length.
fn tool(machine: &Machine, target: &ControllerTarget) -> String {
    let tool = machine.tool();
    let length: f64 = (0..3).map(|i| (tool.tip[i] - tool.gauge[i]) * (tool.tip[i] - tool.gauge[i])).sum();
    let length = significant(libm::sqrt(length), 6);
    let name = if tool.name.is_empty() { String::new() } else { format!("`{}`, ", tool.name) };
    let only = if target.manifest.tool_dependent() { "; such tables hold for one tool only" } else { "" };
    format!("{name}{length} mm from the gauge point to the functional point{only}")
}

fn word(handled: Handled) -> &'static str {
    match handled {
        Handled::Fully => "fully",
        Handled::Partly => "partly",
        Handled::No => "no",
    }
}
