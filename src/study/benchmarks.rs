//! Benchmarks: compares results with values from other sources.
//!
//! ```ron
//! (
//!     title: "What others have found",
//!     benchmarks: [
//!         (
//!             scene: "bench-wedge", set: [("friction.angle", 11.3)],
//!             what: "push over weight",
//!             of: "push", over: "weight",                 // monitors of the scene; over is left out where nothing divides
//!             at: 1.0,                                    // load factor; default: the end of the history
//!             source: "NAFEMS CGS-4", value: 0.3061224, within: 1e-6,
//!             own: 0.306122448979592, drift: 1e-9,
//!         ),
//!     ],
//! )
//! ```
//!
//! Both tolerances are relative, as in Code_Aster's tests: `within` limits the difference from the source's
//! value, which includes the errors of both; `drift` limits the difference from our own earlier value, to
//! detect changes that the source's accuracy would hide. If the source's value is 0, errors are relative to
//! `scale`.

use super::figure::assigned;
use super::read::pairs;
use super::result::{CaseEnd, Row, Run};
use super::run_error::RunError;
use super::solver_pool::{SolverPool, Watch, one};
use super::sweep::side_by_side;
use serde::Deserialize;
use std::fmt;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use stickslip_scene::format::error::{Fault, at, did_you_mean};
use stickslip_scene::format::read::{text as file_text, value as from_ron};
use stickslip_scene::scene::placed;
use stickslip_scene::{EmbeddedFile, Scene, SceneError, increments};
use stickslip_scene::{embedded, joined};

/// Name of the built-in list.
pub const BUILTIN: &str = "benchmarks";
static TABLE: EmbeddedFile = embedded!(BUILTIN, "../../problems/benchmarks/table.ron");
/// Default of [`Benchmark::drift`]: other processors round differently.
const DRIFT: f64 = 1e-8;
/// Largest distance between the end of an increment and a given load factor.
const NEAR: f64 = 1e-9;

/// The text of the built-in list.
pub fn builtin_text() -> &'static str {
    TABLE.text
}

/// A list of benchmarks.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Benchmarks {
    /// Path of the file, or [`BUILTIN`].
    #[serde(skip)]
    pub name: String,
    /// The text of the file, where errors have a line.
    #[serde(skip)]
    text: String,
    /// Title.
    pub title: String,
    /// What the list shows, for the reader.
    #[serde(default)]
    pub about: String,
    /// The benchmarks in the order of the table.
    #[serde(rename = "benchmarks")]
    pub list: Vec<Benchmark>,
}

/// A value known from another source.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Benchmark {
    /// Scene, as for [`Scene::open`].
    pub scene: String,
    /// Settings: path and value.
    #[serde(default, deserialize_with = "pairs")]
    pub set: Vec<(String, String)>,
    /// What is compared, in words.
    pub what: String,
    /// The monitor that is compared.
    pub of: String,
    /// A monitor to divide by.
    pub over: Option<String>,
    /// Load factor of the comparison. `None`: the last.
    pub at: Option<f64>,
    /// The source of the value.
    pub source: String,
    /// The source's value.
    pub value: f64,
    /// Tolerance for the difference from it, relative.
    pub within: f64,
    /// What `within` and `drift` are relative to. `None`: the value itself.
    pub scale: Option<f64>,
    /// Our own earlier value. `None` if there is none yet.
    pub own: Option<f64>,
    /// Tolerance for the difference from our own value.
    #[serde(default = "default_drift")]
    pub drift: f64,
}

/// Result of a benchmark.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedBenchmark {
    /// Our value; `None` if the run did not get that far.
    pub ours: Option<f64>,
    /// (ours − source) / scale.
    pub error: Option<f64>,
    /// (ours − own) / scale.
    pub drift: Option<f64>,
    /// Assessment of the result.
    pub standing: Assessment,
}

/// Assessment of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Assessment {
    /// Close to the source and to our own value.
    Good,
    /// Close to the source, but not to our own value.
    Drifted,
    /// Too far from the source.
    Off,
    /// No value, because the run failed; the reason in a word.
    Failed(String),
    /// Interrupted before the run.
    NotRun,
}

impl fmt::Display for Assessment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Assessment::Good => f.write_str("good"),
            Assessment::Drifted => f.write_str("drifted"),
            Assessment::Off => f.write_str("off"),
            Assessment::Failed(why) => write!(f, "failed: {why}"),
            Assessment::NotRun => f.write_str("not run"),
        }
    }
}

impl Benchmarks {
    /// Reads a list from a file, or the built-in list by its name; `None` if the file is something else.
    ///
    /// # Errors
    /// If the list cannot be read, with line and column.
    pub fn open(name: &str) -> Result<Option<Benchmarks>, SceneError> {
        let path = Path::new(name);
        if !path.is_file() {
            let own = name.strip_suffix(".ron").unwrap_or(name) == BUILTIN;
            return own
                .then(|| Benchmarks::from_text(BUILTIN, builtin_text()))
                .transpose();
        }
        let text = file_text(name, "charts and scenes are written in RON")?;
        if !is_list(&text) {
            return Ok(None);
        }
        let mut list = Benchmarks::from_text(name, &text)?;
        for k in 0..list.list.len() {
            list.list[k].scene = Scene::named_in(name, &list.list[k].scene)
                .map_err(|why| list.fault(k, "scene", why))?;
        }
        Ok(Some(list))
    }

