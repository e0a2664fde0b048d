//! Physical groups: their cells and names.

use super::elements::RawCell;
use crate::mesh::{Cell, Group};
use std::collections::HashMap;

/// The groups defined in a file.
#[derive(Default)]
pub(super) struct Groups {
    /// Dimension, number and name, in file order.
    names: Vec<(u8, i64, String)>,
    /// The groups of each entity, by dimension and number.
    of_entity: HashMap<(u8, i64), Vec<i64>>,
}

impl Groups {
    /// Names a group.
    pub fn name(&mut self, dimension: u8, tag: i64, name: &str) {
        self.names.push((dimension, tag, name.to_owned()));
    }

    /// Adds an entity to a group. In Gmsh a negative sign means that a curve is reversed there.
    pub fn has(&mut self, dimension: u8, entity: i64, group: i64) {
        let group = group.saturating_abs();
        self.of_entity
            .entry((dimension, entity))
            .or_default()
            .push(group);
    }

    /// The cells, each once, and the nonempty groups: named groups in the order of their names, then unnamed ones in the order of
    /// their cells. Version 2.2 repeats a cell for every group that contains it.
    pub fn of_cells(&self, raw: &[RawCell], cells: Vec<Cell>) -> (Vec<Cell>, Vec<Group>) {
        let mut made = Vec::new();
        let mut place_of: HashMap<(u8, i64), usize> = HashMap::new();
        for (dimension, tag, name) in &self.names {
            let (name, cells) = (name.clone(), Vec::new());
            place_of.entry((*dimension, *tag)).or_insert(made.len());
            made.push(Group { name, cells });
        }
        let has_groups = !self.of_entity.is_empty()
            || raw
                .iter()
                .any(|cell| cell.physical.is_some_and(|tag| tag != 0));
        let repeats = repeats(raw);
        let mut first_of: HashMap<Vec<usize>, usize> = HashMap::new();
        let mut kept: Vec<Cell> = Vec::with_capacity(cells.len());
        for (cell, raw) in cells.into_iter().zip(raw) {
            let mut place = kept.len();
            if repeats {
                place = *first_of.entry(cell.nodes.clone()).or_insert(place);
            }
            let dimension = cell.kind.dimension();
            let own = [raw.physical.unwrap_or(0).saturating_abs()];
            let groups = match (has_groups, raw.physical) {
                (false, _) => &[raw.entity][..],
                (true, Some(_)) => &own[..],
                (true, None) => self
                    .of_entity
                    .get(&(dimension, raw.entity))
                    .map_or(&[][..], Vec::as_slice),
            };
            for &tag in groups.iter().filter(|tag| **tag != 0) {
                let group = *place_of.entry((dimension, tag)).or_insert(made.len());
                if group == made.len() {
                    let name = format!(
                        "{}{tag}",
                        ["point", "line", "surface"][usize::from(dimension)]
                    );
                    let cells = Vec::new();
                    made.push(Group { name, cells });
                }
                made[group].cells.push(place);
            }
            if place == kept.len() {
                kept.push(cell);
            }
        }
        for group in &mut made {
            group.cells.sort_unstable();
            group.cells.dedup();
        }
        made.retain(|group| !group.cells.is_empty());
        (kept, made)
    }
}

/// Whether an entity is listed for more than one group, so that its cells are repeated.
fn repeats(raw: &[RawCell]) -> bool {
    let mut group_of = HashMap::new();
    raw.iter().any(|cell| {
        let Some(group) = cell.physical else {
            return false;
        };
        let entity = (cell.kind.dimension(), cell.entity);
        *group_of.entry(entity).or_insert(group) != group
    })
}
