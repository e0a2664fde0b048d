//! The element interface for the assembly: forces and their exact derivative for the element's displacements.

/// State of an element at the last accepted increment. Most elements do not use it.
#[derive(Debug, Clone, Copy)]
pub struct Previous<'a> {
    /// Displacements of the element.
    pub u: &'a [f64],
    /// [`Element::history_len`] numbers, all zero before the first increment.
    pub history: &'a [f64],
}

/// A finite element with its own order of degrees of freedom.
pub trait Element: Send + Sync {
    /// Number of degrees of freedom.
    fn dofs(&self) -> usize;

    /// Number of history variables.
    fn history_len(&self) -> usize {
        0
    }

    /// Adds the internal forces f at displacements `u` to `force`, and ∂f/∂u to `tangent` (row by row, [`Element::dofs`] squared
    /// entries). The part below the diagonal may be left to [`Element::mirror`]. Returns false, with incomplete sums, if there is
    /// no response to these displacements.
    fn add(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool;

    /// Adds only the internal forces, with the same bits; `room` is workspace for a tangent, with undefined content on return.
    fn resist(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64], room: &mut [f64]) -> bool {
        self.add(past, u, force, room)
    }

    /// Fills in the part of a symmetric tangent that [`Element::add`] omits.
    fn mirror(&self, _tangent: &mut [f64]) {}

    /// Updates the history variables when `u` is accepted.
    fn advance(&self, _past: &Previous<'_>, _u: &[f64], _history: &mut [f64]) {}
}

/// Output of [`assemble`](crate::fem::assembly::Assembly::assemble), all of it overwritten.
pub struct ElementOutput<'a> {
    /// Internal force at each degree of freedom, including restrained ones (where the support carries it). Infinite at an element
    /// without a response to its displacements.
    pub force: &'a mut [f64],
    /// Sum of the magnitudes of the element forces at each degree of freedom: the scale of `force`.
    pub size: &'a mut [f64],
    /// Values of the tangent stiffness, in the order of the bound pattern.
    pub values: &'a mut [f64],
    /// Force at each equation due to `step` of the degrees of freedom without an equation.
    pub coupling: &'a mut [f64],
}
