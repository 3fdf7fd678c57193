//! A certificate as text and JSON.

use super::bands;
use super::session::Session;
use super::view::table;
use crate::cli::Outcome;
use abbe::options::Approach;
use abbe::results::{
    Axis, AxisKind, AxisPositions, BallCheck, CertificateReport, CertificateStep, CompensationDegree, ControllerTarget,
    Figures, JobCertificate, MIN_READING_MM, Machine, NumberChange, ReferenceShift, Restored, SeenCorrection,
    SignTrial, SignTrials, SingleErrorResidual, Summary, ToolDirection,
};
use abbe::text::{counted, micro, significant};
use std::path::Path;

/// A certificate with the folder of its files.
pub(crate) struct CertificateView<'a> {
    pub report: &'a CertificateReport,
    pub folder: &'a Path,
}

impl CertificateView<'_> {
    pub(crate) fn print(&self, session: &Session) -> Outcome {
        session.show(self.report, || self.csv(), || self.text())
    }

    /// Returns the effect of a new reference position where tables must vanish at it.
    fn reference_shift(&self) -> String {
        let Some(shifted) = &self.report.reference_shift else { return String::new() };
        let ReferenceShift { shift_um, shift_urad, position_um, without_tables_um } = shifted;
        let one = |axis: &Axis| {
            let (name, unit) = (axis.name.as_str(), micro(axis.kind).1);
            let shift = shift_um.get(name).or_else(|| shift_urad.get(name))?;
            Some(format!("{name} {} {unit}", significant(*shift, 4)))
        };
        let list: Vec<String> = self.report.machine.axes().iter().filter_map(one).collect();
        format!(
            "The tables vanish at the reference position. With the machine zero also moved by {} the position is \
             at most {} um off, 95 % {}; without tables and with the best zero for that, {} and {}.\n",
            list.join(", "),
            significant(position_um.max, 4),
            significant(position_um.p95, 4),
            significant(without_tables_um.max, 4),
            significant(without_tables_um.p95, 4)
        )
    }

    fn csv(&self) -> String {
        let rows = self
            .report
            .errors
            .values()
            .map(|e| format!("{},{},{},{}", e.error, word(e.degree), e.alone_um, e.residual_um));
        let header = "error,handled,alone [um],left [um]".to_owned();
        std::iter::once(header).chain(rows).collect::<Vec<_>>().join("\n")
    }

    fn text(&self) -> String {
        let [figures, job, second] = [self.figures(), self.job(), self.second()];
        let heading = abbe::headlines::certificate(self.report) + &self.heading();
        let parts =
            [heading, second, figures, job, self.programming(), self.drives(), self.by_error(), self.cautions()];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
    }

    fn heading(&self) -> String {
        let what = &self.report.controller.manifest;
        format!(
            "{}: {}\n{} in {}\n{}Tool: {}\n\nCertificate: {} spread over the {}volume, none a table \
             point, {}{}\n",
            self.report.machine.name(),
            what.title,
            counted(self.report.files.len(), "file"),
            self.folder.display(),
            self.restore(),
            tool(&self.report.machine, &self.report.controller),
            counted(self.report.poses, "pose"),
            if self.report.beyond_measured.is_some() { "measured part of the " } else { "" },
            self.report.over.reference_words(),
            approached(self.report.direction)
        )
    }

    /// Returns what takes the files back.
    fn restore(&self) -> String {
        let Some(restored) = self.report.restore else { return String::new() };
        let holds = match restored {
            Restored::InForce => "what was in force before",
            Restored::NominalNumbers => "the numbers of the nominal machine: compare them with those in force",
            Restored::NoCorrections => "the same files without corrections",
        };
        format!("Back again: {}/restore, {holds}\n", self.folder.display())
    }

    /// Returns the figures over the job.
    fn job(&self) -> String {
        let Some(job) = &self.report.job else { return String::new() };
        let JobCertificate { over, direction, uncompensated, compensated, .. } = job;
        let worse = approached(*direction);
        let rows = figures_table(uncompensated, compensated);
        format!("{}Each state is set up by itself{worse}.\n{rows}\n", over.text())
    }

    /// Returns the verdict of the second measurement.
    fn second(&self) -> String {
        let Some(of) = &self.report.second else { return String::new() };
        let percent = |share: f64| format!("{} %", significant(100.0 * share, 3));
        let seen = |of: &SeenCorrection| format!("{:.3} ±{:.3}", of.amount, of.expanded_uncertainty);
        let axis = |of: &SeenCorrection| format!("{} {}", of.axis.as_deref().unwrap_or(""), seen(of));
        let by_axis: Vec<String> = of.correction_by_axis.iter().map(axis).collect();
        let correction = of.correction.as_ref().map_or_else(
            || "The set does nothing that these readings would show.\n".to_owned(),
            |all| format!("Of the correction they see {} (1: all, 0: none): {}.\n", seen(all), by_axis.join(", ")),
        );
        let exact = "The machine file states no uncertainty of its errors: the prediction counts as exact.\n";
        let once = match &of.counted_once[..] {
            [] => String::new(),
            names => format!("Common to both measurements, counted once: {}.\n", names.join(", ")),
        };
        format!(
            "Second measurement, {}: |E_n| is at most 1 for {}; {} are expected, of 1000 good campaigns 995 have {} or \
             more.\n{correction}{}{once}",
            counted(of.readings.len(), "reading"),
            percent(of.within),
            percent(of.within_expected),
            percent(of.within_least),
            if of.has_predicted_uncertainty { "" } else { exact },
        )
    }

    fn figures(&self) -> String {
        let (before, after) = (&self.report.uncompensated, &self.report.compensated);
        let table = figures_table(before, after);
        let bands = self.report.uncertainty.as_ref().map_or_else(String::new, |of| {
            bands::text(&[("uncompensated".to_owned(), &of.uncompensated), ("compensated".to_owned(), &of.compensated)])
        });
        let steps = self.steps();
        let straight = self.report.straight.as_ref().map_or_else(String::new, |of| {
            let [p95, max] = [of.position_um.p95, of.position_um.max].map(|x| significant(x, 4));
            format!(
                "Compensated is with steps between points, at the worse end of each section. With straight lines, an \
                 option of the control: position 95 % {p95} um, max {max} um.\n"
            )
        });
        let (beyond, shift) = (self.beyond_measured(), self.reference_shift());
        format!("{table}\n{bands}{steps}{straight}{beyond}{shift}")
    }

    /// Returns the figures where curves were not measured.
    fn beyond_measured(&self) -> String {
        let Some(of) = &self.report.beyond_measured else { return String::new() };
        let ranges = bands::ranges(&of.measured);
        let rows = [("uncompensated", &of.uncompensated), ("compensated", &of.compensated)].map(|(state, of)| {
            let [p95, max] = [of.position_um.p95, of.position_um.max].map(|x| significant(x, 4));
            format!("{state} 95 % {p95} um, max {max} um")
        });
        format!(
            "Measured: {ranges}. At {} beyond, where curves go on without a measurement: {}.\n",
            counted(of.poses, "pose"),
            rows.join("; ")
        )
    }

    /// Returns the figures after each step of a composed set.
    fn steps(&self) -> String {
        let line = |step: &CertificateStep| {
            let (position, axis) = (step.compensated.position_um.p95, step.compensated.tool_axis_urad.p95);
            let (position, axis) = (significant(position, 4), significant(axis, 4));
            format!("After {}: 95 % {position} um, tool axis {axis} urad.\n", step.target)
        };
        self.report.steps.iter().map(line).collect()
    }

    /// Returns the figures of kinematic parameters by tool and by what a block programs.
    fn programming(&self) -> String {
        let ways = &self.report.programming;
        if ways.is_empty() {
            return String::new();
        }
        let mut table = table(&["programmed", "tool", "position um, max", "95 %", "tool axis urad, max", "95 %"]);
        for way in ways {
            let programmed = match way.tool_direction {
                ToolDirection::Vector => "tool vectors",
                ToolDirection::RotaryAxes => "rotary axes",
            };
            let tool = match (way.tool.as_str(), way.longer_mm > 0.0) {
                ("", true) => format!("{} mm longer", way.longer_mm),
                ("", false) => "of the file".to_owned(),
                (name, true) => format!("{name}, {} mm longer", way.longer_mm),
                (name, false) => name.to_owned(),
            };
            let _ = table.add_row(
                [programmed.to_owned(), tool.clone()]
                    .into_iter()
                    .chain(cells(&way.compensated.position_um, &way.compensated.tool_axis_urad)),
            );
            if let Some(away) = &way.away_from_poles {
                let _ = table.add_row(
                    ["  away from poles".to_owned(), tool]
                        .into_iter()
                        .chain(cells(&away.position_um, &away.tool_axis_urad)),
                );
            }
        }
        format!("Compensated, by what a block programs for the direction of the tool:\n{table}\n{}", self.poles())
    }

    /// Returns what a module asks of the drives: for each rotary axis the linear and the rotary joint that accelerate
    /// most.
    fn drives(&self) -> String {
        let (axes, all) = (self.report.machine.axes(), &self.report.drives);
        if all.is_empty() {
            return String::new();
        }
        let kind = |name: &str| axes.iter().find(|axis| axis.name.as_str() == name).map(|axis| axis.kind);
        let mut text =
            "Drives, for 1 deg/s of a rotary axis while the tip stands on the part (at 10 deg/s rates times \
                        10, accelerations times 100):\n"
                .to_owned();
        for turning in axes.iter().filter(|axis| axis.kind == AxisKind::Rotary) {
            for of in [AxisKind::Linear, AxisKind::Rotary] {
                let moved = all.iter().filter(|one| one.turning == turning.name.as_str());
                let moved = moved.filter(|one| kind(&one.joint) == Some(of));
                let Some(most) = moved.max_by(|a, b| a.acceleration.total_cmp(&b.acceleration)) else { continue };
                let unit = if of == AxisKind::Linear { "mm" } else { "deg" };
                let [rate, most_of, ideal] =
                    [most.rate, most.acceleration, most.ideal_acceleration].map(|x| significant(x, 3));
                let (turning, joint, place) = (&most.turning, &most.joint, place(&most.acceleration_at));
                text.push_str(&format!(
                    "  {turning} turns: {joint} {rate} {unit}/s, {most_of} {unit}/s2 (ideal machine {ideal}) at \
                     {place}\n"
                ));
            }
        }
        if let Some(zone) = self.report.pole_zone_deg {
            text.push_str(&format!(
                "Within {} deg of a pole, where the tool stands along a rotary axis, rotary corrections are bounded.\n",
                significant(zone, 3)
            ));
        }
        text
    }

    /// Returns the check of loaded parameters by a ball.
    fn ball_checks(&self) -> String {
        let checks = &self.report.ball_checks;
        if checks.is_empty() {
            return String::new();
        }
        let centre = |um: &[f64; 3]| um.map(|x| format!("{x:+.1}")).join(" ");
        let mut text =
            "Then probe a ball that stands on the part, with a probe as long as the tool above and the control's \
                        transformation on. Its centre, found in X Y Z of the part, moves by the turn of one axis:\n"
                .to_owned();
        for BallCheck { turned, first, second, before_um, with_um } in checks {
            text.push_str(&format!(
                "  {turned}: from {} to {}\n     before {} um, with this set {} um\n",
                place(first),
                place(second),
                centre(before_um),
                centre(with_um)
            ));
        }
        text
    }

    /// Returns what the controller is taken to do at a pole, if any pose is at one.
    fn poles(&self) -> String {
        match self.report.programming.iter().map(|way| way.at_poles).max() {
            None | Some(0) => String::new(),
            Some(most) => format!(
                "{most} of {} poses are at a pole: the tool stands along a rotary axis, which the certificate keeps \
                 where it is programmed.\n",
                self.report.poses
            ),
        }
    }

    /// Returns the errors that are not compensated fully: a list of forty others helps nobody.
    fn by_error(&self) -> String {
        let list = |keep: &dyn Fn(&SingleErrorResidual) -> bool| {
            let names: Vec<String> =
                self.report.errors.iter().filter(|(_, e)| keep(e)).map(|(name, _)| name.clone()).collect();
            if names.is_empty() { "none".to_owned() } else { names.join(" ") }
        };
        let idle = |e: &SingleErrorResidual| e.alone_um < NO_EFFECT;
        let gone = list(&|e| e.degree == CompensationDegree::Fully && !idle(e));
        let poses = self.report.single_error_poses;
        let mut text = format!(
            "Each error alone, with tables of its own laid out as here, over {poses} of the poses:\n  fully \
             compensated: {gone}\n"
        );
        if self.report.errors.values().any(idle) {
            text.push_str(&format!("  without effect here: {}\n", list(&idle)));
        }
        let mut left: Vec<_> =
            self.report.errors.values().filter(|e| e.degree != CompensationDegree::Fully && !idle(e)).collect();
        left.sort_by(|a, b| b.residual_um.total_cmp(&a.residual_um));
        if !left.is_empty() {
            text.push_str("  residual (95 %, um; in brackets without compensation):\n");
        }
        for e in left {
            let (left, alone) = (significant(e.residual_um, 3), significant(e.alone_um, 3));
            text.push_str(&format!("  {:6} {:6} {left:>8} ({alone})\n", e.error.to_string(), word(e.degree)));
        }
        text
    }

    /// A test at the machine with numbers from these files.
    fn sign_test(&self) -> String {
        let trials = self.report.sign_trials.as_ref().map_or_else(String::new, |trials| self.trials(trials));
        trials + &self.test_of_all()
    }

    /// Returns the test of all numbers together, where they move an axis most.
    fn test_of_all(&self) -> String {
        let Some(strongest) = &self.report.strongest else { return String::new() };
        let axes = self.report.machine.axes();
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
        let place = place.join(", ");
        let small = axis.kind == AxisKind::Linear && strongest.value.abs() < MIN_READING_MM;
        if self.report.sign_trials.is_some() {
            let least = 1e3 * MIN_READING_MM;
            return if small {
                format!("These numbers move no axis by {least} um: the steps above are the test.\n")
            } else {
                format!(
                    "Then load the new numbers in place of those before: for the block at {place} the position of \
                     {name} must change by {added}; by {other} means a wrong sign.\n"
                )
            };
        }
        // Tables beside a module are not switched with it.
        let (what, they) = if self.report.controller.manifest.kinematics().is_some() {
            ("the module adds", "it")
        } else {
            ("the files add", "they")
        };
        let caution = if small { " That may be too little to read: rely on the change above.\n" } else { "\n" };
        format!(
            "Then measure: at {place}{coming}, {what} {added} to {name}. Switched on, {they} must change the reading \
             of an instrument along {name} by {added}; by {other} means a wrong sign.{caution}",
        )
    }

    /// Returns the steps of a sign test of kinematic parameters.
    fn trials(&self, trials: &SignTrials) -> String {
        let Some(words) = &self.report.controller.manifest.trial else { return String::new() };
        let mut text = format!(
            "Each step by itself, from the numbers in force. Move to the positions stated, run this block {}, and read \
             {}. Make the change. {} Run the same block, and read again. Another difference than stated refutes the \
             sense or the place of the numbers changed.\n",
            words.with, words.read, words.activate
        );
        for (n, trial) in trials.trials.iter().enumerate() {
            text.push_str(&self.trial(n + 1, trial));
        }
        if !trials.untested.is_empty() {
            let names = trials.untested.join(", ");
            text.push_str(&format!("No change that can be read within the travels tests these vectors: {names}.\n"));
        }
        text
    }

    fn trial(&self, number: usize, trial: &SignTrial) -> String {
        let axes = self.report.machine.axes();
        let changes: Vec<String> = trial.changes.iter().map(signed).collect();
        let place: Vec<String> =
            axes.iter().zip(&trial.pose).map(|(axis, q)| format!("{} {}", axis.name, significant(*q, 7))).collect();
        let tool = trial.tool_length_mm.map_or_else(String::new, |mm| format!(", with a tool length of {mm} mm"));
        let name = &axes[trial.axis].name;
        let by = |mm: f64| if mm.abs() < UNMOVED_MM { "0 mm".to_owned() } else { format!("{mm:+.3} mm") };
        let turned = axes.iter().zip(&trial.pose).any(|(axis, q)| axis.kind == AxisKind::Rotary && *q != 0.0);
        let unturned =
            if turned { format!(" With the rotary axes at 0: {}.", by(trial.unturned_mm)) } else { String::new() };
        format!(
            "  {number}. {}. At {}{tool}: {name} must change by {}.{unturned}\n",
            changes.join(", "),
            place.join(" "),
            by(trial.reading_mm)
        )
    }

    fn cautions(&self) -> String {
        let manifest = &self.report.controller.manifest;
        let at_reference = &self.report.at_reference;
        let axes = self.report.machine.axes();
        let home = self.report.machine.home().map(|home| {
            let at = |(axis, q): (&Axis, &f64)| format!("{} = {} {}", axis.name, significant(*q, 7), axis.unit());
            axes.iter().zip(&home).map(at).collect::<Vec<_>>().join(", ")
        });
        let place = home.as_ref().map_or_else(|| "With all axes at 0".to_owned(), |home| format!("At home ({home})"));
        let mut text = format!("{place} the controller adds, forward / reverse:\n");
        let added = at_reference.forward.values().zip(at_reference.reverse.values());
        for (axis, (f, r)) in axes.iter().zip(added) {
            text.push_str(&format!(
                "  {:4} {} / {} {}\n",
                axis.name.to_string(),
                significant(*f, 4),
                significant(*r, 4),
                axis.unit()
            ));
        }
        text.push_str(match home {
            Some(_) => "This is also the step at the first motion after switching the compensation on.\n",
            None => "The step after switching it on is that where the axes are homed: state `home` of each axis.\n",
        });
        text.push_str("This target cannot correct:\n");
        manifest.cannot.iter().for_each(|line| text.push_str(&format!("  - {line}\n")));
        text.push_str(&format!("Test the sign before cutting: {}\n", manifest.sign_test.trim()));
        text.push_str(&self.sign_test());
        text.push_str(&self.ball_checks());
        text
    }
}

