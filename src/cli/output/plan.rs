//! `abbe identify --plan`: poses worth measuring, and what they will tell.

use super::session::Session;
use crate::cli::{Format, Outcome};
use crate::identify::plan;
use crate::identify::{Estimate, Measurement, MeasurementPlan, Model, Parameter};
use crate::units::significant;
use serde_json::json;

pub(crate) fn run(session: &Session, model: &Model<'_>, count: usize, noise: f64, seed: u64) -> Outcome {
    let report = Report { model, plan: plan(model, count, noise, seed) };
    match session.format() {
        Format::Json => session.print_json(report.json()),
        Format::Csv => session.print(&report.csv()),
        Format::Text => session.print(&report.text()),
    }
    Ok(())
}

/// What is printed.
struct Report<'a> {
    model: &'a Model<'a>,
    plan: MeasurementPlan,
}

impl Report<'_> {
    fn tool(&self, pose: &Measurement) -> &str {
        &self.model.machine(pose).tool().name
    }

    fn named(&self) -> bool {
        self.model.machines().len() > 1
    }

    fn estimates(&self) -> impl Iterator<Item = (&Parameter, &Estimate)> {
        self.model.parameters().iter().zip(&self.plan.expected.estimates)
    }

    /// A file of measurements that only lacks the measured values.
    fn csv(&self) -> String {
        let axes = self.model.machines().iter().take(1).flat_map(|machine| machine.axes());
        let header: Vec<String> = axes.map(|axis| format!("{} [{}]", axis.name, axis.unit())).collect();
        let tool = if self.named() { ",tool" } else { "" };
        let mut text = format!("{}{tool},dx [um],dy [um],dz [um]\n", header.join(","));
        for pose in &self.plan.poses {
            let cells: Vec<String> = pose.pose.iter().map(|q| rounded(*q).to_string()).collect();
            let tool = if self.named() { format!(",{}", self.tool(pose)) } else { String::new() };
            text += &format!("{}{tool},,,\n", cells.join(","));
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let s = &self.plan.expected;
        let parameter = |(p, e): (&Parameter, &Estimate)| json!({"name": p.name, "sigma": e.sigma.map(|s| p.shown(s)), "unit": p.unit});
        let pose = |m: &Measurement| {
            let axes = self.model.machine(m).axes().iter().zip(&m.pose);
            let axes: serde_json::Map<_, _> =
                axes.map(|(axis, q)| (axis.name.to_string(), json!(rounded(*q)))).collect();
            json!({"axes": axes, "tool": self.tool(m)})
        };
        json!({
            "poses": self.plan.poses.iter().map(pose).collect::<Vec<_>>(),
            "noise_um": s.sigma * 1e3,
            "parameters": self.estimates().map(parameter).collect::<Vec<_>>(),
            "rank": s.rank, "unknowns": self.model.parameters().len(), "well_determined": s.well_determined,
            "null_space": s.null_space, "drowned": s.drowned, "condition": s.condition,
        })
    }

    fn text(&self) -> String {
        let s = &self.plan.expected;
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let _ = table.set_header(["parameter", "1 sigma expected", "unit"]);
        for (p, e) in self.estimates() {
            let sigma = e.sigma.map_or_else(|| "free".to_owned(), |s| significant(p.shown(s), 2));
            let _ = table.add_row([p.name.clone(), sigma, p.unit.clone()]);
        }
        let mut text = format!(
            "{} poses, {} um per reading; `--format csv` writes them as a file of measurements to be filled in\n{}\n{table}\n",
            self.plan.poses.len(),
            significant(s.sigma * 1e3, 3),
            self.csv()
        );
        text += &format!(
            "rank       {} of {} unknowns, {} well determined\n",
            s.rank,
            self.model.parameters().len(),
            s.well_determined
        );
        s.free().iter().for_each(|words| text += &format!("free       {words}\n"));
        s.drowned.iter().for_each(|words| text += &format!("drowned    {words}\n"));
        text
    }
}

/// Positions that a person can type in: 0.01 mm or deg, never `-0`.
fn rounded(q: f64) -> f64 {
    (q * 100.0).round() / 100.0 + 0.0
}
