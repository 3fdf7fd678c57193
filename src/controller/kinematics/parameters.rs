//! Kinematic parameters: the numbers of a controller's own five-axis transformation, from the lines of the rotary axes
//! and back.
//!
//! The certificate uses the transformation that the numbers of the files give. A part of the machine that no number
//! places is where it is nominally.

use super::assumed::{SAME, holds, no_rules};
use super::transformation::Transformation;
use crate::compensation::{Increment, KinematicsMechanism, MachinePart, ParameterRules, ParameterVector};
use crate::controller::emit::decimal_text;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisKind, AxisName, Branch, Machine};
use nalgebra::Vector3;

/// The parameters of a machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameters {
    #[serde(skip)]
    pub(super) rules: ParameterRules,
    #[serde(skip)]
    pub(super) increment: Increment,
    #[serde(skip)]
    max_offset_mm: Option<f64>,
    /// The numbers, in the order of the file: mm, and components of unit vectors.
    values: Vec<f64>,
    /// The numbers with which the errors of the machine file were measured: the nominal machine's, or those found in a
    /// file.
    before: Vec<f64>,
    #[serde(skip)]
    pub(super) nominal: Transformation,
    #[serde(skip)]
    transformation: Transformation,
    /// True if blocks program the direction of the tool by a vector, false if by the rotary axes.
    pub(super) vectors: bool,
}

/// A parameter as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenParameter {
    /// The controller's name.
    pub name: String,
    /// The number.
    pub value: String,
    /// The number with which the machine was measured.
    pub before: String,
}

/// Steps by which numbers that close a loop may miss it.
const LOOSE_STEPS: f64 = 2.0;

impl Parameters {
    /// Takes the parameters from the location errors of a machine. Refusal: E0751.
    pub fn of(machine: &Machine, mechanism: &KinematicsMechanism, vectors: bool) -> Result<Self, Diagnostic> {
        let nominal = Transformation::nominal(machine)?;
        if mechanism.linear_first {
            linear_first(machine)?;
        }
        let rules = mechanism.machines.iter().find(|rules| rules.fit(&nominal));
        let rules = rules.ok_or_else(|| no_rules(mechanism, machine, &nominal))?.clone();
        let actual = Transformation::actual(machine)?;
        let before = rules.numbers(&nominal);
        let empty = Self {
            increment: mechanism.increment,
            max_offset_mm: mechanism.max_offset_mm,
            values: before.clone(),
            before,
            transformation: nominal.clone(),
            nominal,
            rules,
            vectors,
        };
        let moved = empty.moving_to(&actual);
        match moved.beyond(&moved.values) {
            Some(why) => {
                Err(Diagnostic::new(codes::E0751, why).help("the controller takes no such number: move the zero"))
            }
            None => Ok(moved),
        }
    }

    /// The same numbers for a machine that was measured with these in force: old plus what the errors change.
    pub fn on_top_of(self, installed: Vec<f64>) -> Self {
        let change: Vec<f64> = self.values.iter().zip(&self.before).map(|(v, b)| v - b).collect();
        let values: Vec<f64> = installed.iter().zip(&change).map(|(old, change)| old + change).collect();
        let rounded = self.rules.round(&values, self.increment);
        Self { before: installed, ..self }.with_values(rounded)
    }

    /// The parameters that take these back: the numbers before, as far as the format holds their decimals. Beside them
    /// stand these as the earlier ones.
    #[must_use]
    pub fn restored(&self) -> Self {
        let values = self.rules.round(&self.before, self.increment);
        Self { before: self.values.clone(), ..self.clone() }.with_values(values)
    }

    /// The same parameters with other numbers, such as those read from a file.
    pub fn with_values(self, values: Vec<f64>) -> Self {
        let transformation = self.rules.transformation(&self.nominal, &self.effective(&values));
        Self { values, transformation, ..self }
    }

    /// The same, with tool directions programmed by vectors, or by the rotary axes.
    #[must_use]
    pub fn with_programming(self, vectors: bool) -> Self {
        Self { vectors, ..self }
    }

    /// The numbers, in the order of the file.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The names of the numbers.
    pub fn names(&self) -> Vec<&str> {
        self.rules.names().map(String::as_str).collect()
    }

    /// Returns the machine that the numbers leave to tables: their lines are nominal, location errors what is left.
    /// Refusal: E0751.
    pub fn remaining(&self, machine: &Machine) -> Result<Machine, Diagnostic> {
        self.transformation.remaining(machine)
    }

