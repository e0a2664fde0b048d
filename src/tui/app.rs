//! What the terminal alone knows, and what a key does to it. No drawing and no session here: a key changes the
//! app and yields at most one [`Effect`], which the event loop carries out.

use crate::debug::branches::summaries;
use crate::debug::command::{
    self, Action, ChartOf, Command, Context, Filter, Page, Question, Sort, Step, To, Ui, Whose,
};
use crate::debug::lesson::tutor::Kind;
use crate::debug::lesson::{Guess, Tutor};
use crate::outside::shown;
use crate::scene::Mode;
use crate::tui::branches;
use crate::tui::commandline::{CommandLine, Purpose};
use crate::tui::keys;
use crate::tui::layout::{Choice, Pane};
use crate::tui::manual;
use crate::tui::nodes;
use crate::tui::number;
use crate::tui::theme::{self, Theme};
use crate::tui::view::View;
use crate::tui::workprecision;
use crossterm::event::KeyEvent;

/// What a key asks of the world outside the app.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// A command for the session.
    Submit(Command),
    /// Stop the run.
    Interrupt,
    /// Load a scene, by file or built-in name.
    Open(String),
    /// Begin a lesson, by file or built-in name.
    Lesson(String),
    /// Show a work-precision chart.
    Chart(ChartOf),
    Suspend,
    Redraw,
    Quit,
}

/// What lies over the panes or waits for keys before they do.
#[derive(Debug, Clone)]
pub enum Overlay {
    None,
    /// The list of actions, from this line on.
    Help {
        top: usize,
    },
    /// A page of the manual.
    Manual(manual::Reader),
    /// The list of scenes, with one of them selected.
    Chooser {
        at: usize,
    },
    /// A work-precision chart.
    Chart(Box<workprecision::Page>),
    /// A line being typed.
    Line(CommandLine),
    /// A letter for the mode of the selected node.
    Mode,
    /// A letter or digit that answers a question.
    Answer,
}

/// How the message line speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    Plain,
    Error,
}

/// The last thing that was said to the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    pub text: String,
    pub tone: Tone,
}

/// How the shape is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// 1 shows all of it.
    pub zoom: f64,
    /// Shift of the middle, as a fraction of what is seen at zoom 1.
    pub pan: [f64; 2],
}

impl Camera {
    /// All of the shape.
    pub const ALL: Camera = Camera {
        zoom: 1.0,
        pan: [0.0; 2],
    };

    fn zoomed(self, factor: f64) -> Camera {
        Camera {
            zoom: (self.zoom * factor).clamp(0.05, 1e4),
            ..self
        }
    }

    fn panned(self, x: f64, y: f64) -> Camera {
        let step = 0.1 / self.zoom;
        Camera {
            pan: [self.pan[0] + step * x, self.pan[1] + step * y],
            ..self
        }
    }
}

/// A scene that the chooser offers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    pub name: String,
    pub title: String,
}

/// Everything on the screen that is not in the session.
#[derive(Debug, Clone)]
pub struct App {
    pub theme: Theme,
    pub overlay: Overlay,
    /// Pane with the focus.
    pub focus: Pane,
    /// Pane under the table where the screen is small.
    pub page: Pane,
    pub zoomed: bool,
    /// Selected slave node, by slave number.
    pub selected: usize,
    /// Count typed before a motion.
    pub count: Option<u32>,
    pub message: Message,
    pub camera: Camera,
    /// How the table sorts, whether the other way round, and which nodes it shows.
    pub sort: Sort,
    pub backward: bool,
    pub filter: Filter,
    /// Monitor of the load-displacement curve.
    pub monitor: usize,
    /// Selected consistent state, branch (by its row in the tree) and remedy; first line of the diagnosis.
    pub answer: usize,
    pub branch: usize,
    pub remedy: usize,
    pub scroll: usize,
    /// Which of the panes that take turns is shown where there is room for one.
    pub chart: Pane,
    /// Scenes to choose from.
    pub offers: Vec<Offer>,
    /// The lesson that is being taken.
    pub lesson: Option<Tutor>,
    /// Free mode, outside lessons.
    pub guess: Option<Guess>,
    /// Increments done of a chart that is being measured, and all of them.
    pub measuring: Option<(u64, u64)>,
    /// Whether a file is being read.
    pub loading: bool,
    /// Whether the journal was lost.
    pub unkept: bool,
    /// Turns of the spinner.
    pub tick: usize,
    /// The last motion, for Enter.
    last: Option<Command>,
    /// Lines typed at `:`, oldest first.
    history: Vec<String>,
}

