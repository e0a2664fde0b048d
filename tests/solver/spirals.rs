//! Where T_max goes while the modes repeat is told early, and only what is certain is called a cycle.

use crate::census::{drawn, survey};
use crate::common::{self, run, scene};
use std::sync::Arc;
use stickslip::explain::core::cycle;
use stickslip::explain::page;
use stickslip::explain::proven::factor;
use stickslip::interface::census::census;
use stickslip::interface::problem::InterfaceProblem;
use stickslip::interface::t_max_iteration::{TMaxIteration, TMaxLimit, spiral};
use stickslip::interface::trials::Trials;
use stickslip::interface::uniqueness::{Uniqueness, plain, uniqueness};
use stickslip::model::Strategy;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;
use stickslip::step::stepper::Stepper;
use stickslip::strategy::method;

/// The problem of a scene's first major iteration.
fn first(name: &str, set: &[(&str, &str)]) -> InterfaceProblem {
    let mut stepper = Stepper::new(Arc::new(scene(name, set).model));
    stepper.interface_problem().unwrap()
}

fn found(problem: &InterfaceProblem, most: usize) -> Option<TMaxIteration> {
    spiral(problem, method(Strategy::Table2), most)
}

#[test]
fn at_one_node_t_max_converges_by_tan_phi_w_nt_over_w_nn_to_the_consistent_limit() {
    // Its head says that m = 0.948 there.
    let problem = first("osc-slowlag", &[("friction.angle", "35.75")]);
    let spiral = found(&problem, 100).unwrap();
    assert_eq!((spiral.period, spiral.fate), (1, TMaxLimit::Settles));
    assert!(spiral.start < 20, "{spiral:?}");
    let factor = factor(&problem, 0).unwrap();
    assert!((factor - 0.948).abs() < 5e-4, "{factor}");
    assert!((spiral.radius - factor).abs() < 1e-9, "{spiral:?}");
    let answer = census(&problem).unwrap().answers.remove(0).answer.nodes[0];
    assert!((spiral.fixed[0] - answer.f_t).abs() < 1e-9 * problem.force);
    // As many iterations as it says, counted.
    let more = spiral.iterations(problem.force).unwrap();
    let mut nodes = problem.states();
    let mut trials = Trials::new(&problem).unwrap();
    let away = |t_max: f64| (t_max - spiral.fixed[0]).abs() / problem.force;
    let mut counted = 0;
    while away(nodes[0].t_max) > 1e-12 || counted < u64::from(spiral.start) {
        trials.minor(&mut nodes, method(Strategy::Table2)).unwrap();
        counted += 1;
    }
    let told = u64::from(spiral.start) + more;
    assert!(counted.abs_diff(told) <= 3, "{counted} {told}");
}

#[test]
fn where_the_factor_is_above_one_t_max_swings_apart() {
    let mut problem = first("osc-slowlag", &[]);
    problem.settings.minors = 30;
    let spiral = found(&problem, 30).unwrap();
    assert_eq!((spiral.period, spiral.fate), (1, TMaxLimit::Diverges));
    assert!((spiral.radius - 1.054).abs() < 5e-4, "{}", spiral.radius);
    assert_eq!(spiral.iterations(problem.force), None);
}

/// Iterations until T_max and modes repeat, as the stepper waits for it; none if they settle.
fn comes_round(problem: &InterfaceProblem) -> Option<(u32, u32)> {
    let mut longer = problem.clone();
    longer.settings.minors = 20_000;
    let mut nodes = longer.states();
    let mut trials = Trials::new(&longer)?;
    let mut trail = stickslip::interface::minor_history::MinorHistory::default();
    for minor in 1..=6_000 {
        trail.push(&nodes);
        if trials.minor(&mut nodes, method(Strategy::Table2))?.1 {
            return None;
        }
        if let Some(cycle) = trail.cycle(&nodes, minor, 1e-14 * problem.force, 1e-14) {
            return Some((minor, cycle.period));
        }
    }
    None
}

#[test]
fn what_is_called_a_cycle_early_comes_round_and_what_settles_is_not() {
    let (mut early, mut slowest) = (0, 0);
    for k in 0..400 {
        let problem = drawn(5, k, 1..=4);
        let Some(spiral) = found(&problem, 100) else {
            continue;
        };
        let round = comes_round(&problem);
        match spiral.fate {
            TMaxLimit::Cycles => {
                let (minor, period) = round.unwrap();
                assert_eq!(period, spiral.period, "{k}");
                early += usize::from(minor > spiral.start);
                slowest = slowest.max(minor);
            }
            TMaxLimit::Settles => assert_eq!(round, None, "{k}"),
            _ => {}
        }
    }
    println!("early: {early}; the slowest came round after {slowest}");
    assert!(early > 0);
}

#[test]
fn no_census_finds_two_states_where_the_matrix_allows_one() {
    let (mut proven, mut of_plain) = (0, 0);
    for k in 0..3000 {
        let problem = drawn(2, k, 1..=3);
        let unique = matches!(uniqueness(&problem), Uniqueness::Unique { .. });
        let by_condition = plain(&problem).is_some_and(|factor| factor < 0.999);
        assert!(unique || !by_condition, "{k}: {:?}", uniqueness(&problem));
        proven += usize::from(unique);
        of_plain += usize::from(by_condition);
        if unique {
            let all = census(&problem).unwrap();
            assert!(all.answers.len() <= 1, "{k}");
        }
    }
    println!("{proven} of 3000 are proven unique, {of_plain} by the condition of W alone");
    assert!(proven > 2 * of_plain && of_plain > 10);
}

