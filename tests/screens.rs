//! What the screen shows, and what keys do to it.
//!
//! The frames here are made by hand, so that every mark, tie and failure can be put on the screen at will; the
//! debugger on a real scene is tested at the end. Snapshots hold the symbols; where a style carries meaning it is
//! asserted on the cell.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};
use std::sync::Arc;
use stickslip::contact::record::{ContactRecord, Forced};
use stickslip::contact::table2::{Decision, Entry, Numbers, Rule, Ties, decide};
use stickslip::history::frame::Frame;
use stickslip::interface::minor_history::Cycle;
use stickslip::linear::norms::Norms;
use stickslip::model::{Beam, Body, BodyKind, Dofs, Monitor, Node, Slave, Surface, Watched};
use stickslip::model::{Friction, Mode, Model, Settings};
use stickslip::record::command::{Command, Unit};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Position;
use stickslip::step::event::{Event, Failure, Outcome};
use stickslip::step::state::State;
use stickslip::tui::app::{App, Effect, Offer};
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, View, keys, screen};

/// A beam of five nodes over a floor; all of its nodes are slaves, or as many as asked for.
fn model(slaves: usize) -> Model {
    let count = slaves.max(5);
    let beam = (0..count).map(|k| Node {
        name: format!("beam.{}", k + 1),
        at: [k as f64 * 4.0 / (count - 1) as f64, 0.1],
    });
    let floor = [-1.0, 2.0, 5.0].map(|x| Node {
        name: "floor".into(),
        at: [x, 0.0],
    });
    let nodes: Vec<Node> = beam.chain(floor).collect();
    let elements = match count {
        5 => vec![(0..5).collect()],
        _ => (0..count - 1).map(|k| vec![k, k + 1]).collect(),
    };
    Model {
        title: "A beam over a floor".into(),
        about: String::new(),
        bodies: vec![Body {
            name: "beam".into(),
            nodes: (0..count).collect(),
            kind: BodyKind::Beam(Beam {
                elements,
                ea: 1.0,
                ei: 1.0,
                ga: None,
                first_shear: None,
            }),
        }],
        // The outward side is on the right: walked towards −x, the floor looks up.
        surfaces: vec![Surface {
            name: "floor".into(),
            elements: vec![vec![count + 2, count + 1], vec![count + 1, count]],
            rigid: true,
            endless: false,
        }],
        slaves: (0..slaves)
            .map(|node| Slave {
                node,
                surfaces: vec![0],
                friction: Friction {
                    angle: 20.0,
                    cohesion: 0.0,
                },
                start: Mode::Free,
                state: Default::default(),
            })
            .collect(),
        dofs: Dofs {
            first: (0..nodes.len()).map(|node| 3 * node).collect(),
            count: vec![3; nodes.len()],
            equation: vec![None; 3 * nodes.len()],
            equations: 0,
            inner: 0,
        },
        nodes,
        loads: vec![],
        prescribed: vec![],
        path: vec![0.0, 1.0],
        increment: 0.1,
        least: None,
        jumps: Default::default(),
        settings: Settings::default(),
        monitors: vec![],
        length: 4.0,
    }
}

/// What the table would say of these numbers.
fn record(mode: Mode, gap: f64, f_n: f64, f_t: f64, t_max: f64, slip: f64) -> ContactRecord {
    let ties = Ties {
        force: 1e-12,
        length: 1e-12,
        keep: true,
    };
    let decision = decide(
        &Numbers {
            mode,
            gap,
            f_n,
            f_t,
            t_max,
            slip,
            entry: Entry::Fixed,
        },
        &ties,
    );
    ContactRecord {
        decision,
        forced: Forced::No,
        gap,
        f_n,
        f_t,
        t_max,
        t_max_used: t_max,
        slip,
        drift: 0.0,
        spot: None,
        normal: [0.0, 1.0],
        foot: [0.0, 0.0],
        carried: [false; 2],
    }
}

/// One node of every kind that a screen should be able to show.
fn records() -> Vec<ContactRecord> {
    vec![
        record(Mode::Fixed, 0.0, 1.23456789e-1, 4.0e-2, 4.4934579e-2, 0.0),
        record(Mode::Fixed, 0.0, 2.5e-1, -9.2e-2, -9.099255856e-2, 0.0),
        ContactRecord {
            t_max_used: 1.0e-3,
            ..record(
                Mode::Sliding,
                0.0,
                3.0e-3,
                1.0919107e-3,
                1.0919107e-3,
                1.2345678912e-10,
            )
        },
        record(Mode::Free, -1.23456789012e-3, 0.0, 0.0, 0.0, 0.0),
        record(Mode::Free, 4.2e-2, 0.0, 0.0, 0.0, 0.0),
    ]
}

