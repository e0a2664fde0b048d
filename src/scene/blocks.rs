//! Structured blocks of quadrilaterals or triangles (two per cell): nodes, elements and edges.
//!
//! Nodes are numbered row by row from the bottom. With 8-node quadrilaterals, a row of corners and midside nodes has 2 nx + 1
//! nodes, and the row between two of these, which has no nodes inside elements, nx + 1. Kinds with a node inside each cell have 2
//! nx + 1 nodes in every row; those without midside nodes have nx + 1 in every second row and none in between. Curved sides are
//! blended into the interior (transfinite interpolation, Gordon and Hall 1973).

use super::curves::{lagrange, point, sin_cos_degrees};
use super::geometry;
use super::limits;
use crate::format::error::{AtPath, Fault, Path, bail, fault};
use crate::format::spec::{BlockPosition, Point, Side, Sides};
use stickslip_core::ElementKind;

/// Edges of a block in walking order.
pub(crate) const EDGES: [&str; 4] = ["bottom", "right", "top", "left"];

/// Minimum sine of a block's angles; its elements have the same angles.
const SHARPEST: f64 = 1e-2;

/// Lengths with a smaller relative difference are considered equal.
const SAME_LENGTH: f64 = 1e-6;

/// Number of cells of a block in both directions after refinement, and their element kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Grid {
    pub columns: usize,
    pub rows: usize,
    pub kind: ElementKind,
}

/// The half-cell positions at which a row has nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Row {
    None,
    Corners,
    All,
}

/// Where a cell of one or two elements has nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Corners,
    /// Corners and midsides.
    Sides,
    /// Corners, midsides, and the centre.
    Inside,
}

impl Cell {
    /// `None` for an element with nodes elsewhere, which a block cannot place.
    fn from_kind(kind: ElementKind) -> Option<Cell> {
        match (kind.corners().count(), kind.nodes()) {
            (3, 3) | (4, 4) => Some(Cell::Corners),
            (4, 8) => Some(Cell::Sides),
            (3, 6) | (4, 9) => Some(Cell::Inside),
            _ => None,
        }
    }
}

/// Corners and midside nodes of a cell, in half cells to the right and up; then its centre.
const AROUND: [(usize, usize); 9] = [
    (0, 0),
    (2, 0),
    (2, 2),
    (0, 2),
    (1, 0),
    (2, 1),
    (1, 2),
    (0, 1),
    (1, 1),
];

impl Grid {
    /// Kind of the row at j half cells.
    fn row(self, j: usize) -> Row {
        match (Cell::from_kind(self.kind), j.is_multiple_of(2)) {
            (Some(Cell::Corners), true) => Row::Corners,
            (Some(Cell::Corners), false) => Row::None,
            (Some(Cell::Sides), false) => Row::Corners,
            _ => Row::All,
        }
    }

    fn nodes_of(self, row: Row) -> usize {
        match row {
            Row::None => 0,
            Row::Corners => self.columns + 1,
            Row::All => 2 * self.columns + 1,
        }
    }

    fn first_of_row(self, j: usize) -> usize {
        let [even, odd] = [0, 1].map(|j| self.nodes_of(self.row(j)));
        j / 2 * (even + odd) + j % 2 * even
    }

    /// Node at half cells i to the right and j up; must exist.
    fn node(self, i: usize, j: usize) -> usize {
        self.first_of_row(j) + if self.row(j) == Row::All { i } else { i / 2 }
    }

    /// Nodes of each side of a cell.
    pub fn per_edge(self) -> usize {
        self.kind.per_face()
    }

    /// Approximate number of nodes added per cell.
    pub fn nodes_per_cell(kind: ElementKind) -> f64 {
        match Cell::from_kind(kind) {
            Some(Cell::Corners) => 1.0,
            Some(Cell::Sides) => 3.0,
            Some(Cell::Inside) | None => 4.0,
        }
    }

