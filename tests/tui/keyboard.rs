//! Keys, the command line and the help: what is pressed or typed becomes commands.

use crate::by_hand::{app, find, frames, minor, model, press, render, type_text, view};
use ratatui::style::Color;
use stickslip::contact::record::Forced;
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::tui::app::Effect;
use stickslip::tui::{View, screen};

#[test]
fn keys_become_commands() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let forward = |unit, count| Effect::Submit(Command::Forward { unit, count });
    let back = |unit, count| Effect::Submit(Command::Back { unit, count });
    let force = |slave, mode, hold| Effect::Submit(Command::Force { slave, mode, hold });
    let ask = |keys: &str| press(&mut app(), &view, keys);
    let units = [Unit::Minor, Unit::Major, Unit::Increment, Unit::Run];
    assert_eq!(ask("s n f c"), units.map(|unit| forward(unit, 1)));
    assert_eq!(ask("S N F C"), units.map(|unit| back(unit, 1)));
    let by_function_keys = [Unit::Minor, Unit::Major, Unit::Run];
    assert_eq!(
        ask("F11 F10 F5"),
        by_function_keys.map(|unit| forward(unit, 1))
    );
    assert_eq!(
        ask("1 0 s Enter"),
        [forward(Unit::Minor, 10), forward(Unit::Minor, 10)]
    );
    assert_eq!(ask("4 Esc s"), [forward(Unit::Minor, 1)]);
    assert_eq!(
        ask("m x Down m S M"),
        [force(0, Mode::Fixed, false), force(1, Mode::Sliding, true)],
        "nothing is forced in these frames"
    );
    let mut forced = frames.clone();
    let shown = forced.last_mut().unwrap();
    shown.state.nodes[1].forced = Forced::Held(Mode::Sliding);
    assert_eq!(
        press(&mut app(), &crate::by_hand::view(&model, &forced), "Down M"),
        [Effect::Submit(Command::Release { slave: 1 })]
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
    assert_eq!(find(&screen, "unknown action 'jump'").fg, Color::Red);
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
        top.contains("The first ten keys")
            && top.contains("slave nodes, decision, residual")
            && end.contains("closer to switching"),
        "{end}"
    );
    assert_eq!(
        press(&mut app, &view, "q s").len(),
        1,
        "q closes the page, s steps again"
    );
}
