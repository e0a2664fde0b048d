//! The page `protocol`: every message on it is one.

use stickslip::manual;
use stickslip_exchange::attach::{Answer, Request};

/// The JSON values on a page, one after the other, from its blocks of JSON.
fn messages(page: &str) -> Vec<serde_json::Value> {
    let blocks = page.split("```json\n").skip(1);
    let texts = blocks.filter_map(|rest| rest.split("```").next());
    texts
        .flat_map(|text| {
            serde_json::Deserializer::from_str(text)
                .into_iter()
                .map(|value| value.unwrap_or_else(|why| panic!("{why}: {text}")))
                .collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn every_message_on_the_page_of_the_protocol_is_read_whole() {
    let page = manual::page("protocol").expect("the page exists").text();
    let all = messages(page);
    assert!(all.len() > 18, "{} messages", all.len());
    let mut kinds = std::collections::BTreeSet::new();
    for value in all {
        let line = value.to_string();
        let request = Request::read(&line).ok().map(|request| request.line());
        let answer = Answer::read(&line).ok().map(|answer| answer.line());
        let keys = value.as_object().expect("a message is an object");
        // Nothing of it is passed over: all keys come back.
        let whole = |told: &String| {
            let told: serde_json::Value = serde_json::from_str(told).expect("our own line");
            keys.keys().all(|key| told.get(key).is_some())
        };
        assert!(request.iter().chain(&answer).any(whole), "{line}");
        kinds.insert(value["type"].to_string());
    }
    assert_eq!(kinds.len(), 17, "all messages are shown: {kinds:?}");
}

#[test]
fn the_schema_has_every_key_of_the_page_and_requires_what_the_reader_requires() {
    let schema: serde_json::Value = serde_json::from_str(stickslip::attach::SCHEMA).expect("JSON");
    let page = manual::page("protocol").expect("the page exists").text();
    let answers = messages(page);
    // Only the debugger's hello has `reads`.
    let is_answer = |value: &&serde_json::Value| {
        value.get("reads").is_none() && Answer::read(&value.to_string()).is_ok()
    };
    let answers = answers.iter().filter(is_answer);
    let mut kinds = std::collections::BTreeSet::new();
    for answer in answers {
        let kind = answer["type"].as_str().expect("a text");
        kinds.insert(kind);
        let definition = &schema["$defs"][kind];
        let is_required = |key: &String| {
            let required = definition["required"].as_array();
            required.is_some_and(|all| all.iter().any(|name| name == key))
        };
        for key in answer.as_object().expect("an object").keys() {
            assert!(definition["properties"].get(key).is_some(), "{kind}.{key}");
            let mut without = answer.clone();
            without.as_object_mut().expect("an object").remove(key);
            let is_read = Answer::read(&without.to_string()).is_ok();
            assert_eq!(is_read, !is_required(key), "{kind}.{key}");
        }
    }
    let defined = schema["oneOf"].as_array().expect("a list").len();
    assert_eq!(kinds.len(), defined, "{kinds:?}");
}
