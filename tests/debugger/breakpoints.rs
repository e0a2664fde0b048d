//! Breakpoints and watches: a run stops where it should, forward and backward, and says why.

use stickslip::action::{Action, Context, parse};
use stickslip::history::strip::PointKind;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Outcome;

const FLOOR: &str = "01-pinned-beam-rough-floor";
const OSCILLATES: &str = "osc-inclined-cantilever";
const DISTANT: &str = "03-distant-cantilevers";

fn session(scene: &str) -> Session {
    Session::new(Scene::open(scene, &[]).expect("a built-in scene"))
}

/// Carries out a line as it is typed at the colon; what is said last.
fn type_line(session: &mut Session, line: &str) -> Result<String, String> {
    let context = Context {
        model: Some(session.model()),
        ..Context::default()
    };
    let Action::Session(command) = parse(line, &context).map_err(|e| e.to_string())? else {
        panic!("{line} is not for the session");
    };
    let reply = session.submit(command).map_err(|e| e.to_string())?;
    Ok(session.wait().unwrap_or(reply).0)
}

#[track_caller]
fn say(session: &mut Session, line: &str) -> String {
    type_line(session, line).unwrap_or_else(|e| panic!("{line}: {e}"))
}

/// Steps of the whole line at which a node is to be solved in another mode than it was.
fn changes(session: &Session, wanted: impl Fn(usize, Mode, Mode) -> bool) -> Vec<usize> {
    let holds = |at: &usize| {
        let frame = &session.frames()[*at];
        let event = frame
            .event
            .as_ref()
            .filter(|_| frame.intervention.is_none());
        event.is_some_and(|event| {
            let modes = event.nodes.iter().zip(&frame.state.nodes).enumerate();
            modes
                .map(|(s, (found, node))| (s, found.decision.before, node.mode))
                .any(|(s, before, next)| before != next && wanted(s, before, next))
        })
    };
    (0..session.frames().len()).filter(holds).collect()
}

/// All steps at which `continue` stops, from the start to the end of the history.
fn stops(session: &mut Session) -> Vec<usize> {
    let mut found = Vec::new();
    loop {
        let told = say(session, "continue");
        if !told.starts_with("breakpoint") {
            return found;
        }
        found.push(session.cursor());
    }
}

/// The same backward, from the end to the start.
fn stops_back(session: &mut Session) -> Vec<usize> {
    let mut found = Vec::new();
    while session.cursor() > 0 {
        let told = say(session, "reverse-continue");
        if told.starts_with("breakpoint") {
            found.push(session.cursor());
        }
    }
    found.reverse();
    found
}

#[test]
fn a_run_stops_at_every_change_of_mode_forward_backward_and_over_known_steps() {
    for (line, from, to) in [
        ("break mode", None, None),
        ("break mode beam.5 fixed", None, Some(Mode::Fixed)),
        ("break leaves any sliding", Some(Mode::Sliding), None),
    ] {
        let mut session = session(FLOOR);
        say(&mut session, line);
        let forward = stops(&mut session);
        let wanted = changes(&session, |_, before, next| {
            from.is_none_or(|mode| mode == before) && to.is_none_or(|mode| mode == next)
        });
        assert!(!forward.is_empty());
        assert_eq!(forward, wanted, "{line}");
        assert_eq!(stops_back(&mut session), wanted, "{line} backward");
        assert_eq!(stops(&mut session), wanted, "{line} over known steps");
    }
}

#[test]
fn back_to_the_last_time_a_node_left_sliding() {
    let mut session = session(FLOOR);
    say(&mut session, "continue");
    let last = *changes(&session, |_, before, _| before == Mode::Sliding)
        .last()
        .expect("it sticks before it slides back");
    say(&mut session, "break leaves beam.5 sliding");
    let told = say(&mut session, "reverse-continue");
    assert!(
        told.starts_with("breakpoint 1 (beam.5 leaves sliding): increment"),
        "{told}"
    );
    assert_eq!(session.cursor(), last);
}

#[test]
fn one_node_of_several_is_told_from_the_others() {
    let mut session = session(DISTANT);
    say(&mut session, "continue");
    let model = session.model().clone();
    let all = changes(&session, |_, _, _| true);
    // The node that changes last, and not at every change.
    let mut own = Vec::new();
    let mut chosen = 0;
    for slave in 0..model.contacts.len() {
        let steps = changes(&session, |s, _, _| s == slave);
        if !steps.is_empty() && steps.len() < all.len() {
            (own, chosen) = (steps, slave);
        }
    }
    assert!(!own.is_empty(), "no node to tell from the others");
    let name = &model.nodes[model.contacts[chosen].node].name;
    say(&mut session, &format!("break mode {name}"));
    assert_eq!(stops_back(&mut session), own);
}

#[test]
fn cycles_failures_and_places_stop_a_run() {
    let mut session = session(OSCILLATES);
    say(&mut session, "break cycle");
    say(&mut session, "break failure");
    let told = say(&mut session, "continue");
    let both = "breakpoints 1 (a cycle closes), 2 (an increment fails): increment 1";
    assert!(told.starts_with(both), "{told}");
    say(&mut session, "force beam.5 sliding");
    say(&mut session, "break at 3.2");
    let told = say(&mut session, "continue");
    assert!(
        told.starts_with("breakpoint 3 (at 3.2.1): increment 3, major 2, minor 1"),
        "{told}"
    );
    // Motions by other units stop there, too, but not twice.
    say(&mut session, "reverse-finish");
    let told = say(&mut session, "finish");
    assert!(told.starts_with("breakpoint 3"), "{told}");
    assert!(say(&mut session, "finish").contains("load 0.15"));
    let kind = |session: &Session| session.timeline().strips()[session.cursor()].kind;
    assert_eq!(kind(&session), PointKind::Increment);
    say(&mut session, "reverse-continue");
    assert_eq!(
        session.frame().event.as_ref().map(|e| e.position.increment),
        Some(3)
    );
    say(&mut session, "reverse-continue");
    assert_eq!(kind(&session), PointKind::Cycle);
}