    /// Nodes of each element, cell by cell and row by row.
    pub fn elements(self) -> impl Iterator<Item = Vec<usize>> {
        (0..self.rows)
            .flat_map(move |r| (0..self.columns).map(move |c| (c, r)))
            .flat_map(move |(c, r)| self.elements_of(c, r))
    }

    /// Elements per cell: two triangles or one quadrilateral.
    fn per_cell(self) -> usize {
        1 + usize::from(self.kind.is_triangle())
    }

    /// The elements of a cell. Triangles are cut along alternating diagonals, so that meshes with even numbers of cells are as
    /// symmetric as their blocks.
    fn elements_of(self, c: usize, r: usize) -> Vec<Vec<usize>> {
        let at = |(i, j): (usize, usize)| self.node(2 * c + i, 2 * r + j);
        if !self.kind.is_triangle() {
            return vec![
                AROUND[..self.kind.nodes()]
                    .iter()
                    .copied()
                    .map(at)
                    .collect(),
            ];
        }
        let halves = if (c + r).is_multiple_of(2) {
            [[0, 1, 2], [0, 2, 3]]
        } else {
            [[0, 1, 3], [1, 2, 3]]
        };
        let triangle = |corners: [usize; 3]| {
            let corners = corners.map(|k| AROUND[k]);
            corners
                .into_iter()
                .chain((0..3).map(|k| {
                    let ((a, b), (c, d)) = (corners[k], corners[(k + 1) % 3]);
                    ((a + c) / 2, (b + d) / 2)
                }))
                .take(self.kind.nodes())
                .map(at)
                .collect()
        };
        halves.map(triangle).to_vec()
    }

    /// Nodes along an edge, walked anticlockwise around the block.
    pub fn edge(self, which: usize) -> Vec<usize> {
        let (right, top) = (2 * self.columns, 2 * self.rows);
        let step = if self.per_edge() == 2 { 2 } else { 1 };
        let across = (0..right + 1).step_by(step);
        let up = (0..top + 1).step_by(step);
        match which {
            0 => across.map(|i| self.node(i, 0)).collect(),
            1 => up.map(|j| self.node(right, j)).collect(),
            2 => across.rev().map(|i| self.node(i, top)).collect(),
            _ => up.rev().map(|j| self.node(0, j)).collect(),
        }
    }

    /// Positions of the nodes: bilinear interpolation of the corners plus the deviations of the sides from straight lines,
    /// blended between opposite sides (transfinite interpolation).
    fn positions(self, corners: &[Point; 4], at: &Stations, curves: &Curves) -> Vec<Point> {
        let places = (0..=2 * self.rows).flat_map(move |j| {
            let (step, last) = match self.row(j) {
                Row::None => (1, 0),
                Row::Corners => (2, 2 * self.columns + 1),
                Row::All => (1, 2 * self.columns + 1),
            };
            (0..last).step_by(step).map(move |i| (i, j))
        });
        places
            .map(|(i, j)| {
                let (s, t) = (at.across[i], at.up[j]);
                let blend = |c: [f64; 4]| {
                    (1.0 - t) * ((1.0 - s) * c[0] + s * c[1]) + t * ((1.0 - s) * c[3] + s * c[2])
                };
                let straight = (blend(corners.map(|c| c.0)), blend(corners.map(|c| c.1)));
                // Weights of the four sides, and the station on each.
                let parts = [(1.0 - t, i), (s, j), (t, i), (1.0 - s, j)];
                curves
                    .iter()
                    .zip(parts)
                    .filter(|(curve, _)| !curve.is_empty())
                    .fold(straight, |(x, y), (curve, (part, k))| {
                        (x + part * curve[k].0, y + part * curve[k].1)
                    })
            })
            .collect()
    }
}

/// Parameters of the nodes of a block, from 0 to 1, at every half element.
struct Stations {
    across: Vec<f64>,
    up: Vec<f64>,
}

