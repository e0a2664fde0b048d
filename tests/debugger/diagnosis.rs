//! Scenes that are known to cycle are diagnosed as their notes say (`tests/references/`, and the comments of the scenes):
//! period, members, consistent states, cause.

use crate::common::{Run, force, go_on, run, scene};
use std::sync::Arc;
use stickslip::explain::advice::advice;
use stickslip::explain::attempt::{Attempt, Major};
use stickslip::explain::diagnosis::{Cause, Diagnosis, words};
use stickslip::explain::facts::Part;
use stickslip::explain::influence::influences;
use stickslip::explain::majors::limit_words;
use stickslip::explain::restart;
use stickslip::interface::problem::InterfaceProblem;
use stickslip::interface::trials::Trials;
use stickslip::linear::norms::Norms;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::scene::gaps::turned;
use stickslip::step::event::Failure;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;

fn failed(name: &str) -> (Run, InterfaceProblem, Diagnosis) {
    let mut run = run(&scene(name, &[]));
    assert!(
        matches!(run.failure, Some((_, Failure::Cycle(_)))),
        "{name}: {:?}",
        run.failure
    );
    let problem = run.stepper.interface_problem().unwrap();
    let diagnosis = Diagnosis::find(&problem, &|| false).unwrap();
    (run, problem, diagnosis)
}

fn answers(diagnosis: &Diagnosis) -> Vec<String> {
    let census = diagnosis.census.as_ref().unwrap();
    census.answers.iter().map(|a| a.answer.letters()).collect()
}

#[test]
fn the_small_scenes_are_diagnosed_as_their_notes_say() {
    let no_way = |nodes: &[usize]| Cause::NoWayToSliding(nodes.to_vec());
    for (name, period, members, consistent, cause) in [
        ("osc-inclined-cantilever", 2, 1, vec!["-"], no_way(&[0])),
        ("osc-touch2", 2, 1, vec!["-"], no_way(&[0])),
        ("osc-lag4", 4, 1, vec!["-"], Cause::Passed),
        ("osc-zig3", 3, 1, vec!["+"], Cause::Passed),
        ("osc-two3", 3, 2, vec!["++"], no_way(&[0])),
        ("osc-two-many", 3, 2, vec!["XX"], Cause::Passed),
        ("osc-three10", 10, 3, vec!["-FF"], Cause::Passed),
        ("osc-coh-none", 2, 1, vec![], Cause::NoAnswer),
        ("osc-drag65", 4, 1, vec!["-"], Cause::Passed),
    ] {
        let (run, problem, diagnosis) = failed(name);
        assert_eq!(diagnosis.cycle.period, period, "{name}");
        assert_eq!(diagnosis.cycle.members.len(), members, "{name}");
        assert_eq!(answers(&diagnosis), consistent, "{name}");
        assert_eq!(diagnosis.cause, cause, "{name}");
        // The frozen problem's own minor iterations are those of the solver.
        let Some((_, Failure::Cycle(cycle))) = &run.failure else {
            unreachable!()
        };
        assert_eq!(cycle.period, period, "{name}");
        let lines = words(run.stepper.model(), &problem, &diagnosis);
        assert!(lines.len() >= 3 && lines[0].part == Part::Why, "{name}");
    }
}

#[test]
fn assumptions_that_lead_to_one_state_are_ties_and_not_several_states() {
    // The notes list XX and -X: F_t of the first node is at its limit to the last bit, and its slip is none.
    let (_, _, diagnosis) = failed("osc-two-many");
    let census = diagnosis.census.unwrap();
    assert_eq!(census.answers[0].ties, ["-X"]);
}

#[test]
fn the_two_nodes_with_several_periods_have_one_answer_that_gets_out() {
    let (mut run, _, diagnosis) = failed("osc-two6");
    assert_eq!(answers(&diagnosis), ["--"]);
    for slave in 0..2 {
        force(&mut run, slave, Mode::Sliding, false);
    }
    let run = go_on(run);
    assert_eq!(run.stepper.state().status, Status::Finished);
    let end = run.accepted.last().unwrap().monitors["u_x"];
    assert!((end + 0.44859).abs() < 1e-5, "{end}");
}

