//! The page `protocol`: every message on it is one.

use serde_json::json;
use stickslip::manual;
use stickslip::recorded::decode::{RecordedStep, WireFrame};
use stickslip::scene::Scene;
use stickslip::step::state::State;
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
fn requests_of_a_version_1_exchange_are_written_as_they_were() {
    let text = include_str!("../../problems/lessons/kratos-walk.exchange");
    let of = |sign| text.lines().filter_map(move |line| line.strip_prefix(sign));
    let mut count = 0;
    for line in of("> ") {
        let request = Request::read(line).expect("a request");
        assert_eq!(request.line().trim_end(), line);
        count += 1;
    }
    assert!(count > 50, "{count}");
    for line in of("< ") {
        let written = Answer::read(line).expect("an answer").line();
        let again = Answer::read(&written).expect("an answer of ours").line();
        assert_eq!(again, written);
    }
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

/// The scene and the state in space on the page.
fn in_space() -> [serde_json::Value; 2] {
    let page = manual::page("protocol").expect("the page exists").text();
    let all = messages(page);
    let scene = all.iter().find(|value| value["dimension"] == 3);
    let state = all
        .iter()
        .find(|value| value["contacts"][0]["f_t"].is_array());
    [scene, state].map(|found| found.expect("it is on the page").clone())
}

/// Reads a scene and a state; the error of the first that is invalid.
fn decoded([scene, state]: &[serde_json::Value; 2]) -> Result<RecordedStep, String> {
    let read = |value: &serde_json::Value| Answer::read(&value.to_string());
    let (Ok(Answer::Scene(sent)), Ok(Answer::State(state))) = (read(scene), read(state)) else {
        panic!("{scene} {state}");
    };
    let scene = Scene::from_message("space", &sent, None).map_err(|why| why.to_string())?;
    let ids: Vec<_> = sent
        .contacts
        .iter()
        .map(|contact| contact.id.clone())
        .collect();
    let frame = WireFrame {
        model: &scene.model,
        ids: &ids,
        decides: None,
    };
    let start = State::outside_start(&scene.model);
    frame
        .recorded_step(&start, &state)
        .map_err(|fault| fault.to_string())
}

#[test]
fn a_state_in_space_has_lengths_directions_and_displacements() {
    let step = decoded(&in_space()).expect("the page is right");
    let record = &step.event.nodes[0];
    assert_eq!((record.f_t, record.slip), (3.0, 5e-3));
    let [force, slip] = record.directions.expect("in space");
    assert!((force.tan() - 0.75).abs() < 1e-12 && (force - slip).abs() < 1e-12);
    assert!(record.deviation().expect("it slides") < 1e-12);
    assert_eq!(step.event.frames[0], [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    assert_eq!(step.state.u[..3], [-4e-3, -3e-3, 0.0]);
}

#[test]
fn an_invalid_scene_or_state_in_space_is_refused_with_the_place() {
    for (which, pointer, value, told) in [
        (0, "/dimension", json!(4), "dimension: must be 2 or 3"),
        (
            0,
            "/dimension",
            json!(2),
            "nodes[0].at: a position must be two finite numbers",
        ),
        (
            0,
            "/nodes/1/at",
            json!([1, 0]),
            "nodes[1].at: a position must be three finite numbers",
        ),
        (
            0,
            "/faces/0",
            json!([0, 1]),
            "faces[0]: a face needs at least three nodes",
        ),
        (0, "/faces/0/2", json!(8), "faces[0]: there is no node 8"),
        (
            0,
            "/surfaces/0/faces",
            json!([]),
            "surfaces[0].faces: a surface in space needs at least one face",
        ),
        (
            1,
            "/contacts/0/f_t",
            json!(2.4),
            "contacts[0].f_t: must be 2 numbers",
        ),
        (
            1,
            "/contacts/0/slip",
            json!([1, 2, 3]),
            "contacts[0].slip: must be 2 numbers",
        ),
        (
            1,
            "/contacts/0/normal",
            json!([0, 1]),
            "contacts[0].normal: must be 3 numbers",
        ),
        (
            1,
            "/contacts/0/normal",
            json!([0, 0, 2]),
            "contacts[0].normal: must have length 1",
        ),
        (
            1,
            "/contacts/0/tangent",
            json!([0, 0, 1]),
            "contacts[0].tangent: must be at right angles",
        ),
        (
            1,
            "/displacements/3",
            json!([0, 0]),
            "displacements: each must be 3 numbers",
        ),
    ] {
        let mut both = in_space();
        *both[which].pointer_mut(pointer).expect(pointer) = value;
        let why = decoded(&both).err().unwrap_or_default();
        assert!(why.contains(told), "{pointer}: {why:?}");
    }
}