    /// The transformation that the numbers give.
    pub fn transformation(&self) -> &Transformation {
        &self.transformation
    }

    /// The numbers as text.
    pub fn texts(&self) -> Vec<WrittenParameter> {
        let offsets = self.rules.offsets();
        let text = |value: f64, offset: bool| {
            let (scale, decimals) = step(self.increment, offset);
            decimal_text(value * scale, decimals)
        };
        let numbers = self.values.iter().zip(&self.before).zip(offsets);
        let all = self.rules.names().zip(numbers);
        all.map(|(name, ((value, before), offset))| WrittenParameter {
            name: name.clone(),
            value: text(*value, offset),
            before: text(*before, offset),
        })
        .collect()
    }

    /// Returns numbers of a file as mm and components of unit vectors.
    pub fn decode(&self, stored: &[f64]) -> Vec<f64> {
        let offsets = self.rules.offsets();
        stored.iter().zip(&offsets).map(|(number, offset)| number / step(self.increment, *offset).0).collect()
    }

    /// Returns which offset is beyond what the controller takes, if one is.
    fn beyond(&self, values: &[f64]) -> Option<String> {
        let (limit, offsets) = (self.max_offset_mm?, self.rules.offsets());
        let far = (0..values.len()).find(|i| offsets[*i] && values[*i].abs() > limit)?;
        Some(format!("`{}` is {} mm, above the controller's limit of {limit} mm", self.names()[far], values[far]))
    }

    /// Returns the reason why the controller would not do with these numbers what they are for, if there is one.
    pub fn fault(&self, values: &[f64]) -> Option<String> {
        if let Some(why) = self.beyond(values) {
            return Some(why);
        }
        let effective = self.effective(values);
        let placed = self.rules.transformation(&self.nominal, &effective);
        let directions = placed.table.iter().chain(&placed.head).map(|line| line.direction).chain([placed.tool]);
        if directions.into_iter().any(|direction| !(direction.norm() - 1.0).abs().lt(&1e-9)) {
            return Some("a direction has no length".to_owned());
        }
        let (closed, offsets) = (self.rules.numbers(&placed), self.rules.offsets());
        let (scale, decimals) = step(self.increment, true);
        let loose = LOOSE_STEPS / (scale * libm::pow(10.0, f64::from(decimals)));
        let open = (0..values.len()).find(|i| offsets[*i] && (effective[*i] - closed[*i]).abs() > loose)?;
        let off = decimal_text(effective[open] - closed[open], 6);
        Some(format!(
            "`{}` does not close the chain of vectors: it is {off} mm off the sum of the others",
            self.names()[open]
        ))
    }

    /// True if another transformation has other numbers than the nominal one.
    pub(super) fn differs(&self, other: &Transformation) -> bool {
        let both = [&self.nominal, other].map(|of| self.rules.numbers(of));
        both[0].iter().zip(&both[1]).any(|(a, b)| (a - b).abs() > SAME)
    }

    /// The numbers of the nominal machine, changed as these change those with which the machine was measured.
    fn effective(&self, values: &[f64]) -> Vec<f64> {
        let own = self.rules.numbers(&self.nominal);
        (0..values.len()).map(|i| own[i] + values[i] - self.before[i]).collect()
    }

    /// The parameters of displaced lines, rounded.
    fn moving_to(self, actual: &Transformation) -> Self {
        let first = self.rules.round(&self.rules.numbers(actual), self.increment);
        // Numbers that close a loop follow from the rounded others.
        let closed = self.rules.numbers(&self.rules.transformation(&self.nominal, &first));
        let mut values = self.rules.round(&closed, self.increment);
        // A direction is normalised on the way: its rounding is the first.
        let offsets = self.rules.offsets();
        (0..values.len()).filter(|i| !offsets[*i]).for_each(|i| values[i] = first[i]);
        self.with_values(values)
    }
}

/// Units in one mm (of directions in one), and decimals.
pub(super) fn step(increment: Increment, offset: bool) -> (f64, u8) {
    if offset {
        (increment.position_scale.mm, increment.position_decimals)
    } else {
        (increment.correction_scale.mm, increment.correction_decimals)
    }
}

