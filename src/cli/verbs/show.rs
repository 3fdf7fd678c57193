//! `abbe show`: the chain as a picture, frames and lever arms, the location errors it needs.

use crate::analysis::{Lever, LocationSet, Status, levers};
use crate::cli::output::session::Session;
use crate::cli::output::view::{cell, numbers, table};
use crate::cli::store::write::{PictureKind, refuse_outputs, write_picture};
use crate::cli::{Format, Outcome, load};
use crate::machine::{Axis, AxisKind, Branch, Machine, Sense, Travel};
use crate::report::{all_curves, chain_dot, chain_picture};
use crate::units::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Print the chain for Graphviz instead.
    #[arg(long)]
    dot: bool,
    /// Draw the chain.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// The same as PNG.
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Draw the curves of the component errors, as SVG or PNG by the file's ending.
    #[arg(long, value_name = "FILE.svg|.png")]
    curves: Option<PathBuf>,
    /// Which of the machine's tools.
    #[arg(long)]
    tool: Option<String>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if args.dot && session.format() != Format::Text {
        return session.usage("`--dot` is a format of its own: leave `--format` out");
    }
    let machine = load::machine(session, &args.machine, args.tool.as_deref())?;
    let outputs = args.svg.iter().chain(&args.png).chain(&args.curves);
    refuse_outputs(outputs, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    draw(session, args, &machine)?;
    if args.dot {
        session.print(&chain_dot(&machine));
        return Ok(());
    }
    let shown = ChainView { machine: &machine, levers: levers(&machine), set: LocationSet::of(&machine) };
    match session.format() {
        Format::Json => session.print_json(shown.json()),
        Format::Csv => session.print(&shown.csv()),
        Format::Text => session.print(&shown.text()),
    }
    Ok(())
}

/// Writes the pictures asked for.
fn draw(session: &mut Session, args: &Args, machine: &Machine) -> Outcome {
    let mut pictures = Vec::new();
    for (path, kind) in [(&args.svg, PictureKind::Svg), (&args.png, PictureKind::Png)] {
        pictures.extend(path.as_ref().map(|path| (path, kind, chain_picture(machine))));
    }
    if let Some(path) = &args.curves {
        let Some(kind) = PictureKind::of(path) else {
            return session.usage("`--curves` takes a file that ends in .svg or .png");
        };
        let Some(picture) = all_curves(machine) else {
            return session.usage("the machine has no component errors to draw");
        };
        pictures.push((path, kind, picture));
    }
    for (path, kind, picture) in pictures {
        write_picture(path, &picture, kind, &session.diagnostics.sources).or_else(|d| session.refuse(d))?;
    }
    Ok(())
}

/// What is printed.
struct ChainView<'a> {
    machine: &'a Machine,
    levers: Vec<Lever>,
    set: LocationSet,
}

fn point(p: &[f64; 3]) -> String {
    p.map(|x| significant(x, 7)).join(", ")
}

fn kind(axis: &Axis) -> &'static str {
    if axis.kind == AxisKind::Linear { "linear" } else { "rotary" }
}

fn side(axis: &Axis) -> &'static str {
    match (axis.branch, axis.sense) {
        (Branch::Tool, _) => "tool",
        (Branch::Workpiece, Sense::Iso841) => "workpiece",
        (Branch::Workpiece, Sense::Direct) => "workpiece, direct",
    }
}

fn travel(axis: &Axis) -> String {
    match axis.travel {
        Travel::Range(min, max) => format!("{} .. {} {}", significant(min, 7), significant(max, 7), axis.unit()),
        Travel::Continuous => "continuous".to_owned(),
    }
}