#[test]
fn the_matrix_of_a_scene_says_by_how_much_it_proves_one_state_at_most() {
    for name in [
        "02-two-cantilevers-rough",
        "02-two-cantilevers-smooth",
        "03-distant-cantilevers",
        "04-cantilever-rigid-circle",
        "05-cantilever-elastic-block",
        "05-cantilever-elastic-block-swapped",
        "hertz-cylinder-on-block",
    ] {
        let scene = scene(name, &[]);
        let mut stepper = Stepper::new(Arc::new(scene.model));
        let (mut all, mut proven) = (0, 0);
        let mut told = Vec::new();
        let mut nodes = 0;
        loop {
            if stepper.state().next.minor <= 1
                && let Some(problem) = stepper.interface_problem()
            {
                nodes = problem.nodes.len();
                let found = uniqueness(&problem);
                all += 1;
                proven += usize::from(matches!(found, Uniqueness::Unique { .. }));
                if told.last() != Some(&found) && told.len() < 3 {
                    told.push(found);
                }
            }
            if stepper.step().is_none() {
                break;
            }
        }
        println!("{name}, {nodes} nodes: {proven} of {all} majors; {told:?}");
        if name.ends_with("smooth") {
            assert!(all > 0 && proven == all, "{name}: {proven} of {all}");
        }
    }
}

/// Problems 1 to 4 nodes large whose cycle takes more than 150 iterations to come round to round-off.
fn slow_cycles() -> Vec<(usize, u32)> {
    let slow = |k: usize| {
        let problem = drawn(1, k, 1..=4);
        let spiral = found(&problem, 100)?;
        let (minor, _) = comes_round(&problem)?;
        (spiral.fate == TMaxLimit::Cycles && minor > 150).then_some((k, minor))
    };
    (0..1500).filter_map(slow).collect()
}

#[test]
fn a_cycle_that_t_max_spirals_into_slowly_is_reported_within_a_hundred_iterations() {
    let slow = slow_cycles();
    println!("slow: {slow:?}");
    assert!(!slow.is_empty());
    for (k, _) in slow {
        let problem = survey(1, k, 1..=4);
        let scene = Scene::from_spec(&problem.title, problem.spec()).unwrap();
        let scene = scene.with("settings.strategy", "table2").unwrap();
        let scene = scene.with("history.least", "1").unwrap();
        for limit in ["100", "3000"] {
            let scene = scene.with("settings.minors", limit).unwrap();
            let failed = run(&scene);
            let Some((event, Failure::Cycle(cycle))) = failed.failure else {
                panic!("{k}: {:?}", failed.failure)
            };
            let expected = found(&drawn(1, k, 1..=4), 100).unwrap();
            assert_eq!(cycle.period, expected.period, "{k}");
            let _ = event;
            let minors = failed.stepper.state().next.minor;
            assert!(minors <= 102, "{k}: {minors}");
        }
    }
}

/// The page of the failure that a run ended with.
fn page_of(failed: common::Run) -> Vec<String> {
    let mut stepper = failed.stepper;
    let state = stepper.state().clone();
    let mut seen = |_: &_| ();
    let page = page::page(&mut stepper, &state, None, Vec::new(), &|| false, &mut seen);
    page.unwrap().lines()
}

#[test]
fn on_the_page_of_a_minor_limit_the_rate_comes_before_what_to_do() {
    let set = [
        ("friction.angle", "35.75"),
        ("settings.strategy", "table2"),
        ("settings.minors", "60"),
        ("history.least", "1"),
    ];
    let failed = run(&scene("osc-slowlag", &set));
    let failure = failed.failure.as_ref().map(|(_, failure)| failure);
    assert!(
        matches!(failure, Some(Failure::MinorLimit { .. })),
        "{failure:?}"
    );
    let lines = page_of(failed);
    let place = |start: &str| lines.iter().position(|line| line.starts_with(start));
    let why = place("Why: the modes have settled; T_max converges by a factor of 0.94");
    assert!(why.is_some() && why < place("Try 1:"), "{lines:#?}");
    assert!(
        place("    its fixed point: T_max = ").is_some(),
        "{lines:#?}"
    );
}

#[test]
fn the_page_of_a_cycle_that_t_max_spirals_into_says_the_rate_and_the_fixed_point() {
    let problem = survey(1, 782, 1..=4);
    let scene = Scene::from_spec(&problem.title, problem.spec()).unwrap();
    let scene = scene.with("settings.strategy", "table2").unwrap();
    let scene = scene.with("history.least", "1").unwrap();
    let lines = page_of(run(&scene)).join("\n");
    assert!(
        lines.contains("T_max spirals into the cycle by a factor of 0."),
        "{lines}"
    );
    assert!(lines.contains("its fixed point: T_max = "), "{lines}");
}

#[test]
fn a_cycle_that_runs_long_on_the_same_modes_is_found_from_wherever_one_starts() {
    let mut problem = first("osc-slowlag", &[]);
    problem.settings.minors = 20;
    let mut nodes = problem.states();
    let mut trials = Trials::new(&problem).unwrap();
    let mut from = problem.clone();
    for start in 0..45 {
        from.nodes[0].state = nodes[0];
        let cycle = cycle(&from).unwrap_or_else(|| panic!("{start}"));
        assert_eq!(cycle.period, 39, "{start}");
        trials.minor(&mut nodes, method(Strategy::Table2)).unwrap();
    }
}
