//! Rows to the streams of their formats.

use super::table::{ControllerTarget, Form, Prepared, Rows, Stream};
use super::{csv, json, parquet, vtk};
use crate::evaluate::Deviation;
use crate::machine::Pose;
use std::io;

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

    /// Begins a table.
    pub fn stream<'o>(&self, form: Form, out: impl ControllerTarget + 'o) -> io::Result<Box<dyn Stream + 'o>>
    where
        'a: 'o,
    {
        Ok(match form {
            Form::Csv => Box::new(csv::Csv::new(self, out)?),
            Form::Json => Box::new(json::Json::new(self, out)?),
            Form::Parquet => Box::new(parquet::Parquet::new(self, out)?),
            Form::Vtk => Box::new(vtk::Vtk::new(self, out)?),
        })
    }
}

/// um and urad.
fn six(deviation: &Deviation) -> [f64; 6] {
    let (p, r) = (deviation.position * 1e3, deviation.rotation * 1e6);
    [p.x, p.y, p.z, r.x, r.y, r.z]
}
