//! Questions about the shown state that the background thread answers.

use super::background::{Background, BetweenRuns};
use super::exports::{Export, Seen};
use super::machine::{Reply, Session};
use super::refusal::Refusal;
use crate::explain::influence::PushPath;
use crate::explain::pushes_told::{self, Iterations};
use crate::explain::report;
use crate::history::frame::Frame;
use crate::history::rounds::{self, rounds};
use crate::history::strip::{PointKind, Strip};
use crate::history::tree::Tree;
use crate::record::command::Exported;
use crate::record::export::shown::{COLUMNS, ExportError};
use crate::record::export::{self, MadeOf, Origin};
use std::path::PathBuf;
use stickslip_core::step::state::Status;
use stickslip_platform::files;

impl Session {
    /// Results of the background thread.
    pub fn background(&self) -> &Background {
        &self.background
    }

    /// Collects new results of the background thread without blocking; returns whether there were any.
    pub fn gather_background(&mut self) -> bool {
        self.background.gather()
    }

    /// Blocks until the background thread has answered all requests.
    pub fn wait_for_background(&mut self) {
        self.background.wait();
    }

    /// Position of the cursor, the key of the results in [`Background`].
    pub fn place(&self) -> (usize, usize) {
        (self.tree.current(), self.cursor)
    }

    /// Requests what is not known yet: the pushes on a slave node in the shown minor iteration and, if that
    /// closed a cycle, the diagnosis. [`Session::gather_background`] collects the answers.
    pub fn look(&mut self, slave: usize) {
        if self.is_running() || slave >= self.model().contacts.len() {
            return;
        }
        let place = self.place();
        if self.strips()[self.cursor].kind == PointKind::Cycle
            && self.background.examination(place).is_none()
        {
            self.census(&[]);
        }
        let Some(before) = self.minor_before() else {
            return;
        };
        let (tree, cursor) = (&self.tree, self.cursor);
        let is_attached = self.log().is_some();
        if is_attached && !pushes_told::are_told(tree.model(), &self.offers) {
            return self.background.pushes_untold(place, slave);
        }
        self.background.ask_pushes(place, slave, || {
            if is_attached {
                return iterations(tree, before, cursor).map(BetweenRuns::Reported);
            }
            let from = tree.whole_before(before - 1);
            let frames = &tree.frames()[from..cursor];
            let steps = frames[1..].iter().map(|frame| frame.intervention.clone());
            Some(BetweenRuns::Path(PushPath {
                state: Box::new(frames[0].state.clone()),
                steps: steps.collect(),
                before: before - from - 1,
            }))
        });
    }

    /// The minor iteration before the shown one in the same frozen problem, as a step of the line.
    pub fn minor_before(&self) -> Option<usize> {
        let strips = self.strips();
        let shown = &strips[self.cursor];
        let before = (1..self.cursor)
            .rev()
            .find(|&at| strips[at].kind.is_solved())?;
        let of = |strip: &Strip| {
            let at = strip.position;
            (at.increment, at.attempt, at.major)
        };
        let same = of(&strips[before]) == of(shown)
            && matches!(
                strips[before].kind,
                PointKind::Minor | PointKind::Climbed | PointKind::Cycle | PointKind::Failed
            );
        (shown.kind.is_solved() && same).then_some(before)
    }

    /// Requests the cause of the cycle from the shown state, or else its consistent states; for these nodes
    /// only, if any are given.
    pub(super) fn census(&mut self, nodes: &[usize]) -> Reply {
        let place = self.place();
        let known = self.known_of_attached();
        let way = match self.offers.problem {
            true => self
                .back_to(self.cursor)
                .map_or(String::new(), |way| way + "; "),
            false => String::new(),
        };
        let state = &self.tree.frames()[self.cursor].state;
        // The solver moves to this state to report its problem, together with all changes made there.
        if self.offers.problem {
            let outside = state
                .outside
                .as_ref()
                .filter(|outside| outside.asked.is_empty());
            self.stands.at = outside.map(|outside| outside.place);
        }
        self.background.ask_examination(place, state, nodes, known);
        Reply(way + "the diagnosis (d) will show the result")
    }

