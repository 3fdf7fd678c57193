//! `abbe equations`: the closed forms.

use crate::algebra::symbolic::Symbolic;
use crate::algebra::{Algebra, Htm};
use crate::analysis::equations;
use crate::analysis::{Equations, Meaning, Naming, Options, Symbol};
use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome, load};
use crate::machine::Machine;
use crate::report::equations as print;
use serde_json::{Value, json};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Highest degree in the errors, every error on its own.
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=6), conflicts_with = "algebra")]
    order: Option<u8>,
    /// The algebra of the errors instead: the machine file's, or one in the words of its section
    /// `algebra`, such as `degree: 3, generators: per-axis, vanish: [x1^2, x3*x4]`.
    #[arg(long, value_name = "ALGEBRA", num_args = 0..=1, default_missing_value = "")]
    algebra: Option<String>,
    /// Names of the symbols.
    #[arg(long, value_enum, default_value = "iso")]
    symbols: Symbols,
    /// Keep the length of the tool as the symbol L.
    #[arg(long)]
    tool_length: bool,
    /// A LaTeX document instead of text.
    #[arg(long)]
    latex: bool,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
}

/// Whose names.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Symbols {
    /// EBX, EC0Y.
    Iso,
    /// eyx, Sxy.
    Paper,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if session.format() == Format::Csv {
        return session.usage("`equations` has no csv form: it prints text, LaTeX or json");
    }
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    let text = args.algebra.clone().unwrap_or_else(|| format!("degree: {}", args.order.unwrap_or(1)));
    let declared = session.within(|call| crate::api::algebra::declared(call, &machine, &text))?;
    let naming = match args.symbols {
        Symbols::Iso => Naming::Iso,
        Symbols::Paper => Naming::Paper,
    };
    let options = Options { naming, tool_length: args.tool_length };
    let found = equations(&machine, &declared, options).or_else(|refusal| session.refuse(refusal))?;
    match session.format() {
        Format::Json => session.print_json(contract(&machine, declared.ideal().degree, &found)),
        _ if args.latex => session.print(&print::latex(&machine, &found)),
        _ => session.print(&print::text(&machine, &found)),
    }
    Ok(())
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
        Meaning::Error(source, _) => {
            let all = crate::lower::given(machine);
            ("error", all.iter().find(|g| g.source == source).map_or(String::new(), |g| g.name.clone()))
        }
        Meaning::Position(i) => ("position", axis(i).to_owned()),
        Meaning::Sine(i) => ("sine", axis(i).to_owned()),
        Meaning::Cosine(i) => ("cosine", axis(i).to_owned()),
        Meaning::ToolLength => ("tool_length", "Z".to_owned()),
    };
    json!({"symbol": symbol.text, "kind": kind, "of": of, "sign": symbol.sign(), "latex": symbol.latex})
}
