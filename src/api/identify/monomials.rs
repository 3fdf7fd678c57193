//! The fit of Holub and others 2015: monomials of order 2, each component for itself, pseudo-inverse.

use super::IdentifyOptions;
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::identify::verdict::problem::Problem;
use crate::identify::{Coefficient, Component, moore_penrose};
use crate::job::machine_file::MachineFile;
use crate::run::{Answer, Call, Run};
use serde::Serialize;

/// Maximum number of parameters whose products are unknowns.
const MAX_FACTORS: usize = 24;

/// Coefficients of monomials of the errors, which give no machine.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MonomialFit {
    /// `moore-penrose`.
    pub method: &'static str,
    /// Highest degree of the monomials.
    pub order: u8,
    /// The components of the deviation.
    pub components: Vec<MonomialComponent>,
    /// Name of the machine.
    #[serde(skip)]
    pub machine: String,
}

/// One component of the deviation.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MonomialComponent {
    /// `dx`, `dy` or `dz`.
    pub component: &'static str,
    /// Number of readings.
    pub readings: usize,
    /// Number of monomials.
    pub columns: usize,
    /// Rank of the problem.
    pub rank: usize,
    /// Root mean square of the readings.
    pub rms_um: Rms,
    /// The coefficients.
    pub coefficients: Vec<MonomialCoefficient>,
}

/// Root mean square of readings, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Rms {
    /// As measured.
    pub before: f64,
    /// After the fit.
    pub after: f64,
}

/// The coefficient of a monomial.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MonomialCoefficient {
    /// Name such as `EX0C` or `EA0C*EB0C`.
    pub monomial: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// True if the data tell it from the others.
    pub determined: bool,
}

impl MonomialComponent {
    fn of(component: &Component) -> Self {
        Self {
            component: ["dx", "dy", "dz"][component.index.min(2)],
            readings: component.readings,
            columns: component.coefficients.len(),
            rank: component.rank,
            rms_um: Rms { before: component.rms[0] * 1e3, after: component.rms[1] * 1e3 },
            coefficients: component.coefficients.iter().map(MonomialCoefficient::of).collect(),
        }
    }
}

impl MonomialCoefficient {
    fn of(coefficient: &Coefficient) -> Self {
        let Coefficient { name, value, unit, determined, .. } = coefficient.clone();
        Self { monomial: name, value, unit, determined }
    }
}

/// Fits monomials of the errors to measured deviations, each component for itself.
///
/// Fails as [`identify`](super::identify) does, for other readings than deviations, and for options that need a fitted
/// machine: `machine_file`, `pictures`, `robust`, `folds`.
pub fn fit_monomials(
    file: &MachineFile,
    options: &IdentifyOptions,
    run: Run,
) -> Result<Answer<MonomialFit>, Diagnostics> {
    Call::answer(run, file.sources(), |call| {
        let inputs = options.inputs();
        let problem = Problem::read(call, file, &inputs)?;
        if options.machine_file || options.pictures || options.robust || options.folds.is_some() {
            return call.usage(
                "`--method moore-penrose` gives coefficients of monomials, no machine: no --out, --svg, --robust, \
                 --folds",
            );
        }
        let model = problem.model(file, inputs.order);
        if model.own() > MAX_FACTORS {
            let message = format!("{} parameters have too many products for the papers' way", model.own());
            let help = format!("at most {MAX_FACTORS}; the joint fit takes more");
            return call.refuse(Diagnostic::new(codes::E0508, message).help(help));
        }
        let Some(components) = moore_penrose(&model, &problem.rows) else {
            let help = "leave the other files out, or use the joint fit";
            let message = "the papers' way takes deviations dx, dy, dz only";
            return call.refuse(Diagnostic::new(codes::E0510, message).help(help));
        };
        let components = components.iter().map(MonomialComponent::of).collect();
        Ok(MonomialFit { method: "moore-penrose", order: 2, components, machine: file.name().to_owned() })
    })
}
