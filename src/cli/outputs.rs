//! Output of sweeps: tables, pictures, progress, and tables for people.

use super::base::{Error, distinct};
use super::sink::{Sink, spare_inputs};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use stickslip_platform::files::{Output, finish_all};
use stickslip_study::drawn::PlotError;
use stickslip_study::pen;
use stickslip_study::sheet::Sheet;

/// Output options of a sweep.
#[derive(Debug, clap::Args)]
pub struct OutputArgs {
    /// Writes the results as a table (CSV); - is standard output
    #[arg(long, value_name = "FILE|-")]
    csv: Option<String>,
    /// Draws the figure as SVG
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Draws the figure as PNG
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Number of parallel runs [default: one per core]
    #[arg(long, value_name = "N", value_parser = jobs)]
    jobs: Option<NonZeroUsize>,
    /// Overwrites existing files
    #[arg(long)]
    pub force: bool,
    /// Prints nothing but warnings and errors
    #[arg(long, short)]
    pub quiet: bool,
}

impl OutputArgs {
    /// Whether a picture is requested.
    pub fn draws(&self) -> bool {
        self.svg.is_some() || self.png.is_some()
    }

    /// Whether a table or a picture is requested.
    pub fn writes(&self) -> bool {
        self.csv.is_some() || self.draws()
    }

    /// Number of parallel runs.
    pub fn jobs(&self) -> NonZeroUsize {
        self.jobs
            .unwrap_or_else(|| std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN))
    }

    /// A progress bar on a terminal for the whole sweep; `unit` names what is counted.
    pub fn progress(&self, length: u64, unit: &str) -> ProgressBar {
        let target = if !self.quiet && io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        let shape = format!("{{wide_bar}} {{pos}} of {{len}} {unit}, {{eta}} left");
        match ProgressStyle::with_template(&shape) {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }
}

fn jobs(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.parse().ok();
    count.ok_or_else(|| "expected a whole number from 1".to_owned())
}

/// Output files, opened before the sweep runs, so that its results can be written.
pub struct Outputs {
    csv: Option<Sink>,
    svg: Option<Output>,
    png: Option<Output>,
}

impl Outputs {
    /// Opens all requested files.
    ///
    /// # Errors
    /// If a file exists and must not be overwritten, cannot be written, or is named twice; or if a picture is requested and this
    /// build cannot draw.
    pub fn open(args: &OutputArgs) -> Result<Outputs, Error> {
        if args.draws() {
            pen::ready().map_err(Error::usage)?;
        }
        let named =
            |path: &Option<PathBuf>| path.as_ref().map(|p| p.to_string_lossy().into_owned());
        let (svg, png) = (named(&args.svg), named(&args.png));
        distinct(&[
            ("--csv", args.csv.as_deref()),
            ("--svg", svg.as_deref()),
            ("--png", png.as_deref()),
        ])?;
        let output = |path: &PathBuf| -> Result<Output, Error> {
            spare_inputs(&path.to_string_lossy())?;
            Ok(Output::create(path, args.force)?)
        };
        let csv = args.csv.as_deref().map(|to| Sink::open(to, args.force));
        Ok(Outputs {
            csv: csv.transpose()?,
            svg: args.svg.as_ref().map(output).transpose()?,
            png: args.png.as_ref().map(output).transpose()?,
        })
    }

    /// Writes all requested outputs or none. Pictures are drawn here. Standard output is written last, since it cannot be undone. A
    /// reader that closes the pipe is no error.
    ///
    /// # Errors
    /// If an output cannot be written or drawn.
    pub fn write(
        self,
        table: &str,
        picture: impl FnOnce() -> Result<Sheet, PlotError>,
    ) -> Result<(), Error> {
        let mut files = Vec::new();
        if self.svg.is_some() || self.png.is_some() {
            let sheet = picture().map_err(Error::usage)?;
            if let Some(output) = self.svg {
                let svg = sheet.svg().map_err(Error::usage)?;
                files.push(written(output, svg.as_bytes())?);
            }
            if let Some(output) = self.png {
                files.push(written(output, &sheet.png(2.0).map_err(Error::usage)?)?);
            }
        }
        if let Some(mut sink) = self.csv {
            sink.send(table)?;
            files.extend(sink.into_file());
        }
        Ok(finish_all(files)?)
    }

    /// Writes the table, if requested.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_table(self, table: &str) -> Result<(), Error> {
        if let Some(mut sink) = self.csv {
            sink.send(table)?;
            sink.finish()?;
        }
        Ok(())
    }
}

fn written(mut output: Output, bytes: &[u8]) -> Result<Output, Error> {
    output.append(bytes)?;
    Ok(output)
}
