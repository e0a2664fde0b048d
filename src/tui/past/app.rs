//! What a key does to the view of a run that is over. No drawing here.

use super::actions;
use crate::action::{Context, Entry, Keymap};
use crate::explain::past::run::Past;
use crate::explain::past::words;
use crate::manual::search::Search;
use crate::outside::shown;
use crate::tui::app::{Message, PAGE, Tone};
use crate::tui::commandline::{CommandLine, Purpose};
use crate::tui::debugger::Outside;
use crate::tui::keys;
use crate::tui::theme::Theme;
use crossterm::event::KeyEvent;
use stickslip_exchange::calculix::past::End;

/// A part of the screen that can have the focus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pane {
    /// Contacts by iterations.
    Timeline,
    /// Residual and correction over the iterations of this attempt.
    Residual,
    /// Who switched how often.
    Contacts,
    /// How the attempts ended.
    Attempts,
}

impl Pane {
    /// All, in the order of Tab.
    pub const ALL: [Pane; 4] = [
        Pane::Timeline,
        Pane::Residual,
        Pane::Contacts,
        Pane::Attempts,
    ];

    fn turn(self, places: usize) -> Pane {
        Pane::ALL[(self as usize + places) % Pane::ALL.len()]
    }
}

/// What lies over the panes.
#[derive(Debug, Clone)]
pub enum Overlay {
    /// Nothing.
    None,
    /// The list of actions: its first line that is shown, and what is looked for in it.
    Help(usize, Search),
    /// A line being typed.
    Line(CommandLine),
}

/// Everything on the screen.
#[derive(Debug, Clone)]
pub struct App {
    /// The run.
    pub past: Past,
    /// Colours and weights.
    pub theme: Theme,
    /// Which key does what.
    pub keymap: Keymap,
    /// The iteration that is looked at, by its position in the run.
    pub cursor: usize,
    /// The selected contact.
    pub selected: usize,
    /// Pane with the focus.
    pub focus: Pane,
    /// Pane under the timeline on a small screen.
    pub page: Pane,
    /// Whether the focused pane has the whole screen.
    pub zoomed: bool,
    /// Count typed before a motion.
    pub count: Option<usize>,
    /// What lies over the panes.
    pub overlay: Overlay,
    /// What was said last.
    pub message: Message,
    /// Lines of the help page as it was drawn last, to find a text in.
    help: Vec<String>,
    last: Option<&'static Entry>,
    sought: String,
    history: Vec<String>,
}

/// Largest count that digits can make.
const MOST: usize = 1_000_000;

impl App {
    /// At the first cycle, or else the first attempt that did not converge, or else the start.
    pub fn new(past: Past, theme: Theme, keymap: Keymap) -> App {
        let selected = past.chatter.first().map_or(0, |chatter| chatter.slave);
        let notes = words::notes(&past).join("; ");
        let mut app = App {
            past,
            theme,
            keymap,
            cursor: 0,
            selected,
            focus: Pane::Timeline,
            page: Pane::Residual,
            zoomed: false,
            count: None,
            overlay: Overlay::None,
            message: Message {
                text: shown::line(&notes).into_owned(),
                tone: Tone::Plain,
            },
            help: Vec::new(),
            last: None,
            sought: String::new(),
            history: Vec::new(),
        };
        if let Some(first) = app.trouble(0) {
            app.cursor = first;
        }
        app
    }

    /// The lines of the help page, so that one can look for a text in them.
    pub fn shows_help(&mut self, lines: Vec<String>) {
        self.help = lines;
    }

    /// Says something.
    fn say(&mut self, text: &str, tone: Tone) {
        let text = shown::line(text).into_owned();
        self.message = Message { text, tone };
    }

    /// Shows an error in the message line.
    pub(super) fn complain(&mut self, text: &str) {
        self.say(text, Tone::Error);
    }

    /// What a key does, and what it asks of the event loop.
    pub fn key(&mut self, key: &KeyEvent) -> Option<Outside> {
        let name = keys::name(key)?;
        match name.as_str() {
            "Ctrl-z" => return Some(Outside::Suspend),
            "Ctrl-l" => return Some(Outside::Redraw),
            "Ctrl-c" => {
                self.overlay = Overlay::None;
                self.say("nothing is running; q quits", Tone::Plain);
                return None;
            }
            _ => {}
        }
        self.say("", Tone::Plain);
        match &mut self.overlay {
            Overlay::None => self.pane_key(&name),
            Overlay::Help(..) => {
                self.help_key(&name);
                None
            }
            Overlay::Line(_) => self.line_key(key, &name),
        }
    }

    /// Types keys by their names, parted by blanks. For tests and pictures.
    pub fn type_keys(&mut self, names: &str) {
        for key in names.split_whitespace().filter_map(keys::press) {
            self.key(&key);
        }
    }

