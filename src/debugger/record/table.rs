//! Tables of a run: rows of `--csv` and `--trace`.
//!
//! Floats have as many digits as needed to read back the same bits; non-finite values are `NaN`, `inf` and `-inf`.
//!
//! `--csv` has one row per converged increment:
//!
//! - `majors` counts its major iterations, `minors` all its minor iterations.
//! - `jumped` is 1 if the increment leaves its branch of stable equilibrium (it ends on another branch or in an unstable state),
//!   else 0.
//! - `history.control: arc`: the last monitor is `arc`, the arc length along the equilibrium path.
//! - `history.jumps: dynamic`: three columns for the damped motion of a jump: `let_go`, the load factor of the last equilibrium,
//!   `steps`, and `dissipated`, the work of the viscosity.
//! - `--stability`: `stability` of the accepted state ([`stickslip_core::linear::stability`]): `stable`, `unstable(N)` with N
//!   negative eigenvalues, `divergence` or `not known`.
//! - Solids: `worst_stretch`, the smallest principal stretch at their integration points ([`stickslip_core::fem::deformation`]).
//!
//! `--trace` has one row per slave node and minor iteration, and none for a minor iteration that could not be solved:
//!
//! - `residual` is the relative norm of the residual at the start of the major iteration, about which the minor iterations are
//!   linearised; in rows that end a major iteration, at its end.
//! - `t_max` belongs to the row's F_n; `margin` is the distance of the deciding inequality from switching (infinite if none was
//!   tested).
//! - `contact` is 1. A node held in a corner has a second row; each row has the values of its side (F_n, F_t and T_max in its
//!   frame), from the split of least norm.
//! - `history.control: arc`: `arc`, the arc length at the start of the increment; in rows that accept the increment, at its end.
//! - `history.jumps: dynamic`: `drag`, c / Δt of the damped motion that contains the row, otherwise 0.
//! - Scenes with a contact law, a stick stiffness or a pressure monitor: `pressure` and `shear`, F_n / A and F_t / A with the
//!   undeformed tributary area A;
//!   `NaN` without one.
//! - In space: `f_t` and `slip` are lengths of vectors, followed by their components along t and n × t (`f_1`, `f_2`, `slip_1`,
//!   `slip_2`) and by `angle` between them (degrees).

use crate::explain::names;
use crate::history::strip::norms_after;
use std::fmt::Write;
use stickslip_core::fem::deformation::deformation;
use stickslip_core::model::ReportedKind;
use stickslip_core::{
    ContactRecord, Control, Event, Failure, Friction, Jumps, Model, Monitor, MonitorQuantity,
    Motion, Outcome, Stability,
};
use stickslip_study::csv::field;

/// The first line of `--csv`.
pub fn csv_header(model: &Model, stability: bool) -> String {
    let mut line = "increment,load,majors,minors".to_owned();
    for monitor in &model.monitors {
        line.push(',');
        line.push_str(&field(&monitor.name));
    }
    line.push_str(",jumped");
    if moves(model) {
        line.push_str(",let_go,steps,dissipated");
    }
    if stability {
        line.push_str(",stability");
    }
    if model.has_solids() {
        line.push_str(",worst_stretch");
    }
    line.push('\n');
    line
}

/// The row of an accepted increment; `u` is its displacement vector.
pub fn csv_row(
    model: &Model,
    event: &Event,
    minors: u64,
    monitors: &[f64],
    stability: Option<Stability>,
    u: &[f64],
) -> String {
    let at = event.position;
    let mut line = format!(
        "{},{:?},{},{minors}",
        at.increment, event.load_factor, at.major
    );
    for value in monitors {
        // Writing to a string does not fail.
        let _ = write!(line, ",{value:?}");
    }
    let (jumped, motion, stretch) = match event.outcome {
        Outcome::Increment {
            jumped,
            motion,
            stretch,
            ..
        } => (jumped, motion, stretch),
        _ => (false, None, None),
    };
    let _ = write!(line, ",{}", u8::from(jumped));
    match motion.filter(|_| moves(model)) {
        Some(motion) => {
            let Motion {
                from,
                steps,
                dissipated,
                ..
            } = motion;
            let _ = write!(line, ",{from:?},{steps},{dissipated:?}");
        }
        None if moves(model) => line.push_str(",,0,0.0"),
        None => {}
    }
    if let Some(stability) = stability {
        let _ = write!(line, ",{stability}");
    }
    // Attached solvers do not compute it.
    let stretch = stretch.or_else(|| Some(deformation(model, u)?.smallest.stretch));
    if let Some(stretch) = stretch {
        let _ = write!(line, ",{stretch:?}");
    }
    line.push('\n');
    line
}

