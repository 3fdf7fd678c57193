//! The limit of a job: the largest position deviation that the part allows.

use crate::analysis::budget::Statistic;
use crate::analysis::{SummaryBand, figure_of};
use crate::evaluate::Summary;
use crate::units::{by_uncertainty, counted, significant};

/// A limit with what it is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JobLimit {
    /// The limit, mm.
    pub mm: f64,
    /// The figure of a machine over the poses.
    pub statistic: Statistic,
    /// Number of tool poses of the job that the machine does not reach.
    pub missed: usize,
    /// True if errors or bounds of the machine are left out of the figure, so that it decides nothing.
    pub is_partial: bool,
}

/// A figure against the limit of a job.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LimitVerdict {
    /// The limit, um.
    pub limit_um: f64,
    /// The position deviation that is judged, um: the statistic over the poses; of machines drawn the value that 95 %
    /// of them do not exceed.
    pub um: f64,
    /// The interval in which it lies, um: of machines drawn by their number, else by the uncertainties of errors that
    /// the file states; none without such.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_um: Option<[f64; 2]>,
    /// The figure of a machine over the poses.
    pub statistic: Statistic,
    /// True if machines are drawn between bounds; errors with values act in each.
    pub drawn: bool,
    /// Number of tool poses of the job that are out of reach.
    pub missed: usize,
    /// True if errors or bounds of the machine are left out of the figure, so that it decides nothing.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub partial: bool,
    /// The errors with neither value nor bound that could turn the verdict, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<MissingInLimit>,
    /// True if the limit is held; none where the interval is on both sides of it, where it is not exceeded but tool
    /// poses are out of reach, so that the job is not done, where errors or bounds are left out of the figure, and
    /// where missing errors could turn it.
    pub held: Option<bool>,
}

impl JobLimit {
    /// Returns the verdict on the deviations of one machine over the poses, um, with their intervals if uncertainties
    /// of its errors are stated.
    pub(crate) fn on_values(&self, position_um: &Summary, band: Option<&SummaryBand>) -> LimitVerdict {
        let (um, interval) = figure_of(self.statistic, position_um, band);
        self.judge(um, interval, false)
    }

    /// Returns the verdict on the 95 % value (um) of machines drawn, with its interval. If the values that act in each
    /// are uncertain, `spread_um` is by how much their own figure may be smaller and larger.
    pub(crate) fn on_machines(
        &self,
        um: f64,
        interval_um: Option<[f64; 2]>,
        spread_um: Option<[f64; 2]>,
    ) -> LimitVerdict {
        let interval = match spread_um {
            None => interval_um,
            Some(spread) => Some(widened(interval_um.unwrap_or([um, um]), spread)),
        };
        self.judge(um, interval, true)
    }

    /// Returns by how much the figure of one machine's deviations (um) may be smaller and larger.
    pub(crate) fn spread_um(&self, position_um: &Summary, band: Option<&SummaryBand>) -> Option<[f64; 2]> {
        let (um, interval) = figure_of(self.statistic, position_um, band);
        interval.map(|[low, high]| [low - um, high - um])
    }

    fn judge(&self, um: f64, interval_um: Option<[f64; 2]>, drawn: bool) -> LimitVerdict {
        let Self { mm, statistic, missed, is_partial } = *self;
        let limit_um = mm * 1e3;
        let held = match interval_um {
            Some([low, high]) if low <= limit_um && limit_um < high => None,
            Some([_, high]) => Some(high <= limit_um),
            None => Some(um <= limit_um),
        };
        let held = held.filter(|held| !is_partial && (!held || missed == 0));
        LimitVerdict { limit_um, um, interval_um, statistic, drawn, missed, partial: is_partial, missing: None, held }
    }
}

/// Returns an interval of machines drawn (um) with what the uncertainty of values in each adds to either side.
pub(crate) fn widened([from, to]: [f64; 2], [low, high]: [f64; 2]) -> [f64; 2] {
    [(from + low).max(0.0), to + high]
}

/// Errors with neither value nor bound that could turn a limit that is held without them.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MissingInLimit {
    /// Number of these errors.
    pub errors: usize,
    /// The class that has bounds for them.
    pub class: String,
    /// The figure with these bounds, um; none where it was not asked for, place by place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub um: Option<f64>,
}

impl LimitVerdict {
    /// Returns the verdict that is not decided, for missing errors could turn it.
    pub(crate) fn left_open(self, missing: MissingInLimit) -> Self {
        Self { held: None, missing: Some(missing), ..self }
    }

    /// Returns the verdict in words, such as `limit 30 um: held, 95 % of machines within 25.31 um (24.8..26.0)`.
    pub fn words(&self) -> String {
        let missed = self.missed;
        let open = |MissingInLimit { errors, class, um }: &MissingInLimit| {
            let errors = counted(*errors, "error");
            let with = um.map_or_else(String::new, |um| format!(": {} um", significant(um, 4)));
            format!("not decided, {errors} with neither value nor bound could turn it (class {class} has bounds{with})")
        };
        let verdict = match (self.held, &self.missing) {
            (Some(true), _) => "held".to_owned(),
            (Some(false), _) => "exceeded".to_owned(),
            (None, Some(missing)) => open(missing),
            (None, None) if self.partial => "not decided, for values or bounds of the machine are left out".to_owned(),
            (None, None) if missed > 0 => format!("not decided, {} out of reach", counted(missed, "tool pose")),
            (None, None) => "not decided".to_owned(),
        };
        let um = match self.interval_um {
            Some([low, high]) => {
                let [um, low, high] = by_uncertainty(self.um, Some(low), Some(high));
                format!("{um} um ({low}..{high})")
            }
            None => format!("{} um", significant(self.um, 4)),
        };
        let figure = match (self.drawn, self.statistic) {
            (false, Statistic::Max) => "largest deviation",
            (false, Statistic::P95) => "95 % of the poses within",
            (true, Statistic::Max) => "95 % of machines within",
            (true, Statistic::P95) => "95 % of machines at 95 % of the poses within",
        };
        format!("limit {} um: {verdict}; {figure} {um}", significant(self.limit_um, 6))
    }
}
