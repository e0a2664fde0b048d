//! The input line at the bottom of the screen: `:` commands, and the answers to `i` and `/`.

use crate::event::{KeyCode, KeyEvent, Modifiers};
use crate::paint;
use crate::theme::Theme;
use ratatui::style::Modifier;
use ratatui::text::{Line, Span};
use std::borrow::Cow;
use stickslip_debugger::action::{self, ActionEntry, Context};
use stickslip_scene::{joined, shown};
use tui_input::{Input, InputRequest};
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// What is being typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Any action, by name.
    Command,
    /// The increment.
    Increment,
    /// A node's name, or part of it.
    Node,
    /// A number that answers a lesson's question.
    Answer,
}

use Purpose::*;

/// An input line.
#[derive(Debug, Clone)]
pub struct CommandLine {
    /// What is being typed.
    pub purpose: Purpose,
    input: Input,
    /// Completions of the line, and the index of the one shown.
    completions: Option<(Vec<String>, usize)>,
    /// Position in the history, counted from its end; 0 is a new line.
    back: usize,
}

impl CommandLine {
    /// A line with an initial text.
    pub fn new(purpose: Purpose, text: &str) -> Self {
        CommandLine {
            purpose,
            input: Input::new(text.into()),
            completions: None,
            back: 0,
        }
    }

    /// The text.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// Handles an editing key.
    pub fn edit(&mut self, key: &KeyEvent) {
        self.completions = None;
        if let Some(request) = edit_request(key) {
            self.input.handle(request);
        }
    }

    /// Inserts a text; line ends and control characters become blanks.
    pub fn insert(&mut self, text: &str) {
        self.completions = None;
        for letter in text.trim_end().chars() {
            let letter = if shown::is_order(letter) { ' ' } else { letter };
            self.input.handle(InputRequest::InsertChar(letter));
        }
    }

    /// Completes the text; repeated calls step through the completions by `by`.
    pub fn complete(&mut self, by: isize, context: &Context) {
        let (candidates, at) = match self.completions.take() {
            Some((candidates, at)) => {
                let next = (at as isize + by).rem_euclid(candidates.len() as isize);
                (candidates, next as usize)
            }
            None => (self.candidates(context), 0),
        };
        let Some(text) = candidates.get(at) else {
            return;
        };
        self.input = Input::new(text.clone());
        // A single completion is final: the next Tab completes the next word.
        match candidates.len() {
            1 if self.purpose == Command && !self.goes_on() => self.insert_blank(),
            1 => {}
            _ => self.completions = Some((candidates, at)),
        }
    }

    /// Whether the completed word is a path, which takes no blank: Tab then completes inside a folder.
    fn goes_on(&self) -> bool {
        let mut words = self.text().split_whitespace();
        words.next().is_some_and(action::takes_path) && words.next().is_some()
    }

    fn insert_blank(&mut self) {
        self.input.handle(InputRequest::InsertChar(' '));
    }

    fn candidates(&self, context: &Context) -> Vec<String> {
        match self.purpose {
            Command => action::complete(self.text(), context),
            Increment | Answer => Vec::new(),
            Node => action::complete(&format!("node {}", self.text()), context)
                .iter()
                .filter_map(|line| line.strip_prefix("node ").map(String::from))
                .collect(),
        }
    }

    /// Recalls an older line from the history (a newer one with −1).
    pub fn recall(&mut self, by: isize, history: &[String]) {
        if self.purpose != Command {
            return;
        }
        self.completions = None;
        self.back = self.back.saturating_add_signed(by).min(history.len());
        let text = match self.back {
            0 => "",
            back => &history[history.len() - back],
        };
        self.input = Input::new(text.into());
    }

    /// The line after a prompt, with the cursor as a reversed cell, in as many rows as it needs.
    pub fn lines(&self, prompt: &str, width: usize, theme: &Theme) -> paint::Lines {
        let cursor = theme.text.add_modifier(Modifier::REVERSED);
        let at = self.input.cursor();
        let typed = self
            .text()
            .chars()
            .chain([' '])
            .enumerate()
            .map(|(place, letter)| {
                if place == at {
                    (letter, cursor)
                } else {
                    (letter, theme.text)
                }
            });
        let mut rows: Vec<Vec<Span>> = vec![Vec::new()];
        let mut used = 0;
        for (letter, style) in prompt.chars().map(|c| (c, theme.key)).chain(typed) {
            let wide = letter.width().unwrap_or(0);
            if used + wide > width.max(2) {
                rows.push(Vec::new());
                used = 0;
            }
            used += wide;
            if let Some(row) = rows.last_mut() {
                row.push(Span::styled(letter.to_string(), style));
            }
        }
        rows.into_iter().map(Line::from).collect()
    }

