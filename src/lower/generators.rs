//! The generators of errors: a declared algebra on a machine.

use super::source::{AxisErrorValues, ErrorLift, ErrorSite, ErrorValues, Source};
use crate::algebra::weil::{
    Basis, BasisFailure, Binomial, GroebnerBasis, Ideal, IdealFailure, MAX_ELEMENTS, Monomial, Size, Weil,
};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::{AlgebraChoice, Direction, ErrorId, Generators, LocationOrder, Machine, parse_error_name};
use std::collections::BTreeMap;
use std::sync::Arc;

/// An error that a machine has.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedSource {
    /// Its place in the chain.
    pub source: Source,
    /// `EXX`, `EC0Y`; set-up errors are `tool.X` and `workpiece.A`.
    pub name: String,
    /// The error of a joint; `None` for set-up errors.
    pub error: Option<ErrorId>,
}

/// Returns the errors given for a machine, those of the set-up last.
pub fn named_sources(machine: &Machine) -> Vec<NamedSource> {
    let joint = |(id, _): (ErrorId, _)| {
        let index = machine.axis_index(id.axis.as_str()).unwrap_or(machine.axes().len());
        let place = if id.is_location() { ErrorSite::Location(index) } else { ErrorSite::Component(index) };
        NamedSource { source: Source { place, direction: id.direction }, name: id.to_string(), error: Some(id) }
    };
    let clamped = |place: ErrorSite, word: &str, values: &[f64]| {
        let given = Direction::ALL.into_iter().zip(values).filter(|(_, value)| **value != 0.0);
        let one = |(direction, _): (Direction, _)| NamedSource {
            source: Source { place, direction },
            name: format!("{word}.{}", direction.letter()),
            error: None,
        };
        given.map(one).collect::<Vec<_>>()
    };
    let setup = machine.setup();
    let mut all: Vec<NamedSource> = machine.errors().map(joint).collect();
    all.extend(clamped(ErrorSite::Tool, "tool", &setup.tool));
    all.extend(clamped(ErrorSite::Workpiece, "workpiece", &setup.workpiece));
    all
}

/// Returns one for every error that is given, zero elsewhere: errors as large as their generators.
pub fn unit_values(machine: &Machine) -> ErrorValues {
    let errors = named_sources(machine);
    let has = |place: ErrorSite| {
        let mut six = [0.0; 6];
        errors.iter().filter(|e| e.source.place == place).for_each(|e| six[e.source.direction.index()] = 1.0);
        six
    };
    let axes = machine.axes().len();
    let [x, y, z, ..] = has(ErrorSite::Tool);
    ErrorValues {
        axes: (0..axes)
            .map(|i| AxisErrorValues { location: has(ErrorSite::Location(i)), component: has(ErrorSite::Component(i)) })
            .collect(),
        spindle: machine.spindle_errors().map(|_| has(ErrorSite::Location(axes))),
        tool: [x, y, z],
        workpiece: has(ErrorSite::Workpiece),
    }
}

/// The generators of an algebra on a machine.
#[derive(Debug, Clone)]
pub struct DeclaredAlgebra {
    names: Vec<String>,
    generators: BTreeMap<Source, u16>,
    ideal: Ideal,
    relations: Vec<Binomial>,
}

