//! A minor iteration: solves, checks the modes, and detects convergence of modes and T_max.

use crate::interface::line_search::{LineSearch, natural_map};
use crate::interface::minor::{self, Check};
use crate::interface::rows::carried;
use crate::interface::t_max_iteration::{TMaxLimit, spiral};
use crate::linear::sizes::ROUND_OFF;
use crate::model::{self, AtCycle, AtLimit, Body, SlipCount};
use crate::plane::max_abs;
use crate::step::iterate::Iterate;
use crate::step::major::DIVERGED;
use crate::{
    ContactRecord, Cycle, Failure, Method, Mode, NodeIncrement, Outcome, Singular, SolveResult,
    State, Stepper, Ties,
};
use std::sync::Arc;

/// Two states of a minor loop with a smaller relative difference are equal. The limit is far below any tolerance, so that a
/// slowly converging T_max settles before two rounds look alike.
const REPEATED: f64 = 1e-14;
/// Forces larger than this multiple of the interface's stiffness times the scene's length are unbounded.
const UNBOUNDED: f64 = 1e10;
/// Number of minor iterations after which a cycle with a slowly converging T_max is searched for; also done at the settings' limit.
const LOOK: u32 = 100;
/// Number of iterations computed ahead for this search, and maximum number of nodes for which its cost is negligible.
const AHEAD: usize = 600;
const MOST_AHEAD: usize = 40;
/// Maximum number of rounds of simultaneous changes without a decrease of their number.
const PATIENCE: u32 = 10;

impl Stepper {
    /// Checks and records the mode of every contact; true if modes and T_max have converged.
    ///
    /// Leaves the modes of the next minor iteration in the state.
    pub(super) fn check(&mut self) -> bool {
        let settings = self.now.state.settings();
        let method = self.method();
        let check = Check {
            settings,
            method: &*method,
            ties: self.now.ties(),
            stiffness: if method.compares_by_springs() {
                self.now.source.spring()
            } else {
                1.0
            },
        };
        let mut settled = step_on_line(&mut self.now, check.stiffness) == 1.0;
        let line = self.now.state.major.line.clone();
        let controls = self.now.state.controls.clone();
        let singly = method.is_single(self.now.state.is_stalled());
        if singly {
            self.before.clone_from(&self.now.state.nodes);
        }
        for (contact, node) in self.now.state.nodes.iter_mut().enumerate() {
            let over = self.now.source.kinematics(contact);
            let increment = match &line {
                Some(line) => line.at(contact),
                None => self.now.source.increment(contact),
            };
            let friction = node.friction(&controls.friction[contact]);
            let (record, still) = minor::check(node, over.as_ref(), increment, &friction, &check);
            settled &= still;
            self.event.nodes.push(record);
        }
        if method.counts_changes() {
            self.now.state.count_changes(&self.event.nodes);
        }
        if singly {
            minor::one_at_a_time(
                &mut self.now.state.nodes,
                &self.before,
                &mut self.event.nodes,
            );
        }
        settled
    }

    /// The minor loop has not converged: looks for a cycle, checks the limit, and counts on.
    pub(super) fn go_on(&mut self) -> Outcome {
        let settings = self.now.state.settings();
        let method = self.method();
        if method.search().is_some() {
            return self.now.state.begin_search();
        }
        let accept = settings.at_minor_limit == AtLimit::Accept;
        let tried = self
            .now
            .state
            .major
            .minor_history
            .len(self.now.state.nodes.len()) as u32;
        let at_limit = tried > 0 && tried.is_multiple_of(settings.minors);
        if at_limit && accept {
            return self.end_major(false);
        }
        let moves_on = method.counts_changes() && !self.now.state.is_stalled();
        if at_limit && let Some(line) = self.now.state.major.line.take() {
            return self.escalate(Failure::Cycle(line.cycle.clone()));
        }
        if !accept
            && !moves_on
            && self.now.state.major.line.is_none()
            && let Some(cycle) = self
                .now
                .find_cycle()
                .or_else(|| (at_limit || tried == LOOK).then(|| self.now.find_spiral(&*method))?)
        {
            if settings.at_cycle == AtCycle::Damp && self.now.damp() {
                self.now.state.next.minor += 1;
                return Outcome::Damped {
                    cycle,
                    target: self.now.state.major.target,
                };
            }
            // With the literal reading of Table 2's slip, the judge forgives states that a step may lead to.
            if method.searches_line() && settings.slip == SlipCount::Increment {
                self.now.state.begin_again();
                self.now.state.major.line = Some(Arc::new(LineSearch::new(cycle)));
                self.now.state.next.minor += 1;
                return Outcome::Minor;
            }
            return self.escalate(Failure::Cycle(cycle));
        }
        if at_limit {
            let changing = self.event.changing(self.now.ties().force);
            return self.escalate(Failure::MinorLimit {
                limit: settings.minors,
                changing,
            });
        }
        self.now.state.next.minor += 1;
        Outcome::Minor
    }
}