fn event(position: (u32, u32, u32), nodes: Vec<ContactRecord>, outcome: Outcome) -> Event {
    let (increment, major, minor) = position;
    Event {
        position: Position {
            increment,
            attempt: 1,
            major,
            minor,
        },
        load_factor: increment as f64 / 10.0,
        nodes,
        before: Norms::default(),
        outcome,
    }
}

/// The start, and one frame after this event, in which the beam is bent.
fn frames(model: &Model, event: Event) -> Vec<Frame> {
    let start = State::new(model);
    let mut state = start.clone();
    let mut u = vec![0.0; model.dofs.len()];
    for (node, Node { at, .. }) in model
        .nodes
        .iter()
        .enumerate()
        .take(model.bodies[0].nodes.len())
    {
        u[3 * node + 1] = -0.03 * at[0] * at[0] + 0.1 * at[0];
    }
    state.u = Arc::new(u);
    state.next = Position {
        minor: event.position.minor + 1,
        ..event.position
    };
    for (node, record) in state.nodes.iter_mut().zip(&event.nodes) {
        node.mode = record.decision.next;
    }
    vec![
        Frame {
            state: start,
            event: None,
            intervention: None,
            monitors: None,
        },
        Frame {
            state,
            event: Some(Arc::new(event)),
            intervention: None,
            monitors: None,
        },
    ]
}

fn residuals() -> Vec<(u32, Norms)> {
    let norm = |relative| Norms {
        relative,
        interface: 1e-3 * relative,
        limit: 1e-10,
        ..Norms::default()
    };
    [1.0, 3.1e-2, 4.4e-5, 2.0e-9, 0.0]
        .iter()
        .enumerate()
        .map(|(k, v)| (k as u32 + 1, norm(*v)))
        .collect()
}

fn view<'a>(model: &'a Model, frames: &'a [Frame]) -> View<'a> {
    View {
        name: "by-hand",
        scene: None,
        model,
        frames,
        strips: &[],
        tree: None,
        background: None,
        cursor: frames.len() - 1,
        running: false,
        residuals: residuals(),
    }
}

fn app() -> App {
    App::new(Theme::colour(), vec![])
}

/// Presses keys by their names, parted by blanks, and returns the effects.
fn press(app: &mut App, view: &View, names: &str) -> Vec<Effect> {
    let keys = names
        .split_whitespace()
        .map(|name| keys::press(name).expect("a key's name"));
    keys.filter_map(|key| app.key(&key, Some(view))).collect()
}

fn type_text(app: &mut App, view: &View, text: &str) {
    for letter in text.chars() {
        let name = if letter == ' ' {
            "Space".into()
        } else {
            letter.to_string()
        };
        press(app, view, &name);
    }
}

fn render(app: &App, view: &View, width: u16, height: u16) -> Buffer {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    screen::draw(&mut buffer, area, app, Some(view));
    buffer
}

/// The first cell from which on a text stands on the screen.
fn find<'a>(buffer: &'a Buffer, text: &str) -> &'a Cell {
    for row in buffer.area.rows() {
        let symbols: Vec<&str> = row
            .columns()
            .map(|cell| buffer[(cell.x, cell.y)].symbol())
            .collect();
        let letters: Vec<String> = text.chars().map(String::from).collect();
        let at = symbols
            .windows(letters.len())
            .position(|part| part.iter().zip(&letters).all(|(a, b)| a == b));
        if let Some(x) = at {
            return &buffer[(x as u16, row.y)];
        }
    }
    panic!("'{text}' is not on the screen");
}

fn minor() -> Event {
    event((3, 2, 4), records(), Outcome::Minor)
}

#[test]
fn whole_screens() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        insta::assert_snapshot!(
            format!("by-hand-{width}x{height}"),
            screen::text(&app(), Some(&view), width, height)
        );
    }
}

