//! `abbe convert`: the same machine under other conventions, proved by comparing both.

use crate::cli::output::session::Session;
use crate::cli::store::write;
use crate::cli::{Exit, Format, Outcome, load};
use crate::convert::{Change, Conversion, ConversionRequest, Misfit, Proof, ROUNDING, changes, convert, prove};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::machine::{Conventions, Machine, MachineParts, machine_file};
use crate::units::{self, angle, length, significant};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The new conventions: a preset, words such as `carried_body`, or `linear: before, rotary: rotating`; what is not
    /// named stays as it is.
    #[arg(long, value_name = "CONVENTIONS", required_unless_present = "datum")]
    to: Option<String>,
    /// Let location errors count from the actual line of this axis instead of the machine frame (`axis_only`).
    #[arg(long, value_name = "AXIS")]
    datum: Option<String>,
    /// Accept a machine that differs by so much; rotations by so much over a metre. Without it nothing but rounding
    /// is accepted.
    #[arg(long, value_name = "LENGTH", value_parser = distance)]
    within: Option<f64>,
    /// Where to write the converted machine.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Which of the machine's tools is the first of the new file.
    #[arg(long)]
    tool: Option<String>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if session.format() == Format::Csv {
        return session.usage("`convert` has no csv form: it prints text or json");
    }
    let old = load::machine(session, &args.machine, args.tool.as_deref())?;
    write::refuse_outputs(&args.out, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    let wish = wish(session, &old, args)?;
    let conversion = convert(&old, &wish).or_else(|refusal| session.refuse(refusal))?;
    let new = read_back(session, &machine_file(&conversion.parts, &[]))?;
    let proof = prove(&old, &new);
    if !proof.holds(wish.within_mm) {
        return session.refuse(inexact(&old, &wish, &conversion, &proof));
    }
    let report = Report { old: &old, new: &new, wish: &wish, conversion: &conversion, proof };
    if let Some(out) = &args.out {
        let text = with_provenance(&conversion.parts, &report.provenance(args));
        if let Err(refusal) = write::write_whole(out, text.as_bytes()) {
            return session.refuse(refusal);
        }
    }
    match session.format() {
        Format::Json => session.print_json(report.json()),
        _ => session.print(&report.text(args.out.as_deref())),
    }
    session.checked()
}

/// A length of zero or more, such as `10 nm`.
fn distance(text: &str) -> Result<f64, String> {
    let length = units::quantity(text).map_err(|failure| failure.to_string())?.as_length();
    length.filter(|mm| (0.0..=1.0).contains(mm)).ok_or_else(|| "write a length up to 1 mm, such as `10 nm`".to_owned())
}

fn wish(session: &mut Session, machine: &Machine, args: &Args) -> Result<ConversionRequest, Exit> {
    let text = args.to.as_deref();
    let conventions = text.map_or(Ok(*machine.conventions()), |text| machine.conventions().amended(text));
    let conventions = conventions.or_else(|why| {
        let message = format!("`{}`: {}", shown(text.unwrap_or_default()), shown(&why.to_string()));
        let help = format!("write one of {}, or keys as in a machine file", Conventions::words().join(", "));
        session.refuse(Diagnostic::new(codes::E0528, message).help(help))
    })?;
    let known = |name: &String| machine.axes().iter().find(|axis| axis.name.as_str() == *name).map(|a| a.name.clone());
    let datum = match &args.datum {
        Some(name) => match known(name) {
            Some(axis) => Some(axis),
            None => {
                let axes: Vec<&str> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
                let message = format!("the machine has no axis `{}`", shown(name));
                return session
                    .refuse(Diagnostic::new(codes::E0528, message).help(format!("its axes are {}", axes.join(", "))));
            }
        },
        None => None,
    };
    Ok(ConversionRequest { conventions, datum, within_mm: args.within.unwrap_or(ROUNDING).max(ROUNDING) })
}

/// The machine that the text says: what is proved is what is written.
fn read_back(session: &mut Session, text: &str) -> Result<Machine, Exit> {
    load::own(text).or_else(|why| {
        let message = format!("the converted machine is refused: {}", shown(&why.to_string()));
        let help = "an error that is plausible in one convention need not be in another: check the large ones; and all tables stand \
                    in the new file, which has its limits: thin long ones out";
        session.refuse(Diagnostic::new(codes::E0529, message).help(help))
    })
}

/// Why not, how far off, and what would be accepted.
fn inexact(old: &Machine, wish: &ConversionRequest, conversion: &Conversion, proof: &Proof) -> Diagnostic {
    let message = format!(
        "the machine cannot be converted {}: the two differ by up to {} and {}",
        if wish.within_mm > ROUNDING { "as exactly as that" } else { "exactly" },
        small(proof.position, "m"),
        small(proof.rotation * 1e3, "rad"),
    );
    let mut why = Vec::new();
    if old.conventions().joints != wish.conventions.joints {
        why.push("a linearised joint with an angular error stretches, an orthogonal one does not".to_owned());
    }
    let mut list: Vec<&Misfit> = conversion.misfits.iter().collect();
    list.sort_by(|a, b| b.size.total_cmp(&a.size));
    let one = |m: &&Misfit| {
        let unit = if m.error.direction.is_rotation() { small(m.size * 1e3, "rad") } else { small(m.size, "m") };
        format!("{} ({}, {unit} off)", m.error, m.nature)
    };
    if !list.is_empty() {
        let names: Vec<String> = list.iter().take(3).map(one).collect();
        let more = if list.len() > 3 { format!(" and {} more", list.len() - 3) } else { String::new() };
        why.push(format!("no curve of the language is what these would be: {}{more}", names.join(", ")));
    }
    if why.is_empty() && proof.one_sided[0] <= wish.within_mm && proof.one_sided[1] <= wish.within_mm * 1e-3 {
        why.push("each direction of approach comes out the same, but the mean of two products is not the product of the means".to_owned());
    } else if why.is_empty() {
        why.push("the location errors of linearised joints have no product that is one".to_owned());
    }
    let enough = round_up(proof.position.max(proof.rotation * 1e3));
    let help = format!("{}; `--within \"{}\"` would accept it", why.join("; "), small(enough, "m"));
    Diagnostic::new(codes::E0526, message).help(help)
}

