//! Changes values of a compiled model on which no other part of the model depends.
//!
//! If a function here returns nothing, compile the scene with [`compile`](super::compile), which also reports errors.

use super::super::nodes::Names;
use super::layout::{Layout, Loads};
use super::linear::free_motions;
use super::{history, interface};
use crate::Spec;
use crate::format::error::{Path, Step};
use crate::format::paths;
use crate::format::spec::SlaveSpec;
use stickslip_core::groups::marked;
use stickslip_core::{Control, Estimate, Model};

/// Settings that are used outside the solver too: they move nodes, create surfaces, or make the scene invalid.
const DEEP: [&str; 4] = ["initial_gaps", "adjust_gap", "point_force", "memory"];
/// Fields of the history that the model stores unchanged.
const OF_HISTORY: [&str; 5] = ["path", "increment", "increments", "least", "jumps"];
/// Fields of a load that set its size, not where it acts or what it restrains.
const OF_LOADS: [&str; 5] = ["x", "y", "normal", "value", "scale"];

/// The choices of a scene, as its author wrote them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Choices {
    /// A scene that contains nothing else except what its loads refer to; its slave groups name no nodes.
    spec: Spec,
    /// Whether a load was changed.
    loaded: bool,
}

/// A model and the scene from which it was compiled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Compiled<'a> {
    pub(crate) spec: &'a Spec,
    pub(crate) names: &'a Names,
    pub(crate) model: &'a Model,
}

/// The slave group of each contact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Groups(pub(crate) Vec<usize>);

impl Choices {
    /// The choices of a scene.
    pub(crate) fn from_spec(spec: &Spec) -> Choices {
        let group = |own: &SlaveSpec| SlaveSpec {
            nodes: Vec::new(),
            on: Vec::new(),
            sides: Vec::new(),
            ..own.clone()
        };
        Choices {
            spec: Spec {
                slaves: spec.slaves.iter().map(group).collect(),
                supports: spec.supports.clone(),
                loads: spec.loads.clone(),
                friction: spec.friction,
                history: spec.history.clone(),
                settings: spec.settings,
                ..Spec::default()
            },
            loaded: false,
        }
    }

    /// The reduced scene, for looking up scalars.
    pub(crate) fn spec(&self) -> &Spec {
        &self.spec
    }

    /// Sets a scalar; `None` if it does not exist there or the value has the wrong kind.
    pub(crate) fn set(&mut self, path: &str, value: &str) -> Option<()> {
        let change = paths::set(&mut self.spec, path, value).ok()?;
        self.loaded |= key(&change.at, 0) == "loads";
        Some(())
    }

    /// Whether the value at a path is a choice.
    pub(crate) fn has(path: &Path) -> bool {
        match key(path, 0) {
            "friction" => true,
            "slaves" => key(path, 2) == "friction",
            "loads" => OF_LOADS.contains(&key(path, 2)),
            _ => Choices::has_of_method(path),
        }
    }

    /// Whether the value at a path is part of the solution method.
    pub(crate) fn has_of_method(path: &Path) -> bool {
        match key(path, 0) {
            "settings" => !DEEP.contains(&key(path, 1)),
            "history" => OF_HISTORY.contains(&key(path, 1)),
            _ => false,
        }
    }

    /// These choices with the settings and the history of others.
    pub(crate) fn with_method_of(&self, other: &Choices) -> Choices {
        let mut own = self.clone();
        own.spec.settings = other.spec.settings;
        own.spec.history.clone_from(&other.spec.history);
        own
    }

    /// The loads for these choices, in a model that is valid with other choices of its scene; `None` if they do not fit the
    /// model.
    pub(crate) fn loads(&self, with: &Compiled<'_>) -> Option<Loads> {
        let solver = self.spec.settings.solver;
        let fits = || Estimate::from_model(with.model).too_large(solver).is_none();
        let areas = with
            .model
            .contacts
            .iter()
            .all(|contact| contact.area.is_some());
        let suit = self.are_sound()
            && (areas || !self.has_adhesion())
            && (solver == with.model.settings.solver || fits());
        match suit {
            true if self.loaded => self.other_loads(with),
            true => Some(Loads {
                dead: with.model.loads.clone(),
                pressures: with.model.pressures.clone(),
                prescribed: with.model.prescribed.clone(),
            }),
            false => None,
        }
    }

