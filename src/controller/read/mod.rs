//! Files of a target read back into tables. Whatever the controller would accept in silence or misread (comments, blank
//! lines, commas, unsorted lines, NaN, too many points) is refused here with its place.
//!
//! A manifest describes the layout of a file: lines of known patterns ([`lines`]), columns, or one of the formats that
//! have a reader of their own ([`named`], [`lattice`]). The content becomes tables in [`assemble`]. Files without a
//! known name are distinguished by their content ([`recognise()`]), their axes in [`place`].

mod arrays;
mod assemble;
mod columns;
mod constants;
mod coverage;
mod file;
mod lattice;
mod layout;
mod lines;
mod named;
mod parameters;
mod place;
mod products;
mod reading;
mod recognise;
mod rolled;
mod set;

pub use arrays::Arrays;
pub use constants::Pins;
pub use file::{Fault, ReadBack};
pub use parameters::ParameterLines;
pub use recognise::{RecognisedSet, recognise};

use file::number;
use reading::ReadContext;
