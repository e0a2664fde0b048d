//! What an element is to the assembly: forces and their exact derivative for displacements of its own.

/// What an element remembers of the last accepted increment. Most look at none of it.
#[derive(Debug, Clone, Copy)]
pub struct Past<'a> {
    /// Displacements of the element there.
    pub u: &'a [f64],
    /// [`Element::history_len`] numbers, all zero before the first increment.
    pub history: &'a [f64],
}

/// A finite element with degrees of freedom of its own order.
pub trait Element: Send + Sync {
    /// Number of degrees of freedom.
    fn dofs(&self) -> usize;

    /// How many numbers it remembers from increment to increment.
    fn history_len(&self) -> usize {
        0
    }

    /// Internal forces f at displacements `u`, added to `force`, and ∂f/∂u, added to `tangent` (row by row, [`Element::dofs`]
    /// squared entries). What lies below the diagonal of the tangent may be left to [`Element::mirror`]. False, with parts
    /// of the sums missing, where there is no force for such displacements.
    fn add(&self, past: &Past<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool;

    /// Internal forces alone, with the same bits; `room` is for a tangent, and left with anything in it.
    fn resist(&self, past: &Past<'_>, u: &[f64], force: &mut [f64], room: &mut [f64]) -> bool {
        self.add(past, u, force, room)
    }

    /// Fills in what [`Element::add`] leaves out of a symmetric tangent.
    fn mirror(&self, _tangent: &mut [f64]) {}

    /// Writes what to remember once `u` is accepted.
    fn advance(&self, _past: &Past<'_>, _u: &[f64], _history: &mut [f64]) {}
}

/// What [`assemble`](crate::fem::assembly::Assembly::assemble) fills, all of it overwritten.
pub struct Assembled<'a> {
    /// Internal force at each degree of freedom, restrained ones included (there it is what the support carries).
    /// Infinite at an element that has no answer to its displacements.
    pub force: &'a mut [f64],
    /// Sum of the sizes of the element forces at each degree of freedom: the scale of `force`.
    pub size: &'a mut [f64],
    /// Values of the tangent stiffness in the bound pattern.
    pub values: &'a mut [f64],
    /// Force at each equation due to `step` of the degrees of freedom that have none.
    pub coupling: &'a mut [f64],
}
