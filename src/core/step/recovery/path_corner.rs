//! Corners of the equilibrium path: points where the mode of a contact ends, and the path continues in the next mode.
//!
//! Between two changes of mode the path is smooth; at a change its tangent turns. If it turns by more than a right angle, no
//! state lies on the plane ahead of the old tangent, however small the increment. Along the old tangent, with rates ', a mode
//! ends at the least s >= 0 with
//!
//! ```text
//! fixed     F_n + s F_n' = 0: opens,    |F_t + s F_t'| = tan φ (F_n + s F_n') + c: slides
//! sliding   F_n + s F_n' = 0: opens,    sgn(T_max) slip' < 0: sticks, at s = 0,
//!           s |slip'| = distance to a concave corner: is held there
//! free      g + s g' = 0: touches
//! ```
//!
//! The contacts whose modes end first change, and the increment restarts with the tangent in the new modes. Its sign does not
//! follow from an inner product here: it is the sign for which the changed contacts obey Table 2:
//!
//! ```text
//! slides    F_t slip' > 0               opens     g' > 0
//! sticks    sgn(F_t) F_t' < tan φ F_n'    touches   F_n' > 0
//! is held   sgn(F_t) F_t' > tan(φ − h) F_n', with h half the corner's angle: outside the friction cone of the side it came from
//! ```
//!
//! Pivoting methods do the same at the end of an edge of a piecewise linear path (Eaves 1972). If the contacts that change
//! together do not agree on a sign, the path does not continue in these modes.

use super::retry::{Effect, Recovery, Retry};
use super::stalled::FailedIncrement;
use crate::contact::tracking::leave_border;
use crate::plane::minus;
use crate::step::arc_state::{ArcState, Change};
use crate::step::iterate::Iterate;
use crate::{
    BoundUpdate, ContactRecord, ContactState, Failure, Forced, Friction, Mode, NodeIncrement,
    Outcome, SolveResult, State,
};
use std::sync::Arc;

/// Ends of modes coincide if their distances differ by less than this fraction.
const TOGETHER: f64 = 1e-6;
/// A slip stops and reverses after its rate has fallen below this fraction of the last one.
const REVERSAL: f64 = 0.5;
/// An increment starts at a corner that is closer than this fraction of its size.
const AT_START: f64 = 0.02;
/// If an increment can no longer be cut, its corner may be this multiple of its size ahead.
const AHEAD: f64 = 2.0;
/// An increment that is cut to end before a corner covers this fraction of the distance.
const BEFORE: f64 = 0.99;

/// Rates at one contact along a tangent of any size.
#[derive(Debug, Clone, Copy)]
struct Rates {
    f_n: f64,
    f_t: f64,
    gap: f64,
    slip: f64,
}

impl From<NodeIncrement> for Rates {
    fn from(given: NodeIncrement) -> Self {
        let ([f_n, f_t], [normal, slip]) = (given.force, given.motion);
        Rates {
            f_n,
            f_t,
            gap: -normal,
            slip,
        }
    }
}

impl Rates {
    fn times(self, factor: f64) -> Self {
        Rates {
            f_n: factor * self.f_n,
            f_t: factor * self.f_t,
            gap: factor * self.gap,
            slip: factor * self.slip,
        }
    }
}

impl Iterate {
    /// The contacts whose modes end first along the tangent that was just solved for, and their distance as a multiple of the
    /// solved motion. The path continues in the direction `sign` of the solution. Empty if no mode ends.
    pub(in crate::step) fn next_changes(&self, sign: f64) -> (f64, Vec<Change>) {
        let state = &self.state;
        let mut first = (f64::INFINITY, Vec::new());
        for (contact, node) in state.nodes.iter().enumerate() {
            let over = self.source.kinematics(contact);
            let Some(over) =
                over.filter(|over| !matches!(node.forced, Forced::Held(_)) && !over.bond.is_tied())
            else {
                continue;
            };
            let friction = node.friction(&state.controls.friction[contact]);
            let rates = Rates::from(self.source.increment(contact)).times(sign);
            let room = self
                .source
                .held_in_corner(contact, node, Some(rates.slip))
                .and_then(|_| over.room_for(rates.slip));
            let end = end_of_mode(node, over.gap, room, rates, &friction);
            let Some((at, to, force)) = end else {
                continue;
            };
            if at < first.0 * (1.0 - TOGETHER) {
                first = (at, Vec::new());
            }
            if at <= first.0 * (1.0 + TOGETHER) {
                let from = node.mode;
                let held = from == Mode::Sliding && to == Mode::Fixed && at > 0.0;
                first.1.push(Change {
                    contact,
                    from,
                    to,
                    sign: force,
                    held,
                    through: false,
                });
            }
        }
        first
    }

