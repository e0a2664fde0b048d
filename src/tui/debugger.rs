//! The debugger without its terminal: an [`App`], a session, and the queue of keys that wait for the solver. Keys in, screens out.

use crate::app::{App, Effect, LoadTarget, Overlay, TURN};
use crate::chartpage::ChartPage;
use crate::chooser_state::{self, Offer, PreviewLoader};
use crate::event::{Event, KeyEvent};
use crate::keys;
use crate::layout::Pane;
use crate::learning::Learning;
use crate::loading::{LoadedFile, Loading};
use crate::theme::Theme;
use crate::view::View;
use ratatui::layout::Rect;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Duration;
use stickslip_core::Status;
use stickslip_debugger::Refusal;
use stickslip_debugger::action::{self, ChartOf};
use stickslip_debugger::explain::report;
use stickslip_debugger::recorded::calculix::words::GREETING;
use stickslip_debugger::session::Reply;
use stickslip_debugger::teach::play;
use stickslip_debugger::teach::progress::{self, Progress, ProgressStore};
use stickslip_debugger::{Command, Lesson, Session, Tutor};
use stickslip_platform::clock::Instant;
use stickslip_platform::task;
use stickslip_scene::{gaps, shown};
use stickslip_study::measuring::ChartMeasurement;

/// Steps shorter than this delay the next key instead of queueing it, so that the screen does not flicker.
const QUICK: Duration = Duration::from_millis(30);

/// The entries of the chooser, with the progress in the lessons.
pub fn offers() -> Vec<Offer> {
    let progress = progress::place().and_then(|file| Progress::read(&file).ok());
    chooser_state::offers(&progress.unwrap_or_default())
}

/// A request that only the event loop can carry out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TerminalRequest {
    /// Quit.
    Quit,
    /// Suspend the program.
    Suspend,
    /// Redraw the whole screen.
    Redraw,
    /// Copy a text to the terminal's clipboard.
    Copy(String),
    /// Turn mouse support on or off.
    Mouse(bool),
}

/// The debugger without its terminal.
pub struct Debugger {
    /// The state of the terminal front end.
    pub app: App,
    /// The session; `None` until a scene is opened.
    pub session: Option<Session>,
    /// Requests to the event loop from queued keys.
    outside: VecDeque<TerminalRequest>,
    /// Whether the program ends when the requested files are written.
    leaves: bool,
    /// Start time of the current computation.
    begun: Instant,
    /// Number of frames in the session at the last draw.
    frames: usize,
    /// Whether scenes opened here get a journal.
    pub keeps: bool,
    /// The chart that is being measured.
    measuring: Option<ChartMeasurement>,
    /// The file that is being loaded.
    loading: Option<Loading>,
    /// The preview that is being loaded.
    looking: PreviewLoader,
    /// Stores the progress in lessons.
    progress: ProgressStore,
    /// When the lesson was started, less the time that earlier sessions spent on it.
    taught: Instant,
    /// Whether the chooser's entries are listed again, with the files of the folder, each time it opens.
    lists: bool,
}

impl Debugger {
    /// A debugger for a session, or one that opens the chooser.
    pub fn new(theme: Theme, offers: Vec<Offer>, session: Option<Session>) -> Self {
        let mut app = App::new(theme, offers);
        match &session {
            Some(session) => greet(&mut app, session),
            None => app.choose(),
        }
        Debugger {
            app,
            session,
            outside: VecDeque::new(),
            leaves: false,
            begun: Instant::now(),
            frames: 0,
            keeps: false,
            measuring: None,
            loading: None,
            looking: PreviewLoader::default(),
            progress: ProgressStore::default(),
            taught: Instant::now(),
            lists: false,
        }
    }

    /// From now on stores the progress in lessons, and lists the files of the folder in the chooser.
    pub fn use_user_files(&mut self) {
        self.progress = ProgressStore::new(progress::place());
        self.lists = true;
    }

    /// Stores the progress in lessons in this file.
    pub fn keep_progress_in(&mut self, file: PathBuf) {
        self.progress = ProgressStore::new(Some(file));
    }

    fn keep_progress(&mut self) {
        let kept = self
            .app
            .learning
            .lesson
            .as_ref()
            .map(|tutor| self.progress.follow(tutor));
        if let Some(Err(why)) = kept {
            self.app.complain(why);
        }
    }

    /// Follows the preview of the selected entry. Returns whether there is anything new to draw.
    fn preview(&mut self) -> bool {
        let chooser = match &self.app.overlay {
            Overlay::Chooser(chooser) => Some(chooser),
            _ => None,
        };
        let known = self.app.preview.as_ref();
        let found = self.looking.follow(chooser, &self.app.offers, known);
        let any = found.is_some();
        self.app.preview = found.or(self.app.preview.take());
        any
    }

