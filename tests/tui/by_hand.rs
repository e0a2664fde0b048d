//! Frames made by hand, so that every mark, tie and failure can be put on the screen at will, and keys pressed on them.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use std::sync::Arc;
use stickslip::contact::record::{ContactRecord, Forced};
use stickslip::contact::table2::{Entry, Numbers, Ties, decide};
use stickslip::history::frame::Frame;
use stickslip::linear::norms::Norms;
use stickslip::model::{Beam, Body, BodyKind, Contact, Dofs, Node, Surface};
use stickslip::model::{Friction, Mode, Model};
use stickslip::step::event::Position;
use stickslip::step::event::{Event, Outcome};
use stickslip::step::state::State;
use stickslip::tui::app::{App, Effect};
use stickslip::tui::theme::Theme;
use stickslip::tui::{View, keys, screen};

/// A beam of five nodes over a floor; all of its nodes are slaves, or as many as asked for.
pub fn model(slaves: usize) -> Model {
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
        increment: 0.1,
        budget: 1e9,
        dofs: Dofs {
            first: (0..nodes.len()).map(|node| 3 * node).collect(),
            count: vec![3; nodes.len()],
            equation: (0..3 * nodes.len()).map(Some).collect(),
            equations: 0,
            inner: 0,
        },
        length: 4.0,
        ..Model::from_contacts(
            "A beam over a floor",
            nodes,
            vec![Surface::new(
                "floor",
                vec![vec![count + 2, count + 1], vec![count + 1, count]],
                true,
            )],
            (0..slaves)
                .map(|node| {
                    Contact::new(
                        node,
                        vec![0],
                        Friction {
                            angle: 20.0,
                            cohesion: 0.0,
                        },
                    )
                })
                .collect(),
        )
    }
}

/// What the table would say of these numbers.
pub fn record(mode: Mode, gap: f64, f_n: f64, f_t: f64, t_max: f64, slip: f64) -> ContactRecord {
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
        directions: None,
        corner: None,
        carried: [false; 2],
    }
}

/// One node of every kind that a screen should be able to show.
pub fn records() -> Vec<ContactRecord> {
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

pub fn event(position: (u32, u32, u32), nodes: Vec<ContactRecord>, outcome: Outcome) -> Event {
    let (increment, major, minor) = position;
    Event {
        frames: Arc::default(),
        position: Position {
            increment,
            attempt: 1,
            major,
            minor,
        },
        load_factor: increment as f64 / 10.0,
        arc: None,
        drag: 0.0,
        nodes,
        before: Norms::default(),
        words: Arc::default(),
        outcome,
    }
}

pub fn minor() -> Event {
    event((3, 2, 4), records(), Outcome::Minor)
}

/// The start, and one frame after this event, in which the beam is bent.
pub fn frames(model: &Model, event: Event) -> Vec<Frame> {
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

pub fn residuals() -> Vec<(u32, Norms)> {
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

pub fn view<'a>(model: &'a Model, frames: &'a [Frame]) -> View<'a> {
    View {
        name: "by-hand",
        scene: None,
        model,
        frames,
        strips: &[],
        tree: None,
        background: None,
        start_gaps: "",
        attached: None,
        cursor: frames.len() - 1,
        running: false,
        residuals: residuals(),
        aside: String::new(),
    }
}

pub fn app() -> App {
    App::new(Theme::colour(), vec![])
}

/// Presses keys by their names, parted by blanks, and returns the effects.
pub fn press(app: &mut App, view: &View, names: &str) -> Vec<Effect> {
    let keys = names
        .split_whitespace()
        .map(|name| keys::press(name).expect("a key's name"));
    keys.filter_map(|key| app.key(&key, Some(view))).collect()
}

pub fn type_text(app: &mut App, view: &View, text: &str) {
    for letter in text.chars() {
        let name = if letter == ' ' {
            "Space".into()
        } else {
            letter.to_string()
        };
        press(app, view, &name);
    }
}

pub fn render(app: &App, view: &View, width: u16, height: u16) -> Buffer {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    screen::draw(&mut buffer, area, app, Some(view));
    buffer
}

/// The first cell from which on a text stands on the screen.
pub fn find<'a>(buffer: &'a Buffer, text: &str) -> &'a Cell {
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