    /// The footer while the line is open: the completions, or the arguments of the action.
    pub fn hint(&self, context: &Context, width: usize, theme: &Theme) -> paint::Lines {
        if let Some((candidates, at)) = &self.completions {
            let words = candidates
                .iter()
                .map(|candidate| self.displayed(candidate, context));
            return completions(words, *at, width, theme);
        }
        let name = self.text().split_whitespace().next();
        let hint = match (self.purpose, name.map(|name| context.entry(name))) {
            (Increment, _) => {
                "Enter: restart this increment with it   Esc: cancel".into()
            }
            (Answer, _) => "Enter: answer with this number   Esc: back to the panes".into(),
            (Node, _) => {
                "a node's name or part of it; Enter finds the next match, Enter alone repeats the search"
                    .into()
            }
            (Command, Some(Ok(entry))) if entry.offered(context).is_err() => {
                let why = entry.offered(context).err().unwrap_or_default();
                format!("{} {}   not available: {why}", entry.name, entry.arguments)
            }
            (Command, Some(Ok(entry)))
                if entry.name == "set" && context.offers.is_some() =>
            {
                self.parameter(entry, context)
            }
            (Command, Some(Ok(entry))) => {
                let keys = keys(entry, context);
                format!("{} {}   {keys}{}", entry.name, entry.arguments, entry.help)
            }
            (Command, Some(Err(_))) => self.choices(context),
            (Command, None) => {
                "name of an action; Tab completes, Up recalls, Esc cancels".into()
            }
        };
        let lines = paint::wrap(&hint, width.saturating_sub(2)).into_iter();
        lines
            .map(|line| Line::styled(format!(" {line}"), theme.faint))
            .collect()
    }

    /// Describes the parameter that is being set, or lists all parameters.
    fn parameter(&self, entry: &ActionEntry, context: &Context) -> String {
        let rest = self.text().trim_start().split_once(char::is_whitespace);
        match rest.and_then(|(_, rest)| action::parameter(rest, context)) {
            Some((known, _)) => {
                let now = action::present(known, context);
                let about = if known.about.is_empty() { "" } else { ": " };
                format!(
                    "set {}: {}, now {now}{about}{}",
                    known.name, known.range, known.about
                )
            }
            None => {
                let names: Vec<&str> = context
                    .offers
                    .into_iter()
                    .flat_map(|offers| &offers.parameters)
                    .map(|known| known.name.as_str())
                    .collect();
                format!(
                    "{} NAME VALUE   names: {}   (details: :parameters)",
                    entry.name,
                    names.join(", ")
                )
            }
        }
    }

    /// The actions that start with the typed text.
    fn choices(&self, context: &Context) -> String {
        match action::complete(self.text().trim_start(), context) {
            found if found.is_empty() => "no such action; Esc, then ? lists all".into(),
            found => joined(found.iter().map(|name| self.displayed(name, context)), "  "),
        }
    }

    /// The displayed part of a completion: the completed word, or the last component of a path.
    fn displayed<'a>(&self, candidate: &'a str, context: &Context) -> Cow<'a, str> {
        // Parentheses mark actions that are not available, since colour alone must not.
        let grey = |name: &str| {
            context
                .entry(name)
                .is_ok_and(|entry| entry.offered(context).is_err())
        };
        if self.purpose == Command && !candidate.trim().contains(' ') && grey(candidate.trim()) {
            return Cow::Owned(format!("({candidate})"));
        }
        Cow::Borrowed(self.word(candidate))
    }

    /// The word that a candidate completes.
    fn word<'a>(&self, candidate: &'a str) -> &'a str {
        let name = candidate.split_whitespace().next();
        let paths = name.is_some_and(action::takes_path) && self.purpose == Command;
        if !paths {
            return candidate.rsplit(' ').next().unwrap_or(candidate);
        }
        let path = candidate
            .split_once(' ')
            .map_or(candidate, |(_, path)| path);
        let end = path.strip_suffix('/').unwrap_or(path);
        match end.rfind('/') {
            Some(slash) => &path[slash + 1..],
            None => path,
        }
    }
}

/// Maximum rows of completions.
const COMPLETIONS: usize = 6;

