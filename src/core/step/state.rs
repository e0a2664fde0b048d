//! The data that determine the next minor iteration.
//!
//! A state is cheap to clone, since data that rarely change are shared. A run continued from a restored state is bit-identical to
//! an uninterrupted one. Data that can be recomputed (geometry, stiffness, factors) are not stored.

use crate::fem::assembly::history_len;
use crate::interface::line_search::LineSearch;
use crate::interface::minor_history::MinorHistory;
use crate::linear::source::AcceptedState;
use crate::model::least;
use crate::model::{Control, Geometry, SearchBudget, SearchMode, SlipCount};
use crate::step::arc_state::ArcState;
use crate::step::intervention::Value;
use crate::step::major_history::MajorHistory;
use crate::step::recovery::fallback::FallbackState;
use crate::step::recovery::proximal::SlipStiffness;
use crate::step::watch::StabilityWatch;
use crate::strategy;
use crate::{
    ContactState, Failure, Fallback, Friction, Intervention, LinearisationPoint, Model, Motion,
    Pace, Position, SearchProgress, Settings, SubIncrement, Verdict,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// State of the solver between two minor iterations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "SerializedState", from = "SerializedState")]
pub struct State {
    /// Position of the next minor iteration.
    pub next: Position,
    /// Load factor at the end of the current increment.
    pub load_factor: f64,
    /// Values of all degrees of freedom ([`crate::model::Dofs`]) at the start of the current major iteration.
    pub u: Arc<Vec<f64>>,
    /// The interface, one entry per slave node.
    pub nodes: Vec<ContactState>,
    /// State at the start of the current increment.
    pub start: Arc<IncrementStart>,
    /// Values that the user can change during a run.
    pub controls: Arc<Controls>,
    /// The part of an increment that is being solved.
    pub sub_increment: SubIncrement,
    /// The current major iteration.
    pub major: MajorState,
    /// The current attempt at the increment.
    pub attempt: AttemptState,
    /// The recoveries in progress.
    pub recovery: RecoveryState,
    /// Records of the whole run.
    pub record: RunRecord,
    /// Arc-length data of the path. `None` under load control.
    pub way: Option<Box<ArcState>>,
    /// Position of an attached solver, which stores its own data. `None` for the built-in solver.
    pub outside: Option<Box<ExternalState>>,
    /// Whether and how the solver can continue.
    pub status: Status,
}

/// State of a major iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct MajorState {
    /// Starts of its minor iterations, to detect a cycle.
    pub minor_history: Arc<MinorHistory>,
    /// Its line search. `None` with full steps.
    pub line: Option<Arc<LineSearch>>,
    /// Its target load factor: [`State::load_factor`], unless it was damped.
    pub target: f64,
    /// Target load factor of the last major iteration; initially the one at the start of the increment.
    pub last_target: f64,
    /// Largest displacement change in the last major iteration over the length scale.
    pub correction: f64,
    /// Displacements at which the current stiffness of the bodies was computed; `None` for those of the current major iteration
    /// ([`crate::model::Refactor`]).
    pub factored: Option<Arc<Vec<f64>>>,
}

/// State of an attempt at an increment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AttemptState {
    /// Starts of its major iterations, to detect a cycle.
    pub major_history: Arc<MajorHistory>,
    /// Progress of the strategy.
    pub search: Progress,
    /// Minor iterations done.
    pub minors: u32,
    /// Loops whose limit was reached and accepted.
    pub unsettled: u32,
    /// Whether nodes that touched when the increment started keep their anchors from there: the judge has refused a state of the
    /// attempt ([`crate::contact::judge`]).
    pub net: bool,
}

/// States of the recoveries. `None` where a recovery is not in progress.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecoveryState {
    /// Number of cuts of the current whole increment because of a slave node, by node; empty before the first such cut.
    pub cuts: BTreeMap<usize, u32>,
    /// How sliding is held back in the current attempt ([`crate::step::recovery::proximal`]).
    pub brake: Option<SlipStiffness>,
    /// Damped motion past a limit point; each of its steps is an attempt at the increment.
    pub motion: Option<Motion>,
    /// The fallback that is tried if the halves of the increment have failed.
    pub fallback: Option<FallbackState>,
}

/// Records of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunRecord {
    /// How fast the scene moves.
    pub pace: Pace,
    /// Stability of the accepted states that were checked.
    pub watch: StabilityWatch,
    /// The searches done so far.
    pub searched: SearchRecord,
}

