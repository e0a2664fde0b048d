//! Charts in a picture: the load over a monitor, and the force of a contact in its friction cone with T_max by iteration.

use super::export_state::ExportState;
use super::timeline::marker;
use crate::RoundOff;
use crate::explain::names;
use crate::explain::trail::{self, Cone};
use stickslip_core::plane;
use stickslip_core::{ContactRecord, MonitorQuantity, counted};
use stickslip_scene::{sig4, sig6};
use stickslip_study::drawn::PlotError;
use stickslip_study::linear_axis;
use stickslip_study::sheet::{Axes, BLACK, COLOURS, GREY, LABEL, MARGIN, SMALL, Sheet};

/// Columns left of an axis, and rows below it.
const LEFT: f64 = 96.0;
const BELOW: f64 = 44.0;
/// Minimum pixels between two numbers of an axis: horizontally and vertically.
const APART: (f64, f64) = (78.0, 44.0);

/// The name of an axis, and its ends.
type AxisRange<'a> = (&'a str, [f64; 2]);

/// Size of the frame of a plot in columns `left` to `right` of the sheet.
fn frame((left, right): (f64, f64), high: f64) -> (f64, f64) {
    (
        right - left - LEFT - 3.0 * MARGIN,
        high - BELOW - 0.6 * LABEL,
    )
}

/// Axes over a range, drawn in columns `left` to `right` of the sheet; returns the map to the sheet.
fn axes(
    sheet: &mut Sheet,
    (left, right): (f64, f64),
    high: f64,
    (x, y): (AxisRange<'_>, AxisRange<'_>),
) -> impl Fn([f64; 2]) -> (f64, f64) + use<> {
    let axes = Axes {
        left: left + LEFT,
        top: sheet.height + 0.6 * LABEL,
        name: left + MARGIN,
        size: frame((left, right), high),
    };
    let ticks = |[low, up]: [f64; 2], step: f64| {
        linear_axis::ticks((low, up), step)
            .map(move |value| ((value - low) / (up - low), sig6(value).replace('-', "−")))
    };
    let steps = (
        step(x.1, axes.size.0 / APART.0),
        step(y.1, axes.size.1 / APART.1),
    );
    axes.draw(
        sheet,
        (x.0, ticks(x.1, steps.0)),
        (y.0, ticks(y.1, steps.1)),
    );
    let ([x0, x1], [y0, y1]) = (x.1, y.1);
    move |[a, b]: [f64; 2]| axes.at((a - x0) / (x1 - x0), (b - y0) / (y1 - y0))
}

/// The step between the numbers of an axis on which `most` numbers have room.
fn step([low, up]: [f64; 2], most: f64) -> f64 {
    linear_axis::step((low, up), most.clamp(2.0, 9.0))
}

/// A range extended to numbers of an axis of this length.
fn rounded(range: [f64; 2], (long, apart): (f64, f64)) -> [f64; 2] {
    let step = step(range, long / apart);
    linear_axis::rounded(range.into(), step).into()
}

/// The range of some values with 0.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    let [low, high] = plane::range(finite.chain([0.0]));
    if high > low { [low, high] } else { [0.0, 1.0] }
}

/// The load over the requested monitor, or over the first that moves.
pub(super) fn load(sheet: &mut Sheet, shown: &ExportState, high: f64) -> Result<(), PlotError> {
    let monitors = &shown.scene.model.monitors;
    let round_off = shown
        .event
        .map(|event| RoundOff::new(&shown.scene.model, &event.before));
    let moves = |at: &usize| {
        let [low, high] = range(
            shown
                .accepted
                .iter()
                .filter_map(|(_, values)| values.get(*at).copied()),
        );
        let noise = round_off.map_or(0.0, |round_off| match monitors[*at].of {
            MonitorQuantity::Displacement { .. } => round_off.length,
            _ => round_off.force,
        });
        high - low > noise && (low, high) != (0.0, 1.0)
    };
    let at = shown
        .picture
        .monitor
        .or((0..monitors.len()).find(moves))
        .unwrap_or(0);
    let points: Vec<[f64; 2]> = shown
        .accepted
        .iter()
        .filter_map(|(load, values)| Some([*values.get(at)?, *load]))
        .collect();
    let (Some(monitor), true) = (monitors.get(at), points.len() > 1) else {
        return sheet.paragraph(
            &["no accepted increment with a monitor".to_owned()],
            LABEL,
            GREY,
        );
    };
    let width = sheet.width;
    let (wide, long) = frame((0.0, width), high);
    let (x, y) = (
        rounded(range(points.iter().map(|p| p[0])), (wide, APART.0)),
        rounded(range(points.iter().map(|p| p[1])), (long, APART.1)),
    );
    let map = axes(
        sheet,
        (0.0, width),
        high,
        ((&monitor.name, x), ("load factor", y)),
    );
    let line: Vec<(f64, f64)> = points.iter().map(|point| map(*point)).collect();
    sheet.line(&line, 2.0, COLOURS[0]);
    if let Some(end) = line.last() {
        sheet.marker(*end, 0, 4.0, COLOURS[0]);
    }
    sheet.height += high;
    Ok(())
}

