//! Layouts of exports as tables of rules: the words of titles and labels, and their meanings.
//!
//! [`GENERAL`] holds for any instrument. The layout of a particular instrument is another [`ExportLayout`] of this
//! kind.

use super::form::TableForm;
use crate::syntax::ColumnDirection::{self, Forward, Reverse};

/// The meaning of a column besides positions and readings by title.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColumnMeaning {
    Run,
    Direction,
    /// The axis that moved.
    Axis,
    ErrorName,
    /// The unit of the reading in the same row.
    Unit,
    /// A reading whose error stands in its row.
    Value,
    /// Rows with text here are unused.
    Excluded,
    /// Known to be no reading.
    Ignored,
    /// No rule has its title.
    Unknown,
}

/// Whole titles with their meaning, in tables of one form or of all.
struct TitleRule {
    titles: &'static [&'static str],
    form: Option<TableForm>,
    meaning: ColumnMeaning,
}

/// Words of a direction, at the beginning or at the end of a label.
struct DirectionRule {
    words: &'static [&'static str],
    direction: ColumnDirection,
}

/// The words of one family of exports, in lower case.
pub(super) struct ExportLayout {
    titles: &'static [TitleRule],
    /// Titles of columns of targets, beside the name of the axis.
    positions: &'static [&'static str],
    /// Beginnings of titles of positions that were reached; a word stands before its own beginnings.
    reached: &'static [&'static str],
    /// Beginnings of titles of deviations, beside positions that were reached.
    deviations: &'static [&'static str],
    /// Words of readings whose title leaves open whether they are deviations or positions that were reached.
    readings: &'static [&'static str],
    /// Words of numbered runs.
    runs: &'static [&'static str],
    /// Words of titles that are no readings of an error, separated by blanks: statistics, the environment, notes. One
    /// of them in a title is enough.
    others: &'static str,
    /// Words of means over the runs, among [`Self::others`].
    means: &'static [&'static str],
    /// Rules of directions; a word stands before its own beginnings and ends.
    directions: &'static [DirectionRule],
    /// Letters of numbered runs, directions where a table has both.
    letters: [(&'static [char], ColumnDirection); 2],
}

const fn title(titles: &'static [&'static str], form: Option<TableForm>, meaning: ColumnMeaning) -> TitleRule {
    TitleRule { titles, form, meaning }
}

const fn direction(direction: ColumnDirection, words: &'static [&'static str]) -> DirectionRule {
    DirectionRule { words, direction }
}

/// The words of English and German exports.
pub(super) const GENERAL: ExportLayout = ExportLayout {
    titles: &[
        title(&["run", "cycle", "lauf", "zyklus"], None, ColumnMeaning::Run),
        title(&["axis", "achse"], None, ColumnMeaning::Axis),
        title(
            &["direction", "dir", "approach", "approach direction", "direction of approach", "richtung"],
            None,
            ColumnMeaning::Direction,
        ),
        title(&["exclude", "excluded", "reason", "rejected"], None, ColumnMeaning::Excluded),
        title(&["error"], Some(TableForm::Tidy), ColumnMeaning::ErrorName),
        title(&["unit"], Some(TableForm::Tidy), ColumnMeaning::Unit),
        title(&["value"], Some(TableForm::Tidy), ColumnMeaning::Value),
        title(&["", "temp", "temperature", "time", "comment", "point", "no", "index"], None, ColumnMeaning::Ignored),
    ],
    positions: &[
        "position",
        "target",
        "pos",
        "nominal",
        "target position",
        "nominal position",
        "target position pi",
        "target pi",
        "pi",
        "soll",
        "sollposition",
        "soll-position",
        "sollwert",
        "soll pos",
        "ziel",
        "zielposition",
        "zielpos",
        "zielpos.",
        "messposition",
        "position pi",
        "target pos",
        "target pos.",
    ],
    reached: &[
        "actual position",
        "actual pos",
        "actual",
        "measured position",
        "istposition",
        "ist-position",
        "ist position",
        "istwert",
        "ist",
    ],
    deviations: &["deviation", "error", "abweichung", "difference"],
    readings: &["reading", "readings", "messwert", "measured"],
    runs: &["run", "lauf", "cycle", "zyklus", "pass", "measurement", "messung", "j"],
    others: "accuracy air average avg backlash coefficient comment compensated correction count date druck \
             environment feed feedrate feuchte flag genauigkeit humid humidity index korrektur luft luftdruck \
             luftfeuchte material max maximum mean min minimum mittel mittelwert no note nr number nummer offset \
             point press pressure punkt quality range repeatability reversal scatter sensor sigma signal slope spread \
             standard status std stddev stdev streuung strength temp temperatur temperature time timestamp \
             uncertainty umkehrspanne unsicherheit variance velocity vorschub zeit",
    means: &["mean", "average", "avg", "mittel", "mittelwert"],
    directions: &[
        direction(Forward, &["forward"]),
        direction(Reverse, &["reverse", "backward"]),
        direction(Forward, &["vorwärts", "vorwaerts"]),
        direction(Reverse, &["rückwärts", "rueckwaerts", "zurück", "zurueck", "rück", "rueck"]),
        direction(Forward, &["vor", "hin", "fwd"]),
        direction(Reverse, &["bwd", "rev", "down"]),
        direction(Forward, &["up", "->"]),
        direction(Reverse, &["<-"]),
        direction(Forward, &["→", "↑"]),
        direction(Reverse, &["←", "↓"]),
        direction(Forward, &["+"]),
        direction(Reverse, &["-"]),
    ],
    letters: [(&['f', 'v'], Forward), (&['r'], Reverse)],
};

pub(super) fn words(title: &str) -> impl Iterator<Item = &str> {
    title.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty())
}

