//! Output files on a disk: written to a temporary file that is renamed at the end.

use super::FileError;
use crate::system;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use tempfile::NamedTempFile;

/// An unfinished file. It gets its name in [`finish`](Output::finish), and is removed if dropped before.
pub struct Output {
    pub(super) target: PathBuf,
    overwrite: bool,
    to: OutputTarget,
}

enum OutputTarget {
    /// A temporary file in the target's folder, renamed at the end.
    Temporary(BufWriter<NamedTempFile>),
    /// A device or a pipe, written directly.
    Direct(BufWriter<File>),
}

impl Output {
    /// Creates a file.
    ///
    /// # Errors
    /// If it exists and `overwrite` is not set, or if its folder is not writable.
    pub fn create(path: &Path, overwrite: bool) -> Result<Output, FileError> {
        let failed = |source| FileError::new(path, source);
        let found = std::fs::metadata(path).ok();
        if let Some(found) = &found
            && !found.is_file()
            && !found.is_dir()
        {
            let open = open_direct(path).map_err(failed)?;
            return Ok(Output {
                target: path.to_owned(),
                overwrite,
                to: OutputTarget::Direct(BufWriter::new(open)),
            });
        }
        if found.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(failed(io::Error::other("is a directory")));
        }
        // A dangling link has no metadata, but must not be replaced without `overwrite` either.
        if (found.is_some() || path.is_symlink()) && !overwrite {
            return Err(FileError::Exists(path.to_owned()));
        }
        // A link is followed: its target is replaced or created, and the link stays.
        let target = followed(path).map_err(failed)?;
        let to = temporary_file(&target).map_err(failed)?;
        Ok(Output {
            target,
            overwrite,
            to: OutputTarget::Temporary(BufWriter::new(to)),
        })
    }

    /// Finishes the file and gives it its name.
    ///
    /// # Errors
    /// If it cannot be written completely, or if a file of that name has appeared in the meantime.
    pub fn finish(self) -> Result<(), FileError> {
        self.ready()?.place()
    }

    /// Syncs the file to disk, so that only its name is missing; a device or a pipe is complete then.
    fn ready(self) -> Result<ReadyFile, FileError> {
        let Output {
            target,
            overwrite,
            to,
        } = self;
        let failed = |source| FileError::new(&target, source);
        let file = match to {
            OutputTarget::Direct(mut file) => {
                file.flush().map_err(failed)?;
                None
            }
            OutputTarget::Temporary(file) => {
                let file = file.into_inner().map_err(|e| failed(e.into_error()))?;
                file.as_file().sync_all().map_err(failed)?;
                Some(file)
            }
        };
        Ok(ReadyFile {
            target,
            overwrite,
            file,
        })
    }
}

/// Opens a device or a pipe for writing; fails at once for a pipe without a reader.
fn open_direct(path: &Path) -> io::Result<File> {
    let open = system::set_nonblocking(File::options().write(true))
        .open(path)
        .map_err(|error| {
            if system::is_unread_pipe(&error) {
                io::Error::other("is a pipe without a reader")
            } else {
                error
            }
        })?;
    // Blocking writes, since the reader may be slow.
    system::set_blocking(&open)?;
    Ok(open)
}

/// A complete file without its name.
struct ReadyFile {
    target: PathBuf,
    overwrite: bool,
    /// `None` for a device or a pipe.
    file: Option<NamedTempFile>,
}

impl ReadyFile {
    /// A copy (a hard link if possible) of the file that currently has the name; `None` if there is none.
    fn former(&self) -> Result<Option<NamedTempFile>, FileError> {
        if self.file.is_none() || !self.overwrite || !self.target.is_file() {
            return Ok(None);
        }
        let kept = |path: &Path| {
            // Some file systems have no hard links.
            system::second_name(&self.target, path)
                .or_else(|_| std::fs::copy(&self.target, path).map(drop))?;
            File::open(path)
        };
        let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
        let former = builder()
            .make_in(folder(&self.target), kept)
            .map_err(|source| FileError::new(&self.target, source))?;
        let _ = former.as_file().try_lock();
        Ok(Some(former))
    }

    /// Gives the file its name.
    fn place(self) -> Result<(), FileError> {
        let Some(file) = self.file else {
            return Ok(());
        };
        let placed = if self.overwrite {
            file.persist(&self.target)
        } else {
            file.persist_noclobber(&self.target)
        };
        placed.map(drop).map_err(|e| match e.error.kind() {
            io::ErrorKind::AlreadyExists if !self.overwrite => FileError::Exists(self.target),
            _ => FileError::new(&self.target, e.error),
        })
    }
}

