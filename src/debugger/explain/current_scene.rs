//! The scene with the changes made during a run, and further changes of its scalars.

use crate::recorded::orders;
use crate::refusal::{Refusal, refusal};
use std::collections::BTreeMap;
use stickslip_core::step::state::Controls;
use stickslip_core::{Friction, Intervention};
use stickslip_scene::format::contact_law::FrictionSpec;
use stickslip_scene::format::paths;
use stickslip_scene::format::spec::History;
use stickslip_scene::{Scene, Spec};

/// Relative difference below which two values are equal except for round-off.
const SAME: f64 = 1e-12;

/// A scene, and the values in force in one of its states.
pub(crate) struct CurrentScene<'a> {
    pub scene: &'a Scene,
    pub controls: &'a Controls,
}

/// The contacts to which one friction of the scene applies.
struct FrictionGroup {
    /// Its number in [`Spec::slaves`], or of the contact in space; `None`: the scene's friction.
    own: Option<usize>,
    contacts: Vec<usize>,
    /// The values in force.
    friction: FrictionSpec,
}

impl CurrentScene<'_> {
    /// The scene with the settings and the frictions in force.
    pub fn spec(&self) -> Spec {
        let mut spec = self.scene.spec.clone();
        spec.settings = self.controls.settings;
        for FrictionGroup { own, friction, .. } in self.frictions() {
            match (own, &mut spec.in_space) {
                (None, _) => spec.friction = friction,
                (Some(k), Some(space)) => space.contacts[k].1 = friction.of_node(None),
                (Some(k), None) => spec.slaves[k].friction = Some(friction),
            }
        }
        spec
    }

    /// The frictions in force. Tied contacts have none.
    fn frictions(&self) -> Vec<FrictionGroup> {
        let (spec, model) = (&self.scene.spec, &self.scene.model);
        let groups = self.scene.slave_groups();
        let has_own = |group: &usize| {
            spec.slaves
                .get(*group)
                .is_some_and(|s| s.friction.is_some())
        };
        let mut contacts: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for (k, contact) in model.contacts.iter().enumerate() {
            let own = match &groups {
                _ if contact.bond.is_tied() => continue,
                _ if spec.in_space.is_some() => Some(k),
                Some(groups) => Some(groups[k]).filter(has_own),
                None => None,
            };
            contacts.entry(own).or_default().push(k);
        }
        let group = |(own, contacts): (Option<usize>, Vec<usize>)| {
            let of_group = own.and_then(|k| spec.slaves.get(k)?.friction);
            let now: Vec<(Option<f64>, Friction)> = contacts
                .iter()
                .map(|&k| (model.contacts[k].area, self.controls.friction[k]))
                .collect();
            FrictionGroup {
                own,
                contacts,
                friction: in_force(of_group.unwrap_or(spec.friction), &now),
            }
        };
        contacts.into_iter().map(group).collect()
    }

    /// A scalar with the changes, formatted as a user would type it. A friction that differs between contacts has several values.
    pub fn value(&self, path: &str) -> Option<String> {
        let value = |spec: &Spec| {
            let all = paths::list(spec);
            let listed = all.into_iter().find(|listed| listed.path == path.trim())?;
            let value = listed.value;
            Some(value.strip_suffix(".0").map_or(value.clone(), String::from))
        };
        if !path.trim().starts_with("friction.") {
            return value(&Spec {
                history: self.history(),
                ..self.spec()
            });
        }
        let with = |group: FrictionGroup| Spec {
            friction: group.friction,
            ..Spec::default()
        };
        let mut values: Vec<String> = Vec::new();
        for group in self.frictions() {
            values.extend(value(&with(group)).filter(|value| !values.contains(value)));
        }
        (!values.is_empty()).then(|| values.join(" and "))
    }

    /// The history with the increment in force.
    fn history(&self) -> History {
        History {
            increment: self.controls.increment,
            ..self.scene.spec.history.clone()
        }
    }

    /// The intervention of `:set`, on top of earlier changes. A path of the friction changes it at all contacts.
    pub fn intervention(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        let mut spec = Spec {
            history: self.history(),
            ..self.spec()
        };
        paths::set(&mut spec, path, value)?;
        let sound =
            Scene::from_spec(&self.scene.name, spec).map_err(|e| Refusal::new(e.message))?;
        if path.starts_with("settings.") {
            Ok(Intervention::Settings(sound.model.settings))
        } else if path.starts_with("friction.") {
            self.friction(path, value)
        } else if path == "history.increment" {
            Ok(Intervention::Increment(sound.spec.history.increment))
        } else {
            Err(refusal!(
                "{path} cannot change during a run; only friction.*, settings.* and history.increment can. Restart with --set {path}={value}"
            ))
        }
    }

    /// The change of one field of the friction at all contacts.
    fn friction(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        let mut all = self.controls.friction.clone();
        for group in self.frictions() {
            let mut spec = Spec {
                friction: group.friction,
                ..Spec::default()
            };
            paths::set(&mut spec, path, value)?;
            for k in group.contacts {
                all[k] = spec.friction.of_node(self.scene.model.contacts[k].area);
            }
        }
        Ok(orders::each_friction(all))
    }
}

/// The friction of a group of contacts from the values in force at its nodes, with their areas. If these have one cohesion, or one
/// area, the split of the cohesion into a part per area and a part per node is that of `given`.
fn in_force(given: FrictionSpec, now: &[(Option<f64>, Friction)]) -> FrictionSpec {
    let Some((area, first)) = now.first() else {
        return given;
    };
    let by_area = || {
        now.iter()
            .filter_map(|(area, now)| Some(((*area)?, now.cohesion)))
    };
    let order = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
    let adhesion = match by_area().min_by(order).zip(by_area().max_by(order)) {
        Some((a, b)) if b.0 > a.0 * (1.0 + SAME) => (b.1 - a.1) / (b.0 - a.0),
        _ => given.adhesion,
    };
    let adhesion = without_round_off(adhesion, given.adhesion, first.cohesion);
    let cohesion = match adhesion {
        0.0 => first.cohesion,
        adhesion => {
            let rest = first.cohesion - adhesion * area.unwrap_or(0.0);
            without_round_off(rest, given.cohesion, first.cohesion)
        }
    };
    FrictionSpec {
        angle: first.angle,
        cohesion,
        adhesion,
    }
}

/// Removes round-off of the relative size `SAME` of `from`: returns the scene's value if it is that close,
/// 0 instead of a tiny or negative number, and otherwise 12 digits.
fn without_round_off(found: f64, scene: f64, from: f64) -> f64 {
    let near = SAME * from.abs().max(scene.abs());
    match found {
        found if (found - scene).abs() <= near => scene,
        found if found <= near => 0.0,
        found => format!("{found:.11e}").parse().unwrap_or(found),
    }
}
