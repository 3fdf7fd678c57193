//! An error term as written.

use super::forms::{deserialize_by_forms, mapping_or_value};
use super::scalar::Scalar;
use super::schema_forms::{object, quantity};
use indexmap::IndexMap;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

/// A B-spline as written.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BSplineEntry {
    /// 1 to 3; default 3.
    pub degree: Option<u8>,
    /// Rising positions from end to end, each once.
    pub knots: Vec<Scalar>,
    /// One more than the intervals for each degree; on a continuous axis as many as the intervals.
    pub coefficients: Vec<Scalar>,
}

/// Defines an entry with the forms of a curve as fields, and others beside them.
macro_rules! entry_with_curve {
    ($(#[$meta:meta])* $entry:ident { $($beside:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields, default, remote = "Self")]
        #[schemars(transform = super::schema_forms::one_form)]
        pub struct $entry {
            /// A constant with its unit.
            pub value: Option<Scalar>,
            /// Path of a CSV file that has a column of this error's name.
            pub table: Option<String>,
            /// Points in the file: [position, value].
            #[schemars(schema_with = "super::schema_forms::points")]
            pub points: Option<Vec<Vec<Scalar>>>,
            /// Between points: `linear` (default) or `cubic`.
            #[schemars(schema_with = "super::schema_forms::interpolation")]
            pub interpolation: Option<String>,
            /// Beyond the points, where they stop short of the travel: `hold` (default), `slope` or `refuse`.
            #[schemars(schema_with = "super::schema_forms::beyond")]
            pub beyond: Option<String>,
            /// Coefficients by rising power of the position.
            #[schemars(schema_with = "super::schema_forms::polynomial")]
            pub polynomial: Option<Vec<Scalar>>,
            /// [cosine, sine] by order; rotary axes only.
            #[schemars(schema_with = "super::schema_forms::harmonics")]
            pub harmonics: Option<IndexMap<String, Vec<Scalar>>>,
            /// Degree, knots and coefficients.
            #[schemars(schema_with = "super::schema_forms::bspline")]
            pub bspline: Option<BSplineEntry>,
            $($beside)*
        }

        mapping_or_value!(
            $entry,
            value: std::convert::identity,
            "a value with its unit, or a mapping such as { table: x.csv }"
        );
    };
}

entry_with_curve! {
    /// One of the forms of a curve: exactly one of `value`, `table`, `points`, `polynomial`, `harmonics`, `bspline`.
    CurveEntry {}
}

entry_with_curve! {
    /// An error term: a curve, one for each direction, or a tolerance.
    TermEntry {
        /// The curve for rising positions.
        #[schemars(schema_with = "curve")]
        pub forward: Option<CurveEntry>,
        /// The curve for falling positions.
        #[schemars(schema_with = "curve")]
        pub reverse: Option<CurveEntry>,
        /// Not known, only bounded.
        #[schemars(schema_with = "super::schema_forms::bound")]
        pub tolerance: Option<Scalar>,
        /// Expanded uncertainty (k = 2) of the values.
        pub uncertainty: Option<Scalar>,
        /// The origin of the numbers.
        #[schemars(schema_with = "super::schema_forms::notes")]
        pub provenance: Option<IndexMap<String, Scalar>>,
    }
}

impl TermEntry {
    /// The curve of both directions.
    pub fn curve(&self) -> CurveEntry {
        CurveEntry {
            value: self.value.clone(),
            table: self.table.clone(),
            points: self.points.clone(),
            interpolation: self.interpolation.clone(),
            beyond: self.beyond.clone(),
            polynomial: self.polynomial.clone(),
            harmonics: self.harmonics.clone(),
            bspline: self.bspline.clone(),
        }
    }
}

deserialize_by_forms!(CurveEntry, TermEntry);

/// A curve of one direction, short or long.
pub fn curve(generator: &mut SchemaGenerator) -> Schema {
    let (short, long) = (quantity(generator).to_value(), object::<CurveEntry>(generator));
    json_schema!({ "anyOf": [short, long] })
}
