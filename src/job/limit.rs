//! The limit of a job: the largest 95 % value of the position deviation that the part allows.

use crate::units::significant;

/// A figure against the limit of a job.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LimitVerdict {
    /// The limit, um.
    pub limit_um: f64,
    /// The 95 % value of the position deviation, um.
    pub um: f64,
    /// The interval in which it lies, um; none where it is not drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_um: Option<[f64; 2]>,
    /// True if it holds the limit; none where the interval is on both sides of it.
    pub held: Option<bool>,
}

impl LimitVerdict {
    /// Returns the verdict on a figure (um) with its interval, for a limit in mm.
    pub(crate) fn new(limit_mm: f64, um: f64, interval_um: Option<[f64; 2]>) -> Self {
        let limit_um = limit_mm * 1e3;
        let held = match interval_um {
            Some([low, high]) if low <= limit_um && limit_um < high => None,
            Some([_, high]) => Some(high <= limit_um),
            None => Some(um <= limit_um),
        };
        Self { limit_um, um, interval_um, held }
    }

    /// Returns the verdict in words, such as `limit 30 um: held, 25.31 um (24.8..26.0)`.
    pub fn words(&self) -> String {
        let verdict = match self.held {
            Some(true) => "held",
            Some(false) => "exceeded",
            None => "not told",
        };
        let end = |um: f64| significant(um, 4);
        let interval =
            self.interval_um.map_or_else(String::new, |[low, high]| format!(" ({}..{})", end(low), end(high)));
        format!("limit {} um: {verdict}, 95 % value {} um{interval}", significant(self.limit_um, 6), end(self.um))
    }
}
