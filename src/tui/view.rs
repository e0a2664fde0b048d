//! The data that the panes draw: a read-only view of a session.

use std::borrow::Cow;
use stickslip_core::{
    Capabilities, ContactRecord, Event, Forced, Intervention, Mode, Model, Monitor,
    MonitorQuantity, Norms, Outcome, PointDeformation, Position,
};
use stickslip_debugger::action::Context;
use stickslip_debugger::explain::model_facts::ModelFacts;
use stickslip_debugger::explain::outline::{self, Projection};
use stickslip_debugger::session::background::Background;
use stickslip_debugger::teach;
use stickslip_debugger::{
    DiagnosisPage, Frame, Log, NodePush, RemedyTrial, RoundOff, Session, Strip, Tree,
};
use stickslip_scene::{Scene, number, shown};

/// All session data needed for drawing. Plain data, so that tests can construct it.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// File or built-in name of the scene.
    pub name: &'a str,
    /// The scene, which names its nodes; `None` in hand-made tests.
    pub scene: Option<&'a Scene>,
    /// The scene's model.
    pub model: &'a Model,
    /// The history, oldest first; never empty.
    pub frames: &'a [Frame],
    /// Compact records of the same steps; empty in hand-made tests.
    pub strips: &'a [Strip],
    /// The whole history with its branches; `None` in hand-made tests.
    pub tree: Option<&'a Tree>,
    /// Results of the background analyses; `None` in drawings of a session alone.
    pub background: Option<&'a Background>,
    /// The start gaps in words; empty if there are none.
    pub start_gaps: &'a str,
    /// The attached solver, if there is one.
    pub attached: Option<AttachedSolver<'a>>,
    /// Index of the shown frame.
    pub cursor: usize,
    /// Whether the solver is running.
    pub running: bool,
    /// Norms by major iteration in the shown increment attempt.
    pub residuals: Vec<(u32, Norms)>,
    /// The branch, if there are several, and the watches with their values, on one line; may be empty.
    pub aside: String,
}

/// An attached solver.
#[derive(Debug, Clone, Copy)]
pub struct AttachedSolver<'a> {
    /// Its capabilities.
    pub offers: &'a Capabilities,
    /// Its log.
    pub log: &'a Log,
    /// Whether it was lost; the next step restarts it.
    pub lost: bool,
    /// The iterations that it repeats in the running job, in words.
    pub again: &'a str,
}

impl<'a> View<'a> {
    /// The view of a session.
    pub fn new(session: &'a Session) -> Self {
        let mut view = View {
            name: &session.scene().name,
            scene: Some(session.scene()),
            model: session.model(),
            frames: session.frames(),
            strips: session.timeline().strips(),
            tree: Some(session.timeline().tree()),
            background: Some(session.background()),
            start_gaps: session.start_gaps(),
            attached: session.connection().log().map(|log| AttachedSolver {
                offers: session.connection().capabilities(),
                log,
                lost: session.connection().lost().is_some(),
                again: session.connection().repeats(),
            }),
            cursor: session.cursor(),
            running: session.is_running(),
            residuals: session.timeline().residual_history(),
            aside: if session.is_running() {
                String::new()
            } else {
                session.aside()
            },
        };
        if view.event().is_none() {
            view.residuals.clear();
        }
        view
    }

