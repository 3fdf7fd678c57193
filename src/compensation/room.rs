//! The room that a controller has for tables.

use super::{CorrectionTable, CorrectionTables, Mechanisms};

/// A limit on the number of tables that a set exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crowded {
    /// Tables of all mechanisms together.
    All,
    /// Tables of one mechanism.
    Mechanism(&'static str),
    /// Tables of one mechanism that correct one axis.
    Output(&'static str, usize),
}

impl Crowded {
    /// True if the limit counts a table.
    pub fn concerns(self, mechanisms: &Mechanisms, table: &CorrectionTable) -> bool {
        let of = |name| mechanisms.name_of(table) == Some(name);
        match self {
            Self::All => true,
            Self::Mechanism(name) => of(name),
            Self::Output(name, axis) => of(name) && table.corrected == [axis],
        }
    }
}

impl Mechanisms {
    /// Returns the first limit on the number of tables that a set exceeds.
    pub fn excess(&self, tables: &CorrectionTables) -> Option<Crowded> {
        let all = &tables.tables;
        for (name, rules) in self.iter() {
            let of: Vec<&CorrectionTable> = all.iter().filter(|table| self.name_of(table) == Some(name)).collect();
            let same = |table: &&CorrectionTable| of.iter().filter(|other| other.corrected == table.corrected).count();
            if let Some(table) = of.iter().copied().find(|table| same(table) > rules.max_tables_per_output)
                && let [axis] = table.corrected[..]
            {
                return Some(Crowded::Output(name, axis));
            }
            if of.len() > rules.max_tables {
                return Some(Crowded::Mechanism(name));
            }
        }
        let count = all.iter().map(|table| self.count(table)).sum::<usize>();
        self.tables.filter(|max| count > *max).map(|_| Crowded::All)
    }
}