#[test]
fn the_small_screen_turns_its_page() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    let mut seen = Vec::new();
    for _ in 0..9 {
        seen.push(screen::text(&app, Some(&view), 80, 24));
        press(&mut app, &view, "Tab");
    }
    let titles = [
        " Decision ",
        " Decision ",
        " Residual by major",
        " Shape ",
        " Load ",
        " Timeline ",
        " Diagnosis ",
        " Branches ",
        " Remedies ",
    ];
    for (screen, title) in seen.iter().zip(titles) {
        assert!(
            screen.contains(title) && screen.contains(" Slave nodes "),
            "{screen}"
        );
    }
    assert!(seen[3].contains("Tab page 4/9"));
    assert_eq!(
        screen::text(&app, Some(&view), 80, 24)
            .matches(" Remedies ")
            .count(),
        1,
        "the page stays when the table has the focus"
    );
    insta::assert_snapshot!("by-hand-residual-80x24", seen[2]);
    insta::assert_snapshot!("by-hand-shape-80x24", seen[3]);
}

#[test]
fn the_fired_cell_is_lit_and_nothing_else_is() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "Down");
    let screen = render(&app, &view, 120, 40);
    let lit = find(&screen, "|F_t| > |T_max|");
    assert!(lit.modifier.contains(Modifier::REVERSED));
    assert_eq!(lit.fg, Color::Yellow, "the colour of sliding");
    let dark = find(&screen, "|F_t| < |T_max|");
    assert!(!dark.modifier.contains(Modifier::REVERSED));
    // A row that the node is not in stands back.
    assert!(
        find(&screen, "T_max·slip < 0")
            .modifier
            .contains(Modifier::DIM)
    );
}

#[test]
fn without_colour_the_weights_carry_everything() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = App::new(Theme::mono(), vec![]);
    press(&mut app, &view, "Down");
    for keys in ["", "Tab", "?", "Esc", ":", "Esc", "m"] {
        press(&mut app, &view, keys);
        let screen = render(&app, &view, 120, 40);
        assert!(
            screen
                .content
                .iter()
                .all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset)
        );
    }
    press(&mut app, &view, "Esc");
    let screen = render(&app, &view, 120, 40);
    assert!(
        find(&screen, "|F_t| > |T_max|")
            .modifier
            .contains(Modifier::REVERSED)
    );
    assert!(
        find(&screen, "beam.2 fixed →")
            .modifier
            .contains(Modifier::REVERSED),
        "the selected row"
    );
    assert!(
        find(&screen, "fixed → sliding")
            .modifier
            .contains(Modifier::BOLD),
        "a changed mode"
    );
}

#[test]
fn a_tie_is_told_from_a_near_tie() {
    let model = model(2);
    let tie = record(Mode::Fixed, 0.0, 1.0, 0.5, 0.5, 0.0);
    let near = record(Mode::Fixed, 0.0, 1.0, 0.5 - 1e-10, 0.5, 0.0);
    let frames = frames(&model, event((1, 1, 1), vec![tie, near], Outcome::Minor));
    let view = view(&model, &frames);
    let mut app = app();
    let screen = screen::text(&app, Some(&view), 80, 24);
    assert!(
        screen.contains("|F_t| 5.000000000e-1 = |T_max| 5.000000000e-1"),
        "{screen}"
    );
    assert!(
        screen.contains("a tie, by 0 force") && screen.contains("A tie keeps the"),
        "{screen}"
    );
    assert!(screen.contains(" 1-2e-10 "), "{screen}");
    press(&mut app, &view, "Down");
    let screen = screen::text(&app, Some(&view), 80, 24);
    assert!(screen.contains("margin 1.000000083e-10 force"), "{screen}");
}