/// Returns a pose in words.
fn place(at: &AxisPositions) -> String {
    at.iter().map(|(name, q)| format!("{name} {}", significant(*q, 6))).collect::<Vec<_>>().join(" ")
}

/// Returns a change of a number in words.
fn signed(change: &NumberChange) -> String {
    match change.by.strip_prefix('-') {
        Some(amount) => format!("lower {} by {amount}", change.name),
        None => format!("raise {} by {}", change.name, change.by),
    }
}

/// Returns the direction of approach in words.
fn approached(direction: Approach) -> &'static str {
    match direction {
        Approach::Mean => "",
        Approach::Forward => ", approached forward (the worse direction)",
        Approach::Reverse => ", approached in reverse (the worse direction)",
    }
}

fn figures_table(before: &Figures, after: &Figures) -> comfy_table::Table {
    let mut table = table(&["", "max", "95 %", "rms", "mean"]);
    let rows = [
        ("position um, uncompensated", before.position_um),
        ("position um, compensated", after.position_um),
        ("tool axis urad, uncompensated", before.tool_axis_urad),
        ("tool axis urad, compensated", after.tool_axis_urad),
        ("orientation urad, uncompensated", before.rotation_urad),
        ("orientation urad, compensated", after.rotation_urad),
    ];
    for (name, s) in rows {
        let cells = [s.max, s.p95, s.rms, s.mean].map(|x| significant(x, 4));
        let _ = table.add_row(std::iter::once(name.to_owned()).chain(cells));
    }
    table
}

