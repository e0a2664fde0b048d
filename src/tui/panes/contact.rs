//! The contact of the selected node: its geometry and force in numbers, and below them as many of three pictures as fit: the force
//! in the Coulomb cone (in space, the friction circle with the slip) with the trail of the last iterations, T_max over the minor iterations as a cobweb, and who pushed the node.

use crate::app::App;
use crate::canvas::{Canvas, Dot};
use crate::chartframe::ChartFrame;
use crate::copied::row;
use crate::layout::{Pane, top};
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use ratatui::text::Line;
use std::f64::consts::TAU;
use stickslip_core::ContactRecord;
use stickslip_core::contact::projection::tangent;
use stickslip_debugger::explain::tested;
use stickslip_debugger::explain::trail::{self, Cobweb, Cone};
use stickslip_scene::joined;
use stickslip_scene::number::{UNREPORTED, sig2, sig4};
use unicode_width::UnicodeWidthStr;

/// Minimum width and height of a picture.
const WIDE: u16 = 25;
const HIGH: u16 = 5;
/// Width of the axis with its labels.
const LABELS: u16 = 9;
/// Maximum number of nodes around the selected one.
const PUSHERS: usize = 6;

/// A picture of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Picture {
    Cone,
    Circle,
    Cobweb,
    Pushes,
}

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("right", "next picture")],
    copied: row,
    is_ahead: false,
};

/// Draws the contact.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let slave = app.slave(view);
    let name = view.slave(slave);
    let inner = frame(
        buffer,
        area,
        Pane::Contact,
        &format!("Contact  {name}"),
        app,
    );
    let hidden = app.learning.hides(view, slave);
    if view.is_finished() {
        let text = "CalculiX's files contain no forces at the contacts.";
        return paint::note(buffer, inner, text, theme);
    }
    let Some(record) = view.record(slave) else {
        return paint::note(buffer, inner, "No iteration yet.", theme);
    };
    let mut lines = words(record, slave, inner.width.into(), app, view);
    let rows = inner.height.saturating_sub(HIGH);
    lines.truncate(usize::from(rows));
    paint::lines(buffer, inner, &lines);
    let [_, field] = top(inner, lines.len() as u16);
    let friction = view.frame().state.controls.friction.get(slave).copied();
    let trail = trail(slave, view);
    let mut pictures = vec![match record.directions {
        Some(_) => Picture::Circle,
        None => Picture::Cone,
    }];
    let is_rough = friction.is_some_and(|friction| !friction.is_smooth());
    if is_rough && record.directions.is_none() {
        pictures.push(Picture::Cobweb);
    }
    if view.model.contacts.len() > 1 && !hidden {
        pictures.push(Picture::Pushes);
    }
    let first = app.turned % pictures.len();
    pictures.rotate_left(first);
    pictures.truncate(usize::from(field.width / WIDE).max(1));
    let width = field.width / pictures.len() as u16;
    if field.height < HIGH || width < LABELS + 6 {
        return;
    }
    let drawn = view.round_off().drawn;
    for (place, picture) in (0..).zip(pictures) {
        let area = Rect {
            x: field.x + place * width,
            width,
            ..field
        };
        match picture {
            Picture::Cone => {
                let cone = friction.and_then(|friction| Cone::new(&trail, &friction, drawn));
                draw_cone(buffer, area, cone.as_ref(), &trail, app);
            }
            Picture::Circle => circle(buffer, area, (&trail, record), app),
            Picture::Cobweb => cobweb(buffer, area, &trail, app, view),
            Picture::Pushes => pushes(buffer, area, (slave, record), app, view),
        }
    }
}

/// The iterations of a slave node up to the shown one.
fn trail(slave: usize, view: &View) -> Vec<ContactRecord> {
    let solved = view.frames[..=view.cursor]
        .iter()
        .rev()
        .filter(|frame| frame.intervention.is_none());
    trail::trail(solved.map_while(|frame| frame.event.as_deref()), slave)
}

