//! The iteration loops do not allocate once they are warm. A program of its own, since it counts for all threads.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use stickslip::scene::Scene;
use stickslip::step::stepper::Stepper;

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator unchanged; counting touches no memory of the caller.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A sheet that is bent, with a memory of its own.
const SHEET: &str = "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (4, 1)], elements: (4, 2))],
    materials: [Elastic(id: \"m\", E: 100, nu: 0.3, update: updated)],
    bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")], supports: [(node: \"k.left\", fix: [x, y])],
    loads: [Traction(along: \"k.right\", y: 1)], history: (path: [0, 1], increment: 0.01))";

/// A block that slides over another, to and fro.
const BLOCKS: &str = "(title: \"t\", nodes: [Block(id: \"low\", corners: [(0, 0), (3, 1)], elements: (6, 2)),
        Block(id: \"up\", corners: [(0.75, 1), (2.25, 1.6)], elements: (3, 2))],
    materials: [Elastic(id: \"m\", E: 100, nu: 0.3)],
    bodies: [Solid(id: \"low\", mesh: \"low\", material: \"m\"), Solid(id: \"up\", mesh: \"up\", material: \"m\")],
    surfaces: [(id: \"top\", along: \"low.top\")], slaves: [(nodes: [\"up.bottom\"], on: [\"top\"])],
    friction: (angle: 15), supports: [(node: \"low.bottom\", fix: [x, y])],
    loads: [Displacement(node: \"up.top\", component: y, value: -0.05, scale: [(0, 1)]),
        Displacement(node: \"up.top\", component: x, value: 0.1)],
    history: (path: [0, 1, -1, 1], increment: 0.05))";

#[test]
fn minor_major_and_increment_loops_do_not_allocate_after_warm_up() {
    for name in [
        "01-pinned-beam-rough-floor",
        "02-two-cantilevers-smooth",
        "02-two-cantilevers-rough",
        "02-two-cantilevers-rough condensed",
        "sheet",
        "sheet condensed",
        "blocks condensed",
    ] {
        let (scene, solver) = name.split_once(' ').unwrap_or((name, "augmented"));
        let set = [("settings.solver".to_string(), solver.to_string())];
        let scene = match scene {
            "sheet" => Scene::from_text(name, SHEET, &set),
            "blocks" => Scene::from_text(name, BLOCKS, &set),
            scene => Scene::open(scene, &set),
        };
        let scene = scene.unwrap_or_else(|e| panic!("{e}"));
        let mut stepper = Stepper::new(Arc::new(scene.model));
        let warm = 200.min(if name.contains("rough") { 60 } else { 200 });
        for _ in 0..warm {
            stepper.step();
        }
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        let mut increments = 0;
        for _ in 0..100 {
            let position = stepper.step().map(|e| e.position);
            increments = position.map_or(increments, |p| p.increment);
        }
        let made = ALLOCATIONS.load(Ordering::Relaxed) - before;
        assert_eq!(made, 0, "{name}, up to increment {increments}");
    }
}
