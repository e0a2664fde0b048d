//! The census finds every consistent state of a frozen interface problem.

use crate::common::{self, run, scene};
use std::ops::RangeInclusive;
use std::sync::Arc;
use stickslip::explain::diagnosis::{Diagnosis, words};
use stickslip::explain::examination::{examine_nodes, going_round};
use stickslip::explain::facts::Fact;
use stickslip::explain::page::page;
use stickslip::format::condensed::Problem;
use stickslip::interface::census::{BUDGET, MOST, by_blocks, census, search};
use stickslip::interface::problem::InterfaceProblem;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;
use stickslip::step::stepper::Stepper;
use stickslip::study::random::Population;

const TWO_BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/benches/two-blocks-pressed-sheared.ron"
);

#[test]
fn where_free_and_fixed_take_turns_sliding_is_the_one_answer() {
    for solver in ["augmented", "condensed"] {
        let set = [
            ("settings.solver", solver),
            ("settings.t_max", "consistent"),
        ];
        let scene = scene("osc-inclined-cantilever", &set);
        let mut failed = run(&scene);
        assert!(matches!(failed.failure, Some((_, Failure::Cycle(_)))));
        let frozen = failed.stepper.interface_problem().unwrap();
        let census = census(&frozen).unwrap();
        let answers: Vec<_> = census.answers.iter().map(|a| a.answer.letters()).collect();
        assert_eq!((census.tried, answers), (4, vec!["-".to_string()]));
        let slides = census.answers[0].answer.nodes[0];
        // What the solver finds once the tip is forced to slide.
        common::force(&mut failed, 0, stickslip::model::Mode::Sliding, false);
        let mut stepper = failed.stepper;
        let first = loop {
            let event = stepper.step().unwrap();
            if !event.nodes[0].decision.changes() {
                break event.nodes[0];
            }
        };
        assert!(
            (first.f_n - slides.f_n).abs() < 1e-9 * slides.f_n,
            "{first:?} {slides:?}"
        );
        assert!((first.f_t - slides.f_t).abs() < 1e-9 * slides.f_n);
    }
}

#[test]
fn where_nothing_touches_the_free_state_is_the_one_answer() {
    let scene = scene("04-cantilever-rigid-circle", &[]);
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let frozen = stepper.interface_problem().unwrap();
    let count = frozen.nodes.len();
    let found = census(&frozen);
    if count > stickslip::interface::census::MOST {
        assert!(found.unwrap_err().to_string().contains("core"));
    } else {
        assert_eq!(
            found.unwrap().answers[0].answer.letters(),
            "F".repeat(count)
        );
    }
}

/// A problem drawn as the survey draws it.
pub fn survey(seed: u64, k: usize, nodes: RangeInclusive<usize>) -> Problem {
    let count = k + 1;
    let population = Population { seed, count, nodes };
    population.draw(k).problem
}

/// The frozen problem of a problem drawn as the survey draws it.
pub fn drawn(seed: u64, k: usize, nodes: RangeInclusive<usize>) -> InterfaceProblem {
    let problem = survey(seed, k, nodes);
    let scene = Scene::from_spec(&problem.title, problem.spec()).unwrap();
    let mut stepper = Stepper::new(Arc::new(scene.model));
    stepper.interface_problem().unwrap()
}

fn never() -> bool {
    false
}

#[test]
fn branch_and_bound_finds_what_trying_all_assumptions_finds() {
    let mut several = 0;
    let mut none = 0;
    for (nodes, count) in [(1..=4, 300), (5..=6, 60), (7..=8, 12)] {
        for k in 0..count {
            let problem = drawn(11, k, nodes.clone());
            let all = census(&problem).unwrap();
            let found = by_blocks(&problem, BUDGET, &never);
            assert!(found.exact);
            assert_eq!(found.tried, all.tried);
            assert_eq!(found.answers, all.answers, "{k} of {nodes:?}");
            several += usize::from(all.answers.len() > 1);
            none += usize::from(all.answers.is_empty());
        }
    }
    assert!(several > 3 && none > 3, "{several} {none}");
}

#[test]
fn nodes_that_do_not_touch_each_others_forces_are_counted_block_by_block() {
    let one = drawn(11, 3, 4..=4);
    let states = census(&one).unwrap();
    // The problem three times over, in one matrix.
    let size = one.relation.count();
    let mut three = one.clone();
    three.nodes = [one.nodes.clone(), one.nodes.clone(), one.nodes.clone()].concat();
    three.relation.start = one.relation.start.repeat(3);
    three.relation.response = vec![0.0; 9 * size * size];
    for block in 0..3 {
        for j in 0..size {
            for i in 0..size {
                let at = (block * size + j) * 3 * size + block * size + i;
                three.relation.response[at] = one.relation.response[j * size + i];
            }
        }
    }
    let found = search(&three, BUDGET, &never).unwrap();
    assert!(found.exact);
    assert_eq!(found.answers.len(), states.answers.len().pow(3));
    assert_eq!(found.tried, states.tried.pow(3));
}

#[test]
fn twenty_nodes_are_counted_and_each_state_counted_obeys() {
    let counts: Vec<usize> = [1, 7, 20, 21]
        .map(|k| {
            let problem = drawn(1, k, 20..=20);
            let found = search(&problem, BUDGET, &never).unwrap();
            assert!(found.exact && found.visited < 5000, "{k}");
            assert!(found.answers.iter().all(|state| state.answer.obeys(1e-9)));
            found.answers.len()
        })
        .to_vec();
    assert_eq!(counts, [1, 1, 1, 0]);
}

