//! Sets the revision that the program is built from: `STICKSLIP_REVISION` where that is set, else what git reports of the
//! work tree, but only in an optimised build, so that a commit does not rebuild all tests.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=STICKSLIP_REVISION");
    let optimised = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    for path in [".git/logs/HEAD", "src", "problems", "Cargo.lock"] {
        if optimised {
            println!("cargo::rerun-if-changed=../../{path}");
        }
    }
    let given = env::var("STICKSLIP_REVISION").ok();
    let revision = given.or_else(|| optimised.then(described).flatten());
    let revision = revision.unwrap_or_else(|| "a build without a revision".into());
    println!("cargo::rustc-env=STICKSLIP_REVISION={revision}");
}

/// The last commit, and whether the work tree is another; none without git.
fn described() -> Option<String> {
    let arguments = ["describe", "--always", "--dirty"];
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let text = text.trim();
    (output.status.success() && !text.is_empty()).then(|| text.to_owned())
}