/// A small length (mm) or angle (mrad) in nano-units or larger.
fn small(milli: f64, unit: &str) -> String {
    let nano = milli * 1e6;
    match nano {
        n if n >= 1e6 => format!("{} m{unit}", significant(n * 1e-6, 3)),
        n if n >= 1e3 => format!("{} u{unit}", significant(n * 1e-3, 3)),
        n if n >= 1e-3 => format!("{} n{unit}", significant(n, 3)),
        n => format!("{n:.1e} n{unit}"),
    }
}

/// The next of 1, 2, 5 with zeros.
fn round_up(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(value)));
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * decade).find(|step| *step >= value * 1.05).unwrap_or(20.0 * decade)
}

/// The text of the file; entries of an earlier conversion are replaced.
fn with_provenance(parts: &MachineParts, entries: &[(String, String)]) -> String {
    let mut parts = parts.clone();
    parts.provenance.entries.retain(|(key, _)| !entries.iter().any(|(own, _)| own == key));
    machine_file(&parts, entries)
}

/// What is printed.
struct Report<'a> {
    old: &'a Machine,
    new: &'a Machine,
    wish: &'a ConversionRequest,
    conversion: &'a Conversion,
    proof: Proof,
}

impl Report<'_> {
    fn conventions(&self) -> Vec<String> {
        let mut all = self.old.conventions().changes(&self.wish.conventions);
        all.extend(self.wish.datum.iter().map(|axis| format!("datum machine frame -> {axis}")));
        if all.is_empty() { vec!["nothing to convert".to_owned()] } else { all }
    }

    /// Where the numbers of the file come from. No date: the same input gives the same bytes.
    fn provenance(&self, args: &Args) -> Vec<(String, String)> {
        let name = args.machine.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let tame = |text: String| shown(&text).chars().take(180).collect::<String>();
        vec![
            ("converted-by".to_owned(), format!("abbe {}", env!("CARGO_PKG_VERSION"))),
            ("converted-from".to_owned(), tame(name)),
            ("converted-conventions".to_owned(), tame(self.conventions().join("; "))),
            ("converted-proof".to_owned(), self.proved()),
        ]
    }

    fn proved(&self) -> String {
        let Proof { poses: [grid, random], position, rotation, .. } = self.proof;
        format!(
            "largest difference {position:.1e} mm and {rotation:.1e} rad over {grid} poses of a grid and {random} random ones"
        )
    }

    fn changes(&self) -> Vec<Change> {
        changes(self.old, &self.conversion.parts)
    }

    fn json(&self) -> serde_json::Value {
        let shown = |change: &Change, value: f64| value * if change.direction.is_rotation() { 1e6 } else { 1e3 } + 0.0;
        let change = |c: &Change| {
            let unit = if c.direction.is_rotation() { "urad" } else { "um" };
            match c.values {
                Some([a, b]) => json!({"name": c.name, "before": shown(c, a), "after": shown(c, b), "unit": unit}),
                None => json!({"name": c.name, "curve": true}),
            }
        };
        let Proof { poses, position, rotation, .. } = self.proof;
        let within = self.wish.within_mm;
        json!({
            "conventions": self.wish.conventions, "changed": self.conventions(),
            "errors": self.changes().iter().map(change).collect::<Vec<_>>(),
            "misfits": self.conversion.misfits.iter().map(|m| json!({"name": m.error, "off": m.size})).collect::<Vec<_>>(),
            "proof": {"grid_poses": poses[0], "random_poses": poses[1], "position_mm": position, "rotation_rad": rotation,
                      "bound_mm": within, "bound_rad": within * 1e-3},
        })
    }

    fn text(&self, out: Option<&Path>) -> String {
        let mut text = format!("{}: {}\n", self.old.name(), self.conventions().join("; "));
        let (constants, curves): (Vec<_>, Vec<_>) = self.changes().into_iter().partition(|c| c.values.is_some());
        for change in &constants {
            let [a, b] = change.values.unwrap_or_default();
            let print = if change.direction.is_rotation() { angle } else { length };
            text += &format!("  {:<12} {} -> {}\n", change.name, print(a), print(b));
        }
        if !curves.is_empty() {
            let names: Vec<&str> = curves.iter().map(|c| c.name.as_str()).collect();
            text += &format!("  new curves   {}\n", names.join(", "));
        }
        if let Some(name) = self.new.chain().spindle().filter(|_| self.old.chain().spindle().is_none()) {
            text += &format!(
                "  chain        {} (spindle {name} holds how the tool stands on the last axis)\n",
                self.new.chain()
            );
        }
        let bound = self.wish.within_mm;
        text += &format!("proof          {}; bound {bound:.1e} mm and {:.1e} rad\n", self.proved(), bound * 1e-3);
        match out {
            Some(path) => text + &format!("written        {}\n", path.display()),
            None => text + "nothing written: give `--out FILE`\n",
        }
    }
}
