//! Changes at the cursor: interventions, given sequences of steps, and settings.

use super::machine::{Reply, Session, Task};
use super::refusal::Refusal;
use super::worker::Steps;
use crate::explain::report;
use crate::history::branches;
use crate::history::strip::PointKind;
use stickslip_core::model::{Contact, Friction};
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::state::Controls;
use stickslip_scene::Scene;
use stickslip_scene::format::contact_law::FrictionSpec;
use stickslip_scene::format::{Spec, paths};
use stickslip_scene::shown;

/// Relative difference below which two values are equal except for round-off.
const SAME: f64 = 1e-12;

/// Removes round-off of the relative size `SAME` of `from`: returns the scene's value if it is that close, and
/// 0 instead of a tiny or negative number.
fn told(found: f64, scene: f64, from: f64) -> f64 {
    let near = SAME * from.abs().max(scene.abs());
    match found {
        found if (found - scene).abs() <= near => scene,
        found if found <= near => 0.0,
        found => (found / near.max(f64::MIN_POSITIVE)).round() * near,
    }
}

impl Session {
    /// Applies an intervention at the cursor; `setting` is the path and value that it came from.
    pub(super) fn intervene(
        &mut self,
        intervention: Intervention,
        setting: Option<(&str, &str)>,
    ) -> Result<Reply, Refusal> {
        self.offers
            .check(&intervention)
            .map_err(Refusal::Intervention)?;
        if self.cursor + 1 < self.frames().len() {
            self.check_room()?;
        }
        let mut state = self.frame().state.clone();
        state
            .intervene(self.model(), &intervention)
            .map_err(Refusal::Intervention)?;
        let then = setting.and_then(|(path, _)| self.value_of(path, &self.frame().state.controls));
        let now = setting.and_then(|(path, _)| self.value_of(path, &state.controls));
        let mut told = match (setting, then, now) {
            (Some((path, _)), Some(then), Some(now)) if then == now => {
                format!("{} stays {now}", path.trim())
            }
            (Some((path, _)), Some(then), Some(now)) => {
                format!("{} changed from {then} to {now}", path.trim())
            }
            _ => report::intervention(self.model(), &intervention),
        };
        let label = branches::label(self.model(), &intervention, setting);
        let before = self.strips()[self.cursor].kind;
        let forks = self.tree.intervene(self.cursor, state, intervention);
        self.cursor += 1;
        let branch = &self.tree.branches()[self.tree.current()];
        if forks {
            self.tree.rename(label, false);
            let name = branches::name(&self.tree, self.tree.current());
            told += &format!(" (in the new branch {name})");
        } else if !branch.named
            && before == PointKind::Intervention
            && branch.from < self.cursor
            && branch.parent.is_some()
        {
            // Changes made before the first solve belong to the same branch.
            let label = format!("{}, {label}", branch.label);
            self.tree.rename(label, false);
        }
        Ok(Reply(told))
    }

    /// Refuses a new branch when the branches have used up their memory budget.
    fn check_room(&self) -> Result<(), Refusal> {
        let (taken, most) = (self.tree.kept(), self.branch_budget);
        match taken < most {
            true => Ok(()),
            false => Err(Refusal::NoRoom { taken, most }),
        }
    }

    /// Takes a sequence of steps from the cursor, in a new branch.
    pub(super) fn follow(
        &mut self,
        label: String,
        steps: Vec<Option<Intervention>>,
    ) -> Result<Reply, Refusal> {
        self.check_room()?;
        self.tree.fork(self.cursor);
        self.tree.rename(shown::line(&label).into_owned(), false);
        self.take_steps(steps);
        let name = branches::name(&self.tree, self.tree.current());
        Ok(Reply(
            self.way() + &format!("running in the new branch {name}"),
        ))
    }

    /// Starts a sequence of steps from the cursor, which is at the tip.
    pub(super) fn take_steps(&mut self, steps: Vec<Option<Intervention>>) {
        let before = self.strips()[self.cursor].clone();
        self.work(self.cursor, Task::Run, Steps::Follow { before, steps });
    }

    /// The scene with all changes made since.
    fn with(&self, controls: &Controls) -> Spec {
        let mut spec = self.scene.spec.clone();
        spec.settings = controls.settings;
        spec.history.increment = controls.increment;
        spec.friction = self.friction_in_force(controls);
        spec
    }

