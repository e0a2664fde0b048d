//! Scenes damaged at random: whatever is in the file or set from outside, there is an answer and no panic.

use crate::scenes::{EVERYTHING, assert_usable};
use proptest::prelude::*;
use stickslip::format::paths;
use stickslip::scene::cost::Cost;
use stickslip::scene::{Scene, builtin};

fn try_text(text: &str) {
    match Scene::from_text("x", text, &[]) {
        Ok(scene) => {
            assert_usable(&scene.model);
            let _ = Cost::from_scene(&scene).to_string();
            let _ = paths::list(&scene.spec);
        }
        Err(error) => {
            assert!(error.to_string().starts_with("x:"), "{error}");
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}

/// Numbers as damage.
const NUMBERS: [&str; 14] = [
    "NaN",
    "inf",
    "-inf",
    "-1",
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "99999999999999999999999999",
    "18446744073709551615",
    "4294967296",
    "0x7f",
    "\"1\"",
];

/// Byte ranges of the numbers in a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let part = |k: usize| bytes[k].is_ascii_digit() || matches!(bytes[k], b'.' | b'-');
    let mut found = Vec::new();
    let mut k = 0;
    while k < bytes.len() {
        let start = k;
        while k < bytes.len() && part(k) {
            k += 1;
        }
        if bytes[start..k].iter().any(u8::is_ascii_digit) {
            found.push(start..k);
        }
        k = k.max(start + 1);
    }
    found
}

/// One way to damage a text.
#[derive(Debug, Clone)]
enum Damage {
    Delete(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    Insert(prop::sample::Index, String),
    Number(prop::sample::Index, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    let index = any::<prop::sample::Index>;
    prop_oneof![
        (index(), 1usize..40).prop_map(|(at, length)| Damage::Delete(at, length)),
        (index(), 1usize..200).prop_map(|(at, length)| Damage::Repeat(at, length)),
        (index(), "[](){}\",:./*@ a-zA-Z0-9é-]{1,6}")
            .prop_map(|(at, text)| Damage::Insert(at, text)),
        (index(), 0..NUMBERS.len()).prop_map(|(at, which)| Damage::Number(at, which)),
        (index(), 0..NUMBERS.len()).prop_map(|(at, which)| Damage::Number(at, which)),
    ]
}

fn damaged(text: &str, damage: &Damage) -> String {
    let border = |mut k: usize| {
        while !text.is_char_boundary(k) {
            k += 1;
        }
        k
    };
    let slice = |at: &prop::sample::Index, length: usize| {
        let start = border(at.index(text.len() + 1));
        start..border((start + length).min(text.len()))
    };
    match damage {
        Damage::Delete(at, length) => {
            let cut = slice(at, *length);
            format!("{}{}", &text[..cut.start], &text[cut.end..])
        }
        Damage::Repeat(at, length) => {
            let cut = slice(at, *length);
            format!("{}{}", &text[..cut.end], &text[cut.start..])
        }
        Damage::Insert(at, what) => {
            let start = slice(at, 0).start;
            format!("{}{what}{}", &text[..start], &text[start..])
        }
        Damage::Number(at, which) => {
            let found = numbers(text);
            if found.is_empty() {
                return text.to_owned();
            }
            let cut = &found[at.index(found.len())];
            format!(
                "{}{}{}",
                &text[..cut.start],
                NUMBERS[*which],
                &text[cut.end..]
            )
        }
    }
}

fn a_good_scene() -> impl Strategy<Value = String> {
    let mut texts: Vec<String> = builtin::list()
        .iter()
        .map(|scene| scene.text.to_owned())
        .collect();
    texts.push(EVERYTHING.into());
    prop::sample::select(texts)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_answered(text in "\\PC{0,200}") {
        try_text(&text);
    }

    #[test]
    fn any_bytes_are_answered(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        try_text(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_damage_is_answered(text in a_good_scene(), damages in prop::collection::vec(damage(), 1..4)) {
        let text = damages.iter().fold(text, |text, one| damaged(&text, one));
        try_text(&text);
    }

    #[test]
    fn any_setting_is_answered(
        text in a_good_scene(),
        which in any::<prop::sample::Index>(),
        value in prop_oneof![prop::sample::select(NUMBERS.to_vec()).prop_map(str::to_owned), "\\PC{0,12}"],
    ) {
        let scene = Scene::from_text("x", &text, &[]).unwrap();
        let listed = paths::list(&scene.spec);
        let path = &listed[which.index(listed.len())].path;
        match scene.with(path, &value) {
            Ok(scene) => assert_usable(&scene.model),
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }

    #[test]
    fn any_name_of_a_node_is_answered(name in any_name()) {
        let scene = Scene::from_text("x", EVERYTHING, &[]).unwrap();
        let own = scene.model.nodes.iter().position(|node| node.name == name);
        match scene.node(&name) {
            Ok(node) => {
                prop_assert!(node < scene.model.nodes.len());
                prop_assert!(own.is_none_or(|own| own == node), "{} is node {}", name, node);
                prop_assert_eq!(scene.names().nodes(&name), Ok(vec![node]));
            }
            Err(message) => {
                prop_assert!(own.is_none(), "{}", message);
                prop_assert!(message.len() > 10 && !message.contains('\n'), "{}", message);
            }
        }
    }
}

/// Names that nodes have, names near to these, and others.
fn any_name() -> impl Strategy<Value = String> {
    let scene = Scene::from_text("x", EVERYTHING, &[]).unwrap();
    let names = scene.model.nodes.iter().map(|node| node.name.clone());
    let own = prop::sample::select(names.collect::<Vec<_>>());
    prop_oneof![
        own,
        "[abctkrhi][.](start|end|all|[0-9]{1,2})",
        "[a-z]{0,3}[.@]?[-0-9a-z.]{0,6}"
    ]
}

#[test]
fn nodes_of_a_line_are_counted_from_its_start() {
    let scene = Scene::from_text("x", EVERYTHING, &[]).unwrap();
    let at = |name: &str| scene.node(name).map(|node| scene.model.nodes[node].at);
    for place in 1..=9 {
        let x = 0.5 * (place - 1) as f64;
        assert_eq!(at(&format!("b.{place}")), Ok([x, 0.0]));
    }
    assert_eq!((at("b.start"), at("b.end")), (at("b.1"), at("b.9")));
    for wrong in ["b.0", "b.10", "b.all", "b", "q.1", "b.x"] {
        assert!(at(wrong).is_err(), "{wrong}");
    }
}
