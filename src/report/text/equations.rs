//! The closed forms as text and as LaTeX.

use crate::algebra::symbolic::Symbolic;
use crate::algebra::weil::Monomial;
use crate::algebra::{Algebra, Htm};
use crate::analysis::{Equations, FactorsOfJoint, Symbol, SymbolMeaning};
use crate::machine::Machine;
use nalgebra::{Matrix4, Vector3};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Script {
    Text,
    Latex,
}

/// Components of a vector: letter, name.
const COMPONENTS: [&str; 3] = ["x", "y", "z"];

/// A polynomial as text: `EXX - 1/2*ECY*X`.
pub fn polynomial_text(polynomial: &Symbolic, symbols: &[Symbol]) -> String {
    polynomial_in(Script::Text, polynomial, symbols)
}

fn polynomial_in(script: Script, polynomial: &Symbolic, symbols: &[Symbol]) -> String {
    let mut text = String::new();
    for (monomial, coefficient) in polynomial.terms() {
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(sign);
        text.push_str(&term(script, monomial, coefficient.abs(), symbols));
    }
    if text.is_empty() { "0".to_owned() } else { text }
}

fn term(script: Script, monomial: &Monomial, size: f64, symbols: &[Symbol]) -> String {
    let factor = |(index, power): &(u16, u8)| {
        let symbol = symbols.get(usize::from(*index));
        match (script, *power) {
            (Script::Text, 1) => symbol.map_or("?", |s| &s.text).to_owned(),
            (Script::Text, p) => format!("{}^{p}", symbol.map_or("?", |s| &s.text)),
            (Script::Latex, p) => latex_power(symbol, p),
        }
    };
    let mut factors: Vec<String> = monomial.factors().iter().map(factor).collect();
    if size != 1.0 || factors.is_empty() {
        factors.insert(0, number(script, size));
    }
    factors.join(if script == Script::Text { "*" } else { "\\," })
}

/// `\sin^2 A`, but `E_{AX}^2`.
fn latex_power(symbol: Option<&Symbol>, power: u8) -> String {
    let Some(symbol) = symbol else { return "?".to_owned() };
    match (symbol.latex.split_once("\\mathit"), power) {
        (_, 1) => symbol.latex.clone(),
        (Some((function, name)), p) if !function.is_empty() => format!("{function}^{{{p}}}\\mathit{name}"),
        (_, p) => format!("{{{}}}^{{{p}}}", symbol.latex),
    }
}

/// Denominators of Taylor coefficients and of common halves.
const DENOMINATORS: [f64; 12] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 24.0, 60.0, 120.0, 360.0, 720.0];

/// A whole number, a fraction of small numbers, or the double as it is.
fn number(script: Script, value: f64) -> String {
    let near = |d: &&f64| (value * **d - libm::round(value * **d)).abs() <= 1e-14 * value * **d && value * **d < 1e6;
    // 6/60 is better written 0.1.
    let reduced =
        |(above, below): &(f64, f64)| (2..=*below as u32).map(f64::from).all(|p| above % p != 0.0 || below % p != 0.0);
    // Doubles print without an exponent: LaTeX needs nothing else.
    match DENOMINATORS.iter().find(near).map(|d| (libm::round(value * d), *d)).filter(reduced) {
        Some((whole, 1.0)) => whole.to_string(),
        Some((above, below)) if script == Script::Latex => format!("\\tfrac{{{above}}}{{{below}}}"),
        Some((above, below)) => format!("{above}/{below}"),
        None => value.to_string(),
    }
}

/// The parts of a polynomial by degree: (degree, part), those that are not 0.
pub fn by_order(polynomial: &Symbolic) -> Vec<(usize, Symbolic)> {
    let parts = (0..=polynomial.order()).map(|degree| (degree, polynomial.part(degree)));
    parts.filter(|(_, part)| !part.is_empty()).collect()
}

/// The entries of a matrix that are not 0, by row and column from 1.
fn entries(matrix: &Matrix4<Symbolic>) -> Vec<(usize, usize, &Symbolic)> {
    let places = (0..3).flat_map(|i| (0..4).map(move |j| (i, j)));
    places.map(|(i, j)| (i + 1, j + 1, &matrix[(i, j)])).filter(|(.., p)| !p.is_empty()).collect()
}

