//! `stickslip list`: the built-in scenes, one line each.

use super::base::{Error, Exit, answer};
use stickslip_scene::builtin;

#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn main(_: &Args) -> Result<Exit, Error> {
    let scenes = builtin::list();
    let width = scenes.iter().map(|s| s.name.len()).max().unwrap_or(0);
    let lines: String = scenes
        .iter()
        .map(|scene| format!("{:<width$}  {}\n", scene.name, builtin::title(scene)))
        .collect();
    answer(&lines)
}
