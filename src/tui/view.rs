//! What the panes show: a borrowed, read-only look at a session.

use stickslip_core::contact::record::{ContactRecord, Forced};
use stickslip_core::linear::norms::Norms;
use stickslip_core::model::{Mode, Model};
use stickslip_core::step::event::{Event, Outcome, Position};
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::solver::Offers;
use stickslip_debugger::action::Context;
use stickslip_debugger::explain::examination::Examination;
use stickslip_debugger::explain::influence::Push;
use stickslip_debugger::explain::round_off::RoundOff;
use stickslip_debugger::history::frame::Frame;
use stickslip_debugger::history::strip::Strip;
use stickslip_debugger::history::tree::Tree;
use stickslip_debugger::recorded::log::Log;
use stickslip_debugger::session::Session;
use stickslip_debugger::session::background::Background;
use stickslip_debugger::teach;
use stickslip_scene::Scene;
use stickslip_scene::number;

/// Everything that drawing needs to know about the session. Plain data, so that tests can make one by hand.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// File or built-in name of the scene.
    pub name: &'a str,
    /// The scene as read, for the names that it gives its nodes; tests by hand have none.
    pub scene: Option<&'a Scene>,
    /// The scene's model.
    pub model: &'a Model,
    /// The history, oldest first; never empty.
    pub frames: &'a [Frame],
    /// The compact records of the same points; empty in tests by hand.
    pub strips: &'a [Strip],
    /// The whole history, and what was found out beside it; tests by hand have neither.
    pub tree: Option<&'a Tree>,
    /// What is found out beside the session; `None` in drawings of it alone.
    pub background: Option<&'a Background>,
    /// The start gaps in words; empty where there are none.
    pub start_gaps: &'a str,
    /// The solver, where it is an attached one.
    pub guest: Option<Guest<'a>>,
    /// Which of them is shown.
    pub cursor: usize,
    /// Whether the solver is at work.
    pub running: bool,
    /// Norms by major iteration of the shown increment attempt.
    pub residuals: Vec<(u32, Norms)>,
    /// The branch, if there are several, and the watches with their values, in a line; empty where there is neither.
    pub aside: String,
}

/// An attached solver.
#[derive(Debug, Clone, Copy)]
pub struct Guest<'a> {
    /// What it offers.
    pub offers: &'a Offers,
    /// What it says besides.
    pub log: &'a Log,
    /// Whether it is gone; the next step starts it anew.
    pub lost: bool,
    /// What it does again in the running job, before it goes on.
    pub again: &'a str,
}

impl<'a> View<'a> {
    /// The look of a session now.
    pub fn of(session: &'a Session) -> Self {
        let mut view = View {
            name: session.scene_name(),
            scene: Some(session.scene()),
            model: session.model(),
            frames: session.frames(),
            strips: session.strips(),
            tree: Some(session.tree()),
            background: Some(session.background()),
            start_gaps: session.start_gaps(),
            guest: session.log().map(|log| Guest {
                offers: session.offers(),
                log,
                lost: session.lost().is_some(),
                again: session.again(),
            }),
            cursor: session.cursor(),
            running: session.is_running(),
            residuals: session.residual_history(),
            aside: match session.is_running() {
                true => String::new(),
                false => session.aside(),
            },
        };
        if view.event().is_none() {
            view.residuals.clear();
        }
        view
    }

