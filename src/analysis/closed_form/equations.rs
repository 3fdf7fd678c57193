//! The closed forms of a machine: the lowering over polynomials in symbols.
//!
//! 1. Every error that is given becomes a symbol, as large as its generator in the declared algebra;
//!    positions of linear axes become symbols, those of rotary axes a sine and a cosine.
//! 2. The same joints and the same chain as in every evaluation are multiplied.
//! 3. E_VE takes the inverse joint by joint; deviations are those of `eval`, workpiece frame.

use super::symbols::{self, Naming, Symbol, SymbolMeaning};
use crate::algebra::symbolic::{MAX_PRODUCTS, Rules, SymbolKind, Symbolic};
use crate::algebra::{Algebra, Htm};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::rotation;
use crate::lower::{
    Chain, DeclaredAlgebra, ErrorLift, ErrorSite, JointPosition, NamedSource, Source, into_part, named_sources,
    unit_values,
};
use crate::machine::{Axis, AxisKind, Joints, Location, LocationOrder, Machine};
use nalgebra::{Matrix4, Vector3};
use num_traits::Zero;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Options of the notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Letters of the symbols.
    pub naming: Naming,
    /// True to write the length of the tool as the symbol L instead of a number.
    pub tool_length: bool,
}

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Equations {
    /// The symbols, by the index that polynomials use.
    pub symbols: Vec<Symbol>,
    /// The matrix G of every axis, and of the spindle if it has errors, with their names.
    pub joints: Vec<(String, Htm<Symbolic>)>,
    /// Matrix from the bed to the tool.
    pub t_tool: Htm<Symbolic>,
    /// Matrix from the bed to the workpiece.
    pub t_work: Htm<Symbolic>,
    /// (T_tool^-1 T_work) actual minus nominal, between workpiece frame and tool frame.
    pub e_ve: Matrix4<Symbolic>,
    /// Deviation of the functional point, mm.
    pub position: Vector3<Symbolic>,
    /// Deviation of the tool's orientation, rad.
    pub rotation: Vector3<Symbolic>,
}

/// Returns the closed forms of a machine in a declared algebra. Fails if they are no polynomials, or exceed
/// [`MAX_PRODUCTS`].
pub fn equations(machine: &Machine, declared: &DeclaredAlgebra, options: Options) -> Result<Equations, Diagnostic> {
    let errors = named_sources(machine);
    if let Some(culprit) = errors.iter().find(|error| !is_polynomial(machine, error)) {
        return Err(no_polynomial(&culprit.name));
    }
    let alphabet = Alphabet::new(machine, declared, &errors, options);
    let at = alphabet.positions(machine);
    let mut actual = Chain::actual_at(machine, &at, &unit_values(machine), &alphabet);
    let mut nominal = Chain::nominal_at(machine, &at);
    if let Some(length) = alphabet.find(|m| m == SymbolMeaning::ToolLength) {
        let number = Symbolic::from_real(machine.tool().tip[2] - machine.tool().gauge[2]);
        for tip in [&mut actual.tip, &mut nominal.tip] {
            tip[2] += length.clone() - number.clone();
        }
    }
    let equations = collect_terms(machine, &actual, &nominal);
    if alphabet.rules.is_exhausted() {
        return Err(too_long());
    }
    let equations = equations.ok_or_else(no_number)?;
    Ok(Equations { symbols: alphabet.symbols, ..equations })
}

/// Returns the equations without their symbols; `None` if an element is no polynomial.
fn collect_terms(machine: &Machine, actual: &Chain<Symbolic>, nominal: &Chain<Symbolic>) -> Option<Equations> {
    let origin = machine.workpiece();
    let pose = (actual.tool_in_workpiece(&origin), nominal.tool_in_workpiece(&origin));
    let backwards = (inverse_pose(actual, &origin)?, inverse_pose(nominal, &origin)?);
    let names = machine.axes().iter().map(|axis| axis.name.to_string());
    let mut joints: Vec<(String, Htm<Symbolic>)> = names.zip(actual.joints.iter().cloned()).collect();
    if let (Some(name), true) = (machine.chain().spindle(), actual.spindle != Htm::identity()) {
        joints.push((name.to_string(), actual.spindle.clone()));
    }
    let found = Equations {
        symbols: Vec::new(),
        joints,
        t_tool: actual.t_tool(),
        t_work: inverse(actual.workpiece_walk())?,
        e_ve: from_part(machine, backwards.0.to_matrix() - backwards.1.to_matrix()),
        position: into_part(machine, pose.0.translation - pose.1.translation),
        rotation: into_part(machine, rotation(&pose.0.linear, &pose.1.linear, machine.conventions().joints)),
    };
    let found = match machine.conventions().location_order {
        LocationOrder::Real => found,
        // The terms of order 0 are rounding.
        LocationOrder::Nilpotent => Equations {
            e_ve: found.e_ve.map(|p| p.nilpotent()),
            position: found.position.map(|p| p.nilpotent()),
            rotation: found.rotation.map(|p| p.nilpotent()),
            ..found
        },
    };
    let all = found.e_ve.iter().chain(found.position.iter()).chain(found.rotation.iter());
    all.into_iter().all(Symbolic::is_polynomial).then_some(found)
}

