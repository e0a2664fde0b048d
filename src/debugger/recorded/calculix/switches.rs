//! A finished run for ParaView (`.vtu`): the mesh of its deck, with how often each contact switched.
//!
//! | on nodes | |
//! | --- | --- |
//! | `node` | number in the deck |
//! | `switches` | switches of the slave node, or of its faces, in the whole run; -1 if it never was in contact |
//! | `switches_at_most` | the largest number in one attempt |
//! | `status` | in the last iteration: 0 open, 1 closed; -1 if it never was in contact |
//! | `pressure` | of the last result in the .frd; NaN elsewhere |

use super::run::CalculixRun;
use stickslip_exchange::mesh::{Cell, CellKind};
use stickslip_exchange::vtu::{Array, Grid, Values};

/// The grid of a run, and the number of slaves that are not in the deck.
///
/// # Errors
/// If there is no deck.
pub fn grid(run: &CalculixRun, pressures: &[(u32, f64)]) -> Result<(Grid, usize), String> {
    let deck = run.deck.as_ref().ok_or_else(|| {
        format!(
            "{}: the deck next to it is missing; the mesh is read from it",
            run.name
        )
    })?;
    let places = deck.labels();
    let place = |label: u32| places.get(&u64::from(label)).copied();
    let count = deck.nodes.len();
    let (mut switches, mut most, mut status) = (vec![-1; count], vec![-1; count], vec![-1; count]);
    let mut lost = 0;
    let last = run.files.iterations.len().checked_sub(1);
    for (slave, of) in run.files.slaves.iter().enumerate() {
        let nodes: Vec<usize> = of.nodes().iter().copied().filter_map(place).collect();
        lost += usize::from(nodes.is_empty());
        let found = run.switching_of(slave);
        let whole = |count: usize| i32::try_from(count).unwrap_or(i32::MAX);
        let of_run = found.map_or(0, |found| whole(found.total()));
        let of_attempt = found.map_or(0, |found| whole(found.most().1));
        let closed = last.and_then(|last| run.contact(last, slave));
        let closed = closed.map_or(-1, |closed| i32::from(!closed.is_empty()));
        for node in nodes {
            switches[node] = of_run.max(switches[node]);
            most[node] = of_attempt.max(most[node]);
            status[node] = closed.max(status[node]);
        }
    }
    let mut pressure = vec![f64::NAN; count];
    for (label, value) in pressures {
        if let Some(node) = place(*label) {
            pressure[node] = *value;
        }
    }
    let labels = deck
        .nodes
        .iter()
        .map(|node| i32::try_from(node.label).unwrap_or(i32::MAX));
    let cells = deck.elements.iter().map(|element| {
        let (kind, mut nodes) = (element.kind.cell, element.nodes.clone());
        // A deck has the middle of a beam between its ends.
        if kind == CellKind::Line3 {
            nodes.swap(1, 2);
        }
        Cell { kind, nodes }
    });
    let grid = Grid {
        points: deck.nodes.iter().map(|node| node.at).collect(),
        cells: cells.collect(),
        on_points: vec![
            Array::new("node", Values::Wholes(labels.collect())),
            Array::new("switches", Values::Wholes(switches)),
            Array::new("switches_at_most", Values::Wholes(most)),
            Array::new("status", Values::Wholes(status)),
            Array::new("pressure", Values::Numbers(pressure)),
        ],
        ..Grid::default()
    };
    Ok((grid, lost))
}
