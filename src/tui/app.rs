//! The state of the terminal front end and how keys change it, without drawing and without the session: a key changes the [`App`]
//! and returns at most one [`Effect`] for the event loop to carry out.

use crate::camera::Camera;
use crate::chartpage::ChartPage;
use crate::chooser_state::{Chooser, Offer, Preview};
use crate::commandline::{CommandLine, Purpose};
use crate::event::KeyEvent;
use crate::input_queue::{Ahead, QueuedInput};
use crate::keys;
use crate::layout::{Pane, ShownPanes};
use crate::learning::Learning;
use crate::log_counts::LogCounts;
use crate::shape_lines::ShapeLines;
use crate::textpage::{PageText, TextPage};
use crate::theme::{self, Theme};
use crate::view::{View, context};
use ratatui::layout::Rect;
use std::cell::RefCell;
use std::fmt;
use std::time::Duration;
use stickslip_debugger::Refusal;
use stickslip_debugger::action::{Action, ChartOf, Context, Filter, Keymap, Sort, Ui};
use stickslip_debugger::explain::facts::Part;
use stickslip_debugger::{Colours, Command, Tutor};
use stickslip_scene::shown;

/// Rows that PageUp and PageDown move by.
pub(super) const PAGE: isize = 10;

/// A request to the event loop.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// A command for the session.
    Submit(Command),
    /// Stop the run.
    Interrupt,
    /// Load a scene, by file or built-in name.
    Open(String),
    /// Start a lesson, by file or built-in name.
    Lesson(String),
    /// Show a work-precision chart.
    Chart(ChartOf),
    /// Copy a text to the terminal's clipboard.
    Copy(String),
    /// Turn mouse support on or off.
    Mouse(bool),
    /// Suspend the program.
    Suspend,
    /// Redraw the whole screen.
    Redraw,
    /// Quit.
    Quit,
}

/// A page or prompt over the panes, which receives keys before they do.
#[derive(Debug, Clone)]
pub enum Overlay {
    /// No overlay.
    None,
    /// A page of text.
    Text(TextPage),
    /// The list of what can be opened.
    Chooser(Chooser),
    /// A work-precision chart.
    Chart(Box<ChartPage>),
    /// A line being typed.
    Line(CommandLine),
    /// Waits for the mode of the selected node.
    Mode,
    /// Waits for a letter or digit that answers a question.
    Answer,
}

impl Overlay {
    /// A line to type, with an initial text.
    pub(super) fn line(purpose: Purpose, text: &str) -> Overlay {
        Overlay::Line(CommandLine::new(purpose, text))
    }

    fn text(text: PageText) -> Overlay {
        Overlay::Text(TextPage::new(text))
    }

    /// Whether a page that finishes loading may be shown: no overlay is open except the chooser.
    pub fn is_open_to_pages(&self) -> bool {
        matches!(self, Overlay::None | Overlay::Chooser(_))
    }
}

/// The kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Information.
    Plain,
    /// An error.
    Error,
}

/// The last message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// The text, on one line.
    pub text: String,
    /// Its kind.
    pub tone: Tone,
}

/// What a file that is being loaded will show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadTarget {
    /// Another scene, with or without a lesson.
    Scene,
    /// A page over the panes.
    Page,
}

