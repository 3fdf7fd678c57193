//! Parquet: the columns of the CSV as doubles, uncompressed, the facts as the file's metadata.

use super::table::{RowBlock, Rows, Stream};
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::sync::Arc;

/// Rows of a row group: the number that writer and reader hold at once. Groups are the same for any blocks of rows.
const GROUP: usize = 1 << 16;

pub(super) struct Parquet<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    /// Rows that do not make a group yet, by columns.
    waiting: Vec<Vec<f64>>,
}

impl<W: Write + Send> Parquet<W> {
    pub(super) fn new(rows: &Rows<'_>, out: W) -> io::Result<Self> {
        let facts = rows.facts().into_iter().map(|(name, word)| KeyValue::new(name.to_owned(), word));
        let properties = WriterProperties::builder()
            .set_created_by(format!("abbe {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(facts.collect()))
            .build();
        let columns = rows.columns();
        let waiting = vec![Vec::new(); columns.len()];
        let schema = schema(columns).map_err(to_io)?;
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties)).map_err(to_io)?;
        Ok(Self { writer, waiting })
    }

    fn group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        let mut columns = self.waiting.iter_mut();
        while let (Some(mut column), Some(values)) = (group.next_column()?, columns.next()) {
            let _ = column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
            values.clear();
        }
        let _ = group.close()?;
        Ok(())
    }

    fn waiting(&self) -> usize {
        self.waiting.first().map_or(0, Vec::len)
    }
}

impl<W: Write + Send> Stream for Parquet<W> {
    fn put(&mut self, rows: &RowBlock) -> io::Result<()> {
        for row in &rows.rows {
            self.waiting.iter_mut().zip(row).for_each(|(column, x)| column.push(*x));
            if self.waiting() == GROUP {
                self.group().map_err(to_io)?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if self.waiting() > 0 {
            self.group().map_err(to_io)?;
        }
        let _ = self.writer.close().map_err(to_io)?;
        Ok(())
    }
}

fn schema(columns: Vec<String>) -> Result<Type, ParquetError> {
    let column = |name: String| {
        let kind = Type::primitive_type_builder(&name, Physical::DOUBLE);
        kind.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.into_iter().map(column).collect::<Result<Vec<_>, _>>()?;
    Type::group_type_builder("map").with_fields(fields).build()
}

fn to_io(failure: ParquetError) -> io::Error {
    match failure {
        ParquetError::External(inner) => io::Error::other(inner),
        other => io::Error::other(other),
    }
}
