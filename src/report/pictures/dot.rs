//! The kinematic chain for Graphviz.

use super::chain::direction;
use crate::machine::{AxisKind, Body, Branch, Machine};
use petgraph::visit::EdgeRef;
use std::fmt::Write;

/// The chain's graph in the DOT language: an edge leads from a body to the body it carries.
pub fn chain_dot(machine: &Machine) -> String {
    let graph = machine.chain().graph();
    let mut dot = String::from("digraph chain {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n");
    // Writing to a string cannot fail.
    let _ = writeln!(dot, "  label={};", quote(&format!("{}\n{}", machine.name(), machine.chain())));
    for index in graph.node_indices() {
        let (label, style) = node(machine, &graph[index]);
        let _ = writeln!(dot, "  n{} [label={}{style}];", index.index(), quote(&label));
    }
    for edge in graph.edge_references() {
        // In a drawing from left to right the workpiece comes first, as on the walk.
        let (from, to, back) = match edge.weight() {
            Branch::Workpiece => (edge.target(), edge.source(), " [dir=back]"),
            Branch::Tool => (edge.source(), edge.target(), ""),
        };
        let _ = writeln!(dot, "  n{} -> n{}{back};", from.index(), to.index());
    }
    dot.push_str("}\n");
    dot
}

fn node(machine: &Machine, body: &Body) -> (String, &'static str) {
    match body {
        Body::Bed => ("bed".to_owned(), ", style=filled, fillcolor=lightgrey"),
        Body::Workpiece => ("workpiece".to_owned(), ", shape=ellipse"),
        Body::Tool => ("tool".to_owned(), ", shape=ellipse"),
        Body::Spindle(name) => (format!("({name})\nspindle"), ""),
        Body::Axis(name) => (axis(machine, name.as_str()), ""),
    }
}

fn axis(machine: &Machine, name: &str) -> String {
    let Some(axis) = machine.axis_index(name).map(|i| &machine.axes()[i]) else { return name.to_owned() };
    let prime = if axis.branch == Branch::Workpiece { "'" } else { "" };
    let kind = if axis.kind == AxisKind::Linear { "linear" } else { "rotary" };
    format!("{name}{prime}\n{kind} {}", direction(axis))
}

/// A double-quoted string; in DOT only the quote and the backslash need care.
fn quote(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