/// Finishes several files, all or none: no file takes its name before all are on the disk. If a file cannot take its name,
/// those that already have theirs are reverted. Data written to a device or a pipe stays.
///
/// # Errors
/// As [`Output::finish`].
pub fn finish_all(outputs: Vec<Output>) -> Result<(), FileError> {
    let ready: Result<Vec<ReadyFile>, FileError> = outputs.into_iter().map(Output::ready).collect();
    let ready = ready?;
    let formers: Result<Vec<_>, FileError> = ready.iter().map(ReadyFile::former).collect();
    let mut placed: Vec<(PathBuf, Option<NamedTempFile>)> = Vec::new();
    for (file, former) in ready.into_iter().zip(formers?) {
        let target = file.file.is_some().then(|| file.target.clone());
        if let Err(error) = file.place() {
            for (target, former) in placed {
                // A failure to revert is covered by the original error.
                let _ = match former {
                    Some(former) => former.persist(&target).map(drop).map_err(|e| e.error),
                    None => std::fs::remove_file(&target),
                };
            }
            return Err(error);
        }
        placed.extend(target.map(|target| (target, former)));
    }
    Ok(())
}

/// The path behind all symbolic links, which need not exist.
fn followed(path: &Path) -> io::Result<PathBuf> {
    /// The limit of common systems.
    const MOST_LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&target) {
            Ok(next) => target = target.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Prefix of temporary files, followed by the process number and a random part.
const PREFIX: &str = ".stickslip-";
const SUFFIX: &str = ".tmp";
/// Locked while temporary files are created, locked and swept, so that no thread removes a file that another one just created.
static MAKING: Mutex<()> = Mutex::new(());

/// A temporary file in the target's folder, so that it can be renamed to the target in one step.
fn temporary_file(target: &Path) -> io::Result<NamedTempFile> {
    let directory = folder(target);
    if target.file_name().is_none() {
        return Err(io::Error::other("not a file name"));
    }
    let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
    sweep(directory);
    // Temporary files are private by default; results get the usual permissions.
    let mut builder = builder();
    if let Some(usual) = system::usual_permissions() {
        builder.permissions(usual);
    }
    let made = builder.tempfile_in(directory).map_err(|why| {
        // The system's error would name the temporary file.
        let folder = directory.display();
        let what = match why.kind() {
            io::ErrorKind::NotFound if !directory.exists() => {
                format!("there is no folder {folder}")
            }
            // Folders of the system, such as /proc, refuse new files as if they did not exist.
            io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied => {
                format!("the folder {folder} is not writable")
            }
            io::ErrorKind::NotADirectory => format!("{folder} is not a folder"),
            _ => return why,
        };
        io::Error::new(why.kind(), what)
    })?;
    // On file systems without locks, only the process number marks the file as in use.
    let _ = made.as_file().try_lock();
    Ok(made)
}

/// The folder of a file.
fn folder(target: &Path) -> &Path {
    target
        .parent()
        .filter(|parent| *parent != Path::new(""))
        .unwrap_or(Path::new("."))
}

/// Builder of temporary files.
fn builder() -> tempfile::Builder<'static, 'static> {
    static NAME: LazyLock<String> = LazyLock::new(|| format!("{PREFIX}{}-", std::process::id()));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&*NAME).suffix(SUFFIX);
    builder
}

/// Removes the temporary files that killed runs have left in a folder: those of processes that have ended and that nobody has
/// locked. Errors are ignored, since such files may belong to other users.
fn sweep(directory: &Path) {
    let Ok(entries) = std::fs::read_dir(directory) else {
        return;
    };
    for entry in entries.flatten() {
        let abandoned = writer(&entry.file_name()).is_some_and(is_gone)
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        if !abandoned {
            continue;
        }
        let free = File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if free {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// The process number in the name of a temporary file.
fn writer(name: &OsStr) -> Option<i32> {
    let (number, random) = name
        .to_str()?
        .strip_prefix(PREFIX)?
        .strip_suffix(SUFFIX)?
        .split_once('-')?;
    let is_random = !random.is_empty() && random.chars().all(|c| c.is_ascii_alphanumeric());
    number.parse().ok().filter(|_| is_random)
}

/// Whether a process has ended. This process's own number may have been used by an earlier one, so its files count as abandoned
/// unless they are locked.
fn is_gone(process: i32) -> bool {
    process as u32 == std::process::id() || !system::is_running(process)
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.to {
            OutputTarget::Temporary(file) => file.write(bytes),
            OutputTarget::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.to {
            OutputTarget::Temporary(file) => file.flush(),
            OutputTarget::Direct(file) => file.flush(),
        }
    }
}
