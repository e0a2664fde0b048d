//! Reference curves for runs: tables of monitors over the load factor.
//!
//! A table is CSV: `#` lines are comments, followed by a header with `load` and names of monitors (other
//! columns are ignored) and, if the load path reverses, `leg` (from 1; without it, a new leg starts after the
//! load of each corner). The output of `stickslip run --csv` is such a table.

use super::csv::Table;
use super::result::Run;
use std::path::Path;
use stickslip_core::plane::max_abs;
use stickslip_platform::input::{self, TABLE_BYTES};
use stickslip_scene::embedded_all;
use stickslip_scene::format::error::{quoted, shortened};
use stickslip_scene::format::read::not_read;
use stickslip_scene::{EmbeddedFile, SceneError};

/// Relative difference below which loads are equal.
pub const SAME_LOAD: f64 = 1e-9;

/// A reference curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Description for a footer.
    pub source: String,
    /// Names of its columns.
    pub monitors: Vec<String>,
    /// Its rows in the order of the path.
    pub rows: Vec<ReferencePoint>,
}

/// Values at one load.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePoint {
    /// Leg of the load path, from 0.
    pub leg: usize,
    /// The load factor λ.
    pub load: f64,
    /// One value per column.
    pub values: Vec<f64>,
    /// Error bar of each value; empty if it is unknown.
    pub bars: Vec<f64>,
}

/// The built-in references, by scene.
static TABLES: &[EmbeddedFile] = embedded_all![
    "../../problems/references/",
    ".csv",
    "01-pinned-beam-rough-floor",
    "02-two-cantilevers-smooth",
    "02-two-cantilevers-rough",
    "03-distant-cantilevers",
    "04-cantilever-rigid-circle",
    "osc-inclined-cantilever",
];

impl Reference {
    /// The built-in reference for a scene; `path` is the scene's load path.
    ///
    /// # Errors
    /// Never for the built-in tables (checked by tests).
    pub fn builtin(scene: &str, path: &[f64]) -> Option<Result<Reference, SceneError>> {
        let table = TABLES.iter().find(|table| table.name == scene)?;
        Some(Reference::read(
            &format!("{}.csv", table.name),
            table.text,
            path,
        ))
    }

    /// Reads a table from a file.
    ///
    /// # Errors
    /// If it cannot be read; the message has file, line and column.
    pub fn open(file: &Path, path: &[f64]) -> Result<Reference, SceneError> {
        let name = file.display().to_string();
        let text = input::text(file, TABLE_BYTES, "too large for a reference table")
            .map_err(|why| not_read(&name, &why))?;
        Reference::read(&name, &text, path)
    }

    /// Parses a table.
    ///
    /// # Errors
    /// As [`Reference::open`].
    pub fn read(name: &str, text: &str, path: &[f64]) -> Result<Reference, SceneError> {
        let table = Table::read(name, text)?;
        let about: Vec<&str> = table.comments().collect();
        let heads = table.heads();
        let place = |wanted: &str| heads.iter().position(|head| *head == wanted);
        let load = place("load").ok_or_else(|| {
            let header = quoted(table.header_line());
            table.wrong_header(format!("the header needs a column load: {header}"))
        })?;
        let leg = place("leg");
        let words = ["load", "leg", "increment", "majors", "minors"];
        let columns: Vec<usize> = (0..heads.len())
            .filter(|&k| !words.contains(&heads[k]))
            .collect();
        let mut rows: Vec<ReferencePoint> = Vec::new();
        let mut legs = Legs::new(path);
        for row in &table.rows {
            table.check(row)?;
            let number = |k: usize| {
                let value = row.fields[k].parse::<f64>().ok();
                value.filter(|v| v.is_finite()).ok_or_else(|| {
                    let (word, head) = (quoted(&row.fields[k]), shortened(heads[k]));
                    table.wrong(row, k, format!("{word} under {head} is not a number"))
                })
            };
            let at = number(load)?;
            let leg = match leg {
                Some(k) => (number(k)? as usize).saturating_sub(1),
                None => legs.of(at),
            };
            let values = columns
                .iter()
                .map(|&k| number(k))
                .collect::<Result<_, _>>()?;
            rows.push(ReferencePoint {
                leg,
                load: at,
                values,
                bars: Vec::new(),
            });
        }
        if rows.is_empty() {
            return Err(table.wrong_header("the table has no rows".into()));
        }
        Ok(Reference {
            source: [&[name], &about[..]].concat().join(" "),
            monitors: columns.iter().map(|&k| heads[k].to_owned()).collect(),
            rows,
        })
    }