#[test]
fn a_core_is_no_larger_than_its_cycle_and_cycles_by_itself() {
    for name in ["osc-two3", "osc-two6", "osc-three10"] {
        let (_, _, diagnosis) = failed(name);
        let core = diagnosis.core.unwrap();
        assert!(core.places.len() <= diagnosis.cycle.members.len());
        assert_eq!(core.problem.nodes.len(), core.places.len());
        assert!(
            stickslip::explain::core::cycle(&core.problem).is_some(),
            "{name}"
        );
        for drop in 0..core.places.len() {
            let fewer: Vec<usize> = (0..core.places.len()).filter(|&p| p != drop).collect();
            let smaller = core.problem.reduced(&fewer).unwrap();
            let still = stickslip::explain::core::cycle(&smaller);
            assert!(fewer.is_empty() || still.is_none(), "{name} without {drop}");
        }
    }
}

#[test]
fn influences_add_up_to_what_happened() {
    for name in ["osc-two3", "osc-two6", "osc-three10", "osc-drag65"] {
        let (_, problem, diagnosis) = failed(name);
        let mut states = vec![problem.states()];
        let mut trials = Trials::new(&problem).unwrap();
        for _ in 0..diagnosis.cycle.period {
            let mut next = states.last().unwrap().clone();
            trials
                .minor(
                    &mut next,
                    stickslip::strategy::method(problem.settings.strategy),
                )
                .unwrap();
            states.push(next);
        }
        for pair in states.windows(2).take(diagnosis.cycle.period as usize - 1) {
            let (old, new) = (
                trials.solve_states(&pair[0]).unwrap(),
                trials.solve_states(&pair[1]).unwrap(),
            );
            for target in 0..problem.nodes.len() {
                let all = influences(&problem, &old, &pair[1], &[target]).unwrap();
                let all = &all[0];
                let f_n: f64 = all.iter().map(|i| i.f_n).sum();
                let gap: f64 = all.iter().map(|i| i.gap).sum();
                let size = old[target].force[0].abs() + new[target].force[0].abs() + problem.force;
                let happened = new[target].force[0] - old[target].force[0];
                assert!(
                    (f_n - happened).abs() < 1e-9 * size,
                    "{name}: {f_n} {happened}"
                );
                let happened = old[target].motion[0] - new[target].motion[0];
                let size =
                    old[target].motion[0].abs() + new[target].motion[0].abs() + problem.length;
                assert!(
                    (gap - happened).abs() < 1e-9 * size,
                    "{name}: {gap} {happened}"
                );
            }
        }
    }
}

#[test]
fn a_surface_that_most_of_its_nodes_are_behind_is_the_wrong_way_round_and_reversing_it_helps() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/findings/surface-the-wrong-way-round.ron"
    );
    let reversed = scene(file, &[]);
    let found = turned(&reversed.model);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].away, [21, 39]);
    let state = Stepper::new(Arc::new(reversed.model.clone()))
        .state()
        .clone();
    let advised = advice(&reversed.model, &state, &Failure::PathReversal, None);
    let [remedy] = advised.as_slice() else {
        panic!("{advised:?}");
    };
    assert_eq!(remedy.how.typed(), "--set surfaces.punch.reverse=true");
    let right = scene(file, &[("surfaces.punch.reverse", "true")]);
    assert!(turned(&right.model).is_empty());
    assert!(run(&right).failure.is_none());
}

#[test]
fn after_too_many_cuts_the_remedies_are_those_of_the_last_failure_without_smaller_increments() {
    let model = scene("osc-border", &[]).model;
    let state = Stepper::new(Arc::new(model.clone())).state().clone();
    let last = Failure::MajorLimit {
        limit: 60,
        relative: 0.1,
        interface: 0.1,
    };
    let cut = Failure::CutTooOften {
        slave: 0,
        cuts: 300,
        last: Box::new(last.clone()),
    };
    let typed = |failure: &Failure| -> Vec<String> {
        let advised = advice(&model, &state, failure, None).into_iter();
        advised.map(|remedy| remedy.how.typed()).collect()
    };
    let (once, often) = (typed(&last), typed(&cut));
    let smaller = |how: &&String| how.starts_with(":increment");
    assert!(once.iter().any(|how| smaller(&how)), "{once:?}");
    assert!(often.contains(&":set settings.geometry consistent".to_owned()));
    let rest: Vec<_> = once.iter().filter(|how| !smaller(how)).collect();
    assert_eq!(often.iter().collect::<Vec<_>>(), rest);
}

