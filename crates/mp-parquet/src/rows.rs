//! Rows that are gathered, and written together.

use crate::Sink;
use crate::columns::{COLUMNS, Cell, Kind};
use mp_plan::ItemResult;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};

/// The values of a column.
#[derive(Debug)]
enum Values {
    Int(Vec<i64>),
    Double(Vec<f64>),
    Text(Vec<ByteArray>),
    Bool(Vec<bool>),
}

/// A column of some rows: its values that are not null, how much of each value is there, and at which depth of lists each repeats the one
/// before. Numbers that are required have no levels.
#[derive(Debug)]
struct ColumnValues {
    values: Values,
    definition: Vec<i16>,
    repetition: Vec<i16>,
}

/// Rows that are written together.
#[derive(Debug)]
pub(crate) struct RowGroup {
    columns: Vec<ColumnValues>,
    rows: usize,
    numbers: usize,
}

impl RowGroup {
    pub(crate) fn new() -> Self {
        let values = |kind| match kind {
            Kind::Number | Kind::Count => Values::Int(Vec::new()),
            Kind::Double | Kind::Rows => Values::Double(Vec::new()),
            Kind::Text | Kind::Texts => Values::Text(Vec::new()),
            Kind::Bool => Values::Bool(Vec::new()),
        };
        let column =
            |kind| ColumnValues { values: values(kind), definition: Vec::new(), repetition: Vec::new() };
        Self { columns: COLUMNS.iter().map(|c| column(c.kind)).collect(), rows: 0, numbers: 0 }
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// How many numbers of paths there are.
    pub(crate) fn numbers(&self) -> usize {
        self.numbers
    }

    /// Adds a row.
    pub(crate) fn push(&mut self, item: &ItemResult) {
        self.rows += 1;
        for (column, to) in COLUMNS.iter().zip(&mut self.columns) {
            let cell = (column.cell)(item);
            if let Cell::Rows(Some(rows)) = &cell {
                self.numbers += rows.iter().map(Vec::len).sum::<usize>();
            }
            to.push(cell);
        }
    }

    /// Writes the rows.
    pub(crate) fn write(self, writer: &mut SerializedFileWriter<Sink>) -> Result<()> {
        let mut group = writer.next_row_group()?;
        for (column, values) in COLUMNS.iter().zip(self.columns) {
            let missing = || ParquetError::General(format!("there is no column {}", column.name));
            let mut writer = group.next_column()?.ok_or_else(missing)?;
            values.write(column.kind, &mut writer)?;
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }
}

impl ColumnValues {
    fn push(&mut self, cell: Cell<'_>) {
        let Self { values, definition, repetition } = self;
        match (cell, values) {
            (Cell::Count(value), Values::Int(values)) => {
                definition.push(value.is_some().into());
                // As bits: the type of the column says that there is no sign.
                values.extend(value.map(u64::cast_signed));
            }
            (Cell::Double(value), Values::Double(values)) => {
                definition.push(value.is_some().into());
                values.extend(value);
            }
            (Cell::Bool(value), Values::Bool(values)) => {
                definition.push(value.is_some().into());
                values.extend(value);
            }
            (Cell::Text(value), Values::Text(values)) => {
                definition.push(value.is_some().into());
                values.extend(value.map(bytes));
            }
            (Cell::Texts(value), Values::Text(values)) => {
                let mut level = |at, repeats| {
                    definition.push(at);
                    repetition.push(repeats);
                };
                match &value {
                    None => level(0, 0),
                    Some(texts) if texts.is_empty() => level(1, 0),
                    Some(texts) => (0..texts.len()).for_each(|i| level(2, i16::from(i > 0))),
                }
                values.extend(value.into_iter().flatten().map(bytes));
            }
            (Cell::Rows(value), Values::Double(values)) => {
                let mut level = |at, repeats| {
                    definition.push(at);
                    repetition.push(repeats);
                };
                match value {
                    None => level(0, 0),
                    Some([]) => level(1, 0),
                    Some(rows) => {
                        for (i, row) in rows.iter().enumerate() {
                            let new = i16::from(i > 0);
                            match row.len() {
                                0 => level(2, new),
                                numbers => (0..numbers).for_each(|j| level(3, if j == 0 { new } else { 2 })),
                            }
                        }
                    }
                }
                values.extend(value.into_iter().flatten().flatten());
            }
            // Each kind of cell has its kind of column.
            _ => {}
        }
    }

    fn write(self, kind: Kind, writer: &mut SerializedColumnWriter<'_>) -> Result<()> {
        let definition = (kind != Kind::Number).then_some(self.definition.as_slice());
        let repetition = matches!(kind, Kind::Texts | Kind::Rows).then_some(self.repetition.as_slice());
        match &self.values {
            Values::Int(values) => writer.typed::<Int64Type>().write_batch(values, definition, repetition),
            Values::Double(values) => {
                writer.typed::<DoubleType>().write_batch(values, definition, repetition)
            }
            Values::Text(values) => {
                writer.typed::<ByteArrayType>().write_batch(values, definition, repetition)
            }
            Values::Bool(values) => writer.typed::<BoolType>().write_batch(values, definition, repetition),
        }
        .map(|_| ())
    }
}

fn bytes(text: String) -> ByteArray {
    ByteArray::from(text.into_bytes())
}
