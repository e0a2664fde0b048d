//! Plans a study: all combinations of its settings, each checked before anything runs.

use super::read::{AxisQuantity, Study, Vary};
use super::shard::Key;
use super::sweep::Cell;
use super::sweep_input::digest;
use std::sync::Arc;
use stickslip_core::Model;
use stickslip_scene::base::{Base, ScalarLocation};
use stickslip_scene::format::error::{Path, at, did_you_mean, shortened, some_of};
use stickslip_scene::format::paths::{self, ListedScalar};
use stickslip_scene::{Scene, SceneError, increments};

/// Maximum number of cells of a sweep.
pub const MOST_CASES: u64 = 10_000_000;

/// A planned study.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The study as requested.
    pub study: Study,
    /// Title.
    pub title: String,
    /// The columns that distinguish cases: `scene` if there are several, then the varied paths.
    pub columns: Vec<String>,
    /// The runs in the order of the table.
    pub cases: Vec<Case>,
    /// Names of all monitors, in order of first occurrence.
    pub monitors: Vec<String>,
    /// Horizontal axis of the figure.
    pub x: AxisQuantity,
    /// Vertical axis of the figure.
    pub y: AxisQuantity,
}

/// One run of a study.
#[derive(Debug, Clone)]
pub struct Case {
    /// One value per column of the plan.
    pub values: Vec<String>,
    /// Its scene, shared with other cases.
    of: Arc<SceneData>,
    /// One value per path that is set.
    set: Vec<String>,
    /// Number of increments of the history.
    pub increments: u64,
}

/// Data shared by all cases of a scene.
#[derive(Debug)]
struct SceneData {
    /// The scene's text.
    text: Arc<str>,
    /// Key of the imported meshes, if there are any.
    meshes: Option<String>,
    /// Key of the text and the meshes.
    key: Key,
    base: Base,
    /// The paths that are set, in order.
    paths: Vec<String>,
    /// Location of each path in the scene; `None` if one does not exist or cannot be set in the base scene.
    places: Option<Vec<ScalarLocation>>,
}

impl Case {
    /// The scene with the settings of this case.
    ///
    /// # Errors
    /// Never; the plan has checked all cases.
    pub fn open(&self) -> Result<Scene, SceneError> {
        let settings: Vec<_> = self
            .of
            .paths
            .iter()
            .zip(&self.set)
            .map(|(p, v)| (p.clone(), v.clone()))
            .collect();
        let scene = self.of.base.scene();
        match self.of.text.is_empty() {
            // Scenes imported from other programs have no text.
            true => scene.with_all(&settings),
            false => Scene::from_text(&scene.name, &self.of.text, &settings),
        }
    }

    /// The model of the case, without parsing the scene again.
    ///
    /// # Errors
    /// Never; the plan has checked all cases.
    pub fn model(&self) -> Result<Model, SceneError> {
        let quick = self.placed().and_then(|set| self.of.base.model(&set));
        quick.map_or_else(|| Ok(self.open()?.model), Ok)
    }

    /// Key of the scene's text, its imported meshes, and the paths selected by `counts` with their values.
    fn key(&self, counts: impl Fn(&str) -> bool) -> Key {
        self.of
            .paths
            .iter()
            .zip(&self.set)
            .filter(|(path, _)| counts(path))
            .fold(self.of.key, |key, (path, value)| key.and(path).and(value))
    }

    /// The last value set at a path, if any.
    pub fn value(&self, path: &str) -> Option<&str> {
        let set = self.of.paths.iter().rposition(|own| own == path)?;
        self.set.get(set).map(String::as_str)
    }

    /// The settings, by location in the scene.
    fn placed(&self) -> Option<Vec<(&ScalarLocation, &str)>> {
        let places = self.of.places.as_ref()?;
        let values = self.set.iter().map(String::as_str);
        Some(places.iter().zip(values).collect())
    }

    /// Determines the number of increments, and checks the scene with its settings. Returns the names of the
    /// monitors if they differ from those of the base scene.
    fn check(&mut self) -> Result<Option<Vec<String>>, SceneError> {
        let quick = self.placed().and_then(|set| self.of.base.increments(&set));
        if let Some(count) = quick {
            self.increments = count as u64;
            return Ok(None);
        }
        let model = self.model()?;
        self.increments = increments(&model.path, |leg| model.on_leg(leg)) as u64;
        Ok(Some(model.monitors.into_iter().map(|m| m.name).collect()))
    }
}

