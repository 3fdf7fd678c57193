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

/// The same, with its basis.
pub(crate) fn lift(call: &mut Call, machine: &Machine, text: &str) -> Result<WeilLift, Refused> {
    let declared = declare(call, machine, text)?;
    declared.build().or_else(|refusal| call.refuse(refusal))
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
