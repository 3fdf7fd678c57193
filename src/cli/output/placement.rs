//! Places of a part: the best ones as text, all of them as CSV, and the picture.

use super::session::Session;
use super::view::table;
use crate::cli::Outcome;
use crate::cli::arguments::PictureFile;
use abbe::options::Placement;
use abbe::results::{
    CommonFigures, LimitVerdict, PairedDifference, PlaceRange, PlacementGain, PlacementResult, TriedPlace, VersusFirst,
};
use abbe::text::{fold, significant, within};

/// Number of the best places that are listed.
const LISTED: usize = 5;

/// Columns of a terminal.
const COLUMNS: usize = 80;

/// Writes the pictures and prints the places.
pub(crate) fn show<'a>(
    session: &mut Session,
    of: &PlacementResult,
    pictures: impl Iterator<Item = &'a PictureFile>,
) -> Outcome {
    for to in pictures {
        to.write(&of.picture(), session)?;
    }
    session.show(of, || csv(of), || text(of))
}

fn csv(of: &PlacementResult) -> String {
    let mut text = "X [mm],Y [mm],Z [mm],A [deg],B [deg],C [deg],own,reached,share,rewinds,margin [mm],reference,\
                    p95 [um],max [um],rank"
        .to_owned();
    if of.from.is_some() {
        text += ",um,low [um],high [um],minus first [um],minus first low [um],minus first high [um],versus first,limit";
    }
    text += "\n";
    for tried in &of.tried {
        let Placement { origin: [x, y, z], rotation: [a, b, c] } = tried.place;
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let count = |value: Option<usize>| value.map_or_else(String::new, |value| value.to_string());
        let flag = |value: bool| u8::from(value).to_string();
        let mut cells = vec![
            [x, y, z, a, b, c].map(|x| x.to_string()).join(","),
            flag(tried.own),
            tried.reached.to_string(),
            tried.share.to_string(),
            count(tried.rewinds),
            number(tried.margin_mm),
            flag(tried.reaches_reference),
            number(tried.p95_um),
            number(tried.max_um),
            count(tried.rank),
        ];
        if of.from.is_some() {
            let versus = tried.versus_first;
            let minus = versus.map(|versus| versus.minus_first);
            let numbers = [
                tried.um,
                tried.interval_um.map(|[low, _]| low),
                tried.interval_um.map(|[_, high]| high),
                minus.map(|of| of.value),
                minus.and_then(|of| of.low),
                minus.and_then(|of| of.high),
            ];
            cells.extend(numbers.map(number));
            cells.push(versus.map_or_else(String::new, |versus| versus.verdict.words().to_owned()));
            cells.push(tried.limit.as_ref().map_or_else(String::new, |limit| limit_word(limit).to_owned()));
        }
        text += &(cells.join(",") + "\n");
    }
    text
}

/// The verdict on the limit of the job in a word.
fn limit_word(limit: &LimitVerdict) -> &'static str {
    match limit.held {
        Some(true) => "held",
        Some(false) => "exceeded",
        None => "not decided",
    }
}

fn text(of: &PlacementResult) -> String {
    let what = match of.from {
        Some("bounds") => "position deviation that the bounds lead to",
        Some(_) => "position deviation",
        None => "reach of the nominal machine",
    };
    let mut text = format!("{}: places of the part, {what}\n{}", of.machine, of.over.text());
    text += &of.figure_words().map_or_else(String::new, |words| fold(&format!("Figure: {words}")));
    text += &of.drawing.as_ref().map_or_else(String::new, |of| format!("{}{}\n", of.words(), of.class_words()));
    let count: usize = of.ranges.iter().map(|range| range.count).product();
    let own = if of.places > count { " and the file's own" } else { "" };
    let ranges = of.ranges.iter().map(range).collect::<Vec<_>>().join(", ");
    text += &fold(&format!("{count} places{own}: {ranges}"));
    let all = of.over.poses;
    text += &match of.best.as_ref().map(|best| best.reached) {
        None => "None of them reaches a tool pose.\n".to_owned(),
        Some(most) => fold(&format!(
            "{} {all} tool poses; ranked, with the same {most} in reach: {}",
            if of.reach_all == 0 {
                "No place reaches all".to_owned()
            } else {
                format!("{} places reach all", of.reach_all)
            },
            of.ranked
        )),
    };
    text += &format!("\n{}\n", rows(of));
    text += &standing(of);
    if let (Some(best), Some(gain)) = (&of.best, &of.gain) {
        text += &fold(&gained(of, best, gain));
        if !of.at_end_of.is_empty() {
            let ends = of.at_end_of.join(", ");
            text += &fold(&format!("It is at an end of {ends}: a wider range may have a better one."));
        }
        text += &format!("In the job file:\n  {}\n", line(&best.place));
    }
    text
}

/// The ranked places by the machines drawn, and the limit of the job at the best place and at its own.
fn standing(of: &PlacementResult) -> String {
    let mut text = String::new();
    let others = of.tried.iter().filter(|of| of.versus_first.is_some()).count().saturating_sub(1);
    if let Some(open) = of.not_told_apart.filter(|_| others > 0) {
        let rest = if open == others { "" } else { "; the others are worse, with 95 % confidence for all together" };
        text += &fold(&format!("Not told apart from the first by the machines drawn: {open} of {others}{rest}"));
    }
    let best = of.best.as_ref().filter(|best| !best.own).map(|best| ("best place", best));
    for (name, tried) in best.into_iter().chain([("file's own", &of.own)]) {
        text += &tried.limit.as_ref().map_or_else(String::new, |of| fold(&format!("Job, {name}: {}", of.words())));
    }
    text
}

