//! `abbe show`: the chain as a picture, frames and lever arms, the location errors it needs.

use crate::cli::arguments::{PictureFile, ToolArg, help, png, svg};
use crate::cli::output::session::Session;
use crate::cli::output::view::{hide, numbers, table};
use crate::cli::{Format, Outcome};
use abbe::results::{AxisKind, Branch, ChainAxis, ChainResult, ErrorTerm, LocationStatus, Sense};
use abbe::text::{cell, significant};
use abbe::{MachineFile, show};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Print the chain for Graphviz instead.
    #[arg(long)]
    dot: bool,
    #[arg(long, value_name = "FILE", value_parser = svg, help = help::SVG,
        long_help = "Draw the chain, as SVG unless the file ends in .png")]
    svg: Option<PictureFile>,
    #[arg(long, value_name = "FILE", value_parser = png, help = help::PNG,
        long_help = "The same, as PNG unless the file ends in .svg")]
    png: Option<PictureFile>,
    /// Draw the curves of the component errors, as SVG unless the file ends in .png.
    #[arg(long, value_name = "FILE", value_parser = svg)]
    curves: Option<PictureFile>,
    /// Draw gauge point, tip, origins and lines of rotary axes with all axes at 0, as SVG unless the file ends in .png.
    #[arg(long, value_name = "FILE", value_parser = svg)]
    zero_pose: Option<PictureFile>,
    #[command(flatten)]
    tool: ToolArg,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if args.dot && session.format() != Format::Text {
        return session.usage("`--dot` is a format of its own: leave `--format` out");
    }
    let file = session.load(&args.machine, args.tool.name())?;
    PictureFile::refuse(session, args.svg.iter().chain(&args.png).chain(&args.curves).chain(&args.zero_pose))?;
    draw(session, args, &file)?;
    if args.dot {
        session.print(&file.chain_dot());
        return Ok(());
    }
    let chain = show(&file);
    session.show(&chain, || csv(&chain), || text(&chain))
}

/// Writes the pictures asked for.
fn draw(session: &mut Session, args: &Args, file: &MachineFile) -> Outcome {
    let mut pictures = Vec::new();
    pictures.extend(args.svg.iter().chain(&args.png).map(|to| (to, file.chain_picture())));
    pictures.extend(args.zero_pose.iter().map(|to| (to, file.zero_pose_picture())));
    if let Some(to) = &args.curves {
        let Some(picture) = file.error_curves() else {
            let bounded = file.errors().any(|(_, term)| matches!(term, ErrorTerm::Tolerance(_)));
            let bounds = bounded || file.tolerances().count() > 0 || file.class().is_some();
            return session.usage(if bounds {
                "no component error has a value, and bounds have no curve: `abbe map` shows what they lead to"
            } else {
                "the machine has no component errors to draw"
            });
        };
        pictures.push((to, picture));
    }
    for (to, picture) in pictures {
        to.write(&picture, session)?;
    }
    Ok(())
}

fn point(p: &[f64; 3]) -> String {
    p.map(|x| significant(x, 7)).join(", ")
}

fn kind(axis: &ChainAxis) -> &'static str {
    if axis.kind == AxisKind::Linear { "linear" } else { "rotary" }
}

fn side(axis: &ChainAxis) -> &'static str {
    match (axis.side, axis.sense) {
        (Branch::Tool, _) => "tool",
        (Branch::Workpiece, Sense::Iso841) => "workpiece",
        (Branch::Workpiece, Sense::Direct) => "workpiece, direct",
    }
}

fn travel(axis: &ChainAxis) -> String {
    let [min, max] = axis.travel.map(|q| significant(q, 7));
    if axis.continuous { "continuous".to_owned() } else { format!("{min} .. {max} {}", axis.unit) }
}