/// Deviations of each side from a straight line at its stations, walked to the right or upwards; empty for a straight side.
type Curves = [Vec<Point>; 4];

/// Parameters of a block, as the scene gives them.
pub(crate) struct Shape<'a> {
    pub corners: &'a [Point],
    pub elements: (usize, usize),
    pub kind: ElementKind,
    pub grading: (f64, f64),
    pub sides: &'a Sides,
    pub place: &'a BlockPosition,
}

/// The points of a chain, and its number of nodes per element.
pub(crate) type ChainPoints = (Vec<Point>, usize);

/// The grid of a block and the positions of its nodes; `chain` looks up the points and the nodes per element of a chain.
pub(crate) fn block(
    here: &Path,
    shape: &Shape<'_>,
    refine: usize,
    chain: &dyn Fn(&str) -> Result<ChainPoints, String>,
) -> Result<(Grid, Vec<Point>), Fault> {
    if Cell::from_kind(shape.kind).is_none() {
        bail!(
            here.then("element"),
            "a block cannot be meshed with elements of kind {}; use Given or Import for its elements",
            shape.kind.word()
        );
    }
    let (columns, rows) = shape.elements;
    for (k, count) in [columns, rows].into_iter().enumerate() {
        let path = here.then("elements").then(k);
        limits::count(&path, count, 1..=limits::NODES, "the number of elements")?;
    }
    for (k, ratio) in [shape.grading.0, shape.grading.1].into_iter().enumerate() {
        if !(1.0 / limits::GRADING..=limits::GRADING).contains(&ratio) {
            bail!(
                here.then("grading").then(k),
                "the grading is {ratio:?} (last element length over first); it must be between {:?} and \
                 {:?}",
                1.0 / limits::GRADING,
                limits::GRADING
            );
        }
    }
    let corners = corners(here, shape)?;
    // Bounded by `check_total`.
    let grid = Grid {
        columns: columns * refine,
        rows: rows * refine,
        kind: shape.kind,
    };
    let at = Stations {
        across: stations(columns, shape.grading.0, refine),
        up: stations(rows, shape.grading.1, refine),
    };
    let mut curves = Curves::default();
    for (k, side) in shape.sides.around().into_iter().enumerate() {
        let Some(side) = side else { continue };
        // Walked to the right or upwards.
        let (from, to) = [(0, 1), (1, 2), (3, 2), (0, 3)][k];
        let path = here.then("sides").then(EDGES[k]);
        let stations = if k % 2 == 0 { &at.across } else { &at.up };
        let ends = (corners[from], corners[to]);
        curves[k] = match side {
            Side::Arc { center } => arc_side(&path.then("center"), *center, ends, stations)?,
            Side::Along { chain: id } => {
                let path = path.then("chain");
                let (points, m) = chain(id).at(&path)?;
                chain_side(&path, id, &points, m, ends, stations)?
            }
        };
    }
    let mut points = grid.positions(&corners, &at, &curves);
    check_elements(here, grid, &points)?;
    put(here, shape.place, &mut points)?;
    Ok((grid, points))
}

/// The four corners; each corner between two straight sides must be convex (a left turn).
fn corners(here: &Path, shape: &Shape<'_>) -> Result<[Point; 4], Fault> {
    let list = here.then("corners");
    for (k, at) in shape.corners.iter().enumerate() {
        point(&list.then(k), *at)?;
    }
    let corners = match *shape.corners {
        // The block would be turned by 180 degrees: its bottom edge would be at the top.
        [(x, y), high] if x > high.0 && y > high.1 => {
            bail!(
                list,
                "the first corner, ({x:?}, {y:?}), is the upper right one; the lower left one comes first"
            );
        }
        [low, high] => [low, (high.0, low.1), high, (low.0, high.1)],
        [a, b, c, d] => [a, b, c, d],
        _ => {
            bail!(
                list,
                "the list has {} corners; it must have two opposite ones, lower left and upper right, or all four",
                shape.corners.len()
            );
        }
    };
    let curved = shape.sides.around().map(|side| side.is_some());
    let straight = |k: usize| !curved[k] && !curved[(k + 3) % 4];
    if let Some(k) = (0..4).find(|&k| straight(k) && !is_open(&corners, k)) {
        let (x, y) = corners[k];
        bail!(
            list,
            "the block is folded or flat at its corner ({x:?}, {y:?}); list the corners anticlockwise \
             (lower left, lower right, upper right, upper left), with every angle below 180 degrees"
        );
    }
    if let Some(k) = (0..4).find(|&k| corners[k] == corners[(k + 1) % 4]) {
        let (x, y) = corners[k];
        bail!(
            list,
            "the {} side has zero length: both ends are at ({x:?}, {y:?})",
            EDGES[k]
        );
    }
    Ok(corners)
}

