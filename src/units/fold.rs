//! Sentences in lines for a terminal.

/// Columns of a terminal.
const COLUMNS: usize = 80;

/// Longest text in brackets that stays in one line.
const MAX_IN_BRACKETS: usize = 44;

/// Returns a sentence in lines for a terminal of 80 columns, all but the first indented further.
pub fn fold(sentence: &str) -> String {
    let indent = " ".repeat(sentence.len() - sentence.trim_start_matches(' ').len() + 2);
    lines(sentence, COLUMNS, &indent).iter().map(|line| format!("{line}\n")).collect()
}

/// Returns the lines of a text in lines that leave `taken` columns of a terminal free.
pub fn fold_beside(text: &str, taken: usize) -> String {
    text.lines().map(|line| lines(line, COLUMNS.saturating_sub(taken), "").join("\n")).collect::<Vec<_>>().join("\n")
}

fn lines(sentence: &str, columns: usize, indent: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    let parts = |whole| if str::chars(whole).count() > MAX_IN_BRACKETS { words(whole, false) } else { vec![whole] };
    // A command that is longer than a line is broken like other text.
    let room = columns.saturating_sub(indent.len());
    let pieces = |word| str::splitn(word, if str::chars(word).count() > room { usize::MAX } else { 1 }, ' ');
    for word in words(sentence, true).into_iter().flat_map(parts).flat_map(pieces) {
        let is_full =
            |line: &String| !line.trim().is_empty() && line.chars().count() + 1 + word.chars().count() > columns;
        if lines.last().is_some_and(is_full) {
            lines.push(indent.to_owned());
        }
        lines.last_mut().into_iter().for_each(|line| *line += &format!("{word} "));
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// Splits at blanks, but within backticks, where commands stand, and within brackets, such as those of a point.
fn words(text: &str, keeps_brackets: bool) -> Vec<&str> {
    let (mut depth, mut in_code) = (0_usize, false);
    let ends_word = |c: char| {
        match c {
            '`' => in_code = !in_code,
            '(' if keeps_brackets => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ' ' && depth == 0 && !in_code
    };
    text.split(ends_word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_not_broken() {
        let words = "Over a job of 361 tool poses, 361 reached, one path; reference: zero at (0, 0, 0) along (0, 0, 1)";
        let lines: Vec<String> = fold(words).lines().map(str::to_owned).collect();
        assert_eq!(lines[0], "Over a job of 361 tool poses, 361 reached, one path; reference: zero at");
        assert_eq!(lines[1], "  (0, 0, 0) along (0, 0, 1)");
    }

    #[test]
    fn a_command_is_not_broken() {
        let command = "`abbe compile mill.yaml --target linuxcnc --out mill-parameters`";
        let lines: Vec<String> = fold(&format!("Write the set, (once more), by {command}, then load it."))
            .lines()
            .map(str::to_owned)
            .collect();
        assert_eq!(lines, ["Write the set, (once more), by", &format!("  {command}, then load"), "  it."]);
        let long = format!("`{}end`", "word ".repeat(20));
        assert!(fold(&long).lines().all(|line| line.len() <= 80));
        assert!(fold(&"a ` b ".repeat(21)).lines().all(|line| line.len() <= 80));
    }

    #[test]
    fn lines_are_full_and_no_longer() {
        let words = "abcd ".repeat(30);
        assert!(fold_beside(&words, 20).lines().all(|line| line.chars().count() <= 60));
        assert_eq!(fold_beside(&words, 20).lines().next().unwrap().chars().count(), 59);
        let long = "x".repeat(100);
        assert_eq!(fold(&format!("    a {long} b")), format!("    a\n      {long}\n      b\n"));
        assert_eq!(fold_beside("one\n\ntwo", 0), "one\n\ntwo");
    }
}
