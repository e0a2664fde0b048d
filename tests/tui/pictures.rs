//! Pictures that explain: the shape with its conditions and forces, the contact of the selected node, folded timelines, and what the
//! screen offers first.

use crate::by_hand::{app, frames, minor, model, press, type_text, view};
use std::sync::Arc;
use stickslip::model::{Load, Monitor, MonitorQuantity};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::teach::progress::Progress;
use stickslip::tui::app::App;
use stickslip::tui::chooser_state;
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, View, screen};

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

fn debugger(scene: &str, keys: &str) -> Debugger {
    let scene = Scene::open(scene, &[]).unwrap();
    let session = Session::new(scene);
    let mut debugger = Debugger::new(Theme::mono(), vec![], Some(session));
    debugger.settle();
    debugger.type_keys(keys);
    debugger.settle();
    debugger
}

#[test]
fn the_shape_shows_forces_where_they_act_loads_supports_and_magnified_displacements() {
    let mut debugger = debugger("01-pinned-beam-rough-floor", "f f Tab Tab Tab");
    let seen = debugger.text(120, 40);
    // The floor pushes the tip up and to the right; the load pushes it to the left; the other end is pinned.
    let row = |glyph: &str| seen.lines().position(|line| line.contains(glyph));
    let (head, load) = (row("↗").unwrap(), row("←").unwrap());
    assert!(head < load, "the force is drawn above the floor:\n{seen}");
    assert!(row("▲").unwrap() < head, "{seen}");
    assert!(seen.contains("displacements ×"), "{seen}");
    debugger.type_keys("*");
    assert!(
        !debugger.text(120, 40).contains("displacements ×"),
        "to scale"
    );
    debugger.type_keys("*");
    assert!(debugger.text(120, 40).contains("displacements ×10 "));
    debugger.type_keys(":");
    debugger.type_text("magnify 25");
    debugger.type_keys("Enter");
    assert!(debugger.text(120, 40).contains("displacements ×25 "));
    debugger.type_keys(":");
    debugger.type_text("magnify half");
    debugger.type_keys("Enter");
    let said = &debugger.app.message.text;
    assert!(
        said.contains("invalid factor 'half'; expected a number from 1 to 1e9"),
        "{said}"
    );
}

#[test]
fn the_contact_has_its_cone_its_cobweb_and_who_pushed_it() {
    let mut debugger = debugger("osc-two6", "s s s s s E");
    for (width, height) in SIZES {
        insta::assert_snapshot!(
            format!("contact-{width}x{height}"),
            debugger.text(width, height)
        );
    }
    let cone = "Coulomb cone";
    let narrow = |debugger: &Debugger| debugger.text(40, 24);
    assert!(narrow(&debugger).contains(cone));
    debugger.type_keys("Right");
    assert!(narrow(&debugger).contains("T_max"), "{}", narrow(&debugger));
    debugger.type_keys("Right");
    assert!(
        narrow(&debugger).contains("Who pushed it"),
        "{}",
        narrow(&debugger)
    );
    debugger.type_keys("Right");
    assert!(narrow(&debugger).contains(cone));
    // The decision in full has the contact next to it.
    debugger.type_keys("e");
    assert!(debugger.text(200, 60).contains(cone));
}

#[test]
fn who_pushed_a_node_stays_hidden_while_its_mode_is_predicted() {
    let mut debugger = debugger("osc-two6", "p s E");
    let pushes = |debugger: &Debugger| debugger.text(120, 40).contains("Who pushed it");
    assert!(!pushes(&debugger), "{}", debugger.text(120, 40));
    debugger.type_keys("a f");
    debugger.settle();
    assert!(pushes(&debugger), "{}", debugger.text(120, 40));
}

