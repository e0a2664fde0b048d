//! `Y`: copies the selection of the focused pane to the terminal's clipboard, as text.

use crate::app::{App, Effect};
use crate::copied::{NamedText, row, value};
use crate::panes;
use crate::screen;
use crate::view::View;
use stickslip_debugger::action::CopyTarget;
use stickslip_scene::shown;

/// Maximum length in bytes: terminals reject longer clipboard sequences.
const MOST: usize = 50_000;
/// Maximum number of characters that the message shows.
const SHOWN: usize = 60;

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
    // The last line may be the one that copies.
    let copies = |line: &&String| {
        line.split_whitespace()
            .eq(["copy", CopyTarget::Command.word()])
    };
    let line = app
        .history
        .iter()
        .rev()
        .find(|line| !copies(line))
        .cloned()
        .ok_or("no command in the history yet; press : to type one")?;
    Ok(("the command".into(), line))
}

/// The selection of the focused pane.
fn selected_text(app: &App, view: &View) -> Result<NamedText, String> {
    if screen::is_hidden(app.panes.focus, app, view) {
        return Err("hidden until you predict what follows".into());
    }
    (panes::entry(app.panes.focus).copied)(app, view)
}
