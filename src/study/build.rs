//! Sets the revision of the program: `STICKSLIP_REVISION` if set, otherwise the output of git for the work
//! tree, but only in optimised builds, so that a commit does not rebuild all tests.

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

/// The last commit, marked if the work tree differs; `None` without git.
fn described() -> Option<String> {
    let arguments = ["describe", "--always", "--dirty"];
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let text = text.trim();
    (output.status.success() && !text.is_empty()).then(|| text.to_owned())
}
