//! Uncertainties that all readings share, known from elsewhere (type B of the GUM): the calibration of the instrument,
//! the temperature of the material, the set-up.

use super::prediction::FitModel;
use super::refusal::Refusal;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::Frame;
use crate::identify::data::{Measurement, Reading, ReadingKind, rotation_to};
use crate::lower::{ErrorSite, NominalPose, Source};
use crate::machine::AxisKind;
use crate::standards::thermal;
use crate::units::{self, Dimension, significant};
use nalgebra::Vector3;

/// A standard uncertainty that all readings share.
#[derive(Debug, Clone, PartialEq)]
pub struct TypeB {
    /// Its name, as the user gives it.
    pub name: String,
    /// Its effect on the readings.
    pub effect: SharedEffect,
}

/// An effect that all readings share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SharedEffect {
    /// Lengths and positions are read too large by this ratio.
    Scale(f64),
    /// All lengths of a channel are read too large by this (mm), independent of the other channels.
    Offset(f64),
}

/// Readings that share an offset: one component of one kind in one frame, or one error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OffsetChannel {
    kind: ReadingKind,
    component: usize,
    frame: Option<Frame>,
    source: Option<Source>,
}

/// The widest scale that is taken: above a measuring tape, 0.2 mm/m.
const WIDEST_SCALE: f64 = 3e-4;

/// The widest offset that is taken, mm.
const WIDEST_OFFSET: f64 = 1.0;

const HELP: &str = "write a name and a standard uncertainty: `laser 0.4 um/m` (a scale of all lengths), `set-up 2 um` \
                    (the same in every reading), `material 0.5 K x 11.7 um/m/K` (a temperature and an expansion)";

/// Reads an uncertainty in words: `laser 0.4 um/m`, `set-up 2 um`, `material 0.5 K x 11.7 um/m/K`.
pub fn type_b(words: &str) -> Result<TypeB, Refusal> {
    let refusal = |why: &str| {
        let message = format!("the uncertainty `{}` {why}", shown(words));
        Refusal::from(Diagnostic::new(codes::E0517, message).help(HELP))
    };
    let list: Vec<&str> = words.split_whitespace().collect();
    let at = |cut: usize| list.split_at_checked(cut).filter(|(name, _)| !name.is_empty());
    let found = (1..list.len()).rev().filter_map(at).find_map(|(name, rest)| Some((name, effect(&rest.join(" "))?)));
    let Some((name, effect)) = found else {
        return Err(refusal("is no name with a length, a ratio or a temperature times an expansion"));
    };
    match (thermal(&list[name.len()..].join(" ")), effect) {
        (Some(of), _) if !of.is_plausible() => {
            return Err(refusal("has an expansion or a temperature of no machine: steel has 11.5 um/m/K"));
        }
        (None, SharedEffect::Scale(ratio)) if ratio > WIDEST_SCALE => {
            return Err(refusal(&format!("is {} um/m, of no instrument: is um/m meant?", significant(ratio * 1e6, 3))));
        }
        (None, SharedEffect::Offset(size)) if size > WIDEST_OFFSET => {
            return Err(refusal(&format!("is {} mm, of no set-up: is um meant?", significant(size, 3))));
        }
        _ => {}
    }
    let (SharedEffect::Scale(size) | SharedEffect::Offset(size)) = effect;
    if size > 0.0 && size.is_finite() {
        Ok(TypeB { name: name.join(" "), effect })
    } else {
        Err(refusal("is not above zero"))
    }
}

fn effect(words: &str) -> Option<SharedEffect> {
    if let Some(thermal) = thermal(words) {
        return Some(SharedEffect::Scale(thermal.temperature * thermal.expansion));
    }
    let quantity = units::quantity(words).ok()?;
    let length = quantity.as_length().map(SharedEffect::Offset);
    let ratio = (quantity.dimension == Dimension::RATIO && words.contains('/')).then_some(quantity.value);
    length.or(ratio.map(SharedEffect::Scale))
}

impl SharedEffect {
    /// Returns what one standard uncertainty changes of a reading (mm, in its frame) of the machine with these
    /// unknowns, by channel (`None`: common to all).
    pub(crate) fn of(
        self,
        model: &FitModel<'_>,
        m: &Measurement,
        theta: &[f64],
    ) -> Vec<(Option<OffsetChannel>, Vector3<f64>)> {
        match self {
            Self::Scale(ratio) => vec![(None, length_of_reading(model, m, theta) * ratio)],
            Self::Offset(size) => channels(m).map(|of| (Some(of), Vector3::ith(of.component, size))).collect(),
        }
    }
}

/// Returns the channels of a reading; of an angle none, a length says nothing of it.
fn channels(m: &Measurement) -> impl Iterator<Item = OffsetChannel> {
    let kind = m.kind();
    let (frame, source) = match &m.reading {
        Reading::Deviation { frame, .. } => (Some(*frame), None),
        Reading::Error { source, .. } => (None, Some(*source)),
        _ => (None, None),
    };
    let read = m.reading_mask().into_iter().enumerate().filter(move |(_, seen)| *seen && !kind.is_angle());
    read.map(move |(component, _)| OffsetChannel { kind, component, frame, source })
}

/// Returns the length that a reading measures, from the workpiece origin on.
fn length_of_reading(model: &FitModel<'_>, m: &Measurement, theta: &[f64]) -> Vector3<f64> {
    let nominal = || NominalPose::in_part(model.machine(m), &m.pose);
    match &m.reading {
        Reading::Deviation { frame, .. } => {
            let nominal = nominal();
            rotation_to(*frame, &nominal) * nominal.pose.translation
        }
        Reading::Position { .. } => nominal().pose.translation,
        Reading::Distance { zero, .. } => {
            let constant = zero.map_or(0.0, |zero| theta[model.own() + zero]);
            Vector3::new(model.prediction(m, theta).x + constant, 0.0, 0.0)
        }
        Reading::Along { direction, .. } => Vector3::new(direction.dot(&nominal().pose.translation), 0.0, 0.0),
        Reading::Turn { .. } => Vector3::zeros(),
        Reading::Error { source, .. } => match source.place {
            ErrorSite::Component(i) if !source.direction.is_rotation() => {
                let linear = model.machine(m).axes().get(i).filter(|axis| axis.kind == AxisKind::Linear);
                let along = linear.map_or(0.0, |axis| axis.direction[source.direction.index()] * m.pose[i]);
                Vector3::new(along, 0.0, 0.0)
            }
            _ => Vector3::zeros(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read() {
        let effect = |words: &str| type_b(words).map(|found| (found.name, found.effect));
        assert_eq!(effect("laser 0.5 um/m").unwrap(), ("laser".to_owned(), SharedEffect::Scale(0.5e-6)));
        assert_eq!(effect("the set-up 2 um").unwrap(), ("the set-up".to_owned(), SharedEffect::Offset(2e-3)));
        let (name, scale) = effect("steel 0.5 K x 11.5 um/m/K").unwrap();
        assert_eq!(name, "steel");
        assert!(matches!(scale, SharedEffect::Scale(x) if (x - 5.75e-6).abs() < 1e-18), "{scale:?}");
        for wrong in [
            "",
            "device 0.5 mm/m",
            "set-up 2 mm",
            "laser",
            "0.5 um/m",
            "laser 0.5",
            "laser 5 urad",
            "laser 0 um",
            "laser -1 um",
            "steel 1 K",
            "steel 1 K x 115 um/m/K",
        ] {
            assert!(type_b(wrong).is_err(), "{wrong}");
        }
    }
}
