//! The two-level iteration (increments > major > minor) as a state machine: one call, one minor iteration.
//!
//! ```text
//! increment   the load factor moves on
//!   major     geometry, stiffness and residual are renewed and frozen          System::linearise
//!     minor   solve for the assumed modes, check them by Table 2, assume anew   Stepper::step
//!   until modes and T_max have settled; then displacements and forces are updated
//! until residual and interface conditions are within the tolerance; then the increment is accepted
//! ```

use crate::contact::judge::{Finding, Verdict};
use crate::contact::record::{ContactRecord, Forced};
use crate::contact::state::ContactState;
use crate::contact::stick_point::pierced;
use crate::contact::table1::t_max;
use crate::contact::table2::{Decision, Rule, Test, Tested, Ties};
use crate::contact::tracking::Ground;
use crate::interface::census::{Census, census};
use crate::interface::lemke::{End, Lemke, STARTS};
use crate::interface::minor::{self, Check, carried, judge};
use crate::interface::problem::{Assumed, InterfaceProblem, NodeAnswer};
use crate::linear::norms::Norms;
use crate::linear::singular;
use crate::linear::singular::Singular;
use crate::linear::system::{Solved, System};
use crate::model::Watched;
use crate::model::{AtCycle, AtLimit, Axis, ResidualMethod, SlipCount, Sticking, Strategy};
use crate::model::{Mode, Model};
use crate::step::event::{Event, Failure, Outcome, Position};
use crate::step::intervene::Intervention;
use crate::step::major_history::{MajorCycle, Scales};
use crate::step::minor_history::Cycle;
use crate::step::minor_history::Input;
use crate::step::state::{IncrementStart, Pivoting, Search, State, Status};
use crate::step::sub_increment::SubIncrement;
use crate::step::verdict::Bench;
use crate::strategy::NotFound;
use crate::strategy::{LADDER, one_at_a_time};
use std::sync::Arc;

/// A displacement this many times the scene's length is divergence.
const DIVERGED: f64 = 1e4;
/// Two states of a minor loop whose numbers differ by less than this, relatively, are the same. It is far below any
/// tolerance, so that T_max that converges slowly has settled before two rounds look alike.
const SAME: f64 = 1e-14;
/// Where round-off keeps the residual above the tolerance, displacements must have come to rest within this part of
/// the length instead.
const STILL: f64 = 1e-8;
/// Forces this many times larger than the interface's stiffness over the scene's length are no forces.
const UNBOUNDED: f64 = 1e10;
/// MajorHistory that all changes at once may go on without getting fewer.
const PATIENCE: u32 = 10;
/// Sums of halves of an increment are this exact.
const ROUNDING: f64 = 1e-9;
/// A major iteration is not damped below this part of its load.
const SMALLEST_PART: f64 = 1e-6;