/// Returns a matrix that acts on the unturned workpiece frame as one that acts on that of the part.
fn from_part(machine: &Machine, e_ve: Matrix4<Symbolic>) -> Matrix4<Symbolic> {
    let row = |i: usize| into_part(machine, Vector3::from_fn(|k, _| e_ve[(i, k)].clone()));
    Matrix4::from_fn(|i, j| if j < 3 { row(i)[j].clone() } else { e_ve[(i, j)].clone() })
}

/// Returns the inverse of a product: the inverses of the factors in reverse order.
fn inverse<'a>(factors: impl DoubleEndedIterator<Item = &'a Htm<Symbolic>>) -> Option<Htm<Symbolic>> {
    factors.rev().try_fold(Htm::identity(), |product, factor| Some(product.compose(&factor.inverse()?)))
}

/// Returns the inverse of the tool's pose in the workpiece frame.
fn inverse_pose(chain: &Chain<Symbolic>, origin: &[f64; 3]) -> Option<Htm<Symbolic>> {
    let walk = inverse(chain.walk())?;
    let translation = walk.apply(origin) - &chain.tip;
    Some(Htm { linear: walk.linear, translation })
}

/// True if the equations are polynomials in an error: with `location_order: real` only in squareness.
fn is_polynomial(machine: &Machine, error: &NamedSource) -> bool {
    let conventions = machine.conventions();
    let ErrorSite::Location(index) = error.source.place else { return true };
    let linear = machine.axes().get(index).is_some_and(|axis| axis.kind == AxisKind::Linear);
    let squareness = linear && conventions.location == Location::AxisOnly && conventions.joints == Joints::Linearised;
    conventions.location_order == LocationOrder::Nilpotent || squareness
}

fn no_polynomial(culprit: &str) -> Diagnostic {
    Diagnostic::new(codes::E0525, format!("with `location_order: real` the equations are no polynomials ({culprit})"))
        .help("write `conventions: { location_order: nilpotent }` for the equations, or leave the error out")
}

fn too_long() -> Diagnostic {
    let message = format!("the equations take more than {MAX_PRODUCTS} products of terms");
    let help = "ask for a lower `--order`, or an algebra in which more products vanish, such as \
                `--algebra 'degree: 6, generators: per-axis, vanish: ...'`; `abbe eval --order 6` has no such limit";
    Diagnostic::new(codes::E0523, message).help(help)
}

fn no_number() -> Diagnostic {
    Diagnostic::new(codes::E0525, "the equations are no polynomials: a joint's determinant is not a number")
        .help("write `conventions: { location_order: nilpotent, joints: orthogonal }` for the equations")
}

/// The symbols, and the rules of their products.
struct Alphabet {
    symbols: Vec<Symbol>,
    rules: Arc<Rules>,
    errors: BTreeMap<Source, u16>,
}

impl Alphabet {
    fn new(machine: &Machine, declared: &DeclaredAlgebra, errors: &[NamedSource], options: Options) -> Self {
        let axes = machine.axes().iter().enumerate();
        let mut symbols: Vec<Symbol> = errors.iter().map(|e| symbols::error(machine, e, options.naming)).collect();
        let sources = errors.iter().map(|e| e.source).zip(0..).collect();
        symbols.extend(options.tool_length.then(symbols::tool_length));
        symbols.extend(axes.flat_map(|(i, axis)| symbols::position(i, axis, options.naming)));
        let kind = |(index, symbol): (usize, &Symbol)| match symbol.meaning {
            SymbolMeaning::Error(source, _) => {
                declared.of(source).map_or(SymbolKind::Real, |generator| SymbolKind::Nilpotent { generator })
            }
            // The cosine is the next one.
            SymbolMeaning::Sine(_) => SymbolKind::Sine { cosine: index as u16 + 1 },
            _ => SymbolKind::Real,
        };
        let kinds = symbols.iter().enumerate().map(kind).collect();
        let rules = Arc::new(Rules::new(kinds, declared.ideal().clone()));
        Self { symbols, rules, errors: sources }
    }

    fn find(&self, wanted: impl Fn(SymbolMeaning) -> bool) -> Option<Symbolic> {
        let index = self.symbols.iter().position(|s| wanted(s.meaning))?;
        Some(Symbolic::symbol(&self.rules, index as u16))
    }

    fn positions(&self, machine: &Machine) -> Vec<JointPosition<Symbolic>> {
        let symbol = |meaning: SymbolMeaning| self.find(|m| m == meaning).unwrap_or_else(Symbolic::zero);
        let position = |(i, axis): (usize, &Axis)| match axis.kind {
            AxisKind::Linear => JointPosition::Linear(symbol(SymbolMeaning::Position(i))),
            AxisKind::Rotary => JointPosition::Rotary(symbol(SymbolMeaning::Sine(i)), symbol(SymbolMeaning::Cosine(i))),
        };
        machine.axes().iter().enumerate().map(position).collect()
    }
}

impl ErrorLift<Symbolic> for Alphabet {
    fn lift(&self, source: Source, value: f64) -> Symbolic {
        match self.errors.get(&source).filter(|_| value != 0.0) {
            Some(index) => Symbolic::symbol(&self.rules, *index).scaled(self.symbols[usize::from(*index)].sign()),
            None => Symbolic::zero(),
        }
    }

    fn real(&self, source: Source, value: f64) -> Symbolic {
        self.lift(source, value)
    }
}