    /// The data that the panes draw.
    pub fn view(&self) -> Option<View<'_>> {
        self.session.as_ref().map(View::new)
    }

    /// The next request of queued input to the event loop.
    pub fn take_request(&mut self) -> Option<TerminalRequest> {
        self.outside.pop_front()
    }

    /// Whether anything is computed or loaded whose result will change the screen.
    pub fn is_working(&self) -> bool {
        self.is_busy() || self.loading.is_some() || self.looking.is_busy()
    }

    /// Whether the solver is running.
    pub fn is_busy(&self) -> bool {
        self.session.as_ref().is_some_and(Session::is_running)
    }

    /// Handles an event from the terminal.
    pub fn event(&mut self, event: &Event) -> Option<TerminalRequest> {
        match event {
            Event::Key(key) => {
                let mut last = None;
                for key in keys::apart(key) {
                    last = self.key(&key).or(last);
                }
                last
            }
            Event::Paste(text) => {
                self.app.paste(text);
                None
            }
            Event::Mouse(mouse) if self.app.mouse => {
                let view = self.session.as_ref().map(View::new);
                let effect = self.app.mouse(mouse, view.as_ref())?;
                self.carry_out(effect)
            }
            Event::Mouse(_) => None,
        }
    }

    /// Handles a key.
    pub fn key(&mut self, key: &KeyEvent) -> Option<TerminalRequest> {
        let view = self.session.as_ref().map(View::new);
        let chose = matches!(self.app.overlay, Overlay::Chooser(_));
        if let Some(tutor) = &mut self.app.learning.lesson {
            tutor.set_clock(
                self.taught
                    .elapsed()
                    .as_secs()
                    .try_into()
                    .unwrap_or(u32::MAX),
            );
        }
        let effect = self.app.key(key, view.as_ref());
        self.keep_progress();
        if self.lists && !chose && matches!(self.app.overlay, Overlay::Chooser(_)) {
            self.app.offers = offers();
        }
        self.carry_out(effect?)
    }

    /// Carries out an effect, unless only the event loop can.
    pub fn carry_out(&mut self, effect: Effect) -> Option<TerminalRequest> {
        match effect {
            Effect::Quit if self.is_exporting() && !self.leaves => {
                self.leaves = true;
                let wait = "leaving when the file is written; again: now, without the file";
                self.app.say(wait);
            }
            Effect::Quit => return Some(TerminalRequest::Quit),
            Effect::Suspend => return Some(TerminalRequest::Suspend),
            Effect::Redraw => return Some(TerminalRequest::Redraw),
            Effect::Copy(text) => return Some(TerminalRequest::Copy(text)),
            Effect::Mouse(on) => return Some(TerminalRequest::Mouse(on)),
            Effect::Submit(command) => self.submit(command),
            Effect::Interrupt => self.interrupt(),
            Effect::Open(scene) => self.load(Loading::scene(&scene), LoadTarget::Scene, &scene),
            Effect::Chart(of) => self.chart(of),
            Effect::Lesson(name) => {
                let loading = Loading::lesson(&name, self.progress.clone());
                self.load(loading, LoadTarget::Scene, &name);
            }
        }
        None
    }

    /// Handles queued input that need not wait any longer. Returns whether there was any.
    fn resume(&mut self) -> bool {
        let mut any = false;
        while !self.is_busy() {
            let view = self.session.as_ref().map(View::new);
            let Some(effect) = self.app.resume(view.as_ref()) else {
                break;
            };
            any = true;
            let outside = effect.and_then(|effect| self.carry_out(effect));
            if let Some(outside) = outside {
                self.outside.push_back(outside);
                break;
            }
        }
        any
    }

    fn load(&mut self, loading: Loading, opens: LoadTarget, name: &str) {
        self.loading = Some(loading);
        self.app.loading = Some(opens);
        self.app.say(format!("loading {name}; Ctrl-C cancels"));
    }

    /// Shows a loaded file, once no overlay but the chooser is open. Returns whether anything changed.
    fn follow_loading(&mut self) -> bool {
        if !self.app.overlay.is_open_to_pages() {
            return false;
        }
        let Some(loaded) = self.loading.as_ref().and_then(Loading::result) else {
            return false;
        };
        (self.loading, self.app.loading) = (None, None);
        match loaded {
            Ok(LoadedFile::Scene(session)) => self.open(*session),
            Ok(LoadedFile::Lesson(taught)) => self.take_lesson(taught.0, taught.1),
            Ok(LoadedFile::Chart(page)) => {
                self.app.say("");
                self.app.overlay = Overlay::Chart(page);
            }
            Err(why) => self.app.complain(why),
        }
        true
    }

    /// Types keys ([`keys::presses`]; nothing if they are wrong), and waits for the solver after each. For tests and pictures.
    pub fn type_keys(&mut self, names: &str) {
        for key in keys::presses(names).unwrap_or_default() {
            self.key(&key);
            self.settle();
        }
    }

    /// Types a text letter by letter.
    pub fn type_text(&mut self, text: &str) {
        for letter in text.chars() {
            if let Some(key) = keys::press(&letter.to_string()) {
                self.key(&key);
            }
        }
    }

    /// Waits until the solver is idle and the queue is empty.
    pub fn settle(&mut self) {
        loop {
            let moved = self.advance();
            if self.is_busy() {
                if let Some(reply) = self.session.as_mut().and_then(Session::wait) {
                    self.ended(reply);
                }
                continue;
            }
            let open = self.app.overlay.is_open_to_pages();
            // Behind another page these would never finish.
            if open && (self.loading.is_some() || self.measuring.is_some()) {
                task::nap(Duration::from_millis(1));
                continue;
            }
            while self.looking.is_busy() {
                task::nap(Duration::from_millis(1));
                self.advance();
            }
            match &mut self.session {
                Some(session) if session.background().is_busy() => session.background_mut().wait(),
                _ if moved && self.app.ahead.is_any() => {}
                _ => return,
            }
        }
    }

    /// The screen as plain text.
    pub fn text(&self, width: u16, height: u16) -> String {
        crate::screen::text(&self.app, self.view().as_ref(), width, height)
    }

    fn submit(&mut self, command: Command) {
        let Some(session) = &mut self.session else {
            return;
        };
        self.begun = Instant::now();
        // The page itself shows that the analysis is running.
        let shown = match command {
            Command::Census(_) => self.app.panes.focus == Pane::Diagnosis,
            Command::Remedies => self.app.panes.focus == Pane::Remedies,
            _ => false,
        };
        match session.submit(command) {
            Ok(_) if shown => {}
            Ok(reply) => self.tell(reply),
            Err(message) => {
                self.app.learning.fail();
                self.app.complain(message);
            }
        }
    }

    /// Shows the result of a job. The loss of an attached solver is shown until the next key, and queued input is discarded, since
    /// it would restart the solver.
    fn ended(&mut self, reply: Reply) {
        let lost = self
            .session
            .as_ref()
            .is_some_and(|session| session.connection().lost().is_some());
        if lost {
            self.app.ahead.forget();
            self.app.learning.fail();
            self.app.say("");
            self.app.notice = Some(shown::line(&reply.0).into_owned());
            return;
        }
        self.tell(reply);
    }

    /// Takes notice of new lines in an attached solver's log. Returns whether there were any.
    fn hear(&mut self) -> bool {
        let Some(log) = self.session.as_ref().and_then(|s| s.connection().log()) else {
            return false;
        };
        let (any, text) = self.app.log_counts.count(log);
        if let Some(text) = text
            && self.app.notice.is_none()
        {
            self.app.notice = Some(text);
        }
        any
    }

    /// Shows the reply to a command, unless the status at the top already shows it.
    fn tell(&mut self, Reply(text): Reply) {
        let known = self.session.as_ref().and_then(|session| {
            match (session.is_running(), &session.frame().event) {
                // The status line shows which iterations the solver repeats.
                (true, _) => Some(text.clone()),
                (false, Some(event)) => Some(report::outcome(session.model(), event)),
                (false, None) => None,
            }
        });
        // The message must not reveal what the user still has to predict.
        let view = self.session.as_ref().map(View::new);
        let hidden = view.is_some_and(|view| !view.running && self.app.learning.hides_any(&view));
        // The status line already shows the outcome.
        let new = match &known {
            Some(known) => text.strip_prefix(known.as_str()).unwrap_or(&text),
            None => &text,
        };
        let new = new.trim_start_matches("; ").to_owned();
        let said = match (hidden, new.is_empty()) {
            (true, _) => String::new(),
            (false, true) => self.next_step(),
            (false, false) => new,
        };
        let idle = self
            .session
            .as_ref()
            .filter(|session| !session.is_running());
        if let (Some(tutor), Some(session)) = (&mut self.app.learning.lesson, idle) {
            tutor.settled(session.shown_frames());
        }
        self.keep_progress();
        self.app.say(said);
    }

    /// Which keys explain a failure; empty if there is no failure.
    fn next_step(&self) -> String {
        let idle = self
            .session
            .as_ref()
            .filter(|session| !session.is_running());
        let failed = |session: &Session| {
            let failed = matches!(session.frame().state.status, Status::Failed(_));
            failed && session.model().finished.is_none()
        };
        if !idle.is_some_and(failed) {
            return String::new();
        }
        let key = |action: &str| {
            let entry = action::by_name(action).ok();
            let key = entry.and_then(|entry| self.app.keymap.keys(entry).next());
            key.map_or(format!(":{action}"), ToString::to_string)
        };
        let (cause, remedies) = (key("diagnosis"), key("remedies"));
        format!("Press {cause} for the cause, {remedies} to try remedies")
    }

    fn chart(&mut self, of: ChartOf) {
        let over = match of {
            ChartOf::File(file) => {
                return self.load(Loading::chart(&file), LoadTarget::Page, &file);
            }
            ChartOf::Scene => Vec::new(),
            ChartOf::Settings(over) => over,
        };
        let Some(session) = &self.session else {
            return self
                .app
                .complain("no scene to measure; open one with :open");
        };
        let measuring = ChartMeasurement::start(session.scene(), over);
        self.app.measuring = Some(measuring.progress());
        self.measuring = Some(measuring);
        self.app
            .say("measuring in the background; the chart opens when it is ready (Ctrl-C stops it)");
    }

    /// Follows a chart that is being measured, and shows it once no overlay is open. Returns whether there is anything new to draw.
    fn follow_chart(&mut self) -> bool {
        let Some(measuring) = &self.measuring else {
            return false;
        };
        let progress = Some(measuring.progress());
        let grown = std::mem::replace(&mut self.app.measuring, progress) != progress;
        if !matches!(self.app.overlay, Overlay::None) {
            return grown;
        }
        let Some(result) = measuring.result() else {
            return grown;
        };
        (self.measuring, self.app.measuring) = (None, None);
        self.leaves = false;
        self.app.say("");
        let result = result.map_err(Refusal::new);
        match result.and_then(ChartPage::from_chart) {
            Ok(page) => self.app.overlay = Overlay::Chart(Box::new(page)),
            Err(error) => self.app.complain(error),
        }
        true
    }

    fn interrupt(&mut self) {
        self.app.loading = None;
        if self.loading.take().is_some() {
            return self.app.say("loading cancelled");
        }
        if let Some(measuring) = &self.measuring {
            measuring.interrupt();
        }
        self.app.learning.fail();
        if let Some(session) = &self.session {
            session.interrupt();
            session.background().interrupt();
            self.app.say(match (&self.measuring, session.is_running()) {
                (Some(_), false) => "stopping the chart",
                _ => "stopping after this minor iteration",
            });
        }
    }

    /// Continues with another session.
    pub fn open(&mut self, mut session: Session) {
        let resumed = session.journal().path().is_some();
        // A resumed journal continues on its own.
        if self.keeps && !resumed && session.connection().capabilities().past.is_none() {
            session.journal_mut().write_to_default_path();
        }
        self.app.opened();
        if resumed {
            self.app.say("resumed from its journal, which continues")
        } else {
            greet(&mut self.app, &session)
        }
        self.replace_session(session);
    }

    fn replace_session(&mut self, session: Session) {
        self.session = Some(session);
        (self.measuring, self.app.measuring) = (None, None);
    }

    /// Starts a lesson at a step (from 0), or else where the user left it.
    pub fn teach(&mut self, lesson: Lesson, step: Option<usize>) {
        let (tutor, session) = play::begin(lesson, step, &self.progress);
        self.take_lesson(tutor, session);
    }

    fn take_lesson(&mut self, tutor: Tutor, session: Session) {
        let step = tutor.at() + 1;
        let message = match step {
            1 => String::new(),
            _ => {
                let name = &tutor.lesson().name;
                format!("the lesson continues at step {step}; :lesson {name}@1 starts it again")
            }
        };
        let before = Duration::from_secs(tutor.clock().into());
        self.taught = Instant::now().checked_sub(before).unwrap_or(self.taught);
        self.app.opened();
        self.app.learning = Learning::new(tutor);
        self.replace_session(session);
        self.app.say(message);
    }

    fn is_exporting(&self) -> bool {
        let session = self.session.as_ref();
        session.is_some_and(|session| session.background().is_exporting())
    }

    /// Whether the solver has results that have not been collected.
    pub fn is_behind(&self) -> bool {
        self.session.as_ref().is_some_and(Session::is_behind)
    }

    /// Collects results of the solver and handles the input that waited for them. Returns whether there is anything new to draw.
    pub fn advance(&mut self) -> bool {
        let gathered = self.gather();
        let resumed = self.resume();
        let idle = !self.is_busy() && !self.app.ahead.is_any();
        let looked = idle && self.look();
        gathered | resumed | looked
    }

    fn gather(&mut self) -> bool {
        let measured = self.follow_loading() | self.follow_chart() | self.preview();
        self.keep_progress();
        let Some(session) = &mut self.session else {
            return measured;
        };
        let was_busy = session.is_running();
        self.app.unkept = session.journal().lost().is_some();
        let seen = session.background_mut().gather();
        if let Some(exported) = session.background_mut().exported() {
            self.leaves &= exported.is_ok();
            self.app.report(exported);
            if self.leaves && !session.background().is_exporting() {
                self.outside.push_back(TerminalRequest::Quit);
            }
        }
        let reply = session.poll();
        let said = reply.is_some();
        if let Some(reply) = reply {
            self.ended(reply);
        }
        let heard = self.hear();
        let Some(session) = &self.session else {
            return said;
        };
        let (frames, busy) = (session.frames().len(), session.is_running());
        let grown = frames != std::mem::replace(&mut self.frames, frames);
        let turns = if busy {
            self.begun.elapsed().as_millis() / TURN.as_millis()
        } else {
            0
        };
        let elapsed = TURN * turns as u32;
        let turned = elapsed != std::mem::replace(&mut self.app.busy, elapsed);
        let panicked = task::take_panic();
        let failed = panicked.is_some();
        if let Some(message) = panicked {
            self.app.complain(format!(
                "internal error in the solver, please report it: {message}"
            ));
        }
        measured || heard || seen || said || grown || turned || failed || was_busy != busy
    }

    /// Requests background analyses that the panes need for the shown iteration and the selected node. Returns whether any was
    /// requested.
    fn look(&mut self) -> bool {
        let Some(session) = &mut self.session else {
            return false;
        };
        let before = session.background().is_busy();
        if matches!(self.app.panes.focus, Pane::Decision | Pane::Contact) {
            session.demand_pushes();
        }
        session.look(self.app.selected);
        session.background().is_busy() != before
    }

    /// Waits briefly for quick steps, so that fast typing is not queued.
    pub fn breathe(&mut self) {
        let entered = Instant::now();
        let quick = |debugger: &Debugger| {
            let solves = debugger.is_busy() && debugger.begun.elapsed() < QUICK;
            solves || debugger.loading.is_some() && entered.elapsed() < QUICK
        };
        while quick(self) {
            task::nap(Duration::from_micros(500));
            self.advance();
        }
    }
}

