//! Files that a session writes on command: snapshots and named journals.

use super::machine::{Reply, Session};
use super::refusal::Refusal;
use crate::record::journal::Journal;
use crate::record::snapshot::{Applied, Snapshot};
use std::path::PathBuf;
use stickslip_platform::files;

impl Session {
    /// Number of minor iterations up to the cursor, and the interventions among them.
    pub(super) fn record(&self) -> (u64, Vec<Applied>) {
        let (mut step, mut applied) = (0, Vec::new());
        for frame in &self.frames()[1..=self.cursor] {
            match &frame.intervention {
                Some(intervention) => applied.push(Applied {
                    step,
                    intervention: intervention.clone(),
                }),
                None => step += 1,
            }
        }
        (step, applied)
    }

    pub(super) fn snapshot(
        &self,
        file: Option<PathBuf>,
        overwrite: bool,
    ) -> Result<Reply, Refusal> {
        let (steps, applied) = self.record();
        let frame = self.frame();
        let snapshot = Snapshot::take(
            &self.scene,
            &applied,
            steps,
            &frame.state,
            frame.event.as_deref(),
        );
        let file = file.unwrap_or_else(|| self.free_name());
        files::regular(&file)?;
        snapshot.write(&file, overwrite)?;
        Ok(Reply(format!("wrote {}", file.display())))
    }

    /// `SCENE-INC.MAJOR.MINOR.ron` in the working directory, numbered if that exists.
    pub(super) fn free_name(&self) -> PathBuf {
        let scene = files::stem(self.scene_name());
        let at = match &self.frame().event {
            Some(event) => event.position,
            None => self.frame().state.next,
        };
        let stem = format!("{scene}-{}.{}.{}", at.increment, at.major, at.minor);
        let name = |k: u32| {
            PathBuf::from(if k == 0 {
                format!("{stem}.ron")
            } else {
                format!("{stem}-{k}.ron")
            })
        };
        (0..1000)
            .map(name)
            .find(|name| !name.exists())
            .unwrap_or_else(|| name(1000))
    }

    /// Starts a journal with all entries so far and continues it; without a file, reports the path of the
    /// current one.
    pub(super) fn begin_journal(&mut self, file: Option<PathBuf>) -> Result<Reply, Refusal> {
        let Some(file) = file else {
            return Ok(Reply(match (self.lost_journal(), self.journal()) {
                (_, Some(path)) => format!("the journal is written to {}", path.display()),
                (Some(why), _) => {
                    format!(
                        "the journal could not be written: {why}. :journal FILE starts a new one"
                    )
                }
                _ => "there is no journal yet; :journal FILE starts one".into(),
            }));
        };
        if !self.diary.is_kept() && self.tree.len(self.tree.current()) > 1 {
            return Err(Refusal::Forgotten);
        }
        let journal = Journal::create(&file, &self.scene, self.diary.entries())?;
        self.diary.keep(journal);
        let count = self.diary.entries().len();
        Ok(Reply(format!(
            "the journal is now written to {}, which already contains {count} entries",
            file.display()
        )))
    }
}