    /// The tangent behind the corner, in the modes of the state: a motion of all degrees of freedom, of any size, and the slip of
    /// each contact in it.
    ///
    /// # Errors
    /// If there is no such tangent.
    pub(in crate::step) fn tangent_behind(&mut self) -> Result<(Vec<f64>, Vec<f64>), Failure> {
        if !self.enter_corners() {
            return Err(Failure::PathReversal);
        }
        // The start lies before the corner, so a solve includes the motion to it: two solves differ by the tangent.
        let (mut motion, given) = self.solve_tangent()?;
        if let Some(way) = &mut self.state.way {
            way.left = 0.0;
        }
        self.linearised = false;
        if !self.linearise() {
            return Err(Failure::PathReversal);
        }
        let (still, there) = self.solve_tangent()?;
        let rates: Vec<Rates> = given
            .iter()
            .zip(&there)
            .map(|(a, b)| NodeIncrement {
                force: minus(a.force, b.force),
                motion: minus(a.motion, b.motion),
            })
            .map(Rates::from)
            .collect();
        let sign = self.state.way.as_ref().and_then(|way| {
            let signs = way.next.iter().map(|change| {
                let contact = change.contact;
                let friction = &self.state.controls.friction[contact];
                let corner = self.state.nodes[contact].corner;
                agreeing(change, rates[contact], friction, corner)
            });
            let mut signs = signs.filter(|sign| *sign != 0.0);
            // Contacts that do not change continue ahead.
            let first = signs.next().unwrap_or(1.0);
            signs.all(|sign| sign == first).then_some(first)
        });
        let sign = sign.ok_or(Failure::PathReversal)?;
        for (motion, still) in motion.iter_mut().zip(&still) {
            *motion = sign * (*motion - still);
        }
        let slips = rates.iter().map(|rates| sign * rates.slip);
        Ok((motion, slips.collect()))
    }

    /// One solve of the tangent's equations: the motion of all degrees of freedom, and the increment of every contact.
    ///
    /// # Errors
    /// If they have no solution.
    pub(in crate::step) fn solve_tangent(
        &mut self,
    ) -> Result<(Vec<f64>, Vec<NodeIncrement>), Failure> {
        let mut at = self.state.at();
        at.settings.t_max = BoundUpdate::Consistent;
        let solved = self.source.solve(&at);
        if let Some(why) = self.unsolvable(solved) {
            return Err(why);
        }
        if self.source.recover() == SolveResult::Not {
            return Err(Failure::Singular(self.explain()));
        }
        let mut motion = vec![0.0; self.state.u.len()];
        self.source.advance(&mut motion);
        let contacts = 0..self.state.nodes.len();
        Ok((motion, contacts.map(|k| self.source.increment(k)).collect()))
    }

