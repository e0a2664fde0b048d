//! Destination of a table: a file or standard output.

use super::base::{Error, OutputState, say, usage};
use std::io::{self, Write};
use std::path::Path;
use stickslip_platform::files::Output;
use stickslip_scene::shown;

/// An open table.
pub enum Sink {
    /// Standard output, line by line.
    Standard,
    File(Box<Output>),
}

/// Whether a file has the extension of one that the program reads, and never of a table or record.
pub fn is_input(file: &str) -> bool {
    let extension = Path::new(file).extension();
    extension.is_some_and(|own| {
        ["ron", "inp"]
            .iter()
            .any(|known| own.eq_ignore_ascii_case(known))
    })
}

/// Refuses a name that belongs to a scene, deck or snapshot.
pub fn spare_inputs(file: &str) -> Result<(), Error> {
    if is_input(file) {
        return Err(usage!(
            "{file}: a scene, deck or snapshot has such a name, but something else is to be written; name another file"
        ));
    }
    Ok(())
}

impl Sink {
    /// Opens a file, or standard output for `-`.
    pub fn open(to: &str, overwrite: bool) -> Result<Sink, Error> {
        if to == "-" {
            return Ok(Sink::Standard);
        }
        spare_inputs(to)?;
        let output = Output::create(Path::new(to), overwrite)?;
        Ok(Sink::File(Box::new(output)))
    }

    /// Writes whole lines.
    pub fn send(&mut self, lines: &str) -> Result<OutputState, Error> {
        match self {
            Sink::Standard => say(lines),
            Sink::File(output) => match output.write_all(shown::text(lines).as_bytes()) {
                Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(OutputState::Closed),
                Err(e) => Err(output.failed(e).into()),
                Ok(()) => Ok(OutputState::Well),
            },
        }
    }

    /// The unfinished output file; `None` for standard output.
    pub fn into_file(self) -> Option<Output> {
        match self {
            Sink::Standard => None,
            Sink::File(output) => Some(*output),
        }
    }

    /// Finishes the table: a file gets its name.
    pub fn finish(self) -> Result<(), Error> {
        match self {
            Sink::Standard => Ok(()),
            Sink::File(output) => Ok(output.finish()?),
        }
    }
}