    /// Parses a list; `name` is its name for messages.
    ///
    /// # Errors
    /// If it cannot be read, with line and column, or is inconsistent.
    pub fn from_text(name: &str, text: &str) -> Result<Benchmarks, SceneError> {
        let mut list: Benchmarks = from_ron(name, text, "list of benchmarks")?;
        (list.name, list.text) = (name.to_owned(), text.to_owned());
        for (k, benchmark) in list.list.iter().enumerate() {
            benchmark
                .check()
                .map_err(|(field, message)| list.fault(k, field, message))?;
        }
        Ok(list)
    }

    /// An error at a field of the k-th benchmark.
    fn fault(&self, k: usize, field: &str, message: String) -> SceneError {
        let fault = Fault::new(at!["benchmarks", k, field], message);
        placed(&self.name, &self.text, &[], fault)
    }

    /// Runs each combination of scene and settings once, and compares the results.
    ///
    /// # Errors
    /// If a scene or a setting is invalid, or a monitor does not exist. The failure of a run is a
    /// result.
    pub fn run(
        &self,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Vec<ComparedBenchmark>, RunError> {
        let mut posed: Vec<(&Benchmark, Scene)> = Vec::new();
        let mut of = Vec::with_capacity(self.list.len());
        for (k, benchmark) in self.list.iter().enumerate() {
            let place = match posed.iter().position(|(other, _)| {
                (&other.scene, &other.set) == (&benchmark.scene, &benchmark.set)
            }) {
                Some(place) => place,
                None => {
                    let scene = Scene::open(&benchmark.scene, &benchmark.set);
                    let scene = scene.map_err(|error| match error.set {
                        Some(_) => self.fault(k, "set", error.message),
                        None => error,
                    })?;
                    posed.push((benchmark, scene));
                    posed.len() - 1
                }
            };
            self.check_monitors(k, benchmark, &posed[place].1)?;
            of.push(place);
        }
        let spare = SolverPool::default();
        let runs: Vec<Run> = side_by_side(jobs, posed.len(), |k| {
            let model = &posed[k].1.model;
            let count = increments(&model.path, |leg| model.on_leg(leg)) as u64;
            Ok(one(count, Arc::new(model.clone()), &spare, watch))
        })?;
        Ok(self
            .list
            .iter()
            .zip(of)
            .map(|(b, place)| b.compare(&runs[place]))
            .collect())
    }

    fn check_monitors(
        &self,
        k: usize,
        benchmark: &Benchmark,
        scene: &Scene,
    ) -> Result<(), SceneError> {
        let names = || scene.model.monitors.iter().map(|m| m.name.as_str());
        for (field, wanted) in [
            ("of", Some(&benchmark.of)),
            ("over", benchmark.over.as_ref()),
        ] {
            let Some(wanted) = wanted.filter(|wanted| !names().any(|own| own == *wanted)) else {
                continue;
            };
            let message = format!(
                "scene {} has no monitor {wanted:?}{} (monitors: {})",
                benchmark.scene,
                did_you_mean(wanted, names()),
                joined(names(), ", ")
            );
            return Err(self.fault(k, field, message));
        }
        Ok(())
    }
}

/// Whether a text is such a list, valid or not.
fn is_list(text: &str) -> bool {
    stickslip_scene::readers::has_field(text, "benchmarks")
}

impl Benchmark {
    /// What the errors are relative to.
    fn unit(&self) -> f64 {
        self.scale.unwrap_or(self.value).abs()
    }

    /// The field that has an error, and the error.
    fn check(&self) -> Result<(), (&'static str, String)> {
        let named = [
            ("value", Some(self.value)),
            ("within", Some(self.within)),
            ("drift", Some(self.drift)),
            ("scale", self.scale),
            ("own", self.own),
            ("at", self.at),
        ];
        for (field, number) in named {
            let Some(number) = number else { continue };
            if !number.is_finite() {
                return Err((field, format!("{field} is {number:?}; it must be finite")));
            }
            if matches!(field, "within" | "drift") && number <= 0.0 {
                return Err((field, format!("{field} is {number:?}; it must be above 0")));
            }
        }
        if self.unit() == 0.0 {
            return Err(("value", "the value is 0, so its error needs a scale".into()));
        }
        Ok(())
    }

