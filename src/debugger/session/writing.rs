//! What a session writes when it is told to: snapshots, and a journal in a file that is named.

use super::machine::{Reply, Session};
use super::refusal::Refusal;
use crate::record::journal::Journal;
use crate::record::snapshot::{Applied, Snapshot};
use std::path::PathBuf;
use stickslip_platform::files;

impl Session {
    /// Number of minor iterations done up to the cursor, and the interventions among them.
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

    /// `SCENE-INC.MAJOR.MINOR.ron` in the working directory, with a number where that exists.
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

    /// Begins a journal with all that was done, and goes on there; without a file, tells where it is.
    pub(super) fn begin_journal(&mut self, file: Option<PathBuf>) -> Result<Reply, Refusal> {
        let Some(file) = file else {
            return Ok(Reply(match (self.lost_journal(), self.journal()) {
                (_, Some(path)) => format!("the journal is {}", path.display()),
                (Some(why), _) => {
                    format!("the journal is lost: {why}; :journal FILE begins one")
                }
                _ => "there is no journal yet; :journal FILE begins one".into(),
            }));
        };
        if !self.diary.is_kept() && self.tree.len(self.tree.current()) > 1 {
            return Err(Refusal::Forgotten);
        }
        let journal = Journal::create(&file, &self.scene, self.diary.entries())?;
        self.diary.keep(journal);
        let count = self.diary.entries().len();
        Ok(Reply(format!(
            "the journal is {} from now on; {count} entries are in it already",
            file.display()
        )))
    }
}
