//! A scene that is read once has every bit of one that is read with its settings.

use crate::scenes::EVERYTHING;
use std::fmt::Debug;
use stickslip::format::paths;
use stickslip::model::Model;
use stickslip::scene::base::Base;
use stickslip::scene::{Scene, builtin};
use stickslip::study::{Plan, Study, Vary};

/// What tells all bits: -0 is not 0.
fn bits(what: &impl Debug) -> String {
    format!("{what:?}")
}

/// Values to try for one that is listed: all words, its own one otherwise, and what will not do.
fn values(listed: &paths::ListedScalar) -> Vec<String> {
    if let Some(words) = listed.kind.strip_prefix("one of ") {
        return words.split(", ").map(str::to_owned).collect();
    }
    let others = match (listed.value.parse::<f64>(), listed.kind.as_str()) {
        (Ok(_), "a whole number") => vec!["0", "1", "3"],
        (Ok(x), _) if x > 0.0 && x < 1.0 => vec!["-0.0", "1e-3", "0.3"],
        (Ok(_), _) => vec!["-1", "0.0", "2.5"],
        _ => vec!["true", "false", "none", "0.125"],
    };
    others.into_iter().map(str::to_owned).collect()
}

/// How often the base had a model, how often without compiling the scene again, and how often it had none.
#[derive(Default)]
struct Seen {
    models: usize,
    quick: usize,
    none: usize,
}

impl Seen {
    /// Compares the model of a base with that of the scene that is read with the same settings.
    fn compare(&mut self, base: &Base, text: &str, settings: &[(String, String)]) {
        let places: Option<Vec<_>> = settings.iter().map(|(path, _)| base.find(path)).collect();
        let Some(places) = places else {
            assert!(
                settings.iter().any(|(path, _)| path == "settings.memory")
                    || Scene::from_text(&base.scene().name, text, settings).is_err(),
                "{settings:?}"
            );
            return;
        };
        let values = settings.iter().map(|(_, value)| value.as_str());
        let set: Vec<_> = places.iter().zip(values).collect();
        let read = Scene::from_text(&base.scene().name, text, settings);
        let read: Option<Model> = read.ok().map(|scene| scene.model);
        let model = base.model(&set);
        assert_eq!(bits(&model), bits(&read), "{settings:?}");
        if let Some(count) = base.increments(&set) {
            self.quick += 1;
            let model = read.expect("what can be counted can be read");
            let legs = model.path.windows(2);
            let least: f64 = legs
                .map(|leg| (leg[1] - leg[0]).abs() / model.increment)
                .sum();
            assert!(count >= least - 1e-6 && count <= least + model.path.len() as f64);
        }
        match model {
            Some(_) => self.models += 1,
            None => self.none += 1,
        }
    }
}

/// Tries all values of all scalars, each with another one that was set before.
fn try_all(name: &str, text: &str) {
    let base = Base::new(Scene::from_text(name, text, &[]).unwrap_or_else(|e| panic!("{e}")));
    let mut seen = Seen::default();
    seen.compare(&base, text, &[]);
    let mut before: Vec<(String, String)> = Vec::new();
    for (k, listed) in paths::list(&base.scene().spec).iter().enumerate() {
        for value in values(listed) {
            let own = (listed.path.clone(), value);
            seen.compare(&base, text, std::slice::from_ref(&own));
            if k % 3 == 0 {
                seen.compare(&base, text, &[&before[..], &[own]].concat());
            }
        }
        before = vec![(listed.path.clone(), listed.value.clone())];
        if k % 2 == 0 && listed.kind == "a number" {
            before[0].1 = "0.75".to_owned();
        }
    }
    assert!(
        seen.models > 50 && seen.quick > 50 && seen.none > 20,
        "{name}"
    );
}

#[test]
fn whatever_is_set_a_base_has_the_model_of_the_scene_read_with_it_or_none() {
    for name in ["osc-two3", "osc-lag4", "02-two-cantilevers-rough"] {
        try_all(name, builtin::find(name).unwrap().text);
    }
    try_all("all", EVERYTHING);
    let problem = stickslip::study::random::Population {
        seed: 5,
        count: 1,
        nodes: 2..=2,
    };
    let problem = problem.draw(0).problem;
    try_all("contacts", &problem.text(&[]));
}

#[test]
fn a_case_has_the_model_of_its_scene_however_its_settings_are_written() {
    let vary = [
        "friction=10,20",
        "increment=1x,0.5x,0.2",
        "materials.*.EA=90,2x",
    ];
    let study = Study {
        scenes: vec![
            "02-two-cantilevers-rough".to_owned(),
            "02-two-cantilevers-smooth".to_owned(),
        ],
        vary: vary.map(|text| Vary::parse(text).unwrap()).to_vec(),
        set: vec![("settings.t_max".to_owned(), "consistent".to_owned())],
        ..Study::from_scene("02-two-cantilevers-rough")
    };
    for vary in [2, 3].map(|count| study.vary[..count].to_vec()) {
        let plan = Plan::new(Study {
            vary,
            ..study.clone()
        })
        .unwrap();
        assert!(plan.cases.len() >= 12);
        for case in &plan.cases {
            let scene = case.open().unwrap();
            assert_eq!(bits(&case.model().unwrap()), bits(&scene.model));
            let legs = scene.model.path.windows(2);
            let whole: f64 = legs
                .map(|leg| ((leg[1] - leg[0]).abs() / scene.model.increment - 1e-6).ceil())
                .sum();
            assert_eq!(case.increments, whole as u64);
            assert_eq!(case.value("settings.t_max"), Some("consistent"));
        }
    }
}
