//! A mapped field pose by pose, for other programs: CSV, JSON, Parquet and VTK.
//!
//! [`Rows`] says what the table is of. Blocks of consecutive poses are [`Prepared`], on any thread, and put into a
//! [`Stream`] one after the other; so a table is never held as a whole, whatever its form. Positions are in mm and
//! deg as programmed, deviations in um and urad, actual minus nominal.

mod csv;
mod json;
#[cfg(feature = "parquet")]
mod parquet;
mod vtk;

use crate::analysis::{View, frame_rotation, tool_pose};
use crate::evaluate::{Deviation, Frame, Order, Poses};
use crate::machine::{Approach, Machine, Pose};
use std::io::{self, Seek, Write};

/// What a table is of.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The poses.
    pub poses: &'a Poses,
    /// How the deviations were computed.
    pub view: View,
    /// To which order.
    pub order: Order,
    /// The target after whose compensation; empty without.
    pub target: &'a str,
}

/// Form of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
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
pub struct Prepared {
    /// Index of the first.
    first: usize,
    /// Positions (mm, deg), then the deviation (um, urad): the numbers of each row.
    rows: Vec<Vec<f64>>,
    csv: String,
    json: String,
    /// Nominal tips, mm.
    tips: Vec<[f64; 3]>,
}

/// Where the rows of one table go, in their order.
pub trait Stream {
    /// The next rows.
    fn put(&mut self, rows: &Prepared) -> io::Result<()>;

    /// That was all.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// A destination of a table: a file, or a cursor over memory.
pub trait Sink: Write + Seek + Send {}

impl<T: Write + Seek + Send> Sink for T {}

/// Names of the six columns of a deviation.
const DEVIATION: [&str; 6] = ["dx [um]", "dy [um]", "dz [um]", "wx [urad]", "wy [urad]", "wz [urad]"];

impl<'a> Rows<'a> {
    /// Prepares rows for some forms: `first` is the index of the first pose, the deviations (mm, rad) are in the
    /// frame of the view.
    pub fn prepared(&self, forms: &[Form], first: usize, rows: impl Iterator<Item = (Pose, Deviation)>) -> Prepared {
        let mut made = Prepared { first, ..Prepared::default() };
        let wants = |form| forms.contains(&form);
        for (pose, deviation) in rows {
            if wants(Form::Vtk) {
                made.tips.push(self.tip(&pose));
            }
            let mut row = pose;
            row.extend(six(&deviation));
            // Adding zero turns -0 into 0.
            row.iter_mut().for_each(|x| *x += 0.0);
            if wants(Form::Csv) {
                csv::line(&row, &mut made.csv);
            }
            if wants(Form::Json) {
                self.json_line(&row, &mut made.json);
            }
            made.rows.push(row);
        }
        made
    }

    /// Begins a table. Parquet fails with `Unsupported` in a build without the feature `parquet`.
    pub fn stream<'o>(&self, form: Form, out: impl Sink + 'o) -> io::Result<Box<dyn Stream + 'o>>
    where
        'a: 'o,
    {
        Ok(match form {
            Form::Csv => Box::new(csv::Csv::new(self, out)?),
            Form::Json => Box::new(json::Json::new(self, out)?),
            #[cfg(feature = "parquet")]
            Form::Parquet => Box::new(parquet::Parquet::new(self, out)?),
            #[cfg(not(feature = "parquet"))]
            Form::Parquet => {
                let refusal = "this build of abbe has no Parquet (feature `parquet`)";
                return Err(io::Error::new(io::ErrorKind::Unsupported, refusal));
            }
            Form::Vtk => Box::new(vtk::Vtk::new(self, out)?),
        })
    }

    /// `X [mm]`, ..., then those of the deviation.
    fn columns(&self) -> Vec<String> {
        let axes = self.machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
        axes.chain(DEVIATION.map(str::to_owned)).collect()
    }

    /// Nominal tip from the workpiece origin, mm, in the frame of the vectors.
    fn tip(&self, pose: &[f64]) -> [f64; 3] {
        let tip = tool_pose(self.machine, pose).tip;
        match frame_rotation(self.machine, pose, self.view.frame) {
            Some(turn) => (turn * tip).map(|x| x + 0.0).into(),
            None => tip.map(|x| x + 0.0).into(),
        }
    }

    /// What a reader has to know, as names and words.
    fn facts(&self) -> [(&'static str, String); 6] {
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

/// um and urad.
fn six(deviation: &Deviation) -> [f64; 6] {
    let (p, r) = (deviation.position * 1e3, deviation.rotation * 1e6);
    [p.x, p.y, p.z, r.x, r.y, r.z]
}
