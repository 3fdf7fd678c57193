//! The result of `enumerate` as text, JSON and CSV.

use super::view::{cell, table};
use crate::analysis::budget::{Bound, Statistic, known};
use crate::analysis::enumerate::{Ranking, Row, Standing};
use crate::cli::tool_poses::Reached;
use crate::cli::verbs::enumerate::Args;
use crate::machine::Machine;
use crate::units::significant;
use serde_json::json;

/// What arrangements are judged by.
pub(crate) enum By {
    Errors,
    Budget(Vec<Bound>),
}

/// What a study is made of, for those who read its result.
pub(crate) struct Setting<'a> {
    pub(crate) args: &'a Args,
    pub(crate) machine: &'a Machine,
    pub(crate) by: By,
    pub(crate) source: Option<String>,
    /// What the machine itself reaches of a file's tool poses.
    pub(crate) reached: Option<Reached>,
}

/// What is printed.
pub(crate) struct Report<'a> {
    pub(crate) setting: Setting<'a>,
    pub(crate) work: usize,
    pub(crate) ranking: Ranking,
}

impl Report<'_> {
    pub(crate) fn json(&self) -> serde_json::Value {
        let args = self.setting.args;
        let (by, samples, errors) = match &self.setting.by {
            By::Errors => ("errors", None, known(self.setting.machine)),
            By::Budget(bounds) => ("budget", Some(args.samples), bounds.len()),
        };
        let number = |(i, row): (usize, &Row)| {
            let mut json = row_json(row);
            if let Some(object) = json.as_object_mut() {
                let _ = object.insert("rank".to_owned(), (i + 1).into());
            }
            json
        };
        let mut json = json!({
            "machine": self.setting.machine.name(), "chain": self.setting.machine.chain().to_string(), "by": by,
            "class": args.tolerances.class, "class_source": self.setting.source, "errors": errors,
            "poses": self.work, "samples": samples, "seed": args.seed,
            "statistic": args.tolerances.statistic(), "reach": args.reach / 100.0,
            "arrangements": self.ranking.ranked.len() + self.ranking.short.len() + self.ranking.cannot_turn.len(),
            "ranked": self.ranking.ranked.iter().enumerate().map(number).collect::<Vec<_>>(),
            "reach_less": self.ranking.short.iter().map(row_json).collect::<Vec<_>>(),
            "cannot_turn_the_tool": self.ranking.cannot_turn.iter().map(|row| row.chain.clone()).collect::<Vec<_>>(),
        });
        if let (Some(object), Some(reached)) = (json.as_object_mut(), &self.setting.reached) {
            let _ = object.insert("tool_poses".to_owned(), reached.json());
        }
        json
    }

    /// One line for each arrangement.
    pub(crate) fn csv(&self) -> String {
        let mut csv = "rank,group,chain,on table,reached,um,low,high,mean,minus file [um]\n".to_owned();
        let r = &self.ranking;
        for (group, rows) in [("ranked", &r.ranked), ("reaches less", &r.short), ("cannot turn", &r.cannot_turn)] {
            for (i, row) in rows.iter().enumerate() {
                let rank = if group == "ranked" { (i + 1).to_string() } else { String::new() };
                let text = |x: Option<f64>| x.map_or(String::new(), |x| (x + 0.0).to_string());
                let result = row.result;
                let numbers = [
                    text(result.map(|r| r.um)),
                    text(result.and_then(|r| r.low)),
                    text(result.and_then(|r| r.high)),
                    text(result.and_then(|r| r.mean)),
                    text(result.map(|r| r.minus_file)),
                ];
                let head = format!("{rank},{group},{},{},{}", cell(&row.chain), row.table, row.reached);
                csv += &format!("{head},{}\n", numbers.join(","));
            }
        }
        csv
    }

    pub(crate) fn text(&self) -> String {
        let (args, r) = (self.setting.args, &self.ranking);
        let of_each = match args.tolerances.statistic() {
            Statistic::Max => "largest",
            Statistic::P95 => "95 %",
        };
        let mut text = format!(
            "{}: {} arrangements of its axes on {} {}\n",
            self.setting.machine.name(),
            r.ranked.len() + r.short.len() + r.cannot_turn.len(),
            self.work,
            self.setting.reached.as_ref().map_or_else(
                || format!("tool poses, drawn from the volume of {}", self.setting.machine.chain()),
                Reached::words
            )
        );
        text += &match &self.setting.by {
            By::Errors => format!(
                "Ranked by the {of_each} position deviation of the functional point, with the {} errors of the file\n",
                known(self.setting.machine)
            ),
            By::Budget(bounds) => format!(
                "Ranked by the 95 % value of {} drawn machines ({} bounded errors{}); counted is the {of_each} position deviation of each\n",
                args.samples,
                bounds.len(),
                self.setting.source.as_ref().map_or(String::new(), |source| format!(
                    ", class {}: {source}",
                    args.tolerances.class.as_deref().unwrap_or("")
                ))
            ),
        };
        text += &self.table(&r.ranked, true);
        if r.ranked.len() > args.top {
            text += &format!(
                "... and {} more (`--top {}`, or `--format csv`)\n",
                r.ranked.len() - args.top,
                r.ranked.len()
            );
        }
        if !r.short.is_empty() {
            text +=
                &format!("\n{} reach less than {} % of the tool poses:\n", r.short.len(), significant(args.reach, 4));
            text += &self.table(&r.short, false);
        }
        if !r.cannot_turn.is_empty() {
            let few: Vec<&str> = r.cannot_turn.iter().take(3).map(|row| row.chain.as_str()).collect();
            let dots = if r.cannot_turn.len() > 3 { ", ..." } else { "" };
            text += &format!("\n{} cannot turn the tool: {}{dots}\n", r.cannot_turn.len(), few.join(", "));
        }
        text + "Negative differences: less error than the arrangement of the file, on the same tool poses.\n"
    }

    fn table(&self, rows: &[Row], numbered: bool) -> String {
        let budget = matches!(self.setting.by, By::Budget(_));
        let mut header = vec![if numbered { "rank" } else { "" }, "arrangement", "reached", "um"];
        if budget {
            header.push("95 % confidence");
        }
        header.push("minus file's, um");
        let mut list = table(&header);
        let shown = if numbered { self.setting.args.top } else { self.setting.args.top.div_ceil(4) };
        for (i, row) in rows.iter().take(shown).enumerate() {
            let short = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 4));
            let result = row.result;
            let mut cells = vec![
                if numbered { (i + 1).to_string() } else { String::new() },
                row.chain.clone(),
                row.reached.to_string(),
                short(result.map(|r| r.um)),
            ];
            if budget {
                let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 4));
                cells.push(result.map_or("-".to_owned(), |r| format!("{}..{}", end(r.low), end(r.high))));
            }
            cells.push(short(result.map(|r| r.minus_file)));
            let _ = list.add_row(cells);
        }
        format!("{list}\n")
    }
}

fn row_json(row: &Row) -> serde_json::Value {
    let standing = row.standing == Standing::Judged;
    json!({
        "chain": row.chain, "on_table": row.table, "reached": row.reached, "unreachable": row.unreachable,
        "um": row.result.filter(|_| standing).map(|r| r.um), "low": row.result.and_then(|r| r.low),
        "high": row.result.and_then(|r| r.high), "mean": row.result.and_then(|r| r.mean),
        "minus_file": row.result.map(|r| r.minus_file),
    })
}
