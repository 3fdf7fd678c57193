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

/// Help for an unknown word: the nearest candidate, or all of them.
pub fn did_you_mean(word: &str, candidates: &[&str]) -> String {
    match nearest(word, candidates.iter().copied()) {
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
}
