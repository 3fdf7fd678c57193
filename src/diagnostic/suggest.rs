//! "Did you mean": the nearest of the words that would have been right.

use super::shown;

/// The candidate nearest to `word`, if near enough to be the intended one.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // One letter for another is no misspelling of a word of one or two letters.
    let limit = word.chars().count() / 3;
    let word = key(word);
    let scored = candidates.into_iter().map(|c| (strsim::osa_distance(&word, &key(c)), c));
    scored.filter(|(d, _)| *d <= limit).min_by_key(|(d, _)| *d).map(|(_, c)| c)
}

/// Words of the language, each with those of other programs and of data sheets for it.
const OTHER_WORDS: [(&str, &[&str]); 8] = [
    ("tolerances", &["bounds", "limits", "spec", "specification", "accuracy"]),
    ("travel", &["stroke", "range", "limits", "limit", "min", "max", "soft_limits"]),
    ("origin", &["pivot", "position", "center", "centre", "point", "location", "offset"]),
    ("table", &["file", "csv", "path", "data", "curve"]),
    ("value", &["constant", "const", "size", "amount"]),
    ("chain", &["kinematics", "structure", "topology", "axes_order", "order", "sequence"]),
    ("machine", &["name", "title", "model"]),
    ("forward", &["backlash", "reversal", "positive"]),
];

/// The candidate that the field calls by another word.
fn other_word<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let word = key(word);
    let meant = OTHER_WORDS.iter().filter(|(_, others)| others.contains(&word.as_str()));
    meant.flat_map(|(ours, _)| candidates.iter().find(|c| *c == ours).copied()).next()
}

/// Help for an unknown word: the nearest candidate, the one that means it, or all of them.
pub fn did_you_mean(word: &str, candidates: &[&str]) -> String {
    if word.contains('\u{a0}') {
        return "a no-break space stands in it, as word processors write: put a plain one".to_owned();
    }
    match nearest(word, candidates.iter().copied()).or_else(|| other_word(word, candidates)) {
        Some(near) => format!("did you mean `{}`?", shown(near)),
        None if candidates.is_empty() => "remove it".to_owned(),
        None => format!(
            "known here: {}",
            candidates.iter().map(|c| format!("`{}`", shown(c))).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// The beginning of a word in small letters: longer words would only cost time.
fn key(word: &str) -> String {
    word.to_lowercase().chars().take(64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_suggested_and_far_ones_are_not() {
        assert_eq!(nearest("travle", ["travel", "tool"]), Some("travel"));
        assert_eq!(nearest("dirction", ["direction", "origin"]), Some("direction"));
        assert_eq!(nearest("gauge", ["travel", "tool"]), None);
    }

    #[test]
    fn words_of_data_sheets_are_known_where_they_fit() {
        assert_eq!(did_you_mean("stroke", &["travel", "origin"]), "did you mean `travel`?");
        assert_eq!(did_you_mean("limits", &["errors", "tolerances"]), "did you mean `tolerances`?");
        assert_eq!(did_you_mean("stroke", &["errors", "tool"]), "known here: `errors`, `tool`");
    }
}
