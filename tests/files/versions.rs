//! The Rust version that the packages declare is true: nothing that they are built from wants a newer one. `.ci/run` asks for
//! that version, and checks with it where it is installed.

use std::process::Command;

/// A locked package: its name, the Rust that it wants (0 where it does not say), and whether it is one of ours.
#[derive(Debug, PartialEq)]
struct Package {
    name: String,
    wants: [u32; 3],
    ours: bool,
}

/// 1.89 as 1, 89, 0.
fn version(text: &str) -> [u32; 3] {
    let mut parts = text.split('.').map(|part| part.parse().unwrap());
    [(); 3].map(|()| parts.next().unwrap_or(0))
}

/// The text between the first `from` and the `"` after it.
fn between<'a>(text: &'a str, from: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(from)?;
    rest.split_once('"').map(|(value, _)| value)
}

/// The packages in what `cargo metadata` tells. Only a package's name is followed by its version.
fn packages(told: &str) -> Vec<Package> {
    let mut packages: Vec<Package> = Vec::new();
    for piece in told.split("{\"name\":\"") {
        let (name, rest) = piece.split_once('"').unwrap_or_default();
        if rest.starts_with(",\"version\":\"") {
            packages.push(Package {
                name: name.to_owned(),
                wants: [0; 3],
                ours: rest.contains("\"source\":null"),
            });
        }
        if let (Some(last), Some(wants)) =
            (packages.last_mut(), between(rest, "\"rust_version\":\""))
        {
            last.wants = version(wants);
        }
    }
    packages
}

/// What a command says, having ended well.
fn said(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    String::from_utf8(output.stdout).unwrap()
}

/// All that the program and its tests are built from on this machine, as cargo knows it without a network.
fn locked() -> Vec<Package> {
    let rustc = said("rustc", &["-vV"]);
    let host = rustc
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .unwrap();
    let cargo = std::env::var("CARGO").unwrap_or("cargo".into());
    packages(&said(
        &cargo,
        &[
            "metadata",
            "--locked",
            "--offline",
            "--format-version",
            "1",
            "--filter-platform",
            host,
        ],
    ))
}

const DECLARED: &str = env!("CARGO_PKG_RUST_VERSION");

#[test]
fn no_locked_package_wants_a_newer_rust_than_ours_declare() {
    let packages = locked();
    assert!(packages.len() > 100, "{packages:#?}");
    assert!(packages.iter().any(|p| p.wants > [0; 3] && !p.ours));
    let newer: Vec<_> = packages
        .iter()
        .filter(|package| package.wants > version(DECLARED))
        .collect();
    assert!(newer.is_empty(), "Rust {DECLARED} is declared: {newer:#?}");
}

#[test]
fn all_packages_here_and_the_checks_before_a_change_name_one_rust_version() {
    let ours: Vec<_> = locked().into_iter().filter(|p| p.ours).collect();
    assert!(ours.len() >= 2, "{ours:#?}");
    for package in ours {
        assert_eq!(package.wants, version(DECLARED), "{}", package.name);
    }
    let run = concat!(env!("CARGO_MANIFEST_DIR"), "/.ci/run");
    // Published sources are without it.
    if let Ok(text) = std::fs::read_to_string(run) {
        let wanted = text.lines().find_map(|line| line.strip_prefix("wanted="));
        assert_eq!(wanted, Some(DECLARED));
        assert!(text.contains("cargo \"+$oldest\" check --locked"), "{text}");
    }
}

#[test]
fn the_rust_that_a_package_wants_is_read_from_what_cargo_tells() {
    let told = concat!(
        r#"{"packages":[{"name":"a","version":"0.2.0","id":"a","source":"registry","dependencies":[{"name":"b","#,
        r#""source":null,"req":"^1"}],"targets":[{"name":"a","src_path":"/"}],"edition":"2024","rust_version":"1.9"},"#,
        r#"{"name":"b","version":"1.0.0","id":"b","source":null,"targets":[{"name":"b"}],"rust_version":null}]}"#,
    );
    let package = |name: &str, wants, ours| Package {
        name: name.to_owned(),
        wants,
        ours,
    };
    let expected = [package("a", [1, 9, 0], false), package("b", [0; 3], true)];
    assert_eq!(packages(told), expected);
    assert!(version("1.89") < version("1.89.1") && version("1.9") < version("1.88.0"));
}
