//! "Did you mean": the nearest of the words that would have been right.

use super::shown;

/// The candidate nearest to `word`, if near enough to be what was meant.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // One letter for another is no misspelling of a word of one or two letters.
    let limit = word.chars().count() / 3;
    let scored = candidates.into_iter().map(|c| (distance(&word.to_lowercase(), &c.to_lowercase()), c));
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

/// Edits from one word to the other, a swap of neighbours counting as one.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<_>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
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
