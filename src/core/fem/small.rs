//! Small displacements: an element by its stiffness at rest, f = K u.
//!
//! About rest both laws have the moduli of linear elasticity, and strains are linear in the displacements, so that this is
//! the element of linear elasticity. K is found once.

use super::element::{self, Past};

/// An element that answers as another one does about rest.
pub struct Element {
    dofs: usize,
    /// K, row by row; `None` where the other has no answer at rest.
    stiffness: Option<Box<[f64]>>,
}

impl Element {
    /// The linear element that `of` is about rest.
    pub fn new(of: &dyn element::Element) -> Self {
        let dofs = of.dofs();
        let (rest, mut force) = (vec![0.0; dofs], vec![0.0; dofs]);
        let history = vec![0.0; of.history_len()];
        let mut stiffness = vec![0.0; dofs * dofs];
        let past = Past {
            u: &rest,
            history: &history,
        };
        let answers = of.add(&past, &rest, &mut force, &mut stiffness);
        of.mirror(&mut stiffness);
        Element {
            dofs,
            stiffness: answers.then(|| stiffness.into_boxed_slice()),
        }
    }
}

impl element::Element for Element {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn add(&self, past: &Past<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        if !self.resist(past, u, force, &mut []) {
            return false;
        }
        for (sum, k) in tangent.iter_mut().zip(self.stiffness.iter().flatten()) {
            *sum += k;
        }
        true
    }

    fn resist(&self, _: &Past<'_>, u: &[f64], force: &mut [f64], _: &mut [f64]) -> bool {
        let Some(stiffness) = &self.stiffness else {
            return false;
        };
        for (sum, row) in force.iter_mut().zip(stiffness.chunks_exact(self.dofs)) {
            *sum += row.iter().zip(u).map(|(k, u)| k * u).sum::<f64>();
        }
        true
    }
}
