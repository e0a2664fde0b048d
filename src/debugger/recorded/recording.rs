//! Opens finished runs by file name, for viewing.

use super::{calculix, exchange, story};
use stickslip_scene::calculix::cel_of;
use stickslip_scene::shown;

/// A finished run.
pub enum Recording {
    /// The stored exchange with an attached solver.
    Exchange(Box<exchange::OpenedExchange>),
    /// A CalculiX run.
    Calculix(Box<calculix::OpenedRun>),
}

impl Recording {
    /// Opens the recording with this file name; `None` if the name is not that of a recording.
    ///
    /// # Errors
    /// If it is damaged, or belongs to a .cel.
    pub fn open(name: &str) -> Result<Option<Recording>, String> {
        if let Some(cel) = cel_of(name) {
            let cel = shown::cut(&cel.display().to_string(), 120);
            let name = shown::cut(name, 120);
            return Err(format!(
                "{name}: this file belongs to a CalculiX run; open the run with `stickslip {cel}`"
            ));
        }
        if let Some(run) = calculix::file(name) {
            return run.map(Box::new).map(Recording::Calculix).map(Some);
        }
        Ok(exchange::file(name)
            .transpose()
            .map_err(|why| why.to_string())?
            .map(Box::new)
            .map(Recording::Exchange))
    }

    /// Kind of the recording.
    pub fn kind(&self) -> &'static str {
        match self {
            Recording::Exchange(_) => exchange::READ_ONLY,
            Recording::Calculix(_) => calculix::words::READ_ONLY,
        }
    }

    /// Hint shown when the run is opened.
    pub fn greeting(&self) -> &'static str {
        match self {
            Recording::Exchange(_) => {
                "stored exchange (read-only): all iterations of the solver; it cannot be continued"
            }
            Recording::Calculix(_) => calculix::words::GREETING,
        }
    }

    /// The recording as text; `name` is that of the file.
    pub fn text(&mut self, name: &str) -> String {
        match self {
            Recording::Exchange(opened) => story::story(name, opened),
            Recording::Calculix(opened) => calculix::words::text(&opened.run),
        }
    }
}