    /// What the line shows about an attached solver up to the cursor: how it failed, and whether its modes
    /// repeat.
    fn known_of_attached(&self) -> Vec<String> {
        if self.log().is_none() {
            return Vec::new();
        }
        let what = match &self.frame().state.status {
            Status::Failed(failure) => Some(format!(
                "what: {}",
                report::describe_failure(self.model(), failure)
            )),
            _ => None,
        };
        let rounds = rounds(&self.strips()[..=self.cursor]);
        let place =
            rounds.map(|found| format!("where: {}", rounds::words(self.model(), &found, true)));
        what.into_iter().chain(place).collect()
    }

    /// Requests a file made from the shown state; [`Session::exported`] returns the result.
    pub(super) fn export(
        &mut self,
        what: Exported,
        file: PathBuf,
        overwrite: bool,
    ) -> Result<Reply, Refusal> {
        // Fails early if the file cannot be written, and leaves nothing behind.
        files::regular(&file)?;
        if what == Exported::Shown {
            let kind = export::kind(&file)?;
            if matches!(kind.made_of, MadeOf::Journal) {
                return Err(ExportError::OfJournal.into());
            }
            for part in kind.files(&file).map_err(ExportError::NoFile)? {
                drop(files::Output::create(&part, overwrite)?);
            }
        }
        drop(files::Output::create(&file, overwrite)?);
        let frame = self.frame();
        let at = match &frame.event {
            Some(event) if matches!(frame.state.status, Status::Failed(_)) => event.position,
            _ => frame.state.next,
        };
        let mut origin = Origin::of(&self.scene, at, frame.state.target);
        let changed = self.record().1;
        let words = changed
            .iter()
            .map(|a| report::intervention(self.model(), &a.intervention));
        origin.changes.extend(words);
        let told = format!("writing {}", file.display());
        let state = Box::new(frame.state.clone());
        let shown = (what != Exported::Core).then(|| Box::new(self.seen()));
        self.background.ask_export(Export {
            shown,
            what,
            file,
            overwrite,
            origin,
            state,
        });
        Ok(Reply(told))
    }

    /// The context of the shown state, for a picture.
    fn seen(&self) -> Seen {
        let (frames, strips) = (&self.frames()[..=self.cursor], self.strips());
        let strips = &strips[..=self.cursor];
        let begins = |frame: &&Frame| {
            let state = &frame.state;
            frame.is_whole() && state.next.minor == 1 && state.status == Status::Running
        };
        let last_major = frames.iter().rev().find(begins);
        // If the frame of its start was thinned, the whole frame found belongs to another major iteration.
        let ended = frames.last().and_then(|frame| frame.event.as_ref());
        let of_it = |frame: &&Frame| {
            let next = frame.state.next;
            ended.is_some_and(|event| {
                let at = event.position;
                (at.increment, at.attempt, at.major) == (next.increment, next.attempt, next.major)
            })
        };
        Seen {
            scene: self.scene.clone(),
            event: ended.cloned(),
            strips: strips[strips.len().saturating_sub(2 * COLUMNS)..].to_vec(),
            last_major: last_major.filter(of_it).map(|frame| frame.state.clone()),
        }
    }

    /// Result of the latest file written by [`Command::Export`](crate::record::command::Command::Export);
    /// returned once.
    pub fn exported(&mut self) -> Option<Result<Reply, Refusal>> {
        Some(
            self.background
                .exported()?
                .map(Reply)
                .map_err(Refusal::from),
        )
    }

    pub(super) fn remedies(&mut self) -> Reply {
        if self.background.is_trying() {
            return Reply("already trying remedies; Ctrl-C interrupts".into());
        }
        let place = self.place();
        let state = &self.tree.frames()[self.cursor].state;
        self.background.ask_remedies(place, state);
        // Each trial moves the solver elsewhere.
        self.stands.at = None;
        Reply("trying every remedy from here; Ctrl-C interrupts".into())
    }
}

/// Two minor iterations of the line, if all their frames are whole.
fn iterations(tree: &Tree, before: usize, shown: usize) -> Option<Iterations> {
    let frames = tree.frames();
    let whole = |at: usize| frames.get(at).filter(|frame| frame.is_whole());
    Some(Iterations {
        start: Box::new(whole(shown.checked_sub(1)?)?.state.clone()),
        found: [whole(before)?.event.clone()?, whole(shown)?.event.clone()?],
    })
}