/// The solver: a state, and the workspace that is made from it.
pub struct Stepper {
    pub(super) model: Arc<Model>,
    pub(super) state: State,
    pub(super) system: System,
    /// Whether `system` is linearised about `state`.
    pub(super) linearised: bool,
    /// The pivoting of the present major iteration, with its start and the pivots done.
    lemke: Option<(Lemke, usize, usize)>,
    /// What the nodes came with into the present minor iteration, where only one of them may change.
    before: Vec<ContactState>,
    event: Event,
    pub(super) bench: Bench,
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
                nodes: Vec::with_capacity(model.contacts.len()),
                before: Norms::default(),
                outcome: Outcome::Minor,
            },
            state,
            linearised: false,
            lemke: None,
            before: Vec::new(),
            bench: Bench::new(&model),
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
        self.lemke = None;
    }

    /// Current norms and whether they could be computed: those about which the next minor iteration is linearised.
    pub fn norms(&mut self) -> Option<Norms> {
        self.linearise().then(|| self.system.norms())
    }

    /// Whether the minor iterations are solved on the condensed interface.
    pub fn condenses(&self) -> bool {
        self.system.condenses(&self.state.controls.settings)
    }

    /// The frozen interface problem of the present major iteration; none where the bodies cannot be condensed.
    pub fn frozen(&mut self) -> Option<InterfaceProblem> {
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
            return self.fail(Failure::Singular(Singular::Unexplained));
        }
        self.event.before = self.system.norms_of(&self.model, &self.state);
        let strategy = self.state.settings().strategy;
        if let (Strategy::Lemke | Strategy::Census, Pivoting::At { start, pivot }) =
            (strategy, self.state.search.pivoting)
        {
            self.state.minors += 1;
            return match strategy {
                Strategy::Lemke => self.pivot(start, pivot),
                _ => self.try_all(),
            };
        }
        Arc::make_mut(&mut self.state.minor_history).push(&self.state.nodes);
        let solved = self.system.solve(&self.model, &self.state);
        match solved {
            Solved::Well => {}
            Solved::NearlySingular => {
                let singular = self.diagnose();
                if matches!(singular, Singular::Rigid { .. }) {
                    return self.stuck(Failure::Singular(singular));
                }
            }
            Solved::Not => {
                let singular = self.diagnose();
                return self.stuck(Failure::Singular(singular));
            }
        }
        if let Some(failure) = self.jammed() {
            return self.stuck(failure);
        }
        self.state.minors += 1;
        let settled = self.judge();
        if settled && solved == Solved::NearlySingular && self.is_unbounded() {
            return self.stuck(Failure::Singular(Singular::Unexplained));
        }
        if settled {
            return match self.unsupported() {
                Some(first) => self.fail(first),
                None => self.end_major(true),
            };
        }
        self.go_on()
    }

    /// Whether the last solve gave forces out of all proportion: those of a singular system, kept finite by round-off.
    fn is_unbounded(&self) -> bool {
        let natural = self.system.spring(&self.model) * self.model.length;
        (0..self.state.nodes.len()).any(|slave| {
            let forces = self.system.force_increment(slave);
            forces.iter().any(|f| f.abs() > UNBOUNDED * natural)
        })
    }

    /// What failed before a ladder found a state in which nothing is pressed: where the equations were singular, such a
    /// state holds nothing that was loose.
    fn unsupported(&self) -> Option<Failure> {
        let first = self.state.search.first.as_deref()?;
        let force = self.ties().force;
        let pressed = |record: &ContactRecord| record.f_n > force;
        let loose = matches!(first, Failure::Singular(_)) && !self.event.nodes.iter().any(pressed);
        loose.then(|| first.clone())
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
            stuck.then_some(Failure::OverConstrained { slave, gap })
        })
    }

    fn ties(&self) -> Ties {
        let settings = &self.state.controls.settings;
        Ties {
            force: settings.tolerance * self.force_scale(),
            length: settings.tolerance * self.model.length,
            keep: settings.ties == crate::model::Ties::Keep,
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

    /// Checks every node's mode and records it; true where modes and T_max have settled.
    ///
    /// Leaves the modes of the next minor iteration in the state.
    fn judge(&mut self) -> bool {
        let settings = self.state.settings();
        let check = Check {
            settings,
            ties: self.ties(),
            stiffness: match settings.strategy {
                Strategy::Newton => self.system.spring(&self.model),
                _ => 1.0,
            },
        };
        let mut settled = true;
        let controls = self.state.controls.clone();
        let singly = one_at_a_time(settings.strategy, self.is_stalled());
        if singly {
            self.before.clone_from(&self.state.nodes);
        }
        for (slave, node) in self.state.nodes.iter_mut().enumerate() {
            let site = self.system.site(slave, node);
            let given = self.system.given(slave);
            let friction = node.friction(&controls.friction[slave]);
            let (record, still) = judge(node, &site, given, &friction, &check);
            settled &= still;
            self.event.nodes.push(record);
        }
        if settings.strategy == Strategy::Block {
            self.count_changes();
        }
        if singly {
            minor::one_at_a_time(&mut self.state.nodes, &self.before, &mut self.event.nodes);
        }
        settled
    }

    /// Whether all changes at once have gone on for long without getting fewer.
    fn is_stalled(&self) -> bool {
        self.state.search.rounds > PATIENCE
    }

    /// Counts the rounds since fewer nodes changed than ever before in this major iteration. What went before a change
    /// of pace tells nothing of cycles.
    fn count_changes(&mut self) {
        let all = self.event.nodes.iter();
        let changing = all.filter(|record| record.decision.changes()).count();
        let stalled = self.is_stalled();
        let search = &mut self.state.search;
        if search.fewest.is_none_or(|fewest| changing < fewest) {
            (search.fewest, search.rounds) = (Some(changing), 0);
        } else {
            search.rounds += 1;
        }
        if self.is_stalled() != stalled {
            self.state.forget_trail();
        }
    }

    /// The minor loop has not settled: look for a cycle and at the limit, and count on.
    fn go_on(&mut self) -> Outcome {
        let settings = self.state.settings();
        if matches!(settings.strategy, Strategy::Lemke | Strategy::Census) {
            return self.begin_pivoting();
        }
        let accept = settings.at_minor_limit == AtLimit::Accept;
        let minor = self.state.next.minor;
        let tried = self.state.minor_history.len(self.state.nodes.len()) as u32;
        let at_limit = tried > 0 && tried.is_multiple_of(settings.minors);
        if at_limit && accept {
            return self.end_major(false);
        }
        let moves_on = settings.strategy == Strategy::Block && !self.is_stalled();
        if !accept
            && !moves_on
            && let Some(cycle) = self.find_cycle(minor)
        {
            if settings.at_cycle == AtCycle::Damp && self.damp() {
                self.state.next.minor += 1;
                return Outcome::Damped {
                    cycle,
                    aim: self.state.target,
                };
            }
            return self.stuck(Failure::Cycle(cycle));
        }
        if at_limit {
            let changing = self.changing();
            return self.stuck(Failure::MinorLimit {
                limit: settings.minors,
                changing,
            });
        }
        self.state.next.minor += 1;
        Outcome::Minor
    }

    /// The strategy cannot go on: the ladder's next one takes over, from where the major iteration began. Where there is
    /// none, the increment fails.
    fn stuck(&mut self, why: Failure) -> Outcome {
        let looks_at_all = matches!(
            self.state.settings().strategy,
            Strategy::Lemke | Strategy::Census
        );
        if looks_at_all && self.state.search.pivoting == Pivoting::Not {
            return self.begin_pivoting();
        }
        let strategy = self.state.controls.settings.strategy;
        let held = |node: &ContactState| matches!(node.forced, Forced::Held(_));
        if strategy != Strategy::Ladder || self.state.nodes.iter().any(held) {
            let unsolved = matches!(why, Failure::Singular(_) | Failure::OverConstrained { .. });
            self.state.next.minor += u32::from(!unsolved);
            self.state.forget_trail();
            return self.fail(why);
        }
        self.begin_again();
        let search = &mut self.state.search;
        let first = search.first.get_or_insert_with(|| Box::new(why.clone()));
        if let Some(&to) = LADDER.get(search.rung + 1) {
            search.rung += 1;
            (search.fewest, search.rounds, search.pivoting) = (None, 0, Pivoting::Not);
            self.state.next.minor += 1;
            return Outcome::Climbed { why, to };
        }
        let first = first.clone();
        self.state.search = Search::default();
        match (*first, why) {
            (
                first @ (Failure::Singular(Singular::Rigid { .. })
                | Failure::OverConstrained { .. }),
                _,
            ) => self.fail(first),
            (_, why @ Failure::NoAnswer { .. }) => self.fail(why),
            (first, last) => self.fail(Failure::LadderEnded {
                first: Box::new(first),
                last: Box::new(last),
            }),
        }
    }

    /// Gives the nodes what they brought into the present major iteration.
    fn begin_again(&mut self) {
        self.take_back();
        self.state.forget_trail();
    }

    fn take_back(&mut self) {
        let first = self.state.minor_history.first(self.state.nodes.len());
        for (node, input) in self.state.nodes.iter_mut().zip(first) {
            (node.mode, node.ratio) = (input.mode, input.ratio);
            if input.mode == Mode::Sliding {
                (node.t_max, node.sign) = (input.t_max, input.t_max.signum());
            }
        }
    }

    /// The modes that were tried do not hold: the next start of pivoting, or the next answer of the census.
    fn begin_pivoting(&mut self) -> Outcome {
        let search = &mut self.state.search;
        let start = match search.pivoting {
            Pivoting::Not => {
                search.unconfirmed = 0;
                0
            }
            Pivoting::At { start, .. } => start + 1,
            Pivoting::Found { start } => {
                search.unconfirmed += 1;
                start + 1
            }
        };
        search.pivoting = Pivoting::At { start, pivot: 0 };
        self.take_back();
        self.state.next.minor += 1;
        Outcome::Minor
    }

    /// One pivot of Lemke's, from a start; where that has ended on a ray, the next start is next.
    fn pivot(&mut self, start: usize, pivot: usize) -> Outcome {
        let path = match self.lemke.take() {
            Some(path) if (path.1, path.2) == (start, pivot) => Ok(path),
            _ => self.path(start, pivot),
        };
        let (mut lemke, start, mut pivot) = match path {
            Ok(path) => path,
            Err(why) => return self.stuck(Failure::NotFound(why)),
        };
        // It has ended already where its start is the answer.
        if lemke.pivot().is_some() {
            pivot += 1;
        }
        let (cover, bound, ended) = (lemke.cover(), lemke.bound(), lemke.ended());
        let told: Vec<(Assumed, [f64; 4])> = (0..self.state.nodes.len())
            .map(|place| (lemke.assumed(place), lemke.numbers(place)))
            .collect();
        self.lemke = Some((lemke, start, pivot));
        self.state.search.pivoting = match ended {
            None => Pivoting::At { start, pivot },
            Some(End::Solved) => Pivoting::Found { start },
            Some(End::Ray | End::Astray) => Pivoting::At {
                start: start + 1,
                pivot: 0,
            },
        };
        let rule = match ended {
            Some(End::Solved) => Rule::Found,
            _ => Rule::Pivots,
        };
        for (slave, (assumed, numbers)) in told.into_iter().enumerate() {
            self.assume(slave, assumed, numbers, rule, cover);
        }
        if let Some((slave, tested)) = bound {
            self.event.nodes[slave].decision.tests[1] = Some(Test {
                tested,
                value: 0.0,
                bound: 0.0,
                margin: 0.0,
                tie: false,
            });
        }
        self.state.next.minor += 1;
        Outcome::Minor
    }

    /// The tableau after this many pivots from a start, or from the first one behind it whose basis is regular.
    fn path(&mut self, start: usize, pivot: usize) -> Result<(Lemke, usize, usize), NotFound> {
        let problem = self.system.frozen(&self.model, &self.state);
        let problem = problem.map_err(|_| NotFound::NotCondensed)?;
        let brought = self.brought();
        let mut starts = (start..STARTS)
            .filter_map(|number| Some((Lemke::new(&problem, &brought, number)?, number)));
        let Some((mut lemke, found)) = starts.next() else {
            return Err(match (start, self.state.search.unconfirmed) {
                (0, _) => NotFound::NoStart,
                (_, 0) => NotFound::Ray,
                (_, states) => NotFound::Unconfirmed { states },
            });
        };
        let pivot = if found == start { pivot } else { 0 };
        for _ in 0..pivot {
            lemke.pivot();
        }
        Ok((lemke, found, pivot))
    }

    /// What the nodes brought into the present major iteration.
    fn brought(&self) -> Vec<Assumed> {
        let first = self.state.minor_history.first(self.state.nodes.len());
        let of = |input: &Input| Assumed::of(input.mode, input.t_max);
        first.iter().map(of).collect()
    }

    /// Takes the next answer of a census over all nodes that can touch.
    fn try_all(&mut self) -> Outcome {
        let number = match self.state.search.pivoting {
            Pivoting::At { start, .. } => start,
            _ => 0,
        };
        let (undecided, census) = match self.census() {
            Ok(held) => held,
            Err(why) => return self.stuck(Failure::NotFound(why)),
        };
        let Some(found) = census.answers.get(number) else {
            return self.stuck(match census.answers.len() {
                0 => Failure::NoAnswer {
                    first: self.state.search.first.clone(),
                    tried: census.tried,
                },
                states => Failure::NotFound(NotFound::Unconfirmed { states }),
            });
        };
        let free = (Assumed::Free, [0.0, 0.0, f64::INFINITY, 0.0]);
        let mut told = vec![free; self.state.nodes.len()];
        for (&place, node) in undecided.iter().zip(&found.answer.nodes) {
            let numbers = [node.f_n, node.f_t, node.gap, node.slip];
            told[place] = (node.assumed, numbers);
        }
        for (slave, (assumed, numbers)) in told.into_iter().enumerate() {
            self.assume(slave, assumed, numbers, Rule::Found, 0.0);
        }
        self.state.search.pivoting = Pivoting::Found { start: number };
        self.state.next.minor += 1;
        Outcome::Minor
    }

    /// The nodes that can touch, and a census over them, those answers first that change the least.
    fn census(&mut self) -> Result<(Vec<usize>, Census), NotFound> {
        let problem = self.system.frozen(&self.model, &self.state);
        let problem = problem.map_err(|_| NotFound::NotCondensed)?;
        let undecided: Vec<usize> = (0..problem.nodes.len())
            .filter(|&place| problem.nodes[place].choices().len() > 1)
            .collect();
        let problem = problem.reduced(&undecided).ok_or(NotFound::Loose)?;
        let nodes = undecided.len();
        let mut census = census(&problem).map_err(|_| NotFound::TooMany { nodes })?;
        let brought = self.brought();
        let differs = |(place, node): (&usize, &NodeAnswer)| brought[*place] != node.assumed;
        census.answers.sort_by_key(|found| {
            let all = undecided.iter().zip(&found.answer.nodes);
            all.filter(|&pair| differs(pair)).count()
        });
        Ok((undecided, census))
    }

    /// Records what pivoting or the census has a node do, and leaves it in the state.
    fn assume(
        &mut self,
        slave: usize,
        assumed: Assumed,
        [f_n, f_t, gap, slip]: [f64; 4],
        rule: Rule,
        cover: f64,
    ) {
        let node = &mut self.state.nodes[slave];
        let friction = node.friction(&self.state.controls.friction[slave]);
        let site = self.system.site(slave, node);
        let before = node.mode;
        node.mode = assumed.mode();
        node.ratio = 0.0;
        node.sign = assumed.sign();
        let sign = if f_t == 0.0 { node.sign } else { f_t.signum() };
        node.t_max = t_max(&friction, f_n, sign);
        let test = Test {
            tested: Tested::Cover,
            value: cover,
            bound: 0.0,
            margin: -cover,
            tie: false,
        };
        let off = site.gap.is_infinite();
        let rule = if off { Rule::OffSurface } else { rule };
        self.event.nodes.push(ContactRecord {
            decision: Decision {
                before,
                next: node.mode,
                rule,
                tests: [(!off).then_some(test), None],
                wanted: node.mode,
            },
            forced: node.forced,
            gap,
            f_n,
            f_t,
            t_max: node.t_max,
            t_max_used: node.t_max,
            slip,
            drift: node.drift,
            spot: node.spot,
            normal: site.normal,
            foot: site.foot,
            carried: [false; 2],
        });
    }

    /// The increment fails; on the ladder it is cut, where that can help and it is not at its smallest yet.
    fn fail(&mut self, why: Failure) -> Outcome {
        match self.cut(&why) {
            Some(cut) => cut,
            None => Outcome::Failed(why),
        }
    }

    /// Starts the increment again with half its size; none where the strategy does not, where that cannot help, and where it
    /// is at its smallest.
    pub(super) fn cut(&mut self, why: &Failure) -> Option<Outcome> {
        let controls = &self.state.controls;
        let helps = match why {
            Failure::OverConstrained { .. } | Failure::RoundOff { .. } => false,
            Failure::Singular(Singular::Rigid { .. }) => !self.starts_loose(),
            _ => true,
        };
        let half = self.state.sub_increment.halved();
        let least = controls.least * (1.0 - ROUNDING);
        if controls.settings.strategy != Strategy::Ladder
            || !helps
            || half.size() < least
            || half.size() == 0.0
        {
            return if helps { self.leap_over(why) } else { None };
        }
        self.restart(half);
        let (why, size) = (why.clone(), half.size());
        Some(Outcome::Cut { why, size })
    }

    /// Starts the increment again, up to the end of this piece.
    pub(super) fn restart(&mut self, piece: SubIncrement) {
        self.state.sub_increment = piece;
        self.state.start_again();
        self.linearised = false;
        self.lemke = None;
    }

    /// Whether nothing holds a body in the modes that the increment starts with, whatever its size.
    fn starts_loose(&self) -> bool {
        let start = &self.state.start.nodes;
        let footing = |s: usize| self.system.footing(s);
        let found = singular::diagnose(&self.model, &self.system.positions, start, footing);
        matches!(found, Singular::Rigid { .. })
    }

    /// Starts the minor iterations of this major one again, with half the load; false if too little is left of it.
    fn damp(&mut self) -> bool {
        let left = self.state.target - self.state.last_target;
        if left.abs()
            < SMALLEST_PART * (self.state.load_factor - self.state.start.load_factor).abs()
        {
            return false;
        }
        self.state.target = self.state.last_target + left / 2.0;
        self.linearised = false;
        self.begin_again();
        true
    }

    /// Contact nodes whose mode or T_max still changed in the last minor iteration.
    fn changing(&self) -> Vec<usize> {
        let force = self.ties().force;
        let moves =
            |r: &ContactRecord| r.decision.changes() || (r.t_max - r.t_max_used).abs() > force;
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
        state.minor_history.cycle(&state.nodes, minor, force, SAME)
    }

    /// Updates displacements and forces, renews the geometry, and asks whether the increment is done.
    fn end_major(&mut self, settled: bool) -> Outcome {
        if self.system.recover(&self.model) == Solved::Not {
            let singular = self.diagnose();
            return self.fail(Failure::Singular(singular));
        }
        self.update();
        let search = &mut self.state.search;
        (search.first, search.fewest, search.rounds) = (None, None, 0);
        search.pivoting = Pivoting::Not;
        self.lemke = None;
        let norms = self.norms();
        self.state.unsettled += u32::from(!settled);
        let settings = self.state.controls.settings;
        let Some(after) = norms else {
            return self.fail(Failure::Singular(Singular::Unexplained));
        };
        let size = self.system.sizes.largest_motion(&self.state.u);
        let bounded = after.relative.is_finite() && size < DIVERGED * self.model.length;
        let exact = after.relative <= settings.tolerance;
        let balanced = self.state.last_target == self.state.load_factor
            && (exact || (after.relative <= after.limit && after.correction <= STILL))
            && after.interface <= after.limit.max(settings.tolerance);
        let at_limit = self.state.next.major.is_multiple_of(settings.majors);
        let drowned = after.noise > Norms::LOUDEST;
        if settled && balanced && !drowned {
            return self.finish(after);
        }
        let accepts = settings.at_major_limit == AtLimit::Accept && !drowned;
        if at_limit && bounded && accepts {
            self.state.unsettled += 1;
            return self.finish(after);
        }
        self.state.next.major += 1;
        self.state.next.minor = 1;
        if !bounded {
            return self.fail(Failure::Diverged {
                relative: after.relative,
            });
        }
        if drowned && (at_limit || settled && balanced) {
            return self.fail(Failure::RoundOff { noise: after.noise });
        }
        if settings.at_major_limit == AtLimit::Stop
            && let Some(round) = self.find_round()
        {
            self.state.forget_rounds();
            return self.fail(Failure::MajorCycle(round));
        }
        if at_limit {
            return self.fail(Failure::MajorLimit {
                limit: settings.majors,
                relative: after.relative,
                interface: after.interface,
            });
        }
        Outcome::Major { after, settled }
    }

    /// Whether the next major iteration starts from where an earlier one of this increment did.
    fn find_round(&mut self) -> Option<MajorCycle> {
        let scales = Scales {
            force: self.force_scale(),
            length: self.model.length,
        };
        let (major, slaves) = (self.state.next.major, self.state.nodes.len());
        let positions = &self.system.positions;
        let places = self
            .model
            .contacts
            .iter()
            .map(|slave| positions[slave.node]);
        let rounds = Arc::make_mut(&mut self.state.major_history);
        rounds.push(&self.state.nodes, places);
        rounds.cycle(slaves, major, scales)
    }

    fn update(&mut self) {
        (self.state.last_target, self.state.target) = (self.state.target, self.state.load_factor);
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
        if self.state.next.major == 1 {
            self.state.pace.predicted = largest;
        }
        for (s, node) in self.state.nodes.iter_mut().enumerate() {
            let record = &self.event.nodes[s];
            (node.f_n, node.f_t) = (record.f_n, record.f_t);
            node.slip = if record.decision.before == Mode::Free && !node.kept {
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
        self.state.forget_trail();
        self.find_spots();
        self.linearised = self.system.linearise(&self.model, &self.state).is_ok();
        if self.state.controls.settings.residual == ResidualMethod::Stress {
            self.take_forces_from_stresses();
        }
        self.system.turn(&self.model, &self.state);
    }

    /// Finds anew where every slave node stands.
    fn find_spots(&mut self) {
        self.system.place(&self.model, &self.state.u);
        // Where slip is counted anew in every major iteration, so is what to stick to.
        let settings = &self.state.controls.settings;
        let anew = settings.slip == SlipCount::Major && settings.sticking == Sticking::Anchored;
        let ground = Ground {
            surfaces: &self.model.surfaces,
            positions: &self.system.positions,
        };
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.contacts) {
            ground.stand(node, slave, anew);
        }
        self.linearised = false;
    }

    /// Anchors the nodes that bring slip into the scene as far back as they have slipped.
    fn place_anchors(&mut self) {
        let ground = Ground {
            surfaces: &self.model.surfaces,
            positions: &self.system.positions,
        };
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.contacts) {
            ground.place_anchor(node, slave);
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
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.contacts) {
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
    pub(super) fn accept(
        &mut self,
        after: Norms,
        verdict: Verdict,
        marked: Option<Finding>,
        jumped: bool,
    ) -> Outcome {
        let unsettled = self.state.unsettled;
        for node in &mut self.state.nodes {
            (node.slip, node.left, node.kept) = (0.0, None, false);
            if node.mode == Mode::Sliding {
                (node.anchor, node.drift) = (node.spot, 0.0);
            } else if node.corner.is_some() {
                node.anchor = node.spot;
            } else if node.mode == Mode::Free {
                (node.anchor, node.drift) = (None, 0.0);
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
        start.verdict = Some(verdict);
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
            let whole = || {
                SubIncrement::whole(
                    &self.model,
                    &self.state.start,
                    self.state.controls.increment,
                )
            };
            self.state.sub_increment = self.state.sub_increment.next().unwrap_or_else(whole);
            self.state.begin();
            let stands = self.model.prescribed.is_empty() && self.state.start.history.is_empty();
            self.linearised &= stands;
            if self.linearised {
                self.system.aim(&self.model, &self.state);
            }
        }
        Outcome::Increment {
            after,
            unsettled,
            marked,
            jumped,
            last,
        }
    }

    /// Applies what the user wants changed.
    ///
    /// # Errors
    /// Those of [`State::intervene`].
    pub fn intervene(&mut self, intervention: &Intervention) -> Result<(), String> {
        self.linearised = false;
        self.lemke = None;
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
                // The load is that of the displacements at hand, not the one that is aimed at next.
                Watched::Reaction { dof } => {
                    let loads = self.model.loads.iter().filter(|load| load.dof == *dof);
                    let load: f64 = loads
                        .map(|l| l.value * l.scale.at(self.state.last_target))
                        .sum();
                    self.system.internal()[*dof] - load - self.system.interaction(*dof)
                }
            });
        }
    }
}
