//! Changes at the cursor: interventions, given sequences of steps, and settings.

use super::machine::{Session, Task};
use super::worker::Steps;
use crate::explain::current_scene::CurrentScene;
use crate::explain::report;
use crate::history::branches;
use crate::refusal::Refusal;
use stickslip_core::step::state::Controls;
use stickslip_core::{Intervention, State};

impl Session {
    /// Applies an intervention at the cursor; `setting` is the path and value that it came from.
    pub(super) fn intervene(
        &mut self,
        intervention: Intervention,
        setting: Option<(&str, &str)>,
    ) -> Result<String, Refusal> {
        let offers = self.connection.capabilities();
        offers.check(&intervention).map_err(Refusal::new)?;
        if self.cursor() < self.timeline.tip() {
            self.timeline.check_room()?;
        }
        let mut state = self.frame().state.clone();
        state
            .intervene(self.model(), &intervention)
            .map_err(Refusal::new)?;
        let then = self.value_of(setting, &self.frame().state);
        let mut reply = match (then, self.value_of(setting, &state)) {
            (Some((path, then)), Some((_, now))) if then == now => format!("{path} stays {now}"),
            (Some((path, then)), Some((_, now))) => {
                format!("{path} changed from {then} to {now}")
            }
            _ => report::intervention(self.model(), &intervention),
        };
        reply.extend(setting.and_then(|(path, _)| self.overruled(path, &state)));
        let label = branches::label(self.model(), &intervention, setting);
        if let Some(branch) = self.timeline.intervene(state, intervention, label) {
            reply += &format!(" (in the new branch {branch})");
        }
        Ok(reply)
    }

    /// The intervention of `:set` at the cursor.
    pub(super) fn setting(&self, path: &str, value: &str) -> Result<Intervention, Refusal> {
        let State {
            controls, outside, ..
        } = &self.frame().state;
        match outside {
            Some(_) => self.connection.intervention(
                path.trim(),
                value.trim(),
                controls,
                &self.timeline.model().contacts,
            ),
            None => CurrentScene {
                scene: &self.scene,
                controls,
            }
            .intervention(path, value),
        }
    }

    /// The path of a setting, and its value in a state of our own solver.
    fn value_of<'a>(
        &self,
        setting: Option<(&'a str, &str)>,
        state: &State,
    ) -> Option<(&'a str, String)> {
        let (path, _) = setting.filter(|_| state.outside.is_none())?;
        let current = CurrentScene {
            scene: &self.scene,
            controls: &state.controls,
        };
        Some((path.trim(), current.value(path)?))
    }

    /// The value of a setting that a fallback puts in force instead of the chosen one, for the end of a reply.
    fn overruled(&self, path: &str, state: &State) -> Option<String> {
        let value = |controls: &Controls| {
            let scene = &self.scene;
            CurrentScene { scene, controls }.value(path)
        };
        let chosen = value(&state.controls).filter(|_| state.outside.is_none())?;
        state.fallbacks().find_map(|by| {
            let mut controls = (*state.controls).clone();
            controls.settings = by.in_force(controls.settings);
            let other = value(&controls).filter(|other| *other != chosen)?;
            let words = by.words();
            Some(format!("; in force: {other}, by the fallback \"{words}\""))
        })
    }

    /// Takes a sequence of steps from the cursor, in a new branch.
    pub(super) fn follow(
        &mut self,
        label: &str,
        steps: Vec<Option<Intervention>>,
    ) -> Result<String, Refusal> {
        let branch = self.timeline.fork(label)?;
        let reply = format!("running in the new branch {branch}");
        Ok(self.take_steps(steps) + &reply)
    }

    /// Starts a sequence of steps at the cursor, the end of the branch. Returns the iterations that the solver must repeat first,
    /// as the beginning of a reply.
    pub(super) fn take_steps(&mut self, steps: Vec<Option<Intervention>>) -> String {
        let before = self.timeline.strip().clone();
        self.work(self.cursor(), Task::Run, Steps::Follow { before, steps })
    }
}
