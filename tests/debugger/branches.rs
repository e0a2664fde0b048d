//! What-if branches: nothing done is lost by going back, and how branches end is judged.

use stickslip::history::frame::Frame;
use stickslip::history::frame::curve;
use stickslip::history::strip::PointKind;
use stickslip::history::tree::Budget;
use stickslip::history::verdicts::BranchEnd;
use stickslip::history::verdicts::summaries;
use stickslip::model::Mode;
use stickslip::record::command::{BranchTarget, Command, Unit};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::state::State;

const FLOOR: &str = "01-pinned-beam-rough-floor";
const OSCILLATES: &str = "osc-inclined-cantilever";

fn session(scene: &str) -> Session {
    Session::new(Scene::open(scene, &[]).expect("a built-in scene"))
}

/// Carries a command out to its end and returns what is said last.
#[track_caller]
fn submit(session: &mut Session, command: Command) -> String {
    let reply = session.submit(command).unwrap_or_else(|e| panic!("{e}"));
    session.wait().unwrap_or(reply).0
}

fn forward(session: &mut Session, unit: Unit, count: u32) -> String {
    submit(session, Command::Forward { unit, count })
}

fn back(session: &mut Session, unit: Unit, count: u32) -> String {
    submit(session, Command::Back { unit, count })
}

fn force(session: &mut Session, mode: Mode) -> String {
    let hold = false;
    submit(
        session,
        Command::Force {
            slave: 0,
            mode,
            hold,
        },
    )
}

fn branch(session: &mut Session, name: &str) -> String {
    submit(session, Command::Branch(BranchTarget::Named(name.into())))
}

fn set(session: &mut Session, path: &str, value: &str) -> String {
    let (path, value) = (path.into(), value.into());
    submit(session, Command::Set { path, value })
}

fn verdicts(session: &Session) -> Vec<BranchEnd> {
    summaries(session.timeline().tree())
        .into_iter()
        .map(|b| b.verdict)
        .collect()
}

fn names(session: &Session) -> Vec<String> {
    summaries(session.timeline().tree())
        .into_iter()
        .map(|b| b.name)
        .collect()
}

fn states(session: &Session) -> Vec<State> {
    session
        .frames()
        .iter()
        .map(|frame: &Frame| frame.state.clone())
        .collect()
}

#[test]
fn an_intervention_in_the_past_starts_a_branch_and_the_old_future_stays() {
    let mut session = session(FLOOR);
    forward(&mut session, Unit::Increment, 5);
    let old = states(&session);
    back(&mut session, Unit::Increment, 2);
    let fork = session.cursor();
    let told = force(&mut session, Mode::Fixed);
    assert!(told.contains("new branch b2: beam.5 fixed"), "{told}");
    assert_eq!(session.frames().len(), fork + 2);
    forward(&mut session, Unit::Minor, 3);
    let new = states(&session);
    assert_eq!(new[..=fork], old[..=fork]);

    branch(&mut session, "b1");
    assert_eq!(states(&session), old);
    assert_eq!(session.cursor(), old.len() - 1);
    branch(&mut session, "beam.5 f");
    assert_eq!(states(&session), new);
    // An increment goes on from the tip of either.
    forward(&mut session, Unit::Minor, 1);
    assert_eq!(states(&session)[..new.len()], new);
}

#[test]
fn an_intervention_at_the_tip_goes_on_in_the_same_branch() {
    let mut session = session(OSCILLATES);
    forward(&mut session, Unit::Run, 1);
    force(&mut session, Mode::Sliding);
    forward(&mut session, Unit::Run, 1);
    assert_eq!(names(&session), ["b1: start"]);
    assert_eq!(
        session.timeline().strips().last().map(|s| s.kind),
        Some(PointKind::Last)
    );
}

