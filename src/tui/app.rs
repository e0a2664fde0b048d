//! What the terminal alone knows, and what a key does to it. No drawing and no session here: a key changes the
//! app and yields at most one [`Effect`], which the event loop carries out.

use crate::ahead::{Ahead, Typed};
use crate::camera::Camera;
use crate::chartpage::ChartPage;
use crate::choosing::{Chooser, Offer, Preview};
use crate::commandline::{CommandLine, Purpose};
use crate::hearing::Heard;
use crate::keys;
use crate::layout::{Choice, Pane};
use crate::panes::help::{Help, Listing};
use crate::panes::manual;
use crate::panes::solver;
use crate::theme::{self, Theme};
use crate::view::{View, context};
use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use std::fmt;
use stickslip_debugger::action::{
    Action, ChartOf, Colours, Context, Filter, Keymap, Misread, Sort, Ui,
};
use stickslip_debugger::record::command::Command;
use stickslip_debugger::teach::{Guess, Tutor};
use stickslip_scene::shown;

/// Nodes that a page key goes past.
pub(super) const PAGE: isize = 10;

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
    /// Copy a text to the terminal's clipboard.
    Copy(String),
    /// Heed the mouse from now on, or leave it to the terminal.
    Mouse(bool),
    /// Go back to the shell for a while.
    Suspend,
    /// Draw the whole screen anew.
    Redraw,
    /// Leave.
    Quit,
}

/// What lies over the panes or waits for keys before they do.
#[derive(Debug, Clone)]
pub enum Overlay {
    /// Nothing lies over the panes.
    None,
    /// The list of actions, or of keys.
    Help(Help),
    /// A page of the manual.
    Manual(manual::Reader),
    /// The list of what can be opened.
    Chooser(Chooser),
    /// A work-precision chart.
    Chart(Box<ChartPage>),
    /// What an attached solver says, or lets be set.
    Solver(solver::Reader),
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
    /// Said in passing.
    Plain,
    /// Something was refused.
    Error,
}

/// The last thing that was said to the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// What is said.
    pub text: String,
    /// How.
    pub tone: Tone,
}

/// What comes on the screen once a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opens {
    /// Another scene, with a lesson or without.
    Scene,
    /// A page over the panes.
    Page,
}

/// What of a lesson's words was read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Reading {
    /// The page that this is about ([`Tutor::edition`]).
    pub edition: (usize, u32),
    /// The first line that is shown, from 0.
    pub top: usize,
    /// Lines from the first one on that were shown.
    pub seen: usize,
}

/// Everything on the screen that is not in the session.
#[derive(Debug, Clone)]
pub struct App {
    /// Colours and weights.
    pub theme: Theme,
    /// Which key does what.
    pub keymap: Keymap,
    /// The colours that were chosen, which the environment may overrule.
    pub colours: Colours,
    /// Whether the mouse is heeded.
    pub mouse: bool,
    /// The screen as it was drawn last.
    pub area: Rect,
    /// What lies over the panes.
    pub overlay: Overlay,
    /// Pane with the focus.
    pub focus: Pane,
    /// Pane under the table where the screen is small.
    pub page: Pane,
    /// Whether the focused pane has the whole screen.
    pub zoomed: bool,
    /// Selected slave node, by slave number.
    pub selected: usize,
    /// Count typed before a motion.
    pub count: Option<u32>,
    /// What was said last.
    pub message: Message,
    /// What an attached solver said of itself, or how it was lost, until the next key.
    pub notice: Option<String>,
    /// What of its log was heard.
    pub heard: Heard,
    /// What the shape shows, and how large.
    pub camera: Camera,
    /// How the table sorts, whether the other way round, and which nodes it shows.
    pub sort: Sort,
    /// Whether nodes are sorted backward.
    pub backward: bool,
    /// Which nodes the table shows.
    pub filter: Filter,
    /// Monitor of the load-displacement curve.
    pub monitor: usize,
    /// Selected consistent state, branch (by its row in the tree) and remedy; first line of the diagnosis.
    pub answer: usize,
    /// The selected branch, from 0.
    pub branch: usize,
    /// The selected remedy, from 0.
    pub remedy: usize,
    /// The first line of the diagnosis that is shown, from 0.
    pub scroll: usize,
    /// Which of the panes that take turns is shown where there is room for one.
    pub chart: Pane,
    /// What there is to choose from.
    pub offers: Vec<Offer>,
    /// What is known of what is selected there.
    pub preview: Option<Preview>,
    /// The lesson that is being taken.
    pub lesson: Option<Tutor>,
    /// What of its words was read.
    pub reading: Reading,
    /// Free mode, outside lessons.
    pub guess: Option<Guess>,
    /// Increments done of a chart that is being measured, and all of them.
    pub measuring: Option<(u64, u64)>,
    /// What a file that is being read is shown as.
    pub loading: Option<Opens>,
    /// What is typed and not done yet.
    pub ahead: Ahead,
    /// Whether the journal was lost.
    pub unkept: bool,
    /// Turns of the spinner.
    pub tick: usize,
    /// The last motion, for Enter.
    pub(super) last: Option<Command>,
    /// Lines typed at `:`, oldest first.
    pub(super) history: Vec<String>,
    /// What `/` looked for last.
    pub(super) sought: String,
}

