//! The top of the screen: the scene, the position of the solver, and the outcome of the last minor iteration.

use crate::app::{App, Overlay, TURN};
use crate::layout::{Pane, ScreenAreas};
use crate::paint;
use crate::view::{AttachedSolver, View};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use stickslip_core::{
    Event, Fallback, Forced, Model, Outcome, RewindSupport, Status, Strategy, counted,
};
use stickslip_debugger::DiagnosisPage;
use stickslip_debugger::action::by_name;
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::report;
use stickslip_scene::{joined, number};
use unicode_width::UnicodeWidthStr;

/// Draws the status. Lines that do not fit cover the rows below.
pub fn draw(buffer: &mut Buffer, places: &ScreenAreas, app: &App, view: Option<&View>) {
    let area = places.status;
    let Some(view) = view else {
        let title = " a step-through debugger for contact iterations";
        let line = Line::from(vec![
            Span::styled(" stickslip ", app.theme.heading),
            Span::styled(title, app.theme.faint),
        ]);
        paint::lines(buffer, area, &[line]);
        return;
    };
    // A screen of one line shows the position.
    let mut lines = vec![position(app, view, area.width as usize)];
    if area.height > 2 {
        lines.insert(0, scene(app, view, area.width as usize));
    }
    let outcome_lines = outcome(app, view, area.width);
    // The diagnosis repeats the outcome, and needs its rows.
    let open = matches!(app.overlay, Overlay::None) && app.panes.focus != Pane::Diagnosis;
    let more = usize::from(open) * (outcome_lines.len().min(OUTCOME) + lines.len());
    lines.extend(outcome_lines.into_iter().take(OUTCOME));
    let below = (places.message.y.saturating_sub(area.bottom())) / 3;
    let height = area.height + (more as u16).saturating_sub(area.height).min(below);
    paint::over(buffer, Rect { height, ..area }, &lines, &app.theme);
}

/// Maximum number of lines for the outcome.
const OUTCOME: usize = 2;

/// Least width of a cut title.
const TITLE: usize = 12;

/// The attached solver, how it goes back, and the counts of its warnings and errors.
fn solver_line(app: &App, view: &View, attached: &AttachedSolver, width: usize) -> Line<'static> {
    let theme = &app.theme;
    let offers = attached.offers;
    let name = format!("{} {}", offers.name, offers.version);
    let (state, style) = match (attached.lost, offers.past, offers.goes_back) {
        (true, ..) => ("✗ lost; the next step restarts it", theme.bad),
        (_, Some(record), _) => (record, theme.warning),
        (.., RewindSupport::ToAny) => ("attached, can go back to any state", theme.faint),
        (.., RewindSupport::ToIncrements) => (
            "attached, goes back to increments, then replays",
            theme.faint,
        ),
        (.., RewindSupport::Again) => ("attached, goes back by restart", theme.faint),
    };
    let key = by_name("log")
        .ok()
        .and_then(|entry| app.keymap.keys(entry).next());
    let counted = match app.log_counts.words() {
        none if none.is_empty() => none,
        counted => format!("{counted} ({})", key.unwrap_or(":log")),
    };
    let gap = |text: &str| if text.is_empty() { "" } else { "   " };
    let title = view.model.title.as_str();
    let parts = [
        (" stickslip ", theme.faint),
        (name.trim(), theme.heading),
        ("   ", theme.faint),
        (state, style),
        (gap(&counted), theme.faint),
        (counted.as_str(), theme.warning),
        (gap(title), theme.faint),
        (title, theme.faint),
    ];
    // A long name is cut in favour of the state.
    let fixed = state.width() + counted.width() + 17;
    let mut room = width;
    let mut spans = Vec::new();
    for (at, (text, style)) in parts.into_iter().enumerate() {
        let most = if at == 1 {
            width.saturating_sub(fixed).max(8)
        } else {
            room
        };
        // A few letters of the title are of no use.
        let text = match at {
            7 if room < TITLE.min(text.width()) => String::new(),
            _ => paint::cut(text, most.min(room)),
        };
        room -= text.width();
        spans.push(Span::styled(text, style));
    }
    Line::from(spans)
}

