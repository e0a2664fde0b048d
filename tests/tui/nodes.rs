//! The table of slave nodes and the decision of the selected one: marks, ties, order, and what happened in words.

use crate::by_hand::{
    app, event, find, frames, minor, model, press, record, records, render, type_text, view,
};
use ratatui::style::{Color, Modifier};
use stickslip::contact::record::{ContactRecord, Forced};
use stickslip::contact::table2::{Decision, Rule};
use stickslip::interface::minor_history::Cycle;
use stickslip::linear::norms::Norms;
use stickslip::model::Mode;
use stickslip::step::event::{Failure, Outcome};
use stickslip::tui::app::App;
use stickslip::tui::theme::Theme;
use stickslip::tui::{View, screen};

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
    assert_eq!(lit.fg, Color::Indexed(172), "the colour of sliding");
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
        find(&screen, "beam.2 fixed → sliding ")
            .modifier
            .contains(Modifier::REVERSED),
        "the selected row"
    );
    assert!(
        find(&screen, "fixed → sliding ")
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
    assert!(screen.contains("|F_t| 0.5 = |T_max| 0.5"), "{screen}");
    assert!(
        screen.contains("tie, margin 0 force") && screen.contains("keeps the"),
        "{screen}"
    );
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
        screen.contains("You hold it free; Table 2 (◁) decides fixed."),
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
        " ▸ beam.2 fixed → sliding, beam.4 free → fixed"
    );
    assert_eq!(
        say(Outcome::Major {
            after,
            settled: true
        }),
        " ▸ minor iterations settled; residual 2e-5, limit 1e-11"
    );
    let done = |loops| {
        let mut done = Outcome::accepted(after, false);
        if let Outcome::Increment { unsettled, .. } = &mut done {
            *unsettled = loops;
        }
        done
    };
    assert_eq!(say(done(0)), " ✓ load 0.3 accepted");
    assert_eq!(
        say(done(1)),
        " ✓ load 0.3 accepted, but 1 loop of minor iterations did not settle"
    );
    let cycle = Cycle {
        start: 2,
        period: 2,
        members: vec![(4, vec![Mode::Free, Mode::Fixed])],
    };
    assert_eq!(
        say(Outcome::Failed(Failure::Cycle(cycle))),
        " ✗ cycle of period 2 from minor 2: beam.5 free → fixed → …"
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
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "sort scene");
    press(&mut app, &view, "Enter A");
    assert_eq!(listed(&app, &view), ["1", "2", "3", "4"]);
    assert!(screen::text(&app, Some(&view), 80, 24).contains(" 2/4 active, of 5 "));
    press(&mut app, &view, "A");
    assert_eq!(listed(&app, &view), ["1", "2", "3", "4"], "one surface");
    for (filter, nodes) in [
        ("all", &["1", "2", "3", "4", "5"][..]),
        ("surface", &["1", "2", "3", "4"]),
    ] {
        press(&mut app, &view, ":");
        type_text(&mut app, &view, &format!("filter {filter}"));
        press(&mut app, &view, "Enter");
        assert_eq!(listed(&app, &view), nodes, "{filter}");
    }
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "filter all");
    press(&mut app, &view, "Enter End A A");
    assert_eq!(listed(&app, &view), ["5"], "the other surface");
    press(&mut app, &view, ":");
    type_text(&mut app, &view, "filter all");
    press(&mut app, &view, "Enter :");
    type_text(&mut app, &view, "sort lucky");
    press(&mut app, &view, "Enter");
    assert!(
        app.message
            .text
            .contains("expected one of: scene, margin, gap")
    );
    // What has no margin and no gap is last either way.
    frames[1].event = None;
    let view = self::view(&model, &frames);
    for keys in [">", "<", ">"] {
        press(&mut app, &view, keys);
        assert_eq!(listed(&app, &view), ["1", "2", "3", "4", "5"]);
    }
}

#[test]
fn names_of_wide_letters_keep_the_columns() {
    // Both names take six columns.
    let screens = ["beam.1", "梁の一"].map(|name| {
        let mut model = model(5);
        model.nodes[0].name = name.into();
        let frames = frames(&model, minor());
        let view = view(&model, &frames);
        let mut app = app();
        [(80, 24), (120, 40), (200, 60)].map(|(width, height)| {
            press(&mut app, &view, "Tab");
            screen::text(&app, Some(&view), width, height)
        })
    });
    let place = |screen: &str, text: &str| {
        let row = screen.lines().find(|row| row.contains(text));
        let row = row.unwrap_or_else(|| panic!("{text}:\n{screen}"));
        // The picture has a character for every column.
        row.chars().count() - row.split_once(text).unwrap().1.chars().count()
    };
    for (narrow, wide) in screens[0].iter().zip(&screens[1]) {
        for number in ["0.123", "0.04 ", "0.0449"] {
            assert_eq!(place(narrow, number), place(wide, number), "{wide}");
        }
    }
    // Names that are too wide are cut at their columns, not at their letters; these have 26.
    let places = ["abcdefghijklmnopqrstuvwxyz", "接触する面の長い名前の節点"].map(|name| {
        let mut model = model(5);
        model.nodes[0].name = name.into();
        let frames = frames(&model, minor());
        let screen = screen::text(&app(), Some(&view(&model, &frames)), 80, 24);
        assert!(screen.contains('…'), "{screen}");
        place(&screen, "0.123")
    });
    assert_eq!(places[0], places[1]);
}
