//! A finished CalculiX run, from its .cel and what lies beside it.

use crate::outside::input::{self, Unreadable};
use std::fs::OpenOptions;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use stickslip_exchange::broken::Broken;
use stickslip_exchange::calculix::past::PastRun;
use stickslip_exchange::calculix::{cel, cvg, sta};

/// Files of a run: contact elements, attempts, residuals.
const ENDS: [&str; 3] = ["cel", "sta", "cvg"];

/// Why a run cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum NoRun {
    /// A file cannot be opened.
    #[error("{}", .why.of(&.file.display().to_string()))]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        why: Unreadable,
    },
    /// A file is not as it should be.
    #[error("{}{}: {why}", .file.display(), place(.why))]
    Broken {
        /// The file.
        file: PathBuf,
        /// What is wrong, and where.
        why: Broken,
    },
    /// There is no contact element.
    #[error("{}: there is no contact element in it, so there is nothing to show", .0.display())]
    Empty(PathBuf),
}

fn place(broken: &Broken) -> String {
    broken
        .at
        .map_or(String::new(), |(line, column)| format!(":{line}:{column}"))
}

/// Whether a file is called as CalculiX calls the contact elements of a run.
pub fn is_cel(name: &str) -> bool {
    ends(name, "cel")
}

/// Whether it is called as one of those beside them, and then what the .cel is called.
pub fn cel_of(name: &str) -> Option<PathBuf> {
    let beside = ENDS[1..].iter().any(|end| ends(name, end));
    beside.then(|| Path::new(name).with_extension(ENDS[0]))
}

fn ends(name: &str, end: &str) -> bool {
    let found = Path::new(name).extension();
    found.is_some_and(|found| found.eq_ignore_ascii_case(end))
}

/// Reads a run by its .cel; the .sta and the .cvg beside it need not be there.
///
/// # Errors
/// If a file is there and cannot be read, is not as it should be, or no contact element stands in the .cel.
pub fn read(path: &Path) -> Result<PastRun, NoRun> {
    let cel = open(path)?;
    let cel = cel::read(cel).map_err(|why| broken(path, why))?;
    if cel.slaves.is_empty() {
        return Err(NoRun::Empty(path.to_owned()));
    }
    let sta = beside(path, ENDS[1])?;
    let sta = sta.map(|(path, file)| sta::read(file).map_err(|why| broken(&path, why)));
    let cvg = beside(path, ENDS[2])?;
    let cvg = cvg.map(|(path, file)| cvg::read(file).map_err(|why| broken(&path, why)));
    Ok(PastRun::new(cel, sta.transpose()?, cvg.transpose()?))
}

type Reader = BufReader<std::fs::File>;

/// A file beside the .cel; `None` where there is none.
fn beside(cel: &Path, end: &str) -> Result<Option<(PathBuf, Reader)>, NoRun> {
    let path = cel.with_extension(end);
    match open(&path) {
        Ok(file) => Ok(Some((path, file))),
        Err(NoRun::Unreadable {
            why: Unreadable::Failed(error),
            ..
        }) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(other) => Err(other),
    }
}

fn open(path: &Path) -> Result<Reader, NoRun> {
    let file = input::open(path, OpenOptions::new().read(true));
    let file = file.map_err(|why| NoRun::Unreadable {
        file: path.to_owned(),
        why,
    })?;
    Ok(BufReader::with_capacity(1 << 16, file))
}

fn broken(path: &Path, why: Broken) -> NoRun {
    NoRun::Broken {
        file: path.to_owned(),
        why,
    }
}
