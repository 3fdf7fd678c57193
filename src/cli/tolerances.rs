//! Options of the verbs that draw errors between bounds.

use super::Exit;
use super::output::session::Session;
use crate::analysis::budget::Draws;
use crate::api::{Bound, Distribution, Statistic, ToleranceOptions};
use crate::machine::Machine;
use crate::report::Drawing;

/// How errors are drawn and judged.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ToleranceArgs {
    /// Tolerances typical of a class of machines where the file has none: ultra-precision, premium,
    /// production, commodity, large-gantry, desktop.
    #[arg(long, value_name = "NAME")]
    pub(super) class: Option<String>,
    /// How an error is distributed between its bounds.
    #[arg(long, value_enum, default_value = "uniform")]
    distribution: DistributionArg,
    /// What counts of a machine: its largest deviation over the poses, or the 95 % one.
    #[arg(long, value_enum, default_value = "max")]
    statistic: StatisticArg,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum DistributionArg {
    Uniform,
    Triangular,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum StatisticArg {
    Max,
    P95,
}

impl ToleranceArgs {
    pub(super) fn options(&self) -> ToleranceOptions {
        ToleranceOptions { class: self.class.clone(), distribution: self.distribution(), statistic: self.statistic() }
    }

    pub(super) fn distribution(&self) -> Distribution {
        match self.distribution {
            DistributionArg::Uniform => Distribution::Uniform,
            DistributionArg::Triangular => Distribution::Triangular,
        }
    }

    pub(super) fn statistic(&self) -> Statistic {
        match self.statistic {
            StatisticArg::Max => Statistic::Max,
            StatisticArg::P95 => Statistic::P95,
        }
    }

    /// For verbs that compute on their own.
    pub(super) fn drawing(&self, source: Option<String>, samples: usize, seed: u64) -> Drawing {
        self.options().drawing(source, samples, seed)
    }

    /// For verbs that compute on their own.
    pub(super) fn draws(&self, seed: u64) -> Draws {
        self.options().draws(seed)
    }

    /// For verbs that compute on their own.
    pub(super) fn bounds_if_any(
        &self,
        session: &mut Session,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<String>), Exit> {
        session.within(|call| self.options().bounds_if_any(call, machine))
    }
}
