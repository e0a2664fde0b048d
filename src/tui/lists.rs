//! Focus and selection: moving between panes and inside them, and acting on the selected entry.

use crate::app::{App, Effect, PAGE};
use crate::layout::Pane;
use crate::screen;
use crate::view::View;
use Pane::*;
use Step::*;
use stickslip_core::Status;
use stickslip_debugger::action::{Page, Step};
use stickslip_debugger::explain::remedy::RemedyInput;
use stickslip_debugger::history::verdicts::{self, summaries};
use stickslip_debugger::{BranchTarget, Command, DiagnosisPage, RemedyTrial};

impl App {
    /// Shows the curve of a monitor, or of the next one, also if the pane was hidden.
    pub(super) fn watch(&mut self, monitor: Option<usize>, view: Option<&View>) {
        let places = screen::places(self, view, self.area);
        if places.panes.iter().all(|(pane, _)| *pane != Curve) {
            self.panes.look_at(Curve);
        }
        let monitors = view.map_or(&[][..], |view| &view.model.monitors);
        let shown = view.map_or(0, |view| self.watched(view));
        let at = monitor.unwrap_or((shown + 1) % monitors.len().max(1));
        self.monitor = Some(at);
        match monitors.get(at) {
            Some(monitor) => self.say(format!("load over {}", monitor.name)),
            None => self.complain("this scene has no monitors"),
        }
    }

    /// Opens a page, and runs its analysis if there is no result yet. Requesting an open page again keeps it open.
    pub(super) fn page(&mut self, page: Page, view: Option<&View>) -> Option<Effect> {
        match page {
            Page::Timeline => self.panes.zoom(Timeline),
            Page::Branches => self.panes.zoom(Branches),
            Page::Contact => self.panes.zoom(Contact),
            Page::Diagnosis => return self.ask_page(Diagnosis, view),
            // The cures of a finished run are in its diagnosis.
            Page::Remedies if view.is_some_and(View::is_finished) => {
                return self.ask_page(Diagnosis, view);
            }
            Page::Remedies => return self.ask_page(Remedies, view),
        }
        if page == Page::Branches {
            let all = summaries(view?.tree?);
            let order = verdicts::order(&all);
            let current = order.iter().position(|&(branch, _)| all[branch].is_current);
            self.branch = current.unwrap_or(0);
        }
        None
    }

    fn ask_page(&mut self, pane: Pane, view: Option<&View>) -> Option<Effect> {
        let again = self.panes.zoomed && self.panes.focus == pane;
        self.panes.zoomed = true;
        self.panes.look_at(pane);
        let view = view?;
        let found = match pane {
            Diagnosis => view.examination().map(|found| found.is_some()),
            _ => view.tries_here().then(|| !view.is_trying()),
        };
        match (found, pane) {
            (None, Diagnosis) => {
                (self.answer, self.scroll) = (0, 0);
                return self.submit(Command::Census(Vec::new()), Some(view));
            }
            (None, _) => {
                self.remedy = 0;
                return self.submit(Command::Remedies, Some(view));
            }
            (Some(false), Diagnosis) if again => {
                self.say("diagnosis running; Esc closes this page");
            }
            (Some(false), _) if again => {
                self.say("trying remedies; Ctrl-C stops, Esc closes this page");
            }
            (Some(true), _) if again => self.say("the result is complete; Esc closes this page"),
            _ => {}
        }
        None
    }

    /// Enter in the diagnosis: takes the selected line of Try, or folds the selected part; runs the analysis if there is no result
    /// yet.
    pub(super) fn take_answer(&mut self, view: Option<&View>) -> Option<Effect> {
        let Some(found) = view.and_then(View::examination) else {
            return self.ask_page(Diagnosis, view);
        };
        let page = found?;
        let below = self.answer.checked_sub(page.tries.len());
        if let Some((part, _)) = below.and_then(|at| page.below.get(at)) {
            match self.folded.iter().position(|folded| folded == part) {
                Some(at) => drop(self.folded.remove(at)),
                None => self.folded.push(*part),
            }
            return None;
        }
        self.take_try(page, view)
    }

