//! Rows to the streams of their formats.

#[cfg(feature = "parquet")]
use super::parquet;
use super::table::{RowBlock, RowFormat, RowValues, Rows, Sink, Stream};
use super::{csv, json, npy, vtk};
use crate::machine::Pose;
use std::io;

impl<'a> Rows<'a> {
    /// Prepares rows for some forms: `first` is the index of the first pose, deviations (mm, rad) are in the frame of
    /// the view.
    pub fn prepare(
        &self,
        forms: &[RowFormat],
        first: usize,
        rows: impl Iterator<Item = (Pose, impl RowValues)>,
    ) -> RowBlock {
        let mut made = RowBlock { first, ..RowBlock::default() };
        let wants = |form| forms.contains(&form);
        let mut index = first;
        for (pose, values) in rows {
            if wants(RowFormat::Vtk) {
                made.tips.push(self.tip(&pose));
            }
            let mut row = pose;
            values.append(&mut row);
            row.extend(self.along_normal(index, &row));
            // Adding zero turns -0 into 0.
            row.iter_mut().for_each(|x| *x += 0.0);
            if wants(RowFormat::Csv) {
                csv::line(self, index, &row, &mut made.csv);
            }
            if wants(RowFormat::Json) {
                self.json_line(index, &row, &mut made.json);
            }
            made.rows.push(row);
            index += 1;
        }
        if index == self.poses.len() {
            if wants(RowFormat::Csv) {
                csv::write_unreached(self, index, &mut made.csv);
            }
            if wants(RowFormat::Json) {
                self.json_unreached(index, &mut made.json);
            }
        }
        made
    }

    /// Begins a table. Parquet fails with `Unsupported` in a build without the feature `parquet`.
    pub fn stream<'o>(&self, form: RowFormat, out: impl Sink + 'o) -> io::Result<Box<dyn Stream + 'o>>
    where
        'a: 'o,
    {
        Ok(match form {
            RowFormat::Csv => Box::new(csv::Csv::new(self, out)?),
            RowFormat::Json => Box::new(json::Json::new(self, out)?),
            #[cfg(feature = "parquet")]
            RowFormat::Parquet => Box::new(parquet::Parquet::new(self, out)?),
            #[cfg(not(feature = "parquet"))]
            RowFormat::Parquet => {
                let refusal = "this build of abbe has no Parquet (feature `parquet`)";
                return Err(io::Error::new(io::ErrorKind::Unsupported, refusal));
            }
            RowFormat::Npy => Box::new(npy::Npy::new(self, out)?),
            RowFormat::Vtk => Box::new(vtk::Vtk::new(self, out)?),
        })
    }
}