/// Everything, a line for each entry that is not 0.
pub fn text(machine: &Machine, equations: &Equations, with_factors: bool) -> String {
    let mut text = format!("{}: closed forms, workpiece frame; mm and rad\n", machine.name());
    text.push_str("Entries that are 0 are left out, as is the last row 0 0 0 1.\n");
    for line in equations.symbols.iter().filter_map(|symbol| remark(machine, symbol)) {
        text.push_str(&format!("  {line}\n"));
    }
    let line = |p: &Symbolic| polynomial_in(Script::Text, p, &equations.symbols);
    for joint in equations.factors.iter().filter(|_| with_factors) {
        let names: Vec<&str> = joint.factors.iter().map(|factor| factor.name).collect();
        text.push_str(&format!("\nJoint {}, factors {}\n", joint.name, names.join(" | ")));
        for factor in &joint.factors {
            for (i, j, entry) in entries(&factor.matrix.to_matrix()) {
                text.push_str(&format!("  {} [{i},{j}] = {}\n", factor.name, line(entry)));
            }
        }
    }
    for ([name, _], matrix) in matrices(equations) {
        text.push_str(&format!("\n{name}\n"));
        for (i, j, entry) in entries(&matrix) {
            text.push_str(&format!("  [{i},{j}] = {}\n", line(entry)));
        }
    }
    for (name, letter, vector) in vectors(equations) {
        text.push_str(&format!("\n{name}\n"));
        for (component, polynomial) in COMPONENTS.iter().zip(vector.iter()) {
            for (degree, part) in by_order(polynomial) {
                text.push_str(&format!("  {letter}{component}, order {degree}: {}\n", line(&part)));
            }
        }
    }
    text
}

fn remark(machine: &Machine, symbol: &Symbol) -> Option<String> {
    match symbol.meaning {
        SymbolMeaning::ToolLength => {
            let length = machine.tool().tip[2] - machine.tool().gauge[2];
            Some(format!("L: Z of the functional point from the gauge point, {length} mm on this machine"))
        }
        SymbolMeaning::Error(_, -1) => {
            Some(format!("{} is the error in ISO's names with the opposite sign", symbol.text))
        }
        _ => None,
    }
}

/// All matrices with their names, plain and for LaTeX.
fn matrices(equations: &Equations) -> Vec<([String; 2], Matrix4<Symbolic>)> {
    let joint = |(name, htm): &(String, Htm<Symbolic>)| {
        let name = format!("Joint {name}");
        ([name.clone(), escape(&name)], htm.to_matrix())
    };
    let mut all: Vec<_> = equations.joints.iter().map(joint).collect();
    let named = |plain: &str, latex: &str| [plain.to_owned(), format!("$\\boldsymbol{{{latex}}}$")];
    let (tool, work) = ("T_{\\mathrm{tool}}", "T_{\\mathrm{work}}");
    let e_ve = format!(
        "E_{{VE}} = ({tool}^{{-1}} {work})_{{\\mathrm{{real}}}} - ({tool}^{{-1}} {work})_{{\\mathrm{{ideal}}}}"
    );
    all.push((named("T_tool", tool), equations.t_tool.to_matrix()));
    all.push((named("T_work", work), equations.t_work.to_matrix()));
    all.push((named("E_VE = (T_tool^-1 T_work) real minus ideal", &e_ve), equations.e_ve.clone()));
    all
}

/// The two vectors, with their titles and letters.
fn vectors(equations: &Equations) -> [(&'static str, &'static str, &Vector3<Symbolic>); 2] {
    [
        ("Deviation of the functional point, actual minus nominal", "D", &equations.position),
        ("Deviation of the orientation", "w", &equations.rotation),
    ]
}

/// A LaTeX document.
pub fn latex(machine: &Machine, equations: &Equations, with_factors: bool) -> String {
    let mut text = String::from(
        "\\documentclass{article}\n\\usepackage{amsmath,amsbsy}\n\\usepackage[margin=20mm]{geometry}\n\
         \\setlength{\\parindent}{0pt}\n\\begin{document}\n\\raggedright\n",
    );
    text.push_str(&format!("\\section*{{{}}}\n", escape(machine.name())));
    let line = |p: &Symbolic| polynomial_in(Script::Latex, p, &equations.symbols);
    if with_factors {
        text.push_str(&latex_chain(equations));
    }
    for ([_, name], matrix) in matrices(equations) {
        text.push_str(&format!("\n\\subsection*{{{name}}}\n"));
        if fits(&matrix, &equations.symbols) {
            text.push_str(&array(&matrix, line));
            continue;
        }
        for (i, j, entry) in entries(&matrix) {
            text.push_str(&format!("$[{i},{j}] = {}$\\par\n", line(entry)));
        }
    }
    for (name, letter, vector) in vectors(equations) {
        text.push_str(&format!("\n\\subsection*{{{name}}}\n"));
        for (component, polynomial) in COMPONENTS.iter().zip(vector.iter()) {
            for (degree, part) in by_order(polynomial) {
                text.push_str(&format!("${letter}_{component}^{{({degree})}} = {}$\\par\n", line(&part)));
            }
        }
    }
    text.push_str("\\end{document}\n");
    text
}

