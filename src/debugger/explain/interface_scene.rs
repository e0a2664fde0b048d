//! The interface problem that an attached solver reports, as a scene of contacts
//! ([`mod@stickslip_scene::format::condensed`]), in total forces from load zero to one.

use super::names;
use std::sync::Arc;
use stickslip_core::{
    InitialState, Mode, Model, ReportedForm, ReportedProblem, State, Stepper, Strategy,
};
use stickslip_scene::format::condensed::{Contact, Matrix, Problem};
use stickslip_scene::{Scene, SceneError, limits};

/// The scene of a reported problem, starting with the modes of a state.
pub fn problem(model: &Model, state: &State, posed: &ReportedProblem) -> Problem {
    let contacts = posed.contacts.iter().enumerate().map(|(place, &slave)| {
        let (node, friction) = (&state.nodes[slave], posed.friction[place]);
        let bound = friction.limit(node.f_n);
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
    let title: String = format!("Interface problem of {}", model.title)
        .chars()
        .filter(|c| !c.is_control())
        .take(limits::TITLE)
        .collect();
    let matrix = match posed.form {
        ReportedForm::Compliance => Matrix::Compliance(rows),
        ReportedForm::Stiffness => Matrix::Stiffness(rows),
    };
    Problem {
        settings: stickslip_core::Settings {
            strategy: Strategy::Table2,
            ..Default::default()
        },
        ..Problem::new(&title, contacts.collect(), matrix, free.collect())
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
/// # Errors
/// If the problem is invalid.
pub fn stepper(problem: Problem) -> Result<(Scene, Stepper), SceneError> {
    let scene = Scene::from_spec("the interface problem", problem.spec())?;
    let stepper = Stepper::new(Arc::new(scene.model.clone()));
    Ok((scene, stepper))
}