/// S*, its frame, the gap and the force.
fn words(
    record: &ContactRecord,
    slave: usize,
    width: usize,
    app: &App,
    view: &View,
) -> paint::Lines {
    let theme = &app.theme;
    let round_off = view.round_off();
    let number = |value: f64| {
        if value.is_finite() {
            sig4(value)
        } else {
            UNREPORTED.to_owned()
        }
    };
    // Without the sign of −0.
    let vector = |v: &[f64]| format!("({})", joined(v.iter().map(|x| number(x + 0.0)), ", "));
    let surface = |none: &'static str| {
        let spot = record.spot.as_ref();
        let surface = spot.and_then(|spot| view.model.surfaces.get(spot.surface));
        surface.map_or(none, |surface| &surface.name)
    };
    let place = match record.spot {
        Some(_) if record.directions.is_some() => surface("no surface").to_owned(),
        None => "past the ends of every surface".to_owned(),
        Some(spot) => {
            let (surface, element) = (surface("?"), spot.element + 1);
            format!("{surface}, element {element}, ξ {}", number(spot.xi))
        }
    };
    let frame = view.event().and_then(|event| event.frames.get(slave));
    let [n, t] = match frame {
        Some(frame) => frame.each_ref().map(|axis| vector(axis)),
        None => [record.normal, tangent(record.normal)].map(|axis| vector(&axis)),
    };
    let [f_n, f_t, t_max] = [record.f_n, record.f_t, record.t_max].map(|f| round_off.force(f));
    let gap = round_off.length(record.gap);
    let row = |text: String| paint::wrapped(&text, width, theme.text);
    let mode = view.mode_before(slave);
    let angle = record.deviation().map_or(String::new(), |angle| {
        let slip = number(round_off.length(record.slip));
        format!("  slip {slip}  angle {:.0}°", angle.to_degrees())
    });
    let force = format!(
        "g {}  F_n {}  F_t {}  T_max {}{angle}",
        number(gap),
        number(f_n),
        number(f_t),
        number(t_max)
    );
    let mut lines = row(format!("S* {place}"));
    lines.extend(row(format!("n {n}  t {t}")));
    lines.extend(paint::wrapped(&force, width, theme.mode(mode)));
    lines
}

/// A picture's heading; returns the area below it.
fn headed(buffer: &mut Buffer, area: Rect, heading: &str, app: &App) -> Rect {
    let heading = paint::cut(heading, area.width.saturating_sub(2).into());
    paint::lines(
        buffer,
        area,
        &[Line::styled(format!(" {heading}"), app.theme.heading)],
    );
    top(area, 1)[1]
}

fn draw_cone(
    buffer: &mut Buffer,
    area: Rect,
    cone: Option<&Cone>,
    trail: &[ContactRecord],
    app: &App,
) {
    let theme = &app.theme;
    let area = headed(buffer, area, "Coulomb cone", app);
    let (Some(cone), false) = (cone, trail.is_empty()) else {
        return paint::note(buffer, area, "no force", theme);
    };
    let frame = ChartFrame::within(area, LABELS);
    let mut canvas = Canvas::new(frame.field);
    let dot = canvas.scale([-cone.f_t, cone.f_t], [cone.least, cone.f_n]);
    canvas.line(dot([0.0, cone.least]), dot([0.0, cone.f_n]), theme.faint);
    canvas.line(dot([-cone.f_t, 0.0]), dot([cone.f_t, 0.0]), theme.faint);
    let [tip, end] = cone.edge;
    for sign in [1.0, -1.0] {
        let side = |[f_t, f_n]: [f64; 2]| dot([sign * f_t, f_n]);
        canvas.line(side(tip), side(end), theme.strong);
    }
    let dots: Vec<Dot> = trail
        .iter()
        .map(|point| dot([point.f_t, point.f_n]))
        .collect();
    draw_trail(buffer, &mut canvas, trail, &dots, theme);
    frame.axis(buffer, theme.faint);
    frame.tick(buffer, 0, &sig2(cone.f_n), theme.faint);
    let zero = canvas
        .cell(dot([0.0, 0.0]))
        .map_or(0, |(_, y)| y - frame.field.y);
    frame.tick(buffer, zero, "F_n 0", theme.faint);
    below(buffer, frame, [-cone.f_t, cone.f_t], "F_t", app);
}