    /// Compares the result of a run.
    fn compare(&self, run: &Run) -> ComparedBenchmark {
        let none = |standing| ComparedBenchmark {
            ours: None,
            error: None,
            drift: None,
            standing,
        };
        let Some(ours) = self.row(run).and_then(|row| self.taken(run, row)) else {
            return none(match &run.end {
                CaseEnd::Failed(failed) => Assessment::Failed(failed.reason.to_string()),
                CaseEnd::Interrupted | CaseEnd::NotRun => Assessment::NotRun,
                CaseEnd::Finished => Assessment::Failed("no increment ends at that load".into()),
            });
        };
        let from = |value: f64| (ours - value) / self.unit();
        let (error, drift) = (from(self.value), self.own.map(from));
        let within = |off: f64, most: f64| off.abs() <= most;
        let standing = match (within(error, self.within), drift) {
            (false, _) => Assessment::Off,
            (true, Some(drift)) if !within(drift, self.drift) => Assessment::Drifted,
            (true, _) => Assessment::Good,
        };
        ComparedBenchmark {
            ours: Some(ours),
            error: Some(error),
            drift,
            standing,
        }
    }

    /// The increment at whose end the value is taken.
    fn row<'a>(&self, run: &'a Run) -> Option<&'a Row> {
        match self.at {
            None => (run.end == CaseEnd::Finished).then(|| run.last()),
            Some(at) => run
                .rows
                .iter()
                .find(|row| (row.load - at).abs() <= NEAR * at.abs().max(1.0)),
        }
    }

    fn taken(&self, run: &Run, row: &Row) -> Option<f64> {
        let value = |name: &String| {
            let k = run.monitors.iter().position(|own| own == name)?;
            row.monitors.get(k).copied()
        };
        let of = value(&self.of)?;
        Some(match &self.over {
            Some(over) => of / value(over)?,
            None => of,
        })
    }

    /// Scene and settings as text.
    pub fn case(&self) -> String {
        let settings = assigned(&self.set).map(|pair| format!(" {pair}"));
        self.scene.clone() + &settings.collect::<String>()
    }
}

/// The comparison as CSV: `case,what,source,value,ours,error,within,own,drift,allowed,standing`. Floats read
/// back to the same bits; missing values are empty.
pub fn table(list: &Benchmarks, compared: &[ComparedBenchmark]) -> String {
    use super::csv::field;
    let mut text =
        String::from("case,what,source,value,ours,error,within,own,drift,allowed,standing\n");
    let some = |value: Option<f64>| value.map(|value| format!("{value:?}")).unwrap_or_default();
    for (benchmark, compared) in list.list.iter().zip(compared) {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{},{},{:?},{},{},{:?},{},{},{:?},{}",
            field(&benchmark.case()),
            field(&benchmark.what),
            field(&benchmark.source),
            benchmark.value,
            some(compared.ours),
            some(compared.error),
            benchmark.within,
            some(benchmark.own),
            some(compared.drift),
            benchmark.drift,
            field(&compared.standing.to_string()),
        );
    }
    text
}

fn default_drift() -> f64 {
    DRIFT
}

#[cfg(test)]
mod tests {
    use super::*;

    fn benchmark() -> Benchmark {
        let text = "(title: \"t\", benchmarks: [(scene: \"a\", what: \"w\", of: \"m\", source: \"s\", value: 2.0, within: 0.1, \
                    own: 2.1, drift: 1e-3)])";
        Benchmarks::from_text("t", text).unwrap().list.remove(0)
    }

    fn run(value: f64) -> Run {
        let row = |increment, load, value| Row {
            increment,
            load,
            majors: 1,
            minors: 1,
            unsettled: 0,
            jumped: false,
            monitors: vec![value],
        };
        Run {
            monitors: vec!["m".into()],
            start: row(0, 0.0, 0.0),
            rows: vec![row(1, 0.5, 7.0), row(2, 1.0, value)],
            begun: 2,
            factorizations: 2,
            end: CaseEnd::Finished,
        }
    }

    #[test]
    fn a_value_is_good_drifted_or_off() {
        let standing = |value| benchmark().compare(&run(value)).standing;
        assert_eq!(standing(2.1), Assessment::Good);
        assert_eq!(standing(2.15), Assessment::Drifted);
        assert_eq!(standing(2.3), Assessment::Off);
        assert_eq!(standing(f64::NAN), Assessment::Off);
    }

    #[test]
    fn a_value_is_taken_at_the_requested_load() {
        let mut at = benchmark();
        at.at = Some(0.5);
        assert_eq!(at.compare(&run(2.0)).ours, Some(7.0));
        at.at = Some(0.6);
        let missing = at.compare(&run(2.0)).standing;
        assert!(matches!(missing, Assessment::Failed(_)), "{missing}");
    }

    #[test]
    fn inconsistent_benchmarks_are_refused() {
        for (wrong, field) in [
            ("value: 0.0, within: 0.1", "value"),
            ("value: 1.0, within: 0.0", "within"),
        ] {
            let text = format!(
                "(title: \"t\", benchmarks: [(scene: \"a\", what: \"w\", of: \"m\", source: \"s\", {wrong})])"
            );
            let error = Benchmarks::from_text("t", &text).unwrap_err().to_string();
            let at = text.find(wrong).unwrap() + wrong.find(field).unwrap() + field.len() + 3;
            let place = format!("t:1:{at}: benchmarks[0].{field}: ");
            assert!(error.starts_with(&place), "{error}");
        }
    }
}
