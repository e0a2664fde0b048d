//! A scene that has been read, and values set in it.

use crate::compile::{Compiled, Groups, compile};
use crate::format::paths::Override;
use crate::format::{Fault, error, locate, paths};
use crate::nodes::Names;
use crate::{SceneError, Spec};
use crate::{attached, import};
use stickslip_core::Model;
use stickslip_exchange::attach::message;

/// A scene that has been read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Path of the file, or name of the built-in scene.
    pub name: String,
    /// The file's text; empty for a scene created from a [`Spec`].
    pub text: String,
    /// The author's input, including values set from outside.
    pub spec: Spec,
    /// The model that the solver uses.
    pub model: Model,
    /// Warnings about parts of the file that were ignored or reinterpreted: location and text.
    pub remarks: Vec<String>,
    pub(crate) imports: bool,
    names: Names,
    overrides: Vec<Override>,
}

impl Scene {
    /// Checks a scene without a text, such as one from a snapshot.
    ///
    /// # Errors
    /// If the scene is invalid; the error has no line then.
    pub fn from_spec(name: &str, spec: Spec) -> Result<Scene, SceneError> {
        Scene::assemble(name, "", spec, &[], Vec::new())
    }

    /// The scene sent by an attached solver, under a name; `increment` is its first increment, if it sends one.
    ///
    /// # Errors
    /// If the scene is invalid.
    pub fn from_message(
        name: &str,
        message: &message::Scene,
        increment: Option<f64>,
    ) -> Result<Scene, SceneError> {
        Scene::from_spec(name, attached::spec(message, increment))
    }

    /// Checks a scene that is embedded in another file, at a path of its text; `name` identifies the file in messages.
    ///
    /// # Errors
    /// If the scene is invalid, with the location in that file.
    pub fn within(
        name: &str,
        text: &str,
        path: &error::Path,
        mut spec: Spec,
    ) -> Result<Scene, SceneError> {
        let at = |fault: Fault| {
            let whole = error::Path(path.0.iter().chain(&fault.path.0).cloned().collect());
            placed(name, text, &[], Fault::new(whole, fault.message))
        };
        import::resolve(&mut spec, name, at)?;
        Scene::compiled(name, "", spec, Vec::new(), |_, fault| at(fault))
    }

    /// This scene with one scalar changed, as by `--set` or by the debugger's `:set`.
    ///
    /// # Errors
    /// If the path does not exist, or the scene is invalid with the value.
    pub fn with(&self, path: &str, value: &str) -> Result<Scene, SceneError> {
        self.with_all(&[(path.to_owned(), value.to_owned())])
    }

    /// This scene with several scalars changed, one after the other.
    ///
    /// # Errors
    /// As [`Scene::with`].
    pub fn with_all(&self, changes: &[(String, String)]) -> Result<Scene, SceneError> {
        let scene = Scene::assemble(
            &self.name,
            &self.text,
            self.spec.clone(),
            changes,
            self.overrides.clone(),
        )?;
        Ok(Scene {
            remarks: self.remarks.clone(),
            imports: self.imports,
            ..scene
        })
    }

    /// Number of a node by any of its names: `ID.3`, `ID.end`, `ID@0.5`, or the id of a single node.
    ///
    /// # Errors
    /// A message that lists the existing names.
    pub fn node(&self, name: &str) -> Result<usize, String> {
        self.names.node(name)
    }

    /// Whether its text refers to mesh files, whose content the spec already includes.
    pub fn imports(&self) -> bool {
        self.imports
    }

    /// All node names and what they refer to.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// The slave group of each contact, numbered as in [`Spec::slaves`]; `None` if the scene has no slave groups.
    pub fn slave_groups(&self) -> Option<Vec<usize>> {
        let (spec, names, model) = (&self.spec, &self.names, &self.model);
        let groups = Groups::from_scene(&Compiled { spec, names, model })?;
        Some(groups.0)
    }

    /// The values set from outside, in order: path and value.
    pub fn overrides(&self) -> impl Iterator<Item = (&str, &str)> {
        self.overrides
            .iter()
            .map(|o| (o.path.as_str(), o.value.as_str()))
    }

    pub(crate) fn assemble(
        name: &str,
        text: &str,
        spec: Spec,
        changes: &[(String, String)],
        overrides: Vec<Override>,
    ) -> Result<Scene, SceneError> {
        let (spec, overrides) = changed(name, spec, changes, overrides)?;
        let place = |overrides: &[Override], fault| placed(name, text, overrides, fault);
        Scene::compiled(name, text, spec, overrides, place)
    }

    pub(crate) fn compiled(
        name: &str,
        text: &str,
        spec: Spec,
        overrides: Vec<Override>,
        place: impl Fn(&[Override], Fault) -> SceneError,
    ) -> Result<Scene, SceneError> {
        let (model, names) = compile(&spec).map_err(|fault| place(&overrides, fault))?;
        Ok(Scene {
            name: name.to_owned(),
            text: text.to_owned(),
            spec,
            model,
            remarks: Vec::new(),
            names,
            overrides,
            imports: false,
        })
    }
}

/// Why a value has no effect in a scene, and what to set instead.
pub(crate) fn instead_of(spec: &Spec, path: &str) -> Option<String> {
    if spec.in_space.is_some() && !path.starts_with("settings.") {
        return Some("in space; set settings.*, or change the contacts in the file".to_owned());
    }
    let field = path.strip_prefix("friction.")?;
    let own = !spec.slaves.is_empty() && spec.slaves.iter().all(|pair| pair.friction.is_some());
    own.then(|| format!("where every pair has its own friction; set slaves[0].friction.{field}"))
}

/// The scene of a file with additional values set from outside.
pub(crate) fn changed(
    name: &str,
    mut spec: Spec,
    changes: &[(String, String)],
    mut overrides: Vec<Override>,
) -> Result<(Spec, Vec<Override>), SceneError> {
    for (path, value) in changes {
        let refused = |why: String| SceneError {
            set: Some(error::shortened(&format!("{path}={value}"))),
            ..SceneError::whole(name, why)
        };
        let change = paths::set(&mut spec, path, value).map_err(|why| refused(why.to_string()))?;
        if let Some(instead) = instead_of(&spec, &change.path) {
            return Err(refused(format!("{} has no effect {instead}", change.path)));
        }
        overrides.retain(|earlier| earlier.at != change.at);
        overrides.push(change);
    }
    Ok((spec, overrides))
}

/// Determines the origin of a fault: a value set from outside, or a line of the file.
pub fn placed(file: &str, text: &str, overrides: &[Override], fault: Fault) -> SceneError {
    let Fault { path, message } = fault;
    // The last setting is the most likely cause; a fault of a compound value is attributed to a part of it that was set.
    let blamed = |o: &&Override| path == o.at || (!path.0.is_empty() && path.contains(&o.at));
    let set = overrides
        .iter()
        .rev()
        .find(blamed)
        .map(|o| error::shortened(&format!("{}={}", o.path, o.value)));
    let at = (set.is_none() && !text.is_empty())
        .then(|| locate::line_and_column(text, locate::locate(text, &path).start));
    SceneError {
        file: file.to_owned(),
        at,
        set,
        path: path.to_string(),
        message,
    }
}
