//! The history as a tree of branches, within a memory budget.
//!
//! A branch has a name and its own points, which start where it leaves its parent. The *line* of the current
//! branch consists of all points from the root to its tip, in one slice; the own points of the other branches
//! are stored separately.
//!
//! The [`Strip`] of a point is never discarded. Its [`Frame`] is whole (state and event) as long as all whole
//! frames fit into [`Budget::frames`]. Beyond that, frames are thinned: first those inside major iterations,
//! those far from the cursor before near ones; then the ends of major iterations; then every second end of an
//! increment. A thinned frame keeps its position, intervention and monitors, and is recomputed from the nearest
//! whole frame before it when needed. The root, the frame at the cursor and the tips of all branches are always
//! whole. [`Budget::branches`] limits those frames and the strips; beyond it no new branch can start.

use crate::explain::model_facts::ModelFacts;
use crate::{Frame, PointKind, Strip};
use std::collections::HashMap;
use std::sync::Arc;
use stickslip_core::{
    ContactRecord, ContactState, Event, IncrementStart, Intervention, Model, State,
};

/// Limits of the memory that a history takes, in bytes.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// All whole frames.
    pub frames: usize,
    /// Data that is never thinned (tips of all branches, strips of all points); above this size no branch can
    /// start.
    pub branches: usize,
}

impl Default for Budget {
    fn default() -> Budget {
        Budget {
            frames: 256 << 20,
            branches: 256 << 20,
        }
    }
}

/// Part of the budget that is left in use after thinning, so that not every iteration has to thin.
const AFTER_THINNING: f64 = 0.75;

/// A sequence of points.
#[derive(Debug, Default)]
struct Points {
    frames: Vec<Frame>,
    strips: Vec<Strip>,
}

impl Points {
    fn split_off(&mut self, at: usize) -> Points {
        Points {
            frames: self.frames.split_off(at),
            strips: self.strips.split_off(at),
        }
    }

    fn append(&mut self, mut other: Points) {
        self.frames.append(&mut other.frames);
        self.strips.append(&mut other.strips);
    }

    fn len(&self) -> usize {
        self.frames.len()
    }
}

/// A branch: its name, and where it left its parent.
#[derive(Debug)]
pub struct Branch {
    /// Its first intervention, or the user's name for it.
    pub label: String,
    /// Whether the user named it.
    pub named: bool,
    /// Its parent; `None` for the first branch.
    pub parent: Option<usize>,
    /// Index on the line of its first own point.
    pub from: usize,
    /// Own points that are not on the current line.
    away: Points,
}

/// The history.
#[derive(Debug)]
pub struct Tree {
    model: Arc<Model>,
    facts: ModelFacts,
    line: Points,
    branches: Vec<Branch>,
    current: usize,
    ledger: Ledger,
    budget: Budget,
    /// The state left in a thinned frame.
    hollow: State,
}

impl Tree {
    /// The tree of a session at its start.
    pub fn new(model: Arc<Model>, start: State, budget: Budget) -> Tree {
        let strip = Strip::new(&model, &start, None, None, 0.0);
        let empty = Arc::new(Vec::new());
        let hollow = State {
            nodes: Vec::new(),
            u: empty.clone(),
            start: Arc::new(IncrementStart {
                nodes: Vec::new(),
                u: empty,
                history: Vec::new(),
                ..(*start.start).clone()
            }),
            ..start.clone()
        };
        let frame = Frame {
            state: start,
            event: None,
            intervention: None,
            monitors: None,
        };
        let mut ledger = Ledger::default();
        ledger.add(&frame);
        Tree {
            facts: ModelFacts::new(&model),
            model,
            line: Points {
                frames: vec![frame],
                strips: vec![strip],
            },
            branches: vec![Branch {
                label: "start".into(),
                named: false,
                parent: None,
                from: 0,
                away: Points::default(),
            }],
            current: 0,
            ledger,
            budget,
            hollow,
        }
    }

    /// The scene.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The facts about the scene's model.
    pub fn facts(&self) -> &ModelFacts {
        &self.facts
    }

