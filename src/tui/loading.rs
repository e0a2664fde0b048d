//! Loads files on a background thread, so that keys are handled while a large file or a slow disk is read.

use crate::chartpage::ChartPage;
use std::path::Path;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use stickslip_debugger::record::journal::{Journal, JournalError, Record};
use stickslip_debugger::teach::progress::ProgressStore;
use stickslip_debugger::teach::{lesson, play};
use stickslip_debugger::{Lesson, Session, Tutor};
use stickslip_platform::task;
use stickslip_scene::FileKind;

/// A loaded file.
pub enum LoadedFile {
    /// A session on a scene.
    Scene(Box<Session>),
    /// A lesson and the session on its scene.
    Lesson(Box<(Tutor, Session)>),
    /// A chart, loaded or measured.
    Chart(Box<ChartPage>),
}

/// A file that is being loaded; dropping this cancels it.
pub struct Loading {
    result: Receiver<Result<LoadedFile, String>>,
}

impl Loading {
    /// Opens a session on a scene (a file or a built-in name), or resumes a journal at its end.
    pub fn scene(name: &str) -> Loading {
        let name = name.to_owned();
        Loading::start(move || {
            let path = Path::new(&name);
            let session = match FileKind::from_file(path) {
                Some(FileKind::Journal) => resumed(path).map_err(|why| why.to_string()),
                _ => Session::open(&name),
            };
            Ok(LoadedFile::Scene(Box::new(session?)))
        })
    }

    /// Loads a lesson, by file or built-in name, and a session on its scene, at the step where the user left it.
    pub fn lesson(name: &str, progress: ProgressStore) -> Loading {
        let name = name.to_owned();
        Loading::start(move || {
            let (name, step) = lesson::split_step(&name);
            let lesson = Lesson::open(name).map_err(|why| why.to_string())?;
            if let Some(runs) = &lesson.runs {
                // Measured in the background, so that keys need not wait for it; an error is shown where the result is used.
                let _ = runs.measure();
            }
            let begun = play::begin(lesson, step, &progress);
            Ok(LoadedFile::Lesson(Box::new(begun)))
        })
    }

    /// Loads the table of a chart.
    pub fn chart(file: &str) -> Loading {
        let file = file.to_owned();
        Loading::start(move || {
            let page = ChartPage::open(&file).map_err(|why| why.to_string())?;
            Ok(LoadedFile::Chart(Box::new(page)))
        })
    }

    fn start(read: impl FnOnce() -> Result<LoadedFile, String> + Send + 'static) -> Loading {
        let (sender, result) = channel();
        task::spawn(move || {
            // The receiver may be gone.
            let _ = sender.send(read());
        });
        Loading { result }
    }

    /// The result, once it is available.
    pub fn result(&self) -> Option<Result<LoadedFile, String>> {
        match self.result.try_recv() {
            Ok(loaded) => Some(loaded),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("internal error while loading the file".into()))
            }
        }
    }
}

/// Replays a journal to its end; the session continues the journal.
fn resumed(file: &Path) -> Result<Session, JournalError> {
    // The lock keeps other processes from continuing the journal during the replay.
    let mut journal = Journal::open(file)?;
    let record = Record::read(file)?;
    let mut session = record.replay()?;
    journal.cut(record.whole_bytes)?;
    session.journal_mut().write_to(journal);
    Ok(session)
}