/// Largest count that digits can make.
const MOST: u32 = 1_000_000;
/// Nodes that a page key goes past.
const PAGE: isize = 10;

impl App {
    /// A fresh screen. Without a scene the chooser comes first.
    pub fn new(theme: Theme, offers: Vec<Offer>) -> Self {
        App {
            theme,
            overlay: Overlay::None,
            focus: Pane::Nodes,
            page: Pane::Decision,
            zoomed: false,
            selected: 0,
            count: None,
            message: Message {
                text: String::new(),
                tone: Tone::Plain,
            },
            camera: Camera::ALL,
            sort: Sort::Scene,
            backward: false,
            filter: Filter::All,
            monitor: 0,
            answer: 0,
            branch: 0,
            remedy: 0,
            scroll: 0,
            chart: Pane::Residual,
            offers,
            lesson: None,
            guess: None,
            measuring: None,
            loading: false,
            unkept: false,
            tick: 0,
            last: None,
            history: Vec::new(),
        }
    }

    /// Says something.
    pub fn say(&mut self, text: impl Into<String>) {
        self.tell(text.into(), Tone::Plain);
    }

    /// Says what went wrong.
    pub fn complain(&mut self, text: impl Into<String>) {
        self.tell(text.into(), Tone::Error);
    }

    fn tell(&mut self, text: String, tone: Tone) {
        let text = shown::line(&text.replace('\n', " ")).into_owned();
        self.message = Message { text, tone };
    }

    /// Shows a scene that was just opened.
    pub fn opened(&mut self) {
        self.overlay = Overlay::None;
        self.selected = 0;
        self.monitor = 0;
        (self.answer, self.branch, self.remedy, self.scroll) = (0, 0, 0, 0);
        self.camera = Camera::ALL;
        self.last = None;
        self.count = None;
        self.lesson = None;
        self.guess = None;
    }

    /// Offers the scenes.
    pub fn choose(&mut self) {
        self.overlay = Overlay::Chooser { at: 0 };
    }

    /// The user's part in the arrangement of the screen.
    pub fn choice(&self, slaves: usize, outcome: u16, message: u16, lesson: u16) -> Choice {
        Choice {
            focus: self.focus,
            page: self.page,
            chart: self.chart,
            zoomed: self.zoomed,
            slaves,
            outcome,
            message,
            lesson,
        }
    }

    /// What a key does.
    pub fn key(&mut self, key: &KeyEvent, view: Option<&View>) -> Option<Effect> {
        let name = keys::name(key)?;
        match (&mut self.overlay, name.as_str()) {
            (_, "Ctrl-z") => Some(Effect::Suspend),
            (_, "Ctrl-l") => Some(Effect::Redraw),
            (_, "Ctrl-c") => self.interrupt(view),
            (Overlay::None, _) => self.pane_key(&name, view),
            (Overlay::Help { .. }, _) => self.help_key(&name),
            (Overlay::Manual(reader), _) => {
                if !reader.key(&name) {
                    self.close(view);
                }
                None
            }
            (Overlay::Chooser { .. }, _) => self.chooser_key(&name, view),
            (Overlay::Chart(_), _) => self.chart_key(&name, view),
            (Overlay::Line(_), _) => self.line_key(key, &name, view),
            (Overlay::Mode, _) => self.mode_key(&name, view),
            (Overlay::Answer, _) => self.answer_key(&name, view),
        }
    }