fn scene<'a>(app: &App, view: &View<'a>, width: usize) -> Line<'a> {
    if let Some(attached) = &view.attached {
        return solver_line(app, view, attached, width);
    }
    const PROGRAM: &str = " stickslip ";
    // A path would displace the title.
    let file = std::path::Path::new(view.name).file_name();
    let name = file.map_or(view.name.into(), |file| file.to_string_lossy());
    let name = paint::cut(&name, width.saturating_sub(PROGRAM.width()));
    let room = width.saturating_sub(PROGRAM.width() + name.width());
    // A deck has no title, and is called by its name.
    let title = if view.model.title == name {
        String::new()
    } else {
        format!("  {}", view.model.title)
    };
    Line::from(vec![
        Span::styled(PROGRAM, app.theme.faint),
        Span::styled(name, app.theme.heading),
        Span::styled(paint::cut(&title, room), app.theme.faint),
    ])
}

/// The position of the solver: the shown minor iteration, or the first one. A narrow screen has less space between the parts, and
/// leaves out attempt 1.
fn position(app: &App, view: &View, width: usize) -> Line<'static> {
    let (wide, closer) = (place(app, view, "   ", true), place(app, view, "  ", true));
    let second = view.position().attempt > 1;
    let mut line = [wide, closer]
        .into_iter()
        .find(|line| line.width() <= width)
        .unwrap_or_else(|| place(app, view, " ", second));
    if let Some((done, all)) = app.measuring {
        let percent = 100 * done / all.max(1);
        let chart = Span::styled(format!("   chart: {percent} %"), app.theme.warning);
        if line.width() + chart.width() <= width {
            line.push_span(chart);
        }
    }
    if view.attached.is_some_and(|attached| attached.lost) {
        end_with(&mut line, "  ✗ lost", width, app);
    }
    if app.unkept {
        // Nothing is recorded any more, so this must stay visible.
        const LOST: [&str; 2] = ["   no journal (:journal FILE)", "  no journal"];
        let words = LOST
            .iter()
            .find(|words| line.width() + words.width() <= width)
            .unwrap_or(&LOST[1]);
        end_with(&mut line, words, width, app);
    }
    line
}

/// Appends words to a line, instead of its last parts if necessary.
fn end_with(line: &mut Line, words: &'static str, width: usize, app: &App) {
    while line.width() + words.width() > width && line.spans.pop().is_some() {}
    line.push_span(Span::styled(words, app.theme.bad));
}

fn place(app: &App, view: &View, apart: &str, attempt: bool) -> Line<'static> {
    let at = view.position();
    let load = match view.event() {
        Some(event) => event.load_factor,
        None => view.frame().state.load_factor,
    };
    let model = view.model;
    let (two_levels, minor, drive) = match model.finished {
        None => (true, "minor", "load"),
        Some(_) => (false, "iteration", "time"),
    };
    let counts = [
        ("increment", model.increment_name(at.increment), true),
        ("attempt", at.attempt.to_string(), attempt || !two_levels),
        ("major", at.major.to_string(), two_levels),
        (minor, at.minor.to_string(), true),
        (drive, number::shortest(load), !load.is_nan()),
    ];
    let mut spans = vec![Span::raw(" ")];
    for (name, count, _) in counts.into_iter().filter(|(_, _, shown)| *shown) {
        let before = if spans.len() == 1 { "" } else { apart };
        spans.push(Span::styled(format!("{before}{name} "), app.theme.faint));
        spans.push(Span::styled(count, app.theme.heading));
    }
    let (shown, last) = (view.cursor, view.frames.len() - 1);
    if shown < last {
        spans.push(Span::styled(
            format!("{apart}{shown} of {}", counted(last, "step")),
            app.theme.warning,
        ));
    }
    Line::from(spans)
}

/// The initial state, with its start gaps.
fn start(view: &View) -> String {
    let text = "▸ at the start; nothing is solved yet";
    match view.start_gaps {
        "" => text.into(),
        gaps => format!("{text}; start gaps: {gaps}"),
    }
}

