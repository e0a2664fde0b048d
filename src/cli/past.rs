//! A run that is over, by the name of its file: of CalculiX by its .cel, or of an attached solver by the exchange that was kept.

use super::base::Error;
use crate::attach::past::{self, Opened};
use crate::explain::past::run::Past;
use crate::explain::past::words;
use crate::outside::{calculix, shown};
use std::path::Path;

/// The run that a file name stands for; `None` where it is the name of something else.
///
/// # Errors
/// If it cannot be read, or the name is that of a file beside the .cel.
pub fn named(name: &str) -> Result<Option<Past>, Error> {
    if let Some(cel) = calculix::cel_of(name) {
        let cel = shown::cut(&cel.display().to_string(), 120);
        let name = shown::cut(name, 120);
        return Err(Error::Usage(format!(
            "{name}: this lies beside the contact elements of a CalculiX run, and is read with them: `stickslip {cel}`"
        )));
    }
    if !calculix::is_cel(name) {
        return Ok(None);
    }
    let run = calculix::read(Path::new(name)).map_err(|why| Error::Usage(why.to_string()))?;
    Ok(Some(Past::new(name, run)))
}

/// The kept exchange that a file name stands for; `None` where it is the name of something else.
///
/// # Errors
/// If it is damaged.
pub fn kept(name: &str) -> Result<Option<Opened>, Error> {
    let opened = past::file(name).transpose();
    opened.map_err(|why| Error::Usage(why.of(name)))
}

/// Why something cannot be asked for with a run that is over.
pub fn read_only(asked: &str) -> String {
    format!("{asked} does not go with it; it is {}", words::READ_ONLY)
}