    /// Text pasted from the terminal goes into a line that is being typed, and nowhere else: keys do things.
    pub fn paste(&mut self, text: &str) {
        if let Overlay::Line(line) = &mut self.overlay {
            line.insert(text);
        }
    }

    fn scenes(&self) -> Vec<String> {
        self.offers.iter().map(|offer| offer.name.clone()).collect()
    }

    /// Ctrl-C: closes what is open and stops a run; never the program.
    fn interrupt(&mut self, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        let trying = |view: &View| view.looks.is_some_and(|looks| looks.is_trying());
        let works = view.is_some_and(|view| view.running || trying(view));
        if works || self.measuring.is_some() || self.loading {
            return Some(Effect::Interrupt);
        }
        self.say("nothing is running; q quits");
        None
    }

    /// Closes overlays; without a scene the chooser is what is left.
    fn close(&mut self, view: Option<&View>) {
        self.count = None;
        match view {
            Some(_) => self.overlay = Overlay::None,
            None => self.choose(),
        }
    }

    fn pane_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        if let Some(digit) = digit(name)
            && (digit > 0 || self.count.is_some())
        {
            self.count = Some(
                (self
                    .count
                    .unwrap_or(0)
                    .saturating_mul(10)
                    .saturating_add(digit))
                .min(MOST),
            );
            return None;
        }
        let count = self.count.take();
        let Some(entry) = command::by_key(name) else {
            self.complain(format!("{name} does nothing here; ? lists the keys"));
            return None;
        };
        let rest = count
            .filter(|_| entry.takes_count())
            .map(|count| count.to_string());
        let action = entry.act(
            &rest.unwrap_or_default(),
            &context(view, self.selected, &[]),
        );
        self.attempt(action, count, view)
    }

    /// Carries out an action, or says why it cannot be.
    fn attempt(
        &mut self,
        action: Result<Action, String>,
        count: Option<u32>,
        view: Option<&View>,
    ) -> Option<Effect> {
        let action = action.and_then(|action| Ok((self.permits(&action, view)?, action)));
        match action {
            Ok((_, Action::Session(command))) => self.submit(command, view),
            Ok((wanted, Action::Ui(ui))) => {
                let effect = self.ui(ui, count, view);
                if let (true, Some(tutor), Some(view)) = (wanted, &mut self.lesson, view) {
                    tutor.settled(view.cursor, view.frame());
                }
                effect
            }
            Err(message) => {
                self.complain(message);
                None
            }
        }
    }

    /// Whether the lesson, or free mode, lets an action be done; true where the lesson wants it.
    fn permits(&mut self, action: &Action, view: Option<&View>) -> Result<bool, String> {
        let Some(view) = view else { return Ok(false) };
        match (&mut self.lesson, &mut self.guess) {
            (Some(tutor), None) => tutor.permits(action, view.cursor, view.frame()),
            (_, Some(guess)) => {
                guess.permits(action, view.cursor, view.frame())?;
                Ok(false)
            }
            (None, None) => Ok(false),
        }
    }

    /// Free mode, of the lesson or outside.
    pub fn guessing(&self) -> Option<&Guess> {
        let lesson = self.lesson.as_ref().and_then(Tutor::guess);
        lesson.or(self.guess.as_ref())
    }

    /// Whether any decision of the shown frame must not be seen yet.
    pub fn hides_any(&self, view: &View) -> bool {
        let frame = view.frame();
        view.event().is_some()
            && (self.lesson.as_ref().is_some_and(Tutor::hides)
                || self
                    .guessing()
                    .is_some_and(|guess| guess.is_open(view.cursor, frame)))
    }

    /// Whether the decision on this slave node must not be seen yet.
    pub fn hides(&self, view: &View, slave: usize) -> bool {
        view.record(slave).is_some()
            && (self.lesson.as_ref().is_some_and(Tutor::hides)
                || self
                    .guessing()
                    .is_some_and(|guess| guess.hides(view.cursor, view.frame(), slave)))
    }

    fn submit(&mut self, command: Command, view: Option<&View>) -> Option<Effect> {
        match view {
            None => self.complain("open a scene first"),
            Some(_) => {
                if matches!(command, Command::Forward { .. } | Command::Back { .. }) {
                    self.last = Some(command.clone());
                }
                self.say("");
                return Some(Effect::Submit(command));
            }
        }
        None
    }

    fn ui(&mut self, ui: Ui, count: Option<u32>, view: Option<&View>) -> Option<Effect> {
        match ui {
            Ui::Quit => return Some(Effect::Quit),
            Ui::Suspend => return Some(Effect::Suspend),
            Ui::Redraw => return Some(Effect::Redraw),
            Ui::Interrupt => return self.interrupt(view),
            Ui::Open(scene) => return Some(Effect::Open(scene)),
            Ui::Repeat if self.lesson.as_ref().is_some_and(Tutor::is_read) => self.go_on(view),
            Ui::Repeat if self.focus == Pane::Branches => return self.go_to_branch(view),
            Ui::Repeat if self.focus == Pane::Remedies => return self.apply(self.remedy, view),
            Ui::Repeat if self.focus == Pane::Diagnosis => {
                return self.start_from(self.answer, view);
            }
            Ui::Repeat => match self.last.clone() {
                Some(command) => return self.attempt(Ok(Action::Session(command)), None, view),
                None => self.complain("there is no motion to repeat yet; s is one minor iteration"),
            },
            Ui::Move(step) => return self.step(step, count.unwrap_or(1) as isize, view),
            Ui::Select(slave) => self.selected = slave,
            Ui::NextPane => self.turn(1),
            Ui::PreviousPane => self.turn(Pane::ALL.len() - 1),
            Ui::Zoom => self.zoomed = !self.zoomed,
            Ui::Explain => self.show(Pane::Decision),
            Ui::Page(page) => return self.page(page, view),
            Ui::StartFrom(number) => return self.start_from(number, view),
            Ui::Apply(number) => return self.apply(number, view),
            Ui::Enlarge => self.camera = self.camera.zoomed(1.25),
            Ui::Shrink => self.camera = self.camera.zoomed(0.8),
            Ui::Fit => self.camera = Camera::ALL,
            Ui::Sort(sort) => self.sort = sort.unwrap_or(next(&Sort::ALL, self.sort)),
            Ui::SortBackward => self.backward = !self.backward,
            Ui::Filter(filter) => self.filter = filter.unwrap_or(next(&Filter::ALL, self.filter)),
            Ui::Monitor(monitor) => self.watch(monitor, view),
            Ui::Chart(of) => return Some(Effect::Chart(of)),
            Ui::Lesson(lesson) => return Some(Effect::Lesson(lesson)),
            Ui::On => self.go_on(view),
            Ui::Answer(word) => self.answer(&word, view),
            Ui::Predict(whose) => self.predict(whose, view),
            Ui::Ask(question) => self.ask(question, view),
            Ui::CommandLine => self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "")),
            Ui::Help => self.overlay = Overlay::Help { top: 0 },
            Ui::Manual(page) => self.overlay = Overlay::Manual(manual::Reader::new(page)),
            Ui::Cancel => {
                self.zoomed = false;
                self.say("");
            }
        }
        None
    }

    /// On with the lesson.
    fn go_on(&mut self, view: Option<&View>) {
        let (Some(tutor), Some(view)) = (&mut self.lesson, view) else {
            return self.complain("no lesson is being taken; L begins one");
        };
        match tutor.on(view.cursor, view.frame()) {
            Ok(()) => self.say(""),
            Err(message) => self.complain(message),
        }
    }

    /// Answers the lesson's question, or predicts.
    fn answer(&mut self, word: &str, view: Option<&View>) {
        let Some(view) = view else {
            return self.complain("open a scene first");
        };
        let (cursor, frame, selected) = (view.cursor, view.frame(), self.selected);
        let told = match (&mut self.lesson, &mut self.guess) {
            (_, Some(guess)) => guess
                .predict(view.model, cursor, frame, selected, word)
                .map(|(_, text)| text),
            (Some(tutor), None) => tutor
                .answer(word, selected, cursor, frame)
                .map(|()| String::new()),
            (None, None) => {
                Err("nothing is asked; p hides decisions until you predict them".into())
            }
        };
        match told {
            Ok(text) => self.say(text),
            Err(message) => self.complain(message),
        }
    }

    /// Switches free mode.
    fn predict(&mut self, whose: Option<Whose>, view: Option<&View>) {
        let Some(view) = view else {
            return self.complain("open a scene first");
        };
        if self
            .lesson
            .as_ref()
            .is_some_and(|tutor| tutor.step().is_some())
        {
            return self.complain("the lesson asks by itself");
        }
        let toggled = match self.guess {
            Some(_) => Whose::Off,
            None => Whose::Selected,
        };
        match (whose.unwrap_or(toggled), &self.guess) {
            (Whose::Off, Some(guess)) => {
                let told = format!("predicted: {} right, {} wrong", guess.right, guess.wrong);
                self.guess = None;
                self.say(told);
            }
            (Whose::Off, None) => self.complain("decisions are not hidden"),
            (whose, _) => {
                self.guess = Some(Guess::new(whose, view.cursor));
                self.say("decisions hide until you predict them: step, then a and f, s or x");
            }
        }
    }

    fn turn(&mut self, places: usize) {
        self.look_at(self.focus.turn(places));
    }

    /// Gives a pane the focus, and a place on the screen.
    fn look_at(&mut self, pane: Pane) {
        self.focus = pane;
        if pane != Pane::Nodes {
            self.page = pane;
        }
        if pane.takes_turns() {
            self.chart = pane;
        }
    }

    /// Shows a monitor's curve, or the next one's.
    fn watch(&mut self, monitor: Option<usize>, view: Option<&View>) {
        let monitors = view.map_or(&[][..], |view| &view.model.monitors);
        let next = (self.monitor + 1) % monitors.len().max(1);
        self.monitor = monitor.unwrap_or(next);
        match monitors.get(self.monitor) {
            Some(monitor) => self.say(format!("load over {}", monitor.name)),
            None => self.complain("this scene has no monitors"),
        }
    }

    /// Gives a pane the whole screen, or takes it back.
    fn show(&mut self, pane: Pane) {
        self.zoomed = !(self.zoomed && self.focus == pane);
        self.look_at(pane);
    }

    /// Shows a page of its own key; one that has nothing to show yet asks for it.
    fn page(&mut self, page: Page, view: Option<&View>) -> Option<Effect> {
        self.show(match page {
            Page::Timeline => Pane::Timeline,
            Page::Diagnosis => Pane::Diagnosis,
            Page::Branches => Pane::Branches,
            Page::Remedies => Pane::Remedies,
        });
        let view = view?;
        match page {
            Page::Diagnosis if view.finding().is_none() => {
                (self.answer, self.scroll) = (0, 0);
                self.submit(Command::Census(Vec::new()), Some(view))
            }
            Page::Branches => {
                let all = summaries(view.tree?);
                let order = branches::order(&all);
                let current = order.iter().position(|&(branch, _)| all[branch].is_current);
                self.branch = current.unwrap_or(0);
                None
            }
            Page::Remedies => {
                let looks = view.looks?;
                let here = (view.tree?.current(), view.cursor);
                let known = looks.tried().is_some_and(|tried| tried.place == here);
                if known || looks.is_trying() || !self.zoomed {
                    return None;
                }
                self.remedy = 0;
                self.submit(Command::Remedies, Some(view))
            }
            _ => None,
        }
    }

    /// Goes to the tip of the selected branch.
    fn go_to_branch(&mut self, view: Option<&View>) -> Option<Effect> {
        let all = summaries(view?.tree?);
        let (branch, _) = *branches::order(&all).get(self.branch)?;
        let to = To::Named(format!("b{}", branch + 1));
        self.submit(Command::Branch(to), view)
    }

    /// Starts from a consistent state of the census.
    fn start_from(&mut self, number: usize, view: Option<&View>) -> Option<Effect> {
        let found = view?.finding().flatten();
        match found.and_then(|found| found.starts(number)) {
            Some(starts) => return self.submit(Command::Assume(starts), view),
            None if found.is_none() => {
                self.complain(
                    "which states are consistent is not known here yet; :census finds out",
                );
            }
            None => self.complain(format!("there is no consistent state {}", number + 1)),
        }
        None
    }

    /// Takes a remedy of the list, where it was tried.
    fn apply(&mut self, number: usize, view: Option<&View>) -> Option<Effect> {
        let (looks, here) = (view?.looks?, (view?.tree?.current(), view?.cursor));
        let Some(tried) = looks.tried().filter(|tried| !tried.trials.is_empty()) else {
            self.complain("no remedy is tried yet; r tries them all");
            return None;
        };
        let Some(trial) = tried.trials.get(number) else {
            self.complain(format!("there is no remedy {}", number + 1));
            return None;
        };
        if looks.is_trying() || tried.place != here {
            let (branch, step) = tried.place;
            self.complain(match looks.is_trying() {
                true => "remedies are still being tried; Ctrl-C stops that".into(),
                false => format!(
                    "these were tried from step {step} of b{}; go there, or r twice tries them from here",
                    branch + 1
                ),
            });
            return None;
        }
        self.zoomed = false;
        let (label, steps) = (trial.label.clone(), trial.steps.clone());
        self.submit(Command::Follow { label, steps }, view)
    }

    fn step(&mut self, step: Step, count: isize, view: Option<&View>) -> Option<Effect> {
        if self.focus == Pane::Timeline
            && let Some(to) = view.and_then(|view| along(step, count, view))
        {
            return self.submit(Command::Goto { step: to }, view);
        }
        let tried = view.and_then(|view| view.looks?.tried());
        let answers = view.and_then(|view| Some(view.finding()??.census.as_ref()?.answers.len()));
        let list = match self.focus {
            Pane::Branches => {
                let count = view.and_then(|view| Some(view.tree?.branches().len()));
                Some((&mut self.branch, count))
            }
            Pane::Remedies => Some((&mut self.remedy, tried.map(|tried| tried.trials.len()))),
            Pane::Diagnosis if matches!(step, Step::PageUp | Step::PageDown) => {
                Some((&mut self.scroll, Some(usize::MAX)))
            }
            Pane::Diagnosis => Some((&mut self.answer, answers)),
            _ => None,
        };
        if let Some((at, length)) = list {
            let last = length.unwrap_or(0).saturating_sub(1);
            *at = moved(*at, step, count, last);
            return None;
        }
        let order = view.map_or(Vec::new(), |view| nodes::order(self, view));
        let last = order.len().saturating_sub(1);
        let here = order.iter().position(|slave| *slave == self.selected);
        let row = |row: usize| order.get(row).copied().unwrap_or(0);
        let to = |by: isize| {
            let to = here
                .unwrap_or(0)
                .saturating_add_signed(by.saturating_mul(count));
            row(to.min(last))
        };
        match (self.focus, step) {
            (Pane::Shape, Step::Left) => self.camera = self.camera.panned(-1.0, 0.0),
            (Pane::Shape, Step::Right) => self.camera = self.camera.panned(1.0, 0.0),
            (Pane::Shape, Step::Up) => self.camera = self.camera.panned(0.0, 1.0),
            (Pane::Shape, Step::Down) => self.camera = self.camera.panned(0.0, -1.0),
            (_, Step::Up) => self.selected = to(-1),
            (_, Step::Down) => self.selected = to(1),
            (_, Step::PageUp) => self.selected = to(-PAGE),
            (_, Step::PageDown) => self.selected = to(PAGE),
            (_, Step::First) => self.selected = row(0),
            (_, Step::Last) => self.selected = row(last),
            (_, Step::Left | Step::Right) => {}
        }
        None
    }

    fn ask(&mut self, question: Question, view: Option<&View>) {
        let has_slaves = view.is_some_and(|view| !view.model.slaves.is_empty());
        match question {
            Question::Mode if !has_slaves => self.complain("this scene has no slave nodes"),
            Question::Mode => self.overlay = Overlay::Mode,
            Question::Increment => {
                self.overlay = Overlay::Line(CommandLine::new(Purpose::Increment, ""))
            }
            Question::Node => self.overlay = Overlay::Line(CommandLine::new(Purpose::Node, "")),
            Question::Scene => self.choose(),
            Question::Break => {
                self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "break "))
            }
            Question::Lesson => {
                self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "lesson "))
            }
            Question::Answer => self.ask_answer(view),
        }
    }

    /// Opens what an answer is typed into.
    fn ask_answer(&mut self, view: Option<&View>) {
        let asked = self.lesson.as_ref().and_then(Tutor::question);
        let open = view.is_some_and(|view| self.guessing().is_some() && self.hides_any(view));
        match asked.map(|question| question.kind) {
            Some(Kind::Number) => {
                self.overlay = Overlay::Line(CommandLine::new(Purpose::Answer, ""))
            }
            Some(Kind::Mode | Kind::Choice) => self.overlay = Overlay::Answer,
            None if open => self.overlay = Overlay::Answer,
            // What there is to say about it, the answering says.
            None => self.answer("free", view),
        }
    }

    fn answer_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        if name != "Esc" {
            self.answer(name, view);
        }
        None
    }

    fn mode_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        let wanted = [Mode::Free, Mode::Sliding, Mode::Fixed]
            .into_iter()
            .find(|mode| theme::letter(*mode).eq_ignore_ascii_case(name));
        match wanted {
            Some(mode) => {
                let hold = name.chars().all(char::is_uppercase);
                let force = Command::Force {
                    slave: self.selected,
                    mode,
                    hold,
                };
                self.attempt(Ok(Action::Session(force)), None, view)
            }
            None if name == "Esc" => None,
            None => {
                self.complain(format!(
                    "{name} is no mode: f free, s sliding, x fixed; a capital holds it"
                ));
                None
            }
        }
    }

    fn help_key(&mut self, name: &str) -> Option<Effect> {
        let Overlay::Help { top } = &mut self.overlay else {
            return None;
        };
        match name {
            "Esc" | "q" | "?" | "F1" | "Enter" => self.overlay = Overlay::None,
            _ => *top = scrolled(*top, name, usize::MAX),
        }
        None
    }

    fn chart_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        let Overlay::Chart(page) = &mut self.overlay else {
            return None;
        };
        if !page.key(name) && ["Esc", "q", "Enter"].contains(&name) {
            self.close(view);
        }
        None
    }

    fn chooser_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        let Overlay::Chooser { at } = &mut self.overlay else {
            return None;
        };
        match name {
            "Enter" => {
                return self
                    .offers
                    .get(*at)
                    .map(|offer| Effect::Open(offer.name.clone()));
            }
            "q" | "Esc" if view.is_none() => return Some(Effect::Quit),
            "q" | "Esc" => self.overlay = Overlay::None,
            ":" => self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "open ")),
            "L" => self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "lesson ")),
            _ => *at = scrolled(*at, name, self.offers.len().saturating_sub(1)),
        }
        None
    }

    fn line_key(&mut self, key: &KeyEvent, name: &str, view: Option<&View>) -> Option<Effect> {
        let scenes = self.scenes();
        let context = context(view, self.selected, &scenes);
        let Overlay::Line(line) = &mut self.overlay else {
            return None;
        };
        match name {
            "Esc" => self.close(view),
            "Backspace" if line.text().is_empty() => self.close(view),
            "Tab" => line.complete(1, &context),
            "Shift-Tab" => line.complete(-1, &context),
            "Up" => line.recall(1, &self.history),
            "Down" => line.recall(-1, &self.history),
            "Enter" => return self.enter(view),
            _ => line.edit(key),
        }
        None
    }

    /// Carries out the line that was typed.
    fn enter(&mut self, view: Option<&View>) -> Option<Effect> {
        let Overlay::Line(line) = &self.overlay else {
            return None;
        };
        let (purpose, text) = (line.purpose, line.text().trim().to_string());
        self.close(view);
        let line = match purpose {
            _ if text.is_empty() => return None,
            Purpose::Command => text,
            Purpose::Increment => format!("increment {text}"),
            Purpose::Node => format!("node {text}"),
            Purpose::Answer => format!("answer {text}"),
        };
        self.history.retain(|old| *old != line);
        self.history.push(line.clone());
        let scenes = self.scenes();
        let action = command::parse(&line, &context(view, self.selected, &scenes));
        self.attempt(action, None, view)
    }

    /// What the prompt in the message line asks; none where nothing is asked.
    pub fn question(&self, view: Option<&View>) -> Option<String> {
        let view = view?;
        match &self.overlay {
            Overlay::Mode => Some(format!(
                "mode of {}:  f free   s sliding   x fixed   (a capital holds it until M releases)",
                view.slave(self.selected)
            )),
            Overlay::Answer => Some(self.asked(view)),
            Overlay::Line(line) if line.purpose == Purpose::Increment => Some(format!(
                "new increment (now {}): ",
                number::plain(view.frame().state.controls.increment)
            )),
            _ => None,
        }
    }
}

