//! `stickslip show NAME`: prints the file of a built-in scene, study, lesson, deck or chart, or a finished CalculiX run as text.

use super::base::{Error, Exit, put};
use std::path::PathBuf;
use stickslip_debugger::Recording;
use stickslip_debugger::teach;
use stickslip_scene::EmbeddedFile;
use stickslip_scene::builtin;
use stickslip_scene::embedded;
use stickslip_scene::format::error::did_you_mean;
use stickslip_study::{benchmarks, builtin as studies, chart_file};

/// The deck that page `past-runs` runs in CalculiX.
static DECK: EmbeddedFile = embedded!("stiff.inp", "tests/calculix/causes/stiff.inp");

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Name of a built-in scene, study, lesson or deck, the .cel file of a finished CalculiX run, or a recorded exchange
    name: String,
    /// Prints the work-precision chart of that scene
    #[arg(long)]
    chart: bool,
    /// Writes to this file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrites an existing file
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let text = match Recording::open(&args.name).map_err(Error::Usage)? {
        Some(recording) if args.chart => {
            let message = format!(
                "--chart cannot be used with this input: {}",
                recording.kind()
            );
            return Err(Error::Usage(message));
        }
        Some(mut recording) => recording.text(&args.name),
        None => find(&args.name, args.chart)
            .map_err(Error::Usage)?
            .to_owned(),
    };
    put(args.output.as_deref(), &text, args.force)
}

fn find(name: &str, chart: bool) -> Result<&'static str, String> {
    let found = if chart {
        chart_file::text(name.strip_suffix(".ron").unwrap_or(name))
    } else {
        builtin::find(name)
            .map(|file| file.text)
            .or_else(|| studies::find(name).map(|file| file.text))
            .or_else(|| (name == benchmarks::BUILTIN).then(benchmarks::builtin_text))
            .or_else(|| teach::find(name).map(|file| file.text))
            .or_else(|| (name == DECK.name).then_some(DECK.text))
    };
    found.ok_or_else(|| {
        let scenes = builtin::list().iter().map(|scene| scene.name);
        let others = studies::list()
            .iter()
            .map(|study| study.name)
            .chain([benchmarks::BUILTIN]);
        let lessons = teach::list()
            .iter()
            .chain(teach::lesson::sheets())
            .map(|lesson| lesson.name);
        let (what, near) = if chart {
            ("chart", did_you_mean(name, chart_file::names()))
        } else {
            (
                "scene, study or lesson",
                did_you_mean(name, scenes.chain(others).chain(lessons)),
            )
        };
        let name = stickslip_scene::shown::cut(name, 60);
        format!(
            "no built-in {what} named '{name}'{near} (see `stickslip list`, `stickslip lesson`)"
        )
    })
}
