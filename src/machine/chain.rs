//! The kinematic chain as a graph: bed, axes, workpiece and tool are the nodes; an edge leads from
//! a body to the body it carries.

use super::AxisName;
use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, EdgeFiltered};
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

    /// Returns the other one.
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

impl Body {
    /// Returns the name of the joint that moves the body; none of bed, workpiece and tool.
    fn joint(&self) -> Option<&AxisName> {
        match self {
            Self::Axis(name) | Self::Spindle(name) => Some(name),
            Self::Bed | Self::Workpiece | Self::Tool => None,
        }
    }
}

/// The kinematic chain of a serial machine: one path from the bed to the workpiece, one to the tool, and every joint on
/// one of them.
#[derive(Debug, Clone)]
pub struct KinematicChain {
    graph: DiGraph<Body, Branch>,
    bed: NodeIndex,
}

/// The joints that more than one body would carry, so that they are not on one path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RepeatedJoints(pub Vec<AxisName>);

impl KinematicChain {
    /// Builds the graph from the axes of each branch, listed from the bed outwards. A name is one node, wherever it
    /// stands.
    pub fn new(workpiece: &[AxisName], tool: &[AxisName], spindle: Option<&AxisName>) -> Result<Self, RepeatedJoints> {
        let mut graph = DiGraph::new();
        let bed = graph.add_node(Body::Bed);
        let mut add = |carrier: NodeIndex, branch: Branch, body: Body| {
            let same = |node: &NodeIndex| body.joint().is_some() && graph[*node].joint() == body.joint();
            let known = graph.node_indices().find(same);
            let carried = known.unwrap_or_else(|| graph.add_node(body));
            let _ = graph.add_edge(carrier, carried, branch);
            carried
        };
        for (branch, axes, end) in [(Branch::Workpiece, workpiece, Body::Workpiece), (Branch::Tool, tool, Body::Tool)] {
            let spindle = spindle.filter(|_| branch == Branch::Tool).cloned().map(Body::Spindle);
            let bodies = axes.iter().cloned().map(Body::Axis).chain(spindle).chain([end]);
            let _ = bodies.fold(bed, |carrier, body| add(carrier, branch, body));
        }
        let carriers = |node: &NodeIndex| graph.edges_directed(*node, Incoming).count();
        let repeated = graph.node_indices().filter(|node| carriers(node) > 1);
        let names: Vec<AxisName> = repeated.filter_map(|node| graph[node].joint().cloned()).collect();
        if names.is_empty() { Ok(Self { graph, bed }) } else { Err(RepeatedJoints(names)) }
    }

    /// Returns the same chain with another spindle; `None` if an axis has the name.
    pub fn with_spindle(&self, name: &AxisName) -> Option<Self> {
        let [workpiece, tool] = [Branch::Workpiece, Branch::Tool].map(|branch| self.axes(branch));
        let axes = |names: Vec<&AxisName>| names.into_iter().cloned().collect::<Vec<_>>();
        Self::new(&axes(workpiece), &axes(tool), Some(name)).ok()
    }

    /// Returns the graph itself.
    pub fn graph(&self) -> &DiGraph<Body, Branch> {
        &self.graph
    }

    /// Bodies of a branch from the bed outwards, its end (workpiece or tool) included.
    pub fn branch(&self, branch: Branch) -> Vec<&Body> {
        let side = EdgeFiltered::from_fn(&self.graph, |edge| *edge.weight() == branch);
        let mut reached = Dfs::new(&side, self.bed);
        std::iter::from_fn(|| reached.next(&side)).skip(1).map(|node| &self.graph[node]).collect()
    }

    /// Axes of a branch from the bed outwards.
    pub fn axes(&self, branch: Branch) -> Vec<&AxisName> {
        let bodies = self.branch(branch).into_iter();
        bodies.filter_map(|body| if let Body::Axis(name) = body { Some(name) } else { None }).collect()
    }

    /// Returns the spindle's name, if the chain has one.
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

    fn chain(workpiece: &str, tool: &str, spindle: &str) -> Result<KinematicChain, RepeatedJoints> {
        let names = |text: &str| text.split(' ').filter_map(AxisName::new).collect::<Vec<_>>();
        KinematicChain::new(&names(workpiece), &names(tool), AxisName::new(spindle).as_ref())
    }

    #[test]
    fn a_joint_on_two_paths_is_refused() {
        let repeated = |workpiece, tool, spindle| chain(workpiece, tool, spindle).unwrap_err().0;
        let names = |list: &[&str]| list.iter().filter_map(|name| AxisName::new(name)).collect::<Vec<_>>();
        assert_eq!(repeated("Y A C", "X Z Y", "S"), names(&["Y"]));
        assert_eq!(repeated("Y A Y", "X Z", "S"), names(&["Y"]));
        assert_eq!(repeated("Y A C", "A X", "C"), names(&["A", "C"]));
    }

    #[test]
    fn the_walk_goes_from_workpiece_to_tool() {
        let chain = chain("Y A C", "X Z", "S").unwrap();
        assert_eq!(chain.to_string(), "w C' A' Y' b X Z (S) t");
        let walk: Vec<_> = chain.walk().into_iter().map(|(n, _)| n.as_str()).collect();
        assert_eq!(walk, ["C", "A", "Y", "X", "Z"]);
        assert_eq!(chain.graph().node_count(), 9);
        assert!(!petgraph::algo::is_cyclic_directed(chain.graph()));
        let ends = chain.graph().externals(petgraph::Direction::Outgoing).map(|node| &chain.graph()[node]);
        assert_eq!(ends.collect::<Vec<_>>(), [&Body::Workpiece, &Body::Tool]);
    }
}