/// All state of the screen that is not in the session.
#[derive(Debug, Clone)]
pub struct App {
    /// Colours and weights.
    pub theme: Theme,
    /// The key bindings.
    pub keymap: Keymap,
    /// The chosen colours, which the environment can override.
    pub colours: Colours,
    /// Whether the colours follow the terminal's background.
    pub finds_colours: bool,
    /// Whether mouse support is on.
    pub mouse: bool,
    /// Whether pictures consist of octants instead of braille.
    pub octants: bool,
    /// Whether that depends on the terminal.
    pub finds_octants: bool,
    /// The area of the last draw.
    pub area: Rect,
    /// The page or prompt over the panes.
    pub overlay: Overlay,
    /// The panes that the user looks at.
    pub panes: ShownPanes,
    /// Selected slave node, by slave number.
    pub selected: usize,
    /// The count typed before a motion.
    pub count: Option<u32>,
    /// What was said last.
    pub message: Message,
    /// A message about the attached solver or its loss, shown until the next key.
    pub notice: Option<String>,
    /// How much of the attached solver's log has been counted.
    pub log_counts: LogCounts,
    /// Pan and zoom of the shape, and its lines.
    pub camera: Camera,
    pub(crate) lines: RefCell<Option<ShapeLines>>,
    /// Index of the first picture of the contact; it wraps around.
    pub turned: usize,
    /// Sort key of the table.
    pub sort: Sort,
    /// Whether the sort order is reversed.
    pub backward: bool,
    /// Which nodes the table shows.
    pub filter: Filter,
    /// Monitor of the load-displacement curve.
    pub monitor: Option<usize>,
    /// The selected line of Try or consistent state in the diagnosis, from 0; behind them, the headings of the parts below.
    pub answer: usize,
    /// The parts of the diagnosis of which only the heading is shown.
    pub folded: Vec<Part>,
    /// The selected row of the branch tree, from 0.
    pub branch: usize,
    /// The selected remedy, from 0.
    pub remedy: usize,
    /// The first visible line of the diagnosis, from 0.
    pub scroll: usize,
    /// The scenes, lessons and files in the chooser.
    pub offers: Vec<Offer>,
    /// The preview of the chooser's selection.
    pub preview: Option<Preview>,
    /// The current lesson, and prediction mode.
    pub learning: Learning,
    /// Increments done and in total of the chart that is being measured.
    pub measuring: Option<(u64, u64)>,
    /// What the file that is being loaded will show.
    pub loading: Option<LoadTarget>,
    /// The type-ahead queue.
    pub ahead: Ahead,
    /// Whether the journal was lost.
    pub unkept: bool,
    /// Duration of the current computation, in steps of [`TURN`].
    pub busy: Duration,
    /// The last motion, which Enter repeats.
    pub(super) last: Option<Command>,
    /// Lines entered at `:`, oldest first.
    pub(super) history: Vec<String>,
    /// The last text that `/` searched for.
    pub(super) sought: String,
}

/// Largest count that can be typed.
const MOST: u32 = 1_000_000;
/// Time between two pictures of the spinner.
pub const TURN: Duration = Duration::from_millis(250);

impl App {
    /// A new screen; without a scene it shows the chooser first.
    pub fn new(theme: Theme, offers: Vec<Offer>) -> Self {
        App {
            theme,
            keymap: Keymap::default(),
            colours: Colours::default(),
            finds_colours: false,
            mouse: true,
            octants: false,
            finds_octants: false,
            area: Rect::new(0, 0, 80, 24),
            overlay: Overlay::None,
            panes: ShownPanes::default(),
            selected: 0,
            count: None,
            message: Message {
                text: String::new(),
                tone: Tone::Plain,
            },
            notice: None,
            log_counts: LogCounts::default(),
            camera: Camera::ALL,
            lines: RefCell::default(),
            turned: 0,
            sort: Sort::Scene,
            backward: false,
            filter: Filter::All,
            monitor: None,
            answer: 0,
            folded: Vec::new(),
            branch: 0,
            remedy: 0,
            scroll: 0,
            offers,
            preview: None,
            learning: Learning::default(),
            measuring: None,
            loading: None,
            ahead: Ahead::default(),
            unkept: false,
            busy: Duration::ZERO,
            last: None,
            history: Vec::new(),
            sought: String::new(),
        }
    }

    /// Shows a message.
    pub fn say(&mut self, text: impl Into<String>) {
        self.show(text.into(), Tone::Plain);
    }

    /// Shows an error.
    pub fn complain(&mut self, text: impl fmt::Display) {
        self.show(text.to_string(), Tone::Error);
    }

    /// Shows a result or an error.
    pub(super) fn report(&mut self, result: Result<String, impl fmt::Display>) {
        match result {
            Ok(text) => self.say(text),
            Err(why) => self.complain(why),
        }
    }

    fn show(&mut self, text: String, tone: Tone) {
        let text = shown::line(&text.replace('\n', " ")).into_owned();
        self.message = Message { text, tone };
    }

    /// Resets the screen for a scene that was just opened.
    pub fn opened(&mut self) {
        self.overlay = Overlay::None;
        self.panes = ShownPanes::default();
        self.selected = 0;
        self.monitor = None;
        (self.answer, self.branch, self.remedy, self.scroll) = (0, 0, 0, 0);
        self.camera = Camera::ALL;
        (self.notice, self.log_counts) = (None, LogCounts::default());
        self.last = None;
        self.count = None;
        self.learning = Learning::default();
    }