#[test]
fn margins_residuals_and_elements_stop_where_the_events_say() {
    let mut session = session(FLOOR);
    say(&mut session, "break margin beam.5 0.001");
    let forward = stops(&mut session);
    let below = |at: usize| {
        let event = session.frames()[at].event.as_ref().expect("solved");
        event.nodes[0].decision.margin() < 0.001
    };
    let wanted: Vec<usize> = (1..session.frames().len())
        .filter(|&at| below(at) && (at == 1 || !below(at - 1)))
        .collect();
    assert!(forward.len() > 2);
    assert_eq!(forward, wanted);

    let found = ["02-two-cantilevers-smooth", DISTANT].map(rises_and_moves);
    let (rises, moves) = (found[0].0 + found[1].0, found[0].1 + found[1].1);
    assert!(rises > 0 && moves > 0, "{rises} rises, {moves} moves");
}

/// How often the residual rises and a node changes element over a scene; the breakpoints say so at the same steps.
fn rises_and_moves(scene: &str) -> (u32, u32) {
    let mut session = session(scene);
    say(&mut session, "continue");
    say(&mut session, "break residual");
    say(&mut session, "break element");
    let (mut rises, mut moves) = (0, 0);
    let elements = |at: usize| -> Vec<_> {
        let nodes = session.frames()[at].state.nodes.iter();
        nodes
            .map(|node| node.spot.map(|spot| (spot.surface, spot.element)))
            .collect()
    };
    for at in 1..session.frames().len() {
        let event = session.frames()[at].event.as_ref().expect("solved");
        let rose = match &event.outcome {
            Outcome::Major { after, .. } | Outcome::Increment { after, .. } => {
                after.relative > event.before.relative
            }
            _ => false,
        };
        let moved = elements(at - 1) != elements(at);
        let strips = session.timeline().strips();
        let hits = session.breakpoints().hits(&strips[at - 1], &strips[at]);
        assert_eq!(
            (hits.contains(&1), hits.contains(&2)),
            (rose, moved),
            "{scene}, step {at}"
        );
        (rises, moves) = (rises + u32::from(rose), moves + u32::from(moved));
    }
    (rises, moves)
}

#[test]
fn breakpoints_are_listed_disabled_enabled_and_deleted() {
    let mut session = session(FLOOR);
    assert_eq!(
        say(&mut session, "breakpoints"),
        "there are no breakpoints; :break sets one"
    );
    say(&mut session, "break at 2");
    say(&mut session, "break at 3");
    let all = "breakpoints 1 (at 2.1.1), 2 (at 3.1.1)";
    assert_eq!(say(&mut session, "breakpoints"), all);
    let off = "breakpoints 1 (at 2.1.1, disabled), 2 (at 3.1.1)";
    assert_eq!(say(&mut session, "disable 1"), off);
    assert!(say(&mut session, "continue").starts_with("breakpoint 2"));
    say(&mut session, "goto 0");
    assert_eq!(say(&mut session, "enable all"), all);
    assert!(say(&mut session, "continue").starts_with("breakpoint 1"));
    let missing = type_line(&mut session, "delete 7").expect_err("there is none");
    assert_eq!(missing, format!("there is no breakpoint 7; {all}"));
    assert_eq!(say(&mut session, "delete 1"), "breakpoints 2 (at 3.1.1)");
    say(&mut session, "break cycle");
    assert_eq!(session.breakpoints().all()[1].id, 3);
    say(&mut session, "delete all");
    assert!(say(&mut session, "continue").contains("the history is complete"));
}

#[test]
fn watches_show_the_numbers_of_the_iteration_that_is_looked_at() {
    let mut session = session(FLOOR);
    assert_eq!(
        say(&mut session, "watch f_n"),
        "watching f_n beam.5",
        "its number stands beside, once"
    );
    say(&mut session, "watch residual");
    say(&mut session, "watch margin beam.5 as to go");
    assert_eq!(
        session.watches().values(session.frame()),
        [("f_n beam.5", None), ("residual", None), ("to go", None)]
    );
    for motion in ["step 3", "finish", "reverse-step"] {
        say(&mut session, motion);
        let event = session.frame().event.as_ref().expect("solved");
        let found = event.nodes[0];
        assert_eq!(
            session.watches().values(session.frame()),
            [
                ("f_n beam.5", Some(found.f_n)),
                ("residual", Some(event.before.relative)),
                ("to go", Some(found.decision.margin())),
            ]
        );
    }
    let twice = type_line(&mut session, "watch f_n beam.5").expect_err("there is one");
    assert!(twice.contains("'f_n beam.5' already"), "{twice}");
    let none = type_line(&mut session, "unwatch gap").expect_err("there is none");
    assert!(
        none.contains("watches: f_n beam.5, residual, to go"),
        "{none}"
    );
    say(&mut session, "unwatch to go");
    assert_eq!(session.watches().values(session.frame()).len(), 2);
}
