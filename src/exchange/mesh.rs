//! A plane mesh of another program: nodes, cells, and named groups of cells.

/// Kind of a cell. Nodes are ordered: the corners, anticlockwise; then the midside nodes, starting on the side after the first
/// corner; then the centre.
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

    /// 0 for points, 1 for lines, 2 for areas.
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
