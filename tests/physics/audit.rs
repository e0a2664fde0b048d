//! Every accepted increment of what the program ships obeys every law, and `stickslip audit` says so.

use crate::common::scene;
use crate::program::{code, err, out, program};
use std::path::Path;
use std::sync::Arc;
use stickslip::contact::laws::JudgedLaw;
use stickslip::explain::audit::Audit;
use stickslip::explain::remedies::{self, TrialEnd};
use stickslip::model::Mode;
use stickslip::model::{AtLimit, SlipCount, Sticking, TieRule};
use stickslip::scene::{Scene, builtin};
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;
use stickslip::study::plan::Plan;
use stickslip::study::read::Study;

/// A scene to its end or first failure.
fn audit(scene: Scene) -> Audit {
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let mut audit = Audit::default();
    while let Some(event) = stepper.step() {
        if matches!(event.outcome, Outcome::Failed(_)) {
            break;
        }
        audit.take(&stepper);
    }
    audit
}

/// Whether a scene asks for what leaves Coulomb's law: readings of the paper, and limits that are to be accepted.
fn leaves_the_law(scene: &Scene) -> bool {
    let s = &scene.model.settings;
    s.slip == SlipCount::Major
        || s.sticking == Sticking::Increments
        || s.ties == TieRule::Printed
        || s.at_minor_limit == AtLimit::Accept
        || s.at_major_limit == AtLimit::Accept
}

/// Nothing is broken; and what is marked is so since the scene asks for it, or is a touch that no place of touching explains
/// and that could not be cut.
fn assert_clean(name: &str, audit: &Audit, may_be_marked: bool) {
    let broken: Vec<_> = audit.broken().collect();
    assert!(broken.is_empty(), "{name}: {broken:?}");
    let marked = audit
        .worst_marked
        .iter()
        .flatten()
        .map(|found| found.finding);
    let mut beyond =
        marked.filter(|finding| finding.is_broken() && finding.law != JudgedLaw::Touch);
    assert!(
        may_be_marked || beyond.next().is_none(),
        "{name}: {beyond:?}"
    );
}

#[test]
fn every_accepted_increment_of_every_built_in_scene_obeys_every_law() {
    let mut judged = 0;
    for builtin in builtin::list() {
        let scene = scene(builtin.name, &[]);
        let may_be_marked = leaves_the_law(&scene);
        let audit = audit(scene);
        assert_clean(builtin.name, &audit, may_be_marked);
        judged += u32::from(audit.of(JudgedLaw::Slip).is_some());
    }
    assert!(judged > 10, "nodes are pressed in most scenes: {judged}");
}

#[test]
fn the_studies_of_stuck_and_sliding_nodes_obey_every_law_where_they_ask_for_it() {
    for name in ["geometry-02", "t-max-friction"] {
        let plan = Plan::new(Study::open(name).unwrap()).unwrap();
        for case in &plan.cases {
            let scene = case.open().unwrap();
            let may_be_marked = leaves_the_law(&scene);
            assert_clean(name, &audit(scene), may_be_marked);
        }
    }
}

fn findings(file: &str) -> String {
    format!("{}/tests/findings/{file}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_command_prints_the_worst_of_every_law_and_ends_with_0_where_all_hold() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = findings("2-stuck-after-retouch.ron");
    let snapshot = "snapshots/02-rough-at-the-end.ron";
    let output = program(here, &["audit", &file, snapshot]).output().unwrap();
    assert_eq!(code(&output), 0, "{}", err(&output));
    let text = out(&output);
    for law in JudgedLaw::ALL {
        let rows = text.matches(&format!("\n  {} ", law.name())).count();
        assert_eq!(rows, 2, "{text}");
    }
    assert!(text.contains("10 increments accepted"), "{text}");
    assert!(!text.contains("BROKEN"), "{text}");
}

#[test]
fn what_was_accepted_against_a_law_since_the_user_wanted_so_is_listed_apart() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = findings("2-stuck-after-retouch.ron");
    let set = ["--set", "settings.sticking=increments"];
    let output = program(here, &["audit", &file, set[0], set[1]])
        .output()
        .unwrap();
    assert_eq!(code(&output), 0, "{}", err(&output));
    let text = out(&output);
    assert!(
        text.contains("of them marked") && text.contains("marked, not counted"),
        "{text}"
    );
    // And a run warns of it, with law, node and amount.
    let output = program(here, &["run", &file, set[0], set[1]])
        .output()
        .unwrap();
    assert!(err(&output).contains("but s."), "{}", err(&output));
}

#[test]
fn bad_input_to_an_audit_is_told_and_ends_with_2() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let snapshot = "snapshots/02-rough-at-the-end.ron";
    for arguments in [
        vec!["audit"],
        vec!["audit", "no-such-scene"],
        vec!["audit", snapshot, "--set", "refine=2"],
    ] {
        let output = program(here, &arguments).output().unwrap();
        assert_eq!(
            (code(&output), out(&output)),
            (2, String::new()),
            "{arguments:?}"
        );
        assert!(!err(&output).is_empty());
    }
}