impl Plan {
    /// Plans a study.
    ///
    /// # Errors
    /// If a scene, a path or a value is invalid in any case, or the scenes do not have the quantity of
    /// an axis.
    pub fn new(mut study: Study) -> Result<Plan, SceneError> {
        check_values(&mut study)?;
        let scene = (study.scenes.len() > 1).then(|| "scene".to_owned());
        let paths = study.vary.iter().map(|vary| vary.path.clone());
        let mut plan = Plan {
            title: study.title.clone(),
            columns: scene.into_iter().chain(paths).collect(),
            cases: Vec::new(),
            monitors: Vec::new(),
            x: AxisQuantity::Increment,
            y: study.y.clone().unwrap_or(AxisQuantity::Load),
            study,
        };
        for name in plan.study.scenes.clone() {
            plan.lay_out(&name)?;
        }
        plan.x = match (&plan.study.x, plan.monitors.first()) {
            (Some(x), _) => x.clone(),
            (None, Some(first)) => AxisQuantity::Monitor(first.clone()),
            (None, None) => AxisQuantity::Increment,
        };
        for (axis, field) in [(&plan.x, "x"), (&plan.y, "y")] {
            plan.check_axis(axis, field)?;
        }
        Ok(plan)
    }

    /// The cases as cells of a sweep; the shard depends on the paths selected by `count`.
    pub(super) fn cells(&self, count: fn(&str) -> bool) -> Vec<Cell> {
        self.cases
            .iter()
            .map(|case| Cell {
                key: case.key(|_| true),
                shard: case.key(count).mixed(),
                steps: case.increments,
            })
            .collect()
    }

    /// The values of a case that define its problem: all columns except those about how it is computed.
    pub(super) fn posed<'a>(&self, case: &'a Case) -> Vec<&'a str> {
        self.columns
            .iter()
            .zip(&case.values)
            .filter(|(path, _)| poses(path))
            .map(|(_, value)| value.as_str())
            .collect()
    }

    /// Everything that the results depend on, by name.
    pub fn input(&self) -> Vec<(String, String)> {
        let mut parts: Vec<(String, String)> = Vec::new();
        let mut posed: Option<&Arc<SceneData>> = None;
        for case in &self.cases {
            if posed.is_some_and(|posed| Arc::ptr_eq(posed, &case.of)) {
                continue;
            }
            posed = Some(&case.of);
            parts.push(case.of.input());
        }
        let Study { set, vary, .. } = &self.study;
        let varied = vary
            .iter()
            .map(|vary| (format!("{} over", vary.path), vary.values.join(", ")));
        parts.extend(set.iter().cloned().chain(varied));
        parts
    }

    /// Adds the cases of one scene.
    fn lay_out(&mut self, name: &str) -> Result<(), SceneError> {
        let study = &self.study;
        let base = Base::new(Scene::open(name, &[])?);
        let scene = base.scene();
        let known = paths::list(&scene.spec);
        if self.title.is_empty() {
            self.title.clone_from(&scene.spec.title);
        }
        // Each path that is set, with the index of its setting or variation.
        let patterns = study
            .set
            .iter()
            .map(|(path, _)| path)
            .chain(study.vary.iter().map(|vary| &vary.path));
        let mut set: Vec<(String, usize)> = Vec::new();
        for (k, pattern) in patterns.enumerate() {
            set.extend(expanded(&known, pattern).into_iter().map(|path| (path, k)));
        }
        let own: Vec<String> = scene
            .model
            .monitors
            .iter()
            .map(|m| m.name.clone())
            .collect();
        let meshes = scene
            .imports()
            .then(|| digest(&format!("{:?}", scene.spec.nodes)));
        let parts = std::iter::once(scene.text.as_str()).chain(meshes.as_deref());
        let posed = Arc::new(SceneData {
            text: scene.text.as_str().into(),
            key: Key::from_parts(parts),
            meshes,
            places: set.iter().map(|(path, _)| base.find(path)).collect(),
            paths: set.iter().map(|(path, _)| path.clone()).collect(),
            base,
        });
        for settings in product(&study.vary) {
            let varied = settings.into_iter().map(|(_, value)| value);
            let mut given: Vec<String> = study.set.iter().map(|(_, v)| v.clone()).collect();
            let fixed = given.len();
            given.extend(varied);
            let of_path = |(path, k): &(String, usize)| {
                multiple(&known, path, &given[*k]).unwrap_or_else(|| given[*k].clone())
            };
            let scene = (study.scenes.len() > 1).then(|| name.to_owned());
            let mut case = Case {
                of: posed.clone(),
                set: set.iter().map(of_path).collect(),
                values: scene.into_iter().chain(given.split_off(fixed)).collect(),
                increments: 0,
            };
            let names = case.check().map_err(|error| {
                let blamed = set.iter().zip(&case.set).find(|((path, _), value)| {
                    let set = shortened(&format!("{path}={value}"));
                    error.set.as_ref() == Some(&set)
                });
                match blamed {
                    Some(((_, k), _)) => study.setting_fault(*k, error),
                    None => error,
                }
            })?;
            for name in names.as_ref().unwrap_or(&own) {
                if !self.monitors.contains(name) {
                    self.monitors.push(name.clone());
                }
            }
            self.cases.push(case);
        }
        Ok(())
    }

    fn check_axis(&self, axis: &AxisQuantity, field: &str) -> Result<(), SceneError> {
        let AxisQuantity::Monitor(name) = axis else {
            return Ok(());
        };
        if self.monitors.contains(name) {
            return Ok(());
        }
        let known = || {
            let words = ["load", "increment", "majors", "minors"];
            words
                .into_iter()
                .chain(self.monitors.iter().map(String::as_str))
        };
        let message = format!(
            "unknown quantity {name:?}{}; available: {}",
            did_you_mean(name, known()),
            some_of(known())
        );
        Err(self.study.fault(&at![field], message))
    }
}