/// Draws the canvas with a trail: a dot for each minor iteration, the last one filled.
fn draw_trail(
    buffer: &mut Buffer,
    canvas: &mut Canvas,
    trail: &[ContactRecord],
    dots: &[Dot],
    theme: &Theme,
) {
    canvas.polyline(dots, theme.faint);
    canvas.render(buffer);
    let last = dots.len().saturating_sub(1);
    for (k, (point, at)) in trail.iter().zip(dots).enumerate() {
        let (glyph, style) = if k == last {
            (
                "●",
                theme
                    .mode(point.decision.before)
                    .add_modifier(Modifier::BOLD),
            )
        } else {
            ("○", theme.mode(point.decision.before))
        };
        canvas.mark(buffer, *at, glyph, style);
    }
}

/// In space, the friction circle of radius T_max seen along n: the trail of F_t, and the slip as a ray.
fn circle(
    buffer: &mut Buffer,
    area: Rect,
    (trail, record): (&[ContactRecord], &ContactRecord),
    app: &App,
) {
    let theme = &app.theme;
    let area = headed(buffer, area, "F_t in the friction circle", app);
    let radius = record.t_max.abs();
    let forces: Vec<[f64; 2]> = trail.iter().filter_map(ContactRecord::shear).collect();
    let sizes = trail.iter().map(|point| point.f_t).chain([radius]);
    let reach = 1.15 * sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
    if forces.is_empty() || reach <= 0.0 {
        return paint::note(buffer, area, "no friction", theme);
    }
    let mut canvas = Canvas::new(area);
    let [width, height] = canvas.size();
    let scale = 0.5 * width.min(height) / reach;
    let dot = |[a, b]: [f64; 2]| -> Dot { [0.5 * width + scale * a, 0.5 * height - scale * b] };
    let on_circle = |direction: f64| [radius * direction.cos(), radius * direction.sin()];
    let steps = 48;
    let rim = (0..=steps).map(|k| dot(on_circle(TAU * f64::from(k) / f64::from(steps))));
    canvas.polyline(&rim.collect::<Vec<_>>(), theme.strong);
    if let Some([_, slip]) = record.directions.filter(|_| record.slip > 0.0) {
        canvas.line(dot([0.0; 2]), dot(on_circle(slip)), theme.good);
    }
    let dots: Vec<Dot> = forces.into_iter().map(dot).collect();
    draw_trail(buffer, &mut canvas, trail, &dots, theme);
}

/// The ends of a horizontal axis, with its name between them.
fn below(buffer: &mut Buffer, frame: ChartFrame, [low, high]: [f64; 2], name: &str, app: &App) {
    let (low, high) = (sig2(low), sig2(high));
    let width = usize::from(frame.field.width);
    let room = width.saturating_sub(low.len() + high.len());
    // A narrow axis has only its ends.
    let name = if name.width() + 2 > room { "" } else { name };
    let text = format!("{low}{name:^room$}{high}");
    frame.below(buffer, frame.field.x, &text, app.theme.faint);
}

