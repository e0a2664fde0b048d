//! Rows of `--csv` and `--trace`.
//!
//! Floats have as many digits as they need to read back to the same bits; those that are no numbers are `NaN`, `inf`
//! and `-inf`.
//!
//! `--csv`: one row per converged increment; `majors` counts its major iterations, `minors` all of its minor ones, `jumped`
//! is 1 where it ends on another branch of equilibrium than it began on, else 0. With `history.jumps: dynamic` there are three
//! columns more, of the damped motion that a jump is: `let_go`, the load factor of the last equilibrium, `steps`, and
//! `dissipated`, the work that its viscosity took. With `--stability` that of the accepted state comes last
//! ([`crate::linear::stability`]): `stable`, `unstable(N)` with N negative eigenvalues, `divergence` or `not known`.
//!
//! `--trace`: one row per slave node and minor iteration. `residual` is the relative norm of the residual: at the
//! start of the major iteration, about which the minor ones are linearised; on the rows that end a major iteration, at
//! its end. `t_max` is that of the row's own F_n, `margin` the distance of the deciding inequality from switching
//! (infinite where none was tested). With `history.jumps: dynamic`, `drag` comes last: c / Δt of the
//! damped motion that the row is part of, 0 outside. A minor iteration that could not be solved has no rows.

use crate::explain::names;
use crate::linear::stability::Stability;
use crate::model::{Jumps, Model};
use crate::step::event::{Event, Failure, Outcome};
use crate::step::motion::Motion;
use crate::study::csv::field;
use std::fmt::Write;

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
    line.push('\n');
    line
}

/// The row of an increment that was just accepted.
pub fn csv_row(
    model: &Model,
    event: &Event,
    minors: u64,
    monitors: &[f64],
    stability: Option<Stability>,
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
    let (jumped, motion) = match event.outcome {
        Outcome::Increment { jumped, motion, .. } => (jumped, motion),
        _ => (false, None),
    };
    let _ = write!(line, ",{}", u8::from(jumped));
    match motion {
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
    line.push('\n');
    line
}

/// Whether a scene may go on in damped motions, and has columns for them.
fn moves(model: &Model) -> bool {
    model.jumps == Jumps::Dynamic
}

/// The first line of `--trace`.
pub fn trace_header(model: &Model) -> String {
    let mut line =
        "increment,attempt,major,minor,node,mode,next,rule,gap,f_n,f_t,t_max,slip,margin,residual"
            .to_owned();
    if moves(model) {
        line.push_str(",drag");
    }
    line.push('\n');
    line
}

/// The rows of a minor iteration.
pub fn trace_rows(model: &Model, event: &Event) -> String {
    let (at, residual) = (event.position, residual(event));
    let mut lines = String::new();
    for (slave, r) in event.nodes.iter().enumerate() {
        let d = &r.decision;
        let _ = write!(
            lines,
            "{},{},{},{},{},{},{},{},{:?},{:?},{:?},{:?},{:?},{:?},{residual:?}",
            at.increment,
            at.attempt,
            at.major,
            at.minor,
            field(names::slave(model, slave)),
            names::mode(d.before),
            names::mode(d.next),
            names::rule(d.rule),
            r.gap,
            r.f_n,
            r.f_t,
            r.t_max,
            r.slip,
            d.margin(),
        );
        if moves(model) {
            let _ = write!(lines, ",{:?}", event.drag);
        }
        lines.push('\n');
    }
    lines
}

fn residual(event: &Event) -> f64 {
    match &event.outcome {
        Outcome::Major { after, .. }
        | Outcome::Refused { after, .. }
        | Outcome::Increment { after, .. } => after.relative,
        Outcome::Failed(Failure::MajorLimit { relative, .. } | Failure::Diverged { relative }) => {
            *relative
        }
        _ => event.before.relative,
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
