//! The fit of Holub and others 2015: monomials of order 2, each component for itself, pseudo-inverse.

use super::IdentifyOptions;
use crate::diagnostic::{Diagnostic, codes};
use crate::identify::verdict::problem::Problem;
use crate::identify::{MonomialComponent, moore_penrose};
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Reply, Run};
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

/// Fits monomials of the errors to measured deviations, each component for itself.
///
/// Fails as [`identify`](super::identify) does, for other readings than deviations, and for options that need a fitted
/// machine: `machine_file`, `pictures`, `robust`, `folds`.
pub fn fit_monomials(file: &MachineFile, options: &IdentifyOptions, run: Run) -> Reply<MonomialFit> {
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
        Ok(MonomialFit { method: "moore-penrose", order: 2, components, machine: file.name().to_owned() })
    })
}
