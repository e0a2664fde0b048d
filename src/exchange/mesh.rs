//! A mesh of another program in the plane: nodes, cells, and groups of cells by name.

/// What a cell is. Corners come first, anticlockwise, then the middles of the sides that start at them, then the middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// One node.
    Point,
    /// A straight side: its two ends.
    Line2,
    /// A side of second order: its two ends, then its middle.
    Line3,
    /// A triangle of three nodes.
    Triangle3,
    /// A triangle of six nodes.
    Triangle6,
    /// A quadrilateral of four nodes.
    Quad4,
    /// A quadrilateral of eight nodes.
    Quad8,
    /// A quadrilateral of nine nodes.
    Quad9,
}

impl CellKind {
    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            CellKind::Point => 1,
            CellKind::Line2 => 2,
            CellKind::Line3 | CellKind::Triangle3 => 3,
            CellKind::Quad4 => 4,
            CellKind::Triangle6 => 6,
            CellKind::Quad8 => 8,
            CellKind::Quad9 => 9,
        }
    }

    /// 0 for a point, 1 for a side, 2 for what has an area.
    pub fn dimension(self) -> u8 {
        match self {
            CellKind::Point => 0,
            CellKind::Line2 | CellKind::Line3 => 1,
            _ => 2,
        }
    }
}

/// A cell of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// What it is.
    pub kind: CellKind,
    /// Positions of its nodes in [`Mesh::nodes`], as many as its kind has.
    pub nodes: Vec<usize>,
}

/// A mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Where the nodes stand, x and y.
    pub nodes: Vec<[f64; 2]>,
    /// The number that the file gives each node.
    pub labels: Vec<u64>,
    /// The cells of all kinds.
    pub cells: Vec<Cell>,
    /// Groups of cells, in the order of the file.
    pub groups: Vec<Group>,
}

/// Cells with a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Its name in the file.
    pub name: String,
    /// Positions in [`Mesh::cells`], ascending, each once.
    pub cells: Vec<usize>,
}
