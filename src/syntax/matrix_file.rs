//! The file of a matrix over the dual numbers of order n: rows of entries, or one matrix for each power of i.

use super::yaml::from_yaml;
use serde_yaml::{Mapping, Value};

/// A matrix by degree and row.
pub type Coefficients = Vec<Vec<Vec<f64>>>;

/// The highest power of i.
pub const MAX_DEGREE: usize = 6;

/// The largest number of rows.
pub const MAX_ROWS: usize = 8;

/// Content of a file with a matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixFile {
    /// Coefficients of the powers of i, from 1 on.
    pub coefficients: Coefficients,
    /// `kind: motion` is true, `kind: rotation` false.
    pub is_motion: Option<bool>,
}

/// The reason, in words, for which a text is no matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixFailure(String);

impl std::fmt::Display for MatrixFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

const KEYS: [&str; 5] = ["matrix", "real", "dual", "coefficients", "kind"];

/// Reads the file. Fails with the reason in words.
pub fn matrix_file(text: &str) -> Result<MatrixFile, MatrixFailure> {
    let value: Value = from_yaml(text).map_err(|failure| match failure.line {
        Some(line) => MatrixFailure(format!("line {line} is not YAML: {}", failure.message)),
        None => MatrixFailure(format!("the text is not YAML: {}", failure.message)),
    })?;
    let Value::Mapping(map) = value else {
        return Err(MatrixFailure("the file has no key `matrix`".to_owned()));
    };
    if let Some(unknown) = map.keys().map(word).find(|key| !KEYS.contains(&key.as_str())) {
        return Err(MatrixFailure(format!("the key `{unknown}` is unknown")));
    }
    let coefficients = coefficients(&map)?;
    let rows = coefficients.first().map_or(0, Vec::len);
    if !(2..=MAX_ROWS).contains(&rows) {
        return Err(MatrixFailure(format!("a matrix of {rows} rows; 2 to {MAX_ROWS} are read")));
    }
    let is_motion = match map.get("kind").map(word).as_deref() {
        None => None,
        Some("motion") => Some(true),
        Some("rotation") => Some(false),
        Some(other) => {
            return Err(MatrixFailure(format!("`kind: {other}` is neither `motion` nor `rotation`")));
        }
    };
    Ok(MatrixFile { coefficients, is_motion })
}

fn coefficients(map: &Mapping) -> Result<Coefficients, MatrixFailure> {
    match ["matrix", "real", "dual", "coefficients"].map(|key| map.get(key)) {
        [Some(matrix), None, None, None] => of_entries(matrix),
        [None, Some(real), dual, None] => {
            let real = square(real, "`real`")?;
            let dual = dual.map(|dual| square(dual, "`dual`")).transpose()?;
            same_size(std::iter::once(real).chain(dual).collect())
        }
        [None, None, None, Some(Value::Sequence(list))] if !list.is_empty() && list.len() <= MAX_DEGREE + 1 => {
            let one = |(k, m): (usize, &Value)| square(m, &format!("matrix {} of `coefficients`", k + 1));
            same_size(list.iter().enumerate().map(one).collect::<Result<_, _>>()?)
        }
        [None, None, None, Some(_)] => {
            let most = MAX_DEGREE + 1;
            Err(MatrixFailure(format!("`coefficients` is not a list of 1 to {most} matrices, one for each power of i")))
        }
        [None, None, None, None] => Err(MatrixFailure("the file has no key `matrix`".to_owned())),
        [None, None, Some(_), None] => Err(MatrixFailure("`dual` stands without `real`".to_owned())),
        _ => Err(MatrixFailure("`matrix`, `real` and `coefficients` exclude each other".to_owned())),
    }
}

fn same_size(all: Coefficients) -> Result<Coefficients, MatrixFailure> {
    let rows = all.first().map_or(0, Vec::len);
    match all.iter().find(|m| m.len() != rows) {
        Some(other) => Err(MatrixFailure(format!("one part has {rows} rows, another {}", other.len()))),
        None => Ok(all),
    }
}

/// A square matrix of numbers.
fn square(value: &Value, name: &str) -> Result<Vec<Vec<f64>>, MatrixFailure> {
    let entry = |value: &Value, (i, j): (usize, usize)| {
        let text = || format!("entry ({}, {}) of {name} is `{}`, not a number", i + 1, j + 1, word(value));
        number(value).ok_or_else(|| MatrixFailure(text()))
    };
    rows(value, name)?
        .iter()
        .enumerate()
        .map(|(i, row)| row.iter().enumerate().map(|(j, value)| entry(value, (i, j))).collect())
        .collect()
}