/// Largest count that digits can make.
const MOST: u32 = 1_000_000;

impl App {
    /// A fresh screen. Without a scene the chooser comes first.
    pub fn new(theme: Theme, offers: Vec<Offer>) -> Self {
        App {
            theme,
            keymap: Keymap::default(),
            colours: Colours::default(),
            mouse: true,
            area: Rect::new(0, 0, 80, 24),
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
            notice: None,
            heard: Heard::default(),
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
            preview: None,
            lesson: None,
            reading: Reading::default(),
            guess: None,
            measuring: None,
            loading: None,
            ahead: Ahead::default(),
            unkept: false,
            tick: 0,
            last: None,
            history: Vec::new(),
            sought: String::new(),
        }
    }

    /// Says something.
    pub fn say(&mut self, text: impl Into<String>) {
        self.tell(text.into(), Tone::Plain);
    }

    /// Says what went wrong.
    pub fn complain(&mut self, text: impl fmt::Display) {
        self.tell(text.to_string(), Tone::Error);
    }

    pub(super) fn tell(&mut self, text: String, tone: Tone) {
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
        (self.notice, self.heard) = (None, Heard::default());
        self.last = None;
        self.count = None;
        self.lesson = None;
        self.guess = None;
    }

    /// Whether nothing lies over the panes but the list of scenes, so that what is read or measured can be shown.
    pub fn is_open_to_pages(&self) -> bool {
        matches!(self.overlay, Overlay::None | Overlay::Chooser(_))
    }

    /// Offers scenes and lessons.
    pub fn choose(&mut self) {
        self.overlay = Overlay::Chooser(Chooser::default());
    }

    /// The user's part in the arrangement of the screen.
    pub fn choice(&self, view: Option<&View>, lesson: u16) -> Choice {
        let model = view.map(|view| view.model);
        Choice {
            focus: self.focus,
            page: self.page,
            chart: self.chart,
            zoomed: self.zoomed,
            slaves: model.map_or(0, |model| model.contacts.len()),
            has_shape: model.is_none_or(|model| model.finished.is_none()),
            lesson,
        }
    }

    /// What a key does; one that must wait does it later ([`App::resume`]).
    pub fn key(&mut self, key: &KeyEvent, view: Option<&View>) -> Option<Effect> {
        let awaited = self.awaits_all();
        match keys::name(key)?.as_str() {
            "Ctrl-z" => Some(Effect::Suspend),
            "Ctrl-l" => Some(Effect::Redraw),
            "Ctrl-c" => self.interrupt(view),
            _ if awaited.is_some() || self.ahead.is_any() => {
                self.ahead.push(Typed::Key(*key), awaited);
                None
            }
            _ => self.take_key(key, view),
        }
    }

    /// Does what a key means now. What was said before is over then.
    pub(super) fn take_key(&mut self, key: &KeyEvent, view: Option<&View>) -> Option<Effect> {
        let name = keys::name(key)?;
        self.note_reading(view);
        self.say("");
        self.notice = None;
        match &mut self.overlay {
            Overlay::None => self.pane_key(&name, view),
            Overlay::Help(_) => self.help_key(&name, view),
            Overlay::Manual(reader) => {
                if !reader.key(&name) {
                    self.close(view);
                }
                None
            }
            Overlay::Chooser(_) => self.chooser_key(&name, view),
            Overlay::Chart(_) => self.chart_key(&name, view),
            Overlay::Solver(_) => self.solver_key(&name, view),
            Overlay::Line(_) => self.line_key(key, &name, view),
            Overlay::Mode => self.mode_key(&name, view),
            Overlay::Answer => self.answer_key(&name, view),
        }
    }

    /// Text pasted from the terminal goes into a line that is being typed, and nowhere else: keys do things.
    pub fn paste(&mut self, text: &str) {
        match self.ahead.is_any() {
            true => self.ahead.push(Typed::Paste(text.into()), None),
            false => self.take_paste(text),
        }
    }

    pub(super) fn take_paste(&mut self, text: &str) {
        match &mut self.overlay {
            Overlay::Line(line) => line.insert(text),
            Overlay::Chooser(chooser) => chooser.type_text(&shown::line(text.trim())),
            _ => {}
        }
    }

