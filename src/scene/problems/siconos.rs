//! Friction problems condensed to their contacts, as in Siconos and fclib:
//!
//! ```text
//! u = W r + q,     0 <= u_n ⊥ r_n >= 0,     |r_t| <= mu r_n, against u_t     (n, t of each contact in turn)
//! ```
//!
//! [`stickslip_exchange::siconos`] reads and writes the text. In the resulting scene all contacts start free with gap 0, and the
//! free velocity q, and hence u and r, is applied in one increment.

use crate::format::condensed::{Contact, Problem};
use crate::limits;
use stickslip_core::linear::sparse_contacts::FEW;
use stickslip_core::model::LinearSolver;
use stickslip_core::{Friction, Settings, Strategy};
use stickslip_exchange::FormatError;
use stickslip_exchange::problem::{self, Local};
use stickslip_exchange::siconos;

/// Whether a text could be such a file: it starts with a number, as no scene does.
pub fn is_one(text: &str) -> bool {
    text.trim_start().starts_with(|c: char| c.is_ascii_digit())
}

/// Reads such a file as a problem condensed to its contacts, with a memory limit (GB; `None`: the free memory).
///
/// # Errors
/// The error and its line.
pub fn read(text: &str, memory: Option<f64>) -> Result<Local, FormatError> {
    // Checked before anything of that size is read.
    let (contacts, (line, column)) = siconos::contacts(text)?;
    super::blocks_fit(contacts, memory).map_err(|why| FormatError::at(line, column, why))?;
    local(siconos::read(text)?, memory).map_err(FormatError::whole)
}

/// Condenses a problem of any form to its contacts, with a memory limit (GB; `None`: the free memory).
///
/// # Errors
/// Why it cannot be condensed.
pub(super) fn local(problem: problem::Problem, memory: Option<f64>) -> Result<Local, String> {
    let most = crate::memory::budget(memory) / limits::ENTRY_BYTES;
    let local = match problem {
        problem::Problem::Local(local) => local,
        problem::Problem::Mixed(mut local, bilateral) => {
            let turned = super::condense::transposed(&bilateral.v);
            let (w, q) = super::condense::condensed(&bilateral.r, &turned, &bilateral.s, most)
                .map_err(|why| format!("R of the bilateral constraints {why}"))?;
            local.w = local.w.merged();
            let parts = w.entries.into_iter().map(|(i, j, part)| (i, j, -part));
            local.w.entries.extend(parts);
            local
                .q
                .iter_mut()
                .zip(&q)
                .for_each(|(whole, part)| *whole -= part);
            local
        }
        problem::Problem::Global(global) => {
            let (w, mut q) = super::condense::condensed(&global.m, &global.h, &global.f, most)
                .map_err(|why| format!("M {why}"))?;
            q.iter_mut().zip(&global.b).for_each(|(q, b)| *q += b);
            let mu = global.mu;
            Local { w, q, mu }
        }
    };
    let local = Local {
        w: local.w.merged(),
        ..local
    };
    let entries = local.w.entries.len() as f64;
    super::entries_fit(local.mu.len(), entries, memory)?;
    sound(&local)?;
    Ok(local)
}

/// Rejects numbers that a scene cannot have.
fn sound(local: &Local) -> Result<(), String> {
    let of = |what: &dyn Fn() -> String, value: f64| {
        if value.abs() <= limits::MAGNITUDE {
            Ok(())
        } else {
            Err(format!(
                "{} is {value:?}; it must be a number between -1e12 and 1e12",
                what()
            ))
        }
    };
    for &(i, j, value) in &local.w.entries {
        let what = || format!("the entry of W in row {}, column {},", i + 1, j + 1);
        of(&what, value)?;
    }
    for (k, &value) in local.q.iter().enumerate() {
        of(&|| format!("component {} of q", k + 1), value)?;
    }
    local.mu.iter().try_for_each(|mu| coefficient(*mu))
}

/// Rejects coefficients of friction whose angle is not below 90 degrees.
pub(super) fn coefficient(mu: f64) -> Result<(), String> {
    if (0.0..1e15).contains(&mu) {
        return Ok(());
    }
    Err(format!(
        "the friction coefficient is {mu:?}; it must be at least 0 and below 1e15"
    ))
}

/// A condensed problem in the format of the scene.
pub(super) fn problem(local: Local, title: &str) -> Problem {
    Problem {
        about: "A friction problem in Siconos' format: u = W r + q.".to_owned(),
        tangents: local.dimension() - 1,
        settings: settings(local.mu.len()),
        ..Problem::new(
            title,
            contacts(&local.mu, &[]),
            super::compliance(local.w),
            local.q,
        )
    }
}

/// Contacts with these coefficients of friction, and with these loads, if any.
pub(super) fn contacts(mu: &[f64], loads: &[f64]) -> Vec<Contact> {
    let contact = |(k, &mu): (usize, &f64)| Contact {
        id: format!("c{}", k + 1),
        friction: friction(mu),
        load: match loads.get(2 * k..2 * k + 2) {
            Some(load) => [load[0], load[1]],
            None => [0.0; 2],
        },
        ..Contact::default()
    };
    mu.iter().enumerate().map(contact).collect()
}

fn friction(mu: f64) -> Friction {
    Friction {
        angle: mu.atan().to_degrees(),
        cohesion: 0.0,
    }
}

/// W is usually sparse, and condensation has nothing to eliminate. Sweeps solve problems with many contacts, whose other
/// strategies solve for all forces together.
pub(super) fn settings(contacts: usize) -> Settings {
    Settings {
        solver: LinearSolver::Augmented,
        strategy: if contacts > FEW {
            Strategy::GaussSeidel
        } else {
            Strategy::default()
        },
        ..Settings::default()
    }
}