    /// Takes the selected line of Try: repeats its trial in a branch, or tries it if the trials were interrupted. Where nothing failed
    /// it types the line; of a finished run it copies the lines for the deck.
    fn take_try(&mut self, page: &DiagnosisPage, view: Option<&View>) -> Option<Effect> {
        let last = page.tries.len().checked_sub(1)?;
        let line = &page.tries[self.answer.min(last)];
        let label = &line.label;
        let has_failed = matches!(view?.frame().state.status, Status::Failed(_));
        match &line.trial {
            Some(trial) => return follow(self, trial, view),
            _ if view.is_some_and(View::is_finished) => {
                return self.copy(None, view);
            }
            _ if line.typed.is_empty() => {
                self.say(format!("{label}: nothing can try this for you"))
            }
            _ if !has_failed => {
                return self.take_line(line.typed.trim_start_matches(':'), view);
            }
            _ if page.is_complete() => {
                return self.submit(Command::Census(Vec::new()), view);
            }
            _ => self.say(format!("{label}: the trials are running")),
        }
        None
    }

    /// What Enter does in the focused list: the label of its key, or another word; `None` if there is nothing to take.
    pub(super) fn enter_label<'a>(&self, label: &'a str, view: Option<&View>) -> Option<&'a str> {
        let Some(view) = view else {
            return Some(label);
        };
        match self.panes.focus {
            Diagnosis => {
                let Some(found) = view.examination() else {
                    return Some("analyse");
                };
                let page = found?;
                let (tries, below) = (page.tries.len(), page.below.len());
                match self.answer.min((tries + below).saturating_sub(1)) {
                    at if at < tries => Some(label),
                    _ if below > 0 => Some("fold"),
                    _ => None,
                }
            }
            Remedies if !view.has_tried() => Some("try all"),
            Remedies => (!view.trials().is_empty()).then_some(label),
            _ => Some(label),
        }
    }

    /// Enter in the remedies: applies the selected one, or tries all if there is no result yet.
    pub(super) fn take_remedy(&mut self, view: Option<&View>) -> Option<Effect> {
        if view.is_some_and(View::has_tried) {
            self.apply(self.remedy, view)
        } else {
            self.ask_page(Remedies, view)
        }
    }

    /// Goes to the last state of the selected branch.
    pub(super) fn go_to_branch(&mut self, view: Option<&View>) -> Option<Effect> {
        let all = summaries(view?.tree?);
        let (branch, _) = *verdicts::order(&all).get(self.branch)?;
        let to = BranchTarget::Named(format!("b{}", branch + 1));
        self.submit(Command::Branch(to), view)
    }

    /// Starts from a consistent state found by the census.
    pub(super) fn start_from(&mut self, number: usize, view: Option<&View>) -> Option<Effect> {
        let found = view?.examination().flatten();
        match found.and_then(|page| page.found.starts(number)) {
            Some(starts) => return self.submit(Command::Assume(starts), view),
            None if found.is_none() => {
                self.complain("consistent states are not known here yet; run :census");
            }
            None => self.complain(format!("there is no consistent state {}", number + 1)),
        }
        None
    }

    /// Applies a remedy of the list, if it was tried from the current state.
    pub(super) fn apply(&mut self, number: usize, view: Option<&View>) -> Option<Effect> {
        let (background, here) = (view?.background?, (view?.tree?.current(), view?.cursor));
        let Some(tried) = background.tried().filter(|tried| !tried.trials.is_empty()) else {
            self.complain("no remedy tried yet; press r to try all");
            return None;
        };
        let Some(trial) = tried.trials.get(number) else {
            self.complain(format!("there is no remedy {}", number + 1));
            return None;
        };
        if background.is_trying() || tried.place != here {
            let (branch, step) = tried.place;
            self.complain(if background.is_trying() { "remedies are still being tried; Ctrl-C stops them".into() } else { format!(
                    "these remedies were tried from step {step} of b{}; go there, or press r to try them here",
                    branch + 1
                ) });
            return None;
        }
        follow(self, trial, view)
    }

    /// Finds a text in the focused list: a branch, a remedy, or otherwise a slave node. An empty text repeats the last search.
    pub(super) fn seek(&mut self, text: String, view: Option<&View>) -> Option<Effect> {
        if !text.is_empty() {
            self.sought = text;
        }
        let text = self.sought.to_lowercase();
        let view = view.filter(|_| !text.is_empty())?;
        let (names, at): (Vec<String>, _) = match self.panes.focus {
            Branches if !screen::is_hidden(Branches, self, view) => {
                let all = summaries(view.tree?);
                let order = verdicts::order(&all);
                let names = order.iter().map(|&(branch, _)| all[branch].name.clone());
                (names.collect(), &mut self.branch)
            }
            Remedies if !screen::is_hidden(Remedies, self, view) => {
                let names = view.trials().iter().map(|trial| trial.label.clone());
                (names.collect(), &mut self.remedy)
            }
            _ => {
                let line = format!("node {}", self.sought);
                self.remember(&line);
                return self.take_line(&line, Some(view));
            }
        };
        let count = names.len();
        let found = (1..=count)
            .map(|k| (*at + k) % count)
            .find(|&row| names[row].to_lowercase().contains(&text));
        match found {
            Some(row) => *at = row,
            None => self.complain(format!("no entry of this list contains '{}'", self.sought)),
        }
        None
    }

    pub(super) fn step(&mut self, step: Step, count: isize, view: Option<&View>) -> Option<Effect> {
        if self.panes.focus == Timeline
            && let Some(to) = view.and_then(|view| along(step, count, view))
        {
            return self.submit(Command::Goto { step: to }, view);
        }
        let answers = view
            .and_then(|view| view.examination()?)
            .map(|page| page.tries.len() + page.below.len());
        let list = match self.panes.focus {
            Branches => {
                let count = view.and_then(|view| Some(view.tree?.branches().len()));
                Some((&mut self.branch, count))
            }
            Remedies => Some((&mut self.remedy, view.map(|view| view.trials().len()))),
            Diagnosis if matches!(step, PageUp | PageDown) => {
                Some((&mut self.scroll, Some(usize::MAX)))
            }
            Diagnosis => Some((&mut self.answer, answers)),
            _ => None,
        };
        if let Some((at, length)) = list {
            let last = length.unwrap_or(0).saturating_sub(1);
            *at = moved(*at, step, count, last, [Up, Down]);
            return None;
        }
        let order = view.map(|view| self.order(view)).unwrap_or_default();
        let last = order.len().saturating_sub(1);
        let here = order.iter().position(|slave| *slave == self.selected);
        let row = |row: usize| order.get(row).copied().unwrap_or(0);
        let to = |by: isize| {
            let to = here
                .unwrap_or(0)
                .saturating_add_signed(by.saturating_mul(count));
            row(to.min(last))
        };
        match (self.panes.focus, step) {
            (Shape, Left) => self.camera = self.camera.panned(-1.0, 0.0),
            (Shape, Right) => self.camera = self.camera.panned(1.0, 0.0),
            (Shape, Up) => self.camera = self.camera.panned(0.0, 1.0),
            (Shape, Down) => self.camera = self.camera.panned(0.0, -1.0),
            (Contact, Left) => self.turned = self.turned.wrapping_sub(1),
            (Contact, Right) => self.turned = self.turned.wrapping_add(1),
            (_, Up) => self.selected = to(-1),
            (_, Down) => self.selected = to(1),
            (_, PageUp) => self.selected = to(-PAGE),
            (_, PageDown) => self.selected = to(PAGE),
            (_, First) => self.selected = row(0),
            (_, Last) => self.selected = row(last),
            (_, Left | Right) => {}
        }
        None
    }
}

