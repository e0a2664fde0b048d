//! The scene with the changes made during a run, and further changes of its scalars.

use crate::refusal::{Refusal, refusal};
use stickslip_core::step::state::Controls;
use stickslip_core::{Contact, Friction, Intervention};
use stickslip_scene::format::contact_law::FrictionSpec;
use stickslip_scene::format::paths;
use stickslip_scene::{Scene, Spec};

/// Relative difference below which two values are equal except for round-off.
const SAME: f64 = 1e-12;

/// A scene, and the values in force in one of its states.
pub(super) struct CurrentScene<'a> {
    pub scene: &'a Scene,
    pub controls: &'a Controls,
}

impl CurrentScene<'_> {
    /// The scene with all changes.
    fn spec(&self) -> Spec {
        let mut spec = self.scene.spec.clone();
        spec.settings = self.controls.settings;
        spec.history.increment = self.controls.increment;
        spec.friction = self.friction();
        spec
    }

    /// The scene's friction with the values in force at its nodes. If these have one cohesion and one area, the
    /// split of the cohesion into a part per area and a part per node is the scene's.
    fn friction(&self) -> FrictionSpec {
        let scene = self.scene.spec.friction;
        let Some(first) = self.controls.friction.first() else {
            return scene;
        };
        let all = &self.scene.model.contacts;
        let contacts = all.iter().zip(&self.controls.friction);
        let cohesion = |area: f64, now: &Friction| (area, now.cohesion);
        let by_area: Vec<(f64, f64)> = contacts
            .filter_map(|(c, now)| {
                (c.friction == scene.of_node(c.area)).then_some(cohesion(c.area?, now))
            })
            .collect();
        let order = |a: &&(f64, f64), b: &&(f64, f64)| a.0.total_cmp(&b.0);
        let ends = by_area
            .iter()
            .min_by(order)
            .zip(by_area.iter().max_by(order));
        let adhesion = match ends {
            Some((a, b)) if b.0 > a.0 * (1.0 + SAME) => (b.1 - a.1) / (b.0 - a.0),
            _ => scene.adhesion,
        };
        let adhesion = without_round_off(adhesion, scene.adhesion, first.cohesion);
        let own = all.first().and_then(|contact| contact.area);
        let cohesion = match adhesion {
            0.0 => first.cohesion,
            adhesion => {
                let rest = first.cohesion - adhesion * own.unwrap_or(0.0);
                without_round_off(rest, scene.cohesion, first.cohesion)
            }
        };
        FrictionSpec {
            angle: first.angle,
            cohesion,
            adhesion,
        }
    }

    /// A scalar with the changes, formatted as a user would type it.
    pub fn value(&self, path: &str) -> Option<String> {
        let all = paths::list(&self.spec());
        let listed = all.into_iter().find(|listed| listed.path == path.trim());
        let plain = |value: String| value.strip_suffix(".0").map_or(value.clone(), String::from);
        listed.map(|listed| plain(listed.value))
    }

    /// The intervention of `:set`, on top of earlier changes.
    pub fn intervention(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        let mut spec = self.spec();
        paths::set(&mut spec, path, value)?;
        let sound =
            Scene::from_spec(&self.scene.name, spec).map_err(|e| Refusal::new(e.message))?;
        if path.starts_with("settings.") {
            Ok(Intervention::Settings(sound.model.settings))
        } else if path.starts_with("friction.") {
            let friction = sound.spec.friction;
            let of_node = |contact: &Contact| friction.of_node(contact.area);
            Ok(match friction.adhesion {
                0.0 => Intervention::Friction(friction.of_node(None)),
                _ => Intervention::Frictions(sound.model.contacts.iter().map(of_node).collect()),
            })
        } else if path == "history.increment" {
            Ok(Intervention::Increment(sound.spec.history.increment))
        } else {
            Err(refusal!(
                "{path} cannot change during a run; only friction.*, settings.* and history.increment can. Restart with --set {path}={value}"
            ))
        }
    }
}

/// Removes round-off of the relative size `SAME` of `from`: returns the scene's value if it is that close, and
/// 0 instead of a tiny or negative number.
fn without_round_off(found: f64, scene: f64, from: f64) -> f64 {
    let near = SAME * from.abs().max(scene.abs());
    match found {
        found if (found - scene).abs() <= near => scene,
        found if found <= near => 0.0,
        found => (found / near.max(f64::MIN_POSITIVE)).round() * near,
    }
}