/// A word of the machine language for a unit-like value.
fn word(value: impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

fn text(of: &ChainResult) -> String {
    let mut axes = table(&[
        "axis",
        "kind",
        "side",
        "direction",
        "origin, mm",
        "travel",
        "arm at 0, mm",
        "longest arm, mm",
        "share",
    ]);
    for axis in &of.axes {
        let prime = if axis.side == Branch::Workpiece { "'" } else { "" };
        let _ = axes.add_row([
            format!("{}{prime}", axis.name),
            kind(axis).to_owned(),
            side(axis).to_owned(),
            axis.direction.map(|x| significant(x, 6)).join(", "),
            point(&axis.origin_mm),
            travel(axis),
            significant(axis.arm_mm.at_zero, 5),
            significant(axis.arm_mm.longest, 5),
            axis.arm_mm.share.map_or("-".to_owned(), |share| format!("{} %", significant(share * 100.0, 2))),
        ]);
    }
    hide(&mut axes, &[1, 6]);
    format!(
        "{}\n  {}\n\n{axes}\nArm: from the point about which the axis's angular errors turn to the functional point, \
         over the volume.\nShare: of the sum of squares of all errors, what hangs on the arm: the angular errors \
         of the axis.\n\n{}\n{}\n{}\n{}",
        of.machine,
        of.chain,
        other_sides(of),
        frames(of),
        locations(of),
        conventions(of) + &outside(of)
    )
}

/// The files from elsewhere that the machine was read from.
fn outside(of: &ChainResult) -> String {
    let files: Vec<&str> = of.inputs.iter().filter(|input| input.outside).map(|input| input.file.as_str()).collect();
    if files.is_empty() {
        return String::new();
    }
    format!("\n\nInputs outside the folder of the machine file: {}", files.join(", "))
}

/// Rows about the sides on which the axes do not stand.
fn other_sides(of: &ChainResult) -> String {
    let mut text = String::from("On the other side of the bed, if a variant or `enumerate` puts an axis there:\n");
    for axis in &of.axes {
        let Some(there) = &axis.other_side else { continue };
        let side = if there.side == Branch::Workpiece { "workpiece" } else { "tool" };
        let [min, max] = there.travel.map(|q| significant(q, 7));
        let travel = if there.continuous { "continuous".to_owned() } else { format!("{min} .. {max} {}", axis.unit) };
        text.push_str(&format!(
            "  {} with the {side}: origin {} mm, direction {}, travel {travel}\n",
            axis.name,
            point(&there.origin_mm),
            there.direction.map(|x| significant(x, 6)).join(", ")
        ));
    }
    let silent: Vec<&str> = of.axes.iter().filter(|a| a.other_side.is_none()).map(|a| a.name.as_str()).collect();
    if !silent.is_empty() {
        text.push_str(&format!("  not stated: {}\n", silent.join(", ")));
    }
    let here: Vec<&str> = of.axes.iter().filter(|a| !a.geometry_stated).map(|a| a.name.as_str()).collect();
    if !here.is_empty() {
        text.push_str(&format!("  not stated for the side on which it stands: {}\n", here.join(", ")));
    }
    text
}

fn frames(of: &ChainResult) -> String {
    let rotation = of.workpiece_rotation();
    let parallel = if rotation.is_some() { "parallel there but for the workpiece's" } else { "all parallel there" };
    let mut text = format!("Frames, in machine coordinates at the zero pose ({parallel}):\n");
    text.push_str(&format!("  workpiece origin   {} mm\n", point(&of.workpiece_origin_mm)));
    if let Some(rotation) = rotation {
        text.push_str(&format!("  workpiece rotation {rotation}\n"));
    }
    for tool in &of.tools {
        let mark = if tool.in_use { "" } else { " (not in use)" };
        let name = if tool.name.is_empty() { String::new() } else { format!("tool {}{mark}: ", tool.name) };
        let upright = tool.direction == [0.0, 0.0, 1.0];
        let along = if upright { String::new() } else { format!(", axis {}", point(&tool.direction)) };
        text.push_str(&format!(
            "  {name}gauge point {} mm, functional point {} mm{along}\n",
            point(&tool.gauge_mm),
            point(&tool.tip_mm)
        ));
    }
    for axis in of.axes.iter().filter(|axis| axis.kind == AxisKind::Rotary) {
        let along = axis.direction.map(|x| significant(x, 6)).join(", ");
        text.push_str(&format!("  line of {:9} {} mm, along {along}\n", axis.name, point(&axis.origin_mm)));
    }
    text
}

fn locations(of: &ChainResult) -> String {
    let errors = &of.location_errors;
    let with = |status: LocationStatus| {
        let names = errors.set.iter().filter(|e| e.status == status).map(|e| e.error.to_string());
        names.collect::<Vec<_>>().join(" ")
    };
    let all: Vec<String> = errors.set.iter().map(|e| e.error.to_string()).collect();
    let mut text = format!("Location errors this chain needs ({}): {}\n", all.len(), all.join(" "));
    let lines = [
        ("given", LocationStatus::Given),
        ("only bounded by a tolerance", LocationStatus::Bounded),
        ("not given, but said by others that are", LocationStatus::Covered),
        ("missing (taken as zero)", LocationStatus::Missing),
    ];
    for (what, names) in lines.map(|(what, status)| (what, with(status))).iter().filter(|(_, names)| !names.is_empty())
    {
        text.push_str(&format!("  {what}: {names}\n"));
    }
    if !errors.besides.is_empty() {
        let names: Vec<String> = errors.besides.iter().map(ToString::to_string).collect();
        text.push_str(&format!("  given besides: {}\n", names.join(" ")));
    }
    text
}

fn conventions(of: &ChainResult) -> String {
    let c = &of.conventions;
    let mut text = format!(
        "Conventions: location {}, linear {}, rotary {}, workpiece_axes {}, errors_are {}, location_order {}, joints \
         {}\n",
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

/// The table of the axes.
fn csv(of: &ChainResult) -> String {
    let mut csv =
        "axis,kind,side,ux,uy,uz,x [mm],y [mm],z [mm],min,max,unit,arm at 0 [mm],longest arm [mm],share\n".to_owned();
    for axis in &of.axes {
        let ends = if axis.continuous { ",".to_owned() } else { numbers(axis.travel) };
        let fields = [
            axis.name.clone(),
            kind(axis).to_owned(),
            cell(side(axis)),
            numbers(axis.direction),
            numbers(axis.origin_mm),
            ends,
            axis.unit.clone(),
            numbers([axis.arm_mm.at_zero, axis.arm_mm.longest]),
            axis.arm_mm.share.map_or_else(String::new, |share| share.to_string()),
        ];
        csv.push_str(&fields.join(","));
        csv.push('\n');
    }
    csv
}
