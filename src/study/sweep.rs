//! Sweeps: cells that are computed side by side, stored in a log, split into shards, and put together again.
//!
//! A [`Sweep`] lists its cells and knows how to compute one. [`Store`] holds the results that exist already: of a log, or of the
//! logs of all shards. What is put together depends neither on the order of the files nor on how often a cell is in them.

use super::log::{self, Disagreement, Found, Log, LogError, Outcome};
use super::one::{Spare, Watch};
use super::shard::{Key, Shard};
use super::sweep_input::Input;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};
use stickslip_scene::format::SceneError;

/// A scene is read by recursion; as much stack as a program starts with is enough for all that it accepts.
const STACK: usize = 8 << 20;

/// Why a sweep could not be run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The threads cannot be started.
    #[error("no threads to run on: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A scene is unsound.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The results cannot be kept, or taken up.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// A cell of a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Hash of all that the result depends on. Cells with the same key have the same result.
    pub key: Key,
    /// Hash that chooses the shard: cells that are compared with each other have the same one.
    pub shard: u64,
    /// Units of progress.
    pub steps: u64,
}

/// Computes a cell; `None` if it was stopped from outside.
type Compute<'a, T> = dyn Fn(usize, &Spare, &Watch) -> Result<Option<T>, RunError> + Sync + 'a;

/// Cells that are computed one by one.
pub struct Sweep<'a, T> {
    /// All that the results depend on.
    pub input: Input,
    /// In the order of the table.
    pub cells: Vec<Cell>,
    /// What cells and units of progress are called.
    pub units: [&'static str; 2],
    /// Whether cells are timed, and therefore computed one at a time.
    pub is_timed: bool,
    /// Number of runs that each result has.
    pub runs: usize,
    /// What a cell is called.
    pub name: Box<dyn Fn(usize) -> String + Sync + 'a>,
    /// Computes a cell.
    pub compute: Box<Compute<'a, T>>,
}

/// Where results are kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Keeping {
    /// In a file, if there is one; a shard of the cells is computed.
    Log(Option<PathBuf>, Shard),
    /// In files that are there; nothing is computed.
    Merge(Vec<PathBuf>),
}

/// The results of a sweep's cells that exist already.
pub struct Store<T> {
    found: HashMap<Key, Found<T>>,
    log: Option<Log>,
    /// What is computed here; nothing where files are put together.
    shard: Option<Shard>,
    /// The files that were put together, each with the shards that it is of.
    files: Vec<(PathBuf, Vec<Shard>)>,
    /// Kinds of the machines that computed them.
    machines: BTreeSet<String>,
}

/// Cells without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Their numbers, from 0.
    pub cells: Vec<usize>,
    /// The shards that they fall to, each with the file that has a part of it, where there is one.
    pub shards: Vec<(Shard, Option<PathBuf>)>,
}

/// Computes a number of results, each on one thread, in their order.
///
/// # Errors
/// If there are no threads to be had, or a result is an error.
pub fn side_by_side<T: Send>(
    jobs: NonZeroUsize,
    count: usize,
    compute: impl Fn(usize) -> Result<T, RunError> + Send + Sync,
) -> Result<Vec<T>, RunError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.get().min(count.max(1)))
        .stack_size(STACK)
        .build()?;
    // One by one: cells differ much in what they cost, and the first ones are to be done first.
    let all = (0..count).into_par_iter().with_max_len(1);
    pool.install(|| all.map(compute).collect())
}

impl<T: Outcome> Sweep<'_, T> {
    /// Computes all cells, and keeps no result.
    ///
    /// # Errors
    /// If there are no threads to be had, or a scene is unsound. What fails in a run is its result.
    pub fn run(&self, jobs: NonZeroUsize, watch: &Watch) -> Result<Vec<Option<T>>, RunError> {
        let store = Store::open(&Keeping::Log(None, Shard::WHOLE), self)?;
        self.run_with(&store, jobs, watch)
    }

    /// Computes those cells that are to be computed here and have no result yet; `None` for the others.
    ///
    /// # Errors
    /// As [`Sweep::run`], and if a result cannot be kept or is of another sweep.
    pub fn run_with(
        &self,
        store: &Store<T>,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Vec<Option<T>>, RunError> {
        let spare = Spare::default();
        let one = |k: usize| -> Result<Option<T>, RunError> {
            let cell = &self.cells[k];
            if let Some(found) = store.found.get(&cell.key) {
                self.check(store, found)?;
                (watch.done)(cell.steps);
                return Ok(Some(found.value.clone()));
            }
            if !store.does(cell) {
                return Ok(None);
            }
            let outcome = (self.compute)(k, &spare, watch)?;
            if let (Some(log), Some(outcome)) = (&store.log, &outcome)
                && outcome.is_over()
            {
                log.keep(cell.key, outcome)?;
            }
            Ok(outcome)
        };
        let jobs = if self.is_timed {
            NonZeroUsize::MIN
        } else {
            jobs
        };
        side_by_side(jobs, self.cells.len(), one)
    }

    /// Units of progress of all cells.
    pub fn steps(&self) -> u64 {
        self.cells.iter().map(|cell| cell.steps).sum()
    }

    fn check(&self, store: &Store<T>, found: &Found<T>) -> Result<(), LogError> {
        let (has, wants) = (found.value.runs(), self.runs);
        if has == wants {
            return Ok(());
        }
        let path = match (&store.log, store.files.first()) {
            (Some(log), _) => log.path(),
            (None, first) => first.map_or(Path::new(""), |(path, _)| path),
        };
        let message = format!("it is of {has} trials, and its problem has {wants}");
        Err(LogError::broken(path, found.line, message))
    }
}

