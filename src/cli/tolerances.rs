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
    distribution: Distribution,
}

/// Options of the errors that are drawn, and of their effect.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ToleranceArgs {
    #[command(flatten)]
    pub(super) bounds: BoundsArgs,
    /// Figure of a machine: its largest deviation over the poses, or the 95 % one.
    #[arg(long, value_enum, default_value = "max")]
    statistic: Statistic,
}

impl ToleranceArgs {
    pub(super) fn options(&self) -> ToleranceOptions {
        ToleranceOptions { statistic: self.statistic, ..self.bounds.options() }
    }
}

impl BoundsArgs {
    pub(super) fn options(&self) -> ToleranceOptions {
        let (class, distribution) = (self.class.clone(), self.distribution);
        ToleranceOptions { class, distribution, statistic: Statistic::default() }
    }
}