impl DeclaredAlgebra {
    /// Gives the errors their generators and the vanishing monomials their meaning.
    pub fn new(machine: &Machine, choice: &AlgebraChoice) -> Result<Self, Diagnostic> {
        let real = machine.conventions().location_order == LocationOrder::Real;
        let mut names: Vec<String> = match &choice.generators {
            Generators::Groups(groups) => groups.iter().map(|(name, _)| name.clone()).collect(),
            _ => Vec::new(),
        };
        let mut generators = BTreeMap::new();
        for given in
            named_sources(machine).iter().filter(|g| !(real && matches!(g.source.place, ErrorSite::Location(_))))
        {
            let name = generator_name(&choice.generators, given);
            let index = names.iter().position(|n| *n == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            let _ = generators.insert(given.source, u16::try_from(index).unwrap_or(u16::MAX));
        }
        let ideal = Ideal::above(choice.degree);
        let mut declared = Self { names, generators, ideal, relations: Vec::new() };
        for monomial in &choice.vanish {
            declared.ideal.vanish.extend(declared.monomial(machine, monomial)?);
        }
        for relation in &choice.relations {
            match [declared.monomial(machine, &relation.left)?, declared.monomial(machine, &relation.right)?] {
                [Some(left), Some(right)] => {
                    declared.relations.push(Binomial { left, factor: relation.factor, right });
                }
                // An error that the machine has not is 0, and so is the other side.
                [one, other] => declared.ideal.vanish.extend(one.or(other)),
            }
        }
        Ok(declared)
    }

    /// `None` if it names an error that the machine might have, but has not.
    fn monomial(&self, machine: &Machine, named: &[(String, u8)]) -> Result<Option<Monomial>, Diagnostic> {
        let mut factors = Vec::new();
        for (name, power) in named {
            match self.generator(name) {
                Some(generator) => factors.push((generator, *power)),
                None if parse_error_name(name).is_some_and(|id| belongs(machine, &id)) => return Ok(None),
                None => return Err(self.unknown(name)),
            }
        }
        Ok(Some(Monomial::new(factors)))
    }

    /// Returns the generator of a name; `x1` is the first one.
    pub fn generator(&self, name: &str) -> Option<u16> {
        let numbered =
            || name.strip_prefix('x')?.parse::<usize>().ok()?.checked_sub(1).filter(|k| *k < self.names.len());
        let spelt = || self.position(&parse_error_name(name)?.to_string());
        let index = self.position(name).or_else(numbered).or_else(spelt)?;
        u16::try_from(index).ok()
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    fn unknown(&self, name: &str) -> Diagnostic {
        let known: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let count = known.len();
        let help = if name.starts_with('x') {
            format!("there are {count} generators, x1 to x{count}: {}", known.join(", "))
        } else {
            did_you_mean(name, &known)
        };
        Diagnostic::new(codes::E0521, format!("there is no generator `{}`", shown(name))).help(help)
    }

    /// Names of the generators.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the generator of an error; none for errors that the machine does not have, or in the real part.
    pub fn of(&self, source: Source) -> Option<u16> {
        self.generators.get(&source).copied()
    }

    /// Returns the size of the algebra, before it is built.
    pub fn size(&self) -> Size {
        self.ideal.size(u16::try_from(self.names.len()).unwrap_or(u16::MAX))
    }

    /// True if monomials replace others.
    pub fn has_relations(&self) -> bool {
        !self.relations.is_empty()
    }

    /// Returns the vanishing monomials.
    pub fn ideal(&self) -> &Ideal {
        &self.ideal
    }

    /// Returns a monomial in words: `EXX*EYX^2`.
    pub fn monomial_name(&self, monomial: &Monomial) -> String {
        let factor = |(generator, power): &(u16, u8)| {
            let name = self.names.get(usize::from(*generator)).map_or("?", String::as_str);
            if *power == 1 { name.to_owned() } else { format!("{name}^{power}") }
        };
        monomial.factors().iter().map(factor).collect::<Vec<_>>().join("*")
    }

    /// Basis and product table.
    pub fn build(self) -> Result<WeilLift, Diagnostic> {
        let count = u16::try_from(self.names.len()).unwrap_or(u16::MAX);
        let basis = Basis::with_relations(count, self.ideal.clone(), &self.relations);
        let basis = basis.map_err(|failure| self.refusal(&failure))?;
        Ok(WeilLift { declared: self, basis })
    }

    fn refusal(&self, failure: &BasisFailure) -> Diagnostic {
        let (count, degree) = (self.names.len(), self.ideal.degree);
        match failure {
            BasisFailure::KillsOne => Diagnostic::new(codes::E0522, "the ideal contains 1: no algebra would remain"),
            BasisFailure::Degree(degree) => Diagnostic::new(codes::E0215, format!("an algebra of degree {degree}")),
            BasisFailure::Generator(k) => self.unknown(&format!("x{}", k + 1)),
            BasisFailure::Ideal(IdealFailure::Inhomogeneous(_)) => {
                Diagnostic::new(codes::E0215, "a relation between monomials of different degrees")
            }
            BasisFailure::Ideal(IdealFailure::TooMany) => {
                let message = format!("the Groebner basis of the relations has more than {MAX_ELEMENTS} elements");
                Diagnostic::new(codes::E0523, message).help("lower the degree, or write fewer relations")
            }
            BasisFailure::Ideal(IdealFailure::Coefficient) => {
                Diagnostic::new(codes::E0523, "the Groebner basis of the relations has coefficients beyond 38 digits")
                    .help("lower the degree, or write factors of fewer digits")
            }
            BasisFailure::Size(size) => {
                let message = format!(
                    "an algebra of {count} generators to degree {degree} needs up to {:.3e} monomials and {} GB",
                    size.monomials,
                    crate::units::significant(size.bytes() * 1e-9, 3)
                );
                Diagnostic::new(codes::E0523, message).help(
                    "1 GB is the limit: lower the degree, group the errors (`generators: per-axis`), \
                     or let more monomials vanish",
                )
            }
        }
    }
}

fn belongs(machine: &Machine, id: &ErrorId) -> bool {
    machine.axis_index(id.axis.as_str()).is_some() || machine.chain().spindle() == Some(&id.axis)
}

fn generator_name(generators: &Generators, given: &NamedSource) -> String {
    let whole = |word: &str| word.split('.').next().unwrap_or(word).to_owned();
    match generators {
        Generators::PerError => given.name.clone(),
        Generators::Single => "i".to_owned(),
        Generators::PerAxis => given.error.as_ref().map_or_else(|| whole(&given.name), |id| id.axis.to_string()),
        Generators::Groups(groups) => {
            let member =
                |(_, errors): &&(String, Vec<ErrorId>)| given.error.as_ref().is_some_and(|e| errors.contains(e));
            groups.iter().find(member).map_or_else(|| given.name.clone(), |(name, _)| name.clone())
        }
    }
}

/// Errors as elements of a Weil algebra: the value times the error's generator.
#[derive(Debug, Clone)]
pub struct WeilLift {
    declared: DeclaredAlgebra,
    basis: Arc<Basis>,
}

impl WeilLift {
    /// Returns the generators.
    pub fn declared(&self) -> &DeclaredAlgebra {
        &self.declared
    }

    /// Returns the basis.
    pub fn basis(&self) -> &Arc<Basis> {
        &self.basis
    }

    /// Returns the Groebner basis of the relations in words, `x1*x2 = x3^2`, largest leading monomials first.
    pub fn relations(&self) -> Vec<String> {
        let name = |m: &Monomial| self.declared.monomial_name(m);
        let binomial = |b: &Binomial| match b.factor.to_string().as_str() {
            "1" => format!("{} = {}", name(&b.left), name(&b.right)),
            "-1" => format!("{} = -{}", name(&b.left), name(&b.right)),
            factor => format!("{} = {factor} {}", name(&b.left), name(&b.right)),
        };
        let of = |basis: &GroebnerBasis| {
            let zero = basis.monomials().iter().map(|m| format!("{} = 0", name(m)));
            basis.binomials().iter().map(binomial).chain(zero).collect()
        };
        self.basis.relations().map_or_else(Vec::new, of)
    }

    /// Returns the monomials of the basis in words; `1` first.
    pub fn monomials(&self) -> Vec<String> {
        let name = |m: &Monomial| if m.degree() == 0 { "1".to_owned() } else { self.declared.monomial_name(m) };
        self.basis.monomials().iter().map(name).collect()
    }
}

impl ErrorLift<Weil> for WeilLift {
    fn lift(&self, source: Source, value: f64) -> Weil {
        self.declared.of(source).map_or(Weil::Constant(0.0), |generator| Weil::generator(&self.basis, generator, value))
    }
}
