//! Figures of the ISO 230 series from readings of tests: circles, axes of rotation, drift, diagonals.

use super::import::columns_left_out;
use crate::analysis::instrument::CirclePlane;
use crate::diagnostic::Sources;
use crate::report::standard_tests::{TestFigures, TestSetup, circle, diagonals, drift, rotation};
use crate::run::{Call, Refused, Reply, Run};
use crate::standards::{ReadingsTable, TableUse};
use crate::syntax::sheet::read_sheet;
use std::path::Path;

/// A test.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum StandardTest {
    /// Circular path (ISO 230-4).
    #[default]
    Circle,
    /// Error motions of an axis of rotation (ISO 230-7).
    Rotation,
    /// Thermal drift (ISO 230-3).
    Drift,
    /// Lasers along diagonals (ISO 230-6).
    Diagonals,
}

/// Options of [`figures`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct FiguresOptions {
    /// The test.
    pub test: StandardTest,
    /// Circle: its plane.
    pub plane: CirclePlane,
    /// Circle: its nominal radius, above 0 and up to 10000 mm.
    pub radius_mm: f64,
    /// Circle: its feed, mm/min.
    pub feed: Option<f64>,
    /// Rotation and drift: distance of the planes of the first and the second probe, mm; the second towards the tool
    /// holder.
    pub distance_mm: Option<f64>,
}

impl Default for FiguresOptions {
    fn default() -> Self {
        let test = StandardTest::default();
        Self { test, plane: CirclePlane::XY, radius_mm: 100.0, feed: None, distance_mm: None }
    }
}

/// Returns the figures of a test, read from a table: columns are named with their unit in the title.
///
/// Fails for a table that cannot be read, and for readings that do not carry the figures.
pub fn figures(path: impl AsRef<Path>, options: &FiguresOptions, run: Run) -> Reply<TestFigures> {
    Call::answer(run, &Sources::default(), |call| {
        let positive = |value: f64, most: f64| value > 0.0 && value <= most;
        if !positive(options.radius_mm, 1e4) || options.feed.is_some_and(|feed| !positive(feed, 1e6)) {
            return call.usage("a radius is above 0 and up to 10000 mm, a feed above 0 and up to 1000000 mm/min");
        }
        if options.distance_mm.is_some_and(|distance| !positive(distance, 1e4)) {
            return call.usage("a distance is above 0 and up to 10000 mm");
        }
        let sheet = read_sheet(path.as_ref(), run.files, &mut call.diagnostics).ok_or(Refused)?;
        let table = ReadingsTable::of(&sheet).or_else(|refusal| call.refuse(refusal))?;
        let unused = table.unused_columns(match options.test {
            StandardTest::Circle => TableUse::Circle,
            StandardTest::Rotation | StandardTest::Drift => TableUse::Probes,
            StandardTest::Diagonals => TableUse::Diagonals,
        });
        call.extend(columns_left_out(&unused, "a reading has its unit in its title: `x [um]`"));
        let FiguresOptions { plane, radius_mm, feed, distance_mm, .. } = *options;
        let setup = TestSetup { plane, radius_mm, feed, distance_mm };
        let found = match options.test {
            StandardTest::Circle => circle(&table, &setup).map(|test| TestFigures::Circle(Box::new(test))),
            StandardTest::Rotation => rotation(&table, &setup).map(TestFigures::Rotation),
            StandardTest::Drift => drift(&table, &setup).map(TestFigures::Drift),
            StandardTest::Diagonals => diagonals(&table).map(TestFigures::Diagonals),
        };
        found.or_else(|refusal| call.refuse(table.refusal(refusal)))
    })
}
