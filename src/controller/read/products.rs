//! Tables that multiply one another.

use super::lines::TableFields;
use super::{Fault, ReadContext};
use crate::compensation::CorrectionTable;
use crate::controller::emit::StoredColumn;

pub(super) struct TableEntry<'a> {
    pub table: CorrectionTable,
    /// The number, from 1, of the table by which it is multiplied; 0 for none.
    pub times: usize,
    pub record: &'a TableFields,
}

/// Sums up the tables of a file: the plain ones, and the products. Whether the controller also adds the factor tables
/// themselves is documented nowhere, so they are only read where their contributions cancel.
pub(super) fn multiply(reading: &ReadContext, read: Vec<TableEntry>) -> Result<Vec<CorrectionTable>, Fault> {
    let mut products: Vec<CorrectionTable> = Vec::new();
    let mut factors: Vec<usize> = Vec::new();
    for (at, numbered) in read.iter().enumerate().filter(|(_, numbered)| numbered.times > 0) {
        let name = (numbered.times - 1).to_string();
        let line = numbered.record.line;
        let second = read.iter().position(|other| other.record.name == name).ok_or_else(|| {
            Fault::new(line, format!("it is multiplied by table number {}, which is not there", numbered.times))
        })?;
        products.push(product(reading, &numbered.table, &read[second].table, line)?);
        factors.extend([at, second]);
    }
    without_repetition(&mut products);
    factors.sort_unstable();
    factors.dedup();
    let mut alone: Vec<CorrectionTable> = Vec::new();
    for (at, numbered) in read.iter().enumerate() {
        if !factors.contains(&at) {
            alone.push(numbered.table.clone());
            continue;
        }
        let same = |other: &CorrectionTable| (&other.axes, &other.nodes, &other.corrected) == key(&numbered.table);
        let others = factors.iter().map(|at| &read[*at].table).filter(|table| same(table));
        let sums = others.fold(vec![0.0; numbered.table.values.len()], |sums, table| {
            sums.iter().zip(&table.values).map(|(sum, value)| sum + value).collect()
        });
        // Pairs of opposite numbers cancel to the bit, sums of many to a part of the last place.
        if sums.iter().any(|sum| sum.abs() > 1e-12) {
            let message = "a factor of a product whose values no opposite table cancels: whether the controller adds \
             them besides the product is not documented";
            return Err(Fault::new(numbered.record.line, message));
        }
    }
    alone.extend(products);
    Ok(alone)
}

fn key(table: &CorrectionTable) -> (&Vec<usize>, &Vec<Vec<f64>>, &Vec<usize>) {
    (&table.axes, &table.nodes, &table.corrected)
}

/// The table over two axes of a product.
fn product(
    reading: &ReadContext,
    first: &CorrectionTable,
    second: &CorrectionTable,
    line: usize,
) -> Result<CorrectionTable, Fault> {
    let plain = |table: &CorrectionTable| table.axes.len() == 1 && table.reverse.is_none();
    if !plain(first) || !plain(second) {
        return Err(Fault::new(line, "only tables over one axis and for both directions are multiplied"));
    }
    if first.axes == second.axes || first.corrected != second.corrected {
        let message = "factors over one and the same axis, or for different axes, are not read here";
        return Err(Fault::new(line, message));
    }
    let mechanism = &reading.target.manifest.mechanism;
    let rules = mechanism.product.as_ref();
    let rules = rules.ok_or_else(|| Fault::new(line, "the controller has no products of tables"))?;
    let column = StoredColumn::new(rules, reading.machine.axes()[first.corrected[0]].kind);
    let weights = second.values.iter().map(|c| column.as_weight(*c)).collect();
    Ok(CorrectionTable::product(first, second, [first.values.clone(), weights]))
}

/// The product of the opposite factors is the same once more: its factors are no others.
fn without_repetition(products: &mut [CorrectionTable]) {
    for at in 1..products.len() {
        let (before, rest) = products.split_at_mut(at);
        let opposite = |other: &CorrectionTable| {
            let negated = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| *a == 0.0 - *b);
            key(other) == key(&rest[0])
                && other
                    .factors
                    .iter()
                    .zip(&rest[0].factors)
                    .any(|(a, b)| negated(&a[0], &b[0]) && negated(&a[1], &b[1]))
        };
        if before.iter().any(opposite) {
            rest[0].factors.clear();
        }
    }
}
