//! `stickslip check`: validates a scene and estimates its cost.

use super::base::{Error, Exit, SceneArgs, notify, say};
use stickslip_scene::Scene;
use stickslip_scene::cost::Cost;
use stickslip_scene::format::paths;
use stickslip_scene::gaps;
use stickslip_scene::precision;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// Lists every value that --set can change: path, value and range (separated by tabs)
    #[arg(long)]
    paths: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let scene = args.scene.open()?;
    let text = if args.paths {
        all_paths(&scene)
    } else {
        format!("{}: sound\n{}", scene.name, Cost::of(&scene))
    };
    say(&text)?;
    if !args.paths {
        for remark in &scene.remarks {
            notify(&format!("note: {remark}"));
        }
        for note in scene.names().notes(scene.spec.refine) {
            notify(&format!("note: {note}"));
        }
        for warning in gaps::warnings(&scene.model) {
            notify(&format!("warning: {warning}"));
        }
        if let Some(warning) = precision::warning(&scene.model) {
            notify(&format!("warning: {warning}"));
        }
    }
    Ok(Exit::Good)
}

fn all_paths(scene: &Scene) -> String {
    paths::list(&scene.spec)
        .iter()
        .map(|l| format!("{}\t{}\t{}\n", l.path, l.value, l.kind))
        .collect()
}
