//! Third coordinates of a scene in space, which only attached solvers have.

/// What a scene in space has beyond the plane: nodes have three coordinates and three degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Space {
    /// z of each node (length).
    pub heights: Vec<f64>,
}

impl super::Model {
    /// Turns a scene of contacts ([`super::Model::from_contacts`]) into one in space; `heights` are the z of its nodes.
    pub fn raise(&mut self, heights: Vec<f64>) {
        let ends = |low: f64, high: f64| {
            heights
                .iter()
                .fold((low, high), |(l, h), z| (l.min(*z), h.max(*z)))
        };
        let (low, high) = ends(f64::INFINITY, f64::NEG_INFINITY);
        let flat = super::diagonal(self.nodes.iter());
        let length = flat.hypot(high - low);
        self.length = if length > 0.0 { length } else { 1.0 };
        let count = self.nodes.len();
        self.dofs.first = (0..count).map(|node| 3 * node).collect();
        self.dofs.count = vec![3; count];
        self.dofs.equation = vec![None; 3 * count];
        self.space = Some(Space { heights });
    }

    /// Reference position of a node; z is 0 in the plane.
    pub fn at_in_space(&self, node: usize) -> [f64; 3] {
        let [x, y] = self.nodes[node].at;
        let heights = self.space.as_ref().map(|space| &space.heights);
        let z = heights.and_then(|heights| heights.get(node));
        [x, y, z.copied().unwrap_or(0.0)]
    }

    /// Current position of a node ([`super::Model::place`]); z is 0 in the plane.
    pub fn place_in_space(&self, u: &[f64], node: usize) -> [f64; 3] {
        let [x, y] = self.place(u, node);
        let [_, _, z] = self.at_in_space(node);
        let risen = self
            .space
            .as_ref()
            .and_then(|_| u.get(self.dofs.first[node] + 2));
        [x, y, z + risen.copied().unwrap_or(0.0)]
    }
}
