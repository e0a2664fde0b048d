//! Everything that the next minor iteration depends on, as plain data.
//!
//! A state is cheap to clone, since what changes seldom is shared; restoring one and going on gives the same bits as
//! never having left. What can be computed again from it (geometry, stiffness, factors) is not in it.

use crate::contact::corner;
use crate::contact::judge::Verdict;
use crate::contact::projection::Spot;
use crate::contact::strategy::{LADDER, limit};
use crate::fem::assembly::history_len;
use crate::scene::spec::{FrictionLimit, InitialState, SlipCount, Sticking, Strategy, least};
use crate::scene::{Friction, Mode, Model, Settings};
use crate::solve::event::{Cycle, Failure, Forced, Position};
use crate::solve::jump::Pace;
use crate::solve::rounds::Rounds;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The solver between two minor iterations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The minor iteration that comes next.
    pub next: Position,
    /// Load factor at the end of the present increment.
    pub load_factor: f64,
    /// Values of all degrees of freedom ([`crate::scene::model::Dofs`]) at the start of the present major iteration.
    pub u: Arc<Vec<f64>>,
    /// The interface, one entry a slave node.
    pub nodes: Vec<NodeState>,
    /// Where the present increment started.
    pub start: Arc<IncrementStart>,
    /// What the user can turn during a run.
    pub controls: Arc<Controls>,
    /// What went into the minor iterations of the present major one so far, to recognise a cycle.
    pub trail: Arc<Trail>,
    /// What went into the major iterations of the present increment so far, to recognise a cycle of theirs.
    pub rounds: Arc<Rounds>,
    /// Load factor that the present major iteration aims at: `load_factor`, unless it was damped.
    pub aim: f64,
    /// Load factor that the last major iteration aimed at; at first the one at the start of the increment.
    pub reached: f64,
    /// How far the strategy has come in the present increment.
    pub search: Search,
    /// The part of an increment that is aimed at.
    pub piece: Piece,
    /// Minor iterations done in the present increment attempt.
    pub minors: u32,
    /// Loops of the present attempt that were ended by a limit and accepted.
    pub unsettled: u32,
    /// Whether nodes that touched when the increment started keep their anchors from there: the judge has refused a state of
    /// the present attempt ([`crate::contact::judge`]).
    #[serde(default)]
    pub net: bool,
    /// Largest displacement change in the last major iteration over the length scale.
    pub correction: f64,
    /// How fast the scene moves.
    #[serde(default)]
    pub pace: Pace,
    /// Whether and how it can go on.
    pub status: Status,
}

/// Whether the solver can go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Status {
    /// In the middle of an increment, or before one.
    Running,
    /// The last minor iteration made the increment fail; stepping on is allowed.
    Failed(Failure),
    /// The history is done.
    Finished,
}

/// One slave node between two minor iterations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeState {
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// Mode forced by the user, if any.
    pub forced: Forced,
    /// Total forces F_n^(k−1), F_t^(k−1) at the start of the present major iteration.
    pub f_n: f64,
    pub f_t: f64,
    /// T_max for the next minor iteration, signed.
    pub t_max: f64,
    /// Direction of T_max: −1, 0 (unknown) or 1.
    pub sign: f64,
    /// Slip counted up to the start of the present major iteration.
    pub slip: f64,
    /// Where on the master it stuck, or last was when an increment was accepted; none from a major iteration on in which it
    /// opened, unless it is kept ([`crate::contact::anchor`]).
    pub anchor: Option<Spot>,
    /// Whether the anchor is kept while the node is free, so that its net slip counts.
    #[serde(default)]
    pub kept: bool,
    /// Length of the surface from S* to the anchor at the start of the present major iteration, positive along t; in a
    /// corner, how far along t the node still has to go to it.
    pub drift: f64,
    /// Ratio ρ of tangential to normal travel where the node touched in the present major iteration; else 0.
    pub ratio: f64,
    /// Tangential over normal travel in the last minor iteration: the ρ that the node would take, should it touch.
    pub travel: f64,
    /// Where S* lies; none past the ends of all surfaces.
    pub spot: Option<Spot>,
    /// Half the angle (radians) of the concave corner in which it is held; S* is that corner then.
    #[serde(default)]
    pub corner: Option<f64>,
    /// The master element that it left last in the present increment.
    #[serde(default)]
    pub left: Option<usize>,
    /// Outward normal at the start of the present major iteration.
    pub normal: [f64; 2],
}

/// The last accepted state, from which an increment can be tried again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IncrementStart {
    /// Load factor there.
    pub load_factor: f64,
    /// Leg of the path on which the present increment lies: from corner `leg` to corner `leg + 1`.
    pub leg: usize,
    pub u: Arc<Vec<f64>>,
    pub nodes: Vec<NodeState>,
    /// What the elements remember of it ([`crate::fem::assembly::Assembly::advance`]); zeros before the first increment.
    pub history: Vec<f64>,
    /// What the judge found when it was accepted; none before the first increment.
    #[serde(default)]
    pub verdict: Option<Verdict>,
}