/// The force of a contact in its cone, and the cobweb of T_max.
pub(super) fn cone(sheet: &mut Sheet, shown: &ExportState, high: f64) -> Result<(), PlotError> {
    let model = &shown.scene.model;
    let size = |slave: usize| {
        let record = shown.event.and_then(|event| event.nodes.get(slave));
        record.map_or(0.0, |record| record.f_n.hypot(record.f_t))
    };
    let largest = (0..model.contacts.len())
        .rev()
        .max_by(|a, b| size(*a).total_cmp(&size(*b)));
    let Some(slave) = shown.picture.node.or(largest) else {
        return sheet.paragraph(&["the scene has no slave nodes".to_owned()], LABEL, GREY);
    };
    let friction = shown.state.controls.friction[slave];
    let trail = trail::trail(shown.events.iter().rev().map(|event| &**event), slave);
    let name = names::slave(model, slave);
    let round_off = shown
        .event
        .map(|event| RoundOff::new(model, &event.before))
        .unwrap_or_default();
    let cone = Cone::new(&trail, &friction, round_off.drawn);
    let (Some(cone), Some(now)) = (cone, trail.last()) else {
        return sheet.paragraph(&[format!("no force at {name}")], LABEL, GREY);
    };
    let clean = |force: f64| sig4(round_off.force(force));
    let words = format!(
        "{name}: F_n {}, F_t {}, T_max {}; friction angle {}°",
        clean(now.f_n),
        clean(now.f_t),
        clean(now.t_max),
        sig4(friction.angle)
    );
    sheet.paragraph(&[words], LABEL, BLACK)?;
    let width = sheet.width;
    let scale = shown.event.map_or(0.0, |event| event.before.scale);
    let web = trail::cobweb(&trail, scale);
    let middle = web.range.map_or(width, |_| 0.5 * width);
    let cone = cone.to_scale(frame((0.0, middle), high), &friction);
    let ranges = (
        ("F_t", [-cone.f_t, cone.f_t]),
        ("F_n", [cone.least, cone.f_n]),
    );
    let map = axes(sheet, (0.0, middle), high, ranges);
    for sign in [1.0, -1.0] {
        let edge = cone.edge.map(|[f_t, f_n]| map([sign * f_t, f_n]));
        sheet.line(&edge, 2.0, BLACK);
    }
    points(sheet, &trail, &map);
    if let Some(span) = web.range {
        let less = match web.origin {
            0.0 => String::new(),
            origin => format!(" less {}", sig4(origin)),
        };
        let (used, found) = (format!("T_max used{less}"), format!("T_max found{less}"));
        let ranges = ((used.as_str(), span), (found.as_str(), span));
        let map = axes(sheet, (middle, width), high, ranges);
        sheet.dashed(&[map([span[0]; 2]), map([span[1]; 2])], 1.2, GREY);
        let path: Vec<(f64, f64)> = web.path.iter().map(|point| map(*point)).collect();
        sheet.line(&path, 2.0, COLOURS[0]);
        let now = [now.t_max_used, now.t_max].map(|value| value - web.origin);
        sheet.marker(map(now), 0, 4.5, COLOURS[0]);
    }
    sheet.height += high;
    let key = format!(
        "The last {}; large: the last one. Circle free, triangle sliding, square fixed.",
        counted(trail.len(), "minor iteration")
    );
    sheet.paragraph(&[key], SMALL, GREY)
}

/// The trail of forces.
fn points(sheet: &mut Sheet, trail: &[ContactRecord], map: &impl Fn([f64; 2]) -> (f64, f64)) {
    let dots: Vec<(f64, f64)> = trail
        .iter()
        .map(|point| map([point.f_t, point.f_n]))
        .collect();
    sheet.line(&dots, 1.2, GREY);
    let last = trail.len().saturating_sub(1);
    for (k, (point, at)) in trail.iter().zip(&dots).enumerate() {
        marker(
            sheet,
            *at,
            point.decision.before,
            if k == last { 6.0 } else { 3.5 },
        );
    }
}