/// Direction and run in a label, as far as it has them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct RunLabel {
    pub direction: Option<ColumnDirection>,
    /// The name of the run; empty without one.
    pub run: String,
}

impl ExportLayout {
    /// Returns the meaning of a whole title.
    pub fn meaning(&self, title: &str, form: TableForm) -> Option<ColumnMeaning> {
        let fits = |rule: &&TitleRule| rule.form.is_none_or(|own| own == form) && rule.titles.contains(&title);
        self.titles.iter().find(fits).map(|rule| rule.meaning)
    }

    /// True for titles of targets that do not name the axis.
    pub fn is_position(&self, title: &str) -> bool {
        self.positions.contains(&title)
    }

    /// True for titles of deviations beside positions that were reached.
    pub fn is_deviation(&self, title: &str) -> bool {
        self.deviations.iter().any(|word| title.starts_with(word))
    }

    /// Splits a label such as `Run 1 +`, `2 reverse`, `up`, `<-`. `F1`, `V1` and `R1` are directions if `paired`, and
    /// runs otherwise.
    pub fn label(&self, label: &str, paired: bool) -> RunLabel {
        let lower = label.trim().to_lowercase();
        let words = self.directions.iter().flat_map(|rule| rule.words.iter().map(|word| (*word, rule.direction)));
        let mut split = words.filter_map(|(word, direction)| {
            Some((direction, lower.strip_suffix(word).or_else(|| lower.strip_prefix(word))?.trim()))
        });
        let found = split.next().or_else(|| self.letter(&lower).filter(|_| paired));
        let (direction, rest) = found.map_or((None, lower.as_str()), |(direction, rest)| (Some(direction), rest));
        let run = rest.strip_prefix("run").unwrap_or(rest).trim_matches(|c: char| c.is_whitespace() || c == '_');
        RunLabel { direction, run: run.to_owned() }
    }

    /// Splits the title of a run: `Run 1 +`, `2`, `up`, `deviation 3 fwd`, `F1` if `paired`. A title with any other
    /// word is none.
    pub fn run(&self, title: &str, paired: bool) -> Option<RunLabel> {
        let lower = title.trim().to_lowercase();
        if let Some((_, number)) = self.letter(&lower).filter(|(_, number)| !paired && !number.is_empty()) {
            return Some(RunLabel { direction: None, run: number.to_owned() });
        }
        let label = self.label(title, paired);
        let plain = label.run.replace(['(', ')', '#', '_', '-', '=', '.', ':'], " ");
        let mut found = RunLabel { direction: label.direction, run: String::new() };
        let mut named = found.direction.is_some();
        for token in plain.split_whitespace() {
            let word = token.trim_end_matches(|c: char| c.is_ascii_digit());
            let number = &token[word.len()..];
            let direction = self.directions.iter().find(|rule| rule.words.contains(&word)).map(|rule| rule.direction);
            named |= if word.is_empty() || self.runs.contains(&word) || self.is_run_word(word) {
                true
            } else if let (Some(_), None) = (direction, found.direction) {
                found.direction = direction;
                true
            } else if ["no", "nr", "number"].contains(&word) && number.is_empty() {
                false
            } else {
                return None;
            };
            if !number.is_empty() && !found.run.is_empty() {
                return None;
            }
            found.run.push_str(number);
        }
        named.then_some(found)
    }

    /// True for words of deviations, readings and positions that were reached.
    fn is_run_word(&self, word: &str) -> bool {
        let known = [self.deviations, self.readings, self.reached];
        known.iter().any(|words| words.contains(&word))
    }

    /// True if the title of a run leaves open whether it shows deviations or positions that were reached.
    pub fn is_open(&self, title: &str) -> bool {
        words(title).any(|word| self.readings.contains(&word))
            && !words(title).any(|word| self.deviations.contains(&word))
    }

    /// True for titles of columns that are known to be no readings of an error.
    pub fn is_other(&self, title: &str) -> bool {
        words(title).any(|word| self.others.split(' ').any(|other| other == word))
    }

    /// True for titles of means over the runs.
    pub fn is_mean(&self, title: &str) -> bool {
        words(title).any(|word| self.means.contains(&word))
    }

    /// Splits a title of positions that were reached, such as `actual`, `actual position 2 -`, `ist_1`. A title with
    /// another word, such as `actual deviation` or `actual feed`, is none.
    pub fn actual_position_label(&self, title: &str, paired: bool) -> Option<RunLabel> {
        let rest = self.reached.iter().find_map(|word| title.strip_prefix(word))?;
        let name = rest.trim_start_matches([' ', '_', '-']);
        // A sign by itself is a direction, one before a name joins the two.
        let label = self.label(if name.is_empty() { rest } else { name }, paired);
        label.run.chars().all(|c| c.is_ascii_digit()).then_some(label)
    }

    /// Splits `f1`, `v 2`, `r`: a letter and the number of a run.
    pub fn letter<'t>(&self, title: &'t str) -> Option<(ColumnDirection, &'t str)> {
        let split =
            |(letters, direction): &(&[char], ColumnDirection)| Some((*direction, title.strip_prefix(*letters)?));
        let (direction, rest) = self.letters.iter().find_map(split)?;
        let number = rest.trim();
        number.chars().all(|c| c.is_ascii_digit()).then_some((direction, number))
    }

    /// True if letters of both directions are among the titles.
    pub fn has_letter_pairs<'t>(&self, titles: impl Iterator<Item = &'t str> + Clone) -> bool {
        let has =
            |wanted| titles.clone().filter_map(|title| self.letter(title.trim())).any(|(found, _)| found == wanted);
        has(Forward) && has(Reverse)
    }
}