/// Refuses a machine with a rotary axis between the bed and a linear axis: E0751.
fn linear_first(machine: &Machine) -> Result<(), Diagnostic> {
    let rotary =
        |name: &AxisName| machine.axis_index(name.as_str()).is_some_and(|i| machine.axes()[i].kind == AxisKind::Rotary);
    let carrier = [Branch::Workpiece, Branch::Tool].into_iter().find_map(|branch| {
        let axes = machine.chain().axes(branch);
        let first = axes.iter().position(|name| rotary(name))?;
        axes[first..].iter().any(|name| !rotary(name)).then(|| axes[first].clone())
    });
    let Some(carrier) = carrier else { return Ok(()) };
    let message = format!(
        "`{carrier}` stands between the bed and a linear axis: the controller's chain begins with the linear axes"
    );
    Err(Diagnostic::new(codes::E0751, message)
        .help("write the chain with the linear axes next to the bed, or take another target of kinematic parameters"))
}

impl ParameterRules {
    /// True if the rules are for a machine with these nominal lines.
    fn fit(&self, nominal: &Transformation) -> bool {
        self.rotary == nominal.placement && self.assumes.iter().all(|axis| holds(axis, nominal))
    }

    /// For each number, in the order of the file: true if it is of an offset.
    pub(super) fn offsets(&self) -> Vec<bool> {
        let of = |vector: &ParameterVector| {
            let offset = matches!(vector, ParameterVector::Offset { .. });
            vec![offset; vector.names().iter().flatten().count()]
        };
        self.parameters.iter().flat_map(of).collect()
    }

    /// The numbers of a transformation, in the order of the file.
    pub(super) fn numbers(&self, of: &Transformation) -> Vec<f64> {
        let named = |vector: &ParameterVector| {
            let components = of.vector(vector);
            let named = vector.names().iter().zip(components.iter().copied().collect::<Vec<f64>>());
            named.filter_map(|(name, number)| name.as_ref().map(|_| number)).collect::<Vec<f64>>()
        };
        self.parameters.iter().flat_map(named).collect()
    }

    /// Numbers as the controller takes them.
    fn round(&self, numbers: &[f64], increment: Increment) -> Vec<f64> {
        let round = |(number, offset): (&f64, bool)| match offset {
            true => increment.position(*number, AxisKind::Linear),
            false => increment.correction(*number, AxisKind::Linear),
        };
        numbers.iter().zip(self.offsets()).map(round).collect()
    }

    /// The nominal transformation with the parts where numbers place them, one vector after the other. A vector
    /// between two parts that are placed already changes nothing.
    pub(super) fn transformation(&self, nominal: &Transformation, numbers: &[f64]) -> Transformation {
        let mut numbers = numbers.iter();
        let (mut found, mut done) = (nominal.clone(), vec![MachinePart::Gauge]);
        for vector in &self.parameters {
            let mut components = nominal.vector(vector);
            for (k, name) in vector.names().iter().enumerate() {
                if let Some(number) = name.as_ref().and_then(|_| numbers.next()) {
                    components[k] = *number;
                }
            }
            match vector {
                ParameterVector::Offset { from, to, .. } => {
                    let (start, end) = (found.point(*from), found.point(*to));
                    let moved = match (done.contains(from), done.contains(to)) {
                        (true, false) => Some((*to, start + components)),
                        (false, true) => Some((*from, end - components)),
                        _ => None,
                    };
                    if let Some((part, point)) = moved {
                        done.push(part);
                        found.line_mut(part).into_iter().for_each(|line| line.point = point);
                    }
                }
                ParameterVector::Direction { of, reversed, .. } => {
                    let direction = components.normalize() * if *reversed { -1.0 } else { 1.0 };
                    match found.line_mut(*of) {
                        Some(line) => line.direction = direction,
                        None => found.tool = direction,
                    }
                }
            }
        }
        found
    }
}

impl Transformation {
    fn point(&self, part: MachinePart) -> Vector3<f64> {
        self.line(part).map_or_else(Vector3::zeros, |line| line.point)
    }

    pub(super) fn vector(&self, vector: &ParameterVector) -> Vector3<f64> {
        match vector {
            ParameterVector::Offset { from, to, .. } => self.point(*to) - self.point(*from),
            ParameterVector::Direction { of, reversed, .. } => {
                let direction = self.line(*of).map_or(self.tool, |line| line.direction);
                if *reversed { -direction } else { direction }
            }
        }
    }
}