/// The outcome of the shown minor iteration, and the user's interventions.
fn outcome(app: &App, view: &View, width: u16) -> paint::Lines {
    let theme = &app.theme;
    if view.running {
        const SPINNER: [&str; 4] = ["◐", "◓", "◑", "◒"];
        let turns = (app.busy.as_millis() / TURN.as_millis()) as usize;
        let turn = SPINNER[turns % SPINNER.len()];
        let progress = view.attached.and_then(|attached| attached.log.progress());
        let state = view.frames.last().map(|frame| &frame.state);
        let load = state.map_or(String::new(), |state| {
            names::load_of(view.model, state.start.leg, state.load_factor)
        });
        let place = state.map_or(String::new(), |state| {
            format!(", {}", names::position(state.next))
        });
        let took = match app.busy.as_secs() {
            0 | 1 => String::new(),
            seconds => format!(", {seconds} s"),
        };
        let steps = counted(view.frames.len() - 1, "step");
        let line = |place: &str| format!(" {turn} solving: {load}{place}{took}; Ctrl-C stops");
        // The progress of a long step leaves no room for the position; otherwise the line above shows it.
        let lines = match progress {
            Some(progress) => vec![line(&format!("; {progress}"))],
            None => vec![
                line(&format!("{place}; {steps} so far")),
                line(&format!("; {steps} so far")),
                line(""),
            ],
        };
        let fits = |text: &&String| text.width() <= usize::from(width);
        let text = lines.iter().find(fits).or(lines.last());
        let text = text.map_or("", String::as_str);
        let text = paint::cut(text, width as usize);
        let again = view.attached.map_or("", |attached| attached.again);
        let first = (!again.is_empty()).then(|| format!("   {again} first"));
        return [Some(text), first]
            .into_iter()
            .flatten()
            .map(|text| Line::styled(text, theme.warning))
            .collect();
    }
    let mut tried = None;
    let (text, style) = match (view.intervention(), view.event()) {
        (Some(intervention), _) => (
            format!("◇ {}", report::intervention(view.model, intervention)),
            theme.strong,
        ),
        (None, None) => (start(view), theme.text),
        (None, Some(_)) if app.learning.hides_verdict() => (
            "? Accepted. Predict the judge's verdict (a)".into(),
            theme.text,
        ),
        (None, Some(_)) if app.learning.hides_any(view) => {
            ("? Solved. Predict the next mode (a)".into(), theme.text)
        }
        (None, Some(event)) => match view.examination().flatten() {
            Some(page) if page.found.fails && matches!(event.outcome, Outcome::Failed(_)) => {
                tried = page.works().map(|line| format!("Try {}", line.command()));
                (diagnosed(page), theme.bad)
            }
            _ => sentence(event, view.model, app),
        },
    };
    // Further lines are indented to the words after the glyph.
    let room = (width as usize).saturating_sub(4);
    let mut words = paint::wrap(&text, room);
    let asides = joined(
        tried
            .into_iter()
            .chain(interventions(view))
            .filter(|aside| !text.ends_with(aside)),
        "   ",
    );
    let aside = whole_parts(&asides, room);
    // A long aside needs a line; a short one needs the end of the last line.
    let (most, end) = match aside.width() {
        0 => (OUTCOME, 0),
        wide if wide > room / 2 => (OUTCOME - 1, 0),
        wide => (OUTCOME, wide + 3),
    };
    if words.len() > most
        || words.len() == most && words.last().is_some_and(|last| last.width() + end > room)
    {
        words.truncate(most);
        if let Some(last) = words.last_mut() {
            *last = paint::cut(&format!("{last} …"), room.saturating_sub(end).max(1));
        }
    }
    let indent = |index: usize| if index == 0 { " " } else { "   " };
    let line =
        |(index, words): (usize, String)| Line::styled(format!("{}{words}", indent(index)), style);
    let mut lines: Vec<Line> = words.into_iter().enumerate().map(line).collect();
    if !aside.is_empty() {
        match lines.last_mut() {
            Some(last) if last.width() + 3 + aside.width() <= width as usize => {
                last.spans.iter_mut().for_each(|span| span.style = style);
                last.style = Style::new();
                last.push_span(Span::raw("   "));
                last.push_span(Span::styled(aside, theme.warning));
            }
            _ => lines.push(Line::from(vec![
                Span::raw("   "),
                Span::styled(aside, theme.warning),
            ])),
        }
    }
    lines
}

