//! Parquet: the columns of the CSV as doubles, the facts as the file's metadata.

use super::Rows;
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::sync::Arc;

/// Rows of a row group: what a reader holds at once.
const GROUP: usize = 1 << 16;

impl Rows<'_> {
    /// Writes Parquet, uncompressed.
    pub fn parquet(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        self.write_parquet(out).map_err(|failure| match failure {
            ParquetError::External(inner) => io::Error::other(inner),
            other => io::Error::other(other),
        })
    }

    fn write_parquet(&self, out: &mut (dyn Write + Send)) -> Result<(), ParquetError> {
        let facts = self.facts().into_iter().map(|(name, word)| KeyValue::new(name.to_owned(), word));
        let properties = WriterProperties::builder()
            .set_created_by(format!("abbe {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(facts.collect()))
            .build();
        let mut writer = SerializedFileWriter::new(out, Arc::new(self.schema()?), Arc::new(properties))?;
        let count = self.deviations.len();
        for start in (0..count).step_by(GROUP) {
            let rows: Vec<Vec<f64>> = (start..count.min(start + GROUP)).map(|index| self.row(index)).collect();
            let mut group = writer.next_row_group()?;
            columns(&mut group, &rows)?;
            let _ = group.close()?;
        }
        let _ = writer.close()?;
        Ok(())
    }

    fn schema(&self) -> Result<Type, ParquetError> {
        let column = |name: String| {
            let kind = Type::primitive_type_builder(&name, Physical::DOUBLE);
            kind.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
        };
        let fields = self.columns().into_iter().map(column).collect::<Result<Vec<_>, _>>()?;
        Type::group_type_builder("map").with_fields(fields).build()
    }
}

fn columns<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    rows: &[Vec<f64>],
) -> Result<(), ParquetError> {
    let mut k = 0;
    while let Some(mut column) = group.next_column()? {
        let values: Vec<f64> = rows.iter().map(|row| row[k]).collect();
        let _ = column.typed::<DoubleType>().write_batch(&values, None, None)?;
        column.close()?;
        k += 1;
    }
    Ok(())
}
