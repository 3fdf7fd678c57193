//! Options of the verbs that draw errors between bounds.

use abbe::options::{Distribution, Statistic, ToleranceOptions};

/// Options of the bounds of errors, and of their draws.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct BoundsArgs {
    /// Tolerances typical of a class of machines where the file has none, in place of its `class`: ultra-precision,
    /// premium, production, commodity, large-gantry, desktop.
    #[arg(long, value_name = "NAME")]
    pub(super) class: Option<String>,
    /// Distribution of an error between its bounds.
    #[arg(long, value_enum, default_value = "uniform")]
    distribution: DistributionArg,
}

/// Options of the errors that are drawn, and of their effect.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ToleranceArgs {
    #[command(flatten)]
    pub(super) bounds: BoundsArgs,
    /// Figure of a machine: its largest deviation over the poses, or the 95 % one.
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
        ToleranceOptions { statistic: self.statistic(), ..self.bounds.options() }
    }

    fn statistic(&self) -> Statistic {
        match self.statistic {
            StatisticArg::Max => Statistic::Max,
            StatisticArg::P95 => Statistic::P95,
        }
    }
}

impl BoundsArgs {
    pub(super) fn options(&self) -> ToleranceOptions {
        ToleranceOptions {
            class: self.class.clone(),
            distribution: self.distribution(),
            statistic: Statistic::default(),
        }
    }

    fn distribution(&self) -> Distribution {
        match self.distribution {
            DistributionArg::Uniform => Distribution::Uniform,
            DistributionArg::Triangular => Distribution::Triangular,
        }
    }
}
