//! What `abbe identify` prints.

use super::session::Session;
use crate::identify::{
    Estimate, Fit, Measurement, Parameter, Randomness, ReadingKind, Repeats, Residuals, Scatter, Solution,
};
use crate::machine::Machine;
use crate::units::significant;
use serde_json::json;

/// What is printed.
pub(crate) struct Report<'a> {
    pub machine: &'a Machine,
    /// The machine's parameters first.
    pub unknowns: &'a [Parameter],
    /// How many are the machine's.
    pub own: usize,
    pub data: &'a [Measurement],
    pub solution: Solution,
    pub residuals: Residuals,
    pub randomness: Vec<Randomness>,
    pub held_out: Option<f64>,
    pub repeats: Vec<Repeats>,
    pub fit: &'a Fit,
}

/// Beyond so many sigma 95 % is worth saying: less than 30 degrees of freedom.
const USUAL: f64 = 2.045;
/// Lines of one kind in the text; JSON has all.
const MAX_LINES: usize = 10;

/// A size (mm) in the unit of a kind of reading.
fn shown(kind: ReadingKind, mm: f64) -> String {
    let (unit, factor) = kind.unit();
    format!("{} {unit}", significant(mm * factor, 5))
}

fn um(mm: f64) -> f64 {
    mm * 1e3
}

