//! The result of `enumerate` as text and CSV.

use super::budget_text::{coverage_line, values_text};
use super::view::{hide, table};
use abbe::options::{JudgedBy, Statistic};
use abbe::results::{
    Arrangement, ExcludedArrangements, PairedDifference, RankedArrangements, RankingRounds, ReachedToolPoses, Verdict,
};
use abbe::text::{by_uncertainty, cell, fold, shown, significant, within};
use indexmap::IndexMap;

pub(crate) fn csv(of: &RankedArrangements) -> String {
    let mut csv =
        "rank,group,chain,on table,reached,um,low [um],high [um],mean [um],minus file [um],not stated,samples,\
                   versus first,minus first [um],minus first low [um],minus first high [um],travel [mm or deg],\
                   best fit [um],best fit minus first [um],withheld,rewinds\n"
            .to_owned();
    for (group, rows) in [
        ("ranked", &of.ranked),
        ("reaches less", &of.reach_less),
        ("geometry not stated", &of.geometry_not_stated),
        ("cannot turn", &of.cannot_turn_the_tool),
    ] {
        for row in rows {
            let rank = row.rank.map_or(String::new(), |rank| rank.to_string());
            let text = |x: Option<f64>| x.map_or(String::new(), |x| (x + 0.0).to_string());
            let numbers = [row.um, row.low, row.high, row.mean, row.minus_file].map(text);
            let head = format!("{rank},{group},{},{},{}", cell(&row.chain), row.on_table, row.reached);
            let samples = row.samples.map_or(String::new(), |samples| samples.to_string());
            let versus = row.versus_first;
            let difference = versus.map(|versus| versus.minus_first);
            let travel = row.travel.iter().map(|(axis, [min, max])| format!("{axis} {min} {max}"));
            let travel = travel.collect::<Vec<_>>().join("; ");
            let tail = [
                cell(&row.not_stated.join(" ")).to_string(),
                samples,
                row.verdict().map_or(String::new(), |verdict| verdict.words().to_owned()),
                text(difference.map(|d| d.value)),
                text(difference.and_then(|d| d.low)),
                text(difference.and_then(|d| d.high)),
                cell(&travel).to_string(),
                text(row.best_fit.map(|fit| fit.um)),
                text(row.best_fit.and_then(|fit| fit.versus_first).map(|versus| versus.minus_first.value)),
                cell(row.withheld.as_deref().unwrap_or_default()).to_string(),
                row.rewinds.map_or(String::new(), |rewinds| rewinds.to_string()),
            ];
            csv += &format!("{head},{},{}\n", numbers.join(","), tail.join(","));
        }
    }
    csv
}

