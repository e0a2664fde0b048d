//! The two-level iteration (increments > major > minor) as a state machine: one call, one minor iteration.
//!
//! ```text
//! increment   the load factor moves on
//!   major     geometry, stiffness and residual are renewed and frozen          System::linearise
//!     minor   solve for the assumed modes, check them by Table 2, assume anew   Stepper::step
//!   until modes and T_max have settled; then displacements and forces are updated
//! until residual and interface conditions are within the tolerance; then the increment is accepted
//! ```

use crate::contact::anchor::{distance, pierced};
use crate::contact::decision::Ties;
use crate::contact::projection::{footing, hold, project, tangent};
use crate::scene::model::{Surface, Watched};
use crate::scene::spec::{AtCycle, AtLimit, Axis, ResidualMethod, SlipCount, Sticking};
use crate::scene::{Mode, Model, spec};
use crate::solve::event::{Cycle, Event, Failure, NodeRecord, Norms, Outcome, Position, Singular};
use crate::solve::frozen::Frozen;
use crate::solve::intervene::Intervention;
use crate::solve::minor::{carried, judge};
use crate::solve::rounds::{Round, Scales};
use crate::solve::singular;
use crate::solve::state::{IncrementStart, NodeState, State, Status};
use crate::solve::system::{Solved, System};
use std::sync::Arc;

/// A displacement this many times the scene's length is divergence.
const DIVERGED: f64 = 1e4;
/// Two states of a minor loop whose numbers differ by less than this, relatively, are the same. It is far below any
/// tolerance, so that T_max that converges slowly has settled before two rounds look alike.
const SAME: f64 = 1e-14;
/// Where round-off keeps the residual above the tolerance, displacements must have come to rest within this part of
/// the length instead.
const STILL: f64 = 1e-8;
/// From this major iteration on nodes keep their master elements a little past the borders.
const HOLD_FROM: u32 = 5;
/// A major iteration is not damped below this part of its load.
const SMALLEST_PART: f64 = 1e-6;

/// The solver: a state, and the workspace that is made from it.
pub struct Stepper {
    model: Arc<Model>,
    state: State,
    system: System,
    /// Whether `system` is linearised about `state`.
    linearised: bool,
    event: Event,
}

impl Stepper {
    /// A solver at the start of a scene's history.
    pub fn new(model: Arc<Model>) -> Self {
        let state = State::new(&model);
        let mut stepper = Stepper {
            system: System::new(&model),
            event: Event {
                position: Position::default(),
                load_factor: 0.0,
                nodes: Vec::with_capacity(model.slaves.len()),
                before: Norms::default(),
                outcome: Outcome::Minor,
            },
            state,
            linearised: false,
            model,
        };
        stepper.find_spots();
        stepper.place_anchors();
        let start = IncrementStart {
            nodes: stepper.state.nodes.clone(),
            ..(*stepper.state.start).clone()
        };
        stepper.state.start = Arc::new(start);
        stepper
    }

    /// The scene.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Where the solver is.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes to a state of the same scene; what follows has the same bits as the first time.
    pub fn restore(&mut self, state: &State) {
        self.state.clone_from(state);
        self.linearised = false;
    }

    /// Current norms and whether they could be computed: those about which the next minor iteration is linearised.
    pub fn norms(&mut self) -> Option<Norms> {
        self.linearise().then(|| self.system.norms())
    }

    /// The frozen interface problem of the present major iteration; none where the bodies cannot be condensed.
    pub fn frozen(&mut self) -> Option<Frozen> {
        if !self.linearise() {
            return None;
        }
        self.system.frozen(&self.model, &self.state).ok()
    }

    /// One minor iteration. None when the history is done.
    ///
    /// After a failure the next call goes on from the failed state, as a user does who has changed something.
    pub fn step(&mut self) -> Option<&Event> {
        if self.state.status == Status::Finished {
            return None;
        }
        self.state.status = Status::Running;
        self.event.position = self.state.next;
        self.event.load_factor = self.state.load_factor;
        self.event.nodes.clear();
        self.event.outcome = self.minor();
        if let Outcome::Failed(failure) = &self.event.outcome {
            self.state.status = Status::Failed(failure.clone());
        }
        Some(&self.event)
    }

