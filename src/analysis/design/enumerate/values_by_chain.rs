//! The 95 % values of the arrangements of a study in one round, without a journal.

use super::study::{Judge, Study};
use crate::analysis::design::budget::{Bound, percentile_95};
use crate::run::Advance;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The 95 % values of an arrangement, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainValues {
    /// With the reference of the study.
    pub um: f64,
    /// With the best fit, if that is asked for too.
    pub best_fit_um: Option<f64>,
}

impl<'a> Study<'a> {
    /// Returns the same study with other bounds, drawn by the same numbers; of a study of values itself.
    pub fn with_bounds(&self, bounds: Vec<Bound>) -> Study<'a> {
        let mut other = self.clone();
        if let Judge::Budget { bounds: own, .. } = other.judge_mut() {
            *own = bounds;
        }
        other
    }

    /// Returns the values of all arrangements that are judged, by their chains. Calls `progress` with the number of
    /// walks done since its last call.
    pub fn values_by_chain<F: Send>(
        &self,
        samples: usize,
        progress: Advance<'_, F>,
    ) -> Result<BTreeMap<String, ChainValues>, F> {
        let round = self.round(0..samples);
        let step = |index: usize| {
            let records = round.step(index, None).into_iter().filter(|record| !record.values.is_empty());
            let values = records.map(|record| {
                let best_fit_um = (!record.best_fit.is_empty()).then(|| percentile_95(&record.best_fit));
                (record.row.chain, ChainValues { um: percentile_95(&record.values), best_fit_um })
            });
            let values = values.collect::<Vec<_>>();
            progress(1)?;
            Ok(values)
        };
        let all: Vec<Vec<(String, ChainValues)>> =
            (0..self.walks()).into_par_iter().map(step).collect::<Result<_, F>>()?;
        Ok(all.into_iter().flatten().collect())
    }
}
