//! Files in memory, with the part of the interface of `std::fs` that the program uses. The page puts files in ([`put`]) and takes
//! out what was written ([`take_changed`]). There are no folders: a folder is the start of a path.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs::TryLockError;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

#[derive(Default)]
struct Disk {
    files: BTreeMap<PathBuf, Content>,
    changed: BTreeSet<PathBuf>,
}

#[derive(Clone, Default)]
struct Content {
    bytes: Vec<u8>,
    modified: Duration,
}

static DISK: Mutex<Disk> = Mutex::new(Disk {
    files: BTreeMap::new(),
    changed: BTreeSet::new(),
});

fn disk() -> MutexGuard<'static, Disk> {
    DISK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

fn missing() -> io::Error {
    ErrorKind::NotFound.into()
}

impl Disk {
    fn change(&mut self, path: &Path) -> io::Result<&mut Vec<u8>> {
        let content = self.files.get_mut(path).ok_or_else(missing)?;
        content.modified = crate::clock::since_1970();
        self.changed.insert(path.to_owned());
        Ok(&mut content.bytes)
    }
}

/// Stores a file from the page, last changed at this time since 1970.
pub fn put(path: &Path, bytes: Vec<u8>, modified: Duration) {
    let content = Content { bytes, modified };
    disk().files.insert(plain(path), content);
}

/// Files written since the last call, with their bytes; `None` for a removed one.
pub fn take_changed() -> Vec<(PathBuf, Option<Vec<u8>>)> {
    let mut disk = disk();
    let changed = std::mem::take(&mut disk.changed);
    let bytes = |path: &Path| disk.files.get(path).map(|content| content.bytes.clone());
    changed
        .into_iter()
        .map(|path| {
            let bytes = bytes(&path);
            (path, bytes)
        })
        .collect()
}

/// An open file.
#[derive(Debug)]
pub struct File {
    path: PathBuf,
    /// Position of the next read; writes append.
    at: AtomicUsize,
}

impl File {
    /// Options to open a file.
    pub fn options() -> OpenOptions {
        OpenOptions::new()
    }

    /// Size and kind.
    ///
    /// # Errors
    /// If it was removed.
    pub fn metadata(&self) -> io::Result<Metadata> {
        metadata(&self.path)
    }

    /// Does nothing: no other program has the files.
    ///
    /// # Errors
    /// Never.
    pub fn try_lock(&self) -> Result<(), TryLockError> {
        Ok(())
    }

    /// Does nothing.
    ///
    /// # Errors
    /// Never.
    pub fn sync_all(&self) -> io::Result<()> {
        Ok(())
    }

    /// Does nothing.
    ///
    /// # Errors
    /// Never.
    pub fn sync_data(&self) -> io::Result<()> {
        Ok(())
    }

    /// Shortens or extends the file.
    ///
    /// # Errors
    /// If it was removed.
    pub fn set_len(&self, length: u64) -> io::Result<()> {
        let length = usize::try_from(length).map_err(io::Error::other)?;
        disk().change(&self.path)?.resize(length, 0);
        Ok(())
    }
}

impl Read for &File {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let disk = disk();
        let content = disk.files.get(&self.path).ok_or_else(missing)?;
        let at = self.at.load(Ordering::Relaxed);
        let mut rest = content.bytes.get(at..).unwrap_or_default();
        let count = rest.read(to)?;
        self.at.store(at + count, Ordering::Relaxed);
        Ok(count)
    }
}

impl Read for File {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        (&*self).read(to)
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (from, by) = match to {
            SeekFrom::Start(at) => (at, 0),
            SeekFrom::Current(by) => (self.at.load(Ordering::Relaxed) as u64, by),
            SeekFrom::End(by) => (self.metadata()?.len(), by),
        };
        let at = from
            .checked_add_signed(by)
            .ok_or(io::Error::from(ErrorKind::InvalidInput))?;
        let place = usize::try_from(at).map_err(io::Error::other)?;
        self.at.store(place, Ordering::Relaxed);
        Ok(at)
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        disk().change(&self.path)?.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// How to open a file.
#[derive(Debug, Clone, Default)]
pub struct OpenOptions {
    creates: bool,
    must_be_new: bool,
    truncates: bool,
}

impl OpenOptions {
    /// Opens an existing file.
    pub fn new() -> OpenOptions {
        OpenOptions::default()
    }

    /// Has no effect: every file can be read.
    pub fn read(&mut self, _: bool) -> &mut Self {
        self
    }

    /// Has no effect: every file can be written.
    pub fn write(&mut self, _: bool) -> &mut Self {
        self
    }

    /// Has no effect: writes always append.
    pub fn append(&mut self, _: bool) -> &mut Self {
        self
    }

