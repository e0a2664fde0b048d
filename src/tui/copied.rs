//! What panes give to `Y`: a row, a number, or a point of a curve, as text.

use crate::app::App;
use crate::view::View;
use stickslip_debugger::{Watch, WatchQuantity};

/// A name for the message, and the copied text.
pub type NamedText = (String, String);

/// The selected slave node and all its numbers, separated by tabs.
pub fn row(app: &App, view: &View) -> Result<NamedText, String> {
    let slave = app.slave(view);
    if view.model.contacts.is_empty() {
        return Err("this scene has no slave nodes".into());
    }
    let next = if app.learning.hides(view, slave) {
        "?"
    } else {
        view.mode(slave).word()
    };
    let name = view.slave(slave);
    let before = view.mode_before(slave).word();
    let mut cells = vec![name.to_owned(), before.into(), next.into()];
    if let Some(found) = view.record(slave) {
        let numbers = [found.gap, found.f_n, found.f_t, found.t_max, found.slip];
        cells.extend(numbers.map(|number| format!("{number:e}")));
    }
    Ok((format!("the row of {name}"), cells.join("\t")))
}

/// A quantity of the selected node.
pub fn value(quantity: WatchQuantity, app: &App, view: &View) -> Result<NamedText, String> {
    let slave = app.slave(view);
    if quantity.is_nodal() && view.model.contacts.is_empty() {
        return Err("this scene has no slave nodes".into());
    }
    if quantity == WatchQuantity::Margin && app.learning.hides(view, slave) {
        return Err("hidden until you predict what follows".into());
    }
    let watch = Watch::new(view.model, quantity, slave);
    let value = watch.value(view.frame());
    let value = value.ok_or_else(|| format!("{} has no value here", watch.name))?;
    Ok((watch.name, format!("{value:e}")))
}

/// The load and the shown monitor at the last accepted increment.
pub fn monitored(app: &App, view: &View) -> Result<NamedText, String> {
    let at = app.watched(view);
    let monitor = view
        .model
        .monitors
        .get(at)
        .ok_or("this scene has no monitors")?;
    let frames = &view.frames[..=view.cursor];
    let frame = frames.iter().rev().find(|frame| frame.monitors.is_some());
    let value = frame.and_then(|frame| frame.monitors.as_ref()?.get(at).copied());
    let (Some(frame), Some(value)) = (frame, value) else {
        return Err("no increment accepted yet".into());
    };
    let load = frame.state.start.load_factor;
    Ok((
        format!("load and {}", monitor.name),
        format!("{load:e}\t{value:e}"),
    ))
}
