//! The algebra asked for: in the words of the machine file's section `algebra`, or that section itself.

use crate::diagnostic::{Diagnostic, codes, shown};
use crate::lower::{DeclaredAlgebra, WeilLift};
use crate::machine::{AlgebraChoice, Machine};
use crate::run::{Call, Refused};
use crate::syntax::{AlgebraEntry, from_yaml};

/// The algebra declared by a text (empty: by the machine file), with its generators.
pub(crate) fn declare(call: &mut Call, machine: &Machine, text: &str) -> Result<DeclaredAlgebra, Refused> {
    let choice = if text.trim().is_empty() { of_machine(machine) } else { of_text(text) };
    let declared = choice.and_then(|choice| DeclaredAlgebra::new(machine, &choice));
    declared.or_else(|refusal| call.refuse(refusal))
}

/// Products of elements for a joint at a pose.
const PRODUCTS_OF_A_JOINT: f64 = 150.0;

/// Multiplications of numbers that one call may take: some ten seconds.
const MAX_MULTIPLICATIONS: f64 = 4e9;

/// The same, with its basis, for so many poses.
pub(crate) fn lift(call: &mut Call, machine: &Machine, text: &str, poses: usize) -> Result<WeilLift, Refused> {
    let declared = declare(call, machine, text)?;
    let joints = (poses * (machine.axes().len() + 2)) as f64;
    let built = declared.build().and_then(|lift| {
        let work = lift.basis().products() as f64 * PRODUCTS_OF_A_JOINT * joints;
        within_time(lift, work, poses)
    });
    built.or_else(|refusal| call.refuse(refusal))
}

/// The algebra that a result was computed over.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct AlgebraResult {
    /// Names of the generators, x1 first.
    pub generators: Vec<String>,
    /// Order of monomials: graded reverse lexicographic, x1 > x2 > ...
    pub monomial_order: &'static str,
    /// Reduced Groebner basis of the ideal up to the degree, each element solved for its leading monomial; empty
    /// without relations.
    pub groebner_basis: Vec<String>,
    /// Monomials that are a basis of the algebra over the reals.
    pub monomials: Vec<String>,
}

impl AlgebraResult {
    pub(crate) fn of(lift: &WeilLift) -> Self {
        Self {
            generators: lift.declared().names().to_vec(),
            monomial_order: "grevlex",
            groebner_basis: lift.relations(),
            monomials: lift.monomials(),
        }
    }
}

/// Refuses a calculation that would take long.
fn within_time(lift: WeilLift, work: f64, poses: usize) -> Result<WeilLift, Diagnostic> {
    if work <= MAX_MULTIPLICATIONS {
        return Ok(lift);
    }
    let message = format!(
        "{} monomials at {poses} poses are {work:.1e} multiplications, {MAX_MULTIPLICATIONS:.0e} are taken",
        lift.basis().monomials().len()
    );
    let help = "lower the degree, group the errors (`generators: per-axis`), let more monomials vanish, or ask at \
                fewer poses";
    Err(Diagnostic::new(codes::E0523, message).help(help))
}

/// Returns the name printed beside results.
pub(crate) fn name(lift: &WeilLift) -> String {
    let basis = lift.basis();
    let (generators, monomials) = (lift.declared().names().len(), basis.monomials().len());
    format!("{} in {generators} generators, {monomials} monomials", lift.declared().ideal().degree)
}

fn of_machine(machine: &Machine) -> Result<AlgebraChoice, Diagnostic> {
    machine.algebra().cloned().ok_or_else(|| {
        Diagnostic::new(codes::E0814, "the machine file names no algebra")
            .help("add a section `algebra: { degree: 2 }`, or write `--algebra \"degree: 2\"`")
    })
}

fn of_text(text: &str) -> Result<AlgebraChoice, Diagnostic> {
    let entry: AlgebraEntry = from_yaml(&format!("{{{text}}}")).map_err(|failure| {
        let reason = failure.to_string();
        Diagnostic::new(codes::E0814, format!("`{}` is not an algebra: {}", shown(text), shown(&reason)))
            .help("write it as in a machine file: `--algebra \"degree: 3, generators: per-axis, vanish: [X^2]\"`")
    })?;
    AlgebraChoice::new(&entry)
}
