//! A finished CalculiX run, from its .cel and what lies beside it.

use std::fs::OpenOptions;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use stickslip_exchange::broken::Broken;
use stickslip_exchange::calculix::past::PastRun;
use stickslip_exchange::calculix::{cel, cvg, sta};
use stickslip_platform::input::{self, Unreadable};

/// Files of a run: contact elements, attempts, residuals.
const ENDS: [&str; 3] = ["cel", "sta", "cvg"];

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
pub fn read(path: &Path) -> Result<PastRun, String> {
    let cel = open(path).map_err(|why| why.of(&path.display().to_string()))?;
    let cel = cel::read(cel).map_err(|why| broken(path, &why))?;
    if cel.slaves.is_empty() {
        let path = path.display();
        return Err(format!(
            "{path}: there is no contact element in it, so there is nothing to show"
        ));
    }
    let sta = beside(path, ENDS[1], sta::read)?;
    let cvg = beside(path, ENDS[2], cvg::read)?;
    Ok(PastRun::new(cel, sta, cvg))
}

type Reader = BufReader<std::fs::File>;

/// Reads a file beside the .cel; `None` where there is none.
fn beside<T>(
    cel: &Path,
    end: &str,
    read: impl Fn(Reader) -> Result<T, Broken>,
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

fn broken(path: &Path, why: &Broken) -> String {
    let path = path.display();
    match why.at {
        Some((line, column)) => format!("{path}:{line}:{column}: {why}"),
        None => format!("{path}: {why}"),
    }
}
