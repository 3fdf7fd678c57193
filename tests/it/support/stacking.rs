//! The volumetric compensation of controllers that know the ISO 230-1 errors (TF5280, 296386187: serial machines, up to
//! three linear and three rotary axes, only the position of the tool). Their manual prints no equation; it names the
//! plain sum of ISO/TR 16907: every axis displaces the tool by its translations, and by its rotations times the lever
//! arm from the axis to the tool, delta = sum (e_k + eps_k x lever_k), each seen through the axes between it and the
//! workpiece; location errors displace the axis' line and act by the difference that its motion makes. Vectors only: no
//! matrix of a joint, no derivative, no algebra, and nothing of `rigid`.

use std::collections::BTreeMap;

use super::controllers::{Axes, Controller, between};
use crate::oracle::machines::Sample;
use crate::oracle::rigid::Axis;

type V = [f64; 3];

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: V, s: f64) -> V {
    a.map(|x| x * s)
}

fn less(a: V, b: V) -> V {
    add(a, scaled(b, -1.0))
}

/// A vector turned about a direction (Rodrigues).
fn turned(v: V, about: V, deg: f64) -> V {
    let (sin, cos) = deg.to_radians().sin_cos();
    add(add(scaled(v, cos), scaled(cross(about, v), sin)), scaled(about, dot(about, v) * (1.0 - cos)))
}

/// Errors by letters without E: `XX` over positions, `C0Y` one number.
#[derive(Default)]
pub struct Errors(BTreeMap<String, Vec<(f64, f64)>>);

impl Errors {
    /// None if it is there already, or has no value.
    pub fn put(&mut self, name: &str, points: Vec<(f64, f64)>) -> Option<()> {
        (!points.is_empty() && self.0.insert(name.to_owned(), points).is_none()).then_some(())
    }

    /// Translations and rotations of an axis at a position, or of its location.
    fn six(&self, axis: &str, at: Option<(f64, bool)>) -> [V; 2] {
        let value = |direction: char| match at {
            None => self.0.get(&format!("{direction}0{axis}")).map_or(0.0, |points| points[0].1),
            Some((q, endless)) => self.0.get(&format!("{direction}{axis}")).map_or(0.0, |points| {
                let start = points[0].0;
                between(points, if endless { start + (q - start).rem_euclid(360.0) } else { q })
            }),
        };
        [['X', 'Y', 'Z'].map(value), ['A', 'B', 'C'].map(value)]
    }
}

/// The walk from the tool to the workpiece: the tool, and how far it is from where it should be.
struct KinematicsModule {
    tool: V,
    delta: V,
    /// Directions of the linear axes passed so far, with their place in the walk.
    ways: Vec<(usize, V)>,
}

/// One axis' motion of a point, and of a direction.
fn moved(axis: &Axis, unit: V, q: f64, point: V) -> V {
    if axis.rotary { add(axis.origin, turned(less(point, axis.origin), unit, q)) } else { add(point, scaled(unit, q)) }
}

fn swung(axis: &Axis, unit: V, q: f64, way: V) -> V {
    if axis.rotary { turned(way, unit, q) } else { way }
}

fn unit(direction: V) -> V {
    scaled(direction, 1.0 / dot(direction, direction).sqrt())
}

/// The linear axes' answer to the displaced tool.
pub fn controller(errors: Errors, axes: Axes, machine: &Sample) -> Option<Controller> {
    let rigid = machine.rigid.clone();
    let endless: Vec<bool> = machine.axes.iter().map(|extra| extra.travel.is_none()).collect();
    let order: Vec<usize> = rigid
        .walk
        .iter()
        .map(|axis| axes.iter().position(|(letter, _)| axis.name == letter.to_string()))
        .collect::<Option<_>>()?;
    let known = |name: &String| rigid.walk.iter().any(|axis| name.ends_with(&*axis.name));
    errors.0.keys().all(known).then_some(())?;
    let count = axes.len();
    Some(Box::new(move |q, _| {
        let mut seen = KinematicsModule { tool: add(rigid.gauge, rigid.offset), delta: [0.0; 3], ways: Vec::new() };
        for (k, axis) in rigid.walk.iter().enumerate().rev() {
            let programmed = q[order[k]];
            // A workpiece-side axis that is `direct` moves the workpiece in +, the tool in -.
            let direct = axis.direct.unwrap_or(rigid.conventions.direct) && axis.workpiece;
            let (unit, way) = (unit(axis.direction), if direct { -programmed } else { programmed });
            let [e, eps] = errors.six(&axis.name, Some((programmed, endless[k])));
            let [e0, eps0] = errors.six(&axis.name, None);
            let displaced = |point: V| add(e0, cross(eps0, less(point, axis.origin)));
            let by_error = |point: V| add(e, cross(eps, less(point, axis.origin)));
            let (before, after) = (seen.tool, moved(axis, unit, way, seen.tool));
            // A carriage carries its error along; a rotor's is measured where it does not turn: on the side of the bed.
            let on_tool_end = axis.rotary == axis.workpiece;
            let own = if on_tool_end { swung(axis, unit, way, by_error(before)) } else { by_error(after) };
            let location = less(displaced(after), swung(axis, unit, way, displaced(before)));
            seen.delta = add(add(swung(axis, unit, way, seen.delta), own), location);
            seen.tool = after;
            seen.ways.iter_mut().for_each(|(_, w)| *w = swung(axis, unit, way, *w));
            if !axis.rotary {
                seen.ways.push((k, scaled(unit, if direct { -1.0 } else { 1.0 })));
            }
        }
        let mut added = vec![0.0; count];
        let [(i, a), (j, b), (k, c)] = seen.ways[..] else { return added };
        // Cramer: the three motions that together undo the displacement.
        let volume = dot(a, cross(b, c));
        let wanted = scaled(seen.delta, -1.0 / volume);
        added[order[i]] = dot(wanted, cross(b, c));
        added[order[j]] = dot(a, cross(wanted, c));
        added[order[k]] = dot(a, cross(b, wanted));
        added
    }))
}
