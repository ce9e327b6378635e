//! Which flights the data set is made of: `sitl/tautbench/grid.toml`.

use crate::scenario::{Scenario, toml_error};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::{Table, Value};

const FILE: &str = "sitl/tautbench/grid.toml";
const TEXT: &str = include_str!("../../tautbench/grid.toml");
/// Short flights that the repository holds: not of the table.
pub const SAMPLE: &str = "sample";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    seeds: u64,
    base: BTreeMap<String, Table>,
    cell: Vec<WrittenCell>,
    left_out: Vec<WrittenLeftOut>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenCell {
    name: String,
    group: String,
    base: String,
    winds: Vec<f64>,
    #[serde(default)]
    with: Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenLeftOut {
    name: String,
    base: String,
    #[serde(default)]
    with: Table,
    refused: String,
}

/// One scenario, flown once for each seed.
#[derive(Clone, Debug)]
pub struct Cell {
    /// As in files and tables.
    pub name: String,
    /// What it belongs to: wind, line, sensor, fault, taut or [`SAMPLE`].
    pub group: String,
    /// With every key.
    pub scenario: Scenario,
}

/// What the grid leaves out, since it can't be flown.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// Line, length and vehicle.
    pub name: String,
    /// What would be flown.
    pub scenario: Scenario,
    /// What the firmware's refusal says.
    pub refused: String,
}

/// All of it.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Flights of a cell: their seeds begin with 1.
    pub seeds: u64,
    /// In the order of the file.
    pub cells: Vec<Cell>,
    /// In the order of the file.
    pub left_out: Vec<LeftOut>,
}

impl Grid {
    /// The one that is shipped.
    ///
    /// # Errors
    /// One line naming file and cell; never for the file as it is committed.
    pub fn shipped() -> Result<Self, String> {
        let written: Written = toml::from_str(TEXT).map_err(|e| toml_error(FILE, TEXT, &e))?;
        let on = |name: &str, base: &str, with: &Table| -> Result<Table, String> {
            let base = written.base.get(base);
            let mut table = base.cloned().ok_or_else(|| format!("{FILE}: {name}: no such base"))?;
            lay_over(&mut table, with);
            Ok(table)
        };
        let checked = |name: &str, table: Table| {
            Scenario::from_table(table).map_err(|e| format!("{FILE}: {name}: {e}"))
        };
        let mut cells = Vec::new();
        for cell in &written.cell {
            for wind in &cell.winds {
                let mut table = on(&cell.name, &cell.base, &cell.with)?;
                let air = BTreeMap::from([
                    ("speed", Value::Float(*wind)),
                    ("gusts", Value::Boolean(*wind > 0.0)),
                ]);
                table.insert("wind".into(), Table::from_iter(air.into_iter().map(owned)).into());
                let name = match *wind > 0.0 {
                    true => format!("{}-{wind}mps", cell.name),
                    false => format!("{}-calm", cell.name),
                };
                let scenario = checked(&name, table)?;
                cells.push(Cell { name, group: cell.group.clone(), scenario });
            }
        }
        let left_out = written.left_out.iter().map(|one| {
            let scenario = checked(&one.name, on(&one.name, &one.base, &one.with)?)?;
            Ok(LeftOut { name: one.name.clone(), scenario, refused: one.refused.clone() })
        });
        let left_out = left_out.collect::<Result<_, String>>()?;
        Ok(Self { seeds: written.seeds, cells, left_out })
    }

    /// The cells of these names or groups; none: all but the sample.
    ///
    /// # Errors
    /// One line naming what is neither.
    pub fn chosen(&self, names: &[String]) -> Result<Vec<&Cell>, String> {
        if names.is_empty() {
            return Ok(self.cells.iter().filter(|cell| cell.group != SAMPLE).collect());
        }
        let is = |cell: &Cell, name: &String| cell.name == *name || cell.group == *name;
        for name in names {
            if !self.cells.iter().any(|cell| is(cell, name)) {
                return Err(format!("{name}: no such cell or group; {FILE} has them all"));
            }
        }
        Ok(self.cells.iter().filter(|cell| names.iter().any(|name| is(cell, name))).collect())
    }
}

fn owned((key, value): (&str, Value)) -> (String, Value) {
    (key.to_owned(), value)
}

/// Tables are joined key by key, everything else takes the place of what was there.
fn lay_over(table: &mut Table, with: &Table) {
    for (key, value) in with {
        match (table.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            _ => {
                table.insert(key.clone(), value.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_shipped_grid_has_cells_of_every_group_each_with_a_name_of_its_own() {
        let grid = Grid::shipped().unwrap();
        let names: BTreeSet<_> = grid.cells.iter().map(|cell| &cell.name).collect();
        assert_eq!(names.len(), grid.cells.len());
        let all = grid.chosen(&[]).unwrap();
        assert!((40..=60).contains(&all.len()), "{}", all.len());
        for group in ["wind", "line", "sensor", "fault", "taut"] {
            assert!(all.iter().any(|cell| cell.group == group), "{group}");
        }
        for cell in &grid.cells {
            assert!(!cell.scenario.mission.is_empty(), "{}: nobody would fly", cell.name);
            assert!(cell.scenario.params().is_ok(), "{}", cell.name);
        }
    }

    #[test]
    fn lines_reach_from_2_to_30_grams_a_metre_and_from_3_to_80_metres() {
        let grid = Grid::shipped().unwrap();
        let lines = || grid.cells.iter().filter(|cell| cell.group == "line");
        let ends = |of: fn(&Cell) -> f64| {
            let values = lines().map(of);
            values.fold([f64::MAX, 0.0], |[low, high]: [f64; 2], x| [low.min(x), high.max(x)])
        };
        assert_eq!(
            format!("{:?}", ends(|cell| cell.scenario.tether.line_density)),
            "[0.002, 0.03]"
        );
        assert_eq!(format!("{:?}", ends(|cell| cell.scenario.tether.length)), "[3.0, 80.0]");
    }

    #[test]
    fn cells_are_chosen_by_name_or_group_and_what_is_neither_is_named() {
        let grid = Grid::shipped().unwrap();
        let some = grid.chosen(&["cut-3mps".into(), "taut".into()]).unwrap();
        assert_eq!(some.len(), 5);
        let e = grid.chosen(&["cuts".into()]).unwrap_err();
        assert!(e.starts_with("cuts: no such cell or group"), "{e}");
    }
}