#[test]
fn held_and_off_surface_nodes_are_told_in_words() {
    let model = model(2);
    let table = record(Mode::Free, -1e-3, 0.0, 0.0, 0.0, 0.0);
    let decision = Decision {
        next: Mode::Free,
        rule: Rule::Held,
        ..table.decision
    };
    let held = ContactRecord {
        decision,
        forced: Forced::Held(Mode::Free),
        ..table
    };
    let apart = record(Mode::Free, 1.0, 0.0, 0.0, 0.0, 0.0);
    let decision = Decision {
        rule: Rule::OffSurface,
        tests: [None, None],
        ..apart.decision
    };
    let off = ContactRecord { decision, ..apart };
    let mut frames = frames(&model, event((1, 1, 1), vec![held, off], Outcome::Minor));
    frames[1].state.nodes[0].forced = Forced::Held(Mode::Free);
    let view = view(&model, &frames);
    let mut app = app();
    let screen = screen::text(&app, Some(&view), 80, 24);
    assert!(
        screen.contains("You hold it free; Table 2 (◁) wanted fixed."),
        "{screen}"
    );
    assert!(
        screen.contains("▸ ◆beam.1") && screen.contains("◆ 1 held"),
        "{screen}"
    );
    assert!(
        find(&render(&app, &view, 80, 24), "g < 0")
            .modifier
            .contains(Modifier::UNDERLINED)
    );
    press(&mut app, &view, "Down");
    let screen = screen::text(&app, Some(&view), 80, 24);
    assert!(
        screen.contains("the projection lies past an end of every surface"),
        "{screen}"
    );
    assert!(!screen.contains("◀"), "{screen}");
}

#[test]
fn outcomes_have_a_glyph_and_a_sentence() {
    let model = model(5);
    let say = |outcome| {
        let frames = frames(&model, event((3, 2, 4), records(), outcome));
        screen::text(&app(), Some(&view(&model, &frames)), 120, 40)
            .lines()
            .nth(2)
            .unwrap_or("")
            .to_string()
    };
    let after = Norms {
        relative: 2e-5,
        limit: 1e-11,
        ..Norms::default()
    };
    assert_eq!(
        say(Outcome::Minor),
        " ▸ beam.2 fixed > sliding, beam.4 free > fixed"
    );
    assert_eq!(
        say(Outcome::Major {
            after,
            settled: true
        }),
        " ▸ minors settled; residual 2.000e-5, wanted 1.0e-11"
    );
    let done = |unsettled| Outcome::Increment {
        after,
        unsettled,
        marked: None,
        jumped: false,
        last: false,
    };
    assert_eq!(say(done(0)), " ✓ load 0.3 accepted");
    assert_eq!(
        say(done(1)),
        " ✓ load 0.3 accepted, although one loop was cut off unsettled"
    );
    let cycle = Cycle {
        start: 2,
        period: 2,
        members: vec![(4, vec![Mode::Free, Mode::Fixed])],
    };
    assert_eq!(
        say(Outcome::Failed(Failure::Cycle(cycle))),
        " ✗ the modes 2-cycle since minor 2: beam.5 free > fixed > …"
    );
}

#[test]
fn hundreds_of_nodes_scroll_with_the_selection() {
    let model = model(400);
    let nodes = vec![record(Mode::Fixed, 0.0, 1.0, 0.1, 0.3, 0.0); 400];
    let frames = frames(&model, event((1, 1, 1), nodes, Outcome::Minor));
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "End Up PageUp");
    assert_eq!(app.selected, 388);
    assert!(screen::text(&app, Some(&view), 80, 24).contains("▸  beam.389"));
    press(&mut app, &view, "/");
    type_text(&mut app, &view, "beam.77");
    press(&mut app, &view, "Enter");
    assert_eq!(app.selected, 76);
    press(&mut app, &view, "/");
    type_text(&mut app, &view, "99");
    press(&mut app, &view, "Enter");
    assert_eq!(app.selected, 98);
}

/// Names in the table on the screen, from the top down.
fn listed(app: &App, view: &View) -> Vec<String> {
    let screen = screen::text(app, Some(view), 120, 40);
    let rows = screen.lines().filter(|line| line.starts_with('┃'));
    rows.filter_map(|row| {
        row.split_whitespace()
            .find(|word| word.starts_with("beam."))
    })
    .map(|name| name.trim_start_matches("beam.").to_string())
    .collect()
}

