//! A scene that is read once and used with many settings, as in studies.
//!
//! If only values change on which no other part of the model depends (friction, loads, increments, most settings), they are written
//! to a copy of the model; otherwise the scene is compiled again. Both ways give the same bits as [`Scene::from_text`] with these
//! settings. Errors are reported only by `from_text`: where it would fail, the functions here return `None`.

use super::Scene;
use super::compile::{Choices, Compiled, Groups, Loads, compile, renewed};
use super::scene::instead_of;
use crate::Spec;
use crate::format::error::at;
use crate::format::paths;
use stickslip_core::Model;

/// A scene as written by its author, with data for changing it.
#[derive(Debug, Clone)]
pub struct Base {
    scene: Scene,
    choices: Choices,
    groups: Option<Groups>,
}

/// A scalar of a base.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarLocation {
    path: String,
    is_choice: bool,
}

impl Base {
    /// Creates a base from a scene.
    pub fn new(scene: Scene) -> Base {
        Base {
            choices: Choices::from_spec(&scene.spec),
            groups: Groups::from_scene(&compiled(&scene)),
            scene,
        }
    }

    /// The scene without further settings.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Finds a scalar; `None` if the path does not exist or has no effect, or its text has a different format.
    pub fn find(&self, path: &str) -> Option<ScalarLocation> {
        let spec = &self.scene.spec;
        let at = paths::find(spec, path).filter(|_| instead_of(spec, path).is_none())?;
        (at != at!["settings", "memory"]).then(|| ScalarLocation {
            path: path.to_owned(),
            is_choice: Choices::has(&at),
        })
    }

    /// The model with new values; `None` if they are invalid.
    pub fn model(&self, settings: &[(&ScalarLocation, &str)]) -> Option<Model> {
        if let (Some(groups), Some((choices, loads))) = (&self.groups, self.chosen(settings)) {
            return Some(renewed(&self.scene.model, groups, &choices, loads));
        }
        let mut spec = self.scene.spec.clone();
        for (place, value) in settings {
            paths::set(&mut spec, &place.path, value).ok()?;
        }
        compile(&spec).ok().map(|(model, _)| model)
    }

    /// The model of this scene, solved with the settings and history of a method; `None` if that is invalid.
    pub fn solved_by(&self, method: &Method) -> Option<Model> {
        let choices = self.choices.with_method_of(&method.0);
        let loads = choices.loads(&compiled(&self.scene))?;
        let groups = self.groups.as_ref()?;
        Some(renewed(&self.scene.model, groups, &choices, loads))
    }

    /// Number of increments with new values, if they are all choices and valid.
    pub fn increments(&self, settings: &[(&ScalarLocation, &str)]) -> Option<f64> {
        self.groups.as_ref()?;
        let (choices, _) = self.chosen(settings)?;
        Some(choices.increments())
    }

    /// The choices with new values, and the resulting loads; `None` if some value is not a choice or is invalid.
    fn chosen(&self, settings: &[(&ScalarLocation, &str)]) -> Option<(Choices, Loads)> {
        let mut choices = self.choices.clone();
        for (place, value) in settings {
            choices.set(place.is_choice.then_some(&place.path)?, value)?;
        }
        let loads = choices.loads(&compiled(&self.scene))?;
        Some((choices, loads))
    }
}

fn compiled(scene: &Scene) -> Compiled<'_> {
    Compiled {
        spec: &scene.spec,
        names: scene.names(),
        model: &scene.model,
    }
}

/// A solution method for many scenes: settings and a history that do not depend on the rest of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Method(Choices);

impl Method {
    /// The method of a scene with new values; the first or last step of a path may be omitted. `None` if a path is not part of
    /// the method.
    pub fn from_spec(spec: &Spec, settings: &[(String, String)]) -> Option<Method> {
        let mut choices = Choices::from_spec(spec);
        for (path, value) in settings {
            let own = choices.spec();
            let path = paths::whole(own, path);
            if !Choices::has_of_method(&paths::find(own, &path)?) {
                return None;
            }
            choices.set(&path, value)?;
            // Each value must be valid independently of later ones.
            if !choices.are_sound() {
                return None;
            }
        }
        Some(Method(choices))
    }

    /// Number of increments of the history.
    pub fn increments(&self) -> f64 {
        self.0.increments()
    }
}
