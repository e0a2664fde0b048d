//! `Y`: copies the selection of the focused pane to the terminal's clipboard, as text.

use crate::app::{App, Effect};
use crate::panes;
use crate::screen;
use crate::view::View;
use stickslip_debugger::action::CopyTarget;
use stickslip_debugger::explain::names;
use stickslip_debugger::history::watches::{Watch, WatchQuantity};
use stickslip_scene::shown;

/// Maximum length in bytes: terminals reject longer clipboard sequences.
const MOST: usize = 50_000;
/// Maximum number of characters that the message shows.
const SHOWN: usize = 60;

/// A name for the message, and the copied text.
pub(crate) type NamedText = (String, String);

impl App {
    /// Copies something and shows what was copied.
    pub(super) fn copy(&mut self, what: Option<CopyTarget>, view: Option<&View>) -> Option<Effect> {
        let copied = match (what, view) {
            (Some(CopyTarget::Keys), _) => Ok(("the keys".into(), self.keymap.text())),
            (Some(CopyTarget::Command), _) => last_line(self),
            (_, None) => Err("open a scene first".into()),
            (Some(CopyTarget::Row), Some(view)) => row(self, view),
            (Some(CopyTarget::Number(quantity)), Some(view)) => value(quantity, self, view),
            (None, Some(view)) => selected_text(self, view),
        };
        match copied {
            Ok((_, text)) if text.len() > MOST => {
                self.complain(format!(
                    "selection too large: {} bytes; terminals accept at most {MOST}",
                    text.len()
                ));
                None
            }
            Ok((name, text)) => {
                let shown = shown::cut(&text.replace(['\t', '\n'], " "), SHOWN);
                self.say(format!("copied {name}: {shown}"));
                Some(Effect::Copy(text))
            }
            Err(why) => {
                self.complain(why);
                None
            }
        }
    }
}

fn last_line(app: &App) -> Result<NamedText, String> {
    let line = app.history.last().cloned();
    let line = line.ok_or("no command in the history yet; press : to type one")?;
    Ok(("the command".into(), line))
}

/// The selection of the focused pane.
fn selected_text(app: &App, view: &View) -> Result<NamedText, String> {
    if screen::is_hidden(app.panes.focus, app, view) {
        return Err("hidden until you predict what follows".into());
    }
    (panes::entry(app.panes.focus).copied)(app, view)
}

/// The selected slave node and all its numbers, separated by tabs.
pub(crate) fn row(app: &App, view: &View) -> Result<NamedText, String> {
    let slave = app.slave(view);
    if view.model.contacts.is_empty() {
        return Err("this scene has no slave nodes".into());
    }
    let next = match app.learning.hides(view, slave) {
        true => "?",
        false => names::mode(view.mode(slave)),
    };
    let name = view.slave(slave);
    let before = names::mode(view.mode_before(slave));
    let mut cells = vec![name.to_owned(), before.into(), next.into()];
    if let Some(found) = view.record(slave) {
        let numbers = [found.gap, found.f_n, found.f_t, found.t_max, found.slip];
        cells.extend(numbers.map(|number| format!("{number:e}")));
    }
    Ok((format!("the row of {name}"), cells.join("\t")))
}

/// A quantity of the selected node.
pub(crate) fn value(quantity: WatchQuantity, app: &App, view: &View) -> Result<NamedText, String> {
    let slave = app.slave(view);
    if quantity.is_nodal() && view.model.contacts.is_empty() {
        return Err("this scene has no slave nodes".into());
    }
    if quantity == WatchQuantity::Margin && app.learning.hides(view, slave) {
        return Err("hidden until you predict what follows".into());
    }
    let watch = Watch::new(view.model, quantity, slave);
    let value = watch.value(view.frame());
    let value = value.ok_or_else(|| format!("{} has no value here", watch.name))?;
    Ok((watch.name, format!("{value:e}")))
}

/// The load and the shown monitor at the last accepted increment.
pub(crate) fn monitored(app: &App, view: &View) -> Result<NamedText, String> {
    let at = app.watched(view);
    let monitor = view.model.monitors.get(at);
    let monitor = monitor.ok_or("this scene has no monitors")?;
    let frames = &view.frames[..=view.cursor];
    let frame = frames.iter().rev().find(|frame| frame.monitors.is_some());
    let value = frame.and_then(|frame| frame.monitors.as_ref()?.get(at).copied());
    let (Some(frame), Some(value)) = (frame, value) else {
        return Err("no increment accepted yet".into());
    };
    let load = frame.state.start.load_factor;
    Ok((
        format!("load and {}", monitor.name),
        format!("{load:e}\t{value:e}"),
    ))
}
