//! The closed forms: joint matrices, E_VE and deviations as polynomials in the errors.

use super::algebra;
use crate::algebra::symbolic::Symbolic;
use crate::algebra::weil::Monomial;
use crate::algebra::{Algebra, Htm};
use crate::analysis::{
    Equations, Naming, Options, OwnParameter, ParameterShare, Symbol, SymbolMeaning, equations_in as closed_forms,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Frame;
use crate::identify::{BasisFunction, Parameter, ParameterTerm, parameters};
use crate::job::machine_file::MachineFile;
use crate::lower::JointFactor;
use crate::machine::Machine;
use crate::report::equations as print;
use crate::run::{Call, Refused, Reply, Run};
use crate::syntax::IdentifyEntry;
use indexmap::IndexMap;
use nalgebra::{Matrix4, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

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
    /// True to list the factors of each joint: nominal motion, error and location matrices.
    pub factors: bool,
}

/// The closed forms of a machine; mm and rad, workpiece frame.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct EquationsResult {
    /// Name of the machine.
    pub machine: String,
    /// Degree of the algebra.
    pub degree: u8,
    /// Frame of the vectors: the workpiece frame.
    pub frame: Frame,
    /// Units of lengths and angles.
    pub units: EquationUnits,
    /// The symbols.
    pub symbols: Vec<EquationSymbol>,
    /// The matrix of each joint.
    pub joints: IndexMap<String, PolynomialMatrix>,
    /// The factors of these matrices in their order, with [`EquationsOptions::factors`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factors: Option<IndexMap<String, Vec<MatrixFactor>>>,
    /// From the bed to the tool.
    pub t_tool: PolynomialMatrix,
    /// From the bed to the workpiece.
    pub t_work: PolynomialMatrix,
    /// The volumetric error E_VE.
    pub e_ve: PolynomialMatrix,
    /// Displacement of the functional point.
    pub deviation: Vec<Polynomial>,
    /// Rotation of the tool.
    pub rotation: Vec<Polynomial>,
    #[serde(skip)]
    of: Machine,
    #[serde(skip)]
    equations: Equations,
}

/// A factor of the matrix of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MatrixFactor {
    /// `N`, `E`, `E^-1`, `Loc`, `Loc^-1`, `Loc N Loc^-1`, `T(o)` and `T(-o)` with o the origin of the axis.
    pub name: &'static str,
    /// The matrix.
    pub matrix: PolynomialMatrix,
}

/// A matrix of polynomials, row by row.
pub type PolynomialMatrix = Vec<Vec<Polynomial>>;

/// Units of closed forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct EquationUnits {
    /// `mm`.
    pub length: &'static str,
    /// `rad`.
    pub angle: &'static str,
}

/// A symbol of closed forms.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EquationSymbol {
    /// As it stands in the text.
    pub symbol: String,
    /// `error`, `parameter`, `position`, `sine`, `cosine` or `tool_length`.
    pub kind: &'static str,
    /// Name of the error or axis.
    pub of: String,
    /// 1 or -1.
    pub sign: f64,
    /// As LaTeX.
    pub latex: String,
}

/// A polynomial in the symbols.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Polynomial {
    /// As text.
    pub text: String,
    /// Its terms.
    pub terms: Vec<PolynomialTerm>,
}

/// A term of a polynomial.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PolynomialTerm {
    /// Its number.
    pub coefficient: f64,
    /// Powers by symbol.
    pub powers: IndexMap<String, u8>,
    /// Its order in the errors.
    pub order: usize,
}

impl EquationsResult {
    fn new(of: Machine, degree: u8, equations: Equations, with_factors: bool) -> Self {
        let symbols = &equations.symbols;
        let matrix = |htm: &Htm<Symbolic>| rows(&htm.to_matrix(), symbols);
        let vector = |v: &Vector3<Symbolic>| v.iter().map(|p| polynomial(p, symbols)).collect();
        Self {
            machine: of.name().to_owned(),
            degree,
            frame: Frame::Workpiece,
            units: EquationUnits { length: "mm", angle: "rad" },
            symbols: symbols.iter().map(|s| symbol(&of, s)).collect(),
            joints: equations.joints.iter().map(|(name, htm)| (name.clone(), matrix(htm))).collect(),
            factors: with_factors.then(|| {
                let one = |f: &JointFactor<Symbolic>| MatrixFactor { name: f.name, matrix: matrix(&f.matrix) };
                equations.factors.iter().map(|j| (j.name.clone(), j.factors.iter().map(one).collect())).collect()
            }),
            t_tool: matrix(&equations.t_tool),
            t_work: matrix(&equations.t_work),
            e_ve: rows(&equations.e_ve, symbols),
            deviation: vector(&equations.position),
            rotation: vector(&equations.rotation),
            of,
            equations,
        }
    }

