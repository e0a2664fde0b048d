//! Blocks of 8-node quadrilaterals: their nodes, elements and edges.
//!
//! Nodes are numbered row by row from the bottom: a row of corners and middles has 2 nx + 1 of them, the row between
//! two of these, which has no nodes inside elements, nx + 1.

use super::curves::point;
use super::error::{Fault, Path};
use super::limits;
use super::spec::Point;

/// Edges of a block in the order of the walk around it.
pub(crate) const EDGES: [&str; 4] = ["bottom", "right", "top", "left"];

/// Least sine of an angle of a block: its elements have the same angles.
const SHARPEST: f64 = 1e-2;

/// Number of elements of a block in its two directions, after refinement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Grid {
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    fn first_of_row(self, j: usize) -> usize {
        let (full, half) = (2 * self.columns + 1, self.columns + 1);
        j / 2 * (full + half) + j % 2 * full
    }

    /// Node at half elements i to the right and j up; not the middle of an element.
    fn node(self, i: usize, j: usize) -> usize {
        self.first_of_row(j) + if j.is_multiple_of(2) { i } else { i / 2 }
    }

    /// Nodes of each element, row by row.
    pub fn elements(self) -> impl Iterator<Item = [usize; 8]> {
        const AROUND: [(usize, usize); 8] = [
            (0, 0),
            (2, 0),
            (2, 2),
            (0, 2),
            (1, 0),
            (2, 1),
            (1, 2),
            (0, 1),
        ];
        let places = (0..self.rows).flat_map(move |r| (0..self.columns).map(move |c| (c, r)));
        places.map(move |(c, r)| AROUND.map(|(i, j)| self.node(2 * c + i, 2 * r + j)))
    }

    /// Nodes along an edge, walked anticlockwise around the block.
    pub fn edge(self, which: usize) -> Vec<usize> {
        let (right, top) = (2 * self.columns, 2 * self.rows);
        match which {
            0 => (0..=right).map(|i| self.node(i, 0)).collect(),
            1 => (0..=top).map(|j| self.node(right, j)).collect(),
            2 => (0..=right).rev().map(|i| self.node(i, top)).collect(),
            _ => (0..=top).rev().map(|j| self.node(0, j)).collect(),
        }
    }

    /// Positions of the nodes of a block with these four corners.
    fn positions(self, corners: &[Point; 4]) -> Vec<Point> {
        let (columns, rows) = (2 * self.columns, 2 * self.rows);
        let places = (0..=rows).flat_map(move |j| {
            let step = 1 + j % 2;
            (0..=columns).step_by(step).map(move |i| (i, j))
        });
        places
            .map(|(i, j)| {
                let (s, t) = (i as f64 / columns as f64, j as f64 / rows as f64);
                let blend = |c: [f64; 4]| {
                    (1.0 - t) * ((1.0 - s) * c[0] + s * c[1]) + t * ((1.0 - s) * c[3] + s * c[2])
                };
                (blend(corners.map(|c| c.0)), blend(corners.map(|c| c.1)))
            })
            .collect()
    }
}

/// The grid of a block and the positions of its nodes.
pub(crate) fn block(
    here: &Path,
    corners: &[Point],
    (columns, rows): (usize, usize),
    refine: usize,
) -> Result<(Grid, Vec<Point>), Fault> {
    for (k, count) in [columns, rows].into_iter().enumerate() {
        let path = here.then("elements").then(k);
        limits::count(&path, count, 1..=limits::NODES, "the number of elements")?;
    }
    let list = here.then("corners");
    for (k, at) in corners.iter().enumerate() {
        point(&list.then(k), *at)?;
    }
    let corners = match *corners {
        [low, high] => [low, (high.0, low.1), high, (low.0, high.1)],
        [a, b, c, d] => [a, b, c, d],
        _ => {
            let message = format!(
                "the list has {} corners; it must have two opposite ones, lower left and upper right, or all four",
                corners.len()
            );
            return Err(Fault::new(list, message));
        }
    };
    if let Some(k) = (0..4).find(|&k| !is_open(&corners, k)) {
        let (x, y) = corners[k];
        let message = format!(
            "the block is folded or flat at its corner ({x:?}, {y:?}); corners run anticlockwise, as lower left, \
             lower right, upper right, upper left, and every angle is below 180 degrees"
        );
        return Err(Fault::new(list, message));
    }
    // Bounded by `check_total`.
    let grid = Grid {
        columns: columns * refine,
        rows: rows * refine,
    };
    Ok((grid, grid.positions(&corners)))
}

/// Whether the boundary turns left at corner k, clearly.
fn is_open(corners: &[Point; 4], k: usize) -> bool {
    let (before, at, after) = (corners[(k + 3) % 4], corners[k], corners[(k + 1) % 4]);
    let (a, b) = (
        (at.0 - before.0, at.1 - before.1),
        (after.0 - at.0, after.1 - at.1),
    );
    a.0 * b.1 - a.1 * b.0 > SHARPEST * a.0.hypot(a.1) * b.0.hypot(b.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_share_the_nodes_of_their_sides_and_edges_close() {
        let grid = Grid {
            columns: 3,
            rows: 2,
        };
        let elements: Vec<[usize; 8]> = grid.elements().collect();
        assert_eq!(elements[0], [0, 2, 13, 11, 1, 8, 12, 7]);
        assert_eq!(
            [elements[0][1], elements[0][5], elements[0][2]],
            [elements[1][0], elements[1][7], elements[1][3]]
        );
        assert_eq!(elements[0][2..4], [elements[3][1], elements[3][0]]);
        let mut used: Vec<usize> = elements.concat();
        used.sort_unstable();
        used.dedup();
        assert_eq!(used, (0..29).collect::<Vec<_>>());
        let edges: Vec<Vec<usize>> = (0..4).map(|k| grid.edge(k)).collect();
        assert_eq!(edges[0], (0..=6).collect::<Vec<_>>());
        assert_eq!(edges[1], [6, 10, 17, 21, 28]);
        for k in 0..4 {
            assert_eq!(edges[k].last(), edges[(k + 1) % 4].first());
        }
    }

    #[test]
    fn a_block_has_its_corners_and_straight_edges() {
        let corners = [(0.0, 0.0), (4.0, 1.0), (3.0, 3.0), (-1.0, 2.0)];
        let (grid, at) = block(&Path::default(), &corners, (2, 3), 2).unwrap();
        assert_eq!(at.len(), 3 * 4 * 6 + 2 * (4 + 6) + 1);
        assert_eq!(grid.edge(2)[0], at.len() - 1);
        for (k, corner) in corners.iter().enumerate() {
            assert_eq!(at[grid.edge(k)[0]], *corner);
        }
        for element in grid.elements() {
            for side in 0..4 {
                let [a, b, middle] = [side, (side + 1) % 4, side + 4].map(|k| at[element[k]]);
                assert!((middle.0 - 0.5 * (a.0 + b.0)).abs() < 1e-15);
                assert!((middle.1 - 0.5 * (a.1 + b.1)).abs() < 1e-15);
            }
        }
    }
}
