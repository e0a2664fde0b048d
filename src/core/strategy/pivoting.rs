//! Lemke's pivoting on the linear complementarity problem of Coulomb's law ([`crate::interface::pivoting`]) from several starts,
//! with one pivot per minor iteration; in the form that does not end on a ray fifty, once the path is longer than the tableau has
//! rows. Table 2 checks the result in the next minor iteration.
//!
//! If forces are not unique, those found in that form are moved to a state whose modes have a unique solution
//! ([`crate::interface::vertex`]).

use crate::interface::method::{NoProposal, Proposal, Search, SearchInput};
use crate::interface::pivoting::{CoulombForm, PathEnd, Pivoting};
use crate::interface::vertex::vertices;
use crate::{NotFound, Rule, TestedQuantity};

/// Pivoting with the law in one form.
pub struct PivotingStrategy(pub CoulombForm);

/// Pivots per minor iteration on a long path.
const STRIDE: usize = 50;

/// A path, its start, and the number of minor iterations done.
struct PivotPath {
    pivoting: Pivoting,
    start: usize,
    step: usize,
}

impl PivotPath {
    /// Performs the pivots of a minor iteration.
    fn go(&mut self) {
        let tableau = &mut self.pivoting.tableau;
        let long = self.pivoting.form == CoulombForm::Copositive && self.step >= tableau.rows();
        let most = if long { STRIDE } else { 1 };
        // A path that starts at the solution has already ended.
        let done = (0..most).map_while(|_| tableau.pivot()).count();
        self.step += usize::from(done > 0);
    }
}

impl Search for PivotingStrategy {
    /// One step of the path; if it has ended on a ray, continues with the next start.
    fn propose(&self, mut asked: SearchInput<'_>) -> Result<Proposal, NoProposal> {
        let kept = asked.take_kept(|path: &PivotPath| (path.start, path.step));
        let mut path = match kept.filter(|path| path.pivoting.form == self.0) {
            Some(path) => path,
            None => Box::new(self.path(&mut asked)?),
        };
        path.go();
        let pivoting = &path.pivoting;
        let ended = pivoting.ended();
        let is_copositive = self.0 == CoulombForm::Copositive;
        if is_copositive && ended == Some(PathEnd::Astray) {
            let pivots = pivoting.tableau.pivots();
            return Err(NotFound::Astray { pivots }.into());
        }
        let mut nodes: Vec<_> = (0..asked.brought.len())
            .map(|k| (pivoting.assumed(k), pivoting.numbers(k)))
            .collect();
        let solved = ended == Some(PathEnd::Solved);
        if solved && is_copositive {
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

impl PivotingStrategy {
    /// The path after the steps done so far, for a start or the next one with a regular basis.
    fn path(&self, asked: &mut SearchInput<'_>) -> Result<PivotPath, NotFound> {
        let none = match (asked.start, asked.unconfirmed) {
            (0, _) => NotFound::NoStart,
            (_, 0) => NotFound::Ray,
            (_, states) => NotFound::Unconfirmed { states },
        };
        let starts = asked.start..self.0.starts();
        if starts.is_empty() {
            return Err(none);
        }
        let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
        let mut paths = starts.filter_map(|start| {
            let pivoting = Pivoting::new(self.0, &problem, asked.brought, start)?;
            Some(PivotPath {
                pivoting,
                start,
                step: 0,
            })
        });
        let mut path = paths.next().ok_or(none)?;
        if path.start == asked.start {
            (0..asked.step).for_each(|_| path.go());
        }
        Ok(path)
    }
}
