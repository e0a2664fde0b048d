//! Writes files completely or not at all, and overwrites existing ones only on request.

use crate::system;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use tempfile::NamedTempFile;

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file exists.
    #[error("{}: the file exists already", .0.display())]
    Exists(PathBuf),
    /// Writing failed.
    #[error("{}: the file cannot be written: {source}", path.display())]
    Failed {
        /// The file.
        path: PathBuf,
        /// The error from the system.
        source: io::Error,
    },
}

/// An unfinished file. It gets its name in [`finish`](Output::finish), and is removed if dropped before.
pub struct Output {
    target: PathBuf,
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
        let failed = |source| FileError::Failed {
            path: path.to_owned(),
            source,
        };
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
        if found.as_ref().is_some_and(|found| found.is_dir()) {
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
        let failed = |source| FileError::Failed {
            path: target.clone(),
            source,
        };
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

    /// Appends bytes.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), FileError> {
        self.write_all(bytes).map_err(|source| self.failed(source))
    }

    /// A write error with the file's name.
    pub fn failed(&self, source: io::Error) -> FileError {
        FileError::Failed {
            path: self.target.clone(),
            source,
        }
    }
}

/// Opens a device or a pipe for writing; fails at once for a pipe without a reader.
fn open_direct(path: &Path) -> io::Result<File> {
    let open = system::set_nonblocking(File::options().write(true)).open(path);
    let open = open.map_err(|error| match system::is_unread_pipe(&error) {
        true => io::Error::other("is a pipe without a reader"),
        false => error,
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
    fn failed(&self, source: io::Error) -> FileError {
        FileError::Failed {
            path: self.target.clone(),
            source,
        }
    }

    /// A copy (a hard link if possible) of the file that currently has the name; `None` if there is none.
    fn former(&self) -> Result<Option<NamedTempFile>, FileError> {
        if self.file.is_none() || !self.overwrite || !self.target.is_file() {
            return Ok(None);
        }
        let kept = |path: &Path| {
            // Some file systems have no hard links.
            std::fs::hard_link(&self.target, path)
                .or_else(|_| std::fs::copy(&self.target, path).map(drop))?;
            File::open(path)
        };
        let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
        let former = builder().make_in(folder(&self.target), kept);
        let former = former.map_err(|source| self.failed(source))?;
        let _ = former.as_file().try_lock();
        Ok(Some(former))
    }

    /// Gives the file its name.
    fn place(self) -> Result<(), FileError> {
        let Some(file) = self.file else {
            return Ok(());
        };
        let placed = match self.overwrite {
            true => file.persist(&self.target),
            false => file.persist_noclobber(&self.target),
        };
        placed.map(drop).map_err(|e| match e.error.kind() {
            io::ErrorKind::AlreadyExists if !self.overwrite => FileError::Exists(self.target),
            _ => FileError::Failed {
                path: self.target,
                source: e.error,
            },
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

/// Writes several files, all or none.
///
/// # Errors
/// As [`Output::create`] and [`Output::finish`].
pub fn write_all(files: &[(PathBuf, impl AsRef<[u8]>)], overwrite: bool) -> Result<(), FileError> {
    let mut outputs = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let mut output = Output::create(path, overwrite)?;
        output.append(bytes.as_ref())?;
        outputs.push(output);
    }
    finish_all(outputs)
}

/// Rejects paths that exist and are not regular files, whose writes could block.
///
/// # Errors
/// If it is not a regular file.
pub fn regular(path: &Path) -> Result<(), FileError> {
    let found = std::fs::metadata(path).ok();
    match found.and_then(|found| system::special_kind(found.file_type())) {
        None => Ok(()),
        Some(kind) => Err(FileError::Failed {
            path: path.to_owned(),
            source: io::Error::other(format!("is {kind}")),
        }),
    }
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
    let made = builder.tempfile_in(directory)?;
    // On file systems without locks, only the process number marks the file as in use.
    let _ = made.as_file().try_lock();
    Ok(made)
}

/// The folder of a file.
fn folder(target: &Path) -> &Path {
    let parent = target.parent().filter(|parent| *parent != Path::new(""));
    parent.unwrap_or(Path::new("."))
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
    let name = name.to_str()?.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
    let (number, random) = name.split_once('-')?;
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

/// A file name stem for a scene: its letters, digits, `-`, `_` and `.`.
pub fn stem(scene: &str) -> String {
    const MOST: usize = 64;
    let stem = Path::new(scene).file_stem().unwrap_or_default();
    let plain = |c: char| match c.is_alphanumeric() || "-_.".contains(c) {
        true => c,
        false => '_',
    };
    stem.to_string_lossy()
        .chars()
        .take(MOST)
        .map(plain)
        .collect()
}

/// Writes a whole file.
///
/// # Errors
/// As [`Output::create`] and [`Output::finish`].
pub fn write(path: &Path, text: impl AsRef<[u8]>, overwrite: bool) -> Result<(), FileError> {
    let mut output = Output::create(path, overwrite)?;
    output.append(text.as_ref())?;
    output.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(directory).unwrap();
        entries
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        let mut output = Output::create(&path, false).unwrap();
        output.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(output);
        assert!(names(directory.path()).is_empty());
        write(&path, "whole", false).unwrap();
        assert_eq!(names(directory.path()), ["a.csv"]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "whole");
    }

    #[test]
    fn several_files_appear_all_or_none_and_what_was_there_is_there_again() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let outputs = |overwrite: bool| {
            let made = ["a", "b", "c"].map(|name| {
                let mut output = Output::create(&at(name), overwrite).unwrap();
                output.write_all(b"new").unwrap();
                output
            });
            Vec::from(made)
        };
        let all = outputs(false);
        std::fs::write(at("c"), "somebody else's").unwrap();
        assert!(matches!(finish_all(all), Err(FileError::Exists(path)) if path == at("c")));
        assert_eq!(names(directory.path()), ["c"]);
        std::fs::write(at("a"), "old").unwrap();
        let all = outputs(true);
        std::fs::remove_file(at("c")).unwrap();
        std::fs::create_dir(at("c")).unwrap();
        assert!(finish_all(all).is_err());
        assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "old");
        assert!(!at("b").exists());
        std::fs::remove_dir(at("c")).unwrap();
        finish_all(outputs(true)).unwrap();
        let mut left = names(directory.path());
        left.sort();
        assert_eq!(left, ["a", "b", "c"]);
        assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "new");
    }

    #[test]
    fn a_dangling_link_gets_its_target_on_request_and_stays_a_link() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        symlink("sub/there.csv", at("first")).unwrap();
        symlink("first", at("link")).unwrap();
        assert!(matches!(
            write(&at("link"), "a", false),
            Err(FileError::Exists(_))
        ));
        for text in ["a", "b"] {
            write(&at("link"), text, true).unwrap();
            assert_eq!(std::fs::read_to_string(at("sub/there.csv")).unwrap(), text);
            assert!(at("link").is_symlink() && at("first").is_symlink());
        }
        symlink("nowhere/x", at("lost")).unwrap();
        assert!(write(&at("lost"), "a", true).is_err());
        symlink("loop", at("loop")).unwrap();
        assert!(write(&at("loop"), "a", true).is_err());
    }

    #[test]
    fn only_files_of_killed_runs_are_swept() {
        let directory = tempfile::tempdir().unwrap();
        let mut dead = std::process::Command::new("true").spawn().unwrap();
        dead.wait().unwrap();
        let ours = std::process::id();
        let abandoned = [
            format!(".stickslip-{}-aB3xYz.tmp", dead.id()),
            format!(".stickslip-{ours}-aB3xYz.tmp"),
        ];
        let others = [
            ".stickslip-1-aB3xYz.tmp".to_owned(),
            format!(".stickslip-{}-.tmp", dead.id()),
            format!(".stickslip-{}-a/b.tmp", dead.id()).replace('/', "."),
            ".stickslip-notes".to_owned(),
        ];
        let held = Output::create(&directory.path().join("held.csv"), false).unwrap();
        for name in abandoned.iter().chain(&others) {
            std::fs::write(directory.path().join(name), "half").unwrap();
        }
        write(&directory.path().join("a.csv"), "whole", false).unwrap();
        held.finish().unwrap();
        let mut left = names(directory.path());
        left.sort();
        let mut wanted = others.to_vec();
        wanted.extend(["a.csv".to_owned(), "held.csv".to_owned()]);
        wanted.sort();
        assert_eq!(left, wanted);
    }

    #[test]
    fn a_pipe_without_a_reader_fails_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let pipe = directory.path().join("pipe");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        assert!(
            write(&pipe, "a", false)
                .unwrap_err()
                .to_string()
                .contains("without a reader")
        );
        assert!(regular(&pipe).is_err() && regular(directory.path()).is_err());
        let reading = pipe.clone();
        let reader = std::thread::spawn(move || std::fs::read_to_string(reading).unwrap());
        while write(&pipe, "to a reader", false).is_err() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert_eq!(reader.join().unwrap(), "to a reader");
    }

    #[test]
    fn existing_files_are_replaced_only_on_request() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        write(&path, "first", false).unwrap();
        assert!(matches!(
            write(&path, "second", false),
            Err(FileError::Exists(_))
        ));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "first");
        write(&path, "second", true).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        let late = directory.path().join("late.csv");
        let output = Output::create(&late, false).unwrap();
        std::fs::write(&late, "somebody else's").unwrap();
        assert!(matches!(output.finish(), Err(FileError::Exists(_))));
        assert_eq!(std::fs::read_to_string(&late).unwrap(), "somebody else's");
        assert!(Output::create(directory.path(), true).is_err());
        assert!(Output::create(&directory.path().join("no/such/place"), false).is_err());
    }
}
