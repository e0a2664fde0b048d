//! Projected Gauss-Seidel ([`crate::interface::sweep`]), some sweeps a minor iteration, made fast by Newton's step: as soon as
//! the modes last, the next minor iteration solves for them, and Table 2 checks them. If they do not hold, the sweeps go on
//! to others, which must last twice as long.
//!
//! Where forces are not unique, those of the sweeps are taken on to a state whose modes have one solution
//! ([`crate::interface::vertex`]).

use crate::contact::table2::Rule;
use crate::interface::method::{Asked, Method, NoProposal, NotFound, Proposal, Search, Searched};
use crate::interface::problem::Assumed;
use crate::interface::sweep::Sweep;
use crate::interface::vertex::vertices;
use crate::model::BoundUpdate;

/// Sweeps with a solve for the modes that last.
pub struct GaussSeidel;

/// Sweeps in a minor iteration.
const SWEEPS: usize = 10;
/// Most minor iterations of sweeps. Most problems take fewer than 100.
const MOST: usize = 500;

/// Sweeps on their way.
struct Going {
    sweep: Sweep,
    /// What was found so far, and the minor iterations since then.
    start: usize,
    step: usize,
    /// All of them.
    done: usize,
    /// Minor iterations for which the modes have lasted, and those for which they must.
    lasted: usize,
    patience: usize,
    /// What the nodes did before, and in what was found last.
    does: Vec<Assumed>,
    found: Vec<Assumed>,
    /// Change in the last sweep (relative).
    change: f64,
}

impl Going {
    fn new(sweep: Sweep) -> Self {
        Going {
            sweep,
            start: 0,
            step: 0,
            done: 0,
            lasted: 0,
            patience: 1,
            does: Vec::new(),
            found: Vec::new(),
            change: f64::INFINITY,
        }
    }

    /// The sweeps of a minor iteration; true if the modes have lasted, and others were found before.
    fn go(&mut self, nodes: usize) -> bool {
        for _ in 0..SWEEPS {
            self.change = self.sweep.sweep();
        }
        self.done += 1;
        self.step += 1;
        let does: Vec<Assumed> = (0..nodes).map(|k| self.sweep.assumed(k)).collect();
        self.lasted = if does == self.does {
            self.lasted + 1
        } else {
            0
        };
        let lasts = self.lasted >= self.patience && does != self.found;
        self.does = does;
        if lasts {
            self.patience *= 2;
            self.found.clone_from(&self.does);
            (self.start, self.step) = (self.start + 1, 0);
        }
        lasts
    }

    /// Whether more sweeps would change nothing, or there have been too many.
    fn is_over(&self) -> bool {
        self.change == 0.0 && self.does == self.found || self.done >= MOST
    }
}

impl Method for GaussSeidel {
    fn bound(&self, _wanted: BoundUpdate) -> BoundUpdate {
        BoundUpdate::Consistent
    }

    fn search(&self) -> Option<&dyn Search> {
        Some(self)
    }
}

impl Search for GaussSeidel {
    /// Some sweeps over all nodes.
    fn propose(&self, mut asked: Asked<'_>) -> Result<Proposal, NoProposal> {
        let nodes = asked.brought.len();
        let kept = asked.kept.take().and_then(|kept| kept.downcast().ok());
        let mut going: Box<Going> = match kept {
            Some(going) if is_at(&going, &asked) => going,
            _ => Box::new(going(&mut asked)?),
        };
        if going.is_over() {
            return Err(match asked.unconfirmed {
                0 => NotFound::Unsettled {
                    sweeps: going.done * SWEEPS,
                }
                .into(),
                states => NotFound::Unconfirmed { states }.into(),
            });
        }
        let lasts = going.go(nodes);
        let mut proposed: Vec<_> = (0..nodes)
            .map(|k| (going.sweep.assumed(k), going.sweep.numbers(k)))
            .collect();
        if lasts {
            let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
            vertices(&problem, &mut proposed);
        }
        let proposal = Proposal {
            nodes: proposed,
            rule: if lasts { Rule::Found } else { Rule::Sweeps },
            cover: going.change,
            bound: None,
            next: match lasts {
                true => Searched::Found { start: asked.start },
                false => Searched::At {
                    start: asked.start,
                    step: going.step,
                },
            },
        };
        *asked.kept = Some(going);
        Ok(proposal)
    }
}

fn is_at(going: &Going, asked: &Asked<'_>) -> bool {
    (going.start, going.step) == (asked.start, asked.step)
}

/// The sweeps that have come so far.
fn going(asked: &mut Asked<'_>) -> Result<Going, NotFound> {
    let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
    let mut going = Going::new(Sweep::new(&problem).ok_or(NotFound::NoStart)?);
    while !is_at(&going, asked) && !going.is_over() {
        going.go(asked.brought.len());
    }
    Ok(going)
}