    /// Places contacts that slide out of a corner between two sides on the side along which they slide. Holds contacts in a
    /// concave corner if they slide into it, or if they stick there and would slide by the friction of one side. Returns false if
    /// the state cannot be linearised then. A contact that goes `through` such a corner slides out of it at once.
    fn enter_corners(&mut self) -> bool {
        let mut changes = self
            .state
            .way
            .as_ref()
            .map_or_else(Vec::new, |way| way.next.to_vec());
        let starts = self.state.start.clone();
        for change in changes.iter().filter(|change| change.through) {
            let start = &starts.nodes[change.contact];
            if let Some(held) = self.source.held_in_corner(change.contact, start, None) {
                self.state.nodes[change.contact] = held;
            }
        }
        let passes = changes.iter().any(|change| change.through);
        if passes {
            // The direction out of the corner depends on the new mode.
            self.state.change_modes();
            self.linearised = false;
        }
        let leaves = |change: &Change| {
            let start = &starts.nodes[change.contact];
            let at_border = start.spot.is_some_and(|spot| spot.xi.abs() == 1.0);
            start.corner.is_some() || change.to == Mode::Sliding && at_border
        };
        if changes.iter().any(leaves) {
            self.follow();
            self.state.change_modes();
            for change in &changes {
                let node = &mut self.state.nodes[change.contact];
                leave_border(&self.model.surfaces, node);
            }
        }
        for change in changes.iter_mut().filter(|change| !change.through) {
            let start = &starts.nodes[change.contact];
            let motion = match (change.from, change.to) {
                (Mode::Fixed, Mode::Sliding) => None,
                (Mode::Fixed, Mode::Fixed) => None,
                // Slip has the direction of the force.
                (Mode::Sliding, Mode::Fixed) if change.held => Some(change.sign),
                _ => continue,
            };
            let held = self.source.held_in_corner(change.contact, start, motion);
            if let Some(held) = held {
                self.state.nodes[change.contact] = held;
                (change.to, change.held) = (Mode::Fixed, true);
                self.linearised = false;
            }
        }
        if let Some(way) = &mut self.state.way {
            way.next = Arc::new(changes);
        }
        self.linearise()
    }
}

impl State {
    /// Direction in which the path continues along a tangent (−1 or 1). The tangent was solved for a positive inner product with
    /// the previous increment, and that direction is used. If then all sliding contacts would slide against their friction, and
    /// no slower than before, the previous increment is no reference, since it passed a corner: the direction is the one in which
    /// they continue to slide.
    pub(in crate::step) fn onwards(&self, given: &[NodeIncrement]) -> f64 {
        let nodes = &self.nodes;
        let slips = self
            .way
            .as_ref()
            .map(|way| way.slips.clone())
            .unwrap_or_default();
        let mut sliding = nodes
            .iter()
            .zip(given)
            .zip(slips.iter())
            .filter(|((node, _), _)| node.mode == Mode::Sliding);
        let turns = |((node, given), slip): ((&ContactState, &NodeIncrement), &f64)| {
            let rate = given.motion[1];
            node.sign * rate < 0.0 && rate.abs() > REVERSAL * slip.abs()
        };
        let any = sliding.clone().next().is_some();
        if any && sliding.all(turns) { -1.0 } else { 1.0 }
    }

    /// Records which contacts changed their modes first in the current increment.
    pub(in crate::step) fn note_changes(&mut self, records: &[ContactRecord]) {
        let Some(way) = &mut self.way else {
            return;
        };
        if !way.seen.is_empty() || way.turned {
            return;
        }
        let changed = records
            .iter()
            .enumerate()
            .filter(|(_, record)| record.decision.changes());
        let nodes = &self.nodes;
        let seen = changed.map(|(contact, record)| Change {
            contact,
            from: record.decision.before,
            to: record.decision.next,
            sign: nodes[contact].sign,
            held: false,
            through: false,
        });
        let seen: Vec<Change> = seen.collect();
        if !seen.is_empty() {
            way.seen = Arc::new(seen);
        }
    }

    /// Whether a contact that changed at the corner has changed back; or, in an increment that does not start at a corner,
    /// whether a contact that slides along the tangent now sticks. Every state of sliding has a second solution, unloading, where
    /// all contacts stick. That is not the path.
    pub(in crate::step) fn turned_back(&self) -> bool {
        let nodes = &self.nodes;
        let Some(way) = &self.way else {
            return false;
        };
        if way.turned {
            return way
                .next
                .iter()
                .any(|change| nodes[change.contact].mode != change.to);
        }
        nodes
            .iter()
            .zip(&self.start.nodes)
            .any(|(now, start)| (start.mode, now.mode) == (Mode::Sliding, Mode::Fixed))
    }
}