/// Parameters at every half element of a side whose element lengths grow by a constant factor, the last being `ratio` times the
/// first; refinement divides each element evenly.
fn stations(elements: usize, ratio: f64, refine: usize) -> Vec<f64> {
    let steps = 2 * refine;
    let last = elements * steps;
    if ratio == 1.0 || elements == 1 {
        return (0..=last).map(|i| i as f64 / last as f64).collect();
    }
    let growth = ratio.powf(1.0 / (elements - 1) as f64);
    let mut ends = vec![0.0];
    let mut length = 1.0;
    for k in 0..elements {
        ends.push(ends[k] + length);
        length *= growth;
    }
    let whole = ends[elements];
    let at = |i: usize| {
        let (k, part) = ((i / steps).min(elements - 1), i % steps);
        let part = if i == last {
            1.0
        } else {
            part as f64 / steps as f64
        };
        ((1.0 - part) * ends[k] + part * ends[k + 1]) / whole
    };
    (0..=last).map(at).collect()
}

/// Deviation of a side from its chord at a station.
fn deviation((from, to): (Point, Point), s: f64, at: Point) -> Point {
    let straight = |a: f64, b: f64| (1.0 - s) * a + s * b;
    (at.0 - straight(from.0, to.0), at.1 - straight(from.1, to.1))
}

/// The shorter arc about a center.
fn arc_side(
    path: &Path,
    center: Point,
    ends: (Point, Point),
    stations: &[f64],
) -> Result<Vec<Point>, Fault> {
    point(path, center)?;
    let arm = |p: Point| (p.0 - center.0, p.1 - center.1);
    let (a, b) = (arm(ends.0), arm(ends.1));
    let (r, q) = (a.0.hypot(a.1), b.0.hypot(b.1));
    if (r - q).abs() > SAME_LENGTH * r.max(q) {
        bail!(
            path,
            "the corners {:?} and {:?} are {r} and {q} away from the center; an arc needs equal radii",
            ends.0,
            ends.1
        );
    }
    let turn = (a.0 * b.1 - a.1 * b.0).atan2(a.0 * b.0 + a.1 * b.1);
    if turn.abs() > std::f64::consts::PI * (1.0 - SAME_LENGTH) {
        bail!(
            path,
            "the corners are opposite each other, so the direction of the arc is ambiguous; divide the block"
        );
    }
    let on_arc = |s: f64| {
        let (sin, cos) = (turn * s).sin_cos();
        let radius = ((1.0 - s) * r + s * q) / r;
        let (x, y) = (a.0 * cos - a.1 * sin, a.0 * sin + a.1 * cos);
        (center.0 + radius * x, center.1 + radius * y)
    };
    Ok(deviations(ends, stations, on_arc))
}

