//! The rows of a table and their facts, whatever its format.

use super::work::WorkRows;
use crate::analysis::{View, tool_pose};
use crate::evaluate::{Frame, Order, Poses, frame_rotation};
use crate::machine::{Approach, Machine};
use std::io::{self, Seek, Write};

/// Subject of a table.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The poses.
    pub poses: &'a Poses,
    /// View in which the deviations were computed.
    pub view: View,
    /// Order of the errors.
    pub order: Order,
    /// The target after whose compensation; empty without.
    pub target: &'a str,
    /// The rows of a file of tool poses behind the poses.
    pub work: Option<&'a WorkRows>,
}

/// Format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowFormat {
    /// A header with units, one pose a line.
    Csv,
    /// An object with one object a pose.
    Json,
    /// The columns of the CSV.
    Parquet,
    /// An unstructured grid.
    Vtk,
}

/// Consecutive rows, as far as the forms asked for can be made of them apart from the others.
#[derive(Debug, Clone, Default)]
pub struct RowBlock {
    /// Index of the first.
    pub(super) first: usize,
    /// Positions (mm, deg), then the deviation (um, urad): the numbers of each row.
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) csv: String,
    pub(super) json: String,
    /// Nominal tips, mm.
    pub(super) tips: Vec<[f64; 3]>,
}

/// Destination of the rows of one table, in their order.
pub trait Stream {
    /// The next rows.
    fn put(&mut self, rows: &RowBlock) -> io::Result<()>;

    /// That was all.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// A destination of a table: a file, or a cursor over memory.
pub trait Sink: Write + Seek + Send {}

impl<T: Write + Seek + Send> Sink for T {}

/// Names of the six columns of a deviation.
const DEVIATION: [&str; 6] = ["dx [um]", "dy [um]", "dz [um]", "wx [urad]", "wy [urad]", "wz [urad]"];

impl Rows<'_> {
    /// `X [mm]`, ..., then those of the deviation.
    pub(super) fn columns(&self) -> Vec<String> {
        let axes = self.machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
        axes.chain(DEVIATION.map(str::to_owned)).collect()
    }

    /// Nominal tip from the workpiece origin, mm, in the frame of the vectors.
    pub(super) fn tip(&self, pose: &[f64]) -> [f64; 3] {
        let tip = tool_pose(self.machine, pose).unturned(self.machine).tip;
        match frame_rotation(self.machine, pose, self.view.frame) {
            Some(turn) => (turn * tip).map(|x| x + 0.0).into(),
            None => tip.map(|x| x + 0.0).into(),
        }
    }

    /// Facts for a reader, as names and words.
    pub(super) fn facts(&self) -> [(&'static str, String); 6] {
        let frame = match self.view.frame {
            Frame::Workpiece => "workpiece",
            Frame::Machine => "machine",
            Frame::Tool => "tool",
        };
        let order = match self.order {
            Order::Exact => "exact".to_owned(),
            Order::Degree(n) => n.to_string(),
        };
        let direction = match self.view.approach {
            Approach::Mean => "mean",
            Approach::Forward => "forward",
            Approach::Reverse => "reverse",
        };
        [
            ("machine", self.machine.name().to_owned()),
            ("order", order),
            ("frame", frame.to_owned()),
            ("direction", direction.to_owned()),
            ("target", self.target.to_owned()),
            ("sign", "actual minus nominal, tool relative to workpiece".to_owned()),
        ]
    }
}
