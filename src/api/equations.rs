//! The closed forms: joint matrices, E_VE and deviations as polynomials in the errors.

use super::algebra;
use crate::algebra::symbolic::Symbolic;
use crate::algebra::{Algebra, Htm};
use crate::analysis::{Equations, Naming, Options, Symbol, SymbolMeaning, equations as closed_forms};
use crate::diagnostic::Diagnostics;
use crate::job::machine_file::MachineFile;
use crate::machine::Machine;
use crate::report::equations as print;
use crate::run::{Answer, Call, Refused, Run};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// Options of [`equations`].
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct EquationsOptions {
    /// Highest degree in the errors, every error on its own; 1 by default.
    pub order: Option<u8>,
    /// The algebra of the errors instead, in the words of the section `algebra` of a machine file; an empty text takes
    /// that section.
    pub algebra: Option<String>,
    /// Names of the symbols.
    pub symbols: Naming,
    /// True if the length of the tool stays the symbol L.
    pub tool_length: bool,
}

/// The closed forms of a machine; mm and rad, workpiece frame. Serialises as docs/formats.md describes.
#[derive(Debug, Clone)]
pub struct EquationsResult {
    machine: Machine,
    degree: u8,
    equations: Equations,
}

impl EquationsResult {
    /// Returns the closed forms as text.
    pub fn text(&self) -> String {
        print::text(&self.machine, &self.equations)
    }

    /// Returns the closed forms as a LaTeX document.
    pub fn latex(&self) -> String {
        print::latex(&self.machine, &self.equations)
    }
}

impl Serialize for EquationsResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        contract(&self.machine, self.degree, &self.equations).serialize(serializer)
    }
}

/// Returns the closed forms of a machine.
///
/// Fails for an algebra that does not fit the machine, and for errors that are no polynomials of the position.
pub fn equations(
    file: &MachineFile,
    options: &EquationsOptions,
    run: Run<'_>,
) -> Result<Answer<EquationsResult>, Diagnostics> {
    Call::answer_by_hand(run, file.sources(), |call| found(call, file, options))
}

fn found(call: &mut Call<'_>, machine: &Machine, options: &EquationsOptions) -> Result<EquationsResult, Refused> {
    let text = options.algebra.clone().unwrap_or_else(|| format!("degree: {}", options.order.unwrap_or(1)));
    let declared = algebra::declared(call, machine, &text)?;
    let (naming, tool_length) = (options.symbols, options.tool_length);
    let found = closed_forms(machine, &declared, Options { naming, tool_length });
    let equations = found.or_else(|refusal| call.refuse(refusal))?;
    Ok(EquationsResult { machine: machine.clone(), degree: declared.ideal().degree, equations })
}

fn contract(machine: &Machine, degree: u8, found: &Equations) -> Value {
    let symbols = &found.symbols;
    let matrix = |htm: &Htm<Symbolic>| rows(&htm.to_matrix(), symbols);
    let joints: serde_json::Map<_, _> = found.joints.iter().map(|(name, htm)| (name.clone(), matrix(htm))).collect();
    let vector = |v: &nalgebra::Vector3<Symbolic>| -> Vec<Value> { v.iter().map(|p| polynomial(p, symbols)).collect() };
    json!({
        "machine": machine.name(), "degree": degree, "frame": "workpiece",
        "units": {"length": "mm", "angle": "rad"},
        "symbols": symbols.iter().map(|s| symbol(machine, s)).collect::<Vec<_>>(),
        "joints": joints, "t_tool": matrix(&found.t_tool), "t_work": matrix(&found.t_work),
        "e_ve": rows(&found.e_ve, symbols), "deviation": vector(&found.position), "rotation": vector(&found.rotation),
    })
}

fn rows(matrix: &nalgebra::Matrix4<Symbolic>, symbols: &[Symbol]) -> Value {
    let row = |i: usize| (0..4).map(|j| polynomial(&matrix[(i, j)], symbols)).collect::<Vec<_>>();
    json!((0..4).map(row).collect::<Vec<_>>())
}

/// Terms with their order; `powers` by the symbol.
fn polynomial(polynomial: &Symbolic, symbols: &[Symbol]) -> Value {
    let of_order = |degree: usize| {
        let part = polynomial.part(degree);
        let term = |(monomial, coefficient): (&crate::algebra::weil::Monomial, f64)| {
            let power = |(index, power): &(u16, u8)| (symbols[usize::from(*index)].text.clone(), json!(power));
            let powers: serde_json::Map<_, _> = monomial.factors().iter().map(power).collect();
            json!({"coefficient": coefficient, "powers": powers, "order": degree})
        };
        part.terms().map(term).collect::<Vec<_>>()
    };
    let terms: Vec<Value> = (0..=polynomial.order()).flat_map(of_order).collect();
    json!({"text": print::polynomial_text(polynomial, symbols), "terms": terms})
}

fn symbol(machine: &Machine, symbol: &Symbol) -> Value {
    let axis = |index: usize| machine.axes()[index].name.as_str();
    let (kind, of) = match symbol.meaning {
        SymbolMeaning::Error(source, _) => {
            let all = crate::lower::named_sources(machine);
            ("error", all.iter().find(|g| g.source == source).map_or(String::new(), |g| g.name.clone()))
        }
        SymbolMeaning::Position(i) => ("position", axis(i).to_owned()),
        SymbolMeaning::Sine(i) => ("sine", axis(i).to_owned()),
        SymbolMeaning::Cosine(i) => ("cosine", axis(i).to_owned()),
        SymbolMeaning::ToolLength => ("tool_length", "Z".to_owned()),
    };
    json!({"symbol": symbol.text, "kind": kind, "of": of, "sign": symbol.sign(), "latex": symbol.latex})
}
