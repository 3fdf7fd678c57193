//! Options of the verbs that draw errors between bounds, and the bounds they come to.

use super::Exit;
use super::output::session::Session;
use crate::analysis::budget::{Bound, Class, Distribution, Draws, Statistic, bounds, classes, known, lacks_rotary};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::Machine;
use crate::report::DrawSettings;

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

    /// For those who read the result.
    pub(super) fn drawing(&self, source: Option<String>, samples: usize, seed: u64) -> DrawSettings {
        let (distribution, statistic) = (self.distribution(), self.statistic());
        DrawSettings { class: self.class.clone().zip(source), samples, seed, distribution, statistic }
    }

    pub(super) fn draws(&self, seed: u64) -> Draws {
        Draws::new(seed, self.distribution())
    }

    /// The bounds of the file and of the class, and the class's source.
    pub(super) fn bounds(
        &self,
        session: &mut Session,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<String>), Exit> {
        let (list, source) = self.bounds_if_any(session, machine)?;
        if list.is_empty() { session.refuse(nothing_bounded(machine)) } else { Ok((list, source)) }
    }

    /// The same where a machine may have none.
    pub(super) fn bounds_if_any(
        &self,
        session: &mut Session,
        machine: &Machine,
    ) -> Result<(Vec<Bound>, Option<String>), Exit> {
        let class = match &self.class {
            Some(name) => Some(find(session, machine, name)?),
            None => None,
        };
        Ok((bounds(machine, class.as_ref()), class.map(|class| class.source)))
    }
}

fn find(session: &mut Session, machine: &Machine, name: &str) -> Result<Class, Exit> {
    let mut classes = classes();
    let Some(class) = classes.remove(name) else {
        let known: Vec<&str> = classes.keys().map(String::as_str).collect();
        let message = format!("there is no class of machines `{}`", shown(name));
        return session.refuse(Diagnostic::new(codes::E0605, message).help(did_you_mean(name, &known)));
    };
    if lacks_rotary(machine, &class) {
        let message = format!("the class `{name}` knows nothing of rotary axes, and the machine has some");
        let help = "take another class, or write the tolerances of the rotary axes into a variant of the file and leave `--class` out";
        return session.refuse(Diagnostic::new(codes::E0605, message).help(help));
    }
    Ok(class)
}

fn nothing_bounded(machine: &Machine) -> Diagnostic {
    let given = known(machine);
    let message = format!("`{}` has no error that is only bounded", shown(machine.name()));
    let values =
        if given > 0 { format!("its {given} errors have values, which a budget leaves out; ") } else { String::new() };
    Diagnostic::new(codes::E0604, message).help(format!(
        "{values}write bounds, `EAY: {{ tolerance: 20 urad }}`, or take those of a class: `--class production`"
    ))
}
