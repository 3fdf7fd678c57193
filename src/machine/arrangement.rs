//! The axes of a machine placed anew, and the axes whose geometry is not stated where they stand.

use super::{
    Axis, AxisKind, AxisName, Branch, ErrorFamily, Geometry, Grid, KinematicChain, Location, Machine, Sides, Travel,
    Unstated,
};

impl Machine {
    /// Geometry of the axes on either side of the bed.
    pub fn geometry(&self) -> &Geometry {
        &self.parts().geometry
    }

    /// Returns the side of each axis.
    pub fn sides(&self) -> Sides {
        self.axes().iter().map(|axis| (axis.name.clone(), axis.branch)).collect()
    }

    /// Indices of the axes whose geometry is not stated where they stand, with the reason. Where a linear axis lies
    /// matters only if it has angular errors, or if `bounded` says that they are bounded.
    pub fn unstated(&self, bounded: impl Fn(&AxisName) -> bool) -> Vec<(usize, Unstated)> {
        let sides = self.sides();
        let matters = |index: usize, axis: &Axis| {
            axis.kind == AxisKind::Rotary || self.turns_about_its_origin(index) || bounded(&axis.name)
        };
        let axes = self.axes().iter().enumerate().filter(|(index, axis)| matters(*index, axis));
        axes.filter_map(|(index, axis)| Some((index, self.geometry().unstated(&axis.name, &sides)?))).collect()
    }

    /// Indices of the axes without an origin about which angular errors turn the carried body, or are bounded. Those
    /// whose geometry is not stated at all are left out.
    pub fn without_origin(&self, bounded: impl Fn(&AxisName) -> bool) -> Vec<usize> {
        let unstated = self.unstated(&bounded);
        let written =
            |axis: &Axis| self.geometry().axes.get(&axis.name).is_none_or(|both| both.on(axis.branch).origin_written);
        let silent = |index: usize, axis: &Axis| {
            let turned = self.turns_about_its_origin(index) || bounded(&axis.name);
            let turned = turned || (axis.kind == AxisKind::Rotary && self.tilts_its_line(index));
            turned && !written(axis) && unstated.iter().all(|(i, _)| *i != index)
        };
        self.axes().iter().enumerate().filter(|(index, axis)| silent(*index, axis)).map(|(index, _)| index).collect()
    }

    /// Returns the same with the bounds of the file: by letter, along and across, and by the class that it names.
    pub fn without_origin_in_file(&self) -> Vec<usize> {
        self.without_origin(|_| self.class().is_some())
    }

    /// Returns the axis from which the workpiece's origin is given, if that axis does not carry the workpiece.
    pub fn unstated_workpiece(&self) -> Option<AxisName> {
        self.geometry().unstated_workpiece(&self.sides()).cloned()
    }

    /// True if errors of an axis turn the carried body about its origin.
    pub fn turns_about_its_origin(&self, axis: usize) -> bool {
        let errors = self.axis_errors(axis);
        let carried = self.conventions().location == Location::CarriedBody;
        let name = &self.axes()[axis].name;
        let bounded = |family| self.tolerances().bounds(name, family, true);
        errors.tilts()
            || bounded(ErrorFamily::Component)
            || (carried && bounded(ErrorFamily::Location))
            || (carried && errors.location[3..].iter().any(Option::is_some))
    }

    /// True if the file gives or bounds an angle by which the line of an axis is off.
    fn tilts_its_line(&self, axis: usize) -> bool {
        self.axis_errors(axis).location[3..].iter().any(Option::is_some)
            || self.tolerances().bounds(&self.axes()[axis].name, ErrorFamily::Location, true)
    }

    /// Returns the same machine with linear axes of `length_mm` to either side of their zero, on both sides of the bed;
    /// the volume stays.
    pub fn with_linear_travels(&self, length_mm: f64) -> Self {
        let travel = Travel::Range(-length_mm, length_mm);
        let mut parts = self.parts().clone();
        for axis in parts.axes.iter_mut().filter(|axis| axis.kind == AxisKind::Linear) {
            axis.travel = travel;
            if let Some(both) = parts.geometry.axes.get_mut(&axis.name) {
                Branch::BOTH.into_iter().for_each(|branch| both.on_mut(branch).travel = travel);
            }
        }
        self.with_parts(parts)
    }

    /// Returns the same axes in another order or on another side, listed on the walk from workpiece to tool; an axis
    /// left out goes with its errors. Each axis has the geometry, travel and errors that the file states for its side;
    /// where it states none, it keeps what it has. `None` if an axis is not there, or twice, or none is left.
    pub fn rearranged(&self, walk: &[(AxisName, Branch)]) -> Option<Self> {
        let index: Vec<usize> = walk.iter().map(|(name, _)| self.axis_index(name.as_str())).collect::<Option<_>>()?;
        let side = |branch| walk.iter().filter(move |(_, side)| *side == branch).map(|(name, _)| name.clone());
        let (workpiece, tool): (Vec<_>, Vec<_>) =
            (side(Branch::Workpiece).rev().collect(), side(Branch::Tool).collect());
        let chain = KinematicChain::new(&workpiece, &tool, self.chain().spindle()).ok()?;
        // An axis that carries the workpiece does not come after one that carries the tool.
        if walk.is_empty() || !chain.walk().into_iter().eq(walk.iter().map(|(name, branch)| (name, *branch))) {
            return None;
        }
        let mut parts = self.parts().clone();
        parts.chain = chain;
        let sides: Sides = walk.iter().cloned().collect();
        let origins = self.geometry().origins(&sides);
        (parts.axes, parts.errors, parts.volume) = (Vec::new(), Vec::new(), Vec::new());
        for (i, (name, branch)) in index.into_iter().zip(walk) {
            let old = &self.axes()[i];
            let mut errors = self.axis_errors(i).clone();
            let mut axis = Axis { branch: *branch, ..old.clone() };
            if let Some(geometry) = parts.geometry.axes.get_mut(name) {
                if *branch != old.branch
                    && let Some(here) = geometry.on_mut(*branch).errors.take()
                {
                    geometry.on_mut(old.branch).errors = Some(std::mem::replace(&mut errors, here));
                    parts.uncertainty.retain(|error, _| error.axis != *name);
                    parts.forms.retain(|form| form.axis != *name);
                    parts.covariance.iter_mut().for_each(|part| drop(part.errors.remove(name)));
                }
                let here = geometry.on(*branch);
                (axis.direction, axis.travel) = (here.direction, here.travel);
            }
            axis.origin = origins.axis(name);
            parts.volume.push(within(self.volume()[i], old.travel, axis.travel));
            parts.errors.push(errors);
            parts.axes.push(axis);
        }
        parts.errors.extend(self.spindle_errors().cloned());
        parts.workpiece = origins.workpiece();
        // It may name errors that are gone.
        parts.algebra = None;
        Some(self.with_parts(parts))
    }
}

/// Returns the grid of an axis on a side with another travel: what of it lies within, or the whole travel.
fn within(grid: Grid, old: Travel, new: Travel) -> Grid {
    let (min, max) = new.interval();
    if old == new {
        return grid;
    }
    let (low, high) = (grid.min.max(min), grid.max.min(max));
    let whole = (grid.min, grid.max) == old.interval() || low >= high;
    let (min, max) = if whole { (min, max) } else { (low, high) };
    Grid { min, max, ..grid }
}
