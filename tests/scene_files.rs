//! Scene files: the built-in ones are sound, damaged ones get one message with a place, and nothing panics.

use stickslip::scene::{Scene, builtin};

#[test]
fn every_builtin_scene_is_sound_and_has_a_title() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!scene.model.title.is_empty());
        assert_eq!(builtin.title(), scene.model.title);
        assert!(
            scene.text.starts_with("// "),
            "{} opens with a drawing",
            builtin.name
        );
    }
}
