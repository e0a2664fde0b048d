//! Analyses the interface problem that an attached solver reports: its consistent states, and whether Table 2
//! (or Newton's method) would cycle on it.
//!
//! The problem becomes a scene of contacts ([`mod@stickslip_scene::format::condensed`]), in total forces from
//! load zero to one. It is examined like a frozen problem of our own bodies; results are reported with the node
//! numbers of the solver's scene.

use super::examination::{DONE, Examination, census, examine_nodes, frozen};
use super::facts::{Fact, Part};
use super::names;
use super::walk::{ReportedIterations, walk};
use std::sync::Arc;
use stickslip_core::model::{InitialState, Mode, Model, Strategy};
use stickslip_core::step::solver::{Posed, PosedForm};
use stickslip_core::step::state::{State, Status};
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::Scene;
use stickslip_scene::format::SceneError;
use stickslip_scene::format::condensed::{Contact, Matrix, Problem};
use stickslip_scene::limits;

/// Shown without reported minor iterations of the problem.
const NOT_COMPARED: &str =
    "Table 2 applied to its interface problem; not compared with minor iterations of the solver";

/// The scene of a reported problem, starting with the modes of a state.
pub fn problem(model: &Model, state: &State, posed: &Posed) -> Problem {
    let contacts = posed.contacts.iter().enumerate().map(|(place, &slave)| {
        let (node, friction) = (&state.nodes[slave], posed.friction[place]);
        let bound = friction.coefficient() * node.f_n + friction.cohesion;
        let sign = if node.f_t < 0.0 { -1.0 } else { 1.0 };
        let t_max = match node.mode {
            Mode::Sliding if node.t_max.is_finite() && node.t_max != 0.0 => node.t_max,
            Mode::Sliding if bound.is_finite() && bound > 0.0 => sign * bound,
            Mode::Sliding => sign * f64::MIN_POSITIVE,
            _ => 0.0,
        };
        Contact {
            id: id(names::slave(model, slave), place),
            gap: posed.q[2 * place],
            friction,
            load: [posed.load[2 * place], posed.load[2 * place + 1]],
            start: node.mode,
            state: InitialState {
                t_max,
                ..InitialState::default()
            },
        }
    });
    let rows = posed.matrix.clone();
    let free = (0..posed.q.len()).map(|k| if k % 2 == 0 { 0.0 } else { posed.q[k] });
    Problem {
        title: format!("Interface problem of {}", model.title)
            .chars()
            .filter(|c| !c.is_control())
            .take(limits::TITLE)
            .collect(),
        about: String::new(),
        contacts: contacts.collect(),
        matrix: match posed.form {
            PosedForm::Compliance => Matrix::Compliance(rows),
            PosedForm::Stiffness => Matrix::Stiffness(rows),
        },
        free: free.collect(),
        spacing: None,
        history: Default::default(),
        settings: stickslip_core::model::Settings {
            strategy: Strategy::Table2,
            ..Default::default()
        },
    }
}

/// The id of a contact in this scene: its name, without the characters that ids cannot have.
fn id(name: &str, place: usize) -> String {
    match limits::node_id_of(name, limits::NAME - 8) {
        name if name.is_empty() || name.split('.').next() == Some("floor") => {
            format!("contact-{}", place + 1)
        }
        name => name,
    }
}

/// The scene of a reported problem, and our solver at its start.
///
/// # Errors If the problem is invalid.
pub fn stepper(problem: Problem) -> Result<(Scene, Stepper), SceneError> {
    let scene = Scene::from_spec("the interface problem", problem.spec())?;
    let stepper = Stepper::new(Arc::new(scene.model.clone()));
    Ok((scene, stepper))
}

/// Examines the problem that is solved next from a state, for these contacts or, if there are none, for all
/// relevant ones. If no rule reproduces the reported minor iterations, consistent states are counted, but no cause is given. Stops early if `stop` returns true.
pub fn examine(
    model: &Model,
    state: &State,
    posed: &Posed,
    reported: &ReportedIterations,
    contacts: &[usize],
    stop: &dyn Fn() -> bool,
) -> Examination {
    let describe = |line: String| Examination {
        head: line,
        ..Examination::default()
    };
    if state.status == Status::Finished {
        return describe(DONE.into());
    }
    let walk = walk(model, state, posed, reported);
    let mut asked = reported.problem(model, state, posed);
    if let Some(walk) = &walk {
        asked.settings = walk.settings;
    }
    let mut stepper = match stepper(asked) {
        Ok((_, stepper)) => stepper,
        Err(why) => {
            return describe(format!("The reported interface problem is invalid: {why}."));
        }
    };
    let start = stepper.state().clone();
    let is_other = walk.as_ref().is_some_and(|walk| !walk.is_complete());
    let mut found = match contacts {
        [] if is_other => census(&mut stepper, &start, stop),
        [] => frozen(&mut stepper, &start, stop),
        some => {
            let place = |slave: &usize| posed.contacts.iter().position(|known| known == slave);
            let places: Vec<usize> = some.iter().filter_map(place).collect();
            examine_nodes(&mut stepper, &start, &places, stop)
        }
    };
    let part = if is_other { Part::Why } else { Part::Details };
    let compared = walk.map_or_else(|| NOT_COMPARED.to_owned(), |walk| walk.words());
    found.facts.push(Fact::new(part, compared));
    // Maps nodes of the problem to contacts of the scene.
    let slave = |place: usize| posed.contacts.get(place).copied().unwrap_or(place);
    found.nodes = found.nodes.iter().map(|&place| slave(place)).collect();
    if let Some(problem) = &mut found.problem {
        for node in &mut problem.nodes {
            node.slave = slave(node.slave);
        }
    }
    found
}
