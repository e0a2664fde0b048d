//! The form of Lemke's pivoting that does not end on a ray ([`crate::interface::copositive`]), with one pivot per minor
//! iteration, or fifty once the path is longer than the tableau has rows.
//!
//! If forces are not unique, those found by pivoting are moved to a state whose modes have a unique solution
//! ([`crate::interface::vertex`]). Table 2 checks the result in the next minor iteration.

use crate::interface::copositive::{Copositive as Pivoting, STARTS};
use crate::interface::method::{NoProposal, Proposal, Search, SearchInput};
use crate::interface::tableau::PathEnd;
use crate::interface::vertex::vertices;
use crate::{NotFound, Rule, TestedQuantity};

/// Pivoting from all nodes free, with the friction force split into two parts.
pub struct CopositiveStrategy;

/// Pivots per minor iteration on a long path.
const STRIDE: usize = 50;

/// A path, its start, and the number of minor iterations done.
struct CopositivePath {
    pivoting: Pivoting,
    start: usize,
    step: usize,
}

impl CopositivePath {
    /// Performs the pivots of a minor iteration.
    fn go(&mut self) {
        let most = if self.step < self.pivoting.tableau.rows() {
            1
        } else {
            STRIDE
        };
        let done = (0..most)
            .map_while(|_| self.pivoting.tableau.pivot())
            .count();
        self.step += usize::from(done > 0);
    }
}

impl Search for CopositiveStrategy {
    /// One step of the path; if it has ended on a ray, continues with the next start.
    fn propose(&self, mut asked: SearchInput<'_>) -> Result<Proposal, NoProposal> {
        if asked.start >= STARTS {
            return Err(match asked.unconfirmed {
                0 => NotFound::Ray.into(),
                states => NotFound::Unconfirmed { states }.into(),
            });
        }
        let mut path = match asked.take_kept(|path: &CopositivePath| (path.start, path.step)) {
            Some(path) => path,
            None => Box::new(path(&mut asked)?),
        };
        path.go();
        let pivoting = &path.pivoting;
        let ended = pivoting.ended();
        if ended == Some(PathEnd::Astray) {
            let pivots = pivoting.tableau.pivots();
            return Err(NotFound::Astray { pivots }.into());
        }
        let mut nodes: Vec<_> = (0..asked.brought.len())
            .map(|k| (pivoting.assumed(k), pivoting.numbers(k)))
            .collect();
        let solved = ended == Some(PathEnd::Solved);
        if solved {
            let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
            vertices(&problem, &mut nodes);
        }
        let proposal = Proposal {
            nodes,
            rule: if solved { Rule::Found } else { Rule::Pivots },
            cover: pivoting.tableau.cover(),
            covers: TestedQuantity::Cover,
            bound: pivoting.bound(),
            next: PathEnd::next(ended, path.start, path.step),
        };
        *asked.kept = Some(path);
        Ok(proposal)
    }
}

/// The path after the pivots done so far.
fn path(asked: &mut SearchInput<'_>) -> Result<CopositivePath, NotFound> {
    let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
    let mut path = CopositivePath {
        pivoting: Pivoting::new(&problem, asked.start).ok_or(NotFound::NoStart)?,
        start: asked.start,
        step: 0,
    };
    for _ in 0..asked.step {
        path.go();
    }
    Ok(path)
}