/// Below this (um) an error does nothing at the functional point.
const NO_EFFECT: f64 = 0.05;

/// Motion that a display of 1 um does not show, mm.
const UNMOVED_MM: f64 = 5e-4;

/// The tool in words: a table holds for its length.
fn tool(machine: &Machine, target: &ControllerTarget) -> String {
    let tool = machine.tool();
    let length: f64 = (0..3).map(|i| (tool.tip[i] - tool.gauge[i]) * (tool.tip[i] - tool.gauge[i])).sum();
    let length = significant(libm::sqrt(length), 6);
    let name = if tool.name.is_empty() { String::new() } else { format!("`{}`, ", tool.name) };
    let only = if target.manifest.tool_dependent() { "; such tables hold for one tool only" } else { "" };
    format!("{name}{length} mm from the gauge point to the functional point{only}")
}

fn word(degree: CompensationDegree) -> &'static str {
    match degree {
        CompensationDegree::Fully => "fully",
        CompensationDegree::Partly => "partly",
        CompensationDegree::No => "no",
    }
}

/// Position (um) and tool axis (urad), the largest and 95 % of each.
fn cells(position: &Summary, axis: &Summary) -> [String; 4] {
    [position.max, position.p95, axis.max, axis.p95].map(|x| significant(x, 4))
}