impl App {
    /// What the prompt of an answer says.
    fn asked(&self, view: &View) -> String {
        match self.lesson.as_ref().and_then(Tutor::question) {
            Some(question) if question.kind == Kind::Choice => {
                format!("your answer:  1 to {}", question.options.len())
            }
            Some(_) => "your answer:  f free   s sliding   x fixed".into(),
            None => format!(
                "next mode of {}:  f free   s sliding   x fixed",
                view.slave(self.selected)
            ),
        }
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
        scenes,
    }
}

/// Where a step in a list of so many entries leads.
fn moved(at: usize, step: Step, count: isize, last: usize) -> usize {
    let by = match step {
        Step::Up => -count,
        Step::Down => count,
        Step::PageUp => -PAGE,
        Step::PageDown => PAGE,
        Step::First => return 0,
        Step::Last => return last,
        Step::Left | Step::Right => 0,
    };
    at.saturating_add_signed(by).min(last)
}

/// Where a step along the timeline leads; none where it is no such step.
fn along(step: Step, count: isize, view: &View) -> Option<usize> {
    let last = view.frames.len().saturating_sub(1);
    let by = match step {
        Step::Left => -count,
        Step::Right => count,
        Step::PageUp => -PAGE,
        Step::PageDown => PAGE,
        Step::First => return Some(0),
        Step::Last => return Some(last),
        Step::Up | Step::Down => return None,
    };
    Some(view.cursor.saturating_add_signed(by).min(last))
}

/// What comes after one of several, round and round.
fn next<T: Copy + PartialEq>(all: &[T], one: T) -> T {
    let at = all.iter().position(|other| *other == one);
    all[at.map_or(0, |at| (at + 1) % all.len())]
}

/// The digit that a key is.
fn digit(name: &str) -> Option<u32> {
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => letter.to_digit(10),
        _ => None,
    }
}

/// Where a list stands after a key that moves in lists.
fn scrolled(at: usize, name: &str, last: usize) -> usize {
    let to = match name {
        "Up" | "k" => at.saturating_sub(1),
        "Down" | "j" => at.saturating_add(1),
        "PageUp" => at.saturating_sub(PAGE as usize),
        "PageDown" | "Space" => at.saturating_add(PAGE as usize),
        "Home" | "g" => 0,
        "End" | "G" => last,
        _ => at,
    };
    to.min(last)
}
