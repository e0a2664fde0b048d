//! The top of the screen: which scene, where the solver is, and what the last minor iteration led to.

use crate::scene::Model;
use crate::solve::event::{Motion, RigidMotion, Singular};
use crate::solve::{Event, Failure, Forced, Outcome};
use crate::tui::app::App;
use crate::tui::view::View;
use crate::tui::{draw, number, theme};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

/// Draws the status.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: Option<&View>) {
    let Some(view) = view else {
        let title = " a step-through debugger for contact iterations";
        let line = Line::from(vec![Span::styled(" stickslip ", app.theme.heading), Span::styled(title, app.theme.faint)]);
        draw::lines(buffer, area, &[line]);
        return;
    };
    // The position is what a screen of one line must show.
    match area.height {
        0 | 1 => draw::lines(buffer, area, &[position(app, view)]),
        2 => draw::lines(buffer, area, &[position(app, view), outcome(app, view)]),
        _ => draw::lines(buffer, area, &[scene(app, view), position(app, view), outcome(app, view)]),
    }
}

fn scene<'a>(app: &App, view: &View<'a>) -> Line<'a> {
    Line::from(vec![
        Span::styled(" stickslip ", app.theme.faint),
        Span::styled(view.scene, app.theme.heading),
        Span::styled(format!("  {}", view.model.title), app.theme.faint),
    ])
}

/// Where the solver is: the minor iteration that is shown, or the first one to come.
fn position(app: &App, view: &View) -> Line<'static> {
    let at = match view.event() {
        Some(event) => event.position,
        None => view.frame().state.next,
    };
    let load = match view.event() {
        Some(event) => event.load_factor,
        None => view.frame().state.load_factor,
    };
    let counts = [("increment", at.increment), ("attempt", at.attempt), ("major", at.major), ("minor", at.minor)];
    let mut spans = vec![Span::raw(" ")];
    for (name, count) in counts {
        spans.push(Span::styled(format!("{name} "), app.theme.faint));
        spans.push(Span::styled(format!("{count}   "), app.theme.heading));
    }
    spans.push(Span::styled("load ", app.theme.faint));
    spans.push(Span::styled(number::plain(load), app.theme.heading));
    let (shown, last) = (view.cursor, view.frames.len() - 1);
    if shown < last {
        spans.push(Span::styled(format!("   {shown} of {last} steps"), app.theme.warning));
    }
    Line::from(spans)
}

/// What the shown minor iteration led to, and what the user has done to the solve.
fn outcome(app: &App, view: &View) -> Line<'static> {
    let theme = &app.theme;
    if view.running {
        const SPINNER: [&str; 4] = ["◐", "◓", "◑", "◒"];
        let turn = SPINNER[app.tick % SPINNER.len()];
        let at = view.frames.last().map(|frame| frame.state.next).unwrap_or_default();
        let text = format!(
            " {turn} solving: increment {}, major {}, minor {}; {} steps so far; Ctrl-C stops",
            at.increment, at.major, at.minor, view.frames.len() - 1
        );
        return Line::styled(text, theme.warning);
    }
    let (text, style) = match view.event() {
        None => ("▸ at the start; nothing is solved yet".into(), theme.text),
        Some(event) => sentence(event, view.model, app),
    };
    let mut spans = vec![Span::styled(format!(" {text}"), style)];
    if let Some(text) = interventions(view) {
        spans.push(Span::styled(format!("   {text}"), theme.warning));
    }
    Line::from(spans)
}