    /// The scene's friction with the values in force at its nodes. If these have one cohesion and one area, the
    /// split of the cohesion into a part per area and a part per node is the scene's.
    fn friction_in_force(&self, controls: &Controls) -> FrictionSpec {
        let scene = self.scene.spec.friction;
        let Some(first) = controls.friction.first() else {
            return scene;
        };
        let contacts = self.model().contacts.iter().zip(&controls.friction);
        let cohesion = |area: f64, now: &Friction| (area, now.cohesion);
        let by_area = contacts.filter_map(|(c, now)| {
            (c.friction == scene.of_node(c.area)).then_some(cohesion(c.area?, now))
        });
        let by_area: Vec<(f64, f64)> = by_area.collect();
        let order = |a: &&(f64, f64), b: &&(f64, f64)| a.0.total_cmp(&b.0);
        let ends = by_area
            .iter()
            .min_by(order)
            .zip(by_area.iter().max_by(order));
        let adhesion = match ends {
            Some((a, b)) if b.0 > a.0 * (1.0 + SAME) => (b.1 - a.1) / (b.0 - a.0),
            _ => scene.adhesion,
        };
        let adhesion = told(adhesion, scene.adhesion, first.cohesion);
        let own = self
            .model()
            .contacts
            .first()
            .and_then(|contact| contact.area);
        let cohesion = match adhesion {
            0.0 => first.cohesion,
            adhesion => {
                let rest = first.cohesion - adhesion * own.unwrap_or(0.0);
                told(rest, scene.cohesion, first.cohesion)
            }
        };
        FrictionSpec {
            angle: first.angle,
            cohesion,
            adhesion,
        }
    }

    /// A scalar of the scene with the changes made since, formatted as a user would type it.
    fn value_of(&self, path: &str, controls: &Controls) -> Option<String> {
        if self.frame().state.outside.is_some() {
            return None;
        }
        let all = paths::list(&self.with(controls));
        let listed = all.into_iter().find(|listed| listed.path == path.trim());
        let plain = |value: String| value.strip_suffix(".0").map_or(value.clone(), String::from);
        listed.map(|listed| plain(listed.value))
    }

    /// The intervention of `:set` for an attached solver: one of its parameters, or a setting of the debugger.
    fn parameter(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        let number = || {
            let number: Option<f64> = value.parse().ok();
            number.ok_or_else(|| Refusal::Unsound(format!("{value} is not a number")))
        };
        let controls = &self.frame().state.controls;
        let now = controls.friction.first().copied().unwrap_or_default();
        let known = self
            .offers
            .parameters
            .iter()
            .find(|known| known.name == path);
        match (path, known) {
            ("increment" | "history.increment", _) => Ok(Intervention::Increment(number()?)),
            ("friction", Some(_)) => Ok(Intervention::Friction(Friction::from_coefficient(
                number()?,
                now.cohesion,
            ))),
            ("friction.angle", _) if !self.offers.friction => {
                Err(Refusal::Unsound(self.offers.lacks("a friction change")))
            }
            ("cohesion" | "friction.cohesion", _) if !self.offers.cohesion => {
                Err(Refusal::Unsound(self.offers.lacks("a cohesion change")))
            }
            ("friction.angle", _) => Ok(Intervention::Friction(Friction {
                angle: number()?,
                ..now
            })),
            ("cohesion" | "friction.cohesion", _) if self.offers.cohesion => {
                Ok(Intervention::Friction(Friction {
                    cohesion: number()?,
                    ..now
                }))
            }
            (_, Some(known)) => Ok(Intervention::Parameter {
                name: path.to_owned(),
                value: known.read(value).map_err(Refusal::Intervention)?,
            }),
            (_, None) => Err(Refusal::NoParameter {
                name: path.to_owned(),
                known: self.offered_parameters(),
            }),
        }
    }

    /// Lists the parameters of an attached solver.
    fn offered_parameters(&self) -> String {
        let names = self
            .offers
            .parameters
            .iter()
            .map(|known| known.name.as_str());
        match names.collect::<Vec<_>>().join(", ") {
            none if none.is_empty() => "it has none".into(),
            names => format!("it has {names}"),
        }
    }

    /// The intervention of `:set`, on top of earlier changes.
    pub(super) fn setting(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        if self.frame().state.outside.is_some() {
            return self.parameter(path.trim(), value.trim());
        }
        let mut spec = self.with(&self.frame().state.controls);
        paths::set(&mut spec, path, value)?;
        let sound =
            Scene::from_spec(&self.scene.name, spec).map_err(|e| Refusal::Unsound(e.message))?;
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
            Err(Refusal::Unchangeable {
                path: path.into(),
                value: value.into(),
            })
        }
    }
}