#[test]
fn a_node_in_a_rough_valley_ends_at_the_bottom_with_the_force_of_both_sides() {
    let scene = Scene::open(&findings("valley-friction.ron"), &[]).unwrap();
    let mut stepper = Stepper::new(Arc::new(scene.model));
    while let Some(event) = stepper.step() {
        assert!(!matches!(event.outcome, Outcome::Failed(_)));
    }
    // The bottom is at the origin; the springs and the load give the force.
    let state = stepper.state();
    let (at, force) = ([-0.05, 0.028868], state.nodes[0].force());
    for k in 0..2 {
        let (stiffness, load) = ([3.0, 4.0][k], [0.8, -3.0][k]);
        assert!((state.u[k] + at[k]).abs() < 1e-11, "{:?}", state.u);
        assert!(
            (force[k] - (stiffness * -at[k] - load)).abs() < 1e-9,
            "{force:?}"
        );
    }
}

#[test]
fn an_audit_keeps_the_worst_of_all_increments() {
    let scene = scene("01-pinned-beam-rough-floor", &[]);
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let mut audit = Audit::default();
    let (mut worst, mut last) = ([0.0_f64; JudgedLaw::ALL.len()], [0.0; JudgedLaw::ALL.len()]);
    while let Some(event) = stepper.step() {
        let accepted = matches!(event.outcome, Outcome::Increment { marked: None, .. });
        audit.take(&stepper);
        if accepted && let Some(verdict) = stepper.state().start.verdict {
            last = verdict
                .worst
                .map(|found| found.map_or(0.0, |found| found.times()));
            worst = std::array::from_fn(|k| worst[k].max(last[k]));
        }
    }
    let kept = JudgedLaw::ALL.map(|law| audit.of(law).map_or(0.0, |found| found.finding.times()));
    assert_eq!(kept, worst);
    assert_ne!(last, worst);
}

/// A scene up to where Table 2, without the ladder, fails.
fn failed(name: &str) -> Stepper {
    let by_table_2 = scene(name, &[("settings.strategy", "table2")]);
    let mut stepper = Stepper::new(Arc::new(by_table_2.model));
    while let Some(event) = stepper.step() {
        if matches!(event.outcome, Outcome::Failed(_)) {
            return stepper;
        }
    }
    panic!("{name} is to fail")
}

#[test]
fn a_remedy_converges_where_it_reaches_the_load_that_failed() {
    let (mut converged, mut in_parts) = (0, 0);
    for name in ["osc-inclined-cantilever", "osc-drag65", "osc-snap"] {
        let mut stepper = failed(name);
        let failed = stepper.state().clone();
        for remedy in remedies::all(&mut stepper, &failed, None, &|| false) {
            let trial = remedies::attempt(&mut stepper, &failed, None, &remedy, &|| false).unwrap();
            let reached = stepper.state().start.load_factor;
            let short = (failed.load_factor - reached) > 1e-9;
            if trial.end == TrialEnd::Converged {
                assert!(!short, "{name}: {} ends at {reached}", trial.label);
                converged += 1;
                in_parts += u32::from(stepper.state().next.increment > failed.next.increment + 1);
            }
        }
    }
    assert!(converged > 10 && in_parts > 0, "{converged} {in_parts}");
}

#[test]
fn no_remedy_that_ends_against_a_law_is_called_converged() {
    // Nothing is accepted against a law but what the user holds: so a node is held where it does not belong.
    let (mut sound, mut against) = (0, 0);
    for (name, held) in [
        ("osc-inclined-cantilever", None),
        ("osc-inclined-cantilever", Some(Mode::Fixed)),
        ("osc-inclined-cantilever", Some(Mode::Sliding)),
        ("osc-drag65", None),
        ("osc-three10", Some(Mode::Fixed)),
    ] {
        let mut stepper = failed(name);
        if let Some(mode) = held {
            let (slave, hold) = (0, true);
            let force = Intervention::Force { slave, mode, hold };
            stepper.intervene(&force).unwrap();
        }
        let failed = stepper.state().clone();
        for remedy in remedies::all(&mut stepper, &failed, None, &|| false) {
            let trial = remedies::attempt(&mut stepper, &failed, None, &remedy, &|| false).unwrap();
            let verdict = stepper.state().start.verdict;
            let broken = verdict.is_some_and(|verdict| verdict.broken().next().is_some());
            assert!(
                !broken || matches!(trial.end, TrialEnd::Against(_)),
                "{name}: {trial:?}"
            );
            sound += u32::from(verdict.is_some() && !broken);
            against += u32::from(broken);
        }
    }
    assert!(
        sound > 10 && against > 10,
        "{sound} sound, {against} against a law"
    );
}