/// Restart behind the corner of the path at which the increment starts.
pub(super) struct CornerRestart;

impl Recovery for CornerRestart {
    fn name(&self) -> &'static str {
        "turn"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        turn(why, stalled, AT_START, false)
    }
}

/// At the minimum arc: restart behind the corner just ahead, or the one where contacts changed first.
pub(super) struct LastCornerRestart;

impl Recovery for LastCornerRestart {
    fn name(&self) -> &'static str {
        "turn-at-last"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        turn(why, stalled, AHEAD, true)
    }
}

/// Restarts the increment behind a corner that lies at most this fraction of its size ahead. `None` if there is no such corner,
/// or if that restart was what failed.
fn turn(why: &Failure, stalled: &FailedIncrement<'_>, reach: f64, seen: bool) -> Option<Retry> {
    let mut way = stalled.state.way.clone().filter(|way| way.known)?;
    if !stalled.size_helps(why) || way.turned && !way.pass_through() {
        return None;
    }
    let foreseen = !way.next.is_empty() && way.next_at <= reach * way.step;
    if !way.turned && !foreseen {
        if !seen || way.seen.is_empty() {
            return None;
        }
        way.next = way.seen.clone();
    }
    way.turned = true;
    let (why, changes) = (why.clone(), way.next.clone());
    Some(Retry {
        part: stalled.state.sub_increment,
        effect: Effect::Path(way),
        outcome: Outcome::PathCorner { why, changes },
    })
}

/// Size to which an increment is cut: up to the next corner if that lies within it, otherwise half.
pub(in crate::step) fn smaller_arc(way: &ArcState) -> f64 {
    let to = BEFORE * way.next_at;
    let ahead = !way.next.is_empty() && !way.turned && to < BEFORE * BEFORE * way.step;
    if ahead && to > AT_START * way.step {
        to
    } else {
        way.step / 2.0
    }
}

/// Direction of the tangent with these `rates` in which a contact obeys Table 2 after its change (−1 or 1; 0 if it does in both).
fn agreeing(change: &Change, rates: Rates, friction: &Friction, corner: Option<f64>) -> f64 {
    // About the mean normal of a corner, the friction angle of the side that the contact came from is reduced by half the
    // corner's angle.
    let turned = corner.filter(|_| change.held).unwrap_or_default();
    let bound = (friction.angle.to_radians() - turned).tan() * rates.f_n;
    let beyond = change.sign * rates.f_t - bound;
    let margin = match (change.to, change.from) {
        (Mode::Sliding | Mode::Fixed, Mode::Free) => rates.f_n,
        (Mode::Sliding, _) => change.sign * rates.slip,
        (Mode::Fixed, Mode::Fixed) => 0.0,
        (Mode::Free, _) => rates.gap,
        (Mode::Fixed, _) if change.held => beyond,
        (Mode::Fixed, _) => -beyond,
    };
    if margin == 0.0 { 0.0 } else { margin.signum() }
}