/// Two nodes with a friction of their own, and one with the scene's.
const FRICTIONS: &str = "(title: \"t\", nodes: [Node(id: \"a\", at: (0, 0)), Node(id: \"b\", at: (1, 0)), Node(id: \"c\", at: (2, 0)),
        Line(id: \"floor\", from: (5, 0), to: (-1, 0), elements: 2, per_element: 2)],
    materials: [],
    bodies: [Springs(id: \"k\", bars: [(nodes: [\"a\"], angle: 0, stiffness: 10), (nodes: [\"a\"], angle: 90, stiffness: 4),
        (nodes: [\"b\"], angle: 0, stiffness: 10), (nodes: [\"b\"], angle: 90, stiffness: 4),
        (nodes: [\"c\"], angle: 0, stiffness: 10), (nodes: [\"c\"], angle: 90, stiffness: 4)])],
    surfaces: [(id: \"floor\", along: \"floor\")],
    slaves: [(nodes: [\"a\", \"b\"], on: [\"floor\"], friction: (angle: 20, cohesion: 0.05)), (nodes: [\"c\"], on: [\"floor\"])],
    friction: (angle: 30, cohesion: 0.5),
    loads: [Force(node: \"a\", y: -1), Force(node: \"b\", y: -1), Force(node: \"c\", y: -1)],
    history: (path: [0, 1], increment: 0.5))";

#[test]
fn a_change_of_one_field_of_the_friction_leaves_the_others_of_each_node() {
    let mut session = Session::new(Scene::from_text("t.ron", FRICTIONS, &[]).unwrap());
    let frictions = |session: &Session| -> Vec<(f64, f64)> {
        let all = &session.frame().state.controls.friction;
        all.iter().map(|one| (one.angle, one.cohesion)).collect()
    };
    let reply = set(&mut session, "friction.cohesion", "0.2");
    assert_eq!(reply, "friction.cohesion changed from 0.5 and 0.05 to 0.2");
    let alike = [(20.0, 0.2), (20.0, 0.2), (30.0, 0.2)];
    assert_eq!(frictions(&session), alike);
    let mut session = Session::new(Scene::from_text("t.ron", FRICTIONS, &[]).unwrap());
    let reply = set(&mut session, "friction.angle", "5");
    assert_eq!(reply, "friction.angle changed from 30 and 20 to 5");
    let alike = [(5.0, 0.05), (5.0, 0.05), (5.0, 0.5)];
    assert_eq!(frictions(&session), alike);
}

#[test]
fn branches_of_branches_keep_their_lines_and_motions_stay_on_the_present_one() {
    let mut session = session(FLOOR);
    forward(&mut session, Unit::Increment, 6);
    let first = states(&session);
    back(&mut session, Unit::Increment, 2);
    set(&mut session, "friction.angle", "25");
    forward(&mut session, Unit::Increment, 4);
    let second = states(&session);
    // A branch of the branch, one that leaves it before it began, and one from the start of all.
    back(&mut session, Unit::Increment, 1);
    set(&mut session, "friction.angle", "20");
    forward(&mut session, Unit::Increment, 1);
    let third = states(&session);
    back(&mut session, Unit::Increment, 5);
    set(&mut session, "friction.angle", "10");
    forward(&mut session, Unit::Increment, 1);
    let fourth = states(&session);
    submit(&mut session, Command::Goto { step: 0 });
    set(&mut session, "history.increment", "0.02");
    forward(&mut session, Unit::Increment, 1);
    let fifth = states(&session);

    let parents: Vec<_> = summaries(session.timeline().tree())
        .iter()
        .map(|b| b.parent)
        .collect();
    assert_eq!(parents, [None, Some(0), Some(1), Some(0), Some(0)]);
    assert_eq!(names(&session)[1], "b2: friction.angle 25");
    let all = [first, second, third, fourth, fifth];
    for k in [2, 0, 4, 1, 3, 2, 4, 3, 1, 0] {
        branch(&mut session, &format!("b{}", k + 1));
        assert_eq!(states(&session), all[k], "b{}", k + 1);
        let lengths: Vec<usize> = summaries(session.timeline().tree())
            .iter()
            .map(|b| b.length)
            .collect();
        assert_eq!(lengths, all.each_ref().map(Vec::len));
        for (other, line) in all.iter().enumerate() {
            for (at, state) in line.iter().enumerate() {
                let (frame, _) = session.timeline().tree().point(other, at).expect("a point");
                assert_eq!(frame.state, *state, "b{} at {at}", other + 1);
            }
        }
        back(&mut session, Unit::Run, 1);
        forward(&mut session, Unit::Minor, 3);
        assert_eq!(session.frame().state, all[k][session.cursor()]);
        submit(
            &mut session,
            Command::Goto {
                step: all[k].len() - 1,
            },
        );
    }
    submit(&mut session, Command::Branch(BranchTarget::Previous));
    assert_eq!(states(&session), all[4]);
    submit(&mut session, Command::Branch(BranchTarget::Next));
    assert_eq!(states(&session), all[0]);
}

#[test]
fn branches_are_renamed_and_wrong_names_are_told() {
    let mut session = session(OSCILLATES);
    let refused =
        |session: &mut Session, command| session.submit(command).expect_err("refused").to_string();
    let only = refused(&mut session, Command::Branch(BranchTarget::Next));
    assert!(
        only.contains("an intervention before the tip starts another"),
        "{only}"
    );
    forward(&mut session, Unit::Run, 1);
    back(&mut session, Unit::Minor, 1);
    force(&mut session, Mode::Sliding);
    set(&mut session, "settings.minors", "50");
    assert_eq!(names(&session)[1], "b2: beam.5 sliding, minors 50");
    submit(&mut session, Command::Rename("way out".into()));
    assert_eq!(names(&session), ["b1: start", "b2: way out"]);
    for (name, told) in [
        ("", "one line"),
        ("start", "'start' is already in use"),
        ("b7", "looks like a branch number"),
    ] {
        let said = refused(&mut session, Command::Rename(name.into()));
        assert!(said.contains(told), "{said}");
    }
    let said = refused(
        &mut session,
        Command::Branch(BranchTarget::Named("nowhere".into())),
    );
    assert!(said.contains("branches: b1: start, b2: way out"), "{said}");
    branch(&mut session, "sta");
    branch(&mut session, "b2: way out");
    assert_eq!(session.timeline().tree().current(), 1);
}

#[test]
fn ends_are_judged_as_cycle_same_cycle_accepted_same_state_and_unfinished() {
    let mut session = session(OSCILLATES);
    forward(&mut session, Unit::Run, 1);
    submit(&mut session, Command::Goto { step: 1 });
    // Another limit changes nothing: the same cycle.
    set(&mut session, "settings.minors", "50");
    forward(&mut session, Unit::Run, 1);
    assert_eq!(
        verdicts(&session),
        [BranchEnd::Cycle, BranchEnd::SameCycle { branch: 0 }]
    );
    // The way out, twice, from different iterations of the cycle; the second only begun at first.
    for step in [1, 2] {
        branch(&mut session, "b1");
        submit(&mut session, Command::Goto { step: step - 1 });
        force(&mut session, Mode::Sliding);
        assert_eq!(verdicts(&session).last(), Some(&BranchEnd::Unfinished));
        forward(&mut session, Unit::Run, 1);
    }
    assert_eq!(
        verdicts(&session)[2..],
        [
            BranchEnd::Accepted,
            BranchEnd::Same {
                branch: 2,
                load: 1.0
            }
        ]
    );
    // Rougher than before, it ends elsewhere.
    let step = session.frames().len() / 2;
    submit(&mut session, Command::Goto { step });
    set(&mut session, "friction.angle", "25");
    forward(&mut session, Unit::Run, 1);
    let rougher = verdicts(&session)[4].clone();
    assert_eq!(
        rougher,
        BranchEnd::Other {
            branch: 2,
            load: 1.0
        }
    );
    let listed = submit(&mut session, Command::Branches);
    assert!(
        listed.contains("b2: minors 50 (same cycle as b1: start, 3 minor)"),
        "{listed}"
    );
}

#[test]
fn branches_are_compared_at_their_tips_and_at_the_last_load_that_both_reached() {
    let mut session = session(FLOOR);
    forward(&mut session, Unit::Increment, 6);
    submit(&mut session, Command::Goto { step: 0 });
    set(&mut session, "history.increment", "0.02");
    forward(&mut session, Unit::Increment, 2);
    let found = session.timeline().compare(0, 1).expect("two branches");
    assert_eq!(
        found.tips.each_ref().map(|side| side.load_factor),
        [0.06, 0.04]
    );
    let common = found.common.as_ref().expect("load 0.04");
    assert_eq!(common.each_ref().map(|side| side.load_factor), [0.04, 0.04]);
    assert_eq!(common.each_ref().map(|side| side.cost.increments), [4, 2]);
    assert_eq!(found.is_same, Some(true));
    let [a, b] = common;
    assert!(a.cost.minors > b.cost.minors && a.cost.majors > b.cost.majors);
    assert!(a.cost.seconds > 0.0 && a.residual < 1e-9);
    assert_eq!(a.nodes[0].mode, Mode::Sliding);
    let forces = |side: &stickslip::history::compare::Side| side.nodes[0].forces.expect("solved");
    assert!((forces(a)[0] - forces(b)[0]).abs() < 1e-7);
    assert!(session.timeline().compare(0, 7).is_none());
    let told = submit(&mut session, Command::Compare(None));
    assert!(told.contains("same state at load 0.04"), "{told}");
    // Rougher, the same load is another state.
    submit(&mut session, Command::Goto { step: 0 });
    set(&mut session, "friction.angle", "5");
    forward(&mut session, Unit::Increment, 3);
    assert_eq!(
        session.timeline().compare(0, 2).and_then(|c| c.is_same),
        Some(false)
    );
}

#[test]
fn minor_iterations_of_one_major_with_other_forces_are_different_states() {
    let table2 = [("settings.strategy".to_owned(), "table2".to_owned())];
    let mut session = Session::new(Scene::open(OSCILLATES, &table2).expect("a built-in scene"));
    forward(&mut session, Unit::Run, 1);
    back(&mut session, Unit::Minor, 2);
    force(&mut session, Mode::Sliding);
    forward(&mut session, Unit::Minor, 2);
    let found = session.timeline().compare(0, 1).expect("two branches");
    let [a, b] = found.common.as_ref().expect("a common place");
    let forces = |side: &stickslip::history::compare::Side| side.nodes[0].forces.expect("solved");
    assert_ne!(forces(a), forces(b));
    assert_eq!(found.is_same, Some(false));
}

#[test]
fn the_strip_of_an_iteration_tells_what_its_event_tells() {
    let mut session = session("02-two-cantilevers-rough");
    forward(&mut session, Unit::Increment, 3);
    submit(
        &mut session,
        Command::Force {
            slave: 0,
            mode: Mode::Fixed,
            hold: true,
        },
    );
    forward(&mut session, Unit::Increment, 1);
    let mut solved = 0;
    for (frame, strip) in session.frames().iter().zip(session.timeline().strips()) {
        assert_eq!(
            frame.intervention.is_some(),
            strip.kind == PointKind::Intervention
        );
        if !strip.kind.is_solved() {
            continue;
        }
        solved += 1;
        let event = frame.event.as_ref().expect("an event");
        assert_eq!(strip.position, event.position);
        for (s, record) in event.nodes.iter().enumerate() {
            assert_eq!(strip.before(s), record.decision.before);
            assert_eq!(strip.next(s), frame.state.nodes[s].mode);
            assert_eq!(strip.margin(s), record.decision.margin() as f32);
            assert_eq!(
                strip.is_forced(s),
                record.forced != stickslip::contact::record::Forced::No
            );
            assert_eq!(
                strip.element(s).is_some(),
                frame.state.nodes[s].spot.is_some()
            );
        }
    }
    assert!(solved > 10);
}

#[test]
fn a_session_with_hardly_any_memory_does_the_same() {
    let scene = || Scene::open(FLOOR, &[]).expect("a built-in scene");
    let whole_story = |session: &mut Session| {
        let mut seen = Vec::new();
        forward(session, Unit::Run, 1);
        for (unit, count) in [(Unit::Minor, 7), (Unit::Major, 3), (Unit::Increment, 9)] {
            back(session, unit, count);
            seen.push((session.cursor(), session.frame().state.clone()));
        }
        set(session, "friction.angle", "25");
        forward(session, Unit::Run, 1);
        seen.push((session.cursor(), session.frame().state.clone()));
        // Through an intervention, backward and forward.
        for _ in 0..40 {
            back(session, Unit::Minor, 1);
            seen.push((session.cursor(), session.frame().state.clone()));
        }
        submit(session, Command::Goto { step: 3 });
        branch(session, "b1");
        submit(session, Command::Goto { step: 30 });
        forward(session, Unit::Major, 2);
        seen.push((session.cursor(), session.frame().state.clone()));
        seen
    };
    let mut roomy = Session::new(scene());
    let budget = Budget {
        frames: 20_000,
        ..Budget::default()
    };
    let mut tight = Session::with_budget(scene(), budget);
    let (a, b) = (whole_story(&mut roomy), whole_story(&mut tight));
    assert!(roomy.frames().iter().all(Frame::is_whole));
    let whole = tight
        .frames()
        .iter()
        .filter(|frame| frame.is_whole())
        .count();
    assert!(
        whole < tight.frames().len() / 4,
        "{whole} of {}",
        tight.frames().len()
    );
    assert_eq!(a, b);
    // What panes show of the past does not depend on it.
    assert_eq!(
        roomy.timeline().residual_history(),
        tight.timeline().residual_history()
    );
    assert_eq!(
        curve(&roomy.frames()[..=roomy.cursor()], 0),
        curve(&tight.frames()[..=tight.cursor()], 0)
    );
    assert_eq!(verdicts(&roomy).len(), 2);
}

#[test]
fn a_branch_that_does_not_fit_is_refused_and_the_others_go_on() {
    let scene = || Scene::open("osc-lag4", &[]).unwrap();
    let started = |budget| {
        let mut session = Session::with_budget(scene(), budget);
        forward(&mut session, Unit::Increment, 2);
        session
    };
    let one = started(Budget::default())
        .timeline()
        .tree()
        .permanent_bytes();
    let mut session = started(Budget {
        branches: 2 * one,
        ..Budget::default()
    });
    let mut begun = 0;
    let refused = loop {
        submit(&mut session, Command::Goto { step: 1 });
        let force = Command::Force {
            slave: 0,
            mode: Mode::Sliding,
            hold: false,
        };
        match session.submit(force) {
            Ok(_) => begun += 1,
            Err(why) => break why.to_string(),
        }
        assert!(begun < 10_000, "no bound");
    };
    assert!(
        begun > 0 && refused.starts_with("no new branch"),
        "{refused}"
    );
    // One branch more than fits is what the last one may take.
    assert!(
        session.timeline().tree().permanent_bytes() >= 2 * one
            && session.timeline().tree().permanent_bytes() < 3 * one
    );
    let count = verdicts(&session).len();
    branch(&mut session, "b1");
    forward(&mut session, Unit::Minor, 1);
    assert_eq!(verdicts(&session).len(), count);
}

/// Node 7 of the block stands on a vertex of the bent column, where a smooth contact that nobody holds would slide.
#[test]
fn a_mode_that_is_held_is_that_of_every_solve_at_a_vertex_too() {
    let mut session = session("05-cantilever-elastic-block");
    let hold = Command::Force {
        slave: 6,
        mode: Mode::Fixed,
        hold: true,
    };
    submit(&mut session, hold);
    forward(&mut session, Unit::Minor, 12);
    let events = session.frames().iter().filter_map(|f| f.event.as_ref());
    let modes: Vec<Mode> = events.map(|e| e.nodes[6].decision.before).collect();
    assert_eq!(modes, [Mode::Fixed; 12]);
}

/// The scene freezes the contact geometry; after the fallback has helped, it is in the tangent whatever is chosen.
#[test]
fn a_setting_that_a_fallback_overrules_is_answered_with_the_value_in_force() {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/findings/frozen-geometry-diverges.ron"
    );
    let mut session = Session::new(Scene::open(scene, &[]).unwrap());
    let before = set(&mut session, "settings.geometry", "frozen");
    assert!(!before.contains("in force"), "{before}");
    let run = Command::Forward {
        unit: Unit::Run,
        count: 1,
    };
    submit(&mut session, run);
    let back = Command::Back {
        unit: Unit::Increment,
        count: 1,
    };
    submit(&mut session, back);
    let helped = set(&mut session, "settings.geometry", "frozen");
    let wanted = "; in force: consistent, by the fallback \"geometry: consistent\"";
    assert!(helped.contains(wanted), "{helped}");
    let other = set(&mut session, "settings.majors", "50");
    assert!(!other.contains("in force"), "{other}");
}
