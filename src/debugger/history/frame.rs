//! A frame: what one minor iteration left behind, or what one intervention changed.

use std::sync::Arc;
use stickslip_core::step::event::Event;
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::state::State;

/// A point of the history.
///
/// A frame that was thinned has neither event nor slave nodes nor displacements ([`Frame::is_whole`]); its
/// intervention and monitors stay. The frame under the cursor and the last one are always whole.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The state from which the next minor iteration goes on.
    pub state: State,
    /// The last minor iteration; `None` at the start.
    pub event: Option<Arc<Event>>,
    /// What the user changed here, if this frame is due to that and not to a minor iteration.
    pub intervention: Option<Intervention>,
    /// Values of the scene's monitors, where this frame ends an accepted increment.
    pub monitors: Option<Arc<Vec<f64>>>,
}

impl Frame {
    /// Whether state and event are there, and were not thinned.
    pub fn is_whole(&self) -> bool {
        !self.state.u.is_empty()
    }
}

/// A monitor's value and the load factor at the end of every accepted increment among these frames.
pub fn curve(frames: &[Frame], monitor: usize) -> Vec<[f64; 2]> {
    let point = |frame: &Frame| {
        let value = *frame.monitors.as_ref()?.get(monitor)?;
        let accepted = frame.state.start.load_factor;
        Some([
            value,
            frame
                .event
                .as_ref()
                .map_or(accepted, |event| event.load_factor),
        ])
    };
    frames.iter().filter_map(point).collect()
}