/// Whether a scene allows damped motions, and has columns for them.
fn moves(model: &Model) -> bool {
    model.jumps == Jumps::Dynamic
}

/// The first line of `--trace`.
pub fn trace_header(model: &Model) -> String {
    let mut line =
        "increment,attempt,major,minor,node,mode,next,rule,gap,f_n,f_t,t_max,slip,margin,residual,contact"
            .to_owned();
    if model.control == Control::Arc {
        line.push_str(",arc");
    }
    if moves(model) {
        line.push_str(",drag");
    }
    if has_pressures(model) {
        line.push_str(",pressure,shear");
    }
    if model.space.is_some() {
        line.push_str(",f_1,f_2,slip_1,slip_2,angle");
    }
    line.push('\n');
    line
}

/// Whether a scene has columns for pressures.
fn has_pressures(model: &Model) -> bool {
    let watched = |monitor: &Monitor| {
        matches!(
            monitor.of,
            MonitorQuantity::Pressure { .. }
                | MonitorQuantity::Reported {
                    kind: ReportedKind::Pressure,
                    ..
                }
        )
    };
    model.contacts.iter().any(|contact| !contact.bond.is_hard())
        || model.monitors.iter().any(watched)
}

/// The rows of a minor iteration; `friction` is the current friction by slave node.
pub fn trace_rows(model: &Model, friction: &[Friction], event: &Event) -> String {
    let (at, residual) = (event.position, residual(event));
    let mut lines = String::new();
    let mut row = |slave: usize, contact: usize, r: &ContactRecord, [f_n, f_t, t_max]: [f64; 3]| {
        let d = &r.decision;
        let _ = write!(
            lines,
            "{},{},{},{},{},{},{},{},{:?},{f_n:?},{f_t:?},{t_max:?},{:?},{:?},{residual:?},{contact}",
            at.increment,
            at.attempt,
            at.major,
            at.minor,
            field(names::slave(model, slave)),
            d.before.word(),
            d.next.word(),
            d.rule.name(),
            r.gap,
            r.slip,
            d.margin(),
        );
        if let Some(arc) = event.arc {
            let _ = write!(lines, ",{arc:?}");
        }
        if moves(model) {
            let _ = write!(lines, ",{:?}", event.drag);
        }
        if has_pressures(model) {
            let found = model.contacts[slave].pressure(f_n, f_t);
            let [pressure, shear] = found.unwrap_or([f64::NAN; 2]);
            let _ = write!(lines, ",{pressure:?},{shear:?}");
        }
        if let Some([force, sliding]) = r.directions {
            let [f_1, f_2] = [f_t * force.cos(), f_t * force.sin()];
            let [slip_1, slip_2] = [r.slip * sliding.cos(), r.slip * sliding.sin()];
            let angle = r.deviation().unwrap_or(f64::NAN).to_degrees();
            let _ = write!(lines, ",{f_1:?},{f_2:?},{slip_1:?},{slip_2:?},{angle:?}");
        }
        lines.push('\n');
    };
    for (slave, r) in event.nodes.iter().enumerate() {
        match r.sides(&friction[slave]) {
            None => row(slave, 1, r, [r.f_n, r.f_t, r.t_max]),
            Some(sides) => {
                for (k, side) in sides.iter().enumerate() {
                    let t_max = side.limit.copysign(side.f_t);
                    row(slave, k + 1, r, [side.f_n, side.f_t, t_max]);
                }
            }
        }
    }
    lines
}

fn residual(event: &Event) -> f64 {
    match &event.outcome {
        Outcome::Failed(Failure::MajorLimit { relative, .. } | Failure::Diverged { relative }) => {
            *relative
        }
        Outcome::Failed(Failure::Reported {
            relative: Some(relative),
            ..
        }) => *relative,
        outcome => norms_after(outcome).unwrap_or(&event.before).relative,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_would_break_a_row_are_quoted() {
        assert_eq!(field("beam.1"), "beam.1");
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
