//! The error plane: the deviation over two linear axes as a colour map with arrows, or as a deformed grid;
//! two states side by side.

mod bands;
mod deformed;
mod draw;
mod picture;
mod sides;

pub use picture::{PlanePicture, PlaneQuantity, PlaneStyle};
pub use sides::before_after;
