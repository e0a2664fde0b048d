//! Lemke's pivoting on the linear complementarity problem of Coulomb's law ([`crate::interface::lemke`]), with one pivot per
//! minor iteration. Table 2 checks the result in the next minor iteration.

use crate::interface::lemke::{Lemke, PathEnd, STARTS};
use crate::interface::method::{NoProposal, Proposal, Search, SearchInput};
use crate::{NotFound, Rule, TestedQuantity};

/// Pivoting from several starts.
pub struct LemkeStrategy;

/// A tableau, the start that it came from, and the pivots done.
struct LemkePath {
    lemke: Lemke,
    start: usize,
    step: usize,
}

impl Search for LemkeStrategy {
    /// One pivot; if a path has ended on a ray, continues with the next start.
    fn propose(&self, mut asked: SearchInput<'_>) -> Result<Proposal, NoProposal> {
        let mut path = match asked.take_kept(|path: &LemkePath| (path.start, path.step)) {
            Some(path) => path,
            None => Box::new(path(&mut asked)?),
        };
        // A path that starts at the solution has already ended.
        if path.lemke.tableau.pivot().is_some() {
            path.step += 1;
        }
        let lemke = &path.lemke;
        let ended = lemke.tableau.ended();
        let nodes = (0..asked.brought.len()).map(|k| (lemke.assumed(k), lemke.numbers(k)));
        let proposal = Proposal {
            nodes: nodes.collect(),
            rule: match ended {
                Some(PathEnd::Solved) => Rule::Found,
                _ => Rule::Pivots,
            },
            cover: lemke.tableau.cover(),
            covers: TestedQuantity::Cover,
            bound: lemke.bound(),
            next: PathEnd::next(ended, path.start, path.step),
        };
        *asked.kept = Some(path);
        Ok(proposal)
    }
}

/// The tableau after the pivots done so far, for a start or the next one with a regular basis.
fn path(asked: &mut SearchInput<'_>) -> Result<LemkePath, NotFound> {
    let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
    let mut starts = (asked.start..STARTS).filter_map(|number| {
        let lemke = Lemke::new(&problem, asked.brought, number)?;
        Some((lemke, number))
    });
    let Some((mut lemke, start)) = starts.next() else {
        return Err(match (asked.start, asked.unconfirmed) {
            (0, _) => NotFound::NoStart,
            (_, 0) => NotFound::Ray,
            (_, states) => NotFound::Unconfirmed { states },
        });
    };
    let step = if start == asked.start { asked.step } else { 0 };
    for _ in 0..step {
        lemke.tableau.pivot();
    }
    Ok(LemkePath { lemke, start, step })
}