/// The line of a job file.
fn line(place: &Placement) -> String {
    let list = |numbers: &[f64; 3]| numbers.map(|x| x.to_string()).join(", ");
    format!("place: {{ origin: [{}], rotation: [{}] }}", list(&place.origin), list(&place.rotation))
}

fn range(of: &PlaceRange) -> String {
    let [first, last] = of.ends.map(|x| significant(x, 6));
    match of.count {
        1 => format!("{} {first} {}", of.of, of.unit),
        count => format!("{} {first} .. {last} {} ({count})", of.of, of.unit),
    }
}

/// A column of the table, and the cell of a place.
type Column<'a> = (String, Box<dyn Fn(&TriedPlace) -> String + 'a>);

/// The best places and that of the job; the last columns go where the table is too wide for a terminal.
fn rows(of: &PlacementResult) -> comfy_table::Table {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(value, 4));
    let rank = |of: &TriedPlace| {
        let rank = of.rank.map_or("-".to_owned(), |rank| rank.to_string());
        if of.own { rank + ", file" } else { rank }
    };
    let mut columns: Vec<Column<'_>> = vec![("rank".to_owned(), Box::new(rank))];
    for range in &of.ranges {
        let head = format!("{}, {}", range.of, range.unit);
        columns.push((head, Box::new(|of| significant(range.of_place(&of.place), 6))));
    }
    columns.push(("reached".to_owned(), Box::new(|of| of.reached.to_string())));
    if of.over.path {
        columns.push(("rewinds".to_owned(), Box::new(|of| of.rewinds.map_or("-".to_owned(), |n| n.to_string()))));
    }
    if of.not_told_apart.is_some() {
        columns.push(("figure, um".to_owned(), Box::new(move |of| number(of.um))));
        let minus =
            |of: &TriedPlace| of.versus_first.map_or("-".to_owned(), |versus| difference_words(versus.minus_first));
        columns.push(("minus first".to_owned(), Box::new(minus)));
        let verdict = |of: &TriedPlace| of.versus_first.map_or("-", |versus| versus.verdict.words()).to_owned();
        columns.push(("against first".to_owned(), Box::new(verdict)));
    } else if of.from.is_some() {
        columns.push(("95 %, um".to_owned(), Box::new(move |of| number(of.p95_um))));
        columns.push(("max, um".to_owned(), Box::new(move |of| number(of.max_um))));
    }
    columns.push(("margin, mm".to_owned(), Box::new(move |of| number(of.margin_mm))));
    let mut listed: Vec<&TriedPlace> = of.tried.iter().filter(|of| of.rank.is_some_and(|n| n <= LISTED)).collect();
    listed.sort_by_key(|of| of.rank);
    if !listed.iter().any(|of| of.own) {
        listed.push(&of.own);
    }
    loop {
        let mut rows = table(&columns.iter().map(|(head, _)| head.as_str()).collect::<Vec<_>>());
        let _ = rows.add_rows(listed.iter().map(|of| columns.iter().map(|(_, cell)| cell(of)).collect::<Vec<_>>()));
        if rows.lines().all(|line| line.chars().count() <= COLUMNS) || columns.len() <= of.ranges.len() + 2 {
            return rows;
        }
        let _ = columns.pop();
    }
}

/// The gain of the best place over that of the job, in words.
fn gained(of: &PlacementResult, best: &TriedPlace, gain: &PlacementGain) -> String {
    if best.own {
        return "The file's own place is the best of them.".to_owned();
    }
    let counted = |n: i64, noun: &str, more: &str, less: &str| {
        let plural = if n.abs() == 1 { "" } else { "s" };
        (n != 0).then(|| format!("{} {noun}{plural} {}", n.abs(), if n > 0 { more } else { less }))
    };
    let mut words: Vec<String> = counted(gain.poses, "tool pose", "more", "fewer").into_iter().collect();
    words.extend(gain.rewinds.and_then(|n| counted(n, "rewind", "fewer", "more")));
    words.extend(gain.common.as_ref().map(|common| figures(common, of)));
    words.extend(best.margin_mm.zip(of.own.margin_mm).map(|(best, own)| {
        format!("margin to the ends of travel {} mm instead of {}", significant(best, 4), significant(own, 4))
    }));
    if !of.own.reaches_reference {
        words.push("the reference, which the file's own place does not reach".to_owned());
    }
    format!("Best place against the file's own: {}.", words.join("; "))
}

/// A difference with its interval.
fn difference_words(of: PairedDifference) -> String {
    within(of.value, of.low, of.high)
}

fn figures(of: &CommonFigures, places: &PlacementResult) -> String {
    let is_all = of.poses == places.over.poses;
    let on = if is_all { String::new() } else { format!(" (on the {} tool poses that both reach)", of.poses) };
    if places.not_told_apart.is_some() {
        let [best, own] = [of.best_um, of.own_um].map(|um| significant(um, 4));
        let versus =
            |of: VersusFirst| format!(", difference {} um: {}", difference_words(of.minus_first), of.verdict.words());
        return format!("figure {best} um instead of {own}{on}{}", of.versus_own.map_or_else(String::new, versus));
    }

    let percent = if of.own_p95_um > 0.0 {
        let side = if of.p95_um < 0.0 { "more" } else { "less" };
        format!("{} % {side}, ", significant(100.0 * of.p95_um.abs() / of.own_p95_um, 3))
    } else {
        String::new()
    };
    format!(
        "95 % value {percent}{} um instead of {}{on}, largest {} instead of {}",
        significant(of.best_p95_um, 4),
        significant(of.own_p95_um, 4),
        significant(of.best_max_um, 4),
        significant(of.own_max_um, 4)
    )
}
