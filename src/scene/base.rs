//! A scene that is read once, to be had with many settings: what a study runs.
//!
//! Paths are found once ([`Base::find`]). Where all that is set are choices that nothing else of the model hangs on
//! (friction, loads, increments, most settings), they are put into a copy of the model; where not, the scene is compiled again.
//! Either has every bit of [`Scene::from_text`] with the same settings. That alone says what is wrong with them: where it
//! would refuse, there is nothing here.

use super::Scene;
use super::compile::{Choices, Compiled, Groups, Loads, compile, renewed};
use crate::format::error::at;
use crate::format::{Spec, paths};
use stickslip_core::model::Model;

/// A scene as its author wrote it, and what helps to change it.
#[derive(Debug, Clone)]
pub struct Base {
    scene: Scene,
    choices: Choices,
    groups: Option<Groups>,
}

/// Where a scalar of a base stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    in_scene: paths::Found,
    /// Where it is a choice.
    in_choices: Option<paths::Found>,
}

impl Base {
    /// A scene to start from.
    pub fn new(scene: Scene) -> Base {
        Base {
            choices: Choices::of(&scene.spec),
            groups: Groups::of(&compiled(&scene)),
            scene,
        }
    }

    /// The scene without any more settings.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Finds a scalar; `None` if there is none of that path, or if a text is read otherwise for it.
    pub fn find(&self, path: &str) -> Option<Place> {
        let in_scene = paths::find(&self.scene.spec, path)?;
        if in_scene.at == at!["settings", "memory"] {
            return None;
        }
        let is_choice = Choices::has(&in_scene.at);
        let in_choices = is_choice.then(|| paths::find(self.choices.spec(), path));
        Some(Place {
            in_scene,
            in_choices: in_choices.flatten(),
        })
    }

    /// The model with values at places; `None` where they will not do.
    pub fn model(&self, settings: &[(&Place, &str)]) -> Option<Model> {
        if let (Some(groups), Some((choices, loads))) = (&self.groups, self.chosen(settings)) {
            return Some(renewed(&self.scene.model, groups, &choices, loads));
        }
        let mut spec = self.scene.spec.clone();
        for (place, value) in settings {
            place.in_scene.set(&mut spec, value)?;
        }
        compile(&spec).ok().map(|(model, _)| model)
    }

    /// The model of the scene solved in a way that was made of a scene with the same settings and history; `None` where it
    /// will not do.
    pub fn solved_by(&self, method: &Method) -> Option<Model> {
        let choices = self.choices.with_method_of(&method.0);
        let loads = choices.loads(&compiled(&self.scene))?;
        let groups = self.groups.as_ref()?;
        Some(renewed(&self.scene.model, groups, &choices, loads))
    }

    /// Number of increments with values at places, if they are nothing but choices, and will do.
    pub fn increments(&self, settings: &[(&Place, &str)]) -> Option<f64> {
        self.groups.as_ref()?;
        let (choices, _) = self.chosen(settings)?;
        Some(choices.increments())
    }

    /// The choices with values at places, and what loads they make; `None` where not all are choices, or will not do.
    fn chosen(&self, settings: &[(&Place, &str)]) -> Option<(Choices, Loads)> {
        let mut choices = self.choices.clone();
        for (place, value) in settings {
            choices.set(place.in_choices.as_ref()?, value)?;
        }
        let loads = choices.loads(&compiled(&self.scene))?;
        Some((choices, loads))
    }
}

fn compiled(scene: &Scene) -> Compiled<'_> {
    Compiled {
        spec: &scene.spec,
        names: &scene.names,
        model: &scene.model,
    }
}

/// A way of solving that suits many scenes: settings and a history that hang on nothing else of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Method(Choices);

impl Method {
    /// That of a scene with values at paths, the first or last step of which may be left out; `None` if anything
    /// else of the scene is to be set.
    pub fn of(spec: &Spec, settings: &[(String, String)]) -> Option<Method> {
        let mut choices = Choices::of(spec);
        for (path, value) in settings {
            let own = choices.spec();
            let found = paths::find(own, &paths::whole(own, path))?;
            if !Choices::has_of_method(&found.at) {
                return None;
            }
            choices.set(&found, value)?;
            // Each is refused on its own, whatever is set after it.
            if !choices.are_sound() {
                return None;
            }
        }
        Some(Method(choices))
    }

    /// Number of increments of its history.
    pub fn increments(&self) -> f64 {
        self.0.increments()
    }
}