#[test]
fn equal_rows_of_the_timeline_fold() {
    let mut debugger = debugger("04-cantilever-rigid-circle", "3 s t");
    let seen = debugger.text(80, 14);
    assert!(seen.contains("node 1 of 20, folded"), "{seen}");
    let folded = seen.lines().find(|line| line.contains(" … ")).unwrap();
    assert!(folded.contains("beam."), "{seen}");
    // A high screen has a row for every node.
    let high = debugger.text(80, 60);
    assert!(!high.contains(" … ") && high.contains("beam.20"), "{high}");
    debugger.type_keys("Down");
    assert_eq!(debugger.app.selected, 1);
}

fn names(app: &App, view: &View) -> Vec<usize> {
    app.order(view).into_iter().map(|slave| slave + 1).collect()
}

#[test]
fn nodes_sort_by_change_ratio_and_force_and_filter_by_mode() {
    let model = model(5);
    let frames = frames(&model, minor());
    let view = view(&model, &frames);
    let mut app = app();
    let mut order = |line: &str| {
        press(&mut app, &view, ":");
        type_text(&mut app, &view, line);
        press(&mut app, &view, "Enter");
        names(&app, &view)
    };
    let changed = order("sort change");
    let changes = |slave: usize| view.mode_before(slave - 1) != view.mode(slave - 1);
    let count = (1..=5).filter(|slave| changes(*slave)).count();
    assert!(
        count > 0 && changed[..count].iter().all(|slave| changes(*slave)),
        "{changed:?}"
    );
    assert_eq!(order("sort force")[..3], [2, 1, 3]);
    assert_eq!(order("sort ratio")[..3], [3, 2, 1]);
    let of = |mode: &str, seen: Vec<usize>| {
        let wanted = |slave: &usize| format!("{:?}", view.mode(slave - 1)).to_lowercase() == mode;
        // The selected node, 1, is always included.
        seen.iter().all(|slave| wanted(slave) || *slave == 1)
    };
    for mode in ["free", "sliding", "fixed"] {
        let seen = order(&format!("filter {mode}"));
        assert!(of(mode, seen.clone()), "{mode}: {seen:?}");
    }
    let seen = order("filter changing");
    assert!(
        seen.iter().all(|slave| changes(*slave) || *slave == 1),
        "{seen:?}"
    );
}

#[test]
fn the_curve_chooses_a_monitor_that_moves() {
    let mut model = model(5);
    for (name, dof) in [("round-off", 12), ("tip", 13)] {
        let of = MonitorQuantity::Displacement { dof };
        model.monitors.push(Monitor {
            name: name.into(),
            of,
        });
    }
    let mut frames = frames(&model, minor());
    for k in 1..=3 {
        let mut done = frames[1].clone();
        done.monitors = Some(Arc::new(vec![-5e-15, 0.1 * f64::from(k)]));
        frames.push(done);
    }
    let mut view = view(&model, &frames);
    view.cursor = 4;
    let mut app = app();
    press(&mut app, &view, "Tab Tab Tab Tab");
    let seen = screen::text(&app, Some(&view), 80, 24);
    assert!(seen.contains(" Load over tip  2/2 "), "{seen}");
    press(&mut app, &view, "y");
    let seen = screen::text(&app, Some(&view), 80, 24);
    assert!(seen.contains(" Load over round-off  1/2 "), "{seen}");
}

#[test]
fn the_header_has_the_file_s_name_and_the_footer_follows_the_pane() {
    let model = model(5);
    let frames = frames(&model, minor());
    let mut view = view(&model, &frames);
    view.name = "/a/long/path/to/wheel.ron";
    let mut app = app();
    let seen = |app: &App| screen::text(app, Some(&view), 120, 40);
    let first = seen(&app);
    assert!(first.starts_with(" stickslip wheel.ron"), "{first}");
    let footer = |app: &App| seen(app).lines().last().unwrap().to_owned();
    assert!(!footer(&app).contains("magnify"));
    press(&mut app, &view, "Tab Tab Tab");
    assert!(footer(&app).contains("* magnify"), "{}", footer(&app));
    // Digits are a prefix of motions only.
    press(&mut app, &view, "3");
    assert!(footer(&app).contains("s step") && !footer(&app).contains("e explain"));
}