/// T_max found over T_max used: where the path meets the diagonal, T_max has settled.
fn cobweb(buffer: &mut Buffer, area: Rect, trail: &[ContactRecord], app: &App, view: &View) {
    let theme = &app.theme;
    let factor = trail::factor(trail);
    let heading = match factor {
        Some(factor) => format!("T_max changes: ×{}", sig4(factor)),
        None => "T_max by iteration".into(),
    };
    let area = headed(buffer, area, &heading, app);
    let scale = view.event().map_or(0.0, |event| event.before.scale);
    let Cobweb {
        origin,
        path,
        range,
    } = trail::cobweb(trail, scale);
    let Some([low, high]) = range else {
        let text = match trail.last() {
            Some(point) if !path.is_empty() => {
                format!(" T_max has settled at {}", sig4(point.t_max))
            }
            _ => " used only while the node slides".into(),
        };
        return paint::note(buffer, area, &text, theme);
    };
    let frame = ChartFrame::within(area, LABELS);
    let mut canvas = Canvas::new(frame.field);
    let dot = canvas.scale([low, high], [low, high]);
    canvas.line(dot([low, low]), dot([high, high]), theme.faint);
    let dots: Vec<Dot> = path.iter().map(|point| dot(*point)).collect();
    canvas.polyline(&dots, theme.text);
    canvas.render(buffer);
    if let Some(now) = trail.last() {
        let now = [now.t_max_used, now.t_max].map(|value| value - origin);
        canvas.mark(buffer, dot(now), "●", theme.strong);
    }
    frame.axis(buffer, theme.faint);
    frame.tick(buffer, 0, &sig2(high), theme.faint);
    let bottom = frame.field.height - 1;
    frame.tick(buffer, bottom, &sig2(low), theme.faint);
    let name = match origin {
        0.0 => "used".to_owned(),
        _ => format!("less {}", sig4(origin)),
    };
    below(buffer, frame, [low, high], &name, app);
}

/// The nodes whose changes since the previous iteration pushed the selected one, as arrows towards it.
fn pushes(
    buffer: &mut Buffer,
    area: Rect,
    (slave, record): (usize, &ContactRecord),
    app: &App,
    view: &View,
) {
    let theme = &app.theme;
    let quantity = tested::deciding(&record.decision);
    let (symbol, _) = tested::effect(quantity, &Default::default());
    let area = headed(buffer, area, &format!("Who pushed it: {symbol}"), app);
    let none = |buffer: &mut Buffer, text: &str| paint::note(buffer, area, text, theme);
    let Some(Some(found)) = view.pushes(slave) else {
        return none(buffer, "not known here");
    };
    let mut found = tested::effects(quantity, found);
    found.truncate(PUSHERS.min(usize::from(area.height)));
    let Some(largest) = found.first().map(|(_, effect)| effect.abs()) else {
        return none(buffer, "no change at any node moved it");
    };
    let name = found
        .iter()
        .map(|(push, _)| view.slave(push.slave).width())
        .max()
        .unwrap_or(0)
        .min(12);
    let number = 11;
    let room = usize::from(area.width).saturating_sub(name + number + 6);
    // The title of the pane has the name.
    let target = Some(view.slave(slave)).filter(|target| target.width() <= room);
    let target = target.unwrap_or("it");
    let middle = found.len() / 2;
    let lines = found.iter().enumerate().map(|(row, (push, effect))| {
        let part = effect.abs() / largest;
        let from = paint::cut(view.slave(push.slave), name);
        let stroke = match part {
            0.5.. => "━",
            0.1.. => "─",
            _ => "╌",
        };
        let sign = if *effect > 0.0 { "+" } else { "" };
        let end = match row == middle {
            true => format!("▶ {}", paint::cut(target, room)),
            false if row < middle => "╮".into(),
            false => "╯".into(),
        };
        let text = format!(
            " {from:>name$} {stroke}{:─^number$}{stroke}{end}",
            format!("{sign}{}", sig4(*effect))
        );
        let style = if part >= 0.5 {
            theme.strong
        } else {
            theme.text
        };
        Line::styled(text, style)
    });
    paint::lines(buffer, area, &lines.collect::<Vec<_>>());
}
