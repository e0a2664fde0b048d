//! Small displacements: a linear element with the stiffness of the undeformed state, f = K u.
//!
//! At zero strain both laws have the moduli of linear elasticity, and strains are linear in the displacements, so this is the
//! element of linear elasticity. K is computed once.

use super::element::{self, Previous};

/// An element linearised at the undeformed state.
pub struct SmallStrainElement {
    dofs: usize,
    /// K, row by row; `None` if the original element has no response there.
    stiffness: Option<Box<[f64]>>,
}

impl SmallStrainElement {
    /// Linearises `of` at the undeformed state.
    pub fn new(of: &dyn element::Element) -> Self {
        let dofs = of.dofs();
        let (rest, mut force) = (vec![0.0; dofs], vec![0.0; dofs]);
        let history = vec![0.0; of.history_len()];
        let mut stiffness = vec![0.0; dofs * dofs];
        let past = Previous {
            u: &rest,
            history: &history,
        };
        let answers = of.add(&past, &rest, &mut force, &mut stiffness);
        of.mirror(&mut stiffness);
        SmallStrainElement {
            dofs,
            stiffness: answers.then(|| stiffness.into_boxed_slice()),
        }
    }
}

impl element::Element for SmallStrainElement {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn add(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        if !self.resist(past, u, force, &mut []) {
            return false;
        }
        for (sum, k) in tangent.iter_mut().zip(self.stiffness.iter().flatten()) {
            *sum += k;
        }
        true
    }

    fn resist(&self, _: &Previous<'_>, u: &[f64], force: &mut [f64], _: &mut [f64]) -> bool {
        let Some(stiffness) = &self.stiffness else {
            return false;
        };
        for (sum, row) in force.iter_mut().zip(stiffness.chunks_exact(self.dofs)) {
            *sum += row.iter().zip(u).map(|(k, u)| k * u).sum::<f64>();
        }
        true
    }
}
