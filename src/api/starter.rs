//! Machine files to begin with.

/// A kind of machine to begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Starter {
    /// Three linear axes, C-frame: `w X' Y' b Z t`.
    ThreeAxis,
    /// Five axes, both rotary ones under the workpiece: `w C' A' Y' b X Z t`.
    #[default]
    Trunnion,
    /// Five axes, a swivelling head and a rotary table: `w C' Y' b X Z B t`.
    HeadTable,
    /// Five axes, a fork head: `w b X Y Z C A t`.
    HeadHead,
}

/// Returns the text of a machine file to begin with; it is accepted as it is.
pub fn starter(kind: Starter) -> &'static str {
    match kind {
        Starter::ThreeAxis => include_str!("starters/three-axis.yaml"),
        Starter::Trunnion => include_str!("starters/trunnion.yaml"),
        Starter::HeadTable => include_str!("starters/head-table.yaml"),
        Starter::HeadHead => include_str!("starters/head-head.yaml"),
    }
}

/// Returns the JSON Schema (draft-07) of the machine file.
pub fn schema() -> serde_json::Value {
    crate::syntax::schema()
}
