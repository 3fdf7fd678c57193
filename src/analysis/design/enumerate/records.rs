//! Records that a study can have made: those of a file may be altered, with a checksum that is right again.

use super::journal::{RoundRecord, RoundStep};
use super::ranking::{ArrangementRow, Standing};
use super::rounds::Rounds;
use super::study::Study;
use crate::diagnostic::{Reason, shown};
use crate::machine::Machine;

impl Study<'_> {
    /// Fails with the reason for which these are no records of a walk of this study.
    pub fn check_records(&self, rounds: &Rounds, at: RoundStep, records: &[RoundRecord]) -> Result<(), Reason> {
        let of = |what: String| Reason::new(format!("walk {} of round {}: {what}", at.step, at.round));
        if at.round >= rounds.sizes().len() {
            return Err(of(format!("the study has {} rounds", rounds.sizes().len())));
        }
        let arrangements = self.arrangements(at.step, None);
        let tables: Vec<usize> = records.iter().map(|record| record.row.table).collect();
        let known = arrangements.iter().map(|(table, _)| *table).filter(|table| tables.contains(table));
        if !known.eq(tables.iter().copied()) || (at.round == 0 && tables.len() != arrangements.len()) {
            return Err(of("its arrangements are not those of the walk".to_owned()));
        }
        let samples = rounds.samples(at.round).len();
        records.iter().try_for_each(|record| {
            let machine = arrangements.iter().find(|(table, _)| *table == record.row.table).map(|(_, machine)| machine);
            let machine = machine.filter(|machine| machine.chain().to_string() == record.row.chain);
            let machine = machine.ok_or_else(|| of(format!("it has no arrangement `{}`", shown(&record.row.chain))))?;
            let wrong = || self.wrong_counts(&record.row).or_else(|| self.wrong_values(record, machine, samples));
            wrong().map_or(Ok(()), |what| Err(of(format!("`{}` {what}", record.row.chain))))
        })
    }

    /// Returns what the counts of an arrangement contradict.
    fn wrong_counts(&self, row: &ArrangementRow) -> Option<String> {
        let (asked, missed) = (self.work().len(), row.unreachable);
        let reasons =
            [missed.direction, missed.place, missed.travel].iter().try_fold(0_usize, |n, k| n.checked_add(*k));
        if row.reached.checked_add(missed.total) != Some(asked) || reasons != Some(missed.total) {
            return Some(format!("reaches {} and misses {} of {asked} tool poses", row.reached, missed.total));
        }
        let is_possible = match row.standing {
            Standing::Judged | Standing::MissesReference => row.reached > 0,
            Standing::CannotTurn | Standing::ReachesNothing => row.reached == 0,
        };
        (!is_possible || missed.not_proved > missed.total).then(|| "reaches another number than it says".to_owned())
    }

    /// Returns what the values of an arrangement contradict; `samples` is the number of machines of the round.
    fn wrong_values(&self, record: &RoundRecord, machine: &Machine, samples: usize) -> Option<String> {
        let RoundRecord { row, values, best_fit, file, common } = record;
        let judged = row.standing == Standing::Judged;
        let count = if judged { samples } else { 0 };
        let fits = best_fit.len() == count || best_fit.is_empty();
        let idle = !judged && (file.is_some() || common.is_some());
        if values.len() != count || !fits || idle {
            return Some(format!("has {} values of {count} machines", values.len()));
        }
        if best_fit.iter().chain(file).chain(common).any(|um| !um.is_finite() || *um < 0.0) {
            return Some("has an error below zero".to_owned());
        }
        let is_path = judged && self.is_path();
        if row.rewinds.is_some() != is_path || row.rewinds.is_some_and(|rewinds| rewinds >= row.reached.max(1)) {
            return Some("has rewinds that no path has".to_owned());
        }
        let ranges = &row.travel;
        let are_ranges = ranges.iter().all(|of| {
            machine.axes().iter().any(|axis| axis.name.as_str() == of.axis) && of.min.is_finite() && of.min <= of.max
        });
        if !are_ranges || (!judged || !self.is_sized()) && !ranges.is_empty() {
            return Some("has travels that it does not need".to_owned());
        }
        let is_row = row.result.is_none() && row.not_stated == self.not_stated(machine);
        (!is_row).then(|| "has what only the end of a study has".to_owned())
    }
}