    /// Frames from the root to the tip of the current branch.
    pub fn frames(&self) -> &[Frame] {
        &self.line.frames
    }

    /// The strips of these frames.
    pub fn strips(&self) -> &[Strip] {
        &self.line.strips
    }

    /// All branches, oldest first.
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// Number of the current branch.
    pub fn current(&self) -> usize {
        self.current
    }

    /// Renames the current branch.
    pub fn rename(&mut self, label: String, named: bool) {
        let branch = &mut self.branches[self.current];
        (branch.label, branch.named) = (label, named);
    }

    /// Bytes taken by whole frames.
    pub fn bytes(&self) -> usize {
        self.ledger.bytes
    }

    /// Size in bytes of the data that is never thinned: the entry and the strip of every point, and a whole
    /// frame at the tip of every branch. It depends only on the tree, so that a replay computes the same value.
    pub fn permanent_bytes(&self) -> usize {
        let away: usize = self.branches.iter().map(|branch| branch.away.len()).sum();
        let strip = Strip::BYTES_PER_ITERATION + self.model.contacts.len() * Strip::BYTES_PER_NODE;
        let point = size_of::<Frame>() + strip;
        let tip = self.line.frames.last().map_or(0, whole_bytes);
        (self.line.len() + away) * point + self.branches.len() * tip
    }

    /// Limits of the memory that it takes.
    pub fn budget(&self) -> Budget {
        self.budget
    }

    /// Appends a point to the tip.
    pub fn push(&mut self, mut frame: Frame, mut strip: Strip) {
        if let Some(tip) = self.line.frames.last() {
            if let Some(event) = frame.event.as_ref().filter(|_| strip.kind.is_accepted()) {
                let states = [tip, &frame].map(|frame| &*frame.state.start);
                strip.unforced = self.facts.free.findings(&self.model, event, states).into();
            }
            copy(&mut frame, tip);
        }
        self.ledger.add(&frame);
        self.line.frames.push(frame);
        self.line.strips.push(strip);
        let tip = self.line.len() - 1;
        self.thin([tip, tip]);
    }

    /// Adds an intervention after a point of the line, whose frame is whole: at the tip of the current branch,
    /// or otherwise in a new branch. Returns whether a branch was started.
    pub fn intervene(&mut self, at: usize, state: State, intervention: Intervention) -> bool {
        let forks = at + 1 < self.line.len();
        if forks {
            self.fork(at);
        }
        let strip = Strip::intervention(&self.model, &state, &self.line.strips[at]);
        let frame = Frame {
            state,
            event: self.line.frames[at].event.clone(),
            intervention: Some(intervention),
            monitors: None,
        };
        self.push(frame, strip);
        forks
    }

    /// Starts an empty branch after a point of the line, whose frame is whole, and makes it the current one.
    pub fn fork(&mut self, at: usize) {
        let away = self.line.split_off(at + 1);
        // The parent is the branch in the chain that owns the next point.
        let chain = self.chain(self.current);
        self.put_away(&chain, at + 1, away);
        let parent = chain
            .into_iter()
            .rev()
            .find(|&b| self.branches[b].from <= at);
        self.branches.push(Branch {
            label: String::new(),
            named: false,
            parent,
            from: at + 1,
            away: Points::default(),
        });
        self.current = self.branches.len() - 1;
    }

    /// Branches from the first to this one, each the parent of the next.
    fn chain(&self, branch: usize) -> Vec<usize> {
        let mut chain: Vec<usize> =
            std::iter::successors(Some(branch), |&b| self.branches[b].parent).collect();
        chain.reverse();
        chain
    }

    /// Returns points of the line, from `start` on, to the branches of the chain that own them.
    fn put_away(&mut self, chain: &[usize], start: usize, mut points: Points) {
        for &branch in chain.iter().rev() {
            let branch = &mut self.branches[branch];
            let own = branch.from.max(start) - start;
            if own >= points.len() {
                continue;
            }
            let mut own = points.split_off(own);
            own.append(std::mem::take(&mut branch.away));
            branch.away = own;
        }
    }