/// Distance to the end of a node's mode, as a multiple of the motion with these rates, with the next mode and the direction of
/// the tangential force in it. `None` if the mode does not end.
fn end_of_mode(
    node: &ContactState,
    gap: f64,
    room: Option<f64>,
    rates: Rates,
    friction: &Friction,
) -> Option<(f64, Mode, f64)> {
    // Where a + s b falls to 0; at once if it is 0 already.
    let falls = |a: f64, b: f64| (b < 0.0).then(|| (-a / b).max(0.0));
    let first = |all: [Option<(f64, Mode, f64)>; 3]| {
        all.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let opens = || falls(node.f_n, rates.f_n).map(|s| (s, Mode::Free, 0.0));
    match node.mode {
        Mode::Free => {
            let to = if friction.is_smooth() {
                Mode::Sliding
            } else {
                Mode::Fixed
            };
            falls(gap, rates.gap).map(|s| (s, to, 0.0))
        }
        Mode::Fixed => {
            let (mu, c) = (friction.coefficient(), friction.cohesion);
            let slides = |sign: f64| {
                let margin = mu * node.f_n + c - sign * node.f_t;
                let at = falls(margin, mu * rates.f_n - sign * rates.f_t);
                at.map(|s| (s, Mode::Sliding, sign))
            };
            first([opens(), slides(1.0), slides(-1.0)])
        }
        Mode::Sliding => {
            let sticks = (node.sign * rates.slip < 0.0).then_some((0.0, Mode::Fixed, node.sign));
            let meets = room.map(|room| (room / rates.slip.abs(), Mode::Fixed, node.sign));
            first([opens(), sticks, meets])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::InitialState;

    fn node(mode: Mode, f_n: f64, f_t: f64) -> ContactState {
        let mut node = ContactState::new(mode, &InitialState::default());
        (node.f_n, node.f_t, node.sign) = (f_n, f_t, f_t.signum());
        node
    }

    fn rates(f_n: f64, f_t: f64, gap: f64, slip: f64) -> Rates {
        Rates {
            f_n,
            f_t,
            gap,
            slip,
        }
    }

    #[test]
    fn a_mode_ends_where_the_first_of_its_inequalities_does() {
        let friction = Friction {
            angle: 45.0,
            cohesion: 0.5,
        };
        let end = |mode, f_n, f_t, gap, rates| {
            let end = end_of_mode(&node(mode, f_n, f_t), gap, None, rates, &friction);
            end.map(|(at, to, sign)| ((1e9 * at).round() / 1e9, to, sign))
        };
        // The root of 2 − s is beyond that of 1 + s = (2 − s) + 0.5.
        let sheared = end(Mode::Fixed, 2.0, 1.0, 0.0, rates(-1.0, 1.0, 0.0, 0.0));
        assert_eq!(sheared, Some((0.75, Mode::Sliding, 1.0)));
        let opened = end(Mode::Fixed, 2.0, 0.0, 0.0, rates(-8.0, 0.0, 0.0, 0.0));
        assert_eq!(opened, Some((0.25, Mode::Free, 0.0)));
        let held = end(Mode::Fixed, 2.0, 1.0, 0.0, rates(2.0, 1.0, 0.0, 0.0));
        assert_eq!(held, None);
        let slid = end(Mode::Sliding, 2.0, -2.5, 0.0, rates(-1.0, 1.0, 0.0, -1.0));
        assert_eq!(slid, Some((2.0, Mode::Free, 0.0)));
        let stuck = end(Mode::Sliding, 2.0, -2.5, 0.0, rates(-1.0, 1.0, 0.0, 1.0));
        assert_eq!(stuck, Some((0.0, Mode::Fixed, -1.0)));
        let touched = end(Mode::Free, 0.0, 0.0, 0.3, rates(0.0, 0.0, -0.1, 0.0));
        assert_eq!(touched, Some((3.0, Mode::Fixed, 0.0)));
    }

    #[test]
    fn behind_a_corner_the_tangent_goes_where_table_2_allows_it() {
        let friction = Friction {
            angle: 45.0,
            cohesion: 0.0,
        };
        let agreeing = |from, to, sign, rates| {
            let change = Change {
                contact: 0,
                from,
                to,
                sign,
                held: false,
                through: false,
            };
            agreeing(&change, rates, &friction, None)
        };
        let (fixed, sliding, free) = (Mode::Fixed, Mode::Sliding, Mode::Free);
        let all = rates(-1.0, 2.0, 3.0, -4.0);
        assert_eq!(agreeing(fixed, sliding, 1.0, all), -1.0);
        assert_eq!(agreeing(fixed, sliding, -1.0, all), 1.0);
        assert_eq!(agreeing(fixed, free, 0.0, all), 1.0);
        assert_eq!(agreeing(free, fixed, 0.0, all), -1.0);
        // Without friction a touching contact slides either way.
        assert_eq!(agreeing(free, sliding, 1.0, all), -1.0);
        // |F_t| must fall below the bound: 2 s < −s backwards only.
        assert_eq!(agreeing(sliding, fixed, 1.0, all), -1.0);
        assert_eq!(agreeing(sliding, fixed, -1.0, all), 1.0);
    }
}
