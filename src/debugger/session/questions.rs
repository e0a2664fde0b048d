//! Questions about the shown state that the background thread answers, and snapshots of it.

use super::background_messages::BetweenRuns;
use super::exports::{Export, PictureContext};
use super::machine::Session;
use crate::explain::report;
use crate::explain::reported_pushes;
use crate::history::run_report::run_report;
use crate::record::export::export_state::OF_JOURNAL;
use crate::record::export::{self, ExportSource, Origin};
use crate::record::snapshot;
use crate::refusal::Refusal;
use crate::{DiagnosisPage, Examination, ExportScope, PointKind, Snapshot};
use std::path::PathBuf;
use stickslip_core::Status;
use stickslip_platform::files;

impl Session {
    /// Requests what is not known yet: the pushes on a slave node in the shown minor iteration, the worst point of the solids and,
    /// if the iteration closed a cycle, the diagnosis. [`Background`](super::background::Background) collects the answers.
    pub fn look(&mut self, slave: usize) {
        if self.is_running() {
            return;
        }
        if slave < self.model().contacts.len() {
            self.look_at(slave);
        }
        if self.model().has_solids() {
            let u = &self.timeline.frame().state.u;
            self.background.ask_worst_point(u);
        }
    }

    /// Has the pushes on nodes in the shown minor iteration computed even if this needs a second solver of a large scene.
    pub fn demand_pushes(&mut self) {
        self.background.demand_pushes(self.timeline.place());
    }

    fn look_at(&mut self, slave: usize) {
        let timeline = &self.timeline;
        let place = timeline.place();
        if timeline.strip().kind == PointKind::Cycle && self.background.examination(place).is_none()
        {
            self.census(&[]);
        }
        let timeline = &self.timeline;
        let Some(before) = timeline.minor_before() else {
            return;
        };
        let is_attached = self.connection.log().is_some();
        if is_attached
            && !reported_pushes::are_available(timeline.model(), self.connection.capabilities())
        {
            return self.background.pushes_unknown(place, slave);
        }
        self.background.ask_pushes(place, slave, || {
            if is_attached {
                timeline.iterations(before).map(BetweenRuns::Reported)
            } else {
                Some(BetweenRuns::Path(timeline.push_path(before)))
            }
        });
    }

    /// Requests the cause of the cycle from the shown state, or else its consistent states; for these nodes
    /// only, if any are given.
    pub(super) fn census(&mut self, nodes: &[usize]) -> String {
        let (timeline, connection) = (&self.timeline, &mut self.connection);
        let reported = match connection.log() {
            Some(_) => timeline.reported(),
            None => timeline.warnings(),
        };
        let mut reply = String::new();
        let state = &timeline.frame().state;
        if state.status == Status::Finished && nodes.is_empty() && connection.log().is_none() {
            let end = timeline.cursor() + 1;
            let (strips, frames) = (&timeline.strips()[..end], &timeline.frames()[..end]);
            let (head, facts) = run_report(timeline.model(), strips, frames);
            let found = Examination {
                head,
                facts,
                ..Examination::default()
            };
            let page = DiagnosisPage::new(timeline.model(), found);
            self.background.set_examination(timeline.place(), page);
            return "the diagnosis (d) shows the report of the run".into();
        }
        // The solver moves to this state to report its problem, together with all changes made there.
        if connection.capabilities().problem {
            let way = connection.way_back(timeline, timeline.cursor());
            reply.extend(way.map(|way| way + "; "));
            connection.reach(Some(state).filter(|state| {
                let outside = state.outside.as_ref();
                outside.is_some_and(|outside| outside.asked.is_empty())
            }));
        }
        self.background
            .ask_examination(timeline.place(), state, nodes, reported);
        reply + "the diagnosis (d) will show the result"
    }

    /// Requests a file made from the shown state; [`Background::exported`](super::background::Background::exported) returns the result.
    pub(super) fn export(
        &mut self,
        what: ExportScope,
        file: PathBuf,
        overwrite: bool,
    ) -> Result<String, Refusal> {
        // Fails early if the file cannot be written, and leaves nothing behind.
        files::regular(&file)?;
        if what == ExportScope::Shown {
            let kind = export::kind(&file)?;
            if matches!(kind.made_of, ExportSource::Journal) {
                return Err(Refusal::new(OF_JOURNAL));
            }
            for part in kind.files(&file).map_err(Refusal::new)? {
                drop(files::Output::create(&part, overwrite)?);
            }
        }
        drop(files::Output::create(&file, overwrite)?);
        let frame = self.frame();
        let at = match &frame.event {
            Some(event) if matches!(frame.state.status, Status::Failed(_)) => event.position,
            _ => frame.state.next,
        };
        let mut origin = Origin::new(&self.scene, at, frame.state.major.target);
        let changed = self.timeline.applied().1;
        let words = changed
            .iter()
            .map(|a| report::intervention(self.model(), &a.intervention));
        origin.changes.extend(words);
        let reply = format!("writing {}", file.display());
        let state = Box::new(frame.state.clone());
        let shown = (what != ExportScope::Core).then(|| Box::new(self.picture_context()));
        self.background.ask_export(Export {
            shown,
            what,
            file,
            overwrite,
            origin,
            state,
        });
        Ok(reply)
    }

    /// The context of the shown state, for a picture.
    fn picture_context(&self) -> PictureContext {
        PictureContext {
            scene: self.scene.clone(),
            event: self.frame().event.clone(),
            strips: self.timeline.latest().to_vec(),
            last_major: self.timeline.major_start().cloned(),
        }
    }

    /// Writes a snapshot of the shown state.
    pub(super) fn snapshot(
        &self,
        file: Option<PathBuf>,
        overwrite: bool,
    ) -> Result<String, Refusal> {
        let (steps, applied) = self.timeline.applied();
        let frame = self.frame();
        let snapshot = Snapshot::take(
            &self.scene,
            &applied,
            steps,
            &frame.state,
            frame.event.as_deref(),
        );
        let at = self.timeline.position();
        let file = file.unwrap_or_else(|| snapshot::free_name(&self.scene.name, at));
        files::regular(&file)?;
        snapshot.write(&file, overwrite)?;
        Ok(format!("wrote {}", file.display()))
    }

    /// Tries all remedies from the shown state.
    pub(super) fn remedies(&mut self) -> String {
        if self.background.is_trying() {
            return "already trying remedies; Ctrl-C interrupts".into();
        }
        let state = &self.timeline.frame().state;
        self.background.ask_remedies(self.timeline.place(), state);
        // Each trial moves the solver elsewhere.
        self.connection.reach(None);
        "trying every remedy from here; Ctrl-C interrupts".into()
    }
}
