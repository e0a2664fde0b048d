//! The law at a border between two sides: what a node bears there that slid onto it. Kinks go to zero, increments too; the solver,
//! its judge and the judge from outside agree.

use crate::common::{Run, run, scene};
use crate::outside::judge::Corner;
use crate::outside::trial::{End, attempt};
use proptest::prelude::*;
use stickslip::contact::corner::{
    Side, beyond_corner, beyond_slid, half_angle, least_friction, widened,
};
use stickslip::contact::table2::Rule;
use stickslip::explain::audit::Audit;
use stickslip::model::Friction;
use stickslip::scene::Scene;

/// Walked towards −x, so that the outside is up.
const T: [f64; 2] = [-1.0, 0.0];

/// A force on a node that slid along t: F_n, and the friction s F_t against that slip.
fn force(f_n: f64, against: f64) -> [f64; 2] {
    [against, f_n]
}

/// Amounts against the law after a slip along t, and without one, from the core and from outside.
fn beyond(friction: &Friction, half: f64, force: [f64; 2]) -> [[f64; 2]; 2] {
    let [before, behind] = Side::pair([0.0, 1.0], half, friction);
    let outside = Corner::with(T, half, friction);
    [
        [
            beyond_slid(force, [&before, &behind], -1.0),
            outside.beyond_slid(force, -1.0),
        ],
        [
            beyond_corner(force, [&before, &behind]),
            outside.beyond_held(force),
        ],
    ]
}

prop_compose! {
    fn a_friction()(angle in 0.0..60.0_f64, cohesion in prop_oneof![Just(0.0), 0.0..2.0_f64]) -> Friction {
        Friction { angle, cohesion }
    }
}

/// Kinks from 1e-9 to 0.1, evenly by their logarithm.
fn a_kink() -> impl Strategy<Value = f64> {
    (-9.0..-1.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// What the law allows lies within the kink of Coulomb's law on a straight side, and what that allows is within the kink of
    /// what the law allows.
    #[test]
    fn allowed_forces_are_within_the_kink_of_coulombs(
        friction in a_friction(),
        kink in a_kink(),
        along in 1e-3..10.0_f64,
        times in prop_oneof![-3.0..3.0_f64, -1e9..1e9_f64],
    ) {
        let phi = friction.angle.to_radians();
        let (sin, cos) = phi.sin_cos();
        // On the line of sliding, and off it by a number of kinks.
        let size = along + friction.cohesion;
        let off = times * kink * size;
        let line = [along * cos, along * sin + friction.cohesion];
        let whole = force(line[0] - off * sin, line[1] + off * cos);
        let [slid, held] = beyond(&friction, 0.5 * kink, whole);
        let tiny = 1e-13 * size.max(off.abs());
        for amount in slid {
            if off.abs() > kink * (size + off.abs()) + tiny {
                prop_assert!(amount > 0.0, "allowed, {times} kinks off: {slid:?}");
            }
            if times.abs() < 1e-3 {
                prop_assert!(amount <= kink * size, "{slid:?}");
            }
        }
        for amount in held {
            if off > kink * (size + off) + tiny {
                prop_assert!(amount > 0.0, "allowed, {times} kinks beyond the cone: {held:?}");
            }
            if times.abs() < 1e-3 {
                prop_assert!(amount <= tiny, "{held:?}");
            }
        }
        let pull = force(-line[0] - kink * size, line[1] - 2.0 * friction.cohesion);
        let [slid, held] = beyond(&friction, 0.5 * kink, pull);
        prop_assert!(slid.into_iter().chain(held).all(|amount| amount > 0.0), "{slid:?} {held:?}");
    }

    /// Both judges allow the same, and what the solver holds, they allow.
    #[test]
    fn solver_and_judges_draw_the_same_line(
        friction in a_friction(),
        half in prop_oneof![1e-9..0.05_f64, 0.0..1.5_f64],
        f_n in 0.0..3.0_f64,
        against in -6.0..6.0_f64,
        near in proptest::option::of(-1e-3..1e-3_f64),
    ) {
        let least = least_friction(&friction, half, f_n);
        let against = near.map_or(against, |near| least + near);
        let [slid, held] = beyond(&friction, half, force(f_n, against));
        let tiny = 1e-9;
        for [core, outside] in [slid, held] {
            prop_assert!(core <= tiny || outside > 0.0, "{core} {outside}");
            prop_assert!(outside <= tiny || core > 0.0, "{core} {outside}");
        }
        let wide = widened(&friction, half);
        let most = wide.coefficient() * f_n + wide.cohesion;
        // Beyond what is jammed, T_max is only large.
        if friction.angle + half.to_degrees() < 89.9 {
            prop_assert_eq!(held[0] <= tiny, against.abs() <= most + tiny, "{:?} {}", held, most);
            let holds = least <= against && against <= most;
            prop_assert!(!holds || slid[0] <= tiny, "{slid:?}: {least} {most}");
            let breaks = against < least - 1e-6 || against > most + 1e-6;
            prop_assert!(!breaks || slid[0] > 0.0, "{slid:?}: {least} {most}");
        }
    }
}

/// Scenes in which a node slid onto a border of elements and was held there by what no slip law allows.
const FINDINGS: [&str; 4] = ["302-178", "301-43", "301-99", "303-243"];

fn finding(name: &str, set: &[(&str, &str)]) -> Scene {
    let root = env!("CARGO_MANIFEST_DIR");
    scene(
        &format!("{root}/tests/findings/7-slid-onto-border-{name}.ron"),
        set,
    )
}

#[test]
fn no_node_that_slid_onto_a_border_is_held_there_against_the_law_of_slip() {
    for name in FINDINGS {
        let scene = finding(name, &[]);
        let trial = attempt(&scene);
        assert_eq!(trial.end, End::Finished, "{name}");
        assert!(trial.wrong.is_empty(), "{name}: {:?}", trial.wrong);
    }
}