    /// A run as the reference for others.
    pub fn from_run(run: &Run, source: String, path: &[f64]) -> Reference {
        let mut legs = Legs::new(path);
        let row = |row: &super::Row| ReferencePoint {
            leg: legs.of(row.load),
            load: row.load,
            values: row.monitors.clone(),
            bars: Vec::new(),
        };
        Reference {
            source,
            monitors: run.monitors.clone(),
            rows: run.rows.iter().map(row).collect(),
        }
    }

    /// The row at a load on a leg.
    pub fn at(&self, leg: usize, load: f64) -> Option<&ReferencePoint> {
        let size = max_abs(self.rows.iter().map(|row| row.load));
        let here =
            |row: &&ReferencePoint| row.leg == leg && (row.load - load).abs() <= SAME_LOAD * size;
        self.rows.iter().find(here)
    }
}

/// Determines the leg of consecutive loads.
struct Legs<'a> {
    path: &'a [f64],
    leg: usize,
}

impl<'a> Legs<'a> {
    fn new(path: &'a [f64]) -> Self {
        Legs { path, leg: 0 }
    }

    fn of(&mut self, load: f64) -> usize {
        let here = self.leg;
        let size = max_abs(self.path);
        if self
            .path
            .get(here + 1)
            .is_some_and(|corner| (load - corner).abs() <= SAME_LOAD * size)
            && here + 2 < self.path.len()
        {
            self.leg += 1;
        }
        here
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_table_parses_and_ends_with_its_scene() {
        for EmbeddedFile { name, .. } in TABLES {
            let scene = stickslip_scene::Scene::open(name, &[]).unwrap();
            let path = &scene.model.path;
            let table = Reference::builtin(name, path).unwrap().unwrap();
            let known = |m: &String| scene.model.monitors.iter().any(|own| own.name == *m);
            assert!(
                table.monitors.iter().all(known),
                "{name}: {:?}",
                table.monitors
            );
            let last = table.rows.last().unwrap();
            assert_eq!(
                (last.leg, last.load),
                (path.len() - 2, path[path.len() - 1]),
                "{name}"
            );
        }
    }

    #[test]
    fn legs_are_found_from_the_corners() {
        let text = "increment,load,u_x\n1,1,0.1\n2,2,0.2\n3,1,0.3\n4,0,0.4\n";
        let table = Reference::read("x", text, &[0.0, 2.0, 0.0]).unwrap();
        let legs: Vec<usize> = table.rows.iter().map(|row| row.leg).collect();
        assert_eq!(legs, [0, 0, 1, 1]);
        assert_eq!(table.at(1, 1.0).unwrap().values, [0.3]);
        assert_eq!(table.monitors, ["u_x"]);
    }

    #[test]
    fn errors_have_a_line_number() {
        for (text, part) in [
            ("", "no header"),
            ("a,b\n", "x:1:1: the header needs a column load"),
            ("\u{feff}# c\nload,u\n1, a\n", "x:3:3: \"a\" under u"),
            ("load,u\n", "no rows"),
            ("# c\nload,u\n1\n", "x:3:1: the row has 1 fields"),
            ("load,u\n1,a\n", "x:2:3: \"a\" under u"),
        ] {
            let error = Reference::read("x", text, &[0.0, 1.0]).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
