//! SINUMERIK's `$AN_CEC` tables, read as Siemens K3 describes them: tables on one output add up (p. 245), one with a
//! direction acts in that direction (p. 249), one that names another by its number and one is multiplied by it (p.
//! 252). The manual does not state whether the factors of a product also count by themselves: that is for the caller to
//! choose. Values are as stored.

use std::collections::BTreeMap;

use super::controllers::{Points, numbered, pieces, real};

/// One table.
#[derive(Clone, Debug)]
pub struct CorrectionTable {
    /// Number of the axis that is looked up, from 1.
    pub input: usize,
    /// Number of the axis that is corrected, from 1.
    pub output: usize,
    /// 0, or 1 or -1 for one direction only.
    pub direction: f64,
    /// Number of the table by which it is multiplied, from 1; 0 for none.
    pub times: usize,
    points: Points,
}

impl CorrectionTable {
    /// Values at the points.
    pub fn values(&self) -> &[f64] {
        &self.points.values
    }

    fn at(&self, position: &[f64]) -> f64 {
        self.points.read(position[self.input - 1])
    }
}

/// All tables of a file by their index.
#[derive(Clone, Debug)]
pub struct CorrectionTables(pub BTreeMap<usize, CorrectionTable>);

impl CorrectionTables {
    /// None if something is missing or no number.
    pub fn read(text: &str) -> Option<Self> {
        let mut values: BTreeMap<usize, BTreeMap<usize, f64>> = BTreeMap::new();
        let mut said: BTreeMap<(usize, String), f64> = BTreeMap::new();
        for line in text.lines().filter(|line| line.starts_with("$AN_CEC")) {
            match pieces(line, "[],=()")[..] {
                ["$AN_CEC", table, index, value] => {
                    let points = values.entry(table.parse().ok()?).or_default();
                    points.insert(index.parse().ok()?, real(value)?);
                }
                [name, table, value] => {
                    let name = name.trim_start_matches("$AN_CEC_").to_owned();
                    said.insert((table.parse().ok()?, name), real(value.trim_start_matches("AX"))?);
                }
                _ => return None,
            }
        }
        let table = |number: usize, values: &BTreeMap<usize, f64>| {
            let of = |name: &str| said.get(&(number, name.to_owned())).copied();
            let turn = (of("IS_MODULO")? == 1.0).then_some(360.0);
            let points = Points { start: of("MIN")?, step: of("STEP")?, values: numbered(values)?, turn };
            let (input, output) = (of("INPUT_AXIS")? as usize, of("OUTPUT_AXIS")? as usize);
            let (direction, times) = (of("DIRECTION")?, of("MULT_BY_TABLE")? as usize);
            Some((number, CorrectionTable { input, output, direction, times, points }))
        };
        let all: BTreeMap<usize, CorrectionTable> = values.iter().map(|(n, v)| table(*n, v)).collect::<Option<_>>()?;
        let whole = all.values().all(|table| table.times == 0 || all.contains_key(&(table.times - 1)));
        whole.then_some(Self(all))
    }

    /// The sum for an axis, the values of first and second factors added by themselves or not.
    pub fn sum(&self, output: usize, position: &[f64], reverse: bool, [first, second]: [bool; 2]) -> f64 {
        let seconds: Vec<usize> = self.0.values().filter(|t| t.times > 0).map(|t| t.times - 1).collect();
        let acts = |table: &CorrectionTable| table.direction == 0.0 || (table.direction < 0.0) == reverse;
        let of = |(index, table): (&usize, &CorrectionTable)| {
            let own = match (table.times > 0, seconds.contains(index)) {
                (true, _) => first,
                (_, true) => second,
                _ => true,
            };
            let value = table.at(position);
            let product = if table.times > 0 { value * self.0[&(table.times - 1)].at(position) } else { 0.0 };
            product + if own { value } else { 0.0 }
        };
        self.0.iter().filter(|(_, table)| table.output == output && acts(table)).map(of).sum()
    }
}
