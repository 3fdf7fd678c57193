//! The algebra in which a machine is evaluated: the section `algebra` of the file, or the same words on
//! the command line.

use super::{ErrorId, parse_error_name};
use crate::algebra::weil::Fraction;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::syntax::{AlgebraEntry, GeneratorsEntry};

/// The errors or groups that have a nilpotent generator of their own.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Generators {
    /// Every error.
    #[default]
    PerError,
    /// All errors of an axis together.
    PerAxis,
    /// All errors together: the dual numbers.
    Single,
    /// Groups by name; an error in none of them has its own.
    Groups(Vec<(String, Vec<ErrorId>)>),
}

/// A product of powers of generators, by name.
pub type NamedMonomial = Vec<(String, u8)>;

/// A relation between two monomials: `left = factor right`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedRelation {
    /// Left side.
    pub left: NamedMonomial,
    /// Factor of the right side.
    pub factor: Fraction,
    /// Right side.
    pub right: NamedMonomial,
}

/// The algebra as declared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AlgebraChoice {
    /// Highest total degree that is kept.
    pub degree: u8,
    /// The errors or groups that have a generator.
    pub generators: Generators,
    /// Further vanishing monomials: names of generators, or `x1`, `x2`, ... in their order.
    pub vanish: Vec<NamedMonomial>,
    /// Monomials that others replace.
    pub relations: Vec<NamedRelation>,
}

