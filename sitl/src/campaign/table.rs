//! `flights.parquet`: a row a flight, in the order of the flights. What is missing is null.

use super::row::{Cell, Column, Header, Kind, Row};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Writes the table.
///
/// # Errors
/// One line naming the file.
pub fn write_parquet(path: &Path, header: &Header, rows: &[Row]) -> Result<(), String> {
    let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut sorted: Vec<_> = rows.iter().collect();
    sorted.sort_by_key(|row| row.index);
    write(file, header, &sorted).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(file: File, header: &Header, rows: &[&Row]) -> Result<(), ParquetError> {
    let properties = WriterProperties::builder().set_created_by(String::from("tautline")).build();
    let mut file = SerializedFileWriter::new(file, schema(header)?, Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    let every = |of: fn(&Row) -> Cell| rows.iter().map(|row| Some(of(row))).collect::<Vec<_>>();
    for of in [|row: &Row| row.index, |row: &Row| row.seed] {
        let values: Vec<_> = rows.iter().map(|row| Some(of(row) as i64)).collect();
        column::<Int64Type, _>(&mut group, &values, true)?;
    }
    for (i, of) in header.varied.iter().enumerate() {
        let cells: Vec<_> = rows.iter().map(|row| row.varied.get(i).cloned().flatten()).collect();
        cell_column(&mut group, of.kind, &cells, false)?;
    }
    cell_column(&mut group, Kind::Flag, &every(|row| Cell::Flag(row.complete)), true)?;
    cell_column(&mut group, Kind::Flag, &every(|row| Cell::Flag(row.pass)), true)?;
    cell_column(&mut group, Kind::Text, &every(|row| Cell::Text(row.reason.clone())), true)?;
    for (i, of) in header.figures.iter().enumerate() {
        let cells: Vec<_> = rows.iter().map(|row| row.figures.get(i).cloned().flatten()).collect();
        cell_column(&mut group, of.kind, &cells, false)?;
    }
    group.close()?;
    file.close().map(drop)
}

fn schema(header: &Header) -> Result<TypePtr, ParquetError> {
    let field = |name: &str, physical, repetition| {
        let text = (physical == Physical::BYTE_ARRAY).then_some(LogicalType::String);
        let built = Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_logical_type(text)
            .build();
        built.map(Arc::new)
    };
    let of_cells = |column: &Column| {
        let physical = match column.kind {
            Kind::Flag => Physical::BOOLEAN,
            Kind::Number => Physical::DOUBLE,
            Kind::Text => Physical::BYTE_ARRAY,
        };
        field(&column.name, physical, Repetition::OPTIONAL)
    };
    let mut fields = Vec::new();
    for name in ["index", "seed"] {
        fields.push(field(name, Physical::INT64, Repetition::REQUIRED)?);
    }
    for column in &header.varied {
        fields.push(of_cells(column)?);
    }
    for name in ["complete", "pass"] {
        fields.push(field(name, Physical::BOOLEAN, Repetition::REQUIRED)?);
    }
    fields.push(field("reason", Physical::BYTE_ARRAY, Repetition::REQUIRED)?);
    for column in &header.figures {
        fields.push(of_cells(column)?);
    }
    Ok(Arc::new(Type::group_type_builder("flight").with_fields(fields).build()?))
}

fn cell_column(
    group: &mut SerializedRowGroupWriter<'_, File>,
    kind: Kind,
    cells: &[Option<Cell>],
    is_required: bool,
) -> Result<(), ParquetError> {
    fn each<T>(cells: &[Option<Cell>], pick: impl Fn(&Cell) -> Option<T>) -> Vec<Option<T>> {
        cells.iter().map(|cell| cell.as_ref().and_then(&pick)).collect()
    }
    match kind {
        Kind::Flag => {
            let flags = each(cells, |cell| if let Cell::Flag(x) = cell { Some(*x) } else { None });
            column::<BoolType, _>(group, &flags, is_required)
        }
        Kind::Number => {
            let numbers =
                each(cells, |cell| if let Cell::Number(x) = cell { Some(*x) } else { None });
            column::<DoubleType, _>(group, &numbers, is_required)
        }
        Kind::Text => {
            let texts = each(cells, |cell| {
                if let Cell::Text(x) = cell { Some(ByteArray::from(x.as_str())) } else { None }
            });
            column::<ByteArrayType, _>(group, &texts, is_required)
        }
    }
}

/// The next column of a group.
pub(crate) fn column<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[Option<T::T>],
    is_required: bool,
) -> Result<(), ParquetError> {
    let there: Vec<_> = values.iter().flatten().cloned().collect();
    let levels: Vec<_> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let Some(mut writer) = group.next_column()? else {
        return Err(ParquetError::General("more columns than the schema has".into()));
    };
    let levels = (!is_required).then_some(levels.as_slice());
    writer.typed::<T>().write_batch(&there, levels, None)?;
    writer.close()
}
