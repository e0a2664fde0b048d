//! Mouse input: a click selects, the wheel scrolls. Every mouse action has a key.

use crate::app::{App, Effect, Overlay};
use crate::event::{MouseAction, MouseEvent};
use crate::input_queue::QueuedInput;
use crate::layout::Pane;
use crate::panes::{branches, nodes, remedies, shape, timeline};
use crate::screen;
use crate::view::View;
use Pane::*;
use ratatui::layout::{Position, Rect};
use stickslip_debugger::Command;
use stickslip_debugger::action::{Action, Step, Ui};

/// Lines per turn of the wheel in a page of text.
const LINES: usize = 3;

impl App {
    /// Handles a mouse event on the last drawn screen.
    pub fn mouse(&mut self, event: &MouseEvent, view: Option<&View>) -> Option<Effect> {
        let at = Position::new(event.column, event.row);
        match event.kind {
            MouseAction::Click => self.click(at, view),
            MouseAction::ScrollUp => self.wheel(at, true, view),
            MouseAction::ScrollDown => self.wheel(at, false, view),
        }
    }

    fn click(&mut self, at: Position, view: Option<&View>) -> Option<Effect> {
        let view = view?;
        let (pane, area) = pane_at(self, at, view)?;
        self.say("");
        let hidden = screen::is_hidden(pane, self, view);
        // The layout before the focus changes, which can change the layout.
        let row = match pane {
            Branches if !hidden => branches::row_at(area, self, view, at),
            Remedies => remedies::row_at(area, self, view, at),
            _ => None,
        };
        let slave = match pane {
            Nodes => nodes::slave_at(area, self, view, at),
            Shape => shape::slave_at(area, self, view, at),
            Timeline if !hidden => timeline::slave_at(area, self, view, at),
            _ => None,
        };
        let step = match pane {
            Timeline if !hidden => timeline::step_at(area, view, at),
            _ => None,
        };
        if pane != Lesson {
            self.panes.look_at(pane);
        }
        match (pane, row) {
            (Branches, Some(row)) => self.branch = row,
            (Remedies, Some(row)) if !hidden => self.remedy = row,
            _ => {}
        }
        if let Some(slave) = slave {
            self.attempt(Ok(Action::Ui(Ui::Select(slave))), None, Some(view));
        }
        let step = step.filter(|step| *step != view.cursor)?;
        let action = Action::Session(Command::Goto { step });
        match self.awaits(&action, Some(view)) {
            _ if self.ahead.is_any() => None,
            Some(awaited) => {
                let line = QueuedInput::Line(format!("goto {step}"));
                self.ahead.push(line, Some(awaited));
                None
            }
            None => self.attempt(Ok(action), None, Some(view)),
        }
    }

    fn wheel(&mut self, at: Position, up: bool, view: Option<&View>) -> Option<Effect> {
        let key = if up { "Up" } else { "Down" };
        match &self.overlay {
            Overlay::None => {}
            Overlay::Text(_) => {
                for _ in 0..LINES {
                    self.page_key(key, view);
                }
                return None;
            }
            Overlay::Chart(_) => {
                self.page_key(key, view);
                return None;
            }
            Overlay::Chooser(_) if self.loading.is_none() => {
                return self.chooser_key(key, view);
            }
            _ => return None,
        }
        let view = view?;
        let (pane, _) = pane_at(self, at, view)?;
        let step = match (pane, up) {
            (Shape, _) => {
                self.camera = self.camera.zoomed(if up { 1.25 } else { 0.8 });
                return None;
            }
            (Diagnosis, _) => {
                let found = view.examination().flatten();
                let last = found.map_or(0, |found| found.lines().len());
                self.scroll = if up {
                    self.scroll.saturating_sub(LINES)
                } else {
                    (self.scroll + LINES).min(last)
                };
                return None;
            }
            // The timeline cannot be scrolled while the solver runs.
            (Timeline, _) if view.running || self.ahead.is_any() => return None,
            (Timeline, true) => Step::Left,
            (Timeline, false) => Step::Right,
            (Residual | Curve | Lesson | Contact, _) => return None,
            (_, true) => Step::Up,
            (_, false) => Step::Down,
        };
        // Acts like a key in the pane under the mouse, which need not have the focus.
        let focus = std::mem::replace(&mut self.panes.focus, pane);
        let effect = self.attempt(Ok(Action::Ui(Ui::Move(step))), None, Some(view));
        self.panes.focus = focus;
        effect
    }
}

/// The pane at a position, unless an overlay is open.
fn pane_at(app: &App, at: Position, view: &View) -> Option<(Pane, Rect)> {
    if !matches!(app.overlay, Overlay::None) {
        return None;
    }
    let places = screen::places(app, Some(view), app.area);
    places.panes.into_iter().find(|(_, area)| area.contains(at))
}
