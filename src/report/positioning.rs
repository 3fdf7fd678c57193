//! Figures of positioning after ISO 230-2 beyond those of the table: by direction, by target, with their uncertainty.

use crate::identify::import::Import;
use crate::report::{Picture, RunCurves, RunPanel, RunPicture};
use crate::standards::{self, AccuracyFigures, AccuracyUncertainty, Contributor, OneWayFigures, Repeated, contributor};
use crate::units::{Dimension, significant};
use serde::{Deserialize, Serialize};

/// Figures of one direction of approach, in the unit of the error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OneWayAccuracy {
    /// Systematic deviation E of the direction.
    #[serde(rename = "E")]
    pub systematic: f64,
    /// Repeatability R of the direction; none without repeated runs.
    #[serde(rename = "R")]
    pub repeatability: Option<f64>,
    /// Accuracy A of the direction; none without repeated runs.
    #[serde(rename = "A")]
    pub accuracy: Option<f64>,
}

impl OneWayAccuracy {
    fn of(figures: &OneWayFigures, factor: f64) -> Self {
        let scaled = |x: Option<f64>| x.map(|x| x * factor);
        let (repeatability, accuracy) = (scaled(figures.repeatability), scaled(figures.accuracy));
        Self { systematic: figures.systematic * factor, repeatability, accuracy }
    }
}

/// Figures of both directions of approach; none of a direction that was not measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OneWayBoth {
    /// Approached with rising position.
    pub forward: Option<OneWayAccuracy>,
    /// Approached with falling position.
    pub reverse: Option<OneWayAccuracy>,
}

impl OneWayBoth {
    pub(crate) fn of(figures: &AccuracyFigures, factor: f64) -> Self {
        let [forward, reverse] = figures.one_way.map(|way| way.map(|way| OneWayAccuracy::of(&way, factor)));
        Self { forward, reverse }
    }
}

/// Readings of one direction at a target, in the unit of the error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ReadAtTarget {
    /// Their mean.
    pub mean: f64,
    /// The estimate of the standard deviation; none of a single reading.
    pub s: Option<f64>,
    /// Their number.
    pub runs: usize,
}

/// A target with its readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct MeasuredTarget {
    /// Position, mm or deg.
    pub position: f64,
    /// Approached with rising position.
    pub forward: Option<ReadAtTarget>,
    /// Approached with falling position.
    pub reverse: Option<ReadAtTarget>,
    /// Approached from a side that is not known.
    pub unknown: Option<ReadAtTarget>,
    /// Reversal: mean of the forward approach minus mean of the reverse one. Lost motion is below zero.
    #[serde(rename = "B")]
    pub reversal: Option<f64>,
}

impl MeasuredTarget {
    pub(crate) fn all(figures: &AccuracyFigures, factor: f64) -> Vec<Self> {
        let read = |of: Option<Repeated>| {
            of.map(|of| ReadAtTarget {
                mean: of.mean * factor + 0.0,
                s: of.deviation.map(|s| s * factor),
                runs: of.count,
            })
        };
        let one = |target: &standards::TargetReadings| Self {
            position: target.position,
            forward: read(target.forward),
            reverse: read(target.reverse),
            unknown: read(target.unknown),
            reversal: target.reversal().map(|b| b * factor + 0.0),
        };
        figures.targets.iter().map(one).collect()
    }
}

pub(crate) struct DrawnRuns<'a> {
    /// Name of the error.
    pub error: &'a str,
    /// Unit of its values.
    pub unit: &'a str,
    /// E, B, R and A.
    pub figures: [Option<f64>; 4],
    /// The targets.
    pub targets: &'a [MeasuredTarget],
    /// Every reading: position, value, and whether it came from below.
    pub readings: &'a [(f64, f64, Option<bool>)],
}

