//! Handles modes that do not converge: the next strategy of the ladder, or a search over all nodes.

use crate::contact::table1::t_max;
use crate::interface::method::{NoProposal, Proposal, SearchInput};
use crate::model::Geometry;
use crate::step::iterate::Iterate;
use crate::step::recovery::FROZEN;
use crate::step::recovery::left_out::OmittedStep;
use crate::step::state::Progress;
use crate::strategy;
use crate::{
    AssumedMode, ContactRecord, ContactState, Decision, Failure, Forced, Mode, NodeKinematics,
    NotFound, Outcome, Rule, SearchProgress, Singular, State, Stepper, Strategy, Test,
};
use std::cell::RefCell;

impl Stepper {
    /// The strategy cannot continue: the next one of the ladder restarts the major iteration. If there is none, the increment
    /// fails.
    pub(super) fn escalate(&mut self, why: Failure) -> Outcome {
        let searches = self.method().search().is_some();
        // Forces that are not unique have no solve that confirms them, but sweeps find them.
        let sweeps_on = matches!(why, Failure::Singular(_)) && self.now.source.takes_forces();
        if searches && (self.now.state.attempt.search.searched == SearchProgress::Not || sweeps_on)
        {
            return self.now.state.begin_search();
        }
        let chosen = self.now.state.controls.settings.strategy;
        let held = |node: &ContactState| matches!(node.forced, Forced::Held(_));
        if strategy::rungs(chosen).is_empty() || self.now.state.nodes.iter().any(held) {
            let unsolved = matches!(why, Failure::Singular(_) | Failure::OverConstrained { .. });
            self.now.state.next.minor += u32::from(!unsolved);
            self.now.state.forget_minors();
            return self.fail(why);
        }
        let unsupported = self.now.stalled().starts_unsupported(&why);
        self.now.state.begin_again();
        let search = &mut self.now.state.attempt.search;
        let first = search.first.get_or_insert_with(|| Box::new(why.clone()));
        // A census that has tried every combination leaves nothing to find.
        let proven = unsupported || matches!(why, Failure::NoAnswer { .. });
        let contacts = self.now.state.nodes.len();
        let mut next = strategy::next_rung(chosen, search.rung, contacts);
        // A search repeats a step of its damped motion with more drag, which costs less than sweeps.
        let recovery = &self.now.state.recovery;
        let moves = recovery.motion.is_some() && recovery.fallback.is_some();
        if let Some((rung, to)) = next
            && (self.left_out == Some(OmittedStep::Strategy(to))
                || moves && to == Strategy::GaussSeidel)
        {
            next = strategy::next_rung(chosen, rung, contacts);
        }
        let first = first.clone();
        if let Some(again) = self.freeze(&why, &first) {
            return again;
        }
        let search = &mut self.now.state.attempt.search;
        // The searches do not support held-back sliding.
        let braked = self.now.state.recovery.brake.is_some();
        let next = next.filter(|(_, to)| !(braked && strategy::method(*to).search().is_some()));
        if let Some((rung, to)) = next
            && !proven
        {
            search.rung = rung;
            (search.fewest, search.rounds, search.searched) = (None, 0, SearchProgress::Not);
            self.now.state.next.minor += 1;
            return Outcome::StrategyChange {
                why,
                to,
                frozen: search.frozen,
            };
        }
        if let Some(again) = self.now.state.hold_harder(&why) {
            return again;
        }
        self.now.state.attempt.search = Progress::default();
        self.fail(ended(*first, why))
    }

    /// Restarts this major iteration without the change of the contact geometry in the tangent, if no strategy has found consistent
    /// modes with it. That part of the tangent is indefinite, and far from equilibrium the linearised problem may then have no
    /// solution; without it, the response is that of the bodies. Strategies that take many minor iterations follow afterwards: all
    /// behind the second once this has helped in a run, and those behind a census that is too large.
    fn freeze(&mut self, why: &Failure, first: &Failure) -> Option<Outcome> {
        let state = &self.now.state;
        let (chosen, search) = (&state.controls.settings, &state.attempt.search);
        let last = strategy::next_rung(chosen.strategy, search.rung, state.nodes.len()).is_none()
            || matches!(why, Failure::NoAnswer { .. });
        let early = search.rung > 0 && state.record.searched.frozen
            || matches!(why, Failure::NotFound(NotFound::TooMany { .. }));
        let held = matches!(
            first,
            Failure::Singular(Singular::Rigid { .. }) | Failure::OverConstrained { .. }
        );
        if held
            || search.frozen
            || !(last || early)
            || chosen.geometry == Geometry::Frozen
            || state.recovery.brake.is_some()
            || state.way.is_some()
            || self.left_out == Some(OmittedStep::Recovery(FROZEN))
            || self.now.stalled().is_given()
        {
            return None;
        }
        let (rung, to) = strategy::next_rung(chosen.strategy, 0, state.nodes.len())?;
        self.now.state.attempt.search = Progress {
            rung,
            first: Some(Box::new(first.clone())),
            frozen: true,
            ..Progress::default()
        };
        self.now.forget_workspace();
        self.now.state.next.minor += 1;
        Some(Outcome::StrategyChange {
            why: why.clone(),
            to,
            frozen: true,
        })
    }