    /// The event of the last minor iteration.
    pub fn event(&self) -> &Event {
        &self.event
    }

    fn linearise(&mut self) -> bool {
        if !self.linearised {
            self.linearised = self.system.linearise(&self.model, &self.state).is_ok();
            self.system.turn(&self.model, &self.state);
        }
        self.linearised
    }

    fn minor(&mut self) -> Outcome {
        if !self.linearise() {
            return Outcome::Failed(Failure::Singular(Singular::Unexplained));
        }
        self.event.before = self.system.norms();
        match self.system.solve(&self.model, &self.state) {
            Solved::Well => {}
            Solved::Suspicious => {
                let singular = self.diagnose();
                if matches!(singular, Singular::Rigid { .. }) {
                    return Outcome::Failed(Failure::Singular(singular));
                }
            }
            Solved::Not => return Outcome::Failed(Failure::Singular(self.diagnose())),
        }
        if let Some(failure) = self.jammed() {
            return Outcome::Failed(failure);
        }
        self.state.minors += 1;
        Arc::make_mut(&mut self.state.trail).push(&self.state.nodes);
        let settled = self.judge();
        if settled {
            return self.end_major(true);
        }
        self.go_on()
    }

    fn diagnose(&self) -> Singular {
        singular::diagnose(
            &self.model,
            &self.system.positions,
            &self.state.nodes,
            |s| self.system.footing(s),
        )
    }

    /// A touching node with a gap that no unknown can close.
    fn jammed(&self) -> Option<Failure> {
        let tolerance = self.state.controls.settings.tolerance * self.model.length;
        (0..self.state.nodes.len()).find_map(|slave| {
            let gap = self.system.footing(slave)?.gap;
            let stuck = carried(self.state.nodes[slave].mode, self.system.moves(slave))[0]
                && gap < -tolerance;
            stuck.then_some(Failure::Jammed { slave, gap })
        })
    }

    fn ties(&self) -> Ties {
        let settings = &self.state.controls.settings;
        Ties {
            force: settings.tolerance * self.force_scale(),
            length: settings.tolerance * self.model.length,
            keep: settings.ties == spec::Ties::Keep,
        }
    }

    /// Size of forces: where displacements are prescribed, none may act before the first solve but at the interface.
    fn force_scale(&self) -> f64 {
        let nodes = self.state.nodes.iter().enumerate();
        nodes.fold(self.system.norms().scale, |scale, (slave, node)| {
            let [d_n, d_t] = self.system.force_increment(slave);
            scale
                .max((node.f_n + d_n).abs())
                .max((node.f_t + d_t).abs())
        })
    }

    /// Checks every node's mode against Table 2 and records it; true where modes and T_max have settled.
    ///
    /// Leaves the modes of the next minor iteration in the state.
    fn judge(&mut self) -> bool {
        let ties = self.ties();
        let mut settled = true;
        let controls = self.state.controls.clone();
        for (slave, node) in self.state.nodes.iter_mut().enumerate() {
            let site = self.system.site(slave, node);
            let given = self.system.given(slave);
            let friction = &controls.friction[slave];
            let (record, still) = judge(node, &site, given, friction, &controls.settings, &ties);
            settled &= still;
            self.event.nodes.push(record);
        }
        settled
    }

    /// The minor loop has not settled: look for a cycle and at the limit, and count on.
    fn go_on(&mut self) -> Outcome {
        let settings = self.state.controls.settings;
        let accept = settings.at_minor_limit == AtLimit::Accept;
        let minor = self.state.next.minor;
        let tried = self.state.trail.len(self.state.nodes.len()) as u32;
        let at_limit = tried.is_multiple_of(settings.minors);
        if at_limit && accept {
            return self.end_major(false);
        }
        self.state.next.minor += 1;
        if !accept && let Some(cycle) = self.find_cycle(minor) {
            if settings.at_cycle == AtCycle::Damp && self.damp() {
                return Outcome::Damped {
                    cycle,
                    aim: self.state.aim,
                };
            }
            self.state.forget_trail();
            return Outcome::Failed(Failure::Cycle(cycle));
        }
        if at_limit {
            let changing = self.changing();
            return Outcome::Failed(Failure::MinorLimit {
                limit: settings.minors,
                changing,
            });
        }
        Outcome::Minor
    }