/// The curve of a chain of m-node elements, in the direction that matches the corners.
fn chain_side(
    path: &Path,
    id: &str,
    points: &[Point],
    m: usize,
    ends: (Point, Point),
    stations: &[f64],
) -> Result<Vec<Point>, Fault> {
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        bail!(path, "the chain is empty");
    };
    let apart = |a: Point, b: Point| (a.0 - b.0).hypot(a.1 - b.1);
    let near = SAME_LENGTH * apart(ends.0, ends.1);
    let fits = |a: Point, b: Point| apart(a, ends.0).max(apart(b, ends.1)) <= near;
    let mut walked = points.to_vec();
    if !fits(first, last) {
        if !fits(last, first) {
            bail!(
                path,
                "the chain {id:?} runs from {first:?} to {last:?}; it must connect the corners {:?} and {:?}",
                ends.0,
                ends.1
            );
        }
        walked.reverse();
    }
    let count = (walked.len() - 1) / (m - 1);
    let on_chain = |s: f64| {
        let place = s * count as f64;
        let element = (place as usize).min(count - 1);
        let nodes = &walked[element * (m - 1)..=(element + 1) * (m - 1)];
        lagrange(nodes, (place - element as f64) * (m - 1) as f64)
    };
    Ok(deviations(ends, stations, on_chain))
}

/// Deviations from the chord at all stations; zero at the corners.
fn deviations(ends: (Point, Point), stations: &[f64], at: impl Fn(f64) -> Point) -> Vec<Point> {
    let inside = |s: f64| s > 0.0 && s < 1.0;
    stations
        .iter()
        .map(|&s| {
            if inside(s) {
                deviation(ends, s, at(s))
            } else {
                (0.0, 0.0)
            }
        })
        .collect()
}

/// Rejects a mesh with a folded or nearly folded element.
fn check_elements(here: &Path, grid: Grid, at: &[Point]) -> Result<(), Fault> {
    let folds = geometry::Folds::from_kind(grid.kind);
    let folded = |nodes: Vec<usize>| folds.is_folded(nodes.iter().map(|&n| [at[n].0, at[n].1]));
    let Some(place) = grid.elements().position(folded) else {
        return Ok(());
    };
    let place = place / grid.per_cell();
    Err(fault!(
        here,
        "the block is folded in element {} from the left, {} from the bottom: its Jacobian is not \
         positive; list the corners anticlockwise, and check curved and graded sides",
        place % grid.columns + 1,
        place / grid.columns + 1
    ))
}

/// Rotates and moves points.
fn put(here: &Path, place: &BlockPosition, points: &mut [Point]) -> Result<(), Fault> {
    let here = here.then("place");
    limits::finite(&here.then("turn"), place.turn, "the angle")?;
    point(&here.then("about"), place.about)?;
    point(&here.then("shift"), place.shift)?;
    if *place == BlockPosition::default() {
        return Ok(());
    }
    let (sin, cos) = sin_cos_degrees(place.turn);
    let (center, shift) = (place.about, place.shift);
    for at in points {
        let (x, y) = (at.0 - center.0, at.1 - center.1);
        *at = (
            center.0 + cos * x - sin * y + shift.0,
            center.1 + sin * x + cos * y + shift.1,
        );
    }
    Ok(())
}