    /// Opens the chooser.
    pub fn choose(&mut self) {
        self.overlay = Overlay::Chooser(Chooser::default());
    }

    /// Handles a key, or queues it for [`App::resume`].
    pub fn key(&mut self, key: &KeyEvent, view: Option<&View>) -> Option<Effect> {
        let awaited = self.awaits_all();
        match keys::name(key)?.as_str() {
            "Ctrl-z" => Some(Effect::Suspend),
            "Ctrl-l" => Some(Effect::Redraw),
            "Ctrl-c" => self.interrupt(view),
            _ if awaited.is_some() || self.ahead.is_any() => {
                self.ahead.push(QueuedInput::Key(*key), awaited);
                None
            }
            _ => self.take_key(key, view),
        }
    }

    /// Handles a key now; this clears the previous message.
    pub(super) fn take_key(&mut self, key: &KeyEvent, view: Option<&View>) -> Option<Effect> {
        let name = keys::name(key)?;
        let visible = self.lesson_lines(view);
        self.learning.note(visible);
        self.say("");
        self.notice = None;
        match &mut self.overlay {
            Overlay::None => self.pane_key(&name, view),
            Overlay::Chooser(_) => self.chooser_key(&name, view),
            Overlay::Text(_) | Overlay::Chart(_) => {
                self.page_key(&name, view);
                None
            }
            Overlay::Line(_) => self.line_key(key, &name, view),
            Overlay::Mode => self.mode_key(&name, view),
            Overlay::Answer => self.answer_key(&name, view),
        }
    }

    /// Text pasted from the terminal goes only into an open input line, since elsewhere keys are commands.
    pub fn paste(&mut self, text: &str) {
        if self.ahead.is_any() {
            self.ahead.push(QueuedInput::Paste(text.into()), None)
        } else {
            self.take_paste(text)
        }
    }

    pub(super) fn take_paste(&mut self, text: &str) {
        match &mut self.overlay {
            Overlay::Line(line) => line.insert(text),
            Overlay::Chooser(chooser) => chooser.type_text(&shown::line(text.trim())),
            _ => {}
        }
    }

    /// The context in which actions parse their arguments.
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

    /// Follows the terminal's background, unless the user has chosen colours.
    pub fn find_colours(&mut self, light: bool) {
        if self.finds_colours {
            self.colours = Colours::for_background(light);
            self.theme = Theme::chosen(self.colours);
        }
    }

    /// Changes the colours, unless the environment asks for none.
    fn colour(&mut self, colours: Option<Colours>) {
        let overruled = theme::wants_no_colour();
        if let Some(colours) = colours {
            (self.colours, self.finds_colours) = (colours, false);
            self.theme = Theme::chosen(colours);
        }
        if overruled && self.colours != Colours::None {
            self.complain("no colours: the environment sets NO_COLOR")
        } else {
            self.say(format!("colours: {}", self.colours.word()))
        }
    }

    /// Names of the built-in scenes.
    pub(super) fn scenes(&self) -> Vec<String> {
        self.offers
            .iter()
            .filter(|offer| offer.is_scene())
            .map(|offer| offer.name.clone())
            .collect()
    }