/// Completions in a row, or in several rows if they do not fit; the rows shown include the current one.
fn completions<'a>(
    words: impl Iterator<Item = Cow<'a, str>>,
    at: usize,
    width: usize,
    theme: &Theme,
) -> paint::Lines {
    let mut rows: Vec<Vec<Span>> = vec![Vec::new()];
    let (mut used, mut here) = (0, 0);
    for (index, word) in words.enumerate() {
        let word = paint::cut(&word, width.saturating_sub(1));
        let wide = 1 + word.width();
        if used > 0 && used + wide > width {
            rows.push(Vec::new());
            used = 0;
        }
        used += wide;
        let style = if index == at {
            theme.selected
        } else {
            theme.faint
        };
        if index == at {
            here = rows.len() - 1;
        }
        if let Some(row) = rows.last_mut() {
            row.extend([Span::raw(" "), Span::styled(word, style)]);
        }
    }
    let first = (here + 1).saturating_sub(COMPLETIONS);
    rows.into_iter()
        .skip(first)
        .take(COMPLETIONS)
        .map(Line::from)
        .collect()
}

/// The current keys of an action in brackets; empty if it has none.
fn keys(entry: &'static ActionEntry, context: &Context) -> String {
    let keys = match context.keymap {
        Some(keymap) => joined(keymap.keys(entry), " "),
        None => entry.keys.join(" "),
    };
    if keys.is_empty() {
        keys
    } else {
        format!("[{keys}]   ")
    }
}

/// The edit that a key asks for, as in readline.
fn edit_request(key: &KeyEvent) -> Option<InputRequest> {
    use InputRequest::*;
    use KeyCode::*;
    Some(match (key.code, key.modifiers) {
        (Backspace, Modifiers::NONE) | (Char('h'), Modifiers::CONTROL) => DeletePrevChar,
        (Delete, Modifiers::NONE) => DeleteNextChar,
        (Left, Modifiers::NONE) | (Char('b'), Modifiers::CONTROL) => GoToPrevChar,
        (Left, Modifiers::CONTROL) => GoToPrevWord,
        (Right, Modifiers::NONE) | (Char('f'), Modifiers::CONTROL) => GoToNextChar,
        (Right, Modifiers::CONTROL) => GoToNextWord,
        (Char('u'), Modifiers::CONTROL) => DeleteLine,
        (Char('w'), Modifiers::CONTROL) => DeletePrevWord,
        (Delete, Modifiers::CONTROL) => DeleteNextWord,
        (Char('k'), Modifiers::CONTROL) => DeleteTillEnd,
        (Char('y'), Modifiers::CONTROL) => Yank,
        (Home, Modifiers::NONE) | (Char('a'), Modifiers::CONTROL) => GoToStart,
        (End, Modifiers::NONE) | (Char('e'), Modifiers::CONTROL) => GoToEnd,
        (Char(letter), Modifiers::NONE | Modifiers::SHIFT) => InsertChar(letter),
        (Char(letter), modifiers) if modifiers.control && modifiers.alt => InsertChar(letter),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys;

    fn typed(text: &str) -> CommandLine {
        CommandLine::new(Purpose::Command, text)
    }

    #[test]
    fn tab_cycles_through_completions() {
        let context = Context::default();
        let mut line = typed("ste");
        line.complete(1, &context);
        assert_eq!(line.text(), "step ");
        let mut line = typed("m");
        let seen: Vec<String> = (0..3)
            .map(|_| {
                line.complete(1, &context);
                line.text().to_string()
            })
            .collect();
        assert_eq!(seen, ["minors", "majors", "monitor"]);
        line.complete(-1, &context);
        assert_eq!(line.text(), "majors");
    }

    #[test]
    fn history_goes_back_and_forth() {
        let history = ["step".to_string(), "friction 20".to_string()];
        let mut line = typed("");
        line.recall(1, &history);
        assert_eq!(line.text(), "friction 20");
        line.recall(1, &history);
        line.recall(1, &history);
        assert_eq!(line.text(), "step");
        line.recall(-1, &history);
        line.recall(-1, &history);
        assert_eq!(line.text(), "");
    }

    #[test]
    fn editing_and_pasting() {
        let mut line = typed("stp");
        for key in ["Left", "e"] {
            line.edit(&keys::press(key).unwrap());
        }
        assert_eq!(line.text(), "step");
        line.insert("\n3\t4\n");
        assert_eq!(line.text(), "ste 3 4p");
    }

    #[test]
    fn any_width_shows_the_whole_line_and_the_cursor() {
        let line = typed("set settings.at_minor_limit accept");
        for width in 0..60 {
            let rows = line.lines(":", width, &Theme::mono());
            assert!(
                rows.iter().all(|row| row.width() <= width.max(2)),
                "{width}"
            );
            let cells: Vec<&Span> = rows.iter().flat_map(|row| &row.spans).collect();
            let text: String = cells.iter().map(|cell| &*cell.content).collect();
            assert_eq!(text, format!(":{} ", line.text()), "{width}");
            let reversed = |cell: &&&Span| cell.style.add_modifier.contains(Modifier::REVERSED);
            assert_eq!(cells.iter().filter(reversed).count(), 1, "{width}");
        }
    }
}
