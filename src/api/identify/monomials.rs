//! The fit of Holub and others 2015: monomials of order 2, each component for itself, pseudo-inverse.

use super::{IdentifyOptions, NamedSvg};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Order;
use crate::identify::verdict::problem::Problem;
use crate::identify::verdict::remarks::{entries_without_effect, unlikely_sizes};
use crate::identify::{MonomialComponent, moore_penrose, typical_size};
use crate::job::machine_file::MachineFile;
use crate::report::fit_planes::draw_monomials;
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
    /// Pictures, if they were asked for: of each plane of two linear axes phantom and fit.
    #[serde(skip)]
    pub pictures: Vec<NamedSvg>,
    /// Name of the machine.
    #[serde(skip)]
    pub machine: String,
}

/// Fits monomials of the errors to measured deviations, each component for itself.
///
/// Fails as [`identify`](super::identify) does, for other readings than deviations, and for options that have no effect
/// on coefficients of monomials: `machine_file`, `robust`, `folds`, `range`, `accept`, `priors`, `type_b`, `noise_mm`,
/// and an `order` other than 1 or 2.
pub fn fit_monomials(file: &MachineFile, options: &IdentifyOptions, run: Run) -> Reply<MonomialFit> {
    Call::answer(run, file.sources(), |call| {
        let order = match options.order {
            None | Some(Order::Degree(2)) => 2,
            Some(Order::Degree(1)) => 1,
            Some(_) => return call.usage("`--method moore-penrose` has monomials of `--order 1` or `--order 2`"),
        };
        let idle = options.without_effect_on_monomials();
        if !idle.is_empty() {
            let message = format!(
                "`--method moore-penrose` gives coefficients of monomials by what is read alone, no machine: no {}",
                idle.join(", ")
            );
            return call.usage(message);
        }
        let problem = Problem::read(call, file, &options.inputs())?;
        let entries =
            [(problem.known.is_empty() && problem.gauges.is_empty(), "prior"), (problem.type_b.is_empty(), "type_b")];
        let idle: Vec<String> =
            entries.into_iter().filter(|(is_empty, _)| !is_empty).map(|(_, key)| key.to_owned()).collect();
        call.extend(entries_without_effect(&idle));
        let model = problem.model(file, Order::Exact);
        if model.own() > MAX_FACTORS && order > 1 {
            let message = format!("{} parameters have too many products for the papers' way", model.own());
            let help = format!("at most {MAX_FACTORS}; `--order 1` and the joint fit take more");
            return call.refuse(Diagnostic::new(codes::E0508, message).help(help));
        }
        let Some(components) = moore_penrose(&model, &problem.rows, order) else {
            let help = "leave the other files out, or use the joint fit";
            let message = "the papers' way takes deviations dx, dy, dz only";
            return call.refuse(Diagnostic::new(codes::E0510, message).help(help));
        };
        call.extend(unlikely_sizes(typical_size(&model, &problem.rows), 0.0));
        let pictures = if options.pictures {
            draw_monomials(&model, &problem.rows, &components).or_else(|refusal| call.refuse(refusal))?
        } else {
            Vec::new()
        };
        Ok(MonomialFit { method: "moore-penrose", order, components, pictures, machine: file.name().to_owned() })
    })
}