/// How far the strategy has come ([`crate::contact::strategy`]).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Search {
    /// The rung of the ladder that the increment has come to.
    pub rung: usize,
    /// What the first rung failed of in the present major iteration.
    pub first: Option<Box<Failure>>,
    /// Fewest nodes that changed at once in the present major iteration, and the rounds since then.
    pub fewest: Option<usize>,
    pub rounds: u32,
    /// How far pivoting has come in the present major iteration, and how many states that it found were not confirmed.
    pub pivoting: Pivoting,
    pub unconfirmed: usize,
}

/// How far pivoting, or the census, has come in a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Pivoting {
    /// The modes that the iteration began with are tried first.
    #[default]
    Not,
    /// The next minor iteration is this pivot, from this start; of a census, this answer of it.
    At { start: usize, pivot: usize },
    /// A state was found from this start, and the next minor iteration checks it.
    Found { start: usize },
}

/// An increment, or what it was cut to: a part of it, halved some times.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Piece {
    /// Load factors at the start and at the end of the whole increment.
    pub from: f64,
    pub to: f64,
    /// How often it was halved, and which of the parts this is, from 0.
    pub cut: u32,
    pub part: u32,
}

impl Piece {
    /// The whole increment after `start`.
    pub fn whole(model: &Model, start: &IncrementStart, increment: f64) -> Self {
        Piece {
            from: start.load_factor,
            to: next_load_factor(&model.path, start, increment),
            cut: 0,
            part: 0,
        }
    }

    /// Load factor at its end.
    pub fn target(&self) -> f64 {
        let parts = 2_u64.pow(self.cut);
        if u64::from(self.part) + 1 == parts {
            return self.to;
        }
        self.from + (self.to - self.from) * f64::from(self.part + 1) / parts as f64
    }

    /// Size.
    pub fn size(&self) -> f64 {
        (self.to - self.from).abs() / 2_f64.powi(self.cut as i32)
    }

    /// Its first half.
    pub fn halved(self) -> Self {
        Piece {
            cut: self.cut + 1,
            part: 2 * self.part,
            ..self
        }
    }

    /// The piece after it, as large as the halves allow; none where the whole increment is done.
    pub fn next(mut self) -> Option<Self> {
        self.part += 1;
        while self.cut > 0 && self.part.is_multiple_of(2) {
            (self.cut, self.part) = (self.cut - 1, self.part / 2);
        }
        (self.cut > 0).then_some(self)
    }
}

/// What the user can turn during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Controls {
    /// Increment of the load factor.
    pub increment: f64,
    /// Size below which an increment that fails is not cut.
    pub least: f64,
    /// Friction of each slave node.
    pub friction: Vec<Friction>,
    pub settings: Settings,
}

/// What went into each minor iteration of the present major one: while the geometry is frozen, a minor iteration is
/// a function of this alone.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Trail {
    /// One entry a slave node, iteration after iteration.
    entries: Vec<Input>,
}

/// What one slave node brings into a minor iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Input {
    pub mode: Mode,
    /// T_max, where the node slides; else 0.
    pub t_max: f64,
    /// Ratio ρ, where the node touches; else 0.
    pub ratio: f64,
}

impl Input {
    fn of(node: &NodeState) -> Self {
        Input {
            mode: node.mode,
            t_max: if node.mode == Mode::Sliding {
                node.t_max
            } else {
                0.0
            },
            ratio: if node.mode == Mode::Free {
                0.0
            } else {
                node.ratio
            },
        }
    }

    /// Same mode, and numbers that differ by less than these: T_max absolutely, the ratio relatively.
    fn repeats(&self, other: &Input, force: f64, ratio: f64) -> bool {
        self.mode == other.mode
            && (self.t_max - other.t_max).abs() <= force
            && (self.ratio - other.ratio).abs()
                <= ratio * (1.0 + self.ratio.abs().max(other.ratio.abs()))
    }
}

impl Trail {
    /// Forgets everything, keeping its memory.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Input>()
    }

    /// Remembers what goes into the next minor iteration.
    pub fn push(&mut self, nodes: &[NodeState]) {
        self.entries.extend(nodes.iter().map(Input::of));
    }

    /// Number of iterations remembered.
    pub fn len(&self, nodes: usize) -> usize {
        self.entries.len() / nodes.max(1)
    }

    /// What the first of the iterations started from.
    pub fn first(&self, nodes: usize) -> &[Input] {
        &self.entries[..nodes.min(self.entries.len())]
    }

    /// The cycle that is closed where the iteration after `minor`, which `nodes` go into, starts from the same as an
    /// earlier one; none if there is none. Forces are the same that differ by less than `force`, ratios relatively.
    pub fn cycle(&self, nodes: &[NodeState], minor: u32, force: f64, ratio: f64) -> Option<Cycle> {
        let width = nodes.len().max(1);
        let same = |then: &[Input]| {
            then.iter()
                .zip(nodes)
                .all(|(then, node)| then.repeats(&Input::of(node), force, ratio))
        };
        let found = self.entries.chunks_exact(width).rposition(same)?;
        let round = || self.entries[found * width..].chunks_exact(width);
        let period = round().len() as u32;
        let takes_part = |s: &usize| {
            let mut inputs = round().map(|inputs| inputs[*s]);
            let first = inputs.next();
            first.is_some_and(|first| inputs.any(|other| !other.repeats(&first, force, ratio)))
        };
        let pattern = |s: usize| round().map(|inputs| inputs[s].mode).collect();
        Some(Cycle {
            // The last round starts with what iteration `minor + 1 - period` started from.
            start: minor + 1 - period,
            period,
            members: (0..nodes.len())
                .filter(takes_part)
                .map(|s| (s, pattern(s)))
                .collect(),
        })
    }
}