    /// Starts the minor iterations of this major one again, with half the load; false if too little is left of it.
    fn damp(&mut self) -> bool {
        let left = self.state.aim - self.state.reached;
        if left.abs()
            < SMALLEST_PART * (self.state.load_factor - self.state.start.load_factor).abs()
        {
            return false;
        }
        self.state.aim = self.state.reached + left / 2.0;
        self.linearised = false;
        let first = self.state.trail.first(self.state.nodes.len());
        for (node, input) in self.state.nodes.iter_mut().zip(first) {
            (node.mode, node.ratio) = (input.mode, input.ratio);
            if input.mode == Mode::Sliding {
                (node.t_max, node.sign) = (input.t_max, input.t_max.signum());
            }
        }
        self.state.forget_trail();
        true
    }

    /// Slave nodes whose mode or T_max still changed in the last minor iteration.
    fn changing(&self) -> Vec<usize> {
        let force = self.ties().force;
        let moves = |r: &NodeRecord| r.decision.changes() || (r.t_max - r.t_max_used).abs() > force;
        self.event
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, r)| moves(r))
            .map(|(s, _)| s)
            .collect()
    }

    /// Whether the next minor iteration starts from where an earlier one of this major did.
    fn find_cycle(&self, minor: u32) -> Option<Cycle> {
        let force = SAME * self.force_scale();
        let state = &self.state;
        state.trail.cycle(&state.nodes, minor, force, SAME)
    }

    /// Updates displacements and forces, renews the geometry, and asks whether the increment is done.
    fn end_major(&mut self, settled: bool) -> Outcome {
        if self.system.recover(&self.model) == Solved::Not {
            return Outcome::Failed(Failure::Singular(self.diagnose()));
        }
        self.update();
        let norms = self.norms();
        self.state.unsettled += u32::from(!settled);
        let settings = self.state.controls.settings;
        let Some(after) = norms else {
            return Outcome::Failed(Failure::Singular(Singular::Unexplained));
        };
        // The bodies' own unknowns, which come last, are forces.
        let nodal = self.model.dofs.len() - self.model.dofs.inner;
        let motions = &self.state.u[..nodal];
        let size = motions.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let bounded = after.relative.is_finite() && size < DIVERGED * self.model.length;
        let exact = after.relative <= settings.tolerance;
        let balanced = self.state.reached == self.state.load_factor
            && (exact || (after.relative <= after.limit && after.correction <= STILL))
            && after.interface <= after.limit.max(settings.tolerance);
        let at_limit = self.state.next.major.is_multiple_of(settings.majors);
        if settled && balanced {
            return self.accept(after);
        }
        if at_limit && bounded && settings.at_major_limit == AtLimit::Accept {
            self.state.unsettled += 1;
            return self.accept(after);
        }
        self.state.next.major += 1;
        self.state.next.minor = 1;
        if !bounded {
            return Outcome::Failed(Failure::Diverged {
                relative: after.relative,
            });
        }
        if settings.at_major_limit == AtLimit::Stop
            && let Some(round) = self.find_round()
        {
            self.state.forget_rounds();
            return Outcome::Failed(Failure::MajorCycle(round));
        }
        if at_limit {
            return Outcome::Failed(Failure::MajorLimit {
                limit: settings.majors,
                relative: after.relative,
                interface: after.interface,
            });
        }
        Outcome::Major { after, settled }
    }

    /// Whether the next major iteration starts from where an earlier one of this increment did.
    fn find_round(&mut self) -> Option<Round> {
        let scales = Scales {
            force: self.force_scale(),
            length: self.model.length,
        };
        let (major, slaves) = (self.state.next.major, self.state.nodes.len());
        let positions = &self.system.positions;
        let places = self.model.slaves.iter().map(|slave| positions[slave.node]);
        let rounds = Arc::make_mut(&mut self.state.rounds);
        rounds.push(&self.state.nodes, places);
        rounds.cycle(slaves, major, scales)
    }

    fn update(&mut self) {
        (self.state.reached, self.state.aim) = (self.state.aim, self.state.load_factor);
        let mut largest = 0.0_f64;
        let u = Arc::make_mut(&mut self.state.u);
        for n in 0..self.model.nodes.len() {
            for d in self.model.dofs.first[n]..self.model.dofs.first[n] + 2 {
                largest = largest.max(self.system.increment(&self.model, d).abs());
            }
        }
        for (d, u) in u.iter_mut().enumerate() {
            *u += self.system.increment(&self.model, d);
        }
        self.state.correction = largest / self.model.length;
        for (s, node) in self.state.nodes.iter_mut().enumerate() {
            let record = &self.event.nodes[s];
            (node.f_n, node.f_t) = (record.f_n, record.f_t);
            node.slip = if record.decision.before == Mode::Free {
                0.0
            } else {
                let motion = self.system.relative_motion(s);
                let touched = self.system.footing(s).map_or(0.0, |f| {
                    if node.ratio == 0.0 {
                        0.0
                    } else {
                        f.gap * node.ratio
                    }
                });
                node.slip + motion[1] - touched
            };
            if record.decision.before != Mode::Free && node.anchor.is_none() {
                node.anchor = node
                    .spot
                    .zip(self.system.footing(s))
                    .and_then(|(spot, at)| {
                        let positions = &self.system.positions;
                        pierced(&self.model.surfaces, spot, at, node.ratio, positions)
                    });
            }
            node.ratio = 0.0;
            node.travel = 0.0;
        }
        self.find_spots();
        self.linearised = self.system.linearise(&self.model, &self.state).is_ok();
        if self.state.controls.settings.residual == ResidualMethod::Stress {
            self.take_forces_from_stresses();
        }
        self.system.turn(&self.model, &self.state);
        self.state.forget_trail();
    }

    /// Projects every slave node anew. Forces keep their components in the frame that turns with the surface.
    fn find_spots(&mut self) {
        self.system.place(&self.model, &self.state.u);
        let positions = &self.system.positions;
        let holds = self.state.next.major >= HOLD_FROM;
        // Where slip is counted anew in every major iteration, so is what to stick to.
        let settings = &self.state.controls.settings;
        let anew = settings.slip == SlipCount::Major && settings.sticking == Sticking::Anchored;
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.slaves) {
            let at = positions[slave.node];
            let surfaces = &self.model.surfaces;
            let held = if holds && node.mode != Mode::Free {
                hold(at, surfaces, positions, node.spot)
            } else {
                None
            };
            node.spot =
                held.or_else(|| project(at, surfaces, &slave.surfaces, positions, node.spot));
            match node.spot {
                Some(spot) => {
                    node.normal = footing(&self.model.surfaces, spot, positions, at).normal;
                }
                None => {
                    node.mode = Mode::Free;
                    (node.f_n, node.f_t, node.t_max, node.slip) = (0.0, 0.0, 0.0, 0.0);
                }
            }
            if node.mode == Mode::Free {
                (node.f_n, node.f_t) = (0.0, 0.0);
            }
            if anew && node.mode == Mode::Sliding {
                node.anchor = node.spot;
            }
            find_anchor(node, &self.model.surfaces, positions);
        }
        self.linearised = false;
    }

    /// Anchors the nodes that bring slip into the scene as far back as they have slipped. One that has just opened is not
    /// anchored, and takes its slip back all the same, should it stick in this major iteration.
    fn place_anchors(&mut self) {
        let (surfaces, positions) = (&self.model.surfaces, &self.system.positions);
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.slaves) {
            if node.mode == Mode::Free {
                node.drift = node.slip;
            }
            let Some(spot) = node
                .spot
                .filter(|_| node.mode != Mode::Free && node.slip != 0.0)
            else {
                continue;
            };
            let footing = footing(surfaces, spot, positions, positions[slave.node]);
            let t = tangent(footing.normal);
            let point = [0, 1].map(|k| footing.foot[k] + node.slip * t[k]);
            node.anchor = project(point, surfaces, &[spot.surface], positions, Some(spot));
            find_anchor(node, surfaces, positions);
        }
    }

    /// Residual method 2: the total interaction force at a slave node is the nodal force of the current stresses
    /// less the applied load. Where a support shares the node's force, or the node is itself part of a master
    /// surface, the stresses cannot tell it apart and it stays accumulated.
    ///
    /// T_max stays that of the last minor iteration: the stresses carry the whole error of the linearisation, which
    /// can exceed F_n itself, and a first trial with such a T_max opens contacts that are closed.
    fn take_forces_from_stresses(&mut self) {
        let mut changed = false;
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.slaves) {
            let first = self.model.dofs.first[slave.node];
            let held = (0..2).any(|k| self.model.dofs.equation[first + k].is_none());
            let master = self
                .model
                .surfaces
                .iter()
                .any(|s| !s.rigid && s.elements.iter().flatten().any(|&n| n == slave.node));
            if node.mode == Mode::Free || held || master {
                continue;
            }
            let force = [
                self.system.nodal_force(first),
                self.system.nodal_force(first + 1),
            ];
            let [c, s] = node.normal;
            node.f_n = c * force[0] + s * force[1];
            node.f_t = -s * force[0] + c * force[1];
            changed = true;
        }
        if changed {
            self.system.rebalance(&self.model, &self.state);
        }
    }

    /// Makes the present state the start of the next increment.
    fn accept(&mut self, after: Norms) -> Outcome {
        let unsettled = self.state.unsettled;
        for node in &mut self.state.nodes {
            node.slip = 0.0;
            if node.mode == Mode::Sliding {
                (node.anchor, node.drift) = (node.spot, 0.0);
            }
        }
        let mut leg = self.state.start.leg;
        while leg + 1 < self.model.path.len() && self.state.load_factor == self.model.path[leg + 1]
        {
            leg += 1;
        }
        let start = Arc::make_mut(&mut self.state.start);
        start.load_factor = self.state.load_factor;
        start.leg = leg;
        self.system
            .advance(&self.state.u, &start.u, &mut start.history);
        Arc::make_mut(&mut start.u).copy_from_slice(&self.state.u);
        start.nodes.clone_from(&self.state.nodes);
        let last = leg + 1 == self.model.path.len();
        if last {
            self.state.status = Status::Finished;
        } else {
            let p = &mut self.state.next;
            (p.increment, p.attempt) = (p.increment + 1, 1);
            self.state.begin(&self.model);
            self.linearised = false;
        }
        Outcome::Increment {
            after,
            unsettled,
            last,
        }
    }

    /// Applies what the user wants changed.
    ///
    /// # Errors
    /// Those of [`State::intervene`].
    pub fn intervene(&mut self, intervention: &Intervention) -> Result<(), String> {
        self.linearised = false;
        self.state.intervene(&self.model, intervention)
    }

    /// Values of the scene's monitors at the start of the present major iteration (after an accepted increment: at
    /// its end), appended to `out`.
    pub fn monitors(&mut self, out: &mut Vec<f64>) {
        self.linearise();
        for monitor in &self.model.monitors {
            out.push(match &monitor.of {
                Watched::Displacement { dof } => self.state.u[*dof],
                Watched::Contact { slaves, axis } => {
                    let k = if *axis == Axis::X { 0 } else { 1 };
                    slaves.iter().map(|&s| self.state.nodes[s].force()[k]).sum()
                }
                Watched::Drift { slaves } => slaves.iter().fold(0.0, |largest: f64, &s| {
                    let drift = self.state.nodes[s].drift;
                    if drift.abs() > largest.abs() {
                        drift
                    } else {
                        largest
                    }
                }),
                Watched::Reaction { dof } => {
                    self.system.nodal_force(*dof) - self.system.interaction(*dof)
                }
            });
        }
    }
}

/// Gives a touching node that has no anchor one where it stands, takes it from a free one, and measures the drift. A node
/// that has come to another surface is anchored anew there.
fn find_anchor(node: &mut NodeState, surfaces: &[Surface], positions: &[[f64; 2]]) {
    let (Some(spot), true) = (node.spot, node.mode != Mode::Free) else {
        (node.anchor, node.drift) = (None, 0.0);
        return;
    };
    let anchor = node.anchor.filter(|a| a.surface == spot.surface);
    node.anchor = anchor.or(Some(spot));
    node.drift = anchor.map_or(0.0, |anchor| {
        distance(&surfaces[spot.surface], spot, anchor, positions)
    });
}
