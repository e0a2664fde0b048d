//! `stickslip run --vtu DIR`: a ParaView file after each increment, major or minor iteration, and a collection of them.

use super::base::Error;
use std::path::{Path, PathBuf};
use stickslip_core::{Event, Outcome, State, Stepper, counted};
use stickslip_debugger::record::export::grid::grid;
use stickslip_exchange::vtu;
use stickslip_platform::files::{self, Output};

/// When a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum GridInterval {
    /// After each accepted increment
    Increment,
    /// After each major iteration and increment
    Major,
    /// After each minor iteration, with its modes and forces and the displacements of the last major iteration
    Minor,
}

impl GridInterval {
    fn wants(self, event: &Event) -> bool {
        match self {
            GridInterval::Minor => true,
            GridInterval::Increment => event.outcome.is_accepted(),
            GridInterval::Major => matches!(
                event.outcome,
                Outcome::Increment { .. } | Outcome::Major { .. } | Outcome::Refused { .. }
            ),
        }
    }
}

/// ParaView files of a run.
pub struct Grids {
    folder: PathBuf,
    /// Prefix of all file names.
    stem: String,
    each: GridInterval,
    overwrite: bool,
    collection: Output,
    /// Load factor and name of each file.
    written: Vec<(f64, String)>,
}

impl Grids {
    /// Creates the folder, and checks that the collection can be written there.
    ///
    /// # Errors
    /// If the folder cannot be created, or the collection exists and must not be overwritten.
    pub fn open(
        folder: &Path,
        scene: &str,
        each: GridInterval,
        overwrite: bool,
    ) -> Result<Grids, Error> {
        files::create_folder(folder)?;
        let stem = Path::new(scene)
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let collection = Output::create(&folder.join(format!("{stem}.pvd")), overwrite)?;
        Ok(Grids {
            folder: folder.to_owned(),
            stem,
            each,
            overwrite,
            collection,
            written: Vec::new(),
        })
    }

    /// Writes the initial state.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn start(&mut self, stepper: &Stepper) -> Result<(), Error> {
        let state = stepper.state();
        self.write(stepper, state, None, state.start.load_factor)
    }

    /// Writes the state after a minor iteration, if `each` includes it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn see(&mut self, stepper: &Stepper) -> Result<(), Error> {
        let event = stepper.event();
        if self.each.wants(event) {
            self.write(stepper, stepper.state(), Some(event), event.load_factor)
        } else {
            Ok(())
        }
    }

    fn write(
        &mut self,
        stepper: &Stepper,
        state: &State,
        event: Option<&Event>,
        load: f64,
    ) -> Result<(), Error> {
        let at = event.map_or_else(Default::default, |event| event.position);
        let name = format!("{}-{:06}.vtu", self.stem, self.written.len());
        let grid = grid(stepper.model(), state, event, at, load).map_err(Error::usage)?;
        files::write(&self.folder.join(&name), vtu::write(&grid), self.overwrite)?;
        self.written.push((load, name));
        Ok(())
    }

    /// Writes the collection. Its time is the load factor if that increases from file to file, otherwise the file number.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> Result<String, Error> {
        let rises = self.written.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let files: Vec<(f64, String)> = self
            .written
            .into_iter()
            .enumerate()
            .map(|(number, (load, name))| (if rises { load } else { number as f64 }, name))
            .collect();
        let mut output = self.collection;
        output.append(vtu::collection(&files).as_bytes())?;
        output.finish()?;
        let time = if rises { "load factor" } else { "number" };
        let path = self.folder.join(format!("{}.pvd", self.stem));
        Ok(format!(
            "wrote {}: {}, with the {time} as time",
            path.display(),
            counted(files.len(), "file")
        ))
    }
}
