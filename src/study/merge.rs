//! Where the results of a sweep's cells come from and go to: nowhere, one file that outlives a kill, one of many shards, or all
//! files of the shards put together.
//!
//! A sweep asks [`Kept::get`] for each of its cells, [`Kept::does`] whether it is to be computed here, and hands what it
//! computed to [`Kept::keep`]. What is put together depends neither on the order of the files nor on how often a cell is in them.

use super::log::{self, Disagreement, Found, Log, LogError};
use super::shard::{Key, Shard};
use super::sweep_input::Input;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

/// Where results are kept.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Keeping {
    /// Nowhere.
    #[default]
    Nowhere,
    /// In a file that may have results of other sweeps, too.
    Beside(PathBuf),
    /// In a file of this sweep, of which a part is computed.
    Shard(PathBuf, Shard),
    /// In files that are there; nothing is computed.
    Merge(Vec<PathBuf>),
}

/// What a sweep consists of.
pub struct Cells<'a> {
    /// One a cell, in the order of the table. Cells with the same key have the same result.
    pub keys: Vec<Key>,
    /// What they are called together.
    pub unit: &'static str,
    /// What a cell is called.
    pub name: &'a dyn Fn(usize) -> String,
}

/// How the results of one kind of sweep are read.
pub struct Reading<T> {
    /// The kind of results in a file.
    pub kind: log::ResultKind<T>,
    /// What two results of one cell come to; `None` where they contradict each other.
    pub join: fn(&T, &T) -> Option<T>,
}

/// The one of two results that are the same to the last bit.
pub fn same<T: Serialize + Clone>(one: &T, other: &T) -> Option<T> {
    #[cfg(mutants)]
    let other = crate::mutants::pick("merge-keeps-the-first-result", other, one);
    // Their text and not they, since a number that is none is not equal to itself.
    let text = |value: &T| ron::to_string(value).ok();
    (text(one) == text(other)).then(|| one.clone())
}

/// The results of a sweep's cells, as far as they are there.
pub struct Kept<T> {
    keys: Vec<Key>,
    unit: &'static str,
    found: HashMap<Key, Found<T>>,
    log: Option<Log>,
    is_sound: fn(&T) -> bool,
    /// What is computed here; nothing where files are put together.
    shard: Option<Shard>,
    /// The files that were put together, each with the shards that it is of.
    files: Vec<(PathBuf, Vec<Shard>)>,
    /// Kinds of the machines that computed them.
    machines: BTreeSet<String>,
}

/// Cells that nobody has done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Their numbers, from 0.
    pub cells: Vec<usize>,
    /// The shards that they fall to, each with the file that has a part of it, where there is one.
    pub shards: Vec<(Shard, Option<PathBuf>)>,
}

impl<T: Serialize + DeserializeOwned + Clone> Kept<T> {
    /// Opens what there is.
    ///
    /// # Errors
    /// If a file will not do, is of another sweep, or contradicts another one.
    pub fn open(
        keeping: &Keeping,
        input: impl FnOnce() -> Input,
        cells: Cells<'_>,
        reading: &Reading<T>,
    ) -> Result<Kept<T>, LogError> {
        let mut kept = Kept {
            keys: Vec::new(),
            unit: cells.unit,
            found: HashMap::new(),
            log: None,
            is_sound: reading.kind.is_sound,
            shard: Some(Shard::WHOLE),
            files: Vec::new(),
            machines: BTreeSet::new(),
        };
        match keeping {
            Keeping::Nowhere => {}
            Keeping::Beside(path) => {
                let (log, content) = Log::open(path, &reading.kind, None)?;
                kept.found = content.results.into_iter().collect();
                kept.log = Some(log);
            }
            Keeping::Shard(path, shard) => {
                let input = input().with(*shard);
                let (log, content) = Log::open(path, &reading.kind, Some(&input))?;
                if !content.inputs.contains(&input) {
                    log.name(&input)?;
                }
                kept.found = content.results.into_iter().collect();
                (kept.log, kept.shard) = (Some(log), Some(*shard));
            }
            Keeping::Merge(paths) => {
                kept.shard = None;
                kept.merge(paths, &input(), &cells, reading)?;
            }
        }
        kept.keys = cells.keys;
        Ok(kept)
    }

