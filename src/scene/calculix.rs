//! Reads a finished CalculiX run: its .cel file and the files next to it.

use crate::SceneError;
pub use crate::deck::outline;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use stickslip_exchange::FormatError;
use stickslip_exchange::calculix::files::CalculixFiles;
use stickslip_exchange::calculix::{cel, cvg, frd, sta};
use stickslip_exchange::inp::Deck;
use stickslip_platform::disk::{File, OpenOptions};
use stickslip_platform::input::{self, Unreadable};

/// Extensions of a run's files: contact elements, attempts, residuals.
const ENDS: [&str; 3] = ["cel", "sta", "cvg"];

/// Whether a file has the name of a CalculiX contact element file.
pub fn is_cel(name: &str) -> bool {
    ends(name, "cel")
}

/// Whether a text begins like the contact elements of a CalculiX run.
pub fn is_contacts(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first.starts_with("*ELEMENT") && first.contains("=contactelements_st")
}

/// The .cel file that belongs to a .sta or .cvg file; `None` for other names.
pub fn cel_of(name: &str) -> Option<PathBuf> {
    let belongs = ENDS[1..].iter().any(|end| ends(name, end));
    belongs.then(|| Path::new(name).with_extension(ENDS[0]))
}

fn ends(name: &str, end: &str) -> bool {
    let found = Path::new(name).extension();
    found.is_some_and(|found| found.eq_ignore_ascii_case(end))
}

/// The outline of the deck next to a .cel file; `None` if there is none.
///
/// # Errors
/// If it cannot be read.
pub fn deck_of(cel: &Path) -> Result<Option<Deck>, SceneError> {
    let deck = cel.with_extension("inp");
    if deck.is_file() {
        outline(&deck.to_string_lossy()).map(Some)
    } else {
        Ok(None)
    }
}

/// Reads a run from its .cel file; the .sta and .cvg files are optional.
///
/// # Errors
/// If a file cannot be read or has errors, or if the .cel contains no contact element and there is no .cvg.
pub fn read(path: &Path) -> Result<CalculixFiles, String> {
    let cel = open(path).map_err(|why| why.of(&path.display().to_string()))?;
    let cel = cel::read(cel).map_err(|why| broken(path, &why))?;
    if cel.slaves.is_empty() && !path.with_extension(ENDS[2]).is_file() {
        let path = path.display();
        return Err(format!(
            "{path}: no contact elements in this file, so there is nothing to show"
        ));
    }
    let sta = read_sibling(path, ENDS[1], sta::read)?;
    let cvg = read_sibling(path, ENDS[2], cvg::read)?;
    Ok(CalculixFiles::new(cel, sta, cvg))
}

/// The contact pressures of the last result of a run, from its .frd; empty without one.
///
/// # Errors
/// If the file cannot be read.
pub fn pressures(cel: &Path) -> Result<Vec<(u32, f64)>, String> {
    read_sibling(cel, "frd", frd::pressures).map(Option::unwrap_or_default)
}

type Reader = BufReader<File>;

/// Reads a file next to the .cel; `None` if it does not exist.
fn read_sibling<T>(
    cel: &Path,
    end: &str,
    read: impl Fn(Reader) -> Result<T, FormatError>,
) -> Result<Option<T>, String> {
    let path = cel.with_extension(end);
    match open(&path) {
        Ok(file) => read(file).map(Some).map_err(|why| broken(&path, &why)),
        Err(Unreadable::Failed(error)) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(why) => Err(why.of(&path.display().to_string())),
    }
}

fn open(path: &Path) -> Result<Reader, Unreadable> {
    let file = input::open(path, OpenOptions::new().read(true))?;
    Ok(BufReader::with_capacity(1 << 16, file))
}

fn broken(path: &Path, why: &FormatError) -> String {
    let path = path.display();
    match why.at {
        Some((line, column)) => format!("{path}:{line}:{column}: {why}"),
        None => format!("{path}: {why}"),
    }
}