#[test]
fn the_table_sorts_and_filters_and_the_selection_stays_on_its_node() {
    let mut model = model(5);
    model.surfaces.push(model.surfaces[0].clone());
    model.contacts[4].surfaces = vec![1];
    let mut event = minor();
    event.before.scale = 1.0;
    let mut frames = frames(&model, event);
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "Down Down Down >");
    // Of 4 and 5, free both, the gap over the length counts; of the others the force over the scale, or the slip.
    assert_eq!(listed(&app, &view), ["3", "4", "2", "1", "5"]);
    assert_eq!(app.selected, 3);
    assert!(screen::text(&app, Some(&view), 80, 24).contains(" Slave nodes  2/5  by margin "));
    press(&mut app, &view, "Down");
    assert_eq!(app.selected, 1, "the row below, whatever its number");
    press(&mut app, &view, "<");
    assert_eq!(listed(&app, &view), ["5", "1", "2", "4", "3"]);
    press(&mut app, &view, "< >");
    assert_eq!(listed(&app, &view), ["4", "1", "2", "3", "5"]);
    press(&mut app, &view, "> A");
    assert_eq!(listed(&app, &view), ["1", "2", "3", "4"]);
    assert!(screen::text(&app, Some(&view), 80, 24).contains(" 2/4 active of 5 "));
    press(&mut app, &view, "A");
    assert_eq!(listed(&app, &view), ["1", "2", "3", "4"], "one surface");
    press(&mut app, &view, "A End A");
    assert_eq!(
        listed(&app, &view),
        ["1", "2", "3", "4", "5"],
        "the selected one is kept"
    );
    press(&mut app, &view, "A");
    assert_eq!(listed(&app, &view), ["5"], "the other surface");
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "filter all");
    press(&mut app, &view, "Enter :");
    type_text(&mut app, &view, "sort lucky");
    press(&mut app, &view, "Enter");
    assert!(app.message.text.contains("none of scene, margin, gap"));
    // What has no margin and no gap is last either way.
    frames[1].event = None;
    let view = self::view(&model, &frames);
    for keys in [">", "<", ">"] {
        press(&mut app, &view, keys);
        assert_eq!(listed(&app, &view), ["1", "2", "3", "4", "5"]);
    }
}

#[test]
fn the_load_is_drawn_over_a_monitor() {
    let mut model = model(5);
    for (name, dof) in [("tip y", 13), ("tip x", 12)] {
        model.monitors.push(Monitor {
            name: name.into(),
            of: Watched::Displacement { dof },
        });
    }
    let mut frames = frames(&model, minor());
    for k in 1..=8 {
        let mut done = frames[1].clone();
        let mut event = minor();
        event.load_factor = 0.1 * f64::from(k);
        done.event = Some(Arc::new(event));
        done.monitors = Some(Arc::new(vec![-0.01 * f64::from(k * k), 0.5]));
        frames.push(done);
    }
    let mut view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "Tab Tab Tab Tab");
    insta::assert_snapshot!(
        "by-hand-curve-80x24",
        screen::text(&app, Some(&view), 80, 24)
    );
    view.cursor = 4;
    let back = screen::text(&app, Some(&view), 80, 24);
    assert!(back.contains("● -9.000e-2  at load 0.3"), "{back}");
    assert!(back.contains("-6.400e-1"), "the scale stays");
    press(&mut app, &view, "y");
    assert!(screen::text(&app, Some(&view), 80, 24).contains(" Load over tip x  2/2 "));
    press(&mut app, &view, "Shift-Tab");
    let medium = screen::text(&app, Some(&view), 120, 40);
    assert!(medium.contains(" Load over ") && !medium.contains(" Residual "));
    view.cursor = 0;
    assert!(screen::text(&app, Some(&view), 200, 60).contains("No increment is done yet."));
}

#[test]
fn keys_become_commands() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let forward = |unit, count| Effect::Submit(Command::Forward { unit, count });
    let back = |unit, count| Effect::Submit(Command::Back { unit, count });
    let force = |slave, mode, hold| Effect::Submit(Command::Force { slave, mode, hold });
    let ask = |keys: &str| press(&mut app(), &view, keys);
    assert_eq!(
        ask("s n f c"),
        [
            forward(Unit::Minor, 1),
            forward(Unit::Major, 1),
            forward(Unit::Increment, 1),
            forward(Unit::Run, 1)
        ]
    );
    assert_eq!(
        ask("S N F C"),
        [
            back(Unit::Minor, 1),
            back(Unit::Major, 1),
            back(Unit::Increment, 1),
            back(Unit::Run, 1)
        ]
    );
    assert_eq!(
        ask("F11 F10 F5"),
        [
            forward(Unit::Minor, 1),
            forward(Unit::Major, 1),
            forward(Unit::Run, 1)
        ]
    );
    assert_eq!(
        ask("1 0 s Enter"),
        [forward(Unit::Minor, 10), forward(Unit::Minor, 10)]
    );
    assert_eq!(ask("4 Esc s"), [forward(Unit::Minor, 1)]);
    assert_eq!(
        ask("m x Down m S M"),
        [
            force(0, Mode::Fixed, false),
            force(1, Mode::Sliding, true),
            Effect::Submit(Command::Release { slave: 1 })
        ]
    );
    assert_eq!(ask("m Esc m q"), []);
    assert_eq!(
        ask("i 0 . 0 0 5 Enter"),
        [Effect::Submit(Command::Increment(0.005))]
    );
    assert_eq!(
        ask("w q"),
        [
            Effect::Submit(Command::Snapshot {
                file: None,
                overwrite: false
            }),
            Effect::Quit
        ]
    );
    assert_eq!(ask("Ctrl-c"), []);
    let running = View {
        running: true,
        ..view.clone()
    };
    assert_eq!(
        press(&mut app(), &running, "Ctrl-c : Ctrl-c"),
        [Effect::Interrupt, Effect::Interrupt]
    );
}

