//! The closed forms of a machine: the lowering over polynomials in symbols.
//!
//! 1. Every error that is given becomes a symbol, as large as its generator in the declared algebra;
//!    positions of linear axes become symbols, those of rotary axes a sine and a cosine.
//! 2. The same joints and the same chain as in every evaluation are multiplied.
//! 3. E_VE takes the inverse joint by joint; deviations are those of `eval`, workpiece frame.

use super::symbols::{self, Naming, Symbol, SymbolMeaning};
use crate::algebra::symbolic::{MAX_PRODUCTS, Rules, SymbolKind, Symbolic};
use crate::algebra::{Algebra, Htm};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::rotation;
use crate::lower::{
    Chain, DeclaredAlgebra, ErrorLift, ErrorSite, JointFactor, JointPosition, NamedSource, Source, into_part,
    named_sources, unit_values,
};
use crate::machine::{Axis, AxisKind, Joints, Location, LocationOrder, Machine};
use nalgebra::{Matrix4, Vector3};
use num_traits::{One, Zero};
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

/// A parameter of one's own: a symbol that moves errors by powers of their axes' positions.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnParameter {
    /// Its name.
    pub name: String,
    /// The errors that it moves.
    pub moves: Vec<ParameterShare>,
}

/// The part of an error that a parameter makes: a factor times a power of the position (mm).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterShare {
    /// The error.
    pub source: Source,
    /// Power of the position.
    pub power: u8,
    /// The factor.
    pub factor: f64,
}

/// The factors of the matrix of a joint, in their order.
#[derive(Debug, Clone)]
pub struct FactorsOfJoint {
    /// Name of the axis, or of the spindle.
    pub name: String,
    /// True on the workpiece side of the bed.
    pub on_workpiece_side: bool,
    /// Matrices with their names.
    pub factors: Vec<JointFactor<Symbolic>>,
}

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Equations {
    /// The symbols, by the index that polynomials use.
    pub symbols: Vec<Symbol>,
    /// The matrix G of every axis, and of the spindle if it has errors, with their names.
    pub joints: Vec<(String, Htm<Symbolic>)>,
    /// The factors of these matrices.
    pub factors: Vec<FactorsOfJoint>,
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
    equations_in(machine, declared, options, &[])
}

/// Returns the same with parameters of one's own in the place of the errors that they move.
pub fn equations_in(
    machine: &Machine,
    declared: &DeclaredAlgebra,
    options: Options,
    parameters: &[OwnParameter],
) -> Result<Equations, Diagnostic> {
    let moves = |source: Source| parameters.iter().flat_map(|p| &p.moves).any(|share| share.source == source);
    let mut errors = named_sources(machine);
    errors.retain(|error| !moves(error.source));
    if let Some(culprit) = errors.iter().find(|error| !is_polynomial(machine, error.source)) {
        return Err(no_polynomial(&culprit.name));
    }
    parameters.iter().try_for_each(|parameter| is_usable(machine, declared, parameter))?;
    let alphabet = Alphabet::new(machine, declared, &errors, options).with(machine, declared, parameters);
    let at = alphabet.positions(machine);
    let mut values = unit_values(machine);
    parameters.iter().flat_map(|p| &p.moves).for_each(|share| values.set(share.source, 1.0));
    let factors = Chain::factors_at(machine, &at, &values, &alphabet);
    let mut actual = Chain::actual_at(machine, &at, &values, &alphabet);
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
    let workpiece_side = actual.workpiece_walk().count() - 1;
    let named = |(i, factors): (usize, Vec<JointFactor<Symbolic>>)| {
        let spindle = || machine.chain().spindle().map_or_else(String::new, ToString::to_string);
        let name = machine.axes().get(i).map_or_else(spindle, |axis| axis.name.to_string());
        FactorsOfJoint { name, on_workpiece_side: i < workpiece_side, factors }
    };
    let factors = factors.into_iter().enumerate().map(named).collect();
    Ok(Equations { symbols: alphabet.symbols, factors, ..equations })
}

