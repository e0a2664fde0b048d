//! Sort order and filter of the slave-node table.

use crate::app::App;
use crate::view::View;
use stickslip_core::plane::range;
use stickslip_core::{Mode, Rule};
use stickslip_debugger::action::{Filter, Sort};
use stickslip_debugger::explain::tested::Dimension;
use stickslip_debugger::history::frame;

impl App {
    /// The selected slave node; 0 if there are none.
    pub fn slave(&self, view: &View) -> usize {
        self.selected
            .min(view.model.contacts.len().saturating_sub(1))
    }

    /// The monitor of the load curve: the chosen one, or the first that moves by more than round-off.
    pub fn watched(&self, view: &View) -> usize {
        let monitors = &view.model.monitors;
        let moves = |at: &usize| {
            let values = frame::curve(view.frames, *at).into_iter();
            let values = values.map(|[value, _]| value).filter(|x| x.is_finite());
            let [low, high] = range(values.chain([0.0]));
            high - low > view.noise(&monitors[*at])
        };
        let last = monitors.len().saturating_sub(1);
        match self.monitor {
            Some(monitor) => monitor.min(last),
            None => (0..monitors.len()).find(moves).unwrap_or(0),
        }
    }

    /// The mode of a slave node; the one before this iteration if the next one is hidden.
    pub fn shown_mode(&self, view: &View, slave: usize) -> Mode {
        if self.learning.hides(view, slave) {
            view.mode_before(slave)
        } else {
            view.mode(slave)
        }
    }

    /// The slave nodes of the table, in order. The selected one is always included.
    pub fn order(&self, view: &View) -> Vec<usize> {
        let count = view.model.contacts.len();
        let selected = self.slave(view);
        let next = |slave: usize| self.shown_mode(view, slave);
        let wanted = |slave: usize| match self.filter {
            Filter::All => true,
            Filter::Active => next(slave) != Mode::Free || view.mode_before(slave) != next(slave),
            Filter::Surface => surface(slave, view) == surface(selected, view),
            Filter::Changing => view.mode_before(slave) != next(slave),
            Filter::Free => next(slave) == Mode::Free,
            Filter::Sliding => next(slave) == Mode::Sliding,
            Filter::Fixed => next(slave) == Mode::Fixed,
        };
        let mut order: Vec<usize> = (0..count)
            .filter(|&slave| slave == selected || wanted(slave))
            .collect();
        let key = |slave: usize| match self.sort {
            Sort::Scene => Some(slave as f64),
            Sort::Margin => margin(slave, view),
            Sort::Gap => gap(slave, view),
            Sort::Change => Some(match view.mode_before(slave) != next(slave) {
                true => 0.0,
                false if view.t_max_moves(slave) => 1.0,
                false => 2.0,
            }),
            Sort::Ratio => distance_to_limit(slave, view),
            Sort::Force => force(slave, view).map(|force| -force),
        };
        // Nodes without a value come last in either direction.
        let mut keyed: Vec<(Option<f64>, usize)> =
            order.drain(..).map(|slave| (key(slave), slave)).collect();
        keyed.sort_by(|(a, _), (b, _)| match (a, b) {
            (Some(a), Some(b)) if self.backward => b.total_cmp(a),
            (Some(a), Some(b)) => a.total_cmp(b),
            _ => b.is_some().cmp(&a.is_some()),
        });
        order.extend(keyed.into_iter().map(|(_, slave)| slave));
        order
    }
}

/// The surface that a node touches, or the first one that it can touch.
fn surface(slave: usize, view: &View) -> Option<usize> {
    let spot = view.frame().state.nodes.get(slave)?.spot;
    spot.map(|spot| spot.surface)
        .or_else(|| view.model.contacts[slave].surfaces.first().copied())
}

/// The smallest margin of a node: forces relative to the scene's force, lengths relative to its length.
fn margin(slave: usize, view: &View) -> Option<f64> {
    let (event, record) = (view.event()?, view.record(slave)?);
    let tests = record.decision.tests.iter().flatten();
    let (force, length) = (event.before.scale, view.model.length);
    let size = |tested| Dimension::from(tested).scale(force, length);
    tests
        .map(|test| (test.margin / size(test.tested)).abs())
        .filter(|margin| !margin.is_nan())
        .min_by(f64::total_cmp)
}

fn gap(slave: usize, view: &View) -> Option<f64> {
    let record = view.record(slave)?;
    let known = record.decision.rule != Rule::OffSurface && !record.gap.is_nan();
    known.then_some(record.gap)
}

fn force(slave: usize, view: &View) -> Option<f64> {
    let record = view.record(slave)?;
    let force = view.round_off().force(record.f_n.hypot(record.f_t));
    (force > 0.0).then_some(force)
}

/// How far |F_t|/T_max is from 1; `None` without a contact force.
fn distance_to_limit(slave: usize, view: &View) -> Option<f64> {
    let record = view
        .record(slave)
        .filter(|_| force(slave, view).is_some())?;
    let ratio = (record.f_t / record.t_max).abs();
    (!ratio.is_nan()).then_some((1.0 - ratio).abs())
}