#[test]
fn states_of_a_meshed_surface_are_counted_exactly_in_every_minor_iteration() {
    let set = [("refine", "2"), ("history.increment", "1.0")];
    let scene = scene(TWO_BLOCKS, &set);
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let mut searched = 0;
    while searched < 6 {
        let position = stepper.step().unwrap().position;
        if position.increment < 2 {
            continue;
        }
        let problem = stepper.interface_problem().unwrap();
        let found = search(&problem, BUDGET, &never).unwrap();
        let counted = (found.exact, found.answers.len(), found.visited);
        let is_counted = matches!(counted, (true, 1, ..5000));
        assert!(is_counted, "{position:?}: {counted:?}");
        searched += 1;
    }
}

#[test]
fn a_search_that_is_stopped_or_out_of_budget_counts_at_least_what_it_found() {
    let problem = drawn(1, 3, 20..=20);
    let whole = search(&problem, BUDGET, &never).unwrap();
    assert!(whole.exact);
    let stopped = search(&problem, BUDGET, &|| true).unwrap();
    assert!(!stopped.exact && stopped.answers.is_empty());
    let half = search(&problem, whole.visited / 2, &never).unwrap();
    assert!(!half.exact && half.visited == whole.visited / 2);
    assert!(half.answers.len() <= whole.answers.len());
    assert_eq!(half, search(&problem, whole.visited / 2, &never).unwrap());
}

#[test]
fn a_count_and_a_page_that_are_stopped_keep_what_was_found_and_say_that_it_is_not_done() {
    let problem = survey(1, 3, 20..=20);
    let scene = Scene::from_spec(&problem.title, problem.spec()).unwrap();
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let state = stepper.state().clone();
    let all: Vec<usize> = (0..20).collect();
    let counted = examine_nodes(&mut stepper, &state, &all, &|| true);
    let words = texts(&counted.facts);
    assert!(words.contains("incomplete after 0 branches"), "{words}");
    let mut parts = 0;
    let whole = page(
        &mut stepper,
        &state,
        None,
        Vec::new(),
        &|| true,
        &mut |_| parts += 1,
    );
    assert_eq!((whole, parts), (None, 1));
}

fn texts(facts: &[Fact]) -> String {
    let texts: Vec<&str> = facts.iter().map(|fact| fact.text.as_str()).collect();
    texts.join("\n")
}

#[test]
fn of_a_cycle_of_many_nodes_the_states_of_those_that_change_are_counted_and_that_is_said() {
    let (mut of_changing, mut of_core) = (0, 0);
    for k in 0..80 {
        let problem = survey(4, k, 12..=14);
        let scene = Scene::from_spec(&problem.title, problem.spec()).unwrap();
        let scene = scene.with("settings.strategy", "table2").unwrap();
        let mut stepper = Stepper::new(Arc::new(scene.model));
        let (state, whole) = (
            stepper.state().clone(),
            stepper.interface_problem().unwrap(),
        );
        let Some((problem, cycle)) = going_round(&mut stepper, &state, &whole).unwrap() else {
            continue;
        };
        let changes = |member: &&(usize, Vec<Mode>)| member.1.iter().any(|m| *m != member.1[0]);
        let changing: Vec<usize> = cycle.members.iter().filter(changes).map(|m| m.0).collect();
        if cycle.members.len() <= MOST || changing.is_empty() {
            continue;
        }
        let diagnosis = Diagnosis::find(&problem, &never).unwrap();
        let counted: Vec<usize> = diagnosis.problem.nodes.iter().map(|n| n.slave).collect();
        let words = texts(&words(stepper.model(), &problem, &diagnosis));
        if counted == changing {
            of_changing += 1;
            let told = format!("the states of the {} whose modes change", changing.len());
            assert_eq!(
                words.contains(&told),
                changing.len() < cycle.members.len(),
                "{words}"
            );
        } else if counted.len() == whole.nodes.len() {
            assert!(diagnosis.census.is_some_and(|census| census.exact));
        } else {
            of_core += 1;
        }
    }
    println!("{of_changing} of the nodes that change, {of_core} of the core");
    assert!(of_changing > 0 && of_core == 0);
}

/// Run by itself: `cargo test --release --test solver -- --ignored --nocapture thousand`.
#[test]
#[ignore = "takes minutes; its figures are in the manual"]
fn a_thousand_problems_of_twenty_nodes_are_counted_exactly_within_ten_seconds_each() {
    let count = std::env::var("SEEDS").map_or(1000, |n| n.parse().unwrap());
    let mut runs: Vec<(f64, usize, usize)> = (0..count)
        .map(|k| {
            let problem = drawn(1, k, 20..=20);
            let start = std::time::Instant::now();
            let found = search(&problem, BUDGET, &never).unwrap();
            let time = start.elapsed().as_secs_f64();
            assert!(found.exact, "{k}");
            if time > 4.0 {
                println!("{k}: {time:.2} s, {} branches", found.visited);
            }
            (time, found.visited, found.answers.len())
        })
        .collect();
    let with = |states: usize| runs.iter().filter(|run| run.2 == states).count();
    println!("states: none {}, one {}, two {}", with(0), with(1), with(2));
    println!("most states: {:?}", runs.iter().map(|run| run.2).max());
    println!("most branches: {:?}", runs.iter().map(|run| run.1).max());
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    for part in [0.5, 0.9, 0.99, 1.0] {
        let at = ((runs.len() - 1) as f64 * part) as usize;
        println!("{part}: {:.3} s", runs[at].0);
    }
    assert!(runs.iter().all(|run| run.0 < 10.0));
}
