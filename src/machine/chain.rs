//! The kinematic chain as a graph: bed, axes, workpiece and tool are the nodes; an edge leads from
//! a body to the body it carries.

use super::AxisName;
use petgraph::graph::{DiGraph, NodeIndex};
use std::fmt;

/// A side of the bed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Branch {
    /// It carries the workpiece (a primed axis).
    Workpiece,
    /// It carries the tool.
    Tool,
}

impl Branch {
    /// Both, the tool's first.
    pub const BOTH: [Self; 2] = [Self::Tool, Self::Workpiece];

    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Self::Workpiece => Self::Tool,
            Self::Tool => Self::Workpiece,
        }
    }
}

/// A body of the machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Body {
    /// The frame that stands still.
    Bed,
    /// The body that an axis moves.
    Axis(AxisName),
    /// The spindle: does not move here, but has location errors.
    Spindle(AxisName),
    /// The workpiece.
    Workpiece,
    /// The tool.
    Tool,
}

/// The kinematic chain of a serial machine: two branches from the bed.
#[derive(Debug, Clone)]
pub struct KinematicChain {
    graph: DiGraph<Body, Branch>,
    bed: NodeIndex,
    workpiece: NodeIndex,
    tool: NodeIndex,
}

impl KinematicChain {
    /// Builds the graph from the axes of each branch, listed from the bed outwards.
    pub fn new(workpiece: &[AxisName], tool: &[AxisName], spindle: Option<AxisName>) -> Self {
        let mut graph = DiGraph::new();
        let bed = graph.add_node(Body::Bed);
        let mut grow = |branch: Branch, bodies: Vec<Body>| {
            bodies.into_iter().fold(bed, |carrier, body| {
                let carried = graph.add_node(body);
                let _ = graph.add_edge(carrier, carried, branch);
                carried
            })
        };
        let axes = |names: &[AxisName]| names.iter().cloned().map(Body::Axis).collect::<Vec<_>>();
        let workpiece = grow(Branch::Workpiece, [axes(workpiece), vec![Body::Workpiece]].concat());
        let spindle = spindle.into_iter().map(Body::Spindle).collect();
        let tool = grow(Branch::Tool, [axes(tool), spindle, vec![Body::Tool]].concat());
        Self { graph, bed, workpiece, tool }
    }

    /// The graph itself.
    pub fn graph(&self) -> &DiGraph<Body, Branch> {
        &self.graph
    }

    /// Bodies from the bed (excluded) to `end`.
    fn outwards(&self, end: NodeIndex) -> Vec<&Body> {
        let mut bodies = Vec::new();
        let mut at = end;
        while at != self.bed {
            bodies.push(&self.graph[at]);
            match self.graph.neighbors_directed(at, petgraph::Direction::Incoming).next() {
                Some(carrier) => at = carrier,
                None => break,
            }
        }
        bodies.reverse();
        bodies
    }

    /// Bodies of a branch from the bed outwards, its end (workpiece or tool) included.
    pub fn branch(&self, branch: Branch) -> Vec<&Body> {
        self.outwards(if branch == Branch::Workpiece { self.workpiece } else { self.tool })
    }

    /// Axes of a branch from the bed outwards.
    pub fn axes(&self, branch: Branch) -> Vec<&AxisName> {
        let axis = |body: &'_ _| matches!(body, Body::Axis(_));
        let bodies = self.branch(branch).into_iter().filter(|b| axis(*b));
        bodies.filter_map(|b| if let Body::Axis(name) = b { Some(name) } else { None }).collect()
    }

    /// The spindle's name, if the chain has one.
    pub fn spindle(&self) -> Option<&AxisName> {
        self.graph.node_weights().find_map(|b| if let Body::Spindle(name) = b { Some(name) } else { None })
    }

    /// Axes on the walk from the workpiece to the tool, with their side.
    pub fn walk(&self) -> Vec<(&AxisName, Branch)> {
        let side = |branch| self.axes(branch).into_iter().map(move |name| (name, branch));
        side(Branch::Workpiece).rev().chain(side(Branch::Tool)).collect()
    }
}

/// As ISO prints it: `w C' A' Y' b X Z (S) t`.
impl fmt::Display for KinematicChain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("w")?;
        self.axes(Branch::Workpiece).into_iter().rev().try_for_each(|name| write!(f, " {name}'"))?;
        f.write_str(" b")?;
        self.axes(Branch::Tool).into_iter().try_for_each(|name| write!(f, " {name}"))?;
        self.spindle().map_or(Ok(()), |name| write!(f, " ({name})"))?;
        f.write_str(" t")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walk_goes_from_workpiece_to_tool() {
        let names = |text: &str| text.split(' ').filter_map(AxisName::new).collect::<Vec<_>>();
        let chain = KinematicChain::new(&names("Y A C"), &names("X Z"), AxisName::new("S"));
        assert_eq!(chain.to_string(), "w C' A' Y' b X Z (S) t");
        let walk: Vec<_> = chain.walk().into_iter().map(|(n, _)| n.as_str()).collect();
        assert_eq!(walk, ["C", "A", "Y", "X", "Z"]);
        assert_eq!(chain.graph().node_count(), 9);
        assert!(!petgraph::algo::is_cyclic_directed(chain.graph()));
    }
}