/// Position of an attached solver, and the changes to send before its next iteration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ExternalState {
    /// Number of the state from which it continues; 0 is the start.
    pub place: u64,
    /// Changes since then, in order.
    pub asked: Vec<Intervention>,
    /// Parameters that differ from their initial values, by name.
    pub set: Vec<(String, Value)>,
    /// Largest contact force up to this state. Replay recomputes it, so it is not stored.
    #[serde(skip)]
    pub largest_force: f64,
}

/// Record of the search for recoveries in a run ([`SearchBudget`]). Costs are numbers of factorizations: one of the
/// interface for each minor iteration, one of the bodies for each major iteration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SearchRecord {
    /// Cost of all searches.
    pub spent: u32,
    /// Cost of the rest of the run.
    #[serde(default)]
    pub run: u32,
    /// Whether a major iteration without the change of the contact geometry in its tangent has helped.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub frozen: bool,
    /// Whether the change of the contact geometry is in the tangent although the scene freezes it: that has helped.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub geometry: bool,
    /// The fallback of the search that helped last; the next failed increment tries it first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adopted: Option<Fallback>,
    /// Load factor of the equilibrium from which the last damped motion began.
    pub released: Option<f64>,
    /// That equilibrium, while the motion is in progress.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Arc<IncrementStart>>,
}

/// Limit of the cost of searches over that of the rest of the run, unless the scene sets one.
const WORTH: u32 = 4;

impl SearchRecord {
    /// Whether a fallback may continue within the budget; automatically, it is [`WORTH`] times the cost of the run, and once more
    /// for the last fallback. Smaller increments may spend half of it.
    pub(super) fn can_afford(&self, by: Fallback, budget: SearchBudget) -> bool {
        let limit = match budget {
            SearchBudget::Mode(SearchMode::Off) => 0,
            SearchBudget::Limit(limit) if limit > 0 => limit,
            _ if by == Fallback::Longer => self.run.saturating_mul(WORTH + 1),
            _ => self.run.saturating_mul(WORTH),
        };
        match by {
            Fallback::Deeper => self.spent < limit / 2,
            _ => self.spent < limit,
        }
    }

    /// Whether no search was done yet.
    pub fn is_new(&self) -> bool {
        *self == SearchRecord::default()
    }
}

/// Whether the solver can continue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Status {
    /// In the middle of an increment, or before one.
    Running,
    /// The increment failed in the last minor iteration; stepping may continue.
    Failed(Failure),
    /// The history is finished.
    Finished,
}

/// The last accepted state, from which an increment can be retried.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IncrementStart {
    /// Load factor of the state.
    pub load_factor: f64,
    /// Leg of the path that contains the current increment: from corner `leg` to corner `leg + 1`.
    pub leg: usize,
    /// Values of all degrees of freedom.
    pub u: Arc<Vec<f64>>,
    /// The interface, one entry per slave node.
    pub nodes: Vec<ContactState>,
    /// Internal variables of the elements ([`crate::fem::assembly::Assembly::advance`]); zeros before the first increment.
    pub history: Vec<f64>,
    /// Verdict of the judge when the state was accepted. `None` before the first increment.
    pub verdict: Option<Verdict>,
}

/// Progress of the strategy ([`crate::strategy`]).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Current rung of the ladder in this increment.
    pub rung: usize,
    /// Why the first rung failed in the current major iteration.
    pub first: Option<Box<Failure>>,
    /// Minimum number of nodes that changed at once in the current major iteration.
    pub fewest: Option<usize>,
    /// Minor iterations since that minimum.
    pub rounds: u32,
    /// Progress of the search over all nodes in the current major iteration.
    #[serde(rename = "pivoting")]
    pub searched: SearchProgress,
    /// Number of states found by it that were not confirmed.
    pub unconfirmed: usize,
    /// Whether the tangent of the current major iteration omits the change of the contact geometry: with it, no strategy found
    /// consistent modes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub frozen: bool,
}

/// Values that the user can change during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Controls {
    /// Increment of the load factor. If each leg of the path has its own, the next leg begins with that.
    pub increment: f64,
    /// Size below which a failed increment is not cut.
    pub least: f64,
    /// Friction of each slave node.
    pub friction: Vec<Friction>,
    /// The settings chosen by the user.
    pub settings: Settings,
}

impl IncrementStart {
    /// Load factor and leg of the path.
    pub fn place(&self) -> (f64, usize) {
        (self.load_factor, self.leg)
    }
}