#[test]
fn residuals_that_do_not_fall_name_the_node_and_what_changes_instead_of_a_rate() {
    let model = scene("osc-two6", &[]).model;
    let state = Stepper::new(Arc::new(model.clone())).state().clone();
    let node = model.contacts[0].node;
    let attempt = |errors: &[f64]| Attempt {
        majors: errors
            .iter()
            .enumerate()
            .map(|(k, &relative)| Major {
                after: Norms {
                    relative,
                    ..Norms::default()
                },
                u: state.u.clone(),
                largest: Some((node, 2.5)),
                contacts: (0..2)
                    .map(|s| match (s, k % 2) {
                        (1, 1) => (Mode::Free, None),
                        _ => (Mode::Sliding, None),
                    })
                    .collect(),
            })
            .collect(),
        failure: Failure::PathReversal,
    };
    let words = |errors: &[f64]| {
        let facts = limit_words(&model, &model.settings, &attempt(errors));
        let why = facts.into_iter().filter(|fact| fact.part == Part::Why);
        why.map(|fact| fact.text).collect::<Vec<_>>()
    };
    let [hops, largest, change] = &words(&[1e-2, 1e-4, 1e-2, 1e-4])[..] else {
        panic!("three causes");
    };
    assert!(
        hops.contains("4 major iterations lie between 1e-4 and 0.01"),
        "{hops}"
    );
    let (node, body) = (&model.nodes[node].name, &model.bodies[0].name);
    let named = format!("2.5 at node {node} of {body} ");
    assert!(largest.contains(&named), "{largest}");
    let other = &model.nodes[model.contacts[1].node].name;
    let changes = format!("major 4: {other} sliding → free");
    assert!(change.ends_with(&changes), "{change} / {changes}");
    let [falls] = &words(&[1e-1, 1e-2, 1e-3, 1e-4])[..] else {
        panic!("one cause");
    };
    assert!(falls.contains("falls by a factor of 0.1 "), "{falls}");
}

/// On a finer mesh `s.3` is a node in the middle of the beam instead of its tip.
#[test]
fn a_mesh_whose_nodes_are_named_singly_is_not_tried_finer() {
    let is_refined = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/findings/");
        let [mesh, finer] = ["1", "2"].map(|refine| {
            let file = format!("{folder}{name}.ron");
            scene(&file, &[("refine", refine)]).model
        });
        restart::is_refined(&finer, &mesh)
    };
    assert!(is_refined("coarse-mesh-with-frozen-geometry"));
    assert!(!is_refined("slides-to-the-end-of-its-surface"));
}

/// On the finer mesh the nodes have other numbers, so that half of the slave sides, or the node of the monitor, is elsewhere.
#[test]
fn a_mesh_whose_faces_or_monitors_are_named_by_nodes_is_not_tried_finer() {
    let is_refined = |slaves: &str, monitor: &str| {
        let text = format!(
            r#"(
    title: "A block on a base",
    nodes: [
        Block(id: "base", corners: [(-0.5, 0.0), (1.5, 0.5)], elements: (2, 1)),
        Block(id: "b", corners: [(0.0, 0.5), (1.0, 1.0)], elements: (2, 1)),
    ],
    materials: [Elastic(id: "soft", E: 1000.0, nu: 0.2)],
    bodies: [
        Solid(id: "base", mesh: "base", material: "soft"),
        Solid(id: "b", mesh: "b", material: "soft"),
    ],
    surfaces: [(id: "below", along: "base.top")],
    slaves: [(nodes: [{slaves}], on: ["below"], law: Penalty(stiffness: 1e5), by: surface)],
    supports: [(node: "base.bottom", fix: [x, y]), (node: "b.top", fix: [x])],
    loads: [Displacement(node: "b.top", component: y, value: -0.01)],
    monitors: [(name: "u", of: Displacement(node: "{monitor}", component: x))],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#
        );
        let [mesh, finer] = ["1", "2"].map(|refine| {
            let refine = ("refine".to_owned(), refine.to_owned());
            Scene::from_text("block.ron", &text, &[refine])
                .unwrap()
                .model
        });
        restart::is_refined(&finer, &mesh)
    };
    let numbered: Vec<String> = (1..=5).map(|k| format!("\"b.bottom.{k}\"")).collect();
    assert!(is_refined("\"b.bottom\"", "b.top.start"));
    assert!(!is_refined(&numbered.join(", "), "b.top.start"));
    assert!(!is_refined("\"b.bottom\"", "b.bottom.2"));
}