/// The chain: T_tool and T_work as products of joints, and each joint as a product of matrices.
fn latex_chain(equations: &Equations) -> String {
    let product = |workpiece: bool| {
        let side = equations.factors.iter().filter(|joint| joint.on_workpiece_side == workpiece);
        let names: Vec<String> = side.map(|joint| format!("G_{{{}}}", joint.name)).collect();
        if names.is_empty() { "1".to_owned() } else { names.join("\\,") }
    };
    let mut text = format!(
        "\n\\subsection*{{Chain}}\n\\[T_{{\\mathrm{{tool}}}} = {}, \\qquad T_{{\\mathrm{{work}}}} = ({})^{{-1}}\\]\n",
        product(false),
        product(true)
    );
    let line = |p: &Symbolic| polynomial_in(Script::Latex, p, &equations.symbols);
    for FactorsOfJoint { name, factors, .. } in &equations.factors {
        let letter = |factor: &str| match factor {
            "T(o)" => format!("T(o_{{{name}}})"),
            "T(-o)" => format!("T(-o_{{{name}}})"),
            other => other.replace("Loc", "L").replace("^-1", "^{-1}").replace(' ', "\\,"),
        };
        let letters: Vec<String> = factors.iter().map(|factor| letter(factor.name)).collect();
        text.push_str(&format!("\\subsection*{{$G_{{{name}}} = {}$}}\n", letters.join("\\;")));
        for (letter, factor) in letters.iter().zip(factors) {
            let matrix = factor.matrix.to_matrix();
            if fits(&matrix, &equations.symbols) {
                text.push_str(&format!("${letter}$: {}", array(&matrix, line)));
                continue;
            }
            for (i, j, entry) in entries(&matrix) {
                text.push_str(&format!("${letter}\\,[{i},{j}] = {}$\\par\n", line(entry)));
            }
        }
    }
    text
}

/// True if it is narrow enough to be set as a matrix. The text of an entry is about as wide as its print.
fn fits(matrix: &Matrix4<Symbolic>, symbols: &[Symbol]) -> bool {
    let width = |j: usize| (0..3).map(|i| polynomial_text(&matrix[(i, j)], symbols).len()).max().unwrap_or(0);
    (0..4).map(width).sum::<usize>() <= PAGE
}

/// Characters of polynomials that fit on a line, with the gaps of four columns.
const PAGE: usize = 90;

fn array(matrix: &Matrix4<Symbolic>, line: impl Fn(&Symbolic) -> String) -> String {
    let row = |i: usize| (0..4).map(|j| line(&matrix[(i, j)])).collect::<Vec<_>>().join(" & ");
    let rows: Vec<String> = (0..4).map(row).collect();
    format!("$\\begin{{pmatrix}} {} \\end{{pmatrix}}$\\par\n", rows.join(" \\\\ "))
}

/// Letters that plain LaTeX has.
const LETTERS: &str = "ÀÁÂÃÄÅÇÈÉÊËÌÍÎÏÑÒÓÔÕÖØÙÚÛÜÝàáâãäåçèéêëìíîïñòóôõöøùúûüýÿßČčĚěŘřŠšŮůŽž";

/// Text for LaTeX; what it has no letter for is written by its code.
fn escape(text: &str) -> String {
    let one = |c: char| match c {
        'µ' | 'μ' => "$\\mu$".to_owned(),
        '°' => "$^\\circ$".to_owned(),
        _ if !c.is_ascii() && !LETTERS.contains(c) => format!("U+{:04X}", u32::from(c)),
        '\\' => "\\textbackslash{}".to_owned(),
        '^' => "\\textasciicircum{}".to_owned(),
        '~' => "\\textasciitilde{}".to_owned(),
        '{' | '}' | '_' | '#' | '$' | '%' | '&' => format!("\\{c}"),
        _ => c.to_string(),
    };
    text.chars().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_people_would() {
        let text = |value| number(Script::Text, value);
        assert_eq!([text(380.0), text(0.5), text(1.0 / 6.0), text(62.5)], ["380", "1/2", "1/6", "125/2"]);
        assert_eq!([text(0.1), text(libm::sqrt(0.5))], ["0.1", "0.7071067811865476"]);
        assert_eq!(number(Script::Latex, 1.5), "\\tfrac{3}{2}");
    }

    #[test]
    fn powers_of_functions_stand_before_their_argument() {
        let meaning = SymbolMeaning::Cosine(0);
        let symbol = Symbol { text: "cos(A)".to_owned(), latex: "\\cos\\mathit{A}".to_owned(), meaning };
        assert_eq!(latex_power(Some(&symbol), 2), "\\cos^{2}\\mathit{A}");
        let plain =
            Symbol { text: "X".to_owned(), latex: "\\mathit{X}".to_owned(), meaning: SymbolMeaning::Position(0) };
        assert_eq!(latex_power(Some(&plain), 3), "{\\mathit{X}}^{3}");
    }

    #[test]
    fn user_text_cannot_break_the_document() {
        assert_eq!(escape("50% {A_1} \\x"), "50\\% \\{A\\_1\\} \\textbackslash{}x");
    }
}