impl State {
    /// State of built-in bodies before their first increment.
    pub fn new(model: &Model) -> Self {
        let (u, history) = (vec![0.0; model.dofs.len()], vec![0.0; history_len(model)]);
        State::at_start(model, u, history)
    }

    /// State of a scene before its first increment, with a source's unknowns and the internal variables of its elements.
    pub fn at_start(model: &Model, u: Vec<f64>, history: Vec<f64>) -> Self {
        let u = Arc::new(u);
        let nodes: Vec<ContactState> = model
            .contacts
            .iter()
            .map(|slave| ContactState::new(slave.start, &slave.state))
            .collect();
        let load_factor = model.path[0];
        let increment = model.on_leg(0);
        let controls = Controls {
            increment,
            least: least(model.least, increment),
            friction: model.contacts.iter().map(|s| s.friction).collect(),
            settings: model.settings,
        };
        let start = IncrementStart {
            load_factor,
            leg: 0,
            u: u.clone(),
            nodes: nodes.clone(),
            history,
            verdict: None,
        };
        let sub_increment = SubIncrement::whole(model, start.place(), controls.increment);
        let target = sub_increment.target();
        let mut state = State {
            next: Position {
                increment: 1,
                attempt: 1,
                major: 1,
                minor: 1,
            },
            load_factor: target,
            u,
            nodes,
            start: Arc::new(start),
            controls: Arc::new(controls),
            sub_increment,
            major: MajorState {
                minor_history: Arc::default(),
                line: None,
                target,
                last_target: load_factor,
                correction: 0.0,
                factored: None,
            },
            attempt: AttemptState::default(),
            recovery: RecoveryState::default(),
            record: RunRecord::default(),
            way: (model.control == Control::Arc).then(|| Box::new(ArcState::new(model))),
            outside: None,
            status: Status::Running,
        };
        state.set_out();
        state
    }

    /// The fallbacks that change the settings: that of the current increment, and the contact geometry once it has helped.
    pub fn fallbacks(&self) -> impl Iterator<Item = Fallback> {
        let chosen = self.controls.settings;
        let current = self.recovery.fallback.map(|route| route.by);
        let searched = self.record.searched.geometry && current != Some(Fallback::Geometry);
        current
            .into_iter()
            .chain(searched.then_some(Fallback::Geometry))
            .filter(move |by| by.in_force(chosen) != chosen)
    }

    /// The settings in force: with the strategy of the current rung, its update of T_max, and the changes of a fallback.
    pub fn settings(&self) -> Settings {
        let mut settings = strategy::in_force(
            &self.controls.settings,
            self.attempt.search.rung,
            self.nodes.len(),
        );
        for by in self.fallbacks() {
            settings = by.in_force(settings);
        }
        if self.recovery.brake.is_some() && !self.attempt.net {
            settings.slip = SlipCount::Major;
        }
        if self.attempt.search.frozen {
            settings.geometry = Geometry::Frozen;
        }
        settings
    }

    /// The part of the state that digests cover: fields added after the first journals are excluded, so that the digests of those
    /// journals remain valid.
    pub fn digested(&self) -> State {
        let record = RunRecord {
            pace: self.record.pace.digested(),
            watch: StabilityWatch::default(),
            searched: SearchRecord {
                run: 0,
                ..self.record.searched.clone()
            },
        };
        State {
            record,
            ..self.clone()
        }
    }

    /// Adds factorizations to the cost of the run, or of the search that is in progress.
    pub(super) fn count_cost(&mut self, factorizations: u32) {
        let searched = &mut self.record.searched;
        let cost = match self.recovery.fallback {
            Some(fallback) if fallback.by.searches() => &mut searched.spent,
            _ => &mut searched.run,
        };
        *cost = cost.saturating_add(factorizations);
    }

    /// Arc length from the start of the history to the current increment. `None` under load control.
    pub fn arc(&self) -> Option<f64> {
        self.way.as_ref().map(|way| way.length)
    }

