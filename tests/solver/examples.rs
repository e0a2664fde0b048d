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
fn x() {
    println!("{}", written!(force_a_mode));
    println!("{}", written!(interface_problem));
    println!("{}", written!(step_a_scene));
    println!("{}", written!(strategy));
    println!("{}", written!(study));
}
