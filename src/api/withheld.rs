//! Verdicts of a ranking that errors without a value or a bound could turn.

use super::budgets::stand_in;
use super::enumerate::Arrangement;
use crate::analysis::budget::{Bound, Coverage, Verdict};
use crate::analysis::enumerate::{ChainValues, Study};
use crate::machine::Machine;
use crate::run::{Call, Refused};
use schemars::JsonSchema;
use serde::Serialize;

/// Ranked arrangements that have no verdict because errors without a value or a bound could turn it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct TurnedVerdicts {
    /// Number of these arrangements.
    pub arrangements: usize,
    /// The class that bounds the missing errors.
    pub class: String,
    /// The reason in words.
    pub reason: String,
}

/// The bounds of a study with what they do not cover.
pub(crate) struct StudyCoverage<'a> {
    /// The machine as its file has it.
    pub machine: &'a Machine,
    /// The bounds in force.
    pub bounds: &'a [Bound],
    /// Which of the acting errors are known.
    pub coverage: &'a Coverage,
    /// The class in force.
    pub class: Option<&'a str>,
}

impl StudyCoverage<'_> {
    /// Withholds the verdicts against the best arrangement, the first, whose difference changes its sign once the
    /// missing errors have the bounds of a class, on so many machines drawn; `None` if there are none.
    pub(crate) fn withhold(
        &self,
        call: &Call<'_>,
        (study, samples): (&Study<'_>, usize),
        ranked: &mut [Arrangement],
    ) -> Result<Option<TurnedVerdicts>, Refused> {
        let decided = |of: &Arrangement| matches!(of.verdict(), Some(Verdict::Better | Verdict::Worse));
        let Some((first, others)) = ranked.split_first_mut() else { return Ok(None) };
        if self.coverage.missing.is_empty() || !others.iter().any(decided) {
            return Ok(None);
        }
        let (name, class) = stand_in(self.class, &[self.machine]);
        let study = study.with_bounds(self.coverage.fill(self.machine, self.bounds, &[], class.as_ref()));
        let values = call.stage(study.walks(), |advance| study.values_by_chain(samples, advance))?;
        let (missing, acting) = (self.coverage.missing.len(), self.coverage.acting());
        let reason = format!(
            "errors with neither value nor bound could turn it: the file lacks {missing} of {acting}; `--class {name}` \
             bounds them"
        );
        let mut arrangements = 0;
        for row in others.iter_mut().filter(|row| decided(row)) {
            let of = values.get(&row.chain).zip(values.get(&first.chain));
            if of.is_none_or(|(own, first)| turns(row, own, first)) {
                row.withheld = Some(reason.clone());
                row.versus_first.iter_mut().for_each(|versus| versus.verdict = None);
                arrangements += 1;
            }
        }
        Ok((arrangements > 0).then_some(TurnedVerdicts { arrangements, class: name, reason }))
    }
}

/// True if the difference of an arrangement to the first has another sign than the one it is judged by.
fn turns(row: &Arrangement, own: &ChainValues, first: &ChainValues) -> bool {
    let sign = if row.verdict() == Some(Verdict::Better) { -1.0 } else { 1.0 };
    let fitted = own.best_fit_um.zip(first.best_fit_um).map(|(own, first)| own - first);
    std::iter::once(own.um - first.um).chain(fitted).any(|difference| sign * difference <= 0.0)
}