    /// Handles Ctrl-C: closes overlays and stops a run, but never quits the program.
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
        self.say(if waited {
            "queued keys discarded"
        } else {
            "nothing is running; q quits"
        });
        None
    }

    /// Closes overlays; without a scene this leaves the chooser.
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
            self.complain(format!("{name} is not bound here; ? lists the keys"));
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

    /// Carries out an action, or shows why it is not possible.
    pub(super) fn attempt(
        &mut self,
        action: Result<Action, Refusal>,
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
        let visible = self.lesson_lines(view);
        let permitted = view.map_or(Ok(false), |view| {
            self.learning.permits(&action, view, visible)
        });
        match (permitted, action) {
            (Ok(_), Action::Session(command)) => self.submit(command, view),
            (Ok(wanted), Action::Ui(ui)) => {
                let effect = self.ui(ui, count, view);
                if let (true, Some(tutor), Some(view)) = (wanted, &mut self.learning.lesson, view) {
                    tutor.settled(&view.frames[..=view.cursor]);
                    // The lesson asked for this action, so its failure is no error of the user.
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
            Ui::Repeat if self.learning.lesson.as_ref().is_some_and(Tutor::is_read) => {
                return self.continue_lesson(view);
            }
            Ui::Repeat if self.panes.focus == Pane::Branches => return self.go_to_branch(view),
            Ui::Repeat if self.panes.focus == Pane::Remedies => return self.take_remedy(view),
            Ui::Repeat if self.panes.focus == Pane::Diagnosis => return self.take_answer(view),
            Ui::Repeat => match self.last.clone() {
                Some(command) => return self.attempt(Ok(Action::Session(command)), None, view),
                None => self.complain("no motion to repeat yet; press s for one minor iteration"),
            },
            Ui::Move(step) => return self.step(step, count.unwrap_or(1) as isize, view),
            Ui::Select(slave) => self.selected = slave,
            Ui::NextPane => self.panes.turn(1),
            Ui::PreviousPane => self.panes.turn(Pane::ALL.len() - 1),
            Ui::Zoom => self.panes.zoomed = !self.panes.zoomed,
            Ui::Explain => self.panes.zoom(Pane::Decision),
            Ui::Page(page) => return self.page(page, view),
            Ui::StartFrom(number) => return self.start_from(number, view),
            Ui::Apply(number) => return self.apply(number, view),
            Ui::Enlarge => self.camera = self.camera.zoomed(1.25),
            Ui::Shrink => self.camera = self.camera.zoomed(0.8),
            Ui::Fit => {
                self.camera = Camera {
                    magnify: self.camera.magnify,
                    projection: self.camera.projection,
                    ..Camera::ALL
                }
            }
            Ui::View
                if view.is_some_and(|view| view.model.space.is_none() && !view.is_finished()) =>
            {
                self.complain("this scene is plane: it has one view");
            }
            Ui::View => self.camera.projection = self.camera.projection.next(),
            Ui::Magnify(None) => self.camera = self.camera.magnified_next(),
            Ui::Magnify(factor) => self.camera.magnify = factor,
            Ui::Sort(sort) => self.sort = sort.unwrap_or(next(&Sort::ALL, self.sort)),
            Ui::SortBackward => self.backward = !self.backward,
            Ui::Filter(filter) => self.filter = filter.unwrap_or(next(&Filter::ALL, self.filter)),
            Ui::Monitor(monitor) => self.watch(monitor, view),
            Ui::Chart(of) => return Some(Effect::Chart(of)),
            Ui::Lesson(lesson) => return Some(Effect::Lesson(lesson)),
            Ui::On => return self.continue_lesson(view),
            Ui::Hint => {
                let hint = self.learning.hint(self.lesson_lines(view));
                self.report(hint);
            }
            Ui::Reread => self.reread(),
            Ui::Answer(word) => self.answer(&word, view),
            Ui::Predict(whose) => self.predict(whose, view),
            Ui::Ask(question) => self.ask(question, view),
            Ui::CommandLine => self.overlay = Overlay::line(Purpose::Command, ""),
            Ui::Log => {
                let finished = view.is_some_and(View::is_finished);
                self.overlay = Overlay::text(if finished {
                    PageText::Run
                } else {
                    PageText::Log
                });
            }
            Ui::Parameters => self.overlay = Overlay::text(PageText::Parameters),
            Ui::Help => self.overlay = Overlay::text(PageText::Actions),
            Ui::Keys => self.overlay = Overlay::text(PageText::Keys),
            Ui::Copy(what) => return self.copy(what, view),
            Ui::Colours(colours) => self.colour(colours),
            Ui::Mouse(on) => {
                self.mouse = on.unwrap_or(!self.mouse);
                self.say(if self.mouse {
                    "mouse on: click selects, wheel scrolls; :mouse off turns it off"
                } else {
                    "mouse off; :mouse on turns it on"
                });
                return Some(Effect::Mouse(self.mouse));
            }
            Ui::Manual(page) => self.overlay = Overlay::text(PageText::Manual(page)),
            Ui::Cancel => {
                self.panes.zoomed = false;
                self.say("");
            }
        }
        None
    }
}

/// The element after `one`, cyclically.
fn next<T: Copy + PartialEq>(all: &[T], one: T) -> T {
    let at = all.iter().position(|other| *other == one);
    all[at.map_or(0, |at| (at + 1) % all.len())]
}

/// The digit that a key types.
fn digit(name: &str) -> Option<u32> {
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => letter.to_digit(10),
        _ => None,
    }
}
