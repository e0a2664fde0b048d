//! Projected Gauss-Seidel ([`crate::interface::sweep`]) with several sweeps per minor iteration, accelerated by Newton steps:
//! once the modes are stable, the next minor iteration solves for them, and Table 2 checks them. If they are wrong, the sweeps
//! continue until other modes have been stable for twice as long.
//!
//! If forces are not unique, those of the sweeps are moved to a state whose modes have a unique solution
//! ([`crate::interface::vertex`]).

use crate::contact::table2::Rule;
use crate::interface::method::{Asked, Method, NoProposal, NotFound, Proposal, Search, Searched};
use crate::interface::problem::Assumed;
use crate::interface::sweep::Sweep;
use crate::interface::vertex::vertices;
use crate::model::BoundUpdate;

/// Sweeps, with a solve when the modes are stable.
pub struct GaussSeidel;

/// Sweeps per minor iteration.
const SWEEPS: usize = 10;
/// Maximum number of minor iterations with sweeps. Most problems need fewer than 100.
const MOST: usize = 500;

/// State of the sweeps.
struct Going {
    sweep: Sweep,
    /// Number of proposals so far, and of minor iterations since the last one.
    start: usize,
    step: usize,
    /// Total number of minor iterations.
    done: usize,
    /// Number of minor iterations for which the modes have been stable, and the required number.
    lasted: usize,
    patience: usize,
    /// The previous modes, and those of the last proposal.
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

    /// Performs the sweeps of a minor iteration; returns whether the modes have been stable long enough and differ from the last
    /// proposal.
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

    /// Whether further sweeps would change nothing, or the limit is reached.
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
    /// Several sweeps over all nodes.
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

/// The state of the sweeps so far.
fn going(asked: &mut Asked<'_>) -> Result<Going, NotFound> {
    let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
    let mut going = Going::new(Sweep::new(&problem).ok_or(NotFound::NoStart)?);
    while !is_at(&going, asked) && !going.is_over() {
        going.go(asked.brought.len());
    }
    Ok(going)
}
