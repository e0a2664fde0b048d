//! A work-precision chart as its author writes it, and those that the program carries.
//!
//! ```ron
//! (
//!     scene: "04-cantilever-rigid-circle",
//!     set: [("history.increment", 0.25)],                     // for all runs
//!     monitors: ["u_x"],                                      // whose error counts; default: all displacements
//!     finest: [("refine", 8)],                                // the reference; default: the program's table, else the finest
//!     series: [
//!         (name: "mesh", vary: [("refine", [1, 2, 4])]),
//!         (name: "mesh, 9-node elements", vary: [("refine", [1, 2])], set: [("nodes.beam.per_element", 9)]),
//!     ],
//! )
//! ```

use super::read::{Vary, pairs, parse};
use super::reference::Reference;
use serde::Deserialize;
use std::path::PathBuf;
use stickslip_scene::embedded::EmbeddedFile;
use stickslip_scene::embedded_all;
use stickslip_scene::format::error::SceneError;
use stickslip_scene::{Scene, builtin};

/// A chart before anything is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What the chart is called.
    pub title: String,
    /// As `Scene::open` takes it.
    pub scene: String,
    /// What is set for all runs: path and value.
    pub set: Vec<(String, String)>,
    /// Monitors whose error counts; none: all displacements.
    pub monitors: Vec<String>,
    /// Monitors that are asked for instead, by name: the reference must have them.
    pub by: Vec<String>,
    /// What errors are measured against.
    pub truth: Truth,
    /// The curves, in the order of the file.
    pub series: Vec<Series>,
}

/// What runs are measured against.
#[derive(Debug, Clone, PartialEq)]
pub enum Truth {
    /// The table that the program carries for the scene.
    Builtin,
    /// A reference table, by its file.
    Table(PathBuf),
    /// A run with these settings.
    Run(Vec<(String, String)>),
    /// The run with most unknowns, and of these with most increments.
    Finest,
}

/// Runs that are drawn as one line: the product of what is varied.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// What is varied in it.
    #[serde(default)]
    pub vary: Vec<Vary>,
    /// What is set for all of its runs, path and value.
    #[serde(default, deserialize_with = "pairs")]
    pub set: Vec<(String, String)>,
}

/// Charts of built-in scenes, by the scene's name.
const CHARTS: &[EmbeddedFile] = embedded_all![
    "../../problems/charts/",
    ".ron",
    "01-pinned-beam-rough-floor",
    "02-two-cantilevers-smooth",
    "02-two-cantilevers-rough",
    "03-distant-cantilevers",
    "04-cantilever-rigid-circle",
    "05-cantilever-elastic-block",
    "05-cantilever-elastic-block-swapped",
    "osc-inclined-cantilever",
];

/// Names of the scenes that have a chart of their own.
pub fn names() -> impl Iterator<Item = &'static str> {
    CHARTS.iter().map(|chart| chart.name)
}

/// The file of a scene's chart.
pub fn text(name: &str) -> Option<&'static str> {
    let found = CHARTS.iter().find(|chart| chart.name == name);
    found.map(|chart| chart.text)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    scene: String,
    #[serde(default, deserialize_with = "pairs")]
    set: Vec<(String, String)>,
    #[serde(default)]
    monitors: Vec<String>,
    #[serde(default, deserialize_with = "pairs")]
    finest: Vec<(String, String)>,
    series: Vec<Series>,
}

impl Chart {
    /// The chart of a scene: the one that the program carries for it, else of the increments and meshes that every scene
    /// has; with `over`, of the product of that alone.
    ///
    /// # Errors
    /// If there is no such scene.
    pub fn open(name: &str, over: &[Vary]) -> Result<Chart, SceneError> {
        let scene = Scene::open(name, &[])?;
        let known = CHARTS.iter().find(|chart| chart.name == scene.name);
        let mut chart = match known {
            Some(file) => Chart::from_text(file.name, file.text)?,
            None => Chart {
                title: String::new(),
                scene: name.to_owned(),
                set: Vec::new(),
                monitors: Vec::new(),
                by: Vec::new(),
                truth: truth(&scene.name),
                series: any(),
            },
        };
        chart.title.clone_from(&scene.spec.title);
        if !over.is_empty() {
            let paths: Vec<&str> = over.iter().map(|vary| vary.path.as_str()).collect();
            chart.series = vec![Series {
                name: paths.join(", "),
                vary: over.to_vec(),
                set: Vec::new(),
            }];
            chart.set.clear();
            chart.truth = truth(&scene.name);
        }
        Ok(chart)
    }

    /// Reads a chart from a text; `name` is what messages call it.
    ///
    /// # Errors
    /// If it cannot be read, with line and column.
    pub fn from_text(name: &str, text: &str) -> Result<Chart, SceneError> {
        let file: File = parse(name, text)?;
        Ok(Chart {
            title: String::new(),
            truth: match file.finest.is_empty() {
                true => truth(&file.scene),
                false => Truth::Run(file.finest),
            },
            scene: file.scene,
            set: file.set,
            monitors: file.monitors,
            by: Vec::new(),
            series: file.series,
        })
    }
}

/// The best truth there is about a scene. A file of one's own is not the built-in scene that it is called like.
fn truth(scene: &str) -> Truth {
    let builtin = builtin::find(scene).is_some() && !std::path::Path::new(scene).is_file();
    match builtin && Reference::builtin(scene, &[]).is_some() {
        true => Truth::Builtin,
        false => Truth::Finest,
    }
}

/// What can be varied in every scene.
fn any() -> Vec<Series> {
    let one = |name: &str, path: &str, values: &[&str]| Series {
        name: name.to_owned(),
        vary: vec![Vary {
            path: path.to_owned(),
            values: values.iter().map(|v| v.to_string()).collect(),
        }],
        set: Vec::new(),
    };
    vec![
        one("mesh", "refine", &["1", "2", "4"]),
        one("increment", "history.increment", &["1x", "0.5x", "0.25x"]),
        one("T_max", "settings.t_max", &["lagged", "consistent"]),
    ]
}