    /// Returns the closed forms as text.
    pub fn text(&self) -> String {
        print::text(&self.of, &self.equations, self.factors.is_some())
    }

    /// Returns the closed forms as a LaTeX document.
    pub fn latex(&self) -> String {
        print::latex(&self.of, &self.equations, self.factors.is_some())
    }
}

/// Returns the closed forms of a machine.
///
/// Fails for an algebra that does not fit the machine, and for errors that are no polynomials of the position.
pub fn equations(file: &MachineFile, options: &EquationsOptions, run: Run) -> Reply<EquationsResult> {
    Call::answer(run, file.sources(), |call| derive(call, file, options))
}

fn derive(call: &mut Call, machine: &MachineFile, options: &EquationsOptions) -> Result<EquationsResult, Refused> {
    let text = options.algebra.clone().unwrap_or_else(|| format!("degree: {}", options.order.unwrap_or(1)));
    let declared = algebra::declare(call, machine, &text)?;
    if declared.has_relations() {
        let message = "the closed forms keep every product of errors: relations between monomials do not act there";
        let help = "leave the relations out of `vanish`, or evaluate over the algebra by `abbe eval --algebra`";
        return call.refuse(Diagnostic::new(codes::E0525, message).help(help));
    }
    let (naming, tool_length) = (options.symbols, options.tool_length);
    let parameters = match naming {
        Naming::Parameters => own_parameters(machine).or_else(|refusal| call.refuse(refusal))?,
        _ => Vec::new(),
    };
    let found = closed_forms(machine, &declared, Options { naming, tool_length }, &parameters);
    let equations = found.or_else(|refusal| call.refuse(refusal))?;
    let of: &Machine = machine;
    Ok(EquationsResult::new(of.clone(), declared.ideal().degree, equations, options.factors))
}

/// Returns the parameters of the section `identify` of a machine file.
fn own_parameters(machine: &MachineFile) -> Result<Vec<OwnParameter>, Diagnostic> {
    let section = machine.identify.as_ref().map(|section| section.parameters.clone()).unwrap_or_default();
    if section.is_empty() {
        let help = "write `identify: { parameters: { f1: { EBX: [0, 1], EZX: [0, 0, -0.5] } } }`, or ask for \
                    `--symbols paper`";
        return Err(Diagnostic::new(codes::E0525, "the machine file has no parameters of its own").help(help));
    }
    let request =
        IdentifyEntry { fit: section.keys().cloned().collect(), parameters: section, ..IdentifyEntry::default() };
    let power = |basis: &BasisFunction| if let BasisFunction::Power(k) = basis { *k } else { 0 };
    let share =
        |term: &ParameterTerm| ParameterShare { source: term.source, power: power(&term.basis), factor: term.factor };
    let own = |p: Parameter| OwnParameter { moves: p.terms.iter().map(share).collect(), name: p.name };
    let list = parameters(machine, &request).map_err(|refusal| *refusal)?;
    Ok(list.into_iter().map(own).collect())
}

fn rows(matrix: &Matrix4<Symbolic>, symbols: &[Symbol]) -> PolynomialMatrix {
    (0..4).map(|i| (0..4).map(|j| polynomial(&matrix[(i, j)], symbols)).collect()).collect()
}

/// Terms with their order; `powers` by the symbol.
fn polynomial(polynomial: &Symbolic, symbols: &[Symbol]) -> Polynomial {
    let of_order = |order: usize| {
        let part = polynomial.part(order);
        let term = |(monomial, coefficient): (&Monomial, f64)| {
            let power = |(index, power): &(u16, u8)| (symbols[usize::from(*index)].text.clone(), *power);
            PolynomialTerm { coefficient, powers: monomial.factors().iter().map(power).collect(), order }
        };
        part.terms().map(term).collect::<Vec<_>>()
    };
    let terms = (0..=polynomial.order()).flat_map(of_order).collect();
    Polynomial { text: print::polynomial_text(polynomial, symbols), terms }
}

fn symbol(machine: &Machine, symbol: &Symbol) -> EquationSymbol {
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
        SymbolMeaning::Parameter(_) => ("parameter", symbol.text.clone()),
    };
    let Symbol { text, latex, .. } = symbol;
    EquationSymbol { symbol: text.clone(), kind, of, sign: symbol.sign(), latex: latex.clone() }
}
