//! What is read for the debugger, on a thread of its own: a file can be large and its disk slow, and keys are answered all the
//! while.

use crate::chartpage::{ChartPage, NoPage};
use std::path::Path;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use stickslip_debugger::record::journal::{self, Journal, JournalError, Record};
use stickslip_debugger::session::Session;
use stickslip_debugger::teach::Lesson;
use stickslip_scene::format::SceneError;

/// Why a scene or a lesson cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum NotLoaded {
    /// The lesson is unsound.
    #[error(transparent)]
    Lesson(#[from] SceneError),
    /// The journal is not one, is in use, or leads elsewhere.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The scene is unsound, or the finished run is damaged.
    #[error("{0}")]
    Session(String),
    /// The thread that read has ended without an answer.
    #[error("reading it broke down")]
    BrokeDown,
}

/// What was read, or why it cannot be had.
pub enum Loaded {
    /// A scene, opened.
    Scene(Result<Box<Session>, NotLoaded>),
    /// A lesson with its scene, opened.
    Lesson(Result<Box<(Lesson, Session)>, NotLoaded>),
    /// A chart, read or measured.
    Chart(Result<Box<ChartPage>, NoPage>),
}

/// Something on its way; who drops it does not want it any more.
pub struct Loading {
    result: Receiver<Loaded>,
}

impl Loading {
    /// A session on a scene, by file or built-in name; on the scene of a journal, where that has led.
    pub fn scene(name: &str) -> Loading {
        let name = name.to_owned();
        Loading::of(move || {
            if journal::is_named_so(Path::new(&name)) {
                let session = resumed(Path::new(&name));
                return Loaded::Scene(session.map(Box::new).map_err(NotLoaded::from));
            }
            let session = Session::open(&name).map_err(NotLoaded::Session);
            Loaded::Scene(session.map(Box::new))
        })
    }

    /// A lesson, by file or built-in name, and a session on its scene.
    pub fn lesson(name: &str) -> Loading {
        let name = name.to_owned();
        Loading::of(move || {
            let lesson = Lesson::open(&name).map_err(NotLoaded::from);
            Loaded::Lesson(lesson.map(|lesson| {
                if let Some(runs) = &lesson.runs {
                    // Not while keys wait; what is wrong with it is told where it is asked for.
                    let _ = runs.measure();
                }
                let session = Session::new(lesson.scene.clone());
                Box::new((lesson, session))
            }))
        })
    }

    /// The table of a chart.
    pub fn chart(file: &str) -> Loading {
        let file = file.to_owned();
        Loading::of(move || Loaded::Chart(ChartPage::open(&file).map(Box::new)))
    }

    fn of(read: impl FnOnce() -> Loaded + Send + 'static) -> Loading {
        let (told, result) = channel();
        thread::spawn(move || {
            // Nobody may want it any more.
            let _ = told.send(read());
        });
        Loading { result }
    }

    /// What was read, once it is there.
    pub fn result(&self) -> Option<Loaded> {
        match self.result.try_recv() {
            Ok(loaded) => Some(loaded),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Loaded::Scene(Err(NotLoaded::BrokeDown))),
        }
    }
}

/// The session of a journal, done again to its end, which goes on with it.
fn resumed(file: &Path) -> Result<Session, JournalError> {
    // Nobody else may go on with it in the meantime.
    let mut journal = Journal::open(file)?;
    let record = Record::read(file)?;
    let mut session = record.replay()?;
    journal.cut(record.whole_bytes)?;
    session.keep(journal);
    Ok(session)
}
