//! The algebra in which a machine is evaluated: the section `algebra` of the file, or the same words on
//! the command line.

use super::{ErrorId, parse_error_name};
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

/// The algebra as declared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AlgebraChoice {
    /// Highest total degree that is kept.
    pub degree: u8,
    /// The errors or groups that have a generator.
    pub generators: Generators,
    /// Further vanishing monomials: names of generators, or `x1`, `x2`, ... in their order.
    pub vanish: Vec<NamedMonomial>,
}

impl AlgebraChoice {
    /// Highest degree.
    pub const DEGREE: u8 = 6;
    /// Words for `generators`.
    pub const WORDS: [&'static str; 3] = ["per-error", "per-axis", "single"];

    /// Returns one generator for every error, nothing vanishes below a degree.
    pub fn per_error(degree: u8) -> Self {
        Self { degree, generators: Generators::PerError, vanish: Vec::new() }
    }

    /// Reads an entry; the default degree is 2.
    pub fn new(entry: &AlgebraEntry) -> Result<Self, Diagnostic> {
        let degree = entry.degree.unwrap_or(2);
        if !(1..=Self::DEGREE).contains(&degree) {
            let help = format!("write 1 to {}", Self::DEGREE);
            return Err(Diagnostic::new(codes::E0215, format!("an algebra of degree {degree}")).help(help));
        }
        let generators = entry.generators.as_ref().map_or(Ok(Generators::PerError), generators)?;
        let vanish = entry.vanish.iter().map(|text| named_monomial(text));
        Ok(Self { degree, generators, vanish: vanish.collect::<Result<_, _>>()? })
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
