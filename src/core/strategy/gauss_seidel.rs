//! Projected Gauss-Seidel ([`crate::interface::sweep`]) with several sweeps per minor iteration, accelerated by Newton steps:
//! once the modes are stable, the next minor iteration solves for them, and Table 2 checks them. If they are wrong, the sweeps
//! continue until other modes have been stable for twice as long.
//!
//! If forces are not unique, those of the sweeps are moved to a state whose modes have a unique solution
//! ([`crate::interface::vertex`]).
//!
//! With a compliance given by its entries ([`Sweep::is_given`]), a minor iteration sweeps until the error, the natural map, has
//! fallen by a factor of 10, at most [`MOST_SWEEPS`] times. Below [`SETTLED`] the modes are solved for once more; if they have no
//! unique solution, the forces of the sweeps are accepted. Rounded entries make a singular W indefinite, and the error then falls
//! no further than the rounding: from there on, forces within the accuracy of W are accepted in the same way.

use crate::interface::method::{NoProposal, Proposal, Search, SearchInput};
use crate::interface::vertex::vertices;
use crate::{AssumedMode, NotFound, Rule, SearchProgress, Sweep, TestedQuantity};

/// Sweeps, with a solve when the modes are stable.
pub struct GaussSeidel;

/// Sweeps per minor iteration.
const SWEEPS: usize = 10;
/// Maximum number of minor iterations with sweeps. Most problems need fewer than 100.
const MOST: usize = 500;
/// Minor iterations in a row without forces that obey the law at every node, after which the sweeps stop.
const UNANSWERED: usize = 3;
/// Natural map, relative to the forces, below which the forces of sweeps over a given compliance are accepted.
pub const SETTLED: f64 = 1e-9;
/// Factor by which a minor iteration over a given compliance reduces the error, the maximum number of its sweeps, and the number
/// after which the error is measured.
const FALL: f64 = 0.1;
const MOST_SWEEPS: usize = 500;
const MEASURED: usize = 10;
/// Fraction of the error that is left after [`MOST_SWEEPS`] sweeps that do not improve the forces.
const IDLE: f64 = 0.9;
/// Maximum number of sweeps over a given compliance.
const MOST_GIVEN: usize = 100_000;

/// State of the sweeps.
struct SweepState {
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
    does: Vec<AssumedMode>,
    found: Vec<AssumedMode>,
    /// Change in the last sweep, or the error of a given compliance (relative).
    change: f64,
    /// Whether the sweeps of the last minor iteration over a given compliance did not improve the forces.
    idle: bool,
    /// Sweeps done.
    sweeps: usize,
    /// Minor iterations in a row after which a node had no force that obeys the law.
    unanswered: usize,
}

impl SweepState {
    fn new(sweep: Sweep) -> Self {
        SweepState {
            sweep,
            start: 0,
            step: 0,
            done: 0,
            lasted: 0,
            patience: 1,
            does: Vec::new(),
            found: Vec::new(),
            change: f64::INFINITY,
            idle: false,
            sweeps: 0,
            unanswered: 0,
        }
    }

    fn place(&self) -> (usize, usize) {
        (self.start, self.step)
    }

    /// Performs the sweeps of a minor iteration; returns whether the modes have been stable long enough and differ from the last
    /// proposal.
    fn go(&mut self, nodes: usize) -> bool {
        if self.sweep.is_given() {
            self.reduce()
        } else {
            self.sweep_on(SWEEPS)
        }
        self.done += 1;
        self.step += 1;
        let does: Vec<AssumedMode> = (0..nodes).map(|k| self.sweep.assumed(k)).collect();
        self.unanswered = if self.sweep.is_answered() {
            0
        } else {
            self.unanswered + 1
        };
        self.lasted = if does == self.does && self.unanswered == 0 {
            self.lasted + 1
        } else {
            0
        };
        let lasts = self.unanswered == 0
            && (self.lasted >= self.patience || self.is_settled())
            && does != self.found;
        self.does = does;
        if lasts {
            self.patience *= 2;
            self.found.clone_from(&self.does);
            (self.start, self.step) = (self.start + 1, 0);
        }
        lasts
    }

    fn sweep_on(&mut self, sweeps: usize) {
        for _ in 0..sweeps {
            self.change = self.sweep.sweep();
        }
        self.sweeps += sweeps;
    }

    /// The sweeps of a minor iteration over a given compliance.
    fn reduce(&mut self) {
        if self.is_settled() {
            return;
        }
        if self.sweeps == 0 {
            self.change = self.sweep.settle(SETTLED);
        }
        let (before, most) = (self.change, self.sweeps + MOST_SWEEPS);
        while self.change > (FALL * before).max(SETTLED) && self.sweeps < most {
            self.sweep_on(MEASURED);
            self.change = self.sweep.settle(SETTLED);
        }
        self.idle = self.change > IDLE * before;
    }

    /// Whether the forces of a given compliance obey Coulomb's law, as far as its accuracy allows.
    fn is_settled(&self) -> bool {
        let reached = self.idle && self.change <= self.sweep.accuracy();
        self.sweep.is_given() && (self.change <= SETTLED || reached)
    }

    /// Whether further sweeps would change nothing, or the limit is reached.
    fn is_over(&self) -> bool {
        if self.sweep.is_given() {
            self.sweeps >= MOST_GIVEN && !self.is_settled()
        } else {
            self.change == 0.0 && self.does == self.found
                || self.done >= MOST
                || self.unanswered >= UNANSWERED
        }
    }
}

impl Search for GaussSeidel {
    /// Several sweeps over all nodes.
    fn propose(&self, mut asked: SearchInput<'_>) -> Result<Proposal, NoProposal> {
        let nodes = asked.brought.len();
        let mut going = match asked.take_kept(SweepState::place) {
            Some(going) => going,
            None => Box::new(going(&mut asked)?),
        };
        if going.is_over() {
            return Err(NotFound::Unsettled {
                sweeps: going.sweeps,
                error: going.sweep.is_given().then_some(going.change),
            }
            .into());
        }
        let lasts = going.go(nodes);
        let mut proposed: Vec<_> = (0..nodes)
            .map(|k| (going.sweep.assumed(k), going.sweep.numbers(k)))
            .collect();
        if lasts && !going.sweep.is_given() {
            let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
            vertices(&problem, &mut proposed);
        }
        let proposal = Proposal {
            nodes: proposed,
            rule: match lasts {
                true => Rule::Found,
                false if going.is_settled() => Rule::Settled,
                false => Rule::Sweeps,
            },
            cover: going.change,
            covers: if going.sweep.is_given() {
                TestedQuantity::Error
            } else {
                TestedQuantity::Change
            },
            bound: None,
            next: if lasts {
                SearchProgress::Found { start: asked.start }
            } else {
                SearchProgress::At {
                    start: asked.start,
                    step: going.step,
                }
            },
        };
        *asked.kept = Some(going);
        Ok(proposal)
    }
}

/// The state of the sweeps so far.
fn going(asked: &mut SearchInput<'_>) -> Result<SweepState, NotFound> {
    let mut going = SweepState::new((asked.sweep)()?);
    while going.place() != (asked.start, asked.step) && !going.is_over() {
        going.go(asked.brought.len());
    }
    Ok(going)
}
