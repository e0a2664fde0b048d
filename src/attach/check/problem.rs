//! Checks that the frozen interface problem is the one that the next iteration solves.
//!
//! The problem is requested before an iteration, and compared with the iteration's gaps and forces. If an iteration is one linear
//! solve with everything else frozen, gap = (W f + q)_n must hold after each one, whatever the modes are. A solver that updates
//! geometry or law within an iteration differs by that update, which vanishes as it converges: it is only tested in accepted states
//! with settled modes and balanced forces. Its other iterations may miss the problem by at most [`UPDATED`]. Sticking nodes do not move: u = (W f + q)_t = 0 at contacts that were fixed through the
//! whole increment.

use super::super::started_solver::other;
use super::report::{Outcome, fails, good, not_offered, not_tried};
use super::steps::is_settled;
use super::trial::Trial;
use nalgebra::DVector;
use stickslip_core::words::times;
use stickslip_core::{Mode, ReportedProblem};
use stickslip_debugger::Fault;
use stickslip_debugger::recorded::interface_problem::read_problem;
use stickslip_exchange::attach::message::{EndedLevel, Id, State};
use stickslip_exchange::attach::{Answer, Request};
use stickslip_scene::shown;

/// Tolerance for iterations that solve the problem as given, relative to the lengths in it.
const EXACT: f64 = 1e-6;
/// Tolerance in a settled state for solvers that also update other quantities in an iteration.
const SETTLED: f64 = 1e-2;
/// Tolerance for the other iterations of such a solver.
const UPDATED: f64 = 0.2;
const MEND: &str = "W and q must give gap = W f + q for the next iteration, with the total forces f at the end of the increment (compression positive)";

/// Requests the problem before every iteration, and compares.
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
    // Contacts that have been fixed since the start of the increment.
    let mut stuck: Vec<bool> = trial
        .scene
        .contacts
        .iter()
        .map(|contact| contact.mode == Mode::Fixed)
        .collect();
    // The same at the start of the increment, where an attempt that was given up returns to.
    let mut stuck_at_start = stuck.clone();
    for _ in 0..states.len() {
        let problem = match trial.ask(&Request::Problem)? {
            Answer::Problem(problem) => Some(*problem),
            Answer::Refused { reason } => {
                refused.get_or_insert(reason);
                None
            }
            answer => return Err(other(&Request::Problem, answer, "problem")),
        };
        let posed = problem
            .map(|problem| read_problem(&problem, &ids))
            .transpose()?;
        asked += usize::from(posed.is_some());
        let Some(state) = trial.step()? else { break };
        for (stuck, found) in stuck.iter_mut().zip(&state.contacts) {
            *stuck &= found.mode == Mode::Fixed;
        }
        let compared = posed
            .as_ref()
            .and_then(|posed| apart(posed, &state, &stuck));
        // Bodies past a limit load may move against a force. A wrong sign also changes the gaps, which the comparison detects.
        let agrees = compared.is_some_and(|apart| apart <= EXACT);
        if let Some(why) = posed
            .as_ref()
            .filter(|_| !agrees)
            .and_then(|posed| unsound(posed, &ids))
        {
            return Ok(fails(
                why,
                "W must be the compliance of deforming bodies: a force moves its node in its own direction",
            ));
        }
        if let Some(apart) = compared {
            worst = worst.max(apart);
            if is_settled(&state) {
                settled = Some(settled.unwrap_or(0.0).max(apart));
            }
        }
        match state.ended {
            EndedLevel::Increment => {
                let next = state.contacts.iter().map(|found| found.next == Mode::Fixed);
                stuck_at_start = next.collect();
                stuck.clone_from(&stuck_at_start);
            }
            EndedLevel::Cut | EndedLevel::Failure => stuck.clone_from(&stuck_at_start),
            EndedLevel::Iteration | EndedLevel::Equilibrium | EndedLevel::Done => {}
        }
        if trial.is_late() {
            break;
        }
    }
    Ok(match (asked, settled) {
        (0, _) => {
            let reason = refused.unwrap_or_default();
            not_tried("", format!("always refused: {}", shown::line(&reason)))
        }
        (_, _) if worst <= EXACT => good(format!(
            "requested {}; every iteration satisfies it within {worst:.0e}",
            times(asked)
        )),
        (_, Some(settled)) if settled <= SETTLED && worst > UPDATED => fails(
            format!(
                "an iteration misses gap = W f + q by {worst:.1e} of the lengths in it; allowed: {UPDATED}"
            ),
            MEND,
        ),
        (_, Some(settled)) if settled <= SETTLED => good(format!(
            "requested {}; settled states satisfy it within {settled:.0e}, other iterations within {worst:.0e}",
            times(asked)
        )),
        (_, Some(settled)) => fails(
            format!("in a settled state, gap and W f + q differ by a relative {settled:.0e}"),
            MEND,
        ),
        (_, None) => {
            let why = format!(
                "no increment was accepted with settled modes; the other iterations satisfy it within {worst:.0e}"
            );
            not_tried(format!("requested {}", times(asked)), why)
        }
    })
}

/// Why a matrix is not the compliance of deforming bodies.
fn unsound(posed: &ReportedProblem, ids: &[Id]) -> Option<String> {
    let rows = 1 + posed.tangents;
    let of = |k: usize| {
        let contact = &ids[posed.contacts[k / rows]];
        (
            shown::line(&contact.to_string()).into_owned(),
            ["n", "t", "n × t"][k % rows],
        )
    };
    let size = posed.q.len();
    let not_positive = (0..size).find(|&k| posed.matrix[k][k].is_nan() || posed.matrix[k][k] < 0.0);
    not_positive.map(|k| {
        let (contact, axis) = of(k);
        format!("the diagonal is negative at contact {contact} along {axis}")
    })
}

/// The largest deviation of a state's gaps from W f + q, relative to the lengths in it; `None` if the state does not report forces
/// or gaps, or K has no inverse.
fn apart(posed: &ReportedProblem, state: &State, stuck: &[bool]) -> Option<f64> {
    let rows = 1 + posed.tangents;
    let mut f = Vec::with_capacity(posed.q.len());
    for &contact in &posed.contacts {
        let found = state.contacts.get(contact)?;
        f.push(found.f_n?);
        let f_t = found.f_t?;
        f.extend(f_t.as_slice());
    }
    if f.len() != posed.q.len() {
        return None;
    }
    let f = DVector::from_vec(f);
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
            most = most.max((gap - w[rows * place]).abs() / scale);
        }
        if stuck.get(contact) == Some(&true) {
            let motion = w.rows(rows * place + 1, posed.tangents);
            most = most.max(motion.amax() / scale);
        }
    }
    Some(most)
}