/// Repeats a trial in a branch, if it did not change the scene.
fn follow(app: &mut App, trial: &RemedyTrial, view: Option<&View>) -> Option<Effect> {
    let (label, steps) = (trial.label.clone(), trial.steps.clone());
    if let RemedyInput::Restart(_) = &trial.how {
        let option = trial.how.typed();
        app.complain(format!("{label} changes the scene: restart with {option}"));
        return None;
    }
    app.panes.zoomed = false;
    app.submit(Command::Follow { label, steps }, view)
}

/// The index after a step in a list with indices up to `last`; steps other than `back` and `forth` by one stay.
fn moved(at: usize, step: Step, count: isize, last: usize, [back, forth]: [Step; 2]) -> usize {
    let by = match step {
        First => return 0,
        Last => return last,
        PageUp => -PAGE,
        PageDown => PAGE,
        step if step == back => -count,
        step if step == forth => count,
        _ => 0,
    };
    at.saturating_add_signed(by).min(last)
}

/// The target of a step along the timeline; `None` for other steps.
fn along(step: Step, count: isize, view: &View) -> Option<usize> {
    let last = view.frames.len().saturating_sub(1);
    let steps = [Left, Right];
    (!matches!(step, Up | Down)).then(|| moved(view.cursor, step, count, last, steps))
}