impl DrawnRuns<'_> {
    /// The means with their bands of 2 s, and the readings.
    pub fn panel(&self) -> RunPanel {
        let figure = |(name, value): (&str, &Option<f64>)| value.map(|x| format!(", {name} {}", significant(x, 3)));
        let figures: String = ["E", "B", "R", "A"].into_iter().zip(&self.figures).filter_map(figure).collect();
        let read = |of: fn(&MeasuredTarget) -> Option<ReadAtTarget>, way: Option<bool>| RunCurves {
            means: self
                .targets
                .iter()
                .filter_map(|target| of(target).map(|at| (target.position, at.mean, at.s.map(|s| 2.0 * s))))
                .collect(),
            readings: self.readings.iter().filter(|(.., from)| *from == way).map(|(x, y, _)| (*x, *y)).collect(),
        };
        RunPanel {
            title: format!("{}{figures} {}", self.error, print_unit(self.unit)),
            unit: print_unit(self.unit),
            ways: [read(|t| t.forward, Some(true)), read(|t| t.reverse, Some(false)), read(|t| t.unknown, None)],
        }
    }
}

/// Draws the runs of errors of an axis, whose slopes are in `slope_unit`.
pub(crate) fn drawn_runs(axis: &str, subtitle: &str, slope_unit: Option<&str>, panels: &[RunPanel]) -> Picture {
    let rotary = slope_unit.is_some_and(|unit| unit.ends_with("/deg"));
    let position = format!("{axis} in {}", if rotary { "degrees" } else { "mm" });
    RunPicture { title: &format!("Axis {axis}"), subtitle, position: &position, panels }.picture()
}

/// Expanded uncertainties, k = 2, in the unit of the error, after ISO 230-2 annex A: not verified against its text.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct AccuracyUncertainties {
    /// Uncertainty of E, of one direction and of both.
    #[serde(rename = "E")]
    pub systematic: f64,
    /// Uncertainty of M.
    #[serde(rename = "M")]
    pub mean: f64,
    /// Uncertainty of B.
    #[serde(rename = "B")]
    pub reversal: f64,
    /// Uncertainty of R.
    #[serde(rename = "R")]
    pub repeatability: f64,
    /// Uncertainty of A.
    #[serde(rename = "A")]
    pub accuracy: f64,
}

/// Contributors of ISO/TR 230-9 that an uncertainty has, and those that it lacks; the list may not be complete.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct StatedContributors {
    /// Those that count.
    pub has: Vec<&'static str>,
    /// Those that are not stated.
    pub lacks: Vec<&'static str>,
}

impl StatedContributors {
    /// In words: what an uncertainty has and lacks.
    pub fn words(&self) -> String {
        format!("has {}; it lacks {}, and is not complete", self.has.join(", "), self.lacks.join(", "))
    }
}

impl AccuracyUncertainties {
    fn of(found: &AccuracyUncertainty, factor: f64) -> Self {
        Self {
            systematic: found.systematic * factor,
            mean: found.mean * factor,
            reversal: found.reversal * factor,
            repeatability: found.repeatability * factor,
            accuracy: found.accuracy * factor,
        }
    }

    /// Returns those of one error, and their contributors; `None` where none counts for it.
    pub(crate) fn of_error(
        all: &[Contributor],
        found: &Import,
        error: usize,
        figures: &AccuracyFigures,
    ) -> Option<(Self, StatedContributors)> {
        let direction = found.errors.get(error)?.direction;
        let dimension = if direction.is_rotation() { Dimension::ANGLE } else { Dimension::LENGTH };
        let length = found.is_positioning(error).then(|| standards::range(figures.targets.iter().map(|t| t.position)));
        let uncertainty = AccuracyUncertainty::of(all, dimension, length, figures.runs)?;
        let [has, lacks] = standards::contributors(all, dimension, length);
        Some((Self::of(&uncertainty, direction.micro().0), StatedContributors { has, lacks }))
    }
}

pub(crate) fn print_unit(unit: &str) -> &'static str {
    if unit == "um" { "\u{b5}m" } else { "\u{b5}rad" }
}

/// Reads the contributors; the words that cannot be read.
pub(crate) fn contributors(words: &[String]) -> Result<Vec<Contributor>, &String> {
    words.iter().map(|words| contributor(words).ok_or(words)).collect()
}
