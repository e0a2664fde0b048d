//! Solvers that are attached, good ones and rude ones, without anything installed.
//!
//! The solvers on the other side are this program itself, started again with a first argument that says what it is to be:
//! [`rude`], [`filter`] or [`version_1`]. That is why it has a `main` of its own.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;

mod checked;
mod faults;
mod filter;
mod floods;
mod kept;
mod loops;
mod rude;
mod served;
mod side;
mod space;
mod version_1;

use libtest_mimic::{Arguments, Trial};
use std::process::ExitCode;

/// Functions as tests.
#[macro_export]
macro_rules! tests {
    ($($test:ident),* $(,)?) => {
        vec![$(libtest_mimic::Trial::test(
            concat!(module_path!(), "::", stringify!($test)),
            || {
                $test();
                Ok(())
            },
        )),*]
    };
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((first, rest)) if first == rude::NAME => return rude::main(rest),
        Some((first, rest)) if first == filter::NAME => return filter::main(rest),
        Some((first, rest)) if first == version_1::NAME => return version_1::main(rest),
        _ => {}
    }
    let mut tests: Vec<Trial> = faults::tests();
    tests.extend(floods::tests());
    tests.extend(loops::tests());
    tests.extend(served::tests());
    tests.extend(kept::tests());
    tests.extend(checked::tests());
    tests.extend(space::tests());
    tests.extend(version_1::tests());
    libtest_mimic::run(&Arguments::from_args(), tests).exit_code()
}