#[test]
fn the_command_line_completes_recalls_and_complains() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "fri");
    let effects = press(&mut app, &view, "Tab 2 5 Enter");
    let set = Effect::Submit(Command::Set {
        path: "friction.angle".into(),
        value: "25".into(),
    });
    assert_eq!(effects, std::slice::from_ref(&set));
    assert_eq!(press(&mut app, &view, ": Up Enter"), [set]);
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "jump");
    assert!(screen::text(&app, Some(&view), 80, 24).contains("\n:jump"));
    press(&mut app, &view, "Enter");
    let screen = render(&app, &view, 80, 24);
    assert_eq!(find(&screen, "no action is called 'jump'").fg, Color::Red);
}

#[test]
fn help_lists_every_action_and_scrolls() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "?");
    insta::assert_snapshot!("help-110x70", screen::text(&app, Some(&view), 110, 70));
    let top = screen::text(&app, Some(&view), 80, 24);
    press(&mut app, &view, "G");
    let end = screen::text(&app, Some(&view), 80, 24);
    assert!(
        top.contains("Go through the iterations") && end.contains("closer to switching"),
        "{end}"
    );
    assert_eq!(
        press(&mut app, &view, "q s").len(),
        1,
        "q closes the page, s steps again"
    );
}

#[test]
fn without_a_scene_there_is_the_chooser() {
    let offer = |name: &str| Offer {
        name: name.into(),
        title: format!("what {name} shows"),
    };
    let mut app = App::new(Theme::colour(), vec![offer("01-first"), offer("02-second")]);
    app.choose();
    insta::assert_snapshot!("chooser-80x24", screen::text(&app, None, 80, 24));
    let press = |app: &mut App, key: &str| app.key(&keys::press(key).expect("a key's name"), None);
    assert_eq!(press(&mut app, "Esc"), Some(Effect::Quit));
    press(&mut app, "Down");
    assert_eq!(
        press(&mut app, "Enter"),
        Some(Effect::Open("02-second".into()))
    );
    press(&mut app, ":");
    assert!(screen::text(&app, None, 80, 24).contains(":open"));
    press(&mut app, "Esc");
    assert!(screen::text(&app, None, 80, 24).contains("Choose a scene"));
}

#[test]
fn no_size_of_the_screen_breaks_it() {
    let full = model(5);
    let none = model(0);
    let busy = frames(&full, minor());
    let empty = frames(&none, event((1, 1, 1), vec![], Outcome::Minor));
    let mut wild = records();
    for (node, number) in wild
        .iter_mut()
        .zip([f64::NAN, f64::INFINITY, -1e300, 1e-320, -0.0])
    {
        (node.gap, node.f_n, node.f_t, node.t_max, node.slip) =
            (number, number, number, number, number);
    }
    let mut wild = frames(&full, event((u32::MAX, 1, 1), wild, Outcome::Minor));
    wild[1].state.u = Arc::new(vec![f64::NAN; full.dofs.len()]);
    let mut huge = wild.clone();
    huge[1].state.u = Arc::new(vec![1e300; full.dofs.len()]);
    let views = [
        view(&full, &busy),
        view(&none, &empty),
        view(&full, &wild),
        view(&full, &huge),
    ];
    let states = [
        "",
        "e",
        "Esc z",
        "Tab z",
        "Esc Tab Tab z + Left",
        "Esc Tab z y > a",
        "Esc t",
        "Esc d Down Enter",
        "Esc v Down Enter",
        "Esc r Down Enter",
        "?",
        "Esc :",
        "Esc m",
        "Esc /",
        "Esc i",
    ];
    for view in &views {
        let mut app = app();
        for keys in states {
            press(&mut app, view, keys);
            for width in [1, 2, 3, 7, 10, 20, 33, 40, 61, 80, 110, 120, 160, 200, 250] {
                for height in [
                    1, 2, 3, 4, 5, 6, 7, 8, 10, 13, 16, 17, 20, 24, 36, 40, 47, 60, 80,
                ] {
                    render(&app, view, width, height);
                }
            }
        }
    }
}

