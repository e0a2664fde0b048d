//! A frame: the state after one minor iteration or one intervention.

use std::sync::Arc;
use stickslip_core::{Event, Intervention, State};

/// A point of the history.
///
/// A thinned frame has no event, slave nodes or displacements ([`Frame::is_whole`]); its intervention and
/// monitors stay. The frame at the cursor and the last one are always whole.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The state from which the next minor iteration starts.
    pub state: State,
    /// The last minor iteration; `None` at the start.
    pub event: Option<Arc<Event>>,
    /// The change made by the user, if this frame is an intervention.
    pub intervention: Option<Intervention>,
    /// Values of the scene's monitors, if this frame ends an accepted increment.
    pub monitors: Option<Arc<Vec<f64>>>,
}

impl Frame {
    /// Whether state and event have not been thinned.
    pub fn is_whole(&self) -> bool {
        !self.state.u.is_empty()
    }
}

/// A monitor's value and the load factor at the end of each accepted increment in these frames.
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
