//! The diagnosis pages of failed scenes contain no untried advice that is not marked, and no contradictions:
//! `cargo bench --bench random_scenes -- 200 --pages` checks more.

use crate::outside::{page, tally};
use std::path::Path;
use stickslip::scene::{Scene, builtin};

#[test]
fn the_pages_of_failed_scenes_do_not_contradict_themselves() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/failures");
    let files = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = files
        .map(|file| file.unwrap().path().display().to_string())
        .filter(|name| name.ends_with(".ron"))
        .collect();
    let oscillates = builtin::list().iter().map(|scene| scene.name);
    names.extend(
        oscillates
            .filter(|name| name.starts_with("osc-"))
            .map(String::from),
    );
    names.sort();
    let mut failed = 0;
    for name in &names {
        let scene = Scene::open(name, &[]).unwrap_or_else(|error| panic!("{error}"));
        let faults = page::check(&scene).map(|page| page.faults);
        failed += usize::from(faults.is_some());
        let faults = faults.unwrap_or_default();
        assert!(faults.is_empty(), "{name}: {faults:#?}");
    }
    assert!(failed >= 15, "{failed} of {}", names.len());
    // Random scenes that fail; most of the first 200 of this seed.
    let numbers = [
        34, 63, 70, 71, 77, 95, 104, 106, 114, 119, 131, 142, 143, 167, 171, 185, 192,
    ];
    for number in numbers {
        let Ok((_, scene)) = tally::scene(1, number, &[]) else {
            panic!("scene {number}");
        };
        let page = page::check(&scene).unwrap_or_else(|| panic!("scene {number} finishes"));
        let faults = page.faults;
        assert!(faults.is_empty(), "scene {number}: {faults:#?}");
    }
}
