//! The strategies, one file each. To add one, add a file, a line of [`method`], and its name in [`Strategy`].

mod block;
mod census;
pub(crate) mod gauss_seidel;
mod ladder;
mod least;
mod newton;
mod pivoting;
mod sliding;
mod table2;

pub use gauss_seidel::SETTLED;
pub use ladder::needs_support;

use crate::interface::pivoting::CoulombForm;
use crate::{BoundUpdate, Method, Settings, Strategy};
use pivoting::PivotingStrategy;
use std::ops::Deref;
use std::sync::Arc;

/// A strategy of this package, or one from outside ([`crate::step::Stepper::with_strategy`]).
#[derive(Clone)]
pub(crate) enum AnyMethod {
    /// One of those here.
    Builtin(&'static dyn Method),
    /// From outside.
    Custom(Arc<dyn Method>),
}

impl Deref for AnyMethod {
    type Target = dyn Method;

    fn deref(&self) -> &(dyn Method + 'static) {
        match self {
            AnyMethod::Builtin(method) => *method,
            AnyMethod::Custom(method) => &**method,
        }
    }
}

/// The implementation of a strategy.
pub fn method(strategy: Strategy) -> &'static dyn Method {
    match strategy {
        Strategy::Ladder => &ladder::Ladder,
        Strategy::Table2 => &table2::Table2,
        Strategy::Sliding => &sliding::Sliding,
        Strategy::Least => &least::Least,
        Strategy::SlidingLeast => &least::SlidingLeast,
        Strategy::Block => &block::Block,
        Strategy::Newton => &newton::Newton,
        Strategy::Lemke => &PivotingStrategy(CoulombForm::Klarbring),
        Strategy::Census => &census::CensusStrategy,
        Strategy::Copositive => &PivotingStrategy(CoulombForm::Copositive),
        Strategy::GaussSeidel => &gauss_seidel::GaussSeidel,
    }
}

/// The strategies that `chosen` tries in order; empty if it is a single strategy.
pub fn rungs(chosen: Strategy) -> &'static [Strategy] {
    method(chosen).rungs()
}

/// The rung after the given one (both from 0) with this number of contacts, and its strategy. `None` after the last.
pub fn next_rung(chosen: Strategy, rung: usize, contacts: usize) -> Option<(usize, Strategy)> {
    let method = method(chosen);
    let next = method.after(rung, contacts)?;
    Some((next, *method.rungs().get(next)?))
}

/// The effective settings on a rung (from 0; beyond the last one, those of the last) with this number of contacts. The strategy is
/// that of the rung, and `t_max` is what this strategy requires. After the first rung a border between sticking and sliding nodes
/// may move by one node per minor iteration: there may be two per contact (a belt on a drum needs 1.5).
pub fn in_force(chosen: &Settings, rung: usize, contacts: usize) -> Settings {
    let mut settings = *chosen;
    let rungs = rungs(chosen.strategy);
    if let Some(&strategy) = rungs.get(rung.min(rungs.len().saturating_sub(1))) {
        settings.strategy = strategy;
        if rung > 0 {
            settings.t_max = BoundUpdate::Consistent;
            settings.minors = settings.minors.max(2 * contacts as u32);
        }
    }
    settings.t_max = method(settings.strategy).bound(settings.t_max);
    settings
}
