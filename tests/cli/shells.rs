//! Shells complete command lines, and man shows the pages.

use super::program::{code, err, names, out, program, refused, well};
use std::path::Path;
use std::process::{Command, Stdio};

/// Whether a program is there; where it is not, the test says that it looked at nothing.
fn is_there(name: &str) -> bool {
    let tried = Command::new(name)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if tried.is_err() {
        eprintln!("skipped: there is no {name} on this machine");
    }
    tried.is_ok()
}

/// The folder of the program, as a shell looks for it.
fn path() -> String {
    let folder = Path::new(env!("CARGO_BIN_EXE_stickslip")).parent().unwrap();
    let others = std::env::var("PATH").unwrap_or_default();
    format!("{}:{others}", folder.display())
}

/// What a shell says after the script, in an empty folder with a file and a folder of its own.
fn shell(name: &str, arguments: &[&str]) -> Vec<String> {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("my scene.ron"), "").unwrap();
    std::fs::create_dir(place.path().join("mine")).unwrap();
    let output = Command::new(name)
        .args(arguments)
        .env("PATH", path())
        .env("HOME", place.path())
        .current_dir(place.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", err(&output));
    out(&output).lines().map(str::to_owned).collect()
}

/// What bash makes of a line when Tab is pressed at its end, breaking words as it does.
fn bash(line: &str) -> Vec<String> {
    let tab = r#"
        source <(stickslip completions bash)
        COMP_LINE=$1 COMP_POINT=${#1}
        read -ra COMP_WORDS <<< "${1//=/ = }"
        [[ $1 == *[[:space:]] ]] && COMP_WORDS+=("")
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        complete -p stickslip > /dev/null
        _stickslip stickslip "${COMP_WORDS[COMP_CWORD]}" ""
        for word in "${COMPREPLY[@]}"; do echo "$word"; done
    "#;
    shell("bash", &["--norc", "-c", tab, "bash", line])
}

#[test]
fn bash_completes_what_the_program_knows() {
    if !is_there("bash") {
        return;
    }
    for (line, all) in [
        ("stickslip osc-sn", &["osc-snap"][..]),
        ("stickslip rem", &["remedies"]),
        ("stickslip study fig-08", &["fig-08-increment"]),
        ("stickslip lesson tab", &["table-2"]),
        ("stickslip help limit", &["limit-points"]),
        ("stickslip chart osc-snap --cost m", &["minors"]),
        (
            "stickslip map osc-snap --strategies ladder,table",
            &["ladder,table2"],
        ),
        ("stickslip run my", &["my\\ scene.ron"]),
        ("stickslip completions e", &["elvish"]),
    ] {
        assert_eq!(bash(line), all, "{line}");
    }
}

#[test]
fn bash_completes_paths_of_the_scene_and_their_values_across_the_sign_between() {
    if !is_there("bash") {
        return;
    }
    let paths = bash("stickslip run osc-snap --set friction.");
    assert!(paths.contains(&"friction.angle=".to_owned()), "{paths:?}");
    // What bash gets is what follows the sign, since it keeps what stands before it.
    for (line, all) in [
        (
            "stickslip run osc-snap --set settings.t_max=",
            &["lagged", "consistent"][..],
        ),
        (
            "stickslip run osc-snap --set settings.t_max=c",
            &["consistent"],
        ),
        (
            "stickslip osc-snap --set refine=2 --set settings.t_max=l",
            &["lagged"],
        ),
        (
            "stickslip study osc-snap --vary settings.t_max=lagged,c",
            &["lagged,consistent"],
        ),
        (
            "stickslip run no-such-scene --set settings.t_max=l",
            &["lagged"],
        ),
    ] {
        assert_eq!(bash(line), all, "{line}");
    }
}

#[test]
fn fish_completes_with_what_things_are() {
    if !is_there("fish") {
        return;
    }
    let fish = |line: &str| {
        let tab = "stickslip completions fish | source; complete -C $argv[1]";
        shell("fish", &["--no-config", "-c", tab, line])
    };
    let found = fish("stickslip osc-sn");
    assert!(found[0].starts_with("osc-snap\t"), "{found:?}");
    assert_eq!(
        fish("stickslip run osc-snap --set settings.t_max=c"),
        ["settings.t_max=consistent"]
    );
}

#[test]
fn zsh_takes_its_script() {
    if !is_there("zsh") {
        return;
    }
    let load = "autoload -U compinit; compinit -D; source <(stickslip completions zsh); print $_comps[stickslip]";
    assert_eq!(
        shell("zsh", &["-fc", load]),
        ["_clap_dynamic_completer_stickslip"]
    );
}

#[test]
fn every_shell_has_a_script_that_asks_the_program_and_an_unknown_one_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let ask = |shell: &str| {
        program(place.path(), &["completions", shell])
            .output()
            .unwrap()
    };
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = well(&ask(shell));
        assert!(script.contains("STICKSLIP_COMPLETE"), "{shell}: {script}");
    }
    let refused = ask("tcsh");
    assert_eq!(code(&refused), 2);
    assert!(err(&refused).contains("tcsh") && err(&refused).contains("powershell"));
}

#[test]
fn man_has_a_page_of_each_subcommand_and_overwrites_none_unasked() {
    let place = tempfile::tempdir().unwrap();
    let write = |force: &[&str]| {
        let arguments = [&["man", "-o", "share/man1"], force].concat();
        program(place.path(), &arguments).output().unwrap()
    };
    well(&write(&[]));
    let folder = place.path().join("share/man1");
    let pages = names(&folder);
    for page in [
        "stickslip.1",
        "stickslip-run.1",
        "stickslip-map.1",
        "stickslip-man.1",
    ] {
        assert!(pages.contains(&page.to_owned()), "{pages:?}");
    }
    let again = write(&[]);
    refused(&again, "--force");
    well(&write(&["--force"]));
    assert_eq!(well(&program(place.path(), &["man"]).output().unwrap()), {
        std::fs::read_to_string(folder.join("stickslip.1")).unwrap()
    });
    if !is_there("man") {
        return;
    }
    for page in pages {
        let shown = Command::new("man")
            .args(["-l", "--warnings"])
            .arg(folder.join(&page))
            .env("MANPAGER", "cat")
            .env("MANWIDTH", "80")
            .output()
            .unwrap();
        let text = well(&shown);
        let name = page.trim_end_matches(".1");
        assert!(
            text.contains("SYNOPSIS") && text.contains(name),
            "{page}: {text}"
        );
    }
}