pub(crate) fn text(of: &RankedArrangements, top: usize) -> String {
    let of_each = match of.statistic {
        Statistic::Max => "largest",
        Statistic::P95 => "95 %",
    };
    let mut text = match of.ranked.is_empty() {
        true => format!("{}\n", most(of)),
        false => abbe::headlines::enumerate(of),
    };
    text += &format!(
        "{}: {} arrangements of its axes on {} {}\n",
        of.machine,
        of.arrangements,
        of.poses,
        of.tool_poses.as_ref().map_or_else(|| format!("tool poses, drawn from the volume of {}", of.chain), work_text)
    );
    let samples = of.samples.unwrap_or(0);
    text += &match of.by {
        JudgedBy::Errors => format!(
            "Ranked by the {of_each} position deviation of the functional point, with the {} errors of the file\n",
            of.errors
        ),
        JudgedBy::Budget => format!(
            "Ranked by the 95 % value of {samples} to {} drawn machines ({} bounded errors{}); counted is the \
             {of_each} position deviation of each\n",
            of.rounds.as_ref().and_then(|rounds| rounds.done.last()).map_or(samples, |round| round.samples),
            of.errors,
            of.class_source
                .as_ref()
                .map_or(String::new(), |source| format!(", class {}: {source}", of.class.as_deref().unwrap_or("")))
        ),
    };
    text += &values_text(of.left_out, None);
    let missing = of.coverage.as_ref().filter(|coverage| !coverage.missing.is_empty());
    text += &missing.and_then(coverage_line).map_or_else(String::new, |line| line + "\n");
    text += &of.over.text();
    text += &match of.ranked.is_empty() {
        true => String::new(),
        false => arrangements(of, &of.ranked, true, top) + &standing(of),
    };
    if of.ranked.len() > top {
        text += &format!("... and {} more (`--top {}`, or `--format csv`)\n", of.ranked.len() - top, of.ranked.len());
    }
    if !of.reach_less.is_empty() {
        text += &format!(
            "\n{} miss some of the tool poses and have no rank; those that reach {} % come first, by their difference \
             to the file's arrangement on the poses that both reach:\n",
            of.reach_less.len(),
            significant(of.reach * 100.0, 4)
        );
        text += &arrangements(of, &of.reach_less, false, top);
    }
    if !of.geometry_not_stated.is_empty() {
        text += &format!(
            "\n{} have axes whose geometry is not stated for the side where they stand; they are not ranked:\n",
            of.geometry_not_stated.len()
        );
        text += &arrangements(of, &of.geometry_not_stated, false, top);
    }
    let cannot_turn = &of.cannot_turn_the_tool;
    if !cannot_turn.is_empty() {
        let few: Vec<&str> = cannot_turn.iter().take(3).map(|row| row.chain.as_str()).collect();
        let dots = if cannot_turn.len() > 3 { ", ..." } else { "" };
        text += &format!("\n{} cannot turn the tool: {}{dots}\n", cannot_turn.len(), few.join(", "));
    }
    if !of.not_buildable.is_empty() {
        let rule = |rule: &ExcludedArrangements| format!("{} break \"{}\"", rule.arrangements, rule.rule);
        let rules: Vec<String> = of.not_buildable.iter().map(rule).collect();
        text += &format!("\nLeft out as hardly built: {} (`--buildable no` lists them)\n", rules.join(", "));
    }
    text + &arrangement_of_file(of, top)
        + "Negative differences: less error than the arrangement of the file, on the same tool poses.\n"
}

/// The line of the arrangement of the file, to which differences are stated, if it is in no table.
fn arrangement_of_file(of: &RankedArrangements, top: usize) -> String {
    let place = |rows: &[Arrangement]| rows.iter().position(|row| row.chain == of.chain);
    let um = |row: &Arrangement| row.um.map_or_else(String::new, |um| format!(", {} um", significant(um, 4)));
    match (place(&of.ranked), place(&of.reach_less)) {
        (Some(i), _) if i >= top => format!("The file's arrangement: rank {}{}\n", i + 1, um(&of.ranked[i])),
        (None, Some(i)) if i >= top.div_ceil(4) => {
            let row = &of.reach_less[i];
            format!("The file's arrangement reaches {} of {} tool poses{}\n", row.reached, of.poses, um(row))
        }
        _ => String::new(),
    }
}

/// The tool poses of a file, all of which count.
fn work_text(reached: &ReachedToolPoses) -> String {
    let missed = match reached.rows.len() {
        0 => String::new(),
        n => format!(", of which the file's arrangement misses {n}"),
    };
    format!("tool poses of {}{missed}", shown(&reached.file))
}

/// The arrangement that reaches the most, where none reaches all.
fn most(of: &RankedArrangements) -> String {
    let most = of.reach_less.iter().rev().max_by_key(|row| row.reached);
    let words = |row: &Arrangement| format!("; the most is {}, by {}", row.reached, row.chain);
    format!("No arrangement reaches all {} tool poses{}", of.poses, most.map_or_else(String::new, words))
}

