//! The examples of the library run, and write what they promise.

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
fn a_strategy_of_ones_own_settles_where_table_2_cycles() {
    assert_eq!(
        written!(strategy),
        "Table 2: Failed(Cycle(Cycle { start: 1, period: 2, members: [(0, [Free, Fixed])] }))\n\
         Free -> Fixed\nFixed -> Sliding\nSliding -> Sliding\n\
         the stepper goes on: Stopped(0.05)\n"
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