    /// Pasted text goes into a line that is being typed, and nowhere else.
    pub fn paste(&mut self, text: &str) {
        if let Overlay::Line(line) = &mut self.overlay {
            line.insert(text);
        }
    }

    fn pane_key(&mut self, name: &str) -> Option<Outside> {
        if let Ok(digit) = name.parse::<usize>()
            && (digit > 0 || self.count.is_some())
        {
            self.count = Some((self.count.unwrap_or(0) * 10 + digit).min(MOST));
            return None;
        }
        let Some(entry) = self.keymap.by_key(name) else {
            self.count = None;
            self.say(
                &format!("{name} does nothing here; ? lists the keys"),
                Tone::Error,
            );
            return None;
        };
        let count = self.count.take();
        self.act(entry, count, "")
    }

    /// Does what an entry of the table means here.
    fn act(&mut self, entry: &'static Entry, count: Option<usize>, rest: &str) -> Option<Outside> {
        if !actions::is_here(entry) {
            let told = format!("{} cannot be done here; {}", entry.name, words::READ_ONLY);
            self.say(&told, Tone::Error);
            return None;
        }
        let times = count.unwrap_or(1);
        match entry.name {
            "repeat" => {
                if let Some(last) = self.last {
                    return self.act(last, count, "");
                }
            }
            "goto" => self.goto(rest),
            "up" => self.select(-1, times),
            "down" => self.select(1, times),
            "page-up" => self.select(-PAGE, times),
            "page-down" => self.select(PAGE, times),
            "first" => self.select(isize::MIN, 1),
            "last" => self.select(isize::MAX, 1),
            "node" if rest.is_empty() => self.open_line(Purpose::Node),
            "node" => self.find(rest),
            "command" => self.open_line(Purpose::Command),
            "timeline" => {
                self.zoomed = !(self.zoomed && self.focus == Pane::Timeline);
                self.focus = Pane::Timeline;
            }
            "pane" => self.turn(1),
            "previous-pane" => self.turn(Pane::ALL.len() - 1),
            "zoom" => self.zoomed = !self.zoomed,
            "cancel" | "interrupt" => self.zoomed = false,
            "copy" => {
                let attempt = self.past.attempt(self.cursor);
                let cycle = words::cycle(&self.past, attempt)
                    .map_or(String::new(), |cycle| format!("; {cycle}"));
                let place = words::place(&self.past, self.cursor);
                let ended = words::ended(&self.past, attempt);
                self.say("copied", Tone::Plain);
                return Some(Outside::Copy(format!("{place}: {ended}{cycle}")));
            }
            "help" => self.overlay = Overlay::Help(0, Search::default()),
            "redraw" => return Some(Outside::Redraw),
            "suspend" => return Some(Outside::Suspend),
            "quit" => return Some(Outside::Quit),
            _ => {
                self.last = Some(entry);
                for _ in 0..times {
                    if !self.go(entry.name) {
                        break;
                    }
                }
            }
        }
        None
    }

    /// A motion through the iterations; false at the end of the way.
    fn go(&mut self, name: &str) -> bool {
        let last = self.past.len() - 1;
        let attempts = &self.past.run.attempts;
        let (here, at) = (self.cursor, self.past.attempt(self.cursor));
        let end = |attempt: usize| attempts[attempt].iterations.end.checked_sub(1);
        let increment = |k: usize| (attempts[k].step, attempts[k].increment);
        // The ends of attempts and increments that lie on this side of the cursor.
        let ends = |whole: bool| {
            let is_one = move |k: &usize| {
                !attempts[*k].iterations.is_empty()
                    && (!whole || *k + 1 == attempts.len() || increment(*k) != increment(*k + 1))
            };
            (0..attempts.len()).filter(is_one).filter_map(end)
        };
        let on = |whole: bool| ends(whole).find(|end| *end > here);
        let back = |whole: bool| ends(whole).rfind(|end| *end < here);
        let to = match name {
            "step" | "right" => Some(here + 1),
            "reverse-step" | "left" => here.checked_sub(1),
            "next" => on(false),
            "finish" => on(true),
            "reverse-next" => back(false),
            "reverse-finish" => back(true),
            "continue" => self.trouble(at + 1).or(Some(last)),
            _ => (0..at).rev().find_map(|k| self.trouble_of(k)).or(Some(0)),
        };
        let to = match to {
            Some(to) => to.min(last),
            None if name.starts_with("reverse") || name == "left" => 0,
            None => last,
        };
        if to == here {
            let told = if here == 0 {
                "this is the first iteration"
            } else {
                "this is the last iteration of the run"
            };
            self.say(told, Tone::Plain);
        }
        self.cursor = to;
        to != here
    }

    /// The first iteration worth a look in an attempt from this one on.
    fn trouble(&self, from: usize) -> Option<usize> {
        (from..self.past.run.attempts.len()).find_map(|k| self.trouble_of(k))
    }