/// Confidence of the ranks, and the machines drawn for it.
fn standing(of: &RankedArrangements) -> String {
    let (equal, open, worse) = (of.count(Verdict::Equal), of.count(Verdict::NotToldApart), of.count(Verdict::Worse));
    let mut text = format!("Against rank 1: {equal} equal to it, {open} not told apart from it, {worse} worse\n");
    let mut reasons: IndexMap<&str, usize> = IndexMap::new();
    for reason in of.ranked.iter().filter_map(|row| row.withheld.as_deref()) {
        let fit = reason.ends_with("with the best fit");
        let reason = if fit { "machine coordinates and best fit do not agree on them" } else { reason };
        *reasons.entry(reason).or_default() += 1;
    }
    let line = |(reason, count): (&str, usize)| fold(&format!("{count} without a verdict: {reason}"));
    let withheld: usize = reasons.values().sum();
    let judged = if withheld == 0 { "" } else { " that have a verdict and" };
    text.extend(reasons.into_iter().map(line));
    let Some(RankingRounds { max_samples, first, told_apart, done, drawn, drawn_without_elimination }) =
        of.rounds.as_ref().filter(|_| !of.ranked.is_empty())
    else {
        return text;
    };
    let first = if *first == 1 { "Rank 1 is".to_owned() } else { format!("The first {first} ranks are") };
    text += &if withheld > 0 && withheld + 1 >= of.ranked.len() {
        String::new()
    } else if *told_apart {
        format!("{first} told apart from all{judged} that are not equal, with 95 % confidence for all together\n")
    } else {
        format!("{first} not told apart from all others with {max_samples} machines (`--max-samples`)\n")
    };
    let rounds: Vec<String> =
        done.iter().map(|round| format!("{} with {} machines", round.arrangements, round.samples)).collect();
    let without = *drawn_without_elimination;
    let percent = if without > 0 { 100.0 * (1.0 - *drawn as f64 / without as f64) } else { 0.0 };
    text + &format!(
        "Rounds: {}; {drawn} draws of a machine, {} % fewer than with the last number for all\n",
        rounds.join(", "),
        significant(percent, 3)
    )
}

fn arrangements(of: &RankedArrangements, rows: &[Arrangement], numbered: bool, top: usize) -> String {
    let budget = of.by == JudgedBy::Budget;
    let mut header = vec![if numbered { "rank" } else { "" }, "arrangement", "reached", "um"];
    if budget {
        header.push("95 % confidence");
    }
    header.push("minus file's, um");
    let fitted = rows.iter().any(|row| row.best_fit.is_some());
    if fitted {
        header.push("best fit, um");
    }
    if numbered {
        header.push("minus rank 1, um");
        header.push("against rank 1");
    }
    let apart = rows.iter().any(|row| !row.not_stated.is_empty());
    if apart {
        header.push("not stated");
    }
    let wound = rows.iter().any(|row| row.rewinds.is_some());
    if wound {
        header.push("rewinds");
    }
    let sized = rows.iter().any(|row| !row.travel.is_empty());
    if sized {
        header.push("travel needed, mm or deg");
    }
    let mut list = table(&header);
    let shown = if numbered { top } else { top.div_ceil(4) };
    for (i, row) in rows.iter().take(shown).enumerate() {
        let short = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 4));
        let mut cells = vec![
            if numbered { (i + 1).to_string() } else { String::new() },
            row.chain.clone(),
            if row.misses_reference { format!("{}, no zero", row.reached) } else { row.reached.to_string() },
        ];
        match row.um.filter(|_| budget).map(|um| by_uncertainty(um, row.low, row.high)) {
            Some([um, low, high]) => cells.extend([um, format!("{low}..{high}")]),
            None if budget => cells.extend(["-".to_owned(), "-".to_owned()]),
            None => cells.push(short(row.um)),
        }
        cells.push(short(row.minus_file));
        if fitted {
            cells.push(short(row.best_fit.map(|fit| fit.um)));
        }
        if numbered {
            let versus = row.versus_first;
            cells.push(versus.map_or("-".to_owned(), |versus| difference(versus.minus_first)));
            let verdict = row.verdict().map_or("no verdict", Verdict::words);
            cells.push(versus.map_or("-".to_owned(), |_| verdict.to_owned()));
        }
        if apart {
            cells.push(row.not_stated.join(", "));
        }
        if wound {
            cells.push(row.rewinds.map_or("-".to_owned(), |rewinds| rewinds.to_string()));
        }
        if sized {
            let length = |(axis, [min, max]): (&String, &[f64; 2])| format!("{axis} {}", significant(max - min, 4));
            cells.push(row.travel.iter().map(length).collect::<Vec<_>>().join(", "));
        }
        let _ = list.add_row(cells);
    }
    let wide: Vec<usize> =
        (0..header.len()).filter(|i| ["minus file's, um", "minus rank 1, um"].contains(&header[*i])).collect();
    hide(&mut list, if numbered { &wide[..] } else { &[] });
    format!("{list}\n")
}

pub(crate) fn difference(of: PairedDifference) -> String {
    if of.low.is_none() && of.high.is_none() || of.low == of.high {
        return significant(of.value, 3);
    }
    within(of.value, of.low, of.high)
}
