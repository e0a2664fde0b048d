//! Whole screens: what stands on them at which size, and what becomes of what does not fit.
//!
//! Snapshots hold the symbols; where a style carries meaning, a test asserts it on the cell.

use crate::by_hand::{app, event, frames, minor, model, press, records, render, view};
use std::sync::Arc;
use stickslip::interface::minor_history::Cycle;
use stickslip::model::Mode;
use stickslip::model::{Monitor, MonitorQuantity};
use stickslip::step::event::{Failure, Outcome};
use stickslip::tui::screen;

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
    for _ in 0..10 {
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
        " Contact ",
    ];
    for (screen, title) in seen.iter().zip(titles) {
        assert!(
            screen.contains(title) && screen.contains(" Slave nodes "),
            "{screen}"
        );
    }
    assert!(seen[3].contains("Tab page 4/10"));
    assert_eq!(
        screen::text(&app, Some(&view), 80, 24)
            .matches(" Contact ")
            .count(),
        1,
        "the page stays when the table has the focus"
    );
    insta::assert_snapshot!("by-hand-residual-80x24", seen[2]);
    insta::assert_snapshot!("by-hand-shape-80x24", seen[3]);
}

#[test]
fn the_load_is_drawn_over_a_monitor() {
    let mut model = model(5);
    for (name, dof) in [("tip y", 13), ("tip x", 12)] {
        model.monitors.push(Monitor {
            name: name.into(),
            of: MonitorQuantity::Displacement { dof },
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
    assert!(back.contains("● -0.09  at load 0.3"), "{back}");
    assert!(back.contains("-0.64 "), "the scale stays");
    press(&mut app, &view, "y");
    assert!(screen::text(&app, Some(&view), 80, 24).contains(" Load over tip x  2/2 "));
    press(&mut app, &view, "Shift-Tab");
    let medium = screen::text(&app, Some(&view), 120, 40);
    assert!(medium.contains(" Load over ") && !medium.contains(" Residual "));
    view.cursor = 0;
    assert!(screen::text(&app, Some(&view), 200, 60).contains("No increment accepted yet."));
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
        told.contains("beam.1 free → fixed") && told.contains("beam.5 free"),
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
    assert!(screen.contains("F_t exceeds the friction"), "{screen}");
}