    /// Start and step of the search over all nodes to which this minor iteration belongs.
    pub(super) fn searching(&self) -> Option<(usize, usize)> {
        self.method().search()?;
        match self.now.state.attempt.search.searched {
            SearchProgress::At { start, step } => Some((start, step)),
            SearchProgress::Not | SearchProgress::Found { .. } => None,
        }
    }

    /// One proposal of a search over all nodes.
    pub(super) fn propose(&mut self, start: usize, step: usize) -> Outcome {
        let method = self.method();
        self.now.state.attempt.minors += 1;
        let brought = self.now.brought();
        let Iterate {
            state,
            source,
            kept,
            ..
        } = &mut self.now;
        let source = RefCell::new(source);
        let asked = SearchInput {
            start,
            step,
            unconfirmed: state.attempt.search.unconfirmed,
            brought: &brought,
            problem: &mut || source.borrow_mut().problem(&state.at()).ok(),
            sweep: &mut || source.borrow_mut().sweep(&state.at()),
            kept,
        };
        let proposed = match method.search() {
            Some(search) => search.propose(asked),
            None => return self.go_on(),
        };
        match proposed {
            Ok(proposal) if proposal.rule == Rule::Settled => self.settle(&proposal),
            Ok(proposal) => self.take(&proposal),
            Err(NoProposal::NotFound(why)) => self.escalate(Failure::NotFound(why)),
            Err(NoProposal::NoAnswer { tried }) => {
                let first = self.now.state.attempt.search.first.clone();
                self.escalate(Failure::NoAnswer { first, tried })
            }
        }
    }

    /// Records the modes that a search proposes for the contacts, and stores them in the state.
    fn take(&mut self, proposal: &Proposal) -> Outcome {
        self.now.state.attempt.search.searched = proposal.next;
        let (model, mut nodes) = (self.now.model.clone(), proposal.nodes.iter());
        for (contact, slave) in model.contacts.iter().enumerate() {
            if slave.bond.is_tied() {
                self.event.nodes.push(self.now.stay_tied(contact));
            } else if let Some(&(assumed, numbers)) = nodes.next() {
                let record = self.now.assume(contact, assumed, numbers, proposal);
                self.event.nodes.push(record);
            }
        }
        if let Some((place, tested)) = proposal.bound {
            let contact = model
                .contacts
                .iter()
                .enumerate()
                .filter(|(_, slave)| !slave.bond.is_tied())
                .nth(place)
                .map_or(place, |(contact, _)| contact);
            self.event.nodes[contact].decision.tests[1] = Some(Test {
                tested,
                value: 0.0,
                bound: 0.0,
                margin: 0.0,
                tie: false,
            });
        }
        self.now.state.next.minor += 1;
        Outcome::Minor
    }

    /// Ends the major iteration with the forces of a search.
    fn settle(&mut self, proposal: &Proposal) -> Outcome {
        let minor = self.now.state.next.minor;
        self.take(proposal);
        self.now.state.next.minor = minor;
        for record in &mut self.event.nodes {
            record.decision.before = record.decision.next;
        }
        let forces = self.event.nodes.iter().map(|r| [r.f_n, r.f_t]);
        self.now.source.press(&mut { forces });
        self.end_major(true)
    }
}

impl Iterate {
    /// Modes and T_max of the contacts that are not tied, at the start of the current major iteration. Without recorded minor
    /// iterations, as when a diagnosis looks ahead, those of the state.
    fn brought(&self) -> Vec<AssumedMode> {
        let state = &self.state;
        let first = state.major.minor_history.first(state.nodes.len());
        (self.model.contacts.iter().enumerate())
            .filter(|(_, slave)| !slave.bond.is_tied())
            .map(|(contact, _)| match first.get(contact) {
                Some(input) => AssumedMode::from_mode(input.mode, input.t_max),
                None => {
                    let node = &state.nodes[contact];
                    AssumedMode::from_mode(node.mode, node.t_max)
                }
            })
            .collect()
    }