    /// Makes a branch the current one, so that its line becomes the current line.
    pub fn switch(&mut self, to: usize) {
        let line = std::mem::take(&mut self.line);
        self.put_away(&self.chain(self.current), 0, line);
        let chain = self.chain(to);
        for (k, &branch) in chain.iter().enumerate() {
            let end = chain.get(k + 1).map(|&child| self.branches[child].from);
            let branch = &mut self.branches[branch];
            let rest = match end {
                Some(end) => branch.away.split_off(end - branch.from),
                None => Points::default(),
            };
            let own = std::mem::replace(&mut branch.away, rest);
            self.line.append(own);
        }
        self.current = to;
    }

    /// Number of points on a branch's line, from the root to its tip.
    pub fn len(&self, branch: usize) -> usize {
        if branch == self.current {
            return self.line.len();
        }
        self.on_line_until(branch) + self.branches[branch].away.len()
    }

    /// Index at which the stored own points of a branch start.
    fn on_line_until(&self, branch: usize) -> usize {
        let chain = self.chain(self.current);
        match chain.iter().position(|&b| b == branch) {
            Some(at) => chain
                .get(at + 1)
                .map_or(self.line.len(), |&child| self.branches[child].from),
            None => self.branches[branch].from,
        }
    }

    /// A point on a branch's line.
    pub fn point(&self, branch: usize, at: usize) -> Option<(&Frame, &Strip)> {
        if at < self.branches[branch].from {
            return self.point(self.branches[branch].parent?, at);
        }
        let start = self.on_line_until(branch);
        let (points, at) = match at.checked_sub(start) {
            Some(at) => (&self.branches[branch].away, at),
            None => (&self.line, at),
        };
        Some((points.frames.get(at)?, points.strips.get(at)?))
    }

    /// The last point of a branch's line; its frame is whole.
    pub fn tip(&self, branch: usize) -> Option<(&Frame, &Strip)> {
        self.point(branch, self.len(branch).checked_sub(1)?)
    }

    /// The nearest whole frame of the line at or before an index.
    pub fn whole_before(&self, at: usize) -> usize {
        (0..=at)
            .rev()
            .find(|k| self.line.frames[*k].is_whole())
            .unwrap_or(0)
    }

    /// Restores a thinned frame of the line.
    pub fn refill(&mut self, at: usize, state: State, event: Option<Arc<Event>>) {
        let frame = &mut self.line.frames[at];
        if !frame.is_whole() {
            (frame.state, frame.event) = (state, event);
            self.ledger.add(frame);
        }
    }

    /// Thins frames until they fit into the budget, except the two being shown.
    pub fn thin(&mut self, looked_at: [usize; 2]) {
        if self.ledger.bytes <= self.budget.frames {
            return;
        }
        let enough = (self.budget.frames as f64 * AFTER_THINNING) as usize;
        for (_, _, branch, at) in self.candidates(looked_at) {
            if self.ledger.bytes <= enough {
                return;
            }
            let points = match branch {
                Some(branch) => &mut self.branches[branch].away,
                None => &mut self.line,
            };
            let frame = &mut points.frames[at];
            self.ledger.remove(frame);
            empty(frame, &self.hollow);
        }
    }

    /// Whole frames that may be thinned, in order: class, distance, location.
    fn candidates(&self, looked_at: [usize; 2]) -> Vec<(u8, usize, Option<usize>, usize)> {
        let mut found = Vec::new();
        // The tip of a branch that another one left there lies on the line.
        let ending: Vec<usize> = self
            .chain(self.current)
            .into_iter()
            .filter(|&b| self.branches[b].away.len() == 0)
            .map(|b| self.on_line_until(b).saturating_sub(1))
            .collect();
        let mut gather = |points: &Points, branch: Option<usize>| {
            // The last point is a tip; the first of the line is the root.
            let last = points.len().saturating_sub(1);
            for (at, (frame, strip)) in points.frames.iter().zip(&points.strips).enumerate() {
                let on_line = || at == 0 || looked_at.contains(&at) || ending.contains(&at);
                let kept = at == last || (branch.is_none() && on_line());
                if kept || !frame.is_whole() {
                    continue;
                }
                let class = match strip.kind {
                    PointKind::Minor | PointKind::Damped | PointKind::Climbed => 0,
                    PointKind::Major | PointKind::Refused => 1,
                    _ => 2 + (at % 2) as u8,
                };
                let near = match branch {
                    Some(_) => 0,
                    None => usize::MAX - at.abs_diff(looked_at[0]),
                };
                found.push((class, near, branch, at));
            }
        };
        for (number, branch) in self.branches.iter().enumerate() {
            gather(&branch.away, Some(number));
        }
        gather(&self.line, None);
        found.sort_unstable();
        found
    }
}

