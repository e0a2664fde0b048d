//! Output files of `stickslip run`.

use super::base::{Error, OutputState, distinct, spare_input};
use super::grids::{GridInterval, Grids};
use super::json::JsonArgs;
use super::sink::Sink;
use std::path::{Path, PathBuf};
use stickslip_core::Model;
use stickslip_debugger::record::table;
use stickslip_platform::files::Output;
use stickslip_scene::Scene;

#[derive(Debug, clap::Args)]
pub struct RunOutputArgs {
    /// Writes a row per converged increment; - is standard output
    #[arg(long, value_name = "FILE|-")]
    pub csv: Option<String>,
    /// Writes a row per slave node and minor iteration; - is standard output
    #[arg(long, value_name = "FILE|-")]
    pub trace: Option<String>,
    #[command(flatten)]
    pub json: JsonArgs,
    /// Writes the state at the end, or at the failure
    #[arg(long, value_name = "FILE")]
    pub snapshot: Option<PathBuf>,
    /// Writes ParaView files, and a collection of them (.pvd), to a folder
    #[arg(long, value_name = "DIR")]
    pub vtu: Option<PathBuf>,
    /// When --vtu writes a file
    #[arg(
        long,
        value_name = "WHAT",
        value_enum,
        default_value = "increment",
        requires = "vtu"
    )]
    each: GridInterval,
}

/// The output files of a run.
pub struct RunOutputs {
    pub csv: Option<Sink>,
    pub trace: Option<Sink>,
    json: Option<Sink>,
    snapshot: Option<Output>,
    pub grids: Option<Grids>,
}

/// Outputs that are written after the run.
pub struct LastOutputs {
    pub snapshot: Option<Output>,
    pub json: Option<Sink>,
    /// A message about the ParaView files.
    pub wrote: Option<String>,
}

impl RunOutputs {
    /// Opens all requested files.
    ///
    /// # Errors
    /// If a file exists and must not be overwritten, cannot be written, or is named twice.
    pub fn open(args: &RunOutputArgs, scene: &Scene, force: bool) -> Result<RunOutputs, Error> {
        let snapshot = args.snapshot.as_ref().map(|path| path.to_string_lossy());
        let named = [
            ("--csv", args.csv.as_deref()),
            ("--trace", args.trace.as_deref()),
            ("--json", args.json.to()),
            ("--snapshot", snapshot.as_deref()),
        ];
        distinct(&named)?;
        for file in named.iter().filter_map(|(_, file)| *file) {
            spare_input(&scene.name, Path::new(file))?;
        }
        let sink = |to: &Option<String>| match to {
            Some(to) => Sink::open(to, force).map(Some),
            None => Ok(None),
        };
        let output = |path: &PathBuf| Output::create(path, force);
        let grids = |folder: &PathBuf| Grids::open(folder, &scene.name, args.each, force);
        Ok(RunOutputs {
            csv: sink(&args.csv)?,
            trace: sink(&args.trace)?,
            json: args.json.open(force)?,
            snapshot: args.snapshot.as_ref().map(output).transpose()?,
            grids: args.vtu.as_ref().map(grids).transpose()?,
        })
    }

    pub fn headers(&mut self, model: &Model, stability: bool) -> Result<OutputState, Error> {
        let csv = send(&mut self.csv, || table::csv_header(model, stability))?;
        let trace = send(&mut self.trace, || table::trace_header(model))?;
        Ok(self.after(first_closed(csv, trace)))
    }

    /// `Closed` only if all readers are gone and no other output is requested, so that the solve can stop.
    pub fn after(&self, sent: OutputState) -> OutputState {
        let wanted = self.csv.is_some()
            || self.trace.is_some()
            || self.json.is_some()
            || self.snapshot.is_some()
            || self.grids.is_some();
        if wanted { OutputState::Well } else { sent }
    }

    /// Finishes the tables and ParaView files.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn close(self) -> Result<LastOutputs, Error> {
        self.csv.map(Sink::finish).transpose()?;
        self.trace.map(Sink::finish).transpose()?;
        Ok(LastOutputs {
            snapshot: self.snapshot,
            json: self.json,
            wrote: self.grids.map(Grids::finish).transpose()?,
        })
    }
}

/// Sends lines to a requested table; a table whose reader has closed the pipe is dropped.
pub fn send(sink: &mut Option<Sink>, lines: impl FnOnce() -> String) -> Result<OutputState, Error> {
    let sent = sink
        .as_mut()
        .map_or(Ok(OutputState::Well), |s| s.send(&lines()))?;
    if sent == OutputState::Closed {
        *sink = None;
    }
    Ok(sent)
}

pub fn first_closed(a: OutputState, b: OutputState) -> OutputState {
    if a == OutputState::Closed { a } else { b }
}
