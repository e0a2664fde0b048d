//! Lemke's pivoting in the form that does not end on a ray ([`crate::interface::copositive`]), a pivot a minor iteration.
//!
//! Where forces are not unique, those that pivoting comes to are taken on to a state whose modes have one solution
//! ([`crate::interface::vertex`]). What is found is checked by Table 2 in the minor iteration after.

use crate::contact::table2::Rule;
use crate::interface::copositive::{Copositive as Pivoting, STARTS};
use crate::interface::method::{Asked, Method, NoProposal, NotFound, Proposal, Search, Searched};
use crate::interface::tableau::PathEnd;
use crate::interface::vertex::vertices;
use crate::model::BoundUpdate;

/// Pivoting from all nodes free, with the friction force in two parts.
pub struct Copositive;

/// A path, its start, and the pivots done.
struct Path {
    pivoting: Pivoting,
    start: usize,
    step: usize,
}

impl Method for Copositive {
    fn bound(&self, _wanted: BoundUpdate) -> BoundUpdate {
        BoundUpdate::Consistent
    }

    fn search(&self) -> Option<&dyn Search> {
        Some(self)
    }
}

impl Search for Copositive {
    /// One pivot; after a path that has ended without an answer, the next start follows.
    fn propose(&self, mut asked: Asked<'_>) -> Result<Proposal, NoProposal> {
        if asked.start >= STARTS {
            return Err(match asked.unconfirmed {
                0 => NotFound::Ray.into(),
                states => NotFound::Unconfirmed { states }.into(),
            });
        }
        let kept = asked.kept.take().and_then(|kept| kept.downcast().ok());
        let mut path: Box<Path> = match kept {
            Some(path) if path_is_at(&path, &asked) => path,
            _ => Box::new(path(&mut asked)?),
        };
        if path.pivoting.pivot().is_some() {
            path.step += 1;
        }
        let pivoting = &path.pivoting;
        let ended = pivoting.ended();
        let nodes = (0..asked.brought.len()).map(|k| (pivoting.assumed(k), pivoting.numbers(k)));
        let mut nodes: Vec<_> = nodes.collect();
        let solved = ended == Some(PathEnd::Solved);
        if solved {
            let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
            vertices(&problem, &mut nodes);
        }
        let proposal = Proposal {
            nodes,
            rule: if solved { Rule::Found } else { Rule::Pivots },
            cover: pivoting.cover(),
            bound: pivoting.bound(),
            next: match ended {
                None => Searched::At {
                    start: path.start,
                    step: path.step,
                },
                Some(PathEnd::Solved) => Searched::Found { start: path.start },
                Some(PathEnd::Ray | PathEnd::Astray) => Searched::At {
                    start: path.start + 1,
                    step: 0,
                },
            },
        };
        *asked.kept = Some(path);
        Ok(proposal)
    }
}

fn path_is_at(path: &Path, asked: &Asked<'_>) -> bool {
    (path.start, path.step) == (asked.start, asked.step)
}

/// The path after so many pivots.
fn path(asked: &mut Asked<'_>) -> Result<Path, NotFound> {
    let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
    let mut pivoting = Pivoting::new(&problem, asked.start).ok_or(NotFound::NoStart)?;
    for _ in 0..asked.step {
        pivoting.pivot();
    }
    Ok(Path {
        pivoting,
        start: asked.start,
        step: asked.step,
    })
}