/// The parts of an aside that fit: a part is shown whole or not at all, unless it is the only one.
fn whole_parts(aside: &str, room: usize) -> String {
    let cut = paint::cut(aside, room);
    match cut.rfind("  ") {
        Some(at) if cut != aside => format!("{} …", cut[..at].trim_end()),
        _ => cut,
    }
}

/// What failed; the line above shows the position.
fn diagnosed(page: &DiagnosisPage) -> String {
    // The page of an attached solver begins with the reason.
    let what = match page.what.split_once(": ") {
        Some((place, what)) if place.starts_with("increment ") => what,
        _ => &page.what,
    };
    format!("✗ {what}")
}

/// The outcome of a minor iteration as a sentence with a glyph.
fn sentence(event: &Event, model: &Model, app: &App) -> (String, Style) {
    let theme = &app.theme;
    let (glyph, style) = match &event.outcome {
        Outcome::Minor | Outcome::Major { settled: true, .. } => ("▸", theme.text),
        Outcome::Damped { .. }
        | Outcome::StrategyChange { .. }
        | Outcome::Cut { .. }
        | Outcome::WholeIncrement { .. }
        | Outcome::PathCorner { .. }
        | Outcome::HeldBack { .. }
        | Outcome::Motion(_)
        | Outcome::Fallback { .. }
        | Outcome::Refused { .. }
        | Outcome::Major { settled: false, .. } => ("▸", theme.warning),
        Outcome::Increment {
            unsettled: 0,
            marked: None,
            jumped: false,
            left_range: None,
            ..
        } => ("✓", theme.good),
        Outcome::Increment { .. } => ("✓", theme.warning),
        Outcome::Failed(_) => ("✗", theme.bad),
    };
    let words = report::outcome(model, event);
    // The line above shows the position.
    let place = format!("{}: ", names::position_in(model, event.position));
    (
        format!("{glyph} {}", words.strip_prefix(&place).unwrap_or(&words)),
        style,
    )
}

/// Strategy, cuts and the user's interventions, if any.
fn interventions(view: &View) -> Option<String> {
    let forced = (0..view.model.contacts.len()).map(|slave| view.forced(slave));
    let (mut held, mut once) = (0, 0);
    for forced in forced {
        match forced {
            Forced::Held(_) => held += 1,
            Forced::Once(_) => once += 1,
            Forced::No => {}
        }
    }
    let state = &view.frame().state;
    let controls = &state.controls;
    // At the end of the path the last leg's value still applies.
    let leg = state.start.leg.min(view.model.path.len() - 2);
    let of_scene = view.model.on_leg(leg);
    let increment = (controls.increment != of_scene).then(|| {
        format!(
            "increment {} (scene: {})",
            number::shortest(controls.increment),
            number::shortest(of_scene)
        )
    });
    let settings = (controls.settings != view.model.settings).then(|| "settings changed".into());
    let friction = view
        .model
        .contacts
        .iter()
        .zip(&controls.friction)
        .any(|(slave, now)| slave.friction != *now);
    let state = &view.frame().state;
    let strategy = state.settings().strategy;
    let leads = strategy != Strategy::Table2 && state.status != Status::Finished;
    let fallbacks = joined(state.fallbacks().map(Fallback::words), ", ");
    let parts = [
        (!fallbacks.is_empty()).then(|| format!("fallback: {fallbacks}")),
        leads.then(|| format!("strategy {}", strategy.name())),
        (state.sub_increment.cut > 0).then(|| {
            format!(
                "increment cut to {}",
                number::shortest(state.sub_increment.size())
            )
        }),
        (held > 0).then(|| format!("◆ {held} held")),
        (once > 0).then(|| format!("◇ {once} forced")),
        increment,
        friction.then(|| "friction changed".into()),
        settings,
    ];
    let parts = joined(parts.into_iter().flatten(), "  ");
    (!parts.is_empty()).then_some(parts)
}
