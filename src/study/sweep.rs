//! Sweeps: cells that are computed in parallel, stored in a log, split into shards, and merged.
//!
//! A [`Sweep`] lists its cells and computes one of them. A [`Store`] contains the existing results, from one
//! log or from the logs of all shards. The merged result depends neither on the order of the files nor on how
//! often a cell occurs in them.

use super::log::{self, Log, Outcome, StoredResult};
use super::run_error::RunError;
use super::shard::{Key, Shard};
use super::solver_pool::{SolverPool, Watch};
use super::sweep_input::Input;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

/// Scenes are parsed recursively; the stack of a main thread is sufficient for all valid ones.
const STACK: usize = 8 << 20;

/// A cell of a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Hash of everything that the result depends on. Cells with the same key have the same result.
    pub key: Key,
    /// Hash that determines the shard: the same for cells that are compared with each other.
    pub shard: u64,
    /// Number of units of progress.
    pub steps: u64,
}

/// Computes a cell; `None` if interrupted.
type Compute<'a, T> = dyn Fn(usize, &SolverPool, &Watch) -> Result<Option<T>, RunError> + Sync + 'a;

/// Cells that are computed independently.
pub struct Sweep<'a, T> {
    /// Everything that the results depend on.
    pub input: Input,
    /// Cells in the order of the table.
    pub cells: Vec<Cell>,
    /// Names of cells and of units of progress.
    pub units: [&'static str; 2],
    /// Whether cells are timed, and therefore computed one at a time.
    pub is_timed: bool,
    /// Number of runs in each result.
    pub runs: usize,
    /// Name of a cell.
    pub name: Box<dyn Fn(usize) -> String + Sync + 'a>,
    /// Computes a cell.
    pub compute: Box<Compute<'a, T>>,
}

/// Where results are stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ResultStorage {
    /// In a file, if one is given; one shard of the cells is computed.
    Log(Option<PathBuf>, Shard),
    /// In existing files; nothing is computed.
    Merge(Vec<PathBuf>),
}

/// The existing results of a sweep's cells.
pub struct Store<T> {
    found: HashMap<Key, StoredResult<T>>,
    log: Option<Log>,
    /// The shard computed here; `None` when files are merged.
    shard: Option<Shard>,
    /// The merged files, each with the shards that it contains.
    files: Vec<(PathBuf, Vec<Shard>)>,
    /// The machines that computed them.
    machines: BTreeSet<String>,
}

/// Cells without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingCells {
    /// Their numbers, from 0.
    pub cells: Vec<usize>,
    /// Their shards, each with the file that contains a part of it, if there is one.
    pub shards: Vec<(Shard, Option<PathBuf>)>,
}

/// Computes results in parallel, each on one thread, and returns them in order.
///
/// # Errors
/// If the threads cannot be started, or a result is an error.
pub fn side_by_side<T: Send>(
    jobs: NonZeroUsize,
    count: usize,
    compute: impl Fn(usize) -> Result<T, RunError> + Send + Sync,
) -> Result<Vec<T>, RunError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.get().min(count.max(1)))
        .stack_size(STACK)
        .build()
        .map_err(|why| RunError::Again(format!("the threads cannot be started: {why}")))?;
    // One by one, because cells differ in cost and the first ones should be done first.
    let all = (0..count).into_par_iter().with_max_len(1);
    pool.install(|| all.map(compute).collect())
}

