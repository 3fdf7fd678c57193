//! Files of a target read back into tables. Whatever the controller would accept in silence or misread (comments, blank
//! lines, commas, unsorted lines, NaN, too many points) is refused here with its place.
//!
//! A manifest describes the layout of a file: lines of known patterns ([`lines`]), columns, or one of the formats that
//! have a reader of their own ([`named`], [`lattice`]). Lines of a control's own archive become such lines in
//! [`archive`]. The content becomes tables in [`assemble`], as far as [`in_force`] says. Files without a known name are
//! distinguished by their content ([`recognise()`]), their axes in [`place`].

mod activation;
mod archive;
mod arrays;
mod assemble;
mod assignment;
mod columns;
mod constants;
mod coverage;
mod file;
mod in_force;
mod lattice;
mod layout;
mod lines;
mod named;
mod parameters;
mod patterns;
mod place;
mod products;
mod reading;
mod recognise;
mod rolled;
mod sections;
mod set;

pub use arrays::{Arrays, without_c_comments};
pub use constants::Pins;
pub use file::{Fault, ReadBack};
pub use parameters::ParameterLines;
pub use recognise::{IndexFile, RecognisedSet, recognise};

use file::number;
use reading::ReadContext;
