//! Recordings: finished runs that are opened to be viewed, by the name of their file.

use super::{calculix, past, story};
use stickslip_scene::calculix::cel_of;
use stickslip_scene::shown;

/// A finished run.
pub enum Recording {
    /// The exchange with an attached solver.
    Exchange(Box<past::Opened>),
    /// A CalculiX run.
    Calculix(Box<calculix::Opened>),
}

impl Recording {
    /// Opens the recording that a file name stands for; `None` where it is the name of something else.
    ///
    /// # Errors
    /// If it is damaged, or the name is that of a file next to a .cel.
    pub fn open(name: &str) -> Result<Option<Recording>, String> {
        if let Some(cel) = cel_of(name) {
            let cel = shown::cut(&cel.display().to_string(), 120);
            let name = shown::cut(name, 120);
            return Err(format!(
                "{name}: this file belongs to a CalculiX run, and is read with its contact elements: `stickslip {cel}`"
            ));
        }
        if let Some(run) = calculix::file(name) {
            return run.map(Box::new).map(Recording::Calculix).map(Some);
        }
        let exchange = past::file(name).transpose();
        let exchange = exchange.map_err(|why| why.to_string())?;
        Ok(exchange.map(Box::new).map(Recording::Exchange))
    }

    /// What it is.
    pub fn kind(&self) -> &'static str {
        match self {
            Recording::Exchange(_) => past::READ_ONLY,
            Recording::Calculix(_) => calculix::words::READ_ONLY,
        }
    }

    /// What the debugger says when it opens the run.
    pub fn greeting(&self) -> &'static str {
        match self {
            Recording::Exchange(_) => {
                "a kept exchange: all that the solver did, to be gone through; nothing can follow on it"
            }
            Recording::Calculix(_) => calculix::words::GREETING,
        }
    }

    /// It as text; `name` is the file's.
    pub fn text(&mut self, name: &str) -> String {
        match self {
            Recording::Exchange(opened) => story::story(name, opened),
            Recording::Calculix(opened) => calculix::words::text(&opened.run),
        }
    }
}