    /// What actions need to know to read their arguments.
    pub(super) fn context<'a>(
        &'a self,
        view: Option<&View<'a>>,
        scenes: &'a [String],
    ) -> Context<'a> {
        Context {
            keymap: Some(&self.keymap),
            ..context(view, self.selected, scenes)
        }
    }

    /// Other colours, unless the environment wants none.
    fn colour(&mut self, colours: Option<Colours>) {
        let overruled = theme::wants_no_colour();
        if let Some(colours) = colours {
            self.colours = colours;
            self.theme = Theme::chosen(colours);
        }
        match overruled && self.colours != Colours::None {
            true => self.complain("NO_COLOR is set in the environment, and wins: no colours"),
            false => self.say(format!("colours: {}", self.colours.word())),
        }
    }

    /// Names of the built-in scenes.
    pub(super) fn scenes(&self) -> Vec<String> {
        let own = self.offers.iter().filter(|offer| offer.is_scene());
        own.map(|offer| offer.name.clone()).collect()
    }

    /// Ctrl-C: closes what is open and stops a run; never the program.
    fn interrupt(&mut self, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        let waited = self.ahead.is_any();
        self.ahead.forget();
        let trying = |view: &View| {
            view.background
                .is_some_and(|background| background.is_trying() || background.is_examining())
        };
        let works = view.is_some_and(|view| view.running || trying(view));
        if works || self.measuring.is_some() || self.loading.is_some() {
            return Some(Effect::Interrupt);
        }
        self.say(match waited {
            true => "what was typed ahead is forgotten",
            false => "nothing is running; q quits",
        });
        None
    }

    /// Closes overlays; without a scene the chooser is what is left.
    pub(super) fn close(&mut self, view: Option<&View>) {
        self.count = None;
        match view {
            Some(_) => self.overlay = Overlay::None,
            None => self.choose(),
        }
    }

    pub(super) fn pane_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
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
        let Some(entry) = self.keymap.by_key(name) else {
            self.complain(format!("{name} does nothing here; ? lists the keys"));
            return None;
        };
        let rest = count
            .filter(|_| entry.takes_count())
            .map(|count| count.to_string());
        let action = entry.act(&rest.unwrap_or_default(), &self.context(view, &[]));
        if let Some(awaited) = action.as_ref().ok().and_then(|a| self.awaits(a, view)) {
            self.put_off_key(name, count, awaited);
            return None;
        }
        self.attempt(action, count, view)
    }

    /// Carries out an action, or says why it cannot be.
    pub(super) fn attempt(
        &mut self,
        action: Result<Action, Misread>,
        count: Option<u32>,
        view: Option<&View>,
    ) -> Option<Effect> {
        let action = match action {
            Ok(action) => action,
            Err(why) => {
                self.complain(why);
                return None;
            }
        };
        if let Err(why) = action.offered(&self.context(view, &[])) {
            self.complain(why);
            return None;
        }
        match (self.permits(&action, view), action) {
            (Ok(_), Action::Session(command)) => self.submit(command, view),
            (Ok(wanted), Action::Ui(ui)) => {
                let effect = self.ui(ui, count, view);
                if let (true, Some(tutor), Some(view)) = (wanted, &mut self.lesson, view) {
                    tutor.settled(view.cursor, view.frame());
                    // What the lesson waited for is no error any more.
                    if self.message.tone == Tone::Error {
                        self.say("");
                    }
                }
                effect
            }
            (Err(why), _) => {
                self.complain(why);
                None
            }
        }
    }

    pub(super) fn submit(&mut self, command: Command, view: Option<&View>) -> Option<Effect> {
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
            Ui::Repeat if self.focus == Pane::Remedies => return self.take_remedy(view),
            Ui::Repeat if self.focus == Pane::Diagnosis => return self.take_answer(view),
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
            Ui::Reread => self.reread(),
            Ui::Answer(word) => self.answer(&word, view),
            Ui::Predict(whose) => self.predict(whose, view),
            Ui::Ask(question) => self.ask(question, view),
            Ui::CommandLine => self.overlay = Overlay::Line(CommandLine::new(Purpose::Command, "")),
            Ui::Log => {
                let finished = view.is_some_and(|view| view.model.finished.is_some());
                let page = match finished {
                    true => solver::Page::Run,
                    false => solver::Page::Log,
                };
                self.overlay = Overlay::Solver(solver::Reader::new(page));
            }
            Ui::Parameters => {
                self.overlay = Overlay::Solver(solver::Reader::new(solver::Page::Parameters));
            }
            Ui::Help => self.overlay = Overlay::Help(Help::new(Listing::Actions)),
            Ui::Keys => self.overlay = Overlay::Help(Help::new(Listing::Keys)),
            Ui::Copy(what) => return self.copy(what, view),
            Ui::Colours(colours) => self.colour(colours),
            Ui::Mouse(on) => {
                self.mouse = on.unwrap_or(!self.mouse);
                self.say(match self.mouse {
                    true => "the mouse selects and scrolls; :mouse off leaves it to the terminal",
                    false => "the mouse is the terminal's; :mouse on takes it back",
                });
                return Some(Effect::Mouse(self.mouse));
            }
            Ui::Manual(page) => self.overlay = Overlay::Manual(manual::Reader::new(page)),
            Ui::Cancel => {
                self.zoomed = false;
                self.say("");
            }
        }
        None
    }
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
