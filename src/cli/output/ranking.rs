//! The result of `enumerate` as text and CSV.

use super::view::{cell, table, tool_poses_text};
use abbe::options::{JudgedBy, Statistic};
use abbe::results::{ArrangementRow, NeededRange, PairedDifference, RankedArrangements, Verdict};
use abbe::text::significant;

/// One line for each arrangement.
pub(crate) fn csv(of: &RankedArrangements) -> String {
    let mut csv = "rank,group,chain,on table,reached,um,low,high,mean,minus file [um],not stated,samples,versus first,\
                   minus first [um],minus first low,minus first high,travel\n"
        .to_owned();
    let r = &of.ranking;
    for (group, rows) in [
        ("ranked", &r.ranked),
        ("reaches less", &r.short),
        ("geometry not stated", &r.not_stated),
        ("cannot turn", &r.cannot_turn),
    ] {
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
            let samples = result.and_then(|r| r.samples).map_or(String::new(), |samples| samples.to_string());
            let versus = result.and_then(|r| r.versus_first);
            let difference = versus.map(|versus| versus.minus_first);
            let travel = row.travel.iter().map(|t| format!("{} {} {}", t.axis, t.min + 0.0, t.max + 0.0));
            let travel = travel.collect::<Vec<_>>().join("; ");
            let tail = [
                cell(&row.not_stated.join(" ")).to_string(),
                samples,
                versus.map_or(String::new(), |versus| versus.verdict.words().to_owned()),
                text(difference.map(|d| d.value)),
                text(difference.and_then(|d| d.low)),
                text(difference.and_then(|d| d.high)),
                cell(&travel).to_string(),
            ];
            csv += &format!("{head},{},{}\n", numbers.join(","), tail.join(","));
        }
    }
    csv
}

pub(crate) fn text(of: &RankedArrangements, top: usize) -> String {
    let r = &of.ranking;
    let of_each = match of.statistic {
        Statistic::Max => "largest",
        Statistic::P95 => "95 %",
    };
    let mut text = format!(
        "{}: {} arrangements of its axes on {} {}\n",
        of.machine,
        of.arrangements(),
        of.poses,
        of.tool_poses
            .as_ref()
            .map_or_else(|| format!("tool poses, drawn from the volume of {}", of.chain), tool_poses_text)
    );
    text += &match of.by {
        JudgedBy::Errors => format!(
            "Ranked by the {of_each} position deviation of the functional point, with the {} errors of the file\n",
            of.errors
        ),
        JudgedBy::Budget => format!(
            "Ranked by the 95 % value of {} to {} drawn machines ({} bounded errors{}); counted is the {of_each} \
             position deviation of each\n",
            of.samples,
            of.rounds.last().map_or(of.samples, |round| round.samples),
            of.errors,
            of.class_source
                .as_ref()
                .map_or(String::new(), |source| format!(", class {}: {source}", of.class.as_deref().unwrap_or("")))
        ),
    };
    text += &arrangements(of, &r.ranked, true, top);
    text += &standing(of);
    if r.ranked.len() > top {
        text += &format!("... and {} more (`--top {}`, or `--format csv`)\n", r.ranked.len() - top, r.ranked.len());
    }
    if !r.short.is_empty() {
        text +=
            &format!("\n{} reach less than {} % of the tool poses:\n", r.short.len(), significant(of.reach_percent, 4));
        text += &arrangements(of, &r.short, false, top);
    }
    if !r.not_stated.is_empty() {
        text += &format!(
            "\n{} have axes whose geometry is not stated for the side where they stand; they are not ranked:\n",
            r.not_stated.len()
        );
        text += &arrangements(of, &r.not_stated, false, top);
    }
    if !r.cannot_turn.is_empty() {
        let few: Vec<&str> = r.cannot_turn.iter().take(3).map(|row| row.chain.as_str()).collect();
        let dots = if r.cannot_turn.len() > 3 { ", ..." } else { "" };
        text += &format!("\n{} cannot turn the tool: {}{dots}\n", r.cannot_turn.len(), few.join(", "));
    }
    text + "Negative differences: less error than the arrangement of the file, on the same tool poses.\n"
}

/// Confidence of the ranks, and the machines drawn for it.
fn standing(of: &RankedArrangements) -> String {
    let (equal, open, worse) = (of.count(Verdict::Equal), of.count(Verdict::NotToldApart), of.count(Verdict::Worse));
    let mut text = format!("Against rank 1: {equal} equal to it, {open} not told apart from it, {worse} worse\n");
    if of.by != JudgedBy::Budget || of.ranking.ranked.is_empty() {
        return text;
    }
    let first = if of.first == 1 { "Rank 1 is".to_owned() } else { format!("The first {} ranks are", of.first) };
    text += &if of.told_apart {
        format!("{first} told apart from all that are not equal, with 95 % confidence for all together\n")
    } else {
        format!("{first} not told apart from all others with {} machines (`--max-samples`)\n", of.max_samples)
    };
    let rounds: Vec<String> =
        of.rounds.iter().map(|round| format!("{} with {} machines", round.arrangements, round.samples)).collect();
    let (drawn, without) = of.drawn();
    let percent = if without > 0 { 100.0 * (1.0 - drawn as f64 / without as f64) } else { 0.0 };
    text + &format!(
        "Rounds: {}; {drawn} draws of a machine, {} % fewer than with the last number for all\n",
        rounds.join(", "),
        significant(percent, 3)
    )
}

fn arrangements(of: &RankedArrangements, rows: &[ArrangementRow], numbered: bool, top: usize) -> String {
    let budget = of.by == JudgedBy::Budget;
    let mut header = vec![if numbered { "rank" } else { "" }, "arrangement", "reached", "um"];
    if budget {
        header.push("95 % confidence");
    }
    header.push("minus file's, um");
    if numbered {
        header.push("minus rank 1, um");
        header.push("against rank 1");
    }
    let apart = rows.iter().any(|row| !row.not_stated.is_empty());
    if apart {
        header.push("not stated");
    }
    let sized = rows.iter().any(|row| !row.travel.is_empty());
    if sized {
        header.push("travel needed, mm or deg");
    }
    let mut list = table(&header);
    let shown = if numbered { top } else { top.div_ceil(4) };
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
        if numbered {
            let versus = result.and_then(|r| r.versus_first);
            cells.push(versus.map_or("-".to_owned(), |versus| difference(versus.minus_first)));
            cells.push(versus.map_or("-".to_owned(), |versus| versus.verdict.words().to_owned()));
        }
        if apart {
            cells.push(row.not_stated.join(", "));
        }
        if sized {
            let length = |t: &NeededRange| format!("{} {}", t.axis, significant(t.max - t.min, 4));
            cells.push(row.travel.iter().map(length).collect::<Vec<_>>().join(", "));
        }
        let _ = list.add_row(cells);
    }
    format!("{list}\n")
}

/// A difference with its interval.
pub(crate) fn difference(of: PairedDifference) -> String {
    let end = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 3));
    if of.low.is_none() && of.high.is_none() || of.low == of.high {
        return significant(of.value, 3);
    }
    format!("{} ({}..{})", significant(of.value, 3), end(of.low), end(of.high))
}
