//! Columns of measurements as the CSV that the façade reads.

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fmt::Write;

/// A column of numbers or of text.
#[derive(FromPyObject)]
pub enum Column<'py> {
    /// Numbers; one that is missing is NaN.
    Numbers(PyReadonlyArray1<'py, f64>),
    /// Cells as they are.
    Text(Vec<String>),
}

impl Column<'_> {
    fn cells(&self) -> PyResult<Cells<'_>> {
        Ok(match self {
            Self::Numbers(array) => Cells::Numbers(array.as_slice()?),
            Self::Text(cells) => Cells::Text(cells),
        })
    }
}

/// Cells of a column, one after the other.
enum Cells<'a> {
    Numbers(&'a [f64]),
    Text(&'a [String]),
}

impl Cells<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Text(cells) => cells.len(),
        }
    }

    /// Writes a cell; a number keeps every bit.
    fn write(&self, row: usize, csv: &mut String) -> std::fmt::Result {
        match self {
            Self::Numbers(numbers) if numbers[row].is_nan() => Ok(()),
            Self::Numbers(numbers) => write!(csv, "{:?}", numbers[row]),
            Self::Text(cells) => csv.write_str(&cells[row]),
        }
    }
}

/// Returns columns of one length as CSV with a header.
#[pyfunction]
pub fn csv(names: Vec<String>, columns: Vec<Column<'_>>) -> PyResult<String> {
    let cells = columns.iter().map(Column::cells).collect::<PyResult<Vec<_>>>()?;
    let rows = cells.first().map_or(0, Cells::len);
    if cells.len() != names.len() || cells.iter().any(|column| column.len() != rows) {
        return Err(PyValueError::new_err("the columns of measurements are not of one length"));
    }
    let mut csv = names.join(",");
    csv.push('\n');
    for row in 0..rows {
        for (index, column) in cells.iter().enumerate() {
            if index > 0 {
                csv.push(',');
            }
            column.write(row, &mut csv).map_err(|why| PyValueError::new_err(why.to_string()))?;
        }
        csv.push('\n');
    }
    Ok(csv)
}
