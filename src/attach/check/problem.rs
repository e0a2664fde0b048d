//! Whether the frozen interface problem that a solver poses is the one that it solves next.
//!
//! The problem is asked for before an iteration; the iteration then tells gaps and forces. For a solver whose iteration is one
//! linear solve with everything else frozen, gap = (W f + q)_n must hold after each, whatever the modes are. One that updates its
//! geometry or its law within the iteration differs by what that changes, which goes to zero where it converges: there the
//! problem is held to it in states that are accepted with settled modes, with forces that are in balance. Sticking nodes do
//! not move: u = (W f + q)_t = 0 at contacts that were fixed through the whole increment.

use super::super::meeting::other;
use super::report::{Outcome, fails, good, not_offered, not_tried};
use super::steps::is_settled;
use super::trial::{Trial, is_last};
use nalgebra::DVector;
use stickslip_core::model::Mode;
use stickslip_core::step::solver::Posed;
use stickslip_debugger::recorded::fault::Fault;
use stickslip_debugger::recorded::posed::posed;
use stickslip_exchange::attach::message::{Ended, Id, State};
use stickslip_exchange::attach::{Answer, Request};
use stickslip_scene::shown;

/// What an iteration that solves the problem as it is posed may differ by, in parts of the lengths that go into it.
const EXACT: f64 = 1e-6;
/// The same in a settled state of a solver that changes more than modes in an iteration.
const SETTLED: f64 = 1e-2;
const MEND: &str = "gap = W f + q, with the total forces f at the end of the increment (compression positive), of the state that the next iteration would find";

/// Asks for the problem before every iteration, and compares.
pub fn problem(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    if !trial.hello.abilities.problem {
        return Ok(not_offered(""));
    }
    let ids: Vec<Id> = trial
        .scene
        .contacts
        .iter()
        .map(|contact| contact.id.clone())
        .collect();
    let (mut asked, mut refused) = (0, None);
    let (mut worst, mut settled) = (0.0_f64, None::<f64>);
    // Contacts that have been fixed since the increment began.
    let mut stuck: Vec<bool> = trial
        .scene
        .contacts
        .iter()
        .map(|contact| contact.mode == Mode::Fixed)
        .collect();
    for _ in 0..states.len() {
        let told = match trial.ask(&Request::Problem)? {
            Answer::Problem(told) => Some(*told),
            Answer::Refused { reason } => {
                refused.get_or_insert(reason);
                None
            }
            answer => return Err(other(&Request::Problem, answer, "problem")),
        };
        let posed = told.map(|told| posed(&told, &ids)).transpose()?;
        asked += usize::from(posed.is_some());
        let Some(state) = trial.step()? else { break };
        for (stuck, found) in stuck.iter_mut().zip(&state.contacts) {
            *stuck &= found.mode == Mode::Fixed;
        }
        let compared = posed
            .as_ref()
            .and_then(|posed| apart(posed, &state, &stuck));
        // Bodies past a limit of their load may give way against a force; a sign that is wrong gives other gaps, too.
        let agrees = compared.is_some_and(|apart| apart <= EXACT);
        if let Some(why) = posed
            .as_ref()
            .filter(|_| !agrees)
            .and_then(|posed| unsound(posed, &ids))
        {
            return Ok(fails(
                why,
                "W is that of deforming bodies: a force pushes its own node the way it points",
            ));
        }
        if let Some(apart) = compared {
            worst = worst.max(apart);
            if is_settled(&state) {
                settled = Some(settled.unwrap_or(0.0).max(apart));
            }
        }
        if matches!(state.ended, Ended::Increment | Ended::Cut) {
            for (stuck, found) in stuck.iter_mut().zip(&state.contacts) {
                *stuck = found.next == Mode::Fixed;
            }
        }
        if is_last(&state) || trial.is_late() {
            break;
        }
    }
    let times = |count: usize| {
        if count == 1 {
            "once".into()
        } else {
            format!("{count} times")
        }
    };
    Ok(match (asked, settled) {
        (0, _) => {
            let reason = refused.unwrap_or_default();
            not_tried(
                "",
                format!("it is always refused: {}", shown::line(&reason)),
            )
        }
        (_, _) if worst <= EXACT => good(format!(
            "asked {}; every iteration solves it, to {worst:.0e}",
            times(asked)
        )),
        (_, Some(settled)) if settled <= SETTLED => good(format!(
            "asked {}; settled states solve it to {settled:.0e}, iterations on the way to {worst:.0e}",
            times(asked)
        )),
        (_, Some(settled)) => fails(
            format!(
                "in a settled state, gap and W f + q differ by {settled:.0e} of the lengths in it"
            ),
            MEND,
        ),
        (_, None) => {
            let why = format!(
                "no increment was accepted with settled modes; iterations on the way solve it to {worst:.0e}"
            );
            not_tried(format!("asked {}", times(asked)), why)
        }
    })
}

/// What of a matrix is not that of bodies that deform.
fn unsound(posed: &Posed, ids: &[Id]) -> Option<String> {
    let of = |k: usize| {
        let contact = &ids[posed.contacts[k / 2]];
        (
            shown::line(&contact.to_string()).into_owned(),
            if k.is_multiple_of(2) { "n" } else { "t" },
        )
    };
    let size = posed.q.len();
    let not_positive = (0..size).find(|&k| posed.matrix[k][k].is_nan() || posed.matrix[k][k] < 0.0);
    not_positive.map(|k| {
        let (contact, axis) = of(k);
        format!("the diagonal is negative at contact {contact} along {axis}")
    })
}

/// How far the lengths of a state are from W f + q, in parts of those that go into it; `None` where the state does not tell forces
/// or gaps, or K has no inverse.
fn apart(posed: &Posed, state: &State, stuck: &[bool]) -> Option<f64> {
    let size = posed.q.len();
    let mut f = DVector::zeros(size);
    for (place, &contact) in posed.contacts.iter().enumerate() {
        let found = state.contacts.get(contact)?;
        (f[2 * place], f[2 * place + 1]) = (found.f_n?, found.f_t?);
    }
    let w = posed.motion(&f)?;
    let q = DVector::from_column_slice(&posed.q);
    let scale = (&w - &q).amax().max(q.amax());
    if scale == 0.0 || !scale.is_finite() {
        return None;
    }
    let mut most = 0.0_f64;
    for (place, &contact) in posed.contacts.iter().enumerate() {
        let found = &state.contacts[contact];
        if let Some(gap) = found.gap {
            most = most.max((gap - w[2 * place]).abs() / scale);
        }
        if stuck.get(contact) == Some(&true) {
            most = most.max(w[2 * place + 1].abs() / scale);
        }
    }
    Some(most)
}