impl SceneData {
    fn input(&self) -> (String, String) {
        let meshes = self.meshes.as_deref().unwrap_or_default();
        let (text, name) = (digest(&self.text), &self.base.scene().name);
        ("scene".to_owned(), format!("{text}{meshes} ({name})"))
    }
}

/// Whether a path belongs to the problem, and not to how it is computed.
pub(super) fn poses(path: &str) -> bool {
    !path.starts_with("settings.") && !["history.increment", "history.least"].contains(&path)
}

/// Completes paths, and rejects empty, repeated or too many values.
fn check_values(study: &mut Study) -> Result<(), SceneError> {
    if let Some(first) = study.scenes.first() {
        let spec = Scene::open(first, &[])?.spec;
        let paths = study.vary.iter_mut().map(|vary| &mut vary.path);
        for path in paths.chain(study.set.iter_mut().map(|(path, _)| path)) {
            *path = paths::whole(&spec, path);
        }
    }
    let wrong = |at: Path, message: String| Err(study.fault(&at, message));
    let mut cases = study.scenes.len() as u64;
    for (k, vary) in study.vary.iter().enumerate() {
        let Vary { path, values } = vary;
        if study.vary[..k].iter().any(|other| other.path == *path) {
            return wrong(at!["vary", k], format!("{path} is varied twice"));
        }
        if values.is_empty() {
            return wrong(at!["vary", k], format!("{path} has no values to vary over"));
        }
        if let Some(value) = (1..values.len()).find(|&j| values[..j].contains(&values[j])) {
            let at = at!["vary", k, 1, value];
            return wrong(at, format!("{path} has the value {} twice", values[value]));
        }
        cases = cases.saturating_mul(values.len() as u64);
    }
    if cases > MOST_CASES {
        return wrong(
            at!["vary"],
            format!("the study has {cases} runs; the limit is {MOST_CASES} (`help cluster`)"),
        );
    }
    Ok(())
}

/// All combinations of values, path by path; the last path changes fastest.
pub fn product(vary: &[Vary]) -> Vec<Vec<(String, String)>> {
    let mut all = vec![Vec::new()];
    for Vary { path, values } in vary {
        all = all
            .iter()
            .flat_map(|head: &Vec<(String, String)>| {
                values.iter().map(|value| {
                    let mut settings = head.clone();
                    settings.push((path.clone(), value.clone()));
                    settings
                })
            })
            .collect();
    }
    all
}

/// The value of `2x`: twice the scene's value; `None` if it is not a multiple, or the scene's value is not a
/// number.
fn multiple(known: &[ListedScalar], path: &str, value: &str) -> Option<String> {
    let factor: f64 = value.strip_suffix('x')?.parse().ok()?;
    let own = known.iter().find(|listed| listed.path == path)?;
    let product = factor * own.value.parse::<f64>().ok()?;
    // Formatted as typed, without the round-off of the product.
    let short: f64 = format!("{product:.12e}").parse().ok()?;
    Some(short.to_string())
}

/// The paths of a scene that match a pattern, with `*` for any step. A pattern without a match is
/// returned unchanged, and the scene rejects it.
fn expanded(known: &[ListedScalar], pattern: &str) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    if pattern.contains('*') {
        let paths = known.iter().map(|listed| &listed.path);
        all.extend(paths.filter(|path| fits(pattern, path)).cloned());
    }
    if all.is_empty() {
        all.push(pattern.to_owned());
    }
    all
}

/// Whether a path matches a pattern with `*` for one step between dots.
fn fits(pattern: &str, path: &str) -> bool {
    let (pattern, path): (Vec<_>, Vec<_>) =
        (pattern.split('.').collect(), path.split('.').collect());
    pattern.len() == path.len()
        && pattern
            .iter()
            .zip(&path)
            .all(|(wanted, step)| *wanted == "*" || wanted == step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_matches_one_step() {
        assert!(fits("materials.*.update", "materials.lower.update"));
        assert!(!fits("materials.*.update", "materials.lower.E"));
        assert!(!fits("materials.*", "materials.lower.E"));
    }

    #[test]
    fn the_last_path_changes_fastest() {
        let vary = |path: &str, values: &[&str]| Vary {
            path: path.into(),
            values: values.iter().map(|v| v.to_string()).collect(),
        };
        let all = product(&[vary("a", &["1", "2"]), vary("b", &["x", "y"])]);
        let values: Vec<String> = all.iter().map(|c| c[0].1.clone() + &c[1].1).collect();
        assert_eq!(values, ["1x", "1y", "2x", "2y"]);
        assert_eq!(product(&[]).len(), 1);
    }
}