/// A word of the machine language for a unit-like value.
fn word(value: impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

impl ChainView<'_> {
    fn rows(&self) -> impl Iterator<Item = (&Axis, &Lever)> {
        self.machine.axes().iter().zip(&self.levers)
    }

    fn text(&self) -> String {
        let mut axes =
            table(&["axis", "kind", "side", "direction", "origin, mm", "travel", "arm at 0, mm", "longest arm, mm"]);
        for (axis, lever) in self.rows() {
            let prime = if axis.branch == Branch::Workpiece { "'" } else { "" };
            let _ = axes.add_row([
                format!("{}{prime}", axis.name),
                kind(axis).to_owned(),
                side(axis).to_owned(),
                axis.direction.map(|x| significant(x, 6)).join(", "),
                point(&axis.origin),
                travel(axis),
                significant(lever.at_zero, 5),
                significant(lever.longest, 5),
            ]);
        }
        format!(
            "{}\n  {}\n\n{axes}\nArm: from the point about which the axis's angular errors turn to the functional point, over the volume.\n\n{}\n{}\n{}",
            self.machine.name(),
            self.machine.chain(),
            self.frames(),
            self.locations(),
            self.conventions()
        )
    }

    fn frames(&self) -> String {
        let mut text = String::from("Frames, in machine coordinates at the zero pose (all parallel there):\n");
        text.push_str(&format!("  workpiece origin   {} mm\n", point(&self.machine.workpiece())));
        for tool in self.machine.tools() {
            let mark = if tool.name == self.machine.tool().name { "" } else { " (not in use)" };
            let name = if tool.name.is_empty() { String::new() } else { format!("tool {}{mark}: ", tool.name) };
            text.push_str(&format!(
                "  {name}gauge point {} mm, functional point {} mm\n",
                point(&tool.gauge),
                point(&tool.tip)
            ));
        }
        text
    }

    fn locations(&self) -> String {
        let with = |status: Status| {
            let names = self.set.members.iter().filter(|(_, s)| *s == status).map(|(id, _)| id.to_string());
            names.collect::<Vec<_>>().join(" ")
        };
        let all: Vec<String> = self.set.members.iter().map(|(id, _)| id.to_string()).collect();
        let mut text = format!("Location errors this chain needs ({}): {}\n", all.len(), all.join(" "));
        let lines = [
            ("given", Status::Given),
            ("only bounded by a tolerance", Status::Bounded),
            ("not given, but said by others that are", Status::Covered),
            ("missing (taken as zero)", Status::Missing),
        ];
        for (what, names) in
            lines.map(|(what, status)| (what, with(status))).iter().filter(|(_, names)| !names.is_empty())
        {
            text.push_str(&format!("  {what}: {names}\n"));
        }
        if !self.set.besides.is_empty() {
            let names: Vec<String> = self.set.besides.iter().map(ToString::to_string).collect();
            text.push_str(&format!("  given besides: {}\n", names.join(" ")));
        }
        text
    }

    fn conventions(&self) -> String {
        let c = self.machine.conventions();
        let mut text = format!(
            "Conventions: location {}, linear {}, rotary {}, workpiece_axes {}, errors_are {}, location_order {}, joints {}\n",
            word(c.location),
            word(c.linear),
            word(c.rotary),
            word(c.workpiece_axes),
            word(c.errors_are),
            word(c.location_order),
            word(c.joints)
        );
        if let Some(order) = c.default_order {
            text.push_str(&format!("  evaluated to order {order} unless `--order` says otherwise\n"));
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let axes: Vec<_> = self
            .rows()
            .map(|(axis, lever)| {
                let (min, max) = axis.travel.interval();
                json!({
                    "name": axis.name.as_str(), "kind": axis.kind, "side": axis.branch, "sense": axis.sense,
                    "direction": axis.direction, "origin_mm": axis.origin, "travel": [min, max],
                    "continuous": axis.travel == Travel::Continuous, "unit": axis.unit(),
                    "arm_mm": {"at_zero": lever.at_zero, "longest": lever.longest},
                })
            })
            .collect();
        let tools: Vec<_> = self
            .machine
            .tools()
            .iter()
            .map(|t| json!({"name": t.name, "gauge_mm": t.gauge, "tip_mm": t.tip}))
            .collect();
        let members: Vec<_> =
            self.set.members.iter().map(|(id, status)| json!({"error": id, "status": status})).collect();
        json!({
            "machine": self.machine.name(), "chain": self.machine.chain().to_string(), "axes": axes, "tools": tools,
            "workpiece_origin_mm": self.machine.workpiece(), "conventions": self.machine.conventions(),
            "location_errors": {"set": members, "besides": self.set.besides},
        })
    }

    /// The table of the axes.
    fn csv(&self) -> String {
        let mut csv =
            "axis,kind,side,ux,uy,uz,x [mm],y [mm],z [mm],min,max,unit,arm at 0 [mm],longest arm [mm]\n".to_owned();
        for (axis, lever) in self.rows() {
            let (min, max) = axis.travel.interval();
            let ends = if axis.travel == Travel::Continuous { ",".to_owned() } else { numbers([min, max]) };
            let fields = [
                axis.name.to_string(),
                kind(axis).to_owned(),
                cell(side(axis)),
                numbers(axis.direction),
                numbers(axis.origin),
                ends,
                axis.unit().to_owned(),
                numbers([lever.at_zero, lever.longest]),
            ];
            csv.push_str(&fields.join(","));
            csv.push('\n');
        }
        csv
    }
}
