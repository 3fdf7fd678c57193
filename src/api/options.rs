//! Types of the fields of options.

pub use super::certificate::CertifiedWork;
pub use super::enumerate::JudgedBy;
pub use super::figures::StandardTest;
pub use super::import::{Acceptance, FileContents, RunApproach, StraightnessLine};
pub use super::instrument::Instrument;
pub use super::map_result::MapPoses;
pub use super::map_tables::MapTable;
pub use super::replay::ReplayPosition;
pub use super::starter::Starter;
pub use super::tolerances::ToleranceOptions;
pub use crate::analysis::Naming;
pub use crate::analysis::budget::{Distribution, Statistic};
pub use crate::analysis::instrument::CirclePlane;
pub use crate::compensation::{Fit, Goal, Stored};
pub use crate::controller::{Limits, TemplateLimit, TemplateWatch};
pub use crate::evaluate::{Frame, Order};
pub use crate::file_set::options::{CompensationOptions, CorrectingAxes};
pub use crate::identify::verdict::inputs::{FitAcceptance, FitRange};
pub use crate::job::placement::Placement;
pub use crate::job::reference::{Alignment, DatumPoint, Reference, ReferenceKind};
pub use crate::job::reference_text::UnknownReference;
pub use crate::job::test_piece::{ConeMotion, TestPieceKind};
pub use crate::machine::Approach;
pub use crate::report::page::{BenchPage, EngineFile};
pub use crate::report::plane_picture::{PlaneComponent, PlaneDrawing, PlaneOptions};
pub use crate::report::{RowFormat as TableForm, Sink};
pub use crate::shards::study::StudyFile;