    /// The diagnosis of the problem that is solved next from here; the inner `None` while it is being computed.
    pub fn examination(&self) -> Option<Option<&'a DiagnosisPage>> {
        self.background?
            .examination((self.tree?.current(), self.cursor))
    }

    /// Whether remedies were tried, or are being tried.
    pub fn has_tried(&self) -> bool {
        self.background.is_some_and(|b| b.tried().is_some())
    }

    /// The remedies tried so far.
    pub fn trials(&self) -> &'a [RemedyTrial] {
        let tried = self.background.and_then(Background::tried);
        tried.map_or(&[][..], |tried| &tried.trials)
    }

    /// Whether remedies are being tried.
    pub fn is_trying(&self) -> bool {
        self.background.is_some_and(Background::is_trying)
    }

    /// Whether the last remedies start from here; false if their trial was stopped.
    pub fn tries_here(&self) -> bool {
        let here = self.tree.map(|tree| (tree.current(), self.cursor));
        let tried = self.background.and_then(Background::tried);
        tried.is_some_and(|tried| Some(tried.place) == here && !tried.stopped)
    }

    /// The contributions of other nodes to a slave node's change in the shown minor iteration; the inner `None` if they are not
    /// known.
    pub fn pushes(&self, slave: usize) -> Option<Option<&'a [NodePush]>> {
        self.background?
            .pushes((self.tree?.current(), self.cursor), slave)
    }

    /// Whether the pushes of the shown minor iteration are computed only on demand.
    pub fn is_costly(&self) -> bool {
        let place = self.tree.map(|tree| (tree.current(), self.cursor));
        place
            .zip(self.background)
            .is_some_and(|(place, background)| background.is_costly(place))
    }

    /// The solids' point that is inverted or outside the range of its law, once the background thread has found it.
    pub fn worst_point(&self) -> Option<PointDeformation> {
        self.background?.worst_point(&self.frame().state.u)
    }

    /// Whether this is a finished run of another program.
    pub fn is_finished(&self) -> bool {
        self.model.finished.is_some()
    }

    /// The shown frame.
    pub fn frame(&self) -> &'a Frame {
        &self.frames[self.cursor]
    }

    /// The minor iteration that produced the shown frame; `None` at the start, and if the increment restarts, since earlier values
    /// do not describe this state.
    pub fn event(&self) -> Option<&'a Event> {
        let (event, next) = (self.frame().event.as_deref()?, self.frame().state.next);
        let again =
            event.position.increment == next.increment && event.position.attempt != next.attempt;
        (!again || self.is_finished()).then_some(event)
    }

    /// The user's intervention that produced the shown frame, if any.
    pub fn intervention(&self) -> Option<&'a Intervention> {
        self.frame().intervention.as_ref()
    }

    /// The position of the shown minor iteration, or otherwise of the next one.
    pub fn position(&self) -> Position {
        self.event()
            .map_or(self.frame().state.next, |event| event.position)
    }

    /// The values of a slave node in that minor iteration.
    pub fn record(&self, slave: usize) -> Option<&'a ContactRecord> {
        self.event()?.nodes.get(slave)
    }

    /// The solver's description of a contact in the shown iteration.
    pub fn words(&self, slave: usize) -> Option<&'a str> {
        let words = self.event()?.words.contacts.get(slave)?;
        Some(words.as_str()).filter(|words| !words.trim().is_empty())
    }

    /// Which of the shown values are round-off; none at the start.
    pub fn round_off(&self) -> RoundOff {
        self.event().map_or(RoundOff::default(), |event| {
            RoundOff::with_reach(self.facts().reach, &event.before)
        })
    }

    /// The facts about the model.
    pub fn facts(&self) -> Cow<'a, ModelFacts> {
        match self.tree {
            Some(tree) => Cow::Borrowed(tree.facts()),
            None => Cow::Owned(ModelFacts::new(self.model)),
        }
    }

    /// Name of a slave node.
    pub fn slave(&self, slave: usize) -> &'a str {
        match self.model.contacts.get(slave) {
            Some(slave) => &self.model.nodes[slave.node].name,
            None => "",
        }
    }

    /// The next mode of a slave node, from Table 2 or the user.
    pub fn mode(&self, slave: usize) -> Mode {
        self.frame().state.nodes[slave].mode
    }

    /// The mode of a slave node in the shown minor iteration; at the start, its initial mode.
    pub fn mode_before(&self, slave: usize) -> Mode {
        self.record(slave)
            .map_or(self.mode(slave), |record| record.decision.before)
    }

    /// Whether the user forced or holds the next mode of a slave node, or otherwise the shown one.
    pub fn forced(&self, slave: usize) -> Forced {
        match (self.frame().state.nodes[slave].forced, self.record(slave)) {
            (Forced::No, Some(record)) if self.intervention().is_none() => record.forced,
            (forced, _) => forced,
        }
    }

    /// Whether a sliding node's T_max changes by more than the tolerance, so that another iteration is needed.
    pub fn t_max_moves(&self, slave: usize) -> bool {
        let (Some(event), Some(record)) = (self.event(), self.record(slave)) else {
            return false;
        };
        let settled = matches!(
            event.outcome,
            Outcome::Major { settled: true, .. }
                | Outcome::Refused { .. }
                | Outcome::Increment { .. }
        );
        let slides =
            record.decision.before == Mode::Sliding && record.decision.next == Mode::Sliding;
        let least = self.frame().state.controls.settings.tolerance * event.before.scale;
        slides && !settled && (record.t_max - record.t_max_used).abs() > least
    }

    /// Whether an attached solver does not report a value.
    pub fn is_unreported(&self, value: f64) -> bool {
        self.attached.is_some() && value.is_nan()
    }

    /// Whether a value is shown as a dash.
    fn is_absent(&self, value: f64) -> bool {
        // A node off all surfaces has an infinite gap.
        value == f64::INFINITY || self.is_unreported(value)
    }

    /// A value as a table cell ([`number::fixed_width`]); a dash if an attached solver does not report it.
    pub fn cell(&self, value: f64, width: usize) -> String {
        if self.is_absent(value) {
            shown::padded(&format!(" {}", number::UNREPORTED), width)
        } else {
            number::fixed_width(value, width)
        }
    }

    /// A value with ten digits ([`number::shortest`]), or a dash.
    pub fn long(&self, value: f64) -> String {
        if self.is_absent(value) {
            number::UNREPORTED.into()
        } else {
            number::shortest(value)
        }
    }

    /// Whether an attached solver's decision on a node differs from its rules for the same values.
    pub fn differs(&self, slave: usize) -> bool {
        let record = self.record(slave).filter(|_| self.attached.is_some());
        record.is_some_and(stickslip_core::ContactRecord::differs)
    }

    /// The range below which a monitor's values are round-off.
    pub fn noise(&self, monitor: &Monitor) -> f64 {
        let round_off = self.round_off();
        match monitor.of {
            MonitorQuantity::Displacement { .. } => round_off.length,
            MonitorQuantity::Contact { .. } | MonitorQuantity::Reaction { .. } => round_off.force,
            _ => 0.0,
        }
    }

    /// Whether any node is not at its reference position.
    pub fn is_deformed(&self) -> bool {
        self.frame().state.u.iter().any(|u| *u != 0.0)
    }

    /// Position of a node with its displacement magnified.
    pub fn magnified(&self, node: usize, by: (f64, Projection)) -> [f64; 2] {
        outline::magnified(self.model, &self.frame().state.u, node, by)
    }
}

/// The context in which actions parse their arguments.
pub fn context<'a>(view: Option<&View<'a>>, selected: usize, scenes: &'a [String]) -> Context<'a> {
    let (model, scene) = (
        view.map(|view| view.model),
        view.and_then(|view| view.scene),
    );
    Context {
        model,
        scene,
        tree: view.and_then(|view| view.tree),
        selected,
        offers: view
            .and_then(|view| view.attached)
            .map(|attached| attached.offers),
        state: view.map(|view| &view.frame().state),
        next: view.and_then(|view| view.frames.get(view.cursor + 1)),
        scenes,
        lessons: teach::list(),
        keymap: None,
    }
}
