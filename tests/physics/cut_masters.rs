//! Masters that are cut at their convex corners: a node that goes past a corner at a depth touches the side that its own faces.

use crate::common::{Run, finished, scene};
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::stepper::Stepper;

const PLUG: &str = "tests/findings/plug-past-a-corner.inp";

fn solved(text: &str) -> Run {
    let scene = Scene::from_text(PLUG, text, &[]).unwrap_or_else(|e| panic!("{e}"));
    finished(&scene)
}

/// The force that the plug is pressed in with.
fn pressed(run: &Run) -> f64 {
    run.accepted.last().unwrap().monitors["contact y"]
}

/// CalculiX 2.21 has 58.8 kN, whether the bush's top face is part of the master or not.
#[test]
fn a_plug_is_pressed_into_a_bore_whose_rim_is_part_of_the_master() {
    let text = std::fs::read_to_string(PLUG).unwrap();
    let whole = solved(&text);
    let force = pressed(&whole);
    assert!((57e3..59e3).contains(&force), "{force}");
    assert!(whole.accepted.len() < 60, "{}", whole.accepted.len());
    let bore = solved(&text.replace("71, S3\n", ""));
    assert!((force / pressed(&bore) - 1.0).abs() < 0.01, "{force}");
}

#[test]
fn a_plug_with_hard_contact_and_a_rim_goes_the_same_way() {
    let text = std::fs::read_to_string(PLUG).unwrap();
    let hard = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n";
    let soft = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e+06\n";
    assert!(text.contains(soft));
    let text = text.replace(soft, hard);
    let (whole, bore) = (solved(&text), solved(&text.replace("71, S3\n", "")));
    let [force, other] = [&whole, &bore].map(pressed);
    assert!((force / other - 1.0).abs() < 0.01, "{force} {other}");
}

/// The count is set by hand: no scene that is left reaches it.
#[test]
fn an_increment_that_is_cut_again_and_again_for_one_node_ends_and_names_it() {
    let scene = scene("tests/findings/7-slid-onto-border-301-43.ron", &[]);
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let (mut before, culprit) = loop {
        let before = stepper.state().clone();
        if let Outcome::Cut { why, .. } = &stepper.step().unwrap().outcome
            && let Some(slave) = why.culprit()
        {
            break (before, slave);
        }
    };
    assert_eq!(stepper.state().recovery.cuts[&culprit], 1);
    before.recovery.cuts.insert(culprit, 300);
    stepper.restore(&before);
    let Outcome::Failed(Failure::CutTooOften { slave, cuts, last }) =
        stepper.step().unwrap().outcome.clone()
    else {
        panic!("{:?}", stepper.event().outcome);
    };
    assert_eq!((slave, cuts), (culprit, 300));
    assert_eq!(last.culprit(), Some(culprit));
}