    /// The same for changed loads.
    fn other_loads(&self, with: &Compiled<'_>) -> Option<Loads> {
        let (names, bodies) = (with.names, &with.model.bodies);
        let nodes = bodies.iter().flat_map(|body| &body.nodes);
        let mut layout = Layout::new(marked(names.nodes.len(), nodes), bodies);
        layout.supports(&self.spec, names).ok()?;
        let mut loads = layout.loads(&self.spec, names, bodies).ok()?;
        loads
            .dead
            .extend(free_motions(with.spec, bodies, &with.model.dofs));
        Some(loads)
    }

    /// Whether the choices are valid by themselves.
    pub(crate) fn are_sound(&self) -> bool {
        let Spec {
            history,
            settings,
            friction,
            slaves,
            ..
        } = &self.spec;
        // Arc-length parameters are checked against the settings.
        let load = history.control == Control::Load;
        let own = slaves.iter().filter_map(|group| group.friction.as_ref());
        let mut frictions = std::iter::once(friction).chain(own);
        load && history::settings(settings).is_ok()
            && history::history(history).is_ok()
            && frictions.all(|own| interface::friction(&Path::default(), own).is_ok())
    }

    /// Whether any friction is per area.
    fn has_adhesion(&self) -> bool {
        self.spec
            .slaves
            .iter()
            .filter_map(|group| group.friction)
            .chain([self.spec.friction])
            .any(|friction| friction.adhesion != 0.0)
    }

    /// Number of increments of the history.
    pub fn increments(&self) -> f64 {
        let history = &self.spec.history;
        history::increments(&history.path, |leg| history.on_leg(leg))
    }
}

/// A step of a path, if it is a key.
fn key(path: &Path, step: usize) -> &str {
    match path.0.get(step) {
        Some(Step::Key(key)) => key,
        _ => "",
    }
}

impl Groups {
    /// The groups of a scene; `None` if a contact belongs to no group, which does not happen.
    pub(crate) fn from_scene(scene: &Compiled<'_>) -> Option<Groups> {
        let mut of_node = vec![None; scene.model.nodes.len()];
        for (k, group) in scene.spec.slaves.iter().enumerate() {
            for name in &group.nodes {
                for node in scene.names.nodes(name).ok()? {
                    *of_node.get_mut(node)? = Some(k);
                }
            }
        }
        scene
            .model
            .contacts
            .iter()
            .map(|contact| {
                let (node, _) = contact.carriers().next()?;
                of_node.get(node).copied().flatten()
            })
            .collect::<Option<Vec<usize>>>()
            .map(Groups)
    }
}

/// A model with choices of the same scene and the resulting loads.
pub(crate) fn renewed(model: &Model, groups: &Groups, choices: &Choices, loads: Loads) -> Model {
    let spec = &choices.spec;
    let mut model = model.clone();
    (model.loads, model.pressures) = (loads.dead, loads.pressures);
    model.prescribed = loads.prescribed;
    model.path.clone_from(&spec.history.path);
    model.increment = spec.history.increment;
    model.increments.clone_from(&spec.history.increments);
    model.least = spec.history.least;
    model.jumps = spec.history.jumps;
    model.settings = history::resolved(&spec.settings, &model.bodies);
    for (contact, &group) in model.contacts.iter_mut().zip(&groups.0) {
        let own = spec.slaves.get(group).and_then(|group| group.friction);
        if !contact.bond.is_tied() {
            contact.friction = own.unwrap_or(spec.friction).of_node(contact.area);
        }
    }
    model
}