/// Refuses a parameter whose equations are no polynomials.
fn is_usable(machine: &Machine, declared: &DeclaredAlgebra, parameter: &OwnParameter) -> Result<(), Diagnostic> {
    let name = shown(&parameter.name);
    let refusal = |reason: String, help: &str| Err(Diagnostic::new(codes::E0525, reason).help(help));
    if !declared.ideal().vanish.is_empty() {
        let help = "leave `vanish` out, or write the equations in the errors: `--symbols paper`";
        return refusal("an ideal names errors, and the equations have parameters instead".to_owned(), help);
    }
    let turned = |share: &&ParameterShare| match share.source.place {
        ErrorSite::Component(i) => share.power > 0 && machine.axes()[i].kind == AxisKind::Rotary,
        _ => false,
    };
    if parameter.moves.iter().any(|share| turned(&share)) {
        let help =
            "powers of an angle are no polynomials in its sine and cosine: fit such errors under their own names";
        return refusal(format!("`{name}` moves an error with a power of an angle"), help);
    }
    let is_location = |share: &ParameterShare| matches!(share.source.place, ErrorSite::Location(_));
    let real = machine.conventions().location_order == LocationOrder::Real;
    let (locations, all) = (parameter.moves.iter().filter(|share| is_location(share)).count(), parameter.moves.len());
    if real && locations > 0 && locations < all {
        let help = "let a parameter move either location errors or component errors";
        return refusal(format!("`{name}` moves errors of order 0 and of order 1"), help);
    }
    match parameter.moves.iter().find(|share| !is_polynomial(machine, share.source)) {
        Some(_) => Err(no_polynomial(&name)),
        None => Ok(()),
    }
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
        factors: Vec::new(),
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
fn is_polynomial(machine: &Machine, source: Source) -> bool {
    let conventions = machine.conventions();
    let ErrorSite::Location(index) = source.place else { return true };
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
    /// The polynomial of each error; one symbol without parameters.
    errors: BTreeMap<Source, Symbolic>,
}

impl Alphabet {
    fn new(machine: &Machine, declared: &DeclaredAlgebra, errors: &[NamedSource], options: Options) -> Self {
        let axes = machine.axes().iter().enumerate();
        let mut symbols: Vec<Symbol> = errors.iter().map(|e| symbols::error(machine, e, options.naming)).collect();
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
        Self::of(symbols, Rules::new(kinds, declared.ideal().clone()))
    }

    fn of(symbols: Vec<Symbol>, rules: Rules) -> Self {
        let rules = Arc::new(rules);
        let error = |(index, symbol): (u16, &Symbol)| match symbol.meaning {
            SymbolMeaning::Error(source, _) => Some((source, Symbolic::symbol(&rules, index).scaled(symbol.sign()))),
            _ => None,
        };
        let errors = (0..).zip(&symbols).filter_map(error).collect();
        Self { symbols, rules, errors }
    }

    /// Adds parameters, each with a generator of its own, and the errors that they move.
    fn with(self, machine: &Machine, declared: &DeclaredAlgebra, parameters: &[OwnParameter]) -> Self {
        if parameters.is_empty() {
            return self;
        }
        let real = machine.conventions().location_order == LocationOrder::Real;
        let is_real =
            |p: &OwnParameter| real && p.moves.iter().any(|s| matches!(s.source.place, ErrorSite::Location(_)));
        let first = self.symbols.len() as u16;
        let generators = (declared.names().len() as u16..).zip(parameters);
        let kind = |(generator, p): (u16, &OwnParameter)| match is_real(p) {
            true => SymbolKind::Real,
            false => SymbolKind::Nilpotent { generator },
        };
        let kinds = self.rules.kinds().iter().copied().chain(generators.map(kind)).collect();
        let own = parameters.iter().enumerate().map(|(k, p)| symbols::parameter(k, &p.name));
        let symbols = self.symbols.into_iter().chain(own).collect();
        let mut alphabet = Self::of(symbols, Rules::new(kinds, declared.ideal().clone()));
        for (index, parameter) in (first..).zip(parameters) {
            for share in &parameter.moves {
                let position = match share.source.place {
                    ErrorSite::Component(i) => alphabet.find(|m| m == SymbolMeaning::Position(i)),
                    _ => None,
                };
                let symbol = Symbolic::symbol(&alphabet.rules, index).scaled(share.factor);
                let position = position.unwrap_or_else(Symbolic::one);
                let part = (0..share.power).fold(symbol, |product, _| product * position.clone());
                let sum = alphabet.errors.entry(share.source).or_insert_with(Symbolic::zero);
                *sum += part;
            }
        }
        alphabet
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
        self.errors.get(&source).filter(|_| value != 0.0).cloned().unwrap_or_else(Symbolic::zero)
    }

    fn real(&self, source: Source, value: f64) -> Symbolic {
        self.lift(source, value)
    }
}