/// A debugger on a built-in scene.
fn debugger(scene: &str) -> Debugger {
    let scene = Scene::open(scene, &[]).expect("a built-in scene");
    Debugger::new(Theme::mono(), vec![], Some(Session::new(scene)))
}

/// A screen without the digits that another order of rounding could change: those after the fifth, and all of
/// numbers that are round-off themselves.
fn masked(screen: &str) -> String {
    let mut letters: Vec<char> = screen.chars().collect();
    let mut start = 0;
    while start < letters.len() {
        let number = |c: &char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-');
        let length = letters[start..].iter().take_while(|c| number(c)).count();
        let text: String = letters[start..start + length].iter().collect();
        let exponent = text
            .rsplit_once('e')
            .and_then(|(_, e)| e.parse::<i32>().ok());
        if let (Some(exponent), Some(point)) = (exponent, text.find('.')) {
            let kept = if exponent < -9 { 0 } else { point + 5 };
            let digits = text.find('e').unwrap_or(length);
            let masked = (start..start + digits)
                .skip(kept)
                .filter(|at| letters[*at].is_ascii_digit());
            masked
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|at| letters[at] = '#');
        }
        start += length.max(1);
    }
    letters.into_iter().collect()
}

#[test]
fn the_first_scene_at_three_sizes() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    debugger.type_keys("5 f s s");
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        insta::assert_snapshot!(
            format!("first-{width}x{height}"),
            masked(&debugger.text(width, height))
        );
    }
    debugger.type_keys("e");
    insta::assert_snapshot!("first-explain-120x40", masked(&debugger.text(120, 40)));
}

#[test]
fn the_curve_grows_by_accepted_increments_and_shrinks_on_the_way_back() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    let points = |debugger: &Debugger| {
        let session = debugger.session.as_ref().expect("a session");
        session.curve(0)
    };
    assert_eq!(points(&debugger), [[0.0; 2]; 0]);
    debugger.type_keys("3 f");
    let three = points(&debugger);
    assert_eq!(three.len(), 3);
    debugger.type_keys("s");
    assert_eq!(points(&debugger), three);
    debugger.type_keys("S F");
    assert_eq!(points(&debugger), three[..2]);
    debugger.type_keys("f");
    assert_eq!(points(&debugger), three);
}

#[test]
fn stepping_back_shows_the_same_screens() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    let mut screens = vec![debugger.text(120, 40)];
    for _ in 0..6 {
        debugger.type_keys("s");
        screens.push(debugger.text(120, 40));
    }
    let panes = |screen: &str| {
        screen
            .lines()
            .skip(3)
            .take(35)
            .map(String::from)
            .collect::<Vec<_>>()
    };
    for screen in screens.iter().rev().skip(1) {
        debugger.type_keys("S");
        assert_eq!(panes(&debugger.text(120, 40)), panes(screen));
    }
    debugger.type_keys("S");
    assert!(debugger.text(120, 40).contains("this is the start"));
}

#[test]
fn a_person_ends_the_oscillation() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("c");
    let cycle = debugger.text(120, 40);
    assert!(
        cycle.contains("✗ the modes 2-cycle since minor 1: beam.5 free > fixed"),
        "{cycle}"
    );
    debugger.type_keys("m s");
    assert!(debugger.text(120, 40).contains("▸*◇beam.5 fixed → sliding"));
    debugger.type_keys("S m S c");
    let end = debugger.text(120, 40);
    assert!(
        end.contains("✓ load 1 accepted") && end.contains("◆ 1 held"),
        "{end}"
    );
    debugger.type_keys("S M");
    let released = debugger.text(120, 40);
    assert!(!released.contains("◆"), "{released}");
}

