//! A line being typed at the bottom of the screen: `:` commands, and the answers to `i` and `/`.

use crate::action::{self, Context, Entry};
use crate::outside::shown;
use crate::tui::theme::Theme;
use crossterm::event::{Event, KeyEvent};
use ratatui::style::Modifier;
use ratatui::text::{Line, Span};
use tui_input::{Input, InputRequest, backend::crossterm::EventHandler};

/// What the line is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Any action by name.
    Command,
    /// The size of the increment.
    Increment,
    /// The name of a node, or a part of it.
    Node,
    /// A number that answers a lesson's question.
    Answer,
}

/// A line being typed.
#[derive(Debug, Clone)]
pub struct CommandLine {
    /// What the line is for.
    pub purpose: Purpose,
    input: Input,
    /// Completions of what was typed, and which of them is shown.
    completions: Option<(Vec<String>, usize)>,
    /// How far back in the history the line comes from; 0 is a new line.
    back: usize,
}

impl CommandLine {
    /// An open line.
    pub fn new(purpose: Purpose, text: &str) -> Self {
        CommandLine {
            purpose,
            input: Input::new(text.into()),
            completions: None,
            back: 0,
        }
    }

    /// What stands in it.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// A key that edits.
    pub fn edit(&mut self, key: &KeyEvent) {
        self.completions = None;
        self.input.handle_event(&Event::Key(*key));
    }

    /// Types a text; line ends and whatever else is no letter become blanks.
    pub fn insert(&mut self, text: &str) {
        self.completions = None;
        for letter in text.trim_end().chars() {
            let letter = if shown::is_order(letter) { ' ' } else { letter };
            self.input.handle(InputRequest::InsertChar(letter));
        }
    }

    /// Completes what was typed; again and again for the next one (or the one before).
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
        // A single completion is done with: the next Tab completes the next word.
        match candidates.len() {
            1 if self.purpose == Purpose::Command => self.insert_blank(),
            1 => {}
            _ => self.completions = Some((candidates, at)),
        }
    }

    fn insert_blank(&mut self) {
        self.input.handle(InputRequest::InsertChar(' '));
    }

    fn candidates(&self, context: &Context) -> Vec<String> {
        match self.purpose {
            Purpose::Command => action::complete(self.text(), context),
            Purpose::Increment | Purpose::Answer => Vec::new(),
            Purpose::Node => action::complete(&format!("node {}", self.text()), context)
                .iter()
                .filter_map(|line| line.strip_prefix("node ").map(String::from))
                .collect(),
        }
    }

    /// Brings back an older line (or, with −1, a newer one).
    pub fn recall(&mut self, by: isize, history: &[String]) {
        if self.purpose != Purpose::Command {
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

    /// The line as it is shown after a prompt, its cursor a reversed cell.
    pub fn line(&self, prompt: &str, width: usize, theme: &Theme) -> Line<'static> {
        let room = width.saturating_sub(prompt.chars().count() + 1);
        let skipped = self.input.visual_scroll(room);
        let text: Vec<char> = self.text().chars().collect();
        let at = self.input.cursor();
        // Columns and characters are the same for what is typed here; a wide character only scrolls early.
        let start = skipped.min(at);
        let part = |from: usize, to: usize| {
            text[from.min(text.len())..to.min(text.len())]
                .iter()
                .collect::<String>()
        };
        let under = text.get(at).map_or(" ".into(), char::to_string);
        Line::from(vec![
            Span::styled(prompt.to_string(), theme.key),
            Span::styled(part(start, at), theme.text),
            Span::styled(under, theme.text.add_modifier(Modifier::REVERSED)),
            Span::styled(part(at + 1, text.len()), theme.text),
        ])
    }

    /// What the footer says while the line is open: the completions, or what the action takes.
    pub fn hint(&self, context: &Context, theme: &Theme) -> Line<'static> {
        if let Some((candidates, at)) = &self.completions {
            let spans = candidates
                .iter()
                .enumerate()
                .flat_map(|(index, candidate)| {
                    let style = if index == *at {
                        theme.selected
                    } else {
                        theme.faint
                    };
                    let word = candidate.rsplit(' ').next().unwrap_or(candidate);
                    [Span::raw(" "), Span::styled(word.to_string(), style)]
                });
            return Line::from(spans.collect::<Vec<_>>());
        }
        let name = self.text().split_whitespace().next();
        let hint = match (self.purpose, name.map(|name| context.entry(name))) {
            (Purpose::Increment, _) => {
                "Enter: this increment starts again with it   Esc: leave it".into()
            }
            (Purpose::Answer, _) => "a number; Enter answers   Esc: look again first".into(),
            (Purpose::Node, _) => {
                "a name or a part of it; Enter goes to the next, Enter alone to the next of before"
                    .into()
            }
            (Purpose::Command, Some(Ok(entry))) => {
                let keys = keys(entry, context);
                format!("{} {}   {keys}{}", entry.name, entry.arguments, entry.help)
            }
            (Purpose::Command, Some(Err(_))) => choices(self.text(), context),
            (Purpose::Command, None) => {
                "an action's name; Tab completes, Up recalls, Esc leaves".into()
            }
        };
        Line::styled(format!(" {hint}"), theme.faint)
    }
}

/// The present keys of an action, where it has any.
fn keys(entry: &'static Entry, context: &Context) -> String {
    let keys = match context.keymap {
        Some(keymap) => keymap.keys(entry).collect::<Vec<_>>().join(" "),
        None => entry.keys.join(" "),
    };
    match keys.is_empty() {
        true => keys,
        false => format!("[{keys}]   "),
    }
}

/// The actions that a beginning could mean.
fn choices(text: &str, context: &Context) -> String {
    match action::complete(text.trim_start(), context) {
        found if found.is_empty() => "no action is called so; Esc and ? list them".into(),
        found => found.join("  "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::keys;

    fn typed(text: &str) -> CommandLine {
        CommandLine::new(Purpose::Command, text)
    }

    #[test]
    fn tab_completes_and_goes_round() {
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
    fn any_width_shows_something() {
        let line = typed("set settings.at_minor_limit accept");
        for width in 0..60 {
            line.line(":", width, &Theme::mono());
        }
    }
}