#[test]
fn a_lesson_is_a_column_on_the_right_and_covers_no_picture() {
    let offers = chooser_state::offers(&Progress::default());
    let mut debugger = Debugger::new(Theme::mono(), offers, None);
    debugger.settle();
    debugger.type_keys("Enter");
    debugger.settle();
    let seen = debugger.text(120, 40);
    let titles = seen.lines().find(|line| line.contains(" Lesson ")).unwrap();
    assert!(titles.contains(" Slave nodes "), "side by side:\n{seen}");
    assert!(
        seen.contains(" Shape ") && seen.contains(" Decision "),
        "{seen}"
    );
}

#[test]
fn conditions_of_a_scene_by_hand() {
    let mut model = model(2);
    let node = model.contacts[1].node;
    let dof = model.dofs.first[node];
    model.loads.push(Load {
        dof,
        value: -2.0,
        scale: Default::default(),
        volume: None,
    });
    let found =
        stickslip::explain::conditions::conditions(&model, 0.5, &|node| model.nodes[node].at);
    assert_eq!(found.arrows.len(), 1);
    assert_eq!(
        (found.arrows[0].at, found.arrows[0].along),
        (model.nodes[node].at, [-1.0, 0.0])
    );
    // A load comes from the side to which an opposite force goes.
    assert!(found.arrows[0].is_under([3.0, 0.1]));
    assert!(!found.arrows[0].is_under([-3.0, 0.1]) && !found.arrows[0].is_under([1.0, 1.0]));
}

#[test]
fn a_load_is_drawn_next_to_the_contact_force_that_would_cover_it() {
    let debugger = debugger("osc-inclined-cantilever", "c Tab Tab Tab z");
    let seen = debugger.text(120, 40);
    let rows: Vec<&str> = seen.lines().collect();
    let row = |sign: &str| rows.iter().position(|row| row.contains(sign)).unwrap();
    assert!(row("←") < row("→"), "{seen}");
    // The letter is the mode in which the force was found.
    assert!(seen.contains("x!"), "{seen}");
}

#[test]
fn at_the_start_a_small_screen_shows_the_shape_instead_of_a_decision() {
    let mut debugger = debugger("01-pinned-beam-rough-floor", "");
    let seen = debugger.text(80, 24);
    assert!(
        seen.contains(" Shape ") && !seen.contains(" Decision "),
        "{seen}"
    );
    debugger.type_keys("s");
    debugger.settle();
    let seen = debugger.text(80, 24);
    assert!(
        seen.contains(" Decision ") && !seen.contains(" Shape "),
        "{seen}"
    );
}

#[test]
fn an_empty_answer_is_reported_and_a_monitor_shows_its_curve() {
    let mut debugger = debugger("01-pinned-beam-rough-floor", ":lesson by-hand@2 Enter");
    debugger.type_keys("a Enter");
    debugger.settle();
    let seen = debugger.text(120, 40);
    assert!(
        seen.contains("no answer was typed; press a to answer"),
        "{seen}"
    );
    let mut debugger = self::debugger("01-pinned-beam-rough-floor", "2 f");
    assert!(!debugger.text(120, 40).contains("Load over"));
    debugger.type_keys("y");
    let seen = debugger.text(120, 40);
    assert!(seen.contains("Load over"), "{seen}");
}

#[test]
fn a_long_message_leaves_the_task_of_a_lesson_visible() {
    let mut debugger = debugger("01-pinned-beam-rough-floor", ":lesson attached@11 Enter");
    debugger.type_keys(":branch b2 Enter");
    debugger.settle();
    let seen = debugger.text(80, 24);
    assert!(seen.contains("b2: 3 held sliding (valid,"), "{seen}");
    assert!(seen.contains("▶ answer: a, then the number"), "{seen}");
}