/// The rows of a square matrix.
fn rows<'a>(value: &'a Value, name: &str) -> Result<Vec<&'a Vec<Value>>, MatrixFailure> {
    let Value::Sequence(list) = value else {
        return Err(MatrixFailure(format!("{name} is not a list of rows")));
    };
    let row = |(i, row): (usize, &'a Value)| match row {
        Value::Sequence(row) if row.len() == list.len() => Ok(row),
        Value::Sequence(row) => {
            let (number, found, needed) = (i + 1, row.len(), list.len());
            let text = format!("row {number} of {name} has {found} entries; with {needed} rows it needs {needed}");
            Err(MatrixFailure(text))
        }
        _ => Err(MatrixFailure(format!("row {} of {name} is not a list of entries", i + 1))),
    };
    list.iter().enumerate().map(row).collect()
}

/// A matrix whose entries are numbers or lists of coefficients.
fn of_entries(value: &Value) -> Result<Coefficients, MatrixFailure> {
    let rows = rows(value, "`matrix`")?;
    let entry = |value: &Value, (i, j): (usize, usize)| {
        let list = match value {
            Value::Sequence(list) if (1..=MAX_DEGREE + 1).contains(&list.len()) => list.iter().map(number).collect(),
            value => number(value).map(|real| vec![real]),
        };
        list.ok_or_else(|| {
            let place = format!("entry ({}, {}) of `matrix` is `{}`", i + 1, j + 1, word(value));
            MatrixFailure(format!("{place}, neither a number nor 1 to {} coefficients", MAX_DEGREE + 1))
        })
    };
    let parts: Vec<Vec<Vec<f64>>> = rows
        .iter()
        .enumerate()
        .map(|(i, row)| row.iter().enumerate().map(|(j, value)| entry(value, (i, j))).collect())
        .collect::<Result<_, MatrixFailure>>()?;
    let degrees = parts.iter().flatten().map(Vec::len).max().unwrap_or(1).max(2);
    let of_degree = |k: usize| {
        let row = |row: &Vec<Vec<f64>>| row.iter().map(|entry| entry.get(k).copied().unwrap_or(0.0)).collect();
        parts.iter().map(row).collect()
    };
    Ok((0..degrees).map(of_degree).collect())
}

fn number(value: &Value) -> Option<f64> {
    value.as_f64().filter(|x| x.is_finite())
}

/// A value as one would quote it.
fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "empty".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(value) => value.to_string(),
        Value::Sequence(list) => format!("[{}]", list.iter().map(word).collect::<Vec<_>>().join(", ")),
        _ => "a mapping".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_and_parts_are_the_same() {
        let entries = matrix_file("matrix: [[1, [0, 2, 3]], [[0, -2], 1.5]]").unwrap();
        let parts = "coefficients: [[[1, 0], [0, 1.5]], [[0, 2], [-2, 0]], [[0, 3], [0, 0]]]";
        assert_eq!(entries, matrix_file(parts).unwrap());
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        for (text, words) in [
            ("3", "no key `matrix`"),
            ("matrix: [[1, 0], [0]]", "row 2 of `matrix` has 1 entries; with 2 rows it needs 2"),
            ("matrix: [[1, a], [0, 1]]", "entry (1, 2) of `matrix` is `a`"),
            ("matrix: [[1, .inf], [0, 1]]", "entry (1, 2)"),
            ("matrix: [1, 2]", "row 1 of `matrix` is not a list"),
            ("matrix: [[1]]", "a matrix of 1 rows"),
            ("dual: [[1]]", "`dual` stands without `real`"),
            ("real: [[1, 0], [0, 1]]\ndual: [[0]]", "one part has 2 rows, another 1"),
            ("matrix: []\nreal: []", "exclude each other"),
            ("matrix: [[1, 0], [0, 1]]\nkind: affine", "`kind: affine`"),
            ("matrx: []", "key `matrx`"),
            ("matrix: [", "is not YAML"),
        ] {
            let reason = matrix_file(text).unwrap_err().to_string();
            assert!(reason.contains(words), "{text}: {reason}");
        }
    }
}
