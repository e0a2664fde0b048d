//! The examples of the library run, and write what they promise.

#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/attach.rs"]
mod attach;
#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/force_a_mode.rs"]
mod force_a_mode;
#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/interface_problem.rs"]
mod interface_problem;
#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/step_a_scene.rs"]
mod step_a_scene;
#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/strategy.rs"]
mod strategy;
#[allow(dead_code, reason = "the test calls what main calls")]
#[path = "../examples/study.rs"]
mod study;

macro_rules! written {
    ($example:ident) => {{
        let mut out = Vec::new();
        $example::run(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }};
}

#[test]
fn a_scene_is_stepped_to_its_end() {
    let out = written!(step_a_scene);
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines.len(), 8, "{out}");
    assert_eq!(
        lines[3],
        "P = 0.2500: Sliding, F_n = 0.15895, F_t = -0.09177, u_x = -0.012701, after 3 minor iterations"
    );
    assert_eq!(
        lines[5],
        "P = 0.1250: Fixed, F_n = 0.15895, F_t = 0.03323, u_x = -0.012701, after 1 minor iterations"
    );
    assert!(lines[7].starts_with("P = 0.0000: Sliding"), "{out}");
}

#[test]
fn an_interface_problem_without_bodies_has_one_consistent_state_and_is_stepped_to_it() {
    let friction = 20_f64.to_radians().tan() * 20.0;
    // K w = p + F along t, node 1 stuck: 120 slip = 30 − friction.
    let slip = (30.0 - friction) / 120.0;
    let (f_0, f_1) = (format!("{friction:.4}"), format!("{:.4}", 20.0 * slip));
    let expected = format!(
        "XX: node 0 breaks WithinLimit by {:.3}\n\
         16 assumptions tried, 1 consistent\n\
         Plus: F_n = 20.0000, F_t = {f_0}, slip = {slip:.5}\n\
         Fixed: F_n = 20.0000, F_t = {f_1}, slip = 0.00000\n\
         stepped: Finished\n\
         Sliding: F_n = 20.0000, F_t = {f_0}\n\
         Fixed: F_n = 20.0000, F_t = {f_1}\n",
        30.0 - friction,
    );
    assert_eq!(written!(interface_problem), expected);
}

#[test]
fn a_strategy_from_outside_finishes_where_table_2_cycles() {
    assert_eq!(
        written!(strategy),
        "Table 2: Failed(Cycle(Cycle { start: 1, period: 2, members: [(0, [Free, Fixed])] }))\n\
         fixed → sliding: a fixed node never opens at once\nthe strategy: Finished\n"
    );
}

#[test]
fn a_forced_mode_carries_a_scene_over_a_singular_start() {
    assert_eq!(
        written!(force_a_mode),
        "free: nothing holds beam\nsliding: Finished after 50 increments\n"
    );
}

#[test]
fn a_study_runs_a_scene_with_several_frictions() {
    assert_eq!(
        written!(study),
        "20 degrees: u_x = -0.014700 at P = 0.250, Finished\n\
         30 degrees: u_x = -0.012701 at P = 0.250, Finished\n\
         40 degrees: u_x = -0.010887 at P = 0.250, Finished\n"
    );
}

#[test]
fn a_solver_of_ones_own_is_stepped_forced_and_gone_back_with() {
    let out = written!(attach);
    // K u = f + p with the first three nodes on the floor: f_1 = 100 · 0.01 + 5, and the fourth hangs at (5 + 3) / 200.
    assert!(
        out.contains("1.3 SSSO F_n = 6.000 5.000 1.000 0.000, accepted\n"),
        "{out}"
    );
    // With the third held away its springs pull at the second: 300 u_3 = 100 (u_2 + u_4) − 5, 200 u_4 = 100 u_3 − 5.
    let u_3 = (-1.0 - 2.5 - 5.0) / 250.0;
    let f_2 = 5.0 - 3.0 - 100.0 * u_3;
    assert!(
        out.contains(&format!(
            "1.3 SSOO F_n = 6.000 {f_2:.3} 0.000 0.000, accepted\n"
        )),
        "{out}"
    );
    // The way without it is there as before, and goes on.
    assert!(
        out.ends_with("2.1 SSSO F_n = 11.000 10.000 8.500 0.000, accepted\nin b1: start, step 4\n"),
        "{out}"
    );
}
