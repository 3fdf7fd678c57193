//! The geometry of the axes on either side of the bed. Which of it holds, and where relative positions lie, follows
//! from the side on which each axis stands.

use super::{AxisName, Branch, ErrorFamily, JointErrors, Travel};
use petgraph::algo::toposort;
use petgraph::graphmap::DiGraphMap;
use std::collections::BTreeMap;

/// The point that a position is relative to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ReferencePoint {
    /// Machine zero.
    Bed,
    /// The origin of the workpiece.
    Workpiece,
    /// The origin of an axis.
    Axis(AxisName),
}

/// A position at the zero pose (mm), absolute or relative.
#[derive(Debug, Clone, PartialEq)]
pub struct Position {
    /// The point it is relative to.
    pub from: ReferencePoint,
    /// Coordinates from there.
    pub at: [f64; 3],
}

impl Position {
    /// A position in machine coordinates.
    pub fn absolute(at: [f64; 3]) -> Self {
        Self { from: ReferencePoint::Bed, at }
    }
}

/// The geometry of an axis on one side of the bed.
#[derive(Debug, Clone, PartialEq)]
pub struct SideGeometry {
    /// Unit vector.
    pub direction: [f64; 3],
    /// A point of the axis.
    pub origin: Position,
    /// Its travel.
    pub travel: Travel,
    /// True if the file states the geometry for this side.
    pub stated: bool,
    /// True if an origin is written; machine zero, or the origin of the other side, is taken otherwise.
    pub origin_written: bool,
    /// Errors that hold on this side only; of the side on which the axis stands they are those of the machine.
    pub errors: Option<JointErrors>,
}

/// The geometry of an axis on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisGeometry {
    /// When it carries the tool.
    pub tool: SideGeometry,
    /// When it carries the workpiece.
    pub workpiece: SideGeometry,
}

impl AxisGeometry {
    /// Returns the geometry on a side.
    pub fn on(&self, branch: Branch) -> &SideGeometry {
        match branch {
            Branch::Tool => &self.tool,
            Branch::Workpiece => &self.workpiece,
        }
    }

    /// Returns the geometry on a side, to change it.
    pub fn on_mut(&mut self, branch: Branch) -> &mut SideGeometry {
        match branch {
            Branch::Tool => &mut self.tool,
            Branch::Workpiece => &mut self.workpiece,
        }
    }
}

/// The geometry of all axes that a file declares, and the workpiece.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Every axis that is declared, in the chain or not. No reference leads back to where it began.
    pub axes: BTreeMap<AxisName, AxisGeometry>,
    /// Origin of the workpiece.
    pub workpiece: Position,
}

/// The side of each axis of a chain.
pub type Sides = BTreeMap<AxisName, Branch>;

/// Origins of the axes and of the workpiece in machine coordinates (mm), at the zero pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Origins(BTreeMap<ReferencePoint, [f64; 3]>);

impl Origins {
    /// Returns the origin of an axis; machine zero for one that is not declared.
    pub fn axis(&self, name: &AxisName) -> [f64; 3] {
        self.0.get(&ReferencePoint::Axis(name.clone())).copied().unwrap_or_default()
    }

    /// Returns the origin of the workpiece.
    pub fn workpiece(&self) -> [f64; 3] {
        self.0.get(&ReferencePoint::Workpiece).copied().unwrap_or_default()
    }
}

impl Geometry {
    /// Returns the origins with the axes on these sides, each after the one that it is relative to; machine zero if
    /// references lead in a circle.
    pub fn origins(&self, sides: &Sides) -> Origins {
        let of_axis = |(name, axis): (&AxisName, &AxisGeometry)| {
            (ReferencePoint::Axis(name.clone()), axis.on(side(sides, name)).origin.clone())
        };
        let workpiece = (ReferencePoint::Workpiece, self.workpiece.clone());
        let positions: BTreeMap<ReferencePoint, Position> = self.axes.iter().map(of_axis).chain([workpiece]).collect();
        let references: DiGraphMap<&ReferencePoint, ()> =
            positions.iter().map(|(of, position)| (&position.from, of)).collect();
        let mut origins: BTreeMap<ReferencePoint, [f64; 3]> = BTreeMap::new();
        for of in toposort(&references, None).unwrap_or_default() {
            let Some(Position { from, at }) = positions.get(of) else { continue };
            let origin = match origins.get(from) {
                Some(base) => std::array::from_fn(|i| base[i] + at[i]),
                None => *at,
            };
            let _ = origins.insert(of.clone(), origin);
        }
        Origins(origins)
    }

    /// Returns why the geometry of an axis is not stated for the side on which it stands; `None` if it is.
    pub fn unstated(&self, axis: &AxisName, sides: &Sides) -> Option<Unstated> {
        let branch = *sides.get(axis)?;
        let geometry = self.axes.get(axis)?.on(branch);
        if !geometry.stated {
            return Some(Unstated::Side(branch));
        }
        match &geometry.origin.from {
            ReferencePoint::Axis(other) if sides.get(other) != Some(&branch) => {
                Some(Unstated::Reference(other.clone()))
            }
            _ => None,
        }
    }

    /// Returns the axis that the workpiece's origin is relative to, if that axis does not carry the workpiece.
    pub fn unstated_workpiece(&self, sides: &Sides) -> Option<&AxisName> {
        match &self.workpiece.from {
            ReferencePoint::Axis(axis) if sides.get(axis) != Some(&Branch::Workpiece) => Some(axis),
            _ => None,
        }
    }

    /// Forgets what the file states for the sides on which the axes do not stand.
    pub fn forget_other_sides(&mut self, sides: &Sides) {
        for (name, axis) in &mut self.axes {
            for branch in Branch::BOTH.into_iter().filter(|branch| sides.get(name) != Some(branch)) {
                let side = axis.on_mut(branch);
                (side.stated, side.errors) = (false, None);
            }
        }
    }

    /// Gives the other side of an axis the errors that it had in common with this one before they were changed.
    pub fn follow(&mut self, axis: &AxisName, before: &JointErrors, now: &JointErrors) {
        let Some(geometry) = self.axes.get_mut(axis) else { return };
        for errors in [&mut geometry.tool.errors, &mut geometry.workpiece.errors].into_iter().flatten() {
            for family in ErrorFamily::ALL {
                let sixes = errors.six_mut(family).iter_mut().zip(before.six(family)).zip(now.six(family));
                sixes.filter(|((other, before), _)| *other == *before).for_each(|((other, _), now)| {
                    other.clone_from(now);
                });
            }
        }
    }
}

/// Returns the side of an axis; one outside the chain has the geometry of the workpiece's side.
fn side(sides: &Sides, axis: &AxisName) -> Branch {
    sides.get(axis).copied().unwrap_or(Branch::Workpiece)
}

/// The reason why the geometry of an axis is not stated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unstated {
    /// The file says nothing of this side.
    Side(Branch),
    /// Its origin is relative to this axis, which stands on the other side or is not in the chain.
    Reference(AxisName),
}