    fn merge(
        &mut self,
        paths: &[PathBuf],
        input: &Input,
        cells: &Cells<'_>,
        reading: &Reading<T>,
    ) -> Result<(), LogError> {
        let numbers: HashMap<Key, usize> = cells.keys.iter().copied().zip(0..).collect();
        let mut places: HashMap<Key, usize> = HashMap::new();
        for (file, path) in paths.iter().enumerate() {
            let content = log::read::<T>(path, &reading.kind, input)?;
            let others = content.inputs.is_empty();
            for (key, found) in content.results {
                let Some(&number) = numbers.get(&key) else {
                    // A file that does not say what it is of may have other results beside ours.
                    if others {
                        continue;
                    }
                    let message = "it is of no cell that is wanted".to_owned();
                    let (path, line) = (path.clone(), found.line);
                    return Err(LogError::Broken {
                        path,
                        line,
                        column: 1,
                        message,
                    });
                };
                let Some(before) = self.found.get_mut(&key) else {
                    places.insert(key, file);
                    self.found.insert(key, found);
                    continue;
                };
                before.value = (reading.join)(&before.value, &found.value).ok_or_else(|| {
                    let first = places.get(&key).map_or(file, |first| *first);
                    Box::new(Disagreement {
                        cell: (cells.name)(number),
                        first: (paths[first].clone(), before.line),
                        second: (path.clone(), found.line),
                    })
                })?;
            }
            let inputs = content.inputs.iter();
            self.machines
                .extend(inputs.clone().map(|input| input.machine().to_owned()));
            let shards = inputs.filter_map(Input::shard).collect();
            self.files.push((path.clone(), shards));
        }
        Ok(())
    }

    /// The result of a cell.
    pub fn get(&self, key: Key) -> Option<&Found<T>> {
        self.found.get(&key)
    }

    /// Whether a cell whose result is not there is to be computed here.
    pub fn does(&self, key: Key) -> bool {
        self.shard.is_some_and(|shard| shard.has(key))
    }

    /// What the cells are called together.
    pub fn unit(&self) -> &'static str {
        self.unit
    }

    /// The key of a cell.
    pub fn key(&self, cell: usize) -> Key {
        self.keys[cell]
    }

    /// Number of all cells.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there are no cells at all.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Keeps a result.
    ///
    /// # Errors
    /// If it cannot be written, or if a file with it could not be read again.
    pub fn keep(&self, key: Key, value: &T) -> Result<(), LogError> {
        match &self.log {
            None => Ok(()),
            Some(log) if (self.is_sound)(value) => log.keep(key, value),
            Some(log) => Err(LogError::Unsound(log.path().to_owned())),
        }
    }

    /// What is wrong with a result that was found.
    pub fn broken(&self, key: Key, message: &str) -> LogError {
        let line = self.found.get(&key).map_or(1, |found| found.line);
        let path = match (&self.log, self.files.first()) {
            (Some(log), _) => log.path(),
            (None, first) => first.map_or(Path::new(""), |(path, _)| path),
        };
        LogError::Broken {
            path: path.to_owned(),
            line,
            column: 1,
            message: message.to_owned(),
        }
    }

    /// Numbers of the cells that are computed here, or were.
    pub fn own(&self) -> impl Iterator<Item = usize> {
        let keys = self.keys.iter().enumerate();
        keys.filter(|(_, key)| self.does(**key)).map(|(k, _)| k)
    }

    /// How many of these were there before.
    pub fn there(&self) -> usize {
        self.own()
            .filter(|&k| self.found.contains_key(&self.keys[k]))
            .count()
    }

    /// Kinds of the machines that computed what was put together.
    pub fn machines(&self) -> impl Iterator<Item = &str> {
        self.machines.iter().map(String::as_str)
    }

    /// What is missing to a whole, where files were put together; `None` where nothing is.
    pub fn missing(&self) -> Option<Missing> {
        let absent = |k: &usize| !self.found.contains_key(&self.keys[*k]);
        let cells: Vec<usize> = (0..self.keys.len()).filter(absent).collect();
        if self.shard.is_some() || cells.is_empty() {
            return None;
        }
        let of = self.usual();
        let numbers: BTreeSet<u64> = cells.iter().map(|&k| self.keys[k].shard(of)).collect();
        let shards = numbers.into_iter().filter_map(|number| {
            let shard = Shard::new(number, of.get())?;
            let file = self.files.iter().find(|(_, own)| own.contains(&shard));
            Some((shard, file.map(|(path, _)| path.clone())))
        });
        Some(Missing {
            shards: shards.collect(),
            cells,
        })
    }

    /// The number of shards that most of the files are of; of equals the largest.
    fn usual(&self) -> NonZeroU64 {
        let mut counts: BTreeMap<NonZeroU64, usize> = BTreeMap::new();
        for shard in self.files.iter().flat_map(|(_, shards)| shards) {
            *counts.entry(shard.of()).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|&(of, count)| (count, of));
        most.map_or(NonZeroU64::MIN, |(of, _)| of)
    }
}