impl<T: Outcome> Store<T> {
    /// Opens what there is.
    ///
    /// # Errors
    /// If a file cannot be read or written, is of another sweep, or contradicts another one.
    pub fn open(keeping: &Keeping, sweep: &Sweep<'_, T>) -> Result<Store<T>, LogError> {
        let mut store = Store {
            found: HashMap::new(),
            log: None,
            shard: None,
            files: Vec::new(),
            machines: BTreeSet::new(),
        };
        match keeping {
            Keeping::Log(path, shard) => {
                store.shard = Some(*shard);
                if let Some(path) = path {
                    let input = sweep.input.clone().with(*shard);
                    let (log, content) = Log::open(path, &input)?;
                    // Earlier revisions wrote logs that several maps share; they do not say what they are of.
                    let is_shared = content.inputs.is_empty() && !content.results.is_empty();
                    if !is_shared && !content.inputs.contains(&input) {
                        log.name(&input)?;
                    }
                    store.found = content.results.into_iter().collect();
                    store.log = Some(log);
                }
            }
            Keeping::Merge(paths) => store.merge(paths, sweep)?,
        }
        Ok(store)
    }

    fn merge(&mut self, paths: &[PathBuf], sweep: &Sweep<'_, T>) -> Result<(), LogError> {
        let keys = sweep.cells.iter().map(|cell| cell.key);
        let numbers: HashMap<Key, usize> = keys.zip(0..).collect();
        let mut places: HashMap<Key, usize> = HashMap::new();
        for (file, path) in paths.iter().enumerate() {
            let content = log::read::<T>(path, &sweep.input)?;
            let is_shared = content.inputs.is_empty();
            for (key, found) in content.results {
                let Some(&number) = numbers.get(&key) else {
                    if is_shared {
                        continue;
                    }
                    let message = "it is of no cell that is wanted".to_owned();
                    return Err(LogError::broken(path, found.line, message));
                };
                let Some(before) = self.found.get_mut(&key) else {
                    places.insert(key, file);
                    self.found.insert(key, found);
                    continue;
                };
                before.value = before.value.join(&found.value).ok_or_else(|| {
                    let first = places.get(&key).map_or(file, |first| *first);
                    Box::new(Disagreement {
                        cell: (sweep.name)(number),
                        first: (paths[first].clone(), before.line),
                        second: (path.clone(), found.line),
                    })
                })?;
            }
            let machines = content
                .inputs
                .iter()
                .map(|input| input.machine().to_owned());
            self.machines.extend(machines);
            let shards = content.inputs.iter().filter_map(Input::shard).collect();
            self.files.push((path.clone(), shards));
        }
        Ok(())
    }

    /// Whether a cell is computed here, or was.
    pub fn does(&self, cell: &Cell) -> bool {
        self.shard.is_some_and(|shard| shard.has(cell.shard))
    }

    /// Whether there was a result of a cell before.
    pub fn has(&self, cell: &Cell) -> bool {
        self.found.contains_key(&cell.key)
    }

    /// Kinds of the machines that computed what was put together.
    pub fn machines(&self) -> impl Iterator<Item = &str> {
        self.machines.iter().map(String::as_str)
    }

    /// What is missing to a whole, where files were put together; `None` where nothing is.
    pub fn missing(&self, cells: &[Cell]) -> Option<Missing> {
        let absent: Vec<usize> = (0..cells.len()).filter(|&k| !self.has(&cells[k])).collect();
        if self.shard.is_some() || absent.is_empty() {
            return None;
        }
        let of = self.usual();
        let numbers: BTreeSet<u64> = absent.iter().map(|&k| 1 + cells[k].shard % of).collect();
        let shards = numbers.into_iter().filter_map(|number| {
            let shard = Shard::new(number, of.get())?;
            let file = self.files.iter().find(|(_, own)| own.contains(&shard));
            Some((shard, file.map(|(path, _)| path.clone())))
        });
        Some(Missing {
            shards: shards.collect(),
            cells: absent,
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
