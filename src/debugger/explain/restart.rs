//! A changed scene, which is tried from its start to the load of a failure, for changes that are impossible within a run,
//! such as another mesh or material law.

use super::current_scene::CurrentScene;
use std::collections::HashSet;
use std::sync::Arc;
use stickslip_core::model::MonitorQuantity;
use stickslip_core::plane::distance;
use stickslip_core::{Failure, JudgedLaw, Model, RunEnd, State, Status, Stepper};
use stickslip_scene::format::paths;
use stickslip_scene::{Scene, Spec};

/// Maximum number of minor iterations in the trial of a changed scene.
pub(super) const BUDGET: u32 = 4000;

/// Distance up to which two nodes are at the same place, relative to the scene's length.
const SAME: f64 = 1e-6;

/// Distance between a contact point of a face and the next one, relative to the distance to the farthest node of the face.
const NEXT: f64 = 0.25;

/// How a trial ended.
#[derive(Debug, Clone, PartialEq)]
pub enum TrialEnd {
    /// The failed load was accepted.
    Converged,
    /// A state was accepted that violates this law, because of held modes or settings.
    Against(JudgedLaw),
    /// It failed.
    Failed(Failure),
    /// The budget is used up.
    Budget,
}

impl TrialEnd {
    /// The end of a run that stops itself with one; `None` if it was interrupted.
    pub(super) fn from_run(end: RunEnd<TrialEnd>) -> Option<TrialEnd> {
        Some(match end {
            RunEnd::Stopped(end) => end,
            RunEnd::Failed(failure) => TrialEnd::Failed(failure),
            RunEnd::Finished => TrialEnd::Converged,
            RunEnd::Spent => TrialEnd::Budget,
            RunEnd::Interrupted => return None,
        })
    }
}

/// The solver of a scene at its start, with the settings and friction of a failed state and then these changes, by path. `None`
/// if the scene cannot be built.
pub fn changed(spec: &Spec, state: &State, changes: &[(String, String)]) -> Option<Stepper> {
    let scene = Scene::from_spec("original", spec.clone()).ok()?;
    let current = CurrentScene {
        scene: &scene,
        controls: &state.controls,
    };
    let mut spec = current.spec();
    for (path, value) in changes {
        paths::set(&mut spec, path, value).ok()?;
    }
    let model = Scene::from_spec("changed", spec).ok()?.model;
    Some(Stepper::new(Arc::new(model)))
}

/// Whether a finer mesh has slave nodes, contact points of faces, supports, loads and monitors wherever the other mesh has them. A
/// name such as `beam.3` is that of another node on a finer mesh.
pub fn is_refined(finer: &Model, mesh: &Model) -> bool {
    let found = roles(finer);
    let near = SAME * mesh.length;
    let is_kept = |(role, at): &(Role, [f64; 2])| {
        let mut own = found.iter().filter(|(own, _)| own == role);
        own.any(|(_, own)| distance(*own, *at) <= near)
    };
    roles(mesh).iter().all(is_kept) && has_faces(finer, mesh)
}

/// Whether every contact point of a face lies next to one on the finer mesh, whose points on a face are closer than a quarter of it.
fn has_faces(finer: &Model, mesh: &Model) -> bool {
    let points = |model: &Model| {
        let contacts = model.contacts.iter().filter(|c| c.weights.len() > 1);
        let place = |node: usize| model.nodes[node].at;
        let points = contacts.map(|contact| {
            let at = place(contact.node);
            let carriers = contact
                .carriers()
                .map(|(node, _)| distance(place(node), at));
            (at, carriers.fold(0.0, f64::max))
        });
        points.collect::<Vec<_>>()
    };
    let finer = points(finer);
    let is_near = |at: [f64; 2]| {
        finer
            .iter()
            .any(|(own, reach)| distance(*own, at) <= NEXT * reach)
    };
    points(mesh).iter().all(|(at, _)| is_near(*at))
}

/// What a scene does with a node.
#[derive(PartialEq)]
enum Role {
    Slave,
    /// Restrains this component.
    Restrained(usize),
    /// Loads this component.
    Loaded(usize),
    /// Has a monitor with this name: on this component, or on the contact.
    Monitored(String, Option<usize>),
}