#[test]
fn another_increment_starts_the_increment_again() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("s s i 0 . 0 1 Enter");
    let again = debugger.text(120, 40);
    assert!(
        again.contains("increment 1   attempt 2   major 1   minor 1   load 0.01"),
        "{again}"
    );
    assert!(again.contains("increment 0.01 (scene: 0.05)"), "{again}");
    debugger.type_keys("i - 1 Enter");
    assert!(debugger.text(120, 40).contains("'-1' is no increment"));
}

#[test]
fn commands_by_name_reach_the_solver_and_its_refusals_the_screen() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    // Among them an alias of beam.5, a value out of range, and a file that is not there.
    for (line, shown) in [
        ("force beam.end fixed", "◇beam.5 fixed"),
        ("friction 20", "friction changed"),
        ("friction 95", "90"),
        ("step 3", "minor 3"),
        ("reverse-step 3", "2 of 5 steps"),
        ("open nowhere.ron", "nowhere.ron"),
        ("open osc-inclined-cantilever", "Inclined cantilever"),
    ] {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
        let screen = debugger.text(120, 40);
        assert!(screen.contains(shown), "after '{line}':\n{screen}");
    }
}

#[test]
fn branches_breakpoints_and_watches_are_told_in_the_message_line() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("c");
    for (keys, line, shown) in [
        (
            "b",
            "mode any sliding",
            "breakpoint 1 (any node becomes sliding)",
        ),
        (":", "watch f_n", "f_n beam.5 = -5.75"),
        ("S m s", "", "(in the new branch b2: beam.5 sliding)"),
        ("s", "", "in b2: beam.5 sliding   f_n beam.5 = 5."),
        ("[", "", "b1: start (cycle)"),
        ("]", "", "in b2: beam.5 sliding"),
        ("b", "dance", "'dance' is nothing to break at; mode, leaves"),
    ] {
        debugger.type_keys(keys);
        if !line.is_empty() {
            debugger.type_text(line);
            debugger.type_keys("Enter");
        }
        let screen = debugger.text(120, 40);
        assert!(screen.contains(shown), "after '{keys} {line}':\n{screen}");
    }
}

#[test]
fn a_long_outcome_goes_on_in_further_lines() {
    let model = model(5);
    let members = (0..5)
        .map(|slave| (slave, vec![Mode::Free, Mode::Fixed]))
        .collect();
    let cycle = Cycle {
        start: 2,
        period: 2,
        members,
    };
    let outcome = Outcome::Failed(Failure::Cycle(cycle));
    let frames = frames(&model, event((3, 2, 4), records(), outcome));
    let screen = screen::text(&app(), Some(&view(&model, &frames)), 80, 24);
    let told: String = screen.lines().skip(2).take(3).collect();
    assert!(
        told.contains("beam.1 free > fixed") && told.contains("beam.5 free"),
        "{screen}"
    );
    assert!(
        screen.contains(" Decision ") && screen.contains("? help"),
        "{screen}"
    );
}

#[test]
fn a_title_that_does_not_fit_says_so() {
    let mut model = model(5);
    model.title =
        "A beam over a floor, pressed down and pulled along: 梁 and 床 all the way".into();
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let first = |width| {
        let screen = screen::text(&app(), Some(&view), width, 24);
        screen.lines().next().unwrap_or_default().to_string()
    };
    assert_eq!(first(30), " stickslip by-hand  A beam ov…");
    assert!(first(80).ends_with(" and…"), "{}", first(80));
    assert!(first(100).ends_with("all the way"));
    assert_eq!(first(15), " stickslip by-…");
}

#[test]
fn a_long_message_is_not_cut() {
    let model = model(5);
    let frames = frames(&model, minor());
    let mut app = app();
    app.complain("one two three four five six seven eight nine ten eleven twelve thirteen fourteen\nfifteen sixteen");
    let screen = screen::text(&app, Some(&view(&model, &frames)), 80, 24);
    assert!(
        screen.contains("fifteen sixteen") && screen.contains("? help"),
        "{screen}"
    );
}

#[test]
fn a_narrow_screen_shows_the_cell_that_fired_alone() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    press(&mut app, &view, "Down e");
    let screen = screen::text(&app, Some(&view), 50, 14);
    assert!(
        screen.contains("fixed → sliding   F_n > 0, |F_t| > |T_max|"),
        "{screen}"
    );
    assert!(screen.contains("F_t is more than friction can"), "{screen}");
}