impl AlgebraChoice {
    /// Highest degree.
    pub const DEGREE: u8 = 6;
    /// Words for `generators`.
    pub const WORDS: [&'static str; 3] = ["per-error", "per-axis", "single"];

    /// Returns one generator for every error, nothing vanishes below a degree.
    pub fn per_error(degree: u8) -> Self {
        Self { degree, generators: Generators::PerError, vanish: Vec::new(), relations: Vec::new() }
    }

    /// Reads an entry; the default degree is 2.
    pub fn new(entry: &AlgebraEntry) -> Result<Self, Diagnostic> {
        let degree = entry.degree.unwrap_or(2);
        if !(1..=Self::DEGREE).contains(&degree) {
            let help = format!("write 1 to {}", Self::DEGREE);
            return Err(Diagnostic::new(codes::E0215, format!("an algebra of degree {degree}")).help(help));
        }
        let generators = entry.generators.as_ref().map_or(Ok(Generators::PerError), generators)?;
        let (mut vanish, mut relations) = (Vec::new(), Vec::new());
        for text in &entry.vanish {
            match vanishing(text)? {
                Vanishing::Monomial(monomial) => vanish.push(monomial),
                Vanishing::Relation(relation) => relations.push(relation),
            }
        }
        Ok(Self { degree, generators, vanish, relations })
    }
}

fn generators(entry: &GeneratorsEntry) -> Result<Generators, Diagnostic> {
    match entry {
        GeneratorsEntry::Word(word) if word == "per-error" => Ok(Generators::PerError),
        GeneratorsEntry::Word(word) if word == "per-axis" => Ok(Generators::PerAxis),
        GeneratorsEntry::Word(word) if word == "single" => Ok(Generators::Single),
        GeneratorsEntry::Word(word) => {
            let message = format!("`{}` is not a choice for `generators`", shown(word));
            Err(Diagnostic::new(codes::E0210, message).help(did_you_mean(word, &AlgebraChoice::WORDS)))
        }
        GeneratorsEntry::Groups(map) => {
            let group = |(name, errors): (&String, &Vec<String>)| {
                let errors: Result<Vec<ErrorId>, Diagnostic> = errors.iter().map(|e| named_error(e)).collect();
                Ok((name.clone(), errors?))
            };
            map.iter().map(group).collect::<Result<_, _>>().map(Generators::Groups)
        }
    }
}

fn named_error(text: &str) -> Result<ErrorId, Diagnostic> {
    parse_error_name(text).ok_or_else(|| {
        let message = format!("`{}` is not the name of an error", shown(text));
        Diagnostic::new(codes::E0405, message).help("names are `EXX` (component error) or `EC0Y` (location error)")
    })
}

/// An element of an ideal.
pub(super) enum Vanishing {
    Monomial(NamedMonomial),
    Relation(NamedRelation),
}

/// `EXX*EYX`, `x1^2`; with two sides `x1*x2 = x3^2`, `x1*x2 = -0.5 x3^2`.
pub(super) fn vanishing(text: &str) -> Result<Vanishing, Diagnostic> {
    let Some((left, right)) = text.split_once('=') else { return named_monomial(text).map(Vanishing::Monomial) };
    let ([left_factor, right_factor], [left, right]) = {
        let [(a, left), (b, right)] = [left, right].map(|side| coefficient(side.trim()));
        ([a, b], [left, right])
    };
    let failure = || {
        Diagnostic::new(codes::E0215, format!("`{}` is not a relation", shown(text)))
            .help("write two monomials with `=`, the right one with a factor or 0: `x1*x2 = x3^2`, `x1*x2 = -0.5 x3^2`")
    };
    if right == "0" && right_factor == Some(Fraction::ONE) {
        return named_monomial(left).map(Vanishing::Monomial);
    }
    let (Some(a), Some(b)) = (left_factor.filter(|a| !a.is_zero()), right_factor) else { return Err(failure()) };
    let factor = b.over(a).ok_or_else(failure)?;
    let (left, right) = (named_monomial(left)?, named_monomial(right)?);
    let degree = |m: &NamedMonomial| m.iter().map(|(_, power)| u32::from(*power)).sum::<u32>();
    if degree(&left) != degree(&right) {
        return Err(inhomogeneous(text, [degree(&left), degree(&right)]));
    }
    Ok(Vanishing::Relation(NamedRelation { left, factor, right }))
}

fn inhomogeneous(text: &str, [left, right]: [u32; 2]) -> Diagnostic {
    let message = format!("`{}` is not homogeneous: its sides have degrees {left} and {right}", shown(text));
    Diagnostic::new(codes::E0215, message).help(
        "sides of one degree keep the parts by degree apart: what is cut above the degree of the algebra is of that \
         order; a relation between different orders would say that an error is as small as a product of errors",
    )
}

/// Splits `-0.5 x3^2`, `2*x1`, `-x1` into a factor and the rest; no factor where it is no number.
fn coefficient(side: &str) -> (Option<Fraction>, &str) {
    let (sign, rest) = side.strip_prefix('-').map_or((1, side), |rest| (-1, rest.trim_start()));
    let end = rest.find(|c: char| !c.is_ascii_digit() && !"./".contains(c)).unwrap_or(rest.len());
    let (number, after) = rest.split_at(end);
    let after = after.trim_start();
    let monomial = after.strip_prefix('*').map_or(after, str::trim_start);
    if number.is_empty() || monomial.is_empty() {
        return (Fraction::new(sign, 1), rest);
    }
    (Fraction::parse(number).and_then(|f| f.times(Fraction::new(sign, 1)?)), monomial)
}

/// `EXX*EYX`, `x1^2`.
pub(super) fn named_monomial(text: &str) -> Result<NamedMonomial, Diagnostic> {
    let factor = |factor: &str| {
        let (name, power) = factor.split_once('^').unwrap_or((factor, "1"));
        let power = power.trim().parse::<u8>().ok().filter(|p| *p <= AlgebraChoice::DEGREE)?;
        let name = name.trim();
        (!name.is_empty() && !name.contains('^')).then(|| (name.to_owned(), power))
    };
    let factors: Option<NamedMonomial> = text.split('*').map(factor).collect();
    let factors = factors.ok_or_else(|| {
        Diagnostic::new(codes::E0215, format!("`{}` is not a monomial", shown(text)))
            .help("write names with `*` and `^`, such as `EXX*EYX` or `EXX^2`")
    })?;
    if factors.iter().all(|(name, power)| *power == 0 || name == "1") {
        let message = format!("the ideal contains 1 (`{}`): no algebra would remain", shown(text));
        return Err(
            Diagnostic::new(codes::E0522, message).help("only products of generators can vanish, such as `x1^2`")
        );
    }
    Ok(factors)
}