/// The nodes that a scene does something with: what, and where in the undeformed mesh.
fn roles(model: &Model) -> Vec<(Role, [f64; 2])> {
    let mut all = Vec::new();
    for contact in model.contacts.iter().filter(|c| c.weights.is_empty()) {
        all.push((Role::Slave, model.nodes[contact.node].at));
    }
    // Contact points of faces have no unknowns.
    let points = model.contacts.iter().filter(|c| !c.weights.is_empty());
    let points: HashSet<usize> = points.map(|contact| contact.node).collect();
    let loaded: HashSet<usize> = model.loads.iter().map(|load| load.dof).collect();
    for (dof, equation) in model.dofs.equation.iter().enumerate() {
        let Some((node, component)) = model.dofs.node_of(dof) else {
            continue;
        };
        let at = model.nodes[node].at;
        if equation.is_none() && !points.contains(&node) {
            all.push((Role::Restrained(component), at));
        }
        if loaded.contains(&dof) {
            all.push((Role::Loaded(component), at));
        }
    }
    for monitor in &model.monitors {
        let role = |component| Role::Monitored(monitor.name.clone(), component);
        match &monitor.of {
            MonitorQuantity::Displacement { dof } | MonitorQuantity::Reaction { dof } => {
                let node = model.dofs.node_of(*dof);
                all.extend(node.map(|(node, c)| (role(Some(c)), model.nodes[node].at)));
            }
            MonitorQuantity::Contact { slaves, .. }
            | MonitorQuantity::Modes { slaves, .. }
            | MonitorQuantity::Drift { slaves }
            | MonitorQuantity::Pressure { slaves, .. } => {
                let contacts = slaves.iter().map(|&slave| &model.contacts[slave]);
                let nodes = contacts.filter(|contact| contact.weights.is_empty());
                all.extend(nodes.map(|contact| (role(None), model.nodes[contact.node].at)));
            }
            MonitorQuantity::Reported { .. } | MonitorQuantity::Arc => {}
        }
    }
    all
}

/// The load at which an increment failed.
#[derive(Clone, Copy)]
pub(super) struct FailedLoad {
    leg: usize,
    load: f64,
    /// 1 if the load of that increment rises, -1 if it falls. Path following may lower it on a rising leg.
    way: f64,
}

impl FailedLoad {
    /// The load of the increment in which a state is.
    pub fn new(state: &State) -> FailedLoad {
        FailedLoad {
            leg: state.start.leg,
            load: state.load_factor,
            way: (state.load_factor - state.start.load_factor).signum(),
        }
    }

    /// The same for a run from the start, where it is reached in the direction of its leg.
    pub fn from_start(model: &Model, state: &State) -> FailedLoad {
        let mut target = FailedLoad::new(state);
        if let Some([from, to]) = model.path.get(target.leg..target.leg + 2) {
            target.way = (to - from).signum();
        }
        target
    }

    /// Whether the last accepted state has reached it.
    pub fn is_passed(self, state: &State) -> bool {
        let start = &state.start;
        let slack = 1e-9 * state.controls.increment;
        let on_leg = start.leg == self.leg && (start.load_factor - self.load) * self.way >= -slack;
        state.status == Status::Finished || start.leg > self.leg || on_leg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_passed_in_the_direction_of_its_increment() {
        let scene = Scene::open("osc-two6", &[]).unwrap();
        let mut state = Stepper::new(Arc::new(scene.model)).state().clone();
        let at = |state: &State, load: f64| {
            let mut state = state.clone();
            Arc::make_mut(&mut state.start).load_factor = load;
            state
        };
        for (from, failed, before, passed) in [(0.6, 0.2, 0.5, 0.1), (0.2, 0.6, 0.5, 0.7)] {
            state.load_factor = failed;
            let target = FailedLoad::new(&at(&state, from));
            assert!(!target.is_passed(&at(&state, from)));
            assert!(!target.is_passed(&at(&state, before)));
            assert!(target.is_passed(&at(&state, failed)));
            assert!(target.is_passed(&at(&state, passed)));
        }
    }
}