impl Iterate {
    /// Why a solve has no solution, or no meaningful one.
    pub(super) fn unsolvable(&self, solved: SolveResult) -> Option<Failure> {
        let singular = match solved {
            SolveResult::Well => None,
            SolveResult::NearlySingular => {
                Some(self.explain()).filter(|why| matches!(why, Singular::Rigid { .. }))
            }
            SolveResult::Not => Some(self.explain()),
        };
        singular
            .map(Failure::Singular)
            .or_else(|| self.over_constrained())
    }

    /// Motions without any resistance, for the modes of this minor iteration.
    pub(super) fn explain(&self) -> Singular {
        self.source.explain(&self.state.nodes)
    }

    /// A touching contact with a gap that no unknown can close.
    fn over_constrained(&self) -> Option<Failure> {
        let tolerance = self.state.controls.settings.tolerance * self.model.length;
        self.state
            .nodes
            .iter()
            .enumerate()
            .find_map(|(slave, node)| {
                let over = self.source.kinematics(slave)?;
                let holds = carried(node.mode, over.moves)[0] && over.gap < -tolerance;
                holds.then_some(Failure::OverConstrained {
                    slave,
                    gap: over.gap,
                })
            })
    }

    /// Whether the last solve returned excessive forces or motions: those of a singular system, kept finite by round-off.
    pub(super) fn is_unbounded(&self) -> bool {
        let length = self.model.length;
        let exceeds = |values: [f64; 2], limit: f64| values.iter().any(|value| value.abs() > limit);
        (0..self.state.nodes.len()).any(|contact| {
            let NodeIncrement { force, motion, .. } = self.source.increment(contact);
            exceeds(force, UNBOUNDED * self.source.spring() * length)
                || exceeds(motion, DIVERGED * length)
        })
    }

    /// Failure before a ladder found a state without contact pressure: if the equations were singular, such a state does not
    /// support the loose bodies. A body given by its compliance is not loose.
    pub(super) fn unsupported(&self, records: &[ContactRecord]) -> Option<Failure> {
        let first = self.state.attempt.search.first.as_deref()?;
        let force = self.ties().force;
        let loose = matches!(first, Failure::Singular(_))
            && !self.model.bodies.iter().all(Body::is_compliance)
            && !records.iter().any(|record| record.f_n > force);
        loose.then(|| first.clone())
    }

    fn ties(&self) -> Ties {
        let settings = &self.state.controls.settings;
        let tolerance = settings.tolerance.max(self.placed());
        Ties {
            force: tolerance * self.force_scale(),
            length: tolerance * self.model.length,
            keep: settings.ties == model::TieRule::Keep,
        }
    }

    /// Round-off of the slave nodes' positions relative to the scene's length. Far from the origin it sets the tolerance for ties
    /// between contact statuses.
    fn placed(&self) -> f64 {
        let contacts = 0..self.state.nodes.len();
        let reach = max_abs(contacts.flat_map(|contact| self.source.position(contact)));
        ROUND_OFF * f64::EPSILON * reach / self.model.length
    }

    /// Force scale: with prescribed displacements, only the interface may carry forces before the first solve.
    pub(super) fn force_scale(&self) -> f64 {
        self.state
            .nodes
            .iter()
            .enumerate()
            .fold(self.norms.scale, |scale, (contact, node)| {
                let [d_n, d_t] = self.source.increment(contact).force;
                scale
                    .max((node.f_n + d_n).abs())
                    .max((node.f_t + d_t).abs())
            })
    }