    /// Creates the file if it does not exist.
    pub fn create(&mut self, creates: bool) -> &mut Self {
        self.creates = creates;
        self
    }

    /// Creates the file, which must not exist.
    pub fn create_new(&mut self, new: bool) -> &mut Self {
        self.must_be_new = new;
        self
    }

    /// Empties the file.
    pub fn truncate(&mut self, truncates: bool) -> &mut Self {
        self.truncates = truncates;
        self
    }

    /// Opens a file.
    ///
    /// # Errors
    /// If it does not exist and is not created, or exists and must not.
    pub fn open(&self, path: impl AsRef<Path>) -> io::Result<File> {
        let path = plain(path.as_ref());
        let mut disk = disk();
        let exists = disk.files.contains_key(&path);
        match exists {
            true if self.must_be_new => return Err(ErrorKind::AlreadyExists.into()),
            false if !self.creates && !self.must_be_new => return Err(missing()),
            false => drop(disk.files.insert(path.clone(), Content::default())),
            true => {}
        }
        if self.truncates || !exists {
            disk.change(&path)?.clear();
        }
        Ok(File {
            path,
            at: AtomicUsize::new(0),
        })
    }
}

/// Size and kind of a file or folder.
#[derive(Debug, Clone)]
pub struct Metadata {
    length: Option<u64>,
    modified: Duration,
}

impl Metadata {
    /// Whether it is a file.
    pub fn is_file(&self) -> bool {
        self.length.is_some()
    }

    /// Whether it is a folder.
    pub fn is_dir(&self) -> bool {
        self.length.is_none()
    }

    /// Size in bytes; 0 for a folder.
    #[allow(clippy::len_without_is_empty)] // as in std::fs
    pub fn len(&self) -> u64 {
        self.length.unwrap_or(0)
    }

    /// Time of the last change, since 1970.
    ///
    /// # Errors
    /// Never.
    pub fn modified(&self) -> io::Result<Duration> {
        Ok(self.modified)
    }

    /// Kind.
    pub fn file_type(&self) -> FileType {
        FileType(self.is_dir())
    }
}

/// Kind of a file; the value is whether it is a folder.
#[derive(Debug, Clone, Copy)]
pub struct FileType(bool);

impl FileType {
    /// Whether it is a folder.
    pub fn is_dir(&self) -> bool {
        self.0
    }

    /// Whether it is a file.
    pub fn is_file(&self) -> bool {
        !self.0
    }
}

/// Size and kind of a file or folder.
///
/// # Errors
/// If it does not exist.
pub fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let path = plain(path.as_ref());
    let disk = disk();
    let is_folder = || disk.files.keys().any(|file| file.starts_with(&path));
    match disk.files.get(&path) {
        Some(content) => Ok(Metadata {
            length: Some(content.bytes.len() as u64),
            modified: content.modified,
        }),
        None if is_folder() => Ok(Metadata {
            length: None,
            modified: Duration::ZERO,
        }),
        None => Err(missing()),
    }
}

/// The path without `.` and `..`.
///
/// # Errors
/// If it does not exist.
pub fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    metadata(&path)?;
    Ok(plain(path.as_ref()))
}

/// An entry of a folder.
#[derive(Debug, Clone)]
pub struct DirEntry(PathBuf);

impl DirEntry {
    /// Path.
    pub fn path(&self) -> PathBuf {
        self.0.clone()
    }

    /// Name in the folder.
    pub fn file_name(&self) -> OsString {
        self.0.file_name().unwrap_or_default().to_owned()
    }

    /// Size and kind.
    ///
    /// # Errors
    /// If it was removed.
    pub fn metadata(&self) -> io::Result<Metadata> {
        metadata(&self.0)
    }
}

/// The files in a folder.
///
/// # Errors
/// Never: an unknown folder is empty.
pub fn read_dir(
    folder: impl AsRef<Path>,
) -> io::Result<impl Iterator<Item = io::Result<DirEntry>>> {
    let folder = plain(folder.as_ref());
    let files = disk().files.keys().cloned().collect::<Vec<_>>();
    Ok(files
        .into_iter()
        .filter(move |file| file.parent() == Some(&folder))
        .map(|file| Ok(DirEntry(file))))
}

/// Does nothing: a folder exists with its first file.
///
/// # Errors
/// Never.
pub fn create_dir_all(_: impl AsRef<Path>) -> io::Result<()> {
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// If it does not exist.
pub fn remove_file(path: impl AsRef<Path>) -> io::Result<()> {
    let path = plain(path.as_ref());
    let mut disk = disk();
    disk.files.remove(&path).ok_or_else(missing)?;
    disk.changed.insert(path);
    Ok(())
}
