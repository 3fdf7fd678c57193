//! Quantities with units: parse and print `12 um`, `5 arcsec`, `3 um/m`, `0.02/500`.
//!
//! Inside the crate a length is in millimetres and an angle in radians; a quantity is a
//! number in those units together with its [`Dimension`]. The one exception, on purpose:
//! positions of rotary axes stay in degrees, the unit they are programmed in, so that
//! 90 and 360 are exact.

mod fold;
mod interval;
mod parse;
mod print;
mod quantity;

pub use fold::{fold, fold_beside};
pub use interval::Interval;
pub use parse::{Failure, header, number, quantity, unit};
pub use print::{angle, by_uncertainty, counted, ends, length, significant, with_interval, with_sigma, within};
pub use quantity::{Dimension, FARTHEST, Quantity};
