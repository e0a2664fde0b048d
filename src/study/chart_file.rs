//! The file format of work-precision charts, and the built-in charts.
//!
//! ```ron
//! (
//!     scene: "04-cantilever-rigid-circle",
//!     set: [("history.increment", 0.25)],                     // for all runs
//!     monitors: ["u_x"],                                      // whose error counts; default: all displacements
//!     finest: [("refine", 8)],                                // the reference; default: the program's table, else the finest
//!     loads: [1, 2, 3],                                       // where errors are measured, besides the ends of legs
//!     series: [
//!         (name: "mesh", vary: [("refine", [1, 2, 4])]),
//!         (name: "mesh, 9-node elements", vary: [("refine", [1, 2])], set: [("nodes.beam.per_element", 9)]),
//!     ],
//! )
//! ```

use super::figure::assigned;
use super::plan::product;
use super::read::{Vary, pairs};
use super::reference::Reference;
use serde::{Deserialize, Deserializer};
use std::path::PathBuf;
use stickslip_scene::embedded_all;
use stickslip_scene::format::read::value;
use stickslip_scene::{EmbeddedFile, Scene, SceneError};
use stickslip_scene::{builtin, joined};

/// A chart before it is measured.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chart {
    /// Title.
    #[serde(skip)]
    pub title: String,
    /// Scene, as for `Scene::open`.
    pub scene: String,
    /// Settings of all runs: path and value.
    #[serde(default, deserialize_with = "pairs")]
    pub set: Vec<(String, String)>,
    /// Monitors whose error is measured; empty for all displacements.
    #[serde(default)]
    pub monitors: Vec<String>,
    /// Monitors requested by name instead; the reference must have them.
    #[serde(skip)]
    pub by: Vec<String>,
    /// Reference for the errors.
    #[serde(default, rename = "finest", deserialize_with = "finest")]
    pub truth: Truth,
    /// Load factors at which errors are measured, besides the corners of the load path; empty for those of the reference.
    #[serde(default)]
    pub loads: Vec<f64>,
    /// The curves in the order of the file.
    pub series: Vec<Series>,
}

/// The reference of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Truth {
    /// The built-in table for the scene.
    Builtin,
    /// A reference table in a file.
    Table(PathBuf),
    /// A run with these settings.
    Run(Vec<(String, String)>),
    /// The run with the most unknowns and, among these, the most increments.
    #[default]
    Finest,
    /// The limit of the three finest runs of a series, by Richardson extrapolation.
    Richardson,
}

/// Runs drawn as one line: all combinations of the varied settings.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Varied settings.
    #[serde(default)]
    pub vary: Vec<Vary>,
    /// Settings of all its runs: path and value.
    #[serde(default, deserialize_with = "pairs")]
    pub set: Vec<(String, String)>,
}

/// Charts of built-in scenes, by the scene's name.
static CHARTS: &[EmbeddedFile] = embedded_all![
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

/// Names of the scenes with a built-in chart.
pub fn names() -> impl Iterator<Item = &'static str> {
    CHARTS.iter().map(|chart| chart.name)
}

/// The file of a scene's built-in chart.
pub fn text(name: &str) -> Option<&'static str> {
    let found = CHARTS.iter().find(|chart| chart.name == name);
    found.map(|chart| chart.text)
}

impl Chart {
    /// The chart of a scene: the built-in one or, if there is none, increments and meshes, which every scene
    /// has; with `over`, only the combinations of those settings.
    ///
    /// # Errors
    /// If there is no such scene.
    pub fn open(name: &str, over: &[Vary]) -> Result<Chart, SceneError> {
        let scene = Scene::open(name, &[])?;
        let known = CHARTS.iter().find(|chart| chart.name == scene.name);
        let mut chart = match known {
            Some(file) => Chart::from_text(file.name, file.text)?,
            None => Chart {
                scene: name.to_owned(),
                truth: truth(&scene.name),
                series: any(),
                ..Chart::default()
            },
        };
        chart.title.clone_from(&scene.spec.title);
        if let [along, others @ ..] = over {
            chart.series = series(along, others);
            chart.set.clear();
            chart.truth = truth(&scene.name);
        }
        Ok(chart)
    }

    /// Parses a chart; `name` is its name for messages.
    ///
    /// # Errors
    /// If it cannot be read, with line and column.
    pub fn from_text(name: &str, text: &str) -> Result<Chart, SceneError> {
        let mut chart: Chart = value(name, text, "chart")?;
        if chart.truth == Truth::Finest {
            chart.truth = truth(&chart.scene);
        }
        Ok(chart)
    }
}

/// Runs along the values of a setting: one series for each combination of the others.
fn series(along: &Vary, others: &[Vary]) -> Vec<Series> {
    let name = |set: &[(String, String)]| match set {
        [] => along.path.clone(),
        set => joined(assigned(set), ", "),
    };
    product(others)
        .into_iter()
        .map(|set| Series {
            name: name(&set),
            vary: vec![along.clone()],
            set,
        })
        .collect()
}

/// Settings of the run that is the reference.
fn finest<'de, D: Deserializer<'de>>(from: D) -> Result<Truth, D::Error> {
    Ok(match pairs(from)? {
        none if none.is_empty() => Truth::Finest,
        settings => Truth::Run(settings),
    })
}

/// The most accurate reference for a scene. A user's file is not the built-in scene of the same name.
fn truth(scene: &str) -> Truth {
    let builtin = builtin::find(scene).is_some() && !std::path::Path::new(scene).is_file();
    if builtin && Reference::builtin(scene, &[]).is_some() {
        Truth::Builtin
    } else {
        Truth::Finest
    }
}

/// Settings that can be varied in every scene.
fn any() -> Vec<Series> {
    let one = |name: &str, path: &str, values: &[&str]| Series {
        name: name.to_owned(),
        vary: vec![Vary {
            path: path.to_owned(),
            values: values.iter().map(|word| word.to_string()).collect(),
        }],
        set: Vec::new(),
    };
    vec![
        one("mesh", "refine", &["1", "2", "4"]),
        one("increment", "history.increment", &["1x", "0.5x", "0.25x"]),
        one("T_max", "settings.t_max", &["lagged", "consistent"]),
        one("tolerance", "settings.tolerance", &["1e-4", "1e-6"]),
    ]
}