/// Whether the boundary turns clearly left at corner k.
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
            kind: ElementKind::Quad8,
        };
        let elements: Vec<Vec<usize>> = grid.elements().collect();
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
    fn every_kind_uses_all_nodes_and_its_faces_match_or_form_the_edges() {
        for kind in ElementKind::ALL {
            let (columns, rows) = (4, 3);
            let grid = Grid {
                columns,
                rows,
                kind,
            };
            let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)];
            let stations = Stations {
                across: super::stations(columns, 1.0, 1),
                up: super::stations(rows, 1.0, 1),
            };
            let at = grid.positions(&corners, &stations, &Curves::default());
            let elements: Vec<Vec<usize>> = grid.elements().collect();
            let mut used = elements.concat();
            used.sort_unstable();
            used.dedup();
            assert_eq!(used, (0..at.len()).collect::<Vec<_>>(), "{kind:?}");
            // Elements have the same orientation as their parent element.
            let folds = geometry::Folds::from_kind(kind);
            for nodes in &elements {
                assert_eq!(nodes.len(), kind.nodes());
                assert!(!folds.is_folded(nodes.iter().map(|&n| [at[n].0, at[n].1])));
                for face in kind.faces_of(nodes).filter(|face| face.len() == 3) {
                    let [a, b, c] = [at[face[0]], at[face[1]], at[face[2]]];
                    assert_eq!((a.0 + c.0, a.1 + c.1), (2.0 * b.0, 2.0 * b.1), "{kind:?}");
                }
            }
            let outer =
                stickslip_core::model::boundary(elements.iter().map(|e| (kind, e.as_slice())));
            let mut expected = Vec::new();
            for edge in (0..4).map(|k| grid.edge(k)) {
                let m = kind.per_face() - 1;
                expected.extend(
                    (0..edge.len() - 1)
                        .step_by(m)
                        .map(|k| edge[k..=k + m].to_vec()),
                );
            }
            let sorted = |mut faces: Vec<Vec<usize>>| {
                faces.sort();
                faces
            };
            assert_eq!(sorted(outer), sorted(expected), "{kind:?}");
        }
    }

    fn made(
        corners: &[Point],
        elements: (usize, usize),
        grading: (f64, f64),
        sides: &Sides,
        refine: usize,
    ) -> Result<(Grid, Vec<Point>), Fault> {
        let shape = Shape {
            corners,
            elements,
            kind: ElementKind::Quad8,
            grading,
            sides,
            place: &BlockPosition::default(),
        };
        block(&Path::default(), &shape, refine, &|id| Err(id.into()))
    }

    #[test]
    fn a_graded_side_ends_in_an_element_that_is_longer_by_its_ratio_and_refines_evenly() {
        let coarse = stations(4, 8.0, 1);
        let length = |k: usize| coarse[2 * k + 2] - coarse[2 * k];
        assert!((length(3) / length(0) - 8.0).abs() < 1e-12);
        assert!((length(1) / length(0) - 2.0).abs() < 1e-12);
        assert_eq!((coarse[0], coarse[8]), (0.0, 1.0));
        let fine = stations(4, 8.0, 3);
        for k in 0..=4 {
            assert!((fine[6 * k] - coarse[2 * k]).abs() < 1e-15);
        }
        assert!((fine[2] - fine[0] - (fine[4] - fine[2])).abs() < 1e-15);
    }

    #[test]
    fn the_interior_of_a_sector_is_concentric_and_its_elements_are_valid() {
        let arc = || Some(Side::Arc { center: (0.0, 0.0) });
        let sides = Sides {
            bottom: arc(),
            top: arc(),
            ..Sides::default()
        };
        // The bottom is the outer arc, walked anticlockwise, so that the block is on its left.
        let corners = [(2.0, 0.0), (0.0, 2.0), (0.0, 1.0), (1.0, 0.0)];
        let (_, at) = made(&corners, (3, 2), (1.0, 2.0), &sides, 2).unwrap();
        let radii: Vec<f64> = at.iter().map(|p| p.0.hypot(p.1)).collect();
        assert!(radii[..13].iter().all(|r| (r - 2.0).abs() < 1e-14));
        assert!(radii[13..20].iter().all(|r| (r - radii[13]).abs() < 1e-14));
        let wrong = [(1.0, 0.0), (0.0, 1.0), (0.0, 2.0), (2.0, 0.0)];
        let fault = made(&wrong, (3, 2), (1.0, 1.0), &sides, 1).unwrap_err();
        assert!(fault.message.contains("folded"), "{}", fault.message);
    }

    #[test]
    fn a_block_has_its_corners_and_straight_edges() {
        let corners = [(0.0, 0.0), (4.0, 1.0), (3.0, 3.0), (-1.0, 2.0)];
        let (grid, at) = made(&corners, (2, 3), (1.0, 1.0), &Sides::default(), 2).unwrap();
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
