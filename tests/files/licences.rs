//! What the program is made of may be passed on with it: the licences of all packages, as cargo knows them without a network.

use std::collections::BTreeMap;
use std::process::Command;

/// Licences that ask for no more than to be named.
const ALLOWED: [&str; 10] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "Unlicense",
    "Unicode-3.0",
    "0BSD",
];

/// Packages that are allowed besides. Their licence asks only those who change their own files to publish these.
const BESIDES: [(&str, &str); 1] = [("option-ext ", "MPL-2.0")];

/// Whether one of the ways in which a package may be taken is allowed: all of what stands between AND, one of what stands
/// between OR. An older `/` is an OR.
fn is_allowed(licence: &str) -> bool {
    let licence = licence.replace('/', " OR ");
    let part = |part: &str| {
        let part = part.trim().trim_matches(['(', ')']);
        part.split(" OR ").any(|one| ALLOWED.contains(&one.trim()))
    };
    licence.split(" AND ").all(part)
}

/// Packages with their licences: all that the program and its tests are built from on this machine.
fn packages() -> BTreeMap<String, String> {
    let cargo = std::env::var("CARGO").unwrap_or("cargo".into());
    let output = Command::new(cargo)
        .args([
            "tree",
            "--workspace",
            "--locked",
            "--offline",
            "--prefix",
            "none",
        ])
        .args(["--edges", "normal,build,dev", "--format", "{p}|{l}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let lines = String::from_utf8(output.stdout).unwrap();
    let lines = lines.lines().filter_map(|line| line.split_once('|'));
    lines
        .map(|(name, licence)| (name.to_owned(), licence.trim_end_matches(" (*)").to_owned()))
        .collect()
}

#[test]
fn every_package_has_a_licence_that_lets_the_program_be_passed_on() {
    let packages = packages();
    assert!(packages.len() > 100, "{packages:#?}");
    assert!(packages.keys().any(|name| name.starts_with("faer ")));
    let besides = |name: &str, licence: &str| {
        let same = |(own, theirs): &(&str, &str)| name.starts_with(own) && licence == *theirs;
        BESIDES.iter().any(same)
    };
    let allowed = |name: &str, licence: &str| is_allowed(licence) || besides(name, licence);
    let refused: Vec<_> = packages
        .iter()
        .filter(|(name, licence)| !allowed(name, licence))
        .collect();
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn a_licence_is_allowed_where_one_way_to_take_it_is() {
    for licence in [
        "MIT",
        "MIT OR GPL-3.0",
        "MIT/Apache-2.0",
        "(MIT OR Apache-2.0) AND Unicode-3.0",
    ] {
        assert!(is_allowed(licence), "{licence}");
    }
    for licence in [
        "",
        "GPL-3.0",
        "MIT AND GPL-3.0",
        "MPL-2.0",
        "(MIT OR Apache-2.0) AND GPL-3.0",
    ] {
        assert!(!is_allowed(licence), "{licence}");
    }
}