    /// Where the cycle of an attempt begins, or the end of one that did not converge.
    fn trouble_of(&self, attempt: usize) -> Option<usize> {
        let this = &self.past.run.attempts[attempt];
        let cycle = self.past.rounds[attempt]
            .as_ref()
            .map(|round| round.iterations.start);
        let failed = || {
            (this.end != End::Converged)
                .then(|| this.iterations.clone().last())
                .flatten()
        };
        cycle.or_else(failed)
    }

    fn goto(&mut self, rest: &str) {
        let count = self.past.len();
        match rest.trim().parse::<usize>() {
            Ok(number) if (1..=count).contains(&number) => self.cursor = number - 1,
            _ => self.say(
                &format!("goto takes the number of an iteration, 1 to {count}"),
                Tone::Error,
            ),
        }
    }

    /// Contacts in the order of the pane with the focus.
    fn order(&self) -> Vec<usize> {
        match self.focus {
            Pane::Contacts => self
                .past
                .chatter
                .iter()
                .map(|chatter| chatter.slave)
                .collect(),
            _ => (0..self.past.run.slaves.len()).collect(),
        }
    }

    fn select(&mut self, by: isize, times: usize) {
        let by = by.saturating_mul(times as isize);
        let moved = |at: usize, count: usize| at.saturating_add_signed(by).min(count - 1);
        if self.focus == Pane::Attempts {
            let attempts = &self.past.run.attempts;
            let mut to = moved(self.past.attempt(self.cursor), attempts.len());
            // An attempt of which only the .sta tells has no iteration to look at.
            let step = if by < 0 { -1 } else { 1 };
            while attempts[to].iterations.is_empty() {
                match to
                    .checked_add_signed(step)
                    .filter(|to| *to < attempts.len())
                {
                    Some(next) => to = next,
                    None => return,
                }
            }
            self.cursor = attempts[to].iterations.start;
            return;
        }
        let order = self.order();
        if order.is_empty() {
            return;
        }
        let at = order.iter().position(|slave| *slave == self.selected);
        self.selected = order[at.map_or(0, |at| moved(at, order.len()))];
    }

    fn turn(&mut self, places: usize) {
        self.focus = self.focus.turn(places);
        if self.focus != Pane::Timeline {
            self.page = self.focus;
        }
    }

    fn open_line(&mut self, purpose: Purpose) {
        self.overlay = Overlay::Line(CommandLine::new(purpose, ""));
    }

    fn find(&mut self, text: &str) {
        let text = match text.trim() {
            "" => self.sought.clone(),
            text => text.to_owned(),
        };
        match self.past.find(&text, self.selected) {
            Some(found) => {
                self.selected = found;
                self.say(&self.past.slave(found), Tone::Plain);
            }
            None => self.say(&format!("no contact's name holds '{text}'"), Tone::Error),
        }
        self.sought = text;
    }

    fn line_key(&mut self, key: &KeyEvent, name: &str) -> Option<Outside> {
        let Overlay::Line(line) = &mut self.overlay else {
            return None;
        };
        match name {
            "Esc" => self.overlay = Overlay::None,
            "Up" => line.recall(1, &self.history),
            "Down" => line.recall(-1, &self.history),
            "Enter" => {
                let (purpose, text) = (line.purpose, line.text().trim().to_owned());
                self.overlay = Overlay::None;
                match purpose {
                    Purpose::Node => self.find(&text),
                    _ => return self.command(&text),
                }
            }
            _ => line.edit(key),
        }
        None
    }

    /// A typed line: the name of an action, and what it takes.
    fn command(&mut self, text: &str) -> Option<Outside> {
        let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        if word.is_empty() {
            return None;
        }
        self.history.push(text.to_owned());
        let context = Context {
            keymap: Some(&self.keymap),
            ..Context::default()
        };
        match context.entry(word) {
            Ok(entry) => {
                let count = rest.trim().parse().ok().filter(|_| entry.takes_count());
                self.act(entry, count.map(|count: usize| count.min(MOST)), rest)
            }
            Err(why) => {
                self.say(&why.to_string(), Tone::Error);
                None
            }
        }
    }

    fn help_key(&mut self, name: &str) {
        let Overlay::Help(top, search) = &mut self.overlay else {
            return;
        };
        if let Some(go) = search.key(name) {
            *top = search.find(go, *top, &self.help).unwrap_or(*top);
            return;
        }
        let last = self.help.len().saturating_sub(1);
        *top = match name {
            "Esc" | "q" | "?" | "F1" | "Enter" => {
                self.overlay = Overlay::None;
                return;
            }
            "Up" | "k" => top.saturating_sub(1),
            "Down" | "j" => *top + 1,
            "PageUp" => top.saturating_sub(PAGE as usize),
            "PageDown" | "Space" => *top + PAGE as usize,
            "Home" | "g" => 0,
            "End" | "G" => last,
            _ => *top,
        }
        .min(last);
    }
}
