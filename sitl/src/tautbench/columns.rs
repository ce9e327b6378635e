//! Tables of numbers with named columns, as Parquet or CSV. Their first column is `time_s`; what is missing is null, or an
//! empty cell.

use crate::campaign::column;
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::Type;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

/// Of every table.
pub const TIME: &str = "time_s";

/// Rows of as many cells as there are names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Of the columns, with their units.
    pub names: Vec<String>,
    /// In the order of their times.
    pub rows: Vec<Vec<Option<f64>>>,
}

impl Table {
    /// Without rows.
    #[must_use]
    pub fn new<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        Self { names: names.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// By its end: `.csv` or `.parquet`.
    ///
    /// # Errors
    /// One line naming the file and, where it can be told, line and column.
    pub fn read(path: &Path) -> Result<Self, String> {
        let read = match path.extension().and_then(|end| end.to_str()) {
            Some("csv") => {
                fs::read_to_string(path).map_err(|e| e.to_string()).and_then(|text| from_csv(&text))
            }
            Some("parquet") => from_parquet(path),
            _ => Err("neither .csv nor .parquet".into()),
        };
        read.map_err(|e| format!("{}: {e}", path.display()))
    }

    /// As a Parquet file: time in double, everything else in single precision. `repeats`: values come again and again, as
    /// those of sensors with steps do; then they are kept once.
    ///
    /// # Errors
    /// Parquet's own.
    pub fn to_parquet(&self, repeats: bool) -> Result<Vec<u8>, ParquetError> {
        let properties = WriterProperties::builder()
            .set_created_by("tautline".into())
            .set_statistics_enabled(EnabledStatistics::None)
            .set_dictionary_enabled(repeats)
            .set_column_dictionary_enabled(TIME.into(), false);
        let mut bytes = Vec::new();
        let mut file =
            SerializedFileWriter::new(&mut bytes, self.schema()?, Arc::new(properties.build()))?;
        let mut group = file.next_row_group()?;
        for (at, name) in self.names.iter().enumerate() {
            let cells = self.rows.iter().map(|row| row.get(at).copied().flatten());
            if name == TIME {
                column::<DoubleType, _>(&mut group, &cells.collect::<Vec<_>>(), true)?;
            } else {
                let single: Vec<_> = cells.map(|cell| cell.map(|x| x as f32)).collect();
                column::<FloatType, _>(&mut group, &single, false)?;
            }
        }
        group.close()?;
        file.close()?;
        Ok(bytes)
    }

    fn schema(&self) -> Result<Arc<Type>, ParquetError> {
        let field = |name: &String| {
            let (physical, repetition) = match name == TIME {
                true => (Physical::DOUBLE, Repetition::REQUIRED),
                false => (Physical::FLOAT, Repetition::OPTIONAL),
            };
            let built = Type::primitive_type_builder(name, physical).with_repetition(repetition);
            built.build().map(Arc::new)
        };
        let fields = self.names.iter().map(field).collect::<Result<_, _>>()?;
        Ok(Arc::new(Type::group_type_builder("row").with_fields(fields).build()?))
    }

    /// As text, every number to its last bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = self.names.join(",");
        for row in &self.rows {
            let cells: Vec<_> =
                row.iter().map(|cell| cell.map(|x| x.to_string()).unwrap_or_default()).collect();
            text.push('\n');
            text.push_str(&cells.join(","));
        }
        text.push('\n');
        text
    }

    /// The column of this name.
    #[must_use]
    pub fn at(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| own == name)
    }
}

fn from_csv(text: &str) -> Result<Table, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let names: Vec<String> =
        reader.headers().map_err(|e| e.to_string())?.iter().map(str::to_owned).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string().replace('\n', " "))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |(text, name): (&str, &String)| match text {
            "" => Ok(None),
            _ => match text.parse() {
                Ok(x) => Ok(Some(x)),
                Err(_) => Err(format!("line {line}: {name}: {text} is not a number")),
            },
        };
        rows.push(record.iter().zip(&names).map(cell).collect::<Result<_, _>>()?);
    }
    Ok(Table { names, rows })
}

fn from_parquet(path: &Path) -> Result<Table, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let file = SerializedFileReader::new(file).map_err(|e| e.to_string())?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let names: Vec<_> = schema.columns().iter().map(|column| column.name().to_owned()).collect();
    let mut rows = Vec::new();
    for row in file.get_row_iter(None).map_err(|e| e.to_string())? {
        let row = row.map_err(|e| e.to_string())?;
        let cell = |(name, field): (&String, &Field)| match field {
            Field::Null => Ok(None),
            Field::Float(x) => Ok(Some(f64::from(*x))),
            Field::Double(x) => Ok(Some(*x)),
            Field::Int(x) => Ok(Some(f64::from(*x))),
            Field::Long(x) => Ok(Some(*x as f64)),
            _ => Err(format!("{name} holds no numbers")),
        };
        rows.push(row.get_column_iter().map(cell).collect::<Result<_, _>>()?);
    }
    Ok(Table { names, rows })
}