    /// What is found out about the problem that is solved next from here; an inner `None` while that is at work.
    pub fn examination(&self) -> Option<Option<&'a Examination>> {
        self.background?
            .examination((self.tree?.current(), self.cursor))
    }

    /// Whether any remedies were tried, or are being tried.
    pub fn has_tried(&self) -> bool {
        self.background.is_some_and(|b| b.tried().is_some())
    }

    /// Whether remedies are being tried.
    pub fn is_trying(&self) -> bool {
        self.background.is_some_and(Background::is_trying)
    }

    /// Whether the remedies that were tried last, or are being tried, start from here; not those that were stopped.
    pub fn tries_here(&self) -> bool {
        let here = self.tree.map(|tree| (tree.current(), self.cursor));
        let tried = self.background.and_then(Background::tried);
        tried.is_some_and(|tried| Some(tried.place) == here && !tried.stopped)
    }

    /// What pushed a slave node in the shown minor iteration; an inner `None` if that cannot be told.
    pub fn pushes(&self, slave: usize) -> Option<Option<&'a [Push]>> {
        self.background?
            .pushes((self.tree?.current(), self.cursor), slave)
    }

    /// The frame that is shown.
    pub fn frame(&self) -> &'a Frame {
        &self.frames[self.cursor]
    }

    /// The minor iteration that led to the shown frame; `None` at the start, and if the increment starts again,
    /// since what was found before that is not about this state.
    pub fn event(&self) -> Option<&'a Event> {
        let (event, next) = (self.frame().event.as_deref()?, self.frame().state.next);
        let again =
            event.position.increment == next.increment && event.position.attempt != next.attempt;
        (!again || self.model.finished.is_some()).then_some(event)
    }

    /// What the user changed in the shown frame, if it is due to that.
    pub fn intervention(&self) -> Option<&'a Intervention> {
        self.frame().intervention.as_ref()
    }

    /// Where the solver is: the minor iteration that is shown, or else the one to come.
    pub fn position(&self) -> Position {
        self.event()
            .map_or(self.frame().state.next, |event| event.position)
    }

    /// What that minor iteration found at a slave node.
    pub fn record(&self, slave: usize) -> Option<&'a ContactRecord> {
        self.event()?.nodes.get(slave)
    }

    /// The solver's own words for a contact in the shown iteration.
    pub fn words(&self, slave: usize) -> Option<&'a str> {
        let words = self.event()?.words.contacts.get(slave)?;
        Some(words.as_str()).filter(|words| !words.trim().is_empty())
    }

    /// Which of the shown numbers are round-off; none at the start.
    pub fn round_off(&self) -> RoundOff {
        self.event().map_or(RoundOff::default(), |event| {
            RoundOff::of(self.model, &event.before)
        })
    }

    /// Name of a slave node.
    pub fn slave(&self, slave: usize) -> &'a str {
        match self.model.contacts.get(slave) {
            Some(slave) => &self.model.nodes[slave.node].name,
            None => "",
        }
    }

    /// The mode that a slave node takes next: Table 2's, or the user's.
    pub fn mode(&self, slave: usize) -> Mode {
        self.frame().state.nodes[slave].mode
    }

    /// The mode that it had in the shown minor iteration; at the start the one that it starts with.
    pub fn mode_before(&self, slave: usize) -> Mode {
        self.record(slave)
            .map_or(self.mode(slave), |record| record.decision.before)
    }

    /// How the user stands behind its next mode, or else behind the one that it had in the shown minor iteration.
    pub fn forced(&self, slave: usize) -> Forced {
        match (self.frame().state.nodes[slave].forced, self.record(slave)) {
            (Forced::No, Some(record)) if self.intervention().is_none() => record.forced,
            (forced, _) => forced,
        }
    }

    /// Whether a sliding node's T_max still moves by more than the tolerance, so that it is solved for again.
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

    /// Whether a number is one that an attached solver does not tell.
    pub fn is_untold(&self, value: f64) -> bool {
        self.guest.is_some() && value.is_nan()
    }

    /// A number as a cell of a table ([`number::cell`]); a dash where an attached solver does not tell it.
    pub fn cell(&self, value: f64, width: usize) -> String {
        match self.is_untold(value) || (self.guest.is_some() && value == f64::INFINITY) {
            true => format!(
                " {:<width$}",
                number::UNTOLD,
                width = width.saturating_sub(1)
            ),
            false => number::cell(value, width),
        }
    }

    /// The same with ten digits ([`number::long`]).
    pub fn long(&self, value: f64) -> String {
        match self.is_untold(value) || (self.guest.is_some() && value == f64::INFINITY) {
            true => number::UNTOLD.into(),
            false => number::long(value),
        }
    }

    /// Whether an attached solver decided otherwise on a node than the rules that it names want on the same numbers.
    pub fn differs(&self, slave: usize) -> bool {
        let record = self.record(slave).filter(|_| self.guest.is_some());
        record.is_some_and(|record| record.differs())
    }

    /// Where a node is: its place in the reference shape, displaced.
    pub fn place(&self, node: usize) -> [f64; 2] {
        self.model.place(&self.frame().state.u, node)
    }
}

/// What actions need to know to read their arguments.
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
        offers: view.and_then(|view| view.guest).map(|guest| guest.offers),
        state: view.map(|view| &view.frame().state),
        scenes,
        lessons: teach::list(),
        keymap: None,
    }
}