    /// Whether a source has the same linearisation at another state: the states differ only by what minor iterations change.
    pub(super) fn is_linearised_as(&self, other: &State) -> bool {
        let same = |a: &Arc<Vec<f64>>, b: &Arc<Vec<f64>>| Arc::ptr_eq(a, b) || a == b;
        let stands = |(node, other): (&ContactState, &ContactState)| {
            let minor = ContactState {
                mode: node.mode,
                forced: node.forced,
                t_max: node.t_max,
                sign: node.sign,
                ratio: node.ratio,
                travel: node.travel,
                ..*other
            };
            *node == minor
        };
        let factored = match (&self.major.factored, &other.major.factored) {
            (Some(a), Some(b)) => same(a, b),
            (None, None) => true,
            _ => false,
        };
        factored
            && same(&self.u, &other.u)
            && (Arc::ptr_eq(&self.start, &other.start) || self.start == other.start)
            && (Arc::ptr_eq(&self.controls, &other.controls) || self.controls == other.controls)
            && [
                self.major.target,
                self.major.last_target,
                self.major.correction,
            ] == [
                other.major.target,
                other.major.last_target,
                other.major.correction,
            ]
            && self.attempt.search.frozen == other.attempt.search.frozen
            && self.settings().geometry == other.settings().geometry
            && (self.recovery.brake, &self.way, &self.recovery.motion)
                == (other.recovery.brake, &other.way, &other.recovery.motion)
            && self.nodes.len() == other.nodes.len()
            && self.nodes.iter().zip(&other.nodes).all(stands)
    }

    /// The part of the state that a source may read.
    pub fn at(&self) -> LinearisationPoint<'_> {
        LinearisationPoint {
            u: &self.u,
            accepted: AcceptedState {
                u: &self.start.u,
                history: &self.start.history,
                contacts: &self.start.nodes,
            },
            leg: self.start.leg,
            start_load: self.start.load_factor,
            target: self.major.target,
            last_target: self.major.last_target,
            contacts: &self.nodes,
            friction: &self.controls.friction,
            entered: self.major.minor_history.first(self.nodes.len()),
            correction: self.major.correction,
            factored: self.major.factored.as_deref().map(Vec::as_slice),
            brake: self.recovery.brake.map_or(0.0, |brake| brake.stiffness),
            drag: self.recovery.motion.and_then(|motion| motion.drag()),
            chosen: &self.controls.settings,
            settings: self.settings(),
            along: self.way.as_ref().map(|way| way.along()),
            arc: self.arc().unwrap_or(0.0),
        }
    }
}

/// A [`State`] as data: one flat record, whose field names and order the digests of journals rely on.
#[derive(Serialize, Deserialize)]
#[serde(rename = "State")]
struct SerializedState {
    next: Position,
    load_factor: f64,
    u: Arc<Vec<f64>>,
    nodes: Vec<ContactState>,
    start: Arc<IncrementStart>,
    controls: Arc<Controls>,
    trail: Arc<MinorHistory>,
    rounds: Arc<MajorHistory>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    line: Option<Arc<LineSearch>>,
    aim: f64,
    reached: f64,
    search: Progress,
    piece: SubIncrement,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    cuts: BTreeMap<usize, u32>,
    minors: u32,
    unsettled: u32,
    #[serde(default)]
    net: bool,
    correction: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    factored: Option<Arc<Vec<f64>>>,
    #[serde(default)]
    pace: Pace,
    #[serde(default, skip_serializing_if = "StabilityWatch::is_new")]
    watch: StabilityWatch,
    #[serde(skip_serializing_if = "Option::is_none")]
    brake: Option<SlipStiffness>,
    #[serde(skip_serializing_if = "Option::is_none")]
    way: Option<Box<ArcState>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Motion>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    detour: Option<FallbackState>,
    #[serde(default, skip_serializing_if = "SearchRecord::is_new")]
    searched: SearchRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    outside: Option<Box<ExternalState>>,
    status: Status,
}

/// Converts both ways between two records of the same values.
macro_rules! interchangeable {
    ($one:ident $fields:tt, $other:ident $places:tt) => {
        impl From<$one> for $other {
            fn from(from: $one) -> $other {
                let $one $fields = from;
                $other $places
            }
        }

        impl From<$other> for $one {
            fn from(from: $other) -> $one {
                let $other $places = from;
                $one $fields
            }
        }
    };
}

interchangeable! {
    SerializedState {
        next, load_factor, u, nodes, start, controls, trail, rounds, line, aim, reached, search, piece, cuts, minors, unsettled,
        net, correction, factored, pace, watch, brake, way, motion, detour, searched, outside, status,
    },
    State {
        next,
        load_factor,
        u,
        nodes,
        start,
        controls,
        sub_increment: piece,
        major: MajorState {
            minor_history: trail,
            line,
            target: aim,
            last_target: reached,
            correction,
            factored,
        },
        attempt: AttemptState { major_history: rounds, search, minors, unsettled, net },
        recovery: RecoveryState { cuts, brake, motion, fallback: detour },
        record: RunRecord { pace, watch, searched },
        way,
        outside,
        status,
    }
}
