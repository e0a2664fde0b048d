//! The debugger of a page: requests in, changed rows of the screen out.

use crate::message::{Content, MouseKind, Request, Update};
use crate::paint;
use crate::pictures::pictures;
use crate::trace::trace;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::path::Path;
use std::time::Duration;
use stickslip_debugger::record::journal;
use stickslip_debugger::{Colours, Session};
use stickslip_platform::{memory_disk, task};
use stickslip_scene::Scene;
use stickslip_tui::app::Effect;
use stickslip_tui::debugger::{Debugger, TerminalRequest, offers};
use stickslip_tui::event::{Event, MouseAction, MouseEvent};
use stickslip_tui::theme::Theme;
use stickslip_tui::{keys, screen};

/// The debugger of a page.
pub struct Page {
    debugger: Debugger,
    /// The rows that the page shows.
    rows: Vec<String>,
    update: Update,
}

impl Page {
    /// A debugger with the chooser.
    pub fn new() -> Page {
        Page {
            debugger: debugger(),
            rows: Vec::new(),
            update: Update::default(),
        }
    }

    /// Handles a request, solves for a few milliseconds, and returns what changed.
    pub fn handle(&mut self, request: Request) -> Update {
        match request {
            Request::Resize { columns, rows } => {
                self.debugger.app.area = Rect::new(0, 0, columns, rows);
                self.rows = vec![String::new(); rows.into()];
            }
            Request::Background { light } => self.debugger.app.find_colours(light),
            Request::Key(name) => {
                if let Some(key) = keys::press(&name) {
                    self.input(&Event::Key(key));
                }
            }
            Request::Paste(text) => self.input(&Event::Paste(text)),
            Request::Mouse { kind, column, row } => {
                let kind = match kind {
                    MouseKind::Click => MouseAction::Click,
                    MouseKind::Up => MouseAction::ScrollUp,
                    MouseKind::Down => MouseAction::ScrollDown,
                };
                self.input(&Event::Mouse(MouseEvent { kind, column, row }));
            }
            Request::File {
                path,
                content,
                modified,
            } => {
                let modified = Duration::try_from_secs_f64(modified / 1e3).unwrap_or_default();
                memory_disk::put(Path::new(&path), content.into(), modified);
            }
            Request::Open(settings) => self.open(settings),
            Request::Pictures { settings, part } => {
                self.update.pictures = Some(match &self.debugger.session {
                    Some(session) => pictures(session.scene(), &settings, part),
                    None => Err("open a scene first".to_owned()),
                });
            }
            Request::Trace(scene) => self.update.trace = Some(trace(&scene)),
            Request::Advance => {}
        }
        self.advance()
    }

    fn input(&mut self, event: &Event) {
        let request = self.debugger.event(event);
        self.obey(request);
        self.debugger.breathe();
    }

    /// Executes requests to the terminal. `Quit` opens the chooser, since a page cannot close itself.
    fn obey(&mut self, request: Option<TerminalRequest>) {
        match request {
            Some(TerminalRequest::Quit) => {
                let app = &self.debugger.app;
                let (area, colours) = (app.area, app.colours);
                self.debugger = debugger();
                self.debugger.app.area = area;
                (self.debugger.app.colours, self.debugger.app.theme) =
                    (colours, Theme::new(colours));
            }
            Some(TerminalRequest::Copy(text)) => self.update.copy = Some(text),
            Some(TerminalRequest::Suspend) => {
                self.debugger.app.complain("a page cannot be suspended");
            }
            Some(TerminalRequest::Redraw) => self.rows.fill(String::new()),
            Some(TerminalRequest::Mouse(_)) | None => {}
        }
    }

    /// Opens the scene, lesson or journal of a link.
    fn open(&mut self, settings: Vec<(String, String)>) {
        let mut named = None;
        let mut overrides = Vec::new();
        for (key, value) in settings {
            match key.as_str() {
                "lesson" | "scene" | "journal" => named = Some((key, value)),
                _ => overrides.push((key, value)),
            }
        }
        match named {
            Some((kind, name)) if kind == "lesson" => {
                self.debugger.carry_out(Effect::Lesson(name));
            }
            Some((kind, name)) if kind == "scene" => match Scene::open(&name, &overrides) {
                Ok(scene) => self.debugger.open(Session::new(scene)),
                Err(why) => self.debugger.app.complain(why),
            },
            Some((_, name)) => {
                let newest = || journal::newest().map(|path| path.display().to_string());
                let path = match name.as_str() {
                    "" | "newest" => newest().map_err(|why| why.to_string()),
                    _ => Ok(name),
                };
                match path {
                    Ok(path) => drop(self.debugger.carry_out(Effect::Open(path))),
                    Err(why) => self.debugger.app.complain(why),
                }
            }
            None if overrides.is_empty() => {}
            None => {
                let message = "link: expected scene=NAME or lesson=NAME before the settings";
                self.debugger.app.complain(message);
            }
        }
    }

    fn advance(&mut self) -> Update {
        let worked = task::turn();
        let changed = self.debugger.advance();
        while let Some(request) = self.debugger.take_request() {
            self.obey(Some(request));
        }
        self.draw();
        let written = memory_disk::take_changed().into_iter();
        let files =
            written.map(|(path, bytes)| (path.display().to_string(), bytes.map(Content::from)));
        self.update.files = files.collect();
        self.update.busy = worked || changed || self.debugger.is_working();
        std::mem::take(&mut self.update)
    }

    fn draw(&mut self) {
        let area = self.debugger.app.area;
        let mut buffer = Buffer::empty(area);
        let view = self.debugger.view();
        screen::draw(&mut buffer, area, &self.debugger.app, view.as_ref());
        for (at, shown) in self.rows.iter_mut().enumerate() {
            let row = paint::row(&buffer, at);
            if row != *shown {
                shown.clone_from(&row);
                self.update.rows.push((at, row));
            }
        }
    }
}

impl Default for Page {
    fn default() -> Page {
        Page::new()
    }
}

fn debugger() -> Debugger {
    let colours = Colours::default();
    let mut debugger = Debugger::new(Theme::new(colours), offers(), None);
    debugger.app.finds_colours = true;
    debugger.use_user_files();
    debugger.keeps = true;
    debugger
}
