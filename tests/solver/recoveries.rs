//! Which recoveries and strategies scenes need, judged by leaving each out.

use crate::common;
use crate::needs::{needs, run};
use std::collections::BTreeSet;
use stickslip::step::recovery;

/// A built-in scene and what is changed in it.
type Changed = (&'static str, &'static [(&'static str, &'static str)]);

/// Scenes whose runs need help: those that oscillate, on the ladder, and limit points under load, with jumps and along the path.
const SCENES: [Changed; 14] = [
    ("osc-big-step", LADDER),
    ("osc-block-slide", LADDER),
    ("osc-border", LADDER),
    ("osc-drag65", LADDER),
    ("osc-inclined-cantilever", LADDER),
    ("osc-snap", LADDER),
    ("osc-three10", LADDER),
    ("osc-touch2", LADDER),
    ("osc-two-many", LADDER),
    ("osc-zig3", LADDER),
    (
        "05-cantilever-elastic-block",
        &[
            ("history.increment", "0.5"),
            ("settings.strategy", "ladder"),
        ],
    ),
    (
        "02-two-cantilevers-rough",
        &[("friction.angle", "10"), ("refine", "2")],
    ),
    (
        "02-two-cantilevers-rough",
        &[
            ("friction.angle", "10"),
            ("refine", "2"),
            ("history.jumps", "dynamic"),
        ],
    ),
    (
        "02-two-cantilevers-rough",
        &[
            ("friction.angle", "10"),
            ("refine", "2"),
            ("history.control", "arc"),
        ],
    ),
];

/// Scenes that only the search solves.
const SEARCHED: [&str; 6] = [
    "die",
    "frozen-geometry-diverges",
    "stack-of-50-blocks",
    "modes-cycle-at-the-least-increment",
    "moves-to-another-equilibrium",
    "path-ends-behind-the-end-of-a-surface",
];

const LADDER: &[(&str, &str)] = &[("settings.strategy", "ladder")];

#[test]
fn what_scenes_need_is_found_by_leaving_each_recovery_and_strategy_out() {
    let (mut ever_used, mut ever_needed) = (BTreeSet::new(), BTreeSet::new());
    let own = SCENES.map(|(name, set)| {
        let mut set = set.to_vec();
        set.push(("settings.search", "off"));
        (name.to_owned(), set)
    });
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/findings/");
    let searched = SEARCHED.map(|name| (format!("{folder}{name}.ron"), Vec::new()));
    for (name, set) in own.iter().chain(&searched) {
        let scene = common::scene(name, set);
        let (ends, used) = run(&scene, None);
        assert!(ends, "{name} {set:?}");
        let needed = needs(&scene, &used);
        println!("{name} {set:?}: uses {used:?}, needs {needed:?}");
        ever_used.extend(used);
        ever_needed.extend(needed);
    }
    println!("used {ever_used:?}\nneeded {ever_needed:?}");
    for recovery in [
        "halve",
        "held",
        "release",
        "slower",
        "turn-at-last",
        "whole",
        "touching",
        "deeper",
        // Also gets past the end of the scene that a damped motion finishes.
        "longer",
    ] {
        assert!(
            ever_needed.contains(recovery),
            "{recovery}: {ever_needed:?}"
        );
    }
    // The last half is tried again only before a failure.
    let idle = recovery::names().filter(|name| !ever_used.contains(*name));
    let idle: Vec<&str> = idle.filter(|name| !ever_needed.contains(*name)).collect();
    assert_eq!(idle, ["back"]);
}