    /// Records a tied contact, which searches ignore: its forces follow from the next solve.
    fn stay_tied(&self, contact: usize) -> ContactRecord {
        tied_record(&self.state.nodes[contact], self.source.kinematics(contact))
    }

    /// Gives a contact the mode that a search assumes, and records it with the search's forces, gap and slip.
    fn assume(
        &mut self,
        contact: usize,
        assumed: AssumedMode,
        [f_n, f_t, gap, slip]: [f64; 4],
        proposal: &Proposal,
    ) -> ContactRecord {
        let node = &mut self.state.nodes[contact];
        let friction = node.friction(&self.state.controls.friction[contact]);
        let over = self.source.kinematics(contact);
        let before = node.mode;
        node.mode = assumed.mode();
        node.ratio = 0.0;
        node.sign = assumed.sign();
        let sign = if f_t == 0.0 { node.sign } else { f_t.signum() };
        node.t_max = t_max(&friction, f_n, sign);
        let test = Test {
            tested: proposal.covers,
            value: proposal.cover,
            bound: 0.0,
            margin: -proposal.cover,
            tie: false,
        };
        let rule = match over {
            Some(_) => proposal.rule,
            None => Rule::OffSurface,
        };
        let give = over.map_or(0.0, |k| k.bond.give()[0]);
        ContactRecord {
            decision: Decision {
                before,
                next: node.mode,
                rule,
                tests: [over.map(|_| test), None],
                wanted: node.mode,
            },
            gap: match give {
                0.0 => gap,
                give => gap - give * f_n,
            },
            f_n,
            f_t,
            t_max: node.t_max,
            t_max_used: node.t_max,
            slip,
            corner: node.corner.filter(|_| before == Mode::Fixed),
            ..tied_record(node, over)
        }
    }
}

/// The record of a tied contact.
fn tied_record(node: &ContactState, over: Option<NodeKinematics>) -> ContactRecord {
    ContactRecord {
        decision: Decision::tied(),
        forced: node.forced,
        gap: over.map_or(f64::INFINITY, |k| k.gap),
        f_n: node.f_n,
        f_t: node.f_t,
        t_max: 0.0,
        t_max_used: 0.0,
        slip: node.drift,
        drift: node.drift,
        spot: node.spot,
        normal: over.map_or(node.normal, |k| k.normal),
        foot: over.map_or([f64::NAN; 2], |k| k.foot),
        directions: None,
        corner: None,
        carried: [false; 2],
    }
}

impl State {
    /// Restores the contacts to the start of the current major iteration.
    pub(super) fn begin_again(&mut self) {
        self.take_back();
        self.forget_minors();
    }

    fn take_back(&mut self) {
        let first = self.major.minor_history.first(self.nodes.len());
        for (node, input) in self.nodes.iter_mut().zip(first) {
            (node.mode, node.ratio) = (input.mode, input.ratio);
            if input.mode == Mode::Sliding {
                (node.t_max, node.sign) = (input.t_max, input.t_max.signum());
            }
        }
    }

    /// The modes that were tried are not consistent: the next start of a search over all nodes, or its next solution.
    pub(super) fn begin_search(&mut self) -> Outcome {
        let search = &mut self.attempt.search;
        let start = match search.searched {
            SearchProgress::Not => {
                search.unconfirmed = 0;
                0
            }
            SearchProgress::At { start, .. } => start + 1,
            SearchProgress::Found { start } => {
                search.unconfirmed += 1;
                start + 1
            }
        };
        search.searched = SearchProgress::At { start, step: 0 };
        self.take_back();
        self.next.minor += 1;
        Outcome::Minor
    }
}

/// The failure of a ladder whose first strategy failed with `first` and whose last with `last`.
fn ended(first: Failure, last: Failure) -> Failure {
    match (first, last) {
        (
            first @ (Failure::Singular(Singular::Rigid { .. }) | Failure::OverConstrained { .. }),
            _,
        ) => first,
        (_, last @ Failure::NoAnswer { .. }) => last,
        (first, last) => Failure::LadderEnded {
            first: Box::new(first),
            last: Box::new(last),
            scales: false,
        },
    }
}
