//! Verdicts, of a ranking or a limit, that errors without a value or a bound could turn.

use super::budgets::stand_in;
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::{ActingErrors, Bound, Coverage, Request, Verdict, VersusFirst, budget};
use crate::analysis::enumerate::{ChainValues, Study};
use crate::analysis::reference::PartReference;
use crate::job::limit::{LimitVerdict, MissingInLimit};
use crate::machine::{Machine, Pose};
use crate::run::{Call, Refused};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

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

/// The values of all arrangements with the bounds of a class for what is missing.
pub(crate) struct FilledStudy {
    values: BTreeMap<String, ChainValues>,
    class: String,
    /// The reason of a verdict that is withheld, in words.
    pub reason: String,
}

impl StudyCoverage<'_> {
    /// Returns the values of a study with the bounds of a class for the missing errors, on so many machines drawn.
    pub(crate) fn fill(&self, call: &Call<'_>, study: &Study<'_>, samples: usize) -> Result<FilledStudy, Refused> {
        let (name, class) = stand_in(self.class, &[self.machine]);
        let study = study.with_bounds(self.coverage.fill(self.machine, self.bounds, &[], class.as_ref()));
        let values = call.stage("arrangements", study.walks(), |advance| study.values_by_chain(samples, advance))?;
        let (missing, acting) = (self.coverage.missing.len(), self.coverage.acting());
        let reason = format!(
            "errors with neither value nor bound could turn it: the file lacks {missing} of {acting}; `--class {name}` \
             bounds them"
        );
        Ok(FilledStudy { values, class: name, reason })
    }
}

impl FilledStudy {
    /// True if the difference of a chain to the first has another sign than that of its verdict.
    pub(crate) fn turns(&self, chain: &str, first: &str, verdict: Verdict) -> bool {
        let sign = if verdict == Verdict::Better { -1.0 } else { 1.0 };
        let Some((own, first)) = self.values.get(chain).zip(self.values.get(first)) else { return true };
        let fitted = own.best_fit_um.zip(first.best_fit_um).map(|(own, first)| own - first);
        std::iter::once(own.um - first.um).chain(fitted).any(|difference| sign * difference <= 0.0)
    }

    /// Returns the statement of so many verdicts that are withheld; `None` without.
    pub(crate) fn count(self, arrangements: usize) -> Option<TurnedVerdicts> {
        let Self { class, reason, .. } = self;
        (arrangements > 0).then_some(TurnedVerdicts { arrangements, class, reason })
    }
}

/// The machine, the bounds and the work by which a limit was judged.
#[derive(Clone, Copy)]
pub(crate) struct LimitWork<'a> {
    pub machine: &'a Machine,
    /// The bounds in force.
    pub bounds: &'a [Bound],
    pub poses: &'a [Pose],
    /// Motion that the part's set-up takes out.
    pub reference: Option<&'a PartReference>,
    pub tolerances: &'a ToleranceOptions,
    pub samples: usize,
    pub seed: u64,
}

impl LimitWork<'_> {
    /// Returns the verdict on a limit, unless it is held and would not be if missing errors had the bounds of a class.
    pub(crate) fn open(&self, call: &Call<'_>, verdict: LimitVerdict) -> Result<LimitVerdict, Refused> {
        let Self { machine, bounds, poses, reference, tolerances, samples, seed } = *self;
        if verdict.held != Some(true) || poses.is_empty() {
            return Ok(verdict);
        }
        let coverage = Coverage::of(machine, bounds);
        if coverage.missing.is_empty() {
            return Ok(verdict);
        }
        let (name, class) = stand_in(tolerances.class_name(machine), &[machine]);
        let errors = coverage.missing.len();
        // With a minimum zone no machines are drawn.
        if reference.is_some_and(|of| !of.is_linear()) {
            return Ok(verdict.left_open(MissingInLimit { errors, class: name, um: None }));
        }
        let filled = coverage.fill(machine, bounds, &[], class.as_ref());
        let (draws, statistic, acting) = (&tolerances.draws(seed), tolerances.statistic, ActingErrors::OfMachine);
        let bounds = filled.as_slice();
        let (searched, at) = (false, None);
        let request = Request { machine, acting, bounds, poses, reference, searched, at, draws, samples, statistic };
        let um = call
            .stage("machines drawn", 2 * samples, |advance| budget(request, advance))?
            .position
            .percentile(95)
            .value;
        if um <= verdict.limit_um {
            return Ok(verdict);
        }
        Ok(verdict.left_open(MissingInLimit { errors, class: name, um: Some(um) }))
    }
}

/// Returns the reason why there is no verdict, if machine coordinates and best fit do not agree.
pub(super) fn apart(own: VersusFirst, best_fit: VersusFirst) -> Option<String> {
    let (own, best_fit) = (own.verdict, best_fit.verdict);
    (own != best_fit).then(|| format!("{} in machine coordinates, {} with the best fit", own.words(), best_fit.words()))
}
