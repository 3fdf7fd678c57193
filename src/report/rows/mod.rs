//! A mapped field pose by pose, for other programs: CSV, JSON, Parquet and VTK.
//!
//! Each is written to a stream as it is made, so that no second copy of the map is held. Positions are in mm
//! and deg as programmed, deviations in um and urad, actual minus nominal.

mod csv;
mod json;
mod parquet;
mod vtk;

pub use csv::{csv_header, csv_line};

use crate::analysis::View;
use crate::evaluate::{Deviation, Frame, Order, Poses};
use crate::machine::{Approach, Machine};

/// What is written.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The poses.
    pub poses: &'a Poses,
    /// The deviation at each (mm, rad), in the frame of the view.
    pub deviations: &'a [Deviation],
    /// How they were computed.
    pub view: View,
    /// To which order.
    pub order: Order,
    /// The target after whose compensation; empty without.
    pub target: &'a str,
}

/// Names of the six columns of a deviation.
const DEVIATION: [&str; 6] = ["dx [um]", "dy [um]", "dz [um]", "wx [urad]", "wy [urad]", "wz [urad]"];

/// `X [mm]`, ..., then those of the deviation.
fn columns(machine: &Machine) -> Vec<String> {
    let axes = machine.axes().iter().map(|axis| format!("{} [{}]", axis.name, axis.unit()));
    axes.chain(DEVIATION.map(str::to_owned)).collect()
}

impl Rows<'_> {
    fn columns(&self) -> Vec<String> {
        columns(self.machine)
    }

    /// The numbers of a row, in the order of the columns.
    fn row(&self, index: usize) -> Vec<f64> {
        let mut row = self.poses.get(index);
        row.extend(six(&self.deviations[index]));
        // Adding zero turns -0 into 0.
        row.iter_mut().for_each(|x| *x += 0.0);
        row
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
