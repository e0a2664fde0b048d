//! Cells of other programs' meshes, and a plane mesh: nodes, cells, and named groups of cells.

/// Kind of a cell. Nodes are ordered: the corners, anticlockwise (of a solid: of its bottom, then of its top); then the midside
/// nodes in the order of [`CellKind::edges`]; then the centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// One node.
    Point,
    /// A straight line: its two ends.
    Line2,
    /// A second-order line: its two ends, then its midside node.
    Line3,
    /// 3-node triangle.
    Triangle3,
    /// 6-node triangle.
    Triangle6,
    /// 4-node quadrilateral.
    Quad4,
    /// 8-node quadrilateral.
    Quad8,
    /// 9-node quadrilateral.
    Quad9,
    /// 4-node tetrahedron.
    Tetra4,
    /// 10-node tetrahedron.
    Tetra10,
    /// 6-node wedge.
    Wedge6,
    /// 15-node wedge.
    Wedge15,
    /// 8-node brick.
    Hexa8,
    /// 20-node brick.
    Hexa20,
}

use CellKind::*;

/// Sides of a triangle, from corner to corner.
const TRIANGLE: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
/// Sides of a quadrilateral.
const QUAD: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
/// Edges of a tetrahedron.
const TETRA: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
/// Edges of a wedge: bottom, top, upright.
const WEDGE: [[usize; 2]; 9] = [
    [0, 1],
    [1, 2],
    [2, 0],
    [3, 4],
    [4, 5],
    [5, 3],
    [0, 3],
    [1, 4],
    [2, 5],
];
/// Edges of a brick: bottom, top, upright.
const HEXA: [[usize; 2]; 12] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

impl CellKind {
    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Point => 1,
            Line2 => 2,
            Line3 | Triangle3 => 3,
            Quad4 | Tetra4 => 4,
            Triangle6 | Wedge6 => 6,
            Quad8 | Hexa8 => 8,
            Quad9 => 9,
            Tetra10 => 10,
            Wedge15 => 15,
            Hexa20 => 20,
        }
    }

    /// 0 for points, 1 for lines, 2 for areas, 3 for solids.
    pub fn dimension(self) -> u8 {
        match self {
            Point => 0,
            Line2 | Line3 => 1,
            Tetra4 | Tetra10 | Wedge6 | Wedge15 | Hexa8 | Hexa20 => 3,
            _ => 2,
        }
    }

    /// Number of corners.
    pub fn corners(self) -> usize {
        match self {
            Point => 1,
            Line2 | Line3 => 2,
            Triangle3 | Triangle6 => 3,
            Quad4 | Quad8 | Quad9 => 4,
            Tetra4 | Tetra10 => 4,
            Wedge6 | Wedge15 => 6,
            Hexa8 | Hexa20 => 8,
        }
    }

    /// Edges of an area or a solid as pairs of corners; the midside node of edge k follows the corners at place k.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Point | Line2 | Line3 => &[],
            Triangle3 | Triangle6 => &TRIANGLE,
            Quad4 | Quad8 | Quad9 => &QUAD,
            Tetra4 | Tetra10 => &TETRA,
            Wedge6 | Wedge15 => &WEDGE,
            Hexa8 | Hexa20 => &HEXA,
        }
    }

    /// Faces of a solid, or sides of an area, by their corners, in the order S1, S2, ... of CalculiX and Abaqus.
    pub fn sides(self) -> Vec<&'static [usize]> {
        match self {
            Tetra4 | Tetra10 => {
                vec![&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]]
            }
            Wedge6 | Wedge15 => vec![
                &[0, 1, 2],
                &[3, 4, 5],
                &[0, 1, 4, 3],
                &[1, 2, 5, 4],
                &[2, 0, 3, 5],
            ],
            Hexa8 | Hexa20 => vec![
                &[0, 1, 2, 3],
                &[4, 7, 6, 5],
                &[0, 4, 5, 1],
                &[1, 5, 6, 2],
                &[2, 6, 7, 3],
                &[3, 7, 4, 0],
            ],
            _ => self.edges().iter().map(|edge| &edge[..]).collect(),
        }
    }
}

/// A cell of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Kind of cell.
    pub kind: CellKind,
    /// Indices of its nodes in [`Mesh::nodes`]; their number is given by the kind.
    pub nodes: Vec<usize>,
}

/// A mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Positions of the nodes, x and y.
    pub nodes: Vec<[f64; 2]>,
    /// Node numbers in the file.
    pub labels: Vec<u64>,
    /// The cells of all kinds.
    pub cells: Vec<Cell>,
    /// Groups of cells, in file order.
    pub groups: Vec<Group>,
}

/// A named group of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Name in the file.
    pub name: String,
    /// Indices into [`Mesh::cells`], ascending, each once.
    pub cells: Vec<usize>,
}
