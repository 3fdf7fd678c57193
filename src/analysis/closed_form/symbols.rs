//! Names of symbols: ISO's, or those of the papers.

use crate::lower::{ErrorSite, NamedSource, Source};
use crate::machine::{Axis, AxisKind, Conventions, Direction, Location, Machine};

/// Letters of the symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Naming {
    /// `EBX`, `EC0Y`, positions by the names of the axes.
    #[default]
    Iso,
    /// `eyx`, `Sxy` of the papers on three-axis machines, `ey(A)`, `gz(C)` of the one on five axes.
    Paper,
    /// Those of the papers, and the parameters of the section `identify` instead of the errors that they move.
    Parameters,
}

/// The meaning of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SymbolMeaning {
    /// An error, mm or rad; -1 if the symbol is the error with the opposite sign.
    Error(Source, i8),
    /// Position of the linear axis with this index, mm.
    Position(usize),
    /// Sine of the position of a rotary axis.
    Sine(usize),
    /// Cosine of the position of a rotary axis.
    Cosine(usize),
    /// Z of the functional point from the gauge point, mm.
    ToolLength,
    /// The parameter with this index, in the unit of its main error over the power of the position.
    Parameter(usize),
}

/// A symbol with its names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// Symbol as text.
    pub text: String,
    /// Symbol as LaTeX.
    pub latex: String,
    /// Its meaning.
    pub meaning: SymbolMeaning,
}

impl Symbol {
    /// Returns the sign of the symbol relative to its error.
    pub fn sign(&self) -> f64 {
        if let SymbolMeaning::Error(_, sign) = self.meaning { f64::from(sign) } else { 1.0 }
    }
}

pub(crate) fn error(machine: &Machine, given: &NamedSource, naming: Naming) -> Symbol {
    let axis = match given.source.place {
        ErrorSite::Location(i) | ErrorSite::Component(i) => machine.axes().get(i),
        ErrorSite::Tool | ErrorSite::Workpiece => None,
    };
    let paper = axis.filter(|_| naming != Naming::Iso).map(|axis| paper(axis, given.source, machine.conventions()));
    let (text, latex, sign) = paper.unwrap_or_else(|| iso(given));
    Symbol { text, latex, meaning: SymbolMeaning::Error(given.source, sign) }
}

fn iso(given: &NamedSource) -> (String, String, i8) {
    let latex = given
        .name
        .strip_prefix('E')
        .map_or_else(|| format!("\\mathit{{{}}}", given.name.replace('.', "\\_")), |rest| format!("E_{{{rest}}}"));
    (given.name.clone(), latex, 1)
}

/// Returns text, LaTeX and sign in the letters of the papers.
fn paper(axis: &Axis, source: Source, conventions: &Conventions) -> (String, String, i8) {
    let letter = ['x', 'y', 'z'][source.direction.index() % 3];
    let (small, rotation) = (axis.name.as_str().to_lowercase(), source.direction.is_rotation());
    let linear = axis.kind == AxisKind::Linear;
    if let ErrorSite::Location(_) = source.place {
        return match squareness(&small, source.direction).filter(|_| conventions.location == Location::AxisOnly) {
            Some((pair, sign)) => (format!("S{pair}"), format!("S_{{{pair}}}"), sign),
            None if rotation => (format!("g{letter}({})", axis.name), format!("\\gamma_{letter}({})", axis.name), 1),
            None => (format!("a{letter}({})", axis.name), format!("a_{letter}({})", axis.name), 1),
        };
    }
    let (plain, greek) = if rotation { ("e", "\\varepsilon") } else { ("d", "\\delta") };
    if linear && small.len() == 1 {
        return (format!("{plain}{letter}{small}"), format!("{greek}_{{{letter}{small}}}"), 1);
    }
    (format!("{plain}{letter}({})", axis.name), format!("{greek}_{letter}({})", axis.name), 1)
}

/// Returns the pair of axes and the sign of a squareness: Sxy = EC0Y, Sxz = -EB0Z, Syz = EA0Z.
fn squareness(axis: &str, direction: Direction) -> Option<(&'static str, i8)> {
    match (axis, direction) {
        ("y", Direction::C) => Some(("xy", 1)),
        ("z", Direction::B) => Some(("xz", -1)),
        ("z", Direction::A) => Some(("yz", 1)),
        _ => None,
    }
}

pub(crate) fn position(index: usize, axis: &Axis, naming: Naming) -> Vec<Symbol> {
    let symbol = |text: String, latex: String, meaning| Symbol { text, latex, meaning };
    let name = axis.name.as_str();
    match axis.kind {
        AxisKind::Linear => {
            let name = if naming == Naming::Iso { name.to_owned() } else { name.to_lowercase() };
            vec![symbol(name.clone(), format!("\\mathit{{{name}}}"), SymbolMeaning::Position(index))]
        }
        AxisKind::Rotary => vec![
            symbol(format!("sin({name})"), format!("\\sin\\mathit{{{name}}}"), SymbolMeaning::Sine(index)),
            symbol(format!("cos({name})"), format!("\\cos\\mathit{{{name}}}"), SymbolMeaning::Cosine(index)),
        ],
    }
}

/// The symbol of a parameter: `f1` is f_1 in LaTeX.
pub(crate) fn parameter(index: usize, name: &str) -> Symbol {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let plain = letters.len() == 1 && letters.chars().all(|c| c.is_ascii_alphabetic());
    let latex = match name.split_at(letters.len()) {
        (letter, "") if plain => letter.to_owned(),
        (letter, digits) if plain => format!("{letter}_{{{digits}}}"),
        _ => format!("\\mathit{{{}}}", name.replace('_', "\\_")),
    };
    Symbol { text: name.to_owned(), latex, meaning: SymbolMeaning::Parameter(index) }
}

pub(crate) fn tool_length() -> Symbol {
    Symbol { text: "L".to_owned(), latex: "L".to_owned(), meaning: SymbolMeaning::ToolLength }
}
