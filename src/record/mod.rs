//! The record of a calibration as a folder.
//!
//! 1. `description` reads what the engineer states; `files` copies the files that it names.
//! 2. `errors` makes the table of errors and the curves, `figures` reads the figures, `decisions` judges both by
//!    their limits: together the [`RecordData`].
//! 3. `record_page` writes it for print, `dcc` as a digital calibration certificate.
//! 4. `make` does all of it, `sign` signs it. `check` compares a folder with its hashes and its signature; `trend` puts
//!    records in a line.

pub mod check;
mod data;
pub mod dcc;
pub(crate) mod decisions;
pub(crate) mod description;
pub(crate) mod errors;
pub(crate) mod figures;
pub mod files;
pub(crate) mod make;
mod page;
pub(crate) mod promise;
pub(crate) mod sign;
pub(crate) mod trend;

pub use data::{
    AlarmLimit, Contact, CopiedFile, CovariedError, Dates, Day, ErrorCurve, ErrorRow, Instrument, LimitDecision, Line,
    MachineState, NoValue, Person, Place, Plate, PromisedResidual, RecordData, RecordSignature, RecordedCovariance,
    RecordedFigure, RecordedFigures, RecordedSet, StateValue, Statements, Temperature, TwoLetters, UnheldReversal,
};
pub use page::{RecordPictures, record_page, record_pictures};