/// What follows from a minor iteration, in a sentence with a glyph before it.
fn sentence(event: &Event, model: &Model, app: &App) -> (String, Style) {
    let theme = &app.theme;
    let changes = event.nodes.iter().filter(|node| node.decision.changes()).count();
    match &event.outcome {
        Outcome::Minor if changes > 0 => {
            (format!("▸ {} changed: another minor iteration", counted(changes, "mode")), theme.text)
        }
        Outcome::Minor => ("▸ modes settled, T_max not yet: another minor iteration".into(), theme.text),
        Outcome::Major { after, settled } => {
            let why = if *settled { "modes settled" } else { "limit of minor iterations accepted" };
            let relative = number::short(after.relative);
            (format!("▸ {why}; residual {relative}: another major iteration"), theme.text)
        }
        Outcome::Increment { unsettled, last, .. } => {
            let end = if *last { "; the history ends here" } else { "" };
            match unsettled {
                0 => (format!("✓ increment converged{end}"), theme.good),
                n => (format!("✓ increment accepted with {} not settled{end}", counted(*n as usize, "loop")), theme.warning),
            }
        }
        Outcome::Failed(failure) => (format!("✗ {}", failure_sentence(failure, model)), theme.bad),
    }
}

/// Why an increment failed, in a sentence.
pub fn failure_sentence(failure: &Failure, model: &Model) -> String {
    let name = |slave: &usize| match model.slaves.get(*slave) {
        Some(slave) => model.nodes[slave.node].name.clone(),
        None => slave.to_string(),
    };
    match failure {
        Failure::Cycle(cycle) => {
            let members: Vec<String> = cycle
                .members
                .iter()
                .take(3)
                .map(|(slave, modes)| {
                    let modes: Vec<_> = modes.iter().map(|mode| theme::word(*mode)).collect();
                    format!("{} ({})", name(slave), modes.join(", "))
                })
                .collect();
            let more = if cycle.members.len() > 3 { ", …" } else { "" };
            format!("modes cycle: period {} from minor {} on; {}{more}", cycle.period, cycle.start, members.join(", "))
        }
        Failure::MinorLimit { limit, changing } => {
            let names: Vec<_> = changing.iter().take(4).map(name).collect();
            format!("modes not settled within {limit} minor iterations; still changing: {}", names.join(", "))
        }
        Failure::MajorLimit { limit, relative } => {
            format!("no equilibrium within {limit} major iterations; residual {}", number::short(*relative))
        }
        Failure::Jammed { slave, gap } => {
            format!("{} is {} deep in a surface and nothing can push it out", name(slave), number::short(-gap))
        }
        Failure::Singular(Singular::Rigid { motions }) => {
            let motions: Vec<_> = motions.iter().map(rigid).collect();
            format!("nothing holds {}", motions.join(", "))
        }
        Failure::Singular(Singular::Unexplained) => {
            "the equations are singular: a limit point, a bifurcation, or dependent constraints".into()
        }
        Failure::Diverged { relative } => format!("diverged: residual {}", number::short(*relative)),
    }
}

fn rigid(motion: &RigidMotion) -> String {
    let RigidMotion { body, motion } = motion;
    match motion {
        Motion::Translation([x, y]) => format!("{body} against moving along ({}, {})", number::short(*x), number::short(*y)),
        Motion::Rotation([x, y]) => format!("{body} against turning about ({}, {})", number::short(*x), number::short(*y)),
    }
}

/// How the user stands behind the modes, if at all.
fn interventions(view: &View) -> Option<String> {
    let forced = (0..view.model.slaves.len()).map(|slave| view.forced(slave));
    let (mut held, mut once) = (0, 0);
    for forced in forced {
        match forced {
            Forced::Held(_) => held += 1,
            Forced::Once(_) => once += 1,
            Forced::No => {}
        }
    }
    let controls = &view.frame().state.controls;
    let increment = (controls.increment != view.model.increment).then(|| {
        format!("increment {} for {}", number::plain(controls.increment), number::plain(view.model.increment))
    });
    let settings = (controls.settings != view.model.settings).then(|| "settings changed".into());
    let friction = view.model.slaves.iter().zip(&controls.friction).any(|(slave, now)| slave.friction != *now);
    let parts = [
        (held > 0).then(|| format!("◆ {held} held")),
        (once > 0).then(|| format!("◇ {once} forced")),
        increment,
        friction.then(|| "friction changed".into()),
        settings,
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join("  "))
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
