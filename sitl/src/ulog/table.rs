//! A whole topic at once: its samples one behind the other, for whoever works by columns.

use super::{Log, Message, Scalar};
use std::collections::BTreeMap;

/// Where a number stands in each row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// As `x`, `control[2]` or `pose.x`.
    pub path: String,
    /// Bytes from the row's beginning.
    pub offset: usize,
    /// Its type, little-endian.
    pub scalar: Scalar,
}

/// All samples of one topic.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// In the order of the bytes.
    pub columns: Vec<Column>,
    /// Bytes of a row.
    pub width: usize,
    /// Rows as they stand in the log.
    pub rows: Vec<u8>,
}

/// All topics that have samples, by name; of several of one name, the second and so on with `.1` behind it.
pub fn tables(log: &mut Log) -> BTreeMap<String, Table> {
    let mut tables: BTreeMap<(String, u8), Table> = BTreeMap::new();
    for message in log {
        let Message::Data(data) = message else { continue };
        let key = (data.topic.to_owned(), data.instance);
        let table = tables.entry(key).or_insert_with(|| {
            let column = |(path, offset, scalar)| Column { path, offset, scalar };
            let columns = data.layout.numbers().into_iter().map(column).collect();
            Table { columns, width: data.layout.size, rows: Vec::new() }
        });
        // Whoever declares a topic twice, otherwise, has the first count.
        if table.width != data.layout.size {
            continue;
        }
        table.rows.extend_from_slice(data.bytes);
        // A logger may leave padding out.
        table.rows.resize(table.rows.len().next_multiple_of(table.width.max(1)), 0);
    }
    let named = |((topic, instance), table)| match instance {
        0 => (topic, table),
        _ => (format!("{topic}.{instance}"), table),
    };
    tables.into_iter().map(named).collect()
}
