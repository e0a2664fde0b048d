//! What a stuck node holds on to: its drift from the point where it stuck, with an anchor and by the paper's increments.

use crate::common::{Run, run, scene};

/// Problem 05 with a little friction: nodes stick and slide by turns on a master that bends and turns.
const BLOCK: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/problems/studies/drift-block.ron"
);

/// A run of [`BLOCK`], and the largest drift in it over the scene's length.
fn drift(increment: &str, sticking: &str, slip: &str) -> (Run, f64) {
    let set = [
        ("history.increment", increment),
        ("settings.sticking", sticking),
        ("settings.slip", slip),
    ];
    let run = run(&scene(BLOCK, &set));
    assert!(run.failure.is_none(), "{set:?}: {:?}", run.failure);
    let largest = run
        .accepted
        .iter()
        .fold(0.0_f64, |most, a| most.max(a.monitors["drift"].abs()));
    let length = run.stepper.model().length;
    (run, largest / length)
}

#[test]
fn anchored_nodes_do_not_drift_and_others_do_in_third_order_of_the_increment() {
    let (mut before, mut compared) = (None, 0);
    for increment in ["0.2", "0.1", "0.05"] {
        let (held, anchored) = drift(increment, "anchored", "increment");
        assert!(anchored < 1e-14, "{increment}: {anchored}");
        let (loose, drifted) = drift(increment, "increments", "increment");
        assert!(drifted > 1e-9, "{increment}: {drifted}");
        if let Some(before) = before.replace(drifted) {
            let order = f64::log2(before / drifted);
            assert!((2.7..3.3).contains(&order), "{increment}: order {order}");
        }
        // It costs nothing, and moves the result by no more than what drifted; but what drifts is never refused, and so
        // never cut.
        let majors = |run: &Run| run.accepted.iter().map(|a| a.majors).sum::<u32>();
        let cut = held.accepted.len() > loose.accepted.len();
        assert!(cut || majors(&held) <= majors(&loose), "{increment}");
        if cut {
            continue;
        }
        compared += 1;
        let end = |run: &Run| run.accepted.last().unwrap().monitors["u_x"];
        assert!((end(&held) - end(&loose)).abs() < drifted * held.stepper.model().length);
    }
    assert_eq!(compared, 2, "only the largest increment is cut");
}

#[test]
fn slip_counted_over_a_major_iteration_lets_nodes_come_to_rest_elsewhere_whatever_the_increment() {
    let [coarse, fine] = ["0.1", "0.05"].map(|size| drift(size, "increments", "major").1);
    assert!(coarse > 1e-3 && fine > 0.5 * coarse, "{coarse} {fine}");
}

#[test]
fn a_node_that_sticks_all_along_does_not_drift_without_an_anchor_either() {
    for geometry in ["consistent", "frozen"] {
        for sticking in ["anchored", "increments"] {
            let set = [
                ("settings.geometry", geometry),
                ("settings.sticking", sticking),
                ("history.increment", "0.25"),
                // Where the line gives under the node, that moves against it, and only an anchor takes it back.
                ("settings.point_force", "plain"),
            ];
            let run = run(&scene("02-two-cantilevers-rough", &set));
            assert!(run.failure.is_none(), "{set:?}: {:?}", run.failure);
            let length = run.stepper.model().length;
            for a in &run.accepted {
                let drift = a.state.nodes[0].drift / length;
                assert!(drift.abs() < 1e-14, "{set:?}, load {}: {drift}", a.load);
                assert_eq!(a.state.nodes[0].anchor, a.state.start.nodes[0].anchor);
            }
        }
    }
}

#[test]
fn the_anchor_is_a_part_of_the_state_and_is_gone_with_the_contact() {
    let run = run(&scene(
        "03-distant-cantilevers",
        &[("friction.angle", "30")],
    ));
    let (mut held, mut free) = (0, 0);
    for a in &run.accepted {
        for node in &a.state.nodes {
            let touches = node.mode != stickslip::model::Mode::Free;
            assert_eq!(node.anchor.is_some(), touches, "load {}", a.load);
            held += u32::from(touches);
            free += u32::from(!touches);
        }
        let text = ron::to_string(&a.state).unwrap();
        assert_eq!(
            ron::from_str::<stickslip::step::state::State>(&text).unwrap(),
            a.state
        );
    }
    assert!(held > 10 && free > 10);
}