/// The screen after some keys, as plain text. Keys are named as in the key table and separated by blanks; each one waits for the
/// solver.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn screen(scene: &str, keys: &str, width: u16, height: u16) -> Result<String, String> {
    let debugger = after_keys(Some(scene), keys, (width, height), Theme::mono())?;
    Ok(debugger.text(width, height))
}

/// The debugger on a scene, or on the chooser, after some keys, which must be valid ([`keys::presses`]).
///
/// # Errors
/// If the scene cannot be loaded, or a key is unknown.
pub fn after_keys(
    scene: Option<&str>,
    keys: &str,
    (width, height): (u16, u16),
    theme: Theme,
) -> Result<Debugger, String> {
    keys::presses(keys).map_err(|word| format!("unknown key '{word}' (`stickslip help keys`)"))?;
    let session = scene.map(Session::open).transpose()?;
    let offers = chooser_state::offers(&Progress::default());
    let mut debugger = Debugger::new(theme, offers, session);
    debugger.app.area = Rect::new(0, 0, width, height);
    debugger.settle();
    debugger.type_keys(keys);
    debugger.settle();
    Ok(debugger)
}

/// The first message after opening a scene: warnings about its start, or the first key to press.
fn greet(app: &mut App, session: &Session) {
    if session.model().finished.is_some() {
        (app.panes.page, app.panes.chart) = (Pane::Timeline, Pane::Timeline);
        return app.say(GREETING);
    }
    match &gaps::warnings(session.model())[..] {
        [] => app.say("Press s for one minor iteration, ? for all keys"),
        [doubt] => app.complain(doubt),
        [doubt, others @ ..] => app.complain(format!(
            "{doubt} (and {} more: `stickslip check {}` lists all)",
            others.len(),
            session.scene().name
        )),
    }
}