impl Report<'_> {
    fn rows(&self) -> usize {
        self.fit.reduced.rows
    }

    fn estimates(&self) -> impl Iterator<Item = (&Parameter, &Estimate)> {
        self.unknowns.iter().zip(&self.solution.estimates)
    }

    /// The fit in a line.
    pub fn in_short(&self) -> String {
        let (rank, unknowns, rows) = (self.solution.rank, self.unknowns.len(), self.rows());
        let [before, after] = [self.residuals.before, self.residuals.after].map(|rms| significant(um(rms), 5));
        format!("rank {rank} of {unknowns} parameters from {rows} readings; rms {before} um before, {after} um after")
    }

    pub fn json(&self, session: &Session) -> serde_json::Value {
        let parameter = |(p, e): (&Parameter, &Estimate)| json!({"name": p.name, "value": p.shown(e.value) + 0.0, "sigma": e.sigma.map(|s| p.shown(s)), "unit": p.unit, "coverage_factor_95": e.coverage, "valuation": e.valuation});
        let outlier = |o: &crate::identify::Outlier| json!({"place": self.place(session, o.row), "residual_um": um(o.residual), "deviations": o.deviations});
        let (s, r) = (&self.solution, &self.residuals);
        json!({
            "rows": self.rows(), "points": self.data.len(),
            "parameters": self.estimates().take(self.own).map(parameter).collect::<Vec<_>>(),
            "instruments": self.estimates().skip(self.own).map(parameter).collect::<Vec<_>>(),
            "rank": s.rank, "unknowns": self.unknowns.len(), "well_determined": s.well_determined,
            "null_space": s.null_space, "drowned": s.drowned, "condition": s.condition, "valuation": s.valuation,
            "singular_values": s.singular_values,
            "rms_um": {"before": um(r.before), "after": um(r.after), "held_out": self.held_out.map(um)},
            "sigma_um": self.fit.scatter.is_empty().then(|| um(s.sigma)), "degrees_of_freedom": s.freedom,
            "scatter": self.fit.scatter.iter().map(|s| json!({"of": s.of.map_or("uncertainties given", ReadingKind::word), "sigma_um": um(s.sigma)})).collect::<Vec<_>>(),
            "repeatability_um": self.repeats.first().map(|r| um(r.sigma)),
            "repeats": self.repeats.iter().map(|r| json!({"of": r.of.word(), "sigma_um": um(r.sigma), "degrees_of_freedom": r.freedom})).collect::<Vec<_>>(),
            "orders_um": {"first": um(r.parts[0]), "second": um(r.parts[1]), "higher": um(r.parts[2]),
                          "left_by_first": um(r.left[0]), "left_by_second": um(r.left[1])},
            "kinds": r.kinds.iter().map(|(kind, rows, rms)| json!({"kind": kind.word(), "rows": rows, "rms_um": um(*rms)})).collect::<Vec<_>>(),
            "residual_tests": self.randomness.iter().map(|t| json!({"of": t.name(), "count": t.count, "normality": t.normality, "runs": t.runs, "lag1": t.lag1})).collect::<Vec<_>>(),
            "outliers": r.outliers.iter().map(outlier).collect::<Vec<_>>(),
            "steps": self.fit.steps, "settled": self.fit.settled,
        })
    }

    pub fn place(&self, session: &Session, row: usize) -> String {
        let place = &self.data[row].place;
        let sources = &session.diagnostics.sources;
        format!("{}:{}", sources.name(place.source), sources.line_column(place).0)
    }

    pub fn csv(&self) -> String {
        let row = |(p, e): (&Parameter, &Estimate)| {
            let sigma = e.sigma.map_or_else(String::new, |s| p.shown(s).to_string());
            format!("{},{},{sigma},{}", p.name, p.shown(e.value) + 0.0, p.unit)
        };
        std::iter::once("name,value,sigma,unit".to_owned())
            .chain(self.estimates().map(row))
            .collect::<Vec<_>>()
            .join("\n")
    }

    pub fn text(&self, session: &Session) -> String {
        let mut table = comfy_table::Table::new();
        let _ = table.load_style(comfy_table::presets::ASCII_MARKDOWN);
        let _ = table.set_header(["parameter", "value", "1 sigma", "unit"]);
        for (p, e) in self.estimates() {
            let none = if self.solution.freedom > 0 { "free" } else { "unknown" };
            let sigma = e.sigma.map_or_else(|| none.to_owned(), |s| significant(p.shown(s), 2));
            // What is left of a direction that was held is rounding.
            let value = Some(p.shown(e.value)).filter(|v| v.abs() >= 1e-6).unwrap_or(0.0);
            let _ = table.add_row([p.name.clone(), significant(value, 5), sigma, p.unit.clone()]);
        }
        format!("{}: fitted to {} points\n{table}\n{}", self.machine.name(), self.data.len(), self.summary(session))
    }

    /// What a reading scatters by, on its line or on one of its own.
    fn scatter(&self) -> String {
        let given = |sigma: f64| format!("{} times the uncertainty given", significant(um(sigma), 4));
        let one = |s: &Scatter| match s.of {
            Some(kind) => format!("{} of {}", shown(kind, s.sigma), kind.word()),
            None => given(s.sigma),
        };
        let kind = match &self.residuals.kinds[..] {
            [(kind, ..)] => *kind,
            _ => ReadingKind::Deviation,
        };
        match &self.fit.scatter[..] {
            [] if self.data.iter().all(|m| m.known) => format!("; {} per reading", given(self.solution.sigma)),
            [] => format!("; {} per reading", shown(kind, self.solution.sigma)),
            list => format!("\nscatter    per reading {}", list.iter().map(one).collect::<Vec<_>>().join(", ")),
        }
    }

    fn summary(&self, session: &Session) -> String {
        let (s, r) = (&self.solution, &self.residuals);
        let n = |mm: f64| significant(um(mm), 5);
        let mut text = format!(
            "rank       {} of {} unknowns from {} readings, {} well determined, condition {}, valuation {}\n\
             rms        {} um before, {} um after{}\n\
             orders     first {} um, second {} um, higher {} um; first alone leaves {} um, with the second {} um\n",
            s.rank,
            self.unknowns.len(),
            self.rows(),
            s.well_determined,
            significant(s.condition, 3),
            significant(s.valuation, 3),
            n(r.before),
            n(r.after),
            self.scatter(),
            n(r.parts[0]),
            n(r.parts[1]),
            n(r.parts[2]),
            n(r.left[0]),
            n(r.left[1]),
        );
        if r.kinds.len() > 1 {
            let parts =
                r.kinds.iter().map(|(kind, rows, rms)| format!("{} of {rows} {}", shown(*kind, *rms), kind.word()));
            text += &format!("kinds      {}\n", parts.collect::<Vec<_>>().join(", "));
        }
        for t in &self.randomness {
            text += &format!(
                "noise      {}: normal p = {}, signs by chance p = {}, correlation with the one before {}\n",
                t.name(),
                significant(t.normality, 2),
                significant(t.runs, 2),
                significant(t.lag1, 2)
            );
        }
        if let Some((least, most)) = s.coverage().filter(|(_, most)| *most > USUAL) {
            let [least, most] = [least, most].map(|reach| significant(reach, 4));
            let reach = if least == most { most } else { format!("{least} to {most}") };
            text += &format!("intervals  95 % reach {reach} sigma\n");
        }
        if let Some(held_out) = self.held_out {
            text += &format!("held out   {} um on points that were not used\n", n(held_out));
        }
        for Repeats { of, sigma, freedom, .. } in &self.repeats {
            let of = if self.residuals.kinds.len() > 1 { format!(" of {}", of.word()) } else { String::new() };
            let size = n(*sigma);
            text +=
                &format!("repeated   {size} um per reading{of} where a pose was measured again ({freedom} times)\n");
        }
        s.free().iter().for_each(|words| text += &format!("free       {words}\n"));
        s.drowned.iter().take(MAX_LINES).for_each(|words| text += &format!("drowned    {words}\n"));
        if s.drowned.len() > MAX_LINES {
            text += &format!("           and {} more combinations (--format json)\n", s.drowned.len() - MAX_LINES);
        }
        for outlier in r.outliers.iter().take(MAX_LINES) {
            let size = significant(outlier.deviations, 3);
            text +=
                &format!("outlier    {}: {} um, {size} sigma\n", self.place(session, outlier.row), n(outlier.residual));
        }
        if r.outliers.len() > MAX_LINES {
            text += &format!("           and {} more\n", r.outliers.len() - MAX_LINES);
        }
        text
    }
}