impl State {
    /// The scene before its first increment.
    pub fn new(model: &Model) -> Self {
        let u = Arc::new(vec![0.0; model.dofs.len()]);
        let nodes: Vec<NodeState> = model
            .slaves
            .iter()
            .map(|slave| NodeState::new(slave.start, &slave.state))
            .collect();
        let load_factor = model.path[0];
        let controls = Controls {
            increment: model.increment,
            least: least(model.least, model.increment),
            friction: model.slaves.iter().map(|s| s.friction).collect(),
            settings: model.settings,
        };
        let start = IncrementStart {
            load_factor,
            leg: 0,
            u: u.clone(),
            nodes: nodes.clone(),
            history: vec![0.0; history_len(model)],
            verdict: None,
        };
        let piece = Piece::whole(model, &start, controls.increment);
        let aim = piece.target();
        State {
            next: Position {
                increment: 1,
                attempt: 1,
                major: 1,
                minor: 1,
            },
            load_factor: aim,
            u,
            nodes,
            start: Arc::new(start),
            controls: Arc::new(controls),
            trail: Arc::default(),
            rounds: Arc::default(),
            aim,
            reached: load_factor,
            search: Search::default(),
            piece,
            minors: 0,
            unsettled: 0,
            net: false,
            correction: 0.0,
            pace: Pace::default(),
            status: Status::Running,
        }
    }

    /// The settings in force: the strategy is what the ladder has come to, and T_max enters as it wants.
    pub fn settings(&self) -> Settings {
        let mut settings = self.controls.settings;
        if settings.strategy == Strategy::Ladder {
            settings.strategy = LADDER[self.search.rung.min(LADDER.len() - 1)];
            if self.search.rung > 0 {
                settings.t_max = FrictionLimit::Consistent;
            }
        }
        settings.t_max = limit(settings.strategy, settings.t_max);
        settings
    }
}

impl NodeState {
    pub(super) fn new(mode: Mode, brought: &InitialState) -> Self {
        NodeState {
            mode,
            forced: Forced::No,
            f_n: brought.f_n,
            f_t: brought.f_t,
            t_max: brought.t_max,
            sign: if brought.t_max == 0.0 {
                0.0
            } else {
                brought.t_max.signum()
            },
            slip: brought.slip,
            anchor: None,
            kept: false,
            drift: brought.slip,
            ratio: brought.ratio,
            travel: 0.0,
            spot: None,
            corner: None,
            left: None,
            normal: [0.0, 1.0],
        }
    }

    /// What it has slipped up to the start of the present major iteration, and what sticking takes back: counted, or
    /// measured from its anchor.
    pub fn slipped(&self, settings: &Settings) -> f64 {
        if self.corner.is_some() {
            return self.drift;
        }
        match (settings.sticking, settings.slip) {
            (Sticking::Anchored, _) => self.drift,
            (Sticking::Increments, SlipCount::Increment) => self.slip,
            (Sticking::Increments, SlipCount::Major) => 0.0,
        }
    }

    /// Friction where it stands: that in force, or what the corner makes of it.
    pub fn friction(&self, in_force: &Friction) -> Friction {
        match self.corner {
            Some(half) => corner::widened(in_force, half),
            None => *in_force,
        }
    }

    /// Total force on the slave node in Cartesian components (eqn 2).
    pub fn force(&self) -> [f64; 2] {
        let [c, s] = self.normal;
        [c * self.f_n - s * self.f_t, s * self.f_n + c * self.f_t]
    }
}

/// The load factor one increment after `start` along the path; the end of the leg where it is that close.
pub fn next_load_factor(path: &[f64], start: &IncrementStart, increment: f64) -> f64 {
    let target = path[start.leg + 1];
    let left = target - start.load_factor;
    if left.abs() <= increment * (1.0 + 1e-9) {
        return target;
    }
    tidy(start.load_factor + increment * left.signum(), path)
}

/// Rounds off what summing decimal increments leaves behind, so that 0.07 is not 0.07000000000000002.
fn tidy(load_factor: f64, path: &[f64]) -> f64 {
    let size = path.iter().fold(load_factor.abs(), |m, p| m.max(p.abs()));
    let unit = 10f64.powi(13 - size.log10().ceil() as i32);
    let rounded = (load_factor * unit).round() / unit;
    if rounded.is_finite() {
        rounded
    } else {
        load_factor
    }
}