impl<T: Outcome> Sweep<'_, T> {
    /// Computes all cells without storing results.
    ///
    /// # Errors
    /// If the threads cannot be started, or a scene is invalid. The failure of a run is a result.
    pub fn run(&self, jobs: NonZeroUsize, watch: &Watch) -> Result<Vec<Option<T>>, RunError> {
        let store = Store::open(&ResultStorage::Log(None, Shard::WHOLE), self)?;
        self.run_with(&store, jobs, watch)
    }

    /// Computes the cells of this shard that have no result yet; `None` for the others.
    ///
    /// # Errors
    /// As [`Sweep::run`], and if a result cannot be stored or belongs to another sweep.
    pub fn run_with(
        &self,
        store: &Store<T>,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Vec<Option<T>>, RunError> {
        let spare = SolverPool::default();
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

    fn check(&self, store: &Store<T>, found: &StoredResult<T>) -> Result<(), RunError> {
        let (has, wants) = (found.value.runs(), self.runs);
        if has == wants {
            return Ok(());
        }
        let path = match (&store.log, store.files.first()) {
            (Some(log), _) => log.path(),
            (None, first) => first.map_or(Path::new(""), |(path, _)| path),
        };
        let message = format!("the result has {has} trials, but its problem has {wants}");
        Err(log::broken(path, (found.line, 1), &message))
    }
}

impl<T: Outcome> Store<T> {
    /// Opens the existing results.
    ///
    /// # Errors
    /// If a file cannot be read or written, belongs to another sweep, or contradicts another one.
    pub fn open(keeping: &ResultStorage, sweep: &Sweep<'_, T>) -> Result<Store<T>, RunError> {
        let mut store = Store {
            found: HashMap::new(),
            log: None,
            shard: None,
            files: Vec::new(),
            machines: BTreeSet::new(),
        };
        match keeping {
            ResultStorage::Log(path, shard) => {
                store.shard = Some(*shard);
                if let Some(path) = path {
                    let input = sweep.input.clone().with(*shard);
                    let (log, content) = Log::open(path, &input)?;
                    if !content.inputs.contains(&input) {
                        log.name(&input)?;
                    }
                    store.found = content.results.into_iter().collect();
                    store.log = Some(log);
                }
            }
            ResultStorage::Merge(paths) => store.merge(paths, sweep)?,
        }
        Ok(store)
    }

    fn merge(&mut self, paths: &[PathBuf], sweep: &Sweep<'_, T>) -> Result<(), RunError> {
        let numbers: HashMap<Key, usize> =
            sweep.cells.iter().map(|cell| cell.key).zip(0..).collect();
        let mut places: HashMap<Key, usize> = HashMap::new();
        for (file, path) in paths.iter().enumerate() {
            let content = log::read::<T>(path, &sweep.input)?;
            for (key, found) in content.results {
                let Some(&number) = numbers.get(&key) else {
                    let message = "none of its results belongs to this sweep";
                    return Err(log::broken(path, (found.line, 1), message));
                };
                let Some(before) = self.found.get_mut(&key) else {
                    places.insert(key, file);
                    self.found.insert(key, found);
                    continue;
                };
                before.value = before.value.join(&found.value).ok_or_else(|| {
                    let first = places.get(&key).map_or(file, |first| *first);
                    RunError::Incomparable(format!(
                        "{} has two results that differ: {}:{} and {}:{}; one of them was computed by another program or on another kind of machine",
                        (sweep.name)(number),
                        paths[first].display(),
                        before.line,
                        path.display(),
                        found.line
                    ))
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

    /// Whether a cell is or was computed here.
    pub fn does(&self, cell: &Cell) -> bool {
        self.shard.is_some_and(|shard| shard.has(cell.shard))
    }

    /// Whether a cell had a result before.
    pub fn has(&self, cell: &Cell) -> bool {
        self.found.contains_key(&cell.key)
    }

    /// The machines that computed the merged results.
    pub fn machines(&self) -> impl Iterator<Item = &str> {
        self.machines.iter().map(String::as_str)
    }

    /// The cells missing from merged files; `None` if complete.
    pub fn missing(&self, cells: &[Cell]) -> Option<MissingCells> {
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
        Some(MissingCells {
            shards: shards.collect(),
            cells: absent,
        })
    }

    /// The number of shards that most of the files belong to; the largest if several are equally common.
    fn usual(&self) -> NonZeroU64 {
        let mut counts: BTreeMap<NonZeroU64, usize> = BTreeMap::new();
        for shard in self.files.iter().flat_map(|(_, shards)| shards) {
            *counts.entry(shard.of()).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|&(of, count)| (count, of));
        most.map_or(NonZeroU64::MIN, |(of, _)| of)
    }
}
