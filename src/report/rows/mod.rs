//! A mapped field pose by pose, for other programs: CSV, JSON, Parquet, NumPy and VTK.
//!
//! [`Rows`] holds the machine, poses and view of the table. Blocks of consecutive poses are [`RowBlock`], on any
//! thread, and put into a [`Stream`] one after the other; so a table is never held as a whole, whatever its form.
//! Positions are in mm and deg as programmed, deviations in um and urad, actual minus nominal.

mod csv;
mod json;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;
mod stream;
mod structured;
mod table;
mod vtk;
mod work;

pub use structured::structured_grid;
pub use table::{RowBlock, RowFormat, RowValues, Rows, Sink, Stream};
pub use work::{UnreachedRow, WorkRow, WorkRows, cell};
