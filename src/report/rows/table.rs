//! The rows of a table and their facts, whatever its format.

use super::work::WorkRows;
use crate::analysis::budget::BoundedDeviation;
use crate::analysis::{View, tool_pose};
use crate::evaluate::{Deviation, Frame, Order, Poses, frame_rotation};
use crate::machine::{Approach, Machine};
use crate::report::text::DrawSettings;
use nalgebra::Vector3;
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
    /// The machines drawn, for a table of what bounds lead to; `None` for one of deviations.
    pub drawn: Option<&'a DrawSettings>,
}

/// The numbers of a row after its positions, in um and urad.
pub trait RowValues {
    /// Appends them in the order of the columns.
    fn append(&self, row: &mut Vec<f64>);
}

impl RowValues for Deviation {
    fn append(&self, row: &mut Vec<f64>) {
        let (p, r) = (self.position * 1e3, self.rotation * 1e6);
        row.extend([p.x, p.y, p.z, r.x, r.y, r.z]);
    }
}

impl RowValues for BoundedDeviation {
    fn append(&self, row: &mut Vec<f64>) {
        let (p, r) = (self.position, self.rotation);
        row.extend([p.rss * 1e3, p.p95 * 1e3, r.rss * 1e6, r.p95 * 1e6]);
    }
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
    /// The columns of the CSV as a structured array of NumPy (`.npy`).
    Npy,
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

impl RowBlock {
    /// Returns the index of the first row with a number that is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let row = self.rows.iter().position(|row| !finite(row));
        row.or_else(|| self.tips.iter().position(|tip| !finite(tip))).map(|row| self.first + row)
    }
}

/// Destination of the rows of one table, in their order.
pub trait Stream {
    /// The next rows.
    fn put(&mut self, rows: &RowBlock) -> io::Result<()>;

    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// A destination of a table: a file, or a cursor over memory.
pub trait Sink: Write + Seek + Send {}

impl<T: Write + Seek + Send> Sink for T {}

/// Names of the six columns of a deviation.
const DEVIATION: [&str; 6] = ["dx [um]", "dy [um]", "dz [um]", "wx [urad]", "wy [urad]", "wz [urad]"];

/// Name of the column of the deviation along the normal of the surface.
const ALONG_NORMAL: &str = "dn [um]";

/// Names of the four columns of what bounds lead to.
const BOUNDED: [&str; 4] = ["position_rss [um]", "position_p95 [um]", "rotation_rss [urad]", "rotation_p95 [urad]"];

impl Rows<'_> {
    /// `X [mm]`, ..., then those of the deviation, at the end along the normal where the tool poses have one, or of
    /// what bounds lead to.
    pub(super) fn columns(&self) -> Vec<String> {
        let axes = self.machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
        let values = if self.drawn.is_some() { &BOUNDED[..] } else { &DEVIATION };
        let along = self.normals().map(|_| ALONG_NORMAL);
        axes.chain(values.iter().copied().chain(along).map(str::to_owned)).collect()
    }

    /// Returns the normals of the surface, unturned workpiece frame, of a table of deviations.
    fn normals(&self) -> Option<&[Vector3<f64>]> {
        self.work.filter(|_| self.drawn.is_none()).and_then(|work| work.normals.as_deref())
    }

    /// Returns the deviation along the normal at the pose with an index, by a row of positions and deviation (um).
    pub(super) fn along_normal(&self, index: usize, row: &[f64]) -> Option<f64> {
        let (pose, values) = row.split_at(self.machine.axes().len());
        let normal = self.normals()?.get(index)?;
        let turned = frame_rotation(self.machine, pose, self.view.frame).map_or(*normal, |turn| turn * normal);
        Some(turned.iter().zip(values).map(|(n, d)| n * d).sum())
    }

    /// Nominal tip from the workpiece origin, mm, in the frame of the vectors.
    pub(super) fn tip(&self, pose: &[f64]) -> [f64; 3] {
        let tip = tool_pose(self.machine, pose).to_unturned(self.machine).tip;
        match frame_rotation(self.machine, pose, self.view.frame) {
            Some(turn) => (turn * tip).map(|x| x + 0.0).into(),
            None => tip.map(|x| x + 0.0).into(),
        }
    }

    /// Facts for a reader, as names and words.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let frame = match self.view.frame {
            Frame::Workpiece => "workpiece",
            Frame::Machine => "machine",
            Frame::Tool => "tool",
        };
        let order = match self.order {
            Order::Exact => "exact".to_owned(),
            Order::Degree(n) => n.to_string(),
        };
        let direction = match self.view.conditions.approach {
            Approach::Mean => "mean",
            Approach::Forward => "forward",
            Approach::Reverse => "reverse",
        };
        let mut facts = vec![
            ("machine", self.machine.name().to_owned()),
            ("order", order),
            ("frame", frame.to_owned()),
            ("direction", direction.to_owned()),
            ("target", self.target.to_owned()),
            ("sign", "actual minus nominal, tool relative to workpiece".to_owned()),
        ];
        if let Some(drawn) = self.drawn {
            facts.extend([
                ("from", "bounds".to_owned()),
                ("samples", drawn.samples.to_string()),
                ("seed", drawn.seed.to_string()),
                ("distribution", drawn.distribution.name().to_owned()),
                ("class", drawn.class.clone().unwrap_or_default()),
            ]);
        }
        facts
    }
}