/// Moves a frame into memory allocated by this thread, sharing the parts that equal those of the previous
/// frame. The original buffers return to the solver's thread, which reuses them instead of waiting for new
/// pages in each iteration.
fn copy(frame: &mut Frame, before: &Frame) {
    fn part<T: Clone + PartialEq>(own: &mut Arc<T>, before: &Arc<T>) {
        *own = if own == before {
            before.clone()
        } else {
            Arc::new(T::clone(own))
        };
    }
    let state = &mut frame.state;
    state.nodes = state.nodes.clone();
    part(&mut state.u, &before.state.u);
    part(&mut state.start, &before.state.start);
    part(
        &mut state.major.minor_history,
        &before.state.major.minor_history,
    );
    part(
        &mut state.attempt.major_history,
        &before.state.attempt.major_history,
    );
    if let Some(event) = &mut frame.event {
        *event = Arc::new(Event::clone(event));
    }
}

/// Drops state and event of a frame.
fn empty(frame: &mut Frame, hollow: &State) {
    let mut left = State {
        next: frame.state.next,
        load_factor: frame.state.load_factor,
        ..hollow.clone()
    };
    if frame.monitors.is_some() {
        // A monitor's curve needs the load factor accepted here.
        Arc::make_mut(&mut left.start).load_factor = frame.state.start.load_factor;
    }
    (frame.state, frame.event) = (left, None);
}

/// Memory taken by whole frames. A part shared by several frames counts once.
#[derive(Debug, Default)]
struct Ledger {
    bytes: usize,
    /// Number of frames that share a part, by its address.
    shared: HashMap<usize, usize>,
}

impl Ledger {
    fn add(&mut self, frame: &Frame) {
        self.bytes += frame.state.nodes.capacity() * size_of::<ContactState>();
        each_shared(frame, &mut |address, bytes| {
            let frames = self.shared.entry(address).or_insert(0);
            *frames += 1;
            if *frames == 1 {
                self.bytes += bytes;
            }
        });
    }

    fn remove(&mut self, frame: &Frame) {
        self.bytes -= frame.state.nodes.capacity() * size_of::<ContactState>();
        each_shared(frame, &mut |address, bytes| {
            if let Some(frames) = self.shared.get_mut(&address) {
                *frames -= 1;
                if *frames == 0 {
                    self.shared.remove(&address);
                    self.bytes -= bytes;
                }
            }
        });
    }
}

/// Size of a whole frame that shares no data.
fn whole_bytes(frame: &Frame) -> usize {
    let mut bytes = size_of_val(&frame.state.nodes[..]);
    each_shared(frame, &mut |_, part| bytes += part);
    bytes
}

/// The parts of a frame that others may share: address and size.
fn each_shared(frame: &Frame, tell: &mut impl FnMut(usize, usize)) {
    fn address<T>(part: &Arc<T>) -> usize {
        Arc::as_ptr(part).addr()
    }
    let state = &frame.state;
    let floats = |values: &[f64]| size_of_val(values) + size_of::<Vec<f64>>();
    tell(address(&state.u), floats(&state.u));
    let start = &state.start;
    tell(address(&start.u), floats(&start.u));
    let own = size_of::<IncrementStart>()
        + size_of_val(&start.nodes[..])
        + size_of_val(&start.history[..]);
    tell(address(start), own);
    tell(
        address(&state.major.minor_history),
        state.major.minor_history.bytes(),
    );
    if let Some(event) = &frame.event {
        let bytes = size_of::<Event>() + event.nodes.capacity() * size_of::<ContactRecord>();
        tell(address(event), bytes);
    }
}