    /// Finds a cycle: whether the next minor iteration starts from the same state as an earlier one of this major iteration.
    fn find_cycle(&self) -> Option<Cycle> {
        let force = REPEATED * self.force_scale();
        let (state, minor) = (&self.state, self.state.next.minor);
        state
            .major
            .minor_history
            .cycle(&state.nodes, minor, force, REPEATED)
    }

    /// Finds a cycle of modes that repeats endlessly while T_max still converges; this is certain, since T_max changes linearly.
    fn find_spiral(&mut self, method: &dyn Method) -> Option<Cycle> {
        let count = self.state.nodes.len();
        if count > MOST_AHEAD {
            return None;
        }
        let problem = self.source.problem(&self.state.at()).ok()?;
        let found = spiral(&problem, method, AHEAD)?;
        let period = found.period as usize;
        let history = &self.state.major.minor_history;
        // Phase in the cycle of the iteration `back` before the next one: rounds end `start` iterations from now.
        let phase = |back: usize| (2 * period - back - found.start as usize % period) % period;
        let patterns = || problem.nodes.iter().zip(&found.modes);
        let went_round = (1..=period).all(|back| {
            let inputs = history.before(count, back);
            inputs.is_some_and(|inputs| {
                patterns().all(|(node, modes)| {
                    let input: &crate::interface::minor_history::Input = &inputs[node.slave];
                    input.mode == modes[phase(back)]
                })
            })
        });
        if found.fate != TMaxLimit::Cycles || !went_round {
            return None;
        }
        let pattern = |modes: &[Mode]| (1..=period).rev().map(|b| modes[phase(b)]).collect();
        let takes_part = |place: usize, modes: &[Mode]| {
            modes.iter().any(|mode| *mode != modes[0]) || found.places.contains(&place)
        };
        let members = patterns()
            .enumerate()
            .filter(|(place, (_, modes))| takes_part(*place, modes));
        Some(Cycle {
            start: self.state.next.minor + 1 - found.period,
            period: found.period,
            members: members
                .map(|(_, (node, modes))| (node.slave, pattern(modes)))
                .collect(),
        })
    }
}

/// A step of the line search towards the solution of this minor iteration, with the interface's stiffness (force per length);
/// returns its length, 1 without a line search.
fn step_on_line(now: &mut Iterate, stiffness: f64) -> f64 {
    let Some(mut line) = now.state.major.line.take() else {
        return 1.0;
    };
    let (state, source) = (&now.state, &now.source);
    let settings = state.settings();
    let error = |(contact, given): (usize, &NodeIncrement)| {
        let node = &state.nodes[contact];
        let Some(over) = source.kinematics(contact).filter(|k| !k.bond.is_tied()) else {
            return 0.0;
        };
        let [normal, tangential] = given.motion;
        let slip = node.slipped(&settings) + tangential - over.gap * node.ratio;
        let [f_n, f_t] = [node.f_n + given.force[0], node.f_t + given.force[1]];
        let friction = node.friction(&state.controls.friction[contact]);
        natural_map([f_n, f_t, over.gap - normal, slip], &friction, stiffness)
    };
    let to = (0..state.nodes.len()).map(|contact| source.increment(contact));
    let part =
        Arc::make_mut(&mut line).step(to.collect(), |at| at.iter().enumerate().map(error).sum());
    now.state.major.line = Some(line);
    part
}

impl State {
    /// Records the start of this minor iteration, to detect a cycle.
    pub(super) fn remember(&mut self) {
        Arc::make_mut(&mut self.major.minor_history).push(&self.nodes);
    }

    /// Whether simultaneous changes have continued for long without becoming fewer.
    fn is_stalled(&self) -> bool {
        self.attempt.search.rounds > PATIENCE
    }

    /// Counts the rounds since the minimum number of changing nodes in this major iteration. Rounds before a change of pace do
    /// not indicate cycles.
    fn count_changes(&mut self, records: &[ContactRecord]) {
        let changing = records
            .iter()
            .filter(|record| record.decision.changes())
            .count();
        let stalled = self.is_stalled();
        let search = &mut self.attempt.search;
        if search.fewest.is_none_or(|fewest| changing < fewest) {
            (search.fewest, search.rounds) = (Some(changing), 0);
        } else {
            search.rounds += 1;
        }
        if self.is_stalled() != stalled {
            self.forget_minors();
        }
    }
}
